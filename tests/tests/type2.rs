//! Interval type-2 rule sets, compared with sums over many samples for all switch points, and with published figures.

use flagred_tests::random_type2::{OutputTermKind, model};
use flagred_tests::reference::type2;
use fuzzy::model::{Defuzzifier, TypeReduction};
use fuzzy::table::ClosedForm;
use fuzzy::{Engine, Model};

/// Compares `count` random models, each at three points. Returns the number of intervals.
fn compare(kind: OutputTermKind, count: usize, samples: usize, tolerance: f64) -> usize {
    let models = (0..).filter_map(|seed| Some((seed, model(seed, kind)?)));
    let (mut values, mut worst) = (0, 0.0_f64);
    for (seed, (model, points)) in models.take(count) {
        let engine = Engine::new(&model).unwrap();
        let output = &model.outputs[0];
        let range = match kind {
            OutputTermKind::Numbers => 1.0,
            OutputTermKind::Straight | OutputTermKind::Curved => {
                output.variable.high - output.variable.low
            }
        };
        for point in &points {
            let outcome = engine.evaluate(point).unwrap()[0];
            let expected = type2::interval(&model, output, point, samples);
            let (Some(low), Some(high), Some(expected)) = (outcome.low(), outcome.high(), expected)
            else {
                assert_eq!(outcome.value().is_none(), expected.is_none(), "seed {seed}");
                continue;
            };
            let error = |expected: type2::Interval| {
                let errors = [low - expected.low, high - expected.high];
                let errors = errors.map(|error| error.abs() / range);
                errors[0].max(errors[1])
            };
            // Near an empty lower set, the ends depend on a few samples.
            let tolerance = match expected.lower_share {
                share if share < 1e-2 => 1e-2,
                _ => tolerance,
            };
            let mut worst_here = error(expected);
            if worst_here > tolerance {
                // With ten times as many samples, the error of the sums is a hundred times smaller.
                let finer = type2::interval(&model, output, point, 10 * samples);
                worst_here = error(finer.unwrap());
            }
            assert!(
                worst_here <= tolerance,
                "seed {seed} at {point:?}: {low} to {high}, not {expected:?} ({worst_here:e})\n{model:?}"
            );
            if tolerance < 1e-3 {
                values += 1;
                worst = worst.max(worst_here);
            }
            let value = outcome.value().unwrap();
            assert!((low..=high).contains(&value), "{outcome:?}");
        }
    }
    println!("{values} intervals of {kind:?} terms, worst {worst:e} of the range");
    values
}

#[test]
fn straight_terms_have_the_interval_of_all_switch_points() {
    assert!(compare(OutputTermKind::Straight, 40, 20_000, 1e-9) > 60);
}

#[test]
fn curved_terms_and_all_operators_have_the_interval_of_all_switch_points() {
    assert!(compare(OutputTermKind::Curved, 25, 20_000, 1e-9) > 30);
}

#[test]
fn weighted_numbers_have_the_interval_of_all_corners() {
    assert!(compare(OutputTermKind::Numbers, 400, 0, 1e-12) > 800);
}

/// Compares the values of methods of type reduction that give a number.
#[test]
fn reductions_to_a_number_have_their_formulas() {
    let (mut closed, mut integrated) = (0, 0);
    for (kind, count) in [
        (OutputTermKind::Straight, 25),
        (OutputTermKind::Curved, 25),
        (OutputTermKind::Numbers, 100),
    ] {
        let models = (0..).filter_map(|seed| Some((seed, model(seed, kind)?)));
        let is_sum = |model: &Model| model.outputs[0].defuzzifier == Defuzzifier::WeightedSum;
        let models = models.filter(|(_, (model, _))| !is_sum(model));
        for (seed, (mut model, points)) in models.take(count) {
            let expected = points
                .iter()
                .map(|point| type2::interval(&model, &model.outputs[0], point, 10_000));
            let expected: Vec<_> = expected.collect();
            for method in [TypeReduction::NieTan, TypeReduction::BegianMelekMendel] {
                model.outputs[0].type_reduction = method;
                let engine = Engine::new(&model).unwrap();
                match engine.table().unwrap().outputs[0].form() {
                    ClosedForm::Integrated => integrated += 1,
                    _ => closed += 1,
                }
                let variable = &model.outputs[0].variable;
                let range = match kind {
                    OutputTermKind::Numbers => 1.0,
                    _ => variable.high - variable.low,
                };
                for (point, expected) in points.iter().zip(&expected) {
                    let outcome = engine.evaluate(point).unwrap()[0];
                    let (Some(value), Some(expected)) = (outcome.value(), expected) else {
                        assert_eq!(outcome.value().is_none(), expected.is_none(), "seed {seed}");
                        continue;
                    };
                    let expected_value = match method {
                        TypeReduction::NieTan => expected.nie_tan,
                        _ => expected.begian_melek_mendel,
                    };
                    // The centroid of an almost empty lower set depends on a few samples.
                    let tolerance = match expected.lower_share {
                        share if share < 1e-2 => 1e-2,
                        _ => 1e-7,
                    };
                    assert!(
                        (value - expected_value).abs() <= tolerance * range,
                        "seed {seed} at {point:?}: {method:?} {value}, not {expected_value}\n{model:?}"
                    );
                    assert_eq!(outcome.low(), outcome.high());
                }
            }
        }
    }
    assert!(closed > 200 && integrated > 20, "{closed} {integrated}");
}

#[test]
#[ignore = "takes minutes"]
fn thousands_of_intervals() {
    assert!(compare(OutputTermKind::Straight, 1000, 40_000, 1e-9) > 1500);
    assert!(compare(OutputTermKind::Curved, 500, 40_000, 1e-9) > 600);
    assert!(compare(OutputTermKind::Numbers, 20_000, 0, 1e-12) > 40_000);
}

/// Returns the centroid of a word of the code book of Wu and Mendel (A comparative study of ranking methods, similarity measures and
/// uncertainty measures for interval type-2 fuzzy sets, Information Sciences 179, 2009), whose parameters and centroids are
/// printed with two decimals.
fn centroid(upper: &str, lower: &str) -> (f64, f64) {
    let text = format!(
        "
fuzzy: 1
name: word
inputs: {{x: {{range: [0, 1], partition: [no, yes]}}}}
outputs: {{word: {{range: [0, 10], terms: {{it: {{upper: {{trapezoid: {upper}}}, lower: {lower}}}}}}}}}
rules: [IF x IS any THEN word IS it]
"
    );
    let model: Model = text.parse().unwrap();
    let outcome = Engine::new(&model).unwrap().evaluate(&[0.0]).unwrap()[0];
    (outcome.low().unwrap(), outcome.high().unwrap())
}

#[test]
fn words_have_their_published_centroids() {
    let a_bit = centroid(
        "[0.59, 1.5, 2, 3.41]",
        "{triangle: [0.79, 1.68, 2.21], height: 0.74}",
    );
    assert!(
        (a_bit.0 - 1.42).abs() < 0.01 && (a_bit.1 - 2.08).abs() < 0.01,
        "{a_bit:?}"
    );
    let very_little = centroid("[0, 0, 0.14, 1.97]", "{trapezoid: [0, 0, 0.05, 0.66]}");
    let (low, high) = very_little;
    assert!(
        (low - 0.22).abs() < 0.01 && (high - 0.73).abs() < 0.01,
        "{very_little:?}"
    );
}

#[test]
fn short_forms_have_the_interval_of_their_pairs() {
    let interval = |food: &str, tip: &str| {
        let text = format!(
            "
fuzzy: 1
name: dinner
inputs: {{food: {{range: [0, 10], {food}}}}}
outputs: {{tip: {{range: [0, 30], {tip}}}}}
rules: [IF food IS bad THEN tip IS small, IF food IS good THEN tip IS large]
"
        );
        let model: Model = text.parse().unwrap();
        let outcome = Engine::new(&model).unwrap().evaluate(&[4.0]).unwrap()[0];
        (outcome.low().unwrap(), outcome.high().unwrap())
    };
    let short = interval(
        "partition: [bad, good], blur: 0.1",
        "terms: {small: {triangle: [0, 6, 18], blur: 0.05}, large: {triangle: [12, 24, 30], lower_scale: 0.9, lower_lag: [0.5, 0.25]}}",
    );
    let pairs = interval(
        "terms: {bad: {upper: {left_shoulder: [1, 11]}, lower: {left_shoulder: [-1, 9]}}, good: {upper: {right_shoulder: [-1, 9]}, lower: {right_shoulder: [1, 11]}}}",
        "terms: {small: {upper: {trapezoid: [-1.5, 4.5, 7.5, 19.5]}, lower: {triangle: [1.5, 6.5, 16.5], height: 0.8333333333333334}},
                 large: {upper: {triangle: [12, 24, 30]}, lower: {triangle: [18, 24, 28.5], height: 0.9}}}",
    );
    assert!((short.0 - pairs.0).abs() < 1e-12 && (short.1 - pairs.1).abs() < 1e-12);
    assert!(short.0 < short.1);
}

/// The formulas of the papers, as sums over samples, for a set between a trapezoid from 1 to 9 and a triangle of height
/// 0.5.
#[test]
fn type_reductions_have_their_published_formulas() {
    let text = |method: &str| {
        format!(
            "
fuzzy: 1
name: word
inputs: {{x: {{range: [0, 1], partition: [no, yes]}}}}
outputs: {{word: {{range: [0, 10], type_reduction: {method}, terms: {{it: {{upper: {{trapezoid: [1, 2, 4, 9]}}, lower: {{triangle: [2, 3, 6], height: 0.5}}}}}}}}}}
rules: [IF x IS any THEN word IS it]
"
        )
    };
    let outcome = |method: &str| {
        let model: Model = text(method).parse().unwrap();
        assert_eq!(
            fuzzy::yaml::to_string(&model).parse::<Model>().unwrap(),
            model
        );
        Engine::new(&model).unwrap().evaluate(&[0.0]).unwrap()[0]
    };
    const SAMPLES: u32 = 100_000;
    // Only the support [1, 9] of the upper set has samples with a degree.
    let xs = (0..SAMPLES).map(|i| 1.0 + 8.0 * (f64::from(i) + 0.5) / f64::from(SAMPLES));
    let xs: Vec<f64> = xs.collect();
    let upper = |x: f64| (x - 1.0).min(1.0).min((9.0 - x) / 5.0);
    let lower = |x: f64| (0.5 * (x - 2.0).min((6.0 - x) / 3.0)).max(0.0);
    let sum = |f: &dyn Fn(f64) -> f64| xs.iter().map(|x| f(*x)).sum::<f64>();
    let (of_lower, of_upper) = (sum(&lower), sum(&upper));
    let y_lower = sum(&|x| lower(x) * x) / of_lower;
    let y_upper = sum(&|x| upper(x) * x) / of_upper;
    let nie_tan = sum(&|x| (lower(x) + upper(x)) * x) / (of_lower + of_upper);
    let near = |value: f64, expected: f64| {
        assert!((value - expected).abs() < 1e-7, "{value}, not {expected}")
    };
    near(outcome("nie_tan").value().unwrap(), nie_tan);
    near(
        outcome("begian_melek_mendel").value().unwrap(),
        0.5 * y_lower + 0.5 * y_upper,
    );
    let gap =
        |a: f64, b: f64| sum(&|x| upper(x) - lower(x)) / (of_upper * of_lower) * (a * b / (a + b));
    let left = gap(
        sum(&|x| lower(x) * (x - 1.0)),
        sum(&|x| upper(x) * (9.0 - x)),
    );
    let right = gap(
        sum(&|x| upper(x) * (x - 1.0)),
        sum(&|x| lower(x) * (9.0 - x)),
    );
    let wu_mendel = outcome("wu_mendel");
    near(wu_mendel.low().unwrap(), y_lower.min(y_upper) - 0.5 * left);
    near(
        wu_mendel.high().unwrap(),
        y_lower.max(y_upper) + 0.5 * right,
    );
    // Each end of `wu_mendel` is the middle between an inner and an outer bound; the exact end lies between these bounds.
    let exact = outcome("exact");
    let inner = (y_lower.min(y_upper), y_lower.max(y_upper));
    assert!((inner.0 - left..=inner.0).contains(&exact.low().unwrap()));
    assert!((inner.1..=inner.1 + right).contains(&exact.high().unwrap()));
}

#[test]
fn type_reductions_need_type2_terms_and_no_sum() {
    let refused = |input: &str, output: &str| {
        let text = format!(
            "{{fuzzy: 1, name: n, inputs: {{x: {{range: [0, 1], {input}}}}}, outputs: {{y: {{range: [0, 9], type_reduction: nie_tan, {output}}}}}, rules: [IF x IS no THEN y IS a]}}"
        );
        let findings = text.parse::<Model>().unwrap_err();
        findings
            .0
            .iter()
            .map(|it| it.message.clone())
            .collect::<Vec<_>>()
    };
    assert_eq!(
        refused("partition: [no, yes]", "partition: [a, b]"),
        ["output `y` has a `type_reduction`, but the rule set has no type-2 terms"]
    );
    assert_eq!(
        refused(
            "partition: [no, yes], blur: 0.1",
            "defuzzifier: weighted_sum, terms: {a: {constant: 1}}"
        ),
        ["`type_reduction` of output `y` is not defined for `weighted_sum`"]
    );
}
