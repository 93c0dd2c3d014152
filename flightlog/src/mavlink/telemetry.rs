//! What the packets of one vehicle tell about its motors.

use super::{
    Packet, Setup, Version,
    dialect::{
        COMMAND_ACK_DATA, EXTENDED_SYS_STATE_DATA, HEARTBEAT_DATA, MavCmd, MavLandedState,
        MavMessage, MavModeFlag, MavParamType, MavResult, MavState, PARAM_VALUE_DATA,
        SERVO_OUTPUT_RAW_DATA,
    },
};
use super::{
    heartbeat::{AUTOPILOT, is_in_air},
    servo::OUTPUTS_A_PORT,
    setup::missing,
};
use crate::{
    Vehicle, VehicleKind,
    clock::{Clock, Placed},
    parameters::Parameters,
};

/// Ports of SERVO_OUTPUT_RAW: the second has ArduPilot's outputs from 17 on, and PX4's AUX outputs.
const PORTS: usize = 2;
/// What an output that is not driven, or not known, reads.
const NO_PULSE: [u16; 2] = [0, u16::MAX];
/// No output and no limit of one is longer, in us; what is longer is damaged.
const LONGEST_PULSE_US: f64 = 3000.0;

/// The latest pulses of each port, and whether they came since commands were last told.
type Outputs = [([u16; OUTPUTS_A_PORT], bool); PORTS];
const NO_OUTPUTS: Outputs = [([u16::MAX; OUTPUTS_A_PORT], false); PORTS];

/// What a packet changed.
///
/// # Example: a vehicle that starts anew in the middle of a flight
/// ```
/// # mod vehicle { include!(concat!(env!("CARGO_MANIFEST_DIR"), "/doc/vehicle.rs")); }
/// # use flightlog::mavlink::{Version, dialect::*};
/// # use vehicle::packet;
/// # let (mut autopilot, _, _, mut telemetry) = vehicle::followed();
/// use flightlog::mavlink::News;
///
/// let mut told = Vec::new();
/// let mut commands = [0.0; 4];
/// for t_ms in (100_000..101_000).chain(1_000..2_000).step_by(40) {
///     let servo = SERVO_OUTPUT_RAW_DATA { time_usec: 1000 * t_ms, servo1_raw: 1500, ..Default::default() };
///     let bytes = autopilot.packet(Version::V2, 1, &MavMessage::SERVO_OUTPUT_RAW(servo));
///     told.push(telemetry.receive(&packet(&bytes)));
///     telemetry.effective_commands(&telemetry.setup(), &mut commands);
///     if told.last() == Some(&News::Rebooted) {
///         assert!(commands[0].is_nan(), "what was before is forgotten");
///     }
/// }
/// assert!(matches!(told[20], News::Commands { t_s } if t_s > 100.0));
/// assert_eq!(told.iter().filter(|news| **news == News::Rebooted).count(), 1);
/// assert!(commands[0] > 0.0);
/// # Ok::<(), &str>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum News {
    /// Nothing that matters here.
    Nothing,
    /// A parameter became known.
    Parameter,
    /// New motor commands, at this time in seconds since the vehicle booted.
    Commands {
        /// The time.
        t_s: f64,
    },
    /// The vehicle started anew: all that was known of it is forgotten, and this packet with it.
    Rebooted,
    /// The message could not be understood: a field holds a value that the dialect does not know.
    NotUnderstood,
}

/// Follows one vehicle by its packets.
///
/// # Example: from a heartbeat to motor commands
/// ```
/// # mod vehicle { include!(concat!(env!("CARGO_MANIFEST_DIR"), "/doc/vehicle.rs")); }
/// # use flightlog::mavlink::{News, Telemetry, Version, dialect::*, is_in_air, vehicle_of};
/// # use vehicle::packet;
/// # let (mut autopilot, heartbeat) = vehicle::autopilot();
/// # let heartbeat = autopilot.packet(Version::V2, 1, &heartbeat);
/// let vehicle = vehicle_of(&packet(&heartbeat)).ok_or("no vehicle")?;
/// let mut telemetry = Telemetry::new(&packet(&heartbeat), vehicle);
/// assert_eq!((telemetry.system(), telemetry.version()), (1, Version::V2));
/// assert!(telemetry.may_be_multirotor() && telemetry.vehicle().motors == Some(4));
/// assert_eq!(telemetry.receive(&packet(&heartbeat)), News::Nothing);
/// assert!(telemetry.is_armed() && telemetry.is_in_air());
///
/// let mut news = News::Nothing;
/// for i in 1..=10 {
///     let outputs = MavMessage::SERVO_OUTPUT_RAW(SERVO_OUTPUT_RAW_DATA {
///         time_usec: 40_000 * i,
///         servo1_raw: 1550, servo2_raw: 1550, servo3_raw: 1550, servo4_raw: 1950,
///         ..SERVO_OUTPUT_RAW_DATA::default()
///     });
///     let bytes = autopilot.packet(Version::V2, 1, &outputs);
///     news = telemetry.receive(&packet(&bytes));
/// }
/// assert!(matches!(news, News::Commands { t_s } if (t_s - 0.4).abs() < 1e-9));
///
/// // A parameter, as it comes when asked for.
/// let bytes = autopilot.packet(Version::V2, 1, &MavMessage::PARAM_VALUE(PARAM_VALUE_DATA {
///     param_id: "MOT_SPIN_MIN".into(),
///     param_value: 0.125,
///     param_type: MavParamType::MAV_PARAM_TYPE_REAL32,
///     ..PARAM_VALUE_DATA::default()
/// }));
/// assert_eq!(telemetry.receive(&packet(&bytes)), News::Parameter);
/// assert_eq!(telemetry.parameter("MOT_SPIN_MIN"), Some(0.125));
/// assert!(telemetry.take_parameters_changed());
///
/// // The others never came, so what is assumed is said.
/// let setup = telemetry.setup();
/// assert!(setup.assumed.contains(&"commands from 1000 to 2000 us".to_string()));
/// let mut commands = [0.0; 4];
/// telemetry.effective_commands(&setup, &mut commands);
/// assert_eq!(commands[3], 1.0); // motor 4 is at its limit
/// # Ok::<(), &str>(())
/// ```
#[derive(Debug)]
pub struct Telemetry {
    system: u8,
    vehicle: Vehicle,
    version: Version,
    parameters: Parameters,
    parameters_changed: bool,
    is_px4: bool,
    is_armed: bool,
    state: Option<MavState>,
    landed: Option<MavLandedState>,
    clock: Clock,
    boot_clock: Clock,
    /// The latest time stamps of either clock as they came: a packet that comes twice is no witness of itself.
    stamps: [Option<u32>; 2],
    outputs: Outputs,
    /// The port that completes the commands of all motors.
    last_port: usize,
    commands_seen: u64,
    interval_refused: bool,
}

impl Telemetry {
    /// Starts with the heartbeat that [`vehicle_of`](super::vehicle_of) told the vehicle from.
    ///
    /// # Example: nothing is known yet but what the heartbeat says of the vehicle
    /// ```
    /// # mod vehicle { include!(concat!(env!("CARGO_MANIFEST_DIR"), "/doc/vehicle.rs")); }
    /// # let (_, _, _, telemetry) = vehicle::followed();
    /// assert_eq!(telemetry.vehicle().motors, Some(4));
    /// assert!(!telemetry.is_armed(), "that is told by the heartbeats it receives");
    /// # Ok::<(), &str>(())
    /// ```
    pub fn new(heartbeat: &Packet<'_>, vehicle: Vehicle) -> Telemetry {
        Telemetry {
            system: heartbeat.system,
            is_px4: vehicle.firmware.as_deref() == Some("PX4"),
            vehicle,
            version: heartbeat.version,
            parameters: Parameters::default(),
            parameters_changed: false,
            is_armed: false,
            state: None,
            landed: None,
            clock: Clock::default(),
            boot_clock: Clock::default(),
            stamps: [None; 2],
            outputs: NO_OUTPUTS,
            last_port: 0,
            commands_seen: 0,
            interval_refused: false,
        }
    }

    /// The system it follows.
    ///
    /// # Example
    /// ```
    /// # mod vehicle { include!(concat!(env!("CARGO_MANIFEST_DIR"), "/doc/vehicle.rs")); }
    /// # let (_, _, _, telemetry) = vehicle::followed();
    /// assert_eq!(telemetry.system(), 1);
    /// # Ok::<(), &str>(())
    /// ```
    pub fn system(&self) -> u8 {
        self.system
    }

    /// The vehicle as its heartbeat describes it.
    ///
    /// # Example
    /// ```
    /// # mod vehicle { include!(concat!(env!("CARGO_MANIFEST_DIR"), "/doc/vehicle.rs")); }
    /// # let (_, _, _, telemetry) = vehicle::followed();
    /// assert_eq!(telemetry.vehicle().kind, flightlog::VehicleKind::Multirotor);
    /// # Ok::<(), &str>(())
    /// ```
    pub fn vehicle(&self) -> &Vehicle {
        &self.vehicle
    }

    /// The version of the protocol that it speaks.
    ///
    /// # Example: a vehicle that falls back to MAVLink 1
    /// ```
    /// # mod vehicle { include!(concat!(env!("CARGO_MANIFEST_DIR"), "/doc/vehicle.rs")); }
    /// # use flightlog::mavlink::Version;
    /// # use vehicle::packet;
    /// # let (mut autopilot, heartbeat, _, mut telemetry) = vehicle::followed();
    /// assert_eq!(telemetry.version(), Version::V2);
    /// let old = autopilot.packet(Version::V1, 1, &heartbeat);
    /// telemetry.receive(&packet(&old));
    /// assert_eq!(telemetry.version(), Version::V1);
    /// # Ok::<(), &str>(())
    /// ```
    pub fn version(&self) -> Version {
        self.version
    }

    /// Whether the motors are armed.
    ///
    /// # Example
    /// ```
    /// # mod vehicle { include!(concat!(env!("CARGO_MANIFEST_DIR"), "/doc/vehicle.rs")); }
    /// # use vehicle::packet;
    /// # let (_, heartbeat, heard, mut telemetry) = vehicle::followed();
    /// telemetry.receive(&packet(&heard)); // a heartbeat with the flag MAV_MODE_FLAG_SAFETY_ARMED
    /// assert!(telemetry.is_armed());
    /// # Ok::<(), &str>(())
    /// ```
    pub fn is_armed(&self) -> bool {
        self.is_armed
    }

    /// Whether it is in the air.
    ///
    /// # Example: the landed state knows better than the heartbeat
    /// ```
    /// # mod vehicle { include!(concat!(env!("CARGO_MANIFEST_DIR"), "/doc/vehicle.rs")); }
    /// # use flightlog::mavlink::{Version, dialect::*};
    /// # use vehicle::packet;
    /// # let (mut autopilot, _, heard, mut telemetry) = vehicle::followed();
    /// telemetry.receive(&packet(&heard)); // armed and active
    /// assert!(telemetry.is_in_air());
    /// let landed_state = MavLandedState::MAV_LANDED_STATE_ON_GROUND;
    /// let state = MavMessage::EXTENDED_SYS_STATE(EXTENDED_SYS_STATE_DATA { landed_state, ..Default::default() });
    /// telemetry.receive(&packet(&autopilot.packet(Version::V2, 1, &state)));
    /// assert!(telemetry.is_armed() && !telemetry.is_in_air());
    /// # Ok::<(), &str>(())
    /// ```
    pub fn is_in_air(&self) -> bool {
        is_in_air(self.is_armed, self.state, self.landed)
    }

    /// How many SERVO_OUTPUT_RAW came so far.
    pub(super) fn commands_seen(&self) -> u64 {
        self.commands_seen
    }

    /// Whether it refused MAV_CMD_SET_MESSAGE_INTERVAL.
    pub(super) fn interval_refused(&self) -> bool {
        self.interval_refused
    }

    /// The value of a parameter, where it is known.
    ///
    /// # Example: the first value counts
    /// ```
    /// # mod vehicle { include!(concat!(env!("CARGO_MANIFEST_DIR"), "/doc/vehicle.rs")); }
    /// # use flightlog::mavlink::{Version, dialect::*};
    /// # use vehicle::packet;
    /// # let (mut autopilot, _, _, mut telemetry) = vehicle::followed();
    /// for value in [0.125, 0.5] {
    ///     let told = MavMessage::PARAM_VALUE(PARAM_VALUE_DATA {
    ///         param_id: "MOT_SPIN_MIN".into(),
    ///         param_value: value,
    ///         param_type: MavParamType::MAV_PARAM_TYPE_REAL32,
    ///         ..PARAM_VALUE_DATA::default()
    ///     });
    ///     telemetry.receive(&packet(&autopilot.packet(Version::V2, 1, &told)));
    /// }
    /// assert_eq!((telemetry.parameter("MOT_SPIN_MIN"), telemetry.parameter("MOT_SPIN_MAX")), (Some(0.125), None));
    /// # Ok::<(), &str>(())
    /// ```
    pub fn parameter(&self, name: &str) -> Option<f64> {
        self.parameters.get(name)
    }

    /// Whether parameters came since this was last asked.
    ///
    /// # Example: when to ask for the set-up anew
    /// ```
    /// # mod vehicle { include!(concat!(env!("CARGO_MANIFEST_DIR"), "/doc/vehicle.rs")); }
    /// # use flightlog::mavlink::{Version, dialect::*};
    /// # use vehicle::packet;
    /// # let (mut autopilot, _, _, mut telemetry) = vehicle::followed();
    /// # let told = MavMessage::PARAM_VALUE(PARAM_VALUE_DATA {
    /// #     param_id: "MOT_SPIN_MIN".into(),
    /// #     param_value: 0.125,
    /// #     param_type: MavParamType::MAV_PARAM_TYPE_REAL32,
    /// #     ..PARAM_VALUE_DATA::default()
    /// # });
    /// assert!(!telemetry.take_parameters_changed());
    /// telemetry.receive(&packet(&autopilot.packet(Version::V2, 1, &told))); // MOT_SPIN_MIN = 0.125
    /// assert!(telemetry.take_parameters_changed() && !telemetry.take_parameters_changed());
    /// # Ok::<(), &str>(())
    /// ```
    pub fn take_parameters_changed(&mut self) -> bool {
        std::mem::take(&mut self.parameters_changed)
    }

    /// Takes in a packet; those of other systems tell nothing.
    ///
    /// # Example: another vehicle on the same link
    /// ```
    /// # mod vehicle { include!(concat!(env!("CARGO_MANIFEST_DIR"), "/doc/vehicle.rs")); }
    /// # use flightlog::mavlink::{Sender, Version, dialect::*};
    /// # use vehicle::packet;
    /// # let (_, _, _, mut telemetry) = vehicle::followed();
    /// use flightlog::mavlink::News;
    ///
    /// let servo = MavMessage::SERVO_OUTPUT_RAW(SERVO_OUTPUT_RAW_DATA { time_usec: 40_000, ..Default::default() });
    /// let foreign = Sender::new(2).packet(Version::V2, 1, &servo);
    /// assert_eq!(telemetry.receive(&packet(&foreign)), News::Nothing);
    /// # Ok::<(), &str>(())
    /// ```
    pub fn receive(&mut self, packet: &Packet<'_>) -> News {
        if packet.system != self.system {
            return News::Nothing;
        }
        let Some(message) = packet.message() else {
            return News::NotUnderstood;
        };
        match message {
            // A parameter may come through another component of the vehicle.
            MavMessage::PARAM_VALUE(parameter) => return self.learn(&parameter),
            _ if packet.component != AUTOPILOT => return News::Nothing,
            MavMessage::HEARTBEAT(heartbeat) => self.beat(packet, &heartbeat),
            MavMessage::EXTENDED_SYS_STATE(EXTENDED_SYS_STATE_DATA { landed_state, .. }) => {
                self.landed = Some(landed_state);
            }
            MavMessage::ATTITUDE(attitude) => return self.check_boot(attitude.time_boot_ms),
            MavMessage::SERVO_OUTPUT_RAW(servo) => return self.command(&servo),
            MavMessage::COMMAND_ACK(COMMAND_ACK_DATA {
                command: MavCmd::MAV_CMD_SET_MESSAGE_INTERVAL,
                result,
                ..
            }) => self.interval_refused |= result != MavResult::MAV_RESULT_ACCEPTED,
            _ => {}
        }
        News::Nothing
    }

    fn beat(&mut self, packet: &Packet<'_>, heartbeat: &HEARTBEAT_DATA) {
        self.version = packet.version;
        self.is_armed = heartbeat
            .base_mode
            .contains(MavModeFlag::MAV_MODE_FLAG_SAFETY_ARMED);
        self.state = Some(heartbeat.system_status);
    }

    fn learn(&mut self, parameter: &PARAM_VALUE_DATA) -> News {
        let Ok(name) = parameter.param_id.to_str() else {
            return News::NotUnderstood;
        };
        // ArduPilot sends numbers; PX4 sends the bytes of an integer in the place of the number.
        let value = match parameter.param_type {
            MavParamType::MAV_PARAM_TYPE_INT32 if self.is_px4 => {
                f64::from(parameter.param_value.to_bits() as i32)
            }
            _ => f64::from(parameter.param_value),
        };
        let is_known = self.parameters.get(name).is_some();
        if is_known || !is_plausible(name, value) {
            return News::Nothing;
        }
        self.parameters.insert(name, value);
        self.parameters_changed = true;
        self.last_port = self.setup().last_port().min(PORTS - 1);
        News::Parameter
    }

    /// Attitude has a clock of its own, which goes on over 49 days where that of the commands starts over.
    fn check_boot(&mut self, boot_ms: u32) -> News {
        if self.stamps[1].replace(boot_ms) == Some(boot_ms) {
            return News::Nothing;
        }
        self.boot_clock.place(f64::from(boot_ms) * 1e-3);
        match self.boot_clock.boots_s() {
            [] => News::Nothing,
            _ => self.forget(),
        }
    }

    fn command(&mut self, servo: &SERVO_OUTPUT_RAW_DATA) -> News {
        let port = usize::from(servo.port);
        if port >= PORTS {
            return News::Nothing;
        }
        if port != self.last_port {
            // Those of the motors at hand follow, with the same time.
            self.outputs[port] = (pulses(servo), true);
            return News::Nothing;
        }
        self.commands_seen += 1;
        if self.stamps[0].replace(servo.time_usec) == Some(servo.time_usec) {
            return News::Nothing;
        }
        let t_s = match self
            .clock
            .place(seconds(servo.time_usec, self.clock.now_s()))
        {
            Placed::At(t_s) | Placed::Refuted(t_s) | Placed::Confirmed(_, t_s) => t_s,
            Placed::Wait | Placed::RefutedWait => return News::Nothing,
        };
        if !self.clock.boots_s().is_empty() {
            return self.forget();
        }
        self.outputs[port] = (pulses(servo), true);
        for (pulses, is_new) in &mut self.outputs {
            // What did not come again is not known any more.
            if !std::mem::take(is_new) {
                *pulses = [u16::MAX; OUTPUTS_A_PORT];
            }
        }
        News::Commands { t_s }
    }

    fn forget(&mut self) -> News {
        self.parameters = Parameters::default();
        self.is_armed = false;
        self.state = None;
        self.landed = None;
        self.clock = Clock::default();
        self.boot_clock = Clock::default();
        self.stamps = [None; 2];
        self.outputs = NO_OUTPUTS;
        self.interval_refused = false;
        self.last_port = 0;
        News::Rebooted
    }

    /// Motors and ranges from what is known; what is not is assumed, and said to be.
    ///
    /// # Example: parameters in place of an assumption
    /// ```
    /// # mod vehicle { include!(concat!(env!("CARGO_MANIFEST_DIR"), "/doc/vehicle.rs")); }
    /// # use flightlog::mavlink::{Version, dialect::*};
    /// # use vehicle::packet;
    /// # let (mut autopilot, _, _, mut telemetry) = vehicle::followed();
    /// for (name, value) in [("MOT_SPIN_MIN", 0.125), ("MOT_SPIN_MAX", 0.875)] {
    ///     // One of the two is no range yet.
    ///     assert!(telemetry.setup().assumed.contains(&"flown between 0.15 and 0.95 of that".to_string()));
    ///     let told = MavMessage::PARAM_VALUE(PARAM_VALUE_DATA {
    ///         param_id: name.into(),
    ///         param_value: value,
    ///         param_type: MavParamType::MAV_PARAM_TYPE_REAL32,
    ///         ..PARAM_VALUE_DATA::default()
    ///     });
    ///     telemetry.receive(&packet(&autopilot.packet(Version::V2, 1, &told)));
    /// }
    /// let effective = telemetry.setup().effective;
    /// assert_eq!((effective.low, effective.high), (0.125, 0.875));
    /// # Ok::<(), &str>(())
    /// ```
    pub fn setup(&self) -> Setup {
        Setup::of(&self.parameters, &self.vehicle, self.is_px4)
    }

    /// The parameters that motors and their range depend on, and that are not known yet.
    pub(super) fn missing_parameters(&self) -> Vec<String> {
        missing(&self.parameters, &self.vehicle, self.is_px4)
    }

    /// The latest commands on the effective range, 0..1, a value a motor; NaN where it is not known.
    ///
    /// # Example: nothing came yet
    /// ```
    /// # mod vehicle { include!(concat!(env!("CARGO_MANIFEST_DIR"), "/doc/vehicle.rs")); }
    /// # let (_, _, _, telemetry) = vehicle::followed();
    /// let mut commands = [0.0; 4];
    /// telemetry.effective_commands(&telemetry.setup(), &mut commands);
    /// assert!(commands.iter().all(|command| command.is_nan()), "unknown, which is not stopped");
    /// # Ok::<(), &str>(())
    /// ```
    pub fn effective_commands(&self, setup: &Setup, commands: &mut [f64]) {
        for (command, &output) in commands.iter_mut().zip(&setup.outputs) {
            let index = output.checked_sub(1);
            let pulse = index.and_then(|index| {
                let (pulses, _) = self.outputs.get(index / OUTPUTS_A_PORT)?;
                pulses.get(index % OUTPUTS_A_PORT)
            });
            *command = match pulse {
                Some(pulse)
                    if !NO_PULSE.contains(pulse) && f64::from(*pulse) <= LONGEST_PULSE_US =>
                {
                    let fraction = setup.range.fraction(f64::from(*pulse));
                    setup.effective.fraction(fraction)
                }
                _ => f64::NAN,
            };
        }
    }

    /// Whether the vehicle is one that FLAGRED knows about; a generic vehicle may be.
    ///
    /// # Example
    /// ```
    /// # mod vehicle { include!(concat!(env!("CARGO_MANIFEST_DIR"), "/doc/vehicle.rs")); }
    /// # let (_, _, _, telemetry) = vehicle::followed();
    /// assert!(telemetry.may_be_multirotor());
    /// # Ok::<(), &str>(())
    /// ```
    pub fn may_be_multirotor(&self) -> bool {
        matches!(
            self.vehicle.kind,
            VehicleKind::Multirotor | VehicleKind::Unknown
        )
    }
}

/// The pulses of one port.
fn pulses(servo: &SERVO_OUTPUT_RAW_DATA) -> [u16; OUTPUTS_A_PORT] {
    [
        servo.servo1_raw,
        servo.servo2_raw,
        servo.servo3_raw,
        servo.servo4_raw,
        servo.servo5_raw,
        servo.servo6_raw,
        servo.servo7_raw,
        servo.servo8_raw,
        servo.servo9_raw,
        servo.servo10_raw,
        servo.servo11_raw,
        servo.servo12_raw,
        servo.servo13_raw,
        servo.servo14_raw,
        servo.servo15_raw,
        servo.servo16_raw,
    ]
}

/// Damaged limits would make every command look like one at a limit.
fn is_plausible(name: &str, value: f64) -> bool {
    let most = if name.starts_with("MOT_SPIN_") {
        1.0
    } else if name.starts_with("MOT_PWM_") || name.starts_with("RC") {
        LONGEST_PULSE_US
    } else {
        // PX4 has -1 for a limit that is the bank's.
        let is_limit = name.starts_with("PWM_") && !name.contains("FUNC");
        return value.is_finite() && (!is_limit || (-1.0..=LONGEST_PULSE_US).contains(&value));
    };
    (0.0..=most).contains(&value)
}

/// Seconds since boot from microseconds in 32 bits, which start over after 71 minutes: the time nearest to the last
/// one that was believed.
fn seconds(micros: u32, last_s: Option<f64>) -> f64 {
    const ROUND_S: f64 = 4_294.967_296;
    let t_s = f64::from(micros) * 1e-6;
    let rounds = last_s.map_or(0.0, |last_s| ((last_s - t_s) / ROUND_S).round().max(0.0));
    t_s + rounds * ROUND_S
}
