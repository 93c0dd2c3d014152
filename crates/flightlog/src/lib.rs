//! Reads the flight logs of multirotors into one type, [`Flight`].
//!
//! [`open`] and [`read`] detect the format by its content and decompress gzip. They return the vehicle, its motors with
//! their geometry and the range of their commands (each with its source), signals on their own time bases, and the
//! times in the air. Unknown values are `None` or a [`Gap`], never a number. The undamaged part of a damaged log is
//! read, and a [`Report`] counts the damage.
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
//! let flight = flagred_flightlog::read(log.as_bytes(), &flagred_flightlog::Options::default())?;
//! for (t_s, row) in flight.commands.rows() {
//!     let commands: Vec<_> = row.iter().map(|&raw| flight.effective_command(raw)).collect();
//!     assert_eq!(commands.len(), 4, "at {t_s} s");
//! }
//! assert_eq!(flight.signal("roll_deg").unwrap().at(0.05), Some(0.4));
//! # Ok::<(), flagred_flightlog::ReadError>(())
//! ```

mod angle;
mod ardupilot;
mod attitude;
mod clock;
mod csv;
mod dataflash;
mod error;
mod field;
mod flight;
mod gap;
mod geometry;
mod identity;
mod input;
mod interval;
mod kind;
mod known;
mod mav_type;
pub mod mavlink;
mod outputs;
mod parameters;
mod pulse_range;
mod px4;
mod read;
mod report;
#[cfg(feature = "serde")]
mod serialize;
mod signal;
mod statistics;
mod tlog;
mod ulog;
mod utc;

pub use attitude::{ATTITUDE, Attitude};
pub use error::ReadError;
pub use flight::{Commands, Event, Flight, Format, Motor, Range, Vehicle, VehicleKind};
pub use gap::Gap;
pub use geometry::{Basis, Frame, Geometry, ardupilot_frames};
pub use interval::{Interval, Intervals};
pub use kind::FileKind;
pub use known::{KnownSignal, known_signals};
pub use parameters::Parameter;
pub use pulse_range::{PulseRange, PulseRangeError};
pub use read::{Options, is_text_log, kind_of, open, read};
pub use report::{LeftOutCounts, Report};
pub use signal::{Hold, Label, Series, Signal};
pub use statistics::Statistics;
