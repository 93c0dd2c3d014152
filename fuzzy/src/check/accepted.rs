//! Findings that the author accepts.

use alloc::{format, string::String, vec::Vec};

use super::{Report, findings};
use crate::{
    diagnostic::{Diagnostic, Severity},
    model::{Model, document::Spans},
};

/// An entry of [`Model::allow`], with the number of findings that it accepts.
#[derive(Debug, Clone, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct AcceptedFindings {
    /// The code of the finding.
    pub finding: String,
    /// The author's reason.
    pub because: String,
    /// The number of findings with this code.
    pub count: usize,
}

/// Returns the index of the entry that accepts a finding.
pub(super) fn by(model: &Model, finding: &Diagnostic) -> Option<usize> {
    let mut entries = model.allow.iter();
    entries.position(|one| one.finding == finding.code && finding.severity != Severity::Error)
}

/// Returns the entries, each with the number of findings that it accepts.
pub(super) fn counted(report: &Report, model: &Model) -> Vec<AcceptedFindings> {
    let entry = |one: &crate::model::AllowedFinding| AcceptedFindings {
        finding: one.finding.clone(),
        because: one.because.clone(),
        count: 0,
    };
    let mut entries: Vec<AcceptedFindings> = model.allow.iter().map(entry).collect();
    if entries.is_empty() {
        return entries;
    }
    for finding in findings::of(report, model, &Spans::default()) {
        if let Some(entry) = by(model, &finding).and_then(|entry| entries.get_mut(entry)) {
            entry.count += 1;
        }
    }
    entries
}

/// Returns a warning for each entry whose finding does not occur; none if the analysis is incomplete.
pub(super) fn unneeded(report: &Report, model: &Model, spans: &Spans) -> Vec<Diagnostic> {
    let is_complete = report.uncovered_complete && report.reach_complete && report.jumps_complete;
    if !is_complete {
        return Vec::new();
    }
    let warning = |(i, one): (usize, AcceptedFindings)| {
        let span = spans.allow.get(i).cloned().unwrap_or_default();
        let message = format!("`allow` accepts `{}`, which does not occur", one.finding);
        let finding = Diagnostic::warning("unneeded-allow", span, message);
        (one.count == 0).then(|| finding.help("remove the entry"))
    };
    let entries = counted(report, model).into_iter().enumerate();
    entries.filter_map(warning).collect()
}
