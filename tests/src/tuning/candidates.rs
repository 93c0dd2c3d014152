//! The candidate rule sets. The choice between them is made by cross-validation over vehicles.

use fuzzy::Model;

/// The inputs of each candidate besides `at_limit`; the first candidate is the chosen one.
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

/// The template with these inputs and `at_limit`, without the other inputs and their rules.
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

/// The factor for the weights of the learned rules. It compensates for the additional rule about sudden changes.
const BESIDE_STEP: f64 = 0.66;

/// Adds a vote of `unsteady_now` that only raises the risk: on a craft with large reserves, a sudden change is the first sign of
/// a failing motor. Its peaks are chosen by hand, like those of `swing_per_room`, because few flights have such a fault.
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
