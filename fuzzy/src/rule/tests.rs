use alloc::{boxed::Box, string::ToString, vec};

use proptest::prelude::*;

use super::*;

/// Returns a condition such as `x IS low`, or `x IS very low` with hedges.
fn is(variable: &str, hedges: &[Hedge], term: &str) -> Condition {
    Condition::Is(Proposition {
        variable: variable.into(),
        hedges: hedges.to_vec(),
        term: Some(term.into()),
    })
}

fn condition_of(text: &str) -> Condition {
    let rule = alloc::format!("IF {text} THEN z IS a");
    parse(&rule)
        .unwrap_or_else(|d| panic!("{rule}: {d}"))
        .condition
}

#[test]
fn not_binds_tighter_than_and_and_tighter_than_or() {
    let [a, b, c] = ["a", "b", "c"].map(|x| is(x, &[], "t"));
    assert_eq!(
        condition_of("a IS t OR b IS t AND c IS t"),
        Condition::Or(vec![a.clone(), Condition::And(vec![b.clone(), c.clone()])])
    );
    assert_eq!(
        condition_of("NOT a IS t AND b IS t"),
        Condition::And(vec![Condition::Not(Box::new(a.clone())), b.clone()])
    );
    assert_eq!(
        condition_of("(a IS t OR b IS t) AND c IS t"),
        Condition::And(vec![Condition::Or(vec![a, b]), c])
    );
}

#[test]
fn keywords_are_case_insensitive_and_names_are_not() {
    let rule = parse("if Margin Is Very NOT low # why\n tHeN risk is HIGH and note is x with 0.25")
        .unwrap();
    assert_eq!(
        rule.condition,
        is("Margin", &[Hedge::Very, Hedge::Not], "low")
    );
    assert_eq!(rule.weight, 0.25);
    assert_eq!(rule.consequents.len(), 2);
    assert_eq!(rule.consequents[0].term.span, 46..50);
    assert_eq!(
        rule.to_string(),
        "IF Margin IS very NOT low THEN risk IS HIGH AND note IS x WITH 0.25"
    );
}

#[test]
fn names_in_quotes_may_contain_anything() {
    for (written, name) in [
        ("\"wind speed\"", "wind speed"),
        ("'wind speed'", "wind speed"),
        ("\"is\"", "is"),
        (r#""a \"b\" \\ c\d""#, r#"a "b" \ c\d"#),
        ("été", "été"),
        ("m-1.x_%", "m-1.x_%"),
    ] {
        assert_eq!(
            condition_of(&alloc::format!("{written} IS low")),
            is(name, &[], "low")
        );
    }
}

#[test]
fn any_requires_no_term() {
    let bare = |hedges: &[Hedge]| {
        Condition::Is(Proposition {
            variable: "x".into(),
            hedges: hedges.to_vec(),
            term: None,
        })
    };
    assert_eq!(condition_of("x IS any"), bare(&[Hedge::Any]));
    assert_eq!(
        condition_of("(x IS very any)"),
        bare(&[Hedge::Very, Hedge::Any])
    );
    assert_eq!(condition_of("x IS any low"), is("x", &[Hedge::Any], "low"));
}

#[test]
fn every_mistake_has_a_position_and_help() {
    for (text, marked, message, help) in [
        (
            "",
            "",
            "expected `IF` at the start of a rule, found the end of the rule",
            "write the rule as `IF input",
        ),
        (
            "margin IS low",
            "margin",
            "expected `IF` at the start of a rule, found `margin`",
            "write `IF` before `margin`",
        ),
        (
            "IFmargin IS low THEN r IS h",
            "IFmargin",
            "expected `IF` at the start of a rule, found `IFmargin`",
            "write a space after `IF`",
        ),
        (
            "IF margin low THEN r IS h",
            "low",
            "expected `IS` after `margin`, found `low`",
            "write `margin IS low`",
        ),
        (
            "IF wind speed IS low THEN r IS h",
            "speed",
            "expected `IS` after `wind`, found `speed`",
            "in quotes",
        ),
        (
            "IF margin = low THEN r IS h",
            "=",
            "expected `IS` after `margin`, found `=`",
            "write `IS`",
        ),
        (
            "IF margin IS low & s IS low THEN r IS h",
            "&",
            "expected `AND`, `OR` or `THEN` after the condition, found `&`",
            "write `AND`",
        ),
        (
            "IF margin IS low ANd AND s IS low THEN r IS h",
            "AND",
            "expected an input name, `NOT` or `(`, found `AND`",
            "add a condition after `ANd`, or remove",
        ),
        (
            "IF margin IS low THNE r IS h",
            "THNE",
            "expected `AND`, `OR` or `THEN` after the condition, found `THNE`",
            "did you mean `THEN`?",
        ),
        (
            "IF margin IS THEN r IS h",
            "THEN",
            "expected a term or a hedge, found `THEN`",
            "add a term before `THEN`",
        ),
        (
            "IF margin IS very THEN r IS h",
            "THEN",
            "expected a term or a hedge, found `THEN`",
            "add a term before `THEN`",
        ),
        (
            "IF (margin IS low THEN r IS h",
            "(",
            "the bracket `(` is never closed",
            "add the closing bracket `)`",
        ),
        (
            "IF (margin IS low",
            "(",
            "the bracket `(` is never closed",
            "add the closing bracket `)`",
        ),
        (
            "IF (margin IS low s IS low) THEN r IS h",
            "s",
            "expected `AND`, `OR` or `)` after the condition, found `s`",
            "write `AND` before `s`",
        ),
        (
            "IF margin IS low) THEN r IS h",
            ")",
            "expected `AND`, `OR` or `THEN` after the condition, found `)`",
            "has no matching `(`",
        ),
        (
            "IF margin IS 'low THEN r IS h",
            "'low THEN r IS h",
            "the quoted name is never closed",
            "closing quote",
        ),
        (
            "IF '' IS low THEN r IS h",
            "''",
            "the name is empty",
            "between the quotes",
        ),
        (
            "IF margin IS low THEN r IS any h",
            "any",
            "`any` is not allowed after `THEN`",
            "write one of the terms of the output",
        ),
        (
            "IF margin IS low THEN r IS",
            "",
            "expected a term of the output, found the end of the rule",
            "add a term",
        ),
        (
            "IF margin IS low THEN",
            "",
            "expected an output name, found the end of the rule",
            "add a conclusion",
        ),
        (
            "IF margin IS low THEN r h",
            "h",
            "expected `IS` after `r`, found `h`",
            "write `r IS h`",
        ),
        (
            "IF margin IS low THEN r IS h OR r IS l",
            "OR",
            "expected `AND` or `WITH` after the conclusion, found `OR`",
            "instead of `OR`, write two rules",
        ),
        (
            "IF margin IS low THEN r IS h ELSE r IS l",
            "ELSE",
            "expected `AND` or `WITH` after the conclusion, found `ELSE`",
            "rules have no `ELSE`",
        ),
        (
            "IF margin IS low THEN r IS h WITH",
            "",
            "expected a number after `WITH`, found the end of the rule",
            "from 0 to 1",
        ),
        (
            "IF margin IS low THEN r IS h WITH nan",
            "nan",
            "expected a number after `WITH`, found `nan`",
            "from 0 to 1",
        ),
        (
            "IF margin IS low THEN r IS h WITH 80%",
            "80%",
            "expected a number after `WITH`, found `80%`",
            "write `WITH 0.8`",
        ),
        (
            "IF margin IS low THEN r IS h WITH 1.5",
            "1.5",
            "the weight `1.5` is outside [0, 1]",
            "firing strength",
        ),
        (
            "IF margin IS low THEN r IS h WITH -0.5",
            "-0.5",
            "the weight `-0.5` is outside [0, 1]",
            "firing strength",
        ),
        (
            "IF margin IS low THEN r IS h WITH 0.5 x",
            "x",
            "expected the end of the rule after the weight, found `x`",
            "remove everything after the weight",
        ),
        (
            "IF margin IS low ; THEN r IS h",
            ";",
            "expected `AND`, `OR` or `THEN` after the condition, found `;`",
            "remove the semicolon",
        ),
    ] {
        let found = parse(text).unwrap_err();
        assert_eq!(found.message, message, "{text}");
        assert_eq!(&text[found.span.clone()], marked, "{text}");
        let said = found.help.unwrap_or_default();
        assert!(
            said.contains(help) && said.is_empty() == help.is_empty(),
            "{text}: {said}"
        );
    }
}

#[test]
fn deep_nesting_is_an_error() {
    for open in ["(", "NOT ", "NOT ("] {
        let found = parse(&alloc::format!("IF {}", open.repeat(1 << 20))).unwrap_err();
        assert_eq!(found.code, "rule-too-deep");
    }
    let deep = |n: usize| alloc::format!("IF {}x IS a{} THEN y IS b", "(".repeat(n), ")".repeat(n));
    assert!(parse(&deep(DEEPEST_NESTING)).is_ok());
    assert!(parse(&deep(DEEPEST_NESTING + 1)).is_err());
}

fn any_name() -> impl Strategy<Value = Name> {
    prop_oneof![
        3 => "[a-z_][a-z0-9_.%-]{0,5}",
        1 => "(?i)(if|is|and|or|not|then|with|very|any)",
        1 => "\\PC{1,8}",
        1 => "[\"'\\\\#() \n]{1,4}",
    ]
    .prop_map(|text| Name::from(text.as_str()))
}

fn any_proposition() -> impl Strategy<Value = Proposition> {
    let hedges = proptest::collection::vec(proptest::sample::select(&Hedge::ALL[..]), 0..3);
    (
        any_name(),
        hedges,
        proptest::option::weighted(0.9, any_name()),
    )
        .prop_map(|(variable, mut hedges, term)| {
            if term.is_none() {
                hedges.push(Hedge::Any);
            }
            Proposition {
                variable,
                hedges,
                term,
            }
        })
}

/// Generates rules that can be written as text.
pub(crate) fn any_rule() -> impl Strategy<Value = Rule> {
    let condition = any_proposition()
        .prop_map(Condition::Is)
        .prop_recursive(5, 24, 3, |inner| {
            let several = proptest::collection::vec(inner.clone(), 2..4);
            prop_oneof![
                inner.prop_map(|c| Condition::Not(Box::new(c))),
                several.clone().prop_map(Condition::And),
                several.prop_map(Condition::Or),
            ]
        });
    let hedge = proptest::sample::select(&Hedge::ALL[..]).prop_filter("", |h| h.may_conclude());
    let hedges = proptest::collection::vec(hedge, 0..3);
    let consequent =
        (any_name(), hedges, any_name()).prop_map(|(output, hedges, term)| Consequent {
            output,
            hedges,
            term,
        });
    let consequents = proptest::collection::vec(consequent, 1..3);
    let weight = prop_oneof![Just(1.0), 0.0..=1.0];
    (condition, consequents, weight).prop_map(|(condition, consequents, weight)| Rule {
        condition,
        consequents,
        weight,
    })
}

proptest! {
    #[test]
    fn a_printed_rule_reads_back_as_the_same(rule in any_rule()) {
        let text = rule.to_string();
        let again = parse(&text);
        prop_assert_eq!(again.as_ref(), Ok(&rule), "{}", text);
    }

    #[test]
    fn any_text_is_a_rule_or_a_mistake_inside_it(text in "\\PC*") {
        if let Err(found) = parse(&text) {
            prop_assert!(text.get(found.span).is_some());
        }
    }

    #[test]
    fn any_words_are_a_rule_or_a_mistake_inside_them(
        words in proptest::collection::vec(proptest::sample::select(&[
            "IF", "THEN", "IS", "AND", "OR", "NOT", "WITH", "very", "any", "(", ")", "x", "'a b'", "\"", "0.5", "#\n", "é",
        ][..]), 0..20)
    ) {
        let text = words.join(" ");
        match parse(&text) {
            Ok(rule) => prop_assert_eq!(parse(&rule.to_string()), Ok(rule)),
            Err(found) => prop_assert!(text.get(found.span).is_some()),
        }
    }
}
