//! The inputs of a profile, from all samples of a flight.

use flagred::{
    profile::{Profile, Ratio},
    source::{Motors, Signal, Source, Statistic},
};

use super::window::{Window, mean};

/// The length of a bin in seconds.
const BIN_S: f64 = 0.1;
/// Values are kept for this time, in seconds, after they leave the window, so that the bin before the first bin of the
/// window is available.
const MORE_S: f64 = 5.0;

/// The observation of an input in one sample, and its time span.
#[derive(Clone)]
pub struct Observation {
    /// Start in seconds.
    pub from_s: f64,
    /// End in seconds.
    pub to_s: f64,
    /// The known values: one of each motor, or a single one.
    pub values: Vec<f64>,
    /// The difference from the previous bin; for bins only.
    step: f64,
}

/// The state of a vehicle at one time.
pub struct VehicleInputs<'a> {
    /// The effective commands of the motors.
    pub commands: &'a [f64],
    /// The same commands without yaw.
    pub less_yaw: &'a [f64],
    /// The signals, in the order of the profile.
    pub signals: &'a [f64],
}

impl Observation {
    /// Computes the observation of an input's source from one sample; `span` is the time span of the sample.
    pub fn new(
        profile: &Profile,
        source: &Source,
        span: (f64, f64),
        now: &VehicleInputs<'_>,
    ) -> Observation {
        let names = profile.signals();
        let signal = |name: &str| {
            let place = names.iter().position(|known| *known == name);
            place.map_or(f64::NAN, |place| now.signals[place])
        };
        let (from_s, to_s) = span;
        let of = |values: Vec<f64>| Observation {
            from_s,
            to_s,
            values,
            step: 0.0,
        };
        let one = |value: f64| of(Some(value).into_iter().filter(|x| x.is_finite()).collect());
        let of_motors: Vec<f64> = match &source.signal {
            Signal::MotorCommand => now.commands.to_vec(),
            Signal::MotorCommandLessYaw => now.less_yaw.to_vec(),
            Signal::MotorMargin => now.commands.iter().map(|e| e.min(1.0 - e)).collect(),
            Signal::MotorMarginHighSide => now.commands.iter().map(|e| 1.0 - e).collect(),
            Signal::Named(name) => return one(signal(name)),
            Signal::Difference { a, b } if a.ends_with("_deg") => {
                let (sin, cos) = (signal(a) - signal(b)).to_radians().sin_cos();
                return one(sin.atan2(cos).to_degrees());
            }
            Signal::Difference { a, b } => return one(signal(a) - signal(b)),
            Signal::Product { a, b } => return one(signal(a) * signal(b)),
            Signal::Ratio {
                a,
                b,
                unknown_below,
            } => {
                let by = Some(signal(b)).filter(|by| *by != 0.0 && by.abs() >= *unknown_below);
                return one(by.map_or(f64::NAN, |by| signal(a) / by));
            }
            other => panic!("{other:?} has no reference"),
        };
        if let Motors::One(motor) = source.motors {
            return one(of_motors.get(motor as usize).copied().unwrap_or(f64::NAN));
        }
        // One unknown motor makes all values unknown.
        let known = match of_motors.iter().any(|e| e.is_nan()) {
            true => Vec::new(),
            false => of_motors,
        };
        let mean = mean(known.iter().map(|e| (1.0, *e)));
        let squares = known.iter().map(|e| (1.0, (e - mean).powi(2)));
        let std = super::window::mean(squares).sqrt();
        of(match source.motors {
            _ if known.is_empty() => vec![],
            Motors::Mean => vec![mean],
            Motors::Std => vec![std],
            Motors::Min => known.into_iter().reduce(f64::min).into_iter().collect(),
            Motors::Max => known.into_iter().reduce(f64::max).into_iter().collect(),
            Motors::Pooled | Motors::One(_) => known,
        })
    }
}

/// The value of each input of a profile after the last sample; `None` if too little is known. Values that ended before `since_s`
/// do not count in long windows.
pub fn values(
    profile: &Profile,
    observed: &[Vec<Observation>],
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
        match source.exponential {
            true => exponential(profile, source, now_s, observed),
            false => value(profile, &source.statistic, &window, observed),
        }
    });
    let values: Vec<Option<f64>> = values.collect();
    let of = |name: &str| {
        let place = profile.inputs.iter().position(|input| input.name == name);
        place.and_then(|place| values[place])
    };
    let with_ratio = profile.inputs.iter().map(|input| {
        let value = of(&input.name)?;
        Some(match &input.ratio {
            None => value,
            Some(Ratio { per, at_least }) => value / of(per)?.max(*at_least),
        })
    });
    with_ratio.collect()
}

/// A statistic of all values so far, with the weight `exp(-age / T)` integrated over their time spans.
fn exponential(
    profile: &Profile,
    source: &Source,
    now_s: f64,
    observed: &[Observation],
) -> Option<f64> {
    let constant_s = source.window_s;
    let falls = |at_s: f64| ((at_s - now_s) / constant_s).exp();
    let known = observed
        .iter()
        .filter(|o| !o.values.is_empty() && o.to_s > o.from_s);
    let inside: Vec<(f64, &Observation)> = known
        .map(|o| (constant_s * (falls(o.to_s) - falls(o.from_s)), o))
        .collect();
    let sampling = &profile.sampling;
    let weight: f64 = inside.iter().map(|(weight, _)| weight).sum();
    let needed_s = 0.99 * sampling.warm_up_s.min(constant_s);
    let needed = constant_s * (1.0 - (-needed_s / constant_s).exp());
    let samples: f64 = inside.iter().map(|(_, o)| falls(o.to_s)).sum();
    if weight < needed || samples.round() < f64::from(sampling.min_samples) {
        return None;
    }
    Some(of_weights(&source.statistic, &inside))
}

/// A statistic of weighted values; the values of one sample share its weight.
fn of_weights(statistic: &Statistic, inside: &[(f64, &Observation)]) -> f64 {
    let mean_of = |f: &dyn Fn(f64) -> f64| {
        let values = inside.iter().flat_map(|(weight, observed)| {
            let weight = weight / observed.values.len() as f64;
            observed.values.iter().map(move |value| (weight, f(*value)))
        });
        mean(values)
    };
    let average = mean_of(&|x| x);
    let variance = mean_of(&|x| (x - average).powi(2));
    let all = || inside.iter().flat_map(|(_, observed)| &observed.values);
    match *statistic {
        Statistic::Mean => average,
        Statistic::Std => variance.sqrt(),
        Statistic::Rms => mean_of(&|x| x * x).sqrt(),
        Statistic::Min => all().copied().fold(f64::INFINITY, f64::min),
        Statistic::Max => all().copied().fold(f64::NEG_INFINITY, f64::max),
        Statistic::ShareBelow(limit) => mean_of(&|x| f64::from(x < limit)),
        Statistic::ShareAbove(limit) => mean_of(&|x| f64::from(x > limit)),
        Statistic::StdLessNoise | Statistic::Noise => {
            let squares = inside
                .iter()
                .map(|(weight, bin)| (*weight, bin.step.powi(2)));
            let noise = (mean(squares) / 2.0).sqrt();
            match statistic {
                Statistic::Noise => noise,
                _ => (variance - noise.powi(2)).max(0.0).sqrt(),
            }
        }
        ref other => panic!("{other:?} is not of weights"),
    }
}

/// A slot of a window: the time of its middle relative to the end of the window, its weight, and the mean of its
/// values.
struct Slot {
    t_s: f64,
    weight: f64,
    value: f64,
}

fn slots(window: &Window, spans: &[(f64, f64)], inside: &[(f64, &Observation)]) -> Vec<Slot> {
    let mut slots = Vec::new();
    let mut rest = inside;
    for spans in window.slots(spans) {
        let (own, later) = rest.split_at(spans.len());
        rest = later;
        let weight = own.iter().map(|(weight, _)| weight).sum();
        if weight > 0.0 {
            slots.push(Slot {
                t_s: (spans[0].0 + spans[spans.len() - 1].1) / 2.0 - window.now_s,
                weight,
                value: of_weights(&Statistic::Mean, own),
            });
        }
    }
    slots
}

/// The slope of the least-squares line, by the sums of its normal equations.
fn rate(slots: &[Slot]) -> Option<f64> {
    let sum =
        |f: &dyn Fn(&Slot) -> f64| slots.iter().map(|slot| slot.weight * f(slot)).sum::<f64>();
    let (weight, t, x) = (sum(&|_| 1.0), sum(&|s| s.t_s), sum(&|s| s.value));
    let (tx, tt) = (sum(&|s| s.t_s * s.value), sum(&|s| s.t_s * s.t_s));
    (slots.len() > 1).then(|| (weight * tx - t * x) / (weight * tt - t * t))
}

/// The value at a percentile, interpolated linearly between the points (percentile, mean) of the slots.
fn percentile(mut slots: Vec<Slot>, percent: f64) -> Option<f64> {
    slots.sort_by(|a, b| a.value.total_cmp(&b.value));
    let all: f64 = slots.iter().map(|slot| slot.weight).sum();
    let mut below = 0.0;
    let points: Vec<(f64, f64)> = slots
        .iter()
        .map(|slot| {
            below += slot.weight;
            (100.0 * (below - slot.weight / 2.0) / all, slot.value)
        })
        .collect();
    let (first, last) = (points.first()?, points.last()?);
    let between = points
        .windows(2)
        .find(|pair| (pair[0].0..pair[1].0).contains(&percent));
    Some(match between {
        Some([a, b]) => {
            let share = (percent - a.0) / (b.0 - a.0);
            a.1 * (1.0 - share) + b.1 * share
        }
        _ if percent < first.0 => first.1,
        _ => last.1,
    })
}

fn value(
    profile: &Profile,
    statistic: &Statistic,
    window: &Window,
    observed: &[Observation],
) -> Option<f64> {
    let begin_s = window.now_s - window.length_s - MORE_S;
    let first = observed.partition_point(|observed| observed.to_s < begin_s);
    let known = observed[first..]
        .iter()
        .filter(|observed| !observed.values.is_empty());
    let mut all: Vec<&Observation> = known.collect();
    if *statistic == Statistic::Last {
        let latest = observed.last()?;
        let count = latest.values.len() as f64;
        return (count > 0.0).then(|| latest.values.iter().sum::<f64>() / count);
    }
    let mut latest = None;
    let of_bins;
    if matches!(statistic, Statistic::StdLessNoise | Statistic::Noise) {
        of_bins = bins(&all);
        all = of_bins.iter().collect();
        latest = all.pop_if(|bin| bin_of(bin.to_s) == bin_of(window.now_s));
    }
    let has_time = |observed: &&Observation| observed.to_s > observed.from_s;
    all.retain(has_time);
    let spans: Vec<(f64, f64)> = all.iter().map(|o| (o.from_s, o.to_s)).collect();
    let mut inside: Vec<(f64, &Observation)> =
        window.weights(&spans).into_iter().zip(all).collect();
    let slots = slots(window, &spans, &inside);
    inside.retain(|(weight, _)| *weight > 0.0);
    // The bin of the latest sample counts in full.
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
    match *statistic {
        Statistic::Rate => rate(&slots),
        Statistic::Percentile(percent) => percentile(slots, percent),
        ref statistic => Some(of_weights(statistic, &inside)),
    }
}

fn bin_of(t_s: f64) -> f64 {
    (t_s / BIN_S + 1e-6).floor()
}

/// The means of the samples of each bin, with the time span of its samples.
fn bins(observed: &[&Observation]) -> Vec<Observation> {
    let of_bins = observed.chunk_by(|a, b| bin_of(a.to_s) == bin_of(b.to_s));
    let mut bins: Vec<Observation> = Vec::new();
    for samples in of_bins {
        let value = mean(samples.iter().map(|sample| (1.0, sample.values[0])));
        let held_s: f64 = samples
            .iter()
            .map(|sample| sample.to_s - sample.from_s)
            .sum();
        let to_s = samples[samples.len() - 1].to_s;
        let before = bins.last().map_or(value, |bin| bin.values[0]);
        bins.push(Observation {
            from_s: to_s - held_s,
            to_s,
            values: vec![value],
            step: value - before,
        });
    }
    bins
}
