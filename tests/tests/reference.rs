//! The monitor with the rules and the profile of the first version, held against another program: `tests/data/reference` was computed with numpy from
//! the same flights, straight from the definitions, with the rules written out by hand. One row a second.

use std::path::Path;

use approx::assert_abs_diff_eq;
use flagred::{
    estimator::Estimator,
    monitor::{Craft, Monitor, Sample},
    profile::Profile,
    verdict::Level,
};
use flagred_tests::reference_data;

/// Name, log, and when the clock of the reference starts in that of the log, in seconds.
const FLIGHTS: [(&str, &str, f64); 5] = [
    ("f000", "sitl2/timeseries/f000.csv.gz", 0.0),
    ("f030", "sitl2/timeseries/f030.csv.gz", 0.0),
    ("steady", "flights/steady.BIN", 45.609_249),
    ("intermittent", "flights/intermittent.BIN", 45.569_265),
    ("octoquad_crash", "flights/octoquad_crash.BIN", 45.609_249),
];

#[test]
#[ignore = "needs FLAGRED_SHARED"]
fn inputs_risks_and_verdicts_are_those_of_an_independent_computation() {
    let data = reference_data();
    for (name, log, start_s) in FLIGHTS {
        compare(name, &data.join(log), start_s);
    }
}

fn compare(name: &str, log: &Path, start_s: f64) {
    let read = |file: &str| std::fs::read_to_string(format!("data/reference/{file}")).unwrap();
    let mut profile: Profile = read("profile.yaml").parse().unwrap();
    // The reference was computed before these were made slower.
    profile.elevated_risk.rise_pct_per_s = 2.0;
    profile.elevated_risk.fall_pct_per_s = 3.0;
    let rules = read("rules.yaml").parse().unwrap();
    let estimator = Estimator::new(&profile, &rules).unwrap();
    let flight = flightlog::open(log, &flightlog::Options::default()).unwrap();
    let mut monitor = Monitor::new(&estimator, Craft::new(flight.motors.len())).unwrap();

    let reference = std::fs::read_to_string(format!("data/reference/{name}.csv")).unwrap();
    let mut reference = reference.lines().skip(1).map(row).peekable();
    let (mut compared, mut warned) = (0, 0);
    for (t_s, raw) in flight.commands.rows() {
        let commands = raw.iter().map(|raw| flight.effective_command(*raw));
        let motors: Vec<f64> = commands.map(|e| e.unwrap_or(f64::NAN)).collect();
        let in_air = flight.is_in_air(t_s) == Some(true);
        let assessment = monitor.push(&Sample {
            t_s,
            motors: &motors,
            in_air,
            signals: &[],
        });
        let Some(expected) = reference.next_if(|row| row[0] <= t_s - start_s + 1e-3) else {
            continue;
        };
        assert_abs_diff_eq!(expected[0], t_s - start_s, epsilon = 1e-3);
        assert_eq!(expected[1] == 1.0, in_air, "{name} at {t_s} s");
        // In the first second the reference makes do with fewer samples than the monitor.
        let (Ok(estimate), Some(elevated)) = (assessment.risk, assessment.elevated_risk_pct) else {
            continue;
        };
        compared += 1;
        // The logs are not quite even in time, which the monitor weighs and the reference does not; above
        // 128 samples a window counts its oldest ones together.
        for (input, value) in monitor.inputs().iter().enumerate() {
            assert_abs_diff_eq!(*value, expected[2 + input], epsilon = 3e-4);
        }
        assert_abs_diff_eq!(estimate.risk_pct, expected[6], epsilon = 0.6);
        assert_abs_diff_eq!(elevated, expected[7], epsilon = 0.02);
        let level = assessment.level.unwrap_or(Level::Good);
        let expected = [Level::Good, Level::Warn, Level::Fail][expected[8] as usize];
        assert_eq!(level, expected, "{name} at {t_s} s");
        warned += u32::from(level > Level::Good);
    }
    assert!(compared > 100, "{name}: only {compared} rows compared");
    let quiet = matches!(name, "f000" | "steady");
    assert_eq!(warned == 0, quiet, "{name}: {warned} rows not GOOD");
}

/// The numbers of a line; NaN where there is none.
fn row(line: &str) -> Vec<f64> {
    line.split(',')
        .map(|cell| cell.parse().unwrap_or(f64::NAN))
        .collect()
}
