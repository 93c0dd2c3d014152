//! `flagred watch` with pymavlink, an independent implementation of MAVLink, as the vehicle.

use std::process::Command;

use flagred_tests::flagred;

const PEER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/peer/pymavlink_peer.py");

/// `FLAGRED_PYTHON` names a Python that has pymavlink; without it that is `python3`.
#[test]
#[ignore = "needs Python with pymavlink: tests/peer/run.sh"]
fn pymavlink_and_watch_understand_each_other() {
    let python = std::env::var("FLAGRED_PYTHON").unwrap_or_else(|_| "python3".to_owned());
    for version in ["1", "2", "signed"] {
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
