//! The evaluation for programs: one JSON document.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::{
    Evaluation, LeftOut,
    alarms::{Alarms, Figure, Needless, Upsets},
    announced::{Answer, Warning},
    bootstrap::Interval,
    flight::{Record, Said},
    ranking::Band,
    scores::{Evaluated, Scores},
    span::Span,
    warnings::Warnings,
};

/// The version of the document's layout; it grows when a name changes its meaning or goes.
const SCHEMA: &str = "flagred.evaluate/1";

/// The document of an evaluation: what `flagred validate --json` prints.
#[derive(Serialize)]
pub struct Document<'a> {
    schema: &'static str,
    cases: &'static str,
    horizon_s: Option<f64>,
    flights: usize,
    steps: Option<usize>,
    left_out: usize,
    left_out_files: &'a [LeftOut],
    estimators: Vec<EstimatorDocument<'a>>,
    records: Vec<RecordDocument<'a>>,
}

#[derive(Serialize)]
struct EstimatorDocument<'a> {
    name: &'a str,
    description: &'a str,
    #[serde(flatten)]
    all: ScoresDocument,
    /// Only of steps, which have a time before and after.
    #[serde(skip_serializing_if = "Option::is_none")]
    quiet: Option<ScoresDocument>,
    #[serde(skip_serializing_if = "Option::is_none")]
    onset: Option<ScoresDocument>,
    by_vehicle: Vec<OfVehicle<'a>>,
    by_kind: Vec<OfKind<'a, ScoresDocument>>,
    reliability: Option<Vec<BandDocument>>,
    /// Only of profiles.
    #[serde(skip_serializing_if = "Option::is_none")]
    warnings: Option<ProfileWarnings<'a>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    alarms: Option<AlarmsDocument<'a>>,
}

#[derive(Serialize)]
struct OfVehicle<'a> {
    vehicle: &'a str,
    #[serde(flatten)]
    scores: ScoresDocument,
}

#[derive(Serialize)]
struct OfKind<'a, T> {
    kind: &'a str,
    #[serde(flatten)]
    of: T,
}

#[derive(Serialize)]
struct ScoresDocument {
    auc: Option<f64>,
    auc_interval: Option<[f64; 2]>,
    pr_auc: Option<f64>,
    pr_auc_interval: Option<[f64; 2]>,
    no_auc: Option<String>,
    within_flight_auc: Option<f64>,
    within_flight_auc_interval: Option<[f64; 2]>,
    within_flight_flights: usize,
    cases: usize,
    critical: usize,
    unknown: usize,
}

#[derive(Serialize)]
struct BandDocument {
    from_pct: f64,
    to_pct: f64,
    cases: u64,
    critical: u64,
    critical_share: Option<f64>,
    risk_mean_pct: Option<f64>,
}

#[derive(Serialize)]
struct ProfileWarnings<'a> {
    #[serde(flatten)]
    all: WarningsDocument<'a>,
    by_kind: Vec<OfKind<'a, WarningsDocument<'a>>>,
}

#[derive(Serialize)]
struct WarningsDocument<'a> {
    #[serde(flatten)]
    counts: &'a Warnings,
    announced_share: Option<f64>,
    groups_announced_share: Option<f64>,
    false_per_hour: Option<f64>,
}

#[derive(Serialize)]
struct AlarmsDocument<'a> {
    calm_stretches: NeedlessDocument,
    ordinary_flights: NeedlessDocument,
    upsets: UpsetsDocument<'a>,
    upsets_by_fail: UpsetsDocument<'a>,
    by_kind: Vec<OfKind<'a, AlarmsOfKind<'a>>>,
}

#[derive(Serialize)]
struct AlarmsOfKind<'a> {
    calm_stretches: NeedlessDocument,
    upsets: UpsetsDocument<'a>,
}

#[derive(Serialize)]
struct NeedlessDocument {
    flights: usize,
    not_assessed: usize,
    hours: f64,
    verdicts: Verdicts,
    alarms: usize,
    alarms_per_hour: Option<f64>,
    alarms_per_hour_interval: Option<[f64; 2]>,
    fails: usize,
    fails_per_hour: Option<f64>,
    fails_per_hour_interval: Option<[f64; 2]>,
    share_of_time_on: Option<f64>,
    share_of_time_on_interval: Option<[f64; 2]>,
}

#[derive(Serialize)]
#[serde(rename_all = "UPPERCASE")]
struct Verdicts {
    good: usize,
    warn: usize,
    fail: usize,
}

#[derive(Serialize)]
struct UpsetsDocument<'a> {
    assessed: usize,
    #[serde(flatten)]
    upsets: &'a Upsets,
}

/// A flight with its episodes, and the warnings of each profile.
#[derive(Serialize)]
struct RecordDocument<'a> {
    file: &'a str,
    vehicle: Option<&'a str>,
    kind: &'a str,
    judged_s: f64,
    in_air_s: f64,
    largest_error_deg: Option<f64>,
    upsets_s: Vec<f64>,
    steps: usize,
    critical: usize,
    profiles: BTreeMap<&'a str, SaidDocument<'a>>,
}

#[derive(Serialize)]
struct SaidDocument<'a> {
    verdict: String,
    alarms: &'a [Span],
    fails: &'a [Span],
    episodes: Vec<EpisodeDocument>,
    warnings: Vec<WarningDocument>,
}

#[derive(Serialize)]
struct EpisodeDocument {
    #[serde(flatten)]
    episode: Span,
    warned_s: Option<f64>,
    lead_s: Option<f64>,
}

#[derive(Serialize)]
struct WarningDocument {
    #[serde(flatten)]
    span: Span,
    r#false: bool,
}

impl<'a> Document<'a> {
    /// Of an evaluation.
    pub fn new(evaluation: &'a Evaluation) -> Document<'a> {
        let first = evaluation.estimators.first();
        let estimators = evaluation.estimators.iter().enumerate();
        let records = evaluation.records.iter();
        Document {
            schema: SCHEMA,
            cases: evaluation.cases,
            horizon_s: evaluation.horizon_s,
            flights: evaluation.flights,
            steps: first.map(|e| e.all.cases + e.all.unknown),
            left_out: evaluation.left_out.len(),
            left_out_files: &evaluation.left_out,
            estimators: estimators
                .map(|(i, evaluated)| EstimatorDocument::new(i, evaluated, evaluation))
                .collect(),
            records: records
                .map(|record| RecordDocument::new(record, evaluation))
                .collect(),
        }
    }
}

impl<'a> EstimatorDocument<'a> {
    fn new(i: usize, evaluated: &'a Evaluated, evaluation: &'a Evaluation) -> Self {
        let scores = |scores| ScoresDocument::new(scores, evaluation.cases);
        let has_times = evaluation.horizon_s.is_some();
        let by_vehicle = evaluated.by_vehicle.iter();
        let by_kind = evaluated.by_kind.iter();
        EstimatorDocument {
            name: &evaluated.name,
            description: &evaluated.description,
            all: scores(&evaluated.all),
            quiet: has_times.then(|| scores(&evaluated.quiet)),
            onset: has_times.then(|| scores(&evaluated.onset)),
            by_vehicle: by_vehicle
                .map(|(vehicle, of)| OfVehicle {
                    vehicle,
                    scores: scores(of),
                })
                .collect(),
            by_kind: by_kind
                .map(|(kind, of)| OfKind {
                    kind,
                    of: scores(of),
                })
                .collect(),
            reliability: evaluated
                .reliability
                .as_ref()
                .map(|bands| bands.iter().map(BandDocument::new).collect()),
            warnings: evaluation
                .warnings
                .get(i)
                .map(|(all, by_kind)| ProfileWarnings {
                    all: WarningsDocument::new(all),
                    by_kind: by_kind
                        .iter()
                        .map(|(kind, of)| OfKind {
                            kind,
                            of: WarningsDocument::new(of),
                        })
                        .collect(),
                }),
            alarms: evaluation.alarms.get(i).map(AlarmsDocument::new),
        }
    }
}

fn ends(interval: Interval) -> [f64; 2] {
    [interval.low, interval.high]
}

impl ScoresDocument {
    fn new(scores: &Scores, cases: &str) -> Self {
        ScoresDocument {
            auc: scores.areas.map(|a| a.roc),
            auc_interval: scores.intervals.map(|i| ends(i.roc)),
            pr_auc: scores.areas.map(|a| a.precision_recall),
            pr_auc_interval: scores.intervals.map(|i| ends(i.precision_recall)),
            no_auc: scores.no_area(cases),
            within_flight_auc: scores.within.map(|within| within.roc),
            within_flight_auc_interval: scores.within.and_then(|within| within.interval).map(ends),
            within_flight_flights: scores.within.map_or(0, |within| within.groups),
            cases: scores.cases,
            critical: scores.critical,
            unknown: scores.unknown,
        }
    }
}

impl BandDocument {
    fn new(band: &Band) -> Self {
        let is_known = band.predictions > 0;
        BandDocument {
            from_pct: band.from_pct,
            to_pct: band.to_pct,
            cases: band.predictions,
            critical: band.critical,
            critical_share: is_known.then(|| band.critical as f64 / band.predictions as f64),
            risk_mean_pct: band.mean_risk_pct,
        }
    }
}

impl<'a> WarningsDocument<'a> {
    fn new(counts: &'a Warnings) -> Self {
        let share = |part: usize, whole: usize| (whole > 0).then(|| part as f64 / whole as f64);
        WarningsDocument {
            counts,
            announced_share: share(counts.announced, counts.episodes),
            groups_announced_share: share(counts.groups_announced, counts.groups),
            false_per_hour: counts.false_per_hour(),
        }
    }
}

impl<'a> AlarmsDocument<'a> {
    fn new(alarms: &'a Alarms) -> Self {
        let by_kind = alarms.by_kind.iter().map(|(kind, calm, upsets)| {
            let of = AlarmsOfKind {
                calm_stretches: NeedlessDocument::new(calm),
                upsets: UpsetsDocument::new(upsets),
            };
            OfKind { kind, of }
        });
        AlarmsDocument {
            calm_stretches: NeedlessDocument::new(&alarms.calm),
            ordinary_flights: NeedlessDocument::new(&alarms.ordinary),
            upsets: UpsetsDocument::new(&alarms.upsets),
            upsets_by_fail: UpsetsDocument::new(&alarms.upsets_by_fail),
            by_kind: by_kind.collect(),
        }
    }
}

impl NeedlessDocument {
    fn new(of: &Needless) -> Self {
        let value = |figure: Option<Figure>| figure.map(|figure| figure.value);
        let interval = |figure: Option<Figure>| figure.and_then(|f| f.interval).map(ends);
        let [good, warn, fail] = of.verdicts;
        NeedlessDocument {
            flights: of.flights,
            not_assessed: of.not_assessed,
            hours: of.hours,
            verdicts: Verdicts { good, warn, fail },
            alarms: of.alarms,
            alarms_per_hour: value(of.alarms_per_hour),
            alarms_per_hour_interval: interval(of.alarms_per_hour),
            fails: of.fails,
            fails_per_hour: value(of.fails_per_hour),
            fails_per_hour_interval: interval(of.fails_per_hour),
            share_of_time_on: value(of.share_on),
            share_of_time_on_interval: interval(of.share_on),
        }
    }
}

impl<'a> UpsetsDocument<'a> {
    fn new(upsets: &'a Upsets) -> Self {
        let assessed = upsets.assessed();
        UpsetsDocument { assessed, upsets }
    }
}

impl<'a> RecordDocument<'a> {
    fn new(record: &'a Record, evaluation: &'a Evaluation) -> Self {
        let names = evaluation.estimators.iter().map(|e| e.name.as_str());
        let profiles = names.zip(record.said.iter().map(SaidDocument::new));
        RecordDocument {
            file: &record.file,
            vehicle: record.vehicle.as_deref(),
            kind: &record.kind,
            judged_s: record.judged_s,
            in_air_s: record.air_s(),
            largest_error_deg: record.largest_error_deg,
            upsets_s: record.upsets.iter().map(|upset| upset.t_s).collect(),
            steps: record.steps.len(),
            critical: record.steps.iter().filter(|step| step.is_critical).count(),
            profiles: profiles.collect(),
        }
    }
}

impl<'a> SaidDocument<'a> {
    fn new(said: &'a Said) -> Self {
        let episode = |answer: &Answer| EpisodeDocument {
            episode: answer.episode,
            warned_s: answer.warned_s,
            lead_s: answer.lead_s(),
        };
        let warning = |warning: &Warning| WarningDocument {
            span: warning.span,
            r#false: warning.is_false,
        };
        let verdict = said.verdict;
        SaidDocument {
            verdict: verdict.map_or_else(|| "NA".to_owned(), |level| level.to_string()),
            alarms: &said.alarms,
            fails: &said.fails,
            episodes: said.judged.answers.iter().map(episode).collect(),
            warnings: said.judged.warnings.iter().map(warning).collect(),
        }
    }
}
