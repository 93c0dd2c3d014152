//! The terms that rules conclude, activated and aggregated, and the kinks of the result.

use fuzzy::model::{Aggregation, Conjunction, Operators, Term};

use super::number::{Dual, Number};
use super::operators::{ROUNDING, aggregate, and, is_whole};
use super::shapes::{membership, parameters};

/// Functions of the position in the range of an output, which change their sign where a set has a kink or a step.
pub(super) type Kinks<'a> = Vec<Box<dyn Fn(f64) -> f64 + 'a>>;

/// A term with its strength and its highest degree.
pub(super) type FiredTerm<'m> = (f64, f64, &'m Term);

/// Functions that change their sign where the implication of a term has a kink or a step.
pub(super) fn levels<'a>(fired: &'a [FiredTerm<'a>], operators: Operators) -> Kinks<'a> {
    let mut kinks: Kinks<'a> = Vec::new();
    for (strength, highest, term) in fired {
        let mut levels = match operators.implication {
            Conjunction::Minimum => vec![*strength],
            Conjunction::BoundedDifference => vec![1.0 - strength],
            Conjunction::NilpotentMinimum => vec![*strength, 1.0 - strength + ROUNDING],
            _ => vec![],
        };
        levels.retain(|level| level != strength || !is_whole(*strength, *highest));
        for level in levels {
            let degree = |x: f64| term.height * membership(&term.membership_function, x);
            kinks.push(Box::new(move |x| degree(x) - level));
        }
    }
    kinks
}

/// Functions that change their sign where the aggregation has a kink or a step.
pub(super) fn crossings<'a>(fired: &'a [FiredTerm<'a>], operators: Operators) -> Kinks<'a> {
    let mut kinks: Kinks<'a> = Vec::new();
    for i in 0..fired.len() {
        let part = move |j: usize, x: f64| aggregated(&fired[j..=j], operators, x);
        let before = move |x: f64| aggregated(&fired[..i], operators, x);
        match operators.aggregation {
            Aggregation::Maximum | Aggregation::NilpotentMaximum => {
                for j in 0..i {
                    kinks.push(Box::new(move |x| part(i, x) - part(j, x)));
                }
            }
            Aggregation::BoundedSum => {
                kinks.push(Box::new(move |x| {
                    (0..=i).map(|j| part(j, x)).sum::<f64>() - 1.0
                }));
            }
            Aggregation::Drastic => {
                kinks.push(Box::new(move |x| part(i, x) - ROUNDING));
                kinks.push(Box::new(move |x| before(x) - ROUNDING));
            }
            _ => {}
        }
        if i > 0 && operators.aggregation == Aggregation::NilpotentMaximum {
            kinks.push(Box::new(move |x| {
                let (a, b) = (part(i, x), before(x));
                if a.min(b) > 0.0 {
                    1.0 - a - b - ROUNDING
                } else {
                    1.0
                }
            }));
        }
    }
    kinks
}

/// The degree of an aggregated set of terms, each with its strength and highest degree.
pub(super) fn aggregated<T: Number>(fired: &[FiredTerm<'_>], operators: Operators, x: T) -> T {
    let parts = fired
        .iter()
        .map(|one| activate(operators.implication, *one, x));
    parts.fold(T::of(0.0), |y, part| {
        aggregate(operators.aggregation, y, part)
    })
}

/// The activated degree of a term at `x`. A strength that equals the highest degree of the term, except for rounding,
/// does not cut off any part of the term. If the drastic operator cuts off a term, its plateaus remain, but a single
/// peak does not.
fn activate<T: Number>(
    implication: Conjunction,
    (strength, highest, term): FiredTerm<'_>,
    x: T,
) -> T {
    let degree = T::of(term.height) * membership(&term.membership_function, x);
    let whole = is_whole(strength, highest);
    let activated = and(implication, T::of(strength), degree);
    match implication {
        Conjunction::Minimum if whole => degree,
        Conjunction::NilpotentMinimum if whole && activated.value() > 0.0 => degree,
        Conjunction::Drastic if strength >= 1.0 - ROUNDING => degree,
        Conjunction::Drastic => {
            let at = Dual {
                value: x.value(),
                slope: 1.0,
            };
            let slope = membership(&term.membership_function, at).slope;
            if slope == 0.0 { activated } else { T::of(0.0) }
        }
        _ => activated,
    }
}

/// The highest degree of a term within the range.
pub(super) fn highest(term: &Term, low: f64, high: f64) -> f64 {
    const SAMPLES: usize = 500;
    let of = |x: f64| term.height * membership(&term.membership_function, x);
    let step = (high - low) / SAMPLES as f64;
    let even = (0..=SAMPLES).map(|i| low + step * i as f64);
    let places = parameters(&term.membership_function)
        .into_iter()
        .chain(even);
    let inside = places.filter(|x| low <= *x && *x <= high);
    let best = inside.reduce(|best, x| if of(x) > of(best) { x } else { best });
    let best = best.unwrap_or(low);
    // A maximum between two samples, by ternary search.
    let (mut from, mut to) = ((best - step).max(low), (best + step).min(high));
    for _ in 0..80 {
        let third = (to - from) / 3.0;
        if of(from + third) < of(to - third) {
            from += third;
        } else {
            to -= third;
        }
    }
    of(best).max(of(0.5 * (from + to)))
}
