//! The distance between knots, scaled by the typical change of the output between them.
//!
//! With distances in shares of the ranges, an input with a wide range and narrow terms would hardly count, and an
//! irrelevant input would count as much as a decisive one. Instead, the length of a step along an input is the root
//! mean square of the change of the output over such steps in the covered part. This is the geometric anisotropy of
//! geostatistics, at the shortest lag.

use alloc::vec::Vec;

use super::knots::Knots;

/// The minimum weight of an input, as a share of the largest weight, so that knots along it have different coordinates
/// even if the output hardly changes there.
const MIN_CHANGE: f64 = 1e-3;

/// Coordinates are rounded to multiples of this, so that equal distances are equal to the last bit.
const QUANTUM: f64 = 1.0 / (1u64 << 20) as f64;

/// The coordinates of the knots along each axis; the longest step between neighbours is 1.
pub(super) fn coordinates(knots: &Knots, values: &[f64], covered: &[bool]) -> Vec<Vec<f64>> {
    let axes = 0..knots.axes.len();
    let changes: Vec<Option<f64>> = axes
        .map(|axis| change_along(knots, values, covered, axis))
        .collect();
    let known = || changes.iter().flatten().copied();
    let largest = known().fold(0.0, f64::max);
    let mean = known().sum::<f64>() / known().count().max(1) as f64;
    // If the output does not change anywhere, all inputs count the same.
    let weight = |change: Option<f64>| match largest > 0.0 {
        true => (change.unwrap_or(mean) / largest).max(MIN_CHANGE),
        false => 1.0,
    };
    let steps = |axis: usize| -> Vec<f64> {
        let per_unit = weight(changes[axis]) / knots.ranges[axis];
        let pairs = knots.axes[axis].windows(2);
        pairs.map(|pair| (pair[1] - pair[0]) * per_unit).collect()
    };
    let steps: Vec<Vec<f64>> = (0..knots.axes.len()).map(steps).collect();
    let longest = steps.iter().flatten().copied().fold(0.0, f64::max);
    let coordinates = steps.iter().map(|steps| {
        let mut at = 0.0;
        let after = steps.iter().map(|step| {
            at += (libm::round(step / longest / QUANTUM) * QUANTUM).max(QUANTUM);
            at
        });
        core::iter::once(0.0).chain(after).collect()
    });
    coordinates.collect()
}

/// The root mean square of the change of the output along an axis, per range of the input, over pairs of covered
/// neighbours; `None` if there are no such pairs.
fn change_along(knots: &Knots, values: &[f64], covered: &[bool], axis: usize) -> Option<f64> {
    let pairs = (0..covered.len()).filter_map(|knot| Some((knot, knots.next(knot, axis)?)));
    let pairs = pairs.filter(|(a, b)| covered[*a] && covered[*b]);
    let (mut squares, mut count) = (0.0, 0);
    for (a, b) in pairs {
        let index = knots.index_along(a, axis);
        let step = knots.axes[axis][index + 1] - knots.axes[axis][index];
        let slope = (values[b] - values[a]) / (step / knots.ranges[axis]);
        squares += slope * slope;
        count += 1;
    }
    (count > 0).then(|| libm::sqrt(squares / f64::from(count)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec;

    #[test]
    fn a_step_counts_as_much_as_the_output_changes() {
        let axes = vec![vec![0.0, 1.0, 3.0], vec![0.0, 0.5]];
        let knots = Knots::over(axes, vec![10.0, 0.5]);
        // The values change by 4 per unit along the first input, and by 1 over half a unit along
        // the second.
        let values = [0.0, 1.0, 4.0, 5.0, 12.0, 13.0];
        let found = coordinates(&knots, &values, &[true; 6]);
        let expected = [vec![0.0, 0.5, 1.5], vec![0.0, 0.125]];
        for (found, expected) in found.iter().flatten().zip(expected.iter().flatten()) {
            approx::assert_abs_diff_eq!(*found, *expected, epsilon = 1e-6);
        }
    }

    #[test]
    fn inputs_without_effect_are_weighted_by_their_ranges() {
        let knots = Knots::over(vec![vec![0.0, 1.0], vec![0.0, 1.0]], vec![2.0, 1.0]);
        let found = coordinates(&knots, &[7.0; 4], &[true; 4]);
        assert_eq!(found, [vec![0.0, 0.5], vec![0.0, 1.0]]);
    }
}
