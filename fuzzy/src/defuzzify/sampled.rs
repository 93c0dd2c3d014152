//! Sampled defuzzification, which reproduces the results of other programs, including their errors.

use crate::model::{Sampling, SamplingRule};
use crate::table::{OfMaxima, SetDefuzzifier};

impl Sampling {
    /// Returns the value of a set that is given by its degree at `x`; `None` if every sample is 0.
    pub(crate) fn value(
        self,
        defuzzifier: SetDefuzzifier,
        (low, high): (f64, f64),
        degree: impl Fn(f64) -> f64,
    ) -> Option<f64> {
        match defuzzifier {
            SetDefuzzifier::Maxima(which) => self.maxima(which, low, high, degree),
            SetDefuzzifier::Bisector => self.bisector(low, high, degree),
            SetDefuzzifier::Centroid => {
                let (mut area, mut moment) = (0.0, 0.0);
                for i in 0..self.samples {
                    let (x, weight) = self.sample(i, low, high);
                    let y = weight * degree(x);
                    area += y;
                    moment += x * y;
                }
                (area > 0.0).then(|| moment / area)
            }
        }
    }

    /// Returns the value and weight of a sample.
    fn sample(self, i: usize, low: f64, high: f64) -> (f64, f64) {
        match self.rule {
            SamplingRule::Midpoint => {
                let step = (high - low) / self.samples as f64;
                (low + (i as f64 + 0.5) * step, 1.0)
            }
            SamplingRule::Trapezoid => {
                let last = self.samples.saturating_sub(1);
                let x = low + i as f64 * ((high - low) / last as f64);
                (x, if i == 0 || i == last { 0.5 } else { 1.0 })
            }
        }
    }

    /// Returns the first sample at which the cumulative sum reaches half of the total.
    fn bisector(self, low: f64, high: f64, degree: impl Fn(f64) -> f64) -> Option<f64> {
        let terms = || {
            (0..self.samples).map(|i| {
                let (x, weight) = self.sample(i, low, high);
                (x, weight * degree(x))
            })
        };
        let half = 0.5 * terms().map(|(_, y)| y).sum::<f64>();
        let mut sum = 0.0;
        let mut reached = terms().skip_while(|(_, y)| {
            sum += y;
            sum < half
        });
        let first = reached.next().map(|(x, _)| x);
        first.filter(|_| half > 0.0)
    }

    fn maxima(
        self,
        which: OfMaxima,
        low: f64,
        high: f64,
        degree: impl Fn(f64) -> f64,
    ) -> Option<f64> {
        let (mut highest, mut smallest, mut largest) = (0.0, low, low);
        let (mut sum, mut count) = (0.0, 0.0);
        for i in 0..self.samples {
            let (x, _) = self.sample(i, low, high);
            let y = degree(x);
            if y > highest {
                (highest, smallest, sum, count) = (y, x, 0.0, 0.0);
            }
            if y == highest && y > 0.0 {
                largest = x;
                sum += x;
                count += 1.0;
            }
        }
        (count > 0.0).then_some(match which {
            OfMaxima::Smallest => smallest,
            OfMaxima::Largest => largest,
            OfMaxima::Mean => sum / count,
        })
    }
}
