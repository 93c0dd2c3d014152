use super::*;
use crate::starter;

const FLOW: &str = "fuzzy: 1
name: fan
inputs: {heat: {range: [0, 100], partition: [low, high]}} # one
outputs: {speed: {range: [0, 9], partition: {slow: 1, fast: 8}}}
rules: [IF heat IS high THEN speed IS fast]
";

fn text_after(
    text: &str,
    edits: impl FnOnce(&Document) -> Result<Vec<Edit>, String>,
) -> Result<String, String> {
    let document = Document::new(text, |_| None);
    let after = edited(text, &edits(&document)?);
    let read = Document::new(&*after, |_| None);
    assert!(
        !read.findings().has_errors(),
        "{after}\n{}",
        read.findings()
    );
    Ok(after)
}

fn starter() -> String {
    starter::rules("fan")
}

#[test]
fn a_new_term_is_placed_in_the_widest_gap() {
    let after = text_after(&starter(), |d| add_term(d, 0, "tropical")).unwrap();
    assert_eq!(
        after,
        starter().replace("cold: 10,", "tropical: 5, cold: 10,")
    );
    let after = text_after(&starter(), |d| add_term(d, 1, "wet")).unwrap();
    let damp = "damp: {right_shoulder: [40, 60]} # 0 up to 40, 1 from 60 on\n";
    assert_eq!(
        after,
        starter().replace(
            damp,
            &format!("{damp}      wet: {{triangle: [0, 25, 50]}}\n")
        )
    );
    let after = text_after(&starter(), |d| add_term(d, 2, "slower")).unwrap();
    let fast = "fast: {constant: 100}\n";
    assert_eq!(
        after,
        starter().replace(fast, &format!("{fast}      slower: {{constant: 25}}\n"))
    );
    let after = text_after(FLOW, |d| add_term(d, 0, "extreme")).unwrap();
    assert_eq!(after, FLOW.replace("[low, high]", "[low, high, extreme]"));
    let after = text_after(FLOW, |d| add_term(d, 1, "medium")).unwrap();
    assert_eq!(
        after,
        FLOW.replace("slow: 1, fast", "slow: 1, medium: 4.5, fast")
    );
}

#[test]
fn variables_are_added_behind_the_others() {
    let after = text_after(&starter(), |d| add_variable(d, "noise", (0.0, 60.0), false)).unwrap();
    let added = "  noise:\n    range: [0, 60]\n    partition: [low, high]\n";
    assert_eq!(
        after,
        starter().replace("1 from 60 on\n", &format!("1 from 60 on\n{added}"))
    );
    let after = text_after(&starter(), |d| add_variable(d, "light", (0.0, 1.0), true));
    let after = after.unwrap();
    assert!(after.contains("  light:\n    range: [0, 1]\n    terms: {low: {constant: 0}, high: {constant: 1}}\n    defuzzifier: weighted_average\n"), "{after}");
    let after = text_after(FLOW, |d| add_variable(d, "noise", (0.0, 60.0), false)).unwrap();
    assert_eq!(
        after,
        FLOW.replace(
            "high]}} # one",
            "high]}, noise: {range: [0, 60], partition: [low, high]}} # one"
        )
    );
}

#[test]
fn rules_are_added_changed_and_removed() {
    let rule = "IF humidity IS dry THEN fan IS slow";
    let after = text_after(&starter(), |d| add_rule(d, rule)).unwrap();
    assert_eq!(after, format!("{}  - {rule}\n", starter()));
    let after = text_after(&starter(), |d| change_rule(d, 3, rule)).unwrap();
    assert_eq!(
        after,
        starter().replace(
            "IF temperature IS hot AND humidity IS damp THEN fan IS fast,",
            &format!("{rule},")
        )
    );
    let after = text_after(&starter(), |d| remove(d, Part::Rule(1))).unwrap();
    assert_eq!(
        after,
        starter().replace(
            "  - IF temperature IS mild AND humidity IS damp THEN fan IS medium\n",
            ""
        )
    );
    let one = "IF heat IS high THEN speed IS fast";
    let document = Document::new(FLOW, |_| None);
    assert_eq!(
        edited(FLOW, &remove(&document, Part::Rule(0)).unwrap()),
        FLOW.replace(one, "")
    );
    let block = FLOW.replace(&format!(" [{one}]"), &format!("\n  # why\n  - {one}"));
    let document = Document::new(&*block, |_| None);
    let empty = edited(&block, &remove(&document, Part::Rule(0)).unwrap());
    assert_eq!(empty, FLOW.replace(&format!("[{one}]"), "[]\n  # why"));
    let after = text_after(&empty, |d| add_rule(d, one)).unwrap();
    assert!(after.contains(&format!("rules:\n  - {one}\n")), "{after}");
}

#[test]
fn terms_and_variables_used_by_a_rule_are_not_removed() {
    let refused = |part| text_after(&starter(), |d| remove(d, part)).unwrap_err();
    assert_eq!(
        refused(Part::Variable(0)),
        "the rules 1, 2, 3, 4, 5 use `temperature`; remove or change them first"
    );
    assert_eq!(
        refused(Part::Term(1, 0)),
        "rule 3 uses `dry`; remove or change it first"
    );
    let with_light =
        text_after(&starter(), |d| add_variable(d, "noise", (0.0, 60.0), false)).unwrap();
    assert_eq!(
        text_after(&with_light, |d| remove(d, Part::Variable(2))).unwrap(),
        starter()
    );
    let with_term = text_after(FLOW, |d| add_term(d, 1, "medium")).unwrap();
    assert_eq!(
        text_after(&with_term, |d| remove(d, Part::Term(1, 1))).unwrap(),
        FLOW
    );
    let three = text_after(FLOW, |d| add_term(d, 0, "extreme")).unwrap();
    assert_eq!(
        text_after(&three, |d| remove(d, Part::Term(0, 2))).unwrap(),
        FLOW
    );
    let refused = text_after(FLOW, |d| remove(d, Part::Term(0, 0))).unwrap_err();
    assert_eq!(refused, "`heat` needs two terms");
}

#[test]
fn bad_names_ranges_and_rules_are_refused() {
    let refused =
        |run: fn(&Document) -> Result<Vec<Edit>, String>| text_after(&starter(), run).unwrap_err();
    assert!(refused(|d| add_term(d, 0, "a b")).contains("not a name"));
    assert_eq!(
        refused(|d| add_term(d, 0, "cold")),
        "the name `cold` is already used"
    );
    assert_eq!(
        refused(|d| add_variable(d, "fan", (0.0, 1.0), false)),
        "the name `fan` is already used"
    );
    assert!(refused(|d| add_variable(d, "noise", (1.0, 0.0), false)).contains("smaller one first"));
    assert!(!refused(|d| add_rule(d, "IF heat")).is_empty());
}
