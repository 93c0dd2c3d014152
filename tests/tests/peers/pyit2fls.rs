//! PyIT2FLS reads FCL, of which it supports points, AND and `COG`, and evaluates interval type-2 rule sets by sampling.

use std::fmt::Write;

use fastrand::Rng;
use flagred_interchange::Format;
use flagred_tests::Folder;
use fuzzy::{Engine, Model};

use super::{SHIPPED, model, python, run_peer, write};

fn random(seed: u64) -> Model {
    let rng = &mut Rng::with_seed(seed);
    let mut terms = || {
        let places = [(); 3].map(|()| 4.0 * rng.f64());
        let [a, b, c] = places;
        format!(
            "low: {{left_shoulder: [{a}, {}]}}, middle: {{triangle: [{b}, {}, {}]}}, high: {{right_shoulder: [{}, {}]}}",
            a + 3.0,
            b + 3.0,
            b + 6.0,
            c + 2.0,
            c + 5.0
        )
    };
    let [a, b, y] = [(); 3].map(|()| terms());
    let mut text = format!(
        "fuzzy: 1\nname: random\ninputs:\n  a: {{range: [0, 10], terms: {{{a}}}}}\n  b: {{range: [0, 10], terms: {{{b}}}}}\n\
         outputs:\n  y: {{range: [0, 10], terms: {{{y}}}}}\nrules:\n"
    );
    let words = ["low", "middle", "high"];
    for a in words {
        for b in words {
            let not = ["", "NOT "][rng.usize(0..2)];
            let y = words[rng.usize(0..3)];
            let _ = writeln!(text, "  - IF a IS {a} AND b IS {not}{b} THEN y IS {y}");
        }
    }
    model(&text)
}

#[test]
#[ignore = "needs Python with pyit2fls: tests/peer/pyit2fls.sh"]
fn pyit2fls_computes_the_same_values_from_exported_files() {
    let folder = Folder::new();
    let (name, text) = SHIPPED[2];
    write(&folder, name, &model(text), Format::Fcl, 50);
    for seed in 0..20 {
        write(
            &folder,
            &format!("random-{seed}"),
            &random(seed),
            Format::Fcl,
            50,
        );
    }
    run_peer(
        python(),
        "pyit2fls_peer.py",
        &folder,
        "21 rule sets, 0 with other values",
    );
}

/// An upper and a lower triangle, as PyIT2FLS takes them.
type Term = [[f64; 4]; 2];

fn interval_terms(rng: &mut Rng) -> Vec<Term> {
    let term = |i: u8| {
        let peak = 1.0 + 4.0 * f64::from(i) + rng.f64();
        let (left, right) = (peak - 2.5 - 3.0 * rng.f64(), peak + 2.5 + 3.0 * rng.f64());
        let narrow = 0.2 + 0.5 * rng.f64();
        let lower = [
            peak - narrow * (peak - left),
            peak,
            peak + narrow * (right - peak),
            0.5 + 0.5 * rng.f64(),
        ];
        [[left, peak, right, 1.0], lower]
    };
    (0..3).map(term).collect()
}

/// A random interval type-2 rule set as JSON for `pyit2fls_type2_peer.py`, with the engine's intervals at some points.
fn interval_rule_set(seed: u64) -> String {
    let rng = &mut Rng::with_seed(seed);
    let [a, b, y] = [(); 3].map(|()| interval_terms(rng));
    let is_product = rng.bool();
    let rules: Vec<[usize; 3]> = (0..9).map(|i| [i / 3, i % 3, rng.usize(0..3)]).collect();
    let written = |terms: &[Term]| {
        let function = |[left, peak, right, height]: [f64; 4]| {
            format!("{{triangle: [{left}, {peak}, {right}], height: {height}}}")
        };
        let terms = terms.iter().enumerate().map(|(i, [upper, lower])| {
            format!(
                "t{i}: {{upper: {}, lower: {}}}",
                function(*upper),
                function(*lower)
            )
        });
        format!(
            "{{range: [0, 10], terms: {{{}}}}}",
            terms.collect::<Vec<_>>().join(", ")
        )
    };
    let mut text = format!(
        "fuzzy: 1\nname: random\ninputs: {{a: {}, b: {}}}\noutputs: {{y: {}}}\n",
        written(&a),
        written(&b),
        written(&y)
    );
    if is_product {
        text += "operators: {and: product, implication: product}\n";
    }
    text += "rules:\n";
    for [a, b, y] in &rules {
        let _ = writeln!(text, "  - IF a IS t{a} AND b IS t{b} THEN y IS t{y}");
    }
    let engine = Engine::new(&model(&text)).unwrap();
    let points: Vec<[f64; 4]> = (0..5)
        .map(|_| {
            // The points are near the peaks of terms, so that a lower firing strength is above 0.
            let [x, z] = [&a, &b].map(|terms| {
                let peak = terms[rng.usize(0..3)][0][1];
                (peak + 0.4 * (rng.f64() - 0.5)).clamp(0.0, 10.0)
            });
            let outcome = engine.evaluate(&[x, z]).unwrap()[0];
            [x, z, outcome.low().unwrap(), outcome.high().unwrap()]
        })
        .collect();
    let system = serde_json::json!({
        "a": a, "b": b, "y": y, "product": is_product, "rules": rules, "points": points,
    });
    system.to_string()
}

/// Writes random interval type-2 rule sets with their intervals.
fn interval_rule_sets() -> Folder {
    let folder = Folder::new();
    for seed in 0..10 {
        folder.file(&format!("random-{seed}.json"), interval_rule_set(seed));
    }
    folder
}

#[test]
#[ignore = "needs Python with pyit2fls: tests/peer/pyit2fls.sh"]
fn the_samples_of_pyit2fls_approach_our_intervals() {
    let expected = "10 rule sets, 0 numbers of samples with other intervals";
    let folder = interval_rule_sets();
    run_peer(python(), "pyit2fls_type2_peer.py", &folder, expected);
}

#[test]
#[ignore = "needs Python, and takes a minute: tests/peer/pyit2fls.sh"]
fn intervals_computed_with_fractions_equal_ours() {
    let expected = "100 ends of intervals";
    run_peer(python(), "type2_peer.py", &interval_rule_sets(), expected);
}
