//! Maps MAVLink messages to signals (<https://mavlink.io/en/messages/common.html>; fields are ordered by their width).

use super::decoder::Payload;
use crate::angle::Angle;
use crate::field::{NumberType, NumericField};

/// How a signal is computed from the payload of a message.
pub(crate) enum SignalSource {
    /// A field, the factor by which it is multiplied, and the value of the field that means "unknown".
    Number(NumericField, f64, Option<f64>),
    /// The length of the vector of these fields.
    Length(&'static [NumericField]),
    /// An angle of the quaternion that starts at this offset.
    Angle(Angle, usize),
}

/// The signals of one message: computation, name, unit.
pub(crate) struct MessageSpec {
    pub(crate) id: u32,
    pub(crate) message: &'static str,
    pub(crate) signals: &'static [(SignalSource, &'static str, &'static str)],
}

const fn at(offset: usize, kind: NumberType) -> NumericField {
    NumericField { offset, kind }
}

const fn plain(offset: usize, kind: NumberType) -> SignalSource {
    SignalSource::Number(at(offset, kind), 1.0, None)
}

const DEG: f64 = 180.0 / std::f64::consts::PI;

const fn degrees(offset: usize) -> SignalSource {
    SignalSource::Number(at(offset, NumberType::F32), DEG, None)
}

/// RADIO_STATUS of the common dialect and RADIO of SiK radios have the same fields.
const RADIO: &[(SignalSource, &str, &str)] = &[
    (plain(4, NumberType::U8), "radio_rssi", ""),
    (plain(5, NumberType::U8), "radio_remote_rssi", ""),
    (plain(7, NumberType::U8), "radio_noise", ""),
];

/// The signals of each message. If two messages contain the same signal, the first is preferred.
pub(crate) const SPECS: &[MessageSpec] = &[
    MessageSpec {
        id: 30,
        message: "ATTITUDE",
        signals: &[
            (degrees(4), "roll_deg", "deg"),
            (degrees(8), "pitch_deg", "deg"),
            (degrees(12), "yaw_deg", "deg"),
        ],
    },
    MessageSpec {
        id: 62,
        message: "NAV_CONTROLLER_OUTPUT",
        signals: &[
            (plain(0, NumberType::F32), "roll_des_deg", "deg"),
            (plain(4, NumberType::F32), "pitch_des_deg", "deg"),
        ],
    },
    MessageSpec {
        id: 83,
        message: "ATTITUDE_TARGET",
        signals: &[
            (SignalSource::Angle(Angle::Roll, 4), "roll_des_deg", "deg"),
            (SignalSource::Angle(Angle::Pitch, 4), "pitch_des_deg", "deg"),
            (SignalSource::Angle(Angle::Yaw, 4), "yaw_des_deg", "deg"),
        ],
    },
    MessageSpec {
        id: 1,
        message: "SYS_STATUS",
        signals: &[
            (
                SignalSource::Number(at(14, NumberType::U16), 1e-3, Some(65_535.0)),
                "battery_v",
                "V",
            ),
            (
                SignalSource::Number(at(16, NumberType::I16), 0.01, Some(-1.0)),
                "battery_a",
                "A",
            ),
            (
                SignalSource::Number(at(30, NumberType::I8), 1.0, Some(-1.0)),
                "battery_remaining_pct",
                "%",
            ),
        ],
    },
    MessageSpec {
        id: 147,
        message: "BATTERY_STATUS",
        signals: &[(
            SignalSource::Number(at(0, NumberType::I32), 1.0, Some(-1.0)),
            "battery_used_mah",
            "mAh",
        )],
    },
    MessageSpec {
        id: 33,
        message: "GLOBAL_POSITION_INT",
        signals: &[
            // These fields are 0 before the first position.
            (
                SignalSource::Number(at(4, NumberType::I32), 1e-7, Some(0.0)),
                "latitude_deg",
                "deg",
            ),
            (
                SignalSource::Number(at(8, NumberType::I32), 1e-7, Some(0.0)),
                "longitude_deg",
                "deg",
            ),
            (
                SignalSource::Number(at(16, NumberType::I32), 1e-3, None),
                "altitude_m",
                "m",
            ),
        ],
    },
    MessageSpec {
        id: 74,
        message: "VFR_HUD",
        signals: &[
            (plain(4, NumberType::F32), "ground_speed_m_s", "m/s"),
            (plain(12, NumberType::F32), "climb_m_s", "m/s"),
        ],
    },
    MessageSpec {
        id: 241,
        message: "VIBRATION",
        signals: &[
            (plain(8, NumberType::F32), "vibration_x_m_s2", "m/s2"),
            (plain(12, NumberType::F32), "vibration_y_m_s2", "m/s2"),
            (plain(16, NumberType::F32), "vibration_z_m_s2", "m/s2"),
            (
                SignalSource::Length(&[
                    at(8, NumberType::F32),
                    at(12, NumberType::F32),
                    at(16, NumberType::F32),
                ]),
                "vibration_m_s2",
                "m/s2",
            ),
            (plain(20, NumberType::U32), "accelerometer_clips", ""),
        ],
    },
    MessageSpec {
        id: 24,
        message: "GPS_RAW_INT",
        signals: &[
            (
                SignalSource::Number(at(8, NumberType::I32), 1e-7, Some(0.0)),
                "latitude_deg",
                "deg",
            ),
            (
                SignalSource::Number(at(12, NumberType::I32), 1e-7, Some(0.0)),
                "longitude_deg",
                "deg",
            ),
            (plain(28, NumberType::U8), "gps_fix", ""),
            (
                SignalSource::Number(at(29, NumberType::U8), 1.0, Some(255.0)),
                "gps_satellites",
                "",
            ),
            (
                SignalSource::Number(at(20, NumberType::U16), 0.01, Some(65_535.0)),
                "gps_hdop",
                "",
            ),
            // The next two fields are extensions, which are 0 if the sender does not support them.
            (
                SignalSource::Number(at(34, NumberType::U32), 1e-3, Some(0.0)),
                "gps_horizontal_accuracy_m",
                "m",
            ),
            (
                SignalSource::Number(at(38, NumberType::U32), 1e-3, Some(0.0)),
                "gps_vertical_accuracy_m",
                "m",
            ),
        ],
    },
    MessageSpec {
        id: 109,
        message: "RADIO_STATUS",
        signals: RADIO,
    },
    MessageSpec {
        id: 166,
        message: "RADIO",
        signals: RADIO,
    },
    MessageSpec {
        id: 65,
        message: "RC_CHANNELS",
        signals: &[(
            SignalSource::Number(at(41, NumberType::U8), 1.0 / 254.0, Some(255.0)),
            "rc_rssi",
            "1",
        )],
    },
    MessageSpec {
        id: 168,
        message: "WIND",
        signals: &[(plain(4, NumberType::F32), "ekf_wind_m_s", "m/s")],
    },
    MessageSpec {
        id: 231,
        message: "WIND_COV",
        signals: &[
            (plain(8, NumberType::F32), "ekf_wind_north_m_s", "m/s"),
            (plain(12, NumberType::F32), "ekf_wind_east_m_s", "m/s"),
            (
                SignalSource::Length(&[at(8, NumberType::F32), at(12, NumberType::F32)]),
                "ekf_wind_m_s",
                "m/s",
            ),
        ],
    },
];

const BATTERY_STATUS: u32 = 147;

/// The index in [`SPECS`] of the message with this id. Only the first battery has signals.
pub(crate) fn spec_of(id: u32, payload: &Payload) -> Option<usize> {
    let is_other_battery = id == BATTERY_STATUS && payload[32] != 0;
    let index = SPECS.iter().position(|spec| spec.id == id);
    index.filter(|_| !is_other_battery)
}

impl SignalSource {
    /// The value of the signal in a payload that is padded with zeros.
    pub(crate) fn value(&self, payload: &[u8]) -> Option<f64> {
        match self {
            Self::Number(field, factor, unknown) => {
                let number = field.number(payload)?;
                (Some(number) != *unknown).then_some(number * factor)
            }
            Self::Length(fields) => {
                crate::field::vector_length(fields.iter().map(|field| field.number(payload)))
            }
            Self::Angle(angle, offset) => {
                let element =
                    |index: usize| at(offset + 4 * index, NumberType::F32).number(payload);
                Some(angle.of([element(0)?, element(1)?, element(2)?, element(3)?]))
            }
        }
    }
}
