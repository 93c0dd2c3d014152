//! Moving averages that store two numbers, where a window would need too much memory.

/// A moving average. Until its time constant has passed, it is the plain mean of all values.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Average {
    pub(crate) value: f64,
    pub(crate) known_s: f64,
}

impl Average {
    pub(crate) const NONE: Average = Average {
        value: 0.0,
        known_s: 0.0,
    };

    pub(crate) fn add(&mut self, value: f64, held_s: f64, constant_s: f64) {
        if value.is_finite() && held_s > 0.0 {
            self.known_s += held_s;
            let share = held_s / self.known_s.min(constant_s).max(held_s);
            self.value += (value - self.value) * share;
        }
    }

    /// The average; `None` until the average covers `least_s` seconds.
    pub(crate) fn known_after(&self, least_s: f64) -> Option<f64> {
        (self.known_s >= least_s).then_some(self.value)
    }
}

state! { struct Average { value, known_s } }
