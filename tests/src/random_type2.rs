//! Random interval type-2 rule sets without steps, so that sums over samples approach their integrals quickly.

use fastrand::Rng;
use fuzzy::model::{
    Aggregation, Conjunction, Defuzzifier, Disjunction, LowerFunction, MembershipFunction, Model,
    Operators, Output, Term, Variable,
};
use fuzzy::rule::{Condition, Hedge, Rule};

const AND: [Conjunction; 5] = [
    Conjunction::Minimum,
    Conjunction::Product,
    Conjunction::BoundedDifference,
    Conjunction::Einstein,
    Conjunction::Hamacher,
];
const OR: [Disjunction; 5] = [
    Disjunction::Maximum,
    Disjunction::ProbabilisticSum,
    Disjunction::BoundedSum,
    Disjunction::Einstein,
    Disjunction::Hamacher,
];
const AGGREGATION: [Aggregation; 6] = [
    Aggregation::Maximum,
    Aggregation::Maximum,
    Aggregation::Maximum,
    Aggregation::Sum,
    Aggregation::ProbabilisticSum,
    Aggregation::BoundedSum,
];
const HEDGES: [Hedge; 5] = [
    Hedge::Not,
    Hedge::Very,
    Hedge::Somewhat,
    Hedge::Extremely,
    Hedge::Seldom,
];

/// The kinds of terms of the outputs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[expect(missing_docs, reason = "named by its variants")]
pub enum OutputTermKind {
    Straight,
    Curved,
    Numbers,
}

fn between(rng: &mut Rng, low: f64, high: f64) -> f64 {
    low + (high - low) * rng.f64()
}

fn pick<T: Copy>(rng: &mut Rng, all: &[T]) -> T {
    all[rng.usize(0..all.len())]
}

/// An upper membership function, and a lower one of height 1 that is nowhere above it.
fn functions(
    rng: &mut Rng,
    low: f64,
    high: f64,
    curved: bool,
) -> (MembershipFunction, MembershipFunction) {
    use MembershipFunction::{
        Gaussian, LeftShoulder, Piecewise, RightShoulder, SShape, Sigmoid, Trapezoid, Triangle,
    };
    let width = high - low;
    let left = between(rng, low - 0.2 * width, high - 0.3 * width);
    let steps = [0.0; 3].map(|_| between(rng, 0.05, 0.35) * width);
    let (b, c, d) = (
        left + steps[0],
        left + steps[0] + steps[1],
        left + steps.iter().sum::<f64>(),
    );
    let mut inside = |from: f64, to: f64| between(rng, from, to);
    let mean = inside(low, high);
    let shift = inside(0.0, 0.5);
    match (curved, rng.u8(0..5)) {
        (false, 0) => (
            Triangle {
                left,
                peak: b,
                right: c,
            },
            Triangle {
                left: left + shift * (b - left),
                peak: b,
                right: c - shift * (c - b),
            },
        ),
        (false, 1) => (
            Trapezoid {
                left,
                left_top: b,
                right_top: c,
                right: d,
            },
            Trapezoid {
                left: left + shift * (b - left),
                left_top: b + shift * (c - b),
                right_top: c,
                right: d - shift * (d - c),
            },
        ),
        (false, 2) => (
            LeftShoulder { top: b, foot: c },
            LeftShoulder {
                top: b - shift * width,
                foot: c - shift * (c - b),
            },
        ),
        (false, 3) => (
            RightShoulder { foot: b, top: c },
            RightShoulder {
                foot: b + shift * (c - b),
                top: c + shift * width,
            },
        ),
        (false, _) => {
            let degrees = [0.0; 4].map(|_| rng.f64());
            let points = |factor: f64| {
                let points = [left, b, c, d].into_iter().zip(degrees);
                points.map(|(x, y)| (x, factor * y)).collect()
            };
            (
                Piecewise {
                    points: points(1.0),
                },
                Piecewise {
                    points: points(1.0 - shift),
                },
            )
        }
        (true, 0) => (
            SShape { foot: left, top: c },
            SShape {
                foot: left + shift * width,
                top: c + shift * width,
            },
        ),
        (true, 1) => {
            let slope = 12.0 / width;
            (
                Sigmoid {
                    inflection: mean,
                    slope,
                },
                Sigmoid {
                    inflection: mean + shift * width,
                    slope,
                },
            )
        }
        (true, _) => (
            Gaussian { mean, sd: steps[0] },
            Gaussian {
                mean,
                sd: steps[0] * (1.0 - shift),
            },
        ),
    }
}

fn variable(rng: &mut Rng, name: &str, terms: usize, curved: bool) -> Variable {
    let scale = 10f64.powi(rng.i32(-3..4));
    let low = between(rng, -2.0, 2.0) * scale;
    let high = low + between(rng, 0.5, 4.0) * scale;
    let mut variable = Variable::new(name, low, high);
    for i in 0..terms {
        let is_curved = curved && rng.bool();
        let (upper, lower) = functions(rng, low, high, is_curved);
        let height = if rng.bool() {
            1.0
        } else {
            between(rng, 0.5, 1.0)
        };
        let lower = LowerFunction {
            membership_function: lower,
            height: height * between(rng, 0.3, 1.0),
        };
        variable.terms.push(Term {
            name: format!("t{i}"),
            membership_function: upper,
            height,
            lower: (rng.u8(0..5) > 0).then_some(lower),
        });
    }
    variable
}

fn condition(rng: &mut Rng, inputs: &[Variable]) -> Condition {
    let mut parts = inputs.iter().map(|input| {
        let term = format!("t{}", rng.usize(0..input.terms.len()));
        let hedges: Vec<Hedge> = (0..rng.usize(0..3).saturating_sub(1))
            .map(|_| pick(rng, &HEDGES))
            .collect();
        let condition = Condition::is_hedged(&input.name, &hedges, &term);
        match rng.u8(0..5) {
            0 => condition.negated(),
            _ => condition,
        }
    });
    let first = parts.next().unwrap();
    let rest: Vec<Condition> = parts.collect();
    let joined = rest.into_iter().fold(first, |all, one| match rng.u8(0..3) {
        0 => all.or(one),
        _ => all.and(one),
    });
    match rng.u8(0..6) {
        0 => joined.negated(),
        _ => joined,
    }
}

/// Returns the random model of a seed with three points; `None` if the model is not valid.
pub fn model(seed: u64, kind: OutputTermKind) -> Option<(Model, Vec<Vec<f64>>)> {
    let rng = &mut Rng::with_seed(seed);
    let curved = kind == OutputTermKind::Curved;
    let inputs: Vec<Variable> = (0..rng.usize(1..3))
        .map(|i| {
            let is_curved = rng.bool();
            variable(rng, ["x", "y"][i], 3, is_curved)
        })
        .collect();
    let terms = rng.usize(1..4);
    let mut output = Output::new(variable(rng, "out", terms, curved));
    if kind == OutputTermKind::Numbers {
        output.defuzzifier = match rng.u8(0..3) {
            0 => Defuzzifier::WeightedSum,
            _ => Defuzzifier::WeightedAverage,
        };
        for term in &mut output.variable.terms {
            (term.height, term.lower) = (1.0, None);
            let constant = between(rng, -5.0, 5.0);
            term.membership_function = match rng.bool() {
                true => MembershipFunction::Constant { value: constant },
                false => MembershipFunction::Linear {
                    coefficients: vec![("x".into(), between(rng, -1.0, 1.0))],
                    constant,
                },
            };
        }
    }
    let mut builder = Model::builder("random").output(output);
    for input in &inputs {
        builder = builder.input(input.clone());
    }
    for _ in 0..rng.usize(1..7) {
        let condition = condition(rng, &inputs);
        let term = format!("t{}", rng.usize(0..terms));
        let weight = if rng.bool() { 1.0 } else { rng.f64() };
        let rule = match rng.u8(0..5) {
            0 => Rule {
                consequents: vec![fuzzy::rule::Consequent::is_hedged(
                    "out",
                    &[Hedge::Very],
                    &term,
                )],
                ..Rule::new(condition, "out", &term)
            },
            _ => Rule::new(condition, "out", &term),
        };
        builder = builder.rule(rule.with(weight));
    }
    let mut model = builder.build();
    model.operators = Operators {
        and: pick(rng, &AND),
        or: pick(rng, &OR),
        implication: pick(rng, &AND),
        aggregation: pick(rng, &AGGREGATION),
    };
    if kind == OutputTermKind::Straight {
        model.operators.implication = pick(rng, &AND[..2]);
        model.operators.aggregation = Aggregation::Maximum;
    }
    let points = (0..3).map(|_| inputs.iter().map(|v| between(rng, v.low, v.high)).collect());
    let points = points.collect();
    let is_valid = fuzzy::validate(&model, &fuzzy::format::Spans::default()).is_empty();
    is_valid.then_some((model, points))
}
