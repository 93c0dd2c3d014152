//! Tests of values, precedence and syntax errors of formulas.

use alloc::string::{String, ToString};
use alloc::vec::Vec;

use proptest::prelude::*;

use super::{Expression, Formula, Operation, Variable};

fn value(text: &str) -> f64 {
    let formula: Formula = text
        .parse()
        .unwrap_or_else(|found| panic!("{text}: {found}"));
    formula.evaluate(|name| match name {
        "x" => 2.0,
        "y" => -3.5,
        "wind speed" => 7.0,
        other => panic!("{other}"),
    })
}

#[test]
fn operators_bind_as_in_mathematics() {
    let (x, y) = (2.0_f64, -3.5_f64);
    for (text, expected) in [
        ("1 + 2 * 3", 7.0),
        ("(1 + 2) * 3", 9.0),
        ("10 - 4 - 3", 3.0),
        ("16 / 4 / 2", 2.0),
        ("7 % 4 * 2", 6.0),
        ("-7 % 4", -3.0),
        ("2^3^2", 512.0),
        ("-2^2", -4.0),
        ("(-2)^2", 4.0),
        ("2^-1", 0.5),
        ("2 * -3", -6.0),
        ("--2", 2.0),
        ("1 < 2 and 2 < 3", 1.0),
        ("1 < 2 and not 2 < 3", 0.0),
        ("not 1 == 2 or 0", 1.0),
        ("1 or 1 and 0", 1.0),
        ("(1 or 1) and 0", 0.0),
        ("1 + 1 >= 2", 1.0),
        ("2 != 2", 0.0),
        ("0.5 and 2", 1.0),
        ("x^2 + y", x * x + y),
        ("'wind speed' * \"x\"", 14.0),
        ("2 * speed_of_light(1)", f64::NAN),
        ("pi * .5e1", core::f64::consts::PI * 5.0),
        ("min(x, y) - max(x, y)", y - x),
        ("pow(x, 3) + fmod(7, x)", 9.0),
        ("gt(x, y) + neq(x, x)", 1.0),
    ] {
        if expected.is_nan() {
            assert!(text.parse::<Formula>().is_err(), "{text}");
        } else {
            assert_eq!(value(text), expected, "{text}");
        }
    }
}

#[test]
fn functions_are_those_of_the_standard_library() {
    let (x, y) = (0.7_f64, -0.3_f64);
    for (name, expected) in [
        ("abs(-0.7)", x),
        ("acos(0.7)", x.acos()),
        ("acosh(1 / 0.7)", (1.0 / x).acosh()),
        ("asin(0.7)", x.asin()),
        ("asinh(0.7)", x.asinh()),
        ("atan(0.7)", x.atan()),
        ("atan2(-0.3, 0.7)", y.atan2(x)),
        ("atanh(0.7)", x.atanh()),
        ("ceil(-0.3)", -0.0),
        ("cos(0.7)", x.cos()),
        ("cosh(0.7)", x.cosh()),
        ("exp(0.7)", x.exp()),
        ("floor(-0.3)", -1.0),
        ("log(0.7)", x.ln()),
        ("log10(0.7)", x.log10()),
        ("log1p(0.7)", x.ln_1p()),
        ("round(2.5) + round(-2.5) + round(0.4)", 0.0),
        ("sin(0.7)", x.sin()),
        ("sinh(0.7)", x.sinh()),
        ("sqrt(0.7)", x.sqrt()),
        ("tan(0.7)", x.tan()),
        ("tanh(0.7)", x.tanh()),
    ] {
        let found = value(name);
        assert!(
            (found - expected).abs() <= 4e-16,
            "{name}: {found} {expected}"
        );
    }
    // Verifies that the tests above contain every function except `max` and `min`.
    for (operation, word, _) in Operation::ALL {
        if operation.binds().is_none() && !["max", "min"].contains(word) {
            assert!(include_str!("tests.rs").contains(&alloc::format!("(\"{word}(")));
        }
    }
}

#[test]
fn a_formula_without_a_value_is_not_finite() {
    for text in [
        "1 / 0",
        "sqrt(-1)",
        "log(0)",
        "0 / 0",
        "asin(2)",
        "max(0 / 0, 1)",
    ] {
        assert!(!value(text).is_finite(), "{text}");
    }
    assert_eq!(value("min(1, 1 / 0)"), 1.0);
}

/// Returns the position of a syntax error, its message, and the suggestion.
fn mistake(text: &str) -> String {
    let found = text.parse::<Formula>().unwrap_err();
    let here = &text[found.span.clone()];
    let help = found.help.as_deref().unwrap_or("none");
    alloc::format!("{text} | {here} | {} | {help}", found.message)
}

#[test]
fn mistakes_are_reported_with_their_position() {
    let texts = [
        "",
        "2 +",
        "2 * (x + 1",
        "2 * x + 1)",
        "sni(x)",
        "max(x)",
        "min(x, y, 1)",
        "sin(x",
        "2 x",
        "2(x + 1)",
        "x = 2",
        "x ** 2",
        "x && y",
        "!x",
        "1 < x < 2",
        "0,5 * x",
        "1.2.3",
        "1e999",
        "'wind speed",
        "and x",
        "x ² 2",
        "wind speed",
    ];
    let reported: Vec<String> = texts.into_iter().map(mistake).collect();
    insta::assert_snapshot!(reported.join("\n"));
    let deep = "(".repeat(70) + "1";
    assert!(mistake(&deep).contains("nested more than 64 levels deep"));
    let long = "1 + ".repeat(600) + "1";
    assert!(mistake(&long).contains("more than 1000 parts"));
    let wide = "1 + (".repeat(40) + "1" + &")".repeat(40);
    assert!(mistake(&wide).contains("more than 32 intermediate results"));
}

/// Generates formulas that can be written as text.
pub(crate) fn any_formula() -> impl Strategy<Value = Formula> {
    let number = prop_oneof![
        0.0..1000.0,
        Just(core::f64::consts::PI),
        Just(0.1),
        Just(1e-9)
    ];
    let operand = prop_oneof![
        number.prop_map(Expression::Number),
        (0..3_usize).prop_map(Expression::Variable),
    ];
    let all = prop::sample::select(Operation::ALL);
    let tree = operand.prop_recursive(4, 20, 2, move |inner| {
        (all.clone(), inner.clone(), inner).prop_map(|((operation, _, count), a, b)| {
            Expression::Apply(operation, [a, b].into_iter().take(count).collect())
        })
    });
    // Variables are numbered in the order of their first occurrence.
    tree.prop_map(|mut tree| {
        let mut names: Vec<usize> = Vec::new();
        fn renumber(tree: &mut Expression, met: &mut Vec<usize>) {
            match tree {
                Expression::Number(_) => {}
                Expression::Variable(index) => {
                    let known = met.iter().position(|other| other == index);
                    *index = known.unwrap_or_else(|| {
                        met.push(*index);
                        met.len() - 1
                    });
                }
                Expression::Apply(_, operands) => {
                    operands.iter_mut().for_each(|one| renumber(one, met));
                }
            }
        }
        renumber(&mut tree, &mut names);
        let name = |index: usize| ["speed", "wind speed", "not"][index].to_string();
        let variables = names.into_iter().map(|index| Variable {
            name: name(index),
            spans: Vec::new(),
        });
        Formula::new(tree, variables.collect())
    })
}

proptest! {
    #[test]
    fn a_printed_formula_reads_back_as_the_same(formula in any_formula()) {
        let text = formula.to_string();
        let again: Result<Formula, _> = text.parse();
        prop_assert_eq!(again.as_ref(), Ok(&formula), "{}", text);
        let value = |name: &str| name.len() as f64;
        let (one, other) = (formula.evaluate(value), again.unwrap().evaluate(value));
        prop_assert_eq!(one.to_bits(), other.to_bits());
    }

    #[test]
    fn any_text_is_a_formula_or_a_mistake_inside_it(text in "\\PC{0,40}") {
        if let Err(found) = text.parse::<Formula>() {
            prop_assert!(text.get(found.span).is_some());
        }
    }

    #[test]
    fn any_words_are_a_formula_or_a_mistake_inside_them(
        words in prop::collection::vec(prop::sample::select(&[
            "1", "x", "+", "-", "*", "/", "^", "(", ")", ",", "<", "<=", "==", "and", "not", "sin(", "max(", "'a b'", "\"", "é", "=",
        ][..]), 0..20)
    ) {
        let text = words.join(" ");
        match text.parse::<Formula>() {
            Ok(formula) => prop_assert_eq!(formula.to_string().parse::<Formula>(), Ok(formula)),
            Err(found) => prop_assert!(text.get(found.span).is_some()),
        }
    }
}

/// Runs a function in a thread whose stack is as small as on some hosts.
fn in_a_small_thread(run: impl FnOnce() + Send + 'static) {
    let thread = std::thread::Builder::new().stack_size(256 << 10);
    thread.spawn(run).unwrap().join().unwrap();
}

#[test]
fn texts_of_any_length_and_depth_take_little_stack() {
    in_a_small_thread(|| {
        for part in [
            "1 + ",
            "x*",
            "-",
            "not ",
            "(",
            "1 - (",
            "2^",
            "2^-",
            "max(1, ",
            "sin(",
            "x < 1 and ",
            "'a b' + ",
        ] {
            for count in [1_000, 1_000_000] {
                let text = part.repeat(count) + "1";
                let found = text.parse::<Formula>().unwrap_err();
                assert_eq!(found.code, "formula-syntax", "{part}");
            }
        }
    });
}

#[test]
fn the_longest_and_the_deepest_formulas_take_little_stack() {
    let sum = "x + ".repeat(499) + "1";
    let deep = "(".repeat(64) + "x" + &")".repeat(64);
    let calls = "sin(".repeat(63) + "x" + &")".repeat(63);
    for text in [sum, deep, calls] {
        in_a_small_thread(move || {
            let formula: Formula = text.parse().unwrap();
            let again: Formula = formula.to_string().parse().unwrap();
            assert_eq!(again, formula.clone());
            assert!(formula.evaluate(|_| 0.25).is_finite());
            let count = formula.fold(&|_| 1, &|_| 1, &|_, parts: Vec<usize>| {
                parts.into_iter().sum()
            });
            assert!((1..=500).contains(&count));
        });
    }
}
