//! What the tests across packages share; the tests themselves are in `tests/tests/`.

use std::path::PathBuf;

/// The folder of reference data, where the environment variable `FLAGRED_SHARED` names its parent.
///
/// Says so where it does not: the tests that need the data are skipped then.
#[allow(clippy::print_stderr)]
pub fn shared_data() -> Option<PathBuf> {
    match std::env::var_os("FLAGRED_SHARED") {
        Some(folder) => Some(PathBuf::from(folder).join("data")),
        None => {
            eprintln!("skipped: FLAGRED_SHARED names no folder of reference data");
            None
        }
    }
}
