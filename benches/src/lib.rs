//! The fuzzy systems that the benchmarks in this package and in `benches/peers` evaluate.

use fuzzy::model::{
    Defuzzifier, Implication, LowerFunction, MembershipFunction, Model, ModelBuilder, Output,
    Variable,
};
use fuzzy::rule::{Condition, Rule};

fn triangle(left: f64, peak: f64, right: f64) -> MembershipFunction {
    MembershipFunction::Triangle { left, peak, right }
}

/// System (a), the tipper: 2 inputs with gaussian and trapezoid terms, 3 rules.
pub fn tipper() -> Model {
    let gaussian = |mean| MembershipFunction::Gaussian { mean, sd: 1.5 };
    let trapezoid = |left, left_top, right_top, right| MembershipFunction::Trapezoid {
        left,
        left_top,
        right_top,
        right,
    };
    let poor = Condition::is("service", "poor").or(Condition::is("food", "rancid"));
    let excellent = Condition::is("service", "excellent").or(Condition::is("food", "delicious"));
    Model::builder("tipper")
        .input(
            Variable::new("service", 0.0, 10.0)
                .term("poor", gaussian(0.0))
                .term("good", gaussian(5.0))
                .term("excellent", gaussian(10.0)),
        )
        .input(
            Variable::new("food", 0.0, 10.0)
                .term("rancid", trapezoid(-1.0, 0.0, 1.0, 3.0))
                .term("delicious", trapezoid(7.0, 9.0, 10.0, 11.0)),
        )
        .output(Output::new(
            Variable::new("tip", 0.0, 30.0)
                .term("cheap", triangle(0.0, 5.0, 10.0))
                .term("average", triangle(10.0, 15.0, 20.0))
                .term("generous", triangle(20.0, 25.0, 30.0)),
        ))
        .rule(Rule::new(poor, "tip", "cheap"))
        .rule(Rule::new(
            Condition::is("service", "good"),
            "tip",
            "average",
        ))
        .rule(Rule::new(excellent, "tip", "generous"))
        .build()
}

/// Systems (bw) and (b): the ten rules of the published method, with their degrees as weights (bw) or without weights
/// (b).
pub fn published(weighted: bool) -> Model {
    let mut model = Model::builder("published")
        .input(
            Variable::new("margin", 0.0, 0.5)
                .term("very_low", triangle(-0.1, 0.0, 0.1))
                .term("low", triangle(0.0, 0.1, 0.2))
                .term("medium", triangle(0.1, 0.2, 0.3))
                .term(
                    "high",
                    MembershipFunction::RightShoulder {
                        foot: 0.2,
                        top: 0.3,
                    },
                ),
        )
        .input(
            Variable::new("spread", 0.0, 0.5)
                .term("low", triangle(-0.1, 0.0, 0.1))
                .term("medium", triangle(0.0, 0.1, 0.2))
                .term(
                    "high",
                    MembershipFunction::RightShoulder {
                        foot: 0.1,
                        top: 0.2,
                    },
                ),
        )
        .output(Output::new(
            Variable::new("risk", 0.0, 100.0)
                .unit("%")
                .term("very_low", triangle(-25.0, 0.0, 25.0))
                .term("low", triangle(0.0, 25.0, 50.0))
                .term("medium", triangle(25.0, 50.0, 75.0))
                .term("high", triangle(50.0, 75.0, 100.0))
                .term("very_high", triangle(75.0, 100.0, 125.0)),
        ))
        .build();
    for (margin, spread, risk, degree) in [
        ("high", "high", "very_low", 0.23),
        ("high", "low", "very_low", 0.88),
        ("high", "medium", "very_low", 0.76),
        ("medium", "high", "very_low", 0.63),
        ("medium", "low", "very_low", 0.41),
        ("medium", "medium", "low", 0.73),
        ("low", "high", "very_high", 0.84),
        ("low", "medium", "medium", 0.64),
        ("very_low", "high", "very_high", 1.0),
        ("very_low", "medium", "very_high", 0.35),
    ] {
        let condition = Condition::is("margin", margin).and(Condition::is("spread", spread));
        let rule = Rule::new(condition, "risk", risk).with(if weighted { degree } else { 1.0 });
        model.rules.push(rule.into());
    }
    model
}

/// System (b2): like (b), but with interval type-2 terms. The feet of the upper membership functions are moved outwards
/// by a tenth of the distance between two terms. The feet of the lower ones are moved inwards by the same distance, and
/// their height is 0.9.
pub fn published_type2() -> Model {
    let mut model = published(false);
    let widen = |variable: &mut Variable, by: f64| {
        let end = variable.high;
        for term in &mut variable.terms {
            let moved = |by: f64| match term.membership_function {
                MembershipFunction::Triangle { left, peak, right } => {
                    triangle(left - by, peak, right + by)
                }
                // The other programs support only trapezoids.
                MembershipFunction::RightShoulder { foot, top } => MembershipFunction::Trapezoid {
                    left: foot - by,
                    left_top: top,
                    right_top: end,
                    right: 1.2 * end + by,
                },
                ref other => other.clone(),
            };
            term.lower = Some(LowerFunction {
                membership_function: moved(-by),
                height: 0.9,
            });
            term.membership_function = moved(by);
        }
    };
    for input in &mut model.inputs {
        widen(input, 0.01);
    }
    for output in &mut model.outputs {
        widen(&mut output.variable, 2.5);
    }
    model
}

/// System (c): 4 inputs of 5 terms and all 625 rules; the index of the consequent is the rounded mean of the indices
/// of the antecedent's terms.
pub fn four_inputs() -> Model {
    let terms = ["t0", "t1", "t2", "t3", "t4"];
    let five = |name: &str, high: f64| {
        let step = high / 4.0;
        terms
            .iter()
            .zip(0..)
            .fold(Variable::new(name, 0.0, high), |variable, (term, i)| {
                let peak = f64::from(i) * step;
                variable.term(*term, triangle(peak - step, peak, peak + step))
            })
    };
    let names = ["x0", "x1", "x2", "x3"];
    let mut builder = Model::builder("four inputs").output(Output::new(five("y", 100.0)));
    for name in names {
        builder = builder.input(five(name, 1.0));
    }
    let mut model = builder.build();
    for number in 0..625usize {
        let digits = [number / 125, number / 25 % 5, number / 5 % 5, number % 5];
        let condition = names
            .iter()
            .zip(digits)
            .map(|(name, digit)| Condition::is(name, terms[digit]))
            .reduce(Condition::and);
        let mean = (digits.iter().sum::<usize>() + 2) / 4;
        if let Some(condition) = condition {
            model
                .rules
                .push(Rule::new(condition, "y", terms[mean]).into());
        }
    }
    model
}

/// The published rules with the product as implication.
pub fn larsen() -> Model {
    let mut model = published(true);
    model.operators.implication = Implication::Product;
    model
}

/// The published rules with output terms so wide that four overlap.
pub fn overlapping() -> Model {
    let mut model = published(true);
    for output in &mut model.outputs {
        for (term, peak) in output
            .variable
            .terms
            .iter_mut()
            .zip([0.0, 25.0, 50.0, 75.0, 100.0])
        {
            term.membership_function = triangle(peak - 60.0, peak, peak + 60.0);
        }
    }
    model
}

/// A Takagi-Sugeno system: 2 inputs of 3 terms, 9 rules with linear consequents.
pub fn takagi_sugeno() -> Model {
    let names = ["low", "medium", "high"];
    let mut power = Variable::new("power", 0.0, 100.0);
    let mut rules = Vec::new();
    for (i, heat) in (0u8..).zip(names) {
        for (j, damp) in (0u8..).zip(names) {
            let term = format!("{heat}_{damp}");
            let (i, j) = (f64::from(i), f64::from(j));
            power = power.term(
                &*term,
                MembershipFunction::Linear {
                    coefficients: vec![
                        ("heat".into(), 1.0 + 0.5 * i),
                        ("damp".into(), 0.25 * j - 0.3),
                    ],
                    constant: 10.0 * i - 4.0 * j,
                },
            );
            let condition = Condition::is("heat", heat).and(Condition::is("damp", damp));
            rules.push(Rule::new(condition, "power", &term));
        }
    }
    let builder = Model::builder("takagi sugeno")
        .input(Variable::new("heat", 0.0, 40.0).partition(names))
        .input(Variable::new("damp", 0.0, 100.0).partition(names))
        .output(Output::new(power).defuzzifier(Defuzzifier::WeightedAverage));
    rules.into_iter().fold(builder, ModelBuilder::rule).build()
}

/// Points spread over the inputs' ranges, the same on every machine: a Weyl sequence.
pub fn points(model: &Model, count: usize) -> Vec<Vec<f64>> {
    const STEPS: [f64; 4] = [
        0.618_033_988_749_894_8,
        0.414_213_562_373_095_1,
        0.732_050_807_568_877_2,
        0.236_067_977_499_789_7,
    ];
    (1..=count)
        .map(|i| {
            let inputs = model.inputs.iter().zip(STEPS);
            inputs
                .map(|(v, step)| v.low + (v.high - v.low) * (i as f64 * step).fract())
                .collect()
        })
        .collect()
}

/// System (g), a common kind of system with gaussian terms: 2 inputs of 5 terms, 25 rules, and an output with `outputs`
/// terms.
pub fn gaussians(outputs: usize) -> Model {
    let of = |name: &str, low: f64, high: f64, count: usize| {
        let step = (high - low) / (count - 1) as f64;
        (0..count).fold(Variable::new(name, low, high), |variable, i| {
            let term = MembershipFunction::Gaussian {
                mean: low + step * i as f64,
                // The widths differ, but none is so large that the term is flat.
                sd: step * (0.35 + 0.05 * (i % 3) as f64),
            };
            variable.term(format!("t{i}"), term)
        })
    };
    let mut model = Model::builder("gaussians")
        .input(of("x", 0.0, 10.0, 5))
        .input(of("y", -1.0, 1.0, 5))
        .output(Output::new(of("z", 0.0, 100.0, outputs)))
        .build();
    for x in 0..5 {
        for y in 0..5 {
            let condition =
                Condition::is("x", &format!("t{x}")).and(Condition::is("y", &format!("t{y}")));
            let z = (x + y) * (outputs - 1) / 8;
            model
                .rules
                .push(Rule::new(condition, "z", &format!("t{z}")).into());
        }
    }
    model
}
