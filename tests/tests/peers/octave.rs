//! Octave's fuzzy-logic-toolkit and FIS.

use std::{fmt::Write, process::Command};

use fastrand::Rng;
use flagred_interchange::Format;
use flagred_tests::Folder;
use fuzzy::Model;

use super::{SHIPPED, model, run_peer, write};

/// A term in [0, 10]. Octave does not accept vertical flanks, and requires integer slopes of bells.
fn shape(rng: &mut Rng) -> String {
    let a = 5.0 * rng.f64();
    let (b, c) = (a + 0.5 + 2.0 * rng.f64(), a + 3.0 + 2.0 * rng.f64());
    match rng.usize(0..8) {
        0 => format!("{{triangle: [{a}, {b}, {c}]}}"),
        1 => format!("{{trapezoid: [{a}, {b}, {c}, {}]}}", c + 1.0),
        2 => format!("{{left_shoulder: [{a}, {b}]}}"),
        3 => format!("{{right_shoulder: [{a}, {b}]}}"),
        4 => format!("{{gaussian: {{mean: {b}, sd: {}}}}}", c - b),
        5 => format!("{{bell: {{center: {b}, width: {}, slope: 2}}}}", c - b),
        6 => format!("{{sigmoid: {{inflection: {b}, slope: {}}}}}", 3.0 - a),
        _ => format!("{{s_shape: [{a}, {c}]}}"),
    }
}

fn terms(rng: &mut Rng) -> String {
    let terms = (0..3).map(|i| format!("t{i}: {}", shape(rng)));
    terms.collect::<Vec<_>>().join(", ")
}

fn random(seed: u64) -> Model {
    let rng = &mut Rng::with_seed(seed);
    let mut one = |words: &[&'static str]| words[rng.usize(0..words.len())];
    let operators = [
        one(&["minimum", "product"]),
        one(&["maximum", "probabilistic_sum"]),
        one(&["minimum", "product"]),
        one(&["maximum", "probabilistic_sum"]),
    ];
    let [and, or, implication, aggregation] = operators;
    let output = match rng.bool() {
        true => format!("terms: {{{}}}", terms(rng)),
        false => "terms: {t0: {constant: 2}, t1: {linear: {a: 0.5, b: -0.25, constant: 1}}, t2: {constant: 7.5}}, \
                  defuzzifier: weighted_average"
            .to_owned(),
    };
    let mut text = format!(
        "fuzzy: 1\nname: random\ninputs:\n  a: {{range: [0, 10], terms: {{{}}}}}\n  b: {{range: [0, 10], terms: {{{}}}}}\n\
         outputs:\n  y: {{range: [0, 10], {output}}}\n\
         operators: {{and: {and}, or: {or}, implication: {implication}, aggregation: {aggregation}}}\nrules:\n",
        terms(rng),
        terms(rng)
    );
    for _ in 0..rng.usize(2..6) {
        let not = ["", "NOT "][rng.usize(0..2)];
        let join = ["AND", "OR"][rng.usize(0..2)];
        let weight = ["", " WITH 0.5"][rng.usize(0..2)];
        let [a, b, y] = [(); 3].map(|()| rng.usize(0..3));
        let _ = writeln!(
            text,
            "  - IF a IS {not}t{a} {join} b IS t{b} THEN y IS t{y}{weight}"
        );
    }
    model(&text)
}

#[test]
#[ignore = "needs Octave with the fuzzy-logic-toolkit: tests/peer/octave.sh"]
fn octave_computes_the_same_values_from_exported_files() {
    let folder = Folder::new();
    // Octave needs a tenth of a second for each point, so there are few.
    for (name, text) in SHIPPED {
        write(&folder, name, &model(text), Format::Fis, 4);
    }
    for seed in 0..30 {
        write(
            &folder,
            &format!("random-{seed}"),
            &random(seed),
            Format::Fis,
            4,
        );
    }
    let mut octave = Command::new("octave-cli");
    octave.arg("--quiet");
    run_peer(
        octave,
        "octave_peer.m",
        &folder,
        "33 rule sets, 0 outputs with other values",
    );
}
