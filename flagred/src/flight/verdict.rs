//! The verdict of a flight, or why there is none.

use alloc::string::String;
use core::fmt;

use crate::{
    monitor::{MonitorError, Unknown},
    verdict::Level,
};

/// How risky a flight was.
#[derive(Debug, Clone, PartialEq)]
pub enum Verdict {
    /// The level of its gravest finding; GOOD without any.
    Known(Level),
    /// There is no answer (NA), and why.
    NotAvailable(Reason),
}

impl Verdict {
    /// The verdict of two flights: the graver one. A flight that was lost in the air is graver than GOOD; one without
    /// a verdict for another reason counts only where nothing else is known.
    ///
    /// ```
    /// use flagred::{flight::{Reason, Verdict}, verdict::Level};
    ///
    /// let good = Verdict::Known(Level::Good);
    /// let short = Verdict::NotAvailable(Reason::NoCommands);
    /// assert_eq!(good.clone().worst(short), good);
    /// assert_eq!(good.clone().worst(good.clone().lost_in_air()).to_string(), "NA");
    /// ```
    pub fn worst(self, other: Verdict) -> Verdict {
        match self.gravity() >= other.gravity() {
            true => self,
            false => other,
        }
    }

    /// The same for a flight whose end nobody saw: what was seen of it is not GOOD for that.
    pub fn lost_in_air(self) -> Verdict {
        match self {
            Verdict::Known(level) if level > Level::Info => self,
            _ => Verdict::NotAvailable(Reason::LostInAir),
        }
    }

    fn gravity(&self) -> u8 {
        match self {
            Verdict::NotAvailable(Reason::NoFlight) => 0,
            Verdict::NotAvailable(Reason::LostInAir) => 3,
            Verdict::NotAvailable(_) => 1,
            Verdict::Known(Level::Good | Level::Info) => 2,
            Verdict::Known(Level::Warn) => 4,
            Verdict::Known(Level::Fail) => 5,
        }
    }
}

impl fmt::Display for Verdict {
    /// `GOOD`, `WARN`, `FAIL` or `NA`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Verdict::Known(level) => level.fmt(f),
            Verdict::NotAvailable(_) => f.pad("NA"),
        }
    }
}

/// Why a flight has no verdict.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Reason {
    /// The log lacks something that an assessment needs.
    #[cfg(feature = "flightlog")]
    #[error("{0}")]
    Log(flightlog::Gap),
    /// The profile cannot be used on this flight.
    #[error("{0}")]
    Monitor(#[from] MonitorError),
    /// The risk was unknown for most of the time in the air.
    #[error("{explanation}")]
    RiskUnknown {
        /// What made it unknown for longest.
        unknown: Unknown,
        /// The same in words.
        explanation: String,
        /// What helps, where something does.
        help: Option<&'static str>,
    },
    /// There was hardly a motor command in the air.
    #[error("hardly any motor command was known in the air")]
    NoCommands,
    /// The vehicle was in the air when it was last heard, or rebooted there.
    #[error("the vehicle was lost in the air")]
    LostInAir,
    /// No flight was watched.
    #[error("no flight was seen")]
    NoFlight,
}

impl Reason {
    /// What the pilot can do to get a verdict of the next flight.
    pub fn help(&self) -> Option<&'static str> {
        match self {
            #[cfg(feature = "flightlog")]
            Reason::Log(gap) => gap.help(),
            Reason::Monitor(MonitorError::NoSignal { .. }) => {
                Some("`flagred inspect` lists the signals that a log carries")
            }
            Reason::RiskUnknown { help, .. } => *help,
            Reason::LostInAir => {
                Some("the log on board tells how the flight ended: `flagred assess`")
            }
            Reason::Monitor(_) | Reason::NoCommands | Reason::NoFlight => None,
        }
    }
}
