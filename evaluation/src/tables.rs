//! The evaluation as tables, which [`words`](crate::words) and [`page`](crate::page) show.

use std::collections::{BTreeMap, BTreeSet};

use flagred::evaluation::Interval;
use fuzzy::drawing::visible;

use crate::{
    Evaluation,
    alarms::{Alarms, Figure, SmallErrors, Upsets, Verdicts},
    flight::Record,
    scores::{APART, Evaluated, Scores},
    warnings::Warnings,
};

/// A table, with what is said below it.
pub(crate) struct Table {
    /// Empty for the first.
    pub(crate) title: String,
    pub(crate) columns: Vec<Column>,
    /// A row may have a cell more than there are columns.
    pub(crate) rows: Vec<Vec<String>>,
    pub(crate) notes: Vec<String>,
}

pub(crate) struct Column {
    pub(crate) head: String,
    /// In characters; 0 where nothing follows.
    pub(crate) width: usize,
    /// Numbers stand on the right.
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

/// A name that comes from outside.
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

/// What was evaluated, in lines.
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
            "{cases} flights of {vehicles} vehicles, {share} of them critical"
        )];
    };
    let main = || evaluation.records.iter().filter(|r| r.kind != APART);
    let named: BTreeSet<&str> = main().filter_map(|r| r.vehicle.as_deref()).collect();
    let vehicles = named.len();
    let hours = main().map(Record::air_s).sum::<f64>() / 3600.0;
    let mut lines = vec![
        format!("{flights} flights of {vehicles} vehicles, {hours:.2} h in the air, {cases} steps"),
        format!(
            "critical within {horizon_s} s: {} of all steps, {} of {} quiet ones (5 s without a critical error), {} of {} after 10 s of quiet",
            percent(evaluation.critical, cases, 2),
            percent(first.quiet.critical, first.quiet.cases, 2),
            first.quiet.cases + first.quiet.unknown,
            percent(first.onset.critical, first.onset.cases, 2),
            first.onset.cases + first.onset.unknown,
        ),
    ];
    if first.by_kind.iter().any(|(kind, _)| kind == APART) {
        lines.push(format!(
            "flights of kind `{APART}` are not in these figures, only under `by kind`: their errors are commanded"
        ));
    }
    lines
}

/// The reasons for which files were left out, and of how many.
pub(crate) fn left_out(evaluation: &Evaluation) -> BTreeMap<String, usize> {
    let mut reasons = BTreeMap::new();
    for left in &evaluation.left_out {
        *reasons.entry(seen(&left.reason)).or_default() += 1;
    }
    reasons
}

/// The areas of each estimator.
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
            note + "; within a flight: mean over the flights (their number) with critical steps and others"
        }
        false => note,
    };
    columns.extend([column("PR area", 20), column("unknown", 0)]);
    let row = |(name, estimator): (String, &Evaluated)| {
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

/// Areas with a row for each group and a column for each estimator; `None` for a single group.
fn by(
    title: &str,
    evaluation: &Evaluation,
    groups: fn(&Evaluated) -> &Vec<(String, Scores)>,
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
        // The same for all estimators: critical cases, or none, are those of the flights.
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

/// How the flights of each vehicle were judged.
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

/// The alarms of a profile on flights with small errors, and before upsets.
fn alarms(name: &str, alarms: &Alarms) -> Table {
    let mut rows = vec![
        small_errors("ordinary (up to 5 deg)".to_owned(), &alarms.ordinary),
        small_errors("mild (up to 10 deg)".to_owned(), &alarms.mild),
    ];
    let by_kind = match alarms.by_kind.as_slice() {
        [_] => &[],
        several => several,
    };
    rows.extend(
        by_kind
            .iter()
            .map(|(kind, ordinary, _)| small_errors(format!("ordinary, {}", seen(kind)), ordinary)),
    );
    let upsets = |of: &Upsets| {
        let lead = of
            .lead_s
            .map_or(String::new(), |s| format!(" (median lead {s:.1} s)"));
        let unknown = match of.not_assessed {
            0 => String::new(),
            n => format!("; {n} in flights without a verdict"),
        };
        format!(
            "{}; alarm before {}{lead}, within 1 s {}, never {}{unknown}",
            of.assessed() + of.not_assessed,
            of.before,
            of.after,
            of.never
        )
    };
    let mut notes = vec![format!("upsets: {}", upsets(&alarms.upsets))];
    if alarms.upsets.assessed() > 0 {
        let by_fail = upsets(&alarms.upsets_by_fail);
        notes.push(format!("upsets, by FAIL alone: {by_fail}"));
    }
    let by_kind = by_kind
        .iter()
        .filter(|(_, _, of)| of.assessed() + of.not_assessed > 0);
    notes.extend(by_kind.map(|(kind, _, of)| format!("upsets, {}: {}", seen(kind), upsets(of))));
    Table {
        title: format!(
            "alarms of {name} (WARN or FAIL; a WARN that turns FAIL is one) on flights whose error stays small"
        ),
        columns: vec![
            column("flights", 22),
            number("number", 7),
            number("hours", 5),
            column("GOOD/WARN/FAIL", 14),
            number("alarms", 6),
            number("alarms/h", 22),
            number("FAIL", 4),
            number("FAIL/h", 20),
            column("on", 0),
        ],
        rows,
        notes,
    }
}

fn small_errors(name: String, of: &SmallErrors) -> Vec<String> {
    let figure = |figure: Option<Figure>, scale: f64| {
        let Some(Figure { value, interval }) = figure else {
            return "-".to_owned();
        };
        let text = |value: f64| format!("{:.1}", scale * value);
        match interval {
            Some(i) => format!("{} [{}, {}]", text(value), text(i.low), text(i.high)),
            None => text(value),
        }
    };
    let [good, warn, fail] = of.verdicts;
    let unknown = match of.not_assessed {
        0 => String::new(),
        n => format!(" ({n} more NA)"),
    };
    let on = match of.share_on {
        Some(_) => format!("{} %", figure(of.share_on, 100.0)),
        None => "-".to_owned(),
    };
    vec![
        name,
        of.flights.to_string(),
        format!("{:.2}", of.hours),
        format!("{good}/{warn}/{fail}"),
        of.alarms.to_string(),
        figure(of.alarms_per_hour, 1.0),
        of.fails.to_string(),
        figure(of.fails_per_hour, 1.0),
        on + &unknown,
    ]
}

/// What the warnings of a profile are worth.
fn warnings(profile: &Evaluated, all: &Warnings, by_kind: &[(String, Warnings)]) -> Table {
    let by_kind = by_kind.iter().map(|(kind, of)| warned(seen(kind), of));
    Table {
        title: format!("warnings of {}", seen(&profile.name)),
        columns: vec![
            column("kind", 12),
            number("hours", 5),
            number("episodes", 8),
            number("announced", 9),
            number("lead", 6),
            number("groups announced", 15),
            number("lead", 6),
            number("answered after", 14),
            number("false/h", 7),
            number("on", 6),
        ],
        rows: [warned("all".to_owned(), all)]
            .into_iter()
            .chain(by_kind)
            .collect(),
        notes: Vec::new(),
    }
}

fn warned(kind: String, of: &Warnings) -> Vec<String> {
    let seconds = |seconds: Option<f64>| seconds.map_or("-".to_owned(), |s| format!("{s:.1} s"));
    let rate = of.false_per_hour();
    let on = of.share_on;
    vec![
        kind,
        format!("{:.2}", of.hours),
        of.episodes.to_string(),
        percent(of.announced, of.episodes, 0),
        seconds(of.lead_s),
        format!(
            "{} of {}",
            percent(of.groups_announced, of.groups, 0),
            of.groups
        ),
        seconds(of.group_lead_s),
        format!("{} ({})", seconds(of.answer_s), of.answered),
        rate.map_or("-".to_owned(), |rate| format!("{rate:.1}")),
        on.map_or("-".to_owned(), |on| format!("{:.0} %", 100.0 * on)),
    ]
}

/// How often what had a risk became critical; `None` for scores that are no risks.
fn reliability(estimator: &Evaluated) -> Option<Table> {
    let bands = estimator.reliability.as_ref()?.iter();
    let rows = bands.map(|band| {
        let share = match band.predictions {
            0 => "-".to_owned(),
            n => format!("{:.1} %", 100.0 * band.critical as f64 / n as f64),
        };
        let range = format!("{:.0} to {:.0} %", band.from_pct, band.to_pct);
        vec![range, band.predictions.to_string(), share]
    });
    Some(Table {
        title: format!(
            "reliability of {}: risk, cases, share that became critical",
            seen(&estimator.name)
        ),
        columns: vec![number("", 11), number("", 8), number("", 8)],
        rows: rows.collect(),
        notes: Vec::new(),
    })
}

fn percent(part: usize, whole: usize, digits: usize) -> String {
    match whole {
        0 => "-".to_owned(),
        _ => format!("{:.digits$} %", 100.0 * part as f64 / whole as f64),
    }
}

/// `0.904 [0.882, 0.919]`
fn area(area: Option<f64>, interval: Option<Interval>) -> Option<String> {
    let area = area?;
    Some(match interval {
        Some(interval) => format!("{area:.3} [{:.3}, {:.3}]", interval.low, interval.high),
        None => format!("{area:.3}"),
    })
}
