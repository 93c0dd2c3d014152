//! The balance of the motors: trims, weak motors, imbalances.

use flagred::verdict::Measure;

use super::yaw::less_yaw;

/// A finding of the balance: its measure, its time and its motor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BalanceFinding {
    /// The measure that exceeded its limit.
    pub measure: Measure,
    /// The time at which the finding was raised.
    pub raised_s: f64,
    /// The named motor, and another motor that may be the cause.
    pub motor: (usize, Option<usize>),
}

/// A moving average of one value of each motor.
#[derive(Clone, Default)]
struct Averages {
    values: Vec<f64>,
    known_s: f64,
}

impl Averages {
    fn add(&mut self, x: &[f64], held_s: f64, constant_s: f64) {
        self.values.resize(x.len(), 0.0);
        if held_s > 0.0 {
            self.known_s += held_s;
            let weight = held_s / held_s.max(constant_s.min(self.known_s));
            for (value, x) in self.values.iter_mut().zip(x) {
                *value += weight * (x - *value);
            }
        }
    }
}

/// The state of the balance during one period in the air.
#[derive(Clone, Default)]
pub struct Balance {
    lately: Averages,
    /// The trims, which are kept across a gap.
    pub trims: Trims,
    load: Averages,
    at_zero_s: Vec<f64>,
    /// Whether all motors slow down together.
    pub sinks: bool,
    /// Whether the motors work as before an alarm.
    pub has_recovered: bool,
    passed_s: [Option<f64>; 2],
    found: [Option<BalanceFinding>; 2],
}

/// The trims of the motors.
#[derive(Clone, Default)]
pub struct Trims(Averages);

impl Balance {
    /// Creates the balance of a period in the air, starting with the trims from before a gap.
    pub fn new(trims: Trims) -> Balance {
        Balance {
            trims,
            ..Balance::default()
        }
    }

    /// Adds the commands of a settled sample; they are ignored if one command is unknown.
    pub fn push(
        &mut self,
        (t_s, held_s): (f64, f64),
        commands: &[f64],
        factors: &[[f64; 3]],
        (limit, after_s): (f64, f64),
        is_calm: bool,
    ) {
        let count = commands.len() as f64;
        let mean = commands.iter().sum::<f64>() / count;
        let is_low = self.load.known_s >= 3.0 && mean < self.load.values[0] / 2.0;
        self.sinks = is_low && self.is_together(commands);
        if mean.is_nan() {
            self.passed_s = [None; 2];
            return;
        }
        let x: Vec<f64> = commands.iter().map(|e| e - mean).collect();
        self.load.add(&[mean], held_s, 3.0);
        self.lately.add(&x, held_s, 5.0);
        self.at_zero_s.resize(x.len(), 0.0);
        for (at_zero_s, e) in self.at_zero_s.iter_mut().zip(commands) {
            *at_zero_s = if *e == 0.0 { *at_zero_s + held_s } else { 0.0 };
        }
        let settled = self.lately.known_s >= 5.0;
        let learned = self.trims.0.known_s >= 10.0;
        let near = |shift: &[f64]| shift.iter().all(|s| s.abs() < limit / 2.0);
        if is_calm && (!learned || settled && near(&self.shift())) {
            self.trims.0.add(&x, held_s, 30.0);
        }
        let shift = self.shift();
        let alike = self.lately.values.iter().all(|x| x.abs() < limit);
        self.has_recovered = settled && if learned { near(&shift) } else { alike };
        let compares = self.trims.0.known_s >= 10.0 && settled && learned;
        let weak = weak(&shift, limit / 2.0).filter(|_| compares);
        let plain = less_yaw(&shift, factors);
        let farthest = plain.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        let imbalance = if weak.is_some() || self.found[1].is_some() {
            None
        } else if compares && farthest > limit {
            Some((Measure::Imbalance, self.culprit(&shift)))
        } else if settled && self.largest_pair_difference(factors) > 2.0 * limit {
            Some((Measure::PairImbalance, self.culprit(&self.lately.values)))
        } else {
            None
        };
        let weak = weak.map(|(motor, other)| (Measure::WeakMotor, (motor, other)));
        for (i, passed) in [imbalance, weak].into_iter().enumerate() {
            let Some((measure, motor)) = passed else {
                self.passed_s[i] = None;
                continue;
            };
            let since_s = *self.passed_s[i].get_or_insert(t_s);
            if t_s - since_s >= after_s - 1e-6 {
                self.found[i].get_or_insert(BalanceFinding {
                    measure,
                    raised_s: t_s,
                    motor,
                });
            }
        }
    }

    /// The finding at the end of the flight: the weak motor if there is one, because it explains an imbalance.
    pub fn found(&self) -> Option<BalanceFinding> {
        self.found[1].or(self.found[0])
    }

    /// Whether a finding is open.
    pub fn is_open(&self) -> bool {
        self.found().is_some()
    }

    /// Whether the commands of the motors are about as close together as they were recently, or too little is known to
    /// compare them.
    pub fn is_together(&self, commands: &[f64]) -> bool {
        let count = commands.len() as f64;
        let mean = commands.iter().sum::<f64>() / count;
        let spread =
            |x: &mut dyn Iterator<Item = f64>| (x.map(|x| x * x).sum::<f64>() / count).sqrt();
        let lately = spread(&mut self.lately.values.iter().copied());
        let now = spread(&mut commands.iter().map(|e| e - mean));
        let is_apart = now >= lately + 0.05;
        self.lately.known_s < 5.0 || !is_apart
    }

    fn shift(&self) -> Vec<f64> {
        let trim = |motor: usize| self.trims.0.values.get(motor).copied().unwrap_or(0.0);
        let lately = self.lately.values.iter().enumerate();
        lately.map(|(motor, x)| x - trim(motor)).collect()
    }

    /// The largest amount by which a motor exceeds the opposite one.
    fn largest_pair_difference(&self, factors: &[[f64; 3]]) -> f64 {
        let x = less_yaw(&self.lately.values, factors);
        let above =
            (0..factors.len()).filter_map(|motor| Some(x[motor] - x[opposite(factors, motor)?]));
        above.fold(0.0, f64::max)
    }

    fn culprit(&self, x: &[f64]) -> (usize, Option<usize>) {
        let order = |x: &[f64]| {
            let mut order: Vec<usize> = (0..x.len()).collect();
            order.sort_by(|a, b| x[*b].total_cmp(&x[*a]));
            (order[0], order.get(1).copied())
        };
        let (first, second) = order(x);
        let ahead = second.map_or(f64::INFINITY, |second| x[first] - x[second]);
        let (stopped, next) = order(&self.at_zero_s);
        if ahead < x[first] / 3.0 && self.at_zero_s[stopped] > 0.0 {
            let next = next.filter(|next| self.at_zero_s[*next] == self.at_zero_s[stopped]);
            return (stopped, next);
        }
        (first, second.filter(|_| ahead < 0.02))
    }
}

/// The motor that explains the change, and another that explains it nearly as well.
fn weak(shift: &[f64], limit: f64) -> Option<(usize, Option<usize>)> {
    let count = shift.len() as f64;
    let mut order: Vec<usize> = (0..shift.len()).collect();
    order.sort_by(|a, b| shift[*b].total_cmp(&shift[*a]));
    let motor = *order.first()?;
    let all: f64 = shift.iter().map(|s| s * s).sum();
    let explains = shift[motor] * shift[motor] >= 0.75 * all * (count - 1.0).min(3.0) / count;
    let next = order.get(1).copied();
    let other = next.filter(|next| shift[*next] > shift[motor] * 2.0 / 3.0);
    (shift[motor] > limit && explains).then_some((motor, other))
}

/// The motor opposite to this one; if there are two, the one that turns in the same direction as this motor.
fn opposite(factors: &[[f64; 3]], motor: usize) -> Option<usize> {
    let [roll, pitch, yaw] = factors[motor];
    if roll.abs() < 0.1 && pitch.abs() < 0.1 {
        return None;
    }
    let faces = |of: &[f64; 3]| (of[0] + roll).abs() < 0.1 && (of[1] + pitch).abs() < 0.1;
    let facing = (0..factors.len()).filter(|other| faces(&factors[*other]));
    facing.min_by(|a, b| {
        let turns = |motor: usize| (factors[motor][2] - yaw).abs();
        turns(*a).total_cmp(&turns(*b))
    })
}
