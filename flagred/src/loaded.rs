//! Loads a profile by its name or from a file, with the rule set that it names.

use std::{
    env,
    ffi::OsStr,
    path::{Path, PathBuf},
};

use alloc::{
    borrow::ToOwned,
    format,
    string::{String, ToString},
    vec::Vec,
};

use fuzzy::{
    Findings, Source,
    check::AcceptedFindings,
    diagnostic::nearest,
    tree::{Node, Value},
    yaml::{KEYS_OF_RULES, has_key},
};

use crate::{check, estimator::Estimator, profile::Profile, shipped};

/// A loaded profile and rule set, compiled and in source form.
#[derive(Debug, Clone)]
pub struct Loaded {
    /// The compiled profile and rule set.
    pub estimator: Estimator,
    /// The source of the profile.
    pub profile: Source,
    /// The source of the rule set.
    pub rules: Source,
    /// Warnings, which do not prevent the use of the profile.
    pub warnings: Findings,
    /// The files that the profile and its rule set may have been read from; empty for a shipped
    /// profile.
    pub files: Vec<PathBuf>,
}

/// The reason why a profile cannot be used. `E` is the error of reading a file.
#[derive(Debug, thiserror::Error)]
pub enum LoadError<E> {
    /// The profile cannot be read.
    #[error("{0}")]
    Read(E),
    /// A text has errors.
    #[error("`{file}` cannot be used:\n{findings}")]
    Findings {
        /// The name of the file.
        file: String,
        /// The content of the file.
        text: String,
        /// The errors in it.
        findings: Findings,
    },
    /// A file has another format, is missing, or is in a folder that is not allowed.
    #[error("{message}")]
    Unusable {
        /// The file, and the reason.
        message: String,
        /// What to do.
        help: Option<String>,
    },
}

impl<E> LoadError<E> {
    fn unusable(message: String) -> Self {
        LoadError::Unusable {
            message,
            help: None,
        }
    }

    fn help(self, help: impl Into<String>) -> Self {
        match self {
            LoadError::Unusable { message, .. } => LoadError::Unusable {
                message,
                help: Some(help.into()),
            },
            other => other,
        }
    }
}

/// Loads a profile, given by the name of a shipped profile or by a file, with its rule set. `read` returns the content
/// of a file.
///
/// The name of a shipped profile or rule set takes precedence over a file of that name (`./flagred` is the file). Other
/// rule sets are files next to the profile. A profile may come from an untrusted source:
/// its rule set must be in its folder, or in the folder that `FLAGRED_RULES` names, and messages do not quote a file
/// that is not a rule set.
///
/// # Errors
/// If a file cannot be read, or if its content cannot be used.
///
/// # Example
/// ```
/// use flagred::loaded::load;
///
/// let loaded = load("flagred", |path| std::fs::read_to_string(path))?;
/// assert_eq!(loaded.estimator.profile().name, "flagred");
/// # Ok::<(), flagred::loaded::LoadError<std::io::Error>>(())
/// ```
pub fn load<E>(
    name: &str,
    read: impl Fn(&Path) -> Result<String, E>,
) -> Result<Loaded, LoadError<E>> {
    let (profile, source, folder) = self::read(name, &read)?;
    let rules = rule_set(&profile, folder.as_deref(), read)?;
    finish(name, &profile.rules, (source, folder.as_deref()), rules)
}

/// As [`load`], from the text of a profile. `folder` is the folder of the file that contains the text; `None` if
/// the text is not from a file.
///
/// # Errors
/// As [`load`].
pub fn from_source<E>(
    name: &str,
    profile: Source,
    folder: Option<&Path>,
    read: impl Fn(&Path) -> Result<String, E>,
) -> Result<Loaded, LoadError<E>> {
    let parsed = parse(name, &profile)?;
    let rules = rule_set(&parsed, folder, read)?;
    finish(name, &parsed.rules, (profile, folder), rules)
}

/// As [`from_source`], with a rule set that replaces the one that the profile names.
///
/// # Errors
/// As [`load`]; no file is read.
pub fn with_rules<E>(name: &str, profile: Source, rules: Source) -> Result<Loaded, LoadError<E>> {
    let parsed = parse(name, &profile)?;
    let rules = compiled(&parsed, parsed.rules.clone(), rules)?;
    finish(name, &parsed.rules, (profile, None), rules)
}

fn finish<E>(
    name: &str,
    rules_name: &str,
    (profile, folder): (Source, Option<&Path>),
    rules: Source,
) -> Result<Loaded, LoadError<E>> {
    let (findings, estimator) = fit(&profile, &rules);
    let Some(estimator) = estimator else {
        return Err(LoadError::Findings {
            file: name.to_owned(),
            text: profile.text().to_owned(),
            findings,
        });
    };
    let beside = |folder: &Path| [PathBuf::from(name), folder.join(rules_name)];
    Ok(Loaded {
        files: folder.into_iter().flat_map(beside).collect(),
        estimator,
        profile,
        rules,
        warnings: findings,
    })
}

/// Returns the findings of [`fit`] and [`outvoted`], for the author of a profile, and the estimator if the profile
/// can be used.
#[doc(hidden)] // For the programs of this repository.
pub fn examine(profile: &Source, rules: &Source) -> (Findings, Option<Estimator>) {
    let (mut findings, estimator) = fit(profile, rules);
    if let Some(estimator) = &estimator {
        findings.0.extend(outvoted(profile, estimator).0);
    }
    (findings, estimator)
}

/// The findings of [`check::profile`], with the signals that flight logs contain.
pub fn fit(profile: &Source, rules: &Source) -> (Findings, Option<Estimator>) {
    check::profile(profile, rules, &signals())
}

/// The findings of [`check::outvoted`], with the signals that flight logs contain.
pub fn outvoted(profile: &Source, estimator: &Estimator) -> Findings {
    check::outvoted(profile, estimator, &signals())
}

/// The findings that the author of a profile accepts: those of [`check::accepted`], with the signals that flight logs contain.
#[doc(hidden)] // For the programs of this repository.
pub fn accepted(profile: &Source, rules: &Source) -> Vec<AcceptedFindings> {
    check::accepted(profile, rules, &signals())
}

fn signals() -> Vec<(&'static str, &'static str)> {
    let known = flagred_flightlog::known_signals();
    known.iter().map(|s| (s.name, s.unit)).collect()
}

/// The rule set that a profile names, after verifying that it compiles.
///
/// # Errors
/// As [`load`].
#[doc(hidden)] // For the programs of this repository.
pub fn rule_set<E>(
    profile: &Profile,
    folder: Option<&Path>,
    read: impl Fn(&Path) -> Result<String, E>,
) -> Result<Source, LoadError<E>> {
    let (file, text) = rules(profile, folder, read)?;
    compiled(profile, file, Source::new(text))
}

/// Verifies that a rule set compiles; `file` is its name in findings.
fn compiled<E>(profile: &Profile, file: String, source: Source) -> Result<Source, LoadError<E>> {
    if source.document().is_err() && is_profile(&source) {
        return Err(LoadError::unusable(format!(
            "profile `{}` names `{}`, which is a profile, not a rule set",
            profile.name, profile.rules
        ))
        .help("name a rule set, which begins with `fuzzy: 1`, such as `rules: flagred-paper`"));
    }
    if source.document().is_err() && !is_meant_as_rules(source.text()) {
        return Err(LoadError::unusable(format!(
            "profile `{}` names `{file}`, which is not a rule set",
            profile.name
        ))
        .help(match Path::new(&file).extension().and_then(OsStr::to_str) {
            Some("fis" | "t2fis" | "fll" | "fcl" | "fml") => format!(
                "a profile needs a rule set in YAML: `flagred import {file} --output {}`",
                Path::new(&file).with_extension("yaml").display()
            ),
            _ => "a rule set has the keys `inputs`, `outputs` and `rules`".to_owned(),
        }));
    }
    match source.engine().err() {
        None => Ok(source),
        Some(findings) => Err(LoadError::Findings {
            file,
            text: source.text().to_owned(),
            findings,
        }),
    }
}

/// Reads a profile without its rule set. Also returns its source and, for a file, the folder that contains it.
///
/// # Errors
/// As [`load`].
#[doc(hidden)] // For the programs of this repository.
pub fn read<E>(
    name: &str,
    read: impl Fn(&Path) -> Result<String, E>,
) -> Result<(Profile, Source, Option<PathBuf>), LoadError<E>> {
    let path = Path::new(name);
    let shipped = shipped::PROFILES.iter().find(|known| known.name == name);
    let (text, folder) = match shipped {
        Some(known) => (known.text.to_owned(), None),
        None => {
            let text = read(path).map_err(LoadError::Read)?;
            (text, path.parent().map(Path::to_owned))
        }
    };
    let source = Source::new(text);
    Ok((parse(name, &source)?, source, folder))
}

fn parse<E>(name: &str, source: &Source) -> Result<Profile, LoadError<E>> {
    Profile::from_source(source).map_err(|findings| {
        if source.document().is_ok() {
            let file = Path::new(name);
            let file = file.file_name().unwrap_or(file.as_os_str()).to_string_lossy();
            return LoadError::unusable(format!("`{name}` is a rule set, not a profile"))
                .help(format!("write a profile that names it, with `rules: {file}` and the source of each input"));
        }
        LoadError::Findings { file: name.to_owned(), text: source.text().to_owned(), findings }
    })
}

/// The file and the text of the rule set that a profile names.
///
/// # Errors
/// As [`load`].
#[doc(hidden)] // For the programs of this repository.
pub fn rules<E>(
    profile: &Profile,
    folder: Option<&Path>,
    read: impl Fn(&Path) -> Result<String, E>,
) -> Result<(String, String), LoadError<E>> {
    let mut shipped = shipped::RULE_SETS.iter();
    if let Some(known) = shipped.find(|known| known.name == profile.rules) {
        return Ok((known.file.to_owned(), known.text.to_owned()));
    }
    let path = folder.map(|folder| folder.join(&profile.rules));
    if let Some(path) = path.as_ref().filter(|path| path.is_file()) {
        if !is_allowed(path, folder) {
            return Err(LoadError::unusable(format!(
                "profile `{}` names the rule set `{}`, which is not in the profile's folder",
                profile.name, profile.rules
            ))
            .help("move the rule set there, or allow its folder with FLAGRED_RULES=FOLDER"));
        }
        let text = read(path).map_err(LoadError::Read)?;
        return Ok((path.display().to_string(), text));
    }
    if path.is_some_and(|path| path.is_dir() && is_allowed(&path, folder)) {
        return Err(LoadError::unusable(format!(
            "profile `{}` names the rule set `{}`, which is a folder",
            profile.name, profile.rules
        ))
        .help("name a file in it"));
    }
    let beside = rule_sets_in(folder).into_iter().map(|file| {
        let text = folder.and_then(|folder| read(&folder.join(&file)).ok());
        (file, text.map(Source::new))
    });
    let beside: Vec<(String, Option<Source>)> = beside
        .filter(|(_, source)| !source.as_ref().is_some_and(is_profile))
        .collect();
    let names = shipped::RULE_SETS.iter().map(|known| known.name);
    let names = names.chain(beside.iter().map(|(file, _)| file.as_str()));
    let is_named = |(file, source): &&(String, Option<Source>)| {
        let document = source.as_ref().and_then(|source| source.document().ok());
        Path::new(file).file_stem() == Some(OsStr::new(&profile.rules))
            || document.is_some_and(|document| document.model.name == profile.rules)
    };
    let meant = beside.iter().find(is_named).map(|(file, _)| file.as_str());
    let help = match meant.or_else(|| nearest(&profile.rules, names)) {
        Some(near) => format!("did you mean `{near}`?"),
        None => format!(
            "built in are {}; paths are relative to the folder of the profile",
            built_in()
        ),
    };
    Err(LoadError::unusable(format!(
        "profile `{}` names the rule set `{}`, which is neither a file next to it nor built in",
        profile.name, profile.rules
    ))
    .help(help))
}

/// The YAML files in the folder of a profile, by name.
fn rule_sets_in(folder: Option<&Path>) -> Vec<String> {
    let folder = folder.map(|folder| match folder.as_os_str().is_empty() {
        true => Path::new("."),
        false => folder,
    });
    let files = folder.and_then(|folder| folder.read_dir().ok());
    let names = files.into_iter().flatten().flatten();
    let names = names.filter_map(|file| file.file_name().into_string().ok());
    let mut names: Vec<String> = names
        .filter(|name| Path::new(name).extension() == Some(OsStr::new("yaml")))
        .collect();
    names.sort();
    names
}

/// The names of the built-in rule sets.
fn built_in() -> String {
    let names = shipped::RULE_SETS
        .iter()
        .map(|known| format!("`{}`", known.name));
    names.collect::<Vec<_>>().join(", ")
}

/// Whether a line of a text begins with a key that only rule sets and profiles have. Other files are never quoted in
/// messages: a profile from somebody else may name a file that contains secrets.
#[doc(hidden)] // For the programs of this repository.
pub fn is_meant_as_rules(text: &str) -> bool {
    has_key(text, &["flagred"]) || has_key(text, &KEYS_OF_RULES)
}

/// Whether a text is meant to be a profile: whether it has the key `flagred` or the settings of a profile, or names its
/// rules, and does not have the outputs of a rule set. A text that is not valid YAML yet is searched for the key.
#[doc(hidden)] // For the programs of this repository.
pub fn is_profile(source: &Source) -> bool {
    let tree = source.tree();
    let Some(tree) = tree
        .ok()
        .filter(|tree| matches!(tree.value, Value::Mapping(_)))
    else {
        return source
            .text()
            .lines()
            .any(|line| line.starts_with("flagred:"));
    };
    let has = |name: &str| tree.child(name).is_some();
    let settings = [
        "verdict",
        "elevated_risk",
        "window_s",
        "min_samples",
        "other_risks",
    ];
    let is_rules = has("outputs") || has("blocks");
    let rules = tree.child("rules").and_then(Node::as_text);
    let names_rules =
        rules.is_some_and(|rules| !rules.is_empty() && !rules.contains(char::is_whitespace));
    let names_rules = names_rules && !has("fuzzy");
    !is_rules && (has("flagred") || names_rules || settings.iter().any(|key| has(key)))
}

/// Whether a file, with all links resolved, is in the folder of its profile or in the folder that the caller allows.
fn is_allowed(path: &Path, folder: Option<&Path>) -> bool {
    let Ok(path) = path.canonicalize() else {
        return false;
    };
    // The folder of the path `profile.yaml` is empty.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_texts_with_a_key_of_a_rule_set_or_a_profile_are_quoted() {
        for text in ["flagred: 1\nnaem: x", "- \"rules\" : y", "{fuzzy: 1"] {
            assert!(is_meant_as_rules(text), "{text}");
        }
        for text in ["password: x", "# flagred: 1", "rulesets: 1"] {
            assert!(!is_meant_as_rules(text), "{text}");
        }
    }
}
