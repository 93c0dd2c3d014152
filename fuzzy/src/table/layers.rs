//! The centroid of straight terms that are cut at their firing strengths, by a formula: the set is split into
//! horizontal layers.
//!
//! Consider a part of the range where no terms cross. At any degree, the maximum of the cut terms covers the same
//! values as one single term: the highest one whose firing strength exceeds that degree. A term therefore
//! contributes the layer that extends from the largest firing strength of the terms above it (the base of the
//! layer) up to its own firing strength, if that is larger.

use super::Arrays;
use super::operators::{larger, smaller};
use crate::rows::set;

/// The layers of an output.
#[doc(hidden)] // Exported data.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[repr(C)]
pub struct LayeredSet {
    /// The index of the first base.
    pub first_base: u32,
    /// The index after the last base.
    pub end_base: u32,
    /// The index of the first layer.
    pub first_layer: u32,
    /// The index after the last layer.
    pub end_layer: u32,
}

/// The largest firing strength of a list of terms. It is computed as the larger of two values: the base of all terms
/// but the last, and the firing strength of the last term.
#[doc(hidden)] // Exported data.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[repr(C)]
pub struct Base {
    /// 1 plus the index in the set of the base of all terms but the last. 0 if there is no other term; their largest
    /// firing strength is then 0.
    pub others: u32,
    /// The index of the last term's firing strength among those of the output.
    pub strength: u32,
}

/// Four layers of one term. Four numbers fill the vector registers of most processors.
///
/// Each layer covers a part of the range where the term is straight and the same terms are above it. If the term
/// is cut at a degree h, it has the following area and moment on this part, with `u = min(h, high)` and
/// `v = max(u - low, 0)`:
///
/// ```text
/// area(h)   = area[0] u + area[1] v^2
/// moment(h) = moment[0] u + moment[1] v^2 + moment[2] v^3
/// ```
///
/// The area and moment of a layer are the differences between the values of these formulas at its upper end and at
/// its base. For a part of width w whose middle is at m (relative to the middle of the range), the coefficients
/// are `w, -w / 2d` and `w m, -w l / 2d, s w^2 / 6d^2`, with `d = high - low`, l the value at the lower end, and
/// s = 1 if the term falls, -1 if it rises. If the term is level, the coefficients of the powers of v are 0.
#[doc(hidden)] // Exported data.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[repr(C)]
pub struct Layers {
    /// For each layer, the smaller of the degrees at the ends of its part.
    pub low: [f64; 4],
    /// For each layer, the larger of the degrees at the ends of its part.
    pub high: [f64; 4],
    /// The coefficients of the areas.
    pub area: [[f64; 4]; 2],
    /// The coefficients of the moments.
    pub moment: [[f64; 4]; 3],
    /// The bases, encoded as in [`Base::others`].
    pub bases: [u32; 4],
    /// The index of the term's firing strength among those of the output.
    pub strength: u32,
}

impl Layers {
    /// Returns the area and moment between the bases and a firing strength.
    #[inline(always)]
    fn between(&self, bases: [f64; 4], strength: f64) -> (f64, f64) {
        let (mut areas, mut moments) = ([0.0; 4], [0.0; 4]);
        for i in 0..4 {
            let powers = |degree: f64| {
                let u = smaller(degree, self.high[i]);
                let v = larger(u - self.low[i], 0.0);
                [u, v * v, v * v * v]
            };
            let upper = powers(larger(strength, bases[i]));
            let lower = powers(bases[i]);
            let [u, v2, v3] = [
                upper[0] - lower[0],
                upper[1] - lower[1],
                upper[2] - lower[2],
            ];
            areas[i] = self.area[0][i] * u + self.area[1][i] * v2;
            moments[i] = self.moment[0][i] * u + self.moment[1][i] * v2 + self.moment[2][i] * v3;
        }
        let sum = |[a, b, c, d]: [f64; 4]| (a + b) + (c + d);
        (sum(areas), sum(moments))
    }
}

impl LayeredSet {
    fn layers<'t, A: Arrays>(&self, table: &'t A) -> &'t [Layers] {
        &table.layers()[self.first_layer as usize..self.end_layer as usize]
    }

    /// Returns the area and moment of a term at a firing strength of 1 while no other term fires. `strength` is the
    /// index of its firing strength.
    pub(super) fn of_single_term<A: Arrays>(&self, table: &A, strength: u32) -> (f64, f64) {
        let layers = self.layers(table).iter();
        let parts = layers.filter(|four| four.strength == strength);
        parts.fold((0.0, 0.0), |(area, moment), four| {
            let (a, m) = four.between([0.0; 4], 1.0);
            (area + a, moment + m)
        })
    }

    /// Returns the areas and moments of the aggregated set. `bases` needs one element more than there are bases.
    #[inline(always)]
    pub(super) fn integrals<A: Arrays, const L: usize>(
        &self,
        table: &A,
        strengths: &[[f64; L]],
        bases: &mut [[f64; L]],
    ) -> [[f64; L]; 2] {
        bases[0] = [0.0; L];
        let of_set = &table.bases()[self.first_base as usize..self.end_base as usize];
        for (base, index) in of_set.iter().zip(1..) {
            let (known, new) = bases.split_at_mut(index);
            let others = &known[base.others as usize];
            let last = &strengths[base.strength as usize];
            set(&mut new[0], |row| larger(others[row], last[row]));
        }
        let (mut areas, mut moments) = ([0.0; L], [0.0; L]);
        for four in self.layers(table) {
            let strengths = &strengths[four.strength as usize];
            if strengths.iter().all(|strength| *strength <= 0.0) {
                continue;
            }
            let [a, b, c, d] = four.bases.map(|base| &bases[base as usize]);
            for row in 0..L {
                let bases = [a[row], b[row], c[row], d[row]];
                let (area, moment) = four.between(bases, strengths[row]);
                areas[row] += area;
                moments[row] += moment;
            }
        }
        [areas, moments]
    }
}
