//! Inputs, outputs, terms and blocks as lists of named entries: `[{name: heat, range: [0, 40], ...}]`.
//!
//! Some formats sort the keys of a mapping, but the order of these parts is significant: inputs are evaluated by
//! position. Therefore the serde implementation writes lists, and lists can be read wherever mappings can.

use alloc::{borrow::Cow, format, string::String, vec::Vec};

use crate::{
    diagnostic::Diagnostic,
    tree::{Node, Value},
};

const NAME: &str = "name";
/// The keys of a variable under which each term has an entry.
const TERMS: [&str; 2] = ["terms", "steps"];

/// Replaces lists of named entries by mappings, which the reader supports. An entry without a name is reported and
/// omitted.
pub(super) fn to_mappings<'t>(tree: &'t Node, findings: &mut Vec<Diagnostic>) -> Cow<'t, Node> {
    let has_lists = ["inputs", "outputs", "blocks"]
        .into_iter()
        .any(|key| tree.child(key).is_some_and(|part| has_list(key, part)));
    if !has_lists {
        return Cow::Borrowed(tree);
    }
    Cow::Owned(changed(tree.clone(), &mut |what, part| {
        if let Some(mapping) = mapping(what, part, findings) {
            *part = mapping;
        }
    }))
}

/// Replaces the mappings by lists of named entries.
#[cfg(feature = "serde")]
pub(super) fn from_mappings(tree: Node) -> Node {
    changed(tree, &mut |_, part| {
        if let Value::Mapping(entries) = &part.value {
            let items = entries.iter().map(|(name, entry)| {
                let mut fields = Vec::from([(Node::text(NAME), name.clone())]);
                match &entry.value {
                    Value::Mapping(own) => fields.extend(own.iter().cloned()),
                    // In `steps`, the last term has no limit, and not every format has a null value.
                    _ if entry.is_null() => {}
                    _ => fields.push((Node::text("below"), entry.clone())),
                }
                with(entry, Value::Mapping(fields))
            });
            *part = with(part, Value::List(items.collect()));
        }
    })
}

/// Returns whether a part of a rule set, or the terms in it, is a list.
fn has_list(key: &str, part: &Node) -> bool {
    match &part.value {
        Value::List(_) => true,
        Value::Mapping(entries) if key != "blocks" => entries.iter().any(|(_, variable)| {
            let mut terms = TERMS.into_iter().filter_map(|key| variable.child(key));
            terms.any(|terms| matches!(terms.value, Value::List(_)))
        }),
        _ => false,
    }
}

/// Calls `change` for the terms of each variable, and then for the inputs, the outputs and the blocks. The first
/// argument of `change` describes the part for messages, such as ``the terms of `heat` ``.
fn changed(mut tree: Node, change: &mut impl FnMut(&str, &mut Node)) -> Node {
    for (key, part) in entries_mut(&mut tree) {
        let Some(key) = key else { continue };
        if key == "inputs" || key == "outputs" {
            let named = |name: Option<&str>| match name {
                Some(name) => format!("the terms of `{name}`"),
                None => format!("the terms of one of `{key}`"),
            };
            let variables: Vec<(String, &mut Node)> = match &mut part.value {
                Value::Mapping(entries) => {
                    let entries = entries.iter_mut();
                    entries
                        .map(|(name, one)| (named(name.as_text()), one))
                        .collect()
                }
                Value::List(items) => {
                    let items = items.iter_mut();
                    items
                        .map(|one| (named(one.child(NAME).and_then(Node::as_text)), one))
                        .collect()
                }
                Value::Scalar(_) => Vec::new(),
            };
            for (what, variable) in variables {
                for (key, terms) in entries_mut(variable) {
                    if key.is_some_and(|key| TERMS.contains(&key)) {
                        change(&what, terms);
                    }
                }
            }
        }
        if key == "inputs" || key == "outputs" || key == "blocks" {
            change(&format!("`{key}`"), part);
        }
    }
    tree
}

/// Converts a list of named entries to a mapping; `None` for other values, including lists that contain no mapping.
fn mapping(what: &str, list: &Node, findings: &mut Vec<Diagnostic>) -> Option<Node> {
    let Value::List(items) = &list.value else {
        return None;
    };
    let is_mapping = |item: &Node| matches!(item.value, Value::Mapping(_));
    if !items.is_empty() && !items.iter().any(is_mapping) {
        return None;
    }
    if let Some((entries, finding)) = dashes(what, items) {
        findings.push(finding);
        return Some(with(list, Value::Mapping(entries)));
    }
    let mut entries = Vec::with_capacity(items.len());
    for (i, item) in items.iter().enumerate() {
        let entry = format!("entry {} of {what}", i + 1);
        let help = "begin the entry with `- name: ...`, followed by its other keys";
        let Value::Mapping(fields) = &item.value else {
            let finding = item.unexpected(&format!("a mapping with a `name` for {entry}"));
            findings.push(finding.help(help));
            continue;
        };
        let mut own = fields.clone();
        match own.iter().position(|(key, _)| key.as_text() == Some(NAME)) {
            Some(name) => {
                let (_, name) = own.remove(name);
                entries.push((name, with(item, Value::Mapping(own))));
            }
            None => {
                let message = format!("{entry} has no `name`");
                let finding = Diagnostic::error("missing-key", item.span.clone(), message);
                if let [(name, value), keys @ ..] = own.as_slice()
                    && value.is_null()
                    && !keys.is_empty()
                {
                    let text = name.as_text().unwrap_or_default();
                    findings.push(finding.help(format!(
                        "remove the `-` before `{text}:`, and indent its keys under it"
                    )));
                    entries.push((name.clone(), with(item, Value::Mapping(keys.to_vec()))));
                    continue;
                }
                // `- heat: {range: [0, 40]}` is a mapping with one entry.
                let only = match own.as_slice() {
                    [(key, value)] if is_mapping(value) => key.as_text().map(|key| (key, value)),
                    _ => None,
                };
                findings.push(match only {
                    Some((name, _)) => finding.help(format!(
                        "write `{name}: {{...}}` without the `-`, or `- {{name: {name}, ...}}`"
                    )),
                    None => finding.help(help),
                });
                if only.is_some() {
                    entries.extend(own);
                }
            }
        }
    }
    Some(with(list, Value::Mapping(entries)))
}

/// Reads a list in which a `-` precedes each name and the keys follow in the column of the name: `- heat:` and, below
/// the `h`, `range: [0, 40]`. Returns the named entries, and a single error for all of them.
fn dashes(what: &str, items: &[Node]) -> Option<(Vec<(Node, Node)>, Diagnostic)> {
    let entries = items.iter().map(|item| match &item.value {
        Value::Mapping(own) => match own.as_slice() {
            [(name, value), own @ ..]
                if value.is_null()
                    && !own.is_empty()
                    && own.iter().all(|(key, _)| key.as_text() != Some(NAME)) =>
            {
                Some((name.clone(), with(item, Value::Mapping(own.to_vec()))))
            }
            _ => None,
        },
        _ => None,
    });
    let entries: Vec<(Node, Node)> = entries.collect::<Option<_>>()?;
    let (name, _) = entries.first()?;
    let message = format!("the names under {what} must not have a `-` before them");
    let help = format!(
        "write each name without the `-`, for example `{}:`, and indent its keys under it",
        name.as_text().unwrap_or_default()
    );
    let finding = Diagnostic::error("wrong-type", name.span.clone(), message);
    Some((entries, finding.help(help)))
}

/// Returns a node with the given value at the position of another node.
fn with(node: &Node, value: Value) -> Node {
    Node {
        value,
        span: node.span.clone(),
    }
}

fn entries_mut(node: &mut Node) -> impl Iterator<Item = (Option<&str>, &mut Node)> {
    let entries = match &mut node.value {
        Value::Mapping(entries) => entries.as_mut_slice(),
        _ => &mut [],
    };
    entries
        .iter_mut()
        .map(|(key, value)| (key.as_text(), value))
}
