//! Estimates how close a multirotor is to losing control, from its motor commands alone.
//!
//! Entry points:
//!
//! | to | use | feature |
//! |---|---|---|
//! | assess a flight log | `log::assess`, with a `Flight` of `flagred_flightlog::open` | `flightlog` |
//! | assess a flight from samples | [`flight::Assessor`]: samples in, verdict and findings out | |
//! | follow a flight live | [`monitor::Monitor`]: a sample in, the risk and the level of the moment out | |
//! | use the profiles that come with the crate | [`shipped`] | |
//! | use a profile from a file, or a shipped one by its name | `loaded::load` | `flightlog` |
//! | compile a profile and a rule set made in code | [`profile::Profile`], [`estimator::Estimator`] | |
//! | run on board, without an allocator | [`board::Monitor`] | without `std` |
//!
//! The other modules define the arguments and results of these entry points.
//!
//! # Example: a live monitor
//! ```
//! use flagred::{monitor::{Craft, Monitor, Sample}, shipped, verdict::Level};
//!
//! let mut monitor = Monitor::new(&shipped::flagred(), Craft::new(4))?; // four motors
//! let mut alarms = Vec::new();
//! for i in 0..500 {
//!     let t_s = f64::from(i) * 0.04;
//!     // Commands are fractions of the effective range: 0 and 1 are the limits. Here the motors reach them after 10 s.
//!     let motors = if t_s < 10.0 { [0.4, 0.4, 0.41, 0.41] } else { [0.0, 1.0, 0.05, 1.0] };
//!     let update = monitor.push(&Sample { t_s, motors: &motors, in_air: Some(true), signals: &[] });
//!     alarms.extend(update.change); // GOOD, WARN or FAIL, when the level changes
//! }
//! assert_eq!(alarms.last(), Some(&Level::Fail));
//! # Ok::<(), flagred::monitor::MonitorError>(())
//! ```
//!
//! # Example: the verdict of a flight
//! ```
//! use flagred::{flight::{Assessor, Verdict}, monitor::{Craft, Sample}, shipped, verdict::Level};
//!
//! let mut assessor = Assessor::new(&shipped::flagred(), Craft::new(4), None)?;
//! for i in 0..1000 {
//!     let motors = [0.45, 0.5, 0.55, 0.5];
//!     assessor.push(&Sample { t_s: f64::from(i) * 0.02, motors: &motors, in_air: Some(true), signals: &[] });
//! }
//! assert_eq!(assessor.finish().verdict, Verdict::Known(Level::Good));
//! # Ok::<(), flagred::monitor::MonitorError>(())
//! ```
//!
//! # Errors
//! Every error type implements `Display` and `Error`. Errors of profiles and rule sets are
//! [`fuzzy::Findings`](fuzzy::diagnostic::Findings): all errors of a text, each with its line and column.
//!
//! # Features
//! - `std` (default): without it only [`board`] and the modules that it uses are available, which need only `core`.
//! - `flightlog`: flight logs, read by `flagred_flightlog`; profiles from files.
//! - `serde`: assessments, findings and updates as data for `serde`; `schema`: their JSON Schemas.
//!
//! The repository's docs/rust.md is a guide to this crate and to the engine, `fuzzy`.
#![cfg_attr(not(feature = "std"), no_std)]

#[cfg(feature = "std")]
extern crate alloc;

#[cfg(feature = "std")]
#[macro_use]
mod state;
#[cfg(not(feature = "std"))]
macro_rules! state {
    ($($all:tt)*) => {};
}

pub mod accumulator;
mod average;
pub mod board;
mod cause;
#[doc(hidden)] // Its data is part of exported plans and of the memory that `board` borrows.
pub mod channel;
#[cfg(feature = "std")]
pub mod check;
#[cfg(feature = "std")]
mod craft;
mod effort;
#[cfg(feature = "std")]
pub mod estimator;
mod exponential;
#[cfg(feature = "std")]
pub mod flight;
#[doc(hidden)] // Its data is part of exported plans and of the memory that `board` borrows.
pub mod follower;
pub mod gap;
#[cfg(feature = "flightlog")]
pub mod loaded;
#[cfg(feature = "flightlog")]
pub mod log;
mod lookup;
pub mod margin;
mod moments;
#[cfg(feature = "std")]
pub mod monitor;
mod motor;
#[cfg(feature = "std")]
pub mod plan;
#[cfg(feature = "std")]
pub mod profile;
pub mod sample;
#[cfg(feature = "std")]
mod sampling_error;
#[cfg(feature = "std")]
pub mod shipped;
#[cfg(feature = "std")]
pub mod source;
pub mod verdict;
#[doc(hidden)] // Its data is part of exported plans and of the memory that `board` borrows.
pub mod window;
