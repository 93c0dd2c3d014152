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

/// What the learned votes count beside that of a step.
const BESIDE_STEP: f64 = 0.66;

/// The rules with a vote that only raises: a sudden change is what shows a motor that fails on a craft with room to spare. Like
/// what `swing_per_room` says it is chosen, because the flights to learn from have few such faults.
///
/// # Errors
///
/// The template has no input `unsteady_now`.
pub fn with_step(mut model: Model, template: &Model) -> Result<Model, String> {
    for rule in model.rules.iter_mut().skip(1) {
        rule.rule.weight = (100.0 * BESIDE_STEP * rule.rule.weight).round() / 100.0;
    }
    let mut named = template.inputs.iter();
    let input = named.find(|input| input.name == "unsteady_now");
    let mut input = input.cloned().ok_or("no input `unsteady_now`")?;
    input.terms.clear();
    let input = input.partition_at([("calm", 0.01), ("violent", 0.036)]);
    let mut rules = template.rules.iter();
    let rule = rules.find(|rule| rule.rule.to_string().contains("unsteady_now IS violent"));
    let mut rule = rule
        .cloned()
        .ok_or("no rule of `unsteady_now IS violent`")?;
    rule.rule.weight = 1.0;
    model.inputs.insert(0, input);
    model.rules.insert(1, rule);
    Ok(model)
}
