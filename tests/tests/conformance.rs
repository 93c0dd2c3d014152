//! Every way of evaluation gives the same values for the corpus in `tests/conformance`.
//!
//! A file contains a rule set and, after `---`, its cases: operators that differ from those of the rule set,
//! a point, and the values there. The values come from the integration in `flagred_tests::reference` with
//! very many samples; to write those of new cases, omit `is` and run
//! `FLAGRED_BLESS=1 cargo test --release -p flagred-tests --test conformance`.

use std::path::{Path, PathBuf};

use flagred_tests::reference;
use fuzzy::Engine;
use fuzzy::engine::Outcome;
use fuzzy::map::{DecisionMap, Grid};
use fuzzy::model::{Aggregation, Conjunction, Defuzzifier, Disjunction, Model};

/// Tolerance of the engine, relative to the range of the output.
const ENGINE: f64 = 1e-9;
/// Tolerance of the engine for maxima: the expected values are only as precise as the distance between [`MANY`]
/// samples.
const ENGINE_MAXIMA: f64 = 1e-5;
/// Number of samples of the plain integration in tests.
const FEW: usize = 4_000;
/// Tolerance of the plain integration in tests, relative to the range of the output.
const FEW_TOLERANCE: f64 = 1e-6;
/// Tolerance of the plain integration in tests for maxima.
const FEW_MAXIMA: f64 = 1e-3;
/// Number of samples of the plain integration that computes the expected values.
const MANY: usize = 200_000;

struct Case {
    model: Model,
    point: Vec<f64>,
    values: Vec<Option<f64>>,
    place: String,
}

fn files() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("conformance");
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .collect();
    files.sort();
    files
}

/// A rule set and the lines of its cases.
fn parts(file: &Path) -> (Model, String) {
    let text = std::fs::read_to_string(file).unwrap();
    let (rule_set, cases) = text.split_once("\n---\n").unwrap();
    let document = fuzzy::yaml::parse(rule_set);
    let document = document.unwrap_or_else(|error| panic!("{}: {error}", file.display()));
    (document.model, cases.into())
}

/// Parses a case, such as `- {and: product, defuzzifier: bisector, at: [0.1, 0.2], is: [3.5, none]}`.
fn case(model: &Model, line: &str, place: String) -> Case {
    let mut case = Case {
        model: model.clone(),
        point: Vec::new(),
        values: Vec::new(),
        place,
    };
    let list = |text: &str| -> Vec<Option<f64>> {
        let numbers = text.trim_matches(['[', ']']).split(", ");
        numbers.map(|number| number.parse().ok()).collect()
    };
    let inside = line.strip_prefix("- {").unwrap().strip_suffix('}').unwrap();
    let mut rest = inside;
    while !rest.is_empty() {
        let (key, behind) = rest.split_once(": ").unwrap();
        let end = if behind.starts_with('[') {
            behind.find(']').unwrap() + 1
        } else {
            behind.find(", ").unwrap_or(behind.len())
        };
        let (value, behind) = behind.split_at(end);
        rest = behind.strip_prefix(", ").unwrap_or(behind);
        let operators = &mut case.model.operators;
        match key {
            "at" => case.point = list(value).into_iter().flatten().collect(),
            "is" => case.values = list(value),
            "and" => operators.and = conjunction(value),
            "or" => operators.or = disjunction(value),
            "implication" => {
                operators.implication = conjunction(value);
            }
            "aggregation" => {
                operators.aggregation = match value {
                    "maximum" => Aggregation::Maximum,
                    "probabilistic_sum" => Aggregation::ProbabilisticSum,
                    "bounded_sum" => Aggregation::BoundedSum,
                    "sum" => Aggregation::Sum,
                    "drastic" => Aggregation::Drastic,
                    "einstein" => Aggregation::Einstein,
                    "hamacher" => Aggregation::Hamacher,
                    "nilpotent_maximum" => Aggregation::NilpotentMaximum,
                    other => panic!("{other}"),
                }
            }
            "defuzzifier" => {
                for output in &mut case.model.outputs {
                    output.defuzzifier = match value {
                        "centroid" => Defuzzifier::Centroid,
                        "bisector" => Defuzzifier::Bisector,
                        "smallest_of_maxima" => Defuzzifier::SmallestOfMaxima,
                        "mean_of_maxima" => Defuzzifier::MeanOfMaxima,
                        "largest_of_maxima" => Defuzzifier::LargestOfMaxima,
                        other => panic!("{other}"),
                    };
                }
            }
            other => panic!("{}: `{other}`", case.place),
        }
    }
    case
}

fn conjunction(word: &str) -> Conjunction {
    match word {
        "minimum" => Conjunction::Minimum,
        "product" => Conjunction::Product,
        "bounded_difference" => Conjunction::BoundedDifference,
        "drastic" => Conjunction::Drastic,
        "einstein" => Conjunction::Einstein,
        "hamacher" => Conjunction::Hamacher,
        "nilpotent_minimum" => Conjunction::NilpotentMinimum,
        other => panic!("{other}"),
    }
}

fn disjunction(word: &str) -> Disjunction {
    match word {
        "maximum" => Disjunction::Maximum,
        "probabilistic_sum" => Disjunction::ProbabilisticSum,
        "bounded_sum" => Disjunction::BoundedSum,
        "drastic" => Disjunction::Drastic,
        "einstein" => Disjunction::Einstein,
        "hamacher" => Disjunction::Hamacher,
        "nilpotent_maximum" => Disjunction::NilpotentMaximum,
        other => panic!("{other}"),
    }
}

fn corpus() -> Vec<Case> {
    let mut cases = Vec::new();
    for file in files() {
        let (model, lines) = parts(&file);
        let name = file.file_name().unwrap().to_string_lossy().into_owned();
        for line in lines.lines() {
            cases.push(case(&model, line, format!("{name}: {line}")));
        }
    }
    cases
}

fn is_maxima(defuzzifier: Defuzzifier) -> bool {
    use Defuzzifier::{LargestOfMaxima, MeanOfMaxima, SmallestOfMaxima};
    matches!(
        defuzzifier,
        SmallestOfMaxima | MeanOfMaxima | LargestOfMaxima
    )
}

/// Compares values with those of a case; `tolerances` are those of integrals and of maxima.
fn compare(case: &Case, values: &[Option<f64>], tolerances: (f64, f64)) {
    assert_eq!(values.len(), case.values.len(), "{}", case.place);
    for ((output, value), expected) in case.model.outputs.iter().zip(values).zip(&case.values) {
        let range = output.variable.high - output.variable.low;
        let part = if is_maxima(output.defuzzifier) {
            tolerances.1
        } else {
            tolerances.0
        };
        match (value, expected) {
            (Some(value), Some(expected)) => assert!(
                (value - expected).abs() <= part * range,
                "{}: {} is {value}, {:e} of its range away",
                case.place,
                output.variable.name,
                (value - expected).abs() / range
            ),
            (value, expected) => assert_eq!(value, expected, "{}", case.place),
        }
    }
}

fn values(outcomes: &[Outcome]) -> Vec<Option<f64>> {
    outcomes.iter().map(Outcome::value).collect()
}

/// All parts of an outcome, bit for bit.
fn bits(outcomes: &[Outcome]) -> Vec<String> {
    let bits = |x: Option<f64>| x.map(f64::to_bits);
    outcomes
        .iter()
        .map(|o| {
            format!(
                "{:?} {:?} {:?} {}",
                bits(o.value()),
                bits(Some(o.coverage)),
                o.dominant_rule,
                o.clamped
            )
        })
        .collect()
}

#[test]
fn the_corpus_is_as_large_as_it_should_be() {
    let cases = corpus();
    let outputs: usize = cases.iter().map(|case| case.values.len()).sum();
    assert!(
        cases.len() >= 300,
        "{} cases, {outputs} values",
        cases.len()
    );
}

#[test]
fn single_calls_give_the_values_of_the_corpus() {
    for case in corpus() {
        let engine = Engine::new(&case.model).unwrap();
        let outcomes = engine.evaluate(&case.point).unwrap();
        compare(&case, &values(&outcomes), (ENGINE, ENGINE_MAXIMA));
    }
}

#[test]
fn the_values_of_the_corpus_are_those_of_a_plain_integration() {
    if std::env::var_os("FLAGRED_BLESS").is_some() {
        bless();
    }
    for case in corpus() {
        let values = reference::rules::evaluate(&case.model, &case.point, FEW);
        compare(&case, &values, (FEW_TOLERANCE, FEW_MAXIMA));
    }
}

/// Writes the expected values of all cases, computed by plain integration with very many samples.
fn bless() {
    for file in files() {
        let (model, lines) = parts(&file);
        let mut cases = String::new();
        for line in lines.lines() {
            let case = case(&model, line, line.into());
            let values: Vec<String> = reference::rules::evaluate(&case.model, &case.point, MANY)
                .into_iter()
                .map(|value| value.map_or("none".into(), |value| format!("{value:.12}")))
                .collect();
            let requested = line.split(", is: ").next().unwrap().trim_end_matches('}');
            cases.push_str(&format!("{requested}, is: [{}]}}\n", values.join(", ")));
        }
        let text = std::fs::read_to_string(&file).unwrap();
        let (rule_set, _) = text.split_once("\n---\n").unwrap();
        std::fs::write(&file, format!("{rule_set}\n---\n{cases}")).unwrap();
    }
}

/// The outcomes of the corpus, bit for bit, one line per case: its file, its index in the file, and for each output the
/// bits of value and coverage, the index of the dominant rule, and whether an input was clamped. Libraries for other
/// languages are compared with the file. `UPDATE_BITS=1 cargo test -p flagred-tests --test conformance` writes the
/// file.
#[test]
fn the_bits_of_the_corpus_are_those_on_file() {
    let mut lines = String::new();
    for file in files() {
        let (model, cases) = parts(&file);
        let name = file.file_name().unwrap().to_string_lossy().into_owned();
        for (i, line) in cases.lines().enumerate() {
            let case = case(&model, line, format!("{name}: {line}"));
            let outcomes = Engine::new(&case.model).unwrap().evaluate(&case.point);
            lines += &format!("{name} {i}");
            for outcome in outcomes.unwrap() {
                let value = outcome
                    .value()
                    .map_or("none".to_owned(), |value| format!("{:x}", value.to_bits()));
                let rule = outcome
                    .dominant_rule
                    .map_or("none".to_owned(), |rule| rule.to_string());
                lines += &format!(
                    " {value},{:x},{rule},{}",
                    outcome.coverage.to_bits(),
                    u8::from(outcome.clamped)
                );
            }
            lines.push('\n');
        }
    }
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("conformance.bits");
    if std::env::var_os("UPDATE_BITS").is_some() {
        std::fs::write(&path, &lines).unwrap();
    }
    let known = std::fs::read_to_string(&path).unwrap();
    for (known, now) in known.lines().zip(lines.lines()) {
        assert_eq!(known, now, "other bits; if they are meant: UPDATE_BITS=1");
    }
    assert_eq!(known.len(), lines.len());
}

/// Evaluates each case as a batch of equal rows, on one thread and on four. The last block and the last task of rows
/// are incomplete.
#[test]
fn batches_on_one_and_many_threads_have_the_bits_of_single_calls() {
    let pools = [1, 4].map(|threads| {
        rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap()
    });
    for case in corpus() {
        let engine = Engine::new(&case.model).unwrap();
        let single = bits(&engine.evaluate(&case.point).unwrap());
        let rows = if case.place.ends_with("1}") {
            9_001
        } else {
            11
        };
        let columns: Vec<Vec<f64>> = case.point.iter().map(|x| vec![*x; rows]).collect();
        let columns: Vec<&[f64]> = columns.iter().map(|column| &**column).collect();
        for pool in &pools {
            let batch = pool.install(|| engine.evaluate_batch(&columns).unwrap());
            for outcomes in batch.chunks(case.values.len()) {
                assert_eq!(bits(outcomes), single, "{}", case.place);
            }
        }
    }
}

/// Evaluates each case as a map over the first input, with the other inputs fixed at the point of the case.
#[test]
fn decision_maps_have_the_bits_of_single_calls() {
    for case in corpus() {
        let engine = Engine::new(&case.model).unwrap();
        let mut grid = Grid::new(&engine, 3).unwrap();
        for (name, x) in engine.input_names().zip(&case.point).skip(1) {
            grid = grid.fix(name, *x).unwrap();
        }
        for output in 0..case.values.len() {
            let map = DecisionMap::new(&engine, grid.clone(), output).unwrap();
            for cell in 0..map.grid().cells() {
                let mut point = case.point.clone();
                point[0] = map.grid().point(cell)[0];
                let single = engine.evaluate(&point).unwrap()[output];
                let value = map.value(cell).map(f64::to_bits);
                assert_eq!(value, single.value().map(f64::to_bits), "{}", case.place);
                assert_eq!(map.coverage(cell).to_bits(), single.coverage.to_bits());
                assert_eq!(map.dominant(cell), single.dominant_rule);
            }
        }
    }
}

/// `flagred eval` prints numbers that read back to the same bits.
#[test]
fn the_command_line_has_the_bits_of_single_calls() {
    let folder = flagred_tests::Folder::new();
    // One run for all cases of a rule set with the same operators.
    let mut runs: Vec<(String, Vec<Case>)> = Vec::new();
    for case in corpus() {
        let rule_set = fuzzy::yaml::to_string(&case.model);
        match runs.iter_mut().find(|(text, _)| *text == rule_set) {
            Some((_, cases)) => cases.push(case),
            None => runs.push((rule_set, vec![case])),
        }
    }
    for (rule_set, cases) in runs {
        let model = folder.file("model.yaml", rule_set);
        let engine = Engine::new(&cases[0].model).unwrap();
        let mut csv = engine.input_names().collect::<Vec<_>>().join(",") + "\n";
        for case in &cases {
            let row: Vec<String> = case.point.iter().map(f64::to_string).collect();
            csv += &(row.join(",") + "\n");
        }
        let points = folder.file("points.csv", csv);
        let output = flagred_tests::flagred()
            .arg("eval")
            .arg(&model)
            .arg(&points)
            .output()
            .unwrap();
        let printed = String::from_utf8(output.stdout).unwrap();
        let lines: Vec<&str> = printed.lines().skip(1).collect();
        assert_eq!(
            lines.len(),
            cases.len(),
            "{}",
            String::from_utf8_lossy(&output.stderr)
        );
        for (case, line) in cases.iter().zip(lines) {
            let single = engine.evaluate(&case.point).unwrap();
            let cells = line.split(',').skip(case.point.len());
            let read: Vec<Option<u64>> = cells
                .map(|cell| cell.parse().ok().map(f64::to_bits))
                .collect();
            let expected: Vec<Option<u64>> =
                single.iter().map(|o| o.value().map(f64::to_bits)).collect();
            assert_eq!(read, expected, "{}", case.place);
        }
    }
}
