//! Rules that do not fire, and the nearest changes, as text.

use std::fmt::Write as _;

use super::{
    explanation::digits,
    text::{number, visible},
};
use crate::{
    engine::{Change, Effect, SilentRule},
    model::Model,
};

/// The distance of a change, as a fraction of the range, below which the text is `just above` or `just below`. It
/// is the resolution of the search.
const MIN_SHOWN_DISTANCE: f64 = 1e-9;

/// The maximum number of rules that are listed.
const MAX_RULES: usize = 20;

/// Formats the rules that do not fire, each with the reason on the next line; empty if all rules fire.
pub fn silent_text(silent: &[SilentRule]) -> String {
    let mut text = String::new();
    if silent.is_empty() {
        return text;
    }
    // Writing to a String cannot fail.
    let _ = writeln!(text, "\nrules that do not fire");
    for rule in silent.iter().take(MAX_RULES) {
        let (number, reason) = (rule.rule + 1, rule.silence.to_string());
        let _ = writeln!(text, "  {number}: {}", visible(&rule.text));
        let _ = writeln!(text, "     {}", visible(&reason));
    }
    if silent.len() > MAX_RULES {
        let _ = writeln!(text, "  and {} more", silent.len() - MAX_RULES);
    }
    text
}

/// Formats the nearest changes, one per line; empty if nothing changes over the ranges of the inputs.
pub fn what_if_text(model: &Model, changes: &[Change]) -> String {
    let mut text = String::new();
    let rows: Vec<[String; 3]> = changes.iter().map(|change| row(model, change)).collect();
    let width = |column: usize| {
        let cells = rows.iter().map(|row| row[column].chars().count());
        cells.max().unwrap_or(0)
    };
    let (first, second) = (width(0), width(1));
    if !rows.is_empty() {
        let _ = writeln!(
            text,
            "\nnext changes if one input changes and the others stay"
        );
    }
    for [input, at, effect] in &rows {
        let _ = writeln!(text, "  {input:<first$}  {at:<second$}  {effect}");
    }
    text
}

/// Returns the columns of a change: `temperature`, `from 25 up (+1)`, `` rule 3 dominates `fan`: 62.5 ``.
fn row(model: &Model, change: &Change) -> [String; 3] {
    let mut inputs = model.inputs.iter();
    let input = inputs.find(|input| input.name == change.input);
    let width = input.map_or(0.0, |input| input.high - input.low);
    let (at, by) = (shown(change.at), shown(change.by));
    let at = match (
        change.is_below,
        change.by.abs() < MIN_SHOWN_DISTANCE * width,
    ) {
        (true, true) => format!("just below {at}"),
        (false, true) => format!("just above {at}"),
        (true, false) => format!("from {at} down ({by})"),
        (false, false) => format!("from {at} up (+{by})"),
    };
    let effect = match &change.effect {
        Effect::Term { term: Some(term) } => format!("`{term}` is the strongest term"),
        Effect::Term { term: None } => "all terms are 0".to_owned(),
        Effect::Rule {
            output,
            rule,
            value,
        } => {
            let mut outputs = model.outputs.iter().map(|output| &output.variable);
            let unit = outputs.find(|variable| variable.name == *output);
            let unit = unit.and_then(|variable| variable.unit.as_deref());
            let unit = unit.map_or_else(String::new, |unit| format!(" {unit}"));
            let value = match value {
                Some(value) => format!(": {}{unit}", digits(*value)),
                None => ": no value".to_owned(),
            };
            match rule {
                Some(rule) => format!("rule {} dominates `{output}`{value}", rule + 1),
                None => format!("no rule for `{output}` fires{value}"),
            }
        }
    };
    [
        visible(&change.input).into_owned(),
        at,
        visible(&effect).into_owned(),
    ]
}

/// Formats a number with six significant digits; further digits are artefacts of the search.
fn shown(x: f64) -> String {
    let rounded: f64 = format!("{x:.5e}").parse().unwrap_or(x);
    number(rounded, 12)
}
