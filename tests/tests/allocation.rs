//! Verifies that evaluation does not allocate, with an allocator that counts allocations.

use flagred_tests::random_type2::{OutputTermKind, model};
use fuzzy::Engine;
use fuzzy::engine::Outcome;
use fuzzy::model::{Aggregation, Conjunction, Defuzzifier, Implication, MembershipFunction, Model};

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

/// Asserts that evaluations do not allocate, at points on the diagonal of the input ranges and one outside.
fn assert_no_allocation(model: &Model) {
    let engine = Engine::new(model).unwrap();
    // A clone has the same capacity as the original scratch.
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
fn the_allocation_counter_counts() {
    let counted = allocation_counter::measure(|| drop(std::hint::black_box(vec![0u8; 10])));
    assert_eq!(counted.count_total, 1);
}

#[test]
fn no_interval_of_type2_terms_allocates() {
    for kind in [
        OutputTermKind::Straight,
        OutputTermKind::Curved,
        OutputTermKind::Numbers,
    ] {
        let models = (0..100).filter_map(|seed| model(seed, kind));
        assert!(
            models
                .inspect(|(model, _)| assert_no_allocation(model))
                .count()
                > 50
        );
    }
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
        // Weighted numbers have no maxima, and singletons have no area to bisect.
        let is_set = |output: &fuzzy::model::Output| {
            let is_singleton = |term: &fuzzy::model::Term| {
                matches!(
                    term.membership_function,
                    MembershipFunction::Singleton { .. }
                )
            };
            let weighted = matches!(
                output.defuzzifier,
                Defuzzifier::WeightedAverage | Defuzzifier::WeightedSum | Defuzzifier::Tsukamoto
            );
            !weighted && !output.variable.terms.iter().any(is_singleton)
        };
        for defuzzifier in [Defuzzifier::Bisector, Defuzzifier::MeanOfMaxima] {
            for output in &mut model.outputs {
                if is_set(output) {
                    output.defuzzifier = defuzzifier;
                }
            }
            assert_no_allocation(&model);
        }
    }
}

/// 5000 rules with 200 ANDs each have a million edges in their trie, but few nodes are queued at once.
#[test]
fn many_long_rules_need_little_memory() {
    use fuzzy::model::{Output, Variable};
    use fuzzy::rule::{Condition, Rule};

    const TERMS: [&str; 5] = ["a", "b", "c", "d", "e"];
    let names: Vec<String> = (0..200).map(|i| format!("x{i}")).collect();
    let mut builder =
        Model::builder("many").output(Output::new(Variable::new("y", 0.0, 1.0).partition(TERMS)));
    for name in &names {
        builder = builder.input(Variable::new(name, 0.0, 1.0).partition(TERMS));
    }
    let mut random = 1u64;
    for _ in 0..5000 {
        let mut term = || {
            random = random.wrapping_mul(6364136223846793005).wrapping_add(1);
            TERMS[(random >> 33) as usize % TERMS.len()]
        };
        let all = names.iter().map(|name| Condition::is(name, term()));
        let condition = Condition::And(all.collect());
        builder = builder.rule(Rule::new(condition, "y", term()));
    }
    let engine = Engine::new(&builder.build()).unwrap();
    let mut scratch = None;
    let counted = allocation_counter::measure(|| scratch = Some(engine.scratch()));
    assert!(counted.bytes_max < 64 << 10, "{} bytes", counted.bytes_max);
    let mut outcomes = [Outcome::default()];
    let counted = allocation_counter::measure(|| {
        let point = vec![0.5; names.len()];
        engine
            .evaluate_with(scratch.as_mut().unwrap(), &point, &mut outcomes)
            .unwrap();
    });
    assert_eq!(counted.count_total, 1, "the point itself");
}
