use super::*;
use crate::edited;

const RULES: &str = "# My fan
fuzzy: 1
name: fan # short
inputs:
  heat:
    range: [0, 100]
    partition: {low: 10, # cold
      high: 90}
  haze: {range: [0, 1], partition: [thin, thick]} # even
  wind:
    range: [0, 20]
    partition:
    - calm # nothing
    - \"a gale\"
  load:
    range: [-5, 5]
    terms:
      small: {triangle: [-5, -2.50, 5], height: 0.5}
      near: {gaussian: {sd: 1, mean: 0}}
      wide: {cosine: {center: 0, width: 4}}
      odd: {piecewise: [[-5, 0], [0, 1], [0, 0.25]]}
outputs:
  speed: {range: [0, 9], terms: {slow: {constant: 2}, fast: {linear: {heat: 1}}}, defuzzifier: weighted_average}
rules:
  - IF heat IS low THEN speed IS slow # why
";

fn document(text: &str) -> Document {
    Document::new(text, |_| None)
}

/// The text after a handle was moved.
fn after(text: &str, term: (usize, usize), handle: usize, to: (f64, f64)) -> String {
    let document = document(text);
    edited(text, &moved(&document, term, handle, to).unwrap())
}

#[test]
fn handles_are_at_the_parameters() {
    let document = document(RULES);
    assert!(!document.findings().has_errors(), "{}", document.findings());
    let places = |variable, term| -> Vec<(&str, f64, f64, f64, f64)> {
        let handles = of(&document, variable, term).into_iter();
        handles
            .map(|h| (h.name, h.x, h.degree, h.low, h.high))
            .collect()
    };
    assert_eq!(places(0, 0), [("peak", 10.0, 1.0, 0.0, 89.9)]);
    assert_eq!(places(1, 1)[0].1, 1.0);
    assert_eq!(
        places(3, 0),
        [
            ("left", -5.0, 0.0, -5.0, -2.5),
            ("peak", -2.5, 0.5, -5.0, 5.0),
            ("right", 5.0, 0.0, -2.5, 5.0)
        ]
    );
    let sd = places(3, 1)[1];
    assert_eq!((sd.0, sd.1), ("sd", 1.0));
    assert!((sd.2 - (-0.5f64).exp()).abs() < 1e-12);
    assert_eq!(places(3, 2)[1].1, 2.0);
    assert_eq!(places(3, 3)[2], ("point", 0.0, 0.25, 0.0, 5.0));
    assert_eq!(places(4, 0), [("value", 2.0, 1.0, 0.0, 9.0)]);
    assert_eq!(places(4, 1), []);
    assert_eq!(places(9, 0), []);
}

#[test]
fn moving_a_handle_changes_one_number_only() {
    for (term, handle, to, old, new) in [
        ((0, 0), 0, (33.333333, 0.0), "{low: 10,", "{low: 33.3,"),
        ((3, 0), 1, (-2.0, 0.0), "-2.50", "-2"),
        ((3, 0), 1, (99.0, 0.0), "-2.50", "5"),
        ((3, 1), 0, (0.5, 0.0), "mean: 0}", "mean: 0.5}"),
        ((3, 1), 1, (-2.0, 0.0), "sd: 1,", "sd: 0.01,"),
        ((3, 1), 1, (2.5, 0.0), "sd: 1,", "sd: 2.5,"),
        ((3, 2), 1, (1.5, 0.0), "width: 4", "width: 3"),
        ((3, 3), 2, (1.0, 0.5), "[0, 0.25]", "[1, 0.5]"),
        ((4, 0), 0, (2.5, 0.0), "constant: 2}", "constant: 2.5}"),
    ] {
        let expected = RULES.replacen(old, new, 1);
        assert_eq!(after(RULES, term, handle, to), expected, "{old}");
    }
}

#[test]
fn an_even_partition_gets_its_peaks_and_keeps_its_comments() {
    let flow = RULES.replace("[thin, thick]", "{thin: 0.25, thick: 1}");
    assert_eq!(after(RULES, (1, 0), 0, (0.25, 0.0)), flow);
    let block = RULES
        .replace("    - calm # nothing", "      calm: 0 # nothing")
        .replace("    - \"a gale\"", "      \"a gale\": 12");
    assert_eq!(after(RULES, (2, 1), 0, (12.0, 0.0)), block);
}

#[test]
fn every_handle_of_the_shipped_rule_sets_moves() {
    for known in flagred::shipped::RULE_SETS {
        let document = document(known.text);
        let model = document.model().unwrap();
        let variables = model.inputs.iter();
        let variables = variables.chain(model.outputs.iter().map(|o| &o.variable));
        let mut count = 0;
        for (v, variable) in variables.enumerate() {
            for t in 0..variable.terms.len() {
                for (h, handle) in of(&document, v, t).into_iter().enumerate() {
                    let to = (handle.low + handle.high) / 2.0;
                    let edits = moved(&document, (v, t), h, (to, 0.5)).unwrap();
                    let text = edited(known.text, &edits);
                    assert!(text.parse::<fuzzy::Model>().is_ok(), "{}", handle.name);
                    let lines = |text: &str| text.lines().count();
                    assert_eq!(lines(&text), lines(known.text));
                    count += 1;
                }
            }
        }
        assert!(count > 10);
    }
}

#[test]
fn a_handle_that_cannot_move_reports_the_reason() {
    let shared = RULES
        .replace("near: {", "near: &n {")
        .replace("wide: {cosine: {center: 0, width: 4}}", "wide: *n");
    let refused = moved(&document(&shared), (3, 1), 0, (1.0, 0.0)).unwrap_err();
    assert!(refused.contains("shared with other places"), "{refused}");
    assert!(moved(&document(RULES), (3, 0), 1, (f64::NAN, 0.0)).is_err());
    assert!(moved(&document(RULES), (3, 0), 7, (0.0, 0.0)).is_err());
    assert!(moved(&document("flagred: 1\n"), (0, 0), 0, (0.0, 0.0)).is_err());
}

#[test]
fn a_mistake_elsewhere_does_not_prevent_moving_a_handle() {
    let text = RULES
        .replace("range: [0, 1]", "range: 1")
        .replace("IF heat", "IF heatt");
    assert!(document(&text).findings().has_errors());
    let expected = text.replace("{low: 10,", "{low: 20,");
    assert_eq!(after(&text, (0, 0), 0, (20.0, 0.0)), expected);
}
