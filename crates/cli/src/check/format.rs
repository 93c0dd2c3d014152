//! Findings for programs that show them in the source: SARIF 2.1.0, and workflow commands of GitHub.

use std::{collections::BTreeSet, io, io::Write};

use fuzzy::{
    diagnostic::{Diagnostic, Position, Severity},
    drawing::{visible, visible_lines},
};
use serde_json::{Value, json};

/// The output format of findings.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(super) enum Format {
    /// Text for people, with the source lines of the findings
    Text,
    /// A JSON document for each file
    Json,
    /// One SARIF 2.1.0 document
    Sarif,
    /// Commands that annotate a change on GitHub
    Github,
}

/// A SARIF document under construction.
#[derive(Default)]
pub(super) struct Sarif {
    codes: BTreeSet<&'static str>,
    results: Vec<Value>,
}

impl Sarif {
    pub(super) fn add(&mut self, findings: &[Diagnostic], file: &str, text: &str) {
        let uri = uri(file);
        for finding in findings {
            self.codes.insert(finding.code);
            let level = match finding.severity {
                Severity::Error => "error",
                Severity::Warning => "warning",
                Severity::Note => "note",
            };
            let place = |start: usize, end: usize| {
                let (start, end) = (Position::of(text, start), Position::of(text, end));
                json!({
                    "artifactLocation": {"uri": uri},
                    "region": {
                        "startLine": start.line,
                        "startColumn": start.column,
                        "endLine": end.line,
                        "endColumn": end.column,
                    },
                })
            };
            let related = finding.related.iter().map(|related| {
                json!({
                    "physicalLocation": place(related.span.start, related.span.end),
                    "message": {"text": related.message},
                })
            });
            self.results.push(json!({
                "ruleId": finding.code,
                "level": level,
                "message": {"text": message(finding)},
                "locations": [{"physicalLocation": place(finding.span.start, finding.span.end)}],
                "relatedLocations": related.collect::<Vec<_>>(),
            }));
        }
    }

    pub(super) fn write(self, out: &mut impl Write) -> io::Result<()> {
        let rules = self.codes.iter().map(|code| json!({"id": code}));
        let document = json!({
            "$schema": "https://json.schemastore.org/sarif-2.1.0.json",
            "version": "2.1.0",
            "runs": [{
                "tool": {"driver": {
                    "name": "flagred",
                    "version": env!("CARGO_PKG_VERSION"),
                    "rules": rules.collect::<Vec<_>>(),
                }},
                "columnKind": "unicodeCodePoints",
                "results": self.results,
            }],
        });
        serde_json::to_writer_pretty(&mut *out, &document).map_err(io::Error::from)?;
        writeln!(out)
    }
}

/// Writes a line `::error file=..,line=..::..` for each finding.
pub(super) fn write_github(
    out: &mut impl Write,
    findings: &[Diagnostic],
    file: &str,
    text: &str,
) -> io::Result<()> {
    for finding in findings {
        let level = match finding.severity {
            Severity::Error => "error",
            Severity::Warning => "warning",
            Severity::Note => "notice",
        };
        let start = Position::of(text, finding.span.start);
        let end = Position::of(text, finding.span.end);
        write!(
            out,
            "::{level} file={},line={},col={},endLine={}",
            property(&visible(file)),
            start.line,
            start.column,
            end.line
        )?;
        // GitHub accepts an end column only if the finding is within one line.
        if start.line == end.line {
            write!(out, ",endColumn={}", end.column)?;
        }
        let message = message(finding);
        let message = visible_lines(&message);
        writeln!(out, ",title={}::{}", property(finding.code), data(&message))?;
    }
    Ok(())
}

/// The message of a finding, with its help on a separate line.
fn message(finding: &Diagnostic) -> String {
    match &finding.help {
        Some(help) => format!("{}\nhelp: {help}", finding.message),
        None => finding.message.clone(),
    }
}

/// Converts a path to a reference to a file: relative to the working directory, or absolute.
fn uri(file: &str) -> String {
    let file = file.replace(std::path::MAIN_SEPARATOR, "/");
    let mut uri = String::from(if file.starts_with('/') { "file://" } else { "" });
    for byte in file.bytes() {
        match byte {
            b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'-' | b'.' | b'_' | b'~' | b'/' => {
                uri.push(char::from(byte));
            }
            _ => uri.push_str(&format!("%{byte:02X}")),
        }
    }
    uri
}

fn data(text: &str) -> String {
    let text = text.replace('%', "%25").replace('\r', "%0D");
    text.replace('\n', "%0A")
}

fn property(text: &str) -> String {
    data(text).replace(':', "%3A").replace(',', "%2C")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commands_are_escaped() {
        let mut out = Vec::new();
        let text = "fuzzy: 1\nnäme: x\n";
        let finding =
            Diagnostic::note("a-code", 9..14, "50 % of\r\nall: x, y").help("see\n::error::");
        write_github(&mut out, &[finding], "a,b:c%.yaml", text).unwrap();
        assert_eq!(
            String::from_utf8(out).unwrap(),
            "::notice file=a%2Cb%3Ac%25.yaml,line=2,col=1,endLine=2,endColumn=5,title=a-code\
             ::50 %25 of%0D%0Aall: x, y%0Ahelp: see%0A::error::\n"
        );
    }

    #[test]
    fn a_path_is_a_uri() {
        for (file, expected) in [
            ("rules/fan.yaml", "rules/fan.yaml"),
            ("-", "-"),
            ("my fan:ü.yaml", "my%20fan%3A%C3%BC.yaml"),
            ("/tmp/100%.yaml", "file:///tmp/100%25.yaml"),
        ] {
            assert_eq!(uri(file), expected);
        }
    }
}
