//! The elevated risk, from all risks of a flight.

use std::f64::consts::TAU;

use flagred::accumulator::AccumulatorSettings;

use super::window::{Window, mean};

/// A risk in % that changes linearly from one time to another.
#[derive(Clone, Copy)]
pub struct Stretch {
    /// Start: time in seconds and risk.
    pub from: (f64, f64),
    /// End: time in seconds and risk.
    pub to: (f64, f64),
}

/// The rate of change in % per second at the end of the last stretch.
pub fn rate(settings: &AccumulatorSettings, risks: &[Stretch]) -> f64 {
    let now_s = risks[risks.len() - 1].to.0;
    let window = Window {
        length_s: settings.window_s,
        now_s,
        since_s: f64::NEG_INFINITY,
    };
    let first = risks.partition_point(|risk| risk.to.0 < now_s - 2.0 * settings.window_s);
    let risks = &risks[first..];
    let spans: Vec<(f64, f64)> = risks.iter().map(|risk| (risk.from.0, risk.to.0)).collect();
    let weights = window.weights(&spans);
    // Simpson's rule is exact for a straight line and its square.
    let mean_of = |f: &dyn Fn(f64) -> f64| {
        let values = risks.iter().map(|Stretch { from, to }| {
            (f(from.1) + 4.0 * f((from.1 + to.1) / 2.0) + f(to.1)) / 6.0
        });
        mean(weights.iter().copied().zip(values))
    };
    let average = mean_of(&|risk| risk);
    let std = mean_of(&|risk| (risk - average).powi(2)).sqrt();
    settings.rise_pct_per_s * (1.0 - below(settings.high_pct, average, std))
        - settings.fall_pct_per_s * below(settings.low_pct, average, std)
}

/// The share of a normal distribution that is below `x`: the integral of its density by Simpson's rule.
fn below(x: f64, mean: f64, std: f64) -> f64 {
    if std == 0.0 {
        return if mean == x { 0.5 } else { f64::from(mean < x) };
    }
    let z = ((x - mean) / std).clamp(-10.0, 10.0);
    let cells = 200;
    let width = z / f64::from(cells);
    let density = |x: f64| (-x * x / 2.0).exp() / TAU.sqrt();
    let cell = |i: i32| {
        let x = f64::from(i) * width;
        density(x) + 4.0 * density(x + width / 2.0) + density(x + width)
    };
    0.5 + width / 6.0 * (0..cells).map(cell).sum::<f64>()
}
