//! Packets in, events and packets out: everything `flagred watch` does but sockets, files and the screen.
//!
//! Two clocks are kept apart. Risk is taken over the vehicle's clock, which its motor commands carry; what concerns
//! the link (silence, asking again, how often to send) goes by the receiver's, which is passed in.

use flagred::{
    estimator::Estimator,
    monitor::{Assessment, Monitor, Sample, Unknown},
    verdict::{Ended, Finding, Level},
};
use flightlog::{
    Vehicle,
    mavlink::{
        News, Packet, Requests, Sender, Setup, Telemetry, Version, parameters_known, vehicle_of,
    },
};

use super::voice;
use crate::assess::{Tally, Verdict};

/// A link, or the motor commands on it, that are silent for this long are lost.
const SILENT_S: f64 = 2.0;
/// Listening without asking, this long until what is not known is assumed.
const LISTEN_S: f64 = 10.0;
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
    Risk { assessment: Assessment },
    /// The level changed in flight.
    Level {
        t_s: f64,
        level: Level,
        text: String,
    },
    /// A finding ended.
    Ended { finding: Finding },
    /// A flight ended, or what was seen of it.
    Landed { verdict: Verdict },
}

/// What fell silent.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Silent {
    Link,
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
    tracked: Option<Tracked<'e>>,
    others: Vec<u8>,
    heartbeat_s: Option<f64>,
    worst: Level,
    not_understood: u64,
}

struct Tracked<'e> {
    telemetry: Telemetry,
    requests: Requests,
    found_s: f64,
    heard_s: f64,
    link_lost: bool,
    set_up_tried: bool,
    watch: Option<Watch<'e>>,
    received: u64,
    missed: u64,
    sequence: Option<u8>,
}

/// A vehicle whose motors are known.
struct Watch<'e> {
    setup: Setup,
    monitor: Monitor<'e>,
    motors: Vec<f64>,
    commands_s: f64,
    commands_lost: bool,
    risk_sent_s: Option<f64>,
    flight: Option<Flight>,
    latest: Option<Assessment>,
}

/// The flight that is on.
#[derive(Default)]
struct Flight {
    tally: Tally,
    worst: Option<Level>,
    since_s: f64,
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
            worst: Level::Good,
            not_understood: 0,
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
            News::Nothing | News::Parameter => {}
            News::NotUnderstood => self.not_understood += 1,
            News::Rebooted => {
                self.worst = self.worst.max(tracked.end_flight(self.estimator, out));
                out.events.push(Event::Rebooted);
                tracked.watch = None;
                tracked.set_up_tried = false;
                tracked.requests = Requests::new();
                tracked.found_s = now_s;
            }
            News::Commands { t_s } => self.assess(now_s, t_s, out),
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
        tracked.set_up(now_s, self.sender.is_some(), self.estimator, out);
        tracked.listen(now_s, out);
    }

    /// Ends the watch: the flight that is still on, if any. Gives the worst level of all flights.
    pub(crate) fn finish(&mut self, out: &mut Out) -> Level {
        if let Some(tracked) = &mut self.tracked {
            self.worst = self.worst.max(tracked.end_flight(self.estimator, out));
        }
        self.worst
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
        self.tracked = Some(Tracked {
            telemetry,
            requests: Requests::new(),
            found_s: now_s,
            heard_s: now_s,
            link_lost: false,
            set_up_tried: false,
            watch: None,
            received: 0,
            missed: 0,
            sequence: None,
        });
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
        let assessment = watch.monitor.push(&Sample {
            t_s,
            motors: &watch.motors,
            in_air,
            signals: &[],
        });
        if assessment.risk == Err(Unknown::OutOfOrder) {
            return;
        }
        watch.latest = Some(assessment);
        tell(assessment.ended, out);
        if !in_air {
            if let Some(flight) = watch.flight.take() {
                let worst = flight.end(assessment.ended, self.estimator, out);
                self.worst = self.worst.max(worst);
            }
        } else {
            let flight = watch.flight.get_or_insert_with(|| {
                out.events.push(Event::TookOff { t_s });
                Flight {
                    since_s: t_s,
                    ..Flight::default()
                }
            });
            flight.worst = flight.worst.max(worst(assessment.ended));
            let quiet_s = self.estimator.profile().verdict.quiet_after_take_off_s;
            flight
                .tally
                .add(&assessment, t_s >= flight.since_s + quiet_s, &watch.motors);
        }
        out.events.push(Event::Risk { assessment });
        if let Some(level) = assessment.change.filter(|_| in_air) {
            let text = voice::say(
                level,
                &assessment,
                watch.monitor.open_finding(),
                &watch.setup,
            );
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
            && let Ok(estimate) = assessment.risk
            && let Some(elevated_pct) = assessment.elevated_risk_pct
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
        let tracked = self.tracked.as_ref()?;
        let watch = tracked.watch.as_ref();
        let fresh = watch.filter(|watch| !tracked.link_lost && !watch.commands_lost);
        Some(View {
            system: tracked.telemetry.system(),
            vehicle: tracked.telemetry.vehicle(),
            is_armed: tracked.telemetry.is_armed(),
            is_in_air: tracked.telemetry.is_in_air(),
            link_lost: tracked.link_lost,
            motors_lost: watch.is_some_and(|watch| watch.commands_lost),
            lost_share: tracked.missed as f64 / (tracked.missed + tracked.received).max(1) as f64,
            setup: watch.map(|watch| &watch.setup),
            motors: fresh.map_or(&[], |watch| &watch.motors),
            margin: fresh.and_then(|watch| watch.monitor.margin()),
            spread: fresh.and_then(|watch| watch.monitor.spread()),
            latest: fresh.and_then(|watch| watch.latest),
        })
    }

    /// Messages whose fields hold what the dialect does not know.
    pub(crate) fn not_understood(&self) -> u64 {
        self.not_understood
    }
}

/// How things stand; what is lost is not shown as if it were known.
pub(crate) struct View<'a> {
    pub(crate) system: u8,
    pub(crate) vehicle: &'a Vehicle,
    pub(crate) is_armed: bool,
    pub(crate) is_in_air: bool,
    pub(crate) link_lost: bool,
    pub(crate) motors_lost: bool,
    /// The share of the vehicle's packets that did not arrive.
    pub(crate) lost_share: f64,
    pub(crate) setup: Option<&'a Setup>,
    /// Effective commands; NaN is unknown.
    pub(crate) motors: &'a [f64],
    pub(crate) margin: Option<f64>,
    pub(crate) spread: Option<f64>,
    pub(crate) latest: Option<Assessment>,
}

impl<'e> Tracked<'e> {
    /// How it is spoken to.
    fn address(&self) -> (Version, u8) {
        (self.telemetry.version(), self.telemetry.system())
    }

    /// Counts what the sequence numbers of the autopilot tell to be missing; a late packet was counted as such.
    fn count(&mut self, packet: &Packet<'_>) {
        if packet.component != 1 {
            return;
        }
        self.received += 1;
        let step = self
            .sequence
            .map_or(1, |last| packet.sequence.wrapping_sub(last));
        match step {
            0 => {}
            1..=127 => {
                self.missed += u64::from(step) - 1;
                self.sequence = Some(packet.sequence);
            }
            _ => self.missed = self.missed.saturating_sub(1),
        }
    }

    fn hear(&mut self, now_s: f64, out: &mut Out) {
        if self.link_lost {
            self.link_lost = false;
            self.sequence = None;
            if let Some(watch) = &mut self.watch {
                // Their silence was the link's.
                watch.commands_s = now_s;
            }
            out.events.push(Event::Back {
                what: Silent::Link,
                after_s: now_s - self.heard_s,
            });
        }
        self.heard_s = now_s;
    }

    /// Makes a monitor as soon as the motors are known, and a new one where they become known better.
    fn set_up(&mut self, now_s: f64, asks: bool, estimator: &'e Estimator, out: &mut Out) {
        let done = if asks {
            self.requests.parameters_done()
        } else {
            parameters_known(&self.telemetry) || now_s - self.found_s >= LISTEN_S
        };
        // Parameters that came late are not waited for, but looked at.
        if !done || !self.telemetry.take_parameters_changed() && self.set_up_tried {
            return;
        }
        self.set_up_tried = true;
        let setup = self.telemetry.setup();
        if self
            .watch
            .as_ref()
            .is_some_and(|watch| watch.setup == setup)
        {
            return;
        }
        match Monitor::new(estimator, setup.motors.len(), &[]) {
            Ok(monitor) => {
                self.end_flight(estimator, out);
                out.events.push(Event::Ready {
                    setup: setup.clone(),
                });
                self.watch = Some(Watch {
                    motors: vec![f64::NAN; setup.motors.len()],
                    setup,
                    monitor,
                    commands_s: now_s,
                    commands_lost: false,
                    risk_sent_s: None,
                    flight: None,
                    latest: None,
                });
            }
            Err(error) => {
                let text = format!("no risk can be told: {error}");
                out.events.push(Event::Note { text });
            }
        }
    }

    /// Notices silence.
    fn listen(&mut self, now_s: f64, out: &mut Out) {
        if !self.link_lost && now_s - self.heard_s >= SILENT_S {
            self.link_lost = true;
            out.events.push(Event::Lost { what: Silent::Link });
        }
        if let Some(watch) = &mut self.watch
            && !self.link_lost
            && !watch.commands_lost
            && now_s - watch.commands_s >= SILENT_S
        {
            watch.commands_lost = true;
            let what = Silent::Motors;
            out.events.push(Event::Lost { what });
        }
    }

    fn end_flight(&mut self, estimator: &Estimator, out: &mut Out) -> Level {
        let Some(watch) = &mut self.watch else {
            return Level::Good;
        };
        let ended = watch.monitor.finish();
        tell(ended, out);
        match watch.flight.take() {
            Some(flight) => flight.end(ended, estimator, out),
            None => Level::Good,
        }
    }
}

impl Flight {
    fn end(self, ended: Ended, estimator: &Estimator, out: &mut Out) -> Level {
        let worst = self.worst.max(worst(ended)).unwrap_or(Level::Good);
        let verdict = self.tally.verdict(worst, estimator.profile(), None);
        out.events.push(Event::Landed { verdict });
        worst
    }
}

fn tell(ended: Ended, out: &mut Out) {
    let findings = ended.into_iter().flatten();
    out.events
        .extend(findings.map(|finding| Event::Ended { finding }));
}

fn worst(ended: Ended) -> Option<Level> {
    ended
        .into_iter()
        .flatten()
        .map(|finding| finding.level)
        .max()
}

#[cfg(test)]
mod tests;
