use proptest::prelude::*;

use super::*;
use fuzzy::{Engine, check::Monotone, model::Defuzzifier};

fn go_on(_: &Progress<'_>) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

fn parse(text: &str) -> Model {
    fuzzy::yaml::parse(text).unwrap().model
}

/// Rows from a model: its outputs at random points.
fn rows_of(model: &Model, rows: usize, seed: u64) -> Data {
    let mut random = fastrand::Rng::with_seed(seed);
    let column = |input: &fuzzy::model::Variable| -> Vec<f64> {
        (0..rows)
            .map(|_| input.low + random.f64() * (input.high - input.low))
            .collect()
    };
    let inputs: Vec<Vec<f64>> = model.inputs.iter().map(column).collect();
    let engine = Engine::new(model).unwrap();
    let columns: Vec<&[f64]> = inputs.iter().map(Vec::as_slice).collect();
    let outcomes = engine.evaluate_batch(&columns).unwrap();
    let target = model.last_outputs()[0];
    Data {
        truths: outcomes
            .iter()
            .skip(target)
            .step_by(model.outputs.len())
            .map(|outcome| outcome.value().unwrap())
            .collect(),
        inputs,
        ..Data::default()
    }
}

fn tipper(peaks: [f64; 3], output: [f64; 3]) -> Model {
    let ([a, b, c], [small, middle, large]) = (peaks, output);
    parse(&format!(
        "
fuzzy: 1
name: tipper
inputs:
  service: {{range: [0, 10], partition: {{poor: {a}, good: {b}, excellent: {c}}}}}
  food: {{range: [0, 10], partition: {{rancid: 2, delicious: 8}}}}
outputs:
  tip:
    range: [0, 30]
    terms: {{small: {{singleton: {small}}}, middle: {{singleton: {middle}}}, large: {{singleton: {large}}}}}
operators: {{and: product, implication: product, aggregation: sum}}
rules:
  - IF service IS poor AND food IS rancid THEN tip IS small
  - IF service IS poor AND food IS delicious THEN tip IS middle
  - IF service IS good THEN tip IS middle
  - IF service IS excellent THEN tip IS large
"
    ))
}

#[test]
fn a_model_is_recovered_from_its_outputs() {
    let hidden = tipper([1.0, 4.0, 9.0], [3.0, 14.0, 27.0]);
    let begun = tipper([2.0, 5.0, 8.0], [5.0, 15.0, 25.0]);
    let data = rows_of(&hidden, 500, 1);
    let tuned = tune(&begun, &data, &Settings::default(), &mut go_on).unwrap();
    assert!(
        tuned.before > 1.0 && tuned.after < 1e-3,
        "{} {}",
        tuned.before,
        tuned.after
    );
    for (number, hidden) in numbers(&tuned.model).iter().zip(numbers(&hidden)) {
        assert!(
            (number.value - hidden.value).abs() < 0.01,
            "{number:?} {}",
            hidden.value
        );
    }
    assert_eq!(
        tuned
            .moved
            .iter()
            .filter(|moved| moved.of == "service.poor")
            .count(),
        1
    );
}

#[test]
fn rounded_numbers_have_the_requested_digits_and_keep_most_of_the_gain() {
    let data = rows_of(&tipper([1.04, 4.13, 9.02], [3.0, 14.0, 27.0]), 500, 1);
    let settings = Settings {
        digits: Some(2),
        ..Settings::default()
    };
    let tuned = tune(
        &tipper([2.0, 5.0, 8.0], [5.0, 15.0, 25.0]),
        &data,
        &settings,
        &mut go_on,
    )
    .unwrap();
    let values: Vec<f64> = tuned.moved.iter().map(|moved| moved.after).collect();
    assert!(
        values
            .iter()
            .all(|value| format!("{value}").trim_matches(['0', '.']).len() <= 3),
        "{values:?}"
    );
    assert!(
        values.contains(&4.1) && values.contains(&27.0),
        "{values:?}"
    );
    assert!(tuned.after < 0.2, "{}", tuned.after);
}

#[test]
fn the_same_arguments_give_the_same_model() {
    let data = rows_of(&tipper([1.0, 4.0, 9.0], [3.0, 14.0, 27.0]), 200, 2);
    let settings = Settings {
        starts: 3,
        seed: 7,
        ..Settings::default()
    };
    let begun = tipper([2.0, 5.0, 8.0], [5.0, 15.0, 25.0]);
    let once = tune(&begun, &data, &settings, &mut go_on).unwrap();
    assert_eq!(once, tune(&begun, &data, &settings, &mut go_on).unwrap());
}

#[test]
fn an_interrupted_search_keeps_the_best_so_far() {
    let data = rows_of(&tipper([1.0, 4.0, 9.0], [3.0, 14.0, 27.0]), 200, 2);
    let begun = tipper([2.0, 5.0, 8.0], [5.0, 15.0, 25.0]);
    let mut seen = Vec::new();
    let settings = Settings {
        digits: None,
        ..Settings::default()
    };
    let tuned = tune(&begun, &data, &settings, &mut |progress| {
        seen.push(progress.loss);
        match progress.iteration {
            4 => ControlFlow::Break(()),
            _ => ControlFlow::Continue(()),
        }
    })
    .unwrap();
    assert!(tuned.is_stopped);
    assert_eq!(seen.len(), 4);
    assert!(seen.is_sorted_by(|a, b| a >= b));
    assert_eq!(tuned.after, seen[3]);
}

#[test]
fn linear_consequents_are_solved_for() {
    let text = |line: [f64; 4]| {
        let [a, b, c, d] = line;
        parse(&format!(
            "
fuzzy: 1
name: curve
inputs:
  x: {{range: [0, 10], terms: {{low: {{gaussian: {{mean: 2, sd: 2}}}}, high: {{gaussian: {{mean: 8, sd: 2}}}}}}}}
outputs:
  y:
    range: [-100, 100]
    terms: {{left: {{linear: {{x: {a}, constant: {b}}}}}, right: {{linear: {{x: {c}, constant: {d}}}}}}}
    defuzzifier: weighted_average
rules:
  - IF x IS low THEN y IS left
  - IF x IS high THEN y IS right
"
        ))
    };
    let hidden = text([3.0, -1.0, -2.0, 5.0]);
    let begun = text([0.0, 0.0, 0.0, 0.0]);
    assert_eq!(begun.outputs[0].defuzzifier, Defuzzifier::WeightedAverage);
    let settings = Settings {
        only: vec!["y".into()],
        ..Settings::default()
    };
    let tuned = tune(&begun, &rows_of(&hidden, 100, 3), &settings, &mut go_on).unwrap();
    assert!(tuned.after < 1e-6, "{}", tuned.after);
    for (number, hidden) in numbers(&tuned.model).iter().zip(numbers(&hidden)) {
        assert!(
            (number.value - hidden.value).abs() < 1e-4,
            "{number:?} {}",
            hidden.value
        );
    }
}

/// Rows with truth 0 or 1. The truth is 1 for the smaller part of the rows, those above a line.
fn classes(rows: usize) -> Data {
    let mut random = fastrand::Rng::with_seed(5);
    let mut column = || (0..rows).map(|_| 10.0 * random.f64()).collect::<Vec<f64>>();
    let inputs = vec![column(), column()];
    let truth = |row: usize| f64::from(u8::from(inputs[0][row] + 0.2 * inputs[1][row] > 7.0));
    Data {
        truths: (0..rows).map(truth).collect(),
        groups: (0..rows as u32).map(|row| row % 12).collect(),
        inputs,
        ..Data::default()
    }
}

#[test]
fn both_losses_improve_classification() {
    let data = classes(600);
    for (loss, at_most) in [(Loss::Log, 0.25), (Loss::Ranking, 0.02)] {
        let settings = Settings {
            loss,
            weights: true,
            ..Settings::default()
        };
        let begun = tipper([1.0, 2.0, 3.0], [5.0, 15.0, 25.0]);
        let tuned = tune(&begun, &data, &settings, &mut go_on).unwrap();
        assert!(
            tuned.after < tuned.before && tuned.after < at_most,
            "{loss:?} {} {}",
            tuned.before,
            tuned.after
        );
        let mut folds = 0;
        let validation = cross_validate(&begun, &data, &settings, 4, &mut |fold, _| {
            folds = folds.max(fold + 1);
            ControlFlow::Continue(())
        });
        let validation = validation.unwrap().unwrap();
        assert_eq!((validation.folds, folds), (4, 4));
        assert!(validation.gain.low > 0.0, "{validation:?}");
        assert!(
            validation.after.low <= validation.after.value
                && validation.after.value <= validation.after.high
        );
    }
}

/// The last point of a learning curve is the loss of the cross-validation, and the loss on noisy rows decreases with
/// the number of rows.
#[test]
fn a_learning_curve_ends_with_the_validation_and_falls() {
    let truth = tipper([2.0, 6.0, 8.0], [5.0, 12.0, 28.0]);
    let start = tipper([1.0, 5.0, 9.0], [10.0, 15.0, 20.0]);
    let mut data = rows_of(&truth, 100, 5);
    let mut random = fastrand::Rng::with_seed(6);
    for tip in &mut data.truths {
        *tip += 8.0 * random.f64() - 4.0;
    }
    let settings = Settings::default();
    let mut ok = |_: u32, _: &Progress<'_>| ControlFlow::Continue(());
    let validation = cross_validate(&start, &data, &settings, 4, &mut ok).unwrap();
    let validation = validation.unwrap();
    let curve = learning_curve(&start, &data, &settings, 4, &validation, &mut ok)
        .unwrap()
        .unwrap();
    let shares: Vec<f64> = curve.iter().map(|point| point.share).collect();
    assert_eq!(shares, [0.125, 0.25, 0.5, 1.0]);
    assert_eq!(curve[3].unseen_loss, validation.after.value);
    assert!(
        curve[0].unseen_loss > 1.05 * curve[3].unseen_loss,
        "{curve:?}"
    );
    assert!(validation.reliability.is_empty());
    let mut stop = |_: u32, _: &Progress<'_>| ControlFlow::Break(());
    assert_eq!(
        learning_curve(&start, &data, &settings, 4, &validation, &mut stop),
        Ok(None)
    );
}

/// Predictions that were far too high become calibrated probabilities if the consequents are tuned with log loss.
#[test]
fn consequents_tuned_by_log_loss_are_calibrated_on_held_out_rows() {
    let data = classes(800);
    let model = tipper([2.0, 6.0, 8.0], [24.0, 27.0, 30.0]);
    let settings = Settings {
        loss: Loss::Log,
        only: vec!["tip".to_owned()],
        ..Settings::default()
    };
    let mut ok = |_: u32, _: &Progress<'_>| ControlFlow::Continue(());
    let validation = cross_validate(&model, &data, &settings, 4, &mut ok);
    let bins = validation.unwrap().unwrap().reliability;
    assert_eq!(bins.iter().map(|bin| bin.rows).sum::<usize>(), data.len());
    let apart = bins
        .iter()
        .map(|bin| bin.rows as f64 * (bin.predicted - bin.observed).abs());
    assert!(apart.sum::<f64>() / (data.len() as f64) < 0.1, "{bins:?}");
}

#[test]
fn wrong_rows_are_errors() {
    let begun = tipper([2.0, 5.0, 8.0], [5.0, 15.0, 25.0]);
    let error = |data: &Data, loss| {
        let settings = Settings {
            loss,
            ..Settings::default()
        };
        tune(&begun, data, &settings, &mut go_on)
            .unwrap_err()
            .to_string()
    };
    let mut data = classes(20);
    assert_eq!(error(&Data::default(), Loss::Squared), "there are no rows");
    data.truths[3] = 0.5;
    assert_eq!(
        error(&data, Loss::Log),
        "row 3: the output's value is 0.5, but must be 0 or 1 for this loss"
    );
    data.inputs[1][2] = f64::NAN;
    assert_eq!(
        error(&data, Loss::Squared),
        "row 2: a value is not a finite number"
    );
    data.inputs.pop();
    assert_eq!(
        error(&data, Loss::Squared),
        "there must be a column for each input of the model"
    );
    let mut same = classes(20);
    same.truths.fill(0.0);
    assert_eq!(
        error(&same, Loss::Ranking),
        "all rows have the same outcome"
    );
    // Only the rows with truth 1 have a weight above 0.
    let mut one = classes(20);
    one.weights = one.truths.clone();
    assert_eq!(error(&one, Loss::Ranking), "all rows have the same outcome");
    one.weights.fill(0.0);
    assert_eq!(error(&one, Loss::Squared), "the weights of all rows are 0");
    for (weight, reported) in [
        (-1.0, "the weight is -1.0"),
        (1e308, "the weight is 1e308"),
        (f64::NAN, "the weight is NaN"),
    ] {
        one.weights.fill(weight);
        let error = error(&one, Loss::Squared);
        assert!(
            error.starts_with("row 0: ") && error.contains(reported),
            "{error}"
        );
    }
    one.weights.clear();
    one.truths[7] = -1e308;
    assert_eq!(
        error(&one, Loss::Squared),
        "row 7: the value -1e308 is outside the range from -1e50 to 1e50 that tuning supports"
    );
}

/// Some rows may have a weight of 0; cross-validation ignores them.
#[test]
fn rows_without_weight_do_not_change_figures() {
    let begun = tipper([2.0, 5.0, 8.0], [5.0, 15.0, 25.0]);
    let data = rows_of(&tipper([1.0, 4.0, 9.0], [3.0, 14.0, 27.0]), 60, 2);
    let mut more = data.clone();
    more.weights = vec![1.0; 60];
    for (column, x) in more.inputs.iter_mut().zip([1.0, 1.0]) {
        column.extend([x; 60]);
    }
    more.truths.extend([30.0; 60]);
    more.weights.extend([0.0; 60]);
    let settings = Settings {
        iterations: 3,
        ..Settings::default()
    };
    let mut ok = |_: u32, _: &Progress<'_>| ControlFlow::Continue(());
    let validation = |data: &Data, ok: &mut dyn FnMut(u32, &Progress<'_>) -> ControlFlow<()>| {
        cross_validate(&begun, data, &settings, 4, ok)
            .unwrap()
            .unwrap()
    };
    assert_eq!(validation(&data, &mut ok), validation(&more, &mut ok));
}

fn constants(values: [f64; 2]) -> Model {
    let [slow, fast] = values;
    parse(&format!(
        "
fuzzy: 1
name: fan
inputs: {{heat: {{range: [0, 10], partition: {{cool: 2, hot: 8}}}}}}
outputs:
  speed: {{range: [0, 10], terms: {{slow: {{constant: {slow}}}, fast: {{constant: {fast}}}}}, defuzzifier: weighted_average}}
rules: [IF heat IS cool THEN speed IS slow, IF heat IS hot THEN speed IS fast]
"
    ))
}

/// Constants end at the values within the range that have the smallest error, whether they are fitted or searched.
#[test]
fn constants_are_optimal_within_the_range() {
    let heat: Vec<f64> = (0..=20).map(|i| f64::from(i) / 2.0).collect();
    let truths: Vec<f64> = heat.iter().map(|heat| 4.0 + 1.2 * heat).collect();
    let data = Data {
        truths,
        inputs: vec![heat],
        ..Data::default()
    };
    let only = vec!["speed".to_owned()];
    let rmse = |slow: f64| {
        let settings = Settings {
            only: only.clone(),
            iterations: 1,
            digits: None,
            ..Settings::default()
        };
        tune(&constants([slow, 10.0]), &data, &settings, &mut |_| {
            ControlFlow::Break(())
        })
        .unwrap()
        .before
    };
    let places = (0..=1000).map(|i| f64::from(i) / 100.0);
    let best = places.min_by(|a, b| rmse(*a).total_cmp(&rmse(*b))).unwrap();
    let rising = Monotone {
        input: "heat".into(),
        direction: check::Direction::Increasing,
        output: None,
    };
    for monotone in [Vec::new(), vec![rising]] {
        // The search begins inside the range, and at its upper end, where a constant can only decrease.
        for begun in [[3.0, 4.0], [10.0, 10.0]] {
            let settings = Settings {
                only: only.clone(),
                digits: None,
                monotone: monotone.clone(),
                ..Settings::default()
            };
            let tuned = tune(&constants(begun), &data, &settings, &mut go_on).unwrap();
            let values: Vec<f64> = numbers(&tuned.model)[2..4]
                .iter()
                .map(|n| n.value)
                .collect();
            assert!(
                (values[0] - best).abs() < 0.05 && values[1] == 10.0,
                "{values:?} {best}"
            );
        }
    }
    // A constant that is already outside may stay there, but does not move further out.
    let outside = tune(
        &constants([3.0, 12.0]),
        &data,
        &Settings {
            only,
            ..Settings::default()
        },
        &mut go_on,
    );
    assert_eq!(numbers(&outside.unwrap().model)[3].value, 12.0);
}

/// All targets are far above the range, so both constants end at their upper bound.
#[test]
fn constants_end_at_the_end_of_the_range_for_targets_far_beyond_it() {
    let heat: Vec<f64> = (0..=20).map(|i| f64::from(i) / 2.0).collect();
    for target in [50.0, 1e3, 1e6] {
        let data = Data {
            truths: vec![target; heat.len()],
            inputs: vec![heat.clone()],
            ..Data::default()
        };
        for (beyond_range, end) in [(false, 10.0), (true, 20.0)] {
            let settings = Settings {
                only: vec!["speed".into()],
                beyond_range,
                ..Settings::default()
            };
            let tuned = tune(&constants([3.0, 4.0]), &data, &settings, &mut go_on).unwrap();
            let values: Vec<f64> = tuned.moved.iter().map(|moved| moved.after).collect();
            assert_eq!(values, [end, end], "{target}");
            assert!(tuned.after < tuned.before);
            assert_eq!(tuned.at_bounds, ["speed.slow", "speed.fast"]);
        }
    }
}

/// The rows pull one constant far beyond the range, and the other constant to a value inside the range. The first
/// constant does not affect the second.
#[test]
fn a_constant_at_its_limit_does_not_affect_the_others() {
    let heat: Vec<f64> = (0..=20).map(|i| f64::from(i) / 2.0).collect();
    let truths = heat.iter().map(|heat| if *heat <= 2.0 { 6.0 } else { 1e4 });
    let data = Data {
        truths: truths.collect(),
        inputs: vec![heat.clone()],
        weights: heat
            .iter()
            .map(|heat| if *heat > 2.0 && *heat < 8.0 { 0.0 } else { 1.0 })
            .collect(),
        ..Data::default()
    };
    let settings = Settings {
        only: vec!["speed".into()],
        ..Settings::default()
    };
    let tuned = tune(&constants([3.0, 4.0]), &data, &settings, &mut go_on).unwrap();
    let values: Vec<f64> = tuned.moved.iter().map(|moved| moved.after).collect();
    assert_eq!(values, [6.0, 10.0]);
    assert_eq!(tuned.at_bounds, ["speed.fast"]);
}

/// A peak that the rows pull beyond the range ends exactly at the end of the range, without a rounding error.
#[test]
fn a_peak_ends_at_the_end_of_the_range_exactly() {
    let heat: Vec<f64> = (0..=40).map(|i| f64::from(i) / 4.0).collect();
    let data = Data {
        truths: heat.iter().map(|heat| 5.0 + heat / 2.0).collect(),
        inputs: vec![heat],
        ..Data::default()
    };
    let settings = Settings {
        only: vec!["heat".into()],
        ..Settings::default()
    };
    let tuned = tune(&constants([0.0, 10.0]), &data, &settings, &mut go_on).unwrap();
    let peaks = tuned.model.inputs[0].partition_peaks().unwrap();
    assert_eq!(peaks[0], 0.0, "{peaks:?}");
}

#[test]
fn numbers_of_another_model_with_the_same_terms_are_used() {
    let (one, other) = (constants([1.0, 2.0]), constants([3.0, 4.0]));
    assert_eq!(with_numbers_of(&one, &other), Some(other));
    let tip = tipper([1.0, 4.0, 9.0], [3.0, 14.0, 27.0]);
    assert_eq!(with_numbers_of(&one, &tip), None);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    /// Even if noise moves the peaks and consequents, the order of terms and the monotonicity in inputs are kept.
    #[test]
    fn constraints_hold_on_random_rows(seed in any::<u64>()) {
        let mut random = fastrand::Rng::with_seed(seed);
        let mut column = |scale: f64| (0..40).map(|_| scale * random.f64()).collect::<Vec<f64>>();
        let data = Data {
            inputs: vec![column(10.0), column(10.0)],
            truths: column(30.0),
            ..Data::default()
        };
        let settings = Settings {
            monotone: vec![Monotone {
                input: "service".into(),
                direction: check::Direction::Increasing,
                output: None,
            }],
            iterations: 10,
            ..Settings::default()
        };
        let begun = tipper([2.0, 5.0, 8.0], [5.0, 15.0, 25.0]);
        let tuned = tune(&begun, &data, &settings, &mut go_on).unwrap();
        prop_assert!(tuned.after <= tuned.before);
        let engine = Engine::new(&tuned.model).unwrap();
        prop_assert!(check::counterexamples(&engine, &settings.monotone).unwrap().is_empty());
        let peaks = tuned.model.inputs[0].partition_peaks().unwrap();
        prop_assert!(peaks.windows(2).all(|pair| pair[1] - pair[0] >= 0.1 - 1e-9), "{:?}", peaks);
        let places: Vec<f64> = numbers(&tuned.model)[5..8].iter().map(|number| number.value).collect();
        prop_assert!(places.windows(2).all(|pair| pair[0] < pair[1]), "{:?}", places);
    }
}

/// A model with an intermediate output `comfort`, which is not a column of the rows.
fn chain(comfort: [f64; 2], fast: f64) -> Model {
    let [poor, good] = comfort;
    parse(&format!(
        "
fuzzy: 1
name: fan
inputs:
  heat: {{range: [0, 40], partition: {{cool: 10, hot: 30}}}}
  humidity: {{range: [0, 100], partition: {{dry: 20, wet: 80}}}}
outputs:
  speed: {{range: [0, 9], terms: {{slow: {{constant: 0}}, fast: {{constant: {fast}}}}}, defuzzifier: weighted_average}}
  comfort: {{range: [0, 1], partition: {{poor: {poor}, good: {good}}}}}
rules:
  - IF heat IS cool AND humidity IS dry THEN comfort IS good
  - IF heat IS hot OR humidity IS wet THEN comfort IS poor
  - IF comfort IS poor THEN speed IS fast
  - IF comfort IS good THEN speed IS slow
"
    ))
}

#[test]
fn a_chain_is_tuned_from_the_values_of_its_last_output() {
    let data = rows_of(&chain([0.3, 0.7], 8.0), 400, 1);
    let begun = chain([0.1, 0.9], 6.0);
    let settings = Settings {
        monotone: vec![Monotone {
            input: "heat".into(),
            direction: check::Direction::Increasing,
            output: None,
        }],
        ..Settings::default()
    };
    let tuned = tune(&begun, &data, &settings, &mut go_on).unwrap();
    assert!(
        tuned.after < tuned.before / 5.0,
        "{} {}",
        tuned.before,
        tuned.after
    );
    let moves = |name: &str| tuned.moved.iter().any(|moved| moved.of == name);
    assert!(
        moves("comfort.poor") && moves("speed.fast"),
        "{:?}",
        tuned.moved
    );

    let mut two = begun.clone();
    two.rules.truncate(2);
    assert_eq!(
        tune(&two, &data, &settings, &mut go_on).unwrap_err(),
        TuneError::Outputs { outputs: 2 }
    );
}
