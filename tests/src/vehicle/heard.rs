//! What the other side said, and how far it is.

use std::{
    sync::atomic::{AtomicBool, AtomicU64},
    time::Instant,
};

use flagred_flightlog::mavlink::dialect::MavMessage;

/// What the other side said.
#[derive(Debug, Default)]
pub struct Heard {
    /// Its messages, each with when it came, the system and the component that sent it.
    pub messages: Vec<(Instant, u8, u8, MavMessage)>,
}

impl Heard {
    /// The texts, with their severity.
    pub fn texts(&self) -> Vec<(u8, String)> {
        let texts = self
            .messages
            .iter()
            .filter_map(|(_, _, _, message)| match message {
                MavMessage::STATUSTEXT(text) => {
                    Some((text.severity as u8, text.text.to_str().unwrap().to_owned()))
                }
                _ => None,
            });
        texts.collect()
    }

    /// The values of this name, each with when it came and the vehicle's time it is for, in ms.
    pub fn values(&self, name: &str) -> Vec<(Instant, u32, f32)> {
        let values = self
            .messages
            .iter()
            .filter_map(|(at, _, _, message)| match message {
                MavMessage::NAMED_VALUE_FLOAT(value) if value.name.to_str() == Ok(name) => {
                    Some((*at, value.time_boot_ms, value.value))
                }
                _ => None,
            });
        values.collect()
    }
}

/// How far the other side is; kept by whoever reads what it says.
#[derive(Debug, Default)]
pub struct Progress {
    /// The vehicle's time, in ms, of the latest risk that it told.
    pub followed_ms: AtomicU64,
    /// Whether it told that it knows the motors.
    pub is_ready: AtomicBool,
    /// The last other system that it told of: after a flight a heartbeat of another one marks its end.
    pub other_system: AtomicU64,
}
