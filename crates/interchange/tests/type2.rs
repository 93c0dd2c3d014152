//! Type-2 systems of the IT2-FLS toolbox for MATLAB: values of its files, round trips, and messages.

#![allow(
    clippy::expect_used,
    clippy::panic,
    clippy::print_stdout,
    clippy::unwrap_used,
    reason = "helpers of tests fail by panics, and tell what fails"
)]

use flagred_interchange::{Format, Losses};
use fuzzy::{Engine, Model};

/// The rule set of the toolbox's program `fuzzyt2`, which is the worked example of Wu (A brief tutorial on interval
/// type-2 fuzzy sets and systems). `numbers` are the parameters of its four output terms.
fn toolbox(method: &str, numbers: [&str; 4]) -> String {
    let input = "Range=[-1.5 1.5]
NumMFs=2
MF1U='mf1U':'trapmf',[-4.2 -1.8 -0.5 1.5 1]
MF1L='mf1L':'trimf',[-4.5 -1.5 0.5 1]
MF2U='mf2U':'trapmf',[-1.5 0.5 2 4.1 1]
MF2L='mf2L':'trimf',[-0.5 1.5 4.5 1]
";
    let [a, b, c, d] = numbers;
    format!(
        "[System]
Name='Test'
Type='sugeno'
Version=2.0
NumInputs=2
NumOutputs=1
NumRules=4
AndMethod='prod'
OrMethod='probor'
ImpMethod='prod'
AggMethod='sum'
DefuzzMethod='wtaver'
TypeRedMethod='{method}'

[Input1]
Name='input1'
{input}
[Input2]
Name='input2'
{input}
[Output1]
Name='output1'
Range=[-1 1]
NumMFs=4
MF1='mf1':'constant',[{a}]
MF2='mf2':'constant',[{b}]
MF3='mf3':'constant',[{c}]
MF4='mf4':'constant',[{d}]

[Rules]
1 1, 1 (1) : 1
1 2, 2 (1) : 1
2 1, 3 (1) : 1
2 2, 4 (1) : 1
"
    )
}

const INTERVALS: [&str; 4] = ["-1 -0.9", "-0.6 -0.4", "0.4 0.6", "0.9 1"];
const LOWER: [&str; 4] = ["-1 -1", "-0.6 -0.6", "0.4 0.4", "0.9 0.9"];
const UPPER: [&str; 4] = ["-0.9 -0.9", "-0.4 -0.4", "0.6 0.6", "1 1"];

fn read(text: &str) -> Model {
    let document = flagred_interchange::read(text, Format::Fis, Losses::Refuse);
    let document = document.unwrap_or_else(|findings| panic!("{findings}\n{text}"));
    document.validate(text).unwrap();
    document.model
}

fn evaluate(model: &Model, inputs: &[f64]) -> fuzzy::Outcome {
    Engine::new(model).unwrap().evaluate(inputs).unwrap()[0]
}

/// `fuzzyt2` prints `y = 0.1576` for the inputs 0.1 and 0.5 (issue 10 of the repository
/// ahmettaskin/type-2-fuzzy-logic-systems-matlab-toolbox). The numbers in its rule set are intervals: the left end of
/// the result is computed from their lower ends, the right end from their upper ends.
#[test]
fn a_result_of_the_matlab_toolbox_is_reproduced() {
    let low = evaluate(&read(&toolbox("KM", LOWER)), &[0.1, 0.5]).low();
    let high = evaluate(&read(&toolbox("KM", UPPER)), &[0.1, 0.5]).high();
    let y = 0.5 * (low.unwrap() + high.unwrap());
    assert_eq!(format!("{y:.4}"), "0.1576");
    // By hand: -0.635 / 1.2 and 0.76 / 0.9.
    assert!((low.unwrap() + 0.635 / 1.2).abs() < 1e-15);
    assert!((high.unwrap() - 0.76 / 0.9).abs() < 1e-15);
}

/// Returns the lowest and the highest weighted average over all corners of the four firing intervals.
fn corners(x: [f64; 2], numbers: [f64; 4]) -> (f64, f64) {
    let ramp = |x: f64, foot: f64, top: f64| ((x - foot) / (top - foot)).clamp(0.0, 1.0);
    let upper = |x: f64| [ramp(x, 1.5, -0.5), ramp(x, -1.5, 0.5)];
    let lower = |x: f64| [ramp(x, 0.5, -1.5), ramp(x, -0.5, 1.5)];
    let strength =
        |rule: usize, of: &dyn Fn(f64) -> [f64; 2]| of(x[0])[rule / 2] * of(x[1])[rule % 2];
    let averages = (0..16_usize).filter_map(|corner| {
        let (mut sum, mut total) = (0.0, 0.0);
        for (rule, number) in numbers.iter().enumerate() {
            let weight = match corner >> rule & 1 {
                0 => strength(rule, &lower),
                _ => strength(rule, &upper),
            };
            sum += weight * number;
            total += weight;
        }
        (total > 0.0).then_some(sum / total)
    });
    averages.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), it| {
        (low.min(it), high.max(it))
    })
}

#[test]
fn a_file_has_the_interval_of_all_corners() {
    for word in ["KM", "Karnik-Mendel", "EKM", "IASC", "EIASC", "EODS"] {
        let model = read(&toolbox(word, LOWER));
        for i in 0..=12 {
            for j in 0..=12 {
                let x = [f64::from(i) * 0.25 - 1.5, f64::from(j) * 0.25 - 1.5];
                let outcome = evaluate(&model, &x);
                let (low, high) = corners(x, [-1.0, -0.6, 0.4, 0.9]);
                let near = |one: Option<f64>, other: f64| (one.unwrap() - other).abs() < 1e-12;
                assert!(
                    near(outcome.low(), low) && near(outcome.high(), high),
                    "{word} at {x:?}: {outcome:?}, not {low} to {high}"
                );
            }
        }
    }
}

#[test]
fn methods_of_type_reduction_have_their_formulas() {
    let x = [0.1, 0.5];
    let (lower, upper) = ([0.0, 0.1, 0.0, 0.15], [0.35, 0.7, 0.4, 0.8]);
    let numbers = [-1.0, -0.6, 0.4, 0.9];
    let sums = |weights: [f64; 4]| {
        let terms = weights.iter().zip(numbers);
        (
            terms.map(|(w, y)| w * y).sum::<f64>(),
            weights.iter().sum::<f64>(),
        )
    };
    let ((l, of_lower), (u, of_upper)) = (sums(lower), sums(upper));
    for (word, expected) in [
        ("NT", (l + u) / (of_lower + of_upper)),
        ("BMM(0.5, 0.5)", 0.5 * (l / of_lower + u / of_upper)),
    ] {
        let value = evaluate(&read(&toolbox(word, LOWER)), &x).value().unwrap();
        assert!(
            (value - expected).abs() < 1e-15,
            "{word}: {value}, not {expected}"
        );
    }
}

const TYPE2: &str = "
fuzzy: 1
name: fan
inputs:
  heat:
    range: [0, 40]
    terms:
      low: {upper: {left_shoulder: [10, 20]}, lower: {left_shoulder: [8, 18]}}
      middle: {triangle: [10, 20, 30], lower_scale: 0.8, lower_lag: [0.25, 0.5]}
      high: {upper: {s_shape: [20, 30]}, lower: {s_shape: [22, 33], height: 0.9}}
      'mf1U': {gaussian: {mean: 20, sd: 5}, lower_scale: 0.5}
  damp: {range: [0, 1], terms: {dry: {triangle: [0, 0, 0.7], height: 0.75}, wet: {gaussian: {mean: 1, sd: [0.2, 0.3]}}}}
outputs:
  speed:
    range: [0, 9]
    defuzzifier: weighted_average
    terms: {slow: {constant: 1}, medium: {linear: {heat: 0.1, damp: 2, constant: -1}}, fast: {constant: 8}}
operators: {and: product}
rules:
  - IF heat IS low AND damp IS wet THEN speed IS slow
  - IF heat IS middle AND damp IS dry THEN speed IS medium
  - IF heat IS high AND damp IS dry THEN speed IS fast
  - IF heat IS mf1U AND damp IS wet THEN speed IS fast
";

#[test]
fn type2_rule_sets_are_read_again_with_the_same_intervals() {
    for method in ["exact", "nie_tan", "begian_melek_mendel"] {
        let text = TYPE2.replace(
            "range: [0, 9]",
            &format!("range: [0, 9]\n    type_reduction: {method}"),
        );
        let model: Model = text.parse().unwrap();
        let written = flagred_interchange::write(&model, Format::Fis, Losses::Refuse);
        let written = written.unwrap_or_else(|findings| panic!("{findings}"));
        if method == "exact" {
            insta::assert_snapshot!(written.text);
        }
        let again = read(&written.text);
        assert!(again.has_type2_terms());
        assert_eq!(
            again.outputs[0].type_reduction,
            model.outputs[0].type_reduction
        );
        let names = |model: &Model| {
            let terms = model.inputs.iter().flat_map(|input| &input.terms);
            terms.map(|term| term.name.clone()).collect::<Vec<_>>()
        };
        assert_eq!(names(&again), names(&model));
        for i in 0..=40 {
            for j in 0..=10 {
                let x = [f64::from(i), f64::from(j) * 0.1];
                let (before, after) = (evaluate(&model, &x), evaluate(&again, &x));
                for end in [fuzzy::Outcome::low, fuzzy::Outcome::high] {
                    let difference = (end(&before).unwrap() - end(&after).unwrap()).abs();
                    assert!(difference < 1e-12, "{x:?}: {before:?} {after:?}");
                }
            }
        }
    }
}

#[test]
fn messages_about_files() {
    let plain = toolbox("KM", LOWER);
    let mut messages = String::new();
    for text in [
        toolbox("KM", INTERVALS),
        toolbox("BMM(0.9,0.3)", LOWER),
        toolbox("WM", LOWER),
        toolbox("ZZ", LOWER),
        plain.replace("'sugeno'", "'mamdani'"),
        plain.replace("'sugeno'", "'mamfistype2'"),
        plain.replacen("MF1L=", "MF7L=", 1),
        plain.replacen("[-4.2 -1.8 -0.5 1.5 1]", "[-4.2 -1.8 -0.5 1.5]", 1),
        plain.replacen("[-4.5 -1.5 0.5 1]", "[-4.5 -1.5 2.5 1]", 1),
        plain.replace("1 2, 2 (1) : 1", "1 -2, 2 (1) : 1"),
        plain.replace("1 2, 2 (1) : 1", "1 2, 2 (1) : 2"),
        plain.replace("1 2, 2 (1) : 1", "1 2, 2 (0.5) : 1"),
    ] {
        let findings = match flagred_interchange::read(&text, Format::Fis, Losses::Refuse) {
            Ok(document) => document.validate(&text).unwrap_err(),
            Err(findings) => findings,
        };
        messages += &format!("{findings}\n");
    }
    insta::assert_snapshot!(messages);
    // With losses, the lower ends of the numbers remain.
    let text = toolbox("KM", INTERVALS);
    let lossy = flagred_interchange::read(&text, Format::Fis, Losses::Accept).unwrap();
    assert_eq!(lossy.model, read(&plain));
    let other_and = plain.replace("AndMethod='prod'", "AndMethod='min'");
    assert_eq!(read(&other_and), read(&plain));
}

#[test]
fn messages_about_rule_sets() {
    let mut messages = String::new();
    for (format, [from, to]) in [
        (Format::Fis, ["{and: product}", "{and: minimum}"]),
        (
            Format::Fis,
            ["heat IS low AND damp IS wet", "heat IS low OR damp IS wet"],
        ),
        (Format::Fis, ["heat IS low AND", "heat IS NOT low AND"]),
        (
            Format::Fis,
            ["THEN speed IS slow", "THEN speed IS slow WITH 0.5"],
        ),
        (
            Format::Fis,
            [
                "{triangle: [0, 0, 0.7], height: 0.75}",
                "{cosine: {center: 0, width: 1}}",
            ],
        ),
        (
            Format::Fis,
            [
                "range: [0, 9]",
                "range: [0, 9]\n    type_reduction: wu_mendel",
            ],
        ),
        (
            Format::Fis,
            [
                "defuzzifier: weighted_average\n    terms: {slow: {constant: 1}, medium: {linear: {heat: 0.1, damp: 2, constant: -1}}, fast: {constant: 8}}",
                "partition: [slow, medium, fast]",
            ],
        ),
        (Format::Fis, ["heat IS low AND damp IS wet", "heat IS low"]),
        (Format::Fll, ["", ""]),
        (Format::Fcl, ["", ""]),
        (Format::Fml, ["", ""]),
    ] {
        let model: Model = TYPE2.replace(from, to).parse().unwrap();
        let findings = flagred_interchange::write(&model, format, Losses::Refuse).unwrap_err();
        messages += &format!("{findings}\n");
    }
    insta::assert_snapshot!(messages);
}
