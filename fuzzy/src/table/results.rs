//! The results of an evaluation of several rows, and their conversion to outcomes.

use super::{Outcome, State};

/// The results for an output in `L` rows.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Results<const L: usize> {
    /// The values if no rule fires; NaN if the output is then undefined.
    pub(crate) default_values: [f64; L],
    /// The values that rules determined; NaN if no rule fired.
    pub(crate) values: [f64; L],
    /// The largest firing strengths.
    pub(crate) coverage: [f64; L],
    /// The [numbers](number_of) of the rules with those strengths, infinite if none is above 0.
    pub(crate) rules: [f64; L],
    pub(crate) input_flags: InputFlags<L>,
}

/// Flags of the inputs of `L` rows. A flag is as wide as a value, so that a vector contains as many flags as values.
#[derive(Debug, Clone, Copy)]
pub(crate) struct InputFlags<const L: usize> {
    /// 1 if an input was outside its range, else 0.
    pub(crate) clamped: [u64; L],
    /// 1 if an input is NaN or infinite, else 0.
    pub(crate) infinite: [u64; L],
}

/// Returns the number of a rule, `2^52 + index`. It is as wide as a firing strength, so that a vector contains as many
/// rule numbers as strengths.
#[inline(always)]
pub(crate) fn number_of(rule: u32) -> f64 {
    f64::from_bits(0x4330 << 48 | u64::from(rule))
}

#[inline(always)]
fn rule_of(number: f64) -> u32 {
    number.to_bits() as u32
}

impl<const L: usize> Results<L> {
    /// The results before the evaluation of any row.
    pub(crate) const NONE: Self = Results {
        default_values: [f64::NAN; L],
        values: [f64::NAN; L],
        coverage: [0.0; L],
        rules: [f64::INFINITY; L],
        input_flags: InputFlags {
            clamped: [0; L],
            infinite: [0; L],
        },
    };

    /// Returns the value of a row: the value that rules determined, or the default value if no rule fired. NaN if there
    /// is no value.
    #[inline(always)]
    pub(crate) fn value(&self, row: usize) -> f64 {
        let value = self.values[row];
        let value = if value.is_nan() {
            self.default_values[row]
        } else {
            value
        };
        if self.input_flags.infinite[row] != 0 {
            f64::NAN
        } else {
            value
        }
    }

    /// Returns the rule with the largest firing strength in a row.
    #[inline(always)]
    pub(crate) fn dominant(&self, row: usize) -> Option<u32> {
        (self.coverage[row] > 0.0).then_some(rule_of(self.rules[row]))
    }

    /// Stores the outcome of a row. Only the middle of an interval is stored.
    pub(crate) fn set(&mut self, row: usize, outcome: &Outcome) {
        (self.values[row], self.default_values[row]) = (f64::NAN, f64::NAN);
        let value = outcome.value().unwrap_or(f64::NAN);
        match outcome.state {
            State::Defined(_) | State::Interval { .. } => self.values[row] = value,
            State::Default(_) | State::Previous(_) => self.default_values[row] = value,
            State::NoRuleFired | State::InputNotFinite => {}
        }
        self.coverage[row] = outcome.coverage;
        self.rules[row] = outcome
            .dominant_rule
            .map_or(f64::INFINITY, |rule| number_of(rule as u32));
        self.input_flags.clamped[row] = u64::from(outcome.clamped);
        self.input_flags.infinite[row] = u64::from(outcome.state == State::InputNotFinite);
    }

    /// Returns the outcome of a row.
    #[inline(always)]
    pub(crate) fn outcome(&self, row: usize) -> Outcome {
        if self.input_flags.infinite[row] != 0 {
            return Outcome {
                state: State::InputNotFinite,
                ..Outcome::UNDEFINED
            };
        }
        let value = self.values[row];
        Outcome {
            state: if !value.is_nan() {
                State::Defined(value)
            } else if self.default_values[row].is_nan() {
                State::NoRuleFired
            } else {
                State::Default(self.default_values[row])
            },
            coverage: self.coverage[row],
            dominant_rule: self.dominant(row).map(|rule| rule as usize),
            clamped: self.input_flags.clamped[row] != 0,
        }
    }
}
