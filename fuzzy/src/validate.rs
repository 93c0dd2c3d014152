//! Validation of models: all errors that prevent a model from being evaluated for every finite input, or from being
//! written and parsed again.
//!
//! This is the only implementation of these checks; parsing, checking and compiling a rule set all use it.

use alloc::{collections::BTreeMap, format, string::String, vec::Vec};
use core::ops::Range;

use crate::{
    diagnostic::{Diagnostic, Findings, duplicate},
    model::{
        MembershipFunction, Model, Term, Variable,
        chain::cycle_errors,
        document::{Document, RuleSpans, Spans, VariableSpans},
    },
};

mod blocks;
mod rules;
mod type2;
mod variables;

/// The maximum number of inputs and outputs of a model.
const MAX_VARIABLES: usize = 1000;
/// The maximum number of terms of one input or output.
const MAX_TERMS: usize = 1000;
/// The maximum number of terms of all inputs and outputs.
const MAX_TERMS_IN_ALL: usize = 10_000;
/// The maximum number of points of one `piecewise` term.
const MAX_POINTS: usize = 2000;
/// The maximum number of points of all `piecewise` terms.
const MAX_POINTS_IN_ALL: usize = 20_000;
/// The maximum number of rules of a model.
const MAX_RULES: usize = 100_000;
/// The maximum number of conclusions of one rule.
const MAX_CONCLUSIONS: usize = 100;
/// The maximum number of rule blocks of a model.
const MAX_BLOCKS: usize = 1000;
/// The maximum number of errors reported for a model; validation stops after that.
const MAX_FINDINGS: usize = 1000;

/// The suggestion for a variable without terms.
pub(crate) const TERMS_HELP: &str =
    "write `partition: [low, medium, high]`, or `terms` with a membership function for each term";

/// Returns the suggestion for missing inputs or outputs; `key` is `inputs` or `outputs`.
pub(crate) fn missing_help(key: &str) -> String {
    format!(
        "write each {} under `{key}:`, for example `speed: {{range: [0, 10], partition: [low, high]}}`",
        key.trim_end_matches('s')
    )
}

impl Document {
    /// Validates the model: a valid model can be compiled. `text` is the text from which the model was parsed.
    ///
    /// # Errors
    /// The errors that [`validate`] finds, with line and column.
    pub fn validate(&self, text: &str) -> Result<(), Findings> {
        let invalid = validate(&self.model, &self.spans);
        match invalid.is_empty() {
            true => Ok(()),
            false => Err(Findings::locate(invalid, text)),
        }
    }
}

/// Returns all errors of a model, in the order of its parts. If there are none, the model compiles. `spans` are the
/// positions of its parts in a text; they are empty for a model built in code, and the findings then have no position.
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
        // If two inputs share a name, the first one is used.
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
        spans,
        unread: unread.collect(),
        findings: Vec::new(),
    };
    validator.names(spans);
    let no_spans = VariableSpans::default();
    for (i, input) in model.inputs.iter().enumerate() {
        let spans = spans.inputs.get(i).unwrap_or(&no_spans);
        let first = validator.findings.len();
        validator.variable(&format!("input `{}`", input.name), input, spans);
        validator.terms_are_sets(input, spans);
        if validator.findings.len() == first {
            validator.bounds(&format!("input `{}`", input.name), input, spans);
        }
    }
    if model.outputs.is_empty() {
        validator.findings.push(
            Diagnostic::error(
                "missing-key",
                spans.outputs_key.clone(),
                "the rule set has no outputs",
            )
            .help(missing_help("outputs")),
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
            .help("add a rule, such as `- IF input IS term THEN output IS term`"),
        );
    }
    for (i, rule) in model.rules.iter().enumerate() {
        let first = validator.findings.len();
        if first >= MAX_FINDINGS {
            let message = format!("rule {} and the rules after it were not examined", i + 1);
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
            // If there is no text, the message names the rule instead of a position.
            for finding in validator.findings.iter_mut().skip(first) {
                finding.message = format!("rule {}: {}", i + 1, finding.message);
            }
        }
    }
    validator.blocks(spans);
    validator.interval_outputs(spans);
    let cycles = cycle_errors(model, spans);
    let mut findings = validator.findings;
    // If two variables share a name, the author probably meant another name for one of them. Rules may use that name, so
    // unknown names are then not reported.
    let is_repeated = findings
        .iter()
        .any(|finding| finding.code == "duplicate-variable");
    findings.retain(|finding| match finding.code {
        "unknown-variable" => !spans.names_unread && !is_repeated,
        // An output that reads itself is wrong whether its terms are numbers or sets.
        "output-in-condition" if finding.related.is_empty() => {
            !cycles.iter().any(|cycle| cycle.span == finding.span)
        }
        _ => true,
    });
    findings.extend(cycles);
    findings
}

/// Returns a finding if the model exceeds a limit. Larger models take minutes to analyse, and are never intended.
fn too_large(model: &Model, spans: &Spans) -> Option<Diagnostic> {
    let variables = || model.variables();
    let all_spans = || spans.inputs.iter().chain(&spans.outputs);
    let refuse = |here: Option<Range<usize>>, count: usize, most: usize, what: &str| {
        (count > most).then(|| {
            let message = format!("{count} {what} are more than the maximum of {most}");
            let here = here.unwrap_or_default();
            Diagnostic::error("too-large", here, message).help("split the rule set into several")
        })
    };
    let name = |index: usize| all_spans().nth(index).map(|spans| spans.name.clone());
    let most = variables().enumerate().max_by_key(|(_, v)| v.terms.len());
    let (widest, terms, of) = most.map_or((0, 0, ""), |(i, v)| (i, v.terms.len(), &*v.name));
    let in_all = variables().map(|v| v.terms.len()).sum();
    let points_of = |function: &MembershipFunction| match function {
        MembershipFunction::Piecewise { points } => points.len(),
        _ => 0,
    };
    let points = |term: &Term| {
        let lower = term.lower.as_ref().map(|lower| &lower.membership_function);
        [
            points_of(&term.membership_function),
            lower.map_or(0, points_of),
        ]
    };
    let of_term = variables().enumerate().flat_map(|(i, v)| {
        let terms = v.terms.iter();
        terms.map(move |term| (i, points(term).into_iter().max().unwrap_or(0), &*term.name))
    });
    let (owner, most_points, term) = of_term.max_by_key(|one| one.1).unwrap_or((0, 0, ""));
    let all_points = variables().flat_map(|v| &v.terms).flat_map(points).sum();
    let rules = model.rules.len();
    let conclusions = model.rules.iter().map(|rule| rule.rule.consequents.len());
    let longest = conclusions.enumerate().max_by_key(|(_, count)| *count);
    let (rule, conclusions) = longest.unwrap_or((0, 0));
    let rule_span = spans.rules.get(rule).map(|spans| spans.whole.clone());
    let block = spans.blocks.first().map(|spans| spans.name.clone());
    refuse(
        name(0),
        variables().count(),
        MAX_VARIABLES,
        "inputs and outputs",
    )
    .or_else(|| refuse(name(widest), terms, MAX_TERMS, &format!("terms of `{of}`")))
    .or_else(|| refuse(name(0), in_all, MAX_TERMS_IN_ALL, "terms"))
    .or_else(|| {
        let what = format!("points of the term `{term}`");
        refuse(name(owner), most_points, MAX_POINTS, &what)
    })
    .or_else(|| {
        refuse(
            name(0),
            all_points,
            MAX_POINTS_IN_ALL,
            "points of `piecewise` terms",
        )
    })
    .or_else(|| refuse(Some(spans.rules_key.clone()), rules, MAX_RULES, "rules"))
    .or_else(|| {
        let what = format!("conclusions of rule {}", rule + 1);
        refuse(rule_span, conclusions, MAX_CONCLUSIONS, &what)
    })
    .or_else(|| refuse(block, model.blocks.len(), MAX_BLOCKS, "rule blocks"))
}

struct Validator<'m> {
    model: &'m Model,
    spans: &'m Spans,
    inputs: BTreeMap<&'m str, &'m Variable>,
    outputs: BTreeMap<&'m str, &'m Variable>,
    /// The inputs and outputs whose terms could not be parsed.
    unread: Vec<&'m str>,
    findings: Vec<Diagnostic>,
}

impl<'m> Validator<'m> {
    fn error(&mut self, code: &'static str, span: &Range<usize>, message: String, help: &str) {
        let finding = Diagnostic::error(code, span.clone(), message);
        self.findings.push(finding.help(help));
    }

    /// Reports variables and terms without a name, and those that share a name.
    fn names(&mut self, spans: &Spans) {
        let outputs = self.model.outputs.iter().map(|output| &output.variable);
        let variables = self.model.inputs.iter().zip(spans_of(&spans.inputs));
        let variables = variables.chain(outputs.zip(spans_of(&spans.outputs)));
        let mut seen: BTreeMap<&str, Range<usize>> = BTreeMap::new();
        for (variable, spans) in variables {
            let here = spans.map_or(0..0, |spans| spans.name.clone());
            if variable.name.is_empty() {
                let message = String::from("this input or output has an empty name");
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
}

fn spans_of(spans: &[VariableSpans]) -> impl Iterator<Item = Option<&VariableSpans>> {
    spans.iter().map(Some).chain(core::iter::repeat(None))
}

/// Returns a span or, if it is empty, the span that contains it.
fn or<'a>(span: &'a Range<usize>, wider: &'a Range<usize>) -> &'a Range<usize> {
    if span.is_empty() { wider } else { span }
}
