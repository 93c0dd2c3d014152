//! `flagred watch` with pymavlink, an independent implementation of MAVLink, as the vehicle.

use std::process::Command;

use flagred_tests::flagred;

const PEER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/peer/pymavlink_peer.py");

/// A Python that has pymavlink: the one that `FLAGRED_PYTHON` names, or the one on the path where it has it.
fn python() -> Option<String> {
    if let Ok(python) = std::env::var("FLAGRED_PYTHON") {
        return Some(python);
    }
    let tried = Command::new("python3")
        .args(["-c", "import pymavlink"])
        .output();
    if tried.is_ok_and(|output| output.status.success()) {
        return Some("python3".to_owned());
    }
    eprintln!("skipped: FLAGRED_PYTHON names no Python with pymavlink");
    None
}

#[test]
fn pymavlink_and_watch_understand_each_other() {
    let Some(python) = python() else { return };
    for version in ["1", "2"] {
        let output = Command::new(&python)
            .arg(PEER)
            .arg(flagred().get_program())
            .arg(version)
            .output()
            .unwrap();
        let told = String::from_utf8_lossy(&output.stdout);
        let failed = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{told}{failed}");
    }
}
