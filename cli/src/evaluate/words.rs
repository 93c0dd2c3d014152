//! The evaluation in words.

use std::{
    collections::{BTreeMap, BTreeSet},
    io::{self, Write},
};

use flagred::evaluation::Interval;

use super::{
    Evaluation,
    alarms::{Alarms, Figure, SmallErrors, Upsets, Verdicts},
    flight::Record,
    scores::{APART, Scores},
    warnings::Warnings,
};

/// Writes an evaluation.
pub(super) fn write(out: &mut impl Write, evaluation: &Evaluation) -> io::Result<()> {
    head(out, evaluation)?;
    areas(out, evaluation)?;
    by(out, "ROC area by kind", evaluation, |e| &e.by_kind)?;
    by(out, "ROC area by vehicle", evaluation, |e| &e.by_vehicle)?;
    verdicts(out, evaluation)?;
    for (estimator, alarms) in evaluation.estimators.iter().zip(&evaluation.alarms) {
        self::alarms(out, &estimator.name, alarms)?;
    }
    for (estimator, (all, by_kind)) in evaluation.estimators.iter().zip(&evaluation.warnings) {
        writeln!(out, "\nwarnings of {}", estimator.name)?;
        writeln!(
            out,
            "  {:12}  {:>5}  {:>8}  {:>9}  {:>6}  {:>15}  {:>6}  {:>14}  {:>7}  {:>6}",
            "kind",
            "hours",
            "episodes",
            "announced",
            "lead",
            "groups announced",
            "lead",
            "answered after",
            "false/h",
            "on"
        )?;
        for (kind, warnings) in [(&"all".to_owned(), all)]
            .into_iter()
            .chain(by_kind.iter().map(|(k, w)| (k, w)))
        {
            writeln!(out, "  {kind:12}  {}", line(warnings))?;
        }
    }
    for estimator in &evaluation.estimators {
        let Some(bands) = &estimator.reliability else {
            continue;
        };
        writeln!(
            out,
            "\nreliability of {}: risk, cases, share that became critical",
            estimator.name
        )?;
        for band in bands {
            let share = match band.predictions {
                0 => "-".to_owned(),
                n => format!("{:.1} %", 100.0 * band.critical as f64 / n as f64),
            };
            let range = format!("{:.0} to {:.0} %", band.from_pct, band.to_pct);
            writeln!(out, "  {range:>11}  {:>8}  {share:>8}", band.predictions)?;
        }
    }
    Ok(())
}

/// What was evaluated, and what was not.
fn head(out: &mut impl Write, evaluation: &Evaluation) -> io::Result<()> {
    let Some(first) = evaluation.estimators.first() else {
        return Ok(());
    };
    let flights = evaluation.flights;
    let cases = first.all.cases + first.all.unknown;
    let Some(horizon_s) = evaluation.horizon_s else {
        let vehicles = first.by_vehicle.len();
        let share = percent(evaluation.critical, cases, 2);
        writeln!(
            out,
            "{cases} flights of {vehicles} vehicles, {share} of them critical"
        )?;
        return writeln!(out);
    };
    let main = || evaluation.records.iter().filter(|r| r.kind != APART);
    let named: BTreeSet<&str> = main().filter_map(|r| r.vehicle.as_deref()).collect();
    let vehicles = named.len();
    let hours = main().map(Record::air_s).sum::<f64>() / 3600.0;
    writeln!(
        out,
        "{flights} flights of {vehicles} vehicles, {hours:.2} h in the air, {cases} steps"
    )?;
    writeln!(
        out,
        "critical within {horizon_s} s: {} of all steps, {} of {} quiet ones (5 s without a critical error), {} of {} after 10 s of quiet",
        percent(evaluation.critical, cases, 2),
        percent(first.quiet.critical, first.quiet.cases, 2),
        first.quiet.cases + first.quiet.unknown,
        percent(first.onset.critical, first.onset.cases, 2),
        first.onset.cases + first.onset.unknown,
    )?;
    if first.by_kind.iter().any(|(kind, _)| kind == APART) {
        writeln!(
            out,
            "flights of kind `{APART}` are not in these figures, only under `by kind`: their errors are commanded"
        )?;
    }
    let left_out = &evaluation.left_out;
    if !left_out.is_empty() {
        let mut reasons: BTreeMap<&str, usize> = BTreeMap::new();
        for left in left_out {
            *reasons.entry(&left.reason).or_default() += 1;
        }
        writeln!(out, "{} files left out:", left_out.len())?;
        for (reason, files) in reasons {
            writeln!(out, "  {files:>4}  {reason}")?;
        }
    }
    writeln!(out)
}

/// The areas of each estimator.
fn areas(out: &mut impl Write, evaluation: &Evaluation) -> io::Result<()> {
    let cases = evaluation.cases;
    let has_steps = evaluation.horizon_s.is_some();
    let width = evaluation.estimators.iter().map(|e| e.name.chars().count());
    let width = width.max().unwrap_or(0);
    write!(out, "{:width$}  {:20}", "estimator", "ROC area")?;
    if has_steps {
        write!(
            out,
            "  {:20}  {:20}  {:25}",
            "quiet", "after 10 s of quiet", "within a flight"
        )?;
    }
    writeln!(out, "  {:20}  unknown", "PR area")?;
    for estimator in &evaluation.estimators {
        let all = &estimator.all;
        let roc = |scores: &Scores| {
            let interval = scores.intervals.map(|i| i.roc);
            area(scores.areas.map(|a| a.roc), interval)
                .or_else(|| scores.no_area(cases))
                .unwrap_or_default()
        };
        write!(out, "{:width$}  {:20}", estimator.name, roc(all))?;
        if has_steps {
            let within = all.within.and_then(|within| {
                let area = area(Some(within.roc), within.interval)?;
                Some(format!("{area} ({})", within.groups))
            });
            let (quiet, onset) = (roc(&estimator.quiet), roc(&estimator.onset));
            let within = within.unwrap_or_else(|| "-".to_owned());
            write!(out, "  {quiet:20}  {onset:20}  {within:25}")?;
        }
        let pr = area(
            all.areas.map(|a| a.precision_recall),
            all.intervals.map(|i| i.precision_recall),
        );
        let unknown = percent(all.unknown, all.cases + all.unknown, 0);
        let pr = pr.unwrap_or_else(|| "-".to_owned());
        writeln!(out, "  {pr:20}  {unknown}")?;
    }
    write!(out, "areas with 95 % intervals over flights")?;
    match has_steps {
        true => writeln!(
            out,
            "; within a flight: mean over the flights (their number) with critical steps and others"
        ),
        false => writeln!(out),
    }
}

/// How the flights of each vehicle were judged.
fn verdicts(out: &mut impl Write, evaluation: &Evaluation) -> io::Result<()> {
    if evaluation.records.is_empty() {
        return Ok(());
    }
    let mut vehicles: BTreeMap<&str, Verdicts> = BTreeMap::new();
    for record in &evaluation.records {
        vehicles
            .entry(record.vehicle_name())
            .or_default()
            .add(record);
    }
    let wide = vehicles.keys().map(|name| name.chars().count());
    let wide = wide.max().unwrap_or(0);
    writeln!(out, "\nverdicts by vehicle: GOOD/WARN/FAIL, NA")?;
    write!(out, "  {:wide$}  {:>7}  {:>6}", "", "flights", "hours")?;
    let profiles = || evaluation.estimators.iter().take(evaluation.alarms.len());
    for profile in profiles() {
        write!(out, "  {:16}", profile.name)?;
    }
    writeln!(out)?;
    for (name, of) in vehicles {
        write!(out, "  {name:wide$}  {:>7}  {:>6.2}", of.flights, of.hours)?;
        for [good, warn, fail, na] in of.counts {
            let na = match na {
                0 => String::new(),
                na => format!(", {na} NA"),
            };
            write!(out, "  {:16}", format!("{good}/{warn}/{fail}{na}"))?;
        }
        writeln!(out)?;
    }
    Ok(())
}

/// The alarms of a profile on flights with small errors, and before upsets.
fn alarms(out: &mut impl Write, name: &str, alarms: &Alarms) -> io::Result<()> {
    writeln!(
        out,
        "\nalarms of {name} (WARN or FAIL; a WARN that turns FAIL is one) on flights whose error stays small"
    )?;
    writeln!(
        out,
        "  {:22}  {:>7}  {:>5}  {:14}  {:>6}  {:>22}  {:>4}  {:>20}  on",
        "flights", "number", "hours", "GOOD/WARN/FAIL", "alarms", "alarms/h", "FAIL", "FAIL/h"
    )?;
    small_errors(out, "ordinary (up to 5 deg)", &alarms.ordinary)?;
    small_errors(out, "mild (up to 10 deg)", &alarms.mild)?;
    if alarms.by_kind.len() > 1 {
        for (kind, ordinary, _) in &alarms.by_kind {
            small_errors(out, &format!("ordinary, {kind}"), ordinary)?;
        }
    }
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
    writeln!(out, "  upsets: {}", upsets(&alarms.upsets))?;
    if alarms.upsets.assessed() > 0 {
        writeln!(
            out,
            "  upsets, by FAIL alone: {}",
            upsets(&alarms.upsets_by_fail)
        )?;
    }
    if alarms.by_kind.len() > 1 {
        for (kind, _, of) in &alarms.by_kind {
            if of.assessed() + of.not_assessed > 0 {
                writeln!(out, "  upsets, {kind}: {}", upsets(of))?;
            }
        }
    }
    Ok(())
}

fn small_errors(out: &mut impl Write, name: &str, of: &SmallErrors) -> io::Result<()> {
    let figure = |figure: Option<Figure>, scale: f64, digits: usize| {
        let Some(Figure { value, interval }) = figure else {
            return "-".to_owned();
        };
        let text = |value: f64| format!("{:.digits$}", scale * value);
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
        Some(_) => format!("{} %", figure(of.share_on, 100.0, 1)),
        None => "-".to_owned(),
    };
    writeln!(
        out,
        "  {name:22}  {:>7}  {:>5.2}  {:14}  {:>6}  {:>22}  {:>4}  {:>20}  {on}{unknown}",
        of.flights,
        of.hours,
        format!("{good}/{warn}/{fail}"),
        of.alarms,
        figure(of.alarms_per_hour, 1.0, 1),
        of.fails,
        figure(of.fails_per_hour, 1.0, 1),
    )
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

/// A table of areas with a row for each group and a column for each estimator.
fn by(
    out: &mut impl Write,
    title: &str,
    evaluation: &Evaluation,
    groups: fn(&super::scores::Evaluated) -> &Vec<(String, Scores)>,
) -> io::Result<()> {
    let Some(first) = evaluation.estimators.first() else {
        return Ok(());
    };
    if groups(first).len() < 2 {
        return Ok(());
    }
    let wide = groups(first).iter().map(|(name, _)| name.chars().count());
    let wide = wide.max().unwrap_or(0);
    writeln!(out, "\n{title}")?;
    write!(out, "  {:wide$}  {:>7}  {:>8}", "", "cases", "critical")?;
    for estimator in &evaluation.estimators {
        write!(out, "  {}", estimator.name)?;
    }
    writeln!(out)?;
    for (row, (name, scores)) in groups(first).iter().enumerate() {
        let cases = scores.cases + scores.unknown;
        write!(out, "  {name:wide$}  {cases:>7}  {:>8}", scores.critical)?;
        for estimator in &evaluation.estimators {
            let scores = groups(estimator).get(row).map(|(_, scores)| scores);
            let area = scores.and_then(|scores| scores.areas);
            let text = area.map_or("-".to_owned(), |area| format!("{:.3}", area.roc));
            write!(out, "  {text:>0$}", estimator.name.chars().count())?;
        }
        // The same for all estimators: critical cases, or none, are those of the flights.
        let none = scores.no_area(evaluation.cases);
        match none.filter(|_| scores.cases > 0) {
            Some(none) => writeln!(out, "  {none}")?,
            None => writeln!(out)?,
        }
    }
    Ok(())
}

fn line(warnings: &Warnings) -> String {
    let seconds = |seconds: Option<f64>| seconds.map_or("-".to_owned(), |s| format!("{s:.1} s"));
    let groups = format!(
        "{} of {}",
        percent(warnings.groups_announced, warnings.groups, 0),
        warnings.groups
    );
    let answered = format!("{} ({})", seconds(warnings.answer_s), warnings.answered);
    let false_per_hour = warnings.false_per_hour();
    format!(
        "{:>5.2}  {:>8}  {:>9}  {:>6}  {groups:>15}  {:>6}  {answered:>14}  {:>7}  {:>6}",
        warnings.hours,
        warnings.episodes,
        percent(warnings.announced, warnings.episodes, 0),
        seconds(warnings.lead_s),
        seconds(warnings.group_lead_s),
        false_per_hour.map_or("-".to_owned(), |rate| format!("{rate:.1}")),
        warnings
            .share_on
            .map_or("-".to_owned(), |on| format!("{:.0} %", 100.0 * on)),
    )
}
