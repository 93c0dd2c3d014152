//! The interval of a risk, from the intervals of its inputs.

use alloc::{vec, vec::Vec};

use fuzzy::engine::{Enclosure, Interval};

use crate::{
    estimator::Estimator,
    flight::Finding,
    lookup::UNREAD,
    monitor::{Estimate, Monitor},
};

/// The values that a risk may have, because its inputs are computed from a limited number of samples. This interval
/// contains the risk for all values of the inputs within their 95 % intervals. docs/method.md defines it.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RiskInterval {
    /// The lower end in %.
    #[cfg_attr(feature = "serde", serde(rename = "risk_low"))]
    #[cfg_attr(feature = "schema", schemars(range(min = 0, max = 100)))]
    pub low_pct: f64,
    /// The upper end in %.
    #[cfg_attr(feature = "serde", serde(rename = "risk_high"))]
    #[cfg_attr(feature = "schema", schemars(range(min = 0, max = 100)))]
    pub high_pct: f64,
}

/// A known risk with the intervals of the inputs that it was computed from.
#[derive(Debug, Clone)]
pub(super) struct UncertainRisk {
    estimate: Estimate,
    /// The intervals of the inputs, in the order of the profile.
    inputs: Vec<Interval>,
}

impl UncertainRisk {
    /// Creates the uncertain risk after a sample; `None` if the risk or the uncertainty of an input is unknown.
    pub(super) fn of(monitor: &Monitor) -> Option<UncertainRisk> {
        let estimate = monitor.risk()?;
        let inputs = match estimate == Estimate::FALL {
            true => Vec::new(),
            false => monitor.intervals()?,
        };
        Some(UncertainRisk { estimate, inputs })
    }

    #[cfg(test)]
    pub(super) fn inputs(&self) -> &[Interval] {
        &self.inputs
    }
}

/// The highest risk of a finding.
#[derive(Debug, Clone)]
pub(super) struct UncertainPeak {
    /// The time at which the finding begins, in seconds.
    from_s: f64,
    value_pct: f64,
    risk: Option<UncertainRisk>,
}

impl UncertainPeak {
    /// Stores the intervals of the inputs after a sample if the risk of this sample is the highest so far of the open
    /// finding, or of a finding that may be opened. `peaks` has one element for each of the `ended` findings that had
    /// a peak, and a last element for the open finding or for the one that may be opened.
    pub(super) fn keep(peaks: &mut Vec<UncertainPeak>, ended: &[Finding], monitor: &Monitor) {
        let (Some((from_s, value_pct)), Some(risk)) = (monitor.peak_of_risk(), monitor.risk())
        else {
            return;
        };
        if risk.risk_pct != value_pct {
            return;
        }
        let last = peaks.last_mut();
        if last.is_some_and(|last| last.from_s == from_s && last.value_pct >= value_pct) {
            return;
        }
        // The last element is replaced unless it belongs to a finding that has ended.
        let is_replaced = |last: &mut UncertainPeak| {
            let mut ended = ended.iter().rev();
            last.from_s == from_s || !ended.any(|finding| finding.from_s == last.from_s)
        };
        peaks.pop_if(is_replaced);
        peaks.push(UncertainPeak {
            from_s,
            value_pct,
            risk: UncertainRisk::of(monitor),
        });
    }

    /// The highest risk of the finding that begins at a time.
    pub(super) fn find(peaks: &[UncertainPeak], from_s: f64) -> Option<&UncertainRisk> {
        let peak = peaks.iter().find(|peak| peak.from_s == from_s)?;
        peak.risk.as_ref()
    }
}

/// Computes intervals of risks.
pub(super) struct RiskBounds<'e> {
    estimator: &'e Estimator,
    enclosure: Enclosure<'e>,
    /// The intervals of the inputs of the rule set.
    point: Vec<Interval>,
}

impl<'e> RiskBounds<'e> {
    pub(super) fn new(estimator: &'e Estimator) -> RiskBounds<'e> {
        RiskBounds {
            estimator,
            enclosure: estimator.engine().enclosure(),
            point: vec![Interval::from(0.0); estimator.model().inputs.len()],
        }
    }

    /// The interval of a risk; where no rule applies, it is computed from the values that fill the gap.
    pub(super) fn of(&mut self, risk: &UncertainRisk) -> Option<RiskInterval> {
        let risk_pct = risk.estimate.risk_pct;
        let mut values = Interval::from(risk_pct);
        if !risk.inputs.is_empty() {
            let variables = self.estimator.model().inputs.iter();
            let places = variables.zip(self.estimator.order());
            for (place, (variable, from)) in self.point.iter_mut().zip(places) {
                let range = Interval::new(variable.low, variable.high);
                *place = match *from {
                    UNREAD => Interval::from(variable.low),
                    from => risk.inputs.get(from as usize)?.within(range),
                };
            }
            let outcomes = self.enclosure.evaluate(&self.point).ok();
            let output = self.estimator.output();
            let of_rules = outcomes.and_then(|outcomes| outcomes.get(output)?.values);
            let filled = self.estimator.filled_within(&self.point);
            values = of_rules
                .into_iter()
                .chain(filled)
                .fold(values, Interval::hull);
        }
        let Interval { low, high } = values.within(Interval::new(0.0, 100.0));
        Some(RiskInterval {
            low_pct: low,
            high_pct: high,
        })
    }
}

state! {
    struct UncertainRisk { estimate, inputs }
    struct UncertainPeak { from_s, value_pct, risk }
    struct RiskInterval { low_pct, high_pct }
}
