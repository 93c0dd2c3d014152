//! The centroid of the maximum over a partition, as a formula of the firing strengths. The terms of a partition have
//! height 1; each rises in a straight line from 0 to 1, may have a plateau, and falls in a straight line to 0. Two
//! terms overlap only where one falls from 1 to 0 while the other rises from 0 to 1. The formulas are documented at
//! [`Pair`].

use alloc::{vec, vec::Vec};

use super::prepared::{corners, limits};
use crate::model::Term;
use crate::table::Pair;

#[derive(Debug, Clone)]
pub(crate) struct Partition {
    /// The terms from left to right, padded to an even number.
    pairs: Vec<Pair>,
    /// For each term, its position from left to right.
    ranks: Vec<usize>,
    /// Whether terms are scaled by their firing strengths; otherwise they are cut.
    pub(crate) scales: bool,
}

impl Partition {
    /// Creates the closed form of terms that are scaled by their firing strengths or cut at them; `None` if they are
    /// not a partition. Moments are relative to `origin`; areas use the unit of length `unit`.
    pub(crate) fn new(
        terms: &[Term],
        (low, high): (f64, f64),
        (origin, unit): (f64, f64),
        scales: bool,
    ) -> Option<Self> {
        let intervals = intervals(terms, low, high)?;
        let terms = terms.len();
        // Terms that are 0 on the whole range come last.
        let mut middles = vec![f64::INFINITY; terms];
        for Interval { from, to, alive } in &intervals {
            for line in alive {
                // The position on the interval at which the term is highest, or the middle of a
                // plateau. The position of the term is an average of these.
                let x = 0.5 * (from + to) + 0.5 * (to - from) * (line.right - line.left);
                let middle = middles.get_mut(line.term)?;
                *middle = if middle.is_finite() {
                    0.5 * (*middle + x)
                } else {
                    x
                };
            }
        }
        let mut order: Vec<usize> = (0..terms).collect();
        order.sort_by(|a, b| f64::total_cmp(&middles[*a], &middles[*b]));
        let mut ranks = vec![0; terms];
        for (rank, term) in order.into_iter().enumerate() {
            ranks[term] = rank;
        }
        let mut partition = Partition {
            pairs: vec![Pair::default(); terms.div_ceil(2)],
            ranks,
            scales,
        };
        for Interval { from, to, alive } in &intervals {
            let (length, m) = (to - from, from + 0.5 * (to - from) - origin);
            let w = length / unit;
            let (mut falling, mut rising) = (None, None);
            for line in alive {
                let rank = partition.ranks[line.term];
                let Pair { area, moment, .. } = &mut partition.pairs[rank / 2];
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
                if scales {
                    area[0][lane] += 0.5 * w;
                    moment[0][lane] += w * (0.5 * m + side * length / 12.0);
                    continue;
                }
                area[0][lane] += w;
                area[1][lane] -= 0.5 * w;
                moment[0][lane] += m * w;
                moment[1][lane] += w * (0.25 * side * length - 0.5 * m);
                moment[2][lane] -= side * length * w / 6.0;
            }
            match (falling, rising, alive.len()) {
                (Some(left), Some(right), 2) if right == left + 1 => {
                    let pair = &mut partition.pairs[left / 2];
                    pair.width[left % 2] = w;
                    pair.middle[left % 2] = m;
                    if scales {
                        pair.width[left % 2] = 0.5 * w;
                        pair.moment[1][left % 2] = length / 6.0;
                    }
                }
                (_, _, 0 | 1) => {}
                _ => return None,
            }
        }
        Some(partition)
    }

    /// Returns, for each term, the index of its firing strength; the strengths are ordered from left to right.
    pub(crate) fn ranks(&self) -> &[usize] {
        &self.ranks
    }

    /// Returns the number of firing strengths that an evaluation reads: one per term of the pairs, and one more to the
    /// right of the last term. Those that belong to no term of the output are always 0.
    pub(crate) fn strengths(&self) -> usize {
        2 * self.pairs.len() + 1
    }

    /// Returns the coefficients of the polynomials.
    pub(crate) fn pairs(&self) -> &[Pair] {
        &self.pairs
    }
}

/// A part of the range on which every term is straight, with the terms that are above 0 on it.
struct Interval {
    from: f64,
    to: f64,
    alive: Vec<Line>,
}

/// A term on an interval, with its degrees just inside the ends of the interval.
struct Line {
    term: usize,
    left: f64,
    right: f64,
}

/// Splits the range at every corner of every term; `None` if a term is curved.
fn intervals(terms: &[Term], low: f64, high: f64) -> Option<Vec<Interval>> {
    let corners: Vec<_> = terms.iter().map(corners).collect::<Option<_>>()?;
    let mut cuts: Vec<f64> = corners.iter().flatten().map(|corner| corner.0).collect();
    cuts.retain(|x| low < *x && *x < high);
    cuts.extend([low, high]);
    cuts.sort_by(f64::total_cmp);
    cuts.dedup();
    let interval = |(&from, &to): (&f64, &f64)| {
        let lines = corners.iter().enumerate().map(|(term, corners)| {
            let (left, right) = limits(corners, from, to);
            Line { term, left, right }
        });
        let alive = lines.filter(|line| line.left > 0.0 || line.right > 0.0);
        Interval {
            from,
            to,
            alive: alive.collect(),
        }
    };
    Some(cuts.iter().zip(cuts.iter().skip(1)).map(interval).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::defuzzify::curves::Curves;
    use crate::defuzzify::piece::Integrals;
    use crate::defuzzify::workspace::Workspace;
    use crate::defuzzify::{ConsequentOperators, Strengths};
    use crate::model::{Aggregation, Implication, MembershipFunction, Variable};
    use crate::table::centroid;
    use proptest::prelude::*;

    /// Returns the partition of the example risks, an asymmetric one, and one with plateaus and gaps.
    fn partitions() -> Vec<Variable> {
        let triangle = |left, peak, right| MembershipFunction::Triangle { left, peak, right };
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
                    MembershipFunction::LeftShoulder {
                        top: -1.0,
                        foot: 0.0,
                    },
                )
                .term("b", triangle(-1.0, 0.0, 6.0))
                .term(
                    "c",
                    MembershipFunction::RightShoulder {
                        foot: 0.0,
                        top: 6.0,
                    },
                ),
            Variable::new("apart", 0.0, 10.0)
                .term("a", triangle(0.0, 1.0, 2.0))
                .term(
                    "b",
                    MembershipFunction::Rectangle {
                        left: 3.0,
                        right: 4.0,
                    },
                )
                .term(
                    "c",
                    MembershipFunction::Trapezoid {
                        left: 5.0,
                        left_top: 6.0,
                        right_top: 7.0,
                        right: 10.0,
                    },
                ),
        ]
    }

    proptest! {
        /// The formulas and the integration of pieces give the same number.
        #[test]
        fn formulas_equal_the_integration_of_pieces(
            which in 0..3usize,
            scales in any::<bool>(),
            strengths in prop::collection::vec(
                prop_oneof![Just(0.0), Just(0.5), Just(1.0), 0.0..=1.0, 1e-12..1e-9], 5),
        ) {
            let variable = &partitions()[which];
            let (low, high) = (variable.low, variable.high);
            let count = variable.terms.len();
            let origin = 0.5 * (variable.low + variable.high);
            let strengths = &strengths[..count];
            let partition = Partition::new(&variable.terms, (low, high), (origin, 1.0), scales).unwrap();
            let mut ranked = vec![[0.0]; partition.strengths()];
            for (strength, rank) in strengths.iter().zip(partition.ranks()) {
                ranked[*rank] = [*strength];
            }
            let add = if scales { Pair::scaled } else { Pair::cut };
            let [[area], [moment]] = Pair::integrals(partition.pairs(), &ranked, add);
            let fast = centroid(area, moment, origin);
            let offsets: Vec<usize> = (0..=count).collect();
            let mut slow = Integrals::about(origin, 1.0);
            let operators = ConsequentOperators {
                implication: if scales { Implication::Product } else { Implication::Minimum },
                aggregation: Aggregation::Maximum,
            };
            let strengths = Strengths { strengths, offsets: &offsets };
            let curves = Curves::new(&variable.terms, low, high);
            let mut workspace = Workspace::new(count, 5 * count + curves.workspace());
            curves.pieces(strengths, operators, &mut workspace, &mut |piece| slow.add(piece));
            match (fast, slow.centroid()) {
                (Some(fast), Some(slow)) => {
                    prop_assert!((fast - slow).abs() <= 1e-12 * (variable.high - variable.low));
                }
                (fast, slow) => prop_assert_eq!(fast, slow),
            }
        }
    }
}
