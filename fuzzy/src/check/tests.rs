use alloc::{format, string::ToString, vec::Vec};

use super::*;
use crate::yaml;

const INPUTS: &str = "inputs: {x: {range: [0, 1], partition: [low, medium, high]}, \
                      y: {range: [0, 1], partition: [low, high]}}";
const OUTPUTS: &str = "outputs: {z: {range: [0, 1], partition: [low, medium, high]}}";

fn report_of(text: &str, options: &Options) -> (Report, Vec<Diagnostic>) {
    let document = yaml::parse(text).unwrap_or_else(|f| panic!("{text}\n{f}"));
    let engine = Engine::new(&document.model).unwrap();
    let report = check(&engine, options).unwrap();
    let findings = report.findings(&document.model, &document.spans);
    (report, findings)
}

fn with_rules(rules: &[&str]) -> Report {
    let rules: Vec<_> = rules.iter().map(|rule| format!("  - {rule}\n")).collect();
    let text = format!(
        "fuzzy: 1\nname: a\n{INPUTS}\n{OUTPUTS}\nrules:\n{}",
        rules.concat()
    );
    report_of(&text, &Options::default()).0
}

fn paper() -> &'static str {
    include_str!("../../../rules/flagred-paper.yaml")
}

/// Exercises several of the hottest loops: equal terms in long lists, trends of many outputs, and evaluations with
/// curved terms.
#[test]
fn large_rule_sets_are_checked_in_bounded_time() {
    let terms = |count: usize, shape: &dyn Fn(usize) -> String| {
        let terms: Vec<String> = (0..count).map(|i| format!("a{i}: {}", shape(i))).collect();
        format!("terms: {{{}}}", terms.join(", "))
    };
    let triangle = |i: usize| format!("{{triangle: [{}, {i}, {}]}}", i as f64 - 1.0, i + 1);
    let gaussian = |i: usize| format!("{{gaussian: {{mean: {i}, sd: 1}}}}");
    let long = format!(
        "fuzzy: 1\nname: long\ninputs: {{x: {{range: [0, 999], {0}}}}}\noutputs: {{y: {{range: [0, 999], {0}}}}}\nrules:\n{1}",
        terms(1000, &triangle),
        (0..1000)
            .map(|i| format!("  - IF x IS a{i} THEN y IS a{i}\n"))
            .collect::<String>()
    );
    // Many output terms are active at the same time.
    let pairs = (0..100).flat_map(|i| (0..100).map(move |j| (i, j)));
    let rules = pairs.map(|(i, j)| {
        let term = (7 * i + 3 * j) % 100;
        format!("  - IF x IS a{i} AND z IS a{j} THEN y IS a{term}\n")
    });
    let curved = format!(
        "fuzzy: 1\nname: curved\ninputs: {{x: {{range: [0, 99], {0}}}, z: {{range: [0, 99], {0}}}}}\noutputs: {{y: {{range: [0, 99], {0}}}}}\nrules:\n{1}",
        terms(100, &gaussian),
        rules.collect::<String>()
    );
    for (text, is_complete) in [(long, true), (curved, false)] {
        let document = crate::yaml::parse(&text).unwrap();
        let engine = Engine::new(&document.model).unwrap();
        let started = std::time::Instant::now();
        let report = check(&engine, &Options::default()).unwrap();
        // The limit allows for unoptimised builds and a busy machine. Without a bound on the work, the second rule set
        // takes minutes.
        assert!(started.elapsed().as_secs() < 120, "{:?}", started.elapsed());
        assert_eq!(report.reach_complete, is_complete);
        let findings = report.findings(&document.model, &document.spans);
        let is_reported = findings
            .iter()
            .any(|one| one.code == "examined-in-part" && one.message.starts_with("evaluating"));
        assert_eq!(is_reported, !is_complete);
        let narrow = findings.iter().any(|one| one.code == "narrow-reach");
        assert!(is_complete || !narrow);
    }
}

#[test]
fn terms_at_a_single_value_fire_there() {
    let text = |rules: &str| {
        format!(
            "fuzzy: 1\nname: a\ninputs:\n  x: {{range: [0, 1], partition: [low, high]}}\n  \
             mode: {{range: [0, 2], terms: {{off: {{singleton: 0}}, on: {{singleton: 0.12345678901234}}, \
             far: {{singleton: 2}}, wide: {{trapezoid: [0.5, 1, 2, 2]}}}}}}\n{OUTPUTS}\nrules:\n{rules}"
        )
    };
    let all = "  - IF x IS low AND mode IS on THEN z IS low\n  - IF mode IS off AND NOT x IS low THEN z IS medium\n  \
               - IF mode IS far AND mode IS wide THEN z IS high\n";
    let (report, findings) = report_of(&text(all), &Options::default());
    assert!(report.never_firing.is_empty());
    assert!(report.unreachable.is_empty());
    assert_eq!(report.holes[0].low, 0.0);
    assert!(findings.iter().all(|f| f.code != "never-fires"));
    // Two different single values are mutually exclusive.
    let both = format!(
        "{all}  - IF mode IS on AND mode IS far THEN z IS high\n  - IF mode IS on AND mode IS wide THEN z IS low\n"
    );
    let (report, _) = report_of(&text(&both), &Options::default());
    assert_eq!(report.never_firing, [3, 4]);
}

#[test]
fn warnings_of_reading_are_findings() {
    let text = "fuzzy: 1
name: fan
inputs: {heat: {range: [0, 40], partition: {hot: 35, cool: 5}}}
outputs: {speed: {range: [0, 10], partition: [slow, fast]}}
rules: [IF heat IS cool THEN speed IS slow, IF heat IS hot THEN speed IS fast]
";
    let source = crate::Source::new(text);
    let (document, engine) = (source.document().unwrap(), source.engine().unwrap());
    let (findings, _) = super::document(document, engine, text, &Options::default()).unwrap();
    let found = findings
        .0
        .iter()
        .find(|one| one.code == "inverted-parameters");
    let found = found.unwrap();
    assert_eq!(found.severity, crate::diagnostic::Severity::Warning);
    assert_eq!(found.position.map(|place| place.line), Some(3));
}

#[test]
fn findings_of_the_papers_rules() {
    let (report, findings) = report_of(paper(), &Options::default());
    let boxes: Vec<&UncoveredRegion> = report.uncovered.iter().filter(|one| !one.silent).collect();
    assert_eq!(boxes.len(), 1);
    let sides: Vec<_> = boxes[0]
        .sides
        .iter()
        .map(|s| (s.input.as_str(), s.low, s.high))
        .collect();
    assert_eq!(sides, [("margin", 0.0, 0.15), ("spread", 0.0, 0.05)]);
    let missing: Vec<Vec<&str>> = boxes[0]
        .missing
        .iter()
        .map(|all| all.iter().map(|one| one.term.as_str()).collect())
        .collect();
    assert_eq!(missing, [["very_low", "low"], ["low", "low"]]);
    // The only region in which no rule fires at all is a part of the line spread = 0.
    let silent: Vec<&UncoveredRegion> = report.uncovered.iter().filter(|one| one.silent).collect();
    assert_eq!(silent.len(), 1);
    assert_eq!(
        (silent[0].sides[1].low, silent[0].sides[1].high),
        (0.0, 0.0)
    );

    let reach = &report.reach[0];
    // The centroid of a shoulder of width 25 is at a third of its width.
    assert!((reach.low - 25.0 / 3.0).abs() < 1e-9, "{reach:?}");
    assert!(
        (reach.high - (100.0 - 25.0 / 3.0)).abs() < 1e-9,
        "{reach:?}"
    );

    assert_eq!(report.against_trend.len(), 1);
    let step = &report.against_trend[0];
    assert_eq!(
        (step.input.as_str(), step.trend),
        ("spread", Direction::Increasing)
    );
    assert_eq!(
        (step.from_term.as_str(), step.to_term.as_str()),
        ("low", "very_low")
    );
    // The rule with index 3 is IF margin IS medium AND spread IS high.
    assert_eq!(step.to_rule, 3);

    let reported: Vec<String> = findings.iter().map(ToString::to_string).collect();
    insta::assert_snapshot!(reported.join("\n"));
}

#[test]
fn claims_of_the_author_are_verified_against_the_engine() {
    let options = Options {
        monotone: Vec::from([
            Monotone::new("spread", Direction::Increasing),
            Monotone::new("margin:risk", Direction::Decreasing),
        ]),
        ..Options::default()
    };
    let (report, _) = report_of(paper(), &options);
    let engine = Engine::new(&yaml::parse(paper()).unwrap().model).unwrap();
    let risk = |margin: f64, spread: f64| engine.evaluate(&[margin, spread]).unwrap()[0].value();
    let worst = &report.counterexamples[0];
    assert_eq!(worst.claim.output.as_deref(), Some("risk"));
    // The engine confirms the values, and the violation is at least as large as in the paper's table at medium margin.
    let at = |name: &str| worst.at.iter().find(|c| c.input == name).unwrap().value;
    assert_eq!(risk(at("margin"), at("spread")), Some(worst.from_value));
    assert_eq!(risk(at("margin"), worst.to), Some(worst.to_value));
    assert!(
        worst.from_value - worst.to_value >= 25.0 - 25.0 / 3.0 - 1e-9,
        "{worst:?}"
    );
    assert!((at("margin") - 0.2).abs() < 0.06, "{worst:?}");
}

#[test]
fn claims_about_unknown_variables_are_refused() {
    let document = yaml::parse(paper()).unwrap();
    let engine = Engine::new(&document.model).unwrap();
    for (text, help) in [
        ("margn", "did you mean `margin`?"),
        ("margin:rsk", "did you mean `risk`?"),
    ] {
        let options = Options {
            monotone: Vec::from([Monotone::new(text, Direction::Increasing)]),
            ..Options::default()
        };
        let found = check(&engine, &options).unwrap_err();
        assert_eq!(found.help.as_deref(), Some(help));
    }
}

#[test]
fn uncovered_boxes_agree_with_the_engine() {
    // With minimum, maximum and no weights, the coverage must match that of the engine.
    for rules in [
        &["IF x IS low AND y IS high THEN z IS low"][..],
        &[
            "IF NOT (x IS low OR y IS high) THEN z IS low",
            "IF x IS very high THEN z IS high",
        ],
        &[
            "IF x IS somewhat medium THEN z IS low",
            "IF y IS NOT seldom low THEN z IS high",
        ],
        &["IF x IS any THEN z IS low"],
        &["IF x IS extremely high OR (y IS low AND NOT x IS low) THEN z IS low"],
    ] {
        let text: Vec<_> = rules.iter().map(|rule| format!("  - {rule}\n")).collect();
        let text = format!(
            "fuzzy: 1\nname: a\n{INPUTS}\n{OUTPUTS}\nrules:\n{}",
            text.concat()
        );
        let document = yaml::parse(&text).unwrap();
        let engine = Engine::new(&document.model).unwrap();
        let report = check(&engine, &Options::default()).unwrap();
        assert!(report.uncovered_complete);
        let inside = |point: [f64; 2], silent: bool| {
            report
                .uncovered
                .iter()
                .filter(|one| one.silent == silent || one.silent)
                .any(|one| {
                    one.sides.iter().all(|side| {
                        let i = usize::from(side.input == "y");
                        (side.low..=side.high).contains(&point[i])
                    })
                })
        };
        for i in 0..40 {
            for k in 0..40 {
                let point = [(f64::from(i) + 0.513) / 40.0, (f64::from(k) + 0.487) / 40.0];
                let coverage = engine.evaluate(&point).unwrap()[0].coverage;
                assert_eq!(
                    inside(point, false),
                    coverage < 0.5,
                    "{rules:?} {point:?} {coverage}"
                );
                assert_eq!(
                    inside(point, true),
                    coverage == 0.0,
                    "{rules:?} {point:?} {coverage}"
                );
            }
        }
    }
}

#[test]
fn rules_are_compared_with_each_other() {
    let report = with_rules(&[
        "IF x IS low AND y IS low THEN z IS low",
        "IF y IS low AND x IS low THEN z IS high",
        "IF x IS low THEN z IS low",
        "IF x IS high OR y IS high THEN z IS high",
        "IF x IS high THEN z IS high",
        "IF x IS medium AND y IS low THEN z IS medium WITH 0.9",
        "IF y IS low THEN z IS medium WITH 0.5",
    ]);
    let pairs: Vec<_> = report
        .contradictions
        .iter()
        .map(|c| (c.first, c.second))
        .collect();
    assert_eq!(pairs, [(0, 1)]);
    let pairs: Vec<_> = report.subsumed.iter().map(|s| (s.rule, s.by)).collect();
    // The last rule is more general than the one before it, but has a smaller weight.
    assert_eq!(pairs, [(0, 2), (4, 3)]);
}

#[test]
fn rules_that_cannot_fire_and_unreachable_terms_are_found() {
    let report = with_rules(&[
        "IF x IS low AND x IS high THEN z IS low",
        "IF NOT x IS any THEN z IS medium",
        "IF x IS medium THEN z IS high WITH 0",
        "IF y IS low OR y IS high THEN z IS high",
    ]);
    assert_eq!(report.never_firing, [0, 1, 2]);
    let names = |terms: &[TermOf]| {
        let all = terms
            .iter()
            .map(|t| format!("{} {}", t.variable, t.term.as_deref().unwrap_or("*")));
        all.collect::<Vec<_>>()
    };
    assert_eq!(names(&report.unreachable), ["z low", "z medium"]);
    assert_eq!(names(&report.unused), Vec::<String>::new());

    let report = with_rules(&["IF x IS low THEN z IS high"]);
    assert_eq!(
        names(&report.unused),
        ["x medium", "x high", "y *", "z low", "z medium"]
    );
}

#[test]
fn holes_and_single_values_without_a_term_are_found() {
    let text = format!(
        "fuzzy: 1\nname: a\ninputs: {{x: {{range: [0, 10], terms: {{a: {{triangle: [1, 2, 3]}}, \
         b: {{triangle: [3, 4, 5]}}, c: {{rectangle: [6, 7]}}, d: {{gaussian: {{mean: 20, sd: 0.1}}}}}}}}}}\n\
         {OUTPUTS}\nrules: [IF x IS a OR x IS b OR x IS c OR x IS d THEN z IS low]\n"
    );
    let (report, _) = report_of(&text, &Options::default());
    let holes: Vec<_> = report
        .holes
        .iter()
        .map(|hole| (hole.low, hole.high))
        .collect();
    assert_eq!(holes, [(0.0, 1.0), (3.0, 3.0), (5.0, 6.0), (7.0, 10.0)]);
    assert_eq!(report.unreachable[0].term.as_deref(), Some("d"));
}

#[test]
fn jumps_are_found_at_their_positions() {
    let text = format!(
        "fuzzy: 1\nname: a\ninputs: {{x: {{range: [0, 1], terms: {{a: {{rectangle: [0, 0.3]}}, \
         b: {{rectangle: [0.3, 1]}}}}}}}}\n{OUTPUTS}\n\
         rules: [IF x IS a THEN z IS low, IF x IS b THEN z IS high]\n"
    );
    let (report, _) = report_of(&text, &Options::default());
    assert_eq!(report.jumps.len(), 1);
    assert!(
        (report.jumps[0].at[0].value - 0.3).abs() < 1e-9,
        "{:?}",
        report.jumps
    );
    assert!(
        with_rules(&[
            "IF x IS low THEN z IS low",
            "IF NOT x IS low THEN z IS high"
        ])
        .jumps
        .is_empty()
    );
}

#[test]
fn a_jump_names_only_the_inputs_of_its_output() {
    let text = "fuzzy: 1
name: a
inputs:
  x: {range: [0, 1], partition: [low, high]}
  y: {range: [0, 100], steps: {low: 20, enough: }}
outputs:
  z: {range: [0, 1], partition: [low, high]}
  out: {range: [0, 100], terms: {none: {constant: 0}, all: {constant: 100}}, defuzzifier: weighted_average}
rules:
  - IF x IS low THEN z IS low
  - IF x IS high THEN z IS high
  - IF y IS low THEN out IS all
  - IF y IS enough THEN out IS none
";
    let (_, findings) = report_of(text, &Options::default());
    let jump = findings.iter().find(|one| one.code == "jump").unwrap();
    assert_eq!(
        jump.message,
        "`out` jumps from 100 to 0 along `y` at y = 20"
    );
}

/// The rules of `z` read the output `mid`, whose values cover only a part of its range.
#[test]
fn an_output_that_is_read_counts_as_an_input_over_its_range() {
    let outputs = "outputs: {z: {range: [0, 1], partition: [low, medium, high]}, \
                   mid: {range: [0, 1], terms: {low: {triangle: [-0.4, 0, 0.4]}, high: {triangle: [0.6, 1, 1.4]}}}}";
    let text = format!(
        "fuzzy: 1\nname: a\n{INPUTS}\n{outputs}\nrules:
  - IF mid IS low AND mid IS high THEN z IS medium
  - IF x IS low THEN mid IS low
  - IF x IS medium THEN mid IS low
  - IF x IS high THEN mid IS high
  - IF mid IS low AND y IS low THEN z IS low
  - IF mid IS low AND y IS high THEN z IS medium
  - IF mid IS high THEN z IS low
"
    );
    let mut options = Options::default();
    options
        .monotone
        .push(Monotone::new("x:z", Direction::Increasing));
    let (report, findings) = report_of(&text, &options);
    assert_eq!(report.never_firing, [0]);
    assert_eq!(report.holes.len(), 1);
    let TermGap {
        input, low, high, ..
    } = &report.holes[0];
    assert_eq!((input.as_str(), *low, *high), ("mid", 0.4, 0.6));
    let silent: Vec<&UncoveredRegion> = report.uncovered.iter().filter(|one| one.silent).collect();
    let [one] = silent.as_slice() else {
        panic!("{silent:?}");
    };
    let side = &one.sides[0];
    assert_eq!((one.output.as_str(), side.input.as_str()), ("z", "mid"));
    assert_eq!((side.low, side.high, one.sides.len()), (0.4, 0.6, 1));
    // The claim is about an input of the whole model, although the output belongs to a later stage.
    let wrong: Vec<_> = report
        .counterexamples
        .iter()
        .map(|one| one.claim.output.as_deref())
        .collect();
    assert_eq!(wrong, [Some("z")]);
    let reported: Vec<&str> = findings
        .iter()
        .map(|finding| finding.message.as_str())
        .collect();
    assert!(
        reported.contains(&"`mid` has no term from 0.4 to 0.6"),
        "{reported:?}"
    );
    let unknown = Monotone {
        input: "mid".into(),
        ..options.monotone[0].clone()
    };
    options.monotone.push(unknown);
    let engine = Engine::new(&yaml::parse(&text).unwrap().model).unwrap();
    assert!(check(&engine, &options).is_err());
}

/// A rule of a later stage is reported by its index in the whole model, not by its index in the stage.
#[test]
fn rules_of_a_later_stage_are_reported_by_their_numbers() {
    let text = format!(
        "fuzzy: 1\nname: a\n{INPUTS}
outputs: {{mid: {{range: [0, 1], partition: [low, medium, high]}}, z: {{range: [0, 1], partition: [low, medium, high]}}}}
rules:
  - IF x IS low THEN mid IS low
  - IF x IS high THEN mid IS high
  - IF mid IS low AND y IS low THEN z IS low
  - IF mid IS medium AND y IS low THEN z IS medium
  - IF mid IS high AND y IS low THEN z IS high
  - IF mid IS low AND y IS high THEN z IS medium
  - IF mid IS medium AND y IS high THEN z IS high
  - IF mid IS high AND y IS high THEN z IS low
"
    );
    let (report, _) = report_of(&text, &Options::default());
    let along_mid: Vec<_> = report
        .against_trend
        .iter()
        .filter(|one| one.input == "mid")
        .collect();
    assert_eq!(along_mid.len(), 1, "{:?}", report.against_trend);
    assert_eq!((along_mid[0].from_rule, along_mid[0].to_rule), (6, 7));
}

fn findings_of(text: &str) -> Vec<String> {
    let (_, findings) = report_of(text, &Options::default());
    findings.iter().map(ToString::to_string).collect()
}

#[test]
fn terms_that_are_the_same_and_rules_that_contradict_themselves_are_found() {
    let said = findings_of(
        "fuzzy: 1\nname: a\ninputs: {x: {range: [0, 4], terms: {low: {triangle: [-4, 0, 4]}, \
         small: {triangle: {left: -4, peak: 0, right: 4}}, high: {right_shoulder: [0, 4]}}}}\n\
         outputs: {z: {range: [-1, 5], partition: {slow: 0, fast: 4}}}\n\
         rules: [IF x IS low THEN z IS slow, IF x IS small THEN z IS fast, \
         IF x IS high THEN z IS fast AND z IS slow]\n",
    );
    let said = said.join("\n");
    assert!(
        said.contains("the terms `low` and `small` of `x` are the same"),
        "{said}"
    );
    let both = "rule 3 concludes both `z` IS `fast` and `z` IS `slow`";
    assert!(said.contains(both), "{said}");
}

#[test]
fn parts_without_an_effect_or_a_value_are_found() {
    let text = "fuzzy: 1\nname: a\ninputs: {x: {range: [0, 100], terms: {low: {left_shoulder: [30, 50]}, high: TERM}}}\n\
                outputs: {z: {range: [0, 100], OUTPUT}}\n\
                rules: [IF x IS low THEN z IS slow, IF x IS high THEN z IS fast]\n";
    let sets = "partition: [slow, fast]";
    let numbers = "terms: {slow: {constant: 0}, fast: {function: 100 / (x - x)}}, defuzzifier: weighted_average";
    let shoulder = "{right_shoulder: [30, 50]}";
    let found = |term: &str, output: &str, rule: [&str; 2]| {
        let text = text.replace("TERM", term).replace("OUTPUT", output);
        let (_, findings) = report_of(&text.replace(rule[0], rule[1]), &Options::default());
        let codes = ["constant-term", "no-effect", "no-value"];
        let found: Vec<Diagnostic> = findings
            .into_iter()
            .filter(|one| codes.contains(&one.code))
            .collect();
        found
            .iter()
            .map(ToString::to_string)
            .collect::<Vec<_>>()
            .join("\n")
    };
    let none = ["", ""];
    insta::assert_snapshot!(
        [
            found("{sigmoid: {inflection: 50, slope: 0}}", sets, none),
            found("{gaussian: {mean: 50, sd: 1000}}", sets, none),
            found("{gaussian: {mean: 50, sd: 200}}", sets, none),
            found("{right_shoulder: [0.3, 0.5]}", sets, none),
            found(shoulder, &format!("{sets}, clamp: true"), none),
            found(shoulder, numbers, none),
            found(shoulder, sets, ["x IS low", "x IS any low"]),
        ]
        .join("\n")
    );
    // These constant degrees are intended, so they are not reported.
    for (term, output) in [
        (shoulder, sets),
        ("{constant: 1}", sets),
        ("{gaussian: {mean: 50, sd: 100}}", sets),
        (
            shoulder,
            "terms: {slow: {constant: 0}, fast: {constant: 200}}, defuzzifier: weighted_average, clamp: true",
        ),
        (
            shoulder,
            "terms: {slow: {constant: 0}, fast: {function: sqrt(x)}}, defuzzifier: weighted_average",
        ),
    ] {
        assert_eq!(found(term, output, none), "", "{term} {output}");
    }
    let steps = "{range: [0, 1000], steps: {none: 1, some: }}";
    let text = format!(
        "fuzzy: 1\nname: a\ninputs: {{x: {steps}}}\noutputs: {{z: {{range: [0, 100], {sets}}}}}\n\
         rules: [IF x IS none THEN z IS slow, IF x IS some THEN z IS fast]\n"
    );
    let (_, findings) = report_of(&text, &Options::default());
    assert!(
        findings.iter().all(|one| one.code != "constant-term"),
        "{findings:?}"
    );
}

#[test]
fn a_sugeno_output_beyond_its_range_is_found() {
    let said = findings_of(
        "fuzzy: 1\nname: a\ninputs: {x: {range: [0, 1], partition: [low, high]}}\n\
         outputs: {z: {range: [0, 9], defuzzifier: weighted_average, \
         terms: {slow: {constant: 0}, fast: {linear: {x: 5, constant: 7}}}}}\n\
         rules: [IF x IS low THEN z IS slow, IF x IS high THEN z IS fast]\n",
    );
    let beyond =
        "warning[output-outside-range]: `z` takes values from 0 to 12, outside its range [0, 9]";
    assert_eq!(said.len(), 1, "{said:?}");
    assert!(said[0].starts_with(beyond), "{said:?}");
}

#[test]
fn a_gap_is_reported_once() {
    // No term covers 3 to 5. The regions around this gap in which no rule fires, or rules fire only weakly, are not
    // reported separately.
    let said = findings_of(
        "fuzzy: 1\nname: a\ninputs: {x: {range: [0, 8], terms: {low: {left_shoulder: [1, 3]}, \
         high: {right_shoulder: [5, 7]}}}}\n\
         outputs: {z: {range: [0, 1], defuzzifier: weighted_average, terms: {a: {constant: 0}, b: {constant: 1}}}}\n\
         rules: [IF x IS low THEN z IS a, IF x IS high THEN z IS b]\n",
    );
    assert_eq!(said.len(), 1, "{said:?}");
    assert!(said[0].contains("`x` has no term from 3 to 5"), "{said:?}");
    // A missing rule is one finding. The unused term and the region in which no rule fires are not reported
    // separately.
    let said = findings_of(
        "fuzzy: 1\nname: a\ninputs: {x: {range: [0, 1], partition: [low, medium, high]}}\n\
         outputs: {z: {range: [0, 1], defuzzifier: weighted_average, terms: {a: {constant: 0}, b: {constant: 1}}}}\n\
         rules: [IF x IS low THEN z IS a, IF x IS high THEN z IS b]\n",
    );
    assert_eq!(said.len(), 1, "{said:?}");
    assert!(said[0].contains("0.25 < x < 0.75"), "{said:?}");
}

#[test]
fn a_single_value_without_a_term_is_reported_in_few_digits() {
    let said = findings_of(
        "fuzzy: 1\nname: a\ninputs: {x: {range: [0, 4], terms: {low: {triangle: [0, 2, 4]}}}}\n\
         outputs: {z: {range: [0, 1], defuzzifier: weighted_average, terms: {a: {constant: 0}}}}\n\
         rules: [IF x IS low THEN z IS a]\n",
    );
    assert!(
        said.iter().any(|s| s.contains("`x` has no term at 0\n")),
        "{said:#?}"
    );
    let gaps = said.iter().filter(|s| s.starts_with("warning"));
    assert_eq!(gaps.count(), 2, "{said:#?}");
    assert_eq!(
        (shown(1e-300), shown(1.0 / 3.0)),
        ("1e-300".into(), "0.333333".into())
    );
}

/// Returns the findings about the reach of an output, each with its help and severity.
fn reach_of(output: &str) -> Vec<String> {
    let text = format!(
        "fuzzy: 1\nname: valve\ninputs: {{soil: {{range: [0, 100], partition: [dry, moist, damp, soaked]}}}}\n\
         outputs: {{water: {output}}}\nrules:\n  - IF soil IS dry THEN water IS long\n  - IF soil IS moist THEN water IS medium\n  \
         - IF soil IS damp THEN water IS short\n  - IF soil IS soaked THEN water IS off\n"
    );
    let (_, findings) = report_of(&text, &Options::default());
    let found = findings.iter().filter(|one| one.code.ends_with("-reach"));
    let reported = found.map(|one| {
        let help = one.help.as_deref().unwrap_or_default();
        format!("{:?}: {}\n{help}", one.severity, one.message)
    });
    reported.collect()
}

#[test]
fn an_outer_term_that_is_never_reached_is_a_warning_with_both_remedies() {
    let reported = reach_of("{range: [0, 40], partition: [off, short, medium, long]}");
    insta::assert_snapshot!(reported.join("\n"));
    // With either of the suggested changes, the output reaches the peaks of both outer terms, so there is no finding.
    for remedy in [
        "{range: [-7.69, 47.69], partition: {off: 0, short: 13.3333, medium: 26.6667, long: 40}}",
        "{range: [0, 40], terms: {off: {constant: 0}, short: {constant: 13.3333}, medium: {constant: 26.6667}, long: {constant: 40}}, \
         defuzzifier: weighted_average}",
    ] {
        assert_eq!(reach_of(remedy), [] as [&str; 0], "{remedy}");
    }
}

#[test]
fn each_cause_of_an_unreached_outer_term_has_its_own_message() {
    let outputs = [
        // Only one end is not reached.
        "{range: [0, 40], partition: {off: 0, short: 10, medium: 20, long: 24}}",
        // A wider range has no effect on a set that ends where the old range ends.
        "{range: [0, 40], terms: {off: {triangle: [0, 0, 10]}, short: {triangle: [5, 10, 15]}, medium: {triangle: [15, 20, 25]}, long: {triangle: [25, 30, 35]}}}",
        "{range: [0, 40], terms: {off: {gaussian: {mean: 0, sd: 4}}, short: {gaussian: {mean: 10, sd: 4}}, medium: {gaussian: {mean: 25, sd: 4}}, long: {gaussian: {mean: 40, sd: 4}}}, defuzzifier: bisector}",
        // The terms are inside the range, so the output never reaches the ends of the range. This is only a note.
        "{range: [0, 40], terms: {off: {triangle: [0, 5, 10]}, short: {triangle: [10, 15, 20]}, medium: {triangle: [20, 25, 30]}, long: {triangle: [30, 35, 40]}}}",
        // All numbers are below the upper end of the range, so the output never reaches it. This is only a note, too.
        "{range: [0, 40], terms: {off: {constant: 0}, short: {constant: 10}, medium: {constant: 20}, long: {constant: 30}}, defuzzifier: weighted_average}",
        // These cases have no finding: a plateau, the mean of maxima, singletons.
        "{range: [0, 40], partition: {off: 6, short: 12, medium: 24, long: 34}}",
        "{range: [0, 40], partition: [off, short, medium, long], defuzzifier: mean_of_maxima}",
        "{range: [0, 40], terms: {off: {singleton: 0}, short: {singleton: 10}, medium: {singleton: 20}, long: {singleton: 40}}}",
    ];
    let reported = outputs.map(|output| format!("# {output}\n{}\n", reach_of(output).join("\n")));
    insta::assert_snapshot!(reported.join("\n"));
}

#[test]
fn findings_that_the_author_accepts_are_left_out_and_reported_where_they_do_not_occur() {
    let text = "fuzzy: 1
name: credit
inputs: {dti: {range: [0, 100], steps: {fine: 36, stretched: 43, over: }}}
outputs: {risk: {range: [0, 1], terms: {low: {constant: 0}, high: {constant: 1}}, defuzzifier: weighted_average}}
rules: [IF dti IS over THEN risk IS high, IF dti IS NOT over THEN risk IS low]
allow: [{finding: jump, because: required by the regulation}, {finding: hole, because: none}]";
    let (report, findings) = report_of(text, &Options::default());
    let codes: Vec<&str> = findings.iter().map(|finding| finding.code).collect();
    assert_eq!(codes, ["unused", "unused", "unneeded-allow"]);
    let unneeded = findings.last().unwrap();
    assert_eq!(
        unneeded.message,
        "`allow` accepts `hole`, which does not occur"
    );
    assert_eq!(
        &text[unneeded.span.clone()],
        "{finding: hole, because: none}"
    );
    let accepted = report.accepted(&text.parse().unwrap());
    let counts: Vec<usize> = accepted.iter().map(|one| one.count).collect();
    assert_eq!(counts, [1, 0]);
    // An entry with a name accepts only the findings about it.
    let (before, _) = text.split_once("allow:").unwrap();
    let of = "allow: [{finding: unused, of: fine, because: later}, {finding: unused, of: over, because: no}, {finding: jump, of: dti, because: law}]";
    let (_, findings) = report_of(&(before.to_owned() + of), &Options::default());
    let messages: Vec<&str> = findings.iter().map(|one| one.message.as_str()).collect();
    let unused = "no rule uses the term `stretched` of `dti`";
    let unneeded = "`allow` accepts `unused` of `over`, which does not occur";
    assert_eq!(messages, [unused, unneeded]);
}

#[test]
fn steps_have_no_hole_and_no_region_without_a_rule() {
    let text = "fuzzy: 1
name: credit
inputs: {dti: {range: [0, 100], steps: {fine: 36, stretched: 43, over: 100, all: }}}
outputs: {risk: {range: [0, 3], terms: {a: {constant: 0}, b: {constant: 1}, c: {constant: 2}, d: {constant: 3}}, defuzzifier: weighted_average}}
rules: [IF dti IS fine THEN risk IS a, IF dti IS stretched THEN risk IS b, IF dti IS over THEN risk IS c, IF dti IS all THEN risk IS d]
allow: [{finding: jump, because: required by the regulation}]";
    assert_eq!(report_of(text, &Options::default()).1, []);
    let missing = text.replace("IF dti IS stretched THEN risk IS b, ", "");
    let reported: Vec<_> = report_of(&missing, &Options::default()).1;
    let reported: Vec<String> = reported.iter().map(|one| one.to_string()).collect();
    insta::assert_snapshot!(reported.join("\n"));
}

#[test]
fn formulas_are_evaluated_at_the_ends_of_ranges() {
    let of = |formula: &str| {
        let text = format!(
            "fuzzy: 1
name: poles
inputs: {{x: {{range: [0, 2], partition: [low, high]}}, y: {{range: [-1, 1], partition: [low, high]}}}}
outputs: {{z: {{range: [0, 90], terms: {{a: {{function: '{formula}'}}, b: {{constant: 0}}}}, defuzzifier: weighted_average}}}}
rules: [IF x IS low THEN z IS a, IF x IS high THEN z IS b]"
        );
        let document = crate::yaml::parse(&text).unwrap();
        let engine = Engine::new(&document.model).unwrap();
        let report = check(&engine, &Options::default()).unwrap();
        let findings = report.findings(&document.model, &document.spans);
        let codes = ["no-value", "narrow-reach"];
        let found = findings.iter().filter(|one| codes.contains(&one.code));
        found.map(|one| one.message.clone()).collect::<Vec<_>>()
    };
    let at = |place: &str| {
        [format!(
            "the formula of term `a` of output `z` has no finite value at {place}"
        )]
    };
    assert_eq!(of("1 / x"), at("x = 0"));
    assert_eq!(of("-10 * log(x)"), at("x = 0"));
    assert_eq!(of("1 / (1 + y)"), at("y = -1"));
    assert_eq!(of("x / y"), at("x = 1, y = 0"));
    // At the pole (x = 2), no rule that concludes `a` fires.
    assert!(
        !of("1 / (2 - x)")
            .iter()
            .any(|found| found.contains("no finite value"))
    );
}
