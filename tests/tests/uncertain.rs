//! Uncertain inputs: the interval of an output contains its values for all inputs inside their intervals, and is not much
//! wider than the range of these values.

use fastrand::Rng;
use flagred_tests::random_models;
use flagred_tests::random_type2::{OutputTermKind, model};
use fuzzy::engine::Interval;
use fuzzy::{Engine, Model};

/// Evaluates `points` random points inside random intervals of the inputs. Returns the ratio of the width of the
/// interval of each output to the range of its values, if the values differ.
fn compare(seed: u64, model: &Model, points: usize, most: f64) -> Vec<f64> {
    let rng = &mut Rng::with_seed(seed);
    let engine = Engine::new(model).unwrap();
    let inputs: Vec<Interval> = model
        .inputs
        .iter()
        .map(|input| {
            let width = input.high - input.low;
            let half = if rng.u8(0..4) == 0 {
                0.0
            } else {
                0.5 * most * width * rng.f64()
            };
            let value = input.low + width * rng.f64();
            Interval::new(
                (value - half).max(input.low),
                (value + half).min(input.high),
            )
        })
        .collect();
    let enclosed = engine.enclosure().evaluate(&inputs).unwrap();
    let mut scratch = engine.scratch();
    let mut outcomes = vec![fuzzy::engine::Outcome::default(); enclosed.len()];
    let mut seen = vec![(f64::INFINITY, f64::NEG_INFINITY); enclosed.len()];
    for _ in 0..points {
        let end = rng.usize(0..8);
        let mut at = |interval: &Interval| match end {
            // Extreme values are often at the ends.
            0 => interval.low,
            1 => interval.high,
            2..4 => *rng.choice(&[interval.low, interval.high]).unwrap(),
            _ => (interval.low + interval.width() * rng.f64()).min(interval.high),
        };
        let point: Vec<f64> = inputs.iter().map(&mut at).collect();
        engine
            .evaluate_with(&mut scratch, &point, &mut outcomes)
            .unwrap();
        for ((outcome, enclosed), seen) in outcomes.iter().zip(&enclosed).zip(&mut seen) {
            let (Some(low), Some(high)) = (outcome.low(), outcome.high()) else {
                assert!(
                    enclosed.may_be_undefined,
                    "seed {seed} at {point:?}: {outcome:?}"
                );
                continue;
            };
            *seen = (seen.0.min(low), seen.1.max(high));
            let inside = enclosed
                .values
                .is_some_and(|all| all.contains(low) && all.contains(high));
            assert!(
                inside,
                "seed {seed}, {inputs:?}, {point:?}: {outcome:?}, {enclosed:?}\n{model:?}"
            );
        }
    }
    let widths = enclosed.iter().zip(&model.outputs).zip(seen);
    widths
        .filter_map(|((enclosed, output), (low, high))| {
            let range = output.variable.high - output.variable.low;
            (high - low > 1e-3 * range).then(|| enclosed.values.unwrap().width() / (high - low))
        })
        .collect()
}

fn print(what: &str, mut ratios: Vec<f64>) -> f64 {
    ratios.sort_by(f64::total_cmp);
    if ratios.is_empty() {
        return 1.0;
    }
    let at = |part: f64| ratios[(part * (ratios.len() - 1) as f64) as usize];
    println!(
        "{what}: {} intervals, {:.4} times as wide as the values (median), {:.4} (90 %), {:.3} (largest)",
        ratios.len(),
        at(0.5),
        at(0.9),
        at(1.0)
    );
    at(0.5)
}

/// Compares random models of all kinds.
fn random(count: usize, points: usize) {
    let mut ratios = Vec::new();
    for (seed, model, _) in random_models::models(0, count) {
        ratios.extend(compare(seed, &model, points, 0.3));
    }
    print(
        "all operators, defuzzifiers and membership functions",
        ratios,
    );
    for kind in [
        OutputTermKind::Straight,
        OutputTermKind::Curved,
        OutputTermKind::Numbers,
    ] {
        let models = (0..).filter_map(|seed| Some((seed, model(seed, kind)?.0)));
        let ratios = models.take(count / 4);
        let ratios = ratios.flat_map(|(seed, model)| compare(seed, &model, points, 0.3));
        print(&format!("type-2, {kind:?}"), ratios.collect());
    }
}

/// Compares rule sets as authors write them.
fn written(count: u64, points: usize) {
    for name in ["tipper", "flagred", "flagred-battery", "flagred-paper"] {
        let text = std::fs::read_to_string(format!("../rules/{name}.yaml")).unwrap();
        let model: Model = text.parse().unwrap();
        for part in [0.05, 0.2] {
            let ratios = (0..count).flat_map(|seed| compare(seed, &model, points, part));
            let median = print(
                &format!("{name}, up to {part} of the range"),
                ratios.collect(),
            );
            assert!(median < 1.1, "{name} {median}");
        }
    }
}

#[test]
fn no_value_leaves_its_interval() {
    random(60, 60);
    written(8, 300);
}

#[test]
#[ignore = "takes minutes"]
fn two_hundred_thousand_values_stay_in_their_intervals() {
    random(1000, 60);
    written(20, 700);
}
