//! Flights to learn from and to evaluate on: logs that must be complete.

use std::path::Path;

use flagred::log::ATTITUDE;
use flightlog::{Flight, Gap};

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
    let wanted = names.iter().chain(&ATTITUDE).map(|name| (*name).to_owned());
    let options = flightlog::Options {
        signals: Some(wanted.collect()),
    };
    let flight = flightlog::open(path, &options)?;
    let left_out = &flight.report.left_out;
    if left_out.messages > 0 || left_out.changes > 0 {
        return Err(Failure::unreadable(format!(
            "`{}` {cannot}: not all of it is kept, which leaves out {left_out}",
            path.display()
        ))
        .help("docs/limits.md has the bounds"));
    }
    let gaps = flight.gaps();
    match gaps.iter().find(|gap| !matches!(gap, Gap::TooSlow { .. })) {
        None => Ok(flight),
        Some(gap) => {
            let failure = Failure::unreadable(format!("`{}` {cannot}: {gap}", path.display()));
            Err(failure.help_if(gap.help()))
        }
    }
}
