//! Rules in a file: `- IF ... THEN ...`, or a mapping that also contains the provenance of the rule.

use alloc::{
    format,
    string::{String, ToString},
    vec::Vec,
};
use core::{cell::OnceCell, ops::Range};

use super::{RuleSpans, Spans, optional_text};
use crate::{
    diagnostic::Diagnostic,
    model::{Model, RejectedConsequent, Rule, Variable},
    rule::{self, Condition, Known, KnownNames, KnownVariable},
    tree::{Fields, Node, Scalar, Value},
};

pub(super) const KEYS: [&str; 5] = ["rule", "confidence", "support", "against", "note"];

/// Reads the rules of a list. Their numbers continue those of the rules in `model`.
pub(super) fn read(
    node: &Node,
    model: &Model,
    spans: &mut Spans,
    findings: &mut Vec<Diagnostic>,
) -> Option<Vec<Rule>> {
    let Value::List(items) = &node.value else {
        let finding = node.unexpected("a list for `rules`");
        let is_list = node
            .as_text()
            .is_some_and(|text| text.trim_start().starts_with("- "));
        findings.push(finding.help(match &node.value {
            _ if is_list => "remove the `|` or `>` after `rules:`, which turns the list into text",
            Value::Scalar(text) if text.text.trim_end().contains('\n') => {
                "remove the `|` or `>` after `rules:`, and begin the line of each rule with `- IF`"
            }
            Value::Mapping(_) => "begin the line of each rule with `- IF`; rules cannot have names",
            _ => "write each rule on its own line under `rules:`, beginning with `- IF`",
        }));
        return None;
    };
    // The peaks of many shapes are found by sampling, so the names are collected only if a rule has a syntax error.
    let names = OnceCell::new();
    let known = || {
        let (inputs, outputs) = names.get_or_init(|| {
            let outputs = model.outputs.iter().map(|output| &output.variable);
            let inputs: Vec<KnownVariable<'_>> = model.inputs.iter().map(known_variable).collect();
            (inputs, outputs.map(known_variable).collect::<Vec<_>>())
        });
        KnownNames { inputs, outputs }
    };
    let before = model.rules.len();
    let mut rules = Vec::with_capacity(items.len());
    for (i, item) in items.iter().enumerate() {
        // A rule that is split into several entries is reported at the first one.
        let last = i.checked_sub(1).and_then(|last| items.get(last));
        if continues(item) && last.and_then(Node::as_text).is_some() {
            spans.rules_unread = true;
            continue;
        }
        let rest = items.iter().skip(i + 1).take_while(|item| continues(item));
        let parts: Vec<&str> = match item.as_text() {
            Some(first) => core::iter::once(first)
                .chain(rest.filter_map(Node::as_text))
                .collect(),
            None => Vec::new(),
        };
        if parts.len() > 1 {
            let message = format!(
                "rule {} is split into {} entries",
                before + i + 1,
                parts.len()
            );
            let help = format!("write it as one entry: `- {}`", parts.join(" "));
            let finding = Diagnostic::error("rule-syntax", item.span.clone(), message);
            findings.push(finding.help(help));
            spans.rules_unread = true;
            continue;
        }
        let mut here = RuleSpans {
            whole: item.span.clone(),
            ..RuleSpans::default()
        };
        match one(item, before + i + 1, &known, &mut here, findings) {
            Some(rule) => {
                rules.push(rule);
                spans.rules.push(here);
            }
            None => spans.rules_unread = true,
        }
    }
    Some(rules)
}

const HELP: &str = "write `IF input IS term THEN output IS term`, or remove the entry";

const REJECTED_EXAMPLE: &str = "{term: high, degree: 0.4, support: 3}";

/// Returns whether an entry begins with a word that cannot begin a rule, so that it continues the previous entry.
fn continues(item: &Node) -> bool {
    let first = item
        .as_text()
        .and_then(|text| text.split_whitespace().next());
    first.is_some_and(|first| {
        ["AND", "OR", "THEN", "WITH"]
            .iter()
            .any(|word| first.eq_ignore_ascii_case(word))
    })
}

/// Returns the text of a rule that is written as a mapping of its parts: `{if: heat IS high, then: speed IS fast}`.
fn of_parts(fields: &Fields<'_>) -> Option<String> {
    let part = |name: &str| {
        let mut unknown = fields.unknown();
        let entry = unknown.find(|entry| entry.key.eq_ignore_ascii_case(name))?;
        entry.value.as_text()
    };
    Some(format!("IF {} THEN {}", part("if")?, part("then")?))
}

fn one(
    node: &Node,
    number: usize,
    known: Known<'_>,
    spans: &mut RuleSpans,
    findings: &mut Vec<Diagnostic>,
) -> Option<Rule> {
    let what = format!("rule {number}");
    let mut found = Rule {
        rule: rule::Rule {
            condition: Condition::And(Vec::new()),
            consequents: Vec::new(),
            weight: 1.0,
        },
        block: 0,
        confidence: None,
        support: None,
        against: Vec::new(),
        note: None,
    };
    if let Value::Scalar(_) = &node.value {
        (found.rule, spans.weight) = parse(node.words(&what, HELP, findings)?, known, findings)?;
        return Some(found);
    }
    let Value::Mapping(pairs) = &node.value else {
        let finding = node.unexpected(&format!("text or a mapping for {what}"));
        let parts = match &node.value {
            Value::List(parts) => parts.iter().map(Node::as_text).collect(),
            _ => None,
        };
        let help =
            parts.map(|parts: Vec<&str>| format!("remove the brackets: `- {}`", parts.join(" ")));
        findings.push(finding.help(help.unwrap_or_else(|| HELP.into())));
        return None;
    };
    if let [(key, value)] = pairs.as_slice()
        && let Some(finding) = colon(&what, key, value)
    {
        findings.push(finding);
        return None;
    }
    let fields = node.fields(&what, &KEYS, HELP, findings)?;
    if let Some(rule) = of_parts(&fields) {
        fields.withdraw(findings);
        let message = format!("the parts of {what} are written as separate keys");
        let finding = Diagnostic::error("unknown-key", node.span.clone(), message);
        findings.push(finding.help(format!("write the whole rule as text: `- {rule}`")));
        return None;
    }
    let help = "add the key `rule`, for example `{rule: IF input IS term THEN output IS term, confidence: 0.8}`";
    let text = fields.require("rule", help, findings);
    if let Some(node) = fields.get("confidence") {
        spans.confidence = node.span.clone();
        found.confidence = node.finite(&format!("the confidence of {what}"), findings);
    }
    found.support = fields
        .get("support")
        .and_then(|node| node.whole(&format!("the support of {what}"), 0, findings));
    found.note = optional_text(&fields, "note", findings);
    if let Some(node) = fields.get("against") {
        let what = format!("an `against` entry of {what}");
        let help = format!(
            "write the term, its degree and the number of rows: `against: [{REJECTED_EXAMPLE}]`"
        );
        let items = node.items(&what, &help, findings).unwrap_or_default();
        for item in items {
            if let Some((rejected, term, degree)) = rejected(&what, item, findings) {
                found.against.push(rejected);
                spans.against.push(degree);
                spans.against_terms.push(term);
            }
        }
    }
    (found.rule, spans.weight) = parse(text?.words(&what, HELP, findings)?, known, findings)?;
    Some(found)
}

/// Returns the name of a variable, with its terms in the order of their highest degrees.
fn known_variable(variable: &Variable) -> KnownVariable<'_> {
    let terms = variable.terms.iter().map(|term| {
        let peak = variable.peak(&term.membership_function);
        (peak, term.name.as_str())
    });
    let mut terms: Vec<(f64, &str)> = terms.collect();
    terms.sort_by(|(a, _), (b, _)| a.total_cmp(b));
    KnownVariable {
        name: &variable.name,
        terms: terms.into_iter().map(|(_, name)| name).collect(),
    }
}

/// Reports a rule that a colon turns into a mapping: `RULE 4 : IF ...`, or `IF ... THEN speed IS fast: why`.
fn colon(what: &str, key: &Node, value: &Node) -> Option<Diagnostic> {
    let is_rule = |node: &Node| match &node.value {
        Value::Scalar(scalar) => {
            let start = scalar.text.get(..3);
            start.is_some_and(|start| start.eq_ignore_ascii_case("if "))
        }
        _ => false,
    };
    let last = key
        .as_text()
        .and_then(|key| key.split_whitespace().next_back());
    let keyword = last.filter(|last| {
        ["THEN", "WITH"]
            .iter()
            .any(|word| word.eq_ignore_ascii_case(last))
    });
    let is_of_fis = |key: &str| {
        let is_sign = |c: char| c.is_ascii_digit() || " ,()-.".contains(c);
        key.contains(',') && key.chars().all(is_sign)
    };
    let after_keyword = keyword.map(|keyword| format!("remove the colon after `{keyword}`"));
    let remark = format!(
        "remove the colon and the text after it, or write that text as a comment: `# {}`",
        value.as_text().unwrap_or("...")
    );
    let with_colon = || format!("{what} contains a colon, so YAML reads it as a key with a value");
    let (message, help) = if let Some(help) = after_keyword.as_deref().filter(|_| is_rule(key)) {
        (with_colon(), help)
    } else if key.as_text().is_some_and(is_of_fis) {
        let help = "write it in words: `IF input IS term THEN output IS term`; a whole FIS file can be imported";
        (
            format!("{what} is written in numbers, as in the FIS format"),
            help,
        )
    } else if let Some(help) = in_place_of_then(key, value).filter(|_| is_rule(key)) {
        (with_colon(), help)
    } else if is_rule(key) {
        (with_colon(), remark.as_str())
    } else if is_rule(value) && !matches!(&key.value, Value::Scalar(key) if key.text == "rule") {
        let help = "write `- IF ... THEN ...`, without a name or number";
        (format!("{what} starts with a name, not with `IF`"), help)
    } else {
        return None;
    };
    Some(Diagnostic::error("wrong-type", key.span.clone(), message).help(help))
}

/// Returns a suggestion for `IF x IS low: y IS high`.
fn in_place_of_then(condition: &Node, conclusion: &Node) -> Option<&'static str> {
    let has = |node: &Node, keyword: &str| {
        let mut words = node.as_text()?.split_whitespace();
        Some(words.any(|word| word.eq_ignore_ascii_case(keyword)))
    };
    match (has(condition, "THEN")?, has(conclusion, "THEN")?) {
        (false, true) => Some("remove the colon"),
        (false, false) if has(conclusion, "IS")? => Some("write `THEN` in place of the colon"),
        _ => None,
    }
}

/// Reads `{term: high, degree: 0.4, support: 3}`; also returns the positions of the term and the degree.
fn rejected(
    what: &str,
    node: &Node,
    findings: &mut Vec<Diagnostic>,
) -> Option<(RejectedConsequent, Range<usize>, Range<usize>)> {
    let fields = node.fields(
        what,
        &["term", "degree", "support"],
        &format!("write `{REJECTED_EXAMPLE}`"),
        findings,
    )?;
    let written = |key: &str, example: &str| fields.get(key).map_or(example.into(), Node::to_line);
    let help = &format!(
        "write `{{term: {}, degree: {}, support: {}}}`",
        written("term", "high"),
        written("degree", "0.4"),
        written("support", "3")
    );
    let term = fields.require("term", help, findings);
    let term_span = term.map_or(0..0, |node| node.span.clone());
    let term = term.and_then(|node| node.words(&format!("the term in {what}"), help, findings));
    let degree = fields.require("degree", help, findings);
    let span = degree.map_or(0..0, |node| node.span.clone());
    let degree = degree.and_then(|node| node.finite(&format!("the degree in {what}"), findings));
    let support = fields
        .require("support", help, findings)
        .and_then(|node| node.whole(&format!("the support in {what}"), 0, findings));
    let rejected = RejectedConsequent {
        term: term?.text.to_string(),
        degree: degree?,
        support: support?,
    };
    Some((rejected, term_span, span))
}

/// Parses the rule in a scalar, and also returns the position of its weight. Positions are converted to those in the
/// document.
fn parse(
    scalar: &Scalar,
    known: Known<'_>,
    findings: &mut Vec<Diagnostic>,
) -> Option<(rule::Rule, Range<usize>)> {
    match rule::parse_with_weight(&scalar.text, known) {
        Ok((mut rule, weight)) => {
            rule.names_mut(&mut |name| name.span = scalar.span(name.span.clone()));
            Some((rule, scalar.span(weight)))
        }
        Err(mut finding) => {
            finding.span = scalar.span(finding.span.clone());
            findings.push(*finding);
            None
        }
    }
}

/// Returns the rule in the format of a file.
pub(super) fn write(rule: &Rule) -> Node {
    let text = Node::text(rule.rule.to_string());
    let is_bare = rule.confidence.is_none()
        && rule.support.is_none()
        && rule.against.is_empty()
        && rule.note.is_none();
    if is_bare {
        return text;
    }
    let mut entries: Vec<(&str, Node)> = Vec::from([("rule", text)]);
    entries.extend(rule.confidence.map(|c| ("confidence", Node::number(c))));
    entries.extend(rule.support.map(|s| ("support", whole(s))));
    if !rule.against.is_empty() {
        let rejected = rule.against.iter().map(|rejected| {
            Node::mapping([
                ("term", Node::text(rejected.term.as_str())),
                ("degree", Node::number(rejected.degree)),
                ("support", whole(rejected.support)),
            ])
        });
        entries.push(("against", Node::list(rejected.collect())));
    }
    entries.extend(rule.note.as_ref().map(|n| ("note", Node::text(n.as_str()))));
    Node::mapping(entries)
}

pub(super) fn whole(number: u64) -> Node {
    Node::scalar(number.to_string(), false)
}
