//! A watch whose vehicle hovers while others send packets.

use std::net::SocketAddr;

use flagred_cli::fuzzing::Watch;
use flagred_flightlog::mavlink::{
    PacketScan, Sender, Version,
    dialect::{
        HEARTBEAT_DATA, MavAutopilot, MavMessage, MavModeFlag, MavState, MavType, PARAM_VALUE_DATA,
        SERVO_OUTPUT_RAW_DATA,
    },
    next_packet,
};

use super::{SHIPPED, assert_harmless, without};
use crate::log_writer::{self, HEARTBEAT, Message, PARAM_VALUE, SERVO_OUTPUT_RAW, STATUSTEXT};

/// Number of sender addresses; the vehicle has the first.
const ADDRESSES: u8 = 8;
const NAMED_VALUE_FLOAT: Message = (251, 170, 18);
const EXTENDED_SYS_STATE: Message = (245, 130, 2);
const COMMAND_ACK: Message = (77, 143, 3);
/// Messages of other senders, with any system, component and content.
const MESSAGES: [Message; 7] = [
    HEARTBEAT,
    PARAM_VALUE,
    SERVO_OUTPUT_RAW,
    STATUSTEXT,
    NAMED_VALUE_FLOAT,
    EXTENDED_SYS_STATE,
    COMMAND_ACK,
];

/// Encodes a packet of another sender in three bytes and a payload. The first byte is the address plus [`ADDRESSES`] times
/// the delay in hundredths of a second; the second is the kind of message (0 for raw bytes) with the MAVLink version; the
/// third is the length.
pub(super) fn encode(address: u8, wait: u8, kind: u8, payload: &[u8]) -> Vec<u8> {
    let mut bytes = vec![address + ADDRESSES * wait, kind, payload.len() as u8];
    bytes.extend(payload);
    bytes
}

/// Sends any packets of several senders to a watch. The vehicle hovers and is not lost, whatever others send: only
/// packets from its own address and with its own system are accepted.
pub fn session(bytes: &[u8]) {
    let mut link = Link::new();
    let mut rest = bytes;
    let mut is_true = true;
    while let [from, how, length, tail @ ..] = rest {
        let (payload, tail) = tail.split_at(usize::from(*length).min(tail.len()));
        rest = tail;
        let (address, wait_s) = (from % ADDRESSES, f64::from(from / ADDRESSES) / 100.0);
        link.hover(wait_s);
        let kind = usize::from(how % 8);
        let datagram = match (kind, payload) {
            (1.., [system, component, content @ ..]) => {
                let version = if how / 8 % 2 == 0 { 2 } else { 1 };
                is_true &= address != 0 || (*system, *component) != (1, 1);
                let message = MESSAGES[kind - 1];
                log_writer::packet(version, (*system, *component), message, content)
            }
            _ => {
                is_true &= address != 0;
                payload.to_vec()
            }
        };
        let taken = link
            .watch
            .receive(link.now_s, self::address(address), &datagram);
        assert!(taken == 0 || !is_true);
        link.look(is_true);
    }
    link.hover(1.1);
    link.look(is_true);
    let followed = link.watch.followed().unwrap();
    if is_true {
        assert!(followed.system == 1 && !followed.is_lost, "{followed:?}");
        assert!(followed.t_s > Some(link.now_s - 0.1), "{followed:?}");
    }
    let screen = link.watch.screen((80, 24));
    let text = without("mHKJ", &screen).replace("\r\n", "\n");
    assert_harmless(&text);
    link.watch.finish(link.now_s);
    link.look(false);
}

fn address(index: u8) -> Option<SocketAddr> {
    Some(([10, 0, 0, index], 14_550).into())
}

/// The link, and the vehicle on it.
struct Link {
    watch: Watch<'static>,
    vehicle: Sender,
    now_s: f64,
    /// The time of the next motor commands.
    commands_s: f64,
    /// The time of the next heartbeat.
    beat_s: f64,
}

impl Link {
    /// Creates a link with a hovering quadrotor that the watch follows.
    fn new() -> Link {
        let mut link = Link {
            watch: Watch::new(SHIPPED.estimator()),
            vehicle: Sender::new(1),
            now_s: 0.0,
            commands_s: 0.0,
            beat_s: 0.0,
        };
        for _ in 0..3 {
            link.beat();
        }
        for (name, value) in [
            ("MOT_PWM_MIN", 1000.0),
            ("MOT_PWM_MAX", 2000.0),
            ("MOT_SPIN_MIN", 0.1),
            ("MOT_SPIN_MAX", 0.9),
            ("FRAME_CLASS", 1.0),
            ("FRAME_TYPE", 1.0),
        ] {
            link.parameter(name, value);
        }
        for output in 1..=16_u8 {
            let function = if output <= 4 { 32 + output } else { 0 };
            link.parameter(&format!("SERVO{output}_FUNCTION"), function.into());
        }
        link.hover(1.0);
        link.look(true);
        assert_eq!(link.watch.followed().map(|f| f.system), Some(1));
        link
    }

    fn send(&mut self, message: &MavMessage) -> usize {
        let bytes = self.vehicle.packet(Version::V2, 1, message);
        self.watch.receive(self.now_s, address(0), &bytes)
    }

    fn beat(&mut self) {
        self.send(&MavMessage::HEARTBEAT(HEARTBEAT_DATA {
            custom_mode: 0,
            mavtype: MavType::MAV_TYPE_QUADROTOR,
            autopilot: MavAutopilot::MAV_AUTOPILOT_ARDUPILOTMEGA,
            base_mode: MavModeFlag::MAV_MODE_FLAG_SAFETY_ARMED,
            system_status: MavState::MAV_STATE_ACTIVE,
            mavlink_version: 3,
        }));
    }

    fn parameter(&mut self, name: &str, param_value: f32) {
        self.send(&MavMessage::PARAM_VALUE(PARAM_VALUE_DATA {
            param_value,
            param_count: 900,
            param_index: u16::MAX,
            param_id: name.into(),
            ..PARAM_VALUE_DATA::default()
        }));
    }

    /// Advances the time while the vehicle continues to hover.
    fn hover(&mut self, seconds: f64) {
        let end_s = self.now_s + seconds;
        while self.commands_s <= end_s {
            self.now_s = self.commands_s;
            if self.beat_s <= self.now_s {
                self.beat_s += 1.0;
                self.beat();
            }
            let wiggle = (self.now_s * 25.0).round() as u16 % 5;
            self.send(&MavMessage::SERVO_OUTPUT_RAW(SERVO_OUTPUT_RAW_DATA {
                time_usec: (self.now_s * 1e6).round() as u32,
                servo1_raw: 1500 + wiggle,
                servo2_raw: 1500,
                servo3_raw: 1500 - wiggle,
                servo4_raw: 1500,
                ..SERVO_OUTPUT_RAW_DATA::default()
            }));
            self.watch.tick(self.now_s);
            self.commands_s += 0.04;
        }
        self.now_s = end_s;
    }

    /// Asserts that messages are harmless and, if `is_true` (only packets of the vehicle were accepted), that none is a warning.
    fn look(&mut self, is_true: bool) {
        let reported = self.watch.reported();
        reported.words.iter().for_each(|line| assert_harmless(line));
        for packet in &reported.packets {
            assert!(
                matches!(next_packet(packet), PacketScan::Packet(_)),
                "{packet:?}"
            );
        }
        for line in &reported.json {
            let event: serde_json::Value = serde_json::from_str(line).unwrap();
            let event = event["event"].as_str().unwrap();
            let alarms = [
                "level",
                "finding",
                "landed",
                "lost_in_air",
                "left_in_air",
                "lost",
                "given_up",
                "sender_changed",
                "rebooted",
            ];
            assert!(!is_true || !alarms.contains(&event), "{line}");
        }
    }
}
