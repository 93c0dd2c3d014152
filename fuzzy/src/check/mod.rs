//! Static analysis of rule sets.
//!
//! [`validate`](crate::validate()) finds errors that make a model unusable: unknown names and wrong parameters.
//! [`check`] analyses a usable model. It finds inputs that no rule covers, rules that contradict each other or have no
//! effect, terms that are unused or unreachable, the values that outputs take, their jumps, and violations of the
//! author's claims.

use alloc::{string::String, vec::Vec};

use crate::{
    Engine,
    diagnostic::{Diagnostic, Findings, suggest},
    model::{
        Model,
        chain::{Stage, stages},
        document::{Document, Spans},
    },
};

mod accepted;
mod axis;
mod coverage;
mod effects;
mod extent;
mod findings;
mod gaps;
mod jumps;
mod logic;
mod monotone;
mod outer;
mod probe;
mod reach;
mod rules;
mod terms;
#[cfg(test)]
mod tests;
mod trend;

pub use accepted::AcceptedFindings;
pub use coverage::{Antecedent, BoxSide, UncoveredRegion};
pub use extent::extent;
pub use jumps::Jump;
pub use monotone::{Counterexample, Direction, Monotone};
pub use outer::UnreachedTerm;
pub use probe::Coordinate;
pub use reach::Reach;
pub use rules::{Contradiction, SubsumedRule};
pub use terms::{EqualTerms, TermGap, TermOf};
pub use trend::AgainstTrend;

/// The options of the analysis.
///
/// # Example: a claim about an output
/// ```
/// use fuzzy::check::{Direction, Monotone, Options};
///
/// let mut options = Options::default();
/// options.monotone.push(Monotone::new("heat:speed", Direction::Increasing));
/// assert_eq!(options.coverage, 0.5);
/// ```
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Options {
    /// The firing strength that at least one rule should reach at every point of the input space. If the terms of
    /// each input sum to 1 and AND is the minimum, 0.5 means that the dominant combination of terms has a rule.
    pub coverage: f64,
    /// The author's claims about the outputs.
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

/// The results of the analysis. Rules are identified by their index in the model; in serialised results, by the rule
/// number, which counts from 1.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct Report {
    /// Boxes of the input space in which no rule reaches the coverage, or no rule fires at all.
    pub uncovered: Vec<UncoveredRegion>,
    /// Whether `uncovered` is complete. In large rule sets the search stops early. If NOT is applied to an interval
    /// type-2 term, there is no search, and `uncovered` is empty.
    pub uncovered_complete: bool,
    /// Rules with equal conditions and different conclusions, and rules that conclude two terms of the same output.
    pub contradictions: Vec<Contradiction>,
    /// Rules that have no effect because a more general rule fires at least as strongly.
    pub subsumed: Vec<SubsumedRule>,
    /// Rules that cannot fire for any input.
    #[cfg_attr(
        feature = "serde",
        serde(serialize_with = "crate::serial::rule_numbers")
    )]
    #[cfg_attr(feature = "schema", schemars(inner(range(min = 1))))]
    pub never_firing: Vec<usize>,
    /// Variables and terms that no rule uses.
    pub unused: Vec<TermOf>,
    /// Terms whose degree is 0 for all values of the range.
    pub unreachable: Vec<TermOf>,
    /// Terms of a variable with the same membership function.
    pub equal_terms: Vec<EqualTerms>,
    /// Intervals of an input's range in which the degree of every term is 0.
    pub holes: Vec<TermGap>,
    /// The values that each output takes.
    pub reach: Vec<Reach>,
    /// Whether all selected points were evaluated for the reach. If evaluation is slow, the search stops early.
    pub reach_complete: bool,
    /// Rules that contradict the trend of their neighbours.
    pub against_trend: Vec<AgainstTrend>,
    /// Points at which an output violates a claim.
    pub counterexamples: Vec<Counterexample>,
    /// Whether all selected points were evaluated for the claims. If evaluation is slow, the search stops early.
    pub counterexamples_complete: bool,
    /// Points at which an output jumps.
    pub jumps: Vec<Jump>,
    /// Whether all selected points were evaluated for jumps. If evaluation is slow, the search stops early.
    pub jumps_complete: bool,
}

/// Analyses the model of an engine.
///
/// In the analyses of conditions and terms (uncovered boxes, rules that never fire, holes, trends), an output
/// that rules read counts as an input that can take any value of its range. Reach, claims and jumps are computed
/// for the whole model over its inputs. The degree of an interval type-2 term is its upper degree, and the value
/// of an output is the middle of its interval.
///
/// # Errors
/// A claim of `options` names an input or output that the model does not have.
///
/// # Example: a rule set in which a rule is missing
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
    let (counterexamples, counterexamples_complete) = claims(engine, &options.monotone)?;
    let (first, later) = stages(model);
    let stages: Vec<Stage<'_>> = core::iter::once(first).chain(later).collect();
    // The searches for uncovered boxes and for rules that never fire use the upper degrees. This would be wrong if NOT
    // is applied to a type-2 term, so both searches are skipped in that case.
    let (never_firing, (uncovered, uncovered_complete)) = match model.negates_type2() {
        true => (Vec::new(), (Vec::new(), false)),
        false => (
            never_firing(&stages),
            all_uncovered(&stages, options.coverage),
        ),
    };
    let read = model.outputs.iter().map(|output| &output.variable);
    let read = read.filter(|variable| {
        let mut inputs = stages.iter().flat_map(|stage| &stage.model.inputs);
        inputs.any(|input| input.name == variable.name)
    });
    let holes = model.inputs.iter().chain(read).flat_map(terms::holes);
    let mut probe = probe::Probe::new(model, engine);
    let reach = probe.with_part(0.5, probe::Probe::reach);
    let reach_complete = core::mem::replace(&mut probe.is_complete, true);
    let jumps = probe.jumps();
    Ok(Report {
        uncovered,
        uncovered_complete,
        contradictions: rules::contradictions(model),
        subsumed: rules::subsumed(model),
        unused: terms::unused(model),
        unreachable: terms::unreachable(model, &never_firing),
        never_firing,
        equal_terms: model.variables().flat_map(terms::equal).collect(),
        holes: holes.collect(),
        reach,
        reach_complete,
        against_trend: stages.iter().flat_map(against_trend).collect(),
        counterexamples,
        counterexamples_complete,
        jumps,
        jumps_complete: probe.is_complete,
    })
}

/// Evaluates the outputs at many points, and returns the worst counterexample to each claim about each output. The
/// result is empty if the claims are true at these points.
///
/// # Errors
/// A claim names an input or output that the model does not have.
///
/// # Example: a fan that slows down at the highest temperatures
/// ```
/// use fuzzy::{
///     Engine, Model,
///     check::{self, Direction, Monotone},
/// };
///
/// let model: Model = "
/// fuzzy: 1
/// name: fan
/// inputs: {heat: {range: [0, 40], partition: [low, medium, high]}}
/// outputs: {speed: {range: [0, 9], partition: [slow, fast]}}
/// rules: [IF heat IS medium THEN speed IS fast, IF heat IS high THEN speed IS slow]
/// ".parse()?;
/// let claim = Monotone::new("heat", Direction::Increasing);
/// let found = check::counterexamples(&Engine::new(&model)?, &[claim])?;
/// assert_eq!((found[0].at[0].value, found[0].to), (20.0, 40.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn counterexamples(
    engine: &Engine,
    claims: &[Monotone],
) -> Result<Vec<Counterexample>, alloc::boxed::Box<Diagnostic>> {
    self::claims(engine, claims).map(|(found, _)| found)
}

/// Works like [`counterexamples`], and also returns whether all selected points were evaluated.
fn claims(
    engine: &Engine,
    claims: &[Monotone],
) -> Result<(Vec<Counterexample>, bool), alloc::boxed::Box<Diagnostic>> {
    for claim in claims {
        known(engine.model(), claim)?;
    }
    let mut probe = probe::Probe::new(engine.model(), engine);
    let found = claims.iter().flat_map(|claim| probe.counterexamples(claim));
    Ok((found.collect(), probe.is_complete))
}

/// Checks a rule set that was parsed from a text. Returns the warnings of the parser and the results of the analysis as
/// findings with positions. `engine` must be compiled from the document.
///
/// # Errors
/// Fails like [`check`].
pub fn document(
    document: &Document,
    engine: &Engine,
    text: &str,
    options: &Options,
) -> Result<(Findings, Report), alloc::boxed::Box<Diagnostic>> {
    let report = check(engine, options)?;
    let mut findings = document.warnings.0.clone();
    findings.extend(report.findings(&document.model, &document.spans));
    Ok((Findings::locate(findings, text), report))
}

/// Returns the rules that cannot fire, in ascending order.
fn never_firing(stages: &[Stage<'_>]) -> Vec<usize> {
    let of_stage = |stage: &Stage<'_>| {
        let rules = rules::never_firing(&stage.model).into_iter();
        rules
            .filter_map(|rule| stage.rules.get(rule).copied())
            .collect::<Vec<_>>()
    };
    let mut found: Vec<usize> = stages.iter().flat_map(of_stage).collect();
    found.sort_unstable();
    found.dedup();
    found
}

/// Returns the rules of a stage that contradict the trend, with their indices in the whole model.
fn against_trend(stage: &Stage<'_>) -> Vec<AgainstTrend> {
    let mut found = trend::against(&stage.model);
    for one in &mut found {
        for rule in [&mut one.from_rule, &mut one.to_rule] {
            *rule = stage.rules.get(*rule).copied().unwrap_or(*rule);
        }
    }
    found
}

/// Returns the uncovered boxes of all outputs: first those in which no rule fires at all, then those in which no rule
/// reaches the coverage.
fn all_uncovered(stages: &[Stage<'_>], coverage: f64) -> (Vec<UncoveredRegion>, bool) {
    let mut found: Vec<UncoveredRegion> = Vec::new();
    let mut complete = true;
    let mut shared = coverage::SearchBudget::new();
    let mut known = alloc::vec![logic::Changes::new(); stages.len()];
    for level in [None, Some(coverage)] {
        let outputs = stages.iter().enumerate().flat_map(|(index, stage)| {
            let outputs = stage.model.outputs.iter();
            outputs.map(move |output| (index, &*stage.model, output))
        });
        for (stage, model, output) in outputs {
            let Some(known) = known.get_mut(stage) else {
                continue;
            };
            let name = &output.variable.name;
            let boxes = coverage::uncovered(model, name, level, &mut shared, known);
            complete &= boxes.complete;
            let new = boxes.found.into_iter().filter(|one| {
                // If no rule fires in a box, no rule reaches the coverage there either. Such a box is not listed a
                // second time.
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
    /// Converts the report to diagnostics with positions. Findings that the author accepts are omitted. Each entry
    /// of `allow` that accepts no finding is reported, unless the analysis is incomplete.
    #[must_use]
    pub fn findings(&self, model: &Model, spans: &Spans) -> Vec<Diagnostic> {
        let mut found = findings::of(self, model, spans);
        let accepted = AcceptedFindings::remove(&model.allow, &mut found);
        if self.uncovered_complete && self.reach_complete && self.jumps_complete {
            found.extend(AcceptedFindings::unneeded(&accepted, &spans.allow));
        }
        found
    }

    /// Returns the entries of [`Model::allow`], each with the number of findings that it accepts.
    #[must_use]
    pub fn accepted(&self, model: &Model) -> Vec<AcceptedFindings> {
        let mut found = findings::of(self, model, &Spans::default());
        AcceptedFindings::remove(&model.allow, &mut found)
    }
}

/// Formats a number for a message: at most six digits, with very small and very large numbers as `1e-9`.
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
