//! Messages into packets.

use ::mavlink::{MAVLinkV1MessageRaw, MAVLinkV2MessageRaw, MavHeader};

use super::{Version, dialect::MavMessage};

/// Numbers the packets of one component.
#[derive(Debug, Clone)]
pub struct Sender {
    component: u8,
    sequence: u8,
}

impl Sender {
    /// A sender that is this component of whatever system it speaks for.
    pub fn new(component: u8) -> Sender {
        Sender {
            component,
            sequence: 0,
        }
    }

    /// The next packet, as a part of `system`.
    pub fn packet(&mut self, version: Version, system: u8, message: &MavMessage) -> Vec<u8> {
        let header = MavHeader {
            system_id: system.into(),
            component_id: self.component,
            sequence: self.sequence,
        };
        self.sequence = self.sequence.wrapping_add(1);
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
