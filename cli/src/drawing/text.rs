//! Text for HTML and SVG: escaped, and numbers as short as they can be.

use std::fmt;

/// A text from a log or a file, made safe to stand in HTML and SVG, in text and in attributes.
///
/// What is no character of XML becomes a replacement character, so that a damaged log cannot make a broken file.
pub(crate) struct Escaped<'a>(pub(crate) &'a str);

impl fmt::Display for Escaped<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for character in self.0.chars() {
            match character {
                '&' => f.write_str("&amp;")?,
                '<' => f.write_str("&lt;")?,
                '>' => f.write_str("&gt;")?,
                '"' => f.write_str("&quot;")?,
                '\'' => f.write_str("&#39;")?,
                '\n' | '\t' => write!(f, "{character}")?,
                c if c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}') => {
                    f.write_str("\u{fffd}")?;
                }
                c => write!(f, "{c}")?,
            }
        }
        Ok(())
    }
}

/// A number with at most so many decimals, without zeros behind.
pub(crate) fn number(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    let text = match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.'),
        false => &text,
    };
    if text == "-0" { "0" } else { text }.to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_of_a_log_can_be_markup() {
        let text = Escaped("<script>alert(\"1\")</script> & 'x'\0\u{7}").to_string();
        assert_eq!(
            text,
            "&lt;script&gt;alert(&quot;1&quot;)&lt;/script&gt; &amp; &#39;x&#39;\u{fffd}\u{fffd}"
        );
    }

    #[test]
    fn numbers_are_short() {
        for (value, decimals, expected) in [
            (1.50, 2, "1.5"),
            (100.0, 1, "100"),
            (100.0, 0, "100"),
            (-0.001, 2, "0"),
            (0.125, 2, "0.12"),
        ] {
            assert_eq!(number(value, decimals), expected);
        }
    }
}
