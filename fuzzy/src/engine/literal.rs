//! The literals of an input, as straight lines on intervals.

use alloc::vec::Vec;

use crate::model::{MembershipFunction, Term};
use crate::rule::Hedge;
use crate::table::Line;

/// A term of an input with its hedges, in the order in which they are applied.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Literal {
    pub(super) term: Term,
    pub(super) hedges: Vec<Hedge>,
}

/// The literals of an input. Straight literals are divided into intervals, so that an evaluation reads only those that
/// can be above 0.
#[derive(Debug, Clone)]
pub(super) struct Literals {
    /// The index of the first literal of this input among those of all inputs.
    pub(super) first: u32,
    /// The number of literals.
    pub(super) count: u32,
    /// The limits between intervals. Values below the first cut are in interval 0.
    pub(super) cuts: Vec<f64>,
    /// The index of the first line of each interval: the lines above 0 on interval i are
    /// `lines[starts[i]..starts[i + 1]]`.
    pub(super) starts: Vec<u32>,
    pub(super) lines: Vec<Line>,
    pub(super) curved: Vec<(u32, Literal)>,
}

impl Literals {
    pub(super) fn new(first: u32, literals: Vec<Literal>, low: f64, high: f64) -> Self {
        let count = literals.len() as u32;
        let (mut straight, mut curved) = (Vec::new(), Vec::new());
        for (literal, index) in literals.into_iter().zip(0..) {
            match lines(&literal) {
                Some(lines) => straight.push((index, lines)),
                None => curved.push((index, literal)),
            }
        }
        let starts = straight.iter().flat_map(|(_, lines)| lines);
        let mut cuts: Vec<f64> = starts.map(|(start, _)| *start).collect();
        cuts.retain(|x| low < *x && *x <= high);
        cuts.sort_by(f64::total_cmp);
        cuts.dedup();
        let mut table = Literals {
            first,
            count,
            starts: Vec::from([0]),
            lines: Vec::new(),
            curved,
            cuts: Vec::new(),
        };
        for &x in core::iter::once(&low).chain(&cuts) {
            for (index, lines) in &straight {
                let alive = lines.iter().rev().find(|(start, _)| *start <= x);
                if let Some((_, line)) = alive
                    && (line.base > 0.0 || line.rise > 0.0)
                {
                    table.lines.push(Line {
                        literal: *index,
                        ..*line
                    });
                }
            }
            table.starts.push(table.lines.len() as u32);
        }
        table.cuts = cuts;
        table
    }

    /// Stores all literals as formulas, to evaluate several values together.
    pub(super) fn by_formula(first: u32, literals: Vec<Literal>) -> Self {
        Literals {
            first,
            count: literals.len() as u32,
            cuts: Vec::new(),
            starts: Vec::from([0, 0]),
            lines: Vec::new(),
            curved: (0..).zip(literals).collect(),
        }
    }

    /// Iterates over the intervals; each item contains the lines above 0 on the interval.
    pub(super) fn intervals(&self) -> impl Iterator<Item = &[Line]> {
        let ends = self.starts.iter().zip(self.starts.iter().skip(1));
        ends.map(|(start, end)| &self.lines[*start as usize..*end as usize])
    }

    pub(super) fn has_curved(&self) -> bool {
        !self.curved.is_empty()
    }

    /// Returns the maximum number of literals that can be above 0 at the same value.
    pub(super) fn most_alive(&self) -> usize {
        let most = self.intervals().map(<[Line]>::len).max();
        most.unwrap_or(0) + self.curved.len()
    }
}

/// Returns the lines of a straight term of height 1 without hedges, each with the start of its interval, beginning at
/// minus infinity. `None` for any other literal.
pub(super) fn lines(literal: &Literal) -> Option<Vec<(f64, Line)>> {
    if !literal.hedges.is_empty() || literal.term.height != 1.0 {
        return None;
    }
    let shape = &literal.term.membership_function;
    let corners = shape.corners()?;
    let mut lines = Vec::new();
    let mut before: Option<(f64, f64)> = None;
    for &(x, y) in &corners {
        match before {
            None => lines.push((f64::NEG_INFINITY, Line::flat(0, y))),
            Some(left) if left.0 < x => after(&mut lines, shape, left, Some((x, y))),
            Some(_) => {}
        }
        before = Some((x, y));
    }
    if let Some(last) = before {
        after(&mut lines, shape, last, None);
    }
    Some(lines)
}

/// Adds the line from a corner to the next one, or to infinity if there is none. At a discontinuity the corner itself
/// may have a different degree, and then gets its own line.
fn after(
    lines: &mut Vec<(f64, Line)>,
    shape: &MembershipFunction,
    corner: (f64, f64),
    next: Option<(f64, f64)>,
) {
    let (x, y) = corner;
    let at_corner = shape.membership(x);
    let start = if at_corner == y {
        x
    } else {
        lines.push((x, Line::flat(0, at_corner)));
        x.next_up()
    };
    let line = match next {
        Some(next) if next.1 != y => {
            let (low, high) = if y < next.1 {
                (corner, next)
            } else {
                (next, corner)
            };
            Line {
                literal: 0,
                foot: low.0,
                run: high.0 - low.0,
                base: low.1,
                rise: high.1 - low.1,
            }
        }
        _ => Line::flat(0, y),
    };
    lines.push((start, line));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::arrays::OwnedTable;
    use crate::table;
    use alloc::{string::String, vec};
    use proptest::prelude::*;

    fn shapes() -> Vec<MembershipFunction> {
        vec![
            MembershipFunction::Triangle {
                left: 0.1,
                peak: 0.3,
                right: 0.7,
            },
            MembershipFunction::Triangle {
                left: 0.0,
                peak: 0.0,
                right: 0.7,
            },
            MembershipFunction::Triangle {
                left: 0.2,
                peak: 1.0,
                right: 1.0,
            },
            MembershipFunction::Triangle {
                left: 0.5,
                peak: 0.5,
                right: 0.5,
            },
            MembershipFunction::Trapezoid {
                left: -0.5,
                left_top: 0.2,
                right_top: 0.4,
                right: 1.5,
            },
            MembershipFunction::LeftShoulder {
                top: 0.25,
                foot: 0.25,
            },
            MembershipFunction::RightShoulder {
                foot: 0.1,
                top: 0.9,
            },
            MembershipFunction::Rectangle {
                left: 0.25,
                right: 0.5,
            },
            MembershipFunction::Singleton { at: 0.5 },
            MembershipFunction::Constant { value: 0.4 },
            MembershipFunction::Piecewise {
                points: vec![
                    (0.1, 0.5),
                    (0.3, 0.2),
                    (0.3, 0.9),
                    (0.6, 0.1),
                    (0.6, 0.0),
                    (0.9, 0.3),
                ],
            },
            MembershipFunction::Gaussian { mean: 0.4, sd: 0.1 },
        ]
    }

    fn literal(membership_function: MembershipFunction, hedges: &[Hedge]) -> Literal {
        Literal {
            term: Term {
                name: String::new(),
                membership_function,
                height: 1.0,
                lower: None,
            },
            hedges: hedges.to_vec(),
        }
    }

    proptest! {
        /// The table is bitwise equal to the membership functions.
        #[test]
        fn the_table_equals_the_membership_function(x in prop_oneof![
            0.0..=1.0,
            prop::sample::select(vec![0.0, 0.1, 0.2, 0.25, 0.3, 0.5, 0.6, 0.7, 0.9, 1.0]),
        ], ulps in -1..=1) {
            let x: f64 = x;
            let x = match ulps { -1 => x.next_down(), 1 => x.next_up(), _ => x }.clamp(0.0, 1.0);
            let mut all: Vec<Literal> =
                shapes().into_iter().map(|shape| literal(shape, &[])).collect();
            all.push(literal(MembershipFunction::LeftShoulder { top: 0.2, foot: 0.6 }, &[Hedge::Very, Hedge::Not]));
            let mut owned = OwnedTable::default();
            owned.input(&Literals::new(0, all.clone(), 0.0, 1.0), 0.0, 1.0);
            let mut degrees = vec![[0.0]; all.len()];
            table::degrees_in_rows(&owned, &owned.inputs[0], &[x], &mut degrees);
            for (literal, [degree]) in all.iter().zip(degrees) {
                let plain = literal.term.membership(x);
                let expected = literal.hedges.iter().fold(plain, |degree, hedge| hedge.of(degree));
                prop_assert_eq!(degree, expected, "{:?} at {}", literal, x);
            }
        }
    }
}
