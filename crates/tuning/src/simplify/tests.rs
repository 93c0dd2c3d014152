use proptest::prelude::*;

use super::*;

fn parse(text: &str) -> Model {
    fuzzy::yaml::parse(text).unwrap().model
}

fn simplified(model: &Model) -> SimplifyResult {
    simplify(model, &[], &SimplifySettings::default()).unwrap()
}

fn within(model: &Model, tolerance: f64) -> SimplifyResult {
    let settings = SimplifySettings {
        tolerance: Some(tolerance),
        ..SimplifySettings::default()
    };
    simplify(model, &[], &settings).unwrap()
}

fn rules(model: &Model) -> Vec<String> {
    let rules = model.rules.iter();
    rules.map(|rule| rule.rule.to_string()).collect()
}

/// A rule set with two inputs of three terms. `consequents` lists the output term for each combination, row by row; `-`
/// means no rule.
fn table(operators: &str, consequents: &str) -> Model {
    let names = ["low", "middle", "high"];
    let mut text = format!(
        "
fuzzy: 1
name: table
inputs:
  heat: {{range: [0, 10], partition: [low, middle, high]}}
  damp: {{range: [0, 10], partition: [low, middle, high]}}
outputs:
  speed: {{range: [0, 30], partition: [slow, even, fast]}}
operators: {{{operators}}}
rules:
"
    );
    for (i, consequent) in consequents.split_whitespace().enumerate() {
        if consequent != "-" {
            let (heat, damp) = (names[i / 3], names[i % 3]);
            text +=
                &format!("  - IF heat IS {heat} AND damp IS {damp} THEN speed IS {consequent}\n");
        }
    }
    parse(&text)
}

const SUMS: &str = "and: product, implication: product, aggregation: sum";

/// A rule set of 28 learned rules for the risk of a multirotor. Its inputs are the current and the recent unsteadiness
/// of the motors, their load, and the share of time at a limit.
fn risk() -> Model {
    let mut text = String::from(
        "
fuzzy: 1
name: risk
inputs:
  now: {range: [0, 0.5], partition: {calm: 0, shaken: 0.025, violent: 0.05}}
  lately: {range: [0, 0.5], partition: {calm: 0, gusty: 0.025, stormy: 0.05}}
  load: {range: [0, 1], partition: {light: 0.3, medium: 0.6, heavy: 0.9}}
  at_limit: {range: [0, 1], partition: {none: 0, much: 0.5}}
outputs:
  risk:
    range: [0, 100]
    terms:
      very_low: {triangle: [0, 5, 10]}
      low: {triangle: [20, 25, 30]}
      medium: {triangle: [45, 50, 55]}
      high: {triangle: [70, 75, 80]}
      very_high: {triangle: [90, 95, 100]}
operators: {and: product, implication: product, aggregation: sum}
rules:
  - IF at_limit IS much THEN risk IS very_high
",
    );
    let consequents = [
        ("calm", "calm", ["very_low", "very_low", "low"]),
        ("calm", "gusty", ["low", "medium", "medium"]),
        ("calm", "stormy", ["low", "medium", "medium"]),
        ("shaken", "calm", ["medium", "high", "high"]),
        ("shaken", "gusty", ["medium", "high", "high"]),
        ("shaken", "stormy", ["very_high"; 3]),
        ("violent", "calm", ["very_high"; 3]),
        ("violent", "gusty", ["very_high"; 3]),
        ("violent", "stormy", ["very_high"; 3]),
    ];
    for (now, lately, of_load) in consequents {
        for (load, risk) in ["light", "medium", "heavy"].into_iter().zip(of_load) {
            text += &format!(
                "  - IF now IS {now} AND lately IS {lately} AND load IS {load} AND at_limit IS none THEN risk IS {risk}\n"
            );
        }
    }
    parse(&text)
}

#[test]
fn twenty_eight_rules_become_nine_with_the_same_outputs() {
    let found = simplified(&risk());
    insta::assert_snapshot!(rules(&found.model).join("\n"), @r"
    IF at_limit IS much THEN risk IS very_high
    IF now IS calm AND lately IS calm AND load IS NOT heavy AND at_limit IS none THEN risk IS very_low
    IF now IS calm AND lately IS calm AND load IS heavy AND at_limit IS none THEN risk IS low
    IF now IS calm AND lately IS NOT calm AND load IS light AND at_limit IS none THEN risk IS low
    IF now IS calm AND lately IS NOT calm AND load IS NOT light AND at_limit IS none THEN risk IS medium
    IF now IS shaken AND lately IS NOT stormy AND load IS light AND at_limit IS none THEN risk IS medium
    IF now IS shaken AND lately IS NOT stormy AND load IS NOT light AND at_limit IS none THEN risk IS high
    IF now IS shaken AND lately IS stormy AND at_limit IS none THEN risk IS very_high
    IF now IS violent AND at_limit IS none THEN risk IS very_high
    ");
    assert_eq!(found.rules[8], (19..28).collect::<Vec<usize>>());
    assert!(found.dropped.is_empty() && found.inputs.is_empty());
    let difference = found.difference.unwrap();
    assert!((difference.before - difference.after).abs() <= 1e-10);
    let coarse = within(&risk(), 25.0);
    assert!(coarse.rules.len() < 9, "{:?}", rules(&coarse.model));
    let difference = coarse.difference.unwrap();
    assert!((1.0..=25.0).contains(&(difference.before - difference.after).abs()));
}

#[test]
fn adjacent_terms_become_an_or_with_a_suitable_disjunction() {
    let mut text = String::from(
        "
fuzzy: 1
name: five
inputs:
  x: {range: [0, 8], partition: [a, b, c, d, e]}
  z: {range: [0, 1], partition: [low, high]}
outputs: {y: {range: [0, 9], terms: {low: {singleton: 1}, middle: {singleton: 3}, high: {singleton: 8}}}}
operators: {and: product, implication: product, aggregation: sum}
rules:
",
    );
    for (x, y) in ["a", "b", "c", "d", "e"]
        .into_iter()
        .zip(["low", "low", "low", "high", "high"])
    {
        text += &format!("  - IF x IS {x} AND z IS low THEN y IS {y}\n");
        text += &format!("  - IF x IS {x} AND z IS high THEN y IS middle\n");
    }
    let found = simplified(&parse(&text)).model;
    assert_eq!(found.operators.or, Disjunction::BoundedSum);
    insta::assert_snapshot!(rules(&found).join("\n"), @r"
    IF (x IS a OR x IS b OR x IS c) AND z IS low THEN y IS low
    IF z IS high THEN y IS middle
    IF (x IS d OR x IS e) AND z IS low THEN y IS high
    ");
}

#[test]
fn adjacent_terms_become_an_or_with_maximum() {
    let found = simplified(&table("", "slow slow slow even even fast even even fast")).model;
    assert_eq!(found.operators.or, Disjunction::Maximum);
    insta::assert_snapshot!(rules(&found).join("\n"), @r"
    IF heat IS low AND (damp IS low OR damp IS middle OR damp IS high) THEN speed IS slow
    IF heat IS NOT low AND damp IS low THEN speed IS even
    IF (heat IS middle OR heat IS high) AND damp IS middle THEN speed IS even
    IF (heat IS middle OR heat IS high) AND damp IS high THEN speed IS fast
    ");
}

#[test]
fn duplicate_and_redundant_rules_are_dropped() {
    let mut model = table("", "slow - - - even - - - fast");
    let wider: fuzzy::rule::Rule = "IF heat IS high THEN speed IS fast".parse().unwrap();
    let like = |rule: fuzzy::rule::Rule| fuzzy::model::Rule {
        rule,
        ..model.rules[0].clone()
    };
    let more = [like(wider), like(model.rules[1].rule.clone())];
    model.rules.extend(more);
    let found = simplified(&model);
    assert_eq!(found.rules, [[0], [1], [3]]);
    assert_eq!(found.dropped, [2, 4]);
}

#[test]
fn simplification_keeps_gaps() {
    let model = table(SUMS, "slow slow - slow slow slow slow slow slow");
    let found = simplified(&model).model;
    let engine = Engine::new(&found).unwrap();
    assert_eq!(engine.evaluate(&[0.0, 10.0]).unwrap()[0].value(), None);
    assert!(found.rules.len() < 8);
}

#[test]
fn an_input_that_changes_little_is_dropped_within_a_tolerance() {
    let model = parse(
        "
fuzzy: 1
name: fan
inputs:
  heat: {range: [0, 10], partition: [low, high]}
  damp: {range: [0, 10], partition: [low, high]}
outputs:
  speed: {range: [0, 30], terms: {slow: {singleton: 3}, slower: {singleton: 2}, fast: {singleton: 20}}}
operators: {and: product, implication: product, aggregation: sum}
rules:
  - {rule: IF heat IS low AND damp IS low THEN speed IS slow, support: 30, note: many}
  - {rule: IF heat IS low AND damp IS high THEN speed IS slower, support: 10, note: few}
  - IF heat IS high THEN speed IS fast
",
    );
    assert_eq!(simplified(&model).model.rules.len(), 3);
    let found = within(&model, 1.0);
    assert_eq!(found.inputs, ["damp"]);
    assert_eq!(found.model.rules[0].support, Some(40));
    assert_eq!(found.model.rules[0].note.as_deref(), Some("many; few"));
    let difference = found.difference.unwrap();
    assert_eq!((difference.before - difference.after).abs(), 1.0);
    assert_eq!(difference.inputs.len(), 2);
}

#[test]
fn comparing_only_at_rows_allows_more_changes() {
    let model = table(SUMS, "slow slow slow even even even fast fast fast");
    let settings = SimplifySettings {
        rows_only: true,
        ..SimplifySettings::default()
    };
    // `warm` never has a degree above 0.5.
    let heat: Vec<f64> = (0..20).map(|i| f64::from(i) / 5.0).collect();
    let found = simplify(&model, &[heat.clone(), vec![1.0; 20]], &settings).unwrap();
    assert_eq!(found.points, 20);
    assert_eq!(found.model.rules.len(), 2);
    assert_eq!(found.dropped, [6, 7, 8]);
    assert_eq!(simplify(&model, &[], &settings), Err(SimplifyError::NoRows));
    assert_eq!(
        simplify(&model, &[heat], &settings),
        Err(SimplifyError::Columns)
    );
}

#[test]
fn first_match_rule_lists_keep_their_meaning() {
    let model = parse(
        "
fuzzy: 1
name: lamp
inputs: {heat: {range: [0, 40], partition: [low, middle, high]}}
outputs: {lamp: {range: [0, 1], terms: {off: {singleton: 0}, on: {singleton: 1}}}}
activation: {first: 1}
rules:
  - IF heat IS high THEN lamp IS on
  - IF heat IS high THEN lamp IS off
  - IF heat IS low THEN lamp IS off
  - IF heat IS middle THEN lamp IS off
",
    );
    let found = simplified(&model);
    assert_eq!(
        rules(&found.model),
        [
            "IF heat IS high THEN lamp IS on",
            "IF heat IS any THEN lamp IS off"
        ]
    );
    agree(&model, &found.model, 1);
}

#[test]
fn wrong_settings_and_models_are_errors() {
    let error = |tolerance: f64| {
        let settings = SimplifySettings {
            tolerance: Some(tolerance),
            ..SimplifySettings::default()
        };
        simplify(&table("", "slow"), &[], &settings)
            .unwrap_err()
            .to_string()
    };
    assert_eq!(error(-1.0), "the tolerance is -1; it must be at least 0");
    assert_eq!(
        error(f64::NAN),
        "the tolerance is NaN; it must be at least 0"
    );
    let settings = SimplifySettings::default();
    let mut none = table("", "slow");
    none.rules.clear();
    let none = simplify(&none, &[], &settings);
    assert!(matches!(none, Err(SimplifyError::Compile(_))), "{none:?}");
}

/// A model with up to three inputs: a table of rules with few different consequents. Some rules are missing,
/// duplicated, weighted, or have another form.
fn random_model(seed: u64) -> Model {
    let mut random = fastrand::Rng::with_seed(seed);
    let mut one_of = |words: &[&'static str]| *random.choice(words).unwrap();
    let and = one_of(&["minimum", "product"]);
    let aggregation = one_of(&["maximum", "sum", "probabilistic_sum"]);
    let or = one_of(&["maximum", "bounded_sum", "probabilistic_sum"]);
    let (output, implication) = match one_of(&["sets", "numbers"]) {
        "sets" => (
            "terms: {a: {triangle: [0, 2, 4]}, b: {triangle: [3, 5, 7]}, c: {triangle: [6, 8, 10]}}",
            one_of(&["minimum", "product"]),
        ),
        _ => (
            "defuzzifier: weighted_average, terms: {a: {constant: 1}, b: {constant: 5}, c: {linear: {x0: 2, constant: 1}}}",
            "product",
        ),
    };
    let mut text = format!(
        "fuzzy: 1\nname: random\noperators: {{and: {and}, or: {or}, implication: {implication}, aggregation: {aggregation}}}\ninputs:\n"
    );
    let mut tables: Vec<String> = vec![String::new()];
    for input in 0..random.usize(1..=3) {
        let partitions = [
            "[t0, t1]",
            "[t0, t1, t2]",
            "{t0: 1, t1: 2, t2: 9}",
            "[t0, t1, t2, t3]",
        ];
        let gaps = "{t0: {triangle: [0, 2, 4]}, t1: {gaussian: {mean: 5, sd: 1}}, t2: {triangle: [5, 7, 9]}}";
        let (key, terms) = match random.u8(..5) {
            _ if input == 2 => ("partition", partitions[0]),
            0 => ("terms", gaps),
            _ => ("partition", random.choice(partitions).unwrap()),
        };
        text += &format!("  x{input}: {{range: [0, 10], {key}: {terms}}}\n");
        let terms = if key == "terms" {
            3
        } else {
            terms.matches('t').count()
        };
        tables = tables
            .iter()
            .flat_map(|table| {
                (0..terms).map(move |term| format!("{table} AND x{input} IS t{term}"))
            })
            .collect();
    }
    text += &format!("outputs: {{y: {{range: [0, 10], {output}}}}}\nrules:\n");
    let borders = [random.usize(..=tables.len()), random.usize(..=tables.len())];
    for (i, condition) in tables.iter().enumerate() {
        let consequent = match random.u8(..10) {
            0 => random.choice(["a", "b", "c"]).unwrap(),
            _ if i < borders[0] => "a",
            _ if i < borders[1] => "b",
            _ => "c",
        };
        let condition = &condition[5..];
        let weight = if random.u8(..12) == 0 {
            " WITH 0.5"
        } else {
            ""
        };
        let rule = format!("  - IF {condition} THEN y IS {consequent}{weight}\n");
        text += match random.u8(..20) {
            0 => "",
            _ => &rule,
        };
        if random.u8(..15) == 0 {
            text += &rule;
        }
        if random.u8(..25) == 0 {
            text += &format!("  - IF NOT ({condition}) OR x0 IS very t0 THEN y IS a WITH 0.1\n");
        }
    }
    text += "  - IF x0 IS t0 THEN y IS a\n";
    parse(&text)
}

/// Compares both models at points other than those of the search, and with unknown inputs.
fn agree(before: &Model, after: &Model, seed: u64) {
    let mut random = fastrand::Rng::with_seed(seed ^ 0x5eed);
    let engines = [Engine::new(before).unwrap(), Engine::new(after).unwrap()];
    for i in 0..2000 {
        let mut point: Vec<f64> = before
            .inputs
            .iter()
            .map(|input| input.low + random.f64() * (input.high - input.low))
            .collect();
        let kept = |input: &fuzzy::model::Variable| {
            after.inputs.iter().any(|other| other.name == input.name)
        };
        if i % 100 == 0 {
            let kept = before.inputs.iter().position(kept).unwrap();
            point[kept] = f64::NAN;
        }
        let pairs = before.inputs.iter().zip(&point);
        let fewer: Vec<f64> = pairs
            .filter(|(input, _)| kept(input))
            .map(|(_, x)| *x)
            .collect();
        let before = engines[0].evaluate(&point).unwrap()[0];
        let after = engines[1].evaluate(&fewer).unwrap()[0];
        match (before.value(), after.value()) {
            (Some(a), Some(b)) => assert!((a - b).abs() < 1e-9, "{a} {b} at {point:?}"),
            (a, b) => assert_eq!((a, before.state), (b, after.state), "at {point:?}"),
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn random_models_keep_their_outputs_with_fewer_rules(seed in any::<u64>()) {
        let model = random_model(seed);
        let found = simplified(&model);
        prop_assert!(found.model.rules.len() <= model.rules.len());
        agree(&model, &found.model, seed);
        let again = simplified(&found.model);
        prop_assert_eq!(rules(&again.model), rules(&found.model));
        prop_assert!(again.inputs.is_empty() && again.dropped.is_empty());
    }
}

#[test]
fn most_random_models_become_shorter() {
    let counts = (0..50).map(|seed| {
        let model = random_model(seed);
        let found = simplified(&model);
        if seed < 5 {
            assert_eq!(simplified(&model), found);
        }
        (model.rules.len(), found.model.rules.len())
    });
    let (before, after) = counts.fold((0, 0), |sum, count| (sum.0 + count.0, sum.1 + count.1));
    assert!(after * 4 < before * 3, "{before} {after}");
}

/// A rule that matters only in a small part of the input space is kept.
#[test]
fn a_rule_that_rarely_matters_is_kept() {
    let seed = 5_125_509_504_377_779_155;
    let model = random_model(seed);
    agree(&model, &simplified(&model).model, seed);
}
