//! What of a filled map has to be kept to answer where no rule applies: its filled cells. All others the engine knows.

use fuzzy::scale::{Scale, interpolate};

use super::Reading;

/// The filled cells of a decision map.
#[derive(Debug, Clone, Copy)]
pub struct FilledCells<'a> {
    /// The points along each input.
    pub scales: &'a [Scale],
    /// The cells that are kept, in ascending order.
    pub runs: &'a [Run],
    /// Their values, run by run; NaN where nothing could be filled.
    pub values: &'a [f64],
    /// The distance of each to the nearest covered cell, in shares of the inputs' ranges.
    pub distances: &'a [f32],
}

/// Cells that follow one another.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(C)]
pub struct Run {
    /// The first cell.
    pub cell: u32,
    /// Where its value is among those kept.
    pub first: u32,
    /// Where the values of the run end.
    pub end: u32,
}

impl FilledCells<'_> {
    /// Reads the filled map at a point with a coordinate for each input, N-linearly between cells; `rules` gives what
    /// the rules say at the point of a covered cell, for which `corner` is room. `None` where a value is unknown.
    pub(crate) fn read(
        &self,
        point: &[f64],
        corner: &mut [f64],
        mut rules: impl FnMut(&[f64]) -> Option<f64>,
    ) -> Option<Reading> {
        let scales = |i: usize| self.scales.get(i).copied();
        let mut value = |cell| match self.kept(cell) {
            Some(at) => self.values.get(at).copied().filter(|v| !v.is_nan()),
            None => {
                self.locate(cell, corner);
                rules(corner)
            }
        };
        let value = interpolate(&scales, &mut value, point)?;
        let mut distance = |cell| match self.kept(cell) {
            Some(at) => self.distances.get(at).map(|d| f64::from(*d)),
            None => Some(0.0),
        };
        let distance = interpolate(&scales, &mut distance, point)?;
        Some(Reading { value, distance })
    }

    /// Whether every run stays within what is kept and there is a scale for each input.
    pub(crate) fn is_whole(&self, inputs: usize) -> bool {
        let ordered = |pair: &[Run]| match pair {
            [a, b] => a.cell.saturating_add(a.end.saturating_sub(a.first)) <= b.cell,
            _ => true,
        };
        self.scales.len() == inputs
            && self.scales.iter().all(|scale| scale.points >= 2)
            && self.values.len() == self.distances.len()
            && self.runs.windows(2).all(ordered)
            && self
                .runs
                .iter()
                .all(|run| run.first <= run.end && run.end as usize <= self.values.len())
    }

    /// Where the value of a cell is among those kept.
    fn kept(&self, cell: usize) -> Option<usize> {
        let behind = self.runs.partition_point(|run| run.cell as usize <= cell);
        let run = self.runs.get(behind.checked_sub(1)?)?;
        let at = run.first as usize + (cell - run.cell as usize);
        (at < run.end as usize).then_some(at)
    }

    /// The coordinates of a cell.
    fn locate(&self, cell: usize, corner: &mut [f64]) {
        let mut rest = cell;
        for (x, scale) in corner.iter_mut().zip(self.scales).rev() {
            let points = scale.points.max(1) as usize;
            *x = scale.coordinate(rest % points);
            rest /= points;
        }
    }
}
