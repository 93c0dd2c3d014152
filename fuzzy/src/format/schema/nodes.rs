//! Building blocks of JSON Schemas.

use alloc::{format, string::String, vec::Vec};

use crate::tree::Node;

pub(super) type Entries = Vec<(String, Node)>;

pub(super) fn entry(key: &str, value: Node) -> (String, Node) {
    (key.into(), value)
}

pub(super) fn about<const N: usize>(description: &str, entries: [(&str, Node); N]) -> Node {
    let description = [("description", Node::text(description))];
    Node::mapping(description.into_iter().chain(entries))
}

pub(super) fn text(description: &str) -> Node {
    about(description, [("type", Node::text("string"))])
}

pub(super) fn number(description: &str) -> Node {
    about(description, [("type", Node::text("number"))])
}

pub(super) fn degree(description: &str) -> Node {
    let entries = [
        ("type", Node::text("number")),
        ("minimum", Node::number(0.0)),
        ("maximum", Node::number(1.0)),
    ];
    about(description, entries)
}

pub(super) fn whole(description: &str, least: f64) -> Node {
    about(
        description,
        [
            ("type", Node::text("integer")),
            ("minimum", Node::number(least)),
        ],
    )
}

pub(super) fn words<T>(description: &str, words: &[(&str, T)]) -> Node {
    let words = words.iter().map(|(word, _)| Node::text(*word));
    about(description, [("enum", Node::list(words.collect()))])
}

pub(super) fn list(description: &str, items: Node, least: Option<usize>) -> Node {
    let mut entries = Vec::from([
        ("description", Node::text(description)),
        ("type", Node::text("array")),
        ("items", items),
    ]);
    entries.extend(least.map(|least| ("minItems", Node::number(least as f64))));
    Node::mapping(entries)
}

/// Returns the schema of a list of `count` numbers.
pub(super) fn numbers(description: &str, count: usize) -> Node {
    let count = || Node::number(count as f64);
    about(
        description,
        [
            ("type", Node::text("array")),
            ("items", Node::mapping([("type", Node::text("number"))])),
            ("minItems", count()),
            ("maxItems", count()),
        ],
    )
}

/// Returns the schema of a mapping that allows only known keys.
pub(super) fn object<'a>(
    description: &str,
    properties: impl IntoIterator<Item = (&'a str, Node)>,
    required: &[&str],
) -> Entries {
    let required = required.iter().map(|key| Node::text(*key)).collect();
    Vec::from([
        entry("description", Node::text(description)),
        entry("type", Node::text("object")),
        entry("properties", Node::mapping(properties)),
        entry("required", Node::list(required)),
        entry("additionalProperties", no()),
    ])
}

pub(super) fn no() -> Node {
    Node::scalar("false".into(), false)
}

pub(super) fn reference(name: &str) -> Node {
    Node::mapping([("$ref", Node::text(format!("#/$defs/{name}")))])
}

pub(super) fn any_of(description: &str, options: Vec<Node>) -> Node {
    about(description, [("anyOf", Node::list(options))])
}

/// Returns the schema of a mapping whose keys are names that the author chooses. `of` is the name of the schema of the
/// values.
pub(super) fn named(description: &str, of: &str) -> Node {
    let entries = [
        ("type", Node::text("object")),
        ("additionalProperties", reference(of)),
    ];
    about(description, entries)
}

/// Returns the requirement that exactly one of two keys is present.
pub(super) fn one_of<const N: usize>(keys: [&str; N]) -> (String, Node) {
    let one = |key: &str| Node::mapping([("required", Node::list([Node::text(key)].into()))]);
    entry("oneOf", Node::list(keys.map(one).into()))
}
