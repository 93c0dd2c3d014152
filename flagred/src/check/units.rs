//! Warnings about numbers of a profile that seem to be in another unit: milliseconds, shares, percentages.

use alloc::{format, string::String, vec::Vec};

use fuzzy::{diagnostic::Diagnostic, tree::percentage_of_share};

use super::{ValuePositions, shown};
use crate::{
    accumulator::AccumulatorSettings,
    profile::{Profile, ProfileInput},
    source::{Motors, Signal, Source, Statistic},
};

/// The length of the longest window that causes no warning, in seconds.
const LONGEST_WINDOW_S: f64 = 600.0;
/// The longest `after_s` of a level that causes no warning, in seconds.
const LONGEST_WAIT_S: f64 = 30.0;
/// Finds windows and times that are so long that their unit is probably wrong.
pub(super) fn durations(profile: &Profile, at: &ValuePositions, found: &mut Vec<Diagnostic>) {
    let mut note = |path: &[&str], message: String, help: &str| {
        found.push(Diagnostic::warning("unit", at.of(path), message).help(help));
    };
    let window = "windows are in seconds; a risk over a longer window comes too late";
    let mut long = |path: &[&str], window_s: f64| {
        if window_s > LONGEST_WINDOW_S {
            let message = format!("the window of {window_s} s is longer than most flights");
            note(path, message, window);
        }
    };
    long(&["window_s"], profile.window_s);
    long(
        &["elevated_risk", "window_s"],
        profile.elevated_risk.window_s,
    );
    for input in &profile.inputs {
        if input.source.window_s.to_bits() != profile.window_s.to_bits() {
            long(&["inputs", &input.name, "window_s"], input.source.window_s);
        }
    }
    let (sampling, verdict) = (&profile.sampling, &profile.verdict);
    // The longest time of each kind that is not reported, and the effect of a longer one.
    let times: [(&[&str], f64, f64, &str); 6] = [
        (
            &["longest_gap_s"],
            sampling.longest_gap_s,
            600.0,
            "a loss of data this long does not count as a gap",
        ),
        (
            &["take_off_s"],
            sampling.take_off_s,
            60.0,
            "no take-off takes this long",
        ),
        (
            &["warm_up_s"],
            sampling.warm_up_s,
            600.0,
            "the risk is unknown for this time",
        ),
        (
            &["verdict", "clear_after_s"],
            verdict.clear_after_s,
            600.0,
            "a level is not lowered for this time",
        ),
        (
            &["verdict", "quiet_after_take_off_s"],
            verdict.quiet_after_take_off_s,
            120.0,
            "WARN is not raised in this time",
        ),
        (
            &["verdict", "quiet_before_landing_s"],
            verdict.quiet_before_landing_s,
            120.0,
            "a WARN in this time before a landing is withdrawn",
        ),
    ];
    for (path, time_s, longest_s, effect) in times {
        let key = path.last().unwrap_or(&"");
        if time_s > longest_s {
            let of_ms = match time_s >= 500.0 {
                true => format!("; {time_s} ms are `{}`", time_s / 1000.0),
                false => String::new(),
            };
            let help = format!("it is in seconds: write at most {longest_s}{of_ms}");
            note(path, format!("`{key}` is {time_s} s: {effect}"), &help);
        }
    }
    for (name, level) in [("warn", &verdict.warn), ("fail", &verdict.fail)] {
        if level.after_s > LONGEST_WAIT_S {
            let message = format!("`{name}` is raised only after {} s", level.after_s);
            let help = "`after_s` is in seconds; control can be lost within one second";
            note(&["verdict", name, "after_s"], message, help);
        }
    }
}

/// Finds limits of the elevated risk that are probably shares, although risks are in percent.
pub(super) fn elevated_shares(
    settings: &AccumulatorSettings,
    place: &[&str],
    at: &ValuePositions,
) -> Option<Diagnostic> {
    let AccumulatorSettings {
        high_pct, low_pct, ..
    } = *settings;
    (high_pct > 0.0 && high_pct <= 1.0).then(|| {
        let message =
            format!("the elevated risk rises from a risk of {high_pct} % on, at almost any time");
        let meant = match low_pct > 0.0 {
            true => format!(
                "`high: {}` and `low: {}`",
                shown(100.0 * high_pct),
                shown(100.0 * low_pct)
            ),
            false => format!("`high: {}`", shown(100.0 * high_pct)),
        };
        let place = at.of(&[place, &["high"]].concat());
        Diagnostic::warning("unit", place, message)
            .help(format!("risks are in percent: did you mean {meant}?"))
    })
}

/// Warns about a minimum of a divisor that the divisor never exceeds, so that the input is always divided by the
/// minimum.
pub(super) fn least_divisor(
    input: &ProfileInput,
    profile: &Profile,
    at: &ValuePositions,
) -> Option<Diagnostic> {
    let ratio = input.ratio.as_ref()?;
    let mut inputs = profile.inputs.iter();
    let (low, high) = range(&inputs.find(|other| other.name == ratio.per)?.source)?;
    let least = ratio.at_least;
    (least >= high).then(|| {
        let message = format!(
            "`{}` is from {low} to {high}, so `{}` is always divided by `at_least: {least}`",
            ratio.per, input.name
        );
        let place = at.of(&["inputs", &input.name, "at_least"]);
        let finding = Diagnostic::warning("unit", place, message);
        match Some(least / 100.0).filter(|share| least > 1.0 && *share < high) {
            Some(share) => finding.help(format!("did you mean `at_least: {share}`?")),
            None => finding.help(format!("write a number below {high}")),
        }
    })
}

/// Warns about a threshold or a percentile that seems to have another unit: a threshold that the signal never crosses,
/// or a percentile between 0 and 1.
pub(super) fn number_of_statistic<'k>(
    input: &ProfileInput,
    unit_of: impl Fn(&str) -> Option<&'k str>,
    at: &ValuePositions,
) -> Option<Diagnostic> {
    let source = &input.source;
    let finding = |key: &str, message: String, meant: Option<f64>| {
        let place = at.of(&["inputs", &input.name, key]);
        let finding = Diagnostic::warning("unit", place, message);
        Some(match meant {
            Some(meant) => finding.help(format!("did you mean `{key}: {meant}`?")),
            None => finding.help("write a threshold between these"),
        })
    };
    let (key, threshold) = match source.statistic {
        Statistic::ShareBelow(threshold) => ("share_below", threshold),
        Statistic::ShareAbove(threshold) => ("share_above", threshold),
        Statistic::Percentile(number) if number > 0.0 && number < 1.0 => {
            let message = format!("`percentile` is in percent, and {number} is a fraction");
            return finding("percentile", message, Some(percentage_of_share(number)));
        }
        _ => return None,
    };
    let name = match &source.signal {
        Signal::Named(name) => name,
        signal => Signal::name_of(signal)?,
    };
    let is_percent = unit_of(name) == Some("%");
    let (low, high) = match is_percent {
        true => (0.0, 100.0),
        false => range_of_signal(source),
    };
    let is_above = key == "share_above";
    let never = match is_above {
        true => threshold >= high,
        false => threshold <= low,
    };
    let always = match is_above {
        true => threshold < low,
        false => threshold > high,
    };
    let side = key.trim_start_matches("share_");
    let inside = |meant: &f64| *meant > low && *meant < high;
    let what = format!("`{name}` is from {low} to {high}");
    let message = match (never, always) {
        (true, _) => format!("{what}, so it is never {side} {threshold}"),
        (_, true) => format!("{what}, so it is always {side} {threshold}"),
        _ if is_percent && threshold < 1.0 => {
            format!("`{name}` is in percent, and {threshold} is a fraction")
        }
        _ => return None,
    };
    let meant = match is_percent {
        true => Some(percentage_of_share(threshold)),
        false => Some(threshold / 100.0).filter(|_| threshold > 1.0),
    };
    finding(key, message, meant.filter(inside))
}

/// The minimum and maximum of a signal, after the motors of a sample are combined.
fn range_of_signal(source: &Source) -> (f64, f64) {
    let (low, high) = match &source.signal {
        Signal::MotorMargin => (0.0, 0.5),
        Signal::MotorCommand | Signal::MotorMarginLowSide | Signal::MotorMarginHighSide => {
            (0.0, 1.0)
        }
        Signal::CommandNoise => (0.0, 1.0),
        _ => (f64::NEG_INFINITY, f64::INFINITY),
    };
    match source.motors {
        Motors::Std => (0.0, (high - low) / 2.0),
        Motors::Pooled | Motors::Mean | Motors::Min | Motors::Max | Motors::One(_) => (low, high),
    }
}

/// The minimum and maximum of the values of a source; `None` if the values are unbounded.
pub(super) fn range(source: &Source) -> Option<(f64, f64)> {
    let (low, high) = range_of_signal(source);
    let (low, high) = match source.statistic {
        Statistic::ShareBelow(_) | Statistic::ShareAbove(_) => (0.0, 1.0),
        Statistic::Std | Statistic::StdLessNoise => (0.0, (high - low) / 2.0),
        Statistic::Noise => (0.0, high - low),
        Statistic::Rate => return None,
        Statistic::Mean
        | Statistic::Rms
        | Statistic::Min
        | Statistic::Max
        | Statistic::Last
        | Statistic::Percentile(_) => (low, high),
    };
    high.is_finite().then_some((low, high))
}
