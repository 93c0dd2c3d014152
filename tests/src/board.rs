//! Profiles and flights for tests of on-board monitors, and the updates of these monitors as text.

use std::{fmt::Write, path::PathBuf};

use flagred::{
    board::Factors,
    estimator::Estimator,
    profile::Profile,
    sample::{Estimate, Sample, Update},
    verdict::{Cause, EndedFindings, Finding},
};
use flagred_flightlog::{Flight, Options};

use crate::shared_data;

/// The command-line arguments of profiles for on-board monitors: the shipped profiles with a single risk, and a profile
/// with a signal.
pub const PROFILES: [&str; 3] = [
    "flagred",
    "flagred-paper",
    concat!(env!("CARGO_MANIFEST_DIR"), "/battery/flagred-battery.yaml"),
];

/// The estimator of one of [`PROFILES`].
///
/// # Panics
///
/// The profile does not compile.
#[expect(
    clippy::unwrap_used,
    reason = "a profile of the project that does not compile fails the test"
)]
pub fn estimator(profile: &str) -> Estimator {
    let folder = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../rules"));
    let (profile, rules) = match profile {
        "flagred" => ("profiles/multirotor.yaml", "flagred.yaml"),
        "flagred-paper" => ("profiles/flagred-paper.yaml", "flagred-paper.yaml"),
        _ => (
            concat!(env!("CARGO_MANIFEST_DIR"), "/battery/flagred-battery.yaml"),
            concat!(
                env!("CARGO_MANIFEST_DIR"),
                "/battery/flagred-battery-rules.yaml"
            ),
        ),
    };
    // `join` returns an absolute path unchanged.
    let read = |file: &str| std::fs::read_to_string(folder.join(file)).unwrap();
    let profile = read(profile).parse::<Profile>().unwrap();
    let rules = read(rules);
    let model = fuzzy::yaml::parse(&rules).unwrap().model;
    Estimator::new(&profile, &model).unwrap()
}

/// A [`Sample`] that owns its numbers.
#[derive(Debug, Clone)]
pub struct Moment {
    /// The time in seconds.
    pub t_s: f64,
    /// The effective command of each motor.
    pub motors: Vec<f64>,
    /// Whether the vehicle is in the air.
    pub in_air: bool,
    /// The values of the signals, in the order of the profile.
    pub signals: Vec<f64>,
}

impl Moment {
    /// Returns a sample that borrows these numbers.
    pub fn sample(&self) -> Sample<'_> {
        Sample {
            t_s: self.t_s,
            motors: &self.motors,
            in_air: Some(self.in_air),
            signals: &self.signals,
        }
    }
}

/// The shipped flight, and the reference flights if they are available.
///
/// # Panics
///
/// A folder cannot be read.
#[expect(
    clippy::unwrap_used,
    reason = "a flight that cannot be read fails the test"
)]
pub fn logs() -> Vec<PathBuf> {
    let mut folders = vec![PathBuf::from(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../examples/flights"
    ))];
    folders.extend(shared_data().map(|data| data.join("flights")));
    let mut logs: Vec<PathBuf> = folders
        .iter()
        .flat_map(|folder| std::fs::read_dir(folder).unwrap())
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "BIN"))
        .collect();
    logs.sort();
    logs
}

/// Returns the factors of the motors of a flight; if they are unknown, returns the factors of motors that are
/// arranged on a circle.
///
/// # Panics
///
/// The log cannot be read.
#[expect(
    clippy::unwrap_used,
    reason = "a flight that cannot be read fails the test"
)]
pub fn geometry(log: &std::path::Path) -> Vec<Factors> {
    let flight = flagred_flightlog::open(log, &Options::default()).unwrap();
    let motors = flight.motors.len();
    let on_a_circle = |i: usize| {
        let (sin, cos) = (std::f64::consts::TAU * (i as f64 + 0.5) / motors as f64).sin_cos();
        [-sin, cos, if i.is_multiple_of(2) { 1.0 } else { -1.0 }]
    };
    let known = flight.geometry.map(|geometry| geometry.factors);
    known.unwrap_or_else(|| (0..motors).map(on_a_circle).collect())
}

/// The samples of a flight with the signals of a profile, followed by samples that no log contains: repeated timestamps,
/// jumps, and motors that are unknown or at their limits, on the ground and in the air.
///
/// # Panics
///
/// The log cannot be read.
#[expect(
    clippy::unwrap_used,
    reason = "a flight that cannot be read fails the test"
)]
pub fn moments(log: &std::path::Path, signals: &[&str]) -> Vec<Moment> {
    let flight = flagred_flightlog::open(log, &Options::default()).unwrap();
    let mut moments = samples(&flight, signals);
    let Some(last) = moments.last().cloned() else {
        return moments;
    };
    let odd = [0.0, 1.0, f64::NAN, 0.5, 65535.0, -1.0, f64::INFINITY];
    for i in 0..1500 {
        let mut moment = last.clone();
        moment.in_air = i % 500 > 10;
        moment.t_s += match i % 100 {
            7 => 0.02 * f64::from(i - 3),
            50 => f64::NAN,
            _ => 0.02 * f64::from(i) + if i > 900 { 30.0 } else { 0.0 },
        };
        for (n, motor) in moment.motors.iter_mut().enumerate() {
            let swing = (f64::from(i) * 0.11 * (n + 1) as f64).sin();
            *motor = 0.5 + 0.5 * swing;
            if i % 13 == n as i32 {
                *motor = odd[i as usize % odd.len()];
            }
        }
        for (n, signal) in moment.signals.iter_mut().enumerate() {
            *signal = if i % 60 == 0 {
                f64::NAN
            } else {
                f64::from(i) / 15.0 * (n + 1) as f64
            };
        }
        moments.push(moment);
    }
    moments
}

fn samples(flight: &Flight, names: &[&str]) -> Vec<Moment> {
    let mut holds: Vec<_> = names
        .iter()
        .map(|name| flight.signal(name).map(|signal| signal.hold()))
        .collect();
    let moment = |(t_s, row): (f64, &[f64])| Moment {
        t_s,
        motors: row
            .iter()
            .map(|raw| flight.effective_command(*raw).unwrap_or(f64::NAN))
            .collect(),
        in_air: flight.is_in_air(t_s) == Some(true),
        signals: holds
            .iter_mut()
            .map(|hold| {
                let held = hold.as_mut().and_then(|hold| hold.at(t_s));
                held.unwrap_or(f64::NAN)
            })
            .collect(),
    };
    flight.commands.rows().map(moment).collect()
}

/// A grid over the ranges of a profile's inputs and one step beyond them, with `along` points on each axis.
pub fn points(estimator: &Estimator, along: usize) -> Vec<Vec<f64>> {
    let plan_inputs = estimator.profile().inputs.len();
    let ranges: Vec<(f64, f64)> = match estimator.plan() {
        Ok(plan) => {
            let mut ranges = vec![(0.0, 1.0); plan_inputs];
            for (input, index) in plan.rules.table.inputs.iter().zip(plan.order) {
                // The risk need not depend on every input.
                if let Some(range) = ranges.get_mut(*index as usize) {
                    *range = (input.low, input.high);
                }
            }
            ranges
        }
        Err(_) => vec![(0.0, 1.0); plan_inputs],
    };
    let mut points = vec![vec![]];
    for (low, high) in ranges {
        let step = (high - low) / (along - 3) as f64;
        let at = |i: usize| low + step * (i as f64 - 1.0);
        points = points
            .iter()
            .flat_map(|point| {
                (0..along).map(move |i| {
                    let mut point = point.clone();
                    point.push(at(i));
                    point
                })
            })
            .collect();
    }
    points
}

/// An update as text, bit for bit, in the format of `tests/c/follow.c`.
pub fn reported(update: &Update) -> String {
    use flagred::sample::Unknown;
    let (unknown, input) = match update.risk {
        Ok(_) => (0, -1),
        Err(Unknown::OnGround) => (1, -1),
        Err(Unknown::OutOfOrder) => (2, -1),
        Err(Unknown::WarmingUp { input }) => (3, input as i32),
        Err(Unknown::TooFewSamples { input, .. }) => (4, input as i32),
        Err(Unknown::NoValue { input }) => (5, input as i32),
        Err(Unknown::NoRule) => (6, -1),
        Err(Unknown::NoCommand { .. }) => (7, -1),
        Err(Unknown::CommandOutside { .. }) => (8, -1),
    };
    let level = |level: Option<flagred::verdict::Level>| level.map_or(-1, |level| level as i32);
    let mut text = moment(update.risk.ok().as_ref());
    let elevated = bits(update.elevated_risk_pct.unwrap_or(f64::NAN));
    let (now, change) = (level(update.level), level(update.change));
    let _ = write!(text, " {elevated} {now} {change} {unknown} {input}");
    text + &findings(&update.ended)
}

/// An estimate as text.
pub fn moment(estimate: Option<&Estimate>) -> String {
    let known = |value: fn(&Estimate) -> f64| bits(estimate.map_or(f64::NAN, value));
    format!(
        "{} {} {} {} {}",
        known(|said| said.risk_pct),
        known(|said| said.coverage),
        known(|said| said.filled_from.unwrap_or(f64::NAN)),
        estimate
            .and_then(|said| said.dominant_rule)
            .map_or(-1, |rule| rule as i64),
        i32::from(estimate.is_some_and(|said| said.clamped))
    )
}

/// Findings as text.
pub fn findings(ended: &EndedFindings) -> String {
    ended
        .iter()
        .flatten()
        .map(|finding| {
            let Finding {
                severity,
                from_s,
                raised_s,
                failed_s,
                to_s,
                measure,
                threshold_pct,
                value_pct,
                motor,
                cause,
            } = finding;
            let margin = |value: fn(&flagred::verdict::MotorFinding) -> f64| {
                bits(motor.as_ref().map_or(f64::NAN, value))
            };
            let high = motor.is_some_and(|motor| motor.side == flagred::margin::Side::Upper);
            let of_cause =
                |value: fn(&Cause) -> usize| cause.as_ref().map_or(-1, |cause| value(cause) as i64);
            format!(
                " [{} {} {} {} {} {} {} {} {} {} {} {} {} {} {} {}]",
                *severity as i32,
                bits(*from_s),
                bits(*raised_s),
                bits(failed_s.unwrap_or(f64::NAN)),
                bits(*to_s),
                *measure as i32,
                bits(*threshold_pct),
                bits(*value_pct),
                motor.map_or(-1, |motor| motor.number as i64 - 1),
                i32::from(high),
                margin(|motor| motor.margin_mean),
                margin(|motor| motor.margin_min),
                of_cause(|cause| cause.proposition),
                of_cause(|cause| cause.rule),
                of_cause(|cause| cause.input),
                bits(cause.map_or(f64::NAN, |cause| cause.value))
            )
        })
        .collect()
}

/// The bits of a number; every NaN is `nan`.
fn bits(value: f64) -> String {
    if value.is_nan() {
        "nan".into()
    } else {
        format!("{:016x}", value.to_bits())
    }
}
