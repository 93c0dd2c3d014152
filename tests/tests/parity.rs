//! Our results compared with those of other programs and of a closed form, if the reference files are available.

use flagred_tests::reference_data;
use fuzzy::model::{MembershipFunction, Model, Output, Sampling, SamplingRule, Variable};
use fuzzy::rule::{Condition, Rule};
use fuzzy::{Engine, engine::State};

/// Reads the plain description of a reference system: `input`, `term`, `output` and `rule` lines.
fn system(text: &str) -> Model {
    let mut model = Model::builder("system").build();
    for line in text.lines() {
        let words: Vec<&str> = line.split_whitespace().collect();
        let number = |i: usize| words[i].parse::<f64>().unwrap();
        match words[0] {
            "input" => model
                .inputs
                .push(Variable::new(words[1], number(2), number(3))),
            "output" => {
                let variable = Variable::new(words[1], number(2), number(3));
                model.outputs.push(Output::new(variable));
            }
            "term" => {
                let shape = match words[2] {
                    "gaussian" => MembershipFunction::Gaussian {
                        mean: number(3),
                        sd: number(4),
                    },
                    "triangle" => MembershipFunction::Triangle {
                        left: number(3),
                        peak: number(4),
                        right: number(5),
                    },
                    "trapezoid" => MembershipFunction::Trapezoid {
                        left: number(3),
                        left_top: number(4),
                        right_top: number(5),
                        right: number(6),
                    },
                    other => panic!("unknown shape {other}"),
                };
                let variable = match model.outputs.last_mut() {
                    Some(output) => &mut output.variable,
                    None => model.inputs.last_mut().unwrap(),
                };
                *variable = variable.clone().term(words[1], shape);
            }
            "rule" => {
                let condition = words[3]
                    .split(',')
                    .map(|proposition| proposition.split_once('=').unwrap())
                    .map(|(variable, term)| Condition::is(variable, term))
                    .reduce(|all, one| match words[2] {
                        "and" => all.and(one),
                        _ => all.or(one),
                    })
                    .unwrap();
                let output = model.outputs[0].variable.name.clone();
                let rule = Rule::new(condition, &output, words[4]).with(number(1));
                model.rules.push(rule.into());
            }
            other => panic!("unknown line {other}"),
        }
    }
    model
}

/// Rows of numbers; `nan` where no rule fires.
fn rows(folder: &std::path::Path, name: &str) -> Vec<Vec<f64>> {
    let text = std::fs::read_to_string(folder.join(name)).unwrap();
    text.lines()
        .map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect())
        .collect()
}

fn compare(engine: &Engine, inputs: &[f64], expected: f64, tolerance: f64) {
    let outcome = engine.evaluate(inputs).unwrap()[0];
    match outcome.state {
        State::Defined(value) => assert!(
            (value - expected).abs() <= tolerance,
            "at {inputs:?}: {value} instead of {expected}"
        ),
        State::NoRuleFired => assert!(expected.is_nan(), "at {inputs:?}: no rule fired"),
        other => panic!("at {inputs:?}: {other:?}"),
    }
}

#[test]
#[ignore = "needs FLAGRED_SHARED"]
fn centroids_equal_the_closed_form() {
    let folder = reference_data().join("parity");
    for name in ["a", "b", "bw"] {
        let text = std::fs::read_to_string(folder.join(format!("{name}.sys"))).unwrap();
        let engine = Engine::new(&system(&text)).unwrap();
        let rows = rows(&folder, &format!("{name}.exact.csv"));
        assert_eq!(rows.len(), 51 * 51);
        for row in rows {
            compare(&engine, &row[..2], row[2], 1e-10);
        }
    }
    let text = std::fs::read_to_string(folder.join("c.sys")).unwrap();
    let engine = Engine::new(&system(&text)).unwrap();
    let points = rows(&folder, "c.points.csv");
    let exact = rows(&folder, "c.exact.csv");
    assert_eq!((points.len(), exact.len()), (1024, 1024));
    for (point, exact) in points.iter().zip(&exact) {
        compare(&engine, point, exact[0], 1e-10);
    }
}

/// With the same midpoints, the results equal those of fuzzylite except for small firing strengths: fuzzylite treats
/// 1e-6 and less as 0. The possible difference is bounded by these strengths.
#[test]
#[ignore = "needs FLAGRED_SHARED"]
fn a_thousand_midpoints_equal_fuzzylite() {
    let folder = reference_data().join("parity");
    for name in ["a", "b", "bw", "c"] {
        let text = std::fs::read_to_string(folder.join(format!("{name}.sys"))).unwrap();
        let mut model = system(&text);
        model.outputs[0].samples = Some(Sampling {
            samples: 1000,
            rule: SamplingRule::Midpoint,
        });
        let engine = Engine::new(&model).unwrap();
        let mut rows = rows(&folder, &format!("{name}.fuzzylite_cpp.1000.csv"));
        if name == "c" {
            let points = self::rows(&folder, "c.points.csv");
            rows = points
                .into_iter()
                .zip(rows)
                .map(|(p, value)| [p, value].concat())
                .collect();
        }
        let mut compared = 0;
        for row in rows {
            let (expected, point) = row.split_last().unwrap();
            let outcome = engine.evaluate(point).unwrap()[0];
            if outcome.coverage <= 1e-6 {
                continue;
            }
            let value = outcome.value().unwrap();
            let dropped = model.inputs.iter().zip(point).any(|(variable, x)| {
                let mut degrees = variable.terms.iter().map(|term| term.membership(*x));
                degrees.any(|degree| degree > 0.0 && degree <= 1e-6)
            });
            let range = model.outputs[0].variable.high - model.outputs[0].variable.low;
            let tolerance = if dropped { 1e-6 * range } else { 1e-9 };
            assert!(
                (value - expected).abs() <= tolerance,
                "({name}) at {point:?}: {value} instead of {expected}"
            );
            compared += usize::from(!dropped);
        }
        assert!(compared > 300, "({name}) {compared} points");
    }
}
