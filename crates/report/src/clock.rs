//! Times of a flight in words: seconds on the clock of the log, or minutes since take-off.

/// How a time is written.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Clock {
    /// `86.5 s`, on the clock of the log.
    Log,
    /// `1:02.3 min`, counted from this time in seconds on the clock of the log.
    Since(f64),
}

impl Clock {
    /// A time with its unit.
    pub(crate) fn at(self, t_s: f64) -> String {
        match self {
            Clock::Log => format!("{t_s:.1} s"),
            Clock::Since(start_s) => minutes(t_s - start_s, 1) + " min",
        }
    }

    /// A span of time with its unit.
    pub(crate) fn span(self, from_s: f64, to_s: f64) -> String {
        match self {
            Clock::Log => format!("{from_s:.1} to {}", self.at(to_s)),
            Clock::Since(start_s) => {
                format!("{} to {}", minutes(from_s - start_s, 1), self.at(to_s))
            }
        }
    }
}

/// Minutes and seconds, as in `12:03.4`.
pub(crate) fn minutes(seconds: f64, decimals: usize) -> String {
    let unit = 10f64.powi(decimals as i32);
    let rounded = (seconds * unit).round() / unit;
    let (minutes, rest) = ((rounded.abs() / 60.0).floor(), rounded.abs() % 60.0);
    let sign = if rounded < 0.0 { "-" } else { "" };
    let width = if decimals > 0 { decimals + 3 } else { 2 };
    format!("{sign}{minutes}:{rest:0width$.decimals$}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn minutes_and_seconds_carry_and_keep_their_width() {
        assert_eq!(minutes(0.0, 0), "0:00");
        assert_eq!(minutes(59.96, 1), "1:00.0");
        assert_eq!(minutes(3723.04, 1), "62:03.0");
        assert_eq!(minutes(-3.0, 1), "-0:03.0");
        assert_eq!(
            Clock::Since(40.0).span(50.0, 105.25),
            "0:10.0 to 1:05.3 min"
        );
        assert_eq!(Clock::Log.span(50.0, 105.26), "50.0 to 105.3 s");
    }
}
