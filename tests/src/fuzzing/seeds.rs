//! Small seeds of the fuzz targets that cover much of the code.

use std::io::Write;

use flate2::{Compression, write::GzEncoder};

use super::{rule_sets::SEPARATOR, session::encode};
use crate::log_writer::{
    ATTITUDE, DataFlash, HEARTBEAT, PARAM_VALUE, SERVO_OUTPUT_RAW, Tlog, ULog, Value,
};

/// A log of each format.
pub fn logs() -> Vec<Vec<u8>> {
    let log = data_flash();
    vec![
        gzipped(&log.bytes),
        log.bytes,
        log.text.into_bytes(),
        ulog(),
        tlog(),
        csv().into_bytes(),
    ]
}

/// The bytes compressed with gzip.
pub fn gzipped(bytes: &[u8]) -> Vec<u8> {
    let mut packed = GzEncoder::new(Vec::new(), Compression::default());
    packed.write_all(bytes).unwrap();
    packed.finish().unwrap()
}

/// Flights as CSV, as people and other programs write them.
pub fn tables() -> Vec<Vec<u8>> {
    let others = [
        "t_s,motor1,motor2\n0,0.5,0.25\n0.1,,1\n0.1,1,0\n",
        "# vehicle: HEXA/X\n# effective_low: 0.1\n# effective_high: 0.95\n# note: =1+1\n\
         t_s,motor1,motor2,motor3,motor4,motor5,motor6,in_air,\"a,b\",battery_remaining_pct\n\
         0,0.5,0.25,1,0,0.5,0.5,0,nan,90\n0.04,0.5,0.25,1,0,0.5,0.5,1,1e-320,\n",
        "\u{feff}t_s;x\n# \u{1b}[2J: \u{202e}\n",
        "# pwm_low_us: 900\n# pwm_high_us: 2100\n# vehicle_id: 7\n\
         t_s,pwm1,pwm2,pwm3,pwm4,alt_m\n-1e9,1500,1500,900,2100,1\n1e9,1,65535,0,,\n",
    ];
    let mut tables = vec![csv().into_bytes()];
    tables.extend(others.map(|text| text.as_bytes().to_vec()));
    tables
}

/// Packets of other senders on the link of a watch.
pub fn links() -> Vec<Vec<u8>> {
    let beat = |system, component, armed| vec![system, component, 0, 0, 0, 0, 2, 3, armed, 4, 3];
    let commands = |system, t_s: u32| {
        let mut content = vec![system, 1];
        content.extend((t_s * 1_000_000).to_le_bytes());
        content.extend([2000_u16, 1000, 2000, 1000].map(u16::to_le_bytes).concat());
        content
    };
    let parameter = |component, name: &str, value: f32| {
        let mut content = vec![1, component];
        content.extend(value.to_le_bytes());
        content.extend([0; 4]);
        content.extend(name.bytes());
        content
    };
    let impostor: Vec<Vec<u8>> = (0..6)
        .flat_map(|i| {
            [
                encode(1, 20, 1, &beat(1, 1, 128)),
                encode(1, 4, 3, &commands(1, 10 + i)),
            ]
        })
        .collect();
    let others = [
        // Packets of other vehicles, sent from this vehicle's address and from another address.
        encode(0, 10, 1, &beat(2, 1, 128)),
        encode(0, 10, 3, &commands(2, 5)),
        encode(2, 10, 1, &beat(3, 1, 0)),
        encode(2, 10, 11, &commands(3, 5)),
        // Parameters of another component and of an impostor.
        encode(0, 1, 2, &parameter(154, "MOT_PWM_MIN", 1900.0)),
        encode(3, 1, 2, &parameter(1, "SERVO1_FUNCTION", f32::NAN)),
        // A status text, packets of another watch, and arbitrary bytes.
        encode(4, 1, 4, b"\x01\x01\x02WARN \x1b[2J"),
        encode(4, 1, 1, &[1, 191, 9, 0, 0, 0xf1, 18, 8, 0, 4, 3]),
        encode(5, 1, 5, b"\x01\xbf\0\0\0\0\0\0\x80\x3fFR_RISK"),
        encode(6, 31, 0, b"\xfe\x09\0\x01\x01\0\xfd\xff\0\0"),
    ];
    // Packets of the vehicle itself, which reboots.
    let itself = [
        encode(0, 10, 3, &commands(1, 0)),
        encode(0, 10, 3, &commands(1, 1)),
        encode(0, 31, 1, &beat(1, 1, 0)),
    ];
    vec![impostor.concat(), others.concat(), itself.concat()]
}

macro_rules! rules_file {
    ($name:literal) => {
        include_str!(concat!("../../../rules/", $name))
    };
}

/// Profiles with their rule sets.
pub fn profiles() -> Vec<Vec<u8>> {
    let small = "flagred: 1\nname: small\nrules: small\nwindow_s: 1\ninputs:\n  margin: {mean: motor_margin}\n  \
        spread: {std: motor_command, window_s: 3}\n  battery: {last: battery_remaining_pct}\ngap: {method: nearest}\n\
        verdict:\n  warn: {risk: 45, after_s: 0.2}\n  fail: {risk: 60, after_s: 0.2}\n  noise: {above: 0.001, after_s: 0}\n";
    let small_rules = "fuzzy: 1\nname: small\ninputs:\n  margin: {range: [0, 0.5], partition: [low, high]}\n  \
        spread: {range: [0, 0.5], partition: {low: 0, high: 0.2}}\n  battery: {range: [0, 100], terms: {low: {triangle: [0, 0, 60]}}}\n\
        outputs: {risk: {range: [0, 100], partition: [low, high]}}\nrules:\n  - IF margin IS low AND spread IS NOT low THEN risk IS high\n  \
        - IF margin IS high OR battery IS very low THEN risk IS low WITH 0.5\n";
    let pair = |profile: &str, rules: &str| format!("{profile}{SEPARATOR}{rules}").into_bytes();
    vec![
        pair(small, small_rules),
        pair(
            rules_file!("profiles/flagred-paper.yaml"),
            rules_file!("flagred-paper.yaml"),
        ),
        pair(
            include_str!("../../battery/flagred-battery.yaml"),
            include_str!("../../battery/flagred-battery-rules.yaml"),
        ),
    ]
}

/// Rule sets of every kind.
pub fn rule_sets() -> Vec<Vec<u8>> {
    let texts = [
        rules_file!("tipper.yaml"),
        rules_file!("flagred-paper.yaml"),
        include_str!("../../onboard/curves.yaml"),
        include_str!("../../onboard/functions.yaml"),
        include_str!("../../onboard/blocks.yaml"),
    ];
    texts.map(|text| text.as_bytes().to_vec()).to_vec()
}

/// Rule sets as other programs write them.
pub fn other_programs() -> Vec<Vec<u8>> {
    let models = rule_sets().into_iter().map(|bytes| {
        let text = String::from_utf8(bytes).unwrap();
        fuzzy::yaml::parse(&text).unwrap().model
    });
    // A rule set is skipped for any format that lacks the shape of one of its terms.
    let written = models.flat_map(|model| {
        flagred_interchange::Format::ALL.map(|format| {
            let written =
                flagred_interchange::write(&model, format, flagred_interchange::Losses::Accept);
            written.ok().map(|written| written.text.into_bytes())
        })
    });
    let written: Vec<Vec<u8>> = written.flatten().collect();
    assert!(written.len() > 12, "{}", written.len());
    written
}

/// Rules.
pub fn rules() -> Vec<Vec<u8>> {
    let texts = [
        "IF margin IS low AND (spread IS NOT very high OR battery IS somewhat low) THEN risk IS high WITH 0.5",
        "if `a b` is any then x is low and y is 2.5",
    ];
    texts.map(|text| text.as_bytes().to_vec()).to_vec()
}

/// The definitions and parameters of a quad.
fn copter() -> DataFlash {
    let mut log = DataFlash::new();
    log.define(129, "PARM", "QNf", "TimeUS,Name,Value");
    log.define(130, "RCOU", "QHHHH", "TimeUS,C1,C2,C3,C4");
    log.define(
        131,
        "ATT",
        "QccccCC",
        "TimeUS,DesRoll,Roll,DesPitch,Pitch,DesYaw,Yaw",
    );
    log.define(132, "EV", "QB", "TimeUS,Id");
    log.define(133, "MSG", "QZ", "TimeUS,Message");
    log.define(
        134,
        "IMU",
        "Qffffff",
        "TimeUS,GyrX,GyrY,GyrZ,AccX,AccY,AccZ",
    );
    log.write("MSG", [1e6.into(), "ArduCopter V4.5.7 (2a3dc4b7)".into()]);
    for motor in 1..=4 {
        let name = format!("SERVO{motor}_FUNCTION");
        log.parameter(1e6, &name, f64::from(32 + motor));
    }
    log.parameter(1e6, "MOT_PWM_MIN", 1000.0);
    log.parameter(1e6, "MOT_PWM_MAX", 2000.0);
    log
}

/// A quad that hovers from second 3 to second 8 of 10, as an ArduPilot log.
pub fn data_flash() -> DataFlash {
    let mut log = copter();
    for row in 0..100 {
        let time = Value::Number(1e6 + 1e5 * f64::from(row));
        match row {
            10 => log.write("EV", [time, 10.0.into()]),
            20 => log.write("EV", [time, 28.0.into()]),
            70 => log.write("EV", [time, 18.0.into()]),
            _ => {}
        }
        let pulse = Value::Number(f64::from(1400 + row));
        log.write("RCOU", [time, pulse, pulse, pulse, pulse]);
        log.write("IMU", std::iter::once(time).chain([Value::Number(0.5); 6]));
    }
    log
}

/// A quad in the air from second 11 on, without motor commands, which the caller writes.
pub fn hovering() -> DataFlash {
    let mut log = copter();
    log.write("EV", [10e6.into(), 10.0.into()]);
    log.write("EV", [11e6.into(), 28.0.into()]);
    log
}

/// The same flight as a PX4 log.
pub fn ulog() -> Vec<u8> {
    let mut log = ULog::new(1_000_000);
    log.define("actuator_motors:uint64_t timestamp;float[12] control;");
    log.define("vehicle_attitude:uint64_t timestamp;float[4] q;");
    log.define("vehicle_status:uint64_t timestamp;uint8_t arming_state;uint8_t nav_state;");
    log.define("vehicle_land_detected:uint64_t timestamp;bool landed;uint8_t[7] _padding0;");
    log.parameter("CA_ROTOR_COUNT", 4.0);
    log.parameter("MAV_TYPE", 2.0);
    for (id, name) in [
        (1, "actuator_motors"),
        (2, "vehicle_attitude"),
        (3, "vehicle_status"),
        (4, "vehicle_land_detected"),
    ] {
        log.announce(0, id, name);
    }
    for row in 0..100_u64 {
        let time_us = 1_000_000 + 100_000 * row;
        if row % 10 == 0 {
            log.flags(3, time_us, &[2, 3]);
            log.flags(4, time_us, &[u8::from(!(20..80).contains(&row))]);
        }
        log.floats(1, time_us, &[0.4; 12]);
        log.floats(2, time_us, &[1.0, 0.0, 0.0, 0.0]);
    }
    log.bytes
}

/// The same flight as a telemetry log.
pub fn tlog() -> Vec<u8> {
    let mut log = Tlog::default();
    for (motor, version) in [(1, 1), (2, 2), (3, 1), (4, 2)] {
        let mut parameter = (32.0 + motor as f32).to_le_bytes().to_vec();
        parameter.extend([0; 4]);
        parameter.extend(format!("SERVO{motor}_FUNCTION").bytes());
        log.packet(
            1_700_000_000_000_000,
            version,
            (1, 1),
            PARAM_VALUE,
            &parameter,
        );
    }
    for (name, value) in [("MOT_PWM_MIN", 1000.0_f32), ("MOT_PWM_MAX", 2000.0)] {
        let mut parameter = value.to_le_bytes().to_vec();
        parameter.extend([0; 4]);
        parameter.extend(name.bytes());
        log.packet(1_700_000_000_000_000, 2, (1, 190), PARAM_VALUE, &parameter);
    }
    for row in 0..100_u64 {
        let stamp_us = 1_700_000_000_000_000 + 100_000 * row;
        let version = 1 + (row % 2) as u8;
        let heartbeat = [0, 0, 0, 0, 2, 3, 128, 4, 3];
        log.packet(stamp_us, version, (1, 1), HEARTBEAT, &heartbeat);
        let mut servos = vec![0; 4];
        servos.extend([1500_u16; 8].iter().flat_map(|pulse| pulse.to_le_bytes()));
        servos.push(0);
        log.packet(stamp_us, version, (1, 1), SERVO_OUTPUT_RAW, &servos);
        log.packet(stamp_us, version, (1, 1), ATTITUDE, &[0; 28]);
    }
    log.bytes
}

/// A flight CSV.
pub fn csv() -> String {
    let mut log = String::from("# vehicle: quad\n# pwm_low_us: 1000\n# pwm_high_us: 2000\n");
    log += "t_s,pwm1,pwm2,pwm3,pwm4,in_air,roll_deg,roll_des_deg,pitch_deg,pitch_des_deg\n";
    for row in 0..100 {
        let t_s = 0.04 * f64::from(row);
        log += &format!(
            "{t_s:.2},1500,1510,1490,1500,{},0.1,0.2,-0.3,0\n",
            u8::from(row > 9)
        );
    }
    log
}
