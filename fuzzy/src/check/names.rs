//! Whether the names in rules mean something, and the parts of a model fit together.

use alloc::{collections::BTreeMap, format, string::String, vec::Vec};
use core::ops::Range;

use crate::{
    diagnostic::{Diagnostic, Severity, suggest},
    model::{
        Defuzzifier, Model, Shape, Variable,
        document::{Places, VariablePlaces},
    },
    rule::Name,
    tree::duplicate,
};

/// Checks all names of a model, and that outputs and their terms go together. `places` may be empty for a model that
/// was made by code; its findings have no place then.
///
/// # Example
/// ```
/// use fuzzy::{Model, check, format::Places};
///
/// let rule = fuzzy::rule::parse("IF heat IS high THEN speed IS fast")?;
/// let model = Model::builder("fan").rule(rule).build();
/// let findings = check::names::check(&model, &Places::default());
/// assert_eq!(findings[0].message, "there is no input `heat`");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
pub fn check(model: &Model, places: &Places) -> Vec<Diagnostic> {
    let names = Names::of(model);
    let mut findings = Vec::new();
    declared_twice(model, places, &mut findings);
    for rule in &model.rules {
        rule.rule.condition.visit(&mut |proposition| {
            let input = names.input(&proposition.variable, &mut findings);
            if let (Some(input), Some(term)) = (input, &proposition.term) {
                known_term("input", input, term, &mut findings);
            }
        });
        for consequent in &rule.rule.consequents {
            if let Some(output) = names.output(&consequent.output, &mut findings) {
                known_term("output", output, &consequent.term, &mut findings);
            }
        }
    }
    duplicate_rules(model, places, &mut findings);
    output_terms(model, places, &mut findings);
    terms_outside(model, places, &mut findings);
    findings
}

/// Terms that are 0 on the whole range of their variable. In an input that is a rule that never fires, in an output a
/// conclusion without a value.
fn terms_outside(model: &Model, places: &Places, findings: &mut Vec<Diagnostic>) {
    let no_places = VariablePlaces::default();
    for (i, input) in model.inputs.iter().enumerate() {
        let places = places.inputs.get(i).unwrap_or(&no_places);
        for term in super::terms::outside(input) {
            let here = place(&places.terms, term);
            let severity = Severity::Warning;
            findings.extend(outside_range("input", input, term, here, severity));
        }
    }
    for (i, output) in model.outputs.iter().enumerate() {
        let places = places.outputs.get(i).unwrap_or(&no_places);
        for term in super::terms::outside(&output.variable) {
            let here = place(&places.terms, term);
            let severity = Severity::Error;
            findings.extend(outside_range(
                "output",
                &output.variable,
                term,
                here,
                severity,
            ));
        }
    }
}

/// A finding: this term lies outside the range.
pub(super) fn outside_range(
    kind: &str,
    variable: &Variable,
    term: usize,
    here: Range<usize>,
    severity: Severity,
) -> Option<Diagnostic> {
    let Variable {
        name, low, high, ..
    } = variable;
    let term = &variable.terms.get(term)?.name;
    let message =
        format!("term `{term}` of {kind} `{name}` is 0 on the whole range [{low}, {high}]");
    let finding = Diagnostic::error("term-outside-range", here, message);
    Some(
        Diagnostic {
            severity,
            ..finding
        }
        .help("widen the range or move the term"),
    )
}

/// The variables of a model by name.
struct Names<'a> {
    inputs: BTreeMap<&'a str, &'a Variable>,
    outputs: BTreeMap<&'a str, &'a Variable>,
}

impl<'a> Names<'a> {
    fn of(model: &'a Model) -> Self {
        let by_name = |v: &'a Variable| (v.name.as_str(), v);
        Names {
            inputs: model.inputs.iter().map(by_name).collect(),
            outputs: model.outputs.iter().map(|o| by_name(&o.variable)).collect(),
        }
    }

    fn input(&self, name: &Name, findings: &mut Vec<Diagnostic>) -> Option<&'a Variable> {
        let found = self.inputs.get(name.text.as_str()).copied();
        if found.is_none() {
            let span = name.span.clone();
            findings.push(if self.outputs.contains_key(name.text.as_str()) {
                let message = format!("`{}` is an output, and stands in a condition", name.text);
                Diagnostic::error("output-in-condition", span, message).help(
                    "a condition asks for inputs; to build on an output, feed it in as an input",
                )
            } else {
                unknown("input", &name.text, span, self.inputs.keys().copied())
            });
        }
        found
    }

    fn output(&self, name: &Name, findings: &mut Vec<Diagnostic>) -> Option<&'a Variable> {
        let found = self.outputs.get(name.text.as_str()).copied();
        if found.is_none() {
            let span = name.span.clone();
            findings.push(if self.inputs.contains_key(name.text.as_str()) {
                let message = format!("`{}` is an input, and stands after `THEN`", name.text);
                Diagnostic::error("input-in-conclusion", span, message)
                    .help("a conclusion sets an output")
            } else {
                unknown("output", &name.text, span, self.outputs.keys().copied())
            });
        }
        found
    }
}

fn unknown<'a>(
    kind: &str,
    name: &str,
    span: Range<usize>,
    known: impl Iterator<Item = &'a str>,
) -> Diagnostic {
    let message = format!("there is no {kind} `{name}`");
    let mut finding = Diagnostic::error("unknown-variable", span, message);
    finding.help = suggest(name, known).or_else(|| Some(format!("declare it under `{kind}s`")));
    finding
}

fn known_term(kind: &str, variable: &Variable, term: &Name, findings: &mut Vec<Diagnostic>) {
    // Where the terms could not be read, that is the finding.
    if variable.terms.is_empty() || variable.terms.iter().any(|t| t.name == term.text) {
        return;
    }
    let message = format!("{kind} `{}` has no term `{}`", variable.name, term.text);
    let mut finding = Diagnostic::error("unknown-term", term.span.clone(), message);
    finding.help = suggest(&term.text, variable.terms.iter().map(|t| t.name.as_str()));
    findings.push(finding);
}

fn place(spans: &[Range<usize>], i: usize) -> Range<usize> {
    spans.get(i).cloned().unwrap_or(0..0)
}

/// Variables of one name, and terms of one name in a variable.
fn declared_twice(model: &Model, places: &Places, findings: &mut Vec<Diagnostic>) {
    let variables = model.inputs.iter();
    let variables = variables.chain(model.outputs.iter().map(|output| &output.variable));
    let all_places: Vec<_> = places.inputs.iter().chain(&places.outputs).collect();
    let mut seen: BTreeMap<&str, Range<usize>> = BTreeMap::new();
    for (i, variable) in variables.enumerate() {
        let here = all_places.get(i).map_or(0..0, |place| place.name.clone());
        if let Some(first) = seen.insert(&variable.name, here.clone()) {
            let what = "the rule set";
            findings.push(duplicate("variable", &variable.name, what, here, first));
        }
        let mut terms: BTreeMap<&str, Range<usize>> = BTreeMap::new();
        for (k, term) in variable.terms.iter().enumerate() {
            let here = all_places.get(i).map_or(0..0, |p| place(&p.terms, k));
            if let Some(first) = terms.insert(&term.name, here.clone()) {
                let what = format!("`{}`", variable.name);
                findings.push(duplicate("term", &term.name, &what, here, first));
            }
        }
    }
}

/// Rules that say the same: a slip, or one was to be changed.
fn duplicate_rules(model: &Model, places: &Places, findings: &mut Vec<Diagnostic>) {
    let mut seen: BTreeMap<String, Range<usize>> = BTreeMap::new();
    for (i, rule) in model.rules.iter().enumerate() {
        let mut bare = rule.rule.clone();
        bare.weight = 1.0;
        let here = place(&places.rules, i);
        let text = format!("{bare}");
        if let Some(first) = seen.get(&text) {
            let message = format!("rule {} says what an earlier rule says", i + 1);
            findings.push(
                Diagnostic::warning("duplicate-rule", here, message)
                    .related(first.clone(), "the earlier one")
                    .help("remove one of them; with weights the greater one counts alone"),
            );
        } else {
            seen.insert(text, here);
        }
    }
}

/// Takagi-Sugeno outputs have constants and linear functions, Mamdani outputs have sets.
fn output_terms(model: &Model, places: &Places, findings: &mut Vec<Diagnostic>) {
    let no_places = VariablePlaces::default();
    for (i, input) in model.inputs.iter().enumerate() {
        let places = places.inputs.get(i).unwrap_or(&no_places);
        for (k, term) in input.terms.iter().enumerate() {
            if let Shape::Linear { .. } = term.shape {
                let name = (&input.name, &term.name);
                let message = format!(
                    "term `{}` of input `{}` is a linear function",
                    name.1, name.0
                );
                findings.push(
                    Diagnostic::error("wrong-term", place(&places.terms, k), message).help(
                        "only outputs may have one; an input needs a shape such as `triangle`",
                    ),
                );
            }
        }
    }
    for (i, output) in model.outputs.iter().enumerate() {
        let places = places.outputs.get(i).unwrap_or(&no_places);
        let weighted = matches!(
            output.defuzzifier,
            Defuzzifier::WeightedAverage | Defuzzifier::WeightedSum
        );
        for (k, term) in output.variable.terms.iter().enumerate() {
            let here = place(&places.terms, k);
            let what = format!("term `{}` of output `{}`", term.name, output.variable.name);
            match &term.shape {
                Shape::Linear { coefficients, .. } => {
                    if !weighted {
                        let message = format!("{what} is a linear function");
                        findings
                            .push(Diagnostic::error("wrong-term", here.clone(), message).help(
                                "it needs `defuzzifier: weighted_average` or `weighted_sum`",
                            ));
                    }
                    for (input, _) in coefficients {
                        if !model.inputs.iter().any(|v| v.name == *input) {
                            let known = model.inputs.iter().map(|v| v.name.as_str());
                            findings.push(unknown("input", input, here.clone(), known));
                        }
                    }
                }
                Shape::Constant { .. } => {}
                // A shape that could not be read has its finding already.
                Shape::Piecewise { points } if points.is_empty() => {}
                _ if weighted => {
                    let message =
                        format!("{what} is a fuzzy set, but the output is a weighted one");
                    findings.push(
                        Diagnostic::error("wrong-term", here, message)
                            .help("write `{constant: 5}` or `{linear: {input: 2, constant: 1}}`, or `defuzzifier: centroid`"),
                    );
                }
                _ => {}
            }
        }
    }
}
