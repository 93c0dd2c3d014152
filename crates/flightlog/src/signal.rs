//! Signals: named values over time, each group on its own time base.

/// The name, unit and source of a signal.
#[derive(Debug, Clone, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Label {
    /// The name, which includes the unit, such as `roll_deg`.
    pub name: String,
    /// The unit, such as `deg`; empty if the value has none or it is unknown.
    pub unit: String,
    /// The source, such as `ATT.Roll`.
    pub source: String,
}

/// Signals that share a time base, like the fields of one log message.
///
/// Unknown values are stored as NaN; [`Signal::at`] and [`Hold::at`] return `None` for them.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Series {
    t_s: Vec<f64>,
    labels: Vec<Label>,
    columns: Vec<Vec<f64>>,
}

impl Series {
    pub(crate) fn new(labels: Vec<Label>) -> Self {
        let columns = labels.iter().map(|_| Vec::new()).collect();
        Self {
            t_s: Vec::new(),
            labels,
            columns,
        }
    }

    /// Shifts the times of all rows.
    pub(crate) fn shift(&mut self, by_s: f64) {
        self.t_s.iter_mut().for_each(|t_s| *t_s += by_s);
    }

    /// Adds one row; `values` are in the order of the labels. Returns `true` if a row was dropped, either this one or
    /// the previous one: see [`Order`].
    pub(crate) fn push(&mut self, t_s: f64, values: impl IntoIterator<Item = f64>) -> bool {
        let order = Order::of(&self.t_s, t_s);
        match order {
            Order::Last => {}
            Order::Replaces => {
                self.t_s.pop();
                for column in &mut self.columns {
                    column.pop();
                }
            }
            Order::Back => return true,
        }
        self.t_s.push(t_s);
        let mut values = values.into_iter();
        for column in &mut self.columns {
            column.push(values.next().unwrap_or(f64::NAN));
        }
        order != Order::Last
    }

    /// The times of the rows, in seconds on the log's clock, never decreasing.
    pub fn t_s(&self) -> &[f64] {
        &self.t_s
    }

    /// The signals of this series.
    pub fn signals(&self) -> impl Iterator<Item = Signal<'_>> {
        self.labels
            .iter()
            .zip(&self.columns)
            .map(|(label, values)| Signal {
                label,
                t_s: &self.t_s,
                values,
            })
    }

    /// Whether the series has no signals.
    pub(crate) fn is_empty(&self) -> bool {
        self.labels.is_empty()
    }

    /// Keeps the signals whose names satisfy `keep`.
    pub(crate) fn retain(&mut self, mut keep: impl FnMut(&str) -> bool) {
        let labels = std::mem::take(&mut self.labels);
        let columns = std::mem::take(&mut self.columns);
        let kept = labels.into_iter().zip(columns);
        (self.labels, self.columns) = kept.filter(|(label, _)| keep(&label.name)).unzip();
    }
}

/// Orders series by preference. Of signals with the same name only the first is kept, and series without rows or
/// signals are removed.
pub(crate) fn preferred(mut series: Vec<Series>) -> Vec<Series> {
    let mut names = std::collections::BTreeSet::new();
    series.retain(|series| !series.t_s.is_empty());
    for series in &mut series {
        series.retain(|name| names.insert(name.to_owned()));
    }
    series.retain(|series| !series.is_empty());
    series
}

/// One signal with its times and values.
#[derive(Debug, Clone, Copy)]
pub struct Signal<'a> {
    /// The name, unit and source.
    pub label: &'a Label,
    /// The times in seconds on the log's clock, never decreasing.
    pub t_s: &'a [f64],
    /// One value for each time; NaN is unknown.
    pub values: &'a [f64],
}

impl<'a> Signal<'a> {
    /// The latest value at or before `t_s` (zero-order hold); `None` before the first sample and if the value is
    /// unknown.
    pub fn at(&self, t_s: f64) -> Option<f64> {
        let after = self.t_s.partition_point(|&t| t <= t_s);
        let value = *self.values.get(after.checked_sub(1)?)?;
        value.is_finite().then_some(value)
    }

    /// Returns a cursor that reads the signal at ascending times.
    pub fn hold(&self) -> Hold<'a> {
        Hold {
            t_s: self.t_s,
            values: self.values,
            after: 0,
        }
    }

    /// The number of known values.
    pub fn known(&self) -> usize {
        self.values.iter().filter(|value| value.is_finite()).count()
    }

    /// The rate of the known values in Hz, ignoring pauses; `None` if fewer than two values are known.
    pub fn rate_hz(&self) -> Option<f64> {
        let known = self.t_s.iter().zip(self.values);
        let known = known.filter(|(_, value)| value.is_finite());
        rate_hz(&known.map(|(t_s, _)| *t_s).collect::<Vec<f64>>())
    }

    /// Whether unknown values occur repeatedly between known values, as in a table whose rows are more frequent than
    /// the values of the signal.
    pub fn is_sparse(&self) -> bool {
        let is_known = self.values.iter().map(|value| value.is_finite());
        let known = is_known.clone().skip_while(|known| !known);
        let again = known
            .clone()
            .skip(1)
            .zip(known)
            .filter(|(now, before)| *now && !before);
        again.count() > 1
    }
}

/// A zero-order hold of a signal at ascending times, which reads the signal in a single pass.
///
/// # Example: the roll angle at each motor sample
///
/// ```
/// let log = "t_s,motor1,roll_deg\n0.0,0.4,1.5\n0.1,0.5,2.5\n";
/// let flight = flagred_flightlog::read(log.as_bytes(), &flagred_flightlog::Options::default())?;
/// let mut roll = flight.signal("roll_deg").map(|signal| signal.hold());
/// let held: Vec<_> = flight
///     .commands
///     .rows()
///     .map(|(t_s, _)| roll.as_mut().and_then(|hold| hold.at(t_s)))
///     .collect();
/// assert_eq!(held, [Some(1.5), Some(2.5)]);
/// # Ok::<(), flagred_flightlog::ReadError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Hold<'a> {
    t_s: &'a [f64],
    values: &'a [f64],
    after: usize,
}

impl Hold<'_> {
    /// The latest value at or before `t_s`, which must not be before the `t_s` of the previous call.
    pub fn at(&mut self, t_s: f64) -> Option<f64> {
        while self.t_s.get(self.after).is_some_and(|&t| t <= t_s) {
            self.after += 1;
        }
        let value = *self.values.get(self.after.checked_sub(1)?)?;
        value.is_finite().then_some(value)
    }
}

/// The order of a row relative to the rows before it. The times of kept rows never go back: if the time of a row goes
/// back, either this row or the previous one is damaged.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Order {
    /// The row is later than all rows.
    Last,
    /// The row is later than all rows except the last one, which was too far ahead and is dropped.
    Replaces,
    /// The time of the row is before that of the last two rows, so the row itself is dropped.
    Back,
}

impl Order {
    pub(crate) fn of(before_s: &[f64], t_s: f64) -> Self {
        match before_s {
            [.., before, last] if t_s < *last && t_s < *before => Self::Back,
            [.., last] if t_s < *last => Self::Replaces,
            _ => Self::Last,
        }
    }
}

/// A clock that goes back by more than this, in seconds, and stays behind for at least two rows, was set back or
/// restarted.
pub(crate) const SET_BACK_S: f64 = 0.2;
/// The maximum number of entries in [`BackstepDetector::at_s`].
const MAX_SET_BACK: usize = 1000;

/// Detects when a clock is set back. The kept rows alone do not show it, because dropping rows leaves no gap in
/// their times.
#[derive(Debug, Default)]
pub(crate) struct BackstepDetector {
    /// The time of the previous row, if it was dropped.
    dropped_s: Option<f64>,
    at_s: Vec<f64>,
}

impl BackstepDetector {
    /// Processes the order and the time of a row, with the time of the last kept row before it.
    pub(crate) fn see(&mut self, order: Order, t_s: f64, last_s: Option<&f64>) {
        if order != Order::Back {
            self.dropped_s = None;
            return;
        }
        let before_s = self.dropped_s.replace(t_s).filter(|s| *s <= t_s);
        let last_s = last_s.filter(|last_s| **last_s - t_s > SET_BACK_S);
        if let (Some(_), Some(last_s)) = (before_s, last_s)
            && self.at_s.last() != Some(last_s)
            && self.at_s.len() < MAX_SET_BACK
        {
            self.at_s.push(*last_s);
        }
    }

    /// The last time before each backward step of the clock.
    pub(crate) fn at_s(&self) -> &[f64] {
        &self.at_s
    }

    /// Shifts all times.
    pub(crate) fn shift(&mut self, by_s: f64) {
        self.at_s.iter_mut().for_each(|t_s| *t_s += by_s);
    }
}

/// The sample rate in Hz: the inverse of the mean time step, ignoring pauses. A step is a pause if it is over 2 s and
/// over ten times the median step. `None` without any step.
pub(crate) fn rate_hz(t_s: &[f64]) -> Option<f64> {
    let steps = || {
        t_s.windows(2).filter_map(|pair| match pair {
            [a, b] => Some(b - a),
            _ => None,
        })
    };
    let mut sorted: Vec<f64> = steps().collect();
    let middle = sorted.len() / 2;
    if sorted.is_empty() {
        return None;
    }
    let (_, median, _) = sorted.select_nth_unstable_by(middle, f64::total_cmp);
    let longest = (10.0 * *median).max(2.0);
    let within = || steps().filter(|step| *step <= longest);
    let sum_s: f64 = within().sum();
    (sum_s > 0.0).then(|| within().count() as f64 / sum_s)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn series() -> Series {
        let mut series = Series::new(vec![Label {
            name: "x".into(),
            unit: String::new(),
            source: "test".into(),
        }]);
        for (t, x) in [(1.0, 10.0), (2.0, 20.0), (2.0, 21.0), (4.0, f64::NAN)] {
            series.push(t, [x]);
        }
        series
    }

    #[test]
    fn a_signal_keeps_the_latest_value() {
        let series = series();
        let signal = series.signals().next().unwrap();
        let mut hold = signal.hold();
        for (t, expected) in [
            (0.5, None),
            (1.0, Some(10.0)),
            (1.9, Some(10.0)),
            (2.0, Some(21.0)),
            (3.9, Some(21.0)),
            (4.0, None),
            (9.0, None),
        ] {
            assert_eq!(signal.at(t), expected, "at {t}");
            assert_eq!(hold.at(t), expected, "hold at {t}");
        }
    }

    #[test]
    fn unknown_values_do_not_count_in_the_rate() {
        let label = Label {
            name: "x".into(),
            unit: String::new(),
            source: "test".into(),
        };
        let t_s: Vec<f64> = (0..50).map(|i| f64::from(i) * 0.1).collect();
        for (is_known, known, rate_hz, is_sparse) in [
            ((|_| true) as fn(usize) -> bool, 50, 10.0, false),
            (|i| i % 10 == 0, 5, 1.0, true),
            (|i| i < 10, 10, 10.0, false),
            (|i| !(20..22).contains(&i), 48, 470.0 / 49.0, false),
        ] {
            let value = |i| if is_known(i) { 1.0 } else { f64::NAN };
            let values: Vec<f64> = (0..50).map(value).collect();
            let signal = Signal {
                label: &label,
                t_s: &t_s,
                values: &values,
            };
            assert_eq!((signal.known(), signal.is_sparse()), (known, is_sparse));
            approx::assert_abs_diff_eq!(signal.rate_hz().unwrap(), rate_hz, epsilon = 1e-9);
        }
    }

    #[test]
    fn pauses_do_not_count_in_the_rate_but_bursts_do() {
        let close = |t_s: &[f64], expected: f64| {
            let rate = rate_hz(t_s).unwrap();
            assert!((rate - expected).abs() < 1e-9, "{rate} for {expected}");
        };
        close(&[0.0, 0.1, 0.2, 500.0], 10.0);
        close(&[0.0, 0.01, 0.02, 1.0, 1.01, 1.02, 2.0], 3.0);
        close(&[0.0, 10.0, 20.0], 0.1);
        assert_eq!(rate_hz(&[1.0]), None);
        assert_eq!(rate_hz(&[1.0, 1.0]), None);
    }
}
