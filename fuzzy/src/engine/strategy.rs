//! The choice of strategy: how the rules of a stage fire, and how each output is reduced to a number.
//!
//! Times are nanoseconds per evaluation of the rule set `published(true)` of `benches/src/lib.rs` (2 inputs, 10 rules,
//! 5 output terms), with the operators of the respective row, on one machine. Only their ratios are meaningful.
//!
//! # How an output is reduced to a number
//!
//! [`method`] chooses the first row that applies. Methods with a [`ClosedForm`] can be evaluated by the table
//! alone, also in firmware; `Integrated` needs the engine.
//!
//! | defuzzifier, operators, terms | [`Method`] | prepared in | evaluated in | ns |
//! |---|---|---|---|---|
//! | weighted average, weighted sum | `Sugeno` | `defuzzify/weighted.rs` | `table/closed.rs` | 24 |
//! | Tsukamoto | `Tsukamoto` | - | `table/closed.rs` | 46 |
//! | terms that are all singletons | `Integrated`, as singletons | `defuzzify/singletons.rs` | the same | 122 |
//! | `samples` are given | `Integrated`, as samples | `defuzzify/sampled.rs` | the same | 36 per sample |
//! | centroid, minimum or product with maximum, a partition | `Partition` | `defuzzify/partition.rs` | `table/closed.rs` | 27 |
//! | centroid, product with sum, up to 64 terms, no formula | `Moments` | `defuzzify/prepared.rs` | `table/closed.rs` | 23 |
//! | centroid, minimum with maximum, straight terms (limits as above) | `Layered` | `defuzzify/layers.rs` | `table/layers.rs` | 60 |
//! | minimum or product with maximum, or with sum except for maxima, up to 64 terms, no formula | `Prepared` | `defuzzify/prepared.rs` | `table/set.rs` | 73 to 1,200 |
//! | any other | `Integrated`, in pieces | `defuzzify/curves.rs` | the same | 250 to 3,000 |
//!
//! An output with a type reduction to an interval is `Prepared` if possible, whatever its terms, because
//! `table/set/between.rs` integrates parts of its two sets.
//!
//! # How firing strengths of rules with the same consequent are combined
//!
//! | defuzzifier and operators | [`StrengthCombination`] |
//! |---|---|
//! | weighted average, weighted sum; product with sum or bounded sum | `Sum` |
//! | maximum, since every implication is monotone in the strength | `Largest` |
//! | any other | `Separate` |
//!
//! # How rules fire
//!
//! `engine/rules.rs` chooses one layout for the rules. Blocks with their own operators or activation methods are
//! always compiled to programs. The results of all layouts are bitwise equal.
//!
//! | rules | layout | fired by | when |
//! |---|---|---|---|
//! | ANDs of straight terms, at most two above 0 per input | [`Conjunctions::Uniform`] | `table/conjunctions.rs` | up to 6 inputs, 2 consequents per cell |
//! | other ANDs | [`Conjunctions::Dense`] | `table/conjunctions.rs` | up to 65,536 cells and 32 cells per rule |
//! | ANDs in larger tables | [`Conjunctions::Trie`] | `table/conjunctions.rs` | always possible |
//! | any other conditions, and ANDs of small rule sets | programs | `table/firing.rs` | always possible |
//!
//! | evaluation | [`SingleRowMethod`] | file | when | ns |
//! |---|---|---|---|---|
//! | one row | `Plane` | `engine/vectors/plane.rs` | feature `simd`, a uniform table of 2 inputs and 1 output | 27 |
//! | one row | `Vectors` | `engine/vectors/uniform.rs` | feature `simd`, a uniform table of 3 or 4 inputs and 1 output | 66 (`four_inputs`) |
//! | one row | `Cells` | `table/firing.rs` | any other uniform table without programs | 73 (2 outputs) |
//! | one row | `Rules` | `table/firing.rs` | any other rules | 82 (`tipper`) |
//! | one row | `Bounds` | `engine/bounds.rs` | interval type-2 terms: rules have both bounds; the table computes the interval, or `defuzzify/reduction.rs` if there is no closed form | 1,720 |
//! | many rows | - | `engine/batch.rs` | programs alone, if there are few ([`OwnedTable::programs_alone`]); otherwise the layout above | 13 |

use super::arrays::OwnedTable;
use super::bounds::Bounds;
#[cfg(feature = "simd")]
use super::vectors::{Plane, Uniform};
use crate::defuzzify::{
    ConsequentOperators, Consequents, IntegratedSet, Method, Partition, PreparedLayers,
    PreparedSet, corners, unit,
};
use crate::model::{Aggregation, Defuzzifier, Implication, Operators, Output, Variable};
#[cfg(doc)]
use crate::table::{ClosedForm, Conjunctions};
use crate::table::{OfMaxima, Outcome, SetDefuzzifier, has_cells_alone};

/// The method that fires the rules of a stage for a single row.
#[derive(Debug, Clone)]
pub(super) enum SingleRowMethod {
    /// A table of two inputs that is evaluated with vector instructions: both its rules and its
    /// defuzzification.
    #[cfg(feature = "simd")]
    Plane(alloc::boxed::Box<Plane>),
    /// A table whose rules are fired with vector instructions.
    #[cfg(feature = "simd")]
    Vectors(alloc::boxed::Box<Uniform>),
    /// A table that consists of uniform cells only.
    Cells,
    /// Any other layout.
    Rules,
    /// Rules with both bounds of their firing strengths, and a type reduction.
    Bounds(alloc::boxed::Box<Bounds>),
}

impl SingleRowMethod {
    pub(super) fn of(table: &OwnedTable) -> Self {
        #[cfg(feature = "simd")]
        if let Some(plane) = Plane::new(table) {
            return SingleRowMethod::Plane(plane.into());
        } else if let Some(uniform) = Uniform::new(table) {
            return SingleRowMethod::Vectors(uniform.into());
        }
        match has_cells_alone(table) {
            true => SingleRowMethod::Cells,
            false => SingleRowMethod::Rules,
        }
    }

    /// Evaluates the row, without working memory, if the rules are compiled to a plane. Returns whether the row was
    /// evaluated.
    #[inline(always)]
    #[cfg_attr(not(feature = "simd"), expect(unused_variables))]
    pub(super) fn by_plane(&self, inputs: &[f64], outcomes: &mut [Outcome]) -> bool {
        match self {
            #[cfg(feature = "simd")]
            SingleRowMethod::Plane(plane) => {
                if let (Ok(inputs), [outcome]) = (inputs.try_into(), outcomes) {
                    plane.evaluate(inputs, outcome);
                }
                true
            }
            #[cfg(feature = "simd")]
            SingleRowMethod::Vectors(_) => false,
            SingleRowMethod::Cells | SingleRowMethod::Rules | SingleRowMethod::Bounds(_) => false,
        }
    }
}

/// The way in which the firing strengths of rules with the same consequent are combined before the aggregated set is
/// integrated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum StrengthCombination {
    /// By maximum: `max_r min(h_r, mu) = min(max_r h_r, mu)`, and likewise for the other implications.
    Largest,
    /// By sum: `sum_r h_r mu = (sum_r h_r) mu`.
    Sum,
    /// No combination: the firing strength of each rule is used separately.
    Separate,
}

impl StrengthCombination {
    pub(super) fn of(method: &Method, operators: Operators) -> Self {
        match method {
            Method::Sugeno { .. } => return StrengthCombination::Sum,
            Method::Tsukamoto(_) => return StrengthCombination::Separate,
            Method::Partition(_)
            | Method::Layered(_)
            | Method::Moments(_)
            | Method::Prepared(_)
            | Method::Integrated(_) => {}
        }
        match (
            operators.aggregation,
            ImplicationEffect::by(operators.implication),
        ) {
            (Aggregation::Maximum, _) => StrengthCombination::Largest,
            (Aggregation::Sum | Aggregation::BoundedSum, ImplicationEffect::Scaled) => {
                StrengthCombination::Sum
            }
            (
                Aggregation::Sum
                | Aggregation::BoundedSum
                | Aggregation::ProbabilisticSum
                | Aggregation::Drastic
                | Aggregation::Einstein
                | Aggregation::Hamacher
                | Aggregation::NilpotentMaximum,
                ImplicationEffect::Cut | ImplicationEffect::Scaled | ImplicationEffect::Otherwise,
            ) => StrengthCombination::Separate,
        }
    }
}

/// The effect of an implication on a term.
enum ImplicationEffect {
    /// The term is cut off at the firing strength.
    Cut,
    /// The term is scaled by the firing strength.
    Scaled,
    /// Any other effect, which has no closed form.
    Otherwise,
}

impl ImplicationEffect {
    fn by(implication: Implication) -> Self {
        match implication {
            Implication::Minimum => ImplicationEffect::Cut,
            Implication::Product => ImplicationEffect::Scaled,
            Implication::BoundedDifference
            | Implication::Drastic
            | Implication::Einstein
            | Implication::Hamacher
            | Implication::NilpotentMinimum => ImplicationEffect::Otherwise,
        }
    }
}

/// The aggregation of two activated terms.
enum AggregationEffect {
    Maximum,
    Sum,
    /// Any other aggregation, which has no closed form.
    Otherwise,
}

impl AggregationEffect {
    fn by(aggregation: Aggregation) -> Self {
        match aggregation {
            Aggregation::Maximum => AggregationEffect::Maximum,
            Aggregation::Sum => AggregationEffect::Sum,
            Aggregation::BoundedSum
            | Aggregation::ProbabilisticSum
            | Aggregation::Drastic
            | Aggregation::Einstein
            | Aggregation::Hamacher
            | Aggregation::NilpotentMaximum => AggregationEffect::Otherwise,
        }
    }
}

/// Chooses the method that reduces an output of a valid model to a number. `input` returns the index of an input that a
/// consequent names.
pub(super) fn method(
    output: &Output,
    operators: Operators,
    input: impl Fn(&str) -> Option<usize>,
) -> Method {
    let sugeno = |is_sum: bool| Method::Sugeno {
        consequents: Consequents::new(&output.variable.terms, input),
        is_sum,
    };
    let set = |defuzzifier| method_of_set(output, operators, defuzzifier);
    match output.defuzzifier {
        Defuzzifier::WeightedAverage => sugeno(false),
        Defuzzifier::WeightedSum => sugeno(true),
        Defuzzifier::Tsukamoto => Method::Tsukamoto(output.variable.terms.clone()),
        Defuzzifier::Centroid => set(SetDefuzzifier::Centroid),
        Defuzzifier::Bisector => set(SetDefuzzifier::Bisector),
        Defuzzifier::SmallestOfMaxima => set(SetDefuzzifier::Maxima(OfMaxima::Smallest)),
        Defuzzifier::MeanOfMaxima => set(SetDefuzzifier::Maxima(OfMaxima::Mean)),
        Defuzzifier::LargestOfMaxima => set(SetDefuzzifier::Maxima(OfMaxima::Largest)),
    }
}

/// Returns the fastest exact method for a fuzzy set.
fn method_of_set(output: &Output, operators: Operators, defuzzifier: SetDefuzzifier) -> Method {
    let closed = match (output.samples, output.is_discrete()) {
        (None, false) => closed_form(output, operators, defuzzifier),
        (Some(_), _) | (None, true) => None,
    };
    closed.unwrap_or_else(|| {
        let operators = ConsequentOperators {
            implication: operators.implication,
            aggregation: operators.aggregation,
        };
        Method::Integrated(IntegratedSet::new(output, operators, defuzzifier))
    })
}

/// Returns whether the terms are scaled instead of cut, and whether they are summed instead of aggregated by maximum;
/// `None` for other operators, which have no closed form.
fn scales_and_sums(operators: Operators) -> Option<(bool, bool)> {
    let scales = match ImplicationEffect::by(operators.implication) {
        ImplicationEffect::Cut => false,
        ImplicationEffect::Scaled => true,
        ImplicationEffect::Otherwise => return None,
    };
    let sums = match AggregationEffect::by(operators.aggregation) {
        AggregationEffect::Maximum => false,
        AggregationEffect::Sum => true,
        AggregationEffect::Otherwise => return None,
    };
    Some((scales, sums))
}

/// Prepares the fuzzy set of an output without `samples`; `None` if this is not possible.
pub(super) fn prepared_set(
    output: &Output,
    operators: Operators,
    defuzzifier: SetDefuzzifier,
) -> Option<PreparedSet> {
    let range = (output.variable.low, output.variable.high);
    let form = scales_and_sums(operators)?;
    if output.is_discrete() {
        return None;
    }
    PreparedSet::new(&output.variable.terms, range, form, defuzzifier)
}

fn closed_form(
    output: &Output,
    operators: Operators,
    defuzzifier: SetDefuzzifier,
) -> Option<Method> {
    let Variable {
        low, high, terms, ..
    } = &output.variable;
    let range = (*low, *high);
    let about = (low + 0.5 * (high - low), unit(high - low));
    let (scales, sums) = scales_and_sums(operators)?;
    let is_centroid = match defuzzifier {
        SetDefuzzifier::Centroid => true,
        SetDefuzzifier::Maxima(_) if sums => return None,
        SetDefuzzifier::Bisector | SetDefuzzifier::Maxima(_) => false,
    };
    if is_centroid
        && !sums
        && let Some(partition) = Partition::new(terms, range, about, scales)
    {
        return Some(Method::Partition(partition));
    }
    let prepared = prepared_set(output, operators, defuzzifier)?;
    let are_straight = || terms.iter().all(|term| corners(term).is_some());
    Some(match (is_centroid, scales, sums) {
        (true, true, true) => Method::Moments(prepared.moments(about.1)),
        (true, false, false) if are_straight() => match PreparedLayers::new(&prepared, about) {
            Some(layered) => Method::Layered(layered),
            None => Method::Prepared(prepared),
        },
        (_, _, _) => Method::Prepared(prepared),
    })
}
