//! The values at which the terms of a variable are highest, and the interval in which they change.

use alloc::{vec, vec::Vec};

use crate::model::{MembershipFunction, Variable};

/// Returns the peaks of a variable's terms and the ends of its range, in ascending order. A plateau has two peaks, its
/// ends.
///
/// # Example: temperatures of a room
/// ```
/// use fuzzy::model::Variable;
///
/// let room = Variable::new("room", 0.0, 40.0).partition_at([("cold", 10.0), ("fair", 21.0), ("hot", 28.0)]);
/// assert_eq!(fuzzy::map::peaks(&room), [0.0, 10.0, 21.0, 28.0, 40.0]);
/// ```
pub fn peaks(variable: &Variable) -> Vec<f64> {
    let (low, high) = (variable.low, variable.high);
    let tops = variable
        .terms
        .iter()
        .map(|t| top(&t.membership_function, low, high));
    let mut peaks = vec![low, high];
    peaks.extend(tops.flat_map(|(first, last)| [first, last]));
    peaks.sort_by(f64::total_cmp);
    // Peaks closer than a thousandth of the range are merged; the ends are always kept.
    let apart = 1e-3 * (high - low);
    peaks.dedup_by(|next, last| {
        let is_near = *next - *last < apart;
        // At a limit of `steps`, the value belongs to the term above the limit.
        if is_near && *next == last.next_up() {
            *last = *next;
        }
        is_near
    });
    if let Some(last) = peaks.last_mut().filter(|last| high - **last < apart) {
        *last = high;
    }
    peaks
}

/// Returns the interval in which the terms of a variable change; the whole range if they never change.
///
/// # Example: temperatures of a room
/// ```
/// use fuzzy::model::Variable;
///
/// let room = Variable::new("room", 0.0, 40.0).partition_at([("cold", 10.0), ("fair", 21.0), ("hot", 28.0)]);
/// assert_eq!(fuzzy::map::changing(&room), (10.0, 28.0));
/// ```
pub fn changing(variable: &Variable) -> (f64, f64) {
    let peaks = peaks(variable);
    let changes = |pair: &&[f64]| {
        let differ =
            |shape: &MembershipFunction| shape.membership(pair[0]) != shape.membership(pair[1]);
        variable
            .terms
            .iter()
            .any(|term| differ(&term.membership_function))
    };
    let first = peaks.windows(2).find(changes);
    let last = peaks.windows(2).rev().find(changes);
    match (first, last) {
        (Some(first), Some(last)) => (first[0], last[1]),
        _ => (variable.low, variable.high),
    }
}

/// Returns the interval within a range in which a shape is highest.
fn top(shape: &MembershipFunction, low: f64, high: f64) -> (f64, f64) {
    const STEPS: u32 = 2000;
    let corners = shape.corners().filter(|corners| corners.len() > 1);
    let xs: Vec<f64> = match corners {
        Some(corners) => {
            let ends = [low, high].into_iter();
            ends.chain(corners.iter().map(|(x, _)| x.clamp(low, high)))
                .collect()
        }
        None => {
            let at = |i: u32| low + (high - low) * f64::from(i) / f64::from(STEPS);
            (0..=STEPS).map(at).collect()
        }
    };
    let highest = xs.iter().map(|x| shape.membership(*x));
    let highest = highest.fold(f64::NEG_INFINITY, f64::max);
    let at_top = xs
        .iter()
        .filter(|x| shape.membership(**x) >= highest - 1e-9);
    at_top.fold((high, low), |(first, last), x| (x.min(first), x.max(last)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn peaks_are_the_ends_of_plateaus_and_the_maxima_of_curves() {
        let peaks_of =
            |term: MembershipFunction| peaks(&Variable::new("x", 0.0, 1.0).term("a", term));
        let flat = MembershipFunction::Trapezoid {
            left: 0.1,
            left_top: 0.25,
            right_top: 0.5,
            right: 0.7,
        };
        assert_eq!(peaks_of(flat), [0.0, 0.25, 0.5, 1.0]);
        let bell = |mean| MembershipFunction::Gaussian { mean, sd: 0.1 };
        assert_eq!(peaks_of(bell(0.3)), [0.0, 0.3, 1.0]);
        assert_eq!(peaks_of(bell(3.0)), [0.0, 1.0]);
        let all = MembershipFunction::Rectangle {
            left: 0.0,
            right: 1.0,
        };
        assert_eq!(peaks_of(all), [0.0, 1.0]);
    }
}
