//! The centroid of minimum and maximum as a polynomial in the heights, for partitions: terms of height 1
//! that rise straight from 0 to 1, stay there and fall straight to 0, of which two overlap only where one
//! falls from 1 to 0 while the other rises from 0 to 1.
//!
//! A term cut at height h has, on a slope of width w around its middle m (from the middle of the range),
//! area `w (h - h^2 / 2)` and first moment `m area + s w^2 (h^2 / 4 - h^3 / 6)`, with s = 1 rising and -1
//! falling; on a plateau `w h` and `m w h`. Both sum over the term's stretches to polynomials in h. Where a
//! falling and a rising slope overlap, the minimum of the two cut terms has area `w v (1 - v)` with
//! `v = min(h_falling, h_rising, 1/2)`, symmetric about m. The union's area is the sum less the overlaps.

use alloc::{vec, vec::Vec};

use super::piece::Integrals;
use super::polyline::Polylines;
use crate::engine::operators::smaller;

#[derive(Debug, Clone)]
pub(crate) struct Ramps {
    terms: Vec<Polynomials>,
    overlaps: Vec<Overlap>,
}

/// `area = area[0] h + area[1] h^2`, `moment = moment[0] h + moment[1] h^2 + moment[2] h^3`.
#[derive(Debug, Clone, Copy, Default)]
struct Polynomials {
    area: [f64; 2],
    moment: [f64; 3],
}

#[derive(Debug, Clone, Copy)]
struct Overlap {
    falling: u32,
    rising: u32,
    width: f64,
    /// The middle of the overlap, from the middle of the range.
    middle: f64,
}

impl Ramps {
    /// `None` where the terms are no partition.
    pub(crate) fn new(lines: &Polylines, terms: usize, origin: f64) -> Option<Self> {
        let mut ramps = Ramps {
            terms: vec![Polynomials::default(); terms],
            overlaps: Vec::new(),
        };
        for (from, to, alive) in lines.intervals() {
            let (w, m) = (to - from, from + 0.5 * (to - from) - origin);
            let (mut falling, mut rising) = (None, None);
            for line in alive {
                let Polynomials { area, moment } = ramps.terms.get_mut(line.term)?;
                let side = match (line.left, line.right) {
                    (0.0, 1.0) => {
                        rising = Some(line.term as u32);
                        1.0
                    }
                    (1.0, 0.0) => {
                        falling = Some(line.term as u32);
                        -1.0
                    }
                    (1.0, 1.0) if alive.len() == 1 => {
                        area[0] += w;
                        moment[0] += m * w;
                        continue;
                    }
                    _ => return None,
                };
                area[0] += w;
                area[1] -= 0.5 * w;
                moment[0] += m * w;
                moment[1] += w * (0.25 * side * w - 0.5 * m);
                moment[2] -= side * w * w / 6.0;
            }
            match (falling, rising, alive.len()) {
                (Some(falling), Some(rising), 2) => ramps.overlaps.push(Overlap {
                    falling,
                    rising,
                    width: w,
                    middle: m,
                }),
                (_, _, 0 | 1) => {}
                _ => return None,
            }
        }
        Some(ramps)
    }

    /// Whether a term is 0 on the whole range.
    pub(crate) fn is_empty(&self, term: usize) -> bool {
        self.terms.get(term).is_none_or(|term| term.area[0] <= 0.0)
    }

    /// Area and moment of the aggregated set; `heights` has one for each term.
    #[inline(always)]
    pub(crate) fn integrals(&self, heights: &[f64], origin: f64) -> Integrals {
        let (mut area, mut moment) = (0.0, 0.0);
        for (term, &h) in self.terms.iter().zip(heights) {
            area += h * (term.area[0] + h * term.area[1]);
            moment += h * (term.moment[0] + h * (term.moment[1] + h * term.moment[2]));
        }
        for overlap in &self.overlaps {
            let (a, b) = (
                heights[overlap.falling as usize],
                heights[overlap.rising as usize],
            );
            let v = smaller(smaller(a, b), 0.5);
            let common = overlap.width * (v * (1.0 - v));
            area -= common;
            moment -= overlap.middle * common;
        }
        Integrals {
            area,
            moment,
            origin,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::defuzzify::polyline::Room;
    use crate::defuzzify::{Heights, Joint};
    use crate::model::{Aggregation, Implication, Shape, Variable};
    use proptest::prelude::*;

    /// The partition of the example risks, an unsymmetric one, and one with plateaus and gaps.
    fn partitions() -> Vec<Variable> {
        let triangle = |left, peak, right| Shape::Triangle { left, peak, right };
        vec![
            Variable::new("risk", 0.0, 100.0)
                .term("very_low", triangle(-25.0, 0.0, 25.0))
                .term("low", triangle(0.0, 25.0, 50.0))
                .term("medium", triangle(25.0, 50.0, 75.0))
                .term("high", triangle(50.0, 75.0, 100.0))
                .term("very_high", triangle(75.0, 100.0, 125.0)),
            Variable::new("uneven", -3.0, 8.0)
                .term(
                    "a",
                    Shape::LeftShoulder {
                        top: -1.0,
                        foot: 0.0,
                    },
                )
                .term("b", triangle(-1.0, 0.0, 6.0))
                .term(
                    "c",
                    Shape::RightShoulder {
                        foot: 0.0,
                        top: 6.0,
                    },
                ),
            Variable::new("apart", 0.0, 10.0)
                .term("a", triangle(0.0, 1.0, 2.0))
                .term(
                    "b",
                    Shape::Rectangle {
                        left: 3.0,
                        right: 4.0,
                    },
                )
                .term(
                    "c",
                    Shape::Trapezoid {
                        left: 5.0,
                        left_top: 6.0,
                        right_top: 7.0,
                        right: 10.0,
                    },
                ),
        ]
    }

    proptest! {
        /// The polynomials and the walk over pieces are two ways to one number.
        #[test]
        fn polynomials_equal_pieces(
            which in 0..3usize,
            heights in prop::collection::vec(
                prop_oneof![Just(0.0), Just(0.5), Just(1.0), 0.0..=1.0, 1e-12..1e-9], 5),
        ) {
            let variable = &partitions()[which];
            let lines = Polylines::new(&variable.terms, variable.low, variable.high).unwrap();
            let count = variable.terms.len();
            let origin = 0.5 * (variable.low + variable.high);
            let heights = &heights[..count];
            let fast = Ramps::new(&lines, count, origin).unwrap().integrals(heights, origin);
            let places: Vec<usize> = (0..=count).collect();
            let mut slow = Integrals::about(origin);
            let joint = Joint {
                implication: Implication::Minimum,
                aggregation: Aggregation::Maximum,
            };
            let heights = Heights { heights, places: &places };
            lines.pieces(heights, joint, &mut Room::new(count, 0), &mut |piece| slow.add(piece));
            match (fast.centroid(), slow.centroid()) {
                (Some(fast), Some(slow)) => {
                    prop_assert!((fast - slow).abs() <= 1e-12 * (variable.high - variable.low));
                }
                (fast, slow) => prop_assert_eq!(fast, slow),
            }
        }
    }
}
