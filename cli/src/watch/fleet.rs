//! Many vehicles: each sender of a multirotor's heartbeats is followed by a session of its own.

use std::collections::HashMap;

use flagred::{
    estimator::Estimator,
    flight::{Reason, Verdict},
};
use flightlog::mavlink::{Packet, vehicle_of};

use super::session::{Event, Out, Session, Source, View, may_be_multirotor};

/// Vehicles at a time.
const MOST: usize = 1_000;
/// Vehicles that are gone, in the summary.
const MOST_GONE: usize = 10_000;
/// A sender that is silent for so long without having proved to be a vehicle is forgotten.
const STRAY_S: f64 = 10.0;
/// A vehicle that is silent for so long is gone; when it is heard again it is a new one.
const GONE_S: f64 = 60.0;
/// Samples of a flight that are kept while limits are not known: a minute at 25 Hz, in 0.1 MB.
const HISTORY: usize = 1_500;

/// Who a vehicle is: systems of different senders are different vehicles, since a new autopilot is number 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) struct Id {
    pub(crate) link: usize,
    pub(crate) source: Source,
    pub(crate) system: u8,
}

/// A vehicle that is followed.
pub(crate) struct Member<'e> {
    pub(crate) session: Session<'e>,
    heard_s: f64,
    risk_max: Option<f64>,
}

/// What is left of a vehicle.
#[derive(Debug, Clone)]
pub(crate) struct Summary {
    pub(crate) id: Id,
    pub(crate) verdict: Verdict,
    pub(crate) risk_max: Option<f64>,
    pub(crate) lost_share: f64,
}

/// All vehicles that are heard.
pub(crate) struct Fleet<'e> {
    estimator: &'e Estimator,
    members: HashMap<Id, Member<'e>>,
    gone: Vec<Summary>,
    out: Out,
    /// Heartbeats of vehicles beyond the bound, and vehicles that are gone and not in the summary.
    pub(crate) refused: u64,
    pub(crate) forgotten: u64,
}

impl<'e> Fleet<'e> {
    pub(crate) fn new(estimator: &'e Estimator) -> Fleet<'e> {
        Fleet {
            estimator,
            members: HashMap::new(),
            gone: Vec::new(),
            out: Out::default(),
            refused: 0,
            forgotten: 0,
        }
    }

    /// Takes in a packet, and calls `tell` with what it changed.
    pub(crate) fn receive(
        &mut self,
        now_s: f64,
        (link, source): (usize, Source),
        packet: &Packet<'_>,
        mut tell: impl FnMut(Id, &Event, &Session<'e>),
    ) {
        let system = packet.system;
        let id = Id {
            link,
            source,
            system,
        };
        if !self.members.contains_key(&id) {
            if !vehicle_of(packet).is_some_and(|vehicle| may_be_multirotor(&vehicle)) {
                return;
            }
            if self.members.len() >= MOST {
                self.refused += 1;
                return;
            }
        }
        let estimator = self.estimator;
        let member = self.members.entry(id).or_insert_with(|| Member {
            session: Session::new(estimator, None, false).keeping(HISTORY),
            heard_s: now_s,
            risk_max: None,
        });
        member.heard_s = now_s;
        member.session.receive(now_s, source, packet, &mut self.out);
        member.tell(id, &mut self.out, &mut tell);
    }

    /// What is due without any packet; forgets who is gone.
    pub(crate) fn tick(&mut self, now_s: f64, mut tell: impl FnMut(Id, &Event, &Session<'e>)) {
        let mut gone = Vec::new();
        for (id, member) in &mut self.members {
            member.session.tick(now_s, &mut self.out);
            member.tell(*id, &mut self.out, &mut tell);
            let silent_s = now_s - member.heard_s;
            let is_stray = member.session.view().is_none();
            if silent_s >= if is_stray { STRAY_S } else { GONE_S } {
                gone.push((*id, is_stray));
            }
        }
        for (id, is_stray) in gone {
            let Some(mut member) = self.members.remove(&id) else {
                continue;
            };
            let summary = member.finish(id, &mut self.out, &mut tell);
            match is_stray {
                true => {}
                false if self.gone.len() >= MOST_GONE => self.forgotten += 1,
                false => self.gone.push(summary),
            }
        }
    }

    /// Ends all flights; gives a summary of each vehicle, the gravest first.
    pub(crate) fn finish(
        &mut self,
        mut tell: impl FnMut(Id, &Event, &Session<'e>),
    ) -> Vec<Summary> {
        let mut all = std::mem::take(&mut self.gone);
        for (id, mut member) in self.members.drain() {
            if member.session.view().is_some() {
                all.push(member.finish(id, &mut self.out, &mut tell));
            }
        }
        all.sort_by(|a, b| gravity(b).total_cmp(&gravity(a)).then(a.id.cmp(&b.id)));
        all
    }

    /// The vehicles that were found, those with the highest risk first and those whose risk is unknown last.
    pub(crate) fn views(&self) -> Vec<(Id, View<'_>)> {
        let members = self.members.iter();
        let mut views: Vec<(Id, View<'_>)> = members
            .filter_map(|(id, member)| Some((*id, member.session.view()?)))
            .collect();
        let risk = |view: &View<'_>| {
            let risk = view.latest.and_then(|latest| latest.risk.ok());
            risk.map_or(-1.0, |estimate| estimate.risk_pct)
        };
        let level = |view: &View<'_>| view.latest.and_then(|latest| latest.level);
        views.sort_by(|(a_id, a), (b_id, b)| {
            (level(b).cmp(&level(a)))
                .then(risk(b).total_cmp(&risk(a)))
                .then(a_id.cmp(b_id))
        });
        views
    }
}

impl<'e> Member<'e> {
    fn tell(&mut self, id: Id, out: &mut Out, tell: &mut impl FnMut(Id, &Event, &Session<'e>)) {
        // It only listens.
        out.packets.clear();
        for event in out.events.drain(..) {
            if let Event::Risk { update } = &event
                && let Ok(estimate) = update.risk
            {
                let most = self.risk_max.unwrap_or(estimate.risk_pct);
                self.risk_max = Some(most.max(estimate.risk_pct));
            }
            tell(id, &event, &self.session);
        }
    }

    fn finish(
        &mut self,
        id: Id,
        out: &mut Out,
        tell: &mut impl FnMut(Id, &Event, &Session<'e>),
    ) -> Summary {
        let verdict = self.session.finish(out);
        self.tell(id, out, tell);
        Summary {
            id,
            verdict,
            risk_max: self.risk_max,
            lost_share: self.session.view().map_or(0.0, |view| view.lost_share),
        }
    }
}

/// The worst verdict of several vehicles. One that never flew counts where nothing else is known.
pub(crate) fn worst(all: &[Summary]) -> Verdict {
    let none = Verdict::NotAvailable(Reason::NoFlight);
    all.iter()
        .fold(none, |worst, one| one.verdict.clone().worst(worst))
}

fn gravity(summary: &Summary) -> f64 {
    let verdict = match summary.verdict {
        Verdict::Known(level) => 200.0 * (1.0 + f64::from(level as u8)),
        Verdict::NotAvailable(Reason::NoFlight) => 0.0,
        Verdict::NotAvailable(_) => 300.0,
    };
    verdict + summary.risk_max.unwrap_or(0.0)
}
