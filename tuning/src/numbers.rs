//! The numbers of a model that tuning can move, each with its name.

use fuzzy::{
    Model,
    model::{MembershipFunction, Term, Variable},
};

/// A number of a model.
#[derive(Debug, Clone, PartialEq)]
pub struct Number {
    /// What it belongs to: `variable.term`, or `rule 3` counted from 1.
    pub of: String,
    /// Which one it is: `peak` of a partition, the name of a shape's parameter, `constant` or the name of an input of a
    /// linear consequent, `weight`.
    pub name: String,
    /// Its value.
    pub value: f64,
}

/// A number that tuning moved.
#[derive(Debug, Clone, PartialEq)]
pub struct Moved {
    /// What it belongs to: `variable.term`, or `rule 3` counted from 1.
    pub of: String,
    /// Which one it is, as in [`Number::name`].
    pub name: String,
    /// Its value before.
    pub before: f64,
    /// Its value after.
    pub after: f64,
}

/// The numbers that differ.
pub(crate) fn moved(before: &Model, after: &Model) -> Vec<Moved> {
    let pairs = numbers(before).into_iter().zip(numbers(after));
    let differ = pairs.filter(|(before, after)| before.value != after.value);
    let moved = differ.map(|(before, after)| Moved {
        of: before.of,
        name: before.name,
        before: before.value,
        after: after.value,
    });
    moved.collect()
}

/// The numbers of a model, in the order in which it has them.
pub fn numbers(model: &Model) -> Vec<Number> {
    let mut numbers = Vec::new();
    change(&mut model.clone(), &mut |number| {
        let value = number.value;
        numbers.push(number);
        value
    });
    numbers
}

/// The model with another value of the numbers of these indices in [`numbers`]. Values that a shape cannot have change
/// nothing.
pub(crate) fn with(model: &Model, indices: &[usize], value: f64) -> Model {
    let mut model = model.clone();
    let mut index = 0..;
    change(&mut model, &mut |number| match index.next() {
        Some(index) if indices.contains(&index) => value,
        _ => number.value,
    });
    model
}

/// Gives each number of a model the value that `value` returns for it.
fn change(model: &mut Model, value: &mut dyn FnMut(Number) -> f64) {
    let outputs = model.outputs.iter_mut().map(|output| &mut output.variable);
    for variable in model.inputs.iter_mut().chain(outputs) {
        match variable.partition_peaks() {
            Some(peaks) => partition(variable, &peaks, value),
            None => {
                for term in &mut variable.terms {
                    shape(&variable.name, term, value);
                }
            }
        }
    }
    for (i, rule) in model.rules.iter_mut().enumerate() {
        rule.rule.weight = value(Number {
            of: format!("rule {}", i + 1),
            name: "weight".into(),
            value: rule.rule.weight,
        });
    }
}

fn partition(variable: &mut Variable, peaks: &[f64], value: &mut dyn FnMut(Number) -> f64) {
    let terms = std::mem::take(&mut variable.terms);
    let moved = terms.iter().zip(peaks).map(|(term, peak)| {
        let moved = value(Number {
            of: format!("{}.{}", variable.name, term.name),
            name: "peak".into(),
            value: *peak,
        });
        (term.name.as_str(), moved)
    });
    let moved: Vec<(&str, f64)> = moved.collect();
    *variable = variable.clone().partition_at(moved);
}

fn shape(variable: &str, term: &mut Term, value: &mut dyn FnMut(Number) -> f64) {
    let of = format!("{variable}.{}", term.name);
    let mut moved = |name: &str, number: f64| {
        value(Number {
            of: of.clone(),
            name: name.into(),
            value: number,
        })
    };
    if let MembershipFunction::Linear {
        coefficients,
        constant,
    } = &mut term.membership_function
    {
        for (input, coefficient) in coefficients {
            *coefficient = moved(input, *coefficient);
        }
        *constant = moved("constant", *constant);
        return;
    }
    let parameters = term.membership_function.parameters();
    let values = parameters
        .iter()
        .map(|(name, _, number)| moved(name, *number));
    let values: Vec<f64> = values.collect();
    if let Ok(moved) = term.membership_function.with_parameters(&values) {
        term.membership_function = moved;
    }
}

/// The two numbers with so many significant digits on either side of a number; one where it has no more itself.
pub(crate) fn round(value: f64, digits: u32) -> Vec<f64> {
    if value == 0.0 || !value.is_finite() {
        return vec![value];
    }
    let exponent = value.abs().log10().floor() as i32 - (digits.max(1) as i32 - 1);
    let steps = value / 10_f64.powi(exponent);
    let mut rounded: Vec<f64> = [steps.floor(), steps.ceil()]
        .into_iter()
        .filter_map(|steps| decimal(steps, exponent))
        .collect();
    rounded.dedup();
    rounded
}

/// So many steps of a power of ten. Through text, so that 0.3 is 0.3 and not 3 times a tenth.
pub(crate) fn decimal(steps: f64, exponent: i32) -> Option<f64> {
    format!("{steps:.0}e{exponent}").parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_round_neighbours() {
        assert_eq!(round(0.3271, 2), [0.32, 0.33]);
        assert_eq!(round(-1234.0, 2), [-1300.0, -1200.0]);
        assert_eq!(round(0.3, 2), [0.3]);
        assert_eq!(round(0.0, 2), [0.0]);
        assert_eq!(round(99.7, 2), [99.0, 100.0]);
    }
}
