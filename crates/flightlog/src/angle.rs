//! Attitude angles from quaternions.

/// One of the attitude angles, for rotations in the order yaw, pitch, roll (ZYX).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Angle {
    Roll,
    Pitch,
    Yaw,
}

impl Angle {
    /// The angle in degrees of the quaternion `[w, x, y, z]`.
    pub(crate) fn of(self, [w, x, y, z]: [f64; 4]) -> f64 {
        match self {
            Self::Roll => (2.0 * (w * x + y * z)).atan2(1.0 - 2.0 * (x * x + y * y)),
            Self::Pitch => (2.0 * (w * y - z * x)).clamp(-1.0, 1.0).asin(),
            Self::Yaw => (2.0 * (w * z + x * y)).atan2(1.0 - 2.0 * (y * y + z * z)),
        }
        .to_degrees()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_of_single_turns() {
        let half = 15.0_f64.to_radians();
        let (c, s) = (half.cos(), half.sin());
        for (angle, turn) in [
            (Angle::Roll, [c, s, 0.0, 0.0]),
            (Angle::Pitch, [c, 0.0, s, 0.0]),
            (Angle::Yaw, [c, 0.0, 0.0, s]),
        ] {
            for other in [Angle::Roll, Angle::Pitch, Angle::Yaw] {
                let expected = if other == angle { 30.0 } else { 0.0 };
                let found = other.of(turn);
                assert!((found - expected).abs() < 1e-12, "{other:?} of {angle:?}");
            }
        }
    }
}
