//! Opens flights as training data. Their logs must be complete.

use std::path::Path;

use flagred_evaluation::{complete, complete_options};
use flagred_flightlog::Flight;

use crate::failure::Failure;

/// Opens a flight, which must contain motors, attitude and times in the air. The named signals are read if present.
///
/// # Errors
///
/// If the flight cannot be used. The message consists of the path, `cannot` (such as `gives no rows`) and the reason.
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
