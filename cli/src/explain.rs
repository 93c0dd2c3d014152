//! `flagred explain`: why an output is what it is.

use std::{fmt::Write as _, io::Write as _, path::PathBuf};

use fuzzy::{
    Model,
    diagnostic::suggest,
    engine::{Degree, ExplainedInput, ExplainedOutput, Explanation},
};
use serde::Serialize;

use crate::{
    failure::{Exit, Failure},
    rule_set,
};

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The rule set in YAML; `-` is standard input
    #[arg(value_name = "MODEL")]
    model: PathBuf,
    /// The value of each input: margin=0.07
    #[arg(required = true, value_name = "INPUT=VALUE", value_parser = assignment)]
    inputs: Vec<(String, f64)>,
    /// Print a JSON document instead of text
    #[arg(long)]
    json: bool,
}

fn assignment(text: &str) -> Result<(String, f64), String> {
    let (name, value) = text.split_once('=').ok_or("write NAME=VALUE")?;
    match value.trim().parse::<f64>() {
        Ok(number) if number.is_finite() => Ok((name.trim().into(), number)),
        _ => Err(format!("`{value}` is no finite number")),
    }
}

/// The document of `--json`.
#[derive(Serialize)]
struct Json<'a> {
    schema: &'static str,
    model: &'a str,
    #[serde(flatten)]
    explanation: &'a Explanation,
}

pub(crate) fn run(arguments: &Arguments) -> Result<Exit, Failure> {
    let (model, engine) = rule_set::load(&arguments.model)?;
    let values = values(&model, &arguments.inputs)?;
    let explanation = engine.explain(&values).map_err(Failure::usage)?;
    let mut out = anstream::stdout().lock();
    if arguments.json {
        let json = Json {
            schema: "flagred.explain/1",
            model: &model.name,
            explanation: &explanation,
        };
        serde_json::to_writer_pretty(&mut out, &json).map_err(std::io::Error::from)?;
        writeln!(out)?;
    } else {
        write!(out, "{}", text(&model, &explanation))?;
    }
    Ok(Exit::Clean)
}

/// One value for each input, in the order of the model.
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
    let value = |name: &str| {
        let found = given.iter().find(|(known, _)| known == name);
        found.map(|(_, value)| *value).ok_or_else(|| {
            Failure::usage(format!("the input `{name}` has no value"))
                .help(format!("add `{name}=0.5`"))
        })
    };
    names().map(value).collect()
}

/// The explanation for people.
fn text(model: &Model, explanation: &Explanation) -> String {
    let mut text = format!("{}\n", model.name);
    for input in &explanation.inputs {
        input_text(&mut text, model, input);
    }
    for output in &explanation.outputs {
        output_text(&mut text, model, output, explanation);
    }
    text
}

// Writing to a String cannot fail; `writeln!` says so with a Result that there is nothing to do about.
fn input_text(text: &mut String, model: &Model, input: &ExplainedInput) {
    let variable = model
        .inputs
        .iter()
        .find(|variable| variable.name == input.name);
    let unit = unit(variable.and_then(|v| v.unit.as_deref()));
    let _ = write!(text, "\n{} = {}{unit}", input.name, short(input.given));
    if input.given != input.value {
        let _ = write!(text, ", outside the range: taken as {}", short(input.value));
    }
    text.push('\n');
    memberships(text, &input.terms);
}

fn memberships(text: &mut String, terms: &[Degree]) {
    const BAR: f64 = 20.0;
    let width = terms
        .iter()
        .map(|t| t.term.chars().count())
        .max()
        .unwrap_or(0);
    for Degree { term, degree, .. } in terms {
        let bar = "█".repeat((degree * BAR).round() as usize);
        let line = format!("  {term:width$} {degree:>8.5} {bar}");
        let _ = writeln!(text, "{}", line.trim_end());
    }
}

fn output_text(text: &mut String, model: &Model, output: &ExplainedOutput, all: &Explanation) {
    let variable = model
        .outputs
        .iter()
        .map(|o| &o.variable)
        .find(|v| v.name == output.name);
    let unit = unit(variable.and_then(|v| v.unit.as_deref()));
    let _ = match output.value {
        None => writeln!(text, "\n{} is undefined: no rule fires", output.name),
        Some(value) if output.is_default => {
            writeln!(
                text,
                "\n{} = {}{unit}: no rule fires, and the model says so",
                output.name,
                short(value)
            )
        }
        Some(value) => writeln!(text, "\n{} = {}{unit}", output.name, short(value)),
    };
    let _ = writeln!(text, "  coverage {:.5}", output.coverage);
    memberships(text, &output.terms);
    if !output.rules.is_empty() {
        text.push_str("\n  strength  share  rule\n");
    }
    for share in &output.rules {
        let fired = all.rules.iter().find(|rule| rule.rule == share.rule);
        let rule = fired.map_or("", |rule| rule.text.as_str());
        let number = share.rule + 1;
        let percent = 100.0 * share.share;
        let _ = writeln!(
            text,
            "  {:>8.5} {percent:>4.0} %  {number}: {rule}",
            share.strength
        );
    }
    if let Some(variable) = variable
        && !output.set.is_empty()
        && !output.rules.is_empty()
    {
        text.push('\n');
        picture(text, output, variable.low, variable.high);
    }
}

/// The aggregated set as a small picture: degrees from 0 to 1 upwards, the value marked below.
fn picture(text: &mut String, output: &ExplainedOutput, low: f64, high: f64) {
    const WIDTH: usize = 60;
    const HEIGHT: usize = 6;
    const EIGHTHS: [char; 9] = [' ', '▁', '▂', '▃', '▄', '▅', '▆', '▇', '█'];
    let last = output.set.len() - 1;
    let degree = |column: usize| {
        output
            .set
            .get(column * last / (WIDTH - 1))
            .map_or(0.0, |(_, d)| *d)
    };
    for row in (0..HEIGHT).rev() {
        let label = if row + 1 == HEIGHT { "1" } else { " " };
        let _ = write!(text, "  {label} │");
        for column in 0..WIDTH {
            let eighths = degree(column) * (8 * HEIGHT) as f64 - (8 * row) as f64;
            let filled = eighths.round().clamp(0.0, 8.0) as usize;
            text.push(EIGHTHS.get(filled).copied().unwrap_or(' '));
        }
        let line = text.trim_end_matches(' ').len();
        text.truncate(line);
        text.push('\n');
    }
    let _ = writeln!(text, "  0 └{}", "─".repeat(WIDTH));
    if let Some(value) = output.value {
        let column = ((value - low) / (high - low) * (WIDTH - 1) as f64).round();
        let _ = writeln!(
            text,
            "     {}▲ {}",
            " ".repeat(column.max(0.0) as usize),
            short(value)
        );
    }
    let (low, high) = (short(low), short(high));
    let gap = WIDTH.saturating_sub(low.len() + high.len());
    let _ = writeln!(text, "    {low}{}{high}", " ".repeat(gap + 1));
}

fn unit(unit: Option<&str>) -> String {
    unit.map(|unit| format!(" {unit}")).unwrap_or_default()
}

/// Eight digits, without noughts behind them.
fn short(x: f64) -> String {
    let digits: f64 = format!("{x:.7e}").parse().unwrap_or(x);
    digits.to_string()
}
