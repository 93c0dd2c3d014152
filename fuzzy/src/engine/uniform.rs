//! Firing without branches: where every input has straight terms only, of which at most two are alive at
//! once, each interval holds two lines (made up with lines of degree 0), and the same number of cells is
//! visited for every value. Which terms are alive cannot be predicted, so every branch saved counts.

use alloc::vec::Vec;

use super::literal::{Line, Literals};
use super::operators::larger;
use super::rules::{Action, Dense, Strongest};

#[derive(Debug, Clone)]
pub(super) struct Uniform {
    axes: Vec<Axis>,
    /// `actions_a_cell` for each cell.
    actions: Vec<Action>,
    actions_a_cell: usize,
    /// Whether strengths are summed anywhere.
    sums: bool,
}

#[derive(Debug, Clone)]
struct Axis {
    input: usize,
    /// Where intervals begin, made up to a multiple of 4 with infinity.
    cuts: Vec<f64>,
    /// Those of each interval; `literal` is an offset among the cells.
    lines: Vec<[Line; 2]>,
}

/// More axes would visit more than 64 cells: too many where many of them are 0.
const MOST_AXES: usize = 6;
const MOST_ACTIONS_A_CELL: usize = 2;

impl Uniform {
    /// `None` where an input has curved or hedged literals, or where too many cells would be visited.
    pub(super) fn new(
        dense: &Dense,
        actions: &[Action],
        inputs: &[Literals],
        nowhere: usize,
    ) -> Option<Self> {
        let mut axes = Vec::new();
        for dimension in &dense.dimensions {
            let literals = &inputs[dimension.input];
            if literals.has_curved() {
                return None;
            }
            let any = dimension
                .any
                .map(|any| Line::flat(any * dimension.stride, 1.0));
            let mut lines = Vec::new();
            for alive in literals.intervals() {
                let placed = alive.iter().map(|line| Line {
                    literal: line.literal * dimension.stride,
                    ..*line
                });
                let mut placed = placed.chain(any);
                let none = Line::flat(0, 0.0);
                lines.push([placed.next().unwrap_or(none), placed.next().unwrap_or(none)]);
                if placed.next().is_some() {
                    return None;
                }
            }
            let mut cuts = literals.cuts.clone();
            cuts.resize(cuts.len().next_multiple_of(4), f64::INFINITY);
            axes.push(Axis {
                input: dimension.input,
                cuts,
                lines,
            });
        }
        let cell = |ends: &[u32]| actions.get(ends[0] as usize..ends[1] as usize);
        let cells: Vec<&[Action]> = dense.starts.windows(2).filter_map(cell).collect();
        let actions_a_cell = cells.iter().map(|actions| actions.len()).max()?.max(1);
        if axes.len() > MOST_AXES || actions_a_cell > MOST_ACTIONS_A_CELL {
            return None;
        }
        let mut uniform = Uniform {
            axes,
            actions: Vec::new(),
            actions_a_cell,
            sums: actions.iter().any(|action| action.sums),
        };
        for actions in cells {
            let full = uniform.actions.len() + actions_a_cell;
            uniform.actions.extend(actions);
            uniform.actions.resize(full, Action::none(nowhere));
        }
        Some(uniform)
    }

    /// How many cells are visited.
    pub(super) fn visited(&self) -> usize {
        1 << self.axes.len()
    }

    /// Fires into `heights`, whose last place takes what belongs nowhere.
    #[inline(always)]
    pub(super) fn fire(
        &self,
        values: &[f64],
        partial: &mut [(f64, u32)],
        and: impl Fn(f64, f64) -> f64,
        heights: &mut [f64],
        strongest: &mut [Strongest],
    ) {
        if let [first, second] = &*self.axes {
            let [a, b] = first.at(values);
            let [c, d] = second.at(values);
            let both = |p: (f64, u32), q: (f64, u32)| (and(p.0, q.0), p.1 + q.1);
            let cells = [both(a, c), both(b, c), both(a, d), both(b, d)];
            self.act(&cells, heights, strongest);
            return;
        }
        partial[0] = (1.0, 0);
        let mut count = 1;
        for axis in &self.axes {
            let [a, b] = axis.at(values);
            let (first, others) = partial.split_at_mut(count);
            for (cell, other) in first.iter_mut().zip(others) {
                *other = (and(cell.0, b.0), cell.1 + b.1);
                *cell = (and(cell.0, a.0), cell.1 + a.1);
            }
            count *= 2;
        }
        self.act(&partial[..count], heights, strongest);
    }

    #[inline(always)]
    fn act(&self, cells: &[(f64, u32)], heights: &mut [f64], strongest: &mut [Strongest]) {
        if let ([strongest], 1, false) = (&mut *strongest, self.actions_a_cell, self.sums) {
            let mut top = *strongest;
            for &(degree, cell) in cells {
                top = self.actions[cell as usize].act::<false>(degree, heights, top);
            }
            *strongest = top;
            return;
        }
        for &(degree, cell) in cells {
            let first = cell as usize * self.actions_a_cell;
            for action in &self.actions[first..first + self.actions_a_cell] {
                let strongest = &mut strongest[action.output as usize];
                *strongest = action.act::<true>(degree, heights, *strongest);
            }
        }
    }
}

impl Axis {
    /// Degrees and offsets of the two lines on the interval in which the input lies.
    #[inline(always)]
    fn at(&self, values: &[f64]) -> [(f64, u32); 2] {
        let x = values[self.input];
        let mut interval = 0;
        for cuts in self.cuts.chunks_exact(4) {
            for cut in cuts {
                interval += usize::from(x >= *cut);
            }
        }
        let [a, b] = &self.lines[interval];
        [(a.degree(x), a.literal), (b.degree(x), b.literal)]
    }
}

impl Action {
    /// Of weight 0 for no term: fills up cells.
    fn none(nowhere: usize) -> Self {
        Action {
            weight: 0.0,
            place: nowhere as u32,
            output: 0,
            rule: u32::MAX,
            sums: false,
        }
    }

    /// Takes the action and gives the strongest rule so far.
    #[inline(always)]
    pub(super) fn act<const SUMS: bool>(
        &self,
        degree: f64,
        heights: &mut [f64],
        strongest: Strongest,
    ) -> Strongest {
        let strength = self.weight * degree;
        let height = &mut heights[self.place as usize];
        *height = if SUMS && self.sums {
            *height + strength
        } else {
            larger(*height, strength)
        };
        strongest.or(strength, self.rule)
    }
}
