//! Statistics of the means of a window's slots: at most 130 values for any length of the window.

use super::{SLOTS, Window};
use crate::moments::Moments;

/// The mean of the samples of a slot.
#[derive(Debug, Clone, Copy)]
struct Mean {
    /// The middle of the samples' time, in seconds relative to now.
    t_s: f64,
    /// The part of the samples' time that is inside the window, in seconds.
    weight: f64,
    value: f64,
}

impl Window {
    /// For each slot: the middle of the time of its samples, in seconds relative to now, and the moments of the
    /// samples. Of the oldest slot, only the part inside the window counts.
    pub(crate) fn parts(&self) -> impl Iterator<Item = (f64, Moments)> + Clone {
        let inside = self.inside_of_oldest();
        (0..self.len).map(move |i| {
            let slot = &self.slots[self.ring_index(i)];
            let share = if i == 0 { inside } else { 1.0 };
            let t_s = (slot.start_s + slot.end_s) / 2.0 - self.now_s;
            (t_s, slot.moments.scaled(share))
        })
    }

    fn means(&self) -> impl Iterator<Item = Mean> + Clone {
        self.parts().filter_map(|(t_s, part)| {
            Some(Mean {
                t_s,
                weight: part.weight(),
                value: part.mean()?,
            })
        })
    }

    /// The slope of the least-squares line through the means of the slots, per second; `None` with fewer than two.
    pub(crate) fn rate(&self) -> Option<f64> {
        let (mut weight, mut t_s, mut value) = (0.0, 0.0, 0.0);
        for mean in self.means() {
            weight += mean.weight;
            t_s += mean.weight * mean.t_s;
            value += mean.weight * mean.value;
        }
        let (t_s, value) = (t_s / weight, value / weight);
        let (mut along, mut squares) = (0.0, 0.0);
        for mean in self.means() {
            let later_s = mean.t_s - t_s;
            along += mean.weight * later_s * (mean.value - value);
            squares += mean.weight * later_s * later_s;
        }
        (squares > 0.0).then(|| along / squares)
    }
}

impl Window {
    /// The value below which the slots' means have `percent` % of their total weight. Each of the sorted means is the
    /// percentile for the weight of the lower means plus half its own weight. Between two means the percentile is
    /// interpolated linearly; beyond the lowest and the highest mean it is constant. `None` in an empty window.
    pub(crate) fn percentile(&self, percent: f64) -> Option<f64> {
        let mut sorted = [(0.0, 0.0); SLOTS + 2];
        let mut count = 0;
        let mut weight = 0.0;
        for (place, mean) in sorted.iter_mut().zip(self.means()) {
            *place = (mean.value, mean.weight);
            weight += mean.weight;
            count += 1;
        }
        let sorted = sorted.get_mut(..count)?;
        sorted.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
        let wanted = weight * percent / 100.0;
        let mut below = 0.0;
        let mut before: Option<(f64, f64)> = None;
        for &(value, weight) in sorted.iter() {
            let middle = below + weight / 2.0;
            match before {
                _ if middle < wanted => {}
                Some((lower, at)) if middle > at => {
                    return Some(lower + (value - lower) * ((wanted - at) / (middle - at)));
                }
                _ => return Some(value),
            }
            below += weight;
            before = Some((value, middle));
        }
        before.map(|(value, _)| value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn window(length_s: f64, rate_hz: f64, until_s: f64, value: impl Fn(f64) -> f64) -> Window {
        let mut window = Window::new(length_s);
        for i in 1..=(until_s * rate_hz) as u32 {
            let (t_s, held_s) = (f64::from(i) / rate_hz, 1.0 / rate_hz);
            window.push(t_s, held_s, &Moments::of(value(t_s), held_s));
        }
        window
    }

    #[test]
    fn a_ramp_has_its_slope_at_any_rate() {
        for (length_s, rate_hz) in [(2.0, 10.0), (2.0, 64.0), (2.0, 400.0), (30.0, 50.0)] {
            let found = window(length_s, rate_hz, 60.0, |t_s| 7.0 - 0.25 * t_s).rate();
            approx::assert_abs_diff_eq!(found.unwrap(), -0.25, epsilon = 1e-9);
        }
    }

    #[test]
    fn a_constant_has_no_slope_and_a_single_value_an_unknown_one() {
        assert_eq!(window(2.0, 50.0, 60.0, |_| 0.3).rate(), Some(0.0));
        assert_eq!(window(2.0, 50.0, 0.02, |_| 0.3).rate(), None);
        assert_eq!(Window::new(2.0).rate(), None);
    }

    fn of(values: &[f64], percent: f64) -> Option<f64> {
        let mut window = Window::new(values.len() as f64);
        for (i, value) in (1..).zip(values) {
            window.push(f64::from(i), 1.0, &Moments::of(*value, 1.0));
        }
        window.percentile(percent)
    }

    #[test]
    fn percentiles_of_equal_weights_are_the_plain_ones() {
        for (values, percent, expected) in [
            (&[3.0][..], 50.0, 3.0),
            (&[5.0, 1.0, 3.0], 50.0, 3.0),
            (&[5.0, 1.0, 3.0, 11.0], 50.0, 4.0),
            (&[5.0, 1.0, 3.0, 11.0], 0.0, 1.0),
            (&[5.0, 1.0, 3.0, 11.0], 12.5, 1.0),
            (&[5.0, 1.0, 3.0, 11.0], 25.0, 2.0),
            (&[5.0, 1.0, 3.0, 11.0], 75.0, 8.0),
            (&[5.0, 1.0, 3.0, 11.0], 100.0, 11.0),
            (&[2.0, 2.0, 2.0, 2.0], 60.0, 2.0),
            // One spike moves the median little, and the mean much.
            (&[1.0, 1.0, 100.0, 1.0, 1.0], 50.0, 1.0),
        ] {
            let found = of(values, percent).unwrap();
            approx::assert_abs_diff_eq!(found, expected, epsilon = 1e-12);
        }
        assert_eq!(of(&[], 50.0), None);
    }

    #[test]
    fn a_clock_that_counts_from_1970_loses_no_precision() {
        let mut window = Window::new(2.0);
        for i in 1..=100 {
            let t_s = 1_760_000_000.0 + f64::from(i) * 0.04;
            window.push(t_s, 0.04, &Moments::of(f64::from(i), 0.04));
        }
        approx::assert_abs_diff_eq!(window.rate().unwrap(), 25.0, epsilon = 1e-4);
    }
}
