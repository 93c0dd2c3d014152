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
    visit(&mut model.clone(), &mut |number, _| numbers.push(number));
    numbers
}

/// The model with another value of the numbers of these indices in [`numbers`]. A value that a shape cannot have changes
/// nothing.
pub(crate) fn with(model: &Model, indices: &[usize], value: f64) -> Model {
    let mut model = model.clone();
    let mut at = 0;
    visit(&mut model, &mut |_, set| {
        if indices.contains(&at) {
            set(value);
        }
        at += 1;
    });
    model
}

/// Goes through the numbers of a model; each can be set.
fn visit(model: &mut Model, take: &mut dyn FnMut(Number, &mut dyn FnMut(f64))) {
    let outputs = model.outputs.iter_mut().map(|output| &mut output.variable);
    for variable in model.inputs.iter_mut().chain(outputs) {
        match variable.partition_peaks() {
            Some(peaks) => partition(variable, peaks, take),
            None => {
                for term in &mut variable.terms {
                    shape(&variable.name, term, take);
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
        take(number, &mut |value| rule.rule.weight = value);
    }
}

fn partition(
    variable: &mut Variable,
    mut peaks: Vec<f64>,
    take: &mut dyn FnMut(Number, &mut dyn FnMut(f64)),
) {
    let names: Vec<String> = variable
        .terms
        .iter()
        .map(|term| term.name.clone())
        .collect();
    for (i, name) in names.iter().enumerate() {
        let number = Number {
            of: format!("{}.{name}", variable.name),
            name: "peak".into(),
            value: peaks[i],
        };
        take(number, &mut |value| peaks[i] = value);
    }
    variable.terms.clear();
    let moved = names.iter().map(String::as_str).zip(peaks);
    *variable = variable.clone().partition_at(moved);
}

fn shape(variable: &str, term: &mut Term, take: &mut dyn FnMut(Number, &mut dyn FnMut(f64))) {
    let of = format!("{variable}.{}", term.name);
    let number = |name: &str, value: f64| Number {
        of: of.clone(),
        name: name.into(),
        value,
    };
    if let MembershipFunction::Linear {
        coefficients,
        constant,
    } = &mut term.membership_function
    {
        for (input, coefficient) in coefficients {
            take(number(input, *coefficient), &mut |value| {
                *coefficient = value
            });
        }
        take(number("constant", *constant), &mut |value| {
            *constant = value
        });
        return;
    }
    let parameters = term.membership_function.parameters();
    let mut values: Vec<f64> = parameters.iter().map(|(.., value)| *value).collect();
    for (i, (name, _, value)) in parameters.iter().enumerate() {
        take(number(name, *value), &mut |value| values[i] = value);
    }
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
    // Through text, so that 0.3 is 0.3 and not 3 times a tenth.
    let written = |steps: f64| format!("{steps:.0}e{exponent}").parse::<f64>();
    let steps = value / 10_f64.powi(exponent);
    let mut rounded: Vec<f64> = [steps.floor(), steps.ceil()]
        .into_iter()
        .filter_map(|steps| written(steps).ok())
        .collect();
    rounded.dedup();
    rounded
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
