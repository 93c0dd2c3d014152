//! `flagred learn`: rules from rows of data.

pub(crate) mod report;

pub(crate) use report::Document;

use std::io::Write as _;

use clap::ValueEnum;
use flagred::gap::{FilledMap, Filling, GapMethod, GapSettings};
use flagred_evaluation::learning::{
    Errors, ExamineError, GapComparison, Row, cross_validate, leave_one_rule_out,
};
use fuzzy::{
    Engine, Model,
    check::{self, Counterexample},
    learn::{Direction, LastStage, LearnError, LearnResult, Learner, Resolution, Settings},
    map::{DecisionMap, Grid},
    model::{Aggregation, Conjunction, Implication},
};

use crate::{
    failure::{Exit, Failure},
    numbers::{self, whole},
    output::Stdout,
    rows::{self, Clamped},
    rule_set,
};

#[derive(clap::Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    rows: rows::DerivationArguments,

    /// How to choose the consequent if several rows have the same input terms
    #[arg(long, value_enum, default_value = "strongest", value_name = "HOW")]
    resolve: Resolve,

    /// Minimum number of rows for a rule
    #[arg(long, default_value_t = 1, value_name = "ROWS", value_parser = whole(1, u64::MAX))]
    min_support: u64,

    /// Minimum confidence of a rule, from 0 to 1; how it is computed depends on `--resolve`
    #[arg(long, default_value_t = 0.0, value_name = "CONFIDENCE", value_parser = numbers::degree)]
    min_degree: f64,

    /// Add rules for combinations of terms without rows, each from the nearest combination with rows
    #[arg(long)]
    complete: bool,

    /// Keep the rules of the rule set; otherwise the learned rules replace them
    #[arg(long)]
    keep_rules: bool,

    /// Compare the methods of interpolation on rows whose rule is left out
    #[arg(long)]
    compare_gaps: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Resolve {
    /// The row with the highest degree wins, as in the paper; the confidence is its degree
    Strongest,
    /// The consequent with the highest sum of degrees wins; the confidence is its share of the sum
    Heaviest,
    /// The consequent that fits the mean of the rows best wins; the confidence is its share of the sum of degrees
    Mean,
}

/// The results for the report.
struct LearnOutcome {
    learned: LearnResult,
    /// The rule set with the learned rules.
    model: Model,
    kept: usize,
    refused: Vec<String>,
    refused_count: usize,
    coverage: Option<(f64, f64)>,
    errors: Option<Errors>,
    gaps: Option<GapComparison>,
    /// Claims about the output: `--rising`, `--falling`.
    claims: Vec<check::Monotone>,
    /// Counterexamples to the claims.
    counterexamples: Vec<Counterexample>,
}

pub(crate) fn run(arguments: &Arguments) -> Result<Exit, Failure> {
    let (_, output) = arguments.rows.files("learn")?;
    let name = arguments.rows.rewrite.model.display().to_string();
    let source = rule_set::read(&arguments.rows.rewrite.model)?;
    let whole = &rule_set::document(&source, &name)?.model;
    let wrong =
        |error: LearnError| Failure::unusable(format!("`{name}`"), &error).help(error.help());
    let chain = LastStage::new(whole).map_err(wrong)?;
    let mut model = chain.model().clone();
    if !arguments.keep_rules {
        model.rules.clear();
    }
    let learned = whole.measured_output();
    let learned = learned.and_then(|output| whole.outputs.get(output));
    let learned = learned.map_or("", |output| output.variable.name.as_str());
    arguments.rows.claims.check_inputs(whole)?;
    let claims = arguments.rows.claims.about(learned)?;
    let settings = settings(arguments, &claims);
    let mut learner = Learner::new(&model, settings.clone()).map_err(wrong)?;
    // `--clamp` also clamps the output, because a learned rule concludes a term, and values beyond the range belong to
    // no term.
    let data = rows::read(&arguments.rows, whole, Clamped::All)?;
    let mut rows = Vec::with_capacity(data.rows.len());
    let mut refused = data.refused;
    for (row, place) in data.rows {
        let values = chain.values(&row.values);
        let added = values.and_then(|values| {
            learner.add(&values, row.weight)?;
            Ok(Row { values, ..row })
        });
        match added {
            Ok(row) => rows.push(row),
            Err(refusal) => refused.push(format!("{place}: {refusal}")),
        }
    }
    if !refused.is_empty() && (!arguments.rows.rewrite.format.skip_bad_rows || rows.is_empty()) {
        return Err(rows::refuse(
            &refused,
            refused.len() + rows.len(),
            "learned from",
        ));
    }
    let learned = learner.finish();
    if learned.model.rules.is_empty() {
        let message = format!("no rule was learned from {} rows", rows.len());
        return Err(
            Failure::usage(message).help("lower `--min-support` and `--min-degree`, or add rows")
        );
    }
    let gap = GapSettings::default();
    let examined = |error: ExamineError| Failure::unreadable(error.to_string());
    let coverage = coverage(&learned.model, &gap)?;
    let whole = chain.joined(&learned.model);
    let counterexamples = counterexamples(&claims, &whole)?;
    let outcome = LearnOutcome {
        model: whole,
        kept: model.rules.len(),
        refused_count: refused.len(),
        refused,
        coverage,
        errors: match arguments.rows.no_validation {
            true => None,
            false => Some(cross_validate(&model, &settings, &gap, &rows).map_err(examined)?),
        },
        gaps: match arguments.compare_gaps {
            true => {
                let compared = leave_one_rule_out(&learned.model, &rows, &GapMethod::ALL, None);
                Some(compared.map_err(examined)?)
            }
            false => None,
        },
        learned,
        claims,
        counterexamples,
    };
    output.write(&report::rule_set(arguments, &outcome, source.text())?)?;
    let mut out = Stdout::beside(&[&output]);
    if arguments.rows.rewrite.json {
        let document = report::Document::new(arguments, &outcome);
        serde_json::to_writer_pretty(&mut out, &document).map_err(std::io::Error::from)?;
        writeln!(out)?;
    } else {
        report::words(&mut out, arguments, &outcome)?;
    }
    out.finish()?;
    Ok(match outcome.counterexamples.as_slice() {
        [] => Exit::Clean,
        _ => Exit::Findings,
    })
}

fn settings(arguments: &Arguments, claims: &[check::Monotone]) -> Settings {
    let directed = |claim: &check::Monotone| match claim.direction {
        check::Direction::Increasing => (claim.input.clone(), Direction::Rising),
        check::Direction::Decreasing => (claim.input.clone(), Direction::Falling),
    };
    let mut settings = Settings::default();
    settings.resolution = match arguments.resolve {
        Resolve::Strongest => Resolution::Strongest,
        Resolve::Heaviest => Resolution::Heaviest,
        Resolve::Mean => Resolution::Mean,
    };
    settings.min_support = arguments.min_support;
    settings.min_degree = arguments.min_degree;
    settings.complete = arguments.complete;
    settings.monotone = claims.iter().map(directed).collect();
    settings
}

/// Checks the learned rules for contradictions to `--rising` and `--falling`, as `flagred check` does.
fn counterexamples(
    claims: &[check::Monotone],
    model: &Model,
) -> Result<Vec<Counterexample>, Failure> {
    let engine = Engine::new(model).map_err(unusable)?;
    check::counterexamples(&engine, claims).map_err(unusable)
}

/// Returns advice for making the output monotone, if there is any: with inference by product and
/// sum, monotone rules give a monotone output if every combination of terms has a rule.
fn monotone_help(outcome: &LearnOutcome) -> Option<&'static str> {
    let mut model = outcome.model.clone();
    model.operators.and = Conjunction::Product;
    model.operators.implication = Implication::Product;
    model.operators.aggregation = Aggregation::Sum;
    let holds = counterexamples(&outcome.claims, &model).is_ok_and(|found| found.is_empty());
    match (holds, outcome.learned.missing) {
        (true, _) => Some(
            "the output of these rules is monotone with `operators: {and: product, implication: product, aggregation: sum}`",
        ),
        (false, 0) => None,
        (false, _) => Some(
            "combinations of terms without a rule may be the cause: `--complete` adds rules for them",
        ),
    }
}

/// Maximum number of map cells that `coverage` evaluates: enough for 13 inputs.
const MAX_CELLS: usize = 2_000_000;

fn unusable(error: impl std::fmt::Display) -> Failure {
    Failure::unusable("the learned rules cannot be used", &error)
}

/// Returns the share of the map that rules cover, and the share that has a value after filling;
/// `None` if the map has too many cells.
fn coverage(model: &Model, gap: &GapSettings) -> Result<Option<(f64, f64)>, Failure> {
    let engine = Engine::new(model).map_err(unusable)?;
    let points = crate::map::points_along(model.inputs.len());
    let inputs = u32::try_from(model.inputs.len()).unwrap_or(u32::MAX);
    if points
        .checked_pow(inputs)
        .is_none_or(|cells| cells > MAX_CELLS)
    {
        return Ok(None);
    }
    let grid = Grid::new(&engine, points).map_err(unusable)?;
    let map = DecisionMap::new(&engine, grid, 0).map_err(unusable)?;
    let filling = Filling::new(&engine, model, 0, gap).map_err(unusable)?;
    let filled = FilledMap::new(map, filling);
    let cells = filled.map().grid().cells();
    let known = (0..cells).filter(|cell| filled.value(*cell).is_some());
    let known = known.count() as f64 / cells.max(1) as f64;
    Ok(Some((1.0 - filled.filled_share(), known)))
}
