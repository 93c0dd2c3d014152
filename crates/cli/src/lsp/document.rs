//! An open text as the protocol represents it: its findings, and the conversion of the editor's positions.

use std::{
    ops::Range,
    path::{Path, PathBuf},
};

use flagred_authoring::Document;
use fuzzy::diagnostic::{Diagnostic, Severity};
use gen_lsp_types as lsp;
use percent_encoding::percent_decode_str;

use crate::profile;

/// Opens a text. The rule set of a profile is searched for in the same folder.
pub(super) fn open(uri: &lsp::Uri, text: String) -> Document {
    let path = path(uri);
    let folder = path.as_deref().and_then(Path::parent);
    Document::new(text, |parsed| {
        profile::rules(parsed, folder).ok().map(|(_, text)| text)
    })
}

/// Returns the findings of a text.
pub(super) fn diagnostics(
    document: &Document,
    uri: &lsp::Uri,
    encoding: Encoding,
) -> Vec<lsp::Diagnostic> {
    let text = document.text();
    let shown = |finding: &Diagnostic| {
        let mut message = finding.message.clone();
        if let Some(help) = &finding.help {
            message = format!("{message}\nhelp: {help}");
        }
        let related = finding.related.iter().map(|related| {
            let range = encoding.range(text, &related.span);
            lsp::DiagnosticRelatedInformation {
                location: lsp::Location {
                    uri: uri.clone(),
                    range,
                },
                message: related.message.clone(),
            }
        });
        lsp::Diagnostic {
            range: encoding.range(text, &finding.span),
            severity: Some(match finding.severity {
                Severity::Error => lsp::DiagnosticSeverity::Error,
                Severity::Warning => lsp::DiagnosticSeverity::Warning,
                Severity::Note => lsp::DiagnosticSeverity::Information,
            }),
            code: Some(finding.code.to_owned().into()),
            source: Some("flagred".into()),
            message: message.into(),
            related_information: Some(related.collect()),
            ..lsp::Diagnostic::default()
        }
    };
    document.findings().0.iter().map(shown).collect()
}

fn path(uri: &lsp::Uri) -> Option<PathBuf> {
    let encoded = uri.0.strip_prefix("file://")?;
    let path = percent_decode_str(encoded).decode_utf8().ok()?;
    Some(PathBuf::from(&*path))
}

/// The unit in which an editor counts the columns of a line.
#[derive(Clone, Copy, Default)]
pub(super) enum Encoding {
    Utf8,
    #[default]
    Utf16,
}

impl Encoding {
    /// UTF-8 if the editor supports it, else the protocol's default.
    pub(super) fn of(initialize: &serde_json::Value) -> Encoding {
        let offered = initialize.pointer("/capabilities/general/positionEncodings");
        let offered = offered.and_then(|offered| offered.as_array());
        match offered.is_some_and(|all| all.iter().any(|one| one == "utf-8")) {
            true => Encoding::Utf8,
            false => Encoding::Utf16,
        }
    }

    pub(super) fn kind(self) -> lsp::PositionEncodingKind {
        match self {
            Encoding::Utf8 => lsp::PositionEncodingKind::UTF8,
            Encoding::Utf16 => lsp::PositionEncodingKind::UTF16,
        }
    }

    fn width(self, letter: char) -> usize {
        match self {
            Encoding::Utf8 => letter.len_utf8(),
            Encoding::Utf16 => letter.len_utf16(),
        }
    }

    /// Returns the byte offset of a position; the end of the line if the column is beyond it.
    pub(super) fn offset(self, text: &str, at: lsp::Position) -> usize {
        let mut start = 0;
        for line in text.split_inclusive('\n').take(at.line as usize) {
            start += line.len();
        }
        let line = text
            .get(start..)
            .unwrap_or("")
            .split('\n')
            .next()
            .unwrap_or("");
        let mut column = 0;
        for (offset, letter) in line.char_indices() {
            if column >= at.character as usize {
                return start + offset;
            }
            column += self.width(letter);
        }
        start + line.len()
    }

    fn position(self, text: &str, offset: usize) -> lsp::Position {
        let mut end = offset.min(text.len());
        while !text.is_char_boundary(end) {
            end -= 1;
        }
        let before = text.get(..end).unwrap_or("");
        let line = before.matches('\n').count();
        let start = before.rfind('\n').map_or(0, |at| at + 1);
        let letters = before.get(start..).unwrap_or("").chars();
        let column: usize = letters.map(|letter| self.width(letter)).sum();
        lsp::Position {
            line: u32::try_from(line).unwrap_or(u32::MAX),
            character: u32::try_from(column).unwrap_or(u32::MAX),
        }
    }

    pub(super) fn range(self, text: &str, span: &Range<usize>) -> lsp::Range {
        lsp::Range {
            start: self.position(text, span.start),
            end: self.position(text, span.end.max(span.start)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn positions_are_counted_as_by_the_editor() {
        let text = "a: °C 𝛼 x\nb: y";
        let x = text.find('x').unwrap();
        for (encoding, column) in [(Encoding::Utf8, 12), (Encoding::Utf16, 9)] {
            let there = lsp::Position {
                line: 0,
                character: column,
            };
            assert_eq!(encoding.position(text, x), there);
            assert_eq!(encoding.offset(text, there), x);
            let far = lsp::Position {
                line: 0,
                character: 99,
            };
            assert_eq!(encoding.offset(text, far), text.find('\n').unwrap());
            let below = lsp::Position {
                line: 9,
                character: 0,
            };
            assert_eq!(encoding.offset(text, below), text.len());
        }
    }
}
