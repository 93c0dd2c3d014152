//! Whether a rule set has no gap: rules that cover all values of the inputs need no filling.

use alloc::vec::Vec;

use fuzzy::{
    Model,
    model::{Conjunction, Output, Variable},
    rule::{Condition, Name, Proposition, Rule},
};

use super::is_gap;

/// With more cells times rules the proof is not tried.
const MOST_STEPS: usize = 5_000_000;

/// The least degree of each term in each interval of an input.
type Least = Vec<Vec<f64>>;

/// Whether it is certain that no values of the inputs have a coverage by the rules of an output that counts as a gap.
///
/// The range of each input is cut at the corners of its terms and half way between them. In between, degrees are linear, so
/// the least is at an end. The least strength of a rule in a cell follows from the least degrees in the intervals. Rules with
/// other words than AND and IS, and curved terms, count as 0.
pub(crate) fn has_no_gap(model: &Model, output: &Output, coverage_below: f64) -> bool {
    let inputs: Vec<Least> = model.inputs.iter().map(least_degrees).collect();
    let is_output = |name: &Name| name.text == output.variable.name;
    let concludes = |rule: &Rule| rule.consequents.iter().any(|c| is_output(&c.output));
    let rules = model
        .rules
        .iter()
        .map(|rule| &rule.rule)
        .filter(|rule| concludes(rule));
    let rules: Vec<(f64, Vec<(usize, usize)>)> = rules
        .filter_map(|rule| Some((rule.weight.min(1.0), literals(model, &rule.condition)?)))
        .collect();
    let lengths = || inputs.iter().map(Vec::len);
    let cells = lengths().fold(1, usize::saturating_mul);
    let strength = |cell: &[usize], (weight, literals): &(f64, Vec<(usize, usize)>)| {
        let degrees = literals
            .iter()
            .map(|(input, term)| inputs[*input][cell[*input]][*term]);
        weight
            * match model.operators.and {
                Conjunction::Minimum => degrees.fold(1.0, f64::min),
                Conjunction::Product => degrees.product(),
                _ => 0.0,
            }
    };
    let mut cell: Vec<usize> = inputs.iter().map(|_| 0).collect();
    cells.saturating_mul(rules.len()) <= MOST_STEPS
        && (0..cells).all(|number| {
            let mut rest = number;
            for (interval, length) in cell.iter_mut().zip(lengths()) {
                (*interval, rest) = (rest % length, rest / length);
            }
            let strengths = rules.iter().map(|rule| strength(&cell, rule));
            !is_gap(strengths.fold(0.0, f64::max), coverage_below)
        })
}

fn least_degrees(input: &Variable) -> Least {
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

/// The input and term of each proposition, joined by AND; `None` where the condition is more than that.
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
    fn what_is_not_proven_may_have_a_gap() {
        let bells =
            "terms: {cold: {gaussian: {mean: 0, sd: 9}}, warm: {gaussian: {mean: 30, sd: 9}}}";
        let step = "terms: {cold: {rectangle: [0, 15]}, warm: {rectangle: [15, 30]}}";
        assert!(!proven("minimum", bells, ALL) && !proven("minimum", step, ALL));
        assert!(!proven("einstein", PARTITION, ALL));
    }
}
