//! Splitting terms into stretches that only rise, only fall or are level, and computing the knots of curved stretches.

use alloc::{vec, vec::Vec};

use super::{MAX_KNOTS, Measure};
use crate::defuzzify::maxima::monotone;
use crate::model::Term;
use crate::table::numeric::gauss;
use crate::table::{Flank, Knot};

/// A part of a term that only rises, only falls or is level.
pub(crate) struct Stretch {
    /// The ends of the stretch, and the cuts between them.
    pub(super) cuts: Vec<f64>,
    pub(super) left: f64,
    pub(super) right: f64,
    pub(super) is_curved: bool,
}

/// Returns the corners of a term; `None` if it is curved.
pub(crate) fn corners(term: &Term) -> Option<Vec<(f64, f64)>> {
    let mut corners = term.membership_function.corners()?;
    for corner in &mut corners {
        corner.1 *= term.height;
    }
    Some(corners)
}

/// Returns the stretches of a straight term within the range, except those where it is 0.
pub(crate) fn straight(corners: &[(f64, f64)], low: f64, high: f64) -> Vec<Stretch> {
    let mut cuts: Vec<f64> = corners.iter().map(|corner| corner.0).collect();
    cuts.retain(|x| low < *x && *x < high);
    cuts.insert(0, low);
    cuts.push(high);
    cuts.dedup();
    let ends = cuts.iter().zip(cuts.iter().skip(1));
    let stretches = ends.map(|(&from, &to)| {
        let (left, right) = limits(corners, from, to);
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

/// Returns the degrees of a polyline just inside the ends of an interval without corners.
pub(in crate::defuzzify) fn limits(corners: &[(f64, f64)], from: f64, to: f64) -> (f64, f64) {
    let mut before: Option<(f64, f64)> = None;
    for &corner in corners {
        if corner.0 >= to {
            return match before {
                None => (corner.1, corner.1),
                Some(left) => (on_line(left, corner, from), on_line(left, corner, to)),
            };
        }
        before = Some(corner);
    }
    let held = before.map_or(0.0, |corner| corner.1);
    (held, held)
}

fn on_line(a: (f64, f64), b: (f64, f64), x: f64) -> f64 {
    if x <= a.0 {
        a.1
    } else if x >= b.0 {
        b.1
    } else {
        a.1 + (b.1 - a.1) * ((x - a.0) / (b.0 - a.0))
    }
}

/// The difference of degrees below which a stretch of a curve counts as level.
pub(super) const LEVEL: f64 = 4e-16;

pub(super) fn curved(term: &Term, low: f64, high: f64) -> Vec<Stretch> {
    let f = |x: f64| term.membership(x);
    let cuts = monotone(&term.membership_function, low, high);
    // Returns the degree just inside the stretch, beyond a step at the cut.
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

/// Returns the knots of a curved flank, so close to each other that Gauss-Legendre quadrature is exact between them.
pub(super) fn knots(flank: &Flank, cuts: &[f64], measure: Measure) -> Option<Vec<Knot>> {
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
    // A stack of intervals; the one next to the foot is on top.
    let mut open: Vec<(f64, f64)> = cuts
        .iter()
        .zip(cuts.iter().skip(1))
        .map(|(a, b)| (*a, *b))
        .collect();
    open.reverse();
    while let Some((a, b)) = open.pop() {
        // Splitting at the middle is avoided, because the error of a symmetric kink would cancel
        // there.
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
            // The error of the two parts is 0.57^16 of the error of the whole.
            add(middle, left);
            add(b, right);
        } else {
            open.extend([(middle, b), (a, middle)]);
        }
        if knots.len() > MAX_KNOTS {
            return None;
        }
    }
    Some(fewer(knots, |a, b| integral(a, b).0))
}

/// Removes the knots without which the quadrature is equally accurate.
fn fewer(knots: Vec<Knot>, area: impl Fn(f64, f64) -> f64) -> Vec<Knot> {
    let mut kept: Vec<Knot> = Vec::new();
    let mut last: Option<Knot> = None;
    for knot in knots {
        match (kept.last(), last) {
            (Some(from), Some(last)) => {
                // Three positions are compared, because tails may end anywhere before the knot, and because the error
                // of a symmetric kink cancels at the knot itself.
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
