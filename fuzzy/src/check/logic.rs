//! Conversion of conditions to propositional formulas, to find the boxes of the input space in which a rule
//! reaches a degree.
//!
//! With minimum, maximum and `1 - x` as AND, OR and NOT, the degree of a condition reaches a level exactly where a
//! formula of literals is true. A literal is the statement "the degree of this term reaches this level"; it is
//! true on some intervals of one input. Every input is cut at the ends of these intervals. Within a cell between
//! the cuts no literal changes, so evaluating each cell once proves statements about all points.
//!
//! Other operators are treated as minimum and maximum, and weights and activation methods are ignored: the analysis
//! determines where a rule can fire, not how strongly.

use alloc::{boxed::Box, collections::BTreeMap, vec, vec::Vec};

use super::axis;
use crate::{
    model::{MIN_STRENGTH, Model, Variable},
    rule::{Condition, Hedge, Proposition},
};

/// A level that a degree must reach: `degree > value` if strict, else `degree >= value`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Level {
    pub(super) value: f64,
    pub(super) strict: bool,
}

impl Level {
    /// Returns the level at which a rule fires.
    pub(super) fn fires(model: &Model) -> Self {
        let least = model.least_strength;
        // The default of `least_strength` only absorbs rounding errors, so every degree above 0 counts.
        let strict = least <= MIN_STRENGTH;
        Level {
            value: if strict { 0.0 } else { least },
            strict,
        }
    }

    pub(super) fn reaches(value: f64) -> Self {
        let strict = false;
        Level { value, strict }
    }

    fn is_reached_by(self, degree: f64) -> bool {
        match self.strict {
            true => degree > self.value,
            false => degree >= self.value,
        }
    }
}

/// The kinds of sets that an analysis considers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Extent {
    /// Intervals only. Single values are ignored, because they have no width.
    Intervals,
    /// Intervals and single values.
    Points,
}

/// The formulas of a list of conditions, and the cells on which they are evaluated.
pub(super) struct Logic {
    /// The cuts of each input, in ascending order, including both ends of the range.
    pub(super) cuts: Vec<Vec<f64>>,
    literals: Vec<Literal>,
    /// One formula per condition.
    pub(super) formulas: Vec<Formula>,
}

/// The statement that the degree of a term, with its hedges, reaches the level.
struct Literal {
    input: usize,
    /// For each cell, the number of preceding cells in which the literal is true.
    holds_before: Vec<usize>,
}

pub(super) enum Formula {
    Always,
    Literal(usize),
    Not(Box<Formula>),
    And(Vec<Formula>),
    Or(Vec<Formula>),
}

/// A cache of the values at which each literal changes. Outputs share most literals.
pub(super) type Changes = BTreeMap<Key, Vec<f64>>;

/// A box of the input space: for each input, the range `from..to` of its cells.
pub(super) type Cells = Vec<(usize, usize)>;

/// The properties that identify a literal. Equal literals are stored once.
#[derive(PartialEq, Eq, PartialOrd, Ord, Clone)]
pub(super) struct Key {
    input: usize,
    term: usize,
    hedges: Vec<u8>,
    value: u64,
    strict: bool,
}

impl Logic {
    /// Builds a formula for each condition. The formula is true where the degree of the condition reaches the level.
    pub(super) fn new<'m>(
        model: &'m Model,
        conditions: impl Iterator<Item = &'m Condition>,
        level: Level,
        extent: Extent,
        known: &mut Changes,
    ) -> Self {
        let mut reader = Reader {
            model,
            inputs: names(model),
            keys: BTreeMap::new(),
            found: Vec::new(),
        };
        let formulas = conditions.map(|c| reader.formula(c, level)).collect();
        let found = reader.found;
        let mut cuts: Vec<Vec<f64>> = Vec::with_capacity(model.inputs.len());
        // If a literal is true only at a single value, such as the position of a singleton, this value gets its own
        // cell.
        let mut points: Vec<Vec<f64>> = vec![Vec::new(); model.inputs.len()];
        let values: Vec<Vec<f64>> = model.inputs.iter().map(axis::values).collect();
        for variable in &model.inputs {
            cuts.push(vec![variable.low, variable.high]);
        }
        for key in &found {
            if let (Some(input), Some(values), Some(cuts), Some(points)) = (
                model.inputs.get(key.input),
                values.get(key.input),
                cuts.get_mut(key.input),
                points.get_mut(key.input),
            ) {
                let changes = known
                    .entry(key.clone())
                    .or_insert_with(|| axis::changes(values, |x| key.holds(input, x)));
                cuts.extend(changes.iter());
                if extent == Extent::Points {
                    points.extend(axis::points(values, |x| key.holds(input, x)));
                }
            }
        }
        for ((cuts, mut points), variable) in cuts.iter_mut().zip(points).zip(&model.inputs) {
            cuts.retain(|cut| (variable.low..=variable.high).contains(cut));
            points.sort_by(f64::total_cmp);
            points.dedup();
            cuts.retain(|cut| points.binary_search_by(|x| x.total_cmp(cut)).is_err());
            cuts.sort_by(f64::total_cmp);
            cuts.dedup();
            cuts.extend(points.iter().flat_map(|x| [*x, *x]));
            cuts.sort_by(f64::total_cmp);
        }
        let literal = |key: &Key| {
            let mut holds_before = vec![0];
            if let (Some(input), Some(cuts)) = (model.inputs.get(key.input), cuts.get(key.input)) {
                let mut sum = 0;
                for cell in cuts.windows(2) {
                    let middle = 0.5 * cell.iter().sum::<f64>();
                    sum += usize::from(key.holds(input, middle));
                    holds_before.push(sum);
                }
            }
            Literal {
                input: key.input,
                holds_before,
            }
        };
        let literals = found.iter().map(literal).collect();
        Logic {
            cuts,
            literals,
            formulas,
        }
    }

    /// Returns the box that contains all cells, that is, the whole input space.
    pub(super) fn everywhere(&self) -> Cells {
        let cells = self
            .cuts
            .iter()
            .map(|cuts| (0, cuts.len().saturating_sub(1)));
        cells.collect()
    }

    /// Returns `Some(true)` if a formula is true in all cells of a box, `Some(false)` if it is false in all cells, and
    /// `None` if neither can be derived.
    pub(super) fn holds(&self, formula: &Formula, cells: &Cells) -> Option<bool> {
        match formula {
            Formula::Always => Some(true),
            Formula::Literal(literal) => {
                let literal = self.literals.get(*literal)?;
                let &(from, to) = cells.get(literal.input)?;
                let count = literal.holds_before.get(to)? - literal.holds_before.get(from)?;
                match count {
                    0 => Some(false),
                    all if all == to - from => Some(true),
                    _ => None,
                }
            }
            Formula::Not(inner) => self.holds(inner, cells).map(|holds| !holds),
            Formula::And(parts) => self.joined(parts, cells, false),
            Formula::Or(parts) => self.joined(parts, cells, true),
        }
    }

    /// Returns the value of a conjunction (`decisive` is false) or a disjunction (`decisive` is true). A single part
    /// with the value `decisive` determines the result.
    fn joined(&self, parts: &[Formula], cells: &Cells, decisive: bool) -> Option<bool> {
        let mut all = Some(!decisive);
        for part in parts {
            match self.holds(part, cells) {
                Some(truth) if truth == decisive => return Some(decisive),
                Some(_) => {}
                None => all = None,
            }
        }
        all
    }

    /// Returns whether a formula is true in some cell. Also returns true if the search takes too long.
    pub(super) fn holds_somewhere(&self, formula: &Formula) -> bool {
        const MAX_EVALUATIONS: usize = 2_000;
        let mut left = vec![self.everywhere()];
        for _ in 0..MAX_EVALUATIONS {
            let Some(cells) = left.pop() else {
                return false;
            };
            match self.holds(formula, &cells) {
                Some(true) => return true,
                Some(false) => {}
                None => {
                    if let Some((input, cut)) = self.split(formula, &cells) {
                        left.extend(halves(cells, input, cut));
                    }
                }
            }
        }
        true
    }

    /// Returns an input and a cell at which to split a box, chosen so that a literal of the formula changes there.
    pub(super) fn split(&self, formula: &Formula, cells: &Cells) -> Option<(usize, usize)> {
        match formula {
            Formula::Always => None,
            Formula::Literal(index) => {
                let literal = self.literals.get(*index)?;
                if self.holds(formula, cells).is_some() {
                    return None;
                }
                let &(from, to) = cells.get(literal.input)?;
                let holds = |cell: usize| {
                    let before = &literal.holds_before;
                    Some(before.get(cell + 1)? > before.get(cell)?)
                };
                let middle = from + (to - from) / 2;
                let cut = (from + 1..to)
                    .filter(|&cell| holds(cell) != holds(cell - 1))
                    .min_by_key(|cell| cell.abs_diff(middle))?;
                Some((literal.input, cut))
            }
            Formula::Not(inner) => self.split(inner, cells),
            Formula::And(parts) | Formula::Or(parts) => {
                parts.iter().find_map(|part| self.split(part, cells))
            }
        }
    }
}

/// Splits a box in two along an input, at the cell `cut`.
pub(super) fn halves(cells: Cells, input: usize, cut: usize) -> [Cells; 2] {
    let (mut below, mut above) = (cells.clone(), cells);
    if let (Some(below), Some(above)) = (below.get_mut(input), above.get_mut(input)) {
        below.1 = cut;
        above.0 = cut;
    }
    [above, below]
}

fn names(model: &Model) -> BTreeMap<&str, usize> {
    let names = model.inputs.iter().enumerate();
    names.map(|(i, input)| (input.name.as_str(), i)).collect()
}

struct Reader<'m> {
    model: &'m Model,
    inputs: BTreeMap<&'m str, usize>,
    keys: BTreeMap<Key, usize>,
    found: Vec<Key>,
}

impl Reader<'_> {
    fn formula(&mut self, condition: &Condition, level: Level) -> Formula {
        let mut parts =
            |parts: &[Condition]| parts.iter().map(|p| self.formula(p, level)).collect();
        match condition {
            Condition::Is(proposition) => self.literal(proposition, level),
            Condition::And(all) => Formula::And(parts(all)),
            Condition::Or(any) => Formula::Or(parts(any)),
            // `1 - d >= v` is equivalent to `not d > 1 - v`.
            Condition::Not(inner) => {
                let level = Level {
                    value: 1.0 - level.value,
                    strict: !level.strict,
                };
                Formula::Not(Box::new(self.formula(inner, level)))
            }
        }
    }

    fn literal(&mut self, proposition: &Proposition, level: Level) -> Formula {
        if proposition.term.is_none() {
            // The degree of `IS any` depends only on its hedges.
            let hedges = proposition.hedges.iter().rev();
            return match level.is_reached_by(hedges.fold(1.0, |degree, hedge| hedge.of(degree))) {
                true => Formula::Always,
                false => Formula::Not(Box::new(Formula::Always)),
            };
        }
        let input = self.inputs.get(proposition.variable.text.as_str()).copied();
        let term = input.and_then(|i| self.model.inputs.get(i)).and_then(|v| {
            let name = proposition.term.as_ref()?;
            v.terms.iter().position(|term| term.name == name.text)
        });
        // Unknown names are reported by the validation.
        let (Some(input), Some(term)) = (input, term) else {
            return Formula::Always;
        };
        let key = Key {
            input,
            term,
            hedges: proposition.hedges.iter().map(|h| *h as u8).collect(),
            value: level.value.to_bits(),
            strict: level.strict,
        };
        let next = self.found.len();
        let index = *self.keys.entry(key.clone()).or_insert(next);
        if index == next {
            self.found.push(key);
        }
        Formula::Literal(index)
    }
}

impl Key {
    fn holds(&self, input: &Variable, x: f64) -> bool {
        let membership = input.terms.get(self.term).map_or(0.0, |t| t.membership(x));
        let hedges = self.hedges.iter().rev();
        let hedges = hedges.filter_map(|&h| Hedge::ALL.into_iter().find(|hedge| *hedge as u8 == h));
        let level = Level {
            value: f64::from_bits(self.value),
            strict: self.strict,
        };
        level.is_reached_by(hedges.fold(membership, |degree, hedge| hedge.of(degree)))
    }
}
