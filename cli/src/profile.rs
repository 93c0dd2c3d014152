//! `--profile`: a shipped profile by its name, or a file, with the rule set it names.

use std::path::{Path, PathBuf};

use flagred::{estimator::Estimator, profile::Profile, shipped};
use fuzzy::Model;

use crate::{
    diagnostics::{read_text, refuse},
    failure::Failure,
};

/// The profile that is used where none is named.
pub(crate) const DEFAULT: &str = "flagred";

/// A profile and its rule set, ready to use and as they were written.
pub(crate) struct Loaded {
    pub(crate) estimator: Estimator,
    pub(crate) model: Model,
    pub(crate) profile_text: String,
    pub(crate) rules_text: String,
    /// Where it may have been read from; empty for a shipped one.
    pub(crate) files: Vec<PathBuf>,
}

/// Compiles a profile, which is a shipped one's name or a file, with its rule set.
///
/// A shipped name wins over a file of that name (`./flagred` is the file); a file's rule set is looked for beside it first, and then among the shipped ones.
pub(crate) fn load(name: &str) -> Result<Loaded, Failure> {
    let (profile, profile_text, folder) = read(name)?;
    let (rules_file, rules_text) = rules(&profile, folder.as_deref())?;
    let beside = |folder: &PathBuf| [PathBuf::from(name), folder.join(&profile.rules)];
    let files = folder.iter().flat_map(beside).collect();
    let model = fuzzy::yaml::parse(&rules_text)
        .map_err(|findings| refuse(&findings, &rules_file, &rules_text))?
        .model;
    let estimator = Estimator::new(&profile, &model).map_err(|error| {
        Failure::unreadable(format!(
            "profile `{}` with rule set `{}`: {error}",
            profile.name, profile.rules
        ))
    })?;
    Ok(Loaded {
        estimator,
        model,
        profile_text,
        rules_text,
        files,
    })
}

/// Reads a profile without its rule set: also its text, and of a file the folder it is in.
pub(crate) fn read(name: &str) -> Result<(Profile, String, Option<PathBuf>), Failure> {
    let path = Path::new(name);
    let shipped = shipped::PROFILES.iter().find(|known| known.name == name);
    let (text, folder) = match shipped {
        Some(known) => (known.text.to_owned(), None),
        None => {
            let text = read_text(path).map_err(|failure| {
                failure.help(format!(
                    "shipped profiles are {}",
                    shipped::profile_names().join(" and ")
                ))
            })?;
            (text, path.parent().map(Path::to_owned))
        }
    };
    let profile = text.parse::<Profile>().map_err(|findings| {
        if fuzzy::yaml::parse(&text).is_ok() {
            return Failure::unreadable(format!("`{name}` is a rule set, not a profile"))
                .help(format!("write a profile that names it, with `rules: {}` and where each input comes from", file_name(path)));
        }
        refuse(&findings, name, &text)
    })?;
    Ok((profile, text, folder))
}

fn file_name(path: &Path) -> String {
    let file = path.file_name().unwrap_or(path.as_os_str());
    file.to_string_lossy().into_owned()
}

/// The file and the text of the rule set that a profile names.
fn rules(profile: &Profile, folder: Option<&Path>) -> Result<(String, String), Failure> {
    let beside = folder.map(|folder| folder.join(&profile.rules));
    if let Some(path) = beside.filter(|path| path.is_file()) {
        return Ok((path.display().to_string(), read_text(&path)?));
    }
    let shipped = shipped::RULE_SETS
        .iter()
        .find(|known| known.name == profile.rules);
    shipped
        .map(|known| (known.file.to_owned(), known.text.to_owned()))
        .ok_or_else(|| {
            Failure::unreadable(format!(
                "profile `{}` names the rule set `{}`, which is neither a file beside it nor built in",
                profile.name, profile.rules
            ))
        })
}
