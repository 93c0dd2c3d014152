//! Type reductions with a closed form: approximations of the interval of centroids, from the centroids of the lower and
//! the upper set.
//!
//! With the areas L and U of the lower and the upper set, their centroids l and u, and the support [a, b] of the upper
//! set:
//!
//! - Nie and Tan (Towards an efficient type-reduction method for interval type-2 fuzzy logic systems, FUZZ-IEEE 2008):
//!   `(L l + U u) / (L + U)`, the centroid of the mean of both sets.
//! - Begian, Melek and Mendel (Stability analysis of type-2 fuzzy systems, FUZZ-IEEE 2008): `(l + u) / 2`.
//! - Wu and Mendel (Uncertainty bounds and their use in the design of interval type-2 fuzzy logic systems, IEEE
//!   Transactions on Fuzzy Systems 10, 2002): the left end of the exact interval lies between `min(l, u)` and
//!   `min(l, u) - (U - L) / (U L) * A B / (A + B)` with `A = L (l - a)` and `B = U (b - u)`; the right end between
//!   `max(l, u)` and `max(l, u) + (U - L) / (U L) * C D / (C + D)` with `C = U (u - a)` and `D = L (b - l)`. Each end is
//!   the middle of its two bounds.
//!
//! Sums over samples in these papers are integrals here. For weighted outputs they are sums over the terms.

use super::TypeReduction;
use super::operators::{larger, smaller};

/// A summary of an interval type-2 set or of weighted numbers.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Summary {
    /// The area and the centroid of the lower set; `None` if it is empty.
    pub(crate) lower: Option<(f64, f64)>,
    /// The area and the centroid of the upper set.
    pub(crate) upper: (f64, f64),
    /// The ends of the interval on which the upper set is above 0.
    pub(crate) support: (f64, f64),
}

/// Returns the ends of the interval that a type reduction gives; they are equal for a method that gives a single value.
/// If the lower set is empty, the result is the centroid of the upper set or, for a method that gives an interval, the
/// support. `None` for the exact interval, which cannot be computed from the summary.
pub(crate) fn closed(method: TypeReduction, summary: Summary) -> Option<(f64, f64)> {
    let Summary {
        lower,
        upper: (upper_area, upper),
        support,
    } = summary;
    let number = |number: f64| Some((number, number));
    match (method, lower) {
        (TypeReduction::Exact, _) => None,
        (TypeReduction::NieTan | TypeReduction::BegianMelekMendel, None) => number(upper),
        (TypeReduction::WuMendel, None) => Some(support),
        (TypeReduction::NieTan, Some((lower_area, lower))) => {
            // The weighted mean is computed as a shift of `lower`, so that no digits are lost far from 0.
            number(lower + (upper - lower) * (upper_area / (lower_area + upper_area)))
        }
        (TypeReduction::BegianMelekMendel, Some((_, lower))) => {
            number(lower + 0.5 * (upper - lower))
        }
        (TypeReduction::WuMendel, Some((lower_area, lower))) => {
            let share = (upper_area - lower_area) / upper_area / lower_area;
            let reach = |one: f64, other: f64| match one + other > 0.0 {
                true => larger(0.0, share) * (one * (other / (one + other))),
                false => 0.0,
            };
            let (first, last) = support;
            let left = reach(lower_area * (lower - first), upper_area * (last - upper));
            let right = reach(upper_area * (upper - first), lower_area * (last - lower));
            // No centroid is outside the support.
            let low = larger(first, smaller(lower, upper) - 0.5 * left);
            let high = smaller(last, larger(lower, upper) + 0.5 * right);
            Some((low, high))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOTH: Summary = Summary {
        lower: Some((2.0, 3.0)),
        upper: (6.0, 5.0),
        support: (1.0, 9.0),
    };

    #[test]
    fn type_reductions_equal_values_computed_by_hand() {
        assert_eq!(closed(TypeReduction::NieTan, BOTH), Some((4.5, 4.5)));
        assert_eq!(
            closed(TypeReduction::BegianMelekMendel, BOTH),
            Some((4.0, 4.0))
        );
        // (U - L) / (U L) is 1/3. A is 4, B is 24, C is 24 and D is 12.
        let (low, high) = closed(TypeReduction::WuMendel, BOTH).unwrap();
        assert!(
            (low - (3.0 - 0.5 * (4.0 * 24.0 / 28.0) / 3.0)).abs() < 1e-15,
            "{low}"
        );
        assert!(
            (high - (5.0 + 0.5 * (24.0 * 12.0 / 36.0) / 3.0)).abs() < 1e-15,
            "{high}"
        );
        assert_eq!(closed(TypeReduction::Exact, BOTH), None);
    }

    #[test]
    fn without_a_lower_set_and_with_equal_sets() {
        let empty = Summary {
            lower: None,
            ..BOTH
        };
        assert_eq!(closed(TypeReduction::NieTan, empty), Some((5.0, 5.0)));
        assert_eq!(
            closed(TypeReduction::BegianMelekMendel, empty),
            Some((5.0, 5.0))
        );
        assert_eq!(closed(TypeReduction::WuMendel, empty), Some((1.0, 9.0)));
        let equal = Summary {
            lower: Some(BOTH.upper),
            ..BOTH
        };
        for method in [
            TypeReduction::NieTan,
            TypeReduction::BegianMelekMendel,
            TypeReduction::WuMendel,
        ] {
            assert_eq!(closed(method, equal), Some((5.0, 5.0)));
        }
    }
}
