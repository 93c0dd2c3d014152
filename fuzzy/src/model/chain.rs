//! Chains: outputs that are read by the rules of other outputs.
//!
//! An output reads another output if one of its rules names that output in its condition, or if one of its linear
//! functions or formulas does. A model in which outputs read others is evaluated in stages. The first stage has the
//! outputs that read no other output; each later stage adds one output. A stage is a model of its own: its inputs are
//! those of the whole model and the outputs that it reads.

use alloc::{
    borrow::Cow,
    collections::{BTreeMap, BTreeSet},
    format,
    string::String,
    vec,
    vec::Vec,
};
use core::ops::Range;

use super::{Activation, Model, Rule, Variable, concludes, document::Spans};
use crate::diagnostic::Diagnostic;

/// A reference from one output to another output that it reads.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct OutputReference {
    /// The index of the output that is read.
    pub(crate) output: usize,
    /// The index of the first rule that reads this output; `None` if only a linear function or a
    /// formula does.
    pub(crate) rule: Option<usize>,
    /// The span of the output's name in the text.
    pub(crate) span: Range<usize>,
}

/// A part of a model that is evaluated in one pass.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Stage<'m> {
    /// The model of this stage. Its inputs are those of the whole model, followed by `reads`.
    pub(crate) model: Cow<'m, Model>,
    /// The outputs that the stage reads, as ascending indices into the whole model.
    pub(crate) reads: Vec<usize>,
    /// The outputs of the stage, as indices into the whole model.
    pub(crate) outputs: Vec<usize>,
    /// The rules of the stage, as indices into the whole model.
    pub(crate) rules: Vec<usize>,
}

impl Model {
    /// Returns the other outputs that an output reads, in the conditions of its rules or in its linear functions and
    /// formulas.
    ///
    /// # Example: the speed of a fan depends on comfort, which is an output too
    /// ```
    /// let model: fuzzy::Model = "
    /// fuzzy: 1
    /// name: fan
    /// inputs: {heat: {range: [0, 40], partition: [low, high]}}
    /// outputs:
    ///   comfort: {range: [0, 1], partition: [poor, good]}
    ///   speed: {range: [0, 9], partition: [slow, fast]}
    /// rules:
    ///   - IF heat IS low THEN comfort IS good
    ///   - IF heat IS high THEN comfort IS poor
    ///   - IF comfort IS good THEN speed IS slow
    ///   - IF comfort IS poor THEN speed IS fast
    /// ".parse()?;
    /// assert_eq!(model.reads("speed"), ["comfort"]);
    /// assert!(model.reads("comfort").is_empty());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn reads(&self, output: &str) -> Vec<&str> {
        let named = |o: &super::Output| o.variable.name == output;
        let reads = self.outputs.iter().position(named);
        let reads =
            reads.and_then(|index| reads_of_all(self, &Spans::default()).into_iter().nth(index));
        let mut reads: Vec<usize> = reads.iter().flatten().map(|read| read.output).collect();
        reads.sort_unstable();
        let names = reads.iter().filter_map(|read| self.outputs.get(*read));
        names.map(|output| output.variable.name.as_str()).collect()
    }

    /// Returns the indices of the outputs that no other output reads: the ends of chains and the outputs outside
    /// chains.
    pub fn last_outputs(&self) -> Vec<usize> {
        let read: BTreeSet<usize> = reads_of_all(self, &Spans::default())
            .iter()
            .flatten()
            .map(|read| read.output)
            .collect();
        (0..self.outputs.len())
            .filter(|output| !read.contains(output))
            .collect()
    }

    /// Returns the index of the output whose values are measured in data: the only output that no other output reads,
    /// or, if there are several, the only one of them without rules. `None` if there is no such output.
    pub fn measured_output(&self) -> Option<usize> {
        let last = self.last_outputs();
        let is_bare = |index: &&usize| {
            let output = self.outputs.get(**index);
            output.is_some_and(|output| !self.rules.iter().any(|rule| concludes(rule, output)))
        };
        match last[..] {
            [one] => Some(one),
            _ => {
                let mut bare = last.iter().filter(is_bare);
                bare.next().filter(|_| bare.next().is_none()).copied()
            }
        }
    }

    /// Returns all variables: first the inputs, then the variables of the outputs.
    pub fn variables(&self) -> impl Iterator<Item = &Variable> + Clone {
        let outputs = self.outputs.iter().map(|output| &output.variable);
        self.inputs.iter().chain(outputs)
    }

    /// Returns the variables whose values are measured in data: the inputs, then the measured output.
    pub fn measured_variables(&self) -> impl Iterator<Item = &Variable> {
        let output = self.measured_output();
        let output = output.and_then(|output| self.outputs.get(output));
        let inputs = self.inputs.iter();
        inputs.chain(output.map(|output| &output.variable))
    }

    /// Returns the inputs that an output depends on: those that its rules, linear functions and formulas read, and the
    /// inputs on which the outputs that it reads depend. All other inputs change neither its value nor its coverage.
    ///
    /// # Example: an alarm that is independent of the speed of a fan
    /// ```
    /// let model: fuzzy::Model = "
    /// fuzzy: 1
    /// name: fan
    /// inputs:
    ///   heat: {range: [0, 40], partition: [low, high]}
    ///   voltage: {range: [0, 12], partition: [poor, good]}
    /// outputs:
    ///   speed: {range: [0, 9], partition: [slow, fast]}
    ///   alarm: {range: [0, 1], partition: [no, yes]}
    /// rules:
    ///   - IF heat IS high THEN speed IS fast
    ///   - IF voltage IS poor THEN alarm IS yes
    /// ".parse()?;
    /// assert_eq!(model.inputs_of("speed"), ["heat"]);
    /// assert_eq!(model.inputs_of("alarm"), ["voltage"]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn inputs_of(&self, output: &str) -> Vec<&str> {
        let index = |name: &str| self.outputs.iter().position(|o| o.variable.name == name);
        let mut names: BTreeMap<usize, BTreeSet<&str>> = BTreeMap::new();
        visit_reads(self, |by, name, _| {
            names.entry(by).or_default().insert(name);
        });
        let (mut read, mut next) = (BTreeSet::new(), vec![output]);
        while let Some(by) = next.pop() {
            let new = index(by)
                .and_then(|by| names.get(&by))
                .into_iter()
                .flatten();
            next.extend(new.filter(|name| read.insert(**name)));
        }
        let inputs = self.inputs.iter().map(|input| input.name.as_str());
        inputs.filter(|name| read.contains(name)).collect()
    }
}

/// The position at which an output reads a variable.
enum ReferencePosition<'m> {
    /// In the condition of a rule: the index of the rule and the span of the name.
    Condition(usize, &'m Range<usize>),
    /// In the linear function or formula of a term: the index of the term, and the index of the name in it.
    Term(usize, usize),
}

/// Calls `visit` for every variable that an output reads, with the index of the output, the name of the variable and
/// the position.
fn visit_reads<'m>(model: &'m Model, mut visit: impl FnMut(usize, &'m str, ReferencePosition<'m>)) {
    let index = |name: &str| model.outputs.iter().position(|o| o.variable.name == name);
    let together = concluded_together(model);
    for (number, rule) in model.rules.iter().enumerate() {
        if !model.is_enabled(rule) {
            continue;
        }
        let concluded = rule.rule.consequents.iter();
        let mut concluded: Vec<usize> = concluded.filter_map(|c| index(&c.output.text)).collect();
        concluded.extend(together.get(&rule.block).into_iter().flatten());
        rule.rule.condition.visit(&mut |proposition| {
            let name = &proposition.variable;
            for &by in &concluded {
                visit(
                    by,
                    &name.text,
                    ReferencePosition::Condition(number, &name.span),
                );
            }
        });
    }
    for (by, output) in model.outputs.iter().enumerate() {
        // In a fuzzy output, a formula reads only its own variable, which is not a reference to another output.
        if !output.defuzzifier.takes_numbers() {
            continue;
        }
        for (number, term) in output.variable.terms.iter().enumerate() {
            for (i, name) in term.membership_function.reads().into_iter().enumerate() {
                visit(by, name, ReferencePosition::Term(number, i));
            }
        }
    }
}

/// Returns, for each output, the other outputs that it reads, each once.
pub(crate) fn reads_of_all(model: &Model, spans: &Spans) -> Vec<Vec<OutputReference>> {
    let index = |name: &str| model.outputs.iter().position(|o| o.variable.name == name);
    let mut reads: Vec<Vec<OutputReference>> = vec![Vec::new(); model.outputs.len()];
    visit_reads(model, |by, name, place| {
        let (Some(output), Some(reads)) = (index(name), reads.get_mut(by)) else {
            return;
        };
        if reads.iter().any(|known| known.output == output) {
            return;
        }
        let (rule, span) = match place {
            ReferencePosition::Condition(rule, span) => (Some(rule), span.clone()),
            ReferencePosition::Term(term, i) => {
                let terms = spans.outputs.get(by).map(|spans| &spans.terms);
                let span = terms.and_then(|terms| terms.get(term)?.parameters.get(i).cloned());
                (None, span.unwrap_or_default())
            }
        };
        reads.push(OutputReference { output, rule, span });
    });
    reads
}

/// Returns, for each block with an activation method, the outputs that its rules conclude. The method selects the
/// rules that fire by comparing all rules of the block, so each of these outputs reads every variable that any of
/// the rules reads.
fn concluded_together(model: &Model) -> BTreeMap<usize, Vec<usize>> {
    let mut together: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for rule in model.rules.iter().filter(|rule| is_selected(model, rule)) {
        let outputs = model.outputs.iter().enumerate();
        let outputs = outputs.filter(|(_, output)| concludes(rule, output));
        let outputs = outputs.map(|(index, _)| index);
        together.entry(rule.block).or_default().extend(outputs);
    }
    for outputs in together.values_mut() {
        outputs.sort_unstable();
        outputs.dedup();
    }
    together
}

/// Returns whether an activation method determines the strength with which a rule fires.
fn is_selected(model: &Model, rule: &Rule) -> bool {
    model.is_enabled(rule) && model.activation_of(rule) != Activation::General
}

/// Returns the outputs in an order in which each one follows those it reads. If there are cycles, returns these as the
/// error: in each cycle, every output reads the next one, and the last one reads the first.
pub(crate) fn order(reads: &[Vec<OutputReference>]) -> Result<Vec<usize>, Vec<Vec<usize>>> {
    let (mut order, mut cycles) = (Vec::new(), Vec::new());
    let mut placed = vec![false; reads.len()];
    let open = |output: usize, placed: &[bool]| {
        let mut reads = reads.get(output)?.iter().map(|read| read.output);
        reads.find(|read| !placed[*read])
    };
    while let Some(first) = placed.iter().position(|placed| !placed) {
        let ready = (first..reads.len()).find(|i| !placed[*i] && open(*i, &placed).is_none());
        if let Some(ready) = ready {
            placed[ready] = true;
            order.push(ready);
            continue;
        }
        // Each remaining output reads another remaining output, so following these references leads into a cycle.
        let mut path = vec![first];
        while let Some(next) = path.last().and_then(|last| open(*last, &placed)) {
            if let Some(start) = path.iter().position(|output| *output == next) {
                path.drain(..start);
                break;
            }
            path.push(next);
        }
        for output in &path {
            placed[*output] = true;
        }
        cycles.push(path);
    }
    if cycles.is_empty() {
        Ok(order)
    } else {
        Err(cycles)
    }
}

/// Returns an error for each cycle of outputs that read one another; the message lists the whole cycle.
pub(crate) fn cycle_errors(model: &Model, spans: &Spans) -> Vec<Diagnostic> {
    let reads = reads_of_all(model, spans);
    let name = |output: usize| model.outputs.get(output).map(|o| &o.variable.name);
    let step = |by: usize, output: usize| {
        let mut reads = reads.get(by)?.iter();
        let read = reads.find(|read| read.output == output)?;
        let rule = read
            .rule
            .map_or(String::new(), |rule| format!(" in rule {}", rule + 1));
        Some(CycleStep {
            text: format!("`{}` reads `{}`{rule}", name(by)?, name(output)?),
            name: name(by)?,
            rule: read.rule,
            // If the rule does not conclude the output, an activation method makes the output depend on the rule.
            is_selected: read
                .rule
                .and_then(|rule| model.rules.get(rule))
                .is_some_and(|rule| {
                    model
                        .outputs
                        .get(by)
                        .is_some_and(|output| !concludes(rule, output))
                }),
            span: read.span.clone(),
        })
    };
    let cycles = order(&reads).err().unwrap_or_default().into_iter();
    let cycles = cycles.map(|cycle| {
        let next = cycle.iter().cycle().skip(1);
        let steps = cycle.iter().zip(next);
        let steps = steps.filter_map(|(by, output)| step(*by, *output));
        cycle_error(&steps.collect::<Vec<CycleStep<'_>>>())
    });
    cycles.collect()
}

/// A step of a cycle: an output that reads the next one.
struct CycleStep<'m> {
    text: String,
    /// The output that reads the next one.
    name: &'m str,
    /// The index of the rule that reads it; `None` for a term.
    rule: Option<usize>,
    /// Whether the output depends on the rule only because of an activation method.
    is_selected: bool,
    span: Range<usize>,
}

fn cycle_error(steps: &[CycleStep<'_>]) -> Diagnostic {
    let path: Vec<&str> = steps.iter().map(|step| step.text.as_str()).collect();
    let (message, help) = match steps {
        [
            CycleStep {
                name,
                rule: Some(rule),
                is_selected: true,
                ..
            },
        ] => (
            format!(
                "rule {} reads `{name}`, an output of its own block, but all rules of a block with `activation` are evaluated together",
                rule + 1
            ),
            format!("remove `activation`, or move the rules that read `{name}` into a later block"),
        ),
        [
            CycleStep {
                name,
                rule: Some(rule),
                ..
            },
        ] => (
            format!(
                "an output cannot read itself, but rule {} has `{name}` in its condition and its conclusion",
                rule + 1
            ),
            format!(
                "remove `{name}` from the condition, or use a different output in the conclusion"
            ),
        ),
        [CycleStep { name, .. }] => (
            format!("an output cannot read itself: `{name}`"),
            format!("remove `{name}` from the term that reads it"),
        ),
        steps => {
            let message = format!(
                "circular dependency between outputs: {}",
                path.join(" and ")
            );
            let of_rules = steps.iter().filter(|step| step.rule.is_some()).count();
            let help = match of_rules {
                0 => "to break the cycle, remove one of these outputs from the term that reads it",
                _ if of_rules == steps.len() => {
                    "to break the cycle, remove one of these outputs from a condition, or write a new output in the conclusion of one of these rules"
                }
                _ => {
                    "to break the cycle, remove one of these outputs from the condition or the term that reads it"
                }
            };
            (message, help.into())
        }
    };
    let first = steps.first().map_or(0..0, |step| step.span.clone());
    let finding = Diagnostic::error("circular-outputs", first, message);
    let others = steps.iter().skip(1);
    let finding = others.fold(finding, |finding, step| {
        finding.related(step.span.clone(), step.text.as_str())
    });
    finding.help(help)
}

/// Returns the stages of a model in the order of evaluation: the first one, and the later ones. A model without chains
/// has one stage. Outputs on a cycle are omitted; a valid model has no cycles.
pub(crate) fn stages(model: &Model) -> (Stage<'_>, Vec<Stage<'_>>) {
    let reads = reads_of_all(model, &Spans::default());
    if reads.iter().all(Vec::is_empty) {
        let only = Stage {
            model: Cow::Borrowed(model),
            reads: Vec::new(),
            outputs: (0..model.outputs.len()).collect(),
            rules: (0..model.rules.len()).collect(),
        };
        return (only, Vec::new());
    }
    let order = order(&reads).unwrap_or_default();
    let (mut first, later): (Vec<usize>, Vec<usize>) = order
        .into_iter()
        .partition(|output| reads[*output].is_empty());
    first.sort_unstable();
    let first = stage(model, Vec::new(), first);
    let later = later.into_iter().map(|output| {
        let mut reads: Vec<usize> = reads[output].iter().map(|read| read.output).collect();
        reads.sort_unstable();
        stage(model, reads, Vec::from([output]))
    });
    (first, later.collect())
}

fn stage(model: &Model, reads: Vec<usize>, outputs: Vec<usize>) -> Stage<'_> {
    let of = |indices: &[usize]| {
        let outputs = indices.iter().filter_map(|i| model.outputs.get(*i));
        outputs.cloned().collect::<Vec<_>>()
    };
    let handed_over = of(&reads).into_iter().map(|output| output.variable);
    let inputs: Vec<Variable> = model.inputs.iter().cloned().chain(handed_over).collect();
    let own = of(&outputs);
    let (mut numbers, mut rules) = (Vec::new(), Vec::new());
    // In these blocks, all rules are needed to find those that fire.
    let whole: BTreeSet<usize> = model
        .rules
        .iter()
        .filter(|rule| is_selected(model, rule))
        .filter(|rule| own.iter().any(|output| concludes(rule, output)))
        .map(|rule| rule.block)
        .collect();
    for (number, rule) in model.rules.iter().enumerate() {
        let mut rule = rule.clone();
        rule.rule.consequents.retain(|c| {
            own.iter()
                .any(|output| output.variable.name == c.output.text)
        });
        if !rule.rule.consequents.is_empty() || whole.contains(&rule.block) {
            numbers.push(number);
            rules.push(rule);
        }
    }
    Stage {
        model: Cow::Owned(Model {
            inputs,
            outputs: own,
            rules,
            name: model.name.clone(),
            description: None,
            operators: model.operators,
            activation: model.activation,
            least_strength: model.least_strength,
            blocks: model.blocks.clone(),
            allow: Vec::new(),
            provenance: Vec::new(),
        }),
        reads,
        outputs,
        rules: numbers,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Builds references from indices, in the form that `order` takes.
    fn reads(of_each: &[&[usize]]) -> Vec<Vec<OutputReference>> {
        let read = |output: &usize| OutputReference {
            output: *output,
            rule: None,
            span: 0..0,
        };
        let all = of_each.iter().map(|reads| reads.iter().map(read).collect());
        all.collect()
    }

    #[test]
    fn each_output_comes_after_those_it_reads() {
        assert_eq!(order(&reads(&[&[2], &[], &[1]])), Ok(vec![1, 2, 0]));
        assert_eq!(order(&reads(&[&[], &[], &[]])), Ok(vec![0, 1, 2]));
        assert_eq!(order(&[]), Ok(vec![]));
    }

    #[test]
    fn an_output_depends_on_what_its_rules_lines_outputs_and_blocks_read() {
        let variables = "
fuzzy: 1
name: parts
inputs:
  a: {range: [0, 1], partition: [low, high]}
  b: {range: [0, 1], partition: [low, high]}
  c: {range: [0, 1], partition: [low, high]}
outputs:
  x: {range: [0, 1], partition: [low, high]}
  y: {range: [0, 9], terms: {line: {linear: {b: 2, constant: 1}}}, defuzzifier: weighted_average}
  z: {range: [0, 1], partition: [low, high]}
";
        let rules =
            "[IF a IS low THEN x IS low, IF x IS low THEN y IS line, IF c IS low THEN z IS low]";
        let inputs_of = |text: String| {
            let model: Model = text.parse().unwrap();
            ["x", "y", "z"].map(|output| model.inputs_of(output).concat())
        };
        let plain = inputs_of(format!("{variables}rules: {rules}\n"));
        assert_eq!(plain, ["a", "ab", "c"]);
        // The activation method compares both rules, so `x` and `z` depend on the inputs of both.
        let rules = "[IF a IS low THEN x IS low, IF c IS low THEN z IS low]";
        let selected = inputs_of(format!(
            "{variables}activation: {{first: 1}}\nrules: {rules}\n"
        ));
        assert_eq!(selected, ["ac", "b", "ac"]);
        let unknown = format!("{variables}rules: {rules}\n");
        let model: Model = unknown.parse().unwrap();
        assert!(model.inputs_of("nothing").is_empty());
    }

    #[test]
    fn every_cycle_is_found_once() {
        assert_eq!(order(&reads(&[&[0]])), Err(vec![vec![0]]));
        // Output 0 reads a cycle but is not on one; 3 and 4 are a second cycle.
        let two = reads(&[&[1], &[2], &[1], &[4], &[3]]);
        assert_eq!(order(&two), Err(vec![vec![1, 2], vec![3, 4]]));
    }
}
