//! Rules as plain data: what they do, and the tables, tries and programs by which those that fire are found.

/// What a rule does with its degree for one consequent.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Action {
    /// The rule's weight.
    pub weight: f64,
    /// Where its firing strength goes among all heights.
    pub place: u32,
    /// The output.
    pub output: u32,
    /// The rule's index in the model.
    pub rule: u32,
    /// 1 where strengths are summed there, 0 where the largest counts.
    pub sums: u32,
}

impl Action {
    /// Of weight 0 for no term: fills up cells.
    pub(crate) fn none(nowhere: usize) -> Self {
        Action {
            weight: 0.0,
            place: nowhere as u32,
            output: 0,
            rule: u32::MAX,
            sums: 0,
        }
    }
}

/// An input of a uniform table: where every input has straight terms only, of which at most two are alive at once, each
/// interval holds two lines (made up with lines of degree 0), and the same number of cells is visited for every value.
/// Which terms are alive cannot be predicted, so every branch saved counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(C)]
pub struct Axis {
    /// The input.
    pub input: u32,
    /// Where, in the cuts, its own begin: made up to a multiple of 4 with infinity.
    pub first_cut: u32,
    /// Where they end.
    pub end_cut: u32,
    /// Where, in the lines, the two of its first interval stand.
    pub first_line: u32,
}

/// An input of a dense table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(C)]
pub struct Dimension {
    /// The input.
    pub input: u32,
    /// How many cells apart its neighbouring terms stand.
    pub stride: u32,
    /// The coordinate of rules that say nothing of this input; `u32::MAX` where there is none.
    pub any: u32,
}

/// A node of a trie of rules, whose paths are literals in ascending order.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[repr(C)]
pub struct Node {
    /// Its edges.
    pub first_edge: u32,
    /// Where they end.
    pub end_edge: u32,
    /// The actions of the rule that ends here.
    pub first_action: u32,
    /// Where they end.
    pub end_action: u32,
}

/// An edge of a trie.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(C)]
pub struct Edge {
    /// The literal, among all.
    pub literal: u32,
    /// The node it leads to.
    pub node: u32,
}

/// A rule whose condition is no plain AND.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(C)]
pub struct Program {
    /// Its steps.
    pub first_step: u32,
    /// Where they end.
    pub end_step: u32,
    /// Its actions.
    pub first_action: u32,
    /// Where they end.
    pub end_action: u32,
}

/// One step of a condition, on a stack of degrees: no recursion and no allocation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(C)]
pub struct Step {
    /// What it does.
    pub op: Op,
    /// The literal, among all, of a step that has one.
    pub literal: u32,
}

/// What a step does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(transparent)]
pub struct Op(pub u32);

impl Op {
    /// Push the degree of a literal.
    pub const PUSH: Op = Op(0);
    /// Join the top with a literal by AND.
    pub const AND_LITERAL: Op = Op(1);
    /// Join the top with a literal by OR.
    pub const OR_LITERAL: Op = Op(2);
    /// Join the two on top by AND.
    pub const AND: Op = Op(3);
    /// Join the two on top by OR.
    pub const OR: Op = Op(4);
    /// One minus the top.
    pub const NOT: Op = Op(5);
}
