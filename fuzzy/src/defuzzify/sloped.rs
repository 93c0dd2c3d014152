//! Degrees with their slopes: the derivatives of implications and aggregations.

use crate::model::{Aggregation, Implication};
use crate::table::LEAST_STRENGTH;

/// A degree and its slope along the output's range.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Sloped {
    pub(super) degree: f64,
    pub(super) slope: f64,
}

/// A membership under a firing strength.
pub(super) fn activate(implication: Implication, strength: f64, membership: Sloped) -> Sloped {
    let (h, m) = (strength, membership.degree);
    if implication == Implication::Drastic && 1.0 - h > LEAST_STRENGTH && membership.slope != 0.0 {
        // Of a peak, a single point is left.
        return Sloped::default();
    }
    let degree = implication.of(h, m);
    let by_membership = match implication {
        Implication::Product => h,
        Implication::Einstein => {
            // Of h m / (1 + (1 - h) (1 - m)).
            let below = 1.0 + (1.0 - h) * (1.0 - m);
            h * (2.0 - h) / (below * below)
        }
        Implication::Hamacher => {
            // Of h m / (h + m - h m).
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
    Sloped {
        degree,
        slope: by_membership * membership.slope,
    }
}

/// Two activated degrees aggregated.
pub(super) fn aggregate(aggregation: Aggregation, a: Sloped, b: Sloped) -> Sloped {
    let (x, y) = (a.degree, b.degree);
    let degree = aggregation.of(x, y);
    // The derivatives by x and by y.
    let (by_x, by_y) = match aggregation {
        Aggregation::Sum => (1.0, 1.0),
        Aggregation::ProbabilisticSum => (1.0 - y, 1.0 - x),
        // Where the sum is 1 but for rounding, it is not cut off.
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
    Sloped {
        degree,
        slope: by_x * a.slope + by_y * b.slope,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Conjunction;

    const DEGREES: [f64; 6] = [0.05, 0.2, 0.31, 0.52, 0.77, 0.93];
    const STEP: f64 = 1e-6;

    fn sloped(degree: f64, slope: f64) -> Sloped {
        Sloped { degree, slope }
    }

    #[test]
    fn implications_as_by_differences() {
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
    fn aggregations_as_by_differences() {
        for aggregation in [
            Aggregation::Maximum,
            Aggregation::Sum,
            Aggregation::ProbabilisticSum,
            Aggregation::BoundedSum,
            Aggregation::Drastic,
            Aggregation::Einstein,
            Aggregation::Hamacher,
            Aggregation::NilpotentMaximum,
        ] {
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
