//! Where a packet begins and ends, and whether it is whole
//! (<https://mavlink.io/en/guide/serialization.html>).

use ::mavlink::{Message, calculate_crc};

use super::dialect::MavMessage;

/// First byte of a packet of MAVLink 1 and 2.
const MARKERS: [u8; 2] = [0xfe, 0xfd];
const V1_HEADER: usize = 6;
const V2_HEADER: usize = 10;
const CHECKSUM: usize = 2;
const SIGNATURE: usize = 13;
/// The one flag that must be understood to read a packet of MAVLink 2: it is signed.
const SIGNED: u8 = 1;

/// The version of the protocol that a packet is in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Version {
    /// MAVLink 1.
    V1,
    /// MAVLink 2.
    V2,
}

/// A packet whose checksum is right.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Packet<'a> {
    /// The version of the protocol.
    pub version: Version,
    /// Counts the packets of a sender, over all messages.
    pub sequence: u8,
    /// The vehicle or ground station that sent it.
    pub system: u8,
    /// The part of the system that sent it; 1 is the autopilot.
    pub component: u8,
    /// Which message it carries.
    pub message_id: u32,
    /// It carries a signature. Without the sender's secret key nobody can tell whether it is genuine.
    pub is_signed: bool,
    /// The message as bytes; MAVLink 2 leaves zeros off at the end.
    pub payload: &'a [u8],
    /// All of the packet.
    pub bytes: &'a [u8],
}

impl Packet<'_> {
    /// The message; `None` where a field holds a value that the dialect does not know.
    pub fn message(&self) -> Option<MavMessage> {
        MavMessage::parse(self.version.into(), self.message_id, self.payload).ok()
    }
}

impl From<Version> for ::mavlink::MavlinkVersion {
    fn from(version: Version) -> Self {
        match version {
            Version::V1 => Self::V1,
            Version::V2 => Self::V2,
        }
    }
}

/// What stands at the start of some bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Next<'a> {
    /// A packet; the next one begins behind [`Packet::bytes`].
    Packet(Packet<'a>),
    /// So many bytes are not one.
    Skip(usize, Why),
    /// Perhaps the beginning of a packet; more bytes will tell.
    More,
}

/// Why bytes are passed over.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Why {
    /// They do not begin like a packet.
    NoPacket,
    /// The checksum is wrong.
    Checksum,
    /// The message is none that the dialect knows, so its checksum cannot be told.
    UnknownMessage(u32),
    /// The packet asks for a feature of the protocol that this reader does not have.
    UnknownFlags(u8),
}

/// Finds what stands at the start of `bytes`: a packet of MAVLink 1 or 2, or bytes to skip.
///
/// ```
/// use flightlog::mavlink::{Next, Why, next_packet};
///
/// let heartbeat = [
///     0xfe, 9, 0, 1, 1, 0, 0, 0, 0, 0, 2, 3, 81, 3, 3, 0x78, 0x51,
/// ];
/// let Next::Packet(packet) = next_packet(&heartbeat) else { panic!() };
/// assert_eq!((packet.system, packet.component, packet.message_id), (1, 1, 0));
/// assert_eq!(next_packet(b"hello"), Next::Skip(5, Why::NoPacket));
/// assert_eq!(next_packet(&heartbeat[..12]), Next::More);
/// ```
pub fn next_packet(bytes: &[u8]) -> Next<'_> {
    let Some(garbage) = bytes.iter().position(|byte| MARKERS.contains(byte)) else {
        return match bytes.len() {
            0 => Next::More,
            length => Next::Skip(length, Why::NoPacket),
        };
    };
    if garbage > 0 {
        return Next::Skip(garbage, Why::NoPacket);
    }
    let (version, header, length, flags, sequence, system, component, message_id) = match *bytes {
        [0xfe, length, sequence, system, component, id, ..] => {
            let id = u32::from(id);
            (
                Version::V1,
                V1_HEADER,
                length,
                0,
                sequence,
                system,
                component,
                id,
            )
        }
        [
            0xfd,
            length,
            flags,
            _,
            sequence,
            system,
            component,
            a,
            b,
            c,
            ..,
        ] => {
            let id = u32::from_le_bytes([a, b, c, 0]);
            (
                Version::V2,
                V2_HEADER,
                length,
                flags,
                sequence,
                system,
                component,
                id,
            )
        }
        _ => return Next::More,
    };
    if flags & !SIGNED != 0 {
        return Next::Skip(1, Why::UnknownFlags(flags));
    }
    let is_signed = flags & SIGNED != 0;
    let body = header + usize::from(length);
    let whole = body + CHECKSUM + if is_signed { SIGNATURE } else { 0 };
    let (Some(packet), Some(payload), Some(checked), Some(&[low, high])) = (
        bytes.get(..whole),
        bytes.get(header..body),
        bytes.get(1..body),
        bytes
            .get(body..body + CHECKSUM)
            .and_then(|two| two.first_chunk()),
    ) else {
        return Next::More;
    };
    let extra = MavMessage::extra_crc(message_id);
    if extra == 0 && MavMessage::default_message_from_id(message_id).is_none() {
        // Its length can be believed only where another packet, or nothing, follows.
        let follows = bytes.get(whole).is_none_or(|byte| MARKERS.contains(byte));
        let skip = if follows { whole } else { 1 };
        return Next::Skip(skip, Why::UnknownMessage(message_id));
    }
    if calculate_crc(checked, extra) != u16::from_le_bytes([low, high]) {
        return Next::Skip(1, Why::Checksum);
    }
    Next::Packet(Packet {
        version,
        sequence,
        system,
        component,
        message_id,
        is_signed,
        payload,
        bytes: packet,
    })
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::{Sender, dialect::NAMED_VALUE_FLOAT_DATA};
    use super::*;

    fn risk(version: Version) -> Vec<u8> {
        let message = MavMessage::NAMED_VALUE_FLOAT(NAMED_VALUE_FLOAT_DATA {
            time_boot_ms: 1234,
            value: 56.5,
            name: "FR_RISK".into(),
        });
        Sender::new(191).packet(version, 1, &message)
    }

    #[test]
    fn both_versions_are_read_back() {
        for version in [Version::V1, Version::V2] {
            let bytes = risk(version);
            let Next::Packet(packet) = next_packet(&bytes) else {
                panic!("{:?}", next_packet(&bytes));
            };
            assert_eq!(
                (packet.version, packet.system, packet.component),
                (version, 1, 191)
            );
            assert_eq!(packet.bytes, bytes);
            let Some(MavMessage::NAMED_VALUE_FLOAT(value)) = packet.message() else {
                panic!("{packet:?}");
            };
            assert_eq!(value.value, 56.5);
            assert_eq!(value.name.to_str(), Ok("FR_RISK"));
        }
    }

    #[test]
    fn one_wrong_bit_is_no_packet() {
        for version in [Version::V1, Version::V2] {
            let bytes = risk(version);
            for bit in 0..bytes.len() * 8 {
                let mut damaged = bytes.clone();
                damaged[bit / 8] ^= 1 << (bit % 8);
                assert!(
                    !matches!(next_packet(&damaged), Next::Packet(_)),
                    "bit {bit} of {version:?}"
                );
            }
        }
    }

    #[test]
    fn a_part_of_a_packet_asks_for_more() {
        let bytes = risk(Version::V2);
        for end in 0..bytes.len() {
            assert_eq!(next_packet(&bytes[..end]), Next::More, "{end} bytes");
        }
    }

    proptest! {
        /// Whatever comes in, every step takes at least a byte or asks for more, and never panics.
        #[test]
        fn any_bytes_are_taken(bytes in prop::collection::vec(prop_oneof![Just(0xfd), Just(0xfe), any::<u8>()], 0..600)) {
            let mut at = 0;
            loop {
                match next_packet(&bytes[at..]) {
                    Next::Packet(packet) => at += packet.bytes.len(),
                    Next::Skip(count, _) => {
                        prop_assert!(count > 0);
                        at += count;
                    }
                    Next::More => break,
                }
                prop_assert!(at <= bytes.len());
            }
        }
    }
}
