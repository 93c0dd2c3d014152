//! Converts a flight log to samples: the only module that uses both `flightlog` and the monitor.

use alloc::{string::ToString, vec, vec::Vec};

use flagred_flightlog::{Flight, Format, Gap};

use crate::{
    estimator::Estimator,
    flight::{Assessment, Assessor, Reason, Verdict},
    monitor::{Craft, MonitorError, Sample, Unknown},
    profile::Profile,
    verdict::Level,
};

/// Assesses a flight, using every motor sample. A step is kept every `step_s` seconds; if `step_s` is `None`, no
/// steps are kept.
///
/// # Example: from a log to a verdict
/// ```
/// # let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/flights/steady.BIN");
/// let flight = flagred_flightlog::open(path, &flagred_flightlog::Options::default())?;
/// let assessment = flagred::log::assess(&flight, &flagred::shipped::flagred(), None);
/// assert_eq!(assessment.verdict.to_string(), "GOOD");
/// for finding in &assessment.findings {
///     println!("{} from {:.1} to {:.1} s", finding.severity, finding.from_s, finding.to_s);
/// }
/// # Ok::<(), flagred_flightlog::ReadError>(())
/// ```
pub fn assess(flight: &Flight, estimator: &Estimator, step_s: Option<f64>) -> Assessment {
    assess_by(flight, estimator, |craft| {
        Assessor::new(estimator, craft, step_s)
    })
}

/// As [`assess`], with the interval of the risk of each step ([`Assessor::with_intervals`]). This takes longer;
/// it is meant for drawing and exporting steps.
pub fn assess_with_intervals(flight: &Flight, estimator: &Estimator, step_s: f64) -> Assessment {
    assess_by(flight, estimator, |craft| {
        Ok(Assessor::new(estimator, craft, Some(step_s))?.with_intervals())
    })
}

fn assess_by(
    flight: &Flight,
    estimator: &Estimator,
    assessor: impl FnOnce(Craft<'_>) -> Result<Assessor, MonitorError>,
) -> Assessment {
    let gaps = flight.gaps();
    let is_needed = |gap: &&Gap| !matches!(gap, Gap::NoAttitude | Gap::TooSlow { .. });
    let profile = estimator.profile();
    let missing = match profile.reads_motors() {
        true => gaps.iter().find(is_needed).cloned(),
        // A profile that reads no motors applies to any vehicle.
        false => flight.gap_of_air(),
    };
    if let Some(gap) = missing {
        return Assessment::not_available(Reason::Log(gap));
    }
    let needed = profile.signals();
    let carried = carried(flight, &needed);
    // With several risks, a signal that only one of them needs may be missing: the other risks are
    // still assessed.
    let signals = match profile.other_risks.is_empty() {
        true => carried.clone(),
        false => needed,
    };
    let missing = signals.iter().filter(|name| !carried.contains(name));
    let missing: Vec<&str> = missing.copied().collect();
    let craft = craft(flight, &signals).with_optional(&missing);
    let mut assessor = match assessor(craft) {
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
    let explain = |unknown: &Unknown| explained(unknown, flight, profile, &carried);
    for risk in &mut assessment.unknown_risks {
        if let Some(unknown) = numbered(risk.unknown, flight) {
            risk.reason = unknown.explain(profile);
        }
        match explain(&risk.unknown) {
            (Some(reason), _) => (risk.reason, risk.help) = (reason.to_string(), reason.help()),
            (None, help) => risk.help = help,
        }
    }
    if let Verdict::NotAvailable(Reason::RiskUnknown { unknown, help, .. }) =
        &mut assessment.verdict
    {
        match explain(unknown) {
            (Some(reason), _) => assessment.verdict = Verdict::NotAvailable(reason),
            (None, advice) => *help = advice,
        }
    }
    if let Verdict::NotAvailable(Reason::RiskUnknown {
        explanation, help, ..
    }) = &mut assessment.verdict
        && flight.commands.rows().len() == 1
    {
        *explanation = "the log has only one sample of the motor commands".into();
        *help = Some("log several seconds, at 5 Hz or more");
    }
    if let Verdict::NotAvailable(Reason::MotorUnknown { motor, .. }) = &mut assessment.verdict
        && let Some(logged) = flight.motors.get(*motor - 1)
    {
        *motor = logged.number.into();
    }
    if is_in_doubt(&assessment.verdict)
        && let Some(step_s) = step_s_of(flight, &signals)
        && step_s > profile.sampling.longest_gap_s
    {
        assessment.verdict = Verdict::NotAvailable(Reason::SamplesFarApart {
            step_s,
            longest_gap_s: profile.sampling.longest_gap_s,
        });
    }
    // A reboot in the air is treated like the loss of a vehicle's live link: the flight is not GOOD, and if its risk
    // was unknown, the reboot is the reason.
    if let Some(&at_s) = flight.rebooted_in_air_s.first()
        && is_in_doubt(&assessment.verdict)
    {
        assessment.verdict = Verdict::NotAvailable(Reason::SetBackInAir { at_s });
    }
    assessment
}

/// Returns the reason why a risk is unknown if the log causes this; otherwise advice on how to get a known risk, if
/// there is any.
fn explained(
    unknown: &Unknown,
    flight: &Flight,
    profile: &Profile,
    carried: &[&str],
) -> (Option<Reason>, Option<&'static str>) {
    let (Unknown::NoValue { input }
    | Unknown::WarmingUp { input }
    | Unknown::TooFewSamples { input, .. }) = unknown
    else {
        return (None, None);
    };
    let source = profile.inputs.get(*input).map(|input| &input.source.signal);
    let names = || source.iter().flat_map(|signal| signal.carried());
    let gaps = flight.gaps();
    let slow = gaps.iter().find(|gap| matches!(gap, Gap::TooSlow { .. }));
    match (unknown, slow, names().next()) {
        (Unknown::TooFewSamples { .. }, slow, _) => (None, slow.and_then(Gap::help)),
        // With at most two samples in a window, the sample rate is too low; the signal of the motors is not missing.
        (_, Some(slow), None) => (Some(Reason::Log(slow.clone())), None),
        (Unknown::NoValue { .. }, _, Some(_)) => {
            let is_sparse =
                |name: &str| flight.signal(name).is_some_and(|signal| signal.is_sparse());
            match names().find(|name| !carried.contains(name)) {
                Some(signal) => {
                    let signal = signal.into();
                    (Some(MonitorError::NoSignal { signal }.into()), None)
                }
                None if flight.format == Format::Csv && names().any(is_sparse) => {
                    (None, Some(SPARSE_HELP))
                }
                None => (None, Some(INSPECT_HELP)),
            }
        }
        _ => (None, None),
    }
}

const SPARSE_HELP: &str = "an empty cell is an unknown value: if the signal has fewer values than the table has rows, repeat its last value in each row";
const INSPECT_HELP: &str = "`flagred inspect` shows how many values of a signal are known";

/// Replaces the index of the motor in a reason by the number of the motor minus 1; `None` if the reason does not name a
/// motor.
fn numbered(mut unknown: Unknown, flight: &Flight) -> Option<Unknown> {
    let (Unknown::NoCommand { motor } | Unknown::CommandOutside { motor, .. }) = &mut unknown
    else {
        return None;
    };
    *motor = usize::from(flight.motors.get(*motor)?.number).checked_sub(1)?;
    Some(unknown)
}

/// Whether a reboot in the air may hide a worse verdict: the verdict is GOOD, or NA for a reason in the observed part
/// of the flight.
fn is_in_doubt(verdict: &Verdict) -> bool {
    matches!(
        verdict,
        Verdict::Known(Level::Good)
            | Verdict::NotAvailable(
                Reason::MotorUnknown { .. }
                    | Reason::RiskUnknown { .. }
                    | Reason::TooShort { .. }
                    | Reason::NoSamples
            )
    )
}

/// The craft of a flight, whose samples have the named signals.
pub fn craft<'a>(flight: &'a Flight, signals: &'a [&'a str]) -> Craft<'a> {
    let geometry = flight.geometry.as_ref();
    Craft::new(flight.motors.len())
        .with_signals(signals)
        .with_geometry(geometry.map_or(&[], |geometry| &geometry.factors))
}

/// The named signals that the flight contains.
pub fn carried<'a>(flight: &Flight, names: &[&'a str]) -> Vec<&'a str> {
    let names = names.iter().copied();
    names.filter(|name| flight.signal(name).is_some()).collect()
}

/// Calls `take` for every motor sample of a flight in order, with the latest value of each named signal. If the flight
/// has no motor commands, calls `take` at every time at which one of these signals has a value.
pub fn for_each_sample(flight: &Flight, signals: &[&str], mut take: impl FnMut(&Sample<'_>)) {
    let mut holds: Vec<_> = signals
        .iter()
        .map(|name| flight.signal(name).map(|signal| signal.hold()))
        .collect();
    let mut motors = vec![f64::NAN; flight.motors.len()];
    let mut values = vec![f64::NAN; holds.len()];
    let mut sample = |t_s: f64, row: &[f64]| {
        for (effective, &raw) in motors.iter_mut().zip(row) {
            *effective = flight.effective_command(raw).unwrap_or(f64::NAN);
        }
        for (value, hold) in values.iter_mut().zip(&mut holds) {
            let held = hold.as_mut().and_then(|hold| hold.at(t_s));
            *value = held.unwrap_or(f64::NAN);
        }
        take(&Sample {
            t_s,
            motors: &motors,
            in_air: in_air(flight, t_s),
            signals: &values,
        });
    };
    match flight.commands.is_empty() {
        true => times_of(flight, signals)
            .iter()
            .for_each(|t_s| sample(*t_s, &[])),
        false => flight
            .commands
            .rows()
            .for_each(|(t_s, row)| sample(t_s, row)),
    }
}

/// The times of the named signals, ascending and without duplicates.
fn times_of(flight: &Flight, signals: &[&str]) -> Vec<f64> {
    let signals = signals.iter().filter_map(|name| flight.signal(name));
    let mut times: Vec<f64> = signals.flat_map(|signal| signal.t_s).copied().collect();
    times.sort_by(f64::total_cmp);
    times.dedup();
    times
}

/// The typical distance between samples of a flight without motor commands.
fn step_s_of(flight: &Flight, signals: &[&str]) -> Option<f64> {
    if !flight.commands.is_empty() {
        return None;
    }
    let times = times_of(flight, signals);
    let later = times.iter().skip(1);
    let mut steps: Vec<f64> = later.zip(&times).map(|(to, from)| to - from).collect();
    steps.sort_by(f64::total_cmp);
    steps.get(steps.len() / 2).copied()
}

/// Whether the vehicle is in the air at `t_s`. If this is only derived or assumed, and not reported by the autopilot,
/// the result is `None` instead of `Some(true)`.
pub fn in_air(flight: &Flight, t_s: f64) -> Option<bool> {
    let is_assumed = flight.in_air.as_ref().is_some_and(|air| air.is_assumed);
    match flight.is_in_air(t_s) == Some(true) {
        true => (!is_assumed).then_some(true),
        false => Some(false),
    }
}
