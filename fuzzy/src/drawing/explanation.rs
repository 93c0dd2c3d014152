//! Drawings of the terms of a variable, and of explanations, as SVG.

use super::{
    colour::{Colour, distinct, distinct_line},
    document::{Anchor, Frame, LABEL_WIDTH, SvgDocument},
    plot::{Plot, PlotLine, draw},
    scale::Scale,
    text::{number, short, titled, wrapped},
};
use crate::{
    engine::{ExplainedOutput, Explanation, Share},
    model::{Model, Variable, type2::Bound},
};

const WIDTH: f64 = 640.0;
/// The height of the frame of a variable in an explanation.
const FRAME: f64 = 96.0;
/// The height of a frame including its labels.
const BLOCK: f64 = 166.0;
/// The length of the bar of a rule with strength 1.
const RULE_BAR: f64 = 60.0;
/// The number of steps at which a membership function is drawn.
const STEPS: usize = 200;

/// Returns an SVG of the terms of a variable: their membership functions and, if a value is given, their degrees at it.
pub fn terms_svg(variable: &Variable, at: Option<f64>) -> String {
    let mut document = SvgDocument::new(WIDTH, 330.0);
    let title = titled(&variable.name, variable.unit.as_deref());
    let description = variable.description.as_deref().unwrap_or("");
    document.heading(70.0, &title, description);
    let frame = Frame {
        left: 70.0,
        top: 44.0,
        width: 420.0,
        height: 230.0,
    };
    terms(&mut document, &frame, variable, None, &[], at);
    document.finish(&format!("the terms of {title}"))
}

/// Returns an SVG of an explanation: the degrees of the inputs' terms, the aggregated set of each output, and the rules
/// that fired.
///
/// `model` is the rule set that was explained.
pub fn explanation_svg(model: &Model, explanation: &Explanation) -> String {
    let written: Vec<Vec<String>> = explanation
        .rules
        .iter()
        .map(|rule| {
            let text = format!("{}: {}", rule.rule + 1, rule.text);
            wrapped(&text, ((WIDTH - 100.0 - RULE_BAR) / LABEL_WIDTH) as usize)
        })
        .collect();
    let blocks = explanation.inputs.len() + explanation.outputs.len();
    let lines = written.iter().map(Vec::len).sum::<usize>() + written.len();
    let rules_top = 60.0 + BLOCK * blocks as f64;
    let mut document = SvgDocument::new(WIDTH, rules_top + 14.0 * lines as f64 + 20.0);
    document.heading(70.0, &model.name, "");
    let frame = |i: usize| Frame {
        left: 70.0,
        top: 62.0 + BLOCK * i as f64,
        width: 400.0,
        height: FRAME,
    };
    for (i, (input, variable)) in explanation.inputs.iter().zip(&model.inputs).enumerate() {
        let mut title = format!("{} = {}", variable.name, short(input.given));
        if input.given != input.value {
            title += &format!(", outside the range, used as {}", short(input.value));
        }
        let at = (70.0, frame(i).top - 8.0);
        document.text(at, Anchor::Start, "title", &title);
        terms(
            &mut document,
            &frame(i),
            variable,
            None,
            &[],
            Some(input.value),
        );
    }
    for (i, (output, written)) in explanation.outputs.iter().zip(&model.outputs).enumerate() {
        let frame = frame(explanation.inputs.len() + i);
        let at = (70.0, frame.top - 8.0);
        document.text(
            at,
            Anchor::Start,
            "title",
            &titles(output, &written.variable, explanation),
        );
        let shade = |share: &Share| {
            let mut rules = explanation.rules.iter();
            distinct(rules.position(|rule| rule.rule == share.rule).unwrap_or(0))
        };
        if written.defuzzifier.is_weighted() || written.is_discrete() {
            let numbers = output.rules.iter();
            let numbers = numbers.filter_map(|rule| {
                let text = format!("rule {}: {}", rule.rule + 1, short(rule.value?));
                Some((rule.value?, rule.strength, shade(rule), text))
            });
            let numbers: Vec<Number> = numbers.collect();
            sticks(&mut document, &frame, &written.variable, &numbers);
            let scale = Scale::new(written.variable.low, written.variable.high);
            marker(&mut document, &frame, scale, output.value);
        } else {
            let implied = output.rules.iter();
            let implied: Vec<Area<'_>> = implied
                .map(|rule| (rule.implied.as_slice(), shade(rule)))
                .collect();
            terms(
                &mut document,
                &frame,
                &written.variable,
                None,
                &implied,
                output.value,
            );
        }
    }
    let mut y = rules_top;
    if !written.is_empty() {
        document.text(
            (70.0, y),
            Anchor::Start,
            "title",
            "Rules that fired: firing strength from 0 to 1; the implied set above has the same shade",
        );
    }
    y += 20.0;
    for (i, (fired, lines)) in explanation.rules.iter().zip(&written).enumerate() {
        let bar = Frame {
            left: 110.0,
            top: y - 8.0,
            width: RULE_BAR,
            height: 9.0,
        };
        let full = Frame {
            width: RULE_BAR * fired.strength.clamp(0.0, 1.0),
            ..bar
        };
        document.rect(bar, format_args!(r##"fill="#eee""##));
        document.rect(full, format_args!(r#"fill="{}""#, distinct(i)));
        document.text((104.0, y), Anchor::End, "label", &number(fired.strength, 3));
        for line in lines {
            document.text((bar.right() + 10.0, y), Anchor::Start, "label", line);
            y += 14.0;
        }
        y += 4.0;
    }
    document.finish(&format!("{}: an evaluation with its reasons", model.name))
}

/// Returns a text with the value of an output, and the values of the outputs that it reads.
fn titles(output: &ExplainedOutput, variable: &Variable, all: &Explanation) -> String {
    let answer = answer(output, variable, all);
    match read_values(output, all) {
        reads if reads.is_empty() => answer,
        reads => format!("{answer}; reads {}", reads.join(", ")),
    }
}

/// Returns the outputs that an output reads, each with its value.
pub(super) fn read_values(output: &ExplainedOutput, all: &Explanation) -> Vec<String> {
    let reads = all
        .outputs
        .iter()
        .filter(|one| output.reads.contains(&one.name));
    let reads = reads.map(|read| match read.value {
        Some(value) => format!("{} = {}", read.name, digits(value)),
        None => format!("{}, which is undefined", read.name),
    });
    reads.collect()
}

/// Returns a description of the value of an output.
pub(super) fn answer(output: &ExplainedOutput, variable: &Variable, all: &Explanation) -> String {
    let unit = variable.unit.iter().map(|unit| format!(" {unit}"));
    let unit: String = unit.collect();
    let mut reads = all.outputs.iter();
    let unknown = reads.find(|one| one.value.is_none() && output.reads.contains(&one.name));
    match output.value {
        None => match unknown {
            Some(read) => format!("{} is undefined, because {} is", output.name, read.name),
            None if output.keeps_previous => format!(
                "{} keeps its previous value, and a single point has none: no rule fired",
                output.name
            ),
            None => format!("{} is undefined: no rule fired", output.name),
        },
        Some(value) if output.is_default && output.keeps_previous => format!(
            "{} keeps its previous value, or {}{unit} if there is none: no rule fired",
            output.name,
            digits(value)
        ),
        Some(value) if output.is_default => {
            format!(
                "{} = {}{unit}, the default value: no rule fired",
                output.name,
                digits(value)
            )
        }
        Some(value) => {
            let mut text = format!("{} = {}{unit}", output.name, digits(value));
            if let (Some(low), Some(high)) = (output.low, output.high) {
                text += &format!(", the middle of {} to {}", digits(low), digits(high));
            }
            text
        }
    }
}

/// Formats a number with eight significant digits, without trailing zeros.
pub(super) fn digits(x: f64) -> String {
    let rounded: f64 = format!("{x:.7e}").parse().unwrap_or(x);
    rounded.to_string()
}

/// The implied set of a rule, with its colour.
type Area<'a> = (&'a [(f64, f64)], Colour);

/// A number of a Takagi-Sugeno output: value, weight, colour and label.
pub(super) type Number = (f64, f64, Colour, String);

/// Draws the numbers of a Takagi-Sugeno output, each as a stick whose height is its weight.
pub(super) fn sticks(
    document: &mut SvgDocument,
    frame: &Frame,
    variable: &Variable,
    numbers: &[Number],
) {
    let ends = numbers.iter().map(|(value, ..)| *value);
    // The scale includes numbers outside the range.
    let x = Scale::new(
        ends.clone().fold(variable.low, f64::min),
        ends.fold(variable.high, f64::max),
    );
    for (value, weight, colour, _) in numbers {
        let ends = [
            frame.at(x.share(*value), 0.0),
            frame.at(x.share(*value), *weight),
        ];
        let paint = format_args!(r#"stroke="{colour}" stroke-width="6""#);
        document.through("polyline", &ends, paint);
    }
    document.axes(frame, (x, ""), (Scale::new(0.0, 1.0), "weight"));
    let keys = numbers.iter();
    let keys: Vec<(Colour, String)> = keys.map(|(_, _, c, text)| (*c, text.clone())).collect();
    document.legend_entries(frame.right() + 14.0, frame.top, &keys);
}

/// Draws the terms of a variable: membership functions, implied sets of rules, a value, and the degrees at it. The
/// previous shapes of terms that differ in `before` are dashed, the lower membership functions of type-2 terms dotted.
pub(super) fn terms(
    document: &mut SvgDocument,
    frame: &Frame,
    variable: &Variable,
    before: Option<&Variable>,
    implied: &[Area<'_>],
    at: Option<f64>,
) {
    let (x, y) = (
        Scale::new(variable.low, variable.high),
        Scale::new(0.0, 1.0),
    );
    for (set, colour) in implied {
        let (Some(first), Some(last)) = (set.first(), set.last()) else {
            continue;
        };
        let ends = [(last.0, 0.0), (first.0, 0.0)];
        let outline = set.iter().chain(&ends);
        let outline = outline.map(|(value, degree)| frame.at(x.share(*value), y.share(*degree)));
        let outline: Vec<(f64, f64)> = outline.collect();
        let paint = format_args!(r#"fill="{colour}" fill-opacity=".55""#);
        document.through("polygon", &outline, paint);
    }
    let old = before.into_iter().flat_map(|before| {
        let moved = |i: &usize| variable.terms.get(*i) != before.terms.get(*i);
        let moved = (0..before.terms.len()).filter(moved);
        moved.map(|i| PlotLine {
            dash: "5 3",
            ..PlotLine::new(i, "", membership(before, i))
        })
    });
    let series = variable.terms.iter().enumerate().map(|(i, term)| PlotLine {
        dash: "none",
        ..PlotLine::new(i, term.name.as_str(), membership(variable, i))
    });
    let lower = Variable {
        terms: (variable.terms.iter())
            .map(|term| term.only(Bound::Lower))
            .collect(),
        ..variable.clone()
    };
    let type2 = (variable.terms.iter().enumerate()).filter(|(_, term)| term.lower.is_some());
    let dotted = type2.map(|(i, _)| PlotLine {
        dash: "1 3",
        ..PlotLine::new(i, "", membership(&lower, i))
    });
    let plot = Plot {
        title: String::new(),
        x: (x, String::new()),
        y: (y, "degree".into()),
        series: old.chain(series).chain(dotted).collect(),
    };
    draw(document, frame, &plot);
    marker(document, frame, x, at);
    let keys = variable.terms.iter().enumerate().map(|(i, term)| {
        let degree = at.map(|at| {
            let upper = number(term.membership(at), 3);
            match term.lower {
                None => format!(" {upper}"),
                Some(_) => format!(" {} to {upper}", number(term.lower_membership(at), 3)),
            }
        });
        let degree = degree.unwrap_or_default();
        (distinct_line(i), format!("{}{degree}", term.name))
    });
    let keys: Vec<(Colour, String)> = keys.collect();
    document.legend_entries(frame.right() + 14.0, frame.top, &keys);
}

/// Draws a vertical line at a value, over the whole height of a frame.
fn marker(document: &mut SvgDocument, frame: &Frame, x: Scale, value: Option<f64>) {
    if let Some(value) = value {
        let share = x.share(value).clamp(0.0, 1.0);
        document.line(frame.at(share, 0.0), frame.at(share, 1.0), "marker");
    }
}

/// Returns points of the membership function of a term over the range: evenly spaced ones, and both sides of each
/// corner.
fn membership(variable: &Variable, term: usize) -> Vec<(f64, f64)> {
    let Some(term) = variable.terms.get(term) else {
        return Vec::new();
    };
    let range = Scale::new(variable.low, variable.high);
    let even = (0..=STEPS).map(|i| range.value(i as f64 / STEPS as f64));
    let beside = 1e-9 * (range.high - range.low);
    let corners = term.membership_function.corners().unwrap_or_default();
    let corners = corners
        .into_iter()
        .flat_map(|(x, _)| [x - beside, x, x + beside]);
    let within = corners.filter(|x| (range.low..=range.high).contains(x));
    let mut xs: Vec<f64> = even.chain(within).collect();
    xs.sort_by(f64::total_cmp);
    xs.into_iter().map(|x| (x, term.membership(x))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::MembershipFunction;

    #[test]
    fn a_term_is_drawn_through_its_corners_and_names_cannot_be_markup() {
        let variable = Variable::new("a<b", 0.0, 10.0)
            .term(
                "\"low\"",
                MembershipFunction::Rectangle {
                    left: 0.0,
                    right: 3.33,
                },
            )
            .term(
                "high",
                MembershipFunction::Triangle {
                    left: 3.33,
                    peak: 10.0,
                    right: 10.0,
                },
            );
        let points = membership(&variable, 0);
        assert!(points.contains(&(3.33, 1.0)), "{points:?}");
        let after = points.iter().find(|(x, _)| *x > 3.33);
        assert!(after.is_some_and(|(x, degree)| *x < 3.331 && *degree == 0.0));
        let svg = terms_svg(&variable, Some(2.0));
        assert!(svg.contains("a&lt;b") && !svg.contains("a<b"));
        assert!(svg.contains("&quot;low&quot; 1"));
    }
}
