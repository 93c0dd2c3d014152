//! Determines which flights can be used for learning and evaluation, and which part of their time is judged.

use flagred::verdict::VerdictSettings;
use flagred_flightlog::{ATTITUDE, Flight, Gap, LeftOutCounts, Options};

use crate::span::Span;

/// The reason why a flight is not complete: see [`complete`].
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Incomplete {
    /// The log exceeds the limits of the reader, so part of the log was left out.
    #[error("the log exceeds the limits of the reader; left out: {0}")]
    LeftOut(LeftOutCounts),
    /// Required information is missing from the log.
    #[error(transparent)]
    Gap(Gap),
}

impl Incomplete {
    /// Advice on what to do, in addition to the message.
    pub fn help(&self) -> Option<&'static str> {
        match self {
            Incomplete::LeftOut(_) => Some("docs/limits.md lists the limits"),
            Incomplete::Gap(gap) => gap.help(),
        }
    }
}

/// Returns the options for reading a log for learning or evaluation: they request the named signals and the attitude.
pub fn complete_options(names: &[&str]) -> Options {
    let wanted = names.iter().chain(&ATTITUDE).map(|name| (*name).to_owned());
    let mut options = Options::default();
    options.signals = Some(wanted.collect());
    options
}

/// Checks that a flight can be used for learning and evaluation: it must contain motors, attitude and times in the air, and
/// the reader must not have left anything out.
///
/// # Errors
/// Returns the missing information.
pub fn complete(flight: &Flight) -> Result<(), Incomplete> {
    let left_out = &flight.report.left_out;
    if left_out.messages > 0 || left_out.changes > 0 {
        return Err(Incomplete::LeftOut(left_out.clone()));
    }
    let mut gaps = flight.gaps().into_iter();
    let gap = gaps.find(|gap| !matches!(gap, Gap::TooSlow { .. }));
    gap.map_or(Ok(()), |gap| Err(Incomplete::Gap(gap)))
}

/// The value of a key in the header of a flight CSV, such as `kind` or `vehicle`.
pub fn header<'a>(flight: &'a Flight, key: &str) -> Option<&'a str> {
    let found = flight.header.iter().find(|(k, _)| k == key);
    found.map(|(_, value)| value.as_str())
}

/// The judged time in the header of a flight CSV: from `judged_from_s` to `judged_to_s`.
pub fn judged_by_header(flight: &Flight) -> Option<Span> {
    let number = |key| header(flight, key)?.parse().ok();
    Some(Span {
        from_s: number("judged_from_s")?,
        to_s: number("judged_to_s")?,
    })
}

/// The judged time that the flight's header defines. If the header defines none, each time in the air except the
/// first seconds after take-off and the last seconds before landing.
pub fn judged_spans(flight: &Flight, settings: &VerdictSettings) -> Vec<Span> {
    if let Some(span) = judged_by_header(flight) {
        return Vec::from_iter((span.length_s() > 0.0).then_some(span));
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

/// The judged part of a time in the air: without the first seconds after take-off and the last before landing.
///
/// `None` if nothing remains. A flight whose log ends in the air has no landing.
fn judged_span(air: Span, ends_with_log: bool, settings: &VerdictSettings) -> Option<Span> {
    let before_landing_s = match ends_with_log {
        true => 0.0,
        false => settings.quiet_before_landing_s,
    };
    let judged = Span {
        from_s: air.from_s + settings.quiet_after_take_off_s,
        to_s: air.to_s - before_landing_s,
    };
    (judged.length_s() > 0.0).then_some(judged)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn assessed_time_excludes_take_off_and_landing() {
        let settings = VerdictSettings::default();
        let air = Span {
            from_s: 10.0,
            to_s: 30.0,
        };
        let judged = judged_span(air, false, &settings).unwrap();
        assert_eq!((judged.from_s, judged.to_s), (15.0, 29.0));
        assert_eq!(judged_span(air, true, &settings).unwrap().to_s, 30.0);
        let hop = Span {
            from_s: 10.0,
            to_s: 12.0,
        };
        assert_eq!(judged_span(hop, false, &settings), None);
    }
}
