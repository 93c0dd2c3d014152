//! Preparation of the fuzzy set of an output: flanks, their knots, and the sections on which terms do not cross.

use alloc::vec::Vec;

use super::{curves::is_formula, piece::power_of_two};
use crate::model::{MembershipFunction, Term};
use crate::table::flank::Measure;
use crate::table::{
    Flank, FuzzySet, Knot, Moment, Section, SetDefuzzifier, SetTerm, ShapeKind, Strand,
};
use crossings::FlankPair;
pub(super) use stretches::limits;
use stretches::{Stretch, curved, knots};
pub(crate) use stretches::{corners, straight};

mod crossings;
mod stretches;

/// A prepared set. All indices refer to its own arrays.
#[derive(Debug, Clone)]
pub(crate) struct PreparedSet {
    pub(crate) set: FuzzySet,
    /// Whether terms are scaled by their firing strengths; otherwise they are cut.
    pub(crate) scales: bool,
    /// One element per term of the output.
    pub(crate) terms: Vec<SetTerm>,
    pub(crate) sections: Vec<Section>,
    pub(crate) strands: Vec<Strand>,
    pub(crate) flanks: Vec<Flank>,
    pub(crate) knots: Vec<Knot>,
}

// A set with more elements would not fit the cache of the processor; it is integrated in each evaluation instead.
const MAX_STRANDS: usize = 16_384;
const MAX_TERMS: usize = 64;
const MAX_FLANKS: usize = 512;
const MAX_KNOTS: usize = 1024;

impl PreparedSet {
    /// Prepares a set of terms that are scaled by their firing strengths or cut at them, and aggregated by sum or
    /// maximum. `None` if a term is a formula, or the set would be too large.
    pub(crate) fn new(
        terms: &[Term],
        (low, high): (f64, f64),
        (scales, sum): (bool, bool),
        defuzzifier: SetDefuzzifier,
    ) -> Option<Self> {
        if terms.len() > MAX_TERMS || terms.iter().any(is_formula) {
            return None;
        }
        let measure = Measure {
            origin: low + 0.5 * (high - low),
            unit: power_of_two(high - low),
        };
        let mut prepared = PreparedSet {
            set: FuzzySet {
                unit: measure.unit,
                defuzzifier: defuzzifier.code(),
                sum: u32::from(sum),
                first_section: 0,
                end_section: 0,
                first_term: 0,
                end_term: 0,
            },
            scales,
            terms: Vec::new(),
            sections: Vec::new(),
            strands: Vec::new(),
            flanks: Vec::new(),
            knots: Vec::new(),
        };
        for term in terms {
            prepared.term(term, low, high, measure)?;
        }
        if !sum {
            let cuts = prepared.cuts(terms, low, high);
            prepared.sections(&cuts, measure)?;
        }
        Some(prepared)
    }

    /// Returns the area and moment of each term; `unit` is the unit of length.
    pub(crate) fn moments(&self, unit: f64) -> Vec<Moment> {
        let units = self.set.unit / unit;
        let of = |term: &SetTerm| {
            let (mut area, mut moment) = (0.0, 0.0);
            for flank in self.flanks_of(term) {
                area += units * flank.area;
                moment += units * flank.moment;
            }
            Moment { area, moment }
        };
        self.terms.iter().map(of).collect()
    }

    fn flanks_of(&self, term: &SetTerm) -> &[Flank] {
        let span = term.first_flank as usize..term.end_flank as usize;
        self.flanks.get(span).unwrap_or_default()
    }

    /// Adds the flanks of a term.
    fn term(&mut self, term: &Term, low: f64, high: f64, measure: Measure) -> Option<()> {
        let first_flank = self.flanks.len();
        let stretches = match corners(term) {
            Some(corners) => straight(&corners, low, high),
            None => curved(term, low, high),
        };
        for stretch in stretches {
            let flank = self.flank(term, &stretch, measure)?;
            self.flanks.push(flank);
        }
        if self.flanks.len() > MAX_FLANKS {
            return None;
        }
        let flanks = self.flanks.iter().skip(first_flank);
        self.terms.push(SetTerm {
            highest: flanks.fold(0.0, |most: f64, flank| most.max(flank.summit().1)),
            first_flank: first_flank as u32,
            end_flank: self.flanks.len() as u32,
        });
        Some(())
    }

    fn flank(&mut self, term: &Term, stretch: &Stretch, measure: Measure) -> Option<Flank> {
        let (from, to) = (
            stretch.cuts.first().copied()?,
            stretch.cuts.last().copied()?,
        );
        let first_knot = self.knots.len() as u32;
        let mut flank = Flank {
            parameters: [0.0; 4],
            height: term.height,
            from,
            to,
            left: stretch.left,
            right: stretch.right,
            area: 0.0,
            moment: 0.0,
            beyond: 0.0,
            kind: ShapeKind::PIECEWISE,
            first_knot,
            end_knot: first_knot,
        };
        if stretch.is_curved {
            (flank.kind, flank.parameters) = kind(&term.membership_function, flank.rises());
            // Most of the tail of a wider Gaussian is outside the range; the formula for the tail would lose digits.
            if flank.kind == ShapeKind::GAUSSIAN && flank.parameters[1] <= measure.unit {
                let foot = if flank.rises() { from } else { to };
                flank.beyond = flank.beyond_of(foot, measure);
            } else {
                self.knots.extend(knots(&flank, &stretch.cuts, measure)?);
                flank.end_knot = self.knots.len() as u32;
            }
        }
        let (summit, highest) = flank.summit();
        (flank.area, flank.moment) = flank.tail(&self.knots, measure, summit, highest);
        Some(flank)
    }

    /// Returns the limits of sections: the ends of flanks, the crossings of two terms (minimum), and the extrema of the
    /// ratio of two terms (product).
    fn cuts(&self, terms: &[Term], low: f64, high: f64) -> Vec<f64> {
        let mut cuts: Vec<f64> = self.flanks.iter().flat_map(|f| [f.from, f.to]).collect();
        cuts.extend([low, high]);
        let seeds: Vec<Vec<f64>> = terms
            .iter()
            .map(|term| term.membership_function.cuts())
            .collect();
        for (i, one) in self.terms.iter().enumerate() {
            for (j, other) in self.terms.iter().enumerate().skip(i + 1) {
                for a in self.flanks_of(one) {
                    for b in self.flanks_of(other) {
                        let pair = FlankPair::new(a, b);
                        if pair.from < pair.to {
                            pair.cuts([&seeds[i], &seeds[j]], self.scales, &mut cuts);
                        }
                    }
                }
            }
        }
        cuts.sort_by(f64::total_cmp);
        cuts.dedup();
        cuts
    }

    fn sections(&mut self, cuts: &[f64], measure: Measure) -> Option<()> {
        for (&from, &to) in cuts.iter().zip(cuts.iter().skip(1)) {
            let first_strand = self.strands.len();
            let middle = from + 0.5 * (to - from);
            let mut strands = Vec::new();
            for (index, term) in self.terms.iter().enumerate() {
                for flank in term.first_flank..term.end_flank {
                    let of = self.flanks.get(flank as usize)?;
                    if of.from > from || to > of.to {
                        continue;
                    }
                    let at = |x: f64| {
                        let degree = degree(of, x);
                        let (area, moment) = of.tail(&self.knots, measure, x, degree);
                        (degree, [area, moment])
                    };
                    let ((left, left_tail), (right, right_tail)) = (at(from), at(to));
                    if left > 0.0 || right > 0.0 {
                        strands.push((
                            of.degree(middle),
                            Strand {
                                left,
                                right,
                                left_tail,
                                right_tail,
                                strength: index as u32,
                                flank,
                            },
                        ));
                    }
                }
            }
            strands.sort_by(|a, b| b.0.total_cmp(&a.0));
            self.strands.extend(strands.iter().map(|strand| strand.1));
            if self.strands.len() > MAX_STRANDS {
                return None;
            }
            if self.strands.len() > first_strand {
                self.sections.push(Section {
                    from,
                    to,
                    first_strand: first_strand as u32,
                    end_strand: self.strands.len() as u32,
                });
            }
        }
        self.set.end_section = self.sections.len() as u32;
        Some(())
    }
}

/// Returns the degree of a flank; at its ends, the degree just inside it.
fn degree(flank: &Flank, x: f64) -> f64 {
    if x == flank.from {
        flank.left
    } else if x == flank.to {
        flank.right
    } else {
        flank.degree(x)
    }
}

/// Returns the formula of a flank. For a two-sided Gaussian whose sides are separate, this is the formula of the side
/// to which the flank belongs.
fn kind(shape: &MembershipFunction, rises: bool) -> (ShapeKind, [f64; 4]) {
    match (shape.kind(), rises) {
        ((ShapeKind::GAUSSIAN2, [mean, sd, right, _]), true) if mean <= right => {
            (ShapeKind::GAUSSIAN, [mean, sd, 0.0, 0.0])
        }
        ((ShapeKind::GAUSSIAN2, [left, _, mean, sd]), false) if left <= mean => {
            (ShapeKind::GAUSSIAN, [mean, sd, 0.0, 0.0])
        }
        (other, _) => other,
    }
}
