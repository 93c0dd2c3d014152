//! A built-in rule set, or one from a file, for the commands that use it: in YAML, or in a format of another program.

use std::path::Path;

use flagred::profile::Profile;
use fuzzy::{Engine, Model, format::Document};

use crate::{
    built_in,
    diagnostics::{read_text, refuse},
    failure::Failure,
};

/// Reads a rule set, which is a built-in one's name or a file, and may have no rules yet. What is wrong with it is drawn on standard error; warnings are not:
/// `flagred check` tells them.
pub(crate) fn read(path: &Path) -> Result<(Document, String), Failure> {
    let text = match built_in::rule_set_at(path) {
        Some(known) => known.text.to_owned(),
        None => read_text(path)?,
    };
    let document = parse(&path.display().to_string(), &text)?;
    Ok((document, text))
}

/// As [`read`], of a text that was read from a file.
pub(crate) fn parse(file: &str, text: &str) -> Result<Document, Failure> {
    flagred_interchange::document(text).map_err(|findings| {
        profile_instead(file, text).unwrap_or_else(|| refuse(&findings, file, text))
    })
}

/// Reads and compiles a rule set.
pub(crate) fn load(path: &Path) -> Result<(Model, Engine), Failure> {
    let (document, text) = read(path)?;
    let engine = compile(&document, &path.display().to_string(), &text)?;
    Ok((document.model, engine))
}

/// Compiles a rule set that was read. Its errors are drawn on standard error.
pub(crate) fn compile(document: &Document, file: &str, text: &str) -> Result<Engine, Failure> {
    let compiled = document.validate(text);
    let compiled = compiled.and_then(|()| Engine::new(&document.model));
    compiled.map_err(|findings| refuse(&findings, file, text))
}

/// What to say of a text that is no rule set because it is a profile: one thing, where its keys would be a page of
/// mistakes.
fn profile_instead(file: &str, text: &str) -> Option<Failure> {
    let profile = text.parse::<Profile>().ok()?;
    let failure = Failure::unreadable(format!("`{file}` is a profile, not a rule set"));
    Some(failure.help(format!("its rule set is `{}`", profile.rules)))
}
