//! One layout for rule sets and profiles. Comments stay.

use fuzzy::format::Document;
use pretty_yaml::config::FormatOptions;

/// The width of a line.
const WIDTH: usize = 120;

/// A text in the common layout: indentation by two spaces, one space where there were several, rules with keywords in
/// capitals. It means the same, comments included.
///
/// # Errors
/// Why it cannot be laid out: it is no YAML, or would mean something else.
pub fn formatted(text: &str) -> Result<String, String> {
    let before = fuzzy::yaml::read(text).map_err(|findings| findings.to_string())?;
    let document = fuzzy::yaml::parse(text).ok();
    let capitals = document.as_ref().map(|rules| with_capitals(text, rules));
    let mut options = FormatOptions::default();
    options.layout.print_width = WIDTH;
    options.language.brace_spacing = false;
    let formatted = pretty_yaml::format_text(capitals.as_deref().unwrap_or(text), &options)
        .map_err(|error| error.to_string())?;
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
        false => Err("another layout would change its meaning".into()),
    }
}

/// A tree without its places in the text.
fn means(tree: &fuzzy::tree::Node) -> serde_json::Value {
    serde_json::to_value(tree).unwrap_or_default()
}

/// The text with each rule in one line as the rule language prints it, where nothing else is on that line.
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
    fn what_cannot_be_read_is_left_alone() {
        assert!(formatted("a: [1").is_err());
        assert_eq!(
            formatted("flagred: 1\nname:   x\n").unwrap(),
            "flagred: 1\nname: x\n"
        );
    }
}
