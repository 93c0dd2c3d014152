//! Motor commands without their yaw part.

/// The commands without their yaw part: `e_i - y_i yaw`, with the yaw effort of the least-squares solution of
/// `e_i = roll r_i + pitch p_i + yaw y_i + thrust`. The commands are unchanged if the factors do not determine the yaw
/// effort.
pub fn less_yaw(commands: &[f64], factors: &[[f64; 3]]) -> Vec<f64> {
    let Some(yaw) = yaw(commands, factors) else {
        return commands.to_vec();
    };
    let of_motors = commands.iter().zip(factors);
    of_motors.map(|(e, of)| e - of[2] * yaw).collect()
}

/// The yaw effort: the projection on the part of the yaw factors orthogonal to roll, pitch and thrust (Gram-Schmidt).
fn yaw(commands: &[f64], factors: &[[f64; 3]]) -> Option<f64> {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let column = |axis: usize| factors.iter().map(|of| of[axis]).collect::<Vec<f64>>();
    let mut basis: Vec<Vec<f64>> = Vec::new();
    let mut yaw = 0.0;
    for of in [vec![1.0; factors.len()], column(0), column(1), column(2)] {
        let mut rest = of.clone();
        // This is done twice, so that rounding errors are orthogonal as well.
        for other in basis.iter().chain(&basis) {
            let share = dot(&rest, other) / dot(other, other);
            let parts = rest.iter_mut().zip(other);
            parts.for_each(|(x, y)| *x -= share * y);
        }
        let length = dot(&rest, &rest);
        yaw = 0.0;
        if length > 1e-9 {
            yaw = dot(commands, &rest) / length;
            basis.push(rest);
        } else if of.is_empty() || dot(&of, &of) > 0.0 {
            return None;
        }
    }
    Some(yaw)
}
