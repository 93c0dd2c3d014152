//! Floods of packets: the vehicle is not lost, memory stays constant, and damaged bytes raise no alarm.

use allocation_counter::measure;
use fastrand::Rng;
use flagred_flightlog::mavlink::{
    Stream,
    dialect::{NAMED_VALUE_FLOAT_DATA, STATUSTEXT_DATA},
};

use super::*;

/// Number of flood packets for each packet of the vehicle, that is, 50,000 a second.
const SHARE: usize = 2000;
/// Maximum growth of memory after the first packets. The flight may need some memory, the flood must not.
const GROWTH: u64 = 256 << 10;

/// A packet of another sender, and its origin. System, component, address and contents are random.
fn stranger(random: &mut Rng) -> (Source, Vec<u8>) {
    let source = match random.u8(..4) {
        // The vehicle's own address.
        0 => None,
        _ => Some(([random.u8(..), random.u8(..), 0, 1], random.u16(..)).into()),
    };
    let mut system = random.u8(1..=255);
    let component = *random.choice(&[1, 1, 1, 154, 191, 255]).unwrap();
    if system == 1 && component == 1 && source.is_none() {
        system = 2;
    }
    let message = match random.u8(..6) {
        0 | 1 => quadrotor(random.bool()),
        2 => MavMessage::SERVO_OUTPUT_RAW(SERVO_OUTPUT_RAW_DATA {
            time_usec: random.u32(..),
            servo1_raw: 2000,
            servo2_raw: 1000,
            ..SERVO_OUTPUT_RAW_DATA::default()
        }),
        3 => MavMessage::PARAM_VALUE(PARAM_VALUE_DATA {
            param_value: f32::from(random.u16(..)),
            param_id: "MOT_PWM_MIN".into(),
            ..PARAM_VALUE_DATA::default()
        }),
        4 => MavMessage::NAMED_VALUE_FLOAT(NAMED_VALUE_FLOAT_DATA {
            time_boot_ms: random.u32(..),
            value: 1.0,
            name: messages::RISK.into(),
        }),
        _ => MavMessage::STATUSTEXT(STATUSTEXT_DATA::default()),
    };
    let bytes = Sender::new(component).packet(Version::V2, system, &message);
    (source, bytes)
}

/// A link inside the process. It takes bytes as they arrive and passes them on packet by packet.
struct Link<'e> {
    bench: Bench<'e>,
    stream: Stream,
    /// The number of packets that the session attributed to the vehicle.
    taken: u64,
}

impl Link<'_> {
    fn datagram(&mut self, source: Source, bytes: &[u8], out: &mut SessionOutput) {
        self.stream.push(bytes);
        while let Some(packet) = self.stream.packet() {
            let session = &mut self.bench.session;
            self.taken += u64::from(session.receive(self.bench.now_s, source, &packet, out));
        }
        self.stream.end();
    }

    /// Sends packets; one in [`SHARE`] of them comes from the hovering vehicle.
    fn flood(
        &mut self,
        from_s: f64,
        packets: usize,
        mut next: impl FnMut(usize) -> (Source, Vec<u8>),
    ) -> f64 {
        let mut out = SessionOutput::default();
        let mut t_s = from_s;
        for i in 0..packets {
            if i % SHARE == 0 {
                t_s += 0.04;
                self.bench.now_s += 0.04;
                let beat = self.bench.vehicle.packet(Version::V2, 1, &quadrotor(true));
                self.datagram(None, &beat, &mut out);
                let outputs = hovering(t_s);
                let outputs = self.bench.vehicle.packet(Version::V2, 1, &outputs);
                self.datagram(None, &outputs, &mut out);
                self.bench.session.tick(self.bench.now_s, &mut out);
            }
            let (source, bytes) = next(i);
            self.datagram(source, &bytes, &mut out);
            for event in out.events.drain(..) {
                assert!(is_harmless(&event), "{event:?}");
            }
            for packet in out.packets.drain(..) {
                let PacketScan::Packet(packet) = next_packet(&packet) else {
                    panic!("{packet:?}");
                };
                assert_ne!(packet.id, 253, "a text is sent");
            }
        }
        t_s
    }
}

/// Returns whether an event may occur while the vehicle hovers and others flood the link.
fn is_harmless(event: &Event) -> bool {
    match event {
        Event::Doubt { .. }
        | Event::AnotherVehicle { .. }
        | Event::NotAMultirotor { .. }
        | Event::AnotherWatch { .. }
        | Event::TookOff { .. } => true,
        Event::Locked { system, .. } => *system == 1,
        // After the first seconds the risk must be known.
        Event::Risk { update } => update.t_s < 15.0 || update.risk.is_ok(),
        _ => false,
    }
}

fn hovering(t_s: f64) -> MavMessage {
    let wiggle = (t_s * 25.0).round() as u16 % 5;
    servo(t_s, [1500 + wiggle, 1500, 1500 - wiggle, 1500])
}

/// Creates a link with such a short history that it is full before memory is measured. The bound of the history is tested separately, see
/// [`MAX_SAMPLES`](super::super::history::MAX_SAMPLES).
fn link(estimator: &Estimator) -> Link<'_> {
    let session = Session::new(estimator, Some(Sender::new(191)), false).keeping(500);
    let mut bench = Bench {
        session,
        ..Bench::new(estimator, None)
    };
    bench.beat(false);
    bench.all_parameters();
    bench.hover(5.0, 1.0, 1500);
    bench.wait(0.02);
    Link {
        bench,
        stream: Stream::new(),
        taken: 0,
    }
}

fn flood(packets: usize) {
    let estimator = estimator();
    let mut link = link(&estimator);
    let mut random = Rng::with_seed(16);
    // The packets are generated in advance, because generating them would slow the flood down.
    let pool: Vec<_> = (0..20_000).map(|_| stranger(&mut random)).collect();
    let mut pick = |_| pool[random.usize(..pool.len())].clone();
    let warm_up = SHARE * 400;
    let t_s = link.flood(6.0, warm_up, &mut pick);
    let start = std::time::Instant::now();
    let mut end_s = t_s;
    let used = measure(|| end_s = link.flood(t_s, packets - warm_up, &mut pick));
    let kb = used.bytes_max / 1024;
    println!("{packets} packets: {:.1?}, {kb} kB more", start.elapsed());
    assert!(used.bytes_max < GROWTH, "{used:?}");
    let view = link.bench.session.view().unwrap();
    assert!(view.system == 1 && !view.link_lost && !view.motors_lost);
    assert!(view.latest.unwrap().t_s > end_s - 0.05);
    // Only the vehicle's packets were attributed to it.
    assert_eq!(link.taken, 2 * packets.div_ceil(SHARE) as u64);
    assert!(link.bench.session.doubts().second_sender > 0);
}

#[test]
fn a_million_packets_of_others_do_not_lose_the_vehicle() {
    flood(1_000_000);
}

/// A day of packets, in 130 s: `cargo test -p flagred-cli --lib flood -- --ignored --nocapture`.
#[test]
#[ignore = "a day's flood takes two minutes"]
fn a_hundred_million_packets_of_others_do_not_lose_the_vehicle() {
    flood(100_000_000);
}

/// Damages packets by flipping bits and by removing, adding and truncating bytes. Nothing panics, and bytes that are
/// not packets cause no text.
fn mutate(packets: usize) {
    let estimator = estimator();
    let mut link = link(&estimator);
    let mut random = Rng::with_seed(21);
    let mut vehicle = Sender::new(1);
    let mut pool: Vec<Vec<u8>> = (0..1000).map(|_| stranger(&mut random).1).collect();
    for (version, t_s) in [(Version::V1, 8.0), (Version::V2, 9.0)] {
        for message in [hovering(t_s), quadrotor(true), quadrotor(false)] {
            for _ in 0..100 {
                pool.push(vehicle.packet(version, 1, &message));
            }
        }
    }
    let mut next = |_| {
        let mut bytes = pool[random.usize(..pool.len())].clone();
        for _ in 0..random.usize(1..4) {
            let at = random.usize(..bytes.len());
            match random.u8(..8) {
                0 => bytes.truncate(at.max(1)),
                1 => bytes.insert(at, random.u8(..)),
                2 if bytes.len() > 1 => drop(bytes.remove(at)),
                _ => bytes[at] ^= 1 << random.u8(..8),
            }
        }
        (None, bytes)
    };
    let warm_up = SHARE * 100;
    let t_s = link.flood(6.0, warm_up, &mut next);
    let used = measure(|| {
        link.flood(t_s, packets - warm_up, &mut next);
    });
    assert!(used.bytes_max < GROWTH, "{used:?}");
    assert!(link.stream.skipped().checksums > packets as u64 / 4);
    assert_eq!(link.bench.session.view().unwrap().system, 1);
}

#[test]
fn a_million_damaged_packets_raise_no_alarm() {
    mutate(1_000_000);
}

#[test]
#[ignore = "takes a minute"]
fn ten_million_damaged_packets_raise_no_alarm() {
    mutate(10_000_000);
}
