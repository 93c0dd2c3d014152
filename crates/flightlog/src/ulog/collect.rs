//! Converts ULog messages to a `Flight`.

use super::format::keyed_number;
use super::outputs::Outputs;
use super::plan::{TopicRole, parts};
use super::signals::SPECS;
use super::topics::{Topics, key};
use crate::clock::Latest;
use crate::field::NumericField;
use crate::geometry::{self, DeclaredLayout};
use crate::interval::both_hold;
use crate::parameters::Parameters;
use crate::signal::preferred;
use crate::{Commands, Event, Flight, Format, Intervals, Options, Report, Series, identity, px4};

/// A time that is later than all earlier times by more than this, in seconds, is damaged unless the next one agrees.
const LONGEST_PAUSE_S: f64 = 60.0;
/// The number of logged values in an outputs message.
const OUTPUTS: usize = 16;
/// The topic with the torque set points that the rate controllers output.
const TORQUE: &str = "vehicle_torque_setpoint";
const THRUST: &str = "vehicle_thrust_setpoint";
/// Index of the thrust along z.
const DOWN: usize = 2;
/// The assumption if the motor commands are not logged.
const COMPUTED: &str = "motor commands computed from torque and thrust set points: only estimates while motors are at their limits";
/// Thrust and torque are published together. A thrust older than the torque by more than this, in seconds, does not
/// belong to the torque.
const LATE_THRUST_S: f64 = 0.1;
/// The maximum number of topic announcements; a log of PX4 has a few hundred.
const MAX_ANNOUNCED: usize = 4096;

pub(super) struct Collector<'o> {
    options: &'o Options,
    pub(super) report: Report,
    pub(super) topics: Topics,
    announced: usize,
    roles: Vec<Option<(NumericField, TopicRole)>>,
    latest: Latest,
    parameters: Parameters,
    outputs: Vec<Outputs>,
    series: Vec<(&'static str, Series)>,
    armed: Vec<(f64, bool)>,
    landed: Vec<(f64, bool)>,
    modes: Vec<(f64, i64)>,
    texts: Vec<Event>,
    system_type: Option<f64>,
    release: Option<u32>,
    hardware: String,
    id: Option<String>,
    utc_at_zero_s: Option<f64>,
}

impl<'o> Collector<'o> {
    pub(super) fn new(options: &'o Options) -> Self {
        Self {
            options,
            report: Report::default(),
            topics: Topics::default(),
            announced: 0,
            roles: Vec::new(),
            latest: Latest::new(LONGEST_PAUSE_S),
            parameters: Parameters::default(),
            outputs: Vec::new(),
            series: Vec::new(),
            armed: Vec::new(),
            landed: Vec::new(),
            modes: Vec::new(),
            texts: Vec::new(),
            system_type: None,
            release: None,
            hardware: String::new(),
            id: None,
            utc_at_zero_s: None,
        }
    }

    /// Notes the time at which the log began.
    pub(super) fn started(&mut self, start_us: u64) {
        self.latest.accept(start_us as f64 * 1e-6);
    }

    /// Processes the body of a message; `letter` is the type of the message.
    pub(super) fn message(&mut self, letter: u8, body: &[u8]) {
        match letter {
            b'D' => self.data(body),
            b'F' => {
                let text = String::from_utf8_lossy(body);
                if let Err(why) = self.topics.formats.define(&text) {
                    self.report.bad(why);
                }
            }
            b'A' => self.announce(body),
            b'P' => {
                let value = key(body).and_then(|(key, value)| keyed_number(key, value));
                if let Some((name, value)) = value {
                    self.parameters.insert(name, value);
                }
            }
            b'I' => self.information(body),
            b'L' => self.text(body.get(1..)),
            b'C' => self.text(body.get(3..)),
            b'O' => {
                let lost_ms = body
                    .first_chunk()
                    .map_or(0, |bytes| u16::from_le_bytes(*bytes));
                let t_s = self.latest.time_s().unwrap_or_default();
                let what = format!("the logger lost {lost_ms} ms of data");
                self.report.text(&mut self.texts, Event::new(t_s, what));
            }
            _ => {}
        }
    }

    fn text(&mut self, body: Option<&[u8]>) {
        let Some((time, text)) = body.and_then(|body| body.split_first_chunk()) else {
            return;
        };
        let t_s = u64::from_le_bytes(*time) as f64 * 1e-6;
        let text = String::from_utf8_lossy(text).trim_end().to_owned();
        self.report.text(&mut self.texts, Event::new(t_s, text));
    }

    fn information(&mut self, body: &[u8]) {
        let Some((key, value)) = key(body) else {
            return;
        };
        match key.rsplit(' ').next() {
            Some("ver_sw_release") => {
                self.release = keyed_number(key, value).map(|(_, release)| release as u32);
            }
            Some("sys_uuid") => {
                let id = String::from_utf8_lossy(value).into_owned();
                // A board without a serial number writes zeros.
                self.id = Some(id).filter(|id| id.bytes().any(|digit| digit != b'0'));
            }
            Some("ver_hw") => self.hardware = String::from_utf8_lossy(value).into_owned(),
            _ => {}
        }
    }

    /// Processes `A`: instance, number, name of a topic.
    fn announce(&mut self, body: &[u8]) {
        self.announced += 1;
        if self.announced > MAX_ANNOUNCED {
            return self.report.bad("more than 4096 announced topics");
        }
        let Some((&[instance, low, high], name)) = body.split_first_chunk() else {
            return;
        };
        let id = u16::from_le_bytes([low, high]);
        let name = String::from_utf8_lossy(name);
        self.topics.announce(id, &name);
        let index = usize::from(id);
        if self.roles.len() <= index {
            self.roles.resize_with(index + 1, || None);
        }
        let time = self.topics.formats.field(&name, "timestamp");
        let role = self.role(&name, instance);
        if let Some(slot) = self.roles.get_mut(index) {
            *slot = time.zip(Some(role));
        }
    }

    fn role(&mut self, name: &str, instance: u8) -> TopicRole {
        let formats = &self.topics.formats;
        let find = |field: &str| formats.field(name, field);
        let commands = |topic: &'static str, field: &str| {
            let fields = (0..OUTPUTS).map_while(|index| find(&format!("{field}[{index}]")));
            (topic, fields.collect::<Vec<NumericField>>())
        };
        let (topic, fields) = match name {
            "actuator_motors" => commands("actuator_motors", "control"),
            "actuator_outputs" => commands("actuator_outputs", "output"),
            THRUST if instance == 0 => commands(THRUST, "xyz"),
            "vehicle_status" if instance == 0 => {
                return TopicRole::Status {
                    arming: find("arming_state"),
                    mode: find("nav_state"),
                    system_type: find("system_type"),
                };
            }
            "vehicle_land_detected" if instance == 0 => {
                return find("landed").map_or(TopicRole::Nothing, TopicRole::Land);
            }
            _ if instance == 0 => {
                let Some(spec) = SPECS.iter().find(|spec| spec.topic == name) else {
                    return TopicRole::Nothing;
                };
                let utc = find("time_utc_usec");
                let parts = parts(spec, &find, self.options);
                let (parts, labels): (Vec<_>, Vec<_>) = parts.into_iter().unzip();
                self.series.push((spec.topic, Series::new(labels)));
                return TopicRole::Series(self.series.len() - 1, parts, utc);
            }
            _ => return TopicRole::Nothing,
        };
        let known = |outputs: &Outputs| outputs.topic == topic && outputs.instance == instance;
        let index = self.outputs.iter().position(known).unwrap_or_else(|| {
            let width = fields.len();
            self.outputs.push(Outputs::new(topic, instance, width));
            self.outputs.len() - 1
        });
        TopicRole::Outputs(index, fields)
    }

    /// Processes `D`: number of the topic, then its fields.
    fn data(&mut self, body: &[u8]) {
        let Some((&id, body)) = body.split_first_chunk() else {
            return;
        };
        let index = usize::from(u16::from_le_bytes(id));
        let Some((time, role)) = self.roles.get(index).and_then(Option::as_ref) else {
            return;
        };
        if matches!(role, TopicRole::Nothing) || self.report.leaves_out(false) {
            return;
        }
        let Some(t_s) = time.number(body).map(|time_us| time_us * 1e-6) else {
            return self.report.bad("a message without a time");
        };
        if !self.latest.accept(t_s) {
            return self.report.bad("a timestamp that contradicts the others");
        }
        let flag = |field: &NumericField, yes: f64| Some(field.number(body)? == yes);
        match role {
            TopicRole::Nothing => {}
            TopicRole::Outputs(index, fields) => {
                let values = fields
                    .iter()
                    .map(|field| field.number(body).unwrap_or(f64::NAN) as f32);
                let Some(outputs) = self.outputs.get_mut(*index) else {
                    return;
                };
                self.report.row(fields.len(), outputs.push(t_s, values));
            }
            TopicRole::Status {
                arming,
                mode,
                system_type,
            } => {
                let is_armed = arming.as_ref().and_then(|field| flag(field, 2.0));
                self.report.state(&mut self.armed, t_s, is_armed);
                let mode = mode
                    .and_then(|field| field.number(body))
                    .map(|mode| mode as i64);
                if let Some(mode) = mode
                    && self.modes.last().is_none_or(|(_, last)| *last != mode)
                {
                    self.report.mode(&mut self.modes, (t_s, mode));
                }
                let system_type = system_type.and_then(|field| field.number(body));
                self.system_type = self.system_type.or(system_type);
            }
            TopicRole::Land(field) => self.report.state(&mut self.landed, t_s, flag(field, 1.0)),
            TopicRole::Series(index, parts, utc) => {
                if let (None, Some(field)) = (self.utc_at_zero_s, utc) {
                    let utc_us = field.number(body).filter(|&utc_us| utc_us > 0.0);
                    self.utc_at_zero_s = utc_us.map(|utc_us| utc_us * 1e-6 - t_s);
                }
                if let Some((_, series)) = self.series.get_mut(*index) {
                    let values = parts
                        .iter()
                        .map(|part| part.value(body).unwrap_or(f64::NAN));
                    self.report.row(parts.len(), series.push(t_s, values));
                }
            }
        }
    }

    /// Returns the flight, after the whole log has been read.
    pub(super) fn finish(mut self) -> Flight {
        let mut flight = Flight::empty(Format::ULog);
        let firmware = self.release.map(px4::firmware);
        flight.parameters = self.parameters.of_motors("ULog parameter");
        flight.vehicle = px4::vehicle(&self.parameters, self.system_type, firmware);
        if let Some(id) = self.id.take() {
            identity::name(&mut flight.vehicle, id, "sys_uuid");
        }
        self.take_commands(&mut flight);
        self.series
            .sort_by_key(|(name, _)| SPECS.iter().position(|spec| spec.topic == *name));
        let series = self.series.into_iter().map(|(_, series)| series);
        flight.series = preferred(series.collect());
        flight.modes = self
            .modes
            .into_iter()
            .map(|(t_s, mode)| Event::new(t_s, px4::nav_state(mode)))
            .collect();
        flight.messages = self.texts;
        flight.utc_at_zero_s = self.utc_at_zero_s;
        flight.report = self.report;
        flight.report.left_out.parameters = self.parameters.left_out();
        let span_s = geometry::span_s(&flight).unwrap_or_default();
        if !self.armed.is_empty() {
            let rule = "vehicle_status.arming_state = 2";
            flight.armed = Some(Intervals::from_states(&self.armed, span_s, rule));
        }
        if !self.landed.is_empty() {
            let flying: Vec<(f64, bool)> =
                self.landed.iter().map(|&(t, down)| (t, !down)).collect();
            flight.in_air = Some(match self.armed.is_empty() {
                true => Intervals::from_states(&flying, span_s, "vehicle_land_detected.landed = 0"),
                false => {
                    let rule =
                        "vehicle_land_detected.landed = 0 and vehicle_status.arming_state = 2";
                    Intervals::from_states(&both_hold(&flying, &self.armed), span_s, rule)
                }
            });
        }
        let set_back = self.outputs.iter().flat_map(|of| of.set_back.at_s());
        let in_air = set_back.filter(|t_s| flight.is_in_air(**t_s) == Some(true));
        flight.rebooted_in_air_s = in_air.copied().reduce(f64::min).into_iter().collect();
        flight.geometry = geometry::find(&flight, &DeclaredLayout::of_px4(&self.parameters));
        flight
    }

    /// Sets the motors, their commands, and the range of the commands.
    fn take_commands(&self, flight: &mut Flight) {
        let count = flight.vehicle.motors;
        let logged = |topic: &'static str| {
            let of_topic = move |outputs: &&Outputs| outputs.topic == topic && !outputs.is_empty();
            self.outputs.iter().filter(of_topic)
        };
        let topic = "actuator_motors";
        if let Some(outputs) = logged(topic).find(|outputs| outputs.instance == 0) {
            let (motors, range) = px4::actuator_motors(&self.parameters, outputs.in_use() as u16);
            // In this topic, the command of a motor that must stop is NaN.
            flight.commands = outputs.commands(0..motors.len(), |value| {
                if value.is_nan() { 0.0 } else { value.into() }
            });
            flight.motors = motors;
            flight.range = Some(range);
            return;
        }
        // The other instances drive gimbals and similar devices, or are all zero.
        for outputs in logged("actuator_outputs") {
            let instance = outputs.instance;
            let found = px4::actuator_outputs(&self.parameters, instance, count);
            let Some(&(_, first)) = found.first() else {
                continue;
            };
            let extremes = outputs.extremes(found.iter().map(|(_, index)| *index));
            if extremes.1 <= 0.0 {
                continue;
            }
            let hardware = &self.hardware;
            let indices = found.iter().map(|(_, index)| *index);
            flight.commands = outputs.commands(indices, f64::from);
            let own = px4::output_range(&self.parameters, instance, first, extremes, hardware);
            flight.range = self.options.range_or_given(own);
            flight.motors = found.into_iter().map(|(motor, _)| motor).collect();
            return;
        }
        if let Some(commands) = self.computed_commands() {
            let (motors, range) = px4::computed_motors(commands.motors());
            (flight.motors, flight.range, flight.commands) = (motors, Some(range), commands);
            flight.assumed.push(COMPUTED.into());
            return;
        }
        let (motors, _) = px4::actuator_motors(&self.parameters, count.unwrap_or(0));
        flight.motors = motors;
    }

    /// Computes the motor commands from torque and thrust set points.
    fn computed_commands(&self) -> Option<Commands> {
        let allocation = px4::Allocation::of(&self.parameters)?;
        let (_, torque) = self.series.iter().find(|(topic, _)| *topic == TORQUE)?;
        let thrust = self
            .outputs
            .iter()
            .find(|outputs| outputs.topic == THRUST)?;
        let thrust = thrust.commands([DOWN].into_iter(), f64::from);
        let mut thrust = thrust.rows().peekable();
        let mut latest = (f64::NEG_INFINITY, f64::NAN);
        let mut axes: Vec<_> = torque.signals().map(|signal| signal.hold()).collect();
        let mut commands = Commands::new(allocation.motors());
        for &t_s in torque.t_s() {
            while let Some((thrust_s, row)) = thrust.next_if(|(thrust_s, _)| *thrust_s <= t_s) {
                latest = (thrust_s, row.first().copied().unwrap_or(f64::NAN));
            }
            let down = if t_s - latest.0 <= LATE_THRUST_S {
                latest.1
            } else {
                f64::NAN
            };
            let mut axis = |index: usize| axes.get_mut(index)?.at(t_s);
            let [roll, pitch, yaw] = [axis(0), axis(1), axis(2)].map(|set| set.unwrap_or(f64::NAN));
            commands.push(t_s, allocation.commands([roll, pitch, yaw, down]));
        }
        (!commands.is_empty()).then_some(commands)
    }
}
