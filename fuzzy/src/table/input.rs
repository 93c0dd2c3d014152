//! From an input's value to the degrees of its literals. A literal is a term, hedged or not.

use super::operators::Hedge;
use super::{Arrays, Kind};
use crate::rows::each;

/// An input: its range and its literals.
#[doc(hidden)] // Exported data.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Input {
    /// The lower end of its range.
    pub low: f64,
    /// The upper end of its range.
    pub high: f64,
    /// The index of its first literal among those of all inputs.
    pub first_literal: u32,
    /// Its span of cuts. A value below the first cut is in the first interval.
    pub first_cut: u32,
    /// The end of that span.
    pub end_cut: u32,
    /// The index in `starts` of its first interval.
    pub first_start: u32,
    /// Its span of curves.
    pub first_curve: u32,
    /// The end of that span.
    pub end_curve: u32,
}

/// `base + rise ((x - foot) / run)`, the degree of a literal on an interval.
#[doc(hidden)] // Exported data.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Line {
    /// The lower end of the slope. Measured from there, the degree is exactly 0 at the foot and exactly 1 at the top, and
    /// near the foot it is as exact as the value.
    pub foot: f64,
    /// The width of the slope; negative where it falls.
    pub run: f64,
    /// The degree at its foot.
    pub base: f64,
    /// The degree at its top less that at its foot.
    pub rise: f64,
    /// The index of the literal among its input's; in a uniform table, its offset among the cells.
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
    pub kind: Kind,
    /// The index of the literal among its input's.
    pub literal: u32,
    /// Its span of points, where it is piecewise linear or a formula.
    pub first_point: u32,
    /// The end of that span.
    pub end_point: u32,
    /// Its span of hedges, in the order in which they apply.
    pub first_hedge: u32,
    /// The end of that span.
    pub end_hedge: u32,
}

impl Line {
    /// A constant degree.
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

/// Writes the degrees of the literals that can be over 0 at the values of each row.
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
            degrees[line.literal as usize] = each(|row| line.degree(values[row]));
        }
    }
    let first = [values[0]];
    // Along a row of a map all inputs but one stay the same.
    let is_same = L > 1
        && values
            .iter()
            .all(|value| value.to_bits() == values[0].to_bits());
    for curve in curves(table, input) {
        degrees[curve.literal as usize] = if is_same {
            let [degree] = along(table, curve, &first);
            [degree; L]
        } else {
            along(table, curve, values)
        };
    }
}

/// The lines on the interval that holds `x`.
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

/// The degrees of a curve at the values of each row.
#[inline(always)]
pub(super) fn along<A: Arrays, const L: usize>(
    table: &A,
    curve: &Curve,
    values: &[f64; L],
) -> [f64; L] {
    let points = &table.points()[curve.first_point as usize..curve.end_point as usize];
    let hedges = &table.hedges()[curve.first_hedge as usize..curve.end_hedge as usize];
    curve.degrees(points, hedges, values)
}

impl Curve {
    #[inline(always)]
    pub(super) fn degrees<const L: usize>(
        &self,
        points: &[Point],
        hedges: &[Hedge],
        values: &[f64; L],
    ) -> [f64; L] {
        let degrees = self.kind.memberships(&self.parameters, points, values);
        let mut degrees = each(|row| self.height * degrees[row]);
        for hedge in hedges {
            degrees = each(|row| hedge.of(degrees[row]));
        }
        degrees
    }
}
