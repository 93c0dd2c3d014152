//! Drawings of the terms of all variables of a model, and of the curve of a model with one input.

use super::{
    colour::{Colour, distinct, distinct_line},
    document::{Anchor, Frame, SvgDocument},
    explanation::{Number, sticks, terms},
    heat::curve,
    scale::Scale,
    slice::Slice,
    text::{number, short, titled, visible},
};
use crate::model::{MembershipFunction, Model, Output, Term, Variable, type2::Bound};

const WIDTH: f64 = 640.0;
/// The height of a frame.
const FRAME: f64 = 110.0;
/// The height of a frame including its labels.
const BLOCK: f64 = 176.0;

/// Returns an SVG of the terms of every input and output of a model. The `curves`, which are the outputs of a model
/// with a single input, are drawn below the terms.
pub fn variables_svg(model: &Model, curves: &[Slice]) -> String {
    drawn(model, None, curves)
}

/// Returns an SVG of the variables whose terms differ between two models: the new terms, and the old ones dashed. The
/// models must have the same variables.
pub fn moved_svg(before: &Model, after: &Model) -> String {
    let mut moved = after.clone();
    moved.inputs.retain(|input| !before.inputs.contains(input));
    let has_moved = |output: &Output| {
        let mut outputs = before.outputs.iter();
        !outputs.any(|other| other.variable == output.variable)
    };
    moved.outputs.retain(has_moved);
    drawn(&moved, Some(before), &[])
}

fn drawn(model: &Model, before: Option<&Model>, curves: &[Slice]) -> String {
    let blocks = model.inputs.len() + model.outputs.len() + 2 * curves.len();
    let mut document = SvgDocument::new(WIDTH, 60.0 + BLOCK * blocks as f64);
    document.heading(70.0, &model.name, "");
    let frame = |i: usize, height: f64| Frame {
        left: 70.0,
        top: 62.0 + BLOCK * i as f64,
        width: 400.0,
        height,
    };
    let title = |document: &mut SvgDocument, frame: &Frame, title: &str| {
        document.text((70.0, frame.top - 8.0), Anchor::Start, "title", title);
    };
    let heading = |variable: &Variable| titled(&variable.name, variable.unit.as_deref());
    for (i, input) in model.inputs.iter().enumerate() {
        let frame = frame(i, FRAME);
        title(&mut document, &frame, &heading(input));
        let before =
            before.and_then(|before| before.inputs.iter().find(|old| old.name == input.name));
        terms(&mut document, &frame, input, before, &[], None);
    }
    for (i, output) in model.outputs.iter().enumerate() {
        let frame = frame(model.inputs.len() + i, FRAME);
        title(&mut document, &frame, &heading(&output.variable));
        let old = before.and_then(|before| {
            let mut outputs = before.outputs.iter();
            outputs.find(|old| old.variable.name == output.variable.name)
        });
        if output.defuzzifier.takes_numbers() || output.is_discrete() {
            let mut sticks_of = numbers(output);
            let old = old.map(numbers).unwrap_or_default().into_iter();
            // The sticks of the old numbers are half as high.
            let moved = old.filter(|old| !sticks_of.contains(old));
            let moved = moved
                .map(|(at, weight, colour, text)| (at, weight / 2.0, colour, text + " before"));
            sticks_of.extend(moved.collect::<Vec<Number>>());
            sticks(&mut document, &frame, &output.variable, &sticks_of);
        } else {
            let before = old.map(|old| &old.variable);
            terms(&mut document, &frame, &output.variable, before, &[], None);
        }
    }
    let first = model.inputs.len() + model.outputs.len();
    for (i, slice) in curves.iter().enumerate() {
        let frame = frame(first + 2 * i, FRAME + BLOCK);
        let name = format!("{} over {}", slice.output_title(), slice.x.title());
        title(&mut document, &frame, &name);
        curve(&mut document, &frame, slice);
    }
    document.finish(&format!("{}: its variables and their terms", model.name))
}

/// Returns the terms of a Takagi-Sugeno output. Linear functions and formulas have the weight 0, so that only their
/// text is drawn.
fn numbers(output: &Output) -> Vec<Number> {
    let terms = output.variable.terms.iter().enumerate();
    let numbers = terms.filter_map(|(i, term)| {
        let text = formula(term, &output.variable)?;
        Some(match term.membership_function {
            MembershipFunction::Constant { value: at } | MembershipFunction::Singleton { at } => {
                (at, 1.0, distinct(i), text)
            }
            _ => (output.variable.low, 0.0, distinct(i), text),
        })
    });
    numbers.collect()
}

/// Returns the formula of a term, such as `fast = 0.1 heat + 3`; `None` for a fuzzy set.
fn formula(term: &Term, variable: &Variable) -> Option<String> {
    let value = match &term.membership_function {
        MembershipFunction::Function { formula } if !formula.is_over(&variable.name) => {
            formula.to_string()
        }
        MembershipFunction::Constant { value: at } | MembershipFunction::Singleton { at } => {
            short(*at)
        }
        MembershipFunction::Linear {
            coefficients,
            constant,
        } => {
            let parts = coefficients.iter();
            let parts = parts.map(|(input, factor)| format!("{} {input} + ", short(*factor)));
            parts.collect::<String>() + &short(*constant)
        }
        _ => return None,
    };
    Some(format!("{} = {value}", term.name))
}

/// The number of columns of a drawing as text.
const COLUMNS: usize = 60;
/// The number of rows of a drawing as text.
const ROWS: usize = 8;

/// Formats the terms of every input and output of a model as text, with one character per term, and the curves below
/// them.
///
/// `paint` formats a character, given its colour on a terminal. Without colours: `|mark, _| mark.to_string()`.
pub fn variables_text(
    model: &Model,
    curves: &[Slice],
    paint: impl Fn(char, Option<Colour>) -> String,
) -> String {
    let mut text = format!("{}\n", visible(&model.name));
    for variable in model.variables() {
        text += &format!(
            "\n{}\n",
            visible(&titled(&variable.name, variable.unit.as_deref()))
        );
        let x = Scale::new(variable.low, variable.high);
        let sets = variable
            .terms
            .iter()
            .filter(|term| formula(term, variable).is_none());
        // A type-2 term has two lines.
        let sets = sets.flat_map(|term| {
            let lower = term.lower.is_some().then(|| Term {
                name: format!("{}, lower", term.name),
                ..term.only(Bound::Lower)
            });
            core::iter::once(term.only(Bound::Upper)).chain(lower)
        });
        let sets: Vec<Term> = sets.collect();
        if !sets.is_empty() {
            let degree = |i: usize, column: usize| {
                let at = x.value(column as f64 / (COLUMNS - 1) as f64);
                Some(sets.get(i)?.membership(at)).filter(|degree| *degree > 0.0)
            };
            lines(&mut text, sets.len(), degree, ("1", "0"), x, &paint);
        }
        for (i, term) in sets.iter().enumerate() {
            let mark = paint(mark(i), Some(distinct_line(i)));
            text += &format!("  {mark} {}\n", visible(&term.name));
        }
        for formula in variable
            .terms
            .iter()
            .filter_map(|term| formula(term, variable))
        {
            text += &format!("  {}\n", visible(&formula));
        }
    }
    for slice in curves {
        let title = format!("{} over {}", slice.output_title(), slice.x.title());
        text += &format!("\n{}\n", visible(&title));
        let last = slice.columns().saturating_sub(1);
        let at = |_: usize, column: usize| {
            let value = slice.cell(column * last / (COLUMNS - 1), 0).value?;
            Some(slice.share(value))
        };
        let ends = (short(slice.range.high), short(slice.range.low));
        lines(
            &mut text,
            1,
            at,
            (&ends.0, &ends.1),
            slice.x.scale(),
            |_, colour| paint('•', colour),
        );
    }
    text
}

/// Returns the character of the i-th term.
fn mark(i: usize) -> char {
    char::from_digit((i % 35 + 1) as u32, 36).unwrap_or('+')
}

/// Draws lines over a scale; their values are fractions of the height, and the last line is on top.
fn lines(
    text: &mut String,
    count: usize,
    share: impl Fn(usize, usize) -> Option<f64>,
    (high, low): (&str, &str),
    x: Scale,
    paint: impl Fn(char, Option<Colour>) -> String,
) {
    let width = high.len().max(low.len());
    let row_of = |share: f64| (share * (ROWS - 1) as f64).round() as usize;
    for row in (0..ROWS).rev() {
        let label = match row {
            0 => low,
            r if r + 1 == ROWS => high,
            _ => "",
        };
        let mut line = String::new();
        for column in 0..COLUMNS {
            let here = |i: &usize| share(*i, column).is_some_and(|share| row_of(share) == row);
            match (0..count).rev().find(here) {
                Some(i) => line += &paint(mark(i), Some(distinct_line(i))),
                None => line.push(' '),
            }
        }
        *text += &format!("  {label:>width$} │{}\n", line.trim_end());
    }
    *text += &format!("  {:>width$} └{}\n", "", "─".repeat(COLUMNS));
    let (low, high) = (number(x.low, 4), number(x.high, 4));
    let gap = COLUMNS.saturating_sub(low.len() + high.len());
    *text += &format!("  {:>width$}  {low}{}{high}\n", "", " ".repeat(gap));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_term_is_drawn_with_its_name() {
        let model: Model = "
fuzzy: 1
name: fan
inputs: {heat: {range: [0, 40], unit: °C, partition: [low, high]}}
outputs: {speed: {range: [0, 9], defuzzifier: weighted_average, terms: {slow: {constant: 2}, fast: {linear: {heat: 0.1, constant: 3}}}}}
rules: [IF heat IS low THEN speed IS slow, IF heat IS high THEN speed IS fast]
"
        .parse()
        .unwrap();
        let text = variables_text(&model, &[], |mark, _| mark.to_string());
        insta::assert_snapshot!(text);
        let svg = variables_svg(&model, &[]);
        assert!(
            svg.contains("heat [°C]") && svg.contains("slow = 2"),
            "{svg}"
        );
    }

    #[test]
    fn moved_terms_are_drawn_beside_the_old_ones() {
        let model = |low: f64, slow: f64| -> Model {
            format!(
                "
fuzzy: 1
name: fan
inputs:
  heat: {{range: [0, 40], partition: {{low: {low}, high: 30}}}}
  damp: {{range: [0, 40], partition: [dry, wet]}}
outputs: {{speed: {{range: [0, 9], defuzzifier: weighted_average, terms: {{slow: {{constant: {slow}}}, fast: {{constant: 8}}}}}}}}
rules: [IF heat IS low THEN speed IS slow, IF heat IS high THEN speed IS fast]
"
            )
            .parse()
            .unwrap()
        };
        let svg = moved_svg(&model(10.0, 2.0), &model(15.0, 3.0));
        // Both terms of the partition have a different flank now.
        assert_eq!(svg.matches("stroke-dasharray=\"5 3\"").count(), 2);
        assert!(svg.contains("heat") && !svg.contains("damp"), "{svg}");
        assert!(
            svg.contains("slow = 3") && svg.contains("slow = 2 before"),
            "{svg}"
        );
        assert!(!svg.contains("fast = 8 before"), "{svg}");
    }
}
