//! The list of findings that an author accepts: `allow: [{finding: jump, because: required by the regulation}]`.

use alloc::{format, string::String, vec::Vec};
use core::ops::Range;

use super::optional_text;
use crate::{
    diagnostic::{Diagnostic, all_of, duplicate, quoted},
    model::AllowedFinding,
    tree::Node,
};

pub(super) const KEYS: [&str; 3] = ["finding", "of", "because"];

/// The codes of findings that an author can accept: the findings of the analysis that depend only on the rule set.
pub(crate) const CODES: [&str; 17] = [
    "uncovered",
    "no-rule-fires",
    "contradiction",
    "duplicate-rule",
    "subsumed-rule",
    "never-fires",
    "unused",
    "term-outside-range",
    "equal-terms",
    "hole",
    "narrow-reach",
    "output-outside-range",
    "against-trend",
    "jump",
    "constant-term",
    "no-effect",
    "no-value",
];

pub(super) fn read(
    node: &Node,
    spans: &mut Vec<Range<usize>>,
    findings: &mut Vec<Diagnostic>,
) -> Vec<AllowedFinding> {
    let example = "{finding: jump, because: required by the regulation}";
    AllowedFinding::read(node, &CODES, example, spans, findings)
}

impl AllowedFinding {
    /// Reads the value of the key `allow` of a rule set or a profile, whose findings have these `codes`. `example` is
    /// an example of an entry, which messages quote. Appends the span of each entry to `spans`, and errors to
    /// `findings`.
    pub fn read(
        node: &Node,
        codes: &[&'static str],
        example: &str,
        spans: &mut Vec<Range<usize>>,
        findings: &mut Vec<Diagnostic>,
    ) -> Vec<AllowedFinding> {
        let help = format!("write `allow: [{example}]`, with an entry for each finding");
        let items = node.items("`allow`", &help, findings).unwrap_or_default();
        let mut all: Vec<AllowedFinding> = Vec::new();
        for (i, item) in items.iter().enumerate() {
            let Some(allowed) = entry(item, i + 1, codes, example, findings) else {
                continue;
            };
            let is_same =
                |one: &AllowedFinding| one.finding == allowed.finding && one.of == allowed.of;
            let same = all.iter().position(is_same);
            if let Some(first) = same.and_then(|first| spans.get(first)) {
                let (span, first) = (item.span.clone(), first.clone());
                let finding = &allowed.finding;
                findings.push(duplicate("finding", finding, "`allow`", span, first));
                continue;
            }
            spans.push(item.span.clone());
            all.push(allowed);
        }
        all
    }
}

fn entry(
    node: &Node,
    number: usize,
    codes: &[&'static str],
    example: &str,
    findings: &mut Vec<Diagnostic>,
) -> Option<AllowedFinding> {
    let what = format!("entry {number} of `allow`");
    let fields = node.fields(&what, &KEYS, &format!("write `{example}`"), findings)?;
    let code = format!("name a finding of `check`: `{example}`");
    let reason =
        "write why the finding is accepted, for example `because: required by the regulation`";
    let code = fields.require("finding", &code, findings).and_then(|node| {
        let words: Vec<(&str, &'static str)> = codes.iter().map(|code| (*code, *code)).collect();
        let before = findings.len();
        let code = node.choice(&format!("`finding` of {what}"), &words, findings);
        if let (Some(finding), Some(word)) = (findings.get_mut(before), node.as_text()) {
            finding.message = format!(
                "{what}: `{}` is not a warning or note of `check`",
                quoted(word)
            );
            let is_misspelt = |help: &String| help.starts_with("did you mean");
            if !finding.help.as_ref().is_some_and(is_misspelt) {
                finding.help = Some(format!(
                    "`allow` accepts warnings and notes, but not errors; choose one of {}",
                    all_of(codes)
                ));
            }
        }
        code
    });
    let of = match fields.get("of") {
        Some(node) => {
            let help = "write the name of a variable that the finding names: `of: speed`";
            Some(
                node.words(&format!("`of` of {what}"), help, findings)?
                    .text
                    .clone(),
            )
        }
        None => None,
    };
    let node = fields.require("because", reason, findings)?;
    let because = optional_text(&fields, "because", findings)?;
    if because.trim().is_empty() {
        let message = format!("{what} has an empty `because`");
        findings.push(Diagnostic::error("missing-key", node.span.clone(), message).help(reason));
        return None;
    }
    Some(AllowedFinding {
        finding: code?.into(),
        of,
        because,
    })
}

/// Returns the value of the key `allow`; `None` if the author accepts no findings.
pub(super) fn write(allow: &[AllowedFinding]) -> Option<Node> {
    let entries = allow.iter().map(|one| {
        let of = one.of.as_deref().map(|of| ("of", Node::text(of)));
        let entry = [("finding", Node::text(one.finding.as_str()))].into_iter();
        let because = ("because", Node::text(one.because.as_str()));
        Node::mapping(entry.chain(of).chain([because]))
    });
    (!allow.is_empty()).then(|| Node::list(entries.collect()))
}
