//! A flight, sample by sample, in memory that the caller lends: what every monitor does.

use crate::{
    accumulator::{AccumulatorSettings, RunningSum},
    channel::{Channel, Input, Seen, push, value},
    sample::{Estimate, Sample, Sampling, Unknown, Update},
    verdict::{Alert, Ended, Finding, Motor, Step, VerdictSettings},
    window::Window,
};

/// What a profile says about time: when inputs count as known, how risks add up, when levels change.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// When an input counts as known.
    pub sampling: Sampling,
    /// How risks add up to the elevated risk.
    pub elevated_risk: AccumulatorSettings,
    /// When levels are raised and lowered.
    pub verdict: VerdictSettings,
}

/// What is known of a flight beside its windows.
#[derive(Debug, Clone)]
pub(crate) struct Follower {
    settings: Settings,
    sum: RunningSum,
    alert: Alert,
    last_s: Option<f64>,
    in_air_since_s: Option<f64>,
    last_known_s: Option<f64>,
}

/// The memory of a flight: the risks of the last seconds, what each channel has seen, the values of the inputs after the
/// latest sample (NaN is unknown), and the motors.
#[derive(Debug)]
pub(crate) struct Room<'m> {
    pub(crate) risks: &'m mut Window,
    pub(crate) seen: &'m mut [Seen],
    pub(crate) inputs: &'m mut [f64],
    pub(crate) motors: &'m mut [Motor],
}

impl Follower {
    pub(crate) const fn new(settings: Settings) -> Follower {
        Follower {
            sum: RunningSum::new(settings.elevated_risk),
            alert: Alert::new(settings.verdict),
            settings,
            last_s: None,
            in_air_since_s: None,
            last_known_s: None,
        }
    }

    #[cfg(feature = "std")]
    pub(crate) fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Takes a sample in; `estimate` gives what is said about values of the inputs.
    pub(crate) fn push(
        &mut self,
        (channels, inputs): (&[Channel], &[Input]),
        room: &mut Room<'_>,
        sample: &Sample<'_>,
        estimate: impl FnOnce(&[f64]) -> Option<Estimate>,
    ) -> Update {
        let t_s = sample.t_s;
        let mut step = Step::default();
        let longest_gap_s = self.settings.sampling.longest_gap_s;
        let held_s = match self.last_s {
            _ if !t_s.is_finite() => return self.unknown(t_s, Unknown::OutOfOrder, step),
            None => 0.0,
            Some(last_s) if t_s <= last_s && last_s - t_s <= longest_gap_s => {
                return self.unknown(t_s, Unknown::OutOfOrder, step);
            }
            // A jump, forward (a lost link) or back (a vehicle that restarted): what was before is no guide.
            Some(last_s) if !(0.0..=longest_gap_s).contains(&(t_s - last_s)) => {
                step = self.forget(last_s, false, room);
                0.0
            }
            Some(last_s) => t_s - last_s,
        };
        self.last_s = Some(t_s);
        if !sample.in_air {
            if self.in_air_since_s.is_some() {
                step = self.forget(t_s, true, room);
            }
            return self.unknown(t_s, Unknown::OnGround, step);
        }
        let in_air_since_s = *self.in_air_since_s.get_or_insert(t_s);

        let known = sample.motors.iter().map(|e| match e {
            0.0..=1.0 => *e,
            _ => f64::NAN,
        });
        let commands = known.chain(core::iter::repeat(f64::NAN));
        for (motor, command) in room.motors.iter_mut().zip(commands) {
            motor.command = command;
        }
        let commands = room.motors.iter().map(|motor| motor.command);
        push(channels, room.seen, (t_s, held_s), commands, sample.signals);
        let risk = self.estimate(inputs, room, estimate);
        let Ok(said) = risk else {
            let known_s = self.last_known_s.unwrap_or(t_s);
            if t_s - known_s > longest_gap_s {
                step = self.stop_judging(known_s, false, room);
            }
            let reason = risk.err().unwrap_or(Unknown::NoRule);
            return self.unknown(t_s, reason, step);
        };
        self.last_known_s = Some(t_s);
        let elevated = self.sum.push(room.risks, (t_s, held_s), said.risk_pct);
        let is_judged = t_s - in_air_since_s >= self.settings.verdict.quiet_after_take_off_s;
        if is_judged {
            let judged = self.alert.push(t_s, said.risk_pct, elevated, room.motors);
            step = Step {
                change: judged.change.or(step.change),
                // Both at once cannot be: what was just forgotten takes a while to be raised again.
                ended: if step.ended == [None; 2] {
                    judged.ended
                } else {
                    step.ended
                },
            };
        }
        Update {
            t_s,
            risk,
            elevated_risk_pct: Some(elevated),
            level: Some(self.alert.level()),
            change: step.change,
            judged: is_judged,
            ended: step.ended,
        }
    }

    /// The finding that the level rests on, as it stands so far; `None` while the level is good.
    pub(crate) fn open_finding(&self, motors: &[Motor]) -> Option<Finding> {
        self.alert.open(motors)
    }

    /// Ends the flight: the findings that were still open.
    pub(crate) fn finish(&mut self, room: &mut Room<'_>) -> Ended {
        self.last_s
            .map_or([None; 2], |last_s| self.forget(last_s, false, room).ended)
    }

    fn estimate(
        &self,
        inputs: &[Input],
        room: &mut Room<'_>,
        estimate: impl FnOnce(&[f64]) -> Option<Estimate>,
    ) -> Result<Estimate, Unknown> {
        let mut reason = None;
        for (input, kept) in room.inputs.iter_mut().enumerate() {
            let value = reading(inputs, room.seen, &self.settings.sampling, input);
            *kept = value.unwrap_or_else(|unknown| {
                reason.get_or_insert(unknown);
                f64::NAN
            });
        }
        match reason {
            Some(reason) => Err(reason),
            None => estimate(room.inputs).ok_or(Unknown::NoRule),
        }
    }

    /// What is known after a sample without a risk.
    fn unknown(&self, t_s: f64, reason: Unknown, step: Step) -> Update {
        let judging = self.in_air_since_s.is_some() && self.last_known_s.is_some();
        Update {
            t_s,
            risk: Err(reason),
            elevated_risk_pct: None,
            level: judging.then(|| self.alert.level()),
            change: step.change,
            judged: false,
            ended: step.ended,
        }
    }

    /// Starts anew: what is behind says nothing about what comes.
    fn forget(&mut self, t_s: f64, landed: bool, room: &mut Room<'_>) -> Step {
        for seen in room.seen.iter_mut() {
            seen.clear();
        }
        room.inputs.fill(f64::NAN);
        self.in_air_since_s = None;
        self.stop_judging(t_s, landed, room)
    }

    fn stop_judging(&mut self, t_s: f64, landed: bool, room: &mut Room<'_>) -> Step {
        self.sum.clear(room.risks);
        self.last_known_s = None;
        self.alert.end(t_s, landed, room.motors)
    }
}

/// The value of an input, where enough is known of its window.
pub(crate) fn reading(
    inputs: &[Input],
    seen: &[Seen],
    sampling: &Sampling,
    input: usize,
) -> Result<f64, Unknown> {
    let observation = value(inputs, seen, input).ok_or(Unknown::NoValue { input })?;
    // A window that is full to a sample's time or so is full.
    let needed_s = sampling.warm_up_s.min(observation.window_s) * 0.99;
    match observation.samples {
        Some(_) if observation.covered_s < needed_s => Err(Unknown::WarmingUp { input }),
        Some(samples) if samples < sampling.min_samples => {
            Err(Unknown::TooFewSamples { input, samples })
        }
        _ => Ok(observation.value),
    }
}
