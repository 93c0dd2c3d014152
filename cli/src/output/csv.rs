//! Cells of tables that are written for spreadsheets, too.

use std::borrow::Cow;

use fuzzy::drawing::visible;

/// What makes a spreadsheet read a cell as a formula.
const FORMULA: [char; 6] = ['=', '+', '-', '@', '\t', '\r'];

/// A text as a cell: visible, and with an apostrophe in front where a spreadsheet would compute it.
pub(crate) fn cell(text: &str) -> Cow<'_, str> {
    if text.starts_with(FORMULA) {
        Cow::Owned(format!("'{}", visible(text)))
    } else {
        visible(text)
    }
}

/// A cell that is copied from a table: a number stays as it is.
pub(crate) fn number_or_cell(text: &str) -> Cow<'_, str> {
    match text.trim().parse::<f64>() {
        Ok(_) => Cow::Borrowed(text),
        Err(_) => cell(text),
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
            assert_eq!(number_or_cell(text), written);
        }
        for number in ["-2.5", "+1e3", " -7 ", "0.1", "-inf"] {
            assert_eq!(number_or_cell(number), number);
        }
    }
}
