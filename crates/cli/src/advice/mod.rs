//! Advice for command lines that clap rejects: words of other programs, and options and files in the wrong place.

mod line;
mod words;

use std::{ffi::OsString, path::Path};

use clap::{
    Command,
    error::{ContextKind, ContextValue, ErrorKind},
};
use fuzzy::diagnostic::nearest;

pub(crate) use self::line::in_shell;
use self::{
    line::{Line, has_word, takes_value, value_of},
    words::{COMMANDS, VALUES},
};
use crate::{
    failure::Failure,
    path::{RULES, has_ending},
};

/// Adds advice to an error from clap, if there is advice for it. The advice replaces clap's suggestions of similar
/// names.
pub(crate) fn improve(error: &mut clap::Error, program: &Command, words: &[OsString]) {
    let words: Vec<String> = words
        .iter()
        .skip(1)
        .map(|word| word.to_string_lossy().into_owned())
        .collect();
    let advice = match error.kind() {
        ErrorKind::MissingRequiredArgument => required(error, program, &words),
        _ => advice(error, program, &words).into_iter().collect(),
    };
    if advice.is_empty() {
        return;
    }
    for similar in [
        // The usage that clap shows may contain any option that would fit, which distracts from the advice.
        ContextKind::Usage,
        ContextKind::SuggestedArg,
        ContextKind::SuggestedSubcommand,
        ContextKind::SuggestedValue,
    ] {
        error.remove(similar);
    }
    let advice = advice.into_iter().map(Into::into).collect();
    error.insert(ContextKind::Suggested, ContextValue::StyledStrs(advice));
}

/// Recognises a file name after an option that prints to standard output and takes no file, as in `--csv out.csv`.
pub(crate) fn file_behind_switch(program: &Command, words: &[OsString]) -> Option<Failure> {
    let words = words.iter().skip(1).map(|word| word.to_str());
    let words: Vec<String> = words
        .map(|word| Some(word?.to_owned()))
        .collect::<Option<_>>()?;
    let line = Line::of(&words, program)?;
    let name = line.command.get_name();
    let pairs = line.words.iter().zip(line.words.iter().skip(1));
    let (switch, file) = pairs.into_iter().find(|(switch, file)| {
        let option = switch.strip_prefix("--").unwrap_or_default();
        line.arg(switch).is_some_and(|arg| !takes_value(arg))
            && has_ending(Path::new(file), &[option])
            && !Path::new(file).exists()
    })?;
    let others = line.words.iter().filter(|word| *word != file);
    let others: Vec<String> = others.map(|word| in_shell(word)).collect();
    if line.positionals().len() < 2 {
        return None;
    }
    let to = match line.has("--output") {
        true => "--output",
        false => ">",
    };
    let failure = Failure::usage(format!(
        "`{file}` does not exist, and `{switch}` takes no file name"
    ));
    Some(failure.help(format!(
        "`flagred {name} {} {to} {}` writes this file",
        others.join(" "),
        in_shell(file)
    )))
}

/// Recognises a command line that belongs to another command.
pub(crate) fn other_command(error: &clap::Error, words: &[OsString]) -> Option<Failure> {
    let words: Vec<&str> = words.iter().filter_map(|word| word.to_str()).collect();
    let is_rules = |word: &str| has_ending(Path::new(word), RULES);
    match (error.kind(), words.as_slice()) {
        (ErrorKind::ValueValidation, [_, "convert", rest @ ..]) => {
            let rules = rest.iter().find(|word| is_rules(word))?;
            let output = rest.iter().find(|word| is_rules(word) && *word != rules)?;
            let failure = Failure::usage(format!(
                "`{rules}` is a rule set; `convert` converts flight logs"
            ));
            Some(failure.help(format!("flagred import {rules} --output {output}")))
        }
        _ => None,
    }
}

fn advice(error: &clap::Error, program: &Command, words: &[String]) -> Option<String> {
    let wrong = |kind| match error.get(kind) {
        Some(ContextValue::String(word)) => Some(word.as_str()),
        _ => None,
    };
    match error.kind() {
        ErrorKind::InvalidSubcommand => {
            let word = wrong(ContextKind::InvalidSubcommand)?;
            let known = COMMANDS.iter().find(|(others, _)| has_word(others, word));
            let names: Vec<&str> = program.get_subcommands().map(Command::get_name).collect();
            let near = || nearest(word, names).map(|name| format!("did you mean `{name}`?"));
            known.map(|(_, advice)| (*advice).to_owned()).or_else(near)
        }
        ErrorKind::InvalidValue => {
            let word = wrong(ContextKind::InvalidValue)?;
            let Some(ContextValue::Strings(possible)) = error.get(ContextKind::ValidValue) else {
                return None;
            };
            let is_file = Path::new(word).exists();
            match words.first().map(String::as_str) {
                Some("show") if is_file => {
                    return Some(
                        "`show` prints built-in profiles and rule sets; open a file in an editor"
                            .to_owned(),
                    );
                }
                Some("schema") if is_file => {
                    return Some(format!(
                        "`schema` describes formats; `flagred check {word}` checks a file"
                    ));
                }
                _ => {}
            }
            let word = word.to_ascii_lowercase();
            let means = |here: &&String| {
                ***here == word
                    || VALUES
                        .iter()
                        .any(|(others, it)| it == here && has_word(others, &word))
            };
            possible
                .iter()
                .find(means)
                .map(|here| format!("write `{here}`"))
        }
        ErrorKind::UnknownArgument => {
            let word = wrong(ContextKind::InvalidArg)?;
            let Some(line) = Line::of(words, program) else {
                if error.get(ContextKind::SuggestedArg).is_some() {
                    return None;
                }
                return Some(
                    "options are written after the command; `flagred --version` prints the version"
                        .to_owned(),
                );
            };
            match word.starts_with('-') {
                true => line.option(word, program),
                false => line.argument(word),
            }
        }
        ErrorKind::WrongNumberOfValues => {
            // Two values may have been given as one word, as in `--range 1000-2000`.
            let option = wrong(ContextKind::InvalidArg)?.split(' ').next()?;
            let value = value_of(words, option)?;
            let parts = value.split(|c: char| !c.is_ascii_digit());
            let parts: Vec<&str> = parts.filter(|part| !part.is_empty()).collect();
            (parts.len() == 2).then(|| format!("write `{option} {}`", parts.join(" ")))
        }
        _ => None,
    }
}

/// Explains each missing argument with its help text.
fn required(error: &clap::Error, program: &Command, words: &[String]) -> Vec<String> {
    let (Some(line), Some(ContextValue::Strings(missing))) =
        (Line::of(words, program), error.get(ContextKind::InvalidArg))
    else {
        return Vec::new();
    };
    let positionals = line.positionals();
    let missing = missing.iter().filter_map(|shown| {
        if shown.contains('|') {
            return Some("choose one of these options".to_owned());
        }
        let argument = line
            .command
            .get_arguments()
            .find(|argument| argument.to_string() == *shown)?;
        let values = argument.get_possible_values();
        if !values.is_empty() {
            let values: Vec<&str> = values.iter().map(|value| value.get_name()).collect();
            return Some(format!("write one of {}", values.join(", ")));
        }
        if argument.is_positional()
            && let Some(advice) = line.taken_file()
        {
            return Some(advice);
        }
        let name = argument.get_value_names()?.first()?;
        let ending = name.rsplit_once('.').map_or("", |(_, ending)| ending);
        let mut others = positionals
            .iter()
            .skip(1)
            .filter(|word| !Path::new(word).exists());
        let output = others.find(|word| has_ending(Path::new(word), &[ending]));
        Some(match output.filter(|_| argument.get_id() == "output") {
            Some(file) => format!("write `--output {}`", in_shell(file)),
            None => format!("`{shown}`: {}", argument.get_help()?),
        })
    });
    missing.collect()
}
