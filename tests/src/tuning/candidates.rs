//! The rule sets between which vehicles that were left out chose.

use fuzzy::Model;

/// The inputs of each candidate beside `at_limit`; the first is chosen.
pub const CANDIDATES: [&[&str]; 4] = [
    &["unsteady_lately", "throttle_activity", "swing_per_room"],
    &["unsteady_lately", "throttle_activity"],
    &[
        "unsteady_now",
        "unsteady_lately",
        "throttle_activity",
        "load",
        "spread",
    ],
    &[
        "unsteady_now",
        "unsteady_lately",
        "throttle_activity",
        "load",
        "spread",
        "swing_per_room",
    ],
];

/// The template with some of its inputs alone.
pub fn candidate(model: &Model, inputs: &[&str]) -> Model {
    let mut model = model.clone();
    let is_kept = |name: &str| name == "at_limit" || inputs.contains(&name);
    model.inputs.retain(|input| is_kept(&input.name));
    model.rules.retain(|rule| {
        let mut all = true;
        rule.rule
            .condition
            .visit(&mut |proposition| all &= is_kept(&proposition.variable.text));
        all
    });
    model
}
