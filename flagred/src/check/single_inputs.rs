//! The highest risk that each input of a profile can reach alone, at its worst value while all other inputs are calm.

use alloc::{
    format,
    string::{String, ToString},
    vec::Vec,
};

use fuzzy::{
    diagnostic::Diagnostic,
    model::{MembershipFunction, Role, Variable},
};

use super::{OUTVOTED, ValuePositions, is_above, shown, unknown_signal};
use crate::{
    estimator::{Estimator, Memory},
    profile::{Profile, ProfileInput},
    verdict::{Level, Threshold},
};

/// The budget of a search: the maximum number of rules and terms that are evaluated, which takes some tens of
/// milliseconds.
const MAX_STEPS: usize = 3_000_000;
/// The number of equal steps into which an input's range is divided. The ends of the steps are tried, in addition to
/// the points of the terms.
const STEPS: u32 = 32;

/// The highest risk that an input reaches alone.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schema", schemars(rename = "OutvotedInput"))]
#[non_exhaustive]
pub struct InputRisk {
    /// The input.
    pub input: String,
    /// The value at which the risk is highest.
    pub value: f64,
    /// The term to which this value belongs most; `None` if the value belongs to no term.
    pub term: Option<String>,
    /// The output that is the risk; if the profile has several risks, the risk that raises the highest level.
    pub risk_output: String,
    /// The highest risk, in %.
    pub risk_pct: f64,
    /// The risk while all inputs are calm, in %.
    pub calm_risk_pct: f64,
    /// The level that this risk raises if it is constant.
    pub level: Level,
}

/// The highest risk that each input reaches alone, in the order of the profile.
///
/// The search starts where the risk is lowest, with all inputs calm. From there each input in turn takes the value with
/// the highest risk, while the others take the values that lower this risk most. Inputs without any value that gives a
/// risk are left out.
///
/// # Example
/// ```
/// use flagred::{check, shipped, verdict::Level};
///
/// let risks = check::risks_of_single_inputs(&shipped::flagred());
/// let at_limit = risks.iter().find(|one| one.input == "at_limit").ok_or("no such input")?;
/// assert_eq!((at_limit.term.as_deref(), at_limit.level), (Some("much"), Level::Fail));
/// # Ok::<(), &str>(())
/// ```
pub fn risks_of_single_inputs(estimator: &Estimator) -> Vec<InputRisk> {
    let mut worst: Vec<Option<InputRisk>> = Vec::new();
    for risk in core::iter::once(estimator).chain(estimator.others()) {
        let found = of_risk(risk);
        worst.resize(found.len(), None);
        for (worst, found) in worst.iter_mut().zip(found) {
            let is_worse = |one: &InputRisk, known: &InputRisk| {
                (one.level, one.risk_pct) > (known.level, known.risk_pct)
            };
            let (one, known) = (found.as_ref(), worst.as_ref());
            if one.is_some_and(|one| known.is_none_or(|known| is_worse(one, known))) {
                *worst = found;
            }
        }
    }
    worst.into_iter().flatten().collect()
}

/// Warns about each input that does not come from the motors and cannot raise a level alone.
///
/// The inputs from motor commands are symptoms of one cause and rise together, so none of them has to raise a level
/// alone. A problem that another signal measures may not show in the motors at all.
pub(super) fn outvoted(
    estimator: &Estimator,
    at: &ValuePositions,
    signals: &[(&str, &str)],
) -> Vec<Diagnostic> {
    let profile = estimator.profile();
    let risks = risks_of_single_inputs(estimator);
    // If the signal of an input is probably misspelt, it is unknown whether the input can raise a warning.
    let is_other = |input: &&ProfileInput| {
        !input.source.signal.is_computed_from_commands() && unknown_signal(input, signals).is_none()
    };
    let others = profile.inputs.iter().filter(is_other);
    let found = others.filter_map(|input| {
        let one = risks.iter().find(|one| one.input == input.name)?;
        (one.level < Level::Warn).then(|| {
            let place = at.of(&["inputs", &input.name]);
            Diagnostic::warning(OUTVOTED, place, message(one, profile)).help(help(one))
        })
    });
    found.collect()
}

fn message(one: &InputRisk, profile: &Profile) -> String {
    let mut others = profile.other_risks.iter();
    let other = others.find(|risk| risk.output == one.risk_output);
    let warn = other.map_or(profile.verdict.warn, |risk| risk.warn);
    let below = match warn.raise.risk_pct {
        Some(limit) => format!("below `warn` at {limit}"),
        None => "and raises no level".to_string(),
    };
    let (input, risk, risk_pct) = (&one.input, &one.risk_output, shown(one.risk_pct));
    match one.raises_risk() {
        true => format!(
            "`{input}` cannot raise a warning alone: {} gives `{risk}` {risk_pct} % while all other inputs are calm, {below}",
            at(one)
        ),
        false => format!(
            "`{input}` cannot raise a warning alone: while all other inputs are calm, `{risk}` is {risk_pct} % at every value of it, {below}"
        ),
    }
}

impl InputRisk {
    /// Whether the input raises the risk by at least one percentage point.
    fn raises_risk(&self) -> bool {
        self.risk_pct - self.calm_risk_pct >= 1.0
    }
}

/// Formats a value with its term: `0 (empty)`.
fn at(one: &InputRisk) -> String {
    let value = shown_value(one.value);
    match &one.term {
        Some(term) => format!("{value} (`{term}`)"),
        None => value,
    }
}

fn help(one: &InputRisk) -> String {
    let term = one.term.as_deref().unwrap_or("TERM");
    let input = &one.input;
    let accept = format!("`allow: [{{finding: outvoted, of: {input}, because: ...}}]`");
    match one.raises_risk() {
        true => format!(
            "the rules about the other inputs outweigh it: write rules with `{input} IS {term}` that conclude a separate output, such as `{input}_risk`, and name it in `other_risks`; if it is meant to act only with others, accept this: {accept}"
        ),
        false => format!(
            "its rules need other inputs, too; if that is intended, accept this: {accept}; otherwise add rules about `{input}` alone that conclude a separate output, and name it in `other_risks`"
        ),
    }
}

/// Formats a value with at most four digits.
fn shown_value(x: f64) -> String {
    let digits: f64 = format!("{x:.3e}").parse().unwrap_or(x);
    format!("{digits}")
}

/// The highest risk of each input of the profile, for one risk output.
fn of_risk(estimator: &Estimator) -> Vec<Option<InputRisk>> {
    let profile = estimator.profile();
    let model = estimator.model();
    let variables = profile.inputs.iter().map(|input| {
        let mut known = model.inputs.iter();
        known.find(|variable| variable.name == input.name)
    });
    let variables: Vec<Option<&Variable>> = variables.collect();
    let values: Vec<Vec<f64>> = variables
        .iter()
        .map(|variable| variable.map_or(Vec::new(), values))
        .collect();
    let mut search = OutvotedSearch::of(estimator);
    let starts: [fn(&Variable) -> f64; 3] = [
        |variable| variable.low,
        |variable| variable.low / 2.0 + variable.high / 2.0,
        |variable| variable.high,
    ];
    let start = |position: fn(&Variable) -> f64| -> Vec<f64> {
        let values = variables
            .iter()
            .map(|variable| variable.map_or(0.0, position));
        values.collect()
    };
    let calm = starts.map(|position| search.lowest(start(position), &values, None));
    let calm = calm
        .into_iter()
        .flatten()
        .reduce(|a, b| if b.0 < a.0 { b } else { a });
    let Some((calm_risk_pct, calm)) = calm else {
        return profile.inputs.iter().map(|_| None).collect();
    };
    let all = &values;
    let inputs = values.iter().zip(&variables).enumerate();
    let found = inputs.map(|(index, (values, variable))| {
        let mut point = calm.clone();
        let mut highest: Option<(f64, f64)> = None;
        for &value in values {
            *point.get_mut(index)? = value;
            if let Some(risk) = search.risk(&point)
                && highest.is_none_or(|(_, known)| risk > known)
            {
                highest = Some((value, risk));
            }
        }
        let (value, _) = highest?;
        *point.get_mut(index)? = value;
        let (risk_pct, _) = search.lowest(point, all, Some(index))?;
        Some(InputRisk {
            input: profile.inputs.get(index)?.name.clone(),
            value,
            term: term(variable.as_ref()?, value),
            risk_output: profile.output.clone(),
            risk_pct,
            calm_risk_pct,
            level: level(profile, risk_pct),
        })
    });
    found.collect()
}

struct OutvotedSearch<'e> {
    estimator: &'e Estimator,
    memory: Memory,
    /// The remaining budget of evaluations.
    left: usize,
}

impl<'e> OutvotedSearch<'e> {
    fn of(estimator: &'e Estimator) -> OutvotedSearch<'e> {
        let model = estimator.model();
        let terms: usize = model.inputs.iter().map(|input| input.terms.len()).sum();
        let work = model.rules.len() + terms;
        OutvotedSearch {
            estimator,
            memory: Memory::of(estimator),
            left: (MAX_STEPS / work.max(1)).max(1000),
        }
    }

    fn risk(&mut self, point: &[f64]) -> Option<f64> {
        let estimate = self.estimator.estimate(point, &mut self.memory)?;
        Some(estimate.risk_pct)
    }

    /// The lowest risk found by improving one input at a time while `fixed` keeps its value, and
    /// the values of the inputs at that risk.
    fn lowest(
        &mut self,
        start: Vec<f64>,
        values: &[Vec<f64>],
        fixed: Option<usize>,
    ) -> Option<(f64, Vec<f64>)> {
        let mut point = start;
        let mut lowest = self.risk(&point);
        loop {
            let before = lowest;
            let free = values.iter().enumerate();
            for (index, values) in free.filter(|(index, _)| Some(*index) != fixed) {
                let mut best = *point.get(index)?;
                for &value in values {
                    self.left = self.left.saturating_sub(1);
                    if self.left == 0 {
                        break;
                    }
                    *point.get_mut(index)? = value;
                    if let Some(risk) = self.risk(&point)
                        && lowest.is_none_or(|known| risk < known)
                    {
                        (lowest, best) = (Some(risk), value);
                    }
                }
                *point.get_mut(index)? = best;
            }
            if lowest == before || self.left == 0 {
                return Some((lowest?, point));
            }
        }
    }
}

/// The values of an input to try: evenly spaced values over its range, and the points of its terms within it.
fn values(variable: &Variable) -> Vec<f64> {
    /// The maximum number of points; if there are more, they are thinned.
    const MAX_POINTS: usize = 200;
    let (low, high) = (variable.low, variable.high);
    let even = (0..=STEPS).map(|i| {
        let part = f64::from(i) / f64::from(STEPS);
        low * (1.0 - part) + high * part
    });
    let mut from_terms: Vec<f64> = Vec::new();
    for term in &variable.terms {
        match &term.membership_function {
            MembershipFunction::Piecewise { points } => {
                from_terms.extend(points.iter().map(|point| point.0));
            }
            shape => {
                let parameters = shape.parameters().into_iter();
                let positions = parameters.filter(|(_, role, _)| *role != Role::Positive);
                from_terms.extend(positions.map(|(_, _, x)| x));
            }
        }
    }
    from_terms.retain(|x| (low..=high).contains(x));
    let step = from_terms.len().div_ceil(MAX_POINTS).max(1);
    let mut values: Vec<f64> = from_terms.into_iter().step_by(step).chain(even).collect();
    values.sort_by(f64::total_cmp);
    values.dedup();
    values
}

/// The term to which a value belongs most.
fn term(variable: &Variable, value: f64) -> Option<String> {
    let terms = variable.terms.iter();
    let degrees = terms.map(|term| (term.membership(value), &term.name));
    let degrees = degrees.filter(|(degree, _)| *degree > 0.0);
    let highest = degrees.reduce(|a, b| if b.0 > a.0 { b } else { a });
    highest.map(|(_, name)| name.clone())
}

/// The level that a constant risk reaches, directly or through the elevated risk.
fn level(profile: &Profile, risk_pct: f64) -> Level {
    let elevated = &profile.elevated_risk;
    let rises = elevated.rise_pct_per_s > 0.0 && risk_pct >= elevated.high_pct;
    let is_reached = |threshold: &Threshold| {
        let by_risk = threshold
            .risk_pct
            .is_some_and(|limit| !is_above(limit, risk_pct));
        by_risk || (rises && threshold.elevated_risk_pct.is_some())
    };
    match &profile.verdict {
        verdict if is_reached(&verdict.fail.raise) => Level::Fail,
        verdict if is_reached(&verdict.warn.raise) => Level::Warn,
        _ => Level::Good,
    }
}
