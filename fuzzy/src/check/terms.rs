//! Terms that no rule uses or no value reaches, and gaps between the terms of an input.

use alloc::{collections::BTreeSet, string::String, vec::Vec};

use super::axis;
use crate::model::{MembershipFunction, Model, Term, Variable};

/// A term of a variable, or all terms of the variable.
#[derive(Debug, Clone, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TermOf {
    /// The name of the input or output.
    pub variable: String,
    /// The name of the term; `None` if no rule names the variable.
    pub term: Option<String>,
}

/// An interval of a variable's range in which the degree of every term is 0.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct TermGap {
    /// The name of the input.
    pub input: String,
    /// The lower end.
    pub low: f64,
    /// The upper end; equal to `low` if the hole is a single value.
    pub high: f64,
}

/// Two terms of a variable with the same degrees everywhere.
#[derive(Debug, Clone, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct EqualTerms {
    /// The name of the input or output.
    pub variable: String,
    /// The name of the earlier term.
    pub first: String,
    /// The name of the later term.
    pub second: String,
}

/// Returns the terms whose membership function equals that of an earlier term of the variable.
pub(super) fn equal(variable: &Variable) -> Vec<EqualTerms> {
    let values = axis::values(variable);
    let zero_terms = zero_terms(variable);
    // Each fuzzy set has a hash, so that for most pairs no degrees need to be compared.
    let hashes = variable.terms.iter().map(|term| {
        is_set(&term.membership_function, variable).then(|| hash_of_degrees(term, &values))
    });
    let hashes: Vec<Option<u64>> = hashes.collect();
    let same = |(a, a_hash): (&Term, &Option<u64>), (b, b_hash): (&Term, &Option<u64>)| {
        let equal = || values.iter().all(|&x| a.membership(x) == b.membership(x));
        a.lower == b.lower
            && ((a.membership_function == b.membership_function && a.height == b.height)
                || (a_hash.is_some() && a_hash == b_hash && equal()))
    };
    let mut found = Vec::new();
    let terms = || variable.terms.iter().zip(&hashes);
    for (i, second) in terms().enumerate() {
        // A term that is 0 everywhere is reported separately.
        if !zero_terms.contains(&i)
            && let Some((first, _)) = terms().take(i).find(|first| same(*first, second))
        {
            found.push(EqualTerms {
                variable: variable.name.clone(),
                first: first.name.clone(),
                second: second.0.name.clone(),
            });
        }
    }
    found
}

/// Returns a hash that is equal for terms with equal degrees at the values (FxHash).
fn hash_of_degrees(term: &Term, values: &[f64]) -> u64 {
    values.iter().fold(0, |hash: u64, &x| {
        // 0 and -0 are the same degree.
        let degree = (term.membership(x) + 0.0).to_bits();
        (hash.rotate_left(5) ^ degree).wrapping_mul(0x517c_c1b7_2722_0a95)
    })
}

/// Returns the terms that no rule uses. A variable that no rule names is listed once, without its terms.
pub(super) fn unused(model: &Model) -> Vec<TermOf> {
    let mut used: BTreeSet<(&str, &str)> = BTreeSet::new();
    let mut named: BTreeSet<&str> = BTreeSet::new();
    for rule in &model.rules {
        rule.rule.condition.visit(&mut |proposition| {
            named.insert(&proposition.variable.text);
            if let Some(term) = &proposition.term {
                used.insert((&proposition.variable.text, &term.text));
            }
        });
        for consequent in &rule.rule.consequents {
            named.insert(&consequent.output.text);
            used.insert((&consequent.output.text, &consequent.term.text));
        }
    }
    let mut found = Vec::new();
    for variable in model.variables() {
        if !named.contains(variable.name.as_str()) {
            found.push(TermOf {
                variable: variable.name.clone(),
                term: None,
            });
            continue;
        }
        for term in &variable.terms {
            if !used.contains(&(variable.name.as_str(), term.name.as_str())) {
                found.push(term_of(variable, term));
            }
        }
    }
    found
}

fn term_of(variable: &Variable, term: &Term) -> TermOf {
    TermOf {
        variable: variable.name.clone(),
        term: Some(term.name.clone()),
    }
}

/// Returns the terms that are 0 on the whole range of their variable, and the output terms that are concluded only by
/// rules that cannot fire.
pub(super) fn unreachable(model: &Model, never_firing: &[usize]) -> Vec<TermOf> {
    let mut found = Vec::new();
    for variable in model.variables() {
        let terms = zero_terms(variable).into_iter();
        found.extend(terms.filter_map(|i| Some(term_of(variable, variable.terms.get(i)?))));
    }
    // `never_firing` is in ascending order, as the binary search requires.
    let mut alive: BTreeSet<(&str, &str)> = BTreeSet::new();
    let mut dead: BTreeSet<(&str, &str)> = BTreeSet::new();
    for (i, rule) in model.rules.iter().enumerate() {
        let group = if never_firing.binary_search(&i).is_ok() {
            &mut dead
        } else {
            &mut alive
        };
        let consequents = rule.rule.consequents.iter();
        group.extend(consequents.map(|c| (c.output.text.as_str(), c.term.text.as_str())));
    }
    for (output, term) in dead.difference(&alive) {
        let one = TermOf {
            variable: String::from(*output),
            term: Some(String::from(*term)),
        };
        if !found.contains(&one) {
            found.push(one);
        }
    }
    found
}

/// Returns whether the term with the given name is 0 on the whole range of its variable.
pub(super) fn is_zero_on_range(variable: &Variable, term: &str) -> bool {
    let values = axis::values(variable);
    let mut terms = variable.terms.iter().filter(|one| one.name == term);
    terms.any(|term| is_set(&term.membership_function, variable) && is_zero(term, &values))
}

fn is_zero(term: &Term, values: &[f64]) -> bool {
    values.iter().all(|&x| term.membership(x) == 0.0)
}

/// Returns the indices of the terms that are 0 on the whole range of a variable.
fn zero_terms(variable: &Variable) -> Vec<usize> {
    let range = variable.high - variable.low;
    if range.is_nan() || range <= 0.0 {
        // An invalid range is reported elsewhere.
        return Vec::new();
    }
    let values = axis::values(variable);
    let terms = variable.terms.iter().enumerate();
    // Linear and constant functions of a weighted output are not fuzzy sets; neither is a shape that could not be
    // parsed.
    terms
        .filter(|(_, term)| is_set(&term.membership_function, variable) && is_zero(term, &values))
        .map(|(i, _)| i)
        .collect()
}

fn is_set(shape: &MembershipFunction, variable: &Variable) -> bool {
    match shape {
        MembershipFunction::Function { formula } => formula.is_over(&variable.name),
        MembershipFunction::Linear { .. } | MembershipFunction::Constant { .. } => false,
        MembershipFunction::Piecewise { points } => !points.is_empty(),
        _ => true,
    }
}

/// Returns the intervals in which every term of an input is 0. Only rules with NOT can cover such values.
pub(super) fn holes(input: &Variable) -> Vec<TermGap> {
    if input.terms.is_empty() {
        // Only linear functions and formulas of outputs can read an input without terms.
        return Vec::new();
    }
    let covered = |x: f64| input.terms.iter().any(|term| term.membership(x) > 0.0);
    let values = axis::values(input);
    let mut found: Vec<TermGap> = Vec::new();
    let mut start: Option<f64> = None;
    let mut before: Option<f64> = None;
    for &x in &values {
        match (covered(x), start, before) {
            (false, None, None) => start = Some(x),
            (false, None, Some(last)) => {
                let low = axis::rounded(axis::bisect(last, x, covered));
                let is_thin = low - last <= THIN * (input.high - input.low);
                start = Some(if is_thin { last } else { low });
            }
            (true, Some(low), Some(last)) => {
                let high = axis::rounded(axis::bisect(last, x, |x| !covered(x)));
                found.push(hole(input, low, high));
                start = None;
            }
            _ => {}
        }
        before = Some(x);
    }
    if let Some(low) = start {
        found.push(hole(input, low, input.high));
    }
    found
}

/// The relative width below which a hole is a single value with a rounding error.
const THIN: f64 = 1e-9;

fn hole(input: &Variable, low: f64, high: f64) -> TermGap {
    let is_thin = high - low <= THIN * (input.high - input.low);
    let high = if is_thin { low } else { high };
    TermGap {
        input: input.name.clone(),
        low,
        high,
    }
}
