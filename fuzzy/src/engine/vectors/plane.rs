//! Single evaluations of small rule sets with two inputs, if at most two terms of each input overlap. This is the
//! most common kind of rule set.
//!
//! The intervals of the two inputs divide their plane into regions. In each region two terms of either input can
//! be above 0, so an evaluation visits four cells of the table, and their rules act on at most four firing
//! strengths. All data of a region is contiguous and in the order of vectors. The operations and their order are
//! the same as in the table, so the results are bitwise equal.

use alloc::vec::Vec;

use fearless_simd::prelude::*;
use fearless_simd::{Level, f64x4};

use super::{Cuts, Lines, VectorConjunction, fires, four, splat};
use crate::table::operators::{larger, smaller};
use crate::table::results::{InputFlags, number_of};
use crate::table::{ClosedForm, Outcome, Output, Results};

/// A rule set compiled to regions of the plane of its two inputs.
#[derive(Debug, Clone)]
pub(in super::super) struct Plane {
    pub(super) level: Level,
    pub(super) sides: [PlaneInput; 2],
    /// The number of intervals of the second input.
    pub(super) columns: usize,
    /// The regions, row by row: those of the first interval of the first input, then those of its second interval, and
    /// so on.
    pub(super) regions: Vec<Region>,
    /// The least firing strength: smaller ones count as 0.
    pub(super) least: f64,
    pub(super) and: VectorConjunction,
    pub(super) output: Output,
    /// The closed form, which reduces the firing strengths to a value.
    pub(super) form: ClosedForm,
}

/// The range of an input, and the limits between its intervals.
#[derive(Debug, Clone)]
pub(super) struct PlaneInput {
    pub(super) low: f64,
    pub(super) high: f64,
    pub(super) cuts: Cuts,
}

/// The numbers of a region, which is one interval of each input.
///
/// There are four lines: two of the first input, then two of the second. There are four cells, in this order: the first
/// line of the first input with the first of the second, the second with the first, the first with the second, and the
/// second with the second. There are four slots for the firing strengths that the cells act on, in ascending order;
/// unused slots are 0.
#[derive(Debug, Clone)]
pub(super) struct Region {
    pub(super) lines: Lines,
    /// The weight of the rule of each cell.
    pub(super) weights: [f64; 4],
    /// For each cell and slot: infinity if the cell acts on the slot, else 0.
    pub(super) acts: [[f64; 4]; 4],
    /// For each slot, the numbers of the closed form, as in [`Pair`](crate::table::Pair),
    /// [`Moment`](crate::table::Moment) and [`Consequent`](crate::table::Consequent).
    pub(super) numbers: [[f64; 4]; 7],
    /// For each subset of cells, encoded as bits: the smallest rule index of these cells.
    pub(super) first_rules: [u32; 16],
}

impl Plane {
    /// Works like [`Engine::evaluate_with`](crate::Engine::evaluate_with).
    #[inline(always)]
    pub(in super::super) fn evaluate(&self, inputs: &[f64; 2], outcome: &mut Outcome) {
        fearless_simd::dispatch!(self.level, simd => self.evaluate_by(simd, inputs, outcome));
    }

    #[inline(always)]
    fn evaluate_by<S: Simd>(&self, simd: S, inputs: &[f64; 2], outcome: &mut Outcome) {
        let [first, second] = &self.sides;
        // NaN is replaced by the upper end.
        let near = |x: f64, side: &PlaneInput| larger(smaller(x, side.high), side.low);
        let (x, y) = (near(inputs[0], first), near(inputs[1], second));
        let clamped = (x != inputs[0]) | (y != inputs[1]);
        // Non-finite values were clamped too. Clamping is rare, so the second check is usually skipped.
        let infinite = clamped && !(inputs[0].is_finite() && inputs[1].is_finite());
        let (row, column) = (first.cuts.interval(simd, x), second.cuts.interval(simd, y));
        let Some(region) = self.regions.get(row * self.columns + column) else {
            // Unreachable: there is a region for each pair of intervals.
            *outcome = Outcome::UNDEFINED;
            return;
        };
        let degrees = self.and.cells(simd, region.lines.degrees(simd, [x, y]));
        let weights = four(simd, &region.weights);
        let strengths = fires(simd, weights * degrees, self.least);
        let [a, b, c, d] = strengths.to_array();
        let coverage = larger(larger(a, b), larger(c, d));
        let strongest = strengths.simd_eq(splat(simd, coverage)).to_bitmask();
        let rule = region.first_rules[strongest as usize % 16];
        let results = Results {
            default_values: [self.output.default_value],
            values: [self.value(simd, region, strengths, [x, y])],
            coverage: [coverage],
            rules: [number_of(rule)],
            input_flags: InputFlags {
                clamped: [u64::from(clamped)],
                infinite: [u64::from(infinite)],
            },
        };
        *outcome = results.outcome(0);
    }

    /// Returns the value; NaN if no rule fired.
    #[inline(always)]
    fn value<S: Simd>(&self, simd: S, region: &Region, strengths: f64x4<S>, at: [f64; 2]) -> f64 {
        let output = &self.output;
        match self.form {
            ClosedForm::Partition => {
                let heights = region.largest(simd, strengths);
                output.centroid(region.cut(simd, heights))
            }
            ClosedForm::ScaledPartition => {
                let heights = region.largest(simd, strengths);
                output.centroid(region.scaled(simd, heights))
            }
            ClosedForm::Moments => {
                let heights = region.sums(simd, strengths);
                let [area, moment, ..] = &region.numbers;
                let of = |numbers| sum(heights * four(simd, numbers));
                output.centroid((of(area), of(moment)))
            }
            ClosedForm::WeightedAverage | ClosedForm::WeightedSum => {
                let weights = region.sums(simd, strengths);
                let (sum, total) = region.weighted(simd, weights, at);
                let averages = self.form == ClosedForm::WeightedAverage;
                output.weighted(if averages { sum / total } else { sum }, total)
            }
            // A plane never has these forms.
            ClosedForm::Integrated
            | ClosedForm::Tsukamoto
            | ClosedForm::Cut
            | ClosedForm::Scaled
            | ClosedForm::Layers => f64::NAN,
        }
    }
}

impl Region {
    /// Returns the contribution of each cell to the slots.
    #[inline(always)]
    fn parts<S: Simd>(&self, simd: S, strengths: f64x4<S>) -> [f64x4<S>; 4] {
        let strengths = strengths.to_array();
        let part = |cell: usize| splat(simd, strengths[cell]).min(four(simd, &self.acts[cell]));
        [part(0), part(1), part(2), part(3)]
    }

    /// Returns the largest firing strength of each slot.
    #[inline(always)]
    fn largest<S: Simd>(&self, simd: S, strengths: f64x4<S>) -> f64x4<S> {
        let [a, b, c, d] = self.parts(simd, strengths);
        a.max(b).max(c.max(d))
    }

    /// Returns the sum of the firing strengths of each slot.
    #[inline(always)]
    fn sums<S: Simd>(&self, simd: S, strengths: f64x4<S>) -> f64x4<S> {
        let [a, b, c, d] = self.parts(simd, strengths);
        a + b + c + d
    }

    /// Returns the area and the moment of the maximum of the terms, each cut at its height.
    #[inline(always)]
    fn cut<S: Simd>(&self, simd: S, heights: f64x4<S>) -> (f64, f64) {
        let h = heights;
        let [a0, a1, m0, m1, m2, width, middle] = &self.numbers;
        let four = |numbers| four(simd, numbers);
        let v = h.min(right_of(simd, h)).min(splat(simd, 0.5));
        let common = four(width) * (v * (splat(simd, 1.0) - v));
        let areas = h * (four(a0) + h * four(a1)) - common;
        let cubic = four(m1) + h * four(m2);
        let moments = h * (four(m0) + h * cubic) - four(middle) * common;
        (sum(areas), sum(moments))
    }

    /// Returns the area and the moment of the maximum of the terms, each scaled by its height.
    #[inline(always)]
    fn scaled<S: Simd>(&self, simd: S, heights: f64x4<S>) -> (f64, f64) {
        let (h, right) = (heights, right_of(simd, heights));
        let [area, _, moment, sixth, _, width, middle] = &self.numbers;
        let four = |numbers| four(simd, numbers);
        let t = h / (h + right).max(splat(simd, f64::MIN_POSITIVE));
        let common = four(width) * (right * t);
        let place = four(middle) + four(sixth) * (t + t - splat(simd, 1.0));
        (
            sum(h * four(area) - common),
            sum(h * four(moment) - common * place),
        )
    }

    /// Returns the weighted sum of the consequents, and the sum of the weights.
    #[inline(always)]
    fn weighted<S: Simd>(&self, simd: S, weights: f64x4<S>, [x, y]: [f64; 2]) -> (f64, f64) {
        let [constant, of_x, of_y, ..] = &self.numbers;
        let four = |numbers| four(simd, numbers);
        let z = four(constant) + four(of_x) * splat(simd, x) + four(of_y) * splat(simd, y);
        // The consequent may be infinite where the rule does not fire.
        let zero = splat(simd, 0.0);
        let z = weights.simd_gt(zero).select(z, zero);
        (sum(weights * z), sum(weights))
    }
}

/// Returns, for each slot, the height of the next slot.
#[inline(always)]
fn right_of<S: Simd>(simd: S, heights: f64x4<S>) -> f64x4<S> {
    let [_, b, c, d] = heights.to_array();
    four(simd, &[b, c, d, 0.0])
}

/// Returns the sum of the four numbers, added from the first to the last.
#[inline(always)]
fn sum<S: Simd>(numbers: f64x4<S>) -> f64 {
    let [a, b, c, d] = numbers.to_array();
    a + b + c + d
}
