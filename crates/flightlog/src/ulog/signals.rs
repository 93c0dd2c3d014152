//! Maps ULog topics to signals.

use crate::angle::Angle;

/// How a signal is computed from the fields of a topic.
pub(super) enum SignalSource {
    /// A field, multiplied by a factor.
    Field(&'static str, f64),
    /// The length of the vector of these fields.
    Length(&'static [&'static str]),
    /// As `Field`, but 0, which a receiver reports before its first position, counts as unknown.
    Position(&'static str, f64),
    /// The value of the first field, which is unknown unless the second field is 1.
    If(&'static str, &'static str),
    /// An angle of the attitude quaternion in the four elements of this field.
    Angle(Angle, &'static str),
}

/// The signals of one topic. Each has alternative computations (the first one whose fields the topic contains is used),
/// a name and a unit.
pub(super) struct TopicSpec {
    pub(super) topic: &'static str,
    pub(super) signals: &'static [(&'static [SignalSource], &'static str, &'static str)],
}

use SignalSource::{Field, If, Length, Position};

const DEG: f64 = 180.0 / std::f64::consts::PI;

const WIND: &[(&[SignalSource], &str, &str)] = &[
    (
        &[Field("windspeed_north", 1.0)],
        "ekf_wind_north_m_s",
        "m/s",
    ),
    (&[Field("windspeed_east", 1.0)], "ekf_wind_east_m_s", "m/s"),
    (
        &[Length(&["windspeed_north", "windspeed_east"])],
        "ekf_wind_m_s",
        "m/s",
    ),
];

const GPS: &[(&[SignalSource], &str, &str)] = &[
    (
        &[Position("latitude_deg", 1.0), Position("lat", 1e-7)],
        "latitude_deg",
        "deg",
    ),
    (
        &[Position("longitude_deg", 1.0), Position("lon", 1e-7)],
        "longitude_deg",
        "deg",
    ),
    (&[Field("fix_type", 1.0)], "gps_fix", ""),
    (&[Field("satellites_used", 1.0)], "gps_satellites", ""),
    (&[Field("hdop", 1.0)], "gps_hdop", ""),
    (&[Field("eph", 1.0)], "gps_horizontal_accuracy_m", "m"),
    (&[Field("epv", 1.0)], "gps_vertical_accuracy_m", "m"),
    (&[Field("vel_m_s", 1.0)], "ground_speed_m_s", "m/s"),
];

const RADIO: &[(&[SignalSource], &str, &str)] = &[
    (&[Field("rssi", 1.0)], "radio_rssi", ""),
    (
        &[Field("remote_rssi", 1.0), Field("rssi_remote", 1.0)],
        "radio_remote_rssi",
        "",
    ),
    (&[Field("noise", 1.0)], "radio_noise", ""),
];

const fn outputs(
    roll: &'static [SignalSource],
    pitch: &'static [SignalSource],
    yaw: &'static [SignalSource],
) -> [(&'static [SignalSource], &'static str, &'static str); 3] {
    [
        (roll, "roll_output", "1"),
        (pitch, "pitch_output", "1"),
        (yaw, "yaw_output", "1"),
    ]
}

/// The signals of each topic. If two topics contain the same signal, the first is preferred.
pub(super) const SPECS: &[TopicSpec] = &[
    TopicSpec {
        topic: "vehicle_torque_setpoint",
        signals: &outputs(
            &[Field("xyz[0]", 1.0)],
            &[Field("xyz[1]", 1.0)],
            &[Field("xyz[2]", 1.0)],
        ),
    },
    TopicSpec {
        topic: "actuator_controls_0",
        signals: &outputs(
            &[Field("control[0]", 1.0)],
            &[Field("control[1]", 1.0)],
            &[Field("control[2]", 1.0)],
        ),
    },
    TopicSpec {
        topic: "vehicle_attitude",
        signals: &[
            (&[SignalSource::Angle(Angle::Roll, "q")], "roll_deg", "deg"),
            (
                &[SignalSource::Angle(Angle::Pitch, "q")],
                "pitch_deg",
                "deg",
            ),
            (&[SignalSource::Angle(Angle::Yaw, "q")], "yaw_deg", "deg"),
        ],
    },
    TopicSpec {
        topic: "vehicle_attitude_setpoint",
        signals: &[
            (
                &[
                    Field("roll_body", DEG),
                    SignalSource::Angle(Angle::Roll, "q_d"),
                ],
                "roll_des_deg",
                "deg",
            ),
            (
                &[
                    Field("pitch_body", DEG),
                    SignalSource::Angle(Angle::Pitch, "q_d"),
                ],
                "pitch_des_deg",
                "deg",
            ),
            (
                &[
                    Field("yaw_body", DEG),
                    SignalSource::Angle(Angle::Yaw, "q_d"),
                ],
                "yaw_des_deg",
                "deg",
            ),
        ],
    },
    TopicSpec {
        topic: "battery_status",
        signals: &[
            (&[Field("voltage_v", 1.0)], "battery_v", "V"),
            (&[Field("current_a", 1.0)], "battery_a", "A"),
            (&[Field("discharged_mah", 1.0)], "battery_used_mah", "mAh"),
            (&[Field("remaining", 100.0)], "battery_remaining_pct", "%"),
        ],
    },
    TopicSpec {
        topic: "vehicle_global_position",
        signals: &[
            (&[Position("lat", 1.0)], "latitude_deg", "deg"),
            (&[Position("lon", 1.0)], "longitude_deg", "deg"),
        ],
    },
    TopicSpec {
        topic: "vehicle_local_position",
        signals: &[
            (&[If("x", "xy_valid")], "north_m", "m"),
            (&[If("y", "xy_valid")], "east_m", "m"),
            (&[Field("z", -1.0)], "altitude_m", "m"),
            (&[Field("vz", -1.0)], "climb_m_s", "m/s"),
        ],
    },
    TopicSpec {
        topic: "vehicle_imu_status",
        signals: &[
            (
                &[Field("accel_vibration_metric", 1.0)],
                "vibration_m_s2",
                "m/s2",
            ),
            (&[Field("accel_clipping", 1.0)], "accelerometer_clips", ""),
        ],
    },
    TopicSpec {
        topic: "estimator_status",
        signals: &[(&[Field("vibe[2]", 1.0)], "vibration_m_s2", "m/s2")],
    },
    TopicSpec {
        topic: "vehicle_gps_position",
        signals: GPS,
    },
    TopicSpec {
        topic: "sensor_gps",
        signals: GPS,
    },
    TopicSpec {
        topic: "input_rc",
        signals: &[(&[Field("rssi", 0.01)], "rc_rssi", "1")],
    },
    TopicSpec {
        topic: "radio_status",
        signals: RADIO,
    },
    TopicSpec {
        topic: "telemetry_status",
        signals: RADIO,
    },
    TopicSpec {
        topic: "wind",
        signals: WIND,
    },
    TopicSpec {
        topic: "estimator_wind",
        signals: WIND,
    },
    TopicSpec {
        topic: "wind_estimate",
        signals: WIND,
    },
];
