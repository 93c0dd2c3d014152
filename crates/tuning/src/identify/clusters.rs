//! Subtractive clustering (Chiu 1994): finds points that are surrounded by many rows, in the space of some inputs and
//! the output.

use fastrand::Rng;

use crate::data::{Data, range};

/// The maximum number of rows for which a potential is computed; if there are more, a random sample is used.
const MAX_ROWS: usize = 600;

/// The distance around a center within which the potential of other points is reduced, in radii.
const SQUASH: f64 = 1.25;

/// A point is a center if its potential is above this share of the first center's potential. A point with less potential
/// is a center only if it is far from the other centers.
const ACCEPT: f64 = 0.5;
/// The search ends when the highest potential is below this share of the first center's potential.
const REJECT: f64 = 0.15;

/// Centers of clusters.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Clusters {
    pub(super) inputs: Vec<usize>,
    /// For each input, the standard deviation of the gaussians around the centers.
    pub(super) deviations: Vec<f64>,
    /// For each cluster, the value of each input at its center.
    pub(super) centers: Vec<Vec<f64>>,
}

impl Clusters {
    /// Finds at most `most` clusters of rows. The radius is a share of the range of each column.
    pub(super) fn find(data: &Data, inputs: &[usize], radius: f64, most: usize) -> Clusters {
        let columns: Vec<&[f64]> = inputs
            .iter()
            .map(|input| data.inputs[*input].as_slice())
            .chain([data.truths.as_slice()])
            .collect();
        let ranges: Vec<(f64, f64)> = columns.iter().map(|column| range(column)).collect();
        let mut rows: Vec<usize> = (0..data.len()).collect();
        if rows.len() > MAX_ROWS {
            Rng::with_seed(0).shuffle(&mut rows);
            rows.truncate(MAX_ROWS);
        }
        let scaled = |row: &usize| -> Vec<f64> {
            let all = columns.iter().zip(&ranges);
            all.map(|(column, (low, high))| {
                (column[*row] - low) / (high - low).max(f64::MIN_POSITIVE)
            })
            .collect()
        };
        let points: Vec<Vec<f64>> = rows.iter().map(scaled).collect();
        let chosen = centers(&points, radius, most);
        let center = |place: &usize| -> Vec<f64> {
            let row = rows[*place];
            inputs
                .iter()
                .map(|input| data.inputs[*input][row])
                .collect()
        };
        Clusters {
            inputs: inputs.to_vec(),
            deviations: ranges[..inputs.len()]
                .iter()
                .map(|(low, high)| radius * (high - low) / 8_f64.sqrt())
                .collect(),
            centers: chosen.iter().map(center).collect(),
        }
    }

    /// The firing strength of a cluster: the product of the gaussians of all inputs.
    pub(super) fn strength(&self, center: &[f64], x: &dyn Fn(usize) -> f64) -> f64 {
        let parts = self.inputs.iter().zip(&self.deviations).zip(center);
        let squares =
            parts.map(|((input, deviation), mean)| ((x(*input) - mean) / deviation).powi(2));
        (-0.5 * squares.sum::<f64>()).exp()
    }
}

/// The indices of the points that are centers, highest potential first.
fn centers(points: &[Vec<f64>], radius: f64, most: usize) -> Vec<usize> {
    let square =
        |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum() };
    let around =
        |a: &[f64], b: &[f64], radius: f64| (-4.0 * square(a, b) / (radius * radius)).exp();
    let mut potentials: Vec<f64> = points
        .iter()
        .map(|a| points.iter().map(|b| around(a, b, radius)).sum())
        .collect();
    let mut chosen: Vec<usize> = Vec::new();
    let mut first = 0.0;
    while chosen.len() < most {
        let best = (0..points.len()).max_by(|a, b| potentials[*a].total_cmp(&potentials[*b]));
        let Some(best) = best else { break };
        let potential = potentials[best];
        if chosen.is_empty() {
            first = potential;
        }
        let nearest = chosen
            .iter()
            .map(|center| square(&points[best], &points[*center]));
        let nearest = nearest.fold(f64::INFINITY, f64::min).sqrt();
        if potential <= REJECT * first {
            break;
        }
        if potential <= ACCEPT * first && nearest / radius + potential / first < 1.0 {
            potentials[best] = 0.0;
            continue;
        }
        for (other, point) in potentials.iter_mut().zip(points) {
            *other -= potential * around(&points[best], point, SQUASH * radius);
        }
        chosen.push(best);
    }
    chosen
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_group_of_rows_is_a_cluster() {
        let mut random = Rng::with_seed(7);
        let heaps = [(1.0, 10.0), (5.0, 60.0), (9.0, 20.0)];
        let mut data = Data {
            inputs: vec![Vec::new(); 2],
            ..Data::default()
        };
        for i in 0..300 {
            let (x, y) = heaps[i % 3];
            data.inputs[0].push(x + random.f64() - 0.5);
            data.inputs[1].push(random.f64());
            data.truths.push(y + 4.0 * random.f64() - 2.0);
        }
        let found = Clusters::find(&data, &[0], 0.5, 10);
        let mut centers: Vec<f64> = found.centers.iter().map(|center| center[0]).collect();
        centers.sort_by(f64::total_cmp);
        assert_eq!(centers.len(), 3);
        for (center, (x, _)) in centers.iter().zip(heaps) {
            assert!((center - x).abs() < 0.4, "{centers:?}");
        }
        assert!(found.strength(&found.centers[0], &|_| found.centers[0][0]) == 1.0);
    }

    #[test]
    fn the_number_of_clusters_is_bounded() {
        let data = Data {
            inputs: vec![(0..50).map(f64::from).collect()],
            truths: (0..50).map(|x| f64::from(x % 7)).collect(),
            ..Data::default()
        };
        assert_eq!(Clusters::find(&data, &[0], 0.1, 4).centers.len(), 4);
    }
}
