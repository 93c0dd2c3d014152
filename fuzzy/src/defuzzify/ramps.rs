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
use crate::operators::{FROM_TINY, TINY, smaller};

#[derive(Debug, Clone)]
pub(crate) struct Ramps {
    /// Terms from left to right, made up to an even number.
    pairs: Vec<Pair>,
    /// The rank of each term from left to right.
    ranks: Vec<usize>,
}

/// The coefficients of two neighbouring terms, and of the overlap of each with the term to its right.
/// Two at a time, because that is how many every processor computes at once.
#[derive(Debug, Clone, Copy, Default)]
struct Pair {
    /// `area = area[0] h + area[1] h^2`.
    area: [[f64; 2]; 2],
    /// `moment = moment[0] h + moment[1] h^2 + moment[2] h^3`.
    moment: [[f64; 2]; 3],
    /// The width of the overlap; 0 without one.
    width: [f64; 2],
    /// The overlap's middle, from the middle of the range.
    middle: [f64; 2],
}

impl Ramps {
    /// `None` where the terms are no partition.
    pub(crate) fn new(lines: &Polylines, terms: usize, origin: f64) -> Option<Self> {
        // Without a part in the range a term has no place, and stands behind all others.
        let mut places = vec![f64::INFINITY; terms];
        for (from, to, alive) in lines.intervals() {
            for line in alive {
                // The middle of its highest interval, or the end of the range next to its top.
                let x = 0.5 * (from + to) + 0.5 * (to - from) * (line.right - line.left);
                let place = places.get_mut(line.term)?;
                *place = if place.is_finite() {
                    0.5 * (*place + x)
                } else {
                    x
                };
            }
        }
        let mut order: Vec<usize> = (0..terms).collect();
        order.sort_by(|a, b| f64::total_cmp(&places[*a], &places[*b]));
        let mut ranks = vec![0; terms];
        for (rank, term) in order.into_iter().enumerate() {
            ranks[term] = rank;
        }
        let mut ramps = Ramps {
            pairs: vec![Pair::default(); terms.div_ceil(2)],
            ranks,
        };
        for (from, to, alive) in lines.intervals() {
            let (w, m) = (to - from, from + 0.5 * (to - from) - origin);
            let (mut falling, mut rising) = (None, None);
            for line in alive {
                let rank = ramps.ranks[line.term];
                let Pair { area, moment, .. } = &mut ramps.pairs[rank / 2];
                let lane = rank % 2;
                let side = match (line.left, line.right) {
                    (0.0, 1.0) => {
                        rising = Some(rank);
                        1.0
                    }
                    (1.0, 0.0) => {
                        falling = Some(rank);
                        -1.0
                    }
                    (1.0, 1.0) if alive.len() == 1 => {
                        area[0][lane] += w;
                        moment[0][lane] += m * w;
                        continue;
                    }
                    _ => return None,
                };
                area[0][lane] += w;
                area[1][lane] -= 0.5 * w;
                moment[0][lane] += m * w;
                moment[1][lane] += w * (0.25 * side * w - 0.5 * m);
                moment[2][lane] -= side * w * w / 6.0;
            }
            match (falling, rising, alive.len()) {
                (Some(left), Some(right), 2) if right == left + 1 => {
                    ramps.pairs[left / 2].width[left % 2] = w;
                    ramps.pairs[left / 2].middle[left % 2] = m;
                }
                (_, _, 0 | 1) => {}
                _ => return None,
            }
        }
        Some(ramps)
    }

    /// The place of each term's height: heights stand from left to right.
    pub(crate) fn ranks(&self) -> &[usize] {
        &self.ranks
    }

    /// How many heights are read, the last ones always 0.
    pub(crate) fn places(&self) -> usize {
        2 * self.pairs.len() + 1
    }

    /// Whether a term is 0 on the whole range.
    pub(crate) fn is_empty(&self, term: usize) -> bool {
        let area = |rank: usize| self.pairs[rank / 2].area[0][rank % 2];
        self.ranks.get(term).is_none_or(|rank| area(*rank) <= 0.0)
    }

    /// Area and moment of the aggregated set.
    #[inline(always)]
    pub(crate) fn integrals(&self, heights: &[f64], origin: f64) -> Integrals {
        let (mut area, mut moment) = ([0.0; 2], [0.0; 2]);
        for (pair, i) in self.pairs.iter().zip((0..).step_by(2)) {
            let heights: &[f64] = &heights[i..i + 3];
            for side in 0..2 {
                let (a, m) = pair.add(side, heights[side], heights[side + 1]);
                area[side] += a;
                moment[side] += m;
            }
        }
        Integrals {
            area: area[0] + area[1],
            moment: moment[0] + moment[1],
            origin,
        }
    }

    /// The centroids of several sets at once; `strongest` is the largest height of each. The same
    /// operations in the same order as one at a time.
    #[inline(always)]
    pub(crate) fn centroids<const N: usize>(
        &self,
        heights: &[[f64; N]],
        strongest: &[f64; N],
        origin: f64,
    ) -> [f64; N] {
        let mut scale = [1.0; N];
        for lane in 0..N {
            scale[lane] = if strongest[lane] < TINY {
                FROM_TINY
            } else {
                1.0
            };
        }
        let (mut area, mut moment) = ([[0.0; N]; 2], [[0.0; N]; 2]);
        for (pair, i) in self.pairs.iter().zip((0..).step_by(2)) {
            let heights: &[[f64; N]] = &heights[i..i + 3];
            for side in 0..2 {
                let (here, right) = (&heights[side], &heights[side + 1]);
                for lane in 0..N {
                    let scale = scale[lane];
                    let (a, m) = pair.add(side, here[lane] * scale, right[lane] * scale);
                    area[side][lane] += a;
                    moment[side][lane] += m;
                }
            }
        }
        let mut centroids = [0.0; N];
        for lane in 0..N {
            let (area, moment) = (
                area[0][lane] + area[1][lane],
                moment[0][lane] + moment[1][lane],
            );
            centroids[lane] = origin + moment / area;
        }
        centroids
    }
}

impl Pair {
    /// Area and moment that one of the two terms adds, at its height and the one to its right.
    #[inline(always)]
    fn add(&self, side: usize, h: f64, right: f64) -> (f64, f64) {
        let v = smaller(smaller(h, right), 0.5);
        let common = self.width[side] * (v * (1.0 - v));
        let area = h * (self.area[0][side] + h * self.area[1][side]) - common;
        let cubic = self.moment[1][side] + h * self.moment[2][side];
        let alone = h * (self.moment[0][side] + h * cubic);
        (area, alone - self.middle[side] * common)
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
                .term("high", triangle(50.0, 75.0, 100.0))
                .term("medium", triangle(25.0, 50.0, 75.0))
                .term("low", triangle(0.0, 25.0, 50.0))
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
            let ramps = Ramps::new(&lines, count, origin).unwrap();
            let mut ranked = vec![0.0; ramps.places()];
            for (height, rank) in heights.iter().zip(ramps.ranks()) {
                ranked[*rank] = *height;
            }
            let fast = ramps.integrals(&ranked, origin);
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
