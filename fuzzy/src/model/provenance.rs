//! The provenance of rules and numbers: the commands that produced them.

use alloc::{string::String, vec::Vec};

/// A command that derived a rule set from another one. It does not affect evaluation.
#[derive(Debug, Clone, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ProvenanceStep {
    /// The command, or a description of the step.
    pub command: String,
    /// The data files.
    pub data: Vec<DataFile>,
    /// The number of rows that were used.
    pub rows: Option<u64>,
    /// The random seed.
    pub seed: Option<u64>,
    /// The loss that was minimised.
    pub loss: Option<LossChange>,
    /// The number of rules before and after the step.
    pub rules: Option<[u64; 2]>,
    /// The numbers that changed, as text: `heat.warm peak from 20 to 22.5`.
    pub moved: Vec<String>,
    /// Further remarks.
    pub note: Option<String>,
    /// A hash of the resulting rule set. If the current hash differs, the rule set was edited afterwards.
    pub result: Option<String>,
}

/// A data file.
#[derive(Debug, Clone, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct DataFile {
    /// The file name without folders.
    pub file: String,
    /// The SHA-256 of the contents, in hexadecimal; `None` if the contents are not available, as for standard input.
    pub sha256: Option<String>,
}

/// The value of a loss before and after a step.
#[derive(Debug, Clone, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LossChange {
    /// The name of the loss, such as `RMS error`.
    pub name: String,
    /// The loss before the step.
    pub before: f64,
    /// The loss after the step.
    pub after: f64,
}
