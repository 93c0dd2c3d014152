//! Findings of `check` that an author accepts.

use alloc::string::String;

/// A finding of the analysis that an author accepts, with the reason. It does not affect evaluation.
#[derive(Debug, Clone, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct AllowedFinding {
    /// The code of the finding, such as `jump`.
    pub finding: String,
    /// A name in backticks in the message of the finding, such as the name of a variable; `None` accepts all findings
    /// with the code.
    pub of: Option<String>,
    /// The author's reason.
    pub because: String,
}
