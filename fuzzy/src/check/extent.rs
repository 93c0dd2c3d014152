//! The values that an output can take, computed from its consequents only.

use alloc::{format, string::String, vec::Vec};

use crate::{
    Engine,
    model::{Defuzzifier, MembershipFunction, Model, NoRuleFires, Variable},
    rule::{Condition, Rule},
};

/// The firing strengths at which each term is evaluated. The centroid of a cut set depends on the height of the cut.
const STRENGTHS: [f64; 7] = [1.0, 0.9, 0.75, 0.5, 0.25, 0.1, 0.01];

/// Returns the smallest and the largest value of an output if only one consequent of its rules is active, at any firing
/// strength.
///
/// If the terms form a partition, several active consequents give a value between these two; otherwise the value may
/// exceed them slightly. The value for inputs at which no rule fires is included. `None` if the model does not compile,
/// has no such output or no rule for it, if type-2 terms affect the output, or if values are unbounded: for linear
/// terms and formulas, the weighted sum, and Tsukamoto outputs.
///
/// # Example: the centroid of the last term differs from the end of the range
/// ```
/// use fuzzy::check;
///
/// let model = fuzzy::yaml::parse("
/// fuzzy: 1
/// name: fan
/// inputs: {heat: {range: [0, 1], partition: [low, high]}}
/// outputs: {fan: {range: [0, 90], partition: [slow, medium, fast]}}
/// rules: [IF heat IS low THEN fan IS slow, IF heat IS high THEN fan IS fast]
/// ")?.model;
/// let (low, high) = check::extent(&model, "fan").ok_or("no rule")?;
/// assert!((low - 15.0).abs() < 1e-9 && (high - 75.0).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
pub fn extent(model: &Model, output: &str) -> Option<(f64, f64)> {
    let found = model.outputs.iter().find(|o| o.variable.name == output)?;
    if model.has_interval(found) {
        return None;
    }
    match found.defuzzifier {
        Defuzzifier::WeightedSum | Defuzzifier::Tsukamoto => return None,
        Defuzzifier::Centroid
        | Defuzzifier::Bisector
        | Defuzzifier::SmallestOfMaxima
        | Defuzzifier::MeanOfMaxima
        | Defuzzifier::LargestOfMaxima
        | Defuzzifier::WeightedAverage => {}
    }
    let concluded = |term: &str| {
        let rules = model.rules.iter().filter(|rule| model.is_enabled(rule));
        rules
            .flat_map(|rule| &rule.rule.consequents)
            .filter(|c| c.output.text == output)
            .any(|c| c.term.text == term)
    };
    let terms = found.variable.terms.iter();
    let terms: Vec<_> = terms.filter(|term| concluded(&term.name)).collect();
    let is_linear = |f: &MembershipFunction| match f {
        MembershipFunction::Linear { .. } => true,
        MembershipFunction::Function { .. } => found.defuzzifier.takes_numbers(),
        _ => false,
    };
    if terms
        .iter()
        .any(|term| is_linear(&term.membership_function))
    {
        return None;
    }
    // Builds a model with one rule per term. At `selector` = 2 i + strength, only the rule of term i fires, with that
    // strength.
    let name = |term: usize| -> String { format!("term {term}") };
    let mut selector = Variable::new("selector", 0.0, 2.0 * terms.len().max(1) as f64);
    let mut alone = Model::builder("extent").operators(model.operators_of_output(found));
    for (i, term) in terms.iter().enumerate() {
        let left = 2.0 * i as f64;
        let (peak, right) = (left + 1.0, left + 1.5);
        let ramp = MembershipFunction::Triangle { left, peak, right };
        selector = selector.term(name(i), ramp);
        let condition = Condition::is("selector", &name(i));
        alone = alone.rule(Rule::new(condition, output, term.name.as_str()));
    }
    let mut only = found.clone();
    only.variable.terms = terms.iter().map(|term| (*term).clone()).collect();
    only.when_no_rule_fires = NoRuleFires::Undefined;
    let engine = Engine::new(&alone.input(selector).output(only).build()).ok()?;
    let mut values = Vec::new();
    if let NoRuleFires::Value(value) | NoRuleFires::Previous(Some(value)) = found.when_no_rule_fires
    {
        values.push(value);
    }
    for i in 0..terms.len() {
        for strength in STRENGTHS {
            let outcomes = engine.evaluate(&[2.0 * i as f64 + strength]).ok()?;
            values.extend(outcomes.first().and_then(|outcome| outcome.value()));
        }
    }
    let low = values.iter().copied().reduce(f64::min)?;
    let high = values.iter().copied().reduce(f64::max)?;
    Some((low, high))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(output: &str, rules: &str) -> Option<(f64, f64)> {
        let text = format!(
            "fuzzy: 1\nname: t\ninputs: {{x: {{range: [0, 1], partition: [a, b]}}}}\noutputs: {{y: {output}}}\nrules: {rules}"
        );
        extent(&crate::yaml::parse(&text).unwrap().model, "y")
    }

    #[test]
    fn only_concluded_terms_determine_the_extent() {
        let output = "{range: [0, 12], partition: [low, medium, high]}";
        let (low, high) = of(output, "[IF x IS a THEN y IS medium]").unwrap();
        assert!((low - 6.0).abs() < 1e-9 && (high - 6.0).abs() < 1e-9);
        // A ramp that is cut near its foot is nearly flat, so its centroid is near its middle.
        let (low, high) = of(output, "[IF x IS a THEN y IS high]").unwrap();
        assert!((high - 10.0).abs() < 1e-9, "{high}");
        assert!((low - 9.0).abs() < 0.02, "{low}");
    }

    #[test]
    fn a_default_value_counts_and_linear_terms_have_no_bound() {
        let output = "{range: [0, 12], partition: [low, high], when_no_rule_fires: {value: 12}}";
        assert_eq!(of(output, "[IF x IS a THEN y IS low]").unwrap().1, 12.0);
        let takagi = "{range: [0, 9], defuzzifier: weighted_average, terms: {c: {constant: 4}, l: {linear: {x: 2, constant: 1}}}}";
        assert_eq!(of(takagi, "[IF x IS a THEN y IS c]"), Some((4.0, 4.0)));
        assert_eq!(of(takagi, "[IF x IS a THEN y IS l]"), None);
    }
}
