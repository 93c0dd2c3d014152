//! Whether the same number of cells can be visited for every value, and the table that does it.

use alloc::vec::Vec;

use super::literal::Literals;
use super::rules::Dense;
use crate::table::{Action, Line};

#[derive(Debug, Clone)]
pub(super) struct Uniform {
    pub(super) axes: Vec<Axis>,
    /// `actions_a_cell` for each cell.
    pub(super) actions: Vec<Action>,
    pub(super) actions_a_cell: usize,
    /// Whether strengths are summed anywhere.
    pub(super) sums: bool,
}

#[derive(Debug, Clone)]
pub(super) struct Axis {
    pub(super) input: usize,
    /// Where intervals begin, made up to a multiple of 4 with infinity.
    pub(super) cuts: Vec<f64>,
    /// Those of each interval; `literal` is an offset among the cells.
    pub(super) lines: Vec<[Line; 2]>,
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
            sums: actions.iter().any(|action| action.sums != 0),
        };
        for actions in cells {
            let full = uniform.actions.len() + actions_a_cell;
            uniform.actions.extend(actions);
            uniform.actions.resize(full, Action::none(nowhere));
        }
        Some(uniform)
    }
}
