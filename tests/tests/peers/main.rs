//! Other programs read the exported rule sets and compute the same values. `tests/peer` contains the scripts that run them.

#![allow(clippy::unwrap_used, clippy::panic)]

mod fuzzylite;
mod octave;
mod pyit2fls;

use std::{path::Path, process::Command};

use fastrand::Rng;
use flagred_interchange::{Format, Losses};
use flagred_tests::Folder;
use fuzzy::{Engine, Model};

/// Shipped rule sets.
const SHIPPED: [(&str, &str); 3] = [
    ("tipper", include_str!("../../../rules/tipper.yaml")),
    ("flagred", include_str!("../../../rules/flagred.yaml")),
    (
        "flagred-paper",
        include_str!("../../../rules/flagred-paper.yaml"),
    ),
];

fn model(text: &str) -> Model {
    text.parse()
        .unwrap_or_else(|findings| panic!("{text}\n{findings}"))
}

/// Writes a rule set in a format, and a table of its values at this many points spread over its inputs. Points where rules hardly
/// fire are skipped, because programs differ there.
fn write(folder: &Folder, name: &str, model: &Model, format: Format, points: usize) {
    let written = flagred_interchange::write(model, format, Losses::Refuse);
    let written = written.unwrap_or_else(|findings| panic!("{name}: {findings}"));
    // fuzzylite samples the set, and so does the rule set that is read back from the written text. Therefore the
    // expected values are those of that rule set.
    let read = flagred_interchange::read(&written.text, format, Losses::Refuse).unwrap();
    let engine = Engine::new(&read.model).unwrap();
    let names = engine.input_names().chain(engine.output_names());
    let mut table = names.collect::<Vec<_>>().join(",") + "\n";
    let (mut rng, mut rows) = (Rng::with_seed(7), 0);
    for _ in 0..20 * points {
        let at = |input: &fuzzy::model::Variable| input.low + (input.high - input.low) * rng.f64();
        let inputs: Vec<f64> = read.model.inputs.iter().map(at).collect();
        let outcomes = engine.evaluate(&inputs).unwrap();
        if outcomes.iter().any(|outcome| outcome.coverage < 1e-3) {
            continue;
        }
        let values = outcomes.iter().map(|outcome| outcome.value());
        let cells = inputs.iter().map(f64::to_string);
        let cells =
            cells.chain(values.map(|value| value.map_or("NA".into(), |value| value.to_string())));
        table += &(cells.collect::<Vec<_>>().join(",") + "\n");
        rows += 1;
        if rows == points {
            break;
        }
    }
    assert!(rows > points / 4, "{name}: {rows} points");
    folder.file(&format!("{name}.{}", format.ending()), written.text);
    folder.file(&format!("{name}.csv"), table);
}

/// Runs a script of `tests/peer` on a folder, and compares its output.
fn run_peer(mut program: Command, script: &str, folder: &Folder, expected: &str) {
    let script = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("peer")
        .join(script);
    let output = program.arg(script).arg(folder.path()).output().unwrap();
    let reported = String::from_utf8_lossy(&output.stdout);
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{reported}{errors}");
    assert!(reported.contains(expected), "{reported}");
}

/// The Python that `FLAGRED_PYTHON` names.
fn python() -> Command {
    Command::new(std::env::var("FLAGRED_PYTHON").unwrap_or_else(|_| "python3".to_owned()))
}
