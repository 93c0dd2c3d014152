//! Fuzzy c-means (Bezdek 1981): finds clusters of rows; each row belongs to every cluster to a degree.

use fastrand::Rng;

/// The settings of the search for clusters.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// The number of clusters, at least 2.
    pub clusters: usize,
    /// The fuzzifier, above 1: larger values give softer clusters.
    pub fuzzifier: f64,
    /// The maximum number of iterations per start of the search.
    pub iterations: u32,
    /// The number of starts of the search, each from different rows; the best result is returned.
    pub starts: u32,
    /// The random seed for choosing the rows from which the search starts.
    pub seed: u64,
}

impl Default for Settings {
    fn default() -> Self {
        Settings {
            clusters: 3,
            fuzzifier: 2.0,
            iterations: 300,
            starts: 5,
            seed: 0,
        }
    }
}

/// Clusters of rows.
#[derive(Debug, Clone, PartialEq)]
pub struct Clusters {
    /// The centers in ascending order, each as its coordinates.
    pub centers: Vec<Vec<f64>>,
    /// The degree of each row in each cluster; the degrees of a row sum to 1.
    pub degrees: Vec<Vec<f64>>,
    /// The sum of squared distances to the centers, weighted by the degrees to the power of the fuzzifier.
    pub loss: f64,
    /// The number of iterations of the best start.
    pub iterations: u32,
}

/// The reason why rows cannot be clustered.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ClusterError {
    /// Fewer than two clusters are requested.
    #[error("`clusters` is {0}; it must be at least 2")]
    Clusters(usize),
    /// The fuzzifier is not above 1.
    #[error("`fuzzifier` is {0}; it must be above 1")]
    Fuzzifier(f64),
    /// The number of iterations or starts is 0.
    #[error("`iterations` and `starts` must be at least 1")]
    Search,
    /// A value is not a finite number.
    #[error("row {0} has an unknown value")]
    Unknown(usize),
    /// There are fewer distinct rows than clusters.
    #[error("{clusters} clusters need as many distinct rows, but there are {rows}")]
    Rows {
        /// The number of clusters.
        clusters: usize,
        /// The number of distinct rows.
        rows: usize,
    },
}

/// The search ends when no degree changes by more than this.
const CONVERGENCE: f64 = 1e-9;

/// Finds clusters of rows. Distances are computed from the unscaled values, so scale the columns
/// first if their units differ.
///
/// # Errors
/// If the settings or the rows cannot be used.
///
/// ```
/// use flagred_tuning::c_means::{Settings, c_means};
///
/// let rows = [1.0, 2.0, 3.0, 11.0, 12.0, 13.0].map(|value| vec![value]);
/// let settings = Settings { clusters: 2, ..Settings::default() };
/// let found = c_means(&rows, &settings)?;
/// assert!((found.centers[0][0] - 2.0).abs() < 0.1 && (found.centers[1][0] - 12.0).abs() < 0.1);
/// assert!(found.degrees[0][0] > 0.98);
/// # Ok::<(), flagred_tuning::c_means::ClusterError>(())
/// ```
pub fn c_means(rows: &[Vec<f64>], settings: &Settings) -> Result<Clusters, ClusterError> {
    if settings.clusters < 2 {
        return Err(ClusterError::Clusters(settings.clusters));
    }
    if settings.fuzzifier.is_nan() || settings.fuzzifier <= 1.0 || settings.fuzzifier.is_infinite()
    {
        return Err(ClusterError::Fuzzifier(settings.fuzzifier));
    }
    if settings.iterations == 0 || settings.starts == 0 {
        return Err(ClusterError::Search);
    }
    let is_unknown = |row: &Vec<f64>| row.iter().any(|value| !value.is_finite());
    if let Some(row) = rows.iter().position(is_unknown) {
        return Err(ClusterError::Unknown(row));
    }
    let mut different: Vec<&Vec<f64>> = rows.iter().collect();
    different.sort_by(|a, b| order(a, b));
    different.dedup();
    if different.len() < settings.clusters {
        return Err(ClusterError::Rows {
            clusters: settings.clusters,
            rows: different.len(),
        });
    }
    let mut random = Rng::with_seed(settings.seed);
    let mut best: Option<Clusters> = None;
    for _ in 0..settings.starts {
        let found = search(rows, begin(&different, settings, &mut random), settings);
        if best.as_ref().is_none_or(|best| found.loss < best.loss) {
            best = Some(found);
        }
    }
    best.map(ascending).ok_or(ClusterError::Search)
}

/// Chooses initial centers that are far from each other: each further row is drawn with a probability proportional to
/// its squared distance from the nearest center so far (k-means++).
fn begin(different: &[&Vec<f64>], settings: &Settings, random: &mut Rng) -> Vec<Vec<f64>> {
    let mut centers = vec![different[random.usize(..different.len())].clone()];
    while centers.len() < settings.clusters {
        let nearest = |row: &&Vec<f64>| {
            let squares = centers.iter().map(|center| square(row, center));
            squares.fold(f64::INFINITY, f64::min)
        };
        let squares: Vec<f64> = different.iter().map(nearest).collect();
        let mut rest = random.f64() * squares.iter().sum::<f64>();
        let chosen = squares.iter().position(|square| {
            rest -= square;
            *square > 0.0 && rest <= 0.0
        });
        let last = || squares.iter().rposition(|square| *square > 0.0);
        let chosen = chosen.or_else(last).unwrap_or(0);
        centers.push(different[chosen].clone());
    }
    centers
}

fn search(rows: &[Vec<f64>], mut centers: Vec<Vec<f64>>, settings: &Settings) -> Clusters {
    let mut degrees = all_degrees(rows, &centers, settings.fuzzifier);
    let mut iterations = 0;
    while iterations < settings.iterations {
        iterations += 1;
        move_centers(&mut centers, rows, &degrees, settings.fuzzifier);
        let next = all_degrees(rows, &centers, settings.fuzzifier);
        let pairs = degrees.iter().flatten().zip(next.iter().flatten());
        let change = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        degrees = next;
        if change <= CONVERGENCE {
            break;
        }
    }
    let of_row = |(row, degrees): (&Vec<f64>, &Vec<f64>)| -> f64 {
        let parts = centers.iter().zip(degrees);
        parts
            .map(|(center, degree)| degree.powf(settings.fuzzifier) * square(row, center))
            .sum()
    };
    let loss = rows.iter().zip(&degrees).map(of_row).sum();
    Clusters {
        loss,
        iterations,
        centers,
        degrees,
    }
}

fn all_degrees(rows: &[Vec<f64>], centers: &[Vec<f64>], fuzzifier: f64) -> Vec<Vec<f64>> {
    rows.iter()
        .map(|row| degrees(row, centers, fuzzifier))
        .collect()
}

/// The degree of a row in each cluster: `1 / sum_j (d_i / d_j)^(2 / (fuzzifier - 1))`, where `d_i` is the distance of
/// the row from center `i`.
fn degrees(row: &[f64], centers: &[Vec<f64>], fuzzifier: f64) -> Vec<f64> {
    let squares: Vec<f64> = centers.iter().map(|center| square(row, center)).collect();
    let at_center = squares.iter().filter(|square| **square == 0.0).count();
    if at_center > 0 {
        let degree = |square: &f64| f64::from(u8::from(*square == 0.0)) / at_center as f64;
        return squares.iter().map(degree).collect();
    }
    let power = 1.0 / (fuzzifier - 1.0);
    let degree = |own: &f64| {
        let ratios = squares.iter().map(|other| (own / other).powf(power));
        1.0 / ratios.sum::<f64>()
    };
    squares.iter().map(degree).collect()
}

/// Moves each center to the mean of the rows, weighted by their degrees to the power of the fuzzifier.
fn move_centers(centers: &mut [Vec<f64>], rows: &[Vec<f64>], degrees: &[Vec<f64>], fuzzifier: f64) {
    for (cluster, center) in centers.iter_mut().enumerate() {
        let weights: Vec<f64> = degrees.iter().map(|d| d[cluster].powf(fuzzifier)).collect();
        let sum: f64 = weights.iter().sum();
        if sum > 0.0 {
            for (column, value) in center.iter_mut().enumerate() {
                let parts = rows.iter().zip(&weights);
                *value = parts.map(|(row, weight)| row[column] * weight).sum::<f64>() / sum;
            }
        }
    }
}

fn ascending(found: Clusters) -> Clusters {
    let mut places: Vec<usize> = (0..found.centers.len()).collect();
    places.sort_by(|a, b| order(&found.centers[*a], &found.centers[*b]));
    let sorted = |row: &Vec<f64>| places.iter().map(|place| row[*place]).collect();
    Clusters {
        degrees: found.degrees.iter().map(sorted).collect(),
        centers: places
            .iter()
            .map(|place| found.centers[*place].clone())
            .collect(),
        ..found
    }
}

fn order(a: &[f64], b: &[f64]) -> std::cmp::Ordering {
    let columns = a.iter().zip(b);
    columns.fold(std::cmp::Ordering::Equal, |order, (a, b)| {
        order.then(a.total_cmp(b))
    })
}

fn square(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn column(values: &[f64]) -> Vec<Vec<f64>> {
        values.iter().map(|value| vec![*value]).collect()
    }

    /// With the rows -1, 0 and 1 and with two clusters, the centers are at -c and c by symmetry. If the fuzzifier is
    /// 2, the row 0 has the degrees 1/2, and the row 1 has u = (1 + c)^2 / (2 + 2 c^2) in the cluster of c. The center
    /// is the mean weighted by squares: c = (u^2 - (1 - u)^2) / (u^2 + 1/4 + (1 - u)^2). With u - (1 - u) = 2c / (1 +
    /// c^2) = s this is c = s / ((1 + s^2) / 2 + 1/4).
    #[test]
    fn three_rows_have_memberships_computed_by_hand() {
        let settings = Settings {
            clusters: 2,
            ..Settings::default()
        };
        let found = c_means(&column(&[-1.0, 0.0, 1.0]), &settings).unwrap();
        let (low, high) = (found.centers[0][0], found.centers[1][0]);
        assert!((low + high).abs() < 1e-6, "{low} and {high}");
        let s = 2.0 * high / (1.0 + high * high);
        let expected = s / (f64::midpoint(1.0, s * s) + 0.25);
        assert!((high - expected).abs() < 1e-6, "{high} for {expected}");
        assert!((high - 0.795_608_674).abs() < 1e-6, "{high}");
        let u = (1.0 + high).powi(2) / (2.0 + 2.0 * high * high);
        assert!((found.degrees[2][1] - u).abs() < 1e-6);
        assert!((found.degrees[1][0] - 0.5).abs() < 1e-6);
    }

    #[test]
    fn each_group_has_a_center_and_degrees_sum_to_one() {
        let mut random = Rng::with_seed(3);
        let heaps = [(0.0, 0.0), (10.0, 1.0), (5.0, 9.0)];
        let rows: Vec<Vec<f64>> = (0..300)
            .map(|i| {
                let (x, y) = heaps[i % 3];
                vec![x + random.f64() - 0.5, y + random.f64() - 0.5]
            })
            .collect();
        let found = c_means(&rows, &Settings::default()).unwrap();
        for (center, (x, y)) in found
            .centers
            .iter()
            .zip([(0.0, 0.0), (5.0, 9.0), (10.0, 1.0)])
        {
            assert!(square(center, &[x, y]).sqrt() < 0.1, "{center:?}");
        }
        let sums = found
            .degrees
            .iter()
            .map(|degrees| degrees.iter().sum::<f64>());
        assert!(sums.map(|sum| (sum - 1.0).abs()).fold(0.0, f64::max) < 1e-12);
        assert_eq!(found, c_means(&rows, &Settings::default()).unwrap());
    }

    #[test]
    fn data_that_cannot_be_clustered_is_refused() {
        let of = |values: &[f64], clusters| {
            let settings = Settings {
                clusters,
                ..Settings::default()
            };
            c_means(&column(values), &settings).unwrap_err().to_string()
        };
        assert_eq!(of(&[1.0, 2.0], 1), "`clusters` is 1; it must be at least 2");
        assert_eq!(of(&[1.0, f64::NAN], 2), "row 1 has an unknown value");
        assert_eq!(
            of(&[1.0, 1.0, 2.0], 3),
            "3 clusters need as many distinct rows, but there are 2"
        );
    }
}
