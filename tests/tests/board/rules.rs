//! Rule sets without a profile, in borrowed memory and exported to Rust and C: the outcomes are bitwise equal to those
//! of the engine.

use std::path::{Path, PathBuf};

use flagred::{
    board::{
        Evaluator, RuleMemory, Rules,
        table::{Outcome, PartialConjunction, State, StrongestRule},
    },
    plan,
};
use flagred_tests::{Folder, flagred};
use fuzzy::{Engine, Model};

use super::{assert_same, c};

/// The output of `flagred export --rust` for some rule sets.
mod exported {
    pub mod chain {
        include!("../../exported/rules_chain.rs");
    }
    pub mod sets {
        include!("../../exported/rules_sets.rs");
    }
    pub mod tipper {
        include!("../../exported/rules_tipper.rs");
    }
    pub mod type2 {
        include!("../../exported/rules_type2.rs");
    }
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// The rule sets of these tests: name and text.
fn rule_sets() -> Vec<(String, String)> {
    let mut found = Vec::new();
    for folder in [
        "tests/onboard",
        "tests/type2-onboard",
        "tests/conformance",
        "rules",
    ] {
        for entry in std::fs::read_dir(root().join(folder)).unwrap() {
            let path = entry.unwrap().path();
            if path
                .extension()
                .is_some_and(|extension| extension == "yaml")
            {
                let text = std::fs::read_to_string(&path).unwrap();
                let rules = text
                    .split_once("\n---\n")
                    .map_or(&*text, |(rules, _)| rules);
                let folder = folder.rsplit('/').next().unwrap();
                let name = path.file_stem().unwrap().to_str().unwrap();
                found.push((format!("{folder}_{name}"), format!("{rules}\n")));
            }
        }
    }
    found.sort();
    found
}

/// Points in and beyond the ranges of the inputs, and values that are not finite.
fn points(model: &Model) -> Vec<Vec<f64>> {
    let mut random = fastrand::Rng::with_seed(19);
    let mut points: Vec<Vec<f64>> = (0..1500)
        .map(|_| {
            let at = |input: &fuzzy::model::Variable| {
                let share = match random.u32(0..8) {
                    0 => f64::from(random.u32(0..=4)) / 4.0,
                    _ => 1.2 * random.f64() - 0.1,
                };
                input.low + share * (input.high - input.low)
            };
            model.inputs.iter().map(at).collect()
        })
        .collect();
    for odd in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        points.push(vec![odd; model.inputs.len()]);
    }
    points
}

/// Outcomes as text, bit for bit, in the format of `tests/c/evaluate.c`.
fn reported(outcomes: &[Outcome]) -> String {
    let bits = |value: f64| match value.is_nan() {
        true => "nan".to_owned(),
        false => format!("{:016x}", value.to_bits()),
    };
    let one = |outcome: &Outcome| {
        let state = match outcome.state {
            State::Defined(_) | State::Interval { .. } => 0,
            State::Default(_) => 1,
            State::NoRuleFired => 2,
            State::InputNotFinite => 3,
            State::Previous(_) => panic!("{outcome:?}"),
        };
        format!(
            "{state} {} {} {} {} {} {}",
            bits(outcome.value().unwrap_or(f64::NAN)),
            bits(outcome.low().unwrap_or(f64::NAN)),
            bits(outcome.high().unwrap_or(f64::NAN)),
            bits(outcome.coverage),
            outcome.dominant_rule.map_or(-1, |rule| rule as i64),
            i32::from(outcome.clamped)
        )
    };
    outcomes.iter().map(one).collect::<Vec<_>>().join(", ")
}

fn by_the_engine(engine: &Engine, points: &[Vec<f64>]) -> Vec<String> {
    let (mut scratch, outputs) = (engine.scratch(), engine.output_names().len());
    let outcomes = points.iter().map(|point| {
        let mut outcomes = vec![Outcome::default(); outputs];
        // If a required output has no value, the engine returns an error; here only the states of the outcomes are compared.
        let _ = engine.evaluate_with(&mut scratch, point, &mut outcomes);
        reported(&outcomes)
    });
    outcomes.collect()
}

fn lent(rules: &Rules<'_>, points: &[Vec<f64>]) -> Vec<String> {
    assert_eq!(rules.check(), Ok(()));
    let outputs = rules.outputs();
    let mut numbers = vec![0.0; rules.numbers()];
    let mut partials = vec![PartialConjunction::NONE; rules.partials()];
    let mut strongest = vec![StrongestRule::NONE; rules.table.outputs.len()];
    let [mut all, mut own] = [(); 2].map(|()| vec![Outcome::UNDEFINED; outputs]);
    let memory = RuleMemory {
        numbers: &mut numbers,
        partials: &mut partials,
        strongest: &mut strongest,
        outcomes: &mut all,
        own: &mut own,
    };
    let mut evaluator = Evaluator::new(rules, memory).unwrap();
    assert_eq!(evaluator.evaluate(&vec![0.0; rules.inputs() + 1]), None);
    let outcomes = points
        .iter()
        .map(|point| reported(evaluator.evaluate(point).unwrap()));
    outcomes.collect()
}

fn in_c(
    folder: &Folder,
    name: &str,
    text: &str,
    model: &Model,
    points: &[Vec<f64>],
) -> Vec<String> {
    let file = folder.file(&format!("{name}.yaml"), text);
    let of_c: String = model
        .name
        .chars()
        .map(|c| if c.is_ascii_alphanumeric() { c } else { '_' })
        .collect();
    let (mut command, _folder) = c::compiled(
        "tests/c/evaluate.c",
        name,
        &file,
        &[
            ("PLAN", &format!("flagred_rules_{of_c}")),
            ("MEMORY", &format!("FLAGRED_{}_MEMORY", of_c.to_uppercase())),
        ],
    );
    command.args([
        model.inputs.len().to_string(),
        model.outputs.len().to_string(),
    ]);
    c::written(command, &points.concat())
}

#[test]
fn rule_sets_agree_with_the_engine_in_borrowed_memory_and_in_c() {
    let (folder, mut refused, mut chains) = (Folder::new(), Vec::new(), 0);
    let mut intervals = 0;
    let rule_sets = rule_sets();
    for (name, text) in &rule_sets {
        let model: Model = text.parse().unwrap();
        let engine = Engine::new(&model).unwrap();
        let Ok(rules) = plan::rules(&engine) else {
            refused.push(name.as_str());
            continue;
        };
        chains += usize::from(!rules.stages.is_empty());
        intervals += usize::from(model.has_type2_terms());
        let points = points(&model);
        let expected = by_the_engine(&engine, &points);
        assert_same(&expected, &lent(&rules, &points), name);
        let found = in_c(&folder, name, text, &model, &points);
        assert_same(&expected, &found, &format!("{name} in C"));
    }
    assert!(chains >= 2 && intervals >= 2);
    assert!(rule_sets.len() >= 20, "{rule_sets:?}");
    // The centroid of singletons has no closed form.
    assert_eq!(refused, ["conformance_numbers"]);
}

#[test]
fn exported_rust_agrees_with_the_engine() {
    fn exported<const INPUTS: usize, const OUTPUTS: usize>(
        file: &str,
        evaluate: fn(&[f64; INPUTS]) -> [Outcome; OUTPUTS],
        exported: &str,
    ) {
        let path = root().join(file);
        let output = flagred()
            .args(["export", "--rust"])
            .arg(&path)
            .output()
            .unwrap();
        assert!(output.status.success(), "{output:?}");
        let text = String::from_utf8(output.stdout).unwrap();
        let path_of_export = root().join("tests/exported").join(exported);
        if std::env::var_os("UPDATE_EXPORTED").is_some() {
            std::fs::write(&path_of_export, &text).unwrap();
        }
        assert!(
            std::fs::read_to_string(&path_of_export).unwrap() == text,
            "{exported} is not what `flagred export --rust {file}` writes; UPDATE_EXPORTED=1 writes it anew"
        );
        let model: Model = std::fs::read_to_string(path).unwrap().parse().unwrap();
        let engine = Engine::new(&model).unwrap();
        let points = points(&model);
        let output = points
            .iter()
            .map(|point| reported(&evaluate(point[..].try_into().unwrap())));
        assert_same(
            &by_the_engine(&engine, &points),
            &output.collect::<Vec<_>>(),
            file,
        );
    }
    exported(
        "tests/onboard/chain.yaml",
        exported::chain::evaluate,
        "rules_chain.rs",
    );
    exported(
        "tests/onboard/sets.yaml",
        exported::sets::evaluate,
        "rules_sets.rs",
    );
    exported(
        "rules/tipper.yaml",
        exported::tipper::evaluate,
        "rules_tipper.rs",
    );
    exported(
        "tests/type2-onboard/numbers.yaml",
        exported::type2::evaluate,
        "rules_type2.rs",
    );
}

#[test]
fn a_rule_set_of_another_program_is_exported_as_its_import() {
    let folder = Folder::new();
    let fis = flagred()
        .args(["export", "--fis"])
        .arg(root().join("rules/tipper.yaml"))
        .output()
        .unwrap();
    let fis = folder.file("tipper.fis", fis.stdout);
    let imported = folder.at("imported.yaml");
    let status = flagred()
        .args(["import", &fis, "--output", &imported])
        .status();
    assert!(status.unwrap().success());
    for option in ["--rust", "--c"] {
        let [of_fis, of_import] = [&fis, &imported].map(|file| {
            let output = flagred().args(["export", option, file]).output().unwrap();
            assert!(output.status.success(), "{output:?}");
            String::from_utf8(output.stdout).unwrap()
        });
        assert!(
            of_fis.contains("`tipper`") && of_fis == of_import,
            "{of_fis}"
        );
    }
}

#[test]
fn rule_sets_that_keep_previous_values_are_refused_with_help() {
    let folder = Folder::new();
    let tipper = std::fs::read_to_string(root().join("rules/tipper.yaml")).unwrap();
    let refused = |with: &str, arguments: &[&str]| {
        let text = tipper.replace("when_no_rule_fires: undefined", with);
        assert!(text != tipper);
        let file = folder.file("odd.yaml", text);
        let output = flagred()
            .arg("export")
            .args(arguments)
            .arg(file)
            .output()
            .unwrap();
        (
            output.status.code(),
            String::from_utf8(output.stderr).unwrap(),
        )
    };
    for option in ["--rust", "--c"] {
        let (code, reported) = refused("when_no_rule_fires: previous", &[option]);
        assert_eq!(code, Some(3), "{reported}");
        assert!(
            reported.contains("output `tip` keeps its previous value")
                && reported.contains("help: "),
            "{reported}"
        );
        let (code, reported) = refused("samples: {midpoint: 100}", &[option]);
        assert_eq!(code, Some(3), "{reported}");
        assert!(
            reported.contains("no closed form") && reported.contains("`--lossy` drops `samples`"),
            "{reported}"
        );
        let (code, reported) = refused("samples: {midpoint: 100}", &[option, "--lossy"]);
        assert_eq!(code, Some(0), "{reported}");
        assert_eq!(
            reported,
            "warning: output `tip` is computed exactly, not from 100 samples\n"
        );
    }
    let output = flagred()
        .args(["export", "--c", "--lossy", "flagred"])
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2), "{output:?}");
}

#[test]
fn an_interval_without_a_closed_form_is_refused_with_help() {
    let sets = std::fs::read_to_string(root().join("tests/type2-onboard/sets.yaml")).unwrap();
    // The lower membership function of a Gaussian with an uncertain mean is a formula.
    let text = sets.replace(
        "{triangle: [0, 2, 5], lower_scale: 0.8, lower_lag: 0.3}",
        "{gaussian: {mean: [1, 2], sd: 1}}",
    );
    assert!(text != sets);
    let file = Folder::new();
    let path = file.file("formula.yaml", text);
    for option in ["--rust", "--c"] {
        let output = flagred().args(["export", option, &path]).output().unwrap();
        assert_eq!(output.status.code(), Some(3), "{output:?}");
        let reported = String::from_utf8(output.stderr).unwrap();
        assert!(
            reported.contains("the interval of output `speed` has no closed form")
                && reported.contains("help: use `implication: minimum`"),
            "{reported}"
        );
    }
}

#[test]
fn an_evaluation_that_takes_too_much_stack_is_refused_in_rust_and_uses_borrowed_memory_in_c() {
    let folder = Folder::new();
    let rules = "fuzzy: 1\nname: many\ninputs: {x: {range: [0, 1], partition: [a, b]}}\n\
        outputs: {y: {range: [0, 1], partition: [a, b]}}\nactivation: {highest: 2}\nrules:\n"
        .to_owned()
        + &"  - IF x IS a THEN y IS b\n".repeat(40_000);
    let file = folder.file("many.yaml", rules);
    let export = |option: &str| flagred().args(["export", option, &file]).output().unwrap();
    let refused = export("--rust");
    let reported = String::from_utf8(refused.stderr).unwrap();
    assert_eq!(refused.status.code(), Some(3), "{reported}");
    assert!(
        reported.contains("too much for a stack") && reported.contains("help: in C"),
        "{reported}"
    );
    assert!(export("--c").status.success());
}
