//! A decision map whose gaps are filled, read anywhere between its nodes.

use fuzzy::{
    Engine, Model,
    engine::{EvaluateError, Outcome},
};

use super::{GapMethod, GapSettings, Lattice, fill};

/// A decision map without gaps: the value at each node of a grid, and how far from the covered part it is.
#[derive(Debug, Clone)]
pub struct FilledMap {
    lattice: Lattice,
    /// The range of each input.
    ranges: Vec<(f64, f64)>,
    values: Vec<f64>,
    distances: Vec<f32>,
}

/// A value read from a [`FilledMap`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reading {
    /// The value.
    pub value: f64,
    /// How far from the nearest covered node it was taken, in shares of the inputs' ranges; 0 within the covered
    /// part.
    pub distance: f64,
}

impl FilledMap {
    /// Fills a map over the `ranges` of the inputs, with `shape` nodes along each (ends included, the last input
    /// running fastest).
    ///
    /// `None` unless there is a node for each product of the shape, in `values` and in `covered`, and at least
    /// two nodes along each input.
    ///
    /// # Example: a gap in the middle of a line
    ///
    /// ```
    /// use flagred::gap::{FilledMap, GapMethod};
    ///
    /// let values = vec![10.0, f64::NAN, 30.0];
    /// let method = GapMethod::InverseDistance { power: 2.0, neighbours: 2 };
    /// let map = FilledMap::new(&[(0.0, 0.5)], &[3], values, &[true, false, true], method)
    ///     .ok_or("shapes differ")?;
    /// let middle = map.read(&[0.25]).ok_or("nothing is covered")?;
    /// assert_eq!((middle.value, middle.distance), (20.0, 0.5));
    /// # Ok::<(), &str>(())
    /// ```
    pub fn new(
        ranges: &[(f64, f64)],
        shape: &[usize],
        mut values: Vec<f64>,
        covered: &[bool],
        method: GapMethod,
    ) -> Option<FilledMap> {
        let nodes = shape.iter().try_fold(1usize, |n, s| n.checked_mul(*s))?;
        let fits = shape.len() == ranges.len()
            && shape.iter().all(|s| *s >= 2)
            && values.len() == nodes
            && covered.len() == nodes
            && u32::try_from(nodes).is_ok();
        if !fits {
            return None;
        }
        let lattice = Lattice::new(shape);
        let distances = fill(&lattice, covered, &mut values, method);
        Some(FilledMap {
            lattice,
            ranges: ranges.to_vec(),
            values,
            distances,
        })
    }

    /// Evaluates an output of a model at the nodes of a grid and fills its gaps; `None` where there are none to fill.
    ///
    /// # Errors
    ///
    /// Where the engine is not that of the model.
    pub(crate) fn of(
        engine: &Engine,
        model: &Model,
        output: usize,
        shape: &[usize],
        settings: &GapSettings,
    ) -> Result<Option<FilledMap>, EvaluateError> {
        let ranges: Vec<(f64, f64)> = model.inputs.iter().map(|i| (i.low, i.high)).collect();
        let lattice = Lattice::new(shape);
        let nodes = shape.iter().product();
        let coverage_below = settings.coverage_below(model);
        let mut scratch = engine.scratch();
        let mut outcomes = vec![Outcome::default(); engine.output_names().len()];
        let mut inputs = vec![0.0; shape.len()];
        let mut values = Vec::with_capacity(nodes);
        let mut covered = Vec::with_capacity(nodes);
        for node in 0..nodes {
            for (axis, (input, (low, high))) in inputs.iter_mut().zip(&ranges).enumerate() {
                let last = shape[axis] - 1;
                *input = low + (high - low) * lattice.place(node, axis) as f64 / last as f64;
            }
            match engine.evaluate_with(&mut scratch, &inputs, &mut outcomes) {
                Ok(()) | Err(EvaluateError::NoRuleFired { .. }) => {}
                Err(other) => return Err(other),
            }
            let outcome = outcomes.get(output).copied().unwrap_or_default();
            covered.push(outcome.coverage >= coverage_below && outcome.value().is_some());
            values.push(outcome.value().unwrap_or(f64::NAN));
        }
        if covered.iter().all(|covered| *covered) {
            return Ok(None);
        }
        Ok(FilledMap::new(
            &ranges,
            shape,
            values,
            &covered,
            settings.method,
        ))
    }

    /// The values at the nodes, the last input running fastest.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// The distance of each node to the nearest covered one, in shares of the inputs' ranges.
    pub fn distances(&self) -> &[f32] {
        &self.distances
    }

    /// The value at a point, N-linearly between the nodes around it; inputs beyond their range count as its end.
    ///
    /// `None` where there is no such number of inputs, one of them is NaN, or nothing is covered.
    pub fn read(&self, point: &[f64]) -> Option<Reading> {
        if point.len() != self.ranges.len() || point.iter().any(|x| x.is_nan()) {
            return None;
        }
        let mut reading = Reading {
            value: 0.0,
            distance: 0.0,
        };
        self.corners(point, 0, 0, 1.0, &mut reading);
        (reading.value.is_finite() && reading.distance.is_finite()).then_some(reading)
    }

    /// Adds the corners of the cell around `point`, from `axis` on.
    fn corners(&self, point: &[f64], axis: usize, node: usize, weight: f64, sum: &mut Reading) {
        let (Some(x), Some((low, high))) = (point.get(axis), self.ranges.get(axis)) else {
            sum.value += weight * self.values[node];
            sum.distance += weight * f64::from(self.distances[node]);
            return;
        };
        let last = self.lattice.shape[axis] - 1;
        let place = ((x - low) / (high - low)).clamp(0.0, 1.0) * last as f64;
        let below = (place as usize).min(last - 1);
        let share = place - below as f64;
        let stride = self.lattice.strides[axis];
        for (place, part) in [(below, 1.0 - share), (below + 1, share)] {
            // A corner without weight may be undefined: it must not spoil the sum.
            if part > 0.0 {
                self.corners(point, axis + 1, node + place * stride, weight * part, sum);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn plane() -> FilledMap {
        // 1 + 2 x + 4 y on 3 x 5 nodes over [0, 2] x [0, 4].
        let values = (0..15)
            .map(|i| 1.0 + 2.0 * f64::from(i / 5) + 4.0 * f64::from(i % 5))
            .collect();
        FilledMap::new(
            &[(0.0, 2.0), (0.0, 4.0)],
            &[3, 5],
            values,
            &[true; 15],
            GapMethod::Nearest,
        )
        .unwrap()
    }

    proptest! {
        #[test]
        fn reading_between_nodes_is_linear(x in -0.5..2.5f64, y in -0.5..4.5f64) {
            let expected = 1.0 + 2.0 * x.clamp(0.0, 2.0) + 4.0 * y.clamp(0.0, 4.0);
            let reading = plane().read(&[x, y]).unwrap();
            prop_assert!((reading.value - expected).abs() < 1e-12);
            prop_assert_eq!(reading.distance, 0.0);
        }
    }

    #[test]
    fn what_does_not_fit_is_refused() {
        let new = |shape: &[usize], nodes: usize| {
            FilledMap::new(
                &[(0.0, 1.0)],
                shape,
                vec![0.0; nodes],
                &vec![true; nodes],
                GapMethod::Nearest,
            )
        };
        assert!(new(&[3], 3).is_some());
        assert!(new(&[3], 4).is_none());
        assert!(new(&[1], 1).is_none());
        assert!(new(&[3, 3], 9).is_none());
        assert!(plane().read(&[0.0]).is_none());
        assert!(plane().read(&[0.0, f64::NAN]).is_none());
    }

    #[test]
    fn a_map_of_nothing_reads_as_unknown() {
        let map = FilledMap::new(
            &[(0.0, 1.0)],
            &[3],
            vec![f64::NAN; 3],
            &[false; 3],
            GapMethod::Nearest,
        )
        .unwrap();
        assert_eq!(map.read(&[0.3]), None);
    }
}
