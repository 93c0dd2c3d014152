//! The learned rules: as a report in text, as JSON, and as a rule set.

use std::io::Write;

use flagred::gap::GapMethod;
use flagred_evaluation::learning::{Errors, MethodErrors};
use fuzzy::{check::Counterexample, drawing::visible, model::ProvenanceStep};
use schemars::JsonSchema;
use serde::Serialize;

use super::{Arguments, LearnOutcome};
use crate::{failure::Failure, held_out::listed, provenance, rows::word};

/// The rule set with a provenance step for this command. Degrees are rounded to six digits for readability.
pub(super) fn rule_set(
    arguments: &Arguments,
    outcome: &LearnOutcome,
    model_text: &str,
) -> Result<String, Failure> {
    let learned = &outcome.learned;
    let round = |degree: f64| (degree * 1e6).round() / 1e6;
    let mut model = outcome.model.clone();
    for rule in &mut model.rules {
        rule.confidence = rule.confidence.map(round);
        for beaten in &mut rule.against {
            beaten.degree = round(beaten.degree);
        }
    }
    let step = ProvenanceStep {
        command: "flagred learn".into(),
        data: provenance::data(&arguments.rows.data)?,
        rows: Some(learned.samples),
        note: Some(format!(
            "{} resolution; {} rules learned, {} of them without samples",
            word(&arguments.resolve),
            learned.model.rules.len() - outcome.kept,
            learned.completed,
        )),
        ..ProvenanceStep::default()
    };
    provenance::rule_set(model_text, model, step)
}

pub(super) fn words(
    out: &mut dyn Write,
    arguments: &Arguments,
    outcome: &LearnOutcome,
) -> std::io::Result<()> {
    let learned = &outcome.learned;
    let rules = learned.model.rules.len() - outcome.kept;
    writeln!(
        out,
        "rows       {} used, {} refused",
        learned.samples, outcome.refused_count
    )?;
    listed(out, 11, &outcome.refused, outcome.refused_count)?;
    writeln!(
        out,
        "rules      {rules} learned ({}), {} of them completed from their neighbours; {} kept",
        word(&arguments.resolve),
        learned.completed,
        outcome.kept
    )?;
    writeln!(
        out,
        "conflicts  {} combinations of terms whose rows disagree; {} left out because of few or uncertain rows",
        learned.conflicts, learned.left_out
    )?;
    writeln!(
        out,
        "missing    {} combinations of terms without a rule",
        learned.missing
    )?;
    // Of very many combinations, none is listed.
    if !learned.missing_antecedents.is_empty() {
        let missing = usize::try_from(learned.missing).unwrap_or(usize::MAX);
        listed(out, 11, &learned.missing_antecedents, missing)?;
    }
    if !arguments.rows.claims.is_empty() {
        let found = &outcome.counterexamples;
        let holds = if found.is_empty() { "yes" } else { "no" };
        writeln!(
            out,
            "monotone   {holds}; the consequents of {} rules were changed for this",
            learned.moved
        )?;
        for found in found {
            writeln!(out, "           {}", visible(&found.to_string()))?;
        }
        let help = (!found.is_empty()).then(|| super::monotone_help(outcome));
        if let Some(help) = help.flatten() {
            writeln!(out, "           help: {help}")?;
        }
    }
    match outcome.coverage {
        Some((by_rules, after_filling)) => writeln!(
            out,
            "coverage   {:.1} % of the map by rules, {:.1} % after filling ({})",
            100.0 * by_rules,
            100.0 * after_filling,
            GapMethod::default().name()
        )?,
        None => writeln!(out, "coverage   not computed: too many inputs")?,
    }
    let parts = match &arguments.rows.group_by {
        Some(column) => format!("cross-validation over groups of `{}`", visible(column)),
        None if learned.samples < 10 => "cross-validation".to_owned(),
        None => "10-fold cross-validation".to_owned(),
    };
    match &outcome.errors {
        None => {}
        Some(errors) if errors.rows == 0 => {
            writeln!(out, "error      unknown: too few rows for cross-validation")?;
        }
        Some(errors) => writeln!(
            out,
            "error      {:.2} RMS, {:.2} mean, {:+.2} bias over {} rows ({parts})",
            errors.rmse, errors.mean_absolute, errors.bias, errors.rows
        )?,
    }
    if let Some(gaps) = &outcome.gaps {
        writeln!(
            out,
            "gaps       {} rules left out one by one; error of the interpolation on the rows of these rules",
            gaps.rules
        )?;
        writeln!(
            out,
            "           {:<18} {:>8} {:>8} {:>8} {:>16}",
            "method", "RMS", "mean", "bias", "mean over rules"
        )?;
        let with = ("(with the rule)", &gaps.with_the_rule);
        let methods = gaps.methods.iter().map(|(m, e)| (m.name(), e));
        for (name, errors) in [with].into_iter().chain(methods) {
            let Errors {
                rows,
                rmse,
                mean_absolute,
                bias,
                ..
            } = errors.by_row;
            if rows == 0 {
                writeln!(
                    out,
                    "           {name:<18} {:>8} {:>8} {:>8} {:>16}",
                    "NA", "NA", "NA", "NA"
                )?;
                continue;
            }
            writeln!(
                out,
                "           {name:<18} {rmse:>8.2} {mean_absolute:>8.2} {bias:>+8.2} {:>16.2}",
                errors.by_rule_mean_absolute
            )?;
        }
    }
    Ok(())
}

/// The version of the JSON document.
const SCHEMA: &str = "flagred.learn/1";

/// The document of `--json`.
#[derive(Serialize, JsonSchema)]
pub(crate) struct Document<'a> {
    #[schemars(extend("const" = SCHEMA))]
    schema: &'static str,
    rows: RowsDocument<'a>,
    /// The method that resolves conflicts.
    #[schemars(extend("enum" = ["strongest", "heaviest", "mean"]))]
    resolution: String,
    rules: Rules,
    /// The number of antecedents whose rows disagree.
    conflicts: u64,
    /// The number of antecedents with too few rows or too little confidence.
    left_out: u64,
    missing: MissingDocument,
    /// The check of `--rising` and `--falling`; null if neither was given.
    monotone: Option<Monotone<'a>>,
    /// The coverage of the map; null if it has more than 2,000,000 cells.
    coverage: Option<Coverage>,
    /// The cross-validation; null if there were too few rows or it was not requested.
    cross_validation: Option<&'a Errors>,
    /// The errors of the methods that fill gaps; only with `--compare-gaps`.
    gap_methods: Option<GapMethods<'a>>,
}

#[derive(Serialize, JsonSchema)]
struct RowsDocument<'a> {
    /// The number of rows that were used.
    used: u64,
    /// The number of rows that cannot be used.
    refused: usize,
    /// The reasons why these rows cannot be used.
    reasons: &'a [String],
}

#[derive(Serialize, JsonSchema)]
struct Rules {
    /// The number of learned rules.
    learned: usize,
    /// The number of rules of the original rule set that were kept.
    kept: usize,
    /// The number of learned rules for combinations of terms without rows; each was derived from the nearest
    /// combination with rows.
    completed: u64,
}

#[derive(Serialize, JsonSchema)]
struct MissingDocument {
    /// The number of antecedents without a rule.
    count: u64,
    /// The first of these antecedents.
    antecedents: Vec<String>,
}

#[derive(Serialize, JsonSchema)]
struct Monotone<'a> {
    /// Whether the output follows `--rising` and `--falling`.
    holds: bool,
    /// The number of rules whose consequent was changed so that the output follows `--rising` and `--falling`.
    moved: u64,
    /// The worst counterexample of each claim.
    counterexamples: &'a [Counterexample],
}

#[derive(Serialize, JsonSchema)]
struct Coverage {
    /// The share of the map that rules cover.
    by_rules: f64,
    /// The share of the map with a value after filling.
    after_filling: f64,
    /// The method that fills gaps.
    gap_method: &'static str,
}

#[derive(Serialize, JsonSchema)]
struct GapMethods<'a> {
    /// The number of rules that were left out, one at a time.
    rules_left_out: u32,
    /// The errors with all rules, on the rows of the rules that were left out: a lower bound for the errors of the
    /// methods.
    with_the_rule: &'a Errors,
    /// The errors of each method without the rule.
    methods: Vec<MethodDocument<'a>>,
}

#[derive(Serialize, JsonSchema)]
struct MethodDocument<'a> {
    /// The name of the method.
    method: &'static str,
    #[serde(flatten)]
    errors: &'a MethodErrors,
}

impl<'a> Document<'a> {
    pub(super) fn new(arguments: &Arguments, outcome: &'a LearnOutcome) -> Document<'a> {
        let learned = &outcome.learned;
        let missing = learned.missing_antecedents.iter();
        Document {
            schema: SCHEMA,
            rows: RowsDocument {
                used: learned.samples,
                refused: outcome.refused_count,
                reasons: &outcome.refused,
            },
            resolution: word(&arguments.resolve),
            rules: Rules {
                learned: learned.model.rules.len() - outcome.kept,
                kept: outcome.kept,
                completed: learned.completed,
            },
            conflicts: learned.conflicts,
            left_out: learned.left_out,
            missing: MissingDocument {
                count: learned.missing,
                antecedents: missing.map(ToString::to_string).collect(),
            },
            monotone: (!arguments.rows.claims.is_empty()).then(|| Monotone {
                holds: outcome.counterexamples.is_empty(),
                moved: learned.moved,
                counterexamples: &outcome.counterexamples,
            }),
            coverage: outcome.coverage.map(|(by_rules, after_filling)| Coverage {
                by_rules,
                after_filling,
                gap_method: GapMethod::default().name(),
            }),
            cross_validation: outcome.errors.as_ref().filter(|e| e.rows > 0),
            gap_methods: outcome.gaps.as_ref().map(|gaps| GapMethods {
                rules_left_out: gaps.rules,
                with_the_rule: &gaps.with_the_rule.by_row,
                methods: gaps
                    .methods
                    .iter()
                    .map(|(method, errors)| MethodDocument {
                        method: method.name(),
                        errors,
                    })
                    .collect(),
            }),
        }
    }
}
