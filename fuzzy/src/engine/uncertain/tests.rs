use alloc::{format, vec::Vec};

use super::*;
use crate::Model;

fn engine(outputs: &str, rules: &str) -> Engine {
    let text = format!(
        "
fuzzy: 1
name: fan
inputs:
  heat: {{range: [0, 40], partition: [low, high]}}
  damp: {{range: [0, 1], terms: {{wet: {{right_shoulder: [0.5, 1]}}}}}}
outputs: {outputs}
rules: {rules}
"
    );
    let model: Model = text.parse().unwrap();
    Engine::new(&model).unwrap()
}

const SPEED: &str = "{speed: {range: [0, 8], defuzzifier: weighted_average, terms: {slow: {constant: 0}, fast: {constant: 8}}}}";
const BY_HEAT: &str = "[IF heat IS low THEN speed IS slow, IF heat IS high THEN speed IS fast]";

fn of(engine: &Engine, heat: Interval, damp: Interval) -> IntervalOutcome {
    engine.evaluate_interval(&[heat, damp]).unwrap()[0]
}

#[test]
fn a_straight_line_has_the_values_at_its_ends() {
    let engine = engine(SPEED, BY_HEAT);
    let values = of(&engine, Interval::new(10.0, 20.0), Interval::new(0.0, 1.0));
    let Interval { low, high } = values.values.unwrap();
    assert!(
        (1.98..=2.0).contains(&low) && (4.0..=4.02).contains(&high),
        "{low} {high}"
    );
    assert!(!values.may_be_undefined && !values.clamped);
    // If all intervals are points, the interval of the output is its value.
    let value = engine.evaluate(&[13.0, 0.0]).unwrap()[0].value().unwrap();
    let point = of(&engine, 13.0.into(), 0.0.into());
    assert_eq!(point.values, Some(value.into()));
    let beyond = of(&engine, Interval::new(35.0, 99.0), 0.0.into());
    assert!(beyond.clamped && (beyond.values.unwrap().low - 7.0).abs() < 0.01);
}

#[test]
fn an_output_without_a_rule_somewhere_may_be_undefined() {
    let rules = "[IF damp IS wet AND heat IS high THEN speed IS fast]";
    let speed = engine(SPEED, rules);
    let heat = Interval::new(10.0, 20.0);
    let outcome = |damp| of(&speed, heat, damp);
    assert_eq!(outcome(Interval::new(0.0, 0.4)).values, None);
    let some = outcome(Interval::new(0.4, 0.6));
    assert!(some.may_be_undefined && some.values.unwrap().contains(8.0));
    assert!(!outcome(Interval::new(0.6, 0.7)).may_be_undefined);
    let with_default = SPEED.replace(
        "range: [0, 8]",
        "range: [0, 8], when_no_rule_fires: {value: 3}",
    );
    let outcome = of(&engine(&with_default, rules), heat, Interval::new(0.4, 0.6));
    let values = outcome.values.unwrap();
    assert!(values.contains(3.0) && values.contains(8.0) && !values.contains(2.9));
    assert!(!outcome.may_be_undefined);
    let must_fire = SPEED.replace("range: [0, 8]", "range: [0, 8], when_no_rule_fires: error");
    let must_fire = engine(&must_fire, rules);
    assert!(
        must_fire
            .evaluate_interval(&[heat, Interval::new(0.0, 0.4)])
            .is_err()
    );
    assert!(
        must_fire
            .evaluate_interval(&[heat, Interval::new(0.0, 0.6)])
            .is_ok()
    );
}

#[test]
fn invalid_intervals_are_errors() {
    let engine = engine(SPEED, BY_HEAT);
    let error = |inputs: &[Interval]| engine.evaluate_interval(inputs).unwrap_err();
    assert_eq!(
        error(&[Interval::new(1.0, f64::NAN), 0.0.into()]),
        EvaluateError::InputNotFinite
    );
    assert_eq!(
        error(&[Interval::new(2.0, 1.0), 0.0.into()]).to_string(),
        "the interval of input `heat` ends below its start"
    );
    assert!(matches!(
        error(&[0.0.into()]),
        EvaluateError::WrongNumberOfInputs { .. }
    ));
}

/// Tests rules whose firing strengths are products of degrees of different inputs and are summed for each term.
#[test]
fn products_of_different_inputs_have_exact_bounds() {
    let outputs = |defuzzifier: &str| {
        format!(
            "{{speed: {{range: [0, 8], {defuzzifier}, aggregation: sum}}, share: {{range: [0, 1], partition: [less, more]}}}}"
        )
    };
    let centroid = outputs("terms: {slow: {triangle: [0, 1, 3]}, fast: {trapezoid: [2, 5, 6, 8]}}");
    let average =
        outputs("defuzzifier: weighted_average, terms: {slow: {constant: 1}, fast: {constant: 6}}");
    let rules = "
  - IF heat IS low AND damp IS wet THEN speed IS slow WITH 0.3
  - IF heat IS high THEN speed IS fast
  - IF heat IS low THEN speed IS slow WITH 0.8
  - IF damp IS wet THEN speed IS fast WITH 0.6
  - IF heat IS low THEN share IS less
operators: {and: product, or: maximum, implication: product, aggregation: sum}";
    for outputs in [centroid, average] {
        let engine = engine(&outputs, rules);
        for (heat, damp) in [
            (Interval::new(0.0, 40.0), Interval::new(0.0, 1.0)),
            (Interval::new(12.0, 31.0), Interval::new(0.4, 0.8)),
            (Interval::new(25.0, 25.0), Interval::new(0.7, 0.8)),
        ] {
            let values = of(&engine, heat, damp).values.unwrap();
            let mut inner: Option<Interval> = None;
            for i in 0..=400 {
                for j in 0..=400 {
                    let part = |it: Interval, i: u32| it.low + it.width() * f64::from(i) / 400.0;
                    let value = engine.evaluate(&[part(heat, i), part(damp, j)]).unwrap()[0];
                    let value = Interval::from(value.value().unwrap());
                    inner = Some(inner.map_or(value, |inner| inner.hull(value)));
                }
            }
            let inner = inner.unwrap();
            assert!(values.low <= inner.low && inner.high <= values.high);
            assert!(
                inner.low - values.low < 1e-3 && values.high - inner.high < 1e-3,
                "{values:?} {inner:?}"
            );
        }
        // At heat 40 no rule about `share` fires, so `share` may be undefined although it has a value at other
        // vertices.
        let undefined = engine.evaluate_interval(&[Interval::new(0.0, 40.0), 0.0.into()]);
        assert!(undefined.unwrap()[1].may_be_undefined);
    }
}

#[test]
fn every_defuzzifier_and_activation_method_encloses_its_values() {
    let fuzzy = |rest: &str| {
        format!(
            "{{speed: {{range: [0, 8], terms: {{slow: {{triangle: [0, 1, 3]}}, fast: {{trapezoid: [2, 5, 6, 8]}}}}, {rest}}}}}"
        )
    };
    let mut engines = Vec::new();
    for rest in [
        "defuzzifier: centroid",
        "defuzzifier: bisector",
        "defuzzifier: smallest_of_maxima",
        "defuzzifier: mean_of_maxima",
        "defuzzifier: largest_of_maxima",
        "aggregation: sum",
        "samples: {midpoint: 50}",
    ] {
        engines.push(engine(&fuzzy(rest), BY_HEAT));
    }
    engines.push(engine(
        "{speed: {range: [0, 8], defuzzifier: tsukamoto, terms: {slow: {left_shoulder: [0, 3]}, fast: {s_shape: [2, 8]}}}}",
        "[IF heat IS low THEN speed IS slow, IF heat IS high OR damp IS wet THEN speed IS fast]",
    ));
    engines.push(engine(
        "{speed: {range: [0, 8], defuzzifier: weighted_sum, terms: {slow: {linear: {damp: -3, constant: 1}}, fast: {function: heat^2 / 200}}}}",
        "[IF heat IS low THEN speed IS slow, IF heat IS very high THEN speed IS fast WITH 0.5]",
    ));
    engines.push(engine(
        "{speed: {range: [0, 8], terms: {slow: {singleton: 1}, fast: {singleton: 6}}, defuzzifier: mean_of_maxima}}",
        BY_HEAT,
    ));
    engines.push(engine(
        "{comfort: {range: [0, 1], partition: [poor, good]}, speed: {range: [0, 8], partition: [slow, fast]}}",
        "[IF heat IS low THEN comfort IS good, IF heat IS high THEN comfort IS poor, IF comfort IS good THEN speed IS slow, IF comfort IS poor OR damp IS wet THEN speed IS fast]",
    ));
    for activation in [
        "proportional",
        "{first: 1}",
        "{last: 1}",
        "{highest: 1}",
        "{lowest: 1}",
        "{threshold: {above: 0.4}}",
    ] {
        let rules = format!("{BY_HEAT}\nactivation: {activation}");
        engines.push(engine(&fuzzy("defuzzifier: centroid"), &rules));
    }
    for engine in &engines {
        for (heat, damp) in [
            (Interval::new(0.0, 40.0), Interval::new(0.0, 1.0)),
            (Interval::new(18.0, 21.0), Interval::new(0.4, 0.8)),
            (Interval::new(25.0, 25.0), Interval::new(0.7, 0.8)),
            (Interval::new(3.0, 3.5), Interval::new(0.2, 0.2)),
        ] {
            let enclosed = engine.evaluate_interval(&[heat, damp]).unwrap();
            for i in 0..=20 {
                for j in 0..=20 {
                    let part = |it: Interval, i: u32| it.low + it.width() * f64::from(i) / 20.0;
                    let point = [part(heat, i), part(damp, j)];
                    let outcomes = engine.evaluate(&point).unwrap();
                    for (outcome, enclosed) in outcomes.iter().zip(&enclosed) {
                        match outcome.value() {
                            None => assert!(enclosed.may_be_undefined, "{point:?}"),
                            Some(value) => assert!(
                                enclosed.values.is_some_and(|values| values.contains(value)),
                                "{point:?} {value} {enclosed:?} {:?}",
                                engine.model()
                            ),
                        }
                    }
                }
            }
        }
    }
}
