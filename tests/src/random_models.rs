//! Random models over all shapes, norms, implications, aggregations and defuzzifiers.

use fastrand::Rng;
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

/// Implications; the most common ones are repeated.
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
    // Steeper sigmoids are flat to the last digit, so their maxima would depend on rounding.
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

/// Returns a variable with random terms. The height of about every fourth term is below 1.
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

/// The model of a seed; `None` if its random terms are rejected.
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
    let Variable { low, high, .. } = output.variable;
    for term in &mut output.variable.terms {
        if let MembershipFunction::Constant { value } = term.membership_function {
            // A fuzzy output cannot have constants; this rectangle is the same set.
            term.height *= value;
            term.membership_function = MembershipFunction::Rectangle {
                left: low,
                right: high,
            };
        }
    }
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

/// Returns `count` models, each with its seed and three points. The seeds ascend from `first`; those without a valid
/// model are skipped.
pub fn models(first: u64, count: usize) -> impl Iterator<Item = (u64, Model, Vec<Vec<f64>>)> {
    let models = (first..).filter_map(|seed| Some((seed, model(seed)?)));
    models.take(count).map(|(seed, model)| {
        let rng = &mut Rng::with_seed(seed);
        let points = (0..3).map(|_| point(rng, &model)).collect();
        (seed, model, points)
    })
}
