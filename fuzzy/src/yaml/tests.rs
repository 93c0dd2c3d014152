use alloc::{format, string::ToString, vec::Vec};

use proptest::prelude::*;

use super::*;

fn scalar_of(node: &Node) -> &Scalar {
    match &node.value {
        Value::Scalar(scalar) => scalar,
        other => panic!("{other:?}"),
    }
}

/// Tests all styles of writing a rule, with the expected positions of its words.
#[test]
fn positions_in_a_scalar_are_found_in_every_style() {
    for text in [
        "a: IF margin IS low THEN risk IS high",
        "a: IF margin IS low\n   THEN risk\n\n   IS high # why",
        "a: 'IF margin IS low\n  THEN risk IS high'",
        "a: \"IF margin IS \\x6cow THEN\\\n   \\ risk IS \\u0068igh\"",
        "a: >-\n  IF margin IS low\n  THEN risk IS high\n",
        "a: |\n    IF margin IS low\n      THEN risk IS high\n",
        "é: [\"\\t\\\"IF\\\" margin IS low\", x]",
        "a: 'it''s IF margin IS low'",
    ] {
        let tree = read(text).unwrap();
        let Value::Mapping(entries) = &tree.value else {
            panic!("{tree:?}")
        };
        let scalar = match &entries[0].1.value {
            Value::List(items) => scalar_of(&items[0]),
            _ => scalar_of(&entries[0].1),
        };
        for word in ["IF", "margin", "THEN", "risk", "IS"] {
            if let Some(at) = scalar.text.find(word) {
                let place = scalar.span(at..at + word.len());
                assert_eq!(&text[place], word, "{text}");
            }
        }
        for (word, written) in [("low", "\\x6cow"), ("high", "\\u0068igh")] {
            if let Some(at) = scalar.text.find(word) {
                let found = &text[scalar.span(at..at + word.len())];
                assert!(found == word || found == written, "{text}: {found}");
            }
        }
    }
}

#[test]
fn a_text_that_is_not_a_document_is_one_finding_with_its_position() {
    for (text, position, code) in [
        ("", "1:1", "empty-file"),
        ("# nothing\n", "1:1", "empty-file"),
        ("a: [1, 2\nb: 3", "1:4", "yaml-syntax"),
        ("a: 'x", "1:4", "yaml-syntax"),
        ("a: b: c", "1:5", "yaml-syntax"),
        ("a: 1\n---\nb: 2", "2:1", "yaml-syntax"),
        ("a: !!float 1", "1:4", "yaml-syntax"),
        ("a: *b", "1:4", "yaml-syntax"),
        ("a: &a [*a]", "1:8", "yaml-syntax"),
        ("\0", "1:1", "yaml-syntax"),
    ] {
        let found = read(text).unwrap_err();
        assert_eq!(found.0.len(), 1, "{text:?}");
        let line = found.to_string();
        assert!(
            line.starts_with(&format!("{position}: error[{code}]")),
            "{text:?}: {line}"
        );
        assert!(found.0[0].help.is_some(), "{text:?}");
    }
}

#[test]
fn small_files_cannot_require_much_memory() {
    let mut bomb = "a0: &a0 [x, x, x, x, x, x, x, x, x, x]\n".to_string();
    for i in 1..20 {
        let last = format!("*a{}, ", i - 1).repeat(9);
        bomb += &format!("a{i}: &a{i} [{last}*a{}]\n", i - 1);
    }
    assert_eq!(read(&bomb).unwrap_err().0[0].code, "yaml-too-large");

    let mut chain = "a0: &a0 [x]\n".to_string();
    for i in 1..10_000 {
        chain += &format!("a{i}: &a{i} [*a{}]\n", i - 1);
    }
    assert_eq!(read(&chain).unwrap_err().0[0].code, "yaml-too-large");

    let long = format!(
        "a: &a {}\nb: [{}]\n",
        "x".repeat(100_000),
        "*a, ".repeat(1000)
    );
    assert_eq!(read(&long).unwrap_err().0[0].code, "yaml-too-large");

    for open in ["[", "{a: ", "- ", "? "] {
        let found = read(&open.repeat(200_000)).unwrap_err();
        assert_eq!(found.0[0].code, "yaml-syntax", "{open}");
    }
}

#[test]
fn aliases_have_the_value_of_their_anchor() {
    let tree = read("a: &x [1, {b: 2}]\nc: *x\n").unwrap();
    let Value::Mapping(entries) = &tree.value else {
        panic!("{tree:?}")
    };
    assert_eq!(entries[0].1, entries[1].1);
}

/// Generates trees without positions.
fn any_tree() -> impl Strategy<Value = Node> {
    let leaf = prop_oneof![
        any::<f64>().prop_map(Node::number),
        "\\PC{0,12}".prop_map(Node::text),
        "[ -~\\n\\t\\x00\\x7f\u{85}\u{2028}]{0,12}".prop_map(Node::text),
        proptest::sample::select(
            &[
                "true", "null", "~", "1", "- a", "a: b", "#", "", " ", "y", "é"
            ][..]
        )
        .prop_map(Node::text),
    ];
    leaf.prop_recursive(4, 30, 5, |inner| {
        prop_oneof![
            proptest::collection::vec(inner.clone(), 0..5).prop_map(Node::list),
            proptest::collection::vec(("\\PC{0,6}", inner), 0..5).prop_map(Node::mapping),
        ]
    })
}

/// Returns the content of the tree, without its positions.
fn meaning(node: &Node) -> serde_json::Value {
    serde_json::to_value(node).unwrap()
}

#[test]
fn a_finding_about_other_syntax_starts_after_unicode_blanks() {
    let text = "\u{2000}<a>";
    let found = parse(text).unwrap_err();
    assert_eq!(text.get(found.0[0].span.clone()), Some("<a>"));
}

proptest! {
    #[test]
    fn a_written_tree_reads_back_as_the_same(tree in any_tree()) {
        let text = to_text(&tree);
        match read(&text) {
            Ok(again) => prop_assert_eq!(meaning(&again), meaning(&tree), "{}", text),
            Err(found) => prop_assert!(tree.is_null(), "{}\n{}", text, found),
        }
    }

    #[test]
    fn any_text_is_read_or_refused(text in "\\PC*") {
        if let Err(found) = parse(&text) {
            for finding in found.0 {
                prop_assert!(text.get(finding.span).is_some());
            }
        }
    }

    #[test]
    fn any_yaml_like_text_is_read_or_refused(
        words in proptest::collection::vec(proptest::sample::select(&[
            "fuzzy: 1", "\n", "\n  ", "- ", "rules:", "inputs:", "outputs: ", "[", "]", "{", "}", ", ", ": ", "'", "\"",
            "IF x IS low THEN y IS high", "range: [0, 1]", "partition: [low, high]", "|\n", ">\n", "&a ", "*a", "é", "\\",
        ][..]), 0..40)
    ) {
        let text: Vec<&str> = words;
        let text = text.concat();
        if let Err(found) = parse(&text) {
            for finding in found.0 {
                prop_assert!(text.get(finding.span).is_some());
            }
        }
    }
}
