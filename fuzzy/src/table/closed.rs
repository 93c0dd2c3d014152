//! Defuzzifiers with a closed form: from firing strengths to a number by a few sums.

use super::operators::smaller;
use super::{Arrays, Curve, Output, Point};
use crate::formula::evaluate;

/// The closed form of a defuzzifier.
#[doc(hidden)] // Exported data.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(transparent)]
pub struct ClosedForm(pub u32);

impl ClosedForm {
    /// None: an [`Engine`](crate::Engine) integrates the aggregated set.
    pub const NONE: ClosedForm = ClosedForm(0);
    /// The centroid of minimum and maximum over a partition: [`Pair`]s.
    pub const PARTITION: ClosedForm = ClosedForm(1);
    /// The centroid of a sum of products: [`Moment`]s.
    pub const MOMENTS: ClosedForm = ClosedForm(2);
    /// Takagi-Sugeno, `sum(w z) / sum(w)`: [`Consequent`]s.
    pub const WEIGHTED_AVERAGE: ClosedForm = ClosedForm(3);
    /// Takagi-Sugeno, `sum(w z)`: [`Consequent`]s.
    pub const WEIGHTED_SUM: ClosedForm = ClosedForm(4);

    /// Tsukamoto, `sum(w z) / sum(w)` with `z` where a term has the degree `w`: [`Curve`]s, one for each firing strength.
    pub const TSUKAMOTO: ClosedForm = ClosedForm(5);
    /// A [`FuzzySet`](super::FuzzySet) of terms that are cut off: the implication is the minimum.
    pub const CUT: ClosedForm = ClosedForm(6);
    /// A [`FuzzySet`](super::FuzzySet) of terms that are scaled: the implication is the product.
    pub const SCALED: ClosedForm = ClosedForm(7);
}

/// The coefficients of two neighbouring terms of a partition, and of the overlap of each with the term to its right.
/// Two fill a vector register of every processor that has vectors.
///
/// A term cut at firing strength h has, on a slope of width w around its middle m (from the middle of the range),
/// area `w (h - h^2 / 2)` and first moment `m area + s w^2 (h^2 / 4 - h^3 / 6)`, with s = 1 rising and -1
/// falling; on a plateau `w h` and `m w h`. Both sum over the term's stretches to polynomials in h. Where a
/// falling and a rising slope overlap, the minimum of the two cut terms has area `w v (1 - v)` with
/// `v = min(h_falling, h_rising, 1/2)`, symmetric about m. The area of the union is the sum less the overlaps.
#[doc(hidden)] // Exported data.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[repr(C)]
pub struct Pair {
    /// `area = area[0] h + area[1] h^2`.
    pub area: [[f64; 2]; 2],
    /// `moment = moment[0] h + moment[1] h^2 + moment[2] h^3`.
    pub moment: [[f64; 2]; 3],
    /// The width of the overlap; 0 where there is none.
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
    /// The area and moment that one of the two terms adds, from its firing strength and that of the term to its right.
    #[inline(always)]
    pub(crate) fn add(&self, side: usize, h: f64, right: f64) -> (f64, f64) {
        let v = smaller(smaller(h, right), 0.5);
        let common = self.width[side] * (v * (1.0 - v));
        let area = h * (self.area[0][side] + h * self.area[1][side]) - common;
        let cubic = self.moment[1][side] + h * self.moment[2][side];
        let alone = h * (self.moment[0][side] + h * cubic);
        (area, alone - self.middle[side] * common)
    }

    /// The area and moment of the aggregated set of a partition. Firing strengths are ordered from left to right.
    #[inline(always)]
    pub(crate) fn integrals(pairs: &[Pair], strengths: &[f64]) -> Moment {
        let (mut area, mut moment) = ([0.0; 2], [0.0; 2]);
        for (pair, i) in pairs.iter().zip((0..).step_by(2)) {
            let strengths: &[f64] = &strengths[i..i + 3];
            for side in 0..2 {
                let (a, m) = pair.add(side, strengths[side], strengths[side + 1]);
                area[side] += a;
                moment[side] += m;
            }
        }
        Moment {
            area: area[0] + area[1],
            moment: moment[0] + moment[1],
        }
    }
}

/// The centroid of a set whose moment is measured from `origin`; `None` where it has no area.
#[inline(always)]
pub(crate) fn centroid(area: f64, moment: f64, origin: f64) -> Option<f64> {
    (area > 0.0).then(|| origin + moment / area)
}

/// The value of an output with a closed form; `None` where no rule fired.
#[inline(always)]
pub(super) fn closed<A: Arrays>(
    table: &A,
    output: &Output,
    strengths: &[f64],
    inputs: &[f64],
) -> Option<f64> {
    let range = output.first as usize..output.end as usize;
    let Moment { area, moment } = match output.form {
        ClosedForm::PARTITION => Pair::integrals(&table.pairs()[range], strengths),
        ClosedForm::MOMENTS => {
            let mut sum = Moment {
                area: 0.0,
                moment: 0.0,
            };
            for (Moment { area, moment }, strength) in table.moments()[range].iter().zip(strengths)
            {
                sum.area += strength * area;
                sum.moment += strength * moment;
            }
            sum
        }
        ClosedForm::CUT | ClosedForm::SCALED => return super::set::value(table, output, strengths),
        // Not clamped to the range unless the author says so: consequents are numbers that the author chose.
        form => {
            let points = table.points();
            let value = match form {
                ClosedForm::TSUKAMOTO => {
                    tsukamoto(output, &table.curves()[range], points, strengths)
                }
                _ => {
                    let coefficients = (table.coefficients(), points);
                    weighted(
                        form,
                        &table.consequents()[range],
                        coefficients,
                        strengths,
                        inputs,
                    )
                }
            };
            return value.map(|value| output.clamped(value));
        }
    };
    let value = centroid(area, moment, output.origin())?;
    Some(super::larger(output.low, smaller(output.high, value)))
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

/// `sum(w z) / sum(w)` or `sum(w z)` with firing strengths w; `None` where none is over 0, and where a formula has no value.
fn weighted(
    form: ClosedForm,
    consequents: &[Consequent],
    (coefficients, points): (&[Coefficient], &[Point]),
    strengths: &[f64],
    inputs: &[f64],
) -> Option<f64> {
    let (mut sum, mut total) = (0.0, 0.0);
    for (consequent, &strength) in consequents.iter().zip(strengths) {
        if strength > 0.0 {
            let range = consequent.first as usize..consequent.end as usize;
            let mut z = coefficients[range]
                .iter()
                .fold(consequent.constant, |z, c| {
                    z + c.coefficient * inputs[c.input as usize]
                });
            let code = consequent.first_code as usize..consequent.end_code as usize;
            if !code.is_empty() {
                let value = |i: usize| inputs.get(i).copied().unwrap_or(f64::NAN);
                z += evaluate(&points[code], value);
            }
            sum += strength * z;
            total += strength;
        }
    }
    let value = match form {
        ClosedForm::WEIGHTED_SUM => sum,
        _ => sum / total,
    };
    (total > 0.0 && value.is_finite()).then_some(value)
}
