//! The attitude of a flight and its set point.

use crate::Flight;

/// The names of the signals that form an [`Attitude`].
pub const ATTITUDE: [&str; 4] = ["roll_des_deg", "roll_deg", "pitch_des_deg", "pitch_deg"];

/// Desired and actual roll and pitch in degrees.
///
/// # Example: a pitch that lags behind
/// ```
/// use flagred_flightlog::Attitude;
///
/// let attitude = Attitude { roll_des_deg: 0.0, roll_deg: 0.0, pitch_des_deg: 10.0, pitch_deg: 7.0 };
/// assert_eq!(attitude.squared_error_deg2(), 9.0);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Attitude {
    /// The roll set point of the controller.
    pub roll_des_deg: f64,
    /// The roll of the vehicle.
    pub roll_deg: f64,
    /// The pitch set point of the controller.
    pub pitch_des_deg: f64,
    /// The pitch of the vehicle.
    pub pitch_deg: f64,
}

impl Attitude {
    /// `(roll_des - roll)^2 + (pitch_des - pitch)^2` in square degrees, each difference taken the shorter way around.
    /// (Eq. 1 of the paper prints a minus between the squares, which would let a roll error cancel a pitch error: an
    /// erratum.)
    pub fn squared_error_deg2(&self) -> f64 {
        let roll = libm::remainder(self.roll_des_deg - self.roll_deg, 360.0);
        let pitch = libm::remainder(self.pitch_des_deg - self.pitch_deg, 360.0);
        roll * roll + pitch * pitch
    }

    /// The tilt of the vehicle from level, in degrees: `acos(cos(roll) cos(pitch))`.
    pub fn tilt_deg(&self) -> f64 {
        tilt_deg(self.roll_deg, self.pitch_deg)
    }

    /// The tilt of the set point from level, in degrees.
    pub fn commanded_tilt_deg(&self) -> f64 {
        tilt_deg(self.roll_des_deg, self.pitch_des_deg)
    }
}

fn tilt_deg(roll_deg: f64, pitch_deg: f64) -> f64 {
    let up = libm::cos(roll_deg.to_radians()) * libm::cos(pitch_deg.to_radians());
    libm::acos(up.clamp(-1.0, 1.0)).to_degrees()
}

impl Flight {
    /// The attitude over time, at the rate of `roll_deg`. Unknown angles are NaN.
    pub fn attitudes(&self) -> impl Iterator<Item = (f64, Attitude)> + '_ {
        let mut holds = ATTITUDE.map(|name| self.signal(name).map(|signal| signal.hold()));
        let times = self.signal("roll_deg").map_or(&[][..], |roll| roll.t_s);
        times.iter().map(move |&t_s| {
            let [roll_des_deg, roll_deg, pitch_des_deg, pitch_deg] = holds.each_mut().map(|hold| {
                let held = hold.as_mut().and_then(|hold| hold.at(t_s));
                held.unwrap_or(f64::NAN)
            });
            let attitude = Attitude {
                roll_des_deg,
                roll_deg,
                pitch_des_deg,
                pitch_deg,
            };
            (t_s, attitude)
        })
    }
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
        // With the minus of the printed equation, this error would be 0.
        assert_eq!(error(4.0, 0.0, 4.0, 0.0), 32.0);
    }

    #[test]
    fn angles_differ_the_short_way_round() {
        approx::assert_abs_diff_eq!(error(179.0, -179.0, 0.0, 0.0), 4.0, epsilon = 1e-9);
    }
}
