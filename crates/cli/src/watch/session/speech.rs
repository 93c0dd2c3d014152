//! What the watch says to the vehicle's system, and whether another watch says it already.

use std::collections::VecDeque;

use flagred_flightlog::mavlink::{Packet, Sender, Version, dialect::MavMessage};

use super::{Event, Out};
use crate::watch::voice;

/// Another watch that is silent for so long is gone.
const GONE_S: f64 = 5.0;
/// A change between speaking and listening is told at most this often.
const TELL_S: f64 = 5.0;
/// Packets kept to know them again where a link sends them back.
const ECHOES: usize = 16;
/// PX4 sends the latest value it heard again as its own, within this time; so many values are compared.
const ECHO_S: f64 = 5.0;
const VALUES: usize = 32;
/// A text that another watch should send waits for that so long; one heard so long ago counts, too.
const TEXT_WAIT_S: f64 = 1.0;
const TEXT_HEARD_S: f64 = 2.0;
/// Texts that wait, or that were heard.
const TEXTS: usize = 8;

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
    /// The bits of each FR_RISK that this watch or another one sent lately, with the time.
    values: VecDeque<(f64, u32)>,
    /// Texts that are sent unless the other watch sends them first.
    waiting: VecDeque<Waiting>,
    /// The topics of texts that others sent lately, with the time.
    heard: VecDeque<(f64, String)>,
}

/// A text that another watch should send.
struct Waiting {
    due_s: f64,
    topic: Option<String>,
    to: (Version, u8),
    message: MavMessage,
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
            values: VecDeque::new(),
            waiting: VecDeque::new(),
            heard: VecDeque::new(),
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

    /// Sends something, unless another watch does so first.
    pub(super) fn say(
        &mut self,
        now_s: f64,
        to: (Version, u8),
        message: &MavMessage,
        out: &mut Out,
    ) {
        if !self.speaks() {
            return;
        }
        if let MavMessage::NAMED_VALUE_FLOAT(value) = message {
            self.has_told_risk = true;
            self.keep_value(now_s, value.value);
        }
        self.utter(to, message, out);
    }

    /// Sends a text. Where another watch goes first it waits for that one's text on the same topic, and is sent if that
    /// does not come: a warning must reach somebody.
    pub(super) fn warn(
        &mut self,
        now_s: f64,
        to: (Version, u8),
        message: &MavMessage,
        out: &mut Out,
    ) {
        if self.speaks() {
            self.utter(to, message, out);
            return;
        }
        let topic = voice::topic(message);
        let is_heard = |(heard_s, heard): &(f64, String)| {
            now_s - heard_s <= TEXT_HEARD_S && topic.as_ref() == Some(heard)
        };
        if self.sender.is_none() || self.heard.iter().any(is_heard) {
            return;
        }
        self.waiting.truncate(TEXTS - 1);
        self.waiting.push_back(Waiting {
            due_s: now_s + TEXT_WAIT_S,
            topic,
            to,
            message: message.clone(),
        });
    }

    fn utter(&mut self, to: (Version, u8), message: &MavMessage, out: &mut Out) {
        self.ask(to, message, out);
        if let Some(packet) = out.packets.last() {
            self.sent.truncate(ECHOES - 1);
            self.sent.push_front(packet.clone());
        }
    }

    fn keep_value(&mut self, now_s: f64, value: f32) {
        self.values.truncate(VALUES - 1);
        self.values.push_front((now_s, value.to_bits()));
    }

    /// Listens for another watch of the vehicle: the one that has been running longer speaks. A program on the autopilot
    /// itself speaks, and so does one that tells no age and was heard before this one spoke. An autopilot that `echoes`
    /// sends the values of others as its own.
    pub(super) fn hear(&mut self, now_s: f64, packet: &Packet<'_>, echoes: bool, out: &mut Out) {
        if self.sent.iter().any(|sent| sent == packet.bytes) {
            return;
        }
        if let Some(topic) = voice::topic_of(packet) {
            self.waiting
                .retain(|waits| waits.topic.as_ref() != Some(&topic));
            self.heard.truncate(TEXTS - 1);
            self.heard.push_front((now_s, topic));
            return;
        }
        let age_s = voice::age_of(packet);
        let risk = voice::risk_of(packet);
        if age_s.is_none() && risk.is_none() {
            return;
        }
        let autopilot_speaks =
            (self.other.as_ref()).is_some_and(|other| other.component == 1 && other.goes_first);
        if let Some(risk) = risk {
            let is_same =
                |(sent_s, bits): &(f64, u32)| now_s - sent_s <= ECHO_S && *bits == risk.to_bits();
            let is_echo = packet.component == 1 && echoes && self.values.iter().any(is_same);
            if is_echo && !autopilot_speaks {
                return;
            }
            if packet.component != 1 {
                self.keep_value(now_s, risk);
            }
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

    /// Speaks again where the other watch is gone, and sends the texts that it did not send.
    pub(super) fn tick(&mut self, now_s: f64, system: u8, out: &mut Out) {
        // They are in the order in which they are due.
        while (self.waiting.front()).is_some_and(|text| now_s >= text.due_s) {
            if let Some(text) = self.waiting.pop_front() {
                self.utter(text.to, &text.message, out);
            }
        }
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
        self.values.clear();
        self.waiting.clear();
        self.heard.clear();
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
