//! Conditions as flat programs: no recursion and no allocation when they are evaluated.

use alloc::vec::Vec;

use super::operators::{larger, smaller};
use crate::model::{Conjunction, Disjunction};

/// One step of a condition, on a stack of degrees.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Step {
    /// Push the degree of a literal.
    Push(u32),
    /// Join the top with a literal by AND.
    AndLiteral(u32),
    /// Join the top with a literal by OR.
    OrLiteral(u32),
    /// Join the two on top by AND.
    And,
    /// Join the two on top by OR.
    Or,
    /// One minus the top.
    Not,
}

/// The degree of a condition. `stack` has room for the program's depth.
pub(crate) fn run(
    steps: &[Step],
    degrees: &[f64],
    and: Conjunction,
    or: Disjunction,
    stack: &mut Vec<f64>,
) -> f64 {
    let degree = |literal: u32| degrees.get(literal as usize).copied().unwrap_or(0.0);
    stack.clear();
    let mut top = 0.0;
    for step in steps {
        top = match *step {
            Step::Push(literal) => {
                stack.push(top);
                degree(literal)
            }
            Step::AndLiteral(literal) => and.of(top, degree(literal)),
            Step::OrLiteral(literal) => or.of(top, degree(literal)),
            Step::And => and.of(stack.pop().unwrap_or(0.0), top),
            Step::Or => or.of(stack.pop().unwrap_or(0.0), top),
            Step::Not => 1.0 - top,
        };
    }
    larger(0.0, smaller(1.0, top))
}
