//! Rule blocks, activation methods, the least strength, and sequences.

use alloc::{format, string::String, vec, vec::Vec};

use proptest::{prelude::*, sample::select};

use super::{Engine, Outcome, Sequence, State};
use crate::model::{Activation, Block, Comparison, Conjunction, Disjunction, Model, Rule};
use crate::yaml;

fn model(text: &str) -> Model {
    yaml::parse(&format!("fuzzy: 1\nname: t\n{text}"))
        .unwrap()
        .model
}

fn engine(text: &str) -> Engine {
    Engine::new(&model(text)).unwrap()
}

/// Returns the weighted sum of four rules whose firing strengths equal their weights and whose values are 1, 2, 3 and
/// 4. The sum shows which of the rules fire.
fn weighted_sum(activation: &str) -> f64 {
    let text = format!(
        "inputs: {{x: {{range: [0, 1], partition: [a, b]}}}}
outputs: {{y: {{range: [0, 9], defuzzifier: weighted_sum, when_no_rule_fires: {{value: 9}},
  terms: {{one: {{constant: 1}}, two: {{constant: 2}}, three: {{constant: 3}}, four: {{constant: 4}}}}}}}}
activation: {activation}
rules:
  - IF x IS any THEN y IS one WITH 0.25
  - IF x IS any THEN y IS two WITH 0.75
  - IF x IS any THEN y IS three WITH 0.5
  - IF x IS any THEN y IS four WITH 0.75
"
    );
    engine(&text).evaluate(&[0.3]).unwrap()[0].value().unwrap()
}

#[test]
fn activation_methods_have_values_computed_by_hand() {
    for (activation, sum) in [
        ("general", 0.25 + 1.5 + 1.5 + 3.0),
        ("{first: 1}", 0.25),
        ("{first: {rules: 1, at_least: 0.3}}", 1.5),
        ("{last: 2}", 1.5 + 3.0),
        ("{highest: 1}", 1.5),
        ("{highest: 3}", 1.5 + 1.5 + 3.0),
        ("{lowest: 2}", 0.25 + 1.5),
        ("proportional", (0.25 + 1.5 + 1.5 + 3.0) / 2.25),
        ("{threshold: {above: 0.5}}", 1.5 + 3.0),
        ("{threshold: {at_most: 0.5}}", 0.25 + 1.5),
        ("{threshold: {above: 0.75}}", 9.0),
    ] {
        let found = weighted_sum(activation);
        assert!((found - sum).abs() < 1e-15, "{activation}: {found}");
    }
}

const BLOCKS: &str = "
inputs: {x: {range: [0, 1], partition: [a, b]}, y: {range: [0, 1], partition: [a, b]}}
outputs:
  u: {range: [0, 9], partition: [low, high], aggregation: sum}
  v: {range: [0, 9], terms: {one: {constant: 1}, two: {constant: 2}}, defuzzifier: weighted_average}
blocks:
  first:
    operators: {and: product, implication: product}
    rules: [IF x IS a AND y IS a THEN u IS low, IF x IS b AND y IS b THEN u IS high]
  second:
    activation: {highest: 1}
    rules: [IF x IS a AND y IS a THEN v IS one, IF x IS b OR y IS b THEN v IS two]
  third:
    enabled: false
    rules: [IF x IS any THEN u IS low AND v IS one]
";

#[test]
fn blocks_have_their_own_operators() {
    let engine = engine(BLOCKS);
    let outcomes = engine.evaluate(&[0.25, 0.5]).unwrap();
    // The strengths are 0.75 * 0.5 and 0.25 * 0.5. The areas scale with them; the shoulders have an area of 4.5 and
    // centroids at 3 and 6.
    let expected = (0.375 * 3.0 + 0.125 * 6.0) / 0.5;
    assert!((outcomes[0].value().unwrap() - expected).abs() < 1e-12);
    assert_eq!(
        (outcomes[0].coverage, outcomes[0].dominant_rule),
        (0.375, Some(0))
    );
    // Both rules have the strength 0.5. Of rules with equal strength, the first one is dominant.
    assert_eq!(outcomes[1].state, State::Defined(1.0));
    assert_eq!(outcomes[1].dominant_rule, Some(2));
    let explained = engine.explain(&[0.25, 0.5]).unwrap();
    let fired: Vec<(usize, f64)> = explained
        .rules
        .iter()
        .map(|r| (r.rule, r.strength))
        .collect();
    assert_eq!(fired, [(2, 0.5), (0, 0.375), (1, 0.125)]);
}

#[test]
fn rules_without_methods_use_tables() {
    let mut plain = model(BLOCKS);
    plain.blocks.truncate(1);
    plain.rules.retain(|rule| rule.block == 0);
    let engine = Engine::new(&plain).unwrap();
    assert!(engine.table().unwrap().blocks.is_empty());
    assert!(engine.table().unwrap().programs.is_empty());
}

#[test]
fn rounding_fires_no_rule() {
    for and in ["nilpotent_minimum", "bounded_difference", "drastic"] {
        let text = format!(
            "inputs: {{x: {{range: [0, 1], partition: [a, b]}}}}
outputs: {{y: {{range: [0, 1], partition: [low, high]}}}}
operators: {{and: {and}}}
rules: [IF x IS a AND x IS not a THEN y IS low, IF x IS a AND x IS b THEN y IS high]
"
        );
        let engine = engine(&text);
        for i in 0..1000 {
            let outcome = engine.evaluate(&[f64::from(i) / 999.0]).unwrap()[0];
            assert_eq!(outcome, Outcome::UNDEFINED, "{and} at {i}");
        }
    }
    let text = "inputs: {x: {range: [0, 1], partition: [a, b]}}
outputs: {y: {range: [0, 1], partition: [low, high]}}
operators: {or: nilpotent_maximum}
rules: [IF x IS a OR x IS not a THEN y IS low]
";
    let engine = engine(text);
    for i in 0..1000 {
        assert_eq!(
            engine.evaluate(&[f64::from(i) / 999.0]).unwrap()[0].coverage,
            1.0
        );
    }
}

#[test]
fn a_strength_below_the_minimum_does_not_fire() {
    let text = |least: f64| {
        format!(
            "inputs: {{x: {{range: [0, 1], terms: {{up: {{right_shoulder: [0, 1]}}}}}}}}
outputs: {{y: {{range: [0, 1], partition: [low, high]}}}}
least_strength: {least}
rules: [IF x IS up THEN y IS low]
"
        )
    };
    let fires = |least: f64, x: f64| {
        let engine = engine(&text(least));
        let one = engine.evaluate(&[x]).unwrap()[0];
        let batch = engine.evaluate_batch(&[&[x; 9]]).unwrap();
        assert_eq!(batch, vec![one; 9]);
        assert_eq!(
            engine.explain(&[x]).unwrap().rules.is_empty(),
            one.dominant_rule.is_none()
        );
        let raising = engine.raised_by(&mut engine.scratch(), &[x], 0, 0.5);
        assert_eq!(raising, one.dominant_rule);
        one.coverage == x && one.dominant_rule == Some(0)
    };
    assert!(fires(1e-12, 1e-12) && !fires(1e-12, 0.999e-12));
    assert!(fires(1e-6, 1e-6) && !fires(1e-6, 0.999e-6));
}

#[test]
fn a_sequence_keeps_the_previous_value() {
    let text = "inputs: {x: {range: [0, 9], terms: {low: {left_shoulder: [1, 2]}, high: {right_shoulder: [7, 8]}}}}
outputs:
  kept: {range: [0, 9], partition: [low, high], when_no_rule_fires: previous}
  begun: {range: [0, 9], partition: [low, high], when_no_rule_fires: {previous: 4}}
  reads: {range: [0, 99], terms: {ten: {linear: {kept: 10, constant: 0}}}, defuzzifier: weighted_average}
rules:
  - IF x IS low THEN kept IS low AND begun IS low
  - IF x IS high THEN kept IS high AND begun IS high
  - IF kept IS any THEN reads IS ten
";
    let engine = engine(text);
    assert!(engine.model().keeps_previous());
    let mut rows = Sequence::new(&engine);
    let mut states = |x: f64| -> Vec<State> {
        let outcomes = rows.evaluate(&[x]).unwrap();
        outcomes.iter().map(|outcome| outcome.state).collect()
    };
    let none = State::NoRuleFired;
    assert_eq!(states(5.0), [none, State::Default(4.0), none]);
    assert_eq!(
        states(9.0),
        [
            State::Defined(6.0),
            State::Defined(6.0),
            State::Defined(60.0)
        ]
    );
    let kept = [
        State::Previous(6.0),
        State::Previous(6.0),
        State::Defined(60.0),
    ];
    assert_eq!(states(5.0), kept);
    assert_eq!(states(f64::NAN), [State::InputNotFinite; 3]);
    assert_eq!(states(4.0), kept);
    assert_eq!(states(0.0)[0], State::Defined(3.0));
    rows.reset();
    assert_eq!(rows.evaluate(&[5.0]).unwrap()[0].state, none);
    // The engine does not store previous values.
    assert_eq!(
        engine.evaluate(&[5.0]).unwrap()[1].state,
        State::Default(4.0)
    );
}

#[test]
fn a_weighted_output_is_clamped_where_the_author_says_so() {
    let text = |clamp: &str| {
        format!(
            "inputs: {{x: {{range: [0, 9], terms: {{}}}}}}
outputs: {{y: {{range: [0, 5], terms: {{same: {{linear: {{x: 1, constant: 0}}}}}}, defuzzifier: weighted_average{clamp}}}}}
rules: [IF x IS any THEN y IS same]
"
        )
    };
    let at_7 = |clamp: &str| engine(&text(clamp)).evaluate(&[7.0]).unwrap()[0].value();
    assert_eq!((at_7(""), at_7(", clamp: true")), (Some(7.0), Some(5.0)));
}

/// An activation method selects among all rules of its block, including the rules of an output in another stage.
#[test]
fn a_method_sees_all_rules_of_its_block() {
    let text = "inputs: {x: {range: [0, 1], partition: [a, b]}}
outputs:
  d: {range: [0, 1], partition: [low, high]}
  u: {range: [0, 9], terms: {one: {constant: 1}}, defuzzifier: weighted_average}
  v: {range: [0, 9], terms: {two: {constant: 2}}, defuzzifier: weighted_average}
blocks:
  chain: {rules: [IF x IS b THEN d IS high, IF x IS a THEN d IS low]}
  choice:
    activation: {highest: 1}
    rules: [IF d IS low THEN u IS one, IF x IS b THEN v IS two]
";
    let engine = engine(text);
    assert_eq!(engine.model().reads("v"), ["d"]);
    for x in [0.0, 0.2, 0.4, 0.6, 0.8, 1.0] {
        let outcomes = engine.evaluate(&[x]).unwrap();
        let fires = [outcomes[1].value().is_some(), outcomes[2].value().is_some()];
        assert_ne!(fires[0], fires[1], "at {x}");
        let explained = engine.explain(&[x]).unwrap();
        let chosen = explained.rules.iter().filter(|rule| rule.rule >= 2);
        assert_eq!(chosen.count(), 1, "at {x}");
    }
    let circle = text.replace("IF x IS b THEN d", "IF u IS any AND x IS b THEN d");
    let findings = yaml::parse(&format!("fuzzy: 1\nname: t\n{circle}")).unwrap_err();
    assert!(
        findings
            .0
            .iter()
            .any(|finding| finding.code == "circular-outputs")
    );
}

fn activation() -> impl Strategy<Value = Activation> {
    let strength = select(vec![0.0, 0.1, 0.25, 0.5]);
    let comparison = select(vec![
        Comparison::Below,
        Comparison::AtMost,
        Comparison::AtLeast,
        Comparison::Above,
    ]);
    (0..7u8, 1..4u32, strength, comparison).prop_map(|(method, rules, strength, comparison)| {
        let at_least = strength;
        match method {
            0 => Activation::General,
            1 => Activation::First { rules, at_least },
            2 => Activation::Last { rules, at_least },
            3 => Activation::Highest { rules },
            4 => Activation::Lowest { rules },
            5 => Activation::Proportional,
            _ => Activation::Threshold {
                comparison,
                strength,
            },
        }
    })
}

/// Generates models with two blocks over two inputs and two outputs, with rules that contain AND, OR and NOT.
fn any_blocks() -> impl Strategy<Value = Model> {
    let and = select(Conjunction::ALL.to_vec());
    let or = select(Disjunction::ALL.to_vec());
    let block = (and, or, activation(), any::<bool>());
    let rule = (0..5usize, 0..4usize, 1..=4u32, 0..4usize);
    (
        prop::collection::vec(block, 2),
        prop::collection::vec(rule, 2..9),
    )
        .prop_map(|(blocks, rules)| {
            let mut built = model(BLOCKS);
            let blocks = blocks.into_iter().zip(["one", "two"]);
            built.blocks = blocks
                .map(|((and, or, activation, enabled), name)| Block {
                    and,
                    or,
                    activation,
                    enabled: enabled || name == "one",
                    ..Block::new(name)
                })
                .collect();
            let half = rules.len() / 2;
            let written = rules.into_iter().enumerate();
            built.rules = written
                .map(|(i, (condition, terms, weight, conclusion))| {
                    let (p, q) = (["a", "b"][terms % 2], ["a", "b"][terms / 2]);
                    let condition = [
                        format!("x IS {p} AND y IS {q}"),
                        format!("x IS {p} OR y IS {q}"),
                        format!("x IS NOT {p}"),
                        format!("(x IS {p} OR y IS {q}) AND x IS somewhat a"),
                        format!("y IS {q}"),
                    ][condition]
                        .clone();
                    let conclusion =
                        ["u IS low", "u IS high", "v IS one", "u IS low AND v IS two"][conclusion];
                    let weight = f64::from(weight) / 4.0;
                    let text = format!("IF {condition} THEN {conclusion} WITH {weight}");
                    Rule {
                        block: usize::from(i >= half),
                        ..Rule::from(text.parse::<crate::rule::Rule>().unwrap())
                    }
                })
                .collect();
            built
        })
}

proptest! {
    /// Explanations compute the strengths a second time, from the syntax tree of each rule.
    #[test]
    fn all_paths_agree(built in any_blocks(), points in prop::collection::vec((0.0..=1.0f64, 0.0..=1.0f64), 9)) {
        let engine = Engine::new(&built).unwrap();
        let (x, y): (Vec<f64>, Vec<f64>) = points.iter().copied().unzip();
        let batch = engine.evaluate_batch(&[&x, &y]).unwrap();
        let mut rows = Sequence::new(&engine);
        for ((x, y), batch) in points.into_iter().zip(batch.chunks(2)) {
            let outcomes = engine.evaluate(&[x, y]).unwrap();
            prop_assert_eq!(&outcomes[..], batch);
            prop_assert_eq!(&outcomes[..], rows.evaluate(&[x, y]).unwrap());
            let explained = engine.explain(&[x, y]).unwrap();
            for (outcome, output) in outcomes.iter().zip(&explained.outputs) {
                let strongest = output.rules.iter().map(|rule| rule.strength).fold(0.0, f64::max);
                prop_assert_eq!(outcome.coverage, strongest, "{:?}", yaml::to_string(&built));
                prop_assert_eq!(outcome.value().is_some(), !output.rules.is_empty());
            }
        }
    }

    /// A model that is written and parsed again equals the original.
    #[test]
    fn written_blocks_read_back(built in any_blocks()) {
        let text: String = yaml::to_string(&built);
        let again = yaml::parse(&text).unwrap().model;
        prop_assert_eq!(&again, &built, "{}", text);
    }
}
