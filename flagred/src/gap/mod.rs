//! Filling the gaps of a decision map by spatial interpolation.
//!
//! Learned rules cover what was flown. Where the antecedent that dominates has no rule, the coverage (the
//! largest firing strength) of a cell is low and its value an accident of far-off rules; such cells are filled
//! from the covered rest of the map. Distances are in shares of each input's range, so that no input counts more
//! because of its unit.

use fuzzy::{
    Model,
    model::{Conjunction, Variable},
};

mod harmonic;
mod inverse_distance;
mod map;
mod nearest;
mod neighbours;
mod thin_plate;

pub use map::{FilledMap, Reading};

/// How a gap is filled.
///
/// # Example
/// ```
/// use flagred::gap::GapMethod;
///
/// assert_eq!(GapMethod::default(), GapMethod::ThinPlate);
/// assert!(GapMethod::ALL.contains(&GapMethod::INVERSE_DISTANCE));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum GapMethod {
    /// The value of the nearest covered cell.
    Nearest,
    /// `sum(v / d^power) / sum(1 / d^power)` over the nearest covered cells at the edge of the gap.
    ///
    /// Over *all* cells, as the method is often given, a corner reads an average of the whole map: 49 % for a
    /// saturated drone. Hence the number of neighbours.
    InverseDistance {
        /// The power of the distance, over 0.
        power: f64,
        /// How many cells count, at least 1.
        neighbours: usize,
    },
    /// The thin-plate spline through the covered cells nearest to each place: it continues slopes, and can overshoot;
    /// kept within the range of the output.
    #[default]
    ThinPlate,
    /// The solution of Laplace's equation: every filled value is the mean of its neighbours, so it is smooth and
    /// cannot overshoot.
    Harmonic,
}

impl GapMethod {
    /// Every method, those with settings as they are when nothing else is said.
    pub const ALL: [GapMethod; 4] = [
        GapMethod::Nearest,
        GapMethod::INVERSE_DISTANCE,
        GapMethod::ThinPlate,
        GapMethod::Harmonic,
    ];

    /// Inverse distance as it is when nothing else is said: power 2, 4 neighbours.
    pub const INVERSE_DISTANCE: GapMethod = GapMethod::InverseDistance {
        power: 2.0,
        neighbours: 4,
    };
}

/// What a cell must not be to count as covered, and how the others get their values.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct GapSettings {
    /// How the gap is filled.
    pub method: GapMethod,
    /// A cell is a gap below this coverage; `None` is the least with which the dominating antecedent can fire, see
    /// [`GapSettings::coverage_below`].
    pub coverage_below: Option<f64>,
}

impl GapSettings {
    /// The coverage below which a cell of the map of a model is a gap.
    ///
    /// Where none is set: if the terms of every input sum to 1 everywhere, the dominating antecedent has memberships of
    /// 0.5 at least, where two neighbours meet. With the minimum as AND it then fires at 0.5 or more, with the product
    /// of n inputs at `0.5^n`: less means that the dominating antecedent has no rule. With other terms and other
    /// conjunctions only what no rule covers at all is a gap.
    ///
    /// # Example
    /// ```
    /// use flagred::gap::GapSettings;
    ///
    /// let paper = flagred::shipped::rule_set("flagred-paper").ok_or("not shipped")??;
    /// assert_eq!(GapSettings::default().coverage_below(&paper), 0.5);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn coverage_below(&self, model: &Model) -> f64 {
        let least = || match model.operators.and {
            Conjunction::Minimum => 0.5,
            Conjunction::Product => libm::pow(0.5, model.inputs.len() as f64),
            _ => f64::MIN_POSITIVE,
        };
        self.coverage_below
            .unwrap_or_else(|| match model.inputs.iter().all(sums_to_one) {
                true => least(),
                false => f64::MIN_POSITIVE,
            })
    }
}

/// Whether the memberships of a variable's terms sum to 1 all over its range.
fn sums_to_one(variable: &Variable) -> bool {
    const STEPS: u32 = 500;
    (0..=STEPS).all(|i| {
        let share = f64::from(i) / f64::from(STEPS);
        let x = variable.low + (variable.high - variable.low) * share;
        let memberships = variable.terms.iter();
        let sum: f64 = memberships.map(|t| t.height * t.shape.membership(x)).sum();
        (sum - 1.0).abs() < 1e-6
    })
}

/// Whether a coverage is below the one from which on a cell counts as covered. Half way between two peaks, where both
/// terms should be at 0.5, rounding leaves one of them a hair below it.
///
/// # Example
/// ```
/// use flagred::gap::is_gap;
///
/// assert!(is_gap(0.3, 0.5) && !is_gap(0.5, 0.5));
/// assert!(!is_gap(0.5 - 1e-16, 0.5), "rounding is no gap");
/// ```
pub fn is_gap(coverage: f64, coverage_below: f64) -> bool {
    coverage < coverage_below - 1e-9 * coverage_below
}

/// A regular grid over the unit cube: each input from one end of its range to the other, both included.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Lattice {
    /// The number of nodes along each input, the last input running fastest.
    pub(crate) shape: Vec<usize>,
    /// By how much the index grows per step along each input.
    pub(crate) strides: Vec<usize>,
}

impl Lattice {
    pub(crate) fn new(shape: &[usize]) -> Lattice {
        let mut strides = vec![1; shape.len()];
        for axis in (1..shape.len()).rev() {
            strides[axis - 1] = strides[axis] * shape[axis];
        }
        Lattice {
            shape: shape.to_vec(),
            strides,
        }
    }

    /// The step along an axis as a share of the range.
    pub(crate) fn step(&self, axis: usize) -> f64 {
        1.0 / (self.shape[axis].max(2) - 1) as f64
    }

    /// The place of a node along an axis.
    pub(crate) fn place(&self, node: usize, axis: usize) -> usize {
        node / self.strides[axis] % self.shape[axis]
    }

    /// The coordinates of a node in the unit cube.
    pub(crate) fn point(&self, node: usize) -> Vec<f64> {
        (0..self.shape.len())
            .map(|axis| self.place(node, axis) as f64 * self.step(axis))
            .collect()
    }

    /// Reads values at the nodes linearly along each axis from `axis` on.
    fn read(&self, values: &[f64], point: &[f64], axis: usize, node: usize) -> f64 {
        let Some(x) = point.get(axis) else {
            return values[node];
        };
        let last = self.shape[axis] - 1;
        let place = x * last as f64;
        let below = (place as usize).min(last.saturating_sub(1));
        let share = place - below as f64;
        let at = |place| self.read(values, point, axis + 1, node + place * self.strides[axis]);
        if share == 0.0 {
            return at(below);
        }
        (1.0 - share) * at(below) + share * at(below + 1)
    }

    /// The nodes next to a node, along every axis.
    pub(crate) fn neighbours(&self, node: usize) -> impl Iterator<Item = usize> + '_ {
        (0..self.shape.len()).flat_map(move |axis| {
            let place = self.place(node, axis);
            let before = (place > 0).then(|| node - self.strides[axis]);
            let behind = (place + 1 < self.shape[axis]).then(|| node + self.strides[axis]);
            before.into_iter().chain(behind)
        })
    }
}

/// Fills every value whose node is not covered; gives each node's distance to the nearest covered node (0 for a
/// covered one), in shares of the ranges. Values stay within the `range` of the output.
///
/// Where nothing is covered nothing can be filled: the distances are infinite and the values stay.
pub(crate) fn fill(
    lattice: &Lattice,
    covered: &[bool],
    values: &mut [f64],
    range: (f64, f64),
    method: GapMethod,
) -> Vec<f32> {
    let nearest = nearest::nearest(lattice, covered);
    let deepest = nearest.iter().map(|n| n.distance()).fold(0.0, f64::max);
    let distances = nearest.iter().map(|n| n.distance() as f32).collect();
    if deepest == 0.0 || deepest.is_infinite() {
        return distances;
    }
    for (node, nearest) in nearest.iter().enumerate() {
        if let Some(from) = nearest.node() {
            values[node] = values[from];
        }
    }
    // From here on the values in the gap are those of the nearest covered cells.
    drop(nearest);
    match method {
        GapMethod::Nearest => {}
        GapMethod::InverseDistance { power, neighbours } => {
            on_knots(lattice, covered, values, |lattice, covered, values| {
                inverse_distance::fill(lattice, covered, values, power, neighbours);
            });
        }
        GapMethod::ThinPlate => {
            on_knots(lattice, covered, values, |lattice, covered, values| {
                thin_plate::fill(lattice, covered, values, range);
            });
        }
        GapMethod::Harmonic => harmonic::fill(lattice, covered, values, deepest),
    }
    distances
}

/// The methods that look for neighbours do so on at most this many nodes along each axis and in all: what counts as
/// near then does not depend on how finely a map is drawn, and the cost has a bound in any number of dimensions.
const MOST_KNOTS_ALONG: usize = 51;
const MOST_KNOTS: f64 = 40_000.0;

/// Fills a coarser grid, its knots the nodes nearest to even places, and reads the gap linearly between its knots.
fn on_knots(
    lattice: &Lattice,
    covered: &[bool],
    values: &mut [f64],
    fill: impl Fn(&Lattice, &[bool], &mut [f64]),
) {
    let even = libm::pow(MOST_KNOTS, 1.0 / lattice.shape.len() as f64) as usize;
    let along = even.clamp(3, MOST_KNOTS_ALONG);
    if lattice.shape.iter().all(|n| *n <= along) {
        fill(lattice, covered, values);
        return;
    }
    let knots = Lattice::new(
        &lattice
            .shape
            .iter()
            .map(|n| along.min(*n))
            .collect::<Vec<_>>(),
    );
    let count = knots.shape.iter().product();
    let nodes: Vec<usize> = (0..count)
        .map(|knot| {
            let point = knots.point(knot);
            let places = point.iter().enumerate().map(|(axis, x)| {
                let last = (lattice.shape[axis] - 1) as f64;
                libm::round(x * last) as usize * lattice.strides[axis]
            });
            places.sum()
        })
        .collect();
    let known: Vec<bool> = nodes.iter().map(|node| covered[*node]).collect();
    let mut filled: Vec<f64> = nodes.iter().map(|node| values[*node]).collect();
    if known.iter().any(|known| *known) {
        fill(&knots, &known, &mut filled);
    }
    for node in (0..covered.len()).filter(|node| !covered[*node]) {
        values[node] = knots.read(&filled, &lattice.point(node), 0, 0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const RANGE: (f64, f64) = (0.0, 100.0);

    #[test]
    fn what_counts_as_covered_follows_from_the_terms_and_the_conjunction() {
        let below = |partition: &str, and: &str| {
            let text = format!(
                "
fuzzy: 1
name: test
inputs: {{a: {{range: [0, 1], {partition}}}, b: {{range: [0, 1], partition: [low, high]}}}}
outputs: {{y: {{range: [0, 1], partition: [low, high]}}}}
operators: {{and: {and}}}
rules: [IF a IS low THEN y IS low]
"
            );
            let model = fuzzy::yaml::parse(&text).unwrap().model;
            GapSettings::default().coverage_below(&model)
        };
        assert_eq!(below("partition: [low, high]", "minimum"), 0.5);
        assert_eq!(below("partition: [low, high]", "product"), 0.25);
        let bells = "terms: {low: {gaussian: {mean: 0, sd: 0.2}}}";
        assert_eq!(below(bells, "minimum"), f64::MIN_POSITIVE);
        assert_eq!(
            below("partition: [low, high]", "einstein"),
            f64::MIN_POSITIVE
        );
    }

    #[test]
    fn neighbours_stop_at_the_edge() {
        let lattice = Lattice::new(&[3, 4]);
        assert_eq!(lattice.neighbours(0).collect::<Vec<_>>(), [4, 1]);
        assert_eq!(lattice.neighbours(5).collect::<Vec<_>>(), [1, 9, 4, 6]);
        assert_eq!(lattice.point(5), [0.5, 1.0 / 3.0]);
    }

    #[test]
    fn where_nothing_is_covered_nothing_is_filled() {
        for method in GapMethod::ALL {
            let mut values = [1.0, 2.0, 3.0];
            let distances = fill(&Lattice::new(&[3]), &[false; 3], &mut values, RANGE, method);
            assert_eq!(values, [1.0, 2.0, 3.0]);
            assert!(distances.iter().all(|d| d.is_infinite()));
        }
    }

    #[test]
    fn a_gap_between_two_cells_takes_from_both() {
        let filled = |method| {
            let mut values = [0.0, -1.0, -1.0, -1.0, 100.0];
            let covered = [true, false, false, false, true];
            let distances = fill(&Lattice::new(&[5]), &covered, &mut values, RANGE, method);
            assert_eq!(distances, [0.0, 0.25, 0.5, 0.25, 0.0]);
            values
        };
        assert_eq!(filled(GapMethod::Nearest)[1], 0.0);
        assert_eq!(filled(GapMethod::Nearest)[3], 100.0);
        // 100 (1/0.75^2) / (1/0.25^2 + 1/0.75^2) = 10
        approx::assert_abs_diff_eq!(filled(GapMethod::INVERSE_DISTANCE)[1], 10.0, epsilon = 1e-9);
        approx::assert_abs_diff_eq!(filled(GapMethod::INVERSE_DISTANCE)[2], 50.0, epsilon = 1e-9);
        for (i, expected) in [0.0, 25.0, 50.0, 75.0, 100.0].into_iter().enumerate() {
            approx::assert_abs_diff_eq!(filled(GapMethod::Harmonic)[i], expected, epsilon = 1e-4);
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(32))]

        #[test]
        fn covered_cells_stay_and_averages_cannot_overshoot(
            cells in prop::collection::vec((any::<bool>(), 0.0..100.0f64), 3 * 4 * 5),
        ) {
            let lattice = Lattice::new(&[3, 4, 5]);
            let covered: Vec<bool> = cells.iter().map(|c| c.0).collect();
            let original: Vec<f64> = cells.iter().map(|c| c.1).collect();
            prop_assume!(covered.iter().any(|c| *c));
            let known = || (0..60).filter(|i| covered[*i]).map(|i| original[i]);
            let (low, high) = (known().fold(f64::MAX, f64::min), known().fold(f64::MIN, f64::max));
            for method in GapMethod::ALL {
                let mut values = original.clone();
                let distances = fill(&lattice, &covered, &mut values, RANGE, method);
                for i in 0..60 {
                    prop_assert_eq!(distances[i] == 0.0, covered[i]);
                    if covered[i] {
                        prop_assert_eq!(values[i], original[i]);
                    } else if method == GapMethod::ThinPlate {
                        prop_assert!((0.0..=100.0).contains(&values[i]));
                    } else {
                        prop_assert!(values[i] >= low - 1e-9 && values[i] <= high + 1e-9);
                    }
                }
            }
        }
    }
}
