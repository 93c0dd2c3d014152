//! Terms that divide a range at limits: each value belongs to exactly one of them.

use alloc::{string::String, vec::Vec};

use super::{MembershipFunction, Term, Variable};

/// Returns rectangles that reach from limit to limit over a range. A limit belongs to the term above it: the term below
/// it ends at the next smaller number.
pub(crate) fn between_limits(low: f64, high: f64, below: &[(&str, f64)], last: &str) -> Vec<Term> {
    let mut left = low;
    let mut term = |name: &str, right: f64, next: f64| {
        let membership_function = MembershipFunction::Rectangle { left, right };
        left = next;
        Term {
            name: String::from(name),
            membership_function,
            height: 1.0,
            lower: None,
        }
    };
    let mut terms: Vec<Term> = below
        .iter()
        .map(|&(name, limit)| term(name, limit.next_down(), limit))
        .collect();
    terms.push(term(last, high, high));
    terms
}

impl Variable {
    /// Adds terms that divide the range at limits, from left to right. Each term is 1 from the previous limit up to,
    /// but not including, its own limit; `last` is 1 from the last limit to the end of the range.
    ///
    /// # Example: a value at a limit belongs to the term above it
    /// ```
    /// use fuzzy::model::Variable;
    ///
    /// let share = Variable::new("share", 0.0, 100.0).steps([("fine", 36.0), ("stretched", 43.0)], "over");
    /// let at = |x: f64| -> Vec<f64> { share.terms.iter().map(|term| term.membership(x)).collect() };
    /// assert_eq!(at(35.999999), [1.0, 0.0, 0.0]);
    /// assert_eq!(at(36.0), [0.0, 1.0, 0.0]);
    /// assert_eq!(at(43.0), [0.0, 0.0, 1.0]);
    /// assert_eq!(share.step_limits(), Some(vec![36.0, 43.0]));
    /// ```
    #[must_use]
    pub fn steps<'a>(
        mut self,
        below: impl IntoIterator<Item = (&'a str, f64)>,
        last: &str,
    ) -> Self {
        let below: Vec<(&str, f64)> = below.into_iter().collect();
        self.terms
            .extend(between_limits(self.low, self.high, &below, last));
        self
    }

    /// Returns the limits of the terms if they divide the range as [`Variable::steps`] does: at least two rectangles of
    /// height 1 from the lower end of the range to the upper one, each ending at the number before the next one begins.
    /// `None` for other terms.
    pub fn step_limits(&self) -> Option<Vec<f64>> {
        let (last, below) = self.terms.split_last()?;
        let right = |term: &Term| match term.membership_function {
            MembershipFunction::Rectangle { right, .. } => Some(right.next_up()),
            _ => None,
        };
        // The number after the predecessor of 0 is -0.
        let limits: Vec<f64> = below
            .iter()
            .map(|term| right(term).map(|limit| limit + 0.0))
            .collect::<Option<_>>()?;
        let named = below.iter().map(|term| term.name.as_str());
        let named: Vec<(&str, f64)> = named.zip(limits.iter().copied()).collect();
        let in_range = |limit: &f64| self.low < *limit && *limit <= self.high;
        let are_steps = !limits.is_empty()
            && limits.is_sorted_by(|a, b| a < b)
            && limits.iter().all(in_range)
            && self.terms == between_limits(self.low, self.high, &named, &last.name);
        are_steps.then_some(limits)
    }
}
