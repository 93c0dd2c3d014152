//! From an input's value to the degrees of the literals on it.

use super::operators::Hedge;
use super::{Arrays, Kind};

/// An input: its range, and where its literals (terms, hedged or not) stand.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Input {
    /// The lower end of its range.
    pub low: f64,
    /// The upper end of its range.
    pub high: f64,
    /// The first of its literals among all.
    pub first_literal: u32,
    /// Its cuts: values before the first lie in its first interval.
    pub first_cut: u32,
    /// Where its cuts end.
    pub end_cut: u32,
    /// Where, in the starts, that of its first interval stands.
    pub first_start: u32,
    /// Its curves.
    pub first_curve: u32,
    /// Where its curves end.
    pub end_curve: u32,
}

/// `base + rise ((x - foot) / run)`, the degree of a literal on an interval.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Line {
    /// Measured from the lower end of a slope: exactly 0 at its foot, exactly 1 at its top, and as exact as the value
    /// itself near the foot.
    pub foot: f64,
    /// The width of the slope; negative where it falls.
    pub run: f64,
    /// The degree at its foot.
    pub base: f64,
    /// How far it rises.
    pub rise: f64,
    /// The literal, by its place among its input's; in a uniform table, its offset among the cells.
    pub literal: u32,
}

/// A literal that is curved or hedged.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Curve {
    /// The parameters of the shape.
    pub parameters: [f64; 4],
    /// The height of the term.
    pub height: f64,
    /// The shape.
    pub kind: Kind,
    /// The literal, by its place among its input's.
    pub literal: u32,
    /// The points of a shape made of them.
    pub first_point: u32,
    /// Where they end.
    pub end_point: u32,
    /// The hedges, in the order in which they apply.
    pub first_hedge: u32,
    /// Where they end.
    pub end_hedge: u32,
}

impl Line {
    /// The same degree everywhere.
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

/// Calls `visit` with each literal of an input that may be alive at `x`, by its place among the input's, and its
/// degree, which may be 0.
#[inline(always)]
pub(crate) fn degrees<A: Arrays>(
    table: &A,
    input: &Input,
    x: f64,
    mut visit: impl FnMut(u32, f64),
) {
    let cuts = &table.cuts()[input.first_cut as usize..input.end_cut as usize];
    let interval: usize = if cuts.len() <= 16 {
        cuts.iter().map(|cut| usize::from(x >= *cut)).sum()
    } else {
        cuts.partition_point(|cut| x >= *cut)
    };
    let start = input.first_start as usize + interval;
    let (start, end) = (table.starts()[start], table.starts()[start + 1]);
    for line in &table.lines()[start as usize..end as usize] {
        visit(line.literal, line.degree(x));
    }
    for curve in &table.curves()[input.first_curve as usize..input.end_curve as usize] {
        let points = &table.points()[curve.first_point as usize..curve.end_point as usize];
        let hedges = &table.hedges()[curve.first_hedge as usize..curve.end_hedge as usize];
        visit(curve.literal, curve.degree(points, hedges, x));
    }
}

impl Curve {
    // Not a function of the table: one that is called with all of it would have it built in memory for every evaluation.
    #[inline(always)]
    fn degree(&self, points: &[[f64; 2]], hedges: &[Hedge], x: f64) -> f64 {
        let degree = self.height * self.kind.membership(&self.parameters, points, x);
        hedges.iter().fold(degree, |degree, hedge| hedge.of(degree))
    }
}
