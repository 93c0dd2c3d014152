//! Single evaluations with the widest vectors of the processor, for rule sets whose conditions are plain ANDs of
//! straight terms, with at most two overlapping terms per input. The operations and their order are the same as in the
//! table, so the results are bitwise equal.

use fearless_simd::f64x4;
use fearless_simd::prelude::*;

use super::arrays::OwnedTable;
use crate::table::{Arrays as _, Axis, Conjunction, Line};

mod plane;
mod regions;
mod uniform;

pub(super) use plane::Plane;
pub(super) use uniform::Uniform;

/// The maximum number of intervals of an input, minus one.
const MAX_CUTS: usize = 8;

/// The limits between the intervals of an input, in ascending order, padded with infinity.
#[derive(Debug, Clone)]
struct Cuts([f64; MAX_CUTS]);

impl Cuts {
    /// Collects the cuts of an axis; `None` if there are too many.
    fn new(table: &OwnedTable, axis: &Axis) -> Option<Self> {
        let given = table
            .cuts
            .get(axis.first_cut as usize..axis.end_cut as usize)?;
        let mut cuts = [f64::INFINITY; MAX_CUTS];
        cuts.get_mut(..given.len())?.copy_from_slice(given);
        Some(Cuts(cuts))
    }

    fn intervals(&self) -> usize {
        1 + self.0.iter().filter(|cut| cut.is_finite()).count()
    }

    /// Returns the index of the interval that contains `x`.
    #[inline(always)]
    fn interval<S: Simd>(&self, simd: S, x: f64) -> usize {
        let mut above = 0;
        for (i, cuts) in self.0.as_chunks().0.iter().enumerate() {
            above |= splat(simd, x).simd_ge(four(simd, cuts)).to_bitmask() << (4 * i);
        }
        // The cuts are in ascending order, so the bits of the cuts at or below `x` are the lowest bits of `above`.
        // Their count is the index of the interval.
        (above + 1).trailing_zeros() as usize
    }
}

/// The conjunctions that are implemented with vectors.
#[derive(Debug, Clone, Copy)]
enum VectorConjunction {
    Minimum,
    Product,
}

impl VectorConjunction {
    fn of(table: &OwnedTable) -> Option<Self> {
        match table.and() {
            Conjunction::Minimum => Some(VectorConjunction::Minimum),
            Conjunction::Product => Some(VectorConjunction::Product),
            Conjunction::BoundedDifference
            | Conjunction::Drastic
            | Conjunction::Einstein
            | Conjunction::Hamacher
            | Conjunction::NilpotentMinimum => None,
        }
    }

    #[inline(always)]
    fn both<S: Simd>(self, one: f64x4<S>, other: f64x4<S>) -> f64x4<S> {
        match self {
            VectorConjunction::Minimum => one.min(other),
            VectorConjunction::Product => one * other,
        }
    }

    /// Combines the degrees of two lines of each of two inputs. With pairs (line of the first input, line of the second
    /// input), the result is in the order (1, 1), (2, 1), (1, 2), (2, 2).
    #[inline(always)]
    fn cells<S: Simd>(self, simd: S, degrees: f64x4<S>) -> f64x4<S> {
        let [a, b, c, d] = degrees.to_array();
        self.both(four(simd, &[a, b, a, b]), four(simd, &[c, c, d, d]))
    }
}

/// Four lines, two of each of two inputs: see [`Line`].
#[derive(Debug, Clone)]
struct Lines {
    base: [f64; 4],
    rise: [f64; 4],
    foot: [f64; 4],
    run: [f64; 4],
}

impl Lines {
    fn new(lines: [Line; 4]) -> Self {
        Lines {
            base: lines.map(|line| line.base),
            rise: lines.map(|line| line.rise),
            foot: lines.map(|line| line.foot),
            run: lines.map(|line| line.run),
        }
    }

    /// Returns the degrees of the lines at the values of the two inputs.
    #[inline(always)]
    fn degrees<S: Simd>(&self, simd: S, [x, y]: [f64; 2]) -> f64x4<S> {
        let at = four(simd, &[x, x, y, y]);
        let along = (at - four(simd, &self.foot)) / four(simd, &self.run);
        four(simd, &self.base) + four(simd, &self.rise) * along
    }
}

/// Returns the two lines of an interval of an axis.
fn lines(table: &OwnedTable, axis: &Axis, interval: usize) -> Option<[Line; 2]> {
    let first = axis.first_line as usize + 2 * interval;
    table.lines.get(first..first + 2)?.try_into().ok()
}

/// Returns the firing strengths, with those below `least` replaced by 0.
#[inline(always)]
fn fires<S: Simd>(simd: S, strengths: f64x4<S>, least: f64) -> f64x4<S> {
    let is_below = strengths.simd_lt(splat(simd, least));
    is_below.select(splat(simd, 0.0), strengths)
}

#[inline(always)]
fn four<S: Simd>(simd: S, numbers: &[f64; 4]) -> f64x4<S> {
    f64x4::simd_from(simd, *numbers)
}

#[inline(always)]
fn splat<S: Simd>(simd: S, number: f64) -> f64x4<S> {
    f64x4::splat(simd, number)
}

#[cfg(test)]
mod tests;
