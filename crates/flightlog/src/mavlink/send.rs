//! Packs messages into packets, and unpacks them.

use ::mavlink::{MAVLinkV1MessageRaw, MAVLinkV2MessageRaw, MavHeader, MavlinkVersion, Message};

use super::{Key, Packet, Version, dialect::MavMessage};

impl Packet<'_> {
    /// Decodes the message; `None` if a field contains a value that the dialect does not define.
    pub fn message(&self) -> Option<MavMessage> {
        let version = match self.version {
            Version::V1 => MavlinkVersion::V1,
            Version::V2 => MavlinkVersion::V2,
        };
        MavMessage::parse(version, self.id, self.payload).ok()
    }
}

/// Packs messages of one component and numbers the packets.
#[derive(Debug, Clone)]
pub struct Sender {
    component: u8,
    sequence: u8,
    key: Option<Key>,
}

impl Sender {
    /// Creates a sender with this component id; the system id is chosen for each packet.
    pub fn new(component: u8) -> Sender {
        Sender {
            component,
            sequence: 0,
            key: None,
        }
    }

    /// Signs all packets with `key`. Signed packets always have version 2.
    pub fn signed(self, key: Key) -> Sender {
        Sender {
            key: Some(key),
            ..self
        }
    }

    /// Packs a message into the next packet, sent as a component of `system`.
    ///
    /// # Example
    /// ```
    /// use flagred_flightlog::mavlink::{Sender, Version, dialect::{HEARTBEAT_DATA, MavMessage}};
    ///
    /// let mut sender = Sender::new(191);
    /// let heartbeat = MavMessage::HEARTBEAT(HEARTBEAT_DATA::default());
    /// let numbers = [(); 2].map(|()| sender.packet(Version::V2, 1, &heartbeat)[4]);
    /// assert_eq!(numbers, [0, 1]); // packets are counted
    /// ```
    pub fn packet(&mut self, version: Version, system: u8, message: &MavMessage) -> Vec<u8> {
        let header = MavHeader {
            system_id: system.into(),
            component_id: self.component,
            sequence: self.sequence,
        };
        self.sequence = self.sequence.wrapping_add(1);
        if let Some(key) = &self.key {
            let mut raw = MAVLinkV2MessageRaw::new();
            raw.serialize_message_for_signing(header, message);
            key.sign(&mut raw);
            return raw.raw_bytes().to_vec();
        }
        match version {
            Version::V1 => {
                let mut raw = MAVLinkV1MessageRaw::new();
                raw.serialize_message(header, message);
                raw.raw_bytes().to_vec()
            }
            Version::V2 => {
                let mut raw = MAVLinkV2MessageRaw::new();
                raw.serialize_message(header, message);
                raw.raw_bytes().to_vec()
            }
        }
    }
}
