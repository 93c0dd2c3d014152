//! fuzzylite's Python library and FLL.

use std::fmt::Write;

use fastrand::Rng;
use flagred_interchange::Format;
use flagred_tests::Folder;
use fuzzy::Model;

use super::{SHIPPED, model, python, run_peer, write};

/// A random shape over [0, 10] for a term of the variable `own`.
fn shape(rng: &mut Rng, own: &str) -> String {
    let mut places: Vec<f64> = (0..4).map(|_| (rng.f64() * 100.0).round() / 10.0).collect();
    places.sort_by(f64::total_cmp);
    let [a, b, c, d] = places[..] else {
        unreachable!()
    };
    let width = 0.5 + 2.0 * rng.f64();
    match rng.usize(0..13) {
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
        11 => format!("{{function: 'exp(-(({own} - {b}) / {width})^2)'}}"),
        10 => format!("{{spike: {{center: {b}, width: {width}}}}}"),
        _ => format!(
            "{{piecewise: [[{a}, 0], [{}, 1], [{}, 0.25]]}}",
            b + 0.5,
            c + 1.0
        ),
    }
}

fn terms(rng: &mut Rng, own: &str) -> String {
    let terms = (0..3).map(|i| format!("t{i}: {}", shape(rng, own)));
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
        "centroid" => format!("terms: {{{}}}, samples: {{midpoint: 400}}", terms(rng, "y")),
        weighted => format!(
            "terms: {{t0: {{constant: 2}}, t1: {{linear: {{a: 0.5, b: -0.25, constant: 1}}}}, t2: {{function: 'max(a - 2, -b) / (1 + abs(b)) + 3 * (a > b)'}}}}, defuzzifier: {weighted}"
        ),
    };
    let mut text = format!(
        "fuzzy: 1\nname: random\ninputs:\n  a: {{range: [0, 10], terms: {{{}}}}}\n  b: {{range: [0, 10], terms: {{{}}}}}\n\
         outputs:\n  y: {{range: [0, 10], {output}}}\n\
         operators: {{and: {and}, or: {or}, implication: {implication}, aggregation: {aggregation}}}\nrules:\n",
        terms(rng, "a"),
        terms(rng, "b")
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
    model(&text)
}

/// `FLAGRED_PYTHON` names a Python with pyfuzzylite.
#[test]
#[ignore = "needs Python with pyfuzzylite: tests/peer/fuzzylite.sh"]
fn pyfuzzylite_computes_the_same_values_from_exported_files() {
    let folder = Folder::new();
    for (name, text) in SHIPPED {
        write(&folder, name, &model(text), Format::Fll, 50);
    }
    for seed in 0..200 {
        write(
            &folder,
            &format!("random-{seed}"),
            &random(seed),
            Format::Fll,
            50,
        );
    }
    run_peer(
        python(),
        "fuzzylite_peer.py",
        &folder,
        "203 rule sets, 0 with other values",
    );
}
