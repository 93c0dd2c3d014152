//! Simplifies rule sets: fewer and shorter rules and fewer inputs, with the same outputs.
//!
//! Equality of outputs is not derived but tested, by evaluating both rule sets at many points. The test works with
//! every operator, but guarantees equality only at these points.

mod antecedent;
mod change;
mod points;
mod reference;
#[cfg(test)]
mod tests;

use std::collections::{BTreeSet, HashSet};

use fuzzy::{
    Engine, Model, diagnostic::Findings, engine::EvaluateError, model::Disjunction, rule::Condition,
};

use change::{Change, DerivedRule, RuleSlots, changes, rule_size};
use reference::ReferenceOutputs;

/// Values that differ by at most this share of the output's range count as equal.
pub const EQUAL_TOLERANCE: f64 = 1e-12;

/// The maximum number of rules of a rule set to simplify: the time grows faster than the square of their number.
pub const MAX_RULES: usize = 1_000;

/// Settings of [`simplify()`].
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
pub struct SimplifySettings {
    /// The largest allowed difference of an output, in its unit; if `None`, [`EQUAL_TOLERANCE`] applies.
    pub tolerance: Option<f64>,
    /// Whether to compare at the rows only. Elsewhere the outputs may then differ arbitrarily.
    pub rows_only: bool,
    /// The random seed for the points.
    pub seed: u64,
}

/// A simplified model.
#[derive(Debug, Clone, PartialEq)]
pub struct SimplifyResult {
    /// The model.
    pub model: Model,
    /// For each rule of the simplified model, the indices of the original rules that it replaces.
    pub rules: Vec<Vec<usize>>,
    /// The indices of the original rules that had no effect.
    pub dropped: Vec<usize>,
    /// The names of the inputs that no rule needs.
    pub inputs: Vec<String>,
    /// The number of points at which both models were compared, including rows.
    pub points: usize,
    /// The largest difference at these points; `None` if there is none.
    pub difference: Option<Difference>,
}

/// A difference between the outputs of the original and the simplified model at a point.
#[derive(Debug, Clone, PartialEq)]
pub struct Difference {
    /// The output.
    pub output: String,
    /// The value of the output in the original model.
    pub before: f64,
    /// The value of the output in the simplified model.
    pub after: f64,
    /// The values of the inputs, in the order of the original.
    pub inputs: Vec<f64>,
}

/// The reason why a model cannot be simplified.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SimplifyError {
    /// The tolerance is negative or not a number.
    #[error("the tolerance is {tolerance}; it must be at least 0")]
    Tolerance {
        /// The tolerance.
        tolerance: f64,
    },
    /// [`SimplifySettings::rows_only`] is set, but there are no rows.
    #[error("there are no rows")]
    NoRows,
    /// There is not exactly one column for each input, or the columns have different lengths.
    #[error("there must be a column for each input of the model, all of one length")]
    Columns,
    /// There are more than [`MAX_RULES`] rules.
    #[error("the rule set has {rules} rules; at most {MAX_RULES} are simplified")]
    TooManyRules {
        /// The number of rules.
        rules: usize,
    },
    /// The rule set has interval type-2 terms.
    #[error("the rule set has type-2 terms, with which rules cannot be merged")]
    Type2,
    /// The model cannot be used.
    #[error(transparent)]
    Compile(#[from] Findings),
    /// The model cannot be evaluated.
    #[error(transparent)]
    Evaluate(#[from] EvaluateError),
}

/// Makes a model shorter while keeping its outputs: removes rules and inputs without effect, and merges rules that
/// differ in the terms of one input into one rule with `NOT`, with `OR`, or without that input.
///
/// Both models are compared at the rows, given as one column for each input, and at many points: all combinations of
/// the corners of terms and the middles between them (a sample of 50,000 if there are more), and random points,
/// including some at which each rule fires. A change is kept if no output differs by more than the tolerance at any of
/// them, and if rules fire for the same outputs. If no rule contains an OR, the disjunction is changed to the one that
/// shortens most rules.
///
/// # Errors
/// If the settings or the rows cannot be used, or if the model does not compile.
///
/// # Example: two rules that differ in one term
/// ```
/// use flagred_tuning::{SimplifySettings, simplify};
///
/// let model = fuzzy::yaml::parse("
/// fuzzy: 1
/// name: fan
/// inputs:
///   heat: {range: [0, 40], partition: [cool, warm, hot]}
///   humidity: {range: [0, 100], partition: [dry, wet]}
/// outputs:
///   speed: {range: [0, 9], partition: [slow, fast]}
/// operators: {and: product, implication: product, aggregation: sum}
/// rules:
///   - IF heat IS cool THEN speed IS slow
///   - IF heat IS warm AND humidity IS dry THEN speed IS fast
///   - IF heat IS warm AND humidity IS wet THEN speed IS fast
///   - IF heat IS hot THEN speed IS fast
/// ")?.model;
/// let simplified = simplify(&model, &[], &SimplifySettings::default())?;
/// let rules: Vec<String> = simplified.model.rules.iter().map(|rule| rule.rule.to_string()).collect();
/// assert_eq!(rules, ["IF heat IS cool THEN speed IS slow", "IF heat IS NOT cool THEN speed IS fast"]);
/// assert_eq!(simplified.inputs, ["humidity"]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn simplify(
    model: &Model,
    rows: &[Vec<f64>],
    settings: &SimplifySettings,
) -> Result<SimplifyResult, SimplifyError> {
    if let Some(tolerance) = settings.tolerance
        && !(tolerance >= 0.0 && tolerance.is_finite())
    {
        return Err(SimplifyError::Tolerance { tolerance });
    }
    if model.rules.len() > MAX_RULES {
        return Err(SimplifyError::TooManyRules {
            rules: model.rules.len(),
        });
    }
    if model.has_type2_terms() {
        return Err(SimplifyError::Type2);
    }
    // Detects an invalid model before points are generated.
    Engine::new(model)?;
    let count = rows.first().map_or(0, Vec::len);
    let fits = rows.len() == model.inputs.len() && rows.iter().all(|column| column.len() == count);
    if !rows.is_empty() && !fits {
        return Err(SimplifyError::Columns);
    }
    if settings.rows_only && count == 0 {
        return Err(SimplifyError::NoRows);
    }
    let mut columns = match settings.rows_only {
        true => vec![Vec::new(); model.inputs.len()],
        false => points::points(model, settings.seed),
    };
    for (column, rows) in columns.iter_mut().zip(rows) {
        column.extend(rows);
    }
    let mut reference = ReferenceOutputs::new(model, columns, settings.tolerance)?;
    let may_differ = settings.tolerance.is_some();
    let mut short = model.clone();
    let rules = model.rules.iter().cloned().enumerate();
    let derived = |(index, rule)| {
        Some(DerivedRule {
            rule,
            of: vec![index],
        })
    };
    let mut slots: RuleSlots = rules.map(derived).collect();
    // After a reduction, another operator for OR may reduce the rules further.
    loop {
        let before = total_size(&slots);
        let mut best = (before, short.operators.or, slots.clone());
        for or in disjunctions(&short) {
            let mut base = short.clone();
            base.operators.or = or;
            let mut slots = slots.clone();
            without_difference(&base, &mut reference, &mut slots);
            if may_differ {
                within_tolerance(&base, &mut reference, &mut slots);
            }
            let size = total_size(&slots);
            if size < best.0 {
                best = (size, or, slots);
            }
        }
        slots = best.2;
        short = with_rules(&short, &slots);
        let has_or = short.rules.iter().any(|rule| has_or(&rule.rule.condition));
        short.operators.or = if has_or { best.1 } else { model.operators.or };
        if best.0 == before {
            break;
        }
    }
    let inputs = drop_inputs(&mut short, &mut reference);
    let rules: Vec<Vec<usize>> = slots
        .into_iter()
        .flatten()
        .map(|derived| derived.of)
        .collect();
    let kept: BTreeSet<usize> = rules.iter().flatten().copied().collect();
    Ok(SimplifyResult {
        dropped: (0..model.rules.len())
            .filter(|rule| !kept.contains(rule))
            .collect(),
        rules,
        inputs,
        points: reference.len(),
        difference: reference.examine(&short).flatten(),
        model: short,
    })
}

/// The disjunctions to try. Other disjunctions than the author's are tried only if no rule contains an OR, because
/// they would change the meaning of that OR.
fn disjunctions(model: &Model) -> Vec<Disjunction> {
    let own = model.operators.or;
    let mut found = vec![own];
    if model.blocks.is_empty() && !model.rules.iter().any(|rule| has_or(&rule.rule.condition)) {
        let others = [Disjunction::Maximum, Disjunction::BoundedSum];
        found.extend(others.into_iter().filter(|other| *other != own));
    }
    found
}

fn has_or(condition: &Condition) -> bool {
    match condition {
        Condition::Is(_) => false,
        Condition::Not(inner) => has_or(inner),
        Condition::And(parts) => parts.iter().any(has_or),
        Condition::Or(_) => true,
    }
}

/// The number of propositions in all rules.
fn total_size(slots: &RuleSlots) -> usize {
    let rules = slots.iter().flatten();
    rules.map(|derived| rule_size(&derived.rule.rule)).sum()
}

/// Applies the changes that do not change any output, largest reduction first.
fn without_difference(model: &Model, reference: &mut ReferenceOutputs, slots: &mut RuleSlots) {
    // A change that failed is not tried again immediately: the changes applied meanwhile do not affect the outputs, so
    // it would most likely fail again. Before the loop ends, all failed changes are tried once more.
    let mut failed: HashSet<String> = HashSet::new();
    loop {
        let is_complete = failed.is_empty();
        let mut changed: BTreeSet<usize> = BTreeSet::new();
        for change in changes(model, slots, false) {
            let key = key(&change, slots);
            if change.empty.iter().any(|slot| changed.contains(slot)) || failed.contains(&key) {
                continue;
            }
            let candidate = applied(&change, slots);
            if reference.is_equal(&with_rules(model, &candidate)) {
                *slots = candidate;
                changed.extend(change.empty);
            } else {
                failed.insert(key);
            }
        }
        match (changed.is_empty(), is_complete) {
            (true, true) => return,
            (true, false) => failed.clear(),
            _ => {}
        }
    }
}

/// Applies changes that reduce the number of rules or inputs, until every further change would exceed the tolerance.
/// The change with the smallest difference per removed proposition is always applied next.
fn within_tolerance(model: &Model, reference: &mut ReferenceOutputs, slots: &mut RuleSlots) {
    let mut failed: HashSet<String> = HashSet::new();
    loop {
        let mut promising = Vec::new();
        for change in changes(model, slots, true) {
            if !change.has_fewer_inputs && change.fill.len() == change.empty.len() {
                continue;
            }
            let key = key(&change, slots);
            if failed.contains(&key) {
                continue;
            }
            let candidate = applied(&change, slots);
            match reference.sampled_difference(&with_rules(model, &candidate)) {
                Some(share) => promising.push((share / change.saved as f64, key, candidate)),
                None => drop(failed.insert(key)),
            }
        }
        promising.sort_by(|a, b| a.0.total_cmp(&b.0));
        let found = promising.into_iter().find(|(_, key, candidate)| {
            let holds = reference.examine(&with_rules(model, candidate)).is_some();
            if !holds {
                failed.insert(key.clone());
            }
            holds
        });
        match found {
            Some((.., candidate)) => *slots = candidate,
            None => return,
        }
    }
}

/// Removes the inputs that no rule names.
fn drop_inputs(model: &mut Model, reference: &mut ReferenceOutputs) -> Vec<String> {
    let mut named = BTreeSet::new();
    for rule in &model.rules {
        rule.rule.condition.visit(&mut |proposition| {
            named.insert(proposition.variable.text.clone());
        });
    }
    let mut dropped = Vec::new();
    for input in model.inputs.clone() {
        if named.contains(&input.name) {
            continue;
        }
        // A formula may still read the input.
        let mut without = model.clone();
        without.inputs.retain(|other| other.name != input.name);
        if reference.examine(&without).is_some() {
            *model = without;
            dropped.push(input.name);
        }
    }
    dropped
}

fn applied(change: &Change, slots: &RuleSlots) -> RuleSlots {
    let mut slots = slots.clone();
    for slot in &change.empty {
        if let Some(slot) = slots.get_mut(*slot) {
            *slot = None;
        }
    }
    for (slot, derived) in &change.fill {
        if let Some(slot) = slots.get_mut(*slot) {
            *slot = Some(derived.clone());
        }
    }
    slots
}

fn with_rules(model: &Model, slots: &RuleSlots) -> Model {
    let rules = slots.iter().flatten();
    Model {
        rules: rules.map(|derived| derived.rule.clone()).collect(),
        ..model.clone()
    }
}

/// A key for the rules that a change removes and adds.
fn key(change: &Change, slots: &RuleSlots) -> String {
    let taken = change
        .empty
        .iter()
        .filter_map(|slot| slots.get(*slot)?.as_ref());
    let given = change.fill.iter().map(|(_, derived)| derived);
    let texts = |rules: &mut dyn Iterator<Item = &DerivedRule>| {
        rules
            .map(|derived| derived.rule.rule.to_string() + "\n")
            .collect::<String>()
    };
    texts(&mut taken.into_iter()) + "->\n" + &texts(&mut given.into_iter())
}
