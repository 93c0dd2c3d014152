//! Parts of a rule set that have no effect or no value: terms that are nearly constant, `clamp` of a centroid, a term
//! after `any`, formulas without a finite value.

use alloc::{format, string::String, vec::Vec};

use super::{findings::At, shown};
use crate::{
    diagnostic::Diagnostic,
    model::{Formula, MembershipFunction, Model, Term, Variable},
    rule::Hedge,
};

/// The largest difference between degrees that count as equal.
const EQUAL: f64 = 0.05;

/// The least share of a range on which a constant degree is suspicious.
const MOST: f64 = 0.98;

/// The number of steps over a range.
const STEPS: u32 = 1000;

/// Adds the findings, in the order of the model's parts.
pub(super) fn of(model: &Model, at: &At<'_>, found: &mut Vec<Diagnostic>) {
    for input in &model.inputs {
        for term in &input.terms {
            if let Some((message, help)) = constant(input, term) {
                let span = at.term_of(&input.name, &term.name);
                found.push(Diagnostic::warning("constant-term", span, message).help(help));
            }
        }
    }
    for output in &model.outputs {
        let name = &output.variable.name;
        if output.clamp && !output.defuzzifier.is_weighted() {
            let message = format!("`clamp` of output `{name}` has no effect");
            let help = "its values are always in the range; remove `clamp`";
            found.push(Diagnostic::warning("no-effect", at.name(name), message).help(help));
        }
        for term in &output.variable.terms {
            if let MembershipFunction::Function { formula } = &term.membership_function
                && output.defuzzifier.takes_numbers()
                && !has_a_value(model, formula)
            {
                let term = &term.name;
                let message = format!(
                    "the formula of term `{term}` of output `{name}` has no finite value at any of the inputs tried"
                );
                let help =
                    "division by 0, and roots and logarithms of negative numbers, have no value";
                let span = at.term_of(name, term);
                found.push(Diagnostic::warning("no-value", span, message).help(help));
            }
        }
    }
    for (index, rule) in model.rules.iter().enumerate() {
        rule.rule.condition.visit(&mut |proposition| {
            let Some(term) = &proposition.term else {
                return;
            };
            if proposition.hedges.contains(&Hedge::Any) {
                let (input, term) = (&proposition.variable.text, &term.text);
                let message = format!(
                    "the term `{term}` after `any` has no effect in rule {}",
                    index + 1
                );
                let help = format!(
                    "write `{input} IS any` for every value of `{input}`, or `{input} IS {term}`"
                );
                let span = at.rule(index);
                found.push(Diagnostic::warning("no-effect", span, message).help(help));
            }
        });
    }
}

/// Returns the message and the help for a term whose degree is nearly the same on the whole range, or on nearly the
/// whole range, including values at which another term is true as well.
fn constant(input: &Variable, term: &Term) -> Option<(String, String)> {
    let width = input.high - input.low;
    if matches!(
        term.membership_function,
        MembershipFunction::Constant { .. }
    ) || width <= 0.0
    {
        // A constant is intended.
        return None;
    }
    let at = |step: u32| input.low + width * (f64::from(step) / f64::from(STEPS));
    let degrees: Vec<f64> = (0..=STEPS).map(|step| term.membership(at(step))).collect();
    let (least, most) = degrees.iter().fold(
        (f64::INFINITY, f64::NEG_INFINITY),
        |(least, most), degree| (least.min(*degree), most.max(*degree)),
    );
    if !(most > EQUAL) {
        // A term that is 0 on the whole range is reported on its own.
        return None;
    }
    let (name, of) = (&term.name, &input.name);
    let help = format!(
        "check its numbers against the unit and the range [{}, {}] of `{of}`",
        shown(input.low),
        shown(input.high)
    );
    if most - least < EQUAL {
        let degrees = match shown(rounded(least)) == shown(rounded(most)) {
            true => shown(rounded(least)),
            false => format!("{} to {}", shown(rounded(least)), shown(rounded(most))),
        };
        let message = format!(
            "term `{name}` of input `{of}` is nearly constant: {degrees} on the whole range"
        );
        return Some((message, help));
    }
    let top = degrees
        .iter()
        .filter(|degree| **degree > most - EQUAL)
        .count();
    let share = top as f64 / degrees.len() as f64;
    let is_beside = |other: &&Term| {
        other.name != *name
            && (0..=STEPS).zip(&degrees).any(|(step, degree)| {
                *degree > most - EQUAL && other.membership(at(step)) > other.height * (1.0 - EQUAL)
            })
    };
    if share < MOST {
        return None;
    }
    let other = input.terms.iter().find(is_beside)?;
    let message = format!(
        "term `{name}` of input `{of}` is {} on {} % of the range, also where `{}` is {}",
        shown(rounded(most)),
        libm::floor(100.0 * share),
        other.name,
        shown(rounded(other.height))
    );
    Some((message, help))
}

/// Rounds a degree to two decimal places.
fn rounded(degree: f64) -> f64 {
    libm::round(100.0 * degree) / 100.0
}

/// Returns whether a formula has a finite value at any of many points that are spread over the ranges of the variables.
fn has_a_value(model: &Model, formula: &Formula) -> bool {
    const POINTS: u32 = 500;
    let outputs = model.outputs.iter().map(|output| &output.variable);
    let variables: Vec<&Variable> = model.inputs.iter().chain(outputs).collect();
    (0..=POINTS).any(|point| {
        // The additive recurrence with the golden ratio; each variable has another multiple of it.
        let value = |name: &str| {
            let index = variables.iter().position(|variable| variable.name == name);
            let Some((index, variable)) = index.and_then(|i| Some((i, variables.get(i)?))) else {
                return f64::NAN;
            };
            let turns = f64::from(point) * (0.618_033_988_749_895 + 0.37 * index as f64);
            variable.low + (variable.high - variable.low) * (turns - libm::floor(turns))
        };
        formula.evaluate(value).is_finite()
    })
}
