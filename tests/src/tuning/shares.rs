//! Reliability: the share of rows that became critical, by bands of risk.

use std::collections::{BTreeMap, HashMap};

use fuzzy::{Engine, Model};

use super::{Failure, Row, Set};

/// The number of rows with a risk in a band, and how many of these rows became critical.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Share {
    /// The number of rows.
    pub moments: usize,
    /// The number of rows that became critical.
    pub followed: usize,
}

/// The risk at each row in %. Each vehicle belongs to a fold, and its risks come from the rule set that was tuned without
/// this fold.
///
/// # Errors
///
/// A rule set cannot be compiled, or has no value for a row.
pub fn risks_pct(
    rule_sets: &[Model],
    folds: &BTreeMap<&str, usize>,
    rows: &[Row],
) -> Result<Vec<f64>, Failure> {
    let engines: Vec<Engine> = rule_sets
        .iter()
        .map(Engine::new)
        .collect::<Result<_, _>>()?;
    let risk_pct = |row: &Row| {
        let outcome = engines[folds[row.vehicle.as_str()]].evaluate(&row.inputs)?[0];
        let value = outcome.value();
        value.ok_or_else(|| format!("no risk at {:?}", row.inputs).into())
    };
    rows.iter().map(risk_pct).collect()
}

/// The shares in `bands` bands of equal width from 0 to 100 %, for the rows of some data sets. Real flights have twice
/// as many rows per second as simulated ones, so only every second row of a real flight counts.
pub fn shares(rows: &[Row], risks_pct: &[f64], bands: usize, is_in: fn(Set) -> bool) -> Vec<Share> {
    let mut shares = vec![Share::default(); bands];
    let mut seen: HashMap<u32, usize> = HashMap::new();
    for (row, risk_pct) in rows.iter().zip(risks_pct) {
        let seen = seen.entry(row.flight).or_default();
        *seen += 1;
        if !is_in(row.set) || (row.set.is_real() && seen.is_multiple_of(2)) {
            continue;
        }
        let band = (risk_pct / 100.0 * bands as f64) as usize;
        let share = &mut shares[band.min(bands - 1)];
        share.moments += 1;
        share.followed += usize::from(row.is_critical);
    }
    shares
}

/// The text of a profile with these shares as its key `reliability`; `None` if it does not have this key.
pub fn with_shares(profile: &str, real: &[Share], simulated: &[Share]) -> Option<String> {
    let key = profile.find("\nreliability:")? + 1;
    let first = key + profile[key..].find('\n')? + 1;
    let is_row = |line: &&str| line.starts_with("  - ");
    let rows: usize = profile[first..]
        .split_inclusive('\n')
        .take_while(is_row)
        .map(str::len)
        .sum();
    let width_pct = 100 / real.len().max(1);
    let row = |(i, (real, simulated)): (usize, (&Share, &Share))| {
        let of = |share: &Share| {
            format!(
                "{{moments: {}, followed: {}}}",
                share.moments, share.followed
            )
        };
        let (from, to) = (i * width_pct, (i + 1) * width_pct);
        format!(
            "  - {{risk: [{from}, {to}], real: {}, simulated: {}}}\n",
            of(real),
            of(simulated)
        )
    };
    let written: String = real.iter().zip(simulated).enumerate().map(row).collect();
    Some(format!(
        "{}{written}{}",
        &profile[..first],
        &profile[first + rows..]
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_rows_of_a_profile_are_replaced() {
        let share = |moments, followed| Share { moments, followed };
        let profile = "a: 1\nreliability:  # measured\n  - {old: 1}\n  - {old: 2}\nb: 2\n";
        let text = with_shares(
            profile,
            &[share(4, 1), share(2, 2)],
            &[share(9, 0), share(3, 1)],
        );
        let expected = "a: 1\nreliability:  # measured\n\
            \x20 - {risk: [0, 50], real: {moments: 4, followed: 1}, simulated: {moments: 9, followed: 0}}\n\
            \x20 - {risk: [50, 100], real: {moments: 2, followed: 2}, simulated: {moments: 3, followed: 1}}\nb: 2\n";
        assert_eq!(text.as_deref(), Some(expected));
        assert_eq!(with_shares("a: 1\n", &[], &[]), None);
    }
}
