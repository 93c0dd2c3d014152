//! The range of an input, cut where something about its terms changes.

use alloc::vec::Vec;

use crate::model::{MembershipFunction, Parts, Variable};

/// Points of the range at which to look: evenly spaced ones, and those that the terms' parameters name.
const EVENLY_SPACED: usize = 64;

/// The values of a variable at which something may happen: the ends, even steps, every parameter of every term that
/// lies in the range. Rising, no two equal.
pub(super) fn places(variable: &Variable) -> Vec<f64> {
    let (low, high) = (variable.low, variable.high);
    let even = (0..=EVENLY_SPACED).map(|i| {
        let part = i as f64 / EVENLY_SPACED as f64;
        low * (1.0 - part) + high * part
    });
    let named = variable.terms.iter().flat_map(|term| marks(&term.shape));
    let mut places: Vec<f64> = even
        .chain(named.filter(|x| (low..=high).contains(x)))
        .collect();
    places.sort_by(f64::total_cmp);
    places.dedup();
    places
}

/// The corners and middles of a shape, among other numbers.
pub(super) fn marks(shape: &MembershipFunction) -> Vec<f64> {
    match shape.parts() {
        Parts::Fixed(_, parameters) => parameters,
        Parts::Points(points) => points.iter().map(|&(x, _)| x).collect(),
        Parts::Linear(..) => Vec::new(),
    }
}

/// Where `holds` changes from place to place, to the last digit that matters.
pub(super) fn changes(places: &[f64], holds: impl Fn(f64) -> bool) -> Vec<f64> {
    let mut found = Vec::new();
    let Some(&first) = places.first() else {
        return found;
    };
    let mut before = (first, holds(first));
    for &x in places.get(1..).unwrap_or_default() {
        let here = holds(x);
        if here != before.1 {
            found.push(rounded(bisect(before.0, x, |x| holds(x) == before.1)));
        }
        before = (x, here);
    }
    found
}

/// The place between `from`, where `same` holds, and `to`, where it does not, at which it stops.
pub(super) fn bisect(mut from: f64, mut to: f64, same: impl Fn(f64) -> bool) -> f64 {
    loop {
        let middle = 0.5 * (from + to);
        if middle <= from || middle >= to {
            return to;
        }
        if same(middle) {
            from = middle;
        } else {
            to = middle;
        }
    }
}

/// Twelve digits: what lies behind them is the rounding of a membership function, not an author's number.
pub(super) fn rounded(x: f64) -> f64 {
    let text = alloc::format!("{x:.11e}");
    text.parse().unwrap_or(x)
}
