//! A closed output pipe changes neither the written files nor the exit code.
#![cfg(unix)]

use std::{
    fs,
    io::{BufRead, BufReader, Read, Write},
    path::Path,
    process::{Command, Stdio},
    thread,
    time::{Duration, Instant},
};

use flagred_flightlog::mavlink::{Sender, Version, dialect::MavType};
use flagred_tests::{
    Folder, STEADY, flagred,
    vehicle::{StandIn, flight, heartbeat},
    wire::{Link, Speed, Wire},
    writing::{RULES, wild_flight},
};

/// The exit code and errors of a command whose reader reads only `read` bytes of its output, or the whole output.
fn ended(arguments: &[&str], read: Option<usize>) -> (Option<i32>, String) {
    let mut child = flagred()
        .args(arguments)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut out = child.stdout.take().unwrap();
    match read {
        None => {
            out.read_to_end(&mut Vec::new()).unwrap();
        }
        Some(bytes) => out.read_exact(&mut vec![0; bytes]).unwrap(),
    }
    drop(out);
    let mut reported = String::new();
    let mut err = child.stderr.take().unwrap();
    err.read_to_string(&mut reported).unwrap();
    (child.wait().unwrap().code(), reported)
}

#[test]
fn a_closed_pipe_does_not_change_the_exit_code() {
    let folder = Folder::new();
    let log = &folder.file("log.csv", wild_flight(40));
    let still = &folder.file("still.csv", "t_s,motor1,in_air\n0,0.5,0\n1,0.5,0\n");
    let points = &folder.file(
        "points.csv",
        "margin,spread\n".to_owned() + &"0.1,0.1\n".repeat(50_000),
    );
    let bad = &folder.file(
        "bad.csv",
        "margin,spread\n".to_owned() + &"0.1,0.1\n".repeat(50_000) + "x,1\n",
    );
    let faulty = &folder.file("faulty.yaml", "fuzzy: 9\n");
    for (arguments, code) in [
        (vec!["assess", log], 1),
        (vec!["assess", "-v", log], 1),
        (vec!["assess", "--json", log], 1),
        (vec!["assess", "--csv", "--step", "0", log], 1),
        (vec!["assess", log, log, log], 1),
        (vec!["assess", "--json", log, STEADY], 1),
        (vec!["assess", STEADY], 0),
        (vec!["assess", "--json", still], 3),
        (vec!["inspect", log], 0),
        (vec!["inspect", "--json", log], 0),
        (vec!["inspect", log, "nowhere"], 3),
        (vec!["convert", STEADY, "-o", "-"], 0),
        (vec!["check", RULES, "--deny", "notes"], 1),
        (vec!["check", faulty], 1),
        (vec!["check", faulty, "--json"], 1),
        (vec!["check", RULES, faulty, "--format", "sarif"], 1),
        (vec!["check", RULES, "--format", "github"], 0),
        (vec!["map", RULES], 0),
        (vec!["map", RULES, "--csv"], 0),
        (vec!["explain", RULES, "margin=0.1", "spread=0.1"], 0),
        (vec!["eval", RULES, points], 0),
        (vec!["eval", RULES, bad], 1),
        (vec!["dataset", STEADY], 0),
        (vec!["validate", STEADY], 0),
        (vec!["export", "--c"], 0),
        (vec!["man"], 0),
        (vec!["completions", "bash"], 0),
        (vec!["new", "mine", "-o", "-"], 0),
    ] {
        for read in [None, Some(0), Some(1)] {
            let (ended, reported) = ended(&arguments, read);
            assert_eq!(
                ended,
                Some(code),
                "{arguments:?}, {read:?} bytes read: {reported}"
            );
            assert!(
                !reported.contains("roken pipe"),
                "{arguments:?}: {reported}"
            );
        }
    }
}

/// `flagred assess x --html report.html | true`
#[test]
fn reports_are_written_despite_a_closed_pipe() {
    let folder = Folder::new();
    let log = &folder.file("log.csv", wild_flight(40));
    let (html, svg) = (&folder.at("report.html"), &folder.at("risk.svg"));
    let rows = &folder.file("rows.csv", "margin,spread,risk\n0.1,0.1,50\n");
    let learned = &folder.at("learned.yaml");
    for (arguments, code, files) in [
        (
            vec!["assess", log, "--html", html, "--svg", svg],
            1,
            vec![html, svg],
        ),
        (vec!["assess", "--json", log, "--html", html], 1, vec![html]),
        (
            vec!["assess", "--csv", log, log, "--html", html],
            1,
            vec![html],
        ),
        (
            vec!["learn", RULES, rows, "-o", learned, "--force"],
            0,
            vec![learned],
        ),
    ] {
        let (ended, reported) = ended(&arguments, Some(0));
        assert_eq!(ended, Some(code), "{arguments:?}: {reported}");
        for file in files {
            assert!(fs::metadata(file).unwrap().len() > 500, "{arguments:?}");
            fs::remove_file(file).unwrap();
        }
    }
}

/// If nobody reads, the pipe becomes full, but the report is written.
#[test]
fn reports_are_written_before_a_full_pipe_blocks() {
    let folder = Folder::new();
    let log = folder.file("log.csv", wild_flight(60));
    let html = folder.at("report.html");
    let mut child = flagred()
        .args([
            "assess", "--csv", "--step", "0", &log, &log, &log, "--html", &html,
        ])
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    wait_for(|| Path::new(&html).exists());
    assert!(
        child.try_wait().unwrap().is_none(),
        "the output fits into the pipe"
    );
    let mut all = Vec::new();
    child.stdout.take().unwrap().read_to_end(&mut all).unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(1));
    assert!(all.len() > 70_000, "{}", all.len());
}

/// A report on standard output is a complete document: the text goes to standard error.
#[test]
fn only_the_report_is_written_to_standard_output() {
    let output = flagred()
        .args(["assess", STEADY, "--html", "-"])
        .output()
        .unwrap();
    let page = String::from_utf8(output.stdout).unwrap();
    assert!(page.starts_with("<!DOCTYPE html>") && page.ends_with("</html>"));
    let words = String::from_utf8(output.stderr).unwrap();
    assert!(words.starts_with("GOOD "), "{words}");
}

/// A stream has no end: its evaluation ends when the reader closes the pipe.
#[test]
fn an_endless_evaluation_ends_when_its_reader_closes() {
    let mut child = flagred()
        .args(["eval", RULES, "-"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let mut points = child.stdin.take().unwrap();
    let rows = "0.1,0.1\n".repeat(4096);
    let start = Instant::now();
    let mut sent = points.write_all(b"margin,spread\n");
    while sent.is_ok() && start.elapsed() < Duration::from_secs(20) {
        sent = points.write_all(rows.as_bytes());
    }
    assert!(sent.is_err(), "it reads on");
    assert_eq!(child.wait().unwrap().code(), Some(0));
}

/// Receivers of warnings and readers of the recording still need the watch.
#[test]
fn a_watch_without_a_reader_continues_recording() {
    let folder = Folder::new();
    let file = folder.at("recorded.tlog");
    let mut child = flagred()
        .args(["watch", "udpin:127.0.0.1:0", "--jsonl", "--record", &file])
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut lines = BufReader::new(child.stdout.take().unwrap()).lines();
    let started = lines.next().unwrap().unwrap();
    let address = started.split_once("listening at ").unwrap().1;
    let address = address.split_once('"').unwrap().0.parse().unwrap();
    let reader =
        thread::spawn(move || lines.find(|line| line.as_ref().unwrap().contains("\"ready\"")));
    let flight = flight(Path::new(STEADY));
    let mut vehicle = StandIn::new(&flight, Wire::udp(address), Link::default(), Version::V2);
    while !reader.is_finished() {
        vehicle.beat(false, false);
        vehicle.linger(Duration::from_millis(10));
    }
    // The reader has ended and closed the pipe.
    assert!(reader.join().unwrap().is_some());
    let before = fs::metadata(&file).unwrap().len();
    let air = flight.in_air.as_ref().unwrap().spans[0];
    vehicle.fly(&flight, Speed::Times(60.0), air.start_s, air.start_s + 60.0);
    wait_for(|| fs::metadata(&file).unwrap().len() > before + 10_000);
    assert!(!vehicle.received.values("FR_RISK").is_empty());
    let interrupt = format!("kill -INT {}", child.id());
    assert!(
        Command::new("sh")
            .args(["-c", &interrupt])
            .status()
            .unwrap()
            .success()
    );
    assert_eq!(child.wait().unwrap().code(), Some(0));
}

#[test]
fn a_watch_without_any_purpose_ends() {
    let mut child = flagred()
        .args(["watch", "udpin:127.0.0.1:0", "--no-send"])
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut lines = BufReader::new(child.stdout.take().unwrap());
    let mut first = String::new();
    lines.read_line(&mut first).unwrap();
    let address = first.split_once("listening at ").unwrap().1;
    let address = address.split_once(',').unwrap().0.to_owned();
    drop(lines);
    let socket = std::net::UdpSocket::bind("127.0.0.1:0").unwrap();
    // `watch` prints something for each vehicle, and so notices that the pipe is closed.
    for system in (1..=250).cycle().take(1000) {
        let beat = Sender::new(1).packet(
            Version::V2,
            system,
            &heartbeat(MavType::MAV_TYPE_FIXED_WING, true, true),
        );
        socket.send_to(&beat, &address).unwrap();
        thread::sleep(Duration::from_millis(10));
        if child.try_wait().unwrap().is_some() {
            break;
        }
    }
    child.kill().unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(3), "it goes on");
}

fn wait_for(mut happened: impl FnMut() -> bool) {
    let start = Instant::now();
    while !happened() {
        assert!(start.elapsed() < Duration::from_secs(20), "nothing happens");
        thread::sleep(Duration::from_millis(10));
    }
}

/// Columns and rows come from a single reading of the table.
#[test]
fn identify_reads_standard_input_once() {
    let row = |i: i32| format!("{},{},{}\n", i % 7, i % 5, i % 7 * (i % 5));
    let rows: String = (0..70).map(row).collect();
    let mut child = flagred()
        .args(["identify", "-", "--target", "area", "--output", "-"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut table = child.stdin.take().unwrap();
    table
        .write_all(format!("width,length,area\n{rows}").as_bytes())
        .unwrap();
    drop(table);
    let output = child.wait_with_output().unwrap();
    let reported = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success(), "{reported}");
    assert!(reported.contains("70 used, 0 refused"), "{reported}");
    let written = String::from_utf8(output.stdout).unwrap();
    assert!(fuzzy::yaml::parse(&written).is_ok(), "{written}");
}
