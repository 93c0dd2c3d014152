//! Single evaluations of a small rule set of two inputs, of which at most two terms each overlap: the commonest one.
//!
//! The inputs' intervals cut their plane into regions. In each, two terms of either input hold, so four cells of the table, and
//! their rules act on four firing strengths at most. All that an evaluation reads of a region stands together, in the order of
//! vectors. The operations and their order are those of the table, and so are the bits.

use alloc::vec::Vec;

use fearless_simd::prelude::*;
use fearless_simd::{Level, f64x4};

use super::{And, Cuts, Lines, fires, four, splat};
use crate::table::operators::{larger, smaller};
use crate::table::results::{Given, number_of};
use crate::table::{ClosedForm, Outcome, Output, Results};

/// A compiled rule set.
#[derive(Debug, Clone)]
pub(in super::super) struct Plane {
    pub(super) level: Level,
    pub(super) sides: [Side; 2],
    /// The number of intervals of the second input.
    pub(super) columns: usize,
    /// The regions of the first interval of the first input, then those of its second.
    pub(super) regions: Vec<Region>,
    /// A firing strength below it counts as 0.
    pub(super) least: f64,
    pub(super) and: And,
    pub(super) output: Output,
    /// How firing strengths become a value.
    pub(super) form: ClosedForm,
}

/// An input.
#[derive(Debug, Clone)]
pub(super) struct Side {
    pub(super) low: f64,
    pub(super) high: f64,
    pub(super) cuts: Cuts,
}

/// The numbers of an interval of each input.
///
/// The four lines are two of the first input, then two of the second. The four cells are the first line of the first input with
/// the first of the second, the second with the first, the first with the second, and the second with the second. The four
/// slots are the firing strengths that the cells act on, ascending; those that are left over are 0.
#[derive(Debug, Clone)]
pub(super) struct Region {
    pub(super) lines: Lines,
    /// Of each cell: the weight of its rule.
    pub(super) weights: [f64; 4],
    /// Of each cell, for each slot: infinite where it acts on it, else 0.
    pub(super) acts: [[f64; 4]; 4],
    /// Of each slot: the numbers of the closed form, as in [`Pair`](crate::table::Pair), [`Moment`](crate::table::Moment) and
    /// [`Consequent`](crate::table::Consequent).
    pub(super) numbers: [[f64; 4]; 7],
    /// For each set of cells, as bits: the first rule in the model of those of the cells.
    pub(super) first_rules: [u32; 16],
}

impl Plane {
    /// [`Engine::evaluate_with`](crate::Engine::evaluate_with).
    #[inline(always)]
    pub(in super::super) fn evaluate(&self, inputs: &[f64; 2], outcome: &mut Outcome) {
        fearless_simd::dispatch!(self.level, simd => self.evaluate_by(simd, inputs, outcome));
    }

    #[inline(always)]
    fn evaluate_by<S: Simd>(&self, simd: S, inputs: &[f64; 2], outcome: &mut Outcome) {
        let [first, second] = &self.sides;
        // NaN becomes the upper end.
        let near = |x: f64, side: &Side| larger(smaller(x, side.high), side.low);
        let (x, y) = (near(inputs[0], first), near(inputs[1], second));
        let clamped = (x != inputs[0]) | (y != inputs[1]);
        // What is not finite is outside, which is rare.
        let infinite = clamped && !(inputs[0].is_finite() && inputs[1].is_finite());
        let (row, column) = (first.cuts.interval(simd, x), second.cuts.interval(simd, y));
        let Some(region) = self.regions.get(row * self.columns + column) else {
            // There is one for each two intervals.
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
            given: Given {
                clamped: [u64::from(clamped)],
                infinite: [u64::from(infinite)],
            },
        };
        *outcome = results.outcome(0);
    }

    /// The value; NaN where no rule fired.
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
            // No plane has these forms.
            ClosedForm::Integrated
            | ClosedForm::Tsukamoto
            | ClosedForm::Cut
            | ClosedForm::Scaled
            | ClosedForm::Layers => f64::NAN,
        }
    }
}

impl Region {
    /// What each cell adds to the slots.
    #[inline(always)]
    fn parts<S: Simd>(&self, simd: S, strengths: f64x4<S>) -> [f64x4<S>; 4] {
        let strengths = strengths.to_array();
        let part = |cell: usize| splat(simd, strengths[cell]).min(four(simd, &self.acts[cell]));
        [part(0), part(1), part(2), part(3)]
    }

    /// The largest firing strength of each slot.
    #[inline(always)]
    fn largest<S: Simd>(&self, simd: S, strengths: f64x4<S>) -> f64x4<S> {
        let [a, b, c, d] = self.parts(simd, strengths);
        a.max(b).max(c.max(d))
    }

    /// The sum of the firing strengths of each slot.
    #[inline(always)]
    fn sums<S: Simd>(&self, simd: S, strengths: f64x4<S>) -> f64x4<S> {
        let [a, b, c, d] = self.parts(simd, strengths);
        a + b + c + d
    }

    /// The area and moment of the maximum of terms cut at their heights.
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

    /// The area and moment of the maximum of terms scaled by their heights.
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

    /// The weighted sum of the consequents, and that of the weights.
    #[inline(always)]
    fn weighted<S: Simd>(&self, simd: S, weights: f64x4<S>, [x, y]: [f64; 2]) -> (f64, f64) {
        let [constant, of_x, of_y, ..] = &self.numbers;
        let four = |numbers| four(simd, numbers);
        let z = four(constant) + four(of_x) * splat(simd, x) + four(of_y) * splat(simd, y);
        // It may be infinite where the rule does not fire.
        let zero = splat(simd, 0.0);
        let z = weights.simd_gt(zero).select(z, zero);
        (sum(weights * z), sum(weights))
    }
}

/// For each slot, the height of the next one.
#[inline(always)]
fn right_of<S: Simd>(simd: S, heights: f64x4<S>) -> f64x4<S> {
    let [_, b, c, d] = heights.to_array();
    four(simd, &[b, c, d, 0.0])
}

/// In the order of the slots.
#[inline(always)]
fn sum<S: Simd>(numbers: f64x4<S>) -> f64 {
    let [a, b, c, d] = numbers.to_array();
    a + b + c + d
}
