//! The messages of the other side, and its progress.

use std::{
    sync::atomic::{AtomicBool, AtomicU64},
    time::Instant,
};

use flagred_flightlog::mavlink::dialect::MavMessage;

/// The messages of the other side.
#[derive(Debug, Default)]
pub struct Inbox {
    /// The messages, each with its arrival time, system and component.
    pub messages: Vec<(Instant, u8, u8, MavMessage)>,
}

impl Inbox {
    /// The texts with their severity.
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

    /// The values with the given name, each with its arrival time and the vehicle's time in ms.
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

/// The progress of the other side, updated by the reader of its output.
#[derive(Debug, Default)]
pub struct Progress {
    /// The vehicle's time, in ms, of the latest reported risk.
    pub followed_ms: AtomicU64,
    /// Whether the other side reported that it knows the motors.
    pub is_ready: AtomicBool,
    /// The last other system that the other side reported: after a flight, a heartbeat of another system marks the end.
    pub other_system: AtomicU64,
}
