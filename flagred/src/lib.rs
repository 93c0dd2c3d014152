//! FLAGRED: how close a multirotor is to losing control, told from its motor commands alone.
extern crate alloc;

pub mod accumulator;
pub mod attitude;
pub mod estimator;
pub mod evaluation;
pub mod gap;
pub mod learning;
pub mod margin;
pub mod monitor;
pub mod profile;
pub mod shipped;
pub mod source;
pub mod verdict;
pub mod window;
