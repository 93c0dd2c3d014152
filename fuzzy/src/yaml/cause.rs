//! Reasons why a text is not YAML: the format of another program, a Markdown fence, or comments of
//! another language.

use alloc::{format, string::String, vec::Vec};

use crate::diagnostic::Diagnostic;

/// Returns a finding if a text is in another format, or is surrounded by or contains characters that YAML does not
/// allow. Call this only for texts that could not be parsed.
pub(super) fn cause(text: &str) -> Option<Diagnostic> {
    let mut at = 0;
    let lines: Vec<(usize, &str)> = text
        .split_inclusive('\n')
        .map(|line| {
            let blank = |c: char| c == '\u{feff}' || c.is_whitespace();
            let start = at + line.len() - line.trim_start_matches(blank).len();
            at += line.len();
            (start, line.trim_matches(blank))
        })
        .collect();
    let foreign = |(start, line): (usize, &str), message: String, help: &str| {
        Some(Diagnostic::error("foreign-format", start..start + line.len(), message).help(help))
    };
    let comment = |line: &str| {
        line.is_empty()
            || ["#", "%", "//", "(*"]
                .iter()
                .any(|sign| line.starts_with(sign))
    };
    let &first = lines.iter().find(|(_, line)| !comment(line))?;
    if first.1.starts_with("```") {
        let message = String::from("a Markdown fence stands around the rule set");
        let help = "remove the lines that begin with three backticks";
        return foreign(first, message, help);
    }
    if let Some(program) = program(first.1) {
        let message = format!("this is {program}, not a rule set in YAML");
        let help = "write inputs, outputs and rules as YAML; a rule set begins with `fuzzy: 1`";
        return foreign(first, message, help);
    }
    let slashes = lines.iter().find(|(_, line)| line.starts_with("//"))?;
    let span = slashes.0..slashes.0 + 2;
    Some(
        Diagnostic::error("yaml-syntax", span, "`//` does not begin a comment")
            .help("a comment begins with `#`"),
    )
}

/// Returns the format of a text that starts with this line.
fn program(first: &str) -> Option<&'static str> {
    let folded = first.to_lowercase();
    let begins = |starts: &[&str]| starts.iter().any(|start| folded.starts_with(start));
    if begins(&["[system]", "[input1]"]) {
        Some("a FIS file of MATLAB")
    } else if begins(&["function_block"]) {
        Some("a text in the Fuzzy Control Language (FCL)")
    } else if begins(&["engine:", "inputvariable:"]) {
        Some("a text in the FuzzyLite Language (FLL)")
    } else if begins(&["<"]) {
        Some("XML")
    } else if begins(&["import ", "from "]) {
        Some("Python")
    } else if ["mamfis", "sugfis", "newfis", "readfis"]
        .iter()
        .any(|call| folded.contains(call))
    {
        Some("a script of MATLAB")
    } else {
        None
    }
}
