//! Prepared fuzzy sets: outputs whose terms overlap, are curved, or are defuzzified by another way than the centroid of a
//! partition.
//!
//! What does not depend on the inputs is computed when a model is compiled: the [`Flank`]s of the terms, and for the maximum the
//! [`Section`]s of the range on which no two terms cross. With the maximum and minimum, the order of the terms on a section
//! is the same whatever their firing strengths are; with the product, two terms cross at most once on a section.

use super::flank::{Flank, Knot, Measure};
use super::numeric::root;
use super::operators::{larger, smaller};
use super::{Arrays, ClosedForm, Kind, Output};

/// A defuzzifier of a prepared set.
#[doc(hidden)] // Exported data.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(transparent)]
pub struct SetDefuzzifier(pub u32);

impl SetDefuzzifier {
    /// The centre of gravity.
    pub const CENTROID: SetDefuzzifier = SetDefuzzifier(0);
    /// The value that halves the area.
    pub const BISECTOR: SetDefuzzifier = SetDefuzzifier(1);
    /// The smallest value at which the set is highest.
    pub const SMALLEST_OF_MAXIMA: SetDefuzzifier = SetDefuzzifier(2);
    /// The mean of these values.
    pub const MEAN_OF_MAXIMA: SetDefuzzifier = SetDefuzzifier(3);
    /// The largest of these values.
    pub const LARGEST_OF_MAXIMA: SetDefuzzifier = SetDefuzzifier(4);
}

/// The prepared fuzzy set of an output.
#[doc(hidden)] // Exported data.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct FuzzySet {
    /// The unit of length of areas.
    pub unit: f64,
    /// The defuzzifier.
    pub defuzzifier: SetDefuzzifier,
    /// 1 where the aggregation is the sum, else the maximum.
    pub sum: u32,
    /// Its span of sections; empty for a sum.
    pub first_section: u32,
    /// The end of that span.
    pub end_section: u32,
    /// Its span of terms, one for each firing strength.
    pub first_term: u32,
    /// The end of that span.
    pub end_term: u32,
}

/// The term that a firing strength activates.
#[doc(hidden)] // Exported data.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct SetTerm {
    /// Its highest degree within the range.
    pub highest: f64,
    /// Its span of flanks.
    pub first_flank: u32,
    /// The end of that span.
    pub end_flank: u32,
}

/// A part of the range, with its span of strands.
#[doc(hidden)] // Exported data.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Section {
    /// Where it begins.
    pub from: f64,
    /// Where it ends.
    pub to: f64,
    /// Its span of strands, from the highest to the lowest in the middle of the section.
    pub first_strand: u32,
    /// The end of that span.
    pub end_strand: u32,
}

/// A flank on a section.
#[doc(hidden)] // Exported data.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Strand {
    /// The degree just inside the beginning of the section.
    pub left: f64,
    /// The degree just inside its end.
    pub right: f64,
    /// The area and moment of the flank's tail up to the beginning.
    pub left_tail: [f64; 2],
    /// The area and moment of the flank's tail up to the end.
    pub right_tail: [f64; 2],
    /// The index of its firing strength among those of the output.
    pub strength: u32,
    /// The index of its flank.
    pub flank: u32,
}

/// The arrays of one set.
struct Prepared<'t> {
    set: &'t FuzzySet,
    sections: &'t [Section],
    strands: &'t [Strand],
    terms: &'t [SetTerm],
    flanks: &'t [Flank],
    knots: &'t [Knot],
    measure: Measure,
    /// Whether the implication is the product, else the minimum.
    scales: bool,
}

/// A part of the aggregated set: a flank times `degree`, or a plateau of that degree.
struct Part<'t> {
    from: f64,
    to: f64,
    area: f64,
    moment: f64,
    degree: f64,
    flank: Option<&'t Flank>,
    /// Whether the parts to its left have been seen, and not those to its right.
    from_left: bool,
}

/// The value of a prepared set; `None` where it has no area.
pub(super) fn value<A: Arrays>(table: &A, output: &Output, strengths: &[f64]) -> Option<f64> {
    let set = table.sets().get(output.first as usize)?;
    let prepared = Prepared {
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
        scales: output.form == ClosedForm::SCALED,
    };
    let value = match (set.defuzzifier, set.sum) {
        (SetDefuzzifier::CENTROID, _) => prepared.centroid(strengths),
        (SetDefuzzifier::BISECTOR, 0) => prepared.bisector(strengths),
        (SetDefuzzifier::BISECTOR, _) => prepared.bisector_of_sum(output, strengths),
        _ => prepared.maxima(strengths),
    }?;
    Some(larger(output.low, smaller(output.high, value)))
}

impl<'t> Prepared<'t> {
    fn centroid(&self, strengths: &[f64]) -> Option<f64> {
        let (mut area, mut moment) = (0.0, 0.0);
        if self.set.sum != 0 {
            for (term, &strength) in self.terms.iter().zip(strengths) {
                if strength > 0.0 {
                    for flank in self.flanks_of(term) {
                        let (a, m) = self.alone(flank, strength);
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
        super::centroid(area, moment, self.measure.origin)
    }

    fn flanks_of(&self, term: &SetTerm) -> &'t [Flank] {
        &self.flanks[term.first_flank as usize..term.end_flank as usize]
    }

    /// The area and moment of a flank that is cut or scaled alone.
    fn alone(&self, flank: &Flank, strength: f64) -> (f64, f64) {
        if self.scales {
            (strength * flank.area, strength * flank.moment)
        } else {
            flank.clipped(self.knots, self.measure, strength)
        }
    }

    /// Calls `visit` for each part of the aggregated set on a section.
    #[inline(always)]
    fn parts(&self, section: &Section, strengths: &[f64], visit: impl FnMut(Part<'t>)) {
        let strands = &self.strands[section.first_strand as usize..section.end_strand as usize];
        if self.scales {
            self.scaled(section, strands, strengths, visit);
        } else {
            self.cut(section, strands, strengths, visit);
        }
    }

    /// The maximum of terms cut off at their firing strengths.
    ///
    /// Strands are ordered from the highest to the lowest, so one counts only where it is cut off above all before it. It
    /// then is the set between the level of those and its own. What it leaves open is where it is above its own.
    #[inline(always)]
    fn cut(
        &self,
        section: &Section,
        strands: &'t [Strand],
        strengths: &[f64],
        mut visit: impl FnMut(Part<'t>),
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
            // What remains is open at the lower end of the strand or at the higher one.
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
                    let x = flank.where_degree_is(level);
                    leave(&mut from, &mut to, x, level, Some(level));
                }
            }
            if high <= strength {
                let end = if rises { to } else { from };
                leave(&mut from, &mut to, end, f64::NAN, None);
                return;
            }
            if low < strength {
                let x = flank.where_degree_is(strength);
                leave(&mut from, &mut to, x, strength, None);
            }
            level = strength;
        }
        if from < to && level > 0.0 {
            visit(self.plateau((from, to), level, true));
        }
    }

    /// The maximum of terms scaled by their firing strengths. Two cross at most once.
    #[inline(always)]
    fn scaled(
        &self,
        section: &Section,
        strands: &'t [Strand],
        strengths: &[f64],
        mut visit: impl FnMut(Part<'t>),
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
        // Each strand is the highest once at most.
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
                // It is higher at the end; whether it is so already at the next crossing that is known.
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
                } else if first.kind == Kind::PIECEWISE && second.kind == Kind::PIECEWISE {
                    from + (to - from) * (before / (before - after))
                } else if first.kind == Kind::GAUSSIAN && second.kind == Kind::GAUSSIAN {
                    // The logarithm of the ratio has the same sign, and no exponentials.
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

    fn plateau(&self, (from, to): (f64, f64), degree: f64, from_left: bool) -> Part<'t> {
        let (area, moment) = self.measure.rectangle(from, to, degree);
        Part {
            from,
            to,
            area,
            moment,
            degree,
            flank: None,
            from_left,
        }
    }

    /// A strand between two values of its section; `known` is the degree at one of them.
    fn stretch(
        &self,
        section: &Section,
        strand: &Strand,
        flank: &'t Flank,
        (from, to): (f64, f64),
        known: (f64, f64),
        from_left: bool,
    ) -> Part<'t> {
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
        // The tail of a falling flank shrinks to the right.
        let sign = if flank.right < flank.left { -1.0 } else { 1.0 };
        Part {
            from,
            to,
            area: sign * (right - left),
            moment: sign * (right_moment - left_moment),
            degree: 1.0,
            flank: Some(flank),
            from_left,
        }
    }

    fn bisector(&self, strengths: &[f64]) -> Option<f64> {
        let area_of = |section: &Section| {
            let mut area = 0.0;
            self.parts(section, strengths, |part| area += part.area);
            area
        };
        let mut whole = 0.0;
        for section in self.sections {
            whole += area_of(section);
        }
        if whole <= 0.0 {
            return None;
        }
        let half = 0.5 * whole;
        let mut before = 0.0;
        for section in self.sections {
            let area = area_of(section);
            if before + area < half || area <= 0.0 {
                before += area;
                continue;
            }
            // The areas seen from the left end of the section, and from its right end.
            let (mut left, mut right) = (before, before + area);
            let mut value = None;
            self.parts(section, strengths, |part| {
                let start = if part.from_left {
                    left
                } else {
                    right - part.area
                };
                if value.is_none() && start <= half && half <= start + part.area {
                    value = Some(self.where_area_is(&part, half - start));
                }
                if part.from_left {
                    left += part.area;
                } else {
                    right -= part.area;
                }
            });
            // Between two parts by rounding.
            return value.or(Some(section.to));
        }
        self.sections.last().map(|section| section.to)
    }

    /// Up to where a part has this area.
    fn where_area_is(&self, part: &Part<'_>, area: f64) -> f64 {
        let units = area / part.degree;
        let Some(flank) = part.flank else {
            return smaller(part.to, part.from + units * self.measure.unit);
        };
        if flank.kind == Kind::PIECEWISE {
            // units = left d + slope d^2 / 2, solved for d without cancellation.
            let (left, right) = (flank.degree(part.from), flank.degree(part.to));
            let slope = (right - left) * (self.measure.unit / (part.to - part.from));
            let root = libm::sqrt(larger(0.0, left * left + 2.0 * slope * units));
            let length = 2.0 * units / (left + root) * self.measure.unit;
            return smaller(part.to, part.from + length);
        }
        let tail = |x: f64| flank.tail(self.knots, self.measure, x, flank.degree(x)).0;
        let start = tail(part.from);
        let rest = |x: f64| libm::fabs(tail(x) - start) - units;
        self.newton((part.from, part.to), rest, |x| flank.degree(x))
    }

    /// The root of a rising function, given its derivative in units of length.
    fn newton(
        &self,
        (from, to): (f64, f64),
        f: impl Fn(f64) -> f64,
        derivative: impl Fn(f64) -> f64,
    ) -> f64 {
        let (mut from, mut to) = (from, to);
        let mut x = 0.5 * (from + to);
        for _ in 0..200 {
            let y = f(x);
            if y < 0.0 {
                from = x;
            } else {
                to = x;
            }
            let newton = x - y / derivative(x) * self.measure.unit;
            let inside = from < newton && newton < to;
            let next = if inside { newton } else { 0.5 * (from + to) };
            // Another step would be the square of this one.
            let small = inside && libm::fabs(next - x) <= 1e-9 * self.measure.unit;
            if small || next <= from || next >= to {
                return next;
            }
            x = next;
        }
        x
    }

    /// The bisector of a sum: the terms' areas add up.
    fn bisector_of_sum(&self, output: &Output, strengths: &[f64]) -> Option<f64> {
        let sum = |of: &dyn Fn(&Flank, f64) -> f64| {
            let mut sum = 0.0;
            for (term, &strength) in self.terms.iter().zip(strengths) {
                if strength > 0.0 {
                    for flank in self.flanks_of(term) {
                        sum += of(flank, strength);
                    }
                }
            }
            sum
        };
        let whole = sum(&|flank, strength| self.alone(flank, strength).0);
        if whole <= 0.0 {
            return None;
        }
        let area = |x: f64| sum(&|flank, strength| self.area_up_to(flank, strength, x));
        let degree = |x: f64| {
            sum(&|flank, strength| {
                if x < flank.from || x >= flank.to {
                    0.0
                } else if self.scales {
                    strength * flank.degree(x)
                } else {
                    smaller(strength, flank.degree(x))
                }
            })
        };
        let rest = |x: f64| area(x) - 0.5 * whole;
        Some(self.newton((output.low, output.high), rest, degree))
    }

    /// The area to the left of `x` of a flank that is cut or scaled alone.
    fn area_up_to(&self, flank: &Flank, strength: f64, x: f64) -> f64 {
        if x <= flank.from {
            return 0.0;
        }
        let whole = self.alone(flank, strength).0;
        if x >= flank.to {
            return whole;
        }
        // What lies between the foot and x.
        let degree = flank.degree(x);
        let tail = |x: f64, degree: f64| flank.tail(self.knots, self.measure, x, degree).0;
        let area = if self.scales {
            strength * tail(x, degree)
        } else if degree <= strength {
            tail(x, degree)
        } else {
            let (foot, low) = flank.foot();
            let clip = if low < strength {
                flank.where_degree_is(strength)
            } else {
                foot
            };
            let below = if clip == foot {
                0.0
            } else {
                tail(clip, strength)
            };
            below + strength * libm::fabs(x - clip) / self.measure.unit
        };
        if flank.right < flank.left {
            whole - area
        } else {
            area
        }
    }

    /// The smallest, the mean or the largest value at which the maximum is highest.
    fn maxima(&self, strengths: &[f64]) -> Option<f64> {
        // Where its term has its highest degree, cut or scaled.
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
                let level = if self.scales {
                    term.highest
                } else {
                    smaller(strength, term.highest)
                };
                if larger(strand.left, strand.right) >= level * (1.0 - TIE) {
                    spans.add(section, &self.flanks[strand.flank as usize], level);
                }
            }
            spans.put(section, &mut maxima);
        }
        maxima.value(self.set.defuzzifier)
    }
}

/// Degrees this close to the highest, relative to it, count as the highest: two rules that fire alike may differ by rounding.
const TIE: f64 = 1e-12;

/// Where terms are at their highest on a section: from its beginning to `left`, from `right` to its end, and at its ends.
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

    /// Adds where a flank is at or above a level.
    fn add(&mut self, section: &Section, flank: &Flank, level: f64) {
        let (summit, high) = flank.summit();
        if flank.is_level() {
            self.left = section.to;
        } else if high <= level {
            // Nowhere but at the summit, however many digits of the degree beside it are the same.
            self.at_beginning |= summit == section.from && high >= level * (1.0 - TIE);
            self.at_end |= summit == section.to && high >= level * (1.0 - TIE);
        } else {
            let x = if smaller(flank.left, flank.right) >= level {
                if flank.rises() { flank.from } else { flank.to }
            } else {
                flank.where_degree_is(level)
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

/// The values where a set is highest, from left to right.
#[derive(Debug, Default, Clone, Copy)]
pub(crate) struct Maxima {
    smallest: Option<f64>,
    largest: f64,
    /// The length of all plateaus, and the mean of the values on them.
    length: f64,
    mean_of_plateaus: f64,
    /// The number of single values, and their mean.
    points: f64,
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
            // Sums of lengths times values are no numbers where the range is very wide or narrow.
            let middle = from + 0.5 * width;
            self.mean_of_plateaus += (middle - self.mean_of_plateaus) * (width / self.length);
        }
    }

    /// The value; `None` of a set that is 0 everywhere.
    pub(crate) fn value(self, defuzzifier: SetDefuzzifier) -> Option<f64> {
        let smallest = self.smallest?;
        Some(match defuzzifier {
            SetDefuzzifier::SMALLEST_OF_MAXIMA => smallest,
            SetDefuzzifier::LARGEST_OF_MAXIMA => self.largest,
            _ if self.length > 0.0 => self.mean_of_plateaus,
            _ => self.mean_of_points,
        })
    }
}
