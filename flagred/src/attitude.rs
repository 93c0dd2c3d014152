//! The attitude error of a flight, and the risk that rules are learned from.

use crate::channel::short_way_deg;

/// The critical error of the paper in degrees: a risk of 100 %.
pub const CRITICAL_ERROR_DEG: f64 = 5.0;

/// Wanted and actual roll and pitch in degrees.
///
/// # Example: a pitch that lags behind
/// ```
/// use flagred::attitude::Attitude;
///
/// let attitude = Attitude { roll_des_deg: 0.0, roll_deg: 0.0, pitch_des_deg: 10.0, pitch_deg: 7.0 };
/// assert_eq!(attitude.squared_error_deg2(), 9.0);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Attitude {
    /// The roll that the controller wants.
    pub roll_des_deg: f64,
    /// The roll of the vehicle.
    pub roll_deg: f64,
    /// The pitch that the controller wants.
    pub pitch_des_deg: f64,
    /// The pitch of the vehicle.
    pub pitch_deg: f64,
}

impl Attitude {
    /// `(roll_des - roll)^2 + (pitch_des - pitch)^2` in square degrees, each difference taken the short way
    /// round. (Eq. 1 of the paper prints a minus between the squares, which would let a roll error hide a
    /// pitch error: an erratum.)
    pub fn squared_error_deg2(&self) -> f64 {
        let roll = short_way_deg(self.roll_des_deg - self.roll_deg);
        let pitch = short_way_deg(self.pitch_des_deg - self.pitch_deg);
        roll * roll + pitch * pitch
    }

    /// How far the vehicle tilts from level, in degrees: `acos(cos(roll) cos(pitch))`.
    pub fn tilt_deg(&self) -> f64 {
        tilt_deg(self.roll_deg, self.pitch_deg)
    }

    /// How far the set point tilts from level, in degrees.
    pub fn commanded_tilt_deg(&self) -> f64 {
        tilt_deg(self.roll_des_deg, self.pitch_des_deg)
    }
}

fn tilt_deg(roll_deg: f64, pitch_deg: f64) -> f64 {
    let up = libm::cos(roll_deg.to_radians()) * libm::cos(pitch_deg.to_radians());
    libm::acos(up.clamp(-1.0, 1.0)).to_degrees()
}

/// The root mean square of the attitude error over any number of samples.
///
/// # Example: an error of 3 degrees in roll and 4 in pitch is one of 5
///
/// ```
/// use flagred::attitude::{Attitude, AttitudeError, risk_pct};
///
/// let mut error = AttitudeError::default();
/// error.push(&Attitude { roll_des_deg: 3.0, roll_deg: 0.0, pitch_des_deg: 0.0, pitch_deg: 4.0 });
/// let rmse_deg = error.rmse_deg().ok_or("no sample")?;
/// assert_eq!(rmse_deg, 5.0);
/// assert_eq!(risk_pct(rmse_deg, flagred::attitude::CRITICAL_ERROR_DEG), 100.0);
/// # Ok::<(), &str>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct AttitudeError {
    samples: u64,
    mean_square_deg2: f64,
}

impl AttitudeError {
    /// Adds a sample; one with a value that is not finite is left out.
    pub fn push(&mut self, attitude: &Attitude) {
        let square = attitude.squared_error_deg2();
        if square.is_finite() {
            self.samples += 1;
            self.mean_square_deg2 += (square - self.mean_square_deg2) / self.samples as f64;
        }
    }

    /// The number of samples counted.
    pub fn samples(&self) -> u64 {
        self.samples
    }

    /// `sqrt(mean(squared error))` in degrees; `None` without a sample.
    pub fn rmse_deg(&self) -> Option<f64> {
        (self.samples > 0).then(|| libm::sqrt(self.mean_square_deg2))
    }
}

/// The risk that an attitude error stands for, in %: `100 min(1, rmse / critical)`.
///
/// The paper gives the critical error ([`CRITICAL_ERROR_DEG`]) but no scaling; this one is ours.
///
/// # Example
/// ```
/// use flagred::attitude::{CRITICAL_ERROR_DEG, risk_pct};
///
/// assert_eq!(risk_pct(1.0, CRITICAL_ERROR_DEG), 20.0);
/// assert_eq!(risk_pct(12.0, CRITICAL_ERROR_DEG), 100.0);
/// ```
pub fn risk_pct(rmse_deg: f64, critical_deg: f64) -> f64 {
    100.0 * (rmse_deg / critical_deg).min(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn error(roll_des: f64, roll: f64, pitch_des: f64, pitch: f64) -> f64 {
        Attitude {
            roll_des_deg: roll_des,
            roll_deg: roll,
            pitch_des_deg: pitch_des,
            pitch_deg: pitch,
        }
        .squared_error_deg2()
    }

    #[test]
    fn errors_in_roll_and_pitch_add_up() {
        assert_eq!(error(3.0, 0.0, 4.0, 0.0), 25.0);
        assert_eq!(error(0.0, 3.0, 0.0, 4.0), 25.0);
        // With the printed minus this would read 0.
        assert_eq!(error(4.0, 0.0, 4.0, 0.0), 32.0);
    }

    #[test]
    fn angles_differ_the_short_way_round() {
        approx::assert_abs_diff_eq!(error(179.0, -179.0, 0.0, 0.0), 4.0, epsilon = 1e-9);
    }

    #[test]
    fn rmse_is_over_samples_and_leaves_unknown_ones_out() {
        let mut rmse = AttitudeError::default();
        assert_eq!(rmse.rmse_deg(), None);
        for roll_deg in [1.0, f64::NAN, 7.0] {
            rmse.push(&Attitude {
                roll_des_deg: 0.0,
                roll_deg,
                pitch_des_deg: 0.0,
                pitch_deg: 0.0,
            });
        }
        assert_eq!(rmse.samples(), 2);
        approx::assert_abs_diff_eq!(rmse.rmse_deg().unwrap(), 5.0, epsilon = 1e-12);
    }

    #[test]
    fn risk_rises_to_100_at_the_critical_error() {
        for (rmse, risk) in [(0.0, 0.0), (1.0, 20.0), (5.0, 100.0), (18.6, 100.0)] {
            assert_eq!(risk_pct(rmse, CRITICAL_ERROR_DEG), risk);
        }
    }
}
