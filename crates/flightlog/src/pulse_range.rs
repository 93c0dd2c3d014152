//! The range of motor outputs that the user gives for logs that do not report one.

use crate::error::UNNAMED;
use crate::outputs::PULSES_US;
use crate::{Flight, Range, ReadError};

/// The range of the motor outputs as pulse widths, for a log or a vehicle that does not report it: see
/// [`Options::range`](crate::Options::range).
///
/// # Example
/// ```
/// use flagred_flightlog::PulseRange;
///
/// assert!(PulseRange::new(1100, 1900).is_ok());
/// let error = PulseRange::new(1900, 1100).unwrap_err();
/// assert_eq!(error.to_string(), "`1900` to `1100` us is not a range of motor outputs");
/// assert_eq!(error.help(), "expected two pulse widths from 500 to 2500 us, the second at least 100 above the first");
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PulseRange {
    low_us: u16,
    high_us: u16,
}

/// The error for two pulse widths that are not a valid range of motor outputs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("`{low_us}` to `{high_us}` us is not a range of motor outputs")]
pub struct PulseRangeError {
    low_us: u16,
    high_us: u16,
}

impl PulseRangeError {
    /// The requirements for a range.
    pub fn help(&self) -> &'static str {
        "expected two pulse widths from 500 to 2500 us, the second at least 100 above the first"
    }
}

/// The source of a range that the user gave.
const GIVEN: &str = "given by the user";
/// The largest share of commands that may contradict the given range; these commands count as damaged.
const DAMAGED: f64 = 1e-4;
/// A command contradicts the given range only if it exceeds the range by more than this, in us.
const ROUNDING_US: f64 = 5.0;

impl PulseRange {
    /// Creates a range from the lowest to the highest pulse width of the motor outputs, in us.
    ///
    /// # Errors
    ///
    /// If no speed controller has this range.
    pub fn new(low_us: u16, high_us: u16) -> Result<Self, PulseRangeError> {
        match PULSES_US.allow((low_us.into(), high_us.into())) {
            true => Ok(Self { low_us, high_us }),
            false => Err(PulseRangeError { low_us, high_us }),
        }
    }

    pub(crate) fn range(self) -> Range {
        Range {
            low: self.low_us.into(),
            high: self.high_us.into(),
            unit: "us",
            source: GIVEN.into(),
        }
    }

    /// The assumption to report if the log or the vehicle does not report its range.
    pub(crate) fn assumed(self) -> String {
        let Self { low_us, high_us } = self;
        format!("commands from {low_us} to {high_us} us, {GIVEN}")
    }

    /// Adds this range to the assumptions of a flight that was read with it.
    ///
    /// # Errors
    ///
    /// If the log contradicts the range.
    pub(crate) fn apply(self, flight: &mut Flight) -> Result<(), ReadError> {
        if let Some((problem, help)) = self.contradiction(flight) {
            let path = UNNAMED.into();
            return Err(ReadError::Range {
                path,
                problem,
                help,
            });
        }
        let assumed = self.assumed();
        if flight.range.is_some() && !flight.assumed.contains(&assumed) {
            flight.assumed.push(assumed);
        }
        Ok(())
    }

    /// The contradiction between this range and a flight that was read with it, and what to do about it.
    fn contradiction(self, flight: &Flight) -> Option<(String, &'static str)> {
        let range = flight.range.as_ref()?;
        if range.source != GIVEN {
            let unit = if range.unit == "1" { "" } else { range.unit };
            let Range {
                low, high, source, ..
            } = range;
            let own = format!("{low} to {high} {unit}").trim_end().to_owned();
            let problem = format!("reports its own range, {own} ({source})");
            return Some((problem, "assess this log without a given range"));
        }
        let in_air = |t_s: f64| flight.is_in_air(t_s) != Some(false);
        let rows = flight.commands.rows().filter(|(t_s, _)| in_air(*t_s));
        let known = rows.flat_map(|(_, row)| row.iter().copied().filter(|raw| *raw > 0.0));
        let (mut all, mut short, mut above, mut longest) = (0_u64, 0_u64, 0_u64, 0.0_f64);
        for raw in known {
            all += 1;
            short += u64::from(raw < PULSES_US.least);
            above += u64::from(raw > range.high + ROUNDING_US);
            longest = longest.max(raw);
        }
        let most = (DAMAGED * all as f64) as u64;
        if short > most {
            let problem = "has motor commands that are not pulse widths in us".to_owned();
            return Some((problem, "give a range for logs of PWM outputs only"));
        }
        (above > most).then(|| {
            let problem = format!("has motor commands up to {longest} us, above the given range");
            (
                problem,
                "give the range that the motor outputs have on the vehicle",
            )
        })
    }
}
