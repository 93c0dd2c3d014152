//! Many vehicles: a separate session follows each sender of a multirotor's heartbeats.

use std::collections::HashMap;

use flagred::{
    estimator::Estimator,
    flight::{Reason, Verdict},
};
use flagred_flightlog::mavlink::{Packet, vehicle_of};

use super::session::{Event, Session, SessionOutput, Source, VehicleView, may_be_multirotor};

/// Maximum number of vehicles at a time.
const MAX_VEHICLES: usize = 1_000;
/// Maximum number of vehicles that the summary lists although they are no longer received.
const MAX_GONE: usize = 10_000;
/// A sender without evidence that it is a vehicle is dropped after this many seconds of silence.
const STRAY_S: f64 = 10.0;
/// A vehicle is dropped after this many seconds of silence. If it is received again, it counts as
/// new.
const GONE_S: f64 = 60.0;
/// Maximum number of samples of a flight that are stored in case limits become known later: a minute at 25 Hz, which
/// takes 0.1 MB.
const HISTORY: usize = 1_500;

/// The identity of a vehicle. Senders with the same system id count as different vehicles, since every new autopilot
/// has system id 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) struct VehicleId {
    pub(crate) link: usize,
    pub(crate) source: Source,
    pub(crate) system: u8,
}

/// A vehicle that is followed.
pub(crate) struct Member<'e> {
    pub(crate) session: Session<'e>,
    received_s: f64,
    risk_max: Option<f64>,
}

/// The summary of a vehicle.
#[derive(Debug, Clone)]
pub(crate) struct Summary {
    pub(crate) id: VehicleId,
    pub(crate) verdict: Verdict,
    pub(crate) risk_max: Option<f64>,
    pub(crate) lost_share: f64,
}

/// All vehicles that are received.
pub(crate) struct Fleet<'e> {
    estimator: &'e Estimator,
    members: HashMap<VehicleId, Member<'e>>,
    gone: Vec<Summary>,
    out: SessionOutput,
    /// The number of heartbeats of further vehicles that were ignored because the maximum number of vehicles was reached.
    pub(crate) refused: u64,
    /// The number of dropped vehicles that are missing from the summary, because it is full.
    pub(crate) forgotten: u64,
}

impl<'e> Fleet<'e> {
    pub(crate) fn new(estimator: &'e Estimator) -> Fleet<'e> {
        Fleet {
            estimator,
            members: HashMap::new(),
            gone: Vec::new(),
            out: SessionOutput::default(),
            refused: 0,
            forgotten: 0,
        }
    }

    /// Processes a packet, and calls `report` with each event that it causes.
    pub(crate) fn receive(
        &mut self,
        now_s: f64,
        (link, source): (usize, Source),
        packet: &Packet<'_>,
        mut report: impl FnMut(VehicleId, &Event, &Session<'e>),
    ) {
        let system = packet.system;
        let id = VehicleId {
            link,
            source,
            system,
        };
        if !self.members.contains_key(&id) {
            if !vehicle_of(packet).is_some_and(|vehicle| may_be_multirotor(&vehicle)) {
                return;
            }
            if self.members.len() >= MAX_VEHICLES {
                self.refused += 1;
                return;
            }
        }
        let estimator = self.estimator;
        let member = self.members.entry(id).or_insert_with(|| Member {
            session: Session::new(estimator, None, false).keeping(HISTORY),
            received_s: now_s,
            risk_max: None,
        });
        member.received_s = now_s;
        member.session.receive(now_s, source, packet, &mut self.out);
        member.report(id, &mut self.out, &mut report);
    }

    /// Performs the periodic work, and drops silent vehicles.
    pub(crate) fn tick(
        &mut self,
        now_s: f64,
        mut report: impl FnMut(VehicleId, &Event, &Session<'e>),
    ) {
        let mut gone = Vec::new();
        for (id, member) in &mut self.members {
            member.session.tick(now_s, &mut self.out);
            member.report(*id, &mut self.out, &mut report);
            let silent_s = now_s - member.received_s;
            let is_stray = member.session.view().is_none();
            if silent_s >= if is_stray { STRAY_S } else { GONE_S } {
                gone.push((*id, is_stray));
            }
        }
        for (id, is_stray) in gone {
            let Some(mut member) = self.members.remove(&id) else {
                continue;
            };
            let summary = member.finish(id, &mut self.out, &mut report);
            match is_stray {
                true => {}
                false if self.gone.len() >= MAX_GONE => self.forgotten += 1,
                false => self.gone.push(summary),
            }
        }
    }

    /// Ends all flights, and returns a summary of each vehicle, the worst first.
    pub(crate) fn finish(
        &mut self,
        mut report: impl FnMut(VehicleId, &Event, &Session<'e>),
    ) -> Vec<Summary> {
        let mut all = std::mem::take(&mut self.gone);
        for (id, mut member) in self.members.drain() {
            if member.session.view().is_some() {
                all.push(member.finish(id, &mut self.out, &mut report));
            }
        }
        all.sort_by(|a, b| {
            severity_value(b)
                .total_cmp(&severity_value(a))
                .then(a.id.cmp(&b.id))
        });
        all
    }

    /// The vehicles that were found: those with the worst level first, then those with the highest risk. A vehicle in
    /// the air with unknown risk ranks between WARN and GOOD, a vehicle on the ground last.
    pub(crate) fn views(&self) -> Vec<(VehicleId, VehicleView<'_>)> {
        let members = self.members.iter();
        let mut views: Vec<(VehicleId, VehicleView<'_>)> = members
            .filter_map(|(id, member)| Some((*id, member.session.view()?)))
            .collect();
        let rank = |view: &VehicleView<'_>| {
            let level = view.latest.and_then(|latest| latest.level);
            level.map_or(if view.is_in_air { 1.5 } else { -1.0 }, |level| {
                f64::from(level as u8)
            })
        };
        let risk = |view: &VehicleView<'_>| {
            let risk = view.latest.and_then(|latest| latest.risk.ok());
            risk.map_or(-1.0, |estimate| estimate.risk_pct)
        };
        views.sort_by(|(a_id, a), (b_id, b)| {
            (rank(b).total_cmp(&rank(a)))
                .then(risk(b).total_cmp(&risk(a)))
                .then(a_id.cmp(b_id))
        });
        views
    }
}

impl<'e> Member<'e> {
    fn report(
        &mut self,
        id: VehicleId,
        out: &mut SessionOutput,
        report: &mut impl FnMut(VehicleId, &Event, &Session<'e>),
    ) {
        // A fleet sends nothing.
        out.packets.clear();
        for event in out.events.drain(..) {
            if let Event::Risk { update } = &event
                && let Ok(estimate) = update.risk
            {
                let most = self.risk_max.unwrap_or(estimate.risk_pct);
                self.risk_max = Some(most.max(estimate.risk_pct));
            }
            report(id, &event, &self.session);
        }
    }

    fn finish(
        &mut self,
        id: VehicleId,
        out: &mut SessionOutput,
        report: &mut impl FnMut(VehicleId, &Event, &Session<'e>),
    ) -> Summary {
        let verdict = self.session.finish(out);
        self.report(id, out, report);
        Summary {
            id,
            verdict,
            risk_max: self.risk_max,
            lost_share: self.session.view().map_or(0.0, |view| view.lost_share),
        }
    }
}

/// The worst verdict of several vehicles. A vehicle that never flew counts only if no other verdict is available.
pub(crate) fn worst(all: &[Summary]) -> Verdict {
    let none = Verdict::NotAvailable(Reason::NoFlight);
    all.iter()
        .fold(none, |worst, one| one.verdict.clone().worst(worst))
}

fn severity_value(summary: &Summary) -> f64 {
    let verdict = match summary.verdict {
        Verdict::Known(level) => 200.0 * (1.0 + f64::from(level as u8)),
        Verdict::NotAvailable(Reason::NoFlight) => 0.0,
        Verdict::NotAvailable(_) => 300.0,
    };
    verdict + summary.risk_max.unwrap_or(0.0)
}

#[cfg(test)]
pub(crate) mod tests {
    use flagred_flightlog::mavlink::{
        PacketScan, Sender, Version, dialect::MavMessage, next_packet,
    };

    use super::*;
    use crate::watch::session::tests::{estimator, quadrotor, servo};

    /// A fleet on one link, and its clock.
    pub(crate) struct TestLink<'e> {
        pub(crate) fleet: Fleet<'e>,
        now_s: f64,
    }

    impl<'e> TestLink<'e> {
        pub(crate) fn new(estimator: &'e Estimator) -> TestLink<'e> {
            TestLink {
                fleet: Fleet::new(estimator),
                now_s: 0.0,
            }
        }

        fn take_message(&mut self, system: u8, message: &MavMessage) {
            let bytes = Sender::new(1).packet(Version::V2, system, message);
            let PacketScan::Packet(packet) = next_packet(&bytes) else {
                panic!("{bytes:?}");
            };
            (self.fleet).receive(self.now_s, (0, None), &packet, |_, _, _| {});
        }

        /// Advances the time; vehicles send pulses at 10 Hz, and heartbeats.
        pub(crate) fn fly(&mut self, seconds: u32, vehicles: &[(u8, bool, [u16; 4])]) {
            for tick in 0..10 * seconds {
                for (system, in_air, pulses_us) in vehicles {
                    if tick % 10 == 0 {
                        self.take_message(*system, &quadrotor(*in_air));
                    }
                    self.take_message(*system, &servo(self.now_s, *pulses_us));
                }
                self.now_s += 0.1;
                self.fleet.tick(self.now_s, |_, _, _| {});
            }
        }

        fn systems(&self) -> Vec<u8> {
            self.fleet.views().iter().map(|(id, _)| id.system).collect()
        }
    }

    pub(crate) const HOVER: [u16; 4] = [1500; 4];
    pub(crate) const AT_LIMITS: [u16; 4] = [1000, 2000, 1000, 2000];

    #[test]
    fn a_vehicle_lost_in_the_air_is_listed_above_good_ones() {
        let estimator = estimator();
        let mut air = TestLink::new(&estimator);
        let calm = [(1, false, [1000; 4]), (2, true, HOVER), (3, true, HOVER)];
        air.fly(40, &[calm[0], calm[1], calm[2], (4, true, HOVER)]);
        air.fly(8, &[calm[0], calm[1], (4, true, AT_LIMITS)]);
        assert_eq!(air.systems(), [4, 3, 2, 1]);
        let views = air.fleet.views();
        assert!(views[1].1.link_lost && views[1].1.latest.is_none());
    }

    #[test]
    fn a_vehicle_without_motor_outputs_ends_with_that_reason() {
        let estimator = estimator();
        let mut air = TestLink::new(&estimator);
        for second in 0..40 {
            air.fly(1, &[(1, true, HOVER), (3, false, [1000; 4])]);
            air.take_message(2, &quadrotor(second > 10));
        }
        let all = air.fleet.finish(|_, _, _| {});
        let verdicts: Vec<(u8, String, String)> = all
            .iter()
            .map(|one| {
                let reason = crate::watch::lines::reason(&one.verdict);
                (
                    one.id.system,
                    one.verdict.to_string(),
                    reason.unwrap_or_default(),
                )
            })
            .collect();
        let expected = [
            (
                2,
                "NA",
                "the vehicle did not send motor outputs (SERVO_OUTPUT_RAW)",
            ),
            (1, "GOOD", ""),
            (3, "NA", "no flight was observed"),
        ];
        assert_eq!(
            verdicts,
            expected.map(|(id, verdict, reason)| (id, verdict.to_owned(), reason.to_owned()))
        );
        let Verdict::NotAvailable(reason) = &all[0].verdict else {
            panic!("{:?}", all[0]);
        };
        assert!(reason.help().unwrap().contains("SRx_RC_CHAN"));
    }

    #[test]
    fn a_vehicle_that_is_silent_for_a_minute_is_gone_and_its_summary_stays() {
        let estimator = estimator();
        let mut air = TestLink::new(&estimator);
        let (one, other) = ((1, true, HOVER), (2, true, HOVER));
        air.fly(30, &[one, other]);
        air.fly(59, &[other]);
        assert_eq!(air.fleet.members.len(), 2);
        air.fly(2, &[other]);
        assert_eq!(air.systems(), [2]);
        // After the silence, the vehicle counts as new.
        air.fly(30, &[one, other]);
        air.fly(5, &[(1, false, [1000; 4]), (2, false, [1000; 4])]);
        let all = air.fleet.finish(|_, _, _| {});
        let verdicts: Vec<(u8, String)> = all
            .iter()
            .map(|one| (one.id.system, one.verdict.to_string()))
            .collect();
        let expected = [(1, "NA"), (1, "GOOD"), (2, "GOOD")];
        assert_eq!(
            verdicts,
            expected.map(|(id, verdict)| (id, verdict.to_owned()))
        );
    }

    #[test]
    fn stray_senders_are_forgotten_and_vehicles_beyond_the_limit_are_counted() {
        let estimator = estimator();
        let mut fleet = Fleet::new(&estimator);
        let bytes = Sender::new(1).packet(Version::V2, 1, &quadrotor(false));
        let PacketScan::Packet(packet) = next_packet(&bytes) else {
            panic!("{bytes:?}");
        };
        for link in 0..MAX_VEHICLES + 7 {
            fleet.receive(0.0, (link, None), &packet, |_, _, _| {});
        }
        assert_eq!((fleet.members.len(), fleet.refused), (MAX_VEHICLES, 7));
        fleet.tick(STRAY_S - 0.1, |_, _, _| {});
        assert_eq!(fleet.members.len(), MAX_VEHICLES);
        fleet.tick(STRAY_S, |_, _, _| {});
        assert!(fleet.members.is_empty() && fleet.finish(|_, _, _| {}).is_empty());
    }
}
