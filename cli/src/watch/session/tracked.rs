//! The vehicle that is followed: whether it is heard, what its motors are, and its flight.

use flagred::{
    estimator::Estimator,
    monitor::{Assessment, Monitor},
    verdict::{Ended, Level},
};
use flightlog::{
    Vehicle,
    mavlink::{Packet, Requests, Setup, Telemetry, Version, parameters_known},
};

use super::{Event, Out, Silent};
use crate::assessment::follow::Tally;

/// A link, or the motor commands on it, that are silent for this long are lost.
const SILENT_S: f64 = 2.0;
/// Listening without asking, this long until what is not known is assumed.
const LISTEN_S: f64 = 10.0;

/// A vehicle that is followed.
pub(super) struct Tracked<'e> {
    pub(super) telemetry: Telemetry,
    pub(super) requests: Requests,
    pub(super) found_s: f64,
    pub(super) heard_s: f64,
    pub(super) link_lost: bool,
    pub(super) set_up_tried: bool,
    pub(super) watch: Option<Watch<'e>>,
    pub(super) received: u64,
    pub(super) missed: u64,
    pub(super) sequence: Option<u8>,
}

/// A vehicle whose motors are known.
pub(super) struct Watch<'e> {
    pub(super) setup: Setup,
    pub(super) monitor: Monitor<'e>,
    pub(super) motors: Vec<f64>,
    pub(super) commands_s: f64,
    pub(super) commands_lost: bool,
    pub(super) risk_sent_s: Option<f64>,
    pub(super) flight: Option<Flight>,
    pub(super) latest: Option<Assessment>,
}

/// The flight that is on.
#[derive(Default)]
pub(super) struct Flight {
    pub(super) tally: Tally,
    pub(super) worst: Option<Level>,
    pub(super) since_s: f64,
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
    /// Starts to follow the vehicle that a heartbeat told of.
    pub(super) fn new(telemetry: Telemetry, now_s: f64) -> Tracked<'e> {
        Tracked {
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
        }
    }

    /// How things stand.
    pub(super) fn view(&self) -> View<'_> {
        let watch = self.watch.as_ref();
        let fresh = watch.filter(|watch| !self.link_lost && !watch.commands_lost);
        View {
            system: self.telemetry.system(),
            vehicle: self.telemetry.vehicle(),
            is_armed: self.telemetry.is_armed(),
            is_in_air: self.telemetry.is_in_air(),
            link_lost: self.link_lost,
            motors_lost: watch.is_some_and(|watch| watch.commands_lost),
            lost_share: self.missed as f64 / (self.missed + self.received).max(1) as f64,
            setup: watch.map(|watch| &watch.setup),
            motors: fresh.map_or(&[], |watch| &watch.motors),
            margin: fresh.and_then(|watch| watch.monitor.margin()),
            spread: fresh.and_then(|watch| watch.monitor.spread()),
            latest: fresh.and_then(|watch| watch.latest),
        }
    }

    /// How it is spoken to.
    pub(super) fn address(&self) -> (Version, u8) {
        (self.telemetry.version(), self.telemetry.system())
    }

    /// Counts what the sequence numbers of the autopilot tell to be missing; a late packet was counted as such.
    pub(super) fn count(&mut self, packet: &Packet<'_>) {
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

    pub(super) fn hear(&mut self, now_s: f64, out: &mut Out) {
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
    /// Gives the worst level of the flight that ended with the old one.
    pub(super) fn set_up(
        &mut self,
        now_s: f64,
        asks: bool,
        estimator: &'e Estimator,
        out: &mut Out,
    ) -> Level {
        let done = if asks {
            self.requests.parameters_done()
        } else {
            parameters_known(&self.telemetry) || now_s - self.found_s >= LISTEN_S
        };
        // Parameters that came late are not waited for, but looked at.
        if !done || !self.telemetry.take_parameters_changed() && self.set_up_tried {
            return Level::Good;
        }
        self.set_up_tried = true;
        let setup = self.telemetry.setup();
        if self
            .watch
            .as_ref()
            .is_some_and(|watch| watch.setup == setup)
        {
            return Level::Good;
        }
        match Monitor::new(estimator, setup.motors.len(), &[]) {
            Ok(monitor) => {
                let worst = self.end_flight(estimator, out);
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
                worst
            }
            Err(error) => {
                let text = format!("no risk can be told: {error}");
                out.events.push(Event::Note { text });
                Level::Good
            }
        }
    }

    /// Notices silence.
    pub(super) fn listen(&mut self, now_s: f64, out: &mut Out) {
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

    /// The vehicle did, so nothing that was known of it holds; gives the worst level of its flight.
    pub(super) fn start_anew(&mut self, now_s: f64, estimator: &Estimator, out: &mut Out) -> Level {
        let worst = self.end_flight(estimator, out);
        out.events.push(Event::Rebooted);
        self.watch = None;
        self.set_up_tried = false;
        self.requests = Requests::new();
        self.found_s = now_s;
        worst
    }

    pub(super) fn end_flight(&mut self, estimator: &Estimator, out: &mut Out) -> Level {
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
    pub(super) fn end(self, ended: Ended, estimator: &Estimator, out: &mut Out) -> Level {
        let worst = self.worst.max(worst(ended)).unwrap_or(Level::Good);
        let verdict = self.tally.verdict(worst, estimator.profile(), None);
        out.events.push(Event::Landed { verdict });
        worst
    }
}

pub(super) fn tell(ended: Ended, out: &mut Out) {
    let findings = ended.into_iter().flatten();
    out.events
        .extend(findings.map(|finding| Event::Ended { finding }));
}

pub(super) fn worst(ended: Ended) -> Option<Level> {
    ended
        .into_iter()
        .flatten()
        .map(|finding| finding.level)
        .max()
}
