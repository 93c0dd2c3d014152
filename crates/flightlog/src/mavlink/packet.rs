//! Finds packets in bytes and verifies them (<https://mavlink.io/en/guide/serialization.html>).

use super::checksum::{accumulate, extra};

/// The first bytes of packets of version 1 and 2.
const MARKERS: [u8; 2] = [0xfe, 0xfd];
const CHECKSUM: usize = 2;
const SIGNATURE: usize = 13;
/// The flag of a signed packet, the only supported flag.
const SIGNED: u8 = 1;
/// The length of the longest packet in bytes: header, payload, checksum and signature.
pub(crate) const LONGEST: usize = 10 + 255 + CHECKSUM + SIGNATURE;

/// The version of the protocol of a packet.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Version {
    /// MAVLink 1.
    V1,
    /// MAVLink 2.
    V2,
}

/// A packet.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Packet<'a> {
    /// The version of the protocol.
    pub version: Version,
    /// The sequence number, which counts all packets of a sender.
    pub sequence: u8,
    /// The vehicle or ground station that sent the packet.
    pub system: u8,
    /// The component of the system that sent the packet; 1 is the autopilot.
    pub component: u8,
    /// The id of the message.
    pub id: u32,
    /// Whether it is signed. A signature cannot be verified without the sender's key.
    pub is_signed: bool,
    /// The payload of the message; version 2 omits zeros at its end.
    pub payload: &'a [u8],
    /// The whole packet.
    pub bytes: &'a [u8],
    /// Whether the checksum is right; `None` if it cannot be verified, as for messages of other dialects.
    pub sound: Option<bool>,
}

/// The kind of content at the start of some bytes.
enum Start<'a> {
    /// A whole packet, with a right or wrong checksum.
    Whole(Packet<'a>),
    /// Possibly the first part of a packet.
    Part,
    /// A packet that requires an unsupported feature of the protocol.
    Flags(u8),
    /// Not a packet.
    Other,
}

impl<'a> Packet<'a> {
    /// The packet at the start of `bytes`, with a right or wrong checksum; `None` if there is none, or only a part of
    /// one.
    pub(crate) fn at(bytes: &'a [u8]) -> Option<Self> {
        match start(bytes) {
            Start::Whole(packet) => Some(packet),
            Start::Part | Start::Flags(_) | Start::Other => None,
        }
    }
}

fn start(bytes: &[u8]) -> Start<'_> {
    let (version, head, length, flags, [sequence, system, component], id) = match *bytes {
        [0xfe, length, sequence, system, component, id, ..] => {
            let sender = [sequence, system, component];
            (Version::V1, 6, length, 0, sender, u32::from(id))
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
            let sender = [sequence, system, component];
            let id = u32::from_le_bytes([a, b, c, 0]);
            (Version::V2, 10, length, flags, sender, id)
        }
        [0xfe | 0xfd, ..] | [] => return Start::Part,
        _ => return Start::Other,
    };
    if flags & !SIGNED != 0 {
        return Start::Flags(flags);
    }
    let is_signed = flags & SIGNED != 0;
    let end = head + usize::from(length);
    let whole = end + CHECKSUM + if is_signed { SIGNATURE } else { 0 };
    let (Some(packet), Some(payload), Some(checked), Some(&sum)) = (
        bytes.get(..whole),
        bytes.get(head..end),
        bytes.get(1..end),
        bytes.get(end..).and_then(|rest| rest.first_chunk()),
    ) else {
        return Start::Part;
    };
    let sum = u16::from_le_bytes(sum);
    Start::Whole(Packet {
        version,
        sequence,
        system,
        component,
        id,
        is_signed,
        payload,
        bytes: packet,
        sound: extra(id).map(|extra| accumulate(checked, extra) == sum),
    })
}

/// The result of looking for a packet at the start of some bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PacketScan<'a> {
    /// A packet; the next one begins after [`Packet::bytes`].
    Packet(Packet<'a>),
    /// A packet with a message that is not in the dialect, so that its checksum cannot be verified. Another packet, or
    /// nothing, follows it.
    Unverified(Packet<'a>),
    /// The given number of bytes at the start is not part of a packet, for the given reason.
    Skip(usize, SkipReason),
    /// Possibly the beginning of a packet; more bytes are needed.
    More,
}

/// The reason why bytes are skipped.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SkipReason {
    /// The bytes do not begin like a packet.
    NoPacket,
    /// The checksum is wrong.
    Checksum,
    /// The packet requires a feature of the protocol that this reader does not support.
    UnknownFlags(u8),
}

/// Returns the packet of MAVLink 1 or 2 at the start of `bytes`, or the number of bytes to skip.
///
/// ```
/// use flagred_flightlog::mavlink::{PacketScan, SkipReason, next_packet};
///
/// let heartbeat = [
///     0xfe, 9, 0, 1, 1, 0, 0, 0, 0, 0, 2, 3, 81, 3, 3, 0x78, 0x51,
/// ];
/// let PacketScan::Packet(packet) = next_packet(&heartbeat) else { panic!() };
/// assert_eq!((packet.system, packet.component, packet.id), (1, 1, 0));
/// assert_eq!(next_packet(b"hello"), PacketScan::Skip(5, SkipReason::NoPacket));
/// assert_eq!(next_packet(&heartbeat[..12]), PacketScan::More);
/// ```
pub fn next_packet(bytes: &[u8]) -> PacketScan<'_> {
    let Some(garbage) = bytes.iter().position(|byte| MARKERS.contains(byte)) else {
        return match bytes.len() {
            0 => PacketScan::More,
            length => PacketScan::Skip(length, SkipReason::NoPacket),
        };
    };
    if garbage > 0 {
        return PacketScan::Skip(garbage, SkipReason::NoPacket);
    }
    match start(bytes) {
        Start::Whole(packet) => match packet.sound {
            Some(true) => PacketScan::Packet(packet),
            Some(false) => PacketScan::Skip(1, SkipReason::Checksum),
            // The length of an unverified packet is credible only if another packet, or nothing, follows.
            None => match bytes.get(packet.bytes.len()) {
                Some(byte) if !MARKERS.contains(byte) => PacketScan::Skip(1, SkipReason::NoPacket),
                _ => PacketScan::Unverified(packet),
            },
        },
        Start::Part => PacketScan::More,
        Start::Flags(flags) => PacketScan::Skip(1, SkipReason::UnknownFlags(flags)),
        Start::Other => PacketScan::Skip(1, SkipReason::NoPacket),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A heartbeat of version 1 as packed by pymavlink 2.4.50: system 1, component 1, quadrotor, ArduPilot, armed, mode
    /// 5, active.
    const HEARTBEAT: [u8; 17] = [
        0xfe, 0x09, 0x00, 0x01, 0x01, 0x00, 0x05, 0x00, 0x00, 0x00, 0x02, 0x03, 0x81, 0x04, 0x03,
        0xbe, 0xb9,
    ];

    #[test]
    fn a_heartbeat_is_valid_and_a_damaged_one_is_not() {
        let packet = Packet::at(&HEARTBEAT).unwrap();
        assert_eq!((packet.system, packet.component, packet.id), (1, 1, 0));
        assert_eq!((packet.bytes.len(), packet.sound), (17, Some(true)));
        let mut damaged = HEARTBEAT;
        damaged[9] ^= 1;
        assert_eq!(Packet::at(&damaged).unwrap().sound, Some(false));
        assert_eq!(Packet::at(&HEARTBEAT[..16]), None);
        assert_eq!(Packet::at(&HEARTBEAT[1..]), None);
    }
}

#[cfg(all(test, feature = "mavlink"))]
mod round_trips {
    use proptest::prelude::*;

    use super::super::{
        Sender,
        dialect::{MavMessage, NAMED_VALUE_FLOAT_DATA},
    };
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
            let PacketScan::Packet(packet) = next_packet(&bytes) else {
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
    fn one_wrong_bit_invalidates_a_packet() {
        for version in [Version::V1, Version::V2] {
            let bytes = risk(version);
            for bit in 0..bytes.len() * 8 {
                let mut damaged = bytes.clone();
                damaged[bit / 8] ^= 1 << (bit % 8);
                assert!(
                    !matches!(next_packet(&damaged), PacketScan::Packet(_)),
                    "bit {bit} of {version:?}"
                );
            }
        }
    }

    #[test]
    fn a_partial_packet_requires_more_bytes() {
        let bytes = risk(Version::V2);
        for end in 0..bytes.len() {
            assert_eq!(next_packet(&bytes[..end]), PacketScan::More, "{end} bytes");
        }
    }

    proptest! {
        /// For any input, every step consumes at least one byte or requests more bytes, and never panics.
        #[test]
        fn any_bytes_are_accepted(bytes in prop::collection::vec(prop_oneof![Just(0xfd), Just(0xfe), any::<u8>()], 0..600)) {
            let mut at = 0;
            loop {
                match next_packet(&bytes[at..]) {
                    PacketScan::Packet(packet) | PacketScan::Unverified(packet) => at += packet.bytes.len(),
                    PacketScan::Skip(count, _) => {
                        prop_assert!(count > 0);
                        at += count;
                    }
                    PacketScan::More => break,
                }
                prop_assert!(at <= bytes.len());
            }
        }
    }
}
