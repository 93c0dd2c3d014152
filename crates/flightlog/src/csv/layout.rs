//! The columns of a flight CSV.

use std::collections::HashSet;

use csv::ByteRecord;

use super::{HELP, cell, problem};
use crate::{Motor, Options, ReadError};

const MAX_COLUMNS: usize = 4096;
/// The maximum number of motors: ArduPilot has up to 32 outputs, and its frames up to 12 motors.
const MAX_MOTORS: usize = 32;

/// The meaning of the columns.
pub(super) struct Layout {
    pub(super) time: usize,
    /// The column of each motor, in order.
    pub(super) motors: Vec<usize>,
    /// The beginning of the names of motor columns: `pwm` or `motor`.
    pub(super) stem: &'static str,
    pub(super) in_air: Option<usize>,
    /// Column and name of each signal, and whether it is kept.
    pub(super) signals: Vec<(usize, String, bool)>,
    /// The number of columns that a row must have.
    pub(super) columns: usize,
    /// The number of cells of the header.
    pub(super) cells: usize,
}

impl Layout {
    pub(super) fn new(names: &ByteRecord, line: u64, options: &Options) -> Result<Self, ReadError> {
        let names: Vec<String> = names
            .iter()
            .map(|name| String::from_utf8_lossy(cell(name)).into_owned())
            .collect();
        if names.len() > MAX_COLUMNS {
            let text = format!("there are {} columns, more than {MAX_COLUMNS}", names.len());
            return Err(problem(
                line,
                text,
                "leave out columns that no profile needs",
            ));
        }
        if names.iter().all(|name| name.parse::<f64>().is_ok()) {
            let text = "the first line contains numbers, not the names of the columns";
            return Err(problem(line, text, HELP));
        }
        let mut seen = HashSet::new();
        for name in names.iter().filter(|name| !name.is_empty()) {
            if !seen.insert(name) {
                let text = format!("the column `{name}` occurs twice");
                return Err(problem(line, text, "give each column a different name"));
            }
        }
        let find = |name: &str| names.iter().position(|other| other == name);
        let Some(time) = find("t_s") else {
            return Err(problem(
                line,
                "there is no column `t_s`",
                &time_help(&names),
            ));
        };
        let [pwm, motor] = ["pwm", "motor"].map(|stem| numbered(&names, stem));
        if !pwm.is_empty() && !motor.is_empty() {
            let text = "there are both `pwm` and `motor` columns";
            return Err(problem(line, text, "keep one kind of them"));
        }
        if pwm.is_empty() && motor.is_empty() {
            meant_as_motor(&names).map_or(Ok(()), |(given, name)| {
                let text = format!("there is a column `{given}`, but no `{name}`");
                Err(problem(
                    line,
                    text,
                    "rename the columns of the motors: lower-case letters, without separators or units",
                ))
            })?;
        }
        let (stem, mut motors) = match pwm.is_empty() {
            false => ("pwm", pwm),
            true => ("motor", motor),
        };
        motors.sort_unstable();
        if motors.len() > MAX_MOTORS {
            let text = format!("there are {} motors, more than {MAX_MOTORS}", motors.len());
            return Err(problem(
                line,
                text,
                "rename the columns that are not motors",
            ));
        }
        if let Some((0, _)) = motors.first() {
            let text = format!("there is a column `{stem}0`");
            return Err(problem(line, text, "number the motors from 1 without gaps"));
        }
        for (index, &(number, _)) in motors.iter().enumerate() {
            if number != index as u64 + 1 {
                let missing = format!("{stem}{}", index + 1);
                let text = format!("there is a column `{stem}{number}` but no `{missing}`");
                // For example `motor1 (%)`.
                let is_meant = |name: &&String| {
                    let rest = name.strip_prefix(&missing);
                    rest.is_some_and(|rest| !rest.starts_with(|c: char| c.is_alphanumeric()))
                };
                let help = match names.iter().find(is_meant) {
                    Some(given) => format!("rename `{given}` to `{missing}`"),
                    None => "number the motors from 1 without gaps".into(),
                };
                return Err(problem(line, text, &help));
            }
        }
        let motors: Vec<usize> = motors.into_iter().map(|(_, column)| column).collect();
        let in_air = find("in_air");
        if in_air.is_none()
            && let Some(given) = names.iter().find(|name| is_meant_as_in_air(name))
        {
            let text = format!("there is a column `{given}`, but no `in_air`");
            return Err(problem(line, text, "rename the column to `in_air`"));
        }
        let signals = names
            .iter()
            .enumerate()
            .filter(|(column, name)| {
                *column != time
                    && Some(*column) != in_air
                    && !motors.contains(column)
                    && !name.is_empty()
            })
            .map(|(column, name)| (column, name.clone(), options.wants(name)))
            .collect();
        Ok(Self {
            columns: names
                .iter()
                .rposition(|name| !name.is_empty())
                .map_or(0, |last| last + 1),
            cells: names.len(),
            time,
            motors,
            stem,
            in_air,
            signals,
        })
    }

    pub(super) fn motors(&self) -> Vec<Motor> {
        (1..=self.motors.len())
            .map(|number| {
                let name = format!("{}{number}", self.stem);
                Motor {
                    number: u16::try_from(number).unwrap_or(u16::MAX),
                    source: format!("column `{name}`"),
                    output: name,
                }
            })
            .collect()
    }
}

/// A column with a name such as `Motor_1`, and the name that is probably meant.
fn meant_as_motor(names: &[String]) -> Option<(&str, String)> {
    names.iter().find_map(|given| {
        let letters = given.chars().filter(|c| c.is_ascii_alphanumeric());
        let name: String = letters.map(|c| c.to_ascii_lowercase()).collect();
        let number = name.strip_prefix("motor").or(name.strip_prefix("pwm"))?;
        number.parse::<u64>().ok().map(|_| (given.as_str(), name))
    })
}

/// Whether the name of a column consists of the letters of `in_air`, such as `inair`, `In Air` or `in_ari`.
fn is_meant_as_in_air(name: &str) -> bool {
    let letters = name.chars().filter(|c| c.is_ascii_alphanumeric());
    let mut letters: Vec<char> = letters.map(|c| c.to_ascii_lowercase()).collect();
    letters.sort_unstable();
    letters == ['a', 'i', 'i', 'n', 'r']
}

/// Advice for a table without `t_s`: its column of times may have another name.
fn time_help(names: &[String]) -> String {
    const NAMES: &[&str] = &[
        "t",
        "time",
        "times",
        "timestamp",
        "sec",
        "secs",
        "seconds",
        "elapsed",
        "clock",
    ];
    const UNITS: &[(&str, &str)] = &[
        ("_ms", "1000"),
        ("ms", "1000"),
        ("_us", "1000000"),
        ("us", "1000000"),
        ("_s", ""),
    ];
    let of = |name: &String| {
        // For example `time (ms)`.
        let parts = name.split(|c: char| !c.is_ascii_alphanumeric());
        let parts: Vec<&str> = parts.filter(|part| !part.is_empty()).collect();
        let lower = parts.join("_").to_ascii_lowercase();
        let unit = UNITS
            .iter()
            .find_map(|(end, by)| Some((lower.strip_suffix(end)?, *by)));
        let (stem, by) = unit
            .filter(|(stem, _)| NAMES.contains(stem))
            .unwrap_or((&lower, ""));
        NAMES.contains(&stem).then(|| match by {
            "" => format!("rename `{name}` to `t_s`; it must be in seconds"),
            _ => format!("rename `{name}` to `t_s`, and divide its values by {by}"),
        })
    };
    if names.first().is_some_and(|name| name.starts_with("sep=")) {
        return "delete the first line, which is for spreadsheets".to_owned();
    }
    names.iter().find_map(of).unwrap_or_else(|| HELP.to_owned())
}

/// The number and the index of each column whose name is `stem` followed by a number.
fn numbered(names: &[String], stem: &str) -> Vec<(u64, usize)> {
    let number = |name: &String| name.strip_prefix(stem)?.parse().ok();
    names
        .iter()
        .enumerate()
        .filter_map(|(column, name)| Some((number(name)?, column)))
        .collect()
}
