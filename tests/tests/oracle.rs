//! Random models over all shapes, norms, implications, aggregations and defuzzifiers, compared with formulas and integrals that
//! are independent of the engine.

use std::process::Command;

use flagred_tests::Folder;
use flagred_tests::random_models::models;
use flagred_tests::reference::{integral, rules};
use fuzzy::Engine;
use fuzzy::map::{DecisionMap, Grid};
use fuzzy::model::{Defuzzifier, Model};
use fuzzy::table::{ClosedForm, Outcome, PartialConjunction, Scratch, StrongestRule};
use serde_json::json;

/// Counts of the compared values.
#[derive(Debug, Default)]
struct Tally {
    models: usize,
    values: usize,
    ill_conditioned: usize,
    /// The number of models with maxima whose exported arrays were compared.
    exported_maxima: usize,
    worst: f64,
    wrong: Vec<String>,
}

/// The same model with slightly smaller weights.
fn with_rounding(model: &Model) -> Model {
    let mut model = model.clone();
    for rule in &mut model.rules {
        rule.rule.weight *= 1.0 - 1e-15;
    }
    model
}

/// Compares `count` models, with seeds from `first` on.
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
                // The value depends on the last digit of the firing strengths.
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

/// The value from the arrays that exports and the C library evaluate; `None` if the output has no closed form.
fn by_table(engine: &Engine, point: &[f64]) -> Option<Outcome> {
    let table = engine.table()?;
    if table.outputs[0].form() == ClosedForm::Integrated {
        return None;
    }
    let sizes = table.sizes;
    let numbers = |count: u32| vec![0.0; count as usize];
    let partials = |count: u32| vec![PartialConjunction::NONE; count as usize];
    let mut scratch = Scratch {
        values: &mut vec![0.0; point.len()],
        degrees: &mut numbers(sizes.degrees),
        alive: &mut partials(sizes.alive),
        partial: &mut partials(sizes.partial),
        next: &mut partials(sizes.partial),
        stack: &mut numbers(sizes.stack),
        strengths: &mut numbers(sizes.strengths),
        strongest: &mut [StrongestRule::NONE],
    };
    let mut outcomes = [Outcome::UNDEFINED];
    table.evaluate(&mut scratch, point, &mut outcomes);
    Some(outcomes[0])
}

/// Asserts that batches, explanations, exported arrays and maps give bit for bit the values of single calls. Returns whether
/// arrays are exported.
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
    // Nearly all values must have been compared.
    assert!(500 * tally.ill_conditioned <= tally.values, "{tally:?}");
}

#[test]
fn two_thousand_models_agree_with_the_reference() {
    assert_right(&compare(1_000_000, 2000));
}

/// Fails at present: in 55 of 59,945 values, the engine or the reference is wrong (docs/validation.md, The engine).
#[test]
#[ignore = "minutes, and some values differ"]
fn twenty_thousand_models_agree_with_the_reference() {
    assert_right(&compare(2_000_000, 20_000));
}

const PEER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/peer/mpmath_peer.py");

/// `FLAGRED_PYTHON` names a Python with mpmath.
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
    let reported = String::from_utf8(output.stdout).unwrap();
    let errors = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success(), "{reported}{errors}");
    assert!(reported.contains("600 values, 0 wrong"), "{reported}");
}
