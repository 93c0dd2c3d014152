//! The identified rule set: as a report in text, as JSON, and as a file.

use std::io::Write;

use flagred_tuning::identify::IdentifyValidation;
use fuzzy::{
    drawing::{short, visible},
    model::ProvenanceStep,
};
use schemars::JsonSchema;
use serde::Serialize;

use super::{Arguments, IdentifyOutcome};
use crate::{
    failure::Failure,
    held_out::{self, ConfusionDocument, IntervalDocument, divided, figure},
    provenance,
};

/// Maximum number of columns without numbers that are shown.
const SHOWN: usize = 12;

/// The rule set with a provenance step for this command.
pub(super) fn rule_set(
    arguments: &Arguments,
    outcome: &IdentifyOutcome,
) -> Result<String, Failure> {
    let validation = outcome
        .validation
        .as_ref()
        .map_or_else(String::new, |validation| {
            format!(
                "; cross-validation error (RMS, {} folds): {}; of a linear regression: {}",
                validation.folds,
                short(validation.identified.value),
                short(validation.linear.value)
            )
        });
    let step = ProvenanceStep {
        command: "flagred identify".into(),
        data: provenance::data(&arguments.data)?,
        rows: Some(outcome.rows as u64),
        seed: Some(arguments.seed),
        note: Some(format!("from {} columns{validation}", outcome.columns)),
        ..ProvenanceStep::default()
    };
    provenance::rule_set("", outcome.identified.model.clone(), step)
}

pub(super) fn words(
    out: &mut dyn Write,
    arguments: &Arguments,
    outcome: &IdentifyOutcome,
) -> std::io::Result<()> {
    held_out::rows(out, outcome.rows, &outcome.refused)?;
    writeln!(out, "columns     {} examined", outcome.columns)?;
    for name in outcome.without_numbers.iter().take(SHOWN) {
        writeln!(out, "            `{}` contains no number", visible(name))?;
    }
    let identified = &outcome.identified;
    let things = if arguments.clusters {
        "clusters"
    } else {
        "terms"
    };
    let steps = identified.steps.iter();
    let changes: Vec<String> = steps
        .map(|step| format!("{}, {} {things}", visible(&step.input), step.terms))
        .collect();
    let width = changes.iter().map(|change| change.chars().count()).max();
    let width = width.unwrap_or(0);
    for (i, (step, change)) in identified.steps.iter().zip(&changes).enumerate() {
        let title = if i == 0 { "steps" } else { "" };
        let left_out = short(step.cv_error);
        let note = if i == 0 {
            " cross-validation error (RMS)"
        } else {
            ""
        };
        writeln!(out, "{title:<11} {change:<width$}  {left_out}{note}")?;
    }
    let missing = match identified.without_rows {
        0 => String::new(),
        1 => "; 1 combination of terms without rows has no rule".to_owned(),
        count => format!("; {count} combinations of terms without rows have no rule"),
    };
    let inputs = identified.columns.len();
    writeln!(
        out,
        "rules       {} over {inputs} input{}{missing}",
        identified.model.rules.len(),
        if inputs == 1 { "" } else { "s" }
    )?;
    if let Some(validation) = &outcome.validation {
        cross_validation(out, arguments, validation)?;
    }
    Ok(())
}

/// Writes the cross-validation error of the whole search.
fn cross_validation(
    out: &mut dyn Write,
    arguments: &Arguments,
    validation: &IdentifyValidation,
) -> std::io::Result<()> {
    let parts = divided(arguments.group_by.as_ref());
    writeln!(
        out,
        "left out    {} cross-validation error (RMS) of the whole search ({} of {parts}, 95 % intervals)",
        figure(&validation.identified),
        held_out::folds(validation.folds)
    )?;
    let ratio = match validation.ratio {
        ratio if ratio.value < 100.0 => format!("ratio {}", figure(&ratio)),
        _ => "ratio over 100".to_owned(),
    };
    writeln!(
        out,
        "            {} of a linear regression on all columns; {ratio}",
        figure(&validation.linear)
    )?;
    writeln!(out, "            {} of the mean", figure(&validation.mean))?;
    if let Some(confusion) = &validation.confusion {
        held_out::confusion(out, confusion, |_| None)?;
    }
    if validation.without_value > 0 {
        writeln!(
            out,
            "            {} rows without a value: no rule fires there; the mean is used instead",
            validation.without_value
        )?;
    }
    Ok(())
}

/// The version of the JSON document.
const SCHEMA: &str = "flagred.identify/1";

/// The document of `--json`.
#[derive(Serialize, JsonSchema)]
pub(crate) struct Document<'a> {
    #[schemars(extend("const" = SCHEMA))]
    schema: &'static str,
    rows: RowsDocument<'a>,
    columns: Columns<'a>,
    /// The steps of the search.
    steps: Vec<IdentifyStepDocument<'a>>,
    /// The number of rules.
    rules: usize,
    /// The number of combinations of terms without a rule.
    combinations_without_rows: usize,
    /// The cross-validation; null if it was not requested.
    validation: Option<Validation>,
}

#[derive(Serialize, JsonSchema)]
struct RowsDocument<'a> {
    /// The number of rows that were used.
    used: usize,
    /// The number of rows that cannot be used.
    refused: usize,
    /// The reasons why these rows cannot be used.
    reasons: &'a [String],
}

#[derive(Serialize, JsonSchema)]
struct Columns<'a> {
    /// The number of columns that were examined as inputs.
    looked_at: usize,
    /// The columns without numbers.
    without_numbers: &'a [String],
    /// The inputs of the rule set.
    used: Vec<&'a str>,
}

#[derive(Serialize, JsonSchema)]
struct IdentifyStepDocument<'a> {
    /// The input that was added, or that got another term.
    input: &'a str,
    /// The number of terms of this input after the step, or the number of clusters.
    terms: usize,
    /// The cross-validation error (RMS), in the unit of the output.
    left_out: f64,
}

#[derive(Serialize, JsonSchema)]
struct Validation {
    /// The number of cross-validation folds.
    parts: usize,
    /// The number of rows for which no rule fires; the mean of the other rows is used instead.
    rows_without_value: usize,
    /// The cross-validation error (RMS) of the whole search.
    identified: IntervalDocument,
    /// The cross-validation error (RMS) of a linear regression on all columns.
    linear: IntervalDocument,
    /// The cross-validation error (RMS) of the mean of the training rows.
    mean: IntervalDocument,
    /// `identified` divided by `linear`.
    ratio: IntervalDocument,
    /// The confusion matrix of the cross-validation, if the target contains classes (2 to 10 distinct values, all whole
    /// numbers, with at least 5 rows each on average); else null.
    confusion: Option<ConfusionDocument>,
}

impl<'a> Document<'a> {
    pub(super) fn new(outcome: &'a IdentifyOutcome) -> Document<'a> {
        let identified = &outcome.identified;
        let steps = identified.steps.iter().map(|step| IdentifyStepDocument {
            input: &step.input,
            terms: step.terms,
            left_out: step.cv_error,
        });
        let inputs = identified.model.inputs.iter();
        Document {
            schema: SCHEMA,
            rows: RowsDocument {
                used: outcome.rows,
                refused: outcome.refused.len(),
                reasons: &outcome.refused,
            },
            columns: Columns {
                looked_at: outcome.columns,
                without_numbers: &outcome.without_numbers,
                used: inputs.map(|input| input.name.as_str()).collect(),
            },
            steps: steps.collect(),
            rules: identified.model.rules.len(),
            combinations_without_rows: identified.without_rows,
            validation: outcome.validation.as_ref().map(|validation| Validation {
                parts: validation.folds,
                rows_without_value: validation.without_value,
                identified: (&validation.identified).into(),
                linear: (&validation.linear).into(),
                mean: (&validation.mean).into(),
                ratio: (&validation.ratio).into(),
                confusion: validation.confusion.as_ref().map(Into::into),
            }),
        }
    }
}
