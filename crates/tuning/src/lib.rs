//! Tunes fuzzy rule sets on data: peaks of partitions, parameters of membership functions, consequents and weights.
//!
//! Tuning does not change the rules, and keeps the properties that make them readable: the order of the terms of a
//! variable, a minimum distance between their peaks, partitions whose degrees sum to 1, vertical edges, and terms that
//! touch the end of a range. No width, slope or flank grows or shrinks by more than a factor of five. These properties
//! are guaranteed by construction: the search changes free numbers, and any values of these numbers result in a model
//! with these properties.
//!
//! [`tune`] minimises a [`Loss`] by damped Gauss-Newton steps (Levenberg 1944, Marquardt 1963). With squared errors the
//! consequents of a Takagi-Sugeno output are computed by least squares at every step, as in ANFIS (Jang 1993).
//! [`cross_validate`] estimates the loss of a tuned model on unseen rows.
//!
//! [`identify`] finds inputs, partitions and rules from data alone; [`c_means`] finds clusters of rows, which can be
//! the terms of an input; [`simplify()`] reduces the number of rules and keeps the outputs.

pub mod c_means;
mod confusion;
mod consequents;
mod data;
mod folds;
pub mod identify;
mod loss;
mod numbers;
mod objective;
mod ordered;
mod parameters;
mod reliability;
mod search;
mod settings;
mod simplify;
mod validation;

use std::ops::ControlFlow;

use fuzzy::{Model, check, model::MembershipFunction};

pub use confusion::Confusion;
pub use data::Data;
pub use folds::Interval;
pub use numbers::{ChangedNumber, Number, moved_although_fixed, numbers, with_numbers_of};
pub use reliability::Bin;
pub use settings::{Loss, Settings, TuneError};
pub use simplify::{
    Difference, EQUAL_TOLERANCE, MAX_RULES, SimplifyError, SimplifyResult, SimplifySettings,
    simplify,
};
pub use validation::{CurvePoint, Validation, cross_validate, learning_curve};

use objective::{Objective, Point};
use parameters::Parameters;

/// A tuned model.
#[derive(Debug, Clone, PartialEq)]
pub struct TuneResult {
    /// The model.
    pub model: Model,
    /// The loss of the original model; see [`Loss`].
    pub before: f64,
    /// The loss of the tuned model.
    pub after: f64,
    /// The number of rows for which the tuned model has no value; the middle of the range counts as their prediction.
    pub without_value: usize,
    /// The numbers that changed.
    pub moved: Vec<ChangedNumber>,
    /// The constants, as `variable.term`, that are at an end of the range (see [`Settings::beyond_range`]) although
    /// the loss would be smaller beyond it.
    pub at_bounds: Vec<String>,
    /// Whether `watch` ended the search.
    pub is_stopped: bool,
}

/// The progress of a search.
#[derive(Debug)]
pub struct Progress<'a> {
    /// The number of the start, from 1.
    pub start: u32,
    /// The number of the step within this start, from 1.
    pub iteration: u32,
    /// The loss of the best model so far, over all starts.
    pub loss: f64,
    /// The best model so far.
    pub model: &'a Model,
}

/// Minimises the loss on the rows by changing the numbers of a model that [`Settings`] allow to change. Only steps that
/// reduce the loss are taken; rounding to [`Settings::digits`] may undo some of the gain. The same arguments give the
/// same result.
///
/// `watch` is called before every step; on `Break` the search ends with the best model so far.
///
/// # Errors
/// If the rows do not fit the model or the loss, if a name is unknown, if no number may change, or if the model cannot
/// be used.
///
/// # Example: where warm begins
/// ```
/// use std::ops::ControlFlow;
/// use flagred_tuning::{Data, Settings, tune};
///
/// let model = fuzzy::yaml::parse("
/// fuzzy: 1
/// name: fan
/// inputs:
///   heat: {range: [0, 40], partition: {cool: 5, hot: 35}}
/// outputs:
///   speed:
///     range: [0, 10]
///     terms: {slow: {singleton: 2}, fast: {singleton: 8}}
/// rules:
///   - IF heat IS cool THEN speed IS slow
///   - IF heat IS hot THEN speed IS fast
/// ")?.model;
/// // The fan turns slowly up to 20 degrees, fast from 30 degrees on.
/// let heat: Vec<f64> = (0..=40).map(f64::from).collect();
/// let speed = |heat: &f64| 2.0 + 6.0 * ((heat - 20.0) / 10.0).clamp(0.0, 1.0);
/// let data = Data { truths: heat.iter().map(speed).collect(), inputs: vec![heat], ..Data::default() };
/// let tuned = tune(&model, &data, &Settings::default(), &mut |_| ControlFlow::Continue(()))?;
/// assert!(tuned.before > 1.0 && tuned.after < 0.01);
/// let peaks = tuned.model.inputs[0].partition_peaks().unwrap();
/// assert!((peaks[0] - 20.0).abs() < 0.1 && (peaks[1] - 30.0).abs() < 0.1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn tune(
    model: &Model,
    data: &Data,
    settings: &Settings,
    watch: &mut dyn FnMut(&Progress<'_>) -> ControlFlow<()>,
) -> Result<TuneResult, TuneError> {
    data.check(model, settings.loss)?;
    let parameters = Parameters::new(model, settings)?;
    let objective = Objective::new(model, &parameters, data, settings);
    let before = objective.point(model.clone())?;
    if let Some(claim) = objective.broken_claim(model)? {
        return Err(TuneError::NotMonotone {
            input: claim.input,
            direction: match claim.direction {
                check::Direction::Increasing => "increasing",
                check::Direction::Decreasing => "decreasing",
            },
        });
    }
    let before = (objective.measure(&before), before);
    if !(before.0.is_finite() && before.1.slopes.loss.is_finite()) {
        return Err(TuneError::NotFinite);
    }
    let mut best = before.clone();
    let improve = |best: &mut (f64, Point), point: &Point| {
        if point.slopes.loss < best.1.slopes.loss {
            *best = (objective.measure(point), point.clone());
        }
    };
    let mut is_stopped = false;
    let mut random = fastrand::Rng::with_seed(settings.seed);
    for start in 1..=settings.starts.max(1) {
        // A change of 1 in a free number is large: a factor of about e for a width or a distance, the width of the
        // range for a constant.
        let mut jitter = || {
            if start == 1 {
                0.0
            } else {
                2.0 * random.f64() - 1.0
            }
        };
        let from: Vec<f64> = (0..parameters.free()).map(|_| jitter()).collect();
        let reported = &mut |iteration: u32, at: Option<&Point>| {
            at.into_iter().for_each(|at| improve(&mut best, at));
            watch(&Progress {
                start,
                iteration,
                loss: best.0,
                model: &best.1.model,
            })
        };
        let (found, flow) = search::search(
            &objective,
            &parameters,
            &from,
            settings.iterations,
            reported,
        )?;
        found.iter().for_each(|found| improve(&mut best, found));
        is_stopped = flow.is_break();
        if is_stopped {
            break;
        }
    }
    let mut best = best.1;
    if let Some(digits) = settings.digits {
        best = rounded(&objective, &parameters, model, best, digits)?;
    }
    Ok(TuneResult {
        before: before.0,
        after: objective.measure(&best),
        without_value: best
            .predictions
            .iter()
            .filter(|place| place.is_nan())
            .count(),
        at_bounds: at_bounds(&objective, &parameters, &best),
        moved: numbers::moved(model, &best.model),
        model: best.model,
        is_stopped,
    })
}

/// Rounds the changed numbers, one at a time, to the neighbour with the smaller loss. A number whose neighbours both
/// break a constraint is not rounded.
fn rounded(
    objective: &Objective<'_>,
    parameters: &Parameters,
    before: &Model,
    mut at: Point,
    digits: u32,
) -> Result<Point, TuneError> {
    let originals = numbers(before);
    let widths = numbers::widths(before);
    for (index, (original, width)) in originals.iter().zip(widths).enumerate() {
        let known = numbers(&at.model);
        let Some(number) = known
            .get(index)
            .filter(|number| number.value != original.value)
        else {
            continue;
        };
        // Numbers that are equal stay equal, such as the sides of a vertical edge, or the positions
        // at which two terms begin.
        let variable = |number: &Number| number.of.split('.').next().map(str::to_owned);
        let is_equal = |(_, other): &(usize, &Number)| {
            other.value == number.value && variable(other) == variable(number)
        };
        let equal = known.iter().enumerate().filter(is_equal).map(|(i, _)| i);
        let equal: Vec<usize> = equal.collect();
        let mut nearest: Option<Point> = None;
        for value in numbers::round(number.value, digits, width) {
            let model = numbers::with(&at.model, &equal, value);
            if !parameters.keeps(&model) || objective.broken_claim(&model)?.is_some() {
                continue;
            }
            let point = objective.point(model)?;
            if nearest
                .as_ref()
                .is_none_or(|best| point.slopes.loss < best.slopes.loss)
            {
                nearest = Some(point);
            }
        }
        at = nearest.unwrap_or(at);
    }
    Ok(at)
}

/// The constants at a bound beyond which the loss would be smaller.
fn at_bounds(objective: &Objective<'_>, parameters: &Parameters, at: &Point) -> Vec<String> {
    const BEYOND: f64 = 1e-3;
    let mut names = Vec::new();
    for ((output, term), (low, high)) in parameters.bounded() {
        let mut model = at.model.clone();
        let Some(output) = model.outputs.get_mut(output) else {
            continue;
        };
        let variable = &mut output.variable;
        let step = BEYOND * (variable.high - variable.low);
        let Some(term) = variable.terms.get_mut(term) else {
            continue;
        };
        let name = format!("{}.{}", variable.name, term.name);
        let MembershipFunction::Constant { value } = &mut term.membership_function else {
            continue;
        };
        *value += match *value {
            value if value >= high => step,
            value if value <= low => -step,
            _ => continue,
        };
        let beyond = objective.point(model);
        if beyond.is_ok_and(|beyond| beyond.slopes.loss < at.slopes.loss) {
            names.push(name);
        }
    }
    names
}

#[cfg(test)]
mod tests;
