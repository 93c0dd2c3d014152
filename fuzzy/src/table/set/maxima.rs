//! The values at which a prepared set is highest.

use super::{OfMaxima, Section, SetArrays, SetTerm};
use crate::table::Flank;
use crate::table::operators::{larger, smaller};

impl SetArrays<'_> {
    /// Returns the smallest, the mean or the largest value at which the aggregated maximum is highest.
    pub(super) fn maxima(&self, which: OfMaxima, strengths: &[f64]) -> Option<f64> {
        // The degree that the term must reach, before cutting or scaling, for a value to count as highest. A
        // strength that equals the maximum degree of the term up to rounding does not cut the term.
        let level = |term: &SetTerm, strength: f64| {
            if self.scales || strength >= term.highest * (1.0 - TIE) {
                term.highest
            } else {
                strength
            }
        };
        // The maximum degree of the term after cutting or scaling.
        let top = |term: &SetTerm, strength: f64| {
            if self.scales {
                strength * term.highest
            } else {
                smaller(strength, term.highest)
            }
        };
        let terms = || self.terms.iter().zip(strengths);
        let highest = terms().fold(0.0, |most, (term, &h)| larger(most, top(term, h)));
        if highest <= 0.0 {
            return None;
        }
        let mut maxima = Maxima::default();
        for section in self.sections {
            let mut spans = Spans::none_of(section);
            let strands = section.first_strand as usize..section.end_strand as usize;
            for strand in &self.strands[strands] {
                let index = strand.strength as usize;
                let (term, strength) = (&self.terms[index], strengths[index]);
                if top(term, strength) < highest * (1.0 - TIE) {
                    continue;
                }
                let level = level(term, strength);
                if larger(strand.left, strand.right) >= level * (1.0 - TIE) {
                    spans.add(section, &self.flanks[strand.flank as usize], level);
                }
            }
            spans.put(section, &mut maxima);
        }
        maxima.value(which)
    }
}

/// The relative difference from the maximum up to which degrees count as equal: the degrees of two rules that fire
/// equally may differ by rounding.
const TIE: f64 = 1e-12;

/// The values of a section at which terms are highest: from its lower end to `left`, from `right` to its upper end, and
/// the ends themselves if they are flagged.
struct Spans {
    left: f64,
    right: f64,
    at_beginning: bool,
    at_end: bool,
}

impl Spans {
    fn none_of(section: &Section) -> Self {
        Spans {
            left: section.from,
            right: section.to,
            at_beginning: false,
            at_end: false,
        }
    }

    /// Adds the values at which a flank is at or above a level.
    fn add(&mut self, section: &Section, flank: &Flank, level: f64) {
        let (summit, high) = flank.summit();
        if flank.is_level() {
            self.left = section.to;
        } else if high <= level {
            // Only the summit counts, even if the degrees of neighbouring values round to the same number.
            self.at_beginning |= summit == section.from && high >= level * (1.0 - TIE);
            self.at_end |= summit == section.to && high >= level * (1.0 - TIE);
        } else {
            let x = if smaller(flank.left, flank.right) >= level {
                if flank.rises() { flank.from } else { flank.to }
            } else {
                flank.position_of_degree(level)
            };
            if flank.rises() {
                self.right = larger(section.from, smaller(self.right, x));
            } else {
                self.left = smaller(section.to, larger(self.left, x));
            }
        }
    }

    fn put(&self, section: &Section, maxima: &mut Maxima) {
        if self.at_beginning {
            maxima.point(section.from);
        }
        if self.left >= self.right {
            maxima.plateau(section.from, section.to);
        } else {
            if self.left > section.from {
                maxima.plateau(section.from, self.left);
            }
            if self.right < section.to {
                maxima.plateau(self.right, section.to);
            }
        }
        if self.at_end {
            maxima.point(section.to);
        }
    }
}

/// The values at which a set is highest, added from left to right.
#[derive(Debug, Default, Clone, Copy)]
pub(crate) struct Maxima {
    smallest: Option<f64>,
    largest: f64,
    /// The total length of all plateaus.
    length: f64,
    /// The mean of the values on plateaus.
    mean_of_plateaus: f64,
    /// The number of single points.
    points: f64,
    /// The mean of the single points.
    mean_of_points: f64,
}

impl Maxima {
    pub(crate) fn point(&mut self, x: f64) {
        if self.smallest.is_some() && x == self.largest {
            return;
        }
        self.smallest = self.smallest.or(Some(x));
        self.largest = x;
        self.points += 1.0;
        self.mean_of_points += (x - self.mean_of_points) / self.points;
    }

    pub(crate) fn plateau(&mut self, from: f64, to: f64) {
        let width = to - from;
        if width > 0.0 {
            self.smallest = self.smallest.or(Some(from));
            self.largest = to;
            self.length += width;
            // Sums of lengths times values would overflow or underflow for extreme ranges.
            let middle = from + 0.5 * width;
            self.mean_of_plateaus += (middle - self.mean_of_plateaus) * (width / self.length);
        }
    }

    /// Returns the selected value; `None` for a set that is 0 everywhere.
    pub(crate) fn value(self, which: OfMaxima) -> Option<f64> {
        let smallest = self.smallest?;
        Some(match which {
            OfMaxima::Smallest => smallest,
            OfMaxima::Largest => self.largest,
            OfMaxima::Mean if self.length > 0.0 => self.mean_of_plateaus,
            OfMaxima::Mean => self.mean_of_points,
        })
    }
}
