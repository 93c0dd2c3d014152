//! FLAGRED: how close a multirotor is to losing control, told from its motor commands alone.
//!
//! Without the feature `std` there is only what flies on board, in `core` alone: [`board`] and what it stands on.
#![cfg_attr(not(feature = "std"), no_std)]

#[cfg(feature = "std")]
extern crate alloc;

pub mod accumulator;
pub mod assessment;
#[cfg(feature = "std")]
pub mod attitude;
pub mod board;
pub mod channel;
#[cfg(feature = "std")]
pub mod estimator;
#[cfg(feature = "std")]
pub mod evaluation;
pub mod follower;
pub mod gap;
#[cfg(feature = "std")]
pub mod learning;
mod lookup;
pub mod margin;
mod moments;
#[cfg(feature = "std")]
pub mod monitor;
#[cfg(feature = "std")]
pub mod profile;
#[cfg(feature = "std")]
pub mod shipped;
#[cfg(feature = "std")]
pub mod source;
pub mod verdict;
pub mod window;
