//! ULog is self-describing: definitions determine the positions of the fields of a topic.

use std::collections::HashMap;

use crate::field::{NumberType, NumericField};

/// The maximum depth of nested topics; deeper nesting counts as damage.
const DEEPEST: usize = 8;
/// The maximum length of a message, which is stored in 16 bits.
const LONGEST: usize = u16::MAX as usize;
/// The maximum number of fields of a topic, including nested topics; PX4's topics have under 200. It bounds the time
/// for nested definitions.
const MAX_FIELDS: usize = 1024;
/// The maximum size of all definitions in bytes; the definitions of PX4 have less than a quarter of this size.
const MAX_BYTES: usize = 1_000_000;

/// One field of a topic.
#[derive(Debug, Clone, PartialEq)]
struct Member {
    kind: String,
    count: usize,
    name: String,
}

/// All definitions of a log.
#[derive(Debug, Default)]
pub(super) struct Formats {
    topics: HashMap<String, Vec<Member>>,
    bytes: usize,
}

/// The number type with the given name.
fn kind_of(name: &str) -> Option<NumberType> {
    Some(match name {
        "int8_t" => NumberType::I8,
        "uint8_t" | "bool" | "char" => NumberType::U8,
        "int16_t" => NumberType::I16,
        "uint16_t" => NumberType::U16,
        "int32_t" => NumberType::I32,
        "uint32_t" => NumberType::U32,
        "int64_t" => NumberType::I64,
        "uint64_t" => NumberType::U64,
        "float" => NumberType::F32,
        "double" => NumberType::F64,
        _ => return None,
    })
}

/// The name in a typed key such as `float MPC_THR_HOVER`, and the number in `value`.
pub(super) fn keyed_number<'k>(key: &'k str, value: &[u8]) -> Option<(&'k str, f64)> {
    let (kind, name) = key.split_once(' ')?;
    let field = NumericField {
        offset: 0,
        kind: kind_of(kind)?,
    };
    Some((name, field.number(value)?))
}

impl Formats {
    /// Adds a definition, `name:type field;type field;...`. The first definition of a name is used.
    pub(super) fn define(&mut self, text: &str) -> Result<(), &'static str> {
        const INVALID: &str = "a definition that is not valid";
        let (name, fields) = text.split_once(':').ok_or(INVALID)?;
        if self.topics.contains_key(name) {
            return Ok(());
        }
        if self.bytes + text.len() > MAX_BYTES {
            return Err("definitions of more than 1 MB in all");
        }
        let fields = fields
            .split(';')
            .filter(|field| !field.is_empty())
            .map(member)
            .collect::<Option<Vec<Member>>>()
            .ok_or(INVALID)?;
        self.bytes += text.len();
        self.topics.insert(name.to_owned(), fields);
        Ok(())
    }

    /// The size of a topic as it is logged, in bytes: with padding, except for padding at its end.
    pub(super) fn logged_size(&self, topic: &str) -> Option<usize> {
        let fields = self.topics.get(topic)?;
        let padding = |field: &&Member| field.name.starts_with("_padding");
        let end = fields.iter().rev().take_while(padding).count();
        let mut left = MAX_FIELDS;
        self.size_of(fields.get(..fields.len() - end)?, DEEPEST, &mut left)
    }

    /// The size of these fields; `left` is the number of fields that may still be visited.
    fn size_of(&self, fields: &[Member], depth: usize, left: &mut usize) -> Option<usize> {
        fields.iter().try_fold(0_usize, |size, field| {
            let one = self.field_size(field, depth, left)?;
            let size = size.checked_add(one.checked_mul(field.count)?)?;
            (size <= LONGEST).then_some(size)
        })
    }

    /// The size of one element of a field in bytes.
    fn field_size(&self, field: &Member, depth: usize, left: &mut usize) -> Option<usize> {
        *left = left.checked_sub(1)?;
        if let Some(kind) = kind_of(&field.kind) {
            return Some(kind.width());
        }
        let nested = self.topics.get(&field.kind)?;
        self.size_of(nested, depth.checked_sub(1)?, left)
    }

    /// The position, in a topic, of the field `name`, which may have an index as in `q[2]`.
    pub(super) fn field(&self, topic: &str, name: &str) -> Option<NumericField> {
        let (name, index) = match name.split_once('[') {
            Some((name, index)) => (name, index.strip_suffix(']')?.parse().ok()?),
            None => (name, 0_usize),
        };
        let mut offset = 0;
        let mut left = MAX_FIELDS;
        for field in self.topics.get(topic)? {
            let size = self.field_size(field, DEEPEST, &mut left)?;
            if field.name == name {
                let kind = kind_of(&field.kind)?;
                return (index < field.count).then_some(NumericField {
                    offset: offset + index * size,
                    kind,
                });
            }
            offset += size.checked_mul(field.count)?;
        }
        None
    }
}

/// Parses `type name` or `type[count] name`.
fn member(text: &str) -> Option<Member> {
    let (kind, name) = text.trim().split_once(' ')?;
    let (kind, count) = match kind.split_once('[') {
        Some((kind, count)) => (kind, count.strip_suffix(']')?.parse().ok()?),
        None => (kind, 1),
    };
    Some(Member {
        kind: kind.into(),
        count,
        name: name.trim().into(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn formats() -> Formats {
        let mut formats = Formats::default();
        for text in [
            "esc:uint64_t timestamp;float rpm;uint8_t[4] _padding0",
            "all:uint64_t timestamp;esc[2] esc;float[4] q;bool landed;uint8_t[7] _padding0;",
        ] {
            formats.define(text).unwrap();
        }
        formats
    }

    #[test]
    fn fields_follow_nested_topics() {
        let formats = formats();
        assert_eq!(formats.logged_size("all"), Some(8 + 2 * 16 + 16 + 1));
        assert_eq!(formats.logged_size("esc"), Some(12));
        let field = formats.field("all", "q[2]").unwrap();
        assert_eq!(field.offset, 8 + 32 + 8);
        let mut message = vec![0; 57];
        message[48..52].copy_from_slice(&1.5_f32.to_le_bytes());
        assert_eq!(field.number(&message), Some(1.5));
        assert_eq!(field.number(&message[..50]), None);
        assert_eq!(formats.field("all", "q[4]"), None);
        assert_eq!(formats.field("all", "esc"), None);
    }

    #[test]
    fn damaged_definitions_are_refused() {
        let mut formats = formats();
        for text in ["no colon", "a:float", "a:float[x] b", "a:float[3 b"] {
            assert!(formats.define(text).is_err(), "{text}");
        }
        formats.define("loop:loop inner").unwrap();
        assert!(
            formats
                .define("huge:float[99999999999999999999] x")
                .is_err()
        );
        // Without a limit, computing the size of the last topic would take a week.
        formats.define("deep0:float[0] x").unwrap();
        for depth in 1..=8 {
            let inner = format!("deep{} x;", depth - 1).repeat(1000);
            formats.define(&format!("deep{depth}:{inner}")).unwrap();
        }
        assert!(
            formats
                .define(&format!("much:{}", "float x;".repeat(125_000)))
                .is_err()
        );
        formats.define("wide:double[1000000] x").unwrap();
        for topic in ["loop", "wide", "deep8", "unknown"] {
            assert_eq!(formats.logged_size(topic), None, "{topic}");
        }
    }
}
