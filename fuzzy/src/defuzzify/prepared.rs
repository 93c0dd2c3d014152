//! Preparing the fuzzy set of an output: flanks, their knots, and the sections on which terms do not cross.

use alloc::{vec, vec::Vec};

use super::maxima::turns;
use super::polyline::limits;
use super::{Joint, piece::power_of_two};
use crate::model::{Aggregation, Defuzzifier, Implication, MembershipFunction, Term};
use crate::table::flank::Measure;
use crate::table::numeric::{gauss, root};
use crate::table::{Flank, FuzzySet, Kind, Knot, Moment, Section, SetDefuzzifier, SetTerm, Strand};

/// A prepared set. Indices are into its own arrays.
#[derive(Debug, Clone)]
pub(crate) struct Prepared {
    pub(crate) set: FuzzySet,
    /// One for each term of the output.
    pub(crate) terms: Vec<SetTerm>,
    pub(crate) sections: Vec<Section>,
    pub(crate) strands: Vec<Strand>,
    pub(crate) flanks: Vec<Flank>,
    pub(crate) knots: Vec<Knot>,
}

/// More make a set too large for a processor's cache; it is then integrated for each evaluation.
const MOST_STRANDS: usize = 16_384;
const MOST_TERMS: usize = 64;
const MOST_FLANKS: usize = 512;
const MOST_KNOTS: usize = 1024;

impl Prepared {
    /// `None` where the operators and the defuzzifier have no such form, or it would be too large.
    pub(crate) fn new(
        terms: &[Term],
        (low, high): (f64, f64),
        joint: Joint,
        defuzzifier: Defuzzifier,
    ) -> Option<Self> {
        use SetDefuzzifier as To;
        let sum = match joint.aggregation {
            Aggregation::Maximum => false,
            Aggregation::Sum => true,
            _ => return None,
        };
        let defuzzifier = match defuzzifier {
            Defuzzifier::Centroid => To::CENTROID,
            Defuzzifier::Bisector => To::BISECTOR,
            Defuzzifier::SmallestOfMaxima if !sum => To::SMALLEST_OF_MAXIMA,
            Defuzzifier::MeanOfMaxima if !sum => To::MEAN_OF_MAXIMA,
            Defuzzifier::LargestOfMaxima if !sum => To::LARGEST_OF_MAXIMA,
            _ => return None,
        };
        let has_form = matches!(
            joint.implication,
            Implication::Minimum | Implication::Product
        );
        let is_formula = |term: &Term| {
            matches!(
                term.membership_function,
                MembershipFunction::Function { .. }
            )
        };
        if !has_form || terms.len() > MOST_TERMS || terms.iter().any(is_formula) {
            return None;
        }
        let measure = Measure {
            origin: low + 0.5 * (high - low),
            unit: power_of_two(high - low),
        };
        let mut prepared = Prepared {
            set: FuzzySet {
                unit: measure.unit,
                defuzzifier,
                sum: u32::from(sum),
                first_section: 0,
                end_section: 0,
                first_term: 0,
                end_term: 0,
            },
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
            let cuts = prepared.cuts(terms, low, high, joint.implication);
            prepared.sections(&cuts, measure)?;
        }
        Some(prepared)
    }

    /// The area and moment of each term, in this unit of length.
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

    /// Whether a term is 0 all over the range.
    pub(crate) fn is_empty(&self, term: usize) -> bool {
        self.terms.get(term).is_none_or(|term| term.highest <= 0.0)
    }

    fn flanks_of(&self, term: &SetTerm) -> &[Flank] {
        let span = term.first_flank as usize..term.end_flank as usize;
        self.flanks.get(span).unwrap_or_default()
    }

    /// Adds the flanks of a term.
    fn term(&mut self, term: &Term, low: f64, high: f64, measure: Measure) -> Option<()> {
        let first_flank = self.flanks.len();
        let stretches = match term.membership_function.corners() {
            Some(corners) => straight(corners, term.height, low, high),
            None => curved(term, low, high),
        };
        for stretch in stretches {
            let flank = self.flank(term, &stretch, measure)?;
            self.flanks.push(flank);
        }
        if self.flanks.len() > MOST_FLANKS {
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
            kind: Kind::PIECEWISE,
            first_knot,
            end_knot: first_knot,
        };
        if stretch.is_curved {
            (flank.kind, flank.parameters) = kind(&term.membership_function, flank.rises());
            // The tail of a wider gaussian lies mostly outside the range, where its digits would be lost.
            if flank.kind == Kind::GAUSSIAN && flank.parameters[1] <= measure.unit {
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

    /// Where sections end: at the ends of flanks, where two terms cross (minimum), and where the ratio of two turns (product).
    fn cuts(&self, terms: &[Term], low: f64, high: f64, implication: Implication) -> Vec<f64> {
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
                        let pair = Couple::new(a, b);
                        if pair.from < pair.to {
                            pair.cuts([&seeds[i], &seeds[j]], implication, &mut cuts);
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
            if self.strands.len() > MOST_STRANDS {
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

/// The degree of a flank, at its ends just inside it.
fn degree(flank: &Flank, x: f64) -> f64 {
    if x == flank.from {
        flank.left
    } else if x == flank.to {
        flank.right
    } else {
        flank.degree(x)
    }
}

/// The formula of a flank; two-sided shapes are those of one side.
fn kind(shape: &MembershipFunction, rises: bool) -> (Kind, [f64; 4]) {
    match (shape.kind(), rises) {
        ((Kind::GAUSSIAN2, [mean, sd, right, _]), true) if mean <= right => {
            (Kind::GAUSSIAN, [mean, sd, 0.0, 0.0])
        }
        ((Kind::GAUSSIAN2, [left, _, mean, sd]), false) if left <= mean => {
            (Kind::GAUSSIAN, [mean, sd, 0.0, 0.0])
        }
        (other, _) => other,
    }
}

/// A part of a term that only rises, only falls or is level.
struct Stretch {
    /// Its ends, and the cuts between.
    cuts: Vec<f64>,
    left: f64,
    right: f64,
    is_curved: bool,
}

fn straight(mut corners: Vec<(f64, f64)>, height: f64, low: f64, high: f64) -> Vec<Stretch> {
    for corner in &mut corners {
        corner.1 *= height;
    }
    let mut cuts: Vec<f64> = corners.iter().map(|corner| corner.0).collect();
    cuts.retain(|x| low < *x && *x < high);
    cuts.insert(0, low);
    cuts.push(high);
    cuts.dedup();
    let ends = cuts.iter().zip(cuts.iter().skip(1));
    let stretches = ends.map(|(&from, &to)| {
        let (left, right) = limits(&corners, from, to);
        Stretch {
            cuts: vec![from, to],
            left,
            right,
            is_curved: false,
        }
    });
    stretches
        .filter(|s| s.left > 0.0 || s.right > 0.0)
        .collect()
}

/// A curve whose degrees differ by less over a stretch is level there.
const LEVEL: f64 = 4e-16;

fn curved(term: &Term, low: f64, high: f64) -> Vec<Stretch> {
    let f = |x: f64| term.membership(x);
    let mut cuts = term.membership_function.cuts();
    cuts.retain(|x| low < *x && *x < high);
    cuts.extend([low, high]);
    cuts.sort_by(f64::total_cmp);
    cuts.dedup();
    // These may turn anywhere.
    if let Kind::SIGMOID_DIFFERENCE | Kind::SIGMOID_PRODUCT | Kind::GAUSSIAN2 =
        term.membership_function.kind().0
    {
        let mut turning = Vec::new();
        for (&from, &to) in cuts.iter().zip(cuts.iter().skip(1)) {
            let width = to - from;
            let mut found = |part: f64| turning.push(from + width * part);
            turns(&|part| f(from + width * part), 0.0, &mut found);
            turns(
                &|part| -f(from + width * part),
                f64::NEG_INFINITY,
                &mut found,
            );
        }
        cuts.extend(turning);
        cuts.sort_by(f64::total_cmp);
        cuts.dedup();
    }
    // Just inside, past a step at the cut.
    let inside = |x: f64, next: f64| {
        let (here, there) = (f(x), f(next));
        if libm::fabs(here - there) > 1e-9 {
            there
        } else {
            here
        }
    };
    let mut stretches: Vec<Stretch> = Vec::new();
    for (&from, &to) in cuts.iter().zip(cuts.iter().skip(1)) {
        let (left, right) = (inside(from, from.next_up()), inside(to, to.next_down()));
        let middle = f(from + 0.5 * (to - from));
        let near = |a: f64, b: f64| libm::fabs(a - b) <= LEVEL * a.max(b);
        let is_level = near(left, right) && near(left, middle);
        if is_level && middle <= 0.0 {
            continue;
        }
        if let Some(last) = stretches.last_mut()
            && last.cuts.last() == Some(&from)
            && last.right == left
            && if is_level {
                !last.is_curved && last.left == middle
            } else {
                last.is_curved && (last.left < last.right) == (left < right)
            }
        {
            last.cuts.push(to);
            last.right = right;
            continue;
        }
        stretches.push(Stretch {
            cuts: vec![from, to],
            left: if is_level { middle } else { left },
            right: if is_level { middle } else { right },
            is_curved: !is_level,
        });
    }
    stretches
}

/// The knots of a curved flank, so close to each other that Gauss-Legendre is exact between them.
fn knots(flank: &Flank, cuts: &[f64], measure: Measure) -> Option<Vec<Knot>> {
    let mut cuts = cuts.to_vec();
    if flank.right < flank.left {
        cuts.reverse();
    }
    let integral = |a: f64, b: f64| {
        let (area, moment) = gauss(|x| flank.degree(x), a.min(b), a.max(b), measure.origin);
        (area / measure.unit, moment / measure.unit)
    };
    let narrowest = (flank.to - flank.from) * libm::exp2(-44.0);
    let foot = Knot {
        x: cuts.first().copied()?,
        ..Knot::default()
    };
    let mut knots = vec![foot];
    let mut sum = foot;
    // The next stretch from the foot is the last one.
    let mut open: Vec<(f64, f64)> = cuts
        .iter()
        .zip(cuts.iter().skip(1))
        .map(|(a, b)| (*a, *b))
        .collect();
    open.reverse();
    while let Some((a, b)) = open.pop() {
        // Not in the middle: a symmetric kink there would go unseen.
        let middle = a + 0.43 * (b - a);
        let (whole, left, right) = (integral(a, b), integral(a, middle), integral(middle, b));
        let halves = left.0 + right.0;
        let error = libm::fabs(halves - whole.0);
        let known = sum.area + halves + 1e-290;
        let mut add = |x: f64, (area, moment): (f64, f64)| {
            sum = Knot {
                x,
                area: sum.area + area,
                moment: sum.moment + moment,
            };
            knots.push(sum);
        };
        if error <= 4e-15 * known || libm::fabs(b - a) <= narrowest {
            add(b, whole);
        } else if error <= 1e-11 * known {
            // The parts are exact to 0.57^16 of that.
            add(middle, left);
            add(b, right);
        } else {
            open.extend([(middle, b), (a, middle)]);
        }
        if knots.len() > MOST_KNOTS {
            return None;
        }
    }
    Some(fewer(knots, |a, b| integral(a, b).0))
}

/// Leaves out knots that are not needed.
fn fewer(knots: Vec<Knot>, area: impl Fn(f64, f64) -> f64) -> Vec<Knot> {
    let mut kept: Vec<Knot> = Vec::new();
    let mut last: Option<Knot> = None;
    for knot in knots {
        match (kept.last(), last) {
            (Some(from), Some(last)) => {
                // The tail is asked for anywhere up to the knot, and a symmetric kink cancels at the knot itself.
                let agree = [0.37, 0.71, 1.0].into_iter().all(|part| {
                    let x = last.x + part * (knot.x - last.x);
                    let known = last.area - from.area + area(last.x, x);
                    libm::fabs(area(from.x, x) - known) <= 4e-15 * (last.area + known)
                });
                if !agree {
                    kept.push(last);
                }
            }
            _ => kept.push(knot),
        }
        last = Some(knot);
    }
    kept.extend(last);
    kept
}

/// Two flanks where both are.
struct Couple<'f> {
    a: &'f Flank,
    b: &'f Flank,
    from: f64,
    to: f64,
}

/// Points at which two flanks that run in the same direction are compared, besides their cuts.
const COMPARED: usize = 24;

impl<'f> Couple<'f> {
    fn new(a: &'f Flank, b: &'f Flank) -> Self {
        Couple {
            a,
            b,
            from: a.from.max(b.from),
            to: a.to.min(b.to),
        }
    }

    /// Adds the cuts that make the two cross at most at cuts (minimum), or at most once between two (product).
    fn cuts(&self, seeds: [&[f64]; 2], implication: Implication, cuts: &mut Vec<f64>) {
        let direction = |flank: &Flank| match () {
            () if flank.is_level() => 0,
            () if flank.rises() => 1,
            () => -1,
        };
        let alike = direction(self.a) * direction(self.b) > 0;
        let is_straight = |flank: &Flank| flank.kind == Kind::PIECEWISE;
        let points = if alike && !(is_straight(self.a) && is_straight(self.b)) {
            self.points(seeds)
        } else {
            vec![self.from, self.to]
        };
        match implication {
            Implication::Minimum => self.crossings(&points, cuts),
            _ => self.turns_of_ratio(&points, cuts),
        }
    }

    fn points(&self, seeds: [&[f64]; 2]) -> Vec<f64> {
        let (from, to) = (self.from, self.to);
        let even = |i: usize| from + (to - from) * (i as f64 / COMPARED as f64);
        let mut points: Vec<f64> = (1..COMPARED).map(even).collect();
        points.extend(seeds.into_iter().flatten());
        points.retain(|x| from < *x && *x < to);
        points.extend([from, to]);
        points.sort_by(f64::total_cmp);
        points.dedup();
        points
    }

    fn crossings(&self, points: &[f64], cuts: &mut Vec<f64>) {
        let mut before: Option<(f64, f64)> = None;
        for &x in points {
            let (a, b) = (degree(self.a, x), degree(self.b, x));
            let difference = a - b;
            if libm::fabs(difference) <= LEVEL * a.max(b) {
                continue;
            }
            if let Some((last, other)) = before
                && (other > 0.0) != (difference > 0.0)
            {
                cuts.push(root(last, x, |x| degree(self.a, x) - degree(self.b, x)));
            }
            before = Some((x, difference));
        }
    }

    fn turns_of_ratio(&self, points: &[f64], cuts: &mut Vec<f64>) {
        let ratio = |x: f64| libm::log(degree(self.a, x)) - libm::log(degree(self.b, x));
        let ratios: Vec<(f64, f64)> = points
            .iter()
            .map(|x| (*x, ratio(*x)))
            .filter(|(_, ratio)| ratio.is_finite())
            .collect();
        for window in ratios.windows(3) {
            let [(from, left), (_, middle), (to, right)] = *window else {
                continue;
            };
            let turns = (middle - left) * (right - middle) < 0.0;
            let clearly = libm::fabs(middle - left).min(libm::fabs(right - middle)) > 1e-12;
            if turns && clearly {
                cuts.push(turning_point(from, to, middle > left, ratio));
            }
        }
    }
}

/// Where a function with one maximum (or minimum) between two values has it: by the golden section, to a part in a million.
fn turning_point(from: f64, to: f64, is_maximum: bool, f: impl Fn(f64) -> f64) -> f64 {
    const GOLDEN: f64 = 0.618_033_988_749_894_8;
    let f = |x: f64| if is_maximum { f(x) } else { -f(x) };
    let (mut from, mut to) = (from, to);
    for _ in 0..30 {
        let width = GOLDEN * (to - from);
        if f(to - width) > f(from + width) {
            to = from + width;
        } else {
            from = to - width;
        }
    }
    0.5 * (from + to)
}
