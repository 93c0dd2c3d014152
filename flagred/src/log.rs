//! A flight log as samples: the one place where `flightlog` and FLAGRED meet.

use alloc::{borrow::ToOwned, vec, vec::Vec};

use flightlog::{Flight, Gap, LeftOut, Options};

use crate::{
    attitude::Attitude,
    estimator::Estimator,
    evaluation::Span,
    flight::{Assessment, Assessor, Reason, Verdict, judged_span},
    monitor::{Craft, MonitorError, Sample, Unknown},
    verdict::{Level, VerdictSettings},
};

/// The signals that an attitude error is made of.
pub const ATTITUDE: [&str; 4] = ["roll_des_deg", "roll_deg", "pitch_des_deg", "pitch_deg"];

/// Assesses a flight. Every motor sample counts; a step is kept every `step_s` seconds, or none.
///
/// # Example: from a log to a verdict
/// ```
/// # let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/flights/steady.BIN");
/// let flight = flightlog::open(path, &flightlog::Options::default())?;
/// let assessment = flagred::log::assess(&flight, &flagred::shipped::flagred(), None);
/// assert_eq!(assessment.verdict.to_string(), "GOOD");
/// for finding in &assessment.findings {
///     println!("{} from {:.1} to {:.1} s", finding.level, finding.from_s, finding.to_s);
/// }
/// # Ok::<(), flightlog::ReadError>(())
/// ```
pub fn assess(flight: &Flight, estimator: &Estimator, step_s: Option<f64>) -> Assessment {
    let gaps = flight.gaps();
    let is_needed = |gap: &&Gap| !matches!(gap, Gap::NoAttitude | Gap::TooSlow { .. });
    if let Some(gap) = gaps.iter().find(is_needed) {
        return Assessment::not_available(Reason::Log(gap.clone()));
    }
    let profile = estimator.profile();
    let needed = profile.signals();
    let carried = carried(flight, &needed);
    // A signal that one of several risks needs does not keep the others from being assessed.
    let signals = match profile.other_risks.is_empty() {
        true => carried.clone(),
        false => needed,
    };
    let mut assessor = match Assessor::new(estimator, craft(flight, &signals), step_s) {
        Ok(assessor) => assessor,
        Err(error) => return Assessment::not_available(error),
    };
    for_each_sample(flight, &signals, |sample| {
        assessor.push(sample);
    });
    if let Some(in_air) = &flight.in_air {
        assessor.set_in_air_s(in_air.duration_s());
    }
    let mut assessment = assessor.finish();
    if let Verdict::NotAvailable(Reason::RiskUnknown { unknown, .. }) = &assessment.verdict
        && let Unknown::NoValue { input } = unknown
        && let Some(input) = profile.inputs.get(*input)
        && let Some(signal) = input.source.signal.carried().find(|s| !carried.contains(s))
    {
        let signal = signal.into();
        assessment.verdict = Verdict::NotAvailable(MonitorError::NoSignal { signal }.into());
    }
    let reads_motors = |input: usize| {
        let input = profile.inputs.get(input);
        input.is_none_or(|input| input.source.signal.carried().next().is_none())
    };
    let slow = gaps.iter().find(|gap| matches!(gap, Gap::TooSlow { .. }));
    if let (Verdict::NotAvailable(Reason::RiskUnknown { unknown, help, .. }), Some(slow)) =
        (&mut assessment.verdict, slow)
    {
        match unknown {
            Unknown::TooFewSamples { .. } => *help = slow.help(),
            // Two samples or none in a window: the rate is the reason, not the motors' signal.
            Unknown::NoValue { input } | Unknown::WarmingUp { input } if reads_motors(*input) => {
                assessment.verdict = Verdict::NotAvailable(Reason::Log(slow.clone()));
            }
            _ => {}
        }
    }
    if let Verdict::NotAvailable(Reason::MotorUnknown { motor, .. }) = &mut assessment.verdict
        && let Some(logged) = flight.motors.get(*motor - 1)
    {
        *motor = logged.number.into();
    }
    // As for a vehicle that is lost on a live link: what was seen of the flight is not GOOD for that. What is unknown then is
    // unknown for that, too.
    if let Some(&at_s) = flight.rebooted_in_air_s.first()
        && matches!(
            assessment.verdict,
            Verdict::Known(Level::Good)
                | Verdict::NotAvailable(
                    Reason::MotorUnknown { .. } | Reason::RiskUnknown { .. } | Reason::NoCommands
                )
        )
    {
        assessment.verdict = Verdict::NotAvailable(Reason::SetBackInAir { at_s });
    }
    assessment
}

/// The craft that flew, with samples that carry the named signals.
pub fn craft<'a>(flight: &'a Flight, signals: &'a [&'a str]) -> Craft<'a> {
    let geometry = flight.geometry.as_ref();
    Craft::new(flight.motors.len())
        .with_signals(signals)
        .with_geometry(geometry.map_or(&[], |geometry| &geometry.factors))
}

/// Those of the named signals that the flight carries.
pub fn carried<'a>(flight: &Flight, names: &[&'a str]) -> Vec<&'a str> {
    let names = names.iter().copied();
    names.filter(|name| flight.signal(name).is_some()).collect()
}

/// Calls `take` with every motor sample of a flight in turn, with the latest value of each named signal.
pub fn for_each_sample(flight: &Flight, signals: &[&str], mut take: impl FnMut(&Sample<'_>)) {
    let mut holds: Vec<_> = signals
        .iter()
        .map(|name| flight.signal(name).map(|signal| signal.hold()))
        .collect();
    let mut motors = vec![f64::NAN; flight.motors.len()];
    let mut signals = vec![f64::NAN; holds.len()];
    for (t_s, row) in flight.commands.rows() {
        for (effective, &raw) in motors.iter_mut().zip(row) {
            *effective = flight.effective_command(raw).unwrap_or(f64::NAN);
        }
        for (value, hold) in signals.iter_mut().zip(&mut holds) {
            let held = hold.as_mut().and_then(|hold| hold.at(t_s));
            *value = held.unwrap_or(f64::NAN);
        }
        take(&Sample {
            t_s,
            motors: &motors,
            in_air: in_air(flight, t_s),
            signals: &signals,
        });
    }
}

/// Whether the autopilot reports at a time that the vehicle is in the air; `None` where that is assumed.
pub fn in_air(flight: &Flight, t_s: f64) -> Option<bool> {
    let is_assumed = flight.in_air.as_ref().is_some_and(|air| air.is_assumed);
    match flight.is_in_air(t_s) == Some(true) {
        true => (!is_assumed).then_some(true),
        false => Some(false),
    }
}

/// The attitude over time, at the rate of `roll_deg`.
pub fn attitudes(flight: &Flight) -> impl Iterator<Item = (f64, Attitude)> + '_ {
    let mut holds = ATTITUDE.map(|name| flight.signal(name).map(|signal| signal.hold()));
    let times = flight.signal("roll_deg").map_or(&[][..], |roll| roll.t_s);
    times.iter().map(move |&t_s| {
        let [roll_des_deg, roll_deg, pitch_des_deg, pitch_deg] = holds.each_mut().map(|hold| {
            let held = hold.as_mut().and_then(|hold| hold.at(t_s));
            held.unwrap_or(f64::NAN)
        });
        let attitude = Attitude {
            roll_des_deg,
            roll_deg,
            pitch_des_deg,
            pitch_deg,
        };
        (t_s, attitude)
    })
}

/// Why a flight is not complete: see [`complete`].
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Incomplete {
    /// The log has more than is kept of it.
    #[error("not all of it is kept, which leaves out {0}")]
    LeftOut(LeftOut),
    /// The log lacks something.
    #[error(transparent)]
    Gap(Gap),
}

impl Incomplete {
    /// What to do about it, apart from the message.
    pub fn help(&self) -> Option<&'static str> {
        match self {
            Incomplete::LeftOut(_) => Some("docs/limits.md has the bounds"),
            Incomplete::Gap(gap) => gap.help(),
        }
    }
}

/// What is read of a log to learn from it or to evaluate on it: the named signals, and the attitude.
pub fn complete_options(names: &[&str]) -> Options {
    let wanted = names.iter().chain(&ATTITUDE).map(|name| (*name).to_owned());
    Options {
        signals: Some(wanted.collect()),
        ..Options::default()
    }
}

/// Whether a flight can be learned from and evaluated on: with motors, attitude and times in the air, and nothing left out.
///
/// # Errors
/// What it lacks.
pub fn complete(flight: &Flight) -> Result<(), Incomplete> {
    let left_out = &flight.report.left_out;
    if left_out.messages > 0 || left_out.changes > 0 {
        return Err(Incomplete::LeftOut(left_out.clone()));
    }
    let mut gaps = flight.gaps().into_iter();
    let gap = gaps.find(|gap| !matches!(gap, Gap::TooSlow { .. }));
    gap.map_or(Ok(()), |gap| Err(Incomplete::Gap(gap)))
}

/// What the header of a flight CSV says under a key, such as `kind` or `vehicle`.
pub fn header<'a>(flight: &'a Flight, key: &str) -> Option<&'a str> {
    let found = flight.header.iter().find(|(k, _)| k == key);
    found.map(|(_, value)| value.as_str())
}

/// The judged time of a flight: from `judged_from_s` to `judged_to_s` of the header, else [`judged_span`] of each time in
/// the air.
pub fn judged_spans(flight: &Flight, settings: &VerdictSettings) -> Vec<Span> {
    let number = |key| header(flight, key).and_then(|text| text.parse::<f64>().ok());
    if let (Some(from_s), Some(to_s)) = (number("judged_from_s"), number("judged_to_s")) {
        let span = Span { from_s, to_s };
        return Some(span)
            .filter(|span| span.length_s() > 0.0)
            .into_iter()
            .collect();
    }
    let air = flight.in_air.iter().flat_map(|air| &air.spans);
    air.filter_map(|span| {
        let air = Span {
            from_s: span.start_s,
            to_s: span.end_s,
        };
        judged_span(air, span.ends_with_log, settings)
    })
    .collect()
}
