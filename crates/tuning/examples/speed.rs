//! Tunes 81 rules over 4 inputs on 100,000 rows, and prints the time and the peak memory of the process.
//!
//! `cargo run --release -p flagred-tuning --example speed`
#![allow(clippy::print_stdout, reason = "it is a program")]

use std::{ops::ControlFlow, time::Instant};

use flagred_tuning::{Data, Settings, tune};
use fuzzy::{
    Engine, Model,
    model::{Aggregation, Conjunction, Implication, Output, Variable},
    rule::{Condition, Rule},
};

const ROWS: usize = 100_000;
const INPUTS: [&str; 4] = ["a", "b", "c", "d"];
const TERMS: [&str; 3] = ["low", "middle", "high"];
const OUTPUTS: [&str; 5] = ["very_low", "low", "middle", "high", "very_high"];

/// A model with a rule for every combination of terms: the output term depends on the sum of the indices of the input terms.
fn model(middle: f64, outputs: [f64; 5]) -> Model {
    let mut model = Model::builder("speed");
    for name in INPUTS {
        let peaks = TERMS.into_iter().zip([0.0, middle, 1.0]);
        model = model.input(Variable::new(name, 0.0, 1.0).partition_at(peaks));
    }
    let peaks = OUTPUTS.into_iter().zip(outputs);
    let output = Variable::new("y", 0.0, 100.0).partition_at(peaks);
    model = model.output(Output::new(output));
    for cell in 0..81_usize {
        let term = |input: usize| cell / 3_usize.pow(input as u32) % 3;
        let is = |input: usize| Condition::is(INPUTS[input], TERMS[term(input)]);
        let sum: usize = (0..4).map(term).sum();
        let condition = (1..4).fold(is(0), |all, input| all.and(is(input)));
        model = model.rule(Rule::new(condition, "y", OUTPUTS[sum / 2]));
    }
    let mut model = model.build();
    model.operators.and = Conjunction::Product;
    model.operators.implication = Implication::Product;
    model.operators.aggregation = Aggregation::Sum;
    model
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut random = fastrand::Rng::with_seed(1);
    let mut column = || (0..ROWS).map(|_| random.f64()).collect::<Vec<f64>>();
    let inputs: Vec<Vec<f64>> = INPUTS.iter().map(|_| column()).collect();
    let noise = column();
    let hidden = Engine::new(&model(0.3, [10.0, 20.0, 50.0, 70.0, 90.0]))?;
    let columns: Vec<&[f64]> = inputs.iter().map(Vec::as_slice).collect();
    let values = hidden.evaluate_batch(&columns)?;
    let truths = values.iter().zip(&noise);
    let data = Data {
        truths: truths
            .map(|(outcome, noise)| outcome.value().unwrap_or(f64::NAN) + 4.0 * (noise - 0.5))
            .collect(),
        inputs,
        ..Data::default()
    };
    let begun = model(0.5, [5.0, 25.0, 50.0, 75.0, 95.0]);
    let (start, mut steps) = (Instant::now(), 0);
    let tuned = tune(&begun, &data, &Settings::default(), &mut |_| {
        steps += 1;
        ControlFlow::Continue(())
    })?;
    println!(
        "{ROWS} rows, 81 rules: {:.1} s, {steps} steps, RMS error {:.3} -> {:.3} (noise: {:.3})",
        start.elapsed().as_secs_f64(),
        tuned.before,
        tuned.after,
        4.0 / 12.0_f64.sqrt()
    );
    if let Ok(status) = std::fs::read_to_string("/proc/self/status") {
        let peak = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        println!("highest memory: {}", peak.unwrap_or(" unknown").trim());
    }
    Ok(())
}
