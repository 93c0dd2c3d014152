//! `flagred simplify`: a rule set with fewer rules and inputs, whose outputs are the same within a tolerance.

use std::{io::Write, path::PathBuf};

use flagred_tuning::{Difference, SimplifyError, SimplifyResult, SimplifySettings, simplify};
use fuzzy::{
    Model,
    drawing::{short, visible},
    model::ProvenanceStep,
};
use schemars::JsonSchema;
use serde::Serialize;

use crate::{
    failure::{Exit, Failure},
    numbers,
    output::{Files, Replace, Stdout},
    provenance, rows, rule_set, table,
};

#[derive(clap::Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    rewrite: rows::Rewrite,

    /// Tables with a column for each input: the outputs are also compared at their rows
    #[arg(value_name = "TABLE.csv")]
    data: Vec<PathBuf>,

    /// Largest accepted difference of an output, in its unit [default: 1e-12 of its range]
    #[arg(long, value_name = "VALUE", value_parser = numbers::at_least_0)]
    tolerance: Option<f64>,

    /// Compare outputs only at the rows of the tables; elsewhere they may differ by any amount
    #[arg(long, requires = "data")]
    rows_only: bool,

    /// Random seed (test points)
    #[arg(long, default_value_t = 0, value_name = "NUMBER", value_parser = numbers::seed)]
    seed: u64,
}

pub(crate) fn run(arguments: &Arguments) -> Result<Exit, Failure> {
    let rewrite = &arguments.rewrite;
    let command = format!("simplify --output {}", rewrite.output.display());
    table::rule_set_first(&command, &rewrite.model, &arguments.data)?;
    let mut files = Files::reading(arguments.data.iter().chain([&rewrite.model]))?;
    let output = files.output(&rewrite.output, Replace::forced(rewrite.force))?;
    let name = rewrite.model.display().to_string();
    let source = rule_set::read(&rewrite.model)?;
    let model = rule_set::engine(&source, &name)?.model();
    let widest = model
        .outputs
        .iter()
        .map(|output| output.variable.high - output.variable.low);
    let widest = widest.fold(0.0, f64::max);
    if let Some(tolerance) = arguments.tolerance.filter(|tolerance| *tolerance >= widest) {
        let message = format!(
            "a tolerance of {} allows any output: the widest range is {}",
            short(tolerance),
            short(widest)
        );
        return Err(Failure::usage(message)
            .help("write a smaller `--tolerance`, in the unit of the output"));
    }
    let (rows, refused) = rows(arguments, model)?;
    let mut settings = SimplifySettings::default();
    settings.tolerance = arguments.tolerance;
    settings.rows_only = arguments.rows_only;
    settings.seed = arguments.seed;
    let simplified = simplify(model, &rows, &settings).map_err(|error| {
        let help = match error {
            SimplifyError::NoRows => {
                "the tables contain no rows; leave out `--rows-only`"
            }
            SimplifyError::TooManyRules { .. } => {
                "learn it with fewer rules, for example with a higher `--min-support`, or split it by outputs"
            }
            SimplifyError::Type2 => "remove the keys that make terms type-2, such as `blur` or `lower`, to simplify the rules",
            _ => "`flagred check` shows what is wrong with the rule set",
        };
        Failure::unusable(format!("`{name}`"), &error).help(help)
    })?;
    let outcome = SimplifyOutcome {
        arguments,
        model,
        rows: rows.first().map_or(0, Vec::len),
        refused,
        simplified,
    };
    output.write(&outcome.rule_set(source.text())?)?;
    let mut out = Stdout::beside(&[&output]);
    if rewrite.json {
        serde_json::to_writer_pretty(&mut out, &outcome.document())
            .map_err(std::io::Error::from)?;
        writeln!(out)?;
    } else {
        outcome.words(&mut out)?;
    }
    out.finish()?;
    Ok(Exit::Clean)
}

/// Returns a column of usable rows for each input, and the reasons why other rows cannot be used.
fn rows(arguments: &Arguments, model: &Model) -> Result<(Vec<Vec<f64>>, Vec<String>), Failure> {
    if arguments.data.is_empty() {
        return Ok((Vec::new(), Vec::new()));
    }
    let names: Vec<&str> = model.inputs.iter().map(|input| &*input.name).collect();
    let format = &arguments.rewrite.format;
    let rows::Data { rows, refused } = rows::columns(
        rows::tables(&arguments.data, format),
        format,
        &names,
        &[],
        [None; 2],
    )?;
    if !refused.is_empty() && !format.skip_bad_rows {
        return Err(rows::refuse(
            &refused,
            refused.len() + rows.len(),
            "compared",
        ));
    }
    let column = |input: usize| {
        let rows = rows.iter();
        rows.filter_map(|(row, _)| row.values.get(input).copied())
            .collect()
    };
    Ok(((0..names.len()).map(column).collect(), refused))
}

struct SimplifyOutcome<'a> {
    arguments: &'a Arguments,
    model: &'a Model,
    rows: usize,
    refused: Vec<String>,
    simplified: SimplifyResult,
}

impl SimplifyOutcome<'_> {
    /// The allowed difference, as text.
    fn allowed(&self) -> String {
        match self.arguments.tolerance {
            Some(tolerance) => format!("{tolerance}"),
            None => format!("{:e} of the range", flagred_tuning::EQUAL_TOLERANCE),
        }
    }

    fn points(&self) -> String {
        let points = self.simplified.points;
        match (self.arguments.rows_only, self.rows) {
            (true, _) => format!("{points} rows"),
            (false, 0) => format!("{points} points"),
            (false, rows) => format!("{points} points, {rows} of them rows"),
        }
    }

    /// The rule set with a provenance step for this command.
    fn rule_set(&self, model_text: &str) -> Result<String, Failure> {
        let after = self.simplified.model.clone();
        let step = ProvenanceStep {
            command: "flagred simplify".into(),
            data: provenance::data(&self.arguments.data)?,
            rows: (self.rows > 0).then_some(self.rows as u64),
            seed: Some(self.arguments.seed),
            rules: Some([self.model.rules.len() as u64, after.rules.len() as u64]),
            note: Some(format!(
                "no output differs by more than {} at {}",
                self.allowed(),
                self.points()
            )),
            ..ProvenanceStep::default()
        };
        provenance::rule_set(model_text, after, step)
    }

    fn words(&self, out: &mut dyn Write) -> std::io::Result<()> {
        let after = &self.simplified.model;
        writeln!(
            out,
            "rules       {} before, {} after",
            self.model.rules.len(),
            after.rules.len()
        )?;
        if !self.simplified.dropped.is_empty() {
            writeln!(out, "dropped     {}", listed(&self.simplified.dropped))?;
        }
        for name in &self.simplified.inputs {
            writeln!(
                out,
                "dropped     input `{}`: no rule needs it",
                visible(name)
            )?;
        }
        let ors = [self.model, after].map(disjunction);
        if ors[0] != ors[1] {
            writeln!(
                out,
                "or          {} before, {} after; no rule contains OR",
                ors[0], ors[1]
            )?;
        }
        let (points, allowed) = (self.points(), self.allowed());
        match &self.simplified.difference {
            None => writeln!(out, "difference  none at {points}; allowed is {allowed}")?,
            Some(difference) => {
                let at = self.named(difference);
                let at = at.map(|one| format!("{} = {}", one.input, short(one.value)));
                writeln!(
                    out,
                    "difference  at most {} of `{}` at {points}; allowed is {allowed}",
                    tiny(size(difference)),
                    visible(&difference.output)
                )?;
                writeln!(
                    out,
                    "            {} before, {} after, at {}",
                    short(difference.before),
                    short(difference.after),
                    visible(&at.collect::<Vec<_>>().join(", "))
                )?;
            }
        }
        if !self.refused.is_empty() {
            writeln!(out, "refused     {} rows", self.refused.len())?;
        }
        for (i, (rule, of)) in after.rules.iter().zip(&self.simplified.rules).enumerate() {
            if of
                .iter()
                .any(|before| self.model.rules.get(*before).map(|b| &b.rule) != Some(&rule.rule))
            {
                writeln!(
                    out,
                    "{:<11} of {}: {}",
                    format!("rule {}", i + 1),
                    listed(of),
                    visible(&rule.rule.to_string())
                )?;
            }
        }
        Ok(())
    }

    /// The names and values of the inputs at a difference.
    fn named<'a>(&'a self, difference: &'a Difference) -> impl Iterator<Item = InputDocument<'a>> {
        let inputs = self.model.inputs.iter().zip(&difference.inputs);
        inputs.map(|(input, value)| InputDocument {
            input: &input.name,
            value: *value,
        })
    }

    fn document(&self) -> Document<'_> {
        let simplified = &self.simplified;
        let rules = simplified.model.rules.iter().zip(&simplified.rules);
        let ors = [self.model, &simplified.model].map(disjunction);
        Document {
            schema: SCHEMA,
            rules: Rules {
                before: self.model.rules.len(),
                after: simplified.model.rules.len(),
                dropped: simplified.dropped.iter().map(|rule| rule + 1).collect(),
                list: rules
                    .map(|(rule, of)| RuleDocument {
                        rule: rule.rule.to_string(),
                        of: of.iter().map(|rule| rule + 1).collect(),
                    })
                    .collect(),
            },
            dropped_inputs: &simplified.inputs,
            or: Change {
                before: ors[0],
                after: ors[1],
            },
            points: Points {
                all: simplified.points,
                rows: self.rows,
                refused: self.refused.len(),
                reasons: &self.refused,
            },
            tolerance: self.arguments.tolerance,
            difference: simplified
                .difference
                .as_ref()
                .map(|difference| DifferenceDocument {
                    output: &difference.output,
                    size: size(difference),
                    before: difference.before,
                    after: difference.after,
                    inputs: self.named(difference).collect(),
                }),
        }
    }
}

fn size(difference: &Difference) -> f64 {
    (difference.after - difference.before).abs()
}

/// Formats a number that may be far below 1.
fn tiny(value: f64) -> String {
    if value < 1e-3 {
        format!("{value:.1e}")
    } else {
        short(value)
    }
}

/// Lists rule numbers: `rules 2, 3`.
fn listed(rules: &[usize]) -> String {
    let numbers: Vec<String> = rules.iter().map(|rule| (rule + 1).to_string()).collect();
    let plural = if numbers.len() == 1 { "" } else { "s" };
    format!("rule{plural} {}", numbers.join(", "))
}

/// The word in the rule format for the function that evaluates OR.
fn disjunction(model: &Model) -> &'static str {
    fuzzy::format::word_of_or(model.operators.or)
}

/// The version of the JSON document.
const SCHEMA: &str = "flagred.simplify/1";

/// The document of `--json`.
#[derive(Serialize, JsonSchema)]
pub(crate) struct Document<'a> {
    #[schemars(extend("const" = SCHEMA))]
    schema: &'static str,
    rules: Rules,
    /// The inputs that no rule needs.
    dropped_inputs: &'a [String],
    /// The function for OR; it changes only if no rule contains OR.
    or: Change,
    /// The points at which both rule sets were compared.
    points: Points<'a>,
    /// The allowed difference of an output; null means 1e-12 of its range.
    tolerance: Option<f64>,
    /// The largest difference; null if the outputs are equal.
    difference: Option<DifferenceDocument<'a>>,
}

#[derive(Serialize, JsonSchema)]
struct Rules {
    /// The number of rules before simplification.
    before: usize,
    /// The number of rules after simplification.
    after: usize,
    /// The rules that had no effect, by their numbers in the original rule set.
    #[schemars(inner(range(min = 1)))]
    dropped: Vec<usize>,
    /// The rules of the simplified rule set.
    list: Vec<RuleDocument>,
}

#[derive(Serialize, JsonSchema)]
struct RuleDocument {
    /// The text of the rule.
    rule: String,
    /// The rules that this rule replaces, by their numbers in the original rule set.
    #[schemars(inner(range(min = 1)))]
    of: Vec<usize>,
}

#[derive(Serialize, JsonSchema)]
struct Change {
    /// The function for OR before simplification.
    before: &'static str,
    /// The function for OR after simplification.
    after: &'static str,
}

#[derive(Serialize, JsonSchema)]
struct Points<'a> {
    /// The number of all points.
    all: usize,
    /// The number of these points that are rows of the data.
    rows: usize,
    /// The number of rows that cannot be used.
    refused: usize,
    /// The reasons why these rows cannot be used.
    reasons: &'a [String],
}

#[derive(Serialize, JsonSchema)]
struct DifferenceDocument<'a> {
    /// The output.
    output: &'a str,
    /// The size of the difference.
    size: f64,
    /// The value of the output before simplification.
    before: f64,
    /// The value of the output after simplification.
    after: f64,
    /// The values of the inputs at this difference.
    inputs: Vec<InputDocument<'a>>,
}

#[derive(Serialize, JsonSchema)]
struct InputDocument<'a> {
    /// The input.
    input: &'a str,
    /// The value of this input.
    value: f64,
}
