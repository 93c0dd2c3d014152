//! The example from the ANFIS paper (Jang 1993): predicts a chaotic series six steps ahead from
//! four past values.
#![allow(clippy::unwrap_used)]

use std::ops::ControlFlow;

use flagred_tuning::{Data, Settings, tune};
use fuzzy::{
    Engine, Model,
    model::{Conjunction, Defuzzifier, MembershipFunction, Output, Variable},
    rule::{Condition, Rule},
};

/// The solution of `x'(t) = 0.2 x(t - 17) / (1 + x(t - 17)^10) - 0.1 x(t)`, where x is 1.2 at t = 0 and 0 before;
/// computed by the Runge-Kutta method with steps of 0.1.
fn series(count: usize) -> Vec<f64> {
    const STEP: f64 = 0.1;
    const DELAY: usize = 170;
    let mut x = vec![1.2];
    for i in 0..count * 10 {
        let delayed = |at: usize| if at >= DELAY { x[at - DELAY] } else { 0.0 };
        let slope = |x: f64, delayed: f64| 0.2 * delayed / (1.0 + delayed.powi(10)) - 0.1 * x;
        let (begin, end) = (delayed(i), delayed(i + 1));
        let middle = (begin + end) / 2.0;
        let k1 = slope(x[i], begin);
        let k2 = slope(x[i] + STEP / 2.0 * k1, middle);
        let k3 = slope(x[i] + STEP / 2.0 * k2, middle);
        let k4 = slope(x[i] + STEP * k3, end);
        x.push(x[i] + STEP / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4));
    }
    x.into_iter().step_by(10).collect()
}

/// Returns `count` rows of the series, beginning `from` steps after t = 118.
fn rows(series: &[f64], from: usize, count: usize) -> Data {
    let past = |lag: usize| (from..from + count).map(|t| series[t - lag]).collect();
    Data {
        inputs: [18, 12, 6, 0].map(past).to_vec(),
        truths: (from..from + count).map(|t| series[t + 6]).collect(),
        ..Data::default()
    }
}

/// A model with two bell-shaped terms for each input, and a rule with a linear consequent for each of the 16
/// combinations of terms.
fn grid(low: f64, high: f64) -> Model {
    let names = ["x18", "x12", "x6", "x0"];
    let mut model = Model::builder("mackey-glass");
    for name in names {
        let bell = |center| MembershipFunction::Bell {
            center,
            width: (high - low) / 2.0,
            slope: 2.0,
        };
        model = model.input(
            Variable::new(name, low, high)
                .term("low", bell(low))
                .term("high", bell(high)),
        );
    }
    let mut output =
        Output::new(Variable::new("x", low, high)).defuzzifier(Defuzzifier::WeightedAverage);
    for cell in 0..16 {
        let coefficients = names.map(|name| (name.to_owned(), 0.0)).to_vec();
        output.variable = output.variable.term(
            format!("line_{cell}"),
            MembershipFunction::Linear {
                coefficients,
                constant: 0.0,
            },
        );
        let is = |i: usize| {
            let term = if cell >> i & 1 == 1 { "high" } else { "low" };
            Condition::is(names[i], term)
        };
        let condition = (1..4).fold(is(0), |all, i| all.and(is(i)));
        model = model.rule(Rule::new(condition, "x", &format!("line_{cell}")));
    }
    let mut model = model.output(output).build();
    model.operators.and = Conjunction::Product;
    model
}

fn rmse(model: &Model, data: &Data) -> f64 {
    let engine = Engine::new(model).unwrap();
    let columns: Vec<&[f64]> = data.inputs.iter().map(Vec::as_slice).collect();
    let outcomes = engine.evaluate_batch(&columns).unwrap();
    let errors = outcomes
        .iter()
        .zip(&data.truths)
        .map(|(outcome, truth)| outcome.value().unwrap() - truth);
    (errors.map(|error| error * error).sum::<f64>() / data.truths.len() as f64).sqrt()
}

#[test]
fn the_chaotic_series_is_predicted_as_well_as_by_anfis() {
    let series = series(1200);
    let (training, checking) = (rows(&series, 118, 500), rows(&series, 618, 500));
    let all = training.inputs.iter().chain(&checking.inputs).flatten();
    let (low, high) = all.fold((f64::MAX, f64::MIN), |(low, high), x| {
        (low.min(*x), high.max(*x))
    });
    let mut settings = Settings::default();
    settings.iterations = 60;
    settings.digits = None;
    let mut steps = 0;
    let tuned = tune(&grid(low, high), &training, &settings, &mut |_| {
        steps += 1;
        ControlFlow::Continue(())
    })
    .unwrap();
    let checked = rmse(&tuned.model, &checking);
    eprintln!(
        "training {:.5}, checking {checked:.5} after {steps} steps",
        tuned.after
    );
    assert!(checked <= 0.0025, "{checked}");
}
