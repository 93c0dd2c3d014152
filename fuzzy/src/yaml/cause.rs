//! Reasons why a text is not YAML: an unresolved merge conflict, `+` or a number at the start of each line, comments of
//! another language, spaces that YAML does not allow, an open quote, or a missing colon or space after a colon.

use alloc::{format, string::String, vec::Vec};

use granit_parser::ErrorKind;

use super::{
    foreign::{foreign, lines},
    syntax::{SyntaxError, specific_or},
};
use crate::{diagnostic::Diagnostic, format::is_key_of_variable};

/// Returns a finding if a text has an unresolved merge conflict, is in another format, has `+` or a number at the start of
/// each line, is indented with spaces that YAML does not allow, or has comments that begin with `//`. Call this only for
/// texts that could not be parsed.
pub(super) fn cause(text: &str) -> Option<Diagnostic> {
    let lines = lines(text);
    let syntax = |at: usize, length: usize, message: &str, help: &str| {
        Some(Diagnostic::error("yaml-syntax", at..at + length, message).help(help))
    };
    if let Some(&(start, line)) = lines.iter().find(|(_, line)| line.starts_with("<<<<<<< ")) {
        let help = "keep one of the two versions, and remove the lines that begin with `<<<<<<<`, `=======` and `>>>>>>>`";
        return syntax(
            start,
            line.len(),
            "a merge conflict has not been resolved",
            help,
        );
    }
    if let Some(finding) = foreign(text).or_else(|| marked(&lines)) {
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
                "indent with plain spaces; text copied from a web page may contain no-break spaces";
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

/// Returns a finding if each line begins with `+`, as in a diff, or with its number, as in a listing.
fn marked(lines: &[(usize, &str)]) -> Option<Diagnostic> {
    let lines = lines.iter().filter(|(_, line)| !line.is_empty());
    let lines: Vec<&(usize, &str)> = lines.collect();
    let &&(start, _) = lines.first().filter(|_| lines.len() > 1)?;
    let number = |line: &str| {
        let end = line.find(|c: char| !c.is_ascii_digit())?;
        let is_apart = line.get(end..)?.starts_with([' ', '\t', ':', '|', '.']);
        line.get(..end)?.parse::<usize>().ok().filter(|_| is_apart)
    };
    let numbers: Option<Vec<usize>> = lines.iter().map(|(_, line)| number(line)).collect();
    let is_numbered = numbers.is_some_and(|numbers| numbers.is_sorted_by(|a, b| a < b));
    let (message, help) = if lines.iter().all(|(_, line)| line.starts_with('+')) {
        (
            "each line begins with `+`, as in a diff",
            "remove the `+` at the start of each line",
        )
    } else if is_numbered {
        (
            "each line begins with a line number",
            "remove the line numbers",
        )
    } else {
        return None;
    };
    Some(Diagnostic::error("yaml-syntax", start..start + 1, message).help(help))
}

/// Returns a more specific finding for a syntax error, from the line in which it was detected and the lines above it: for
/// example a key without a colon, or a colon without a space after it.
pub(super) fn line(text: &str, error: &SyntaxError) -> Option<Diagnostic> {
    let finding = &error.finding;
    if matches!(
        error.kind,
        Some(
            ErrorKind::UnclosedQuotedScalar
                | ErrorKind::DocumentIndicatorInQuotedScalar
                | ErrorKind::InvalidQuotedScalarIndent
        )
    ) {
        return None;
    }
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
        let value = rest.get(..end)?;
        let message = String::from("a colon is missing after this key");
        let finding = Diagnostic::error("yaml-syntax", at..at + key.len(), message);
        let help = specific_or(
            text,
            format!("write `{key}: {value}`"),
            "write `key: [value, value]`",
        );
        return Some(finding.help(help));
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
    // For example `unit:°C` in the line above, or `name:fan` in this line.
    if let Some(finding) = [above, start]
        .into_iter()
        .find_map(|at| missing_space_after_colon(text, at))
    {
        return Some(finding);
    }
    match error.kind {
        Some(ErrorKind::SimpleKeyExpected) => {
            of_rules(text, start).or_else(|| no_colon(text, start))
        }
        Some(ErrorKind::ExpectedBlockMappingKey) => list_entry(text, start),
        Some(ErrorKind::MappingValueNotAllowed) => no_key(text, above)
            .filter(|_| above < start)
            .or_else(|| second_colon(text, start))
            .or_else(|| further_right(text, start)),
        Some(ErrorKind::InvalidTrailingDoubleQuotedScalar) => open_quote(text, start),
        _ => None,
    }
}

/// Returns a finding for a line that begins with `-` without a space, or that continues a rule but is not indented.
fn of_rules(text: &str, start: usize) -> Option<Diagnostic> {
    let (at, content) = content_at(text, start)?;
    let first = content.split(' ').next().unwrap_or("");
    if content.starts_with('-') && first.len() > 1 {
        let finding = Diagnostic::error("yaml-syntax", at..at + 1, "a space is missing after `-`");
        return Some(finding.help("begin each entry of a list with `-` and a space"));
    }
    let continues = ["AND", "OR", "THEN", "WITH"];
    if !continues
        .iter()
        .any(|word| word.eq_ignore_ascii_case(first))
    {
        return None;
    }
    let message = "this line continues a rule, but is not indented under it";
    let finding = Diagnostic::error("yaml-syntax", at..at + content.len(), message);
    Some(finding.help("indent the line more than the `-` of its rule"))
}

/// Returns a finding for an entry of a list in another column than the entries above, or without a key above it.
fn list_entry(text: &str, start: usize) -> Option<Diagnostic> {
    let (at, content) = content_at(text, start)?;
    if !content.starts_with("- ") {
        return None;
    }
    let is_below_entries =
        line_above(text, start).is_some_and(|line| line.trim().starts_with("- "));
    let (message, help) = match is_below_entries {
        true => (
            "this entry starts in a different column from the entries above it",
            "align its `-` with the `-` of the entries above",
        ),
        false => (
            "this list is not nested under a key",
            "indent the list under the key that it belongs to, such as `rules:`",
        ),
    };
    Some(Diagnostic::error("yaml-syntax", at..at + content.len(), message).help(help))
}

/// Returns a finding for a line with two colons: `description: how hot: a question`, or `unit: °C, range: [0, 40]`.
fn second_colon(text: &str, start: usize) -> Option<Diagnostic> {
    let (at, content) = content_at(text, start)?;
    let (key, value) = content.split_once(": ")?;
    let (before, _) = value.split_once(": ")?;
    let key = key.trim_start_matches("- ");
    let colon = at + content.len() - value.len() + before.len();
    let is_second_key = before.rsplit_once(", ").is_some_and(|(_, key)| is_key(key));
    let (message, help) = match is_second_key {
        true => (
            "a second key begins on this line",
            "write each key on a line of its own".into(),
        ),
        false => {
            let value = value.trim().replace('"', "\\\"");
            let general = "put the text in quotes";
            (
                "text that contains `: ` must be in quotes",
                specific_or(text, format!("write `{key}: \"{value}\"`"), general),
            )
        }
    };
    Some(Diagnostic::error("yaml-syntax", colon..colon + 1, message).help(help))
}

/// Returns a finding for a key that is indented more than the key above, and for a colon in a text of several lines.
fn further_right(text: &str, start: usize) -> Option<Diagnostic> {
    let (at, content) = content_at(text, start)?;
    let line = line_above(text, start)?;
    let is_more = at - start > line.len() - line.trim_start().len();
    let (message, help) = match line.trim().split_once(": ") {
        Some((key, _)) if is_key(key) && is_more => (
            "this key is indented more than the key above it",
            specific_or(
                text,
                format!("begin it in the same column as `{key}:`"),
                "begin all keys of a mapping in the same column",
            ),
        ),
        None if is_more => (
            "text that contains `: ` must be in quotes",
            "put the whole text in quotes: write `\"` at its beginning and at its end".into(),
        ),
        _ => return None,
    };
    let colon = content.find(": ").map_or(content.len(), |colon| colon + 1);
    Some(Diagnostic::error("yaml-syntax", at..at + colon, message).help(help))
}

/// Returns the last line above `start` that is neither empty nor a comment.
fn line_above(text: &str, start: usize) -> Option<&str> {
    let mut above = text.get(..start)?.lines().rev();
    above.find(|line| !line.trim().is_empty() && !line.trim().starts_with('#'))
}

/// Returns the line that starts at `start` without its indentation, and the position of its content.
fn content_at(text: &str, start: usize) -> Option<(usize, &str)> {
    let line = text.get(start..)?.lines().next()?;
    let content = line.trim_start();
    Some((start + line.len() - content.len(), content.trim_end()))
}

/// Returns a finding for a line such as `unit:°C`.
fn missing_space_after_colon(text: &str, start: usize) -> Option<Diagnostic> {
    let (at, content) = content_at(text, start)?;
    let (key, value) = content.split_once(':')?;
    if !is_key(key) || value.is_empty() || value.starts_with([' ', '/']) || value.contains(": ") {
        return None;
    }
    let message = "a space is missing after the colon";
    let finding = Diagnostic::error("yaml-syntax", at..at + content.len(), message);
    Some(finding.help(specific_or(
        text,
        format!("write `{key}: {value}`"),
        "write `key: value`",
    )))
}

/// Returns a finding for a line such as `name fan` or `name = fan`.
fn no_colon(text: &str, start: usize) -> Option<Diagnostic> {
    let (at, content) = content_at(text, start)?;
    let words = content.split([' ', '=']).filter(|word| !word.is_empty());
    let words: Vec<&str> = words.collect();
    let [key, value] = words.as_slice() else {
        return no_key(text, start);
    };
    if !is_key(key) || content.contains(": ") {
        return no_key(text, start);
    }
    let message = "a colon is missing after this key";
    let finding = Diagnostic::error("yaml-syntax", at..at + content.len(), message);
    let general = "write `key: value`, with a colon and a space";
    Some(finding.help(specific_or(
        text,
        format!("write `{key}: {value}`"),
        general,
    )))
}

/// Returns a finding for a line of plain text in place of a key, such as a comment without its `#`.
fn no_key(text: &str, start: usize) -> Option<Diagnostic> {
    let (at, content) = content_at(text, start)?;
    let is_plain = !content.is_empty()
        && !content.contains(": ")
        && !content.starts_with(['#', '-', '{', '[', '"', '\''])
        && !content.ends_with([':', ',', '{', '[', '|', '>']);
    // A text or a rule may continue on this line.
    let above = text.get(..start)?.trim_end();
    let above = above.get(above.rfind('\n').map_or(0, |at| at + 1)..)?;
    let is_indented_more = at - start > above.len() - above.trim_start().len();
    let continues = is_indented_more && !above.is_empty() && !above.ends_with(':');
    let first = content.split(' ').next().unwrap_or("");
    let is_of_rule = ["IF", "AND", "OR", "THEN", "WITH"]
        .iter()
        .any(|word| word.eq_ignore_ascii_case(first));
    (is_plain && !continues && !is_of_rule).then(|| {
        let message = "expected a key, found a line of plain text";
        let finding = Diagnostic::error("yaml-syntax", at..at + content.len(), message);
        finding.help("remove the line, or begin it with `#` to make it a comment")
    })
}

/// Returns a finding for a double quote that is not closed in its line; the quote of a later line, at `start`, closes it.
fn open_quote(text: &str, start: usize) -> Option<Diagnostic> {
    let mut at = 0;
    let mut open = None;
    for line in text.get(..start)?.split_inclusive('\n') {
        let code = line.split(" #").next().unwrap_or(line);
        let quotes = code.match_indices('"');
        let quotes =
            quotes.filter(|(quote, _)| !code.get(..*quote).is_some_and(|c| c.ends_with('\\')));
        let quotes: Vec<(usize, &str)> = quotes.collect();
        if quotes.len() % 2 == 1 {
            open = match open {
                None => quotes.last().map(|(quote, _)| at + quote),
                Some(_) => None,
            };
        }
        at += line.len();
    }
    let message = "the quote is not closed on this line";
    let finding = open.map(|at| Diagnostic::error("yaml-syntax", at..at + 1, message));
    finding.map(|finding| finding.help("add the closing quote"))
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
            let message = "this line is indented more than the following lines of the same mapping";
            let finding = Diagnostic::error("yaml-syntax", at..at + str::len(line), message);
            let key = line.split(':').next().unwrap_or("");
            return Some(finding.help(match is_key_of_variable(key) {
                true => "if the name of an input or output is missing, write it above this line",
                false => "begin all keys of a mapping in the same column",
            }));
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
        let message = String::from("a space is missing after the colon");
        Diagnostic::error("yaml-syntax", colon..colon + 1, message)
            .help("write a space after the colon")
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
        let message = String::from("a colon is missing after this key");
        let help = specific_or(
            text,
            format!("write `{content}:`"),
            "write a colon after it",
        );
        Diagnostic::error("yaml-syntax", at..at + content.len(), message).help(help)
    })
}

/// If a comment follows the position of a syntax error in a rule, adds to the help that `#` begins a comment.
pub(super) fn comment(text: &str, finding: &mut Diagnostic) {
    let rest = text.get(finding.span.end..).unwrap_or("");
    let rest = rest.lines().next().unwrap_or("").trim_start();
    if finding.code == "rule-syntax"
        && let Some(comment) = rest.strip_prefix('#')
        && let Some(help) = &mut finding.help
    {
        let mut words = comment.split_whitespace();
        let is_rule = words.any(|word| ["AND", "OR", "THEN"].contains(&word));
        match is_rule {
            true => *help = "remove the `#`: it begins a comment".into(),
            false => help.push_str("; `#` begins a comment"),
        }
    }
}
