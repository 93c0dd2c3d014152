//! A built-in rule set, or one from a file, for the commands that use it: in YAML, or in a format of another program.

use std::path::Path;

use flagred::profile::Profile;
use fuzzy::{Engine, Source, format::Document};

use crate::{
    built_in,
    diagnostics::{read_text, refuse},
    failure::Failure,
};

/// Reads a rule set, which is a built-in one's name or a file, and may have no rules yet. What is wrong with it is drawn on standard error; warnings are not:
/// `flagred check` tells them.
pub(crate) fn read(path: &Path) -> Result<Source, Failure> {
    let text = match built_in::rule_set_at(path) {
        Some(known) => known.text.to_owned(),
        None => read_text(path)?,
    };
    let source = flagred_interchange::source(text);
    document(&source, &path.display().to_string())?;
    Ok(source)
}

/// The rule set in a text that was read from a file. Its errors are drawn on standard error.
pub(crate) fn document<'s>(source: &'s Source, file: &str) -> Result<&'s Document, Failure> {
    source.document().map_err(|findings| {
        profile_instead(file, source).unwrap_or_else(|| refuse(&findings, file, source.text()))
    })
}

/// Reads and compiles a rule set.
pub(crate) fn load(path: &Path) -> Result<Engine, Failure> {
    engine(&read(path)?, &path.display().to_string()).cloned()
}

/// As [`document`], compiled.
pub(crate) fn engine<'s>(source: &'s Source, file: &str) -> Result<&'s Engine, Failure> {
    document(source, file)?;
    let engine = source.engine();
    engine.map_err(|findings| refuse(&findings, file, source.text()))
}

/// What to say of a text that is no rule set because it is a profile: one thing, where its keys would be a page of
/// mistakes.
fn profile_instead(file: &str, source: &Source) -> Option<Failure> {
    let profile = Profile::from_source(source).ok()?;
    let failure = Failure::unreadable(format!("`{file}` is a profile, not a rule set"));
    Some(failure.help(format!("its rule set is `{}`", profile.rules)))
}
