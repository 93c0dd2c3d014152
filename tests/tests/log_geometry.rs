//! The motor geometry of the flights of the reference data.

use std::{fs, io::Read, path::Path};

use flagred_flightlog::{Basis, Flight, Options};
use flagred_tests::reference_data;

fn open(path: &Path) -> Flight {
    flagred_flightlog::open(path, &Options::default()).unwrap()
}

/// A flight CSV with a frame in its header.
fn declared(path: &Path, frame: &str) -> Flight {
    let mut log = format!("# frame: {frame}\n");
    let file = fs::File::open(path).unwrap();
    flate2::read::GzDecoder::new(file)
        .read_to_string(&mut log)
        .unwrap();
    flagred_flightlog::read(log.as_bytes(), &Options::default()).unwrap()
}

/// The geometry of a log: the frame, how certain it is, and its source.
fn reported(flight: &Flight) -> Option<(Option<&str>, Basis, &str)> {
    let geometry = flight.geometry.as_ref()?;
    Some((
        geometry.frame.as_deref(),
        geometry.basis,
        geometry.source.as_str(),
    ))
}

#[test]
#[ignore = "needs FLAGRED_SHARED"]
fn the_geometry_of_logs_is_read() {
    let data = reference_data();
    for (log, frame, source) in [
        (
            "logs/ap_beast_mechfail36.bin",
            Some("QUAD/X"),
            "frame `QUAD`, FRAME = 1",
        ),
        (
            "logs/ap_beast_sample.bin",
            Some("QUAD/X"),
            "FRAME_CLASS = 1, FRAME_TYPE = 1",
        ),
        (
            "logs/ap_delorean183.bin",
            Some("QUAD/PLUS"),
            "FRAME_CLASS = 1, FRAME_TYPE = 0",
        ),
        (
            "logs/ap_maik17.bin",
            Some("QUAD/X"),
            "FRAME_CLASS = 1, FRAME_TYPE = 1",
        ),
        (
            "logs/aptxt_mechanical_fail.log",
            Some("QUAD/X"),
            "4 motors, FRAME = 1",
        ),
        ("logs/px_3dr1.ulg", Some("HEXA/X"), "SYS_AUTOSTART = 6021"),
        ("logs/px_esc.ulg", Some("QUAD/X"), "SYS_AUTOSTART = 4006"),
        ("logs/px_events.ulg", None, "CA_ROTORn_PX, PY, KM"),
        ("logs/px_quadlocal.ulg", None, "CA_ROTORn_PX, PY, KM"),
        (
            "flights/octoquad.BIN",
            Some("OCTAQUAD/X"),
            "FRAME_CLASS = 4, FRAME_TYPE = 1",
        ),
        (
            "flights/octoquad_crash.BIN",
            Some("OCTAQUAD/X"),
            "FRAME_CLASS = 4, FRAME_TYPE = 1",
        ),
        (
            "flights/steady.BIN",
            Some("QUAD/X"),
            "FRAME_CLASS = 1, FRAME_TYPE = 1",
        ),
    ] {
        let flight = open(&data.join(log));
        assert_eq!(
            reported(&flight),
            Some((frame, Basis::Declared, source)),
            "{log}"
        );
        let geometry = flight.geometry.unwrap();
        assert_eq!(geometry.doubt, None, "{log}");
        assert_eq!(geometry.factors.len(), flight.motors.len(), "{log}");
        // The motors are, in this order: front right, rear left, front left, rear right. ArduPilot and PX4 agree on
        // this order.
        let signs = |f: &[f64; 3]| f.map(|x| if x.abs() < 0.5 { 0.0 } else { x.signum() });
        if flight.motors.len() == 4 && frame != Some("QUAD/PLUS") {
            let found: Vec<[f64; 3]> = geometry.factors.iter().map(signs).collect();
            let x = [
                [-1.0, 1.0, 1.0],
                [1.0, -1.0, 1.0],
                [1.0, 1.0, -1.0],
                [-1.0, -1.0, -1.0],
            ];
            assert_eq!(found, x, "{log}");
        }
    }
    assert_eq!(open(&data.join("logs/tl_vtol.tlog")).geometry, None);
}

/// The simulated hexarotors and octorotors do not declare their layouts: none is mistaken for another, and a wrong declared
/// frame is reported.
#[test]
#[ignore = "needs FLAGRED_SHARED"]
fn layouts_of_six_and_eight_motors_are_found_and_contradictions_reported() {
    let data = reference_data();
    let (mut found, mut all, mut told_wrong) = (0, 0, 0);
    for folder in ["sitl2/timeseries", "sitl3/timeseries"] {
        for entry in fs::read_dir(data.join(folder)).unwrap() {
            let path = entry.unwrap().path();
            let flight = open(&path);
            let (expected, wrong) = match flight.motors.len() {
                6 => ("HEXA/X", "HEXA/DJI_X"),
                8 => ("OCTAQUAD/X", "OCTA/X"),
                _ => continue,
            };
            all += 1;
            if let Some(geometry) = &flight.geometry {
                found += 1;
                assert_eq!(geometry.basis, Basis::Inferred);
                assert_eq!(
                    geometry.frame.as_deref(),
                    Some(expected),
                    "{}",
                    path.display()
                );
            }
            let right = declared(&path, expected).geometry.unwrap();
            assert_eq!(right.doubt, None, "{}", path.display());
            told_wrong += usize::from(declared(&path, wrong).geometry.unwrap().doubt.is_some());
        }
    }
    eprintln!("{found} of {all} found, {told_wrong} wrong ones told");
    assert!(all > 60 && 10 * found >= 9 * all && 10 * told_wrong >= 9 * all);
}

/// On quadrotors, only the attitude indicates the frame: a correct frame is not doubted, a wrong one often is.
#[test]
#[ignore = "needs FLAGRED_SHARED"]
fn wrong_frames_of_quadrotors_are_detected_by_their_attitude() {
    let data = reference_data();
    let (mut all, mut reported) = (0, 0);
    for entry in fs::read_dir(data.join("sitl2/timeseries")).unwrap() {
        let path = entry.unwrap().path();
        if open(&path).motors.len() != 4 {
            continue;
        }
        let right = declared(&path, "QUAD/X");
        all += 1;
        assert_eq!(right.geometry.unwrap().doubt, None, "{}", path.display());
        reported += usize::from(
            declared(&path, "QUAD/BF_X")
                .geometry
                .unwrap()
                .doubt
                .is_some(),
        );
    }
    eprintln!("{reported} of {all} wrong frames told");
    assert!(all > 100 && 2 * reported > all);
}
