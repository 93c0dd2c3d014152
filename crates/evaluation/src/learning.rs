//! Errors of learned rules: on samples that were not used for learning, and in regions whose rule is missing.

use std::collections::BTreeMap;

use flagred::gap::{Filling, GapMethod, GapSettings};
use fuzzy::{
    Engine, Model,
    engine::{EvaluateError, Outcome, Scratch},
    learn::{LearnError, Learner, SampleError, Settings},
};

/// A sample to learn from.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// The value of each input of the model, then the risk in %.
    pub values: Vec<f64>,
    /// The weight of the sample.
    pub weight: f64,
    /// The group of the sample, such as its vehicle. Cross-validation keeps the rows of a group together.
    pub group: Option<u32>,
}

/// Errors of predictions on rows, in the unit of the output, weighted by row. NaN if no row was compared.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Errors {
    /// The number of compared rows.
    pub rows: usize,
    /// The number of rows without a prediction.
    pub without_prediction: usize,
    /// The root mean square of the error.
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub rmse: f64,
    /// The mean absolute error.
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub mean_absolute: f64,
    /// The mean of prediction minus truth; above 0 if the predictions are too high.
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub bias: f64,
}

/// Sums of errors.
#[derive(Debug, Clone, Copy, Default)]
struct Tally {
    rows: usize,
    without_prediction: usize,
    weight: f64,
    squares: f64,
    sizes: f64,
    sum: f64,
}

impl Tally {
    fn add(&mut self, prediction: Option<f64>, truth: f64, weight: f64) {
        let Some(prediction) = prediction else {
            self.without_prediction += 1;
            return;
        };
        let error = prediction - truth;
        self.rows += 1;
        self.weight += weight;
        self.squares += weight * error * error;
        self.sizes += weight * error.abs();
        self.sum += weight * error;
    }

    fn errors(&self) -> Errors {
        // Without rows the means are NaN, because an error of 0 would look like the best possible.
        let mean = |sum: f64| sum / self.weight;
        Errors {
            rows: self.rows,
            without_prediction: self.without_prediction,
            rmse: mean(self.squares).sqrt(),
            mean_absolute: mean(self.sizes),
            bias: mean(self.sum),
        }
    }
}

/// The reason why rules cannot be learned from rows or compared with them.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ExamineError {
    /// Nothing can be learned.
    #[error(transparent)]
    Learn(#[from] LearnError),
    /// The rules cannot be used.
    #[error(transparent)]
    Compile(#[from] fuzzy::diagnostic::Findings),
    /// The rules cannot be evaluated.
    #[error(transparent)]
    Evaluate(#[from] EvaluateError),
    /// A row cannot be used for learning.
    #[error("row {row}: {refusal}")]
    Refused {
        /// The index of the row, from 0.
        row: usize,
        /// The reason.
        refusal: SampleError,
    },
}

/// A rule set whose gaps are filled where possible, which predicts the output for given inputs.
struct Predictor {
    /// `None` without rules; then there are no predictions.
    rules: Option<Rules>,
}

struct Rules {
    engine: Engine,
    scratch: Scratch,
    outcomes: Vec<Outcome>,
    filling: Filling,
}

impl Predictor {
    fn new(model: &Model, gap: &GapSettings) -> Result<Predictor, ExamineError> {
        if model.rules.is_empty() {
            return Ok(Predictor { rules: None });
        }
        let engine = Engine::new(model)?;
        let rules = Rules {
            scratch: engine.scratch(),
            outcomes: vec![Outcome::default(); model.outputs.len()],
            filling: Filling::new(&engine, model, 0, gap)?,
            engine,
        };
        Ok(Predictor { rules: Some(rules) })
    }

    /// The outcome of the rules at these inputs, before gaps are filled.
    fn outcome(&mut self, inputs: &[f64]) -> Result<Outcome, ExamineError> {
        let Some(rules) = &mut self.rules else {
            return Ok(Outcome::UNDEFINED);
        };
        let engine = &rules.engine;
        match engine.evaluate_with(&mut rules.scratch, inputs, &mut rules.outcomes) {
            Ok(()) | Err(EvaluateError::NoRuleFired { .. }) => {}
            Err(error) => return Err(error.into()),
        }
        Ok(rules.outcomes.first().copied().unwrap_or_default())
    }

    fn is_gap(&self, outcome: Outcome) -> bool {
        let rules = self.rules.as_ref();
        rules.is_none_or(|rules| rules.filling.is_gap(outcome.coverage))
    }

    fn predict(&mut self, inputs: &[f64]) -> Result<Option<f64>, ExamineError> {
        let outcome = self.outcome(inputs)?;
        if !self.is_gap(outcome) {
            return Ok(outcome.value());
        }
        let rules = self.rules.as_ref();
        let reading = rules.and_then(|rules| rules.filling.read(inputs));
        Ok(reading.map(|reading| reading.value))
    }
}

/// The number of folds for rows without groups, or with too many groups.
const FOLDS: u32 = 10;

/// The largest number of groups that are left out one at a time.
const MAX_GROUPS: usize = 50;

/// Cross-validation: for each fold in turn, learns from all other rows and predicts the fold.
///
/// The folds are the groups if the rows have any (10 folds of whole groups if there are over 50), otherwise 10 folds
/// that depend on the values of the rows and not on their order.
///
/// # Errors
///
/// If a row is refused or the model is not suitable for learning.
///
/// # Example: predictions for vehicles that were left out of the training rows
/// ```
/// use flagred_evaluation::learning::{Row, cross_validate};
/// use flagred::gap::GapSettings;
/// use fuzzy::learn::Settings;
///
/// let mut model = flagred::shipped::flagred_paper_rules();
/// model.rules.clear();
/// // Risk falls with the margin; three vehicles, each predicted from the other two.
/// let rows: Vec<Row> = (0..60).map(|i| {
///     let margin = f64::from(i % 20) / 50.0;
///     Row { values: vec![margin, 0.1, 100.0 - 200.0 * margin], weight: 1.0, group: Some(i % 3) }
/// }).collect();
/// let errors = cross_validate(&model, &Settings::default(), &GapSettings::default(), &rows)?;
/// assert_eq!((errors.rows, errors.without_prediction), (60, 0));
/// assert!(errors.rmse < 15.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn cross_validate(
    model: &Model,
    settings: &Settings,
    gap: &GapSettings,
    rows: &[Row],
) -> Result<Errors, ExamineError> {
    let parts = parts(rows);
    let mut all: Vec<u32> = parts.clone();
    all.sort_unstable();
    all.dedup();
    let mut tally = Tally::default();
    if all.len() < 2 {
        return Ok(tally.errors());
    }
    for part in all {
        let mut learner = Learner::new(model, settings.clone())?;
        let (mut held_out, mut learned) = (vec![], 0);
        for (i, (row, of)) in rows.iter().zip(&parts).enumerate() {
            if *of == part {
                held_out.push(row);
                continue;
            }
            let added = learner.add(&row.values, row.weight);
            added.map_err(|refusal| ExamineError::Refused { row: i, refusal })?;
            learned += 1;
        }
        if learned == 0 {
            continue;
        }
        let learned = learner.finish().model;
        let mut predictor = Predictor::new(&learned, gap)?;
        for row in held_out {
            if let Some((truth, inputs)) = row.values.split_last() {
                tally.add(predictor.predict(inputs)?, *truth, row.weight);
            }
        }
    }
    Ok(tally.errors())
}

/// The fold of each row.
fn parts(rows: &[Row]) -> Vec<u32> {
    let mut groups: Vec<u32> = rows.iter().filter_map(|row| row.group).collect();
    groups.sort_unstable();
    groups.dedup();
    rows.iter()
        .map(|row| match row.group {
            Some(group) if groups.len() <= MAX_GROUPS => group,
            // The rank of the group selects the fold: with the number itself, groups with the same last digit would
            // share a fold.
            Some(group) => groups.partition_point(|other| *other < group) as u32 % FOLDS,
            None => (fingerprint(&row.values) % u64::from(FOLDS)) as u32,
        })
        .collect()
}

/// FNV-1a over the bits of the values.
fn fingerprint(values: &[f64]) -> u64 {
    let bytes = values
        .iter()
        .flat_map(|value| value.to_bits().to_le_bytes());
    let hash = bytes.fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
    });
    // The low bits of the product depend only on the low bits of the bytes, so the high bits are mixed in.
    hash ^ (hash >> 32)
}

/// The errors of each gap method in cells whose rule was removed.
#[derive(Debug, Clone, PartialEq)]
pub struct GapComparison {
    /// The number of rules that were removed, one at a time. Rules whose gap contains no rows are not counted.
    pub rules: u32,
    /// The errors on the same rows if no rule is removed, for comparison with the errors of the methods.
    pub with_the_rule: MethodErrors,
    /// The errors of each method.
    pub methods: Vec<(GapMethod, MethodErrors)>,
}

/// Errors in which each row counts the same, and an error in which each rule counts the same.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct MethodErrors {
    /// Errors in which each row counts the same.
    pub by_row: Errors,
    /// The mean over the removed rules of their mean absolute error, so that each rule counts the same, however many
    /// samples it has. Rules without a predicted row are ignored; NaN if no removed rule has one.
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub by_rule_mean_absolute: f64,
}

/// Removes each rule in turn, fills its gap with each method, and compares the filled values with the rows in the gap.
///
/// Rows belong to the rule that fires most strongly on them. Rows that other rules also cover, or that no rule covers,
/// are ignored.
///
/// # Errors
///
/// If the rules do not compile.
///
/// # Example
/// ```
/// use flagred_evaluation::learning::{Row, leave_one_rule_out};
/// use flagred::gap::GapMethod;
///
/// let model = flagred::shipped::flagred_paper_rules();
/// let rows: Vec<Row> = (0..20).map(|i| {
///     let margin = f64::from(i) / 50.0;
///     Row { values: vec![margin, 0.1, 100.0 - 200.0 * margin], weight: 1.0, group: None }
/// }).collect();
/// let compared = leave_one_rule_out(&model, &rows, &GapMethod::ALL, None)?;
/// assert_eq!(compared.methods.len(), 4);
/// assert!(compared.rules > 1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn leave_one_rule_out(
    model: &Model,
    rows: &[Row],
    methods: &[GapMethod],
    coverage_below: Option<f64>,
) -> Result<GapComparison, ExamineError> {
    let settings = |method| {
        let mut settings = GapSettings::default();
        settings.method = method;
        settings.coverage_below = coverage_below;
        settings
    };
    let mut with_it = Predictor::new(model, &settings(GapMethod::Nearest))?;
    let mut of_rule: BTreeMap<usize, Vec<&Row>> = BTreeMap::new();
    for row in rows {
        let Some((_, inputs)) = row.values.split_last() else {
            continue;
        };
        let outcome = with_it.outcome(inputs)?;
        if let Some(rule) = outcome.dominant_rule
            && !with_it.is_gap(outcome)
        {
            of_rule.entry(rule).or_default().push(row);
        }
    }
    let mut totals = vec![(Tally::default(), Tally::default()); methods.len() + 1];
    let mut rules = 0;
    for (rule, rows) in &of_rule {
        let mut without = model.clone();
        if *rule < without.rules.len() {
            without.rules.remove(*rule);
        }
        let mut without_it = methods
            .iter()
            .map(|method| Predictor::new(&without, &settings(*method)))
            .collect::<Result<Vec<Predictor>, ExamineError>>()?;
        let mut tallies = vec![Tally::default(); methods.len() + 1];
        let mut in_the_gap = 0;
        for row in rows {
            let (Some((truth, inputs)), Some(any)) =
                (row.values.split_last(), without_it.first_mut())
            else {
                continue;
            };
            let outcome = any.outcome(inputs)?;
            if !any.is_gap(outcome) {
                continue;
            }
            in_the_gap += 1;
            let predictors = [&mut with_it].into_iter().chain(&mut without_it);
            for ((tally, (total, _)), predictor) in
                tallies.iter_mut().zip(&mut totals).zip(predictors)
            {
                let prediction = predictor.predict(inputs)?;
                tally.add(prediction, *truth, row.weight);
                total.add(prediction, *truth, row.weight);
            }
        }
        if in_the_gap == 0 {
            continue;
        }
        rules += 1;
        for ((_, by_rule), tally) in totals.iter_mut().zip(tallies) {
            let predicted = (tally.rows > 0).then(|| tally.errors().mean_absolute);
            by_rule.add(predicted, 0.0, 1.0);
        }
    }
    let mut all = totals.into_iter().map(|(tally, by_rule)| MethodErrors {
        by_row: tally.errors(),
        by_rule_mean_absolute: by_rule.errors().mean_absolute,
    });
    Ok(GapComparison {
        rules,
        with_the_rule: all.next().unwrap_or_default(),
        methods: methods.iter().copied().zip(all).collect(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows whose risk falls linearly with the margin and does not depend on the spread.
    fn rows(groups: Option<u32>) -> Vec<Row> {
        (0..400)
            .map(|i| {
                let (margin, spread) = (f64::from(i % 20) / 40.0, f64::from(i / 20) / 40.0);
                Row {
                    values: vec![margin, spread, 100.0 - 200.0 * margin],
                    weight: 1.0,
                    group: groups.map(|n| i as u32 % n),
                }
            })
            .collect()
    }

    fn blank() -> Model {
        let text = "
fuzzy: 1
name: even
inputs:
  margin: {range: [0, 0.5], partition: [a, b, c, d, e]}
  spread: {range: [0, 0.5], partition: [low, high]}
outputs: {risk: {range: [0, 100], partition: [v0, v25, v50, v75, v100]}}
rules: []
";
        fuzzy::yaml::parse(text).unwrap().model
    }

    fn learned() -> Model {
        let mut learner = Learner::new(&blank(), Settings::default()).unwrap();
        for row in rows(None) {
            learner.add(&row.values, row.weight).unwrap();
        }
        learner.finish().model
    }

    #[test]
    fn a_linear_relation_is_predicted_on_held_out_rows() {
        let validate = |groups, order: fn(&mut Vec<Row>)| {
            let mut rows = rows(groups);
            order(&mut rows);
            cross_validate(
                &blank(),
                &Settings::default(),
                &GapSettings::default(),
                &rows,
            )
            .unwrap()
        };
        let errors = validate(None, |_| {});
        assert_eq!((errors.rows, errors.without_prediction), (400, 0));
        // The values of the outer terms (their centroids) are 8 % of the range away from its ends, and neighbouring
        // terms are 25 % of the range apart.
        assert!(
            errors.rmse < 8.0 && errors.mean_absolute <= errors.rmse,
            "{errors:?}"
        );
        let turned = validate(None, |rows| rows.reverse());
        approx::assert_abs_diff_eq!(turned.rmse, errors.rmse, epsilon = 1e-9);
        assert_eq!(validate(Some(4), |_| {}).rows, 400);
        assert_eq!(validate(Some(100), |_| {}).rows, 400);
        assert_eq!(validate(Some(1), |_| {}).rows, 0);
    }

    #[test]
    fn neighbours_replace_a_missing_rule() {
        let methods = GapMethod::ALL;
        let compared = leave_one_rule_out(&learned(), &rows(None), &methods, None).unwrap();
        assert_eq!(compared.rules, 10);
        assert_eq!(compared.methods.len(), 4);
        for (method, errors) in &compared.methods {
            // Halfway between two terms, the rule of the neighbouring term covers the row as well; this applies to 20
            // of the 400 rows.
            assert_eq!(errors.by_row.rows, 380, "{method:?}");
            // A neighbour along the spread predicts the same as the removed rule.
            assert!(errors.by_rule_mean_absolute < 15.0, "{method:?} {errors:?}");
        }
    }

    #[test]
    fn many_groups_are_held_out_in_tenths() {
        let mut rows = rows(Some(60));
        let validate = |rows: &[Row]| {
            let gap = GapSettings::default();
            cross_validate(&blank(), &Settings::default(), &gap, rows).unwrap()
        };
        let errors = validate(&rows);
        for row in &mut rows {
            row.group = row.group.map(|group| 10 * group);
        }
        assert_eq!((errors.rows, validate(&rows)), (400, errors));
    }

    #[test]
    fn without_its_only_rule_a_gap_has_no_prediction() {
        let mut only = learned();
        only.rules.truncate(1);
        let compared = leave_one_rule_out(&only, &rows(None), &GapMethod::ALL, None).unwrap();
        assert_eq!(compared.rules, 1);
        assert!(compared.with_the_rule.by_rule_mean_absolute < 15.0);
        for (method, errors) in &compared.methods {
            assert_eq!(errors.by_row.rows, 0, "{method:?}");
            assert!(errors.by_row.without_prediction > 0, "{method:?}");
            let unknown = [errors.by_row.rmse, errors.by_rule_mean_absolute];
            assert!(unknown.iter().all(|error| error.is_nan()), "{method:?}");
        }
    }

    #[test]
    fn a_bad_row_is_named() {
        let mut rows = rows(None);
        rows[7].values[0] = f64::NAN;
        let error = cross_validate(
            &blank(),
            &Settings::default(),
            &GapSettings::default(),
            &rows,
        )
        .unwrap_err();
        assert_eq!(error.to_string(), "row 7: `margin` is not a finite number");
    }
}
