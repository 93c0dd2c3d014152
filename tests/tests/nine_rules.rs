//! The shipped rules as a person would write them: docs/validation.md says that nine rules with NOT are the same.

use fuzzy::{Engine, Model};

const NINE: [&str; 9] = [
    "IF at_limit IS none AND unsteady_now IS calm AND unsteady_lately IS calm AND load IS NOT heavy THEN risk IS very_low",
    "IF at_limit IS none AND unsteady_now IS calm AND unsteady_lately IS calm AND load IS heavy THEN risk IS low",
    "IF at_limit IS none AND unsteady_now IS calm AND unsteady_lately IS NOT calm AND load IS light THEN risk IS low",
    "IF at_limit IS none AND unsteady_now IS calm AND unsteady_lately IS NOT calm AND load IS NOT light THEN risk IS medium",
    "IF at_limit IS none AND unsteady_now IS shaken AND unsteady_lately IS NOT stormy AND load IS light THEN risk IS medium",
    "IF at_limit IS none AND unsteady_now IS shaken AND unsteady_lately IS NOT stormy AND load IS NOT light THEN risk IS high",
    "IF at_limit IS none AND unsteady_now IS shaken AND unsteady_lately IS stormy THEN risk IS very_high",
    "IF at_limit IS none AND unsteady_now IS violent THEN risk IS very_high",
    "IF at_limit IS much THEN risk IS very_high",
];

fn risk(engine: &Engine, inputs: [f64; 4]) -> f64 {
    engine.evaluate(&inputs).unwrap()[0].value().unwrap()
}

#[test]
fn nine_rules_with_not_are_the_same_and_never_fall() {
    let shipped = flagred::shipped::flagred_rules();
    let mut nine: Model = shipped.clone();
    nine.rules.truncate(NINE.len());
    for (rule, text) in nine.rules.iter_mut().zip(NINE) {
        rule.rule = fuzzy::rule::parse(text).unwrap();
    }
    let (shipped, nine) = (Engine::new(&shipped).unwrap(), Engine::new(&nine).unwrap());
    let unsteady = |i: u32| f64::from(i) * 0.007;
    let share = |i: u32| f64::from(i) / 9.0;
    for a in 0..10 {
        for b in 0..10 {
            for c in 0..10 {
                for d in 0..10 {
                    let at = [unsteady(a), unsteady(b), share(c), share(d)];
                    let here = risk(&shipped, at);
                    assert!((here - risk(&nine, at)).abs() < 1e-9, "{at:?}");
                    for (input, step) in
                        [0.007, 0.007, 1.0 / 9.0, 1.0 / 9.0].into_iter().enumerate()
                    {
                        let mut higher = at;
                        higher[input] = (higher[input] + step).min(1.0);
                        assert!(risk(&shipped, higher) >= here - 1e-9, "{at:?} {input}");
                    }
                }
            }
        }
    }
}
