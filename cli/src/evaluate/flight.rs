//! One flight under evaluation: its steps with the scores of every estimator, its episodes and upsets, and the alarms.

use std::path::Path;

use flagred::{
    attitude::Attitude,
    evaluation::{BaselineObserver, ErrorRecord, Judged, Span, judge, upset_s},
    flight::Finding,
    flight::{Assessor, Verdict},
    log,
    verdict::{Level, VerdictSettings},
};
use flightlog::Flight;

use super::estimators::Estimators;
use crate::{failure::Failure, flights::open_complete};

/// How far apart steps are, in seconds.
const STEP_S: f64 = 0.5;

/// Where the log does not say what is judged, steps begin so many seconds after take-off: the shortest window is full.
const FIRST_STEP_S: f64 = 2.0;

/// A step is quiet without a critical error in so many seconds before it, and an onset after so many.
const QUIET_S: f64 = 5.0;
const ONSET_S: f64 = 10.0;

/// A baseline forgets what was before so long a time without a sample, in seconds.
const LONGEST_GAP_S: f64 = 2.0;

/// Sums of time steps are off by less than this.
const ROUNDING_S: f64 = 1e-6;

/// What became of a flight.
pub(super) struct Record {
    pub(super) file: String,
    /// `None` where the log names no vehicle.
    pub(super) vehicle: Option<String>,
    /// What the flight was about, as its header says: `gusts`, `calm`, `manoeuvre`.
    pub(super) kind: String,
    pub(super) judged_s: f64,
    pub(super) air: Vec<Span>,
    /// The largest attitude error over a second, and the largest tilt, in the air.
    pub(super) largest_error_deg: Option<f64>,
    pub(super) largest_tilt_deg: Option<f64>,
    pub(super) upsets: Vec<Upset>,
    pub(super) steps: Vec<Step>,
    /// For each profile.
    pub(super) said: Vec<Said>,
}

impl Record {
    pub(super) fn vehicle_name(&self) -> &str {
        self.vehicle.as_deref().unwrap_or("unknown")
    }

    pub(super) fn air_s(&self) -> f64 {
        self.air.iter().map(Span::length_s).sum()
    }
}

/// The first upset of a time in the air.
pub(super) struct Upset {
    pub(super) t_s: f64,
    pub(super) air: Span,
}

/// A moment and what was said of it.
pub(super) struct Step {
    pub(super) is_critical: bool,
    pub(super) is_quiet: bool,
    pub(super) is_onset: bool,
    /// For each estimator; NaN is unknown.
    pub(super) scores: Vec<f64>,
}

/// What a profile said of a flight.
#[derive(Default)]
pub(super) struct Said {
    /// `None` is NA.
    pub(super) verdict: Option<Level>,
    /// WARN or FAIL, from raised until last reached; one that turns into the other is one.
    pub(super) alarms: Vec<Span>,
    pub(super) fails: Vec<Span>,
    /// The times at which a level was on, against the episodes.
    pub(super) judged: Judged,
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
    let header = |key| log::header(&flight, key).map(str::to_owned);
    let attitudes: Vec<(f64, Attitude)> = log::attitudes(&flight)
        .filter(|(t_s, _)| flight.is_in_air(*t_s) == Some(true))
        .collect();
    let errors = ErrorRecord::new(attitudes.iter().copied());
    let air: Vec<Span> = flight
        .in_air
        .iter()
        .flat_map(|air| &air.spans)
        .map(|span| Span {
            from_s: span.start_s,
            to_s: span.end_s,
        })
        .collect();
    let upsets: Vec<Upset> = air
        .iter()
        .filter_map(|air| {
            let t_s = upset_s(&errors, &attitudes, *air)?;
            Some(Upset { t_s, air: *air })
        })
        .collect();
    let mut steps = steps(&flight, &upsets, &errors, horizon_s);
    let warned = follow(&flight, estimators, &mut steps)?;
    let lost_s = flight
        .in_air
        .iter()
        .filter_map(|air| air.spans.last())
        .find(|span| span.ends_with_log)
        .map(|span| span.end_s);
    let judged = log::judged_spans(&flight, &VerdictSettings::default());
    let said = warned.into_iter().map(|(mut said, warnings)| {
        said.judged = judge(&warnings, errors.episodes(), &judged, lost_s);
        said
    });
    Ok(Record {
        file: path.display().to_string(),
        vehicle: flight.vehicle.id.clone().or_else(|| header("vehicle")),
        kind: header("kind").unwrap_or_else(|| "unnamed".to_owned()),
        judged_s: judged.iter().map(Span::length_s).sum(),
        largest_error_deg: errors.largest_deg(),
        largest_tilt_deg: attitudes
            .iter()
            .map(|(_, attitude)| attitude.tilt_deg())
            .reduce(f64::max),
        said: said.collect(),
        steps: steps.into_iter().map(|(_, step)| step).collect(),
        upsets,
        air,
    })
}

/// The steps of a flight, without scores yet, where it is known what became of them.
///
/// They are in the judged time that the header of the log gives. Without one they are in the times in the air, from 2 s
/// after take-off to 1 s before landing, each up to its upset.
fn steps(
    flight: &Flight,
    upsets: &[Upset],
    errors: &ErrorRecord,
    horizon_s: f64,
) -> Vec<(f64, Step)> {
    let settings = VerdictSettings {
        quiet_after_take_off_s: FIRST_STEP_S,
        ..VerdictSettings::default()
    };
    let header_says = ["judged_from_s", "judged_to_s"]
        .iter()
        .all(|key| log::header(flight, key).is_some());
    let is_upset = |t_s: f64| {
        let mut upsets = upsets.iter();
        !header_says && upsets.any(|upset| upset.air.contains(t_s) && t_s >= upset.t_s)
    };
    let spans = log::judged_spans(flight, &settings);
    let times = spans.iter().flat_map(step_times);
    times
        .filter(|t_s| !is_upset(*t_s))
        .filter_map(|t_s| {
            let step = Step {
                is_critical: errors.critical_within(t_s, horizon_s)?,
                is_quiet: errors.is_quiet(t_s, QUIET_S),
                is_onset: errors.is_quiet(t_s, ONSET_S),
                scores: Vec::new(),
            };
            Some((t_s, step))
        })
        .collect()
}

fn step_times(span: &Span) -> impl Iterator<Item = f64> + use<> {
    let (from_s, to_s) = (span.from_s, span.to_s);
    (0_u32..)
        .map(move |i| from_s + f64::from(i) * STEP_S)
        .take_while(move |t_s| *t_s <= to_s + ROUNDING_S)
}

/// A profile on its way through a flight.
struct Running {
    /// `None` where the flight lacks a signal that the profile needs.
    assessor: Option<Assessor>,
    risk_pct: f64,
    warnings: Vec<Span>,
    is_warning: bool,
}

/// Sends the samples of a flight through all estimators and fills in the scores of the steps: what an estimator says at a
/// time is what it said after the newest sample. Gives what each profile said, with the times at which a level was on.
fn follow(
    flight: &Flight,
    estimators: &Estimators,
    steps: &mut [(f64, Step)],
) -> Result<Vec<(Said, Vec<Span>)>, Failure> {
    let names = log::carried(flight, &estimators.signals());
    let mut running: Vec<Running> = estimators
        .profiles
        .iter()
        .map(|profile| Running {
            assessor: Assessor::new(&profile.estimator, log::craft(flight, &names), None).ok(),
            risk_pct: f64::NAN,
            warnings: Vec::new(),
            is_warning: false,
        })
        .collect();
    let mut baselines = BaselineObserver::new(&estimators.baselines, log::craft(flight, &names))
        .map_err(Failure::unreadable)?;

    let mut steps = steps.iter_mut().peekable();
    let mut last_s = None;
    log::for_each_sample(flight, &names, |sample| {
        while let Some((_, step)) = steps.next_if(|(t_s, _)| *t_s < sample.t_s - ROUNDING_S) {
            step.scores = scores(&running, &baselines);
        }
        let held_s = last_s.map_or(0.0, |last_s| sample.t_s - last_s);
        last_s = Some(sample.t_s);
        if !sample.in_air || !(0.0..=LONGEST_GAP_S).contains(&held_s) {
            baselines.clear();
        } else if held_s > 0.0 {
            baselines.push(sample.t_s, held_s, sample.motors, sample.signals);
        }
        for running in &mut running {
            let Some(assessor) = &mut running.assessor else {
                continue;
            };
            let update = assessor.push(sample);
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
    for (_, step) in steps {
        step.scores = scores(&running, &baselines);
    }
    let in_air_s = flight.in_air.as_ref().map(flightlog::Intervals::duration_s);
    let said = running.into_iter().map(|running| {
        let assessment = running.assessor.map(|mut assessor| {
            if let Some(in_air_s) = in_air_s {
                assessor.set_in_air_s(in_air_s);
            }
            assessor.finish()
        });
        let said = assessment.map_or_else(Said::default, |assessment| Said {
            verdict: match assessment.verdict {
                Verdict::Known(level) => Some(level),
                Verdict::NotAvailable(_) => None,
            },
            alarms: alarms(&assessment.findings, Level::Warn),
            fails: alarms(&assessment.findings, Level::Fail),
            judged: Judged::default(),
        });
        (said, running.warnings)
    });
    Ok(said.collect())
}

/// The times of findings of a level or a higher one.
fn alarms(findings: &[Finding], least: Level) -> Vec<Span> {
    let findings = findings.iter().filter(|finding| finding.level >= least);
    Span::joined(findings.map(|finding| Span {
        from_s: finding.raised_s,
        to_s: finding.to_s.max(finding.raised_s),
    }))
}

fn scores(running: &[Running], baselines: &BaselineObserver<'_>) -> Vec<f64> {
    let risks = running.iter().map(|running| running.risk_pct);
    let baselines = baselines.scores();
    risks
        .chain(baselines.map(|score| score.unwrap_or(f64::NAN)))
        .collect()
}
