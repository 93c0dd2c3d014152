//! Statistics of margin and command over the time in the air.

use crate::{Flight, Gap};

/// Statistics of margin and command over all motors and all samples in the air, on either the effective or the
/// full range.
///
/// The margin of a command `c` is `min(c, 1 - c)`. Standard deviations are those of the population (divided by the
/// number of values).
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct Statistics {
    /// The number of rows of motor commands in the air.
    pub samples: usize,
    /// The mean margin.
    pub margin_mean: f64,
    /// The smallest margin.
    pub margin_min: f64,
    /// The standard deviation of the margin.
    pub margin_std: f64,
    /// The mean, over the rows, of the smallest margin among the motors.
    pub margin_mean_of_min: f64,
    /// The mean command.
    pub command_mean: f64,
    /// The standard deviation of the command.
    pub command_std: f64,
}

impl Flight {
    /// Computes the statistics on the effective range.
    ///
    /// # Errors
    ///
    /// The first gap of the log that prevents this, such as no motors, no range or no flight.
    ///
    /// ```
    /// let log = "t_s,motor1,motor2\n0,0.5,0.4\n0.1,0.5,0.8\n";
    /// let flight = flagred_flightlog::read(log.as_bytes(), &flagred_flightlog::Options::default())?;
    /// let statistics = flight.statistics()?;
    /// assert!((statistics.margin_mean - 0.4).abs() < 1e-12);
    /// assert!((statistics.command_mean - 0.55).abs() < 1e-12);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn statistics(&self) -> Result<Statistics, Gap> {
        self.statistics_of(|raw| self.effective_command(raw))
    }

    /// Computes the statistics on the full range, where a motor at its limit still has a margin.
    ///
    /// # Errors
    ///
    /// As [`Flight::statistics`].
    pub fn full_range_statistics(&self) -> Result<Statistics, Gap> {
        self.statistics_of(|raw| self.command(raw))
    }

    fn statistics_of(&self, command: impl Fn(f64) -> Option<f64>) -> Result<Statistics, Gap> {
        if let Some(gap) = self.gaps().into_iter().find(Gap::stops_statistics) {
            return Err(gap);
        }
        let mut samples = 0;
        let mut margins = Moments::default();
        let mut commands = Moments::default();
        let mut minima = Moments::default();
        let mut margin_min = f64::INFINITY;
        for (t_s, row) in self.commands.rows() {
            if self.is_in_air(t_s) != Some(true) {
                continue;
            }
            let mut least = f64::INFINITY;
            for c in row.iter().filter_map(|&raw| command(raw)) {
                let margin = c.min(1.0 - c);
                margins.add(margin);
                commands.add(c);
                least = least.min(margin);
            }
            if least.is_finite() {
                samples += 1;
                minima.add(least);
                margin_min = margin_min.min(least);
            }
        }
        if samples == 0 {
            return Err(Gap::NoCommandsInAir);
        }
        Ok(Statistics {
            samples,
            margin_mean: margins.mean,
            margin_min,
            margin_std: margins.std(),
            margin_mean_of_min: minima.mean,
            command_mean: commands.mean,
            command_std: commands.std(),
        })
    }
}

/// Mean and variance in one pass (Welford 1962), without cancellation.
#[derive(Default)]
struct Moments {
    count: f64,
    mean: f64,
    squares: f64,
}

impl Moments {
    fn add(&mut self, value: f64) {
        self.count += 1.0;
        let off = value - self.mean;
        self.mean += off / self.count;
        self.squares += off * (value - self.mean);
    }

    fn std(&self) -> f64 {
        (self.squares / self.count).sqrt()
    }
}
