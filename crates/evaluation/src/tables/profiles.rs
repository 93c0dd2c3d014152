//! The tables of single profiles: alarms, warnings, reliability.

use super::{Table, column, number, percent, seen};
use crate::{
    alarms::{Alarms, Figure, NeedlessAlarms, Upsets},
    scores::ProfileScores,
    warnings::Warnings,
};

/// The table of the alarms of a profile in calm times and before upsets.
pub(super) fn alarms(name: &str, alarms: &Alarms) -> Table {
    let mut rows = vec![
        needless("calm stretches".to_owned(), &alarms.calm),
        needless("ordinary flights".to_owned(), &alarms.ordinary),
    ];
    let by_kind = match alarms.by_kind.as_slice() {
        [_] => &[],
        several => several,
    };
    rows.extend(
        by_kind
            .iter()
            .map(|(kind, calm, _)| needless(format!("calm, {}", seen(kind)), calm)),
    );
    let upsets = |of: &Upsets| {
        let lead = of
            .lead_s_median
            .map_or(String::new(), |s| format!(" (median lead {s:.1} s)"));
        let unknown = match of.not_assessed {
            0 => String::new(),
            n => format!("; {n} in flights without a verdict"),
        };
        format!(
            "{}; alarm before {}{lead}, within 1 s {}, never {}{unknown}",
            of.assessed() + of.not_assessed,
            of.before,
            of.within_1_s,
            of.never
        )
    };
    let mut notes = vec![format!("upsets: {}", upsets(&alarms.upsets))];
    if alarms.upsets.assessed() > 0 {
        let by_fail = upsets(&alarms.upsets_by_fail);
        notes.push(format!("upsets, by FAIL only: {by_fail}"));
    }
    let by_kind = by_kind
        .iter()
        .filter(|(_, _, of)| of.assessed() + of.not_assessed > 0);
    notes.extend(by_kind.map(|(kind, _, of)| format!("upsets, {}: {}", seen(kind), upsets(of))));
    Table {
        title: format!(
            "alarms of {name} in calm times (WARN or FAIL; a WARN that is raised to FAIL counts once)"
        ),
        columns: vec![
            column("", 22),
            number("flights", 7),
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

fn needless(name: String, of: &NeedlessAlarms) -> Vec<String> {
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
    let on = match of.share_of_time_on {
        Some(_) => format!("{} %", figure(of.share_of_time_on, 100.0)),
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

/// The table of the quality of the warnings of a profile.
pub(super) fn warnings(
    profile: &ProfileScores,
    all: &Warnings,
    by_kind: &[(String, Warnings)],
) -> Table {
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
            number("late by", 14),
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
    let on = of.share_of_time_on;
    vec![
        kind,
        format!("{:.2}", of.hours),
        of.episodes.to_string(),
        percent(of.announced, of.episodes, 0),
        seconds(of.lead_s_median),
        format!(
            "{} of {}",
            percent(of.groups_announced, of.groups, 0),
            of.groups
        ),
        seconds(of.group_lead_s_median),
        format!("{} ({})", seconds(of.delay_s_median), of.late),
        rate.map_or("-".to_owned(), |rate| format!("{rate:.1}")),
        on.map_or("-".to_owned(), |on| format!("{:.0} %", 100.0 * on)),
    ]
}

/// The table of how often cases in each band of the risk were critical; `None` for scores that are not risks.
pub(super) fn reliability(estimator: &ProfileScores) -> Option<Table> {
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
