//! `flagred convert`: written flights are read back unchanged.

use std::path::Path;

use flagred::{
    flight::{Reason, Verdict},
    log::assess,
    shipped,
};
use flagred_flightlog::{Flight, Gap, Options};
use flagred_tests::{Folder, STEADY, flagred, log_writer::ULog, reference_data};

fn open(path: &Path) -> Flight {
    flagred_flightlog::open(path, &Options::default()).unwrap()
}

fn converted(log: &Path) -> Flight {
    let folder = Folder::new();
    let csv = folder.at("converted.csv");
    let status = flagred()
        .arg("convert")
        .arg(log)
        .arg("-o")
        .arg(&csv)
        .status()
        .unwrap();
    assert!(status.success());
    open(Path::new(&csv))
}

/// Commands, ranges and statistics are the same to the last bit; signals keep their latest value between rows.
fn compare(log: &Path) {
    let (flight, again) = (open(log), converted(log));
    assert!(again.report.is_clean(), "{:?}", again.report);
    assert_eq!(again.commands.t_s(), flight.commands.t_s());
    assert_eq!(again.statistics(), flight.statistics());
    assert_eq!(
        again.full_range_statistics(),
        flight.full_range_statistics()
    );
    assert_eq!(again.vehicle.kind, flight.vehicle.kind);
    for signal in flight.signals() {
        let name = &signal.label.name;
        let copy = again
            .signal(name)
            .unwrap_or_else(|| panic!("{name} is lost"));
        for &t_s in flight.commands.t_s() {
            assert_eq!(copy.at(t_s), signal.at(t_s), "{name} at {t_s}");
        }
    }
}

#[test]
fn the_shipped_flight_is_the_same_as_csv() {
    compare(Path::new(STEADY));
}

#[test]
#[ignore = "needs FLAGRED_SHARED"]
fn flights_of_other_formats_are_the_same_as_csv() {
    let data = reference_data();
    for log in [
        "px_quadlocal.ulg",
        "px_esc.ulg",
        "aptxt_mechanical_fail.log",
    ] {
        compare(&data.join("logs").join(log));
    }
}

/// The CSV of a log has the same verdict, reason, findings and summary.
fn compare_assessments(log: &Path) {
    let Ok(flight) = flagred_flightlog::open(log, &Options::default()) else {
        return;
    };
    let mut csv = Vec::new();
    flight.write_csv(&mut csv).unwrap();
    let again = flagred_flightlog::read(&csv[..], &Options::default()).unwrap();
    for estimator in [shipped::flagred(), shipped::flagred_paper()] {
        let [of_log, of_csv] = [&flight, &again].map(|flight| assess(flight, &estimator, None));
        let reason = |verdict: &Verdict| match verdict {
            // The CSV names another source of the vehicle's kind, so only the kind is compared.
            Verdict::NotAvailable(Reason::Log(Gap::NotAMultirotor { kind, .. })) => {
                kind.to_string()
            }
            // A CSV has no parameters, so its reason cannot name the parameter that may be the cause.
            Verdict::NotAvailable(Reason::Log(Gap::NoCommands { .. })) => "no commands".into(),
            Verdict::NotAvailable(reason) => reason.to_string(),
            Verdict::Known(level) => level.to_string(),
        };
        let name = log.display();
        assert_eq!(reason(&of_csv.verdict), reason(&of_log.verdict), "{name}");
        assert_eq!(of_csv.findings, of_log.findings, "{name}");
        assert_eq!(of_csv.summary, of_log.summary, "{name}");
    }
}

#[test]
fn the_shipped_flights_are_assessed_alike_as_csv() {
    let flights = Path::new(STEADY).parent().unwrap();
    let logs = std::fs::read_dir(flights).unwrap();
    let logs: Vec<_> = logs.map(|entry| entry.unwrap().path()).collect();
    assert!(logs.iter().any(|log| log == Path::new(STEADY)));
    logs.iter().for_each(|log| compare_assessments(log));
}

/// The motors stop long before the log ends: the landing is between two rows.
#[test]
fn a_landing_between_two_motor_commands_is_the_same_as_csv() {
    let mut log = ULog::new(1_000_000);
    log.define("actuator_motors:uint64_t timestamp;float[12] control;");
    log.define("vehicle_land_detected:uint64_t timestamp;bool landed;");
    log.parameter("CA_ROTOR_COUNT", 4.0);
    log.announce(0, 1, "actuator_motors");
    log.announce(0, 2, "vehicle_land_detected");
    let mut controls = [f32::NAN; 12];
    controls[..4].fill(0.4);
    for second in 0..240 {
        let us = 1_000_000 * (second + 1);
        log.flags(2, us + 500, &[u8::from(!(3..60).contains(&second))]);
        // No commands are logged after the landing, except in the last seconds.
        if !(60..230).contains(&second) {
            for row in 0..20 {
                log.floats(1, us + 50_000 * row + 1000, &controls);
            }
        }
    }
    let folder = Folder::new();
    let log = folder.file("landing.ulg", &log.bytes);
    let flight = open(Path::new(&log));
    let again = converted(Path::new(&log));
    assert_eq!(
        flight.in_air.as_ref().unwrap().spans,
        again.in_air.unwrap().spans
    );
    assert_eq!(flight.commands, again.commands);
    assert_eq!(
        assess(&flight, &shipped::flagred(), None)
            .verdict
            .to_string(),
        "GOOD"
    );
    compare_assessments(Path::new(&log));
}

#[test]
#[ignore = "needs FLAGRED_SHARED"]
fn all_logs_are_assessed_alike_as_csv() {
    let data = reference_data();
    let mut count = 0;
    for folder in [
        "flights",
        "logs",
        "real/flights",
        "real2/flights",
        "real2/logs",
    ] {
        let Ok(entries) = std::fs::read_dir(data.join(folder)) else {
            continue;
        };
        for entry in entries {
            let log = entry.unwrap().path();
            if log.is_file()
                && log
                    .extension()
                    .is_none_or(|end| end != "json" && end != "md")
            {
                compare_assessments(&log);
                count += 1;
            }
        }
    }
    assert!(count > 90, "{count}");
}

#[test]
fn standard_output_and_failures() {
    let output = flagred()
        .arg("convert")
        .arg(STEADY)
        .args(["-o", "-"])
        .output()
        .unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(
        text.starts_with(
            "# vehicle: QUAD/X\n# system_id: 1\n# boot_count: 1\n# vehicle_kind: multirotor\n"
        ),
        "{}",
        &text[..200]
    );
    assert!(text.contains("\nt_s,pwm1,pwm2,pwm3,pwm4,in_air,roll_des_deg,"));

    let mut refused = flagred();
    refused
        .arg("convert")
        .arg(STEADY)
        .args(["-o", "/no/such/folder/x.csv"]);
    let output = refused.output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(
        String::from_utf8_lossy(&output.stderr)
            .contains("`/no/such/folder/x.csv` cannot be written")
    );
}

#[test]
fn an_unknown_flight_state_stays_unknown_in_csv() {
    let mut log = ULog::new(1_000_000);
    log.define("actuator_motors:uint64_t timestamp;float[12] control;");
    log.parameter("CA_ROTOR_COUNT", 4.0);
    log.announce(0, 1, "actuator_motors");
    for row in 0..50 {
        log.floats(1, 1_000_000 + 100_000 * row, &[0.4; 12]);
    }
    let flight = flagred_flightlog::read(&log.bytes[..], &Options::default()).unwrap();
    assert_eq!(flight.in_air, None);
    let mut csv = Vec::new();
    flight.write_csv(&mut csv).unwrap();
    let again = flagred_flightlog::read(&csv[..], &Options::default()).unwrap();
    assert_eq!((again.in_air, again.commands.len()), (None, 50));
    // A row with an empty cell has the state of the row before it.
    let csv = "t_s,motor1,in_air\n0,0.5,1\n1,0.5,\n2,0.5,0\n3,0.5,\n";
    let flight = flagred_flightlog::read(csv.as_bytes(), &Options::default()).unwrap();
    let in_air = [0.5, 1.5, 2.5, 3.0].map(|t_s| flight.is_in_air(t_s));
    assert_eq!(in_air, [Some(true), Some(true), Some(false), Some(false)]);
}

#[test]
fn a_log_without_motor_commands_does_not_grow() {
    let csv = "t_s,in_air,altitude_m\n0,0,1\n1,0,2\n2,1,3\n3,1,4\n4,0,5\n5,0,6\n";
    let flight = flagred_flightlog::read(csv.as_bytes(), &Options::default()).unwrap();
    let mut written = Vec::new();
    flight.write_csv(&mut written).unwrap();
    let written = String::from_utf8(written).unwrap();
    assert!(written.ends_with(csv), "{written}");
}
