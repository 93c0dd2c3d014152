//! The knots at which a rule set is evaluated, and from which its gaps are filled.

use alloc::{vec, vec::Vec};

use fuzzy::{
    Model,
    map::{changing, peaks},
};

use super::filled::read;

/// The maximum number of knots at the peaks and between them. Larger grids are thinned, which bounds the cost of filling for
/// any number of inputs.
const MAX_KNOTS: usize = 40_000;

/// A grid over the inputs of a rule set, with a coordinate at the peak of every term and a coordinate halfway
/// between every two neighbouring peaks.
///
/// At a peak a single term applies. Halfway between two peaks both terms apply equally, so the gap that a missing
/// rule leaves ends there.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Knots {
    /// The coordinates of the knots along each input, ascending.
    pub(super) axes: Vec<Vec<f64>>,
    /// The width of each input's range.
    pub(super) ranges: Vec<f64>,
    /// The difference between the indices of neighbours along each input; the last input varies
    /// fastest.
    strides: Vec<usize>,
}

impl Knots {
    /// The grid over the part of each input in which terms change; beyond this part the rules cannot distinguish
    /// points. An input whose name is not in `read` has one coordinate.
    ///
    /// `None` if the grid is too large even with two coordinates for each input, as for 16 inputs.
    pub(super) fn of(model: &Model, read: &[&str]) -> Option<Knots> {
        let axes = model.inputs.iter().map(|input| {
            if !read.contains(&input.name.as_str()) {
                return vec![input.low];
            }
            let (first, last) = changing(input);
            let mut peaks = peaks(input);
            peaks.retain(|x| (first..=last).contains(x));
            peaks
        });
        let mut axes: Vec<Vec<f64>> = axes.collect();
        let finer: Vec<Vec<f64>> = axes.iter().map(|peaks| with_middles(peaks)).collect();
        if count(&finer) <= MAX_KNOTS {
            axes = finer;
        }
        while count(&axes) > MAX_KNOTS {
            let longest = axes.iter_mut().max_by_key(|axis| axis.len());
            let longest = longest.filter(|axis| axis.len() > 2)?;
            let last = longest.len() - 1;
            let mut i = 0..;
            longest.retain(|_| i.next().is_some_and(|i| i % 2 == 0 || i == last));
        }
        let ranges = model.inputs.iter().map(|i| i.high - i.low);
        Some(Knots::over(axes, ranges.collect()))
    }

    /// The same grid, extended to the ends of the inputs' ranges, unless this makes it larger than four times the maximum.
    pub(super) fn with_ends(&self, model: &Model) -> Knots {
        let axes = self
            .axes
            .iter()
            .zip(&model.inputs)
            .map(|(coordinates, input)| {
                if coordinates.len() == 1 {
                    return coordinates.clone();
                }
                let before =
                    Some(input.low).filter(|low| coordinates.first().is_some_and(|x| low < x));
                let behind =
                    Some(input.high).filter(|high| coordinates.last().is_some_and(|x| high > x));
                before
                    .into_iter()
                    .chain(coordinates.iter().copied())
                    .chain(behind)
                    .collect()
            });
        let axes: Vec<Vec<f64>> = axes.collect();
        match count(&axes) <= 4 * MAX_KNOTS {
            true => Knots::over(axes, self.ranges.clone()),
            false => self.clone(),
        }
    }

    /// A grid with the given coordinates.
    pub(super) fn over(axes: Vec<Vec<f64>>, ranges: Vec<f64>) -> Knots {
        let mut strides = vec![1; axes.len()];
        for axis in (1..axes.len()).rev() {
            strides[axis - 1] = strides[axis] * axes[axis].len();
        }
        Knots {
            axes,
            ranges,
            strides,
        }
    }

    /// The number of knots.
    pub(super) fn count(&self) -> usize {
        count(&self.axes)
    }

    /// The index of a knot along an axis.
    pub(super) fn index_along(&self, knot: usize, axis: usize) -> usize {
        knot / self.strides[axis] % self.axes[axis].len()
    }

    /// The coordinates of a knot.
    pub(super) fn point(&self, knot: usize) -> Vec<f64> {
        let axes = self.axes.iter().enumerate();
        axes.map(|(axis, coordinates)| coordinates[self.index_along(knot, axis)])
            .collect()
    }

    /// The next knot along an axis.
    pub(super) fn next(&self, knot: usize, axis: usize) -> Option<usize> {
        let behind = self.index_along(knot, axis) + 1 < self.axes[axis].len();
        behind.then(|| knot + self.strides[axis])
    }

    /// The previous knot along an axis.
    pub(super) fn previous(&self, knot: usize, axis: usize) -> Option<usize> {
        (self.index_along(knot, axis) > 0).then(|| knot - self.strides[axis])
    }

    /// The coordinates of all knots, one column for each input.
    pub(super) fn columns(&self) -> Vec<Vec<f64>> {
        let column = |(axis, coordinates): (usize, &Vec<f64>)| {
            let knots = 0..self.count();
            knots
                .map(|knot| coordinates[self.index_along(knot, axis)])
                .collect()
        };
        self.axes.iter().enumerate().map(column).collect()
    }

    /// Interpolates values at the knots, see [`read`].
    pub(super) fn read(&self, values: &[f64], point: &[f64]) -> Option<f64> {
        let axis = |axis: usize| self.axes.get(axis).map(Vec::as_slice);
        read(self.axes.len(), &axis, values, point)
    }
}

fn count(axes: &[Vec<f64>]) -> usize {
    let times = |n: usize, axis: &Vec<f64>| n.saturating_mul(axis.len());
    axes.iter().fold(1, times)
}

/// Adds a coordinate halfway between every two neighbours.
fn with_middles(coordinates: &[f64]) -> Vec<f64> {
    let middles = coordinates.windows(2).map(|pair| (pair[0] + pair[1]) / 2.0);
    let mut all: Vec<f64> = middles.chain(coordinates.iter().copied()).collect();
    all.sort_by(f64::total_cmp);
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all_knots(model: &Model) -> Knots {
        let names: Vec<&str> = model.inputs.iter().map(|i| i.name.as_str()).collect();
        Knots::of(model, &names).unwrap()
    }

    fn knots(inputs: &str) -> Knots {
        let text = format!(
            "
fuzzy: 1
name: test
inputs: {{{inputs}}}
outputs: {{y: {{range: [0, 1], partition: [low, high]}}}}
rules: []
"
        );
        all_knots(&fuzzy::yaml::parse(&text).unwrap().model)
    }

    fn coordinates_of(terms: &str) -> Vec<f64> {
        knots(&format!("x: {{range: [0, 1], {terms}}}"))
            .axes
            .remove(0)
    }

    #[test]
    fn a_partition_has_knots_at_peaks_and_between_them() {
        let coordinates = coordinates_of("partition: {low: 0.2, middle: 0.4, high: 0.8}");
        let expected = [0.2, 0.3, 0.4, 0.6, 0.8];
        assert_eq!(coordinates.len(), expected.len());
        for (found, expected) in coordinates.iter().zip(expected) {
            approx::assert_abs_diff_eq!(*found, expected, epsilon = 1e-12);
        }
    }

    #[test]
    fn the_ends_of_the_range_become_knots_beyond_the_outermost_peaks() {
        let text = "
fuzzy: 1
name: test
inputs: {x: {range: [0, 1], partition: {low: 0, high: 0.5}}}
outputs: {y: {range: [0, 1], partition: [low, high]}}
rules: []
";
        let model = fuzzy::yaml::parse(text).unwrap().model;
        let knots = all_knots(&model);
        assert_eq!(knots.axes, [[0.0, 0.25, 0.5]]);
        assert_eq!(knots.with_ends(&model).axes, [[0.0, 0.25, 0.5, 1.0]]);
    }

    #[test]
    fn interpolation_is_linear_between_knots_and_constant_beyond() {
        let knots = Knots::over(vec![vec![0.0, 1.0, 3.0], vec![0.0, 2.0]], vec![3.0, 2.0]);
        let plane: Vec<f64> = (0..6)
            .map(|knot| knots.axes[0][knot / 2] + 10.0 * knots.axes[1][knot % 2])
            .collect();
        let read = |point: &[f64]| knots.read(&plane, point);
        assert_eq!(read(&[2.0, 0.5]), Some(7.0));
        assert_eq!(read(&[-5.0, 9.0]), Some(20.0));
        assert_eq!(read(&[3.0, 2.0]), Some(23.0));
        assert_eq!((read(&[1.0]), read(&[f64::NAN, 0.0])), (None, None));
    }

    #[test]
    fn many_inputs_have_fewer_knots_each() {
        let input = |i| format!("x{i}: {{range: [0, 1], partition: [a, b, c, d, e]}}");
        let inputs: Vec<String> = (0..7).map(input).collect();
        let knots = knots(&inputs.join(", "));
        assert!(knots.count() <= MAX_KNOTS, "{}", knots.count());
        for coordinates in &knots.axes {
            assert_eq!(
                (coordinates[0], coordinates[coordinates.len() - 1]),
                (0.0, 1.0)
            );
        }
    }
}
