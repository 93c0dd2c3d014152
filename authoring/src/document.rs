//! An open text: what it means, and what is wrong with it.

use flagred::{loaded, profile::Profile};
use fuzzy::{
    Model, check,
    diagnostic::{Diagnostic, Findings},
    format::{self, Partial},
    tree::Value,
};

use crate::provenance;

/// A rule set or a profile that an editor shows.
#[derive(Debug)]
pub struct Document {
    text: String,
    /// The rule set as far as it can be read; of a profile, the one that it names.
    rules: Option<Partial>,
    is_profile: bool,
    findings: Findings,
}

impl Document {
    /// Reads a text. `rules_of` gives the text of the rule set that a profile names; none where there is no such.
    pub fn new(
        text: impl Into<String>,
        rules_of: impl FnOnce(&Profile) -> Option<String>,
    ) -> Document {
        let text = text.into();
        if !is_profile(&text) {
            return Document {
                rules: partial(&text),
                is_profile: false,
                // Of claims, and none are made.
                findings: examine(&text, &check::Options::default()).map_or_else(
                    |finding| Findings::locate(vec![*finding], &text),
                    |e| e.findings,
                ),
                text,
            };
        }
        let (rules, findings) = match text.parse::<Profile>() {
            Ok(profile) => {
                let rules = rules_of(&profile);
                let model = rules.as_deref().map(fuzzy::yaml::parse);
                let findings = match model {
                    Some(Ok(document)) => loaded::examine(&text, &document.model).0,
                    _ => unusable_rules(&text, &profile.rules),
                };
                (rules, findings)
            }
            Err(findings) => (None, findings),
        };
        Document {
            rules: rules.as_deref().and_then(partial),
            is_profile: true,
            findings,
            text,
        }
    }

    /// The text.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// What `flagred check` finds.
    pub fn findings(&self) -> &Findings {
        &self.findings
    }

    /// Whether it is a profile.
    pub fn is_profile(&self) -> bool {
        self.is_profile
    }

    /// The rule set as far as it can be read; of a profile, the one that it names.
    pub fn model(&self) -> Option<&Model> {
        self.rules.as_ref().map(|rules| &rules.model)
    }

    /// The rule set as far as it can be read, with its places; none of a profile.
    pub(crate) fn rules(&self) -> Option<&Partial> {
        self.rules.as_ref().filter(|_| !self.is_profile)
    }
}

fn partial(text: &str) -> Option<Partial> {
    format::read_partly(&fuzzy::yaml::read(text).ok()?)
}

/// Whether a text is meant to be a profile: whether it has the key `flagred`, also where it is no YAML yet.
pub fn is_profile(text: &str) -> bool {
    let tree = fuzzy::yaml::read(text).map(|tree| tree.value);
    let Ok(Value::Mapping(pairs)) = tree else {
        return text.lines().any(|line| line.starts_with("flagred:"));
    };
    let mut keys = pairs.iter().map(|(key, _)| &key.value);
    keys.any(|key| matches!(key, Value::Scalar(key) if key.text == "flagred"))
}

/// What there is to say of a rule set.
#[derive(Debug)]
pub struct Examined {
    /// All findings.
    pub findings: Findings,
    /// The rule set and its analysis, where it can be analysed.
    pub analysed: Option<(format::Document, check::Report)>,
}

/// Examines a rule set, in YAML or a format of another program.
///
/// # Errors
/// A claim of the options names what the rule set does not have.
pub fn examine(text: &str, options: &check::Options) -> Result<Examined, Box<Diagnostic>> {
    let document = match interchange::document(text) {
        Ok(document) => document,
        Err(findings) => {
            return Ok(Examined {
                findings,
                analysed: None,
            });
        }
    };
    let (findings, report) = check::document(&document, text, options)?;
    Ok(Examined {
        findings: provenance::with_edited(findings, &document, text),
        analysed: report.map(|report| (document, report)),
    })
}

/// The finding of a profile whose rule set cannot be used.
fn unusable_rules(text: &str, rules: &str) -> Findings {
    let place = text.find("rules:").unwrap_or(0);
    let message = format!("the rule set `{rules}` cannot be used");
    let finding = Diagnostic::error("rule-set", place..place + 5, message).help(
        "`flagred check` shows why; a rule set is a shipped one, or a file beside the profile",
    );
    Findings::locate(vec![finding], text)
}
