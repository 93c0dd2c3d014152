//! Packets in, events and packets out: everything `flagred watch` does but sockets, files and the screen.
//!
//! Two clocks are kept apart. Risk is taken over the vehicle's clock, which its motor commands carry; what concerns
//! the link (silence, asking again, how often to send) goes by the receiver's, which is passed in.

use flagred::{
    estimator::Estimator,
    flight::{Finding, Reason, Verdict},
    monitor::{Sample, Unknown, Update},
    verdict::Level,
};
use flightlog::{
    Vehicle,
    mavlink::{News, Packet, Sender, Setup, Telemetry, Version, vehicle_of},
};

mod tracked;

use super::voice;
pub(crate) use tracked::View;
use tracked::{Tracked, tell};

/// Seconds between two heartbeats, and between two risks sent.
const HEARTBEAT_S: f64 = 1.0;
const RISK_S: f64 = 0.5;
/// Systems told apart: there are no more.
const SYSTEMS: usize = 256;

/// Something to tell.
#[derive(Debug, Clone)]
pub(crate) enum Event {
    /// A vehicle was found.
    Found { system: u8, vehicle: Vehicle },
    /// Another vehicle is on the link; it is not followed.
    Another { system: u8 },
    /// The vehicle that was found is no multirotor; there is nothing to say about it.
    NotAMultirotor { system: u8, vehicle: Vehicle },
    /// Motors and limits are known, or assumed; again where they became known better.
    Ready { setup: Setup },
    /// Something in words.
    Note { text: String },
    /// Nothing comes any more.
    Lost { what: Silent },
    /// It comes again.
    Back { what: Silent, after_s: f64 },
    /// The vehicle started anew.
    Rebooted,
    /// A flight began.
    TookOff { t_s: f64 },
    /// A sample was assessed.
    Risk { update: Update },
    /// The level changed in flight.
    Level {
        t_s: f64,
        level: Level,
        text: String,
    },
    /// A finding ended.
    Ended { finding: Finding },
    /// A flight is over, or what was seen of it.
    Over { end: End, flown: Flown },
}

/// How a flight, or what was seen of it, ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum End {
    /// The vehicle landed.
    Landed,
    /// It was in the air when it was last known.
    Lost(Lost),
    /// It is still in the air, and is heard.
    Left(Left),
}

/// What was lost in the air.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Lost {
    Link,
    MotorCommands,
    /// The vehicle rebooted.
    Reboot,
}

/// Why a flight is not followed to its end.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Left {
    /// The watch ended.
    WatchEnded,
    /// Motors or limits became known better: the rest is assessed as a flight of its own.
    SetUpAnew,
}

/// What was seen of a flight.
#[derive(Debug, Clone)]
pub(crate) struct Flown {
    /// The latest time of the vehicle's clock.
    pub(crate) t_s: Option<f64>,
    pub(crate) verdict: Verdict,
    /// The level of what was seen; `None` where too little was.
    pub(crate) level_seen: Option<Level>,
    pub(crate) risk_max: Option<f64>,
}

/// What fell silent.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Silent {
    Link,
    #[serde(rename = "motor_commands")]
    Motors,
}

/// What comes out.
#[derive(Default)]
pub(crate) struct Out {
    pub(crate) events: Vec<Event>,
    /// Packets to send, in their order.
    pub(crate) packets: Vec<Vec<u8>>,
}

/// Follows the first vehicle on a link.
pub(crate) struct Session<'e> {
    estimator: &'e Estimator,
    /// `None` listens only.
    sender: Option<Sender>,
    tracked: Option<Tracked>,
    others: Vec<u8>,
    heartbeat_s: Option<f64>,
    /// The worst verdict of the flights so far.
    worst: Verdict,
}

impl<'e> Session<'e> {
    /// Speaks as `component` of the vehicle's system; listens only where that is `None`.
    pub(crate) fn new(estimator: &'e Estimator, component: Option<u8>) -> Session<'e> {
        Session {
            estimator,
            sender: component.map(Sender::new),
            tracked: None,
            others: Vec::new(),
            heartbeat_s: None,
            worst: Verdict::NotAvailable(Reason::NoFlight),
        }
    }

    /// Takes in a packet at `now_s` of the receiver's clock; says whether it is the vehicle's.
    pub(crate) fn receive(&mut self, now_s: f64, packet: &Packet<'_>, out: &mut Out) -> bool {
        if let Some(vehicle) = vehicle_of(packet) {
            self.meet(now_s, packet, vehicle, out);
        }
        let Some(tracked) = &mut self.tracked else {
            return false;
        };
        if packet.system != tracked.telemetry.system() {
            return false;
        }
        tracked.count(packet);
        if packet.component == 1 {
            tracked.hear(now_s, out);
        }
        match tracked.telemetry.receive(packet) {
            News::Rebooted => {
                let verdict = tracked.start_anew(now_s, out);
                add(&mut self.worst, verdict);
            }
            News::Commands { t_s } => self.assess(now_s, t_s, out),
            _ => {}
        }
        true
    }

    /// What is due without any packet; to be called often.
    pub(crate) fn tick(&mut self, now_s: f64, out: &mut Out) {
        self.ask(now_s, out);
        self.beat(now_s, out);
        let Some(tracked) = &mut self.tracked else {
            return;
        };
        let verdict = tracked.set_up(now_s, self.sender.is_some(), self.estimator, out);
        tracked.listen(now_s, out);
        add(&mut self.worst, verdict);
    }

    /// Ends the watch and the flight that is still on. Gives the worst verdict of the flights.
    pub(crate) fn finish(&mut self, out: &mut Out) -> Verdict {
        let verdict = self
            .tracked
            .as_mut()
            .and_then(|tracked| tracked.finish(out));
        add(&mut self.worst, verdict);
        self.worst.clone()
    }

    fn meet(&mut self, now_s: f64, packet: &Packet<'_>, vehicle: Vehicle, out: &mut Out) {
        let system = packet.system;
        if let Some(tracked) = &self.tracked {
            if tracked.telemetry.system() != system && self.is_new(system) {
                out.events.push(Event::Another { system });
            }
            return;
        }
        let telemetry = Telemetry::new(packet, vehicle.clone());
        if !telemetry.may_be_multirotor() {
            if self.is_new(system) {
                out.events.push(Event::NotAMultirotor { system, vehicle });
            }
            return;
        }
        out.events.push(Event::Found { system, vehicle });
        self.tracked = Some(Tracked::new(telemetry, now_s));
        self.heartbeat_s = None;
    }

    fn is_new(&mut self, system: u8) -> bool {
        let is_new = !self.others.contains(&system) && self.others.len() < SYSTEMS;
        if is_new {
            self.others.push(system);
        }
        is_new
    }

    fn ask(&mut self, now_s: f64, out: &mut Out) {
        if let (Some(tracked), Some(sender)) = (&mut self.tracked, &mut self.sender)
            && !tracked.link_lost
        {
            let mut messages = Vec::new();
            tracked
                .requests
                .due(now_s, &tracked.telemetry, &mut messages);
            let (version, system) = tracked.address();
            out.packets
                .extend(messages.iter().map(|m| sender.packet(version, system, m)));
        }
    }

    fn beat(&mut self, now_s: f64, out: &mut Out) {
        let due = self
            .heartbeat_s
            .is_none_or(|sent_s| now_s - sent_s >= HEARTBEAT_S);
        if let Some(sender) = &mut self.sender
            && due
        {
            self.heartbeat_s = Some(now_s);
            let (version, system) = self
                .tracked
                .as_ref()
                .map_or((Version::V2, voice::NOBODY), Tracked::address);
            out.packets
                .push(sender.packet(version, system, &voice::heartbeat()));
        }
    }

    fn assess(&mut self, now_s: f64, t_s: f64, out: &mut Out) {
        let Some(tracked) = &mut self.tracked else {
            return;
        };
        let (version, system) = tracked.address();
        let in_air = tracked.telemetry.is_in_air();
        let Some(watch) = &mut tracked.watch else {
            return;
        };
        if watch.commands_lost {
            watch.commands_lost = false;
            out.events.push(Event::Back {
                what: Silent::Motors,
                after_s: now_s - watch.commands_s,
            });
        }
        watch.commands_s = now_s;
        tracked
            .telemetry
            .effective_commands(&watch.setup, &mut watch.motors);
        let update = watch.assessor.push(&Sample {
            t_s,
            motors: &watch.motors,
            in_air,
            signals: &[],
        });
        if update.risk == Err(Unknown::OutOfOrder) {
            return;
        }
        watch.latest = Some(update);
        tell(watch.assessor.ended(), out);
        if in_air && !watch.is_flying {
            watch.is_flying = true;
            out.events.push(Event::TookOff { t_s });
        } else if !in_air {
            let verdict = watch.end_flight(End::Landed, out);
            add(&mut self.worst, verdict);
        }
        out.events.push(Event::Risk { update });
        if let Some(level) = update.change.filter(|_| in_air) {
            let finding = watch.assessor.open_finding();
            let text = voice::say(level, &update, finding.as_ref(), &watch.setup);
            if let Some(sender) = &mut self.sender {
                let message = voice::status(level, &text);
                out.packets.push(sender.packet(version, system, &message));
            }
            out.events.push(Event::Level { t_s, level, text });
        }
        let due = watch
            .risk_sent_s
            .is_none_or(|sent_s| now_s - sent_s >= RISK_S);
        if let Some(sender) = &mut self.sender
            && due
            && let Ok(estimate) = update.risk
            && let Some(elevated_pct) = update.elevated_risk_pct
        {
            watch.risk_sent_s = Some(now_s);
            for (name, value) in [
                (voice::RISK, estimate.risk_pct),
                (voice::ELEVATED, elevated_pct),
            ] {
                let message = voice::value(t_s, name, value);
                out.packets.push(sender.packet(version, system, &message));
            }
        }
    }

    /// How things stand, for a screen.
    pub(crate) fn view(&self) -> Option<View<'_>> {
        self.tracked.as_ref().map(Tracked::view)
    }
}

/// Keeps the graver verdict.
fn add(worst: &mut Verdict, verdict: Option<Verdict>) {
    if let Some(verdict) = verdict {
        *worst = verdict.worst(worst.clone());
    }
}

#[cfg(test)]
pub(crate) mod tests;
