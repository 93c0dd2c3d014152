//! Events as lines of text, for people and pipes.

use flagred::{
    estimator::Estimator,
    flight::{Reason, Verdict},
    monitor::Update,
};
use flagred_flightlog::{Vehicle, mavlink::Setup};

use fuzzy::drawing::visible;

use super::session::{
    ContactLoss, End, Event, FlightSummary, Session, SilentSource, Source, StopReason,
    UntrustedPacket, VehicleView,
};
use flagred_report::{finding::FindingContext, words::effective_range};

/// Seconds of the vehicle's clock between two lines with the risk.
const STEP_S: f64 = 1.0;

/// Formats events: one line per event, and one line per second in the air.
#[derive(Default)]
pub(crate) struct Words {
    next_s: Option<f64>,
}

impl Words {
    pub(crate) fn line(
        &mut self,
        at_s: f64,
        event: &Event,
        session: &Session<'_>,
        estimator: &Estimator,
    ) -> Option<String> {
        let Event::Risk { update } = event else {
            return Some(words(at_s, &describe(event, session, estimator)));
        };
        let Some(view) = session.view().filter(|view| view.is_in_air) else {
            self.next_s = None;
            return None;
        };
        let t_s = update.t_s;
        let waits = |next_s: f64| (next_s - 2.0 * STEP_S..next_s).contains(&t_s);
        if self.next_s.is_some_and(waits) {
            return None;
        }
        self.next_s = Some(t_s + STEP_S);
        Some(words(at_s, &risk(update, &view, estimator)))
    }
}

/// Formats a line of text with the receiver's time.
pub(crate) fn words(at_s: f64, text: &str) -> String {
    format!("{at_s:8.1} s  {}\n", visible(text))
}

/// Describes an event other than a risk. [`Words`] describes a risk, together with the current state.
pub(crate) fn describe(event: &Event, session: &Session<'_>, estimator: &Estimator) -> String {
    match event {
        Event::Found { system, vehicle } => format!("found vehicle {system}: {}", name(vehicle)),
        Event::Locked { system, address } => format!(
            "motor commands of vehicle {system} are received{}: the vehicle is followed, and other senders with this number are ignored",
            from(*address)
        ),
        Event::GivenUp { system } => {
            format!(
                "vehicle {system} is no longer followed: it is silent, or sends no motor commands"
            )
        }
        Event::SenderChanged { system, to, .. } => format!(
            "vehicle {system} is now received{} and followed there",
            from(*to)
        ),
        Event::Doubt {
            what,
            system,
            component,
            address,
        } => match what {
            UntrustedPacket::SecondSender => format!(
                "another sender{} that uses the number of vehicle {system} is ignored",
                from(*address)
            ),
            UntrustedPacket::OtherComponent => format!(
                "component {component} of vehicle {system} sends parameters: they are ignored, because this component is not the autopilot"
            ),
            UntrustedPacket::ClockJump => format!(
                "vehicle {system} sent a timestamp that jumps while its clock continues: the timestamp is ignored"
            ),
        },
        Event::AnotherWatch {
            component,
            is_sending,
            ..
        } => another_watch(*component, *is_sending),
        Event::AnotherVehicle { system } => {
            format!("vehicle {system} is also on the link, but is not followed")
        }
        Event::NotAMultirotor { system, vehicle } => {
            format!(
                "vehicle {system} is a {}, not a multirotor: it is not followed",
                vehicle.kind
            )
        }
        Event::Ready { setup, .. } => ready(setup),
        Event::Slowed {
            rate_hz,
            wanted_hz,
            system,
            component,
        } => {
            let who = match (system, component) {
                (Some(system), Some(component)) => {
                    format!("station {system}, component {component}, requested a lower rate")
                }
                _ => "another station requested a lower rate, or the link is too slow".to_owned(),
            };
            format!(
                "motor commands arrive at {rate_hz:.1} Hz, but {wanted_hz:.0} Hz are needed: {who}; they are requested again"
            )
        }
        Event::Note { text } => text.clone(),
        Event::Lost {
            what: SilentSource::Link,
        } => "LINK LOST: no packets from the vehicle, the risk is unknown".to_owned(),
        Event::Lost {
            what: SilentSource::MotorCommands,
        } => "no motor commands are received (SERVO_OUTPUT_RAW), the risk is unknown".to_owned(),
        Event::Back { what, after_s } => format!(
            "{} again, after {after_s:.1} s of silence",
            match what {
                SilentSource::Link => "the vehicle is received",
                SilentSource::MotorCommands => "motor commands are received",
            }
        ),
        Event::Rebooted => "the vehicle rebooted: earlier data are discarded".to_owned(),
        Event::TookOff { .. } => "took off".to_owned(),
        Event::Risk { update } => update.risk.map_or_else(
            |_| String::new(),
            |estimate| format!("risk {:.0} %", estimate.risk_pct),
        ),
        Event::Level { text, advice, .. } => match advice {
            Some(advice) => format!("{text}: {advice}"),
            None => text.clone(),
        },
        Event::Ended { finding } => {
            let view = session.view();
            let context = finding_context(view.as_ref(), estimator);
            let advice = context.words(finding).advice;
            format!(
                "{} of {} {advice}",
                finding.severity,
                context.finding(finding)
            )
        }
        Event::Over { end, flown } => over(*end, flown),
    }
}

/// Formats the origin of a packet, if known.
fn from(source: Source) -> String {
    source.map_or(String::new(), |address| format!(" from {address}"))
}

fn another_watch(component: Option<u8>, is_sending: bool) -> String {
    let (what, so) = match (component, is_sending) {
        (None, _) => return "no other watch is received any more".to_owned(),
        (Some(1), false) => ("the autopilot itself sends the risk".to_owned(), "nothing"),
        (Some(number), false) => (
            format!("component {number} also watches the vehicle"),
            "nothing",
        ),
        (Some(number), true) => (
            format!("component {number} also watches the vehicle"),
            "everything",
        ),
    };
    let help = match is_sending {
        false => "; with `--send-anyway`, both send",
        true => "",
    };
    format!("{what}: this watch sends {so}{help}")
}

fn over(end: End, flown: &FlightSummary) -> String {
    let mut text = match end {
        End::Landed => format!("{}: the flight is over", flown.verdict),
        End::Lost(lost) => format!("{}: LOST IN THE AIR, {}", flown.verdict, cause_of(lost)),
        End::LeftInAir(StopReason::WatchEnded) => {
            format!(
                "{}: the watch ends while the vehicle is in the air",
                flown.verdict
            )
        }
        End::LeftInAir(StopReason::Reconfigured) => format!(
            "{}: the flight so far; motors or limits became known late, the rest is assessed as a separate flight",
            flown.verdict
        ),
    };
    match (&flown.verdict, flown.level_seen) {
        (Verdict::NotAvailable(Reason::LostInAir), Some(level)) => {
            text += &format!("; {level} until then");
        }
        (Verdict::NotAvailable(reason), _) => text += &format!("; no verdict: {reason}"),
        (Verdict::Known(_), _) => {}
    }
    text
}

fn cause_of(lost: ContactLoss) -> &'static str {
    match lost {
        ContactLoss::Link => "no packets from the vehicle",
        ContactLoss::MotorCommands => "motor commands are no longer received",
        ContactLoss::Reboot => "the vehicle rebooted",
    }
}

pub(super) fn finding_context<'a>(
    view: Option<&VehicleView<'a>>,
    estimator: &'a Estimator,
) -> FindingContext<'a> {
    let setup = view.and_then(|view| view.setup);
    FindingContext {
        estimator,
        motors: setup.map_or(&[], |setup| &setup.motors),
    }
}

/// Describes a vehicle in a few words.
pub(crate) fn name(vehicle: &Vehicle) -> String {
    let frame = vehicle.frame.clone();
    let kind = frame.unwrap_or_else(|| vehicle.kind.to_string());
    match &vehicle.firmware {
        Some(firmware) => format!("{kind}, {firmware}"),
        None => kind,
    }
}

fn ready(setup: &Setup) -> String {
    let outputs: Vec<&str> = setup.motors.iter().map(|m| m.output.as_str()).collect();
    let mut text = format!(
        "{} motors ({}), {} to {} {} ({}), {} ({})",
        setup.motors.len(),
        outputs.join(", "),
        setup.range.low,
        setup.range.high,
        setup.range.unit,
        setup.range.source,
        effective_range(&setup.effective_range),
        setup.effective_range.source,
    );
    if !setup.assumed.is_empty() {
        text += &format!(
            "; the vehicle did not report everything; assumed values: {}",
            setup.assumed.join("; ")
        );
    }
    text
}

/// Describes the risk of a moment and the values behind it.
fn risk(update: &Update, view: &VehicleView<'_>, estimator: &Estimator) -> String {
    let number = |value: Option<f64>| value.map_or("unknown".to_owned(), |v| format!("{v:.2}"));
    let tail = format!(
        "margin {}, spread {}",
        number(view.margin),
        number(view.spread)
    );
    match (update.risk, update.elevated_risk_pct) {
        (Ok(estimate), Some(elevated_pct)) => format!(
            "{:<4} risk {:.0} %, elevated {elevated_pct:.0} %, {tail}",
            update
                .level
                .map_or(String::new(), |level| level.to_string()),
            estimate.risk_pct,
        ),
        (Err(unknown), _) => format!("risk unknown: {}", unknown.explain(estimator.profile())),
        (Ok(_), None) => "risk unknown".to_owned(),
    }
}

/// Explains why a verdict is NA.
pub(crate) fn reason(verdict: &Verdict) -> Option<String> {
    match verdict {
        Verdict::Known(_) => None,
        Verdict::NotAvailable(reason) => Some(reason.to_string()),
    }
}
