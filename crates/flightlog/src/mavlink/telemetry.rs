//! The motor commands and the state of one vehicle from its packets.

use super::{
    Packet, Setup, Version,
    decoder::{AUTOPILOT, Decoder, DecoderChange, Payload, ServoOutputs, filled, number},
    servo::OUTPUTS_PER_PORT,
    setup::missing,
    signals::{MessageSpec, SPECS, spec_of},
};
use crate::{
    Parameter, PulseRange, Vehicle,
    clock::{Clock, TimestampDecision, seconds_of},
    field::NumberType,
};

const SYS_STATUS: u32 = 1;
const GPS_RAW_INT: u32 = 24;
const ATTITUDE: u32 = 30;
const GLOBAL_POSITION_INT: u32 = 33;
const RC_CHANNELS: u32 = 65;
const VFR_HUD: u32 = 74;
const COMMAND_ACK: u32 = 77;
/// MAV_CMD_SET_MESSAGE_INTERVAL.
const SET_MESSAGE_INTERVAL: f64 = 511.0;
/// MAV_RESULT of an accepted command.
const ACCEPTED: f64 = 0.0;

const BATTERY_STATUS: u32 = 147;
const VIBRATION: u32 = 241;

/// The messages for which a rate is requested: first motor commands, attitude and the landed state, then the messages
/// that contain other signals, which are requested only if one of these signals is wanted. Messages that only one kind
/// of autopilot has (wind, wanted angles, radio) are read but not requested, because a refusal does not name the
/// message that it refuses.
pub(super) const RATED: [u32; 10] = [
    36,
    ATTITUDE,
    245,
    SYS_STATUS,
    BATTERY_STATUS,
    GLOBAL_POSITION_INT,
    VFR_HUD,
    VIBRATION,
    GPS_RAW_INT,
    RC_CHANNELS,
];
/// The number of messages at the start of [`RATED`] that are always requested.
const ALWAYS: usize = 3;

/// The number of ports of SERVO_OUTPUT_RAW. The second port has the outputs 17 to 32 of ArduPilot, or the AUX outputs
/// of PX4.
const PORTS: usize = 2;
/// The pulse widths of all outputs at a time, in us.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Pulses(pub(super) [[u16; OUTPUTS_PER_PORT]; PORTS]);

/// The latest pulses of each port, and whether they arrived since the last commands were reported.
type Outputs = [([u16; OUTPUTS_PER_PORT], bool); PORTS];
const NO_OUTPUTS: Outputs = [([u16::MAX; OUTPUTS_PER_PORT], false); PORTS];

/// The maximum age in seconds of a landed state that still counts as a report that the vehicle is in the air.
const LANDED_FRESH_S: f64 = 1.5;

/// A clock that jumps is accepted only after the old clock has been silent for this time, in seconds.
const CLOCK_SILENT_S: f64 = 2.0;

/// A clock of a live vehicle, and the time at which its latest accepted timestamp arrived.
#[derive(Debug, Default)]
struct LiveClock {
    clock: Clock,
    received_s: Option<f64>,
    /// The latest timestamp as received, to detect repeated packets, because a repeated packet does not confirm a
    /// timestamp.
    stamp: Option<u32>,
}

/// The change that a packet caused.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum TelemetryChange {
    /// No relevant change.
    Nothing,
    /// A parameter is now known.
    Parameter,
    /// New motor commands arrived.
    Commands {
        /// The time of the commands, in seconds since the vehicle booted.
        t_s: f64,
    },
    /// The vehicle rebooted: its state, including this packet, is discarded.
    Rebooted,
}

/// Tracks the state of one vehicle from its packets.
///
/// # Example: from a heartbeat to motor commands
/// ```
/// use flagred_flightlog::mavlink::{
///     PacketScan, Sender, Telemetry, TelemetryChange, Version, dialect::*, next_packet, vehicle_of,
/// };
///
/// // The autopilot of an armed quadrotor, in place of a link.
/// let mut autopilot = Sender::new(1);
/// let mut send = |message: MavMessage| autopilot.packet(Version::V2, 1, &message);
/// let heartbeat = send(MavMessage::HEARTBEAT(HEARTBEAT_DATA {
///     mavtype: MavType::MAV_TYPE_QUADROTOR,
///     autopilot: MavAutopilot::MAV_AUTOPILOT_ARDUPILOTMEGA,
///     base_mode: MavModeFlag::MAV_MODE_FLAG_SAFETY_ARMED,
///     system_status: MavState::MAV_STATE_ACTIVE,
///     ..HEARTBEAT_DATA::default()
/// }));
///
/// let PacketScan::Packet(packet) = next_packet(&heartbeat) else { panic!("no packet") };
/// let vehicle = vehicle_of(&packet).unwrap();
/// let mut telemetry = Telemetry::new(&packet, vehicle);
/// assert!(telemetry.is_armed() && telemetry.is_in_air());
///
/// let mut change = TelemetryChange::Nothing;
/// for i in 1..=10 {
///     let outputs = send(MavMessage::SERVO_OUTPUT_RAW(SERVO_OUTPUT_RAW_DATA {
///         time_usec: 40_000 * i,
///         servo1_raw: 1550, servo2_raw: 1550, servo3_raw: 1550, servo4_raw: 1950,
///         ..SERVO_OUTPUT_RAW_DATA::default()
///     }));
///     let PacketScan::Packet(packet) = next_packet(&outputs) else { panic!("no packet") };
///     change = telemetry.receive(&packet, 0.04 * f64::from(i));
/// }
/// assert!(matches!(change, TelemetryChange::Commands { t_s } if (t_s - 0.4).abs() < 1e-9));
///
/// // No parameter arrived, so limits are assumed, and `assumed` mentions them.
/// let setup = telemetry.setup();
/// assert!(setup.assumed.contains(&"commands from 1000 to 2000 us".to_string()));
/// let mut commands = [0.0; 4];
/// telemetry.effective_commands(&setup, &mut commands);
/// assert_eq!(commands[3], 1.0); // motor 4 is at its limit
/// ```
#[derive(Debug)]
pub struct Telemetry {
    system: u8,
    vehicle: Vehicle,
    version: Version,
    decoder: Decoder,
    parameters_changed: bool,
    clock: LiveClock,
    boot_clock: LiveClock,
    clock_jumps: u64,
    /// The time at which a landed state last arrived.
    landed_state_s: Option<f64>,
    outputs: Outputs,
    /// The port whose message completes the commands of all motors.
    last_port: usize,
    seen: [u64; RATED.len()],
    has_commands: bool,
    interval_refused: bool,
    rate_asker: Option<(u8, u8)>,
    /// The range of motor outputs to use if the vehicle does not report it.
    given: Option<PulseRange>,
    signals: Vec<LatestSignal>,
}

/// The latest value of a signal that is wanted.
#[derive(Debug)]
struct LatestSignal {
    name: String,
    /// The index in [`SPECS`] of the message that contained the value; a message with a larger index does not replace
    /// the value.
    spec: usize,
    /// The value; NaN if unknown.
    value: f64,
}

impl LatestSignal {
    fn new(name: &str) -> LatestSignal {
        LatestSignal {
            name: name.to_owned(),
            spec: SPECS.len(),
            value: f64::NAN,
        }
    }

    fn is_in(&self, spec: &MessageSpec) -> bool {
        spec.signals.iter().any(|(_, name, _)| *name == self.name)
    }
}

impl Telemetry {
    /// Starts from the heartbeat by which [`vehicle_of`](super::vehicle_of) identified the vehicle.
    pub fn new(heartbeat: &Packet<'_>, vehicle: Vehicle) -> Telemetry {
        let mut decoder = Decoder::live();
        decoder.message(heartbeat.component, heartbeat.id, &filled(heartbeat));
        Telemetry {
            system: heartbeat.system,
            vehicle,
            version: heartbeat.version,
            decoder,
            parameters_changed: false,
            clock: LiveClock::default(),
            boot_clock: LiveClock::default(),
            clock_jumps: 0,
            landed_state_s: None,
            outputs: NO_OUTPUTS,
            last_port: 0,
            seen: [0; RATED.len()],
            has_commands: false,
            interval_refused: false,
            rate_asker: None,
            given: None,
            signals: Vec::new(),
        }
    }

    /// Keeps the latest values of these signals, for [`Telemetry::signals`]. Names are those of
    /// [`known_signals`](crate::known_signals).
    #[must_use]
    pub fn with_signals(self, names: &[&str]) -> Telemetry {
        let signals = names.iter().map(|name| LatestSignal::new(name)).collect();
        Telemetry { signals, ..self }
    }

    /// Uses the given range of motor outputs instead of an assumed one until the vehicle reports its own.
    #[must_use]
    pub fn with_range(self, given: Option<PulseRange>) -> Telemetry {
        Telemetry { given, ..self }
    }

    /// Whether the vehicle reports its own range although a range was given.
    pub fn ignores_range(&self, setup: &Setup) -> bool {
        self.given.is_some_and(|given| given.range() != setup.range)
    }

    /// The system id of the vehicle.
    pub fn system(&self) -> u8 {
        self.system
    }

    /// The vehicle, as described by the heartbeat.
    pub fn vehicle(&self) -> &Vehicle {
        &self.vehicle
    }

    /// The protocol version of the latest heartbeat.
    pub fn version(&self) -> Version {
        self.version
    }

    /// Whether the motors are armed.
    pub fn is_armed(&self) -> bool {
        self.decoder.is_armed()
    }

    /// Whether the vehicle is in the air, according to EXTENDED_SYS_STATE. Without that message, the state in the
    /// heartbeats of ArduPilot is used (active in the air, standby while landed). A vehicle that reports neither
    /// counts as in the air while it is armed.
    pub fn is_in_air(&self) -> bool {
        self.decoder.is_in_air_or_armed()
    }

    /// Whether the vehicle reports that it is in the air, at `now_s` of the receiver's clock. `None` if it is armed
    /// but does not report a landed state (EXTENDED_SYS_STATE), if that state is older than 1.5 s, or if the motors
    /// were stopped on purpose.
    pub fn reported_in_air(&self, now_s: f64) -> Option<bool> {
        let is_fresh = |received_s: f64| now_s - received_s <= LANDED_FRESH_S;
        match self.is_in_air() {
            false => Some(false),
            true => (self.decoder.reports_flight() && self.landed_state_s.is_some_and(is_fresh))
                .then_some(true),
        }
    }

    /// Whether the vehicle has ever sent motor outputs (SERVO_OUTPUT_RAW).
    pub fn has_commands(&self) -> bool {
        self.has_commands
    }

    /// The number of messages of each kind in [`RATED`] that arrived so far.
    pub(super) fn seen(&self) -> [u64; RATED.len()] {
        self.seen
    }

    /// The system and component id of the latest other station whose MAV_CMD_SET_MESSAGE_INTERVAL the vehicle accepted.
    pub fn rate_asker(&self) -> Option<(u8, u8)> {
        self.rate_asker
    }

    /// Whether a message of [`RATED`] is needed.
    pub(super) fn wants(&self, rated: usize) -> bool {
        let id = RATED.get(rated);
        let specs = || SPECS.iter().filter(|spec| Some(&spec.id) == id);
        let is_wanted = |signal: &LatestSignal| specs().any(|spec| signal.is_in(spec));
        rated < ALWAYS || self.signals.iter().any(is_wanted)
    }

    /// Whether the vehicle refused MAV_CMD_SET_MESSAGE_INTERVAL.
    pub(super) fn interval_refused(&self) -> bool {
        self.interval_refused
    }

    /// The value of a parameter; `None` while it is unknown. A value that is set in the air applies after the landing.
    pub fn parameter(&self, name: &str) -> Option<f64> {
        self.decoder.parameters.get(name)
    }

    /// Whether parameters arrived since the last call, so that [`Telemetry::setup`] may have changed.
    pub fn take_parameters_changed(&mut self) -> bool {
        std::mem::take(&mut self.parameters_changed)
    }

    /// The number of packets that were ignored because their timestamps jumped while the previous clock continued.
    pub fn clock_jumps(&self) -> u64 {
        self.clock_jumps
    }

    /// Processes a packet that arrived at `now_s` of the receiver's clock; packets of other systems are ignored.
    ///
    /// A clock that jumps back or ahead is accepted once no packet has continued the old time for 2 s. A vehicle that
    /// reboots is silent for that long; a vehicle whose packets somebody else forges is not.
    pub fn receive(&mut self, packet: &Packet<'_>, now_s: f64) -> TelemetryChange {
        if packet.system != self.system {
            return TelemetryChange::Nothing;
        }
        // The checksum of an unknown message cannot be verified, so its content is not used.
        if packet.sound.is_none() {
            return TelemetryChange::Nothing;
        }
        let payload = filled(packet);
        if packet.component == AUTOPILOT {
            self.count(packet.id, &payload, now_s);
        }
        let change = self.decoder.message(packet.component, packet.id, &payload);
        if change == DecoderChange::Parameter || self.decoder.take_changed() {
            self.parameters_changed = true;
            self.last_port = self.setup().last_port().min(PORTS - 1);
        }
        match change {
            DecoderChange::Parameter => return TelemetryChange::Parameter,
            DecoderChange::Outputs(outputs) => return self.command(&outputs, now_s),
            DecoderChange::State if packet.id == 0 => self.version = packet.version,
            DecoderChange::Nothing if packet.component == AUTOPILOT => {
                self.keep_signals(packet.id, &payload);
                return self.other(packet.id, &payload, now_s);
            }
            DecoderChange::State | DecoderChange::Text(_) | DecoderChange::Nothing => {}
        }
        TelemetryChange::Nothing
    }

    fn count(&mut self, id: u32, payload: &Payload, now_s: f64) {
        if id == RATED[2] {
            self.landed_state_s = Some(now_s);
        }
        self.has_commands |= id == RATED[0];
        // The messages of the two ports of one row of commands are counted as one.
        let is_other_port = id == RATED[0] && usize::from(payload[20]) != self.last_port;
        let index = RATED.iter().position(|&rated| rated == id);
        if let Some(index) = index.filter(|_| !is_other_port) {
            self.seen[index] += 1;
        }
    }

    fn keep_signals(&mut self, id: u32, payload: &Payload) {
        if self.signals.is_empty() {
            return;
        }
        let Some((index, spec)) = spec_of(id, payload).and_then(|i| Some((i, SPECS.get(i)?)))
        else {
            return;
        };
        for (from, name, _) in spec.signals {
            let mut of_name = self.signals.iter_mut().filter(|kept| kept.name == *name);
            if let Some(kept) = of_name.next()
                && index <= kept.spec
            {
                kept.spec = index;
                kept.value = from.value(payload).unwrap_or(f64::NAN);
            }
        }
    }

    fn other(&mut self, id: u32, payload: &Payload, now_s: f64) -> TelemetryChange {
        let number = |offset, kind| number(payload, offset, kind);
        match id {
            ATTITUDE => {
                let boot_ms = number(0, NumberType::U32).unwrap_or_default();
                return self.check_boot(boot_ms as u32, now_s);
            }
            COMMAND_ACK if number(0, NumberType::U16) == Some(SET_MESSAGE_INTERVAL) => {
                let is_accepted = number(2, NumberType::U8) == Some(ACCEPTED);
                // The addressee; 0 in version 1, and from vehicles that do not set it.
                let (system, component) = (payload[8], payload[9]);
                if system == 0 || system == self.system {
                    self.interval_refused |= !is_accepted;
                } else if is_accepted {
                    self.rate_asker = Some((system, component));
                }
            }
            _ => {}
        }
        TelemetryChange::Nothing
    }

    /// Detects a reboot by the clock of attitude messages. This clock wraps around only after 49 days, but the clock
    /// of the commands after 71 minutes.
    fn check_boot(&mut self, boot_ms: u32, now_s: f64) -> TelemetryChange {
        let clock = &mut self.boot_clock;
        if clock.stamp.replace(boot_ms) == Some(boot_ms) {
            return TelemetryChange::Nothing;
        }
        clock.check(f64::from(boot_ms) * 1e-3, now_s, &mut self.clock_jumps);
        match clock.clock.boots_s() {
            [] => TelemetryChange::Nothing,
            _ => self.forget(),
        }
    }

    fn command(&mut self, outputs: &ServoOutputs, now_s: f64) -> TelemetryChange {
        let port = usize::from(outputs.port);
        if port >= PORTS {
            return TelemetryChange::Nothing;
        }
        if port != self.last_port {
            // The message of the last port, which completes the row, follows with the same time.
            self.outputs[port] = (outputs.pulses_us, true);
            return TelemetryChange::Nothing;
        }
        let clock = &mut self.clock;
        if clock.stamp.replace(outputs.time_us) == Some(outputs.time_us) {
            return TelemetryChange::Nothing;
        }
        let t_s = seconds_of(outputs.time_us, clock.clock.now_s());
        let Some(t_s) = clock.check(t_s, now_s, &mut self.clock_jumps) else {
            return TelemetryChange::Nothing;
        };
        if !clock.clock.boots_s().is_empty() {
            return self.forget();
        }
        self.outputs[port] = (outputs.pulses_us, true);
        for (pulses, is_new) in &mut self.outputs {
            // Pulses that did not arrive again since the previous row are unknown.
            if !std::mem::take(is_new) {
                *pulses = [u16::MAX; OUTPUTS_PER_PORT];
            }
        }
        TelemetryChange::Commands { t_s }
    }

    fn forget(&mut self) -> TelemetryChange {
        self.decoder.boot();
        self.clock = LiveClock::default();
        self.boot_clock = LiveClock::default();
        self.landed_state_s = None;
        self.outputs = NO_OUTPUTS;
        self.interval_refused = false;
        self.rate_asker = None;
        self.last_port = 0;
        for signal in &mut self.signals {
            *signal = LatestSignal::new(&signal.name);
        }
        TelemetryChange::Rebooted
    }

    /// Determines motors and ranges from the known parameters. Missing ones are assumed, and reported as such.
    pub fn setup(&self) -> Setup {
        Setup::of(
            &self.decoder.parameters,
            &self.vehicle,
            self.decoder.is_px4(),
            self.given,
        )
    }

    /// The known parameters that determine motors and ranges, and the gains.
    pub fn parameters(&self) -> Vec<Parameter> {
        self.decoder.parameters.of_motors("PARAM_VALUE")
    }

    /// The parameters that determine the motors and their range and that are not known yet, except parameters that
    /// the vehicle reported as missing.
    pub(super) fn missing_parameters(&self) -> Vec<String> {
        let mut names = missing(
            &self.decoder.parameters,
            &self.vehicle,
            self.decoder.is_px4(),
        );
        names.retain(|name| !self.decoder.is_absent(name));
        names
    }

    /// The latest pulses of all outputs, for [`Setup::effective_commands`].
    pub fn pulses(&self) -> Pulses {
        let [(first, _), (second, _)] = self.outputs;
        Pulses([first, second])
    }

    /// The latest values of the signals that [`Telemetry::with_signals`] named, in its order; NaN is unknown.
    pub fn signals(&self) -> impl Iterator<Item = f64> {
        self.signals.iter().map(|signal| signal.value)
    }

    /// The latest commands on the effective range, 0..1, one value for each motor; NaN is unknown.
    pub fn effective_commands(&self, setup: &Setup, commands: &mut [f64]) {
        setup.effective_commands(&self.pulses(), commands);
    }
}

impl LiveClock {
    /// The time at which a message with the timestamp `t_s` is accepted; `None` if it is not accepted.
    fn check(&mut self, t_s: f64, now_s: f64, jumps: &mut u64) -> Option<f64> {
        let is_alive = |received_s: f64| now_s - received_s < CLOCK_SILENT_S;
        if !self.clock.is_next(t_s) && self.received_s.is_some_and(is_alive) {
            *jumps += 1;
            return None;
        }
        let t_s = match self.clock.check(t_s) {
            TimestampDecision::At(t_s)
            | TimestampDecision::Refuted(t_s)
            | TimestampDecision::Confirmed(_, t_s) => t_s,
            TimestampDecision::Wait | TimestampDecision::RefutedWait => return None,
        };
        self.received_s = Some(now_s);
        Some(t_s)
    }
}
