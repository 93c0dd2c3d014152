//! The state of a flight, updated sample by sample in memory that the caller provides. All kinds of monitors use this
//! module.

use crate::{
    accumulator::{Accumulator, AccumulatorSettings},
    cause::{Cause, is_of_limits},
    channel::{Channel, ChannelState, Input, Now, assumed, note, push, reads_motors, value},
    motor::{self, Bin, Motor},
    sample::{Estimate, Sample, Sampling, Unknown, Update},
    verdict::{self, Alert, EndedFindings, Finding, Level, Notices, ROUNDING_S, VerdictSettings},
    window::Window,
};

/// The settings of a profile that concern time: when inputs count as known, how risks accumulate, when levels change.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// The conditions under which an input counts as known.
    pub sampling: Sampling,
    /// The parameters of the elevated risk.
    pub elevated_risk: AccumulatorSettings,
    /// The conditions under which levels are raised and cleared.
    pub verdict: VerdictSettings,
}

/// The state of a flight, without its windows.
#[derive(Debug, Clone)]
pub(crate) struct Follower {
    settings: Settings,
    sum: Accumulator,
    alert: Alert,
    notices: Notices,
    bin: Bin,
    last_s: Option<f64>,
    in_air_since_s: Option<f64>,
    /// Whether the take-off has been discarded from the windows.
    has_discarded_take_off: bool,
    /// The time since which the vehicle seems to be on the ground, in seconds; the flight may continue within
    /// [`TOUCH_S`].
    down_since_s: Option<f64>,
    /// The interpretation of idling motors: a landing, or trouble in flight; `None` while the motors do not idle.
    idle: Option<Idle>,
    /// The last time in seconds at which the motors did not idle; `None` if there is no such time since the autopilot
    /// last reported that the vehicle is on the ground.
    lifted_s: Option<f64>,
    /// Whether the vehicle counts as falling, because its motors idle in the air.
    falls: bool,
    last_high_s: Option<f64>,
    last_known_s: Option<f64>,
    /// During and after an alarm, the last time in seconds at which the motors were not known to work as they did
    /// before the alarm.
    unrecovered_s: Option<f64>,
}

/// The time in seconds for which the land detector must report the ground, or the motors must idle, to count as a
/// landing.
const TOUCH_S: f64 = 1.0;

/// Motors that idle within this time after a high risk, in seconds, do not count as a landing.
const TROUBLE_S: f64 = 2.0;

/// Motors that idle for this long, in seconds, while the autopilot reports that the vehicle is in the air, count as a
/// fall. A land detector reports a landing up to 1.5 s after the motors begin to idle, and in bounces motors idle for
/// up to 2.3 s (docs/profiles.md).
const FALL_S: f64 = 3.0;

/// The reason why a flight or its observation ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum End {
    Landing,
    /// Samples are missing in the air.
    Gap,
    /// The clock goes back, or no more samples follow.
    Restart,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Idle {
    Landing,
    InTrouble,
}

/// The risk after a sample.
struct Risk {
    estimate: Estimate,
    elevated_pct: f64,
    /// Whether the risk counts for the verdict.
    judged: bool,
}

/// The memory of a flight: the risks of the last seconds, the observations of each channel, the values of the inputs
/// after the latest sample (NaN is unknown), and the motors.
#[derive(Debug)]
pub(crate) struct FlightMemory<'m> {
    pub(crate) risks: &'m mut Window,
    pub(crate) seen: &'m mut [ChannelState],
    pub(crate) inputs: &'m mut [f64],
    pub(crate) motors: &'m mut [Motor],
}

/// The data that a risk is computed from.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Feed<'a> {
    pub(crate) channels: &'a [Channel],
    /// The inputs of the profile, and inputs that a monitor appends.
    pub(crate) inputs: &'a [Input],
    /// The inputs that the risk depends on, in the form of [`Lookup::order`](crate::lookup::Lookup::order).
    pub(crate) order: &'a [u32],
}

impl Feed<'_> {
    /// Whether the risk depends on an input, or on a ratio that divides by it.
    pub(crate) fn needs(&self, input: usize) -> bool {
        self.order.iter().any(|from| {
            let read = self.inputs.get(*from as usize);
            *from as usize == input || read.is_some_and(|read| read.others().any(|of| of == input))
        })
    }

    /// Whether the risk depends on an input that reads the commands of the motors.
    pub(crate) fn needs_motors(&self) -> bool {
        let mut inputs = self.inputs.iter().enumerate();
        inputs.any(|(i, input)| self.needs(i) && reads_motors(self.channels, input))
    }
}

impl Follower {
    pub(crate) const fn new(settings: Settings) -> Follower {
        Follower {
            sum: Accumulator::new(settings.elevated_risk),
            alert: Alert::new(settings.verdict),
            notices: Notices::new(settings.verdict.notices),
            bin: Bin::NONE,
            settings,
            last_s: None,
            in_air_since_s: None,
            has_discarded_take_off: false,
            down_since_s: None,
            idle: None,
            lifted_s: None,
            falls: false,
            last_high_s: None,
            last_known_s: None,
            unrecovered_s: None,
        }
    }

    #[cfg(feature = "std")]
    pub(crate) fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Processes a sample; `estimate` computes the risk for given values of the inputs.
    pub(crate) fn push(
        &mut self,
        feed: Feed<'_>,
        room: &mut FlightMemory<'_>,
        sample: &Sample<'_>,
        estimate: impl FnOnce(&[f64]) -> Option<Estimate>,
    ) -> Update {
        let before = self.level();
        let mut update = Update {
            t_s: sample.t_s,
            risk: Err(Unknown::OutOfOrder),
            elevated_risk_pct: None,
            level: None,
            change: None,
            judged: false,
            ended: EndedFindings::default(),
        };
        match self.take(feed, room, sample, &mut update.ended, estimate) {
            Ok(risk) => {
                update.risk = Ok(risk.estimate);
                update.elevated_risk_pct = Some(risk.elevated_pct);
                update.judged = risk.judged;
                update.level = Some(self.level());
            }
            Err(reason) => {
                update.risk = Err(reason);
                update.level = self.level_while_unknown();
            }
        }
        update.change = update.level.filter(|level| *level != before);
        update
    }

    fn take(
        &mut self,
        feed: Feed<'_>,
        room: &mut FlightMemory<'_>,
        sample: &Sample<'_>,
        ended: &mut EndedFindings,
        estimate: impl FnOnce(&[f64]) -> Option<Estimate>,
    ) -> Result<Risk, Unknown> {
        let t_s = sample.t_s;
        let longest_gap_s = self.settings.sampling.longest_gap_s;
        let held_s = match self.last_s {
            _ if !t_s.is_finite() => return Err(Unknown::OutOfOrder),
            None => 0.0,
            Some(last_s) if t_s <= last_s && last_s - t_s <= longest_gap_s => {
                return Err(Unknown::OutOfOrder);
            }
            // A jump, forward (a lost link) or back (a restarted vehicle), resets the state.
            Some(last_s) if !(0.0..=longest_gap_s).contains(&(t_s - last_s)) => {
                let end = if t_s > last_s { End::Gap } else { End::Restart };
                *ended = self.forget(last_s, end, room);
                self.unrecovered_s = self.unrecovered_s.map(|_| t_s);
                0.0
            }
            Some(last_s) => t_s - last_s,
        };
        self.last_s = Some(t_s);
        note((feed.channels, feed.inputs), room.seen, sample.signals);
        let together = motor::take(room.motors, &mut self.bin, t_s, sample.motors);
        let is_at_rest = self.is_at_rest(sample, room.motors);
        // During a fall, a risk that does not depend on the motors is still estimated.
        self.falls = self.falls && feed.needs_motors();
        if is_at_rest {
            room.inputs.fill(f64::NAN);
            if self.in_air_since_s.is_some() {
                let down_since_s = *self.down_since_s.get_or_insert(t_s);
                if t_s - down_since_s >= TOUCH_S {
                    *ended = self.forget(down_since_s, End::Landing, room);
                }
            } else {
                // The landing was within a gap.
                self.unrecovered_s = None;
                motor::forget_trims(room.motors);
            }
            return Err(Unknown::OnGround);
        }
        self.down_since_s = None;
        let in_air_since_s = *self.in_air_since_s.get_or_insert(t_s);
        let now = Now {
            motors: room.motors,
            together,
            named: sample.signals,
        };
        push(feed.channels, room.seen, (t_s, held_s), &now);
        self.discard_take_off(t_s, in_air_since_s, room);
        let unknown = unknown_motor(room.motors, sample.motors);
        if self.has_discarded_take_off && unknown.is_none() {
            let is_calm = self.alert.level() == Level::Good && self.unrecovered_s.is_none();
            self.notices
                .push((t_s, held_s), together.noise, room.motors, is_calm);
        }
        let unknown = unknown.filter(|_| feed.needs_motors());
        let estimate = match self.estimate(feed, room, unknown, estimate) {
            _ if self.falls => Estimate::FALL,
            Ok(estimate) => estimate,
            Err(reason) => {
                let known_s = self.last_known_s.unwrap_or(t_s);
                if t_s - known_s > longest_gap_s {
                    *ended = self.stop_judging(known_s, End::Gap, room);
                }
                return Err(reason);
            }
        };
        self.last_known_s = Some(t_s);
        let verdict = &self.settings.verdict;
        if verdict
            .warn
            .raise
            .risk_pct
            .is_some_and(|high| estimate.risk_pct >= high)
        {
            self.last_high_s = Some(t_s);
        }
        let elevated = self.sum.push(room.risks, (t_s, held_s), estimate.risk_pct);
        let takes_off = !self.falls && t_s - in_air_since_s < verdict.quiet_after_take_off_s;
        let now = verdict::Now {
            t_s,
            risk_pct: estimate.risk_pct,
            elevated_pct: elevated,
            takes_off,
            slow_down_together: !self.falls && self.notices.slow_down_together(),
            falls: self.falls,
        };
        let step = self.alert.push(now, room.motors);
        self.update_recovery(t_s);
        // This cannot replace a finding that ended because the state was reset: raising a level again takes a while, so no
        // second finding can end with the same sample.
        if step.ended.is_some() {
            ended[0] = step.ended;
        }
        Ok(Risk {
            estimate,
            elevated_pct: elevated,
            judged: !takes_off,
        })
    }

    /// The finding behind the current level, with its values so far; `None` while the level is good.
    pub(crate) fn open_finding(&self) -> Option<Finding> {
        self.alert.open().or_else(|| self.notices.open().copied())
    }

    /// The beginning and the highest value of the open finding of the risk, or of the finding that will be
    /// opened if a threshold stays reached: see [`Alert::peak`].
    #[cfg(feature = "std")]
    pub(crate) fn peak_of_risk(&self) -> Option<(f64, f64)> {
        self.alert.peak()
    }

    /// The worst open finding that is not about the risk, with its values so far: little reserve or an imbalance.
    #[cfg(feature = "std")]
    pub(crate) fn open_notice(&self) -> Option<Finding> {
        self.notices.open().copied()
    }

    /// Sets the cause of the open finding if the latest sample raised its level; `cause` is called only then.
    pub(crate) fn explain(
        &mut self,
        feed: Feed<'_>,
        update: &Update,
        cause: impl FnOnce(f64) -> Option<Cause>,
    ) {
        if !self.alert.needs_cause() {
            return;
        }
        let by_rules = update
            .risk
            .ok()
            .filter(|estimate| estimate.filled_from.is_none());
        let by_rules = by_rules.filter(|_| !self.falls);
        let cause = by_rules.and_then(|estimate| cause(estimate.risk_pct));
        self.alert.explain(cause, |motor| {
            cause
                .is_some_and(|cause| is_of_limits((feed.channels, feed.inputs), cause.input, motor))
        });
    }

    /// Ends the flight and returns the findings that were still open.
    pub(crate) fn finish(&mut self, room: &mut FlightMemory<'_>) -> EndedFindings {
        let Some(last_s) = self.last_s else {
            return EndedFindings::default();
        };
        let ended = match self.down_since_s {
            Some(down_s) => self.forget(down_s, End::Landing, room),
            None => self.forget(last_s, End::Restart, room),
        };
        self.lifted_s = None;
        ended
    }

    /// The worst level of the risk and of the other findings. After an alarm it stays at least WARN
    /// until the motors work as they did before.
    pub(crate) fn level(&self) -> Level {
        let noticed = self.notices.open().map_or(Level::Good, |f| f.severity);
        let recovering = self.unrecovered_s.map_or(Level::Good, |_| Level::Warn);
        self.alert.level().max(noticed).max(recovering)
    }

    /// After an alarm, keeps the level above GOOD until the motors have worked for `clear_after_s` as they did before
    /// the alarm.
    fn update_recovery(&mut self, t_s: f64) {
        let is_alarm = self.alert.level() > Level::Good;
        let clear_after_s = self.settings.verdict.clear_after_s;
        let is_recent = |then_s: f64| t_s - then_s < clear_after_s - ROUNDING_S;
        if (is_alarm || self.unrecovered_s.is_some()) && !self.notices.has_recovered() {
            self.unrecovered_s = Some(t_s);
        } else if !is_alarm {
            self.unrecovered_s = self.unrecovered_s.filter(|then_s| is_recent(*then_s));
        }
    }

    /// Whether the vehicle is on the ground: the autopilot reports it, or the motors idle before take-off or after a
    /// flight that was calm to its end. If a motor is unknown, this cannot be determined, and the vehicle counts as in
    /// the air.
    fn is_at_rest(&mut self, sample: &Sample<'_>, motors: &[Motor]) -> bool {
        let t_s = sample.t_s;
        let fell = core::mem::replace(&mut self.falls, false);
        if sample.is_on_ground() {
            self.lifted_s = None;
            return true;
        }
        let sum: f64 = motors.iter().map(|motor| motor.command).sum();
        if sum.is_nan() {
            return false;
        }
        if sum >= self.settings.verdict.idle_below * motors.len() as f64 {
            self.idle = None;
            self.lifted_s = Some(t_s);
            return false;
        }
        let is_long = |lifted_s: f64| t_s - lifted_s >= FALL_S;
        // During an alarm, only the rules determine the level, so a fall does not begin.
        self.falls = (fell || self.alert.level() == Level::Good)
            && sample.in_air == Some(true)
            && self.lifted_s.is_some_and(is_long);
        let was_high = |high_s: f64| t_s - high_s <= TROUBLE_S;
        let in_trouble =
            self.last_high_s.is_some_and(was_high) || !self.notices.is_together(motors);
        let idle = *self.idle.get_or_insert(match in_trouble {
            true => Idle::InTrouble,
            false => Idle::Landing,
        });
        idle == Idle::Landing && !self.falls
    }

    /// Discards the take-off from the long windows and the elevated risk, once it has been over for `warm_up_s`.
    fn discard_take_off(&mut self, t_s: f64, in_air_since_s: f64, room: &mut FlightMemory<'_>) {
        let Sampling {
            take_off_s,
            warm_up_s,
            ..
        } = self.settings.sampling;
        if self.has_discarded_take_off || t_s - in_air_since_s < take_off_s + warm_up_s {
            return;
        }
        self.has_discarded_take_off = true;
        if take_off_s > 0.0 {
            for seen in room.seen.iter_mut() {
                seen.forget_before(in_air_since_s + take_off_s, take_off_s);
            }
            self.sum.clear(room.risks);
        }
    }

    fn estimate(
        &self,
        feed: Feed<'_>,
        room: &mut FlightMemory<'_>,
        mut reason: Option<Unknown>,
        estimate: impl FnOnce(&[f64]) -> Option<Estimate>,
    ) -> Result<Estimate, Unknown> {
        let plan = (feed.channels, feed.inputs);
        for (input, kept) in room.inputs.iter_mut().enumerate() {
            let value = match assumed(feed.inputs, room.seen, input) {
                Some(value) => Ok(value),
                None => reading(plan, room.seen, &self.settings.sampling, input),
            };
            *kept = value.unwrap_or_else(|unknown| {
                if feed.needs(input) {
                    reason.get_or_insert(unknown);
                }
                f64::NAN
            });
        }
        for (input, of) in feed.inputs.iter().enumerate() {
            if let Some(ratio) = of.ratio
                && assumed(feed.inputs, room.seen, input).is_none()
                && let Some(value) = ratio.of(room.inputs, input)
                && let Some(kept) = room.inputs.get_mut(input)
            {
                *kept = value;
            }
        }
        match reason {
            Some(reason) => Err(reason),
            None => estimate(room.inputs).ok_or(Unknown::NoRule),
        }
    }

    /// The level while the risk is unknown: the level of an ongoing alarm or of another open finding; `None` instead of
    /// GOOD.
    fn level_while_unknown(&self) -> Option<Level> {
        let level = match self.last_known_s {
            Some(_) if self.in_air_since_s.is_some() => Some(self.level()),
            _ => self.notices.open().map(|finding| finding.severity),
        };
        level.filter(|level| *level > Level::Good)
    }

    /// Resets the state after a flight or a gap. After a gap in the air, the trims are kept, and so is the level if it
    /// was above GOOD (see [`Self::update_recovery`]).
    fn forget(&mut self, t_s: f64, end: End, room: &mut FlightMemory<'_>) -> EndedFindings {
        for seen in room.seen.iter_mut() {
            seen.clear();
        }
        room.inputs.fill(f64::NAN);
        self.bin = Bin::NONE;
        self.in_air_since_s = None;
        self.has_discarded_take_off = false;
        self.down_since_s = None;
        self.idle = None;
        if end != End::Landing {
            self.lifted_s = None;
        }
        self.last_high_s = None;
        let [risk, ..] = self.stop_judging(t_s, end, room);
        let [noise, reserve, balance] = self.notices.end();
        motor::clear(room.motors, end == End::Gap);
        [risk, noise, reserve, balance]
    }

    fn stop_judging(&mut self, t_s: f64, end: End, room: &mut FlightMemory<'_>) -> EndedFindings {
        self.unrecovered_s = (end == End::Gap && self.level() > Level::Good).then_some(t_s);
        self.sum.clear(room.risks);
        self.last_known_s = None;
        let step = self.alert.end(t_s, end == End::Landing);
        [step.ended, None, None, None]
    }
}

/// The reason why the risk is unknown if the command of a motor is unknown; `None` if all commands are known.
fn unknown_motor(motors: &[Motor], commands: &[f64]) -> Option<Unknown> {
    let motor = motors.iter().position(|motor| motor.command.is_nan())?;
    let given = commands.get(motor).copied();
    Some(match given.filter(|command| !command.is_nan()) {
        Some(command) => Unknown::CommandOutside { motor, command },
        None => Unknown::NoCommand { motor },
    })
}

/// The statistic of an input, if enough of its window is known.
pub(crate) fn reading(
    plan: (&[Channel], &[Input]),
    seen: &[ChannelState],
    sampling: &Sampling,
    input: usize,
) -> Result<f64, Unknown> {
    let observation = value(plan, seen, input).ok_or(Unknown::NoValue { input })?;
    // A window counts as full if it lacks at most 1 % of its time.
    let needed_s = sampling.warm_up_s.min(observation.window_s) * 0.99;
    match observation.samples {
        Some(_) if observation.covered_s < needed_s => Err(Unknown::WarmingUp { input }),
        Some(samples) if samples < sampling.min_samples => {
            Err(Unknown::TooFewSamples { input, samples })
        }
        _ => Ok(observation.value),
    }
}

state! {
    struct Follower {
        settings, sum, alert, notices, bin, last_s, in_air_since_s, has_discarded_take_off, down_since_s, idle, lifted_s, falls, last_high_s,
        last_known_s, unrecovered_s
    }
    struct Settings { sampling, elevated_risk, verdict }
}

state! { enum Idle { 0 = Landing {}, 1 = InTrouble {} } }

#[cfg(test)]
#[cfg(feature = "std")]
mod tests;
