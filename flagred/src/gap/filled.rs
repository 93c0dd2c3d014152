//! The grid of knots and values that fills gaps of the rules.

#[cfg(feature = "std")]
use fuzzy::engine::Interval;

/// Knots with their values. Values between knots are interpolated linearly along each input.
#[derive(Debug, Clone, Copy)]
pub struct FilledKnots<'a> {
    /// The coordinates of the knots along each input, ascending: all of the first input, then all of the second, and so
    /// on.
    pub coordinates: &'a [f64],
    /// The index in `coordinates` of the first coordinate of each input, followed by the length of `coordinates`.
    pub starts: &'a [u32],
    /// The value at each knot; the last input varies fastest.
    pub values: &'a [f64],
    /// The distance of each knot to the nearest covered knot, in shares of the inputs' ranges.
    pub distances: &'a [f64],
}

/// A value that is interpolated where no rule applies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reading {
    /// The value.
    pub value: f64,
    /// The distance to the nearest covered knot, in shares of the inputs' ranges, interpolated in the same way.
    pub distance: f64,
}

impl FilledKnots<'_> {
    /// Interpolates at a point with one coordinate for each input; beyond the outermost knots the value is constant.
    /// `None` if the point has another number of coordinates, or if one is NaN.
    pub fn read(&self, point: &[f64]) -> Option<Reading> {
        let axes = self.starts.len().checked_sub(1)?;
        let axis = |axis: usize| {
            let (start, end) = (self.starts.get(axis)?, self.starts.get(axis + 1)?);
            self.coordinates.get(*start as usize..*end as usize)
        };
        Some(Reading {
            value: read(axes, &axis, self.values, point)?,
            distance: read(axes, &axis, self.distances, point)?,
        })
    }

    /// The smallest and the largest value within intervals. Between knots the value is linear along each input, so both
    /// extremes are at vertices of the grid formed by the knots inside the intervals and the ends of the intervals. If
    /// there are too many vertices, this is the range of all values. `None` if there is not one interval for each input.
    #[cfg(feature = "std")]
    pub(crate) fn within(&self, inputs: &[Interval]) -> Option<Interval> {
        const MAX_VERTICES: usize = 4096;
        let mut points = alloc::vec![alloc::vec::Vec::new()];
        for (axis, interval) in inputs.iter().enumerate() {
            let (start, end) = (self.starts.get(axis)?, self.starts.get(axis + 1)?);
            let coordinates = self.coordinates.get(*start as usize..*end as usize)?;
            let inside = coordinates.iter().copied();
            let inside = inside.filter(|x| interval.low < *x && *x < interval.high);
            let along = || {
                [interval.low, interval.high]
                    .into_iter()
                    .chain(inside.clone())
            };
            let count = if interval.width() > 0.0 {
                usize::MAX
            } else {
                1
            };
            points = points
                .iter()
                .flat_map(|point| {
                    along()
                        .take(count)
                        .map(move |x| [&point[..], &[x]].concat())
                })
                .collect();
            if points.len() > MAX_VERTICES {
                return hull(self.values.iter().copied());
            }
        }
        hull(
            points
                .iter()
                .filter_map(|point| Some(self.read(point)?.value)),
        )
    }

    /// Whether there are coordinates along each input, and a value and a distance for each knot.
    pub(crate) fn is_whole(&self, inputs: usize) -> bool {
        let lengths = self.starts.windows(2).map(|pair| match pair {
            [start, end] => end.saturating_sub(*start) as usize,
            _ => 0,
        });
        let knots = lengths.fold(1, usize::saturating_mul);
        let rises = |pair: &[u32]| pair.is_sorted();
        self.starts.len() == inputs + 1
            && self.starts.windows(2).all(rises)
            && self.starts.last().map(|end| *end as usize) == Some(self.coordinates.len())
            && knots > 0
            && self.values.len() == knots
            && self.distances.len() == knots
    }
}

/// The smallest interval that contains all values; `None` without any.
#[cfg(feature = "std")]
fn hull(values: impl Iterator<Item = f64>) -> Option<Interval> {
    values.map(Interval::from).reduce(Interval::hull)
}

/// Interpolates values at knots linearly along each axis; beyond the outermost knots the value is constant. `None` if
/// the point has another number of coordinates, or if one is NaN.
pub(super) fn read<'a>(
    axes: usize,
    axis: &impl Fn(usize) -> Option<&'a [f64]>,
    values: &[f64],
    point: &[f64],
) -> Option<f64> {
    let fits = point.len() == axes && point.iter().all(|x| !x.is_nan());
    fits.then(|| read_from(axis, values, point, 0, 0)).flatten()
}

fn read_from<'a>(
    axis: &impl Fn(usize) -> Option<&'a [f64]>,
    values: &[f64],
    point: &[f64],
    depth: usize,
    knot: usize,
) -> Option<f64> {
    let Some(&x) = point.get(depth) else {
        return values.get(knot).copied();
    };
    let coordinates = axis(depth)?;
    let behind = coordinates.partition_point(|place| *place <= x);
    let at = |place| {
        read_from(
            axis,
            values,
            point,
            depth + 1,
            knot * coordinates.len() + place,
        )
    };
    let (Some(left), Some(right)) = (
        behind.checked_sub(1).and_then(|i| coordinates.get(i)),
        coordinates.get(behind),
    ) else {
        return at(behind.saturating_sub(1));
    };
    let share = (x - left) / (right - left);
    if share == 0.0 {
        return at(behind - 1);
    }
    Some((1.0 - share) * at(behind - 1)? + share * at(behind)?)
}
