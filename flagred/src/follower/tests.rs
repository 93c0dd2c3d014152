use alloc::vec::Vec;

use crate::{
    estimator::Estimator,
    margin::Side,
    monitor::{Craft, Monitor, Sample, Unknown, Update},
    profile::Profile,
    shipped,
    verdict::{Finding, Level, LevelSettings, Limit, Measure, NoticeSettings, Threshold},
};

const HOVER: [f64; 4] = [0.5; 4];
const LIMIT: [f64; 4] = [0.0, 1.0, 0.0, 1.0];
const IDLE: [f64; 4] = [0.0; 4];

/// A monitor and its clock, at 50 Hz.
struct SimulatedFlight {
    monitor: Monitor,
    samples: u32,
}

impl SimulatedFlight {
    fn new(estimator: &Estimator) -> SimulatedFlight {
        SimulatedFlight {
            monitor: Monitor::new(estimator, Craft::new(4)).unwrap(),
            samples: 0,
        }
    }

    fn fly(&mut self, seconds: f64, in_air: bool, motors: [f64; 4]) -> Vec<Update> {
        self.fly_with(seconds, in_air, |_| motors)
    }

    fn fly_with(
        &mut self,
        seconds: f64,
        in_air: bool,
        motors: impl Fn(f64) -> [f64; 4],
    ) -> Vec<Update> {
        self.fly_reporting(seconds, Some(in_air), motors)
    }

    fn fly_reporting(
        &mut self,
        seconds: f64,
        in_air: Option<bool>,
        motors: impl Fn(f64) -> [f64; 4],
    ) -> Vec<Update> {
        let mut updates = Vec::new();
        for _ in 0..(seconds * 50.0).round() as u32 {
            let t_s = f64::from(self.samples) / 50.0;
            updates.push(self.monitor.push(&Sample {
                t_s,
                motors: &motors(t_s),
                in_air,
                signals: &[],
            }));
            self.samples += 1;
        }
        updates
    }
}

fn ended(updates: &[Update]) -> Vec<Finding> {
    updates.iter().flat_map(|u| u.ended).flatten().collect()
}

fn last(updates: &[Update]) -> Update {
    *updates.last().unwrap()
}

/// A flight that reached FAIL.
fn failed() -> SimulatedFlight {
    let mut flight = SimulatedFlight::new(&shipped::flagred_paper());
    flight.fly(10.0, true, HOVER);
    let updates = flight.fly(3.0, true, LIMIT);
    assert_eq!(last(&updates).level, Some(Level::Fail));
    flight
}

#[test]
fn a_flickering_land_detector_does_not_end_the_flight() {
    let mut flight = failed();
    let flicker = flight.fly(0.9, false, LIMIT);
    assert_eq!(ended(&flicker), []);
    assert_eq!(last(&flicker).risk, Err(Unknown::OnGround));
    assert_eq!(last(&flicker).level, Some(Level::Fail));
    let again = flight.fly(0.1, true, LIMIT);
    assert_eq!(ended(&again), []);
    // The windows were not cleared.
    assert!(again[0].risk.is_ok());
    assert_eq!(last(&again).level, Some(Level::Fail));

    let landed = flight.fly(1.1, false, LIMIT);
    let [finding] = ended(&landed)[..] else {
        panic!("{landed:?}")
    };
    assert_eq!(finding.severity, Level::Fail);
    assert_eq!(last(&landed).level, None);
}

#[test]
fn idling_on_the_ground_raises_nothing() {
    let mut flight = SimulatedFlight::new(&shipped::flagred_paper());
    let idle = flight.fly(30.0, true, IDLE);
    assert!(idle.iter().all(|u| u.risk == Err(Unknown::OnGround)));
    assert!(idle.iter().all(|u| u.level.is_none()));
    // The first seconds in the air count from the time at which the motors leave idle.
    let off = flight.fly(4.0, true, HOVER);
    assert!(off.iter().all(|update| !update.judged));
    assert_eq!(flight.monitor.finish(), [None; 4]);
}

#[test]
fn idling_after_a_calm_landing_keeps_no_level() {
    let mut flight = failed();
    flight.fly(5.0, true, HOVER);
    assert_eq!(
        last(&flight.fly(0.02, true, HOVER)).level,
        Some(Level::Fail)
    );
    let idle = flight.fly(1.1, true, IDLE);
    assert_eq!(ended(&idle).len(), 1);
    assert_eq!(last(&idle).level, None);
}

#[test]
fn motors_at_idle_after_a_high_risk_are_not_a_landing() {
    let mut flight = failed();
    let falling = flight.fly(5.0, true, IDLE);
    assert_eq!(ended(&falling), []);
    assert!(falling.iter().all(|update| update.risk.is_ok()));
    assert_eq!(last(&falling).level, Some(Level::Fail));
}

/// A fall at a command that no rule considers a limit.
#[test]
fn motors_that_idle_while_the_vehicle_is_reported_in_the_air_are_a_fall() {
    for estimator in [shipped::flagred(), shipped::flagred_paper()] {
        let mut flight = SimulatedFlight::new(&estimator);
        flight.fly(30.0, true, HOVER);
        let falling = flight.fly(6.0, true, [0.03; 4]);
        let is_alarm = |update: &&Update| update.level > Some(Level::Good);
        let first_s = falling.iter().find(is_alarm).unwrap().t_s;
        assert!((33.0..33.5).contains(&first_s), "{first_s}");
        assert_eq!(last(&falling).level, Some(Level::Fail));
        assert!(last(&falling).judged);
        let [finding] = ended(&flight.fly(2.0, false, IDLE))[..] else {
            panic!("one finding")
        };
        assert_eq!(
            (finding.severity, finding.measure, finding.value_pct),
            (Level::Fail, Measure::IdleInAir, 100.0)
        );
        assert_eq!((finding.cause, finding.motor), (None, None));
        // On the ground the fall has ended.
        let idle = flight.fly(10.0, true, IDLE);
        assert!(idle.iter().all(|update| update.level.is_none()));
    }
}

#[test]
fn a_late_or_silent_land_detector_raises_no_level() {
    for (idle_s, in_air) in [(2.9, Some(true)), (20.0, None)] {
        let mut flight = SimulatedFlight::new(&shipped::flagred());
        flight.fly(30.0, true, HOVER);
        let mut updates = flight.fly_reporting(idle_s, in_air, |_| IDLE);
        updates.extend(flight.fly(5.0, false, IDLE));
        assert!(updates.iter().all(|u| u.risk == Err(Unknown::OnGround)));
        assert_eq!(ended(&updates), []);
    }
}

#[test]
fn a_bounce_is_not_a_fall() {
    let mut flight = SimulatedFlight::new(&shipped::flagred());
    flight.fly(30.0, true, HOVER);
    for _ in 0..3 {
        let mut updates = flight.fly(2.5, true, IDLE);
        updates.extend(flight.fly(2.0, true, HOVER));
        assert!(updates.iter().all(|u| u.level <= Some(Level::Good)));
    }
}

#[test]
fn long_windows_drop_the_take_off() {
    const TEXT: &str = "
flagred: 1
name: long
rules: flagred-paper
inputs:
  margin: {mean: motor_margin, window_s: 20}
  spread: {std: motor_command, window_s: 2}
";
    for (take_off_s, drops) in [(0.0, false), (3.0, true)] {
        let mut profile = TEXT.parse::<Profile>().unwrap();
        profile.sampling.take_off_s = take_off_s;
        let rules = shipped::flagred_paper_rules();
        let mut flight = SimulatedFlight::new(&Estimator::new(&profile, &rules).unwrap());
        flight.fly(5.0, false, IDLE);
        flight.fly(2.0, true, [0.9; 4]);
        // Until the window covers `warm_up_s` of the time after take-off, it includes the take-off.
        flight.fly(1.9, true, HOVER);
        assert!(flight.monitor.inputs()[0] < 0.4);
        flight.fly(0.2, true, HOVER);
        match drops {
            true => assert_eq!(flight.monitor.inputs(), [0.5, 0.0]),
            false => assert!(flight.monitor.inputs()[0] < 0.4),
        }
    }
}

/// A flight whose profile reports notices only.
fn noticing(notices: NoticeSettings) -> SimulatedFlight {
    let mut profile = shipped::flagred_paper().profile().clone();
    let never = LevelSettings {
        raise: Threshold::default(),
        after_s: 0.0,
        until: Threshold::default(),
    };
    profile.verdict.warn = never;
    profile.verdict.fail = never;
    profile.verdict.notices = notices;
    let estimator = Estimator::new(&profile, &shipped::flagred_paper_rules()).unwrap();
    SimulatedFlight::new(&estimator)
}

fn limit(value: f64, after_s: f64) -> Option<Limit> {
    Some(Limit { value, after_s })
}

#[test]
fn little_reserve_is_reported_while_it_lasts_and_ends_with_the_flight() {
    let mut flight = noticing(NoticeSettings {
        reserve: limit(0.1, 3.0),
        ..NoticeSettings::default()
    });
    let calm = flight.fly(20.0, true, [0.85; 4]);
    assert!(calm.iter().all(|update| update.level <= Some(Level::Good)));
    let heavy = flight.fly(15.0, true, [0.96; 4]);
    let change = heavy.iter().find_map(|u| Some((u.t_s, u.change?)));
    let (warned_s, Level::Warn) = change.unwrap() else {
        panic!("{change:?}")
    };
    assert!((23.0..28.0).contains(&warned_s), "{warned_s}");
    let open = flight.monitor.open_finding().unwrap();
    assert_eq!(
        (open.severity, open.measure),
        (Level::Warn, Measure::Reserve)
    );
    assert_eq!(open.threshold_pct, 10.0);
    assert!((4.0..6.0).contains(&open.value_pct), "{}", open.value_pct);

    let light = flight.fly(5.0, true, HOVER);
    assert_eq!(last(&light).level, Some(Level::Warn));
    let landed = flight.fly(2.0, false, IDLE);
    assert_eq!(ended(&landed).len(), 1);
    // On the ground there is no level; it does not change to GOOD.
    assert!(landed.iter().all(|update| update.change.is_none()));
    assert_eq!(last(&landed).level, None);
}

/// The samples are so far apart that the risk is always unknown.
#[test]
fn little_reserve_is_reported_where_the_risk_is_unknown() {
    let flight = noticing(NoticeSettings {
        reserve: limit(0.1, 3.0),
        ..NoticeSettings::default()
    });
    let mut monitor = flight.monitor;
    let updates: Vec<Update> = (0..60)
        .map(|t_s| {
            let motors = if t_s < 30 { [0.8; 4] } else { [0.96; 4] };
            monitor.push(&Sample {
                t_s: f64::from(t_s),
                motors: &motors,
                in_air: Some(true),
                signals: &[],
            })
        })
        .collect();
    assert!(updates.iter().all(|update| update.risk.is_err()));
    let levels: Vec<_> = updates.iter().filter_map(|update| update.change).collect();
    assert_eq!(levels, [Level::Warn]);
    assert!(updates[..30].iter().all(|update| update.level.is_none()));
    assert_eq!(last(&updates).level, Some(Level::Warn));
}

#[test]
fn a_motor_is_reported_only_if_it_leaves_its_usual_share() {
    let notices = NoticeSettings {
        imbalance: limit(0.25, 3.0),
        ..NoticeSettings::default()
    };
    let mut flight = noticing(notices);
    flight.fly(40.0, true, HOVER);
    flight.fly(20.0, true, [0.4, 0.9, 0.4, 0.4]);
    let [.., Some(finding)] = flight.monitor.finish() else {
        panic!("no imbalance")
    };
    assert_eq!(
        (finding.severity, finding.measure),
        (Level::Warn, Measure::WeakMotor)
    );
    assert!((40.0..55.0).contains(&finding.from_s), "{finding:?}");
    let motor = finding.motor.unwrap();
    assert_eq!((motor.number, motor.side), (2, Side::Upper));

    let mut flight = noticing(notices);
    flight.fly(60.0, true, [0.4, 0.9, 0.4, 0.4]);
    assert_eq!(flight.monitor.finish(), [None; 4]);
}

#[test]
fn noise_is_information_and_changes_no_level() {
    // The command changes by 0.1 from each bin (0.1 s) to the next, so the noise is 0.1 / sqrt(2).
    let shaken = |t_s: f64| {
        let even = ((t_s * 10.0 + 1e-6) as u32).is_multiple_of(2);
        [if even { 0.45 } else { 0.55 }; 4]
    };
    for (above, is_reported) in [(0.04, true), (0.08, false)] {
        let mut flight = noticing(NoticeSettings {
            noise: limit(above, 3.0),
            ..NoticeSettings::default()
        });
        let updates = flight.fly_with(30.0, true, shaken);
        assert!(updates.iter().all(|update| update.change.is_none()));
        let [_, noise, ..] = flight.monitor.finish();
        assert_eq!(noise.is_some(), is_reported, "{noise:?}");
        if let Some(noise) = noise {
            assert_eq!(
                (noise.severity, noise.measure),
                (Level::Info, Measure::CommandNoise)
            );
            assert!((6.0..7.2).contains(&noise.value_pct), "{noise:?}");
        }
    }
}
