//! Measures how well the risks of profiles predict critical attitude errors, compared with predictors without rules.
//!
//! A *step* is a time of a flight with the scores of the [`Estimators`]: the risks of profiles, and the [`Baseline`]s.
//! It is critical if the attitude error, root mean square over a second, exceeds 5 degrees within a horizon after it
//! ([`ErrorRecord`]). The measures of an estimator are how well it ranks critical steps above the others ([`Ranking`]),
//! how often steps with a given risk were critical ([`reliability`]), and which episodes its warnings announce
//! ([`match_warnings`]).
//!
//! A [`Record`] is a flight with its steps. An [`Evaluation`] contains the measures over many of them and can be output
//! as text ([`words`]), as a [`Document`] for programs, as a picture ([`svg`]) and as a [`page`]. [`learning`] measures
//! the errors of learned rules.

mod alarms;
mod attitude;
mod baseline;
mod bootstrap;
mod calm;
mod complete;
mod critical;
mod document;
mod estimators;
mod files;
mod flight;
pub mod learning;
pub mod page;
mod random;
mod ranking;
pub mod recipe;
mod rows;
mod scores;
mod span;
pub mod svg;
mod tables;
mod upset;
mod warning_matches;
mod warnings;
pub mod words;

use serde::Serialize;

pub use attitude::{risk_pct, rmse_deg};
pub use baseline::{Baseline, BaselineObserver, PerMotor};
pub use bootstrap::{Interval, bootstrap};
pub use calm::calm_stretches;
pub use complete::{
    Incomplete, complete, complete_options, header, judged_by_header, judged_spans,
};
pub use critical::ErrorRecord;
pub use document::Document;
pub use estimators::Estimators;
pub use files::{Candidate, files};
pub use flight::{FlightError, Record};
pub use ranking::{
    Areas, Band, Intervals, Prediction, Ranking, RocPoint, WithinGroups, reliability,
};
pub use rows::{ERROR, FlightTable, cases};
pub use scores::Case;
pub use span::Span;
pub use upset::{UpsetAlarm, upset_s};
pub use warning_matches::{EpisodeMatch, Warning, WarningMatches, match_warnings};

use alarms::Alarms;
use scores::{ProfileScores, SEPARATE_KIND};
use warnings::Warnings;

/// A file that is not among the evaluated flights, and the reason.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LeftOutFile {
    /// The name of the file.
    file: String,
    /// The reason why the file was left out.
    reason: String,
}

impl LeftOutFile {
    /// Creates an entry for a file; the reason does not repeat its name.
    pub fn new(file: String, why: &FlightError) -> LeftOutFile {
        let reason = why.to_string().replace(&format!("`{file}`"), "");
        let reason = reason.trim_start_matches([' ', ',']).to_owned();
        LeftOutFile { file, reason }
    }
}

/// The results of an evaluation.
pub struct Evaluation {
    /// The kind of cases: `steps` or `flights`.
    cases: &'static str,
    horizon_s: Option<f64>,
    flights: usize,
    critical: usize,
    left_out: Vec<LeftOutFile>,
    estimators: Vec<ProfileScores>,
    /// The warnings of each profile: over all flights, and by kind.
    warnings: Vec<(Warnings, Vec<(String, Warnings)>)>,
    alarms: Vec<Alarms>,
    records: Vec<Record>,
    all: Vec<Case>,
}

impl Evaluation {
    /// Evaluates flights that were read with the same estimators and horizon; `None` if they have no step. `done` is
    /// called after each estimator.
    pub fn of_flights(
        estimators: &Estimators,
        horizon_s: f64,
        mut records: Vec<Record>,
        left_out: Vec<LeftOutFile>,
        done: &(dyn Fn() + Sync),
    ) -> Option<Evaluation> {
        let cases: Vec<Case> = records
            .iter_mut()
            .zip(0..)
            .flat_map(|(record, group)| {
                let vehicle = record.vehicle_name().to_owned();
                let kind = record.kind.clone();
                record.steps.iter_mut().map(move |step| Case {
                    group,
                    t_s: Some(step.t_s),
                    vehicle: vehicle.clone(),
                    kind: kind.clone(),
                    is_critical: step.is_critical,
                    is_quiet: step.is_quiet,
                    is_onset: step.is_onset,
                    scores: std::mem::take(&mut step.scores),
                })
            })
            .collect();
        if cases.is_empty() {
            return None;
        }
        let main = records.iter().filter(|record| record.kind != SEPARATE_KIND);
        let profiles = 0..estimators.profiles.len();
        Some(Evaluation {
            cases: "steps",
            horizon_s: Some(horizon_s),
            flights: main.count(),
            left_out,
            warnings: profiles
                .clone()
                .map(|profile| Warnings::by_kind(profile, &records))
                .collect(),
            alarms: profiles
                .map(|profile| Alarms::of(profile, &records))
                .collect(),
            records,
            ..Evaluation::of_cases(estimators, cases, done)
        })
    }

    /// Evaluates cases that are whole flights. `done` is called after each estimator.
    pub fn of_cases(
        estimators: &Estimators,
        cases: Vec<Case>,
        done: &(dyn Fn() + Sync),
    ) -> Evaluation {
        let main = || cases.iter().filter(|case| case.kind != SEPARATE_KIND);
        let (names, risks) = (estimators.names(), estimators.profiles.len());
        Evaluation {
            cases: "flights",
            horizon_s: None,
            flights: main().count(),
            critical: main().filter(|case| case.is_critical).count(),
            left_out: Vec::new(),
            estimators: scores::score(names, risks, &cases, done),
            warnings: Vec::new(),
            alarms: Vec::new(),
            records: Vec::new(),
            all: cases,
        }
    }

    /// The steps or flights that were evaluated.
    pub fn cases(&self) -> &[Case] {
        &self.all
    }

    /// The flights that were evaluated; none if the cases are whole flights.
    pub fn records(&self) -> &[Record] {
        &self.records
    }

    /// The points of an estimator's ROC curve: false and true positive rate.
    pub fn roc(&self, estimator: usize) -> impl Iterator<Item = (f64, f64)> + '_ {
        let evaluated = self.estimators.get(estimator);
        // Without an area there is no curve.
        let evaluated = evaluated.filter(|evaluated| evaluated.all.areas.is_some());
        let points = evaluated.into_iter().flat_map(|evaluated| &evaluated.roc);
        points.map(|point| (point.false_positive_rate, point.true_positive_rate))
    }
}

/// Runs the example of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
