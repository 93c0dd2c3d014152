//! Reads files with rule sets and profiles, and reports their errors on standard error.

use std::{
    fs,
    io::{self, Read, Write},
    path::Path,
};

use flagred_flightlog::FileKind;
use flagred_report::diagnostics::{self, Style};
use fuzzy::{
    diagnostic::{Diagnostic, Findings, nearest},
    yaml::LARGEST_BYTES,
};

use crate::{
    built_in,
    failure::{Failure, cannot_read},
};

/// Draws findings with their source lines. Pass `colored` text through `anstream`, which removes colours that a terminal
/// does not support.
pub(crate) fn draw(findings: &[Diagnostic], file: &str, text: &str, colored: bool) -> String {
    let style = Style {
        colored,
        advice: command,
        all: "`flagred check --json` lists them",
        is_quoted: is_meant_as_rules,
    };
    diagnostics::draw(findings, file, text, style)
}

/// Returns whether a text looks like a profile or a rule set, which may be in the format of another program.
pub(crate) fn is_meant_as_rules(text: &str) -> bool {
    flagred_interchange::Format::of(text).is_some() || flagred::loaded::is_meant_as_rules(text)
}

/// Returns the command that helps with a finding. It is added here because the engine must not depend on the
/// command line.
fn command(code: &str) -> Option<&'static str> {
    match code {
        "empty-file" => Some("`flagred new NAME` writes a rule set to start from"),
        "no-rules" => Some("`flagred learn` writes rules from data"),
        "several-blocks" => Some("`flagred import --block NAME` writes one in YAML"),
        "not-monotone" => Some("`flagred explain` shows the rules that fire at a point"),
        _ => None,
    }
}

/// Draws findings on standard error.
pub(crate) fn show(findings: &Findings, file: &str, text: &str) {
    let mut err = anstream::stderr().lock();
    // A write fails if standard error is closed. That cannot be reported elsewhere.
    let _ = write!(err, "{}", draw(&findings.0, file, text, true));
}

/// Draws the findings that make a file unusable on standard error, and returns the failure.
pub(crate) fn refuse(findings: &Findings, file: &str, text: &str) -> Failure {
    show(findings, file, text);
    Failure::shown(3)
}

/// Reads a rule set or a profile, or standard input for `-`.
pub(crate) fn read_text(path: &Path) -> Result<String, Failure> {
    let shown = path.display();
    let bytes = if path == Path::new("-") {
        read_up_to_limit(io::stdin().lock())
    } else {
        fs::File::open(path).and_then(read_up_to_limit)
    };
    let shown = shown.to_string();
    text(whole(bytes, &shown)?, &shown)
}

/// Reads the bytes of a rule set or profile that is open already.
pub(crate) fn read_bytes(file: fs::File, shown: &str) -> Result<Vec<u8>, Failure> {
    whole(read_up_to_limit(file), shown)
}

/// Returns the bytes of a rule set or profile, or the failure to report if it cannot be read or is too large.
fn whole(bytes: io::Result<Vec<u8>>, shown: &str) -> Result<Vec<u8>, Failure> {
    let bytes = bytes.map_err(|error| {
        let failure = cannot_read(shown, &error);
        let stem = shown.strip_suffix(".yaml").unwrap_or(shown);
        let near = nearest(stem, built_in::profile_names());
        match near.filter(|_| error.kind() == io::ErrorKind::NotFound) {
            Some(name) => failure.help(format!("did you mean the built-in `{name}`?")),
            None => failure,
        }
    })?;
    if bytes.len() <= LARGEST_BYTES || flagred_flightlog::kind_of(&bytes).is_some() {
        return Ok(bytes);
    }
    let limit = LARGEST_BYTES / 1_000_000;
    let failure = Failure::unreadable(format!("`{shown}` is larger than {limit} MB"));
    Err(failure.help("rule sets and profiles are small YAML files"))
}

/// Decodes the text of a rule set or profile.
pub(crate) fn text(bytes: Vec<u8>, shown: &str) -> Result<String, Failure> {
    if let Some((what, help)) = foreign(&bytes, shown) {
        return Err(Failure::unreadable(format!("`{shown}` is {what}")).help(help));
    }
    decoded(bytes).map_err(|error| error.failure(shown))
}

/// Returns whether bytes begin with a byte order mark of UTF-16.
pub(crate) fn is_utf16(bytes: &[u8]) -> bool {
    matches!(bytes.get(..2), Some([0xff, 0xfe] | [0xfe, 0xff]))
}

/// Recognises bytes that are not a rule set or profile; also returns what to do.
fn foreign(bytes: &[u8], shown: &str) -> Option<(&'static str, String)> {
    const RULES: &str = "a rule set is a text file that begins with `fuzzy: 1`";
    if is_utf16(bytes) {
        return None;
    }
    if is_utf16_without_mark(bytes) {
        return Some((
            "text in UTF-16 without a byte order mark",
            "save the file as UTF-8".to_owned(),
        ));
    }
    match flagred_flightlog::kind_of(bytes) {
        // Other text files are accepted here, because the check of rule sets reports what they contain.
        Some(kind) if kind.is_text() => {}
        Some(kind) if kind != FileKind::LOG => {
            return Some((kind.name, kind.help.unwrap_or(RULES).replace("FILE", shown)));
        }
        None if !flagred_flightlog::is_text_log(bytes) => {}
        _ => {
            return Some((
                "a flight log, not a rule set",
                format!("`flagred assess {shown}` assesses a flight"),
            ));
        }
    }
    let has_ending = |ending: &[&str]| crate::output::has_ending(Path::new(shown), ending);
    if has_ending(&["md", "rst", "html"])
        && !bytes
            .split(|byte| *byte == b'\n')
            .any(|line| line.starts_with(b"fuzzy:") || line.starts_with(b"flagred:"))
    {
        return Some(("a document, not a rule set", RULES.to_owned()));
    }
    bytes
        .contains(&0)
        .then(|| ("not a text file", RULES.to_owned()))
}

/// Returns whether bytes are probably UTF-16 without a byte order mark: one byte of each ASCII letter is 0.
fn is_utf16_without_mark(bytes: &[u8]) -> bool {
    const LOOKED_AT: usize = 1000;
    let (pairs, _) = bytes.as_chunks::<2>();
    let pairs = || pairs.iter().take(LOOKED_AT);
    let halves = pairs()
        .filter(|pair| (pair[0] == 0) != (pair[1] == 0))
        .count();
    2 * halves > pairs().count()
}

/// The reason why bytes are not valid text.
struct NoText {
    /// The line with the first invalid byte, and that byte; `None` in UTF-16.
    at: Option<(usize, u8)>,
}

impl NoText {
    fn failure(&self, file: &str) -> Failure {
        let failure = Failure::unreadable(match self.at {
            Some((line, byte)) => {
                format!("`{file}` is not UTF-8: line {line} contains the byte {byte:02X}")
            }
            None => format!(
                "`{file}` is not valid UTF-16, although it begins with a UTF-16 byte order mark"
            ),
        });
        failure.help(match self.at {
            // Smaller bytes are control characters in Latin-1, so the file is probably not Latin-1
            // text.
            Some((_, byte)) if byte >= 0xa0 => {
                let letter = char::from(byte);
                format!("the file may be in Latin-1, where the byte is `{letter}`; save the file as UTF-8")
            }
            _ => String::from("save the file as UTF-8"),
        })
    }
}

/// Decodes the text of a file: UTF-8, or UTF-16 after a byte order mark.
fn decoded(bytes: Vec<u8>) -> Result<String, NoText> {
    let low_first = match bytes.get(..2) {
        Some([0xff, 0xfe]) => true,
        Some([0xfe, 0xff]) => false,
        _ => {
            return String::from_utf8(bytes).map_err(|error| {
                let good = error.utf8_error().valid_up_to();
                let bytes = error.as_bytes();
                let lines = bytes
                    .iter()
                    .take(good)
                    .filter(|byte| **byte == b'\n')
                    .count();
                NoText {
                    at: bytes.get(good).map(|byte| (lines + 1, *byte)),
                }
            });
        }
    };
    let (units, rest) = bytes.get(2..).unwrap_or_default().as_chunks::<2>();
    let unit = |&[first, second]: &[u8; 2]| {
        let (low, high) = if low_first {
            (first, second)
        } else {
            (second, first)
        };
        u16::from(high) << 8 | u16::from(low)
    };
    let units: Vec<u16> = units.iter().map(unit).collect();
    match String::from_utf16(&units) {
        Ok(text) if rest.is_empty() => Ok(text),
        _ => Err(NoText { at: None }),
    }
}

/// Reads all bytes, but at most one more than the limit, so that the caller can detect larger
/// files.
fn read_up_to_limit(source: impl Read) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    source
        .take(LARGEST_BYTES as u64 + 1)
        .read_to_end(&mut bytes)?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn other_files_are_recognised_by_their_bytes() {
        let utf16: Vec<u8> = "fuzzy: 1\nname: ä"
            .encode_utf16()
            .flat_map(u16::to_le_bytes)
            .collect();
        let cases: [(&[u8], Option<&str>); 7] = [
            (b"%PDF-1.7\n\xe2", Some("a PDF document")),
            (b"\xa3\x95\x80", Some("a flight log, not a rule set")),
            (b"t_s,pwm1\n0,1500\n", Some("a flight log, not a rule set")),
            (&utf16, Some("text in UTF-16 without a byte order mark")),
            (&[0; 100], Some("not a text file")),
            (b"\xff\xfef\0", None),
            ("fuzzy: 1\nname: ä".as_bytes(), None),
        ];
        for (bytes, what) in cases {
            assert_eq!(foreign(bytes, "x").map(|(what, _)| what), what, "{bytes:?}");
        }
    }
}
