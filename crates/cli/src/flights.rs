//! Flights to learn from: logs that must be complete.

use std::path::Path;

use flagred_evaluation::{complete, complete_options};
use flagred_flightlog::Flight;

use crate::failure::Failure;

/// Opens a flight that must carry motors, attitude and times in the air, with the named signals where it has them.
///
/// # Errors
///
/// Why it cannot be used; `cannot` says for what: `makes no rows`.
pub(crate) fn open_complete(
    path: impl AsRef<Path>,
    names: &[&str],
    cannot: &str,
) -> Result<Flight, Failure> {
    let path = path.as_ref();
    let flight = flagred_flightlog::open(path, &complete_options(names))?;
    complete(&flight).map_err(|lacks| {
        let failure = Failure::unreadable(format!("`{}` {cannot}: {lacks}", path.display()));
        failure.help_if(lacks.help())
    })?;
    Ok(flight)
}
