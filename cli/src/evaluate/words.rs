//! The evaluation in words.

use std::io::{self, Write};

use flagred::evaluation::Interval;

use super::{
    Evaluation,
    scores::{APART, Scores},
    warnings::Warnings,
};

/// Writes an evaluation.
pub(super) fn write(out: &mut impl Write, evaluation: &Evaluation) -> io::Result<()> {
    let Some(first) = evaluation.estimators.first() else {
        return Ok(());
    };
    let cases = first.all.cases + first.all.unknown;
    let critical = evaluation.critical;
    let share = 100.0 * critical as f64 / cases.max(1) as f64;
    let vehicles = first.by_vehicle.len();
    let flights = evaluation.flights;
    let what = match evaluation.horizon_s {
        Some(horizon_s) => format!(
            "{flights} flights of {vehicles} vehicles, {cases} steps, {share:.2} % of them critical within {horizon_s} s"
        ),
        None => format!("{cases} flights of {vehicles} vehicles, {share:.2} % of them critical"),
    };
    writeln!(out, "{what}")?;
    let apart = first.by_kind.iter().find(|(kind, _)| kind == APART);
    if apart.is_some() {
        writeln!(
            out,
            "flights of kind `{APART}` are not in these figures, only under `by kind`: their errors are commanded"
        )?;
    }
    if evaluation.left_out > 0 {
        writeln!(out, "{} files left out", evaluation.left_out)?;
    }
    writeln!(out)?;

    let width = evaluation.estimators.iter().map(|e| e.name.chars().count());
    let width = width.max().unwrap_or(0);
    writeln!(
        out,
        "{:width$}  {:20}  {:20}  unknown",
        "estimator", "ROC area", "PR area"
    )?;
    for estimator in &evaluation.estimators {
        let all = &estimator.all;
        let unknown = 100.0 * all.unknown as f64 / cases.max(1) as f64;
        writeln!(
            out,
            "{:width$}  {:20}  {:20}  {unknown:.0} %",
            estimator.name,
            area(all.areas.map(|a| a.roc), all.intervals.map(|i| i.roc)),
            area(
                all.areas.map(|a| a.precision_recall),
                all.intervals.map(|i| i.precision_recall),
            ),
        )?;
    }
    writeln!(out, "areas with 95 % intervals over whole flights")?;
    by(out, "ROC area by kind", evaluation, |e| &e.by_kind)?;
    by(out, "ROC area by vehicle", evaluation, |e| &e.by_vehicle)?;

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

/// `0.904 [0.882, 0.919]`
fn area(area: Option<f64>, interval: Option<Interval>) -> String {
    let Some(area) = area else {
        return "-".to_owned();
    };
    match interval {
        Some(interval) => format!("{area:.3} [{:.3}, {:.3}]", interval.low, interval.high),
        None => format!("{area:.3}"),
    }
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
        writeln!(out)?;
    }
    Ok(())
}

fn line(warnings: &Warnings) -> String {
    let share = |part: usize, whole: usize| match whole {
        0 => "-".to_owned(),
        _ => format!("{:.0} %", 100.0 * part as f64 / whole as f64),
    };
    let seconds = |seconds: Option<f64>| seconds.map_or("-".to_owned(), |s| format!("{s:.1} s"));
    let groups = format!(
        "{} of {}",
        share(warnings.groups_announced, warnings.groups),
        warnings.groups
    );
    let answered = format!("{} ({})", seconds(warnings.answer_s), warnings.answered);
    let false_per_hour = warnings.false_per_hour();
    format!(
        "{:>5.2}  {:>8}  {:>9}  {:>6}  {groups:>15}  {:>6}  {answered:>14}  {:>7}  {:>6}",
        warnings.hours,
        warnings.episodes,
        share(warnings.announced, warnings.episodes),
        seconds(warnings.lead_s),
        seconds(warnings.group_lead_s),
        false_per_hour.map_or("-".to_owned(), |rate| format!("{rate:.1}")),
        warnings
            .share_on
            .map_or("-".to_owned(), |on| format!("{:.0} %", 100.0 * on)),
    )
}
