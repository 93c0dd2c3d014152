//! The core of `flagred watch`: receives packets, and returns events and packets to send. Sockets, files and the
//! screen are handled elsewhere.
//!
//! There are two clocks. The risk is computed over the vehicle's clock, which its motor commands contain. The
//! state of the link (silence, repeated requests, sending rates) depends on the receiver's clock, which is
//! passed in.

use flagred::{
    estimator::Estimator,
    flight::{Finding, Reason, Verdict},
    monitor::{Unknown, Update},
    verdict::Level,
};
use flagred_flightlog::{
    PulseRange,
    mavlink::{MOTOR_RATE_HZ, Packet, Sender, Telemetry, TelemetryChange, Version, vehicle_of},
};

mod event;
mod history;
mod tracked_vehicle;
mod trust;
mod watch_sender;

use super::messages;
pub(crate) use event::{ContactLoss, End, Event, FlightSummary, SilentSource, StopReason};
use flagred_report::finding::numbered;
use history::ReceivedSample;
pub(crate) use tracked_vehicle::VehicleView;
use tracked_vehicle::{AssessedVehicle, TrackedVehicle, report};
use trust::{Candidates, Evidence, doubt_of};
pub(crate) use trust::{Source, UntrustedCounts, UntrustedPacket, may_be_multirotor};
use watch_sender::WatchSender;

/// Seconds between two heartbeats.
const HEARTBEAT_S: f64 = 1.0;
/// Seconds between two sent risks. At this rate one arrives every second even if the link loses a tenth of its packets.
const RISK_S: f64 = 0.25;
/// A vehicle that sends no motor commands for this long despite requests is replaced by another one.
const CONFIRMATION_WAIT_S: f64 = 5.0;
/// A vehicle that is silent for this long is replaced by a vehicle with another system id.
const GONE_S: f64 = 30.0;
/// Maximum number of other systems that are remembered: MAVLink has no more than 256 system ids.
const SYSTEMS: usize = 256;

/// The output of a session.
#[derive(Default)]
pub(crate) struct SessionOutput {
    pub(crate) events: Vec<Event>,
    /// Packets to send, in order.
    pub(crate) packets: Vec<Vec<u8>>,
}

/// Follows the first sender on a link that proves to be a vehicle.
pub(crate) struct Session<'e> {
    estimator: &'e Estimator,
    watch_sender: WatchSender,
    tracked: Option<TrackedVehicle>,
    candidates: Candidates,
    doubts: UntrustedCounts,
    others: Vec<u8>,
    heartbeat_s: Option<f64>,
    /// The worst verdict of the flights so far.
    worst: Verdict,
    /// The verdict for parts of flights in which the risk is unknown, if there are any.
    unknown_part: Option<Verdict>,
    /// Maximum number of stored samples of a flight.
    history: usize,
    /// The range of motor outputs to assume if the vehicle does not report it.
    range: Option<PulseRange>,
}

impl<'e> Session<'e> {
    /// Creates a session that sends with `sender`, or only listens if there is none. If another watch already sends
    /// warnings, this session does so only if it `insists`.
    pub(crate) fn new(
        estimator: &'e Estimator,
        sender: Option<Sender>,
        insists: bool,
    ) -> Session<'e> {
        Session {
            estimator,
            watch_sender: WatchSender::new(sender, insists),
            tracked: None,
            candidates: Candidates::default(),
            doubts: UntrustedCounts::default(),
            others: Vec::new(),
            heartbeat_s: None,
            worst: Verdict::NotAvailable(Reason::NoFlight),
            unknown_part: None,
            history: history::MAX_SAMPLES,
            range: None,
        }
    }

    /// Sets the range of motor outputs to assume if a vehicle does not report its own.
    pub(crate) fn with_range(self, range: Option<PulseRange>) -> Session<'e> {
        Session { range, ..self }
    }

    /// Sets the maximum number of stored samples of a flight.
    pub(crate) fn keeping(self, history: usize) -> Session<'e> {
        Session { history, ..self }
    }

    /// Processes a packet from `source` at `now_s` of the receiver's clock, and returns whether it comes from the vehicle.
    pub(crate) fn receive(
        &mut self,
        now_s: f64,
        source: Source,
        packet: &Packet<'_>,
        out: &mut SessionOutput,
    ) -> bool {
        // A message of an unknown type cannot be verified. It is counted as a packet of its sender and recorded, but
        // not evaluated.
        if packet.sound.is_none() {
            let is_followed = self.is_followed(source, packet);
            if let Some(tracked) = self.tracked.as_mut().filter(|_| is_followed) {
                tracked.count(packet);
            }
            return is_followed;
        }
        if !self.is_followed(source, packet) {
            self.take_doubtful(now_s, source, packet, out);
            if !self.consider(now_s, source, packet, out) {
                return false;
            }
        }
        let Some(tracked) = &mut self.tracked else {
            return false;
        };
        self.watch_sender
            .take_message(now_s, packet, echoes(&tracked.telemetry), out);
        tracked.count(packet);
        tracked.take_message(now_s, out);
        let jumps = tracked.telemetry.clock_jumps();
        let news = tracked.telemetry.receive(packet, now_s);
        let jumps = tracked.telemetry.clock_jumps() - jumps;
        if self.doubts.add(UntrustedPacket::ClockJump, jumps) {
            out.events
                .push(untrusted_event(UntrustedPacket::ClockJump, source, packet));
        }
        match news {
            TelemetryChange::Rebooted => {
                let verdict = tracked.start_anew(now_s, out);
                add(&mut self.worst, verdict);
            }
            TelemetryChange::Commands { t_s } => {
                if !std::mem::replace(&mut tracked.is_confirmed, true) {
                    let system = packet.system;
                    out.events.push(Event::Locked {
                        system,
                        address: source,
                    });
                    self.candidates.clear();
                }
                self.assess(now_s, t_s, out);
            }
            _ => {}
        }
        true
    }

    /// Notes that the connection has closed. The vehicle may return on another one.
    pub(crate) fn closed(&mut self) {
        if let Some(tracked) = &mut self.tracked {
            tracked.is_gone = true;
        }
    }

    /// Returns whether a packet of another sender could be mistaken for a packet of the vehicle if addresses are
    /// unknown.
    pub(crate) fn is_doubtful(&self, packet: &Packet<'_>) -> bool {
        let tracked = self.tracked.as_ref();
        match doubt_of(packet) {
            Some(UntrustedPacket::OtherComponent) => true,
            Some(_) => tracked.is_some_and(|it| it.telemetry.system() == packet.system),
            None => false,
        }
    }

    /// The numbers of packets that were not trusted.
    pub(crate) fn doubts(&self) -> UntrustedCounts {
        self.doubts
    }

    fn is_followed(&self, source: Source, packet: &Packet<'_>) -> bool {
        let is_it = |tracked: &TrackedVehicle| {
            (tracked.telemetry.system(), tracked.source) == (packet.system, source)
        };
        packet.component == 1 && self.tracked.as_ref().is_some_and(is_it)
    }

    /// Counts a doubtful packet of the vehicle's system. A second sender is not counted while the vehicle is silent.
    fn take_doubtful(
        &mut self,
        now_s: f64,
        source: Source,
        packet: &Packet<'_>,
        out: &mut SessionOutput,
    ) {
        let Some(tracked) = &self.tracked else {
            return;
        };
        if tracked.telemetry.system() != packet.system {
            return;
        }
        if packet.component != 1 {
            self.watch_sender.take_message(now_s, packet, false, out);
        }
        let doubt = doubt_of(packet);
        let is_other_end = doubt == Some(UntrustedPacket::SecondSender) && tracked.is_silent();
        if let Some(doubt) = doubt.filter(|_| !is_other_end)
            && self.doubts.add(doubt, 1)
        {
            out.events.push(untrusted_event(doubt, source, packet));
        }
    }

    /// Performs the periodic work that does not depend on packets. Must be called often.
    pub(crate) fn tick(&mut self, now_s: f64, out: &mut SessionOutput) {
        self.send_requests(now_s, out);
        self.beat(now_s, out);
        let Some(tracked) = &mut self.tracked else {
            return;
        };
        let before = tracked.level();
        let verdict = tracked.set_up(now_s, self.watch_sender.may_request(), self.estimator, out);
        let to = tracked.address();
        if let Some(watch) = tracked.watch.as_mut().filter(|watch| watch.is_flying)
            && let Some(update) = watch.latest
            && update
                .level
                .is_some_and(|level| level != before.unwrap_or(Level::Good))
        {
            let finding = watch.assessor.open_finding();
            report_level(
                now_s,
                to,
                &mut self.watch_sender,
                (watch, &update, before),
                finding,
                out,
            );
        }
        if let Some(Verdict::NotAvailable(_)) = &verdict {
            self.unknown_part = verdict.clone();
        }
        self.watch_sender
            .tick(now_s, tracked.telemetry.system(), out);
        tracked.listen(now_s, out);
        add(&mut self.worst, verdict);
    }

    /// Ends the watch and the current flight. Returns the worst verdict of the flights.
    pub(crate) fn finish(&mut self, out: &mut SessionOutput) -> Verdict {
        let verdict = self
            .tracked
            .as_mut()
            .and_then(|tracked| tracked.finish(out));
        add(&mut self.worst, verdict);
        let is_mute =
            (self.tracked.as_ref()).is_some_and(|tracked| !tracked.telemetry.has_commands());
        if self.worst == Verdict::NotAvailable(Reason::NoFlight) {
            if is_mute {
                return Verdict::NotAvailable(Reason::NoMotorOutputs);
            }
            let refused = self.tracked.as_mut().and_then(|t| t.refused.take());
            if let Some(reason) = refused {
                return Verdict::NotAvailable(reason);
            }
        }
        match (&self.worst, self.unknown_part.take()) {
            // A flight is not GOOD if a part of it is unknown.
            (Verdict::Known(Level::Good | Level::Info), Some(part)) => part,
            _ => self.worst.clone(),
        }
    }

    /// Decides whether to follow the sender of a packet from now on, and returns the decision.
    fn consider(
        &mut self,
        now_s: f64,
        source: Source,
        packet: &Packet<'_>,
        out: &mut SessionOutput,
    ) -> bool {
        let is_open = (self.tracked.as_ref())
            .is_none_or(|tracked| !tracked.is_confirmed || tracked.is_silent());
        if is_open {
            self.candidates.take_message(source, packet);
        }
        let Some(vehicle) = vehicle_of(packet) else {
            return false;
        };
        let system = packet.system;
        let followed = self.tracked.as_ref().map(|t| t.telemetry.system());
        if followed.is_some_and(|followed| followed != system) && self.is_new(system) {
            out.events.push(Event::AnotherVehicle { system });
        }
        if !may_be_multirotor(&vehicle) {
            if self.is_new(system) {
                out.events.push(Event::NotAMultirotor { system, vehicle });
            }
            return false;
        }
        if !is_open {
            return false;
        }
        let evidence = self.candidates.beat(now_s, source, system, &vehicle);
        if evidence == Evidence::None {
            return false;
        }
        if let Some(tracked) = &mut self.tracked {
            let is_same = followed == Some(system) && *tracked.telemetry.vehicle() == vehicle;
            if tracked.is_confirmed && is_same {
                out.events.push(Event::SenderChanged {
                    system,
                    from: std::mem::replace(&mut tracked.source, source),
                    to: source,
                });
                self.candidates.clear();
                return true;
            }
            let is_unanswered =
                self.watch_sender.may_request() && now_s - tracked.found_s >= CONFIRMATION_WAIT_S;
            let is_replaced = match tracked.is_confirmed {
                true => now_s - tracked.received_s >= GONE_S,
                false => tracked.is_silent() || evidence == Evidence::Commands || is_unanswered,
            };
            if !is_replaced {
                return false;
            }
            let verdict = tracked.end_flight(End::Lost(ContactLoss::Link), out);
            add(&mut self.worst, verdict);
            let system = tracked.telemetry.system();
            out.events.push(Event::GivenUp { system });
        }
        let telemetry = Telemetry::new(packet, vehicle.clone())
            .with_range(self.range)
            .with_signals(&self.estimator.profile().signals());
        self.tracked = Some(TrackedVehicle::new(telemetry, source, now_s, self.history));
        self.candidates.clear();
        self.watch_sender.forget();
        self.heartbeat_s = None;
        out.events.push(Event::Found { system, vehicle });
        true
    }

    fn is_new(&mut self, system: u8) -> bool {
        let is_new = !self.others.contains(&system) && self.others.len() < SYSTEMS;
        if is_new {
            self.others.push(system);
        }
        is_new
    }

    fn send_requests(&mut self, now_s: f64, out: &mut SessionOutput) {
        if let Some(tracked) = &mut self.tracked
            && self.watch_sender.may_request()
            && !tracked.is_silent()
        {
            let mut messages = Vec::new();
            let lost_share = tracked.lost_share();
            tracked
                .requests
                .due(now_s, &tracked.telemetry, lost_share, &mut messages);
            let to = tracked.address();
            for message in &messages {
                self.watch_sender.request(to, message, out);
            }
            if let Some(rate_hz) = tracked.slowed_hz(now_s) {
                let by = tracked.telemetry.rate_asker();
                out.events.push(Event::Slowed {
                    rate_hz,
                    wanted_hz: MOTOR_RATE_HZ,
                    system: by.map(|(system, _)| system),
                    component: by.map(|(_, component)| component),
                });
                if tracked.telemetry.is_in_air() {
                    let text = messages::status(Level::Warn, &messages::slowed_text(rate_hz, by));
                    self.watch_sender.warn(now_s, to, &text, out);
                }
            }
        }
    }

    fn beat(&mut self, now_s: f64, out: &mut SessionOutput) {
        let due = self
            .heartbeat_s
            .is_none_or(|sent_s| now_s - sent_s >= HEARTBEAT_S);
        if due {
            self.heartbeat_s = Some(now_s);
            let to = self.tracked.as_ref().map_or(
                (Version::V2, messages::DEFAULT_SYSTEM),
                TrackedVehicle::address,
            );
            self.watch_sender
                .send(now_s, to, &messages::heartbeat(now_s), out);
        }
    }

    fn assess(&mut self, now_s: f64, t_s: f64, out: &mut SessionOutput) {
        let Some(tracked) = &mut self.tracked else {
            return;
        };
        let to = tracked.address();
        let in_air = tracked.telemetry.is_in_air();
        let reported = tracked.telemetry.reported_in_air(now_s);
        let received = ReceivedSample {
            t_s,
            in_air: reported,
            pulses: tracked.telemetry.pulses(),
            signals: tracked.telemetry.signals().collect(),
        };
        if in_air {
            tracked.history.push(received.clone());
        } else {
            tracked.history.clear();
        }
        let Some(watch) = &mut tracked.watch else {
            return;
        };
        if watch.commands_lost {
            watch.commands_lost = false;
            out.events.push(Event::Back {
                what: SilentSource::MotorCommands,
                after_s: now_s - watch.commands_s,
            });
        }
        watch.commands_s = now_s;
        let update = watch.push(&received);
        if update.risk == Err(Unknown::OutOfOrder) {
            return;
        }
        watch.latest = Some(update);
        report(watch.assessor.ended(), out);
        if in_air && !watch.is_flying {
            watch.is_flying = true;
            out.events.push(Event::TookOff { t_s });
            watch.note_assumed(out);
        } else if !in_air {
            let verdict = watch.end_flight(End::Landed, out);
            add(&mut self.worst, verdict);
        }
        out.events.push(Event::Risk { update });
        let before = std::mem::replace(&mut watch.level, update.level);
        // A notice is also reported if it is raised while the level does not change.
        let raised = watch.raised_notice();
        let is_new = match (before, update.level) {
            (None, Some(level)) => level > Level::Good,
            // A landing is a separate event.
            (Some(before), None) => before > Level::Good && update.risk != Err(Unknown::OnGround),
            (before, level) => before != level,
        };
        if in_air && (is_new || raised.is_some() && update.level.is_some()) {
            let finding = if is_new {
                watch.assessor.open_finding()
            } else {
                raised
            };
            report_level(
                now_s,
                to,
                &mut self.watch_sender,
                (watch, &update, before),
                finding,
                out,
            );
        }
        let due = watch
            .risk_sent_s
            .is_none_or(|sent_s| now_s - sent_s >= RISK_S);
        if due
            && self.watch_sender.is_sending()
            && let Ok(estimate) = update.risk
            && let Some(elevated_pct) = update.elevated_risk_pct
        {
            watch.risk_sent_s = Some(now_s);
            for (name, value) in [
                (messages::RISK, estimate.risk_pct),
                (messages::ELEVATED, elevated_pct),
            ] {
                self.watch_sender
                    .send(now_s, to, &messages::value(t_s, name, value), out);
            }
        }
    }

    /// The current state, for a screen.
    pub(crate) fn view(&self) -> Option<VehicleView<'_>> {
        self.tracked.as_ref().map(TrackedVehicle::view)
    }
}

/// Reports a change of level, and sends its text.
fn report_level(
    now_s: f64,
    to: (Version, u8),
    watch_sender: &mut WatchSender,
    (watch, update, before): (&AssessedVehicle, &Update, Option<Level>),
    finding: Option<Finding>,
    out: &mut SessionOutput,
) {
    let finding = finding.map(|finding| numbered(&finding, &watch.setup.motors));
    let words = finding
        .as_ref()
        .map(|finding| finding.words(watch.assessor.monitor().estimator()));
    let (severity, text) = match update.level {
        Some(level) => (
            level,
            messages::level_text(level, update, finding.as_ref().zip(words.as_ref())),
        ),
        None => (
            Level::Warn,
            messages::unknown_text(before.unwrap_or(Level::Warn)),
        ),
    };
    watch_sender.warn(now_s, to, &messages::status(severity, &text), out);
    let (code, advice) = words.map(|words| (words.code, words.advice)).unzip();
    out.events.push(Event::Level {
        t_s: update.t_s,
        level: update.level,
        before,
        text,
        code,
        advice,
        motor: finding.as_ref().and_then(|finding| finding.motor),
        cause: finding.and_then(|finding| finding.cause),
    });
}

/// Returns whether an autopilot forwards values of other senders as its own.
fn echoes(telemetry: &Telemetry) -> bool {
    let firmware = telemetry.vehicle().firmware.as_deref();
    firmware.is_some_and(|firmware| firmware.starts_with("PX4"))
}

/// Converts a doubt to an event.
fn untrusted_event(what: UntrustedPacket, source: Source, packet: &Packet<'_>) -> Event {
    Event::Doubt {
        what,
        system: packet.system,
        component: packet.component,
        address: source,
    }
}

/// Adds a verdict; the worst one is kept.
fn add(worst: &mut Verdict, verdict: Option<Verdict>) {
    if let Some(verdict) = verdict {
        *worst = verdict.worst(worst.clone());
    }
}

#[cfg(test)]
pub(crate) mod tests;
