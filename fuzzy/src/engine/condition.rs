//! Conditions as flat programs, on their way into a table.

use crate::table::{self, Op};

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

impl Step {
    /// As it stands in a table.
    pub(super) fn compiled(self) -> table::Step {
        let (op, literal) = match self {
            Step::Push(literal) => (Op::PUSH, literal),
            Step::AndLiteral(literal) => (Op::AND_LITERAL, literal),
            Step::OrLiteral(literal) => (Op::OR_LITERAL, literal),
            Step::And => (Op::AND, 0),
            Step::Or => (Op::OR, 0),
            Step::Not => (Op::NOT, 0),
        };
        table::Step { op, literal }
    }
}
