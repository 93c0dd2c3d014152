//! Advice for texts that are meant as numbers: decimal commas, separators, units, percentages, letters, dashes.

use alloc::{format, string::String};

use crate::formula::Formula;

/// Characters that look like a minus sign: hyphens, dashes and the typographic minus sign.
const DASHES: [char; 5] = ['\u{2010}', '\u{2011}', '\u{2012}', '\u{2013}', '\u{2212}'];

/// Units that are easily confused, each with the unit that is 1000 times as large.
const MILLI: [(&str, &str); 4] = [("ms", "s"), ("mm", "m"), ("mV", "V"), ("mA", "A")];

/// Returns the share of a percentage: 0.05 for `5%`.
#[must_use]
pub fn share_of_percentage(text: &str) -> Option<f64> {
    Some(plain(text.trim().strip_suffix('%')?)? / 100.0)
}

/// Returns the percentage of a share, rounded to six digits after the decimal point: 90 for 0.9.
#[must_use]
pub fn percentage_of_share(share: f64) -> f64 {
    libm::round(1e8 * share) / 1e6
}

/// Returns advice for a percentage that was written in place of a share, such as `80` instead of 0.8; `None`
/// for numbers that are probably not percentages.
#[must_use]
pub fn percentage_advice(number: f64) -> Option<String> {
    (10.0..=100.0)
        .contains(&number)
        .then(|| format!("if you mean {number} %, write `{}`", number / 100.0))
}

/// Returns advice for a text that is not a number, but was probably meant as one.
#[must_use]
pub fn number_advice(text: &str) -> Option<String> {
    let ascii = text.trim_matches(|c: char| c.is_ascii_whitespace());
    let text = text.trim();
    if plain(text).is_some() {
        return (ascii != text).then(|| format!("remove the no-break space: write `{text}`"));
    }
    if let Some(number) = text.strip_suffix([',', ';'])
        && plain(number).is_some()
    {
        return Some(format!("write only the number: `{number}`"));
    }
    if let Some(share) = share_of_percentage(text) {
        let percent = text.trim_end_matches('%').trim();
        return Some(match share {
            0.0 => "write only the number: `0`".into(),
            _ => format!("write `{percent}`, or `{share}` on a scale from 0 to 1"),
        });
    }
    if let Some(positive) = text
        .strip_prefix(DASHES)
        .filter(|rest| plain(rest).is_some())
    {
        return Some(format!(
            "this dash is not a minus sign: write `-{positive}`"
        ));
    }
    if let Some(advice) = separators(text) {
        return Some(advice);
    }
    if text.contains(['*', '/', '+'])
        && let Ok(formula) = text.parse::<Formula>()
        && let value = formula.evaluate(|_| f64::NAN)
        && value.is_finite()
    {
        return Some(format!("write the number, not a calculation: `{value}`"));
    }
    if let Some(number) = other_notation(text) {
        return Some(format!("write decimal digits only: `{number}`"));
    }
    let digits = text.replace(['O', 'o'], "0").replace('l', "1");
    if plain(&digits).is_some() {
        return Some(format!(
            "did you mean `{digits}`, with digits in place of letters?"
        ));
    }
    let end = text.find(|c: char| !(c.is_ascii_digit() || "+-.".contains(c)))?;
    let (number, unit) = text.split_at_checked(end)?;
    let unit = unit.trim();
    let small = plain(number).filter(|_| !unit.contains(|c: char| c.is_ascii_digit()))?;
    Some(match MILLI.iter().find(|(milli, _)| *milli == unit) {
        Some((_, larger)) => format!(
            "write the number without its unit: `{}` if the unit is {larger}, `{number}` if it is {unit}",
            small / 1000.0
        ),
        None => format!("write the number without its unit: `{number}`"),
    })
}

fn plain(text: &str) -> Option<f64> {
    text.trim()
        .parse()
        .ok()
        .filter(|number: &f64| number.is_finite())
}

/// Returns advice for a decimal comma, or for separators of thousands. If there are both commas and points, the last
/// one is the decimal mark.
fn separators(text: &str) -> Option<String> {
    let point = |number: &str| format!("write a decimal point: `{number}`");
    let bare = text.replace([' ', '\'', '\u{a0}', '\u{202f}', '\u{2019}'], "");
    let number = match (bare.rfind(','), bare.rfind('.')) {
        (Some(comma), Some(dot)) if comma > dot => bare.replace('.', "").replace(',', "."),
        (Some(_), Some(_)) => bare.replace(',', ""),
        (Some(comma), None) if bare.matches(',').count() == 1 => {
            let (whole, part) = (bare.get(..comma)?, bare.get(comma + 1..)?);
            let number = format!("{whole}.{part}");
            plain(&number)?;
            let digits = whole.trim_start_matches(['+', '-']);
            // Three digits after a comma may be thousands or a fraction.
            let is_thousands = part.len() == 3 && (1..=3).contains(&digits.len()) && digits != "0";
            return Some(match is_thousands {
                true => {
                    format!(
                        "write `{whole}{part}`, or `{number}` if the comma is meant as a decimal point"
                    )
                }
                false => point(&number),
            });
        }
        _ => bare.replace(',', ""),
    };
    let is_grouped = number != text && text.starts_with(|c: char| c.is_ascii_digit() || c == '-');
    (is_grouped && plain(&number).is_some())
        .then(|| format!("write the number without separators: `{number}`"))
}

/// Parses a number in hexadecimal, octal or binary notation, or with `_` between digits.
fn other_notation(text: &str) -> Option<u64> {
    let prefixed = [("0x", 16), ("0o", 8), ("0b", 2)].into_iter();
    let mut numbers = prefixed.filter_map(|(prefix, radix)| {
        let digits = text.to_ascii_lowercase();
        u64::from_str_radix(digits.strip_prefix(prefix)?, radix).ok()
    });
    numbers.next().or_else(|| {
        let starts_with_digit = text.starts_with(|c: char| c.is_ascii_digit());
        let digits = text.replace('_', "").parse().ok();
        digits.filter(|_| starts_with_digit)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn advice_names_the_intended_number() {
        for (text, advice) in [
            ("20,5", "write a decimal point: `20.5`"),
            ("0,125", "write a decimal point: `0.125`"),
            (
                "1,000",
                "write `1000`, or `1.000` if the comma is meant as a decimal point",
            ),
            ("1,000.5", "write the number without separators: `1000.5`"),
            ("1.234,5", "write the number without separators: `1234.5`"),
            ("40.000,0", "write the number without separators: `40000.0`"),
            (
                "1,000,000",
                "write the number without separators: `1000000`",
            ),
            ("1'000", "write the number without separators: `1000`"),
            ("\u{2212}12", "this dash is not a minus sign: write `-12`"),
            (
                "15.48 %",
                "write `15.48`, or `0.1548` on a scale from 0 to 1",
            ),
            ("36 %", "write `36`, or `0.36` on a scale from 0 to 1"),
            ("0%", "write only the number: `0`"),
            ("22V", "write the number without its unit: `22`"),
            (
                "20mV",
                "write the number without its unit: `0.02` if the unit is V, `20` if it is mV",
            ),
            ("1O", "did you mean `10`, with digits in place of letters?"),
            ("0x10", "write decimal digits only: `16`"),
            ("2*3", "write the number, not a calculation: `6`"),
            ("24,", "write only the number: `24`"),
            ("5\u{a0}", "remove the no-break space: write `5`"),
        ] {
            assert_eq!(number_advice(text).as_deref(), Some(advice), "{text}");
        }
        for text in [
            "50", " 50 ", "-1", "1e3", "2-3", "a,b", "much", "", "-", "1..2", ".",
        ] {
            assert_eq!(number_advice(text), None, "{text}");
        }
    }
}
