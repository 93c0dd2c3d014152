//! The C interface of [`flagred::board`]. `include/flagred.h` documents the functions.
//!
//! It converts between pointers and references, which needs `unsafe` code.
#![cfg_attr(not(feature = "std"), no_std)]

mod array;
mod evaluator;
mod memory;
mod plan;
mod rules;
mod status;
mod update;

use core::ffi::{CStr, c_char};

use flagred::{
    board::{
        Factors, Memory, Monitor, SetupError,
        table::{Outcome, PartialConjunction, StrongestRule},
    },
    channel::ChannelState,
    margin::Range,
    sample::Sample,
    verdict::Motor,
    window::Window,
};

use array::Array;
use memory::Block;
use plan::Plan;
use status::Status;
use update::{ENDED, Finding, Update, findings};

/// The limits of a motor: `struct flagred_limits` in C.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct Limits {
    low: f64,
    high: f64,
}

/// A sample of a flight: `struct flagred_sample` in C.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct CSample {
    t_s: f64,
    commands: Array<f64>,
    signals: Array<f64>,
    in_air: i32,
}

/// A monitor of a flight: `struct flagred_monitor` in C.
#[derive(Debug)]
pub struct CMonitor {
    monitor: Monitor<'static>,
    /// The limits of each motor; empty if commands are from 0 to 1.
    limits: &'static [Range],
    /// The effective command of each motor in the current sample.
    effective: &'static mut [f64],
}

/// The version of this library, such as "0.1.0".
#[unsafe(no_mangle)]
#[allow(unsafe_code, reason = "a name that C can call")]
pub extern "C" fn flagred_version() -> *const c_char {
    const VERSION: &CStr =
        match CStr::from_bytes_with_nul(concat!(env!("CARGO_PKG_VERSION"), "\0").as_bytes()) {
            Ok(version) => version,
            Err(_) => c"",
        };
    VERSION.as_ptr()
}

/// Returns a description of a status, as a static C string.
#[unsafe(no_mangle)]
#[allow(unsafe_code, reason = "a name that C can call")]
pub extern "C" fn flagred_status_text(status: i32) -> *const c_char {
    status::text(status).as_ptr()
}

/// The size of a monitor's memory in bytes; 0 for an invalid plan.
///
/// # Safety
/// `plan` must be null or point to a plan whose arrays have the stated lengths.
#[unsafe(no_mangle)]
#[allow(unsafe_code, reason = "foreign memory")]
pub unsafe extern "C" fn flagred_memory_size(plan: *const Plan, motors: usize) -> usize {
    // SAFETY: the caller's promise.
    let plan = unsafe { plan.as_ref() };
    let plan = plan.ok_or(Status::NullPointer);
    // SAFETY: the caller's promise about the plan's arrays, which are used in this call only.
    let sizes = plan.and_then(|plan| unsafe { plan.bytes(motors) });
    sizes.unwrap_or(0)
}

/// Creates a monitor of a new flight.
///
/// # Safety
/// `plan` must be null or point to a plan whose arrays have the stated lengths; `limits` must be null or have one item
/// for each motor; `memory` must be null or have `size` bytes that nothing else uses; `monitor` must be null or
/// writable. The plan and the memory must outlive the monitor.
#[unsafe(no_mangle)]
#[allow(unsafe_code, reason = "foreign memory")]
pub unsafe extern "C" fn flagred_start(
    plan: *const Plan,
    motors: usize,
    limits: *const Limits,
    memory: *mut u8,
    size: usize,
    monitor: *mut *mut CMonitor,
) -> i32 {
    // SAFETY: the caller's promises, passed on.
    let started = unsafe { start(plan, motors, limits, memory, size) };
    if monitor.is_null() {
        return Status::NullPointer as i32;
    }
    let (status, started) = match started {
        Ok(started) => (Status::Ok, started),
        Err(status) => (status, core::ptr::null_mut()),
    };
    // SAFETY: not null, and writable by the caller's promise.
    unsafe { monitor.write(started) };
    status as i32
}

/// # Safety
/// As [`flagred_start`].
#[allow(unsafe_code, reason = "foreign memory")]
unsafe fn start(
    plan: *const Plan,
    motors: usize,
    limits: *const Limits,
    memory: *mut u8,
    size: usize,
) -> Result<*mut CMonitor, Status> {
    // SAFETY: the caller promises that the plan is valid and outlives the monitor.
    let plan: &'static Plan = unsafe { plan.as_ref() }.ok_or(Status::NullPointer)?;
    // SAFETY: the caller's promise: nothing else uses the memory, and it outlives the monitor.
    let mut block = unsafe { Block::new(memory, size) }?;
    // SAFETY: the caller's promise about the plan's arrays, which are used in this call only.
    if size < unsafe { plan.bytes(motors) }? {
        return Err(Status::MemorySize);
    }
    // SAFETY: the caller's promise about the plan's arrays.
    let plan = unsafe { plan.read(&mut block) }?;
    let plan: &'static flagred::board::Plan<'static> = block.store(plan)?;
    plan.check().map_err(|_| Status::DamagedPlan)?;

    let limits = Array {
        items: limits,
        count: if limits.is_null() { 0 } else { motors },
    };
    // SAFETY: the caller promises one item for each motor.
    let limits: &'static [Limits] = unsafe { limits.read() }?;
    let ranges = block.fill(limits.len(), Range::FULL)?;
    for (range, Limits { low, high }) in ranges.iter_mut().zip(limits) {
        *range = Range::new(*low, *high).ok_or(Status::BadLimits)?;
    }
    let sizes = plan.sizes();
    let memory = Memory {
        numbers: block.fill(sizes.numbers, 0.0)?,
        partials: block.fill(sizes.partials, PartialConjunction::NONE)?,
        strongest: block.fill(sizes.outputs, StrongestRule::NONE)?,
        outcomes: block.fill(sizes.outputs, Outcome::UNDEFINED)?,
        own: block.fill(sizes.outputs, Outcome::UNDEFINED)?,
        seen: block.repeat(sizes.channels, |_| Ok(ChannelState::IDLE))?,
        risks: block.store(Window::IDLE)?,
        motors: block.fill(motors, Motor::UNKNOWN)?,
    };
    let monitor = CMonitor {
        monitor: Monitor::new(plan, memory).map_err(|refused| match refused {
            SetupError::NoMotors => Status::NoMotors,
            _ => Status::DamagedPlan,
        })?,
        limits: ranges,
        effective: block.fill(motors, f64::NAN)?,
    };
    block.store(monitor).map(core::ptr::from_mut)
}

/// Sets the factors of each motor.
///
/// # Safety
/// `monitor` must be null or from [`flagred_start`]; `factors` must be null or have `motors` items.
#[unsafe(no_mangle)]
#[allow(unsafe_code, reason = "foreign memory")]
pub unsafe extern "C" fn flagred_set_geometry(
    monitor: *mut CMonitor,
    factors: *const Factors,
    motors: usize,
) -> i32 {
    let factors = Array {
        items: factors,
        count: motors,
    };
    // SAFETY: the caller's promises; the factors are used in this call only.
    let (monitor, factors) = unsafe { (monitor.as_mut(), factors.read()) };
    let (Some(monitor), Ok(factors)) = (monitor, factors) else {
        return Status::NullPointer as i32;
    };
    let set = monitor.monitor.set_geometry(factors);
    set.map_or(Status::BadGeometry, |()| Status::Ok) as i32
}

/// Processes the next sample and writes the update.
///
/// # Safety
/// `monitor` must be null or from [`flagred_start`]; `sample` must be null or point to a sample whose arrays have the
/// stated lengths; `update` must be null or writable.
#[unsafe(no_mangle)]
#[allow(unsafe_code, reason = "foreign memory")]
pub unsafe extern "C" fn flagred_push(
    monitor: *mut CMonitor,
    sample: *const CSample,
    update: *mut Update,
) -> i32 {
    // SAFETY: the caller's promises.
    let (monitor, sample) = unsafe { (monitor.as_mut(), sample.as_ref()) };
    let (Some(monitor), Some(sample), false) = (monitor, sample, update.is_null()) else {
        return Status::NullPointer as i32;
    };
    // SAFETY: the caller's promise about the sample's arrays, which are used in this call only.
    let arrays = unsafe { (sample.commands.read(), sample.signals.read()) };
    let (Ok(commands), Ok(signals)) = arrays else {
        return Status::NullPointer as i32;
    };
    if commands.len() > monitor.effective.len() {
        return Status::WrongCount as i32;
    }
    let known = commands.iter().copied().chain(core::iter::repeat(f64::NAN));
    for (i, (effective, command)) in monitor.effective.iter_mut().zip(known).enumerate() {
        *effective = match monitor.limits.get(i) {
            Some(limits) if limits.can_be_command(command) => limits.fraction(command),
            Some(_) => f64::NAN,
            None => command,
        };
    }
    let result = monitor.monitor.push(&Sample {
        t_s: sample.t_s,
        motors: monitor.effective,
        in_air: (sample.in_air >= 0).then_some(sample.in_air != 0),
        signals,
    });
    // SAFETY: not null, and writable by the caller's promise.
    unsafe { update.write(Update::of(&result)) };
    Status::Ok as i32
}

/// Writes the open finding of the current level.
///
/// # Safety
/// `monitor` must be null or from [`flagred_start`]; `finding` must be null or writable.
#[unsafe(no_mangle)]
#[allow(unsafe_code, reason = "foreign memory")]
pub unsafe extern "C" fn flagred_open_finding(
    monitor: *const CMonitor,
    finding: *mut Finding,
) -> i32 {
    // SAFETY: the caller's promise.
    let monitor = unsafe { monitor.as_ref() };
    let (Some(monitor), false) = (monitor, finding.is_null()) else {
        return Status::NullPointer as i32;
    };
    // SAFETY: not null, and writable by the caller's promise.
    unsafe { finding.write(Finding::of(monitor.monitor.open_finding())) };
    Status::Ok as i32
}

/// Ends the flight and writes the open findings.
///
/// # Safety
/// `monitor` must be null or from [`flagred_start`]; `ended` must be null or writable.
#[unsafe(no_mangle)]
#[allow(unsafe_code, reason = "foreign memory")]
pub unsafe extern "C" fn flagred_finish(
    monitor: *mut CMonitor,
    ended: *mut [Finding; ENDED],
) -> i32 {
    // SAFETY: the caller's promise.
    let monitor = unsafe { monitor.as_mut() };
    let (Some(monitor), false) = (monitor, ended.is_null()) else {
        return Status::NullPointer as i32;
    };
    // SAFETY: not null, and writable by the caller's promise.
    unsafe { ended.write(findings(monitor.monitor.finish())) };
    Status::Ok as i32
}

/// Computes the risk at values of the profile's inputs, independent of the flight.
///
/// # Safety
/// `monitor` must be null or from [`flagred_start`]; `inputs` must be null or have `count` items; `update` must be null
/// or writable.
#[unsafe(no_mangle)]
#[allow(unsafe_code, reason = "foreign memory")]
pub unsafe extern "C" fn flagred_evaluate(
    monitor: *mut CMonitor,
    inputs: *const f64,
    count: usize,
    update: *mut Update,
) -> i32 {
    let inputs = Array {
        items: inputs,
        count,
    };
    // SAFETY: the caller's promises.
    let (monitor, inputs) = unsafe { (monitor.as_mut(), inputs.read()) };
    let (Some(monitor), Ok(inputs), false) = (monitor, inputs, update.is_null()) else {
        return Status::NullPointer as i32;
    };
    let estimate = monitor.monitor.at(inputs);
    // SAFETY: not null, and writable by the caller's promise.
    unsafe { update.write(Update::of_estimate(estimate)) };
    Status::Ok as i32
}

/// Halts in an endless loop after a panic. A panic is a bug in this library.
#[cfg(not(feature = "std"))]
#[panic_handler]
fn stop(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {
        core::hint::spin_loop();
    }
}
