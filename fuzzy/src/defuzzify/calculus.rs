//! Properties of the operators that the integrator needs: their derivatives, the positions of kinks and steps, and
//! whether straight lines stay straight between these.

use crate::model::{Aggregation, Implication};
use crate::table::MIN_STRENGTH;

/// A degree, with its slope along the output's range.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct SlopedDegree {
    pub(super) degree: f64,
    pub(super) slope: f64,
}

/// Returns the activated degree of a membership at a firing strength.
pub(super) fn activate(
    implication: Implication,
    strength: f64,
    membership: SlopedDegree,
) -> SlopedDegree {
    let (h, m) = (strength, membership.degree);
    if implication == Implication::Drastic && 1.0 - h > MIN_STRENGTH && membership.slope != 0.0 {
        // The result is above 0 only at the peak, which is a single point.
        return SlopedDegree::default();
    }
    let degree = implication.of(h, m);
    let by_membership = match implication {
        Implication::Product => h,
        Implication::Einstein => {
            // The derivative of h m / (1 + (1 - h) (1 - m)).
            let below = 1.0 + (1.0 - h) * (1.0 - m);
            h * (2.0 - h) / (below * below)
        }
        Implication::Hamacher => {
            // The derivative of h m / (h + m - h m).
            let share = h / (h + m * (1.0 - h));
            share * share
        }
        Implication::BoundedDifference if degree > 0.0 => 1.0,
        Implication::Minimum | Implication::Drastic | Implication::NilpotentMinimum
            if degree == m =>
        {
            1.0
        }
        Implication::BoundedDifference
        | Implication::Minimum
        | Implication::Drastic
        | Implication::NilpotentMinimum => 0.0,
    };
    SlopedDegree {
        degree,
        slope: by_membership * membership.slope,
    }
}

/// Returns the aggregation of two activated degrees.
pub(super) fn aggregate(
    aggregation: Aggregation,
    a: SlopedDegree,
    b: SlopedDegree,
) -> SlopedDegree {
    let (x, y) = (a.degree, b.degree);
    let degree = aggregation.of(x, y);
    // The partial derivatives with respect to x and y.
    let (by_x, by_y) = match aggregation {
        Aggregation::Sum => (1.0, 1.0),
        Aggregation::ProbabilisticSum => (1.0 - y, 1.0 - x),
        // A sum of exactly 1 is not limited yet.
        Aggregation::BoundedSum if x + y <= 1.0 => (1.0, 1.0),
        Aggregation::Einstein => {
            let below = (1.0 + x * y) * (1.0 + x * y);
            ((1.0 - y) * (1.0 + y) / below, (1.0 - x) * (1.0 + x) / below)
        }
        Aggregation::Hamacher if x * y < 1.0 => {
            let (first, second) = ((1.0 - y) / (1.0 - x * y), (1.0 - x) / (1.0 - x * y));
            (first * first, second * second)
        }
        Aggregation::Maximum | Aggregation::Drastic | Aggregation::NilpotentMaximum
            if degree == x && x > y =>
        {
            (1.0, 0.0)
        }
        Aggregation::Maximum | Aggregation::Drastic | Aggregation::NilpotentMaximum
            if degree == y =>
        {
            (0.0, 1.0)
        }
        Aggregation::BoundedSum
        | Aggregation::Hamacher
        | Aggregation::Maximum
        | Aggregation::Drastic
        | Aggregation::NilpotentMaximum => (0.0, 0.0),
    };
    SlopedDegree {
        degree,
        slope: by_x * a.slope + by_y * b.slope,
    }
}

/// Returns the degrees of membership at which a term activated at a strength has a kink or a step.
pub(super) fn levels(implication: Implication, strength: f64) -> [Option<f64>; 2] {
    match implication {
        Implication::Minimum => [Some(strength), None],
        Implication::BoundedDifference => [Some(1.0 - strength), None],
        Implication::NilpotentMinimum => [Some(strength), Some(1.0 - strength + MIN_STRENGTH)],
        Implication::Product
        | Implication::Drastic
        | Implication::Einstein
        | Implication::Hamacher => [None, None],
    }
}

/// Returns an implication without steps. Between two levels, it gives the same degrees as `implication` wherever
/// the activated term is not constant.
pub(super) fn between_levels(implication: Implication) -> Implication {
    match implication {
        Implication::Drastic | Implication::NilpotentMinimum => Implication::Minimum,
        Implication::Minimum
        | Implication::Product
        | Implication::BoundedDifference
        | Implication::Einstein
        | Implication::Hamacher => implication,
    }
}

/// Returns whether a straight term stays straight between two levels.
pub(super) fn keeps_lines(implication: Implication) -> bool {
    match implication {
        Implication::Minimum
        | Implication::Product
        | Implication::BoundedDifference
        | Implication::Drastic
        | Implication::NilpotentMinimum => true,
        Implication::Einstein | Implication::Hamacher => false,
    }
}

/// The kinks and steps of an aggregated set between the levels of its activated terms.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kinks {
    /// No kinks and no steps.
    None,
    /// At the crossings of two terms.
    Crossings,
    /// At the crossings of two terms, and where their sum reaches 1.
    CrossingsAndSteps,
    /// Where a term reaches the least firing strength.
    Steps,
    /// Where the sum of all terms reaches 1.
    Bound,
}

impl Kinks {
    pub(super) fn of(aggregation: Aggregation) -> Self {
        match aggregation {
            Aggregation::Maximum => Kinks::Crossings,
            Aggregation::NilpotentMaximum => Kinks::CrossingsAndSteps,
            Aggregation::Drastic => Kinks::Steps,
            Aggregation::BoundedSum => Kinks::Bound,
            Aggregation::Sum
            | Aggregation::ProbabilisticSum
            | Aggregation::Einstein
            | Aggregation::Hamacher => Kinks::None,
        }
    }
}

/// The properties of an aggregation between its kinks and steps.
#[derive(Debug, Clone, Copy)]
pub(super) struct Smooth {
    /// An aggregation that gives the same degrees as the aggregation of the output, except beyond a step, where the
    /// degree of the output is 1.
    pub(super) aggregation: Aggregation,
    /// Whether the aggregated degree jumps to 1 at some positions.
    pub(super) has_steps: bool,
    /// Whether an aggregation of straight terms is straight between the kinks and steps.
    pub(super) keeps_lines: bool,
}

impl Smooth {
    pub(super) fn of(aggregation: Aggregation) -> Self {
        let (between, keeps_lines) = match aggregation {
            Aggregation::Maximum | Aggregation::Sum | Aggregation::BoundedSum => {
                (aggregation, true)
            }
            Aggregation::NilpotentMaximum => (Aggregation::Maximum, true),
            // If one of the degrees is below the least strength, the result is the larger degree. Two terms may cross
            // in this region without a cut at the crossing, so the set may have a kink there.
            Aggregation::Drastic => (Aggregation::Maximum, false),
            Aggregation::ProbabilisticSum | Aggregation::Einstein | Aggregation::Hamacher => {
                (aggregation, false)
            }
        };
        Smooth {
            aggregation: between,
            has_steps: between != aggregation,
            keeps_lines,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Conjunction;

    const DEGREES: [f64; 6] = [0.05, 0.2, 0.31, 0.52, 0.77, 0.93];
    const STEP: f64 = 1e-6;

    fn sloped(degree: f64, slope: f64) -> SlopedDegree {
        SlopedDegree { degree, slope }
    }

    #[test]
    fn derivatives_of_implications_equal_differences() {
        for implication in Conjunction::ALL {
            for h in DEGREES {
                for m in DEGREES.map(|m| m + 0.001) {
                    let at = |m: f64| implication.of(h, m);
                    let difference = (at(m + STEP) - at(m - STEP)) / (2.0 * STEP);
                    let slope = activate(implication, h, sloped(m, 3.0)).slope;
                    let expected = 3.0 * difference;
                    assert!((slope - expected).abs() < 1e-8, "{implication:?} {h} {m}");
                }
            }
        }
    }

    #[test]
    fn derivatives_of_aggregations_equal_differences() {
        for aggregation in Aggregation::ALL {
            for x in DEGREES {
                for y in DEGREES.map(|y| y + 0.001) {
                    let at = |t: f64| aggregation.of(x + 2.0 * t, y - 0.7 * t);
                    let difference = (at(STEP) - at(-STEP)) / (2.0 * STEP);
                    let slope = aggregate(aggregation, sloped(x, 2.0), sloped(y, -0.7)).slope;
                    assert!((slope - difference).abs() < 1e-8, "{aggregation:?} {x} {y}");
                }
            }
        }
    }
}
