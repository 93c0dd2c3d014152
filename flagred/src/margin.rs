//! The motor margin: the distance of a motor command to the nearer limit.
//!
//! Eq. 2 and 3 of the paper. All functions use the *effective* range, the part of the command range that the vehicle
//! uses in flight, so a motor at its limit has margin 0 with any configuration of the vehicle.

/// A command range: the two values between which a motor can be driven.
///
/// # Example: a saturated motor has no margin
/// ```
/// use flagred::margin::{Range, margin};
///
/// let spin = Range::new(0.15, 0.95).ok_or("low must be below high")?; // MOT_SPIN_MIN, MOT_SPIN_MAX
/// assert_eq!(margin(spin.fraction(0.95)), 0.0);
/// # Ok::<(), &str>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    low: f64,
    high: f64,
}

impl Range {
    /// The whole range of a normalised command.
    pub const FULL: Range = Range {
        low: 0.0,
        high: 1.0,
    };

    /// A range from `low` to `high`; `None` unless both and their difference are finite and `low < high`. The
    /// difference must be at least 1e-9, and at least 1e-9 of the larger limit: otherwise every command would be at a
    /// limit.
    ///
    /// # Example
    /// ```
    /// use flagred::margin::Range;
    ///
    /// assert!(Range::new(1100.0, 1940.0).is_some());
    /// assert!(Range::new(1940.0, 1100.0).is_none() && Range::new(1100.0, f64::NAN).is_none());
    /// ```
    pub fn new(low: f64, high: f64) -> Option<Range> {
        const MIN_SPAN: f64 = 1e-9;
        let span = high - low;
        let least = MIN_SPAN * low.abs().max(high.abs()).max(1.0);
        (span >= least && span.is_finite()).then_some(Range { low, high })
    }

    /// The position of a value in this range: 0 at `low`, 1 at `high`, clamped to [0, 1]; NaN for NaN.
    ///
    /// # Example
    /// ```
    /// use flagred::margin::Range;
    ///
    /// let spin = Range::new(0.25, 0.75).ok_or("low must be below high")?;
    /// assert_eq!((spin.fraction(0.1), spin.fraction(0.5), spin.fraction(0.9)), (0.0, 0.5, 1.0));
    /// # Ok::<(), &str>(())
    /// ```
    pub fn fraction(&self, value: f64) -> f64 {
        ((value - self.low) / (self.high - self.low)).clamp(0.0, 1.0)
    }

    /// Whether a value can be a command. A value outside the range by more than ten times its width is a code, such as
    /// 65535 for an unknown command; NaN is unknown as well.
    ///
    /// ```
    /// let pulse_us = flagred::margin::Range::new(1000.0, 2000.0).ok_or("low must be below high")?;
    /// assert!(pulse_us.can_be_command(0.0) && !pulse_us.can_be_command(65535.0) && !pulse_us.can_be_command(f64::NAN));
    /// # Ok::<(), &str>(())
    /// ```
    pub fn can_be_command(&self, value: f64) -> bool {
        let most = 10.0 * (self.high - self.low);
        (self.low - most..=self.high + most).contains(&value)
    }
}

/// The margin of an effective command in [0, 1]: `min(e, 1 - e)`, in [0, 0.5]; 0 means saturated at either limit.
///
/// # Example
/// ```
/// use flagred::margin::margin;
///
/// assert_eq!((margin(0.0), margin(0.5), margin(0.75), margin(1.0)), (0.0, 0.5, 0.25, 0.0));
/// ```
pub fn margin(effective: f64) -> f64 {
    effective.min(1.0 - effective)
}

/// The nearer limit of a motor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(rename_all = "lowercase"))]
pub enum Side {
    /// The lower limit: the motor nearly stops and cannot give less thrust.
    Lower,
    /// The upper limit: the motor has nearly full power and cannot give more thrust.
    Upper,
}

impl Side {
    /// The limit nearer to an effective command; 0.5 counts as the upper limit.
    ///
    /// # Example
    /// ```
    /// use flagred::margin::Side;
    ///
    /// assert_eq!((Side::of(0.1), Side::of(0.9)), (Side::Lower, Side::Upper));
    /// ```
    pub fn of(effective: f64) -> Side {
        if effective < 0.5 {
            Side::Lower
        } else {
            Side::Upper
        }
    }
}

state! { enum Side { 0 = Lower {}, 1 = Upper {} } }

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_range_needs_two_finite_limits_in_order() {
        for (low, high) in [
            (1.0, 1.0),
            (2.0, 1.0),
            (f64::NAN, 1.0),
            (0.0, f64::INFINITY),
            (0.0, 5e-324),
            (1e6, 1e6 + 1e-4),
        ] {
            assert_eq!(Range::new(low, high), None, "{low} {high}");
        }
    }

    #[test]
    fn an_unknown_command_stays_unknown() {
        assert!(Range::FULL.fraction(f64::NAN).is_nan());
    }

    proptest! {
        #[test]
        fn margin_is_symmetric_and_bounded(e in 0.0..=1.0f64) {
            prop_assert!((0.0..=0.5).contains(&margin(e)));
            prop_assert!((margin(e) - margin(1.0 - e)).abs() < 1e-15);
            prop_assert_eq!(margin(e) == e, e <= 1.0 - e);
        }

        #[test]
        fn fraction_is_the_inverse_of_a_range(low in -10.0..10.0f64, width in 0.01..10.0f64, e in 0.0..=1.0f64) {
            let range = Range::new(low, low + width).unwrap();
            prop_assert!((range.fraction(low + e * width) - e).abs() < 1e-9);
        }
    }
}
