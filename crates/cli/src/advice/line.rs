//! Advice for an option or a word that a command does not accept.

use std::path::Path;

use clap::{Arg, Command};

use super::words::{DIRECTIONS, FILES, OPTIONS, PICTURES, RENAMED, WRITTEN};
use crate::path::{RULES, has_ending};

/// A command and the words after it.
pub(super) struct Line<'a> {
    pub(super) command: &'a Command,
    pub(super) words: &'a [String],
}

impl<'a> Line<'a> {
    /// Splits the words of a command line after the program; `None` if they do not begin with a command.
    pub(super) fn of(words: &'a [String], program: &'a Command) -> Option<Self> {
        let (command, words) = words.split_first()?;
        let command = program.find_subcommand(command)?;
        Some(Line { command, words })
    }

    /// Advice for an option that the command does not have.
    pub(super) fn option(&self, option: &str, program: &Command) -> Option<String> {
        let name = self.command.get_name();
        let value = value_of(self.words, option);
        // clap reads `-profile` as `-p`.
        let single_dash = self.words.iter().filter_map(|word| word.strip_prefix('-'));
        let mut single_dash = single_dash.filter(|word| format!("-{word}").starts_with(option));
        if let Some(long) = single_dash.find(|word| self.has(&format!("--{word}"))) {
            return Some(format!("write `--{long}`"));
        }
        let mut special = OPTIONS.iter();
        if let Some((.., advice)) = special
            .find(|(commands, others, _)| has_word(commands, name) && has_word(others, option))
        {
            return Some(advice.replace("VALUE", value.unwrap_or("COLUMN")));
        }
        // For example `--monotone temperature:increasing`.
        if let Some((input, direction)) = value.and_then(|value| value.rsplit_once(':'))
            && self.has("--rising")
            && let Some(here) = DIRECTIONS
                .iter()
                .find(|(words, _)| has_word(words, direction))
        {
            return Some(format!("write `{} {}`", here.1, in_shell(input)));
        }
        // The name of an option may have been given as a value, as in `--format fis` instead of `--fis`.
        let is_choice = [
            "--format",
            "--language",
            "--lang",
            "--to",
            "--type",
            "-t",
            "-f",
        ]
        .contains(&option);
        if let Some(value) = value.filter(|value| is_choice && self.has(&format!("--{value}"))) {
            return Some(format!("write `--{value}`"));
        }
        // An existing file is probably an input, so the advice must not name an option that would replace it.
        let new_file = value.filter(|value| !Path::new(value).exists());
        let mut renamed = RENAMED.iter().filter(|(others, here)| {
            has_word(others, option)
                && self.has(here)
                && (value == new_file || !WRITTEN.contains(here))
        });
        if let Some((_, here)) = renamed.next() {
            let takes_value = self.arg(here).is_some_and(takes_value);
            return match (takes_value, value) {
                (true, Some(value)) => {
                    let ending = Path::new(value).extension();
                    let format = here.trim_start_matches('-');
                    let value = match ending.filter(|_| PICTURES.contains(here)) {
                        Some(ending) if !ending.eq_ignore_ascii_case(format) => Path::new(value)
                            .with_extension(format)
                            .display()
                            .to_string(),
                        _ => value.to_owned(),
                    };
                    Some(format!("write `{here} {}`", in_shell(&value)))
                }
                (true, None) => None,
                (false, _) => Some(format!("write `{here}`")),
            };
        }
        let is_output = |word: &str| {
            RENAMED.iter().any(|(others, here)| {
                *here == "--output" && (word == "-o" || word == *here || has_word(others, word))
            })
        };
        if let Some(file) = new_file.filter(|_| is_output(option)) {
            return Some(self.output(file));
        }
        if name == "explain" {
            let pairs = self.words.windows(2).filter_map(|pair| match pair {
                [name, value] if value.parse::<f64>().is_ok() => {
                    Some(format!("{}={value}", name.strip_prefix("--")?))
                }
                _ => None,
            });
            let pairs: Vec<String> = pairs.collect();
            if !pairs.is_empty() {
                return Some(format!("write `{}`", pairs.join(" ")));
            }
        }
        let has_file = self.command.get_positionals().next().is_some();
        if let Some(value) = value.filter(|_| has_file && FILES.contains(&option)) {
            return Some(format!(
                "name the file without an option: `{}`",
                in_shell(value)
            ));
        }
        let others = program
            .get_subcommands()
            .filter(|other| !other.is_hide_set());
        let others = others.filter(|other| argument_of(other, option).is_some());
        let others: Vec<String> = others
            .map(|other| format!("`{}`", other.get_name()))
            .collect();
        (!others.is_empty() && option.starts_with("--"))
            .then(|| format!("`{option}` is an option of {}", others.join(", ")))
    }

    /// Explains how a command without `--output` writes a file.
    fn output(&self, file: &str) -> String {
        let ending = Path::new(file).extension().unwrap_or_default();
        let option = format!("--{}", ending.to_string_lossy().to_ascii_lowercase());
        let file = in_shell(file);
        match self.arg(&option).map(takes_value) {
            Some(true) => format!("write `{option} {file}`"),
            Some(false) => format!("`{option} > {file}` writes standard output to the file"),
            None => format!("`> {file}` writes standard output to the file"),
        }
    }

    /// Advice for a word that is not an option, and that the command does not accept as a further argument.
    pub(super) fn argument(&self, word: &str) -> Option<String> {
        let name = self.command.get_name();
        let positionals = self.positionals();
        let first = positionals.first().copied()?;
        let (shown, path) = (in_shell(word), Path::new(word));
        if word.contains('=') {
            return match name {
                "eval" | "plot" => {
                    let values: Vec<&str> = self
                        .words
                        .iter()
                        .map(String::as_str)
                        .filter(|it| it.contains('='))
                        .collect();
                    Some(format!(
                        "`flagred explain {first} {}` evaluates one point",
                        values.join(" ")
                    ))
                }
                "map" => Some(format!("to fix an input, write `--hold {shown}`")),
                _ => None,
            };
        }
        let at = self.words.iter().position(|other| other == word)?;
        let before = at.checked_sub(2).and_then(|at| self.words.get(at..at + 2));
        if let Some([option, value]) = before
            && self
                .arg(option)
                .is_some_and(|arg| arg.get_value_delimiter().is_some())
        {
            return Some(format!(
                "separate the values by commas: `{option} {value},{shown}`"
            ));
        }
        // `INPUT=VALUE` may have been given as two words, as in `--hold temperature 5`.
        if let Some([option, value]) = before
            && self.arg(option).is_some_and(|arg| {
                let names = arg.get_value_names().unwrap_or_default();
                names.iter().any(|name| name.contains('='))
            })
        {
            return Some(format!("write `{option} {value}={shown}`"));
        }
        let mut dashless = positionals.iter().filter(|word| {
            let option = self.arg(&format!("--{word}"));
            option.is_some_and(|option| !takes_value(option)) && !Path::new(word).exists()
        });
        if let Some(option) = dashless.next() {
            return Some(format!("an option begins with dashes: write `--{option}`"));
        }
        let language = self.words.iter().find(|other| {
            let ending = other.strip_prefix("--").unwrap_or_default();
            let first = Path::new(first);
            name == "export" && has_ending(first, &[ending]) && !first.exists()
        });
        if let Some(language) = language {
            return Some(format!(
                "`{language}` takes no file name; write `{language} {shown} --output {first}`"
            ));
        }
        match name {
            "new" => {
                return Some(format!(
                    "a name has no spaces; write `{}`",
                    positionals.join("-")
                ));
            }
            "lsp" => {
                return Some(format!(
                    "an editor starts `lsp` and names the files; `flagred check {shown}` lists errors"
                ));
            }
            "plot" if !path.exists() => {
                return Some(format!("`plot` draws all variables: leave `{shown}` out"));
            }
            _ => {}
        }
        if name == "map" && word.parse::<f64>().is_ok() {
            return Some("for a part of an axis write `--x INPUT:LOW..HIGH`".to_owned());
        }
        if name == "map" && path.extension().is_none() {
            let axes = positionals.iter().skip(1).zip(["--x", "--y"]);
            let axes: Vec<String> = axes
                .map(|(input, option)| format!("{option} {}", in_shell(input)))
                .collect();
            return Some(format!("to choose the axes, write `{}`", axes.join(" ")));
        }
        let has_output = self
            .words
            .iter()
            .any(|it| it == "-o" || it.starts_with("--output"));
        if self.has("--output") && !has_output && !path.exists() && path.extension().is_some() {
            return Some(format!("write `--output {shown}`"));
        }
        Some(match path.exists() {
            true => format!("`{name}` takes one file at a time"),
            false => format!("leave `{shown}` out"),
        })
    }

    /// The words that are neither options nor values of options.
    pub(super) fn positionals(&self) -> Vec<&str> {
        let mut found = Vec::new();
        let mut words = self.words.iter();
        while let Some(word) = words.next() {
            if !word.starts_with('-') {
                found.push(word.as_str());
            } else if !word.contains('=') && self.arg(word).is_some_and(takes_value) {
                words.next();
            }
        }
        found
    }

    /// Advice for an option that took the missing file as its value, as in `--rising fan.yaml` and `--profile 7.BIN`.
    pub(super) fn taken_file(&self) -> Option<String> {
        let pair = self.words.windows(2).find(|pair| match pair {
            [option, value] => {
                let takes = self.arg(option).is_some_and(takes_value);
                let is_rules = has_ending(Path::new(value), RULES);
                let is_misplaced = match option.as_str() {
                    "--profile" => !is_rules,
                    _ => is_rules,
                };
                takes && is_misplaced && Path::new(value).exists()
            }
            _ => false,
        });
        let [option, file] = pair? else { return None };
        let argument = self.arg(option)?;
        let name = argument.get_value_names()?.first()?;
        let (command, file) = (self.command.get_name(), in_shell(file));
        let takes_files = name.contains("FILE") || name.contains("PATH");
        (option == "--profile" || !takes_files).then(|| {
            format!(
                "`{option}` took `{file}` as its value: write `flagred {command} {file} {option} {name}`"
            )
        })
    }

    pub(super) fn has(&self, option: &str) -> bool {
        self.arg(option).is_some()
    }

    pub(super) fn arg(&self, option: &str) -> Option<&Arg> {
        argument_of(self.command, option)
    }
}

/// The argument for an option such as `--output` or `-o`.
fn argument_of<'a>(command: &'a Command, option: &str) -> Option<&'a Arg> {
    command.get_arguments().find(|arg| {
        let long = arg.get_long().map(|long| format!("--{long}"));
        let short = arg.get_short().map(|short| format!("-{short}"));
        [long, short].iter().flatten().any(|name| name == option)
    })
}

pub(super) fn takes_value(arg: &Arg) -> bool {
    arg.get_action().takes_values()
}

/// The value of an option: after `=`, or the next word.
pub(super) fn value_of<'a>(words: &'a [String], option: &str) -> Option<&'a str> {
    let joined = words
        .iter()
        .find_map(|word| word.strip_prefix(option)?.strip_prefix('='));
    let next = words
        .windows(2)
        .find(|pair| matches!(pair, [word, _] if word == option));
    let next = next
        .and_then(|pair| pair.last())
        .filter(|word| !word.starts_with('-'));
    joined.or(next.map(String::as_str))
}

pub(super) fn has_word(words: &str, word: &str) -> bool {
    words.split(' ').any(|other| other == word)
}

/// Quotes a word for the shell if necessary.
pub(crate) fn in_shell(word: &str) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "._-/=:+@%,".contains(c);
    match word.chars().all(is_plain) && !word.is_empty() {
        true => word.to_owned(),
        false => format!("'{word}'"),
    }
}
