//! Tests of conclusions: Tsukamoto outputs, hedges, formulas, singletons. Values are compared to an independent
//! computation from the definition.

#![allow(
    clippy::panic,
    clippy::unwrap_used,
    reason = "helpers of tests fail by panics"
)]

use fuzzy::{Engine, Model};

/// Returns a rule set with one input `x` in [0, 1]; the degree of `x` in the term `high` equals its value.
fn model(outputs: &str, rules: &str) -> Model {
    let text = format!(
        "fuzzy: 1\nname: t\ninputs: {{x: {{range: [0, 1], terms: {{low: {{left_shoulder: [0, 1]}}, high: {{right_shoulder: [0, 1]}}}}}}}}\noutputs: {outputs}\nrules: {rules}"
    );
    text.parse()
        .unwrap_or_else(|found| panic!("{text}\n{found}"))
}

fn value(engine: &Engine, x: f64) -> f64 {
    engine.evaluate(&[x]).unwrap()[0].value().unwrap()
}

/// Evaluates a term at several firing strengths; returns each strength, the output value, and the membership of that
/// value.
fn places(shape: &str, range: &str, height: f64) -> Vec<(f64, f64, f64)> {
    let output = format!(
        "{{y: {{range: {range}, defuzzifier: tsukamoto, terms: {{t: {{{shape}, height: {height}}}}}}}}}"
    );
    let model = model(&output, "[IF x IS high THEN y IS t]");
    let engine = Engine::new(&model).unwrap();
    let term = &model.outputs[0].variable.terms[0];
    let degrees = [0.001, 0.1, 0.25, 0.4999, 0.5, 0.7, 0.9, 0.9999];
    let place = |w| (w, value(&engine, w), term.membership(value(&engine, w)));
    degrees.map(place).to_vec()
}

#[test]
fn a_tsukamoto_value_is_where_the_term_has_the_degree() {
    for shape in [
        "right_shoulder: [2, 8]",
        "left_shoulder: [2, 8]",
        "s_shape: [2, 8]",
        "z_shape: [2, 8]",
        "sigmoid: {inflection: 5, slope: 1.5}",
        "sigmoid: {inflection: 5, slope: -1.5}",
        "concave: {inflection: 4, end: 6}",
        "concave: {inflection: 6, end: 4}",
        "arc: {start: 2, end: 8}",
        "arc: {start: 8, end: 2}",
        "piecewise: [[1, 0], [3, 0.3], [5, 0.4], [9, 1]]",
        "piecewise: [[1, 1], [3, 0.6], [5, 0.55], [9, 0]]",
    ] {
        for (w, z, there) in places(shape, "[0, 10]", 1.0) {
            assert!((there - w).abs() < 1e-12, "{shape}: {w} at {z} is {there}");
        }
        for (w, z, there) in places(shape, "[0, 10]", 0.8) {
            // For degrees above the height of the term, the value is the end of its slope; a sigmoid has no such end.
            if w < 0.8 || !shape.starts_with("sigmoid") {
                let found = (there - w.min(0.8)).abs();
                assert!(found < 1e-12, "{shape}: {w} at {z} is {there}");
            }
        }
    }
}

#[test]
fn plateaus_steps_and_infinity() {
    let at = |shape: &str, w: f64| {
        let output =
            format!("{{y: {{range: [0, 10], defuzzifier: tsukamoto, terms: {{t: {{{shape}}}}}}}}}");
        let model = model(&output, "[IF x IS high THEN y IS t]");
        // Because of rounding, `w z / w` may differ from `z`.
        (value(&Engine::new(&model).unwrap(), w) * 1e12).round() / 1e12
    };
    // The value is the end of the slope, not the middle of the plateau.
    assert_eq!(at("right_shoulder: [2, 8]", 1.0), 8.0);
    assert_eq!(at("left_shoulder: [2, 8]", 1.0), 2.0);
    let steps = "piecewise: [[1, 0.2], [2, 0.2], [4, 0.6], [6, 0.6], [6, 0.8], [9, 0.8]]";
    assert_eq!(at(steps, 0.1), 2.0);
    assert_eq!(at(steps, 0.2), 2.0);
    assert_eq!(at(steps, 0.4), 3.0);
    assert_eq!(at(steps, 0.6), 4.0);
    assert_eq!(at(steps, 0.7), 6.0);
    assert_eq!(at(steps, 0.9), 6.0);
    // A sigmoid never reaches the degree 1, so a firing strength of 1 gives the end of the range. For strengths near 1
    // the value may be outside the range.
    assert_eq!(at("sigmoid: {inflection: 5, slope: 1}", 1.0), 10.0);
    assert_eq!(at("sigmoid: {inflection: 5, slope: -1}", 1.0), 0.0);
    assert!(at("sigmoid: {inflection: 5, slope: 1}", 0.9999) > 14.0);
}

#[test]
fn tsukamoto_values_are_weighted_rule_by_rule() {
    let output = "{y: {range: [0, 10], defuzzifier: tsukamoto, terms: {up: {right_shoulder: [2, 8]}, down: {left_shoulder: [1, 5]}}}}";
    let rules = "[IF x IS high THEN y IS up, IF x IS low THEN y IS up WITH 0.5, IF x IS low THEN y IS down]";
    let engine = Engine::new(&model(output, rules)).unwrap();
    for x in [0.1, 0.3, 0.5, 0.77] {
        let weights = [x, 0.5 * (1.0 - x), 1.0 - x];
        let places = [
            2.0 + 6.0 * weights[0],
            2.0 + 6.0 * weights[1],
            5.0 - 4.0 * weights[2],
        ];
        let sum: f64 = weights.iter().zip(places).map(|(w, z)| w * z).sum();
        let expected = sum / weights.iter().sum::<f64>();
        assert!((value(&engine, x) - expected).abs() < 1e-14, "at {x}");
        let explained = engine.explain(&[x]).unwrap();
        let up = explained.outputs[0].rules.iter().find(|r| r.rule == 0);
        assert!((up.unwrap().value.unwrap() - places[0]).abs() < 1e-14);
        assert_eq!(explained.outputs[0].value, Some(value(&engine, x)));
    }
    // A rule counts however weakly it fires, as long as its strength is at least the minimum.
    assert_eq!(value(&engine, 1.0), 8.0);
    let only = Engine::new(&model(output, "[IF x IS high THEN y IS up]")).unwrap();
    assert!((value(&only, 1e-12) - 2.0).abs() < 1e-11);
    assert_eq!(only.evaluate(&[0.9e-12]).unwrap()[0].value(), None);
}

#[test]
fn a_hedge_in_a_conclusion_changes_the_strength_of_that_conclusion() {
    let output = "{y: {range: [0, 10], defuzzifier: weighted_average, terms: {a: {constant: 2}, b: {constant: 8}}}, z: {range: [0, 10], defuzzifier: weighted_sum, terms: {a: {constant: 1}}}}";
    let rules = "[IF x IS high THEN y IS very a AND z IS somewhat very a WITH 0.5, IF x IS low THEN y IS b AND z IS a]";
    let model = model(output, rules);
    assert_eq!(
        model.rules[0].rule.to_string(),
        "IF x IS high THEN y IS very a AND z IS somewhat very a WITH 0.5"
    );
    let again: Model = fuzzy::yaml::to_string(&model).parse().unwrap();
    assert_eq!(again, model);
    let engine = Engine::new(&model).unwrap();
    for x in [0.0_f64, 0.2, 0.6, 1.0] {
        // The weight is applied before the hedges, and the hedge nearest to the term before the other hedges.
        let very = (0.5 * x).powi(2);
        let expected = (very * 2.0 + (1.0 - x) * 8.0) / (very + 1.0 - x);
        assert!((value(&engine, x) - expected).abs() < 1e-14, "at {x}");
        let outcome = engine.evaluate(&[x]).unwrap()[1];
        let expected = very.sqrt() + 1.0 - x;
        assert!((outcome.value().unwrap() - expected).abs() < 1e-14);
        assert!((outcome.coverage - very.sqrt().max(1.0 - x)).abs() < 1e-15);
    }
    let explained = engine.explain(&[0.6]).unwrap();
    let strength = |output: usize| {
        let mut rules = explained.outputs[output].rules.iter();
        rules.find(|share| share.rule == 0).unwrap().strength
    };
    assert_eq!((strength(0), strength(1)), (0.3 * 0.3, 0.3));
}

#[test]
fn batches_have_the_bits_of_single_calls() {
    let output = "{y: {range: [0, 10], defuzzifier: tsukamoto, terms: {up: {sigmoid: {inflection: 3, slope: 2}}, down: {z_shape: [1, 5]}}}, z: {range: [0, 10], partition: [small, large]}}";
    let rules = "[IF x IS high THEN y IS very up AND z IS seldom small, IF x IS low THEN y IS down AND z IS extremely large WITH 0.7]";
    let engine = Engine::new(&model(output, rules)).unwrap();
    let points: Vec<f64> = (0..=100).map(|i| f64::from(i) / 100.0).collect();
    let outcomes = engine.evaluate_batch(&[&points]).unwrap();
    for (x, batch) in points.iter().zip(outcomes.chunks(2)) {
        assert_eq!(engine.evaluate(&[*x]).unwrap()[..], *batch, "at {x}");
    }
}

#[test]
fn a_formula_gives_a_number_to_a_takagi_sugeno_output() {
    let outputs = "{y: {range: [0, 10], defuzzifier: weighted_average, terms: {a: {function: 2 * x^2 + 1}, b: {linear: {x: 3}}, c: {function: sqrt(x - 0.5)}}}, z: {range: [-10, 10], defuzzifier: weighted_sum, terms: {a: {function: sin(y) - x * y}}}}";
    let rules = "[IF x IS high THEN y IS a AND z IS a, IF x IS low THEN y IS b WITH 0.5]";
    let model = model(outputs, rules);
    assert_eq!(model.reads("z"), ["y"]);
    let text = fuzzy::yaml::to_string(&model);
    assert!(text.contains(r#"function: "2 * x^2 + 1""#), "{text}");
    assert_eq!(text.parse::<Model>().unwrap(), model);
    let engine = Engine::new(&model).unwrap();
    for x in [0.0_f64, 0.25, 0.6, 1.0] {
        let (w, v) = (x, 0.5 * (1.0 - x));
        let y = (w * (2.0 * x * x + 1.0) + v * 3.0 * x) / (w + v);
        assert!((value(&engine, x) - y).abs() < 1e-15, "at {x}");
        let outcome = engine.evaluate(&[x]).unwrap()[1];
        let z = w * (y.sin() - x * y);
        // If no rule fires, there is no value.
        match outcome.value() {
            Some(found) => assert!((found - z).abs() < 1e-15, "at {x}: {found} {z}"),
            None => assert_eq!(x, 0.0),
        }
    }
    let explained = engine.explain(&[0.6]).unwrap();
    let first = explained.outputs[0].rules.iter().find(|r| r.rule == 0);
    assert_eq!(first.unwrap().value, Some(2.0 * 0.6 * 0.6 + 1.0));
    let second = explained.outputs[1].rules[0].value.unwrap();
    let y = value(&engine, 0.6);
    assert!((second - (y.sin() - 0.6 * y)).abs() < 1e-15);
}

#[test]
fn where_a_formula_has_no_value_neither_has_the_output() {
    let output = "{y: {range: [0, 10], defuzzifier: weighted_average, terms: {a: {function: sqrt(x - 0.5)}, b: {constant: 4}}}}";
    let rules = "[IF x IS high THEN y IS a, IF x IS low THEN y IS b]";
    let engine = Engine::new(&model(output, rules)).unwrap();
    let outcome = engine.evaluate(&[0.25]).unwrap()[0];
    assert_eq!((outcome.value(), outcome.coverage), (None, 0.75));
    // The formula of a rule that does not fire is not evaluated.
    assert_eq!(value(&engine, 0.0), 4.0);
    assert_eq!(value(&engine, 1.0), 0.5_f64.sqrt());
    let explained = engine.explain(&[0.25]).unwrap();
    assert_eq!(explained.outputs[0].value, None);
}

#[test]
fn a_formula_is_a_fuzzy_set_over_its_variable() {
    let text = "
fuzzy: 1
name: t
inputs:
  x: {range: [0, 10], terms: {low: {function: 1 - x / 4}, high: {function: exp(-(x - 8)^2 / 2), height: 0.9}}}
outputs:
  y: {range: [0, 6], terms: {a: {function: y * (6 - y) / 9}, b: {function: y > 2 and y < 3}}}
rules: [IF x IS very low THEN y IS a, IF x IS high THEN y IS b]
";
    let model: Model = text.parse().unwrap();
    assert_eq!(
        fuzzy::yaml::to_string(&model).parse::<Model>().unwrap(),
        model
    );
    let engine = Engine::new(&model).unwrap();
    // The values are the axes of symmetry of the terms: 3 for the parabola, and 2.5 for the step from 2 to 3. Formulas
    // are clamped to [0, 1], so the results are degrees.
    let low = engine.evaluate(&[1.0]).unwrap()[0];
    assert!((low.value().unwrap() - 3.0).abs() < 1e-12);
    assert_eq!(low.coverage, 0.75 * 0.75);
    let high = engine.evaluate(&[7.0]).unwrap()[0];
    assert!((high.value().unwrap() - 2.5).abs() < 1e-9, "{high:?}");
    assert!((high.coverage - 0.9 * (-0.5_f64).exp()).abs() < 1e-15);
    let terms = &engine.explain(&[5.0]).unwrap().inputs[0].terms;
    assert_eq!(terms[0].degree, 0.0);
    // The term y^2 / 36 is asymmetric; by its integrals, the centroid over [0, 6] is 4.5. Scaling does not move it.
    let text = text.replace("y * (6 - y) / 9", "y^2 / 36");
    let text = text.replace("rules:", "operators: {implication: product}\nrules:");
    let engine = Engine::new(&text.parse().unwrap()).unwrap();
    let found = engine.evaluate(&[1.0]).unwrap()[0].value().unwrap();
    assert!((found - 4.5).abs() < 1e-12, "{found}");
}

#[test]
fn an_output_of_singletons_has_a_few_positions() {
    let of = |defuzzifier: &str, operators: &str, x: f64| {
        let text = format!(
            "{{fuzzy: 1, name: t, inputs: {{x: {{range: [0, 1], partition: [low, high]}}}}, outputs: {{y: {{range: [0, 10], defuzzifier: {defuzzifier}, terms: {{a: {{singleton: 2}}, b: {{singleton: 8}}, c: {{singleton: 9, height: 0.5}}, d: {{singleton: 2}}}}}}}}, operators: {{{operators}}}, rules: [IF x IS low THEN y IS a, IF x IS high THEN y IS b, IF x IS high THEN y IS c, IF x IS high THEN y IS d WITH 0.5]}}"
        );
        let engine = Engine::new(&text.parse().unwrap()).unwrap();
        let explained = engine.explain(&[x]).unwrap();
        let found = engine.evaluate(&[x]).unwrap()[0].value().unwrap();
        assert_eq!(explained.outputs[0].value, Some(found));
        let shares: f64 = explained.outputs[0].rules.iter().map(|r| r.share).sum();
        assert!((shares - 1.0).abs() < 1e-12);
        found
    };
    let near = |found: f64, expected: f64| {
        assert!(
            (found - expected).abs() < 1e-14,
            "{found} is not {expected}"
        );
    };
    // At 0.7 the strengths are 0.3, 0.7, 0.7 and 0.35; the first and the last rule conclude the same value.
    near(
        of("centroid", "aggregation: maximum", 0.7),
        (2.0 * 0.35 + 8.0 * 0.7 + 9.0 * 0.5) / (0.35 + 0.7 + 0.5),
    );
    near(
        of("centroid", "implication: product, aggregation: sum", 0.7),
        (2.0 * 0.65 + 8.0 * 0.7 + 9.0 * 0.35) / (0.65 + 0.7 + 0.35),
    );
    let either = 0.3 + 0.35 - 0.3 * 0.35;
    near(
        of("centroid", "aggregation: probabilistic_sum", 0.7),
        (2.0 * either + 8.0 * 0.7 + 9.0 * 0.5) / (either + 0.7 + 0.5),
    );
    for (x, least, mean, most) in [(0.7, 8.0, 8.0, 8.0), (0.5, 2.0, 19.0 / 3.0, 9.0)] {
        near(of("smallest_of_maxima", "", x), least);
        near(of("mean_of_maxima", "", x), mean);
        near(of("largest_of_maxima", "", x), most);
    }
}
