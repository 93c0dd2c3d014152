//! A rule set in firmware: model, engine and evaluation with `core` and `alloc` only.
//!
//! `scripts/test-no-std` builds this for a processor without a standard library. A build of the whole workspace proves
//! nothing, because cargo then enables the features that other members require.
#![no_std]

use fuzzy::diagnostic::Findings;
use fuzzy::engine::{EvaluateError, Outcome, Scratch};
use fuzzy::model::{MembershipFunction, Model, Output, Variable};
use fuzzy::rule::{Condition, Rule};
use fuzzy::{Engine, map::DecisionMap, map::Grid};

/// An engine that computes a risk in % from a margin in [0, 0.5], with curved and straight terms and two rules.
///
/// # Errors
/// Never: the model is complete.
pub fn engine() -> Result<Engine, Findings> {
    Engine::new(
        &Model::builder("margin")
            .input(
                Variable::new("margin", 0.0, 0.5)
                    .term("low", MembershipFunction::Gaussian { mean: 0.0, sd: 0.1 })
                    .term(
                        "high",
                        MembershipFunction::RightShoulder {
                            foot: 0.1,
                            top: 0.3,
                        },
                    ),
            )
            .output(Output::new(
                Variable::new("risk", 0.0, 100.0)
                    .term(
                        "low",
                        MembershipFunction::LeftShoulder {
                            top: 0.0,
                            foot: 50.0,
                        },
                    )
                    .term(
                        "high",
                        MembershipFunction::SShape {
                            foot: 50.0,
                            top: 100.0,
                        },
                    ),
            ))
            .rule(Rule::new(Condition::is("margin", "low"), "risk", "high"))
            .rule(Rule::new(Condition::is("margin", "high"), "risk", "low"))
            .build(),
    )
}

/// Returns the risk for a margin, evaluated in the caller's scratch memory as in a control loop.
///
/// # Errors
/// Never: the model has one input and one output.
pub fn risk(engine: &Engine, scratch: &mut Scratch, margin: f64) -> Result<Outcome, EvaluateError> {
    let mut outcome = [Outcome::default()];
    engine.evaluate_with(scratch, &[margin], &mut outcome)?;
    let [outcome] = outcome;
    Ok(outcome)
}

/// Returns a decision map of the risk over the whole range, which can be used instead of the engine.
pub fn map(engine: &Engine) -> Option<DecisionMap> {
    let grid = Grid::new(engine, 51).ok()?;
    DecisionMap::new(engine, grid, 0).ok()
}

#[cfg(test)]
mod tests {
    #[test]
    fn rules_run_without_the_standard_library() {
        let engine = super::engine().unwrap();
        let mut scratch = engine.scratch();
        let map = super::map(&engine).unwrap();
        let at = map.grid().point(2)[0];
        let low = super::risk(&engine, &mut scratch, at).unwrap();
        let high = super::risk(&engine, &mut scratch, 0.4).unwrap();
        assert!(low.value() > Some(60.0) && high.value() < Some(40.0));
        assert_eq!(map.value(2), low.value());
    }
}
