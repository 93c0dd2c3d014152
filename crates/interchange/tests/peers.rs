//! Models of other programs give the values that those programs compute. The models are not shipped: the tests look
//! for them in the folder `data/models` of FLAGRED_SHARED.

#![allow(
    clippy::expect_used,
    clippy::panic,
    clippy::print_stdout,
    clippy::unwrap_used,
    reason = "helpers of tests fail by panics, and tell what fails"
)]

use std::{
    fs,
    io::Read,
    path::{Path, PathBuf},
};

use flagred_interchange::{Format, Losses};
use fuzzy::{
    Engine, Model,
    model::{Defuzzifier, NoRuleFires, Sampling, SamplingRule},
};

fn models() -> PathBuf {
    let shared = std::env::var_os("FLAGRED_SHARED").expect("FLAGRED_SHARED names the folder");
    Path::new(&shared).join("data/models")
}

/// Inputs and outputs of each row of a table with the header `in:NAME,...,out:NAME,...`.
fn points(path: &Path) -> Vec<(Vec<f64>, Vec<f64>)> {
    let mut text = String::new();
    flate2::read::GzDecoder::new(fs::File::open(path).unwrap())
        .read_to_string(&mut text)
        .unwrap();
    let mut lines = text.lines();
    let inputs = lines
        .next()
        .unwrap()
        .split(',')
        .filter(|name| name.starts_with("in:"))
        .count();
    let number = |word: &str| word.parse().unwrap_or(f64::NAN);
    let row = |line: &str| {
        let numbers: Vec<f64> = line.split(',').map(number).collect();
        (numbers[..inputs].to_vec(), numbers[inputs..].to_vec())
    };
    lines.map(row).collect()
}

/// The largest difference from the points, as a share of the output's range.
fn largest_difference(model: &Model, points: &[(Vec<f64>, Vec<f64>)]) -> f64 {
    let engine = Engine::new(model).unwrap_or_else(|findings| panic!("{findings}"));
    assert!(points.len() > 100);
    let mut largest = 0.0_f64;
    for (inputs, expected) in points {
        let found = engine.evaluate(inputs).unwrap();
        for ((found, expected), output) in found.iter().zip(expected).zip(&model.outputs) {
            // At degree 1 the inverse of a sigmoid is undefined: fuzzylite returns infinity.
            if expected.is_infinite() {
                continue;
            }
            let width = output.variable.high - output.variable.low;
            let difference = match found.value() {
                Some(value) => (value - expected).abs() / width,
                None if expected.is_nan() => 0.0,
                None => f64::INFINITY,
            };
            let difference = if difference.is_nan() {
                f64::INFINITY
            } else {
                difference
            };
            largest = largest.max(difference);
        }
    }
    largest
}

/// Reads each model of a folder and compares it with its points; `change` adapts the model to deviations of the other
/// program.
fn compare(
    files: &[(String, PathBuf, PathBuf)],
    largest: f64,
    change: impl Fn(&str, &mut Model),
) -> Vec<String> {
    let mut failed = vec![];
    for (name, file, expected) in files {
        let text = fs::read_to_string(file).unwrap();
        let format = Format::of(&text).expect("a known format");
        assert_eq!(file.extension().unwrap(), format.ending());
        let found = match flagred_interchange::read(&text, format, Losses::Refuse) {
            Ok(mut document) => {
                change(name, &mut document.model);
                match Engine::new(&document.model) {
                    Ok(_) if !expected.exists() => Ok(0.0),
                    Ok(_) => Ok(largest_difference(&document.model, &points(expected))),
                    Err(findings) => Err(findings),
                }
            }
            Err(findings) => Err(findings),
        };
        match found {
            Ok(difference) if difference <= largest => continue,
            Ok(difference) => println!("{name}: {difference:e}"),
            Err(findings) => println!("{name}: {findings}"),
        }
        failed.push(name.clone());
    }
    println!("{} of {} failed: {failed:?}", failed.len(), files.len());
    failed
}

fn sorted(folder: &str) -> Vec<PathBuf> {
    let entries = fs::read_dir(models().join(folder)).unwrap();
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    paths
}

fn name_of(path: &Path) -> String {
    path.file_name().unwrap().to_string_lossy().into_owned()
}

/// Name, file and points of each model of fuzzylite.
fn fuzzylite(file: &str, points: &str) -> Vec<(String, PathBuf, PathBuf)> {
    let folders = sorted("fuzzylite").into_iter().filter(|path| path.is_dir());
    let of = |folder: PathBuf| (name_of(&folder), folder.join(file), folder.join(points));
    folders.map(of).collect()
}

/// Adapts a model to fuzzylite's C++ library, which ignores strengths up to 1e-6. If no rule fires and there is no
/// default value, its mean of maxima is the middle of the range; here, and in pyfuzzylite 8, there is no value.
fn as_fuzzylite_in_cpp(_: &str, model: &mut Model) {
    model.least_strength = 1e-6;
    for output in &mut model.outputs {
        let is_mean = output.defuzzifier == Defuzzifier::MeanOfMaxima;
        if is_mean && output.when_no_rule_fires == NoRuleFires::Undefined {
            let middle = (output.variable.low + output.variable.high) / 2.0;
            output.when_no_rule_fires = NoRuleFires::Value(middle);
        }
    }
}

/// As [`as_fuzzylite_in_cpp`], with 1000 samples.
fn as_fuzzylite(name: &str, model: &mut Model) {
    as_fuzzylite_in_cpp(name, model);
    for output in &mut model.outputs {
        let weighted = matches!(
            output.defuzzifier,
            Defuzzifier::WeightedAverage | Defuzzifier::WeightedSum | Defuzzifier::Tsukamoto
        );
        output.samples = (!weighted).then_some(Sampling {
            samples: 1000,
            rule: SamplingRule::Midpoint,
        });
    }
}

/// Compares the FIS and FCL files that fuzzylite writes for its own models. Its FIS files lack some content of these
/// models: conditions on outputs, the kind of a hybrid system, and hedges that Octave reads as cubes.
#[test]
#[ignore = "needs FLAGRED_SHARED"]
fn copies_of_fuzzylites_models_have_the_same_values() {
    for (file, refused) in [
        (
            "model.fis",
            &[
                "hybrid_ObstacleAvoidance",
                "mamdani_Laundry",
                "mamdani_SimpleDimmerChained",
                "mamdani_SimpleDimmerInverse",
                "takagi-sugeno_octave_sugeno_tip_calculator",
            ][..],
        ),
        ("model.fcl", &[]),
    ] {
        let files = fuzzylite(file, "points_1000.csv.gz");
        let failed = compare(&files, 1e-9, as_fuzzylite);
        println!("{file}: {failed:?}");
        assert_eq!(failed, refused);
    }
}

#[test]
#[ignore = "needs FLAGRED_SHARED"]
fn fll_models_equal_fuzzylite() {
    let files = fuzzylite("model.fll", "points_own.csv.gz");
    assert_eq!(files.len(), 26);
    let failed = compare(&files, 1e-9, as_fuzzylite_in_cpp);
    assert!(failed.is_empty());
}

#[test]
#[ignore = "needs FLAGRED_SHARED"]
fn fis_models_equal_fuzzylite() {
    let files = sorted("fis")
        .into_iter()
        .filter(|path| path.extension().unwrap() == "fis");
    let files: Vec<_> = files
        .map(|file| {
            let points = file.with_file_name(format!("{}.points_1000.csv.gz", name_of(&file)));
            (name_of(&file), file, points)
        })
        .collect();
    assert_eq!(files.len(), 22);
    // Octave's cubic hedges are refused in conclusions, and where AND is not the product.
    let refused = ["takagi-sugeno_octave_sugeno_tip_calculator.fis"];
    assert_eq!(compare(&files, 1e-3, as_fuzzylite_in_cpp), refused);
    assert_eq!(compare(&files, 1e-9, as_fuzzylite), refused);
}

/// Compares with tables of jFuzzyLogic. A row contains the inputs, then the degrees of the first input's terms, the
/// value of the output, or both.
#[test]
#[ignore = "needs FLAGRED_SHARED"]
fn fcl_models_equal_jfuzzylogic() {
    let files = sorted("fcl")
        .into_iter()
        .filter(|path| path.extension().unwrap() == "fcl");
    let (mut read, mut compared) = (0, 0);
    for file in files {
        let text = fs::read_to_string(&file).unwrap();
        assert_eq!(Format::of(&text), Some(Format::Fcl));
        let document = flagred_interchange::read(&text, Format::Fcl, Losses::Refuse)
            .unwrap_or_else(|findings| panic!("{}: {findings}", file.display()));
        read += 1;
        let Ok(table) = fs::read_to_string(file.with_extension("txt")) else {
            continue;
        };
        let model = document.model;
        let file = name_of(&file);
        // Tables with a header contain values in hundredths, truncated; the others contain unscaled values.
        let is_cut = !table.starts_with(|c: char| c.is_ascii_digit());
        let unit = if is_cut { 0.01 } else { 1.0 };
        let memberships = table.starts_with("inVar");
        let engine = (!model.outputs.is_empty()).then(|| Engine::new(&model).unwrap());
        let number = |word: &str| unit * word.parse::<f64>().unwrap();
        for line in table.lines().skip(usize::from(is_cut)) {
            let row: Vec<f64> = line.split_whitespace().map(number).collect();
            let (inputs, rest) = row.split_at(model.inputs.len());
            let (degrees, values) = match memberships {
                true => rest.split_at(model.inputs[0].terms.len()),
                false => rest.split_at(0),
            };
            for (term, expected) in model.inputs[0].terms.iter().zip(degrees) {
                let degree = term.membership_function.membership(inputs[0]);
                assert!(
                    (degree - expected).abs() < 0.011,
                    "{file}: {} at {inputs:?} is {degree}, not {expected}",
                    term.name
                );
                compared += 1;
            }
            if let (Some(engine), [expected]) = (&engine, values) {
                // If no rule fires, jFuzzyLogic keeps the previous value, or 0 in the first row; such values are not
                // compared.
                let found = engine.evaluate(inputs).unwrap()[0].value();
                let tolerance = if is_cut { 0.011 } else { 1e-3 };
                if let Some(found) = found {
                    assert!(
                        (found - expected).abs() < tolerance,
                        "{file}: {inputs:?} is {found}, not {expected}"
                    );
                    compared += 1;
                }
            }
        }
    }
    assert_eq!(read, 14);
    assert!(compared > 3_000, "{compared}");
}

/// Every usable model is written in its own format and read back: the model or its values are equal.
#[test]
#[ignore = "needs FLAGRED_SHARED"]
fn models_are_written_back_and_read_again_as_they_were() {
    let fll = fuzzylite("model.fll", "")
        .into_iter()
        .map(|(_, file, _)| file);
    let others = ["fis", "fcl", "fml"].into_iter().flat_map(sorted);
    let (mut equal, mut equal_values) = (0, 0);
    for file in fll.chain(others) {
        let Some(format) = file.extension().and_then(|ending| match ending.to_str()? {
            "xml" => Some(Format::Fml),
            ending => Format::ALL
                .into_iter()
                .find(|format| format.ending() == ending),
        }) else {
            continue;
        };
        let name = file.strip_prefix(models()).unwrap().display().to_string();
        let read = |text: &str| flagred_interchange::read(text, format, Losses::Refuse);
        let Ok(document) = read(&fs::read_to_string(&file).unwrap()) else {
            continue;
        };
        let model = document.model;
        let Ok(engine) = Engine::new(&model) else {
            continue;
        };
        // Only fuzzylite supports Tsukamoto outputs in FIS.
        if name == "fis/tsukamoto_tsukamoto.fis" {
            continue;
        }
        let written = flagred_interchange::write(&model, format, Losses::Refuse);
        let written = written.unwrap_or_else(|findings| panic!("{name}: {findings}"));
        let again = read(&written.text)
            .unwrap_or_else(|findings| panic!("{name}: {findings}"))
            .model;
        if again == model {
            equal += 1;
            continue;
        }
        // FCL replaces triangles by points, and FIS replaces shoulders by trapezoids, so the models differ although
        // their values are equal.
        assert!(
            format == Format::Fcl || name == "fis/mamdani_AllTerms.fis",
            "{name}"
        );
        equal_values += 1;
        let again = Engine::new(&again).unwrap();
        for i in 0..500 {
            let share = |k: usize| (f64::from(i) * 0.618 * (k + 1) as f64).fract();
            let inputs = model.inputs.iter().enumerate();
            let inputs: Vec<f64> = inputs
                .map(|(k, input)| input.low + share(k) * (input.high - input.low))
                .collect();
            let [before, after] = [&engine, &again].map(|engine| engine.evaluate(&inputs).unwrap());
            for (before, after) in before.iter().zip(&after) {
                let same = match (before.value(), after.value()) {
                    (Some(before), Some(after)) => (before - after).abs() < 1e-9,
                    (before, after) => before == after,
                };
                assert!(same, "{name} at {inputs:?}: {before:?}, {after:?}");
            }
        }
    }
    assert_eq!((equal, equal_values), (47, 3));
}

/// The tipper of FuzzyLogic.jl, built by hand.
#[test]
#[ignore = "needs FLAGRED_SHARED"]
fn the_fml_tipper_is_the_tipper() {
    let text = fs::read_to_string(models().join("fml/tipper.xml")).unwrap();
    let document =
        flagred_interchange::read(&text, Format::of(&text).unwrap(), Losses::Refuse).unwrap();
    let tipper = "
fuzzy: 1
name: tipper
inputs:
  food:
    range: [0, 10]
    terms: {rancid: {left_shoulder: [0, 5.5]}, delicious: {right_shoulder: [5.5, 10]}}
  service:
    range: [0, 10]
    terms:
      poor: {gaussian2: {left_mean: 0, left_sd: 2, right_mean: 0, right_sd: 2}}
      good: {gaussian: {mean: 5, sd: 2}}
      excellent: {gaussian2: {left_mean: 10, left_sd: 2, right_mean: 10, right_sd: 2}}
outputs:
  tip:
    range: [0, 20]
    terms: {cheap: {triangle: [0, 5, 10]}, average: {triangle: [5, 10, 15]}, generous: {triangle: [10, 15, 20]}}
    when_no_rule_fires: {value: 0}
rules:
  - IF food IS rancid OR service IS very poor THEN tip IS cheap
  - IF service IS good THEN tip IS average
  - IF service IS excellent OR food IS delicious THEN tip IS generous
";
    let tipper: Model = tipper
        .parse()
        .unwrap_or_else(|findings| panic!("{findings}"));
    assert_eq!(document.model, tipper);
}
