//! Recognition of files of other kinds or programs that were passed instead of a rule set. Most of them are recognised
//! by their first lines.

use alloc::{format, string::String, vec::Vec};

use crate::diagnostic::Diagnostic;

/// Returns a finding if a text is recognised as another kind of file.
pub(super) fn foreign(text: &str) -> Option<Diagnostic> {
    let lines = lines(text);
    let foreign = |(start, line): (usize, &str), message: String, help: &str| {
        Some(Diagnostic::error("foreign-format", start..start + line.len(), message).help(help))
    };
    let comment = |line: &str| {
        line.is_empty()
            || ["#", "%", "//", "(*"]
                .iter()
                .any(|sign| line.starts_with(sign))
    };
    let mut content = lines.iter().filter(|(_, line)| !comment(line));
    let &first = content.next()?;
    if first.1.starts_with("```") {
        let message = String::from("the rule set is inside a Markdown code fence");
        let help = "remove the lines that begin with three backticks";
        return foreign(first, message, help);
    }
    if first.1.starts_with("version https://git-lfs.") {
        let message = String::from("this is a Git LFS pointer, not the file itself");
        return foreign(first, message, "fetch the file: `git lfs pull`");
    }
    if let Some((format, section)) = headless(&lines) {
        let message = format!(
            "this looks like a file in {format} format, but its first section, `{section}`, is missing"
        );
        return foreign(first, message, "copy the whole file again");
    }
    if let Some(program) = program(first.1) {
        let message = format!("this is {program}, not a rule set in YAML");
        let help = match program {
            WEB_PAGE => "download the file itself; on GitHub, use the `Raw` button",
            CPP => "export the engine to an FLL file with `FllExporter`, and use that file",
            _ => "write inputs, outputs and rules as YAML; a rule set begins with `fuzzy: 1`",
        };
        return foreign(first, message, help);
    }
    if is_table(first.1, content.next().map(|(_, line)| *line)) {
        let message = String::from("this is a table of values, not a rule set");
        return foreign(
            first,
            message,
            "pass a rule set as the first file; if the command also reads a table, pass it as the second",
        );
    }
    None
}

/// Returns the format and the first section of a FIS or FLL file that lacks this section.
fn headless(lines: &[(usize, &str)]) -> Option<(&'static str, &'static str)> {
    let folded: Vec<String> = lines
        .iter()
        .map(|(_, line)| line.to_ascii_lowercase())
        .collect();
    let begins = |start: &str| folded.iter().any(|line| line.starts_with(start));
    if begins("[input1]") && begins("[output1]") && !begins("[system]") {
        Some(("FIS", "[System]"))
    } else if begins("inputvariable:") && begins("outputvariable:") && !begins("engine:") {
        Some(("FLL", "Engine:"))
    } else {
        None
    }
}

/// Returns whether the first two lines have the same number of cells, and this number is greater than 1.
fn is_table(first: &str, second: Option<&str>) -> bool {
    let cells = |line: &str, sign: char| line.split(sign).count();
    let is_yaml = |line: &str| {
        line.contains(": ") || line.ends_with(':') || line.starts_with(['{', '[', '-'])
    };
    second.is_some_and(|second| {
        !is_yaml(first)
            && !is_yaml(second)
            && [',', ';', '\t']
                .into_iter()
                .any(|sign| cells(first, sign) > 1 && cells(first, sign) == cells(second, sign))
    })
}

const WEB_PAGE: &str = "a web page";
const CPP: &str = "a C++ program for fuzzylite";

/// Returns the format of a text that starts with this line.
fn program(first: &str) -> Option<&'static str> {
    let folded = first.to_ascii_lowercase();
    let begins = |starts: &[&str]| starts.iter().any(|start| folded.starts_with(start));
    if begins(&["[system]"]) {
        Some("a FIS file of MATLAB")
    } else if begins(&["function_block"]) {
        Some("a file in the Fuzzy Control Language (FCL)")
    } else if begins(&["engine:"]) {
        Some("a file in the FuzzyLite Language (FLL)")
    } else if begins(&["<!doctype html", "<html"]) {
        Some(WEB_PAGE)
    } else if begins(&["fl::", "using namespace fl;"]) {
        Some(CPP)
    } else if begins(&["<"]) {
        Some("XML")
    } else if begins(&["import ", "from "]) {
        Some("Python")
    } else if ["mamfis", "sugfis", "newfis", "readfis"]
        .iter()
        .any(|call| folded.contains(call))
    {
        Some("a script of MATLAB")
    } else if first.ends_with(';') && first.contains(['(', '=']) {
        Some("a program")
    } else if is_toml(first) {
        Some("TOML")
    } else {
        None
    }
}

/// Returns whether a line is `[section]` or `key = value` in TOML.
fn is_toml(line: &str) -> bool {
    let is_name = |name: &str| {
        !name.is_empty()
            && name
                .chars()
                .all(|c| c.is_ascii_alphanumeric() || "_-.".contains(c))
    };
    let section = line
        .strip_prefix('[')
        .and_then(|line| line.strip_suffix(']'));
    let key = line.split_once(" = ").map(|(key, _)| key);
    section.or(key).is_some_and(is_name)
}

/// Returns the start of each line after its indentation, and the line without white space around it.
pub(super) fn lines(text: &str) -> Vec<(usize, &str)> {
    let mut at = 0;
    let lines = text.split_inclusive('\n').map(|line| {
        let blank = |c: char| c == '\u{feff}' || c.is_whitespace();
        let start = at + line.len() - line.trim_start_matches(blank).len();
        at += line.len();
        (start, line.trim_matches(blank))
    });
    lines.collect()
}
