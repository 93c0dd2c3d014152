//! Infers the motor layout from the commands of a flight.
//!
//! A mixer adds thrust, roll, pitch and yaw, so the commands of `n` motors are in a four-dimensional space (thrust
//! curves and limits distort it a little). A layout fits if little of the variance of the commands is outside its
//! space.

use super::{Basis, Geometry, in_order, tables};
use crate::Flight;

/// The minimum number of rows in the air.
const MIN_ROWS: usize = 100;
/// A layout fits if at most this share of the variance is outside its space. In calm and gusty flights the share is
/// 0 to 0.02; failed motors and motors at a limit raise it.
const FITS: f64 = 0.05;
/// A layout does not fit if at least this share of the variance is outside its space.
const MISFIT: f64 = 0.2;
/// `(factor, offset)`: a share is clearly larger than another share `s` if it exceeds `factor * s + offset`.
const CLEARLY: (f64, f64) = (5.0, 0.002);
/// The minimum correlation of the efforts with the outputs of the rate controllers for a layout to be right. It is
/// 0.44 to 1 for the right layout, and higher than for any other layout.
const FOLLOWS: f64 = 0.4;
/// The minimum difference by which this correlation must be higher for the right layout than for any other layout.
const FOLLOWS_LEAD: f64 = 0.2;
/// A declared layout is doubted only if its correlation of effort and attitude error is below this. Right layouts have
/// 0.0 to 0.9; well-tuned and slow flights have low values.
const DOUBT_BELOW: f64 = 0.1;
/// Another layout fits if its correlation of effort and attitude error exceeds this.
const ALTERNATIVE_ABOVE: f64 = 0.4;
/// `(minimum, lead)`: another layout also fits if its correlation exceeds `minimum`, and is higher than the
/// correlation of the declared layout by more than `lead`.
const ALTERNATIVE_LEAD: (f64, f64) = (0.25, 0.6);

/// The signals that show whether a layout is right: the outputs of the rate controllers, and the attitude.
pub(crate) const SIGNALS: [&str; 7] = [
    "roll_output",
    "pitch_output",
    "yaw_output",
    "roll_des_deg",
    "roll_deg",
    "pitch_des_deg",
    "pitch_deg",
];

/// The common layout that fits the commands, if only one does. Layouts with the same space count as one; the most
/// common of them is returned.
pub(super) fn geometry(flight: &Flight, class: Option<i64>) -> Option<Geometry> {
    let variance = Variance::of_commands(flight, false)?;
    let of_class = |of: &i64| class.is_none_or(|class| class == *of);
    let shares: Vec<(f64, String, Vec<[f64; 3]>)> = layouts(flight)
        .filter(|(class, ..)| of_class(class))
        .map(|(_, name, factors)| (variance.outside(&factors), name, factors))
        .collect();
    let least = shares.iter().map(|(share, ..)| *share).reduce(f64::min)?;
    let (alike, others): (Vec<_>, Vec<_>) = shares
        .into_iter()
        .partition(|(share, ..)| share - least < 1e-6);
    // If only yaw was commanded, several layouts fit; they must agree on yaw.
    let alike_in_yaw = |factors: &[[f64; 3]]| {
        let (_, _, first) = alike.first()?;
        let product = |a: &[[f64; 3]], b: &[[f64; 3]]| -> f64 {
            a.iter().zip(b).map(|(a, b)| a[2] * b[2]).sum()
        };
        let norms = product(factors, factors) * product(first, first);
        Some(product(factors, first).abs() > 0.999 * norms.sqrt())
    };
    if least > FITS
        || !others.iter().all(|(share, _, factors)| {
            is_clearly_more(*share, least) || alike_in_yaw(factors) == Some(true)
        })
    {
        return None;
    }
    if let Some(geometry) = by_outputs(&variance, &alike) {
        return Some(geometry);
    }
    // With four motors, all layouts span the same space, so the commands do not distinguish them.
    let mut alike = alike.into_iter().filter(|_| flight.motors.len() > 4);
    let (_, name, factors) = alike.next()?;
    let same: Vec<String> = alike.map(|(_, name, _)| name).collect();
    let same = match same.is_empty() {
        true => String::new(),
        false => format!(
            " (or {}, which the commands do not distinguish from it)",
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

/// The layout whose efforts follow the outputs of the rate controllers, if all layouts that follow them nearly as well
/// have the same yaw factors.
fn by_outputs(variance: &Variance, layouts: &[(f64, String, Vec<[f64; 3]>)]) -> Option<Geometry> {
    let correlation = |factors: &[[f64; 3]]| variance.with_outputs(factors).unwrap_or(-1.0);
    let (_, name, factors) = layouts
        .iter()
        .max_by(|(.., a), (.., b)| correlation(a).total_cmp(&correlation(b)))?;
    let best = correlation(factors);
    let yaw = |factors: &[[f64; 3]]| factors.iter().map(|f| f[2]).collect::<Vec<f64>>();
    let near = |factors: &[[f64; 3]]| correlation(factors) > best - FOLLOWS_LEAD;
    let mut rivals = layouts.iter().filter(|(.., other)| near(other));
    let same_yaw = rivals.all(|(.., other)| yaw(other) == yaw(factors));
    (best > FOLLOWS && same_yaw).then(|| Geometry {
        factors: factors.clone(),
        frame: Some(name.clone()),
        basis: Basis::Inferred,
        source: format!(
            "the commands follow the outputs of the rate controllers (correlation {best:.2})"
        ),
        doubt: None,
    })
}

fn is_clearly_more(share: f64, than: f64) -> bool {
    let (times, more) = CLEARLY;
    share > times * than + more
}

/// The reason why the commands of the flight contradict a layout.
pub(super) fn contradiction(flight: &Flight, geometry: &Geometry) -> Option<String> {
    let variance = Variance::of_commands(flight, false)?;
    let is_other = |name: &String| Some(name) != geometry.frame.as_ref();
    let others = || layouts(flight).filter(|(_, name, _)| is_other(name));
    let share = variance.outside(&geometry.factors);
    if share > MISFIT {
        let running = Variance::of_commands(flight, true);
        if running.is_some_and(|running| running.outside(&geometry.factors) <= FITS) {
            return None;
        }
        let better = others()
            .map(|(_, name, factors)| (variance.outside(&factors), name))
            .min_by(|(a, _), (b, _)| a.total_cmp(b))
            .filter(|(other, _)| *other < FITS && is_clearly_more(share, *other));
        if let Some((other, name)) = better {
            return Some(format!(
                "its mixer leaves {:.0} % of the variance of the commands unexplained, that of {name} only {:.0} %",
                100.0 * share,
                100.0 * other
            ));
        }
    }
    let best = |correlation: &dyn Fn(&[[f64; 3]]) -> Option<f64>| {
        others()
            .filter_map(|(_, name, factors)| Some((correlation(&factors)?, name)))
            .max_by(|(a, _), (b, _)| a.total_cmp(b))
    };
    if let Some(own) = variance.with_outputs(&geometry.factors) {
        let (least, name) = best(&|factors| variance.with_outputs(factors))?;
        return (least > FOLLOWS && least > own + FOLLOWS_LEAD).then(|| {
            format!(
                "its roll, pitch and yaw do not follow the outputs of the controllers (correlation {own:.2}), but those of {name} do ({least:.2})"
            )
        });
    }
    let own = variance.with_errors(&geometry.factors)?;
    let (least, name) = best(&|factors| variance.with_errors(factors))?;
    let (from, above) = ALTERNATIVE_LEAD;
    let fits = least > ALTERNATIVE_ABOVE || least > from && least > own + above;
    (own < DOUBT_BELOW && fits).then(|| {
        format!(
            "its roll and pitch do not correlate with the attitude error (correlation {own:.2}), but those of {name} do ({least:.2})"
        )
    })
}

/// The layouts that are possible for the motors of a flight: class, name, factors.
fn layouts(flight: &Flight) -> impl Iterator<Item = (i64, String, Vec<[f64; 3]>)> {
    let candidates = tables::candidates(flight.motors.len()).iter();
    candidates.filter_map(|&(class, kind)| {
        let factors = in_order(&flight.motors, &tables::layout(class, kind)?)?;
        Some((class, tables::name(class, kind), factors))
    })
}

/// Variances and covariances of the commands in the air, and of the controller outputs and attitude errors to
/// which the commands respond.
struct Variance {
    commands: Covariance,
    /// The last columns are the outputs of the rate controllers of roll, pitch and yaw.
    with_outputs: Covariance,
    /// The last columns are the errors of roll and pitch: set point minus angle.
    with_errors: Covariance,
}

impl Variance {
    /// Computes the covariances from a flight. `all_run` excludes the times at which a motor is stopped, because a
    /// stopped motor does not follow the mixer.
    fn of_commands(flight: &Flight, all_run: bool) -> Option<Self> {
        let motors = flight.motors.len();
        let mut commands = Covariance::new(motors);
        let mut with_outputs = Covariance::new(motors + 3);
        let mut with_errors = Covariance::new(motors + 2);
        let hold = |name| flight.signal(name).map(|signal| signal.hold());
        let mut holds = SIGNALS.map(hold);
        let mut row = Vec::new();
        for (t_s, raw) in flight.commands.rows() {
            if flight.is_in_air(t_s) != Some(true) {
                continue;
            }
            row.clear();
            row.extend(raw.iter().map_while(|&raw| flight.effective_command(raw)));
            if row.len() < motors || all_run && row.iter().any(|command| *command <= 0.0) {
                continue;
            }
            commands.add(&row);
            let [
                roll_out,
                pitch_out,
                yaw_out,
                roll_des,
                roll,
                pitch_des,
                pitch,
            ] = holds.each_mut().map(|hold| {
                let held = hold.as_mut().and_then(|hold| hold.at(t_s));
                held.unwrap_or(f64::NAN)
            });
            let errors = [roll_des - roll, pitch_des - pitch];
            with_outputs.add_known(&mut row, &[roll_out, pitch_out, yaw_out]);
            with_errors.add_known(&mut row, &errors);
        }
        (commands.count >= MIN_ROWS).then_some(Self {
            commands,
            with_outputs,
            with_errors,
        })
    }

    /// The share of the variance that is outside the space of a mixer; the variance of the thrust is excluded.
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

    /// The smallest correlation of the roll, pitch and yaw efforts with the outputs of the rate controllers.
    fn with_outputs(&self, factors: &[[f64; 3]]) -> Option<f64> {
        // A tricopter has no yaw effort.
        let axes = (0..3).filter(|&axis| factors.iter().any(|f| f[axis] != 0.0));
        least(axes.map(|axis| self.with_outputs.with_effort(factors, axis)))
    }

    /// The smallest correlation of the roll and pitch efforts with the attitude errors.
    fn with_errors(&self, factors: &[[f64; 3]]) -> Option<f64> {
        least((0..2).map(|axis| self.with_errors.with_effort(factors, axis)))
    }
}

/// The minimum of the numbers; `None` if one is unknown.
fn least(numbers: impl Iterator<Item = Option<f64>>) -> Option<f64> {
    let numbers = numbers.collect::<Option<Vec<f64>>>()?;
    numbers.into_iter().reduce(f64::min)
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

    /// Adds commands and further values, if all of them are known.
    fn add_known(&mut self, commands: &mut Vec<f64>, values: &[f64]) {
        if values.iter().all(|value| value.is_finite()) {
            let motors = commands.len();
            commands.extend_from_slice(values);
            self.add(commands);
            commands.truncate(motors);
        }
    }

    /// The correlation of the effort of an axis with the controller output or the attitude error of that axis, which is
    /// in a column after the commands.
    fn with_effort(&self, factors: &[[f64; 3]], axis: usize) -> Option<f64> {
        if self.count < MIN_ROWS {
            return None;
        }
        let motors = factors.len();
        let column = |axis: usize| factors.iter().map(|f| f[axis]).collect::<Vec<f64>>();
        // The least-squares effort of an axis is along the part of its column that is orthogonal to the other columns.
        let others = (0..3).filter(|&other| other != axis).map(column);
        let mut direction = column(axis);
        for other in orthonormal(std::iter::once(vec![1.0; motors]).chain(others)) {
            reject(&mut direction, &other);
        }
        let value = motors + axis;
        let covariance: f64 = (direction.iter().enumerate())
            .map(|(motor, part)| part * self.of(motor, value))
            .sum();
        let square = self.along(&direction) * self.of(value, value);
        (square > 1e-18).then(|| covariance / square.sqrt())
    }

    fn of(&self, i: usize, j: usize) -> f64 {
        let product = self.products.get(i * self.size + j);
        product.copied().unwrap_or_default() / self.count.max(1) as f64
    }

    /// The variance along a direction in the space of the first values.
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

/// An orthonormal basis of the space spanned by these vectors (Gram-Schmidt).
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

/// Makes a vector orthogonal to a unit vector.
fn reject(vector: &mut [f64], unit: &[f64]) {
    let along = dot(vector, unit);
    for (x, u) in vector.iter_mut().zip(unit) {
        *x -= along * u;
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
