//! One flight under evaluation: its steps with the scores of every estimator, its episodes and the warnings on them.

use std::path::Path;

use flagred::{
    evaluation::{ErrorRecord, Judged, Span, judge},
    log,
    monitor::Monitor,
    source::Observer,
    verdict::{Level, VerdictSettings},
};
use flightlog::Flight;

use super::estimators::Estimators;
use crate::{failure::Failure, flights::open_complete};

/// How far apart steps are, in seconds.
const STEP_S: f64 = 0.5;

/// A baseline forgets what was before so long a time without a sample, in seconds.
const LONGEST_GAP_S: f64 = 2.0;

/// Sums of time steps are off by less than this.
const ROUNDING_S: f64 = 1e-6;

/// What became of a flight.
pub(super) struct Record {
    pub(super) file: String,
    pub(super) vehicle: String,
    /// What the flight was about, as its header says: `gusts`, `calm`, `manoeuvre`.
    pub(super) kind: String,
    pub(super) judged_s: f64,
    pub(super) steps: Vec<Step>,
    /// For each profile.
    pub(super) judged: Vec<Judged>,
}

/// A moment and what was said of it.
pub(super) struct Step {
    pub(super) is_critical: bool,
    /// For each estimator; NaN is unknown.
    pub(super) scores: Vec<f64>,
}

/// Evaluates a flight.
///
/// # Errors
///
/// A file that cannot be read or is no flight log, and a flight that lacks motors, attitude or times in the air.
pub(super) fn evaluate(
    path: &Path,
    estimators: &Estimators,
    horizon_s: f64,
) -> Result<Record, Failure> {
    let flight = open_complete(path, &estimators.signals(), "cannot be evaluated")?;
    let file = path.display().to_string();
    let header = |key| log::header(&flight, key).map(str::to_owned);
    let judged = log::judged_spans(&flight, &VerdictSettings::default());
    let errors = ErrorRecord::new(log::attitudes(&flight));
    let times: Vec<(f64, bool)> = judged
        .iter()
        .flat_map(step_times)
        .filter_map(|t_s| Some((t_s, errors.critical_within(t_s, horizon_s)?)))
        .collect();
    let followed = follow(&flight, estimators, &times)?;
    let lost_s = flight
        .in_air
        .iter()
        .filter_map(|air| air.spans.last())
        .find(|span| span.ends_with_log)
        .map(|span| span.end_s);
    Ok(Record {
        vehicle: header("vehicle")
            .or_else(|| flight.vehicle.frame.clone())
            .unwrap_or_else(|| file.clone()),
        kind: header("kind").unwrap_or_else(|| "unnamed".to_owned()),
        file,
        judged_s: judged.iter().map(Span::length_s).sum(),
        steps: followed.steps,
        judged: followed
            .warnings
            .iter()
            .map(|warnings| judge(warnings, errors.episodes(), &judged, lost_s))
            .collect(),
    })
}

fn step_times(span: &Span) -> impl Iterator<Item = f64> + use<> {
    let (from_s, to_s) = (span.from_s, span.to_s);
    (0_u32..)
        .map(move |i| from_s + f64::from(i) * STEP_S)
        .take_while(move |t_s| *t_s <= to_s + ROUNDING_S)
}

struct Followed {
    steps: Vec<Step>,
    /// When each profile warned.
    warnings: Vec<Vec<Span>>,
}

/// A profile on its way through a flight.
struct Running {
    /// `None` where the flight lacks a signal that the profile needs.
    monitor: Option<Monitor>,
    risk_pct: f64,
    warnings: Vec<Span>,
    is_warning: bool,
}

/// Sends the samples of a flight through all estimators; what they say at a time is what they said after the newest sample.
fn follow(
    flight: &Flight,
    estimators: &Estimators,
    times: &[(f64, bool)],
) -> Result<Followed, Failure> {
    let names = log::carried(flight, &estimators.signals());
    let mut running: Vec<Running> = estimators
        .profiles
        .iter()
        .map(|profile| Running {
            monitor: Monitor::new(&profile.estimator, log::craft(flight, &names)).ok(),
            risk_pct: f64::NAN,
            warnings: Vec::new(),
            is_warning: false,
        })
        .collect();
    let baselines = estimators.carried_baselines(&names);
    let sources = baselines.iter().flatten().map(|baseline| &baseline.source);
    let mut observer = Observer::new(sources, log::craft(flight, &names)).map_err(Failure::unreadable)?;

    let mut steps = Vec::with_capacity(times.len());
    let mut last_s = None;
    log::for_each_sample(flight, &names, |sample| {
        while let Some((_, is_critical)) = times
            .get(steps.len())
            .filter(|(t_s, _)| *t_s < sample.t_s - ROUNDING_S)
        {
            steps.push(step(*is_critical, &running, &baselines, &observer));
        }
        let held_s = last_s.map_or(0.0, |last_s| sample.t_s - last_s);
        last_s = Some(sample.t_s);
        if !sample.in_air || !(0.0..=LONGEST_GAP_S).contains(&held_s) {
            observer.clear();
        } else if held_s > 0.0 {
            observer.push(sample.t_s, held_s, sample.motors, sample.signals);
        }
        for running in &mut running {
            let Some(monitor) = &mut running.monitor else {
                continue;
            };
            let update = monitor.push(sample);
            running.risk_pct = update.risk.map_or(f64::NAN, |risk| risk.risk_pct);
            let warns = update.level >= Some(Level::Warn);
            Span::follow(
                &mut running.warnings,
                &mut running.is_warning,
                sample.t_s,
                warns,
            );
        }
    });
    while let Some((_, is_critical)) = times.get(steps.len()) {
        steps.push(step(*is_critical, &running, &baselines, &observer));
    }
    Ok(Followed {
        steps,
        warnings: running.into_iter().map(|r| r.warnings).collect(),
    })
}

fn step(
    is_critical: bool,
    running: &[Running],
    baselines: &[Option<&flagred::evaluation::Baseline>],
    observer: &Observer,
) -> Step {
    let mut observed = 0;
    let baselines = baselines.iter().map(|baseline| {
        let Some(baseline) = baseline else {
            return f64::NAN;
        };
        observed += 1;
        let value = observer.value(observed - 1);
        value.map_or(f64::NAN, |observation| baseline.score(observation.value))
    });
    Step {
        is_critical,
        scores: running
            .iter()
            .map(|r| r.risk_pct)
            .chain(baselines)
            .collect(),
    }
}
