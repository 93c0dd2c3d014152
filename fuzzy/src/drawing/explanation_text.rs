//! Explanations as text.

use std::fmt::Write as _;

use super::{
    explanation::{answer, digits, read_values},
    scale::Scale,
    text::{bar, block, visible},
};
use crate::{
    engine::{Degree, ExplainedInput, ExplainedOutput, Explanation},
    model::{Model, Variable},
};

/// The length of a bar for degree 1.
const BAR: usize = 20;
/// The number of columns of the drawing of an aggregated set.
const COLUMNS: usize = 60;
/// The number of rows of the drawing of an aggregated set.
const ROWS: usize = 6;

/// Formats an explanation as text: the degrees of the inputs' terms, the rules that fired, and the aggregated set of
/// each output.
///
/// `model` is the rule set that was explained.
pub fn explanation_text(model: &Model, explanation: &Explanation) -> String {
    let mut text = format!("{}\n", visible(&model.name));
    for (input, variable) in explanation.inputs.iter().zip(&model.inputs) {
        add_input(&mut text, variable, input);
    }
    for (output, written) in explanation.outputs.iter().zip(&model.outputs) {
        add_output(&mut text, &written.variable, output, explanation);
    }
    text
}

// Writing to a String cannot fail.
fn add_input(text: &mut String, variable: &Variable, input: &ExplainedInput) {
    let unit = variable
        .unit
        .iter()
        .map(|unit| format!(" {}", visible(unit)));
    let unit: String = unit.collect();
    let _ = write!(
        text,
        "\n{} = {}{unit}",
        visible(&input.name),
        digits(input.given)
    );
    if input.given != input.value {
        let _ = write!(text, ", outside the range, used as {}", digits(input.value));
    }
    text.push('\n');
    add_degrees(text, &input.terms, input.value);
}

/// Adds a line per term: the degree of a value in it, as a number and as a bar.
fn add_degrees(text: &mut String, terms: &[Degree], value: f64) {
    let terms = terms.iter().map(|term| {
        let degree = bounds(term.lower, term.degree);
        (visible(&term.term), degree, term.degree)
    });
    let terms: Vec<_> = terms.collect();
    let names = terms.iter().map(|(term, ..)| term.chars().count());
    let width = names.max().unwrap_or(0).max(4);
    let degrees = terms.iter().map(|(_, degree, _)| degree.len());
    let wide = degrees.max().unwrap_or(0).max(8);
    if !terms.is_empty() {
        let _ = writeln!(
            text,
            "  degree of {} in each term, the bar from 0 to 1:",
            digits(value)
        );
        let _ = writeln!(
            text,
            "  {:width$} {:>wide$}  0{:>scale$}",
            "term",
            "degree",
            1,
            scale = BAR - 1
        );
    }
    for (term, shown, degree) in terms {
        let _ = writeln!(text, "  {term:width$} {shown:>wide$}  {}", bar(degree, BAR));
    }
}

/// Formats a degree or a firing strength; with type-2 terms, both bounds.
fn bounds(lower: Option<f64>, upper: f64) -> String {
    match lower {
        None => format!("{upper:.5}"),
        Some(lower) => format!("{lower:.5} to {upper:.5}"),
    }
}

fn add_output(text: &mut String, variable: &Variable, output: &ExplainedOutput, all: &Explanation) {
    let _ = writeln!(text, "\n{}", visible(&answer(output, variable, all)));
    let reads = read_values(output, all);
    if !reads.is_empty() {
        let _ = writeln!(text, "  reads {}", visible(&reads.join(", ")));
    }
    let _ = writeln!(
        text,
        "  coverage {:.5}, the largest firing strength",
        output.coverage
    );
    add_degrees(text, &output.terms, output.value.unwrap_or(f64::NAN));
    let weighted = output.rules.iter().any(|rule| rule.value.is_some());
    let strengths = (output.rules.iter()).map(|share| bounds(share.lower, share.strength));
    let strengths: Vec<String> = strengths.collect();
    let wide = strengths.iter().map(String::len).max().unwrap_or(0).max(8);
    if !output.rules.is_empty() {
        let value = if weighted { "       value" } else { "" };
        let _ = writeln!(text, "\n  {:>wide$}  share{value}  rule", "strength");
    }
    for (share, strength) in output.rules.iter().zip(strengths) {
        let fired = all.rules.iter().find(|rule| rule.rule == share.rule);
        let rule = fired.map_or("".into(), |rule| visible(&rule.text));
        let (number, percent) = (share.rule + 1, 100.0 * share.share);
        let value = share
            .value
            .map_or_else(String::new, |value| format!("{:>12}", digits(value)));
        let _ = writeln!(
            text,
            "  {strength:>wide$} {percent:>4.0} %{value}  {number}: {rule}"
        );
    }
    if !output.set.is_empty() && !output.rules.is_empty() {
        let _ = writeln!(
            text,
            "\n  aggregated set{}: degree over {}",
            if output.low.is_some() {
                ", upper bound"
            } else {
                ""
            },
            visible(&output.name)
        );
        add_set(text, output, Scale::new(variable.low, variable.high));
    }
}

/// Adds the aggregated set, with degrees from 0 at the bottom to 1 at the top, and the value marked below.
fn add_set(text: &mut String, output: &ExplainedOutput, range: Scale) {
    let last = output.set.len() - 1;
    let eighths = |column: usize| {
        let point = output.set.get(column * last / (COLUMNS - 1));
        point.map_or(0, |(_, degree)| {
            (degree * (8 * ROWS) as f64).round() as usize
        })
    };
    for row in (0..ROWS).rev() {
        let label = if row + 1 == ROWS { "1" } else { " " };
        let blocks: String = (0..COLUMNS)
            .map(|column| block(eighths(column), row))
            .collect();
        let _ = writeln!(text, "  {label} │{}", blocks.trim_end());
    }
    let _ = writeln!(text, "  0 └{}", "─".repeat(COLUMNS));
    if let Some(value) = output.value {
        let column = (range.share(value) * (COLUMNS - 1) as f64).round().max(0.0);
        let indent = " ".repeat(column as usize);
        let _ = writeln!(text, "     {indent}▲ {}", digits(value));
    }
    let (low, high) = (digits(range.low), digits(range.high));
    let gap = COLUMNS.saturating_sub(low.len() + high.len()) + 1;
    let _ = writeln!(text, "    {low}{}{high}", " ".repeat(gap));
}
