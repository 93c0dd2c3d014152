//! Static analysis of rule sets.
//!
//! [`validate`](crate::validate()) finds what keeps a model from being used: unknown names, wrong parameters. [`check`] analyses a model that
//! can be used: inputs that no rule covers, rules that contradict each other or add nothing, terms that are never used or
//! never reached, the values an output takes, its jumps, and where it contradicts a claim of the author.

use alloc::{string::String, vec::Vec};

use crate::{
    Engine,
    diagnostic::{Diagnostic, Findings, suggest},
    model::{
        Aggregation, Model, Variable,
        document::{Document, Spans},
    },
    validate::validate,
};

mod axis;
mod coverage;
mod findings;
mod gaps;
mod jumps;
mod logic;
mod monotone;
mod probe;
mod reach;
mod rules;
mod terms;
#[cfg(test)]
mod tests;
mod trend;

pub use coverage::{Antecedent, Side, Uncovered};
pub use jumps::Jump;
pub use monotone::{Counterexample, Direction, Monotone};
pub use probe::Coordinate;
pub use reach::Reach;
pub use rules::{Contradiction, Subsumed};
pub use terms::{EqualTerms, Hole, TermOf};
pub use trend::AgainstTrend;

/// How to analyse a rule set.
///
/// # Example: what an author says of an output
/// ```
/// use fuzzy::check::{Direction, Monotone, Options};
///
/// let claim: Monotone = "heat:increasing:speed".parse()?;
/// assert_eq!(claim.direction, Direction::Increasing);
/// let mut options = Options::default();
/// options.monotone.push(claim);
/// assert_eq!(options.coverage, 0.5);
/// # Ok::<(), String>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Options {
    /// The firing strength that some rule should reach everywhere. With terms that sum to 1 and the minimum as AND, one
    /// half means that the dominant combination of terms has a rule.
    pub coverage: f64,
    /// Claims of the author about the outputs.
    pub monotone: Vec<Monotone>,
}

impl Default for Options {
    fn default() -> Self {
        Options {
            coverage: 0.5,
            monotone: Vec::new(),
        }
    }
}

/// All that was found. Fields hold indices of rules in the model; serialised, rules count from 1.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Report {
    /// Boxes of the input space without a rule.
    pub uncovered: Vec<Uncovered>,
    /// Whether the list is complete; in a large rule set the search stops early.
    pub uncovered_complete: bool,
    /// Rules with equal conditions and different conclusions, and rules with two terms of one output as conclusions.
    pub contradictions: Vec<Contradiction>,
    /// Rules that add nothing to a wider one.
    pub subsumed: Vec<Subsumed>,
    /// Rules that fire nowhere.
    #[cfg_attr(
        feature = "serde",
        serde(serialize_with = "crate::serial::rule_numbers")
    )]
    pub never_firing: Vec<usize>,
    /// Variables and terms that no rule uses.
    pub unused: Vec<TermOf>,
    /// Terms that no value reaches.
    pub unreachable: Vec<TermOf>,
    /// Terms of a variable with the same membership function.
    pub equal_terms: Vec<EqualTerms>,
    /// Parts of an input's range in which every term is 0.
    pub holes: Vec<Hole>,
    /// The values each output takes.
    pub reach: Vec<Reach>,
    /// Rules against the trend of their neighbours.
    pub against_trend: Vec<AgainstTrend>,
    /// Points at which an output contradicts a claim.
    pub counterexamples: Vec<Counterexample>,
    /// Points at which an output jumps.
    pub jumps: Vec<Jump>,
}

/// Analyses the model of an engine.
///
/// # Errors
/// A claim of `options` about an input or output that the model does not have.
///
/// # Example: a rule is missing
/// ```
/// use fuzzy::{Engine, check};
///
/// let document = fuzzy::yaml::parse("
/// fuzzy: 1
/// name: fan
/// inputs: {heat: {range: [0, 1], partition: [low, medium, high]}}
/// outputs: {fan: {range: [0, 1], partition: [slow, fast]}}
/// rules: [IF heat IS low THEN fan IS slow, IF heat IS high THEN fan IS fast]
/// ")?;
/// let engine = Engine::new(&document.model)?;
/// let report = check::check(&engine, &check::Options::default())?;
/// let hole = &report.uncovered[0];
/// assert_eq!((hole.sides[0].low, hole.sides[0].high), (0.25, 0.75));
/// assert_eq!(hole.missing[0][0].term, "medium");
///
/// let findings = report.findings(&document.model, &document.spans);
/// assert!(findings.iter().any(|f| f.code == "uncovered"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn check(engine: &Engine, options: &Options) -> Result<Report, alloc::boxed::Box<Diagnostic>> {
    let model = engine.model();
    for claim in &options.monotone {
        known(model, claim)?;
    }
    let never_firing = rules::never_firing(model);
    let (uncovered, uncovered_complete) = all_uncovered(model, options.coverage);
    let mut probe = probe::Probe::new(model, engine);
    let claims = options.monotone.iter();
    let counterexamples = claims
        .flat_map(|claim| probe.counterexamples(claim))
        .collect();
    // With another aggregation a rule adds to the result even where a wider one fires.
    let merging = model.operators.aggregation == Aggregation::Maximum;
    Ok(Report {
        uncovered,
        uncovered_complete,
        contradictions: rules::contradictions(model),
        subsumed: if merging {
            rules::subsumed(model)
        } else {
            Vec::new()
        },
        unused: terms::unused(model),
        unreachable: terms::unreachable(model, &never_firing),
        never_firing,
        equal_terms: all_variables(model).flat_map(terms::equal).collect(),
        holes: model.inputs.iter().flat_map(terms::holes).collect(),
        reach: probe.reach(),
        against_trend: trend::against(model),
        counterexamples,
        jumps: probe.jumps(),
    })
}

/// Checks a rule set that was read: its errors, or else the analysis, as located findings.
///
/// A rule set without rules is read with a warning, because rules are learned into it; here it is an error.
///
/// # Errors
/// As [`check`].
pub fn document(
    document: &Document,
    text: &str,
    options: &Options,
) -> Result<(Findings, Option<Report>), alloc::boxed::Box<Diagnostic>> {
    let invalid = validate(&document.model, &document.spans);
    if !invalid.is_empty() {
        return Ok((Findings::locate(invalid, text), None));
    }
    let engine = match Engine::new(&document.model) {
        Ok(engine) => engine,
        Err(findings) => return Ok((findings, None)),
    };
    let report = check(&engine, options)?;
    let findings = report.findings(&document.model, &document.spans);
    Ok((Findings::locate(findings, text), Some(report)))
}

fn all_variables(model: &Model) -> impl Iterator<Item = &Variable> {
    let outputs = model.outputs.iter().map(|output| &output.variable);
    model.inputs.iter().chain(outputs)
}

/// The uncovered boxes of all outputs: those where no rule fires at all, then those where none reaches the coverage.
/// Outputs with the same boxes are listed once.
fn all_uncovered(model: &Model, coverage: f64) -> (Vec<Uncovered>, bool) {
    let mut found: Vec<Uncovered> = Vec::new();
    let mut complete = true;
    for level in [None, Some(coverage)] {
        for output in &model.outputs {
            let boxes = coverage::uncovered(model, &output.variable.name, level);
            complete &= boxes.complete;
            let new = boxes.found.into_iter().filter(|one| {
                // A box in which no rule fires is uncovered too.
                one.silent
                    || !found
                        .iter()
                        .any(|f| f.silent && f.output == one.output && f.sides == one.sides)
            });
            found.extend(new.collect::<Vec<_>>());
        }
    }
    (found, complete)
}

fn known(model: &Model, claim: &Monotone) -> Result<(), alloc::boxed::Box<Diagnostic>> {
    let unknown = |kind: &str, name: &str, names: Vec<&str>| {
        let message = alloc::format!("there is no {kind} `{name}`");
        let mut finding = Diagnostic::error("unknown-variable", 0..0, message);
        finding.help = suggest(name, names);
        Err(alloc::boxed::Box::new(finding))
    };
    let inputs: Vec<&str> = model.inputs.iter().map(|v| v.name.as_str()).collect();
    if !inputs.contains(&claim.input.as_str()) {
        return unknown("input", &claim.input, inputs);
    }
    let outputs = model.outputs.iter().map(|o| o.variable.name.as_str());
    let outputs: Vec<&str> = outputs.collect();
    match &claim.output {
        Some(output) if !outputs.contains(&output.as_str()) => unknown("output", output, outputs),
        _ => Ok(()),
    }
}

impl Report {
    /// Converts the report to located diagnostics.
    #[must_use]
    pub fn findings(&self, model: &Model, spans: &Spans) -> Vec<Diagnostic> {
        findings::of(self, model, spans)
    }
}

/// A number for a message: at most six digits, very small and very large ones as `1e-9`.
fn shown(x: f64) -> String {
    if x == 0.0 {
        return "0".into();
    }
    let digits: f64 = alloc::format!("{x:.5e}").parse().unwrap_or(x);
    if (1e-5..1e15).contains(&libm::fabs(digits)) {
        alloc::format!("{digits}")
    } else {
        alloc::format!("{digits:e}")
    }
}
