//! Voting rules, tuned on flights and validated on held-out vehicles.
//!
//! The risk is the mean of the peaks of the consequents, weighted by the degrees of the antecedents times the rule
//! weights. This equals the centroid for terms of equal width, with implication by product and aggregation by sum.
//! A template defines the inputs, their terms and the rules; peaks, consequents and weights are tuned.

mod candidates;
mod folds;
mod objective;
mod rows;
mod search;
mod shares;
mod votes;

pub use candidates::{CANDIDATES, candidate, with_step};
pub use folds::{folds, judge, tune_without};
pub use objective::{AREAS, Area, FALSE_ALARM_SETS, FalseAlarmSet};
pub use rows::{Data, Row, Set, read};
pub use search::tune;
pub use shares::{Share, risks_pct, shares, with_shares};
pub use votes::Votes;

/// An error, for example while reading or writing files.
pub type Failure = Box<dyn std::error::Error + Send + Sync>;
