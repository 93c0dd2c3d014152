//! The `# key: value` lines on top of a flight CSV.

use std::{io::BufRead as _, ops::RangeInclusive};

use super::{BOM, Layout, problem};
use crate::error::io_error;
use crate::flight::whole_range;
use crate::geometry::{DeclaredLayout, tables};
use crate::input::Input;
use crate::outputs::{Bounds, FRACTIONS, PULSES_US};
use crate::{Flight, Intervals, Range, ReadError, VehicleKind, identity};

/// An entry of the header, and the line that contains it.
pub(super) struct HeaderLine {
    line: u64,
    key: String,
    value: String,
}

/// Keys that change an assessment.
const KEYS: &[&str] = &[
    "pwm_low_us",
    "pwm_high_us",
    "effective_low",
    "effective_high",
    "motors",
    "frame",
    "frame_class",
    "frame_type",
    "vehicle_kind",
    "armed",
    "in_air",
    "end_s",
    "rebooted_in_air_s",
    "utc_at_zero_s",
];

/// Reads the `# key: value` lines at the top, and returns them with the number of lines.
pub(super) fn read_header(input: &mut Input<'_>) -> Result<(Vec<HeaderLine>, u64), ReadError> {
    let mut header = Vec::new();
    let mut lines = 0;
    loop {
        let mut next = input.fill_buf().map_err(io_error)?;
        if lines == 0 && next.starts_with(BOM) {
            input.consume(BOM.len());
            next = input.fill_buf().map_err(io_error)?;
        }
        if !matches!(next.first(), Some(b'#' | b'\r' | b'\n')) {
            if let Some((key, value)) = entry_without_sign(next) {
                let help = format!("write `# {key}: {value}`");
                return Err(problem(lines + 1, "a header line begins with `#`", &help));
            }
            return Ok((header, lines));
        }
        let mut text = Vec::new();
        input.read_until(b'\n', &mut text).map_err(io_error)?;
        lines += 1;
        let text = String::from_utf8_lossy(&text);
        let text = text.trim().trim_start_matches('#').trim();
        // A known key with `=` or a space instead of a colon is an error, because its value would silently be ignored.
        let number = |value: &str| value.trim().parse::<f64>().is_ok();
        let by_space = || text.split_once(' ').filter(|(_, value)| number(value));
        if let Some((key, value)) = text.split_once('=').or_else(by_space)
            && KEYS.contains(&key.trim())
        {
            let help = format!("write `# {}: {}`", key.trim(), value.trim());
            return Err(problem(lines, format!("`{text}` has no colon"), &help));
        }
        if let Some((key, value)) = text.split_once(':') {
            header.push(HeaderLine {
                line: lines,
                key: key.trim().into(),
                value: value.trim().into(),
            });
        }
    }
}

/// The key and the value in the first line of a text, if that is a header line without its `#`.
pub(super) fn entry_without_sign(text: &[u8]) -> Option<(String, String)> {
    let line = text.split(|byte| *byte == b'\n').next()?;
    let line = String::from_utf8_lossy(line.strip_prefix(BOM).unwrap_or(line));
    let (key, value) = line.split_once([':', '='])?;
    let is_word = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
    // Other keys are allowed too, but a colon may also be a part of the name of a column.
    let is_entry = !key.is_empty()
        && key.chars().all(is_word)
        && value.starts_with(' ')
        && !value.contains(',');
    let is_known = KEYS.contains(&key.trim());
    (is_known || is_entry).then(|| (key.trim().to_owned(), value.trim().to_owned()))
}

/// The value of `written_by` in the files that this crate writes.
pub(super) const WRITER: &str = "flagred";

/// Whether this crate wrote the file. If so, its units are certain, even if the values of a damaged log are odd.
pub(super) fn is_ours(header: &[HeaderLine]) -> bool {
    let mut header = header.iter();
    header.any(|entry| entry.key == "written_by" && entry.value == WRITER)
}

/// The end of the last time in the air, if the log ended in the air.
pub(super) fn end_s(header: &[HeaderLine]) -> Result<Option<f64>, ReadError> {
    number_of(header, "end_s")
}

fn number_of(header: &[HeaderLine], key: &str) -> Result<Option<f64>, ReadError> {
    let Some(entry) = header.iter().find(|entry| entry.key == key) else {
        return Ok(None);
    };
    match entry.value.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(Some(value)),
        _ => {
            let text = format!("`{key}` is `{}`, not a number", entry.value);
            let help = "write it as `# key: number`, without a unit";
            Err(problem(entry.line, text, help))
        }
    }
}

/// Copies limits, vehicle and geometry from the header to the flight.
pub(super) fn apply_header(
    flight: &mut Flight,
    header: Vec<HeaderLine>,
    layout: &Layout,
    span_s: RangeInclusive<f64>,
) -> Result<DeclaredLayout, ReadError> {
    let value = |key: &str| number_of(&header, key);
    let line_of = |key: &str| {
        let entry = header.iter().find(|entry| entry.key == key);
        entry.map_or(1, |entry| entry.line)
    };
    let pair = |low: &str, high: &str, bounds: Bounds| -> Result<Option<(f64, f64)>, ReadError> {
        let Bounds { least, most, width } = bounds;
        for key in [low, high] {
            if let Some(value) = value(key)?.filter(|value| !(least..=most).contains(value)) {
                let text = format!("`{key}` is {value}, outside {least} to {most}");
                let help = match value {
                    2.0..=100.0 if most <= 1.0 => "write a fraction: 0.15 for 15 %",
                    _ => "write the limit of the vehicle",
                };
                return Err(problem(line_of(key), text, help));
            }
        }
        // If a limit seems to be missing, it may have been written with another name, such as `pwm_min_us`
        // for `pwm_low_us`.
        let stem = low.split('_').next();
        let mut others = header
            .iter()
            .filter(|entry| !KEYS.contains(&entry.key.as_str()));
        let other =
            others.find(|entry| entry.key.contains('_') && entry.key.split('_').next() == stem);
        let help = |missing: &str| match other {
            Some(entry) => format!(
                "write `{missing}` in place of `{}` in line {}",
                entry.key, entry.line
            ),
            None => "write both or neither".to_owned(),
        };
        let (low_value, high_value) = match (value(low)?, value(high)?) {
            (Some(low_value), Some(high_value)) => (low_value, high_value),
            (None, None) => return Ok(None),
            (Some(_), None) => {
                let text = format!("`{low}` is given without `{high}`");
                return Err(problem(line_of(low), text, &help(high)));
            }
            (None, Some(_)) => {
                let text = format!("`{high}` is given without `{low}`");
                return Err(problem(line_of(high), text, &help(low)));
            }
        };
        if high_value <= low_value {
            let text = format!("`{high}` is not above `{low}`");
            return Err(problem(line_of(high), text, "swap or correct the two"));
        }
        if !bounds.allow((low_value, high_value)) {
            let text = format!("`{high}` is less than {width} above `{low}`");
            let help = "write the limits of the vehicle";
            return Err(problem(line_of(high), text, help));
        }
        Ok(Some((low_value, high_value)))
    };
    let pwm = pair("pwm_low_us", "pwm_high_us", PULSES_US)?;
    if layout.stem == "motor" && !layout.motors.is_empty() {
        flight.range = Some(Range {
            low: 0.0,
            high: 1.0,
            unit: "1",
            source: "columns `motor1`.. are fractions".into(),
        });
    } else if let Some((low, high)) = pwm {
        flight.range = Some(Range {
            low,
            high,
            unit: "us",
            source: "header pwm_low_us, pwm_high_us".into(),
        });
    }
    flight.effective_range = match pair("effective_low", "effective_high", FRACTIONS)? {
        Some((low, high)) => Range {
            low,
            high,
            unit: "1",
            source: "header effective_low, effective_high".into(),
        },
        None => whole_range("no effective_low and effective_high in the header"),
    };
    let is_ours = is_ours(&header);
    for entry in &header {
        match entry.key.as_str() {
            "vehicle" => flight.vehicle.frame = Some(entry.value.clone()),
            "vehicle_id" => {
                let id = entry.value.clone();
                identity::name(&mut flight.vehicle, id, "header vehicle_id");
            }
            "assumed" => flight.assumed = entry.value.split("; ").map(str::to_owned).collect(),
            "system_id" => flight.vehicle.system_id = entry.value.parse().ok(),
            "boot_count" => flight.vehicle.boot_count = entry.value.parse().ok(),
            "firmware" => flight.vehicle.firmware = Some(entry.value.clone()),
            "motors" => {
                let motors = entry.value.parse().ok().filter(|motors| *motors > 0);
                flight.vehicle.motors = Some(motors.ok_or_else(|| {
                    let text = format!("`motors` is `{}`", entry.value);
                    problem(entry.line, text, "write how many motors the vehicle has")
                })?);
            }
            "armed" if entry.value == "never" => {
                flight.armed = Some(Intervals {
                    spans: Vec::new(),
                    rule: "header armed".into(),
                    is_assumed: false,
                });
            }
            "armed" => {
                let text = format!("`armed` is `{}`", entry.value);
                let help = "write `never`, or leave the line out";
                return Err(problem(entry.line, text, help));
            }
            "in_air" if entry.value == "assumed" => {
                flight.in_air = flight.in_air.take().map(Intervals::assumed);
            }
            "in_air" => {
                let text = format!("`in_air` is `{}`", entry.value);
                let help = "write `assumed`, or leave the line out";
                return Err(problem(entry.line, text, help));
            }
            "rebooted_in_air_s" => {
                let numbers = entry.value.split_whitespace().map(str::parse::<f64>);
                let times = numbers.collect::<Result<Vec<f64>, _>>().map_err(|_| {
                    let text = format!("`rebooted_in_air_s` is `{}`", entry.value);
                    problem(
                        entry.line,
                        text,
                        "write times in seconds, with spaces between them",
                    )
                })?;
                let outside = times.iter().find(|t_s| !span_s.contains(t_s));
                // A file that this crate wrote from a damaged log may contain times outside the flight. They are
                // accepted, because a flight with a reboot in the air cannot have the verdict GOOD.
                if let Some(outside) = outside.filter(|_| !is_ours) {
                    let (from_s, to_s) = (span_s.start(), span_s.end());
                    let text = format!(
                        "`rebooted_in_air_s` is {outside}, but the flight goes from {from_s} to {to_s} s"
                    );
                    let help = "write times on the clock of `t_s`";
                    return Err(problem(entry.line, text, help));
                }
                flight.rebooted_in_air_s.extend(times);
            }
            "vehicle_kind" => {
                flight.vehicle.kind = VehicleKind::from_name(&entry.value).ok_or_else(|| {
                    let text = format!("`{}` is not a kind of vehicle", entry.value);
                    problem(entry.line, text, VehicleKind::NAMES_HELP)
                })?;
                flight.vehicle.source = "header vehicle_kind".into();
            }
            _ => {}
        }
    }
    flight.utc_at_zero_s = value("utc_at_zero_s")?;
    let declared = geometry_of(&header, layout.motors.len())?;
    if flight.vehicle.motors.is_none() {
        flight.vehicle.motors = declared.class().and_then(tables::motors_of_class);
    }
    let columns = layout.motors.len();
    let of_frame = declared.class().and_then(tables::motors_of_class);
    for (keys, motors) in [
        (&["motors"][..], flight.vehicle.motors),
        (&["frame", "frame_class"], of_frame),
    ] {
        let entry = header
            .iter()
            .find(|entry| keys.contains(&entry.key.as_str()));
        if let (Some(entry), Some(motors)) = (entry, motors)
            && columns > usize::from(motors)
        {
            let stem = layout.stem;
            let text = format!(
                "`{}` is `{}`, which has {motors} motors, but there are columns `{stem}1` to `{stem}{columns}`",
                entry.key, entry.value
            );
            let help = "correct the frame or the number of motors in this line, or rename the columns that are not motors";
            return Err(problem(entry.line, text, help));
        }
    }
    flight.header = header
        .into_iter()
        .map(|entry| (entry.key, entry.value))
        .collect();
    Ok(declared)
}

/// The motor layout that the header declares: with `motorN_factors` for every motor, with `frame`,
/// or with `frame_class` and `frame_type`.
fn geometry_of(header: &[HeaderLine], motors: usize) -> Result<DeclaredLayout, ReadError> {
    let entry = |key: &str| header.iter().find(|entry| entry.key == key);
    let frame = entry("frame")
        .map(|entry| {
            let known = tables::parse(&entry.value).ok_or_else(|| {
                let text = format!("unknown frame `{}`", entry.value);
                problem(
                    entry.line,
                    text,
                    "write class and type as ArduPilot does, such as `QUAD/X` or `HEXA/PLUS`",
                )
            })?;
            if let (class, None) = known
                && let Some((name, kind)) = entry.value.split_once('/')
                && !is_ours(header)
            {
                let text = format!("unknown frame type `{kind}` of `{name}`");
                let kinds = tables::kinds_of(class).join("`, `");
                let help =
                    format!("write one of the types of ArduPilot after `{name}/`: `{kinds}`");
                return Err(problem(entry.line, text, &help));
            }
            Ok((entry.value.clone(), known))
        })
        .transpose()?;
    let factors = (1..=motors)
        .filter_map(|number| Some((number as u16, entry(&format!("motor{number}_factors"))?)))
        .map(|(number, entry)| {
            let parts: Vec<f64> = entry
                .value
                .split_whitespace()
                .map_while(|part| part.parse().ok().filter(|part: &f64| part.is_finite()))
                .collect();
            match parts.as_slice() {
                &[roll, pitch, yaw] => Ok((number, [roll, pitch, yaw])),
                _ => {
                    let text = format!("`{}` is `{}`", entry.key, entry.value);
                    Err(problem(
                        entry.line,
                        text,
                        "write three numbers: roll, pitch and yaw, such as `-1 1 1`",
                    ))
                }
            }
        })
        .collect::<Result<Vec<_>, _>>()?;
    if motors > 0 && factors.len() == motors {
        return Ok(DeclaredLayout::Factors {
            frame: frame.map(|(name, _)| name),
            factors,
            source: "header motorN_factors".into(),
        });
    }
    let number = |key: &str| entry(key)?.value.parse::<i64>().ok();
    Ok(match (frame, number("frame_class")) {
        (Some((name, (class, kind))), _) => DeclaredLayout::Frame {
            class,
            kind,
            source: format!("header frame `{name}`"),
        },
        (None, Some(class)) => {
            let kind = number("frame_type");
            let text = kind.map_or(String::new(), |kind| format!(", frame_type {kind}"));
            DeclaredLayout::Frame {
                class,
                kind,
                source: format!("header frame_class {class}{text}"),
            }
        }
        (None, None) => DeclaredLayout::Nothing,
    })
}
