//! `flagred convert`: what is written is read back the same.

use std::path::Path;

use flagred_tests::{Folder, STEADY, flagred, log_writer::ULog, reference_data};
use flightlog::{Flight, Options};

fn open(path: &Path) -> Flight {
    flightlog::open(path, &Options::default()).unwrap()
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

/// Commands, ranges and statistics are the same to the last bit; signals are held.
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
fn whether_in_the_air_stays_unknown() {
    let mut log = ULog::new(1_000_000);
    log.define("actuator_motors:uint64_t timestamp;float[12] control;");
    log.parameter("CA_ROTOR_COUNT", 4.0);
    log.announce(0, 1, "actuator_motors");
    for row in 0..50 {
        log.floats(1, 1_000_000 + 100_000 * row, &[0.4; 12]);
    }
    let flight = flightlog::read(&log.bytes[..], &Options::default()).unwrap();
    assert_eq!(flight.in_air, None);
    let mut csv = Vec::new();
    flight.write_csv(&mut csv).unwrap();
    let again = flightlog::read(&csv[..], &Options::default()).unwrap();
    assert_eq!((again.in_air, again.commands.len()), (None, 50));
    // A cell that says nothing changes nothing.
    let csv = "t_s,motor1,in_air\n0,0.5,1\n1,0.5,\n2,0.5,0\n3,0.5,\n";
    let flight = flightlog::read(csv.as_bytes(), &Options::default()).unwrap();
    let in_air = [0.5, 1.5, 2.5, 3.0].map(|t_s| flight.is_in_air(t_s));
    assert_eq!(in_air, [Some(true), Some(true), Some(false), Some(false)]);
}
