//! Equidistant points on a range, and reading between them.

/// Equidistant points from `low` to `high`, both included.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Scale {
    /// The first point.
    pub low: f64,
    /// The last point.
    pub high: f64,
    /// The number of points, at least 2.
    pub points: u32,
}

impl Scale {
    /// The coordinate of a point: `low + i (high - low) / (points - 1)`; the last is `high` itself.
    pub fn coordinate(&self, i: usize) -> f64 {
        let points = self.points as usize;
        if i + 1 >= points {
            self.high
        } else {
            self.low + (self.high - self.low) * (i as f64 / (points - 1) as f64)
        }
    }

    /// The points around `x` and how far it lies between them, in [0, 1]; beyond the ends, the end.
    pub fn locate(&self, x: f64) -> (usize, f64) {
        let points = self.points as usize;
        let last = points.saturating_sub(2);
        let place = (x - self.low) / (self.high - self.low) * (points - 1) as f64;
        if place > 0.0 {
            let i = (place as usize).min(last);
            (i, (place - i as f64).min(1.0))
        } else {
            (0, 0.0)
        }
    }
}

/// Reads values on the cells of a grid N-linearly at a point; beyond the grid's ends, at the end. The last scale runs
/// fastest; `scales` gives `None` beyond it.
///
/// `None` where a cell that counts there has no value, or the point has too few coordinates.
///
/// # Example: between four cells
/// ```
/// use fuzzy::scale::{Scale, interpolate};
///
/// let scale = Scale { low: 0.0, high: 1.0, points: 2 };
/// let scales = [scale, scale];
/// let cells = [0.0, 10.0, 20.0, 30.0];
/// let middle = interpolate(&|i| scales.get(i).copied(), &mut |cell| cells.get(cell).copied(), &[0.5, 0.5]);
/// assert_eq!(middle, Some(15.0));
/// ```
pub fn interpolate(
    scales: &impl Fn(usize) -> Option<Scale>,
    value: &mut impl FnMut(usize) -> Option<f64>,
    point: &[f64],
) -> Option<f64> {
    corner_sum(scales, value, point, 0, 0)
}

/// Interpolates along one scale between what the further ones give on both sides.
fn corner_sum(
    scales: &impl Fn(usize) -> Option<Scale>,
    value: &mut impl FnMut(usize) -> Option<f64>,
    point: &[f64],
    depth: usize,
    cell: usize,
) -> Option<f64> {
    let Some(scale) = scales(depth) else {
        return value(cell);
    };
    let (i, between) = scale.locate(*point.get(depth)?);
    let first = cell * scale.points as usize + i;
    if between == 0.0 {
        return corner_sum(scales, value, point, depth + 1, first);
    }
    let right = corner_sum(scales, value, point, depth + 1, first + 1)?;
    if between == 1.0 {
        return Some(right);
    }
    let left = corner_sum(scales, value, point, depth + 1, first)?;
    Some(left + (right - left) * between)
}
