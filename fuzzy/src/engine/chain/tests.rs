use alloc::{string::String, vec, vec::Vec};

use proptest::prelude::*;

use super::*;
use crate::{
    engine::{EvaluateError, State},
    model::{
        Aggregation, Conjunction, Defuzzifier, Disjunction, Implication, MembershipFunction, Model,
        NoRuleFires, Operators, Output, Variable,
    },
    rule::{Condition, Hedge, Rule},
};

fn engine(text: &str) -> Engine {
    Engine::new(&text.parse().unwrap()).unwrap()
}

fn values(engine: &Engine, inputs: &[f64]) -> Vec<Option<f64>> {
    let outcomes = engine.evaluate(inputs).unwrap();
    outcomes.iter().map(|outcome| outcome.value()).collect()
}

/// A chain of two outputs, whose terms have simple areas and centres. The output of the later stage is listed first.
const FAN: &str = "
fuzzy: 1
name: fan
inputs: {heat: {range: [0, 10], partition: [low, high]}}
outputs:
  fan: {range: [0, 100], terms: {slow: {rectangle: [0, 40]}, fast: {rectangle: [60, 100]}}}
  comfort: {range: [0, 10], terms: {poor: {triangle: [0, 2.5, 5]}, good: {triangle: [5, 7.5, 10]}}}
operators: {implication: product, aggregation: sum}
rules:
  - IF comfort IS good THEN fan IS slow
  - IF comfort IS NOT good THEN fan IS fast WITH 0.5
  - IF heat IS low THEN comfort IS good
  - IF heat IS high THEN comfort IS poor
";

#[test]
fn two_stages_have_values_computed_by_hand() {
    let engine = engine(FAN);
    let outcomes = engine.evaluate(&[3.0]).unwrap();
    // comfort = 0.7 * 7.5 + 0.3 * 2.5 = 6, whose degree in `good` is (6 - 5) / 2.5 = 0.4
    let value = |i: usize| outcomes[i].value().unwrap();
    assert!((value(1) - 6.0).abs() < 1e-12);
    // fan = (0.4 * 20 + 0.5 * 0.6 * 80) / (0.4 + 0.5 * 0.6)
    assert!((value(0) - 32.0 / 0.7).abs() < 1e-12);
    assert!((outcomes[0].coverage - 0.4).abs() < 1e-12);
    assert_eq!(
        (outcomes[0].dominant_rule, outcomes[1].dominant_rule),
        (Some(0), Some(2))
    );
    assert!(!outcomes[0].clamped && engine.evaluate(&[-1.0]).unwrap()[0].clamped);
    assert!(engine.table().is_none());
}

#[test]
fn a_linear_function_reads_an_output_and_a_value_outside_its_range_is_clamped() {
    let engine = engine(
        "
fuzzy: 1
name: tank
inputs: {level: {range: [0, 10], partition: [low, high]}}
outputs:
  need: {range: [0, 4], defuzzifier: weighted_average, terms: {by_level: {linear: {level: -1, constant: 8}}}}
  pump: {range: [0, 50], defuzzifier: weighted_average, terms: {by_need: {linear: {need: 10, level: 1}}}}
rules: [IF level IS any THEN need IS by_level AND pump IS by_need]
",
    );
    assert_eq!(values(&engine, &[6.0]), [Some(2.0), Some(26.0)]);
    assert!(!engine.evaluate(&[6.0]).unwrap()[1].clamped);
    // The value of a Takagi-Sugeno output is not clamped; but if a rule reads the output, the value that it reads is
    // clamped.
    assert_eq!(values(&engine, &[2.0]), [Some(6.0), Some(42.0)]);
    let outcomes = engine.evaluate(&[2.0]).unwrap();
    assert_eq!((outcomes[0].clamped, outcomes[1].clamped), (false, true));
}

/// Returns an engine in which a value of `x` below 4 determines `a`, `a` determines `b`, and `b` and `x` determine
/// `c`.
fn three(a: &str, c: &str) -> Engine {
    engine(&alloc::format!(
        "
fuzzy: 1
name: three
inputs: {{x: {{range: [0, 10], terms: {{low: {{left_shoulder: [1, 4]}}, all: {{constant: 1}}}}}}}}
outputs:
  a: {{range: [0, 1], partition: [low, high], when_no_rule_fires: {a}}}
  b: {{range: [0, 1], partition: [low, high], when_no_rule_fires: {{value: 0.5}}}}
  c: {{range: [0, 1], partition: [low, high], when_no_rule_fires: {c}}}
  apart: {{range: [0, 1], partition: [low, high]}}
rules:
  - IF x IS low THEN a IS high
  - IF a IS any THEN b IS high
  - IF NOT b IS low THEN c IS high AND apart IS low
  - IF x IS all THEN c IS low
"
    ))
}

#[test]
fn an_output_that_reads_an_unknown_output_is_unknown() {
    let engine = three("undefined", "{value: 0.5}");
    assert!(values(&engine, &[2.0]).iter().all(Option::is_some));
    // `b` and `c` have default values, and `c` has a rule about `x`, but the outputs they read are undefined.
    let outcomes = engine.evaluate(&[5.0]).unwrap();
    assert_eq!(outcomes[..], [Outcome::UNDEFINED; 4]);
    let explanation = engine.explain(&[5.0]).unwrap();
    assert!(explanation.rules.is_empty(), "{explanation:?}");
    assert_eq!(explanation.outputs[2].reads, ["b"]);
    let clamped = engine.evaluate(&[11.0]).unwrap();
    assert!(
        clamped
            .iter()
            .all(|outcome| outcome.clamped && outcome.value().is_none())
    );
}

#[test]
fn a_default_value_is_passed_to_the_next_stage() {
    let engine = three("{value: 1}", "undefined");
    let outcomes = engine.evaluate(&[5.0]).unwrap();
    assert_eq!(outcomes[0].state, State::Default(1.0));
    assert!(outcomes.iter().all(|outcome| outcome.value().is_some()));
}

#[test]
fn no_rule_firing_for_an_intermediate_output_can_be_an_error() {
    let error = three("error", "undefined").evaluate(&[5.0]).unwrap_err();
    let output = "a".into();
    assert_eq!(error, EvaluateError::NoRuleFired { output });
}

#[test]
fn an_input_that_is_not_a_number_makes_all_outputs_unknown() {
    let unknown = Outcome {
        state: State::InputNotFinite,
        ..Outcome::UNDEFINED
    };
    let outcomes = three("undefined", "undefined")
        .evaluate(&[f64::NAN])
        .unwrap();
    assert_eq!(outcomes[..], [unknown; 4]);
}

fn messages(text: &str) -> Vec<String> {
    let model = crate::yaml::parse(text).unwrap_err();
    let codes = model.0.iter();
    codes
        .map(|f| alloc::format!("{}: {}", f.code, f.message))
        .collect()
}

#[test]
fn a_cycle_is_refused_with_its_path() {
    let text = FAN.replace(
        "IF heat IS high THEN comfort",
        "IF fan IS fast THEN comfort",
    );
    assert_eq!(
        messages(&text),
        [
            "circular-outputs: circular dependency between outputs: `fan` reads `comfort` in rule 1 and \
          `comfort` reads `fan` in rule 4"
        ]
    );
    let itself = FAN.replace(
        "IF heat IS high THEN comfort",
        "IF comfort IS good THEN comfort",
    );
    assert_eq!(
        messages(&itself),
        [
            "circular-outputs: an output cannot read itself, but rule 4 has `comfort` in its condition and its conclusion"
        ]
    );
}

/// Generates models over `inputs` with conclusions about one output.
fn any_stage(
    inputs: &'static [&'static str],
    output: &'static str,
) -> impl Strategy<Value = Model> {
    let variables: Vec<_> = inputs.iter().map(|name| any_variable(name)).collect();
    let rules = prop::collection::vec((any_condition(inputs), 0..3usize, any_weight()), 1..5);
    (
        variables,
        any_variable(output),
        rules,
        any_policy(),
        any_defuzzifier(),
    )
        .prop_map(move |(inputs, variable, rules, policy, defuzzifier)| {
            let mut model = Model::builder(output).build();
            model.inputs = inputs;
            let mut concluded = Output::new(variable).when_no_rule_fires(policy);
            concluded.defuzzifier = defuzzifier;
            model.outputs.push(concluded);
            for (condition, term, weight) in rules {
                let rule = Rule::new(condition, output, TERMS[term]).with(weight);
                model.rules.push(rule.into());
            }
            model
        })
}

const TERMS: [&str; 3] = ["low", "middle", "high"];

fn any_variable(name: &'static str) -> impl Strategy<Value = Variable> {
    let triangle = |from: f64| {
        (from..from + 2.0, 0.0..3.0f64, 0.0..3.0f64).prop_map(|(left, rise, fall)| {
            let (peak, right) = (left + rise, left + rise + fall + 0.1);
            MembershipFunction::Triangle { left, peak, right }
        })
    };
    (triangle(0.0), triangle(3.0), triangle(6.0)).prop_map(move |(low, middle, high)| {
        let variable = Variable::new(name, 0.0, 10.0).term("low", low);
        variable.term("middle", middle).term("high", high)
    })
}

fn any_condition(inputs: &'static [&'static str]) -> impl Strategy<Value = Condition> {
    let hedges = prop::sample::select(vec![vec![], vec![Hedge::Very], vec![Hedge::Not]]);
    let is = (prop::sample::select(inputs), 0..3usize, hedges)
        .prop_map(|(input, term, hedges)| Condition::is_hedged(input, &hedges, TERMS[term]));
    is.prop_recursive(2, 6, 3, |inner| {
        let parts = prop::collection::vec(inner.clone(), 2..3);
        prop_oneof![
            parts.clone().prop_map(Condition::And),
            parts.prop_map(Condition::Or),
            inner.prop_map(Condition::negated),
        ]
    })
}

fn any_weight() -> impl Strategy<Value = f64> {
    prop::sample::select(vec![1.0, 1.0, 0.5, 0.3])
}

fn any_policy() -> impl Strategy<Value = NoRuleFires> {
    prop::sample::select(vec![NoRuleFires::Undefined, NoRuleFires::Value(4.0)])
}

fn any_defuzzifier() -> impl Strategy<Value = Defuzzifier> {
    prop::sample::select(vec![
        Defuzzifier::Centroid,
        Defuzzifier::Bisector,
        Defuzzifier::MeanOfMaxima,
    ])
}

fn any_operators() -> impl Strategy<Value = Operators> {
    let ands = vec![Conjunction::Minimum, Conjunction::Product];
    let ors = vec![Disjunction::Maximum, Disjunction::ProbabilisticSum];
    let cuts = vec![Implication::Minimum, Implication::Product];
    let sums = vec![Aggregation::Maximum, Aggregation::Sum];
    let one_of = (
        prop::sample::select(ands),
        prop::sample::select(ors),
        prop::sample::select(cuts),
        prop::sample::select(sums),
    );
    one_of.prop_map(|(and, or, implication, aggregation)| Operators {
        and,
        or,
        implication,
        aggregation,
    })
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    /// Compares a model with a chain to two separate models, where the output of the first model is an input of the
    /// second.
    #[test]
    fn a_chain_has_the_bits_of_two_models_in_a_row(
        mut first in any_stage(&["x", "y"], "mid"),
        mut second in any_stage(&["x", "y", "mid"], "last"),
        operators in any_operators(),
        later_first in any::<bool>(),
        points in prop::collection::vec((-1.0..=11.0f64, -1.0..=11.0f64), 1..10),
    ) {
        (first.operators, second.operators) = (operators, operators);
        // Each variable must have the same definition in both models.
        second.inputs.truncate(0);
        second.inputs.extend(first.inputs.iter().cloned());
        second.inputs.push(first.outputs[0].variable.clone());
        let mut whole = first.clone();
        if later_first {
            whole.outputs.insert(0, second.outputs[0].clone());
            whole.rules.splice(0..0, second.rules.iter().cloned());
        } else {
            whole.outputs.push(second.outputs[0].clone());
            whole.rules.extend(second.rules.iter().cloned());
        }
        let (mid, last) = if later_first { (1, 0) } else { (0, 1) };
        let second_rule = if later_first { 0 } else { first.rules.len() };
        let first_rule = if later_first { second.rules.len() } else { 0 };
        let reads = !whole.reads("last").is_empty();
        let (chained, first, second) =
            (Engine::new(&whole).unwrap(), Engine::new(&first).unwrap(), Engine::new(&second).unwrap());
        let mut batch = chained.evaluate_batch(&[
            &points.iter().map(|point| point.0).collect::<Vec<_>>(),
            &points.iter().map(|point| point.1).collect::<Vec<_>>(),
        ]).unwrap().into_iter();
        for (x, y) in points {
            let outcomes = chained.evaluate(&[x, y]).unwrap();
            if let Some(flat) = of_arrays(&chained, &[x, y]) {
                prop_assert_eq!(&flat[..], &outcomes[..]);
            }
            let handed = first.evaluate(&[x, y]).unwrap()[0];
            let mut expected = match handed.value() {
                Some(value) => second.evaluate(&[x, y, value]).unwrap()[0],
                None if reads => Outcome { clamped: handed.clamped, ..Outcome::UNDEFINED },
                None => second.evaluate(&[x, y, 0.0]).unwrap()[0],
            };
            expected.dominant_rule = expected.dominant_rule.map(|rule| rule + second_rule);
            let handed = Outcome { dominant_rule: handed.dominant_rule.map(|rule| rule + first_rule), ..handed };
            for (outcome, expected) in [(outcomes[mid], handed), (outcomes[last], expected)] {
                prop_assert_eq!(outcome, expected);
                prop_assert_eq!(outcome.value().map(f64::to_bits), expected.value().map(f64::to_bits));
            }
            prop_assert_eq!(batch.by_ref().take(2).collect::<Vec<_>>(), outcomes.to_vec());
            let explanation = chained.explain(&[x, y]).unwrap();
            for (explained, outcome) in explanation.outputs.iter().zip(&outcomes) {
                prop_assert_eq!(explained.value, outcome.value());
                let strongest = explained.rules.iter().map(|share| share.strength).fold(0.0, f64::max);
                prop_assert!((strongest - outcome.coverage).abs() < 1e-12);
            }
        }
    }
}

/// The rule that raises the fan most reads the comfort. The rule that determines the comfort reads the heat.
#[test]
fn the_rule_that_raises_an_output_is_found_through_the_outputs_it_reads() {
    let engine = engine(FAN);
    let mut scratch = engine.scratch();
    let fan = engine.evaluate(&[3.0]).unwrap()[0].value().unwrap();
    let propositions = engine.propositions();
    let of_index = |index: usize| {
        let mut all = propositions
            .iter()
            .filter(|proposition| proposition.evaluation_index == index);
        all.next().unwrap()
    };
    // Rules 3 and 4 belong to the first stage, so they are evaluated first.
    let index = engine.raised_by(&mut scratch, &[3.0], 0, fan).unwrap();
    let why = of_index(index);
    assert_eq!(
        (index, why.rule, why.input, &*why.term),
        (3, 1, 2, "NOT good")
    );
    // The rule for low heat is stronger, but it concludes that the comfort is good.
    let index = engine.concluded_by(&mut scratch, &[3.0], why).unwrap();
    let why = of_index(index);
    assert_eq!((index, why.rule, why.input, &*why.term), (1, 3, 0, "high"));
    assert_eq!(engine.concluded_by(&mut scratch, &[3.0], why), None);
    assert_eq!(engine.raised_by(&mut scratch, &[f64::NAN], 0, fan), None);
}

/// Returns the outcomes of the plain arrays of a chain; `None` if an output has no closed form.
fn of_arrays(engine: &Engine, inputs: &[f64]) -> Option<Vec<Outcome>> {
    let chain = engine.chain()?;
    assert_eq!(chain.check(inputs.len()), Ok(()));
    let table = chain.table;
    if table
        .outputs
        .iter()
        .any(|output| output.form() == table::ClosedForm::Integrated)
    {
        return None;
    }
    let (sizes, outputs) = (table.sizes, table.outputs.len());
    let most = inputs.len() + chain.most_reads();
    let mut scratch = table::Scratch {
        values: &mut vec![0.0; most],
        degrees: &mut vec![0.0; sizes.degrees as usize],
        alive: &mut vec![table::PartialConjunction::NONE; sizes.alive as usize],
        partial: &mut vec![table::PartialConjunction::NONE; sizes.partial as usize],
        next: &mut vec![table::PartialConjunction::NONE; sizes.partial as usize],
        stack: &mut vec![0.0; sizes.stack as usize],
        strengths: &mut vec![0.0; sizes.strengths as usize],
        strongest: &mut vec![table::StrongestRule::NONE; outputs],
    };
    let mut outcomes = vec![Outcome::UNDEFINED; outputs];
    let mut values = table::Values {
        inputs: &mut vec![0.0; most],
        own: &mut vec![Outcome::UNDEFINED; outputs],
    };
    chain.evaluate(&mut scratch, &mut values, inputs, &mut outcomes);
    Some(outcomes)
}

#[test]
fn plain_arrays_have_the_bits_of_the_engine() {
    let engine = engine(FAN);
    for i in -10..=110 {
        let heat = f64::from(i) / 10.0;
        let expected = engine.evaluate(&[heat]).unwrap();
        assert_eq!(of_arrays(&engine, &[heat]).unwrap(), expected.to_vec());
    }
    let unknown = of_arrays(&engine, &[f64::NAN]).unwrap();
    assert_eq!(unknown[..], engine.evaluate(&[f64::NAN]).unwrap()[..]);
}
