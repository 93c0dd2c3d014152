//! Closed forms of defuzzifiers, which compute a number from the firing strengths with a few sums.

use core::hint::select_unpredictable;

use libm::fabs;

use super::operators::{larger, smaller};
use super::{Arrays, Curve, Output, Point};
use crate::formula::evaluate;
use crate::rows::{join, set};

/// The method by which a table computes the value of an output from its firing strengths.
#[doc(hidden)] // The codes of exported data.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ClosedForm {
    /// No closed form: an [`Engine`](crate::Engine) integrates the aggregated set.
    Integrated,
    /// The centroid of a partition, with implication by minimum and aggregation by maximum; computed from [`Pair`]s.
    Partition,
    /// The centroid of a sum of products: [`Moment`]s.
    Moments,
    /// Takagi-Sugeno, `sum(w z) / sum(w)`: [`Consequent`]s.
    WeightedAverage,
    /// Takagi-Sugeno, `sum(w z)`: [`Consequent`]s.
    WeightedSum,
    /// Tsukamoto, `sum(w z) / sum(w)`, where `z` is the value at which a term has the degree `w`: one [`Curve`] per
    /// firing strength.
    Tsukamoto,
    /// A [`FuzzySet`](super::FuzzySet) of terms that are cut off (implication by minimum).
    Cut,
    /// A [`FuzzySet`](super::FuzzySet) of terms that are scaled (implication by product).
    Scaled,
    /// The centroid of a partition, with implication by product and aggregation by maximum; computed from [`Pair`]s.
    ScaledPartition,
    /// The centroid of straight terms, with implication by minimum and aggregation by maximum; computed from a
    /// [`LayeredSet`](super::LayeredSet).
    Layers,
}

impl ClosedForm {
    /// Returns the form with the given code in exported data; [`ClosedForm::Integrated`] for an
    /// unknown code, which only a damaged table contains.
    #[inline(always)]
    pub(crate) const fn from_code(code: u32) -> Self {
        match code {
            1 => ClosedForm::Partition,
            2 => ClosedForm::Moments,
            3 => ClosedForm::WeightedAverage,
            4 => ClosedForm::WeightedSum,
            5 => ClosedForm::Tsukamoto,
            6 => ClosedForm::Cut,
            7 => ClosedForm::Scaled,
            8 => ClosedForm::ScaledPartition,
            9 => ClosedForm::Layers,
            _ => ClosedForm::Integrated,
        }
    }
}

/// The coefficients of two neighbouring terms of a partition, and of the overlap of each with the term to its
/// right. Two numbers fill a vector register on every processor that has vector instructions.
///
/// Consider a term cut at firing strength h. A slope of width w with its middle at m (relative to the middle of
/// the range) contributes the area `w (h - h^2 / 2)` and the first moment `m area + s w^2 (h^2 / 4 - h^3 / 6)`,
/// with s = 1 if the slope rises and s = -1 if it falls. A plateau contributes `w h` and `m w h`. The sums over
/// the slopes and plateaus of a term are polynomials in h. Where a falling slope and a rising slope overlap, the
/// minimum of the two cut terms has the area `w v (1 - v)` with `v = min(h_falling, h_rising, 1/2)`, symmetric
/// about m. The area of the union is the sum of the areas minus the overlaps.
///
/// Consider a term scaled by firing strength h. A slope as above contributes the area `w h / 2` and the first
/// moment `(m / 2 + s w / 12) w h`. The minimum of a falling slope scaled by a and a rising slope scaled by b is a
/// triangle with its peak at the fraction `t = a / (a + b)` of the overlap. It has the area `w b t / 2` and its
/// centroid at `m + w (2 t - 1) / 6`.
#[doc(hidden)] // Exported data.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[repr(C)]
pub struct Pair {
    /// `area = area[0] h + area[1] h^2`; for scaled terms `area[0] h`.
    pub area: [[f64; 2]; 2],
    /// `moment = moment[0] h + moment[1] h^2 + moment[2] h^3`; for scaled terms `moment[0] h`, and `moment[1]` is a
    /// sixth of the width of the overlap.
    pub moment: [[f64; 2]; 3],
    /// The width of the overlap, 0 if there is none; for scaled terms half of it.
    pub width: [f64; 2],
    /// The middle of the overlap, relative to the middle of the range.
    pub middle: [f64; 2],
}

/// The area and first moment of a term at a firing strength of 1.
#[doc(hidden)] // Exported data.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Moment {
    /// The area.
    pub area: f64,
    /// The first moment, relative to the middle of the range.
    pub moment: f64,
}

/// A Takagi-Sugeno consequent: `z = constant + sum(coefficient input) + formula`.
#[doc(hidden)] // Exported data.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Consequent {
    /// The constant.
    pub constant: f64,
    /// The index of the first coefficient.
    pub first: u32,
    /// The index after the last coefficient.
    pub end: u32,
    /// The index in `points` of the code of the formula; the range is empty if the consequent has
    /// no formula.
    pub first_code: u32,
    /// The index in `points` after the code of the formula.
    pub end_code: u32,
}

/// A coefficient of a Takagi-Sugeno consequent.
#[doc(hidden)] // Exported data.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Coefficient {
    /// The factor of the input's value.
    pub coefficient: f64,
    /// The index of the input.
    pub input: u32,
}

impl Pair {
    /// Returns the area and moment that one of the two terms adds when it is cut at `h`; `right` is the firing strength
    /// of the term to its right.
    #[inline(always)]
    pub(crate) fn cut(&self, side: usize, h: f64, right: f64) -> (f64, f64) {
        let v = smaller(smaller(h, right), 0.5);
        let common = self.width[side] * (v * (1.0 - v));
        let area = h * (self.area[0][side] + h * self.area[1][side]) - common;
        let cubic = self.moment[1][side] + h * self.moment[2][side];
        let alone = h * (self.moment[0][side] + h * cubic);
        (area, alone - self.middle[side] * common)
    }

    /// Works like [`Pair::cut`], for a term that is scaled.
    #[inline(always)]
    pub(crate) fn scaled(&self, side: usize, h: f64, right: f64) -> (f64, f64) {
        let t = h / larger(h + right, f64::MIN_POSITIVE);
        let common = self.width[side] * (right * t);
        let place = self.middle[side] + self.moment[1][side] * (t + t - 1.0);
        (
            h * self.area[0][side] - common,
            h * self.moment[0][side] - common * place,
        )
    }

    /// Returns the areas and moments of the aggregated sets of a partition whose terms are cut or scaled. The firing
    /// strengths are ordered from left to right.
    #[inline(always)]
    pub(crate) fn integrals<const L: usize>(
        pairs: &[Pair],
        mut strengths: &[[f64; L]],
        add: impl Fn(&Pair, usize, f64, f64) -> (f64, f64),
    ) -> [[f64; L]; 2] {
        let (mut areas, mut moments) = ([0.0; L], [0.0; L]);
        for pair in pairs {
            let Some((three, _)) = strengths.split_first_chunk::<3>() else {
                break;
            };
            for side in 0..2 {
                for row in 0..L {
                    let (area, moment) = add(pair, side, three[side][row], three[side + 1][row]);
                    areas[row] += area;
                    moments[row] += moment;
                }
            }
            strengths = &strengths[2..];
        }
        [areas, moments]
    }
}

/// Returns the centroid of a set whose moment is relative to `origin`; `None` if the area is 0.
#[inline(always)]
pub(crate) fn centroid(area: f64, moment: f64, origin: f64) -> Option<f64> {
    (area > 0.0).then(|| origin + moment / area)
}

/// Computes the values of an output whose closed form needs the same few sums in every row; NaN if no rule fired.
/// Returns `false` for any other output. `bases` is memory for the bases of a [`LayeredSet`](super::LayeredSet).
#[inline(always)]
pub(super) fn closed<A: Arrays, const L: usize>(
    table: &A,
    output: &Output,
    strengths: &[[f64; L]],
    bases: &mut [[f64; L]],
    inputs: &[[f64; L]],
    values: &mut [f64; L],
) -> bool {
    let range = output.first as usize..output.end as usize;
    match output.form() {
        ClosedForm::Partition
        | ClosedForm::ScaledPartition
        | ClosedForm::Layers
        | ClosedForm::Moments => {
            let [areas, moments] = integrals(table, output, strengths, bases);
            set(values, |row| output.centroid((areas[row], moments[row])));
        }
        ClosedForm::WeightedAverage | ClosedForm::WeightedSum => {
            let (consequents, coefficients) = (&table.consequents()[range], table.coefficients());
            let numbers = (consequents, coefficients, table.points());
            weighted(output, numbers, strengths, inputs, values);
        }
        ClosedForm::Integrated | ClosedForm::Tsukamoto | ClosedForm::Cut | ClosedForm::Scaled => {
            return false;
        }
    }
    true
}

/// Returns the areas and moments of a set if its closed form computes them by a few sums; 0 for any other output.
#[inline(always)]
fn integrals<A: Arrays, const L: usize>(
    table: &A,
    output: &Output,
    strengths: &[[f64; L]],
    bases: &mut [[f64; L]],
) -> [[f64; L]; 2] {
    let range = output.first as usize..output.end as usize;
    match output.form() {
        ClosedForm::Partition => Pair::integrals(&table.pairs()[range], strengths, Pair::cut),
        ClosedForm::ScaledPartition => {
            Pair::integrals(&table.pairs()[range], strengths, Pair::scaled)
        }
        ClosedForm::Layers => {
            let layered = table.layered_sets()[output.first as usize];
            layered.integrals(table, strengths, bases)
        }
        ClosedForm::Moments => {
            let (mut areas, mut moments) = ([0.0; L], [0.0; L]);
            for (Moment { area, moment }, strengths) in table.moments()[range].iter().zip(strengths)
            {
                for row in 0..L {
                    areas[row] += strengths[row] * area;
                    moments[row] += strengths[row] * moment;
                }
            }
            [areas, moments]
        }
        ClosedForm::Integrated
        | ClosedForm::Cut
        | ClosedForm::Scaled
        | ClosedForm::Tsukamoto
        | ClosedForm::WeightedAverage
        | ClosedForm::WeightedSum => [[0.0; L]; 2],
    }
}

/// Returns the area and the centroid of a set in one row; `None` if it is empty or has no closed form.
pub(super) fn area_and_centroid<A: Arrays>(
    table: &A,
    output: &Output,
    strengths: &[[f64; 1]],
    bases: &mut [[f64; 1]],
) -> Option<(f64, f64)> {
    let (area, moment) = match output.form() {
        ClosedForm::Cut | ClosedForm::Scaled => {
            super::set::integrals(table, output, strengths.as_flattened())?
        }
        _ => {
            let [[area], [moment]] = integrals(table, output, strengths, bases);
            (area, moment)
        }
    };
    (area > 0.0).then(|| (area, output.centroid((area, moment))))
}

/// Works like [`closed`]. It is a separate function because its code would otherwise take registers from the code for
/// partitions.
#[inline(never)]
pub(super) fn closed_outlined<A: Arrays, const L: usize>(
    table: &A,
    output: &Output,
    strengths: &[[f64; L]],
    bases: &mut [[f64; L]],
    inputs: &[[f64; L]],
    values: &mut [f64; L],
) -> bool {
    closed(table, output, strengths, bases, inputs, values)
}

/// Works like [`closed`], for a partition.
#[inline(always)]
pub(super) fn partition<A: Arrays, const L: usize>(
    table: &A,
    output: &Output,
    strengths: &[[f64; L]],
    values: &mut [f64; L],
    add: impl Fn(&Pair, usize, f64, f64) -> (f64, f64),
) {
    let pairs = &table.pairs()[output.first as usize..output.end as usize];
    let [areas, moments] = Pair::integrals(pairs, strengths, add);
    set(values, |row| output.centroid((areas[row], moments[row])));
}

impl Output {
    /// Returns the centroid of a set, given its area and its moment relative to the middle of the range; NaN if the
    /// area is 0.
    #[inline(always)]
    pub(crate) fn centroid(&self, (area, moment): (f64, f64)) -> f64 {
        let value = self.origin() + moment / area;
        let value = larger(self.low, smaller(self.high, value));
        select_unpredictable(area > 0.0, value, f64::NAN)
    }

    /// Returns the value of a Takagi-Sugeno output; NaN if `total`, the sum of the weights, is 0 because no rule fired,
    /// or if the value is not finite. It is clamped to the range only if the output has `clamp`, because consequents
    /// outside the range may be intended.
    #[inline(always)]
    pub(crate) fn weighted(&self, value: f64, total: f64) -> f64 {
        let is_value = (total > 0.0) & (fabs(value) < f64::INFINITY);
        self.clamped(select_unpredictable(is_value, value, f64::NAN))
    }
}

/// Returns the value in one row of an output that [`closed`] does not support; `None` if no rule fired. `integrate`
/// returns the value of an output without a closed form, given its index and its firing strengths.
#[inline(always)]
pub(crate) fn value_in_row<A: Arrays>(
    table: &A,
    index: usize,
    output: &Output,
    strengths: &[f64],
    mut integrate: impl FnMut(usize, &[f64]) -> Option<f64>,
) -> Option<f64> {
    match output.form() == ClosedForm::Integrated {
        true => integrate(index, strengths),
        false => closed_in_row(table, output, strengths),
    }
}

/// Implements [`value_in_row`] for an output with a closed form.
fn closed_in_row<A: Arrays>(table: &A, output: &Output, strengths: &[f64]) -> Option<f64> {
    match output.form() {
        ClosedForm::Cut | ClosedForm::Scaled => super::set::value(table, output, strengths),
        ClosedForm::Tsukamoto => {
            let curves = &table.curves()[output.first as usize..output.end as usize];
            let value = tsukamoto(output, curves, table.points(), strengths);
            value.map(|value| output.clamped(value))
        }
        ClosedForm::Integrated
        | ClosedForm::Partition
        | ClosedForm::ScaledPartition
        | ClosedForm::Layers
        | ClosedForm::Moments
        | ClosedForm::WeightedAverage
        | ClosedForm::WeightedSum => None,
    }
}

/// Returns a value if it is finite. Otherwise returns the upper end of the range for positive infinity, and the lower
/// end for negative infinity and NaN.
pub(crate) fn finite(place: f64, low: f64, high: f64) -> f64 {
    if place.is_finite() {
        place
    } else if place > 0.0 {
        high
    } else {
        low
    }
}

/// Computes `sum(w z) / sum(w)` with firing strengths w; `None` if none is above 0. The result is not clamped to the
/// range.
fn tsukamoto(
    output: &Output,
    curves: &[Curve],
    points: &[Point],
    strengths: &[f64],
) -> Option<f64> {
    let (mut sum, mut total) = (0.0, 0.0);
    for (curve, &strength) in curves.iter().zip(strengths) {
        if strength > 0.0 {
            let points = &points[curve.first_point as usize..curve.end_point as usize];
            let part = smaller(1.0, strength / curve.height);
            let place = curve.kind.inverse(&curve.parameters, points, part);
            sum += strength * finite(place, output.low, output.high);
            total += strength;
        }
    }
    (total > 0.0).then(|| sum / total)
}

/// Computes `sum(w z) / sum(w)` or `sum(w z)` with firing strengths w; NaN if none is above 0 or a formula has no
/// value.
#[inline(always)]
fn weighted<const L: usize>(
    output: &Output,
    (consequents, coefficients, points): (&[Consequent], &[Coefficient], &[Point]),
    strengths: &[[f64; L]],
    inputs: &[[f64; L]],
    values: &mut [f64; L],
) {
    let (mut sums, mut totals) = ([0.0; L], [0.0; L]);
    for (consequent, strengths) in consequents.iter().zip(strengths) {
        if strengths.iter().all(|strength| *strength <= 0.0) {
            continue;
        }
        let constant = consequent.constant;
        let terms = &coefficients[consequent.first as usize..consequent.end as usize];
        let code = &points[consequent.first_code as usize..consequent.end_code as usize];
        let product = |c: &Coefficient, row: usize| c.coefficient * inputs[c.input as usize][row];
        match (terms, code) {
            // The most common consequents take a single pass.
            ([], []) => add(&mut sums, &mut totals, strengths, |_| constant),
            ([a], []) => add(&mut sums, &mut totals, strengths, |row| {
                constant + product(a, row)
            }),
            ([a, b], []) => add(&mut sums, &mut totals, strengths, |row| {
                constant + product(a, row) + product(b, row)
            }),
            _ => {
                let mut z = [constant; L];
                for c in terms {
                    join(&mut z, &inputs[c.input as usize], |z, x| {
                        z + c.coefficient * x
                    });
                }
                if !code.is_empty() {
                    for row in 0..L {
                        let value = |i: usize| inputs.get(i).map_or(f64::NAN, |inputs| inputs[row]);
                        z[row] += evaluate(code, value);
                    }
                }
                add(&mut sums, &mut totals, strengths, |row| z[row]);
            }
        }
    }
    let is_sum = output.form() == ClosedForm::WeightedSum;
    set(values, |row| {
        let value = match is_sum {
            true => sums[row],
            false => sums[row] / totals[row],
        };
        output.weighted(value, totals[row])
    });
}

/// Returns the number of a Takagi-Sugeno consequent at the values of the inputs.
pub(crate) fn number<A: Arrays>(table: &A, consequent: &Consequent, inputs: &[[f64; 1]]) -> f64 {
    let range = consequent.first as usize..consequent.end as usize;
    let terms = table.coefficients().get(range).unwrap_or_default();
    let code = consequent.first_code as usize..consequent.end_code as usize;
    let code = table.points().get(code).unwrap_or_default();
    let input = |index: usize| inputs.get(index).map_or(f64::NAN, |[value]| *value);
    let linear = terms.iter().fold(consequent.constant, |z, c| {
        z + c.coefficient * input(c.input as usize)
    });
    match code {
        [] => linear,
        code => linear + evaluate(code, input),
    }
}

/// Adds the values `z` of a consequent, times their weights `strengths`, to `sums`, and the weights to `totals`.
#[inline(always)]
fn add<const L: usize>(
    sums: &mut [f64; L],
    totals: &mut [f64; L],
    strengths: &[f64; L],
    z: impl Fn(usize) -> f64,
) {
    for row in 0..L {
        // The consequent may be infinite where the rule does not fire.
        let z = select_unpredictable(strengths[row] > 0.0, z(row), 0.0);
        sums[row] += strengths[row] * z;
        totals[row] += strengths[row];
    }
}
