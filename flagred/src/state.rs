//! The state of a flight as bytes. The results of a monitor that is restored from them are bit for bit those of
//! the original monitor.
//!
//! The rules are not part of the state: they come from the estimator of the new monitor.

use alloc::{collections::VecDeque, string::String, vec::Vec};

use fuzzy::engine::Interval;

/// The version of the layout. Raise it when a type below gets or loses a field.
pub(crate) const VERSION: u32 = 3;

const NAME: &[u8] = b"flagred state ";

/// The reason why the state of a flight cannot be restored.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum StateError {
    /// The bytes are not the state of a flight, or they are damaged.
    #[error("the bytes are not the state of a flight, or they are damaged")]
    Damaged,
    /// The state has the layout of another version.
    #[error(
        "the state has version {found}, but this version of flagred reads version {VERSION}: end the flight with the \
         version that saved its state"
    )]
    Version {
        /// The version of the state.
        found: u32,
    },
    /// The state was saved with another profile, another rule set or another craft.
    #[error("the state belongs to another profile, rule set or craft")]
    OtherMonitor,
}

/// A value that is part of the state.
pub(crate) trait State: Sized {
    /// Appends the value.
    fn save(&self, to: &mut Vec<u8>);

    /// Reads the value; `None` if there are too few bytes, or if the bytes do not represent a value of this type.
    fn load(from: &mut Reader<'_>) -> Option<Self>;
}

/// The bytes that are left to read.
pub(crate) struct Reader<'a> {
    bytes: &'a [u8],
}

impl Reader<'_> {
    fn take(&mut self, count: usize) -> Option<&[u8]> {
        let (taken, left) = self.bytes.split_at_checked(count)?;
        self.bytes = left;
        Some(taken)
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.bytes.is_empty()
    }
}

/// Begins a state that belongs to a monitor with this description.
pub(crate) fn begin(description: &str) -> Vec<u8> {
    let mut bytes = NAME.to_vec();
    VERSION.save(&mut bytes);
    checksum(description.as_bytes()).save(&mut bytes);
    bytes
}

/// Ends a state with its checksum.
pub(crate) fn end(bytes: &mut Vec<u8>) {
    checksum(bytes).save(bytes);
}

/// Checks that the bytes are the state of a monitor with this description, and returns a reader of the values in it.
pub(crate) fn open<'a>(bytes: &'a [u8], description: &str) -> Result<Reader<'a>, StateError> {
    let bytes = bytes.strip_prefix(NAME).ok_or(StateError::Damaged)?;
    let mut from = Reader { bytes };
    let found = u32::load(&mut from).ok_or(StateError::Damaged)?;
    if found != VERSION {
        return Err(StateError::Version { found });
    }
    let of = u64::load(&mut from).ok_or(StateError::Damaged)?;
    let (state, end) = from.bytes.split_last_chunk().ok_or(StateError::Damaged)?;
    let header = bytes.len() - from.bytes.len();
    let whole = [NAME, bytes.get(..header + state.len()).unwrap_or_default()].concat();
    if checksum(&whole) != u64::from_le_bytes(*end) {
        return Err(StateError::Damaged);
    }
    if of != checksum(description.as_bytes()) {
        return Err(StateError::OtherMonitor);
    }
    from.bytes = state;
    Ok(from)
}

/// The FNV-1a hash, which detects accidental changes.
fn checksum(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xCBF2_9CE4_8422_2325, |sum, byte| {
        (sum ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01B3)
    })
}

/// Implements [`State`] for structs by their fields, and for enums by their numbered variants.
macro_rules! state {
    ($(struct $type:ident { $($field:ident),* })*) => {$(
        impl $crate::state::State for $type {
            fn save(&self, to: &mut alloc::vec::Vec<u8>) {
                let $type { $($field),* } = self;
                $($crate::state::State::save($field, to);)*
            }

            fn load(from: &mut $crate::state::Reader<'_>) -> Option<Self> {
                Some($type { $($field: $crate::state::State::load(from)?),* })
            }
        }
    )*};
    (enum $type:ident { $($number:literal = $variant:ident { $($field:ident),* }),* }) => {
        impl $crate::state::State for $type {
            fn save(&self, to: &mut alloc::vec::Vec<u8>) {
                match self {
                    $($type::$variant { $($field),* } => {
                        to.push($number);
                        $($crate::state::State::save($field, to);)*
                    })*
                }
            }

            fn load(from: &mut $crate::state::Reader<'_>) -> Option<Self> {
                match <u8 as $crate::state::State>::load(from)? {
                    $($number => Some($type::$variant { $($field: $crate::state::State::load(from)?),* }),)*
                    _ => None,
                }
            }
        }
    };
}

macro_rules! numbers {
    ($($number:ident)*) => {$(
        impl State for $number {
            fn save(&self, to: &mut Vec<u8>) {
                to.extend_from_slice(&self.to_le_bytes());
            }

            fn load(from: &mut Reader<'_>) -> Option<$number> {
                let bytes = from.take(size_of::<$number>())?;
                Some($number::from_le_bytes(bytes.try_into().ok()?))
            }
        }
    )*};
}

numbers! { u8 u32 u64 f64 }

impl State for usize {
    fn save(&self, to: &mut Vec<u8>) {
        (*self as u64).save(to);
    }

    fn load(from: &mut Reader<'_>) -> Option<usize> {
        u64::load(from)?.try_into().ok()
    }
}

impl State for bool {
    fn save(&self, to: &mut Vec<u8>) {
        to.push(u8::from(*self));
    }

    fn load(from: &mut Reader<'_>) -> Option<bool> {
        match u8::load(from)? {
            0 => Some(false),
            1 => Some(true),
            _ => None,
        }
    }
}

impl<T: State> State for Option<T> {
    fn save(&self, to: &mut Vec<u8>) {
        self.is_some().save(to);
        if let Some(value) = self {
            value.save(to);
        }
    }

    fn load(from: &mut Reader<'_>) -> Option<Option<T>> {
        match bool::load(from)? {
            true => Some(Some(T::load(from)?)),
            false => Some(None),
        }
    }
}

impl<A: State, B: State> State for (A, B) {
    fn save(&self, to: &mut Vec<u8>) {
        self.0.save(to);
        self.1.save(to);
    }

    fn load(from: &mut Reader<'_>) -> Option<(A, B)> {
        Some((A::load(from)?, B::load(from)?))
    }
}

impl<T: State, const N: usize> State for [T; N] {
    fn save(&self, to: &mut Vec<u8>) {
        self.iter().for_each(|value| value.save(to));
    }

    fn load(from: &mut Reader<'_>) -> Option<[T; N]> {
        let all: Option<Vec<T>> = (0..N).map(|_| T::load(from)).collect();
        all?.try_into().ok()
    }
}

impl<T: State> State for Vec<T> {
    fn save(&self, to: &mut Vec<u8>) {
        self.len().save(to);
        self.iter().for_each(|value| value.save(to));
    }

    fn load(from: &mut Reader<'_>) -> Option<Vec<T>> {
        let count = usize::load(from)?;
        // Each element takes at least one byte, so if the count is wrong, reading fails at the end of the bytes at the
        // latest.
        (0..count).map(|_| T::load(from)).collect()
    }
}

impl<T: State> State for VecDeque<T> {
    fn save(&self, to: &mut Vec<u8>) {
        self.len().save(to);
        self.iter().for_each(|value| value.save(to));
    }

    fn load(from: &mut Reader<'_>) -> Option<VecDeque<T>> {
        Vec::load(from).map(VecDeque::from)
    }
}

impl State for String {
    fn save(&self, to: &mut Vec<u8>) {
        self.len().save(to);
        to.extend_from_slice(self.as_bytes());
    }

    fn load(from: &mut Reader<'_>) -> Option<String> {
        let count = usize::load(from)?;
        let text = core::str::from_utf8(from.take(count)?).ok()?;
        Some(text.into())
    }
}

state! { struct Interval { low, high } }
