//! From DataFlash messages, binary or text, to a `Flight`.

use super::format::{Cells, FMT, Format};
use super::signals::{From, INSTANCE, SPECS, Spec};
use super::untimed::{Kept, Untimed};
use crate::ardupilot::{self, Parameters};
use crate::clock::{Clock, Placed};
use crate::outputs::Outputs;
use crate::signal::Label;
use crate::{Event, Flight, Intervals, Options, Report, Series, utc};

/// What a kind of message is read for. Numbers are columns.
#[derive(Debug, Clone)]
enum Role {
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
    /// Output commands: column and output number, or motor number for MOT.
    Outputs(Vec<(usize, u16)>),
    Series(Vec<Part>),
}

/// One signal of a series.
#[derive(Debug, Clone)]
enum Part {
    Field { column: usize, scale: f64 },
    Length(usize, usize),
}

#[derive(Debug, Clone)]
struct Kind {
    format: Format,
    role: Role,
    /// Column of the time and its unit in seconds.
    time: Option<(usize, f64)>,
    instance: Option<usize>,
    /// Index of its series.
    series: usize,
}

pub(super) struct Collector<'o> {
    options: &'o Options,
    kinds: Vec<Option<Kind>>,
    /// Motors that have a column of their own in MOT messages (firmware before 3.2).
    named_motors: u16,
    clock: Clock,
    waiting: Option<Kept>,
    untimed: Untimed,
    redefine: bool,
    pub(super) report: Report,
    parameters: Parameters,
    outputs: Outputs,
    label: &'static str,
    series: Vec<(&'static str, Series)>,
    events: Vec<(f64, Landing)>,
    modes: Vec<Event>,
    texts: Vec<Event>,
    /// Texts that stand above the messages of a text log.
    pub(super) greetings: Vec<String>,
    utc_at_zero_s: Option<f64>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Landing {
    Armed,
    Disarmed,
    Left,
    Landed,
}

impl<'o> Collector<'o> {
    pub(super) fn new(options: &'o Options) -> Self {
        Self {
            options,
            kinds: vec![None; 256],
            named_motors: 0,
            clock: Clock::default(),
            waiting: None,
            untimed: Untimed::default(),
            redefine: true,
            report: Report::default(),
            parameters: Parameters::default(),
            outputs: Outputs::default(),
            label: "C",
            series: Vec::new(),
            events: Vec::new(),
            modes: Vec::new(),
            texts: Vec::new(),
            greetings: Vec::new(),
            utc_at_zero_s: None,
        }
    }

    /// Whether messages of this type hold anything that is read.
    pub(super) fn wants(&self, type_id: u8) -> bool {
        self.kind(type_id)
            .is_some_and(|kind| !matches!(kind.role, Role::Nothing))
    }

    /// Number of fields of messages of this type.
    pub(super) fn columns(&self, type_id: u8) -> usize {
        self.kind(type_id)
            .map_or(0, |kind| kind.format.columns.len())
    }

    fn kind(&self, type_id: u8) -> Option<&Kind> {
        self.kinds.get(usize::from(type_id))?.as_ref()
    }

    /// Takes in the description of a kind of message; gives whether it holds from now on.
    pub(super) fn define(&mut self, format: Format) -> bool {
        let known = self.kind(format.type_id).map(|kind| &kind.format);
        let (is_known, is_same) = (known.is_some(), known == Some(&format));
        if format.type_id == FMT && is_known {
            // The definitions start over: the autopilot booted again into this log.
            self.clock.expect_boot();
            self.redefine = true;
        }
        if is_same {
            return true;
        }
        // Within one boot a second, different definition of a type is damage.
        if is_known && !self.redefine {
            self.report.bad_messages += 1;
            self.report
                .because(|| format!("message `{}` is defined twice", format.name));
            return false;
        }
        let kind = self.plan(format);
        if let Some(slot) = self.kinds.get_mut(usize::from(kind.format.type_id)) {
            *slot = Some(kind);
        }
        true
    }

    fn plan(&mut self, format: Format) -> Kind {
        // TimeMS of a GPS message is the time in the GPS week; T is that since boot, and
        // Time is all that firmware before 3.1 has.
        let labels: &[(&str, f64)] = match format.name.as_str() {
            "GPS" => &[("TimeUS", 1e-6), ("T", 1e-3), ("Time", 1e-3)],
            _ => &[("TimeUS", 1e-6), ("TimeMS", 1e-3)],
        };
        let time = labels
            .iter()
            .find_map(|(label, unit)| Some((format.column(&[label])?, *unit)));
        let role = self.role(&format);
        let mut series = 0;
        if matches!(role, Role::Series(_)) {
            series = self.series_of(&format);
        }
        Kind {
            instance: match role {
                Role::Series(_) => format.column(INSTANCE),
                _ => None,
            },
            role,
            time,
            series,
            format,
        }
    }

    fn role(&mut self, format: &Format) -> Role {
        let column = |label| format.column(&[label]);
        let role = match format.name.as_str() {
            "PARM" => (column("Name").zip(column("Value")))
                .map(|(name, value)| Role::Parameter { name, value }),
            "MSG" => column("Message").map(Role::Text),
            "EV" => column("Id").map(Role::Event),
            "ARM" => column("ArmState").map(Role::Arm),
            "MODE" => column("Mode").map(|name| Role::Mode {
                number: column("ModeNum"),
                name,
            }),
            "RCOU" | "RCO2" | "RCO3" => {
                let outputs = numbered(format, &["Chan", "Ch", "C"]);
                if let Some((label, _)) = outputs.first() {
                    self.label = label;
                }
                Some(Role::Outputs(outputs.into_iter().map(|(_, c)| c).collect()))
            }
            "MOT" => {
                let motors = numbered(format, &["Mot"]);
                self.named_motors = motors.len() as u16;
                Some(Role::Outputs(motors.into_iter().map(|(_, c)| c).collect()))
            }
            _ => None,
        };
        role.or_else(|| {
            let spec = SPECS.iter().find(|spec| spec.message == format.name)?;
            let parts = parts(spec, format, self.options);
            let useful = !parts.is_empty() || format.name == "GPS";
            useful.then(|| Role::Series(parts.into_iter().map(|(part, _)| part).collect()))
        })
        .unwrap_or(Role::Nothing)
    }

    /// The series for this kind of message, the one of before where it fits.
    fn series_of(&mut self, format: &Format) -> usize {
        let Some(spec) = SPECS.iter().find(|spec| spec.message == format.name) else {
            return 0;
        };
        let labels: Vec<Label> = parts(spec, format, self.options)
            .into_iter()
            .map(|(_, label)| label)
            .collect();
        let same = |(name, series): &(&str, Series)| {
            *name == spec.message && series.signals().map(|s| s.label).eq(&labels)
        };
        if let Some(index) = self.series.iter().position(same) {
            return index;
        }
        self.series.push((spec.message, Series::new(labels)));
        self.series.len() - 1
    }

    /// Takes in a message.
    pub(super) fn message(&mut self, type_id: u8, cells: Cells<'_>) {
        let Some(kind) = self
            .kinds
            .get(usize::from(type_id))
            .and_then(Option::as_ref)
        else {
            return;
        };
        if let Some(column) = kind.instance
            && cells.number(&kind.format, column) != Some(0.0)
        {
            return;
        }
        // Parameters need no time, and may be logged with that of another thread.
        if let Role::Parameter { name, value } = kind.role {
            let name = cells.text(&kind.format, name);
            let value = cells.number(&kind.format, value);
            if let Some((name, value)) = name.zip(value) {
                self.parameters.insert(&name, value);
            }
            return;
        }
        let Some((column, unit)) = kind.time else {
            // An event without a time does not tell when: the commands tell more.
            if !matches!(kind.role, Role::Event(_) | Role::Arm(_) | Role::Nothing)
                && !self.untimed.keep(type_id, cells)
            {
                self.report.bad_messages += 1;
                self.report.because(|| "messages without a time".into());
            }
            return;
        };
        let Some(t_s) = cells.number(&kind.format, column).map(|time| time * unit) else {
            self.report.bad_messages += 1;
            return;
        };
        match self.clock.place(t_s) {
            Placed::At(t_s) => self.take_timed(type_id, cells, t_s),
            Placed::Wait => self.wait(type_id, cells),
            Placed::Confirmed(first_s, t_s) => {
                self.untimed.confirm_first(first_s);
                if let Some(waiting) = self.waiting.take() {
                    waiting.give(|type_id, cells| self.take(type_id, cells, first_s));
                }
                self.take_timed(type_id, cells, t_s);
            }
            Placed::Refuted(t_s) => {
                self.refute();
                self.take_timed(type_id, cells, t_s);
            }
            Placed::RefutedWait => {
                self.refute();
                self.wait(type_id, cells);
            }
        }
    }

    fn wait(&mut self, type_id: u8, cells: Cells<'_>) {
        self.waiting = Some(Kept::new(type_id, cells));
        if self.clock.now_s().is_none() {
            self.untimed.mark_first();
        }
    }

    /// Takes a message whose time is its own, and those before it that had none.
    fn take_timed(&mut self, type_id: u8, cells: Cells<'_>, t_s: f64) {
        for (t_s, kept) in self.untimed.placed_before(t_s) {
            kept.give(|type_id, cells| self.take(type_id, cells, t_s));
        }
        self.take(type_id, cells, t_s);
    }

    fn refute(&mut self) {
        self.waiting = None;
        self.report.bad_messages += 1;
        self.report
            .because(|| "a message with a time that no other agrees with".into());
    }

    fn take(&mut self, type_id: u8, cells: Cells<'_>, t_s: f64) {
        let Some(kind) = self
            .kinds
            .get(usize::from(type_id))
            .and_then(Option::as_ref)
        else {
            return;
        };
        let format = &kind.format;
        self.redefine = false;
        let number = |column| cells.number(format, column);
        match &kind.role {
            Role::Nothing | Role::Parameter { .. } => {}
            Role::Text(column) => {
                if let Some(text) = cells.text(format, *column) {
                    self.texts.push(Event::new(t_s, text));
                }
            }
            Role::Event(column) => {
                let landing = match number(*column).map(|id| id as i64) {
                    Some(10) => Landing::Armed,
                    Some(11) => Landing::Disarmed,
                    Some(28) => Landing::Left,
                    Some(18) => Landing::Landed,
                    _ => return,
                };
                self.events.push((t_s, landing));
            }
            Role::Arm(column) => {
                let landing = match number(*column) {
                    Some(0.0) => Landing::Disarmed,
                    Some(_) => Landing::Armed,
                    None => return,
                };
                self.events.push((t_s, landing));
            }
            Role::Mode { number: id, name } => {
                let id = id.and_then(number).or_else(|| number(*name));
                let mode = match id {
                    Some(id) => ardupilot::copter_mode(id as i64),
                    None => cells.text(format, *name).unwrap_or_default(),
                };
                self.modes.push(Event::new(t_s, mode));
            }
            Role::Outputs(columns) => {
                let values = columns
                    .iter()
                    .filter_map(|(column, output)| Some((*output, number(*column)?)));
                let first = columns.first().is_none_or(|(_, output)| *output == 1);
                self.report.bad_messages += u64::from(self.outputs.add(t_s, first, values));
            }
            Role::Series(parts) => {
                if self.utc_at_zero_s.is_none() && format.name == "GPS" {
                    self.utc_at_zero_s = gps_utc_s(format, &cells).map(|utc_s| utc_s - t_s);
                }
                if parts.is_empty() {
                    return;
                }
                let values = parts.iter().map(|part| match part {
                    Part::Field { column, scale } => {
                        number(*column).map_or(f64::NAN, |value| value * scale)
                    }
                    Part::Length(a, b) => match number(*a).zip(number(*b)) {
                        Some((a, b)) => a.hypot(b),
                        None => f64::NAN,
                    },
                });
                if let Some((_, series)) = self.series.get_mut(kind.series) {
                    self.report.bad_messages += u64::from(series.push(t_s, values));
                }
            }
        }
    }

    /// The flight, once the whole log has been read.
    pub(super) fn finish(mut self, mut flight: Flight) -> Flight {
        if self.waiting.take().is_some() {
            self.refute();
        }
        if self.clock.now_s().is_none() && !self.untimed.is_empty() {
            self.report.because(|| "no message has a time".into());
        }
        for (t_s, kept) in self.untimed.placed_at_end() {
            kept.give(|type_id, cells| self.take(type_id, cells, t_s));
        }
        let said = self.texts.iter().map(|text| &text.what);
        let texts = self.greetings.iter().chain(said).map(String::as_str);
        flight.vehicle = ardupilot::vehicle(texts, &self.parameters);
        flight.motors = match self.named_motors {
            0 => ardupilot::motors(&self.parameters, &flight.vehicle, self.label),
            motors => ardupilot::numbered_motors(motors, "Mot", "MOT message"),
        };
        flight.range = ardupilot::pwm_range(&self.parameters);
        flight.effective = ardupilot::effective_range(&self.parameters);
        flight.commands = self.outputs.commands(&flight.motors);
        let span_s = self.clock.first_s().zip(self.clock.now_s());
        (flight.armed, flight.in_air) = ardupilot::air_from_commands(&flight);
        if !self.events.is_empty() {
            let span_s = span_s.unwrap_or_default();
            let (armed, in_air) = air_from_events(&self.events, self.clock.boots_s(), span_s);
            flight.armed = Some(armed);
            // Firmware before 3.1 tells of arming, but not of leaving the ground.
            let tells = |event| matches!(event, Landing::Left | Landing::Landed);
            if self.events.iter().any(|&(_, event)| tells(event)) {
                flight.in_air = Some(in_air);
            }
        }
        flight.series = order(self.series);
        self.modes.sort_by_key(|mode| mode.t_us);
        flight.modes = self.modes;
        flight.messages = self.texts;
        flight.utc_at_zero_s = self.utc_at_zero_s;
        flight.boots_s = self.clock.boots_s().to_vec();
        flight.report = self.report;
        flight
    }
}

/// Columns labelled with one of `stems` and a number.
fn numbered(format: &Format, stems: &[&'static str]) -> Vec<(&'static str, (usize, u16))> {
    let number = |label: &str| {
        stems.iter().find_map(|stem| {
            let number: u16 = label.strip_prefix(stem)?.parse().ok()?;
            (1..=32).contains(&number).then_some((*stem, number))
        })
    };
    format
        .columns
        .iter()
        .enumerate()
        .filter_map(|(column, described)| {
            let (stem, output) = number(&described.label)?;
            Some((stem, (column, output)))
        })
        .collect()
}

/// The signals that a message of this format holds and that are asked for.
fn parts(spec: &Spec, format: &Format, options: &Options) -> Vec<(Part, Label)> {
    let integer = |column: usize| {
        let kind = format.columns.get(column).map(|described| described.kind);
        matches!(kind, Some(b'h' | b'H' | b'i' | b'I'))
    };
    spec.signals
        .iter()
        .filter(|(_, name, _)| options.wants(name))
        .filter_map(|(from, name, unit)| {
            let (part, fields) = match from {
                From::Field(labels) => {
                    let column = format.column(labels)?;
                    (
                        Part::Field { column, scale: 1.0 },
                        format.columns.get(column)?.label.clone(),
                    )
                }
                From::Hundredths(labels) => {
                    let column = format.column(labels)?;
                    let scale = if integer(column) { 0.01 } else { 1.0 };
                    (
                        Part::Field { column, scale },
                        format.columns.get(column)?.label.clone(),
                    )
                }
                From::Length(a, b) => (
                    Part::Length(format.column(&[a])?, format.column(&[b])?),
                    format!("{a}, {b}"),
                ),
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

/// UTC of a GPS message with a fix, from its week and the time in it.
fn gps_utc_s(format: &Format, cells: &Cells<'_>) -> Option<f64> {
    let number = |labels| cells.number(format, format.column(labels)?);
    let has_fix = number(&["Status"])? >= 3.0;
    let week = number(&["GWk", "Week"]).filter(|&week| has_fix && week > 0.0)?;
    Some(utc::from_gps_s(week, number(&["GMS", "TimeMS"])? * 1e-3))
}

/// Armed and in-air times from the events of the log. A boot ends both.
fn air_from_events(
    events: &[(f64, Landing)],
    boots_s: &[f64],
    (first_s, last_s): (f64, f64),
) -> (Intervals, Intervals) {
    let changes = |yes: Landing, no: &[Landing]| -> Vec<(f64, bool)> {
        let mut changes: Vec<(f64, bool)> = events
            .iter()
            .filter_map(|&(t_s, event)| match event {
                event if event == yes => Some((t_s, true)),
                event if no.contains(&event) => Some((t_s, false)),
                _ => None,
            })
            .chain(boots_s.iter().map(|&t_s| (t_s, false)))
            .collect();
        changes.sort_by(|a, b| a.0.total_cmp(&b.0));
        changes
    };
    let first = events.first().map(|&(_, event)| event);
    let armed = Intervals::from_changes(
        &changes(Landing::Armed, &[Landing::Disarmed]),
        // A log whose first word is of flying or its end was already armed before.
        first.is_some_and(|event| event != Landing::Armed),
        first_s,
        last_s,
        "EV 10 (armed) to EV 11 (disarmed), and ARM",
    );
    let in_air = Intervals::from_changes(
        &changes(Landing::Left, &[Landing::Landed, Landing::Disarmed]),
        first == Some(Landing::Landed),
        first_s,
        last_s,
        "EV 28 (not landed) to EV 18 (land complete) or disarmed",
    );
    (armed, in_air)
}

/// The series in the order of their table, so that the preferred source of a signal comes
/// first; those without rows are left out.
fn order(series: Vec<(&'static str, Series)>) -> Vec<Series> {
    let mut series: Vec<_> = series.into_iter().filter(|(_, s)| !s.is_empty()).collect();
    series.sort_by_key(|(name, _)| SPECS.iter().position(|spec| spec.message == *name));
    series.into_iter().map(|(_, series)| series).collect()
}
