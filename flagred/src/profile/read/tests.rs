use super::*;
use crate::{
    profile::{ErrorFrequency, Reliability},
    source::{Motors, Signal, Source, Statistic},
    verdict::{LevelSettings, Limit, NoticeSettings, Threshold, VerdictSettings},
};

const START: &str =
    "flagred: 1\nname: test\nrules: test\ninputs:\n  margin: {mean: motor_margin}\n";

#[test]
fn missing_settings_of_a_profile_have_defaults() {
    let profile = START.parse::<Profile>().unwrap();
    assert_eq!(profile.output, "risk");
    assert_eq!(profile.inputs[0].source.window_s, WINDOW_S);
    assert_eq!(profile.sampling, Sampling::default());
    assert_eq!(profile.gap, GapSettings::default());
    assert_eq!(profile.elevated_risk, AccumulatorSettings::default());
    assert_eq!(profile.verdict, VerdictSettings::default());
}

#[test]
fn every_setting_is_read() {
    let profile = "
flagred: 1
name: all
description: everything set
rules: some.yaml
output: danger
window_s: 3
min_samples: 7
warm_up_s: 0.5
longest_gap_s: 4
take_off_s: 2.5
inputs:
  a: {std: {std: motor_command}, window_s: 30}
  b: {share_below: 0.02, of: {min: motor_margin}}
  c: {share_above: 0.9, of: battery_v, window_s: 1}
  d: {last: battery_v, if_missing: 14}
  e: {rms: motor_margin_high_side}
  f: {std_less_noise: {std: motor_command_less_yaw}}
  g: {noise: roll_effort}
  h: {mean: command_noise}
  i: {mean: {motor: 3, of: motor_margin}}
  j: {rms: {difference: [yaw_des_deg, yaw_deg]}}
  k: {rate: battery_v}
  l: {percentile: 90, of: {max: motor_command}}
  m: {median: battery_v, window_s: 8}
  n: {mean: battery_v, time_constant_s: 7}
  o: {mean: {ratio: [battery_a, battery_v], unknown_below: 5}}
  p: {max: {product: [battery_a, battery_v]}}
gap: {method: {inverse_distance: {power: 3, neighbours: 4}}, coverage_below: 0.25}
elevated_risk: {window_s: 5, high: 80, low: 20, rise_per_s: 30, fall_per_s: 3}
verdict:
  warn: {risk: 60, elevated_risk: 40, after_s: 1, until: {risk: 50}}
  fail: {risk: 95, after_s: 2}
  clear_after_s: 2
  quiet_after_take_off_s: 3
  quiet_before_landing_s: 4
  idle_below: 0.2
  noise: {above: 0.04, after_s: 10}
  reserve: {below: 0.1, after_s: 3}
  imbalance: {above: 0.25}
other_risks:
  tip_over: {warn: {risk: 30}, elevated_risk: {high: 60}}
findings:
  d: {code: low_battery, brief: low battery, text: 'The battery had {value} V, or {percent} %.', advice: Land.}
reliability:
  - {risk: [0, 50], real: {moments: 10, followed: 3}}
  - {risk: [50, 100], simulated: {moments: 7, followed: 7}}
"
    .parse::<Profile>()
    .unwrap();
    assert_eq!(profile.description.as_deref(), Some("everything set"));
    assert_eq!(
        (profile.rules.as_str(), profile.output.as_str()),
        ("some.yaml", "danger")
    );
    assert_eq!(
        profile.sampling,
        Sampling {
            min_samples: 7,
            warm_up_s: 0.5,
            longest_gap_s: 4.0,
            take_off_s: 2.5,
        }
    );
    let source = |statistic, motors, signal: &str, window_s| Source {
        statistic,
        motors,
        signal: Signal::named(signal),
        window_s,
        exponential: false,
    };
    let missing = profile.inputs.iter().filter_map(|input| input.if_missing);
    assert_eq!(missing.collect::<Vec<f64>>(), [14.0]);
    assert_eq!(profile.inputs[3].if_missing, Some(14.0));
    let sources: Vec<&Source> = profile.inputs.iter().map(|i| &i.source).collect();
    assert_eq!(
        sources,
        [
            &source(Statistic::Std, Motors::Std, "motor_command", 30.0),
            &source(
                Statistic::ShareBelow(0.02),
                Motors::Min,
                "motor_margin",
                3.0
            ),
            &source(Statistic::ShareAbove(0.9), Motors::Pooled, "battery_v", 1.0),
            &source(Statistic::Last, Motors::Pooled, "battery_v", 3.0),
            &source(
                Statistic::Rms,
                Motors::Pooled,
                "motor_margin_high_side",
                3.0
            ),
            &source(
                Statistic::StdLessNoise,
                Motors::Std,
                "motor_command_less_yaw",
                3.0
            ),
            &source(Statistic::Noise, Motors::Pooled, "roll_effort", 3.0),
            &source(Statistic::Mean, Motors::Pooled, "command_noise", 3.0),
            &source(Statistic::Mean, Motors::One(2), "motor_margin", 3.0),
            &Source {
                signal: Signal::Difference {
                    a: "yaw_des_deg".into(),
                    b: "yaw_deg".into(),
                },
                ..source(Statistic::Rms, Motors::Pooled, "", 3.0)
            },
            &source(Statistic::Rate, Motors::Pooled, "battery_v", 3.0),
            &source(
                Statistic::Percentile(90.0),
                Motors::Max,
                "motor_command",
                3.0
            ),
            &source(
                Statistic::Percentile(50.0),
                Motors::Pooled,
                "battery_v",
                8.0
            ),
            &Source {
                exponential: true,
                ..source(Statistic::Mean, Motors::Pooled, "battery_v", 7.0)
            },
            &Source {
                signal: Signal::Ratio {
                    a: "battery_a".into(),
                    b: "battery_v".into(),
                    unknown_below: 5.0,
                },
                ..source(Statistic::Mean, Motors::Pooled, "", 3.0)
            },
            &Source {
                signal: Signal::Product {
                    a: "battery_a".into(),
                    b: "battery_v".into(),
                },
                ..source(Statistic::Max, Motors::Pooled, "", 3.0)
            },
        ]
    );
    assert_eq!(
        profile.gap.method,
        GapMethod::InverseDistance {
            power: 3.0,
            neighbours: 4
        }
    );
    assert_eq!(profile.gap.coverage_below, Some(0.25));
    assert_eq!(profile.elevated_risk.window_s, 5.0);
    assert_eq!(profile.elevated_risk.high_pct, 80.0);
    assert_eq!(profile.elevated_risk.low_pct, 20.0);
    assert_eq!(profile.elevated_risk.rise_pct_per_s, 30.0);
    assert_eq!(profile.elevated_risk.fall_pct_per_s, 3.0);
    // Settings that another risk omits default to those of the first risk.
    let [other] = profile.other_risks.as_slice() else {
        panic!("{:?}", profile.other_risks)
    };
    assert_eq!(other.output, "tip_over");
    assert_eq!(other.fail, profile.verdict.fail);
    assert_eq!(other.warn.raise.risk_pct, Some(30.0));
    assert_eq!(
        other.elevated_risk,
        AccumulatorSettings {
            high_pct: 60.0,
            ..profile.elevated_risk
        }
    );
    let [words] = profile.findings.as_slice() else {
        panic!("{:?}", profile.findings)
    };
    assert_eq!(
        [&words.input, &words.code, &words.brief, &words.advice],
        ["d", "low_battery", "low battery", "Land."]
    );
    assert_eq!(words.text, "The battery had {value} V, or {percent} %.");
    let counts = |moments, followed| Some(ErrorFrequency { moments, followed });
    assert_eq!(
        profile.reliability,
        [
            Reliability {
                from_pct: 0.0,
                to_pct: 50.0,
                real: counts(10, 3),
                simulated: None,
            },
            Reliability {
                from_pct: 50.0,
                to_pct: 100.0,
                real: None,
                simulated: counts(7, 7),
            }
        ]
    );
    assert_eq!(counts(10, 3).unwrap().share_pct(), Some(30.0));
    assert_eq!(counts(0, 0).unwrap().share_pct(), None);
    let threshold = |risk_pct, elevated_risk_pct| Threshold {
        risk_pct,
        elevated_risk_pct,
    };
    let limit = |value, after_s| Some(Limit { value, after_s });
    assert_eq!(
        profile.verdict,
        VerdictSettings {
            warn: LevelSettings {
                raise: threshold(Some(60.0), Some(40.0)),
                after_s: 1.0,
                until: threshold(Some(50.0), None),
            },
            fail: LevelSettings {
                raise: threshold(Some(95.0), None),
                after_s: 2.0,
                until: threshold(Some(95.0), None),
            },
            clear_after_s: 2.0,
            quiet_after_take_off_s: 3.0,
            quiet_before_landing_s: 4.0,
            idle_below: 0.2,
            notices: NoticeSettings {
                noise: limit(0.04, 10.0),
                reserve: limit(0.1, 3.0),
                imbalance: limit(0.25, 0.0),
            },
        }
    );
}

#[test]
fn all_mistakes_are_reported_at_once_with_their_positions() {
    let text = "flagred: 1
name: wrong
rules: flagred-paper
window: 2
min_samples: none
inputs:
  margin: {meen: motor_margin}
  spread: {std: motor_command, mean: motor_command}
  lowest: {mean: {least: motor_margin}}
  battery: {mean: {min: battery_v}}
  share: {share_below: 0.1}
  mean: {mean: motor_margin, of: motor_margin, window_s: -1}
  mean: {mean: motor_margin}
gap: {method: neerest, coverage_below: -1}
elevated_risk: {high: 20, low: 80, rise_per_s: fast}
verdict: {warn: {risk: 50, until: {risk: 60}}, fail: {risk: 150}, clear_after_s: .nan}
";
    let findings = text.parse::<Profile>().unwrap_err();
    insta::assert_snapshot!(findings);
}

#[test]
fn mistakes_in_statistics_without_noise_and_in_notices_are_reported() {
    let text = "flagred: 1
name: wrong
rules: flagred
take_off_s: -1
inputs:
  pooled: {std_less_noise: motor_command}
  noise: {noise: motor_margin}
  battery: {std_less_noise: {std: battery_v}}
  both: {std_less_noise: {std: motor_command}, noise: {std: motor_command}}
verdict:
  idle_below: low
  noise: 0.04
  reserve: {above: 0.1}
  imbalance: {above: 0.25, after_s: -3}
";
    let findings = text.parse::<Profile>().unwrap_err();
    insta::assert_snapshot!(findings);
}

#[test]
fn mistakes_in_signals_are_reported() {
    let text = "flagred: 1
name: wrong
rules: flagred
inputs:
  zero: {mean: {motor: 0, of: motor_margin}}
  alone: {mean: {motor: 2}}
  one: {mean: {motor: 1, of: battery_v}}
  both: {mean: {motor: 1, min: motor_margin}}
  three: {mean: {difference: [roll_deg, pitch_deg, yaw_deg]}}
  motors: {mean: {difference: [motor_command, motor_margin]}}
  parts: {mean: {ratio: [battery_a]}}
  power: {mean: {product: [battery_a, motor_command]}}
  floor: {mean: {product: [battery_a, battery_v], unknown_below: 1}}
  below: {mean: {ratio: [battery_a, battery_v], unknown_below: -1}}
  other: {mean: {ratio: [battery_a, battery_v], at_least: 1}}
  pooled: {rate: motor_command}
  most: {percentile: 101, of: battery_v}
  whose: {percentile: 90}
  medians: {median: motor_margin}
  two: {mean: battery_v, window_s: 1, time_constant_s: 5}
  weightless: {max: battery_v, time_constant_s: 5}
  constant: {mean: battery_v, time_constant_s: 0}
  engine: {mean: motor_margin, if_missing: 0.2}
  full: {last: battery_v, if_missing: full}
  number: {last: 5}
  divided: {last: battery_a / battery_v}
  doubled: {mean: {product: [battery_v, 2]}}
  whole: {percentile: battery_v}
  average: {average: battery_v}
  reversed: {battery_v: mean}
  spread: {mean: {median: motor_margin}}
  share: {share_below: battery_v, of: 12}
  bare: motor_margin
  called: std(motor_command)
  default: {last: battery_v, default: 12}
verdict:
  idle_below: 10
  reserve: {below: 15}
  noise: 0.08
  imbalance: {below: 0.1}
  warn: {risk: 0.6, until: {risk: 25}}
  fail: 70
gap: nearest
reliability: {risk: [60, 80]}
min_samples: 2.5
other_risks:
  risk: {}
  other: {verdict: {}, warn: {risk: 120}}
";
    let findings = text.parse::<Profile>().unwrap_err();
    insta::assert_snapshot!(findings);
}

#[test]
fn mistakes_in_ratios_are_reported() {
    let text = "flagred: 1
name: wrong
rules: flagred
inputs:
  room: {mean: {min: motor_margin_high_side}}
  good: {std: motor_command, per: room, at_least: 0.02}
  nobody: {std: motor_command, per: rom, at_least: 0.02}
  itself: {std: motor_command, per: itself, at_least: 0.02}
  again: {std: motor_command, per: good, at_least: 0.02}
  bottomless: {std: motor_command, per: room}
  undivided: {std: motor_command, at_least: 0.02}
  flat: {std: motor_command, per: room, at_least: 0}
";
    let findings = text.parse::<Profile>().unwrap_err();
    insta::assert_snapshot!(findings);
}

#[test]
fn words_in_place_of_numbers_and_missing_sources_are_reported() {
    let found = |replaced: &str, by: &str| {
        let text = format!(
            "{START}verdict: {{warn: {{risk: 60}}}}\nfindings:\n  margin: {{code: a, brief: a, text: a, advice: a}}\n"
        );
        let text = text.replace(replaced, by);
        text.parse::<Profile>().unwrap_err().to_string()
    };
    insta::assert_snapshot!(
        [
            ("risk: 60", "risk: high"),
            ("  margin: {code", "  spread: {code"),
            ("  margin: {code", "  margn: {code"),
            ("{mean: motor_margin}", "{motor: 1, of: motor_command}"),
        ]
        .map(|(replaced, by)| found(replaced, by))
        .join("\n")
    );
}

#[test]
fn mistakes_in_words_and_reliability_are_reported() {
    let text = "flagred: 1
name: wrong
rules: flagred
inputs:
  battery: {last: battery_v}
findings:
  batery: {code: low_battery, brief: low battery, text: Low., advice: Land.}
  battery:
    code: Low battery
    brief: the battery is nearly empty
    text: '{percent} % or {volts} V'
reliability:
  - {risk: [60, 80], real: {moments: 3, followed: 4}}
  - {risk: [50, 120], simulated: {moments: 3}}
  - {risk: 80}
  - {real: {moments: 3, followed: 1}}
";
    let findings = text.parse::<Profile>().unwrap_err();
    insta::assert_snapshot!(findings);
}

#[test]
fn a_file_that_is_not_a_profile_is_refused() {
    for (text, expected) in [
        ("", "the file is empty"),
        ("[1, 2]", "expected a profile, found a list"),
        ("name: x", "the profile has no key `flagred`"),
        (
            "flagred: 2\nname: x\nrules: y\ninputs: {a: {last: b}}",
            "version 1 only",
        ),
        ("flagred: 1\nname: [", "the bracket `[` is never closed"),
    ] {
        let message = text.parse::<Profile>().unwrap_err().to_string();
        assert!(message.contains(expected), "{text:?}: {message}");
    }
}
