//! Times the Rust crates fuzzy-logic_rs and oxictl on a system written by the example `peers`:
//! flagred-peers NAME FOLDER prints `system,program,ns per call,largest error in % of the range`.
//!
//! Both support only rules that are ANDs of one term of every input, so they cannot evaluate the tipper.

use std::hint::black_box;
use std::time::{Duration, Instant};

use fuzzy_logic_rs::aggregations::Aggregations;
use fuzzy_logic_rs::defuzzifications::Defuzzifiers;
use fuzzy_logic_rs::fuzzy_inference_systems::MamdaniFIS;
use fuzzy_logic_rs::implications::Implications;
use fuzzy_logic_rs::membership_functions::{MF, MFKind, Trapezoid, Triangle};
use fuzzy_logic_rs::membership_ranges::MembershipRange;
use fuzzy_logic_rs::rules::Rule;
use fuzzy_logic_rs::s_norms::SNorms;
use fuzzy_logic_rs::t_norms::TNorms;
use fuzzy_logic_rs::variables::{InputVariable, OutputVariable};
use oxictl::fuzzy::inference::MamdaniEngine;
use oxictl::fuzzy::{
    Antecedent, Consequent, FuzzyRule, MembershipFn, TNorm, Trapezoidal, Triangular,
};

/// A variable of the file: its range, and the 3 or 4 corners of each term.
struct Variable {
    name: String,
    low: f64,
    high: f64,
    terms: Vec<(String, Vec<f64>)>,
}

/// A rule: the term of each input, the term of the output, and the weight.
struct ParsedRule {
    inputs: Vec<usize>,
    output: usize,
    weight: f64,
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [system, folder] = &arguments[..] else {
        return Err("use NAME FOLDER".into());
    };
    let (variables, rules) = read(&std::fs::read_to_string(format!("{folder}/{system}.fll"))?)?;
    let points = std::fs::read_to_string(format!("{folder}/{system}.points"))?;
    let mut rows = Vec::new();
    // Rule sets with many rules are evaluated at fewer points, because these programs would need minutes for all
    // points.
    for line in points
        .lines()
        .take(if rules.len() > 100 { 64 } else { 1024 })
    {
        let row: Result<Vec<f64>, _> = line.split(' ').map(str::parse).collect();
        rows.push(row?);
    }
    let (output, inputs) = variables.split_last().ok_or("no variables")?;
    for samples in [100, 1000] {
        let program = format!("fuzzy-logic_rs 0.5 (Rust) {samples} samples");
        let engine = fuzzy_logic_rs(inputs, output, &rules, samples)?;
        report(system, &program, output, &rows, |row| {
            engine.compute_outputs(row.to_vec())[0]
        });
    }
    oxictl(system, inputs, output, &rules, &rows)
}

/// Parses the variables and rules of a file in the subset of fuzzylite's language that the example `peers` writes.
fn read(text: &str) -> Result<(Vec<Variable>, Vec<ParsedRule>), Box<dyn std::error::Error>> {
    let (mut variables, mut rules) = (Vec::<Variable>::new(), Vec::new());
    for line in text.lines() {
        let (key, value) = line.trim().split_once(": ").unwrap_or((line, ""));
        let words: Vec<&str> = value.split(' ').collect();
        match (key, variables.last_mut()) {
            ("InputVariable" | "OutputVariable", _) => variables.push(Variable {
                name: value.into(),
                low: 0.0,
                high: 0.0,
                terms: Vec::new(),
            }),
            ("range", Some(variable)) => {
                (variable.low, variable.high) = (words[0].parse()?, words[1].parse()?);
            }
            ("term", Some(variable)) => {
                let corners: Result<Vec<f64>, _> = words[2..].iter().map(|w| w.parse()).collect();
                variable.terms.push((words[0].into(), corners?));
            }
            ("rule", _) => {
                // if V is T and V is T then V is T with W
                let place = |variable: &Variable| {
                    let at = words
                        .windows(3)
                        .find(|w| w[0] == variable.name && w[1] == "is")?;
                    variable.terms.iter().position(|(name, _)| name == at[2])
                };
                let places: Option<Vec<usize>> = variables.iter().map(place).collect();
                let (output, inputs) = places
                    .as_deref()
                    .and_then(<[usize]>::split_last)
                    .ok_or_else(|| format!("not a plain AND of all inputs: {value}"))?;
                rules.push(ParsedRule {
                    inputs: inputs.to_vec(),
                    output: *output,
                    weight: words[words.len() - 1].parse()?,
                });
            }
            _ => {}
        }
    }
    Ok((variables, rules))
}

fn fuzzy_logic_rs(
    inputs: &[Variable],
    output: &Variable,
    rules: &[ParsedRule],
    samples: i32,
) -> Result<MamdaniFIS, Box<dyn std::error::Error>> {
    let mut engine = MamdaniFIS::new(
        SNorms::Max,
        TNorms::Min,
        Implications::Min,
        Aggregations::Max,
        Defuzzifiers::Centroid,
    );
    for input in inputs {
        let mut variable = InputVariable::new(input.name.clone(), (input.low, input.high));
        for (name, corners) in &input.terms {
            let kind = match corners[..] {
                [a, b, c] => MFKind::Triangle(Triangle::new(a, b, c)),
                [a, b, c, d] => MFKind::Trapezoid(Trapezoid::new(a, b, c, d)),
                _ => return Err(format!("`{name}` has {} corners", corners.len()).into()),
            };
            variable.add_membership(MF::new(name.clone(), kind));
        }
        engine.add_input(variable);
    }
    let mut variable = OutputVariable::new(output.name.clone(), (output.low, output.high), samples);
    for (name, corners) in &output.terms {
        let [a, b, c] = corners[..] else {
            return Err(format!("`{name}` is not a triangle").into());
        };
        let universe = variable.get_universe();
        let range = MembershipRange::new_triangle(universe, name.clone(), a, b, c);
        variable.add_membership(range);
    }
    engine.add_output(variable);
    for rule in rules {
        let places = rule.inputs.iter().chain([&rule.output]);
        let places = places.map(|place| *place as i32).collect();
        engine.add_rule(Rule::new_and(places, rule.weight));
    }
    Ok(engine)
}

fn oxictl(
    system: &str,
    inputs: &[Variable],
    output: &Variable,
    rules: &[ParsedRule],
    rows: &[Vec<f64>],
) -> Result<(), Box<dyn std::error::Error>> {
    type MembershipFunction = Box<dyn MembershipFn<f64>>;
    let shapes = |variable: &Variable| -> Result<Vec<MembershipFunction>, Box<dyn std::error::Error>> {
        let shape = |(name, corners): &(String, Vec<f64>)| -> Result<MembershipFunction, String> {
            match corners[..] {
                [a, b, c] => Triangular::new(a, b, c).map(|s| Box::new(s) as MembershipFunction),
                [a, b, c, d] => Trapezoidal::new(a, b, c, d).map(|s| Box::new(s) as MembershipFunction),
                _ => return Err(format!("`{name}` has {} corners", corners.len())),
            }
            .map_err(|error| error.to_string())
        };
        Ok(variable.terms.iter().map(shape).collect::<Result<_, _>>()?)
    };
    let inputs: Vec<Vec<MembershipFunction>> = inputs.iter().map(shapes).collect::<Result<_, _>>()?;
    let inputs: Vec<Vec<&dyn MembershipFn<f64>>> = inputs
        .iter()
        .map(|terms| terms.iter().map(|t| &**t).collect())
        .collect();
    let inputs: Vec<&[&dyn MembershipFn<f64>]> = inputs.iter().map(|terms| &**terms).collect();
    let terms = shapes(output)?;
    let terms: Vec<&dyn MembershipFn<f64>> = terms.iter().map(|t| &**t).collect();

    // The maximum number of rules is part of the type, so each system gets a type of its own.
    macro_rules! with_room_for {
        ($rules:literal) => {{
            let mut engine = MamdaniEngine::<f64, $rules, 8>::new(TNorm::Min);
            for rule in rules {
                let mut antecedent = Antecedent::new();
                for (input, term) in rule.inputs.iter().enumerate() {
                    antecedent.add(input, *term).map_err(|e| e.to_string())?;
                }
                let consequent = Consequent::new(0, rule.output, rule.weight);
                let rule = FuzzyRule::new(antecedent, consequent);
                engine.add_rule(rule).map_err(|e| e.to_string())?;
            }
            let values = inputs.len();
            report(
                system,
                "oxictl 0.1 (Rust) 128 samples",
                output,
                rows,
                |row| {
                    let range = (output.low, output.high);
                    let value =
                        engine.infer_crisp(&row[..values], &inputs, &terms, range.0, range.1);
                    value.unwrap_or(f64::NAN)
                },
            );
        }};
    }
    if rules.len() > 16 {
        with_room_for!(625);
    } else {
        with_room_for!(16);
    }
    Ok(())
}

/// Prints the time per call in the fastest of many rounds, and the largest error in percent of the output's range. The
/// exact values are in the last column of the rows.
fn report(
    system: &str,
    program: &str,
    output: &Variable,
    rows: &[Vec<f64>],
    evaluate: impl Fn(&[f64]) -> f64,
) {
    let (mut best, mut error) = (f64::INFINITY, 0.0_f64);
    let begun = Instant::now();
    while begun.elapsed() < Duration::from_millis(1500) {
        let start = Instant::now();
        for row in rows {
            if let [inputs @ .., exact] = &row[..] {
                let distance = (evaluate(black_box(inputs)) - exact).abs();
                error = if distance > error { distance } else { error };
            }
        }
        best = best.min(start.elapsed().as_secs_f64());
    }
    let nanoseconds = best * 1e9 / rows.len() as f64;
    let percent = 100.0 * error / (output.high - output.low);
    println!("{system},{program},{nanoseconds:.0},{percent:.2}");
}
