//! From firing strengths to a number.

use alloc::vec::Vec;

use crate::model::{Aggregation, Defuzzifier, Implication, Operators, Output, Sampling};
use crate::table::operators::{larger, smaller};
use crate::table::{self, Moment, Pair};
use curves::Curves;
use maxima::{Highest, Maxima};
use piece::{Integrals, Piece};
use polyline::{Polylines, Room};
pub(crate) use ramps::Ramps;
use weighted::Consequence;

mod curves;
mod maxima;
mod piece;
pub(crate) mod polyline;
mod ramps;
mod sampled;
pub(crate) mod weighted;

/// How activated consequents come about and join.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Joint {
    pub(crate) implication: Implication,
    pub(crate) aggregation: Aggregation,
}

/// How firing strengths of one consequent come together before anything is integrated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Merging {
    /// `max_r min(h_r, mu) = min(max_r h_r, mu)`, and the same for the product: the largest counts.
    Largest,
    /// `sum_r h_r mu = (sum_r h_r) mu`: the sum counts.
    Sum,
    /// Each rule keeps its own.
    Apart,
}

/// Firing strengths of one output, grouped by term.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Heights<'a> {
    /// The firing strengths.
    pub(crate) heights: &'a [f64],
    /// Those of term k stand at `places[k]..places[k + 1]`.
    pub(crate) places: &'a [usize],
}

impl<'a> Heights<'a> {
    fn of(&self, term: usize) -> &'a [f64] {
        match (self.places.get(term), self.places.get(term + 1)) {
            (Some(&first), Some(&end)) => self.heights.get(first..end).unwrap_or_default(),
            _ => &[],
        }
    }
}

/// The closed form of an output, as a table holds it.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Closed<'a> {
    /// None.
    Open,
    /// The centroid of minimum and maximum over a partition.
    Partition(&'a [Pair]),
    /// The centroid of a sum of products.
    Moments(&'a [Moment]),
    /// Takagi-Sugeno.
    Weighted(table::Set, &'a [Consequence]),
}

/// One output, compiled.
#[derive(Debug, Clone)]
pub(crate) struct Defuzzify {
    low: f64,
    high: f64,
    defuzzifier: Defuzzifier,
    joint: Joint,
    set: Set,
}

#[derive(Debug, Clone)]
enum Set {
    Lines(Polylines),
    /// The centroid of minimum and maximum over a partition.
    Ramps(Ramps),
    Curves(Curves),
    Sampled(Sampling, Curves),
    /// Sum of products: the area and moment of each term at full height.
    Moments(Vec<Moment>),
    Weighted(Vec<Consequence>),
}

impl Merging {
    pub(crate) fn of(defuzzifier: Defuzzifier, operators: Operators) -> Self {
        use Aggregation::{BoundedSum, Maximum, Sum};
        let weighted = defuzzifier.is_weighted();
        match (operators.aggregation, operators.implication) {
            _ if weighted => Merging::Sum,
            (Maximum, _) => Merging::Largest,
            (Sum | BoundedSum, Implication::Product) => Merging::Sum,
            _ => Merging::Apart,
        }
    }
}

impl Defuzzifier {
    /// Whether it takes Takagi-Sugeno consequents rather than fuzzy sets.
    pub(crate) fn is_weighted(self) -> bool {
        matches!(
            self,
            Defuzzifier::WeightedAverage | Defuzzifier::WeightedSum
        )
    }
}

impl Defuzzify {
    /// Compiles an output of fuzzy sets.
    pub(crate) fn fuzzy(output: &Output, operators: Operators) -> Self {
        let variable = &output.variable;
        let (low, high) = (variable.low, variable.high);
        let curves = || Curves::new(&variable.terms, low, high);
        let set = match output.samples {
            Some(sampling) => Set::Sampled(sampling, curves()),
            None => Polylines::new(&variable.terms, low, high)
                .map_or_else(|| Set::Curves(curves()), Set::Lines),
        };
        let mut compiled = Defuzzify {
            low,
            high,
            defuzzifier: output.defuzzifier,
            joint: Joint {
                implication: operators.implication,
                aggregation: operators.aggregation,
            },
            set,
        };
        if output.defuzzifier == Defuzzifier::Centroid && output.samples.is_none() {
            let terms = variable.terms.len();
            let closed = match (&compiled.set, operators.implication, operators.aggregation) {
                (_, Implication::Product, Aggregation::Sum) => {
                    Some(Set::Moments(compiled.moments(terms)))
                }
                (Set::Lines(lines), Implication::Minimum, Aggregation::Maximum) => {
                    Ramps::new(lines, terms, compiled.middle()).map(Set::Ramps)
                }
                _ => None,
            };
            compiled.set = closed.unwrap_or(compiled.set);
        }
        compiled
    }

    /// Compiles a Takagi-Sugeno output.
    pub(crate) fn weighted(output: &Output, operators: Operators, z: Vec<Consequence>) -> Self {
        Defuzzify {
            low: output.variable.low,
            high: output.variable.high,
            defuzzifier: output.defuzzifier,
            joint: Joint {
                implication: operators.implication,
                aggregation: operators.aggregation,
            },
            set: Set::Weighted(z),
        }
    }

    /// Area and moment of each term alone at full height.
    fn moments(&self, terms: usize) -> Vec<Moment> {
        let places: Vec<usize> = (0..=terms).collect();
        let mut room = Room::new(terms, self.cuts());
        let mut moments = Vec::new();
        for term in 0..terms {
            let heights: Vec<f64> = (0..terms).map(|i| f64::from(i == term)).collect();
            let heights = Heights {
                heights: &heights,
                places: &places,
            };
            let mut integrals = self.integrals();
            self.pieces(heights, &mut room, &mut |piece| integrals.add(piece));
            moments.push(Moment {
                area: integrals.area,
                moment: integrals.moment,
            });
        }
        moments
    }

    /// The closed form of the centroid over a partition.
    pub(crate) fn ramps(&self) -> Option<&Ramps> {
        match &self.set {
            Set::Ramps(ramps) => Some(ramps),
            _ => None,
        }
    }

    /// How many heights the output has, and the place of each term's; `None` where they stand as
    /// [`Heights`] says.
    pub(crate) fn ranks(&self) -> Option<(usize, &[usize])> {
        self.ramps().map(|ramps| (ramps.places(), ramps.ranks()))
    }

    /// How many cuts an evaluation can need beside those of its activations.
    pub(crate) fn cuts(&self) -> usize {
        match &self.set {
            Set::Curves(curves) => curves.room(),
            _ => 0,
        }
    }

    /// Whether a term is 0 on the whole range.
    pub(crate) fn is_empty(&self, term: usize) -> bool {
        match &self.set {
            Set::Lines(lines) => lines.is_empty(term),
            Set::Curves(curves) | Set::Sampled(_, curves) => curves.is_empty(term),
            Set::Ramps(ramps) => ramps.is_empty(term),
            Set::Moments(moments) => moments.get(term).is_none_or(|m| m.area <= 0.0),
            Set::Weighted(_) => false,
        }
    }

    /// The closed form, where there is one.
    pub(crate) fn closed(&self) -> Closed<'_> {
        match &self.set {
            Set::Ramps(ramps) => Closed::Partition(ramps.pairs()),
            Set::Moments(moments) => Closed::Moments(moments),
            Set::Weighted(consequences) => {
                let set = match self.defuzzifier {
                    Defuzzifier::WeightedSum => table::Set::WEIGHTED_SUM,
                    _ => table::Set::WEIGHTED_AVERAGE,
                };
                Closed::Weighted(set, consequences)
            }
            Set::Lines(_) | Set::Curves(_) | Set::Sampled(..) => Closed::Open,
        }
    }

    /// The number of an output without a closed form; `None` where no rule fired. A call, which costs nothing beside what it
    /// does, and keeps it out of the way of outputs that have one.
    #[inline(never)]
    pub(crate) fn value(&self, heights: Heights<'_>, room: &mut Room) -> Option<f64> {
        let value = match &self.set {
            Set::Sampled(sampling, curves) => {
                sampling.value(self.defuzzifier, (self.low, self.high), |x| {
                    curves.degree(heights, self.joint, x)
                })
            }
            Set::Lines(_) | Set::Curves(_) => self.exact(heights, room),
            Set::Ramps(_) | Set::Moments(_) | Set::Weighted(_) => None,
        }?;
        Some(larger(self.low, smaller(self.high, value)))
    }

    fn exact(&self, heights: Heights<'_>, room: &mut Room) -> Option<f64> {
        match self.defuzzifier {
            Defuzzifier::SmallestOfMaxima
            | Defuzzifier::MeanOfMaxima
            | Defuzzifier::LargestOfMaxima => {
                let mut highest = Highest::default();
                self.pieces(heights, room, &mut |piece| highest.see(piece));
                let mut maxima = Maxima::of(highest);
                self.pieces(heights, room, &mut |piece| maxima.see(piece));
                maxima.value(self.defuzzifier).filter(|_| highest.0 > 0.0)
            }
            Defuzzifier::Bisector => {
                let mut whole = self.integrals();
                self.pieces(heights, room, &mut |piece| whole.add(piece));
                let half = 0.5 * whole.area;
                let mut sum = 0.0;
                let mut bisector = None;
                self.pieces(heights, room, &mut |piece| {
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
            _ => {
                let mut integrals = self.integrals();
                self.pieces(heights, room, &mut |piece| integrals.add(piece));
                integrals.centroid()
            }
        }
    }

    /// The middle of the range.
    pub(crate) fn middle(&self) -> f64 {
        self.low + 0.5 * (self.high - self.low)
    }

    fn integrals(&self) -> Integrals {
        Integrals::about(self.middle())
    }

    fn pieces(&self, heights: Heights<'_>, room: &mut Room, visit: &mut dyn FnMut(&Piece<'_>)) {
        match &self.set {
            Set::Lines(lines) => lines.pieces(heights, self.joint, room, visit),
            Set::Curves(curves) => curves.pieces(heights, self.joint, room, visit),
            Set::Ramps(_) | Set::Sampled(..) | Set::Moments(_) | Set::Weighted(_) => {}
        }
    }
}
