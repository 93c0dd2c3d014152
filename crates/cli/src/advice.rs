//! Advice for command lines that clap rejects: words of other programs, and options and files in the wrong place.

use std::{ffi::OsString, path::Path};

use clap::{
    Arg, Command, CommandFactory as _,
    error::{ContextKind, ContextValue, ErrorKind},
};
use fuzzy::diagnostic::nearest;

use crate::{
    failure::Failure,
    output::{RULES, has_ending},
};

/// Names of commands in other programs, and the commands here.
const COMMANDS: &[(&str, &str)] = &[
    (
        "analyze analyse analysis evaluate-flight risk",
        "`flagred assess` assesses a flight",
    ),
    (
        "train fit",
        "`flagred learn` learns rules from a table, `flagred tune` moves the numbers of a rule set",
    ),
    (
        "optimize optimise calibrate",
        "`flagred tune` moves the numbers of a rule set to fit a table",
    ),
    (
        "format prettify",
        "`flagred fmt` formats rule sets and profiles",
    ),
    (
        "run predict infer inference compute calc simulate",
        "`flagred explain` evaluates a rule set at one point, `flagred eval` at the points of a table",
    ),
    (
        "lint test verify",
        "`flagred check` lists the errors of rule sets and profiles",
    ),
    (
        "report",
        "`flagred assess FLIGHT --html report.html` writes a report",
    ),
    (
        "compare",
        "`flagred assess FLIGHTS --html all.html` compares flights, `flagred validate` compares profiles",
    ),
    (
        "score benchmark",
        "`flagred validate` measures how good the risks of profiles are",
    ),
    ("fleet", "`python -m flagred.fleet` (docs/fleet.md)"),
    (
        "init create generate-rules start",
        "`flagred new NAME` writes a rule set to start from",
    ),
    (
        "edit gui ui serve web open view",
        "`flagred studio` opens the page in the browser",
    ),
    (
        "draw graph chart",
        "`flagred plot` draws the terms of a rule set, `flagred map` its output",
    ),
    (
        "info dump stat",
        "`flagred inspect` shows the contents of a log",
    ),
    (
        "list ls profiles cat print",
        "`flagred show NAME` prints a built-in profile or rule set; `flagred show --help` lists them",
    ),
    (
        "live monitor connect",
        "`flagred watch` assesses a flight live",
    ),
    (
        "cluster discover",
        "`flagred identify` finds inputs, terms and rules for a column of a table",
    ),
    (
        "reduce prune minify shrink",
        "`flagred simplify` writes a rule set with fewer rules",
    ),
    (
        "generate codegen compile build",
        "`flagred export` writes a profile or a rule set as code",
    ),
    (
        "csv",
        "`flagred convert LOG --output flight.csv` writes a flight CSV",
    ),
    (
        "evalute evaluation",
        "`flagred eval` evaluates a rule set, `flagred validate` profiles",
    ),
];

/// Options of other programs, and the same option here. An entry counts for the commands that have this option.
const RENAMED: &[(&str, &str)] = &[
    (
        "--sep --separator --delim --field-separator -d -s -F",
        "--delimiter",
    ),
    (
        "--out --outfile --out-file --output-file --save --save-to --write",
        "--output",
    ),
    (
        "--picture --image --img --figure --png --pdf --plot --graph --save-plot",
        "--svg",
    ),
    ("--report --html-report", "--html"),
    ("--overwrite --yes --replace -f -y", "--force"),
    ("--resolution --grid --samples --n -n", "--points"),
    ("--set --at --with-value", "--hold"),
    (
        "--skip --lenient --ignore-errors --skip-errors --skip-invalid",
        "--skip-bad-rows",
    ),
    ("--cv --k-fold --kfold --cross-validation", "--folds"),
    ("--label --response --output-column --y -y", "--target"),
    ("--inputs --features --feature", "--input"),
    ("--exclude --drop", "--ignore"),
    (
        "--epochs --max-iter --max-iterations --steps",
        "--iterations",
    ),
    ("--restarts", "--starts"),
    ("--freeze --fixed --lock", "--fix"),
    ("--rename --map-column", "--column"),
    ("--monotone --increasing", "--rising"),
    ("--decreasing", "--falling"),
    ("--random-state --random-seed", "--seed"),
    ("--min-rows --min-samples", "--min-support"),
    ("--pwm --pwm-range --min-max", "--range"),
    ("--config --settings --preset -p", "--profile"),
    ("--dt --interval --rate", "--step"),
    ("-c", "--csv"),
    ("-j", "--json"),
];

/// Options that name the file that is an argument without an option.
const FILES: &[&str] = &[
    "--file",
    "--files",
    "--log",
    "--logs",
    "--flight",
    "--flights",
    "--rules",
    "--model",
    "--ruleset",
    "--data",
    "--dataset",
    "--table",
    "--rows",
    "--points",
    "--in",
    "--input",
    "--input-file",
    "-i",
];

/// Options of single commands. `VALUE` in the advice is the value that follows the option.
const OPTIONS: &[(&str, &str, &str)] = &[
    (
        "learn tune",
        "--target --label --output-column",
        "the target is the output of the rule set; if its column has another name, write `--column OUTPUT=VALUE`",
    ),
    (
        "import",
        "--format --from --type --fis --fll --fcl --fml",
        "the format is recognised by the content: leave the option out",
    ),
    (
        "plot",
        "--csv --values --points",
        "`flagred map RULES --csv` prints a table of values",
    ),
    (
        "fmt",
        "--output --out -o --stdout",
        "`fmt` formats files in place; to keep the original, write `flagred fmt - < IN.yaml > OUT.yaml`",
    ),
    (
        "check",
        "--strict --werror --pedantic -W",
        "write `--deny warnings`",
    ),
    (
        "assess watch validate inspect",
        "--rules --ruleset --model",
        "a profile names the rule set: `flagred new NAME --profile flagred` writes a profile; assess by `--profile NAME.yaml`",
    ),
    (
        "identify",
        "--rules --model",
        "`identify` makes a new rule set; `flagred learn` and `flagred tune` start from one",
    ),
];

/// Adds advice to an error of clap, in place of options and commands whose names are merely similar.
pub(crate) fn improve(error: &mut clap::Error, program: &Command, words: &[OsString]) {
    let words: Vec<String> = words
        .iter()
        .skip(1)
        .map(|word| word.to_string_lossy().into_owned())
        .collect();
    if let Some(advice) = advice(error, program, &words) {
        for similar in [ContextKind::SuggestedArg, ContextKind::SuggestedSubcommand] {
            error.remove(similar);
        }
        let advice = ContextValue::StyledStrs(vec![advice.into()]);
        error.insert(ContextKind::Suggested, advice);
    }
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

/// Advice for a file that does not exist.
pub(crate) fn missing(shown: &str) -> String {
    let path = Path::new(shown);
    if shown.starts_with("http") {
        return "download the file first, and name it".to_owned();
    }
    if shown.contains('*') {
        return "no file matches this pattern".to_owned();
    }
    if let Some((option, value)) = shown.split_once('=')
        && is_option(option)
    {
        return format!("an option begins with dashes: `--{option} {value}`");
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
        .find(|other| Path::new(other).file_stem() == Some(name.as_ref().as_ref()));
    let near = || nearest(&name, names.iter().map(String::as_str));
    match same_stem.map(String::as_str).or_else(near) {
        Some(near) => format!("did you mean `{}`?", folder.join(near).display()),
        None => "check the path".to_owned(),
    }
}

/// Whether a command has an option of this name.
fn is_option(name: &str) -> bool {
    let program = crate::Arguments::command();
    let mut arguments = program.get_subcommands().flat_map(Command::get_arguments);
    arguments.any(|argument| argument.get_long() == Some(name))
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
            known.map(|(_, advice)| (*advice).to_owned())
        }
        ErrorKind::UnknownArgument => {
            let word = wrong(ContextKind::InvalidArg)?;
            let Some(command) = words.first().and_then(|word| program.find_subcommand(word)) else {
                return Some(
                    "options are written after the command; `flagred --version` prints the version"
                        .to_owned(),
                );
            };
            let line = Line {
                command,
                words: words.get(1..).unwrap_or_default(),
            };
            match word.starts_with('-') {
                true => line.option(word),
                false => line.argument(word),
            }
        }
        ErrorKind::WrongNumberOfValues => {
            // For example `--range 1000-2000`.
            let option = wrong(ContextKind::InvalidArg)?.split(' ').next()?;
            let value = value_of(words, option)?;
            let parts = value.split(|c: char| !c.is_ascii_digit());
            let parts: Vec<&str> = parts.filter(|part| !part.is_empty()).collect();
            (parts.len() == 2).then(|| format!("write `{option} {}`", parts.join(" ")))
        }
        _ => None,
    }
}

/// A command and the words after it.
struct Line<'a> {
    command: &'a Command,
    words: &'a [String],
}

impl Line<'_> {
    /// Advice for an option that the command does not have.
    fn option(&self, option: &str) -> Option<String> {
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
        // For example `--format fis` for `--fis`.
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
        let mut renamed = RENAMED.iter();
        if let Some((_, here)) =
            renamed.find(|(others, here)| has_word(others, option) && self.has(here))
        {
            let takes_value = self.arg(here).is_some_and(takes_value);
            return Some(match value.filter(|_| takes_value) {
                Some(value) => format!("write `{here} {}`", in_shell(value)),
                None => format!("write `{here}`"),
            });
        }
        if option == "-o"
            || RENAMED.iter().any(|(others, here)| {
                *here == "--output" && (*here == option || has_word(others, option))
            })
        {
            return value.map(|file| self.output(file));
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
        let value = value.filter(|_| has_file && FILES.contains(&option))?;
        Some(format!(
            "name the file without an option: `{}`",
            in_shell(value)
        ))
    }

    /// How a command without `--output` writes a file.
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

    /// Advice for a word that is not an option, where the command takes no further one.
    fn argument(&self, word: &str) -> Option<String> {
        let name = self.command.get_name();
        let positionals = self.positionals();
        let first = positionals.first().copied()?;
        let shown = in_shell(word);
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
        let language = self.words.iter().find(|other| {
            let ending = other.strip_prefix("--").unwrap_or_default();
            name == "export" && has_ending(Path::new(first), &[ending])
        });
        if let Some(language) = language {
            return Some(format!(
                "`{language}` takes no file; write `{language} {shown} --output {first}`"
            ));
        }
        match name {
            "new" => {
                return Some(format!(
                    "a name has no spaces; write `{}`",
                    positionals.join("-")
                ));
            }
            "plot" if !Path::new(word).exists() => {
                return Some(format!("`plot` draws all variables: leave `{shown}` out"));
            }
            _ => {}
        }
        let has_output = self
            .words
            .iter()
            .any(|it| it == "-o" || it.starts_with("--output"));
        if self.has("--output") && !has_output && !Path::new(word).exists() {
            return Some(format!("write `--output {shown}`"));
        }
        Some(format!("`{name}` takes one file at a time"))
    }

    /// The words that are neither options nor their values.
    fn positionals(&self) -> Vec<&str> {
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

    fn has(&self, option: &str) -> bool {
        self.arg(option).is_some()
    }

    /// The argument for an option such as `--output` or `-o`.
    fn arg(&self, option: &str) -> Option<&Arg> {
        self.command.get_arguments().find(|arg| {
            let long = arg.get_long().map(|long| format!("--{long}"));
            let short = arg.get_short().map(|short| format!("-{short}"));
            [long, short].iter().flatten().any(|name| name == option)
        })
    }
}

fn takes_value(arg: &Arg) -> bool {
    arg.get_action().takes_values()
}

/// The value of an option: after `=`, or the next word.
fn value_of<'a>(words: &'a [String], option: &str) -> Option<&'a str> {
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

fn has_word(words: &str, word: &str) -> bool {
    words.split(' ').any(|other| other == word)
}

/// Quotes a word for the shell, if it needs that.
fn in_shell(word: &str) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "._-/=:+@%,".contains(c);
    match word.chars().all(is_plain) && !word.is_empty() {
        true => word.to_owned(),
        false => format!("'{word}'"),
    }
}
