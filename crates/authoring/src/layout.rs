//! Formats rule sets and profiles in a common layout. Comments are preserved.

use std::fmt;

use fuzzy::{
    Findings,
    format::Document,
    tree::{Node, Value},
};
use pretty_yaml::config::FormatOptions;

/// The maximum width of a line.
const WIDTH: usize = 120;

/// The reason why a text cannot be formatted.
#[derive(Debug)]
pub enum LayoutError {
    /// The text is not YAML.
    NotYaml(Findings),
    /// The text is neither a rule set nor a profile, so it may belong to another program.
    Foreign,
    /// Formatting would change the meaning of the text, or the formatter does not support it.
    Other(String),
}

impl fmt::Display for LayoutError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            LayoutError::NotYaml(findings) => findings.fmt(f),
            LayoutError::Foreign => f.write_str("the file is neither a rule set nor a profile"),
            LayoutError::Other(why) => f.write_str(why),
        }
    }
}

/// Formats a text: indentation by two spaces, single spaces between words, rules with keywords in capitals. Meaning
/// and comments are preserved.
///
/// # Errors
/// Returns the reason if the text cannot be formatted.
pub fn formatted(text: &str) -> Result<String, LayoutError> {
    let before = fuzzy::yaml::read(text).map_err(LayoutError::NotYaml)?;
    if !is_ours(&before) {
        return Err(LayoutError::Foreign);
    }
    let document = fuzzy::yaml::parse(text).ok();
    let capitals = document.as_ref().map(|rules| with_capitals(text, rules));
    let mut options = FormatOptions::default();
    options.layout.print_width = WIDTH;
    options.language.brace_spacing = false;
    let formatted = pretty_yaml::format_text(capitals.as_deref().unwrap_or(text), &options)
        .map_err(|error| LayoutError::Other(error.to_string()))?;
    let same = match document {
        Some(document) => {
            fuzzy::yaml::parse(&formatted).is_ok_and(|new| new.model == document.model)
        }
        None => {
            let after = fuzzy::yaml::read(&formatted);
            after.is_ok_and(|after| means(&after) == means(&before))
        }
    };
    match same {
        true => Ok(formatted),
        false => Err(LayoutError::Other(
            "another layout would change its meaning".into(),
        )),
    }
}

/// Whether a tree is a rule set or a profile: it has the key `fuzzy` or `flagred` with a number, or the keys `inputs`
/// and `outputs`.
fn is_ours(tree: &Node) -> bool {
    let Value::Mapping(entries) = &tree.value else {
        return false;
    };
    let has = |wanted: &str| {
        let mut keys = entries.iter().map(|(key, _)| &key.value);
        keys.any(|key| matches!(key, Value::Scalar(key) if key.text == wanted))
    };
    let is_numbered = entries
        .iter()
        .any(|(key, value)| match (&key.value, &value.value) {
            (Value::Scalar(key), Value::Scalar(version)) => {
                matches!(key.text.as_str(), "fuzzy" | "flagred")
                    && version.text.parse::<f64>().is_ok()
            }
            _ => false,
        });
    is_numbered || has("inputs") && has("outputs")
}

/// Converts a tree to JSON, which does not contain the positions in the text.
fn means(tree: &Node) -> serde_json::Value {
    serde_json::to_value(tree).unwrap_or_default()
}

/// Returns the text with its rules in the syntax of the rule language, with keywords in capitals. A rule is left
/// unchanged if it spans several lines or contains quotation marks or parentheses.
fn with_capitals(text: &str, document: &Document) -> String {
    let mut changed = text.to_owned();
    let rules = document.model.rules.iter().zip(&document.spans.rules);
    for (rule, spans) in rules.rev() {
        let written = text.get(spans.whole.clone()).unwrap_or("");
        let is_plain = written
            .get(..3)
            .is_some_and(|start| start.eq_ignore_ascii_case("if "));
        if is_plain && !written.contains(['\n', '"', '\'', '(']) {
            changed.replace_range(spans.whole.clone(), &rule.rule.to_string());
        }
    }
    changed
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_layout_keeps_comments_and_meaning() {
        let text = "# my fan\nfuzzy:   1\nname: fan # short\n\ninputs:\n    heat: {range: [0,100],   partition: [low, high]}\n\
                    outputs: {speed: {range: [0, 9], partition: [slow, fast]}}\nrules:\n- if heat is high then   speed is fast # why\n";
        let once = formatted(text).unwrap();
        let expected = "# my fan
fuzzy: 1
name: fan # short

inputs:
  heat: {range: [0, 100], partition: [low, high]}
outputs: {speed: {range: [0, 9], partition: [slow, fast]}}
rules:
  - IF heat IS high THEN speed IS fast # why
";
        assert_eq!(once, expected);
        assert_eq!(formatted(&once).unwrap(), once);
    }

    #[test]
    fn unreadable_text_is_not_changed() {
        for broken in ["a: [1", ""] {
            let found = formatted(broken);
            assert!(matches!(found, Err(LayoutError::NotYaml(_))), "{broken}");
        }
        for foreign in [
            "services:\n   web: {image: nginx}\n",
            "- flagred: 1\n",
            "inputs: {token: x}\n",
            "just text",
            "fuzzy: hello\n",
            "flagred: {image: nginx}\n",
        ] {
            let found = formatted(foreign);
            assert!(matches!(found, Err(LayoutError::Foreign)), "{foreign}");
        }
        assert_eq!(
            formatted("flagred: 1\nname:   x\n").unwrap(),
            "flagred: 1\nname: x\n"
        );
    }
}
