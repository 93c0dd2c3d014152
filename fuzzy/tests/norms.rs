//! Tests of every implication with every aggregation: comparisons with sums over many samples, using independent
//! definitions of the norms, and with integrals computed by hand.
#![allow(
    clippy::panic,
    clippy::unwrap_used,
    reason = "helpers of tests fail by panics"
)]

use fuzzy::Engine;
use fuzzy::model::{Aggregation, Defuzzifier, Implication, Model};

const STRAIGHT: &str = "a: {triangle: [0, 2, 7]}, b: {trapezoid: [3, 5, 6, 9]}, c: {piecewise: [[5, 0], [8, 0.9], [10, 0.4]]}";
const CURVED: &str = "a: {gaussian: {mean: 2, sd: 1.1}}, b: {bell: {center: 5, width: 1.5, slope: 2}}, c: {s_shape: [4, 9]}";

fn model(terms: &str) -> Model {
    let text = format!(
        "fuzzy: 1\nname: t\ninputs: {{x: {{range: [0, 1], partition: [low, middle, high]}}}}\noutputs: {{y: {{range: [0, 10], terms: {{{terms}}}}}}}\nrules:
  - IF x IS low THEN y IS a
  - IF x IS middle THEN y IS b WITH 0.9
  - IF x IS high THEN y IS c WITH 0.8
  - IF x IS NOT low THEN y IS b WITH 0.7
"
    );
    text.parse().unwrap()
}

/// Returns the firing strengths of the rules, each with the index of its term.
fn strengths(x: f64) -> [(f64, usize); 4] {
    let middle = 1.0 - (2.0 * x - 1.0).abs();
    let (low, high) = ((1.0 - 2.0 * x).max(0.0), (2.0 * x - 1.0).max(0.0));
    [
        (low, 0),
        (0.9 * middle, 1),
        (0.8 * high, 2),
        (0.7 * (1.0 - low), 1),
    ]
}

fn implied(implication: Implication, h: f64, m: f64) -> f64 {
    match implication {
        Implication::Minimum => h.min(m),
        Implication::Product => h * m,
        Implication::BoundedDifference => (h + m - 1.0).max(0.0),
        Implication::Drastic if h == 1.0 => m,
        Implication::Drastic if m == 1.0 => h,
        Implication::Drastic => 0.0,
        Implication::Einstein => h * m / (2.0 - (h + m - h * m)),
        Implication::Hamacher if h + m == 0.0 => 0.0,
        Implication::Hamacher => h * m / (h + m - h * m),
        Implication::NilpotentMinimum if h + m > 1.0 => h.min(m),
        Implication::NilpotentMinimum => 0.0,
    }
}

fn aggregated(aggregation: Aggregation, a: f64, b: f64) -> f64 {
    match aggregation {
        Aggregation::Maximum => a.max(b),
        Aggregation::ProbabilisticSum => a + b - a * b,
        Aggregation::BoundedSum => (a + b).min(1.0),
        Aggregation::Sum => a + b,
        Aggregation::Drastic if a.min(b) == 0.0 => a.max(b),
        Aggregation::Drastic => 1.0,
        Aggregation::Einstein => (a + b) / (1.0 + a * b),
        Aggregation::Hamacher if a * b == 1.0 => 1.0,
        Aggregation::Hamacher => (a + b - 2.0 * a * b) / (1.0 - a * b),
        Aggregation::NilpotentMaximum if a + b < 1.0 => a.max(b),
        Aggregation::NilpotentMaximum => 1.0,
    }
}

const IMPLICATIONS: [Implication; 7] = [
    Implication::Minimum,
    Implication::Product,
    Implication::BoundedDifference,
    Implication::Drastic,
    Implication::Einstein,
    Implication::Hamacher,
    Implication::NilpotentMinimum,
];
const AGGREGATIONS: [Aggregation; 8] = [
    Aggregation::Maximum,
    Aggregation::ProbabilisticSum,
    Aggregation::BoundedSum,
    Aggregation::Sum,
    Aggregation::Drastic,
    Aggregation::Einstein,
    Aggregation::Hamacher,
    Aggregation::NilpotentMaximum,
];

const SAMPLES: usize = 10_000;

#[test]
fn centroids_and_bisectors_are_those_of_many_samples() {
    let mut compared = 0;
    for terms in [STRAIGHT, CURVED] {
        let mut model = model(terms);
        let shapes = model.outputs[0].variable.terms.clone();
        let step = 10.0 / SAMPLES as f64;
        let places: Vec<f64> = (0..SAMPLES).map(|i| (i as f64 + 0.5) * step).collect();
        let memberships: Vec<Vec<f64>> = shapes
            .iter()
            .map(|term| places.iter().map(|x| term.membership(*x)).collect())
            .collect();
        for implication in IMPLICATIONS {
            for aggregation in AGGREGATIONS {
                model.operators.implication = implication;
                model.operators.aggregation = aggregation;
                // With the drastic implication, only the peak of a curved term remains (and positions whose degree
                // rounds to 1), so it is not compared.
                if implication == Implication::Drastic && terms == CURVED {
                    continue;
                }
                for at in [0.15, 0.55, 0.8, 0.95] {
                    let fired = strengths(at);
                    let degrees: Vec<f64> = (0..SAMPLES)
                        .map(|i| {
                            fired.iter().fold(0.0, |all, (h, term)| {
                                let part = implied(implication, *h, memberships[*term][i]);
                                if *h > 0.0 {
                                    aggregated(aggregation, all, part)
                                } else {
                                    all
                                }
                            })
                        })
                        .collect();
                    let area: f64 = degrees.iter().sum();
                    let of = |defuzzifier: Defuzzifier| {
                        let mut model = model.clone();
                        model.outputs[0].defuzzifier = defuzzifier;
                        let engine = Engine::new(&model).unwrap();
                        engine.evaluate(&[at]).unwrap()[0].value()
                    };
                    let place = format!("{implication:?} {aggregation:?} at {at}: {terms}");
                    if area == 0.0 {
                        assert_eq!(of(Defuzzifier::Centroid), None, "{place}");
                        continue;
                    }
                    let moments = degrees.iter().zip(&places).map(|(y, x)| x * y);
                    let centroid = moments.sum::<f64>() / area;
                    let found = of(Defuzzifier::Centroid).unwrap();
                    assert!(
                        (found - centroid).abs() < 0.005,
                        "{place}: {found} {centroid}"
                    );
                    let mut sum = 0.0;
                    let mut reached = degrees.iter().zip(&places).skip_while(|(y, _)| {
                        sum += **y;
                        sum < 0.5 * area
                    });
                    let (_, bisector) = reached.next().unwrap();
                    let found = of(Defuzzifier::Bisector).unwrap();
                    assert!(
                        (found - bisector).abs() < 0.01,
                        "{place}: {found} {bisector}"
                    );
                    compared += 1;
                }
            }
        }
    }
    assert!(compared > 350, "{compared}");
}

fn centroid(terms: &str, rules: &str, operators: &str) -> Option<f64> {
    let text = format!(
        "{{fuzzy: 1, name: t, inputs: {{x: {{range: [0, 1], terms: {{high: {{right_shoulder: [0, 1]}}}}}}}}, outputs: {{y: {{range: [0, 10], terms: {{{terms}}}}}}}, operators: {{{operators}}}, rules: [{rules}]}}"
    );
    let model: Model = text.parse().unwrap();
    Engine::new(&model).unwrap().evaluate(&[1.0]).unwrap()[0].value()
}

fn near(found: Option<f64>, expected: f64) {
    let found = found.unwrap();
    assert!(
        (found - expected).abs() < 1e-11,
        "{found} is not {expected}"
    );
}

#[test]
fn norms_have_integrals_computed_by_hand() {
    let one = "IF x IS high THEN y IS a WITH 0.6";
    let two = "IF x IS high THEN y IS a WITH 0.5, IF x IS high THEN y IS b WITH 0.25";
    // min(0.6, m) where m > 0.4: rises from 0.8 to 1.2, is level up to 5.2, and falls to 6.8.
    let nilpotent = centroid(
        "a: {triangle: [0, 2, 10]}",
        one,
        "implication: nilpotent_minimum",
    );
    let moments = (1.728 - 0.512) / 6.0
        + 0.3 * (5.2 * 5.2 - 1.2 * 1.2)
        + (5.0 * (6.8f64.powi(2) - 5.2f64.powi(2)) - (6.8f64.powi(3) - 5.2f64.powi(3)) / 3.0) / 8.0;
    near(nilpotent, moments / (0.4 * 0.5 + 4.0 * 0.6 + 1.6 * 0.5));
    // m - 0.4 where it is above 0: a triangle [0.8, 2, 6.8].
    let bounded = centroid(
        "a: {triangle: [0, 2, 10]}",
        one,
        "implication: bounded_difference",
    );
    near(bounded, (0.8 + 2.0 + 6.8) / 3.0);
    // 0.6 where the trapezoid is 1.
    let drastic = centroid("a: {trapezoid: [0, 2, 7, 8]}", one, "implication: drastic");
    near(drastic, 4.5);
    let nothing = centroid("a: {triangle: [0, 2, 10]}", one, "implication: drastic");
    assert_eq!(nothing, None);
    // 0.6 m / (0.6 + 0.4 m) for a ramp m = x / 10: the integral of 1.5 x / (15 + x).
    let hamacher = centroid("a: {right_shoulder: [0, 10]}", one, "implication: hamacher");
    let logarithm = (25.0f64 / 15.0).ln();
    near(
        hamacher,
        (50.0 - 150.0 + 225.0 * logarithm) / (10.0 - 15.0 * logarithm),
    );
    // 0.6 m / (1.4 - 0.4 m) for the same ramp: the integral of 1.5 x / (35 - x).
    let einstein = centroid("a: {right_shoulder: [0, 10]}", one, "implication: einstein");
    let logarithm = (35.0f64 / 25.0).ln();
    near(
        einstein,
        (35.0f64.powi(2) * logarithm - 350.0 - 50.0) / (35.0 * logarithm - 10.0),
    );
    // Two triangles; 1 where they overlap.
    let drastic = centroid(
        "a: {triangle: [0, 2, 4]}, b: {triangle: [3, 5, 7]}",
        two,
        "implication: product, aggregation: drastic",
    );
    let (left, right) = (0.125, 0.0625);
    let moment = 2.0 + 0.5 * 5.0 - left * (3.0 + 1.0 / 3.0) - right * (3.0 + 2.0 / 3.0) + 3.5;
    near(drastic, moment / (1.0 + 0.5 - left - right + 1.0));
    // The larger of the ramp m and the constant 0.75 where m is below 0.25, and 1 beyond.
    let nilpotent = centroid(
        "a: {right_shoulder: [0, 10]}, b: {rectangle: [0, 10]}",
        "IF x IS high THEN y IS a, IF x IS high THEN y IS b WITH 0.75",
        "aggregation: nilpotent_maximum",
    );
    near(
        nilpotent,
        (0.75 * 2.5 * 1.25 + 7.5 * 6.25) / (0.75 * 2.5 + 7.5),
    );
}

#[test]
fn the_words_of_all_norms_are_written_and_read() {
    let mut model = model(STRAIGHT);
    for implication in IMPLICATIONS {
        for aggregation in AGGREGATIONS {
            model.operators.implication = implication;
            model.operators.aggregation = aggregation;
            let again: Model = fuzzy::yaml::to_string(&model).parse().unwrap();
            assert_eq!(again, model);
        }
    }
}
