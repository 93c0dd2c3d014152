//! The rules, compiled for firing: plain ANDs in a dense table or a trie, all others as programs.
//!
//! A firing strength of 0 counts nowhere, and 0 AND anything is 0. So a plain AND is only followed as long
//! as its degree is over 0: with terms that sum to 1, 16 of the 625 rules of 4 inputs with 5 terms.

use alloc::{vec, vec::Vec};

use super::condition::{self, Step};
use super::literal::Literals;
use super::operators::smaller;
use super::uniform::Uniform;
use crate::model::{Conjunction, Disjunction};

/// What a rule does with its degree for one consequent.
#[derive(Debug, Clone, Copy)]
pub(super) struct Action {
    pub(super) weight: f64,
    /// Where its firing strength goes among all heights.
    pub(super) place: u32,
    pub(super) output: u32,
    /// The rule's index in the model.
    pub(super) rule: u32,
    /// Whether strengths are summed there, or the largest counts.
    pub(super) sums: bool,
}

/// The strongest rule of an output: the bits of its strength above those of `u32::MAX` less the rule. For
/// numbers that are not negative, bits order as the numbers do, so the largest of these is the strongest
/// rule, of several as strong the first in the model, whatever the order of firing; found without a branch.
#[derive(Debug, Clone, Copy)]
pub(super) struct Strongest(u128);

impl Strongest {
    pub(super) const NONE: Strongest = Strongest(0);

    #[inline(always)]
    pub(super) fn or(self, strength: f64, rule: u32) -> Self {
        let bits = u128::from(strength.to_bits()) << 32 | u128::from(u32::MAX - rule);
        Strongest(if bits > self.0 { bits } else { self.0 })
    }

    /// The strength, and the rule where it is over 0.
    #[inline(always)]
    pub(super) fn rule(self) -> (f64, Option<usize>) {
        let strength = f64::from_bits((self.0 >> 32) as u64);
        let rule = u32::MAX - self.0 as u32;
        (strength, (strength > 0.0).then_some(rule as usize))
    }
}

#[derive(Debug, Clone)]
pub(super) struct Rules {
    pub(super) and: Conjunction,
    or: Disjunction,
    actions: Vec<Action>,
    conjunctions: Conjunctions,
    programs: Vec<Program>,
    steps: Vec<Step>,
    /// Whether degrees of literals are needed by their index.
    pub(super) needs_degrees: bool,
}

/// The rules that are plain ANDs of literals of different inputs.
#[derive(Debug, Clone)]
enum Conjunctions {
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
    most_partial: usize,
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
struct Trie {
    nodes: Vec<Node>,
    /// Literal and node.
    edges: Vec<(u32, u32)>,
}

#[derive(Debug, Clone, Default)]
struct Node {
    first_edge: u32,
    end_edge: u32,
    first_action: u32,
    end_action: u32,
}

#[derive(Debug, Clone)]
struct Program {
    first_step: u32,
    end_step: u32,
    first_action: u32,
    end_action: u32,
}

/// A rule on its way into the compiled form.
#[derive(Debug, Clone)]
pub(super) struct Draft {
    /// The literals of a plain AND, ascending, each of another input; `None` of another condition.
    pub(super) literals: Option<Vec<u32>>,
    pub(super) steps: Vec<Step>,
    pub(super) actions: Vec<Action>,
}

/// Room for firing.
#[derive(Debug)]
pub(super) struct FiringRoom {
    alive: Vec<(f64, u32)>,
    partial: Vec<(f64, u32)>,
    next: Vec<(f64, u32)>,
    stack: Vec<f64>,
    path: Vec<(f64, u32)>,
}

/// As much room: the clone of a vector alone has no room for more than it holds.
impl Clone for FiringRoom {
    fn clone(&self) -> Self {
        FiringRoom {
            alive: self.alive.clone(),
            partial: self.partial.clone(),
            next: self.next.clone(),
            stack: Vec::with_capacity(self.stack.capacity()),
            path: Vec::with_capacity(self.path.capacity()),
        }
    }
}

/// A dense table takes at most this many cells, and at most this many for each rule.
const MOST_CELLS: usize = 1 << 16;
const MOST_CELLS_A_RULE: usize = 32;

impl Rules {
    /// `drafts` in an order that does not depend on the order of the model's rules; `nowhere` is the height
    /// that belongs to no term.
    pub(super) fn new(
        and: Conjunction,
        or: Disjunction,
        drafts: &[Draft],
        inputs: &[Literals],
        nowhere: usize,
    ) -> Self {
        let mut rules = Rules {
            and,
            or,
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

    pub(super) fn room(&self, inputs: &[Literals]) -> FiringRoom {
        let (partial, edges) = match &self.conjunctions {
            Conjunctions::Uniform(uniform) => (uniform.visited(), 0),
            Conjunctions::Dense(dense) => (dense.most_partial, 0),
            Conjunctions::Trie(trie) => (0, trie.edges.len()),
        };
        let alive = inputs.iter().map(Literals::most_alive).max().unwrap_or(0);
        FiringRoom {
            alive: vec![(0.0, 0); alive + 2],
            partial: vec![(0.0, 0); partial + 1],
            next: vec![(0.0, 0); partial + 1],
            stack: Vec::with_capacity(self.steps.len() + 1),
            path: Vec::with_capacity(edges + 1),
        }
    }

    /// Fires all rules into `heights` and `strongest`, which hold zeros before; the last height belongs to no
    /// place. `degrees` holds those of all literals where they are needed.
    #[inline(always)]
    pub(super) fn fire(
        &self,
        inputs: &[Literals],
        values: &[f64],
        degrees: &[f64],
        room: &mut FiringRoom,
        heights: &mut [f64],
        strongest: &mut [Strongest],
    ) {
        // The usual operators without a choice inside the loops.
        match self.and {
            Conjunction::Minimum => {
                self.fire_with(smaller, inputs, values, degrees, room, heights, strongest);
            }
            Conjunction::Product => {
                let and = |a, b| a * b;
                self.fire_with(and, inputs, values, degrees, room, heights, strongest);
            }
            and => {
                let and = |a, b| and.of(a, b);
                self.fire_with(and, inputs, values, degrees, room, heights, strongest);
            }
        }
    }

    #[inline(always)]
    #[allow(clippy::too_many_arguments)]
    fn fire_with(
        &self,
        and: impl Fn(f64, f64) -> f64,
        inputs: &[Literals],
        values: &[f64],
        degrees: &[f64],
        room: &mut FiringRoom,
        heights: &mut [f64],
        strongest: &mut [Strongest],
    ) {
        let mut firing = Firing { heights, strongest };
        match &self.conjunctions {
            Conjunctions::Uniform(uniform) => {
                uniform.fire(
                    values,
                    &mut room.partial,
                    and,
                    firing.heights,
                    firing.strongest,
                );
            }
            Conjunctions::Dense(dense) => {
                dense.fire(&self.actions, inputs, values, room, and, &mut firing);
            }
            Conjunctions::Trie(trie) => {
                trie.fire(&self.actions, degrees, and, &mut room.path, &mut firing);
            }
        }
        for program in &self.programs {
            let steps = &self.steps[program.first_step as usize..program.end_step as usize];
            let degree = condition::run(steps, degrees, self.and, self.or, &mut room.stack);
            if degree > 0.0 {
                let range = program.first_action as usize..program.end_action as usize;
                firing.act(&self.actions[range], degree);
            }
        }
    }
}

struct Firing<'a> {
    heights: &'a mut [f64],
    strongest: &'a mut [Strongest],
}

impl Firing<'_> {
    #[inline(always)]
    fn act(&mut self, actions: &[Action], degree: f64) {
        for action in actions {
            let strongest = &mut self.strongest[action.output as usize];
            *strongest = action.act::<true>(degree, self.heights, *strongest);
        }
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

    /// Widens partial ANDs input by input; the last input acts at once.
    #[inline(always)]
    fn fire(
        &self,
        actions: &[Action],
        inputs: &[Literals],
        values: &[f64],
        room: &mut FiringRoom,
        and: impl Fn(f64, f64) -> f64,
        firing: &mut Firing<'_>,
    ) {
        let Some((last, others)) = self.dimensions.split_last() else {
            let (start, end) = (self.starts[0], self.starts[1]);
            firing.act(&actions[start as usize..end as usize], 1.0);
            return;
        };
        room.partial[0] = (1.0, 0);
        let mut count = 1;
        for dimension in others {
            let alive = dimension.alive(inputs, values, &mut room.alive);
            let mut widened = 0;
            for &(strength, cell) in &room.partial[..count] {
                for &(degree, offset) in &room.alive[..alive] {
                    // Written in any case, counted where it is over 0: no branch to mispredict.
                    let both = and(strength, degree);
                    room.next[widened] = (both, cell + offset);
                    widened += usize::from(both > 0.0);
                }
            }
            core::mem::swap(&mut room.partial, &mut room.next);
            count = widened;
        }
        let alive = last.alive(inputs, values, &mut room.alive);
        for &(strength, cell) in &room.partial[..count] {
            for &(degree, offset) in &room.alive[..alive] {
                let cell = (cell + offset) as usize;
                let (start, end) = (self.starts[cell], self.starts[cell + 1]);
                firing.act(
                    &actions[start as usize..end as usize],
                    and(strength, degree),
                );
            }
        }
    }
}

impl Dimension {
    /// Writes the degrees over 0 and their offsets; gives their number.
    #[inline(always)]
    fn alive(&self, inputs: &[Literals], values: &[f64], alive: &mut [(f64, u32)]) -> usize {
        let mut count = 0;
        inputs[self.input].degrees(values[self.input], |literal, degree| {
            alive[count] = (degree, literal * self.stride);
            count += usize::from(degree > 0.0);
        });
        if let Some(any) = self.any {
            alive[count] = (1.0, any * self.stride);
            count += 1;
        }
        count
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
                children.push((literal, self.add(group, depth + 1, all_actions)));
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

    fn fire(
        &self,
        actions: &[Action],
        degrees: &[f64],
        and: impl Fn(f64, f64) -> f64,
        path: &mut Vec<(f64, u32)>,
        firing: &mut Firing<'_>,
    ) {
        path.clear();
        path.push((1.0, 0));
        while let Some((strength, node)) = path.pop() {
            let node = &self.nodes[node as usize];
            let range = node.first_action as usize..node.end_action as usize;
            firing.act(&actions[range], strength);
            for &(literal, child) in &self.edges[node.first_edge as usize..node.end_edge as usize] {
                let both = and(strength, degrees[literal as usize]);
                if both > 0.0 {
                    path.push((both, child));
                }
            }
        }
    }
}
