//! `flagred watch` with pymavlink, an independent implementation of MAVLink, as the vehicle.

use std::{
    fs::File,
    io::{BufRead, BufReader},
    process::{Child, Command, Stdio},
};

use flagred_tests::{Folder, flagred};

const PEER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/peer/pymavlink_peer.py");

/// `FLAGRED_PYTHON` names a Python with pymavlink; the default is `python3`.
fn python() -> Command {
    Command::new(std::env::var("FLAGRED_PYTHON").unwrap_or_else(|_| "python3".to_owned()))
}

/// A process that is killed at the end of the test, even if the test fails.
struct ChildProcess(Child);

impl Drop for ChildProcess {
    fn drop(&mut self) {
        // Errors are ignored, because the process may have ended already.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Every line of scripts/try-against-sitl runs, and every check passes with a stand-in for the simulator.
#[test]
#[ignore = "needs Python with pymavlink, and takes two minutes: tests/peer/run.sh"]
fn watch_works_against_a_stand_in_for_the_simulator() {
    const SPEED: &str = "3";
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/..");
    let stand_in = python()
        .args([&format!("{root}/tests/peer/sitl_stand_in.py"), SPEED])
        .stdout(Stdio::piped())
        .spawn();
    let mut stand_in = ChildProcess(stand_in.unwrap());
    let mut ports = String::new();
    let reported = stand_in.0.stdout.take().unwrap();
    BufReader::new(reported).read_line(&mut ports).unwrap();
    let ports: Vec<String> = ports
        .split_whitespace()
        .map(|port| format!("tcp:127.0.0.1:{port}"))
        .collect();
    let folder = Folder::new();
    let said = folder.path().join("said.jsonl");
    let watch = flagred()
        .args(["watch", &ports[1], "--jsonl"])
        .stdout(File::create(&said).unwrap())
        .spawn();
    let watch = ChildProcess(watch.unwrap());
    let output = python()
        .args([
            &format!("{root}/scripts/try-against-sitl"),
            &ports[0],
            "--speed",
            SPEED,
            "--said",
        ])
        .arg(&said)
        .output()
        .unwrap();
    let reported = String::from_utf8(output.stdout).unwrap();
    assert!(
        output.status.success(),
        "{reported}{}",
        String::from_utf8_lossy(&output.stderr)
    );
    assert!(
        reported.ends_with("all checks hold\n") && reported.lines().count() > 25,
        "{reported}"
    );
    drop((watch, stand_in));
}

/// Every check of scripts/try-against-sitl passes with ArduCopter's simulator, with and without the script on board. `SITL_BIN`
/// names the simulator and `SITL_PARAMS` the folder of its default parameters; without them nothing is run.
#[test]
#[ignore = "flies ArduCopter's simulator for half an hour: docs/live.md"]
fn watch_works_against_the_simulator() {
    if std::env::var_os("SITL_BIN").is_none() {
        return;
    }
    let folder = Folder::new();
    let script = folder.at("flagred.lua");
    let exported = flagred()
        .args(["export", "--lua", "--output", &script])
        .status();
    assert!(exported.unwrap().success());
    for frame in ["quad", "octaquad", "y6"] {
        for on_board in [&["--script", &script][..], &[]] {
            let output = python()
                .arg(concat!(
                    env!("CARGO_MANIFEST_DIR"),
                    "/../scripts/try-against-sitl"
                ))
                .args(["--frame", frame])
                .args(on_board)
                .env("FLAGRED", flagred().get_program())
                .output()
                .unwrap();
            let reported = String::from_utf8_lossy(&output.stdout);
            let failed = String::from_utf8_lossy(&output.stderr);
            assert!(
                output.status.success(),
                "{frame} {on_board:?}\n{reported}{failed}"
            );
        }
    }
}

#[test]
#[ignore = "needs Python with pymavlink: tests/peer/run.sh"]
fn pymavlink_and_watch_understand_each_other() {
    for version in ["1", "2", "signed"] {
        let output = python()
            .arg(PEER)
            .arg(flagred().get_program())
            .arg(version)
            .output()
            .unwrap();
        let reported = String::from_utf8_lossy(&output.stdout);
        let failed = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{reported}{failed}");
    }
}
