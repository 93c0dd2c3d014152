//! Signals other than motor commands: battery level and others that a profile reads.

use flagred::profile::Profile;
use flagred_flightlog::mavlink::dialect::SYS_STATUS_DATA;

use super::*;

/// The percentage of the battery that remains.
fn battery(remaining_pct: i8) -> MavMessage {
    MavMessage::SYS_STATUS(SYS_STATUS_DATA {
        battery_remaining: remaining_pct,
        ..SYS_STATUS_DATA::default()
    })
}

/// The profile `flagred-battery` with a value to assume for vehicles without a battery monitor.
fn with_optional_battery() -> Estimator {
    let shipped = shipped::flagred_battery();
    let mut profile: Profile = shipped.profile().clone();
    let input = profile.inputs.iter_mut().find(|it| it.name == "battery");
    input.unwrap().if_missing = Some(100.0);
    Estimator::new(&profile, &shipped::flagred_battery_rules()).unwrap()
}

impl<'e> Bench<'e> {
    /// A session with a vehicle whose parameters are known.
    fn known(estimator: &'e Estimator) -> Bench<'e> {
        let mut bench = Bench::new(estimator, Some(191));
        bench.beat(false);
        bench.all_parameters();
        bench.wait(0.1);
        bench
    }

    /// Hovers for 30 s with a battery level once a second.
    fn hover_with(&mut self, from_s: f64, remaining_pct: i8) {
        for second in 0..30 {
            self.take_message(&battery(remaining_pct));
            self.hover(from_s + f64::from(second), 1.0, 1500);
        }
    }

    fn level(&self) -> Option<Level> {
        self.session.view().unwrap().latest.unwrap().level
    }

    fn asks_for(&self, message: u32) -> bool {
        self.sent.iter().any(|sent| match sent {
            MavMessage::COMMAND_LONG(command) => command.param1 == message as f32,
            _ => false,
        })
    }
}

#[test]
fn an_empty_battery_raises_the_level() {
    let estimator = shipped::flagred_battery();
    let mut bench = Bench::known(&estimator);
    bench.hover_with(10.0, 80);
    assert_eq!(bench.level(), Some(Level::Good));
    bench.hover_with(40.0, 2);
    assert_eq!(bench.level(), Some(Level::Fail));
}

#[test]
fn without_a_battery_level_the_flight_has_no_verdict() {
    let estimator = shipped::flagred_battery();
    let mut bench = Bench::known(&estimator);
    bench.hover(10.0, 30.0, 1500);
    // In MAVLink, -1 means unknown.
    bench.hover_with(40.0, -1);
    let verdict = bench.session.finish(&mut SessionOutput::default());
    assert!(matches!(verdict, Verdict::NotAvailable(_)), "{verdict}");
}

#[test]
fn the_value_for_missing_signals_holds_until_the_signal_is_received() {
    let estimator = with_optional_battery();
    let mut bench = Bench::known(&estimator);
    bench.hover(10.0, 30.0, 1500);
    assert_eq!(bench.level(), Some(Level::Good));
    let notes = |bench: &Bench<'_>| {
        let texts = bench.events.iter().filter_map(|event| match event {
            Event::Note { text } => Some(text.clone()),
            _ => None,
        });
        texts.collect::<Vec<String>>()
    };
    let assumed = "`battery_remaining_pct` has not been received yet: input `battery` is assumed to be 100 (`if_missing`)";
    assert_eq!(notes(&bench), [assumed]);
    bench.hover_with(40.0, 2);
    assert_eq!(bench.level(), Some(Level::Fail));
    assert_eq!(notes(&bench).len(), 1);
}

#[test]
fn only_messages_of_wanted_signals_are_requested() {
    let (with, without) = (shipped::flagred_battery(), shipped::flagred());
    for (estimator, is_wanted) in [(&with, true), (&without, false)] {
        let mut bench = Bench::known(estimator);
        bench.hover(10.0, 5.0, 1500);
        assert!(bench.asks_for(30), "attitude is always requested");
        assert_eq!(bench.asks_for(1), is_wanted, "SYS_STATUS");
        assert!(!bench.asks_for(241), "VIBRATION");
    }
}

#[test]
fn signals_of_other_components_are_ignored() {
    let estimator = shipped::flagred_battery();
    let mut bench = Bench::known(&estimator);
    bench.hover_with(10.0, 80);
    let mut other = Sender::new(42);
    let bytes = other.packet(Version::V2, 1, &battery(1));
    bench.hear_bytes(None, &bytes);
    bench.hover(40.0, 20.0, 1500);
    assert_eq!(bench.level(), Some(Level::Good));
}
