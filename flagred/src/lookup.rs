//! Computes a risk from the values of inputs: by the rules where they apply, otherwise by filling.

use fuzzy::table::Outcome;

use crate::{
    gap::{FilledKnots, is_gap},
    sample::Estimate,
};

/// Marks an input that the risk does not depend on, instead of its index among the inputs of the profile.
pub(crate) const UNREAD: u32 = u32::MAX;

/// The data that an estimate of the risk needs in addition to the rules.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Lookup<'a> {
    /// For each input of the rule set its index in the profile, or [`UNREAD`].
    pub(crate) order: &'a [u32],
    /// The coverage below which the rules do not apply.
    pub(crate) coverage_below: f64,
    /// The values that fill gaps; `None` if nothing is filled.
    pub(crate) filled: Option<FilledKnots<'a>>,
}

impl Lookup<'_> {
    /// The risk for given values of the inputs, in the order of the profile; `rules` evaluates the rule set for inputs in
    /// the order of the rule set. `None` if no rule applies and nothing is filled, or if a value is not finite.
    pub(crate) fn estimate(
        &self,
        inputs: &[f64],
        point: &mut [f64],
        rules: impl FnOnce(&[f64]) -> Option<Outcome>,
    ) -> Option<Estimate> {
        self.reorder(inputs, point)?;
        let outcome = rules(point)?;
        let reading = self
            .filled
            .filter(|_| is_gap(outcome.coverage, self.coverage_below))
            .filter(|_| point.iter().all(|x| x.is_finite()))
            .and_then(|knots| knots.read(point));
        let risk_pct = reading
            .map(|reading| reading.value)
            .or_else(|| outcome.value())?;
        Some(Estimate {
            risk_pct: risk_pct.clamp(0.0, 100.0),
            coverage: outcome.coverage,
            filled_from: reading.map(|reading| reading.distance),
            dominant_rule: outcome.dominant_rule,
            clamped: outcome.clamped,
        })
    }

    /// Copies the inputs of the profile in the order of the rule set. Inputs that the risk does not depend on keep
    /// their value.
    pub(crate) fn reorder(&self, inputs: &[f64], point: &mut [f64]) -> Option<()> {
        for (value, from) in point.iter_mut().zip(self.order) {
            if *from != UNREAD {
                *value = *inputs.get(*from as usize)?;
            }
        }
        Some(())
    }
}
