//! Rule sets and profiles that are built in, by their names. A name wins over a file that is called so: `./flagred` is the file.

use std::path::Path;

use flagred::shipped::{PROFILES, RULE_SETS, Shipped};

use crate::failure::Failure;

/// The built-in rule set that a path names, if it names one.
pub(crate) fn rule_set_at(path: &Path) -> Option<&'static Shipped> {
    RULE_SETS.iter().find(|known| path == Path::new(known.name))
}

/// The built-in profile that a path names, if it names one.
pub(crate) fn profile_at(path: &Path) -> Option<&'static Shipped> {
    PROFILES.iter().find(|known| path == Path::new(known.name))
}

/// The built-in rule set of a name.
pub(crate) fn rule_set(name: &str) -> Result<&'static Shipped, Failure> {
    rule_set_at(Path::new(name)).ok_or_else(|| unknown(name))
}

/// The built-in profile of a name.
pub(crate) fn profile(name: &str) -> Result<&'static Shipped, Failure> {
    profile_at(Path::new(name)).ok_or_else(|| unknown(name))
}

/// How to change what is built in, where a path names it and no file is there.
pub(crate) fn help_to_edit(path: &Path) -> Option<String> {
    let known = profile_at(path).filter(|_| !path.exists())?;
    let name = known.name;
    Some(format!(
        "`{name}` is built in; `flagred new NAME --from {name}` writes a copy of the rule set to edit, `flagred new NAME --profile {name}` one of the profile"
    ))
}

fn unknown(name: &str) -> Failure {
    Failure::usage(format!("there is no built-in `{name}`"))
}

/// The names of built-in rule sets and profiles, for an argument; each rule set has a profile of its name.
pub(crate) fn names() -> clap::builder::PossibleValuesParser {
    clap::builder::PossibleValuesParser::new(profile_names())
}

/// The names of built-in profiles.
pub(crate) fn profile_names() -> impl Iterator<Item = &'static str> {
    PROFILES.iter().map(|known| known.name)
}
