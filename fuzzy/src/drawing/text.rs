//! Text in drawings: escaping of control characters and markup, short numbers, bars of characters.

use std::{borrow::Cow, fmt};

/// Returns whether a character would affect a terminal or the direction of text instead of being displayed: control
/// characters, line and paragraph separators, bidirectional controls (Unicode, UAX 9), and characters that XML does not
/// allow.
fn is_hidden(c: char) -> bool {
    c.is_control()
        || matches!(c,
            '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}'
            | '\u{fffe}' | '\u{ffff}')
}

/// Escapes a text from the input for display on one line: each character that would not be displayed is replaced by its
/// number.
///
/// ```
/// assert_eq!(fuzzy::drawing::visible("warm\u{1b}[2J"), "warm\\u{1b}[2J");
/// assert_eq!(fuzzy::drawing::visible("größer als 5 °C"), "größer als 5 °C");
/// ```
pub fn visible(text: &str) -> Cow<'_, str> {
    replaced(text, |_, _| false)
}

/// Works like [`visible`], for a text of several lines: line breaks and tabs are kept.
pub fn visible_lines(text: &str) -> Cow<'_, str> {
    replaced(text, |c, rest| match c {
        '\n' | '\t' => true,
        '\r' => rest.starts_with('\n'),
        _ => false,
    })
}

/// Replaces hidden characters by their numbers. `stays` receives each one with the text after it, and returns whether
/// to keep it.
fn replaced(text: &str, stays: impl Fn(char, &str) -> bool) -> Cow<'_, str> {
    if !text.contains(is_hidden) {
        return Cow::Borrowed(text);
    }
    let mut shown = String::with_capacity(text.len() + 16);
    let mut rest = text.chars();
    while let Some(c) = rest.next() {
        if is_hidden(c) && !stays(c, rest.as_str()) {
            shown.extend(c.escape_unicode());
        } else {
            shown.push(c);
        }
    }
    Cow::Owned(shown)
}

/// A text that is escaped for the content and attributes of HTML and SVG and made visible ([`visible_lines`]), so that
/// no text can break a file.
pub struct EscapedText<'a>(pub &'a str);

impl fmt::Display for EscapedText<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for character in visible_lines(self.0).chars() {
            match character {
                '&' => f.write_str("&amp;")?,
                '<' => f.write_str("&lt;")?,
                '>' => f.write_str("&gt;")?,
                '"' => f.write_str("&quot;")?,
                '\'' => f.write_str("&#39;")?,
                c => write!(f, "{c}")?,
            }
        }
        Ok(())
    }
}

/// Formats a number with at most `decimals` decimals, without trailing zeros.
pub fn number(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    let text = match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.'),
        false => &text,
    };
    if text == "-0" { "0" } else { text }.to_owned()
}

/// Formats a number with at most 6 decimals, without trailing zeros; empty if it is not finite.
pub fn short(x: f64) -> String {
    if x.is_finite() {
        number(x, 6)
    } else {
        String::new()
    }
}

/// Formats the name and the unit of a variable: `margin [%]`.
pub(super) fn titled(name: &str, unit: Option<&str>) -> String {
    match unit {
        Some(unit) => format!("{name} [{unit}]"),
        None => name.to_owned(),
    }
}

/// Returns a bar of `width` characters for a fraction from 0 to 1: `██████····`.
pub fn bar(share: f64, width: usize) -> String {
    let full = (share.clamp(0.0, 1.0) * width as f64).round() as usize;
    "█".repeat(full) + &"·".repeat(width - full)
}

/// Returns the character of a column in a row of a bar chart. The column is `eighths` eighths of a row high; rows count
/// from the bottom.
///
/// # Example: a column of one and a half rows
/// ```
/// use fuzzy::drawing::block;
/// assert_eq!([block(12, 2), block(12, 1), block(12, 0)], [' ', '▄', '█']);
/// ```
pub fn block(eighths: usize, row: usize) -> char {
    const EIGHTHS: [char; 9] = [' ', '▁', '▂', '▃', '▄', '▅', '▆', '▇', '█'];
    EIGHTHS[eighths.saturating_sub(row * 8).min(8)]
}

/// Breaks a text between words into lines of at most `most` characters; longer words are cut.
pub(super) fn wrapped(text: &str, most: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split(' ') {
        let length = word.chars().count();
        match lines.last_mut() {
            Some(line) if line.chars().count() + 1 + length <= most => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(cut(word, most)),
        }
    }
    lines
}

/// Shortens a text to at most `most` characters; the last one is an ellipsis if the text is longer.
pub(super) fn cut(text: &str, most: usize) -> String {
    if text.chars().count() <= most {
        return text.to_owned();
    }
    let kept: String = text.chars().take(most.saturating_sub(1)).collect();
    kept + "…"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_of_a_log_cannot_be_markup() {
        let text = EscapedText("<script>alert(\"1\")</script> & 'x'\0\u{7}").to_string();
        assert_eq!(
            text,
            "&lt;script&gt;alert(&quot;1&quot;)&lt;/script&gt; &amp; &#39;x&#39;\\u{0}\\u{7}"
        );
    }

    #[test]
    fn control_characters_are_made_visible() {
        for (text, shown) in [
            ("", ""),
            ("Größe 5 µs, 飛行", "Größe 5 µs, 飛行"),
            ("a\u{1b}]0;title\u{7}", "a\\u{1b}]0;title\\u{7}"),
            ("\u{9b}31m\u{7f}", "\\u{9b}31m\\u{7f}"),
            ("nib\u{202e}gpj.\u{2066}", "nib\\u{202e}gpj.\\u{2066}"),
            ("\u{200f}\u{61c}\u{2028}", "\\u{200f}\\u{61c}\\u{2028}"),
            ("one\ntwo\r\n\t", "one\\u{a}two\\u{d}\\u{a}\\u{9}"),
        ] {
            assert_eq!(visible(text), shown);
        }
        let lines = "one\ntwo\r\n\tthree\rfour\u{1b}";
        assert_eq!(visible_lines(lines), "one\ntwo\r\n\tthree\\u{d}four\\u{1b}");
    }

    #[test]
    fn texts_are_shortened_to_fit() {
        assert_eq!(wrapped("at a = 1, b = 2", 9), ["at a = 1,", "b = 2"]);
        assert_eq!(wrapped("abcdefgh", 4), ["abc…"]);
        assert_eq!((bar(0.25, 4), bar(7.0, 2)), ("█···".into(), "██".into()));
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
