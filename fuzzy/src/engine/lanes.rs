//! Batches of the commonest kind of model, several rows at once: every step is done for [`LANES`] rows in
//! one loop, which the compiler turns into vector instructions. Every number comes from the same operations
//! in the same order as in a single evaluation, so the bits are the same.
//!
//! The kind: one output with the centroid over a partition, rules that are plain ANDs by minimum, input
//! terms that are slopes and plateaus. Every term and every rule is computed for every row, so the rules
//! must be few.

use alloc::vec::Vec;

use super::literal::{Line, Literal, lines};
use super::operators::{larger, smaller};
use super::outcome::{Outcome, State};
use super::rules::Draft;
use super::{CompiledOutput, Input};
use crate::defuzzify::Ramps;
use crate::model::{Conjunction, NoRuleFires};

/// Rows at a time: the width of the widest vectors.
const LANES: usize = 8;
type Row = [f64; LANES];

/// Above this number of operations a row, visiting only the rules alive is faster.
const MOST_OPERATIONS: usize = 600;
const MOST_TERMS: usize = 32;
const MOST_PLACES: usize = 33;

#[derive(Debug, Clone)]
pub(super) struct Lanes {
    inputs: Vec<Range>,
    slopes: Vec<Slopes>,
    rules: Vec<Rule>,
    ramps: Ramps,
    low: f64,
    high: f64,
    origin: f64,
    otherwise: State,
}

#[derive(Debug, Clone)]
struct Range {
    low: f64,
    high: f64,
    first_literal: usize,
    end_literal: usize,
}

/// A term that rises up to `split` at the latest and falls from there at the earliest:
/// `(x - foot) / run` on both sides, held to [0, 1].
#[derive(Debug, Clone, Copy)]
struct Slopes {
    split: f64,
    rising: (f64, f64),
    falling: (f64, f64),
}

#[derive(Debug, Clone)]
struct Rule {
    literals: Vec<usize>,
    place: usize,
    weight: f64,
    index: f64,
}

impl Lanes {
    /// `None` of another kind of model.
    pub(super) fn new(
        and: Conjunction,
        inputs: &[Input],
        literals: &[Vec<Literal>],
        drafts: &[Draft],
        outputs: &[CompiledOutput],
    ) -> Option<Self> {
        let [output] = outputs else {
            return None;
        };
        let ramps = output.defuzzify.ramps()?;
        let mut slopes = Vec::new();
        let mut ranges = Vec::new();
        for (input, literals) in inputs.iter().zip(literals) {
            let first_literal = slopes.len();
            for literal in literals {
                slopes.push(Slopes::new(&lines(literal)?, input.low, input.high)?);
            }
            ranges.push(Range {
                low: input.low,
                high: input.high,
                first_literal,
                end_literal: slopes.len(),
            });
        }
        let mut rules = Vec::new();
        for draft in drafts {
            let literals = draft.literals.as_ref()?;
            for action in &draft.actions {
                rules.push(Rule {
                    literals: literals.iter().map(|literal| *literal as usize).collect(),
                    place: action.place as usize,
                    weight: action.weight,
                    index: f64::from(action.rule),
                });
            }
        }
        // In the order of the model, so that of several as strong the first is kept.
        rules.sort_by(|a, b| f64::total_cmp(&a.index, &b.index));
        let ands: usize = rules.iter().map(|rule| rule.literals.len()).sum();
        let operations = 12 * slopes.len() + ands + 8 * rules.len() + 20 * ramps.places();
        let fits = and == Conjunction::Minimum
            && operations <= MOST_OPERATIONS
            && slopes.len() <= MOST_TERMS
            && ramps.places() <= MOST_PLACES;
        fits.then(|| Lanes {
            inputs: ranges,
            slopes,
            rules,
            ramps: ramps.clone(),
            low: output.low,
            high: output.high,
            origin: output.defuzzify.middle(),
            otherwise: match output.when_no_rule_fires {
                NoRuleFires::Value(value) => State::Default(value),
                NoRuleFires::Undefined | NoRuleFires::Error => State::NoRuleFired,
            },
        })
    }

    /// Evaluates the rows from `first` on, as many as `outcomes` has room for.
    pub(super) fn rows(&self, columns: &[&[f64]], first: usize, outcomes: &mut [Outcome]) {
        // With the widest vectors of the processor at hand; the operations, and so the bits, are the same.
        #[cfg(feature = "std")]
        pulp::Arch::new().dispatch(Blocks {
            lanes: self,
            columns,
            first,
            outcomes,
        });
        #[cfg(not(feature = "std"))]
        self.blocks(columns, first, outcomes);
    }

    #[inline(always)]
    fn blocks(&self, columns: &[&[f64]], first: usize, outcomes: &mut [Outcome]) {
        let mut degrees = [[0.0; LANES]; MOST_TERMS];
        let mut heights = [[0.0; LANES]; MOST_PLACES];
        let heights = &mut heights[..self.ramps.places()];
        for (i, outcomes) in outcomes.chunks_mut(LANES).enumerate() {
            let start = first + i * LANES;
            self.block(columns, start, outcomes, &mut degrees, heights);
        }
    }

    #[inline(always)]
    fn block(
        &self,
        columns: &[&[f64]],
        start: usize,
        outcomes: &mut [Outcome],
        degrees: &mut [Row; MOST_TERMS],
        heights: &mut [Row],
    ) {
        let (mut finite, mut clamped) = ([true; LANES], [false; LANES]);
        for (input, column) in self.inputs.iter().zip(columns) {
            let rows = &column[start..start + outcomes.len()];
            let values = Row::try_from(rows).unwrap_or_else(|_| {
                let mut values = [input.low; LANES];
                values[..rows.len()].copy_from_slice(rows);
                values
            });
            let mut x = [0.0; LANES];
            for lane in 0..LANES {
                finite[lane] &= values[lane].is_finite();
                x[lane] = larger(input.low, smaller(input.high, values[lane]));
                clamped[lane] |= x[lane] != values[lane];
            }
            let range = input.first_literal..input.end_literal;
            for (slopes, degrees) in self.slopes[range.clone()].iter().zip(&mut degrees[range]) {
                slopes.degrees(&x, degrees);
            }
        }
        heights.fill([0.0; LANES]);
        let (mut strongest, mut dominant) = ([0.0; LANES], [-1.0; LANES]);
        for rule in &self.rules {
            let mut strength = [1.0; LANES];
            for literal in &rule.literals {
                let degrees = &degrees[*literal];
                for lane in 0..LANES {
                    strength[lane] = smaller(strength[lane], degrees[lane]);
                }
            }
            let height = &mut heights[rule.place];
            for lane in 0..LANES {
                let strength = rule.weight * strength[lane];
                height[lane] = larger(height[lane], strength);
                dominant[lane] = choose(strength > strongest[lane], rule.index, dominant[lane]);
                strongest[lane] = larger(strength, strongest[lane]);
            }
        }
        let values = self.ramps.centroids(heights, &strongest, self.origin);
        for (lane, outcome) in outcomes.iter_mut().enumerate() {
            if !finite[lane] {
                *outcome = Outcome {
                    state: State::InputNotFinite,
                    ..Outcome::default()
                };
                continue;
            }
            let fired = strongest[lane] > 0.0;
            let value = larger(self.low, smaller(self.high, values[lane]));
            *outcome = Outcome {
                state: if fired {
                    State::Defined(value)
                } else {
                    self.otherwise
                },
                coverage: strongest[lane],
                dominant: fired.then_some(dominant[lane] as usize),
                clamped: clamped[lane],
            };
        }
    }
}

/// The arguments of [`Lanes::blocks`], for a call compiled for wider vectors.
#[cfg(feature = "std")]
struct Blocks<'a> {
    lanes: &'a Lanes,
    columns: &'a [&'a [f64]],
    first: usize,
    outcomes: &'a mut [Outcome],
}

#[cfg(feature = "std")]
impl pulp::WithSimd for Blocks<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        self.lanes.blocks(self.columns, self.first, self.outcomes);
    }
}

impl Slopes {
    /// The term's lines between `low` and `high`, where it rises once and falls once at most.
    fn new(lines: &[(f64, Line)], low: f64, high: f64) -> Option<Self> {
        // `x - (-infinity)` over 1 is infinite, which is held to 1: a plateau.
        let plateau = (f64::NEG_INFINITY, 1.0);
        let mut slopes = Slopes {
            split: f64::INFINITY,
            rising: plateau,
            falling: plateau,
        };
        let ends = lines
            .iter()
            .skip(1)
            .map(|line| line.0)
            .chain([f64::INFINITY]);
        let mut before = None;
        for ((start, line), end) in lines.iter().zip(ends) {
            if end <= low || *start > high || start >= &end {
                continue;
            }
            let slope = (line.foot, line.run);
            match (line.base, line.rise, before) {
                (0.0, 1.0, None | Some(Part::Below)) if line.run > 0.0 => {
                    slopes.rising = slope;
                    before = Some(Part::Rising);
                }
                (0.0, 1.0, None | Some(Part::Rising | Part::Plateau)) => {
                    slopes.split = *start;
                    slopes.falling = slope;
                    before = Some(Part::Falling);
                }
                (1.0, 0.0, None | Some(Part::Rising)) => before = Some(Part::Plateau),
                (0.0, 0.0, None) => before = Some(Part::Below),
                (0.0, 0.0, Some(Part::Falling)) => {}
                _ => return None,
            }
        }
        (before != Some(Part::Below)).then_some(slopes)
    }

    #[inline(always)]
    fn degrees(&self, x: &Row, degrees: &mut Row) {
        for (x, degree) in x.iter().zip(degrees) {
            let falls = *x >= self.split;
            let foot = choose(falls, self.falling.0, self.rising.0);
            let run = choose(falls, self.falling.1, self.rising.1);
            *degree = larger(0.0, smaller(1.0, (x - foot) / run));
        }
    }
}

/// One of two numbers by their bits, which the compiler does for all lanes at once: an `if` it may turn into
/// a branch for each.
#[inline(always)]
fn choose(first: bool, a: f64, b: f64) -> f64 {
    let mask = 0u64.wrapping_sub(u64::from(first));
    f64::from_bits((a.to_bits() & mask) | (b.to_bits() & !mask))
}

/// How far a term has come from left to right.
#[derive(Clone, Copy, PartialEq)]
enum Part {
    Below,
    Rising,
    Plateau,
    Falling,
}
