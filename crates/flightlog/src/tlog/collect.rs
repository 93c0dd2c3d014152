//! Converts MAVLink packets to a `Flight`.

use super::time::VehicleTime;
use crate::ardupilot::{self, Mode};
use crate::clock::Latest;
use crate::geometry;
use crate::mavlink::decoder::{AUTOPILOT, Decoder, DecoderChange, Payload, ServoOutputs, filled};
use crate::mavlink::packet::Packet;
use crate::mavlink::servo::OUTPUTS_PER_PORT;
use crate::mavlink::signals::{MessageSpec, SPECS, spec_of};
use crate::outputs::Outputs;
use crate::signal::{Label, preferred};
use crate::{
    Event, Flight, Format, Intervals, Options, Report, Series, VehicleKind, identity, px4,
};

/// The longest pause of telemetry while the link is lost, in seconds; a time further ahead is damaged.
const LONGEST_PAUSE_S: f64 = 3600.0;

pub(super) struct Collector<'o> {
    options: &'o Options,
    pub(super) report: Report,
    /// The time of the first packet of the log, in microseconds since 1970.
    zero_us: Option<u64>,
    latest: Latest,
    /// The state of each system, in the order of their first packets.
    systems: Vec<(u8, SystemState)>,
}

/// The state of one system.
#[derive(Default)]
struct SystemState {
    decoder: Decoder,
    time: VehicleTime,
    /// The offset of the vehicle's clock from the time of reception, determined at the first motor commands.
    ahead_s: f64,
    outputs: Outputs,
    has_port_0: bool,
    series: Vec<(usize, Series)>,
    armed: Vec<(f64, bool)>,
    in_air: Vec<(f64, bool)>,
    modes: Vec<(f64, u32)>,
    texts: Vec<Event>,
}

impl<'o> Collector<'o> {
    pub(super) fn new(options: &'o Options) -> Self {
        Self {
            options,
            report: Report::default(),
            zero_us: None,
            latest: Latest::new(LONGEST_PAUSE_S),
            systems: Vec::new(),
        }
    }

    /// Processes a packet.
    pub(super) fn packet(&mut self, stamp_us: u64, packet: &Packet<'_>) {
        let is_full_of_boots = self.systems.iter().any(|(_, state)| state.time.is_full());
        if self.report.leaves_out(is_full_of_boots) {
            return;
        }
        let zero_us = *self.zero_us.get_or_insert(stamp_us);
        let t_s = (stamp_us as f64 - zero_us as f64) * 1e-6;
        if !self.latest.accept(t_s) {
            return self.report.bad("a timestamp that contradicts the others");
        }
        let known = (self.systems.iter()).position(|(system, _)| *system == packet.system);
        let index = known.unwrap_or_else(|| {
            self.systems.push((packet.system, SystemState::default()));
            self.systems.len() - 1
        });
        if let Some((_, state)) = self.systems.get_mut(index) {
            state.message(t_s, packet, self.options, &mut self.report);
        }
    }

    /// Returns the flight, after the whole log has been read.
    pub(super) fn finish(self) -> Flight {
        let mut flight = Flight::empty(Format::Tlog);
        flight.report = self.report;
        flight.utc_at_zero_s = self.zero_us.map(|zero_us| zero_us as f64 * 1e-6);
        // The vehicle is the first system that sent the heartbeat of a vehicle. If there is none, it is the first
        // system that sends as an autopilot.
        let is_vehicle = |(_, state): &(u8, SystemState)| state.decoder.mav_type().is_some();
        let mut systems = self.systems;
        let chosen = systems.iter().position(is_vehicle).unwrap_or(0);
        if chosen < systems.len() {
            let (system, state) = systems.swap_remove(chosen);
            let ahead_s = state.ahead_s;
            flight.utc_at_zero_s = flight.utc_at_zero_s.map(|utc_s| utc_s - ahead_s);
            state.finish(&mut flight, self.options);
            flight.vehicle.system_id = Some(system);
        }
        flight
    }
}

impl SystemState {
    /// Processes a message of the system.
    fn message(
        &mut self,
        received_s: f64,
        packet: &Packet<'_>,
        options: &Options,
        report: &mut Report,
    ) {
        let payload = filled(packet);
        let t_s = self.time.other(received_s, packet.id, &payload);
        match self.decoder.message(packet.component, packet.id, &payload) {
            DecoderChange::State => self.state(t_s, report),
            DecoderChange::Outputs(outputs) => self.commands(received_s, outputs, report),
            DecoderChange::Text(text) => report.text(&mut self.texts, Event::new(t_s, text)),
            DecoderChange::Nothing if packet.component == AUTOPILOT => {
                self.signals(t_s, packet.id, &payload, options, report);
            }
            DecoderChange::Nothing | DecoderChange::Parameter => {}
        }
    }

    fn commands(&mut self, received_s: f64, outputs: ServoOutputs, report: &mut Report) {
        let timed = self.time.commands(received_s, outputs);
        if let Some(ahead_s) = timed.ahead_s {
            self.shift(ahead_s);
        }
        let mut dropped = timed.dropped;
        for (t_s, outputs) in timed.rows.iter().flatten() {
            // A time that goes back counts as damage, except on the vehicle's clock: there the packet is late or repeated.
            dropped |= self.servos(*t_s, outputs) && !self.time.is_known();
        }
        report.row(outputs.pulses_us.len(), dropped);
    }

    /// Shifts the data from before the first motor commands to the vehicle's clock.
    fn shift(&mut self, ahead_s: f64) {
        self.ahead_s = ahead_s;
        self.outputs.shift(ahead_s);
        for (_, series) in &mut self.series {
            series.shift(ahead_s);
        }
        let times = (self.armed.iter_mut())
            .chain(&mut self.in_air)
            .map(|(t_s, _)| t_s)
            .chain(self.modes.iter_mut().map(|(t_s, _)| t_s));
        times.for_each(|t_s| *t_s += ahead_s);
        for text in &mut self.texts {
            text.t_us += (ahead_s * 1e6).round() as i64;
        }
    }

    fn state(&mut self, t_s: f64, report: &mut Report) {
        report.state(&mut self.armed, t_s, Some(self.decoder.is_armed()));
        report.state(&mut self.in_air, t_s, self.decoder.is_in_air());
        let last = self.modes.last().map(|(_, last)| *last);
        if let Some(mode) = self.decoder.mode().filter(|mode| last != Some(*mode)) {
            report.mode(&mut self.modes, (t_s, mode));
        }
    }

    /// Stores outputs 1 to 8 of a port, and 9 to 16 in version 2; the outputs of port 1 complete the row that port 0
    /// began.
    fn servos(&mut self, t_s: f64, outputs: &ServoOutputs) -> bool {
        let port = outputs.port;
        if port > 1 {
            return false;
        }
        self.has_port_0 |= port == 0;
        let first = port == 0 || !self.has_port_0;
        let before = u16::from(port) * OUTPUTS_PER_PORT as u16;
        // Outputs that are not driven are 0. In MAVLink 1, so are outputs above 8.
        let pulses = (1..).zip(outputs.pulses_us).filter(|&(_, us)| us > 0);
        let pulses = pulses.map(|(output, us)| (before + output, f64::from(us)));
        self.outputs.add(t_s, first, pulses)
    }

    fn signals(
        &mut self,
        t_s: f64,
        id: u32,
        payload: &Payload,
        options: &Options,
        report: &mut Report,
    ) {
        let Some(index) = spec_of(id, payload) else {
            return;
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
        if let Some((_, series)) = self.series.get_mut(slot) {
            let dropped = series.push(t_s, values) && !self.time.is_known();
            report.row(spec.signals.len(), dropped);
        }
    }

    fn finish(mut self, flight: &mut Flight, options: &Options) {
        self.decoder.finish();
        flight.report.left_out.parameters = self.decoder.parameters.left_out();
        flight.boots_s = self.time.boots_s().to_vec();
        self.name_vehicle(flight);
        let known = self.decoder.outputs(&flight.vehicle, options.range);
        let outputs: Vec<u16>;
        (flight.motors, outputs) = known.motors.into_iter().unzip();
        if !flight.motors.is_empty() {
            flight.range = Some(known.range);
            flight.assumed = known.assumed;
        }
        let restarts_s = self.outputs.restarts_s(&flight.boots_s);
        flight.commands = self.outputs.commands(&outputs);
        self.series.sort_by_key(|(index, _)| *index);
        flight.series = preferred(self.series.into_iter().map(|(_, series)| series).collect());
        flight.messages = self.texts;
        let kind = flight.vehicle.kind;
        let is_px4 = self.decoder.is_px4();
        let mode = |number: u32| match is_px4 {
            true => px4::custom_mode(number),
            false => Mode::Number(number.into()).name(kind),
        };
        flight.modes = self
            .modes
            .into_iter()
            .map(|(t_s, number)| Event::new(t_s, mode(number)))
            .collect();
        if let Some(span_s) = geometry::span_s(flight) {
            let intervals = |states: &[(f64, bool)], rule: &str| {
                (!states.is_empty()).then(|| Intervals::from_states(states, span_s, rule))
            };
            flight.armed = intervals(&self.armed, "HEARTBEAT.base_mode has its armed bit");
            let rule = "EXTENDED_SYS_STATE.landed_state, or HEARTBEAT.system_status, and armed";
            flight.in_air = intervals(&self.in_air, rule);
            if !self.decoder.has_landed_state() {
                flight.in_air = flight.in_air.take().map(Intervals::assumed);
            }
            if let Some(in_air) = &flight.in_air {
                flight.rebooted_in_air_s = in_air.within(&restarts_s);
            }
        }
        flight.parameters = self.decoder.parameters.of_motors("PARAM_VALUE");
        let parameters = &self.decoder.parameters;
        (flight.effective_range, flight.effective_range_doubt) =
            match is_px4 || known.is_effective_assumed {
                true => (known.effective, None),
                false => (
                    ardupilot::range_in_force(parameters, flight),
                    ardupilot::effective_doubt(parameters),
                ),
            };
        flight.geometry = geometry::find(flight, &known.declared);
    }

    /// Determines the vehicle from its texts and parameters, and from the type in its heartbeats.
    fn name_vehicle(&self, flight: &mut Flight) {
        let texts = self.texts.iter().map(|text| text.what.as_str());
        flight.vehicle = ardupilot::vehicle(texts, &self.decoder.parameters);
        let vehicle = &mut flight.vehicle;
        if self.decoder.is_px4() {
            vehicle.firmware = self.decoder.px4_firmware();
        }
        let reported = self.decoder.vehicle();
        if vehicle.id_source.as_deref() != Some(ardupilot::BOARD)
            && let Some((id, source)) = reported.id.zip(reported.id_source)
        {
            identity::name(vehicle, id, &source);
        }
        if self.decoder.mav_type().is_none() {
            return;
        }
        // A quadplane may send the heartbeat of a plane, but a plane does not send the heartbeat of a quadplane.
        if !(vehicle.kind == VehicleKind::Vtol && reported.kind == VehicleKind::Plane) {
            vehicle.kind = reported.kind;
            vehicle.source = reported.source;
        }
        vehicle.frame = vehicle.frame.take().or(reported.frame);
        vehicle.motors = vehicle.motors.or(reported.motors);
        if self.decoder.is_px4() {
            px4::count_rotors(vehicle, &self.decoder.parameters);
        }
    }
}

fn labels(spec: &MessageSpec, options: &Options) -> Vec<Label> {
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
