//! `--profile`: a shipped profile by its name, or a file, with the rule set it names.

use std::{
    env,
    path::{Path, PathBuf},
};

use flagred::{estimator::Estimator, profile::Profile, shipped};
use fuzzy::Model;

use crate::{
    diagnostics::{is_meant_as_rules, read_text, refuse},
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
/// A profile may come from somebody else: the rule set lies in its folder, or in the one that `FLAGRED_RULES` names, and
/// a file that is no rule set is not quoted.
pub(crate) fn load(name: &str) -> Result<Loaded, Failure> {
    let (profile, profile_text, folder) = read(name)?;
    let (rules_file, rules_text) = rules(&profile, folder.as_deref())?;
    let beside = |folder: &PathBuf| [PathBuf::from(name), folder.join(&profile.rules)];
    let files = folder.iter().flat_map(beside).collect();
    let model = fuzzy::yaml::parse(&rules_text)
        .map_err(|findings| match is_meant_as_rules(&rules_text) {
            true => refuse(&findings, &rules_file, &rules_text),
            false => Failure::unreadable(format!(
                "profile `{}` names `{rules_file}`, which is not a rule set",
                profile.name
            ))
            .help("a rule set has the keys `inputs`, `outputs` and `rules`"),
        })?
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
        if !is_allowed(&path, folder) {
            return Err(Failure::unreadable(format!(
                "profile `{}` names the rule set `{}`, which is not in the profile's folder",
                profile.name, profile.rules
            ))
            .help("move it there, or allow its folder with FLAGRED_RULES=FOLDER"));
        }
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

/// Whether a file, all links followed, lies in the folder of its profile or in the folder that the caller allows.
fn is_allowed(path: &Path, folder: Option<&Path>) -> bool {
    let Ok(path) = path.canonicalize() else {
        return false;
    };
    // The folder of `profile.yaml` has no name.
    let folder = folder.map(|folder| match folder.as_os_str().is_empty() {
        true => PathBuf::from("."),
        false => folder.to_owned(),
    });
    let allowed = env::var_os("FLAGRED_RULES").map(PathBuf::from);
    [folder, allowed]
        .into_iter()
        .flatten()
        .filter_map(|folder| folder.canonicalize().ok())
        .any(|folder| path.starts_with(folder))
}
