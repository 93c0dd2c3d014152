//! Parsers of numbers on the command line. Their error messages state which numbers are allowed.

use std::{fmt::Display, str::FromStr};

use fuzzy::tree::{number_advice, share_of_percentage};

/// Parses a whole number from `low` to `high`.
pub(crate) fn whole<N>(low: N, high: N) -> impl Fn(&str) -> Result<N, String> + Clone + Send + Sync
where
    N: FromStr + PartialOrd + Display + Copy + Send + Sync + 'static,
{
    // A limit that exists only because of the number type is not mentioned in the message.
    let is_open = high.to_string().len() > 15;
    move |text| {
        let number = text.parse().ok();
        number
            .filter(|number| (low..=high).contains(number))
            .ok_or_else(|| match is_open {
                true => format!("write a whole number of at least {low}"),
                false => format!("write a whole number from {low} to {high}"),
            })
    }
}

/// Parses a random seed.
pub(crate) fn seed(text: &str) -> Result<u64, String> {
    whole(0, u64::MAX)(text)
}

/// Parses a share: at least 0 and less than 1.
pub(crate) fn share(text: &str) -> Result<f64, String> {
    fraction(
        text,
        |share| (0.0..1.0).contains(&share),
        "write a fraction of at least 0 and less than 1",
    )
}

/// Parses a degree: above 0, at most 1.
pub(crate) fn degree_above_0(text: &str) -> Result<f64, String> {
    fraction(
        text,
        |degree| degree > 0.0 && degree <= 1.0,
        "write a number above 0 and at most 1",
    )
}

/// Parses a degree: from 0 to 1.
pub(crate) fn degree(text: &str) -> Result<f64, String> {
    fraction(
        text,
        |degree| (0.0..=1.0).contains(&degree),
        "write a number from 0 to 1",
    )
}

/// Parses a finite number above 0.
pub(crate) fn positive(text: &str) -> Result<f64, String> {
    real(text, |number| number > 0.0, "write a number above 0")
}

/// Parses a finite number of at least 0.
pub(crate) fn at_least_0(text: &str) -> Result<f64, String> {
    real(text, |number| number >= 0.0, "write a number of at least 0")
}

fn fraction(text: &str, is_allowed: impl Fn(f64) -> bool, what: &str) -> Result<f64, String> {
    match share_of_percentage(text).filter(|share| is_allowed(*share)) {
        Some(share) => Err(format!("{what}: `{share}`")),
        None => real(text, is_allowed, what),
    }
}

fn real(text: &str, is_allowed: impl Fn(f64) -> bool, what: &str) -> Result<f64, String> {
    let number = text.parse().ok();
    let number = number.filter(|number: &f64| number.is_finite() && is_allowed(*number));
    // If the text has one of these units, the number without the unit would have another meaning, so the advice does
    // not suggest it.
    let other_unit = ["us", "min", "h"].iter().find(|unit| text.ends_with(*unit));
    number.ok_or_else(|| match (number_advice(text), other_unit) {
        (Some(_), Some(unit)) => format!("{what}, without `{unit}`, in the unit of the option"),
        (Some(advice), None) => format!("{what}; {advice}"),
        (None, _) => what.to_owned(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_list_the_allowed_values() {
        assert_eq!(whole(2, 100)("5"), Ok(5));
        for wrong in ["1", "101", "five", "1e1", "-3", "5%", ""] {
            let error = whole(2_u32, 100)(wrong).unwrap_err();
            assert_eq!(error, "write a whole number from 2 to 100", "{wrong}");
        }
        assert!(share("1").is_err() && share("nan").is_err());
        assert!(degree("1.01").is_err());
        assert_eq!(
            degree("50%").unwrap_err(),
            "write a number from 0 to 1: `0.5`"
        );
        assert_eq!(
            positive("5s").unwrap_err(),
            "write a number above 0; write the number without its unit: `5`"
        );
        for (text, error) in [
            (
                "100ms",
                "write a number above 0; write the number without its unit: `0.1` if the unit is s, `100` if it is ms",
            ),
            (
                "1%",
                "write a number above 0; write `1`, or `0.01` on a scale from 0 to 1",
            ),
            (
                "5min",
                "write a number above 0, without `min`, in the unit of the option",
            ),
        ] {
            assert_eq!(positive(text).unwrap_err(), error);
        }
        assert!(degree_above_0("0").is_err() && positive("inf").is_err());
        assert_eq!(at_least_0("0"), Ok(0.0));
    }
}
