//! The monitor in C: exported profiles, the examples, and mistakes of a caller.

use std::{
    collections::BTreeMap,
    io::Write,
    path::{Path, PathBuf},
    process::{Command, Stdio},
    sync::OnceLock,
};

use flagred::board::{Factors, table};
use flagred_tests::{
    Folder, STEADY,
    board::{Moment, PROFILES, estimator, geometry, logs, moment, moments, points},
    flagred,
};

use super::{along, assert_same, exported, monitor_results, profiles_of_every_kind};

/// The shipped profile, and its name in C.
const FLAGRED: (&str, &str) = ("flagred", "flagred");

/// The folder of the C library, built with `core` only.
fn library() -> &'static Path {
    static LIBRARY: OnceLock<PathBuf> = OnceLock::new();
    LIBRARY.get_or_init(|| {
        let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        let target = workspace.join("target");
        let status = Command::new(env!("CARGO"))
            .args([
                "build",
                "--quiet",
                "-p",
                "flagred-c",
                "--no-default-features",
            ])
            .args(["--profile", "onboard", "--target-dir"])
            .arg(&target)
            .current_dir(&workspace)
            .status();
        assert!(
            status.unwrap().success(),
            "the library for C does not build"
        );
        target.join("onboard")
    })
}

/// Compiles a C program with the library and an exported profile, and returns it and its folder.
pub(crate) fn program(
    source: &str,
    name: &str,
    (profile, plan): (&str, &str),
) -> (Command, Folder) {
    let plan = format!("flagred_plan_{plan}");
    compiled(source, name, profile, &[("PLAN", &plan)])
}

/// Like [`program`], for any shipped profile or profile file, with macros for the compiler. The compiler is `cc`, which
/// Rust requires for linking too.
pub(crate) fn compiled(
    source: &str,
    name: &str,
    exported: &str,
    defined: &[(&str, &str)],
) -> (Command, Folder) {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let folder = Folder::new();
    let mut cc = Command::new("cc");
    cc.args([
        "-std=c11",
        "-O1",
        "-Wall",
        "-Wextra",
        "-Wpedantic",
        "-Werror",
    ]);
    cc.arg("-I").arg(root.join("bindings/c/include"));
    let header = folder.at("profile.h");
    let status = flagred()
        .args(["export", "--c", exported, "--output"])
        .arg(&header)
        .status();
    assert!(status.unwrap().success(), "{exported}");
    cc.arg("-I").arg(folder.path());
    cc.arg(format!("-DPROFILE=\"{header}\""));
    for (macro_name, value) in defined {
        cc.arg(format!("-D{macro_name}={value}"));
    }
    let binary = folder.at(name);
    cc.arg(root.join(source)).arg("-o").arg(&binary);
    cc.arg(library().join("libflagred.a"));
    let compiled = cc.output().unwrap();
    let reported = String::from_utf8_lossy(&compiled.stderr);
    assert!(compiled.status.success(), "{reported}");
    (Command::new(binary), folder)
}

/// The C initialisers name their fields, so the compiler verifies that the structures agree.
#[test]
fn the_header_has_the_arrays_of_a_table() {
    macro_rules! list {
        ($($(#[$doc:meta])* $array:ident: $item:ident,)*) => {
            [$((stringify!($array), stringify!($item))),*]
        };
    }
    let arrays = table::arrays!(list!).map(|(array, item)| match item {
        "f64" => format!("FLAGRED_ARRAY(double, {array})"),
        "u32" => format!("FLAGRED_ARRAY(uint32_t, {array})"),
        "AntecedentStep" => format!("FLAGRED_ARRAY(flagred_antecedent_step, {array})"),
        "FuzzySet" => format!("FLAGRED_ARRAY(flagred_fuzzy_set, {array})"),
        "LayeredSet" => format!("FLAGRED_ARRAY(flagred_layered_set, {array})"),
        "SetTerm" => format!("FLAGRED_ARRAY(flagred_set_term, {array})"),
        item => format!("FLAGRED_ARRAY(flagred_{}, {array})", item.to_lowercase()),
    });
    let header = include_str!("../../../bindings/c/include/flagred.h");
    let listed: Vec<&str> = header
        .lines()
        .filter_map(|line| line.split(';').next()?.strip_prefix("    "))
        .filter(|line| line.starts_with("FLAGRED_ARRAY("))
        .take(arrays.len())
        .collect();
    assert_eq!(arrays[..], listed);
    // `ends` has a field for each array, in the same order.
    macro_rules! names {
        ($($(#[$doc:meta])* $array:ident: $item:ident,)*) => { [$(stringify!($array)),*].join(", ") };
    }
    let header = header.split_whitespace().collect::<Vec<&str>>().join(" ");
    let ends = format!("struct {{ uint32_t {}; }} ends;", table::arrays!(names!));
    assert!(header.contains(&ends), "{ends}");
}

/// A geometry and a flight as input of `tests/c/follow.c`.
pub(crate) fn doubles(geometry: &[Factors], flight: &[Moment]) -> Vec<f64> {
    let mut doubles = Vec::new();
    if !geometry.is_empty() {
        doubles.push(3.0);
        doubles.extend(geometry.iter().flatten());
    }
    for moment in flight {
        doubles.extend([0.0, moment.t_s, f64::from(u8::from(moment.in_air))]);
        doubles.extend(&moment.motors);
        doubles.extend(&moment.signals);
    }
    doubles.push(2.0);
    doubles
}

/// The output of a program that reads doubles as its input.
pub(crate) fn written(mut program: Command, doubles: &[f64]) -> Vec<String> {
    let mut child = program
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let bytes: Vec<u8> = doubles.iter().flat_map(|x| x.to_ne_bytes()).collect();
    let mut stdin = child.stdin.take().unwrap();
    let writer = std::thread::spawn(move || stdin.write_all(&bytes).unwrap());
    let output = child.wait_with_output().unwrap();
    writer.join().unwrap();
    assert!(output.status.success());
    let text = String::from_utf8(output.stdout).unwrap();
    text.lines().map(str::to_owned).collect()
}

#[test]
fn exported_c_agrees_with_the_monitor_on_flights_and_with_the_estimator_on_a_grid() {
    for (profile, (name, _)) in PROFILES.iter().zip(exported()) {
        let (_, folder) = program("tests/c/follow.c", name, (profile, name));
        let estimator = estimator(profile);
        for log in logs() {
            let flight = moments(&log, &estimator.profile().signals());
            for geometry in [&[][..], &geometry(&log)] {
                let mut command = Command::new(folder.at(name));
                command.arg(flight[0].motors.len().to_string());
                let expected = monitor_results(&estimator, geometry, &flight);
                let what = format!("{name} in C, {} factors, {}", geometry.len(), log.display());
                assert_same(
                    &expected,
                    &written(command, &doubles(geometry, &flight)),
                    &what,
                );
            }
        }
        let points = points(&estimator, along(&estimator));
        let doubles = points
            .iter()
            .flat_map(|point| [1.0].into_iter().chain(point.iter().copied()));
        let found = written(
            Command::new(folder.at(name)),
            &doubles.collect::<Vec<f64>>(),
        );
        let expected: Vec<String> = points
            .iter()
            .map(|point| moment(estimator.at(point).as_ref()))
            .collect();
        assert_same(&expected, &found, &format!("{name} in C over its inputs"));
    }
}

#[test]
fn the_example_in_c_runs() {
    let (mut program, _folder) = program("bindings/c/examples/hover.c", "hover", FLAGRED);
    let output = program.output().unwrap();
    assert!(output.status.success());
    let text = String::from_utf8(output.stdout).unwrap();
    insta::assert_snapshot!(text);
}

/// The time in us and the risk of every row with a risk.
fn risks(csv: &[u8]) -> BTreeMap<u64, f64> {
    let text = std::str::from_utf8(csv).unwrap();
    let names: Vec<&str> = text.lines().next().unwrap().split(',').collect();
    let column = names.iter().position(|name| *name == "risk").unwrap();
    let rows = text.lines().skip(1).filter_map(|line| {
        let cells: Vec<&str> = line.split(',').collect();
        let t_us = (cells[0].parse::<f64>().unwrap() * 1e6).round() as u64;
        Some((t_us, cells[column].parse().ok()?))
    });
    rows.collect()
}

#[test]
fn a_log_replayed_in_c_has_the_risk_of_assess() {
    let (mut program, folder) = program("bindings/c/examples/replay.c", "replay", FLAGRED);
    let csv = folder.at("steady.csv");
    let converted = flagred()
        .args(["convert", STEADY, "--output", &csv])
        .output();
    assert!(converted.unwrap().status.success());
    let flown = program.stdin(std::fs::File::open(&csv).unwrap()).output();
    let flown = risks(&flown.unwrap().stdout);
    let assessed = flagred().args(["assess", "--csv", &csv]).output().unwrap();
    let assessed = risks(&assessed.stdout);
    assert!(assessed.len() > 1000, "{}", assessed.len());
    for (t_us, risk_pct) in &assessed {
        let by_c = flown.get(t_us).copied().unwrap_or(f64::NAN);
        assert!(
            (by_c - risk_pct).abs() <= 1e-6,
            "{t_us} us: {by_c} is not {risk_pct}"
        );
    }
}

#[test]
fn a_damaged_table_is_refused_or_evaluates_in_c() {
    let folder = Folder::new();
    let of_every_kind = profiles_of_every_kind(&folder);
    let of_every_kind = of_every_kind
        .iter()
        .map(|(name, _, file)| (&**name, &**file));
    let shipped = exported().into_iter().zip(PROFILES);
    let shipped = shipped.map(|((name, _), profile)| (name, profile));
    for (name, profile) in of_every_kind.chain(shipped) {
        let (mut command, _folder) = program("tests/c/damage.c", name, (profile, name));
        // `scripts/check-c` tries many more damaged plans, with sanitizers.
        let output = command.args(["1000", "16"]).output().unwrap();
        assert!(output.status.success(), "{name}: {output:?}");
        let text = String::from_utf8(output.stdout).unwrap();
        let (accepted, tried) = text.trim().split_once(" of ").unwrap();
        let [accepted, tried] = [accepted, tried].map(|count| count.parse::<u32>().unwrap());
        assert!(accepted > 100 && tried > accepted + 100, "{name}: {text}");
    }
}

/// The programs of examples/09-on-board.md and docs/firmware.md.
#[test]
fn the_programs_in_c_of_the_documents_run() {
    let tipper = concat!(env!("CARGO_MANIFEST_DIR"), "/../rules/tipper.yaml");
    for (page, header, exported, prints) in [
        (
            include_str!("../../../examples/09-on-board.md"),
            "profile.h",
            "flagred",
            "FAIL\n",
        ),
        (
            include_str!("../../../docs/firmware.md"),
            "tipper.h",
            tipper,
            "22.98\n",
        ),
    ] {
        let (_, rest) = page.split_once("```c\n").unwrap();
        let (code, _) = rest.split_once("```").unwrap();
        let code = code.replace(&format!("\"{header}\""), "PROFILE");
        let pages = Folder::new();
        let source = pages.file("page.c", code);
        let (mut program, _folder) = compiled(&source, "page", exported, &[]);
        let output = program.output().unwrap();
        assert!(output.status.success());
        assert_eq!(String::from_utf8(output.stdout).unwrap(), prints);
    }
}

/// If the profiles had the same names, the sizes of the one included last would apply to both.
#[test]
fn two_profiles_in_one_program_have_their_own_memory_sizes() {
    let folder = Folder::new();
    for profile in ["flagred", "flagred-paper"] {
        let status = flagred()
            .args(["export", "--c", profile, "--output"])
            .arg(folder.at(&format!("{profile}-plan.h")))
            .status();
        assert!(status.unwrap().success());
    }
    let header = Path::new(env!("CARGO_MANIFEST_DIR")).join("../bindings/c/include");
    let compiles = |text: &str| {
        let cc = Command::new("cc")
            .args([
                "-std=c11",
                "-Wall",
                "-Wextra",
                "-Werror",
                "-Wno-unused",
                "-fsyntax-only",
            ])
            .arg("-I")
            .arg(&header)
            .arg(folder.file("program.c", text))
            .output();
        cc.unwrap().status.success()
    };
    let include = |file: &str| format!("#include \"{}\"\n", folder.at(file));
    let one = include("flagred-plan.h");
    let both = one.clone() + &include("flagred-paper-plan.h");
    let memory = |name: &str| format!("static unsigned char of_{name}[{name}(4)];\n");
    let own = [
        "FLAGRED_PLAN_FLAGRED_MEMORY",
        "FLAGRED_PLAN_FLAGRED_PAPER_MEMORY",
    ]
    .map(memory);
    assert!(compiles(&(one + &own[0] + &memory("FLAGRED_MEMORY"))));
    assert!(compiles(&(both.clone() + &own.concat())));
    assert!(!compiles(&(both + &memory("FLAGRED_MEMORY"))));
}

#[test]
fn mistakes_in_c_are_reported_and_write_nothing() {
    let (mut program, _folder) = program("tests/c/mistakes.c", "mistakes", FLAGRED);
    let output = program.output().unwrap();
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{text}");
}

/// The module for PX4, with replacements for the parts of PX4 that it uses.
#[test]
#[ignore = "needs a compiler of C++"]
fn the_module_for_px4_reports_the_risk_and_the_level() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let example = root.join("bindings/c/examples/px4");
    let folder = Folder::new();
    let exported = flagred()
        .args(["export", "--c", "flagred", "--output"])
        .arg(folder.at("flagred_profile.h"))
        .status();
    assert!(exported.unwrap().success());
    let compile = |compiler: &str, flags: &[&str]| {
        let output = Command::new(compiler)
            .args(["-Wall", "-Wextra", "-Werror", "-Wno-unused-parameter"])
            .arg("-I")
            .arg(root.join("bindings/c/include"))
            .arg("-I")
            .arg(folder.path())
            .args(flags)
            .output();
        let output = output.unwrap();
        let reported = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{reported}");
    };
    let source = |file: &str| example.join(file).display().to_string();
    let object = folder.at("profile.o");
    compile(
        "cc",
        &["-std=c11", "-c", &source("profile.c"), "-o", &object],
    );
    let binary = folder.at("fly");
    let stand_ins = concat!(env!("CARGO_MANIFEST_DIR"), "/px4");
    compile(
        "c++",
        &[
            "-std=c++17",
            "-I",
            &format!("{stand_ins}/include"),
            "-I",
            &example.display().to_string(),
            &source("FlagredMonitor.cpp"),
            &format!("{stand_ins}/fly.cpp"),
            &object,
            &library().join("libflagred.a").display().to_string(),
            "-o",
            &binary,
        ],
    );
    let output = Command::new(&binary).output().unwrap();
    assert!(output.status.success(), "{output:?}");
    let text = String::from_utf8(output.stdout).unwrap();
    let values = |name: &str| text.lines().filter(|line| line.starts_with(name)).count();
    assert!(values("FR_RISK ") > 60 && values("FR_ELEV ") > 60, "{text}");
    assert!(text.contains("critical FLAGRED: FAIL risk "), "{text}");
}
