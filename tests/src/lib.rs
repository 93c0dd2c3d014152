//! Functions shared by the tests across packages; the tests themselves are in `tests/tests/`.

pub mod board;
mod folder;
pub mod fuzzing;
pub mod log_writer;
pub mod random_models;
pub mod random_type2;
pub mod reference;
pub mod schema;
pub mod simulated;
pub mod tuning;
pub mod typescript;
pub mod vehicle;
pub mod watch;
pub mod wire;
pub mod writing;

pub use folder::Folder;

use std::{path::PathBuf, process::Command, sync::OnceLock};

/// The shipped flight: two minutes of a quadrotor in a steady wind.
pub const STEADY: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../examples/flights/steady.BIN"
);

/// The folder of reference data, if the environment variable `FLAGRED_SHARED` names its parent; for tests that also run
/// without the data.
pub fn shared_data() -> Option<PathBuf> {
    std::env::var_os("FLAGRED_SHARED").map(|folder| PathBuf::from(folder).join("data"))
}

/// The folder of reference data, for tests that are ignored without it.
///
/// # Panics
///
/// If the environment variable `FLAGRED_SHARED` does not name its parent.
#[expect(
    clippy::expect_used,
    reason = "a test without the data that it needs has failed"
)]
pub fn reference_data() -> PathBuf {
    let folder = std::env::var_os("FLAGRED_SHARED")
        .expect("FLAGRED_SHARED names the folder whose `data` this test needs");
    PathBuf::from(folder).join("data")
}

/// A command for the `flagred` binary of this workspace, built with the profile of the tests.
///
/// Cargo provides the path of a binary only to tests of the same package. These tests are in another package, so the binary is
/// built here, with the same features as for tests of its own package: after `cargo test --workspace` there is nothing left to
/// build.
///
/// # Panics
///
/// If the binary does not build.
#[expect(
    clippy::panic,
    reason = "a test that cannot build what it tests has failed"
)]
pub fn flagred() -> Command {
    static BINARY: OnceLock<PathBuf> = OnceLock::new();
    let binary = BINARY.get_or_init(|| {
        let workspace = concat!(env!("CARGO_MANIFEST_DIR"), "/..");
        let built = Command::new(env!("CARGO"))
            .args(["test", "--workspace", "--no-run", "--test", "authoring"])
            .args(["--quiet", "--message-format=json"])
            .args((!cfg!(debug_assertions)).then_some("--release"))
            .current_dir(workspace)
            .output();
        let output = match built {
            Ok(output) if output.status.success() => output,
            Ok(output) => panic!("{}", String::from_utf8_lossy(&output.stderr)),
            Err(error) => panic!("cargo cannot be run: {error}"),
        };
        let messages = String::from_utf8_lossy(&output.stdout);
        let path = messages.lines().find_map(|line| {
            let message: serde_json::Value = serde_json::from_str(line).ok()?;
            let target = &message["target"];
            let is_binary = target["name"] == "flagred" && target["kind"][0] == "bin";
            let path = message["executable"].as_str().filter(|_| is_binary)?;
            Some(PathBuf::from(path))
        });
        path.unwrap_or_else(|| panic!("cargo named no binary: {messages}"))
    });
    Command::new(binary)
}
