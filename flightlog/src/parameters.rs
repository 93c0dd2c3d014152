//! Parameters of an autopilot, from its log or its telemetry.

use std::collections::BTreeMap;

/// Parameters by name, each with the FIRST value in the log: failure tests and learning change
/// parameters in flight.
#[derive(Debug, Default)]
pub(crate) struct Parameters {
    values: BTreeMap<String, f64>,
    left_out: u64,
}

/// Parameters that are kept; vehicles have up to about 2,000.
const MOST: usize = 1 << 14;
/// Bytes of a name; autopilots allow 16.
const LONGEST_NAME: usize = 64;

impl Parameters {
    pub(crate) fn insert(&mut self, name: &str, value: f64) {
        if !value.is_finite() || self.values.contains_key(name) {
            return;
        }
        match self.values.len() < MOST && name.len() <= LONGEST_NAME {
            true => _ = self.values.insert(name.to_owned(), value),
            false => self.left_out += 1,
        }
    }

    pub(crate) fn get(&self, name: &str) -> Option<f64> {
        self.values.get(name).copied()
    }

    /// Values beyond the bounds, which were not kept.
    pub(crate) fn left_out(&self) -> u64 {
        self.left_out
    }

    pub(crate) fn pair(&self, low: &str, high: &str) -> Option<(f64, f64)> {
        Some((self.get(low)?, self.get(high)?)).filter(|(low, high)| high > low)
    }
}

impl<'a> FromIterator<(&'a str, f64)> for Parameters {
    fn from_iter<T: IntoIterator<Item = (&'a str, f64)>>(pairs: T) -> Self {
        let mut parameters = Self::default();
        for (name, value) in pairs {
            parameters.insert(name, value);
        }
        parameters
    }
}

/// The name of a number in a table with gaps; `what` and the number where the table has none.
pub(crate) fn name_of(names: &[&str], number: i64, what: &str) -> String {
    let name = usize::try_from(number)
        .ok()
        .and_then(|index| names.get(index));
    match name {
        Some(name) if !name.is_empty() => (*name).into(),
        _ => format!("{what} {number}"),
    }
}
