//! Reads a flight log several times and prints the speed, for `logs.py`.
//!
//! `read-log LOG RUNS [SIGNAL...]`: if signals are named, only these are decoded; with `none`, only the motor commands.
//! Prints one line of JSON.

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let log = arguments.next().ok_or("which log?")?;
    let runs: u32 = arguments.next().ok_or("how many runs?")?.parse()?;
    let signals: Vec<String> = arguments.collect();
    let mut options = flagred_flightlog::Options::default();
    options.signals = (!signals.is_empty()).then_some(signals);
    let mut flight = None;
    let start_s = cpu_s()?;
    for _ in 0..runs {
        drop(flight.take());
        flight = Some(flagred_flightlog::open(&log, &options)?);
    }
    let seconds = (cpu_s()? - start_s) / f64::from(runs);
    let flight = flight.ok_or("at least one run")?;
    let rows = |name: &str| flight.signal(name).map_or(0, |signal| signal.values.len());
    println!(
        "{{\"seconds\": {seconds}, \"bytes\": {}, \"commands\": {}, \"attitude\": {}, \"peak_kib\": {}}}",
        flight.report.bytes,
        flight.commands.len(),
        rows("roll_deg"),
        peak_kib(),
    );
    Ok(())
}

/// The CPU time of this process in seconds. CPU time is measured for the other programs too, because wall-clock time
/// includes the load of other processes. Linux reports CPU time in nanoseconds, but updates it rarely.
fn cpu_s() -> Result<f64, Box<dyn std::error::Error>> {
    let used = std::fs::read_to_string("/proc/self/schedstat")?;
    let ns = used.split_whitespace().next().ok_or("no CPU time")?;
    Ok(ns.parse::<f64>()? * 1e-9)
}

/// The peak memory of the process in KiB; 0 if the system does not report it.
fn peak_kib() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let number = line.and_then(|line| line.split_whitespace().next());
    number.and_then(|number| number.parse().ok()).unwrap_or(0)
}
