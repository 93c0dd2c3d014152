//! Determines whether a rule set has no gap: rules that cover all values of the inputs need no filling.

use alloc::vec::Vec;

use fuzzy::{
    Model,
    model::{Activation, Conjunction, Output, Variable},
    rule::{Condition, Name, Proposition, Rule},
};

use super::is_gap;

/// The number of examined rules after which the proof is abandoned.
const MAX_STEPS: usize = 5_000_000;

/// The minimum degree of each term in each interval of an input.
type MinimumDegrees = Vec<Vec<f64>>;

/// Whether the rules of an output are proven to cover all values of the inputs, so that none counts as a gap.
///
/// The range of each input is divided at the corners of its terms and halfway between them. Degrees are linear within
/// an interval, so their minimum is at an end. The minimum strength of a rule in a cell follows from the minimum
/// degrees in the intervals. Rules with operators other than AND and IS are ignored, and the degree of a term that is
/// curved or has a step counts as 0. Nothing is proven for outputs that read other outputs (which may have no value),
/// for rule blocks and for activation methods.
pub(crate) fn has_no_gap(model: &Model, output: &Output, coverage_below: f64) -> bool {
    if !model.reads(&output.variable.name).is_empty() || !is_plain(model) {
        return false;
    }
    let inputs: Vec<MinimumDegrees> = model.inputs.iter().map(least_degrees).collect();
    let is_output = |name: &Name| name.text == output.variable.name;
    let concludes = |rule: &Rule| rule.consequents.iter().any(|c| is_output(&c.output));
    let rules = model
        .rules
        .iter()
        .map(|rule| &rule.rule)
        .filter(|rule| concludes(rule));
    let mut rules: Vec<Antecedent> = rules
        .filter_map(|rule| {
            Some(Antecedent {
                weight: rule.weight.min(1.0),
                literals: literals(model, &rule.condition)?,
            })
        })
        .collect();
    // Inputs that many rules read come first: once they are fixed, few of the other inputs matter.
    let mentions = |input: usize| {
        let literals = rules.iter().flat_map(|rule| &rule.literals);
        literals.filter(|(i, _)| *i == input).count()
    };
    let mut order: Vec<usize> = (0..inputs.len()).collect();
    order.sort_by_key(|&input| core::cmp::Reverse(mentions(input)));
    for (input, _) in rules.iter_mut().flat_map(|rule| &mut rule.literals) {
        *input = order.iter().position(|i| i == input).unwrap_or_default();
    }
    let mut search = GapSearch {
        inputs: order.iter().map(|&input| &inputs[input]).collect(),
        rules,
        and: model.operators.and,
        coverage_below,
        cell: Vec::new(),
        steps: 0,
    };
    search.is_covered()
}

/// Whether all rules share the same operators and fire with the degree of their condition.
pub(super) fn is_plain(model: &Model) -> bool {
    model.blocks.is_empty() && model.activation == Activation::General
}

/// The antecedent of a rule: its inputs and their terms, joined by AND.
struct Antecedent {
    weight: f64,
    literals: Vec<(usize, usize)>,
}

/// A depth-first search for a cell that no rule covers.
struct GapSearch<'a> {
    inputs: Vec<&'a MinimumDegrees>,
    rules: Vec<Antecedent>,
    and: Conjunction,
    coverage_below: f64,
    /// For each of the first inputs, the index of its interval.
    cell: Vec<usize>,
    steps: usize,
}

impl GapSearch<'_> {
    /// Whether all cells that have the intervals in `cell` for the first inputs are covered. A rule that reads
    /// none of the remaining inputs covers all of these cells at once, or none of them.
    fn is_covered(&mut self) -> bool {
        self.steps += self.rules.len();
        let known = self.cell.len();
        let decided = self.rules.iter().filter(|rule| {
            let last = rule.literals.iter().map(|(input, _)| input + 1).max();
            last.unwrap_or(0) == known
        });
        let strongest = decided.map(|rule| self.strength(rule)).fold(0.0, f64::max);
        if !is_gap(strongest, self.coverage_below) {
            return true;
        }
        let Some(intervals) = self.inputs.get(known).map(|least| least.len()) else {
            return false;
        };
        (0..intervals).all(|interval| {
            self.cell.push(interval);
            let covered = self.steps < MAX_STEPS && self.is_covered();
            self.cell.pop();
            covered
        })
    }

    fn strength(&self, rule: &Antecedent) -> f64 {
        let degrees = rule
            .literals
            .iter()
            .map(|(input, term)| self.inputs[*input][self.cell[*input]][*term]);
        rule.weight
            * match self.and {
                Conjunction::Minimum => degrees.fold(1.0, f64::min),
                Conjunction::Product => degrees.product(),
                Conjunction::BoundedDifference
                | Conjunction::Drastic
                | Conjunction::Einstein
                | Conjunction::Hamacher
                | Conjunction::NilpotentMinimum => 0.0,
            }
    }
}

fn least_degrees(input: &Variable) -> MinimumDegrees {
    let corners: Vec<_> = input
        .terms
        .iter()
        .map(|term| term.membership_function.corners())
        .collect();
    let all = corners.iter().flatten().flatten().map(|(x, _)| *x);
    let mut cuts: Vec<f64> = all.chain([input.low, input.high]).collect();
    cuts.retain(|x| (input.low..=input.high).contains(x));
    cuts.sort_by(f64::total_cmp);
    cuts.dedup();
    let middles: Vec<f64> = cuts
        .windows(2)
        .map(|pair| (pair[0] + pair[1]) / 2.0)
        .collect();
    cuts.extend(middles);
    cuts.sort_by(f64::total_cmp);
    let terms = || input.terms.iter().zip(&corners);
    let least = |pair: &[f64]| {
        let degrees = terms().map(|(term, corners)| {
            let jumps = |corners: &Vec<(f64, f64)>| corners.windows(2).any(|c| c[0].0 == c[1].0);
            match corners {
                Some(corners) if !jumps(corners) => {
                    let [start, end] =
                        [pair[0], pair[1]].map(|x| term.membership_function.membership(x));
                    term.height * start.min(end)
                }
                _ => 0.0,
            }
        });
        degrees.collect()
    };
    cuts.windows(2).map(least).collect()
}

/// The input and term of each proposition, if the condition consists of propositions joined by AND; otherwise `None`.
fn literals(model: &Model, condition: &Condition) -> Option<Vec<(usize, usize)>> {
    match condition {
        Condition::Is(Proposition {
            variable,
            hedges,
            term: Some(term),
        }) if hedges.is_empty() => {
            let input = model.inputs.iter().position(|i| variable.text == i.name)?;
            let term = model.inputs[input]
                .terms
                .iter()
                .position(|t| term.text == t.name)?;
            Some([(input, term)].into())
        }
        Condition::And(all) => {
            let parts: Option<Vec<_>> = all.iter().map(|part| literals(model, part)).collect();
            parts.map(|parts| parts.concat())
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gap::GapSettings;
    use alloc::format;

    fn proven(and: &str, terms: &str, rules: &str) -> bool {
        let text = format!(
            "
fuzzy: 1
name: heating
inputs: {{inside: {{range: [0, 30], {terms}}}, outside: {{range: [-20, 40], partition: {{cold: 0, warm: 20}}}}}}
outputs: {{power: {{range: [0, 100], partition: [low, high]}}}}
operators: {{and: {and}}}
rules: [{rules}]
"
        );
        let model = fuzzy::yaml::parse(&text).unwrap().model;
        let below = GapSettings::default().coverage_below(&model);
        has_no_gap(&model, &model.outputs[0], below)
    }

    const PARTITION: &str = "partition: {cold: 10, warm: 20}";
    const ALL: &str = "IF inside IS cold AND outside IS cold THEN power IS high,
        IF inside IS cold AND outside IS warm THEN power IS high,
        IF inside IS warm AND outside IS cold THEN power IS high,
        IF inside IS warm AND outside IS warm THEN power IS low";

    #[test]
    fn rules_for_every_combination_leave_no_gap() {
        assert!(proven("minimum", PARTITION, ALL) && proven("product", PARTITION, ALL));
        let (all_but_one, _) = ALL.rsplit_once(',').unwrap();
        assert!(!proven("minimum", PARTITION, all_but_one));
        assert!(!proven("product", PARTITION, all_but_one));
    }

    #[test]
    fn rules_about_one_input_that_cover_all_of_it_leave_no_gap() {
        let one = "IF inside IS cold THEN power IS high, IF inside IS warm THEN power IS low";
        assert!(proven("product", PARTITION, one));
    }

    #[test]
    fn an_unproven_cover_may_have_a_gap() {
        let bells =
            "terms: {cold: {gaussian: {mean: 0, sd: 9}}, warm: {gaussian: {mean: 30, sd: 9}}}";
        let step = "terms: {cold: {rectangle: [0, 15]}, warm: {rectangle: [15, 30]}}";
        assert!(!proven("minimum", bells, ALL) && !proven("minimum", step, ALL));
        assert!(!proven("einstein", PARTITION, ALL));
    }
}
