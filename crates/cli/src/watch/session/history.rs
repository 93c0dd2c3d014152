//! The motor commands of a flight so far. If motors or limits become known later, the flight is assessed again from its
//! beginning.

use flagred_flightlog::mavlink::Pulses;

/// Maximum number of stored samples: 20 minutes at 25 Hz, in 3 MB.
pub(super) const MAX_SAMPLES: usize = 30_000;

/// A sample as it was received.
#[derive(Debug, Clone)]
pub(super) struct ReceivedSample {
    pub(super) t_s: f64,
    /// Whether the vehicle reports that it is in the air.
    pub(super) in_air: Option<bool>,
    pub(super) pulses: Pulses,
    /// The signals of the profile, in the order of the profile; NaN means unknown.
    pub(super) signals: Vec<f64>,
}

/// The samples of a flight.
#[derive(Debug)]
pub(super) struct History {
    most: usize,
    samples: Vec<ReceivedSample>,
    is_cut: bool,
}

impl History {
    /// Creates an empty history for a maximum number of samples.
    pub(super) fn new(most: usize) -> History {
        History {
            most,
            samples: Vec::new(),
            is_cut: false,
        }
    }

    /// Adds a sample. A flight that is too long is not stored at all.
    pub(super) fn push(&mut self, received: ReceivedSample) {
        self.is_cut |= self.samples.len() >= self.most;
        match self.is_cut {
            true => self.samples = Vec::new(),
            false => self.samples.push(received),
        }
    }

    /// Returns whether no sample was added.
    pub(super) fn is_empty(&self) -> bool {
        self.samples.is_empty() && !self.is_cut
    }

    /// Removes all samples.
    pub(super) fn clear(&mut self) {
        if !self.is_empty() {
            *self = History::new(self.most);
        }
    }

    /// The samples since take-off; `None` if some were dropped.
    pub(super) fn whole(&self) -> Option<&[ReceivedSample]> {
        (!self.is_cut).then_some(&self.samples[..])
    }
}
