//! Decides which senders the watch trusts: finds candidates for the vehicle to follow, and doubts packets from
//! other senders that use the ids of the vehicle.

use std::net::SocketAddr;

use flagred_flightlog::{Vehicle, VehicleKind, mavlink::Packet};
use schemars::JsonSchema;
use serde::Serialize;

/// The address of a packet's sender; `None` on a serial port, which has one sender.
pub(crate) type Source = Option<SocketAddr>;

/// Number of consistent heartbeats after which a candidate becomes the vehicle to follow.
const BEATS: u32 = 3;
/// Maximum time between two consistent heartbeats of a candidate, in seconds.
const BEAT_WAIT_S: f64 = 5.0;
/// Number of motor commands that, after enough heartbeats, confirm a candidate as a vehicle, so that it replaces a
/// followed vehicle that is not yet confirmed.
const COMMANDS: u32 = 2;
/// Maximum number of candidates: enough for one per system id.
const CANDIDATES: usize = 256;

const SERVO_OUTPUT_RAW: u32 = 36;
const PARAM_VALUE: u32 = 22;

/// A kind of packet that is not trusted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum UntrustedPacket {
    /// A packet with the ids of the vehicle's autopilot, from another address.
    SecondSender,
    /// A packet with a parameter, from another component of the vehicle.
    OtherComponent,
    /// A packet with a timestamp that jumps although the clock of the vehicle does not jump.
    ClockJump,
}

/// The numbers of packets that were not trusted.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, JsonSchema)]
pub(crate) struct UntrustedCounts {
    /// Packets with the ids of the vehicle's autopilot, from another address.
    pub(crate) second_sender: u64,
    /// Packets with parameters, from other components of the vehicle.
    pub(crate) other_component: u64,
    /// Packets with timestamps that jump although the clock of the vehicle does not jump.
    pub(crate) clock_jumps: u64,
}

impl UntrustedCounts {
    /// Adds `count` packets of a kind that is not trusted, and returns whether they are the first of this kind.
    pub(super) fn add(&mut self, doubt: UntrustedPacket, count: u64) -> bool {
        let total = match doubt {
            UntrustedPacket::SecondSender => &mut self.second_sender,
            UntrustedPacket::OtherComponent => &mut self.other_component,
            UntrustedPacket::ClockJump => &mut self.clock_jumps,
        };
        let is_first = *total == 0 && count > 0;
        *total += count;
        is_first
    }
}

/// Returns the reason to doubt a packet that has the vehicle's system id but may come from another sender.
pub(super) fn doubt_of(packet: &Packet<'_>) -> Option<UntrustedPacket> {
    match (packet.component, packet.id) {
        (1, _) => Some(UntrustedPacket::SecondSender),
        (_, PARAM_VALUE) => Some(UntrustedPacket::OtherComponent),
        _ => None,
    }
}

/// Returns whether a vehicle is a multirotor or of unknown kind.
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

/// The evidence that a candidate is a vehicle, weakest first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Evidence {
    None,
    /// Several consistent heartbeats.
    Beats,
    /// Several consistent heartbeats, and motor commands.
    Commands,
}

/// The senders that may be a vehicle. They are collected while no vehicle is followed, and while the followed vehicle is
/// silent or not yet confirmed.
#[derive(Debug, Default)]
pub(super) struct Candidates(Vec<Candidate>);

impl Candidates {
    /// Counts a packet if it contains motor commands of a candidate.
    pub(super) fn take_message(&mut self, source: Source, packet: &Packet<'_>) {
        if packet.id != SERVO_OUTPUT_RAW || packet.component != 1 {
            return;
        }
        if let Some(candidate) = self.find(packet.system, source) {
            candidate.commands += 1;
        }
    }

    /// Processes a heartbeat, and returns the evidence for its sender so far.
    pub(super) fn beat(
        &mut self,
        now_s: f64,
        source: Source,
        system: u8,
        vehicle: &Vehicle,
    ) -> Evidence {
        let Some(candidate) = self.find(system, source) else {
            self.add(Candidate {
                system,
                source,
                vehicle: vehicle.clone(),
                beats: 1,
                beat_s: now_s,
                commands: 0,
            });
            return Evidence::None;
        };
        if candidate.vehicle != *vehicle || now_s - candidate.beat_s > BEAT_WAIT_S {
            candidate.vehicle = vehicle.clone();
            (candidate.beats, candidate.commands) = (0, 0);
        }
        candidate.beats += 1;
        candidate.beat_s = now_s;
        match (candidate.beats, candidate.commands) {
            (..BEATS, _) => Evidence::None,
            (_, ..COMMANDS) => Evidence::Beats,
            _ => Evidence::Commands,
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

    /// Adds a candidate. If there are too many, the oldest of those with the fewest heartbeats is dropped.
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
