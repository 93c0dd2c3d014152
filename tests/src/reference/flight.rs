//! A whole flight, sample by sample.

use flagred::{
    profile::Profile,
    verdict::{Level, VerdictSettings},
};
use fuzzy::Model;

use super::{
    balance::{Balance, BalanceFinding, Trims},
    elevated::{self, Stretch},
    inputs::{self, Observation, VehicleInputs},
    levels::{Levels, Moment, RaisedEpisode},
    rules,
    yaw::less_yaw,
};

/// A time on the ground shorter than this, in seconds, is not a landing.
const TOUCH_S: f64 = 1.0;
/// If the motors begin to idle within this time, in seconds, after a high risk, the vehicle has not landed.
const TROUBLE_S: f64 = 2.0;
/// Motors that idle for this long in the air, in seconds, indicate a fall.
const FALL_S: f64 = 3.0;

/// The motor commands at one time.
pub struct Sample {
    /// Time in seconds.
    pub t_s: f64,
    /// The effective command of each motor; NaN is unknown.
    pub commands: Vec<f64>,
    /// The signals, in the order of the profile; NaN is unknown.
    pub signals: Vec<f64>,
    /// Whether the vehicle is in the air, according to the log.
    pub in_air: bool,
}

impl Sample {
    fn lacks_a_motor(&self) -> bool {
        self.commands.iter().any(|e| e.is_nan())
    }
}

/// The results after a sample that the log reports as in the air.
pub struct Row {
    /// The time in seconds.
    pub t_s: f64,
    /// The inputs of the profile.
    pub inputs: Vec<Option<f64>>,
    /// The risk in %.
    pub risk: Option<f64>,
    /// The elevated risk in %.
    pub elevated: Option<f64>,
}

/// The samples of a log, without signals.
pub fn samples(flight: &flagred_flightlog::Flight) -> Vec<Sample> {
    let effective = |raw: &f64| flight.effective_command(*raw).unwrap_or(f64::NAN);
    let rows = flight.commands.rows().map(|(t_s, raw)| Sample {
        t_s,
        commands: raw.iter().map(effective).collect(),
        signals: Vec::new(),
        in_air: flight.is_in_air(t_s) == Some(true),
    });
    rows.collect()
}

/// The results of the flights of a log.
pub struct ReferenceResults {
    /// The results after each sample that the log reports as in the air.
    pub rows: Vec<Row>,
    /// The findings of the risk.
    pub episodes: Vec<RaisedEpisode>,
    /// The findings of the balance: the last one of each period in the air.
    pub unbalanced: Vec<BalanceFinding>,
}

/// State that is kept across a gap in the air: the trims and, after an alarm, the last time at which the motors did
/// not yet work as before the alarm.
type AcrossGap = (Trims, Option<f64>);

/// Follows flights with a profile and a rule set; `factors` contains the motors' factors, and is empty if they are
/// unknown.
pub fn follow(
    samples: &[Sample],
    factors: &[[f64; 3]],
    profile: &Profile,
    model: &Model,
) -> ReferenceResults {
    let longest_gap_s = profile.sampling.longest_gap_s;
    let mut rows = Vec::new();
    let mut episodes = Vec::new();
    let mut unbalanced = Vec::new();
    let mut air: Option<AirborneState> = None;
    let mut kept: Option<AcrossGap> = None;
    let mut down_since_s = None;
    let mut before_s: Option<f64> = None;
    let mut lifted_s: Option<f64> = None;
    let mut falls = false;
    for sample in samples {
        let t_s = sample.t_s;
        let since_s = before_s.map(|before_s| t_s - before_s);
        if since_s.is_some_and(|s| (-longest_gap_s..=0.0).contains(&s)) {
            continue;
        }
        let held_s = since_s.filter(|s| (0.0..=longest_gap_s).contains(s));
        if held_s.is_none() {
            if let Some(air) = air.take() {
                let of_air = air.end(profile, None);
                let doubt_s = of_air.level_at_end.then_some(t_s);
                kept = Some((of_air.trims, doubt_s));
                episodes.extend(of_air.episodes);
                unbalanced.extend(of_air.unbalanced);
            }
            if since_s.is_some_and(|s| s < 0.0) {
                kept = None;
            }
            down_since_s = None;
        }
        before_s = Some(t_s);
        if held_s.is_none() || !sample.in_air {
            lifted_s = None;
        }
        let idles = mean(sample) < profile.verdict.idle_below;
        if sample.in_air && !idles && !sample.lacks_a_motor() {
            lifted_s = Some(t_s);
        }
        let is_alarm = (air.as_ref()).is_some_and(|air| air.levels.level > Level::Good);
        let is_long = lifted_s.is_some_and(|lifted_s| t_s - lifted_s >= FALL_S);
        falls = sample.in_air && idles && is_long && (falls || !is_alarm);
        let rests = sample.in_air && rests(&mut air, sample, profile);
        if sample.in_air && (falls || !rests) {
            falls &= reads_motors(profile);
            down_since_s = None;
            let air = air.get_or_insert_with(|| AirborneState::new(t_s, profile, kept.take()));
            air.falls = falls;
            rows.push(air.take_in(sample, held_s.unwrap_or(0.0), factors, (profile, model)));
            continue;
        }
        if sample.in_air {
            rows.push(Row {
                t_s,
                inputs: vec![None; profile.inputs.len()],
                risk: None,
                elevated: None,
            });
        }
        let down_s = *down_since_s.get_or_insert(t_s);
        if air.is_none() {
            kept = None;
        }
        if t_s - down_s >= TOUCH_S
            && let Some(air) = air.take()
        {
            let of_air = air.end(profile, Some(down_s));
            episodes.extend(of_air.episodes);
            unbalanced.extend(of_air.unbalanced);
        }
    }
    if let Some(air) = air {
        let of_air = air.end(profile, down_since_s);
        episodes.extend(of_air.episodes);
        unbalanced.extend(of_air.unbalanced);
    }
    ReferenceResults {
        rows,
        episodes,
        unbalanced,
    }
}

/// The mean command; NaN if a motor is unknown.
fn mean(sample: &Sample) -> f64 {
    sample.commands.iter().sum::<f64>() / sample.commands.len() as f64
}

/// Whether an input reads the commands of the motors.
fn reads_motors(profile: &Profile) -> bool {
    profile.inputs.iter().any(|input| {
        let signal = &input.source.signal;
        signal.carried().next().is_none()
    })
}

/// Whether the motors idle on the ground: before take-off, or after a flight unless a high risk came just before.
fn rests(air: &mut Option<AirborneState>, sample: &Sample, profile: &Profile) -> bool {
    if sample.lacks_a_motor() {
        return false;
    }
    let idles = mean(sample) < profile.verdict.idle_below;
    let Some(air) = air else { return idles };
    if !idles {
        air.fell = None;
        return false;
    }
    let since_high_s = sample.t_s - air.last_high_s;
    let is_apart =
        profile.verdict.notices.imbalance.is_some() && !air.balance.is_together(&sample.commands);
    !*air
        .fell
        .get_or_insert(since_high_s <= TROUBLE_S || is_apart)
}

/// The state during a period in the air. It is reset before and after the period.
struct AirborneState {
    take_off_s: f64,
    /// Values that ended before this time do not count in the long windows.
    since_s: f64,
    /// The observed values of each input.
    observed: Vec<Vec<Observation>>,
    risks: Vec<Stretch>,
    /// The rate in % per second after the last of the risks, and the elevated risk in %.
    elevated: Option<(f64, f64)>,
    moments: Vec<Moment>,
    levels: Levels,
    episodes: Vec<RaisedEpisode>,
    balance: Balance,
    /// During and after an alarm: the last time, in seconds, at which the motors did not yet work as before the alarm.
    unrecovered_s: Option<f64>,
    /// Whether the motors began to idle after a high risk; `None` while they do not idle.
    fell: Option<bool>,
    /// Whether the motors idle in the air.
    falls: bool,
    last_high_s: f64,
}

/// The results of a period in the air.
struct AirborneResults {
    episodes: Vec<RaisedEpisode>,
    unbalanced: Option<BalanceFinding>,
    trims: Trims,
    /// Whether an alarm was active at the end.
    level_at_end: bool,
}

impl AirborneState {
    fn new(take_off_s: f64, profile: &Profile, kept: Option<AcrossGap>) -> AirborneState {
        let (trims, unrecovered_s) = kept.unwrap_or_default();
        AirborneState {
            levels: Levels::new(),
            balance: Balance::new(trims),
            unrecovered_s,
            take_off_s,
            since_s: f64::NEG_INFINITY,
            observed: vec![Vec::new(); profile.inputs.len()],
            risks: Vec::new(),
            elevated: None,
            moments: Vec::new(),
            episodes: Vec::new(),
            fell: None,
            falls: false,
            last_high_s: f64::NEG_INFINITY,
        }
    }

    fn end(mut self, profile: &Profile, landed_s: Option<f64>) -> AirborneResults {
        let level_at_end = self.is_alarm();
        self.stop(profile, landed_s);
        AirborneResults {
            episodes: self.episodes,
            unbalanced: self.balance.found(),
            trims: self.balance.trims,
            level_at_end,
        }
    }

    /// Whether an alarm is active: the level is above GOOD, a finding of the balance is open, or the motors do not yet
    /// work as before an alarm.
    fn is_alarm(&self) -> bool {
        self.levels.level > Level::Good || self.balance.is_open() || self.unrecovered_s.is_some()
    }

    /// Ends the findings and resets the elevated risk.
    fn stop(&mut self, profile: &Profile, landed_s: Option<f64>) {
        self.episodes
            .extend(self.levels.end(&profile.verdict, landed_s));
        self.moments.clear();
        self.begin_anew();
    }

    /// Resets the elevated risk to 0.
    fn begin_anew(&mut self) {
        self.risks.clear();
        self.elevated = None;
    }

    fn take_in(
        &mut self,
        sample: &Sample,
        held_s: f64,
        factors: &[[f64; 3]],
        (profile, model): (&Profile, &Model),
    ) -> Row {
        let Sample {
            t_s, ref commands, ..
        } = *sample;
        let now = VehicleInputs {
            commands,
            less_yaw: &less_yaw(commands, factors),
            signals: &sample.signals,
        };
        let span = (t_s - held_s, t_s);
        for (input, observed) in profile.inputs.iter().zip(&mut self.observed) {
            observed.push(Observation::new(profile, &input.source, span, &now));
        }
        self.discard_take_off(t_s, profile);
        let settled_s = profile.sampling.take_off_s + profile.sampling.warm_up_s;
        if let Some(limit) = profile.verdict.notices.imbalance
            && t_s - self.take_off_s >= settled_s
            && !sample.lacks_a_motor()
        {
            let is_calm = self.levels.level == Level::Good && self.unrecovered_s.is_none();
            let limit = (limit.value, limit.after_s);
            let time = (t_s, held_s);
            self.balance.push(time, commands, factors, limit, is_calm);
        }
        let inputs = inputs::values(profile, &self.observed, t_s, self.since_s);
        let is_unknown = sample.lacks_a_motor() && reads_motors(profile);
        let risk = risk(profile, model, &inputs).filter(|_| !is_unknown);
        let risk = if self.falls { Some(100.0) } else { risk };
        let elevated = risk.map(|risk| self.add(risk, span, profile));
        let known_s = self.moments.last().map_or(t_s, |moment| moment.t_s);
        if t_s - known_s > profile.sampling.longest_gap_s {
            self.unrecovered_s = self.is_alarm().then_some(known_s);
            self.stop(profile, None);
        }
        Row {
            t_s,
            inputs,
            risk,
            elevated,
        }
    }

    /// Drops the take-off from the long windows and the elevated risk.
    fn discard_take_off(&mut self, t_s: f64, profile: &Profile) {
        let sampling = &profile.sampling;
        let flown_s = t_s - self.take_off_s;
        let is_due = flown_s >= sampling.take_off_s + sampling.warm_up_s;
        if self.since_s.is_infinite() && is_due && sampling.take_off_s > 0.0 {
            self.since_s = self.take_off_s + sampling.take_off_s;
            self.begin_anew();
        }
    }

    /// Adds a risk and returns the elevated risk.
    fn add(&mut self, risk: f64, (from_s, t_s): (f64, f64), profile: &Profile) -> f64 {
        let verdict = &profile.verdict;
        if verdict.warn.raise.risk_pct.is_some_and(|high| risk >= high) {
            self.last_high_s = t_s;
        }
        let before = self.risks.last().map_or(risk, |stretch| stretch.to.1);
        if t_s > from_s {
            self.risks.push(Stretch {
                from: (from_s, before),
                to: (t_s, risk),
            });
            let rate = elevated::rate(&profile.elevated_risk, &self.risks);
            let (rate_before, elevated) = self.elevated.unwrap_or((rate, 0.0));
            let step = (t_s - from_s) * (rate_before + rate) / 2.0;
            self.elevated = Some((rate, (elevated + step).clamp(0.0, 100.0)));
        }
        let elevated = self.elevated.map_or(0.0, |(_, elevated)| elevated);
        self.moments.push(Moment {
            t_s,
            risk,
            elevated,
            takes_off: !self.falls && t_s - self.take_off_s < verdict.quiet_after_take_off_s,
            sinks: !self.falls && self.balance.sinks,
        });
        self.levels.push(verdict, &self.moments);
        self.update_recovery(t_s, verdict);
        elevated
    }

    /// Updates `unrecovered_s`. An alarm lasts until the motors have worked as before the alarm for `clear_after_s`.
    fn update_recovery(&mut self, t_s: f64, verdict: &VerdictSettings) {
        let is_alarm = self.levels.level > Level::Good;
        let has_recovered = verdict.notices.imbalance.is_none() || self.balance.has_recovered;
        if (is_alarm || self.unrecovered_s.is_some()) && !has_recovered {
            self.unrecovered_s = Some(t_s);
        } else if !is_alarm {
            let lasts = |s: &f64| t_s - s < verdict.clear_after_s - 1e-6;
            self.unrecovered_s = self.unrecovered_s.filter(lasts);
        }
    }
}

/// The risk for values of the inputs of a profile.
fn risk(profile: &Profile, model: &Model, inputs: &[Option<f64>]) -> Option<f64> {
    let known: Option<Vec<f64>> = inputs.iter().copied().collect();
    let known = known?;
    let place = |name: &str| profile.inputs.iter().position(|input| input.name == name);
    let value = |name: &str| place(name).map(|input| known[input]);
    let point: Option<Vec<f64>> = model
        .inputs
        .iter()
        .map(|input| value(&input.name))
        .collect();
    let mut outputs = model.outputs.iter();
    let output = outputs.position(|output| output.variable.name == profile.output)?;
    // The risk of the shipped rules has symmetric triangles as terms, so few samples suffice for
    // the exact centroid.
    rules::evaluate(model, &point?, 2)[output]
}
