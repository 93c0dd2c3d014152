//! Written rule sets are read back with the same values.

#![allow(
    clippy::expect_used,
    clippy::panic,
    clippy::print_stdout,
    clippy::unwrap_used,
    reason = "helpers of tests fail by panics, and tell what fails"
)]

use flagred_interchange::{Format, Losses};
use fuzzy::{Engine, Model};

/// Rule sets of this repository that the formats can represent.
const SETS: [(&str, &str); 5] = [
    ("flagred", include_str!("../../../rules/flagred.yaml")),
    (
        "flagred-paper",
        include_str!("../../../rules/flagred-paper.yaml"),
    ),
    ("takagi-sugeno", TAKAGI_SUGENO),
    ("curves", CURVES),
    ("steps", STEPS),
];

const TAKAGI_SUGENO: &str = "
fuzzy: 1
name: tip
inputs:
  service: {range: [0, 10], terms: {poor: {gaussian: {mean: 0, sd: 2}}, good: {gaussian: {mean: 10, sd: 2}}}}
  food: {range: [0, 10], partition: [bad, fair, fine]}
outputs:
  tip:
    range: [0, 30]
    defuzzifier: weighted_average
    terms: {low: {constant: 5}, high: {linear: {service: 1.5, food: -0.25, constant: 8}}}
operators: {and: product, or: probabilistic_sum}
rules:
  - IF service IS poor AND food IS bad THEN tip IS low
  - IF service IS NOT poor OR food IS fine THEN tip IS high WITH 0.5
";

const STEPS: &str = "
fuzzy: 1
name: credit
inputs:
  dti: {range: [0, 100], steps: {fine: 36, stretched: 43, over: }}
  score: {range: [-1, 1], steps: {poor: 0, good: }}
outputs:
  risk: {range: [0, 1], defuzzifier: weighted_average, terms: {low: {constant: 0}, medium: {constant: 0.5}, high: {constant: 1}}}
rules:
  - IF dti IS over OR score IS poor THEN risk IS high
  - IF dti IS fine AND score IS good THEN risk IS low
  - IF dti IS stretched AND score IS good THEN risk IS medium
";

const CURVES: &str = "
fuzzy: 1
name: 'every curve'
inputs:
  'the x':
    range: [0, 10]
    terms:
      low: {z_shape: [0, 5]}
      middle: {pi_shape: [2, 4, 4, 6]}
      high: {s_shape: [5, 10]}
      'very': {trapezoid: [1, 2, 3, 4]}
outputs:
  y:
    range: [0, 100]
    samples: {midpoint: 1000}
    terms:
      low: {left_shoulder: [10, 40]}
      middle: {triangle: [20, 50, 80]}
      high: {piecewise: [[60, 0], [90, 1]]}
rules:
  - IF 'the x' IS low THEN y IS low
  - IF 'the x' IS middle OR 'the x' IS very 'very' THEN y IS middle
  - IF 'the x' IS high THEN y IS high
";

fn same_values(before: &Model, after: &Model, context: &str) {
    let engines = [before, after]
        .map(|model| Engine::new(model).unwrap_or_else(|f| panic!("{context}: {f}")));
    let mut seed = 1_u64;
    for _ in 0..500 {
        let inputs: Vec<f64> = before
            .inputs
            .iter()
            .map(|input| {
                seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                input.low + (input.high - input.low) * (seed >> 11) as f64 / (1_u64 << 53) as f64
            })
            .collect();
        let [before, after] = engines
            .each_ref()
            .map(|engine| engine.evaluate(&inputs).unwrap());
        for (before, after) in before.iter().zip(&after) {
            let difference = match (before.value(), after.value()) {
                (Some(before), Some(after)) => (before - after).abs(),
                (before, after) => panic!("{context}: {inputs:?}: {before:?} {after:?}"),
            };
            assert!(
                difference < 1e-9,
                "{context}: {inputs:?}: {before:?} {after:?}"
            );
        }
    }
}

#[test]
fn written_rule_sets_are_read_again_with_the_same_values() {
    let mut refused = String::new();
    for (name, text) in SETS {
        let model: Model = text
            .parse()
            .unwrap_or_else(|findings| panic!("{name}: {findings}"));
        for format in Format::ALL {
            let context = format!("{name}.{}", format.ending());
            let written = match flagred_interchange::write(&model, format, Losses::Refuse) {
                Ok(written) => written,
                Err(findings) => {
                    refused.push_str(&format!("{context}\n{findings}\n"));
                    continue;
                }
            };
            assert_eq!(Format::of(&written.text), Some(format), "{context}");
            let document = flagred_interchange::read(&written.text, format, Losses::Refuse)
                .unwrap_or_else(|findings| panic!("{context}: {findings}\n{}", written.text));
            let mut again = document.model;
            if format == Format::Fll || model.outputs.iter().any(|output| output.samples.is_some())
            {
                for (before, after) in model.outputs.iter().zip(&mut again.outputs) {
                    after.samples = before.samples;
                }
            }
            same_values(&model, &again, &context);
        }
    }
    insta::assert_snapshot!(refused);
}

#[test]
fn steps_are_exported_as_rectangles_and_read_back_as_steps() {
    let model: Model = STEPS.parse().unwrap();
    for format in Format::ALL {
        let written = flagred_interchange::write(&model, format, Losses::Refuse).unwrap();
        let reported = written.findings.to_string();
        assert!(
            reported.contains("note[steps]: the steps of `dti`"),
            "{reported}"
        );
        let again = flagred_interchange::read(&written.text, format, Losses::Refuse).unwrap();
        let limits = again
            .model
            .inputs
            .iter()
            .map(fuzzy::model::Variable::step_limits);
        assert_eq!(
            limits.collect::<Vec<_>>(),
            [Some(vec![36.0, 43.0]), Some(vec![0.0])]
        );
        // In files of other programs, neighbouring rectangles share a limit.
        let shared = written.text.replace("35.99999999999999", "36");
        let again = flagred_interchange::read(&shared, format, Losses::Refuse).unwrap();
        assert_eq!(again.model.inputs[0].step_limits(), None, "{shared}");
        let reported = again.warnings.to_string();
        assert!(
            reported.contains("`fine` and `stretched` of `dti` both contain 36"),
            "{reported}"
        );
    }
}

/// A rule set with an output that has two terms, `a` and `b`, and one rule for each.
fn with_output(name: &str, output: &str) -> Model {
    let text = format!(
        "fuzzy: 1\nname: {name}\ninputs: {{x: {{range: [0, 1], partition: [low, high]}}}}\n\
         outputs: {{y: {{range: [0, 1], {output}}}}}\n\
         rules: [IF x IS low THEN y IS a, IF x IS high THEN y IS b]\n"
    );
    text.parse().unwrap_or_else(|findings| panic!("{findings}"))
}

const NUMBERS: &str =
    "defuzzifier: weighted_average, terms: {a: {constant: -5}, b: {constant: 20}}";

#[test]
fn an_fcl_keeps_constants_outside_the_range() {
    let model = with_output("outside", NUMBERS);
    let written = flagred_interchange::write(&model, Format::Fcl, Losses::Refuse).unwrap();
    assert!(
        written.text.contains("RANGE := (-5 .. 20);"),
        "{}",
        written.text
    );
    let again = flagred_interchange::read(&written.text, Format::Fcl, Losses::Refuse).unwrap();
    same_values(&model, &again.model, "outside");
}

#[test]
fn names_of_rule_sets_are_written_so_that_they_can_be_read() {
    for name in ["3d", "'my rules'", "var_input", "'1 + 1'", "größe"] {
        let model = with_output(name, NUMBERS);
        let written = flagred_interchange::write(&model, Format::Fcl, Losses::Refuse).unwrap();
        let reported = written.findings.to_string();
        assert!(reported.contains("renamed"), "{name}: {reported}");
        let again = flagred_interchange::read(&written.text, Format::Fcl, Losses::Refuse)
            .unwrap_or_else(|findings| panic!("{findings}\n{}", written.text));
        same_values(&model, &again.model, name);
    }
}

/// A name that the format allows is kept, even if another one before it would be converted to the same name.
#[test]
fn valid_names_are_kept_beside_names_that_change() {
    let text = "fuzzy: 1\nname: names\n\
                inputs: {my temp: {range: [0, 1], partition: [too low, too_low]}, my_temp: {range: [0, 1], partition: [low, high]}}\n\
                outputs: {y: {range: [0, 1], defuzzifier: weighted_average, terms: {low: {constant: 0}, high: {constant: 1}}}}\n\
                rules:\n  - IF 'my temp' IS 'too low' AND my_temp IS low THEN y IS low\n  \
                - IF 'my temp' IS too_low AND my_temp IS high THEN y IS high\n";
    let model: Model = text.parse().unwrap_or_else(|findings| panic!("{findings}"));
    for format in [Format::Fis, Format::Fll, Format::Fcl, Format::Fml] {
        let written = flagred_interchange::write(&model, format, Losses::Accept)
            .unwrap_or_else(|findings| panic!("{findings}"));
        let again = flagred_interchange::read(&written.text, format, Losses::Refuse)
            .unwrap_or_else(|findings| panic!("{findings}\n{}", written.text));
        let [first, second] = &again.model.inputs[..] else {
            panic!("{}", written.text);
        };
        assert_eq!(second.name, "my_temp", "{}", written.text);
        assert_eq!(first.terms[1].name, "too_low", "{}", written.text);
        same_values(&model, &again.model, "names");
    }
}

#[test]
fn features_of_no_format_are_refused_even_where_losses_are_accepted() {
    let tsukamoto =
        "defuzzifier: tsukamoto, terms: {a: {left_shoulder: [0, 1]}, b: {right_shoulder: [0, 1]}}";
    let model = with_output("tsukamoto", tsukamoto);
    let refused = flagred_interchange::write(&model, Format::Fis, Losses::Accept).unwrap_err();
    assert!(refused.to_string().contains("`tsukamoto`"), "{refused}");
    let text = "fuzzy: 1\nname: chain\ninputs: {x: {range: [0, 1], partition: [low, high]}}\n\
                outputs: {y: {range: [0, 1], partition: [low, high]}, \
                z: {range: [0, 1], defuzzifier: weighted_average, terms: {a: {linear: {y: 2, constant: 1}}}}}\n\
                rules: [IF x IS low THEN y IS low, IF x IS high THEN y IS high, IF x IS low THEN z IS a]\n";
    let model: Model = text.parse().unwrap();
    for format in [Format::Fis, Format::Fll, Format::Fml] {
        let refused = flagred_interchange::write(&model, format, Losses::Accept).unwrap_err();
        assert!(!refused.0.is_empty());
        assert!(flagred_interchange::write(&model, format, Losses::Refuse).is_err());
    }
}

#[test]
fn features_with_another_meaning_elsewhere_are_a_loss() {
    let mut model = with_output("weak", NUMBERS);
    model.least_strength = 0.25;
    let text = "fuzzy: 1\nname: chain\ninputs: {x: {range: [0, 1], partition: [low, high]}}\n\
                outputs: {y: {range: [0, 1], partition: [low, high]}, z: {range: [0, 1], partition: [low, high]}}\n\
                rules: [IF x IS low THEN y IS low, IF x IS high THEN y IS high, IF y IS high THEN z IS low]\n";
    let chain: Model = text.parse().unwrap();
    for format in Format::ALL {
        let refused = flagred_interchange::write(&model, format, Losses::Refuse).unwrap_err();
        assert_eq!(refused.0[0].code, "least-strength");
        assert!(flagred_interchange::write(&model, format, Losses::Accept).is_ok());
    }
    let refused = flagred_interchange::write(&chain, Format::Fll, Losses::Refuse).unwrap_err();
    assert!(refused.0.iter().any(|finding| finding.code == "chain"));
}
