//! The assessment of a flight in words, for the terminal.

use std::io::{self, Write};

use anstyle::{AnsiColor, Style};
use flagred::{
    estimator::Estimator,
    flight::{Assessment, Peak, Summary, UnknownRisk, Verdict},
    profile::{ErrorFrequency, Profile},
    shipped,
    verdict::{Level, LevelSettings, VerdictSettings},
};
use flagred_flightlog::Flight;
use fuzzy::drawing::{number, visible};

use crate::{
    curve::over_time_text,
    finding::{self, FindingContext},
};

/// The number of columns of the picture of risk over time.
const PICTURE_COLUMNS: usize = 64;

/// Writes the assessment of one flight: one line for each cause, or every finding with its details.
pub fn write(
    out: &mut impl Write,
    name: &str,
    flight: &Flight,
    estimator: &Estimator,
    assessed: &Assessment,
    verbose: bool,
) -> io::Result<()> {
    let style = style(&assessed.verdict);
    writeln!(
        out,
        "{style}{:<4}{style:#} {}",
        assessed.verdict,
        visible(name)
    )?;
    indented(out, &vehicle(flight))?;
    if let Verdict::NotAvailable(reason) = &assessed.verdict {
        indented(out, &format!("no verdict: {reason}"))?;
        if let Some(help) = reason.help() {
            indented(out, &format!("help: {help}"))?;
        }
    }
    if !flight.report.is_clean() {
        indented(out, &damage(&flight.report))?;
    }
    for note in notes(flight, assessed) {
        indented(out, &note)?;
    }
    if let Some(spans) = &flight.in_air
        && assessed.summary.in_air_s > 0.0
    {
        let when = spans
            .spans
            .iter()
            .map(|s| format!("{:.1} to {:.1} s", s.start_s, s.end_s));
        let mut text = format!(
            "{} {:.1} s (log time {})",
            in_the_air(flight),
            assessed.summary.in_air_s,
            first_spans(when)
        );
        if let Some(rate_hz) = flight.command_rate_hz().filter(|_| verbose) {
            text += &format!(", motors at {rate_hz:.1} Hz");
        }
        let profile = &estimator.profile().name;
        if verbose || *profile != shipped::PROFILES[0].name {
            text += &format!("; profile {}", visible(profile));
        }
        indented(out, &text)?;
        if verbose {
            indented(out, &levels(&estimator.profile().verdict))?;
        }
    }
    if assessed.summary.assessed_s > 0.0 || assessed.summary.risk_max.is_some() {
        indented(out, &summary(assessed, verbose))?;
    }
    for (risk, output) in assessed.other_risks.iter().enumerate() {
        if let Some(peak) = finding::highest_other(assessed, risk) {
            indented(out, &format!("{output}: highest {}", at(peak)))?;
        }
    }
    if verbose && let Some(text) = reliability(&assessed.summary, estimator.profile()) {
        indented(out, &text)?;
    }
    writeln!(out)?;
    let context = FindingContext {
        estimator,
        motors: &flight.motors,
    };
    if verbose {
        for finding in &assessed.findings {
            let code = context.words(finding).code;
            let text = format!("{} [{code}]", context.finding(finding));
            line(out, finding.severity, &text)?;
            indented(out, &finding::advice(context, finding, flight))?;
            indented(out, &context.details(finding))?;
        }
    } else {
        for one in finding::lines(&assessed.findings) {
            line(out, one.worst.severity, &context.line(&one))?;
            indented(out, &finding::advice(context, one.worst, flight))?;
        }
    }
    if !assessed.findings.is_empty() {
        writeln!(out)?;
    }
    let judged = assessed.steps.iter().filter(|step| step.judged);
    let points: Vec<(f64, Option<f64>)> = judged
        .map(|step| (step.t_s, step.estimate.map(|e| e.risk_pct)))
        .collect();
    if points.iter().any(|(_, risk)| risk.is_some()) {
        let others = estimator.profile().other_risks.iter();
        let others: Vec<_> = others.map(|risk| visible(&risk.output)).collect();
        match others.is_empty() {
            true => writeln!(out, "risk over time")?,
            false => writeln!(out, "risk over time (not shown: {})", others.join(" and "))?,
        }
        writeln!(out, "{}", over_time_text(&points, PICTURE_COLUMNS))?;
    }
    Ok(())
}

/// Writes the assessment of one of several flights on one line: the verdict or the reason why there is none, the log, the
/// highest risks, unknown risks, assumed inputs and the most severe finding.
pub fn write_line(
    out: &mut impl Write,
    name: &str,
    flight: &Flight,
    estimator: &Estimator,
    assessed: &Assessment,
) -> io::Result<()> {
    let style = style(&assessed.verdict);
    let verdict = &assessed.verdict;
    let mut parts = Vec::new();
    if let Verdict::NotAvailable(reason) = verdict {
        parts.push(format!("no verdict: {reason}"));
    }
    if let Some(peak) = assessed.summary.risk_max {
        parts.push(format!(
            "highest risk {:.0} % in {:.1} s {}",
            peak.value_pct,
            assessed.summary.in_air_s,
            in_the_air(flight)
        ));
    }
    for (risk, output) in assessed.other_risks.iter().enumerate() {
        let peak = finding::highest_other(assessed, risk);
        parts.extend(peak.map(|peak| format!("highest {output} {:.0} %", peak.value_pct)));
    }
    parts.extend(
        unknown_risks(assessed)
            .into_iter()
            .map(|(unknown, _)| unknown),
    );
    for assumed in &assessed.assumed_inputs {
        let value = number(assumed.value, 6);
        parts.push(format!("`{}` assumed to be {value}", assumed.input));
    }
    let context = FindingContext {
        estimator,
        motors: &flight.motors,
    };
    let lines = finding::lines(&assessed.findings);
    if let Some(worst) = lines.first() {
        parts.push(context.line(worst).trim_end_matches('.').to_owned());
    }
    match lines.len() {
        0 | 1 => {}
        2 => parts.push("1 more finding".into()),
        count => parts.push(format!("{} more findings", count - 1)),
    }
    let (name, text) = (visible(name), parts.join("; "));
    writeln!(
        out,
        "{style}{verdict:<4}{style:#} {name}: {}",
        visible(&text)
    )
}

fn line(out: &mut impl Write, level: Level, text: &str) -> io::Result<()> {
    let style = level_style(level);
    writeln!(out, "{style}{level:<4}{style:#} {}", visible(text))
}

fn indented(out: &mut impl Write, text: &str) -> io::Result<()> {
    writeln!(out, "     {}", visible(text))
}

/// The words for the time in which a vehicle is assessed: "in the air", or "in use" for a vehicle without motors,
/// which may not fly at all.
pub(crate) fn in_the_air(flight: &Flight) -> &'static str {
    match flight.motors.is_empty() {
        true => "in use",
        false => "in the air",
    }
}

/// The vehicle on one line: format of the log, firmware, frame, motors and ranges.
pub fn vehicle(flight: &Flight) -> String {
    let mut parts = vec![flight.format.to_string()];
    parts.extend(flight.vehicle.firmware.clone());
    parts.extend(flight.vehicle.frame.clone());
    if let (Some(first), Some(last)) = (flight.motors.first(), flight.motors.last()) {
        parts.push(match flight.motors.len() {
            1 => format!("1 motor ({})", first.output),
            n => format!("{n} motors ({}..{})", first.output, last.output),
        });
    }
    if let Some(range) = &flight.range {
        let unit = match range.unit {
            "1" => "",
            unit => &format!(" {unit}"),
        };
        parts.push(format!("{} to {}{unit}", range.low, range.high));
        parts.push(effective_range(&flight.effective_range));
    }
    parts.join(", ")
}

/// The part of a range of commands that is used in flight.
pub fn effective_range(effective: &flagred_flightlog::Range) -> String {
    format!(
        "effective range {} to {} %",
        number(100.0 * effective.low, 1),
        number(100.0 * effective.high, 1)
    )
}

/// The largest share of the time in the air for which a risk may be unknown without a note.
const LARGEST_UNKNOWN_SHARE: f64 = 0.05;

/// The maximum number of spans of time that are listed on a line.
const MAX_SPANS: usize = 12;

/// The first spans, with the number of further spans.
pub fn first_spans(mut spans: impl ExactSizeIterator<Item = String>) -> String {
    let first: Vec<String> = spans.by_ref().take(MAX_SPANS).collect();
    match spans.len() {
        0 => first.join(", "),
        more => format!("{} and {more} more", first.join(", ")),
    }
}

/// The limitations of the verdict, such as assumed values, unknown risks, and data omitted from a log that is too
/// large.
pub fn notes(flight: &Flight, assessed: &Assessment) -> Vec<String> {
    let mut notes = Vec::new();
    if let Some(doubt) = &flight.effective_range_doubt {
        notes.push(format!("the effective range is the whole range: {doubt}"));
    }
    if !flight.assumed.is_empty() {
        let assumed = flight.assumed.join("; ");
        notes.push(format!(
            "the log does not report everything; assumed values: {assumed}"
        ));
    }
    for assumed in &assessed.assumed_inputs {
        notes.push(format!(
            "`{}` is not in the log: input `{}` is assumed to be {} (`if_missing`)",
            missing(flight, &assumed.signals),
            assumed.input,
            number(assumed.value, 6)
        ));
    }
    for (unknown, help) in unknown_risks(assessed) {
        notes.push(unknown + &help.map_or(String::new(), |help| format!("; {help}")));
    }
    let left_out = &flight.report.left_out;
    if !left_out.is_empty() {
        notes.push(format!(
            "the log exceeds the limits of the reader: {left_out} are left out"
        ));
    }
    if assessed.findings_left_out > 0 {
        notes.push(format!(
            "the {} most severe findings are kept, {} others are left out",
            assessed.findings.len(),
            assessed.findings_left_out
        ));
    }
    if let Some(step_s) = assessed.widened_step_s {
        notes.push(format!(
            "the steps are {} s apart, so that at most {} are kept",
            number(step_s, 6),
            flagred::flight::MAX_STEPS
        ));
    }
    notes
}

/// The risks that were unknown for more than 5 % of the time, each with the reason and advice. If there is no verdict,
/// the reason for that is reported elsewhere. Therefore a risk that is unknown for the same reason is left out, and so
/// is the only risk of a profile if it was never known.
fn unknown_risks(assessed: &Assessment) -> Vec<(String, Option<&'static str>)> {
    let in_air_s = assessed.summary.in_air_s;
    let is_reported = |risk: &UnknownRisk| match &assessed.verdict {
        Verdict::NotAvailable(reason) => {
            let is_only = assessed.other_risks.is_empty() && assessed.summary.assessed_s == 0.0;
            is_only || reason.to_string().starts_with(&risk.reason)
        }
        Verdict::Known(_) => false,
    };
    let unknown = assessed
        .unknown_risks
        .iter()
        .filter(|risk| risk.unknown_s > LARGEST_UNKNOWN_SHARE * in_air_s && !is_reported(risk));
    let sentences = unknown.map(|risk| {
        let share_pct = 100.0 * risk.unknown_s / in_air_s;
        let time = match share_pct >= 99.5 {
            true => "the whole time".to_owned(),
            false => format!("{share_pct:.0} % of the time"),
        };
        let sentence = format!("`{}` is unknown for {time}: {}", risk.output, risk.reason);
        (sentence, risk.help)
    });
    sentences.collect()
}

/// The first of the given signals that is missing from the log.
fn missing<'a>(flight: &Flight, signals: &'a [String]) -> &'a str {
    let mut signals = signals.iter();
    signals
        .find(|name| flight.signal(name).is_none())
        .map_or("", String::as_str)
}

/// If at most this number of bytes is damaged, and only at the end, the log was probably cut off inside a message when
/// the power was lost.
const ONE_MESSAGE_BYTES: u64 = 256;

/// Describes the damage of a log that could be read in part.
pub fn damage(report: &flagred_flightlog::Report) -> String {
    if let Some(reason) = report
        .reason
        .as_ref()
        .filter(|reason| reason.contains("gzip"))
    {
        return format!(
            "the rest of the flight is missing: {reason}; copy or download the file again"
        );
    }
    if report.truncated && report.bad_messages == 0 && report.skipped_bytes <= ONE_MESSAGE_BYTES {
        let (last, are) = match report.skipped_bytes {
            1 => ("last byte".to_owned(), "is"),
            bytes => (format!("last {bytes} bytes"), "are"),
        };
        return format!("the log ends inside a message: its {last} {are} ignored");
    }
    let mut parts = Vec::new();
    if report.bad_messages > 0 {
        let plural = if report.bad_messages == 1 { "" } else { "s" };
        parts.push(format!("{} bad message{plural}", report.bad_messages));
    }
    if report.skipped_bytes > 0 {
        parts.push(format!(
            "{} of {} bytes skipped",
            report.skipped_bytes, report.bytes
        ));
    }
    if report.truncated {
        parts.push("the end is missing".to_owned());
    }
    let reason = report
        .reason
        .as_ref()
        .map(|r| format!(" ({r})"))
        .unwrap_or_default();
    format!("damaged log, read in part: {}{reason}", parts.join(", "))
}

/// Describes what is lost when a log is written as flight CSV.
pub fn conversion(name: &str, flight: &Flight) -> Vec<String> {
    let report = &flight.report;
    let damage = report.reason.as_ref();
    let damage = damage
        .map(|reason| format!("`{name}` is damaged: {reason}; the undamaged part is converted"));
    let left_out = &report.left_out;
    let left_out = (!left_out.is_empty())
        .then(|| format!("`{name}` exceeds the limits of the reader: {left_out} are left out"));
    damage.into_iter().chain(left_out).collect()
}

fn summary(assessed: &Assessment, verbose: bool) -> String {
    let summary = &assessed.summary;
    let at = |peak: Option<Peak>| peak.map_or("unknown".to_owned(), at);
    let share = |part: f64| 100.0 * part / summary.in_air_s;
    let mut text = match summary.risk_mean_pct {
        Some(mean) => format!("risk: mean {mean:.0} %, highest {}", at(summary.risk_max)),
        None => "risk: not judged at any time of the flight".to_owned(),
    };
    if verbose {
        text += &format!("; elevated risk: highest {}", at(summary.elevated_risk_max));
    }
    if summary.filled_s > 0.0 {
        text += &format!(
            "; interpolated for {:.0} % of the time, where no rule applies",
            share(summary.filled_s)
        );
    }
    text
}

fn at(peak: Peak) -> String {
    format!("{:.0} % at {:.1} s", peak.value_pct, peak.t_s)
}

/// Formats the share of moments that were followed by an error, and the number of moments: `54 % of 1280`; `None` if
/// there are no moments.
pub(crate) fn share(counts: ErrorFrequency) -> Option<String> {
    let share_pct = counts.share_pct()?;
    Some(format!("{share_pct:.0} % of {}", counts.moments))
}

/// Describes how often errors followed moments with a risk as high as the highest risk of the flight; `None` if
/// this was not measured.
fn reliability(summary: &Summary, profile: &Profile) -> Option<String> {
    let highest_pct = summary.risk_max?.value_pct;
    let mut rows = profile.reliability.iter().rev();
    let row = rows.find(|row| row.from_pct <= highest_pct && highest_pct <= row.to_pct)?;
    let shares: Vec<String> = [("real", row.real), ("simulated", row.simulated)]
        .into_iter()
        .filter_map(|(name, counts)| Some(format!("{} on {name} vehicles", share(counts?)?)))
        .collect();
    (!shares.is_empty()).then(|| {
        format!(
            "in the flights that the rules were tested on, moments with a risk of {} to {} % were followed by an attitude error over \
             5 degrees within 5 s: {}",
            row.from_pct,
            row.to_pct,
            shares.join(", ")
        )
    })
}

fn style(verdict: &Verdict) -> Style {
    match verdict {
        Verdict::Known(level) => level_style(*level),
        Verdict::NotAvailable(_) => Style::new().bold(),
    }
}

/// The thresholds of the levels: `WARN after 0.2 s at a risk of 62 % or an elevated risk of 60 %`.
fn levels(verdict: &VerdictSettings) -> String {
    let level = |name: Level, of: &LevelSettings| {
        let percent = |limit: f64| number(limit, 2);
        let risk = of
            .raise
            .risk_pct
            .map(|limit| format!("a risk of {} %", percent(limit)));
        let elevated = of.raise.elevated_risk_pct;
        let elevated = elevated.map(|limit| format!("an elevated risk of {} %", percent(limit)));
        let any: Vec<String> = risk.into_iter().chain(elevated).collect();
        let after_s = number(of.after_s, 3);
        (!any.is_empty()).then(|| format!("{name} after {after_s} s at {}", any.join(" or ")))
    };
    let levels = [(Level::Warn, &verdict.warn), (Level::Fail, &verdict.fail)];
    let levels = levels.into_iter().filter_map(|(name, of)| level(name, of));
    format!("levels: {}", levels.collect::<Vec<_>>().join("; "))
}

/// The style of a level on a terminal.
pub fn level_style(level: Level) -> Style {
    match level {
        Level::Good => AnsiColor::Green,
        Level::Info => AnsiColor::Cyan,
        Level::Warn => AnsiColor::Yellow,
        Level::Fail => AnsiColor::Red,
    }
    .on_default()
    .bold()
}
