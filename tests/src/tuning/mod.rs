//! Rules that vote, tuned on flights and judged on vehicles that were left out.
//!
//! The risk is the mean of the consequents' peaks, weighted by what the rules' antecedents come to times their weights:
//! the centroid over terms of equal width with product and sum. A template names the inputs, their terms and the rules;
//! peaks, consequents and weights are tuned.

mod candidates;
mod folds;
mod objective;
mod rows;
mod search;
mod shares;
mod votes;

pub use candidates::{CANDIDATES, candidate, with_step};
pub use folds::{folds, judge, tune_without};
pub use objective::{AREAS, Area, EXCESSES, Excess};
pub use rows::{Data, Row, Set, read};
pub use search::tune;
pub use shares::{Share, risks_pct, shares, with_shares};
pub use votes::Votes;

/// What goes wrong with files.
pub type Failure = Box<dyn std::error::Error + Send + Sync>;
