//! Reading values from a tree; errors are added to a list of findings.

use alloc::{
    format,
    string::{String, ToString},
    vec::Vec,
};
use core::ops::Range;

use super::{
    Node, Scalar, Value,
    number::{number_advice, share_of_percentage},
};
use crate::{
    diagnostic::{Diagnostic, duplicate, either, likely_candidates, listed, suggest},
    foreign,
};

/// The suggestion for a comment that begins with `//`.
const COMMENT: &str = "a comment begins with `#`, not with `//`";

/// The suggestion for a file without a rule set around its rules.
const ONLY_RULES: &str = "write the rules as a list under `rules:`, and add `fuzzy: 1`, `name`, `inputs` and `outputs` above `rules:`";

/// The suggestion for a value that does not resemble a number.
const NUMBER: &str = "write a number";

/// The fields of a mapping whose keys are known.
pub struct Fields<'a> {
    /// A description of the mapping for messages, such as ``input `heat` ``.
    what: String,
    /// The position at which missing keys are reported.
    place: Range<usize>,
    entries: Vec<Entry<'a>>,
    /// The known keys that the author probably meant by unknown keys. They are not reported as missing.
    meant: Vec<String>,
    unknown: Vec<&'a str>,
    /// The positions of the unknown keys that resemble no known key.
    unlike: Vec<Range<usize>>,
}

/// A key with its value.
#[derive(Clone)]
pub struct Entry<'a> {
    /// The key.
    pub key: &'a str,
    /// The position of the key.
    pub key_span: Range<usize>,
    /// The value.
    pub value: &'a Node,
}

impl Entry<'_> {
    /// Returns whether the key is the part of a number after a decimal comma: `{window_s: 2,5}` has a key `5`.
    pub(crate) fn is_rest_of_a_number(&self) -> bool {
        self.value.is_null() && self.key.bytes().all(|c| c.is_ascii_digit())
    }

    /// Returns a suggestion for a time in milliseconds or microseconds, such as `window_ms: 3000`.
    fn in_seconds(&self, known: &[&str]) -> Option<String> {
        let (stem, unit) = self.key.rsplit_once('_')?;
        let key = known
            .iter()
            .find(|key| key.strip_suffix("_s") == Some(stem))?;
        let in_a_second = match unit {
            "ms" => 1e3,
            "us" => 1e6,
            _ => return None,
        };
        let time = self.value.as_number_text()?.parse::<f64>().ok()?;
        Some(format!(
            "write the time in seconds: `{key}: {}`",
            time / in_a_second
        ))
    }
}

impl<'a> Fields<'a> {
    /// Returns the value of a key; `None` if the key or its value is missing.
    #[must_use]
    pub fn get(&self, key: &str) -> Option<&'a Node> {
        self.entry(key).map(|entry| entry.value)
    }

    /// Returns the entry of a key; `None` if the key or its value is missing.
    #[must_use]
    pub fn entry(&self, key: &str) -> Option<&Entry<'a>> {
        self.entries
            .iter()
            .find(|entry| entry.key == key && !entry.value.is_null())
    }

    /// Returns whether an unknown key probably refers to this one.
    pub fn misspells(&self, key: &str) -> bool {
        self.meant.iter().any(|meant| meant == key)
    }

    /// Returns all entries, including those with unknown keys; of a repeated key, only the first entry.
    #[must_use]
    pub fn entries(&self) -> &[Entry<'a>] {
        &self.entries
    }

    /// Returns the value of a key, or that of the unknown key that probably refers to it.
    pub(crate) fn get_or_misspelt(&self, key: &str) -> Option<&'a Node> {
        let is_meant = |entry: &&Entry<'_>| !likely_candidates(entry.key, &[key]).is_empty();
        let misspelt = || self.unknown().find(is_meant).map(|entry| entry.value);
        self.get(key).or_else(misspelt)
    }

    /// Returns the unknown keys with their values.
    pub fn unknown(&self) -> impl Iterator<Item = &Entry<'a>> {
        let entries = self.entries.iter();
        entries.filter(|entry| self.unknown.contains(&entry.key))
    }

    /// Removes the findings about unknown keys of this mapping, so that the caller can report a single finding instead.
    pub fn withdraw(&self, findings: &mut Vec<Diagnostic>) {
        findings.retain(|finding| {
            let is_here = |entry: &Entry<'_>| entry.key_span == finding.span;
            finding.code != "unknown-key" || !self.unknown().any(is_here)
        });
    }

    /// Returns the value of a required key, and reports a finding if it is missing. If the mapping has a single unknown
    /// key that resembles no known key, the missing key was probably meant. In this case, the finding about the unknown
    /// key suggests the missing key, and no second finding is reported.
    pub fn require(
        &self,
        key: &str,
        help: &str,
        findings: &mut Vec<Diagnostic>,
    ) -> Option<&'a Node> {
        let found = self.get(key);
        if found.is_some() || self.misspells(key) {
            return found;
        }
        let is_unlike = |finding: &&mut Diagnostic| {
            // The help of a finding that already suggests another missing key does not start like this.
            let is_open = finding
                .help
                .as_deref()
                .is_some_and(|help| help.starts_with("the key"));
            finding.code == "unknown-key" && is_open && self.unlike.contains(&finding.span)
        };
        if self.unlike.len() == 1
            && !self.entries.iter().any(|entry| entry.key == key)
            && let Some(finding) = findings.iter_mut().find(is_unlike)
        {
            finding.help = Some(format!("did you mean `{key}`?"));
        } else {
            let place = self.entries.iter().find(|entry| entry.key == key);
            let span = place.map_or(self.place.clone(), |entry| entry.key_span.clone());
            let message = match place {
                None => format!("{} has no key `{key}`", self.what),
                Some(_) => format!("`{key}` of {} is empty", self.what),
            };
            findings.push(Diagnostic::error("missing-key", span, message).help(help));
        }
        found
    }
}

impl<'a> Entry<'a> {
    /// Reads the value of this key as a mapping, like [`Node::fields`], but reports missing keys at the position of
    /// this key.
    pub fn fields(
        &self,
        what: &str,
        known: &[&str],
        help: &str,
        findings: &mut Vec<Diagnostic>,
    ) -> Option<Fields<'a>> {
        let fields = self.value.fields(what, known, help, findings)?;
        Some(Fields {
            place: self.key_span.clone(),
            ..fields
        })
    }
}

impl Node {
    /// Reads a mapping with known keys. `what` names it in messages, as in ``input `heat` ``. Unknown keys, repeated
    /// keys and values other than a mapping are reported. `help` is the suggestion for a value that is not a mapping;
    /// it contains an example.
    pub fn fields<'a>(
        &'a self,
        what: &str,
        known: &[&str],
        help: &str,
        findings: &mut Vec<Diagnostic>,
    ) -> Option<Fields<'a>> {
        let entries = self.entries(what, "key", help, findings)?;
        let mut misspelt: Vec<String> = Vec::new();
        let (mut unknown, mut unlike) = (Vec::new(), Vec::new());
        for entry in &entries {
            if !known.contains(&entry.key) {
                let message = format!("unknown key `{}` in {what}", entry.key);
                let mut finding = Diagnostic::error("unknown-key", entry.key_span.clone(), message);
                let is_there = |key: &str| entries.iter().any(|entry| entry.key == key);
                let meant = likely_candidates(entry.key, known);
                finding.help = match foreign::belongs_elsewhere(entry.key) {
                    Some(help) if meant.is_empty() => Some(help.into()),
                    // `window_s: 2,5` in braces is parsed as a key `5` without a value.
                    _ if entry.is_rest_of_a_number() => entries
                        .iter()
                        .take_while(|one| one.key_span != entry.key_span)
                        .last()
                        .and_then(|one| {
                            Some(format!(
                                "write a decimal point: `{}: {}.{}`",
                                one.key,
                                one.value.as_number_text()?,
                                entry.key
                            ))
                        }),
                    _ if let Some(help) = entry.in_seconds(known) => Some(help),
                    _ if let [key] = meant.as_slice()
                        && is_there(key) =>
                    {
                        Some(format!(
                            "did you mean `{key}`? That key exists already: keep only one of the two"
                        ))
                    }
                    _ if meant.is_empty() => {
                        unlike.push(entry.key_span.clone());
                        let is = if known.len() == 1 {
                            "key is"
                        } else {
                            "keys are"
                        };
                        Some(format!("the {is} {}", listed(known)))
                    }
                    _ => suggest(entry.key, known.iter().copied()),
                };
                unknown.push(entry.key);
                misspelt.extend(meant.into_iter().map(String::from));
                findings.push(finding);
            }
        }
        Some(Fields {
            what: what.to_string(),
            place: self.span.start..self.span.start,
            entries,
            meant: misspelt,
            unknown,
            unlike,
        })
    }

    /// Reads a mapping with names that the author chose. The second of two equal names is reported as
    /// `duplicate-<kind>` and omitted. `help` is the suggestion for a value that is not a mapping.
    pub fn entries<'a>(
        &'a self,
        what: &str,
        kind: &str,
        help: &str,
        findings: &mut Vec<Diagnostic>,
    ) -> Option<Vec<Entry<'a>>> {
        let Value::Mapping(pairs) = &self.value else {
            let finding = self.unexpected(&format!("a mapping for {what}"));
            findings.push(finding.help(help));
            return None;
        };
        let mut entries: Vec<Entry<'a>> = Vec::with_capacity(pairs.len());
        let mut seen = alloc::collections::BTreeMap::new();
        for (key, value) in pairs {
            let Value::Scalar(scalar) = &key.value else {
                let finding = key.unexpected(&format!("a {kind} of {what}"));
                findings.push(finding.help("write a name before the colon"));
                continue;
            };
            if let Some(first) = seen.insert(scalar.text.as_str(), key.span.clone()) {
                findings.push(duplicate(kind, &scalar.text, what, key.span.clone(), first));
                continue;
            }
            entries.push(Entry {
                key: &scalar.text,
                key_span: key.span.clone(),
                value,
            });
        }
        Some(entries)
    }

    /// Reads a list; `help` is the suggestion for a value that is not a list.
    pub fn items(&self, what: &str, help: &str, findings: &mut Vec<Diagnostic>) -> Option<&[Node]> {
        match &self.value {
            Value::List(items) => Some(items),
            _ => {
                let finding = self.unexpected(&format!("a list for {what}"));
                findings.push(finding.help(help));
                None
            }
        }
    }

    /// Reads a finite number.
    pub fn finite(&self, what: &str, findings: &mut Vec<Diagnostic>) -> Option<f64> {
        let number = match &self.value {
            Value::Scalar(scalar) => scalar.as_number(),
            _ => None,
        };
        match number {
            Some(number) if number.is_finite() => Some(number),
            Some(_) => {
                let shown = self.shown();
                let message = format!("{what} must be a finite number, not {shown}");
                let finding = Diagnostic::error("not-finite", self.span.clone(), message);
                findings.push(finding.help(NUMBER));
                None
            }
            None => {
                let mut finding = self.unexpected(&format!("a number for {what}"));
                let help = self.number_advice();
                finding.help = Some(help.unwrap_or_else(|| NUMBER.into()));
                findings.push(finding);
                None
            }
        }
    }

    /// Reads a finite number that is a share or a degree.
    pub fn share(&self, what: &str, findings: &mut Vec<Diagnostic>) -> Option<f64> {
        let before = findings.len();
        let found = self.finite(what, findings);
        let percentage = self.as_text().and_then(share_of_percentage);
        if let (Some(finding), Some(share)) = (findings.get_mut(before), percentage) {
            finding.help = Some(format!("write it as a fraction: `{share}`"));
        }
        found
    }

    /// Reads an integer of at least `least`.
    pub fn whole(&self, what: &str, least: u64, findings: &mut Vec<Diagnostic>) -> Option<u64> {
        let found = match &self.value {
            Value::Scalar(scalar) if !scalar.quoted => scalar.text.parse().ok(),
            _ => None,
        };
        match found {
            Some(number) if number >= least => Some(number),
            _ => {
                let is_negative = self.as_text().is_some_and(|text| text.starts_with('-'));
                let bounds = match least {
                    0 if !is_negative => String::new(),
                    least => format!(" of at least {least}"),
                };
                let finding = self.unexpected(&format!("a whole number{bounds} for {what}"));
                let advice = self.whole_advice(least);
                findings.push(finding.help(advice));
                None
            }
        }
    }

    /// Reads text; `help` is the suggestion for null, lists and mappings. Numbers and booleans are returned as written,
    /// because names may look like them.
    pub fn words(&self, what: &str, help: &str, findings: &mut Vec<Diagnostic>) -> Option<&Scalar> {
        match &self.value {
            Value::Scalar(scalar) if !scalar.is_null() => Some(scalar),
            _ => {
                let finding = self.unexpected(&format!("text for {what}"));
                findings.push(finding.help(help));
                None
            }
        }
    }

    /// Reads `true` or `false`.
    pub fn boolean(&self, what: &str, findings: &mut Vec<Diagnostic>) -> Option<bool> {
        let found = match &self.value {
            Value::Scalar(scalar) if !scalar.quoted => scalar.as_bool(),
            _ => None,
        };
        if found.is_none() {
            let finding = self.unexpected(&format!("`true` or `false` for {what}"));
            let is_quoted = matches!(&self.value, Value::Scalar(scalar) if scalar.quoted);
            findings.push(finding.help(match is_quoted {
                true => "write `true` or `false`, without quotes",
                false => "write `true` or `false`",
            }));
        }
        found
    }

    /// Reads one of a list of words.
    pub fn choice<T: Copy>(
        &self,
        what: &str,
        choices: &[(&str, T)],
        findings: &mut Vec<Diagnostic>,
    ) -> Option<T> {
        let names: Vec<&str> = choices.iter().map(|(name, _)| *name).collect();
        let word = self.words(what, &format!("write {}", either(&names)), findings)?;
        let found = choices.iter().find(|(name, _)| *name == word.text);
        if found.is_none() {
            let message = format!("invalid value `{}` for {what}", word.text);
            let mut finding = Diagnostic::error("unknown-word", self.span.clone(), message);
            finding.help = suggest(&word.text, names);
            findings.push(finding);
        }
        found.map(|&(_, value)| value)
    }

    /// Returns a finding for a value of an unexpected type.
    #[must_use]
    pub fn unexpected(&self, expected: &str) -> Diagnostic {
        let message = format!("expected {expected}, found {}", self.shown());
        Diagnostic::error("wrong-type", self.span.clone(), message)
    }

    /// Returns a finding for a document that is not a mapping; `what` is "rule set" or "profile", and `first` its first
    /// line. The text is not quoted, because the document may be any file, for example one with secrets.
    #[must_use]
    pub fn unexpected_document(&self, what: &str, first: &str) -> Diagnostic {
        let begin = format!("a {what} begins with `{first}`");
        let is_rule = |node: &Node| {
            let start = node.as_text().and_then(|text| text.get(..3));
            start.is_some_and(|start| start.eq_ignore_ascii_case("if "))
        };
        let (message, help) = match &self.value {
            Value::List(items) if !items.is_empty() && items.iter().all(is_rule) => {
                ("the file contains only rules".into(), ONLY_RULES.into())
            }
            Value::Scalar(_) if is_rule(self) => (
                "the file contains only a rule, not a complete rule set".into(),
                ONLY_RULES.into(),
            ),
            Value::List(items) if items.iter().any(|item| item.children() > 0) => {
                let help = match items.as_slice() {
                    [_] => "remove the `-`, and begin the top-level keys in the first column",
                    _ => "remove the `-` before each top-level key, such as `name: ...`",
                };
                (
                    format!("a {what} must be a mapping, found a list"),
                    help.into(),
                )
            }
            Value::Scalar(scalar) if !scalar.is_null() => {
                (format!("this is plain text, not a {what}"), begin)
            }
            _ => (format!("expected a {what}, found {}", self.shown()), begin),
        };
        Diagnostic::error("wrong-type", self.span.clone(), message).help(help)
    }

    /// Returns a short description of the value, to quote in messages.
    fn shown(&self) -> String {
        match &self.value {
            Value::List(_) => "a list".into(),
            Value::Mapping(_) => "a mapping".into(),
            Value::Scalar(scalar) if scalar.is_null() => "nothing".into(),
            Value::Scalar(scalar) if scalar.text.trim_end().contains('\n') => {
                "text of several lines".into()
            }
            Value::Scalar(scalar) => {
                let cut: String = scalar.text.chars().take(40).collect();
                let dots = if cut.len() < scalar.text.len() {
                    "..."
                } else {
                    ""
                };
                if scalar.quoted {
                    format!("the text `{cut}{dots}`")
                } else {
                    format!("`{cut}{dots}`")
                }
            }
        }
    }

    /// Returns a suggestion for a list with a wrong number of numbers. `[0, 20,5]` contains a decimal comma: there is
    /// no blank after it, but there is one after the other comma. `[0 1]` contains no comma.
    #[must_use]
    pub fn list_advice(items: &[Node], expected: usize) -> Option<String> {
        if let [only] = items
            && let Value::Scalar(scalar) = &only.value
        {
            let numbers = scalar.text.split([' ', ';', '|']).map(str::trim);
            let numbers: Vec<&str> = numbers.filter(|number| !number.is_empty()).collect();
            let is_list = numbers.len() > 1 && numbers.iter().all(|n| n.parse::<f64>().is_ok());
            return is_list.then(|| {
                format!(
                    "separate the numbers with commas: `[{}]`",
                    numbers.join(", ")
                )
            });
        }
        let mut adjoining = items.windows(2).filter_map(|pair| match pair {
            [whole, part] if part.span.start == whole.span.end + 1 => {
                let (whole, part) = (whole.as_number_text()?, part.as_number_text()?);
                let is_part = part.bytes().all(|c| c.is_ascii_digit());
                number_advice(&format!("{whole},{part}")).filter(|_| is_part)
            }
            _ => None,
        });
        let first = adjoining.next()?;
        (items.len() == expected + 1 + adjoining.count()).then_some(first)
    }

    /// Returns a suggestion for a value that is not a whole number of at least `least`.
    fn whole_advice(&self, least: u64) -> String {
        let Value::Scalar(scalar) = &self.value else {
            return format!("write a whole number such as `{}`", least.max(1));
        };
        let text = scalar.text.trim();
        if text.contains(" //") {
            return COMMENT.into();
        }
        let whole = |text: &str| text.parse::<u64>().ok().filter(|number| *number >= least);
        if scalar.quoted && whole(text).is_some() {
            return "remove the quotes".into();
        }
        let fraction = text.split_once('.');
        match fraction.filter(|(_, part)| part.bytes().all(|c| c == b'0')) {
            Some((number, _)) if whole(number).is_some() => format!("write `{number}`"),
            _ => {
                let letters = text.trim_start_matches(|c: char| c.is_ascii_alphabetic());
                match whole(letters) {
                    Some(number) => format!("write `{number}`"),
                    None => {
                        let near = text.parse::<f64>().map_or(0.0, libm::round);
                        let near = if near < 1e6 { near } else { 0.0 };
                        let example = (near as u64).max(least).max(1);
                        let sign = if text.starts_with('-') {
                            " that is not negative,"
                        } else {
                            ""
                        };
                        format!("write a whole number{sign} such as `{example}`")
                    }
                }
            }
        }
    }

    fn number_advice(&self) -> Option<String> {
        let Value::Scalar(scalar) = &self.value else {
            return None;
        };
        let text = scalar.text.trim();
        if text.parse().is_ok_and(f64::is_finite) {
            return Some("remove the quotes".into());
        }
        if text.contains(" //") {
            return Some(COMMENT.into());
        }
        number_advice(text)
    }
}

impl Scalar {
    /// Returns the number if this scalar is one, in YAML's notations for decimal numbers, infinities and NaN.
    #[must_use]
    pub fn as_number(&self) -> Option<f64> {
        if self.quoted {
            return None;
        }
        let text = self.text.as_str();
        let unsigned = text.strip_prefix(['+', '-']).unwrap_or(text);
        match unsigned {
            ".inf" | ".Inf" | ".INF" if text.starts_with('-') => Some(f64::NEG_INFINITY),
            ".inf" | ".Inf" | ".INF" => Some(f64::INFINITY),
            ".nan" | ".NaN" | ".NAN" => Some(f64::NAN),
            // Rust parses `inf` and `nan` as numbers; in YAML they are words.
            _ if unsigned.starts_with(|c: char| c.is_ascii_digit() || c == '.') => {
                text.parse().ok()
            }
            _ => None,
        }
    }

    pub(super) fn as_bool(&self) -> Option<bool> {
        match self.text.as_str() {
            "true" | "True" | "TRUE" if !self.quoted => Some(true),
            "false" | "False" | "FALSE" if !self.quoted => Some(false),
            _ => None,
        }
    }
}
