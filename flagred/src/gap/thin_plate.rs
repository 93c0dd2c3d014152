//! The thin-plate spline: the smoothest surface through the covered knots around a point (Duchon 1977).
//!
//! `f(x) = a + b x + sum_i w_i phi(|x - c_i|)`, `phi(r) = r^2 ln r`, with weights such that f has the known values at
//! the centres c_i and `sum w_i = 0`, `sum w_i c_i = 0`. The centres are the covered knots nearest to the point; with
//! two inputs these are nearly all of them. The surface continues slopes beyond the known values, so it can overshoot;
//! values are kept within the range of the output.

use super::{field::Field, neighbours::Tree};

/// The number of covered knots that shape the surface at a point: the first number applies with up to two inputs,
/// the second with more. More knots change the filled values of our maps by less than 1 %.
const NEIGHBOURS: (usize, usize) = (32, 64);

/// A penalty on slopes. If the neighbours are in one plane, the slope across it is undetermined, and the penalty makes
/// it 0. Elsewhere it has no visible effect.
const COST_OF_SLOPE: f64 = 1e-7;

/// Fills the knots that are not covered, within `range`.
pub(super) fn fill(field: &mut Field, range: (f64, f64)) {
    let known = field.known_highest_first();
    let dimensions = field.coordinates.len();
    let mut tree = Tree::new(dimensions, field.points(&known));
    let count = if dimensions <= 2 {
        NEIGHBOURS.0
    } else {
        NEIGHBOURS.1
    };
    for knot in field.gap() {
        let point = field.point(knot);
        let neighbours: Vec<usize> = tree
            .nearest(&point, count)
            .iter()
            .filter_map(|(_, index)| known.get(*index).copied())
            .collect();
        // The centres are relative to the point, so that the constant of the spline is the value at the point.
        let centres: Vec<Vec<f64>> = neighbours
            .iter()
            .map(|n| {
                let centre = field.point(*n);
                centre.iter().zip(&point).map(|(c, x)| c - x).collect()
            })
            .collect();
        let known: Vec<f64> = neighbours.iter().map(|n| field.values[*n]).collect();
        if let Some(value) = value_at_origin(&centres, &known) {
            field.values[knot] = value.clamp(range.0, range.1);
        }
    }
}

/// The spline through `known` values at `centres`, evaluated at the origin.
fn value_at_origin(centres: &[Vec<f64>], known: &[f64]) -> Option<f64> {
    let dimensions = centres.first()?.len();
    let n = centres.len();
    let size = n + dimensions + 1;
    let mut rows = vec![vec![0.0; size + 1]; size];
    for (i, centre) in centres.iter().enumerate() {
        for (j, other) in centres.iter().enumerate() {
            rows[i][j] = phi(centre.iter().zip(other).map(|(a, b)| a - b));
        }
        rows[i][n] = 1.0;
        rows[n][i] = 1.0;
        for (d, x) in centre.iter().enumerate() {
            rows[i][n + 1 + d] = *x;
            rows[n + 1 + d][i] = *x;
        }
        rows[i][size] = known[i];
    }
    for (i, row) in rows.iter_mut().enumerate().skip(n + 1) {
        row[i] = -COST_OF_SLOPE;
    }
    let solution = solve(rows)?;
    let (weights, plane) = solution.split_at(n);
    let bumps = weights
        .iter()
        .zip(centres)
        .map(|(w, c)| w * phi(c.iter().copied()));
    Some(plane.first()? + bumps.sum::<f64>())
}

/// `phi(r) = r^2 ln r = r^2 ln(r^2) / 2`, where `r` is the length of `difference`.
fn phi(difference: impl Iterator<Item = f64>) -> f64 {
    let square: f64 = difference.map(|x| x * x).sum();
    if square > 0.0 {
        0.5 * square * libm::log(square)
    } else {
        0.0
    }
}

/// Solves linear equations, given as rows with the right side last, by elimination with partial pivoting; `None` if the
/// system is singular.
fn solve(mut rows: Vec<Vec<f64>>) -> Option<Vec<f64>> {
    let n = rows.len();
    for column in 0..n {
        let size = |row: &usize| rows[*row][column].abs();
        let pivot = (column..n).max_by(|a, b| size(a).total_cmp(&size(b)).then(b.cmp(a)))?;
        rows.swap(column, pivot);
        let (above, below) = rows.split_at_mut(column + 1);
        let lead = &above[column];
        for row in below {
            let factor = row[column] / lead[column];
            if factor != 0.0 {
                for (x, l) in row[column..].iter_mut().zip(&lead[column..]) {
                    *x -= factor * l;
                }
            }
        }
    }
    let mut solution = vec![0.0; n];
    for i in (0..n).rev() {
        let done: f64 = (i + 1..n).map(|j| rows[i][j] * solution[j]).sum();
        solution[i] = (rows[i][n] - done) / rows[i][i];
    }
    solution.iter().all(|x| x.is_finite()).then_some(solution)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(centres: &[[f64; 2]], known: &[f64], point: [f64; 2]) -> f64 {
        let centres: Vec<Vec<f64>> = centres
            .iter()
            .map(|c| vec![c[0] - point[0], c[1] - point[1]])
            .collect();
        value_at_origin(&centres, known).unwrap()
    }

    #[test]
    fn the_spline_interpolates_its_centres_and_reproduces_planes() {
        let centres: Vec<[f64; 2]> = (0..12)
            .map(|i| [f64::from(i % 4) / 3.0, f64::from(i / 4) / 2.0])
            .collect();
        let plane = |c: [f64; 2]| 20.0 + 30.0 * c[0] - 10.0 * c[1];
        let known: Vec<f64> = centres.iter().map(|c| plane(*c)).collect();
        let beyond = [2.0, -1.0];
        approx::assert_abs_diff_eq!(at(&centres, &known, beyond), plane(beyond), epsilon = 1e-4);

        let bumpy: Vec<f64> = (0..12).map(|i| f64::from(i * i % 7)).collect();
        for (centre, value) in centres.iter().zip(&bumpy) {
            approx::assert_abs_diff_eq!(at(&centres, &bumpy, *centre), value, epsilon = 1e-4);
        }
    }

    const SCIPY_CENTRES: [[f64; 2]; 9] = [
        [0.09, 0.24],
        [0.8, 0.58],
        [0.09, 0.43],
        [0.48, 0.16],
        [0.73, 0.11],
        [0.39, 0.52],
        [0.43, 0.59],
        [0.74, 0.96],
        [0.28, 0.65],
    ];
    const SCIPY_KNOWN: [f64; 9] = [69.6, 29.3, 0.1, 97.3, 29.8, 31.4, 89.2, 58.5, 47.1];
    const SCIPY_POINTS: [([f64; 2], f64); 4] = [
        ([0.88, -0.16], 21.134210381),
        ([0.79, 0.32], 15.466102392),
        ([-0.07, 0.72], 8.507749443),
        ([1.1, 0.09], -37.796746890),
    ];

    // Computed with scipy 1.17.1: RBFInterpolator(centres, known, kernel="thin_plate_spline")(points).
    #[test]
    fn the_spline_agrees_with_scipy() {
        for (point, expected) in SCIPY_POINTS {
            approx::assert_abs_diff_eq!(
                at(&SCIPY_CENTRES, &SCIPY_KNOWN, point),
                expected,
                epsilon = 1e-4
            );
        }
    }

    #[test]
    fn the_spline_is_constant_across_a_plane_of_centres() {
        let line: Vec<[f64; 2]> = (0..6).map(|i| [f64::from(i) / 5.0, 0.5]).collect();
        let known: Vec<f64> = (0..6).map(|i| 10.0 * f64::from(i)).collect();
        approx::assert_abs_diff_eq!(at(&line, &known, [0.4, 0.5]), 20.0, epsilon = 1e-4);
        approx::assert_abs_diff_eq!(at(&line, &known, [0.4, 0.45]), 20.0, epsilon = 1.0);
    }
}
