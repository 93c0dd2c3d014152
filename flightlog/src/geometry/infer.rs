//! The motor layout by the commands of a flight.
//!
//! A mixer adds thrust, roll, pitch and yaw, so the commands of `n` motors lie in a space of
//! four dimensions (thrust curves and limits bend it a little). A layout fits when little of
//! the variance of the commands lies outside of its space.

use super::{Basis, Geometry, in_order, tables};
use crate::Flight;

/// Rows in the air under which nothing is said.
const FEWEST_ROWS: usize = 100;
/// A layout fits when at most this share of the variance is outside of its space. Calm and
/// gusty flights have 0 to 0.02; failed motors and motors at a limit raise it.
const FITS: f64 = 0.05;
/// A layout does not fit, by itself, from this share on.
const FITS_NOT: f64 = 0.2;
/// A share is clearly larger than another one from so many times of it, and this, on.
const CLEARLY: (f64, f64) = (5.0, 0.01);
/// Correlation of effort and attitude error up to which they do not go with each other. Right
/// layouts have 0.0 to 0.9: well-tuned and slow flights little.
const GOES_WITHOUT: f64 = 0.1;
/// Correlations from which another layout fits: by itself, and where it is so far above.
const GOES_WITH: f64 = 0.4;
const GOES_WITH_RATHER: (f64, f64) = (0.25, 0.6);

/// The common layout that fits the commands, if only one does. Layouts with the same space
/// count as one, for which the most common stands.
pub(super) fn geometry(flight: &Flight, class: Option<i64>) -> Option<Geometry> {
    let variance = Variance::of_commands(flight)?;
    let of_class = |of: &i64| class.is_none_or(|class| class == *of);
    let shares: Vec<(f64, String, Vec<[f64; 3]>)> = layouts(flight)
        .filter(|(class, ..)| of_class(class))
        .map(|(_, name, factors)| (variance.outside(&factors), name, factors))
        .collect();
    let least = shares.iter().map(|(share, ..)| *share).reduce(f64::min)?;
    let (alike, others): (Vec<_>, Vec<_>) = shares
        .into_iter()
        .partition(|(share, ..)| share - least < 1e-6);
    if least > FITS
        || !others
            .iter()
            .all(|(share, ..)| is_clearly_more(*share, least))
    {
        return None;
    }
    let mut alike = alike.into_iter().map(|(_, name, factors)| (name, factors));
    let (name, factors) = alike.next()?;
    let same: Vec<String> = alike.map(|(name, _)| name).collect();
    let same = match same.is_empty() {
        true => String::new(),
        false => format!(
            " (or {}, whose mixer spans the same space)",
            same.join(", ")
        ),
    };
    Some(Geometry {
        factors,
        frame: Some(name),
        basis: Basis::Inferred,
        source: format!("the only common layout that fits the commands{same}"),
        doubt: None,
    })
}

fn is_clearly_more(share: f64, than: f64) -> bool {
    let (times, more) = CLEARLY;
    share > times * than + more
}

/// Why the commands of the flight contradict a layout.
pub(super) fn contradiction(flight: &Flight, geometry: &Geometry) -> Option<String> {
    let variance = Variance::of_commands(flight)?;
    let is_other = |name: &String| Some(name) != geometry.frame.as_ref();
    let others = || layouts(flight).filter(|(_, name, _)| is_other(name));
    let share = variance.outside(&geometry.factors);
    if share > FITS_NOT {
        let better = others()
            .map(|(_, name, factors)| (variance.outside(&factors), name))
            .min_by(|(a, _), (b, _)| a.total_cmp(b))
            .filter(|(other, _)| *other < FITS && is_clearly_more(share, *other));
        if let Some((other, name)) = better {
            return Some(format!(
                "{:.0} % of the variance of the commands is outside of its mixer, {:.0} % outside of that of {name}",
                100.0 * share,
                100.0 * other
            ));
        }
    }
    let [roll, pitch] = variance.goes_with_error(&geometry.factors)?;
    if roll.min(pitch) > GOES_WITHOUT {
        return None;
    }
    let (least, name) = others()
        .filter_map(|(_, name, factors)| {
            let [roll, pitch] = variance.goes_with_error(&factors)?;
            Some((roll.min(pitch), name))
        })
        .max_by(|(a, _), (b, _)| a.total_cmp(b))?;
    let (from, above) = GOES_WITH_RATHER;
    let fits = least > GOES_WITH || least > from && least > roll.min(pitch) + above;
    fits.then(|| {
        format!(
            "its roll and pitch commands do not go with the attitude error (correlations {roll:.2} and {pitch:.2}), those of {name} do ({least:.2} or more)"
        )
    })
}

/// The layouts that the motors of a flight may have: class, name, factors.
fn layouts(flight: &Flight) -> impl Iterator<Item = (i64, String, Vec<[f64; 3]>)> {
    let candidates = tables::candidates(flight.motors.len()).iter();
    candidates.filter_map(|&(class, kind)| {
        let factors = in_order(&flight.motors, &tables::layout(class, kind)?)?;
        Some((class, tables::name(class, kind), factors))
    })
}

/// Variances and covariances of the commands in the air, and of these with the attitude error.
struct Variance {
    commands: Covariance,
    /// The last two are the errors of roll and pitch, set point less angle.
    with_error: Covariance,
}

impl Variance {
    fn of_commands(flight: &Flight) -> Option<Self> {
        let motors = flight.motors.len();
        let mut commands = Covariance::new(motors);
        let mut with_error = Covariance::new(motors + 2);
        let hold = |name| flight.signal(name).map(|signal| signal.hold());
        let mut attitude = ["roll_des_deg", "roll_deg", "pitch_des_deg", "pitch_deg"].map(hold);
        let mut row = Vec::new();
        for (t_s, raw) in flight.commands.rows() {
            if flight.is_in_air(t_s) != Some(true) {
                continue;
            }
            row.clear();
            row.extend(raw.iter().map_while(|&raw| flight.effective_command(raw)));
            if row.len() < motors {
                continue;
            }
            commands.add(&row);
            let [roll_des, roll, pitch_des, pitch] = attitude.each_mut().map(|hold| {
                hold.as_mut()
                    .and_then(|hold| hold.at(t_s))
                    .unwrap_or(f64::NAN)
            });
            row.extend([roll_des - roll, pitch_des - pitch]);
            if row.iter().all(|value| value.is_finite()) {
                with_error.add(&row);
            }
        }
        (commands.count >= FEWEST_ROWS).then_some(Self {
            commands,
            with_error,
        })
    }

    /// The share of the variance, without that of the thrust, that is outside of the space of a mixer.
    fn outside(&self, factors: &[[f64; 3]]) -> f64 {
        let motors = factors.len();
        let axes = (0..3).map(|axis| factors.iter().map(|f| f[axis]).collect());
        let basis = orthonormal(std::iter::once(vec![1.0; motors]).chain(axes));
        let along = |direction: &Vec<f64>| self.commands.along(direction);
        let total = (0..motors).map(|i| self.commands.of(i, i)).sum::<f64>()
            - basis.first().map_or(0.0, along);
        let inside: f64 = basis.iter().skip(1).map(along).sum();
        ((total - inside) / total.max(1e-12)).max(0.0)
    }

    /// How the effort of roll and of pitch goes with its attitude error, as correlations.
    fn goes_with_error(&self, factors: &[[f64; 3]]) -> Option<[f64; 2]> {
        if self.with_error.count < FEWEST_ROWS {
            return None;
        }
        let motors = factors.len();
        let column = |axis: usize| factors.iter().map(|f| f[axis]).collect::<Vec<f64>>();
        let correlation = |axis: usize| {
            // The least-squares effort of an axis is along what of its column is outside of the others.
            let others = (0..3).filter(|&other| other != axis).map(column);
            let mut direction = column(axis);
            for other in orthonormal(std::iter::once(vec![1.0; motors]).chain(others)) {
                reject(&mut direction, &other);
            }
            let with = |i: usize| self.with_error.of(i, motors + axis);
            let covariance: f64 = direction.iter().enumerate().map(|(i, d)| d * with(i)).sum();
            let square = self.with_error.along(&direction)
                * self.with_error.of(motors + axis, motors + axis);
            (square > 0.0).then(|| covariance / square.sqrt())
        };
        Some([correlation(0)?, correlation(1)?])
    }
}

/// Covariances of rows of values, in one pass (Welford 1962).
struct Covariance {
    count: usize,
    size: usize,
    mean: Vec<f64>,
    products: Vec<f64>,
}

impl Covariance {
    fn new(size: usize) -> Self {
        Self {
            count: 0,
            size,
            mean: vec![0.0; size],
            products: vec![0.0; size * size],
        }
    }

    fn add(&mut self, row: &[f64]) {
        self.count += 1;
        let before: Vec<f64> = row
            .iter()
            .zip(&self.mean)
            .map(|(x, mean)| x - mean)
            .collect();
        for (mean, off) in self.mean.iter_mut().zip(&before) {
            *mean += off / self.count as f64;
        }
        for (products, off) in self.products.chunks_exact_mut(self.size).zip(&before) {
            let after = row.iter().zip(&self.mean).map(|(x, mean)| x - mean);
            for (product, after) in products.iter_mut().zip(after) {
                *product += off * after;
            }
        }
    }

    fn of(&self, i: usize, j: usize) -> f64 {
        let product = self.products.get(i * self.size + j);
        product.copied().unwrap_or_default() / self.count.max(1) as f64
    }

    /// Variance along a direction over the first values.
    fn along(&self, direction: &[f64]) -> f64 {
        let part = |i: usize, di: f64| -> f64 {
            let row = direction.iter().enumerate();
            row.map(|(j, dj)| di * dj * self.of(i, j)).sum()
        };
        direction
            .iter()
            .enumerate()
            .map(|(i, di)| part(i, *di))
            .sum()
    }
}

/// An orthonormal basis of the space of these vectors (Gram-Schmidt).
fn orthonormal(vectors: impl Iterator<Item = Vec<f64>>) -> Vec<Vec<f64>> {
    let mut basis: Vec<Vec<f64>> = Vec::new();
    for mut vector in vectors {
        for known in &basis {
            reject(&mut vector, known);
        }
        let length = dot(&vector, &vector).sqrt();
        if length > 1e-6 {
            basis.push(vector.iter().map(|x| x / length).collect());
        }
    }
    basis
}

/// Takes the part along a unit vector out of a vector.
fn reject(vector: &mut [f64], unit: &[f64]) {
    let along = dot(vector, unit);
    for (x, u) in vector.iter_mut().zip(unit) {
        *x -= along * u;
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
