//! `--profile`: a shipped profile by its name, or a file, with the rule set it names.

use std::path::{Path, PathBuf};

use flagred::{
    loaded::{self, LoadError},
    profile::Profile,
    shipped,
};
use fuzzy::Source;

use crate::{
    diagnostics::{read_text, refuse, show},
    failure::Failure,
};

pub(crate) use flagred::loaded::{Loaded, examine};

/// The profile that is used where none is named.
pub(crate) const DEFAULT: &str = "flagred";

/// Compiles a profile, which is a shipped one's name or a file, with its rule set. Warnings are drawn on standard error.
pub(crate) fn load(name: &str) -> Result<Loaded, Failure> {
    let loaded = loaded::load(name, |path| read_profile(name, path)).map_err(failure)?;
    show(&loaded.warnings, name, loaded.profile.text());
    Ok(loaded)
}

/// As [`load`], of a text that was read from a file.
pub(crate) fn from_source(path: &Path, source: Source) -> Result<Loaded, Failure> {
    let name = path.display().to_string();
    let is_stdin = path == Path::new("-");
    let folder = path.parent().filter(|_| !is_stdin);
    let loaded = loaded::from_source(&name, source, folder, read_text).map_err(failure)?;
    show(&loaded.warnings, &name, loaded.profile.text());
    Ok(loaded)
}

/// The rule set that a profile names. It compiles.
pub(crate) fn rule_set(profile: &Profile, folder: Option<&Path>) -> Result<Source, Failure> {
    loaded::rule_set(profile, folder, read_text).map_err(failure)
}

/// Reads a profile without its rule set: also what it was written as, and of a file the folder it is in.
pub(crate) fn read(name: &str) -> Result<(Profile, Source, Option<PathBuf>), Failure> {
    loaded::read(name, |path| read_profile(name, path)).map_err(failure)
}

/// The file and the text of the rule set that a profile names.
pub(crate) fn rules(profile: &Profile, folder: Option<&Path>) -> Result<(String, String), Failure> {
    loaded::rules(profile, folder, read_text).map_err(failure)
}

/// The text of a profile, or of the rule set that it names.
fn read_profile(profile: &str, path: &Path) -> Result<String, Failure> {
    match path == Path::new(profile) {
        true => file_text(path),
        false => read_text(path),
    }
}

/// The text of a file that may be the misspelt name of a shipped profile.
pub(crate) fn file_text(path: &Path) -> Result<String, Failure> {
    read_text(path).map_err(|failure| {
        let names = shipped::profile_names().join(", ");
        failure.help(format!("built-in profiles are {names}"))
    })
}

/// Whether a profile of this name is shipped.
pub(crate) fn is_shipped(name: &str) -> bool {
    shipped::PROFILES.iter().any(|known| known.name == name)
}

fn failure(error: LoadError<Failure>) -> Failure {
    match error {
        LoadError::Read(failure) => failure,
        LoadError::Findings {
            file,
            text,
            findings,
        } => refuse(&findings, &file, &text),
        LoadError::Unusable { message, help } => Failure::unreadable(message).help_if(help),
    }
}
