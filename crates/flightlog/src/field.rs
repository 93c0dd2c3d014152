//! Numeric fields of messages; all formats here are little-endian.

/// Offset and type of a numeric field.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct NumericField {
    pub(crate) offset: usize,
    pub(crate) kind: NumberType,
}

/// Types of numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum NumberType {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
}

impl NumberType {
    /// The size in bytes.
    pub(crate) fn width(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }
}

impl NumericField {
    /// The number in `message`; `None` if the message is too short.
    pub(crate) fn number(self, message: &[u8]) -> Option<f64> {
        let bytes = message.get(self.offset..)?;
        Some(match self.kind {
            NumberType::I8 => f64::from(i8::from_le_bytes(*bytes.first_chunk()?)),
            NumberType::U8 => f64::from(*bytes.first()?),
            NumberType::I16 => f64::from(i16::from_le_bytes(*bytes.first_chunk()?)),
            NumberType::U16 => f64::from(u16::from_le_bytes(*bytes.first_chunk()?)),
            NumberType::I32 => f64::from(i32::from_le_bytes(*bytes.first_chunk()?)),
            NumberType::U32 => f64::from(u32::from_le_bytes(*bytes.first_chunk()?)),
            NumberType::I64 => i64::from_le_bytes(*bytes.first_chunk()?) as f64,
            NumberType::U64 => u64::from_le_bytes(*bytes.first_chunk()?) as f64,
            NumberType::F32 => f64::from(f32::from_le_bytes(*bytes.first_chunk()?)),
            NumberType::F64 => f64::from_le_bytes(*bytes.first_chunk()?),
        })
    }
}

/// The length of the vector of these numbers; `None` if one is missing.
pub(crate) fn vector_length(numbers: impl Iterator<Item = Option<f64>>) -> Option<f64> {
    let squares = numbers.map(|number| number.map(|x| x * x));
    squares.sum::<Option<f64>>().map(f64::sqrt)
}
