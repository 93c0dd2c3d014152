//! The scores of each estimator: how well it ranks critical cases, over all cases, by vehicle and by kind.

use std::collections::BTreeMap;

use rayon::prelude::*;

use crate::ranking::{
    Areas, Band, Intervals, Prediction, Ranking, RocPoint, WithinGroups, reliability,
};

/// The kind of flight that is reported separately, because its attitude errors result from commanded manoeuvres.
pub(crate) const SEPARATE_KIND: &str = "manoeuvre";

/// The number of resamples of whole flights from which an interval is computed.
pub(crate) const RESAMPLES: usize = 1000;
pub(crate) const SEED: u64 = 1;

/// The number of steps along the drawn curve.
const ROC_STEPS: u32 = 200;

/// A step or a flight with its outcome and scores.
pub struct Case {
    /// The index of the flight.
    pub group: u32,
    /// The time on the flight's clock, in seconds; `None` for a whole flight.
    pub t_s: Option<f64>,
    /// The vehicle.
    pub vehicle: String,
    /// The kind of flight.
    pub kind: String,
    /// Whether the case was critical.
    pub is_critical: bool,
    /// Whether no error was critical in the 5 s before the case.
    pub is_quiet: bool,
    /// Whether no error was critical in the 10 s before the case.
    pub is_onset: bool,
    /// The score of each estimator; NaN is unknown.
    pub scores: Vec<f64>,
}

/// The measures of an estimator over some cases.
pub(crate) struct Scores {
    /// The number of cases with a score.
    pub(crate) cases: usize,
    /// The number of cases without a score.
    pub(crate) unknown: usize,
    pub(crate) critical: usize,
    /// The areas; `None` unless there are both critical and other cases.
    pub(crate) areas: Option<Areas>,
    /// The 95 % intervals of the areas.
    pub(crate) intervals: Option<Intervals>,
    /// The mean area under the ROC curve within single flights; `None` if no flight has both critical and other cases.
    pub(crate) within: Option<WithinGroups>,
}

impl Scores {
    /// The reason why the areas cannot be computed; `cases` is the kind of cases, such as `steps`.
    pub(crate) fn no_area(&self, cases: &str) -> Option<String> {
        let case = cases.trim_end_matches('s');
        match (self.areas, self.cases, self.critical) {
            (Some(_), ..) => None,
            (None, 0, _) if self.unknown == 0 => Some(format!("no {case}")),
            (None, 0, _) => Some("unknown".to_owned()),
            (None, _, 0) => Some(format!("no critical {case}")),
            (None, ..) => Some(format!("only critical {cases}")),
        }
    }
}

/// An evaluated estimator.
pub(crate) struct ProfileScores {
    pub(crate) name: String,
    pub(crate) description: String,
    /// The scores over all kinds except [`SEPARATE_KIND`].
    pub(crate) all: Scores,
    /// The scores over the quiet steps of these kinds.
    pub(crate) quiet: Scores,
    /// The scores over the onsets of these kinds.
    pub(crate) onset: Scores,
    pub(crate) by_vehicle: Vec<(String, Scores)>,
    pub(crate) by_kind: Vec<(String, Scores)>,
    /// The reliability, only for risks in %: other scores have no fixed scale.
    pub(crate) reliability: Option<[Band; 10]>,
    pub(crate) roc: Vec<RocPoint>,
}

/// Scores every estimator; the first `risks` estimators give risks in %. `done` is called after
/// each estimator.
pub(crate) fn score<'a>(
    names: impl Iterator<Item = (&'a str, &'a str)>,
    risks: usize,
    cases: &[Case],
    done: &(dyn Fn() + Sync),
) -> Vec<ProfileScores> {
    let names: Vec<(&str, &str)> = names.collect();
    let all = names.into_par_iter().enumerate().map(|(i, name)| {
        let evaluated = evaluated(i, name, i < risks, cases);
        done();
        evaluated
    });
    all.collect()
}

fn evaluated(
    i: usize,
    (name, description): (&str, &str),
    is_risk: bool,
    cases: &[Case],
) -> ProfileScores {
    let main = || cases.iter().filter(|case| case.kind != SEPARATE_KIND);
    let ranking = Ranking::new(predictions(main(), i));
    let part = |is_in: fn(&Case) -> bool| {
        let cases = || main().filter(|case| is_in(case));
        let ranking = Ranking::new(predictions(cases(), i));
        scores(cases().count(), &ranking, RESAMPLES)
    };
    ProfileScores {
        name: name.to_owned(),
        description: description.to_owned(),
        all: scores(main().count(), &ranking, RESAMPLES),
        quiet: part(|case| case.is_quiet),
        onset: part(|case| case.is_onset),
        by_vehicle: grouped(main(), |case| &case.vehicle)
            .into_iter()
            .map(|(vehicle, cases)| {
                let ranking = Ranking::new(predictions(cases.iter().copied(), i));
                (vehicle.to_owned(), scores(cases.len(), &ranking, 0))
            })
            .collect(),
        by_kind: grouped(cases.iter(), |case| &case.kind)
            .into_iter()
            .map(|(kind, cases)| {
                let ranking = Ranking::new(predictions(cases.iter().copied(), i));
                (kind.to_owned(), scores(cases.len(), &ranking, RESAMPLES))
            })
            .collect(),
        reliability: is_risk.then(|| reliability(predictions(main(), i))),
        roc: ranking.roc(ROC_STEPS),
    }
}

fn predictions<'a>(
    cases: impl Iterator<Item = &'a Case>,
    estimator: usize,
) -> impl Iterator<Item = Prediction> {
    cases.map(move |case| Prediction {
        score: case.scores.get(estimator).copied().unwrap_or(f64::NAN),
        critical: case.is_critical,
        group: case.group,
    })
}

fn scores(cases: usize, ranking: &Ranking, resamples: usize) -> Scores {
    Scores {
        cases: ranking.len(),
        unknown: cases - ranking.len(),
        critical: ranking.critical(),
        areas: ranking.areas(),
        intervals: ranking.bootstrap(resamples, SEED),
        within: ranking.within_groups(resamples, SEED),
    }
}

fn grouped<'a>(
    cases: impl Iterator<Item = &'a Case>,
    key: fn(&Case) -> &String,
) -> BTreeMap<&'a str, Vec<&'a Case>> {
    let mut groups: BTreeMap<&str, Vec<&Case>> = BTreeMap::new();
    for case in cases {
        groups.entry(key(case)).or_default().push(case);
    }
    groups
}

pub(crate) fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    let upper = *values.get(middle)?;
    match values.len() % 2 {
        1 => Some(upper),
        _ => Some((values.get(middle - 1)? + upper) / 2.0),
    }
}
