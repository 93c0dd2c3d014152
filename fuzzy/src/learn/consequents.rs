//! Assignment of output values to terms of the output.

use alloc::vec::Vec;

use crate::model::{MembershipFunction, Variable};

/// The peaks of the terms of the output.
#[derive(Debug, Clone)]
pub(super) struct Consequents {
    /// The value of each term that is a number, or the peak of each fuzzy set.
    pub(super) peaks: Vec<f64>,
    /// Whether all terms are numbers (constants or singletons). A value between two numbers belongs to both of them, with
    /// degrees that depend on the distances.
    are_numbers: bool,
}

impl Consequents {
    pub(super) fn of(output: &Variable) -> Consequents {
        let shapes = || output.terms.iter().map(|term| &term.membership_function);
        Consequents {
            peaks: shapes()
                .map(|shape| number(shape).unwrap_or_else(|| output.peak(shape)))
                .collect(),
            are_numbers: shapes().all(|shape| number(shape).is_some()),
        }
    }

    /// Returns the index of the term with the highest degree at a value, and this degree. If several terms have
    /// that degree, the first one is returned. `None` if all degrees are 0.
    pub(super) fn highest(&self, output: &Variable, value: f64) -> Option<(u16, f64)> {
        if !self.are_numbers {
            return highest(output, value);
        }
        let term = self.nearest_peak(value);
        let at = *self.peaks.get(usize::from(term))?;
        // The neighbouring peak on the other side of the value.
        let others = self.peaks.iter().filter(|other| match value < at {
            true => **other < at,
            false => **other > at,
        });
        let gap = others.map(|other| (other - at).abs()).reduce(f64::min);
        let degree = gap.map_or(1.0, |gap| 1.0 - (value - at).abs() / gap);
        Some((term, degree))
    }

    /// Works like [`Consequents::highest`], but returns the term with the nearest peak if all degrees are 0.
    pub(super) fn nearest(&self, output: &Variable, value: f64) -> u16 {
        let highest = self.highest(output, value);
        highest.map_or_else(|| self.nearest_peak(value), |(term, _)| term)
    }

    fn nearest_peak(&self, value: f64) -> u16 {
        let mut nearest = (0, f64::INFINITY);
        for (term, peak) in (0..=u16::MAX).zip(&self.peaks) {
            let distance = (peak - value).abs();
            if distance < nearest.1 {
                nearest = (term, distance);
            }
        }
        nearest.0
    }
}

fn number(shape: &MembershipFunction) -> Option<f64> {
    shape.number().or_else(|| shape.at())
}

/// Returns the index of the term with the highest membership, and this membership. If several terms have that
/// membership, the first one is returned. `None` if all memberships are 0.
pub(super) fn highest(variable: &Variable, value: f64) -> Option<(u16, f64)> {
    let mut best: Option<(u16, f64)> = None;
    for (i, term) in (0..=u16::MAX).zip(&variable.terms) {
        let membership = term.height * term.membership_function.membership(value);
        if membership > best.map_or(0.0, |(_, highest)| highest) {
            best = Some((i, membership));
        }
    }
    best
}
