//! Maps DataFlash messages to signals.

/// How a signal is computed from the fields of a message.
pub(crate) enum SignalSource {
    /// The field with the first of these labels that the message has.
    Field(&'static [&'static str]),
    /// As `Field`, but in hundredths if the field is an integer (firmware before 3.3).
    Hundredths(&'static [&'static str]),
    /// The length of the vector of these fields.
    Length(&'static [&'static str]),
    /// As `Field`, but 0, which an autopilot writes before its first position, counts as unknown.
    Position(&'static [&'static str]),
}

/// The signals of one message type: computation, name, unit.
pub(crate) struct MessageSpec {
    pub(crate) message: &'static str,
    pub(crate) signals: &'static [(SignalSource, &'static str, &'static str)],
}

/// Labels of the field that numbers several sensors, cores or batteries; only number 0 is used.
pub(crate) const INSTANCE: &[&str] = &["I", "Inst", "Instance", "IMU", "C"];

use SignalSource::{Field, Hundredths, Length, Position};

const WIND: &[(SignalSource, &str, &str)] = &[
    (Field(&["VWN"]), "ekf_wind_north_m_s", "m/s"),
    (Field(&["VWE"]), "ekf_wind_east_m_s", "m/s"),
    (Length(&["VWN", "VWE"]), "ekf_wind_m_s", "m/s"),
];

pub(crate) const SPECS: &[MessageSpec] = &[
    MessageSpec {
        message: "ATT",
        signals: &[
            (Field(&["DesRoll", "RollIn"]), "roll_des_deg", "deg"),
            (Field(&["Roll"]), "roll_deg", "deg"),
            (Field(&["DesPitch", "PitchIn"]), "pitch_des_deg", "deg"),
            (Field(&["Pitch"]), "pitch_deg", "deg"),
            (Field(&["DesYaw", "YawIn"]), "yaw_des_deg", "deg"),
            (Field(&["Yaw"]), "yaw_deg", "deg"),
        ],
    },
    MessageSpec {
        message: "RATE",
        signals: &[
            (Field(&["ROut"]), "roll_output", "1"),
            (Field(&["POut"]), "pitch_output", "1"),
            (Field(&["YOut"]), "yaw_output", "1"),
        ],
    },
    MessageSpec {
        message: "BAT",
        signals: &[
            (Field(&["Volt"]), "battery_v", "V"),
            (Field(&["Curr"]), "battery_a", "A"),
            (Field(&["CurrTot"]), "battery_used_mah", "mAh"),
            (Field(&["RemPct"]), "battery_remaining_pct", "%"),
        ],
    },
    MessageSpec {
        message: "CURR",
        signals: &[
            (Hundredths(&["Volt"]), "battery_v", "V"),
            (Hundredths(&["Curr"]), "battery_a", "A"),
            (Field(&["CurrTot"]), "battery_used_mah", "mAh"),
        ],
    },
    MessageSpec {
        message: "CTUN",
        signals: &[(Field(&["Alt", "BarAlt"]), "altitude_m", "m")],
    },
    MessageSpec {
        message: "VIBE",
        signals: &[
            (Field(&["VibeX"]), "vibration_x_m_s2", "m/s2"),
            (Field(&["VibeY"]), "vibration_y_m_s2", "m/s2"),
            (Field(&["VibeZ"]), "vibration_z_m_s2", "m/s2"),
            (
                Length(&["VibeX", "VibeY", "VibeZ"]),
                "vibration_m_s2",
                "m/s2",
            ),
            (Field(&["Clip", "Clip0"]), "accelerometer_clips", ""),
        ],
    },
    // The estimated position is preferred to the position that the receiver reports.
    MessageSpec {
        message: "POS",
        signals: &[
            (Position(&["Lat"]), "latitude_deg", "deg"),
            (Position(&["Lng"]), "longitude_deg", "deg"),
        ],
    },
    MessageSpec {
        message: "GPS",
        signals: &[
            (Position(&["Lat"]), "latitude_deg", "deg"),
            (Position(&["Lng"]), "longitude_deg", "deg"),
            (Field(&["Status"]), "gps_fix", ""),
            (Field(&["NSats"]), "gps_satellites", ""),
            (Field(&["HDop"]), "gps_hdop", ""),
            (Field(&["Spd"]), "ground_speed_m_s", "m/s"),
        ],
    },
    MessageSpec {
        message: "GPA",
        signals: &[
            (Field(&["HAcc"]), "gps_horizontal_accuracy_m", "m"),
            (Field(&["VAcc"]), "gps_vertical_accuracy_m", "m"),
        ],
    },
    MessageSpec {
        message: "RAD",
        signals: &[
            (Field(&["RSSI"]), "radio_rssi", ""),
            (Field(&["RemRSSI"]), "radio_remote_rssi", ""),
            (Field(&["Noise"]), "radio_noise", ""),
        ],
    },
    MessageSpec {
        message: "RSSI",
        signals: &[
            (Field(&["RXRSSI"]), "rc_rssi", "1"),
            (Field(&["RXLQ"]), "rc_link_quality_pct", "%"),
        ],
    },
    MessageSpec {
        message: "XKF2",
        signals: WIND,
    },
    MessageSpec {
        message: "NKF2",
        signals: WIND,
    },
    MessageSpec {
        message: "EKF2",
        signals: WIND,
    },
    MessageSpec {
        message: "SIMW",
        signals: &[
            (Length(&["WN", "WE"]), "wind_m_s", "m/s"),
            (Field(&["WD"]), "wind_down_m_s", "m/s"),
        ],
    },
];
