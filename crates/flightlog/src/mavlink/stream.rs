//! Splits a stream of bytes into packets.

use super::{Packet, PacketScan, SkipReason, next_packet};

/// Counts of skipped data.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct SkipCounts {
    /// The number of bytes that are not part of a readable packet.
    pub bytes: u64,
    /// Packets with a wrong checksum, and bytes that only looked like the beginning of a packet.
    pub checksums: u64,
    /// Packets with an unknown message, which are returned unverified, or with an unsupported feature of the protocol,
    /// which are skipped.
    pub unknown: u64,
    /// Signed packets, which cannot be verified without the key.
    pub signed: u64,
    /// The number of unsigned packets, if there is a key.
    pub unsigned: u64,
    /// The number of packets with a wrong signature or an old timestamp, if there is a key.
    pub bad_signatures: u64,
}

impl SkipCounts {
    /// Whether nothing was skipped.
    pub fn is_empty(&self) -> bool {
        *self == SkipCounts::default()
    }
}

/// The reason why a whole packet is not accepted.
enum Refusal {
    /// The packet is signed, and there is no key.
    Signed,
    #[cfg(feature = "mavlink")]
    Unsigned,
    #[cfg(feature = "mavlink")]
    NotGenuine,
}

/// Splits bytes into packets as they arrive.
///
/// Its memory is bounded by the largest slice that was pushed plus one packet.
///
/// # Example: a packet that arrives in pieces
/// ```
/// let heartbeat = [0xfe, 9, 0, 1, 1, 0, 0, 0, 0, 0, 2, 3, 81, 3, 3, 0x78, 0x51];
/// let mut stream = flagred_flightlog::mavlink::Stream::new();
/// stream.push(b"noise");
/// stream.push(&heartbeat[..8]);
/// assert!(stream.packet().is_none());
/// stream.push(&heartbeat[8..]);
/// assert_eq!(stream.packet().map(|packet| packet.id), Some(0));
/// assert_eq!(stream.skipped().bytes, 5);
/// ```
#[derive(Debug, Clone, Default)]
pub struct Stream {
    buffer: Vec<u8>,
    taken: usize,
    skipped: SkipCounts,
    #[cfg(feature = "mavlink")]
    key: Option<super::Key>,
}

impl Stream {
    /// Creates a stream without any bytes.
    pub fn new() -> Stream {
        Stream::default()
    }

    /// Creates a stream that accepts only packets signed with `key`.
    #[cfg(feature = "mavlink")]
    pub fn with_key(key: super::Key) -> Stream {
        Stream {
            key: Some(key),
            ..Stream::default()
        }
    }

    /// Adds bytes that arrived.
    pub fn push(&mut self, bytes: &[u8]) {
        self.buffer.drain(..self.taken.min(self.buffer.len()));
        self.taken = 0;
        self.buffer.extend_from_slice(bytes);
    }

    /// Returns the next packet; `None` until more bytes arrive. Without a key, signed packets are counted and skipped;
    /// with a key, unsigned packets and packets that are not genuine are counted and skipped.
    ///
    /// A packet with an unknown message is returned as well, for recording. Its [`Packet::sound`] is `None`, because
    /// its checksum cannot be verified.
    pub fn packet(&mut self) -> Option<Packet<'_>> {
        let length = loop {
            match next_packet(self.buffer.get(self.taken..)?) {
                PacketScan::Packet(packet) | PacketScan::Unverified(packet) => {
                    let length = packet.bytes.len();
                    let is_unverified = packet.sound.is_none();
                    match self.refusal(&packet) {
                        None => {
                            self.skipped.unknown += u64::from(is_unverified);
                            break length;
                        }
                        Some(Refusal::Signed) => self.skipped.signed += 1,
                        #[cfg(feature = "mavlink")]
                        Some(Refusal::Unsigned) => self.skipped.unsigned += 1,
                        #[cfg(feature = "mavlink")]
                        Some(Refusal::NotGenuine) => self.skipped.bad_signatures += 1,
                    }
                    self.taken += length;
                }
                PacketScan::Skip(count, reason) => {
                    match reason {
                        SkipReason::NoPacket => {}
                        SkipReason::Checksum => self.skipped.checksums += 1,
                        SkipReason::UnknownFlags(_) => self.skipped.unknown += 1,
                    }
                    self.skipped.bytes += count as u64;
                    self.taken += count;
                }
                PacketScan::More => return None,
            }
        };
        let start = self.taken;
        self.taken += length;
        match next_packet(self.buffer.get(start..self.taken)?) {
            PacketScan::Packet(packet) | PacketScan::Unverified(packet) => Some(packet),
            _ => None,
        }
    }

    fn refusal(&self, packet: &Packet<'_>) -> Option<Refusal> {
        #[cfg(feature = "mavlink")]
        if let Some(key) = &self.key {
            return match packet.is_signed {
                false => Some(Refusal::Unsigned),
                true => (!key.verify(packet)).then_some(Refusal::NotGenuine),
            };
        }
        packet.is_signed.then_some(Refusal::Signed)
    }

    /// Ends a datagram: discards a partial packet.
    pub fn end(&mut self) {
        self.skipped.bytes += self.buffer.len().saturating_sub(self.taken) as u64;
        self.buffer.clear();
        self.taken = 0;
    }

    /// The counts of skipped data since the stream began.
    pub fn skipped(&self) -> SkipCounts {
        self.skipped
    }
}
