//! What the watch says to the vehicle's system, and whether another watch says it already.

use std::collections::VecDeque;

use flightlog::mavlink::{Packet, Sender, Version, dialect::MavMessage};

use super::{Event, Out};
use crate::watch::voice;

/// Another watch that is silent for so long is gone.
const GONE_S: f64 = 5.0;
/// A change between speaking and listening is told at most this often.
const TELL_S: f64 = 5.0;
/// Packets kept to know them again where a link sends them back.
const ECHOES: usize = 16;

/// The watch's own voice.
pub(super) struct Speech {
    /// `None` listens only.
    sender: Option<Sender>,
    /// Speaks although another watch does.
    insists: bool,
    other: Option<Other>,
    told: Option<(f64, bool)>,
    has_told_risk: bool,
    sent: VecDeque<Vec<u8>>,
}

/// Another watch of the same vehicle.
struct Other {
    component: u8,
    heard_s: f64,
    /// It told how long it has been running; where it did not, its values were heard.
    has_age: bool,
    goes_first: bool,
}

impl Speech {
    pub(super) fn new(sender: Option<Sender>, insists: bool) -> Speech {
        Speech {
            sender,
            insists,
            other: None,
            told: None,
            has_told_risk: false,
            sent: VecDeque::new(),
        }
    }

    /// Whether it may request anything.
    pub(super) fn asks(&self) -> bool {
        self.sender.is_some()
    }

    /// Whether it says anything: no other watch does so first.
    pub(super) fn speaks(&self) -> bool {
        let yields = self.other.as_ref().is_some_and(|other| other.goes_first);
        self.sender.is_some() && (self.insists || !yields)
    }

    /// Sends a request.
    pub(super) fn ask(
        &mut self,
        (version, system): (Version, u8),
        message: &MavMessage,
        out: &mut Out,
    ) {
        if let Some(sender) = &mut self.sender {
            out.packets.push(sender.packet(version, system, message));
        }
    }

    /// Says something, where it may.
    pub(super) fn say(&mut self, to: (Version, u8), message: &MavMessage, out: &mut Out) {
        if !self.speaks() {
            return;
        }
        self.has_told_risk |= matches!(message, MavMessage::NAMED_VALUE_FLOAT(_));
        self.ask(to, message, out);
        if let Some(packet) = out.packets.last() {
            self.sent.truncate(ECHOES - 1);
            self.sent.push_front(packet.clone());
        }
    }

    /// Listens for another watch of the vehicle: the one that has been running longer speaks. A program on the autopilot
    /// itself speaks, and so does one that tells no age and was heard before this one spoke.
    pub(super) fn hear(&mut self, now_s: f64, packet: &Packet<'_>, out: &mut Out) {
        let age_s = voice::age_of(packet);
        if age_s.is_none() && !voice::is_risk(packet) {
            return;
        }
        if self.sent.iter().any(|sent| sent == packet.bytes) {
            return;
        }
        let known = self
            .other
            .as_ref()
            .filter(|other| other.component == packet.component);
        let goes_first = match (age_s, known) {
            (Some(age_s), _) => age_s > now_s,
            (None, Some(known)) if known.has_age => known.goes_first,
            (None, Some(known)) => known.goes_first || packet.component == 1,
            (None, None) => packet.component == 1 || !self.has_told_risk,
        };
        // Of several others, one that goes first is enough.
        if self.other.as_ref().is_some_and(|other| {
            other.goes_first && !goes_first && other.component != packet.component
        }) {
            return;
        }
        self.other = Some(Other {
            component: packet.component,
            heard_s: now_s,
            has_age: age_s.is_some() || known.is_some_and(|known| known.has_age),
            goes_first,
        });
        self.tell(now_s, packet.system, out);
    }

    /// Speaks again where the other watch is gone.
    pub(super) fn tick(&mut self, now_s: f64, system: u8, out: &mut Out) {
        if self
            .other
            .as_ref()
            .is_some_and(|other| now_s - other.heard_s >= GONE_S)
        {
            self.other = None;
            self.tell(now_s, system, out);
        }
    }

    /// Forgets the other watch: it is that of another vehicle.
    pub(super) fn forget(&mut self) {
        self.other = None;
        self.told = None;
        self.has_told_risk = false;
    }

    fn tell(&mut self, now_s: f64, system: u8, out: &mut Out) {
        let speaks = self.speaks();
        let is_news = match self.told {
            None => true,
            Some((told_s, told)) => told != speaks && now_s - told_s >= TELL_S,
        };
        if is_news {
            self.told = Some((now_s, speaks));
            out.events.push(Event::AnotherWatch {
                system,
                component: self.other.as_ref().map(|other| other.component),
                speaks,
            });
        }
    }
}
