//! Whether a model means something: all that keeps it from being evaluated on every finite input, or from being written
//! and read back.
//!
//! This is the only place that decides it. Reading a rule set, checking one and compiling one ask the same function.

use alloc::{
    collections::{BTreeMap, BTreeSet},
    format,
    string::String,
    vec::Vec,
};
use core::ops::Range;

use crate::{
    defuzzify::Defuzzify,
    diagnostic::{Diagnostic, duplicate, nearest, suggest},
    model::{
        Defuzzifier, Formula, MembershipFunction, Model, NoRuleFires, Output, Rule, Variable,
        chain::circles,
        document::{RuleSpans, Spans, TermSpans, VariableSpans},
    },
    rule::{Condition, DEEPEST_NESTING, Hedge, Name, Proposition},
};

mod blocks;

/// Inputs and outputs of a model.
const MOST_VARIABLES: usize = 1000;
/// Terms of one input or output.
const MOST_TERMS: usize = 1000;
/// Terms of all inputs and outputs.
const MOST_TERMS_IN_ALL: usize = 10_000;
/// Rules of a model.
const MOST_RULES: usize = 100_000;
/// Errors that are told of a model; what follows is not looked at.
const MOST_FINDINGS: usize = 1000;

/// Products of degrees and distances within a narrower range lose their digits.
const NARROWEST_RANGE: f64 = 1e-250;

/// More samples than this add no accuracy and make an evaluation hang.
const MOST_SAMPLES: usize = 10_000_000;

/// All errors of a model, in the order of its parts; none if it compiles. `spans` says where its parts stand in a text;
/// it is empty for a model made in code, and the findings then have no position.
///
/// # Example
/// ```
/// use fuzzy::{Model, format::Spans, model::{Output, Variable}};
///
/// let model = Model::builder("fan")
///     .output(Output::new(Variable::new("speed", 0.0, 9.0).partition(["slow", "fast"])))
///     .rule("IF heat IS high THEN speed IS fast".parse()?)
///     .build();
/// let findings = fuzzy::validate(&model, &Spans::default());
/// assert_eq!(findings[0].message, "rule 1: there is no input `heat`");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
pub fn validate(model: &Model, spans: &Spans) -> Vec<Diagnostic> {
    if let Some(finding) = too_large(model, spans) {
        return Vec::from([finding]);
    }
    let inputs = model.inputs.iter().zip(&spans.inputs);
    let outputs = model.outputs.iter().map(|output| &output.variable);
    let unread = inputs
        .chain(outputs.zip(&spans.outputs))
        .filter(|(_, spans)| spans.terms_unread)
        .map(|(variable, _)| variable.name.as_str());
    let mut validator = Validator {
        model,
        // Of two that share a name the first one counts.
        inputs: model
            .inputs
            .iter()
            .rev()
            .map(|v| (v.name.as_str(), v))
            .collect(),
        outputs: model
            .outputs
            .iter()
            .rev()
            .map(|o| (o.variable.name.as_str(), &o.variable))
            .collect(),
        unread: unread.collect(),
        findings: Vec::new(),
    };
    validator.names(spans);
    let no_spans = VariableSpans::default();
    for (i, input) in model.inputs.iter().enumerate() {
        let spans = spans.inputs.get(i).unwrap_or(&no_spans);
        validator.variable(&format!("input `{}`", input.name), input, spans);
        validator.terms_are_sets(input, spans);
    }
    if model.outputs.is_empty() {
        validator.findings.push(
            Diagnostic::error(
                "missing-key",
                spans.outputs_key.clone(),
                "the rule set has no output",
            )
            .help("write a name, a range and terms for at least one output"),
        );
    }
    for (i, output) in model.outputs.iter().enumerate() {
        validator.output(output, spans.outputs.get(i).unwrap_or(&no_spans));
    }
    if model.rules.is_empty() && !spans.rules_unread {
        validator.findings.push(
            Diagnostic::error(
                "no-rules",
                spans.rules_key.clone(),
                "the rule set has no rules",
            )
            .help("write rules: `- IF input IS term THEN output IS term`"),
        );
    }
    for (i, rule) in model.rules.iter().enumerate() {
        let first = validator.findings.len();
        if first >= MOST_FINDINGS {
            let message = format!("rule {} and those after it are not looked at", i + 1);
            let here = spans.rules.get(i).map_or(0..0, |rule| rule.whole.clone());
            let help = format!("correct the {first} errors above first");
            validator.error("too-many-errors", &here, message, &help);
            break;
        }
        let spans = spans.rules.get(i);
        validator.rule(
            &format!("rule {}", i + 1),
            rule,
            spans.unwrap_or(&RuleSpans::default()),
        );
        if spans.is_none() {
            // Without a text the message says which rule it is about.
            for finding in validator.findings.iter_mut().skip(first) {
                finding.message = format!("rule {}: {}", i + 1, finding.message);
            }
        }
    }
    validator.blocks(spans);
    validator.findings.extend(circles(model, spans));
    validator.findings
}

/// What a model has too much of: with more its analysis takes minutes, and nobody means it.
fn too_large(model: &Model, spans: &Spans) -> Option<Diagnostic> {
    let outputs = model.outputs.iter().map(|output| &output.variable);
    let variables = || model.inputs.iter().chain(outputs.clone());
    let all_spans = || spans.inputs.iter().chain(&spans.outputs);
    let refuse = |here: Option<Range<usize>>, count: usize, most: usize, what: &str| {
        (count > most).then(|| {
            let message = format!("{count} {what} are more than {most}");
            let here = here.unwrap_or_default();
            Diagnostic::error("too-large", here, message).help("split the rule set into several")
        })
    };
    let name = |index: usize| all_spans().nth(index).map(|spans| spans.name.clone());
    let most = variables().enumerate().max_by_key(|(_, v)| v.terms.len());
    let (widest, terms, of) = most.map_or((0, 0, ""), |(i, v)| (i, v.terms.len(), &*v.name));
    let in_all = variables().map(|v| v.terms.len()).sum();
    let rules = model.rules.len();
    refuse(
        name(0),
        variables().count(),
        MOST_VARIABLES,
        "inputs and outputs",
    )
    .or_else(|| refuse(name(widest), terms, MOST_TERMS, &format!("terms of `{of}`")))
    .or_else(|| refuse(name(0), in_all, MOST_TERMS_IN_ALL, "terms"))
    .or_else(|| refuse(Some(spans.rules_key.clone()), rules, MOST_RULES, "rules"))
}

struct Validator<'m> {
    model: &'m Model,
    inputs: BTreeMap<&'m str, &'m Variable>,
    outputs: BTreeMap<&'m str, &'m Variable>,
    /// The inputs and outputs whose terms could not be read.
    unread: Vec<&'m str>,
    findings: Vec<Diagnostic>,
}

impl<'m> Validator<'m> {
    fn error(&mut self, code: &'static str, span: &Range<usize>, message: String, help: &str) {
        let finding = Diagnostic::error(code, span.clone(), message);
        self.findings.push(finding.help(help));
    }

    /// Variables and terms without a name, and those that share one.
    fn names(&mut self, spans: &Spans) {
        let outputs = self.model.outputs.iter().map(|output| &output.variable);
        let variables = self.model.inputs.iter().zip(spans_of(&spans.inputs));
        let variables = variables.chain(outputs.zip(spans_of(&spans.outputs)));
        let mut seen: BTreeMap<&str, Range<usize>> = BTreeMap::new();
        for (variable, spans) in variables {
            let here = spans.map_or(0..0, |spans| spans.name.clone());
            if variable.name.is_empty() {
                let message = String::from("the variable has no name");
                self.error(
                    "empty-name",
                    &here,
                    message,
                    "write a name before the colon",
                );
            }
            if let Some(first) = seen.insert(&variable.name, here.clone()) {
                let finding = duplicate("variable", &variable.name, "the rule set", here, first);
                self.findings.push(finding);
            }
            let mut terms: BTreeMap<&str, Range<usize>> = BTreeMap::new();
            for (i, term) in variable.terms.iter().enumerate() {
                let here = spans.and_then(|spans| spans.terms.get(i));
                let here = here.map_or(0..0, |term| term.name.clone());
                if term.name.is_empty() {
                    let message = format!("a term of `{}` has no name", variable.name);
                    self.error("empty-name", &here, message, "write a name for the term");
                }
                if let Some(first) = terms.insert(&term.name, here.clone()) {
                    let owner = format!("`{}`", variable.name);
                    self.findings
                        .push(duplicate("term", &term.name, &owner, here, first));
                }
            }
        }
    }

    /// The range, the membership functions and the heights of an input or output; `what` names it in messages.
    fn variable(&mut self, what: &str, variable: &Variable, spans: &VariableSpans) {
        if !spans.range_unread {
            self.range(what, variable, or(&spans.range, &spans.name));
        }
        let no_spans = TermSpans::default();
        for (i, term) in variable.terms.iter().enumerate() {
            let term_spans = spans.terms.get(i).unwrap_or(&no_spans);
            let what = format!("term `{}` of {what}", term.name);
            if !term_spans.unread
                && let Err(error) = term.membership_function.validate()
            {
                let blamed = error.parameter.and_then(|i| term_spans.parameters.get(i));
                let here = blamed.unwrap_or(&term_spans.name);
                let message = format!("{what}: {error}");
                let help = "the positions of a membership function ascend, its widths are greater than 0, its degrees lie in [0, 1]";
                self.error("wrong-parameter", here, message, help);
            }
            if !(term.height > 0.0 && term.height <= 1.0) {
                let here = or(&term_spans.height, &term_spans.name);
                let message = format!("the height {} of {what} is outside (0, 1]", term.height);
                let help =
                    "a height is the largest degree of membership: greater than 0, at most 1";
                self.error("wrong-parameter", here, message, help);
            }
        }
    }

    fn range(&mut self, what: &str, variable: &Variable, here: &Range<usize>) {
        let Variable { low, high, .. } = *variable;
        if !low.is_finite() || !high.is_finite() {
            let message = format!("the range of {what} is [{low}, {high}], not finite");
            self.error("wrong-range", here, message, "write two finite numbers");
        } else if low >= high {
            let message = format!("the range of {what} starts at {low} and ends at {high}");
            let help = "write the least value first, then the greatest";
            self.error("wrong-range", here, message, help);
        } else if !(2.0 * (high - low)).is_finite() {
            // Twice the width must be a number too, or distances within the range overflow.
            let message = format!("the range of {what} is too wide");
            self.error(
                "wrong-range",
                here,
                message,
                "write the values that can occur",
            );
        } else if high - low < NARROWEST_RANGE {
            let message = format!("the range of {what} is too narrow");
            let help = "write it in a smaller unit";
            self.error("wrong-range", here, message, help);
        }
    }

    /// Terms of an input are no linear functions, and formulas over the input alone.
    fn terms_are_sets(&mut self, input: &Variable, spans: &VariableSpans) {
        for (i, term) in input.terms.iter().enumerate() {
            let no_spans = TermSpans::default();
            let spans = spans.terms.get(i).unwrap_or(&no_spans);
            let what = format!("term `{}` of input `{}`", term.name, input.name);
            match &term.membership_function {
                MembershipFunction::Linear { .. } => {
                    let message = format!("{what} is a linear function");
                    let help = "only outputs may have one; an input needs a membership function such as `triangle`";
                    self.error("wrong-term", &spans.name, message, help);
                }
                MembershipFunction::Function { formula } => {
                    self.own_formula(&what, input, formula, spans);
                }
                _ => {}
            }
        }
    }

    /// A formula that is a fuzzy set reads its own variable alone.
    fn own_formula(
        &mut self,
        what: &str,
        variable: &Variable,
        formula: &Formula,
        spans: &TermSpans,
    ) {
        for (i, name) in formula.variables().enumerate() {
            if name != variable.name {
                let here = spans.parameters.get(i).unwrap_or(&spans.name);
                let message = format!("{what}: the formula of a fuzzy set reads `{name}`");
                let own = &variable.name;
                let help = format!(
                    "write `{own}` for the value of the variable; formulas over several variables are for outputs with `weighted_average` or `weighted_sum`"
                );
                self.error("wrong-term", here, message, &help);
            }
        }
    }

    fn output(&mut self, output: &Output, spans: &VariableSpans) {
        let variable = &output.variable;
        let what = format!("output `{}`", variable.name);
        let first = self.findings.len();
        self.variable(&what, variable, spans);
        if variable.terms.is_empty() && !spans.terms_unread {
            let message = format!("{what} has no terms");
            let help = "write `partition: [low, medium, high]`, or `terms` with a membership function for each";
            self.error("missing-key", &spans.name, message, help);
        }
        if let Some(sampling) = output.samples {
            let here = or(&spans.samples, &spans.name);
            let samples = sampling.samples;
            if samples < 2 {
                let message = format!("{what} is integrated with {samples} samples");
                self.error("wrong-parameter", here, message, "write 2 samples or more");
            } else if samples > MOST_SAMPLES {
                let message = format!("{samples} samples are more than {MOST_SAMPLES}");
                let help = "leave `samples` out: the result is exact then";
                self.error("wrong-parameter", here, message, help);
            }
        }
        if let NoRuleFires::Value(value) | NoRuleFires::Previous(Some(value)) =
            output.when_no_rule_fires
            && !spans.range_unread
            && !(variable.low..=variable.high).contains(&value)
        {
            let message = format!("the value {value} lies outside the range of {what}");
            let help = format!("write a value from {} to {}", variable.low, variable.high);
            let here = or(&spans.default, &spans.name);
            self.error("value-outside-range", here, message, &help);
        }
        self.consequents_fit(&what, output, spans);
        let unread = spans.range_unread || spans.terms.iter().any(|term| term.unread);
        if self.findings.len() == first && !unread && !output.defuzzifier.is_weighted() {
            self.terms_have_area(&what, output, spans);
        }
    }

    /// A Takagi-Sugeno output has numbers and linear functions as terms, a Mamdani output has fuzzy sets.
    fn consequents_fit(&mut self, what: &str, output: &Output, spans: &VariableSpans) {
        const WEIGHTED: &str = "it needs `defuzzifier: weighted_average` or `weighted_sum`";
        let weighted = output.defuzzifier.takes_numbers();
        let tsukamoto = output.defuzzifier == Defuzzifier::Tsukamoto;
        let no_spans = TermSpans::default();
        for (i, term) in output.variable.terms.iter().enumerate() {
            let spans = spans.terms.get(i).unwrap_or(&no_spans);
            let here = &spans.name;
            let what = format!("term `{}` of {what}", term.name);
            match &term.membership_function {
                _ if spans.unread => {}
                MembershipFunction::Linear { coefficients, .. } => {
                    if !weighted {
                        let message = format!("{what} is a linear function");
                        self.error("wrong-term", here, message, WEIGHTED);
                    }
                    self.coefficients(&what, coefficients, spans);
                }
                MembershipFunction::Function { formula } if weighted => {
                    for (i, name) in formula.variables().enumerate() {
                        self.is_read(name, spans.parameters.get(i).unwrap_or(here));
                    }
                }
                MembershipFunction::Function { formula } if !tsukamoto => {
                    self.own_formula(&what, &output.variable, formula, spans);
                }
                shape if tsukamoto && !shape.is_monotone() => {
                    let message = format!("{what} does not rise or fall all along");
                    let help = "with `tsukamoto` each degree has one place: write `right_shoulder`, `left_shoulder`, `s_shape`, `z_shape`, `sigmoid`, `concave`, `arc` or a monotone `piecewise`";
                    self.error("wrong-term", here, message, help);
                }
                MembershipFunction::Singleton { .. } if !weighted && !output.is_discrete() => {
                    let message =
                        format!("{what} is a singleton, which has no area beside fuzzy sets");
                    let help = "make all terms of the output singletons, or this one a narrow set such as `rectangle`";
                    self.error("wrong-term", here, message, help);
                }
                MembershipFunction::Singleton { .. }
                    if output.defuzzifier == Defuzzifier::Bisector =>
                {
                    let message = format!("{what} is a singleton, which has no area to halve");
                    let help =
                        "write `defuzzifier: centroid`, the mean of the places by their degrees";
                    self.error("wrong-term", here, message, help);
                }
                MembershipFunction::Constant { .. } | MembershipFunction::Singleton { .. } => {}
                shape if weighted => {
                    let message =
                        format!("{what} is a fuzzy set, but the output is a weighted one");
                    let help = if shape.is_monotone() {
                        "write `defuzzifier: tsukamoto`, or numbers: `{constant: 5}` or `{linear: {input: 2, constant: 1}}`"
                    } else {
                        "write `{constant: 5}` or `{linear: {input: 2, constant: 1}}`, or `defuzzifier: centroid`"
                    };
                    self.error("wrong-term", here, message, help);
                }
                _ => {}
            }
        }
    }

    /// The inputs that a linear function names.
    fn coefficients(&mut self, what: &str, coefficients: &[(String, f64)], spans: &TermSpans) {
        let mut seen = BTreeSet::new();
        for (i, (input, _)) in coefficients.iter().enumerate() {
            if self.findings.len() >= MOST_FINDINGS {
                return;
            }
            let here = spans.parameters.get(i).unwrap_or(&spans.name);
            if input == "constant" {
                // In a rule set this key is the constant part.
                let message = format!("{what} has a coefficient for an input called `constant`");
                self.error("wrong-term", here, message, "rename the input");
            } else {
                self.is_read(input, here);
            }
            if !seen.insert(input) {
                let message = format!("{what} has two coefficients for `{input}`");
                self.error("duplicate-key", here, message, "keep one of them");
            }
        }
    }

    /// What a consequent reads is an input or an output.
    fn is_read(&mut self, name: &str, here: &Range<usize>) {
        if !self.inputs.contains_key(name) && !self.outputs.contains_key(name) {
            let finding = self.unknown_input(name, here);
            self.findings.push(finding);
        }
    }

    /// A term without an area within the range gives an output no value.
    fn terms_have_area(&mut self, what: &str, output: &Output, spans: &VariableSpans) {
        let variable = &output.variable;
        let compiled = Defuzzify::fuzzy(output, self.model.operators_of_output(output));
        for (i, term) in variable.terms.iter().enumerate() {
            if compiled.is_empty(i) {
                let here = spans.terms.get(i).map_or(0..0, |term| term.name.clone());
                let lacks = if output.is_discrete() {
                    "does not lie"
                } else {
                    "has no area"
                };
                let message = format!(
                    "term `{}` of {what} {lacks} within the range [{}, {}]",
                    term.name, variable.low, variable.high
                );
                let help = "widen the range or move the term";
                self.error("term-outside-range", &here, message, help);
            }
        }
    }

    fn rule(&mut self, what: &str, rule: &'m Rule, spans: &RuleSpans) {
        let Rule {
            rule,
            confidence,
            against,
            ..
        } = rule;
        self.condition(&rule.condition, 0, &spans.whole);
        if rule.consequents.is_empty() {
            let message = String::from("the rule has no conclusion");
            let help = "add `THEN output IS term`";
            self.error("empty-rule", &spans.whole, message, help);
        }
        for consequent in &rule.consequents {
            if let Some(output) = self.known_output(&consequent.output) {
                self.known_term("output", output, &consequent.term);
            }
            let mut hedges = consequent.hedges.iter();
            if let Some(hedge) = hedges.find(|hedge| !hedge.may_conclude()) {
                let message = format!("`{}` cannot stand after `THEN`", hedge.word());
                let help = "it belongs in the condition";
                self.error("rule-syntax", &spans.whole, message, help);
            }
        }
        if !is_degree(rule.weight) {
            let message = format!("the weight {} is outside [0, 1]", rule.weight);
            let help = "a weight is a number from 0 to 1";
            self.error("weight-outside-range", &spans.whole, message, help);
        }
        let help = "write a number from 0 to 1";
        if let Some(confidence) = *confidence
            && !is_degree(confidence)
        {
            let here = or(&spans.confidence, &spans.whole);
            let message = format!("the confidence of {what} is {confidence}, outside [0, 1]");
            self.error("value-outside-range", here, message, help);
        }
        for (i, beaten) in against.iter().enumerate() {
            if !is_degree(beaten.degree) {
                let here = spans.against.get(i).unwrap_or(&spans.whole);
                let degree = beaten.degree;
                let message =
                    format!("the degree in `against` of {what} is {degree}, outside [0, 1]");
                self.error("value-outside-range", here, message, help);
            }
        }
    }

    /// `depth` counts NOTs and brackets, as the rule is written.
    fn condition(&mut self, condition: &'m Condition, depth: usize, rule: &Range<usize>) {
        if depth > DEEPEST_NESTING {
            let message = format!("brackets and NOTs are nested deeper than {DEEPEST_NESTING}");
            let help = "split the rule into several rules of the same conclusion";
            self.error("rule-too-deep", rule, message, help);
            return;
        }
        match condition {
            Condition::Is(proposition) => self.proposition(proposition),
            Condition::Not(inner) => {
                let brackets = matches!(**inner, Condition::And(_) | Condition::Or(_));
                self.condition(inner, depth + 1 + usize::from(brackets), rule);
            }
            Condition::And(parts) | Condition::Or(parts) => {
                if parts.is_empty() {
                    let message = String::from("the rule has an empty condition");
                    self.error("empty-rule", rule, message, "add `input IS term`");
                }
                let in_or = matches!(condition, Condition::Or(_));
                for part in parts {
                    let brackets = match part {
                        Condition::Or(_) => true,
                        Condition::And(_) => !in_or,
                        _ => false,
                    };
                    self.condition(part, depth + usize::from(brackets), rule);
                }
            }
        }
    }

    fn proposition(&mut self, proposition: &'m Proposition) {
        let name = &proposition.variable;
        let input = self.inputs.get(name.text.as_str()).copied();
        let output = self.outputs.get(name.text.as_str()).copied();
        let (kind, variable) = match (input, output) {
            (Some(input), _) => ("input", input),
            (None, Some(output)) => ("output", output),
            (None, None) => {
                let finding = self.unknown_input(&name.text, &name.span);
                self.findings.push(finding);
                return;
            }
        };
        match &proposition.term {
            Some(_) if kind == "output" && self.is_weighted(variable) => {
                let message = format!(
                    "`{}` is a Takagi-Sugeno output, whose terms are numbers; a condition reads fuzzy sets",
                    name.text
                );
                let help = "let a linear function read it, or give it another defuzzifier and fuzzy sets as terms";
                self.error("output-in-condition", &name.span, message, help);
            }
            Some(term) => self.known_term(kind, variable, term),
            // What a rule without a term reads back as.
            None if proposition.hedges.last() == Some(&Hedge::Any) => {}
            None => {
                let message = format!("`{}` has no term", name.text);
                let help = "add a term, or the hedge `any`";
                self.error("missing-term", &name.span, message, help);
            }
        }
    }

    fn is_weighted(&self, variable: &Variable) -> bool {
        let mut outputs = self.model.outputs.iter();
        outputs.any(|o| o.variable.name == variable.name && o.defuzzifier.takes_numbers())
    }

    /// Suggests an output only where the name is nearly that of one.
    fn unknown_input(&self, name: &str, span: &Range<usize>) -> Diagnostic {
        let inputs = self.inputs.keys().copied();
        match nearest(name, inputs.clone().chain(self.outputs.keys().copied())) {
            Some(near) => unknown("input", name, span, core::iter::once(near)),
            None => unknown("input", name, span, inputs),
        }
    }

    fn known_output(&mut self, name: &Name) -> Option<&'m Variable> {
        let found = self.outputs.get(name.text.as_str()).copied();
        // A model without outputs has a finding of its own.
        if found.is_none() && !self.outputs.is_empty() {
            let finding = if self.inputs.contains_key(name.text.as_str()) {
                let message = format!("`{}` is an input; a conclusion sets outputs", name.text);
                let help = "write the name of an output after `THEN`";
                Diagnostic::error("input-in-conclusion", name.span.clone(), message).help(help)
            } else {
                let known = self.outputs.keys().copied();
                unknown("output", &name.text, &name.span, known)
            };
            self.findings.push(finding);
        }
        found
    }

    fn known_term(&mut self, kind: &str, variable: &Variable, term: &Name) {
        // Terms that could not be read, and an output without any, are findings of their own.
        let is_told = self.unread.contains(&variable.name.as_str())
            || (kind == "output" && variable.terms.is_empty());
        if is_told || variable.terms.iter().any(|t| t.name == term.text) {
            return;
        }
        let message = format!("{kind} `{}` has no term `{}`", variable.name, term.text);
        let mut finding = Diagnostic::error("unknown-term", term.span.clone(), message);
        let known = variable.terms.iter().map(|t| t.name.as_str());
        finding.help = suggest(&term.text, known).or_else(|| Some("add terms to it".into()));
        self.findings.push(finding);
    }
}

fn spans_of(spans: &[VariableSpans]) -> impl Iterator<Item = Option<&VariableSpans>> {
    spans.iter().map(Some).chain(core::iter::repeat(None))
}

/// A span, or where there is none the wider one that it lies in.
fn or<'a>(span: &'a Range<usize>, wider: &'a Range<usize>) -> &'a Range<usize> {
    if span.is_empty() { wider } else { span }
}

fn is_degree(x: f64) -> bool {
    (0.0..=1.0).contains(&x)
}

fn unknown<'a>(
    kind: &str,
    name: &str,
    span: &Range<usize>,
    known: impl Iterator<Item = &'a str>,
) -> Diagnostic {
    let message = format!("there is no {kind} `{name}`");
    let mut finding = Diagnostic::error("unknown-variable", span.clone(), message);
    finding.help = suggest(name, known).or_else(|| Some(format!("declare it under `{kind}s`")));
    finding
}
