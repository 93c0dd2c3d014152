//! Parsers of numbers on the command line, whose errors name what is allowed.

use std::{fmt::Display, str::FromStr};

/// Parses a whole number from `low` to `high`.
pub(crate) fn whole<N>(low: N, high: N) -> impl Fn(&str) -> Result<N, String> + Clone + Send + Sync
where
    N: FromStr + PartialOrd + Display + Copy + Send + Sync + 'static,
{
    // A limit of the type only is not worth a mention.
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
    real(text)
        .filter(|share| (0.0..1.0).contains(share))
        .ok_or_else(|| "write a fraction of at least 0 and less than 1".into())
}

/// Parses a degree: above 0, at most 1.
pub(crate) fn degree_above_0(text: &str) -> Result<f64, String> {
    real(text)
        .filter(|degree| *degree > 0.0 && *degree <= 1.0)
        .ok_or_else(|| "write a number above 0 and at most 1".into())
}

/// Parses a degree: from 0 to 1.
pub(crate) fn degree(text: &str) -> Result<f64, String> {
    real(text)
        .filter(|degree| (0.0..=1.0).contains(degree))
        .ok_or_else(|| "write a number from 0 to 1".into())
}

/// Parses a finite number above 0.
pub(crate) fn positive(text: &str) -> Result<f64, String> {
    real(text)
        .filter(|number| *number > 0.0)
        .ok_or_else(|| "write a number above 0".into())
}

/// Parses a finite number of at least 0.
pub(crate) fn at_least_0(text: &str) -> Result<f64, String> {
    real(text)
        .filter(|number| *number >= 0.0)
        .ok_or_else(|| "write a number of at least 0".into())
}

fn real(text: &str) -> Option<f64> {
    let number: Option<f64> = text.parse().ok();
    number.filter(|number| number.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_name_what_is_allowed() {
        assert_eq!(whole(2, 100)("5"), Ok(5));
        for wrong in ["1", "101", "five", "1e1", "-3", "5%", ""] {
            let error = whole(2_u32, 100)(wrong).unwrap_err();
            assert_eq!(error, "write a whole number from 2 to 100", "{wrong}");
        }
        assert!(share("1").is_err() && share("nan").is_err());
        assert!(degree("1.01").is_err() && degree("50%").is_err());
        assert!(degree_above_0("0").is_err() && positive("inf").is_err());
        assert_eq!(at_least_0("0"), Ok(0.0));
    }
}
