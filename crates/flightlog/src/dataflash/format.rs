//! DataFlash is self-describing: FMT records define the other messages.

use std::borrow::Cow;

use crate::field::{NumberType, NumericField};

/// Type of the FMT records themselves.
pub(crate) const FMT: u8 = 128;

/// One field of a message.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Column {
    pub(crate) label: String,
    /// The letter of the field's type.
    pub(crate) kind: u8,
    /// The position and type of the number in the payload of a binary record.
    field: NumericField,
}

/// The definition of a message type by its FMT record.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Format {
    pub(crate) type_id: u8,
    /// The length of a binary record in bytes, including its header of three bytes.
    pub(crate) length: usize,
    pub(crate) name: String,
    pub(crate) columns: Vec<Column>,
    /// Whether the lengths of the fields and of the record differ, so that offsets may be wrong.
    pub(crate) damaged: bool,
}

impl Format {
    pub(crate) fn new(type_id: u8, length: usize, name: &str, kinds: &str, labels: &str) -> Self {
        let mut offset = 0;
        let columns = kinds
            .bytes()
            // The fields after one of unknown type have unknown offsets.
            .take_while(|kind| width(*kind) > 0)
            .zip(labels.split(','))
            .map(|(kind, label)| {
                let column = Column {
                    label: label.trim().into(),
                    kind,
                    field: NumericField {
                        offset,
                        kind: number_of(kind).0,
                    },
                };
                offset += width(kind);
                column
            })
            .collect();
        Self {
            type_id,
            length,
            name: name.into(),
            columns,
            damaged: false,
        }
    }

    /// The format that the payload of a binary FMT record describes; `None` if its length is impossible.
    pub(crate) fn from_payload(payload: &[u8]) -> Option<Self> {
        let (&[type_id, length], rest) = payload.split_first_chunk()?;
        let (name, rest) = rest.split_first_chunk::<4>()?;
        let (kinds, rest) = rest.split_first_chunk::<16>()?;
        let labels = rest.get(..64)?;
        let kinds = ascii(kinds)?;
        let mut format = Self::new(
            type_id,
            length.into(),
            &ascii(name)?,
            &kinds,
            &ascii(labels)?,
        );
        let filled = 3 + kinds.bytes().map(width).sum::<usize>();
        let all_known = kinds.bytes().all(|kind| width(kind) > 0);
        format.damaged = all_known && format.length != filled;
        (format.length >= filled).then_some(format)
    }

    /// Whether a column has one of these types.
    pub(crate) fn has_kind(&self, column: usize, kinds: &[u8]) -> bool {
        let described = self.columns.get(column);
        described.is_some_and(|described| kinds.contains(&described.kind))
    }

    /// The index of the first of `labels` that the message has.
    pub(crate) fn column(&self, labels: &[&str]) -> Option<usize> {
        labels
            .iter()
            .find_map(|label| self.columns.iter().position(|c| c.label == *label))
    }
}

/// The size of a field type in bytes; 0 for an unknown letter.
fn width(kind: u8) -> usize {
    match kind {
        b'b' | b'B' | b'M' => 1,
        b'h' | b'H' | b'c' | b'C' | b'g' => 2,
        b'i' | b'I' | b'f' | b'e' | b'E' | b'L' | b'n' => 4,
        b'd' | b'q' | b'Q' => 8,
        b'N' => 16,
        b'Z' | b'a' => 64,
        _ => 0,
    }
}

/// The text up to the first zero; `None` if it is not printable ASCII and therefore not part of a definition.
fn ascii(bytes: &[u8]) -> Option<Cow<'_, str>> {
    let text = bytes.split(|&byte| byte == 0).next()?;
    let printable = text.iter().all(|byte| (b' '..=b'~').contains(byte));
    printable.then(|| String::from_utf8_lossy(text))
}

/// The fields of one message, in either encoding.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Cells<'a> {
    /// The payload of a binary record, after its header.
    Binary(&'a [u8]),
    /// The fields of a text line, after its name.
    Text(&'a [&'a str]),
}

impl Cells<'_> {
    /// The number in a column, scaled to its unit; `None` if it is not a number.
    pub(crate) fn number(&self, format: &Format, column: usize) -> Option<f64> {
        let described = format.columns.get(column)?;
        match self {
            Self::Binary(payload) => {
                let is_number = !matches!(described.kind, b'n' | b'N' | b'Z' | b'a' | b'g');
                let number = described.field.number(payload).filter(|_| is_number)?;
                Some(number * number_of(described.kind).1)
            }
            Self::Text(cells) => cells.get(column)?.parse().ok(),
        }
    }

    /// The text in a column.
    pub(crate) fn text(&self, format: &Format, column: usize) -> Option<String> {
        let described = format.columns.get(column)?;
        match self {
            Self::Binary(payload) => {
                if !matches!(described.kind, b'n' | b'N' | b'Z') {
                    return None;
                }
                let end = described.field.offset + width(described.kind);
                let bytes = payload.get(described.field.offset..end)?;
                let text = bytes.split(|&byte| byte == 0).next()?;
                Some(String::from_utf8_lossy(text).trim().to_owned())
            }
            Self::Text(cells) => {
                // A text in the last column may contain commas.
                let to = match column + 1 == format.columns.len() {
                    true => cells.len(),
                    false => column + 1,
                };
                Some(cells.get(column..to)?.join(",").trim().to_owned())
            }
        }
    }
}

/// The number type of a letter, and its unit.
fn number_of(kind: u8) -> (NumberType, f64) {
    match kind {
        b'b' => (NumberType::I8, 1.0),
        b'h' => (NumberType::I16, 1.0),
        b'H' => (NumberType::U16, 1.0),
        b'c' => (NumberType::I16, 0.01),
        b'C' => (NumberType::U16, 0.01),
        b'i' => (NumberType::I32, 1.0),
        b'I' => (NumberType::U32, 1.0),
        b'e' => (NumberType::I32, 0.01),
        b'E' => (NumberType::U32, 0.01),
        b'L' => (NumberType::I32, 1e-7),
        b'f' => (NumberType::F32, 1.0),
        b'd' => (NumberType::F64, 1.0),
        b'q' => (NumberType::I64, 1.0),
        b'Q' => (NumberType::U64, 1.0),
        // B, M, and types that are not numbers: see `Cells::number`.
        _ => (NumberType::U8, 1.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_have_the_offsets_of_their_types() {
        let format = Format::new(200, 3 + 8 + 2 + 4, "TEST", "QcL", "TimeUS,A,Lat");
        let mut payload = 1_500_000_u64.to_le_bytes().to_vec();
        payload.extend((-1234_i16).to_le_bytes());
        payload.extend(123_456_789_i32.to_le_bytes());
        let cells = Cells::Binary(&payload);
        assert_eq!(cells.number(&format, 0), Some(1_500_000.0));
        assert_eq!(cells.number(&format, 1), Some(-12.34));
        assert_eq!(cells.number(&format, 2), Some(12.345_678_9));
        assert_eq!(cells.number(&format, 3), None);
        assert_eq!(Cells::Binary(&payload[..9]).number(&format, 1), None);
    }

    #[test]
    fn a_definition_shorter_than_its_fields_is_refused() {
        let mut payload = vec![200, 12];
        for (text, width) in [("TEST", 4), ("QQ", 16), ("TimeUS,A", 64)] {
            payload.extend(text.bytes().chain(std::iter::repeat(0)).take(width));
        }
        assert_eq!(Format::from_payload(&payload), None);
        for (length, damaged) in [(19, false), (20, true)] {
            payload[1] = length;
            let format = Format::from_payload(&payload).unwrap();
            assert_eq!((format.columns.len(), format.damaged), (2, damaged));
        }
        payload[7] = b'?';
        let format = Format::from_payload(&payload).unwrap();
        assert_eq!((format.columns.len(), format.damaged), (1, false));
    }
}
