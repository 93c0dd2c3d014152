use super::*;
use crate::verdict::Level;

const RULES: &str = "
fuzzy: 1
name: rules
inputs:
  margin: {range: [0, 0.5], partition: [low, high]}
  battery: {range: [0, 100], unit: '%', partition: [empty, full]}
outputs:
  risk: {range: [0, 100], partition: [low, medium, high]}
rules:
  - IF margin IS low OR battery IS empty THEN risk IS high
  - IF margin IS high AND battery IS full THEN risk IS low
";

const PROFILE: &str = "flagred: 1
name: mine
rules: rules.yaml
inputs:
  margin: {mean: motor_margin}
  battery: {last: battery_remaining_pct}
verdict:
  warn: {risk: 60, until: {risk: 30}}
  fail: {risk: 80}
";

const SIGNALS: [(&str, &str); 4] = [
    ("battery_v", "V"),
    ("battery_remaining_pct", "%"),
    ("roll_des_deg", "deg"),
    ("roll_deg", "deg"),
];

/// Checks the text of a profile against the text of a rule set.
fn fit(text: &str, rules: &str) -> (Findings, Option<Estimator>) {
    profile(
        &fuzzy::Source::new(text),
        &fuzzy::Source::new(rules),
        &SIGNALS,
    )
}

/// The findings after a part of the profile or of the rule set is replaced: the text that each finding is about, and
/// the finding.
fn found(replaced: &str, by: &str) -> Vec<String> {
    let (text, model) = (PROFILE.replace(replaced, by), RULES.replace(replaced, by));
    assert_ne!((PROFILE, RULES), (text.as_str(), model.as_str()));
    let (findings, estimator) = fit(&text, &model);
    let is_error = |one: &Diagnostic| one.severity == Severity::Error;
    assert_eq!(estimator.is_none(), findings.0.iter().any(is_error));
    let shown = |one: &Diagnostic| format!("{}: {one}", &text[one.span.clone()]);
    findings.0.iter().map(shown).collect()
}

#[test]
fn a_profile_that_fits_its_rule_set_has_no_finding() {
    let (findings, estimator) = fit(PROFILE, RULES);
    assert_eq!(findings.0, []);
    assert!(estimator.is_some());
    for (shipped, rules) in crate::shipped::PROFILES.iter().zip([0, 1, 2]) {
        let rules = crate::shipped::RULE_SETS[rules].text;
        let (findings, estimator) = fit(shipped.text, rules);
        assert_eq!(findings.0, [], "{}", shipped.name);
        assert!(estimator.is_some());
    }
}

#[test]
fn misfits_are_reported_at_their_positions() {
    let cases = [
        ("  battery: {last: battery_remaining_pct}\n", ""),
        ("  battery: {last", "  batery: {last"),
        ("rules: rules.yaml", "rules: rules.yaml\noutput: danger"),
        (
            "range: [0, 100], partition: [low",
            "range: [0, 1], partition: [low",
        ),
        (
            "range: [0, 100], partition: [low",
            "range: [0, 10], partition: [low",
        ),
        ("fail: {risk: 80}", "fail: {risk: 85}"),
        (
            "warn: {risk: 60, until: {risk: 30}}\n  fail: {risk: 80}",
            "warn: {risk: 84}\n  fail: {risk: 85}",
        ),
        ("warn: {risk: 60, until: {risk: 30}}", "warn: {risk: 82}"),
        ("warn: {risk: 60, until: {risk: 30}}", "warn: {risk: 15}"),
        ("until: {risk: 30}", "until: {risk: 10}"),
        (
            "verdict:",
            "elevated_risk: {rise_per_s: 0}\nverdict:\n  quiet_after_take_off_s: 3",
        ),
        (
            "fail: {risk: 80}",
            "fail: {elevated_risk: 80}\nelevated_risk: {rise_per_s: 0}",
        ),
        ("verdict:", "other_risks: {tip_over: {}}\nverdict:"),
        ("battery_remaining_pct", "battery_v"),
        ("battery_remaining_pct", "baterry_v"),
        ("battery_remaining_pct", "coffee_level"),
        (
            "{last: battery_remaining_pct}",
            "{last: {difference: [battery_remaining_pct, battery_v]}}",
        ),
        (
            "{last: battery_remaining_pct}",
            "{last: {difference: [tilt_deg, tilt]}}",
        ),
        (
            "{last: battery_remaining_pct}",
            "{last: {difference: [roll_des_deg, roll_deg]}}",
        ),
        (
            "{last: battery_remaining_pct}",
            "{last: {difference: [roll_des_deg, roll_degs]}}",
        ),
        (
            "{last: battery_remaining_pct}",
            "{share_above: 5, of: {difference: [roll_des_deg, roll_deg]}}",
        ),
        (
            "{last: battery_remaining_pct}",
            "{rate: battery_remaining_pct}",
        ),
        ("range: [0, 0.5]", "range: [0, 50]"),
        (
            "range: [0, 100], unit: '%', partition: [empty",
            "range: [0, 1], partition: [empty",
        ),
        ("mean: motor_margin", "mean: pwm1"),
        ("battery_remaining_pct", "roll"),
        ("warn: {risk: 60, until: {risk: 30}}", "warn: {risk: 0.6}"),
        ("fail: {risk: 80}", "fail: {risk: 80, after_s: 200}"),
        ("rules: rules.yaml", "rules: rules.yaml\nwindow_s: 3000"),
        (
            "rules: rules.yaml",
            "rules: rules.yaml\nlongest_gap_s: 2000\ntake_off_s: 300\nelevated_risk: {high: 0.5, low: 0.46}",
        ),
        (
            "verdict:",
            "verdict:\n  clear_after_s: 5000\n  quiet_after_take_off_s: 600",
        ),
        (
            "{mean: motor_margin}",
            "{mean: motor_margin, per: room, at_least: 2}\n  room: {mean: motor_command}",
        ),
        (
            "risk IS high\n  - IF margin IS high AND battery IS full THEN risk IS low",
            "risk IS high",
        ),
        (
            "IF margin IS low OR battery IS empty THEN risk IS high\n  - IF margin IS high AND battery IS full THEN risk IS low",
            "IF battery IS empty THEN risk IS high",
        ),
    ];
    let shown: Vec<String> = cases
        .iter()
        .map(|(replaced, by)| {
            let found = found(replaced, by);
            format!("# {replaced} -> {by}\n{}\n", found.join("\n"))
        })
        .collect();
    insta::assert_snapshot!(shown.join("\n"));
}

#[test]
fn a_mistake_in_the_profile_is_reported_first() {
    let (findings, estimator) = fit("flagred: 1\nname: x", RULES);
    assert!(estimator.is_none());
    assert!(findings.0.iter().all(|one| one.code == "missing-key"));
}

#[test]
fn the_levels_of_another_risk_are_checked_at_their_position() {
    let rules = RULES.replace(
        "rules:",
        "  tip_over: {range: [0, 100], partition: [low, medium, high]}\nrules:\n  - IF margin IS low THEN tip_over IS high\n  - IF margin IS high THEN tip_over IS low",
    );
    let text = format!("{PROFILE}other_risks:\n  tip_over:\n    fail: {{risk: 95}}\n");
    let (findings, estimator) = fit(&text, &rules);
    let [finding] = findings.0.as_slice() else {
        panic!("{findings}")
    };
    assert_eq!(
        (finding.code, &text[finding.span.clone()]),
        ("out-of-reach", "95")
    );
    assert_eq!(estimator.unwrap().others().len(), 1);
}

/// Tests the battery both as one more vote in the default rules, and as a risk of its own.
#[test]
fn an_input_that_raises_no_level_alone_is_reported_as_outvoted() {
    let rules = crate::shipped::RULE_SETS[0].text;
    let input = "inputs:\n  battery: {range: [0, 100], partition: {empty: 20, ok: 35}}\n";
    let rules = rules.replacen("inputs:\n", input, 1);
    let text = crate::shipped::PROFILES[0].text;
    let with =
        |signal: &str| text.replacen("inputs:\n", &format!("inputs:\n  battery: {signal}\n"), 1);
    let found = |rule: &str, signal: &str| {
        let rules = rules.replacen("\nrules:\n", &format!("\nrules:\n  - {rule}\n"), 1);
        let text = with(signal);
        let (_, estimator) = fit(&text, &rules);
        let estimator = estimator.unwrap();
        let reached = risks_of_single_inputs(&estimator)
            .into_iter()
            .find(|one| one.input == "battery");
        let reported = outvoted(&fuzzy::Source::new(&*text), &estimator, &SIGNALS).0;
        (
            reached.unwrap(),
            reported
                .iter()
                .map(|one| text[one.span.clone()].to_string())
                .collect::<Vec<_>>(),
        )
    };
    let vote = "IF battery IS empty THEN risk IS very_high";
    let (reached, reported) = found(vote, "{last: battery_remaining_pct}");
    // By hand: the battery votes for 95 with weight 1, other inputs for 5, 25 and 5 with weights 0.66, 0.33 and 0.66.
    let expected = (95.0 + 14.85) / (1.0 + 1.65);
    assert!((reached.risk_pct - expected).abs() < 1e-9, "{reached:?}");
    assert_eq!(
        (reached.value, reached.term.as_deref()),
        (0.0, Some("empty"))
    );
    assert_eq!(
        (reached.level, reported),
        (Level::Good, Vec::from(["battery".to_string()]))
    );
    // The signal is probably misspelt, so what the input can raise is unknown.
    assert_eq!(
        found(vote, "{last: battery_remaining_pc}").1,
        [] as [&str; 0]
    );
    // An input from the motors needs to contribute only a part of the risk, so it is not reported.
    assert_eq!(found(vote, "{mean: motor_command}").1, [] as [&str; 0]);

    let shipped = crate::shipped::flagred_battery();
    assert_eq!(
        outvoted(
            &fuzzy::Source::new(crate::shipped::PROFILES[2].text),
            &shipped,
            &SIGNALS
        )
        .0,
        []
    );
    let reached = risks_of_single_inputs(&shipped);
    let battery = reached.iter().find(|one| one.input == "battery").unwrap();
    assert_eq!(
        (
            battery.risk_output.as_str(),
            battery.level,
            battery.risk_pct
        ),
        ("battery_risk", Level::Fail, 100.0)
    );
}

#[test]
fn a_level_of_another_risk_without_elevated_risk_is_reported() {
    let rules = RULES.replace(
        "rules:\n  - IF margin",
        "  torn: {range: [0, 100], partition: [low, high]}\nrules:\n  - IF battery IS empty THEN torn IS high\n  - IF margin",
    );
    let warnings = |verdict: &str, other: &str| {
        let profile = PROFILE.replace("{risk: 60, until: {risk: 30}}", verdict);
        let text = format!("{profile}other_risks: {{torn: {other}}}\n");
        let (findings, _) = fit(&text, &rules);
        let mut shown: Vec<String> = findings.0.iter().map(|one| one.to_string()).collect();
        shown.retain(|one| one.contains("missing-threshold"));
        shown
    };
    let with = "{risk: 60, elevated_risk: 50}";
    let found = warnings(with, "{warn: {risk: 61}}");
    assert_eq!(found.len(), 1, "{found:?}");
    assert!(
        found[0].contains("`warn` has no `elevated_risk`, unlike `warn` in `verdict`")
            && found[0].contains("write `elevated_risk: 50`"),
        "{found:?}"
    );
    assert_eq!(warnings(with, "{}"), [""; 0]);
    assert_eq!(warnings("{risk: 60}", "{warn: {risk: 61}}"), [""; 0]);
}

#[test]
fn numbers_of_statistics_in_another_unit_are_reported() {
    let of = |source: &str| found("mean: motor_margin", source).join("");
    for (source, message) in [
        (
            "share_below: 6, of: motor_margin",
            "`motor_margin` is from 0 to 0.5, so it is always below 6",
        ),
        (
            "share_above: 95, of: motor_command",
            "`motor_command` is from 0 to 1, so it is never above 95",
        ),
        (
            "share_below: 0, of: motor_margin",
            "`motor_margin` is from 0 to 0.5, so it is never below 0",
        ),
        (
            "share_below: 0.2, of: battery_remaining_pct",
            "`battery_remaining_pct` is in percent, and 0.2 is a fraction",
        ),
        (
            "percentile: 0.9, of: battery_v",
            "`percentile` is in percent, and 0.9 is a fraction",
        ),
    ] {
        let found = of(source);
        assert!(found.contains(message), "{source}: {found}");
    }
    for (source, help) in [
        ("share_below: 6, of: motor_margin", "`share_below: 0.06`"),
        ("share_above: 95, of: motor_command", "`share_above: 0.95`"),
        ("percentile: 0.9, of: battery_v", "`percentile: 90`"),
        (
            "percentile: 0.9, of: motor_margin",
            "`{percentile: 90, of: {mean: motor_margin}}`",
        ),
    ] {
        let found = of(source);
        assert!(found.contains(help), "{source}: {found}");
    }
    for source in [
        "share_below: 0.06, of: motor_margin",
        "share_above: 0.95, of: motor_command",
        "share_above: 3.5, of: battery_v",
        "share_below: 20, of: battery_remaining_pct",
        "percentile: 90, of: battery_v",
    ] {
        assert_eq!(of(source), "", "{source}");
    }
}

#[test]
fn the_author_accepts_findings_by_code_and_name() {
    let rules = RULES.replace(
        "  - IF margin IS low OR battery IS empty THEN risk IS high",
        "  - IF margin IS low AND battery IS empty THEN risk IS high
  - IF margin IS low AND battery IS full THEN risk IS low
  - IF margin IS high AND battery IS empty THEN risk IS low",
    );
    let rules = fuzzy::Source::new(rules);
    let check = |allow: &str| {
        let source = fuzzy::Source::new(format!("{PROFILE}{allow}"));
        let (mut findings, estimator) = profile(&source, &rules, &SIGNALS);
        findings
            .0
            .extend(outvoted(&source, &estimator.unwrap(), &SIGNALS).0);
        let codes = findings.0.iter().map(|one| one.code);
        let counts = accepted(&source, &rules, &SIGNALS).into_iter();
        let counts: Vec<usize> = counts.map(|one| one.count).collect();
        (codes.collect::<Vec<_>>(), counts)
    };
    assert_eq!(check(""), (vec!["outvoted"], Vec::new()));
    let entry = "allow: [{finding: outvoted, of: battery, because: only together}]\n";
    assert_eq!(check(entry), (Vec::new(), vec![1]));
    // An entry of `allow` that accepts no finding is reported, and the findings that no entry accepts remain.
    let entries =
        "allow: [{finding: outvoted, of: margin, because: x}, {finding: unit, because: y}]\n";
    let all = vec!["unneeded-allow", "outvoted", "unneeded-allow"];
    assert_eq!(check(entries), (all, vec![0, 0]));
    let wrong = format!("{PROFILE}allow: [{{finding: jump, because: x}}]\n");
    let error = wrong.parse::<Profile>().unwrap_err().to_string();
    assert!(
        error.contains("entry 1 of `allow`: `jump` is not a warning or note of `check`"),
        "{error}"
    );
}

#[test]
fn an_input_without_an_effect_of_its_own_is_not_called_outweighed() {
    let rules = RULES.replace(
        "  - IF margin IS low OR battery IS empty THEN risk IS high",
        "  - IF margin IS low THEN risk IS high",
    );
    let rules = rules.replace(
        "margin IS high AND battery IS full",
        "margin IS high AND battery IS any",
    );
    let source = fuzzy::Source::new(PROFILE);
    let (_, estimator) = profile(&source, &fuzzy::Source::new(rules), &SIGNALS);
    let found = outvoted(&source, &estimator.unwrap(), &SIGNALS);
    let [finding] = found.0.as_slice() else {
        panic!("{found}");
    };
    assert!(
        finding
            .message
            .contains("at every value of it, below `warn` at 60"),
        "{found}"
    );
    let help = finding.help.as_deref().unwrap();
    assert!(
        help.starts_with("its rules need other inputs, too; if that is intended"),
        "{help}"
    );
}
