//! The results of on-board monitors are bitwise equal to those of the monitor: with a plan in borrowed memory, with
//! exported Rust and with exported C, over grids of inputs and over every flight.

mod autopilot;
mod c;
mod lua;
mod rules;

use std::{collections::BTreeSet, path::Path, process::Command};

use flagred::{
    board::{
        self, Factors, OwnedMemory, Plan,
        table::{PartialConjunction, Scratch, StrongestRule, Table},
    },
    estimator::Estimator,
    monitor::{Craft, Monitor},
};
use flagred_tests::{
    Folder,
    board::{
        Moment, PROFILES, estimator, findings, geometry, logs, moment, moments, points, reported,
    },
    flagred,
};

/// The output of `flagred export --rust` for each profile.
mod exported {
    pub mod flagred {
        include!("../../exported/flagred.rs");
    }
    pub mod flagred_paper {
        include!("../../exported/flagred_paper.rs");
    }
    pub mod flagred_battery {
        include!("../../exported/flagred_battery.rs");
    }
}

fn exported() -> [(&'static str, &'static Plan<'static>); 3] {
    [
        ("flagred", &exported::flagred::PLAN),
        ("flagred_paper", &exported::flagred_paper::PLAN),
        ("flagred_battery", &exported::flagred_battery::PLAN),
    ]
}

/// Runs an on-board monitor.
fn with_monitor<R>(
    plan: &Plan<'_>,
    motors: usize,
    run: impl FnOnce(&mut board::Monitor<'_>) -> R,
) -> R {
    run(&mut OwnedMemory::new(plan, motors).monitor(plan).unwrap())
}

/// The updates of the monitor for each sample of a flight, and the findings at its end.
fn monitor_results(estimator: &Estimator, geometry: &[Factors], flight: &[Moment]) -> Vec<String> {
    let signals = estimator.profile().signals();
    let mut monitor = Monitor::new(
        estimator,
        Craft::new(flight[0].motors.len())
            .with_signals(&signals)
            .with_optional(&signals)
            .with_geometry(geometry),
    )
    .unwrap();
    let output = flight
        .iter()
        .map(|moment| reported(&monitor.push(&moment.sample())));
    let mut output: Vec<String> = output.collect();
    output.push(findings(&monitor.finish()));
    output
}

fn on_board(plan: &Plan<'_>, geometry: &[Factors], flight: &[Moment]) -> Vec<String> {
    with_monitor(plan, flight[0].motors.len(), |monitor| {
        if !geometry.is_empty() {
            monitor.set_geometry(geometry).unwrap();
        }
        let output = flight
            .iter()
            .map(|moment| reported(&monitor.push(&moment.sample())));
        let mut output: Vec<String> = output.collect();
        output.push(findings(&monitor.finish()));
        output
    })
}

/// Asserts that two outputs are equal. Shows only the first difference, because a whole flight is too long to print.
fn assert_same(expected: &[String], found: &[String], what: &str) {
    assert_eq!(expected.len(), found.len(), "{what}");
    for (i, (expected, found)) in expected.iter().zip(found).enumerate() {
        assert_eq!(expected, found, "{what}, step {i}");
    }
}

/// The number of points on each axis of a grid, chosen so that the grid is dense but the test is fast enough.
fn along(estimator: &Estimator) -> usize {
    match estimator.profile().inputs.len() {
        0..=2 => 203,
        3 => 53,
        4 => 19,
        5 => 8,
        _ => 7,
    }
}

#[test]
fn exported_files_equal_the_output_of_export() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("exported");
    for (profile, (file, _)) in PROFILES.iter().zip(exported()) {
        // One script is enough: other profiles differ only in their data, and `lua.rs` runs their scripts.
        let lua = (file == "flagred").then_some(("--lua", "lua"));
        for (option, ending) in [("--rust", "rs")].into_iter().chain(lua) {
            let output = flagred()
                .args(["export", option, profile])
                .output()
                .unwrap();
            let text = String::from_utf8(output.stdout).unwrap();
            assert!(output.status.success(), "{profile}");
            let path = folder.join(format!("{file}.{ending}"));
            if std::env::var_os("UPDATE_EXPORTED").is_some() {
                std::fs::write(&path, &text).unwrap();
            }
            assert!(
                std::fs::read_to_string(&path).unwrap() == text,
                "{} is not what `flagred export {option} {profile}` writes; UPDATE_EXPORTED=1 writes it anew",
                path.display()
            );
        }
    }
}

#[test]
fn plans_agree_with_the_estimator_on_a_grid_of_inputs() {
    for (profile, (name, plan)) in PROFILES.iter().zip(exported()) {
        let estimator = estimator(profile);
        let lent = estimator.plan().unwrap();
        // Compared as text, in which NaN equals NaN.
        let table = |plan: &Plan<'_>| format!("{:?}", plan.rules.table);
        assert!(table(plan) == table(&lent), "{name}");
        let (mut known, mut filled) = (0, 0);
        with_monitor(plan, 1, |monitor| {
            for point in points(&estimator, along(&estimator)) {
                let expected = estimator.at(&point);
                known += usize::from(expected.is_some());
                filled +=
                    usize::from(expected.is_some_and(|output| output.filled_from > Some(0.0)));
                let found = monitor.at(&point);
                assert_eq!(
                    moment(expected.as_ref()),
                    moment(found.as_ref()),
                    "{name} at {point:?}"
                );
            }
            let inputs = estimator.profile().inputs.len();
            assert_eq!(monitor.at(&vec![f64::NAN; inputs]), None);
            assert_eq!(monitor.at(&vec![f64::INFINITY; inputs]), None);
            assert_eq!(monitor.at(&[]), None);
        });
        eprintln!("{name}: {known} points, {filled} of them filled");
        assert!(known > 30_000, "{name}: {known}");
        // The rules of `flagred` have no gap.
        assert_eq!(filled > 0, name != "flagred", "{name}: {filled}");
        assert_eq!(plan.filled.is_some(), name != "flagred", "{name}");
    }
}

#[test]
fn plans_agree_with_the_monitor_on_every_flight() {
    for (profile, (name, plan)) in PROFILES.iter().zip(exported()) {
        let estimator = estimator(profile);
        let lent = estimator.plan().unwrap();
        for log in logs() {
            let flight = moments(&log, &estimator.profile().signals());
            for geometry in [&[][..], &geometry(&log)] {
                let what = format!("{name}, {} factors, {}", geometry.len(), log.display());
                let expected = monitor_results(&estimator, geometry, &flight);
                assert_same(&expected, &on_board(&lent, geometry, &flight), &what);
                assert_same(&expected, &on_board(plan, geometry, &flight), &what);
            }
        }
    }
}

/// A rule whose strength has a lower index than the first strength of its output raises nothing, and does not cause a panic.
#[test]
fn an_action_without_an_output_is_not_a_cause() {
    let estimator = estimator("flagred-paper");
    let plan = estimator.plan().unwrap();
    let mut outputs = plan.rules.table.outputs.to_vec();
    let table = plan.rules.table;
    let sizes = table.sizes;
    let (mut low, mut high) = (None, None);
    for (first, found) in [(0, &mut low), (outputs[0].end_strength - 1, &mut high)] {
        outputs[0].first_strength = first;
        let table = Table {
            outputs: &outputs,
            ..table
        };
        let mut scratch = Scratch {
            values: &mut [0.0; 2],
            degrees: &mut vec![0.0; sizes.degrees as usize],
            alive: &mut vec![PartialConjunction::NONE; sizes.alive as usize],
            partial: &mut vec![PartialConjunction::NONE; sizes.partial as usize],
            next: &mut vec![PartialConjunction::NONE; sizes.partial as usize],
            stack: &mut vec![0.0; sizes.stack as usize],
            strengths: &mut vec![0.0; sizes.strengths as usize],
            strongest: &mut [StrongestRule::NONE],
        };
        *found = table.raised_by(&mut scratch, &[0.3, 0.1], 0, 10.0);
    }
    assert!(low.is_some());
    assert_eq!(high, None);
}

/// A profile with every signal of motors, every statistic that a script supports, and every notice, with its file.
pub(crate) fn profile_of_every_signal(folder: &Folder) -> (Estimator, String) {
    const SOURCES: [&str; 13] = [
        "{std_less_noise: {std: motor_command_less_yaw}, per: x9, at_least: 0.02}",
        "{std_less_noise: {mean: motor_command_less_yaw}, window_s: 9}",
        "{noise: {max: motor_command}}",
        "{noise: yaw_effort}",
        "{std: roll_effort}",
        "{rms: pitch_effort}",
        "{std_less_noise: thrust_effort}",
        "{mean: command_noise, window_s: 9}",
        "{max: motor_command_less_yaw}",
        "{min: {min: motor_margin_low_side}}",
        "{share_above: 0.02, of: command_noise, window_s: 9}",
        "{share_below: 0.5, of: {max: motor_margin_high_side}}",
        "{mean: {motor: 2, of: motor_margin}}",
    ];
    profile_of(folder, &SOURCES)
}

/// A profile with every statistic that only plans support.
fn profile_of_every_statistic(folder: &Folder) -> (Estimator, String) {
    const SOURCES: [&str; 16] = [
        "{rate: {max: motor_command}}",
        "{rate: {difference: [yaw_des_deg, yaw_deg]}, window_s: 9}",
        "{rms: {difference: [yaw_des_deg, yaw_deg]}}",
        "{last: {difference: [yaw_des_deg, yaw_deg]}}",
        "{std: {difference: [ground_speed_m_s, ekf_wind_m_s]}}",
        "{median: {motor: 4, of: motor_command_less_yaw}}",
        "{median: command_noise, window_s: 9}",
        "{percentile: 90, of: {min: motor_margin}, window_s: 5}",
        "{percentile: 2.5, of: roll_effort}",
        "{mean: motor_command, time_constant_s: 3}",
        "{std: {motor: 1, of: motor_command}, time_constant_s: 8}",
        "{share_above: 5, of: {difference: [ground_speed_m_s, ekf_wind_m_s]}, time_constant_s: 0.5}",
        "{std: {difference: [ground_speed_m_s, ekf_wind_m_s]}, per: x9, at_least: 0.3}",
        "{mean: {ratio: [ekf_wind_m_s, ground_speed_m_s], unknown_below: 0.01}, window_s: 9}",
        "{std: {product: [yaw_des_deg, ground_speed_m_s]}}",
        "{last: no_such_signal, if_missing: 0.2}",
    ];
    profile_of(folder, &SOURCES)
}

fn profile_of(folder: &Folder, of: &[&str]) -> (Estimator, String) {
    let (mut inputs, mut sources, mut rules) = (String::new(), String::new(), String::new());
    for (i, source) in of.iter().enumerate() {
        let width = if source.contains("mean") || source.contains("noise") {
            0.05
        } else {
            0.5
        };
        inputs += &format!("  x{i}: {{range: [0, 1], partition: {{low: 0, high: {width}}}}}\n");
        sources += &format!("  x{i}: {source}\n");
        rules += &format!(
            "  - IF x{i} IS low THEN risk IS low\n  - IF x{i} IS high THEN risk IS high\n"
        );
    }
    let rules = format!(
        "fuzzy: 1\nname: every-signal\ninputs:\n{inputs}outputs:\n  risk: {{range: [0, 100], partition: [low, high]}}\n\
         operators: {{and: product, or: maximum, implication: product, aggregation: sum}}\nrules:\n{rules}"
    );
    let profile = format!(
        "flagred: 1\nname: every-signal\nrules: every-signal.yaml\ntake_off_s: 4\ninputs:\n{sources}\
         verdict:\n  warn: {{risk: 45, after_s: 0.2}}\n  fail: {{risk: 60, after_s: 0.2}}\n  idle_below: 0.05\n  \
         noise: {{above: 0.001, after_s: 0}}\n  reserve: {{below: 0.6, after_s: 0.5}}\n  \
         imbalance: {{above: 0.002, after_s: 0.1}}\n"
    );
    let model = fuzzy::yaml::parse(&rules).unwrap().model;
    let estimator = Estimator::new(&profile.parse().unwrap(), &model).unwrap();
    folder.file("every-signal.yaml", rules);
    (estimator, folder.file("every-signal-profile.yaml", profile))
}

#[test]
fn every_signal_and_notice_is_the_same_in_borrowed_memory_and_in_c() {
    let folder = Folder::new();
    let measures = same_lent_and_in_c(profile_of_every_signal(&folder));
    // In the shipped flights, an alarm is raised before the trims are known, so imbalance relative to trims is not expected.
    for expected in ["command noise", "pair imbalance", "reserve", "risk"] {
        assert!(measures.contains(expected), "{measures:?}");
    }
}

#[test]
fn every_statistic_is_the_same_in_borrowed_memory_and_in_c() {
    let folder = Folder::new();
    same_lent_and_in_c(profile_of_every_statistic(&folder));
}

#[test]
fn a_profile_without_motors_is_the_same_in_borrowed_memory_and_in_c() {
    let folder = Folder::new();
    let rules = "fuzzy: 1\nname: loads\ninputs:\n  load: {range: [0, 2], partition: {rated: 1, over: 1.5}}\n\
                 outputs:\n  risk: {range: [0, 100], partition: [low, medium, high]}\nrules:\n\
                 - IF load IS rated THEN risk IS low\n- IF load IS over THEN risk IS high\n";
    let profile = "flagred: 1\nname: no-motors\nrules: loads.yaml\ninputs: {load: {mean: load_t}}\n\
                   verdict: {warn: {risk: 50}, fail: {risk: 75}}\n";
    let model = fuzzy::yaml::parse(rules).unwrap().model;
    let estimator = Estimator::new(&profile.parse().unwrap(), &model).unwrap();
    folder.file("loads.yaml", rules);
    let file = folder.file("no-motors.yaml", profile);
    let moment = |i: u32| Moment {
        t_s: f64::from(i) * 0.1,
        motors: Vec::new(),
        in_air: i < 550,
        signals: vec![f64::from(i) / 300.0],
    };
    let flight: Vec<Moment> = (0..600).map(moment).collect();
    let expected = monitor_results(&estimator, &[], &flight);
    let plan = estimator.plan().unwrap();
    assert_same(&expected, &on_board(&plan, &[], &flight), "no motors");
    let (_, built) = c::program("tests/c/follow.c", "no-motors", (&file, "no_motors"));
    let mut command = Command::new(built.at("no-motors"));
    command.arg("0");
    let found = c::written(command, &c::doubles(&[], &flight));
    assert_same(&expected, &found, "no motors in C");
    // FAIL has the code 3.
    assert!(
        expected.iter().any(|reported| reported.contains(" [3 ")),
        "{expected:?}"
    );
}

/// Asserts that the results of a plan and of its export to C are bitwise equal to those of the monitor. Returns the
/// kinds of findings.
fn same_lent_and_in_c((estimator, file): (Estimator, String)) -> BTreeSet<String> {
    let signals = estimator.profile().signals();
    let plan = estimator.plan().unwrap();
    let (_, built) = c::program("tests/c/follow.c", "every-signal", (&file, "every_signal"));
    let (mut known, mut measures) = (0, BTreeSet::new());
    for log in logs() {
        let flight = moments(&log, &signals);
        let geometry = geometry(&log);
        let expected = monitor_results(&estimator, &geometry, &flight);
        let what = format!("every signal, {}", log.display());
        assert_same(&expected, &on_board(&plan, &geometry, &flight), &what);
        with_monitor(&plan, geometry.len(), |monitor| {
            let mut whole = Monitor::new(
                &estimator,
                Craft::new(geometry.len())
                    .with_signals(&signals)
                    .with_optional(&signals)
                    .with_geometry(&geometry),
            )
            .unwrap();
            monitor.set_geometry(&geometry).unwrap();
            let bits = |inputs: &[f64]| inputs.iter().map(|x| x.to_bits()).collect::<Vec<u64>>();
            let mut ended = Vec::new();
            for moment in &flight {
                let update = whole.push(&moment.sample());
                known += usize::from(update.risk.is_ok());
                ended.extend(update.ended.into_iter().flatten());
                monitor.push(&moment.sample());
                assert_eq!(bits(whole.inputs()), bits(monitor.inputs()), "{what}");
            }
            ended.extend(whole.finish().into_iter().flatten());
            measures.extend(ended.iter().map(|finding| finding.measure.to_string()));
        });
        let mut command = Command::new(built.at("every-signal"));
        command.arg(geometry.len().to_string());
        let found = c::written(command, &c::doubles(&geometry, &flight));
        assert_same(&expected, &found, &format!("{what} in C"));
    }
    assert!(known > 1000, "{known}");
    measures
}

#[test]
fn an_ambiguous_geometry_is_refused_and_changes_nothing() {
    let estimator = estimator("flagred");
    let plan = estimator.plan().unwrap();
    let log = &logs()[0];
    let flight = moments(log, &[]);
    let known = geometry(log);
    let alike = vec![[1.0, 1.0, 1.0]; known.len()];
    let mut odd = known.clone();
    odd[0][2] = f64::NAN;
    with_monitor(&plan, known.len(), |monitor| {
        for wrong in [&alike, &odd, &known[1..].to_vec(), &vec![]] {
            assert_eq!(
                monitor.set_geometry(wrong),
                Err(board::SetupError::Geometry)
            );
        }
        let output = flight
            .iter()
            .map(|moment| reported(&monitor.push(&moment.sample())));
        let mut output: Vec<String> = output.collect();
        output.push(findings(&monitor.finish()));
        assert_same(
            &monitor_results(&estimator, &[], &flight),
            &output,
            "refused",
        );
    });
    let with_it = monitor_results(&estimator, &known, &flight);
    assert!(with_it != monitor_results(&estimator, &[], &flight));
}

#[test]
fn a_storage_rejects_plans_of_other_sizes() {
    let mut storage = exported::flagred::Storage::<8>::new();
    assert!(storage.monitor(&exported::flagred::PLAN).is_ok());
    let other = storage.monitor(&exported::flagred_battery::PLAN);
    assert_eq!(other.err(), Some(board::SetupError::Memory));
    let mut nothing = exported::flagred::Storage::<0>::new();
    let refused = nothing.monitor(&exported::flagred::PLAN);
    assert_eq!(refused.err(), Some(board::SetupError::NoMotors));
}

#[test]
fn a_sample_on_board_allocates_nothing() {
    for (profile, (name, plan)) in PROFILES.iter().zip(exported()) {
        let estimator = estimator(profile);
        let flight = moments(&logs()[0], &estimator.profile().signals());
        with_monitor(plan, flight[0].motors.len(), |monitor| {
            let counted = allocation_counter::measure(|| {
                for moment in &flight {
                    std::hint::black_box(monitor.push(&moment.sample()));
                }
            });
            assert_eq!(counted.count_total, 0, "{name}");
        });
    }
}

#[test]
fn outputs_without_a_closed_form_are_refused_with_alternatives() {
    let folder = Folder::new();
    let rules = include_str!("../../../rules/flagred-paper.yaml")
        .replace("defuzzifier: centroid", "samples: {midpoint: 100}");
    folder.file("odd-rules.yaml", rules);
    let profile = include_str!("../../../rules/profiles/flagred-paper.yaml")
        .replace("rules: flagred-paper ", "rules: odd-rules.yaml ");
    let output = flagred()
        .args(["export", "--c", &folder.file("odd.yaml", profile)])
        .output()
        .unwrap();
    let reported = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(3), "{reported}");
    assert!(
        reported.contains("output `risk` has no closed form")
            && reported.contains("help: the defuzzifiers have a closed form with"),
        "{reported}"
    );
}

/// A profile for each rule set of `tests/onboard`; together, these rule sets use every array of a table. Each input is
/// the last value of a signal.
fn profiles_of_every_kind(folder: &Folder) -> Vec<(String, Estimator, String)> {
    let rule_sets = Path::new(env!("CARGO_MANIFEST_DIR")).join("onboard");
    let mut profiles = Vec::new();
    for entry in std::fs::read_dir(rule_sets).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_stem().unwrap().to_str().unwrap().to_owned();
        let rules = std::fs::read_to_string(&path).unwrap();
        let model = fuzzy::yaml::parse(&rules).unwrap().model;
        let mut text = format!("flagred: 1\nname: {name}\nrules: {name}.yaml\ninputs:\n");
        for input in &model.inputs {
            text += &format!("  {0}: {{last: signal_{0}}}\n", input.name);
        }
        text += "gap: {method: nearest}\n";
        let profile = text.parse::<flagred::profile::Profile>().unwrap();
        let estimator = Estimator::new(&profile, &model).unwrap();
        folder.file(&format!("{name}.yaml"), rules);
        let file = folder.file(&format!("{name}-profile.yaml"), text);
        profiles.push((name, estimator, file));
    }
    assert_eq!(profiles.len(), 7);
    profiles
}

#[test]
fn tables_of_every_kind_agree_with_the_estimator_in_borrowed_memory_and_in_c() {
    let folder = Folder::new();
    let mut used = Vec::new();
    for (name, estimator, file) in profiles_of_every_kind(&folder) {
        let plan = estimator.plan().unwrap();
        let table = &plan.rules.table;
        used.extend([
            (!table.curves.is_empty(), "curves"),
            (!table.points.is_empty(), "points"),
            (!table.hedges.is_empty(), "hedges"),
            (!table.programs.is_empty(), "programs"),
            (!table.blocks.is_empty(), "blocks"),
            (!table.nodes.is_empty(), "nodes"),
            (!table.pairs.is_empty(), "pairs"),
            (!table.layers.is_empty(), "layers"),
            (!table.moments.is_empty(), "moments"),
            (!table.coefficients.is_empty(), "coefficients"),
            (!plan.rules.stages.is_empty(), "stages"),
        ]);
        let along = if plan.inputs.len() > 2 { 10 } else { 80 };
        let points = points(&estimator, along);
        let expected: Vec<String> = points
            .iter()
            .map(|point| moment(estimator.at(point).as_ref()))
            .collect();
        let lent: Vec<String> = with_monitor(&plan, 1, |monitor| {
            let output = points.iter().map(|point| monitor.at(point));
            output.map(|output| moment(output.as_ref())).collect()
        });
        assert_same(&expected, &lent, &name);
        let (command, _folder) = c::program("tests/c/follow.c", &name, (&file, &name));
        let doubles = points
            .iter()
            .flat_map(|point| [1.0].into_iter().chain(point.iter().copied()));
        let found = c::written(command, &doubles.collect::<Vec<f64>>());
        assert_same(&expected, &found, &format!("{name} in C"));
    }
    for (_, array) in &used {
        assert!(used.contains(&(true, array)), "no {array} are used");
    }
}

#[test]
fn every_compiled_table_is_valid() {
    for entry in std::fs::read_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/conformance")).unwrap() {
        let text = std::fs::read_to_string(entry.unwrap().path()).unwrap();
        let (rule_set, _) = text.split_once("\n---\n").unwrap();
        let model = fuzzy::yaml::parse(rule_set).unwrap().model;
        let engine = fuzzy::Engine::new(&model).unwrap();
        let whole = match (engine.table(), engine.chain()) {
            (Some(table), None) => table.check(),
            (None, Some(chain)) => chain.check(model.inputs.len()),
            both => panic!("{both:?}"),
        };
        assert_eq!(whole, Ok(()), "{}", model.name);
    }
}
