//! Random models for property tests.

use alloc::{format, string::String, vec::Vec};

use proptest::{collection::vec, option, prelude::*, sample::select};

use crate::{
    Engine,
    format::{blocks, words},
    model::*,
    rule::{self, Condition},
};

/// Generates numbers as authors write them, and arbitrary ones.
fn position() -> impl Strategy<Value = f64> {
    prop_oneof![3 => (-100..100i32).prop_map(|x| f64::from(x) / 10.0), 1 => -1e9..1e9f64, 1 => -1e-9..1e-9f64]
}

fn ascending<const N: usize>() -> impl Strategy<Value = [f64; N]> {
    proptest::array::uniform::<_, N>(position()).prop_map(|mut positions| {
        positions.sort_by(f64::total_cmp);
        positions
    })
}

fn width() -> impl Strategy<Value = f64> {
    prop_oneof![Just(1.0), 1e-6..1e6f64]
}

fn any_set() -> impl Strategy<Value = MembershipFunction> {
    let piecewise = (vec(position(), 1..5), vec(0.0..=1.0f64, 5)).prop_map(|(mut xs, degrees)| {
        xs.sort_by(f64::total_cmp);
        let points = xs.into_iter().zip(degrees).collect();
        MembershipFunction::Piecewise { points }
    });
    prop_oneof![
        ascending().prop_map(|[left, peak, right]| MembershipFunction::Triangle {
            left,
            peak,
            right
        }),
        ascending().prop_map(
            |[left, left_top, right_top, right]| MembershipFunction::Trapezoid {
                left,
                left_top,
                right_top,
                right
            }
        ),
        ascending().prop_map(|[top, foot]| MembershipFunction::LeftShoulder { top, foot }),
        ascending().prop_map(|[foot, top]| MembershipFunction::RightShoulder { foot, top }),
        (position(), width()).prop_map(|(mean, sd)| MembershipFunction::Gaussian { mean, sd }),
        (position(), width(), width()).prop_map(|(center, width, slope)| {
            MembershipFunction::Bell {
                center,
                width,
                slope,
            }
        }),
        (position(), position())
            .prop_map(|(inflection, slope)| MembershipFunction::Sigmoid { inflection, slope }),
        position().prop_map(|at| MembershipFunction::Singleton { at }),
        piecewise,
    ]
}

pub(super) fn any_text() -> impl Strategy<Value = String> {
    prop_oneof!["[a-z_]{1,8}", "\\PC{1,8}", "[ -~\\n]{1,6}"]
}

/// Generates a variable; some of its terms may be outside its range.
fn any_variable() -> impl Strategy<Value = Variable> {
    let terms = prop_oneof![
        vec(any_set().prop_map(Some), 1..4),
        (2..5usize).prop_map(|count| vec![None; count]),
    ];
    (
        ascending::<2>(),
        terms,
        option::of(any_text()),
        option::of(any_text()),
        0.1..=1.0f64,
        option::weighted(0.05, 0.3..=1.0f64),
    )
        .prop_map(|([low, high], shapes, unit, description, height, lower)| {
            let high = if low < high { high } else { low + 1.0 };
            let mut variable = Variable::new("x", low, high);
            let names: Vec<String> = (0..shapes.len()).map(|i| format!("t {i}")).collect();
            let sets: Option<Vec<MembershipFunction>> = shapes.iter().cloned().collect();
            match sets {
                Some(sets) => {
                    let terms = names
                        .into_iter()
                        .zip(sets)
                        .map(|(name, membership_function)| Term {
                            name,
                            lower: lower.map(|part| LowerFunction {
                                membership_function: membership_function.clone(),
                                height: part * height,
                            }),
                            membership_function,
                            height,
                        });
                    variable.terms = terms.collect();
                }
                None if names.len() > 2 && height == 1.0 => {
                    let count = (names.len() - 1) as f64;
                    let limit = |i| low + (high - low) * f64::from(i) / count;
                    let below = names.iter().map(String::as_str).zip((1..).map(limit));
                    let below: Vec<_> = below.take(names.len() - 1).collect();
                    variable = variable.steps(below, names.last().unwrap());
                }
                None => variable = variable.partition(names.iter().map(String::as_str)),
            }
            Variable {
                description,
                unit,
                ..variable
            }
        })
}

/// Generates finite numbers, near the usual ranges or arbitrary.
pub(super) fn any_finite() -> impl Strategy<Value = f64> {
    prop_oneof![3 => position(), 1 => any::<f64>().prop_filter("finite", |x| x.is_finite())]
}

fn any_operators() -> impl Strategy<Value = Operators> {
    let and = select(&words::CONJUNCTIONS[..]);
    let or = select(&words::DISJUNCTIONS[..]);
    let implication = select(&words::CONJUNCTIONS[..]);
    let aggregation = select(&words::AGGREGATIONS[..]);
    (and, or, implication, aggregation).prop_map(|words| Operators {
        and: words.0.1,
        or: words.1.1,
        implication: words.2.1,
        aggregation: words.3.1,
    })
}

fn any_activation() -> impl Strategy<Value = Activation> {
    let (count, strength) = (1..4u32, prop_oneof![Just(0.0), 0.0..=1.0f64]);
    (0..7u8, count, strength, select(&blocks::COMPARISONS[..])).prop_map(
        |(method, rules, at_least, (_, comparison))| match method {
            0 => Activation::General,
            1 => Activation::First { rules, at_least },
            2 => Activation::Last { rules, at_least },
            3 => Activation::Highest { rules },
            4 => Activation::Lowest { rules },
            5 => Activation::Proportional,
            _ => Activation::Threshold {
                comparison,
                strength: at_least,
            },
        },
    )
}

fn any_block() -> impl Strategy<Value = Block> {
    let operators = any_operators();
    (
        option::of(any_text()),
        prop::bool::weighted(0.8),
        operators,
        any_activation(),
    )
        .prop_map(|(description, enabled, operators, activation)| Block {
            description,
            enabled,
            and: operators.and,
            or: operators.or,
            activation,
            ..Block::new("")
        })
}

pub(super) fn any_model() -> impl Strategy<Value = Model> {
    let output = (any_variable(), select(&words::DEFUZZIFIERS[..]));
    let sampling = (2..10_000usize, any::<bool>());
    let rule = (
        0..4usize,
        0..4usize,
        0.0..=1.0f64,
        option::of(0.0..=1.0f64),
        option::of(any_text()),
    );
    (
        any_text(),
        vec(any_variable(), 1..4),
        (
            output,
            option::of(sampling),
            0..5u8,
            option::of(select(&words::AGGREGATIONS[..])),
            any::<bool>(),
        ),
        (
            any_operators(),
            any_activation(),
            prop_oneof![Just(MIN_STRENGTH), Just(1e-6)],
            vec(any_block(), 0..3),
        ),
        vec(rule, 1..5),
    )
        .prop_map(
            |(
                name,
                mut inputs,
                of_output,
                (operators, activation, least_strength, mut blocks),
                rules,
            )| {
                let (output, samples, otherwise, aggregation, clamp) = of_output;
                for (i, block) in blocks.iter_mut().enumerate() {
                    block.name = format!("block {i}");
                    block.implication = operators.implication;
                }
                for (i, input) in inputs.iter_mut().enumerate() {
                    input.name = format!("input {i}");
                }
                let (mut variable, (_, defuzzifier)) = output;
                variable.name = "the output".into();
                if defuzzifier == Defuzzifier::Tsukamoto {
                    for (i, term) in variable.terms.iter_mut().enumerate() {
                        let (foot, top) = (variable.low, variable.high);
                        term.membership_function = match i % 3 {
                            0 => MembershipFunction::RightShoulder { foot, top },
                            1 => MembershipFunction::ZShape {
                                top: foot,
                                foot: top,
                            },
                            _ => MembershipFunction::Sigmoid {
                                inflection: foot,
                                slope: -0.5,
                            },
                        };
                    }
                }
                if defuzzifier.takes_numbers() {
                    for (i, term) in variable.terms.iter_mut().enumerate() {
                        let constant = i as f64;
                        let coefficients = Vec::from([(inputs[0].name.clone(), 0.5)]);
                        let formula = "abs(\"input 0\")^0.5 - 2 * max(\"input 0\", 1)";
                        term.membership_function = match i % 4 {
                            0 => MembershipFunction::Constant { value: constant },
                            1 => MembershipFunction::Singleton { at: constant },
                            2 => MembershipFunction::Function {
                                formula: formula.parse().unwrap(),
                            },
                            _ => MembershipFunction::Linear {
                                coefficients,
                                constant,
                            },
                        };
                    }
                }
                let has_type2 = inputs
                    .iter()
                    .chain([&variable])
                    .any(Variable::has_type2_terms);
                let is_sum = defuzzifier == Defuzzifier::WeightedSum;
                let when_no_rule_fires = match otherwise {
                    0 => NoRuleFires::Undefined,
                    1 => NoRuleFires::Error,
                    2 => NoRuleFires::Previous(None),
                    3 => NoRuleFires::Previous(Some(variable.low)),
                    _ => NoRuleFires::Value(variable.low),
                };
                let (count, all) = (blocks.len(), rules.len());
                let term = |v: &Variable, i: usize| v.terms[i % v.terms.len()].name.clone();
                let rules = rules.into_iter().enumerate().map(
                    |(number, (input, i, weight, confidence, note))| {
                        let input = &inputs[input % inputs.len()];
                        let condition = Condition::is(&input.name, &term(input, i));
                        let rule = rule::Rule::new(condition, &variable.name, &term(&variable, i))
                            .with(weight);
                        let rejected = RejectedConsequent {
                            term: "other".into(),
                            degree: weight,
                            support: 3,
                        };
                        Rule {
                            rule,
                            block: number * count / all,
                            confidence,
                            support: confidence.map(|c| (c * 1e6) as u64),
                            against: confidence.map(|_| rejected).into_iter().collect(),
                            note,
                        }
                    },
                );
                let step = ProvenanceStep {
                    command: format!("command {name}"),
                    data: Vec::from([DataFile {
                        file: format!("{name}.csv"),
                        sha256: clamp.then(|| "0123".into()),
                    }]),
                    rows: clamp.then_some(3),
                    seed: Some(7),
                    loss: clamp.then(|| LossChange {
                        name: format!("of {name}"),
                        before: variable.high,
                        after: least_strength,
                    }),
                    rules: clamp.then_some([28, 9]),
                    moved: Vec::from([format!("{name} peak from 1 to 2")]),
                    note: clamp.then(|| format!("{name}: a note")),
                    result: Some("0123e4".into()),
                };
                Model {
                    rules: rules.collect(),
                    allow: match otherwise {
                        1 => vec![AllowedFinding {
                            finding: "jump".into(),
                            of: clamp.then(|| name.clone()),
                            because: "limits: of 'the' regulation".into(),
                        }],
                        _ => Vec::new(),
                    },
                    provenance: if otherwise == 0 {
                        Vec::from([step])
                    } else {
                        Vec::new()
                    },
                    name,
                    description: None,
                    inputs,
                    outputs: Vec::from([Output {
                        variable,
                        defuzzifier,
                        samples: samples.map(|(samples, midpoint)| Sampling {
                            samples,
                            rule: if midpoint {
                                SamplingRule::Midpoint
                            } else {
                                SamplingRule::Trapezoid
                            },
                        }),
                        when_no_rule_fires,
                        aggregation: aggregation.map(|(_, aggregation)| aggregation),
                        clamp,
                        type_reduction: match has_type2 && !is_sum {
                            true => {
                                TypeReduction::ALL[otherwise as usize % TypeReduction::ALL.len()]
                            }
                            false => TypeReduction::Exact,
                        },
                    }]),
                    operators,
                    activation,
                    least_strength,
                    blocks,
                }
            },
        )
}

/// Generates valid models.
pub(super) fn valid_model() -> impl Strategy<Value = Model> {
    any_model().prop_filter("compiles", |model| Engine::new(model).is_ok())
}
