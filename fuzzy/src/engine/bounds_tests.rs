use super::*;
use crate::engine::Engine;
use crate::model::{Implication, Operators, Variable};
use crate::rule;

const TIPPER: &str = "
fuzzy: 1
name: tipper
inputs:
  food:
    range: [0, 10]
    terms:
      bad: {upper: {left_shoulder: [2, 6]}, lower: {left_shoulder: [0, 4], height: 0.8}}
      good: {upper: {right_shoulder: [4, 8]}, lower: {right_shoulder: [6, 10]}}
outputs:
  tip:
    range: [0, 30]
    terms:
      small: {upper: {triangle: [0, 6, 18]}, lower: {triangle: [3, 6, 12], height: 0.9}}
      large: {upper: {triangle: [12, 24, 30]}, lower: {triangle: [18, 24, 27], height: 0.9}}
rules:
  - IF food IS bad THEN tip IS small
  - IF food IS NOT bad THEN tip IS large
";

fn interval(engine: &Engine, inputs: &[f64]) -> (f64, f64) {
    let outcome = engine.evaluate(inputs).unwrap()[0];
    (outcome.low().unwrap(), outcome.high().unwrap())
}

/// Returns the interval of centroids, computed by bisection with sums over samples.
fn sampled(range: (f64, f64), bounds: impl Fn(f64) -> (f64, f64)) -> (f64, f64) {
    const SAMPLES: usize = 200_000;
    let step = (range.1 - range.0) / SAMPLES as f64;
    let samples: Vec<(f64, f64, f64)> = (0..SAMPLES)
        .map(|i| {
            let x = range.0 + (i as f64 + 0.5) * step;
            let (lower, upper) = bounds(x);
            (x, lower, upper)
        })
        .collect();
    let end = |is_left: bool| {
        let (mut a, mut b) = range;
        for _ in 0..60 {
            let c = 0.5 * (a + b);
            let moment: f64 = samples
                .iter()
                .map(|&(x, lower, upper)| (x - c) * if (x < c) == is_left { upper } else { lower })
                .sum();
            if moment > 0.0 {
                a = c;
            } else {
                b = c;
            }
        }
        a
    };
    (end(true), end(false))
}

#[test]
fn a_centroid_is_that_of_many_samples() {
    let model: Model = TIPPER.parse().unwrap();
    for implication in [Implication::Minimum, Implication::Product] {
        let mut model = model.clone();
        model.operators.implication = implication;
        let engine = Engine::new(&model).unwrap();
        for food in [0.0, 1.5, 3.0, 4.5, 5.0, 7.0, 10.0] {
            let degree = |x: f64, bound: Bound| {
                let [small, large] =
                    [0, 1].map(|i| model.outputs[0].variable.terms[i].bound(bound, x));
                let bad = |bound| model.inputs[0].terms[0].bound(bound, food);
                let first = implication.of(bad(bound), small);
                let second = implication.of(1.0 - bad(bound.opposite()), large);
                first.max(second)
            };
            let expected = sampled((0.0, 30.0), |x| {
                (degree(x, Bound::Lower), degree(x, Bound::Upper))
            });
            let (low, high) = interval(&engine, &[food]);
            assert!(
                (low - expected.0).abs() < 1e-6,
                "{food}: {low} {expected:?}"
            );
            assert!(
                (high - expected.1).abs() < 1e-6,
                "{food}: {high} {expected:?}"
            );
            let value = engine.evaluate(&[food]).unwrap()[0].value().unwrap();
            assert_eq!(value, low + 0.5 * (high - low));
        }
    }
}

#[test]
fn equal_bounds_give_the_ordinary_value() {
    let mut model: Model = TIPPER.parse().unwrap();
    let outputs = model.outputs.iter_mut().map(|output| &mut output.variable);
    for term in model
        .inputs
        .iter_mut()
        .chain(outputs)
        .flat_map(|v| &mut v.terms)
    {
        let lower = term.lower.as_mut().unwrap();
        lower.membership_function = term.membership_function.clone();
        lower.height = term.height;
    }
    let mut ordinary = model.clone();
    let outputs = ordinary
        .outputs
        .iter_mut()
        .map(|output| &mut output.variable);
    for term in ordinary
        .inputs
        .iter_mut()
        .chain(outputs)
        .flat_map(|v| &mut v.terms)
    {
        term.lower = None;
    }
    let (engine, ordinary) = (
        Engine::new(&model).unwrap(),
        Engine::new(&ordinary).unwrap(),
    );
    for i in 0..=100 {
        let food = f64::from(i) / 10.0;
        let value = ordinary.evaluate(&[food]).unwrap()[0].value().unwrap();
        let (low, high) = interval(&engine, &[food]);
        assert!(
            (low - value).abs() < 1e-13 && (high - value).abs() < 1e-13,
            "{food}"
        );
    }
}

#[test]
fn weighted_numbers_equal_values_computed_by_hand() {
    let text = "
fuzzy: 1
name: fan
inputs:
  heat:
    range: [0, 10]
    terms:
      low: {upper: {constant: 0.75}, lower: {constant: 0.25}}
      high: {upper: {constant: 0.75}, lower: {constant: 0.25}}
outputs:
  speed: {range: [0, 100], terms: {slow: {constant: 0}, fast: {linear: {heat: 10}}}, defuzzifier: weighted_average}
  sum: {range: [0, 100], terms: {one: {constant: -8}, two: {constant: 4}}, defuzzifier: weighted_sum}
  crisp: {range: [0, 100], terms: {one: {constant: 8}}, defuzzifier: weighted_sum}
rules:
  - IF heat IS low THEN speed IS slow
  - IF heat IS high THEN speed IS fast WITH 0.5
  - IF heat IS low THEN sum IS one
  - IF heat IS NOT high THEN sum IS two
  - IF heat IS any THEN crisp IS one
";
    let engine = Engine::new(&text.parse().unwrap()).unwrap();
    let outcomes = engine.evaluate(&[10.0]).unwrap();
    // The weights are in [0.25, 0.75] and [0.125, 0.375].
    let State::Interval { low, high } = outcomes[0].state else {
        panic!()
    };
    assert!((low - 12.5 / 0.875).abs() < 1e-13 && (high - 37.5 / 0.625).abs() < 1e-13);
    let (low, high) = (-8.0 * 0.75 + 4.0 * 0.25, -8.0 * 0.25 + 4.0 * 0.75);
    assert_eq!(outcomes[1].state, State::Interval { low, high });
    // An output that no type-2 term affects has an ordinary value.
    assert_eq!(outcomes[2].state, State::Defined(8.0));
    assert_eq!(
        (outcomes[0].coverage, outcomes[0].dominant_rule),
        (0.75, Some(0))
    );
}

#[test]
fn an_empty_lower_set_gives_the_support() {
    let mut model: Model = TIPPER.parse().unwrap();
    model.rules.truncate(1);
    let engine = Engine::new(&model).unwrap();
    // Between 4 and 6, only the upper degree of `bad` is above 0.
    assert_eq!(interval(&engine, &[5.0]), (0.0, 18.0));
    assert_eq!(
        engine.evaluate(&[6.0]).unwrap()[0].state,
        State::NoRuleFired
    );
}

#[test]
fn batches_sequences_and_clones_give_the_outcomes_of_single_calls() {
    let engine = Engine::new(&TIPPER.parse().unwrap()).unwrap();
    let foods: Vec<f64> = (0..200).map(|i| f64::from(i) * 0.07 - 2.0).collect();
    let outcomes = engine.evaluate_batch(&[&foods]).unwrap();
    let mut values = alloc::vec![0.0; foods.len()];
    engine
        .evaluate_columns(&[&foods], &mut [&mut values])
        .unwrap();
    let mut scratch = engine.scratch();
    let mut sequence = crate::engine::Sequence::new(&engine);
    for ((food, outcome), value) in foods.iter().zip(&outcomes).zip(&values) {
        assert_eq!(engine.evaluate(&[*food]).unwrap()[0], *outcome);
        assert_eq!(Some(*value), outcome.value());
        let mut again = [Outcome::default()];
        scratch = scratch.clone();
        engine
            .evaluate_with(&mut scratch, &[*food], &mut again)
            .unwrap();
        assert_eq!(again[0], *outcome);
        assert_eq!(sequence.evaluate(&[*food]).unwrap()[0], *outcome);
    }
}

#[test]
fn a_name_that_looks_like_a_lower_term_is_not_confused() {
    let model = Model::builder("names")
        .input(
            Variable::new("x", 0.0, 1.0)
                .interval_term(
                    "a",
                    MembershipFunction::Constant { value: 0.8 },
                    MembershipFunction::Constant { value: 0.4 },
                )
                .term("lower a", MembershipFunction::Constant { value: 0.1 }),
        )
        .output(
            Output::new(
                Variable::new("y", 0.0, 9.0)
                    .term("one", MembershipFunction::Constant { value: 1.0 }),
            )
            .defuzzifier(Defuzzifier::WeightedSum),
        )
        .operators(Operators::default())
        .rule(rule::parse("IF x IS a THEN y IS one").unwrap())
        .rule(rule::parse("IF x IS \"lower a\" THEN y IS one").unwrap())
        .build();
    let (low, high) = interval(&Engine::new(&model).unwrap(), &[0.5]);
    assert!((low - 0.5).abs() < 1e-15 && (high - 0.9).abs() < 1e-15);
}

#[test]
fn a_chain_passes_on_the_middle_of_an_interval() {
    let rules = |first: &str, second: &str| {
        format!(
            "
fuzzy: 1
name: chain
inputs:
  food: {{range: [0, 10], terms: {{bad: {{upper: {{left_shoulder: [2, 6]}}, lower: {{left_shoulder: [0, 4]}}}}, good: {{right_shoulder: [4, 8]}}}}}}{first}
outputs:
{second}
"
        )
    };
    let mood = "{range: [0, 1], terms: {low: {upper: {left_shoulder: [0.2, 0.8]}, lower: {left_shoulder: [0.1, 0.6]}}, high: {right_shoulder: [0.3, 0.9]}}}";
    let tip = "  tip: {range: [0, 30], terms: {small: {triangle: [0, 6, 18]}, large: {triangle: [12, 24, 30]}}}\n";
    let of_mood = "  - IF food IS bad THEN mood IS low\n  - IF food IS NOT bad THEN mood IS high\n";
    let of_tip = "  - IF mood IS low THEN tip IS small\n  - IF mood IS NOT low AND food IS good THEN tip IS large\n";
    let chain = rules(
        "",
        &format!("  mood: {mood}\n{tip}rules:\n{of_mood}{of_tip}"),
    );
    let first = rules("", &format!("  mood: {mood}\nrules:\n{of_mood}"));
    let second = rules(
        &format!("\n  mood: {mood}"),
        &format!("{tip}rules:\n{of_tip}"),
    );
    let [chain, first, second] =
        [chain, first, second].map(|text| Engine::new(&text.parse().unwrap()).unwrap());
    assert!(chain.table().is_none() && chain.chain().is_some());
    for food in [0.0, 2.5, 4.5, 5.5, 7.0, 10.0] {
        let outcomes = chain.evaluate(&[food]).unwrap();
        let mood = first.evaluate(&[food]).unwrap()[0];
        assert_eq!(outcomes[0], mood);
        let tip = second.evaluate(&[food, mood.value().unwrap()]).unwrap()[0];
        assert_eq!(outcomes[1].state, tip.state, "{food}");
        assert!(matches!(tip.state, State::Interval { .. }));
        // An explanation contains the same ends, and the bounds of the strengths.
        let explanation = chain.explain(&[food]).unwrap();
        assert_eq!(explanation.outputs[1].low, outcomes[1].low());
        for rule in &explanation.rules {
            assert!(
                rule.lower.is_some_and(|lower| lower <= rule.strength),
                "{rule:?}"
            );
        }
    }
}

#[test]
fn blocks_have_their_own_operators() {
    let text = |blocks: &str| {
        format!(
            "
fuzzy: 1
name: blocks
inputs:
  x: {{range: [0, 1], terms: {{a: {{upper: {{constant: 0.8}}, lower: {{constant: 0.5}}}}}}}}
  y: {{range: [0, 1], terms: {{b: {{upper: {{constant: 0.5}}, lower: {{constant: 0.4}}}}}}}}
outputs: {{z: {{range: [0, 9], terms: {{one: {{constant: 1}}, two: {{constant: 10}}}}, defuzzifier: weighted_sum}}}}
{blocks}"
        )
    };
    let engine = |blocks: &str| Engine::new(&text(blocks).parse().unwrap()).unwrap();
    let both = engine(
        "blocks:
  product: {operators: {and: product}, rules: [IF x IS a AND y IS b THEN z IS one]}
  minimum: {rules: [IF x IS NOT a AND y IS b THEN z IS two WITH 0.5]}
  off: {enabled: false, rules: [IF x IS a THEN z IS two]}",
    );
    let (low, high) = interval(&both, &[0.5, 0.5]);
    // The weights are 0.5 * 0.4 to 0.8 * 0.5, and half of min(0.2, 0.4) to min(0.5, 0.5).
    assert!((low - (0.2 + 1.0)).abs() < 1e-14, "{low}");
    assert!((high - (0.4 + 2.5)).abs() < 1e-14, "{high}");
}

#[test]
fn a_written_rule_set_reads_back_as_the_same() {
    let model: Model = TIPPER.parse().unwrap();
    let text = crate::yaml::to_string(&model);
    assert_eq!(text.parse::<Model>().unwrap(), model);
    let json = serde_json::to_string(&model).unwrap();
    assert_eq!(serde_json::from_str::<Model>(&json).unwrap(), model);
    let engine = Engine::new(&model).unwrap();
    let outcome = serde_json::to_value(engine.evaluate(&[5.0]).unwrap()[0]).unwrap();
    let (low, high) = interval(&engine, &[5.0]);
    assert_eq!(
        (&outcome["low"], &outcome["high"]),
        (&low.into(), &high.into())
    );
}
