//! The table of docs/interchange.md: which content of a rule set each format supports. Every cell is measured: a rule
//! set is written and read back, and the two rule sets are compared. `UPDATE_DOCUMENTS=1` writes the table.

#![allow(
    clippy::expect_used,
    clippy::panic,
    clippy::print_stdout,
    clippy::unwrap_used,
    reason = "helpers of tests fail by panics, and tell what fails"
)]

use std::{fs, path::Path};

use flagred_interchange::{Format, Losses};
use fuzzy::{Engine, Model};

/// A rule set with a placeholder for each part that a feature changes.
const BASE: &str = "
fuzzy: 1
name: base
inputs:
  a: {range: [0, 10], terms: {low: {triangle: [0, 2, 6]}, high: <TERM>}}
  b: {range: [-1, 1], terms: {low: {triangle: [-1, -0.5, 0.5]}, high: {triangle: [-0.5, 0.5, 1]}}}
outputs:
  y: {range: [0, 9], <OUTPUT>}
operators: {and: <AND>, or: <OR>, implication: <IMPLICATION>, aggregation: <AGGREGATION>}
<RULES>
";

/// The placeholders of [`BASE`], and their default texts.
const PLACES: [(&str, &str); 8] = [
    (
        "RULES",
        "rules: [<RULE>, IF a IS high OR b IS low THEN y IS large]",
    ),
    ("TERM", "{triangle: [3, 7, 10]}"),
    (
        "OUTPUT",
        "terms: {small: {triangle: [0, 2, 4]}, large: {triangle: [3, 6, 9]}}",
    ),
    ("AND", "minimum"),
    ("OR", "maximum"),
    ("IMPLICATION", "minimum"),
    ("AGGREGATION", "maximum"),
    ("RULE", "IF a IS low AND b IS low THEN y IS small"),
];

/// A feature, its placeholder, and the text for it.
const FEATURES: &[(&str, &str, &str)] = &[
    (
        "triangles, trapezoids",
        "TERM",
        "{trapezoid: [3, 5, 8, 10]}",
    ),
    ("shoulders", "TERM", "{right_shoulder: [3, 8]}"),
    ("`rectangle`", "TERM", "{rectangle: [3, 8]}"),
    (
        "`piecewise`",
        "TERM",
        "{piecewise: [[3, 0], [5, 0.5], [8, 1]]}",
    ),
    ("`gaussian`", "TERM", "{gaussian: {mean: 7, sd: 2}}"),
    (
        "`gaussian2`",
        "TERM",
        "{gaussian2: {left_mean: 6, left_sd: 2, right_mean: 7, right_sd: 1}}",
    ),
    ("`bell`", "TERM", "{bell: {center: 7, width: 2, slope: 3}}"),
    ("`sigmoid`", "TERM", "{sigmoid: {inflection: 5, slope: 2}}"),
    (
        "`sigmoid_difference`",
        "TERM",
        "{sigmoid_difference: {left_inflection: 3, left_slope: 2, right_inflection: 8, right_slope: 2}}",
    ),
    (
        "`sigmoid_product`",
        "TERM",
        "{sigmoid_product: {left_inflection: 3, left_slope: 2, right_inflection: 8, right_slope: -2}}",
    ),
    ("`s_shape`, `z_shape`", "TERM", "{s_shape: [3, 8]}"),
    ("`pi_shape`", "TERM", "{pi_shape: [3, 5, 6, 8]}"),
    ("`cosine`", "TERM", "{cosine: {center: 6, width: 6}}"),
    ("`spike`", "TERM", "{spike: {center: 6, width: 6}}"),
    ("`concave`", "TERM", "{concave: {inflection: 5, end: 9}}"),
    ("`arc`, `semi_ellipse`", "TERM", "{semi_ellipse: [3, 9]}"),
    (
        "a formula as a membership function",
        "TERM",
        "{function: exp(-((a - 7) / 2)^2)}",
    ),
    (
        "the height of a term",
        "TERM",
        "{triangle: [3, 7, 10], height: 0.5}",
    ),
    ("`and: product`", "AND", "product"),
    (
        "`and: bounded_difference`, `drastic`, `einstein`, `hamacher`",
        "AND",
        "einstein",
    ),
    ("`and: nilpotent_minimum`", "AND", "nilpotent_minimum"),
    ("`or: probabilistic_sum`", "OR", "probabilistic_sum"),
    (
        "`or: bounded_sum`, `drastic`, `einstein`, `hamacher`",
        "OR",
        "bounded_sum",
    ),
    ("`implication: product`", "IMPLICATION", "product"),
    (
        "`aggregation: probabilistic_sum`, `bounded_sum`",
        "AGGREGATION",
        "bounded_sum",
    ),
    ("`aggregation: sum`", "AGGREGATION", "sum"),
    (
        "`bisector`, maxima",
        "OUTPUT",
        "terms: {small: {triangle: [0, 2, 4]}, large: {triangle: [3, 6, 9]}}, defuzzifier: bisector",
    ),
    (
        "`weighted_average` of constants",
        "OUTPUT",
        "terms: {small: {constant: 2}, large: {constant: 6}}, defuzzifier: weighted_average",
    ),
    (
        "`weighted_average` of `linear` terms",
        "OUTPUT",
        "terms: {small: {constant: 2}, large: {linear: {a: 0.5, b: -1, constant: 1}}}, defuzzifier: weighted_average",
    ),
    (
        "`weighted_average` of formulas",
        "OUTPUT",
        "terms: {small: {constant: 2}, large: {function: 'max(a, 1) - 2 * b^2'}}, defuzzifier: weighted_average",
    ),
    (
        "`weighted_sum`",
        "OUTPUT",
        "terms: {small: {constant: 2}, large: {constant: 6}}, defuzzifier: weighted_sum",
    ),
    (
        "`tsukamoto`",
        "OUTPUT",
        "terms: {small: {left_shoulder: [1, 5]}, large: {right_shoulder: [3, 8]}}, defuzzifier: tsukamoto",
    ),
    (
        "a value if no rule fires",
        "OUTPUT",
        "terms: {small: {triangle: [0, 2, 4]}, large: {triangle: [3, 6, 9]}}, when_no_rule_fires: {value: 1}",
    ),
    (
        "OR in one rule",
        "RULE",
        "IF a IS low OR b IS high THEN y IS small",
    ),
    (
        "AND and OR in one rule",
        "RULE",
        "IF a IS low AND (b IS low OR b IS high) THEN y IS small",
    ),
    (
        "`IS NOT`",
        "RULE",
        "IF a IS NOT low AND b IS low THEN y IS small",
    ),
    (
        "NOT before brackets, dual operators",
        "RULE",
        "IF NOT (a IS low AND b IS low) THEN y IS small",
    ),
    (
        "`very`",
        "RULE",
        "IF a IS very low AND b IS low THEN y IS small",
    ),
    (
        "`extremely`",
        "RULE",
        "IF a IS extremely low AND b IS low THEN y IS small",
    ),
    (
        "several hedges",
        "RULE",
        "IF a IS NOT very low AND b IS low THEN y IS small",
    ),
    ("`any`", "RULE", "IF a IS any AND b IS low THEN y IS small"),
    (
        "a hedge in a conclusion",
        "RULE",
        "IF a IS low AND b IS low THEN y IS very small",
    ),
    (
        "`activation`",
        "RULES",
        "activation: {highest: 1}\nrules: [IF a IS low THEN y IS small, IF a IS high OR b IS low THEN y IS large]",
    ),
    (
        "`blocks` with operators of their own",
        "RULES",
        "blocks: {one: {operators: {and: product}, rules: [IF a IS low AND b IS low THEN y IS small]}, two: {rules: [IF a IS high OR b IS low THEN y IS large]}}",
    ),
    (
        "`when_no_rule_fires: previous`",
        "OUTPUT",
        "terms: {small: {triangle: [0, 2, 4]}, large: {triangle: [3, 6, 9]}}, when_no_rule_fires: previous",
    ),
    (
        "`clamp`",
        "OUTPUT",
        "terms: {small: {constant: 2}, large: {constant: 12}}, defuzzifier: weighted_sum, clamp: true",
    ),
    (
        "a weight",
        "RULE",
        "IF a IS low AND b IS low THEN y IS small WITH 0.25",
    ),
];

fn rule_set(place: &str, text: &str) -> Model {
    let mut rules = BASE.to_owned();
    for (known, plain) in PLACES {
        rules = rules.replace(
            &format!("<{known}>"),
            if known == place { text } else { plain },
        );
    }
    rules
        .parse()
        .unwrap_or_else(|findings| panic!("{text}: {findings}"))
}

/// Returns `carried` if the rule set that is read back gives the same values, `refused` if the format cannot represent
/// the model.
fn measured(model: &Model, format: Format) -> &'static str {
    let Ok(written) = flagred_interchange::write(model, format, Losses::Refuse) else {
        return "refused";
    };
    let document = flagred_interchange::read(&written.text, format, Losses::Refuse)
        .unwrap_or_else(|findings| panic!("{}: {findings}\n{}", format.name(), written.text));
    let mut again = document.model;
    for (before, after) in model.outputs.iter().zip(&mut again.outputs) {
        after.samples = before.samples;
        // FIS does not define a value for points where no rule fires.
        if format == Format::Fis {
            assert_eq!(before.when_no_rule_fires, after.when_no_rule_fires);
        }
    }
    let engines = [model, &again].map(|model| Engine::new(model).unwrap());
    for i in 0..=40 {
        for j in 0..=20 {
            let inputs = [f64::from(i) * 0.25, f64::from(j) * 0.1 - 1.0];
            let [before, after] = engines
                .each_ref()
                .map(|engine| engine.evaluate(&inputs).unwrap()[0]);
            let same = match (before.value(), after.value()) {
                (Some(before), Some(after)) => (before - after).abs() < 1e-9,
                (before, after) => before == after,
            };
            assert!(
                same,
                "{}: {inputs:?}: {before:?} {after:?}\n{}",
                format.name(),
                written.text
            );
        }
    }
    "carried"
}

#[test]
fn the_documented_table_of_features_is_measured() {
    let mut table =
        String::from("| in a rule set | FIS | FLL | FCL | FML |\n|---|---|---|---|---|\n");
    for (feature, place, text) in FEATURES {
        let model = rule_set(place, text);
        let cells = Format::ALL.map(|format| measured(&model, format));
        table += &format!("| {feature} | {} |\n", cells.join(" | "));
    }
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/interchange.md");
    let document = fs::read_to_string(&path).unwrap();
    let start = document
        .find("| in a rule set |")
        .expect("the table begins");
    let end = start
        + document[start..]
            .find("\n\n")
            .map_or(document.len() - start, |at| at + 1);
    if std::env::var_os("UPDATE_DOCUMENTS").is_some() {
        fs::write(
            &path,
            format!("{}{table}{}", &document[..start], &document[end..]),
        )
        .unwrap();
        return;
    }
    assert_eq!(&document[start..end], table, "run with UPDATE_DOCUMENTS=1");
}
