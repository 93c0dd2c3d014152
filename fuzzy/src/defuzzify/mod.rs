//! Computing a number from firing strengths: the coefficients of the closed forms, and the integrator for sets without
//! a closed form.
//!
//! [`engine::strategy`](crate::engine) chooses one of these methods for each output. The following list shows the
//! data that each method stores for an output with three triangles, `low` (0, 0, 5), `medium` (0, 5, 10) and
//! `high` (5, 10, 10), over 0 to 10:
//!
//! - [`Partition`]: the terms sum to 1, so each term is stored as one half of a [`Pair`](crate::table::Pair).
//!   If `low` is cut at `h`, it has the area `5 h - 2.5 h^2`. Its overlap with `medium` is 5 wide, and the
//!   middle of the overlap is at 2.5.
//! - [`Moments`](Method::Moments): the area and moment of each term about the middle, 5. `low` has the area 2.5 and,
//!   with its centroid at 5/3, the moment `2.5 (5/3 - 5) = -8.33`.
//! - [`PreparedSet`]: each term is split into flanks, which only rise or only fall: one for `low`, two for `medium`, one
//!   for `high`. The range is split where two flanks cross, at 2.5 and 7.5, and where they end, at 5. On each of the
//!   four sections, one of the two flanks is always the higher one.
//! - [`PreparedLayers`]: for each term on each section, the area of a layer. The layer lies between the largest
//!   firing strength of the terms that are higher there, and the firing strength of the term itself.
//! - [`IntegratedSet`]: only the terms and their corners, 0, 5 and 10. The aggregated set is split into pieces in each
//!   evaluation.
//! - [`Reduction`]: the same data as for `IntegratedSet`, for the lower and for the upper membership functions
//!   of an interval type-2 output.

use alloc::vec::Vec;

use crate::model::{Aggregation, Implication, Output, Term};
use crate::table::Moment;
use curves::Curves;
pub(crate) use enclosure::EnclosureMethod;
pub(crate) use integrated::IntegratedSet;
pub(crate) use layers::PreparedLayers;
pub(crate) use partition::Partition;
pub(crate) use piece::unit;
pub(crate) use prepared::{PreparedSet, corners, straight};
pub(crate) use reduction::Reduction;
pub(crate) use weighted::Consequents;

mod calculus;
mod curves;
mod enclosure;
mod integrated;
mod layers;
mod maxima;
mod partition;
mod piece;
mod prepared;
mod reduction;
mod sampled;
mod singletons;
mod weighted;
pub(crate) mod workspace;

/// The operators that activate and aggregate consequents.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ConsequentOperators {
    pub(crate) implication: Implication,
    pub(crate) aggregation: Aggregation,
}

/// Firing strengths of one output, grouped by term.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Strengths<'a> {
    pub(crate) strengths: &'a [f64],
    /// The offsets of the terms: term k has the firing strengths `offsets[k]..offsets[k + 1]`.
    pub(crate) offsets: &'a [usize],
}

impl<'a> Strengths<'a> {
    pub(crate) fn of(&self, term: usize) -> &'a [f64] {
        match (self.offsets.get(term), self.offsets.get(term + 1)) {
            (Some(&first), Some(&end)) => self.strengths.get(first..end).unwrap_or_default(),
            (None, _) | (_, None) => &[],
        }
    }
}

/// The method that computes the value of an output, with all data that does not depend on the inputs.
#[derive(Debug, Clone)]
pub(crate) enum Method {
    /// The centroid of a set whose terms form a partition and are aggregated by maximum.
    Partition(Partition),
    /// The centroid of a set of straight terms that are cut, and aggregated by maximum.
    Layered(PreparedLayers),
    /// The centroid of a set of terms that are scaled and summed: the area and moment of each term at a firing strength
    /// of 1.
    Moments(Vec<Moment>),
    /// A set with known flanks and sections.
    Prepared(PreparedSet),
    /// A set without a closed form.
    Integrated(IntegratedSet),
    /// Takagi-Sugeno: the mean of the consequents weighted by firing strengths, or their sum.
    Sugeno {
        consequents: Consequents,
        is_sum: bool,
    },
    /// Tsukamoto, with monotone terms.
    Tsukamoto(Vec<Term>),
}

/// Returns whether a term of a fuzzy output is 0 on the whole range.
pub(crate) fn is_empty(output: &Output, term: &Term) -> bool {
    let (low, high) = (output.variable.low, output.variable.high);
    match (term.membership_function.at(), corners(term)) {
        (Some(x), _) => !(low..=high).contains(&x),
        (None, Some(corners)) => straight(&corners, low, high).is_empty(),
        (None, None) => Curves::new(core::slice::from_ref(term), low, high).is_empty(),
    }
}

#[cfg(test)]
mod tests;
