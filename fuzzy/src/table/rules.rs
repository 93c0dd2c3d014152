//! Rules as plain data: their actions, and the tables, tries and programs that find the rules that fire.

/// What a rule does for one of its consequents: its weight times the degree of its antecedent is its firing strength.
#[doc(hidden)] // Exported data.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Action {
    /// The rule's weight.
    pub weight: f64,
    /// The index of the firing strength it updates.
    pub strength: u32,
    /// The index of the output.
    pub output: u32,
    /// The rule's index in the model.
    pub rule: u32,
    /// 1 where firing strengths are summed, 0 where the largest counts.
    pub sums: u32,
}

impl Action {
    /// An action without effect, which pads cells. `unused` is the index of the firing strength of no output.
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

/// An input of a uniform table. All its terms are straight and at most two overlap. Each interval has two lines, padded with
/// lines of degree 0, so every value visits the same number of cells without a branch that a processor could mispredict.
#[doc(hidden)] // Exported data.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(C)]
pub struct Axis {
    /// The index of the input.
    pub input: u32,
    /// Its span of cuts, padded to a multiple of 4 with infinity.
    pub first_cut: u32,
    /// The end of that span.
    pub end_cut: u32,
    /// The index of the first of the two lines of its first interval.
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
    /// The coordinate of rules without this input; [`Dimension::NONE`] where there are none.
    pub any: u32,
}

impl Dimension {
    /// [`Dimension::any`] where every rule has the input.
    pub const NONE: u32 = u32::MAX;
}

/// A node of a trie of rules. Its paths are literals in ascending order.
#[doc(hidden)] // Exported data.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[repr(C)]
pub struct Node {
    /// Its span of edges.
    pub first_edge: u32,
    /// The end of that span.
    pub end_edge: u32,
    /// The span of actions of the rules that end here.
    pub first_action: u32,
    /// The end of that span.
    pub end_action: u32,
}

/// An edge of a trie.
#[doc(hidden)] // Exported data.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(C)]
pub struct Edge {
    /// The index of its literal among those of all inputs.
    pub literal: u32,
    /// The index of the node it leads to.
    pub node: u32,
}

/// A rule whose antecedent is not a plain AND, whose conclusion has hedges, or that stands in a [`Block`](super::Block). The
/// degree of its antecedent times `weight`, then changed by the activation method and the hedges, is the strength that its
/// actions take. In a block with an activation method, a program without steps is more of the rule before it.
#[doc(hidden)] // Exported data.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Program {
    /// The rule's weight, which multiplies the degree before the hedges; those of the actions are not used.
    pub weight: f64,
    /// Its span of steps.
    pub first_step: u32,
    /// The end of that span.
    pub end_step: u32,
    /// Its span of actions.
    pub first_action: u32,
    /// The end of that span.
    pub end_action: u32,
    /// Its span of hedges, in the order in which they apply.
    pub first_hedge: u32,
    /// The end of that span.
    pub end_hedge: u32,
}

/// A step of an antecedent, on a stack of degrees.
#[doc(hidden)] // Exported data.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[repr(C)]
pub struct Step {
    /// The operation.
    pub op: Op,
    /// The index of its literal among those of all inputs; 0 where the operation has none.
    pub literal: u32,
}

/// The operation of a step.
#[doc(hidden)] // Exported data.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[repr(transparent)]
pub struct Op(pub u32);

impl Op {
    /// Push the degree of a literal.
    pub const PUSH: Op = Op(0);
    /// Replace the top by its AND with a literal.
    pub const AND_LITERAL: Op = Op(1);
    /// Replace the top by its OR with a literal.
    pub const OR_LITERAL: Op = Op(2);
    /// Replace the two on top by their AND.
    pub const AND: Op = Op(3);
    /// Replace the two on top by their OR.
    pub const OR: Op = Op(4);
    /// Replace the top by one minus it.
    pub const NOT: Op = Op(5);
}
