//! The aggregated set of terms made of straight lines, cut into pieces that have a closed form.
//!
//! Compilation cuts the output's range at every corner of every term; on each interval every term is one line. An
//! evaluation cuts each interval where a line meets its own plateau (implication by minimum), and then where lines cross
//! (maximum) or their sum reaches 1 (bounded sum).

use alloc::vec::Vec;

use super::curves::Part;
use super::piece::{Curve, Piece};
use super::sloped::{Sloped, aggregate};
use super::{Joint, Strengths};
use crate::model::{Aggregation, Implication, Term};
use crate::table::operators::smaller;

/// The terms of one output, as lines between cuts.
#[derive(Debug, Clone, Default)]
pub(crate) struct Polylines {
    intervals: Vec<Interval>,
    lines: Vec<Line>,
}

#[derive(Debug, Clone)]
struct Interval {
    from: f64,
    to: f64,
    first_line: usize,
    end_line: usize,
}

/// A term on an interval: its degrees just inside the interval's ends.
#[derive(Debug, Clone)]
pub(super) struct Line {
    pub(super) term: usize,
    pub(super) left: f64,
    pub(super) right: f64,
}

/// A straight line over a stretch, by its degrees at the ends.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Segment {
    left: f64,
    right: f64,
}

/// Scratch memory of the caller. An evaluation never grows it.
#[derive(Debug)]
pub(crate) struct Workspace {
    active: Vec<Activated>,
    pub(super) cuts: Vec<f64>,
    /// The most cuts. The vector's capacity depends on the allocator.
    pub(super) most_cuts: usize,
    segments: Vec<Segment>,
    pub(super) parts: Vec<Part>,
    pub(crate) steps: Steps,
}

/// The work of integrations, about one membership a step.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Steps {
    pub(crate) taken: u64,
    /// An integration that would take more ends early, and its value means nothing.
    pub(crate) most: u64,
}

impl Steps {
    const UNBOUNDED: Steps = Steps {
        taken: 0,
        most: u64::MAX,
    };

    /// Takes steps, and returns whether there were enough left.
    pub(super) fn take(&mut self, steps: usize) -> bool {
        self.taken = self.taken.saturating_add(steps as u64);
        !self.are_spent()
    }

    pub(crate) fn are_spent(&self) -> bool {
        self.taken > self.most
    }
}

/// About so many memberships of each term are evaluated to integrate a piece with a curve.
pub(super) const STEPS_OF_A_CURVE: usize = 16;

/// A line under a firing strength.
#[derive(Debug, Clone, Copy)]
struct Activated {
    strength: f64,
    left: f64,
    right: f64,
}

impl Workspace {
    /// Workspace for `activations` and `cuts` at once.
    pub(crate) fn new(activations: usize, cuts: usize) -> Self {
        let most_cuts = cuts.max(activations + 2);
        Workspace {
            active: Vec::with_capacity(activations),
            cuts: Vec::with_capacity(most_cuts),
            most_cuts,
            segments: Vec::with_capacity(activations),
            parts: Vec::with_capacity(activations),
            steps: Steps::UNBOUNDED,
        }
    }
}

/// Has the same capacities, and is empty. A derived clone would have no spare capacity.
impl Clone for Workspace {
    fn clone(&self) -> Self {
        Workspace::new(self.active.capacity(), self.most_cuts)
    }
}

impl Polylines {
    /// Whether activated lines are lines, and their aggregate is smooth but for corners that are found. With other operators
    /// terms made of straight lines are curves.
    pub(super) fn can(joint: Joint) -> bool {
        let is_straight = matches!(
            joint.implication,
            Implication::Minimum | Implication::Product
        );
        is_straight
            && match joint.aggregation {
                Aggregation::Drastic | Aggregation::NilpotentMaximum => false,
                Aggregation::Maximum
                | Aggregation::Sum
                | Aggregation::BoundedSum
                | Aggregation::ProbabilisticSum
                | Aggregation::Einstein
                | Aggregation::Hamacher => true,
            }
    }

    /// Cuts `[low, high]` at every corner of every term; `None` where a term is curved.
    pub(crate) fn new(terms: &[Term], low: f64, high: f64) -> Option<Self> {
        let corners = terms
            .iter()
            .map(|term| {
                let mut corners = term.membership_function.corners()?;
                for corner in &mut corners {
                    corner.1 *= term.height;
                }
                Some(corners)
            })
            .collect::<Option<Vec<_>>>()?;
        let mut cuts: Vec<f64> = corners.iter().flatten().map(|corner| corner.0).collect();
        cuts.retain(|x| low < *x && *x < high);
        cuts.push(low);
        cuts.push(high);
        cuts.sort_by(f64::total_cmp);
        cuts.dedup();
        let mut polylines = Polylines {
            intervals: Vec::new(),
            lines: Vec::new(),
        };
        for (&from, &to) in cuts.iter().zip(cuts.iter().skip(1)) {
            let first_line = polylines.lines.len();
            for (term, corners) in corners.iter().enumerate() {
                let (left, right) = limits(corners, from, to);
                if left > 0.0 || right > 0.0 {
                    polylines.lines.push(Line { term, left, right });
                }
            }
            polylines.intervals.push(Interval {
                from,
                to,
                first_line,
                end_line: polylines.lines.len(),
            });
        }
        Some(polylines)
    }

    /// The intervals between cuts, each with the lines over 0 on it.
    pub(super) fn intervals(&self) -> impl Iterator<Item = (f64, f64, &[Line])> {
        self.intervals.iter().map(|interval| {
            let lines = self.lines.get(interval.first_line..interval.end_line);
            (interval.from, interval.to, lines.unwrap_or_default())
        })
    }

    /// Whether a term is 0 all over the range.
    pub(crate) fn is_empty(&self, term: usize) -> bool {
        self.lines.iter().all(|line| line.term != term)
    }

    /// Calls `visit` for each piece of the aggregated set over 0, from left to right.
    pub(crate) fn pieces(
        &self,
        strengths: Strengths<'_>,
        joint: Joint,
        workspace: &mut Workspace,
        visit: &mut dyn FnMut(&Piece<'_>),
    ) {
        for (from, to, lines) in self.intervals() {
            workspace.active.clear();
            workspace.cuts.clear();
            workspace.cuts.push(0.0);
            for line in lines {
                for &strength in strengths.of(line.term) {
                    if strength > 0.0 {
                        workspace.active.push(Activated {
                            strength,
                            left: line.left,
                            right: line.right,
                        });
                        if joint.implication == Implication::Minimum
                            && (line.left > strength) != (line.right > strength)
                            && line.left != strength
                            && line.right != strength
                        {
                            workspace
                                .cuts
                                .push((strength - line.left) / (line.right - line.left));
                        }
                    }
                }
            }
            if workspace.active.is_empty() {
                continue;
            }
            workspace.cuts.push(1.0);
            workspace.cuts.sort_unstable_by(f64::total_cmp);
            let steps = workspace.active.len() * workspace.cuts.len() * STEPS_OF_A_CURVE;
            if !workspace.steps.take(steps) {
                return;
            }
            let width = to - from;
            for (&start, &end) in workspace.cuts.iter().zip(workspace.cuts.iter().skip(1)) {
                if start >= end {
                    continue;
                }
                workspace.segments.clear();
                for active in &workspace.active {
                    workspace
                        .segments
                        .push(active.on(start, end, joint.implication));
                }
                let at = |t: f64| match t {
                    // Exact at the ends, so that neighbouring pieces meet.
                    0.0 => from,
                    1.0 => to,
                    _ => from + width * t,
                };
                let stretch = Stretch {
                    from: at(start),
                    to: at(end),
                };
                join(&workspace.segments, stretch, joint.aggregation, visit);
            }
        }
    }
}

impl Activated {
    /// The activated line on a part of its interval, where `start` and `end` are in [0, 1] and no plateau ends between them.
    fn on(&self, start: f64, end: f64, implication: Implication) -> Segment {
        let at = |t: f64| {
            if t == 0.0 {
                self.left
            } else if t == 1.0 {
                self.right
            } else {
                self.left + (self.right - self.left) * t
            }
        };
        if implication == Implication::Minimum && at(0.5 * (start + end)) >= self.strength {
            // Exactly the plateau: reading it off the line would lose digits.
            return Segment {
                left: self.strength,
                right: self.strength,
            };
        }
        Segment {
            left: implication.of(self.strength, at(start)),
            right: implication.of(self.strength, at(end)),
        }
    }
}

#[derive(Clone, Copy)]
struct Stretch {
    from: f64,
    to: f64,
}

impl Stretch {
    fn at(&self, t: f64) -> f64 {
        if t >= 1.0 {
            self.to
        } else {
            self.from + (self.to - self.from) * t
        }
    }
}

/// Joins lines over a stretch into pieces.
fn join(
    segments: &[Segment],
    stretch: Stretch,
    aggregation: Aggregation,
    visit: &mut dyn FnMut(&Piece<'_>),
) {
    match aggregation {
        Aggregation::Maximum => upper_envelope(segments, stretch, visit),
        Aggregation::Sum => {
            let sum = sum(segments);
            visit(&straight(stretch, 0.0, 1.0, sum.left, sum.right));
        }
        Aggregation::BoundedSum => {
            let sum = sum(segments);
            if (sum.left > 1.0) == (sum.right > 1.0) {
                let (left, right) = (smaller(1.0, sum.left), smaller(1.0, sum.right));
                visit(&straight(stretch, 0.0, 1.0, left, right));
            } else {
                let t = (1.0 - sum.left) / (sum.right - sum.left);
                visit(&straight(stretch, 0.0, t, smaller(1.0, sum.left), 1.0));
                visit(&straight(stretch, t, 1.0, 1.0, smaller(1.0, sum.right)));
            }
        }
        Aggregation::ProbabilisticSum
        | Aggregation::Drastic
        | Aggregation::Einstein
        | Aggregation::Hamacher
        | Aggregation::NilpotentMaximum => {
            let sloped = |t: f64| {
                segments.iter().fold(Sloped::default(), |sum, segment| {
                    let slope = segment.right - segment.left;
                    let degree = segment.left + slope * t;
                    aggregate(aggregation, sum, Sloped { degree, slope })
                })
            };
            visit(&Piece {
                from: stretch.from,
                to: stretch.to,
                left: sloped(0.0).degree,
                right: sloped(1.0).degree,
                curve: Some(Curve {
                    degree: &|t| sloped(t).degree,
                    slope: &|t| sloped(t).slope,
                }),
            });
        }
    }
}

fn sum(segments: &[Segment]) -> Segment {
    let (mut left, mut right) = (0.0, 0.0);
    for segment in segments {
        left += segment.left;
        right += segment.right;
    }
    Segment { left, right }
}

fn straight(stretch: Stretch, start: f64, end: f64, left: f64, right: f64) -> Piece<'static> {
    Piece {
        from: stretch.at(start),
        to: stretch.at(end),
        left,
        right,
        curve: None,
    }
}

/// The maximum of lines. Starts at the highest line on the left, and at each crossing continues on the steeper line.
fn upper_envelope(segments: &[Segment], stretch: Stretch, visit: &mut dyn FnMut(&Piece<'_>)) {
    let Some(mut top) = segments.iter().copied().reduce(|best, segment| {
        if (segment.left, segment.right) > (best.left, best.right) {
            segment
        } else {
            best
        }
    }) else {
        return;
    };
    let (mut t, mut y) = (0.0, top.left);
    loop {
        let mut next: Option<(f64, Segment)> = None;
        for &segment in segments {
            if segment.right <= top.right {
                continue;
            }
            // The crossing of two lines, from their distances at both ends.
            let (behind, ahead) = (top.left - segment.left, segment.right - top.right);
            let crossing = if behind > 0.0 {
                behind / (behind + ahead)
            } else {
                0.0
            };
            let crossing = if crossing > t { crossing } else { t };
            let steeper = next.is_none_or(|(at, other)| {
                crossing < at || (crossing == at && segment.right > other.right)
            });
            if steeper {
                next = Some((crossing, segment));
            }
        }
        let Some((crossing, segment)) = next else {
            break;
        };
        if crossing >= 1.0 {
            break;
        }
        if crossing > t {
            let at_crossing = top.left + (top.right - top.left) * crossing;
            visit(&straight(stretch, t, crossing, y, at_crossing));
            (t, y) = (crossing, at_crossing);
        }
        top = segment;
    }
    visit(&straight(stretch, t, 1.0, y, top.right));
}

/// The degrees of a polyline just inside the ends of an interval without corners.
pub(super) fn limits(corners: &[(f64, f64)], from: f64, to: f64) -> (f64, f64) {
    let mut before: Option<(f64, f64)> = None;
    for &corner in corners {
        if corner.0 >= to {
            return match before {
                None => (corner.1, corner.1),
                Some(left) => (on_line(left, corner, from), on_line(left, corner, to)),
            };
        }
        before = Some(corner);
    }
    let held = before.map_or(0.0, |corner| corner.1);
    (held, held)
}

fn on_line(a: (f64, f64), b: (f64, f64), x: f64) -> f64 {
    if x <= a.0 {
        a.1
    } else if x >= b.0 {
        b.1
    } else {
        a.1 + (b.1 - a.1) * ((x - a.0) / (b.0 - a.0))
    }
}
