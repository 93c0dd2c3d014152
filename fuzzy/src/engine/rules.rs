//! Rules as arrays: a uniform table, a dense table or a trie of plain ANDs, and programs.

use alloc::{vec, vec::Vec};

use super::arrays::OwnedTable;
use super::literal::Literals;
use crate::model::{Activation, Conjunction, Disjunction, Model};
use crate::table::{
    Action, AntecedentStep, Axis, Block, Conjunctions, Dimension, Edge, Hedge, Line, Node, Op,
    Program,
};

/// A rule whose names are replaced by indices.
#[derive(Debug, Clone)]
pub(super) struct IndexedRule {
    /// The literals of a plain AND, in ascending order, each of a different input; `None` for any other antecedent and
    /// for rules with hedges.
    pub(super) literals: Option<Vec<u32>>,
    pub(super) steps: Vec<AntecedentStep>,
    /// The hedges of the consequents, in the order in which they are applied.
    pub(super) hedges: Vec<Hedge>,
    /// The weight of the rule.
    pub(super) weight: f64,
    pub(super) actions: Vec<Action>,
    /// The index of the rule.
    pub(super) rule: usize,
    /// The index of the block of the rule.
    pub(super) block: usize,
}

/// The operators and activation methods with which the rules of a stage fire.
#[derive(Debug, Clone)]
pub(super) struct FiringOperators {
    pub(super) and: Conjunction,
    pub(super) or: Disjunction,
    pub(super) least_strength: f64,
    /// The rule blocks; empty if all rules share the operators and have no activation method.
    pub(super) blocks: Vec<FiringBlock>,
}

/// The operators and the activation method with which the rules of a block fire.
#[derive(Debug, Clone)]
pub(super) struct FiringBlock {
    pub(super) index: usize,
    pub(super) operators: (Conjunction, Disjunction),
    pub(super) activation: Activation,
}

impl FiringOperators {
    pub(super) fn of(model: &Model) -> Self {
        let of_model = FiringBlock {
            index: 0,
            operators: (model.operators.and, model.operators.or),
            activation: model.activation,
        };
        let blocks = model.blocks.iter().enumerate();
        let blocks = blocks.filter(|(_, block)| block.enabled);
        let mut blocks: Vec<FiringBlock> = blocks
            .map(|(index, block)| FiringBlock {
                index,
                operators: (block.and, block.or),
                activation: block.activation,
            })
            .collect();
        if model.blocks.is_empty() {
            blocks.push(of_model.clone());
        }
        let (and, or) = blocks.first().unwrap_or(&of_model).operators;
        let is_plain = |block: &FiringBlock| {
            block.operators == (and, or) && block.activation == Activation::General
        };
        if blocks.iter().all(is_plain) {
            blocks.clear();
        }
        FiringOperators {
            and,
            or,
            least_strength: model.least_strength,
            blocks,
        }
    }
}

/// The literals and actions of a plain AND.
type PlainConjunction<'d> = (&'d [u32], &'d [Action]);

/// The maximum number of cells of a dense table.
const MAX_CELLS: usize = 1 << 16;
/// The maximum number of cells per rule of a dense table.
const MAX_CELLS_A_RULE: usize = 32;
/// The maximum number of axes of a uniform table. With more, an evaluation would visit more than 64 cells, most of them
/// with degree 0.
const MAX_AXES: usize = 6;
/// The maximum number of actions per cell of a uniform table.
const MAX_ACTIONS_PER_CELL: usize = 2;
/// The maximum total number of steps of all rules for which evaluating every rule is faster than finding the rules that
/// fire.
const MAX_STEPS_OF_FEW_RULES: usize = 64;

/// Returns whether evaluating all rules is faster than finding those that fire.
fn are_few(drafts: &[IndexedRule]) -> bool {
    let steps: usize = drafts.iter().map(|draft| draft.steps.len()).sum();
    steps <= MAX_STEPS_OF_FEW_RULES
}

/// Returns whether a batch may evaluate all rules, each for several rows together. This is not allowed if a firing
/// strength is a sum of more than two numbers, because they would be added in another order than in a single
/// evaluation.
pub(super) fn may_be_programs(drafts: &[IndexedRule]) -> bool {
    let actions = || drafts.iter().flat_map(|draft| &draft.actions);
    let keeps_its_bits = |action: &Action| {
        let same = actions().filter(|other| other.strength == action.strength);
        action.sums == 0 || same.count() <= 2
    };
    are_few(drafts) && actions().all(keeps_its_bits)
}

impl OwnedTable {
    /// Adds the rules. The order of `drafts` does not depend on the order of the rules in the model. `unused` is the
    /// index of a firing strength that no output uses.
    pub(super) fn rules(&mut self, drafts: &[IndexedRule], inputs: &[Literals], unused: u32) {
        let plain: Vec<PlainConjunction<'_>> = drafts
            .iter()
            .filter_map(|draft| Some((draft.literals.as_deref()?, &*draft.actions)))
            .collect();
        let is_short = are_few(drafts);
        // If one rule is a program, the degrees of all literals are computed anyway. Then the plain ANDs become
        // programs too, unless there are many rules.
        let is_plain = plain.len() == drafts.len();
        let has_table = (is_plain || !is_short) && self.dense(&plain, inputs).is_some();
        let is_uniform = has_table && self.uniform(inputs, unused).is_some();
        let all_programs = is_short && !is_uniform;
        if all_programs {
            self.dimensions.clear();
            self.cells.clear();
            self.actions.clear();
        }
        if all_programs || !has_table {
            let mut sorted = if all_programs { Vec::new() } else { plain };
            sorted.sort_by_key(|(literals, _)| *literals);
            let (_, most_open) = self.node(&sorted, 0);
            self.conjunctions = Conjunctions::Trie;
            self.sizes.partial = most_open.max(1);
        }
        for draft in drafts
            .iter()
            .filter(|draft| all_programs || draft.literals.is_none())
        {
            self.program(draft);
        }
    }

    /// Adds the rules of blocks in the order of `drafts`.
    pub(super) fn blocks(&mut self, blocks: &[FiringBlock], drafts: &[IndexedRule]) {
        for block in blocks {
            let first_program = self.programs.len() as u32;
            let mut latest = None;
            for draft in drafts.iter().filter(|draft| draft.block == block.index) {
                // An activation method considers each rule once, even if hedges split the rule into several programs.
                let selects = block.activation != Activation::General;
                let again = selects && latest.replace(draft.rule) == Some(draft.rule);
                let steps = if again { &[][..] } else { &draft.steps };
                self.program_of(draft, steps.iter().copied());
            }
            let end_program = self.programs.len() as u32;
            let span = (first_program, end_program);
            let block = Block::new(block.operators, block.activation, span);
            self.blocks.push(block);
            self.sizes.partial = self.sizes.partial.max(end_program - first_program);
        }
        // The trie is empty, so that no rule is found in it.
        self.nodes.push(Node::default());
        self.conjunctions = Conjunctions::Trie;
        self.sizes.partial = self.sizes.partial.max(1);
    }

    /// Adds a rule as a program. The literals of a plain AND are in the same order as in a table, to give the same
    /// bits.
    pub(super) fn program(&mut self, draft: &IndexedRule) {
        match &draft.literals {
            Some(literals) => {
                let ops = core::iter::once(Op::PUSH).chain(core::iter::repeat(Op::AND_LITERAL));
                let steps = literals.iter().zip(ops);
                self.program_of(
                    draft,
                    steps.map(|(&literal, op)| AntecedentStep { op, literal }),
                );
            }
            None => self.program_of(draft, draft.steps.iter().copied()),
        }
    }

    fn program_of(&mut self, draft: &IndexedRule, steps: impl Iterator<Item = AntecedentStep>) {
        let (first_step, first_action) = (self.steps.len(), self.actions.len());
        let first_hedge = self.hedges.len();
        self.steps.extend(steps);
        self.actions.extend(&draft.actions);
        self.hedges.extend(&draft.hedges);
        self.programs.push(Program {
            weight: draft.weight,
            first_step: first_step as u32,
            end_step: self.steps.len() as u32,
            first_action: first_action as u32,
            end_action: self.actions.len() as u32,
            first_hedge: first_hedge as u32,
            end_hedge: self.hedges.len() as u32,
        });
        let steps = self.steps.get(first_step..).unwrap_or_default();
        let pushes = steps.iter().filter(|step| step.op == Op::PUSH);
        self.sizes.stack = self.sizes.stack.max(pushes.count() as u32);
    }

    /// Adds a dense table; `None` if it would have too many cells.
    fn dense(&mut self, plain: &[PlainConjunction<'_>], inputs: &[Literals]) -> Option<()> {
        let used = |input: &Literals, literals: &[u32]| {
            let range = input.first..input.first + input.count;
            let literal = literals.iter().find(|literal| range.contains(literal));
            literal.map(|literal| literal - input.first)
        };
        let mut dimensions = Vec::new();
        let (mut cells, mut most_partial) = (1usize, 1usize);
        for (index, input) in inputs.iter().enumerate().rev() {
            let uses = plain
                .iter()
                .filter(|(literals, _)| used(input, literals).is_some());
            let uses = uses.count();
            if uses == 0 {
                continue;
            }
            let in_all = uses == plain.len();
            dimensions.push(Dimension {
                input: index as u32,
                stride: cells as u32,
                any: if in_all { Dimension::NONE } else { input.count },
            });
            cells = cells.checked_mul(input.count as usize + usize::from(!in_all))?;
            if cells > MAX_CELLS.min(MAX_CELLS_A_RULE * plain.len().max(8)) {
                return None;
            }
            most_partial *= input.most_alive() + usize::from(!in_all);
        }
        dimensions.reverse();
        let mut actions_of = vec![Vec::new(); cells];
        for (literals, actions) in plain {
            let mut cell = 0;
            for dimension in &dimensions {
                let literal = used(&inputs[dimension.input as usize], literals);
                cell += literal.unwrap_or(dimension.any) * dimension.stride;
            }
            actions_of[cell as usize].extend_from_slice(actions);
        }
        for actions in actions_of {
            self.cells.push(self.actions.len() as u32);
            self.actions.extend(actions);
        }
        self.cells.push(self.actions.len() as u32);
        self.dimensions = dimensions;
        self.conjunctions = Conjunctions::Dense;
        self.sizes.partial = most_partial as u32 + 1;
        Some(())
    }

    /// Replaces a dense table by a uniform one; `None` if an input has curved or hedged literals or more than two literals
    /// above 0 at the same value, or if there are too many axes or actions per cell.
    fn uniform(&mut self, inputs: &[Literals], unused: u32) -> Option<()> {
        let (mut axes, mut cuts, mut lines) = (Vec::new(), Vec::new(), Vec::new());
        for dimension in &self.dimensions {
            let literals = &inputs[dimension.input as usize];
            if literals.has_curved() {
                return None;
            }
            let any = (dimension.any != Dimension::NONE)
                .then(|| Line::flat(dimension.any * dimension.stride, 1.0));
            let (first_cut, first_line) = (cuts.len(), lines.len() as u32);
            for alive in literals.intervals() {
                let offset = |line: &Line| Line {
                    literal: line.literal * dimension.stride,
                    ..*line
                };
                let end = lines.len() + 2;
                lines.extend(alive.iter().map(offset).chain(any));
                if lines.len() > end {
                    return None;
                }
                lines.resize(end, Line::flat(0, 0.0));
            }
            cuts.extend(&literals.cuts);
            let padded = literals.cuts.len().next_multiple_of(4);
            cuts.resize(first_cut + padded, f64::INFINITY);
            axes.push(Axis {
                input: dimension.input,
                first_cut: first_cut as u32,
                end_cut: cuts.len() as u32,
                first_line,
            });
        }
        let cells = |ends: &[u32]| self.actions.get(ends[0] as usize..ends[1] as usize);
        let cells: Vec<&[Action]> = self.cells.windows(2).filter_map(cells).collect();
        let actions_per_cell = cells.iter().map(|actions| actions.len()).max()?.max(1);
        if axes.len() > MAX_AXES || actions_per_cell > MAX_ACTIONS_PER_CELL {
            return None;
        }
        let mut actions = Vec::new();
        for cell in cells {
            let end = actions.len() + actions_per_cell;
            actions.extend(cell);
            actions.resize(end, Action::none(unused));
        }
        // The padded cells replace those of the dense table.
        let first_action = self.cells.first().copied()?;
        self.conjunctions = Conjunctions::Uniform {
            actions_per_cell: actions_per_cell as u32,
            first_action,
            sums: self.actions.iter().any(|action| action.sums != 0),
        };
        self.actions.truncate(first_action as usize);
        self.actions.extend(actions);
        self.sizes.partial = 1 << axes.len();
        (self.axes, self.cuts, self.lines) = (axes, cuts, lines);
        self.dimensions.clear();
        self.cells.clear();
        Some(())
    }

    /// Adds the node of a trie for rules that share their first `depth` literals. Returns its index, and the maximum
    /// size of the stack of nodes during a traversal. The children are visited in reverse order: while the nodes below
    /// a child are on the stack, the stack also contains all children before it.
    fn node(&mut self, rules: &[PlainConjunction<'_>], depth: usize) -> (u32, u32) {
        let node = self.nodes.len();
        self.nodes.push(Node::default());
        let ended = rules
            .iter()
            .take_while(|(literals, _)| literals.len() == depth)
            .count();
        let (here, further) = rules.split_at(ended);
        let first_action = self.actions.len() as u32;
        for (_, actions) in here {
            self.actions.extend_from_slice(actions);
        }
        let end_action = self.actions.len() as u32;
        let next = |rule: &PlainConjunction<'_>| rule.0.get(depth).copied();
        let mut children = Vec::new();
        let mut most_open = 0;
        for group in further.chunk_by(|a, b| next(a) == next(b)) {
            if let Some(literal) = group.first().and_then(next) {
                let (node, below) = self.node(group, depth + 1);
                most_open = most_open.max(children.len() as u32 + below.max(1));
                children.push(Edge { literal, node });
            }
        }
        let first_edge = self.edges.len() as u32;
        self.edges.extend(children);
        self.nodes[node] = Node {
            first_edge,
            end_edge: self.edges.len() as u32,
            first_action,
            end_action,
        };
        (node as u32, most_open)
    }
}
