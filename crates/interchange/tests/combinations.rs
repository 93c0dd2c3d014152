//! Random rule sets: the written text is read back with the same values, or writing is refused. Text written with
//! losses can at least be read.

#![allow(
    clippy::expect_used,
    clippy::panic,
    clippy::print_stdout,
    clippy::unwrap_used,
    reason = "helpers of tests fail by panics, and tell what fails"
)]

use flagred_interchange::{Format, Losses};
use fuzzy::{Engine, Model};

/// Names that some format cannot write, or writes in the same way as another name.
const NAMES: [&str; 30] = [
    "3d",
    "two words",
    "two  words",
    "two_words",
    "two words_2",
    "if",
    "END_VAR",
    "end_ruleblock",
    "pi",
    "x",
    "a:b",
    "it's",
    "its",
    "say \"hi\"",
    "100%",
    "größe",
    "max",
    "very",
    "NC",
    "b#c",
    "-",
    "term",
    "RANGE",
    "é",
    "rule",
    "a.b",
    "MF1",
    "(",
    "function",
    "=",
];

/// Shapes over the range [0, 10]; `@` is the name of the variable.
const SHAPES: [&str; 22] = [
    "triangle: [0, 2, 6]",
    "triangle: [1, 1, 7]",
    "trapezoid: [1, 2, 3, 7]",
    "left_shoulder: [2, 8]",
    "right_shoulder: [1, 9]",
    "rectangle: [3, 8]",
    "piecewise: [[3, 0], [5, 0.5], [8, 1]]",
    "gaussian: {mean: 7, sd: 2}",
    "gaussian2: {left_mean: 6, left_sd: 2, right_mean: 7, right_sd: 1}",
    "bell: {center: 7, width: 2, slope: 3}",
    "sigmoid: {inflection: 5, slope: -2}",
    "sigmoid_difference: {left_inflection: 3, left_slope: 2, right_inflection: 8, right_slope: 3}",
    "sigmoid_product: {left_inflection: 3, left_slope: 2, right_inflection: 8, right_slope: -2}",
    "s_shape: [3, 8]",
    "z_shape: [2, 6]",
    "pi_shape: [3, 5, 5, 7]",
    "cosine: {center: 6, width: 6}",
    "spike: {center: 6, width: 6}",
    "concave: {inflection: 5, end: 9}",
    "semi_ellipse: [3, 9]",
    "arc: [3, 9]",
    "function: \"exp(-((@ - 7) / 2)^2)\"",
];

const MONOTONE: [&str; 4] = [
    "left_shoulder: [1, 5]",
    "right_shoulder: [3, 8]",
    "s_shape: [2, 9]",
    "piecewise: [[0, 0], [5, 0.5], [9, 1]]",
];

/// A deterministic random number generator.
struct Random(u64);

impl Random {
    fn below(&mut self, count: usize) -> usize {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % count
    }

    fn one<'a>(&mut self, of: &[&'a str]) -> &'a str {
        of[self.below(of.len())]
    }

    /// True with a probability of 1 in `count`.
    fn once_in(&mut self, count: usize) -> bool {
        self.below(count) == 0
    }
}

/// A text in YAML quotes.
fn yaml(text: &str) -> String {
    format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\""))
}

/// A name in the quotes of rules and formulas.
fn quoted(name: &str) -> String {
    format!("'{}'", name.replace('\\', "\\\\").replace('\'', "\\'"))
}

/// The name of a variable, and the names of its terms.
struct Variable(String, Vec<String>);

fn rule_set(random: &mut Random) -> String {
    // Half of the rule sets have only content that every format supports, apart from names and shapes.
    let is_plain = random.once_in(2);
    let mut names: Vec<&str> = NAMES.to_vec();
    let mut name = |random: &mut Random| match random.once_in(2) {
        true => names.swap_remove(random.below(names.len())).to_owned(),
        false => format!("n{}", random.below(1_000_000)),
    };
    let mut variable = |random: &mut Random| {
        let own = name(random);
        Variable(own, vec![name(random), name(random)])
    };
    let inputs = [variable(random), variable(random)];
    let outputs: Vec<Variable> = (0..=random.below(2)).map(|_| variable(random)).collect();
    let mut text = format!("fuzzy: 1\nname: {}\ninputs:\n", yaml(&name(random)));
    for Variable(own, terms) in &inputs {
        text += &format!("  {}: {{range: [0, 10], terms: {{", yaml(own));
        for term in terms {
            let shapes = if is_plain { &SHAPES[..7] } else { &SHAPES[..] };
            let shape = random.one(shapes).replace('@', &quoted(own));
            let shape = if !is_plain && random.once_in(15) {
                "constant: 0.5"
            } else {
                &shape
            };
            let height = if !is_plain && random.once_in(8) {
                ", height: 0.5"
            } else {
                ""
            };
            text += &format!("{}: {{{shape}{height}}}, ", yaml(term));
        }
        text += "}}\n";
    }
    text += "outputs:\n";
    let mut reads_sets = vec![];
    for Variable(own, terms) in &outputs {
        let [a, b] = [&inputs[0].0, &inputs[1].0];
        let kind = random.below(6);
        reads_sets.push(kind < 2);
        let fuzzy = [
            "centroid",
            "centroid",
            "bisector",
            "smallest_of_maxima",
            "mean_of_maxima",
            "largest_of_maxima",
        ];
        let defuzzifier = match kind {
            0 | 1 => random.one(&fuzzy),
            2 => random.one(&["centroid", "mean_of_maxima", "largest_of_maxima"]),
            3 | 4 => random.one(&["weighted_average", "weighted_sum"]),
            _ => "tsukamoto",
        };
        text += &format!(
            "  {}: {{range: [0, 10], defuzzifier: {defuzzifier}, terms: {{",
            yaml(own)
        );
        for term in terms {
            let shape = match kind {
                0 | 1 if is_plain => random.one(&SHAPES[..7]).to_owned(),
                0 | 1 => random.one(&SHAPES).replace('@', &quoted(own)),
                2 => format!("singleton: {}", random.below(10)),
                3 | 4 => match random.below(4) {
                    0 => format!(
                        "linear: {{{}: 1.5, {}: -0.25, constant: 2}}",
                        yaml(a),
                        yaml(b)
                    ),
                    1 => format!(
                        "function: {}",
                        yaml(&format!("max({}, 1) - 2 * {}^2", quoted(a), quoted(b)))
                    ),
                    _ => format!("constant: {}", random.below(40) as f64 - 15.0),
                },
                _ => random.one(&MONOTONE).to_owned(),
            };
            let height = if !is_plain && random.once_in(8) {
                ", height: 0.5"
            } else {
                ""
            };
            text += &format!("{}: {{{shape}{height}}}, ", yaml(term));
        }
        text += "}";
        if !is_plain && random.once_in(3) {
            text += ", when_no_rule_fires: ";
            text += random.one(&["{value: 3}", "previous", "{previous: 4}"]);
        }
        if !is_plain && random.once_in(6) {
            text += ", clamp: true";
        }
        if !is_plain && random.once_in(6) {
            text += ", aggregation: sum";
        }
        text += "}\n";
    }
    let and = random.one(&[
        "minimum",
        "product",
        "einstein",
        "bounded_difference",
        "nilpotent_minimum",
    ]);
    let or = random.one(&["maximum", "probabilistic_sum", "bounded_sum"]);
    let implication = random.one(&["minimum", "product", "hamacher"]);
    let aggregation = random.one(&["maximum", "sum", "probabilistic_sum", "bounded_sum"]);
    text += &format!(
        "operators: {{and: {and}, or: {or}, implication: {implication}, aggregation: {aggregation}}}\n"
    );
    if !is_plain && random.once_in(8) {
        text += "least_strength: 0.2\n";
    }
    if !is_plain && random.once_in(8) {
        text += random.one(&[
            "activation: {highest: 1}\n",
            "activation: {threshold: {at_least: 0.3}}\n",
        ]);
    }
    let mut rules = vec![];
    for _ in 0..2 + random.below(3) {
        let mut read: Vec<&Variable> = inputs.iter().collect();
        if !is_plain && random.once_in(8) && reads_sets[0] {
            read.push(&outputs[0]);
        }
        let condition = match is_plain {
            true => {
                let [a, b] = [&inputs[0], &inputs[1]].map(|Variable(own, terms)| {
                    let not = random.one(&["", "NOT "]);
                    format!(
                        "{} IS {not}{}",
                        quoted(own),
                        quoted(&terms[random.below(2)])
                    )
                });
                format!("{a} {} {b}", random.one(&["AND", "OR"]))
            }
            false => condition(random, &read, 2),
        };
        let own = if outputs.len() > 1 {
            random.below(outputs.len())
        } else {
            0
        };
        let Variable(output, terms) = &outputs[own];
        let hedge = match is_plain {
            true => "",
            false => random.one(&["", "", "", "", "", "very "]),
        };
        let term = quoted(&terms[random.below(2)]);
        let weight = random.one(&["", "", " WITH 0.25"]);
        rules.push(format!(
            "IF {condition} THEN {} IS {hedge}{term}{weight}",
            quoted(output)
        ));
    }
    let listed = |rules: &[String]| {
        let rules: Vec<String> = rules.iter().map(|rule| yaml(rule)).collect();
        rules.join(", ")
    };
    if !is_plain && random.once_in(6) {
        let (first, second) = rules.split_at(1);
        let names = [name(random), name(random)].map(|name| yaml(&name));
        let [first, second] = [listed(first), listed(second)];
        text += &format!(
            "blocks: {{{}: {{rules: [{first}]}}, {}: {{operators: {{and: product}}, rules: [{second}]}}}}\n",
            names[0], names[1]
        );
    } else {
        text += &format!("rules: [{}]\n", listed(&rules));
    }
    text
}

fn condition(random: &mut Random, read: &[&Variable], depth: usize) -> String {
    if depth > 0 && random.once_in(2) {
        let (a, b) = (
            condition(random, read, depth - 1),
            condition(random, read, depth - 1),
        );
        let (and, not) = (
            random.one(&["AND", "AND", "OR"]),
            random.one(&["", "", "", "NOT "]),
        );
        return format!("{not}({a} {and} {b})");
    }
    let Variable(own, terms) = read[random.below(read.len())];
    let hedge = random.one(&[
        "",
        "",
        "",
        "NOT ",
        "very ",
        "somewhat ",
        "NOT very ",
        "extremely ",
    ]);
    format!(
        "{} IS {hedge}{}",
        quoted(own),
        quoted(&terms[random.below(terms.len())])
    )
}

/// The values of all outputs at the points of a grid.
fn values(model: &Model, context: &str) -> Vec<Option<f64>> {
    let engine = Engine::new(model).unwrap_or_else(|findings| panic!("{findings}\n{context}"));
    let points =
        (0..=10).flat_map(|i| (0..=6).map(move |j| [f64::from(i) * 0.993, f64::from(j) * 1.639]));
    points
        .flat_map(|point| engine.evaluate(&point).unwrap())
        .map(|outcome| outcome.value())
        .collect()
}

fn check(rounds: usize) {
    let mut random = Random(11);
    let (mut used, mut carried) = (0, [0; 4]);
    while used < rounds {
        let text = rule_set(&mut random);
        let Ok(model) = text.parse::<Model>() else {
            continue;
        };
        if Engine::new(&model).is_err() {
            continue;
        }
        used += 1;
        let expected = values(&model, &text);
        for format in Format::ALL {
            if let Ok(written) = flagred_interchange::write(&model, format, Losses::Accept) {
                let context = format!("{text}\nwith losses:\n{}", written.text);
                let read = flagred_interchange::read(&written.text, format, Losses::Accept);
                let document = read.unwrap_or_else(|findings| panic!("{findings}\n{context}"));
                let valid = document.validate(&written.text);
                valid.unwrap_or_else(|findings| panic!("{findings}\n{context}"));
            }
            let Ok(written) = flagred_interchange::write(&model, format, Losses::Refuse) else {
                continue;
            };
            carried[format as usize] += 1;
            let context = format!("{text}\n{}", written.text);
            let read = flagred_interchange::read(&written.text, format, Losses::Refuse);
            let mut again = read
                .unwrap_or_else(|findings| panic!("{findings}\n{context}"))
                .model;
            for (before, after) in model.outputs.iter().zip(&mut again.outputs) {
                after.samples = before.samples;
            }
            let found = values(&again, &context);
            for (index, (before, after)) in expected.iter().zip(&found).enumerate() {
                let same = match (before, after) {
                    (Some(before), Some(after)) => (before - after).abs() < 1e-9,
                    (before, after) => before == after,
                };
                assert!(same, "{index}: {before:?} {after:?}\n{context}");
            }
        }
    }
    println!("{carried:?} of {used}");
    assert!(
        carried.iter().all(|&count| count >= used / 20),
        "{carried:?} of {used}"
    );
}

#[test]
fn random_rule_sets_are_written_and_read_with_the_same_values_or_refused() {
    check(200);
}

#[test]
#[ignore = "takes minutes"]
fn five_thousand_random_rule_sets_are_written_and_read() {
    check(5_000);
}
