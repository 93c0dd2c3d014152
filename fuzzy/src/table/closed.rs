//! Defuzzifiers with a closed form: from firing strengths to a number by a few sums.

use core::hint::select_unpredictable;

use libm::fabs;

use super::operators::{larger, smaller};
use super::{Arrays, Curve, Output, Point};
use crate::formula::evaluate;
use crate::rows::{join, set};

/// How a table computes the value of an output from its firing strengths.
#[doc(hidden)] // The codes of exported data.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ClosedForm {
    /// None: an [`Engine`](crate::Engine) integrates the aggregated set.
    Integrated,
    /// The centroid of minimum and maximum over a partition: [`Pair`]s.
    Partition,
    /// The centroid of a sum of products: [`Moment`]s.
    Moments,
    /// Takagi-Sugeno, `sum(w z) / sum(w)`: [`Consequent`]s.
    WeightedAverage,
    /// Takagi-Sugeno, `sum(w z)`: [`Consequent`]s.
    WeightedSum,
    /// Tsukamoto, `sum(w z) / sum(w)` with `z` where a term has the degree `w`: [`Curve`]s, one for each firing strength.
    Tsukamoto,
    /// A [`FuzzySet`](super::FuzzySet) of terms that are cut off: the implication is the minimum.
    Cut,
    /// A [`FuzzySet`](super::FuzzySet) of terms that are scaled: the implication is the product.
    Scaled,
    /// The centroid of product and maximum over a partition: [`Pair`]s.
    ScaledPartition,
    /// The centroid of minimum and maximum over straight terms: a [`LayeredSet`](super::LayeredSet).
    Layers,
}

impl ClosedForm {
    /// The form of this code in exported data. An unknown code, of a damaged table, has no closed form.
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

/// The coefficients of two neighbouring terms of a partition, and of the overlap of each with the term to its right.
/// Two fill a vector register of every processor that has vectors.
///
/// A term cut at firing strength h has, on a slope of width w around its middle m (from the middle of the range),
/// area `w (h - h^2 / 2)` and first moment `m area + s w^2 (h^2 / 4 - h^3 / 6)`, with s = 1 rising and -1
/// falling; on a plateau `w h` and `m w h`. Both sum over the term's stretches to polynomials in h. Where a
/// falling and a rising slope overlap, the minimum of the two cut terms has area `w v (1 - v)` with
/// `v = min(h_falling, h_rising, 1/2)`, symmetric about m. The area of the union is the sum less the overlaps.
///
/// A term scaled by firing strength h has, on such a slope, area `w h / 2` and first moment `(m / 2 + s w / 12) w h`. The
/// minimum of a falling slope scaled by a and a rising one scaled by b is a triangle, highest at the part `t = a / (a + b)` of
/// the overlap: it has area `w b t / 2`, and its centre lies at `m + w (2 t - 1) / 6`.
#[doc(hidden)] // Exported data.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[repr(C)]
pub struct Pair {
    /// `area = area[0] h + area[1] h^2`; scaled, `area[0] h`.
    pub area: [[f64; 2]; 2],
    /// `moment = moment[0] h + moment[1] h^2 + moment[2] h^3`; scaled, `moment[0] h`, and `moment[1]` is a sixth of the length of
    /// the overlap.
    pub moment: [[f64; 2]; 3],
    /// The width of the overlap, 0 where there is none; scaled, half of it.
    pub width: [f64; 2],
    /// The middle of the overlap, from the middle of the range.
    pub middle: [f64; 2],
}

/// The area and first moment of a term at a firing strength of 1.
#[doc(hidden)] // Exported data.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Moment {
    /// The area.
    pub area: f64,
    /// The moment, from the middle of the range.
    pub moment: f64,
}

/// A Takagi-Sugeno consequent: `z = constant + sum(coefficient input) + formula`.
#[doc(hidden)] // Exported data.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Consequent {
    /// The constant.
    pub constant: f64,
    /// Its span of coefficients.
    pub first: u32,
    /// The end of that span.
    pub end: u32,
    /// The span in `points` of the code of its formula; empty where it has none.
    pub first_code: u32,
    /// The end of that span.
    pub end_code: u32,
}

/// A coefficient of a Takagi-Sugeno consequent.
#[doc(hidden)] // Exported data.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Coefficient {
    /// The coefficient.
    pub coefficient: f64,
    /// The index of the input.
    pub input: u32,
}

impl Pair {
    /// The area and moment that one of the two terms adds, cut at its firing strength, from that of the term to its right.
    #[inline(always)]
    pub(crate) fn cut(&self, side: usize, h: f64, right: f64) -> (f64, f64) {
        let v = smaller(smaller(h, right), 0.5);
        let common = self.width[side] * (v * (1.0 - v));
        let area = h * (self.area[0][side] + h * self.area[1][side]) - common;
        let cubic = self.moment[1][side] + h * self.moment[2][side];
        let alone = h * (self.moment[0][side] + h * cubic);
        (area, alone - self.middle[side] * common)
    }

    /// [`Pair::cut`] for a term that is scaled.
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

    /// The areas and moments of the aggregated sets of a partition, whose terms are cut or scaled. Firing strengths are ordered
    /// from left to right.
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

/// The centroid of a set whose moment is measured from `origin`; `None` where it has no area.
#[inline(always)]
pub(crate) fn centroid(area: f64, moment: f64, origin: f64) -> Option<f64> {
    (area > 0.0).then(|| origin + moment / area)
}

/// Writes the values of an output with a closed form that is the same few sums in every row; NaN where no rule fired. `false`
/// for another output. `bases` is memory for those of a [`LayeredSet`](super::LayeredSet).
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
        ClosedForm::Partition => partition(table, output, strengths, values, Pair::cut),
        ClosedForm::ScaledPartition => partition(table, output, strengths, values, Pair::scaled),
        ClosedForm::Layers => {
            let layered = table.layered_sets()[output.first as usize];
            let [areas, moments] = layered.integrals(table, strengths, bases);
            set(values, |row| output.centroid((areas[row], moments[row])));
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

/// [`closed`], apart from the code of partitions, from which it would take registers.
#[inline(never)]
pub(super) fn closed_apart<A: Arrays, const L: usize>(
    table: &A,
    output: &Output,
    strengths: &[[f64; L]],
    bases: &mut [[f64; L]],
    inputs: &[[f64; L]],
    values: &mut [f64; L],
) -> bool {
    closed(table, output, strengths, bases, inputs, values)
}

/// [`closed`] of a partition.
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
    /// The centroid of a set, from its area and its moment from the middle of the range; NaN where it has no area.
    #[inline(always)]
    pub(crate) fn centroid(&self, (area, moment): (f64, f64)) -> f64 {
        let value = self.origin() + moment / area;
        let value = larger(self.low, smaller(self.high, value));
        select_unpredictable(area > 0.0, value, f64::NAN)
    }

    /// The value of a Takagi-Sugeno output with this total of weights; NaN where no rule fired, and where there is no value. It
    /// is not clamped to the range unless the author says so: consequents are numbers that the author chose.
    #[inline(always)]
    pub(crate) fn weighted(&self, value: f64, total: f64) -> f64 {
        let is_value = (total > 0.0) & (fabs(value) < f64::INFINITY);
        self.clamped(select_unpredictable(is_value, value, f64::NAN))
    }
}

/// The value in one row of an output that [`closed`] does not know; `None` where no rule fired. `integrate` gives the value of
/// an output without a closed form from its index and its firing strengths.
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

/// [`value_in_row`] of an output with a closed form, apart from the code that calls it.
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

/// A place, or the end of the range on the side where it lies at infinity.
pub(crate) fn finite(place: f64, low: f64, high: f64) -> f64 {
    if place.is_finite() {
        place
    } else if place > 0.0 {
        high
    } else {
        low
    }
}

/// `sum(w z) / sum(w)` with firing strengths w; `None` where none is over 0. Not clamped to the range.
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
            let place = curve.kind.place(&curve.parameters, points, part);
            sum += strength * finite(place, output.low, output.high);
            total += strength;
        }
    }
    (total > 0.0).then(|| sum / total)
}

/// Writes `sum(w z) / sum(w)` or `sum(w z)` with firing strengths w; NaN where none is over 0, and where a formula has no value.
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
            // The commonest ones in one pass.
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

/// Adds the weighted values of a consequent, and its weights.
#[inline(always)]
fn add<const L: usize>(
    sums: &mut [f64; L],
    totals: &mut [f64; L],
    strengths: &[f64; L],
    z: impl Fn(usize) -> f64,
) {
    for row in 0..L {
        // It may be infinite where the rule does not fire.
        let z = select_unpredictable(strengths[row] > 0.0, z(row), 0.0);
        sums[row] += strengths[row] * z;
        totals[row] += strengths[row];
    }
}
