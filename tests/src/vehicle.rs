//! A stand-in vehicle that replays a log over MAVLink. "The other side" is the program that receives it, such as
//! `flagred watch`.

mod answers;
mod messages;
mod received;

use messages::{OUTPUTS_PER_PORT, attitude, landed_state, servo_of_port};
pub use messages::{heartbeat, heartbeat_of, servo};
pub use received::{Inbox, Progress};

use std::{
    collections::VecDeque,
    path::Path,
    sync::{Arc, atomic::Ordering},
    time::{Duration, Instant},
};

use flagred_flightlog::{
    Flight,
    mavlink::{
        Key, Sender, SkipCounts, Stream, Version,
        dialect::{MavMessage, MavType},
    },
};

use crate::wire::{Link, Speed, Wire};

/// A vehicle that replays a log.
pub struct StandIn {
    wire: Wire,
    link: Link,
    version: Version,
    system: u8,
    parameters: Vec<(String, f64)>,
    kind: MavType,
    sender: Sender,
    /// States of the random number generators for the packets of the flight and for all others, so that the number of
    /// requests does not affect the flight.
    random: [u64; 2],
    stream: Stream,
    /// A second link.
    other: Option<(Wire, Stream)>,
    late: VecDeque<(u32, Vec<u8>)>,
    /// Messages received from the other side.
    pub received: Inbox,
    /// Messages received on the second link.
    pub heard_elsewhere: Inbox,
    /// For each motor command, its time on the vehicle's clock in ms, and the moment at which it was sent.
    pub sent: Vec<(u32, Instant)>,
    /// The progress of the other side. A flight at full speed waits for it, because otherwise the buffers of the
    /// machine would overflow and packets would be lost.
    pub progress: Option<Arc<Progress>>,
    /// The number of flights whose end has been marked.
    marks: u8,
    /// The vehicle's clock at time 0 of the log, in seconds.
    pub clock_s: f64,
    /// Whether requests are answered.
    pub answers: bool,
    /// The interval at which incoming packets are read while the vehicle waits for its next
    /// command.
    pub look_every: Duration,
    requested: bool,
    /// The minimum interval between motor commands.
    pub every: Duration,
    /// Whether the vehicle sends motor commands at the rate that the other side requests.
    pub obeys: bool,
    /// The offset of the vehicle's motors from the outputs of the log.
    shift: usize,
}

/// The index in [`StandIn::random`] for the packets of a flight.
const FLIGHT: usize = 0;
/// The index in [`StandIn::random`] for all other packets.
const TALK: usize = 1;

/// Half the time between two commands of a log.
const HALF_A_SAMPLE_S: f64 = 0.02;

/// The time-out for any reaction of the other side: machines that run many tests are slow.
const TIMEOUT: Duration = Duration::from_secs(60);

impl StandIn {
    /// A vehicle with the motors and limits of a flight.
    pub fn new(flight: &Flight, wire: Wire, link: Link, version: Version) -> StandIn {
        StandIn {
            wire,
            link,
            version,
            system: 1,
            parameters: answers::parameters(flight),
            kind: match flight.motors.len() {
                4 => MavType::MAV_TYPE_QUADROTOR,
                6 => MavType::MAV_TYPE_HEXAROTOR,
                _ => MavType::MAV_TYPE_OCTOROTOR,
            },
            sender: Sender::new(1),
            random: [0x9e37_79b9_7f4a_7c15, 0xd1b5_4a32_d192_ed03],
            stream: Stream::new(),
            other: None,
            late: VecDeque::new(),
            received: Inbox::default(),
            heard_elsewhere: Inbox::default(),
            sent: Vec::new(),
            progress: None,
            marks: 0,
            clock_s: 0.0,
            answers: true,
            look_every: Duration::from_millis(2),
            requested: false,
            every: Duration::ZERO,
            obeys: false,
            shift: 0,
        }
    }

    /// Sends heartbeats until the other side reports that it knows the motors. If the test does not read the output of
    /// the other side, sends heartbeats until the other side has sent a request.
    pub fn meet(&mut self) {
        let start = Instant::now();
        let is_met = |vehicle: &StandIn| match &vehicle.progress {
            Some(progress) => progress.is_ready.load(Ordering::Acquire),
            None => vehicle.requested,
        };
        while !is_met(self) {
            assert!(start.elapsed() < TIMEOUT, "the vehicle is not met");
            self.beat(false, false);
            self.linger(Duration::from_millis(10));
        }
    }

    /// Replays the part of a log between two times, and waits until the other side has processed it to the end.
    pub fn fly(&mut self, flight: &Flight, speed: Speed, from_s: f64, to_s: f64) {
        self.fly_on(flight, speed, from_s, to_s);
        self.wait_until_processed();
    }

    /// Replays the part of a log between two times.
    pub fn fly_on(&mut self, flight: &Flight, speed: Speed, from_s: f64, to_s: f64) {
        let outputs: Vec<usize> = flight.motors.iter().map(|m| output(&m.output)).collect();
        let mut state = None;
        let mut next_beat_s = f64::NEG_INFINITY;
        let mut next_state_s = f64::NEG_INFINITY;
        let mut next_command_s = f64::NEG_INFINITY;
        let (start, mut first_s, mut count) = (Instant::now(), None, 0);
        for (t_s, row) in flight.commands.rows() {
            if t_s < from_s || t_s > to_s {
                continue;
            }
            if let Speed::Times(times) = speed {
                let first_s = *first_s.get_or_insert(t_s);
                let due = Duration::from_secs_f64((t_s - first_s) / times);
                while start.elapsed() < due {
                    self.listen();
                    std::thread::sleep(self.look_every);
                }
            }
            let armed = flight
                .armed
                .as_ref()
                .is_none_or(|armed| armed.contains(t_s));
            let now = (armed, flight.is_in_air(t_s) == Some(true));
            let changed = state.replace(now) != Some(now);
            if changed || t_s >= next_beat_s {
                next_beat_s = t_s + 1.0;
                let beat = heartbeat(self.kind, now.0, now.1);
                self.send(&beat);
            }
            if changed || t_s >= next_state_s {
                next_state_s = t_s + 0.25;
                self.send(&attitude(t_s + self.clock_s));
                self.send(&landed_state(now.1));
            }
            let clock_s = t_s + self.clock_s;
            if t_s < next_command_s {
                continue;
            }
            next_command_s = t_s + self.every.as_secs_f64() - HALF_A_SAMPLE_S;
            let mut pulses = [[0; OUTPUTS_PER_PORT]; 2];
            for (&output, &raw) in outputs.iter().zip(row) {
                let output = output + self.shift;
                pulses[output / OUTPUTS_PER_PORT][output % OUTPUTS_PER_PORT] = raw as u16;
            }
            self.sent
                .push(((clock_s * 1e3).round() as u32, Instant::now()));
            // The microseconds wrap around after 71 minutes.
            let time_usec = (clock_s * 1e6).round() as u64 as u32;
            let ports = if self.shift == 0 { 1 } else { 2 };
            for (port, pulses) in (0..ports).zip(&pulses) {
                self.send(&servo_of_port(time_usec, port, pulses));
            }
            count += 1;
            if speed != Speed::Fastest {
                self.wire.flush();
            }
            self.listen();
            if speed == Speed::Fastest && count % 16 == 0 {
                self.wait_for_the_other_side(clock_s, now.1);
            }
        }
        while let Some((_, packet)) = self.late.pop_front() {
            self.wire.send(&packet);
        }
    }

    /// Sends a heartbeat of a marker vehicle and waits until the other side reports it. Packets stay in order, so the
    /// other side has then processed all packets of the flight.
    pub fn wait_until_processed(&mut self) {
        let Some(progress) = self.progress.clone() else {
            self.linger(Duration::from_millis(200));
            return;
        };
        let system = 250 - self.marks;
        self.marks += 1;
        let mark = heartbeat(self.kind, false, false);
        let packet = Sender::new(1).packet(self.version, system, &mark);
        self.wire.send(&packet);
        let start = Instant::now();
        while progress.other_system.load(Ordering::Acquire) != u64::from(system) {
            assert!(start.elapsed() < TIMEOUT, "the flight is not followed");
            self.linger(Duration::from_millis(2));
        }
        // Waits briefly, because the last messages are still on their way.
        self.linger(Duration::from_millis(20));
    }

    /// Waits until at most two seconds of commands are in transit.
    fn wait_for_the_other_side(&mut self, t_s: f64, in_air: bool) {
        self.wire.flush();
        let Some(progress) = self.progress.clone().filter(|_| in_air) else {
            std::thread::sleep(Duration::from_millis(8));
            return;
        };
        let start = Instant::now();
        let behind = || (progress.followed_ms.load(Ordering::Relaxed) as f64) < (t_s - 2.0) * 1e3;
        while behind() && start.elapsed() < Duration::from_millis(500) {
            self.listen();
            std::thread::sleep(Duration::from_micros(200));
        }
    }

    /// Receives packets for some time.
    pub fn linger(&mut self, time: Duration) {
        let start = Instant::now();
        while start.elapsed() < time {
            self.wire.flush();
            self.listen();
            std::thread::sleep(Duration::from_millis(2));
        }
    }

    /// Sends a heartbeat.
    pub fn beat(&mut self, armed: bool, in_air: bool) {
        let beat = heartbeat(self.kind, armed, in_air);
        self.send_outside_flight(&beat);
    }

    /// From now on, signs the packets of the vehicle and accepts only signed packets.
    pub fn sign(&mut self, key: &Key) {
        self.sender = Sender::new(1).signed(key.clone());
        self.stream = Stream::with_key(key.clone());
    }

    /// The numbers of packets from the other side that the vehicle could not decode.
    pub fn skipped(&self) -> SkipCounts {
        self.stream.skipped()
    }

    /// Forwards packets between the vehicle's wire and another, as an autopilot does between its links.
    pub fn forward_to(&mut self, wire: Wire) {
        self.other = Some((wire, Stream::new()));
    }

    /// Continues to send from another address.
    pub fn move_to(&mut self, wire: Wire) {
        self.wire = wire;
    }

    /// Sends a message as another component of the vehicle's system.
    pub fn say_as(&mut self, component: u8, message: &MavMessage) {
        let packet = Sender::new(component).packet(self.version, self.system, message);
        self.transmit(&packet);
    }

    fn transmit(&mut self, packet: &[u8]) {
        self.wire.send(packet);
        if let Some((other, _)) = &mut self.other {
            other.send(packet);
        }
    }

    /// Sends bytes directly, without the losses of the link.
    pub fn raw(&mut self, bytes: &[u8]) {
        self.wire.send(bytes);
    }

    /// Sends a message that is not part of the flight; the link may lose it.
    fn send_outside_flight(&mut self, message: &MavMessage) {
        let packet = self.sender.packet(self.version, self.system, message);
        if !self.chance(TALK, self.link.loss) {
            self.transmit(&packet);
        }
    }

    /// Sends a message of a flight over the link, with its losses, repetitions and reordering.
    pub fn send(&mut self, message: &MavMessage) {
        let packet = self.sender.packet(self.version, self.system, message);
        if self.chance(FLIGHT, self.link.loss) {
            return;
        }
        if self.chance(FLIGHT, self.link.reordered) {
            let after = 1 + (self.random[FLIGHT] >> 20) as u32 % 3;
            self.late.push_back((after, packet));
            return;
        }
        self.transmit(&packet);
        if self.chance(FLIGHT, self.link.repeated) {
            self.transmit(&packet);
        }
        for (after, _) in &mut self.late {
            *after = after.saturating_sub(1);
        }
        while self.late.front().is_some_and(|(after, _)| *after == 0) {
            if let Some((_, packet)) = self.late.pop_front() {
                self.transmit(&packet);
            }
        }
    }

    fn chance(&mut self, of: usize, share: f64) -> bool {
        let random = &mut self.random[of];
        *random ^= *random << 13;
        *random ^= *random >> 7;
        *random ^= *random << 17;
        ((*random >> 11) as f64 / (1_u64 << 53) as f64) < share
    }

    /// Receives packets, and answers requests.
    pub fn listen(&mut self) {
        self.forward();
        while self.wire.receive(&mut self.stream) {
            let mut messages = Vec::new();
            while let Some(packet) = self.stream.packet() {
                if let Some((other, _)) = &mut self.other {
                    other.send(packet.bytes);
                }
                let message = packet.message().unwrap();
                messages.push((Instant::now(), packet.system, packet.component, message));
            }
            for (at, system, component, message) in messages {
                if !self.chance(TALK, self.link.loss) {
                    self.answer(&message);
                }
                self.received
                    .messages
                    .push((at, system, component, message));
            }
        }
    }

    /// Forwards packets of the second link to the first.
    fn forward(&mut self) {
        let Some((other, stream)) = &mut self.other else {
            return;
        };
        let mut messages = Vec::new();
        while other.receive(stream) {
            while let Some(packet) = stream.packet() {
                self.wire.send(packet.bytes);
                let message = packet.message().unwrap();
                messages.push((Instant::now(), packet.system, packet.component, message));
            }
        }
        for message in messages {
            self.answer(&message.3);
            self.heard_elsewhere.messages.push(message);
        }
    }
}

/// The flight of a log, for a stand-in.
///
/// # Panics
///
/// If it cannot be read.
pub fn flight(log: &Path) -> Flight {
    let signals = Some(Vec::new());
    let mut options = flagred_flightlog::Options::default();
    options.signals = signals;
    flagred_flightlog::open(log, &options).unwrap()
}

fn output(name: &str) -> usize {
    let digits = name.trim_start_matches(|c: char| !c.is_ascii_digit());
    digits.parse::<usize>().unwrap() - 1
}
