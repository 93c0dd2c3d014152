use std::ops::ControlFlow;

use fuzzy::Engine;

use super::*;

/// Rows of three random columns; the output does not depend on the third.
fn rows(count: usize, truth: fn(f64, f64) -> f64) -> (Vec<String>, Data) {
    let mut random = fastrand::Rng::with_seed(11);
    let mut data = Data {
        inputs: vec![Vec::new(); 3],
        ..Data::default()
    };
    for _ in 0..count {
        let row = [10.0 * random.f64(), random.f64(), 5.0 * random.f64() - 2.5];
        for (column, x) in data.inputs.iter_mut().zip(row) {
            column.push(x);
        }
        let noise = 0.1 * (random.f64() - 0.5);
        data.truths.push(truth(row[0], row[1]) + noise);
    }
    let names = ["flow", "valve", "colour"].map(str::to_owned);
    (names.to_vec(), data)
}

fn wave(x: f64, y: f64) -> f64 {
    (x / 2.0).sin() * 3.0 + 4.0 * y
}

#[test]
fn inputs_that_matter_are_found_and_predict() {
    let (names, data) = rows(2000, wave);
    let found = identify(&names, "level", &data, &Identification::default()).unwrap();
    let mut columns = found.columns.clone();
    columns.sort_unstable();
    assert_eq!(columns, [0, 1]);
    let errors: Vec<f64> = found.steps.iter().map(|step| step.cv_error).collect();
    assert!(errors.is_sorted_by(|a, b| a > b), "{errors:?}");
    let engine = Engine::new(&found.model).unwrap();
    let columns: Vec<&[f64]> = found.columns.iter().map(|c| &data.inputs[*c][..]).collect();
    let outcomes = engine.evaluate_batch(&columns).unwrap();
    let squares = outcomes.iter().zip(&data.truths);
    let squares = squares.map(|(outcome, truth)| (outcome.value().unwrap() - truth).powi(2));
    let rmse = (squares.sum::<f64>() / data.len() as f64).sqrt();
    assert!(
        rmse < 1.1 * errors.last().unwrap() + 0.05,
        "{rmse} {errors:?}"
    );
    assert!(rmse < 0.6, "{rmse}");
}

#[test]
fn a_model_survives_being_written_and_read() {
    let (names, data) = rows(500, wave);
    for antecedents in [Antecedents::Partitions, Antecedents::Clusters] {
        for consequents in [Consequents::Constants, Consequents::Lines] {
            let settings = Identification {
                antecedents,
                consequents,
                ..Identification::default()
            };
            let found = identify(&names, "level", &data, &settings).unwrap();
            let text = fuzzy::yaml::to_string(&found.model);
            assert_eq!(
                fuzzy::yaml::parse(&text).unwrap().model,
                found.model,
                "{text}"
            );
            assert!(Engine::new(&found.model).is_ok());
            assert!(found.model.rules.len() <= settings.max_rules);
            assert_eq!(found, identify(&names, "level", &data, &settings).unwrap());
        }
    }
}

#[test]
fn named_inputs_are_used_and_unknown_ones_refused() {
    let (names, data) = rows(300, wave);
    let mut settings = Identification {
        inputs: vec!["colour".to_owned()],
        ..Identification::default()
    };
    let found = identify(&names, "level", &data, &settings).unwrap();
    assert_eq!(found.columns, [2]);
    settings.inputs = vec!["color".to_owned()];
    let refused = identify(&names, "level", &data, &settings).unwrap_err();
    let name = "color".to_owned();
    assert_eq!(refused, TuneError::Unknown { name });
}

#[test]
fn noise_gives_no_model() {
    let (names, data) = rows(300, |_, _| 0.0);
    let (_, mut constant) = rows(30, |_, _| 0.0);
    constant.truths.fill(4.0);
    for data in [data, constant] {
        let refused = identify(&names, "level", &data, &Identification::default());
        assert_eq!(refused.unwrap_err(), TuneError::NoInputHelps);
    }
}

#[test]
fn combinations_without_rows_have_no_rule() {
    let (names, mut data) = rows(2000, |x, y| x * y);
    let rows: Vec<bool> = (0..data.len())
        .map(|row| data.inputs[0][row] < 3.0 || data.inputs[1][row] < 0.2)
        .collect();
    data = data.filtered(|row| rows[row]);
    let settings = Identification {
        max_rules: 9,
        least_support: 5,
        ..Identification::default()
    };
    let found = identify(&names, "level", &data, &settings).unwrap();
    assert!(
        found.without_rows > 0,
        "{}",
        fuzzy::yaml::to_string(&found.model)
    );
    let cells: usize = found
        .model
        .inputs
        .iter()
        .map(|input| input.terms.len())
        .product();
    assert_eq!(found.model.rules.len() + found.without_rows, cells);
}

#[test]
fn a_curved_relation_is_predicted_better_than_by_a_line() {
    let (names, data) = rows(600, wave);
    let mut parts = Vec::new();
    let validation = cross_validate(
        &names,
        "level",
        &data,
        &Identification::default(),
        4,
        &mut |part| {
            parts.push(part);
            ControlFlow::Continue(())
        },
    );
    let validation = validation.unwrap().unwrap();
    assert_eq!((validation.folds, parts), (4, vec![0, 1, 2, 3]));
    assert!(validation.linear.value < validation.mean.value);
    assert!(
        validation.identified.value < 0.6 * validation.linear.value,
        "{validation:?}"
    );
    assert!(validation.ratio.low > 0.0 && validation.ratio.high < 0.7);
    let stopped = cross_validate(
        &names,
        "level",
        &data,
        &Identification::default(),
        4,
        &mut |_| ControlFlow::Break(()),
    );
    assert_eq!(stopped.unwrap(), None);
}

/// For a linear relation with noise, the error of linear regression is the noise alone, and the identified models
/// are not better.
#[test]
fn a_linear_relation_is_not_predicted_better_than_by_a_line() {
    let (names, data) = rows(400, |x, y| 2.0 * x - y + 1.0);
    let validation = cross_validate(
        &names,
        "level",
        &data,
        &Identification::default(),
        5,
        &mut |_| ControlFlow::Continue(()),
    );
    let validation = validation.unwrap().unwrap();
    // The standard deviation of uniform noise with a width of 0.1.
    assert!(
        (validation.linear.value - 0.1 / 12_f64.sqrt()).abs() < 0.002,
        "{validation:?}"
    );
    assert!(validation.ratio.value > 1.0);
}
