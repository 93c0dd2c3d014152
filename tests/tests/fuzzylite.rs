//! fuzzylite reads the rule sets that are written for it, and computes the same values.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::{fmt::Write, process::Command};

use fastrand::Rng;
use flagred_tests::Folder;
use fuzzy::{Engine, Model};
use interchange::{Format, Losses};

const PEER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/peer/fuzzylite_peer.py");

/// Rule sets that come with the program.
const SHIPPED: [(&str, &str); 3] = [
    ("tipper", include_str!("../../rules/tipper.yaml")),
    ("flagred", include_str!("../../rules/flagred.yaml")),
    (
        "flagred-paper",
        include_str!("../../rules/flagred-paper.yaml"),
    ),
];

/// A shape over [0, 10].
fn shape(rng: &mut Rng) -> String {
    let mut places: Vec<f64> = (0..4).map(|_| (rng.f64() * 100.0).round() / 10.0).collect();
    places.sort_by(f64::total_cmp);
    let [a, b, c, d] = places[..] else {
        unreachable!()
    };
    let width = 0.5 + 2.0 * rng.f64();
    match rng.usize(0..12) {
        0 => format!("{{triangle: [{a}, {b}, {c}]}}"),
        1 => format!("{{trapezoid: [{a}, {b}, {c}, {d}]}}"),
        2 => format!("{{left_shoulder: [{a}, {}]}}", b + 1.0),
        3 => format!("{{right_shoulder: [{a}, {}]}}", b + 1.0),
        4 => format!("{{gaussian: {{mean: {b}, sd: {width}}}}}"),
        5 => format!("{{bell: {{center: {b}, width: {width}, slope: 2}}}}"),
        6 => format!("{{sigmoid: {{inflection: {c}, slope: {width}}}}}"),
        7 => format!("{{s_shape: [{a}, {}]}}", b + 1.0),
        8 => format!("{{z_shape: [{a}, {}]}}", b + 1.0),
        9 => format!("{{cosine: {{center: {b}, width: {}}}}}", 2.0 + width),
        10 => format!("{{spike: {{center: {b}, width: {width}}}}}"),
        _ => format!(
            "{{piecewise: [[{a}, 0], [{}, 1], [{}, 0.25]]}}",
            b + 0.5,
            c + 1.0
        ),
    }
}

fn terms(rng: &mut Rng) -> String {
    let terms = (0..3).map(|i| format!("t{i}: {}", shape(rng)));
    terms.collect::<Vec<_>>().join(", ")
}

fn condition(rng: &mut Rng) -> String {
    let one = |rng: &mut Rng| {
        let hedge = [
            "",
            "",
            "",
            "very ",
            "somewhat ",
            "NOT ",
            "extremely ",
            "seldom ",
        ];
        let hedge = hedge[rng.usize(0..hedge.len())];
        format!(
            "{} IS {hedge}t{}",
            ["a", "b"][rng.usize(0..2)],
            rng.usize(0..3)
        )
    };
    let (x, y, z) = (one(rng), one(rng), one(rng));
    match rng.usize(0..4) {
        0 => x,
        1 => format!("{x} AND {y}"),
        2 => format!("{x} OR {y} AND {z}"),
        _ => format!("({x} OR {y}) AND {z}"),
    }
}

fn random(seed: u64) -> Model {
    let rng = &mut Rng::with_seed(seed);
    let mut one = |words: &[&'static str]| words[rng.usize(0..words.len())];
    let and = one(&[
        "minimum",
        "product",
        "bounded_difference",
        "einstein",
        "hamacher",
    ]);
    let or = one(&[
        "maximum",
        "probabilistic_sum",
        "bounded_sum",
        "einstein",
        "hamacher",
    ]);
    let implication = one(&["minimum", "product"]);
    let aggregation = one(&["maximum", "probabilistic_sum", "sum"]);
    let output = match one(&["centroid", "centroid", "weighted_average", "weighted_sum"]) {
        "centroid" => format!("terms: {{{}}}, samples: {{midpoint: 400}}", terms(rng)),
        weighted => format!(
            "terms: {{t0: {{constant: 2}}, t1: {{linear: {{a: 0.5, b: -0.25, constant: 1}}}}, t2: {{constant: 7.5}}}}, defuzzifier: {weighted}"
        ),
    };
    let mut text = format!(
        "fuzzy: 1\nname: random\ninputs:\n  a: {{range: [0, 10], terms: {{{}}}}}\n  b: {{range: [0, 10], terms: {{{}}}}}\n\
         outputs:\n  y: {{range: [0, 10], {output}}}\n\
         operators: {{and: {and}, or: {or}, implication: {implication}, aggregation: {aggregation}}}\nrules:\n",
        terms(rng),
        terms(rng)
    );
    for _ in 0..rng.usize(1..6) {
        let weight = ["", " WITH 0.5"][rng.usize(0..2)];
        writeln!(
            text,
            "  - IF {} THEN y IS t{}{weight}",
            condition(rng),
            rng.usize(0..3)
        )
        .unwrap();
    }
    text.parse()
        .unwrap_or_else(|findings| panic!("{text}\n{findings}"))
}

/// Writes a rule set, and its values at points that are spread over its inputs.
fn write(folder: &Folder, name: &str, model: &Model) {
    let written = interchange::write(model, Format::Fll, Losses::Refuse);
    let written = written.unwrap_or_else(|findings| panic!("{name}: {findings}"));
    // What is not sampled is sampled there: the values are those of the text as it is read again.
    let read = interchange::read(&written.text, Format::Fll, Losses::Refuse).unwrap();
    let engine = Engine::new(&read.model).unwrap();
    let names = engine.input_names().chain(engine.output_names());
    let mut table = names.collect::<Vec<_>>().join(",") + "\n";
    let mut rng = Rng::with_seed(7);
    for _ in 0..50 {
        let inputs = read
            .model
            .inputs
            .iter()
            .map(|input| input.low + (input.high - input.low) * rng.f64());
        let inputs: Vec<f64> = inputs.collect();
        let outcomes = engine.evaluate(&inputs).unwrap();
        // Here a strength below 1e-12 fires no rule, there every one above 0 does.
        if outcomes.iter().any(|outcome| outcome.coverage < 1e-3) {
            continue;
        }
        let values = outcomes.iter().map(|outcome| outcome.value());
        let cells = inputs.iter().map(f64::to_string);
        let cells =
            cells.chain(values.map(|value| value.map_or("NA".into(), |value| value.to_string())));
        table += &(cells.collect::<Vec<_>>().join(",") + "\n");
    }
    folder.file(&format!("{name}.fll"), written.text);
    folder.file(&format!("{name}.csv"), table);
}

/// `FLAGRED_PYTHON` names a Python that has pyfuzzylite.
#[test]
#[ignore = "needs Python with pyfuzzylite: tests/peer/fuzzylite.sh"]
fn pyfuzzylite_computes_the_values_of_what_is_written_for_it() {
    let folder = Folder::new();
    for (name, text) in SHIPPED {
        write(
            &folder,
            name,
            &text.parse().unwrap_or_else(|findings| panic!("{findings}")),
        );
    }
    for seed in 0..200 {
        write(&folder, &format!("random-{seed}"), &random(seed));
    }
    let python = std::env::var("FLAGRED_PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let output = Command::new(python)
        .arg(PEER)
        .arg(folder.path())
        .output()
        .unwrap();
    let told = String::from_utf8(output.stdout).unwrap();
    let errors = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success(), "{told}{errors}");
    assert!(
        told.contains("203 rule sets, 0 with other values"),
        "{told}"
    );
}
