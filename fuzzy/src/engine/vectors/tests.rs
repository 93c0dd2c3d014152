//! The vector code and the table code give bitwise equal results.

use alloc::format;
use alloc::vec::Vec;

use proptest::prelude::*;

use crate::engine::strategy::SingleRowMethod;
use crate::engine::{Engine, Outcome};
use crate::model::{Aggregation, Conjunction, Defuzzifier, Implication, MembershipFunction};
use crate::model::{Model, Output, Variable};
use crate::rule::{Condition, Rule};
use crate::table::{PartialConjunction, Scratch, StrongestRule};

const TERMS: [&str; 4] = ["a", "b", "c", "d"];

/// Returns a model whose inputs have four terms each, with a rule for each combination. Weights repeat and are sometimes
/// 0; `seed` selects the conclusions.
fn model(inputs: usize, kind: usize, multiplies: bool, weights: &[u8], seed: usize) -> Model {
    let mut power = Variable::new("y", -3.0, 7.0);
    if kind == 3 {
        for (i, term) in (0u8..).zip(TERMS) {
            let slope = f64::from(i) - 1.3;
            let coefficients = Vec::from([("x0".into(), slope), ("x1".into(), 0.7 * slope)]);
            let constant = 0.1 * slope;
            let linear = MembershipFunction::Linear {
                coefficients,
                constant,
            };
            power = power.term(term, linear);
        }
    } else {
        power = power.partition(TERMS);
    }
    let output = Output::new(power);
    let mut model = Model::builder("vectors")
        .output(match kind {
            3 => output.defuzzifier(Defuzzifier::WeightedAverage),
            _ => output,
        })
        .build();
    for input in 0..inputs {
        let variable = Variable::new(format!("x{input}"), 0.0, 1.0).partition(TERMS);
        model.inputs.push(variable);
    }
    for number in 0..4usize.pow(inputs as u32) {
        let term = |input: usize| TERMS[number / 4usize.pow(input as u32) % 4];
        let is = |input: usize| Condition::is(&format!("x{input}"), term(input));
        let condition = (0..inputs).map(is).reduce(Condition::and).unwrap();
        let weight = f64::from(weights[number % weights.len()]) / 4.0;
        let conclusion = TERMS[(number * 7 + seed) % 11 % 4];
        let rule = Rule::new(condition, "y", conclusion).with(weight);
        model.rules.push(rule.into());
    }
    if multiplies {
        model.operators.and = Conjunction::Product;
    }
    if kind == 1 || kind == 2 {
        model.operators.implication = Implication::Product;
    }
    if kind == 2 {
        model.operators.aggregation = Aggregation::Sum;
    }
    model
}

proptest! {
    #[test]
    fn vectors_have_the_bits_of_the_table(
        inputs in 2..=4usize,
        kind in 0..4usize,
        multiplies in any::<bool>(),
        weights in prop::collection::vec(0..=4u8, 1..7),
        seed in 0..11usize,
        points in prop::collection::vec(prop::collection::vec(prop_oneof![
            -0.1..=1.1,
            prop::sample::select(Vec::from([0.0, 1.0 / 3.0, 0.5, 2.0 / 3.0, 1.0, f64::NAN, f64::INFINITY])),
        ], 4), 20),
    ) {
        let engine = Engine::new(&model(inputs, kind, multiplies, &weights, seed)).unwrap();
        let by_vectors = &engine.first.single;
        let expected = match inputs {
            2 => matches!(by_vectors, SingleRowMethod::Plane(_)),
            _ if kind == 2 || kind == 3 => matches!(by_vectors, SingleRowMethod::Cells | SingleRowMethod::Rules),
            _ => matches!(by_vectors, SingleRowMethod::Vectors(_)),
        };
        prop_assert!(expected, "{inputs} inputs, kind {kind}");
        let (table, mut own) = (engine.table().unwrap(), engine.scratch());
        let sizes = table.sizes;
        let mut scratch = Scratch {
            values: &mut [0.0; 4],
            degrees: &mut alloc::vec![0.0; sizes.degrees as usize],
            alive: &mut alloc::vec![PartialConjunction::NONE; sizes.alive as usize],
            partial: &mut alloc::vec![PartialConjunction::NONE; sizes.partial as usize],
            next: &mut alloc::vec![PartialConjunction::NONE; sizes.partial as usize],
            stack: &mut alloc::vec![0.0; sizes.stack as usize],
            strengths: &mut alloc::vec![0.0; sizes.strengths as usize],
            strongest: &mut [StrongestRule::NONE],
        };
        for point in &points {
            let point = &point[..inputs];
            let (mut fast, mut slow) = ([Outcome::default()], [Outcome::default()]);
            engine.evaluate_with(&mut own, point, &mut fast).unwrap();
            table.evaluate(&mut scratch, point, &mut slow);
            prop_assert_eq!(fast, slow, "{:?}", point);
        }
    }
}
