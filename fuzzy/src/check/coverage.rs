//! Regions of the input space that no rule covers.

use alloc::{string::String, vec::Vec};

use super::logic::{Cells, Changes, Extent, Level, Logic, halves};
use crate::model::{Model, Variable};

/// A box of the input space in which no rule of an output reaches the required firing strength.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct UncoveredRegion {
    /// The name of the output.
    pub output: String,
    /// The firing strength that no rule reaches; 0 if `silent`.
    pub coverage: f64,
    /// Whether no rule fires at all, so that the output has no value.
    pub silent: bool,
    /// The sides of the box. Inputs that are not listed span their whole range.
    pub sides: Vec<BoxSide>,
    /// The fraction of the input space that the box covers.
    pub share: f64,
    /// The conditions of rules that would cover the box. Each is an AND of one term per input in `sides`.
    pub missing: Vec<Vec<Antecedent>>,
    /// The number of further conditions that are omitted from `missing`.
    pub more_missing: usize,
    /// Inputs that have no term above the required degree in a part of the box. No rule can cover that part.
    pub weak: Vec<String>,
}

/// One side of a box.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct BoxSide {
    /// The name of the input.
    pub input: String,
    /// The lower end.
    pub low: f64,
    /// The upper end.
    pub high: f64,
}

/// A proposition `input IS term`.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Antecedent {
    /// The name of the input.
    pub input: String,
    /// The name of the term.
    pub term: String,
}

/// Uncovered boxes, with a flag for whether the list is complete.
pub(super) struct Boxes {
    pub(super) found: Vec<UncoveredRegion>,
    pub(super) complete: bool,
}

/// The maximum number of boxes. The search stops there, because no author reads more of them.
const MAX_BOXES: usize = 50;
/// The maximum number of missing antecedents listed for a box.
const MAX_MISSING: usize = 16;
/// The maximum number of sides for which antecedents are listed. A rule for more sides would be too long to write.
const MAX_SIDES_OF_A_RULE: usize = 6;
/// The maximum number of formula evaluations in the search for one output.
const MAX_EVALUATIONS: usize = 100_000;
/// The maximum number of formula evaluations in the searches for all outputs together.
const MAX_TOTAL_EVALUATIONS: usize = 4_000_000;

/// State that is shared by the searches for all outputs.
pub(super) struct SearchBudget {
    evaluations_left: usize,
}

impl SearchBudget {
    pub(super) fn new() -> Self {
        let evaluations_left = MAX_TOTAL_EVALUATIONS;
        SearchBudget { evaluations_left }
    }
}

/// Returns the boxes in which no rule of `output` reaches `coverage` or, if it is `None`, in which no rule fires.
pub(super) fn uncovered(
    model: &Model,
    output: &str,
    coverage: Option<f64>,
    shared: &mut SearchBudget,
    known: &mut Changes,
) -> Boxes {
    let level = coverage.map_or(Level::fires(model), Level::reaches);
    let concludes = |rule: &&crate::model::Rule| {
        model.is_enabled(rule)
            && rule.rule.weight > 0.0
            && rule
                .rule
                .consequents
                .iter()
                .any(|c| c.output.text == output)
    };
    let conditions = model.rules.iter().filter(concludes);
    let conditions = conditions.map(|rule| &rule.rule.condition);
    let logic = Logic::new(model, conditions, level, Extent::Intervals, known);
    let (boxes, complete) = search(&logic, shared);
    let boxes = merged(boxes);
    let mut found: Vec<UncoveredRegion> = boxes
        .iter()
        .map(|cells| describe(model, &logic, cells, output, coverage))
        .collect();
    found.sort_by(|a, b| b.share.total_cmp(&a.share));
    Boxes { found, complete }
}

/// Returns the boxes in which no formula is true, and whether the search is complete.
fn search(logic: &Logic, shared: &mut SearchBudget) -> (Vec<Cells>, bool) {
    let all: Vec<usize> = (0..logic.formulas.len()).collect();
    let mut boxes = Vec::new();
    let most = shared.evaluations_left.min(MAX_EVALUATIONS);
    let mut evaluations = 0;
    // The boxes to search, each with the formulas that may be true in it.
    let mut left = Vec::from([(logic.everywhere(), all)]);
    while let Some((cells, formulas)) = left.pop() {
        let more = formulas.len() + 1;
        evaluations += more;
        shared.evaluations_left = shared.evaluations_left.saturating_sub(more);
        if evaluations > most || boxes.len() >= MAX_BOXES {
            return (boxes, false);
        }
        let Some(open) = undecided(logic, &cells, &formulas) else {
            continue;
        };
        let formula = open.first().and_then(|&index| logic.formulas.get(index));
        let Some(formula) = formula else {
            boxes.push(cells);
            continue;
        };
        let Some((input, cut)) = logic.split(formula, &cells) else {
            continue;
        };
        left.extend(halves(cells, input, cut).map(|half| (half, open.clone())));
    }
    (boxes, true)
}

/// Returns the formulas that may be true in a part of the box; `None` if one is true in the whole box.
fn undecided(logic: &Logic, cells: &Cells, formulas: &[usize]) -> Option<Vec<usize>> {
    let mut open = Vec::new();
    for &index in formulas {
        match logic.holds(logic.formulas.get(index)?, cells) {
            Some(true) => return None,
            Some(false) => {}
            None => open.push(index),
        }
    }
    Some(open)
}

/// Merges neighbouring boxes whose union is a box.
fn merged(mut boxes: Vec<Cells>) -> Vec<Cells> {
    loop {
        let before = boxes.len();
        let mut left: Vec<Cells> = Vec::with_capacity(before);
        for one in boxes {
            let joined = left
                .iter()
                .enumerate()
                .find_map(|(i, other)| Some((i, together(other, &one)?)));
            match joined.and_then(|(i, whole)| Some((left.get_mut(i)?, whole))) {
                Some((place, whole)) => *place = whole,
                None => left.push(one),
            }
        }
        // A merged box may have a new neighbour among the earlier ones, so merging is repeated until nothing changes.
        if left.len() == before {
            return left;
        }
        boxes = left;
    }
}

/// Returns the union of two boxes if they differ in only one input and are adjacent there.
fn together(a: &Cells, b: &Cells) -> Option<Cells> {
    let mut differing = a.iter().zip(b).enumerate().filter(|(_, (a, b))| a != b);
    let (input, (&(from, to), &(other_from, other_to))) = differing.next()?;
    if differing.next().is_some() || (to != other_from && other_to != from) {
        return None;
    }
    let mut whole = a.clone();
    *whole.get_mut(input)? = (from.min(other_from), to.max(other_to));
    Some(whole)
}

fn describe(
    model: &Model,
    logic: &Logic,
    cells: &Cells,
    output: &str,
    coverage: Option<f64>,
) -> UncoveredRegion {
    /// A side narrower than this fraction of the range is a single value with a rounding error, and is reported as that
    /// value.
    const THIN: f64 = 1e-9;
    let mut sides = Vec::new();
    let mut share = 1.0;
    let mut choices: Vec<Vec<Antecedent>> = Vec::new();
    let mut weak = Vec::new();
    for ((variable, cuts), &(from, to)) in model.inputs.iter().zip(&logic.cuts).zip(cells) {
        let (Some(&low), Some(&high)) = (cuts.get(from), cuts.get(to)) else {
            continue;
        };
        let range = variable.high - variable.low;
        if low == variable.low && high == variable.high {
            continue;
        }
        let input = variable.name.clone();
        let dominating =
            DominantTerms::of(variable, cuts.get(from..=to).unwrap_or_default(), coverage);
        let term = |term: &str| Antecedent {
            input: input.clone(),
            term: term.into(),
        };
        choices.push(dominating.terms.into_iter().map(term).collect());
        if dominating.weak {
            weak.push(input.clone());
        }
        let high = if high - low > THIN * range { high } else { low };
        share *= (high - low) / range;
        sides.push(BoxSide { input, low, high });
    }
    let count = choices
        .iter()
        .map(Vec::len)
        .fold(1usize, usize::saturating_mul);
    let missing = combinations(&choices, MAX_MISSING);
    UncoveredRegion {
        output: output.into(),
        coverage: coverage.unwrap_or(0.0),
        silent: coverage.is_none(),
        sides,
        share,
        more_missing: if missing.is_empty() {
            0
        } else {
            count - missing.len()
        },
        missing,
        weak,
    }
}

/// The terms that have the highest degree somewhere in an interval of an input, from left to right.
struct DominantTerms<'v> {
    /// The terms that have the highest degree and reach the coverage at the same value.
    terms: Vec<&'v str>,
    /// Whether there is a value at which no term reaches the coverage.
    weak: bool,
}

impl<'v> DominantTerms<'v> {
    fn of(variable: &'v Variable, cuts: &[f64], coverage: Option<f64>) -> Self {
        const LOOKS_IN_A_CELL: usize = 8;
        let mut found = DominantTerms {
            terms: Vec::new(),
            weak: false,
        };
        for cell in cuts.windows(2) {
            let &[low, high] = cell else { continue };
            for i in 0..LOOKS_IN_A_CELL {
                let x = low + (high - low) * (i as f64 + 0.5) / LOOKS_IN_A_CELL as f64;
                let mut best: (f64, &str) = (0.0, "");
                for term in &variable.terms {
                    let degree = term.membership(x);
                    if degree > best.0 {
                        best = (degree, &term.name);
                    }
                }
                if best.0 == 0.0 || coverage.is_some_and(|least| best.0 < least) {
                    found.weak = true;
                } else if !found.terms.contains(&best.1) {
                    found.terms.push(best.1);
                }
            }
        }
        found
    }
}

/// Returns the combinations of one antecedent per choice, at most `most` of them.
fn combinations(choices: &[Vec<Antecedent>], most: usize) -> Vec<Vec<Antecedent>> {
    if choices.is_empty()
        || choices.len() > MAX_SIDES_OF_A_RULE
        || choices.iter().any(Vec::is_empty)
    {
        return Vec::new();
    }
    let mut all: Vec<Vec<Antecedent>> = Vec::from([Vec::new()]);
    for choice in choices {
        let mut longer = Vec::new();
        for start in &all {
            for next in choice.iter().take(most - longer.len().min(most)) {
                let mut one = start.clone();
                one.push(next.clone());
                longer.push(one);
            }
        }
        all = longer;
    }
    all
}
