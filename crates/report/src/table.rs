//! Cells of tables that spreadsheets and terminals read.

use std::{
    borrow::Cow,
    io::{self, Write},
};

use flagred_flightlog::Flight;
use fuzzy::drawing::{visible, visible_lines};

/// The first characters that make a spreadsheet interpret a cell as a formula.
const FORMULA: [char; 6] = ['=', '+', '-', '@', '\t', '\r'];

/// Converts a text to a cell: hidden characters are made visible, and an apostrophe is added if a spreadsheet would
/// evaluate the text as a formula.
pub fn cell(text: &str) -> Cow<'_, str> {
    if text.starts_with(FORMULA) {
        Cow::Owned(format!("'{}", visible(text)))
    } else {
        visible(text)
    }
}

/// Writes a flight as flight CSV, with hidden characters in its texts made visible.
///
/// # Errors
/// If writing to `out` fails.
pub fn write_flight(out: impl Write, flight: &Flight) -> io::Result<()> {
    flight.write_csv(VisibleText(out))
}

/// A writer that makes hidden characters in text visible, except line ends.
struct VisibleText<W>(W);

impl<W: Write> Write for VisibleText<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let is_plain = |byte: &u8| matches!(byte, b' '..=b'~' | b'\n');
        if bytes.iter().all(is_plain) {
            return self.0.write(bytes);
        }
        // Formatted text arrives in pieces of whole characters as long as no buffer is in between.
        let text = String::from_utf8_lossy(bytes);
        self.0.write_all(visible_lines(&text).as_bytes())?;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.0.flush()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_cell_is_a_formula() {
        for (text, written) in [
            ("flight.bin", "flight.bin"),
            ("=HYPERLINK(1)", "'=HYPERLINK(1)"),
            ("@SUM(A1)", "'@SUM(A1)"),
            ("-2+3+cmd|' /C calc'!A0", "'-2+3+cmd|' /C calc'!A0"),
            ("\t=1", "'\\u{9}=1"),
            ("a\u{1b}[2J", "a\\u{1b}[2J"),
        ] {
            assert_eq!(cell(text), written);
        }
    }
}
