use crate::{Basis, Flight, Options};

/// Reads a flight CSV with commands computed by a mixer, and an attitude error that follows the roll and pitch efforts
/// of the mixer.
fn flight(header: &str, mixer: &[[f64; 3]]) -> Flight {
    read(header, mixer, false)
}

/// As [`flight`], with or without the outputs of the rate controllers.
fn read(header: &str, mixer: &[[f64; 3]], with_outputs: bool) -> Flight {
    let mut log = format!("{header}t_s");
    for motor in 1..=mixer.len() {
        log += &format!(",motor{motor}");
    }
    log += ",roll_des_deg,roll_deg,pitch_des_deg,pitch_deg";
    log += if with_outputs {
        ",roll_output,pitch_output,yaw_output\n"
    } else {
        "\n"
    };
    let mut state = 1_u64;
    let mut random = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (state >> 33) as f64 / f64::from(1_u32 << 30) - 1.0
    };
    for row in 0..300 {
        let [thrust, roll, pitch, yaw, noise] = [(); 5].map(|()| random());
        log += &format!("{}", 0.1 * f64::from(row));
        for [r, p, y] in mixer {
            let command = 0.5 + 0.05 * (thrust + r * roll + p * pitch + y * yaw);
            log += &format!(",{command}");
        }
        let error = |effort: f64| 3.0 * effort + noise;
        log += &format!(",{},0,{},0", error(roll), error(pitch));
        if with_outputs {
            log += &format!(",{roll},{pitch},{}", yaw + 0.3 * noise);
        }
        log += "\n";
    }
    crate::read(log.as_bytes(), &Options::default()).unwrap()
}

fn mixer(frame: &str) -> Vec<[f64; 3]> {
    let (class, kind) = super::tables::parse(frame).unwrap();
    let layout = super::tables::layout(class, kind.unwrap()).unwrap();
    layout.into_iter().map(|(_, factors)| factors).collect()
}

fn geometry(header: &str, frame: &str) -> super::Geometry {
    flight(header, &mixer(frame)).geometry.unwrap()
}

#[test]
fn declared_motors_have_positions() {
    let positions = |frame: &str| {
        let geometry = geometry(&format!("# frame: {frame}\n"), frame);
        let motors = 0..=geometry.factors.len();
        motors
            .map(|motor| geometry.position(motor))
            .collect::<Vec<_>>()
    };
    let quad = ["front right", "rear left", "front left", "rear right"].map(Some);
    assert_eq!(positions("QUAD/X"), [&quad[..], &[None]].concat());
    assert_eq!(
        positions("QUAD/PLUS")[..4],
        ["right", "left", "front", "rear"].map(Some)
    );
    let hexa = [
        "right",
        "left",
        "front left",
        "rear right",
        "front right",
        "rear left",
    ]
    .map(Some);
    assert_eq!(positions("HEXA/X")[..6], hexa);
    // The same commands fit HEXA/PLUS, rotated by 90 degrees.
    assert_eq!(geometry("", "HEXA/X").position(0), None);
}

#[test]
fn the_layout_of_six_and_eight_motors_is_found_by_their_commands() {
    for (frame, found) in [
        ("HEXA/X", "HEXA/X"),
        // Both frames span the same space, because one is the other rotated by 90 degrees.
        ("HEXA/PLUS", "HEXA/X"),
        ("HEXA/DJI_X", "HEXA/DJI_X"),
        ("Y6/Y6B", "Y6/Y6B"),
        ("OCTAQUAD/X", "OCTAQUAD/X"),
        ("OCTA/X", "OCTA/X"),
        ("OCTA/V", "OCTA/V"),
    ] {
        let found_here = geometry("", frame);
        assert_eq!(found_here.basis, Basis::Inferred, "{frame}");
        assert_eq!(found_here.frame.as_deref(), Some(found), "{frame}");
    }
    // Motors that do not move together do not follow a mixer.
    let mut odd = mixer("OCTA/X");
    odd.swap(0, 3);
    odd.swap(1, 6);
    assert_eq!(flight("", &odd).geometry, None);
}

/// The outputs of the rate controllers distinguish layouts that the commands by themselves do not distinguish.
#[test]
fn the_outputs_of_the_controllers_name_the_layout() {
    for frame in [
        "QUAD/X",
        "QUAD/PLUS",
        "QUAD/H",
        "QUAD/BF_X",
        "QUAD/CW_X",
        "HEXA/PLUS",
        "OCTAQUAD/H",
        "OCTAQUAD/BF_X",
    ] {
        let found = read("", &mixer(frame), true).geometry.unwrap();
        assert_eq!(found.basis, Basis::Inferred, "{frame}");
        assert_eq!(found.frame.as_deref(), Some(frame));
        let header = format!("# frame: {frame}\n");
        let declared = read(&header, &mixer(frame), true).geometry.unwrap();
        assert_eq!((declared.doubt, declared.factors), (None, found.factors));
    }
    for (declared, flown) in [
        ("QUAD/X", "QUAD/PLUS"),
        ("QUAD/X", "QUAD/H"),
        ("HEXA/X", "HEXA/PLUS"),
    ] {
        let header = format!("# frame: {declared}\n");
        let doubt = read(&header, &mixer(flown), true)
            .geometry
            .unwrap()
            .doubt
            .unwrap();
        assert!(doubt.contains(flown), "{doubt}");
    }
    // The result does not depend on the choice of kept signals.
    let log = {
        let mut csv = Vec::new();
        read("", &mixer("QUAD/H"), true)
            .write_csv(&mut csv)
            .unwrap();
        csv
    };
    let none = Options {
        signals: Some(Vec::new()),
        ..Options::default()
    };
    let few = crate::read(&log[..], &none).unwrap();
    assert_eq!(few.signals().count(), 0);
    assert_eq!(few.geometry.unwrap().frame.as_deref(), Some("QUAD/H"));
}

#[test]
fn four_motors_are_assumed_to_be_numbered_as_usual() {
    let geometry = geometry("", "QUAD/PLUS");
    assert_eq!(geometry.basis, Basis::Assumed);
    let yaw: Vec<f64> = geometry.factors.iter().map(|f| f[2]).collect();
    assert_eq!(yaw, [1.0, 1.0, -1.0, -1.0]);
}

#[test]
fn a_declared_layout_that_the_commands_contradict_is_reported() {
    for (declared, flown, doubted) in [
        ("OCTAQUAD/X", "OCTAQUAD/X", false),
        ("OCTA/X", "OCTAQUAD/X", true),
        ("HEXA/X", "HEXA/X", false),
        ("HEXA/DJI_X", "HEXA/X", true),
        ("QUAD/X", "QUAD/X", false),
        ("QUAD/X", "QUAD/PLUS", false),
        ("QUAD/BF_X", "QUAD/X", true),
        ("QUAD/DJI_X", "QUAD/BF_X", true),
    ] {
        let geometry = geometry(&format!("# frame: {declared}\n"), flown);
        assert_eq!(geometry.basis, Basis::Declared);
        assert_eq!(geometry.frame.as_deref(), Some(declared));
        assert_eq!(
            geometry.doubt.is_some(),
            doubted,
            "{geometry:?}, flown {flown}"
        );
    }
}

#[test]
fn a_motor_that_stops_does_not_suggest_another_layout() {
    let mut log = Vec::new();
    flight("# frame: HEXA/X\n", &mixer("HEXA/X"))
        .write_csv(&mut log)
        .unwrap();
    let log = String::from_utf8(log).unwrap();
    let rows = log.lines().enumerate().map(|(i, line)| {
        let mut cells: Vec<&str> = line.split(',').collect();
        // Late in the flight one motor stops, and the motor that compensates for its yaw nearly stops.
        if i > 200 {
            cells[1] = "0";
            cells[4] = "0.02";
        }
        cells.join(",") + "\n"
    });
    let rows: String = rows.collect();
    let flight = crate::read(rows.as_bytes(), &Options::default()).unwrap();
    assert_eq!(flight.geometry.unwrap().doubt, None);
}

#[test]
fn headers_name_the_frame_or_the_factors() {
    let x = mixer("QUAD/X");
    for header in [
        "# frame: QUAD/X\n",
        "# frame: quad/x\n",
        "# frame_class: 1\n# frame_type: 1\n",
        "# motor1_factors: -1 1 1\n# motor2_factors: 1 -1 1\n# motor3_factors: 1 1 -1\n# motor4_factors: -1 -1 -1\n",
    ] {
        let found = geometry(header, "QUAD/X");
        assert_eq!(found.basis, Basis::Declared, "{header}");
        for (found, expected) in found.factors.iter().flatten().zip(x.iter().flatten()) {
            assert!((found - expected).abs() < 1e-12, "{header}");
        }
    }
    for (header, said) in [
        ("# frame: my quad\n", "unknown frame `my quad`"),
        ("# motor1_factors: 1 2\n", "`motor1_factors` is `1 2`"),
    ] {
        let log = format!("{header}t_s,motor1\n0,0.5\n");
        let error = crate::read(log.as_bytes(), &Options::default()).unwrap_err();
        assert!(error.to_string().contains(said), "{error}");
    }
}

/// The written geometry is read back: a frame by its name, positions by their factors.
#[test]
fn a_written_geometry_is_read_back() {
    for header in [
        "# frame: HEXA/DJI_X\n",
        "# motor1_factors: -0.5 0.25 1\n# motor2_factors: 1 0.25 -1\n# motor3_factors: -0.5 -1 0\n",
    ] {
        let frame = if header.contains("HEXA") {
            "HEXA/DJI_X"
        } else {
            "TRI/X"
        };
        let flight = flight(header, &mixer(frame));
        let mut csv = Vec::new();
        flight.write_csv(&mut csv).unwrap();
        let again = crate::read(&csv[..], &Options::default()).unwrap();
        assert_eq!(again.geometry, flight.geometry);
        assert_eq!(flight.geometry.unwrap().basis, Basis::Declared);
    }
}

#[test]
fn parameters_of_both_autopilots_determine_the_layout() {
    use super::DeclaredLayout;
    let of = |declared: &DeclaredLayout, motors: u16| {
        let motors = crate::ardupilot::numbered_motors(motors, |n| n.to_string(), "test");
        let motors: Vec<_> = motors.into_iter().map(|(motor, _)| motor).collect();
        super::of(&motors, declared)
    };
    let ardupilot = |pairs: &[(&str, f64)], frame: Option<&str>| {
        let parameters = pairs.iter().copied().collect();
        let vehicle = crate::Vehicle {
            frame: frame.map(str::to_owned),
            motors: Some(4),
            ..crate::Vehicle::default()
        };
        let found = of(&DeclaredLayout::of_ardupilot(&parameters, &vehicle), 4).unwrap();
        (found.frame.unwrap(), found.basis, found.source)
    };
    let declared =
        |frame: &str, source: &str| (frame.to_owned(), Basis::Declared, source.to_owned());
    assert_eq!(
        ardupilot(&[("FRAME_CLASS", 1.0), ("FRAME_TYPE", 12.0)], None),
        declared("QUAD/BF_X", "FRAME_CLASS = 1, FRAME_TYPE = 12")
    );
    assert_eq!(
        ardupilot(&[("FRAME", 0.0)], Some("QUAD")),
        declared("QUAD/PLUS", "frame `QUAD`, FRAME = 0")
    );
    assert_eq!(
        ardupilot(&[], Some("QUAD/H")),
        declared("QUAD/H", "frame `QUAD/H`")
    );
    assert_eq!(
        ardupilot(&[("FRAME", 1.0)], None),
        declared("QUAD/X", "4 motors, FRAME = 1")
    );
    for frame in [None, Some("QUAD"), Some("quadrotor")] {
        let (found, basis, _) = ardupilot(&[], frame);
        assert_eq!((found.as_str(), basis), ("QUAD/X", Basis::Assumed));
    }

    // PX4: front right, rear left, front left, rear right.
    let mut px4 = vec![("CA_ROTOR_COUNT".to_owned(), 4.0)];
    for (rotor, [px, py, km]) in [
        [0.2, 0.3, 0.05],
        [-0.2, -0.3, 0.05],
        [0.2, -0.3, -0.05],
        [-0.2, 0.3, -0.05],
    ]
    .into_iter()
    .enumerate()
    {
        for (name, value) in [("PX", px), ("PY", py), ("KM", km)] {
            px4.push((format!("CA_ROTOR{rotor}_{name}"), value));
        }
    }
    let px4 = px4
        .iter()
        .map(|(name, value)| (name.as_str(), *value))
        .collect();
    let found = of(&DeclaredLayout::of_px4(&px4), 4).unwrap();
    assert_eq!((found.factors, found.frame), (mixer("QUAD/X"), None));
    let airframe =
        |number: f64| DeclaredLayout::of_px4(&[("SYS_AUTOSTART", number)].into_iter().collect());
    assert_eq!(
        of(&airframe(12_001.0), 8).unwrap().frame.as_deref(),
        Some("OCTAQUAD/X")
    );
    // An airframe with another number of motors does not match these motors.
    assert_eq!(of(&airframe(6001.0), 8), None);
    assert_eq!(of(&airframe(10_044.0), 4), None);
    assert_eq!(of(&airframe(4001.0), 4).unwrap().basis, Basis::Declared);
}
