//! Rules as plain data: their actions, and the tables, tries and programs that find the rules that fire.

/// The action of a rule for one of its consequents. The firing strength is the weight times the degree of the
/// antecedent.
#[doc(hidden)] // Exported data.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Action {
    /// The weight of the rule.
    pub weight: f64,
    /// The index of the firing strength that it updates.
    pub strength: u32,
    /// The index of the output.
    pub output: u32,
    /// The index of the rule among the rules of the model.
    pub rule: u32,
    /// 1 if firing strengths are summed, 0 if the largest is used.
    pub sums: u32,
}

impl Action {
    /// Returns an action without effect, which pads cells. `unused` is the index of a firing strength that no output
    /// uses.
    pub(crate) fn none(unused: u32) -> Self {
        Action {
            weight: 0.0,
            strength: unused,
            output: 0,
            rule: u32::MAX,
            sums: 0,
        }
    }
}

/// An input of a uniform table. All its terms are straight, and at most two overlap. Each interval has exactly two
/// lines, if necessary padded with lines of degree 0. Therefore the same number of cells is visited for every value,
/// without a branch that a processor could mispredict.
#[doc(hidden)] // Exported data.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(C)]
pub struct Axis {
    /// The index of the input.
    pub input: u32,
    /// The index of the first cut; the cuts are padded to a multiple of 4 with infinity.
    pub first_cut: u32,
    /// The index after the last cut.
    pub end_cut: u32,
    /// The index of the first of the two lines of the first interval.
    pub first_line: u32,
}

/// An input of a dense table.
#[doc(hidden)] // Exported data.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(C)]
pub struct Dimension {
    /// The index of the input.
    pub input: u32,
    /// The distance, in cells, between neighbouring terms.
    pub stride: u32,
    /// The coordinate of rules without this input; [`Dimension::NONE`] if there are no such rules.
    pub any: u32,
}

impl Dimension {
    /// The value of [`Dimension::any`] if every rule reads the input.
    pub const NONE: u32 = u32::MAX;
}

/// A node of a trie of rules. Each path through the trie is a sequence of literals in ascending order.
#[doc(hidden)] // Exported data.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[repr(C)]
pub struct Node {
    /// The index of the first edge.
    pub first_edge: u32,
    /// The index after the last edge.
    pub end_edge: u32,
    /// The index of the first action of the rules that end here.
    pub first_action: u32,
    /// The index after the last of those actions.
    pub end_action: u32,
}

/// An edge of a trie.
#[doc(hidden)] // Exported data.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(C)]
pub struct Edge {
    /// The index of the literal among those of all inputs.
    pub literal: u32,
    /// The index of the node it leads to.
    pub node: u32,
}

/// A rule that no table or trie contains: its antecedent is not a plain AND, its conclusion has hedges, it belongs to a
/// [`Block`](super::Block), or the rule set is small. The strength that its actions use is the degree of its antecedent
/// times `weight`, adjusted by the activation method and then by the hedges. In a block with an activation method, a
/// program without steps continues the previous rule.
#[doc(hidden)] // Exported data.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Program {
    /// The weight of the rule, by which the degree is multiplied before the hedges are applied. The weights of the
    /// actions are not used.
    pub weight: f64,
    /// The index of the first step.
    pub first_step: u32,
    /// The index after the last step.
    pub end_step: u32,
    /// The index of the first action.
    pub first_action: u32,
    /// The index after the last action.
    pub end_action: u32,
    /// The index of the first hedge; hedges are in the order in which they are applied.
    pub first_hedge: u32,
    /// The index after the last hedge.
    pub end_hedge: u32,
}

/// A step in the computation of an antecedent, on a stack of degrees.
#[doc(hidden)] // Exported data.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[repr(C)]
pub struct AntecedentStep {
    /// The operation.
    pub op: Op,
    /// The index of the literal among those of all inputs; 0 if the operation has no literal.
    pub literal: u32,
}

/// The operation of a step.
#[doc(hidden)] // Exported data.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[repr(transparent)]
pub struct Op(pub u32);

impl Op {
    /// Pushes the degree of a literal.
    pub const PUSH: Op = Op(0);
    /// Replaces the top of the stack by its conjunction with a literal.
    pub const AND_LITERAL: Op = Op(1);
    /// Replaces the top of the stack by its disjunction with a literal.
    pub const OR_LITERAL: Op = Op(2);
    /// Replaces the top two degrees by their conjunction.
    pub const AND: Op = Op(3);
    /// Replaces the top two degrees by their disjunction.
    pub const OR: Op = Op(4);
    /// Replaces the top of the stack by one minus its degree.
    pub const NOT: Op = Op(5);
}
