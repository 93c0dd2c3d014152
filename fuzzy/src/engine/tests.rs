//! What an outcome says.

use alloc::string::ToString;

use super::*;
use crate::model::{Model, NoRuleFires, Output, Shape, Variable};
use crate::rule::{Condition, Rule};

/// `x` in [0, 10] says `y` in [0, 100]: a gap without a rule from 4 to 6.
fn gap(when_no_rule_fires: NoRuleFires) -> Model {
    let shoulder = |top, foot| Shape::LeftShoulder { top, foot };
    Model::builder("gap")
        .input(
            Variable::new("x", 0.0, 10.0)
                .term("low", shoulder(1.0, 4.0))
                .term(
                    "high",
                    Shape::RightShoulder {
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
                        Shape::Rectangle {
                            left: 0.0,
                            right: 20.0,
                        },
                    )
                    .term(
                        "large",
                        Shape::Rectangle {
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
            dominant: Some(0),
            clamped: false,
        }
    );
    assert_eq!(one(&engine, 9.0).coverage, 0.5);
    assert_eq!(one(&engine, 9.0).dominant, Some(1));
    assert_eq!((engine.input("x"), engine.input("z")), (Some(0), None));
    assert_eq!((engine.output("y"), engine.output("x")), (Some(0), None));
}

#[test]
fn where_no_rule_fires() {
    let undefined = one(&Engine::new(&gap(NoRuleFires::Undefined)).unwrap(), 5.0);
    assert_eq!(undefined.state, State::NoRuleFired);
    assert_eq!(undefined.value(), None);
    assert_eq!((undefined.coverage, undefined.dominant), (0.0, None));

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
fn no_answer_is_left_from_an_earlier_call() {
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
fn inputs_out_of_range_and_out_of_the_numbers() {
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
fn wrong_numbers_of_places() {
    let engine = Engine::new(&gap(NoRuleFires::Undefined)).unwrap();
    assert_eq!(
        engine.evaluate(&[1.0, 2.0]).unwrap_err().to_string(),
        "2 values were given for 1 input(s)"
    );
    assert_eq!(
        engine
            .evaluate_with(&mut engine.scratch(), &[1.0], &mut [])
            .unwrap_err()
            .to_string(),
        "there is room for 0 outcomes of 1 output(s)"
    );
}

#[test]
fn every_problem_of_a_model_at_once() {
    let mut model = gap(NoRuleFires::Value(101.0));
    model.inputs.push(Variable::new("x", 1.0, 1.0));
    model.inputs[0].terms[0].shape = Shape::Gaussian {
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
        Engine::new(&model).unwrap_err().to_string().replace("; ", "\n"),
        @"
    `x` is defined twice in the inputs
    term `low` of `x`: `sd` is -1, not over 0
    the range of `x` is not from a finite number up to a larger one
    the value of `y` where no rule fires is not in its range
    rule 3 names `z`, which is no input
    rule 3 names `middle`, which is no term of `x`
    the weight of rule 1 is not in [0, 1]
    rule 3 names `none`, which is no term of `y`
    "
    );
}
