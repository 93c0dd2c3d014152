//! An open text with its model and its findings.

use std::cell::OnceCell;

use flagred::{
    check::{InputRisk, risks_of_single_inputs},
    estimator::Estimator,
    loaded::{self, is_profile},
    profile::Profile,
};
use fuzzy::{
    Model, Source, check,
    diagnostic::{Diagnostic, Findings},
    format::{self, PartialModel},
};

use crate::provenance;

/// A rule set or a profile that is open in an editor.
#[derive(Debug)]
pub struct Document {
    source: Source,
    /// The rule set as far as it can be read; for a profile, the rule set that it names.
    partial: Option<PartialModel>,
    profile: Option<OpenProfile>,
    /// A profile compiled with its rule set, and the findings about both.
    fitted: OnceCell<(Findings, Option<Estimator>)>,
    /// All findings; computed on demand, because that takes most of the time.
    findings: OnceCell<Findings>,
}

/// A text that is meant to be a profile.
#[derive(Debug)]
struct OpenProfile {
    read: Result<Profile, Findings>,
    rules: Option<Source>,
}

impl Document {
    /// Reads a text. `rules_of` returns the text of the rule set that a profile names, or `None` if there is none.
    pub fn new(
        text: impl Into<String>,
        rules_of: impl FnOnce(&Profile) -> Option<String>,
    ) -> Document {
        let source = flagred_interchange::source(text);
        let profile = is_profile(&source).then(|| {
            let read = Profile::from_source(&source);
            let rules = read.as_ref().ok().and_then(rules_of).map(Source::new);
            OpenProfile { read, rules }
        });
        let partial = match &profile {
            Some(profile) => profile.rules.as_ref().and_then(partial),
            None => partial(&source),
        };
        Document {
            source,
            partial,
            profile,
            fitted: OnceCell::new(),
            findings: OnceCell::new(),
        }
    }

    /// The text.
    pub fn text(&self) -> &str {
        self.source.text()
    }

    /// The source of the text.
    pub fn source(&self) -> &Source {
        &self.source
    }

    /// The findings of `flagred check`.
    pub fn findings(&self) -> &Findings {
        self.findings.get_or_init(|| match self.fitted() {
            Some((findings, estimator)) => {
                let outvoted = estimator
                    .as_ref()
                    .map(|e| loaded::outvoted(&self.source, e));
                let outvoted = outvoted.into_iter().flat_map(|findings| findings.0);
                Findings(findings.0.iter().cloned().chain(outvoted).collect())
            }
            // This fails only for invalid claims, and there are no claims.
            None => examine(&self.source, &check::Options::default()).map_or_else(
                |finding| Findings::locate(vec![*finding], self.text()),
                |examined| examined.findings,
            ),
        })
    }

    /// A profile compiled with its rule set; `None` for a rule set and for a profile with errors.
    pub fn estimator(&self) -> Option<&Estimator> {
        self.fitted()?.1.as_ref()
    }

    fn fitted(&self) -> Option<&(Findings, Option<Estimator>)> {
        let profile = self.profile.as_ref()?;
        Some(self.fitted.get_or_init(|| profile.fit(&self.source)))
    }

    /// The highest risk that each input of a profile causes while all other inputs are calm; empty for a rule set and for a
    /// profile with errors.
    pub fn risks_of_single_inputs(&self) -> Vec<InputRisk> {
        self.estimator()
            .map(risks_of_single_inputs)
            .unwrap_or_default()
    }

    /// Whether the text is a profile.
    pub fn is_profile(&self) -> bool {
        self.profile.is_some()
    }

    /// The profile, if it can be read.
    pub fn profile(&self) -> Option<&Profile> {
        self.profile.as_ref()?.read.as_ref().ok()
    }

    /// The rule set as far as it can be read; for a profile, the rule set that it names.
    pub fn model(&self) -> Option<&Model> {
        self.partial.as_ref().map(|rules| &rules.model)
    }

    /// The rule set as far as it can be read, with its spans; `None` for a profile.
    pub(crate) fn rules(&self) -> Option<&PartialModel> {
        self.partial.as_ref().filter(|_| self.profile.is_none())
    }
}

impl OpenProfile {
    fn fit(&self, source: &Source) -> (Findings, Option<Estimator>) {
        match (&self.read, &self.rules) {
            (Err(findings), _) => (findings.clone(), None),
            (Ok(_), Some(rules)) if rules.document().is_ok() => loaded::fit(source, rules),
            (Ok(profile), _) => {
                let message = format!("the rule set `{}` cannot be used", profile.rules);
                let help = "`flagred check` shows why; a rule set must be a shipped one, or a file next to the profile";
                (unusable_rules(source, message, Some(help.into())), None)
            }
        }
    }
}

pub(crate) fn partial(source: &Source) -> Option<PartialModel> {
    format::read_partly(source.tree().ok()?)
}

/// The result of examining a rule set.
#[derive(Debug)]
pub struct Examination<'s> {
    /// All findings.
    pub findings: Findings,
    /// The rule set and its analysis, if it can be analysed.
    pub analysed: Option<(&'s format::Document, check::Report)>,
}

impl Examination<'_> {
    /// The findings that the author accepts.
    pub fn accepted(&self) -> Vec<check::AcceptedFindings> {
        let of = |(document, report): &(&format::Document, check::Report)| {
            report.accepted(&document.model)
        };
        self.analysed.as_ref().map(of).unwrap_or_default()
    }
}

/// Examines a rule set.
///
/// # Errors
/// If a claim of the options names something that the rule set does not have.
pub fn examine<'s>(
    source: &'s Source,
    options: &check::Options,
) -> Result<Examination<'s>, Box<Diagnostic>> {
    let (document, engine) = match (source.document(), source.engine()) {
        (Ok(document), Ok(engine)) => (document, engine),
        (Err(findings), _) | (_, Err(findings)) => {
            return Ok(Examination {
                findings,
                analysed: None,
            });
        }
    };
    let (findings, report) = check::document(document, engine, source.text(), options)?;
    Ok(Examination {
        findings: provenance::with_edited(findings, document, source.text()),
        analysed: Some((document, report)),
    })
}

/// Returns the finding for a profile whose rule set cannot be used, at the name of the rule set.
pub fn unusable_rules(profile: &Source, message: String, help: Option<String>) -> Findings {
    let rules = profile.tree().ok().and_then(|tree| tree.child("rules"));
    let place = rules.map_or(0..0, |rules| rules.span.clone());
    let mut finding = Diagnostic::error("rule-set", place, message);
    finding.help = help;
    Findings::locate(vec![finding], profile.text())
}
