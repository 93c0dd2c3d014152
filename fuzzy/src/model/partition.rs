//! Terms whose degrees sum to 1 everywhere.

use alloc::{string::String, vec::Vec};

use super::{MembershipFunction, Term, Variable};

/// Returns triangles that end at the peaks of their neighbours, with shoulders at both ends; the degrees sum to 1
/// everywhere.
pub(crate) fn between_peaks(peaks: &[(&str, f64)]) -> Vec<Term> {
    let peak = |i: usize| peaks.get(i).map(|(_, peak)| *peak);
    let term = |(i, &(name, at)): (usize, &(&str, f64))| {
        let left = i.checked_sub(1).and_then(peak);
        let membership_function = match (left, peak(i + 1)) {
            (Some(left), Some(right)) => MembershipFunction::Triangle {
                left,
                peak: at,
                right,
            },
            (None, Some(foot)) => MembershipFunction::LeftShoulder { top: at, foot },
            (Some(foot), None) => MembershipFunction::RightShoulder { foot, top: at },
            (None, None) => MembershipFunction::Constant { value: 1.0 },
        };
        Term {
            name: String::from(name),
            membership_function,
            height: 1.0,
            lower: None,
        }
    };
    peaks.iter().enumerate().map(term).collect()
}

impl Variable {
    /// Returns the peaks of the terms if they form a partition as [`Variable::partition_at`] creates it: at least two
    /// terms of height 1, with increasing peaks inside the range. `None` for other terms.
    pub fn partition_peaks(&self) -> Option<Vec<f64>> {
        let peak = |term: &Term| match term.membership_function {
            MembershipFunction::Triangle { peak, .. } => Some(peak),
            MembershipFunction::LeftShoulder { top, .. }
            | MembershipFunction::RightShoulder { top, .. } => Some(top),
            _ => None,
        };
        let peaks: Vec<f64> = self.terms.iter().map(peak).collect::<Option<_>>()?;
        let names = self.terms.iter().map(|term| term.name.as_str());
        let partition = between_peaks(&names.zip(peaks.iter().copied()).collect::<Vec<_>>());
        let is_partition = peaks.len() >= 2
            && peaks.is_sorted_by(|a, b| a < b)
            && peaks
                .iter()
                .all(|peak| (self.low..=self.high).contains(peak))
            && self.terms == partition;
        is_partition.then_some(peaks)
    }
}

/// Returns the peaks of `count` terms that are evenly spaced from `low` to `high`.
pub(crate) fn even_peaks(low: f64, high: f64, count: usize) -> impl Iterator<Item = f64> {
    let last = count.saturating_sub(1).max(1) as f64;
    (0..count).map(move |i| {
        let part = i as f64 / last;
        low * (1.0 - part) + high * part
    })
}
