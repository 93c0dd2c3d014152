//! Rows from a flight log.

use flagred::{estimator::Estimator, log, monitor::Monitor, profile::Profile, sample::Unknown};
use flagred_evaluation::{
    ErrorRecord, Span, header, judged_by_header, judged_spans, risk_pct, rmse_deg,
};
use flagred_flightlog::{Attitude, Flight};
use fuzzy::{
    Model,
    model::{Output, Variable},
    rule::{Condition, Rule},
};

use super::{BEFORE_S, Cut, FileRows, Plan, Row};
use crate::{failure::Failure, flights::open_complete};

/// The length of the period after take-off for which [`Cut::Ahead`] creates no rows, in seconds. It applies if the
/// header of the flight does not contain the judged time.
const AFTER_TAKE_OFF_S: f64 = 2.0;
/// The length of the period before landing for which [`Cut::Ahead`] creates no rows, in seconds. It applies if the
/// header of the flight does not contain the judged time.
const BEFORE_END_S: f64 = 1.0;

pub(super) fn rows(log: &str, plan: &Plan) -> Result<FileRows, Failure> {
    let names = plan.profile.signals();
    let flight = open_complete(log, &names, "gives no rows")?;
    let header_value = |key: &str| header(&flight, key);
    let carried = log::carried(&flight, &names);
    if let Some(lacking) = names.iter().find(|name| !carried.contains(name)) {
        return Err(Failure::unreadable(format!(
            "`{log}` gives no rows: it does not contain the signal `{lacking}`"
        ))
        .help("`flagred inspect` lists the signals of a log"));
    }
    let errors: Vec<(f64, Attitude)> = flight.attitudes().collect();
    let mut made = FileRows {
        rows: Vec::new(),
        notes: Vec::new(),
    };
    let mut refused = 0;
    for FlightPart { air_s, span } in parts(&flight, plan) {
        let moments = moments(plan.cut, span.from_s, span.to_s);
        let length_s = match plan.cut {
            Cut::Flights => Some(span.length_s()),
            Cut::Windows { length_s } => Some(length_s),
            Cut::Ahead { .. } => None,
        };
        // Attitude errors on the ground do not belong to the flight.
        let in_air = errors.iter().filter(|(t_s, _)| air_s.contains(*t_s));
        let record = ErrorRecord::new(in_air.copied());
        let inputs = inputs(&flight, plan, &carried, length_s, &moments)?;
        for (t_s, inputs) in moments.into_iter().zip(inputs) {
            let error_deg = match plan.cut {
                Cut::Ahead { horizon_s, .. } => record.largest_within(t_s, horizon_s),
                _ => rmse(&errors, t_s - length_s.unwrap_or(0.0), t_s),
            };
            let known = inputs.iter().all(|value| value.is_finite());
            let (Some(att_rmse_deg), true) = (error_deg, known) else {
                refused += 1;
                continue;
            };
            let before = |before_s| record.largest_within(t_s - before_s, before_s);
            made.rows.push(Row {
                vehicle: header_value("vehicle").unwrap_or("").to_owned(),
                kind: header_value("kind")
                    .or(header_value("real_class"))
                    .unwrap_or("")
                    .to_owned(),
                from_s: Some(length_s.map_or(air_s.from_s, |length_s| t_s - length_s)),
                to_s: Some(t_s),
                inputs,
                errors_before_deg: match plan.cut {
                    Cut::Ahead { .. } => BEFORE_S.map(before).to_vec(),
                    _ => Vec::new(),
                },
                att_rmse_deg,
                risk_pct: risk_pct(att_rmse_deg, plan.critical_deg),
            });
        }
    }
    if made.rows.is_empty() {
        made.notes.push(
            "no rows: the time in the air is too short, or an input or the attitude is unknown throughout".to_owned(),
        );
    } else if refused > 0 {
        made.notes.push(format!(
            "{refused} rows left out: an input or the attitude is unknown"
        ));
    }
    Ok(made)
}

/// A part of a flight from which rows are computed.
struct FlightPart {
    /// The time in the air that contains this part.
    air_s: Span,
    /// The time span of this part.
    span: Span,
}

fn parts(flight: &Flight, plan: &Plan) -> Vec<FlightPart> {
    let Cut::Ahead { .. } = plan.cut else {
        let judged = judged_spans(flight, &plan.profile.verdict);
        let parts = judged
            .into_iter()
            .map(|span| FlightPart { air_s: span, span });
        return parts.collect();
    };
    let judged = judged_by_header(flight);
    let air = flight.in_air.iter().flat_map(|air| &air.spans);
    let parts = air.map(|air| {
        let (from_s, to_s) = (air.start_s, air.end_s);
        let span = match judged {
            Some(judged) => Span {
                from_s: judged.from_s.max(from_s),
                to_s: judged.to_s.min(to_s),
            },
            None => Span {
                from_s: from_s + AFTER_TAKE_OFF_S,
                to_s: to_s - BEFORE_END_S,
            },
        };
        let air_s = Span { from_s, to_s };
        FlightPart { air_s, span }
    });
    parts.collect()
}

/// The times of the rows, in order.
fn moments(cut: Cut, from_s: f64, to_s: f64) -> Vec<f64> {
    let every = |first_s: f64, step_s: f64| {
        let count = ((to_s - first_s) / step_s + 1e-9).floor();
        (0..=count.max(-1.0) as i64).map(move |i| first_s + i as f64 * step_s)
    };
    match cut {
        Cut::Flights => vec![to_s],
        Cut::Windows { length_s } if from_s + length_s > to_s => Vec::new(),
        Cut::Windows { length_s } => every(from_s + length_s, length_s).collect(),
        Cut::Ahead { step_s, .. } => every(from_s, step_s).collect(),
    }
}

/// Returns the inputs at each moment as a monitor computes them; NaN is unknown. If `length_s` is given, it replaces
/// the window of every input.
fn inputs(
    flight: &Flight,
    plan: &Plan,
    carried: &[&str],
    length_s: Option<f64>,
    moments: &[f64],
) -> Result<Vec<Vec<f64>>, Failure> {
    let mut profile = plan.profile.clone();
    // The placeholder rules have only one output.
    profile.other_risks.clear();
    for input in &mut profile.inputs {
        input.source.window_s = length_s.unwrap_or(input.source.window_s);
    }
    let refuse =
        |error: String| Failure::unreadable(format!("profile `{}`: {error}", profile.name));
    let estimator = Estimator::new(&profile, &any_rules(&profile))
        .map_err(|error| refuse(error.to_string()))?;
    let mut monitor = Monitor::new(&estimator, log::craft(flight, carried))
        .map_err(|error| refuse(error.to_string()))?;
    let mut rows = Vec::with_capacity(moments.len());
    let mut now = vec![f64::NAN; profile.inputs.len()];
    log::for_each_sample(flight, carried, |sample| {
        // The state at a moment is the state after the latest sample at or before it. A short contact with the ground
        // is ignored.
        while moments
            .get(rows.len())
            .is_some_and(|t_s| *t_s + 1e-6 < sample.t_s)
        {
            rows.push(now.clone());
        }
        let update = monitor.push(sample);
        if update.risk != Err(Unknown::OnGround) {
            now.copy_from_slice(monitor.inputs());
        }
    });
    rows.resize(moments.len(), now);
    Ok(rows)
}

/// Placeholder rules for a monitor that only computes inputs: the profile's own rules may not be learned yet.
fn any_rules(profile: &Profile) -> Model {
    let terms = ["low", "high"];
    let mut model = Model::builder("any");
    for input in &profile.inputs {
        let condition = Condition::is(&input.name, "low");
        model = model
            .input(Variable::new(&input.name, 0.0, 1.0).partition(terms))
            .rule(Rule::new(condition, &profile.output, "low"));
    }
    let output = Variable::new(&profile.output, 0.0, 100.0).partition(terms);
    model.output(Output::new(output)).build()
}

/// The root mean square attitude error over `(from_s, to_s]`.
fn rmse(errors: &[(f64, Attitude)], from_s: f64, to_s: f64) -> Option<f64> {
    let first = errors.partition_point(|(t_s, _)| *t_s <= from_s + 1e-6);
    let end = errors.partition_point(|(t_s, _)| *t_s <= to_s + 1e-6);
    let errors = errors.get(first..end).unwrap_or(&[]);
    rmse_deg(errors.iter().map(|(_, attitude)| attitude))
}
