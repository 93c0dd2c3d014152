//! Rule blocks and activation methods.

use alloc::{format, string::String, vec::Vec};
use core::ops::Range;

use super::{BlockSpans, Spans, optional_text, rules, words};
use crate::{
    diagnostic::Diagnostic,
    model::{Activation, Block, Comparison, Model, Operators, Rule},
    tree::{Entry, Node, Value},
};

pub(super) const KEYS: [&str; 5] = ["description", "enabled", "operators", "activation", "rules"];

pub(super) const METHODS: [(&str, Activation); 2] = [
    ("general", Activation::General),
    ("proportional", Activation::Proportional),
];

pub(super) const COMPARISONS: [(&str, Comparison); 6] = [
    ("below", Comparison::Below),
    ("at_most", Comparison::AtMost),
    ("equal", Comparison::Equal),
    ("not_equal", Comparison::NotEqual),
    ("at_least", Comparison::AtLeast),
    ("above", Comparison::Above),
];

/// Reads the blocks; values of keys that a block omits are taken from `model`.
pub(super) fn read(
    node: &Node,
    model: &mut Model,
    spans: &mut Spans,
    findings: &mut Vec<Diagnostic>,
) {
    let help = "write each block by its name: `blocks: {main: {rules: [IF ... THEN ...]}}`";
    let Some(entries) = node.entries("`blocks`", "block", help, findings) else {
        spans.rules_unread = true;
        return;
    };
    for (index, entry) in entries.iter().enumerate() {
        let mut here = BlockSpans {
            name: entry.key_span.clone(),
            ..BlockSpans::default()
        };
        let block = one(entry, index, model, (spans, &mut here), findings);
        spans.blocks.push(here);
        model.blocks.push(block);
    }
}

fn one(
    entry: &Entry<'_>,
    index: usize,
    model: &mut Model,
    (spans, here): (&mut Spans, &mut BlockSpans),
    findings: &mut Vec<Diagnostic>,
) -> Block {
    let what = format!("block `{}`", entry.key);
    let mut block = Block {
        and: model.operators.and,
        or: model.operators.or,
        implication: model.operators.implication,
        activation: model.activation,
        ..Block::new(entry.key)
    };
    if KEYS.contains(&entry.key) && !matches!(entry.value.value, Value::Mapping(_)) {
        // The keys of a block are directly below `blocks`, without the name of the block.
        let message = "the keys of a block must be under its name, not directly under `blocks`";
        let help = "nest the keys under the name of a block, for example `blocks: {main: {rules: [IF ... THEN ...]}}`";
        if !findings.iter().any(|finding| finding.message == message) {
            let finding = Diagnostic::error("wrong-type", entry.key_span.clone(), message);
            findings.push(finding.help(help));
        }
        spans.rules_unread = true;
        return block;
    }
    let help = format!("write `{}: {{rules: [IF ... THEN ...]}}`", entry.key);
    let Some(fields) = entry.fields(&what, &KEYS, &help, findings) else {
        spans.rules_unread = true;
        return block;
    };
    block.description = optional_text(&fields, "description", findings);
    if let Some(node) = fields.get("enabled") {
        let enabled = node.boolean(&format!("`enabled` of {what}"), findings);
        block.enabled = enabled.unwrap_or(true);
    }
    if let Some(node) = fields.get("operators") {
        let of = format!("`operators` of {what}");
        let keys = ["and", "or", "implication"];
        let found = words::operators(node, &of, &keys, model.operators, findings);
        let found = found.unwrap_or(model.operators);
        (block.and, block.or, block.implication) = (found.and, found.or, found.implication);
    }
    if let Some(node) = fields.get("activation") {
        let of = format!("the activation of {what}");
        block.activation =
            activation(&of, node, &mut here.activation, findings).unwrap_or(block.activation);
    }
    let help = "write `rules:` followed by a list of rules, such as `- IF input IS term THEN output IS term`";
    let rules = fields.require("rules", help, findings);
    let read = rules.and_then(|node| rules::read(node, model, spans, findings));
    spans.rules_unread |= read.is_none();
    let of_block = |rule: Rule| Rule {
        block: index,
        ..rule
    };
    model
        .rules
        .extend(read.unwrap_or_default().into_iter().map(of_block));
    block
}

/// Reads `general`, `{first: 1}`, `{first: {rules: 2, at_least: 0.1}}` or `{threshold: {at_least: 0.3}}`; `span` is set
/// to the position of the whole value.
pub(super) fn activation(
    what: &str,
    node: &Node,
    span: &mut Range<usize>,
    findings: &mut Vec<Diagnostic>,
) -> Option<Activation> {
    const HELP: &str = "write one: `activation: general`, `{first: 1}`, `{last: 1}`, `{highest: 1}`, `{lowest: 1}`, `proportional`, \
                        `{threshold: {at_least: 0.3}}`";
    *span = node.span.clone();
    let keys = ["first", "last", "highest", "lowest", "threshold"];
    let Value::Mapping(pairs) = &node.value else {
        let before = findings.len();
        let method = node.choice(what, &METHODS, findings);
        if let Some(finding) = findings.get_mut(before) {
            let word = node.as_text().unwrap_or("");
            let needs = |value: &str| format!("{what} is `{word}`, which needs {value}");
            let help = match word {
                "threshold" => {
                    finding.message = needs("a comparison");
                    "write `{threshold: {at_least: 0.3}}`".into()
                }
                _ if keys.contains(&word) => {
                    finding.message = needs("the number of rules");
                    format!("write how many rules may fire: `{{{word}: 1}}`")
                }
                _ => HELP.into(),
            };
            finding.help = Some(help);
        }
        return method;
    };
    let before = findings.len();
    let fields = node.fields(what, &keys, HELP, findings)?;
    let [method] = fields.entries() else {
        if findings.len() == before {
            let message = format!(
                "{what} has {} methods, but only one is allowed",
                pairs.len()
            );
            let methods = pairs
                .iter()
                .map(|(key, value)| format!("`{{{}: {}}}`", key.to_line(), value.to_line()));
            let methods: Vec<String> = methods.collect();
            let help = format!("keep one of them: {}", methods.join(" or "));
            findings.push(Diagnostic::error("wrong-type", node.span.clone(), message).help(help));
        }
        return None;
    };
    let of = format!("`{}` in {what}", method.key);
    match method.key {
        "first" | "last" => {
            let (rules, at_least) = counted(&of, method.value, findings)?;
            Some(match method.key {
                "first" => Activation::First { rules, at_least },
                _ => Activation::Last { rules, at_least },
            })
        }
        "highest" => Some(Activation::Highest {
            rules: count(&of, method.value, findings)?,
        }),
        "lowest" => Some(Activation::Lowest {
            rules: count(&of, method.value, findings)?,
        }),
        "threshold" => threshold(&of, method.value, findings),
        // Unknown keys are reported by the reader of the mapping.
        _ => None,
    }
}

fn count(what: &str, node: &Node, findings: &mut Vec<Diagnostic>) -> Option<u32> {
    let before = findings.len();
    let rules = node.whole(what, 1, findings);
    if let Some(number) = node.child("rules").and_then(Node::as_number_text)
        && let Some(finding) = findings.get_mut(before)
    {
        finding.help = Some(format!("write `{number}`"));
    }
    Some(u32::try_from(rules?).unwrap_or(u32::MAX))
}

/// Reads `2` or `{rules: 2, at_least: 0.1}`.
fn counted(what: &str, node: &Node, findings: &mut Vec<Diagnostic>) -> Option<(u32, f64)> {
    let Value::Mapping(_) = &node.value else {
        return Some((count(what, node, findings)?, 0.0));
    };
    let help = "write `{rules: 1, at_least: 0.1}`";
    let fields = node.fields(what, &["rules", "at_least"], help, findings)?;
    let rules = fields.require("rules", help, findings);
    let rules = rules.and_then(|node| count(&format!("`rules` of {what}"), node, findings));
    let at_least = fields.get("at_least").map_or(Some(0.0), |node| {
        node.finite(&format!("`at_least` of {what}"), findings)
    });
    Some((rules?, at_least?))
}

/// Reads `{at_least: 0.3}`.
fn threshold(what: &str, node: &Node, findings: &mut Vec<Diagnostic>) -> Option<Activation> {
    let number = node.as_number_text().unwrap_or("0.3");
    let help = &format!(
        "write `{{at_least: {number}}}`, or replace `at_least` by `below`, `at_most`, `equal`, `not_equal` or `above`"
    );
    let Value::Mapping(_) = &node.value else {
        let finding = node.unexpected(&format!("a comparison for {what}"));
        findings.push(finding.help(help));
        return None;
    };
    let keys = COMPARISONS.map(|(word, _)| word);
    let fields = node.fields(what, &keys, help, findings)?;
    let found = COMPARISONS
        .iter()
        .filter_map(|(word, comparison)| Some((*comparison, fields.get(word)?)));
    let found: Vec<(Comparison, &Node)> = found.collect();
    let [(comparison, number)] = found.as_slice() else {
        let message = format!("{what} must have exactly one comparison");
        findings.push(Diagnostic::error("wrong-type", node.span.clone(), message).help(help));
        return None;
    };
    Some(Activation::Threshold {
        comparison: *comparison,
        strength: number.finite(what, findings)?,
    })
}

/// Returns the blocks of a model with their rules.
pub(super) fn write(model: &Model) -> Node {
    let blocks = model.blocks.iter().enumerate().map(|(index, block)| {
        let mut entries: Vec<(&str, Node)> = Vec::new();
        entries.extend(
            block
                .description
                .as_deref()
                .map(|text| ("description", Node::text(text))),
        );
        if !block.enabled {
            entries.push(("enabled", Node::scalar("false".into(), false)));
        }
        let operators = Operators {
            and: block.and,
            or: block.or,
            implication: block.implication,
            ..model.operators
        };
        let [and, or, implication, _] = words::written(operators);
        entries.push(("operators", Node::mapping([and, or, implication])));
        if block.activation != model.activation {
            entries.push(("activation", write_activation(block.activation)));
        }
        let rules = model.rules.iter().filter(|rule| rule.block == index);
        entries.push(("rules", Node::list(rules.map(rules::write).collect())));
        (block.name.clone(), Node::mapping(entries))
    });
    Node::mapping(blocks.collect::<Vec<(String, Node)>>())
}

pub(super) fn write_activation(activation: Activation) -> Node {
    let whole = |number: u32| Node::number(f64::from(number));
    let counted = |rules: u32, at_least: f64| {
        if at_least == 0.0 {
            return whole(rules);
        }
        Node::mapping([
            ("rules", whole(rules)),
            ("at_least", Node::number(at_least)),
        ])
    };
    match activation {
        Activation::First { rules, at_least } => {
            Node::mapping([("first", counted(rules, at_least))])
        }
        Activation::Last { rules, at_least } => Node::mapping([("last", counted(rules, at_least))]),
        Activation::Highest { rules } => Node::mapping([("highest", whole(rules))]),
        Activation::Lowest { rules } => Node::mapping([("lowest", whole(rules))]),
        Activation::Threshold {
            comparison,
            strength,
        } => {
            let word = words::word_of(&COMPARISONS, comparison);
            let threshold = Node::mapping([(word, Node::number(strength))]);
            Node::mapping([("threshold", threshold)])
        }
        method => Node::text(words::word_of(&METHODS, method)),
    }
}
