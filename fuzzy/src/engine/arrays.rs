//! The arrays of a [`Table`], owned by the engine.

use alloc::vec::Vec;

use super::literal::Literals;
use super::rules::{FiringOperators, IndexedRule, may_be_programs};
use super::{CompiledOutput, Input as Range};
use crate::defuzzify::{Method, PreparedSet};
use crate::model::{Conjunction, Disjunction, MembershipFunction, NoRuleFires, Term};
use crate::table::{
    Action, AntecedentStep, Axis, Base, Block, ClosedForm, Coefficient, Conjunctions, Consequent,
    Curve, Dimension, Edge, Ends, Flank, FuzzySet, Hedge, Input, Knot, LayeredSet, Layers, Line,
    Moment, Node, Output, Pair, Point, Program, Section, SetTerm, Sizes, Strand, Table, arrays,
    arrays_from_fields,
};

/// The maximum number of literals for which a batch evaluates every formula. If there are more, the batch looks up the
/// literals above 0.
const MAX_FORMULAS: u32 = 32;

macro_rules! define {
    ($($(#[$doc:meta])* $array:ident: $item:ident,)*) => {
        /// A [`Table`] that owns its arrays.
        #[derive(Debug, Clone, Default)]
        pub(super) struct OwnedTable {
            and: Conjunction,
            or: Disjunction,
            pub(super) conjunctions: Conjunctions,
            least_strength: f64,
            pub(super) sizes: Sizes,
            $(pub(super) $array: Vec<$item>,)*
        }

        impl OwnedTable {
            /// Appends the arrays of another stage.
            pub(super) fn append(&mut self, other: &OwnedTable) {
                // All stages have the operators of the model.
                (self.and, self.or) = (other.and, other.or);
                self.least_strength = other.least_strength;
                let (own, other_sizes) = (self.sizes, other.sizes);
                self.sizes = Sizes {
                    degrees: own.degrees.max(other_sizes.degrees),
                    alive: own.alive.max(other_sizes.alive),
                    partial: own.partial.max(other_sizes.partial),
                    stack: own.stack.max(other_sizes.stack),
                    strengths: own.strengths.max(other_sizes.strengths),
                };
                $(self.$array.extend_from_slice(&other.$array);)*
            }

            /// Returns the lengths of the arrays.
            pub(super) fn ends(&self) -> Ends {
                Ends {
                    $($array: self.$array.len() as u32,)*
                }
            }

            pub(super) fn table(&self) -> Table<'_> {
                Table {
                    and: self.and,
                    or: self.or,
                    conjunctions: self.conjunctions,
                    least_strength: self.least_strength,
                    sizes: self.sizes,
                    $($array: &self.$array,)*
                }
            }
        }
    };
}
arrays!(define!);
arrays!(arrays_from_fields! OwnedTable;);

impl OwnedTable {
    pub(super) fn new(
        firing: &FiringOperators,
        inputs: &[Range],
        literals: &[Literals],
        drafts: &[IndexedRule],
        outputs: &[CompiledOutput],
    ) -> Self {
        let mut table = OwnedTable::empty(firing, outputs);
        if firing.blocks.is_empty() {
            table.rules(drafts, literals, table.sizes.strengths - 1);
        } else {
            table.blocks(&firing.blocks, drafts);
        }
        if !table.programs.is_empty() || table.conjunctions == Conjunctions::Trie {
            table.sizes.degrees = literals.iter().map(|literals| literals.count).sum();
        }
        let alive = literals.iter().map(Literals::most_alive).max().unwrap_or(0);
        table.sizes.alive = alive as u32 + 2;
        // A uniform table stores the lines of its axes itself, so its inputs need no lines.
        let reads_literals = table.sizes.degrees > 0 || table.conjunctions == Conjunctions::Dense;
        for (range, literals) in inputs.iter().zip(literals) {
            if reads_literals {
                table.input(literals, range.low, range.high);
            } else {
                let none = Literals::new(literals.first, Vec::new(), range.low, range.high);
                table.input(&none, range.low, range.high);
            }
        }
        table
    }

    /// Compiles all rules to programs and all literals to formulas, to evaluate several rows together. `None` if a
    /// batch does not benefit from that.
    pub(super) fn programs_alone(
        firing: &FiringOperators,
        inputs: &[Range],
        literals: &[Literals],
        drafts: &[IndexedRule],
        outputs: &[CompiledOutput],
    ) -> Option<Self> {
        let mut table = OwnedTable::empty(firing, outputs);
        table.sizes.degrees = literals.iter().map(|literals| literals.count).sum();
        let is_small = may_be_programs(drafts) && table.sizes.degrees <= MAX_FORMULAS;
        if !is_small || !firing.blocks.is_empty() {
            return None;
        }
        table.sizes.partial = 1;
        // Programs are added in the order of the model, because finding the strongest rule then takes fewer steps.
        let mut drafts: Vec<&IndexedRule> = drafts.iter().collect();
        drafts.sort_by_key(|draft| draft.rule);
        for draft in drafts {
            table.program(draft);
        }
        for (range, literals) in inputs.iter().zip(literals) {
            table.input(literals, range.low, range.high);
        }
        Some(table)
    }

    /// Returns a table with the outputs, but without inputs and rules.
    fn empty(firing: &FiringOperators, outputs: &[CompiledOutput]) -> Self {
        let mut table = OwnedTable {
            and: firing.and,
            or: firing.or,
            least_strength: firing.least_strength,
            ..OwnedTable::default()
        };
        let strengths = outputs.last().map_or(0, |output| output.strengths.end);
        table.sizes.strengths = strengths as u32 + 1;
        for output in outputs {
            table.output(output);
        }
        table
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
            self.curve(*index, &literal.term, &literal.hedges);
        }
        self.inputs.push(Input {
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

    pub(super) fn curve(&mut self, index: u32, term: &Term, hedges: &[Hedge]) {
        let (first_point, first_hedge) = (self.points.len() as u32, self.hedges.len() as u32);
        let (kind, parameters) = term.membership_function.kind();
        match &term.membership_function {
            MembershipFunction::Piecewise { points } => {
                self.points.extend(points.iter().map(|(x, y)| [*x, *y]));
            }
            MembershipFunction::Function { formula } => self.points.extend(formula.code()),
            _ => {}
        }
        self.hedges.extend(hedges);
        self.curves.push(Curve {
            parameters,
            height: term.height,
            kind,
            literal: index,
            first_point,
            end_point: self.points.len() as u32,
            first_hedge,
            end_hedge: self.hedges.len() as u32,
        });
    }

    fn output(&mut self, output: &CompiledOutput) {
        let (form, (first, end)) = match &output.method {
            Method::Integrated(_) => (ClosedForm::Integrated, (0, 0)),
            Method::Partition(partition) => {
                let form = match partition.scales {
                    true => ClosedForm::ScaledPartition,
                    false => ClosedForm::Partition,
                };
                (form, extend(&mut self.pairs, partition.pairs()))
            }
            Method::Prepared(prepared) => {
                let form = match prepared.scales {
                    true => ClosedForm::Scaled,
                    false => ClosedForm::Cut,
                };
                (form, self.set(prepared, &output.offsets))
            }
            Method::Layered(layered) => {
                let bases = layered.bases.len() as u32 + 1;
                self.sizes.stack = self.sizes.stack.max(bases);
                let (first_base, end_base) = extend(&mut self.bases, &layered.bases);
                let (first_layer, end_layer) = extend(&mut self.layers, &layered.layers);
                let set = LayeredSet {
                    first_base,
                    end_base,
                    first_layer,
                    end_layer,
                };
                (ClosedForm::Layers, extend(&mut self.layered_sets, &[set]))
            }
            Method::Moments(moments) => (ClosedForm::Moments, extend(&mut self.moments, moments)),
            Method::Tsukamoto(terms) => {
                let first = self.curves.len() as u32;
                let counts = output.offsets.iter().zip(output.offsets.iter().skip(1));
                for (term, (start, end)) in terms.iter().zip(counts) {
                    for _ in *start..*end {
                        self.curve(0, term, &[]);
                    }
                }
                (ClosedForm::Tsukamoto, (first, self.curves.len() as u32))
            }
            Method::Sugeno {
                consequents,
                is_sum,
            } => {
                let (first, _) = extend(&mut self.coefficients, &consequents.coefficients);
                let (first_code, _) = extend(&mut self.points, &consequents.code);
                let mut consequents = consequents.consequents.clone();
                for consequent in &mut consequents {
                    consequent.first += first;
                    consequent.end += first;
                    consequent.first_code += first_code;
                    consequent.end_code += first_code;
                }
                let form = match is_sum {
                    true => ClosedForm::WeightedSum,
                    false => ClosedForm::WeightedAverage,
                };
                (form, extend(&mut self.consequents, &consequents))
            }
        };
        self.outputs.push(Output {
            low: output.low,
            high: output.high,
            default_value: match output.when_no_rule_fires {
                NoRuleFires::Value(value) | NoRuleFires::Previous(Some(value)) => value,
                NoRuleFires::Undefined | NoRuleFires::Error | NoRuleFires::Previous(None) => {
                    f64::NAN
                }
            },
            form: form as u32,
            first,
            end,
            first_strength: output.strengths.start as u32,
            end_strength: output.strengths.end as u32,
            clamps: u32::from(output.clamps),
            reduction: 0,
            lower: 0,
        });
    }
}

impl OwnedTable {
    /// Adds a prepared set. Term k has the firing strengths `offsets[k]..offsets[k + 1]`.
    fn set(&mut self, prepared: &PreparedSet, offsets: &[usize]) -> (u32, u32) {
        let (first_knot, first_flank) = (self.knots.len() as u32, self.flanks.len() as u32);
        let (first_strand, first_term) = (self.strands.len() as u32, self.set_terms.len() as u32);
        self.knots.extend(&prepared.knots);
        self.flanks
            .extend(prepared.flanks.iter().map(|flank| Flank {
                first_knot: flank.first_knot + first_knot,
                end_knot: flank.end_knot + first_knot,
                ..*flank
            }));
        self.strands
            .extend(prepared.strands.iter().map(|strand| Strand {
                flank: strand.flank + first_flank,
                ..*strand
            }));
        let ends = offsets.iter().zip(offsets.iter().skip(1));
        for (term, (first, end)) in prepared.terms.iter().zip(ends) {
            let term = SetTerm {
                first_flank: term.first_flank + first_flank,
                end_flank: term.end_flank + first_flank,
                ..*term
            };
            self.set_terms.extend((*first..*end).map(|_| term));
        }
        let sections = prepared.sections.iter().map(|section| Section {
            first_strand: section.first_strand + first_strand,
            end_strand: section.end_strand + first_strand,
            ..*section
        });
        let first_section = self.sections.len() as u32;
        self.sections.extend(sections);
        let set = FuzzySet {
            first_section,
            end_section: self.sections.len() as u32,
            first_term,
            end_term: self.set_terms.len() as u32,
            ..prepared.set
        };
        extend(&mut self.sets, &[set])
    }
}

/// Appends items and returns their range of indices.
fn extend<T: Copy>(all: &mut Vec<T>, items: &[T]) -> (u32, u32) {
    let first = all.len() as u32;
    all.extend_from_slice(items);
    (first, all.len() as u32)
}
