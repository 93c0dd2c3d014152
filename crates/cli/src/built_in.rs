//! Built-in rule sets and profiles, by name. A built-in name takes precedence over a file of that name; to refer to the
//! file, write `./flagred`.

use std::path::Path;

use flagred::shipped::{PROFILES, RULE_SETS, Shipped};

use crate::failure::Failure;

/// Returns the built-in rule set that a path names, if any.
pub(crate) fn rule_set_at(path: &Path) -> Option<&'static Shipped> {
    RULE_SETS.iter().find(|known| path == Path::new(known.name))
}

/// Returns the built-in profile that a path names, if any.
pub(crate) fn profile_at(path: &Path) -> Option<&'static Shipped> {
    PROFILES.iter().find(|known| path == Path::new(known.name))
}

/// Returns the built-in rule set with the given name.
pub(crate) fn rule_set(name: &str) -> Result<&'static Shipped, Failure> {
    rule_set_at(Path::new(name)).ok_or_else(|| unknown(name))
}

/// Returns the built-in profile with the given name.
pub(crate) fn profile(name: &str) -> Result<&'static Shipped, Failure> {
    profile_at(Path::new(name)).ok_or_else(|| unknown(name))
}

/// Explains how to edit a copy of a built-in item, if the path names one and no such file exists.
pub(crate) fn help_to_edit(path: &Path) -> Option<String> {
    let known = profile_at(path).filter(|_| !path.exists())?;
    let name = known.name;
    Some(format!(
        "`{name}` is built in; `flagred new NAME --from {name}` writes a copy of the rule set to edit, `flagred new NAME --profile {name}` a copy of the profile"
    ))
}

fn unknown(name: &str) -> Failure {
    Failure::usage(format!("there is no built-in `{name}`"))
}

/// The names of built-in rule sets and profiles, for an argument. Each rule set has a profile of the same name.
pub(crate) fn names() -> clap::builder::PossibleValuesParser {
    clap::builder::PossibleValuesParser::new(profile_names())
}

/// The names of built-in profiles.
pub(crate) fn profile_names() -> impl Iterator<Item = &'static str> + Clone {
    PROFILES.iter().map(|known| known.name)
}
