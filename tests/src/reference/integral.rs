//! Defuzzification of a set whose degree and slope are known at each point. The error is about 1e-13 of its range.
//!
//! The range is cut where the set may have a kink or a step: where the functions in `Set::kinks` change their
//! sign. Between the cuts, it is integrated by Gauss-Legendre rules, on intervals that are halved until nothing
//! changes. Degrees are never negative, so the sums lose no digits, and 64-bit numbers suffice. A maximum is where
//! the slope, by automatic differentiation, changes its sign. tests/peer/mpmath.sh computes the same with 80
//! digits.

use std::sync::OnceLock;

use fuzzy::model::Defuzzifier;

use super::{operators::ROUNDING, rules::Set};

/// The value of a set; `None` if the set is 0 everywhere. NaN if the value depends on rounding, because a peak is lower
/// than the highest one by almost exactly the tolerance within which both count as highest.
pub fn defuzzify(set: &Set<'_>) -> Option<f64> {
    let pieces = pieces(set);
    if let Defuzzifier::Centroid | Defuzzifier::Bisector = set.defuzzifier {
        let rough: f64 = pieces.iter().map(|piece| gauss(set, *piece).0).sum();
        let allowed = 1e-15 * rough;
        let integrals: Vec<(f64, f64)> = pieces
            .iter()
            .map(|piece| integral(set, *piece, allowed, 0))
            .collect();
        let area: f64 = integrals.iter().map(|one| one.0).sum();
        if area <= 0.0 {
            return None;
        }
        if set.defuzzifier == Defuzzifier::Bisector {
            return Some(bisector(set, &pieces, &integrals, 0.5 * area, allowed));
        }
        return Some(middle(set) + integrals.iter().map(|one| one.1).sum::<f64>() / area);
    }
    maxima(set, &pieces)
}

fn middle(set: &Set<'_>) -> f64 {
    0.5 * (set.low + set.high)
}

/// The number of intervals of a piece that are searched for roots.
const GRID: u32 = 48;

/// An interval on which the set is smooth.
type Piece = (f64, f64);

/// Returns evenly spaced positions in a piece. The first and the last position are at a distance of `inside` times the
/// width of the piece from its ends.
fn grid((from, to): Piece, inside: f64) -> impl Iterator<Item = f64> {
    let rounding = 4.0 * f64::EPSILON * from.abs().max(to.abs());
    let inside = (inside * (to - from)).max(rounding).min(0.1 * (to - from));
    let width = to - from - 2.0 * inside;
    (0..=GRID).map(move |i| from + inside + width * (f64::from(i) / f64::from(GRID)))
}

/// The pieces of the range, without those that are so narrow that they result from rounding.
fn pieces(set: &Set<'_>) -> Vec<Piece> {
    let narrow = 1e-13 * (set.high - set.low);
    let mut cuts = set.cuts.clone();
    for kinks in &set.kinks {
        let mut more = Vec::new();
        for ends in cuts.windows(2) {
            for kink in kinks {
                let places: Vec<(f64, f64)> = grid((ends[0], ends[1]), 1e-14)
                    .map(|x| (x, kink(x)))
                    .collect();
                for two in places.windows(2) {
                    if two[0].1 * two[1].1 < 0.0 {
                        let rises = two[1].1 > 0.0;
                        more.push(bisection(two[0].0, two[1].0, |x| (kink(x) < 0.0) == rises));
                    }
                }
            }
        }
        cuts.extend(more);
        cuts.sort_by(f64::total_cmp);
        cuts.dedup();
    }
    let pieces = cuts.windows(2).map(|ends| (ends[0], ends[1]));
    pieces.filter(|(from, to)| to - from > narrow).collect()
}

/// The end of the interval on which a condition is true.
fn bisection(from: f64, to: f64, holds: impl Fn(f64) -> bool) -> f64 {
    let (mut from, mut to) = (from, to);
    for _ in 0..100 {
        let x = 0.5 * (from + to);
        *(if holds(x) { &mut from } else { &mut to }) = x;
    }
    0.5 * (from + to)
}

const NODES: usize = 20;

/// Nodes and weights on [-1, 1], by Newton's method on Legendre polynomials.
fn legendre(n: usize) -> Vec<(f64, f64)> {
    let polynomial = |x: f64| {
        let (mut before, mut here) = (1.0, x);
        for k in 2..=n {
            let k = k as f64;
            (before, here) = (here, ((2.0 * k - 1.0) * x * here - (k - 1.0) * before) / k);
        }
        (here, n as f64 * (x * here - before) / (x * x - 1.0))
    };
    (0..n)
        .map(|i| {
            let mut x = (std::f64::consts::PI * (i as f64 + 0.75) / (n as f64 + 0.5)).cos();
            for _ in 0..20 {
                let (value, slope) = polynomial(x);
                x -= value / slope;
            }
            let slope = polynomial(x).1;
            (x, 2.0 / ((1.0 - x * x) * slope * slope))
        })
        .collect()
}

/// The area and the moment about the middle of the range.
fn gauss(set: &Set<'_>, (from, to): Piece) -> (f64, f64) {
    static RULE: OnceLock<Vec<(f64, f64)>> = OnceLock::new();
    let (center, half) = (0.5 * (from + to), 0.5 * (to - from));
    let mut sums = (0.0, 0.0);
    for (node, weight) in RULE.get_or_init(|| legendre(NODES)) {
        let x = center + half * node;
        let y = half * weight * (set.degree)(x);
        sums.0 += y;
        sums.1 += y * (x - middle(set));
    }
    sums
}

/// The area and the moment, by halving intervals until nothing changes.
fn integral(set: &Set<'_>, (from, to): Piece, allowed: f64, halvings: u32) -> (f64, f64) {
    let center = 0.5 * (from + to);
    let (whole, left, right) = (
        gauss(set, (from, to)),
        gauss(set, (from, center)),
        gauss(set, (center, to)),
    );
    if (left.0 + right.0 - whole.0).abs() <= allowed || halvings > 45 {
        return (left.0 + right.0, left.1 + right.1);
    }
    let left = integral(set, (from, center), allowed, halvings + 1);
    let right = integral(set, (center, to), allowed, halvings + 1);
    (left.0 + right.0, left.1 + right.1)
}

fn bisector(
    set: &Set<'_>,
    pieces: &[Piece],
    integrals: &[(f64, f64)],
    half: f64,
    allowed: f64,
) -> f64 {
    let mut sum = 0.0;
    for (&(from, to), (area, _)) in pieces.iter().zip(integrals) {
        if sum + area >= half {
            let up_to = |x: f64| sum + integral(set, (from, x), allowed, 0).0;
            return bisection(from, to, |x| up_to(x) < half);
        }
        sum += area;
    }
    set.high
}

/// A position with the degree and the slope there.
type SlopedPoint = (f64, f64, f64);

fn maxima(set: &Set<'_>, pieces: &[Piece]) -> Option<f64> {
    let seen: Vec<Vec<SlopedPoint>> = pieces
        .iter()
        .map(|piece| {
            let places = grid(*piece, 1e-10).map(|x| (x, (set.degree)(x), (set.slope)(x)));
            places.collect()
        })
        .collect();
    let peaks = peaks(set, pieces, &seen);
    let degrees = peaks.iter().map(|peak| peak.1);
    let all = degrees.chain(seen.iter().flatten().map(|place| place.1));
    let highest = all.fold(0.0, f64::max);
    if highest <= 0.0 {
        return None;
    }
    let least = highest * (1.0 - ROUNDING);
    let is_at_bound = |degree: f64| (1.0 - degree / highest - ROUNDING).abs() < 0.5 * ROUNDING;
    if peaks.iter().any(|peak| is_at_bound(peak.1)) {
        return Some(f64::NAN);
    }
    let high = pieces.iter().zip(&seen);
    let plateaus = high.filter(|(_, places)| places.iter().all(|place| place.1 >= least));
    let plateaus: Vec<Piece> = plateaus.map(|(piece, _)| *piece).collect();
    let is_beside = |x: &f64| !plateaus.iter().any(|(from, to)| from <= x && x <= to);
    let high = peaks.iter().filter(|peak| peak.1 >= least);
    let points: Vec<f64> = high.map(|peak| peak.0).filter(is_beside).collect();
    let ends = plateaus.iter().flat_map(|(from, to)| [*from, *to]);
    let all = points.iter().copied().chain(ends);
    Some(match set.defuzzifier {
        Defuzzifier::SmallestOfMaxima => all.fold(f64::INFINITY, f64::min),
        Defuzzifier::LargestOfMaxima => all.fold(f64::NEG_INFINITY, f64::max),
        _ if plateaus.is_empty() => points.iter().sum::<f64>() / points.len() as f64,
        _ => {
            let moment = plateaus
                .iter()
                .map(|(from, to)| 0.5 * (from + to) * (to - from));
            moment.sum::<f64>() / plateaus.iter().map(|(from, to)| to - from).sum::<f64>()
        }
    })
}

/// The peaks of a set with their degrees, from left to right.
fn peaks(set: &Set<'_>, pieces: &[Piece], seen: &[Vec<SlopedPoint>]) -> Vec<(f64, f64)> {
    let mut peaks = Vec::new();
    let mut before: Option<SlopedPoint> = None;
    for (&(from, to), places) in pieces.iter().zip(seen) {
        let (first, last) = (places[0], places[GRID as usize]);
        let (rises, left) = before.map_or((true, first.1), |place| (place.2 > 0.0, place.1));
        // `up`: the set rises to the cut, or steps up at the cut. `down`: the set falls after the cut, or steps down at
        // the cut.
        let is_step = (left - first.1).abs() > 1e-7 * left.max(first.1);
        let up = if is_step { left < first.1 } else { rises };
        let down = if is_step {
            left > first.1
        } else {
            first.2 < 0.0
        };
        if up && (first.2 < 0.0 || down) || down && rises {
            let beside = left.max(first.1);
            let here = (set.degree)(from);
            // The degree at the peak must equal the degrees beside it; at a step, a single point may have another degree.
            let is_peak = !is_step && (here - beside).abs() <= 1e-7 * beside;
            peaks.push((from, if is_peak { here } else { beside }));
        }
        for two in places.windows(2) {
            if two[0].2 > 0.0 && two[1].2 <= 0.0 {
                let x = bisection(two[0].0, two[1].0, |x| (set.slope)(x) > 0.0);
                peaks.push((x, (set.degree)(x)));
            }
        }
        if to == set.high && last.2 > 0.0 {
            peaks.push((to, last.1));
        }
        before = Some(last);
    }
    peaks
}
