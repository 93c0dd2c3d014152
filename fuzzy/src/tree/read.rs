//! Reading a tree: what is expected is asked for, what is wrong goes to the list of findings.

use alloc::{
    format,
    string::{String, ToString},
    vec::Vec,
};
use core::ops::Range;

use super::{Node, Scalar, Value};
use crate::diagnostic::{Diagnostic, duplicate, suggest};

/// The fields of a mapping whose keys are known.
///
/// # Example
/// ```
/// # use fuzzy::yaml;
/// # let mut findings = Vec::new();
/// let tree = yaml::read("{speed: fast, blades: }")?;
/// let fields = tree.fields("the fan", &["speed", "blades"], &mut findings).ok_or("no mapping")?;
/// assert!(fields.get("speed").is_some() && fields.get("blades").is_none());
/// assert_eq!(fields.entries().len(), 2);
/// assert!(fields.require("blades", "write `blades: 5`", &mut findings).is_none());
/// assert_eq!(findings[0].to_string(), "error[missing-key]: `blades` of the fan is empty\n  help: write `blades: 5`");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Fields<'a> {
    /// What the mapping is, for messages: ``input `margin` ``.
    what: String,
    /// Where to tell that something is missing.
    place: Range<usize>,
    entries: Vec<Entry<'a>>,
}

/// A key and what stands behind it.
///
/// # Example: where a key stands
/// ```
/// use fuzzy::tree::Entry;
///
/// let text = "{speed: fast}";
/// let tree = fuzzy::yaml::read(text)?;
/// let fields = tree.fields("the fan", &["speed"], &mut Vec::new()).ok_or("no mapping")?;
/// let Entry { key, key_span, value } = &fields.entries()[0];
/// assert_eq!((*key, &text[key_span.clone()], &text[value.span.clone()]), ("speed", "speed", "fast"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone)]
pub struct Entry<'a> {
    /// The key.
    pub key: &'a str,
    /// Where the key stands.
    pub key_span: Range<usize>,
    /// What stands behind it.
    pub value: &'a Node,
}

impl<'a> Fields<'a> {
    /// The value behind a key; a key with nothing behind it counts as absent.
    ///
    /// # Example: nothing behind a key is as good as no key
    /// ```
    /// let tree = fuzzy::yaml::read("{speed: fast, blades: }")?;
    /// let fields = tree.fields("the fan", &["speed", "blades"], &mut Vec::new()).ok_or("no mapping")?;
    /// assert!(fields.get("speed").is_some());
    /// assert_eq!((fields.get("blades"), fields.get("colour")), (None, None));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn get(&self, key: &str) -> Option<&'a Node> {
        self.entry(key).map(|entry| entry.value)
    }

    /// The key and the value behind it; a key with nothing behind it counts as absent.
    ///
    /// # Example: a finding at the key
    /// ```
    /// use fuzzy::diagnostic::Diagnostic;
    ///
    /// let tree = fuzzy::yaml::read("{blades: 5, speed: fast}")?;
    /// let fields = tree.fields("the fan", &["speed", "blades"], &mut Vec::new()).ok_or("no mapping")?;
    /// let speed = fields.entry("speed").ok_or("no speed")?;
    /// let finding = Diagnostic::note("unused", speed.key_span.clone(), "the fan has one speed");
    /// assert_eq!(finding.span, 12..17);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn entry(&self, key: &str) -> Option<&Entry<'a>> {
        self.entries
            .iter()
            .find(|entry| entry.key == key && !entry.value.is_null())
    }

    /// All keys that are there once, with their values.
    ///
    /// # Example: a key given twice counts once, and is a finding
    /// ```
    /// let mut findings = Vec::new();
    /// let tree = fuzzy::yaml::read("{speed: fast, blades: 5, speed: slow}")?;
    /// let fields = tree.fields("the fan", &["speed", "blades"], &mut findings).ok_or("no mapping")?;
    /// let keys: Vec<&str> = fields.entries().iter().map(|entry| entry.key).collect();
    /// assert_eq!((keys, findings[0].code), (vec!["speed", "blades"], "duplicate-key"));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn entries(&self) -> &[Entry<'a>] {
        &self.entries
    }

    /// The value behind a key that has to be there.
    ///
    /// # Example
    /// ```
    /// let mut findings = Vec::new();
    /// let tree = fuzzy::yaml::read("{speed: fast}")?;
    /// let fields = tree.fields("the fan", &["speed", "blades"], &mut findings).ok_or("no mapping")?;
    /// assert!(fields.require("speed", "write `speed: fast`", &mut findings).is_some());
    /// assert!(fields.require("blades", "write `blades: 5`", &mut findings).is_none());
    /// assert_eq!(findings[0].to_string(), "error[missing-key]: the fan has no `blades`\n  help: write `blades: 5`");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn require(
        &self,
        key: &str,
        help: &str,
        findings: &mut Vec<Diagnostic>,
    ) -> Option<&'a Node> {
        let found = self.get(key);
        if found.is_none() {
            let place = self.entries.iter().find(|entry| entry.key == key);
            let span = place.map_or(self.place.clone(), |entry| entry.key_span.clone());
            let message = match place {
                None => format!("{} has no `{key}`", self.what),
                Some(_) => format!("`{key}` of {} is empty", self.what),
            };
            findings.push(Diagnostic::error("missing-key", span, message).help(help));
        }
        found
    }
}

impl<'a> Entry<'a> {
    /// [`Node::fields`] of the value; what is missing in it is told at the key.
    ///
    /// # Example: what is missing is told at the key
    /// ```
    /// let text = "{fan: {speed: fast}}";
    /// let mut findings = Vec::new();
    /// let tree = fuzzy::yaml::read(text)?;
    /// let file = tree.fields("the file", &["fan"], &mut findings).ok_or("no mapping")?;
    /// let fan = file.entries()[0].fields("the fan", &["speed", "blades"], &mut findings).ok_or("no mapping")?;
    /// fan.require("blades", "write `blades: 5`", &mut findings);
    /// assert_eq!(&text[findings[0].span.clone()], "fan");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn fields(
        &self,
        what: &str,
        known: &[&str],
        findings: &mut Vec<Diagnostic>,
    ) -> Option<Fields<'a>> {
        let fields = self.value.fields(what, known, findings)?;
        Some(Fields {
            place: self.key_span.clone(),
            ..fields
        })
    }
}

impl Node {
    /// Reads a mapping of known keys. `what` names it in messages, as in ``input `margin` ``. An unknown key, a key
    /// given twice and anything but a mapping is a finding.
    ///
    /// # Example
    /// ```
    /// # use fuzzy::yaml;
    /// # let mut findings = Vec::new();
    /// let tree = yaml::read("{sped: fast}")?;
    /// let fields = tree.fields("the fan", &["speed"], &mut findings).ok_or("no mapping")?;
    /// assert_eq!(fields.entries()[0].key, "sped");
    /// assert_eq!(findings[0].help.as_deref(), Some("did you mean `speed`?"));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn fields<'a>(
        &'a self,
        what: &str,
        known: &[&str],
        findings: &mut Vec<Diagnostic>,
    ) -> Option<Fields<'a>> {
        let entries = self.entries(what, "key", findings)?;
        for entry in &entries {
            if !known.contains(&entry.key) {
                let message = format!("{what} has no key `{}`", entry.key);
                let mut finding = Diagnostic::error("unknown-key", entry.key_span.clone(), message);
                finding.help = suggest(entry.key, known.iter().copied());
                findings.push(finding);
            }
        }
        Some(Fields {
            what: what.to_string(),
            place: self.span.start..self.span.start,
            entries,
        })
    }

    /// Reads a mapping of names the author chose: of two equal ones the second is a finding `duplicate-<kind>` and
    /// left out.
    ///
    /// # Example
    /// ```
    /// # use fuzzy::yaml;
    /// # let mut findings = Vec::new();
    /// let tree = yaml::read("{low: 1, high: 2}")?;
    /// let entries = tree.entries("the fan", "speed", &mut findings).ok_or("no mapping")?;
    /// assert_eq!(entries[1].key, "high");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn entries<'a>(
        &'a self,
        what: &str,
        kind: &str,
        findings: &mut Vec<Diagnostic>,
    ) -> Option<Vec<Entry<'a>>> {
        let Value::Mapping(pairs) = &self.value else {
            let finding = self.unexpected(&format!("a mapping for {what}"));
            findings.push(finding.help("write `key: value` lines below it, indented"));
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

    /// Reads a list.
    ///
    /// # Example
    /// ```
    /// # use fuzzy::yaml;
    /// # let mut findings = Vec::new();
    /// assert_eq!(yaml::read("[1, 2]")?.items("the speeds", &mut findings).map(|items| items.len()), Some(2));
    /// assert!(yaml::read("fast")?.items("the speeds", &mut findings).is_none());
    /// assert_eq!(findings[0].code, "wrong-type");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn items(&self, what: &str, findings: &mut Vec<Diagnostic>) -> Option<&[Node]> {
        match &self.value {
            Value::List(items) => Some(items),
            _ => {
                let finding = self.unexpected(&format!("a list for {what}"));
                findings.push(finding.help("write `- item` lines below it, or `[a, b]`"));
                None
            }
        }
    }

    /// Reads a finite number.
    ///
    /// # Example
    /// ```
    /// # use fuzzy::yaml;
    /// # let mut findings = Vec::new();
    /// assert_eq!(yaml::read("1e3")?.finite("`speed`", &mut findings), Some(1000.0));
    /// assert_eq!(yaml::read(".inf")?.finite("`speed`", &mut findings), None);
    /// assert_eq!(findings[0].code, "not-finite");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
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
                findings.push(
                    Diagnostic::error("not-finite", self.span.clone(), message)
                        .help("write a number such as `0.5`"),
                );
                None
            }
            None => {
                let mut finding = self.unexpected(&format!("a number for {what}"));
                let help = self.number_advice();
                finding.help = Some(help.unwrap_or_else(|| "write a number such as `0.5`".into()));
                findings.push(finding);
                None
            }
        }
    }

    /// Reads a whole number from `least` on.
    ///
    /// # Example
    /// ```
    /// # use fuzzy::yaml;
    /// # let mut findings = Vec::new();
    /// assert_eq!(yaml::read("5")?.whole("`blades`", 1, &mut findings), Some(5));
    /// assert_eq!(yaml::read("2.5")?.whole("`blades`", 1, &mut findings), None);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn whole(&self, what: &str, least: u64, findings: &mut Vec<Diagnostic>) -> Option<u64> {
        let found = match &self.value {
            Value::Scalar(scalar) if !scalar.quoted => scalar.text.parse().ok(),
            _ => None,
        };
        match found {
            Some(number) if number >= least => Some(number),
            _ => {
                let expected = format!("a whole number from {least} on for {what}");
                findings.push(
                    self.unexpected(&expected)
                        .help("write a whole number without quotes"),
                );
                None
            }
        }
    }

    /// Reads text. A number or `true` stands for its own letters: names may look like that.
    ///
    /// # Example
    /// ```
    /// # use fuzzy::yaml;
    /// # let mut findings = Vec::new();
    /// let tree = yaml::read("12")?;
    /// assert_eq!(tree.words("the name", &mut findings).map(|word| word.text.as_str()), Some("12"));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn words(&self, what: &str, findings: &mut Vec<Diagnostic>) -> Option<&Scalar> {
        match &self.value {
            Value::Scalar(scalar) if !scalar.is_null() => Some(scalar),
            _ => {
                let finding = self.unexpected(&format!("text for {what}"));
                findings.push(finding.help("write a word or a sentence"));
                None
            }
        }
    }

    /// Reads `true` or `false`.
    ///
    /// # Example
    /// ```
    /// # use fuzzy::yaml;
    /// # let mut findings = Vec::new();
    /// assert_eq!(yaml::read("true")?.boolean("`quiet`", &mut findings), Some(true));
    /// assert_eq!(yaml::read("1")?.boolean("`quiet`", &mut findings), None);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn boolean(&self, what: &str, findings: &mut Vec<Diagnostic>) -> Option<bool> {
        let found = match &self.value {
            Value::Scalar(scalar) if !scalar.quoted => scalar.as_bool(),
            _ => None,
        };
        if found.is_none() {
            let finding = self.unexpected(&format!("`true` or `false` for {what}"));
            findings.push(finding.help("write one of the two, without quotes"));
        }
        found
    }

    /// Reads one of several words.
    ///
    /// # Example
    /// ```
    /// # use fuzzy::yaml;
    /// # let mut findings = Vec::new();
    /// let choices = [("slow", 1), ("fast", 9)];
    /// assert_eq!(yaml::read("fast")?.choice("`speed`", &choices, &mut findings), Some(9));
    /// assert_eq!(yaml::read("fats")?.choice("`speed`", &choices, &mut findings), None);
    /// assert_eq!(findings[0].help.as_deref(), Some("did you mean `fast`?"));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn choice<T: Copy>(
        &self,
        what: &str,
        choices: &[(&str, T)],
        findings: &mut Vec<Diagnostic>,
    ) -> Option<T> {
        let word = self.words(what, findings)?;
        let found = choices.iter().find(|(name, _)| *name == word.text);
        if found.is_none() {
            let message = format!("{what} cannot be `{}`", word.text);
            let mut finding = Diagnostic::error("unknown-word", self.span.clone(), message);
            finding.help = suggest(&word.text, choices.iter().map(|(name, _)| *name));
            findings.push(finding);
        }
        found.map(|&(_, value)| value)
    }

    /// A finding: here stands something else than what was expected.
    ///
    /// # Example
    /// ```
    /// let finding = fuzzy::yaml::read("fast")?.unexpected("a number");
    /// assert_eq!(finding.message, "expected a number, found `fast`");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn unexpected(&self, expected: &str) -> Diagnostic {
        let message = format!("expected {expected}, found {}", self.shown());
        Diagnostic::error("wrong-type", self.span.clone(), message)
    }

    /// What stands here, for messages.
    fn shown(&self) -> String {
        match &self.value {
            Value::List(_) => "a list".into(),
            Value::Mapping(_) => "a mapping".into(),
            Value::Scalar(scalar) if scalar.is_null() => "nothing".into(),
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

    fn number_advice(&self) -> Option<String> {
        let Value::Scalar(scalar) = &self.value else {
            return None;
        };
        let text = scalar.text.trim();
        let plain = |s: &str| s.parse::<f64>().ok().filter(|x| x.is_finite());
        if plain(text).is_some() {
            return Some("a number stands without quotes".into());
        }
        if let Some(percent) = text.strip_suffix('%').and_then(plain) {
            return Some(format!(
                "write the number alone: `{percent}` or `{}`",
                percent / 100.0
            ));
        }
        if plain(&text.replacen(',', ".", 1)).is_some() {
            return Some(format!(
                "write a decimal point: `{}`",
                text.replacen(',', ".", 1)
            ));
        }
        let number: String = text
            .chars()
            .take_while(|c| c.is_ascii_digit() || matches!(c, '.' | '-' | '+'))
            .collect();
        plain(&number).map(|_| format!("write the number without its unit: `{number}`"))
    }
}

impl Scalar {
    /// The number it is, if it is one: YAML's forms of decimal numbers, infinities and NaN.
    ///
    /// # Example
    /// ```
    /// use fuzzy::tree::Value;
    ///
    /// let number = |text: &str| match fuzzy::yaml::read(text).ok()?.value {
    ///     Value::Scalar(scalar) => scalar.as_number(),
    ///     _ => None,
    /// };
    /// assert_eq!((number("-.5"), number("'5'"), number("inf")), (Some(-0.5), None, None));
    /// ```
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
            // Rust reads `inf` and `nan` as numbers, YAML as words.
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
