use fuzzy::{Engine, model::Variable};
use proptest::prelude::*;

use super::*;

/// A term of every shape with an anchor, and a partition.
fn model() -> Model {
    fuzzy::yaml::parse(
        "
fuzzy: 1
name: shapes
inputs:
  heat: {range: [0, 40], partition: {cold: 0, mild: 12, hot: 30}}
  food:
    range: [0, 10]
    terms:
      a: {left_shoulder: [1, 2]}
      b: {triangle: [2, 2, 4]}
      c: {trapezoid: [3, 4, 5, 6]}
      d: {gaussian: {mean: 5, sd: 1}}
      e: {bell: {center: 6, width: 1, slope: 2}}
      f: {pi_shape: [6, 7, 7.5, 9]}
      g: {cosine: {center: 8, width: 2}}
      h: {sigmoid: {inflection: 9, slope: 3}}
      i: {gaussian2: {left_mean: 9.1, left_sd: 1, right_mean: 9.3, right_sd: 2}}
      j: {s_shape: [9, 10]}
outputs:
  tip: {range: [0, 30], partition: [small, large]}
rules:
  - IF heat IS hot OR food IS a THEN tip IS large
  - IF food IS NOT a THEN tip IS small
",
    )
    .unwrap()
    .model
}

fn names(variable: &Variable) -> Vec<&str> {
    variable
        .terms
        .iter()
        .map(|term| term.name.as_str())
        .collect()
}

#[test]
fn zeros_give_the_original_model() {
    let settings = Settings {
        weights: true,
        ..Settings::default()
    };
    let parameters = Parameters::new(&model(), &settings).unwrap();
    let same = parameters.model(&vec![0.0; parameters.free()]);
    for (number, original) in crate::numbers(&same).iter().zip(crate::numbers(&model())) {
        assert_eq!(number.of, original.of);
        let error = (number.value - original.value).abs();
        assert!(error < 0.05, "{number:?} {}", original.value);
    }
}

#[test]
fn a_vertical_edge_stays_vertical() {
    let parameters = Parameters::new(&model(), &Settings::default()).unwrap();
    let moved = parameters.model(&vec![0.7; parameters.free()]);
    let MembershipFunction::Triangle { left, peak, right } =
        moved.inputs[1].terms[1].membership_function
    else {
        panic!();
    };
    assert_eq!(left, peak);
    assert!(peak != 2.0 && right != 4.0);
}

#[test]
fn named_parameters_move_and_fixed_ones_stay() {
    let settings = Settings {
        only: vec!["heat".into(), "food.d".into()],
        fix: vec!["heat.hot".into()],
        ..Settings::default()
    };
    let parameters = Parameters::new(&model(), &settings).unwrap();
    // heat.cold touches the end of the range and heat.hot is fixed, so one peak can change. In food.d, the mean and the
    // deviation can change.
    assert_eq!(parameters.free(), 3);
    let moved = crate::numbers::moved(&model(), &parameters.model(&[1.0; 3]));
    let mut named: Vec<String> = moved
        .into_iter()
        .map(|moved| format!("{} {}", moved.of, moved.name))
        .collect();
    named.sort();
    assert_eq!(named, ["food.d mean", "food.d sd", "heat.mild peak"]);
}

#[test]
fn an_unknown_name_and_no_free_parameter_are_errors() {
    let of = |only: &[&str], fix: &[&str]| {
        let names = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect();
        let settings = Settings {
            only: names(only),
            fix: names(fix),
            ..Settings::default()
        };
        Parameters::new(&model(), &settings).unwrap_err()
    };
    assert_eq!(
        of(&["haet"], &[]).to_string(),
        "the rule set has no variable and no term `haet`"
    );
    assert_eq!(of(&["heat"], &["heat"]), TuneError::NothingMoves);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn every_number_makes_a_model_with_its_constraints(free in prop::collection::vec(-8.0..8.0_f64, 64)) {
        let settings = Settings { weights: true, ..Settings::default() };
        let parameters = Parameters::new(&model(), &settings).unwrap();
        let moved = parameters.model(&free[..parameters.free()]);
        prop_assert!(Engine::new(&moved).is_ok());
        prop_assert!(parameters.keeps(&moved));
        let peaks = moved.inputs[0].partition_peaks().unwrap();
        prop_assert!(peaks[0] == 0.0 && peaks[1] >= 0.4 - 1e-9 && peaks[2] - peaks[1] >= 0.4 - 1e-9);
        let original = model();
        prop_assert_eq!(names(&moved.inputs[1]), names(&original.inputs[1]));
        for rule in &moved.rules {
            prop_assert!(rule.rule.weight > 0.0 && rule.rule.weight <= 1.0);
        }
    }
}
