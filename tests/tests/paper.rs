//! The paper's numbers: its worked example, and the decision map that its rules imply.
//!
//! Source: Hovington, Petit, Stratford, Hamelin, Lussier-Desbiens, Ferland, "FLAGRED - Fuzzy Logic-based Algorithm
//! Generalizing Risk Estimation for Drones", Tables I and II.

use approx::assert_abs_diff_eq;
use fuzzy::{Engine, Model, model::Variable};

fn paper() -> Model {
    let text = std::fs::read_to_string("../rules/flagred-paper.yaml").unwrap();
    fuzzy::yaml::parse(&text).unwrap().model
}

fn membership(variable: &Variable, term: &str, x: f64) -> f64 {
    let term = variable.terms.iter().find(|t| t.name == term).unwrap();
    term.membership_function.membership(x) * term.height
}

/// Row 0 of Table I, for which the paper prints the memberships and the degree of the learned rule.
#[test]
fn the_worked_example_of_the_paper_is_reproduced() {
    let model = paper();
    let [margin, spread] = model.inputs.as_slice() else {
        panic!("two inputs")
    };
    let very_low = membership(margin, "very_low", 0.007969);
    let high = membership(spread, "high", 0.226310);
    let risk = membership(&model.outputs[0].variable, "high", 65.679063);
    assert_abs_diff_eq!(very_low, 0.92031, epsilon = 1e-5);
    assert_abs_diff_eq!(high, 1.0, epsilon = 1e-5);
    assert_abs_diff_eq!(risk, 0.6271625, epsilon = 1e-5);
    assert_abs_diff_eq!(very_low * high * risk, 0.577186, epsilon = 1e-5);
}

/// The decision map of the printed rules before any gap is filled: AND and implication are the minimum, aggregation is
/// the maximum; exact centroid, no weights. Risk in %, rows by spread, columns by margin; computed independently of
/// this project.
#[test]
fn the_decision_map_of_the_paper_is_reproduced() {
    const MARGIN: [f64; 9] = [0.0, 0.03, 0.05, 0.10, 0.15, 0.20, 0.25, 0.30, 0.50];
    const RISK: [(f64, [f64; 9]); 4] = [
        (0.05, [90.3, 67.1, 63.4, 50.0, 34.5, 22.0, 22.0, 9.7, 9.7]),
        (0.10, [91.7, 69.4, 63.4, 50.0, 37.5, 25.0, 22.0, 8.3, 8.3]),
        (0.15, [90.3, 67.1, 63.4, 63.4, 46.4, 22.0, 22.0, 9.7, 9.7]),
        (0.20, [91.7, 91.1, 90.3, 91.7, 50.0, 8.3, 9.7, 8.3, 8.3]),
    ];
    let engine = Engine::new(&paper()).unwrap();
    for (spread, row) in RISK {
        for (margin, expected) in MARGIN.into_iter().zip(row) {
            let risk = engine.evaluate(&[margin, spread]).unwrap()[0]
                .value()
                .unwrap();
            assert_abs_diff_eq!(risk, expected, epsilon = 0.05 + 1e-9);
        }
    }
}

/// Where no rule fires, the value is undefined, never a number.
#[test]
fn no_rule_fires_at_no_spread_and_no_margin() {
    let engine = Engine::new(&paper()).unwrap();
    let outcome = engine.evaluate(&[0.05, 0.0]).unwrap()[0];
    assert_eq!(outcome.value(), None);
    assert_eq!(outcome.coverage, 0.0);
}
