//! The motor commands of a flight so far. Where motors or limits become known better, the flight is assessed again from its
//! beginning.

use flagred_flightlog::mavlink::Pulses;

/// Samples that are kept: 20 minutes at 25 Hz, in 2 MB.
pub(super) const MOST: usize = 30_000;

/// The samples of a flight.
#[derive(Debug)]
pub(super) struct History {
    most: usize,
    samples: Vec<(f64, Option<bool>, Pulses)>,
    is_cut: bool,
}

impl History {
    /// An empty one for so many samples.
    pub(super) fn new(most: usize) -> History {
        History {
            most,
            samples: Vec::new(),
            is_cut: false,
        }
    }

    /// Adds a sample, with what the vehicle reports of being in the air. Of a flight that is too long nothing is kept.
    pub(super) fn push(&mut self, t_s: f64, in_air: Option<bool>, pulses: Pulses) {
        self.is_cut |= self.samples.len() >= self.most;
        match self.is_cut {
            true => self.samples = Vec::new(),
            false => self.samples.push((t_s, in_air, pulses)),
        }
    }

    /// Whether nothing was added.
    pub(super) fn is_empty(&self) -> bool {
        self.samples.is_empty() && !self.is_cut
    }

    /// Forgets the flight.
    pub(super) fn clear(&mut self) {
        if !self.is_empty() {
            *self = History::new(self.most);
        }
    }

    /// The samples since take-off; `None` where not all are kept.
    pub(super) fn whole(&self) -> Option<&[(f64, Option<bool>, Pulses)]> {
        (!self.is_cut).then_some(&self.samples[..])
    }
}
