//! Statistics of a signal over the last seconds: time-weighted, without drift, in fixed memory.
//!
//! A sample applies to the time since the previous sample, so the statistics are integrals over the window `(t -
//! length, t]` and do not depend on the sample rate. At an even rate they are the plain statistics of the samples in
//! the window.

use crate::moments::Moments;
#[cfg(feature = "std")]
use crate::state::State;

mod slots;

/// The number of slots that the samples of a window are divided into. See [`Window`].
const SLOTS: usize = 128;

/// A sample counts as outside the window if its part inside is at most this long, in seconds: timestamps have a
/// resolution of one microsecond.
const TIME_RESOLUTION_S: f64 = 1e-6;

/// The statistics of a signal over the last `length_s` seconds.
///
/// The memory is fixed for any sample rate, and the average cost of a sample does not depend on the length (the
/// worst single sample takes about a hundred merges). The window is divided into 128 slots of time, the samples of
/// a slot are merged, and the slots form a queue of two stacks with running totals. With up to 128 evenly spaced
/// samples in a window (64 Hz at 2 s), every sample has its own slot and the statistics are exact. If samples
/// share slots, the oldest slot counts in proportion to the part of it that is still inside the window, and the
/// extremes may include values that left the window up to 1/128 of its length ago.
///
/// A [`board::Monitor`](crate::board::Monitor) takes it as memory from the caller; a
/// [`source::Observer`](crate::source::Observer) owns it.
///
/// # Example: a second of silence leaves a window of one second empty
///
/// ```
/// use flagred::{monitor::Craft, source::{Motors, Observer, Signal, Source, Statistic}};
///
/// let margin = Source { statistic: Statistic::Mean, motors: Motors::Pooled, signal: Signal::MotorMargin, window_s: 1.0, exponential: false };
/// let mut observer = Observer::new([&margin], Craft::new(1))?;
/// for i in 1..=50 {
///     observer.push(f64::from(i) * 0.04, 0.04, &[0.3], &[]);
/// }
/// assert_eq!(observer.value(0).and_then(|observed| observed.samples), Some(25));
/// observer.push(3.0, 1.0, &[f64::NAN], &[]);
/// assert_eq!(observer.value(0), None);
/// # Ok::<(), String>(())
/// ```
#[derive(Debug, Clone)]
pub struct Window {
    length_s: f64,
    now_s: f64,
    /// A ring; the `len` entries from `oldest` on are the slots in use, oldest first.
    slots: [Slot; SLOTS + 2],
    oldest: usize,
    len: usize,
    samples: u32,
    /// The number of slots in the front: the oldest slots, of which `and_later` is set.
    front: usize,
    /// The total of all slots after the front.
    back: Moments,
}

#[derive(Debug, Clone, Copy)]
struct Slot {
    /// The number of the slot, counted from t = 0.
    index: f64,
    start_s: f64,
    end_s: f64,
    samples: u32,
    moments: Moments,
    /// The total of this slot and the later slots of the front.
    and_later: Moments,
}

impl Window {
    /// Memory for a window, all zeros, so that a static one takes no space in the firmware image; a monitor initialises
    /// it.
    pub const IDLE: Window = {
        const FREE: Slot = Slot {
            index: 0.0,
            start_s: 0.0,
            end_s: 0.0,
            samples: 0,
            moments: Moments::IDLE,
            and_later: Moments::IDLE,
        };
        Window {
            length_s: 0.0,
            now_s: 0.0,
            slots: [FREE; SLOTS + 2],
            oldest: 0,
            len: 0,
            samples: 0,
            front: 0,
            back: Moments::IDLE,
        }
    };

    /// An empty window over the last `length_s` seconds (above 0).
    #[cfg(feature = "std")]
    pub(crate) fn new(length_s: f64) -> Window {
        Window {
            length_s,
            now_s: f64::NEG_INFINITY,
            back: Moments::EMPTY,
            ..Window::IDLE
        }
    }

    /// Resets the window to an empty one over the last `length_s` seconds, in place.
    pub(crate) fn restart(&mut self, length_s: f64) {
        self.length_s = length_s;
        self.oldest = 0;
        self.clear();
    }

    /// The length in seconds.
    pub(crate) fn length_s(&self) -> f64 {
        self.length_s
    }

    /// Discards all samples.
    pub(crate) fn clear(&mut self) {
        self.len = 0;
        self.samples = 0;
        self.front = 0;
        self.back = Moments::EMPTY;
        self.now_s = f64::NEG_INFINITY;
    }

    /// Adds a sample at `t_s` that applies to the `held_s` seconds before; its moments have the total weight `held_s`.
    /// A sample with `held_s` of 0 does not count.
    ///
    /// `t_s` must not decrease; a sample older than the newest one is treated as if it had the time of the newest one.
    pub(crate) fn push(&mut self, t_s: f64, held_s: f64, moments: &Moments) {
        self.advance(t_s);
        if held_s <= 0.0 {
            return;
        }
        let t_s = self.now_s;
        let index = libm::floor(t_s * SLOTS as f64 / self.length_s);
        let full = self.len == self.slots.len();
        match self.newest() {
            Some(slot) if slot.index == index || full => {
                slot.end_s = t_s;
                slot.samples = slot.samples.saturating_add(1);
                slot.moments.merge(moments);
            }
            _ => {
                let at = self.ring_index(self.len);
                self.slots[at] = Slot {
                    index,
                    start_s: t_s - held_s,
                    end_s: t_s,
                    samples: 1,
                    moments: *moments,
                    and_later: Moments::EMPTY,
                };
                self.len += 1;
            }
        }
        self.samples = self.samples.saturating_add(1);
        self.back.merge(moments);
        self.keep_a_front();
    }

    /// Advances the time to `t_s`: samples older than the window leave it.
    pub(crate) fn advance(&mut self, t_s: f64) {
        self.now_s = self.now_s.max(t_s);
        self.forget_before(self.now_s - self.length_s);
    }

    /// Discards the slots that ended before `t_s`.
    pub(crate) fn forget_before(&mut self, t_s: f64) {
        while self.len > 0 && self.slots[self.oldest].end_s - t_s <= TIME_RESOLUTION_S {
            let left = self.slots[self.oldest].samples;
            self.samples = self.samples.saturating_sub(left);
            self.oldest = self.ring_index(1);
            self.len -= 1;
            if self.front > 0 {
                self.front -= 1;
            } else {
                self.back = Moments::EMPTY;
            }
            self.keep_a_front();
        }
    }

    /// The statistics of the samples in the window; the weight is the time that they cover, in seconds.
    pub(crate) fn total(&self) -> Moments {
        if self.front == 0 {
            return self.back.scaled(self.inside_of_oldest());
        }
        let mut total = self.slots[self.oldest]
            .moments
            .scaled(self.inside_of_oldest());
        if self.front > 1 {
            total.merge(&self.slots[self.ring_index(1)].and_later);
        }
        total.merge(&self.back);
        total
    }

    /// The number of samples in the window.
    pub(crate) fn samples(&self) -> u32 {
        self.samples
    }

    /// The share of the oldest slot that is inside the window.
    fn inside_of_oldest(&self) -> f64 {
        if self.len == 0 {
            return 1.0;
        }
        let slot = &self.slots[self.oldest];
        let inside_s = slot.end_s - (self.now_s - self.length_s);
        (inside_s / (slot.end_s - slot.start_s)).min(1.0)
    }

    /// Moves all slots except the newest, which still takes samples, into the front if the front is empty.
    fn keep_a_front(&mut self) {
        if self.front > 0 || self.len < 2 {
            return;
        }
        self.front = self.len - 1;
        let mut and_later = Moments::EMPTY;
        for i in (0..self.front).rev() {
            let at = self.ring_index(i);
            and_later.merge(&self.slots[at].moments);
            self.slots[at].and_later = and_later;
        }
        self.back = self.slots[self.ring_index(self.front)].moments;
    }

    fn newest(&mut self) -> Option<&mut Slot> {
        let at = self.ring_index(self.len.checked_sub(1)?);
        self.slots.get_mut(at)
    }

    /// The index in the ring of the i-th oldest slot.
    fn ring_index(&self, i: usize) -> usize {
        (self.oldest + i) % self.slots.len()
    }
}

state! { struct Slot { index, start_s, end_s, samples, moments, and_later } }

/// Only the slots in use are saved; the oldest becomes the first of the ring.
#[cfg(feature = "std")]
impl crate::state::State for Window {
    fn save(&self, to: &mut alloc::vec::Vec<u8>) {
        let slots = (0..self.len).map(|i| self.slots[self.ring_index(i)]);
        slots.collect::<alloc::vec::Vec<Slot>>().save(to);
        let counts = (self.samples, self.front);
        ((self.length_s, self.now_s), (counts, self.back)).save(to);
    }

    fn load(from: &mut crate::state::Reader<'_>) -> Option<Window> {
        let used = alloc::vec::Vec::<Slot>::load(from)?;
        let ((length_s, now_s), ((samples, front), back)) = State::load(from)?;
        let mut window = Window {
            length_s,
            now_s,
            len: used.len(),
            samples,
            front,
            back,
            ..Window::IDLE
        };
        window.slots.get_mut(..used.len())?.copy_from_slice(&used);
        (front <= used.len()).then_some(window)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec::Vec;
    use proptest::prelude::*;

    /// The definition, computed directly: the integral over `(t - length, t]` of a signal held between samples.
    fn integral(samples: &[(f64, f64)], length_s: f64) -> Option<(f64, f64)> {
        let now = samples.last()?.0;
        let held = samples.windows(2).map(|pair| {
            let (start, end) = (pair[0].0.max(now - length_s), pair[1].0);
            ((end - start).max(0.0), pair[1].1)
        });
        let weight: f64 = held.clone().map(|(w, _)| w).sum();
        let mean = held.clone().map(|(w, x)| w * x).sum::<f64>() / weight;
        let variance = held.map(|(w, x)| w * (x - mean).powi(2)).sum::<f64>() / weight;
        (weight > 0.0).then(|| (mean, variance.sqrt()))
    }

    fn run(window: &mut Window, samples: &[(f64, f64)]) {
        for pair in samples.windows(2) {
            let held = pair[1].0 - pair[0].0;
            window.push(pair[1].0, held, &Moments::of(pair[1].1, held));
        }
    }

    #[test]
    fn an_even_rate_gives_the_plain_statistics_of_the_last_samples() {
        let samples: Vec<_> = (0..=500)
            .map(|i| (f64::from(i) * 0.04, (f64::from(i) * 0.7).sin()))
            .collect();
        let mut window = Window::new(2.0);
        run(&mut window, &samples);
        let last: Vec<f64> = samples[451..].iter().map(|s| s.1).collect();
        let mean = last.iter().sum::<f64>() / 50.0;
        let std = (last.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / 50.0).sqrt();
        let total = window.total();
        assert_eq!(window.samples(), 50);
        approx::assert_abs_diff_eq!(total.mean().unwrap(), mean, epsilon = 1e-12);
        approx::assert_abs_diff_eq!(total.std().unwrap(), std, epsilon = 1e-12);
        approx::assert_abs_diff_eq!(total.weight(), 2.0, epsilon = 1e-9);
        assert_eq!(total.min(), last.iter().copied().reduce(f64::min));
        assert_eq!(total.max(), last.iter().copied().reduce(f64::max));
    }

    #[test]
    fn a_day_of_samples_does_not_drift() {
        let mut window = Window::new(2.0);
        let dt = 0.02;
        let samples = 24 * 3600 * 50;
        // A large disturbance in the middle of the day must leave no trace.
        for i in 1..=samples {
            let x = if i == samples / 2 { 1e9 } else { 0.3 };
            window.push(i as f64 * dt, dt, &Moments::of(x, dt));
        }
        let total = window.total();
        assert_eq!(total.mean(), Some(0.3));
        assert_eq!(total.std(), Some(0.0));
    }

    #[test]
    fn statistics_of_a_window_do_not_depend_on_the_rate() {
        let signal = |t: f64| 0.3 + 0.1 * (t * 0.9).sin();
        let mut totals = Vec::new();
        for rate in [10, 25, 400, 4000] {
            let samples: Vec<_> = (0..=20 * rate)
                .map(|i| f64::from(i) / f64::from(rate))
                .map(|t| (t, signal(t)))
                .collect();
            let mut window = Window::new(5.0);
            run(&mut window, &samples);
            totals.push(window.total());
        }
        for total in &totals {
            approx::assert_abs_diff_eq!(
                total.mean().unwrap(),
                totals[3].mean().unwrap(),
                epsilon = 0.005
            );
            approx::assert_abs_diff_eq!(
                total.std().unwrap(),
                totals[3].std().unwrap(),
                epsilon = 0.005
            );
        }
    }

    #[test]
    fn a_silence_empties_a_window() {
        let mut window = Window::new(1.0);
        for i in 1..=50 {
            window.push(f64::from(i) * 0.04, 0.04, &Moments::of(0.3, 0.04));
        }
        assert_eq!(window.samples(), 25);
        approx::assert_abs_diff_eq!(window.total().weight(), 1.0, epsilon = 1e-9);
        window.advance(3.0);
        assert_eq!((window.samples(), window.total().mean()), (0, None));
    }

    #[test]
    fn an_empty_window_is_unknown() {
        let total = Window::new(1.0).total();
        assert_eq!(
            (
                total.mean(),
                total.std(),
                total.rms(),
                total.min(),
                total.max()
            ),
            (None, None, None, None, None)
        );
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        #[test]
        fn uneven_samples_give_the_integral(
            steps in prop::collection::vec((0.03..0.5f64, -1.0..1.0f64), 2..200),
        ) {
            let mut t = 100.0;
            let samples: Vec<_> = steps.iter().map(|(dt, x)| { t += dt; (t, *x) }).collect();
            let mut window = Window::new(3.0);
            for n in 2..=samples.len() {
                run(&mut window, &samples[n - 2..n]);
                let (mean, std) = integral(&samples[..n], 3.0).unwrap();
                let total = window.total();
                prop_assert!((total.mean().unwrap() - mean).abs() < 1e-6);
                prop_assert!((total.std().unwrap() - std).abs() < 1e-6);
            }
        }
    }
}
