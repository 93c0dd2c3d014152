//! The numbers in the cells of a table.

use fuzzy::{diagnostic::quoted, tree::number_advice};

/// The number in a cell, if any.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Cell {
    /// A finite number.
    Number(f64),
    /// Empty, `NA`, `NaN` or `#N/A`, as spreadsheets write it.
    Unknown,
    /// Any other text.
    Bad,
}

/// Texts by which other programs represent an unknown value.
const UNKNOWN: [&str; 14] = [
    "null",
    "none",
    "nil",
    "na",
    "n/a",
    "n.a.",
    "-",
    "--",
    "?",
    "unknown",
    "missing",
    "undefined",
    "invalid",
    "<NA>",
];

impl Cell {
    pub(crate) fn of(text: &[u8]) -> Cell {
        let text = text.trim_ascii();
        // Numbers contain only ASCII characters.
        let number = str::from_utf8(text)
            .ok()
            .and_then(|text| text.parse::<f64>().ok());
        match number {
            Some(number) if number.is_finite() => Cell::Number(number),
            Some(number) if number.is_nan() => Cell::Unknown,
            None if text.is_empty() || text == b"NA" || text == b"#N/A" => Cell::Unknown,
            _ => Cell::Bad,
        }
    }

    /// Explains why a cell is [`Cell::Bad`].
    pub(crate) fn problem(text: &[u8]) -> String {
        let text = String::from_utf8_lossy(text.trim_ascii());
        let shown = quoted(&text);
        match text.parse::<f64>() {
            Ok(_) => format!("`{shown}` is not a finite number"),
            Err(_) if text.is_empty() => "the cell is empty".to_owned(),
            Err(_) if UNKNOWN.iter().any(|word| text.eq_ignore_ascii_case(word)) => {
                format!(
                    "`{shown}` is not a number: if the value is unknown, leave the cell empty or write `NA`"
                )
            }
            Err(_) => match number_advice(&text) {
                Some(advice) => format!("`{shown}` is not a number: {advice}"),
                None => format!("`{shown}` is not a number"),
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cell_is_a_number_or_an_error_with_a_reason() {
        for (text, cell) in [
            ("1.5", Cell::Number(1.5)),
            (" -2e-3\t", Cell::Number(-0.002)),
            ("", Cell::Unknown),
            ("  ", Cell::Unknown),
            ("NA", Cell::Unknown),
            ("nan", Cell::Unknown),
            ("NaN", Cell::Unknown),
            ("#N/A", Cell::Unknown),
            ("na", Cell::Bad),
            ("inf", Cell::Bad),
            ("1e999", Cell::Bad),
            ("20,5", Cell::Bad),
            ("much", Cell::Bad),
        ] {
            assert_eq!(Cell::of(text.as_bytes()), cell, "{text}");
        }
        for (text, problem) in [
            ("1e999", "`1e999` is not a finite number"),
            (
                "20,5",
                "`20,5` is not a number: write a decimal point: `20.5`",
            ),
            (
                "1,000",
                "`1,000` is not a number: write `1000`, or `1.000` if the comma is meant as a decimal point",
            ),
            (
                "15.48 %",
                "`15.48 %` is not a number: write `15.48`, or `0.1548` on a scale from 0 to 1",
            ),
            ("2-3", "`2-3` is not a number"),
            (
                "null",
                "`null` is not a number: if the value is unknown, leave the cell empty or write `NA`",
            ),
            (
                "n/a",
                "`n/a` is not a number: if the value is unknown, leave the cell empty or write `NA`",
            ),
            ("a,b", "`a,b` is not a number"),
            (" much ", "`much` is not a number"),
        ] {
            assert_eq!(Cell::problem(text.as_bytes()), problem);
        }
    }
}
