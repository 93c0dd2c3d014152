//! Computes motor commands from torque and thrust set points, like PX4's control allocation
//! (<https://docs.px4.io/main/en/concept/control_allocation.html>).

use crate::geometry::rotor_effects;
use crate::parameters::Parameters;

/// The number of set points: roll, pitch and yaw torque, and thrust along z (down).
const AXES: usize = 4;
/// Contributions to a command smaller than this count as 0, before and after scaling.
const SMALLEST: f64 = 1e-3;
/// A pivot smaller than this share of the largest number means that some torque cannot be produced.
const SINGULAR: f64 = 1e-9;

/// The contribution of each set point to the command of each motor.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Allocation {
    parts: Vec<[f64; AXES]>,
}

impl Allocation {
    /// The allocation of a multirotor with upright rotors that spin in one direction; `None` for other vehicles, and if
    /// the parameters do not describe the rotors.
    pub(crate) fn of(parameters: &Parameters) -> Option<Self> {
        let is_zero = |name| parameters.get(name).is_none_or(|value| value == 0.0);
        if !is_zero("CA_AIRFRAME") || !is_zero("CA_R_REV") {
            return None;
        }
        let effects = rotor_effects(parameters).filter(|effects| !effects.is_empty())?;
        let is_upright = |[x, y, _]: &[f64; 3]| x.abs().max(y.abs()) < 1e-6;
        if !effects.iter().all(|(_, force)| is_upright(force)) {
            return None;
        }
        let effects: Vec<[f64; AXES]> = effects
            .into_iter()
            .map(|([roll, pitch, yaw], [_, _, down])| [roll, pitch, yaw, down])
            .collect();
        let mut parts = pseudo_inverse(&effects)?;
        let scales = scales(&parts);
        for part in parts.iter_mut() {
            for (part, scale) in part.iter_mut().zip(scales) {
                *part /= scale;
                if part.abs() < SMALLEST {
                    *part = 0.0;
                }
            }
        }
        Some(Self { parts })
    }

    /// The number of motors.
    pub(crate) fn motors(&self) -> usize {
        self.parts.len()
    }

    /// The commands, clipped to 0..1; NaN if a set point is unknown. PX4 does not clip commands but lowers the set
    /// points, so if one command is clipped, the commands of the other motors are only estimates.
    pub(crate) fn commands(&self, set_points: [f64; AXES]) -> impl Iterator<Item = f64> {
        self.parts.iter().map(move |parts| {
            let products = parts.iter().zip(set_points).map(|(part, set)| part * set);
            products.sum::<f64>().clamp(0.0, 1.0)
        })
    }
}

/// The least-squares commands for a unit of each effect: `B^T (B B^T)^-1`, one row for each motor.
fn pseudo_inverse(effects: &[[f64; AXES]]) -> Option<Vec<[f64; AXES]>> {
    // Each row is solved for its motor: (B B^T) x = effects of the motor.
    let mut squares = [[0.0; AXES]; AXES];
    for effect in effects {
        for (row, one) in squares.iter_mut().zip(effect) {
            for (sum, other) in row.iter_mut().zip(effect) {
                *sum += one * other;
            }
        }
    }
    effects
        .iter()
        .map(|effect| solve(squares, *effect))
        .collect()
}

/// The solution of linear equations, by elimination with the largest pivots; `None` if it is not unique.
fn solve(mut matrix: [[f64; AXES]; AXES], mut right: [f64; AXES]) -> Option<[f64; AXES]> {
    let largest = matrix
        .iter()
        .flatten()
        .fold(0.0_f64, |most, x| most.max(x.abs()));
    for column in 0..AXES {
        let pivot = (column..AXES)
            .max_by(|&a, &b| matrix[a][column].abs().total_cmp(&matrix[b][column].abs()))?;
        let size = matrix[pivot][column].abs();
        if size.is_nan() || size <= SINGULAR * largest {
            return None;
        }
        matrix.swap(column, pivot);
        right.swap(column, pivot);
        let (pivots, known) = (matrix[column], right[column]);
        let rows = matrix.iter_mut().zip(&mut right).enumerate();
        for (_, (row, right)) in rows.filter(|(row, _)| *row != column) {
            let factor = row[column] / pivots[column];
            for (own, pivot) in row.iter_mut().zip(pivots) {
                *own -= factor * pivot;
            }
            *right -= factor * known;
        }
    }
    Some(std::array::from_fn(|i| right[i] / matrix[i][i]))
}

/// The scales that normalise the set points of each axis. Roll and pitch are scaled together, by the larger of the
/// two, so that the contributions of a quadrotor are 0.71; yaw is scaled so that its largest contribution is 1, and
/// thrust so that its mean contribution is 1.
fn scales(parts: &[[f64; AXES]]) -> [f64; AXES] {
    let of_axis = |axis: usize| parts.iter().map(move |parts| parts[axis]);
    let turning = |axis: usize| {
        let used = of_axis(axis).filter(|part| part.abs() > SMALLEST).count();
        let squares: f64 = of_axis(axis).map(|part| part * part).sum();
        (used > 0).then(|| (squares / (used as f64 / 2.0)).sqrt())
    };
    let tilt = turning(0).unwrap_or(1.0).max(turning(1).unwrap_or(1.0));
    let yaw = of_axis(2).fold(0.0, f64::max);
    let lifting = of_axis(3).filter(|part| part.abs() > f64::from(f32::EPSILON));
    let (sum, count) = lifting.fold((0.0, 0), |(sum, count), part| (sum + part.abs(), count + 1));
    let thrust = sum / f64::from(count);
    [tilt, tilt, yaw, thrust].map(|scale| if scale > 0.0 { scale } else { 1.0 })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parameters(pairs: &[(&str, f64)], rotors: &[[f64; 3]]) -> Parameters {
        let mut parameters: Parameters = pairs.iter().copied().collect();
        parameters.insert("CA_ROTOR_COUNT", rotors.len() as f64);
        for (rotor, [x, y, km]) in rotors.iter().enumerate() {
            for (name, value) in [("PX", x), ("PY", y), ("KM", km)] {
                parameters.insert(&format!("CA_ROTOR{rotor}_{name}"), *value);
            }
        }
        parameters
    }

    const QUAD: [[f64; 3]; 4] = [
        [0.15, 0.15, 0.05],
        [-0.15, -0.15, 0.05],
        [0.15, -0.15, -0.05],
        [-0.15, 0.15, -0.05],
    ];

    /// The contributions for a symmetric quadrotor are those in PX4's documentation, independent of its size.
    #[test]
    fn set_points_of_a_quadrotor_are_shared_among_its_motors() {
        for size in [0.5, 1.0, 4.0] {
            let rotors = QUAD.map(|[x, y, km]| [size * x, size * y, km]);
            let allocation = Allocation::of(&parameters(&[], &rotors)).unwrap();
            let commands: Vec<f64> = allocation.commands([0.1, 0.2, 0.05, -0.5]).collect();
            let half = 0.5_f64.sqrt();
            for (command, [x, y, km]) in commands.iter().zip(QUAD) {
                let own = 0.5 + half * (0.2 * x.signum() - 0.1 * y.signum()) + 0.05 * km.signum();
                assert!((command - own).abs() < 1e-9, "{commands:?}");
            }
        }
    }

    #[test]
    fn commands_are_clipped_and_unknown_set_points_give_no_command() {
        let allocation = Allocation::of(&parameters(&[], &QUAD)).unwrap();
        let mut commands = allocation.commands([1.0, 0.0, 0.0, -0.9]);
        let first = commands.next().unwrap();
        assert!((first - (0.9 - 0.5_f64.sqrt())).abs() < 1e-9, "{first}");
        assert_eq!(commands.next(), Some(1.0));
        assert!(
            allocation
                .commands([f64::NAN, 0.0, 0.0, -0.9])
                .all(f64::is_nan)
        );
    }

    #[test]
    fn other_vehicles_have_no_allocation() {
        let collinear = QUAD.map(|[x, _, km]| [x, x, km]);
        for parameters in [
            parameters(&[("CA_AIRFRAME", 2.0)], &QUAD),
            parameters(&[("CA_R_REV", 1.0)], &QUAD),
            parameters(&[("CA_ROTOR0_AX", 0.3)], &QUAD),
            parameters(&[], &QUAD.map(|[x, y, _]| [x, y, 0.0])),
            parameters(&[], &collinear),
            parameters(&[], &[]),
        ] {
            assert_eq!(Allocation::of(&parameters), None);
        }
    }
}
