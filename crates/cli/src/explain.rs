//! `flagred explain`: how the outputs of a rule set are computed at one point, or at each row of a table.

mod table;

use std::path::PathBuf;

use flagred_authoring::answers::Explained;
use fuzzy::{
    Model,
    diagnostic::suggest,
    drawing::{explanation_svg, explanation_text, short, silent_text, what_if_text},
    model::Variable,
    tree::number_advice,
};

use crate::{
    failure::{Exit, Failure},
    output::{self, Files, print},
    rule_set,
    table::{Format, Suffix, is_table},
};

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The rule set: a file in YAML, FIS, FLL, FCL or FML, the name of a built-in one, or `-` for standard input
    #[arg(value_name = "RULES")]
    model: PathBuf,
    /// A value for each input: `margin=0.07`
    #[arg(value_name = "INPUT=VALUE")]
    inputs: Vec<String>,
    /// Explain each row of this table: print it with the value, the dominant rule and the shares of the rules for each output.
    /// `--suffix`, `--column`, `--delimiter` and `--skip-bad-rows` describe this table
    #[arg(long, alias = "csv", value_name = "TABLE.csv", conflicts_with_all = ["inputs", "json", "svg"])]
    rows: Option<PathBuf>,
    /// The file to write, replaced if it exists; `-` is standard output [default: -]
    #[arg(short, long, value_name = "FILE", value_parser = output::text_path)]
    output: Option<PathBuf>,
    /// Print a JSON document instead of text
    #[arg(long)]
    json: bool,
    /// Write an SVG picture of terms, rules and results to this file instead of text; `-` is standard output
    #[arg(long, value_name = "FILE", conflicts_with_all = ["json", "output"], value_parser = output::svg_path)]
    svg: Option<PathBuf>,
    #[command(flatten)]
    suffix: Suffix,
    #[command(flatten)]
    format: Format,
}

/// Parses a value of an input, as `INPUT=VALUE`.
fn assignment(model: &Model, given: &[String], text: &str) -> Result<(String, f64), Failure> {
    let Some((name, value)) = text.split_once('=') else {
        if std::path::Path::new(text).is_file() {
            let failure = Failure::usage(format!("`{text}` is a file, not the value of an input"));
            return Err(failure.help(format!(
                "to explain each row of a table, use `--rows {text}`"
            )));
        }
        // The advice uses the numbers that follow the names, as in `fan = 5`. Without names, it uses the numbers in the
        // order of the inputs.
        let words = given
            .iter()
            .flat_map(|word| word.split(['=', ':']))
            .filter(|word| !word.is_empty());
        let words: Vec<&str> = words.collect();
        let number = |word: &&&str| word.parse::<f64>().is_ok();
        let is_named = model
            .inputs
            .iter()
            .any(|input| words.contains(&input.name.as_str()));
        let pairs = model.inputs.iter().enumerate().map(|(i, input)| {
            let at = words.iter().position(|word| *word == input.name);
            let named = at.and_then(|at| words.get(at + 1)).filter(number);
            let value = match is_named {
                true => named,
                false => words.iter().filter(number).nth(i),
            };
            format!("{}={}", input.name, value.unwrap_or(&"VALUE"))
        });
        let help = format!("write `{}`", pairs.collect::<Vec<_>>().join(" "));
        let problem = match words.contains(&text) && is_named {
            true if text.parse::<f64>().is_err() => "has no value",
            _ => "does not name an input",
        };
        return Err(Failure::usage(format!("`{text}` {problem}")).help(help));
    };
    let value = value.trim();
    match value.parse::<f64>() {
        Ok(number) if number.is_finite() => Ok((name.trim().into(), number)),
        _ => {
            let failure = Failure::usage(format!(
                "the value of `{name}` is not a finite number: `{value}`"
            ));
            let term = model.inputs.iter().find(|input| input.name == name.trim());
            let is_term =
                term.is_some_and(|input| input.terms.iter().any(|term| term.name == value));
            let number = value.strip_suffix([',', ';']);
            let advice = match is_term {
                true => Some(format!("`{value}` is a term; write a number")),
                false if number.is_some_and(|number| number.parse::<f64>().is_ok()) => {
                    let words = given.iter().map(|word| word.trim_matches([',', ';', ' ']));
                    let words: Vec<&str> = words.filter(|word| !word.is_empty()).collect();
                    Some(format!(
                        "write spaces between the values: `{}`",
                        words.join(" ")
                    ))
                }
                false => value_advice(value),
            };
            Err(failure.help_if(advice))
        }
    }
}

/// Advice for a value that is not a finite number.
fn value_advice(text: &str) -> Option<String> {
    if ["nan", "na", ""]
        .iter()
        .any(|unknown| text.eq_ignore_ascii_case(unknown))
    {
        return Some("an unknown value cannot be explained; write a number".into());
    }
    if text.contains('=') {
        return Some("separate the values by spaces".into());
    }
    number_advice(text)
}

pub(crate) fn run(arguments: &Arguments) -> Result<Exit, Failure> {
    let mut files = Files::reading([&arguments.model].into_iter().chain(&arguments.rows))?;
    let svg = files.optional(arguments.svg.as_ref())?;
    let output = files.optional(arguments.output.as_ref())?;
    let model = arguments.model.display().to_string();
    if model.contains('=') && !arguments.model.exists() {
        let failure = Failure::usage(format!("`{model}` is not a rule set"));
        return Err(failure.help("name the rule set first, then the values of its inputs"));
    }
    let engine = rule_set::load(&arguments.model)?;
    let model = engine.model();
    if let (None, Some(path)) = (
        &arguments.rows,
        arguments.output.as_ref().filter(|it| is_table(it)),
    ) {
        let message = format!(
            "`{}` is the name of a table, but the output is text",
            path.display()
        );
        return Err(Failure::usage(message).help("`--rows` writes tables"));
    }
    let given = arguments.format.given().or(arguments.suffix.given());
    if let (None, Some(option)) = (&arguments.rows, given) {
        let failure = Failure::usage(format!("`{option}` needs a table"));
        return Err(failure.help("name a table with `--rows`, or leave the option out"));
    }
    if let Some(points) = &arguments.rows {
        table::explain(&engine, points, arguments, output.as_ref())?;
        return Ok(Exit::Clean);
    }
    let given = arguments.inputs.iter();
    let given = given.map(|text| assignment(model, &arguments.inputs, text));
    let given: Vec<(String, f64)> = given.collect::<Result<_, _>>()?;
    let values = values(model, &given)?;
    let explanation = engine.explain(&values).map_err(Failure::usage)?;
    if let Some(svg) = svg {
        svg.write(&explanation_svg(model, &explanation))?;
        return Ok(Exit::Clean);
    }
    let silent = engine.silent(&explanation).map_err(Failure::usage)?;
    let changes = engine.what_if(&values).map_err(Failure::usage)?;
    let text = if arguments.json {
        let json = Explained::new(&model.name, &explanation).with_reasons(silent, changes);
        let text = serde_json::to_string_pretty(&json).map_err(std::io::Error::from)?;
        text + "\n"
    } else {
        let reasons = silent_text(&silent) + &what_if_text(model, &changes);
        explanation_text(model, &explanation) + &reasons
    };
    print(output.as_ref(), &text)?;
    Ok(Exit::Clean)
}

/// Returns one value for each input, in the order of the model.
fn values(model: &Model, given: &[(String, f64)]) -> Result<Vec<f64>, Failure> {
    let names = || model.inputs.iter().map(|input| input.name.as_str());
    for (i, (name, _)) in given.iter().enumerate() {
        if !names().any(|known| known == name) {
            let failure = Failure::usage(format!("the rule set has no input `{name}`"));
            return Err(failure.help_if(suggest(name, names())));
        }
        if given.iter().take(i).any(|(other, _)| other == name) {
            return Err(Failure::usage(format!("`{name}` is given twice")));
        }
    }
    let value = |input: &Variable| {
        let name = &input.name;
        let found = given.iter().find(|(known, _)| known == name);
        found.map(|(_, value)| *value).ok_or_else(|| {
            let missing = model.inputs.iter();
            let missing =
                missing.filter(|input| !given.iter().any(|(name, _)| *name == input.name));
            let middles = missing
                .map(|input| format!("{}={}", input.name, short((input.low + input.high) / 2.0)));
            let middles: Vec<String> = middles.collect();
            let whose = match middles.as_slice() {
                [_] => "the middle of its range",
                _ => "the middles of their ranges",
            };
            let help = format!("add `{}`, {whose}", middles.join(" "));
            Failure::usage(format!("input `{name}` has no value")).help(help)
        })
    };
    model.inputs.iter().map(value).collect()
}
