//! Benchmarks of reading and writing a rule set with 5,000 rules over six inputs, in the file formats of other
//! programs.

use std::fmt::Write;

use divan::{Bencher, black_box, counter::ItemsCount};
use flagred_interchange::{Format, Losses};
use fuzzy::Model;

fn main() {
    divan::main();
}

const RULES: usize = 5_000;

/// Returns a rule set with six inputs of five terms each.
fn model() -> Model {
    let mut text = String::from("fuzzy: 1\nname: large\ninputs:\n");
    for input in 0..6 {
        let _ = writeln!(
            text,
            "  x{input}: {{range: [0, 1], partition: [a, b, c, d, e]}}"
        );
    }
    text += "outputs:\n  y: {range: [0, 1], partition: [a, b, c, d, e]}\nrules:\n";
    for rule in 0..RULES {
        let term = |input: u32| ["a", "b", "c", "d", "e"][rule / 5_usize.pow(input) % 5];
        let condition = (0..6).map(|input| format!("x{input} IS {}", term(input)));
        let condition = condition.collect::<Vec<_>>().join(" AND ");
        let _ = writeln!(text, "  - IF {condition} THEN y IS {}", term(2));
    }
    text.parse().unwrap()
}

const FORMATS: [&str; 4] = ["fis", "fll", "fcl", "fml"];

fn format_of(ending: &str) -> Format {
    Format::ALL
        .into_iter()
        .find(|format| format.ending() == ending)
        .unwrap()
}

#[divan::bench(args = FORMATS, sample_count = 20)]
fn read_5000_rules(bencher: Bencher<'_, '_>, ending: &str) {
    let format = format_of(ending);
    let written = flagred_interchange::write(&model(), format, Losses::Refuse).unwrap();
    bencher.counter(ItemsCount::new(RULES)).bench(|| {
        flagred_interchange::read(black_box(&written.text), format, Losses::Refuse).unwrap()
    });
}

#[divan::bench(args = FORMATS, sample_count = 20)]
fn write_5000_rules(bencher: Bencher<'_, '_>, ending: &str) {
    let (model, format) = (model(), format_of(ending));
    bencher
        .counter(ItemsCount::new(RULES))
        .bench(|| flagred_interchange::write(black_box(&model), format, Losses::Refuse).unwrap());
}
