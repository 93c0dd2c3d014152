//! The area and moment of a part of a prepared set, and the interval of the centroids between two prepared sets.

use super::{SetArrays, SetSegment};
use crate::table::closed_reduction::{Summary, closed};
use crate::table::operators::{larger, smaller};
use crate::table::reduction::both_ends;
use crate::table::{Arrays, Flank, Output, ShapeKind, TypeReduction, centroid};

/// Returns the ends of the interval that a type reduction gives for the sets of `upper` and `lower`; `None` if the
/// upper set is empty.
pub(in crate::table) fn interval<A: Arrays>(
    table: &A,
    method: TypeReduction,
    (upper, upper_strengths): (&Output, &[f64]),
    (lower, lower_strengths): (&Output, &[f64]),
) -> Option<(f64, f64)> {
    let range = (upper.low, upper.high);
    let (upper, lower) = (SetArrays::of(table, upper)?, SetArrays::of(table, lower)?);
    let whole = |set: &SetArrays<'_>, strengths: &[f64]| {
        let (area, moment) = set.integrals(strengths);
        Some((area, centroid(area, moment, set.measure.origin)?))
    };
    let summary = Summary {
        lower: whole(&lower, lower_strengths),
        upper: whole(&upper, upper_strengths)?,
        support: upper.support(upper_strengths),
    };
    if method != TypeReduction::Exact {
        return closed(method, summary);
    }
    if summary.lower.is_none() {
        return Some(summary.support);
    }
    Some(both_ends(summary.upper.1, range, |end, x| {
        let (of_upper, of_lower) = end.parts(x);
        let (a, m) = upper.between(upper_strengths, of_upper);
        let (b, n) = lower.between(lower_strengths, of_lower);
        (a + b, m + n - (a + b) * (x - upper.measure.origin))
    }))
}

impl SetArrays<'_> {
    /// Returns the ends of the interval on which the set is above 0.
    fn support(&self, strengths: &[f64]) -> (f64, f64) {
        let fired = self.terms.iter().zip(strengths).filter(|(_, h)| **h > 0.0);
        let flanks = fired.flat_map(|(term, _)| self.flanks_of(term));
        flanks.fold((f64::INFINITY, f64::NEG_INFINITY), |(from, to), flank| {
            (smaller(from, flank.from), larger(to, flank.to))
        })
    }

    /// Returns the area between two values, and the moment about the origin.
    fn between(&self, strengths: &[f64], span: (f64, f64)) -> (f64, f64) {
        let (mut area, mut moment) = (0.0, 0.0);
        let mut add = |(a, m): (f64, f64)| {
            area += a;
            moment += m;
        };
        if self.set.sum != 0 {
            for (term, &strength) in self.terms.iter().zip(strengths) {
                if strength > 0.0 {
                    for flank in self.flanks_of(term) {
                        add(self.flank_between(flank, strength, span));
                    }
                }
            }
        } else {
            for section in self.sections {
                if section.from < span.1 && span.0 < section.to {
                    self.parts(section, strengths, |part| {
                        add(self.part_between(&part, span))
                    });
                }
            }
        }
        (area, moment)
    }

    /// Works like [`SetArrays::between`], for a part of the set.
    fn part_between(&self, part: &SetSegment<'_>, span: (f64, f64)) -> (f64, f64) {
        if span.0 <= part.from && part.to <= span.1 {
            return (part.area, part.moment);
        }
        let common = common((part.from, part.to), span);
        match part.flank {
            None => self.rectangle(common, part.degree),
            Some(flank) => {
                let (area, moment) = self.curve(flank, common);
                (part.degree * area, part.degree * moment)
            }
        }
    }

    /// Works like [`SetArrays::between`], for a flank that is cut or scaled, as if it were the only one.
    fn flank_between(&self, flank: &Flank, strength: f64, span: (f64, f64)) -> (f64, f64) {
        if span.0 <= flank.from && flank.to <= span.1 {
            return self.of_single_flank(flank, strength);
        }
        let common = common((flank.from, flank.to), span);
        if self.scales {
            let (area, moment) = self.curve(flank, common);
            return (strength * area, strength * moment);
        }
        let clip = flank.clip(strength);
        let (slope, plateau) = match flank.foot().0 <= flank.summit().0 {
            true => (
                (common.0, smaller(clip, common.1)),
                (larger(clip, common.0), common.1),
            ),
            false => (
                (larger(clip, common.0), common.1),
                (common.0, smaller(clip, common.1)),
            ),
        };
        let (curve, level) = (self.curve(flank, slope), self.rectangle(plateau, strength));
        (curve.0 + level.0, curve.1 + level.1)
    }

    /// Returns the area and moment below a flank between two values.
    fn curve(&self, flank: &Flank, (from, to): (f64, f64)) -> (f64, f64) {
        if from >= to {
            return (0.0, 0.0);
        }
        let (left, right) = (flank.degree(from), flank.degree(to));
        if flank.kind == ShapeKind::PIECEWISE {
            return self.measure.trapezoid((from, left), (to, right));
        }
        let tail = |x, degree| flank.tail(self.knots, self.measure, x, degree);
        let ((a, m), (b, n)) = (tail(from, left), tail(to, right));
        match flank.right < flank.left {
            true => (a - b, m - n),
            false => (b - a, n - m),
        }
    }

    fn rectangle(&self, (from, to): (f64, f64), degree: f64) -> (f64, f64) {
        match from < to {
            true => self.measure.rectangle(from, to, degree),
            false => (0.0, 0.0),
        }
    }
}

fn common(one: (f64, f64), other: (f64, f64)) -> (f64, f64) {
    (larger(one.0, other.0), smaller(one.1, other.1))
}
