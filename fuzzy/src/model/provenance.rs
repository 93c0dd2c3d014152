//! Where rules and numbers come from: the commands that made them.

use alloc::{string::String, vec::Vec};

/// A command that made a rule set of another one. It changes nothing of what the rules mean.
#[derive(Debug, Clone, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Step {
    /// What made it: a command, or in words.
    pub command: String,
    /// The files with the data.
    pub data: Vec<DataFile>,
    /// How many rows of them were used.
    pub rows: Option<u64>,
    /// The seed of what was random.
    pub seed: Option<u64>,
    /// The loss that was made small.
    pub loss: Option<LossChange>,
    /// The number of rules, before and after.
    pub rules: Option<[u64; 2]>,
    /// The numbers that moved, each in words: `heat.warm peak from 20 to 22.5`.
    pub moved: Vec<String>,
    /// What else there is to say.
    pub note: Option<String>,
    /// A hash of the rule set that the command made; another one now says that it was edited since.
    pub result: Option<String>,
}

/// A file with data.
#[derive(Debug, Clone, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct DataFile {
    /// Its name, without folders.
    pub file: String,
    /// The SHA-256 of its bytes, in hexadecimal digits; `None` where they are gone, as those of standard input.
    pub sha256: Option<String>,
}

/// A loss before and after.
#[derive(Debug, Clone, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LossChange {
    /// What it is, as `RMS error`.
    pub name: String,
    /// Before.
    pub before: f64,
    /// After.
    pub after: f64,
}
