//! Parameters of an autopilot, from its log or its telemetry.

use std::collections::BTreeMap;

/// Parameters by name, each with the FIRST value in the log: failure tests and learning change
/// parameters in flight.
#[derive(Debug, Default)]
pub(crate) struct Parameters(BTreeMap<String, f64>);

impl Parameters {
    pub(crate) fn insert(&mut self, name: &str, value: f64) {
        if value.is_finite() && !self.0.contains_key(name) {
            self.0.insert(name.to_owned(), value);
        }
    }

    pub(crate) fn get(&self, name: &str) -> Option<f64> {
        self.0.get(name).copied()
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
