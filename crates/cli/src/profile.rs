//! `--profile`: a built-in profile by its name, or a file, with the rule set that it names.

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
    path::CHECK,
};

pub(crate) use flagred::loaded::{Loaded, accepted, examine};

/// The profile that is used by default.
pub(crate) const DEFAULT: &str = "flagred";

/// Compiles a built-in profile or a file, with its rule set. Warnings are drawn on standard error.
pub(crate) fn load(name: &str) -> Result<Loaded, Failure> {
    let loaded = loaded::load(name, |path| read_profile(name, path)).map_err(failure)?;
    show(&loaded.warnings, name, loaded.profile.text());
    Ok(loaded)
}

/// Like [`load`], for a text that was already read from a file.
pub(crate) fn from_source(path: &Path, source: Source) -> Result<Loaded, Failure> {
    let name = path.display().to_string();
    let is_stdin = path == Path::new("-");
    let folder = path.parent().filter(|_| !is_stdin);
    let loaded = loaded::from_source(&name, source, folder, read_text).map_err(failure)?;
    show(&loaded.warnings, &name, loaded.profile.text());
    Ok(loaded)
}

/// Returns the rule set that a profile names, after compiling it. If the file is not a rule set, the failure points to the
/// line of the profile that names the file.
pub(crate) fn rule_set(
    profile: &Profile,
    (file, source): (&str, &Source),
    folder: Option<&Path>,
) -> Result<Source, Failure> {
    loaded::rule_set(profile, folder, read_text).map_err(|error| match error {
        LoadError::Unusable { message, help } => {
            let findings = flagred_authoring::unusable_rules(source, message, help);
            refuse(&findings, file, source.text())
        }
        other => failure(other),
    })
}

/// Reads a profile without its rule set. Also returns its text and, for a file, its folder.
pub(crate) fn read(name: &str) -> Result<(Profile, Source, Option<PathBuf>), Failure> {
    loaded::read(name, |path| read_profile(name, path)).map_err(failure)
}

/// Returns the file name and the text of the rule set that a profile names.
pub(crate) fn rules(profile: &Profile, folder: Option<&Path>) -> Result<(String, String), Failure> {
    loaded::rules(profile, folder, read_text).map_err(failure)
}

/// Reads the text of a profile, or of the rule set that it names.
fn read_profile(profile: &str, path: &Path) -> Result<String, Failure> {
    match path == Path::new(profile) {
        true => file_text(path),
        false => read_text(path),
    }
}

/// Reads a file whose name may be a misspelt name of a built-in profile.
pub(crate) fn file_text(path: &Path) -> Result<String, Failure> {
    read_text(path).map_err(|failure| {
        failure.instead_of(CHECK, || {
            let names = shipped::profile_names().join(", ");
            let all = path.to_string_lossy();
            match all.contains(',') && all.split(',').any(|name| is_shipped(name.trim())) {
                true => "name one profile".to_owned(),
                false => format!("built-in profiles are {names}"),
            }
        })
    })
}

/// Returns whether a built-in profile has this name.
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
