//! From firing strengths to a number.

use alloc::vec::Vec;

use crate::model::{
    Aggregation, Defuzzifier, Implication, Operators, Output, Sampling, Term, Variable,
};
use crate::table::Moment;
use crate::table::operators::{larger, smaller};
use curves::Curves;
pub(crate) use layers::Layered;
use maxima::{Highest, Maxima};
pub(crate) use partition::Partition;
use piece::{Integrals, Piece, unit};
pub(crate) use prepared::Prepared;
use singletons::Singletons;
use weighted::Consequents;
use workspace::Workspace;

mod calculus;
mod curves;
mod layers;
mod maxima;
mod partition;
mod piece;
mod prepared;
mod sampled;
mod singletons;
pub(crate) mod weighted;
pub(crate) mod workspace;

/// The operators that activate and aggregate consequents.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Joint {
    pub(crate) implication: Implication,
    pub(crate) aggregation: Aggregation,
}

/// How the firing strengths of one consequent combine before the aggregated set is integrated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Merging {
    /// The largest counts: `max_r min(h_r, mu) = min(max_r h_r, mu)`, and the same for the product.
    Largest,
    /// The sum counts: `sum_r h_r mu = (sum_r h_r) mu`.
    Sum,
    /// Each rule keeps its own.
    Apart,
}

/// Firing strengths of one output, grouped by term.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Strengths<'a> {
    pub(crate) strengths: &'a [f64],
    /// Term k has the firing strengths `offsets[k]..offsets[k + 1]`.
    pub(crate) offsets: &'a [usize],
}

impl<'a> Strengths<'a> {
    fn of(&self, term: usize) -> &'a [f64] {
        match (self.offsets.get(term), self.offsets.get(term + 1)) {
            (Some(&first), Some(&end)) => self.strengths.get(first..end).unwrap_or_default(),
            _ => &[],
        }
    }
}

/// One output, compiled.
#[derive(Debug, Clone)]
pub(crate) struct Defuzzify {
    low: f64,
    high: f64,
    pub(crate) defuzzifier: Defuzzifier,
    joint: Joint,
    pub(crate) method: Method,
}

/// How the value is computed.
#[derive(Debug, Clone)]
pub(crate) enum Method {
    /// The centroid of the maximum over a partition.
    Partition(Partition),
    Curves(Curves),
    Sampled(Sampling, Curves),
    /// All terms are singletons.
    Singletons(Singletons),
    /// What does not depend on the inputs is computed.
    Prepared(Prepared),
    /// The centroid of the maximum of straight terms that are cut.
    Layered(Layered),
    /// The centroid of a sum of products: the area and moment of each term at a firing strength of 1.
    Moments(Vec<Moment>),
    /// Takagi-Sugeno.
    Weighted(Consequents),
    /// Tsukamoto, with monotone terms.
    Places(Vec<Term>),
}

impl Merging {
    pub(crate) fn of(defuzzifier: Defuzzifier, operators: Operators) -> Self {
        use Aggregation::{
            BoundedSum, Drastic, Einstein, Hamacher, Maximum, NilpotentMaximum, ProbabilisticSum,
            Sum,
        };
        if defuzzifier.takes_numbers() {
            return Merging::Sum;
        }
        if defuzzifier == Defuzzifier::Tsukamoto {
            return Merging::Apart;
        }
        match operators.aggregation {
            Maximum => Merging::Largest,
            Sum | BoundedSum if operators.implication == Implication::Product => Merging::Sum,
            Sum | BoundedSum | ProbabilisticSum | Drastic | Einstein | Hamacher
            | NilpotentMaximum => Merging::Apart,
        }
    }
}

impl Defuzzifier {
    /// Whether its terms are numbers and functions, as Takagi-Sugeno consequents are, rather than fuzzy sets.
    pub(crate) fn takes_numbers(self) -> bool {
        match self {
            Defuzzifier::WeightedAverage | Defuzzifier::WeightedSum => true,
            Defuzzifier::Centroid
            | Defuzzifier::Bisector
            | Defuzzifier::SmallestOfMaxima
            | Defuzzifier::MeanOfMaxima
            | Defuzzifier::LargestOfMaxima
            | Defuzzifier::Tsukamoto => false,
        }
    }

    /// Whether it weighs numbers, one for each rule: Takagi-Sugeno or Tsukamoto.
    pub(crate) fn is_weighted(self) -> bool {
        self.takes_numbers() || self == Defuzzifier::Tsukamoto
    }
}

impl Method {
    /// The fastest that is exact.
    fn of(output: &Output, joint: Joint) -> Self {
        let Variable {
            low, high, terms, ..
        } = &output.variable;
        let (low, high) = (*low, *high);
        if let Some(singletons) = Singletons::new(output) {
            return Method::Singletons(singletons);
        }
        if let Some(sampling) = output.samples {
            return Method::Sampled(sampling, Curves::new(terms, low, high));
        }
        let about = (low + 0.5 * (high - low), unit(high - low));
        let is_centroid_of = |implication: Implication, aggregation: Aggregation| {
            output.defuzzifier == Defuzzifier::Centroid
                && (joint.implication, joint.aggregation) == (implication, aggregation)
        };
        let cuts = is_centroid_of(Implication::Minimum, Aggregation::Maximum);
        let scales = is_centroid_of(Implication::Product, Aggregation::Maximum);
        if (cuts || scales)
            && let Some(partition) = Partition::new(terms, (low, high), about, scales)
        {
            return Method::Partition(partition);
        }
        let is_straight = |term: &Term| term.membership_function.corners().is_some();
        let all_straight = terms.iter().all(is_straight);
        let prepared = Prepared::new(terms, (low, high), joint, output.defuzzifier);
        match prepared {
            Some(prepared) if is_centroid_of(Implication::Product, Aggregation::Sum) => {
                Method::Moments(prepared.moments(about.1))
            }
            Some(prepared) if cuts && all_straight => match Layered::new(&prepared, about) {
                Some(layered) => Method::Layered(layered),
                None => Method::Prepared(prepared),
            },
            Some(prepared) => Method::Prepared(prepared),
            None => Method::Curves(Curves::new(terms, low, high)),
        }
    }
}

impl Defuzzify {
    /// Compiles a Mamdani output.
    pub(crate) fn fuzzy(output: &Output, operators: Operators) -> Self {
        let variable = &output.variable;
        let (low, high) = (variable.low, variable.high);
        let joint = Joint {
            implication: operators.implication,
            aggregation: operators.aggregation,
        };
        Defuzzify {
            low,
            high,
            defuzzifier: output.defuzzifier,
            joint,
            method: Method::of(output, joint),
        }
    }

    /// Compiles a Takagi-Sugeno or Tsukamoto output.
    pub(crate) fn weighted(output: &Output, operators: Operators, method: Method) -> Self {
        Defuzzify {
            low: output.variable.low,
            high: output.variable.high,
            defuzzifier: output.defuzzifier,
            joint: Joint {
                implication: operators.implication,
                aggregation: operators.aggregation,
            },
            method,
        }
    }

    /// The closed form of the centroid over a partition.
    pub(crate) fn partition(&self) -> Option<&Partition> {
        match &self.method {
            Method::Partition(partition) => Some(partition),
            _ => None,
        }
    }

    /// The number of firing strengths of a partition, and the index of each term's; `None` of another output, where
    /// [`Strengths::offsets`] has them.
    pub(crate) fn ranks(&self) -> Option<(usize, &[usize])> {
        self.partition()
            .map(|partition| (partition.strengths(), partition.ranks()))
    }

    /// The most cuts of an evaluation, besides those of its activations.
    pub(crate) fn cuts(&self) -> usize {
        match &self.method {
            Method::Curves(curves) => curves.workspace(),
            _ => 0,
        }
    }

    /// Whether a term is 0 all over the range.
    pub(crate) fn is_empty(&self, term: usize) -> bool {
        match &self.method {
            Method::Curves(curves) | Method::Sampled(_, curves) => curves.is_empty(term),
            Method::Partition(partition) => partition.is_empty(term),
            Method::Prepared(prepared) => prepared.is_empty(term),
            Method::Layered(layered) => layered.is_empty(term),
            Method::Moments(moments) => moments.get(term).is_none_or(|m| m.area <= 0.0),
            Method::Singletons(singletons) => singletons.is_empty(term),
            Method::Weighted(_) | Method::Places(_) => false,
        }
    }

    /// The value of an output without a closed form; `None` where no rule fired. Not inlined, which keeps the code of closed
    /// forms small.
    #[inline(never)]
    pub(crate) fn value(&self, strengths: Strengths<'_>, workspace: &mut Workspace) -> Option<f64> {
        let value = match &self.method {
            Method::Sampled(sampling, curves) => {
                let steps = sampling.samples.saturating_mul(strengths.strengths.len());
                if !workspace.steps.take(steps) {
                    return None;
                }
                sampling.value(self.defuzzifier, (self.low, self.high), |x| {
                    curves.degree(strengths, self.joint, x)
                })
            }
            Method::Curves(_) => self.exact(strengths, workspace),
            Method::Singletons(singletons) => {
                singletons.value(strengths, self.joint, self.defuzzifier)
            }
            Method::Partition(_)
            | Method::Prepared(_)
            | Method::Layered(_)
            | Method::Moments(_)
            | Method::Weighted(_)
            | Method::Places(_) => None,
        }?;
        Some(larger(self.low, smaller(self.high, value)))
    }

    fn exact(&self, strengths: Strengths<'_>, workspace: &mut Workspace) -> Option<f64> {
        match self.defuzzifier {
            Defuzzifier::SmallestOfMaxima
            | Defuzzifier::MeanOfMaxima
            | Defuzzifier::LargestOfMaxima => {
                let mut highest = Highest::default();
                self.pieces(strengths, workspace, &mut |piece| highest.see(piece));
                let mut maxima = Maxima::of(highest);
                self.pieces(strengths, workspace, &mut |piece| maxima.see(piece));
                maxima.value(self.defuzzifier).filter(|_| highest.0 > 0.0)
            }
            Defuzzifier::Bisector => {
                let mut whole = self.integrals();
                self.pieces(strengths, workspace, &mut |piece| whole.add(piece));
                let unit = unit(self.high - self.low);
                let half = 0.5 * whole.area * unit;
                let mut sum = 0.0;
                let mut bisector = None;
                self.pieces(strengths, workspace, &mut |piece| {
                    if bisector.is_none() {
                        let area = piece.area();
                        if sum + area >= half && area > 0.0 {
                            bisector = Some(piece.where_area_is(half - sum));
                        }
                        sum += area;
                    }
                });
                bisector.filter(|_| whole.area > 0.0)
            }
            Defuzzifier::Centroid
            | Defuzzifier::WeightedAverage
            | Defuzzifier::WeightedSum
            | Defuzzifier::Tsukamoto => {
                let mut integrals = self.integrals();
                self.pieces(strengths, workspace, &mut |piece| integrals.add(piece));
                integrals.centroid()
            }
        }
    }

    pub(crate) fn implication(&self) -> Implication {
        self.joint.implication
    }

    /// The middle of the range.
    pub(crate) fn middle(&self) -> f64 {
        self.low + 0.5 * (self.high - self.low)
    }

    fn integrals(&self) -> Integrals {
        Integrals::about(self.middle(), unit(self.high - self.low))
    }

    fn pieces(
        &self,
        strengths: Strengths<'_>,
        workspace: &mut Workspace,
        visit: &mut dyn FnMut(&Piece<'_>),
    ) {
        match &self.method {
            Method::Curves(curves) => curves.pieces(strengths, self.joint, workspace, visit),
            Method::Partition(_)
            | Method::Prepared(_)
            | Method::Layered(_)
            | Method::Sampled(..)
            | Method::Singletons(_)
            | Method::Moments(_)
            | Method::Weighted(_)
            | Method::Places(_) => {}
        }
    }
}

#[cfg(test)]
mod tests;
