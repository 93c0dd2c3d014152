//! Checks of messages against the topics that the log has announced.

use super::format::Formats;
use super::{HEAD, SYNC};

/// The topics of a log by the numbers in their messages.
#[derive(Default)]
pub(super) struct Topics {
    pub(super) formats: Formats,
    /// For each topic number, the length of its messages in bytes, including the number itself: 0 if it is unknown,
    /// `None` if the topic was not announced.
    lengths: Vec<Option<u16>>,
}

impl Topics {
    /// Assigns the number `id` to the topic `name` from now on.
    pub(super) fn announce(&mut self, id: u16, name: &str) {
        let index = usize::from(id);
        if self.lengths.len() <= index {
            self.lengths.resize(index + 1, None);
        }
        let length = self
            .formats
            .logged_size(name)
            .and_then(|size| u16::try_from(size + 2).ok());
        if let Some(slot) = self.lengths.get_mut(index) {
            *slot = Some(length.unwrap_or(0));
        }
    }

    /// The message at the start of `bytes` with its header, if these bytes can be a message; `None` for damage and for a
    /// message that is cut off.
    pub(super) fn message<'a>(&self, bytes: &'a [u8]) -> Option<&'a [u8]> {
        let length = self.length(bytes)?;
        let message = bytes.get(..length)?;
        let rest = &bytes[length..];
        if self.exact(message) || rest.is_empty() || self.may_start(rest) {
            return Some(message);
        }
        None
    }

    /// Whether a message starts here that is (almost) certainly not damaged.
    pub(super) fn certain(&self, bytes: &[u8]) -> bool {
        let Some(message) = self.length(bytes).and_then(|length| bytes.get(..length)) else {
            return false;
        };
        let rest = &bytes[message.len()..];
        self.exact(message) && (rest.is_empty() || self.may_start(rest))
    }

    /// The length of the message that starts here, including its header, if its letter and length are consistent.
    fn length(&self, bytes: &[u8]) -> Option<usize> {
        let &[low, high, letter] = bytes.first_chunk()?;
        let length = u16::from_le_bytes([low, high]);
        let fits = match letter {
            b'D' => match self.expected(bytes) {
                Some(0) => length >= 10,
                // Firmware before 1.8 also logs the padding at the end.
                Some(expected) => (expected..expected.saturating_add(8)).contains(&length),
                None => false,
            },
            b'B' => length >= 40,
            b'S' => length == 8,
            b'O' => length == 2,
            b'R' => length == 2,
            b'A' => (4..=300).contains(&length),
            b'L' | b'C' => (9..=1024).contains(&length),
            b'F' | b'I' | b'M' | b'P' | b'Q' => length >= 3,
            _ => false,
        };
        fits.then_some(HEAD + usize::from(length))
    }

    /// The length that the topic of a data message has: 0 if its definition is missing, `None` if it was not announced.
    fn expected(&self, bytes: &[u8]) -> Option<u16> {
        let &[.., low, high] = bytes.first_chunk::<5>()?;
        let id = usize::from(u16::from_le_bytes([low, high]));
        self.lengths.get(id).copied().flatten()
    }

    /// Whether another message may start here, as far as the available bytes show.
    fn may_start(&self, bytes: &[u8]) -> bool {
        bytes.len() < 5 || self.length(bytes).is_some()
    }

    /// Whether the body is also consistent with the letter.
    fn exact(&self, message: &[u8]) -> bool {
        let body = &message[HEAD..];
        match message[2] {
            b'D' => self.expected(message) == u16::try_from(body.len()).ok(),
            b'S' => body == SYNC,
            b'F' => body.iter().take(CHECKED).any(|&byte| byte == b':') && printable(body),
            b'A' => printable(&body[3..]),
            b'I' | b'P' => key(body).is_some(),
            b'M' | b'Q' => key(&body[1..]).is_some(),
            b'L' => printable(&body[9..]),
            _ => false,
        }
    }
}

/// The key of a body that starts with the length of the key, and the bytes after it.
pub(super) fn key(body: &[u8]) -> Option<(&str, &[u8])> {
    let (&length, rest) = body.split_first()?;
    let (key, value) = rest.split_at_checked(length.into())?;
    let key = std::str::from_utf8(key)
        .ok()
        .filter(|key| key.contains(' '))?;
    Some((key, value))
}

/// The maximum number of bytes of a text that are examined. It bounds the time for damaged data, in which every byte
/// may look like the beginning of a long message.
const CHECKED: usize = 64;

fn printable(text: &[u8]) -> bool {
    text.iter()
        .take(CHECKED)
        .all(|&byte| byte >= b' ' || byte.is_ascii_whitespace())
}
