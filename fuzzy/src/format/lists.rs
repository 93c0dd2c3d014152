//! Inputs, outputs, terms and blocks as lists of named entries: `[{name: heat, range: [0, 40], ...}]`.
//!
//! Some formats sort the keys of a mapping, and the order of these parts has a meaning: inputs are evaluated by position. So serde
//! writes lists, and lists are read wherever mappings are.

use alloc::{borrow::Cow, vec::Vec};

use crate::tree::{Node, Value};

const NAME: &str = "name";

/// Replaces the lists of named entries by mappings, which the reader knows.
pub(super) fn to_mappings(tree: &Node) -> Cow<'_, Node> {
    let has_lists = ["inputs", "outputs", "blocks"]
        .into_iter()
        .any(|key| child(tree, key).is_some_and(|part| has_list(key, part)));
    if !has_lists {
        return Cow::Borrowed(tree);
    }
    Cow::Owned(changed(tree.clone(), &mut |part| {
        if let Some(mapping) = mapping(part) {
            *part = mapping;
        }
    }))
}

/// Replaces the mappings by lists of named entries.
#[cfg(feature = "serde")]
pub(super) fn from_mappings(tree: Node) -> Node {
    changed(tree, &mut |part| {
        if let Value::Mapping(entries) = &part.value {
            let items = entries.iter().map(|(name, entry)| {
                let mut fields = Vec::from([(Node::text(NAME), name.clone())]);
                if let Value::Mapping(own) = &entry.value {
                    fields.extend(own.iter().cloned());
                }
                with(entry, Value::Mapping(fields))
            });
            *part = with(part, Value::List(items.collect()));
        }
    })
}

/// Whether a part of a rule set, or the terms in it, is a list.
fn has_list(key: &str, part: &Node) -> bool {
    match &part.value {
        Value::List(_) => true,
        Value::Mapping(entries) if key != "blocks" => entries.iter().any(|(_, variable)| {
            child(variable, "terms").is_some_and(|terms| matches!(terms.value, Value::List(_)))
        }),
        _ => false,
    }
}

/// Changes the terms of each variable, and then the inputs, the outputs and the blocks.
fn changed(mut tree: Node, change: &mut impl FnMut(&mut Node)) -> Node {
    for (key, part) in entries_mut(&mut tree) {
        let Some(key) = key else { continue };
        if key == "inputs" || key == "outputs" {
            let variables: Vec<&mut Node> = match &mut part.value {
                Value::Mapping(entries) => entries.iter_mut().map(|(_, one)| one).collect(),
                Value::List(items) => items.iter_mut().collect(),
                Value::Scalar(_) => Vec::new(),
            };
            for variable in variables {
                for (key, terms) in entries_mut(variable) {
                    if key == Some("terms") {
                        change(terms);
                    }
                }
            }
        }
        if key == "inputs" || key == "outputs" || key == "blocks" {
            change(part);
        }
    }
    tree
}

/// A list of named entries as a mapping; `None` of what is not one.
fn mapping(list: &Node) -> Option<Node> {
    let Value::List(items) = &list.value else {
        return None;
    };
    let entry = |item: &Node| {
        let Value::Mapping(fields) = &item.value else {
            return None;
        };
        let is_name = |key: &Node| text(key) == Some(NAME);
        let name = fields.iter().find(|(key, _)| is_name(key))?.1.clone();
        let own = fields.iter().filter(|(key, _)| !is_name(key));
        Some((name, with(item, Value::Mapping(own.cloned().collect()))))
    };
    let entries: Option<Vec<_>> = items.iter().map(entry).collect();
    Some(with(list, Value::Mapping(entries?)))
}

/// Another value at the same place.
fn with(node: &Node, value: Value) -> Node {
    Node {
        value,
        span: node.span.clone(),
    }
}

fn text(key: &Node) -> Option<&str> {
    match &key.value {
        Value::Scalar(scalar) => Some(&scalar.text),
        _ => None,
    }
}

fn child<'a>(node: &'a Node, key: &str) -> Option<&'a Node> {
    let Value::Mapping(entries) = &node.value else {
        return None;
    };
    let mut found = entries.iter().filter(|(known, _)| text(known) == Some(key));
    found.next().map(|(_, value)| value)
}

fn entries_mut(node: &mut Node) -> impl Iterator<Item = (Option<&str>, &mut Node)> {
    let entries = match &mut node.value {
        Value::Mapping(entries) => entries.as_mut_slice(),
        _ => &mut [],
    };
    entries.iter_mut().map(|(key, value)| (text(key), value))
}
