//! The motor commands of a flight so far. If motors or limits become known later, the flight is assessed again from its
//! beginning.

use flagred_flightlog::mavlink::Pulses;

/// Maximum number of stored samples: 20 minutes at 25 Hz, in 2 MB.
pub(super) const MOST: usize = 30_000;

/// The samples of a flight.
#[derive(Debug)]
pub(super) struct History {
    most: usize,
    samples: Vec<(f64, Option<bool>, Pulses)>,
    is_cut: bool,
}

impl History {
    /// Creates an empty history for this many samples.
    pub(super) fn new(most: usize) -> History {
        History {
            most,
            samples: Vec::new(),
            is_cut: false,
        }
    }

    /// Adds a sample, and whether the vehicle reports to be in the air. If a flight is too long, all its samples are dropped.
    pub(super) fn push(&mut self, t_s: f64, in_air: Option<bool>, pulses: Pulses) {
        self.is_cut |= self.samples.len() >= self.most;
        match self.is_cut {
            true => self.samples = Vec::new(),
            false => self.samples.push((t_s, in_air, pulses)),
        }
    }

    /// Returns whether no sample was added.
    pub(super) fn is_empty(&self) -> bool {
        self.samples.is_empty() && !self.is_cut
    }

    /// Drops the flight.
    pub(super) fn clear(&mut self) {
        if !self.is_empty() {
            *self = History::new(self.most);
        }
    }

    /// The samples since take-off; `None` if the flight was too long.
    pub(super) fn whole(&self) -> Option<&[(f64, Option<bool>, Pulses)]> {
        (!self.is_cut).then_some(&self.samples[..])
    }
}
