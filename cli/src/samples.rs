//! From a flight to the samples that the monitor and its windows take.

use flagred::monitor::Sample;
use flightlog::Flight;

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
