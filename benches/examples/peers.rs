//! Writes the reference systems as files for other programs, and measures how long this engine takes, for the
//! comparison with these programs.
//!
//! `write FOLDER` writes each system in fuzzylite's language, and a table of points with the exact outputs. For
//! the type-2 system it writes only the points, since that language has no type-2 terms. `time` prints this
//! engine's time for each system, as `system,program,ns`.

use std::fmt::Write as _;
use std::path::Path;
use std::time::Instant;

use flagred_benches::{
    four_inputs, gaussians, larsen, overlapping, points, published, published_type2, takagi_sugeno,
    tipper,
};
use fuzzy::engine::Outcome;
use fuzzy::map::{DecisionMap, Grid};
use fuzzy::model::{Defuzzifier, Implication, MembershipFunction, Model, Variable};
use fuzzy::{Engine, rule::Condition, rule::Rule};

const POINTS: usize = 1024;
/// A number of points that is too large for the branch predictor of a processor to memorise, unlike [`POINTS`].
const MANY_POINTS: usize = 16_384;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let systems = [
        ("a", tipper()),
        ("bw", published(true)),
        ("c", four_inputs()),
        ("t", takagi_sugeno()),
        ("o", overlapping()),
        ("l", larsen()),
        ("g", gaussians(5)),
    ];
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["write", folder] => {
            for (name, model) in &systems {
                write(Path::new(folder), name, model)?;
            }
            write_points(Path::new(folder), "b2", &published_type2())?;
        }
        ["time"] => {
            for (name, model) in &systems {
                time(name, model)?;
            }
            time("b2", &published_type2())?;
        }
        _ => return Err("use `write FOLDER` or `time`".into()),
    }
    Ok(())
}

fn write(folder: &Path, name: &str, model: &Model) -> Result<(), Box<dyn std::error::Error>> {
    std::fs::write(folder.join(format!("{name}.fll")), fll(model))?;
    write_points(folder, name, model)
}

/// Writes points with the exact outputs. For a system with interval type-2 terms, also writes the bounds of the exact
/// intervals.
fn write_points(
    folder: &Path,
    name: &str,
    model: &Model,
) -> Result<(), Box<dyn std::error::Error>> {
    let engine = Engine::new(model)?;
    let mut text = String::new();
    for point in points(model, POINTS) {
        let numbers: Vec<String> = point.iter().map(f64::to_string).collect();
        let outcome = engine.evaluate(&point)?[0];
        let value = outcome.value().unwrap_or(f64::NAN);
        write!(text, "{} {value}", numbers.join(" "))?;
        if let (Some(low), Some(high)) = (outcome.low(), outcome.high())
            && model.has_type2_terms()
        {
            write!(text, " {low} {high}")?;
        }
        writeln!(text)?;
    }
    std::fs::write(folder.join(format!("{name}.points")), text)?;
    Ok(())
}

/// The model in fuzzylite's language.
fn fll(model: &Model) -> String {
    let mut text = format!("Engine: {}\n", model.name.replace(' ', "_"));
    let variable = |v: &Variable| {
        let mut text = format!(
            "  enabled: true\n  range: {} {}\n  lock-range: false\n",
            v.low, v.high
        );
        if let Some(output) = model.outputs.iter().find(|o| o.variable.name == v.name) {
            text += match output.defuzzifier {
                Defuzzifier::WeightedAverage => {
                    "  aggregation: none\n  defuzzifier: WeightedAverage\n"
                }
                _ => "  aggregation: Maximum\n  defuzzifier: Centroid 100\n",
            };
            text += "  default: nan\n  lock-previous: false\n";
        }
        for term in &v.terms {
            let shape = match term.membership_function {
                MembershipFunction::Triangle { left, peak, right } => {
                    format!("Triangle {left} {peak} {right}")
                }
                MembershipFunction::Trapezoid {
                    left,
                    left_top,
                    right_top,
                    right,
                } => {
                    format!("Trapezoid {left} {left_top} {right_top} {right}")
                }
                MembershipFunction::LeftShoulder { top, foot } => {
                    format!("Trapezoid {} {} {top} {foot}", v.low - 0.1, v.low)
                }
                MembershipFunction::RightShoulder { foot, top } => {
                    format!("Trapezoid {foot} {top} {} {}", v.high, v.high + 0.1)
                }
                MembershipFunction::Gaussian { mean, sd } => format!("Gaussian {mean} {sd}"),
                MembershipFunction::Linear {
                    ref coefficients,
                    constant,
                } => {
                    let of = |input: &Variable| {
                        let found = coefficients.iter().find(|(name, _)| *name == input.name);
                        found
                            .map_or(0.0, |(_, coefficient)| *coefficient)
                            .to_string()
                    };
                    let all: Vec<String> = model.inputs.iter().map(of).collect();
                    format!("Linear {} {constant}", all.join(" "))
                }
                ref other => format!("{other:?}"),
            };
            text += &format!("  term: {} {shape}\n", term.name);
        }
        text
    };
    for input in &model.inputs {
        text += &format!("InputVariable: {}\n{}", input.name, variable(input));
    }
    for output in &model.outputs {
        text += &format!(
            "OutputVariable: {}\n{}",
            output.variable.name,
            variable(&output.variable)
        );
    }
    let implication = match model.operators.implication {
        Implication::Product => "AlgebraicProduct",
        _ => "Minimum",
    };
    text += &format!(
        "RuleBlock: rules\n  enabled: true\n  conjunction: Minimum\n  disjunction: Maximum\n  implication: {implication}\n  activation: General\n"
    );
    for rule in &model.rules {
        text += &format!("  rule: {}\n", sentence(&rule.rule));
    }
    text
}

fn sentence(rule: &Rule) -> String {
    let is = |condition: &Condition| match condition {
        Condition::Is(p) => {
            let term = p.term.as_ref().map_or("", |term| &term.text);
            format!("{} is {term}", p.variable.text)
        }
        other => format!("{other:?}"),
    };
    let condition = match &rule.condition {
        Condition::And(all) => all.iter().map(is).collect::<Vec<_>>().join(" and "),
        Condition::Or(any) => any.iter().map(is).collect::<Vec<_>>().join(" or "),
        one => is(one),
    };
    let then = &rule.consequents[0];
    format!(
        "if {condition} then {} is {} with {}",
        then.output.text, then.term.text, rule.weight
    )
}

/// Returns the time per call in the fastest of many rounds, in ns. The fastest round is the one that other load on the
/// machine disturbs least.
fn fastest(calls: usize, mut round: impl FnMut()) -> f64 {
    let mut best = f64::INFINITY;
    let started = Instant::now();
    while started.elapsed().as_millis() < 700 {
        let begun = Instant::now();
        round();
        best = best.min(begun.elapsed().as_secs_f64());
    }
    best * 1e9 / calls as f64
}

fn time(name: &str, model: &Model) -> Result<(), Box<dyn std::error::Error>> {
    let engine = Engine::new(model)?;
    let mut scratch = engine.scratch();
    let mut outcome = [Outcome::default()];
    let mut single = |points: &[Vec<f64>]| {
        fastest(points.len(), || {
            for point in points {
                let _ =
                    engine.evaluate_with(&mut scratch, std::hint::black_box(point), &mut outcome);
            }
        })
    };
    let many = single(&points(model, MANY_POINTS));
    let points = points(model, POINTS);
    println!("{name},ours,{},0", single(&points));
    println!("{name},ours: {MANY_POINTS} points,{many},0");
    let columns: Vec<Vec<f64>> = (0..model.inputs.len())
        .map(|input| points.iter().map(|point| point[input]).collect())
        .collect();
    let columns: Vec<&[f64]> = columns.iter().map(|column| &**column).collect();
    let mut outcomes = vec![Outcome::default(); POINTS];
    let batch = fastest(POINTS, || {
        let _ = engine.evaluate_batch_into(std::hint::black_box(&columns), &mut outcomes);
    });
    println!("{name},ours in a batch,{batch},0");
    if model.inputs.len() == 2 {
        let grid = Grid::new(&engine, 501)?;
        let map = fastest(1, || {
            let _ = std::hint::black_box(DecisionMap::new(&engine, grid.clone(), 0));
        });
        println!("{name},ours: map of 501 x 501,{map},0");
    }
    Ok(())
}
