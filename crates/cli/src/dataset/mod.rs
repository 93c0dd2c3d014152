//! `flagred dataset`: flights as rows of training data.

mod flight;
pub(crate) mod summary;

use std::{
    io::Write,
    path::{Path, PathBuf},
};

use flagred::{
    profile::{CRITICAL_ERROR_DEG, Profile, ProfileInput},
    source::{Motors, Signal, Source, Statistic},
};

use crate::{
    failure::{Exit, Failure},
    numbers,
    output::{self, Files, Stdout},
    parallel, profile,
};

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Flight logs with attitude; or CSV tables that already have a row for each flight, with columns such as `margin_mean`
    #[arg(required = true, value_name = "LOG")]
    logs: Vec<String>,

    /// Add the inputs of this profile (an input whose name is taken becomes `input_NAME`): `flagred`, `flagred-paper`, `flagred-battery`, or a file
    #[arg(long, value_name = "NAME|FILE")]
    profile: Option<String>,

    /// Make a row for each period of this length [default: a row for each flight]
    #[arg(long, value_name = "SECONDS", value_parser = numbers::positive, conflicts_with = "horizon")]
    window: Option<f64>,

    /// Make a row for each moment, with the inputs at that moment and the largest attitude error in the given number of
    /// seconds after it
    #[arg(long, value_name = "SECONDS", value_parser = numbers::positive)]
    horizon: Option<f64>,

    /// The time between the rows of `--horizon`
    #[arg(long, value_name = "SECONDS", value_parser = numbers::positive, default_value_t = 0.5, requires = "horizon")]
    every: f64,

    /// Attitude error that counts as a risk of 100 %, in degrees
    #[arg(long, value_name = "DEGREES", value_parser = numbers::positive, default_value_t = CRITICAL_ERROR_DEG)]
    critical: f64,

    /// The file to write, replaced if it exists; `-` is standard output [default: -]
    #[arg(short, long, value_name = "OUT.csv", value_parser = output::csv_path)]
    output: Option<PathBuf>,
}

/// The settings for computing rows.
struct Plan {
    profile: Profile,
    cut: Cut,
    critical_deg: f64,
}

/// The method by which a flight is divided into rows.
#[derive(Clone, Copy)]
enum Cut {
    /// One row for each time in the air.
    Flights,
    /// One row for each window of this length.
    Windows { length_s: f64 },
    /// A row every `step_s` seconds, with the ground truth from the `horizon_s` seconds that follow.
    Ahead { horizon_s: f64, step_s: f64 },
}

/// The lengths of periods that end at a row of [`Cut::Ahead`], in seconds. The largest attitude error in each period is
/// reported.
const BEFORE_S: [f64; 2] = [5.0, 10.0];

/// One row of the data set.
struct Row {
    vehicle: String,
    /// The kind of flight, from the header.
    kind: String,
    /// The start of the row; for [`Cut::Ahead`], the start of the time in the air.
    from_s: Option<f64>,
    to_s: Option<f64>,
    inputs: Vec<f64>,
    /// For [`Cut::Ahead`]: the largest error in each of the periods [`BEFORE_S`]; `None` if it is unknown.
    errors_before_deg: Vec<Option<f64>>,
    att_rmse_deg: f64,
    risk_pct: f64,
}

/// The rows of one file, and notes for the user about it.
struct FileRows {
    rows: Vec<Row>,
    notes: Vec<String>,
}

pub(crate) fn run(arguments: &Arguments) -> Result<Exit, Failure> {
    let profile = match &arguments.profile {
        Some(name) => profile::read(name)?.0,
        None => profile::read("flagred-paper")?.0,
    };
    let cut = match (arguments.window, arguments.horizon) {
        (Some(length_s), _) => Cut::Windows { length_s },
        (None, Some(horizon_s)) => Cut::Ahead {
            horizon_s,
            step_s: arguments.every,
        },
        (None, None) => Cut::Flights,
    };
    let plan = Plan {
        profile: with_margin_and_spread(profile, cut),
        cut,
        critical_deg: arguments.critical,
    };
    let named = arguments.profile.iter();
    let mut files = Files::reading(named.chain(&arguments.logs).map(PathBuf::from))?;
    let output = files.optional(arguments.output.as_ref())?;
    let output = output.filter(|output| !output.is_stdout());
    let mut table = Vec::new();
    let sink: Box<dyn Write + '_> = match output {
        Some(_) => Box::new(&mut table),
        None => Box::new(Stdout::data()),
    };
    let mut out = csv::Writer::from_writer(sink);
    out.write_record(head(&plan))?;

    let mut exit = Exit::Clean;
    let mut written = 0;
    let mut failed = None;
    parallel::in_order(
        &arguments.logs,
        "files",
        |log| rows_of(log, &plan),
        |log, made| {
            match made {
                Ok(made) => {
                    for note in &made.notes {
                        output::print_note(&format!("{log}: {note}"));
                    }
                    written += made.rows.len();
                    for row in &made.rows {
                        if failed.is_none() {
                            failed = out.write_record(cells(log, row)).err();
                        }
                    }
                }
                Err(failure) => {
                    failure.report();
                    exit = Exit::Unreadable;
                }
            }
            failed.is_none()
        },
    );
    if let Some(error) = failed {
        return Err(error.into());
    }
    out.flush()?;
    if written == 0 && exit == Exit::Clean {
        return Err(Failure::unreadable("these flights give no rows"));
    }
    drop(out);
    if let Some(output) = output {
        output.write_with(|to| to.write_all(&table))?;
    }
    Ok(exit)
}

/// Adds the inputs of the paper, `margin` and `spread`, in front of the profile's inputs if the profile lacks them. An
/// input of the profile that has one of these names but measures another quantity is first renamed to `input_NAME`, as
/// in the steps of `assess`; with [`Cut::Ahead`] it keeps its name.
fn with_margin_and_spread(mut profile: Profile, cut: Cut) -> Profile {
    let paper = [
        ("margin", Statistic::Mean, Signal::MotorMargin),
        ("spread", Statistic::Std, Signal::MotorCommand),
    ];
    for (place, (name, statistic, signal)) in paper.into_iter().enumerate() {
        let is_same = |input: &ProfileInput| {
            let source = &input.source;
            input.ratio.is_none()
                && source.statistic == statistic
                && source.signal == signal
                && source.motors == Motors::Pooled
                && !source.exponential
        };
        let mut inputs = profile.inputs.iter_mut();
        if !matches!(cut, Cut::Ahead { .. })
            && let Some(other) = inputs.find(|input| input.name == name && !is_same(input))
        {
            let renamed = format!("input_{name}");
            other.name.clone_from(&renamed);
            let ratios = profile
                .inputs
                .iter_mut()
                .filter_map(|input| input.ratio.as_mut());
            let named = ratios.map(|ratio| &mut ratio.per);
            for other in named.filter(|other| *other == name) {
                other.clone_from(&renamed);
            }
        }
        if profile.inputs.iter().all(|input| input.name != name) {
            let source = Source {
                statistic,
                motors: Motors::Pooled,
                signal,
                window_s: profile.window_s,
                exponential: false,
            };
            let name = name.to_owned();
            let input = ProfileInput {
                name,
                source,
                ratio: None,
                if_missing: None,
            };
            profile
                .inputs
                .insert(place.min(profile.inputs.len()), input);
        }
    }
    profile
}

fn rows_of(log: &str, plan: &Plan) -> Result<FileRows, Failure> {
    if let Some(table) = summary::open(Path::new(log)) {
        return summary::rows(&table?, plan);
    }
    flight::rows(log, plan)
}

/// The names of the columns, in their order.
fn head(plan: &Plan) -> Vec<String> {
    let mut head = ["file", "vehicle", "kind", "from_s", "t_s"]
        .map(str::to_owned)
        .to_vec();
    let inputs = plan.profile.inputs.iter();
    head.extend(inputs.map(|input| output::cell(&input.name).into_owned()));
    if let Cut::Ahead { .. } = plan.cut {
        head.extend(BEFORE_S.map(|length_s| format!("error_last_{length_s}_s_deg")));
    }
    head.push("att_rmse_deg".to_owned());
    head.push(output::cell(&plan.profile.output).into_owned());
    head
}

fn cells(log: &str, row: &Row) -> Vec<String> {
    let texts = [log, &row.vehicle, &row.kind];
    let mut cells = texts.map(|text| output::cell(text).into_owned()).to_vec();
    for time in [row.from_s, row.to_s] {
        cells.push(time.map(|t_s| format!("{t_s:.3}")).unwrap_or_default());
    }
    cells.extend(row.inputs.iter().map(|value| format!("{value:.8}")));
    for error_deg in &row.errors_before_deg {
        let error_deg = error_deg.map(|error_deg| format!("{error_deg:.6}"));
        cells.push(error_deg.unwrap_or_default());
    }
    cells.push(format!("{:.6}", row.att_rmse_deg));
    cells.push(format!("{:.5}", row.risk_pct));
    cells
}
