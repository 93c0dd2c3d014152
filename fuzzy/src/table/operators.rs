//! Operators and hedges.

use core::hint::select_unpredictable;

use super::MIN_STRENGTH;

/// The AND of two degrees: a t-norm.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Conjunction {
    /// `min(a, b)`.
    #[default]
    Minimum,
    /// `a b`.
    Product,
    /// `max(0, a + b - 1)` (Lukasiewicz).
    BoundedDifference,
    /// `min(a, b)` if one of them is 1 up to rounding (1e-12), else 0.
    Drastic,
    /// `a b / (2 - (a + b - a b))`.
    Einstein,
    /// `a b / (a + b - a b)`; 0 if both are 0.
    Hamacher,
    /// `min(a, b)` if `a + b > 1` by more than rounding (1e-12) or one of them is 1, else 0.
    NilpotentMinimum,
}

/// The OR of two degrees: an s-norm.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Disjunction {
    /// `max(a, b)`.
    #[default]
    Maximum,
    /// `a + b - a b`.
    ProbabilisticSum,
    /// `min(1, a + b)`.
    BoundedSum,
    /// `max(a, b)` if one of them is 0 up to rounding (1e-12), else 1.
    Drastic,
    /// `(a + b) / (1 + a b)`.
    Einstein,
    /// `(a + b - 2 a b) / (1 - a b)`; 1 if both are 1.
    Hamacher,
    /// `max(a, b)` if `a + b < 1` by more than rounding (1e-12) or one of them is 0, else 1.
    NilpotentMaximum,
}

/// The function that activates a consequent with membership `m` at firing strength `h`: a t-norm, such as `min(h, m)`
/// (Mamdani) or `h m` (Larsen).
pub type Implication = Conjunction;

/// The function that aggregates the activated consequents of an output.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Aggregation {
    /// `max(a, b)`.
    #[default]
    Maximum,
    /// `a + b - a b`.
    ProbabilisticSum,
    /// `min(1, a + b)`.
    BoundedSum,
    /// `a + b`, unbounded.
    Sum,
    /// `max(a, b)` if one of them is 0 up to rounding (1e-12), else 1.
    Drastic,
    /// `(a + b) / (1 + a b)`.
    Einstein,
    /// `(a + b - 2 a b) / (1 - a b)`; 1 if both are 1.
    Hamacher,
    /// `max(a, b)` if `a + b < 1` by more than rounding (1e-12) or one of them is 0, else 1.
    NilpotentMaximum,
}

/// A hedge: a function that changes a degree `x`. Of several hedges, the one nearest to the term is applied first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u32)]
pub enum Hedge {
    /// `1 - x`.
    Not,
    /// `x^2` (concentration, Zadeh 1972).
    Very,
    /// `x^(1/2)` (dilation, Zadeh 1972).
    Somewhat,
    /// `2 x^2` up to 0.5, `1 - 2 (1 - x)^2` above (contrast intensification).
    Extremely,
    /// `(x/2)^(1/2)` up to 0.5, `1 - ((1 - x)/2)^(1/2)` above.
    Seldom,
    /// The constant 1.
    Any,
}

impl Conjunction {
    /// All conjunctions, in the order of their codes in exported data.
    pub const ALL: [Conjunction; 7] = [
        Conjunction::Minimum,
        Conjunction::Product,
        Conjunction::BoundedDifference,
        Conjunction::Drastic,
        Conjunction::Einstein,
        Conjunction::Hamacher,
        Conjunction::NilpotentMinimum,
    ];
}

impl Disjunction {
    /// All disjunctions, in the order of their codes in exported data.
    pub const ALL: [Disjunction; 7] = [
        Disjunction::Maximum,
        Disjunction::ProbabilisticSum,
        Disjunction::BoundedSum,
        Disjunction::Drastic,
        Disjunction::Einstein,
        Disjunction::Hamacher,
        Disjunction::NilpotentMaximum,
    ];
}

impl Aggregation {
    /// All aggregations.
    pub const ALL: [Aggregation; 8] = [
        Aggregation::Maximum,
        Aggregation::ProbabilisticSum,
        Aggregation::BoundedSum,
        Aggregation::Sum,
        Aggregation::Drastic,
        Aggregation::Einstein,
        Aggregation::Hamacher,
        Aggregation::NilpotentMaximum,
    ];
}

impl Hedge {
    /// All hedges.
    pub const ALL: [Hedge; 6] = [
        Hedge::Not,
        Hedge::Very,
        Hedge::Somewhat,
        Hedge::Extremely,
        Hedge::Seldom,
        Hedge::Any,
    ];

    /// Returns whether the hedge is allowed in a conclusion: it maps a strength of 0 to 0, so that a rule that does not
    /// fire has no effect.
    #[must_use]
    pub fn may_conclude(self) -> bool {
        !matches!(self, Hedge::Not | Hedge::Any)
    }

    /// Returns the word for the hedge in the rule language.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Hedge::Not => "NOT",
            Hedge::Very => "very",
            Hedge::Somewhat => "somewhat",
            Hedge::Extremely => "extremely",
            Hedge::Seldom => "seldom",
            Hedge::Any => "any",
        }
    }
}

/// Returns the smaller of two numbers that are not NaN. Unlike `f64::min` it takes one instruction, and it never
/// branches.
#[inline(always)]
pub(crate) fn smaller(a: f64, b: f64) -> f64 {
    select_unpredictable(a < b, a, b)
}

/// Returns the larger of two numbers that are not NaN.
#[inline(always)]
pub(crate) fn larger(a: f64, b: f64) -> f64 {
    select_unpredictable(a > b, a, b)
}

impl Conjunction {
    /// Returns the AND of two degrees in [0, 1]; 0 AND anything is 0.
    #[inline(always)]
    pub(crate) fn of(self, a: f64, b: f64) -> f64 {
        match self {
            Conjunction::Minimum => smaller(a, b),
            Conjunction::Product => a * b,
            // `a + b - 1` would lose digits of a small degree.
            Conjunction::BoundedDifference => larger(0.0, smaller(a, b) - (1.0 - larger(a, b))),
            Conjunction::Drastic => {
                if 1.0 - larger(a, b) <= MIN_STRENGTH {
                    smaller(a, b)
                } else {
                    0.0
                }
            }
            Conjunction::Einstein => a * b / (1.0 + (1.0 - a) * (1.0 - b)),
            Conjunction::Hamacher => {
                let (small, large) = (smaller(a, b), larger(a, b));
                if small == 0.0 {
                    0.0
                } else {
                    // The factor is at most 1; the product of two small degrees would underflow.
                    small * (large / (large + small * (1.0 - large)))
                }
            }
            Conjunction::NilpotentMinimum => {
                // If b was computed as `1 - a`, `a + b` may differ from 1 by rounding.
                let (small, large) = (smaller(a, b), larger(a, b));
                if large == 1.0 || small - (1.0 - large) > MIN_STRENGTH {
                    small
                } else {
                    0.0
                }
            }
        }
    }
}

impl Disjunction {
    /// Returns the OR of two degrees in [0, 1]; 0 OR `a` is `a`.
    #[inline(always)]
    pub(crate) fn of(self, a: f64, b: f64) -> f64 {
        match self {
            Disjunction::Maximum => larger(a, b),
            Disjunction::ProbabilisticSum => probabilistic_sum(a, b),
            Disjunction::BoundedSum => smaller(1.0, a + b),
            Disjunction::Drastic => {
                if smaller(a, b) <= MIN_STRENGTH {
                    larger(a, b)
                } else {
                    1.0
                }
            }
            Disjunction::Einstein => smaller(1.0, (a + b) / (1.0 + a * b)),
            Disjunction::Hamacher => {
                if a * b == 1.0 {
                    1.0
                } else {
                    // (a + b - 2ab) / (1 - ab), without cancellation.
                    smaller(1.0, (a * (1.0 - b) + b * (1.0 - a)) / (1.0 - a * b))
                }
            }
            Disjunction::NilpotentMaximum => {
                let (small, large) = (smaller(a, b), larger(a, b));
                if small == 0.0 || (1.0 - large) - small > MIN_STRENGTH {
                    large
                } else {
                    1.0
                }
            }
        }
    }
}

/// Returns `a + b - a b`, computed as `a + b (1 - a)`, which stays in [0, 1] up to rounding.
#[inline(always)]
pub(crate) fn probabilistic_sum(a: f64, b: f64) -> f64 {
    smaller(1.0, a + b * (1.0 - a))
}

impl Aggregation {
    /// Returns the aggregated degree of two activated consequents.
    #[inline(always)]
    pub(crate) fn of(self, a: f64, b: f64) -> f64 {
        match self {
            Aggregation::Maximum => larger(a, b),
            Aggregation::ProbabilisticSum => probabilistic_sum(a, b),
            Aggregation::BoundedSum => smaller(1.0, a + b),
            Aggregation::Sum => a + b,
            Aggregation::Drastic => Disjunction::Drastic.of(a, b),
            Aggregation::Einstein => Disjunction::Einstein.of(a, b),
            Aggregation::Hamacher => Disjunction::Hamacher.of(a, b),
            Aggregation::NilpotentMaximum => Disjunction::NilpotentMaximum.of(a, b),
        }
    }
}

impl Hedge {
    /// Returns the hedged degree.
    #[must_use]
    pub fn of(self, x: f64) -> f64 {
        match self {
            Hedge::Not => 1.0 - x,
            Hedge::Very => x * x,
            Hedge::Somewhat => libm::sqrt(x),
            Hedge::Extremely => {
                if x <= 0.5 {
                    2.0 * x * x
                } else {
                    1.0 - 2.0 * (1.0 - x) * (1.0 - x)
                }
            }
            Hedge::Seldom => {
                if x <= 0.5 {
                    libm::sqrt(0.5 * x)
                } else {
                    1.0 - libm::sqrt(0.5 * (1.0 - x))
                }
            }
            Hedge::Any => 1.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CONJUNCTIONS: [(Conjunction, f64, f64); Conjunction::ALL.len()] = [
        // The results at (0.5, 0.75) and at (0.25, 0.5), computed by hand.
        (Conjunction::Minimum, 0.5, 0.25),
        (Conjunction::Product, 0.375, 0.125),
        (Conjunction::BoundedDifference, 0.25, 0.0),
        (Conjunction::Drastic, 0.0, 0.0),
        (Conjunction::Einstein, 1.0 / 3.0, 1.0 / 11.0),
        (Conjunction::Hamacher, 3.0 / 7.0, 0.2),
        (Conjunction::NilpotentMinimum, 0.5, 0.0),
    ];

    const DISJUNCTIONS: [(Disjunction, f64, f64); Disjunction::ALL.len()] = [
        (Disjunction::Maximum, 0.75, 0.5),
        (Disjunction::ProbabilisticSum, 0.875, 0.625),
        (Disjunction::BoundedSum, 1.0, 0.75),
        (Disjunction::Drastic, 1.0, 1.0),
        (Disjunction::Einstein, 10.0 / 11.0, 2.0 / 3.0),
        (Disjunction::Hamacher, 0.8, 4.0 / 7.0),
        (Disjunction::NilpotentMaximum, 1.0, 0.5),
    ];

    const DEGREES: [f64; 9] = [0.0, 1e-300, 1e-9, 0.1, 0.3, 0.5, 0.75, 1.0 - 1e-16, 1.0];

    #[test]
    fn norms_equal_values_computed_by_hand() {
        for (and, first, second) in CONJUNCTIONS {
            assert!((and.of(0.5, 0.75) - first).abs() < 1e-15, "{and:?}");
            assert!((and.of(0.25, 0.5) - second).abs() < 1e-15, "{and:?}");
        }
        for (or, first, second) in DISJUNCTIONS {
            assert!((or.of(0.5, 0.75) - first).abs() < 1e-15, "{or:?}");
            assert!((or.of(0.25, 0.5) - second).abs() < 1e-15, "{or:?}");
        }
        for (hedge, at_quarter, at_three_quarters) in [
            (Hedge::Not, 0.75, 0.25),
            (Hedge::Very, 0.0625, 0.5625),
            (Hedge::Somewhat, 0.5, 0.75_f64.sqrt()),
            (Hedge::Extremely, 0.125, 0.875),
            (Hedge::Seldom, 0.125_f64.sqrt(), 1.0 - 0.125_f64.sqrt()),
            (Hedge::Any, 1.0, 1.0),
        ] {
            assert!((hedge.of(0.25) - at_quarter).abs() < 1e-15, "{hedge:?}");
            assert!(
                (hedge.of(0.75) - at_three_quarters).abs() < 1e-15,
                "{hedge:?}"
            );
        }
    }

    #[test]
    fn laws_of_norms() {
        for a in DEGREES {
            for (and, ..) in CONJUNCTIONS {
                assert_eq!(and.of(a, 0.0), 0.0, "{and:?}");
                assert_eq!(and.of(0.0, a), 0.0, "{and:?}");
                assert!((and.of(a, 1.0) - a).abs() <= 1e-16 * a, "{and:?} at {a}");
            }
            for (or, ..) in DISJUNCTIONS {
                assert_eq!(or.of(a, 0.0), a, "{or:?}");
                assert_eq!(or.of(0.0, a), a, "{or:?}");
                assert_eq!(or.of(a, 1.0), 1.0, "{or:?}");
            }
            for b in DEGREES {
                for (and, ..) in CONJUNCTIONS {
                    let both = and.of(a, b);
                    // The inequality holds up to rounding.
                    let most = a.min(b) * (1.0 + 4e-16);
                    assert!(
                        (0.0..=most).contains(&both),
                        "{and:?} of {a} and {b}: {both}"
                    );
                }
                for (or, ..) in DISJUNCTIONS {
                    let any = or.of(a, b);
                    let least = a.max(b) * (1.0 - 4e-16);
                    assert!((least..=1.0).contains(&any), "{or:?} of {a} and {b}: {any}");
                }
            }
        }
    }
}
