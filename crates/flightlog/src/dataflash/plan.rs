//! Determines how each kind of DataFlash message is used.

use super::format::Format;
use super::signals::{INSTANCE, MessageSpec, SPECS, SignalSource};
use crate::Options;
use crate::signal::Label;

/// How the messages of a type are used. The numbers without a description are indices of columns.
#[derive(Debug)]
pub(super) enum MessageRole {
    Nothing,
    Parameter {
        name: usize,
        value: usize,
    },
    Text(usize),
    Event(usize),
    Arm(usize),
    Mode {
        number: Option<usize>,
        name: usize,
    },
    /// Output commands: the prefix of their labels, then the index of the column and the number of each output.
    Outputs(&'static str, Vec<(usize, u16)>),
    /// The index of the series, and how each of its signals is computed.
    Series(usize, Vec<ResolvedSource>),
}

/// One signal of a series.
#[derive(Debug)]
pub(super) enum ResolvedSource {
    Field { column: usize, scale: f64 },
    Length(Vec<usize>),
    Position(usize),
}

/// A message type and its use.
#[derive(Debug)]
pub(super) struct MessageType {
    pub(super) format: Format,
    pub(super) role: MessageRole,
    /// The column of the time, and its unit in seconds.
    pub(super) time: Option<(usize, f64)>,
    pub(super) instance: Option<usize>,
}

impl MessageType {
    /// Determines how the messages of a type are used. `series` returns the index of the series with the given
    /// message name and signals.
    pub(super) fn new(
        format: Format,
        options: &Options,
        series: impl FnOnce(&'static str, Vec<Label>) -> usize,
    ) -> Self {
        // In a GPS message, TimeMS is the time of the GPS week and T is the time since boot. Firmware before 3.1 has
        // only Time.
        let labels: &[(&str, f64)] = match format.name.as_str() {
            "GPS" => &[("TimeUS", 1e-6), ("T", 1e-3), ("Time", 1e-3)],
            _ => &[("TimeUS", 1e-6), ("TimeMS", 1e-3)],
        };
        let time = labels
            .iter()
            .find_map(|(label, unit)| Some((format.column(&[label])?, *unit)));
        // Times are integers; otherwise the definition is damaged.
        let timed = time.is_none_or(|(column, _)| format.has_kind(column, b"QI"));
        let role = match timed && !format.damaged {
            true => role(&format).or_else(|| {
                let spec = SPECS.iter().find(|spec| spec.message == format.name)?;
                let (parts, labels) = parts(spec, &format, options).into_iter().unzip();
                Some(MessageRole::Series(series(spec.message, labels), parts))
            }),
            false => None,
        };
        Self {
            instance: match role {
                Some(MessageRole::Series(..)) => format.column(INSTANCE),
                _ => None,
            },
            role: role.unwrap_or(MessageRole::Nothing),
            time,
            format,
        }
    }
}

/// How the messages of a type without signals are used.
fn role(format: &Format) -> Option<MessageRole> {
    let column = |label| format.column(&[label]);
    match format.name.as_str() {
        "PARM" => column("Name")
            .zip(column("Value"))
            .map(|(name, value)| MessageRole::Parameter { name, value }),
        "MSG" => column("Message").map(MessageRole::Text),
        "EV" => column("Id").map(MessageRole::Event),
        "ARM" => column("ArmState").map(MessageRole::Arm),
        "MODE" => column("Mode").map(|name| MessageRole::Mode {
            number: column("ModeNum"),
            name,
        }),
        "RCOU" | "RCO2" | "RCO3" => outputs(format, &["Chan", "Ch", "C"]),
        MOTORS => outputs(format, &["Mot"]),
        _ => None,
    }
}

/// The message of firmware before 3.2 that has a column for each motor.
pub(super) const MOTORS: &str = "MOT";

/// The columns whose label is one of `stems` followed by a number.
fn outputs(format: &Format, stems: &[&'static str]) -> Option<MessageRole> {
    let number = |label: &str| {
        stems.iter().find_map(|stem| {
            let number: u16 = label.strip_prefix(stem)?.parse().ok()?;
            (1..=32).contains(&number).then_some((*stem, number))
        })
    };
    let columns = format.columns.iter().enumerate();
    let (stems, columns): (Vec<_>, Vec<_>) = columns
        .filter_map(|(column, described)| {
            let (stem, output) = number(&described.label)?;
            // Pulse widths are 16-bit integers; otherwise the definition is damaged.
            if !format.has_kind(column, b"Hh") {
                return None;
            }
            Some((stem, (column, output)))
        })
        .unzip();
    Some(MessageRole::Outputs(stems.first()?, columns))
}

/// The signals that a message of this format contains and that the options request.
fn parts(spec: &MessageSpec, format: &Format, options: &Options) -> Vec<(ResolvedSource, Label)> {
    let integer = |column: usize| format.has_kind(column, b"hHiI");
    spec.signals
        .iter()
        .filter(|(_, name, _)| options.wants(name))
        .filter_map(|(from, name, unit)| {
            let (part, fields) = match from {
                SignalSource::Field(labels) => {
                    let column = format.column(labels)?;
                    (
                        ResolvedSource::Field { column, scale: 1.0 },
                        format.columns.get(column)?.label.clone(),
                    )
                }
                SignalSource::Hundredths(labels) => {
                    let column = format.column(labels)?;
                    let scale = if integer(column) { 0.01 } else { 1.0 };
                    (
                        ResolvedSource::Field { column, scale },
                        format.columns.get(column)?.label.clone(),
                    )
                }
                SignalSource::Position(labels) => {
                    let column = format.column(labels)?;
                    (
                        ResolvedSource::Position(column),
                        format.columns.get(column)?.label.clone(),
                    )
                }
                SignalSource::Length(labels) => {
                    let columns = labels.iter().map(|label| format.column(&[label]));
                    (
                        ResolvedSource::Length(columns.collect::<Option<_>>()?),
                        labels.join(", "),
                    )
                }
            };
            let label = Label {
                name: (*name).into(),
                unit: (*unit).into(),
                source: format!("{}.{fields}", format.name),
            };
            Some((part, label))
        })
        .collect()
}
