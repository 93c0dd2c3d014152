//! Signatures of MAVLink 2 packets (<https://mavlink.io/en/guide/message_signing.html>).

use std::{fmt, sync::Arc};

use ::mavlink::{MAVLinkV2MessageRaw, SigningConfig, SigningData};

use super::Packet;

/// The length of a key in bytes.
const BYTES: usize = 32;

/// The secret key that a vehicle shares with its ground stations, and the timestamps received and sent so far. Clones
/// share both.
///
/// A packet is genuine if its signature is valid and its timestamp is later than that of the previous packet from the
/// same system, component and link. The first packet may be up to a minute behind the clock of this machine.
///
/// # Example
/// ```
/// use flagred_flightlog::mavlink::{Key, Sender, Stream, Version, dialect::{HEARTBEAT_DATA, MavMessage}};
///
/// let key = Key::from_bytes("42".repeat(32).as_bytes()).unwrap();
/// let mut vehicle = Sender::new(1).signed(key);
/// let packet = vehicle.packet(Version::V2, 1, &MavMessage::HEARTBEAT(HEARTBEAT_DATA::default()));
///
/// let mut stream = Stream::with_key(Key::from_bytes(&[0x42; 32]).unwrap());
/// stream.push(&packet);
/// assert!(stream.packet().is_some());
/// stream.push(&packet); // once more: a replay
/// assert!(stream.packet().is_none());
/// assert_eq!(stream.skipped().bad_signatures, 1);
/// ```
#[derive(Clone)]
pub struct Key(Arc<SigningData>);

impl Key {
    /// Creates a key from 32 bytes, or from 64 hexadecimal digits with optional white space around them; `None` for
    /// anything else.
    pub fn from_bytes(bytes: &[u8]) -> Option<Key> {
        let secret = match <[u8; BYTES]>::try_from(bytes) {
            Ok(secret) => secret,
            Err(_) => hexadecimal(bytes.trim_ascii())?,
        };
        let config = SigningConfig::new(secret, 0, true, false);
        Some(Key(Arc::new(SigningData::from_config(config))))
    }

    /// Whether a packet is signed with this key, and is not a replay.
    pub(super) fn verify(&self, packet: &Packet<'_>) -> bool {
        let mut raw = MAVLinkV2MessageRaw::new();
        let bytes = raw.as_mut_slice().get_mut(..packet.bytes.len());
        packet.is_signed
            && bytes.is_some_and(|bytes| {
                bytes.copy_from_slice(packet.bytes);
                true
            })
            && self.0.verify_signature(&raw)
    }

    pub(super) fn sign(&self, packet: &mut MAVLinkV2MessageRaw) {
        self.0.sign_message(packet);
    }
}

/// Does not show the secret.
impl fmt::Debug for Key {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Key(..)")
    }
}

fn hexadecimal(digits: &[u8]) -> Option<[u8; BYTES]> {
    if digits.len() != 2 * BYTES {
        return None;
    }
    let mut secret = [0; BYTES];
    for (byte, pair) in secret.iter_mut().zip(digits.chunks_exact(2)) {
        for &digit in pair {
            let digit = char::from(digit).to_digit(16)?;
            *byte = *byte << 4 | digit as u8;
        }
    }
    Some(secret)
}

#[cfg(test)]
mod tests {
    use super::super::{
        Sender, Stream, Version,
        dialect::{HEARTBEAT_DATA, MavMessage},
    };
    use super::*;

    fn heartbeat() -> MavMessage {
        MavMessage::HEARTBEAT(HEARTBEAT_DATA::default())
    }

    /// The numbers of accepted, unsigned and not genuine packets.
    fn taken<'a>(packets: impl IntoIterator<Item = &'a [u8]>) -> (usize, u64, u64) {
        let mut stream = Stream::with_key(Key::from_bytes(&[7; 32]).unwrap());
        let mut count = 0;
        for packet in packets {
            stream.push(packet);
            while stream.packet().is_some() {
                count += 1;
            }
        }
        let skipped = stream.skipped();
        (count, skipped.unsigned, skipped.bad_signatures)
    }

    #[test]
    fn keys_are_bytes_or_digits() {
        assert!(Key::from_bytes(&[0; 32]).is_some());
        assert!(Key::from_bytes(format!("{}\n", "aB".repeat(32)).as_bytes()).is_some());
        for wrong in [&b""[..], &[0; 31], &[0; 33], &[b'a'; 63], &[b'g'; 64]] {
            assert!(Key::from_bytes(wrong).is_none(), "{wrong:?}");
        }
        assert_eq!(format!("{:?}", Key::from_bytes(&[7; 32])), "Some(Key(..))");
    }

    #[test]
    fn packets_are_accepted_only_if_signed_and_only_once() {
        let mut genuine = Sender::new(1).signed(Key::from_bytes(&[7; 32]).unwrap());
        let mut foreign = Sender::new(1).signed(Key::from_bytes(&[8; 32]).unwrap());
        let first = genuine.packet(Version::V2, 1, &heartbeat());
        // A signed packet has version 2, whichever version the vehicle uses.
        let second = genuine.packet(Version::V1, 1, &heartbeat());
        let wrong = foreign.packet(Version::V2, 1, &heartbeat());
        let unsigned =
            [Version::V1, Version::V2].map(|v| Sender::new(1).packet(v, 1, &heartbeat()));
        assert_eq!(taken([&first[..], &second]), (2, 0, 0));
        assert_eq!(taken([&second[..], &first, &second]), (1, 0, 2), "replays");
        assert_eq!(taken([&wrong[..], &first]), (1, 0, 1));
        assert_eq!(taken([&unsigned[0][..], &unsigned[1], &first]), (1, 2, 0));
    }

    #[test]
    fn one_wrong_bit_invalidates_a_signature() {
        let key = Key::from_bytes(&[7; 32]).unwrap();
        let packet = Sender::new(1)
            .signed(key)
            .packet(Version::V2, 1, &heartbeat());
        for bit in 0..packet.len() * 8 {
            let mut damaged = packet.clone();
            damaged[bit / 8] ^= 1 << (bit % 8);
            assert_eq!(taken([&damaged[..]]).0, 0, "bit {bit}");
        }
    }
}
