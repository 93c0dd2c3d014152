//! The evaluation for programs: one JSON document.

use flagred::evaluation::Interval;
use serde_json::{Map, Value, json};

use super::{
    Evaluation,
    flight::Record,
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
            let mut object = scores(&evaluated.all);
            object.insert("name".into(), json!(evaluated.name));
            object.insert("description".into(), json!(evaluated.description));
            object.insert(
                "by_vehicle".into(),
                groups("vehicle", &evaluated.by_vehicle),
            );
            object.insert("by_kind".into(), groups("kind", &evaluated.by_kind));
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
        "left_out": evaluation.left_out,
        "estimators": estimators,
        "records": evaluation.records.iter().map(|record| self::record(record, evaluation)).collect::<Vec<_>>(),
    })
}

fn scores(scores: &Scores) -> Map<String, Value> {
    let interval = |interval: Option<Interval>| interval.map(|i| [i.low, i.high]);
    let value = json!({
        "auc": scores.areas.map(|a| a.roc),
        "auc_interval": interval(scores.intervals.map(|i| i.roc)),
        "pr_auc": scores.areas.map(|a| a.precision_recall),
        "pr_auc_interval": interval(scores.intervals.map(|i| i.precision_recall)),
        "cases": scores.cases,
        "critical": scores.critical,
        "unknown": scores.unknown,
    });
    match value {
        Value::Object(object) => object,
        _ => Map::new(),
    }
}

fn groups(key: &str, groups: &[(String, Scores)]) -> Value {
    let objects = groups.iter().map(|(name, of_group)| {
        let mut object = scores(of_group);
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

/// A flight with its episodes, and the warnings of each profile.
fn record(record: &Record, evaluation: &Evaluation) -> Value {
    let names = evaluation.estimators.iter().map(|e| e.name.clone());
    let profiles = names.zip(&record.judged).map(|(name, judged)| {
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
        "steps": record.steps.len(),
        "critical": record.steps.iter().filter(|step| step.is_critical).count(),
        "profiles": profiles.collect::<Map<String, Value>>(),
    })
}
