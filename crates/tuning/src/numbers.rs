//! The numbers of a model that tuning can change, with their names.

use std::collections::BTreeSet;

use fuzzy::{
    Model,
    model::{MembershipFunction, Term, Variable},
};

use crate::{parameters::is_width, settings::Settings};

/// A number of a model.
#[derive(Debug, Clone, PartialEq)]
pub struct Number {
    /// The element that contains it: `variable.term`, or `rule 3` counted from 1.
    pub of: String,
    /// The name of the number: `peak` of a partition, the name of a shape's parameter, `constant` or the name of an
    /// input in a linear consequent, `weight`.
    pub name: String,
    /// The current value.
    pub value: f64,
}

/// A number that tuning changed.
#[derive(Debug, Clone, PartialEq)]
pub struct ChangedNumber {
    /// The element that contains it: `variable.term`, or `rule 3` counted from 1.
    pub of: String,
    /// The name of the number, as in [`Number::name`].
    pub name: String,
    /// The value before tuning.
    pub before: f64,
    /// The value after tuning.
    pub after: f64,
}

/// Returns the numbers that differ between two models.
pub(crate) fn moved(before: &Model, after: &Model) -> Vec<ChangedNumber> {
    let pairs = numbers(before).into_iter().zip(numbers(after));
    let differ = pairs.filter(|(before, after)| before.value != after.value);
    let moved = differ.map(|(before, after)| ChangedNumber {
        of: before.of,
        name: before.name,
        before: before.value,
        after: after.value,
    });
    moved.collect()
}

/// The first number that differs although `settings` do not allow it to change.
pub fn moved_although_fixed(
    before: &Model,
    after: &Model,
    settings: &Settings,
) -> Option<ChangedNumber> {
    let (mut movable, mut fixed) = (BTreeSet::new(), BTreeSet::new());
    for variable in before.variables() {
        for term in &variable.terms {
            let names = match settings.may_move(&variable.name, &term.name) {
                true => &mut movable,
                false => &mut fixed,
            };
            names.insert(format!("{}.{}", variable.name, term.name));
        }
    }
    // An element that is not a term is a rule, whose number is its weight.
    let is_fixed = |of: &String| fixed.contains(of) || !(settings.weights || movable.contains(of));
    moved(before, after)
        .into_iter()
        .find(|moved| is_fixed(&moved.of))
}

/// The numbers of a model, in the order of the model. The limits of `steps` are excluded.
pub fn numbers(model: &Model) -> Vec<Number> {
    let mut numbers = Vec::new();
    change(&mut model.clone(), &mut |number, _| {
        let value = number.value;
        numbers.push(number);
        value
    });
    numbers
}

/// For each of the [`numbers`], the width of the variable's range if the number is a position in this range, otherwise
/// infinity.
pub(crate) fn widths(model: &Model) -> Vec<f64> {
    let mut widths = Vec::new();
    change(&mut model.clone(), &mut |number, width| {
        widths.push(width);
        number.value
    });
    widths
}

/// The `model` with the numbers of `other`. `None` if `other` has different numbers, because its terms, shapes or rules
/// differ.
pub fn with_numbers_of(model: &Model, other: &Model) -> Option<Model> {
    let (own, others) = (numbers(model), numbers(other));
    let name = |number: &Number| (number.of.clone(), number.name.clone());
    if !own.iter().map(name).eq(others.iter().map(name)) {
        return None;
    }
    let mut values = others.into_iter();
    let mut model = model.clone();
    change(&mut model, &mut |number, _| {
        values.next().map_or(number.value, |other| other.value)
    });
    Some(model)
}

/// The model with another value for the numbers at these indices in [`numbers`]. Values that are invalid for a shape
/// are ignored.
pub(crate) fn with(model: &Model, indices: &[usize], value: f64) -> Model {
    let mut model = model.clone();
    let mut index = 0..;
    change(&mut model, &mut |number, _| match index.next() {
        Some(index) if indices.contains(&index) => value,
        _ => number.value,
    });
    model
}

/// Returns the new value of a number. The second argument is the width of the variable's range if the number is a
/// position in this range, otherwise infinity.
type Change<'a> = dyn FnMut(Number, f64) -> f64 + 'a;

/// Sets each number of a model to the value that `value` returns for it.
fn change(model: &mut Model, value: &mut Change<'_>) {
    let outputs = model.outputs.iter_mut().map(|output| &mut output.variable);
    for variable in model.inputs.iter_mut().chain(outputs) {
        match variable.partition_peaks() {
            Some(peaks) => partition(variable, &peaks, value),
            // Limits are not tuned, because they are requirements of the author.
            None if variable.step_limits().is_some() => {}
            None => {
                let width = variable.high - variable.low;
                for term in &mut variable.terms {
                    shape(&variable.name, width, term, value);
                }
            }
        }
    }
    for (i, rule) in model.rules.iter_mut().enumerate() {
        let number = Number {
            of: format!("rule {}", i + 1),
            name: "weight".into(),
            value: rule.rule.weight,
        };
        rule.rule.weight = value(number, f64::INFINITY);
    }
}

fn partition(variable: &mut Variable, peaks: &[f64], value: &mut Change<'_>) {
    let width = variable.high - variable.low;
    let terms = std::mem::take(&mut variable.terms);
    let moved = terms.iter().zip(peaks).map(|(term, peak)| {
        let number = Number {
            of: format!("{}.{}", variable.name, term.name),
            name: "peak".into(),
            value: *peak,
        };
        (term.name.as_str(), value(number, width))
    });
    let moved: Vec<(&str, f64)> = moved.collect();
    *variable = variable.clone().partition_at(moved);
}

fn shape(variable: &str, width: f64, term: &mut Term, value: &mut Change<'_>) {
    let of = format!("{variable}.{}", term.name);
    let mut moved = |name: &str, number: f64, width: f64| {
        let number = Number {
            of: of.clone(),
            name: name.into(),
            value: number,
        };
        value(number, width)
    };
    if let MembershipFunction::Linear {
        coefficients,
        constant,
    } = &mut term.membership_function
    {
        for (input, coefficient) in coefficients {
            *coefficient = moved(input, *coefficient, f64::INFINITY);
        }
        *constant = moved("constant", *constant, f64::INFINITY);
        return;
    }
    let parameters = term.membership_function.parameters();
    let values = parameters.iter().map(|(name, role, number)| {
        let is_position = !is_width(name, *role);
        moved(
            name,
            *number,
            if is_position { width } else { f64::INFINITY },
        )
    });
    let values: Vec<f64> = values.collect();
    if let Ok(moved) = term.membership_function.with_parameters(&values) {
        term.membership_function = moved;
    }
}

/// Returns the nearest number with `digits` significant digits on each side of `value`, or only `value` if it has no
/// more digits than that. If the value is a position, `width` is the width of its range, otherwise infinity. If the
/// width is smaller than the position, the digits are counted from the first digit of the width. A position near 0 is
/// not rounded more finely than its range requires: three digits are at most 0.05 % of the width.
pub(crate) fn round(value: f64, digits: u32, width: f64) -> Vec<f64> {
    if value == 0.0 || !value.is_finite() {
        return vec![value];
    }
    // Such a small position is the rounding error of a difference that should be 0.
    if width.is_finite() && value.abs() < 1e-9 * width {
        return vec![0.0];
    }
    let digits = digits.max(1) as i32;
    let of_value = value.abs().min(width).log10().floor() as i32 - (digits - 1);
    let of_width = (0.5 * width * 10_f64.powi(-digits)).log10().floor() as i32;
    let exponent = match width.is_finite() {
        true => of_value.max(of_width),
        false => of_value,
    };
    let steps = value / 10_f64.powi(exponent);
    let mut rounded: Vec<f64> = [steps.floor(), steps.ceil()]
        .into_iter()
        .filter_map(|steps| decimal(steps, exponent))
        .collect();
    rounded.dedup();
    rounded
}

/// Returns `steps` times the power of ten with the given exponent. The result is parsed from text, so that 0.3 is
/// exactly 0.3 and not 3 times a tenth.
pub(crate) fn decimal(steps: f64, exponent: i32) -> Option<f64> {
    let parsed: f64 = format!("{steps:.0}e{exponent}").parse().ok()?;
    // Adding 0 removes the sign of -0.
    Some(parsed + 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_round_neighbours() {
        let free = f64::INFINITY;
        assert_eq!(round(0.3271, 2, free), [0.32, 0.33]);
        assert_eq!(round(-1234.0, 2, free), [-1300.0, -1200.0]);
        assert_eq!(round(0.3, 2, free), [0.3]);
        assert_eq!(round(0.0, 2, free), [0.0]);
        assert_eq!(round(99.7, 2, free), [99.0, 100.0]);
        // For example, a pressure from 950 to 1050.
        assert_eq!(round(1013.27, 3, 100.0), [1013.0, 1014.0]);
        // Rounding to two digits changes a position by at most 0.5 % of the range, and rounding to three digits by at most
        // 0.05 %.
        assert_eq!(round(0.3271, 2, 100.0), [0.3, 0.4]);
        assert_eq!(round(0.000949, 3, 40.0), [0.0, 0.01]);
        assert_eq!(round(-0.000949, 3, 40.0), [-0.01, 0.0]);
        assert_eq!(round(27.46, 3, 40.0), [27.4, 27.5]);
        assert_eq!(round(0.000949, 3, 0.5), [0.0009, 0.001]);
        assert_eq!(round(-3.1e-15, 2, 100.0), [0.0]);
    }
}
