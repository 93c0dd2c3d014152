//! The evaluation as tables, which [`words`](crate::words) and [`page`](crate::page) display.

mod profiles;

use std::collections::{BTreeMap, BTreeSet};

use fuzzy::drawing::visible;

use crate::{
    Evaluation,
    alarms::Verdicts,
    bootstrap::Interval,
    flight::Record,
    scores::{ProfileScores, SEPARATE_KIND, Scores},
};
use profiles::{alarms, reliability, warnings};

/// A table, with notes below it.
pub(crate) struct Table {
    /// The title; empty for the first table.
    pub(crate) title: String,
    pub(crate) columns: Vec<Column>,
    /// The rows. A row may have one cell more than there are columns.
    pub(crate) rows: Vec<Vec<String>>,
    pub(crate) notes: Vec<String>,
}

pub(crate) struct Column {
    pub(crate) head: String,
    /// The width in characters; 0 for the last column.
    pub(crate) width: usize,
    /// Whether cells are aligned to the right, as numbers.
    pub(crate) is_number: bool,
}

fn column(head: &str, width: usize) -> Column {
    Column {
        head: head.to_owned(),
        width,
        is_number: false,
    }
}

fn number(head: &str, width: usize) -> Column {
    Column {
        is_number: true,
        ..column(head, width)
    }
}

/// A name from the user's data, with invisible characters made visible.
fn seen(name: &str) -> String {
    visible(name).into_owned()
}

fn widest<'a>(names: impl Iterator<Item = &'a String>) -> usize {
    names.map(|name| name.chars().count()).max().unwrap_or(0)
}

/// All tables.
pub(crate) fn tables(evaluation: &Evaluation) -> Vec<Table> {
    let mut tables = vec![areas(evaluation)];
    tables.extend(by("ROC area by kind", evaluation, |e| &e.by_kind));
    tables.extend(by("ROC area by vehicle", evaluation, |e| &e.by_vehicle));
    tables.extend(verdicts(evaluation));
    let profiles = || evaluation.estimators.iter();
    let alarmed = profiles().zip(&evaluation.alarms);
    tables.extend(alarmed.map(|(profile, of)| alarms(&seen(&profile.name), of)));
    let warned = profiles().zip(&evaluation.warnings);
    tables.extend(warned.map(|(profile, (all, by_kind))| warnings(profile, all, by_kind)));
    tables.extend(profiles().filter_map(reliability));
    tables
}

/// Lines that describe what was evaluated.
pub(crate) fn head(evaluation: &Evaluation) -> Vec<String> {
    let Some(first) = evaluation.estimators.first() else {
        return Vec::new();
    };
    let flights = evaluation.flights;
    let cases = first.all.cases + first.all.unknown;
    let Some(horizon_s) = evaluation.horizon_s else {
        let vehicles = first.by_vehicle.len();
        let share = percent(evaluation.critical, cases, 2);
        return vec![format!(
            "{} of {}; {share} of the flights are critical",
            count(cases, "flight"),
            count(vehicles, "vehicle")
        )];
    };
    let main = || {
        evaluation
            .records
            .iter()
            .filter(|r| r.kind != SEPARATE_KIND)
    };
    let named: BTreeSet<&str> = main().filter_map(|r| r.vehicle.as_deref()).collect();
    let vehicles = named.len();
    let hours = main().map(Record::air_s).sum::<f64>() / 3600.0;
    let mut lines = vec![
        format!(
            "{} of {}, {hours:.2} h in the air, {}",
            count(flights, "flight"),
            count(vehicles, "vehicle"),
            count(cases, "step")
        ),
        format!(
            "critical within {horizon_s} s: {} of all steps, {} of {} quiet ones (5 s without a critical error), {} of {} after 10 s of quiet",
            percent(evaluation.critical, cases, 2),
            percent(first.quiet.critical, first.quiet.cases, 2),
            first.quiet.cases + first.quiet.unknown,
            percent(first.onset.critical, first.onset.cases, 2),
            first.onset.cases + first.onset.unknown,
        ),
    ];
    if first.by_kind.iter().any(|(kind, _)| kind == SEPARATE_KIND) {
        lines.push(format!(
            "flights of kind `{SEPARATE_KIND}` are not in these figures, only under `by kind`: their attitude errors are commanded on purpose"
        ));
    }
    lines
}

/// The reasons why files were left out, each with the number of files.
pub(crate) fn left_out(evaluation: &Evaluation) -> BTreeMap<String, usize> {
    let mut reasons = BTreeMap::new();
    for left in &evaluation.left_out {
        *reasons.entry(seen(&left.reason)).or_default() += 1;
    }
    reasons
}

/// Returns the table of the areas under the ROC and precision-recall curves, with a row for each estimator.
fn areas(evaluation: &Evaluation) -> Table {
    let cases = evaluation.cases;
    let has_steps = evaluation.horizon_s.is_some();
    let names: Vec<String> = evaluation
        .estimators
        .iter()
        .map(|e| seen(&e.name))
        .collect();
    let mut columns = vec![
        column("estimator", widest(names.iter())),
        column("ROC area", 20),
    ];
    let note = "areas with 95 % intervals over flights".to_owned();
    let note = match has_steps {
        true => {
            columns.push(column("quiet", 20));
            columns.push(column("after 10 s of quiet", 20));
            columns.push(column("within a flight", 25));
            note + "; within a flight: mean over the flights (their number) with both critical and other steps"
        }
        false => note,
    };
    columns.extend([column("PR area", 20), column("unknown", 0)]);
    let row = |(name, estimator): (String, &ProfileScores)| {
        let all = &estimator.all;
        let roc = |scores: &Scores| {
            let interval = scores.intervals.map(|i| i.roc);
            area(scores.areas.map(|a| a.roc), interval)
                .or_else(|| scores.no_area(cases))
                .unwrap_or_default()
        };
        let mut cells = vec![name, roc(all)];
        if has_steps {
            let within = all.within.and_then(|within| {
                let area = area(Some(within.roc), within.interval)?;
                Some(format!("{area} ({})", within.groups))
            });
            cells.extend([roc(&estimator.quiet), roc(&estimator.onset)]);
            cells.push(within.unwrap_or_else(|| "-".to_owned()));
        }
        let pr = area(
            all.areas.map(|a| a.precision_recall),
            all.intervals.map(|i| i.precision_recall),
        );
        cells.push(pr.unwrap_or_else(|| "-".to_owned()));
        cells.push(percent(all.unknown, all.cases + all.unknown, 0));
        cells
    };
    Table {
        title: String::new(),
        columns,
        rows: names
            .into_iter()
            .zip(&evaluation.estimators)
            .map(row)
            .collect(),
        notes: vec![note],
    }
}

/// A table of areas with a row for each group and a column for each estimator; `None` if there is only one group.
fn by(
    title: &str,
    evaluation: &Evaluation,
    groups: fn(&ProfileScores) -> &Vec<(String, Scores)>,
) -> Option<Table> {
    let first = groups(evaluation.estimators.first()?);
    if first.len() < 2 {
        return None;
    }
    let names: Vec<String> = first.iter().map(|(name, _)| seen(name)).collect();
    let mut columns = vec![
        column("", widest(names.iter())),
        number("cases", 7),
        number("critical", 8),
    ];
    columns.extend(evaluation.estimators.iter().map(|estimator| {
        let name = seen(&estimator.name);
        number(&name, name.chars().count())
    }));
    let rows = names.into_iter().zip(first).enumerate();
    let rows = rows.map(|(row, (name, (_, scores)))| {
        let cases = scores.cases + scores.unknown;
        let mut cells = vec![name, cases.to_string(), scores.critical.to_string()];
        cells.extend(evaluation.estimators.iter().map(|estimator| {
            let scores = groups(estimator).get(row).map(|(_, scores)| scores);
            let area = scores.and_then(|scores| scores.areas);
            area.map_or("-".to_owned(), |area| format!("{:.3}", area.roc))
        }));
        // This is the reason for the first estimator. It depends on the flights, so it is usually the same for all.
        let none = scores.no_area(evaluation.cases);
        cells.extend(none.filter(|_| scores.cases > 0));
        cells
    });
    Some(Table {
        title: title.to_owned(),
        columns,
        rows: rows.collect(),
        notes: Vec::new(),
    })
}

/// The table of the verdicts on the flights of each vehicle.
fn verdicts(evaluation: &Evaluation) -> Option<Table> {
    let mut vehicles: BTreeMap<String, Verdicts> = BTreeMap::new();
    for record in &evaluation.records {
        let vehicle = vehicles.entry(seen(record.vehicle_name()));
        vehicle.or_default().add(record);
    }
    let mut columns = vec![
        column("", widest(vehicles.keys())),
        number("flights", 7),
        number("hours", 6),
    ];
    let profiles = evaluation.estimators.iter().take(evaluation.alarms.len());
    columns.extend(profiles.map(|profile| column(&seen(&profile.name), 16)));
    let rows = vehicles.into_iter().map(|(name, of)| {
        let mut cells = vec![name, of.flights.to_string(), format!("{:.2}", of.hours)];
        cells.extend(of.counts.iter().map(|[good, warn, fail, na]| {
            let na = match na {
                0 => String::new(),
                na => format!(", {na} NA"),
            };
            format!("{good}/{warn}/{fail}{na}")
        }));
        cells
    });
    (!evaluation.records.is_empty()).then(|| Table {
        title: "verdicts by vehicle: GOOD/WARN/FAIL, NA".to_owned(),
        columns,
        rows: rows.collect(),
        notes: Vec::new(),
    })
}

/// A number with its noun, such as `1 flight` or `2 flights`.
pub(crate) fn count(number: usize, thing: &str) -> String {
    let plural = if number == 1 { "" } else { "s" };
    format!("{number} {thing}{plural}")
}

fn percent(part: usize, whole: usize, digits: usize) -> String {
    match whole {
        0 => "-".to_owned(),
        _ => format!("{:.digits$} %", 100.0 * part as f64 / whole as f64),
    }
}

/// Formats an area with its interval: `0.904 [0.882, 0.919]`.
fn area(area: Option<f64>, interval: Option<Interval>) -> Option<String> {
    let area = area?;
    Some(match interval {
        Some(interval) => format!("{area:.3} [{:.3}, {:.3}]", interval.low, interval.high),
        None => format!("{area:.3}"),
    })
}
