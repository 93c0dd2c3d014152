//! PyIT2FLS and FCL: it supports points, AND and `COG`.

use std::fmt::Write;

use fastrand::Rng;
use flagred_interchange::Format;
use flagred_tests::Folder;
use fuzzy::Model;

use super::{SHIPPED, ask, model, python, write};

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
    ask(
        python(),
        "pyit2fls_peer.py",
        &folder,
        "21 rule sets, 0 with other values",
    );
}
