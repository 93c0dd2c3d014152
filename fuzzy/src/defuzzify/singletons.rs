//! Outputs whose terms are all singletons: the aggregated set consists of single points with a degree each.

use alloc::vec::Vec;

use super::{ConsequentOperators, Strengths};
use crate::model::Output;
use crate::table::{OfMaxima, SetDefuzzifier};

/// The terms of one output as points, from left to right.
#[derive(Debug, Clone)]
pub(crate) struct Singletons {
    /// For each term, its value, its index and its height.
    terms: Vec<(f64, usize, f64)>,
}

impl Singletons {
    /// Creates the points of an output; `None` if a term is not a singleton.
    pub(super) fn new(output: &Output) -> Option<Self> {
        if !output.is_discrete() {
            return None;
        }
        let terms = output.variable.terms.iter().enumerate();
        let place = |(i, term): (usize, &crate::model::Term)| {
            Some((term.membership_function.at()?, i, term.height))
        };
        let mut terms: Vec<(f64, usize, f64)> = terms.map(place).collect::<Option<_>>()?;
        terms.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        Some(Singletons { terms })
    }

    /// Returns the centroid `sum(x y) / sum(y)` over the points x with their aggregated degrees y, or the smallest,
    /// mean or largest of the points with the highest degree; `None` if all degrees are 0.
    pub(super) fn value(
        &self,
        strengths: Strengths<'_>,
        operators: ConsequentOperators,
        defuzzifier: SetDefuzzifier,
    ) -> Option<f64> {
        let places = || {
            self.terms.chunk_by(|a, b| a.0 == b.0).filter_map(|terms| {
                let mut degree = 0.0;
                for (_, term, height) in terms {
                    for strength in strengths.of(*term).iter().filter(|h| **h > 0.0) {
                        let part = operators.implication.of(*strength, *height);
                        degree = operators.aggregation.of(degree, part);
                    }
                }
                terms.first().map(|(x, ..)| (*x, degree))
            })
        };
        let total: f64 = places().map(|(_, degree)| degree).sum();
        if total <= 0.0 {
            return None;
        }
        let highest = places().map(|(_, degree)| degree).fold(0.0, f64::max);
        let mut top = places().filter(|(_, degree)| *degree == highest);
        Some(match defuzzifier {
            SetDefuzzifier::Maxima(OfMaxima::Smallest) => top.next()?.0,
            SetDefuzzifier::Maxima(OfMaxima::Largest) => top.next_back()?.0,
            SetDefuzzifier::Maxima(OfMaxima::Mean) => {
                let count = top.clone().count() as f64;
                top.map(|(x, _)| x / count).sum()
            }
            // Singletons have no area to halve; validation rejects a bisector.
            SetDefuzzifier::Centroid | SetDefuzzifier::Bisector => {
                places().map(|(x, degree)| x * (degree / total)).sum()
            }
        })
    }
}
