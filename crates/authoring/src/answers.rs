//! The JSON documents of `flagred check` and `flagred explain`.

use flagred::check::InputRisk;
use fuzzy::{check, diagnostic::Diagnostic, engine, model::ProvenanceStep};
use serde::Serialize;

use crate::Examination;

// The version increases when a name in the document changes its meaning or is removed.
/// The name and version of the layout of [`CheckDocument`].
const CHECK: &str = "flagred.check/1";
/// The name and version of the layout of [`Explained`].
const EXPLAIN: &str = "flagred.explain/1";

/// The findings about a rule set or a profile: `flagred check --json`.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CheckDocument<'a> {
    #[cfg_attr(feature = "schema", schemars(extend("const" = CHECK)))]
    schema: &'static str,
    /// The path of the file, as given.
    file: &'a str,
    /// The name of the rule set; null if it has errors, and for a profile.
    model: Option<&'a str>,
    /// The name of the profile; absent if it cannot be read, and for a rule set.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(with = "str"))]
    profile: Option<&'a str>,
    /// The commands that created the rule set; absent if it has no provenance.
    #[serde(skip_serializing_if = "<[ProvenanceStep]>::is_empty")]
    provenance: &'a [ProvenanceStep],
    /// The findings of the text, followed by those of the analysis.
    findings: &'a [Diagnostic],
    /// The findings that the author accepts; absent if the author accepts none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    accepted: Vec<check::AcceptedFindings>,
    /// Regions, conflicts, reach and monotonicity in numbers; null if the rule set has errors, and for a profile.
    report: Option<&'a check::Report>,
    /// The highest risk that each input of a profile causes while all other inputs are calm; absent for a rule set.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(with = "[InputRisk]"))]
    alone: Option<&'a [InputRisk]>,
}

impl<'a> CheckDocument<'a> {
    /// The findings of a rule set.
    pub fn rules(file: &'a str, examined: &'a Examination) -> CheckDocument<'a> {
        let model = examined
            .analysed
            .as_ref()
            .map(|(document, _)| &document.model);
        CheckDocument {
            model: model.map(|model| model.name.as_str()),
            provenance: model.map_or(&[], |model| &model.provenance),
            accepted: examined.accepted(),
            report: examined.analysed.as_ref().map(|(_, report)| report),
            alone: None,
            ..CheckDocument::profile(file, None, &examined.findings.0, &[])
        }
    }

    /// The findings of the profile with the given name.
    pub fn profile(
        file: &'a str,
        name: Option<&'a str>,
        findings: &'a [Diagnostic],
        alone: &'a [InputRisk],
    ) -> CheckDocument<'a> {
        CheckDocument {
            schema: CHECK,
            file,
            model: None,
            profile: name,
            provenance: &[],
            findings,
            accepted: Vec::new(),
            report: None,
            alone: Some(alone),
        }
    }

    /// Adds the findings that the author accepts.
    #[must_use]
    pub fn with_accepted(mut self, accepted: Vec<check::AcceptedFindings>) -> CheckDocument<'a> {
        self.accepted = accepted;
        self
    }
}

/// An explanation of the outputs at a point: `flagred explain --json`.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schema", schemars(rename = "Explanation"))]
pub struct Explained<'a> {
    #[cfg_attr(feature = "schema", schemars(extend("const" = EXPLAIN)))]
    schema: &'static str,
    /// The name of the rule set.
    model: &'a str,
    #[serde(flatten)]
    explanation: &'a engine::Explanation,
    /// The rules that do not fire.
    #[serde(skip_serializing_if = "Option::is_none")]
    silent: Option<Vec<engine::SilentRule>>,
    /// The smallest changes of single inputs that change the result while the other inputs stay the same.
    #[serde(skip_serializing_if = "Option::is_none")]
    changes: Option<Vec<engine::Change>>,
}

impl<'a> Explained<'a> {
    /// The explanation for the rule set with the given name.
    pub fn new(model: &'a str, explanation: &'a engine::Explanation) -> Explained<'a> {
        Explained {
            schema: EXPLAIN,
            model,
            explanation,
            silent: None,
            changes: None,
        }
    }

    /// Adds the rules that do not fire and the nearest changes.
    #[must_use]
    pub fn with_reasons(
        mut self,
        silent: Vec<engine::SilentRule>,
        changes: Vec<engine::Change>,
    ) -> Explained<'a> {
        (self.silent, self.changes) = (Some(silent), Some(changes));
        self
    }
}
