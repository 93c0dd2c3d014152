//! From MAVLink packets to a `Flight`.

use super::signals::{SPECS, Spec};
use crate::ardupilot::{self, Mode};
use crate::clock::Latest;
use crate::geometry::{self, Declared};
use crate::interval::both_hold;
use crate::mav_type::{MavType, mav_type};
use crate::mavlink::packet::Packet;
use crate::mavlink::servo::{OUTPUTS_A_PORT, bank, field, px4_motors};
use crate::outputs::Outputs;
use crate::parameters::Parameters;
use crate::place::{Kind, Place};
use crate::signal::{Label, preferred};
use crate::{Event, Flight, Format, Intervals, Options, Report, Series, VehicleKind, px4};

/// Telemetry pauses while the link is lost; a time further ahead is damage.
const LONGEST_PAUSE_S: f64 = 3600.0;
/// The component of a system that is its autopilot.
const AUTOPILOT: u8 = 1;
/// MAV_AUTOPILOT of PX4.
const PX4: u8 = 12;
/// Flag of HEARTBEAT.base_mode: the motors are armed.
const ARMED: u8 = 128;

const HEARTBEAT: u32 = 0;
const PARAM_VALUE: u32 = 22;
const SERVO_OUTPUT_RAW: u32 = 36;
const BATTERY_STATUS: u32 = 147;
const AUTOPILOT_VERSION: u32 = 148;
const EXTENDED_SYS_STATE: u32 = 245;
const STATUSTEXT: u32 = 253;

pub(super) struct Collector<'o> {
    options: &'o Options,
    /// Numbers of the messages that are read.
    wanted: Vec<u32>,
    pub(super) report: Report,
    /// Time of the first packet of the log, microseconds since 1970.
    zero_us: Option<u64>,
    latest: Latest,
    /// What was heard of each system, in the order in which they were first heard.
    systems: Vec<(u8, Heard)>,
}

/// What was heard of a system.
#[derive(Default)]
struct Heard {
    autopilot: u8,
    mav_type: Option<u8>,
    version: Option<u32>,
    parameters: Parameters,
    outputs: Outputs,
    has_port_0: bool,
    series: Vec<(usize, Series)>,
    armed: Vec<(f64, bool)>,
    active: Vec<(f64, bool)>,
    flying: Vec<(f64, bool)>,
    modes: Vec<(f64, u32)>,
    texts: Vec<Event>,
}

impl<'o> Collector<'o> {
    pub(super) fn new(options: &'o Options) -> Self {
        let always = [
            HEARTBEAT,
            PARAM_VALUE,
            SERVO_OUTPUT_RAW,
            AUTOPILOT_VERSION,
            EXTENDED_SYS_STATE,
            STATUSTEXT,
        ];
        let signals = SPECS.iter().map(|spec| spec.id);
        Self {
            options,
            wanted: always.into_iter().chain(signals).collect(),
            report: Report::default(),
            zero_us: None,
            latest: Latest::new(LONGEST_PAUSE_S),
            systems: Vec::new(),
        }
    }

    /// Takes in a packet.
    pub(super) fn packet(&mut self, stamp_us: u64, packet: &Packet<'_>) {
        let zero_us = *self.zero_us.get_or_insert(stamp_us);
        let t_s = (stamp_us as f64 - zero_us as f64) * 1e-6;
        if !self.latest.believe(t_s) {
            return self.report.bad("a time that no other agrees with");
        }
        // Ground stations store parameters under the number of another component.
        if packet.component != AUTOPILOT && packet.id != PARAM_VALUE
            || !self.wanted.contains(&packet.id)
        {
            return;
        }
        // Version 2 leaves out the zeros at the end of a payload.
        let mut payload = [0; 255];
        let length = packet.payload.len().min(payload.len());
        payload[..length].copy_from_slice(&packet.payload[..length]);
        let known = (self.systems.iter()).position(|(system, _)| *system == packet.system);
        let index = known.unwrap_or_else(|| {
            self.systems.push((packet.system, Heard::default()));
            self.systems.len() - 1
        });
        if let Some((_, heard)) = self.systems.get_mut(index) {
            let dropped = heard.message(t_s, packet.id, &payload, self.options);
            self.report.dropped_row(dropped);
        }
    }

    /// The flight, once the whole log has been read.
    pub(super) fn finish(self) -> Flight {
        let mut flight = Flight::empty(Format::Tlog);
        flight.report = self.report;
        flight.utc_at_zero_s = self.zero_us.map(|zero_us| zero_us as f64 * 1e-6);
        // The vehicle is the first system that says of itself to be one; where none does,
        // the first that sends anything as an autopilot.
        let is_vehicle = |(_, heard): &(u8, Heard)| heard.mav_type().is_some();
        let mut systems = self.systems;
        let chosen = systems.iter().position(is_vehicle).unwrap_or(0);
        if chosen < systems.len() {
            let declared = systems.swap_remove(chosen).1.finish(&mut flight);
            flight.geometry = geometry::find(&flight, &declared);
        }
        flight
    }
}

fn number(payload: &[u8], offset: usize, kind: Kind) -> Option<f64> {
    Place { offset, kind }.number(payload)
}

fn text(bytes: &[u8]) -> String {
    let end = bytes
        .iter()
        .position(|&byte| byte == 0)
        .unwrap_or(bytes.len());
    String::from_utf8_lossy(&bytes[..end]).trim().to_owned()
}

impl Heard {
    /// Takes in a message of the vehicle; `true` when a row was dropped because times go back.
    fn message(&mut self, t_s: f64, id: u32, payload: &[u8; 255], options: &Options) -> bool {
        match id {
            HEARTBEAT => self.heartbeat(t_s, payload),
            PARAM_VALUE => self.parameter(payload),
            SERVO_OUTPUT_RAW => return self.servos(t_s, payload),
            AUTOPILOT_VERSION => {
                // PX4 tells its version only here; capabilities, uid, then the version.
                let version = number(payload, 16, Kind::U32).map(|version| version as u32);
                self.version = self.version.or(version);
            }
            EXTENDED_SYS_STATE => {
                // 1 on the ground, 2 in the air, 3 taking off, 4 landing.
                if let landed @ 1..=4 = payload[1] {
                    self.flying.push((t_s, landed != 1));
                }
            }
            STATUSTEXT => self.texts.push(Event::new(t_s, text(&payload[1..51]))),
            BATTERY_STATUS if payload[32] != 0 => {}
            _ => return self.signals(t_s, id, payload, options),
        }
        false
    }

    /// The type in its heartbeats, if it is that of a vehicle.
    fn mav_type(&self) -> Option<(u8, MavType)> {
        let number = self.mav_type?;
        Some((number, mav_type(number.into())?))
    }

    fn heartbeat(&mut self, t_s: f64, payload: &[u8; 255]) {
        let [mode @ .., mav_type, autopilot, base_mode, status] =
            *payload.first_chunk::<8>().unwrap_or(&[0; 8]);
        self.autopilot = autopilot;
        self.mav_type = Some(mav_type);
        self.armed.push((t_s, base_mode & ARMED != 0));
        // ArduPilot is in STANDBY on the ground, and ACTIVE or CRITICAL in the air.
        self.active.push((t_s, matches!(status, 4 | 5)));
        let mode = u32::from_le_bytes(mode);
        if self.modes.last().is_none_or(|(_, last)| *last != mode) {
            self.modes.push((t_s, mode));
        }
    }

    fn parameter(&mut self, payload: &[u8; 255]) {
        // PX4 sends the bits of integers; ArduPilot sends every number as a float.
        let is_integer = matches!(payload[24], 1..=6);
        let kind = match self.autopilot == PX4 && is_integer {
            true => Kind::I32,
            false => Kind::F32,
        };
        if let Some(value) = number(payload, 0, kind) {
            self.parameters.insert(&text(&payload[8..24]), value);
        }
    }

    /// Outputs 1 to 8 of a port, and 9 to 16 in version 2; those of port 1 complete the row that port 0 began.
    fn servos(&mut self, t_s: f64, payload: &[u8; 255]) -> bool {
        let port = payload[20];
        if port > 1 {
            return false;
        }
        self.has_port_0 |= port == 0;
        let first = port == 0 || !self.has_port_0;
        let before = u16::from(port) * OUTPUTS_A_PORT as u16;
        let offset = |output: u16| match output {
            ..=8 => 2 + 2 * usize::from(output),
            _ => 3 + 2 * usize::from(output),
        };
        // Those above 8 are 0 where the sender does not have them.
        let outputs = (1..=16)
            .filter_map(|output| Some((output, number(payload, offset(output), Kind::U16)?)))
            .filter(|&(output, pulse_us)| output <= 8 || pulse_us > 0.0)
            .map(|(output, pulse_us)| (before + output, pulse_us));
        self.outputs.add(t_s, first, outputs)
    }

    fn signals(&mut self, t_s: f64, id: u32, payload: &[u8; 255], options: &Options) -> bool {
        let Some(index) = SPECS.iter().position(|spec| spec.id == id) else {
            return false;
        };
        let spec = &SPECS[index];
        let known = self.series.iter().position(|(of, _)| *of == index);
        let slot = known.unwrap_or_else(|| {
            self.series
                .push((index, Series::new(labels(spec, options))));
            self.series.len() - 1
        });
        let wanted = spec
            .signals
            .iter()
            .filter(|(_, name, _)| options.wants(name));
        let values = wanted.map(|(from, _, _)| from.value(payload).unwrap_or(f64::NAN));
        match self.series.get_mut(slot) {
            Some((_, series)) => series.push(t_s, values),
            None => false,
        }
    }

    /// Fills in the flight; gives what is known of the motor layout.
    fn finish(mut self, flight: &mut Flight) -> Declared {
        self.name_vehicle(flight);
        let declared = match self.autopilot {
            PX4 => Declared::of_px4(&self.parameters),
            _ => Declared::of_ardupilot(&self.parameters, &flight.vehicle),
        };
        let motors = match self.autopilot {
            PX4 => match px4_motors(&self.parameters) {
                none if none.is_empty() => {
                    let source = "MAV_TYPE, the first outputs";
                    let count = flight.vehicle.motors.unwrap_or(0);
                    ardupilot::numbered_motors(count, field, source)
                }
                named => named,
            },
            _ => ardupilot::motors(&self.parameters, &flight.vehicle, field),
        };
        let (of_bank, index) = bank(motors.first().map_or(1, |(_, output)| *output));
        let outputs: Vec<u16>;
        (flight.motors, outputs) = motors.into_iter().unzip();
        flight.range = match self.autopilot {
            PX4 => px4::output_range(&self.parameters, of_bank, index, 0.0, ""),
            _ => ardupilot::pwm_range(&self.parameters),
        };
        if self.autopilot != PX4 {
            flight.effective = ardupilot::effective_range(&self.parameters);
        }
        flight.commands = self.outputs.commands(&outputs);
        self.series.sort_by_key(|(index, _)| *index);
        flight.series = preferred(self.series.into_iter().map(|(_, series)| series).collect());
        flight.messages = self.texts;
        let kind = flight.vehicle.kind;
        let is_px4 = self.autopilot == PX4;
        let mode = |number: u32| match is_px4 {
            true => px4::custom_mode(number),
            false => Mode::Number(number.into()).name(kind),
        };
        flight.modes = self
            .modes
            .into_iter()
            .map(|(t_s, number)| Event::new(t_s, mode(number)))
            .collect();
        let Some(span_s) = flight.time_span_s() else {
            return declared;
        };
        if self.armed.is_empty() {
            return declared;
        }
        let rule = "HEARTBEAT.base_mode has its armed bit";
        flight.armed = Some(Intervals::from_states(&self.armed, span_s, rule));
        let (flying, rule) = match (self.flying.is_empty(), is_px4) {
            (false, _) => (&self.flying, "EXTENDED_SYS_STATE.landed_state, and armed"),
            (true, false) => (
                &self.active,
                "HEARTBEAT.system_status active or critical, and armed",
            ),
            // PX4 is active as soon as it is armed.
            (true, true) => return declared,
        };
        let in_air = both_hold(flying, &self.armed);
        flight.in_air = Some(Intervals::from_states(&in_air, span_s, rule));
        declared
    }

    /// The vehicle by its texts and parameters, and by the type in its heartbeats.
    fn name_vehicle(&self, flight: &mut Flight) {
        let texts = self.texts.iter().map(|text| text.what.as_str());
        flight.vehicle = ardupilot::vehicle(texts, &self.parameters);
        let vehicle = &mut flight.vehicle;
        if self.autopilot == PX4 {
            vehicle.firmware = self.version.map(px4::firmware);
        }
        let Some((number, told)) = self.mav_type() else {
            return;
        };
        // What sends the heartbeat of a quadplane may call itself a plane, not the reverse.
        if !(vehicle.kind == VehicleKind::Vtol && told.kind == VehicleKind::Plane) {
            vehicle.kind = told.kind;
            vehicle.source = format!("HEARTBEAT.type = {number}");
        }
        vehicle.frame.get_or_insert_with(|| told.name.into());
        vehicle.motors = vehicle.motors.or(told.motors);
    }
}

fn labels(spec: &Spec, options: &Options) -> Vec<Label> {
    spec.signals
        .iter()
        .filter(|(_, name, _)| options.wants(name))
        .map(|(_, name, unit)| Label {
            name: (*name).into(),
            unit: (*unit).into(),
            source: spec.message.into(),
        })
        .collect()
}
