//! An open text: what it means, and what is wrong with it.

use std::cell::OnceCell;

use flagred::{
    check::{Alone, alone},
    loaded,
    profile::Profile,
};
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
    profile: Option<OpenProfile>,
    /// Found when somebody asks: it is most of the work.
    findings: OnceCell<Findings>,
}

/// A text that is meant to be a profile.
#[derive(Debug)]
struct OpenProfile {
    read: Result<Profile, Findings>,
    rules_text: Option<String>,
}

impl Document {
    /// Reads a text. `rules_of` gives the text of the rule set that a profile names; none where there is no such.
    pub fn new(
        text: impl Into<String>,
        rules_of: impl FnOnce(&Profile) -> Option<String>,
    ) -> Document {
        let text = text.into();
        let profile = is_profile(&text).then(|| {
            let read = text.parse::<Profile>();
            let rules_text = read.as_ref().ok().and_then(rules_of);
            OpenProfile { read, rules_text }
        });
        let rules = match &profile {
            Some(profile) => profile.rules_text.as_deref().and_then(partial),
            None => partial(&text),
        };
        Document {
            text,
            rules,
            profile,
            findings: OnceCell::new(),
        }
    }

    /// The text.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// What `flagred check` finds.
    pub fn findings(&self) -> &Findings {
        self.findings.get_or_init(|| match &self.profile {
            Some(profile) => profile.findings(&self.text),
            // Only claims are refused, and none are made.
            None => examine(&self.text, &check::Options::default()).map_or_else(
                |finding| Findings::locate(vec![*finding], &self.text),
                |examined| examined.findings,
            ),
        })
    }

    /// What each input of a profile reaches alone; nothing of a rule set and of a profile with errors.
    pub fn alone(&self) -> Vec<Alone> {
        let rules = self.profile.as_ref().and_then(|p| p.rules_text.as_deref());
        let rules = rules.and_then(|text| fuzzy::yaml::parse(text).ok());
        let estimator = rules.and_then(|rules| loaded::fit(&self.text, &rules.model).1);
        estimator.as_ref().map(alone).unwrap_or_default()
    }

    /// Whether it is a profile.
    pub fn is_profile(&self) -> bool {
        self.profile.is_some()
    }

    /// The profile, where it can be read.
    pub fn profile(&self) -> Option<&Profile> {
        self.profile.as_ref()?.read.as_ref().ok()
    }

    /// The rule set as far as it can be read; of a profile, the one that it names.
    pub fn model(&self) -> Option<&Model> {
        self.rules.as_ref().map(|rules| &rules.model)
    }

    /// The rule set as far as it can be read, with its places; none of a profile.
    pub(crate) fn rules(&self) -> Option<&Partial> {
        self.rules.as_ref().filter(|_| self.profile.is_none())
    }
}

impl OpenProfile {
    fn findings(&self, text: &str) -> Findings {
        let profile = match &self.read {
            Ok(profile) => profile,
            Err(findings) => return findings.clone(),
        };
        match self.rules_text.as_deref().map(fuzzy::yaml::parse) {
            Some(Ok(document)) => loaded::examine(text, &document.model).0,
            _ => unusable_rules(text, &profile.rules),
        }
    }
}

pub(crate) fn partial(text: &str) -> Option<Partial> {
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

impl Examined {
    /// The findings that the author accepts.
    pub fn accepted(&self) -> Vec<check::Accepted> {
        let of = |(document, report): &(format::Document, check::Report)| {
            report.accepted(&document.model)
        };
        self.analysed.as_ref().map(of).unwrap_or_default()
    }
}

/// Examines a rule set, in YAML or a format of another program.
///
/// # Errors
/// A claim of the options names what the rule set does not have.
pub fn examine(text: &str, options: &check::Options) -> Result<Examined, Box<Diagnostic>> {
    let document = match flagred_interchange::document(text) {
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
