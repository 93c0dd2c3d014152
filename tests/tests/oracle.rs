//! Random models over all shapes, norms, implications, aggregations and defuzzifiers, held against formulas and integrals that
//! are not the engine's.

use fastrand::Rng;
use flagred_tests::reference::{integral, rules};
use fuzzy::Engine;
use fuzzy::map::{DecisionMap, Grid};
use fuzzy::model::{
    Aggregation, Conjunction, Defuzzifier, Disjunction, MembershipFunction, Model, Operators,
    Output, Variable,
};
use fuzzy::rule::{Condition, Rule};

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

/// The commonest twice. A drastic implication leaves sets without area, and there is no more to integrate.
const IMPLICATION: [Conjunction; 8] = [
    Conjunction::Minimum,
    Conjunction::Minimum,
    Conjunction::Product,
    Conjunction::Product,
    Conjunction::BoundedDifference,
    Conjunction::Einstein,
    Conjunction::Hamacher,
    Conjunction::NilpotentMinimum,
];

const AGGREGATION: [Aggregation; 9] = [
    Aggregation::Maximum,
    Aggregation::Maximum,
    Aggregation::Maximum,
    Aggregation::Sum,
    Aggregation::ProbabilisticSum,
    Aggregation::BoundedSum,
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
    match rng.u8(0..18) {
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

/// A model of a seed, with maxima under all implications or those that are right today; `None` where the terms that it draws are refused.
fn model(seed: u64, all_maxima: bool) -> Option<Model> {
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
    let implication = &mut model.operators.implication;
    let is_common = matches!(*implication, Conjunction::Minimum | Conjunction::Product);
    let maxima = [
        Defuzzifier::SmallestOfMaxima,
        Defuzzifier::MeanOfMaxima,
        Defuzzifier::LargestOfMaxima,
    ];
    if !all_maxima && !is_common && maxima.contains(&model.outputs[0].defuzzifier) {
        *implication = Conjunction::Minimum;
    }
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
    worst: f64,
    wrong: Vec<String>,
}

/// Compares so many models, at three points each. `first` is the first seed.
fn compare(first: u64, models: usize, all_maxima: bool) -> Tally {
    let mut tally = Tally::default();
    let mut seed = first;
    while tally.models < models {
        seed += 1;
        let Some(model) = model(seed, all_maxima) else {
            continue;
        };
        tally.models += 1;
        let engine = Engine::new(&model).unwrap();
        let rng = &mut Rng::with_seed(seed);
        let points: Vec<Vec<f64>> = (0..3).map(|_| point(rng, &model)).collect();
        let output = &model.outputs[0];
        let mut range = output.variable.high - output.variable.low;
        if let Defuzzifier::WeightedSum | Defuzzifier::WeightedAverage = output.defuzzifier {
            range = 1.0;
        }
        for point in &points {
            let value = engine.evaluate(point).unwrap()[0].value();
            let exact = rules::evaluate_with(&model, point, &integral::defuzzify)[0];
            match (value, exact) {
                (_, Some(exact)) if exact.is_nan() => tally.ill_conditioned += 1,
                (Some(value), Some(exact)) => {
                    tally.values += 1;
                    let error = (value - exact).abs() / range;
                    tally.worst = tally.worst.max(error);
                    // Written so that no number is wrong, too.
                    if error.is_nan() || error > 1e-9 {
                        tally.wrong.push(format!(
                            "seed {seed} at {point:?}: {value}, not {exact} ({error:e} of the range), {:?} {:?}",
                            output.defuzzifier, model.operators
                        ));
                    }
                }
                (None, None) => tally.values += 1,
                (value, exact) => tally.wrong.push(format!(
                    "seed {seed} at {point:?}: {value:?}, not {exact:?}, {:?} {:?}",
                    output.defuzzifier, model.operators
                )),
            }
        }
        same_bits(&model, &engine, &points);
    }
    tally
}

/// Batches and maps give the bits of single calls.
fn same_bits(model: &Model, engine: &Engine, points: &[Vec<f64>]) {
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
    // Most must have been compared.
    assert!(20 * tally.ill_conditioned < tally.values, "{tally:?}");
}

#[test]
fn some_models() {
    assert_right(&compare(0, 60, false));
}

/// `cargo test --release -p flagred-tests --test oracle -- --ignored --nocapture`
#[test]
#[ignore = "minutes"]
fn two_thousand_models() {
    assert_right(&compare(1_000_000, 2000, false));
}

/// Fails today: some 90 of 6,000 values, nearly all under the nilpotent minimum.
#[test]
#[ignore = "maxima under other implications than minimum and product are not exact yet"]
fn maxima_under_all_implications() {
    assert_right(&compare(1_000_000, 2000, true));
}
