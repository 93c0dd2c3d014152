//! Sends the messages of the watch to the vehicle's system, in coordination with other watches.

use std::collections::VecDeque;

use flagred_flightlog::mavlink::{Packet, Sender, Version, dialect::MavMessage};

use super::{Event, SessionOutput};
use crate::watch::messages;

/// Another watch is considered gone after this silence.
const GONE_S: f64 = 5.0;
/// Minimum seconds between two reports that the watch starts or stops sending.
const REPORT_INTERVAL_S: f64 = 5.0;
/// Number of sent packets that are stored to recognise packets that a link sends back.
const ECHOES: usize = 16;
/// Seconds within which PX4 may send the latest value that it received, as if the value were its own.
const ECHO_S: f64 = 5.0;
/// Maximum number of values that are stored to recognise values that PX4 sends again.
const VALUES: usize = 32;
/// Seconds to wait for another watch to send a text before this watch sends it.
const TEXT_WAIT_S: f64 = 1.0;
/// A text is not sent if another watch sent a text on the same topic at most this many seconds ago.
const RECENT_TEXT_S: f64 = 2.0;
/// Maximum number of delayed texts, beyond which the oldest is sent at once, and of texts received from other watches.
const TEXTS: usize = 8;

/// Sends the messages of the watch to the vehicle's system, unless another watch has precedence.
pub(super) struct WatchSender {
    /// `None` if the watch only listens.
    sender: Option<Sender>,
    /// Whether this watch sends values and texts even if another watch sends them.
    insists: bool,
    other: Option<OtherWatch>,
    reported: Option<(f64, bool)>,
    has_reported_risk: bool,
    sent: VecDeque<Vec<u8>>,
    /// The time and the bits of each recent FR_RISK value, sent by this watch or another one.
    values: VecDeque<(f64, u32)>,
    /// Texts that are sent unless the other watch sends them first.
    waiting: VecDeque<DelayedText>,
    /// The time and the topic of each recent text of another watch.
    received: VecDeque<(f64, String)>,
}

/// A delayed text; this watch sends it if no other watch does.
struct DelayedText {
    due_s: f64,
    topic: Option<String>,
    to: (Version, u8),
    message: MavMessage,
}

/// Another watch of the same vehicle.
struct OtherWatch {
    component: u8,
    received_s: f64,
    /// Whether the other watch has reported its running time. If not, only values were received from it.
    has_age: bool,
    goes_first: bool,
}

impl WatchSender {
    pub(super) fn new(sender: Option<Sender>, insists: bool) -> WatchSender {
        WatchSender {
            sender,
            insists,
            other: None,
            reported: None,
            has_reported_risk: false,
            sent: VecDeque::new(),
            values: VecDeque::new(),
            waiting: VecDeque::new(),
            received: VecDeque::new(),
        }
    }

    /// Returns whether this watch may send requests.
    pub(super) fn may_request(&self) -> bool {
        self.sender.is_some()
    }

    /// Returns whether this watch sends values and texts: it has a sender, and it insists or no other watch has
    /// precedence.
    pub(super) fn is_sending(&self) -> bool {
        let yields = self.other.as_ref().is_some_and(|other| other.goes_first);
        self.sender.is_some() && (self.insists || !yields)
    }

    pub(super) fn request(
        &mut self,
        (version, system): (Version, u8),
        message: &MavMessage,
        out: &mut SessionOutput,
    ) {
        if let Some(sender) = &mut self.sender {
            out.packets.push(sender.packet(version, system, message));
        }
    }

    /// Sends a message, unless another watch has precedence.
    pub(super) fn send(
        &mut self,
        now_s: f64,
        to: (Version, u8),
        message: &MavMessage,
        out: &mut SessionOutput,
    ) {
        if !self.is_sending() {
            return;
        }
        if let MavMessage::NAMED_VALUE_FLOAT(value) = message {
            self.has_reported_risk = true;
            self.keep_value(now_s, value.value);
        }
        self.send_message(to, message, out);
    }

    /// Sends a text. If another watch has precedence, the text is delayed, and dropped if the other watch sends a text on the
    /// same topic. Therefore at least one of the two sends each warning.
    pub(super) fn warn(
        &mut self,
        now_s: f64,
        to: (Version, u8),
        message: &MavMessage,
        out: &mut SessionOutput,
    ) {
        if self.is_sending() {
            self.send_message(to, message, out);
            return;
        }
        let topic = messages::topic(message);
        let is_recent = |(received_s, received): &(f64, String)| {
            now_s - received_s <= RECENT_TEXT_S && topic.as_ref() == Some(received)
        };
        if self.sender.is_none() || self.received.iter().any(is_recent) {
            return;
        }
        if self.waiting.len() >= TEXTS {
            self.send_first(out);
        }
        self.waiting.push_back(DelayedText {
            due_s: now_s + TEXT_WAIT_S,
            topic,
            to,
            message: message.clone(),
        });
    }

    /// Sends the first of the delayed texts.
    fn send_first(&mut self, out: &mut SessionOutput) {
        if let Some(text) = self.waiting.pop_front() {
            self.send_message(text.to, &text.message, out);
        }
    }

    fn send_message(&mut self, to: (Version, u8), message: &MavMessage, out: &mut SessionOutput) {
        self.request(to, message, out);
        if let Some(packet) = out.packets.last() {
            self.sent.truncate(ECHOES - 1);
            self.sent.push_front(packet.clone());
        }
    }

    fn keep_value(&mut self, now_s: f64, value: f32) {
        self.values.truncate(VALUES - 1);
        self.values.push_front((now_s, value.to_bits()));
    }

    /// Processes a packet of another watch of the vehicle. The watch that has been running longer has precedence. A
    /// program on the autopilot itself always has precedence over this watch. A sender that reports no running time has
    /// precedence if its first value arrived before this watch sent a risk. `echoes` is true for an autopilot that
    /// repeats the values of others as its own.
    pub(super) fn take_message(
        &mut self,
        now_s: f64,
        packet: &Packet<'_>,
        echoes: bool,
        out: &mut SessionOutput,
    ) {
        if self.sent.iter().any(|sent| sent == packet.bytes) {
            return;
        }
        if let Some(topic) = messages::topic_of(packet) {
            self.waiting
                .retain(|waits| waits.topic.as_ref() != Some(&topic));
            self.received.truncate(TEXTS - 1);
            self.received.push_front((now_s, topic));
            return;
        }
        let age_s = messages::age_of(packet);
        let risk = messages::risk_of(packet);
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
            (None, None) => packet.component == 1 || !self.has_reported_risk,
        };
        // A watch without precedence does not replace one with precedence, which still keeps this watch from sending.
        if self.other.as_ref().is_some_and(|other| {
            other.goes_first && !goes_first && other.component != packet.component
        }) {
            return;
        }
        self.other = Some(OtherWatch {
            component: packet.component,
            received_s: now_s,
            has_age: age_s.is_some() || known.is_some_and(|known| known.has_age),
            goes_first,
        });
        self.report(now_s, packet.system, out);
    }

    /// Sends the delayed texts that are due, and resumes sending if the other watch is gone.
    pub(super) fn tick(&mut self, now_s: f64, system: u8, out: &mut SessionOutput) {
        // The texts are sorted by the time at which they are due.
        while (self.waiting.front()).is_some_and(|text| now_s >= text.due_s) {
            self.send_first(out);
        }
        if self
            .other
            .as_ref()
            .is_some_and(|other| now_s - other.received_s >= GONE_S)
        {
            self.other = None;
            self.report(now_s, system, out);
        }
    }

    /// Forgets other watches and texts, because another vehicle is followed from now on.
    pub(super) fn forget(&mut self) {
        self.other = None;
        self.reported = None;
        self.has_reported_risk = false;
        self.values.clear();
        self.waiting.clear();
        self.received.clear();
    }

    fn report(&mut self, now_s: f64, system: u8, out: &mut SessionOutput) {
        let is_sending = self.is_sending();
        let is_news = match self.reported {
            None => true,
            Some((reported_s, reported)) => {
                reported != is_sending && now_s - reported_s >= REPORT_INTERVAL_S
            }
        };
        if is_news {
            self.reported = Some((now_s, is_sending));
            out.events.push(Event::AnotherWatch {
                system,
                component: self.other.as_ref().map(|other| other.component),
                is_sending,
            });
        }
    }
}
