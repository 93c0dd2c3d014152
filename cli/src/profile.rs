//! `--profile`: a shipped profile by its name, or a file, with the rule set it names.

use std::{
    env,
    path::{Path, PathBuf},
};

use ::report::findings::is_meant_as_rules;
use flagred::{estimator::Estimator, profile::Profile, shipped};
use fuzzy::{Findings, Model, tree::Value};

use crate::{
    diagnostics::{read_text, refuse, show},
    failure::Failure,
    rule_set,
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

/// Compiles a profile, which is a shipped one's name or a file, with its rule set. Warnings are drawn on standard error.
///
/// A shipped name wins over a file of that name (`./flagred` is the file); a file's rule set is looked for beside it first,
/// and then among the shipped ones. A profile may come from somebody else: the rule set lies in its folder, or in the one
/// that `FLAGRED_RULES` names, and a file that is no rule set is not quoted.
pub(crate) fn load(name: &str) -> Result<Loaded, Failure> {
    let (profile, text, folder) = read(name)?;
    compile(name, &profile, text, folder.as_deref())
}

/// As [`load`], of a text that was read from a file.
pub(crate) fn from_text(path: &Path, text: String) -> Result<Loaded, Failure> {
    let name = path.display().to_string();
    let profile = parse(&name, &text)?;
    let is_stdin = path == Path::new("-");
    let folder = path.parent().filter(|_| !is_stdin);
    compile(&name, &profile, text, folder)
}

fn compile(
    name: &str,
    profile: &Profile,
    profile_text: String,
    folder: Option<&Path>,
) -> Result<Loaded, Failure> {
    let (model, rules_text) = model(profile, folder)?;
    let (findings, estimator) = examine(&profile_text, &model);
    let Some(estimator) = estimator else {
        return Err(refuse(&findings, name, &profile_text));
    };
    show(&findings, name, &profile_text);
    let beside = |folder: &Path| [PathBuf::from(name), folder.join(&profile.rules)];
    Ok(Loaded {
        files: folder.into_iter().flat_map(beside).collect(),
        estimator,
        model,
        profile_text,
        rules_text,
    })
}

/// The findings about the text of a profile and the rule set that it names.
pub(crate) fn examine(profile_text: &str, model: &Model) -> (Findings, Option<Estimator>) {
    let known = flightlog::known_signals();
    let signals: Vec<(&str, &str)> = known.iter().map(|s| (s.name, s.unit)).collect();
    flagred::check::profile(profile_text, model, &signals)
}

/// The rule set that a profile names, and its text.
pub(crate) fn model(profile: &Profile, folder: Option<&Path>) -> Result<(Model, String), Failure> {
    let (file, text) = rules(profile, folder)?;
    let document =
        fuzzy::yaml::parse(&text).map_err(|findings| match is_meant_as_rules(&text) {
            true => refuse(&findings, &file, &text),
            false => Failure::unreadable(format!(
                "profile `{}` names `{file}`, which is not a rule set",
                profile.name
            ))
            .help("a rule set has the keys `inputs`, `outputs` and `rules`"),
        })?;
    rule_set::compile(&document, &file, &text)?;
    Ok((document.model, text))
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
    Ok((parse(name, &text)?, text, folder))
}

fn parse(name: &str, text: &str) -> Result<Profile, Failure> {
    text.parse::<Profile>().map_err(|findings| {
        if fuzzy::yaml::parse(text).is_ok() {
            return Failure::unreadable(format!("`{name}` is a rule set, not a profile"))
                .help(format!("write a profile that names it, with `rules: {}` and where each input comes from", file_name(Path::new(name))));
        }
        refuse(&findings, name, text)
    })
}

fn file_name(path: &Path) -> String {
    let file = path.file_name().unwrap_or(path.as_os_str());
    file.to_string_lossy().into_owned()
}

/// Whether a text is meant to be a profile: whether it has the key `flagred`, also where it is no YAML yet.
pub(crate) fn is_profile(text: &str) -> bool {
    let tree = fuzzy::yaml::read(text).map(|tree| tree.value);
    let Ok(Value::Mapping(pairs)) = tree else {
        return text.lines().any(|line| line.starts_with("flagred:"));
    };
    let mut keys = pairs.iter().map(|(key, _)| &key.value);
    keys.any(|key| matches!(key, Value::Scalar(key) if key.text == "flagred"))
}

/// The file and the text of the rule set that a profile names.
pub(crate) fn rules(profile: &Profile, folder: Option<&Path>) -> Result<(String, String), Failure> {
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
