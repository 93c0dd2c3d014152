//! Reads the key `findings` of a profile: the words for the pilot, by the input that raised the risk.

use alloc::{format, string::String, vec::Vec};

use fuzzy::{
    diagnostic::{Diagnostic, nearest},
    tree::{Entry, Fields, Node},
};

use super::Mistakes;
use crate::profile::{CauseWords, ProfileInput};

/// The maximum length of a brief in bytes. Such a brief fits into a message of 50 characters together with the level
/// and the elevated risk that precede it.
const LONGEST_BRIEF: usize = 20;

/// The placeholders that a text may contain in braces.
const PLACEHOLDERS: [&str; 2] = ["percent", "value"];

pub(super) fn findings(
    fields: &Fields,
    inputs: &[ProfileInput],
    found: &mut Mistakes,
) -> Vec<CauseWords> {
    let entries = fields.get("findings").and_then(|node| {
        let help =
            format!("write the texts for each input by its name: `findings: {{spread: {WORDS}}}`");
        node.entries("`findings`", "input", &help, found)
    });
    let mut all = Vec::new();
    for entry in entries.unwrap_or_default() {
        // If the inputs have errors, an input may be missing only because of them.
        if found.is_empty() && !inputs.iter().any(|input| input.name == entry.key) {
            let message = format!("the profile has no input `{}`", entry.key);
            let names: Vec<&str> = inputs.iter().map(|input| input.name.as_str()).collect();
            let help = match nearest(entry.key, names.iter().copied()) {
                Some(near) => format!("did you mean `{near}`?"),
                None => format!(
                    "its inputs are {}; if the rule set has an input `{name}`, add it to `inputs`: `{name}: {{mean: SIGNAL}}`; if not, remove these texts",
                    names.join(", "),
                    name = entry.key
                ),
            };
            found.push(
                Diagnostic::error("unknown-input", entry.key_span.clone(), message).help(help),
            );
        }
        all.extend(words(&entry, found));
    }
    all
}

const WORDS: &str = "{code: fighting_gusts, brief: fighting gusts, text: ..., advice: ...}";

fn words(entry: &Entry, found: &mut Mistakes) -> Option<CauseWords> {
    let what = format!("finding `{}`", entry.key);
    let keys = ["code", "brief", "text", "advice"];
    let help = format!("write `{}: {WORDS}`", entry.key);
    let fields = entry.value.fields(&what, &keys, &help, found)?;
    let mut read = |key, check: fn(&Node, &str, &mut Mistakes)| {
        let help = format!("write `{key}`; docs/findings.md has examples");
        let node = fields.require(key, &help, found)?;
        let words = node.words(&format!("`{key}`"), &help, found)?;
        let words = words.text.clone();
        check(node, &words, found);
        Some(words)
    };
    Some(CauseWords {
        input: entry.key.into(),
        code: read("code", check_code)?,
        brief: read("brief", check_brief)?,
        text: read("text", check_placeholders)?,
        advice: read("advice", check_placeholders)?,
    })
}

fn refuse(node: &Node, message: String, help: String, found: &mut Mistakes) {
    found.push(Diagnostic::error("finding", node.span.clone(), message).help(help));
}

fn check_code(node: &Node, code: &str, found: &mut Mistakes) {
    let is_letter = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
    if code.is_empty() || !code.chars().all(is_letter) {
        let message = format!("`{code}` is not a code");
        let help = "write lower-case letters, digits and `_`, such as `sudden_change`";
        refuse(node, message, help.into(), found);
    }
}

fn check_brief(node: &Node, brief: &str, found: &mut Mistakes) {
    if let Some(letter) = brief.chars().find(|c| !c.is_ascii()) {
        let message = format!("`{letter}` in `brief` is not an ASCII character");
        let help = "programs that support only ASCII show it: write letters without accents";
        refuse(node, message, help.into(), found);
    } else if brief.len() > LONGEST_BRIEF {
        let message = format!("`brief` takes at most {LONGEST_BRIEF} ASCII characters");
        let help =
            "it is a part of messages of at most 50 characters: write two or three short words";
        refuse(node, message, help.into(), found);
    }
}

fn check_placeholders(node: &Node, text: &str, found: &mut Mistakes) {
    for part in text.split('{').skip(1) {
        let name = part.split_once('}').map(|(name, _)| name);
        if !name.is_some_and(|name| PLACEHOLDERS.contains(&name)) {
            let message = String::from("`{` does not begin a placeholder");
            let help = "placeholders are `{value}`, the value of the input, and `{percent}`, 100 times that";
            refuse(node, message, help.into(), found);
        }
    }
}
