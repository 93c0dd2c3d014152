//! One [`Flight`] out of every log that a multirotor pilot has.
//!
//! [`open`] and [`read`] tell the kind of log by its content, unpack gzip, and give the
//! vehicle, its motors and where each of them is known from, the range of their commands,
//! signals on their own time bases, and when it was in the air. What a log does not tell
//! is `None` or a [`Gap`], never a number that means nothing. A damaged log gives what is
//! left of it, and a [`Report`] of what is not.
//!
//! ```
//! let log = "\
//! ## vehicle: my quad
//! ## pwm_low_us: 1000
//! ## pwm_high_us: 2000
//! t_s,pwm1,pwm2,pwm3,pwm4,roll_deg
//! 0.00,1500,1510,1490,1500,0.3
//! 0.04,1520,1500,1480,1500,0.4
//! ";
//! let flight = flightlog::read(log.as_bytes(), &flightlog::Options::default())?;
//! for (t_s, row) in flight.commands.rows() {
//!     let commands: Vec<_> = row.iter().map(|&raw| flight.effective_command(raw)).collect();
//!     assert_eq!(commands.len(), 4, "at {t_s} s");
//! }
//! assert_eq!(flight.signal("roll_deg").unwrap().at(0.05), Some(0.4));
//! # Ok::<(), flightlog::ReadError>(())
//! ```

mod angle;
mod ardupilot;
mod clock;
mod csv;
mod dataflash;
mod error;
mod flight;
mod gap;
mod geometry;
mod input;
mod interval;
mod mav_type;
pub mod mavlink;
mod outputs;
mod parameters;
mod place;
mod px4;
mod read;
mod report;
mod signal;
mod statistics;
mod tlog;
mod ulog;
mod utc;

pub use error::ReadError;
pub use flight::{Commands, Event, Flight, Format, Motor, Range, Vehicle, VehicleKind};
pub use gap::Gap;
pub use geometry::{Basis, Geometry};
pub use interval::{Interval, Intervals};
pub use read::{Options, open, read};
pub use report::Report;
pub use signal::{Hold, Label, Series, Signal};
pub use statistics::Statistics;
