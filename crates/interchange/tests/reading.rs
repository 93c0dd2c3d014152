//! Errors that the readers report. No text makes the readers panic.

#![allow(
    clippy::expect_used,
    clippy::panic,
    clippy::print_stdout,
    clippy::unwrap_used,
    reason = "helpers of tests fail by panics, and tell what fails"
)]

use flagred_interchange::{Format, Losses};

const FLL: &str = "# A fan that follows the heat.
Engine: fan
InputVariable: heat
  range: 0 40
  term: low Ramp 20 10
  term: high Gaussian 30 5 0.5
OutputVariable: speed
  range: 0 9
  aggregation: Maximum
  defuzzifier: Centroid 100
  default: 4.5
  term: slow Triangle 0 2 4
  term: fast Discrete 5 0 7 1 9 0
RuleBlock:
  conjunction: AlgebraicProduct
  disjunction: Maximum
  implication: Minimum
  activation: General
  rule: if heat is low or (heat is very high and heat is not low) then speed is slow # at night
  rule: if heat is any then speed is fast with 0.5
";

const FIS: &str = "% A tip
[System]
Name='tip'
Type='sugeno'
NumInputs=2
NumOutputs=1
NumRules=2
AndMethod='prod'
OrMethod='probor'
DefuzzMethod='wtaver'
[Input1]
Name='service'
Range=[0 10]
NumMFs=2
MF1='poor':'gaussmf',[1.5 0]
MF2='good':'zmf',[5 10 0 0]
[Input2]
Name='food'
Range=[0 10]
NumMFs=1
MF1='bad':'trapmf',[-1 0 1 3]
[Output1]
Name='tip'
Range=[0 30]
NumMFs=2
MF1='low':'constant',[5]
MF2='high':'linear',[1 2 3]
[Rules]
1 -1, 1 (1) : 2 % the guest is angry
2 0, 2 (0.5) : 1
";

const FCL: &str = "(* A crane *)
FUNCTION_BLOCK crane
VAR_INPUT distance : REAL; END_VAR
VAR_OUTPUT power : REAL; END_VAR
FUZZIFY distance
  TERM near := (0, 1) (10, 0);
  TERM far := GAUSS 20 5;
  RANGE := (0 .. 20);
END_FUZZIFY
DEFUZZIFY power
  TERM low := -12; TERM high := 27.5;
  METHOD : COGS;
  DEFAULT := 0;
END_DEFUZZIFY
RULEBLOCK first
  AND : MIN;
  RULE 1 : IF distance IS NOT far THEN power IS low; // slow down
  RULE 2 : IF distance IS far THEN power IS high WITH 0.5;
END_RULEBLOCK
END_FUNCTION_BLOCK
";

const FML: &str = r#"<?xml version="1.0"?>
<fuzzySystem xmlns="http://www.ieee1855.org" name="fan">
  <knowledgeBase>
    <fuzzyVariable name="heat" domainleft="0" domainright="40" scale="C" type="input">
      <fuzzyTerm name="low"><leftLinearShape param1="10" param2="20"/></fuzzyTerm>
      <fuzzyTerm name="high"><rightGaussianShape param1="30" param2="5"/></fuzzyTerm>
    </fuzzyVariable>
    <fuzzyVariable name="speed" domainleft="0" domainright="9" type="output" accumulation="MAX" defuzzifier="COG" defaultValue="0">
      <fuzzyTerm name="slow"><triangularShape param1="0" param2="2" param3="4"/></fuzzyTerm>
      <fuzzyTerm name="fast"><pointSetShape><point x="5" y="0"/><point x="7" y="1"/></pointSetShape></fuzzyTerm>
    </fuzzyVariable>
  </knowledgeBase>
  <mamdaniRuleBase name="r" andMethod="MIN" orMethod="MAX" activationMethod="MIN">
    <rule name="1" connector="and" weight="0.5">
      <antecedent><clause modifier="very"><variable>heat</variable><term>low</term></clause></antecedent>
      <consequent><then><clause><variable>speed</variable><term>slow</term></clause></then></consequent>
    </rule>
  </mamdaniRuleBase>
</fuzzySystem>
"#;

const TEXTS: [(Format, &str); 4] = [
    (Format::Fis, FIS),
    (Format::Fll, FLL),
    (Format::Fcl, FCL),
    (Format::Fml, FML),
];

/// A rule with `deep` brackets around its condition, in each format whose rules have brackets.
fn bracketed(deep: usize) -> [String; 2] {
    let condition = format!("{}x is low{}", "(".repeat(deep), ")".repeat(deep));
    [
        format!(
            "FUNCTION_BLOCK f\nVAR_INPUT x : REAL; END_VAR\nVAR_OUTPUT y : REAL; END_VAR\n\
             FUZZIFY x TERM low := (0, 1) (1, 0); RANGE := (0 .. 1); END_FUZZIFY\n\
             DEFUZZIFY y TERM low := (0, 1) (1, 0); METHOD : COG; RANGE := (0 .. 1); END_DEFUZZIFY\n\
             RULEBLOCK r AND : MIN; RULE 1 : IF {condition} THEN y IS low; END_RULEBLOCK\nEND_FUNCTION_BLOCK\n"
        ),
        format!(
            "Engine: e\nInputVariable: x\n  range: 0 1\n  lock-range: true\n  term: low Ramp 1 0\nOutputVariable: y\n  range: 0 1\n  \
             aggregation: Maximum\n  defuzzifier: Centroid 100\n  default: nan\n  term: low Ramp 1 0\n\
             RuleBlock: r\n  conjunction: Minimum\n  implication: Minimum\n  activation: General\n  rule: if {condition} then y is low\n"
        ),
    ]
}

/// The nesting of brackets is limited by counting, so a small stack is enough.
#[test]
fn nested_brackets_are_bounded_and_use_little_stack() {
    let read = || {
        for (deep, is_read) in [(64, true), (65, false), (100_000, false)] {
            for text in bracketed(deep) {
                let read = flagred_interchange::document(&text);
                match read {
                    Ok(_) => assert!(is_read, "{deep}"),
                    Err(findings) => {
                        let reported = findings.to_string();
                        assert!(!is_read, "{reported}");
                        assert!(
                            reported.contains("rule-too-deep") && reported.len() < 500,
                            "{reported}"
                        );
                    }
                }
            }
        }
    };
    let thread = std::thread::Builder::new().stack_size(256 * 1024);
    thread.spawn(read).unwrap().join().unwrap();
}

/// A word of 200 kB is quoted only up to a limit, in every format.
#[test]
fn long_words_are_cut_in_messages() {
    let long = "x".repeat(200_000);
    let texts = [
        bracketed(0)[0].replace("x is low", &format!("x is {long}")),
        bracketed(0)[0].replace("METHOD : COG", &format!("METHOD : {long}")),
        bracketed(0)[0].replace("x is low", &format!("x {long} low")),
        bracketed(0)[1].replace("x is low", &format!("x is {long}")),
        bracketed(0)[1].replace("low Ramp", &format!("low {long}")),
        bracketed(0)[1].replace("  range: 0 1", &format!("  range: 0 {long}")),
        format!("[System]\nName='a'\nNumInputs={long}\n"),
        format!(
            "[System]\nName='a'\nType='{long}'\nNumInputs=1\n[Input1]\nName='x'\nRange=[0 {long}]\n"
        ),
        format!("<fuzzySystem name=\"a\"><{long}/></fuzzySystem>"),
        format!(
            "fuzzy: 1\nname: a\ninputs: {{x: {{range: [0, 1], partition: [a, b]}}}}\noutputs: {{y: {{range: [0, 1], partition: [a, b]}}}}\nrules: [IF x IS {long} THEN y IS a, IF x {long} a THEN y IS a, IF {long} IS a THEN y IS a]\n"
        ),
        format!(
            "fuzzy: 1\nname: a\n{long}: 1\ninputs: {{x: {{range: [0, {long}], partition: [a, b]}}}}\n"
        ),
    ];
    for text in texts {
        let reported = flagred_interchange::document(&text).unwrap_err();
        for finding in &reported.0 {
            let shown = finding.to_string();
            assert!(shown.len() < 700, "{} {}", shown.len(), &shown[..300]);
        }
    }
}

#[test]
fn each_format_becomes_a_rule_set() {
    let mut read = String::new();
    for (format, text) in TEXTS {
        assert_eq!(Format::of(text), Some(format));
        let document = flagred_interchange::read(text, format, Losses::Refuse)
            .unwrap_or_else(|findings| panic!("{}: {findings}", format.name()));
        fuzzy::Engine::new(&document.model).unwrap_or_else(|findings| panic!("{findings}"));
        read += &format!(
            "{}\n{}\n{}\n",
            format.name(),
            document.warnings,
            fuzzy::yaml::to_string(&document.model)
        );
    }
    insta::assert_snapshot!(read);
}

/// Each error is made by replacing a part of a text.
#[test]
fn mistakes_are_reported_with_their_position() {
    let mistakes = [
        (Format::Fis, "'wtaver'", "'centroid'"),
        (Format::Fis, "'gaussmf',[1.5 0]", "'gausmf',[1.5 0]"),
        (Format::Fis, "[1.5 0]", "[1.5]"),
        (Format::Fis, "[1.5 0]", "[1.5 pi/x]"),
        (Format::Fis, "'prod'", "'myand'"),
        (Format::Fis, "'sugeno'", "'mamtype2'"),
        (Format::Fis, "1 -1, 1 (1) : 2", "1 -2, 1 (1) : 2"),
        (Format::Fis, "1 -1, 1 (1) : 2", "1, 1 (1) : 2"),
        (Format::Fis, "1 -1, 1 (1) : 2", "1 -1, -1 (1) : 2"),
        (Format::Fis, "1 -1, 1 (1) : 2", "1.7 -1, 1 (1) : 2"),
        (Format::Fis, "1 -1, 1 (1) : 2", "1 -1, 1 (1) : 3"),
        (Format::Fis, "Range=[0 10]", "Range=[0]"),
        (Format::Fis, "[1.5 0]", "[1,5 0]"),
        (Format::Fis, "'poor'", "’poor’"),
        (Format::Fis, "[-1 0 1 3]", "[-1 0 1]"),
        (Format::Fll, "  range: 0 40", "  range 0 40"),
        (Format::Fll, "Triangle 0 2 4", "Triangle 0 2"),
        (Format::Fll, "Gaussian 30", "Gausian 30"),
        (Format::Fll, "Gaussian 30 5 0.5", "Gaussian 30"),
        (Format::Fll, "range: 0 40", "rang: 0 40"),
        (Format::Fll, "Maximum\n  defuzz", "Maxmum\n  defuzz"),
        (Format::Fll, "and heat", "heat"),
        (Format::Fll, "if heat is any then", "if heat is any the"),
        (
            Format::Fll,
            "  range: 0 40",
            "  enabled: false\n  range: 0 40",
        ),
        (Format::Fll, "Centroid 100", "Centroid many"),
        (Format::Fll, "(heat is very", "((heat is very"),
        (Format::Fcl, "GAUSS 20 5", "GAUS 20 5"),
        (Format::Fcl, "GAUSS 20 5", "GAUSS 20"),
        (Format::Fcl, "(10, 0)", "(10 0)"),
        (Format::Fcl, "COGS", "COGGS"),
        (Format::Fcl, "DEFAULT := 0", "DEFAULT := NC"),
        (Format::Fcl, "FUZZIFY distance", "FUZZIFY distanse"),
        (
            Format::Fcl,
            "END_FUNCTION_BLOCK\n",
            "END_FUNCTION_BLOCK\nFUNCTION_BLOCK b\n",
        ),
        (Format::Fcl, "THEN power IS low", "power IS low"),
        (Format::Fcl, "(0 .. 20);", "(0 .. 20)"),
        (Format::Fcl, "(0 .. 20);", "(0 . 20);"),
        (Format::Fcl, "TERM far :=", "TERM far ="),
        (Format::Fcl, "END_FUZZIFY\n", ""),
        (Format::Fcl, "IF distance IS NOT", "distance IS NOT"),
        (Format::Fml, "name=\"fan\"", "name=\"fan & heat\""),
        (Format::Fml, "domainleft=\"0\"", "domainleft=0"),
        (Format::Fml, "</fuzzyTerm>", ""),
        (Format::Fml, " param2=\"20\"", ""),
        (Format::Fml, "leftLinearShape", "leftLinerShape"),
        (Format::Fml, "param1=\"10\"", "param1=\"ten\""),
        (
            Format::Fml,
            "domainleft=\"0\" domainright=\"40\"",
            "domainleft=\"0\"",
        ),
        (Format::Fml, "\"very\"", "\"slightly\""),
        (Format::Fml, "\"COG\"", "\"COF\""),
        (Format::Fml, "</fuzzySystem>", ""),
        (Format::Fml, "mamdaniRuleBase", "anYaRuleBase"),
    ];
    let mut reported = String::new();
    for (format, before, after) in mistakes {
        let (_, text) = TEXTS.iter().find(|(known, _)| *known == format).unwrap();
        assert!(text.contains(before), "{before}");
        let text = text.replace(before, after);
        let findings = match flagred_interchange::read(&text, format, Losses::Refuse) {
            Ok(document) => document.warnings,
            Err(findings) => findings,
        };
        assert!(!findings.0.is_empty(), "{before} -> {after}");
        reported += &format!("{}: {before:?} -> {after:?}\n{findings}\n\n", format.name());
    }
    insta::assert_snapshot!(reported);
}

#[test]
fn unsupported_features_are_warnings_where_losses_are_accepted() {
    let text = FLL.replace("  range: 0 40", "  enabled: false\n  range: 0 40");
    assert!(flagred_interchange::read(&text, Format::Fll, Losses::Refuse).is_err());
    let document = flagred_interchange::read(&text, Format::Fll, Losses::Accept).unwrap();
    assert_eq!(document.warnings.0[0].code, "not-enabled");
}

/// An FCL text with an output whose values are computed, and two rules with the same conclusion. `accu` is inserted at
/// the end of the output, `end` after the last rule.
fn twice(accu: &str, end: &str) -> String {
    format!(
        "FUNCTION_BLOCK twice\nVAR_INPUT\n  x : REAL;\nEND_VAR\nVAR_OUTPUT\n  y : REAL;\nEND_VAR\n\
         FUZZIFY x\n  TERM low := (0, 1) (10, 0);\n  TERM high := (0, 0) (10, 1);\nEND_FUZZIFY\n\
         DEFUZZIFY y\n  RANGE := (0 .. 30);\n  TERM line := FUNCTION 2 * x + 1;\n  TERM flat := 3;\n  METHOD : COGS;\n  {accu}\nEND_DEFUZZIFY\n\
         RULEBLOCK r\n  RULE 1 : IF x IS low THEN y IS line;\n  RULE 2 : IF x IS high THEN y IS line;\n  \
         RULE 3 : IF x IS high THEN y IS flat{end}\nEND_RULEBLOCK\nEND_FUNCTION_BLOCK\n"
    )
}

#[test]
fn rules_that_an_fcl_joins_are_a_loss_where_values_are_computed() {
    let read = |accu: &str, end: &str| {
        flagred_interchange::read(&twice(accu, end), Format::Fcl, Losses::Refuse)
    };
    // The default is MAX, and NONE in fuzzylite's dialect, which has no `;` after a rule.
    for (accu, end) in [("ACCU : MAX;", ";"), ("", ";"), ("ACCU : BSUM;", "")] {
        let findings = read(accu, end).unwrap_err();
        let reported = findings.0.iter().any(|finding| finding.code == "joined");
        assert!(reported, "{accu}: {findings}");
    }
    for (accu, end) in [("ACCU : SUM;", ";"), ("ACCU : NONE;", ";"), ("", "")] {
        let document = read(accu, end).unwrap_or_else(|findings| panic!("{accu}: {findings}"));
        let engine = fuzzy::Engine::new(&document.model).unwrap();
        // 0.6 * 9 + 0.4 * 9 + 0.4 * 3, over 1.4
        let value = engine.evaluate(&[4.0]).unwrap()[0].value().unwrap();
        assert!((value - 10.2 / 1.4).abs() < 1e-12, "{accu}: {value}");
    }
    let text =
        twice("ACCU : MAX;", ";").replace("x IS high THEN y IS line", "x IS high THEN y IS flat");
    let text = text.replace("  RULE 3 : IF x IS high THEN y IS flat;\n", "");
    assert!(
        flagred_interchange::read(&text, Format::Fcl, Losses::Refuse).is_ok(),
        "{text}"
    );
}

#[test]
fn one_function_block_of_several_is_read_by_its_name() {
    let text = twice("ACCU : SUM;", ";") + FCL;
    let findings = flagred_interchange::read(&text, Format::Fcl, Losses::Refuse).unwrap_err();
    assert_eq!(findings.0[0].code, "several-blocks");
    assert_eq!(
        findings.0[0].message,
        "the file has the function blocks `twice`, `crane`"
    );
    for name in ["twice", "crane"] {
        let document = flagred_interchange::read_block(&text, name, Losses::Refuse).unwrap();
        assert_eq!(document.model.name, name);
        assert!(!document.model.rules.is_empty());
    }
    let findings = flagred_interchange::read_block(&text, "twise", Losses::Refuse).unwrap_err();
    assert_eq!(findings.0[0].code, "unknown-block");
    assert_eq!(findings.0[0].help.as_deref(), Some("did you mean `twice`?"));
}

/// A file that ends within a section lacks rules or terms; the rest by itself would be a different rule set.
#[test]
fn an_fcl_that_is_cut_off_is_refused() {
    let lines: Vec<&str> = FCL.lines().collect();
    for length in 1..lines.len() {
        let text = lines[..length].join("\n");
        let found = flagred_interchange::read(&text, Format::Fcl, Losses::Accept).unwrap_err();
        let is_cut_off = |message: &str| message.contains("the file ends");
        assert!(
            found.0.iter().any(|finding| is_cut_off(&finding.message)),
            "{text}\n{found}"
        );
    }
}

#[test]
fn damaged_texts_do_not_cause_a_panic() {
    damage(2_000);
}

#[test]
#[ignore = "takes half a minute"]
fn twenty_thousand_damaged_texts_of_each_format_do_not_cause_a_panic() {
    damage(20_000);
}

/// Bytes of each text are replaced, duplicated, removed and swapped.
fn damage(rounds: usize) {
    let mut state = 7_u64;
    let mut random = move |below: usize| {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % below.max(1)
    };
    let pieces = [
        "", "(", ")", ";", ":=", "..", "-", "1e999", "'", "\"", "<", "/>", "[", "\n", "if", "not",
        "\u{e4}", "RULE", "END",
    ];
    let mut readable = 0;
    for (format, text) in TEXTS {
        for _ in 0..rounds {
            let mut damaged = text.to_owned();
            for _ in 0..=random(3) {
                let places: Vec<usize> = damaged.char_indices().map(|(at, _)| at).collect();
                let (a, b) = (random(places.len()), random(places.len()));
                let (start, end) = (
                    places[a.min(b)],
                    places[a.max(b)].min(places[a.min(b)] + random(40)),
                );
                let end = (start..=end)
                    .rev()
                    .find(|&at| damaged.is_char_boundary(at))
                    .unwrap_or(start);
                let piece = match random(3) {
                    0 => damaged[start..end].repeat(2),
                    _ => pieces[random(pieces.len())].to_owned(),
                };
                damaged.replace_range(start..end, &piece);
            }
            for losses in [Losses::Refuse, Losses::Accept] {
                let Ok(document) = flagred_interchange::read(&damaged, format, losses) else {
                    continue;
                };
                readable += 1;
                for format in Format::ALL {
                    let _ = flagred_interchange::write(&document.model, format, losses);
                }
            }
            let _ = Format::of(&damaged);
        }
    }
    assert!(readable > 1_000, "{readable}");
}

/// The findings of a text, by code, and whether it can be read.
fn codes(text: &str, format: Format) -> (bool, Vec<&'static str>) {
    match flagred_interchange::read(text, format, Losses::Refuse) {
        Ok(document) => (true, document.warnings.0.iter().map(|f| f.code).collect()),
        Err(findings) => (false, findings.0.iter().map(|f| f.code).collect()),
    }
}

#[test]
fn a_fis_with_fewer_parts_than_declared_has_a_warning() {
    assert_eq!(codes(FIS, Format::Fis), (true, vec![]));
    for (before, after) in [
        ("NumRules=2", "NumRules=3"),
        ("2 0, 2 (0.5) : 1\n", ""),
        ("[Rules]\n", "[Rules]\n1 1, 1 (1) : 1\n"),
        ("NumMFs=1", "NumMFs=2"),
        ("NumInputs=2", "NumInputs=3"),
        ("NumOutputs=1", "NumOutputs=two"),
    ] {
        let text = FIS.replace(before, after);
        assert_eq!(
            codes(&text, Format::Fis),
            (true, vec!["wrong-count"]),
            "{after}"
        );
    }
    // A file without its rules is an error.
    let cut = FIS.split("[Rules]").next().unwrap();
    assert_eq!(codes(cut, Format::Fis), (false, vec!["wrong-count"]));
}

#[test]
fn a_fis_may_contain_arithmetic_with_numbers_and_pi() {
    let text = FIS.replace("Range=[0 10]\nNumMFs=2", "Range=[-pi/4 3*(pi-1)]\nNumMFs=2");
    let text = text.replace("[1.5 0]", "[1/2 -2*pi]");
    let model = flagred_interchange::read(&text, Format::Fis, Losses::Refuse)
        .unwrap()
        .model;
    use std::f64::consts::PI;
    assert_eq!(
        (model.inputs[0].low, model.inputs[0].high),
        (-PI / 4.0, 3.0 * (PI - 1.0))
    );
    let fuzzy::model::MembershipFunction::Gaussian { mean, sd } =
        model.inputs[0].terms[0].membership_function
    else {
        panic!("{model:?}")
    };
    assert_eq!((mean, sd), (-2.0 * PI, 0.5));
    for wrong in [
        "[1.5 pie]",
        "[1.5 1/0]",
        "[1.5 sin(1)]",
        "[1.5 2^3]",
        "[1.5 pi/]",
        "[1.5 ()]",
    ] {
        let (is_read, codes) = codes(&FIS.replace("[1.5 0]", wrong), Format::Fis);
        assert_eq!((is_read, codes), (false, vec!["not-a-number"]), "{wrong}");
    }
}

#[test]
fn octaves_cube_is_read_where_a_product_equals_it() {
    let values = |rule: &str, and: &str| {
        let text = FIS.replace("1 -1, 1 (1) : 2", rule).replace("'prod'", and);
        let document = flagred_interchange::read(&text, Format::Fis, Losses::Refuse)?;
        let engine = fuzzy::Engine::new(&document.model)?;
        let explanation = engine.explain(&[1.0, 2.0]).unwrap();
        let first = explanation.rules.iter().find(|rule| rule.rule == 0);
        Ok::<_, fuzzy::Findings>(first.unwrap().strength)
    };
    let gauss = (-0.5 * (1.0_f64 / 1.5).powi(2)).exp();
    for (rule, expected) in [
        ("1.3 0, 1 (1) : 1", gauss.powi(3)),
        ("-1.30 0, 1 (1) : 1", 1.0 - gauss.powi(3)),
        // `bad` has the degree 0.5 at 2.
        ("1.3 1.3, 1 (1) : 1", gauss.powi(3) * 0.125),
        (
            "1.3 1.3, 1 (1) : 2",
            gauss.powi(3) + 0.125 - gauss.powi(3) * 0.125,
        ),
    ] {
        let strength = values(rule, "'prod'").unwrap();
        assert!(
            (strength - expected).abs() < 1e-15,
            "{rule}: {strength} {expected}"
        );
    }
    let findings = values("1.3 0, 1 (1) : 1", "'min'").unwrap_err();
    assert_eq!(findings.0[0].code, "unknown-hedge");
}

#[test]
fn numbers_in_rules_of_a_fis_name_a_term_or_are_0() {
    for (word, is_read) in [
        ("0.0", true),
        ("-0", true),
        ("NaN", false),
        ("inf", false),
        ("-inf", false),
        ("0.5", false),
        ("-0.2", false),
        ("1e300", false),
    ] {
        let rule = format!("{word} 1, 1 (1) : 1");
        let text = FIS.replace("1 -1, 1 (1) : 2", &rule);
        let (found, codes) = codes(&text, Format::Fis);
        assert_eq!(found, is_read, "{word}: {codes:?}");
        assert!(is_read || codes == ["unknown-term"], "{word}: {codes:?}");
    }
}

#[test]
fn only_an_outer_side_of_a_shape_may_be_infinite() {
    let fll = |shape: &str| codes(&FLL.replace("Ramp 20 10", shape), Format::Fll);
    for open in [
        "Triangle -inf 5 9",
        "Triangle 1 5 inf",
        "Trapezoid -inf 2 5 9",
        "Trapezoid -inf -inf 5 9",
        "Trapezoid 1 5 9 inf",
        "Trapezoid 1 5 inf inf",
        "Trapezoid 1 5 9 inf 0.5",
        "Binary 5 inf",
        "Binary 5 -inf",
    ] {
        assert_eq!(fll(open), (true, vec![]), "{open}");
    }
    for wrong in [
        "Triangle nan 1 1.5",
        "Triangle 0 nan 1",
        "Triangle 0 1 nan",
        "Triangle inf 0 1",
        "Triangle 0 1 -inf",
        "Triangle -inf 1 inf",
        "Trapezoid 0 1 2 nan",
        "Trapezoid nan 1 2 3",
        "Trapezoid -inf nan 2 3",
        "Trapezoid -inf 1 inf 3",
        "Trapezoid 0 inf 2 3",
        "Rectangle -inf 3",
        "Ramp inf 3",
        "Ramp nan 3",
        "Gaussian nan 1",
        "Sigmoid 1 inf",
        "SShape 1 nan",
        "PiShape -inf 1 2 3",
    ] {
        assert_eq!(fll(wrong), (false, vec!["not-finite"]), "{wrong}");
    }
    assert_eq!(fll("Binary 5 nan"), (false, vec!["parameter-count"]));
    assert_eq!(fll("Binary nan inf"), (false, vec!["parameter-count"]));
    let fis = |shape: &str| codes(&FIS.replace("'trapmf',[-1 0 1 3]", shape), Format::Fis);
    assert_eq!(fis("'trapmf',[-Inf -Inf 1 3]"), (true, vec![]));
    assert_eq!(fis("'trapmf',[-1 0 1 NaN]"), (false, vec!["not-finite"]));
    // Other invalid numbers are reported by the reader or, at the latest, when the rule set is used.
    for (text, format) in [
        (FLL.replace("Discrete 5 0", "Discrete nan 0"), Format::Fll),
        (FLL.replace("with 0.5", "with nan"), Format::Fll),
        (FLL.replace("5 0.5", "5 nan"), Format::Fll),
        (FLL.replace("default: 4.5", "default: inf"), Format::Fll),
        (FLL.replace("range: 0 40", "range: 0 inf"), Format::Fll),
        (
            FLL.replace("activation: General", "activation: Threshold >= nan"),
            Format::Fll,
        ),
        (
            FIS.replace("'constant',[5]", "'constant',[NaN]"),
            Format::Fis,
        ),
        (FIS.replace("[1 2 3]", "[1 -Inf 3]"), Format::Fis),
        (FCL.replace("(10, 0)", "(10, nan)"), Format::Fcl),
        (FCL.replace("low := -12", "low := nan"), Format::Fcl),
        (FML.replace("param2=\"2\"", "param2=\"NaN\""), Format::Fml),
        (
            FML.replace("defaultValue=\"0\"", "defaultValue=\"NaN\""),
            Format::Fml,
        ),
    ] {
        let is_used = flagred_interchange::read(&text, format, Losses::Refuse)
            .is_ok_and(|document| fuzzy::Engine::new(&document.model).is_ok());
        assert!(!is_used, "{text}");
    }
}

#[test]
fn a_flag_of_an_fll_is_true_or_false() {
    for (before, after) in [
        ("  range: 0 40", "  range: 0 40\n  lock-range: falsch"),
        ("  range: 0 9", "  range: 0 9\n  lock-range: falsch"),
        ("  range: 0 9", "  range: 0 9\n  lock-previous: 1"),
        (
            "  range: 0 9",
            "  range: 0 9\n  lock-previous: true\n  lock-valid: falsch",
        ),
        ("  range: 0 9", "  range: 0 9\n  enabled: yes"),
    ] {
        let found = codes(&FLL.replace(before, after), Format::Fll);
        assert_eq!(found, (false, vec!["not-a-flag"]), "{after}");
    }
}

#[test]
fn maxima_without_a_firing_rule_have_no_value_unless_a_default_is_written() {
    for method in [
        "SmallestOfMaximum",
        "MeanOfMaximum",
        "LargestOfMaximum",
        "Centroid",
        "Bisector",
    ] {
        for (default, expected) in [
            ("default: nan", None),
            ("default: 4.5", Some(4.5)),
            ("", None),
        ] {
            let text = FLL
                .replace("Centroid", method)
                .replace("default: 4.5", default)
                .replace("  rule: if heat is any then speed is fast with 0.5\n", "")
                .replace(
                    "heat is low or (heat is very high and heat is not low)",
                    "heat is low",
                );
            let model = flagred_interchange::read(&text, Format::Fll, Losses::Refuse)
                .unwrap()
                .model;
            let value = |model: &fuzzy::Model| {
                fuzzy::Engine::new(model)
                    .unwrap()
                    .evaluate(&[30.0])
                    .unwrap()[0]
                    .value()
            };
            assert_eq!(value(&model), expected, "{method} {default}");
            let written = flagred_interchange::write(&model, Format::Fll, Losses::Refuse).unwrap();
            let again =
                flagred_interchange::read(&written.text, Format::Fll, Losses::Refuse).unwrap();
            assert_eq!(value(&again.model), expected, "{method} {default}");
        }
    }
}
