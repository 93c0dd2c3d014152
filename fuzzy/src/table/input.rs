//! Computing the degrees of literals from the value of an input. A literal is a term, with or without hedges.

use super::operators::Hedge;
use super::{Arrays, ShapeKind};
use crate::rows::{change, set};

/// An input: its range and its literals.
#[doc(hidden)] // Exported data.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Input {
    /// The lower end of the range.
    pub low: f64,
    /// The upper end of the range.
    pub high: f64,
    /// The index of the first literal among those of all inputs.
    pub first_literal: u32,
    /// The index of the first cut. A value below the first cut is in the first interval.
    pub first_cut: u32,
    /// The index after the last cut.
    pub end_cut: u32,
    /// The index in `starts` of the first interval.
    pub first_start: u32,
    /// The index of the first curve.
    pub first_curve: u32,
    /// The index after the last curve.
    pub end_curve: u32,
}

/// The degree of a literal on an interval: `base + rise ((x - foot) / run)`.
#[doc(hidden)] // Exported data.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Line {
    /// The lower end of the slope. Since `x` is measured relative to it, the degree is exactly 0 at the foot and
    /// exactly 1 at the top, and near the foot it is as accurate as the value.
    pub foot: f64,
    /// The width of the slope; negative if the slope falls.
    pub run: f64,
    /// The degree at the foot of the slope.
    pub base: f64,
    /// The difference between the degrees at the top and at the foot of the slope.
    pub rise: f64,
    /// The index of the literal among those of its input; in a uniform table, its offset among the cells.
    pub literal: u32,
}

/// A corner `(x, degree)` of a piecewise linear membership function, or an instruction of a formula.
#[doc(hidden)] // Exported data.
pub type Point = [f64; 2];

/// A literal that is curved or hedged.
#[doc(hidden)] // Exported data.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Curve {
    /// The parameters of the membership function.
    pub parameters: [f64; 4],
    /// The height of the term.
    pub height: f64,
    /// The kind of membership function.
    pub kind: ShapeKind,
    /// The index of the literal among those of its input.
    pub literal: u32,
    /// The index of the first point, if the function is piecewise linear or a formula.
    pub first_point: u32,
    /// The index after the last point.
    pub end_point: u32,
    /// The index of the first hedge; hedges are in the order in which they are applied.
    pub first_hedge: u32,
    /// The index after the last hedge.
    pub end_hedge: u32,
}

impl Line {
    /// Returns a line of constant degree.
    pub(crate) const fn flat(literal: u32, degree: f64) -> Self {
        Line {
            literal,
            foot: 0.0,
            run: f64::INFINITY,
            base: degree,
            rise: 0.0,
        }
    }

    #[inline(always)]
    pub(crate) fn degree(&self, x: f64) -> f64 {
        self.base + self.rise * ((x - self.foot) / self.run)
    }
}

/// Computes, for each row, the degrees of those literals that can be above 0 at the value of the row.
#[inline(always)]
pub(crate) fn degrees_in_rows<A: Arrays, const L: usize>(
    table: &A,
    input: &Input,
    values: &[f64; L],
    degrees: &mut [[f64; L]],
) {
    if input.first_cut < input.end_cut {
        for row in 0..L {
            for line in lines(table, input, values[row]) {
                degrees[line.literal as usize][row] = line.degree(values[row]);
            }
        }
    } else if let Some(&x) = values.first() {
        for line in lines(table, input, x) {
            set(&mut degrees[line.literal as usize], |row| {
                line.degree(values[row])
            });
        }
    }
    // Along a row of a map, all inputs but one are constant.
    let is_same = L > 1
        && values
            .iter()
            .all(|value| value.to_bits() == values[0].to_bits());
    for curve in curves(table, input) {
        let degrees = &mut degrees[curve.literal as usize];
        if is_same {
            let mut degree = [0.0];
            along(table, curve, &[values[0]], &mut degree);
            degrees.fill(degree[0]);
        } else {
            along(table, curve, values, degrees);
        }
    }
}

/// Returns the lines on the interval that contains `x`.
#[inline(always)]
pub(super) fn lines<'t, A: Arrays>(table: &'t A, input: &Input, x: f64) -> &'t [Line] {
    let cuts = &table.cuts()[input.first_cut as usize..input.end_cut as usize];
    let interval: usize = if cuts.len() <= 16 {
        cuts.iter().map(|cut| usize::from(x >= *cut)).sum()
    } else {
        cuts.partition_point(|cut| x >= *cut)
    };
    let start = input.first_start as usize + interval;
    let (start, end) = (table.starts()[start], table.starts()[start + 1]);
    &table.lines()[start as usize..end as usize]
}

#[inline(always)]
pub(super) fn curves<'t, A: Arrays>(table: &'t A, input: &Input) -> &'t [Curve] {
    &table.curves()[input.first_curve as usize..input.end_curve as usize]
}

/// Computes the degrees of a curve at the values of each row.
#[inline(always)]
pub(super) fn along<A: Arrays, const L: usize>(
    table: &A,
    curve: &Curve,
    values: &[f64; L],
    degrees: &mut [f64; L],
) {
    let points = &table.points()[curve.first_point as usize..curve.end_point as usize];
    let hedges = &table.hedges()[curve.first_hedge as usize..curve.end_hedge as usize];
    curve.degrees(points, hedges, values, degrees);
}

impl Curve {
    #[inline(always)]
    pub(super) fn degrees<const L: usize>(
        &self,
        points: &[Point],
        hedges: &[Hedge],
        values: &[f64; L],
        degrees: &mut [f64; L],
    ) {
        self.kind
            .memberships(&self.parameters, points, values, degrees);
        if self.height != 1.0 {
            change(degrees, |degree| self.height * degree);
        }
        for hedge in hedges {
            change(degrees, |degree| hedge.of(degree));
        }
    }
}
