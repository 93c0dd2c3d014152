//! Parts of a rule set that have no effect or no value: terms that are nearly constant, `clamp` for values that never
//! leave the range, a term that follows the hedge `any`, formulas without a finite value.

use alloc::{format, string::String, vec::Vec};

use super::{findings::ModelPositions, shown};
use crate::{
    Engine,
    diagnostic::Diagnostic,
    model::{Formula, MembershipFunction, Model, Output, Term, Variable},
    rule::Hedge,
};

/// The largest difference between degrees that count as equal.
const EQUAL_TOLERANCE: f64 = 0.05;

/// A term is reported if it has its largest degree on at least this share of the range.
const MIN_SHARE: f64 = 0.98;

/// The number of steps into which the range of a variable is divided; degrees are computed at the ends of each step.
const STEPS: u32 = 200;

/// Adds the findings, in the order of the model's parts. Returns the outputs that have no value at some inputs because of
/// a formula.
pub(super) fn of(
    model: &Model,
    at: &ModelPositions<'_>,
    found: &mut Vec<Diagnostic>,
) -> Vec<String> {
    let mut without = Vec::new();
    for input in &model.inputs {
        constants(input, at, found);
    }
    for output in &model.outputs {
        let name = &output.variable.name;
        if output.clamp && !output.defuzzifier.is_weighted() {
            let message = format!("`clamp` of output `{name}` has no effect");
            let help = "its values are always in the range; remove `clamp`";
            found.push(Diagnostic::warning("no-effect", at.name(name), message).help(help));
        }
        numbers_without_effect(output, at, found);
        for term in &output.variable.terms {
            if let MembershipFunction::Function { formula } = &term.membership_function
                && output.defuzzifier.takes_numbers()
                && let Some(place) = without_value(model, name, term, formula)
            {
                without.push(name.clone());
                let term = &term.name;
                let message = format!(
                    "the formula of term `{term}` of output `{name}` has no finite value at {place}"
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
    without
}

/// Reports the settings of a weighted output that apply only to fuzzy sets.
fn numbers_without_effect(output: &Output, at: &ModelPositions<'_>, found: &mut Vec<Diagnostic>) {
    let name = &output.variable.name;
    if !output.defuzzifier.takes_numbers() {
        return;
    }
    let settings = [
        (output.samples.is_some(), "samples"),
        (output.aggregation.is_some(), "aggregation"),
    ];
    for (_, key) in settings.iter().filter(|(is_set, _)| *is_set) {
        let message = format!("`{key}` of output `{name}` has no effect");
        let help = format!("its terms are numbers, not fuzzy sets; remove `{key}`");
        found.push(Diagnostic::warning("no-effect", at.name(name), message).help(help));
    }
    for term in output
        .variable
        .terms
        .iter()
        .filter(|term| term.height != 1.0)
    {
        let (term, span) = (&term.name, at.term_of(name, &term.name));
        let message = format!("`height` of term `{term}` of output `{name}` has no effect");
        let help = "the term is a number, not a fuzzy set; remove `height`, or give the rules a weight: `WITH 0.5`";
        found.push(Diagnostic::warning("no-effect", span, message).help(help));
    }
}

/// The degrees of a term at evenly spaced values of its variable.
struct Degrees<'m> {
    term: &'m Term,
    at: Vec<f64>,
    least: f64,
    most: f64,
}

impl Degrees<'_> {
    fn of<'m>(variable: &Variable, term: &'m Term) -> Degrees<'m> {
        let width = variable.high - variable.low;
        let x = |step: u32| variable.low + width * (f64::from(step) / f64::from(STEPS));
        let at: Vec<f64> = (0..=STEPS).map(|step| term.membership(x(step))).collect();
        Degrees {
            term,
            least: at.iter().copied().fold(f64::INFINITY, f64::min),
            most: at.iter().copied().fold(0.0, f64::max),
            at,
        }
    }

    /// Returns, for each value, whether the degree is nearly the largest one.
    fn is_top(&self) -> impl Iterator<Item = bool> {
        self.at
            .iter()
            .map(|degree| *degree > self.most - EQUAL_TOLERANCE)
    }
}

/// Reports the terms of an input whose degree is nearly the same on the whole range. Also reports a term that has
/// nearly its largest degree on nearly the whole range, if another term is fully true there too, or if only a narrow
/// part is left for the other terms. Terms with degrees below [`EQUAL_TOLERANCE`] on the whole range are reported by the
/// analysis of terms outside the range. A `constant` is not reported, because its author wants the same degree
/// everywhere.
fn constants(input: &Variable, at: &ModelPositions<'_>, found: &mut Vec<Diagnostic>) {
    let degrees: Vec<Degrees<'_>> = input
        .terms
        .iter()
        .map(|term| Degrees::of(input, term))
        .collect();
    for one in &degrees {
        let is_constant = matches!(
            one.term.membership_function,
            MembershipFunction::Constant { .. }
        );
        if is_constant || one.most <= EQUAL_TOLERANCE {
            continue;
        }
        if let Some((message, help)) = constant(input, one, &degrees) {
            let span = at.term_of(&input.name, &one.term.name);
            found.push(Diagnostic::warning("constant-term", span, message).help(help));
        }
    }
}

/// Returns the message and the help for a term that is nearly constant.
fn constant(input: &Variable, one: &Degrees<'_>, all: &[Degrees<'_>]) -> Option<(String, String)> {
    let (name, of) = (&one.term.name, &input.name);
    if let MembershipFunction::Sigmoid { slope: 0.0, .. } = one.term.membership_function {
        let message =
            format!("`slope` of term `{name}` of input `{of}` is 0: its degree is 0.5 everywhere");
        let help = "write a slope above 0 for a rising term, below 0 for a falling one";
        return Some((message, help.into()));
    }
    let help = format!(
        "check its numbers against the unit and the range [{}, {}] of `{of}`",
        shown(input.low),
        shown(input.high)
    );
    let (least, most) = (shown(rounded(one.least)), shown(rounded(one.most)));
    if one.most - one.least < EQUAL_TOLERANCE {
        let degrees = match least == most {
            true => most,
            false => format!("{least} to {most}"),
        };
        let message = format!(
            "term `{name}` of input `{of}` is nearly constant: {degrees} over the whole range"
        );
        return Some((message, help));
    }
    let share = one.is_top().filter(|is_top| *is_top).count() as f64 / one.at.len() as f64;
    if share < MIN_SHARE {
        return None;
    }
    let is_beside = |other: &&Degrees<'_>| {
        let height = other.term.height;
        other.term.name != *name
            && (one.is_top().zip(&other.at))
                .any(|(is_top, degree)| is_top && *degree > height - EQUAL_TOLERANCE)
    };
    let Some(other) = all.iter().find(is_beside).map(|other| other.term) else {
        // A crisp term whose limits are near the ends of the range is intended.
        let x = |step: u32| input.low + (input.high - input.low) * (f64::from(step) / 2000.0);
        let is_between =
            |degree: f64| degree > EQUAL_TOLERANCE && degree < one.most - EQUAL_TOLERANCE;
        if !(0..=2000).any(|step| is_between(one.term.membership(x(step)))) {
            return None;
        }
        let message = format!(
            "term `{name}` of input `{of}` is {most} on {} % of the range, so that the other terms have almost no effect",
            libm::floor(100.0 * share)
        );
        return Some((message, help));
    };
    let message = format!(
        "term `{name}` of input `{of}` is {most} on {} % of the range, also where `{}` is {}",
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

/// Returns a description of the values at which the formula of a term has no finite value although a rule that
/// concludes the term fires; `None` if no such values were found. The ends of the ranges, where most formulas have
/// their poles, are among the values tried.
fn without_value(model: &Model, output: &str, term: &Term, formula: &Formula) -> Option<String> {
    const MAX_POINTS: usize = 3000;
    if !has_a_value(model, formula) {
        return Some("any of the inputs tried".into());
    }
    let is_read = |input: &Variable| formula.places().any(|(name, _)| name == input.name);
    let mut points: Vec<Vec<f64>> = Vec::from([Vec::new()]);
    for input in &model.inputs {
        let middle = input.low / 2.0 + input.high / 2.0;
        let zero = (input.low < 0.0 && input.high > 0.0).then_some(0.0);
        let tried = [Some(middle), Some(input.low), Some(input.high), zero];
        let tried = tried.into_iter().flatten();
        let count = match points.len() * 4 > MAX_POINTS && !is_read(input) {
            true => 1,
            false => 4,
        };
        let tried: Vec<f64> = tried.take(count).collect();
        let longer = points.iter().flat_map(|point| {
            tried
                .iter()
                .map(move |value| point.iter().copied().chain([*value]).collect())
        });
        points = longer.take(MAX_POINTS).collect();
    }
    let value_of = |point: &[f64], name: &str| {
        let mut inputs = model.inputs.iter().zip(point);
        let found = inputs.find(|(input, _)| input.name == name);
        // The result is `None` for an output, because its value is not known here.
        found.map(|(_, value)| *value)
    };
    points.retain(|point| {
        let is_known = |(name, _): (&str, _)| value_of(point, name).is_some();
        let value = |name: &str| value_of(point, name).unwrap_or(f64::NAN);
        formula.places().all(is_known) && !formula.evaluate(value).is_finite()
    });
    if points.is_empty() {
        return None;
    }
    let index = model
        .outputs
        .iter()
        .position(|it| it.variable.name == output)?;
    // Replaces the formula with a number, so that the output has a value wherever the rule fires.
    let mut other = model.clone();
    let terms = other
        .outputs
        .get_mut(index)
        .map(|output| &mut output.variable.terms);
    let one = terms
        .into_iter()
        .flatten()
        .find(|one| one.name == term.name)?;
    one.membership_function = MembershipFunction::Constant { value: 1.0 };
    let (engine, other) = (Engine::new(model).ok()?, Engine::new(&other).ok()?);
    let has_value = |engine: &Engine, point: &[f64]| {
        let outcomes = engine.evaluate(point).ok();
        outcomes
            .and_then(|outcomes| outcomes.get(index)?.value())
            .is_some()
    };
    let point = points
        .iter()
        .find(|point| !has_value(&engine, point) && has_value(&other, point))?;
    let values = model
        .inputs
        .iter()
        .zip(point)
        .filter(|(input, _)| is_read(input));
    let values: Vec<String> = values
        .map(|(input, value)| format!("{} = {}", input.name, shown(*value)))
        .collect();
    Some(values.join(", "))
}

/// Returns whether a formula has a finite value at any of many points that are spread over the ranges of the variables.
fn has_a_value(model: &Model, formula: &Formula) -> bool {
    const POINTS: u32 = 500;
    let variables: Vec<&Variable> = model.variables().collect();
    (0..=POINTS).any(|point| {
        // The points follow an additive recurrence. Its step differs between variables; for the first variable it is
        // 1 / golden ratio.
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
