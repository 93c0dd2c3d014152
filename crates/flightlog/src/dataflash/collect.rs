//! Converts DataFlash messages, binary or text, to a `Flight`.

use super::format::{Cells, Column, FMT, Format};
use super::plan::{MOTORS, MessageRole, MessageType, ResolvedSource};
use super::signals::SPECS;
use super::state_events::{StateEvent, air_from_events, boots_in_air};
use super::untimed::{PendingMessage, UntimedMessages};
use crate::ardupilot::{self, Mode};
use crate::clock::{Clock, TimestampDecision};
use crate::field::vector_length;
use crate::geometry::{self, DeclaredLayout};
use crate::outputs::Outputs;
use crate::parameters::Parameters;
use crate::signal::{Label, preferred};
use crate::{Event, Flight, Options, Report, Series, VehicleKind, utc};

pub(super) struct Collector<'o> {
    options: &'o Options,
    kinds: Vec<Option<MessageType>>,
    /// The number of motors that have a column of their own in MOT messages (firmware before 3.2).
    named_motors: u16,
    clock: Clock,
    waiting: Option<PendingMessage>,
    untimed: UntimedMessages,
    redefine: bool,
    pub(super) report: Report,
    parameters: Parameters,
    outputs: Outputs,
    label: &'static str,
    series: Vec<(&'static str, Series)>,
    events: Vec<(f64, StateEvent)>,
    modes: Vec<(f64, Mode)>,
    texts: Vec<Event>,
    /// The texts of a text log before its first message.
    pub(super) greetings: Vec<String>,
    utc_at_zero_s: Option<f64>,
}

impl<'o> Collector<'o> {
    pub(super) fn new(options: &'o Options) -> Self {
        Self {
            options,
            kinds: (0..256).map(|_| None).collect(),
            named_motors: 0,
            clock: Clock::default(),
            waiting: None,
            untimed: UntimedMessages::default(),
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

    /// Whether messages of this type contain anything that is read.
    pub(super) fn wants(&self, type_id: u8) -> bool {
        kind(&self.kinds, type_id).is_some_and(|kind| !matches!(kind.role, MessageRole::Nothing))
    }

    /// Checks that the fields of a text line match their definition in number and type.
    pub(super) fn check(&self, type_id: u8, cells: &[&str]) -> Result<(), &'static str> {
        let Some(kind) = kind(&self.kinds, type_id) else {
            return Ok(());
        };
        let columns = &kind.format.columns;
        if cells.len() < columns.len() {
            return Err("with too few fields");
        }
        let is_number = |(column, cell): (&Column, &&str)| {
            matches!(column.kind, b'n' | b'N' | b'Z' | b'M' | b'a') || cell.parse::<f64>().is_ok()
        };
        let wanted = !matches!(kind.role, MessageRole::Nothing);
        if wanted && !columns.iter().zip(cells).all(is_number) {
            return Err("with a field that is not a number");
        }
        Ok(())
    }

    /// Stores the definition of a message type, and returns whether it is in use from now on.
    pub(super) fn define(&mut self, format: Format) -> bool {
        let known = kind(&self.kinds, format.type_id).map(|kind| &kind.format);
        let (is_known, is_same) = (known.is_some(), known == Some(&format));
        if format.type_id == FMT && is_known {
            // The definitions are repeated: the autopilot rebooted and continued this log.
            self.clock.expect_boot();
            self.redefine = true;
        }
        if is_same {
            return true;
        }
        // If the same boot defines a type a second time in a different way, the definition is damaged.
        if is_known && !self.redefine {
            self.report
                .bad(&format!("message `{}` is defined twice", format.name));
            return false;
        }
        let type_id = usize::from(format.type_id);
        let known = &mut self.series;
        let kind = MessageType::new(format, self.options, |name, labels| {
            series_of(known, name, labels)
        });
        if let MessageRole::Outputs(label, columns) = &kind.role {
            match kind.format.name.as_str() {
                MOTORS => self.named_motors = columns.len() as u16,
                _ => self.label = label,
            }
        }
        if let Some(slot) = self.kinds.get_mut(type_id) {
            *slot = Some(kind);
        }
        true
    }

    /// Processes a message.
    pub(super) fn message(&mut self, type_id: u8, cells: Cells<'_>) {
        if self.report.leaves_out(self.clock.is_full()) {
            return;
        }
        let Some(kind) = kind(&self.kinds, type_id) else {
            return;
        };
        if let Some(column) = kind.instance
            && cells.number(&kind.format, column) != Some(0.0)
        {
            return;
        }
        // Parameters need no time, and may carry the time of another thread.
        if let MessageRole::Parameter { name, value } = kind.role {
            let name = cells.text(&kind.format, name);
            let value = cells.number(&kind.format, value);
            if let Some((name, value)) = name.zip(value) {
                self.parameters.insert(&name, value);
            }
            return;
        }
        let Some((column, unit)) = kind.time else {
            // Events without a time are ignored, because the commands show the state better.
            if !matches!(
                kind.role,
                MessageRole::Event(_) | MessageRole::Arm(_) | MessageRole::Nothing
            ) && !self.untimed.keep(type_id, cells)
            {
                self.report.bad("messages without a time");
            }
            return;
        };
        let Some(t_s) = cells.number(&kind.format, column).map(|time| time * unit) else {
            return self.report.bad("a message without a time");
        };
        match self.clock.check(t_s) {
            TimestampDecision::At(t_s) => self.take_timed(type_id, cells, t_s),
            TimestampDecision::Wait => self.wait(type_id, cells),
            TimestampDecision::Confirmed(first_s, t_s) => {
                self.untimed.confirm_first(first_s);
                if let Some(waiting) = self.waiting.take() {
                    waiting.give(|type_id, cells| self.take(type_id, cells, first_s));
                }
                self.take_timed(type_id, cells, t_s);
            }
            TimestampDecision::Refuted(t_s) => {
                self.refute();
                self.take_timed(type_id, cells, t_s);
            }
            TimestampDecision::RefutedWait => {
                self.refute();
                self.wait(type_id, cells);
            }
        }
    }

    fn wait(&mut self, type_id: u8, cells: Cells<'_>) {
        self.waiting = Some(PendingMessage::new(type_id, cells));
        if self.clock.now_s().is_none() {
            self.untimed.mark_first();
        }
    }

    /// Processes a message with its own time, after the earlier messages that had none.
    fn take_timed(&mut self, type_id: u8, cells: Cells<'_>, t_s: f64) {
        for (t_s, kept) in self.untimed.timed_before(t_s) {
            kept.give(|type_id, cells| self.take(type_id, cells, t_s));
        }
        self.take(type_id, cells, t_s);
    }

    fn refute(&mut self) {
        self.waiting = None;
        self.report.bad("a timestamp that contradicts the others");
    }

    fn take(&mut self, type_id: u8, cells: Cells<'_>, t_s: f64) {
        let Some(kind) = kind(&self.kinds, type_id) else {
            return;
        };
        let format = &kind.format;
        self.redefine = false;
        let number = |column| cells.number(format, column);
        match &kind.role {
            MessageRole::Nothing | MessageRole::Parameter { .. } => {}
            MessageRole::Text(column) => {
                if let Some(text) = cells.text(format, *column) {
                    self.report.text(&mut self.texts, Event::new(t_s, text));
                }
            }
            MessageRole::Event(column) => {
                if let Some(event) = number(*column).and_then(StateEvent::of) {
                    self.report.change();
                    self.events.push((t_s, event));
                }
            }
            MessageRole::Arm(column) => {
                let event = match number(*column) {
                    Some(0.0) => StateEvent::Disarmed,
                    Some(_) => StateEvent::Armed,
                    None => return,
                };
                self.report.change();
                self.events.push((t_s, event));
            }
            MessageRole::Mode { number: id, name } => {
                let id = id.and_then(number).or_else(|| number(*name));
                let mode = match id {
                    Some(id) => Mode::Number(id as i64),
                    None => Mode::Name(cells.text(format, *name).unwrap_or_default()),
                };
                self.report.mode(&mut self.modes, (t_s, mode));
            }
            MessageRole::Outputs(_, columns) => {
                let values = columns
                    .iter()
                    .filter_map(|(column, output)| Some((*output, number(*column)?)));
                let first = columns.first().is_none_or(|(_, output)| *output == 1);
                let dropped = self.outputs.add(t_s, first, values);
                self.report.row(columns.len(), dropped);
            }
            MessageRole::Series(index, parts) => {
                if self.utc_at_zero_s.is_none() && format.name == "GPS" {
                    self.utc_at_zero_s = gps_utc_s(format, &cells).map(|utc_s| utc_s - t_s);
                }
                let values = parts.iter().map(|part| match part {
                    ResolvedSource::Field { column, scale } => {
                        number(*column).map_or(f64::NAN, |value| value * scale)
                    }
                    ResolvedSource::Position(column) => number(*column)
                        .filter(|degrees| *degrees != 0.0)
                        .unwrap_or(f64::NAN),
                    ResolvedSource::Length(columns) => {
                        vector_length(columns.iter().map(|&column| number(column)))
                            .unwrap_or(f64::NAN)
                    }
                });
                match self.series.get_mut(*index) {
                    Some((_, series)) => self.report.row(parts.len(), series.push(t_s, values)),
                    None => self.report.bad("more than 256 definitions of signals"),
                }
            }
        }
    }

    /// Returns the flight, after the whole log has been read.
    pub(super) fn finish(mut self, mut flight: Flight) -> Flight {
        if self.waiting.take().is_some() {
            self.refute();
        }
        if self.clock.now_s().is_none() && !self.untimed.is_empty() {
            self.report.because(|| "no message has a time".into());
        }
        for (t_s, kept) in self.untimed.timed_at_end() {
            kept.give(|type_id, cells| self.take(type_id, cells, t_s));
        }
        let texts_of_log = self.texts.iter().map(|text| &text.what);
        let texts = self
            .greetings
            .iter()
            .chain(texts_of_log)
            .map(String::as_str);
        flight.vehicle = ardupilot::vehicle(texts, &self.parameters);
        let vehicle = &mut flight.vehicle;
        if vehicle.motors.is_none() && vehicle.kind == VehicleKind::Multirotor {
            vehicle.motors = match self.named_motors {
                0 => self.outputs.estimate_motor_count(),
                motors => Some(motors),
            };
        }
        let motors = match self.named_motors {
            0 => ardupilot::motors(&self.parameters, &flight.vehicle, |output| {
                format!("{}{output}", self.label)
            }),
            motors => {
                let name = |motor| format!("Mot{motor}");
                ardupilot::numbered_motors(motors, name, "MOT message")
            }
        };
        let outputs: Vec<u16>;
        (flight.motors, outputs) = motors.into_iter().unzip();
        flight.parameters = self.parameters.of_motors("PARM");
        let own = ardupilot::pwm_range(&self.parameters);
        flight.range = self.options.range_or_given(own);
        let restarts_s = self.outputs.restarts_s(self.clock.boots_s());
        flight.commands = self.outputs.commands(&outputs);
        let span_s = self.clock.first_s().zip(self.clock.now_s());
        let left_out = &mut self.report.left_out;
        left_out.parameters = self.parameters.left_out();
        (flight.armed, flight.in_air) =
            ardupilot::air_from_commands(&flight, &mut left_out.changes);
        if let Some(by_commands) = &flight.in_air {
            flight.rebooted_in_air_s = by_commands.within(&restarts_s);
        }
        if !self.events.is_empty() {
            let span_s = span_s.unwrap_or_default();
            let (armed, in_air) = air_from_events(&self.events, self.clock.boots_s(), span_s);
            flight.armed = Some(armed);
            if let Some(in_air) = in_air {
                flight.in_air = Some(in_air);
                flight.rebooted_in_air_s = boots_in_air(&self.events, &restarts_s);
            }
        }
        flight.effective_range = ardupilot::range_in_force(&self.parameters, &flight);
        flight.effective_range_doubt = ardupilot::effective_doubt(&self.parameters);
        self.series
            .sort_by_key(|(name, _)| SPECS.iter().position(|spec| spec.message == *name));
        let series = self.series.into_iter().map(|(_, series)| series);
        flight.series = preferred(series.collect());
        self.modes.sort_by(|(a, _), (b, _)| a.total_cmp(b));
        let kind = flight.vehicle.kind;
        flight.modes = self
            .modes
            .into_iter()
            .map(|(t_s, mode)| Event::new(t_s, mode.name(kind)))
            .collect();
        flight.messages = self.texts;
        flight.utc_at_zero_s = self.utc_at_zero_s;
        flight.boots_s = self.clock.boots_s().to_vec();
        flight.report = self.report;
        let declared = DeclaredLayout::of_ardupilot(&self.parameters, &flight.vehicle);
        flight.geometry = geometry::find(&flight, &declared);
        flight
    }
}

/// The definition and use of a message type.
fn kind(kinds: &[Option<MessageType>], type_id: u8) -> Option<&MessageType> {
    kinds.get(usize::from(type_id))?.as_ref()
}

/// The maximum number of different series that changing definitions can create; undamaged logs have fewer.
const MAX_SERIES: usize = 256;

/// The index of the series for a message with these signals: the existing series if the definition is repeated,
/// otherwise a new one.
fn series_of(known: &mut Vec<(&str, Series)>, name: &'static str, labels: Vec<Label>) -> usize {
    let same = |(of, series): &(&str, Series)| {
        *of == name && series.signals().map(|signal| signal.label).eq(&labels)
    };
    known.iter().position(same).unwrap_or_else(|| {
        // If there are too many series, the index is out of range and the rows are dropped.
        if known.len() < MAX_SERIES {
            known.push((name, Series::new(labels)));
            return known.len() - 1;
        }
        MAX_SERIES
    })
}

/// The UTC time of a GPS message with a fix, from its GPS week and its time of the week.
fn gps_utc_s(format: &Format, cells: &Cells<'_>) -> Option<f64> {
    let number = |labels| cells.number(format, format.column(labels)?);
    let has_fix = number(&["Status"])? >= 3.0;
    let week = number(&["GWk", "Week"]).filter(|&week| has_fix && week > 0.0)?;
    Some(utc::from_gps_s(week, number(&["GMS", "TimeMS"])? * 1e-3))
}
