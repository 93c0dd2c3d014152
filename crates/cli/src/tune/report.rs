//! The tuned rule set: as a report in text, as JSON, and as a file.

use std::io::Write;

use flagred_tuning::{Bin, ChangedNumber};
use fuzzy::{
    drawing::{short, visible},
    model::{LossChange, ProvenanceStep, Term},
};
use schemars::JsonSchema;
use serde::Serialize;

use super::{Arguments, LossName, TuneOutcome};
use crate::{
    failure::Failure,
    held_out::{self, ConfusionDocument, IntervalDocument, divided, figure},
    provenance,
    rows::word,
};

fn loss(arguments: &Arguments) -> &'static str {
    match arguments.loss {
        LossName::Squared => "RMS error",
        LossName::Log => "log loss",
        LossName::Ranking => "wrong pairs",
    }
}

/// The rule set with a provenance step for this command.
pub(super) fn rule_set(
    arguments: &Arguments,
    outcome: &TuneOutcome,
    model_text: &str,
) -> Result<String, Failure> {
    let tuned = &outcome.tuned;
    let left_out = outcome.validation.as_ref().map(|validation| {
        format!(
            "cross-validation in {} folds: {} before, {} after",
            validation.folds,
            short(validation.before.value),
            short(validation.after.value)
        )
    });
    let step = ProvenanceStep {
        command: "flagred tune".into(),
        data: provenance::data(&arguments.rows.data)?,
        rows: Some(outcome.rows as u64),
        seed: Some(arguments.seed),
        loss: Some(LossChange {
            name: loss(arguments).into(),
            before: rounded(tuned.before),
            after: rounded(tuned.after),
        }),
        moved: tuned.moved.iter().map(moved).collect(),
        note: left_out,
        ..ProvenanceStep::default()
    };
    provenance::rule_set(model_text, tuned.model.clone(), step)
}

/// Rounds to six digits, for readability.
fn rounded(loss: f64) -> f64 {
    format!("{loss:.5e}").parse().unwrap_or(loss)
}

/// Describes a moved number: `heat.warm peak from 20 to 22.5`.
fn moved(moved: &ChangedNumber) -> String {
    let [before, after] = [moved.before, moved.after].map(short);
    format!("{} {} from {before} to {after}", moved.of, moved.name)
}

pub(super) fn words(
    out: &mut dyn Write,
    arguments: &Arguments,
    outcome: &TuneOutcome,
) -> std::io::Result<()> {
    let tuned = &outcome.tuned;
    held_out::rows(out, outcome.rows, &outcome.refused)?;
    if tuned.without_value > 0 {
        writeln!(
            out,
            "            {} without a value: no rule fires there; they count as the middle of the range",
            tuned.without_value
        )?;
    }
    if outcome.is_resumed {
        writeln!(out, "started     with the checkpoint")?;
    }
    let ended = if tuned.is_stopped {
        "; ended early"
    } else {
        ""
    };
    let name = loss(arguments);
    writeln!(
        out,
        "{name:<11} {} before, {} after{ended}",
        short(tuned.before),
        short(tuned.after)
    )?;
    if let Some(validation) = &outcome.validation {
        let parts = divided(arguments.rows.group_by.as_ref());
        writeln!(
            out,
            "left out    {} before, {} after; gain {} ({} of {parts}, 95 % intervals)",
            figure(&validation.before),
            figure(&validation.after),
            figure(&validation.gain),
            held_out::folds(validation.folds)
        )?;
        for (i, bin) in validation.reliability.iter().enumerate() {
            let (title, note) = match i {
                0 => ("reliability", " left out"),
                _ => ("", ""),
            };
            let Bin {
                rows,
                predicted,
                observed,
            } = bin;
            writeln!(
                out,
                "{title:<11} {predicted:.3} predicted, {observed:.3} observed, {rows} rows{note}"
            )?;
        }
        if let Some(confusion) = &validation.confusion {
            let model = &outcome.tuned.model;
            let output = model.measured_output();
            let output = output.and_then(|output| model.outputs.get(output));
            held_out::confusion(out, confusion, |class| {
                let terms = &output?.variable.terms;
                let is_class = |term: &&Term| term.membership_function.number() == Some(class);
                Some(terms.iter().find(is_class)?.name.clone())
            })?;
        }
    }
    for (i, point) in outcome.curve.iter().flatten().enumerate() {
        let title = if i == 0 { "curve" } else { "" };
        let left_out = short(point.unseen_loss);
        let note = if i == 0 {
            " cross-validated, tuned on this share of the other rows"
        } else {
            ""
        };
        writeln!(
            out,
            "{title:<11} {:>5.1} %  {left_out}{note}",
            100.0 * point.share
        )?;
    }
    let width = tuned
        .moved
        .iter()
        .map(|moved| moved.of.chars().count())
        .max()
        .unwrap_or(0);
    for (i, moved) in tuned.moved.iter().enumerate() {
        let title = if i == 0 { "moved" } else { "" };
        let ChangedNumber {
            of,
            name,
            before,
            after,
        } = moved;
        writeln!(
            out,
            "{title:<11} {:<width$} {} {} -> {}",
            visible(of),
            visible(name),
            short(*before),
            short(*after)
        )?;
    }
    if tuned.moved.is_empty() {
        let within = match tuned.at_bounds.is_empty() {
            true => "",
            false => " within the range",
        };
        writeln!(out, "moved       nothing: no step{within} reduces the loss")?;
    }
    if !tuned.at_bounds.is_empty() {
        let names = tuned.at_bounds.iter().map(|name| visible(name));
        let names: Vec<String> = names.map(|name| name.into_owned()).collect();
        let remedy = match arguments.beyond_range {
            true => "check the units of the column, or widen `range`",
            false => "check the units of the column, widen `range`, or use `--beyond-range`",
        };
        writeln!(
            out,
            "at bounds   {}: the rows require values beyond the range; {remedy}",
            names.join(", ")
        )?;
    }
    Ok(())
}

/// The version of the JSON document.
const SCHEMA: &str = "flagred.tune/1";

/// The document of `--json`.
#[derive(Serialize, JsonSchema)]
pub(crate) struct Document<'a> {
    #[schemars(extend("const" = SCHEMA))]
    schema: &'static str,
    rows: RowsDocument<'a>,
    /// `squared`, `log` or `ranking`.
    #[schemars(extend("enum" = ["squared", "log", "ranking"]))]
    loss: String,
    /// The loss before tuning: the RMS error, the mean log loss, or the share of pairs in the wrong
    /// order.
    before: f64,
    /// The loss after tuning, in the same unit.
    after: f64,
    /// Whether the user interrupted the search.
    ended_early: bool,
    /// Whether the search began with a checkpoint.
    from_checkpoint: bool,
    /// The cross-validation; null if it was not requested.
    validation: Option<ValidationDocument>,
    /// The learning curve; null if it was not requested.
    learning_curve: Option<Vec<CurvePointDocument>>,
    /// The numbers that tuning changed.
    moved: Vec<ChangedNumberDocument<'a>>,
    /// Constants, as `variable.term`, that are at an end of the range although values beyond it
    /// would reduce the loss.
    at_bounds: &'a [String],
}

#[derive(Serialize, JsonSchema)]
struct RowsDocument<'a> {
    /// The number of rows that were used.
    used: usize,
    /// The number of rows for which no rule fires; they count as the middle of the range.
    without_value: usize,
    /// The number of rows that cannot be used.
    refused: usize,
    /// The reasons why these rows cannot be used.
    reasons: &'a [String],
}

#[derive(Serialize, JsonSchema)]
struct ValidationDocument {
    /// The number of cross-validation folds.
    parts: usize,
    /// The cross-validated loss before tuning.
    before: IntervalDocument,
    /// The cross-validated loss after tuning.
    after: IntervalDocument,
    /// The reduction of the loss.
    gain: IntervalDocument,
    /// The cross-validated predictions in ten bins, if the outcomes are 0 and 1; else empty.
    reliability: Vec<BinDocument>,
    /// The confusion matrix of the cross-validation, if the output's column contains classes (2 to 10 distinct values,
    /// all whole numbers, with at least 5 rows each on average); else null.
    confusion: Option<ConfusionDocument>,
}

#[derive(Serialize, JsonSchema)]
struct BinDocument {
    /// The number of rows.
    rows: usize,
    /// The mean of the predictions, as positions in the range of the output from 0 to 1.
    predicted: f64,
    /// The share of rows with the outcome 1.
    observed: f64,
}

#[derive(Serialize, JsonSchema)]
struct CurvePointDocument {
    /// The share of the training rows or groups that was used.
    share: f64,
    /// The cross-validated loss.
    left_out: f64,
}

#[derive(Serialize, JsonSchema)]
struct ChangedNumberDocument<'a> {
    /// The term (`variable.term`) or rule (`rule 3`) whose number changed.
    of: &'a str,
    /// The number that moved, such as `peak`.
    name: &'a str,
    /// The value before tuning.
    before: f64,
    /// The value after tuning.
    after: f64,
}

impl<'a> Document<'a> {
    pub(super) fn new(arguments: &Arguments, outcome: &'a TuneOutcome) -> Document<'a> {
        let bin = |bin: &Bin| BinDocument {
            rows: bin.rows,
            predicted: bin.predicted,
            observed: bin.observed,
        };
        let tuned = &outcome.tuned;
        let moved = tuned.moved.iter().map(|moved| ChangedNumberDocument {
            of: &moved.of,
            name: &moved.name,
            before: moved.before,
            after: moved.after,
        });
        Document {
            schema: SCHEMA,
            rows: RowsDocument {
                used: outcome.rows,
                without_value: tuned.without_value,
                refused: outcome.refused.len(),
                reasons: &outcome.refused,
            },
            loss: word(&arguments.loss),
            before: tuned.before,
            after: tuned.after,
            ended_early: tuned.is_stopped,
            from_checkpoint: outcome.is_resumed,
            validation: outcome
                .validation
                .as_ref()
                .map(|validation| ValidationDocument {
                    parts: validation.folds,
                    before: (&validation.before).into(),
                    after: (&validation.after).into(),
                    gain: (&validation.gain).into(),
                    reliability: validation.reliability.iter().map(bin).collect(),
                    confusion: validation.confusion.as_ref().map(Into::into),
                }),
            learning_curve: outcome.curve.as_ref().map(|curve| {
                let points = curve.iter().map(|point| CurvePointDocument {
                    share: point.share,
                    left_out: point.unseen_loss,
                });
                points.collect()
            }),
            moved: moved.collect(),
            at_bounds: &tuned.at_bounds,
        }
    }
}
