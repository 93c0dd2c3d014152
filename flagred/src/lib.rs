//! Estimates from motor commands alone how close a multirotor is to losing control.
//!
//! - [`flight::Assessor`]: samples of a flight in, its verdict and findings out; `log::assess` (feature `flightlog`) does it
//!   for a flight log.
//! - [`monitor::Monitor`]: a sample in, the risk and the level of the moment out; [`board::Monitor`] is the same without an
//!   allocator.
//! - [`shipped`]: the profiles and rule sets that come with the crate; [`profile::Profile`] and [`estimator::Estimator`]
//!   make others usable; `loaded::load` (feature `flightlog`) reads both.
//!
//! ```
//! use flagred::{flight::{Assessor, Verdict}, monitor::{Craft, Sample}, shipped, verdict::Level};
//!
//! let mut assessor = Assessor::new(&shipped::flagred(), Craft::new(4), None)?;
//! for i in 0..1000 {
//!     let motors = [0.45, 0.5, 0.55, 0.5]; // of the effective range: 0 and 1 are the limits
//!     assessor.push(&Sample { t_s: f64::from(i) * 0.02, motors: &motors, in_air: Some(true), signals: &[] });
//! }
//! assert_eq!(assessor.finish().verdict, Verdict::Known(Level::Good));
//! # Ok::<(), flagred::monitor::MonitorError>(())
//! ```
//!
//! Features: `std` (default); `flightlog` for flight logs; `serde` to serialise what comes out. Without `std` there is only
//! [`board`] and what it uses, which needs `core` alone.
#![cfg_attr(not(feature = "std"), no_std)]

#[cfg(feature = "std")]
extern crate alloc;

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
pub mod shipped;
#[cfg(feature = "std")]
pub mod source;
pub mod verdict;
#[doc(hidden)] // Its data is part of exported plans and of the memory that `board` borrows.
pub mod window;
