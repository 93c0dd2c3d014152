//! The evaluation for programs: one JSON document.

use flagred::evaluation::Interval;
use serde_json::{Map, Value, json};

use super::{
    Evaluation,
    alarms::{Figure, SmallErrors, Upsets},
    flight::{Record, Said},
    scores::{Evaluated, Scores},
    warnings::Warnings,
};

/// The version of the document's layout; it grows when a name changes its meaning or goes.
const SCHEMA: &str = "flagred.evaluate/1";

/// The document of an evaluation.
pub(super) fn document(evaluation: &Evaluation) -> Value {
    let estimators = evaluation.estimators.iter().enumerate();
    let estimators: Vec<Value> = estimators
        .map(|(i, evaluated)| {
            let cases = evaluation.cases;
            let mut object = scores(&evaluated.all, cases);
            object.insert("name".into(), json!(evaluated.name));
            object.insert("description".into(), json!(evaluated.description));
            if evaluation.horizon_s.is_some() {
                object.insert(
                    "quiet".into(),
                    Value::Object(scores(&evaluated.quiet, cases)),
                );
                object.insert(
                    "onset".into(),
                    Value::Object(scores(&evaluated.onset, cases)),
                );
            }
            object.insert(
                "by_vehicle".into(),
                groups("vehicle", &evaluated.by_vehicle, cases),
            );
            object.insert("by_kind".into(), groups("kind", &evaluated.by_kind, cases));
            object.insert("reliability".into(), reliability(evaluated));
            if let Some((all, by_kind)) = evaluation.warnings.get(i) {
                let by_kind = by_kind.iter().map(|(kind, warnings)| {
                    let mut object = self::warnings(warnings);
                    object.insert("kind".into(), json!(kind));
                    Value::Object(object)
                });
                let mut object_of_all = self::warnings(all);
                object_of_all.insert("by_kind".into(), by_kind.collect());
                object.insert("warnings".into(), Value::Object(object_of_all));
            }
            if let Some(alarms) = evaluation.alarms.get(i) {
                let by_kind = alarms.by_kind.iter().map(|(kind, ordinary, found)| {
                    json!({
                        "kind": kind,
                        "ordinary_flights": small_errors(ordinary),
                        "upsets": upsets(found),
                    })
                });
                let value = json!({
                    "ordinary_flights": small_errors(&alarms.ordinary),
                    "mild_flights": small_errors(&alarms.mild),
                    "upsets": upsets(&alarms.upsets),
                    "upsets_by_fail": upsets(&alarms.upsets_by_fail),
                    "by_kind": by_kind.collect::<Vec<_>>(),
                });
                object.insert("alarms".into(), value);
            }
            Value::Object(object)
        })
        .collect();
    let first = evaluation.estimators.first();
    json!({
        "schema": SCHEMA,
        "cases": evaluation.cases,
        "horizon_s": evaluation.horizon_s,
        "flights": evaluation.flights,
        "steps": first.map(|e| e.all.cases + e.all.unknown),
        "left_out": evaluation.left_out.len(),
        "left_out_files": evaluation.left_out.iter().map(|left| json!({
            "file": left.file,
            "reason": left.reason,
        })).collect::<Vec<_>>(),
        "estimators": estimators,
        "records": evaluation.records.iter().map(|record| self::record(record, evaluation)).collect::<Vec<_>>(),
    })
}

fn scores(scores: &Scores, cases: &str) -> Map<String, Value> {
    let interval = |interval: Option<Interval>| interval.map(|i| [i.low, i.high]);
    let value = json!({
        "auc": scores.areas.map(|a| a.roc),
        "auc_interval": interval(scores.intervals.map(|i| i.roc)),
        "pr_auc": scores.areas.map(|a| a.precision_recall),
        "pr_auc_interval": interval(scores.intervals.map(|i| i.precision_recall)),
        "no_auc": scores.no_area(cases),
        "within_flight_auc": scores.within.map(|within| within.roc),
        "within_flight_auc_interval": interval(scores.within.and_then(|within| within.interval)),
        "within_flight_flights": scores.within.map_or(0, |within| within.groups),
        "cases": scores.cases,
        "critical": scores.critical,
        "unknown": scores.unknown,
    });
    match value {
        Value::Object(object) => object,
        _ => Map::new(),
    }
}

fn groups(key: &str, groups: &[(String, Scores)], cases: &str) -> Value {
    let objects = groups.iter().map(|(name, of_group)| {
        let mut object = scores(of_group, cases);
        object.insert(key.to_owned(), json!(name));
        Value::Object(object)
    });
    objects.collect()
}

fn reliability(evaluated: &Evaluated) -> Value {
    let Some(bands) = &evaluated.reliability else {
        return Value::Null;
    };
    let objects = bands.iter().map(|band| {
        let share = (band.predictions > 0).then(|| band.critical as f64 / band.predictions as f64);
        json!({
            "from_pct": band.from_pct,
            "to_pct": band.to_pct,
            "cases": band.predictions,
            "critical": band.critical,
            "critical_share": share,
            "risk_mean_pct": band.mean_risk_pct,
        })
    });
    objects.collect()
}

fn warnings(of: &Warnings) -> Map<String, Value> {
    let share = |part: usize, whole: usize| (whole > 0).then(|| part as f64 / whole as f64);
    let value = json!({
        "flights": of.flights,
        "hours": of.hours,
        "episodes": of.episodes,
        "announced": of.announced,
        "announced_share": share(of.announced, of.episodes),
        "lead_s_median": of.lead_s,
        "groups": of.groups,
        "groups_announced": of.groups_announced,
        "groups_announced_share": share(of.groups_announced, of.groups),
        "group_lead_s_median": of.group_lead_s,
        "answered": of.answered,
        "answer_s_median": of.answer_s,
        "warnings": of.warnings,
        "false_warnings": of.false_warnings,
        "false_per_hour": of.false_per_hour(),
        "share_of_time_on": of.share_on,
    });
    match value {
        Value::Object(object) => object,
        _ => Map::new(),
    }
}

fn small_errors(of: &SmallErrors) -> Value {
    let value = |figure: Option<Figure>| figure.map(|figure| figure.value);
    let interval = |figure: Option<Figure>| {
        let interval = figure.and_then(|figure| figure.interval);
        interval.map(|i| [i.low, i.high])
    };
    let [good, warn, fail] = of.verdicts;
    json!({
        "flights": of.flights,
        "not_assessed": of.not_assessed,
        "hours": of.hours,
        "verdicts": {"GOOD": good, "WARN": warn, "FAIL": fail},
        "alarms": of.alarms,
        "alarms_per_hour": value(of.alarms_per_hour),
        "alarms_per_hour_interval": interval(of.alarms_per_hour),
        "fails": of.fails,
        "fails_per_hour": value(of.fails_per_hour),
        "fails_per_hour_interval": interval(of.fails_per_hour),
        "share_of_time_on": value(of.share_on),
        "share_of_time_on_interval": interval(of.share_on),
    })
}

fn upsets(of: &Upsets) -> Value {
    json!({
        "assessed": of.assessed(),
        "not_assessed": of.not_assessed,
        "before": of.before,
        "within_1_s": of.after,
        "never": of.never,
        "lead_s_median": of.lead_s,
    })
}

/// A flight with its episodes, and the warnings of each profile.
fn record(record: &Record, evaluation: &Evaluation) -> Value {
    let names = evaluation.estimators.iter().map(|e| e.name.clone());
    let profiles = names.zip(&record.said).map(|(name, said)| {
        let Said { judged, .. } = said;
        let episodes = judged.answers.iter().map(|answer| {
            json!({
                "from_s": answer.episode.from_s,
                "to_s": answer.episode.to_s,
                "warned_s": answer.warned_s,
                "lead_s": answer.lead_s(),
            })
        });
        let warnings = judged.warnings.iter().map(|warning| {
            json!({
                "from_s": warning.span.from_s,
                "to_s": warning.span.to_s,
                "false": warning.is_false,
            })
        });
        let object = json!({
            "verdict": said.verdict.map_or("NA".to_owned(), |level| level.to_string()),
            "alarms": said.alarms,
            "fails": said.fails,
            "episodes": episodes.collect::<Vec<_>>(),
            "warnings": warnings.collect::<Vec<_>>(),
        });
        (name, object)
    });
    json!({
        "file": record.file,
        "vehicle": record.vehicle,
        "kind": record.kind,
        "judged_s": record.judged_s,
        "in_air_s": record.air_s(),
        "largest_error_deg": record.largest_error_deg,
        "upsets_s": record.upsets.iter().map(|upset| upset.t_s).collect::<Vec<_>>(),
        "steps": record.steps.len(),
        "critical": record.steps.iter().filter(|step| step.is_critical).count(),
        "profiles": profiles.collect::<Map<String, Value>>(),
    })
}
