//! How well each estimator ranks what became critical, over everything, by vehicle and by kind.

use std::collections::BTreeMap;

use flagred::evaluation::{Areas, Band, Intervals, Prediction, Ranking, RocPoint, reliability};

use crate::parallel;

/// The kind of flight that is reported apart: its attitude errors are real, but commanded.
pub(super) const APART: &str = "manoeuvre";

/// How often whole flights are drawn for an interval, and from which seed.
const RESAMPLES: usize = 1000;
const SEED: u64 = 1;

/// Steps along the curve that is drawn.
const ROC_STEPS: u32 = 200;

/// A moment or a flight that was predicted.
pub(super) struct Case {
    /// The number of its flight.
    pub(super) group: u32,
    pub(super) vehicle: String,
    pub(super) kind: String,
    pub(super) is_critical: bool,
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
}

/// An estimator under evaluation.
pub(super) struct Evaluated {
    pub(super) name: String,
    pub(super) description: String,
    /// Over all kinds but the one apart.
    pub(super) all: Scores,
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
    Evaluated {
        name: name.to_owned(),
        description: description.to_owned(),
        all: scores(main().count(), &ranking, RESAMPLES),
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
