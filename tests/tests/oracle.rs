//! Random models over all shapes, norms, implications, aggregations and defuzzifiers, held against formulas and integrals that
//! are not the engine's.

use std::process::Command;

use fastrand::Rng;
use flagred_tests::Folder;
use flagred_tests::reference::{integral, rules};
use fuzzy::Engine;
use fuzzy::map::{DecisionMap, Grid};
use fuzzy::model::{
    Aggregation, Conjunction, Defuzzifier, Disjunction, MembershipFunction, Model, Operators,
    Output, Variable,
};
use fuzzy::rule::{Condition, Rule};
use fuzzy::table::{ClosedForm, Outcome, Partial, Scratch, Strongest};
use serde_json::json;

const AND: [Conjunction; 7] = [
    Conjunction::Minimum,
    Conjunction::Product,
    Conjunction::BoundedDifference,
    Conjunction::Drastic,
    Conjunction::Einstein,
    Conjunction::Hamacher,
    Conjunction::NilpotentMinimum,
];

const OR: [Disjunction; 7] = [
    Disjunction::Maximum,
    Disjunction::ProbabilisticSum,
    Disjunction::BoundedSum,
    Disjunction::Drastic,
    Disjunction::Einstein,
    Disjunction::Hamacher,
    Disjunction::NilpotentMaximum,
];

/// The commonest more often.
const IMPLICATION: [Conjunction; 11] = [
    Conjunction::Minimum,
    Conjunction::Minimum,
    Conjunction::Minimum,
    Conjunction::Product,
    Conjunction::Product,
    Conjunction::Product,
    Conjunction::BoundedDifference,
    Conjunction::Drastic,
    Conjunction::Einstein,
    Conjunction::Hamacher,
    Conjunction::NilpotentMinimum,
];

const AGGREGATION: [Aggregation; 10] = [
    Aggregation::Maximum,
    Aggregation::Maximum,
    Aggregation::Maximum,
    Aggregation::Sum,
    Aggregation::ProbabilisticSum,
    Aggregation::BoundedSum,
    Aggregation::Drastic,
    Aggregation::Einstein,
    Aggregation::Hamacher,
    Aggregation::NilpotentMaximum,
];

const DEFUZZIFIER: [Defuzzifier; 7] = [
    Defuzzifier::Centroid,
    Defuzzifier::Bisector,
    Defuzzifier::SmallestOfMaxima,
    Defuzzifier::MeanOfMaxima,
    Defuzzifier::LargestOfMaxima,
    Defuzzifier::WeightedAverage,
    Defuzzifier::WeightedSum,
];

fn between(rng: &mut Rng, low: f64, high: f64) -> f64 {
    low + (high - low) * rng.f64()
}

fn shape(rng: &mut Rng, low: f64, high: f64) -> MembershipFunction {
    let width = high - low;
    let mut places: Vec<f64> = (0..4)
        .map(|_| between(rng, low - 0.2 * width, high + 0.2 * width))
        .collect();
    places.sort_by(f64::total_cmp);
    let [a, b, c, d] = places[..] else {
        unreachable!()
    };
    let inside = between(rng, low, high);
    let spread = width * between(rng, 0.02, 0.4);
    let other = width * between(rng, 0.02, 0.4);
    // Steeper ones are level to the last digit, and maxima hang on rounding.
    let steep = between(rng, 4.0, 25.0) / width * if rng.bool() { 1.0 } else { -1.0 };
    match rng.u8(0..21) {
        0 => MembershipFunction::Triangle {
            left: a,
            peak: b,
            right: c,
        },
        1 => MembershipFunction::Trapezoid {
            left: a,
            left_top: b,
            right_top: c,
            right: d,
        },
        2 => MembershipFunction::LeftShoulder { top: b, foot: c },
        3 => MembershipFunction::RightShoulder { foot: b, top: c },
        4 => MembershipFunction::Rectangle { left: b, right: c },
        5 => MembershipFunction::Piecewise {
            points: vec![
                (a, rng.f64()),
                (b, rng.f64()),
                (b, rng.f64()),
                (d, rng.f64()),
            ],
        },
        6 => MembershipFunction::Gaussian2 {
            left_mean: b,
            left_sd: spread,
            right_mean: c,
            right_sd: other,
        },
        7 => MembershipFunction::Bell {
            center: inside,
            width: spread,
            slope: between(rng, 0.4, 3.0),
        },
        8 => MembershipFunction::Sigmoid {
            inflection: inside,
            slope: steep,
        },
        9 => MembershipFunction::SigmoidDifference {
            left_inflection: b,
            left_slope: steep.abs(),
            right_inflection: c,
            right_slope: between(rng, 4.0, 25.0) / width,
        },
        10 => MembershipFunction::SigmoidProduct {
            left_inflection: b,
            left_slope: steep.abs(),
            right_inflection: c,
            right_slope: -between(rng, 4.0, 25.0) / width,
        },
        11 => MembershipFunction::SShape { foot: b, top: c },
        12 => MembershipFunction::ZShape { top: b, foot: c },
        13 => MembershipFunction::PiShape {
            left: a,
            left_top: b,
            right_top: c,
            right: d,
        },
        14 => MembershipFunction::Cosine {
            center: inside,
            width: 2.0 * spread,
        },
        15 => MembershipFunction::Spike {
            center: inside,
            width: 2.0 * spread,
        },
        16 => MembershipFunction::Concave {
            inflection: b,
            end: if rng.bool() { c } else { a },
        },
        17 => MembershipFunction::Arc {
            start: b,
            end: if rng.bool() { c } else { a },
        },
        18 => MembershipFunction::SemiEllipse { left: b, right: c },
        19 => MembershipFunction::Constant { value: rng.f64() },
        _ => MembershipFunction::Gaussian {
            mean: inside,
            sd: spread,
        },
    }
}

/// A variable of a random range with so many terms.
fn variable(rng: &mut Rng, name: &str, terms: usize) -> Variable {
    let scale = 10f64.powi(rng.i32(-3..4));
    let low = between(rng, -2.0, 2.0) * scale;
    let high = low + between(rng, 0.5, 4.0) * scale;
    let mut variable = Variable::new(name, low, high);
    for i in 0..terms {
        variable = variable.term(format!("t{i}"), shape(rng, low, high));
        if rng.u8(0..4) == 0 {
            variable.terms[i].height = between(rng, 0.3, 1.0);
        }
    }
    variable
}

fn condition(rng: &mut Rng, inputs: &[Variable]) -> Condition {
    let mut parts = inputs.iter().map(|input| {
        let term = format!("t{}", rng.usize(0..input.terms.len()));
        let condition = Condition::is(&input.name, &term);
        if rng.u8(0..6) == 0 {
            Condition::Not(Box::new(condition))
        } else {
            condition
        }
    });
    let first = parts.next().unwrap();
    let rest: Vec<Condition> = parts.collect();
    rest.into_iter().fold(first, |all, one| match rng.u8(0..4) {
        0 => all.or(one),
        1 => all,
        _ => all.and(one),
    })
}

/// The model of a seed; `None` where the terms that it draws are refused.
fn model(seed: u64) -> Option<Model> {
    let rng = &mut Rng::with_seed(seed);
    let inputs: Vec<Variable> = (0..rng.usize(1..4))
        .map(|i| {
            let terms = rng.usize(1..5);
            variable(rng, ["x", "y", "z"][i], terms)
        })
        .collect();
    let terms = rng.usize(1..7);
    let mut output = Output::new(variable(rng, "out", terms));
    output.defuzzifier = DEFUZZIFIER[rng.usize(0..DEFUZZIFIER.len())];
    if let Defuzzifier::WeightedAverage | Defuzzifier::WeightedSum = output.defuzzifier {
        for term in &mut output.variable.terms {
            let value = between(rng, -5.0, 5.0);
            let coefficient = between(rng, -1.0, 1.0);
            term.height = 1.0;
            term.membership_function = if rng.bool() {
                MembershipFunction::Constant { value }
            } else {
                MembershipFunction::Linear {
                    coefficients: vec![("x".into(), coefficient)],
                    constant: value,
                }
            };
        }
    }
    let mut builder = Model::builder("random").output(output);
    for input in &inputs {
        builder = builder.input(input.clone());
    }
    for _ in 0..rng.usize(1..9) {
        let condition = condition(rng, &inputs);
        let term = format!("t{}", rng.usize(0..terms));
        let weight = if rng.bool() { 1.0 } else { rng.f64() };
        builder = builder.rule(Rule::new(condition, "out", &term).with(weight));
    }
    let mut model = builder.build();
    model.operators = Operators {
        and: AND[rng.usize(0..AND.len())],
        or: OR[rng.usize(0..OR.len())],
        implication: IMPLICATION[rng.usize(0..IMPLICATION.len())],
        aggregation: AGGREGATION[rng.usize(0..AGGREGATION.len())],
    };
    fuzzy::validate(&model, &fuzzy::format::Spans::default())
        .is_empty()
        .then_some(model)
}

fn point(rng: &mut Rng, model: &Model) -> Vec<f64> {
    let inputs = model.inputs.iter();
    inputs.map(|v| between(rng, v.low, v.high)).collect()
}

/// What was compared.
#[derive(Debug, Default)]
struct Tally {
    models: usize,
    values: usize,
    ill_conditioned: usize,
    /// Models with maxima whose exported arrays were compared.
    exported_maxima: usize,
    worst: f64,
    wrong: Vec<String>,
}

/// So many models with three points each, from a seed on.
fn models(first: u64, count: usize) -> impl Iterator<Item = (u64, Model, Vec<Vec<f64>>)> {
    let models = (first..).filter_map(|seed| Some((seed, model(seed)?)));
    models.take(count).map(|(seed, model)| {
        let rng = &mut Rng::with_seed(seed);
        let points = (0..3).map(|_| point(rng, &model)).collect();
        (seed, model, points)
    })
}

/// The same model with slightly smaller weights.
fn with_rounding(model: &Model) -> Model {
    let mut model = model.clone();
    for rule in &mut model.rules {
        rule.rule.weight *= 1.0 - 1e-15;
    }
    model
}

/// Compares so many models from a seed on.
fn compare(first: u64, count: usize) -> Tally {
    let mut tally = Tally::default();
    for (seed, model, points) in models(first, count) {
        tally.models += 1;
        let engine = Engine::new(&model).unwrap();
        let output = &model.outputs[0];
        let mut range = output.variable.high - output.variable.low;
        if let Defuzzifier::WeightedSum | Defuzzifier::WeightedAverage = output.defuzzifier {
            range = 1.0;
        }
        for point in &points {
            let value = engine.evaluate(point).unwrap()[0].value();
            let exact = |model: &Model| rules::evaluate_with(model, point, &integral::defuzzify)[0];
            let error = |value: Option<f64>, exact: Option<f64>| match (value, exact) {
                (Some(value), Some(exact)) => (value - exact).abs() / range,
                (None, None) => 0.0,
                _ => f64::INFINITY,
            };
            let is_right = |error: f64| error <= 1e-9;
            let expected = exact(&model);
            let found = error(value, expected);
            if is_right(found) {
                tally.values += 1;
                tally.worst = tally.worst.max(found);
            } else if is_right(error(expected, exact(&with_rounding(&model)))) {
                tally.wrong.push(format!(
                    "seed {seed} at {point:?}: {value:?}, not {expected:?} ({found:e} of the range), {:?} {:?}",
                    output.defuzzifier, model.operators
                ));
            } else {
                // Hangs on the last digit of the firing strengths.
                tally.ill_conditioned += 1;
            }
        }
        let is_exported = same_bits(&model, &engine, &points);
        let has_maxima = matches!(
            output.defuzzifier,
            Defuzzifier::SmallestOfMaxima
                | Defuzzifier::MeanOfMaxima
                | Defuzzifier::LargestOfMaxima
        );
        tally.exported_maxima += usize::from(is_exported && has_maxima);
    }
    tally
}

/// The value by the arrays that exports and the C library evaluate; `None` of an output that has no closed form there.
fn by_table(engine: &Engine, point: &[f64]) -> Option<Outcome> {
    let table = engine.table()?;
    if table.outputs[0].form == ClosedForm::NONE {
        return None;
    }
    let sizes = table.sizes;
    let numbers = |count: u32| vec![0.0; count as usize];
    let partials = |count: u32| vec![Partial::NONE; count as usize];
    let mut scratch = Scratch {
        values: &mut vec![0.0; point.len()],
        degrees: &mut numbers(sizes.degrees),
        alive: &mut partials(sizes.alive),
        partial: &mut partials(sizes.partial),
        next: &mut partials(sizes.partial),
        stack: &mut numbers(sizes.stack),
        strengths: &mut numbers(sizes.strengths),
        strongest: &mut [Strongest::NONE],
    };
    let mut outcomes = [Outcome::UNDEFINED];
    table.evaluate(&mut scratch, point, &mut outcomes);
    Some(outcomes[0])
}

/// Batches, explanations, exported arrays and maps give the bits of single calls. Returns whether there are exported arrays.
fn same_bits(model: &Model, engine: &Engine, points: &[Vec<f64>]) -> bool {
    let bits = |value: Option<f64>| value.map(f64::to_bits);
    let columns: Vec<Vec<f64>> = (0..model.inputs.len())
        .map(|input| points.iter().map(|point| point[input]).collect())
        .collect();
    let columns: Vec<&[f64]> = columns.iter().map(|column| &**column).collect();
    let batch = engine.evaluate_batch(&columns).unwrap();
    for (point, outcome) in points.iter().zip(batch) {
        let single = engine.evaluate(point).unwrap()[0];
        assert_eq!(bits(outcome.value()), bits(single.value()), "{point:?}");
        let explained = engine.explain(point).unwrap();
        assert_eq!(bits(explained.outputs[0].value), bits(single.value()));
        if let Some(exported) = by_table(engine, point) {
            assert_eq!(exported, single, "{point:?}");
        }
    }
    let mut grid = Grid::new(engine, 3).unwrap();
    for (name, x) in engine.input_names().zip(&points[0]).skip(1) {
        grid = grid.fix(name, *x).unwrap();
    }
    let map = DecisionMap::new(engine, grid, 0).unwrap();
    for cell in 0..map.grid().cells() {
        let mut point = points[0].clone();
        point[0] = map.grid().point(cell)[0];
        let single = engine.evaluate(&point).unwrap()[0];
        assert_eq!(bits(map.value(cell)), bits(single.value()), "{point:?}");
    }
    by_table(engine, &points[0]).is_some()
}

fn assert_right(tally: &Tally) {
    println!(
        "{} models, {} values, {} ill-conditioned, worst {:e} of the range",
        tally.models, tally.values, tally.ill_conditioned, tally.worst
    );
    assert!(
        tally.wrong.is_empty(),
        "{} wrong:\n{}",
        tally.wrong.len(),
        tally.wrong.join("\n")
    );
    assert!(30 * tally.exported_maxima > tally.models, "{tally:?}");
    // Nearly all must have been compared.
    assert!(500 * tally.ill_conditioned <= tally.values, "{tally:?}");
}

#[test]
fn two_thousand_models() {
    assert_right(&compare(1_000_000, 2000));
}

/// Fails today: in 55 of 59,945 values one of the two is wrong (docs/validation.md, The engine).
#[test]
#[ignore = "minutes, and some values differ"]
fn twenty_thousand_models() {
    assert_right(&compare(2_000_000, 20_000));
}

const PEER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/peer/mpmath_peer.py");

/// `FLAGRED_PYTHON` names a Python that has mpmath.
#[test]
#[ignore = "needs Python with mpmath: tests/peer/mpmath.sh"]
fn mpmath_computes_the_values_of_two_hundred_models() {
    let lines = models(1_000_000, 200).map(|(seed, model, points)| {
        let engine = Engine::new(&model).unwrap();
        let value = |point: &Vec<f64>| engine.evaluate(point).unwrap()[0].value();
        let values: Vec<Option<f64>> = points.iter().map(value).collect();
        let case = json!({"seed": seed, "model": model, "points": points, "values": values});
        case.to_string() + "\n"
    });
    let folder = Folder::new();
    folder.file("models.jsonl", lines.collect::<String>());
    let python = std::env::var("FLAGRED_PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let output = Command::new(python)
        .arg(PEER)
        .arg(folder.path().join("models.jsonl"))
        .output()
        .unwrap();
    let told = String::from_utf8(output.stdout).unwrap();
    let errors = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success(), "{told}{errors}");
    assert!(told.contains("600 values, 0 wrong"), "{told}");
}
