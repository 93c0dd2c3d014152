//! Rows from a flight log.

use flagred::{
    attitude::{Attitude, AttitudeError, risk_pct},
    evaluation::{ErrorRecord, Span},
    log,
    source::{Observer, Source},
};
use flightlog::Flight;

use super::{Cut, Plan, Row, Rows};
use crate::{failure::Failure, flights::open_complete};

/// How far apart the moments are from which [`Cut::Ahead`] looks ahead, in seconds.
const STEP_S: f64 = 0.5;

pub(super) fn rows(log: &str, plan: &Plan) -> Result<Rows, Failure> {
    let names = plan.profile.signals();
    let flight = open_complete(log, &names, "makes no rows")?;
    let said = |key: &str| log::header(&flight, key);
    if let Some((key, value)) = plan.skip.iter().find(|(k, v)| said(k) == Some(v)) {
        return Ok(Rows {
            rows: Vec::new(),
            notes: vec![format!("left out: {key} is {value}")],
        });
    }
    let carried = log::carried(&flight, &names);
    if let Some(lacking) = names.iter().find(|name| !carried.contains(name)) {
        return Err(Failure::unreadable(format!(
            "`{log}` makes no rows: it does not carry the signal `{lacking}`"
        ))
        .help("`flagred inspect` lists the signals a log carries"));
    }
    let errors: Vec<(f64, Attitude)> = log::attitudes(&flight).collect();
    let record = ErrorRecord::new(errors.iter().copied());
    let mut made = Rows {
        rows: Vec::new(),
        notes: Vec::new(),
    };
    let mut refused = 0;
    for Span { from_s, to_s } in log::judged_spans(&flight, &plan.profile.verdict) {
        let moments = moments(plan.cut, from_s, to_s);
        let length_s = match plan.cut {
            Cut::Flights => Some(to_s - from_s),
            Cut::Windows { length_s } => Some(length_s),
            Cut::Ahead { .. } => None,
        };
        let inputs = inputs(&flight, plan, &carried, length_s, &moments);
        for (t_s, inputs) in moments.into_iter().zip(inputs) {
            let error_deg = match plan.cut {
                Cut::Ahead { horizon_s } => record.largest_within(t_s, horizon_s),
                _ => rmse(&errors, t_s - length_s.unwrap_or(0.0), t_s),
            };
            let known = inputs.iter().all(|value| value.is_finite());
            let (Some(att_rmse_deg), true) = (error_deg, known) else {
                refused += 1;
                continue;
            };
            made.rows.push(Row {
                vehicle: said("vehicle").unwrap_or("").to_owned(),
                from_s: length_s.map(|length_s| t_s - length_s),
                to_s: Some(t_s),
                inputs,
                att_rmse_deg,
                risk_pct: risk_pct(att_rmse_deg, plan.critical_deg),
            });
        }
    }
    if made.rows.is_empty() {
        made.notes
            .push("no row: too short a time in the air, or nothing known in it".to_owned());
    } else if refused > 0 {
        made.notes.push(format!(
            "{refused} rows left out: an input or the attitude is unknown"
        ));
    }
    Ok(made)
}

/// The times at which rows are made, in order.
fn moments(cut: Cut, from_s: f64, to_s: f64) -> Vec<f64> {
    let every = |first_s: f64, step_s: f64| {
        let count = ((to_s - first_s) / step_s + 1e-9).floor();
        (0..=count.max(-1.0) as i64).map(move |i| first_s + i as f64 * step_s)
    };
    match cut {
        Cut::Flights => vec![to_s],
        Cut::Windows { length_s } if from_s + length_s > to_s => Vec::new(),
        Cut::Windows { length_s } => every(from_s + length_s, length_s).collect(),
        Cut::Ahead { .. } => every(from_s, STEP_S).collect(),
    }
}

/// The inputs at each moment, over windows of one length or over their own.
fn inputs(
    flight: &Flight,
    plan: &Plan,
    carried: &[&str],
    length_s: Option<f64>,
    moments: &[f64],
) -> Vec<Vec<f64>> {
    let sources: Vec<Source> = plan
        .profile
        .inputs
        .iter()
        .map(|input| Source {
            window_s: length_s.unwrap_or(input.source.window_s),
            ..input.source.clone()
        })
        .collect();
    let Ok(mut observer) = Observer::new(&sources, carried) else {
        return Vec::new();
    };
    let read = |observer: &Observer| {
        let values = (0..sources.len()).map(|i| observer.value(i));
        values
            .map(|observed| observed.map_or(f64::NAN, |o| o.value))
            .collect::<Vec<f64>>()
    };
    let mut rows = Vec::with_capacity(moments.len());
    let mut last_s = None;
    let longest_gap_s = plan.profile.sampling.longest_gap_s;
    log::for_each_sample(flight, carried, |sample| {
        // The state at a moment is that after the newest sample up to it.
        while moments
            .get(rows.len())
            .is_some_and(|t_s| *t_s + 1e-6 < sample.t_s)
        {
            rows.push(read(&observer));
        }
        let held_s = last_s.map_or(0.0, |last_s| sample.t_s - last_s);
        last_s = Some(sample.t_s);
        if !sample.in_air || held_s > longest_gap_s {
            observer.clear();
        } else if held_s > 0.0 {
            observer.push(sample.t_s, held_s, sample.motors, sample.signals);
        }
    });
    while rows.len() < moments.len() {
        rows.push(read(&observer));
    }
    rows
}

/// The root mean square over `(from_s, to_s]`.
fn rmse(errors: &[(f64, Attitude)], from_s: f64, to_s: f64) -> Option<f64> {
    let first = errors.partition_point(|(t_s, _)| *t_s <= from_s + 1e-6);
    let end = errors.partition_point(|(t_s, _)| *t_s <= to_s + 1e-6);
    let mut rmse = AttitudeError::default();
    for (_, attitude) in errors.get(first..end).unwrap_or(&[]) {
        rmse.push(attitude);
    }
    rmse.rmse_deg()
}
