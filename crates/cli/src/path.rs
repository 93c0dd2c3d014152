//! Paths that the user names: their extensions, and advice for files that do not exist.

use std::path::Path;

use clap::{Command, CommandFactory as _};
use flagred::shipped::PROFILES;
use fuzzy::diagnostic::nearest;

/// Extensions of rule sets and profiles, here and in other programs.
pub(crate) const RULES: &[&str] = &["yaml", "yml", "fis", "t2fis", "fll", "fcl", "fml"];

/// Returns whether the extension of a path is one of these, in lower or upper case.
pub(crate) fn has_ending(path: &Path, extensions: &[&str]) -> bool {
    let ending = path.extension();
    ending.is_some_and(|ending| extensions.iter().any(|e| ending.eq_ignore_ascii_case(e)))
}

/// Advice for a file that does not exist.
pub(crate) fn missing(shown: &str) -> String {
    let path = Path::new(shown);
    if shown.starts_with("http") {
        return "download the file first, and name it".to_owned();
    }
    if shown.contains('*') {
        return "no file matches this pattern".to_owned();
    }
    if has_ending(path, &["html"]) {
        return format!("to write a report, write `--html {shown}`");
    }
    if let Some((option, value)) = shown.split_once('=')
        && is_option(option)
    {
        return format!("an option begins with dashes: `--{option} {value}`");
    }
    if PROFILES.iter().any(|known| known.name == shown) {
        return format!("a built-in profile is chosen by `--profile {shown}`");
    }
    let folder = path.parent().unwrap_or(Path::new(""));
    let there = match folder == Path::new("") {
        true => Path::new(".").read_dir(),
        false => folder.read_dir(),
    };
    let there = there.into_iter().flatten().flatten();
    let mut names: Vec<String> = there
        .filter_map(|file| file.file_name().into_string().ok())
        .collect();
    names.sort();
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let same_stem = names
        .iter()
        .filter(|other| Path::new(other).file_stem() == Some(name.as_ref().as_ref()))
        .min_by_key(|other| {
            RULES
                .iter()
                .position(|ending| has_ending(Path::new(other), &[ending]))
                .unwrap_or(RULES.len())
        });
    // Only the names without their extensions are compared, because equal extensions would make short names
    // look similar. A file with the same extension matches if its name is similar; a file with another
    // extension matches only if its name is equal.
    let stem = |name: &str| {
        let stem = Path::new(name).file_stem().unwrap_or_default();
        stem.to_string_lossy().to_ascii_lowercase()
    };
    let ending = path.extension().and_then(|ending| ending.to_str());
    let is_same_kind =
        |name: &&String| ending.is_none_or(|ending| has_ending(Path::new(name), &[ending]));
    let near = || {
        let same: Vec<(String, &String)> = names
            .iter()
            .filter(is_same_kind)
            .map(|name| (stem(name), name))
            .collect();
        let wanted = stem(&name);
        let nearest = nearest(&wanted, same.iter().map(|(stem, _)| stem.as_str()));
        let near = same.iter().find(|(stem, _)| Some(stem.as_str()) == nearest);
        let same_name = || names.iter().find(|other| stem(other) == wanted);
        near.map(|(_, name)| *name)
            .or_else(same_name)
            .map(String::as_str)
    };
    match same_stem.map(String::as_str).or_else(near) {
        Some(near) => format!("did you mean `{}`?", folder.join(near).display()),
        None => {
            let same = names
                .iter()
                .filter(|_| ending.is_some())
                .filter(is_same_kind);
            let same: Vec<String> = same.map(|name| format!("`{name}`")).collect();
            match same.as_slice() {
                [] => CHECK.to_owned(),
                all if all.len() > MAX_LISTED => CHECK.to_owned(),
                all => format!("{CHECK}; the folder has {}", all.join(", ")),
            }
        }
    }
}

/// The maximum number of files that are listed if none has a similar name.
const MAX_LISTED: usize = 5;
/// Advice for a file that does not exist and resembles no other.
pub(crate) const CHECK: &str = "check the path";

/// Whether a command has an option of this name.
fn is_option(name: &str) -> bool {
    let program = crate::Arguments::command();
    let mut arguments = program.get_subcommands().flat_map(Command::get_arguments);
    arguments.any(|argument| argument.get_long() == Some(name))
}
