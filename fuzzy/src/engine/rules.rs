//! The rules, compiled: plain ANDs in a dense table or a trie, all others as programs.

use alloc::{vec, vec::Vec};

use super::condition::Step;
use super::literal::Literals;
use super::uniform::Uniform;
use crate::table::{Action, Edge, Node, Program};

#[derive(Debug, Clone)]
pub(super) struct Rules {
    pub(super) actions: Vec<Action>,
    pub(super) conjunctions: Conjunctions,
    pub(super) programs: Vec<Program>,
    pub(super) steps: Vec<Step>,
    /// Whether degrees of literals are needed by their index.
    pub(super) needs_degrees: bool,
}

/// The rules that are plain ANDs of literals of different inputs.
#[derive(Debug, Clone)]
pub(super) enum Conjunctions {
    Uniform(Uniform),
    Dense(Dense),
    Trie(Trie),
}

/// A cell for each combination of literals, one an input.
#[derive(Debug, Clone)]
pub(super) struct Dense {
    pub(super) dimensions: Vec<Dimension>,
    /// The actions of a cell are `starts[cell]..starts[cell + 1]`.
    pub(super) starts: Vec<u32>,
    pub(super) most_partial: usize,
}

#[derive(Debug, Clone)]
pub(super) struct Dimension {
    pub(super) input: usize,
    pub(super) stride: u32,
    /// The coordinate of rules that say nothing of this input.
    pub(super) any: Option<u32>,
}

/// Rules as paths of literals in ascending order.
#[derive(Debug, Clone, Default)]
pub(super) struct Trie {
    pub(super) nodes: Vec<Node>,
    pub(super) edges: Vec<Edge>,
}

/// A rule on its way into the compiled form.
#[derive(Debug, Clone)]
pub(super) struct Draft {
    /// The literals of a plain AND, ascending, each of another input; `None` of another condition.
    pub(super) literals: Option<Vec<u32>>,
    pub(super) steps: Vec<Step>,
    pub(super) actions: Vec<Action>,
}

/// A dense table takes at most this many cells, and at most this many for each rule.
const MOST_CELLS: usize = 1 << 16;
const MOST_CELLS_A_RULE: usize = 32;

impl Rules {
    /// `drafts` in an order that does not depend on the order of the model's rules; `nowhere` is the height
    /// that belongs to no term.
    pub(super) fn new(drafts: &[Draft], inputs: &[Literals], nowhere: usize) -> Self {
        let mut rules = Rules {
            actions: Vec::new(),
            conjunctions: Conjunctions::Trie(Trie::default()),
            programs: Vec::new(),
            steps: Vec::new(),
            needs_degrees: false,
        };
        for draft in drafts.iter().filter(|draft| draft.literals.is_none()) {
            let (first_step, first_action) = (rules.steps.len(), rules.actions.len());
            rules.steps.extend(&draft.steps);
            rules.actions.extend(&draft.actions);
            rules.programs.push(Program {
                first_step: first_step as u32,
                end_step: rules.steps.len() as u32,
                first_action: first_action as u32,
                end_action: rules.actions.len() as u32,
            });
        }
        let plain: Vec<(&[u32], &[Action])> = drafts
            .iter()
            .filter_map(|draft| Some((draft.literals.as_deref()?, &*draft.actions)))
            .collect();
        rules.conjunctions = match Dense::new(&plain, inputs, &mut rules.actions) {
            Some(dense) => match Uniform::new(&dense, &rules.actions, inputs, nowhere) {
                Some(uniform) => Conjunctions::Uniform(uniform),
                None => Conjunctions::Dense(dense),
            },
            None => Conjunctions::Trie(Trie::new(&plain, &mut rules.actions)),
        };
        rules.needs_degrees =
            !rules.programs.is_empty() || matches!(rules.conjunctions, Conjunctions::Trie(_));
        rules
    }
}

impl Dense {
    fn new(
        plain: &[(&[u32], &[Action])],
        inputs: &[Literals],
        all_actions: &mut Vec<Action>,
    ) -> Option<Self> {
        let used = |input: &Literals, literals: &[u32]| {
            let range = input.first..input.first + input.count;
            literals
                .iter()
                .find(|l| range.contains(l))
                .map(|l| l - input.first)
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
            let any = (uses < plain.len()).then_some(input.count);
            let coordinates = input.count as usize + usize::from(any.is_some());
            dimensions.push(Dimension {
                input: index,
                stride: cells as u32,
                any,
            });
            cells = cells.checked_mul(coordinates)?;
            if cells > MOST_CELLS.min(MOST_CELLS_A_RULE * plain.len().max(8)) {
                return None;
            }
            most_partial *= input.most_alive() + usize::from(any.is_some());
        }
        dimensions.reverse();
        let mut table = vec![Vec::new(); cells];
        for (literals, actions) in plain {
            let mut cell = 0;
            for dimension in &dimensions {
                let coordinate = used(&inputs[dimension.input], literals).or(dimension.any)?;
                cell += coordinate * dimension.stride;
            }
            table[cell as usize].extend_from_slice(actions);
        }
        let mut starts = Vec::with_capacity(cells + 1);
        for actions in table {
            starts.push(all_actions.len() as u32);
            all_actions.extend(actions);
        }
        starts.push(all_actions.len() as u32);
        Some(Dense {
            dimensions,
            starts,
            most_partial,
        })
    }
}

impl Trie {
    fn new(plain: &[(&[u32], &[Action])], all_actions: &mut Vec<Action>) -> Self {
        let mut trie = Trie::default();
        let mut sorted = plain.to_vec();
        sorted.sort_by_key(|(literals, _)| *literals);
        trie.add(&sorted, 0, all_actions);
        trie
    }

    /// Adds the node of all rules that share their first `depth` literals; gives its index.
    fn add(
        &mut self,
        rules: &[(&[u32], &[Action])],
        depth: usize,
        all_actions: &mut Vec<Action>,
    ) -> u32 {
        let node = self.nodes.len();
        self.nodes.push(Node::default());
        let ended = rules
            .iter()
            .take_while(|(literals, _)| literals.len() == depth)
            .count();
        let (here, further) = rules.split_at(ended);
        let first_action = all_actions.len() as u32;
        for (_, actions) in here {
            all_actions.extend_from_slice(actions);
        }
        let end_action = all_actions.len() as u32;
        let next = |rule: &(&[u32], &[Action])| rule.0.get(depth).copied();
        let mut children = Vec::new();
        for group in further.chunk_by(|a, b| next(a) == next(b)) {
            if let Some(literal) = group.first().and_then(next) {
                let node = self.add(group, depth + 1, all_actions);
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
        node as u32
    }
}
