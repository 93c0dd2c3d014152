//! A rule set from a file, for the commands that use it.

use std::path::Path;

use fuzzy::{Engine, Model};

use crate::{
    diagnostics::{read_text, refuse},
    failure::Failure,
};

/// Reads and compiles a rule set. What is wrong with it is drawn on standard error; warnings are not: `flagred check`
/// tells them.
pub(crate) fn load(path: &Path) -> Result<(Model, Engine), Failure> {
    let text = read_text(path)?;
    let file = path.display().to_string();
    let document = fuzzy::yaml::parse(&text).map_err(|findings| refuse(&findings, &file, &text))?;
    let model = document.model;
    let engine = Engine::new(&model).map_err(|error| refuse(&error.findings(), &file, &text))?;
    Ok((model, engine))
}
