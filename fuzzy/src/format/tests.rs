use alloc::{string::String, vec::Vec};

use proptest::{collection::vec, option, prelude::*, sample::select};

mod models;

use super::*;
use crate::{
    Engine,
    engine::State,
    model::{
        Activation, Block, Comparison, Defuzzifier, Implication, MembershipFunction, NoRuleFires,
        Output, RejectedConsequent, Rule, Sampling, SamplingRule, Variable,
    },
    rule::{self, Condition, DEEPEST_NESTING, Hedge},
};
use models::*;

fn first_rule(model: &mut Model) -> &mut rule::Rule {
    &mut model.rules[0].rule
}

fn with_condition(model: &mut Model, condition: Condition) {
    first_rule(model).condition = condition;
}

/// Moves all rules into one block.
fn in_block(model: &mut Model) -> &mut Block {
    for rule in &mut model.rules {
        rule.block = 0;
    }
    model.blocks = Vec::from([Block::new("only")]);
    &mut model.blocks[0]
}

/// A finding's code, and a change to a model that causes it.
type Mistake = (&'static str, fn(&mut Model));

/// All ways to invalidate a model, with the code of the expected finding.
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
        let rejected = RejectedConsequent {
            term: "other".into(),
            degree: -0.5,
            support: 1,
        };
        m.rules[0].against = Vec::from([rejected]);
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
        // The rules of a disabled block do not read anything.
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

    /// Every model that compiles can be written and read, and every model that is read without errors compiles, unless
    /// it has no rules yet.
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

    /// Each error is reported when compiling and when reading; reading also reports its position in the text.
    #[test]
    fn every_mistake_is_reported_with_its_position(model in valid_model(), (code, make) in select(&MISTAKES[..])) {
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

    /// Every model that compiles yields an outcome: a value in the output's range, or the information that no rule
    /// fires, but never an arbitrary number.
    #[test]
    fn a_model_that_compiles_evaluates_every_finite_input(
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
                (State::Interval { low, high }, _) => {
                    let within = variable.low <= low && high <= variable.high;
                    prop_assert!(within || (defuzzifier.is_weighted() && (low + high).is_finite()));
                    prop_assert!(low <= high, "{low} {high}");
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
    /// The crate of the YAML organisation reads the same model from text that this crate wrote, and this crate reads
    /// the same model from text that the other one wrote.
    #[test]
    fn generated_rule_sets_mean_the_same_to_another_yaml_reader(model in valid_model()) {
        let ours = crate::yaml::to_string(&model);
        let read = serde_yaml::from_str::<Model>(&ours);
        prop_assert_eq!(read.as_ref().ok(), Some(&model), "{}\n{:?}", ours, read);
        // If a text consists only of line breaks, that crate writes it as a block, which our YAML library reads as an
        // empty text.
        let outputs = model.outputs.iter().map(|output| &output.variable);
        let texts = model.inputs.iter().chain(outputs).flat_map(|v| [&v.unit, &v.description]);
        let texts = texts.chain(model.rules.iter().map(|rule| &rule.note));
        let texts = texts.chain(model.blocks.iter().map(|block| &block.description)).flatten();
        // The two libraries fold the line separators of YAML 1.1 differently.
        let separators = ['\u{85}', '\u{2028}', '\u{2029}'];
        let is_alike = |text: &String| !text.trim_matches('\n').is_empty() && !text.contains(separators);
        prop_assume!(texts.chain([&model.name]).all(is_alike));
        let theirs = serde_yaml::to_string(&model).unwrap();
        let read = theirs.parse::<Model>();
        prop_assert_eq!(read.as_ref(), Ok(&model), "{}", theirs);
    }
}

#[test]
fn words_of_other_programs_give_suggestions() {
    fn words<T>(table: &[(&'static str, T)]) -> Vec<&'static str> {
        table.iter().map(|(word, _)| *word).collect()
    }
    let shapes = crate::model::MembershipFunction::FORMS.iter();
    let known: Vec<&str> = [
        shapes.clone().map(|form| form.name).collect(),
        shapes.flat_map(|form| form.names()).collect(),
        words(&super::words::CONJUNCTIONS),
        words(&super::words::DISJUNCTIONS),
        words(&super::words::AGGREGATIONS),
        words(&super::words::DEFUZZIFIERS),
        super::variables::OUTPUT_KEYS.to_vec(),
        crate::rule::Hedge::ALL
            .map(crate::rule::Hedge::word)
            .to_vec(),
        super::allow::KEYS.to_vec(),
        super::provenance::KEYS.to_vec(),
        Vec::from([
            "piecewise",
            "and",
            "or",
            "implication",
            "aggregation",
            "fuzzy",
            "upper",
            "lower",
        ]),
        // Profiles use the same table of words.
        Vec::from(["flagred", "mean", "std", "if_missing"]),
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

#[test]
fn provenance_is_read_and_written() {
    let text = "\
fuzzy: 1
name: fan
inputs:
  heat: {range: [0, 9], partition: [low, high]}
outputs:
  speed: {range: [0, 9], partition: [slow, fast], defuzzifier: centroid, when_no_rule_fires: undefined}
operators:
  and: minimum
  or: maximum
  implication: minimum
  aggregation: maximum
rules:
  - IF heat IS low THEN speed IS slow
provenance:
  - {command: by hand}
  -
    command: tune
    data: [{file: rows.csv, sha256: ab12}, {file: \"-\"}]
    rows: 61
    seed: 7
    loss: {name: RMS error, before: 3, after: 2.5}
    rules: [28, 9]
    moved: [heat.low peak from 0 to 1]
    note: \"why, and how\"
    result: \"0123\"
";
    let document = crate::yaml::parse(text).unwrap();
    let steps = &document.model.provenance;
    assert_eq!(steps[0].command, "by hand");
    assert_eq!(steps[1].result.as_deref(), Some("0123"));
    assert_eq!(&text[document.spans.provenance.clone()], "provenance");
    assert_eq!(crate::yaml::to_string(&document.model), text);
    let wrong = text
        .replace("command: by hand", "comand: by hand")
        .replace("[28, 9]", "[28]")
        .replace("before: 3", "before: low");
    insta::assert_snapshot!(crate::yaml::parse(&wrong).unwrap_err().to_string(), @r"
    15:6: error[unknown-key]: unknown key `comand` in step 1 of the provenance
      help: did you mean `command`?
    21:37: error[wrong-type]: expected a number for `before` of the loss of step 2 of the provenance, found `low`
      help: write a number
    22:12: error[wrong-type]: expected two numbers for `rules` of step 2 of the provenance, found a list
      help: write how many there were before and after: `[28, 9]`
    ");
}
