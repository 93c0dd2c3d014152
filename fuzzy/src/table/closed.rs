//! Outputs with a closed form: from heights to a number by a few sums.

use super::operators::smaller;
use super::{Arrays, Output};

/// The closed form of an output.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(transparent)]
pub struct Set(pub u32);

impl Set {
    /// None: only an [`Engine`](crate::Engine) knows its value.
    pub const OPEN: Set = Set(0);
    /// The centroid of minimum and maximum over a partition: [`Pair`]s.
    pub const PARTITION: Set = Set(1);
    /// The centroid of a sum of products: [`Moment`]s.
    pub const MOMENTS: Set = Set(2);
    /// Takagi-Sugeno, `sum(w z) / sum(w)`: [`Consequence`]s.
    pub const WEIGHTED_AVERAGE: Set = Set(3);
    /// Takagi-Sugeno, `sum(w z)`: [`Consequence`]s.
    pub const WEIGHTED_SUM: Set = Set(4);

    /// Whether sets are integrated, whose ratios alone count.
    pub(crate) fn is_fuzzy(self) -> bool {
        !matches!(self, Set::WEIGHTED_AVERAGE | Set::WEIGHTED_SUM)
    }
}

/// The coefficients of two neighbouring terms of a partition, and of the overlap of each with the term to its right.
/// Two at a time, because that is how many every processor computes at once.
///
/// A term cut at height h has, on a slope of width w around its middle m (from the middle of the range),
/// area `w (h - h^2 / 2)` and first moment `m area + s w^2 (h^2 / 4 - h^3 / 6)`, with s = 1 rising and -1
/// falling; on a plateau `w h` and `m w h`. Both sum over the term's stretches to polynomials in h. Where a
/// falling and a rising slope overlap, the minimum of the two cut terms has area `w v (1 - v)` with
/// `v = min(h_falling, h_rising, 1/2)`, symmetric about m. The union's area is the sum less the overlaps.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[repr(C)]
pub struct Pair {
    /// `area = area[0] h + area[1] h^2`.
    pub area: [[f64; 2]; 2],
    /// `moment = moment[0] h + moment[1] h^2 + moment[2] h^3`.
    pub moment: [[f64; 2]; 3],
    /// The width of the overlap; 0 without one.
    pub width: [f64; 2],
    /// The overlap's middle, from the middle of the range.
    pub middle: [f64; 2],
}

/// Area and first moment of a term at full height.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Moment {
    /// The area.
    pub area: f64,
    /// The moment, from the middle of the range.
    pub moment: f64,
}

/// `z = constant + sum(coefficient input)`.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Consequence {
    /// The constant.
    pub constant: f64,
    /// Its coefficients.
    pub first: u32,
    /// Where they end.
    pub end: u32,
}

/// A coefficient of a Takagi-Sugeno consequent.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Coefficient {
    /// The coefficient.
    pub coefficient: f64,
    /// The input.
    pub input: u32,
}

impl Pair {
    /// Area and moment that one of the two terms adds, at its height and the one to its right.
    #[inline(always)]
    pub(crate) fn add(&self, side: usize, h: f64, right: f64) -> (f64, f64) {
        let v = smaller(smaller(h, right), 0.5);
        let common = self.width[side] * (v * (1.0 - v));
        let area = h * (self.area[0][side] + h * self.area[1][side]) - common;
        let cubic = self.moment[1][side] + h * self.moment[2][side];
        let alone = h * (self.moment[0][side] + h * cubic);
        (area, alone - self.middle[side] * common)
    }

    /// Area and moment of the aggregated set of a partition; heights stand from left to right.
    #[inline(always)]
    pub(crate) fn integrals(pairs: &[Pair], heights: &[f64]) -> Moment {
        let (mut area, mut moment) = ([0.0; 2], [0.0; 2]);
        for (pair, i) in pairs.iter().zip((0..).step_by(2)) {
            let heights: &[f64] = &heights[i..i + 3];
            for side in 0..2 {
                let (a, m) = pair.add(side, heights[side], heights[side + 1]);
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

/// The centre of gravity of a set whose moment is measured from `origin`; `None` without area.
#[inline(always)]
pub(crate) fn centroid(area: f64, moment: f64, origin: f64) -> Option<f64> {
    (area > 0.0).then(|| origin + moment / area)
}

/// The number; `None` where no rule fired.
#[inline(always)]
pub(super) fn closed<A: Arrays>(
    table: &A,
    output: &Output,
    heights: &[f64],
    inputs: &[f64],
) -> Option<f64> {
    let range = output.first as usize..output.end as usize;
    let Moment { area, moment } = match output.set {
        Set::PARTITION => Pair::integrals(&table.pairs()[range], heights),
        Set::MOMENTS => {
            let mut sum = Moment {
                area: 0.0,
                moment: 0.0,
            };
            for (Moment { area, moment }, height) in table.moments()[range].iter().zip(heights) {
                sum.area += height * area;
                sum.moment += height * moment;
            }
            sum
        }
        // Not held to the range: the consequents are the author's own numbers.
        set => {
            let consequences = &table.consequences()[range];
            return weighted(set, consequences, table.coefficients(), heights, inputs);
        }
    };
    let value = centroid(area, moment, output.origin())?;
    Some(super::larger(output.low, smaller(output.high, value)))
}

/// `sum(w z) / sum(w)` or `sum(w z)`; `None` where no weight is over 0.
fn weighted(
    set: Set,
    consequences: &[Consequence],
    coefficients: &[Coefficient],
    weights: &[f64],
    inputs: &[f64],
) -> Option<f64> {
    let (mut sum, mut total) = (0.0, 0.0);
    for (consequence, &weight) in consequences.iter().zip(weights) {
        if weight > 0.0 {
            let range = consequence.first as usize..consequence.end as usize;
            let z = coefficients[range]
                .iter()
                .fold(consequence.constant, |z, c| {
                    z + c.coefficient * inputs[c.input as usize]
                });
            sum += weight * z;
            total += weight;
        }
    }
    (total > 0.0).then_some(match set {
        Set::WEIGHTED_SUM => sum,
        _ => sum / total,
    })
}
