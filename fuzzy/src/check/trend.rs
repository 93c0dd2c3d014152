//! Rules against the trend: along an input most rules raise an output but a few lower it, or the reverse.
//!
//! Two rules are neighbours if their antecedents differ in only one input, by one step in the order of its terms. Each
//! step between neighbours raises or lowers the output. The direction of most steps along an input is the trend.

use alloc::{collections::BTreeMap, string::String, vec::Vec};

use super::{axis, monotone::Direction};
use crate::{
    model::{MembershipFunction, Model, Term, Variable},
    rule::{Condition, Proposition},
};

/// A step between two neighbouring rules that contradicts the trend.
#[derive(Debug, Clone, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct AgainstTrend {
    /// The name of the input.
    pub input: String,
    /// The name of the output.
    pub output: String,
    /// The direction of most steps along the input.
    pub trend: Direction,
    /// The number of steps that follow the trend.
    pub following: usize,
    /// The rule at the lower term of the input.
    #[cfg_attr(
        feature = "serde",
        serde(serialize_with = "crate::serial::rule_number")
    )]
    #[cfg_attr(feature = "schema", schemars(range(min = 1)))]
    pub from_rule: usize,
    /// The term that `from_rule` concludes.
    pub from_term: String,
    /// The rule at the next higher term.
    #[cfg_attr(
        feature = "serde",
        serde(serialize_with = "crate::serial::rule_number")
    )]
    #[cfg_attr(feature = "schema", schemars(range(min = 1)))]
    pub to_rule: usize,
    /// The term that `to_rule` concludes, which contradicts the trend.
    pub to_term: String,
}

/// Returns the steps that contradict the trend. There is a trend if at least twice as many steps go in one direction as
/// in the other.
pub(super) fn against(model: &Model) -> Vec<AgainstTrend> {
    let mut found = Vec::new();
    // Terms are ordered by their middles, not by their order in the file.
    let order: Vec<Vec<usize>> = model.inputs.iter().map(ranks).collect();
    for output in &model.outputs {
        let Some(table) = Table::new(model, &output.variable, &order) else {
            continue;
        };
        table.against(model, &output.variable, &mut found);
    }
    found
}

/// The rules of an output whose antecedents are plain conjunctions.
struct Table {
    /// The rules by their antecedents. The key is a list of (input, rank of its term), in the order of the inputs.
    rows: BTreeMap<Vec<(usize, usize)>, Row>,
}

struct Row {
    rule: usize,
    term: String,
    /// The middle of the term that the rule concludes.
    middle: f64,
}

impl Table {
    fn new(model: &Model, output: &Variable, order: &[Vec<usize>]) -> Option<Self> {
        let names: BTreeMap<&str, usize> = model
            .inputs
            .iter()
            .enumerate()
            .map(|(i, v)| (v.name.as_str(), i))
            .collect();
        let middles: BTreeMap<&str, Option<f64>> = output
            .terms
            .iter()
            .map(|term| (term.name.as_str(), middle(term, output)))
            .collect();
        let mut rows = BTreeMap::new();
        for (rule, written) in model.rules.iter().enumerate() {
            if !model.is_enabled(written) {
                continue;
            }
            let consequents = &written.rule.consequents;
            let Some(consequent) = consequents.iter().find(|c| c.output.text == output.name) else {
                continue;
            };
            let term = consequent.term.text.as_str();
            let Some(middle) = *middles.get(term)? else {
                continue;
            };
            if let Some(key) = key(model, &names, order, &written.rule.condition) {
                let term = String::from(term);
                rows.insert(key, Row { rule, term, middle });
            }
        }
        Some(Table { rows })
    }

    fn against(&self, model: &Model, output: &Variable, found: &mut Vec<AgainstTrend>) {
        let mut steps: BTreeMap<usize, Steps<'_>> = BTreeMap::new();
        for (key, row) in &self.rows {
            for (i, &(input, _)) in key.iter().enumerate() {
                let mut next = key.clone();
                if let Some((_, rank)) = next.get_mut(i) {
                    *rank += 1;
                }
                let Some(other) = self.rows.get(&next) else {
                    continue;
                };
                let steps = steps.entry(input).or_default();
                if other.middle > row.middle {
                    steps.rising.push((row, other));
                } else if other.middle < row.middle {
                    steps.falling.push((row, other));
                }
            }
        }
        for (input, Steps { rising, falling }) in steps {
            let (trend, most, few) = if rising.len() >= 2 * falling.len() {
                (Direction::Increasing, rising.len(), falling)
            } else if falling.len() >= 2 * rising.len() {
                (Direction::Decreasing, falling.len(), rising)
            } else {
                continue;
            };
            let Some(input) = model.inputs.get(input) else {
                continue;
            };
            found.extend(few.into_iter().map(|(from, to)| AgainstTrend {
                input: input.name.clone(),
                output: output.name.clone(),
                trend,
                following: most,
                from_rule: from.rule,
                from_term: from.term.clone(),
                to_rule: to.rule,
                to_term: to.term.clone(),
            }));
        }
    }
}

/// Pairs of neighbouring rules along an input: those that raise the output and those that lower it. Each pair starts
/// with the rule at the lower term.
#[derive(Default)]
struct Steps<'t> {
    rising: Vec<(&'t Row, &'t Row)>,
    falling: Vec<(&'t Row, &'t Row)>,
}

/// Returns the inputs of a condition and the ranks of their terms; `None` unless it is a conjunction of propositions
/// without hedges.
fn key(
    model: &Model,
    names: &BTreeMap<&str, usize>,
    order: &[Vec<usize>],
    condition: &Condition,
) -> Option<Vec<(usize, usize)>> {
    let mut key = BTreeMap::new();
    let mut take = |proposition: &Proposition| {
        let input = *names.get(proposition.variable.text.as_str())?;
        let name = &proposition.term.as_ref()?.text;
        let terms = &model.inputs.get(input)?.terms;
        let term = terms.iter().position(|term| term.name == *name)?;
        let rank = order.get(input)?.get(term)?;
        let is_plain = proposition.hedges.is_empty();
        (is_plain && key.insert(input, *rank).is_none()).then_some(())
    };
    match condition {
        Condition::Is(proposition) => take(proposition)?,
        Condition::And(parts) => {
            for part in parts {
                match part {
                    Condition::Is(proposition) => take(proposition)?,
                    _ => return None,
                }
            }
        }
        _ => return None,
    }
    Some(key.into_iter().collect())
}

/// Returns the rank of each term in the order of the middles.
fn ranks(variable: &Variable) -> Vec<usize> {
    let middles: Vec<f64> = variable
        .terms
        .iter()
        .map(|term| middle(term, variable).unwrap_or(f64::NAN))
        .collect();
    middles
        .iter()
        .map(|middle| middles.iter().filter(|other| *other < middle).count())
        .collect()
}

/// Returns the middle of the values at which the degree of a term is highest, or the value of a constant. `None` for a
/// linear function or a formula over inputs.
fn middle(term: &Term, variable: &Variable) -> Option<f64> {
    match &term.membership_function {
        MembershipFunction::Constant { value } => return Some(*value),
        MembershipFunction::Function { formula } if !formula.is_over(&variable.name) => {
            return None;
        }
        MembershipFunction::Linear { .. } => return None,
        _ => {}
    }
    let values = axis::values(variable);
    let highest = values
        .iter()
        .map(|&x| term.membership(x))
        .fold(0.0, f64::max);
    let mut top = values.iter().filter(|&&x| term.membership(x) == highest);
    let first = *top.next()?;
    let last = top.next_back().copied().unwrap_or(first);
    Some(0.5 * (first + last))
}
