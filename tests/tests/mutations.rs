//! Damaged inputs of every reader, every writer and the live session: none causes a panic, is slow or uses much memory.
//!
//! `cargo test --release -p flagred-tests --test mutations -- --ignored --nocapture` runs a million of them.

use std::{
    io::Write,
    time::{Duration, Instant},
};

use allocation_counter::measure;
use fastrand::Rng;
use flagred_tests::fuzzing::{TARGETS, Target, mutation::damaged};
use flate2::{Compression, write::GzEncoder};
use rayon::prelude::*;

/// The maximum memory in bytes for a single input, and also for the whole process.
const MEMORY: u64 = 256 << 20;

/// Prints the name of the target and the seed of the input if the target panics.
struct SeedReport<'t>(&'t Target, u64);

impl Drop for SeedReport<'_> {
    fn drop(&mut self) {
        if std::thread::panicking() {
            eprintln!("{}, seed {}", self.0.name, self.1);
        }
    }
}

/// The time and memory that an input uses.
fn cost(target: &Target, seeds: &[Vec<u8>], seed: u64) -> (Duration, u64) {
    let _report = SeedReport(target, seed);
    let mut random = Rng::with_seed(seed);
    let bytes = damaged(random.choice(seeds).unwrap(), &mut random);
    let run = || {
        let start = Instant::now();
        let used = measure(|| (target.body)(&bytes));
        (start.elapsed(), used.bytes_max)
    };
    let (time, memory) = run();
    // A second run distinguishes a slow input from a busy machine.
    let again = time > Duration::from_millis(500);
    (if again { time.min(run().0) } else { time }, memory)
}

/// Runs this many inputs, each within the given time.
fn survive(count: u64, longest: Duration) {
    assert_eq!(TARGETS.iter().map(|target| target.share).sum::<u64>(), 100);
    for target in &TARGETS {
        let seeds = (target.seeds)();
        for seed in &seeds {
            (target.body)(seed);
        }
        let start = Instant::now();
        let count = count * target.share / 100;
        let costs = (0..count).into_par_iter();
        let (slowest, largest) = costs
            .map(|seed| cost(target, &seeds, seed))
            .reduce(Default::default, |a, b| (a.0.max(b.0), a.1.max(b.1)));
        println!(
            "{}: {count} inputs in {:.1?}, the slowest in {slowest:.1?}, the largest with {} kB",
            target.name,
            start.elapsed(),
            largest / 1024
        );
        assert!(slowest < longest, "{}: {slowest:?}", target.name);
        assert!(largest < MEMORY, "{}: {largest} bytes", target.name);
    }
    // This includes the memory of other threads and of libraries.
    if let Ok(status) = std::fs::read_to_string("/proc/self/status") {
        let line = status.lines().find(|line| line.starts_with("VmHWM:"));
        let kb: u64 = line
            .unwrap()
            .split_whitespace()
            .nth(1)
            .unwrap()
            .parse()
            .unwrap();
        println!("{kb} kB at most");
        assert!(kb < MEMORY / 1024, "{kb} kB");
    }
}

#[test]
fn some_damaged_inputs_cause_no_panic() {
    survive(5000, Duration::from_secs(5));
}

#[test]
#[ignore = "takes many minutes: run it with --release"]
fn a_million_damaged_inputs_cause_no_panic() {
    survive(1_000_000, Duration::from_secs(1));
}

/// Zeros are compressed to a thousandth of their size, so a small file can contain a huge log.
#[test]
fn a_log_of_zeros_takes_little_memory() {
    let mut packed = GzEncoder::new(Vec::new(), Compression::fast());
    for _ in 0..200 {
        packed.write_all(&[0; 1 << 20]).unwrap();
    }
    let packed = packed.finish().unwrap();
    assert!(packed.len() < 2 << 20);
    let used = measure(|| {
        let read = flagred_flightlog::read(&packed[..], &flagred_flightlog::Options::default());
        assert!(read.is_err());
    });
    assert!(used.bytes_max < 8 << 20, "{used:?}");
}
