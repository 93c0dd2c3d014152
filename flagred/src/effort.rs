//! Efforts: the motor commands decomposed into roll, pitch, yaw and thrust.
//!
//! A mixer commands motor `i` with `e_i = roll r_i + pitch p_i + yaw y_i + thrust`, where the factors `(r_i, p_i, y_i)`
//! follow from its position and its direction of rotation. The efforts are the least-squares solution for all motors,
//! given by the pseudo-inverse of the matrix of factors.

/// The factors `[roll, pitch, yaw]` of a motor. Positive means that more thrust of this motor rolls the vehicle to the
/// right, raises the nose, or turns the nose to the right.
pub type Factors = [f64; 3];

/// Roll, pitch, yaw and thrust, in the unit of the commands.
pub(crate) type Efforts = [f64; 4];

pub(crate) const ROLL_PITCH_YAW_THRUST: usize = 4;

/// The efforts if the geometry or a motor is unknown.
pub(crate) const UNKNOWN: Efforts = [f64::NAN; ROLL_PITCH_YAW_THRUST];

/// The contribution of one unit of a motor's command to each effort: its column of the pseudo-inverse. The columns of
/// all motors are computed from the normal matrix of all factors.
///
/// `None` if the efforts cannot be separated, as with fewer than four motors, or if a factor is not finite.
pub(crate) fn column(normal: &Normal, factors: &Factors) -> Option<Efforts> {
    let [roll, pitch, yaw] = *factors;
    let shares = solve(normal, [roll, pitch, yaw, 1.0]);
    shares.filter(|shares| shares.iter().all(|share| share.is_finite()))
}

/// The sums of the products of the factors over all motors.
pub(crate) type Normal = [[f64; ROLL_PITCH_YAW_THRUST]; ROLL_PITCH_YAW_THRUST];

/// The normal matrix of the factors of all motors. An axis that no motor acts on gets an effort of 0.
pub(crate) fn normal(all: impl Iterator<Item = Factors>) -> Normal {
    let mut sums = [[0.0; ROLL_PITCH_YAW_THRUST]; ROLL_PITCH_YAW_THRUST];
    for [roll, pitch, yaw] in all {
        let row = [roll, pitch, yaw, 1.0];
        for (sums, a) in sums.iter_mut().zip(row) {
            for (sum, b) in sums.iter_mut().zip(row) {
                *sum += a * b;
            }
        }
    }
    for (axis, sums) in sums.iter_mut().enumerate() {
        if sums.iter().all(|sum| *sum == 0.0) {
            sums[axis] = 1.0;
        }
    }
    sums
}

/// Gaussian elimination with pivoting; `None` if the matrix is singular.
fn solve(matrix: &Normal, mut right: Efforts) -> Option<Efforts> {
    const SINGULAR: f64 = 1e-9;
    let mut rows = *matrix;
    for step in 0..ROLL_PITCH_YAW_THRUST {
        let largest = |a: &usize, b: &usize| rows[*a][step].abs().total_cmp(&rows[*b][step].abs());
        let pivot = (step..ROLL_PITCH_YAW_THRUST).max_by(largest)?;
        if rows[pivot][step].abs() < SINGULAR {
            return None;
        }
        rows.swap(step, pivot);
        right.swap(step, pivot);
        for below in step + 1..ROLL_PITCH_YAW_THRUST {
            let factor = rows[below][step] / rows[step][step];
            let pivot_row = rows[step];
            for (value, of_pivot) in rows[below].iter_mut().zip(pivot_row) {
                *value -= factor * of_pivot;
            }
            right[below] -= factor * right[step];
        }
    }
    for step in (0..ROLL_PITCH_YAW_THRUST).rev() {
        let known: f64 = (step + 1..ROLL_PITCH_YAW_THRUST)
            .map(|column| rows[step][column] * right[column])
            .sum();
        right[step] = (right[step] - known) / rows[step][step];
    }
    Some(right)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const QUAD_X: [Factors; 4] = [
        [-1.0, 1.0, 1.0],
        [1.0, -1.0, 1.0],
        [1.0, 1.0, -1.0],
        [-1.0, -1.0, -1.0],
    ];

    fn efforts(factors: &[Factors], commands: &[f64]) -> Option<Efforts> {
        let normal = normal(factors.iter().copied());
        let mut efforts = [0.0; 4];
        for (factors, command) in factors.iter().zip(commands) {
            for (effort, share) in efforts.iter_mut().zip(column(&normal, factors)?) {
                *effort += share * command;
            }
        }
        Some(efforts)
    }

    #[test]
    fn a_yaw_command_of_a_quad_has_effort_in_yaw_only() {
        let found = efforts(&QUAD_X, &[0.6, 0.6, 0.4, 0.4]).unwrap();
        for (found, expected) in found.into_iter().zip([0.0, 0.0, 0.1, 0.5]) {
            approx::assert_abs_diff_eq!(found, expected, epsilon = 1e-12);
        }
    }

    #[test]
    fn an_axis_without_factors_has_no_effort() {
        let tricopter = QUAD_X.map(|[roll, pitch, _]| [roll, pitch, 0.0]);
        let found = efforts(&tricopter, &[0.6, 0.6, 0.4, 0.4]).unwrap();
        assert_eq!(found[2], 0.0);
    }

    #[test]
    fn three_motors_have_no_efforts() {
        assert_eq!(efforts(&QUAD_X[..3], &[0.5; 3]), None);
    }

    #[test]
    fn factors_that_are_not_finite_have_no_efforts() {
        for odd in [f64::NAN, f64::INFINITY, f64::MAX] {
            let mut factors = QUAD_X;
            factors[2][1] = odd;
            assert_eq!(efforts(&factors, &[0.5; 4]), None, "{odd}");
        }
    }

    proptest! {
        #[test]
        fn mixed_commands_are_recovered(mixed in prop::array::uniform4(-0.2..0.2f64), turn in 0.0..1.0f64) {
            // An octocopter with motors at eight angles.
            let factors: Vec<Factors> = (0..8).map(|i| {
                let angle = (f64::from(i) + turn) * core::f64::consts::FRAC_PI_4;
                [angle.sin(), angle.cos(), if i % 2 == 0 { 1.0 } else { -1.0 }]
            }).collect();
            let commands: Vec<f64> = factors.iter()
                .map(|[r, p, y]| mixed[0] * r + mixed[1] * p + mixed[2] * y + mixed[3])
                .collect();
            let found = efforts(&factors, &commands).unwrap();
            for (found, mixed) in found.into_iter().zip(mixed) {
                prop_assert!((found - mixed).abs() < 1e-9);
            }
        }
    }
}
