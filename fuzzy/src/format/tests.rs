use alloc::{format, string::String, vec::Vec};

use proptest::{collection::vec, option, prelude::*, sample::select};

use super::*;
use crate::{
    Engine,
    engine::State,
    model::{
        Activation, Beaten, Block, Comparison, Defuzzifier, Implication, LEAST_STRENGTH,
        MembershipFunction, NoRuleFires, Operators, Output, Rule, Sampling, SamplingRule, Term,
        Variable,
    },
    rule::{self, Condition, DEEPEST_NESTING, Hedge},
};

/// Numbers as authors write them, and any others.
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

fn any_text() -> impl Strategy<Value = String> {
    prop_oneof!["[a-z_]{1,8}", "\\PC{1,8}", "[ -~\\n]{1,6}"]
}

/// A variable, some of whose terms may lie outside its range.
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
    )
        .prop_map(|([low, high], shapes, unit, description, height)| {
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
                            membership_function,
                            height,
                        });
                    variable.terms = terms.collect();
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

/// A finite number, near the ranges that variables have or anywhere.
fn any_finite() -> impl Strategy<Value = f64> {
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

fn any_model() -> impl Strategy<Value = Model> {
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
            prop_oneof![Just(LEAST_STRENGTH), Just(1e-6)],
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
                        let beaten = Beaten {
                            term: "other".into(),
                            degree: weight,
                            support: 3,
                        };
                        Rule {
                            rule,
                            block: number * count / all,
                            confidence,
                            support: confidence.map(|c| (c * 1e6) as u64),
                            against: confidence.map(|_| beaten).into_iter().collect(),
                            note,
                        }
                    },
                );
                Model {
                    rules: rules.collect(),
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
                    }]),
                    operators,
                    activation,
                    least_strength,
                    blocks,
                }
            },
        )
}

/// Models that mean something.
fn valid_model() -> impl Strategy<Value = Model> {
    any_model().prop_filter("compiles", |model| Engine::new(model).is_ok())
}

fn first_rule(model: &mut Model) -> &mut rule::Rule {
    &mut model.rules[0].rule
}

fn with_condition(model: &mut Model, condition: Condition) {
    first_rule(model).condition = condition;
}

/// All rules in one block.
fn in_block(model: &mut Model) -> &mut Block {
    for rule in &mut model.rules {
        rule.block = 0;
    }
    model.blocks = Vec::from([Block::new("only")]);
    &mut model.blocks[0]
}

/// A code, and what makes a model deserve it.
type Mistake = (&'static str, fn(&mut Model));

/// Every way to break a model, and the code of what is wrong then.
const MISTAKES: [Mistake; 39] = [
    ("value-outside-range", |m| m.least_strength = 0.0),
    ("value-outside-range", |m| {
        m.activation = Activation::First {
            rules: 1,
            at_least: 1.5,
        };
    }),
    ("empty-name", |m| in_block(m).name.clear()),
    ("value-outside-range", |m| {
        in_block(m).activation = Activation::Threshold {
            comparison: Comparison::Above,
            strength: -1.0,
        };
    }),
    ("duplicate-block", |m| {
        let again = in_block(m).clone();
        m.blocks.push(again);
    }),
    ("different-implications", |m| {
        m.outputs[0] =
            Output::new(Variable::new("the output", 0.0, 1.0).partition(["low", "high"]));
        let rule = rule::Rule::new(m.rules[0].rule.condition.clone(), "the output", "low");
        m.rules = Vec::from([Rule::from(rule.clone()), Rule::from(rule)]);
        m.rules[1].block = 1;
        let other = Block {
            implication: Implication::Product,
            ..Block::new("other")
        };
        m.blocks = Vec::from([Block::new("one"), other]);
    }),
    ("missing-key", |m| m.outputs.clear()),
    ("missing-key", |m| m.outputs[0].variable.terms.clear()),
    ("empty-name", |m| m.inputs[0].name.clear()),
    ("empty-name", |m| m.inputs[0].terms[0].name.clear()),
    ("duplicate-variable", |m| m.inputs.push(m.inputs[0].clone())),
    ("duplicate-variable", |m| {
        m.inputs[0].name = m.outputs[0].variable.name.clone()
    }),
    ("duplicate-term", |m| {
        let again = m.inputs[0].terms[0].clone();
        m.inputs[0].terms.push(again);
    }),
    ("wrong-range", |m| m.inputs[0].low = f64::INFINITY),
    ("wrong-range", |m| m.inputs[0].high = m.inputs[0].low),
    ("wrong-range", |m| {
        (m.inputs[0].low, m.inputs[0].high) = (-1e308, 1e308)
    }),
    ("wrong-parameter", |m| m.inputs[0].terms[0].height = 0.0),
    ("wrong-parameter", |m| {
        m.inputs[0].terms[0].height = f64::NAN
    }),
    ("wrong-parameter", |m| {
        m.inputs[0].terms[0].membership_function = MembershipFunction::Triangle {
            left: 0.0,
            peak: 2.0,
            right: 1.0,
        };
    }),
    ("wrong-parameter", |m| {
        m.inputs[0].terms[0].membership_function =
            MembershipFunction::Gaussian { mean: 0.0, sd: 0.0 };
    }),
    ("wrong-parameter", |m| {
        m.inputs[0].terms[0].membership_function =
            MembershipFunction::Piecewise { points: Vec::new() }
    }),
    ("wrong-parameter", |m| {
        let samples = Sampling {
            samples: 1,
            rule: SamplingRule::Midpoint,
        };
        m.outputs[0].samples = Some(samples);
    }),
    ("wrong-parameter", |m| {
        let samples = Sampling {
            samples: 10_000_001,
            rule: SamplingRule::Trapezoid,
        };
        m.outputs[0].samples = Some(samples);
    }),
    ("value-outside-range", |m| {
        m.outputs[0].when_no_rule_fires = NoRuleFires::Value(m.outputs[0].variable.high + 1e9);
    }),
    ("value-outside-range", |m| m.rules[0].confidence = Some(1.5)),
    ("value-outside-range", |m| {
        let beaten = Beaten {
            term: "other".into(),
            degree: -0.5,
            support: 1,
        };
        m.rules[0].against = Vec::from([beaten]);
    }),
    ("wrong-term", |m| {
        let coefficients = Vec::new();
        m.inputs[0].terms[0].membership_function = MembershipFunction::Linear {
            coefficients,
            constant: 1.0,
        };
    }),
    ("wrong-term", |m| {
        m.outputs[0].defuzzifier = Defuzzifier::Bisector;
        m.outputs[0].variable.terms[0].membership_function = MembershipFunction::Singleton {
            at: m.outputs[0].variable.low,
        };
    }),
    ("wrong-term", |m| {
        m.outputs[0].defuzzifier = Defuzzifier::WeightedSum;
        m.outputs[0].variable.terms[0].membership_function =
            MembershipFunction::Gaussian { mean: 0.0, sd: 1.0 };
    }),
    ("unknown-variable", |m| {
        m.outputs[0].defuzzifier = Defuzzifier::WeightedSum;
        let coefficients = Vec::from([("nothing".into(), 1.0)]);
        m.outputs[0].variable.terms[0].membership_function = MembershipFunction::Linear {
            coefficients,
            constant: 1.0,
        };
    }),
    ("term-outside-range", |m| {
        m.outputs[0].defuzzifier = Defuzzifier::Bisector;
        for term in &mut m.outputs[0].variable.terms {
            term.membership_function = MembershipFunction::Rectangle {
                left: 2e9,
                right: 3e9,
            };
        }
    }),
    ("unknown-variable", |m| {
        with_condition(m, Condition::is("nothing", "t 0"))
    }),
    ("unknown-term", |m| {
        with_condition(m, Condition::is(&m.inputs[0].name.clone(), "nothing"))
    }),
    ("circular-outputs", |m| {
        // The rules of a disabled block read nothing.
        m.blocks.iter_mut().for_each(|block| block.enabled = true);
        with_condition(m, Condition::is("the output", "t 0"))
    }),
    ("output-in-condition", |m| {
        let mut number = Variable::new("a number", 0.0, 1.0);
        number = number.term("one", MembershipFunction::Constant { value: 1.0 });
        let mut output = Output::new(number);
        output.defuzzifier = Defuzzifier::WeightedSum;
        m.outputs.push(output);
        with_condition(m, Condition::is("a number", "one"));
    }),
    ("missing-term", |m| {
        let condition = Condition::is_hedged(&m.inputs[0].name, &[Hedge::Any, Hedge::Very], "");
        let Condition::Is(mut proposition) = condition else {
            return;
        };
        proposition.term = None;
        with_condition(m, Condition::Is(proposition));
    }),
    ("empty-rule", |m| {
        with_condition(m, Condition::And(Vec::new()))
    }),
    ("weight-outside-range", |m| first_rule(m).weight = f64::NAN),
    ("rule-too-deep", |m| {
        let nested =
            (0..=DEEPEST_NESTING).fold(Condition::is("input 0", "t 0"), |c, _| c.negated());
        with_condition(m, nested);
    }),
];

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]
    #[test]
    fn a_saved_model_loads_as_itself(model in valid_model()) {
        let by_tree = read(&write(&model)).map_err(Findings);
        prop_assert_eq!(&by_tree.unwrap().model, &model);
        let by_json = serde_json::from_value::<Model>(serde_json::to_value(&model).unwrap());
        prop_assert_eq!(&by_json.unwrap(), &model);
        let text = crate::yaml::to_string(&model);
        prop_assert_eq!(&crate::yaml::parse(&text).unwrap().model, &model, "{}", text);
    }

    /// What compiles can be written and read, and what reads without error compiles, unless it has no rules yet.
    #[test]
    fn reading_and_compiling_refuse_the_same_models(
        model in any_model(),
        mistake in option::of(select(&MISTAKES[..])),
        without_rules in proptest::bool::weighted(0.1),
    ) {
        let mut model = model;
        if let Some((_, make)) = mistake {
            make(&mut model);
        }
        if without_rules {
            model.rules.clear();
        }
        let compiled = Engine::new(&model).map_err(|findings| findings.to_string());
        let text = crate::yaml::to_string(&model);
        let read = crate::yaml::parse(&text).map_err(|findings| findings.to_string());
        match (compiled, read) {
            (Ok(engine), Ok(document)) => prop_assert_eq!(engine.model(), &document.model),
            (Err(_), Err(_)) => {}
            (Err(why), Ok(_)) if model.rules.is_empty() => {
                prop_assert!(why.starts_with("error[no-rules]") && !why.contains("\nerror"), "{}", why);
            }
            (Ok(_), Err(why)) => prop_assert!(false, "compiles, but {}\n{}", why, text),
            (Err(why), Ok(_)) => prop_assert!(false, "reads, but {}\n{}", why, text),
        }
    }

    /// Each mistake is found by compiling and by reading; reading marks it in the text.
    #[test]
    fn every_mistake_is_found_with_its_position(model in valid_model(), (code, make) in select(&MISTAKES[..])) {
        let mut model = model;
        make(&mut model);
        let compiled = Engine::new(&model).unwrap_err();
        prop_assert!(compiled.0.iter().any(|finding| finding.code == code), "{}", compiled);
        let text = crate::yaml::to_string(&model);
        let findings = crate::yaml::parse(&text).unwrap_err();
        for finding in &findings.0 {
            prop_assert!(finding.position.is_some() && !finding.span.is_empty(), "{}\n{}", finding, text);
        }
    }

    /// Whatever compiles answers: a value in the output's range, or that no rule fires, never a silent number.
    #[test]
    fn a_model_that_compiles_answers_every_finite_input(
        model in valid_model(),
        points in vec(vec(any_finite(), 3), 8),
    ) {
        let engine = Engine::new(&model).unwrap();
        let Output { variable, when_no_rule_fires, defuzzifier, .. } = &model.outputs[0];
        for point in &points {
            let outcome = match engine.evaluate(&point[..model.inputs.len()]) {
                Ok(outcomes) => outcomes[0],
                Err(_) => {
                    prop_assert_eq!(*when_no_rule_fires, NoRuleFires::Error);
                    continue;
                }
            };
            match (outcome.state, when_no_rule_fires) {
                (State::Defined(value), _) => {
                    let within = (variable.low..=variable.high).contains(&value);
                    prop_assert!(within || (defuzzifier.is_weighted() && value.is_finite()), "{value}");
                    prop_assert!(outcome.coverage > 0.0);
                }
                (State::NoRuleFired, NoRuleFires::Undefined | NoRuleFires::Previous(None)) => {}
                (
                    State::Default(value),
                    NoRuleFires::Value(written) | NoRuleFires::Previous(Some(written)),
                ) => prop_assert_eq!(value, *written),
                (state, _) => prop_assert!(false, "{:?} at {:?}", state, point),
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]
    /// What we write means the same to the YAML organisation's crate, and what it writes to us.
    #[test]
    fn generated_rule_sets_mean_the_same_to_another_reader(model in valid_model()) {
        let ours = crate::yaml::to_string(&model);
        let read = serde_yaml::from_str::<Model>(&ours);
        prop_assert_eq!(read.as_ref().ok(), Some(&model), "{}\n{:?}", ours, read);
        // They write text of line breaks alone as a block that our YAML library takes for empty.
        let outputs = model.outputs.iter().map(|output| &output.variable);
        let texts = model.inputs.iter().chain(outputs).flat_map(|v| [&v.unit, &v.description]);
        let texts = texts.chain(model.rules.iter().map(|rule| &rule.note));
        let texts = texts.chain(model.blocks.iter().map(|block| &block.description)).flatten();
        // The two fold the line separators of YAML 1.1 in different ways.
        let separators = ['\u{85}', '\u{2028}', '\u{2029}'];
        let is_alike = |text: &String| !text.trim_matches('\n').is_empty() && !text.contains(separators);
        prop_assume!(texts.chain([&model.name]).all(is_alike));
        let theirs = serde_yaml::to_string(&model).unwrap();
        let read = theirs.parse::<Model>();
        prop_assert_eq!(read.as_ref(), Ok(&model), "{}", theirs);
    }
}

#[test]
fn another_programs_word_is_answered_with_one_of_this_format() {
    fn words<T>(table: &[(&'static str, T)]) -> Vec<&'static str> {
        table.iter().map(|(word, _)| *word).collect()
    }
    let shapes = crate::model::MembershipFunction::FORMS.iter();
    let known: Vec<&str> = [
        shapes.map(|form| form.name).collect(),
        words(&super::words::CONJUNCTIONS),
        words(&super::words::DISJUNCTIONS),
        words(&super::words::AGGREGATIONS),
        words(&super::words::DEFUZZIFIERS),
        super::variables::OUTPUT_KEYS.to_vec(),
        crate::rule::Hedge::ALL
            .map(crate::rule::Hedge::word)
            .to_vec(),
        Vec::from(["piecewise", "and", "or", "implication", "aggregation"]),
    ]
    .concat();
    for (word, meanings) in crate::foreign::WORDS {
        for meaning in *meanings {
            assert!(known.contains(meaning), "{word}: {meaning}");
        }
    }
}

#[test]
fn a_rule_set_that_is_being_built_may_lack_outputs_and_rules() {
    let read = |text: &str| super::read_unfinished(&crate::yaml::read(text).unwrap());
    let begun = "{fuzzy: 1, name: fan, inputs: {heat: {range: [0, 40], partition: [low, high]}}, outputs: {}, rules: []}";
    assert_eq!(read(begun).unwrap().model.inputs.len(), 1);
    let wrong = read(&begun.replace("[0, 40]", "[40, 0]")).unwrap_err();
    assert_eq!(wrong.len(), 1, "{wrong:?}");
    assert!(crate::yaml::parse(begun).is_err());
}
