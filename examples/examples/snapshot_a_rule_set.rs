//! Keep the decision map of your rule set as text beside your tests, so that a review shows changed decisions.
//!
//! `cargo run -p flagred-examples --example snapshot_a_rule_set`

use std::error::Error;

use fuzzy::{
    Engine, drawing,
    map::{DecisionMap, Grid},
};

const RULES: &str = "
fuzzy: 1
name: battery
inputs:
  charge: {unit: '%', range: [0, 100], partition: {empty: 0, low: 20, full: 60}}
  distance: {unit: m, range: [0, 2000], partition: {near: 0, far: 1000}}
outputs:
  urgency: {range: [0, 1], partition: [none, some, high]}
rules:
  - IF charge IS empty OR charge IS low AND distance IS far THEN urgency IS high
  - IF charge IS low AND distance IS near THEN urgency IS some
  - IF charge IS full THEN urgency IS none
";

/// The decision map of the rule set, as text.
fn decisions() -> Result<String, Box<dyn Error>> {
    let model = fuzzy::yaml::parse(RULES)?.model;
    let engine = Engine::new(&model)?;
    let map = DecisionMap::new(&engine, Grid::new(&engine, 41)?, 0)?;
    let slice = drawing::Slice::new(&model, &map).ok_or("fix inputs until one or two are left")?;
    Ok(drawing::map_text(&slice, |cell, _| cell.to_string()) + &drawing::values_text(&slice, 6))
}

fn main() -> Result<(), Box<dyn Error>> {
    #[expect(clippy::print_stdout, reason = "an example shows what it does")]
    {
        println!("{}", decisions()?);
    }
    Ok(())
}

#[test]
fn the_decisions_are_those_that_were_reviewed() -> Result<(), Box<dyn Error>> {
    insta::assert_snapshot!(decisions()?);
    Ok(())
}
