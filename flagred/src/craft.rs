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
    /// The factors of each motor, in the order of the samples; empty where the geometry is unknown.
    pub geometry: &'a [Factors],
}

impl<'a> Craft<'a> {
    /// A craft with so many motors whose samples carry no other signals.
    pub const fn new(motors: usize) -> Craft<'a> {
        Craft {
            motors,
            signals: &[],
            geometry: &[],
        }
    }

    /// The same craft with samples that carry signals of these names, in this order.
    pub const fn with_signals(self, signals: &'a [&'a str]) -> Craft<'a> {
        Craft { signals, ..self }
    }

    /// The same craft with the factors of each motor, so that turning the nose is told from what pushes the craft around.
    pub const fn with_geometry(self, geometry: &'a [Factors]) -> Craft<'a> {
        Craft { geometry, ..self }
    }
}
