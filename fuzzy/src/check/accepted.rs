//! Findings that the author accepts.

use alloc::{format, string::String, vec::Vec};
use core::ops::Range;

use crate::{
    diagnostic::{Diagnostic, Severity},
    model::AllowedFinding,
};

/// An entry of `allow`, with the number of findings that it accepts.
#[derive(Debug, Clone, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct AcceptedFindings {
    /// The code of the finding.
    pub finding: String,
    /// The name that the finding must contain; absent if all findings with this code are accepted.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Option::is_none"))]
    #[cfg_attr(feature = "schema", schemars(with = "str"))]
    pub of: Option<String>,
    /// The author's reason.
    pub because: String,
    /// The number of accepted findings.
    pub count: usize,
}

impl AcceptedFindings {
    /// Removes from `findings` those that an entry of `allow` accepts. Returns the entries, each with the number of
    /// findings that it accepts. Errors are never accepted. If several entries accept a finding, it counts for the
    /// first of them.
    pub fn remove(
        allow: &[AllowedFinding],
        findings: &mut Vec<Diagnostic>,
    ) -> Vec<AcceptedFindings> {
        let entry = |one: &AllowedFinding| AcceptedFindings {
            finding: one.finding.clone(),
            of: one.of.clone(),
            because: one.because.clone(),
            count: 0,
        };
        let mut entries: Vec<AcceptedFindings> = allow.iter().map(entry).collect();
        findings.retain(|finding| {
            let entry = entries.iter_mut().find(|one| one.accepts(finding));
            entry.is_none_or(|entry| {
                entry.count += 1;
                false
            })
        });
        entries
    }

    /// Returns a warning for each entry that accepts no finding. `spans` are the positions of the entries.
    pub fn unneeded(entries: &[AcceptedFindings], spans: &[Range<usize>]) -> Vec<Diagnostic> {
        let warning = |(i, one): (usize, &AcceptedFindings)| {
            let span = spans.get(i).cloned().unwrap_or_default();
            let of = one
                .of
                .as_ref()
                .map_or(String::new(), |of| format!(" of `{of}`"));
            let message = format!(
                "`allow` accepts `{}`{of}, which does not occur",
                one.finding
            );
            let finding = Diagnostic::warning("unneeded-allow", span, message);
            (one.count == 0).then(|| finding.help("remove the entry"))
        };
        entries.iter().enumerate().filter_map(warning).collect()
    }

    fn accepts(&self, finding: &Diagnostic) -> bool {
        let is_of = |of: &String| finding.message.contains(&format!("`{of}`"));
        self.finding == finding.code
            && finding.severity != Severity::Error
            && self.of.as_ref().is_none_or(is_of)
    }
}
