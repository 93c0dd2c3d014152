//! Evaluation does not allocate: an allocator that counts says so.

use fuzzy::Engine;
use fuzzy::engine::Outcome;
use fuzzy::model::{Aggregation, Conjunction, Defuzzifier, Implication, Model};

/// The rule sets of the conformance corpus: every shape, hedge, operator and kind of output.
fn models() -> Vec<Model> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/conformance");
    let mut models = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let text = std::fs::read_to_string(entry.unwrap().path()).unwrap();
        let (rule_set, _) = text.split_once("\n---\n").unwrap();
        models.push(fuzzy::yaml::parse(rule_set).unwrap().model);
    }
    assert!(!models.is_empty());
    models
}

/// Evaluates points along the diagonal of the inputs' ranges and beyond.
fn assert_no_allocation(model: &Model) {
    let engine = Engine::new(model).unwrap();
    // A clone has as much room as the scratch it is of.
    let mut scratch = engine.scratch().clone();
    let mut outcomes = vec![Outcome::default(); model.outputs.len()];
    let mut point = vec![0.0; model.inputs.len()];
    for part in [-0.1, 0.0, 0.17, 0.5, 0.75, 0.83, 1.0] {
        for (x, variable) in point.iter_mut().zip(&model.inputs) {
            *x = variable.low + (variable.high - variable.low) * part;
        }
        let counted = allocation_counter::measure(|| {
            engine
                .evaluate_with(&mut scratch, &point, &mut outcomes)
                .unwrap();
        });
        assert_eq!(counted.count_total, 0, "{} at {point:?}", model.name);
    }
}

#[test]
fn the_counter_counts() {
    let counted = allocation_counter::measure(|| drop(std::hint::black_box(vec![0u8; 10])));
    assert_eq!(counted.count_total, 1);
}

#[test]
fn no_evaluation_allocates() {
    for mut model in models() {
        for (and, implication, aggregation) in [
            (
                Conjunction::Minimum,
                Implication::Minimum,
                Aggregation::Maximum,
            ),
            (
                Conjunction::Product,
                Implication::Product,
                Aggregation::Maximum,
            ),
            (
                Conjunction::Hamacher,
                Implication::Minimum,
                Aggregation::ProbabilisticSum,
            ),
            (
                Conjunction::Einstein,
                Implication::Product,
                Aggregation::BoundedSum,
            ),
            (Conjunction::Minimum, Implication::Minimum, Aggregation::Sum),
            (Conjunction::Minimum, Implication::Product, Aggregation::Sum),
        ] {
            model.operators.and = and;
            model.operators.implication = implication;
            model.operators.aggregation = aggregation;
            assert_no_allocation(&model);
        }
        let weighted = |defuzzifier: Defuzzifier| {
            matches!(
                defuzzifier,
                Defuzzifier::WeightedAverage | Defuzzifier::WeightedSum
            )
        };
        for defuzzifier in [Defuzzifier::Bisector, Defuzzifier::MeanOfMaxima] {
            for output in &mut model.outputs {
                if !weighted(output.defuzzifier) {
                    output.defuzzifier = defuzzifier;
                }
            }
            assert_no_allocation(&model);
        }
    }
}
