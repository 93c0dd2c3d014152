//! Rule sets that say the same with fewer rules, shorter ones and fewer inputs.
//!
//! Whether two rule sets say the same is not derived: it is seen by evaluating both at many points. So it holds for every
//! operator, and no further than to these points.

mod antecedent;
mod change;
mod judge;
mod points;
#[cfg(test)]
mod tests;

use std::collections::{BTreeSet, HashSet};

use fuzzy::{
    Engine, Model, diagnostic::Findings, engine::EvaluateError, model::Disjunction, rule::Condition,
};

use change::{Change, Places, Standing, changes, rule_size};
use judge::Judge;

/// Values that differ by at most this share of the output's range are equal.
pub const EQUAL: f64 = 1e-12;

/// The most rules of a rule set that is simplified: the time grows with more than the square of their number.
pub const MOST_RULES: usize = 1_000;

/// When a rule set says the same as another one.
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
pub struct SimplifySettings {
    /// By how much an output may differ, in its unit; `None`: by [`EQUAL`].
    pub tolerance: Option<f64>,
    /// Compare at the rows alone. Between them the outputs may then be anything.
    pub rows_only: bool,
    /// For the points at random.
    pub seed: u64,
}

/// A model that was simplified.
#[derive(Debug, Clone, PartialEq)]
pub struct Simplified {
    /// The model.
    pub model: Model,
    /// For each of its rules the rules that it stands for, by their indices in the original.
    pub rules: Vec<Vec<usize>>,
    /// The rules that had no effect, by their indices in the original.
    pub dropped: Vec<usize>,
    /// The inputs that no rule needs.
    pub inputs: Vec<String>,
    /// The points at which both were compared, rows included.
    pub points: usize,
    /// The largest difference there; `None` where there is none.
    pub difference: Option<Difference>,
}

/// By how much an output differs at a point.
#[derive(Debug, Clone, PartialEq)]
pub struct Difference {
    /// The output.
    pub output: String,
    /// Its value in the original.
    pub before: f64,
    /// Its value in the simplified model.
    pub after: f64,
    /// The inputs, in the order of the original.
    pub inputs: Vec<f64>,
}

/// Why a model cannot be simplified.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SimplifyError {
    /// The tolerance is below 0 or no number.
    #[error("the tolerance {tolerance} is not a number from 0")]
    Tolerance {
        /// What it is.
        tolerance: f64,
    },
    /// [`SimplifySettings::rows_only`] without rows.
    #[error("there are no rows")]
    NoRows,
    /// There is not a column of one length for each input.
    #[error("there must be a column for each input of the model, all of one length")]
    Columns,
    /// More rules than [`MOST_RULES`].
    #[error("the rule set has {rules} rules; at most {MOST_RULES} are simplified")]
    TooManyRules {
        /// How many.
        rules: usize,
    },
    /// The model cannot be used.
    #[error(transparent)]
    Compile(#[from] Findings),
    /// The model cannot be evaluated.
    #[error(transparent)]
    Evaluate(#[from] EvaluateError),
}

/// Makes a model shorter and keeps what it says: drops rules and inputs without effect, and merges rules that differ in the
/// terms of one input into one with `NOT`, with `OR`, or without that input.
///
/// Both models are compared at the rows, given as a column for each input, and at many points: all combinations of the values
/// at which terms bend and the middles between them (50,000 drawn where there are more), and others at random, among them some
/// where each rule fires. A change is kept where no output differs by more than the tolerance at any of them, and the same
/// outputs have a value from rules. Where no rule has an OR, the disjunction becomes the one that makes most rules short.
///
/// # Errors
/// The settings or the rows cannot be used, or the model does not compile.
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
) -> Result<Simplified, SimplifyError> {
    if let Some(tolerance) = settings.tolerance
        && !(tolerance >= 0.0 && tolerance.is_finite())
    {
        return Err(SimplifyError::Tolerance { tolerance });
    }
    if model.rules.len() > MOST_RULES {
        return Err(SimplifyError::TooManyRules {
            rules: model.rules.len(),
        });
    }
    // That it can be used is known before points are looked for.
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
    let mut judge = Judge::new(model, columns, settings.tolerance)?;
    let may_differ = settings.tolerance.is_some();
    let mut short = model.clone();
    let rules = model.rules.iter().cloned().enumerate();
    let standing = |(index, rule)| {
        Some(Standing {
            rule,
            of: vec![index],
        })
    };
    let mut places: Places = rules.map(standing).collect();
    // What became shorter may be made shorter still by another disjunction.
    loop {
        let before = total_size(&places);
        let mut best = (before, short.operators.or, places.clone());
        for or in disjunctions(&short) {
            let mut base = short.clone();
            base.operators.or = or;
            let mut places = places.clone();
            without_difference(&base, &mut judge, &mut places);
            if may_differ {
                within_tolerance(&base, &mut judge, &mut places);
            }
            let size = total_size(&places);
            if size < best.0 {
                best = (size, or, places);
            }
        }
        places = best.2;
        short = with_rules(&short, &places);
        let has_or = short.rules.iter().any(|rule| has_or(&rule.rule.condition));
        short.operators.or = if has_or { best.1 } else { model.operators.or };
        if best.0 == before {
            break;
        }
    }
    let inputs = drop_inputs(&mut short, &mut judge);
    let rules: Vec<Vec<usize>> = places
        .into_iter()
        .flatten()
        .map(|standing| standing.of)
        .collect();
    let kept: BTreeSet<usize> = rules.iter().flatten().copied().collect();
    Ok(Simplified {
        dropped: (0..model.rules.len())
            .filter(|rule| !kept.contains(rule))
            .collect(),
        rules,
        inputs,
        points: judge.len(),
        difference: judge.examine(&short).flatten(),
        model: short,
    })
}

/// The disjunctions to try: others than the author's only where no rule has an OR whose meaning would change.
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

/// How many propositions all rules have.
fn total_size(places: &Places) -> usize {
    let rules = places.iter().flatten();
    rules.map(|standing| rule_size(&standing.rule.rule)).sum()
}

/// Makes the changes that change nothing, the largest first.
fn without_difference(model: &Model, judge: &mut Judge, places: &mut Places) {
    // What failed fails again, as long as all changes change nothing; the last time everything is tried once more.
    let mut failed: HashSet<String> = HashSet::new();
    loop {
        let is_complete = failed.is_empty();
        let mut changed: BTreeSet<usize> = BTreeSet::new();
        for change in changes(model, places, false) {
            let key = key(&change, places);
            if change.empty.iter().any(|place| changed.contains(place)) || failed.contains(&key) {
                continue;
            }
            let candidate = applied(&change, places);
            if judge.is_equal(&with_rules(model, &candidate)) {
                *places = candidate;
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

/// Makes changes that leave fewer rules or inputs as long as one stays within the tolerance, each time the one with the least
/// difference for what it saves.
fn within_tolerance(model: &Model, judge: &mut Judge, places: &mut Places) {
    let mut failed: HashSet<String> = HashSet::new();
    loop {
        let mut promising = Vec::new();
        for change in changes(model, places, true) {
            if !change.has_fewer_inputs && change.fill.len() == change.empty.len() {
                continue;
            }
            let key = key(&change, places);
            if failed.contains(&key) {
                continue;
            }
            let candidate = applied(&change, places);
            match judge.glance(&with_rules(model, &candidate)) {
                Some(share) => promising.push((share / change.saved as f64, key, candidate)),
                None => drop(failed.insert(key)),
            }
        }
        promising.sort_by(|a, b| a.0.total_cmp(&b.0));
        let found = promising.into_iter().find(|(_, key, candidate)| {
            let holds = judge.examine(&with_rules(model, candidate)).is_some();
            if !holds {
                failed.insert(key.clone());
            }
            holds
        });
        match found {
            Some((.., candidate)) => *places = candidate,
            None => return,
        }
    }
}

/// Drops the inputs that no rule names.
fn drop_inputs(model: &mut Model, judge: &mut Judge) -> Vec<String> {
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
        // A formula may read it.
        let mut without = model.clone();
        without.inputs.retain(|other| other.name != input.name);
        if judge.examine(&without).is_some() {
            *model = without;
            dropped.push(input.name);
        }
    }
    dropped
}

fn applied(change: &Change, places: &Places) -> Places {
    let mut places = places.clone();
    for place in &change.empty {
        if let Some(place) = places.get_mut(*place) {
            *place = None;
        }
    }
    for (place, standing) in &change.fill {
        if let Some(place) = places.get_mut(*place) {
            *place = Some(standing.clone());
        }
    }
    places
}

fn with_rules(model: &Model, places: &Places) -> Model {
    let rules = places.iter().flatten();
    Model {
        rules: rules.map(|standing| standing.rule.clone()).collect(),
        ..model.clone()
    }
}

/// The rules that a change takes and those that it gives.
fn key(change: &Change, places: &Places) -> String {
    let taken = change
        .empty
        .iter()
        .filter_map(|place| places.get(*place)?.as_ref());
    let given = change.fill.iter().map(|(_, standing)| standing);
    let texts = |rules: &mut dyn Iterator<Item = &Standing>| {
        rules
            .map(|standing| standing.rule.rule.to_string() + "\n")
            .collect::<String>()
    };
    texts(&mut taken.into_iter()) + "->\n" + &texts(&mut given.into_iter())
}
