//! The exported script for ArduPilot, run by Lua 5.3 with 32-bit floats and integers, agrees with the monitor.

use flagred::{
    estimator::Estimator,
    flight::Assessor,
    monitor::{Craft, Monitor, Sample},
    verdict::Level,
};
use flagred_flightlog::Options;
use flagred_tests::{
    Folder,
    board::{PROFILES, estimator, logs},
    flagred,
};

use crate::autopilot::{Record, RecordOutput, Run, Vehicle, records, run};

/// The maximum difference of a risk, in percentage points.
const TOLERANCE_PCT: f64 = 0.1;

/// The monitor's result for the first sample with a known risk in each tenth of a second, which is what the script logs.
fn monitor_results(
    estimator: &Estimator,
    vehicle: &Vehicle,
    records: &[Record],
) -> Vec<RecordOutput> {
    let signals = estimator.profile().signals();
    let craft = Craft::new(vehicle.factors.len())
        .with_signals(&signals)
        .with_optional(&signals)
        .with_geometry(&vehicle.factors);
    let mut monitor = Monitor::new(estimator, craft).unwrap();
    let (mut output, mut bin) = (Vec::new(), None);
    for (i, record) in records.iter().enumerate() {
        let motors: Vec<f64> = record
            .pwm
            .iter()
            .map(|pwm| vehicle.effective(*pwm))
            .collect();
        let battery = signals.iter().map(|name| match *name {
            "battery_v" => 16.0 + record.battery_pct / 50.0,
            _ => record.battery_pct,
        });
        let battery: Vec<f64> = battery.collect();
        let t_us = record.t_us - records[0].t_us;
        let update = monitor.push(&Sample {
            t_s: t_us as f64 / 1e6,
            motors: &motors,
            in_air: Some(record.flying),
            signals: &battery,
        });
        if let (Ok(estimate), Some(elevated_pct)) = (update.risk, update.elevated_risk_pct)
            && bin != Some(t_us / 100_000)
        {
            bin = Some(t_us / 100_000);
            // The script does not report information, because it is not a warning.
            let level = update.level.filter(|level| *level > Level::Info);
            output.push((
                i,
                estimate.risk_pct,
                elevated_pct,
                level.unwrap_or(Level::Good),
            ));
        }
    }
    output
}

/// The largest differences of risk and elevated risk; levels must be equal.
fn differ(expected: &[RecordOutput], found: &[RecordOutput], what: &str) -> (f64, f64) {
    let at = |output: &[RecordOutput]| output.iter().map(|output| output.0).collect::<Vec<usize>>();
    assert_eq!(at(expected), at(found), "{what}: known at other times");
    let (mut risk, mut elevated, mut at_edge) = (0.0_f64, 0.0_f64, 0);
    for (expected, found) in expected.iter().zip(found) {
        assert_eq!(
            expected.3, found.3,
            "{what}: level at record {}, {expected:?} {found:?}",
            expected.0
        );
        let difference = (expected.1 - found.1).abs();
        // A sample that is exactly as old as the window is long may be inside the window for one clock and
        // outside for the other. One such difference is allowed.
        if difference > TOLERANCE_PCT && difference < 1.0 && at_edge == 0 {
            at_edge += 1;
        } else {
            risk = risk.max(difference);
        }
        elevated = elevated.max((expected.2 - found.2).abs());
    }
    (risk, elevated)
}

/// The script of a profile.
fn script(profile: &str, folder: &Folder) -> String {
    let file = folder.at("script.lua");
    let status = flagred()
        .args(["export", "--lua", profile, "--output", &file])
        .status();
    assert!(status.unwrap().success(), "{profile}");
    file
}

#[test]
fn the_script_agrees_with_the_monitor_on_every_flight() {
    let folder = Folder::new();
    for profile in PROFILES {
        let estimator = estimator(profile);
        let script = script(profile, &folder);
        for log in logs() {
            let flight = flagred_flightlog::open(&log, &Options::default()).unwrap();
            let (vehicle, records) = (Vehicle::of(&flight), records(&flight));
            let what = format!("{profile}, {}", log.display());
            let expected = monitor_results(&estimator, &vehicle, &records);
            assert!(expected.len() > 500, "{what}: {}", expected.len());
            let run = run(&script, &vehicle, &records, &[]);
            let (risk, elevated) = differ(&expected, &run.logged, &what);
            eprintln!(
                "{what}: {} risks, {risk:.4} %, elevated {elevated:.4} %, instructions {:?}, heap {:?}",
                expected.len(),
                run.instructions,
                run.heap
            );
            assert!(
                risk <= TOLERANCE_PCT && elevated <= TOLERANCE_PCT,
                "{what}: {risk} {elevated}"
            );
            run.assert_within_budget(&what);
            assert!(run.values > 100, "{what}: {}", run.values);
        }
    }
}

/// Three flights with all events, sampled 25 times a second. The first has a turn, gusts, and a motor that weakens
/// while another compensates for it; the second has a heavy load; in the third, the commands of two motors shift in
/// opposite directions, and the vehicle falls at the end.
fn eventful(vehicle: &Vehicle) -> Vec<Record> {
    let mut random = fastrand::Rng::with_seed(7);
    let mut records = Vec::new();
    for i in 0..10_000_u64 {
        let t_s = i as f64 * 0.04;
        let between = |from: f64, to: f64| (from..to).contains(&t_s);
        let flying = between(2.0, 250.0) || between(260.0, 320.0) || t_s > 330.0;
        let gust = match () {
            () if between(60.0, 90.0) => 0.08 * (2.0 * t_s).sin(),
            () if between(90.0, 100.0) => 0.6 * (1.3 * t_s).sin(),
            () => 0.0,
        };
        let hover = if between(290.0, 310.0) { 0.93 } else { 0.45 };
        let turn = if between(40.0, 50.0) { 0.1 } else { 0.0 };
        let weak = match () {
            () if between(140.0, 165.0) => 0.02 * (t_s - 140.0),
            () if between(360.0, 390.0) => 0.25,
            () => 0.0,
        };
        let factors = vehicle.factors.iter().zip(0..);
        let pwm = factors.map(|([roll, pitch, yaw], motor)| {
            let noise = 0.01 * (random.f64() - 0.5);
            let weak = match motor {
                2 => weak,
                3 => -weak,
                _ => 0.0,
            };
            let e = hover + gust * (0.7 * roll + 0.5 * pitch + 0.3) + turn * yaw + noise + weak;
            // A fall at the end.
            let e = if between(393.0, 399.0) { 0.03 } else { e };
            let e = if flying { e.clamp(0.0, 1.0) } else { 0.0 };
            let command = vehicle.spin.0 + e * (vehicle.spin.1 - vehicle.spin.0);
            (vehicle.pwm.0 + command * (vehicle.pwm.1 - vehicle.pwm.0)).round()
        });
        records.push(Record {
            pwm: pwm.collect(),
            // Calls are up to a millisecond late.
            t_us: i * 40_000 + random.u64(0..1000),
            flying,
            battery_pct: (100.0 - t_s / 4.0).round(),
        });
    }
    records
}

/// The messages of a flight according to the assessor's findings: time, level and cause.
fn assessor_messages(estimator: &Estimator, vehicle: &Vehicle, records: &[Record]) -> Vec<String> {
    let craft = Craft::new(vehicle.factors.len()).with_geometry(&vehicle.factors);
    let mut assessor = Assessor::new(estimator, craft, None).unwrap();
    let mut reported = Vec::new();
    for record in records {
        let pwm = record.pwm.iter();
        let motors: Vec<f64> = pwm.map(|pwm| vehicle.effective(*pwm)).collect();
        let update = assessor.push(&Sample {
            t_s: (record.t_us - records[0].t_us) as f64 / 1e6,
            motors: &motors,
            in_air: Some(record.flying),
            signals: &[],
        });
        if update.risk.is_err() {
            continue;
        }
        let notice = assessor.open_notice();
        let raised = notice.filter(|notice| notice.raised_s == update.t_s);
        let finding = match (update.change, &raised) {
            (Some(level), _) => assessor.open_finding().filter(|_| level > Level::Good),
            (None, _) => raised.clone(),
        };
        let level = update.change.or_else(|| raised.and(update.level));
        let Some(level) = level else { continue };
        let motor = finding.as_ref().and_then(|finding| finding.motor);
        let cause = finding.as_ref().and_then(|finding| finding.cause.as_ref());
        let about = match (motor, cause) {
            (Some(motor), Some(_)) => format!(", limit, motor {}", motor.number),
            (Some(motor), None) => format!(", motor {}", motor.number),
            (None, Some(_)) => {
                let words = finding.as_ref().map(|finding| finding.words(estimator));
                format!(", {}", words.unwrap().brief.concat())
            }
            (None, None) => String::new(),
        };
        reported.push(format!("{:.1} s {level}{about}", record.t_us as f64 / 1e6));
    }
    reported
}

/// Shortens a text such as `3.4 s, 4: FLAGRED: WARN risk 78 %, upper limit, motor 3` to `3.4 s WARN, limit, motor 3`.
fn in_short(line: &str) -> String {
    let (when, text) = line.split_once(" s, ").unwrap();
    let (_, text) = text.split_once("FLAGRED: ").unwrap();
    let (level, _) = text.split_once(' ').unwrap();
    let about = text
        .split_once(" %, ")
        .map(|(_, about)| format!(", {about}"));
    let weak = text.split_once(" weak: ");
    let weak = weak.and_then(|(before, _)| before.split_once(' '));
    let about = about.or(weak.map(|(_, motor)| format!(", {motor}")));
    let about = about.unwrap_or_default();
    let about = about.replace(", upper limit", ", limit");
    let about = about.replace(", lower limit", ", limit");
    format!("{when} s {level}{about}")
}

#[test]
fn the_script_reports_levels_and_causes_of_any_frame() {
    let folder = Folder::new();
    let estimator = estimator("flagred");
    let script = script("flagred", &folder);
    for name in ["QUAD/X", "OCTAQUAD/X", "DODECAHEXA/X"] {
        let vehicle = Vehicle::named(name);
        let records = eventful(&vehicle);
        let expected = monitor_results(&estimator, &vehicle, &records);
        let run = run(&script, &vehicle, &records, &[]);
        eprintln!(
            "{name}: instructions {:?}, heap {:?}\n{}",
            run.instructions, run.heap, run.texts
        );
        let (risk, elevated) = differ(&expected, &run.logged, name);
        assert!(
            risk <= TOLERANCE_PCT && elevated <= TOLERANCE_PCT,
            "{name}: {risk} {elevated}"
        );
        run.assert_within_budget(name);
        for level in [Level::Good, Level::Warn, Level::Fail] {
            assert!(
                expected.iter().any(|output| output.3 == level),
                "{name}: never {level}"
            );
        }
        // Without yaw and thrust, opposite motors of a quadrotor differ equally from their trims: either may be named.
        let either = |reported: String| match name {
            "QUAD/X" if !reported.contains("limit") => reported.replace("motor 3", "motor 4"),
            _ => reported,
        };
        let found = run.texts.lines().skip(1).map(in_short).map(either);
        let found: Vec<String> = found.collect();
        let reported = assessor_messages(&estimator, &vehicle, &records);
        let reported: Vec<String> = reported.into_iter().map(either).collect();
        assert_eq!(reported, found, "{name}");
        assert!(found.len() > 5, "{found:?}");
        if name == "QUAD/X" {
            insta::assert_snapshot!(run.texts);
        }
    }
}

#[test]
fn the_script_obeys_its_parameters_and_survives_an_error() {
    let folder = Folder::new();
    let script = script("flagred", &folder);
    let vehicle = Vehicle::named("QUAD/X");
    let records = &eventful(&vehicle)[..2000];
    let silent = run(&script, &vehicle, records, &["FRISK_ENABLE=0"]);
    assert_eq!((silent.logged.len(), silent.values), (0, 0));
    let warned = |run: &Run| {
        run.logged
            .iter()
            .filter(|output| output.3 > Level::Good)
            .count()
    };
    let usual = run(&script, &vehicle, records, &[]);
    let early = run(&script, &vehicle, records, &["FRISK_WARN=5"]);
    assert!(
        warned(&early) > warned(&usual) + 200,
        "{} {}",
        warned(&early),
        warned(&usual)
    );
    // The script runs to its end, so it does not block arming.
    let broken = run(&script, &vehicle, records, &["BROKEN=1"]);
    assert_eq!(broken.logged.len(), 0);
    let reported: Vec<&str> = broken.texts.lines().skip(1).collect();
    let [reported] = reported[..] else {
        panic!("{reported:?}")
    };
    assert!(reported.contains("FLAGRED failed: "), "{reported}");
    let other = Vehicle {
        frame: (99, 0),
        ..Vehicle::named("QUAD/X")
    };
    let unknown = run(&script, &other, records, &[]).texts;
    assert!(unknown.contains("frame unknown"), "{unknown}");
    let none = Vehicle {
        pwm: (0.0, 10.0),
        ..Vehicle::named("QUAD/X")
    };
    let none = run(&script, &none, records, &[]);
    assert!(
        none.texts.contains("no motors or no limits"),
        "{}",
        none.texts
    );
    assert_eq!((none.logged.len(), none.blocks), (0, None));
}

/// The motors without outputs may be at their limits.
#[test]
fn a_frame_with_more_motors_than_outputs_is_not_assessed() {
    let folder = Folder::new();
    let four = Vehicle::named("QUAD/X");
    let records = &eventful(&four)[..2000];
    for profile in ["flagred", "flagred-paper"] {
        let script = script(profile, &folder);
        let of = |frame| {
            let factors = four.factors.clone();
            let vehicle = Vehicle {
                frame,
                factors,
                ..Vehicle::named("QUAD/X")
            };
            run(&script, &vehicle, records, &[])
        };
        for (frame, motors) in [((2, 1), 6), ((5, 10), 6), ((12, 1), 12)] {
            let run = of(frame);
            let text =
                format!("start, 3: FLAGRED is off: only 4 of {motors} motors have outputs\n");
            assert_eq!(run.texts, text);
            assert_eq!((run.logged.len(), run.values, run.blocks), (0, 0, None));
        }
        assert!(of((1, 1)).logged.len() > 100);
        assert!(of((99, 1)).logged.len() > 100);
    }
}

/// With a heap of any size, the script either runs, or sends one text and ends. The vehicle can be armed in both cases.
#[test]
fn a_heap_that_is_too_small_does_not_block_arming() {
    const ENOUGH: u64 = 159_744;
    let folder = Folder::new();
    let script = script("flagred", &folder);
    let vehicle = Vehicle::named("OCTAQUAD/X");
    let records = &eventful(&vehicle)[..1500];
    let (mut off, mut flew) = (0, 0);
    for heap in (30_000..=166_000).step_by(2_000).chain([ENOUGH]) {
        let size = format!("SCR_HEAP_SIZE={heap}");
        let run = run(&script, &vehicle, records, &[&size]);
        assert_eq!(run.blocks, None, "{heap}");
        let texts: Vec<&str> = run.texts.lines().collect();
        if run.logged.is_empty() {
            assert_eq!(
                texts,
                ["start, 3: FLAGRED is off: increase SCR_HEAP_SIZE"],
                "{heap}"
            );
            assert!(heap < ENOUGH, "{heap}");
            off += 1;
        } else {
            assert!(!run.texts.contains("failed"), "{heap}: {}", run.texts);
            assert!(run.logged.len() > 400, "{heap}: {}", run.logged.len());
            flew += 1;
        }
    }
    assert!(off > 30 && flew > 5, "{off} {flew}");
}

/// A truncated or edited file is reported, and does not block arming.
#[test]
fn a_damaged_script_does_not_block_arming() {
    let folder = Folder::new();
    let text = std::fs::read_to_string(script("flagred", &folder)).unwrap();
    let vehicle = Vehicle::named("QUAD/X");
    let records = &eventful(&vehicle)[..100];
    let parts = text.match_indices('\x0c').map(|(at, _)| at);
    let whole = text.len();
    let misspelled = text.replacen("function judge(", "function judge((", 1);
    let first = text.find('\x0c').unwrap();
    // The script is cut anywhere after the loader, within or between lines, but not at the beginning of a comment.
    let ends =
        (first..whole)
            .step_by(whole / 40)
            .chain([whole - 1, whole - 2, whole - 3, whole - 5]);
    let cut = ends
        .filter(|end| !text[..*end].ends_with(['\n', '-']))
        .flat_map(|end| {
            let kept = &text[..end];
            let line = kept.rfind('\n').map_or(end, |at| at + 1);
            [
                kept.to_owned(),
                text[..line].to_owned(),
                format!("{kept}{}", "\0".repeat(whole - end)),
            ]
        });
    let lost = parts
        .clone()
        .zip(parts.skip(1))
        .map(|(from, to)| format!("{}{}", &text[..from], &text[to..]));
    for damaged in cut.chain([misspelled]).chain(lost) {
        let run = run(&folder.file("damaged.lua", damaged), &vehicle, records, &[]);
        assert_eq!(run.blocks, None);
        assert!(
            run.texts.contains("3: FLAGRED is off: ") || run.texts.contains("3: FLAGRED failed: "),
            "{}",
            run.texts
        );
    }
}

#[test]
fn every_signal_and_statistic_is_the_same_in_the_script() {
    let folder = Folder::new();
    let (estimator, file) = super::profile_of_every_signal(&folder);
    let script = script(&file, &folder);
    let vehicle = Vehicle::named("HEXA/X");
    let records = &eventful(&vehicle)[..4000];
    let expected = monitor_results(&estimator, &vehicle, records);
    assert!(expected.len() > 1000, "{}", expected.len());
    let run = run(&script, &vehicle, records, &[]);
    eprintln!("every signal: instructions {:?}", run.instructions);
    let (risk, elevated) = differ(&expected, &run.logged, "every signal");
    assert!(
        risk <= TOLERANCE_PCT && elevated <= TOLERANCE_PCT,
        "{risk} {elevated}"
    );
}

/// The battery level is unknown in the first minute, so values are assumed. Once the level falls below 80 %, the ratio is
/// unknown.
#[test]
fn ratios_products_and_missing_signals_are_the_same_in_the_script() {
    let folder = Folder::new();
    let (estimator, file) = super::profile_of(
        &folder,
        &[
            "{mean: {ratio: [battery_v, battery_remaining_pct], unknown_below: 80}, if_missing: 0.03}",
            "{last: {product: [battery_v, battery_remaining_pct]}, if_missing: 0.1}",
            "{max: battery_remaining_pct, per: x0, at_least: 0.1, if_missing: 0.2}",
        ],
    );
    let script = script(&file, &folder);
    let vehicle = Vehicle::named("QUAD/X");
    let mut records = eventful(&vehicle)[..4000].to_vec();
    for record in &mut records[..1500] {
        record.battery_pct = f64::NAN;
    }
    let expected = monitor_results(&estimator, &vehicle, &records);
    let [first, .., last] = expected.as_slice() else {
        panic!("{expected:?}")
    };
    // The ratio is unknown when the battery level is 79 %.
    assert!(
        first.0 < 500 && (1900..2200).contains(&last.0),
        "{first:?} {last:?}"
    );
    let run = run(&script, &vehicle, &records, &[]);
    let (risk, elevated) = differ(&expected, &run.logged, "missing");
    assert!(
        risk <= TOLERANCE_PCT && elevated <= TOLERANCE_PCT,
        "{risk} {elevated}"
    );
}

/// The rules of the paper are changed so that they conclude `strain`. Further rules conclude `risk` from `strain`,
/// partly through `trouble`. The test runs once with minimum and maximum over partitions, and once with sums of
/// products.
#[test]
fn the_script_evaluates_outputs_that_read_other_outputs() {
    let folder = Folder::new();
    let paper = include_str!("../../../rules/flagred-paper.yaml");
    let (head, rules) = paper.split_once("outputs:\n").unwrap();
    let (risk, rules) = rules.split_once("operators:").unwrap();
    let rules = rules.replace("risk IS", "strain IS");
    let (operators, rules) = rules.split_once('\n').unwrap();
    let strain = risk.replace("  risk:", "  strain:");
    let trouble = "  trouble: {range: [0, 1], partition: [none, some, much], when_no_rule_fires: {value: 0.1}}\n";
    // The risk does not read this output, so the script does not contain it.
    let unread = "  comfort: {range: [0, 1], terms: {good: {gaussian: {mean: 1, sd: 0.3}}}}\n";
    let more = "
  - IF strain IS NOT very_low AND spread IS NOT low THEN trouble IS some
  - IF strain IS high OR strain IS very very_high THEN trouble IS much
  - IF margin IS high THEN trouble IS none AND comfort IS good WITH 0.5
  - IF strain IS very_low THEN risk IS very_low
  - IF strain IS low THEN risk IS low
  - IF strain IS medium AND trouble IS NOT much THEN risk IS medium
  - IF trouble IS much AND strain IS high THEN risk IS high
  - IF trouble IS somewhat much AND strain IS very_high THEN risk IS very_high
";
    let profile = include_str!("../../../rules/profiles/flagred-paper.yaml");
    let profile = profile
        .replace("rules: flagred-paper ", "rules: chained.yaml ")
        .replace(
            "{risk: 67, elevated_risk: 50,",
            "{risk: 25, elevated_risk: 50,",
        );
    let file = folder.file("profile.yaml", &profile);
    let profile: flagred::profile::Profile = profile.parse().unwrap();
    let vehicle = Vehicle::named("HEXA/X");
    let records = eventful(&vehicle);
    let sums = "{and: product, or: probabilistic_sum, implication: product, aggregation: sum}";
    for operators in [operators.trim(), sums] {
        let text = format!(
            "{head}outputs:\n{risk}{trouble}{strain}{unread}operators: {operators}\n{}{more}",
            rules.trim_end()
        );
        folder.file("chained.yaml", &text);
        let model: fuzzy::Model = text.parse().unwrap();
        let estimator = Estimator::new(&profile, &model).unwrap();
        let script = script(&file, &folder);
        let written = std::fs::read_to_string(&script).unwrap();
        assert!(!written.contains("comfort IS good THEN") && written.contains("LEADS"));
        let expected = monitor_results(&estimator, &vehicle, &records);
        let run = run(&script, &vehicle, &records, &[]);
        let (risk, elevated) = differ(&expected, &run.logged, operators);
        eprintln!(
            "{operators}: {} risks, {risk:.4} %, elevated {elevated:.4} %, instructions {:?}",
            expected.len(),
            run.instructions
        );
        assert!(
            risk <= TOLERANCE_PCT && elevated <= TOLERANCE_PCT,
            "{operators}: {risk} {elevated}"
        );
        run.assert_within_budget(operators);
        let found: Vec<String> = run.texts.lines().skip(1).map(in_short).collect();
        let reported = assessor_messages(&estimator, &vehicle, &records);
        assert_eq!(reported, found, "{operators}");
        // The cause of the risk is the cause of the strain that it reads.
        assert!(
            found
                .iter()
                .any(|reported| reported.contains("WARN, limit")),
            "{found:?}"
        );
    }
}

/// 36 minutes in microseconds exceed a 32-bit integer; a 32-bit float has a precision of 24 bits.
#[test]
#[ignore = "takes half a minute"]
fn the_script_does_not_drift_in_a_long_flight() {
    let folder = Folder::new();
    let estimator = estimator("flagred");
    let vehicle = Vehicle::named("QUAD/X");
    let one = eventful(&vehicle);
    let calm = &one[3000..3400];
    let mut records = one[..3000].to_vec();
    for round in 0..270_u64 {
        records.extend(calm.iter().cloned().map(|record| Record {
            t_us: record.t_us + round * 400 * 40_000,
            ..record
        }));
    }
    let last_us = 270 * 400 * 40_000;
    records.extend(one[3000..].iter().cloned().map(|record| Record {
        t_us: record.t_us + last_us,
        ..record
    }));
    let expected = monitor_results(&estimator, &vehicle, &records);
    let run = run(&script("flagred", &folder), &vehicle, &records, &[]);
    let (risk, elevated) = differ(&expected, &run.logged, "78 minutes");
    eprintln!("78 minutes: risk {risk:.4} %, elevated {elevated:.4} %");
    assert!(
        risk <= TOLERANCE_PCT && elevated <= TOLERANCE_PCT,
        "{risk} {elevated}"
    );
}

#[test]
fn unsupported_features_of_a_script_are_refused_with_alternatives() {
    let folder = Folder::new();
    let rules = include_str!("../../../rules/flagred-paper.yaml");
    let profile = include_str!("../../../rules/profiles/flagred-paper.yaml");
    let profile = profile.replace("rules: flagred-paper ", "rules: odd-rules.yaml ");
    let curved = rules.replace(
        "partition: {low: 0, medium: 0.1, high: 0.2}",
        "terms: {low: {gaussian: {mean: 0, sd: 0.1}}, medium: {triangle: [0, 0.1, 0.2]}, high: {right_shoulder: [0.1, 0.2]}}",
    );
    let operator = rules.replace("and: minimum", "and: einstein");
    let fed = |source: &str| profile.replace("{std: motor_command}", source);
    let [signal, rate, median, percentile, exponential] = [
        "{std: wind_m_s}",
        "{rate: {max: motor_command}}",
        "{median: {max: motor_command}}",
        "{percentile: 90, of: {max: motor_command}}",
        "{std: motor_command, time_constant_s: 3}",
    ]
    .map(fed);
    for (rules, profile, reported) in [
        (
            curved.as_str(),
            &profile,
            "term `low` of input `spread` is curved",
        ),
        (&operator, &profile, "rule set's function for AND"),
        (rules, &signal, "cannot read the signal `wind_m_s`"),
        (rules, &rate, "cannot compute the statistic `rate`"),
        (
            rules,
            &median,
            "cannot compute the statistics `median` and `percentile`",
        ),
        (
            rules,
            &percentile,
            "cannot compute the statistics `median` and `percentile`",
        ),
        (
            rules,
            &exponential,
            "cannot compute windows with a `time_constant_s`",
        ),
    ] {
        folder.file("odd-rules.yaml", rules);
        let output = flagred()
            .args(["export", "--lua", &folder.file("odd.yaml", profile)])
            .output()
            .unwrap();
        let text = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(3), "{text}");
        assert!(text.contains(reported) && text.contains("help: "), "{text}");
    }
}

#[test]
fn a_profile_that_exceeds_a_limit_of_the_autopilot_is_refused() {
    let folder = Folder::new();
    let thresholds =
        |count: u32| (1..=count).map(|i| format!("{{share_below: 0.{i:03}, of: motor_margin}}"));
    let windows = |count: u32, what: &'static str| {
        (1..=count).map(move |i| format!("{{{what}, window_s: {}}}", 10 + i))
    };
    let of = |sources: Vec<String>| {
        let sources: Vec<&str> = sources.iter().map(String::as_str).collect();
        super::profile_of(&folder, &sources).1
    };
    let refused = |file: &str, reported: &str| {
        let output = flagred().args(["export", "--lua", file]).output().unwrap();
        let text = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(3), "{text}");
        assert!(text.contains(reported) && text.contains("help: "), "{text}");
        assert!(output.stdout.is_empty());
    };
    refused(
        &of(thresholds(95).collect()),
        "98 local variables in a function, but ArduPilot's Lua allows 90",
    );
    refused(
        &of(windows(25, "mean: motor_command").collect()),
        "(`SCR_VM_I_COUNT`)",
    );
    refused(
        &of(windows(9, "std: motor_command").collect()),
        "(`SCR_HEAP_SIZE`)",
    );
    let file = of(thresholds(51).collect());
    let rules = std::fs::read_to_string(folder.path().join("every-signal.yaml")).unwrap();
    let all: Vec<String> = (0..51)
        .map(|i| format!("x{i} IS low OR x{i} IS high"))
        .collect();
    folder.file(
        "every-signal.yaml",
        format!("{rules}  - IF {} THEN risk IS low\n", all.join(" OR ")),
    );
    refused(&file, "a rule has 102 conditions");
}
