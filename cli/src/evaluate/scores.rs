//! How well each estimator ranks what became critical, over everything, by vehicle and by kind.

use std::collections::BTreeMap;

use flagred::evaluation::{
    Areas, Band, Intervals, Prediction, Ranking, RocPoint, WithinGroups, reliability,
};

use crate::parallel;

/// The kind of flight that is reported apart: its attitude errors are real, but commanded.
pub(super) const APART: &str = "manoeuvre";

/// How often whole flights are drawn for an interval, and from which seed.
pub(super) const RESAMPLES: usize = 1000;
pub(super) const SEED: u64 = 1;

/// Steps along the curve that is drawn.
const ROC_STEPS: u32 = 200;

/// A moment or a flight that was predicted.
pub(super) struct Case {
    /// The number of its flight.
    pub(super) group: u32,
    pub(super) vehicle: String,
    pub(super) kind: String,
    pub(super) is_critical: bool,
    /// No critical error in the 5 s before, and none in the 10 s before.
    pub(super) is_quiet: bool,
    pub(super) is_onset: bool,
    /// For each estimator; NaN is unknown.
    pub(super) scores: Vec<f64>,
}

/// What an estimator comes to.
pub(super) struct Scores {
    /// The cases in which it said something.
    pub(super) cases: usize,
    /// Those in which it did not.
    pub(super) unknown: usize,
    pub(super) critical: usize,
    /// `None` where all cases are critical, or none is.
    pub(super) areas: Option<Areas>,
    pub(super) intervals: Option<Intervals>,
    /// Within single flights; `None` where none has critical cases and others.
    pub(super) within: Option<WithinGroups>,
}

impl Scores {
    /// Why there is no area; `cases` is what the cases are: `steps`.
    pub(super) fn no_area(&self, cases: &str) -> Option<String> {
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

/// An estimator under evaluation.
pub(super) struct Evaluated {
    pub(super) name: String,
    pub(super) description: String,
    /// Over all kinds but the one apart.
    pub(super) all: Scores,
    /// Over the quiet steps of those, and over the onsets.
    pub(super) quiet: Scores,
    pub(super) onset: Scores,
    pub(super) by_vehicle: Vec<(String, Scores)>,
    pub(super) by_kind: Vec<(String, Scores)>,
    /// Of risks in %; other scores have no scale.
    pub(super) reliability: Option<[Band; 10]>,
    pub(super) roc: Vec<RocPoint>,
}

/// Scores every estimator; the first `risks` of them give risks in %.
pub(super) fn score<'a>(
    names: impl Iterator<Item = (&'a str, &'a str)>,
    risks: usize,
    cases: &[Case],
) -> Vec<Evaluated> {
    let names: Vec<(usize, (&str, &str))> = names.enumerate().collect();
    let mut all = Vec::with_capacity(names.len());
    parallel::in_order(
        &names,
        "estimators",
        |(i, name)| evaluated(*i, *name, *i < risks, cases),
        |_, evaluated| {
            all.push(evaluated);
            true
        },
    );
    all
}

fn evaluated(
    i: usize,
    (name, description): (&str, &str),
    is_risk: bool,
    cases: &[Case],
) -> Evaluated {
    let main = || cases.iter().filter(|case| case.kind != APART);
    let ranking = Ranking::new(predictions(main(), i));
    let part = |is_in: fn(&Case) -> bool| {
        let cases = || main().filter(|case| is_in(case));
        let ranking = Ranking::new(predictions(cases(), i));
        scores(cases().count(), &ranking, RESAMPLES)
    };
    Evaluated {
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

pub(super) fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    let upper = *values.get(middle)?;
    match values.len() % 2 {
        1 => Some(upper),
        _ => Some((values.get(middle - 1)? + upper) / 2.0),
    }
}
