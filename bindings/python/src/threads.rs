//! Threads: pools that survive a fork, and work that Ctrl-C interrupts.

use std::{
    collections::HashMap,
    process,
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicBool, Ordering},
        mpsc,
    },
    thread,
    time::Duration,
};

use fuzzy::diagnostic::quoted;
use pyo3::{
    exceptions::{PyKeyboardInterrupt, PyRuntimeError},
    prelude::*,
};
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::errors::data_error;

/// The pools of this process, by their numbers of threads.
type Pools = (u32, HashMap<usize, Arc<ThreadPool>>);

/// Converts the `threads` argument of a Python call to a number.
pub(crate) fn count(value: &Bound<'_, PyAny>) -> PyResult<Option<usize>> {
    value.extract().map_err(|_| {
        let shown = value
            .repr()
            .map_or_else(|_| "?".into(), |text| text.to_string());
        let message = format!(
            "`threads` is {}; it must be a whole number of at least 1",
            quoted(&shown)
        );
        data_error(
            message,
            Some("leave it out for as many threads as there are cores".into()),
        )
    })
}

/// Returns an error for 0 threads.
pub(crate) fn checked(threads: Option<usize>) -> PyResult<()> {
    match threads {
        Some(0) => Err(data_error(
            "`threads` must be at least 1",
            Some("leave it out for as many threads as there are cores".into()),
        )),
        _ => Ok(()),
    }
}

/// Returns a pool with the given number of threads, but at most one thread per core. The default is one thread
/// per core.
///
/// A fork copies a pool without its threads, so work in the copy would never run. Therefore a child process
/// creates its own pools.
pub(crate) fn pool(threads: Option<usize>) -> PyResult<Arc<ThreadPool>> {
    static POOLS: Mutex<Option<Pools>> = Mutex::new(None);
    checked(threads)?;
    let cores = thread::available_parallelism().map_or(1, Into::into);
    let threads = threads.map_or(cores, |threads| threads.min(cores));
    let mut guard = POOLS.lock().unwrap_or_else(PoisonError::into_inner);
    let here = process::id();
    if let Some((_, pools)) = guard.take_if(|(process, _)| *process != here) {
        // The threads of these pools exist only in the parent process, so dropping the pools here would wait for ever.
        std::mem::forget(pools);
    }
    let (_, pools) = guard.get_or_insert_with(|| (here, HashMap::new()));
    if let Some(pool) = pools.get(&threads) {
        return Ok(Arc::clone(pool));
    }
    let pool = ThreadPoolBuilder::new().num_threads(threads).build();
    let pool = Arc::new(pool.map_err(|error| PyRuntimeError::new_err(error.to_string()))?);
    pools.insert(threads, Arc::clone(&pool));
    Ok(pool)
}

/// Runs long work on another thread while this one checks for Ctrl-C. After Ctrl-C, it returns an error without waiting
/// for the work.
pub(crate) fn interruptible<T: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce() -> T + Send + 'static,
) -> PyResult<T> {
    run_interruptibly(py, work, Err)
}

/// Like [`interruptible`], for work that returns a result soon after `stop` is set. The first Ctrl-C sets `stop`, and
/// the function waits for the result; after a second Ctrl-C it does not wait. Also returns whether Ctrl-C was pressed.
pub(crate) fn stoppable<T: Send + 'static>(
    py: Python<'_>,
    stop: &AtomicBool,
    work: impl FnOnce() -> T + Send + 'static,
) -> PyResult<(T, bool)> {
    let mut was_interrupted = false;
    let result = run_interruptibly(py, work, |error| {
        stop.store(true, Ordering::Relaxed);
        if was_interrupted || !error.is_instance_of::<PyKeyboardInterrupt>(py) {
            return Err(error);
        }
        was_interrupted = true;
        Ok(())
    })?;
    Ok((result, was_interrupted))
}

/// Runs work on another thread. `on_signal` receives exceptions from signals, and returns whether to continue waiting.
fn run_interruptibly<T: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce() -> T + Send + 'static,
    mut on_signal: impl FnMut(PyErr) -> PyResult<()>,
) -> PyResult<T> {
    /// The interval between checks for Ctrl-C, too short to be noticed as a delay.
    const CHECK_INTERVAL: Duration = Duration::from_millis(50);
    let (sender, mut receiver) = mpsc::sync_channel(1);
    thread::spawn(move || sender.send(work()));
    loop {
        let receiver = &mut receiver;
        match py.detach(move || receiver.recv_timeout(CHECK_INTERVAL)) {
            Ok(done) => return Ok(done),
            Err(mpsc::RecvTimeoutError::Timeout) => py.check_signals().or_else(&mut on_signal)?,
            Err(mpsc::RecvTimeoutError::Disconnected) => {
                return Err(PyRuntimeError::new_err(
                    "the calculation ended without a result",
                ));
            }
        }
    }
}
