//! The text of `inspect`.

use std::io::{self, Write};

use flagred_flightlog::{Flight, Intervals, Range};
use fuzzy::drawing::visible;

use flagred_report::words::first_spans;

/// Maximum number of autopilot messages, and of boots, that are shown; the JSON document contains all.
const MESSAGES: usize = 12;
/// Maximum number of flight modes that are shown.
const MODES: usize = 200;

pub(crate) fn write(out: &mut impl Write, name: &str, flight: &Flight) -> io::Result<()> {
    writeln!(out, "{}: {}", visible(name), flight.format)?;
    line(out, "vehicle", &vehicle(flight))?;
    line(out, "identity", &identity(flight))?;
    lines(out, "motors", motors(flight))?;
    lines(out, "geometry", geometry(flight))?;
    line(out, "range", &range(flight.range.as_ref(), ""))?;
    line(
        out,
        "effective",
        &range(Some(&flight.effective_range), " of the range"),
    )?;
    lines(out, "time", clock(flight))?;
    line(out, "armed", &spans(flight.armed.as_ref()))?;
    line(out, "in the air", &spans(flight.in_air.as_ref()))?;
    lines(out, "statistics", statistics(flight))?;
    lines(out, "modes", events(&flight.modes, MODES))?;
    lines(out, "messages", events(&flight.messages, MESSAGES))?;
    lines(out, "header", header(flight))?;
    lines(out, "signals", signals(flight))?;
    lines(out, "read", report(flight))?;
    lines(out, "NA", gaps(flight))?;
    writeln!(out)
}

fn line(out: &mut impl Write, key: &str, value: &str) -> io::Result<()> {
    writeln!(out, "  {key:<11}{}", visible(value))
}

/// Writes a key and lines; the first line follows the key. Writes nothing if there are no lines.
fn lines(
    out: &mut impl Write,
    key: &str,
    values: impl IntoIterator<Item = String>,
) -> io::Result<()> {
    let mut key = key;
    for value in values {
        line(out, std::mem::take(&mut key), &value)?;
    }
    Ok(())
}

fn vehicle(flight: &Flight) -> String {
    let vehicle = &flight.vehicle;
    let mut text = vehicle.kind.to_string();
    for part in [&vehicle.frame, &vehicle.firmware].into_iter().flatten() {
        text.push_str(", ");
        text.push_str(part);
    }
    let reported = vehicle
        .firmware
        .as_ref()
        .is_some_and(|firmware| vehicle.source.contains(firmware));
    match vehicle.source.as_str() {
        "" => text,
        _ if reported => text,
        source => format!("{text} ({source})"),
    }
}

/// The identity of the vehicle, with its sources.
fn identity(flight: &Flight) -> String {
    let vehicle = &flight.vehicle;
    let id = vehicle.id.as_ref().zip(vehicle.id_source.as_ref());
    let known = [
        id.map(|(id, source)| format!("{id} ({source})")),
        vehicle.system_id.map(|id| format!("system id {id}")),
        vehicle.boot_count.map(|count| format!("boot {count}")),
    ];
    let known: Vec<String> = known.into_iter().flatten().collect();
    match known.is_empty() {
        true => "NA".into(),
        false => known.join(", "),
    }
}

fn motors(flight: &Flight) -> Vec<String> {
    let rate = match flight.command_rate_hz() {
        Some(rate_hz) => format!("{rate_hz:.4} Hz"),
        None => "NA".into(),
    };
    let rows = flight.commands.len();
    let mut lines = vec![format!(
        "{}; {rows} rows of commands, {rate}",
        flight.motors.len()
    )];
    lines.extend(flight.motors.iter().enumerate().map(|(index, motor)| {
        let geometry = flight.geometry.as_ref();
        let factors = geometry.and_then(|geometry| geometry.factors.get(index));
        let factors = factors.map_or(String::new(), |[roll, pitch, yaw]| {
            format!(", roll {roll:+.2}, pitch {pitch:+.2}, yaw {yaw:+.2}")
        });
        let position = geometry.and_then(|geometry| geometry.position(index));
        let position = position.map_or(String::new(), |position| format!(", {position}"));
        let (number, output, source) = (motor.number, &motor.output, &motor.source);
        format!("motor {number}, output {output} ({source}){position}{factors}")
    }));
    lines
}

fn geometry(flight: &Flight) -> Vec<String> {
    let Some(geometry) = &flight.geometry else {
        return vec!["NA".into()];
    };
    let frame = geometry.frame.as_deref().unwrap_or("motor positions");
    let mut lines = vec![format!("{frame}, {} ({})", geometry.basis, geometry.source)];
    let doubt = geometry.doubt.iter();
    lines.extend(doubt.map(|doubt| format!("doubtful: {doubt}")));
    lines
}

fn range(range: Option<&Range>, of: &str) -> String {
    let Some(range) = range else {
        return "NA".into();
    };
    let unit = match range.unit {
        "1" => String::new(),
        unit => format!(" {unit}"),
    };
    let [low, high] = [range.low, range.high].map(short);
    format!("{low} to {high}{unit}{of} ({})", range.source)
}

/// A number with at most 6 decimals, without trailing zeros. Parameters have only single precision, so more decimals
/// would be meaningless.
fn short(value: f64) -> String {
    let text = format!("{value:.6}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

fn clock(flight: &Flight) -> Vec<String> {
    let Some((first_s, last_s)) = flight.time_span_s() else {
        return vec!["NA".into()];
    };
    let utc = match flight.utc_at_zero_s {
        Some(zero_s) => format!(", from {}", utc(zero_s + first_s)),
        None => ", UTC not known".into(),
    };
    let mut lines = vec![format!(
        "{first_s:.3} to {last_s:.3} s on the log's clock{utc}"
    )];
    let boots = flight.boots_s.iter().take(MESSAGES);
    lines.extend(boots.map(|boot_s| format!("the autopilot booted again at {boot_s:.3} s")));
    if flight.boots_s.len() > MESSAGES {
        let more = flight.boots_s.len() - MESSAGES;
        lines.push(format!("and {more} more boots (see --json)"));
    }
    lines
}

/// Formats seconds since 1970 as date and time (days to civil date after Howard Hinnant,
/// <https://howardhinnant.github.io/date_algorithms.html>).
fn utc(seconds: f64) -> String {
    let days = (seconds / 86_400.0).floor();
    let in_day = seconds - days * 86_400.0;
    let shifted = days as i64 + 719_468;
    let (era, day_of_era) = (shifted.div_euclid(146_097), shifted.rem_euclid(146_097));
    let year_of_era =
        (day_of_era - day_of_era / 1460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let shifted_month = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * shifted_month + 2) / 5 + 1;
    let month = if shifted_month < 10 {
        shifted_month + 3
    } else {
        shifted_month - 9
    };
    let year = year_of_era + era * 400 + i64::from(month <= 2);
    let (hour, minute) = ((in_day / 3600.0) as u32, (in_day / 60.0) as u32 % 60);
    let second = (in_day % 60.0) as u32;
    format!("{year:04}-{month:02}-{day:02} {hour:02}:{minute:02}:{second:02} UTC")
}

fn spans(intervals: Option<&Intervals>) -> String {
    let Some(intervals) = intervals else {
        return "NA".into();
    };
    let spans = intervals.spans.iter().map(|span| {
        let end = if span.ends_with_log {
            " (end of the log)"
        } else {
            ""
        };
        format!("{:.1} to {:.1}{end}", span.start_s, span.end_s)
    });
    match spans.len() {
        0 => format!("never ({})", intervals.rule),
        _ => format!(
            "{:.1} s: {} ({})",
            intervals.duration_s(),
            first_spans(spans),
            intervals.rule
        ),
    }
}

fn statistics(flight: &Flight) -> Vec<String> {
    let statistics = match flight.statistics() {
        Ok(statistics) => statistics,
        Err(gap) => return vec![format!("NA: {gap}")],
    };
    vec![
        format!(
            "in the air, on the effective range, {} rows",
            statistics.samples
        ),
        format!(
            "margin  mean {:.4}, min {:.4}, std {:.4}; mean of the smallest motor {:.4}",
            statistics.margin_mean,
            statistics.margin_min,
            statistics.margin_std,
            statistics.margin_mean_of_min
        ),
        format!(
            "command mean {:.4}, std {:.4}",
            statistics.command_mean, statistics.command_std
        ),
    ]
}

fn events(events: &[flagred_flightlog::Event], most: usize) -> Vec<String> {
    let mut lines: Vec<String> = events
        .iter()
        .take(most)
        .map(|event| format!("{:>9.3} s  {}", event.t_s(), event.what))
        .collect();
    if events.len() > most {
        lines.push(format!("and {} more (see --json)", events.len() - most));
    }
    lines
}

fn header(flight: &Flight) -> impl Iterator<Item = String> {
    flight
        .header
        .iter()
        .map(|(key, value)| format!("{key}: {value}"))
}

fn signals(flight: &Flight) -> impl Iterator<Item = String> {
    flight.signals().map(|signal| {
        let rate = match signal.rate_hz() {
            Some(rate_hz) => format!("{rate_hz:.1} Hz"),
            None => "NA".into(),
        };
        let (label, known) = (signal.label, signal.known());
        let unknown = match signal.values.len() - known {
            0 => String::new(),
            unknown => format!("; {unknown} more are unknown"),
        };
        format!(
            "{:<28} {:<5} {rate:>9} {known:>8} samples  {}{unknown}",
            label.name, label.unit, label.source
        )
    })
}

fn report(flight: &Flight) -> Vec<String> {
    let report = &flight.report;
    let mut lines = vec![format!(
        "{} bytes, {} messages",
        report.bytes, report.messages
    )];
    if report.skipped_bytes > 0 || report.bad_messages > 0 {
        lines.push(format!(
            "{} bytes skipped, {} bad messages",
            report.skipped_bytes, report.bad_messages
        ));
    }
    if report.truncated {
        lines.push("the log is cut off at its end".into());
    }
    lines.extend(
        report
            .reason
            .as_ref()
            .map(|reason| format!("reason: {reason}")),
    );
    if !report.left_out.is_empty() {
        lines.push(format!("left out: {}", report.left_out));
    }
    lines
}

fn gaps(flight: &Flight) -> Vec<String> {
    let mut lines = Vec::new();
    for gap in flight.gaps() {
        lines.push(gap.to_string());
        lines.extend(gap.help().map(|help| format!("  help: {help}")));
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::utc;

    #[test]
    fn seconds_since_1970_are_shown_as_dates() {
        for (seconds, text) in [
            (0.0, "1970-01-01 00:00:00 UTC"),
            (951_782_399.0, "2000-02-28 23:59:59 UTC"),
            (951_782_400.5, "2000-02-29 00:00:00 UTC"),
            (1_483_228_799.0, "2016-12-31 23:59:59 UTC"),
        ] {
            assert_eq!(utc(seconds), text);
        }
    }
}
