//! Whom the watch believes: candidates for the vehicle to follow, and what speaks in its name without being it.

use std::net::SocketAddr;

use flagred_flightlog::{Vehicle, VehicleKind, mavlink::Packet};
use schemars::JsonSchema;
use serde::Serialize;

/// Where a packet came from; `None` on a serial port, which has one sender.
pub(crate) type Source = Option<SocketAddr>;

/// So many consistent heartbeats make a candidate the vehicle to follow.
const BEATS: u32 = 3;
/// They come in steps of at most this.
const BEAT_WAIT_S: f64 = 5.0;
/// So many motor commands prove a candidate while the one that is followed shows none.
const COMMANDS: u32 = 2;
/// Candidates at a time: at least one a system.
const CANDIDATES: usize = 256;

const SERVO_OUTPUT_RAW: u32 = 36;
const PARAM_VALUE: u32 = 22;

/// Something that is not believed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Doubt {
    /// The vehicle's autopilot, from another address.
    SecondSender,
    /// A parameter from another component of the vehicle.
    OtherComponent,
    /// A time stamp that jumps while the clock goes on.
    ClockJump,
}

/// How much was not believed.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, JsonSchema)]
pub(crate) struct Doubts {
    /// Packets in the name of the vehicle's autopilot from another address.
    pub(crate) second_sender: u64,
    /// Parameters from other components.
    pub(crate) other_component: u64,
    /// Time stamps that jump.
    pub(crate) clock_jumps: u64,
}

impl Doubts {
    /// Counts; whether it is the first of its kind.
    pub(super) fn add(&mut self, doubt: Doubt, count: u64) -> bool {
        let total = match doubt {
            Doubt::SecondSender => &mut self.second_sender,
            Doubt::OtherComponent => &mut self.other_component,
            Doubt::ClockJump => &mut self.clock_jumps,
        };
        let is_first = *total == 0 && count > 0;
        *total += count;
        is_first
    }
}

/// What a packet of the vehicle's system that is not from its autopilot makes doubtful.
pub(super) fn doubt_of(packet: &Packet<'_>) -> Option<Doubt> {
    match (packet.component, packet.id) {
        (1, _) => Some(Doubt::SecondSender),
        (_, PARAM_VALUE) => Some(Doubt::OtherComponent),
        _ => None,
    }
}

/// Whether a vehicle is a multirotor, or does not say what it is.
pub(crate) fn may_be_multirotor(vehicle: &Vehicle) -> bool {
    matches!(vehicle.kind, VehicleKind::Multirotor | VehicleKind::Unknown)
}

/// A sender that may be a vehicle.
#[derive(Debug)]
struct Candidate {
    system: u8,
    source: Source,
    vehicle: Vehicle,
    beats: u32,
    beat_s: f64,
    commands: u32,
}

/// What speaks for a candidate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Proof {
    None,
    /// Several consistent heartbeats.
    Beats,
    /// And motor commands.
    Commands,
}

/// The senders that may be a vehicle, while none is followed or the one that is does not prove to be one.
#[derive(Debug, Default)]
pub(super) struct Candidates(Vec<Candidate>);

impl Candidates {
    /// Counts motor commands.
    pub(super) fn hear(&mut self, source: Source, packet: &Packet<'_>) {
        if packet.id != SERVO_OUTPUT_RAW || packet.component != 1 {
            return;
        }
        if let Some(candidate) = self.find(packet.system, source) {
            candidate.commands += 1;
        }
    }

    /// Takes in a heartbeat; gives what speaks for its sender so far.
    pub(super) fn beat(
        &mut self,
        now_s: f64,
        source: Source,
        system: u8,
        vehicle: &Vehicle,
    ) -> Proof {
        let Some(candidate) = self.find(system, source) else {
            self.add(Candidate {
                system,
                source,
                vehicle: vehicle.clone(),
                beats: 1,
                beat_s: now_s,
                commands: 0,
            });
            return Proof::None;
        };
        if candidate.vehicle != *vehicle || now_s - candidate.beat_s > BEAT_WAIT_S {
            candidate.vehicle = vehicle.clone();
            (candidate.beats, candidate.commands) = (0, 0);
        }
        candidate.beats += 1;
        candidate.beat_s = now_s;
        match (candidate.beats, candidate.commands) {
            (..BEATS, _) => Proof::None,
            (_, ..COMMANDS) => Proof::Beats,
            _ => Proof::Commands,
        }
    }

    pub(super) fn clear(&mut self) {
        self.0.clear();
    }

    fn find(&mut self, system: u8, source: Source) -> Option<&mut Candidate> {
        let is_it =
            |candidate: &&mut Candidate| (candidate.system, candidate.source) == (system, source);
        self.0.iter_mut().find(is_it)
    }

    /// Where there is no room, the one that goes has the fewest heartbeats, and of these the oldest.
    fn add(&mut self, candidate: Candidate) {
        if self.0.len() >= CANDIDATES {
            let least = (self.0.iter().enumerate())
                .min_by(|(_, a), (_, b)| a.beats.cmp(&b.beats).then(a.beat_s.total_cmp(&b.beat_s)));
            if let Some(index) = least.map(|(index, _)| index) {
                self.0.swap_remove(index);
            }
        }
        self.0.push(candidate);
    }
}
