//! The steps of a flight as CSV.

use std::io::{self, Write};

use flagred::{
    estimator::Estimator,
    flight::{Assessment, Step},
};

use crate::table::cell;

/// The default time between the steps that are written, in seconds.
pub const STEP_S: f64 = 0.1;

/// Returns the columns of a step, each with its name and its field. The names are those in JSON; the inputs of
/// the profile are `input_NAME`, its other risks `other_risk_NAME`. The field of an unknown value is empty.
fn row(estimator: &Estimator, step: &Step) -> Vec<(String, String)> {
    let number = |value: Option<f64>| {
        let known = value.filter(|value| value.is_finite());
        known.map(|value| value.to_string()).unwrap_or_default()
    };
    let estimate = step.estimate;
    let filled = estimate.map(|e| u8::from(e.filled_from.is_some()).to_string());
    let mut row = [
        ("t_s", number(Some(step.t_s))),
        ("margin", number(step.margin)),
        ("spread", number(step.spread)),
        ("coverage", number(estimate.map(|e| e.coverage))),
        ("filled", filled.unwrap_or_default()),
        ("risk", number(estimate.map(|e| e.risk_pct))),
        ("risk_low", number(step.risk_interval.map(|it| it.low_pct))),
        (
            "risk_high",
            number(step.risk_interval.map(|it| it.high_pct)),
        ),
        ("elevated_risk", number(step.elevated_risk_pct)),
    ]
    .map(|(name, field)| (name.to_owned(), field))
    .to_vec();
    // The prefix is needed because a profile may have an input `spread` whose window differs from that of the column
    // `spread`.
    let inputs = estimator.profile().inputs.iter().enumerate();
    row.extend(inputs.map(|(i, input)| {
        let field = number(step.inputs.get(i).copied());
        (format!("input_{}", input.name), field)
    }));
    let others = estimator.profile().other_risks.iter().enumerate();
    row.extend(others.map(|(i, risk)| {
        let field = number(step.other_risks_pct.get(i).copied());
        (format!("other_risk_{}", risk.output), field)
    }));
    row
}

/// Writes the steps of one flight as CSV, with a header line if `head` is set; for several flights `log` is the first
/// column.
///
/// # Errors
/// If writing to `out` fails.
pub fn write_csv(
    out: &mut impl Write,
    log: Option<&str>,
    head: bool,
    estimator: &Estimator,
    assessed: &Assessment,
) -> io::Result<()> {
    let mut table = csv::Writer::from_writer(out);
    if head {
        let columns = row(estimator, &Step::default()).into_iter();
        let names = columns.map(|(name, _)| cell(&name).into_owned());
        let record = log.map(|_| "log".to_owned()).into_iter().chain(names);
        table.write_record(record).map_err(io_error)?;
    }
    for step in &assessed.steps {
        let fields = row(estimator, step).into_iter().map(|(_, field)| field);
        let record = log.map(|log| cell(log).into_owned());
        table
            .write_record(record.into_iter().chain(fields))
            .map_err(io_error)?;
    }
    table.flush()
}

fn io_error(error: csv::Error) -> io::Error {
    match error.into_kind() {
        csv::ErrorKind::Io(error) => error,
        kind => io::Error::other(format!("{kind:?}")),
    }
}
