use alloc::string::String;

use super::*;
use crate::{Engine, model::Output};
use alloc::format;
use proptest::prelude::*;

fn variables() -> Model {
    let text = "
fuzzy: 1
name: flight
inputs:
  margin: {range: [0, 0.5], partition: {very_low: 0, low: 0.1, medium: 0.2, high: 0.3}}
  spread: {range: [0, 0.5], partition: {low: 0, medium: 0.1, high: 0.2}}
outputs:
  risk: {range: [0, 100], partition: [very_low, low, medium, high, very_high]}
rules: []
";
    crate::yaml::parse(text).unwrap().model
}

fn learn(settings: Settings, rows: &[[f64; 3]]) -> LearnResult {
    let mut learner = Learner::new(&variables(), settings).unwrap();
    for row in rows {
        learner.add(row, 1.0).unwrap();
    }
    learner.finish()
}

fn words(learned: &LearnResult) -> Vec<String> {
    learned
        .model
        .rules
        .iter()
        .map(|r| r.rule.to_string())
        .collect()
}

// FLAGRED, Table I: the four rows that the paper prints, numbers 0, 2, 383 and 384.
const TABLE_1: [[f64; 3]; 4] = [
    [0.007969, 0.226310, 65.679063],
    [0.070469, 0.308401, 100.0],
    [0.064687, 0.153689, 46.015181],
    [0.351094, 0.092301, 4.798570],
];

#[test]
fn the_papers_printed_rows_make_three_rules() {
    let learned = learn(Settings::default(), &TABLE_1);
    // Computed by hand: the degree of a row is the product of the highest memberships of its values. Rows 2 and 383 have
    // the same antecedent: 0.70469 * 1 * 1 is more than 0.64687 * 0.53689 * 0.84061.
    let expected = [
        (
            "IF margin IS very_low AND spread IS high THEN risk IS high",
            0.577186,
        ),
        (
            "IF margin IS low AND spread IS high THEN risk IS very_high",
            0.70469,
        ),
        (
            "IF margin IS high AND spread IS medium THEN risk IS very_low",
            0.745841,
        ),
    ];
    let rules = &learned.model.rules;
    assert_eq!(rules.len(), 3);
    for (rule, expected) in rules.iter().zip(expected) {
        assert_eq!(rule.rule.to_string(), expected.0);
        approx::assert_abs_diff_eq!(rule.confidence.unwrap(), expected.1, epsilon = 5e-6);
    }
    let rejected = &rules[1].against;
    assert_eq!(
        (
            rejected.len(),
            rejected[0].term.as_str(),
            rejected[0].support
        ),
        (1, "medium", 1)
    );
    approx::assert_abs_diff_eq!(rejected[0].degree, 0.291941, epsilon = 1e-6);
    assert_eq!(
        (learned.samples, learned.conflicts, learned.missing),
        (4, 1, 9)
    );
}

#[test]
fn the_papers_rules_are_recovered_from_their_own_map() {
    let model = crate::yaml::parse(include_str!("../../../rules/flagred-paper.yaml"))
        .unwrap()
        .model;
    let engine = Engine::new(&model).unwrap();
    let mut blank = model.clone();
    blank.rules.clear();
    // Samples are at the peaks and halfway between them. Finer samples would include transitions of the centroid
    // between two rules, and would vote for the wrong terms: 75 % at margin 0.08 belongs fully to `high`, although
    // no rule concludes `high`.
    for step in [5, 10] {
        let mut learner = Learner::new(&blank, Settings::default()).unwrap();
        for i in (0..=50).step_by(step) {
            for j in (0..=50).step_by(step) {
                let point = [f64::from(i) / 100.0, f64::from(j) / 100.0];
                let outcome = engine.evaluate(&point).unwrap()[0];
                // Where the dominant antecedent has no rule, the map has a gap.
                if let (Some(risk), true) = (outcome.value(), outcome.coverage > 0.5 + 1e-9) {
                    learner.add(&[point[0], point[1], risk], 1.0).unwrap();
                }
            }
        }
        let mut found = words(&learner.finish());
        let mut expected: Vec<String> = model.rules.iter().map(|r| r.rule.to_string()).collect();
        found.sort();
        expected.sort();
        assert_eq!(found, expected, "a sample every {step} hundredths");
    }
}

#[test]
fn conflicts_are_resolved_as_configured_and_rejected_candidates_are_kept() {
    // One strong vote for very_low, and three weaker ones for medium.
    let rows = [
        [0.3, 0.2, 0.0],
        [0.27, 0.2, 45.0],
        [0.27, 0.2, 50.0],
        [0.27, 0.2, 50.0],
    ];
    let strongest = learn(Settings::default(), &rows);
    assert_eq!(
        words(&strongest),
        ["IF margin IS high AND spread IS high THEN risk IS very_low"]
    );
    let rule = &strongest.model.rules[0];
    assert_eq!((rule.confidence, rule.support), (Some(1.0), Some(4)));
    assert_eq!(rule.against.len(), 1);
    assert_eq!(
        (rule.against[0].term.as_str(), rule.against[0].support),
        ("medium", 3)
    );
    approx::assert_abs_diff_eq!(rule.against[0].degree, 0.7, epsilon = 1e-9);
    assert_eq!(strongest.conflicts, 1);

    let by = |resolution| {
        let settings = Settings {
            resolution,
            ..Settings::default()
        };
        let learned = learn(settings, &rows);
        learned.model.rules[0].rule.consequents[0].term.text.clone()
    };
    assert_eq!(by(Resolution::Heaviest), "medium");
    // (0 + 0.7 * 145) / (1 + 3 * 0.7) = 32.7
    assert_eq!(by(Resolution::Mean), "low");
}

#[test]
fn too_few_or_uncertain_samples_give_no_rule_with_thresholds() {
    let rows = [[0.3, 0.2, 0.0], [0.3, 0.2, 0.0], [0.0, 0.2, 90.0]];
    let with = |min_support, min_degree| {
        let settings = Settings {
            min_support,
            min_degree,
            ..Settings::default()
        };
        let learned = learn(settings, &rows);
        (words(&learned).len(), learned.left_out)
    };
    assert_eq!(with(0, 0.0), (2, 0));
    assert_eq!(with(2, 0.0), (1, 1));
    assert_eq!(with(0, 0.7), (1, 1));
}

#[test]
fn rules_can_be_completed_and_made_monotone() {
    let rows = [
        [0.0, 0.2, 100.0],
        [0.1, 0.2, 25.0],
        // Contrary to physics: less spread than in the row above, but more risk.
        [0.1, 0.1, 75.0],
        [0.3, 0.0, 0.0],
    ];
    let settings = Settings {
        resolution: Resolution::Mean,
        complete: true,
        monotone: vec![
            ("margin".into(), Direction::Falling),
            ("spread".into(), Direction::Rising),
        ],
        ..Settings::default()
    };
    let learned = learn(settings, &rows);
    assert_eq!(learned.model.rules.len(), 12);
    assert_eq!((learned.completed, learned.missing), (8, 0));
    let engine = Engine::new(&learned.model).unwrap();
    let risk = |margin: f64, spread: f64| {
        engine.evaluate(&[margin, spread]).unwrap()[0]
            .value()
            .unwrap()
    };
    for margin in [0.0, 0.1, 0.2] {
        for spread in [0.0, 0.1, 0.2] {
            assert!(risk(margin, spread) >= risk(margin + 0.1, spread) - 1e-9);
            assert!(risk(margin, spread) >= risk(margin, (spread - 0.1).max(0.0)) - 1e-9);
        }
    }
    let completed = learned
        .model
        .rules
        .iter()
        .filter(|rule| rule.support == Some(0));
    for rule in completed {
        assert!(
            rule.note
                .as_ref()
                .unwrap()
                .starts_with("no samples; consequent of the nearest rule")
        );
        assert_eq!(rule.confidence, None);
    }
}

/// The terms are not in ascending order, and there are antecedents without a rule between others that have one.
#[test]
fn rules_are_monotone_over_gaps_and_in_the_order_of_the_terms() {
    let model = crate::yaml::parse(
        "
fuzzy: 1
name: fan
inputs:
  heat: {range: [0, 40], terms: {high: {right_shoulder: [30, 40]}, low: {left_shoulder: [0, 10]}, mild: {triangle: [0, 10, 20]}, warm: {triangle: [20, 30, 40]}, medium: {triangle: [10, 20, 30]}}}
outputs:
  speed: {range: [0, 100], terms: {fast: {triangle: [50, 100, 150]}, slow: {triangle: [-50, 0, 50]}, medium: {triangle: [0, 50, 100]}}}
rules: []
",
    )
    .unwrap()
    .model;
    let settings = Settings {
        monotone: vec![("heat".into(), Direction::Rising)],
        ..Settings::default()
    };
    let mut learner = Learner::new(&model, settings).unwrap();
    // There are no samples at mild and warm. The single sample with a high speed at low heat contradicts many samples
    // with a low speed.
    learner.add(&[0.0, 100.0], 1.0).unwrap();
    for _ in 0..9 {
        learner.add(&[20.0, 0.0], 1.0).unwrap();
    }
    learner.add(&[40.0, 50.0], 1.0).unwrap();
    let learned = learner.finish();
    assert_eq!(learned.moved, 1);
    assert_eq!(
        words(&learned),
        [
            "IF heat IS high THEN speed IS medium",
            "IF heat IS low THEN speed IS slow",
            "IF heat IS medium THEN speed IS slow",
        ]
    );
    let moved = &learned.model.rules[1];
    assert_eq!(
        (moved.confidence, moved.against[0].term.as_str()),
        (Some(0.0), "fast")
    );
    assert_eq!(
        moved.note.as_deref(),
        Some("moved from fast, so that the output is monotone")
    );
}

#[test]
fn rules_of_the_model_are_kept() {
    let mut model = variables();
    model.rules.push(crate::model::Rule::from(
        crate::rule::parse("IF margin IS very_low THEN risk IS very_high").unwrap(),
    ));
    let mut learner = Learner::new(&model, Settings::default()).unwrap();
    learner.add(&TABLE_1[3], 1.0).unwrap();
    assert_eq!(
        words(&learner.finish()),
        [
            "IF margin IS very_low THEN risk IS very_high",
            "IF margin IS high AND spread IS medium THEN risk IS very_low"
        ]
    );
}

#[test]
fn bad_samples_are_refused_with_the_reason() {
    let mut learner = Learner::new(&variables(), Settings::default()).unwrap();
    for (values, weight, message) in [
        (vec![0.1, 0.1], 1.0, "2 values for 3 variables"),
        (
            vec![f64::NAN, 0.1, 1.0],
            1.0,
            "`margin` is not a finite number",
        ),
        (
            vec![0.1, f64::INFINITY, 1.0],
            1.0,
            "`spread` is not a finite number",
        ),
        (
            vec![0.1, 0.6, 1.0],
            1.0,
            "`spread` is 0.6, outside its range from 0 to 0.5",
        ),
        (
            vec![1e308, 0.1, 1.0],
            1.0,
            "`margin` is 1e308, outside its range from 0 to 0.5",
        ),
        (
            vec![0.1, 0.1, -1.0],
            1.0,
            "`risk` is -1, outside its range from 0 to 100",
        ),
        (
            vec![0.1, 0.1, 1.0],
            0.0,
            "the weight is 0.0, but must be a number from 1e-50 to 1e50",
        ),
        (
            vec![0.1, 0.1, 1.0],
            1e308,
            "the weight is 1e308, but must be a number from 1e-50 to 1e50",
        ),
        (
            vec![0.1, 0.1, 1.0],
            1e-320,
            "the weight is 1e-320, but must be a number from 1e-50 to 1e50",
        ),
    ] {
        let refusal = learner.add(&values, weight).unwrap_err();
        assert_eq!(refusal.to_string(), message);
    }
    assert_eq!(learner.samples(), 0);
    assert_eq!(learner.finish().model.rules, []);
}

/// Regression test: sums overflowed and gave all rules the same consequent.
#[test]
fn equal_weights_give_the_rules_of_rows_without_weights() {
    let rows = [
        [0.02, 0.1, 90.0],
        [0.1, 0.02, 70.0],
        [0.11, 0.03, 20.0],
        [0.45, 0.4, 3.0],
    ];
    for resolution in [Resolution::Heaviest, Resolution::Mean] {
        let learned = |weight: f64| {
            let settings = Settings {
                resolution,
                complete: true,
                monotone: vec![("margin".into(), Direction::Falling)],
                ..Settings::default()
            };
            let mut learner = Learner::new(&variables(), settings).unwrap();
            for row in rows {
                learner.add(&row, weight).unwrap();
            }
            let rules = learner.finish().model.rules;
            rules.into_iter().map(|rule| rule.rule).collect::<Vec<_>>()
        };
        let plain = learned(1.0);
        for weight in [1e50, 1e30, 1e-30, 1e-50] {
            assert_eq!(learned(weight), plain, "{resolution:?} {weight}");
        }
    }
}

#[test]
fn settings_that_do_not_fit_the_model_are_refused() {
    let settings = Settings {
        monotone: vec![("wind".into(), Direction::Rising)],
        ..Settings::default()
    };
    let error = Learner::new(&variables(), settings).unwrap_err();
    assert_eq!(error.to_string(), "`wind` is not an input to learn over");

    let mut model = variables();
    model.inputs = ["a", "b", "c"].map(|name| numbered(name, 101)).into();
    let settings = Settings {
        complete: true,
        ..Settings::default()
    };
    let error = Learner::new(&model, settings).unwrap_err();
    assert_eq!(
        error.to_string(),
        "the inputs have 1030301 combinations of terms, but rules can be completed or made monotone only for up to 1000000"
    );
    assert!(Learner::new(&model, Settings::default()).is_ok());
}

/// A variable with this number of terms, whose peaks are 0, 1, 2 and so on.
fn numbered(name: &str, terms: usize) -> Variable {
    let names: Vec<String> = (0..terms).map(|term| format!("t{term}")).collect();
    Variable::new(name, 0.0, terms as f64 - 1.0).partition(names.iter().map(String::as_str))
}

/// The number of terms of each input of the model that is completed below.
const SHAPE: [usize; 3] = [3, 4, 5];

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Compared with a search of all rules for the nearest one, and of the nearest ones for the highest output.
    #[test]
    fn completed_rules_have_the_consequent_of_the_nearest_rule(
        known in prop::collection::btree_map(0usize..60, 0usize..5, 1..20),
    ) {
        let mut model = variables();
        model.inputs = ["a", "b", "c"].into_iter().zip(SHAPE).map(|(name, count)| numbered(name, count)).collect();
        model.outputs = vec![Output::new(numbered("y", 5))];
        let settings = Settings { complete: true, ..Settings::default() };
        let mut learner = Learner::new(&model, settings).unwrap();
        let place = |i: usize| [i / 20, i / 5 % 4, i % 5];
        for (i, term) in &known {
            let [a, b, c] = place(*i).map(|term| term as f64);
            learner.add(&[a, b, c, *term as f64], 1.0).unwrap();
        }
        let learned = learner.finish();
        prop_assert_eq!(learned.completed as usize, 60 - known.len());
        for (i, rule) in learned.model.rules.iter().enumerate() {
            let steps = |other: usize| place(i).iter().zip(place(other)).map(|(a, b)| a.abs_diff(b)).sum::<usize>();
            let nearest = known.keys().map(|other| steps(*other)).min().unwrap();
            let term = known.iter().filter(|(other, _)| steps(**other) == nearest).map(|(_, term)| term).max().unwrap();
            prop_assert_eq!(&rule.rule.consequents[0].term.text, &format!("t{term}"), "{}", i);
            prop_assert_eq!(rule.note.as_ref().map(|note| note.contains(&format!(", {nearest} step"))), (nearest > 0).then_some(true));
        }
    }

    #[test]
    fn the_order_of_the_rows_does_not_matter(
        rows in prop::collection::vec((0.0..0.5f64, 0.0..0.5f64, 0.0..100.0f64, 0.01..3.0f64), 1..120),
        shift in 0usize..120,
    ) {
        for resolution in [Resolution::Strongest, Resolution::Heaviest, Resolution::Mean] {
            let settings = Settings { resolution, ..Settings::default() };
            let learn = |rows: &[(f64, f64, f64, f64)]| {
                let mut learner = Learner::new(&variables(), settings.clone()).unwrap();
                for (margin, spread, risk, weight) in rows {
                    learner.add(&[*margin, *spread, *risk], *weight).unwrap();
                }
                learner.finish()
            };
            let mut turned = rows.clone();
            turned.rotate_left(shift % rows.len());
            let mut reversed = rows.clone();
            reversed.reverse();
            let once = learn(&rows);
            prop_assert_eq!(&once, &learn(&turned));
            prop_assert_eq!(&once, &learn(&reversed));
            prop_assert_eq!(format!("{once:?}"), format!("{:?}", learn(&turned)));
        }
    }
}

#[test]
fn outputs_that_chain_are_refused() {
    let mut model = variables();
    let strain = Output::new(Variable::new("strain", 0.0, 1.0).partition(["low", "high"]));
    model.outputs.push(strain);
    for rule in [
        "IF margin IS low THEN strain IS high",
        "IF strain IS high THEN risk IS high",
    ] {
        model
            .rules
            .push(rule.parse::<crate::rule::Rule>().unwrap().into());
    }
    let refused = Learner::new(&model, Settings::default()).unwrap_err();
    assert_eq!(refused, LearnError::Outputs { outputs: 2 });
}

#[test]
fn rules_are_not_learned_for_functions_of_inputs() {
    let text = "{fuzzy: 1, name: t, inputs: {x: {range: [0, 1], partition: [a, b]}}, outputs: {y: {range: [0, 1], defuzzifier: weighted_sum, terms: {steep: {function: x^2}}}}, rules: []}";
    let model = crate::yaml::parse(text).unwrap().model;
    let refused = Learner::new(&model, Settings::default()).unwrap_err();
    assert_eq!(
        refused.to_string(),
        "the term `steep` of the output is a function of inputs; rules are learned for fuzzy sets and numbers"
    );
}

#[test]
fn the_mean_selects_the_nearest_singleton_at_any_position() {
    let text = "{fuzzy: 1, name: t, inputs: {x: {range: [0, 1], partition: [a, b]}}, outputs: {y: {range: [0, 1], terms: {low: {singleton: 0}, odd: {singleton: 0.12345}, high: {singleton: 0.98765}}}}, rules: []}";
    let model = crate::yaml::parse(text).unwrap().model;
    let settings = Settings {
        resolution: Resolution::Mean,
        ..Settings::default()
    };
    let mut learner = Learner::new(&model, settings).unwrap();
    for row in [[0.0, 0.2], [1.0, 0.8]] {
        learner.add(&row, 1.0).unwrap();
    }
    let learned = words(&learner.finish());
    assert_eq!(
        learned,
        ["IF x IS a THEN y IS odd", "IF x IS b THEN y IS high"]
    );
}

const RESOLUTIONS: [Resolution; 3] = [
    Resolution::Strongest,
    Resolution::Heaviest,
    Resolution::Mean,
];

/// Returns a fan whose speed increases with the heat, with the given terms and defuzzifier.
fn fan(terms: &str, defuzzifier: &str) -> Model {
    let text = format!(
        "{{fuzzy: 1, name: fan, inputs: {{heat: {{range: [0, 40], partition: {{cold: 10, mild: 20, hot: 30}}}}}}, \
         outputs: {{speed: {{range: [0, 100], terms: {{{terms}}}, defuzzifier: {defuzzifier}}}}}, rules: []}}"
    );
    crate::yaml::parse(&text).unwrap().model
}

#[test]
fn numbers_are_learned_in_every_notation() {
    let numbers = [
        (
            "slow: {constant: 0}, medium: {constant: 50}, fast: {constant: 100}",
            "weighted_average",
        ),
        (
            "slow: {constant: 0}, medium: {constant: 50}, fast: {constant: 100}",
            "weighted_sum",
        ),
        (
            "slow: {singleton: 0}, medium: {singleton: 50}, fast: {singleton: 100}",
            "weighted_average",
        ),
        (
            "slow: {singleton: 0}, medium: {singleton: 50}, fast: {singleton: 100}",
            "centroid",
        ),
        (
            "slow: {function: 0}, medium: {linear: {constant: 50}}, fast: {function: 10^2}",
            "weighted_average",
        ),
        (
            "fast: {constant: 100}, slow: {constant: 0}, medium: {constant: 50}",
            "weighted_average",
        ),
    ];
    for (terms, defuzzifier) in numbers {
        for resolution in RESOLUTIONS {
            let settings = Settings {
                resolution,
                ..Settings::default()
            };
            let mut learner = Learner::new(&fan(terms, defuzzifier), settings).unwrap();
            for i in 0..=80 {
                let heat = f64::from(i) / 2.0;
                let speed = (5.0 * (heat - 10.0)).clamp(0.0, 100.0);
                learner.add(&[heat, speed], 1.0).unwrap();
            }
            let learned = learner.finish();
            assert_eq!(
                words(&learned),
                [
                    "IF heat IS cold THEN speed IS slow",
                    "IF heat IS mild THEN speed IS medium",
                    "IF heat IS hot THEN speed IS fast"
                ],
                "{terms} {defuzzifier} {resolution:?}"
            );
            let engine = Engine::new(&learned.model).unwrap();
            let value = engine.evaluate(&[15.0]).unwrap()[0].value().unwrap();
            assert!((value - 25.0).abs() < 1e-9, "{value}");
        }
    }
}

#[test]
fn a_value_between_two_numbers_belongs_to_both_by_its_distance() {
    let model = fan(
        "fast: {constant: 100}, slow: {constant: 10}, medium: {constant: 50}",
        "weighted_average",
    );
    let output = &model.outputs[0].variable;
    let consequents = Consequents::of(output);
    for (value, term, degree) in [
        (0.0, 1, 1.0),
        (10.0, 1, 1.0),
        (26.0, 1, 0.6),
        // Among equally near terms, the first one is used.
        (30.0, 1, 0.5),
        (34.0, 2, 0.6),
        (70.0, 2, 0.6),
        (100.0, 0, 1.0),
    ] {
        let (found, of) = consequents.highest(output, value).unwrap();
        assert_eq!(found, term, "{value}");
        approx::assert_abs_diff_eq!(of, degree, epsilon = 1e-12);
    }
    // The confidence is the degree of the strongest vote, 0.6.
    let mut learner = Learner::new(&model, Settings::default()).unwrap();
    learner.add(&[10.0, 26.0], 1.0).unwrap();
    let rule = &learner.finish().model.rules[0];
    approx::assert_abs_diff_eq!(rule.confidence.unwrap(), 0.6, epsilon = 1e-12);
}

#[test]
fn rules_for_numbers_are_made_monotone() {
    let model = fan(
        "slow: {constant: 0}, medium: {constant: 50}, fast: {constant: 100}",
        "weighted_average",
    );
    let settings = Settings {
        monotone: vec![("heat".into(), Direction::Rising)],
        complete: true,
        ..Settings::default()
    };
    let mut learner = Learner::new(&model, settings).unwrap();
    learner.add(&[10.0, 90.0], 1.0).unwrap();
    for _ in 0..9 {
        learner.add(&[20.0, 10.0], 1.0).unwrap();
    }
    let learned = learner.finish();
    assert_eq!((learned.moved, learned.completed), (1, 1));
    assert_eq!(
        words(&learned),
        [
            "IF heat IS cold THEN speed IS slow",
            "IF heat IS mild THEN speed IS slow",
            // The completed rule has the same conclusion as the nearest rule.
            "IF heat IS hot THEN speed IS slow"
        ]
    );
}
