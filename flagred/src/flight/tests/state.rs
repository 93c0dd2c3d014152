//! Tests of assessors that continue from the state of another assessor.

use proptest::prelude::*;

use super::*;

/// A sample: the seconds since the previous sample, whether the vehicle is in the air, and the commands of the motors.
type SampleCase = (f64, Option<bool>, [f64; 4]);

/// Calm, violent and idle phases, with gaps, unknown motors and clocks that go back.
fn flights() -> impl Strategy<Value = Vec<SampleCase>> {
    let motors = prop_oneof![
        4 => Just([0.5; 4]),
        4 => Just(LIMIT),
        2 => Just([0.9, 0.4, 0.4, 0.4]),
        1 => Just([0.0; 4]),
        1 => Just([0.5, f64::NAN, 0.5, 0.5]),
        2 => prop::array::uniform4(0.0..1.0),
    ];
    let in_air = prop_oneof![6 => Just(Some(true)), 1 => Just(Some(false)), 1 => Just(None)];
    let step_s = prop_oneof![8 => Just(0.02), 1 => Just(0.1), 1 => Just(0.013)];
    let jump_s = prop_oneof![12 => Just(0.02), 1 => Just(3.0), 1 => Just(-5.0), 1 => Just(-0.01)];
    let phase = (jump_s, step_s, in_air, motors, 10..300usize);
    prop::collection::vec(phase, 1..10).prop_map(|phases| {
        let samples = phases
            .into_iter()
            .flat_map(|(jump_s, step_s, in_air, motors, count)| {
                (0..count).map(move |i| {
                    let wave = [0.03, -0.02, 0.01, -0.01].map(|size| size * (i as f64 * 0.7).sin());
                    let moved = core::array::from_fn(|m| motors[m] + wave[m]);
                    (if i == 0 { jump_s } else { step_s }, in_air, moved)
                })
            });
        samples.collect()
    })
}

fn push_all(assessor: &mut Assessor, (t_s, in_air, motors): &SampleCase) -> String {
    let update = assessor.push(&Sample {
        t_s: *t_s,
        motors,
        in_air: *in_air,
        signals: &[],
    });
    let (open, notice) = (assessor.open_finding(), assessor.open_notice());
    format!("{update:?} {:?} {open:?} {notice:?}", assessor.ended())
}

fn begin(estimator: &Estimator) -> Assessor {
    let assessor = Assessor::new(estimator, Craft::new(4), Some(0.1)).unwrap();
    assessor.with_intervals()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn a_restored_flight_continues_with_the_same_bits(
        flight in flights(),
        cuts in prop::collection::vec(any::<prop::sample::Index>(), 1..4),
        has_two_risks in any::<bool>(),
    ) {
        let estimator = match has_two_risks {
            true => two_risks("output: weak\nother_risks: {torn: {fail: {risk: 80}}}"),
            false => shipped::flagred(),
        };
        let (mut one, mut other) = (begin(&estimator), begin(&estimator));
        let mut t_s = 0.0;
        for (i, (step_s, in_air, motors)) in flight.iter().enumerate() {
            t_s += step_s;
            if cuts.iter().any(|cut| cut.index(flight.len()) == i) {
                let saved = other.state();
                let fresh = Assessor::new(&estimator, Craft::new(4), None).unwrap();
                other = fresh.restore(&saved).unwrap();
                prop_assert!(other.state() == saved && saved == one.state());
            }
            let given = (t_s, *in_air, *motors);
            prop_assert_eq!(push_all(&mut one, &given), push_all(&mut other, &given));
        }
        prop_assert!(one.state() == other.state());
        prop_assert_eq!(format!("{:?}", one.finish()), format!("{:?}", other.finish()));
    }

    #[test]
    fn a_damaged_state_is_refused(at in any::<prop::sample::Index>(), flip in 1..=255u8, cut in any::<bool>()) {
        let estimator = shipped::flagred_paper();
        let mut assessor = begin(&estimator);
        push_all(&mut assessor, &(0.0, None, HOVER));
        let mut saved = assessor.state();
        let at = at.index(saved.len());
        match cut {
            true => saved.truncate(at),
            false => saved[at] ^= flip,
        }
        prop_assert!(begin(&estimator).restore(&saved).is_err());
    }
}

#[test]
fn a_state_of_another_version_profile_or_craft_is_refused() {
    let paper = begin(&shipped::flagred_paper());
    let saved = paper.state();
    let octa = Assessor::new(&shipped::flagred_paper(), Craft::new(8), None).unwrap();
    for other in [begin(&shipped::flagred()), octa] {
        assert_eq!(other.restore(&saved).unwrap_err(), StateError::OtherMonitor);
    }
    let mut newer = saved.clone();
    newer[b"flagred state ".len()] += 1;
    let error = paper.clone().restore(&newer).unwrap_err().to_string();
    assert_eq!(
        error,
        "the state has version 4, but this version of flagred reads version 3: end the flight with the version that saved \
         its state"
    );
    assert_eq!(paper.restore(b"a log").unwrap_err(), StateError::Damaged);
}

/// If this fails because a type of the state got or lost a field, raise `state::VERSION`.
#[test]
fn the_saved_layout_matches_its_version() {
    let mut assessor = begin(&shipped::flagred_paper());
    for i in 0..2000 {
        let motors = if i < 1000 { HOVER } else { LIMIT };
        push_all(&mut assessor, &(f64::from(i) * 0.02, Some(true), motors));
    }
    let length = assessor.state().len();
    assert_eq!((crate::state::VERSION, length), (3, 109_728));
}
