//! The attitude error over a period, and the risk that is computed from it for learning.

use flagred_flightlog::Attitude;

/// Returns the root mean square of the attitude error in degrees. Unknown attitudes are ignored; `None` if all are
/// unknown.
///
/// # Example: errors of 3 degrees in roll and 4 degrees in pitch are an attitude error of 5 degrees
/// ```
/// use flagred_flightlog::Attitude;
///
/// let attitude = Attitude { roll_des_deg: 3.0, roll_deg: 0.0, pitch_des_deg: 0.0, pitch_deg: 4.0 };
/// assert_eq!(flagred_evaluation::rmse_deg([&attitude]), Some(5.0));
/// ```
pub fn rmse_deg<'a>(attitudes: impl IntoIterator<Item = &'a Attitude>) -> Option<f64> {
    let squares = attitudes.into_iter().map(Attitude::squared_error_deg2);
    let (samples, mean) = squares
        .filter(|square| square.is_finite())
        .fold((0_u64, 0.0), |(samples, mean), square| {
            (samples + 1, mean + (square - mean) / (samples + 1) as f64)
        });
    (samples > 0).then(|| mean.sqrt())
}

/// Returns the risk that corresponds to an attitude error, in %: `100 min(1, rmse / critical)`.
///
/// The paper gives the critical error ([`CRITICAL_ERROR_DEG`](flagred::profile::CRITICAL_ERROR_DEG)) but no scaling.
///
/// # Example
/// ```
/// use flagred_evaluation::risk_pct;
/// use flagred::profile::CRITICAL_ERROR_DEG;
///
/// assert_eq!(risk_pct(1.0, CRITICAL_ERROR_DEG), 20.0);
/// assert_eq!(risk_pct(12.0, CRITICAL_ERROR_DEG), 100.0);
/// ```
pub fn risk_pct(rmse_deg: f64, critical_deg: f64) -> f64 {
    100.0 * (rmse_deg / critical_deg).min(1.0)
}

#[cfg(test)]
mod tests {
    use flagred::profile::CRITICAL_ERROR_DEG;

    use super::*;

    #[test]
    fn rmse_is_over_samples_and_ignores_unknown_ones() {
        let attitudes = [1.0, f64::NAN, 7.0].map(|roll_deg| Attitude {
            roll_des_deg: 0.0,
            roll_deg,
            pitch_des_deg: 0.0,
            pitch_deg: 0.0,
        });
        assert_eq!(rmse_deg([]), None);
        approx::assert_abs_diff_eq!(rmse_deg(&attitudes).unwrap(), 5.0, epsilon = 1e-12);
    }

    #[test]
    fn risk_rises_to_100_at_the_critical_error() {
        for (rmse, risk) in [(0.0, 0.0), (1.0, 20.0), (5.0, 100.0), (18.6, 100.0)] {
            assert_eq!(risk_pct(rmse, CRITICAL_ERROR_DEG), risk);
        }
    }
}
