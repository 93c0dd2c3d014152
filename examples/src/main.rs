//! Follow a flight from a program of your own: `cargo run -p flagred-examples`.
//!
//! A log becomes samples, samples go through the monitor, and what is said is when the level changed. The other
//! examples are the numbered pages beside this program.

use std::error::Error;

use flagred::{
    estimator::Estimator,
    monitor::{Monitor, Sample},
    shipped,
    verdict::Level,
};

/// When the level of risk changed in a flight, in seconds on the log's clock.
fn changes(log: &str) -> Result<Vec<(f64, Level)>, Box<dyn Error>> {
    let flight = flightlog::open(log, &flightlog::Options::default())?;
    let profile = shipped::profile("flagred").ok_or("not shipped")??;
    let rules = shipped::rule_set(&profile.rules).ok_or("not shipped")??;
    let estimator = Estimator::new(&profile, &rules)?;
    let mut monitor = Monitor::new(&estimator, flight.motors.len(), &[])?;
    let mut changes = Vec::new();
    for (t_s, row) in flight.commands.rows() {
        let effective = |raw: &f64| flight.effective_command(*raw).unwrap_or(f64::NAN);
        let motors: Vec<f64> = row.iter().map(effective).collect();
        let in_air = flight.is_in_air(t_s) == Some(true);
        let sample = Sample {
            t_s,
            motors: &motors,
            in_air,
            signals: &[],
        };
        changes.extend(monitor.push(&sample).change.map(|level| (t_s, level)));
    }
    Ok(changes)
}

#[allow(clippy::print_stdout)]
fn main() -> Result<(), Box<dyn Error>> {
    let log = std::env::args().nth(1);
    let log =
        log.unwrap_or_else(|| concat!(env!("CARGO_MANIFEST_DIR"), "/flights/steady.BIN").into());
    let changes = changes(&log)?;
    for (t_s, level) in &changes {
        println!("{t_s:.1} s: {level:?}");
    }
    println!("{} changes of level", changes.len());
    Ok(())
}

#[cfg(test)]
mod tests {
    #[test]
    fn a_steady_wind_changes_nothing() {
        let log = concat!(env!("CARGO_MANIFEST_DIR"), "/flights/steady.BIN");
        assert_eq!(super::changes(log).unwrap(), []);
    }
}
