//! Structures: the antecedents of a Takagi-Sugeno model.

use crate::identify::clusters::Clusters;

/// The antecedents of a model.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Structure {
    /// One rule for each combination of the terms of partitions.
    Grid(Vec<Axis>),
    /// One rule for each cluster.
    Clusters(Clusters),
}

/// A partitioned input.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Axis {
    /// The index of the input.
    pub(super) input: usize,
    /// The peaks of the terms, ascending.
    pub(super) peaks: Vec<f64>,
}

impl Axis {
    /// The two terms that a value may belong to, each with the degree of the value.
    fn degrees(&self, x: f64) -> [(usize, f64); 2] {
        let right = self.peaks.partition_point(|peak| *peak < x);
        let last = self.peaks.len() - 1;
        if right == 0 || right > last {
            return [(right.min(last), 1.0), (0, 0.0)];
        }
        let (low, high) = (self.peaks[right - 1], self.peaks[right]);
        let part = (x - low) / (high - low);
        [(right - 1, 1.0 - part), (right, part)]
    }
}

impl Structure {
    /// The inputs in use.
    pub(super) fn inputs(&self) -> Vec<usize> {
        match self {
            Structure::Grid(axes) => axes.iter().map(|axis| axis.input).collect(),
            Structure::Clusters(clusters) => clusters.inputs.clone(),
        }
    }

    /// The number of rules.
    pub(super) fn rules(&self) -> usize {
        match self {
            Structure::Grid(axes) => axes.iter().map(|axis| axis.peaks.len()).product(),
            Structure::Clusters(clusters) => clusters.centers.len(),
        }
    }

    /// Computes the firing strengths above 0 at a point.
    pub(super) fn strengths(&self, x: &dyn Fn(usize) -> f64, into: &mut Vec<(usize, f64)>) {
        into.clear();
        match self {
            Structure::Grid(axes) => {
                into.push((0, 1.0));
                for axis in axes {
                    let degrees = axis.degrees(x(axis.input));
                    let before = std::mem::take(into);
                    for (cell, strength) in before {
                        for (term, degree) in degrees {
                            if degree > 0.0 {
                                into.push((cell * axis.peaks.len() + term, strength * degree));
                            }
                        }
                    }
                }
            }
            Structure::Clusters(clusters) => {
                let all = clusters.centers.iter().enumerate();
                into.extend(all.map(|(rule, center)| (rule, clusters.strength(center, x))));
            }
        }
    }

    /// For each axis, the index of the term in a rule of a grid.
    pub(super) fn terms(axes: &[Axis], mut rule: usize) -> Vec<usize> {
        let mut terms: Vec<usize> = Vec::with_capacity(axes.len());
        for axis in axes.iter().rev() {
            terms.push(rule % axis.peaks.len());
            rule /= axis.peaks.len();
        }
        terms.reverse();
        terms
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_strengths_of_a_grid_sum_to_1_and_belong_to_its_terms() {
        let axis = |input: usize, peaks: &[f64]| Axis {
            input,
            peaks: peaks.to_vec(),
        };
        let axes = vec![axis(1, &[0.0, 1.0]), axis(0, &[0.0, 5.0, 10.0])];
        let grid = Structure::Grid(axes.clone());
        assert_eq!((grid.rules(), grid.inputs()), (6, vec![1, 0]));
        let mut strengths = Vec::new();
        for (x, y) in [(7.5, 0.25), (-3.0, 9.0), (5.0, 0.0), (12.0, 0.5)] {
            grid.strengths(&|input| [x, y][input], &mut strengths);
            let sum: f64 = strengths.iter().map(|(_, strength)| strength).sum();
            assert_eq!(sum, 1.0);
        }
        grid.strengths(&|input| [7.5, 0.25][input], &mut strengths);
        let best = strengths.iter().max_by(|a, b| a.1.total_cmp(&b.1)).unwrap();
        assert_eq!(best.1, 0.375);
        let best = Structure::terms(&axes, best.0);
        assert!(best == [0, 1] || best == [0, 2]);
    }
}
