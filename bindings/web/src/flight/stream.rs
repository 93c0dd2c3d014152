//! Reads bytes from JavaScript in pieces, and writes bytes to it.

use std::io::{self, Read, Write};

use js_sys::{Error, Function, Uint8Array};
use wasm_bindgen::{JsCast, JsValue};

use super::PIECE;

/// A reader that obtains bytes by calling a JavaScript function with an offset and a length.
pub(super) struct Source<'f> {
    read: &'f Function,
    /// The offset of the first byte after the piece.
    offset: f64,
    piece: Vec<u8>,
    used: usize,
}

impl<'f> Source<'f> {
    pub(super) fn new(read: &'f Function) -> Self {
        Source {
            read,
            offset: 0.0,
            piece: Vec::new(),
            used: 0,
        }
    }

    fn next_piece(&mut self) -> io::Result<()> {
        let given = self
            .read
            .call2(&JsValue::NULL, &self.offset.into(), &(PIECE as f64).into());
        let given = given.map_err(io_error)?.dyn_into::<Uint8Array>();
        let given =
            given.map_err(|_| io::Error::other("the function that reads returned no bytes"))?;
        self.piece = given.to_vec();
        self.offset += self.piece.len() as f64;
        self.used = 0;
        Ok(())
    }
}

impl Read for Source<'_> {
    fn read(&mut self, to: &mut [u8]) -> io::Result<usize> {
        if self.used == self.piece.len() {
            self.next_piece()?;
        }
        let mut rest = self.piece.get(self.used..).unwrap_or_default();
        let count = rest.read(to)?;
        self.used += count;
        Ok(count)
    }
}

/// A writer that calls a function with bytes.
pub(super) struct Sink<'f>(pub(super) &'f Function);

impl Write for Sink<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let piece = Uint8Array::from(bytes);
        let written = self.0.call1(&JsValue::NULL, &piece);
        written.map(|_| bytes.len()).map_err(io_error)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Converts an exception of JavaScript to an error with its message.
fn io_error(thrown: JsValue) -> io::Error {
    let words = match thrown.dyn_ref::<Error>() {
        Some(error) => String::from(error.message()),
        None => format!("{thrown:?}"),
    };
    io::Error::other(words)
}
