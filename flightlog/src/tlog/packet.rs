//! MAVLink packets, version 1 and 2 (<https://mavlink.io/en/guide/serialization.html>).

use super::checksum::{accumulate, extra};

/// Bytes of the longest packet: head, payload, checksum and signature.
pub(super) const LONGEST: usize = 10 + 255 + 2 + 13;
/// Bytes of a signature.
const SIGNATURE: usize = 13;
/// Flag of a packet that is signed.
const SIGNED: u8 = 1;

/// One packet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Packet<'a> {
    pub(super) system: u8,
    pub(super) component: u8,
    pub(super) id: u32,
    /// Without the zeros at its end in version 2.
    pub(super) payload: &'a [u8],
    /// Bytes of the whole packet.
    pub(super) length: usize,
    /// The checksum holds; `None` when it cannot be checked, as that of messages of other
    /// dialects.
    pub(super) sound: Option<bool>,
}

impl<'a> Packet<'a> {
    /// The packet at the start of `bytes`; `None` when there is none, or not all of it.
    pub(super) fn at(bytes: &'a [u8]) -> Option<Self> {
        let (system, component, id, head, signature) = match bytes {
            [0xfe, _, _, system, component, id, ..] => (*system, *component, u32::from(*id), 6, 0),
            [0xfd, _, flags, _, _, system, component, a, b, c, ..] => {
                let signature = match flags {
                    0 => 0,
                    &SIGNED => SIGNATURE,
                    _ => return None,
                };
                let id = u32::from_le_bytes([*a, *b, *c, 0]);
                (*system, *component, id, 10, signature)
            }
            _ => return None,
        };
        let end = head + usize::from(*bytes.get(1)?);
        let length = end + 2 + signature;
        let payload = bytes.get(..length)?.get(head..end)?;
        let sum = u16::from_le_bytes(*bytes.get(end..)?.first_chunk()?);
        let sound =
            extra(id).map(|extra| accumulate(bytes.get(1..end).unwrap_or_default(), extra) == sum);
        Some(Self {
            system,
            component,
            id,
            payload,
            length,
            sound,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A heartbeat of version 1 as pymavlink 2.4.50 packs it: system 1, component 1,
    /// quadrotor, ArduPilot, armed, mode 5, active.
    const HEARTBEAT: [u8; 17] = [
        0xfe, 0x09, 0x00, 0x01, 0x01, 0x00, 0x05, 0x00, 0x00, 0x00, 0x02, 0x03, 0x81, 0x04, 0x03,
        0xbe, 0xb9,
    ];

    #[test]
    fn a_heartbeat_is_sound_and_a_damaged_one_is_not() {
        let packet = Packet::at(&HEARTBEAT).unwrap();
        assert_eq!((packet.system, packet.component, packet.id), (1, 1, 0));
        assert_eq!((packet.length, packet.sound), (17, Some(true)));
        let mut damaged = HEARTBEAT;
        damaged[9] ^= 1;
        assert_eq!(Packet::at(&damaged).unwrap().sound, Some(false));
        assert_eq!(Packet::at(&HEARTBEAT[..16]), None);
        assert_eq!(Packet::at(&HEARTBEAT[1..]), None);
    }
}
