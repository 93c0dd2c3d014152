//! What happens, line by line: words for people and pipes, JSON for programs.

use flagred::{
    estimator::Estimator,
    margin::Side,
    monitor::Assessment,
    verdict::{Finding, Measure},
};
use flightlog::{Vehicle, mavlink::Setup};
use serde_json::{Map, Value, json};

use super::session::{Event, Session, Silent, View};
use crate::assessment::follow::{Verdict, word};

/// Seconds of the vehicle's clock between two lines of risk in words.
const STEP_S: f64 = 1.0;

/// One line an event, and one a second in the air.
#[derive(Default)]
pub(crate) struct Words {
    next_s: Option<f64>,
}

impl Words {
    pub(crate) fn line(
        &mut self,
        at_s: f64,
        event: &Event,
        session: &Session<'_>,
        estimator: &Estimator,
    ) -> Option<String> {
        let Event::Risk { assessment } = event else {
            return Some(words(at_s, &describe(event)));
        };
        let Some(view) = session.view().filter(|view| view.is_in_air) else {
            self.next_s = None;
            return None;
        };
        let t_s = assessment.t_s;
        let waits = |next_s: f64| (next_s - 2.0 * STEP_S..next_s).contains(&t_s);
        if self.next_s.is_some_and(waits) {
            return None;
        }
        self.next_s = Some(t_s + STEP_S);
        Some(words(at_s, &risk(assessment, &view, estimator)))
    }
}

/// A line of words with the receiver's time.
pub(crate) fn words(at_s: f64, text: &str) -> String {
    format!("{at_s:8.1} s  {text}\n")
}

/// An event in words; a risk is described with how things stand, by [`Words`].
pub(crate) fn describe(event: &Event) -> String {
    match event {
        Event::Found { system, vehicle } => format!("found vehicle {system}: {}", name(vehicle)),
        Event::Another { system } => {
            format!("another vehicle is on the link, {system}: it is not followed")
        }
        Event::NotAMultirotor { system, vehicle } => {
            format!(
                "vehicle {system} is a {}, not a multirotor: it is not followed",
                vehicle.kind
            )
        }
        Event::Ready { setup } => ready(setup),
        Event::Note { text } => text.clone(),
        Event::Lost { what: Silent::Link } => {
            "LINK LOST: nothing comes from the vehicle, the risk is unknown".to_owned()
        }
        Event::Lost {
            what: Silent::Motors,
        } => "no motor commands come (SERVO_OUTPUT_RAW), the risk is unknown".to_owned(),
        Event::Back { what, after_s } => format!(
            "{} again, after {after_s:.1} s of silence",
            match what {
                Silent::Link => "the vehicle is heard",
                Silent::Motors => "motor commands come",
            }
        ),
        Event::Rebooted => "the vehicle started anew: what was before is forgotten".to_owned(),
        Event::TookOff { .. } => "took off".to_owned(),
        Event::Risk { assessment } => assessment.risk.map_or_else(
            |_| String::new(),
            |estimate| format!("risk {:.0} %", estimate.risk_pct),
        ),
        Event::Level { text, .. } => text.clone(),
        Event::Ended { finding } => format!(
            "{} from {:.1} to {:.1} s of the vehicle's clock: {} up to {:.0} %",
            word(finding.level),
            finding.from_s,
            finding.to_s,
            measure(finding).replace('_', " "),
            finding.peak_pct
        ),
        Event::Landed { verdict } => match verdict {
            Verdict::Known(level) => format!("{}: the flight is over", word(*level)),
            Verdict::NotAvailable { reason, .. } => {
                format!("NA: the flight is over; no answer: {reason}")
            }
        },
    }
}

/// A vehicle in a few words.
pub(crate) fn name(vehicle: &Vehicle) -> String {
    let frame = vehicle.frame.clone();
    let kind = frame.unwrap_or_else(|| vehicle.kind.to_string());
    match &vehicle.firmware {
        Some(firmware) => format!("{kind}, {firmware}"),
        None => kind,
    }
}

fn ready(setup: &Setup) -> String {
    let outputs: Vec<&str> = setup.motors.iter().map(|m| m.output.as_str()).collect();
    let mut text = format!(
        "{} motors ({}), {} to {} {} ({}), flown between {} and {} of it ({})",
        setup.motors.len(),
        outputs.join(", "),
        setup.range.low,
        setup.range.high,
        setup.range.unit,
        setup.range.source,
        setup.effective.low,
        setup.effective.high,
        setup.effective.source,
    );
    if !setup.assumed.is_empty() {
        text += &format!(
            "; the vehicle did not tell everything, assumed: {}",
            setup.assumed.join("; ")
        );
    }
    text
}

/// The risk of a moment and what it comes from, in words.
fn risk(assessment: &Assessment, view: &View<'_>, estimator: &Estimator) -> String {
    let number = |value: Option<f64>| value.map_or("unknown".to_owned(), |v| format!("{v:.2}"));
    let tail = format!(
        "margin {}, spread {}",
        number(view.margin),
        number(view.spread)
    );
    match (assessment.risk, assessment.elevated_risk_pct) {
        (Ok(estimate), Some(elevated_pct)) => format!(
            "{:<4} risk {:.0} %, elevated {elevated_pct:.0} %, {tail}",
            assessment.level.map_or("", word),
            estimate.risk_pct,
        ),
        (Err(unknown), _) => format!("risk unknown: {}", unknown.explain(estimator.profile())),
        (Ok(_), None) => "risk unknown".to_owned(),
    }
}

fn measure(finding: &Finding) -> &'static str {
    match finding.measure {
        Measure::Risk => "risk",
        Measure::ElevatedRisk => "elevated_risk",
    }
}

/// An event as one object; `None` for samples on the ground, which there is nothing to say about.
pub(crate) fn json(
    at_s: f64,
    event: &Event,
    session: &Session<'_>,
    estimator: &Estimator,
) -> Option<Value> {
    let about = |system: u8, vehicle: &Vehicle| {
        json!({
            "system": system,
            "kind": vehicle.kind.to_string(),
            "frame": vehicle.frame,
            "firmware": vehicle.firmware,
        })
    };
    let silent = |what: &Silent| match what {
        Silent::Link => "link",
        Silent::Motors => "motor_commands",
    };
    let (kind, fields) = match event {
        Event::Found { system, vehicle } => ("found", about(*system, vehicle)),
        Event::Another { system } => ("another_vehicle", json!({ "system": system })),
        Event::NotAMultirotor { system, vehicle } => ("not_a_multirotor", about(*system, vehicle)),
        Event::Ready { setup } => ("ready", setup_json(setup)),
        Event::Note { text } => ("note", json!({ "text": text })),
        Event::Lost { what } => ("lost", json!({ "what": silent(what) })),
        Event::Back { what, after_s } => {
            ("back", json!({ "what": silent(what), "after_s": after_s }))
        }
        Event::Rebooted => ("rebooted", json!({})),
        Event::TookOff { t_s } => ("took_off", json!({ "t_s": t_s })),
        Event::Risk { assessment } => {
            let view = session.view().filter(|view| view.is_in_air)?;
            ("risk", risk_json(assessment, &view, estimator))
        }
        Event::Level { t_s, level, text } => (
            "level",
            json!({ "t_s": t_s, "level": word(*level), "text": text }),
        ),
        Event::Ended { finding } => (
            "finding",
            json!({
                "severity": word(finding.level),
                "from_s": finding.from_s,
                "to_s": finding.to_s,
                "raised_s": finding.raised_s,
                "measure": measure(finding),
                "value_pct": finding.peak_pct,
                "threshold_pct": finding.threshold_pct,
                "motor": finding.motor.map(|motor| json!({
                    "index": motor.motor,
                    "side": match motor.side { Side::Low => "lower", Side::High => "upper" },
                    "margin_mean": motor.mean_margin,
                    "margin_min": motor.least_margin,
                })),
            }),
        ),
        Event::Landed { verdict } => (
            "landed",
            json!({
                "verdict": verdict.word(),
                "reason": match verdict {
                    Verdict::Known(_) => None,
                    Verdict::NotAvailable { reason, .. } => Some(reason),
                },
            }),
        ),
    };
    Some(line(kind, at_s, fields))
}

/// An object with its kind and the receiver's time before its other fields.
pub(crate) fn line(kind: &str, at_s: f64, fields: Value) -> Value {
    let mut object = Map::new();
    object.insert("event".to_owned(), json!(kind));
    object.insert("at_s".to_owned(), json!((at_s * 1e3).round() / 1e3));
    if let Value::Object(fields) = fields {
        object.extend(fields);
    }
    Value::Object(object)
}

fn setup_json(setup: &Setup) -> Value {
    let range = |range: &flightlog::Range| json!({"low": range.low, "high": range.high, "unit": range.unit, "source": range.source});
    json!({
        "motors": setup.motors.iter().map(|motor| {
            json!({"number": motor.number, "output": motor.output, "source": motor.source})
        }).collect::<Vec<_>>(),
        "range": range(&setup.range),
        "effective_range": range(&setup.effective),
        "assumed": setup.assumed,
    })
}

fn risk_json(assessment: &Assessment, view: &View<'_>, estimator: &Estimator) -> Value {
    let unknown = assessment.risk.err();
    json!({
        "t_s": assessment.t_s,
        "risk_pct": assessment.risk.ok().map(|estimate| estimate.risk_pct),
        "elevated_risk_pct": assessment.elevated_risk_pct,
        "level": assessment.level.map(word),
        "margin": view.margin,
        "spread": view.spread,
        "motors": view.motors,
        "unknown": unknown.map(|unknown| unknown.explain(estimator.profile())),
    })
}
