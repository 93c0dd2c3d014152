//! The monitor over minutes of flight: processing a sample does not allocate.

use flagred::{
    monitor::{Craft, Monitor, Sample},
    shipped,
};

/// Sets the commands of eight motors at 50 Hz, and returns the time in seconds and whether the vehicle is in the air.
/// The vehicle compensates gusts, lands and takes off, loses its link, and sends NaN for a motor.
fn sample(i: u32, motors: &mut [f64; 8]) -> (f64, bool) {
    let t_s = f64::from(i) * 0.02 + if i > 6000 { 60.0 } else { 0.0 };
    for (n, motor) in motors.iter_mut().enumerate() {
        let gust = (t_s * 1.3).sin().max(0.0) * 0.4;
        *motor = (0.55 + gust * (t_s * 9.0 + n as f64).sin()).clamp(0.0, 1.0);
    }
    if i.is_multiple_of(97) {
        motors[3] = f64::NAN;
    }
    (t_s, !(4000..4300).contains(&i))
}

#[test]
fn a_sample_never_allocates() {
    for estimator in [shipped::flagred(), shipped::flagred_paper()] {
        let name = &estimator.profile().name;
        let mut monitor = Monitor::new(&estimator, Craft::new(8)).unwrap();
        let mut motors = [0.0; 8];
        let (mut known, mut changes) = (0, 0);
        let counted = allocation_counter::measure(|| {
            for i in 0..10_000 {
                let (t_s, in_air) = sample(i, &mut motors);
                let assessment = monitor.push(&Sample {
                    t_s,
                    motors: &motors,
                    in_air: Some(in_air),
                    signals: &[],
                });
                known += u32::from(assessment.risk.is_ok());
                changes += u32::from(assessment.change.is_some());
            }
        });
        assert_eq!(counted.count_total, 0, "{name}");
        // The level changes repeatedly with the default rules, and at most once with the rules of the paper.
        assert!(known > 9000, "{name}: {known}");
        assert_eq!(changes > 1, name == "flagred", "{name}: {changes}");
    }
}
