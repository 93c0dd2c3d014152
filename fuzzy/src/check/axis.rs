//! Values in the range of an input, and the values at which a property of its terms changes.

use alloc::vec::Vec;

use crate::model::{MembershipFunction, ShapeParts, Variable};

/// The number of evenly spaced steps over a range.
const EVENLY_SPACED: usize = 64;

/// Returns the values at which a variable is evaluated: evenly spaced values including both ends, and the parameters
/// of the terms that are in the range. They are in ascending order without duplicates.
pub(super) fn values(variable: &Variable) -> Vec<f64> {
    let (low, high) = (variable.low, variable.high);
    let even = (0..=EVENLY_SPACED).map(|i| {
        let part = i as f64 / EVENLY_SPACED as f64;
        low * (1.0 - part) + high * part
    });
    let named = variable
        .terms
        .iter()
        .flat_map(|term| marks(&term.membership_function));
    let mut values: Vec<f64> = even
        .chain(named.filter(|x| (low..=high).contains(x)))
        .collect();
    values.sort_by(f64::total_cmp);
    values.dedup();
    values
}

/// Returns the parameters of a membership function: corners and middles, but also widths and slopes.
pub(super) fn marks(shape: &MembershipFunction) -> Vec<f64> {
    match shape.parts() {
        ShapeParts::Fixed(_, parameters) => parameters,
        ShapeParts::Points(points) => points.iter().map(|&(x, _)| x).collect(),
        ShapeParts::Formula(_) | ShapeParts::Linear(..) => Vec::new(),
    }
}

/// Returns the values at which the result of `is_true` changes between two successive given values. They are found by
/// bisection.
pub(super) fn changes(values: &[f64], is_true: impl Fn(f64) -> bool) -> Vec<f64> {
    let mut found = Vec::new();
    let Some(&first) = values.first() else {
        return found;
    };
    let mut before = (first, is_true(first));
    for &x in values.get(1..).unwrap_or_default() {
        let here = is_true(x);
        if here != before.1 {
            found.push(rounded(bisect(before.0, x, |x| is_true(x) == before.1)));
        }
        before = (x, here);
    }
    found
}

/// Returns the values at which `is_true` returns true, although it returns false at the next smaller and the next
/// larger floating-point number.
pub(super) fn points(values: &[f64], is_true: impl Fn(f64) -> bool) -> Vec<f64> {
    let (Some(&low), Some(&high)) = (values.first(), values.last()) else {
        return Vec::new();
    };
    let is_alone = |x: &f64| {
        let beside = [x.next_down(), x.next_up()];
        let mut beside = beside.into_iter().filter(|x| (low..=high).contains(x));
        is_true(*x) && !beside.any(&is_true)
    };
    values.iter().copied().filter(is_alone).collect()
}

/// Returns a number for which `same` is false, although it is true for the next smaller floating-point number. `same`
/// must be true at `from` and false at `to`.
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

/// Rounds to twelve digits, because further digits result from rounding in membership functions.
pub(super) fn rounded(x: f64) -> f64 {
    let text = alloc::format!("{x:.11e}");
    text.parse().unwrap_or(x)
}
