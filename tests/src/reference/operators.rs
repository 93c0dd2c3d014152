//! Hedges, norms and aggregations, by their formulas.

use fuzzy::model::{Aggregation, Conjunction, Disjunction};
use fuzzy::rule::Hedge;

use super::number::Number;

pub(super) fn hedged(hedges: &[Hedge], mut x: f64) -> f64 {
    for hedge in hedges.iter().rev() {
        x = match hedge {
            Hedge::Not => 1.0 - x,
            Hedge::Very => x.powi(2),
            Hedge::Somewhat => x.sqrt(),
            Hedge::Extremely if x <= 0.5 => 2.0 * x.powi(2),
            Hedge::Extremely => 1.0 - 2.0 * (1.0 - x).powi(2),
            Hedge::Seldom if x <= 0.5 => (x / 2.0).sqrt(),
            Hedge::Seldom => 1.0 - ((1.0 - x) / 2.0).sqrt(),
            Hedge::Any => 1.0,
        };
    }
    x
}

/// Tolerance of operators with a step: values this close to the step are on it, and degrees this close are equal.
pub(super) const ROUNDING: f64 = 1e-12;

pub(super) fn and<T: Number>(operator: Conjunction, a: T, b: T) -> T {
    let (x, y, one) = (a.value(), b.value(), T::of(1.0));
    match operator {
        Conjunction::Minimum => a.min(b),
        Conjunction::Product => a * b,
        Conjunction::BoundedDifference => (a + b - one).max(T::of(0.0)),
        Conjunction::Drastic if x.max(y) >= 1.0 - ROUNDING => a.min(b),
        Conjunction::Drastic => T::of(0.0),
        Conjunction::Einstein => a * b / (T::of(2.0) - (a + b - a * b)),
        Conjunction::Hamacher if x + y == 0.0 => T::of(0.0),
        Conjunction::Hamacher => a * b / (a + b - a * b),
        Conjunction::NilpotentMinimum if x + y - 1.0 > ROUNDING || x.max(y) == 1.0 => a.min(b),
        Conjunction::NilpotentMinimum => T::of(0.0),
    }
}

pub(super) fn or<T: Number>(operator: Disjunction, a: T, b: T) -> T {
    let (x, y, one) = (a.value(), b.value(), T::of(1.0));
    match operator {
        Disjunction::Maximum => a.max(b),
        Disjunction::ProbabilisticSum => a + b - a * b,
        Disjunction::BoundedSum => (a + b).min(one),
        Disjunction::Drastic if x.min(y) <= ROUNDING => a.max(b),
        Disjunction::Drastic => one,
        Disjunction::Einstein => (a + b) / (one + a * b),
        Disjunction::Hamacher if x == 1.0 || y == 1.0 => one,
        Disjunction::Hamacher => (a * (one - b) + b * (one - a)) / (one - a * b),
        Disjunction::NilpotentMaximum if 1.0 - x - y > ROUNDING || x.min(y) == 0.0 => a.max(b),
        Disjunction::NilpotentMaximum => one,
    }
}

/// Aggregates two activated degrees.
pub(super) fn aggregate<T: Number>(aggregation: Aggregation, a: T, b: T) -> T {
    match aggregation {
        Aggregation::Maximum => a.max(b),
        Aggregation::ProbabilisticSum => or(Disjunction::ProbabilisticSum, a, b),
        Aggregation::BoundedSum => or(Disjunction::BoundedSum, a, b),
        Aggregation::Sum => a + b,
        Aggregation::Drastic => or(Disjunction::Drastic, a, b),
        Aggregation::Einstein => or(Disjunction::Einstein, a, b),
        Aggregation::Hamacher => or(Disjunction::Hamacher, a, b),
        Aggregation::NilpotentMaximum => or(Disjunction::NilpotentMaximum, a, b),
    }
}

/// Whether a strength does not cut off any part of a term.
pub(super) fn is_whole(strength: f64, highest: f64) -> bool {
    strength >= highest * (1.0 - ROUNDING)
}
