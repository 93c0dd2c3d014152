//! The readers of telemetry logs and of live links interpret a vehicle alike: both receive the same messages.

use flagred_flightlog::{
    Flight, Options,
    mavlink::{PacketScan, Telemetry, TelemetryChange, next_packet, vehicle_of},
};
use flagred_tests::log_writer::{HEARTBEAT, Message, PARAM_VALUE, SERVO_OUTPUT_RAW, Tlog};

const EXTENDED_SYS_STATE: Message = (245, 130, 2);
const AUTOPILOT_VERSION: Message = (148, 178, 60);
const ARDUPILOT: u8 = 3;
const PX4: u8 = 12;
const START_US: u64 = 1_700_000_000_000_000;
/// Bytes of the timestamp before each packet of a telemetry log.
const STAMP: usize = 8;

/// The messages of a vehicle, as a log and one by one.
#[derive(Default)]
struct Vehicle {
    log: Tlog,
    packets: Vec<(f64, Vec<u8>)>,
}

/// A row of commands from a live link.
struct Row {
    t_s: f64,
    commands: [f64; 4],
    armed: bool,
    in_air: bool,
}

impl Vehicle {
    fn send(&mut self, t_s: f64, message: Message, payload: &[u8]) {
        let from = self.log.bytes.len() + STAMP;
        let stamp_us = START_US + (t_s * 1e6).round() as u64;
        self.log.packet(stamp_us, 2, (1, 1), message, payload);
        self.packets.push((t_s, self.log.bytes[from..].to_vec()));
    }

    fn heartbeat(&mut self, t_s: f64, autopilot: u8, armed: bool, status: u8) {
        let mode = if armed { 128 } else { 0 };
        self.send(t_s, HEARTBEAT, &[0, 0, 0, 0, 2, autopilot, mode, status, 3]);
    }

    fn landed_state(&mut self, t_s: f64, state: u8) {
        self.send(t_s, EXTENDED_SYS_STATE, &[0, state]);
    }

    fn parameter(&mut self, name: &str, bytes: [u8; 4], kind: u8) {
        let mut payload = bytes.to_vec();
        payload.extend([0; 4]);
        payload.extend(name.bytes());
        payload.resize(24, 0);
        payload.push(kind);
        self.send(0.5, PARAM_VALUE, &payload);
    }

    fn outputs(&mut self, t_s: f64, pulses_us: [u16; 4]) {
        let mut payload = ((t_s * 1e6).round() as u32).to_le_bytes().to_vec();
        payload.extend(pulses_us.iter().flat_map(|us| us.to_le_bytes()));
        payload.resize(21, 0);
        self.send(t_s, SERVO_OUTPUT_RAW, &payload);
    }

    fn recorded(&self) -> Flight {
        flagred_flightlog::read(&self.log.bytes[..], &Options::default()).unwrap()
    }

    /// The vehicle and its rows of commands according to a live link.
    fn live(&self) -> (Telemetry, Vec<Row>) {
        let mut telemetry: Option<Telemetry> = None;
        let mut rows = Vec::new();
        for (t_s, bytes) in &self.packets {
            let PacketScan::Packet(packet) = next_packet(bytes) else {
                panic!("no packet")
            };
            if telemetry.is_none() {
                let vehicle = vehicle_of(&packet).unwrap();
                telemetry = Some(Telemetry::new(&packet, vehicle));
            }
            let telemetry = telemetry.as_mut().unwrap();
            if let TelemetryChange::Commands { t_s } = telemetry.receive(&packet, *t_s) {
                let mut commands = [0.0; 4];
                telemetry.effective_commands(&telemetry.setup(), &mut commands);
                rows.push(Row {
                    t_s,
                    commands,
                    armed: telemetry.is_armed(),
                    in_air: telemetry.is_in_air(),
                });
            }
        }
        (telemetry.unwrap(), rows)
    }
}

/// Compares a recording with the link.
fn compare(vehicle: &Vehicle) -> Flight {
    let flight = vehicle.recorded();
    assert!(flight.report.is_clean(), "{:?}", flight.report);
    let (telemetry, live) = vehicle.live();
    let setup = telemetry.setup();
    assert_eq!(setup.assumed, Vec::<String>::new());
    assert_eq!(setup.motors, flight.motors);
    assert_eq!(Some(&setup.range), flight.range.as_ref());
    assert_eq!(setup.effective_range, flight.effective_range);
    assert_eq!(setup.geometry, flight.geometry);
    assert_eq!(telemetry.vehicle().kind, flight.vehicle.kind);
    assert_eq!(telemetry.vehicle().motors, flight.vehicle.motors);
    // A live link accepts the first timestamp only once the second confirms it, so it reports no row for the first.
    let recorded: Vec<_> = flight.commands.rows().skip(1).collect();
    assert_eq!(live.len(), recorded.len());
    for (live, (row_s, row)) in live.into_iter().zip(recorded) {
        let Row {
            t_s,
            commands,
            armed,
            in_air,
        } = live;
        assert!((t_s - row_s).abs() < 1e-6);
        let effective: Vec<f64> = row
            .iter()
            .filter_map(|&raw| flight.effective_command(raw))
            .collect();
        assert_eq!(effective, commands, "at {t_s} s");
        assert_eq!(
            flight.armed.as_ref().unwrap().contains(t_s),
            armed,
            "armed at {t_s} s"
        );
        assert_eq!(flight.is_in_air(t_s), Some(in_air), "in the air at {t_s} s");
    }
    flight
}

fn spans(flight: &Flight) -> Vec<(f64, f64)> {
    let spans = &flight.in_air.as_ref().unwrap().spans;
    spans
        .iter()
        .map(|span| (span.start_s, span.end_s))
        .collect()
}

fn ardupilot() -> Vehicle {
    let mut vehicle = Vehicle::default();
    vehicle.heartbeat(0.0, ARDUPILOT, false, 3);
    for (name, value) in [
        ("SERVO1_FUNCTION", 33.0_f32),
        ("SERVO2_FUNCTION", 34.0),
        ("SERVO3_FUNCTION", 35.0),
        ("SERVO4_FUNCTION", 36.0),
        ("MOT_PWM_MIN", 1100.0),
        ("MOT_PWM_MAX", 1900.0),
        // Damaged limits are ignored.
        ("MOT_SPIN_MIN", 65_535.0),
        ("MOT_SPIN_MIN", 0.125),
        ("MOT_SPIN_MAX", 0.875),
        ("FRAME_CLASS", 1.0),
        ("FRAME_TYPE", 0.0),
    ] {
        // ArduPilot sends integers as floats, whatever their type is.
        vehicle.parameter(name, value.to_le_bytes(), 2);
    }
    vehicle
}

#[test]
fn an_ardupilot_vehicle_is_found_by_its_heartbeats() {
    let mut vehicle = ardupilot();
    // Standby, active, critical, emergency, terminating, standby, disarmed.
    let states = [
        (true, 3),
        (true, 4),
        (true, 5),
        (true, 6),
        (true, 8),
        (true, 3),
        (false, 3),
    ];
    for (second, (armed, status)) in (1_u32..).zip(states) {
        let start_s = f64::from(second);
        vehicle.heartbeat(start_s, ARDUPILOT, armed, status);
        for row in 0..10_u16 {
            let t_s = start_s + 0.05 + 0.1 * f64::from(row);
            vehicle.outputs(t_s, [1300 + row, 1400, 1500, 1900]);
        }
    }
    let flight = compare(&vehicle);
    assert_eq!(
        (flight.effective_range.low, flight.effective_range.high),
        (0.125, 0.875)
    );
    assert_eq!(spans(&flight), [(2.0, 6.0)]);
    // The vehicle counts as armed from the first row of commands on.
    assert!((flight.armed.unwrap().duration_s() - 5.95).abs() < 1e-6);
    // In a recording, the first value applies; on a link, the latest one.
    vehicle.parameter("MOT_SPIN_MAX", 0.5_f32.to_le_bytes(), 2);
    assert_eq!(vehicle.recorded().effective_range.high, 0.875);
    assert_eq!(vehicle.live().0.parameter("MOT_SPIN_MAX"), Some(0.5));
}

/// The id of the board is the one that PX4 writes into its own logs.
#[test]
fn the_vehicle_of_a_px4_log_is_identified_by_its_board() {
    let mut vehicle = Vehicle::default();
    vehicle.heartbeat(0.0, PX4, false, 3);
    vehicle.parameter("STAT_BOOTCNT", 81_i32.to_le_bytes(), 6);
    let mut version = vec![0; 78];
    version[8] = 7;
    vehicle.send(1.0, AUTOPILOT_VERSION, &version);
    let by_uid = vehicle.recorded().vehicle;
    assert_eq!(by_uid.id.as_deref(), Some("0000000000000007"));
    assert_eq!(by_uid.id_source.as_deref(), Some("AUTOPILOT_VERSION.uid"));
    assert_eq!((by_uid.system_id, by_uid.boot_count), (Some(1), Some(81)));

    let mut vehicle = Vehicle::default();
    vehicle.heartbeat(0.0, PX4, false, 3);
    version[60..].fill(0xa5);
    vehicle.send(1.0, AUTOPILOT_VERSION, &version);
    let by_uid2 = vehicle.recorded().vehicle;
    assert_eq!(by_uid2.id, Some("a5".repeat(18)));
    assert_eq!(by_uid2.id_source.as_deref(), Some("AUTOPILOT_VERSION.uid2"));
    assert_eq!(by_uid2.boot_count, None);
}

#[test]
fn the_landed_state_takes_precedence_over_the_heartbeat_while_it_is_known() {
    let mut vehicle = ardupilot();
    vehicle.heartbeat(1.0, ARDUPILOT, true, 4);
    // On the ground, taking off, in the air, landing, unknown (the heartbeat is active), on the ground.
    for (second, state) in (1_u32..).zip([1, 3, 2, 4, 0, 1]) {
        let start_s = f64::from(second);
        vehicle.landed_state(start_s + 0.01, state);
        for row in 0..10_u16 {
            vehicle.outputs(start_s + 0.05 + 0.1 * f64::from(row), [1500; 4]);
        }
    }
    let flight = compare(&vehicle);
    assert_eq!(spans(&flight), [(2.01, 6.01)]);
}

#[test]
fn a_px4_vehicle_sends_the_bytes_of_integers_and_is_active_on_the_ground() {
    let mut vehicle = Vehicle::default();
    vehicle.heartbeat(0.0, PX4, false, 3);
    for (output, function) in (1..).zip([101_i32, 102, 103, 104]) {
        let name = format!("PWM_MAIN_FUNC{output}");
        vehicle.parameter(&name, function.to_le_bytes(), 6);
    }
    vehicle.parameter("PWM_MAIN_MIN1", [0x4c, 0x04, 0, 0], 4); // 1100 as INT16
    vehicle.parameter("PWM_MAIN_MAX1", 1900_i32.to_le_bytes(), 6);
    vehicle.parameter("CA_ROTOR_COUNT", [4, 0xff, 0xff, 0xff], 1); // 4 as UINT8
    for (rotor, [px, py, km]) in (0..).zip([
        [1.0_f32, 1.0, 0.05],
        [-1.0, -1.0, 0.05],
        [1.0, -1.0, -0.05],
        [-1.0, 1.0, -0.05],
    ]) {
        for (part, value) in [("PX", px), ("PY", py), ("KM", km)] {
            vehicle.parameter(&format!("CA_ROTOR{rotor}_{part}"), value.to_le_bytes(), 9);
        }
    }
    for second in 1..=6_u32 {
        let start_s = f64::from(second);
        vehicle.heartbeat(start_s, PX4, second < 6, 4);
        vehicle.landed_state(start_s, if (3..5).contains(&second) { 2 } else { 1 });
        for row in 0..10_u16 {
            vehicle.outputs(
                start_s + 0.05 + 0.1 * f64::from(row),
                [1500, 1600, 1700, 1800],
            );
        }
    }
    let flight = compare(&vehicle);
    assert_eq!(spans(&flight), [(3.0, 5.0)]);
    assert_eq!(flight.range.as_ref().map(|range| range.low), Some(1100.0));
    assert_eq!(
        flight.geometry.as_ref().map(|g| g.factors[0]),
        Some([-1.0, 1.0, 1.0])
    );
}
