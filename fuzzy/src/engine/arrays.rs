//! The compiled parts of an engine laid out as the arrays of a [`Table`].

use alloc::vec::Vec;

use super::literal::{Literal, Literals};
use super::rules::{Conjunctions, Rules};
use super::{CompiledOutput, Input};
use crate::defuzzify::Closed;
use crate::model::{Conjunction, Disjunction, MembershipFunction, NoRuleFires, Operators};
use crate::rule::Hedge;
use crate::table::{
    self, Action, Axis, Coefficient, Consequence, Curve, Dimension, Edge, Line, Moment, Node, Op,
    Output, Pair, Program, Set, Sizes, Step, Table,
};

/// The arrays of a [`Table`], owned.
#[derive(Debug, Clone, Default)]
pub(super) struct Arrays {
    and: Conjunction,
    or: Disjunction,
    conjunctions: table::Conjunctions,
    pub(super) sizes: Sizes,
    pub(super) inputs: Vec<table::Input>,
    cuts: Vec<f64>,
    starts: Vec<u32>,
    lines: Vec<Line>,
    curves: Vec<Curve>,
    points: Vec<[f64; 2]>,
    hedges: Vec<Hedge>,
    axes: Vec<Axis>,
    dimensions: Vec<Dimension>,
    cells: Vec<u32>,
    nodes: Vec<Node>,
    edges: Vec<Edge>,
    actions: Vec<Action>,
    programs: Vec<Program>,
    steps: Vec<Step>,
    outputs: Vec<Output>,
    pairs: Vec<Pair>,
    moments: Vec<Moment>,
    consequences: Vec<Consequence>,
    coefficients: Vec<Coefficient>,
}

table::arrays_of_fields!(Arrays);

impl Arrays {
    pub(super) fn new(
        operators: Operators,
        inputs: &[Input],
        literals: &[Literals],
        rules: Rules,
        outputs: &[CompiledOutput],
    ) -> Self {
        let mut arrays = Arrays {
            and: operators.and,
            or: operators.or,
            ..Arrays::default()
        };
        // A uniform table has its own lines, and needs no others but for programs.
        let is_uniform = matches!(rules.conjunctions, Conjunctions::Uniform(_));
        for (input, literals) in inputs.iter().zip(literals) {
            if is_uniform && !rules.needs_degrees {
                let nothing = Literals::new(literals.first, Vec::new(), input.low, input.high);
                arrays.input(&nothing, input.low, input.high);
            } else {
                arrays.input(literals, input.low, input.high);
            }
        }
        let alive = literals.iter().map(Literals::most_alive).max().unwrap_or(0);
        arrays.sizes.alive = alive as u32 + 2;
        if rules.needs_degrees {
            arrays.sizes.degrees = literals.iter().map(|literals| literals.count).sum();
        }
        arrays.rules(rules);
        for output in outputs {
            arrays.output(output);
        }
        arrays
    }

    /// Adds an input with its literals.
    pub(super) fn input(&mut self, literals: &Literals, low: f64, high: f64) {
        let (first_cut, first_curve) = (self.cuts.len() as u32, self.curves.len() as u32);
        let (first_start, first_line) = (self.starts.len() as u32, self.lines.len() as u32);
        self.cuts.extend(&literals.cuts);
        let starts = literals.starts.iter();
        self.starts.extend(starts.map(|start| first_line + start));
        self.lines.extend(&literals.lines);
        for (index, literal) in &literals.curved {
            self.curve(*index, literal);
        }
        self.inputs.push(table::Input {
            low,
            high,
            first_literal: literals.first,
            first_cut,
            end_cut: self.cuts.len() as u32,
            first_start,
            first_curve,
            end_curve: self.curves.len() as u32,
        });
    }

    fn curve(&mut self, index: u32, literal: &Literal) {
        let (first_point, first_hedge) = (self.points.len() as u32, self.hedges.len() as u32);
        let (kind, parameters) = literal.term.shape.kind();
        if let MembershipFunction::Piecewise { points } = &literal.term.shape {
            self.points.extend(points.iter().map(|(x, y)| [*x, *y]));
        }
        self.hedges.extend(&literal.hedges);
        self.curves.push(Curve {
            parameters,
            height: literal.term.height,
            kind,
            literal: index,
            first_point,
            end_point: self.points.len() as u32,
            first_hedge,
            end_hedge: self.hedges.len() as u32,
        });
    }

    fn rules(&mut self, rules: Rules) {
        let depth = |program: &Program| {
            let steps = program.first_step as usize..program.end_step as usize;
            let pushes = self.steps_of(&rules, steps).filter(|op| *op == Op::PUSH);
            pushes.count() as u32
        };
        self.sizes.stack = rules.programs.iter().map(depth).max().unwrap_or(0);
        self.actions = rules.actions;
        self.programs = rules.programs;
        self.steps = rules.steps.iter().map(|step| step.compiled()).collect();
        match rules.conjunctions {
            Conjunctions::Uniform(uniform) => {
                self.sizes.partial = 1 << uniform.axes.len();
                // Its actions stand in the place of those of the dense table that it was made of.
                let programs = self.programs.iter().map(|program| program.end_action);
                self.actions.truncate(programs.max().unwrap_or(0) as usize);
                self.conjunctions = table::Conjunctions::Uniform {
                    actions_a_cell: uniform.actions_a_cell as u32,
                    first_action: self.actions.len() as u32,
                    sums: uniform.sums,
                };
                self.actions.extend(uniform.actions);
                for axis in uniform.axes {
                    let first_cut = self.cuts.len() as u32;
                    self.cuts.extend(axis.cuts);
                    self.axes.push(Axis {
                        input: axis.input as u32,
                        first_cut,
                        end_cut: self.cuts.len() as u32,
                        first_line: self.lines.len() as u32,
                    });
                    self.lines.extend(axis.lines.iter().flatten());
                }
            }
            Conjunctions::Dense(dense) => {
                self.sizes.partial = dense.most_partial as u32 + 1;
                self.conjunctions = table::Conjunctions::Dense;
                self.cells = dense.starts;
                self.dimensions = dense
                    .dimensions
                    .iter()
                    .map(|dimension| Dimension {
                        input: dimension.input as u32,
                        stride: dimension.stride,
                        any: dimension.any.unwrap_or(u32::MAX),
                    })
                    .collect();
            }
            Conjunctions::Trie(trie) => {
                self.sizes.partial = trie.edges.len() as u32 + 1;
                self.conjunctions = table::Conjunctions::Trie;
                self.nodes = trie.nodes;
                self.edges = trie.edges;
            }
        }
    }

    fn steps_of<'r>(
        &self,
        rules: &'r Rules,
        range: core::ops::Range<usize>,
    ) -> impl Iterator<Item = Op> + use<'r> {
        let steps = rules.steps.get(range).unwrap_or_default();
        steps.iter().map(|step| step.compiled().op)
    }

    fn output(&mut self, output: &CompiledOutput) {
        let (set, first, end) = match output.defuzzify.closed() {
            Closed::Open => (Set::OPEN, 0, 0),
            Closed::Partition(pairs) => {
                let first = self.pairs.len();
                self.pairs.extend(pairs);
                (Set::PARTITION, first, self.pairs.len())
            }
            Closed::Moments(moments) => {
                let first = self.moments.len();
                self.moments.extend(moments);
                (Set::MOMENTS, first, self.moments.len())
            }
            Closed::Weighted(set, consequents) => {
                let first = self.consequences.len();
                for consequent in consequents {
                    let first = self.coefficients.len() as u32;
                    let coefficients = consequent.coefficients.iter();
                    self.coefficients
                        .extend(coefficients.map(|(input, coefficient)| Coefficient {
                            coefficient: *coefficient,
                            input: *input as u32,
                        }));
                    self.consequences.push(Consequence {
                        constant: consequent.constant,
                        first,
                        end: self.coefficients.len() as u32,
                    });
                }
                (set, first, self.consequences.len())
            }
        };
        self.sizes.heights = output.heights.end as u32 + 1;
        self.outputs.push(Output {
            low: output.low,
            high: output.high,
            otherwise: match output.when_no_rule_fires {
                NoRuleFires::Value(value) => value,
                NoRuleFires::Undefined | NoRuleFires::Error => f64::NAN,
            },
            set,
            first: first as u32,
            end: end as u32,
            first_height: output.heights.start as u32,
            end_height: output.heights.end as u32,
        });
    }

    /// The arrays, lent.
    pub(super) fn table(&self) -> Table<'_> {
        Table {
            and: self.and,
            or: self.or,
            conjunctions: self.conjunctions,
            sizes: self.sizes,
            inputs: &self.inputs,
            cuts: &self.cuts,
            starts: &self.starts,
            lines: &self.lines,
            curves: &self.curves,
            points: &self.points,
            hedges: &self.hedges,
            axes: &self.axes,
            dimensions: &self.dimensions,
            cells: &self.cells,
            nodes: &self.nodes,
            edges: &self.edges,
            actions: &self.actions,
            programs: &self.programs,
            steps: &self.steps,
            outputs: &self.outputs,
            pairs: &self.pairs,
            moments: &self.moments,
            consequences: &self.consequences,
            coefficients: &self.coefficients,
        }
    }
}
