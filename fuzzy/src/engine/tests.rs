//! Tests of the outcomes of evaluations.

use alloc::string::ToString;

use super::*;
use crate::model::{MembershipFunction, Model, NoRuleFires, Output, Variable};
use crate::rule::{Condition, Rule};

/// Returns a model in which `x` in [0, 10] determines `y` in [0, 100], and no rule covers 4 to 6.
fn gap(when_no_rule_fires: NoRuleFires) -> Model {
    let shoulder = |top, foot| MembershipFunction::LeftShoulder { top, foot };
    Model::builder("gap")
        .input(
            Variable::new("x", 0.0, 10.0)
                .term("low", shoulder(1.0, 4.0))
                .term(
                    "high",
                    MembershipFunction::RightShoulder {
                        foot: 6.0,
                        top: 9.0,
                    },
                ),
        )
        .output(
            Output::new(
                Variable::new("y", 0.0, 100.0)
                    .term(
                        "small",
                        MembershipFunction::Rectangle {
                            left: 0.0,
                            right: 20.0,
                        },
                    )
                    .term(
                        "large",
                        MembershipFunction::Rectangle {
                            left: 80.0,
                            right: 100.0,
                        },
                    ),
            )
            .when_no_rule_fires(when_no_rule_fires),
        )
        .rule(Rule::new(Condition::is("x", "low"), "y", "small"))
        .rule(Rule::new(Condition::is("x", "high"), "y", "large").with(0.5))
        .build()
}

fn one(engine: &Engine, x: f64) -> Outcome {
    engine.evaluate(&[x]).unwrap()[0]
}

#[test]
fn a_value_with_its_reasons() {
    let engine = Engine::new(&gap(NoRuleFires::Undefined)).unwrap();
    assert_eq!(
        one(&engine, 2.5),
        Outcome {
            state: State::Defined(10.0),
            coverage: 0.5,
            dominant_rule: Some(0),
            clamped: false,
        }
    );
    assert_eq!(one(&engine, 9.0).coverage, 0.5);
    assert_eq!(one(&engine, 9.0).dominant_rule, Some(1));
    assert_eq!((engine.input("x"), engine.input("z")), (Some(0), None));
    assert_eq!((engine.output("y"), engine.output("x")), (Some(0), None));
}

#[test]
fn where_no_rule_fires() {
    let undefined = one(&Engine::new(&gap(NoRuleFires::Undefined)).unwrap(), 5.0);
    assert_eq!(undefined.state, State::NoRuleFired);
    assert_eq!(undefined.value(), None);
    assert_eq!((undefined.coverage, undefined.dominant_rule), (0.0, None));

    let chosen = one(&Engine::new(&gap(NoRuleFires::Value(42.0))).unwrap(), 5.0);
    assert_eq!(chosen.state, State::Default(42.0));
    assert_eq!(chosen.value(), Some(42.0));

    let error = Engine::new(&gap(NoRuleFires::Error))
        .unwrap()
        .evaluate(&[5.0]);
    assert_eq!(
        error.unwrap_err().to_string(),
        "no rule fired for output `y`"
    );
}

#[test]
fn no_value_remains_from_an_earlier_call() {
    let engine = Engine::new(&gap(NoRuleFires::Undefined)).unwrap();
    let mut scratch = engine.scratch();
    let mut outcome = [Outcome::default()];
    for (x, defined) in [
        (0.0, true),
        (5.0, false),
        (10.0, true),
        (f64::NAN, false),
        (5.0, false),
    ] {
        engine
            .evaluate_with(&mut scratch, &[x], &mut outcome)
            .unwrap();
        assert_eq!(outcome[0].value().is_some(), defined, "at {x}");
        assert_eq!(outcome[0], one(&engine, x), "at {x}");
    }
}

#[test]
fn inputs_out_of_range_and_not_finite() {
    let engine = Engine::new(&gap(NoRuleFires::Undefined)).unwrap();
    let (inside, outside) = (one(&engine, 10.0), one(&engine, 1e300));
    assert!(!inside.clamped && outside.clamped);
    assert_eq!(inside.value(), outside.value());
    for x in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        assert_eq!(one(&engine, x).state, State::InputNotFinite);
        assert_eq!(one(&engine, x).value(), None);
    }
}

#[test]
fn wrong_numbers_of_inputs_are_refused() {
    let engine = Engine::new(&gap(NoRuleFires::Undefined)).unwrap();
    assert_eq!(
        engine.evaluate(&[1.0, 2.0]).unwrap_err().to_string(),
        "the model has 1 input, but 2 values were given"
    );
    assert_eq!(
        engine
            .evaluate_with(&mut engine.scratch(), &[1.0], &mut [])
            .unwrap_err()
            .to_string(),
        "there must be room for 1 outcome, not for 0"
    );
}

#[test]
fn all_problems_of_a_model_are_reported_at_once() {
    let mut model = gap(NoRuleFires::Value(101.0));
    model.inputs.push(Variable::new("x", 1.0, 1.0));
    model.inputs[0].terms[0].membership_function = MembershipFunction::Gaussian {
        mean: 0.0,
        sd: -1.0,
    };
    model.rules[0].rule.weight = f64::NAN;
    model.rules.push(
        Rule::new(
            Condition::is("z", "low").or(Condition::is("x", "middle")),
            "y",
            "none",
        )
        .into(),
    );
    insta::assert_snapshot!(
        Engine::new(&model).unwrap_err().to_string(),
        @"
    error[duplicate-variable]: the rule set has the variable `x` twice
      help: each input and output must have its own name: rename or remove one of the two
    error[wrong-parameter]: term `low` of input `x`: `sd` is -1, but must be greater than 0
      help: write a number greater than 0
    error[wrong-range]: the maximum of the range of input `x` must be greater than its minimum, but the range is [1, 1]
      help: write a greater maximum
    error[value-outside-range]: the value 101 is outside the range of output `y`
      help: write a value from 0 to 100
    error[weight-outside-range]: rule 1: the weight NaN is outside [0, 1]
      help: a weight is a number from 0 to 1
    error[unknown-term]: rule 3: input `x` has no term `middle`
      help: choose one of `low` and `high`
    error[unknown-term]: rule 3: output `y` has no term `none`
      help: choose one of `small` and `large`
    "
    );
}

/// Compares the bits of two outcomes, which distinguishes -0.0 from 0.0, and prints them if they differ.
fn same_bits(one: &Outcome, other: &Outcome) -> bool {
    let bits = |outcome: &Outcome| {
        let value = outcome.value().map(f64::to_bits);
        (
            value,
            outcome.coverage.to_bits(),
            outcome.dominant_rule,
            outcome.clamped,
        )
    };
    bits(one) == bits(other)
        && core::mem::discriminant(&one.state) == core::mem::discriminant(&other.state)
}

/// Returns a model with all kinds of terms for which a batch evaluates several rows together.
fn slopes(when_no_rule_fires: NoRuleFires) -> Model {
    let triangle = |left, peak, right| MembershipFunction::Triangle { left, peak, right };
    let risk = Variable::new("z", -1.0, 3.0)
        .term(
            "large",
            MembershipFunction::RightShoulder {
                foot: 1.0,
                top: 2.0,
            },
        )
        .term(
            "small",
            MembershipFunction::LeftShoulder {
                top: 0.0,
                foot: 1.0,
            },
        )
        .term("middle", triangle(0.0, 1.0, 2.0));
    let and = |x, y| Condition::is("x", x).and(Condition::is("y", y));
    Model::builder("slopes")
        .input(
            Variable::new("x", 0.0, 1.0)
                .term("falls", triangle(0.0, 0.0, 0.5))
                .term(
                    "plateau",
                    MembershipFunction::Trapezoid {
                        left: 0.1,
                        left_top: 0.3,
                        right_top: 0.4,
                        right: 0.9,
                    },
                )
                .term(
                    "rises",
                    MembershipFunction::RightShoulder {
                        foot: 0.3,
                        top: 0.7,
                    },
                ),
        )
        .input(
            Variable::new("y", 0.0, 1.0)
                .term(
                    "low",
                    MembershipFunction::LeftShoulder {
                        top: 0.2,
                        foot: 0.6,
                    },
                )
                .term("high", triangle(0.3, 1.0, 1.0)),
        )
        .output(Output::new(risk).when_no_rule_fires(when_no_rule_fires))
        .rule(Rule::new(and("falls", "low"), "z", "small").with(0.7))
        .rule(Rule::new(and("plateau", "low"), "z", "middle"))
        .rule(Rule::new(and("rises", "high"), "z", "large"))
        .rule(Rule::new(Condition::is("y", "high"), "z", "middle").with(0.3))
        .build()
}

mod laws {
    use super::*;
    use proptest::prelude::*;

    fn value() -> impl Strategy<Value = f64> {
        prop_oneof![
            4 => 0.0..=1.0f64,
            2 => prop::sample::select(vec![0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.9, 1.0]),
            1 => prop::sample::select(vec![-1.0, 2.0, f64::NAN, f64::INFINITY, 1e-300, 0.5 + 1e-16]),
        ]
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

        #[test]
        fn a_batch_has_the_bits_of_single_calls(
            points in prop::collection::vec((value(), value()), 1..150),
            default in any::<bool>(),
        ) {
            let when = if default { NoRuleFires::Value(0.5) } else { NoRuleFires::Undefined };
            let engine = Engine::new(&slopes(when)).unwrap();
            let (x, y): (Vec<f64>, Vec<f64>) = points.iter().copied().unzip();
            let batch = engine.evaluate_batch(&[&x, &y]).unwrap();
            let mut values = vec![0.0; points.len()];
            engine.evaluate_columns(&[&x, &y], &mut [&mut values]).unwrap();
            let values = values.into_iter().map(|value| Some(value).filter(|value| !value.is_nan()));
            prop_assert!(values.eq(batch.iter().map(Outcome::value)));
            for ((x, y), outcome) in points.iter().zip(&batch) {
                let single = engine.evaluate(&[*x, *y]).unwrap()[0];
                prop_assert!(same_bits(&single, outcome), "at {x}, {y}: {single:?}, {outcome:?}");
            }
        }

        #[test]
        fn the_order_of_rules_and_the_unit_change_nothing(
            (x, y) in (0.0..=1.0f64, 0.0..=1.0f64),
            rotation in 0..4usize,
            scale in prop::sample::select(vec![1e-3, 0.5, 3.0, 1e6]),
        ) {
            let model = slopes(NoRuleFires::Undefined);
            let expected = Engine::new(&model).unwrap().evaluate(&[x, y]).unwrap()[0];

            let mut rotated = model.clone();
            rotated.rules.rotate_left(rotation);
            let outcome = Engine::new(&rotated).unwrap().evaluate(&[x, y]).unwrap()[0];
            prop_assert_eq!(outcome.value().map(f64::to_bits), expected.value().map(f64::to_bits));
            prop_assert_eq!(outcome.coverage, expected.coverage);

            let mut scaled = model;
            let output = &mut scaled.outputs[0].variable;
            (output.low, output.high) = (scale * output.low, scale * output.high);
            for term in &mut output.terms {
                let corners = term.membership_function.corners().unwrap();
                let points = corners.into_iter().map(|(x, y)| (scale * x, y)).collect();
                term.membership_function = MembershipFunction::Piecewise { points };
            }
            let outcome = Engine::new(&scaled).unwrap().evaluate(&[x, y]).unwrap()[0];
            match (outcome.value(), expected.value()) {
                (Some(scaled), Some(value)) => {
                    prop_assert!((scaled - scale * value).abs() <= 1e-12 * 4.0 * scale);
                    prop_assert!((-1.0..=3.0).contains(&value));
                }
                (scaled, value) => prop_assert_eq!(scaled, value),
            }
        }

        /// A mirrored model at the mirrored point gives the mirrored value.
        #[test]
        fn mirrored_models_give_mirrored_values((x, y) in (0.0..=1.0f64, 0.0..=1.0f64)) {
            let model = slopes(NoRuleFires::Undefined);
            let mut mirrored = model.clone();
            let outputs = mirrored.outputs.iter_mut().map(|o| &mut o.variable);
            for variable in mirrored.inputs.iter_mut().chain(outputs) {
                (variable.low, variable.high) = (-variable.high, -variable.low);
                for term in &mut variable.terms {
                    let corners = term.membership_function.corners().unwrap();
                    let points = corners.into_iter().rev().map(|(x, y)| (-x, y)).collect();
                    term.membership_function = MembershipFunction::Piecewise { points };
                }
            }
            let value = Engine::new(&model).unwrap().evaluate(&[x, y]).unwrap()[0].value();
            let mirror = Engine::new(&mirrored).unwrap().evaluate(&[-x, -y]).unwrap()[0].value();
            match (value, mirror) {
                (Some(value), Some(mirror)) => prop_assert!((value + mirror).abs() <= 1e-12),
                (value, mirror) => prop_assert_eq!(value, mirror),
            }
        }

        /// With one input, ordered terms and consequents in the same order, the output increases with the input.
        #[test]
        fn monotone_models_are_monotone(a in 0.0..=10.0f64, b in 0.0..=10.0f64) {
            let three = |name| Variable::new(name, 0.0, 10.0)
                .term("low", MembershipFunction::LeftShoulder { top: 0.0, foot: 5.0 })
                .term("middle", MembershipFunction::Triangle { left: 0.0, peak: 5.0, right: 10.0 })
                .term("high", MembershipFunction::RightShoulder { foot: 5.0, top: 10.0 });
            let mut model = Model::builder("follows")
                .input(three("x"))
                .output(Output::new(three("y")))
                .build();
            for term in ["low", "middle", "high"] {
                model.rules.push(Rule::new(Condition::is("x", term), "y", term).into());
            }
            let engine = Engine::new(&model).unwrap();
            let y = |x: f64| one(&engine, x).value().unwrap();
            prop_assert!(y(a.min(b)) <= y(a.max(b)) + 1e-12);
        }
    }
}
