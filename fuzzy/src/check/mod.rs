//! What an author should know about a rule set: static analysis.
//!
//! [`validate`](crate::validate()) finds what keeps a model from being used: unknown names, wrong parameters. [`check`] analyses a model that
//! can be used: inputs that no rule covers, rules that contradict each other or add nothing, terms that are never used or
//! never reached, the values an output takes, its jumps, and where it contradicts a claim of the author.

use alloc::{string::String, vec::Vec};

use crate::{
    Engine,
    diagnostic::{Diagnostic, Findings, suggest},
    model::{
        Aggregation, Model,
        document::{Document, Spans},
    },
    validate::validate,
};

mod axis;
mod coverage;
mod findings;
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
pub use terms::{Hole, TermOf};
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
    /// The degree that some rule should reach everywhere; with terms that sum to 1 and the minimum as AND, one half
    /// means that the condition that dominates has a rule.
    pub coverage: f64,
    /// What the author says of the outputs.
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
///
/// # Example: three rules, and most of what can be wrong with them
/// ```
/// use fuzzy::check::{self, Antecedent, Contradiction, Side, Subsumed, TermOf, Uncovered};
///
/// let text = "fuzzy: 1
/// name: fan
/// inputs: {heat: {range: [0, 100], partition: [low, high]}, sun: {range: [0, 1], partition: [down, up]}}
/// outputs: {speed: {range: [0, 9], partition: [slow, fast]}}
/// rules:
///   - IF heat IS high THEN speed IS fast
///   - IF heat IS high AND sun IS up THEN speed IS fast
///   - IF heat IS high THEN speed IS slow";
/// let model = fuzzy::yaml::parse(text)?.model;
/// let report = check::check(&model, &fuzzy::Engine::new(&model)?, &check::Options::default())?;
///
/// assert_eq!(report.subsumed, [Subsumed { rule: 1, by: 0 }]);
/// let Contradiction { first, second, .. } = &report.contradictions[0];
/// assert_eq!((*first, *second), (0, 2));
/// let Uncovered { sides, missing, .. } = &report.uncovered[1]; // the first one is where no rule fires at all
/// assert_eq!(sides[..], [Side { input: "heat".into(), low: 0.0, high: 50.0 }]);
/// assert_eq!(missing[0], [Antecedent { input: "heat".into(), term: "low".into() }]);
/// assert!(report.unused.contains(&TermOf { variable: "sun".into(), term: Some("down".into()) }));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Report {
    /// Boxes of the input space without a rule.
    pub uncovered: Vec<Uncovered>,
    /// Whether these are all boxes; in a large rule set the search for more is given up.
    pub uncovered_complete: bool,
    /// Rules of one condition and different conclusions.
    pub contradictions: Vec<Contradiction>,
    /// Rules that add nothing to a wider one.
    pub subsumed: Vec<Subsumed>,
    /// Rules that fire nowhere.
    #[cfg_attr(
        feature = "serde",
        serde(serialize_with = "crate::serial::rule_numbers")
    )]
    pub never_firing: Vec<usize>,
    /// Variables and terms that stand in no rule.
    pub unused: Vec<TermOf>,
    /// Terms that no value reaches.
    pub unreachable: Vec<TermOf>,
    /// Parts of an input's range in which every term is 0.
    pub holes: Vec<Hole>,
    /// The values each output takes.
    pub reach: Vec<Reach>,
    /// Rules against the trend of their neighbours.
    pub against_trend: Vec<AgainstTrend>,
    /// Places at which an output does not do what the author says.
    pub counterexamples: Vec<Counterexample>,
    /// Places at which an output jumps.
    pub jumps: Vec<Jump>,
}

/// Analyses a model.
///
/// # Errors
/// A claim of `options` about an input or output that the model does not have, without a place.
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
/// let report = check::check(&document.model, &engine, &check::Options::default())?;
/// let hole = &report.uncovered[0];
/// assert_eq!((hole.sides[0].low, hole.sides[0].high), (0.25, 0.75));
/// assert_eq!(hole.missing[0][0].term, "medium");
///
/// let findings = report.findings(&document.model, &document.spans);
/// assert!(findings.iter().any(|f| f.code == "uncovered"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn check(
    model: &Model,
    engine: &Engine,
    options: &Options,
) -> Result<Report, alloc::boxed::Box<Diagnostic>> {
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
        holes: model.inputs.iter().flat_map(terms::holes).collect(),
        reach: probe.reach(),
        against_trend: trend::against(model),
        counterexamples,
        jumps: probe.jumps(),
    })
}

/// Checks a rule set that was read and is meant to be used: all findings with their places in the text, what reading it
/// warned of included, and the analysis, where there can be one.
///
/// A rule set without rules is read with a warning, for learning fills it; here it is an error.
///
/// # Errors
/// As [`check`].
///
/// # Example: a rule set that nobody has filled yet
/// ```
/// use fuzzy::check;
///
/// let text = "
/// fuzzy: 1
/// name: fan
/// inputs: {heat: {range: [0, 1], partition: [low, high]}}
/// outputs: {fan: {range: [0, 1], partition: [slow, fast]}}
/// rules: []
/// ";
/// let document = fuzzy::yaml::parse(text)?;
/// let (findings, report) = check::document(&document, text, &check::Options::default())?;
/// assert!(report.is_none());
/// assert!(findings.to_string().starts_with("6:8: error[no-rules]: the rule set has no rules"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
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
    let report = check(&document.model, &engine, options)?;
    let findings = report.findings(&document.model, &document.spans);
    Ok((Findings::locate(findings, text), Some(report)))
}

/// The uncovered boxes of all outputs: those where no rule fires at all, then those where none reaches the coverage.
/// Outputs with the same boxes are told once.
fn all_uncovered(model: &Model, coverage: f64) -> (Vec<Uncovered>, bool) {
    let mut found: Vec<Uncovered> = Vec::new();
    let mut complete = true;
    for level in [None, Some(coverage)] {
        for output in &model.outputs {
            let boxes = coverage::uncovered(model, &output.variable.name, level);
            complete &= boxes.complete;
            let new = boxes.found.into_iter().filter(|one| {
                // What is silent is uncovered too.
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
    /// What was found, in words, the parts of the model at their places.
    ///
    /// # Example
    /// ```
    /// use fuzzy::{Engine, check};
    ///
    /// let text = "fuzzy: 1
    /// name: fan
    /// inputs: {heat: {range: [0, 100], partition: [low, high]}}
    /// outputs: {speed: {range: [0, 9], partition: [slow, fast]}}
    /// rules: [IF heat IS high THEN speed IS fast]";
    /// let document = fuzzy::yaml::parse(text)?;
    /// let engine = Engine::new(&document.model)?;
    /// let report = check::check(&document.model, &engine, &check::Options::default())?;
    /// let findings = report.findings(&document.model, &document.spans);
    /// assert!(findings.iter().any(|finding| finding.message == "no rule uses the term `low` of `heat`"));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn findings(&self, model: &Model, spans: &Spans) -> Vec<Diagnostic> {
        findings::of(self, model, spans)
    }
}

/// Numbers in messages: six digits, without noughts behind them.
fn shown(x: f64) -> String {
    if x == 0.0 {
        return "0".into();
    }
    let digits = alloc::format!("{x:.5e}").parse().unwrap_or(x);
    alloc::format!("{digits}")
}
