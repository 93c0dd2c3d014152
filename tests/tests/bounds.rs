//! Inputs of any size: memory and time are bounded, and the program reports what it omits. Inputs are generated while
//! they are read; nothing large is stored.

use std::{
    fs,
    io::{BufWriter, Write},
    process::{Command, Output, Stdio},
    time::{Duration, Instant},
};

use flagred_tests::{
    Folder, flagred,
    log_writer::{DataFlash, STATUSTEXT, Tlog, ULog, Value},
};
use serde_json::Value as Json;

/// The maximum virtual memory of a call, in kB. Most of it is only reserved by threads and libraries, and never used.
#[cfg(unix)]
const MEMORY_KB: u64 = 1_200_000;

/// Runs the binary with bounded memory; `write` writes its standard input.
#[cfg(unix)]
fn run(arguments: &[&str], memory_kb: u64, write: impl FnOnce(&mut dyn Write) + Send) -> Output {
    let binary = flagred();
    let mut child = Command::new("sh")
        .args(["-c", &format!("ulimit -v {memory_kb}; exec \"$0\" \"$@\"")])
        .arg(binary.get_program())
        .args(arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut input = BufWriter::new(child.stdin.take().unwrap());
    std::thread::scope(|scope| {
        scope.spawn(move || write(&mut input));
        child.wait_with_output().unwrap()
    })
}

/// The document that a call prints.
#[cfg(unix)]
fn json(command: &str, write: impl FnOnce(&mut dyn Write) + Send) -> Json {
    let output = run(&[command, "--json", "-"], MEMORY_KB, write);
    assert!(output.stdout.len() < 40_000_000, "{}", output.stdout.len());
    serde_json::from_slice(&output.stdout)
        .unwrap_or_else(|error| panic!("{error}: {}", String::from_utf8_lossy(&output.stderr)))
}

/// A copter with its definitions and first messages.
fn copter() -> DataFlash {
    let mut log = DataFlash::new();
    log.define(129, "PARM", "QNf", "TimeUS,Name,Value");
    log.define(130, "RCOU", "QHHHH", "TimeUS,C1,C2,C3,C4");
    log.define(132, "EV", "QB", "TimeUS,Id");
    log.define(133, "MSG", "QZ", "TimeUS,Message");
    log.define(134, "MODE", "QMBB", "TimeUS,Mode,ModeNum,Rsn");
    log.write("MSG", [1e6.into(), "ArduCopter V4.5.7 (2a3dc4b7)".into()]);
    for motor in 1..=4 {
        let name = format!("SERVO{motor}_FUNCTION");
        log.parameter(1e6, &name, f64::from(32 + motor));
    }
    log.parameter(1e6, "MOT_PWM_MIN", 1000.0);
    log.parameter(1e6, "MOT_PWM_MAX", 2000.0);
    log
}

/// The bytes that `more` adds to a log.
fn added(log: &mut DataFlash, more: impl FnOnce(&mut DataFlash)) -> Vec<u8> {
    log.bytes.clear();
    more(log);
    std::mem::take(&mut log.bytes)
}

#[cfg(unix)]
#[test]
fn texts_modes_and_parameters_beyond_the_limit_are_counted() {
    let log = json("inspect", |out| {
        let mut log = copter();
        out.write_all(&log.bytes).unwrap();
        let text = added(&mut log, |log| {
            log.write("MSG", [1.1e6.into(), "all is well".into()]);
        });
        for _ in 0..200_000 {
            out.write_all(&text).unwrap();
        }
        for i in 0..30_000 {
            let message = added(&mut log, |log| {
                let time = Value::Number(1.2e6 + f64::from(i));
                let mode = Value::Number(f64::from(i % 3));
                log.write("MODE", [time, mode, mode, 0.0.into()]);
                log.parameter(1.2e6, &format!("P{i}"), 1.0);
            });
            out.write_all(&message).unwrap();
        }
    });
    let left_out = &log["read"]["left_out"];
    assert_eq!(left_out["texts"], 190_001);
    assert_eq!(left_out["modes"], 20_000);
    assert_eq!(left_out["parameters"], 30_006 - 16_384);
    assert_eq!(left_out["messages"], 0);
    assert_eq!(log["messages"].as_array().unwrap().len(), 10_000);
    assert_eq!(log["modes"].as_array().unwrap().len(), 10_000);
}

/// Writes `count` flights of one second each.
fn flights(out: &mut dyn Write, count: u32) {
    let mut log = copter();
    out.write_all(&log.bytes).unwrap();
    let mut t_us = 1e6;
    for _ in 0..count {
        let flight = added(&mut log, |log| {
            log.write("EV", [t_us.into(), 10.0.into()]);
            log.write("EV", [t_us.into(), 28.0.into()]);
            for step in 0..25 {
                t_us += 1e5;
                let pulse = Value::Number(if step < 10 { 1500.0 } else { 1000.0 });
                log.write("RCOU", [t_us.into(), pulse, pulse, pulse, pulse]);
                if step == 10 {
                    log.write("EV", [t_us.into(), 18.0.into()]);
                }
            }
        });
        out.write_all(&flight).unwrap();
    }
}

#[cfg(unix)]
#[test]
fn too_many_take_offs_end_the_flight_and_all_outputs_report_it() {
    let folder = Folder::new();
    let html = folder.at("report.html");
    let log = json("assess", |out| flights(out, 4_000));
    let left_out = log["read"]["left_out"]["messages"].as_u64().unwrap();
    assert!((10_000..20_000).contains(&left_out), "{left_out}");
    let said = format!("the log exceeds the limits of the reader: {left_out} messages");
    let arguments = ["assess", "-", "--html", &html];
    let output = run(&arguments, MEMORY_KB, |out| flights(out, 4_000));
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.contains(&said), "{text}");
    let more = text.split(" more)").next();
    let more = more.and_then(|before| before.rsplit(" and ").next()?.parse::<u32>().ok());
    assert!(more.is_some_and(|more| more > 3_000), "{text}");
    assert!(text.len() < 10_000, "{}", text.len());
    let html = fs::read_to_string(html).unwrap();
    assert!(html.contains(&said));
    assert!(html.len() < 3_000_000, "{}", html.len());
    // An incomplete flight must not be learned from.
    let log = folder.at("flights.bin");
    flights(&mut fs::File::create(&log).unwrap(), 4_000);
    let rows = flagred().args(["dataset", &log]).output().unwrap();
    assert_eq!(rows.status.code(), Some(3), "{rows:?}");
    let reported = String::from_utf8(rows.stderr).unwrap();
    assert!(
        reported.contains("exceeds the limits of the reader"),
        "{reported}"
    );
}

/// Without events, take-offs are detected from the commands, possibly at every row.
#[cfg(unix)]
#[test]
fn take_offs_seen_only_in_the_commands_are_counted() {
    let log = json("inspect", |out| {
        let mut log = copter();
        out.write_all(&log.bytes).unwrap();
        for i in 0..30_000 {
            let row = added(&mut log, |log| {
                let pulse = Value::Number(if i % 2 == 0 { 1000.0 } else { 1500.0 });
                let time = Value::Number(1e6 + 2e6 * f64::from(i));
                log.write("RCOU", [time, pulse, pulse, pulse, pulse]);
            });
            out.write_all(&row).unwrap();
        }
    });
    assert_eq!(log["read"]["left_out"]["changes"], 2 * 20_000);
    let spans = log["in_air"]["spans"].as_array().unwrap();
    assert_eq!(spans.len(), 5_000);
    assert!(spans[4_999]["end_s"].as_f64().unwrap() < 20_010.0);
}

#[cfg(unix)]
#[test]
fn a_line_of_a_text_log_is_bounded() {
    let log = json("inspect", |out| {
        let log = copter();
        out.write_all(log.text.as_bytes()).unwrap();
        out.write_all(b"MSG, 1000000, ").unwrap();
        for _ in 0..50 {
            out.write_all(&[b'a'; 1_000_000]).unwrap();
        }
        // The message after the long line is read.
        out.write_all(b"\nMSG, 1000000, the next line\n").unwrap();
    });
    assert_eq!(log["read"]["bad_messages"], 1);
    assert_eq!(log["read"]["reason"], "a line longer than 4096 bytes");
    assert!(log["read"]["skipped_bytes"].as_u64().unwrap() > 50_000_000);
    assert_eq!(log["messages"][1]["what"], "the next line");
}

#[cfg(unix)]
#[test]
fn texts_and_definitions_of_a_ulog_are_bounded() {
    let log = json("inspect", |out| {
        let mut log = ULog::new(0);
        for i in 0..60 {
            log.define(&format!("topic{i}:{}", "uint64_t timestamp;".repeat(1000)));
        }
        log.define("last:uint64_t timestamp;");
        for _ in 0..5_000 {
            log.announce(0, 1, "topic0");
        }
        let mut text = vec![b'6'];
        text.extend(1_000_000_u64.to_le_bytes());
        text.extend(b"all is well");
        for _ in 0..50_000 {
            log.message(b'L', &text);
        }
        out.write_all(&log.bytes).unwrap();
    });
    assert_eq!(log["read"]["left_out"]["texts"], 40_000);
    assert_eq!(
        log["read"]["reason"],
        "definitions of more than 1 MB in all"
    );
    // The rejected messages are 8 definitions and all announcements after the first 4096.
    assert_eq!(log["read"]["bad_messages"], 8 + 904);
}

#[cfg(unix)]
#[test]
fn texts_of_a_telemetry_log_are_bounded() {
    let log = json("inspect", |out| {
        let mut log = Tlog::default();
        let mut text = vec![6];
        text.extend(b"all is well");
        for i in 0..12_000 {
            let stamp_us = 1_700_000_000_000_000 + i;
            log.packet(stamp_us, 1, (1, 1), STATUSTEXT, &text);
        }
        out.write_all(&log.bytes).unwrap();
    });
    assert_eq!(log["read"]["left_out"]["texts"], 2_000);
    assert_eq!(log["messages"].as_array().unwrap().len(), 10_000);
}

/// Writes a flight CSV of `rows` rows at 100 Hz.
#[cfg(unix)]
fn long_flight(out: &mut dyn Write, rows: u32) {
    out.write_all(b"# pwm_low_us: 1000\n# pwm_high_us: 2000\nt_s,pwm1,pwm2,pwm3,pwm4\n")
        .unwrap();
    for i in 0..rows {
        let t_s = f64::from(i) * 0.01;
        writeln!(out, "{t_s},{},1500,1400,1600", 1400 + i % 200).unwrap();
    }
}

#[cfg(unix)]
#[test]
#[ignore = "takes a minute in a debug build"]
fn steps_are_further_apart_where_there_are_too_many() {
    let arguments = ["assess", "--json", "--step", "0", "-"];
    let output = run(&arguments, MEMORY_KB, |out| long_flight(out, 300_000));
    let log: Json = serde_json::from_slice(&output.stdout).unwrap();
    let steps = log["steps"].as_array().unwrap();
    assert!(
        (125_000..=250_000).contains(&steps.len()),
        "{}",
        steps.len()
    );
    let step_s = log["widened_step_s"].as_f64().unwrap();
    assert!((step_s - 0.02).abs() < 1e-4, "{step_s}");
}

/// Rows beyond the limit are counted and not kept, even if their timestamps are equal or a microsecond apart.
#[cfg(unix)]
#[test]
#[ignore = "reads 1.5 GB: a minute in a release build"]
fn rows_at_one_time_end_the_flight_that_is_kept() {
    for step_us in [0.0, 1.0] {
        let log = json("inspect", |out| {
            let mut log = copter();
            out.write_all(&log.bytes).unwrap();
            for i in 0..40_000_000 {
                let row = added(&mut log, |log| {
                    let time = Value::Number(1e6 + step_us * f64::from(i));
                    let pulse = Value::Number(1500.0);
                    log.write("RCOU", [time, pulse, pulse, pulse, pulse]);
                });
                out.write_all(&row).unwrap();
            }
        });
        let rows = log["commands"]["rows"].as_u64().unwrap();
        assert_eq!(rows, (1_u64 << 26).div_ceil(5));
        assert_eq!(log["read"]["left_out"]["messages"], 40_000_000 - rows);
    }
}

/// Invalid spin limits are reported: with the full range, a motor at its limit may be missed.
#[test]
fn invalid_limits_are_reported() {
    let folder = Folder::new();
    for (low, high) in [(0.9, 0.2), (0.5, 0.55)] {
        let mut log = copter();
        log.parameter(1e6, "MOT_SPIN_MIN", low);
        log.parameter(1e6, "MOT_SPIN_MAX", high);
        let path = folder.file("spin.bin", &log.bytes);
        let output = flagred().args(["assess", &path]).output().unwrap();
        let text = String::from_utf8(output.stdout).unwrap();
        let said = "the effective range is the whole range: MOT_SPIN_MIN/MAX, ";
        assert!(text.contains(said), "{text}");
        assert!(text.contains(", are not valid limits"), "{text}");
    }
}

/// A rule set with the given numbers of inputs, of terms per input and of rules. Each rule is about two inputs.
fn rule_set(
    inputs: usize,
    terms: usize,
    rules: usize,
    conclusion: impl Fn(usize) -> usize,
) -> String {
    let names: Vec<String> = (0..terms).map(|term| format!("t{term}")).collect();
    let names = names.join(", ");
    let mut text = "fuzzy: 1\nname: large\ninputs:\n".to_owned();
    for input in 0..inputs {
        text += &format!("  x{input}: {{range: [0, 1], partition: [{names}]}}\n");
    }
    text += "outputs:\n  y: {range: [0, 1], partition: [t0, t1, t2, t3]}\nrules:\n";
    for rule in 0..rules {
        let (a, b) = (rule % inputs, (rule / inputs + rule) % inputs);
        let (s, t) = (rule / 7 % terms, rule / 11 % terms);
        let and = if a == b {
            String::new()
        } else {
            format!(" AND x{b} IS t{t}")
        };
        text += &format!("  - IF x{a} IS t{s}{and} THEN y IS t{}\n", conclusion(rule));
    }
    text
}

const VARIABLES: &str = "fuzzy: 1\nname: large\n\
    inputs: {x: {range: [0, 1], partition: [low, high]}}\n\
    outputs: {y: {range: [0, 1], partition: [small, large]}}\n";

/// A rule set whose output has this many terms with this many points.
fn piecewise(terms: usize, points: usize) -> String {
    let mut text = "fuzzy: 1\nname: large\ninputs: {x: {range: [0, 1], partition: [low, high]}}\n\
                    outputs: {y: {range: [0, 1], terms: {"
        .to_owned();
    for term in 0..terms {
        let point = |i: usize| {
            let x = i as f64 / points as f64;
            format!(
                "[{x}, {}]",
                0.5 + (i * 7919 % points) as f64 / (2 * points) as f64
            )
        };
        let points: Vec<String> = (0..points).map(point).collect();
        text += &format!("t{term}: {{piecewise: [{}]}}, ", points.join(", "));
    }
    text += "}}}\nrules:\n";
    for rule in 0..terms.max(2) {
        let x = ["low", "high"][rule % 2];
        text += &format!("  - IF x IS {x} THEN y IS t{}\n", rule % terms);
    }
    text
}

/// A rule set of this many rules with this many conclusions each.
fn conclusions(rules: usize, count: usize) -> String {
    let conclusions = vec!["y IS large"; count].join(" AND ");
    let rule = format!("  - IF x IS low THEN {conclusions} AND y IS small\n");
    let rule = match rules {
        1 => rule.replace(" AND y IS small", ""),
        _ => rule.replacen("y IS large AND ", "", 1),
    };
    format!("{VARIABLES}rules:\n{}", rule.repeat(rules))
}

fn blocks(count: usize) -> String {
    let block = |i| format!("  b{i}: {{rules: [IF x IS low THEN y IS small]}}\n");
    let blocks: String = (0..count).map(block).collect();
    format!("{VARIABLES}blocks:\n{blocks}")
}

fn formula(start: &str) -> String {
    VARIABLES.replace(
        "partition: [small, large]",
        &format!("terms: {{small: {{function: \"{start}1\"}}}}"),
    ) + "rules: [IF x IS low THEN y IS small]\n"
}

/// Files of other programs, below 4 MB, in which a part is repeated many times.
#[test]
fn files_of_other_programs_are_refused_in_time() {
    let folder = Folder::new();
    let input = "InputVariable: x\n range: 0 1\n term: a Triangle 0 0.2 1\n";
    let output = |name: usize| {
        format!(
            "OutputVariable: o{name}\n range: 0 1\n aggregation: Maximum\n defuzzifier: Centroid 10\n term: t Triangle 0 0.2 1\n"
        )
    };
    let fll = |sections: String| format!("Engine: large\n{input}{sections}");
    let terms: String = (0..100_000)
        .map(|i| format!(" term: t{i} Triangle 0 0.5 1\n"))
        .collect();
    let inputs: String = (0..80_000)
        .map(|i| format!("InputVariable: x{i}\n range: 0 1\n"))
        .collect();
    let outputs: String = (0..60).map(output).collect();
    // Each rule contains the previous one twice.
    let doubled: String = (1..60)
        .map(|i| format!(" rule: if o{0} is t or o{0} is t then o{i} is t\n", i - 1))
        .collect();
    let nested: String = (1..60)
        .map(|i| {
            format!(
                " rule: if x is a and (not o{0} is t or x is a) then o{i} is t\n",
                i - 1
            )
        })
        .collect();
    let block = "RuleBlock:\n conjunction: Minimum\n disjunction: Maximum\n implication: Minimum\n rule: if x is a then o0 is t\n";
    let conclusions = vec!["o0 is very t"; 150_000].join(" and ");
    let attributes: String = (0..100_000).map(|i| format!(" a{i}=\"1\"")).collect();
    let namespaces: String = (0..4_000)
        .map(|i| format!("<a xmlns:a{i}=\"u{i}\">"))
        .collect();
    let sums = "1 + ".repeat(900_000);
    for (name, file, text, said) in [
        (
            "terms",
            "large.fll",
            fll(terms),
            "there are more than 1000 terms of `x`",
        ),
        (
            "inputs",
            "large.fll",
            fll(inputs),
            "there are more than 1000 inputs",
        ),
        (
            "blocks",
            "large.fll",
            fll(output(0) + &"RuleBlock:\n".repeat(300_000)),
            "there are more than 1000 rule blocks",
        ),
        (
            "doubled",
            "large.fll",
            fll(format!("{outputs}{block}{doubled}")),
            "too many conditions",
        ),
        (
            "nested",
            "large.fll",
            fll(format!("{outputs}{block}{nested}")),
            "too many conditions",
        ),
        (
            "hedges",
            "large.fll",
            fll(format!(
                "{}RuleBlock:\n rule: if x is a then {conclusions}\n",
                output(0)
            )),
            "at most 64 hedges",
        ),
        (
            "formula",
            "large.fll",
            fll(format!(" term: f Function {sums}1\n")),
            "the formula has more than 1000 parts",
        ),
        (
            "attributes",
            "large.fml",
            format!("<fuzzySystem name=\"large\"><knowledgeBase{attributes}/></fuzzySystem>"),
            "an element has more than 1000 attributes",
        ),
        (
            "elements in elements",
            "large.fml",
            format!(
                "<fuzzySystem name=\"large\">{}</fuzzySystem>",
                "<a>".repeat(900_000)
            ),
            "elements are nested more than 256 levels deep",
        ),
        (
            "namespaces",
            "large.fml",
            format!(
                "<fuzzySystem name=\"large\">{namespaces}{}</fuzzySystem>",
                "</a>".repeat(4_000)
            ),
            "there are more than 100 declarations of namespaces",
        ),
    ] {
        assert!(text.len() < 4_000_000, "{name}");
        let path = folder.file(file, text);
        for command in ["check", "import"] {
            let started = Instant::now();
            let output = flagred().args([command, &path]).output().unwrap();
            assert!(
                started.elapsed() < Duration::from_secs(30),
                "{name}: {:?}",
                started.elapsed()
            );
            let reported = [output.stdout, output.stderr].concat();
            let reported = String::from_utf8(reported).unwrap();
            assert!(matches!(output.status.code(), Some(1 | 3)), "{name}");
            assert!(
                reported.contains(said),
                "{name}: {}",
                &reported[..reported.len().min(1_000)]
            );
        }
    }
}

/// A chain is evaluated once for all its curves.
#[test]
fn a_long_chain_is_drawn_in_time() {
    let folder = Folder::new();
    let mut text =
        "fuzzy: 1\nname: chain\ninputs: {x: {range: [0, 1], partition: [low, high]}}\noutputs:\n"
            .to_owned();
    let mut rules = String::new();
    for i in 0..999 {
        text += &format!("  y{i}: {{range: [0, 1], partition: [low, high]}}\n");
        let before = if i == 0 {
            "x".to_owned()
        } else {
            format!("y{}", i - 1)
        };
        for term in ["low", "high"] {
            rules += &format!("  - IF {before} IS {term} THEN y{i} IS {term}\n");
        }
    }
    let path = folder.file("chain.yaml", format!("{text}rules:\n{rules}"));
    let svg = folder.at("chain.svg");
    let started = Instant::now();
    let output = flagred()
        .args(["plot", &path, "--svg", &svg])
        .output()
        .unwrap();
    assert!(output.status.success(), "{output:?}");
    assert!(
        started.elapsed() < Duration::from_secs(30),
        "{:?}",
        started.elapsed()
    );
}

#[test]
fn tables_with_too_many_columns_are_not_searched_for_inputs() {
    let folder = Folder::new();
    let names: Vec<String> = (0..50_000).map(|i| format!("c{i}")).collect();
    let row = |i: usize| format!("{i}{}\n", format!(",{}", i * i).repeat(names.len()));
    let rows: String = (0..5).map(row).collect();
    let table = folder.file("wide.csv", format!("y,{}\n{rows}", names.join(",")));
    let started = Instant::now();
    let output = folder.at("identified.yaml");
    let output = flagred()
        .args(["identify", &table, "--target", "y", "--output", &output])
        .output()
        .unwrap();
    assert!(
        started.elapsed() < Duration::from_secs(30),
        "{:?}",
        started.elapsed()
    );
    assert_eq!(output.status.code(), Some(3));
    let reported = String::from_utf8(output.stderr).unwrap();
    assert!(
        reported.contains("50000 columns exceed the limit of 500"),
        "{reported}"
    );
    assert!(reported.contains("--input"), "{reported}");
}

#[test]
fn large_rule_sets_are_checked_in_time() {
    let folder = Folder::new();
    let wrong = rule_set(2, 2, 20_000, |_| 9);
    for (name, text, code, said) in [
        (
            "10,000 rules",
            rule_set(20, 10, 10_000, |rule| rule % 4),
            0,
            "more findings; `flagred",
        ),
        (
            "equal rules",
            rule_set(1, 2, 10_000, |_| 0),
            0,
            "more findings; `flagred",
        ),
        (
            "contradictory rules",
            rule_set(1, 2, 10_000, |rule| rule % 4),
            0,
            "more findings; `flagred",
        ),
        ("wrong rules", wrong, 1, "1001 errors"),
        (
            "100,000 terms",
            rule_set(1, 100_000, 2, |_| 0),
            1,
            "100000 terms of `x0` are more than the maximum of 1000",
        ),
        (
            "terms in all",
            rule_set(20, 1000, 2, |_| 0),
            1,
            "20004 terms are more than the maximum of 10000",
        ),
        (
            "inputs",
            rule_set(20_000, 2, 2, |_| 0),
            1,
            "20001 inputs and outputs are more than the maximum of 1000",
        ),
        (
            "rules",
            rule_set(1, 2, 100_001, |_| 0),
            1,
            "100001 rules are more than the maximum of 100000",
        ),
        (
            "points of a term",
            piecewise(1, 100_000),
            1,
            "100000 points of the term `t0` are more than the maximum of 2000",
        ),
        (
            "points in all",
            piecewise(200, 1_000),
            1,
            "200000 points of `piecewise` terms are more than the maximum of 20000",
        ),
        (
            "as many points as there may be",
            piecewise(10, 2_000),
            0,
            "",
        ),
        (
            "conclusions of a rule",
            conclusions(1, 200_000),
            1,
            "200000 conclusions of rule 1 are more than the maximum of 100",
        ),
        (
            "as many conclusions as there may be",
            conclusions(200, 100),
            0,
            "contradict",
        ),
        (
            "rule blocks",
            blocks(50_000),
            1,
            "50000 rule blocks are more than the maximum of 1000",
        ),
        (
            "a sum in a formula",
            formula(&"1 + ".repeat(900_000)),
            1,
            "the formula has more than 1000 parts",
        ),
        (
            "brackets in a formula",
            formula(&"(".repeat(900_000)),
            1,
            "brackets, signs and powers are nested more than 64 levels deep",
        ),
    ] {
        let path = folder.file("large.yaml", text);
        let started = Instant::now();
        let output = flagred().args(["check", &path]).output().unwrap();
        // 30 s is enough for a debug build on a busy machine. With quadratic time, these inputs would take minutes to
        // hours.
        assert!(
            started.elapsed() < Duration::from_secs(30),
            "{name}: {:?}",
            started.elapsed()
        );
        let text = String::from_utf8(output.stdout).unwrap();
        assert_eq!(output.status.code(), Some(code), "{name}");
        assert!(
            text.contains(said),
            "{name}: {}",
            &text[text.len().saturating_sub(500)..]
        );
        assert!(text.len() < 200_000, "{name}: {}", text.len());
    }
}

#[test]
fn large_rule_sets_are_used_in_time() {
    let folder = Folder::new();
    let inputs = 20;
    let rules = folder.file("large.yaml", rule_set(inputs, 10, 10_000, |rule| rule % 4));
    let names: Vec<String> = (0..inputs).map(|input| format!("x{input}")).collect();
    let values: Vec<String> = names.iter().map(|name| format!("{name}=0.4")).collect();
    let points = format!("{}\n{}\n", names.join(","), vec!["0.4"; inputs].join(","));
    let points = folder.file("points.csv", points);
    let explain: Vec<&str> = ["explain", &rules]
        .into_iter()
        .chain(values.iter().map(String::as_str))
        .collect();
    for arguments in [&["eval", &rules, &points][..], &explain] {
        let started = Instant::now();
        let output = flagred().args(arguments).output().unwrap();
        assert!(output.status.success(), "{output:?}");
        assert!(
            started.elapsed() < Duration::from_secs(30),
            "{:?}",
            started.elapsed()
        );
    }
}

/// A term with many coefficients for the same input is reported in time.
#[test]
fn names_that_repeat_are_found_in_time() {
    let folder = Folder::new();
    let repeated = "x: 1, ".repeat(60_000);
    let text = format!(
        "fuzzy: 1\nname: repeated\ninputs: {{x: {{range: [0, 1], partition: [low, high]}}}}\n\
         outputs: {{y: {{range: [0, 1], defuzzifier: weighted_average, terms: {{a: {{linear: {{{repeated}}}}}}}}}}}\n\
         rules: [IF x IS low THEN y IS a]\n"
    );
    let path = folder.file("repeated.yaml", text);
    let started = Instant::now();
    let output = flagred().args(["check", &path]).output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    assert!(output.stdout.len() < 200_000);
    assert!(
        started.elapsed() < Duration::from_secs(30),
        "{:?}",
        started.elapsed()
    );
}

/// Passes one endless cell, and a header with many columns, to every reader of tables.
#[cfg(unix)]
#[test]
fn tables_are_bounded() {
    let folder = Folder::new();
    let rules = folder.file("large.yaml", rule_set(1, 2, 2, |_| 0));
    let output = folder.at("learned.yaml");
    for arguments in [
        &["eval", &rules, "-"][..],
        &["learn", &rules, "-", "--output", &output],
        &["validate", "-"],
    ] {
        for start in ["x0,y\n0.5,", "x0,y\n0.5,\"", "x0"] {
            let output = run(arguments, 600_000, |out| {
                // The reader may stop before everything is written.
                let _ = out.write_all(start.as_bytes());
                for _ in 0..1000 {
                    if out.write_all(&[b'5'; 1_000_000]).is_err() {
                        return;
                    }
                }
            });
            let reported = String::from_utf8(output.stderr).unwrap();
            assert_ne!(output.status.code(), Some(0), "{arguments:?}: {reported}");
            assert!(output.status.code().is_some(), "{arguments:?}: {reported}");
        }
    }
    let wide: Vec<String> = (0..100_000).map(|column| format!("c{column}")).collect();
    let header = wide.join(",");
    let points = folder.file(
        "wide.csv",
        format!("x0,{header}\n0.5{}\n", ",1".repeat(100_000)),
    );
    let started = Instant::now();
    let evaluated = flagred().args(["eval", &rules, &points]).output().unwrap();
    assert!(evaluated.status.success(), "{evaluated:?}");
    assert!(
        started.elapsed() < Duration::from_secs(30),
        "{:?}",
        started.elapsed()
    );
}

/// The rows of docs/limits.md that name a constant.
#[test]
fn the_table_of_limits_agrees_with_the_constants() {
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/..");
    let table = fs::read_to_string(format!("{root}/docs/limits.md")).unwrap();
    let mut compared = 0;
    for row in table.lines().filter(|line| line.starts_with("| ")) {
        let cells: Vec<&str> = row.trim_matches('|').split('|').map(str::trim).collect();
        let Some((path, name)) = cells.last().and_then(|cell| {
            let (path, name) = cell
                .strip_prefix('`')?
                .strip_suffix('`')?
                .split_once("` `")?;
            path.ends_with(".rs").then_some((path, name))
        }) else {
            continue;
        };
        let source = fs::read_to_string(format!("{root}/{path}")).unwrap();
        let line = source
            .lines()
            .find(|line| line.contains(&format!("const {name}: ")))
            .unwrap_or_else(|| panic!("{path} has no {name}"));
        let value = line.split_once("= ").unwrap().1.trim_end_matches(';');
        let value = match value.split_once(" << ") {
            Some(("1", bits)) => 1_u64 << bits.parse::<u32>().unwrap(),
            _ => value.replace('_', "").parse().unwrap(),
        };
        let reported = &cells[cells.len() - 3];
        let digits: String = reported
            .chars()
            .take_while(|c| c.is_ascii_digit() || *c == ',')
            .filter(char::is_ascii_digit)
            .collect();
        assert_eq!(digits.parse(), Ok(value), "{row}");
        compared += 1;
    }
    assert!(compared > 40, "{compared}");
}
