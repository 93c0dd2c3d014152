//! The inputs of a profile, from all samples of a flight.

use flagred::{
    profile::Profile,
    source::{Motors, Signal, Source, Statistic},
};

use super::window::{Window, mean};

/// The length of a bin in seconds.
const BIN_S: f64 = 0.1;
/// How far back a window is looked for, in seconds beyond its length: the bin before its first one.
const MORE_S: f64 = 5.0;

/// What an input observes in one sample, and the time that it stands for.
#[derive(Clone)]
pub struct Observed {
    /// From when, in seconds.
    pub from_s: f64,
    /// Until when.
    pub to_s: f64,
    /// The known values: of the motors, or one of all of them.
    pub values: Vec<f64>,
    /// By how much it differs from the one before; of bins.
    step: f64,
}

impl Observed {
    /// What a source observes in a sample: the effective commands of the motors, and the same without yaw.
    pub fn new(source: &Source, span: (f64, f64), commands: &[f64], less_yaw: &[f64]) -> Observed {
        let of_motors: Vec<f64> = match &source.signal {
            Signal::MotorCommand => commands.to_vec(),
            Signal::MotorCommandLessYaw => less_yaw.to_vec(),
            Signal::MotorMargin => commands.iter().map(|e| e.min(1.0 - e)).collect(),
            other => panic!("{other:?} has no reference"),
        };
        let known: Vec<f64> = of_motors.into_iter().filter(|e| e.is_finite()).collect();
        let mean = mean(known.iter().map(|e| (1.0, *e)));
        let squares = known.iter().map(|e| (1.0, (e - mean).powi(2)));
        let std = super::window::mean(squares).sqrt();
        let values = match source.motors {
            _ if known.is_empty() => vec![],
            Motors::Pooled => known,
            Motors::Mean => vec![mean],
            Motors::Std => vec![std],
            other => panic!("{other:?} has no reference"),
        };
        let (from_s, to_s) = span;
        let step = 0.0;
        Observed {
            from_s,
            to_s,
            values,
            step,
        }
    }
}

/// The value of each input of a profile after the last sample; `None` where too little is known. What ended before `since_s`
/// does not count in long windows.
pub fn values(
    profile: &Profile,
    observed: &[Vec<Observed>],
    now_s: f64,
    since_s: f64,
) -> Vec<Option<f64>> {
    let inputs = profile.inputs.iter().zip(observed);
    let values = inputs.map(|(input, observed)| {
        let source = &input.source;
        let is_long = source.window_s > profile.sampling.take_off_s;
        let window = Window {
            length_s: source.window_s,
            now_s,
            since_s: if is_long { since_s } else { f64::NEG_INFINITY },
        };
        value(profile, &source.statistic, &window, observed)
    });
    values.collect()
}

fn value(
    profile: &Profile,
    statistic: &Statistic,
    window: &Window,
    observed: &[Observed],
) -> Option<f64> {
    let begin_s = window.now_s - window.length_s - MORE_S;
    let first = observed.partition_point(|observed| observed.to_s < begin_s);
    let known = observed[first..]
        .iter()
        .filter(|observed| !observed.values.is_empty());
    let mut all: Vec<&Observed> = known.collect();
    let mut latest = None;
    let of_bins;
    if *statistic == Statistic::StdLessNoise {
        of_bins = bins(&all);
        all = of_bins.iter().collect();
        latest = all.pop_if(|bin| bin_of(bin.to_s) == bin_of(window.now_s));
    }
    let has_time = |observed: &&Observed| observed.to_s > observed.from_s;
    all.retain(has_time);
    let spans: Vec<(f64, f64)> = all.iter().map(|o| (o.from_s, o.to_s)).collect();
    let mut inside: Vec<(f64, &Observed)> = window.weights(&spans).into_iter().zip(all).collect();
    inside.retain(|(weight, _)| *weight > 0.0);
    // The bin that the latest sample is in counts in full.
    inside.extend(
        latest
            .filter(has_time)
            .map(|bin| (bin.to_s - bin.from_s, bin)),
    );

    let sampling = &profile.sampling;
    let covered_s: f64 = inside.iter().map(|(weight, _)| weight).sum();
    let needed_s = 0.99 * sampling.warm_up_s.min(window.length_s);
    if covered_s < needed_s || inside.len() < sampling.min_samples as usize {
        return None;
    }
    let mean_of = |f: &dyn Fn(f64) -> f64| {
        let values = inside.iter().flat_map(|(weight, observed)| {
            let weight = weight / observed.values.len() as f64;
            observed.values.iter().map(move |value| (weight, f(*value)))
        });
        mean(values)
    };
    let average = mean_of(&|x| x);
    let variance = mean_of(&|x| (x - average).powi(2));
    Some(match *statistic {
        Statistic::Mean => average,
        Statistic::Std => variance.sqrt(),
        Statistic::ShareBelow(limit) => mean_of(&|x| f64::from(x < limit)),
        Statistic::StdLessNoise => {
            let squares = inside
                .iter()
                .map(|(weight, bin)| (*weight, bin.step.powi(2)));
            let noise = (mean(squares) / 2.0).sqrt();
            (variance - noise.powi(2)).max(0.0).sqrt()
        }
        ref other => panic!("{other:?} has no reference"),
    })
}

fn bin_of(t_s: f64) -> f64 {
    (t_s / BIN_S + 1e-6).floor()
}

/// The plain means of the samples of each bin, which stand for the time of its samples.
fn bins(observed: &[&Observed]) -> Vec<Observed> {
    let of_bins = observed.chunk_by(|a, b| bin_of(a.to_s) == bin_of(b.to_s));
    let mut bins: Vec<Observed> = Vec::new();
    for samples in of_bins {
        let value = mean(samples.iter().map(|sample| (1.0, sample.values[0])));
        let held_s: f64 = samples
            .iter()
            .map(|sample| sample.to_s - sample.from_s)
            .sum();
        let to_s = samples[samples.len() - 1].to_s;
        let before = bins.last().map_or(value, |bin| bin.values[0]);
        bins.push(Observed {
            from_s: to_s - held_s,
            to_s,
            values: vec![value],
            step: value - before,
        });
    }
    bins
}
