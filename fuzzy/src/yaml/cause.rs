//! Reasons why a text is not YAML: an unresolved merge conflict, the format of another program, a Markdown fence,
//! comments of another language, spaces that YAML does not allow, or a missing colon or space after a colon.

use alloc::{format, string::String, vec::Vec};

use crate::diagnostic::Diagnostic;

/// Returns a finding if a text has an unresolved merge conflict, is in another format, is indented with spaces that YAML
/// does not allow, or has comments that begin with `//`. Call this only for texts that could not be parsed.
pub(super) fn cause(text: &str) -> Option<Diagnostic> {
    let lines = lines(text);
    let syntax = |at: usize, length: usize, message: &str, help: &str| {
        Some(Diagnostic::error("yaml-syntax", at..at + length, message).help(help))
    };
    if let Some(&(start, line)) = lines.iter().find(|(_, line)| line.starts_with("<<<<<<< ")) {
        let help =
            "keep one of the two versions, and remove the lines `<<<<<<<`, `=======` and `>>>>>>>`";
        return syntax(start, line.len(), "a merge conflict is not resolved", help);
    }
    if let Some(finding) = foreign(text) {
        return Some(finding);
    }
    let is_blank = |c: char| c.is_whitespace() && c != ' ' && c != '\t' && c != '\r' && c != '\n';
    let mut at = 0;
    for line in text.split_inclusive('\n') {
        let indent = line.len() - line.trim_start().len();
        let indented = line.get(..indent).unwrap_or("");
        if let Some(found) = indented.find(is_blank)
            && !line.trim().is_empty()
        {
            let blank = indented.get(found..).and_then(|rest| rest.chars().next());
            let length = blank.map_or(0, char::len_utf8);
            let help =
                "indent with plain spaces; text that is copied from a web page may contain others";
            return syntax(
                at + found,
                length,
                "the line is indented with a no-break space",
                help,
            );
        }
        at += line.len();
    }
    let slashes = lines.iter().find(|(_, line)| line.starts_with("//"))?;
    syntax(
        slashes.0,
        2,
        "`//` does not begin a comment",
        "a comment begins with `#`",
    )
}

/// Returns the start of each line after its indentation, and the line without white space around it.
fn lines(text: &str) -> Vec<(usize, &str)> {
    let mut at = 0;
    let lines = text.split_inclusive('\n').map(|line| {
        let blank = |c: char| c == '\u{feff}' || c.is_whitespace();
        let start = at + line.len() - line.trim_start_matches(blank).len();
        at += line.len();
        (start, line.trim_matches(blank))
    });
    lines.collect()
}

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
        let message = String::from("a Markdown fence surrounds the rule set");
        let help = "remove the lines that begin with three backticks";
        return foreign(first, message, help);
    }
    if first.1.starts_with("version https://git-lfs.") {
        let message = String::from("this is a pointer of Git LFS, not the file itself");
        return foreign(first, message, "fetch the file: `git lfs pull`");
    }
    if let Some((format, section)) = headless(&lines) {
        let message = format!("this looks like {format} without its first section `{section}`");
        return foreign(
            first,
            message,
            "look for the lines that are missing at its start",
        );
    }
    if let Some(program) = program(first.1) {
        let message = format!("this is {program}, not a rule set in YAML");
        let help = "write inputs, outputs and rules as YAML; a rule set begins with `fuzzy: 1`";
        return foreign(first, message, help);
    }
    if is_table(first.1, content.next().map(|(_, line)| *line)) {
        let message = String::from("this is a table of values, not a rule set");
        return foreign(
            first,
            message,
            "name a file with a rule set; a command that also reads a table takes it after the rule set",
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

/// Returns whether the first two lines look like a table: not YAML, with the same number of cells, at least two.
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

/// Explains a syntax error by a key without a space after its colon, or without a colon, in the same line or in the
/// line before it.
pub(super) fn line(text: &str, finding: &Diagnostic) -> Option<Diagnostic> {
    let before = text.get(..finding.span.start)?;
    let start = before.rfind('\n').map_or(0, |at| at + 1);
    // For example `{triangle [30, 50, 70]}`.
    let rest = text.get(finding.span.start..)?;
    let key = before
        .get(start..)?
        .trim_end()
        .rsplit([' ', '{', ','])
        .next()?;
    if rest.starts_with(['[', '{']) && is_key(key) && before.ends_with(' ') {
        let at = before.trim_end().len() - key.len();
        let end = rest.find([']', '}', '\n']).map_or(0, |end| end + 1);
        rest.get(..end)?;
        let message = String::from("a colon is missing before a bracket");
        let finding = Diagnostic::error("yaml-syntax", at..at + key.len(), message);
        return Some(finding.help("write `key: [value, value]`"));
    }
    // For example `range:[0, 40]` in this line or the one above, or a line above without its colon.
    if let Some(finding) = brackets_behind_colon(text, finding.span.start, start) {
        return Some(finding);
    }
    let above = before.get(..start).map_or(0, |before| {
        before.trim_end().rfind('\n').map_or(0, |at| at + 1)
    });
    let bare = [start, above].into_iter();
    if let Some(finding) = bare.filter_map(|at| key_without_colon(text, at)).next() {
        return Some(finding);
    }
    if let Some(finding) = indented_more(text, start) {
        return Some(finding);
    }
    // For example `unit:°C` in the line above.
    let above = before.get(..start)?.trim_end();
    let at = above.rfind('\n').map_or(0, |at| at + 1);
    let line = above.get(at..)?;
    let content = line.trim_start();
    let (key, value) = content.split_once(':')?;
    if !is_key(key) || value.is_empty() || value.starts_with([' ', '/']) || value.contains(": ") {
        return None;
    }
    let at = at + line.len() - content.len();
    // The message does not quote the text, which may be any file.
    let message = String::from("a space is missing after a colon");
    let finding = Diagnostic::error("yaml-syntax", at..at + content.len(), message);
    Some(finding.help("write `key: value`"))
}

/// Returns a finding if the line that starts at `start` is indented less than the first line of its mapping.
fn indented_more(text: &str, start: usize) -> Option<Diagnostic> {
    let indent = |line: &str| line.len() - line.trim_start().len();
    let line = text.get(start..)?.lines().next()?;
    let here = indent(line);
    if line.get(..here)?.contains('\t') {
        return None;
    }
    let mut first = None;
    let mut end = start;
    for line in text.get(..start)?.split_inclusive('\n').rev() {
        end -= line.len();
        let content = line.trim();
        if content.is_empty() || content.starts_with('#') {
            continue;
        }
        if line.get(..indent(line))?.contains('\t') {
            return None;
        }
        if indent(line) < here {
            let (at, line) = first.filter(|_| content.ends_with(':'))?;
            let message =
                String::from("the line is indented more than the later ones of its mapping");
            let finding = Diagnostic::error("yaml-syntax", at..at + str::len(line), message);
            let help = "begin the keys of one mapping in the same column; if these are the keys of an input or output, write its name above them";
            return Some(finding.help(help));
        }
        if indent(line) == here {
            return None;
        }
        first = Some((end + indent(line), content));
    }
    None
}

fn is_key(key: &str) -> bool {
    !key.is_empty()
        && key
            .chars()
            .all(|c| c.is_alphanumeric() || c == '_' || c == '-')
}

/// Returns a finding if a bracket directly follows a colon: the colon at `at`, or the colon after the key at the
/// beginning of the line at `start` or of the line before it.
fn brackets_behind_colon(text: &str, at: usize, start: usize) -> Option<Diagnostic> {
    let finding = |colon: usize| {
        let message = String::from("a space is missing after a colon");
        let help = "write `key: [value, value]`, with a space after the colon";
        Diagnostic::error("yaml-syntax", colon..colon + 1, message).help(help)
    };
    let here = text.get(at..)?;
    if here.starts_with(":[") || here.starts_with(":{") {
        return Some(finding(at));
    }
    let above = text.get(..start.saturating_sub(1))?;
    let above = above.rfind('\n').map_or(0, |at| at + 1);
    [start, above].into_iter().find_map(|at| {
        let line = text.get(at..)?.lines().next()?;
        let content = line.trim_start();
        let (key, value) = content.split_once(':')?;
        let is_meant = is_key(key) && value.starts_with(['[', '{']);
        is_meant.then(|| finding(at + line.len() - content.len() + key.len()))
    })
}

/// Returns a finding if the line that starts at `start` consists only of a key without a colon, and the next line is
/// an indented `key: value`.
fn key_without_colon(text: &str, start: usize) -> Option<Diagnostic> {
    let mut lines = text.get(start..)?.lines();
    let (line, below) = (lines.next()?, lines.next()?);
    let indent = |line: &str| line.len() - line.trim_start().len();
    let (at, content) = (start + indent(line), line.trim());
    let is_meant = is_key(content) && indent(below) > indent(line) && below.contains(':');
    is_meant.then(|| {
        let message = String::from("a colon is missing after a key");
        Diagnostic::error("yaml-syntax", at..at + content.len(), message).help("write `key:`")
    })
}

/// If a comment follows the position of a syntax error in a rule, adds to the help that `#` begins a comment.
pub(super) fn comment(text: &str, finding: &mut Diagnostic) {
    let rest = text.get(finding.span.end..).unwrap_or("");
    let rest = rest.lines().next().unwrap_or("").trim_start();
    if finding.code == "rule-syntax"
        && rest.starts_with('#')
        && let Some(help) = &mut finding.help
    {
        help.push_str("; `#` begins a comment");
    }
}

/// Returns the format of a text that starts with this line.
fn program(first: &str) -> Option<&'static str> {
    let folded = first.to_ascii_lowercase();
    let begins = |starts: &[&str]| starts.iter().any(|start| folded.starts_with(start));
    if begins(&["[system]"]) {
        Some("a FIS file of MATLAB")
    } else if begins(&["function_block"]) {
        Some("a text in the Fuzzy Control Language (FCL)")
    } else if begins(&["engine:"]) {
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
