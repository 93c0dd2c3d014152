//! What is known of a craft before it flies.

use crate::effort::Factors;

/// The vehicle that samples come from.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Craft<'a> {
    /// The number of motors.
    pub motors: usize,
    /// The names of the signals that samples carry beside the motors, in their order.
    pub signals: &'a [&'a str],
    /// Those of the signals that the vehicle may never send. Until one is known for the first time, an input with
    /// [`if_missing`](crate::profile::ProfileInput::if_missing) has that value.
    pub optional: &'a [&'a str],
    /// The factors of each motor, in the order of the samples; empty where the geometry is unknown.
    pub geometry: &'a [Factors],
}

impl<'a> Craft<'a> {
    /// A craft with so many motors whose samples carry no other signals.
    pub const fn new(motors: usize) -> Craft<'a> {
        Craft {
            motors,
            signals: &[],
            optional: &[],
            geometry: &[],
        }
    }

    /// The same craft with samples that carry signals of these names, in this order.
    pub const fn with_signals(self, signals: &'a [&'a str]) -> Craft<'a> {
        Craft { signals, ..self }
    }

    /// The same craft that may never send some of its signals: a live vehicle, of which nobody knows yet what it sends.
    pub const fn with_optional(self, optional: &'a [&'a str]) -> Craft<'a> {
        Craft { optional, ..self }
    }

    /// Whether the vehicle sends a signal.
    pub(crate) fn sends(&self, signal: &str) -> bool {
        self.signals.contains(&signal) && !self.optional.contains(&signal)
    }

    /// The same craft with the factors of each motor, so that turning the nose is told from what pushes the craft around.
    pub const fn with_geometry(self, geometry: &'a [Factors]) -> Craft<'a> {
        Craft { geometry, ..self }
    }
}
