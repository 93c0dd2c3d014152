//! Every limit of docs/limits.md, on the command line: larger inputs are rejected quickly, with a message.

use std::{
    fs,
    process::{Output, Stdio},
    time::{Duration, Instant},
};

use flagred_tests::{
    Folder, flagred,
    log_writer::{DataFlash, Value},
};

const RULE_SET: &str = "fuzzy: 1\nname: wind\ninputs: {wind: {range: [0, 20], partition: [calm, storm]}}\n\
    outputs: {risk: {range: [0, 100], partition: [low, high]}}\n\
    rules: [IF wind IS calm THEN risk IS low, IF wind IS storm THEN risk IS high]\n";

fn profile(rules: &str) -> String {
    format!("flagred: 1\nname: wind\nrules: {rules}\ninputs: {{wind: {{last: wind_m_s}}}}\n")
}

fn run(arguments: &[&str]) -> Output {
    let mut command = flagred();
    let started = Instant::now();
    let output = command.args(arguments).output().unwrap();
    // 20 s is enough for a debug build on a busy machine. Without the limits under test, these inputs would take
    // minutes or all memory.
    assert!(
        started.elapsed() < Duration::from_secs(20),
        "{arguments:?} took {:?}",
        started.elapsed()
    );
    output
}

/// Asserts that a call ends with exit code 3 and that its standard error contains `message`.
fn refused(arguments: &[&str], message: &str) {
    let output = run(arguments);
    let reported = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(3), "{arguments:?}: {reported}");
    assert!(reported.contains(message), "{arguments:?}: {reported}");
}

#[test]
fn rule_sets_and_profiles_have_a_size_limit() {
    let folder = Folder::new();
    let comments = folder.file("comments.yaml", "# nothing\n".repeat(10_000_000));
    let said = "is larger than 4 MB";
    refused(&["check", &comments], said);
    refused(&["export", "--c", &comments], said);
    refused(
        &[
            "export",
            "--c",
            &folder.file("p.yaml", profile("comments.yaml")),
        ],
        said,
    );
    #[cfg(unix)]
    for command in [&["check", "/dev/zero"][..], &["export", "--c", "/dev/zero"]] {
        refused(command, said);
    }
    let largest = format!("{RULE_SET}{}", "#".repeat(4_000_000 - RULE_SET.len()));
    let output = run(&["check", &folder.file("largest.yaml", &largest)]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    refused(&["check", &folder.file("larger.yaml", largest + "#")], said);
}

/// A profile may come from an untrusted source.
#[test]
fn many_rules_are_not_simplified_and_many_inputs_not_mapped() {
    let folder = Folder::new();
    let rule = "  - IF wind IS calm THEN risk IS low\n";
    let rules = RULE_SET.split_once("rules:").unwrap().0.to_owned() + "rules:\n";
    let many = folder.file("many.yaml", rules + &rule.repeat(20_000));
    let out = folder.at("out.yaml");
    refused(
        &["simplify", &many, "-o", &out],
        "the rule set has 20000 rules; at most 1000 are simplified",
    );
    let input = |i: u32| format!("  x{i}: {{range: [0, 1], partition: [low, high]}}\n");
    let inputs: String = (0..17).map(input).collect();
    let wide = format!(
        "fuzzy: 1\nname: wide\ninputs:\n{inputs}outputs: {{y: {{range: [0, 1], partition: [low, high]}}}}\n\
         rules: [IF x0 IS low THEN y IS low]\n"
    );
    refused(
        &["map", "--csv", &folder.file("wide.yaml", wide)],
        "the grid has 129140163 cells; a map has at most 10000000",
    );
}

#[test]
fn a_long_cell_is_quoted_by_its_beginning() {
    let folder = Folder::new();
    let rules = folder.file("wind.yaml", RULE_SET);
    let long = "9x".repeat(100_000);
    for table in [
        format!("wind\n{long}\n"),
        format!("wind,{long},{long}\n1,2,3\n"),
        format!("{long}\n1\n"),
    ] {
        let output = run(&["eval", &rules, &folder.file("rows.csv", table)]);
        assert!(output.stderr.len() < 1_000, "{}", output.stderr.len());
    }
}

#[test]
fn a_profile_names_rule_sets_of_its_own_folder() {
    let folder = Folder::new();
    fs::create_dir(folder.at("own")).unwrap();
    folder.file("wind.yaml", RULE_SET);
    folder.file("own/beside.yaml", RULE_SET);
    let absolute = folder.at("wind.yaml");
    let said = "which is not in the profile's folder";
    let named = folder.at("own/profile.yaml");
    let export = ["export", "--c", &named];
    for rules in ["../wind.yaml", &absolute] {
        folder.file("own/profile.yaml", profile(rules));
        refused(&export, said);
        let allowed = flagred()
            .args(export)
            .env("FLAGRED_RULES", folder.path())
            .output()
            .unwrap();
        assert!(allowed.status.success(), "{allowed:?}");
    }
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink(&absolute, folder.at("own/link.yaml")).unwrap();
        folder.file("own/profile.yaml", profile("link.yaml"));
        refused(&export, said);
    }
    folder.file("own/profile.yaml", profile("beside.yaml"));
    assert!(run(&export).status.success());
    // A profile can be named without its folder.
    let here = flagred()
        .args(["export", "--c", "profile.yaml"])
        .current_dir(folder.at("own"))
        .output()
        .unwrap();
    assert!(here.status.success(), "{here:?}");
}

/// A small compressed file can contain a row that fills the memory.
#[test]
fn rows_headers_and_columns_of_a_flight_csv_are_bounded() {
    let folder = Folder::new();
    let names = "t_s,motor1\n";
    for (name, start, repeated, said) in [
        (
            "cell",
            "t_s,motor1\n0,",
            "5",
            "line 2: the row is longer than 1000000 bytes",
        ),
        (
            "names",
            "t_s,motor1,",
            "x",
            "line 1: the row is longer than 1000000 bytes",
        ),
        (
            "quoted",
            "t_s,motor1\n0,\"",
            "5\n",
            "line 2: the row is longer than 1000000 bytes",
        ),
        (
            "commas",
            "t_s,motor1\n0.5",
            ",",
            "line 2: the row is longer than 1000000 bytes",
        ),
        ("header", "# note: ", "x", "not a flight log"),
        ("headers", "# a: b\n", "# a: b\n", "not a flight log"),
    ] {
        let block = repeated.repeat(1_000_000 / repeated.len());
        let path = folder.at(name);
        let mut packed = flate2::write::GzEncoder::new(
            fs::File::create(&path).unwrap(),
            flate2::Compression::fast(),
        );
        std::io::Write::write_all(&mut packed, start.as_bytes()).unwrap();
        for _ in 0..100 {
            std::io::Write::write_all(&mut packed, block.as_bytes()).unwrap();
        }
        std::io::Write::write_all(&mut packed, names.as_bytes()).unwrap();
        packed.finish().unwrap();
        refused(&["inspect", &path], said);
    }
    let columns: String = (0..4095).map(|i| format!(",s{i}")).collect();
    let wide = folder.file(
        "wide.csv",
        format!("t_s{columns}\n0{}\n", ",1".repeat(4095)),
    );
    assert!(
        !String::from_utf8(run(&["inspect", &wide]).stderr)
            .unwrap()
            .contains("columns")
    );
    let wider = folder.file("wider.csv", format!("t_s{columns},more\n"));
    refused(
        &["inspect", &wider],
        "line 1: there are 4097 columns, more than 4096",
    );
    let twice = folder.file("twice.csv", "t_s,a,b,a\n");
    refused(&["inspect", &twice], "the column `a` occurs twice");
}

/// A single damaged time must not make all later times count as times that go back.
#[test]
fn a_time_of_another_millennium_loses_only_its_row() {
    let folder = Folder::new();
    let log = folder.file(
        "far.csv",
        "t_s,pwm1,pwm2,pwm3,pwm4\n0,1500,1500,1500,1500\n7e40,1500,1500,1500,1500\n-1e15,1500,1500,1500,1500\n\
         0.02,1500,1500,1500,1500\n",
    );
    let output = run(&["inspect", &log, "--json"]);
    let document: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(document["read"]["bad_messages"], 2, "{document}");
    assert_eq!(document["read"]["messages"], 2, "{document}");
    let reported = document.to_string();
    assert!(
        reported.contains("line 3: the time is beyond 100000000000000 s"),
        "{reported}"
    );
}

#[test]
fn a_report_shows_the_first_flight_modes_and_counts_the_rest() {
    let mut log = DataFlash::new();
    log.define(129, "PARM", "QNf", "TimeUS,Name,Value");
    log.define(130, "RCOU", "QHHHH", "TimeUS,C1,C2,C3,C4");
    log.define(132, "EV", "QB", "TimeUS,Id");
    log.define(133, "MSG", "QZ", "TimeUS,Message");
    log.define(134, "MODE", "QMBB", "TimeUS,Mode,ModeNum,Rsn");
    log.write("MSG", [1e6.into(), "ArduCopter V4.5.7 (2a3dc4b7)".into()]);
    for motor in 1..=4 {
        log.parameter(
            1e6,
            &format!("SERVO{motor}_FUNCTION"),
            f64::from(32 + motor),
        );
    }
    log.parameter(1e6, "MOT_PWM_MIN", 1000.0);
    log.parameter(1e6, "MOT_PWM_MAX", 2000.0);
    for row in 0..30_000 {
        let time = Value::Number(1e6 + 1e4 * f64::from(row));
        if let Some(event) = [(10, 10.0), (20, 28.0)].iter().find(|event| event.0 == row) {
            log.write("EV", [time, event.1.into()]);
        }
        let mode = Value::Number(f64::from(row % 3));
        log.write("MODE", [time, mode, mode, 0.0.into()]);
        log.write(
            "RCOU",
            [
                time,
                1500.0.into(),
                1500.0.into(),
                1500.0.into(),
                1500.0.into(),
            ],
        );
    }
    let folder = Folder::new();
    let (log, report) = (
        folder.file("modes.bin", &log.bytes),
        folder.at("report.html"),
    );
    assert!(run(&["assess", &log, "--html", &report]).status.success());
    let html = fs::read_to_string(report).unwrap();
    let more = html
        .split("and ")
        .find(|rest| rest.contains(" more flight modes"));
    let more = more.and_then(|rest| rest.split(' ').next()?.parse::<usize>().ok());
    assert!(more.is_some_and(|more| more > 9_000), "{more:?}");
    assert!(html.contains("20000 flight modes are left out"));
    assert!(html.len() < 2_000_000, "{}", html.len());
}

#[test]
fn a_file_that_is_not_a_rule_set_is_not_quoted() {
    let folder = Folder::new();
    folder.file(
        "secret.txt",
        "root:x:0:0:root:/root:/bin/sh\npassword: {hunter2\n",
    );
    let named = folder.file("profile.yaml", profile("secret.txt"));
    let output = run(&["export", "--c", &named]);
    let reported = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(3));
    assert!(
        reported.contains("secret.txt`, which is not a rule set"),
        "{reported}"
    );
    assert!(
        !reported.contains("root:") && !reported.contains("hunter2"),
        "{reported}"
    );
    // The content is not shown either if the file itself is named as a rule set or as a profile.
    let texts = [
        "root:x:0:0:root:/root:/bin/sh\npassword: {hunter2\n",
        "root:x:0:0:root:/root:/bin/sh\nhunter2",
        "- root: hunter2\n",
        "user: root:x\npassword: hunter2\nlogin: [hunter2\n",
        "'root:x'\n",
        "# password: hunter2\n",
    ];
    for text in texts {
        let file = folder.file("other.txt", text);
        for arguments in [
            &["check", &file][..],
            &["check", "--json", &file],
            &["explain", &file],
            &["export", "--c", &file],
        ] {
            let output = run(arguments);
            assert_ne!(output.status.code(), Some(0), "{arguments:?}");
            let reported = [output.stdout, output.stderr].concat();
            let reported = String::from_utf8(reported).unwrap();
            assert!(
                !reported.contains("root:") && !reported.contains("hunter2"),
                "{arguments:?}: {reported}"
            );
        }
    }
    // A file that looks like a rule set is quoted, so that its author finds the mistake.
    folder.file("secret.txt", RULE_SET.replace("IS calm", "IS clam"));
    refused(&["export", "--c", &named], "did you mean `calm`?");
}

#[cfg(unix)]
#[test]
fn a_rule_set_is_read_from_a_pipe_and_waiting_can_be_interrupted() {
    let folder = Folder::new();
    let pipe = folder.at("pipe");
    let made = std::process::Command::new("mkfifo").arg(&pipe).status();
    assert!(made.unwrap().success());
    let check = || {
        let mut command = flagred();
        command.args(["check", &pipe]).stdout(Stdio::null());
        command.spawn().unwrap()
    };
    let mut running = check();
    fs::write(&pipe, RULE_SET).unwrap();
    assert_eq!(running.wait().unwrap().code(), Some(0));

    let mut waiting = check();
    std::thread::sleep(Duration::from_millis(300));
    assert!(waiting.try_wait().unwrap().is_none());
    let id = waiting.id().to_string();
    let kill = std::process::Command::new("kill")
        .args(["-INT", &id])
        .status();
    assert!(kill.unwrap().success());
    let ended = std::os::unix::process::ExitStatusExt::signal(&waiting.wait().unwrap());
    assert_eq!(ended, Some(2));
}
