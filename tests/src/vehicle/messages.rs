//! The messages of an autopilot.

use flagred_flightlog::mavlink::dialect::{
    ATTITUDE_DATA, EXTENDED_SYS_STATE_DATA, HEARTBEAT_DATA, MavAutopilot, MavLandedState,
    MavMessage, MavModeFlag, MavParamType, MavState, MavType, PARAM_VALUE_DATA,
    SERVO_OUTPUT_RAW_DATA,
};

/// The number of outputs in one SERVO_OUTPUT_RAW.
pub const OUTPUTS_PER_PORT: usize = 16;

/// The heartbeat of an ArduPilot vehicle.
pub fn heartbeat(mavtype: MavType, armed: bool, in_air: bool) -> MavMessage {
    let mut base_mode = MavModeFlag::MAV_MODE_FLAG_CUSTOM_MODE_ENABLED;
    base_mode.set(MavModeFlag::MAV_MODE_FLAG_SAFETY_ARMED, armed);
    let system_status = match in_air {
        true => MavState::MAV_STATE_ACTIVE,
        false => MavState::MAV_STATE_STANDBY,
    };
    let autopilot = MavAutopilot::MAV_AUTOPILOT_ARDUPILOTMEGA;
    heartbeat_of(mavtype, autopilot, base_mode, system_status)
}

/// A heartbeat with the given type and autopilot.
pub fn heartbeat_of(
    mavtype: MavType,
    autopilot: MavAutopilot,
    base_mode: MavModeFlag,
    system_status: MavState,
) -> MavMessage {
    MavMessage::HEARTBEAT(HEARTBEAT_DATA {
        custom_mode: 0,
        mavtype,
        autopilot,
        base_mode,
        system_status,
        mavlink_version: 3,
    })
}

/// An attitude at a time of the vehicle's clock.
pub(super) fn attitude(t_s: f64) -> MavMessage {
    MavMessage::ATTITUDE(ATTITUDE_DATA {
        time_boot_ms: (t_s * 1e3) as u32,
        ..ATTITUDE_DATA::default()
    })
}

/// EXTENDED_SYS_STATE: whether the vehicle is in the air.
pub(super) fn landed_state(in_air: bool) -> MavMessage {
    MavMessage::EXTENDED_SYS_STATE(EXTENDED_SYS_STATE_DATA {
        landed_state: match in_air {
            true => MavLandedState::MAV_LANDED_STATE_IN_AIR,
            false => MavLandedState::MAV_LANDED_STATE_ON_GROUND,
        },
        ..EXTENDED_SYS_STATE_DATA::default()
    })
}

/// A parameter.
pub(super) fn parameter(name: &str, value: f64) -> MavMessage {
    MavMessage::PARAM_VALUE(PARAM_VALUE_DATA {
        param_value: value as f32,
        param_count: 900,
        param_index: u16::MAX,
        param_id: name.into(),
        param_type: MavParamType::MAV_PARAM_TYPE_REAL32,
    })
}

/// SERVO_OUTPUT_RAW of the first 16 outputs.
pub fn servo(time_usec: u32, pulses: &[u16; OUTPUTS_PER_PORT]) -> MavMessage {
    servo_of_port(time_usec, 0, pulses)
}

/// SERVO_OUTPUT_RAW of 16 outputs of a port.
pub(super) fn servo_of_port(
    time_usec: u32,
    port: u8,
    pulses: &[u16; OUTPUTS_PER_PORT],
) -> MavMessage {
    let p = pulses;
    MavMessage::SERVO_OUTPUT_RAW(SERVO_OUTPUT_RAW_DATA {
        time_usec,
        servo1_raw: p[0],
        servo2_raw: p[1],
        servo3_raw: p[2],
        servo4_raw: p[3],
        servo5_raw: p[4],
        servo6_raw: p[5],
        servo7_raw: p[6],
        servo8_raw: p[7],
        port,
        servo9_raw: p[8],
        servo10_raw: p[9],
        servo11_raw: p[10],
        servo12_raw: p[11],
        servo13_raw: p[12],
        servo14_raw: p[13],
        servo15_raw: p[14],
        servo16_raw: p[15],
    })
}
