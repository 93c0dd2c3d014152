//! Prepared fuzzy sets: outputs whose terms overlap or are curved, or whose defuzzifier is not the centroid of a
//! partition.
//!
//! Everything that does not depend on the inputs is computed when a model is compiled: the [`Flank`]s of the terms
//! and, for aggregation by maximum, the [`Section`]s of the range in which no two terms cross. If the implication
//! is the minimum, the order of the terms on a section does not depend on their firing strengths; if it is the
//! product, two terms cross at most once on a section.

use super::flank::{Flank, Knot, Measure};
use super::numeric::root;
use super::operators::{larger, smaller};
use super::{Arrays, ClosedForm, Output, ShapeKind};
pub(crate) use maxima::Maxima;

pub(super) mod between;
mod bisector;
mod maxima;

/// The defuzzifier of a fuzzy set.
#[doc(hidden)] // The codes of exported data.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SetDefuzzifier {
    /// The centre of gravity.
    Centroid,
    /// The value that halves the area.
    Bisector,
    /// A value among those at which the set is highest.
    Maxima(OfMaxima),
}

/// The selection among the values at which a set is highest.
#[doc(hidden)] // The codes of exported data.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OfMaxima {
    /// The smallest one.
    Smallest,
    /// The mean of these values.
    Mean,
    /// The largest one.
    Largest,
}

impl SetDefuzzifier {
    /// All defuzzifiers, in the order of their codes in exported data.
    pub const ALL: [SetDefuzzifier; 5] = [
        SetDefuzzifier::Centroid,
        SetDefuzzifier::Bisector,
        SetDefuzzifier::Maxima(OfMaxima::Smallest),
        SetDefuzzifier::Maxima(OfMaxima::Mean),
        SetDefuzzifier::Maxima(OfMaxima::Largest),
    ];

    /// Returns the code in exported data.
    #[cfg(feature = "alloc")]
    pub(crate) fn code(self) -> u32 {
        let index = Self::ALL.iter().position(|other| *other == self);
        index.unwrap_or(Self::ALL.len()) as u32
    }
}

/// The prepared fuzzy set of an output.
#[doc(hidden)] // Exported data.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct FuzzySet {
    /// The unit of length of areas.
    pub unit: f64,
    /// The defuzzifier, as an index in [`SetDefuzzifier::ALL`].
    pub defuzzifier: u32,
    /// 1 if the aggregation is the sum, 0 if it is the maximum.
    pub sum: u32,
    /// The index of the first section; the range is empty for a sum.
    pub first_section: u32,
    /// The index after the last section.
    pub end_section: u32,
    /// The index of the first term; there is one per firing strength.
    pub first_term: u32,
    /// The index after the last term.
    pub end_term: u32,
}

/// The term that a firing strength activates.
#[doc(hidden)] // Exported data.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct SetTerm {
    /// The maximum degree within the range.
    pub highest: f64,
    /// The index of the first flank.
    pub first_flank: u32,
    /// The index after the last flank.
    pub end_flank: u32,
}

/// A part of the range, with its strands.
#[doc(hidden)] // Exported data.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Section {
    /// The lower end.
    pub from: f64,
    /// The upper end.
    pub to: f64,
    /// The index of the first strand; strands are ordered from the highest to the lowest in the middle of the section.
    pub first_strand: u32,
    /// The index after the last strand.
    pub end_strand: u32,
}

/// A flank on a section.
#[doc(hidden)] // Exported data.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Strand {
    /// The degree just inside the lower end of the section.
    pub left: f64,
    /// The degree just inside the upper end.
    pub right: f64,
    /// The area and moment of the flank's tail up to the lower end of the section.
    pub left_tail: [f64; 2],
    /// The area and moment of the flank's tail up to the upper end of the section.
    pub right_tail: [f64; 2],
    /// The index of the term's firing strength among those of the output.
    pub strength: u32,
    /// The index of the flank.
    pub flank: u32,
}

/// The arrays of one set.
struct SetArrays<'t> {
    set: &'t FuzzySet,
    sections: &'t [Section],
    strands: &'t [Strand],
    terms: &'t [SetTerm],
    flanks: &'t [Flank],
    knots: &'t [Knot],
    measure: Measure,
    /// Whether the implication is the product; otherwise it is the minimum.
    scales: bool,
}

/// A part of the aggregated set: a flank scaled by `degree`, or a plateau of that degree.
struct SetSegment<'t> {
    from: f64,
    to: f64,
    area: f64,
    moment: f64,
    degree: f64,
    flank: Option<&'t Flank>,
    /// Whether the parts to the left have already been visited, rather than those to the right.
    from_left: bool,
}

/// Returns the area and the moment of a prepared set, in the unit of length of the other closed forms. For ranges that
/// are not extreme, this unit is 1.
pub(super) fn integrals<A: Arrays>(
    table: &A,
    output: &Output,
    strengths: &[f64],
) -> Option<(f64, f64)> {
    let prepared = SetArrays::of(table, output)?;
    let (area, moment) = prepared.integrals(strengths);
    let unit = match (1e-100..1e100).contains(&(output.high - output.low)) {
        true => prepared.measure.unit,
        false => 1.0,
    };
    Some((unit * area, unit * moment))
}

/// Returns the value of a prepared set; `None` if its area is 0.
pub(super) fn value<A: Arrays>(table: &A, output: &Output, strengths: &[f64]) -> Option<f64> {
    let prepared = SetArrays::of(table, output)?;
    let set = prepared.set;
    let value = match *SetDefuzzifier::ALL.get(set.defuzzifier as usize)? {
        SetDefuzzifier::Centroid => {
            let (area, moment) = prepared.integrals(strengths);
            super::centroid(area, moment, prepared.measure.origin)
        }
        SetDefuzzifier::Bisector if set.sum == 0 => prepared.bisector(strengths),
        SetDefuzzifier::Bisector => prepared.bisector_of_sum(output, strengths),
        SetDefuzzifier::Maxima(which) => prepared.maxima(which, strengths),
    }?;
    Some(larger(output.low, smaller(output.high, value)))
}

impl<'t> SetArrays<'t> {
    fn of<A: Arrays>(table: &'t A, output: &Output) -> Option<Self> {
        let set = table.sets().get(output.first as usize)?;
        Some(SetArrays {
            set,
            sections: &table.sections()[set.first_section as usize..set.end_section as usize],
            strands: table.strands(),
            terms: &table.set_terms()[set.first_term as usize..set.end_term as usize],
            flanks: table.flanks(),
            knots: table.knots(),
            measure: Measure {
                origin: output.origin(),
                unit: set.unit,
            },
            scales: output.form() == ClosedForm::Scaled,
        })
    }

    /// Returns the area and the moment about the origin.
    fn integrals(&self, strengths: &[f64]) -> (f64, f64) {
        let (mut area, mut moment) = (0.0, 0.0);
        if self.set.sum != 0 {
            for (term, &strength) in self.terms.iter().zip(strengths) {
                if strength > 0.0 {
                    for flank in self.flanks_of(term) {
                        let (a, m) = self.of_single_flank(flank, strength);
                        area += a;
                        moment += m;
                    }
                }
            }
        } else {
            for section in self.sections {
                self.parts(section, strengths, |part| {
                    area += part.area;
                    moment += part.moment;
                });
            }
        }
        (area, moment)
    }

    fn flanks_of(&self, term: &SetTerm) -> &'t [Flank] {
        &self.flanks[term.first_flank as usize..term.end_flank as usize]
    }

    /// Returns the area and moment of a flank that is cut or scaled, as if it were the only one.
    fn of_single_flank(&self, flank: &Flank, strength: f64) -> (f64, f64) {
        if self.scales {
            (strength * flank.area, strength * flank.moment)
        } else {
            flank.clipped(self.knots, self.measure, strength)
        }
    }

    /// Calls `visit` for each part of the aggregated set on a section.
    #[inline(always)]
    fn parts(&self, section: &Section, strengths: &[f64], visit: impl FnMut(SetSegment<'t>)) {
        let strands = &self.strands[section.first_strand as usize..section.end_strand as usize];
        if self.scales {
            self.scaled(section, strands, strengths, visit);
        } else {
            self.cut(section, strands, strengths, visit);
        }
    }

    /// Visits the parts of the maximum of terms that are cut off at their firing strengths.
    ///
    /// Strands are ordered from the highest to the lowest, so a strand contributes only if it is cut off at a higher
    /// level than all strands before it. The set follows the strand where its degree is between the previous level and
    /// its own level. Where its degree is lower, the set is a plateau at the previous level. Where its degree is
    /// higher, the following strands determine the set.
    #[inline(always)]
    fn cut(
        &self,
        section: &Section,
        strands: &'t [Strand],
        strengths: &[f64],
        mut visit: impl FnMut(SetSegment<'t>),
    ) {
        let (mut from, mut to, mut level) = (section.from, section.to, 0.0);
        for strand in strands {
            let strength = strengths[strand.strength as usize];
            if strength <= level {
                continue;
            }
            let flank = &self.flanks[strand.flank as usize];
            let rises = strand.left < strand.right;
            let (low, high) = if rises {
                (strand.left, strand.right)
            } else {
                (strand.right, strand.left)
            };
            // Visits the side on which the strand is low, up to `clip`. The remaining part is on the other side: at the
            // upper end if the strand rises, at the lower end if it falls.
            let mut leave = |from: &mut f64, to: &mut f64, clip: f64, degree, part: Option<f64>| {
                let x = larger(*from, smaller(*to, clip));
                let degree = if x == clip { degree } else { f64::NAN };
                let span = if rises { (*from, x) } else { (x, *to) };
                if span.0 < span.1 {
                    visit(match part {
                        Some(level) => self.plateau(span, level, rises),
                        None => self.stretch(section, strand, flank, span, (x, degree), rises),
                    });
                }
                *(if rises { from } else { to }) = x;
            };
            if level > 0.0 {
                if high <= level {
                    break;
                }
                if low < level {
                    let x = flank.position_of_degree(level);
                    leave(&mut from, &mut to, x, level, Some(level));
                }
            }
            if high <= strength {
                let end = if rises { to } else { from };
                leave(&mut from, &mut to, end, f64::NAN, None);
                return;
            }
            if low < strength {
                let x = flank.position_of_degree(strength);
                leave(&mut from, &mut to, x, strength, None);
            }
            level = strength;
        }
        if from < to && level > 0.0 {
            visit(self.plateau((from, to), level, true));
        }
    }

    /// Visits the parts of the maximum of terms that are scaled by their firing strengths. Two terms cross at most
    /// once.
    #[inline(always)]
    fn scaled(
        &self,
        section: &Section,
        strands: &'t [Strand],
        strengths: &[f64],
        mut visit: impl FnMut(SetSegment<'t>),
    ) {
        let scale = |strand: &Strand| strengths[strand.strength as usize];
        let ends = |strand: &Strand| (scale(strand) * strand.left, scale(strand) * strand.right);
        let mut top: Option<&Strand> = None;
        for strand in strands {
            if scale(strand) > 0.0 && top.is_none_or(|top| ends(strand) > ends(top)) {
                top = Some(strand);
            }
        }
        let Some(mut top) = top else {
            return;
        };
        let mut from = section.from;
        // Each strand is the highest at most once.
        for _ in strands {
            let mut next: Option<(f64, &Strand)> = None;
            for strand in strands {
                let higher = ends(strand).1 - ends(top).1;
                if scale(strand) <= 0.0 || higher <= 0.0 {
                    continue;
                }
                let to = next.map_or(section.to, |next| next.0);
                let (first, second) = (self.flank(strand), self.flank(top));
                let difference =
                    |x: f64| scale(strand) * first.degree(x) - scale(top) * second.degree(x);
                // The strand is higher than `top` at the end of the section. Check whether it is already higher at the
                // nearest known crossing.
                let after = if to < section.to {
                    difference(to)
                } else {
                    higher
                };
                if after <= 0.0 {
                    continue;
                }
                let before = if from > section.from {
                    difference(from)
                } else {
                    ends(strand).0 - ends(top).0
                };
                let x = if before >= 0.0 {
                    from
                } else if first.kind == ShapeKind::PIECEWISE && second.kind == ShapeKind::PIECEWISE
                {
                    from + (to - from) * (before / (before - after))
                } else if first.kind == ShapeKind::GAUSSIAN && second.kind == ShapeKind::GAUSSIAN {
                    // The logarithm of the ratio of the degrees has the same sign as their difference, and needs no
                    // exponentials.
                    let ratio =
                        libm::log((scale(strand) * first.height) / (scale(top) * second.height));
                    root(from, to, |x| ratio + second.exponent(x) - first.exponent(x))
                } else {
                    root(from, to, difference)
                };
                next = Some((x, strand));
            }
            let to = next.map_or(section.to, |next| next.0);
            if from < to {
                let flank = self.flank(top);
                let span = (from, to);
                let mut part = self.stretch(section, top, flank, span, (f64::NAN, f64::NAN), true);
                part.degree = scale(top);
                part.area *= part.degree;
                part.moment *= part.degree;
                visit(part);
            }
            let Some((x, strand)) = next else {
                return;
            };
            (from, top) = (x, strand);
        }
    }

    fn flank(&self, strand: &Strand) -> &'t Flank {
        &self.flanks[strand.flank as usize]
    }

    fn plateau(&self, (from, to): (f64, f64), degree: f64, from_left: bool) -> SetSegment<'t> {
        let (area, moment) = self.measure.rectangle(from, to, degree);
        SetSegment {
            from,
            to,
            area,
            moment,
            degree,
            flank: None,
            from_left,
        }
    }

    /// Returns the part of a strand between two values of its section; `known` is the degree at one of them.
    fn stretch(
        &self,
        section: &Section,
        strand: &Strand,
        flank: &'t Flank,
        (from, to): (f64, f64),
        known: (f64, f64),
        from_left: bool,
    ) -> SetSegment<'t> {
        let tail = |x: f64| {
            if x == section.from {
                return strand.left_tail;
            }
            if x == section.to {
                return strand.right_tail;
            }
            let degree = if x == known.0 && known.1 > 0.0 {
                known.1
            } else {
                flank.degree(x)
            };
            flank.tail(self.knots, self.measure, x, degree).into()
        };
        let ([left, left_moment], [right, right_moment]) = (tail(from), tail(to));
        // The tail of a falling flank becomes smaller to the right.
        let sign = if flank.right < flank.left { -1.0 } else { 1.0 };
        SetSegment {
            from,
            to,
            area: sign * (right - left),
            moment: sign * (right_moment - left_moment),
            degree: 1.0,
            flank: Some(flank),
            from_left,
        }
    }
}
