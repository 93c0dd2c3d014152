//! Evaluates batches of the most common kind of model, several rows at once. Each step is a loop over [`LANES`] rows that
//! the compiler turns into vector instructions. The operations and their order are those of a single evaluation, so the
//! bits are the same.
//!
//! The kind of model: one output with the centroid over a partition, rules that are plain ANDs by minimum, input terms of
//! slopes and plateaus, and few rules, because every term and rule is computed for every row.

use alloc::vec::Vec;
use core::ops::Range;

use super::literal::{Literal, lines};
use super::operators::{larger, smaller};
use super::rules::Draft;
use super::{CompiledOutput, Input, Outcome, State};
use crate::defuzzify::Partition;
use crate::model::{Conjunction, NoRuleFires};
use crate::table::Line;

/// The number of rows at a time: the width of the widest vectors.
const LANES: usize = 8;
type Row = [f64; LANES];

/// Above this number of operations a row, visiting only the rules that fire is faster.
const MOST_OPERATIONS: usize = 600;
const MOST_INPUTS: usize = 8;
const MOST_TERMS: usize = 32;
const MOST_STRENGTHS: usize = 33;
const MOST_RULES: usize = 64;

#[derive(Debug, Clone)]
pub(super) struct Lanes {
    inputs: Vec<InputRange>,
    slopes: Vec<Slopes>,
    /// Ordered by the firing strength they update.
    rules: Vec<Rule>,
    literals: Vec<usize>,
    /// The offset in `rules` of the rules of each firing strength, and the end of the last one's.
    offsets: Vec<usize>,
    partition: Partition,
    low: f64,
    high: f64,
    origin: f64,
    least_strength: f64,
    otherwise: State,
}

#[derive(Debug, Clone)]
struct InputRange {
    low: f64,
    high: f64,
    literals: Range<usize>,
}

/// A term that rises only below `split` and falls only above: `(x - foot) / run` on both sides, clamped to [0, 1].
#[derive(Debug, Clone, Copy)]
struct Slopes {
    split: f64,
    rising: (f64, f64),
    falling: (f64, f64),
}

#[derive(Debug, Clone)]
struct Rule {
    literal: usize,
    /// The span of its other literals.
    others: Range<usize>,
    weight: f64,
    /// The index in the model, negated.
    negated_index: f64,
}

/// The memory of an evaluation of a block.
struct Block {
    /// The bits of the values whose degrees are held, for each input.
    known: [[u64; LANES]; MOST_INPUTS],
    degrees: [Row; MOST_TERMS],
    by_rule: [Row; MOST_RULES],
    strengths: [Row; MOST_STRENGTHS],
}

impl Lanes {
    /// `None` for another kind of model.
    pub(super) fn new(
        (and, least_strength): (Conjunction, f64),
        inputs: &[Input],
        literals: &[Vec<Literal>],
        drafts: &[Draft],
        outputs: &[CompiledOutput],
    ) -> Option<Self> {
        let [output] = outputs else {
            return None;
        };
        let partition = output.defuzzify.partition()?;
        let mut slopes = Vec::new();
        let mut ranges = Vec::new();
        for (input, literals) in inputs.iter().zip(literals) {
            let first_literal = slopes.len();
            for literal in literals {
                slopes.push(Slopes::new(&lines(literal)?, input.low, input.high)?);
            }
            ranges.push(InputRange {
                low: input.low,
                high: input.high,
                literals: first_literal..slopes.len(),
            });
        }
        let mut actions = Vec::new();
        for draft in drafts {
            let literals = draft.literals.as_ref()?;
            actions.extend(draft.actions.iter().map(|action| (action, literals)));
        }
        actions.sort_by_key(|(action, _)| (action.strength, action.rule));
        let ands: usize = actions.iter().map(|(_, literals)| literals.len()).sum();
        let operations = 12 * slopes.len() + ands + 6 * actions.len() + 20 * partition.strengths();
        let fits = and == Conjunction::Minimum
            && operations <= MOST_OPERATIONS
            && inputs.len() <= MOST_INPUTS
            && slopes.len() <= MOST_TERMS
            && actions.len() <= MOST_RULES
            && partition.strengths() <= MOST_STRENGTHS;
        if !fits {
            return None;
        }
        let (mut rules, mut all_literals) = (Vec::new(), Vec::new());
        for (action, literals) in &actions {
            let (literal, others) = literals.split_first()?;
            let start = all_literals.len();
            all_literals.extend(others.iter().map(|literal| *literal as usize));
            rules.push(Rule {
                literal: *literal as usize,
                others: start..all_literals.len(),
                weight: action.weight,
                negated_index: -f64::from(action.rule),
            });
        }
        let before = |index: usize| actions.partition_point(|(a, _)| (a.strength as usize) < index);
        let offsets = (0..=partition.strengths()).map(before).collect();
        Some(Lanes {
            inputs: ranges,
            slopes,
            rules,
            literals: all_literals,
            offsets,
            partition: partition.clone(),
            low: output.low,
            high: output.high,
            origin: output.defuzzify.middle(),
            least_strength,
            otherwise: match output.when_no_rule_fires {
                NoRuleFires::Value(value) | NoRuleFires::Previous(Some(value)) => {
                    State::Default(value)
                }
                NoRuleFires::Undefined | NoRuleFires::Error | NoRuleFires::Previous(None) => {
                    State::NoRuleFired
                }
            },
        })
    }

    /// Evaluates the rows of `range` and calls `put` with each one's outcome, in their order.
    pub(super) fn rows(&self, columns: &[&[f64]], range: Range<usize>, put: impl FnMut(Outcome)) {
        // Compiled for the widest vectors of the processor; the operations, and so the bits, stay the same.
        #[cfg(feature = "simd")]
        fearless_simd::dispatch!(fearless_simd::Level::new(), _ => self.blocks(columns, range, put));
        #[cfg(not(feature = "simd"))]
        self.blocks(columns, range, put);
    }

    #[inline(always)]
    fn blocks(&self, columns: &[&[f64]], range: Range<usize>, mut put: impl FnMut(Outcome)) {
        let mut block = Block {
            // The bits of a NaN.
            known: [[u64::MAX; LANES]; MOST_INPUTS],
            degrees: [[0.0; LANES]; MOST_TERMS],
            by_rule: [[0.0; LANES]; MOST_RULES],
            strengths: [[0.0; LANES]; MOST_STRENGTHS],
        };
        for start in range.clone().step_by(LANES) {
            let end = range.end.min(start + LANES);
            self.block(columns, start..end, &mut block, &mut put);
        }
    }

    /// Evaluates the rows of `range`, at most [`LANES`].
    #[inline(always)]
    fn block(
        &self,
        columns: &[&[f64]],
        range: Range<usize>,
        block: &mut Block,
        put: &mut impl FnMut(Outcome),
    ) {
        let Block {
            known,
            degrees,
            by_rule,
            strengths,
        } = block;
        let strengths = &mut strengths[..self.partition.strengths()];
        let (mut infinite, mut clamped) = ([0; LANES], [0; LANES]);
        for ((input, column), known) in self.inputs.iter().zip(columns).zip(known) {
            let rows = &column[range.clone()];
            let values = Row::try_from(rows).unwrap_or_else(|_| {
                let mut values = [input.low; LANES];
                values[..rows.len()].copy_from_slice(rows);
                values
            });
            let mut x = [0.0; LANES];
            for lane in 0..LANES {
                infinite[lane] |= mask(!values[lane].is_finite());
                x[lane] = larger(input.low, smaller(input.high, values[lane]));
                clamped[lane] |= mask(x[lane] != values[lane]);
            }
            // Along a row of a map all inputs but one stay the same.
            let bits = values.map(f64::to_bits);
            if *known == bits {
                continue;
            }
            *known = bits;
            let literals = input.literals.clone();
            for (slopes, degrees) in self.slopes[literals.clone()]
                .iter()
                .zip(&mut degrees[literals])
            {
                slopes.degrees(&x, degrees);
            }
        }
        let mut strongest = [0.0; LANES];
        let spans = self.offsets.iter().zip(self.offsets.iter().skip(1));
        for ((first, end), kept) in spans.zip(&mut *strengths) {
            let mut largest = [0.0; LANES];
            let rules = *first..*end;
            for (rule, of_rule) in self.rules[rules.clone()].iter().zip(&mut by_rule[rules]) {
                let mut strength = degrees[rule.literal];
                for literal in &self.literals[rule.others.clone()] {
                    let degrees = &degrees[*literal];
                    for lane in 0..LANES {
                        strength[lane] = smaller(strength[lane], degrees[lane]);
                    }
                }
                for lane in 0..LANES {
                    strength[lane] *= rule.weight;
                    largest[lane] = larger(largest[lane], strength[lane]);
                }
                *of_rule = strength;
            }
            for lane in 0..LANES {
                // The largest is below the least strength where all are.
                largest[lane] = choose(largest[lane] < self.least_strength, 0.0, largest[lane]);
                strongest[lane] = larger(strongest[lane], largest[lane]);
            }
            *kept = largest;
        }
        // The first in the model of equally strong rules has the largest negated index.
        let mut first = [f64::NEG_INFINITY; LANES];
        for (rule, strength) in self.rules.iter().zip(&*by_rule) {
            for lane in 0..LANES {
                let is_strongest = strength[lane] == strongest[lane];
                let index = choose(is_strongest, rule.negated_index, f64::NEG_INFINITY);
                first[lane] = larger(first[lane], index);
            }
        }
        let values = self.partition.centroids(strengths, self.origin);
        for lane in 0..range.len().min(LANES) {
            if infinite[lane] != 0 {
                put(Outcome {
                    state: State::InputNotFinite,
                    ..Outcome::default()
                });
                continue;
            }
            let fired = strongest[lane] > 0.0;
            let value = larger(self.low, smaller(self.high, values[lane]));
            put(Outcome {
                state: if fired {
                    State::Defined(value)
                } else {
                    self.otherwise
                },
                coverage: strongest[lane],
                dominant: fired.then_some(-first[lane] as usize),
                clamped: clamped[lane] != 0,
            });
        }
    }
}

impl Slopes {
    /// `None` where, between `low` and `high`, the term rises or falls more than once.
    fn new(lines: &[(f64, Line)], low: f64, high: f64) -> Option<Self> {
        // `(x - (-infinity)) / 1` is infinite, which is clamped to 1: a plateau.
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

/// All bits or none.
#[inline(always)]
fn mask(truth: bool) -> u64 {
    0u64.wrapping_sub(u64::from(truth))
}

/// One of two numbers, selected by a mask. The compiler may turn an `if` into a branch for each lane.
#[inline(always)]
fn choose(first: bool, a: f64, b: f64) -> f64 {
    let mask = mask(first);
    f64::from_bits((a.to_bits() & mask) | (b.to_bits() & !mask))
}

/// A part of a term, from left to right.
#[derive(Clone, Copy, PartialEq)]
enum Part {
    Below,
    Rising,
    Plateau,
    Falling,
}
