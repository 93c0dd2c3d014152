//! The evaluation as a JSON document for programs.

use std::collections::BTreeMap;

use flagred::flight::VerdictWord;
use serde::Serialize;

use crate::{
    Evaluation, LeftOutFile,
    alarms::{Alarms, Figure, NeedlessAlarms, Upsets},
    bootstrap::Interval,
    flight::{ProfileResult, Record},
    ranking::Band,
    scores::{ProfileScores, Scores},
    span::Span,
    warning_matches::{EpisodeMatch, Warning},
    warnings::Warnings,
};

/// The version of the document's layout; it increases when a name changes its meaning or is removed.
const SCHEMA: &str = "flagred.validate/1";

/// The document of an evaluation: the output of `flagred validate --json`.
#[derive(Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Document<'a> {
    #[cfg_attr(feature = "schema", schemars(extend("const" = SCHEMA)))]
    schema: &'static str,
    /// The cases: `steps`, half a second apart, or whole `flights`.
    #[cfg_attr(feature = "schema", schemars(extend("enum" = ["steps", "flights"])))]
    cases: &'static str,
    /// How far ahead a risk should predict, in seconds; null for whole flights.
    horizon_s: Option<f64>,
    /// The number of flights.
    flights: usize,
    /// The number of steps that were scored.
    steps: Option<usize>,
    /// The number of files that are not complete flights.
    left_out: usize,
    /// The files that were left out, with the reasons.
    left_out_files: &'a [LeftOutFile],
    /// The profiles, then the predictors without rules.
    estimators: Vec<EstimatorDocument<'a>>,
    /// The flights.
    records: Vec<RecordDocument<'a>>,
}

#[derive(Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct EstimatorDocument<'a> {
    name: &'a str,
    description: &'a str,
    #[serde(flatten)]
    all: ScoresDocument,
    /// The scores over the steps that follow 5 s without a critical error. Absent if the cases are whole flights.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(with = "ScoresDocument"))]
    quiet: Option<ScoresDocument>,
    /// The scores over the steps that follow 10 s without a critical error. Absent if the cases are whole flights.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(with = "ScoresDocument"))]
    onset: Option<ScoresDocument>,
    by_vehicle: Vec<VehicleScoresDocument<'a>>,
    by_kind: Vec<FlightKindDocument<'a, ScoresDocument>>,
    /// For risks in %, the reliability by tenths of the scale; null for other scores.
    reliability: Option<Vec<BandDocument>>,
    /// The warnings, only for profiles.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(with = "ProfileWarnings<'_>"))]
    warnings: Option<ProfileWarnings<'a>>,
    /// The alarms, only for profiles on flights.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(with = "AlarmsDocument<'_>"))]
    alarms: Option<AlarmsDocument<'a>>,
}

#[derive(Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct VehicleScoresDocument<'a> {
    vehicle: &'a str,
    #[serde(flatten)]
    scores: ScoresDocument,
}

#[derive(Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct FlightKindDocument<'a, T> {
    kind: &'a str,
    #[serde(flatten)]
    of: T,
}

#[derive(Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct ScoresDocument {
    /// The area under the ROC curve.
    auc: Option<f64>,
    /// The 95 % interval of this area, by resampling whole flights.
    auc_interval: Option<[f64; 2]>,
    /// The area under the precision-recall curve.
    pr_auc: Option<f64>,
    /// The 95 % interval of this area, by resampling whole flights.
    pr_auc_interval: Option<[f64; 2]>,
    /// The reason why there is no area, such as `no critical step`.
    no_auc: Option<String>,
    /// The mean area under the ROC curve within single flights, over the flights that have both critical and other
    /// cases.
    within_flight_auc: Option<f64>,
    /// The 95 % interval of this mean, by resampling whole flights.
    within_flight_auc_interval: Option<[f64; 2]>,
    /// The number of flights in this mean.
    within_flight_flights: usize,
    /// The number of cases with a score.
    cases: usize,
    /// The number of these cases that were critical.
    critical: usize,
    /// The number of cases without a score.
    unknown: usize,
}

#[derive(Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct BandDocument {
    /// The lower end of the band in %, inclusive.
    from_pct: f64,
    /// The upper end in %, exclusive except for 100.
    to_pct: f64,
    /// The number of cases whose risk is in the band.
    cases: u64,
    /// The number of these cases that were critical.
    critical: u64,
    /// The share of critical cases, from 0 to 1.
    critical_share: Option<f64>,
    /// The mean risk of these cases, in %.
    risk_mean_pct: Option<f64>,
}

#[derive(Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct ProfileWarnings<'a> {
    #[serde(flatten)]
    all: WarningsDocument<'a>,
    by_kind: Vec<FlightKindDocument<'a, WarningsDocument<'a>>>,
}

#[derive(Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct WarningsDocument<'a> {
    #[serde(flatten)]
    counts: &'a Warnings,
    announced_share: Option<f64>,
    groups_announced_share: Option<f64>,
    false_per_hour: Option<f64>,
}

#[derive(Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct AlarmsDocument<'a> {
    /// Alarms in calm stretches. A calm stretch is at least 20 s long, begins at least 5 s after take-off, and is at
    /// least 10 s away from any error over 5 degrees and any tilt over 45 degrees.
    calm_stretches: NeedlessAlarmsDocument,
    /// Alarms in ordinary flights. In an ordinary flight the error, as a root mean square over 1 s, never exceeds 5
    /// degrees, the tilt is below 45 degrees, and there is no upset.
    ordinary_flights: NeedlessAlarmsDocument,
    /// The upsets, classified by the alarms (WARN or FAIL) around them.
    upsets: UpsetsDocument<'a>,
    /// The upsets, classified by FAIL only.
    upsets_by_fail: UpsetsDocument<'a>,
    by_kind: Vec<FlightKindDocument<'a, AlarmsOfKind<'a>>>,
}

#[derive(Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct AlarmsOfKind<'a> {
    calm_stretches: NeedlessAlarmsDocument,
    upsets: UpsetsDocument<'a>,
}

#[derive(Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct NeedlessAlarmsDocument {
    /// The number of flights that contain such times (calm stretches or ordinary flights) and have a verdict.
    flights: usize,
    /// The number of flights that contain such times, but have the verdict NA.
    not_assessed: usize,
    /// The total length of these times, in hours.
    hours: f64,
    /// The number of flights with each verdict.
    verdicts: Verdicts,
    /// The number of periods of WARN or FAIL; a WARN that is raised to FAIL counts once.
    alarms: usize,
    alarms_per_hour: Option<f64>,
    alarms_per_hour_interval: Option<[f64; 2]>,
    /// The number of periods of FAIL.
    fails: usize,
    fails_per_hour: Option<f64>,
    fails_per_hour_interval: Option<[f64; 2]>,
    /// The share of these times during which an alarm was on.
    share_of_time_on: Option<f64>,
    share_of_time_on_interval: Option<[f64; 2]>,
}

#[derive(Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "UPPERCASE")]
struct Verdicts {
    good: usize,
    warn: usize,
    fail: usize,
}

#[derive(Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct UpsetsDocument<'a> {
    /// The number of upsets in flights with a verdict.
    assessed: usize,
    #[serde(flatten)]
    upsets: &'a Upsets,
}

/// A flight with its episodes, and the warnings of each profile.
#[derive(Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct RecordDocument<'a> {
    /// The name of the log.
    file: &'a str,
    /// The serial number of the board, or `vehicle_id` or `vehicle` of the header.
    vehicle: Option<&'a str>,
    /// The kind of flight, from its header.
    kind: &'a str,
    /// The judged time, in seconds.
    judged_s: f64,
    /// The time in the air, in seconds.
    in_air_s: f64,
    /// The largest attitude error over a second in the air, in degrees.
    largest_error_deg: Option<f64>,
    /// The times at which the vehicle was upset, in seconds.
    upsets_s: Vec<f64>,
    /// The number of steps.
    steps: usize,
    /// The number of critical steps.
    critical: usize,
    /// The results of each profile, by its name.
    profiles: BTreeMap<&'a str, ProfileResultDocument<'a>>,
}

#[derive(Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct ProfileResultDocument<'a> {
    /// The verdict of the profile on the flight.
    verdict: VerdictWord,
    /// Periods of WARN or FAIL.
    alarms: &'a [Span],
    /// Periods of FAIL.
    fails: &'a [Span],
    /// Periods of critical error.
    episodes: Vec<EpisodeDocument>,
    /// Periods of WARN or FAIL that count as warnings.
    warnings: Vec<WarningDocument>,
}

#[derive(Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct EpisodeDocument {
    #[serde(flatten)]
    episode: Span,
    /// The start, in seconds, of the warning that announced the episode, or else of the first warning that began during
    /// it.
    warned_s: Option<f64>,
    /// The lead time: the time from the start of the warning to the start of the episode, in
    /// seconds; negative if the warning began during the episode.
    lead_s: Option<f64>,
}

#[derive(Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct WarningDocument {
    #[serde(flatten)]
    span: Span,
    /// Whether the warning is false: it neither precedes an episode nor begins during or just after one.
    r#false: bool,
}

impl<'a> Document<'a> {
    /// Creates the document of an evaluation.
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
    fn new(i: usize, evaluated: &'a ProfileScores, evaluation: &'a Evaluation) -> Self {
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
                .map(|(vehicle, of)| VehicleScoresDocument {
                    vehicle,
                    scores: scores(of),
                })
                .collect(),
            by_kind: by_kind
                .map(|(kind, of)| FlightKindDocument {
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
                        .map(|(kind, of)| FlightKindDocument {
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
                calm_stretches: NeedlessAlarmsDocument::new(calm),
                upsets: UpsetsDocument::new(upsets),
            };
            FlightKindDocument { kind, of }
        });
        AlarmsDocument {
            calm_stretches: NeedlessAlarmsDocument::new(&alarms.calm),
            ordinary_flights: NeedlessAlarmsDocument::new(&alarms.ordinary),
            upsets: UpsetsDocument::new(&alarms.upsets),
            upsets_by_fail: UpsetsDocument::new(&alarms.upsets_by_fail),
            by_kind: by_kind.collect(),
        }
    }
}

impl NeedlessAlarmsDocument {
    fn new(of: &NeedlessAlarms) -> Self {
        let value = |figure: Option<Figure>| figure.map(|figure| figure.value);
        let interval = |figure: Option<Figure>| figure.and_then(|f| f.interval).map(ends);
        let [good, warn, fail] = of.verdicts;
        NeedlessAlarmsDocument {
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
            share_of_time_on: value(of.share_of_time_on),
            share_of_time_on_interval: interval(of.share_of_time_on),
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
        let profiles = names.zip(record.results.iter().map(ProfileResultDocument::new));
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

impl<'a> ProfileResultDocument<'a> {
    fn new(result: &'a ProfileResult) -> Self {
        let episode = |answer: &EpisodeMatch| EpisodeDocument {
            episode: answer.episode,
            warned_s: answer.warned_s,
            lead_s: answer.lead_s(),
        };
        let warning = |warning: &Warning| WarningDocument {
            span: warning.span,
            r#false: warning.is_false,
        };
        ProfileResultDocument {
            verdict: result.verdict.into(),
            alarms: &result.alarms,
            fails: &result.fails,
            episodes: result.matches.episodes.iter().map(episode).collect(),
            warnings: result.matches.warnings.iter().map(warning).collect(),
        }
    }
}
