//! Search for outer terms (the first and the last term of an output) whose peak the output never reaches, with
//! suggested changes to the rule set.
//!
//! The centroid of a term lies inside the term, so the output never reaches the peak of a term at the end of the
//! range. For example, a valve with a range from 0 and a term `off` at 0 never closes completely.

use alloc::{
    format,
    string::{String, ToString},
    vec::Vec,
};

use super::shown;
use crate::{
    Engine,
    model::{Defuzzifier, MembershipFunction, Model, Output, Term, Variable},
    rule::{Condition, Rule, is_plain_name},
};

/// A peak is reported if all values of the output are at least this far away from it, as a fraction of the range.
pub(super) const NEAR: f64 = 0.01;

/// An outer term, that is, the first or the last term of an output, whose peak the output never reaches.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct UnreachedTerm {
    /// The name of the term.
    pub term: String,
    /// The peak of the term; for a plateau, the end that is nearer to the values of the output.
    pub peak: f64,
    /// The value of the output if only rules for this term fire.
    pub alone: f64,
}

/// Returns the outer terms whose peak the output does not reach even if only rules for that term fire, in the order of
/// their peaks. Terms that no rule concludes are not reported, nor are terms that fall to 0 before the end of the
/// range, because the author chose that shape.
pub(super) fn unreached(
    model: &Model,
    output: &Output,
    (low, high): (f64, f64),
) -> Vec<UnreachedTerm> {
    let variable = &output.variable;
    // The suggested numbers do not apply to type-2 terms, which have two membership functions.
    if output.defuzzifier.is_weighted() || model.has_interval(output) {
        return Vec::new();
    }
    let near = NEAR * (variable.high - variable.low);
    let [first, last] = outer(variable);
    let below =
        first.filter(|(term, (_, peak))| *peak < low - near && term.membership(variable.low) > 0.0);
    let above = last
        .filter(|(term, (peak, _))| *peak > high + near && term.membership(variable.high) > 0.0);
    let found = [
        below.map(|(term, (_, peak))| (term, peak)),
        above.map(|(term, (peak, _))| (term, peak)),
    ];
    let found = found.into_iter().flatten().filter_map(|(term, peak)| {
        let is_concluded = model.rules.iter().any(|rule| {
            let mut consequents = rule.rule.consequents.iter();
            model.is_enabled(rule)
                && consequents.any(|c| c.output.text == variable.name && c.term.text == term.name)
        });
        let value = value_of_single_term(model, output, term).filter(|_| is_concluded)?;
        ((value - peak).abs() > near).then(|| UnreachedTerm {
            term: term.name.clone(),
            peak,
            alone: value,
        })
    });
    found.collect()
}

/// Returns whether the parts of the range outside `[low, high]` are negligible or plateaus of the outer terms.
pub(super) fn covers_range(output: &Output, (low, high): (f64, f64)) -> bool {
    let variable = &output.variable;
    let near = NEAR * (variable.high - variable.low);
    let [first, last] = outer(variable);
    let is_set = !output.defuzzifier.is_weighted();
    let is_covered = |plateau: Option<(&Term, (f64, f64))>, from: f64, to: f64| {
        let plateau = plateau.filter(|_| is_set);
        to - from <= near
            || plateau.is_some_and(|(_, (left, right))| left <= from + near && right >= to - near)
    };
    is_covered(first, variable.low, low) && is_covered(last, high, variable.high)
}

/// Returns whether a rule concludes a term whose values are all outside `[low, high]`.
pub(super) fn concludes_beyond(model: &Model, output: &Output, (low, high): (f64, f64)) -> bool {
    let variable = &output.variable;
    let near = NEAR * (variable.high - variable.low);
    let rules = model.rules.iter().filter(|rule| model.is_enabled(rule));
    let mut consequents = rules.flat_map(|rule| &rule.rule.consequents);
    consequents.any(|consequent| {
        let mut terms = variable.terms.iter();
        let term = terms.find(|term| {
            consequent.output.text == variable.name && term.name == consequent.term.text
        });
        term.is_some_and(|term| {
            let (first, last) = match term.membership_function.number() {
                Some(number) => (number, number),
                None => variable.plateau(&term.membership_function),
            };
            last < low - near || first > high + near
        })
    })
}

/// Returns the first and the last term in the order of their peaks, with their plateaus.
fn outer(variable: &Variable) -> [Option<(&Term, (f64, f64))>; 2] {
    let terms = || {
        let terms = variable.terms.iter();
        terms.map(|term| (term, variable.plateau(&term.membership_function)))
    };
    let middle = |(_, (left, right)): &(&Term, (f64, f64))| left + right;
    [
        terms().min_by(|a, b| middle(a).total_cmp(&middle(b))),
        terms().max_by(|a, b| middle(a).total_cmp(&middle(b))),
    ]
}

/// Returns the value of an output if only rules for one of its terms fire.
fn value_of_single_term(model: &Model, output: &Output, term: &Term) -> Option<f64> {
    let always = MembershipFunction::Constant { value: 1.0 };
    let mut only = output.clone();
    only.variable.terms = Vec::from([term.clone()]);
    let name = &output.variable.name;
    let model = Model::builder("single term")
        .operators(model.operators_of_output(output))
        .input(Variable::new("a condition", 0.0, 1.0).term("that holds", always))
        .output(only)
        .rule(Rule::new(
            Condition::is("a condition", "that holds"),
            name,
            &term.name,
        ))
        .build();
    let outcomes = Engine::new(&model).ok()?.evaluate(&[0.5]).ok()?;
    outcomes.first()?.value()
}

/// Returns a suggestion: changes to the output after which it reaches the peaks of these terms.
pub(super) fn remedies(model: &Model, output: &Output, unreached: &[UnreachedTerm]) -> String {
    let Output {
        variable,
        defuzzifier,
        ..
    } = output;
    let method = match defuzzifier {
        Defuzzifier::Bisector => "bisector",
        Defuzzifier::Centroid
        | Defuzzifier::SmallestOfMaxima
        | Defuzzifier::MeanOfMaxima
        | Defuzzifier::LargestOfMaxima
        | Defuzzifier::WeightedAverage
        | Defuzzifier::WeightedSum
        | Defuzzifier::Tsukamoto => "centroid",
    };
    let wider = widened(model, output, unreached).map(|[low, high]| {
        let range = format!("range: [{}, {}]", shown(low), shown(high));
        match variable.partition_peaks() {
            // The peaks are written out, because terms without explicit peaks are spaced over the range and would move
            // with it.
            Some(peaks) => {
                let peaks = listed(variable, &peaks, shown);
                format!("`{range}` with `partition: {peaks}`")
            }
            None => format!("`{range}`"),
        }
    });
    let mut is_read = false;
    for rule in &model.rules {
        let condition = &rule.rule.condition;
        condition.visit(&mut |proposition| is_read |= proposition.variable.text == variable.name);
    }
    if is_read {
        // Conditions can only read fuzzy sets. Replacing the terms by numbers is therefore not suggested.
        let wider = wider.as_deref().unwrap_or("a wider `range`");
        return format!("the {method} of a term lies inside the term: write {wider}");
    }
    let peaks: Vec<f64> = variable
        .terms
        .iter()
        .map(|term| {
            let reported = unreached.iter().find(|one| one.term == term.name);
            reported.map_or_else(|| variable.peak(&term.membership_function), |one| one.peak)
        })
        .collect();
    let numbers = listed(variable, &peaks, |peak| {
        format!("{{constant: {}}}", shown(peak))
    });
    let wider = wider.map(|wider| format!("{wider}, or "));
    format!(
        "the {method} of a term lies inside the term: write {}numbers, `terms: {numbers}` with `defuzzifier: weighted_average`",
        wider.unwrap_or_default()
    )
}

/// Formats the terms of a variable, each with a number: `{off: 0, short: 10}`.
fn listed(variable: &Variable, numbers: &[f64], write: impl Fn(f64) -> String) -> String {
    /// The maximum number of terms in a message.
    const MAX_TERMS: usize = 10;
    let terms = variable.terms.iter().zip(numbers).take(MAX_TERMS);
    let terms = terms.map(|(term, number)| {
        let name = match is_plain_name(&term.name) {
            true => term.name.clone(),
            false => format!("{:?}", term.name),
        };
        format!("{name}: {}", write(*number))
    });
    let mut terms: Vec<String> = terms.collect();
    if variable.terms.len() > MAX_TERMS {
        terms.push("...".to_string());
    }
    format!("{{{}}}", terms.join(", "))
}

/// Returns a wider range of the output in which each of these terms, if it is the only active one, yields its peak.
/// `None` if even a range that is three times as wide is not sufficient.
fn widened(model: &Model, output: &Output, unreached: &[UnreachedTerm]) -> Option<[f64; 2]> {
    let [low, high] = [output.variable.low, output.variable.high];
    let mut range = [low, high];
    for one in unreached {
        let term = output.variable.terms.iter().find(|t| t.name == one.term)?;
        let is_below = one.peak < one.alone;
        let by = |more: f64| match is_below {
            true => [low - more, high],
            false => [low, high + more],
        };
        // Returns how far the value still is from the peak if the range is wider by `more`.
        let short = |more: f64| {
            let mut wider = output.clone();
            [wider.variable.low, wider.variable.high] = by(more);
            let value = value_of_single_term(model, &wider, term)?;
            Some(if is_below {
                value - one.peak
            } else {
                one.peak - value
            })
        };
        let (mut less, mut more) = (0.0, high - low);
        if short(more)? > NEAR * 0.1 * (high - low) {
            return None;
        }
        for _ in 0..40 {
            let middle = (less + more) / 2.0;
            match short(middle)? > 0.0 {
                true => less = middle,
                false => more = middle,
            }
        }
        // The number is rounded down, so that the value does not exceed the peak.
        let digits = libm::pow(10.0, libm::floor(libm::log10(less)) - 2.0);
        let [left, right] = by(libm::floor(less / digits) * digits);
        range = [range[0].min(left), range[1].max(right)];
    }
    Some(range)
}
