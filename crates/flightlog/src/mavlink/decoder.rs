//! The state of one vehicle from its messages: armed, in the air, parameters, outputs. Telemetry logs and live links
//! use the same decoder.

use std::collections::{BTreeMap, BTreeSet};

use crate::field::{NumberType, NumericField};
use crate::mav_type::{MavType, mav_type};
use crate::outputs::LONGEST_PULSE_US;
use crate::parameters::Parameters;
use crate::{PulseRange, Vehicle, identity, px4};

use super::Packet;
use super::outputs::KnownOutputs;

/// The component id of the autopilot of a system.
pub(crate) const AUTOPILOT: u8 = 1;
/// MAV_AUTOPILOT of ArduPilot.
const ARDUPILOT: u8 = 3;
/// MAV_AUTOPILOT of components that are not autopilots.
const NO_AUTOPILOT: u8 = 8;
/// MAV_AUTOPILOT of PX4.
const PX4: u8 = 12;
/// Flag of HEARTBEAT.base_mode: the motors are armed.
const ARMED: u8 = 128;

const HEARTBEAT: u32 = 0;
const PARAM_VALUE: u32 = 22;
const SERVO_OUTPUT_RAW: u32 = 36;
const AUTOPILOT_VERSION: u32 = 148;
const EXTENDED_SYS_STATE: u32 = 245;
const STATUSTEXT: u32 = 253;
const PARAM_ERROR: u32 = 345;
/// MAV_PARAM_ERROR of a parameter that exists but could not be read.
const READ_FAILED: u8 = 8;

/// The maximum number of parameters that wait for the first heartbeat; any vehicle has fewer.
const MAX_WAITING: usize = 1 << 12;

/// A payload, padded with the zeros that version 2 omits at its end.
pub(crate) type Payload = [u8; 255];

pub(crate) fn filled(packet: &Packet<'_>) -> Payload {
    let mut payload = [0; 255];
    let length = packet.payload.len().min(payload.len());
    payload[..length].copy_from_slice(&packet.payload[..length]);
    payload
}

pub(crate) fn number(payload: &Payload, offset: usize, kind: NumberType) -> Option<f64> {
    NumericField { offset, kind }.number(payload)
}

fn text(bytes: &[u8]) -> String {
    let end = bytes.iter().position(|&byte| byte == 0);
    let text = bytes.get(..end.unwrap_or(bytes.len())).unwrap_or_default();
    String::from_utf8_lossy(text).trim().to_owned()
}

/// The change that a message caused.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum DecoderChange {
    /// No change in the decoder.
    Nothing,
    /// A change of the armed state, the in-air state or the mode; the methods of [`Decoder`] return the new values.
    State,
    /// A parameter is now known, or known to be unreadable.
    Parameter,
    Outputs(ServoOutputs),
    Text(String),
}

/// The content of a SERVO_OUTPUT_RAW message.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ServoOutputs {
    pub(crate) port: u8,
    /// The time of the vehicle, which wraps around after 71 minutes.
    pub(crate) time_us: u32,
    /// Outputs 1 to 16 of the port; in MAVLink 1, the outputs above 8 are 0.
    pub(crate) pulses_us: [u16; 16],
}

/// The state of one vehicle, from its messages so far.
#[derive(Debug, Default)]
pub(crate) struct Decoder {
    autopilot: Option<u8>,
    mav_type: Option<u8>,
    version: Option<u32>,
    id: Option<(String, &'static str)>,
    pub(crate) parameters: Parameters,
    /// Whether a later value of a parameter replaces the first, as on a live link. For a log, the first value is used.
    takes_changes: bool,
    /// Parameters that were set in the air; they apply after the landing.
    changed: BTreeMap<String, f64>,
    /// Parameters that the vehicle reported as missing or unreadable.
    absent: BTreeSet<String>,
    /// PARAM_VALUE messages that arrived before the type of the autopilot was known: name, value, type.
    waiting: Vec<(String, [u8; 4], u8)>,
    is_armed: bool,
    /// Whether the vehicle is active rather than on standby, from HEARTBEAT.system_status.
    is_active: Option<bool>,
    /// Whether the vehicle is in the air, from EXTENDED_SYS_STATE.landed_state.
    is_flying: Option<bool>,
    /// Whether any EXTENDED_SYS_STATE message contained a known landed state.
    has_landed_state: bool,
    /// Whether the motors are stopped on purpose (flight termination, kill switch).
    is_terminating: bool,
    mode: Option<u32>,
}

impl Decoder {
    /// The decoder of a live link, where parameters may be set between flights.
    #[cfg(feature = "mavlink")]
    pub(crate) fn live() -> Decoder {
        Decoder {
            takes_changes: true,
            ..Decoder::default()
        }
    }

    pub(crate) fn is_px4(&self) -> bool {
        self.autopilot == Some(PX4)
    }

    /// Whether a heartbeat of an autopilot has arrived.
    pub(crate) fn is_known(&self) -> bool {
        self.autopilot.is_some()
    }

    pub(crate) fn is_armed(&self) -> bool {
        self.is_armed
    }

    /// HEARTBEAT.custom_mode.
    pub(crate) fn mode(&self) -> Option<u32> {
        self.mode
    }

    /// The firmware of PX4, which reports its version in a separate message.
    pub(crate) fn px4_firmware(&self) -> Option<String> {
        self.version.filter(|_| self.is_px4()).map(px4::firmware)
    }

    /// Whether the vehicle is in the air; `None` while that is unknown.
    ///
    /// The source is EXTENDED_SYS_STATE or, without that message, the state in ArduPilot's heartbeat: standby while
    /// landed, active otherwise. During a failsafe, that state is critical even on the ground, and counts as in the
    /// air. PX4 reports active as soon as it is armed, so its heartbeat is not used.
    pub(crate) fn is_in_air(&self) -> Option<bool> {
        let by_heartbeat = self.is_active.filter(|_| !self.is_px4());
        self.is_flying
            .or(by_heartbeat)
            .map(|flying| flying && self.is_armed)
    }

    /// Whether the vehicle has ever reported a landed state. The state in a heartbeat does not count, because it is
    /// still critical after a landing in a failsafe.
    pub(crate) fn has_landed_state(&self) -> bool {
        self.has_landed_state
    }

    /// Whether the vehicle is armed and reports that it is in the air, and its motors were not stopped on purpose. A
    /// pilot may stop them after a landing without waiting for the land detector.
    #[cfg(feature = "mavlink")]
    pub(crate) fn reports_flight(&self) -> bool {
        self.is_flying == Some(true) && self.is_armed && !self.is_terminating
    }

    /// [`Decoder::is_in_air`]; a vehicle that does not report it counts as in the air while it is armed.
    pub(crate) fn is_in_air_or_armed(&self) -> bool {
        self.is_in_air().unwrap_or(self.is_armed)
    }

    /// The type in the heartbeats, if it is the type of a vehicle.
    pub(crate) fn mav_type(&self) -> Option<(u8, MavType)> {
        let number = self.mav_type?;
        Some((number, mav_type(number.into())?))
    }

    /// Processes a message of the vehicle.
    pub(crate) fn message(&mut self, component: u8, id: u32, payload: &Payload) -> DecoderChange {
        // Parameters are accepted from every component, because ground stations store them under other component ids.
        if component != AUTOPILOT && id != PARAM_VALUE {
            return DecoderChange::Nothing;
        }
        match id {
            HEARTBEAT => self.heartbeat(payload),
            PARAM_VALUE => self.parameter(payload),
            SERVO_OUTPUT_RAW => DecoderChange::Outputs(servo_outputs(payload)),
            AUTOPILOT_VERSION => {
                // The version is in bytes 16 to 19, after the capabilities and the uid.
                let version = number(payload, 16, NumberType::U32).map(|version| version as u32);
                self.version = self.version.or(version);
                let reported = || identity::of_version(&payload[8..16], &payload[60..78]);
                self.id = self.id.take().or_else(reported);
                DecoderChange::Nothing
            }
            EXTENDED_SYS_STATE => {
                // 1 on the ground, 2 in the air, 3 taking off, 4 landing; 0 is unknown.
                self.is_flying = match payload[1] {
                    1 => Some(false),
                    2..=4 => Some(true),
                    _ => None,
                };
                self.has_landed_state |= self.is_flying.is_some();
                DecoderChange::State
            }
            STATUSTEXT => DecoderChange::Text(text(&payload[1..51])),
            // The payload begins with the index of the parameter, then the system and the component of the requester;
            // the name follows.
            PARAM_ERROR => self.parameter_error(text(&payload[4..20]), payload[20]),
            _ => DecoderChange::Nothing,
        }
    }

    fn heartbeat(&mut self, payload: &Payload) -> DecoderChange {
        let [mode @ .., mav_type, autopilot, base_mode, status] =
            *payload.first_chunk::<8>().unwrap_or(&[0; 8]);
        if autopilot == NO_AUTOPILOT {
            return DecoderChange::Nothing;
        }
        self.autopilot = Some(autopilot);
        self.mav_type = Some(mav_type);
        self.mode = Some(u32::from_le_bytes(mode));
        self.is_armed = base_mode & ARMED != 0;
        self.is_terminating = status == 8;
        self.is_active = match status {
            // Active, critical (a failsafe) and emergency (going down).
            4..=6 => Some(true),
            // While the flight is terminated, the previous state remains.
            8 => self.is_active.or(Some(self.is_armed)),
            _ => Some(false),
        };
        for (name, value, kind) in std::mem::take(&mut self.waiting) {
            self.learn(name, value, kind);
        }
        DecoderChange::State
    }

    fn parameter(&mut self, payload: &Payload) -> DecoderChange {
        let &[a, b, c, d, ..] = payload;
        let (name, value, kind) = (text(&payload[8..24]), [a, b, c, d], payload[24]);
        if self.is_known() {
            return self.learn(name, value, kind);
        }
        if self.waiting.len() < MAX_WAITING {
            self.waiting.push((name, value, kind));
        }
        DecoderChange::Nothing
    }

    fn parameter_error(&mut self, name: String, error: u8) -> DecoderChange {
        if matches!(error, 0 | READ_FAILED) || self.absent.len() >= MAX_WAITING {
            return DecoderChange::Nothing;
        }
        match self.absent.insert(name) {
            true => DecoderChange::Parameter,
            false => DecoderChange::Nothing,
        }
    }

    /// Whether the vehicle reported that a parameter does not exist or cannot be read.
    #[cfg(feature = "mavlink")]
    pub(crate) fn is_absent(&self, name: &str) -> bool {
        self.absent.contains(name)
    }

    fn learn(&mut self, name: String, value: [u8; 4], kind: u8) -> DecoderChange {
        // PX4 sends the bytes of an integer in place of the float; ArduPilot sends every number as a float
        // (<https://mavlink.io/en/services/parameter.html#parameter_encoding>).
        let kind = match kind {
            _ if !self.is_px4() => NumberType::F32,
            1 => NumberType::U8,
            2 => NumberType::I8,
            3 => NumberType::U16,
            4 => NumberType::I16,
            5 => NumberType::U32,
            6 => NumberType::I32,
            _ => NumberType::F32,
        };
        let value = NumericField { offset: 0, kind }.number(&value);
        let Some(value) = value.filter(|value| is_plausible(&name, *value)) else {
            return DecoderChange::Nothing;
        };
        match self.parameters.get(&name) {
            None => self.parameters.insert(&name, value),
            Some(_) if !self.takes_changes => return DecoderChange::Nothing,
            Some(_) if self.is_in_air_or_armed() => {
                self.changed.insert(name, value);
                return DecoderChange::Nothing;
            }
            Some(known) if known == value => return DecoderChange::Nothing,
            Some(_) => self.parameters.set(&name, value),
        }
        DecoderChange::Parameter
    }

    /// Applies, on the ground, the parameters that were set in the air; returns whether any changed.
    #[cfg(feature = "mavlink")]
    pub(crate) fn take_changed(&mut self) -> bool {
        if self.changed.is_empty() || self.is_in_air_or_armed() {
            return false;
        }
        for (name, value) in std::mem::take(&mut self.changed) {
            self.parameters.set(&name, value);
        }
        true
    }

    /// Applies the parameters that wait for a heartbeat, for a vehicle that never sent one.
    pub(crate) fn finish(&mut self) {
        for (name, value, kind) in std::mem::take(&mut self.waiting) {
            self.learn(name, value, kind);
        }
    }

    /// Resets the state that may have changed while the vehicle rebooted, and keeps its type.
    #[cfg(feature = "mavlink")]
    pub(crate) fn boot(&mut self) {
        *self = Self {
            autopilot: self.autopilot,
            mav_type: self.mav_type,
            id: self.id.take(),
            takes_changes: self.takes_changes,
            ..Self::default()
        };
    }

    /// The vehicle that the heartbeat describes.
    pub(crate) fn vehicle(&self) -> Vehicle {
        let mut vehicle = Vehicle::default();
        if let Some(number) = self.mav_type {
            vehicle.source = format!("HEARTBEAT.type = {number}");
        }
        if let Some((_, MavType { kind, name, motors })) = self.mav_type() {
            vehicle.kind = kind;
            vehicle.frame = Some(name.to_owned());
            vehicle.motors = motors;
        }
        vehicle.firmware = match self.autopilot {
            Some(ARDUPILOT) => Some("ArduPilot".to_owned()),
            Some(PX4) => Some("PX4".to_owned()),
            _ => None,
        };
        if let Some((id, source)) = &self.id {
            identity::name(&mut vehicle, id.clone(), source);
        }
        vehicle
    }

    /// Motors and ranges from the parameters, with assumptions for missing ones.
    pub(crate) fn outputs(&self, vehicle: &Vehicle, given: Option<PulseRange>) -> KnownOutputs {
        KnownOutputs::of(&self.parameters, vehicle, self.is_px4(), given)
    }
}

fn servo_outputs(payload: &Payload) -> ServoOutputs {
    // In MAVLink 2, the outputs from 9 on follow the port.
    let offset = |output: usize| {
        if output < 8 {
            4 + 2 * output
        } else {
            5 + 2 * output
        }
    };
    let pulse = |output| number(payload, offset(output), NumberType::U16).unwrap_or_default();
    ServoOutputs {
        port: payload[20],
        time_us: number(payload, 0, NumberType::U32).unwrap_or_default() as u32,
        pulses_us: std::array::from_fn(|output| pulse(output) as u16),
    }
}

/// Whether a limit is plausible. With damaged limits, every command would seem to be at a limit.
fn is_plausible(name: &str, value: f64) -> bool {
    let most = if name.starts_with("MOT_SPIN_") {
        1.0
    } else if name.starts_with("MOT_PWM_") || is_radio_limit(name) {
        LONGEST_PULSE_US
    } else {
        // PX4 uses -1 for "the limit of the bank".
        let is_limit = name.starts_with("PWM_") && !name.contains("FUNC");
        return value.is_finite() && (!is_limit || (-1.0..=LONGEST_PULSE_US).contains(&value));
    };
    (0.0..=most).contains(&value)
}

/// Whether the parameter is RCn_MIN or RCn_MAX.
fn is_radio_limit(name: &str) -> bool {
    name.starts_with("RC") && (name.ends_with("_MIN") || name.ends_with("_MAX"))
}
