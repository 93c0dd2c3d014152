//! Computes inputs of profiles from a table with one row for each flight, which contains means and standard
//! deviations of the motor commands.
//!
//! These are statistics of the normalised command c on the full range. Moments of a command convert exactly to
//! the effective range, `e = (c - low) / (high - low)`. By the law of total variance, the variance over all
//! motors and times is the variance over time of the mean of the motors, plus the mean over time of the variance
//! between motors.

use flagred::source::{Motors, Signal, Source, Statistic};

/// A method to compute an input from columns and from the limits of the effective range.
pub struct Recipe {
    /// The columns that the recipe reads.
    pub columns: &'static [&'static str],
    make: Make,
}

type Make = fn(&[f64], f64, f64) -> f64;

impl Recipe {
    /// The value for a row. `cell` returns the number in a column, or `None` if there is no such column; without limits
    /// the effective range is the full range.
    ///
    /// # Errors
    /// The errors of `cell`.
    pub fn value<E>(&self, cell: impl Fn(&str) -> Result<Option<f64>, E>) -> Result<f64, E> {
        let low = cell("c_limit_low")?.unwrap_or(0.0);
        let high = cell("c_limit_high")?.unwrap_or(1.0);
        let values = self.columns.iter().map(|name| cell(name));
        let values = values.collect::<Result<Option<Vec<f64>>, E>>()?;
        Ok(values.map_or(f64::NAN, |values| (self.make)(&values, low, high)))
    }
}

/// The recipe of a source; `None` if it cannot be computed from means and standard deviations.
pub fn recipe(source: &Source) -> Option<Recipe> {
    let spread: Make = |values, low, high| values[0] / (high - low);
    let (columns, make): (&'static [&'static str], Make) =
        match (source.statistic, source.motors, &source.signal) {
            (Statistic::Mean, Motors::Pooled | Motors::Mean, Signal::MotorCommand) => {
                (&["c_mean"], |values, low, high| {
                    ((values[0] - low) / (high - low)).clamp(0.0, 1.0)
                })
            }
            (Statistic::Std, Motors::Pooled, Signal::MotorCommand) => (&["c_std"], spread),
            (Statistic::Std, Motors::Mean, Signal::MotorCommand) => (&["c_std_time"], spread),
            (Statistic::Mean, Motors::Std, Signal::MotorCommand) => (&["c_std_motors"], spread),
            (Statistic::Std, Motors::Std, Signal::MotorCommand) => (
                &["c_std", "c_std_time", "c_std_motors"],
                |values, low, high| {
                    let square = values[0].powi(2) - values[1].powi(2) - values[2].powi(2);
                    square.max(0.0).sqrt() / (high - low)
                },
            ),
            (Statistic::Mean, Motors::Pooled, Signal::MotorMargin) => {
                (&["margin_mean", "c_mean"], effective_margin)
            }
            (Statistic::Mean, Motors::Min, Signal::MotorMargin) => {
                (&["margin_min_mean", "c_mean"], effective_margin)
            }
            (Statistic::ShareBelow(limit), Motors::Pooled, Signal::MotorMargin)
                if (0.004..0.01).contains(&limit) =>
            {
                (&["sat_lim_frac"], |values, _, _| values[0])
            }
            _ => return None,
        };
    Some(Recipe { columns, make })
}

/// Converts a mean margin to the effective range. The result is exact if all commands are on the same side of the
/// middle of both ranges.
fn effective_margin(values: &[f64], low: f64, high: f64) -> f64 {
    let nearer = if values[1] < 0.5 {
        values[0] - low
    } else {
        high - (1.0 - values[0])
    };
    (nearer / (high - low)).clamp(0.0, 0.5)
}
