//! The evaluation of one flight: its steps with the scores of every estimator, its episodes and upsets, and the alarms.

use std::path::Path;

use flagred::{
    flight::{Assessor, Finding, Verdict},
    log,
    verdict::{Level, VerdictSettings},
};
use flagred_flightlog::{Attitude, Flight, ReadError};

use crate::{
    baseline::BaselineObserver,
    calm::calm_stretches,
    complete::{Incomplete, complete, complete_options, header, judged_by_header, judged_spans},
    critical::ErrorRecord,
    estimators::Estimators,
    span::Span,
    upset::upset_s,
    warning_matches::{WarningMatches, match_warnings},
};

/// The distance between steps, in seconds.
const STEP_S: f64 = 0.5;

/// Steps begin this time after take-off, in seconds, unless the log defines the judged time. By then the shortest
/// window is full.
const FIRST_STEP_S: f64 = 2.0;

/// A step is quiet if no critical error occurred within this many seconds before it.
const QUIET_S: f64 = 5.0;
/// A step is an onset if no critical error occurred within this many seconds before it.
const ONSET_S: f64 = 10.0;

/// A baseline is reset after this time without a sample, in seconds.
const LONGEST_GAP_S: f64 = 2.0;

/// A tolerance for sums of time steps, in seconds.
const ROUNDING_S: f64 = 1e-6;

/// An evaluated flight.
pub struct Record {
    pub(crate) file: String,
    /// The vehicle; `None` if the log does not identify it.
    pub(crate) vehicle: Option<String>,
    /// The kind of flight, from its header: `gusts`, `calm`, `manoeuvre`.
    pub(crate) kind: String,
    pub(crate) judged_s: f64,
    pub(crate) air: Vec<Span>,
    /// The calm stretches.
    pub(crate) calm: Vec<Span>,
    /// The largest attitude error over a second in the air, in degrees.
    pub(crate) largest_error_deg: Option<f64>,
    /// The largest tilt in the air, in degrees.
    pub(crate) largest_tilt_deg: Option<f64>,
    pub(crate) upsets: Vec<Upset>,
    pub(crate) steps: Vec<ScoredTime>,
    /// The results of each profile.
    pub(crate) results: Vec<ProfileResult>,
}

/// The first upset in a period in the air.
pub(crate) struct Upset {
    pub(crate) t_s: f64,
    pub(crate) air: Span,
}

/// A time of the flight, with the scores of the estimators at that time.
pub(crate) struct ScoredTime {
    pub(crate) t_s: f64,
    pub(crate) is_critical: bool,
    pub(crate) is_quiet: bool,
    pub(crate) is_onset: bool,
    /// The score of each estimator; NaN is unknown.
    pub(crate) scores: Vec<f64>,
}

/// The results of a profile for a flight.
#[derive(Default)]
pub(crate) struct ProfileResult {
    /// The verdict; `None` is NA.
    pub(crate) verdict: Option<Level>,
    /// The periods of WARN or FAIL, each from the time a level is raised until it is last reached. A WARN that is
    /// raised to FAIL counts as one period.
    pub(crate) alarms: Vec<Span>,
    pub(crate) fails: Vec<Span>,
    /// The periods during which the level was WARN or FAIL, matched with the critical episodes.
    pub(crate) matches: WarningMatches,
}

/// The reason why a flight cannot be evaluated.
#[derive(Debug, thiserror::Error)]
pub enum FlightError {
    /// The file cannot be read, or is not a flight log.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// Motors, attitude or times in the air are missing.
    #[error("`{name}` cannot be evaluated: {lacks}")]
    Incomplete {
        /// The name of the flight for the user.
        name: String,
        /// Description of the missing information.
        lacks: Incomplete,
    },
    /// The baselines cannot be computed for the flight.
    #[error("`{name}` cannot be evaluated: {problem}")]
    Baselines {
        /// The name of the flight for the user.
        name: String,
        /// The reason.
        problem: String,
    },
}

impl FlightError {
    /// Advice on what to do, in addition to the message.
    pub fn help(&self) -> Option<&str> {
        match self {
            FlightError::Read(error) => error.help(),
            FlightError::Incomplete { lacks, .. } => lacks.help(),
            FlightError::Baselines { .. } => None,
        }
    }
}

impl Record {
    /// Reads a log and evaluates the flight.
    ///
    /// # Errors
    /// If the file cannot be read or is not a flight log, and in the cases of [`Record::new`].
    pub fn read(
        path: &Path,
        estimators: &Estimators,
        horizon_s: f64,
    ) -> Result<Record, FlightError> {
        let flight = flagred_flightlog::open(path, &complete_options(&estimators.signals()))?;
        Record::new(&path.display().to_string(), &flight, estimators, horizon_s)
    }

    /// Evaluates a flight; the risk should predict critical errors within `horizon_s` seconds.
    ///
    /// # Errors
    /// If motors, attitude or times in the air are missing, or if the reader left part of the flight out.
    pub fn new(
        name: &str,
        flight: &Flight,
        estimators: &Estimators,
        horizon_s: f64,
    ) -> Result<Record, FlightError> {
        complete(flight).map_err(|lacks| FlightError::Incomplete {
            name: name.to_owned(),
            lacks,
        })?;
        let named = |key| header(flight, key).map(str::to_owned);
        let attitudes: Vec<(f64, Attitude)> = flight
            .attitudes()
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
        let mut steps = steps(flight, &upsets, &errors, horizon_s);
        let warned =
            follow(flight, estimators, &mut steps).map_err(|problem| FlightError::Baselines {
                name: name.to_owned(),
                problem,
            })?;
        let lost_s = flight
            .in_air
            .iter()
            .filter_map(|air| air.spans.last())
            .find(|span| span.ends_with_log)
            .map(|span| span.end_s);
        let judged = judged_spans(flight, &VerdictSettings::default());
        let results = warned.into_iter().map(|(mut result, warnings)| {
            result.matches = match_warnings(&warnings, errors.episodes(), &judged, lost_s);
            result
        });
        Ok(Record {
            file: name.to_owned(),
            vehicle: flight.vehicle.id.clone().or_else(|| named("vehicle")),
            kind: named("kind").unwrap_or_else(|| "unnamed".to_owned()),
            judged_s: judged.iter().map(Span::length_s).sum(),
            largest_error_deg: errors.largest_deg(),
            largest_tilt_deg: attitudes
                .iter()
                .map(|(_, attitude)| attitude.tilt_deg())
                .reduce(f64::max),
            calm: air
                .iter()
                .flat_map(|air| calm_stretches(&errors, &attitudes, *air))
                .collect(),
            results: results.collect(),
            steps,
            upsets,
            air,
        })
    }

    /// The name of the file of the log.
    pub fn file(&self) -> &str {
        &self.file
    }

    pub(crate) fn vehicle_name(&self) -> &str {
        self.vehicle.as_deref().unwrap_or("unknown")
    }

    pub(crate) fn air_s(&self) -> f64 {
        self.air.iter().map(Span::length_s).sum()
    }
}

/// The steps of a flight, without scores yet, at the times for which the outcome is known.
///
/// The steps are in the judged time of the log's header. If the header has none, they are in the times in the air, from
/// 2 s after take-off to 1 s before landing, and end at an upset.
fn steps(
    flight: &Flight,
    upsets: &[Upset],
    errors: &ErrorRecord,
    horizon_s: f64,
) -> Vec<ScoredTime> {
    let settings = VerdictSettings {
        quiet_after_take_off_s: FIRST_STEP_S,
        ..VerdictSettings::default()
    };
    let header_says = judged_by_header(flight).is_some();
    let is_upset = |t_s: f64| {
        let mut upsets = upsets.iter();
        !header_says && upsets.any(|upset| upset.air.contains(t_s) && t_s >= upset.t_s)
    };
    let spans = judged_spans(flight, &settings);
    let times = spans.iter().flat_map(step_times);
    times
        .filter(|t_s| !is_upset(*t_s))
        .filter_map(|t_s| {
            Some(ScoredTime {
                t_s,
                is_critical: errors.critical_within(t_s, horizon_s)?,
                is_quiet: errors.is_quiet(t_s, QUIET_S),
                is_onset: errors.is_quiet(t_s, ONSET_S),
                scores: Vec::new(),
            })
        })
        .collect()
}

fn step_times(span: &Span) -> impl Iterator<Item = f64> + use<> {
    let (from_s, to_s) = (span.from_s, span.to_s);
    (0_u32..)
        .map(move |i| from_s + f64::from(i) * STEP_S)
        .take_while(move |t_s| *t_s <= to_s + ROUNDING_S)
}

/// The state of a profile during a flight.
struct ProfileState {
    /// `None` if a signal that the profile needs is missing from the flight.
    assessor: Option<Assessor>,
    risk_pct: f64,
    warnings: Vec<Span>,
    is_warning: bool,
}

/// Passes the samples of a flight to all estimators, and stores in each step the scores after the last sample before
/// the step. Returns the results of each profile.
fn follow(
    flight: &Flight,
    estimators: &Estimators,
    steps: &mut [ScoredTime],
) -> Result<Vec<(ProfileResult, Vec<Span>)>, String> {
    let names = log::carried(flight, &estimators.signals());
    let mut running: Vec<ProfileState> = estimators
        .profiles
        .iter()
        .map(|profile| ProfileState {
            assessor: Assessor::new(&profile.estimator, log::craft(flight, &names), None).ok(),
            risk_pct: f64::NAN,
            warnings: Vec::new(),
            is_warning: false,
        })
        .collect();
    let mut baselines = BaselineObserver::new(&estimators.baselines, log::craft(flight, &names))?;

    let mut steps = steps.iter_mut().peekable();
    let mut last_s = None;
    log::for_each_sample(flight, &names, |sample| {
        while let Some(step) = steps.next_if(|step| step.t_s < sample.t_s - ROUNDING_S) {
            step.scores = scores(&running, &baselines);
        }
        let held_s = last_s.map_or(0.0, |last_s| sample.t_s - last_s);
        last_s = Some(sample.t_s);
        if sample.is_on_ground() || !(0.0..=LONGEST_GAP_S).contains(&held_s) {
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
    for step in steps {
        step.scores = scores(&running, &baselines);
    }
    let in_air_s = flight
        .in_air
        .as_ref()
        .map(flagred_flightlog::Intervals::duration_s);
    let results = running.into_iter().map(|running| {
        let assessment = running.assessor.map(|mut assessor| {
            if let Some(in_air_s) = in_air_s {
                assessor.set_in_air_s(in_air_s);
            }
            assessor.finish()
        });
        let result = assessment.map_or_else(ProfileResult::default, |assessment| ProfileResult {
            verdict: match assessment.verdict {
                Verdict::Known(level) => Some(level),
                Verdict::NotAvailable(_) => None,
            },
            alarms: alarms(&assessment.findings, Level::Warn),
            fails: alarms(&assessment.findings, Level::Fail),
            matches: WarningMatches::default(),
        });
        (result, running.warnings)
    });
    Ok(results.collect())
}

/// Returns the periods of the findings whose severity is at least the given level.
fn alarms(findings: &[Finding], least: Level) -> Vec<Span> {
    let findings = findings.iter().filter(|finding| finding.severity >= least);
    Span::joined(findings.map(|finding| Span {
        from_s: finding.raised_s,
        to_s: finding.to_s.max(finding.raised_s),
    }))
}

fn scores(running: &[ProfileState], baselines: &BaselineObserver<'_>) -> Vec<f64> {
    let risks = running.iter().map(|running| running.risk_pct);
    let baselines = baselines.scores();
    risks
        .chain(baselines.map(|score| score.unwrap_or(f64::NAN)))
        .collect()
}
