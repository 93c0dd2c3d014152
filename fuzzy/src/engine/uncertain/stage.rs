//! A stage whose inputs are intervals: bounds of the degrees and of the firing strengths, and an interval of each output.

use alloc::{vec, vec::Vec};

use super::super::compile::Compiler;
use super::super::rules::{FiringOperators, IndexedRule};
use super::degrees::RangedLiteral;
use super::formula::{self, Span};
use super::{Interval, OutputBounds};
use crate::defuzzify::{ConsequentOperators, EnclosureMethod, Strengths, workspace::Workspace};
use crate::model::{
    Activation, Conjunction, Defuzzifier, Disjunction, MembershipFunction, Model, NoRuleFires,
    Output, chain,
};
use crate::table::operators::{larger, smaller};
use crate::table::{Action, AntecedentStep, Op};

/// The relative width of the band around the least firing strength in which rounding may decide whether a rule
/// fires.
const NEAR: f64 = 1e-3;

/// A stage that is evaluated with intervals as inputs.
#[derive(Debug, Clone)]
pub(super) struct RangedStage {
    /// The indices in the model of the outputs that the stage reads. The values of these outputs are stored after the
    /// values of the inputs.
    reads: Vec<usize>,
    /// The indices in the model of the outputs of the stage.
    outputs: Vec<usize>,
    /// The ranges of the inputs of the stage.
    ranges: Vec<Interval>,
    literals: Vec<RangedLiteral>,
    rules: Vec<RangedRule>,
    own: Vec<RangedOutput>,
    least_strength: f64,
    strengths: usize,
}

/// A rule, or the part of a rule whose consequents have the same hedges.
#[derive(Debug, Clone)]
struct RangedRule {
    draft: IndexedRule,
    and: Conjunction,
    or: Disjunction,
    activation: Activation,
}

#[derive(Debug, Clone)]
struct RangedOutput {
    enclosing: EnclosureMethod,
    /// The index of the first firing strength.
    first: usize,
    /// The offset of each term's firing strengths from the first one.
    offsets: Vec<usize>,
    /// The constant, linear function or formula of each term; empty unless the output is a Takagi-Sugeno output.
    numbers: Vec<MembershipFunction>,
    when_no_rule_fires: NoRuleFires,
    range: Interval,
    clamps: bool,
    /// The names of the inputs of the stage, which formulas read.
    names: Vec<alloc::string::String>,
}

/// The working memory of a stage.
#[derive(Debug)]
pub(super) struct RangedScratch {
    values: Vec<Interval>,
    pub(super) degrees: Vec<(f64, f64)>,
    stack: Vec<(f64, f64)>,
    of_rules: Vec<(f64, f64)>,
    lower: Vec<f64>,
    upper: Vec<f64>,
    workspace: Workspace,
}

impl RangedScratch {
    /// Returns the number of steps of integrations so far.
    pub(super) fn steps(&self) -> u64 {
        self.workspace.steps.taken
    }
}

impl RangedStage {
    pub(super) fn new(stage: &chain::Stage<'_>) -> Self {
        let model = &*stage.model;
        let without_sets = without_sets(model);
        let compiler = Compiler::new(&without_sets);
        let mut drafts = compiler.drafts();
        let mut first = 0;
        let mut own = Vec::new();
        for (index, output) in model.outputs.iter().enumerate() {
            let compiled = compiler.output(index, &without_sets.outputs[index], first, &mut drafts);
            first = compiled.strengths.end;
            own.push(RangedOutput::new(
                model,
                output,
                compiled.strengths.start,
                compiled.offsets,
            ));
        }
        let literals = compiler.literals.keys();
        let literals = literals.map(|(input, term, hedges)| {
            let term = term.and_then(|term| model.inputs.get(*input)?.terms.get(term));
            RangedLiteral::new(*input, term.cloned(), hedges.clone())
        });
        let firing = FiringOperators::of(model);
        let rule = |draft: IndexedRule| {
            let block = firing
                .blocks
                .iter()
                .find(|block| block.index == draft.block);
            let (operators, activation) = match block {
                None => ((firing.and, firing.or), Activation::General),
                Some(block) => (block.operators, block.activation),
            };
            RangedRule {
                draft,
                and: operators.0,
                or: operators.1,
                activation,
            }
        };
        RangedStage {
            reads: stage.reads.clone(),
            outputs: stage.outputs.clone(),
            ranges: model
                .inputs
                .iter()
                .map(|input| Interval::new(input.low, input.high))
                .collect(),
            literals: literals.collect(),
            rules: drafts.into_iter().map(rule).collect(),
            own,
            least_strength: model.least_strength,
            strengths: first,
        }
    }

    /// Returns the indices in the model of the outputs of the stage.
    pub(super) fn outputs(&self) -> &[usize] {
        &self.outputs
    }

    /// Adds the corners of the terms that the rules of an output read. Returns an upper bound of the total of the firing
    /// strengths that count as 0 although they are not, divided by the least weight of a rule. `None` unless the firing
    /// strengths are linear along each input between corners, and the strengths of a term are summed.
    pub(super) fn linear(&self, output: usize, corners: &mut [Vec<f64>]) -> Option<f64> {
        let output = self.own.get(output)?;
        let strengths = output.first..output.first + output.offsets.last()?;
        let mut found = Vec::new();
        let (mut count, mut least_weight) = (0_u32, 1.0_f64);
        for rule in &self.rules {
            let own = |action: &&Action| strengths.contains(&(action.strength as usize));
            let actions: Vec<&Action> = rule.draft.actions.iter().filter(own).collect();
            if actions.is_empty() || rule.draft.weight <= 0.0 {
                continue;
            }
            let literals = rule.draft.literals.as_ref()?;
            let is_product = rule.and == Conjunction::Product || literals.len() < 2;
            let is_plain = rule.draft.hedges.is_empty() && rule.activation == Activation::General;
            if !is_product || !is_plain || actions.iter().any(|action| action.sums == 0) {
                return None;
            }
            for literal in literals {
                let literal = self.literals.get(*literal as usize)?;
                found.push((literal.input, literal.corners()?));
            }
            count += 1;
            least_weight = least_weight.min(rule.draft.weight);
        }
        for (input, of_term) in found {
            corners.get_mut(input)?.extend(of_term);
        }
        // The factor is 2 because strengths below the least strength count as 0 both at a vertex and elsewhere.
        Some(2.0 * f64::from(count) * self.least_strength / least_weight)
    }

    pub(super) fn scratch(&self) -> RangedScratch {
        let cuts = self.own.iter().map(|output| output.enclosing.cuts());
        let cuts = 5 * self.strengths + cuts.max().unwrap_or(0);
        RangedScratch {
            values: Vec::new(),
            degrees: Vec::new(),
            stack: Vec::new(),
            of_rules: Vec::new(),
            lower: vec![0.0; self.strengths],
            upper: vec![0.0; self.strengths],
            workspace: Workspace::new(self.strengths, cuts).with_lines(),
        }
    }

    /// Encloses the outputs of the stage for inputs inside their ranges. `known` has an element per output of the model.
    pub(super) fn enclose(
        &self,
        inputs: &[Interval],
        scratch: &mut RangedScratch,
        known: &mut [OutputBounds],
    ) {
        scratch.values.clear();
        scratch.values.extend_from_slice(inputs);
        let mut may_be_unknown = false;
        for (read, range) in self.reads.iter().zip(self.ranges.iter().skip(inputs.len())) {
            let Some(read) = known.get(*read) else {
                return;
            };
            may_be_unknown |= read.may_be_undefined;
            let Some(values) = read.values else {
                for output in &self.outputs {
                    if let Some(known) = known.get_mut(*output) {
                        *known = OutputBounds::UNDEFINED;
                    }
                }
                return;
            };
            scratch.values.push(values.within(*range));
        }
        self.fire(scratch);
        for (own, output) in self.own.iter().zip(&self.outputs) {
            if let Some(known) = known.get_mut(*output) {
                *known = own.enclose(scratch);
                known.may_be_undefined |= may_be_unknown;
            }
        }
    }

    /// Increases the score of each input by the widths of the degree intervals of its terms.
    pub(super) fn scores(&self, scratch: &RangedScratch, scores: &mut [f64]) {
        for (literal, (low, high)) in self.literals.iter().zip(&scratch.degrees) {
            if let Some(score) = scores.get_mut(literal.input) {
                *score += high - low;
            }
        }
    }

    /// Computes the bounds of the firing strengths.
    fn fire(&self, scratch: &mut RangedScratch) {
        let RangedScratch {
            values,
            degrees,
            stack,
            of_rules,
            lower,
            upper,
            ..
        } = scratch;
        degrees.clear();
        degrees.extend(self.literals.iter().map(|literal| {
            let value = values.get(literal.input);
            value.map_or((0.0, 1.0), |value| literal.degrees(value.low, value.high))
        }));
        of_rules.clear();
        of_rules.extend(self.rules.iter().map(|rule| rule.strength(degrees, stack)));
        lower.fill(0.0);
        upper.fill(0.0);
        for (index, rule) in self.rules.iter().enumerate() {
            let (low, high) = self.activated(index, rule, of_rules);
            let low = if low < self.least_strength * (1.0 + NEAR) {
                0.0
            } else {
                low
            };
            let high = if high < self.least_strength * (1.0 - NEAR) {
                0.0
            } else {
                high
            };
            let hedged = |strength: f64| {
                let hedges = rule.draft.hedges.iter();
                hedges.fold(strength, |strength, hedge| hedge.of(strength))
            };
            for action in &rule.draft.actions {
                for (strengths, strength) in
                    [(&mut *lower, hedged(low)), (&mut *upper, hedged(high))]
                {
                    if let Some(all) = strengths.get_mut(action.strength as usize) {
                        *all = match action.sums {
                            0 => larger(*all, strength),
                            _ => *all + strength,
                        };
                    }
                }
            }
        }
    }

    /// Returns the bounds of the strength of a rule after the activation method of its block was applied.
    fn activated(&self, index: usize, rule: &RangedRule, of_rules: &[(f64, f64)]) -> (f64, f64) {
        let Some(&(low, high)) = of_rules.get(index) else {
            return (0.0, 1.0);
        };
        match rule.activation {
            Activation::General => (low, high),
            Activation::Proportional => {
                // Each rule counts once, even if hedges split it into several programs.
                let (mut others, mut latest) = ((0.0, 0.0), None);
                for (other, strength) in self.rules.iter().zip(of_rules) {
                    let again = latest.replace(other.draft.rule) == Some(other.draft.rule);
                    let is_other = other.draft.block == rule.draft.block
                        && other.draft.rule != rule.draft.rule;
                    if is_other && !again {
                        others = (others.0 + strength.0, others.1 + strength.1);
                    }
                }
                let part =
                    |own: f64, others: f64| if own > 0.0 { own / (own + others) } else { 0.0 };
                (part(low, others.1), part(high, others.0))
            }
            // The rule may be selected or not.
            Activation::First { .. }
            | Activation::Last { .. }
            | Activation::Highest { .. }
            | Activation::Lowest { .. }
            | Activation::Threshold { .. } => (0.0, high),
        }
    }
}

impl RangedRule {
    /// Returns the bounds of the firing strength of the rule.
    fn strength(&self, degrees: &[(f64, f64)], stack: &mut Vec<(f64, f64)>) -> (f64, f64) {
        stack.clear();
        for AntecedentStep { op, literal } in &self.draft.steps {
            let degree = degrees.get(*literal as usize).copied();
            let degree = degree.unwrap_or((0.0, 1.0));
            let and = |a: (f64, f64), b: (f64, f64)| (self.and.of(a.0, b.0), self.and.of(a.1, b.1));
            let or = |a: (f64, f64), b: (f64, f64)| (self.or.of(a.0, b.0), self.or.of(a.1, b.1));
            let top = match *op {
                Op::PUSH => degree,
                _ => {
                    let top = stack.pop().unwrap_or((0.0, 1.0));
                    match *op {
                        Op::AND_LITERAL => and(top, degree),
                        Op::OR_LITERAL => or(top, degree),
                        Op::AND => and(stack.pop().unwrap_or((0.0, 1.0)), top),
                        Op::OR => or(stack.pop().unwrap_or((0.0, 1.0)), top),
                        _ => (1.0 - top.1, 1.0 - top.0),
                    }
                }
            };
            stack.push((
                smaller(1.0, larger(0.0, top.0)),
                smaller(1.0, larger(0.0, top.1)),
            ));
        }
        let (low, high) = stack.pop().unwrap_or((0.0, 1.0));
        (self.draft.weight * low, self.draft.weight * high)
    }
}

impl RangedOutput {
    fn new(model: &Model, output: &Output, first: usize, offsets: Vec<usize>) -> Self {
        let operators = model.operators_of_output(output);
        let joint = ConsequentOperators {
            implication: operators.implication,
            aggregation: operators.aggregation,
        };
        let numbers = output.variable.terms.iter();
        let numbers = numbers.filter(|_| output.defuzzifier.takes_numbers());
        RangedOutput {
            enclosing: EnclosureMethod::new(output, joint),
            first,
            offsets,
            numbers: numbers
                .map(|term| term.membership_function.clone())
                .collect(),
            when_no_rule_fires: output.when_no_rule_fires,
            range: Interval::new(output.variable.low, output.variable.high),
            clamps: output.clamp,
            names: model
                .inputs
                .iter()
                .map(|input| input.name.clone())
                .collect(),
        }
    }

    fn enclose(&self, scratch: &mut RangedScratch) -> OutputBounds {
        let RangedScratch {
            values,
            lower,
            upper,
            workspace,
            ..
        } = scratch;
        let count = self.offsets.last().copied().unwrap_or(0);
        let of = |strengths: &'_ [f64]| -> Vec<f64> {
            let own = strengths.get(self.first..self.first + count);
            own.unwrap_or_default().to_vec()
        };
        let (lower, upper) = (of(lower), of(upper));
        let strengths = |strengths| Strengths {
            strengths,
            offsets: &self.offsets,
        };
        let mut may_have_no_number = false;
        let mut numbers: Vec<(f64, f64)> = Vec::with_capacity(self.numbers.len());
        for (term, number) in self.numbers.iter().enumerate() {
            let span = self.number(number, values);
            let fires = strengths(&upper)
                .of(term)
                .iter()
                .any(|strength| *strength > 0.0);
            may_have_no_number |= fires && span.may_be_undefined;
            numbers.push((span.low, span.high));
        }
        let number = |term: usize| {
            let number = numbers.get(term).copied();
            number.unwrap_or((f64::NEG_INFINITY, f64::INFINITY))
        };
        let enclosed =
            self.enclosing
                .interval(strengths(&lower), strengths(&upper), number, workspace);
        let fallback = match self.when_no_rule_fires {
            NoRuleFires::Value(value) | NoRuleFires::Previous(Some(value)) => Some(value),
            NoRuleFires::Undefined | NoRuleFires::Error | NoRuleFires::Previous(None) => None,
        };
        let is_certain =
            enclosed.is_some_and(|enclosed| enclosed.is_certain) && !may_have_no_number;
        let mut values = enclosed.map(|enclosed| {
            let values = Interval::new(enclosed.low, enclosed.high);
            if self.clamps {
                values.within(self.range)
            } else {
                values
            }
        });
        if !is_certain && let Some(fallback) = fallback {
            let of_fallback = Interval::new(fallback, fallback);
            values = Some(values.map_or(of_fallback, |values| values.hull(of_fallback)));
        }
        OutputBounds {
            values,
            may_be_undefined: !is_certain && fallback.is_none(),
        }
    }

    /// Returns the range of the numbers that a term of a Takagi-Sugeno output yields for values in the given intervals.
    fn number(&self, function: &MembershipFunction, values: &[Interval]) -> Span {
        let value = |name: &str| {
            let index = self.names.iter().position(|known| known == name);
            let value = index.and_then(|index| values.get(index));
            value.map_or(Span::between(f64::NEG_INFINITY, f64::INFINITY), |value| {
                Span::between(value.low, value.high)
            })
        };
        match function {
            MembershipFunction::Constant { value } => Span::between(*value, *value),
            MembershipFunction::Singleton { at } => Span::between(*at, *at),
            MembershipFunction::Linear {
                coefficients,
                constant,
            } => {
                let (mut low, mut high) = (*constant, *constant);
                for (name, factor) in coefficients {
                    let value = value(name);
                    let (one, other) = (factor * value.low, factor * value.high);
                    low += smaller(one, other);
                    high += larger(one, other);
                }
                Span::between(low, high)
            }
            MembershipFunction::Function { formula } => formula::range(formula, value),
            _ => Span::between(f64::NEG_INFINITY, f64::INFINITY),
        }
    }
}

/// Returns a model whose fuzzy outputs have singletons in place of their terms. Its firing strengths are therefore
/// combined only if the operators allow it for all membership functions.
fn without_sets(model: &Model) -> Model {
    let mut changed = model.clone();
    for output in &mut changed.outputs {
        if output.defuzzifier.is_weighted() {
            continue;
        }
        output.defuzzifier = Defuzzifier::Centroid;
        let at = output.variable.low;
        for term in &mut output.variable.terms {
            term.membership_function = MembershipFunction::Singleton { at };
            (term.height, term.lower) = (1.0, None);
        }
    }
    changed
}
