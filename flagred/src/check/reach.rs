//! Warnings about thresholds of a profile that the risk never or always reaches.

use alloc::{format, string::String, vec::Vec};
use core::ops::Range;

use fuzzy::{
    Model,
    check::extent,
    diagnostic::Diagnostic,
    rule::{Condition, Hedge},
};

use super::{ValuePositions, is_above, shown};
use crate::{
    estimator::Estimator,
    verdict::{LevelSettings, Threshold},
};

/// Finds thresholds that are never or always reached, and WARN above FAIL.
pub(super) fn thresholds(
    estimator: &Estimator,
    place: &[&str],
    at: &ValuePositions,
    found: &mut Vec<Diagnostic>,
) {
    let profile = estimator.profile();
    let of = |keys: &[&str]| at.of(&[place, keys].concat());
    let verdict = &profile.verdict;
    let levels = [("warn", &verdict.warn), ("fail", &verdict.fail)];
    let never_rises = profile.elevated_risk.rise_pct_per_s == 0.0;
    if let Some((low, high)) = estimator.extent() {
        let is_possible = |level: &LevelSettings| {
            let Threshold {
                risk_pct,
                elevated_risk_pct,
            } = level.raise;
            let by_risk = risk_pct.is_some_and(|limit| !is_above(limit, high));
            by_risk || (elevated_risk_pct.is_some() && !never_rises)
        };
        if !levels.iter().any(|(_, level)| is_possible(level)) {
            let message = format!(
                "neither `warn` nor `fail` can be reached: the rules give at most {}",
                shown(high)
            );
            found
                .push(Diagnostic::error("out-of-reach", of(&[]), message).help(
                    "lower the thresholds: with these thresholds every flight would be GOOD",
                ));
            return;
        }
        let reached: Vec<Diagnostic> = levels
            .into_iter()
            .flat_map(|(name, level)| reached(name, level, (low, high), of))
            .collect();
        let is_always = |(_, level): &(&str, &LevelSettings)| {
            level
                .raise
                .risk_pct
                .is_some_and(|limit| limit > 1.0 && limit <= low)
        };
        let omitted = omitted_terms(estimator.model(), &profile.output);
        match omitted.first().filter(|_| levels.iter().any(is_always)) {
            None => found.extend(reached),
            // The missing rule causes all these findings, so it is reported instead of them.
            Some(proposition) => {
                let output = &profile.output;
                let message = format!(
                    "`{output}` is at least {}: no rule for it covers `{proposition}`",
                    shown(low)
                );
                let help = format!(
                    "add a rule: `IF {proposition} THEN {output} IS ...`; where no rule fires, the risk is estimated from the values around"
                );
                found.push(Diagnostic::warning("out-of-reach", of(&[]), message).help(help));
            }
        }
    }
    if never_rises {
        for (name, level) in levels {
            if level
                .raise
                .elevated_risk_pct
                .is_some_and(|limit| limit > 0.0)
            {
                let message = format!(
                    "`{name}` is never reached by the elevated risk, because that never rises"
                );
                let place = of(&[name, "elevated_risk"]);
                let help = "write `rise_per_s` in `elevated_risk`, or remove the threshold";
                found.push(Diagnostic::warning("out-of-reach", place, message).help(help));
            }
        }
    }
    type Limit = fn(&Threshold) -> Option<f64>;
    let measures: [(&str, Limit); 2] = [
        ("risk", |threshold| threshold.risk_pct),
        ("elevated_risk", |threshold| threshold.elevated_risk_pct),
    ];
    for (measure, limit) in measures {
        if let (Some(warn), Some(fail)) = (limit(&verdict.warn.raise), limit(&verdict.fail.raise))
            && warn > fail
        {
            let message =
                format!("`warn` at {measure} {warn} is above `fail` at {fail}: FAIL comes first");
            let place = of(&["warn", measure]);
            let finding = Diagnostic::warning("order", place, message)
                .help(format!(
                    "lower `warn` to {fail} or below, or raise `fail` to {warn} or above"
                ))
                .related(of(&["fail", measure]), "FAIL");
            found.push(finding);
        }
    }
}

/// Returns the terms that no rule for an output mentions, of the inputs that these rules read, as propositions:
/// `battery IS enough`. Empty if a rule has a `NOT` or a hedge other than `very`, which may cover other terms, or if it
/// joins conditions.
fn omitted_terms(model: &Model, output: &str) -> Vec<String> {
    let rules = model.rules.iter().map(|rule| &rule.rule);
    let rules = rules.filter(|rule| {
        rule.consequents
            .iter()
            .any(|consequent| consequent.output.text == output)
    });
    let propositions = rules.map(|rule| match &rule.condition {
        Condition::Is(proposition)
            if proposition.hedges.iter().all(|hedge| *hedge == Hedge::Very) =>
        {
            Some((
                proposition.variable.text.as_str(),
                proposition.term.as_ref()?.text.as_str(),
            ))
        }
        _ => None,
    });
    let Some(covered) = propositions.collect::<Option<Vec<(&str, &str)>>>() else {
        return Vec::new();
    };
    let inputs = model.inputs.iter();
    let inputs = inputs.filter(|input| covered.iter().any(|(name, _)| *name == input.name));
    let terms = inputs.flat_map(|input| {
        input
            .terms
            .iter()
            .map(move |term| (&input.name, &term.name))
    });
    let omitted = terms.filter(|(input, term)| !covered.contains(&(input.as_str(), term.as_str())));
    omitted
        .map(|(input, term)| format!("{input} IS {term}"))
        .collect()
}

/// Finds thresholds of a level that the risk cannot reach, or always reaches.
fn reached(
    name: &str,
    level: &LevelSettings,
    (low, high): (f64, f64),
    of: impl Fn(&[&str]) -> Range<usize>,
) -> Vec<Diagnostic> {
    let mut found = Vec::new();
    let place = |key: &[&str]| of(&[&[name], key].concat());
    if let Some(limit) = level.raise.risk_pct
        && (low..1.0).contains(&limit)
        && limit > 0.0
    {
        let message = format!("`{name}` at risk {limit} is raised below 1 %");
        let help = format!(
            "thresholds are in percent: did you mean {}?",
            shown(100.0 * limit)
        );
        found.push(Diagnostic::warning("unit", place(&["risk"]), message).help(help));
    }
    if let Some(limit) = level.raise.risk_pct {
        let above = is_above(limit, high);
        if above || limit <= low {
            let (what, bound) = match above {
                true => ("is never reached", format!("at most {}", shown(high))),
                false => ("is always reached", format!("at least {}", shown(low))),
            };
            let message = format!("`{name}` at risk {limit} {what}: the rules give {bound}");
            let help = match above {
                true => {
                    "lower the threshold in `verdict`, or make the last term of the output narrower: the centroid of a term is inside the term"
                }
                false => {
                    "raise the threshold in `verdict` above the lowest risk that the rules give"
                }
            };
            let help = match limit > 0.0 && limit <= 1.0 && !above {
                true => format!("risks are in percent: did you mean {}?", limit * 100.0),
                false => help.into(),
            };
            found.push(Diagnostic::warning("out-of-reach", place(&["risk"]), message).help(help));
        }
    }
    if let Some(until) = level.until.risk_pct
        && until <= low
        && level.raise.risk_pct.is_none_or(|limit| limit > low)
    {
        let message = format!(
            "`{name}` is never lowered: it lasts until the risk falls below {until}, but the rules give at least {}",
            shown(low)
        );
        let help = "raise `until` above the lowest risk that the rules give";
        let place = place(&["until", "risk"]);
        found.push(Diagnostic::warning("out-of-reach", place, message).help(help));
    }
    found
}

impl Estimator {
    /// The smallest and largest risk that the rules and the filled gaps can give; `None` if they are unknown.
    fn extent(&self) -> Option<(f64, f64)> {
        let (low, high) = extent(self.model(), &self.profile().output)?;
        let filled = self.filled().iter().copied();
        Some(filled.fold((low, high), |(low, high), value| {
            (low.min(value), high.max(value))
        }))
    }
}
