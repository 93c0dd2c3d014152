//! The properties of a vehicle that are known before it flies.

use crate::effort::Factors;

/// The vehicle that samples come from.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Craft<'a> {
    /// The number of motors in each sample.
    pub motors: usize,
    /// The names of the signals of a sample other than motor commands, in order.
    pub signals: &'a [&'a str],
    /// The subset of `signals` that the vehicle might never send. Until such a signal is known for the first time, the
    /// inputs that read it have the value of their
    /// [`if_missing`](crate::profile::ProfileInput::if_missing), or are unknown without it.
    pub optional: &'a [&'a str],
    /// The factors of each motor, in the order of the samples; empty if the geometry is unknown.
    pub geometry: &'a [Factors],
}

impl<'a> Craft<'a> {
    /// A craft with `motors` motors whose samples have no other signals.
    pub const fn new(motors: usize) -> Craft<'a> {
        Craft {
            motors,
            signals: &[],
            optional: &[],
            geometry: &[],
        }
    }

    /// Sets the names of the signals of a sample other than motor commands, in order.
    pub const fn with_signals(self, signals: &'a [&'a str]) -> Craft<'a> {
        Craft { signals, ..self }
    }

    /// Sets the signals that the craft may never send, as for a live vehicle whose messages are not known yet.
    pub const fn with_optional(self, optional: &'a [&'a str]) -> Craft<'a> {
        Craft { optional, ..self }
    }

    /// Whether the vehicle is known to send a signal.
    pub(crate) fn sends(&self, signal: &str) -> bool {
        self.signals.contains(&signal) && !self.optional.contains(&signal)
    }

    /// Sets the factors of each motor, so that yaw commands are separated from the rest.
    pub const fn with_geometry(self, geometry: &'a [Factors]) -> Craft<'a> {
        Craft { geometry, ..self }
    }
}
