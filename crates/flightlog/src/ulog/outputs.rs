//! Commands of motors and outputs in logs of PX4.

use crate::Commands;
use crate::signal::{BackstepDetector, Order};

/// The raw commands of one topic and instance.
pub(super) struct Outputs {
    pub(super) topic: &'static str,
    pub(super) instance: u8,
    t_s: Vec<f64>,
    /// Rows of `width` values.
    values: Vec<f32>,
    width: usize,
    pub(super) set_back: BackstepDetector,
}

impl Outputs {
    pub(super) fn new(topic: &'static str, instance: u8, width: usize) -> Self {
        Self {
            topic,
            instance,
            t_s: Vec::new(),
            values: Vec::new(),
            width,
            set_back: BackstepDetector::default(),
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.t_s.is_empty()
    }

    /// Adds a row; returns `true` if a row was dropped because times go back.
    pub(super) fn push(&mut self, t_s: f64, values: impl Iterator<Item = f32>) -> bool {
        let order = Order::of(&self.t_s, t_s);
        self.set_back.see(order, t_s, self.t_s.last());
        match order {
            Order::Last => {}
            Order::Replaces => {
                self.t_s.pop();
                self.values.truncate(self.t_s.len() * self.width);
            }
            Order::Back => return true,
        }
        self.t_s.push(t_s);
        self.values
            .extend(values.chain(std::iter::repeat(f32::NAN)).take(self.width));
        order != Order::Last
    }

    fn rows(&self) -> impl Iterator<Item = &[f32]> {
        self.values.chunks_exact(self.width.max(1))
    }

    /// The number of columns up to the last one that contains a finite value.
    pub(super) fn in_use(&self) -> usize {
        let used = |row: &[f32]| row.iter().rposition(|value| value.is_finite());
        self.rows()
            .filter_map(used)
            .max()
            .map_or(0, |last| last + 1)
    }

    /// The smallest and the largest value above 0; infinity and 0 if there is none.
    pub(super) fn extremes(&self, columns: impl Iterator<Item = usize> + Clone) -> (f64, f64) {
        let values = self
            .rows()
            .flat_map(|row| columns.clone().filter_map(|column| row.get(column)))
            .filter(|value| **value > 0.0);
        values.fold((f64::INFINITY, 0.0), |(smallest, largest), &value| {
            (smallest.min(value.into()), largest.max(value.into()))
        })
    }

    pub(super) fn commands(
        &self,
        columns: impl ExactSizeIterator<Item = usize> + Clone,
        value: impl Fn(f32) -> f64,
    ) -> Commands {
        let mut commands = Commands::new(columns.len());
        for (&t_s, row) in self.t_s.iter().zip(self.rows()) {
            let known = columns.clone().map(|column| row.get(column));
            commands.push(
                t_s,
                known.map(|raw| raw.map_or(f64::NAN, |&raw| value(raw))),
            );
        }
        commands
    }
}
