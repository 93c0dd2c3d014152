//! Fuzz targets for flight logs: reading logs, and writing their contents.

use flagred_cli::fuzzing::{converted, documents};
use flagred_flightlog::{Flight, Options, ReadError};

use super::{SHIPPED, assert_harmless, without};

fn read(bytes: &[u8]) -> Option<Flight> {
    match flagred_flightlog::read(bytes, &Options::default()) {
        Ok(flight) => Some(flight),
        Err(ReadError::Io { source, .. }) => panic!("{source}"),
        Err(_) => None,
    }
}

/// Checks that any bytes are read as a flight or rejected with an error. The format is detected from the content.
pub fn flight_log(bytes: &[u8]) {
    if let Some(flight) = read(bytes) {
        check(&flight, bytes);
    }
}

/// Asserts the invariants of every flight, however damaged its log is.
pub fn check(flight: &Flight, log: &[u8]) {
    let report = &flight.report;
    assert!(report.skipped_bytes <= report.bytes);
    assert!(report.is_clean() || report.reason.is_some(), "{report:?}");
    assert!(flight.commands.t_s().is_sorted());
    assert!(flight.commands.t_s().iter().all(|t_s| t_s.is_finite()));
    // Every value occupies at least one byte of the log.
    let values: usize = flight.series.iter().map(|series| series.t_s().len()).sum();
    let bytes = log.len().max(report.bytes as usize);
    assert!(flight.commands.len() + values <= 40 * bytes);
    for signal in flight.signals() {
        assert!(signal.t_s.is_sorted(), "{}", signal.label.name);
        assert_eq!(signal.t_s.len(), signal.values.len());
    }
    for range in flight.range.iter().chain([&flight.effective_range]) {
        assert!(range.high > range.low, "{range:?}");
    }
    for intervals in flight.in_air.iter().chain(&flight.armed) {
        let ends = |span: &flagred_flightlog::Interval| span.end_s >= span.start_s;
        assert!(intervals.spans.iter().all(ends), "{intervals:?}");
    }
    if let Ok(statistics) = flight.statistics() {
        for value in [
            statistics.margin_mean,
            statistics.margin_min,
            statistics.margin_std,
        ] {
            assert!((0.0..=0.5).contains(&value), "{statistics:?}");
        }
        for value in [statistics.command_mean, statistics.command_std] {
            assert!((0.0..=1.0).contains(&value), "{statistics:?}");
        }
    }
    is_read_back(flight);
}

/// Checks that any flight written as CSV is read back with the same samples, and that writing it again gives the same
/// lines.
pub fn csv(bytes: &[u8]) {
    if let Some(flight) = read(bytes) {
        is_read_back(&flight);
    }
}

fn is_read_back(flight: &Flight) {
    let written = converted(flight).unwrap();
    if flight.commands.is_empty() {
        return;
    }
    let text = String::from_utf8_lossy(&written);
    let again = flagred_flightlog::read(&written[..], &Options::default());
    let again = again.unwrap_or_else(|error| panic!("{error}\n{text}"));
    assert_eq!(again.commands.t_s(), flight.commands.t_s());
    for ((t_s, row), (_, same)) in flight.commands.rows().zip(again.commands.rows()) {
        let bits = |flight: &Flight, row: &[f64]| -> Vec<Option<u64>> {
            let known = row.iter().map(|raw| flight.command(*raw));
            known.map(|known| known.map(f64::to_bits)).collect()
        };
        assert_eq!(bits(&again, same), bits(flight, row), "at {t_s} s");
        // If the state changes for less than a second, the log and the CSV may ignore the change at different rows.
        let in_air = again.is_in_air(t_s);
        let mut near = flight
            .commands
            .t_s()
            .iter()
            .filter(|t| (**t - t_s).abs() <= 1.0);
        assert!(
            near.any(|t_s| flight.is_in_air(*t_s) == in_air),
            "{in_air:?} at {t_s} s"
        );
    }
    let twice = converted(&again).unwrap();
    assert_same_lines(&written, &twice, true);
    let again = flagred_flightlog::read(&twice[..], &Options::default()).unwrap();
    assert_same_lines(&twice, &converted(&again).unwrap(), false);
}

/// Asserts that two tables are the same. With `flicker`, times in the air may differ: a landing of about a second may be lost,
/// because its ends have moved to the times of rows.
fn assert_same_lines(one: &[u8], other: &[u8], flicker: bool) {
    let text = |bytes| std::str::from_utf8(bytes).unwrap();
    // The motors of a CSV are identified by their columns.
    let lines = |bytes| str::lines(text(bytes)).filter(|line| !line.starts_with("# motor"));
    let head = lines(one)
        .find(|line| line.starts_with("t_s,"))
        .unwrap_or("");
    let column = head.split(',').position(|name| name == "in_air");
    let column = column.filter(|_| flicker);
    let without = |line: &str| -> Vec<String> {
        let cells = line.split(',').enumerate();
        let cells = cells.filter(|(i, _)| Some(*i) != column);
        cells.map(|(_, cell)| cell.to_owned()).collect()
    };
    for (line, same) in lines(one).zip(lines(other)) {
        assert_eq!(without(same), without(line));
    }
    assert_eq!(lines(other).count(), lines(one).count());
}

/// Checks the outputs for any flight: text is safe on a terminal, documents are JSON, and pages are markup.
pub fn report(bytes: &[u8]) {
    let Some(flight) = read(bytes) else {
        return;
    };
    let said = documents("a\u{1b}[2Jflight<b>.bin", flight, &SHIPPED).unwrap();
    let words = without("m", std::str::from_utf8(&said.words).unwrap());
    assert_harmless(&words);
    for json in &said.json {
        serde_json::from_str::<serde_json::Value>(json).unwrap();
    }
    assert_harmless(std::str::from_utf8(&said.csv).unwrap());
    for page in &said.pages {
        assert!(!page.contains("<b>.bin"));
        assert_harmless(page);
    }
}
