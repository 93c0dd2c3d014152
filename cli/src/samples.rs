//! From a flight to what is computed with: samples for the monitor and its windows, attitudes, the time that counts.

use flagred::{attitude::Attitude, evaluation::Span, monitor::Sample};
use flightlog::{Flight, Gap};

use crate::failure::Failure;

/// The signals that an attitude error is made of.
pub(crate) const ATTITUDE: [&str; 4] = ["roll_des_deg", "roll_deg", "pitch_des_deg", "pitch_deg"];

/// Without times in the header, so much at either end of a time in the air is taking off and landing, in seconds.
const ENDS_S: f64 = 10.0;

/// Those of the named signals that the flight carries.
pub(crate) fn carried<'a>(flight: &Flight, names: &[&'a str]) -> Vec<&'a str> {
    let names = names.iter().copied();
    names.filter(|name| flight.signal(name).is_some()).collect()
}

/// Every motor sample of a flight in turn: effective commands, and the named signals as they stood then.
pub(crate) fn each(flight: &Flight, names: &[&str], mut sample: impl FnMut(&Sample<'_>)) {
    let mut holds: Vec<_> = names
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
        sample(&Sample {
            t_s,
            motors: &motors,
            in_air: flight.is_in_air(t_s) == Some(true),
            signals: &signals,
        });
    }
}

/// The attitude over time, as often as roll was logged.
pub(crate) fn attitudes(flight: &Flight) -> impl Iterator<Item = (f64, Attitude)> + '_ {
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

/// What the header of a flight CSV says of itself: `kind`, `vehicle`.
pub(crate) fn header<'a>(flight: &'a Flight, key: &str) -> Option<&'a str> {
    let found = flight.header.iter().find(|(k, _)| k == key);
    found.map(|(_, value)| value.as_str())
}

/// From when to when a flight counts: as its header says, else all its time in the air but the ends.
pub(crate) fn judged_times(flight: &Flight) -> Vec<Span> {
    let number = |key| header(flight, key).and_then(|text| text.parse::<f64>().ok());
    let spans = match (number("judged_from_s"), number("judged_to_s")) {
        (Some(from_s), Some(to_s)) => vec![Span { from_s, to_s }],
        _ => {
            let spans = flight.in_air.iter().flat_map(|air| &air.spans);
            spans
                .map(|span| Span {
                    from_s: span.start_s + ENDS_S,
                    to_s: span.end_s - ENDS_S,
                })
                .collect()
        }
    };
    let is_some = |span: &Span| span.length_s() > 0.0;
    spans.into_iter().filter(is_some).collect()
}

/// Opens a flight that must carry motors, attitude and times in the air, with the named signals where it has them.
///
/// # Errors
///
/// Why it cannot be used; `cannot` says for what: `makes no rows`.
pub(crate) fn open_complete(
    path: impl AsRef<std::path::Path>,
    names: &[&str],
    cannot: &str,
) -> Result<Flight, Failure> {
    let path = path.as_ref();
    let wanted = names.iter().chain(&ATTITUDE).map(|name| (*name).to_owned());
    let options = flightlog::Options {
        signals: Some(wanted.collect()),
    };
    let flight = flightlog::open(path, &options)?;
    let gaps = flight.gaps();
    match gaps.iter().find(|gap| !matches!(gap, Gap::TooSlow { .. })) {
        None => Ok(flight),
        Some(gap) => {
            let failure = Failure::unreadable(format!("`{}` {cannot}: {gap}", path.display()));
            Err(gap.help().into_iter().fold(failure, Failure::help))
        }
    }
}
