//! Conversion of a struct or map of numbers to named numbers, for `Engine::evaluate_struct`.

use alloc::{
    format,
    string::{String, ToString},
    vec::Vec,
};
use core::fmt;

use serde::{
    Serialize, Serializer,
    ser::{Error, Impossible, SerializeMap, SerializeStruct},
};

/// The error for a value that is not a struct or map of numbers.
#[derive(Debug)]
pub(crate) struct NoFields(pub(crate) String);

impl fmt::Display for NoFields {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl core::error::Error for NoFields {}

impl Error for NoFields {
    fn custom<T: fmt::Display>(message: T) -> Self {
        NoFields(message.to_string())
    }
}

/// A serializer that collects the fields of a struct or map.
#[derive(Default)]
pub(crate) struct Fields {
    found: Vec<(String, f64)>,
    key: String,
}

/// A serializer that accepts only a number or a missing value.
struct Number;
/// A serializer that accepts only a name.
struct Name;

/// Defines the methods of a serializer that reject the listed types.
macro_rules! refuse {
    ($what:literal: $($method:ident($($argument:ty),*))+) => {
        $(fn $method(self, $(_: $argument),*) -> Result<Self::Ok, NoFields> {
            Err(NoFields(format!("expected {}", $what)))
        })+
    };
    ($what:literal -> $($method:ident($($argument:ty),*) -> $compound:ident)+) => {
        $(fn $method(self, $(_: $argument),*) -> Result<Self::$compound, NoFields> {
            Err(NoFields(format!("expected {}", $what)))
        })+
    };
    ($what:literal of values) => {
        fn serialize_newtype_variant<T: Serialize + ?Sized>(
            self, _: &'static str, _: u32, _: &'static str, _: &T,
        ) -> Result<Self::Ok, NoFields> {
            Err(NoFields(format!("expected {}", $what)))
        }
        refuse!($what: serialize_bool(bool) serialize_bytes(&[u8])
            serialize_unit_struct(&'static str));
        refuse!($what -> serialize_seq(Option<usize>) -> SerializeSeq
            serialize_tuple(usize) -> SerializeTuple
            serialize_tuple_struct(&'static str, usize) -> SerializeTupleStruct
            serialize_tuple_variant(&'static str, u32, &'static str, usize) -> SerializeTupleVariant
            serialize_struct_variant(&'static str, u32, &'static str, usize) -> SerializeStructVariant);
        type Error = NoFields;
        type SerializeSeq = Impossible<Self::Ok, NoFields>;
        type SerializeTuple = Impossible<Self::Ok, NoFields>;
        type SerializeTupleStruct = Impossible<Self::Ok, NoFields>;
        type SerializeTupleVariant = Impossible<Self::Ok, NoFields>;
        type SerializeStructVariant = Impossible<Self::Ok, NoFields>;
    };
    (numbers $what:literal) => {
        refuse!($what: serialize_i8(i8) serialize_i16(i16) serialize_i32(i32) serialize_i64(i64)
            serialize_u8(u8) serialize_u16(u16) serialize_u32(u32) serialize_u64(u64)
            serialize_f32(f32) serialize_f64(f64));
    };
    (text $what:literal) => {
        refuse!($what: serialize_char(char) serialize_str(&str)
            serialize_unit_variant(&'static str, u32, &'static str));
    };
    (fields $what:literal) => {
        refuse!($what -> serialize_map(Option<usize>) -> SerializeMap
            serialize_struct(&'static str, usize) -> SerializeStruct);
        type SerializeMap = Impossible<Self::Ok, NoFields>;
        type SerializeStruct = Impossible<Self::Ok, NoFields>;
    };
}

/// Defines the methods of a serializer that unwrap transparent values.
macro_rules! look_inside {
    () => {
        fn serialize_some<T: Serialize + ?Sized>(self, value: &T) -> Result<Self::Ok, NoFields> {
            value.serialize(self)
        }
        fn serialize_newtype_struct<T: Serialize + ?Sized>(
            self,
            _: &'static str,
            value: &T,
        ) -> Result<Self::Ok, NoFields> {
            value.serialize(self)
        }
    };
}

impl Serializer for Fields {
    type Ok = Vec<(String, f64)>;
    type SerializeMap = Fields;
    type SerializeStruct = Fields;

    fn serialize_map(self, _: Option<usize>) -> Result<Fields, NoFields> {
        Ok(self)
    }

    fn serialize_struct(self, _: &'static str, _: usize) -> Result<Fields, NoFields> {
        Ok(self)
    }

    look_inside!();
    refuse!("a struct or map of numbers": serialize_none() serialize_unit());
    refuse!(numbers "a struct or map of numbers");
    refuse!(text "a struct or map of numbers");
    refuse!("a struct or map of numbers" of values);
}

impl SerializeMap for Fields {
    type Ok = Vec<(String, f64)>;
    type Error = NoFields;

    fn serialize_key<T: Serialize + ?Sized>(&mut self, key: &T) -> Result<(), NoFields> {
        self.key = key.serialize(Name)?;
        Ok(())
    }

    fn serialize_value<T: Serialize + ?Sized>(&mut self, value: &T) -> Result<(), NoFields> {
        let named = |why: NoFields| NoFields(format!("input `{}`: {}", self.key, why.0));
        if let Some(number) = value.serialize(Number).map_err(named)? {
            self.found.push((core::mem::take(&mut self.key), number));
        }
        Ok(())
    }

    fn end(self) -> Result<Self::Ok, NoFields> {
        Ok(self.found)
    }
}

impl SerializeStruct for Fields {
    type Ok = Vec<(String, f64)>;
    type Error = NoFields;

    fn serialize_field<T: Serialize + ?Sized>(
        &mut self,
        key: &'static str,
        value: &T,
    ) -> Result<(), NoFields> {
        self.serialize_entry(key, value)
    }

    fn end(self) -> Result<Self::Ok, NoFields> {
        Ok(self.found)
    }
}

macro_rules! take_numbers {
    ($($method:ident($number:ty))+) => {
        $(fn $method(self, number: $number) -> Result<Self::Ok, NoFields> {
            Ok(Some(number as f64))
        })+
    };
}

/// Serializes a number or a missing value; all other types are rejected.
impl Serializer for Number {
    type Ok = Option<f64>;

    take_numbers!(serialize_i8(i8) serialize_i16(i16) serialize_i32(i32) serialize_i64(i64)
        serialize_u8(u8) serialize_u16(u16) serialize_u32(u32) serialize_u64(u64)
        serialize_f32(f32) serialize_f64(f64));

    fn serialize_none(self) -> Result<Self::Ok, NoFields> {
        Ok(None)
    }

    fn serialize_unit(self) -> Result<Self::Ok, NoFields> {
        Ok(None)
    }

    look_inside!();
    refuse!(text "a number");
    refuse!(fields "a number");
    refuse!("a number" of values);
}

impl Serializer for Name {
    type Ok = String;

    fn serialize_str(self, name: &str) -> Result<String, NoFields> {
        Ok(name.into())
    }

    fn serialize_char(self, name: char) -> Result<String, NoFields> {
        Ok(name.into())
    }

    fn serialize_unit_variant(
        self,
        _: &'static str,
        _: u32,
        name: &'static str,
    ) -> Result<String, NoFields> {
        Ok(name.into())
    }

    look_inside!();
    refuse!("a name": serialize_none() serialize_unit());
    refuse!(numbers "a name");
    refuse!(fields "a name");
    refuse!("a name" of values);
}
