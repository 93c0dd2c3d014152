//! The followed vehicle: its link, its motors, and its flight.

use flagred::{
    estimator::Estimator,
    flight::{Assessor, Finding, Reason, Verdict},
    monitor::{Craft, Sample, Update},
    verdict::{Level, Measure},
};
use flagred_flightlog::{
    Gap, Vehicle,
    mavlink::{Packet, Requests, Setup, Telemetry, Version, parameters_known},
};
use fuzzy::drawing::number;

use super::{
    ContactLoss, End, Event, FlightSummary, SessionOutput, SilentSource, Source, StopReason,
    history::{History, ReceivedSample},
};

/// A link, or the motor commands on it, count as lost after this silence.
const SILENT_S: f64 = 2.0;
/// A watch that sends no requests waits this long for parameters before it assumes them.
const LISTEN_S: f64 = 10.0;
/// If a vehicle is in the air, the watch waits no longer than this before it assumes missing parameters.
const IN_AIR_WAIT_S: f64 = 1.0;
/// Minimum seconds between two reports of a station that reduces the rate of the motor commands.
const SLOWED_REPORT_INTERVAL_S: f64 = 60.0;

/// A vehicle that is followed.
pub(super) struct TrackedVehicle {
    pub(super) telemetry: Telemetry,
    /// The origin of the vehicle's packets.
    pub(super) source: Source,
    /// Whether motor commands with an advancing clock were received.
    pub(super) is_confirmed: bool,
    /// Whether the connection on which the vehicle was received is closed.
    pub(super) is_gone: bool,
    pub(super) requests: Requests,
    pub(super) found_s: f64,
    pub(super) received_s: f64,
    pub(super) link_lost: bool,
    pub(super) set_up_tried: bool,
    /// The reason why the motors cannot be assessed, if there is one.
    pub(super) refused: Option<Reason>,
    /// The samples of the flight so far. Parameters that arrive later may change motors or limits, and then the flight
    /// is assessed again.
    pub(super) history: History,
    slowed_reported_s: Option<f64>,
    pub(super) watch: Option<AssessedVehicle>,
    pub(super) received: u64,
    pub(super) missed: u64,
    pub(super) sequence: Option<u8>,
}

/// A vehicle whose motors are known.
pub(super) struct AssessedVehicle {
    pub(super) setup: Setup,
    pub(super) assessor: Assessor,
    pub(super) motors: Vec<f64>,
    pub(super) commands_s: f64,
    pub(super) commands_lost: bool,
    pub(super) risk_sent_s: Option<f64>,
    pub(super) is_flying: bool,
    /// The notice that was open after the previous sample.
    pub(super) noticed: Option<Measure>,
    /// The level of the previous sample; `None` if unknown.
    pub(super) level: Option<Level>,
    pub(super) latest: Option<Update>,
}

/// The current state. Values that are out of date are omitted.
pub(crate) struct VehicleView<'a> {
    pub(crate) system: u8,
    pub(crate) vehicle: &'a Vehicle,
    pub(crate) is_armed: bool,
    pub(crate) is_in_air: bool,
    pub(crate) link_lost: bool,
    pub(crate) motors_lost: bool,
    /// The share of the vehicle's packets that were lost.
    pub(crate) lost_share: f64,
    pub(crate) setup: Option<&'a Setup>,
    /// The effective commands, where NaN means unknown.
    pub(crate) motors: &'a [f64],
    pub(crate) margin: Option<f64>,
    pub(crate) spread: Option<f64>,
    pub(crate) latest: Option<Update>,
}

impl TrackedVehicle {
    /// Starts following the vehicle that a heartbeat identified.
    pub(super) fn new(
        telemetry: Telemetry,
        source: Source,
        now_s: f64,
        history: usize,
    ) -> TrackedVehicle {
        TrackedVehicle {
            telemetry,
            source,
            is_confirmed: false,
            is_gone: false,
            requests: Requests::new(),
            found_s: now_s,
            received_s: now_s,
            link_lost: false,
            set_up_tried: false,
            refused: None,
            history: History::new(history),
            slowed_reported_s: None,
            watch: None,
            received: 0,
            missed: 0,
            sequence: None,
        }
    }

    /// The current state.
    pub(super) fn view(&self) -> VehicleView<'_> {
        let watch = self.watch.as_ref();
        let fresh = watch.filter(|watch| !self.link_lost && !watch.commands_lost);
        VehicleView {
            system: self.telemetry.system(),
            vehicle: self.telemetry.vehicle(),
            is_armed: self.telemetry.is_armed(),
            is_in_air: self.telemetry.is_in_air(),
            link_lost: self.link_lost,
            motors_lost: watch.is_some_and(|watch| watch.commands_lost),
            lost_share: self.lost_share(),
            setup: watch.map(|watch| &watch.setup),
            motors: fresh.map_or(&[], |watch| &watch.motors),
            margin: fresh.and_then(|watch| watch.assessor.monitor().margin()),
            spread: fresh.and_then(|watch| watch.assessor.monitor().spread()),
            latest: fresh.and_then(|watch| watch.latest),
        }
    }

    /// The protocol version and system of packets to the vehicle.
    pub(super) fn address(&self) -> (Version, u8) {
        (self.telemetry.version(), self.telemetry.system())
    }

    /// Counts packets that are missing according to the autopilot's sequence numbers. A packet that arrives late is
    /// removed from the count.
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

    /// The share of the vehicle's packets that were lost.
    pub(super) fn lost_share(&self) -> f64 {
        self.missed as f64 / (self.missed + self.received).max(1) as f64
    }

    /// The rate of the motor commands, if a station reduced it and a report is due.
    pub(super) fn slowed_hz(&mut self, now_s: f64) -> Option<f64> {
        let rate_hz = self.requests.take_slowed_hz()?;
        let is_due = (self.slowed_reported_s)
            .is_none_or(|reported_s| now_s - reported_s >= SLOWED_REPORT_INTERVAL_S);
        is_due.then(|| {
            self.slowed_reported_s = Some(now_s);
            rate_hz
        })
    }

    pub(super) fn level(&self) -> Option<Level> {
        self.watch.as_ref()?.latest?.level
    }

    /// Returns whether no packets arrive any more.
    pub(super) fn is_silent(&self) -> bool {
        self.link_lost || self.is_gone
    }

    pub(super) fn take_message(&mut self, now_s: f64, out: &mut SessionOutput) {
        self.is_gone = false;
        if self.link_lost {
            self.link_lost = false;
            self.sequence = None;
            self.requests.resume();
            if let Some(watch) = &mut self.watch {
                // The commands were missing because the link was lost.
                watch.commands_s = now_s;
            }
            out.events.push(Event::Back {
                what: SilentSource::Link,
                after_s: now_s - self.received_s,
            });
        }
        self.received_s = now_s;
    }

    /// Creates a monitor as soon as the motors are known, and replaces it when more is known about them; the new
    /// monitor assesses the flight from its beginning. If the flight is already too long for that, it is ended and its
    /// verdict is returned.
    pub(super) fn set_up(
        &mut self,
        now_s: f64,
        asks: bool,
        estimator: &Estimator,
        out: &mut SessionOutput,
    ) -> Option<Verdict> {
        let waited_s = now_s - self.found_s;
        let done = if asks {
            self.requests.parameters_done()
        } else {
            parameters_known(&self.telemetry) || waited_s >= LISTEN_S
        };
        let is_urgent =
            !done && self.watch.is_none() && !self.history.is_empty() && waited_s >= IN_AIR_WAIT_S;
        // A setup that changed on the ground does not apply to the previous flight, which ends with the next commands.
        if self.watch.as_ref().is_some_and(|watch| watch.is_flying) && !self.telemetry.is_in_air() {
            return None;
        }
        // The watch does not wait for late parameters, but it uses them when they arrive.
        let is_due = done && (self.telemetry.take_parameters_changed() || !self.set_up_tried);
        if !is_due && !is_urgent {
            return None;
        }
        let setup = self.telemetry.setup();
        let found = setup.motors.len();
        if is_urgent && setup.motors_expected() != Some(found) {
            return None;
        }
        if done {
            self.set_up_tried = true;
        }
        if let Some(watch) = &mut self.watch
            && watch.setup.is_equivalent(&setup)
        {
            if watch.setup != setup {
                watch.setup = setup;
                ready(&watch.setup, &self.telemetry, out);
            }
            return None;
        }
        if let Some(expected) = setup.motors_expected().filter(|&expected| expected > found) {
            let text = format!(
                "the risk cannot be assessed: outputs are known for {found} of the {expected} motors only"
            );
            out.events.push(Event::Note { text });
            self.refused = Some(Reason::Log(Gap::MotorsMissing { found, expected }));
            return None;
        }
        let geometry = setup.geometry.as_ref();
        let signals = estimator.profile().signals();
        let craft = Craft::new(found)
            .with_signals(&signals)
            .with_optional(&signals)
            .with_geometry(geometry.map_or(&[], |geometry| &geometry.factors));
        let assessor = match Assessor::new(estimator, craft, None) {
            Ok(assessor) => assessor,
            Err(error) => {
                let text = format!("the risk cannot be assessed: {error}");
                out.events.push(Event::Note { text });
                self.refused = Some(error.into());
                return None;
            }
        };
        self.refused = None;
        ready(&setup, &self.telemetry, out);
        let mut watch = AssessedVehicle::new(setup, assessor, now_s);
        let Some(flown) = self.history.whole() else {
            let verdict = self.end_flight(End::LeftInAir(StopReason::Reconfigured), out);
            self.watch = Some(watch);
            return verdict;
        };
        let before = self.watch.take();
        watch.replay(flown, out);
        match before {
            Some(before) => watch.risk_sent_s = before.risk_sent_s,
            None => {
                if let Some(first) = flown.first() {
                    out.events.push(Event::TookOff { t_s: first.t_s });
                    watch.note_assumed(out);
                }
            }
        }
        self.watch = Some(watch);
        None
    }

    /// Reports a silent link and missing motor commands.
    pub(super) fn listen(&mut self, now_s: f64, out: &mut SessionOutput) {
        if !self.link_lost && now_s - self.received_s >= SILENT_S {
            self.link_lost = true;
            out.events.push(Event::Lost {
                what: SilentSource::Link,
            });
        }
        if let Some(watch) = &mut self.watch
            && !self.link_lost
            && !watch.commands_lost
            && now_s - watch.commands_s >= SILENT_S
        {
            watch.commands_lost = true;
            let what = SilentSource::MotorCommands;
            out.events.push(Event::Lost { what });
        }
    }

    /// Resets the state of the vehicle after a reboot. Returns the verdict of the flight that the reboot ended.
    pub(super) fn start_anew(&mut self, now_s: f64, out: &mut SessionOutput) -> Option<Verdict> {
        let verdict = self.end_flight(End::Lost(ContactLoss::Reboot), out);
        out.events.push(Event::Rebooted);
        self.watch = None;
        self.history.clear();
        self.set_up_tried = false;
        self.refused = None;
        self.requests = Requests::new();
        self.found_s = now_s;
        verdict
    }

    /// Ends the current flight because the watch ends.
    pub(super) fn finish(&mut self, out: &mut SessionOutput) -> Option<Verdict> {
        let commands_lost = self.watch.as_ref().is_some_and(|watch| watch.commands_lost);
        let end = match self.telemetry.is_in_air() {
            _ if self.link_lost => End::Lost(ContactLoss::Link),
            false => End::Landed,
            true if commands_lost => End::Lost(ContactLoss::MotorCommands),
            true => End::LeftInAir(StopReason::WatchEnded),
        };
        self.end_flight(end, out)
    }

    pub(super) fn end_flight(&mut self, end: End, out: &mut SessionOutput) -> Option<Verdict> {
        let watch = self.watch.as_mut()?;
        watch.end_flight(end, out)
    }
}

/// Reports motors and limits. Adds a note if a given range is ignored.
fn ready(setup: &Setup, telemetry: &Telemetry, out: &mut SessionOutput) {
    out.events.push(Event::Ready {
        setup: setup.clone(),
        parameters: telemetry.parameters(),
    });
    if telemetry.ignores_range(setup) {
        let text = "`--range` is ignored: the vehicle reports a range of its own".to_owned();
        out.events.push(Event::Note { text });
    }
}

impl AssessedVehicle {
    fn new(setup: Setup, assessor: Assessor, now_s: f64) -> AssessedVehicle {
        AssessedVehicle {
            motors: vec![f64::NAN; setup.motors.len()],
            setup,
            assessor,
            commands_s: now_s,
            commands_lost: false,
            risk_sent_s: None,
            is_flying: false,
            noticed: None,
            level: None,
            latest: None,
        }
    }

    /// Processes a sample.
    pub(super) fn push(&mut self, received: &ReceivedSample) -> Update {
        self.setup
            .effective_commands(&received.pulses, &mut self.motors);
        self.assessor.push(&Sample {
            t_s: received.t_s,
            motors: &self.motors,
            in_air: received.in_air,
            signals: &received.signals,
        })
    }

    /// Reports inputs whose signals have not been received, and that therefore have the value of `if_missing`.
    pub(super) fn note_assumed(&self, out: &mut SessionOutput) {
        let monitor = self.assessor.monitor();
        let inputs = &monitor.estimator().profile().inputs;
        for input in monitor.assumed().filter_map(|index| inputs.get(index)) {
            let signals: Vec<&str> = input.source.signal.carried().collect();
            let text = format!(
                "`{}` has not been received yet: input `{}` is assumed to be {} (`if_missing`)",
                signals.join("` and `"),
                input.name,
                number(input.if_missing.unwrap_or(f64::NAN), 6)
            );
            out.events.push(Event::Note { text });
        }
    }

    /// Processes the samples of a flight so far; findings are reported again, levels are not.
    fn replay(&mut self, flown: &[ReceivedSample], out: &mut SessionOutput) {
        for received in flown {
            let update = self.push(received);
            self.level = update.level;
            self.latest = Some(update);
            report(self.assessor.ended(), out);
        }
        self.is_flying = !flown.is_empty();
        self.raised_notice();
    }

    /// The notice that the latest sample raised, if any.
    pub(super) fn raised_notice(&mut self) -> Option<Finding> {
        let open = self.assessor.open_notice();
        let before = std::mem::replace(&mut self.noticed, open.as_ref().map(|open| open.measure));
        open.filter(|open| before != Some(open.measure))
    }

    /// Ends the current flight, if any, and returns its verdict.
    pub(super) fn end_flight(&mut self, end: End, out: &mut SessionOutput) -> Option<Verdict> {
        if !std::mem::take(&mut self.is_flying) {
            return None;
        }
        report(self.assessor.end_findings(), out);
        let t_s = self.latest.map(|update| update.t_s);
        let seen = self.assessor.finish();
        let level_seen = match seen.verdict {
            Verdict::Known(level) => Some(level),
            Verdict::NotAvailable(_) => None,
        };
        let verdict = match end {
            End::Lost(_) => seen.verdict.lost_in_air(),
            End::Landed | End::LeftInAir(_) => seen.verdict,
        };
        let flown = FlightSummary {
            t_s,
            verdict: verdict.clone(),
            level_seen,
            risk_max: seen.summary.risk_max.map(|peak| peak.value_pct),
        };
        out.events.push(Event::Over { end, flown });
        Some(verdict)
    }
}

pub(super) fn report(ended: &[Finding], out: &mut SessionOutput) {
    let findings = ended.iter().cloned();
    out.events
        .extend(findings.map(|finding| Event::Ended { finding }));
}
