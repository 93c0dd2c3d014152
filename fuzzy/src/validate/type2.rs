//! Validation of interval type-2 terms, and of the outputs that they affect.

use alloc::{format, vec::Vec};

use super::{Validator, or};
use crate::model::{
    Defuzzifier, MembershipFunction, Output, Term, TypeReduction, Variable,
    document::{Spans, TermSpans, VariableSpans},
};

/// The difference up to which the degrees of two membership functions count as equal.
const EQUAL: f64 = 1e-12;

/// The number of steps over the range in which curved membership functions are compared.
const STEPS: u32 = 400;

/// The number of steps in the search for the largest difference within the interval between two compared values.
const SEARCH: usize = 60;

impl Validator<'_> {
    /// Requires that the lower membership functions of a variable with valid terms and a valid range are nowhere above
    /// the upper ones.
    pub(super) fn bounds(&mut self, what: &str, variable: &Variable, spans: &VariableSpans) {
        let unread = spans.range_unread || spans.terms.iter().any(|term| term.unread);
        if unread || !variable.has_type2_terms() {
            return;
        }
        for (i, term) in variable.terms.iter().enumerate() {
            let here = spans.terms.get(i).and_then(|spans| spans.lower.as_deref());
            let Some((x, lower, upper)) = above(term, variable.low, variable.high) else {
                continue;
            };
            let here = here.map_or(0..0, |spans| {
                let first = spans.parameters.first().unwrap_or(&spans.name);
                let last = spans.parameters.last().unwrap_or(&spans.name);
                first.start..last.end
            });
            let message = format!(
                "the lower membership function of term `{}` of {what} exceeds the upper one: at {x}, the lower degree is {lower}, but the upper degree is {upper}",
                term.name,
                x = rounded(x),
                lower = rounded(lower),
                upper = rounded(upper)
            );
            let help = "make the lower membership function narrower, or give it a smaller `height`: it must not exceed the upper one anywhere";
            self.error("lower-above-upper", &here, message, help);
        }
    }

    /// Requires that a Takagi-Sugeno output has no lower membership functions, and that each lower membership
    /// function is a fuzzy set. If one membership function of a term is a singleton, both must be singletons at the
    /// same position.
    pub(super) fn bounds_are_sets(&mut self, what: &str, output: &Output, spans: &VariableSpans) {
        let no_spans = TermSpans::default();
        for (i, term) in output.variable.terms.iter().enumerate() {
            let spans = spans.terms.get(i).unwrap_or(&no_spans);
            let (Some(lower), false) = (&term.lower, spans.unread) else {
                continue;
            };
            let what = format!("term `{}` of {what}", term.name);
            let here = &spans.name;
            let lower = &lower.membership_function;
            if output.defuzzifier.takes_numbers() {
                let message = format!(
                    "{what} has `upper` and `lower`, but the defuzzifier of the output needs a single number for each term"
                );
                let help = "write a single constant or linear function; the output becomes an interval if terms of its inputs have `upper` and `lower`";
                self.error("wrong-term", here, message, help);
            } else if let MembershipFunction::Function { formula } = lower {
                let spans = spans.lower.as_deref().unwrap_or(&no_spans);
                self.own_formula(&what, &output.variable, formula, spans);
            } else if lower.at() != term.membership_function.at() {
                let message = format!(
                    "`upper` and `lower` of {what} must be two singletons at the same position, or two fuzzy sets"
                );
                let help = "write two singletons with the same position and different heights, or two fuzzy sets such as `triangle`";
                self.error("wrong-term", here, message, help);
            } else if lower.number().is_some() || matches!(lower, MembershipFunction::Linear { .. })
            {
                let message = format!("the lower membership function of {what} is not a fuzzy set");
                self.error(
                    "wrong-term",
                    here,
                    message,
                    "write a set such as `triangle`",
                );
            }
        }
    }

    /// Requires that the intervals of outputs affected by type-2 terms can be computed.
    pub(super) fn interval_outputs(&mut self, spans: &Spans) {
        let model = self.model;
        let no_spans = VariableSpans::default();
        for (i, output) in model.outputs.iter().enumerate() {
            let here = &spans.outputs.get(i).unwrap_or(&no_spans).name;
            let name = &output.variable.name;
            if output.type_reduction == TypeReduction::Exact {
                continue;
            }
            if !model.has_type2_terms() {
                let message = format!(
                    "output `{name}` has a `type_reduction`, but the rule set has no type-2 terms"
                );
                self.error(
                    "unsupported-type-2",
                    here,
                    message,
                    "remove `type_reduction`",
                );
            } else if output.defuzzifier == Defuzzifier::WeightedSum {
                let message = format!(
                    "`type_reduction` of output `{name}` is not defined for `weighted_sum`"
                );
                let help = "remove `type_reduction`: the interval of a sum is exact";
                self.error("unsupported-type-2", here, message, help);
            }
        }
        if !model.has_type2_terms() {
            return;
        }
        for (i, output) in model.outputs.iter().enumerate() {
            if !model.has_interval(output) {
                continue;
            }
            let spans = spans.outputs.get(i).unwrap_or(&no_spans);
            let name = &output.variable.name;
            let supported = match output.defuzzifier {
                Defuzzifier::Centroid | Defuzzifier::WeightedAverage | Defuzzifier::WeightedSum => {
                    true
                }
                Defuzzifier::Bisector
                | Defuzzifier::SmallestOfMaxima
                | Defuzzifier::MeanOfMaxima
                | Defuzzifier::LargestOfMaxima
                | Defuzzifier::Tsukamoto => false,
            };
            if !supported {
                let message = format!(
                    "output `{name}` depends on type-2 terms, so its value is an interval, which the defuzzifier `{}` cannot compute",
                    output.defuzzifier.word()
                );
                let help = "write `defuzzifier: centroid`, `weighted_average` or `weighted_sum`, or remove the keys that make terms type-2, such as `blur` or `lower`";
                self.error("unsupported-type-2", &spans.name, message, help);
            }
            if output.samples.is_some() {
                let message =
                    format!("output `{name}` depends on type-2 terms, so it cannot use `samples`");
                let help =
                    "remove `samples`: the interval of such an output is always computed exactly";
                self.error(
                    "unsupported-type-2",
                    or(&spans.samples, &spans.name),
                    message,
                    help,
                );
            }
        }
        if let Some(index) = model.selected_type2_rule() {
            let block = model.rules.get(index).map(|rule| rule.block);
            let of_block = block.and_then(|block| spans.blocks.get(block));
            let here = of_block.map_or(&spans.activation, |block| &block.activation);
            let message = format!(
                "rule {} uses a type-2 term, so its firing strength is an interval, which `activation` cannot rank",
                index + 1
            );
            let help = "remove `activation`, or the keys that make terms type-2, such as `blur` or `lower`";
            self.error("unsupported-type-2", here, message, help);
        }
    }
}

/// Returns the value at which the lower membership function of a term exceeds the upper one most, with both degrees.
fn above(term: &Term, low: f64, high: f64) -> Option<(f64, f64, f64)> {
    let lower = term.lower.as_ref()?;
    let excess = |x: f64| term.lower_membership(x) - term.membership(x);
    let functions = [&lower.membership_function, &term.membership_function];
    let mut points: Vec<f64> = functions.iter().flat_map(|it| it.cuts()).collect();
    points.extend([low, high]);
    // At a step, the degrees of the neighbouring numbers are the limits from both sides.
    let near: Vec<f64> = points
        .iter()
        .flat_map(|x| [x.next_down(), x.next_up()])
        .collect();
    points.extend(near);
    if functions.iter().any(|it| it.corners().is_none()) {
        let at = |i: u32| low + (high - low) * (f64::from(i) / f64::from(STEPS));
        points.extend((0..=STEPS).map(at));
        for i in 1..STEPS {
            let (left, middle, right) = (at(i - 1), at(i), at(i + 1));
            if excess(middle) >= excess(left) && excess(middle) >= excess(right) {
                points.push(highest(left, right, excess));
            }
        }
    }
    points.retain(|x| (low..=high).contains(x));
    let mut worst: Option<(f64, f64)> = None;
    for x in points {
        let excess = excess(x);
        if excess > worst.map_or(EQUAL, |(_, most)| most + EQUAL) {
            worst = Some((x, excess));
        }
    }
    worst.map(|(x, _)| (x, term.lower_membership(x), term.membership(x)))
}

/// Returns the position of the maximum of a function between `left` and `right`; the function must have a single
/// maximum there.
fn highest(mut left: f64, mut right: f64, f: impl Fn(f64) -> f64) -> f64 {
    for _ in 0..SEARCH {
        let third = (right - left) / 3.0;
        if f(left + third) < f(right - third) {
            left += third;
        } else {
            right -= third;
        }
    }
    0.5 * (left + right)
}

/// Rounds a number for a message.
fn rounded(x: f64) -> f64 {
    let digits = libm::round(x * 1e6) / 1e6;
    if digits == 0.0 || !digits.is_finite() {
        x
    } else {
        digits
    }
}
