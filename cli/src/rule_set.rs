//! A rule set from a file, for the commands that use it.

use std::path::Path;

use flagred::profile::Profile;
use fuzzy::{Engine, Findings, Model, format::Document, validate};

use crate::{
    diagnostics::{read_text, refuse},
    failure::Failure,
};

/// Reads a rule set, which may have no rules yet. What is wrong with it is drawn on standard error; warnings are not:
/// `flagred check` tells them.
pub(crate) fn read(path: &Path) -> Result<(Document, String), Failure> {
    let text = read_text(path)?;
    let file = path.display().to_string();
    let document = fuzzy::yaml::parse(&text).map_err(|findings| {
        profile_instead(&file, &text).unwrap_or_else(|| refuse(&findings, &file, &text))
    })?;
    Ok((document, text))
}

/// Reads and compiles a rule set.
pub(crate) fn load(path: &Path) -> Result<(Model, Engine), Failure> {
    let (document, text) = read(path)?;
    let refuse = |findings| refuse(&findings, &path.display().to_string(), &text);
    let invalid = validate(&document.model, &document.spans);
    if !invalid.is_empty() {
        return Err(refuse(Findings::locate(invalid, &text)));
    }
    let engine = Engine::new(&document.model).map_err(refuse)?;
    Ok((document.model, engine))
}

/// What to say of a text that is no rule set because it is a profile: one thing, where its keys would be a page of
/// mistakes.
pub(crate) fn profile_instead(file: &str, text: &str) -> Option<Failure> {
    let profile = text.parse::<Profile>().ok()?;
    let failure = Failure::unreadable(format!("`{file}` is a profile, not a rule set"));
    Some(failure.help(format!("its rule set is `{}`", profile.rules)))
}
