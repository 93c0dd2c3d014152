//! `--profile`: a shipped profile by its name, or a file, with the rule set it names.

use std::path::Path;

use flagred::{estimator::Estimator, profile::Profile, shipped};
use fuzzy::Model;

use crate::{
    diagnostics::{read_text, refuse},
    failure::Failure,
};

/// The profile that is used where none is named.
pub(crate) const DEFAULT: &str = "flagred";

/// Compiles a profile, which is a shipped one's name or a file, with its rule set.
///
/// A shipped name wins over a file of that name (`./flagred` is the file); a file's rule set is looked for beside it first, and then among the shipped ones.
pub(crate) fn load(profile: &str) -> Result<Estimator, Failure> {
    let path = Path::new(profile);
    let (profile, rules) = match shipped::profile(profile) {
        Some(read) => {
            let read = read.map_err(Failure::unreadable)?;
            let rules = rules(&read, None)?;
            (read, rules)
        }
        None => {
            let text = read_text(path).map_err(|failure| {
                failure.help(format!(
                    "shipped profiles are {}",
                    shipped::profile_names().join(" and ")
                ))
            })?;
            let read =
                Profile::from_yaml(&text).map_err(|findings| refuse(&findings, profile, &text))?;
            let rules = rules(&read, path.parent())?;
            (read, rules)
        }
    };
    Estimator::new(&profile, &rules).map_err(|error| {
        Failure::unreadable(format!(
            "profile `{}` with rule set `{}`: {error}",
            profile.name, profile.rules
        ))
    })
}

fn rules(profile: &Profile, folder: Option<&Path>) -> Result<Model, Failure> {
    let beside = folder.map(|folder| folder.join(&profile.rules));
    match (
        beside.filter(|path| path.is_file()),
        shipped::rule_set(&profile.rules),
    ) {
        (Some(path), _) => {
            let text = read_text(&path)?;
            let document = fuzzy::yaml::parse(&text)
                .map_err(|findings| refuse(&findings, &path.display().to_string(), &text))?;
            Ok(document.model)
        }
        (None, Some(read)) => read.map_err(Failure::unreadable),
        (None, None) => Err(Failure::unreadable(format!(
            "profile `{}` names the rule set `{}`, which is no file beside it and not shipped",
            profile.name, profile.rules
        ))),
    }
}
