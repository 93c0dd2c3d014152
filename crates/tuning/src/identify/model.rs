//! Converts a structure with its consequents to a model.

use fuzzy::{
    Model,
    model::{Conjunction, Defuzzifier, MembershipFunction, Output, Variable},
    rule::{Condition, Rule},
};

use crate::{
    data::{Data, range},
    numbers::decimal,
};

use super::{
    Identification, IdentifyResult,
    fit::{Fit, RIDGE},
    structure::{Axis, Structure},
};

/// The names of the terms of an input with two, three, four and five terms.
const NAMES: [&[&str]; 4] = [
    &["low", "high"],
    &["low", "medium", "high"],
    &["low", "rather_low", "rather_high", "high"],
    &["very_low", "low", "medium", "high", "very_high"],
];

/// The largest number of terms for which there are names.
pub const MAX_TERMS: usize = NAMES.len() + 1;

/// Rounds to a multiple of a power of ten; this power is at most a twentieth of the range.
pub(super) fn round(value: f64, range: f64, how: fn(f64) -> f64) -> f64 {
    let exponent = (range / 20.0).log10().floor() as i32;
    decimal(how(value / 10_f64.powi(exponent)), exponent).unwrap_or(value)
}

/// A variable whose range covers the values of a column.
fn variable(name: &str, column: &[f64]) -> Variable {
    let (low, high) = range(column);
    let [low, high] = [(low, f64::floor as fn(f64) -> f64), (high, f64::ceil)]
        .map(|(value, how)| round(value, high - low, how));
    Variable::new(name, low, high)
}

pub(super) fn model(
    names: &[String],
    output: &str,
    data: &Data,
    settings: &Identification,
    structure: &Structure,
) -> IdentifyResult {
    let kept = kept(data, settings, structure);
    let numbers = Fit {
        structure,
        consequents: settings.consequents,
        kept: &kept,
        ridge: RIDGE,
    }
    .numbers(data);
    let columns = structure.inputs();
    let inputs: Vec<Variable> = (0..columns.len())
        .map(|place| input(names, data, structure, place))
        .collect();
    let input_names: Vec<&str> = inputs.iter().map(|input| input.name.as_str()).collect();
    let mut concluded =
        Output::new(variable(output, &data.truths)).defuzzifier(Defuzzifier::WeightedAverage);
    let (low, high) = range(&data.truths);
    let mut consequents: Vec<(usize, MembershipFunction)> = Vec::new();
    let rules = (0..structure.rules()).filter(|rule| kept[*rule]);
    for rule in rules {
        consequents.push((rule, consequent(&input_names, &numbers[rule], (low, high))));
    }
    // Rules with equal constants share a term; terms are sorted.
    let place = |function: &MembershipFunction| match function {
        MembershipFunction::Constant { value } => *value,
        _ => 0.0,
    };
    let mut terms: Vec<MembershipFunction> = Vec::new();
    let mut sorted: Vec<&(usize, MembershipFunction)> = consequents.iter().collect();
    sorted.sort_by(|a, b| place(&a.1).total_cmp(&place(&b.1)));
    for (_, function) in sorted {
        if !terms.contains(function) {
            terms.push(function.clone());
        }
    }
    let word = match structure {
        Structure::Grid(_) if numbers.first().is_some_and(|numbers| numbers.len() == 1) => "level",
        _ => "line",
    };
    let name_of = |function: &MembershipFunction| {
        let place = terms.iter().position(|term| term == function);
        format!("{word}_{}", place.map_or(0, |place| place + 1))
    };
    for function in &terms {
        concluded.variable = concluded.variable.term(name_of(function), function.clone());
    }
    let mut model = Model::builder(output);
    for input in &inputs {
        model = model.input(input.clone());
    }
    for (rule, function) in &consequents {
        model = model.rule(Rule::new(
            condition(structure, &inputs, *rule),
            output,
            &name_of(function),
        ));
    }
    let mut model = model.output(concluded).build();
    model.operators.and = Conjunction::Product;
    IdentifyResult {
        model,
        columns,
        steps: Vec::new(),
        without_rows: kept.iter().filter(|kept| !**kept).count(),
    }
}

/// Returns for each rule whether it fires more strongly than all others in enough rows.
fn kept(data: &Data, settings: &Identification, structure: &Structure) -> Vec<bool> {
    let mut support = vec![0; structure.rules()];
    let mut strengths = Vec::new();
    for row in 0..data.len() {
        structure.strengths(&|input| data.inputs[input][row], &mut strengths);
        if let Some((rule, _)) = strengths.iter().max_by(|a, b| a.1.total_cmp(&b.1)) {
            support[*rule] += 1;
        }
    }
    support
        .iter()
        .map(|rows| *rows >= settings.least_support)
        .collect()
}

fn input(names: &[String], data: &Data, structure: &Structure, place: usize) -> Variable {
    let input = structure.inputs()[place];
    let variable = variable(&names[input], &data.inputs[input]);
    match structure {
        Structure::Grid(axes) => {
            let Axis { peaks, .. } = &axes[place];
            let names = NAMES[peaks.len() - 2].iter().copied();
            variable.partition_at(names.zip(peaks.iter().copied()))
        }
        Structure::Clusters(clusters) => {
            let width = variable.high - variable.low;
            let deviation = round(clusters.deviations[place], width / 10.0, f64::round);
            let centers = clusters.centers.iter().enumerate();
            centers.fold(variable, |variable, (i, center)| {
                let mean = round(center[place], width / 10.0, f64::round);
                let gaussian = MembershipFunction::Gaussian {
                    mean,
                    sd: deviation,
                };
                variable.term(format!("cluster_{}", i + 1), gaussian)
            })
        }
    }
}

fn condition(structure: &Structure, inputs: &[Variable], rule: usize) -> Condition {
    let terms = match structure {
        Structure::Grid(axes) => Structure::terms(axes, rule),
        Structure::Clusters(_) => vec![rule; inputs.len()],
    };
    let parts = inputs.iter().zip(terms);
    let parts = parts.map(|(input, term)| Condition::is(&input.name, &input.terms[term].name));
    let conjunction = parts.reduce(Condition::and);
    conjunction.unwrap_or_else(|| Condition::And(Vec::new()))
}

/// The consequent of a rule. A constant is rounded, and stays within the range of the truths, because no rows support
/// values outside.
fn consequent(inputs: &[&str], numbers: &[f64], (low, high): (f64, f64)) -> MembershipFunction {
    match numbers.split_last() {
        Some((constant, slopes)) if !slopes.is_empty() => MembershipFunction::Linear {
            coefficients: inputs
                .iter()
                .zip(slopes)
                .map(|(name, slope)| ((*name).to_owned(), *slope))
                .collect(),
            constant: *constant,
        },
        constant => {
            let value = constant.map_or(low, |(constant, _)| constant.clamp(low, high));
            MembershipFunction::Constant {
                value: round(value, (high - low) / 10.0, f64::round),
            }
        }
    }
}
