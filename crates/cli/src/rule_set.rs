//! Built-in rule sets and rule set files for the commands that use them: in YAML, or in a format of another program.

use std::path::Path;

use flagred::profile::Profile;
use fuzzy::{Engine, Source, format::Document};

use crate::{
    built_in,
    diagnostics::{read_text, refuse},
    failure::Failure,
};

/// Reads a built-in rule set or a file, which may have no rules yet. Errors are drawn on standard error. Warnings are not: `flagred check`
/// reports them.
pub(crate) fn read(path: &Path) -> Result<Source, Failure> {
    let text = match built_in::rule_set_at(path) {
        Some(known) => known.text.to_owned(),
        None => read_text(path)?,
    };
    let source = flagred_interchange::source(text);
    document(&source, &path.display().to_string())?;
    Ok(source)
}

/// Parses a rule set that was read from a file. Errors are drawn on standard error.
pub(crate) fn document<'s>(source: &'s Source, file: &str) -> Result<&'s Document, Failure> {
    source.document().map_err(|findings| {
        profile_instead(file, source).unwrap_or_else(|| refuse(&findings, file, source.text()))
    })
}

/// Reads and compiles a rule set.
pub(crate) fn load(path: &Path) -> Result<Engine, Failure> {
    engine(&read(path)?, &path.display().to_string()).cloned()
}

/// Like [`document`], but also compiles the rule set.
pub(crate) fn engine<'s>(source: &'s Source, file: &str) -> Result<&'s Engine, Failure> {
    document(source, file)?;
    let engine = source.engine();
    engine.map_err(|findings| refuse(&findings, file, source.text()))
}

/// Recognises a profile in place of a rule set. One message then replaces an error for each of its keys.
fn profile_instead(file: &str, source: &Source) -> Option<Failure> {
    let profile = Profile::from_source(source).ok()?;
    let failure = Failure::unreadable(format!("`{file}` is a profile, not a rule set"));
    Some(failure.help(format!("its rule set is `{}`", profile.rules)))
}
