//! Detects columns whose values are probably shares although the range of their variable is in percent.

use fuzzy::model::Variable;

/// The extent of the values of a column.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Extent {
    count: u64,
    pub(crate) low: f64,
    pub(crate) high: f64,
    /// Whether a value is neither 0 nor 1.
    has_fraction: bool,
}

impl Extent {
    pub(crate) const NONE: Extent = Extent {
        count: 0,
        low: f64::INFINITY,
        high: f64::NEG_INFINITY,
        has_fraction: false,
    };

    /// Returns the extent of the numbers among the values.
    pub(crate) fn of(values: impl IntoIterator<Item = f64>) -> Extent {
        values.into_iter().fold(Extent::NONE, |extent, value| {
            extent.and(match value.is_finite() {
                false => Extent::NONE,
                true => Extent {
                    count: 1,
                    low: value,
                    high: value,
                    has_fraction: value != 0.0 && value != 1.0,
                },
            })
        })
    }

    /// Returns the extent of both columns together.
    pub(crate) fn and(self, other: Extent) -> Extent {
        Extent {
            count: self.count + other.count,
            low: self.low.min(other.low),
            high: self.high.max(other.high),
            has_fraction: self.has_fraction || other.has_fraction,
        }
    }

    /// Returns a warning if the values of a variable are shares, but its range is much wider. If all values are 0 or 1,
    /// they count as outcomes, not as shares.
    pub(crate) fn warning(self, variable: &Variable) -> Option<String> {
        const FEWEST: u64 = 3;
        const NARROWEST: f64 = 10.0;
        let Variable {
            name, low, high, ..
        } = variable;
        let is_share =
            self.count >= FEWEST && self.has_fraction && self.low >= 0.0 && self.high <= 1.0;
        (is_share && high - low >= NARROWEST).then(|| {
            format!(
                "warning: all {} values of `{name}` are from {} to {}, but its range is {low} to {high}: is the column a fraction instead of a percentage?",
                self.count, self.low, self.high
            )
        })
    }
}
