//! Benchmarks of the time and allocations for processing a sample of eight motors, with the monitor for computers
//! and with the monitor for flight controllers.

use divan::{Bencher, black_box, counter::ItemsCount};
use flagred::{
    board::OwnedMemory,
    estimator::Estimator,
    monitor::{Craft, Monitor, Sample},
    shipped,
};

#[global_allocator]
static ALLOCATOR: divan::AllocProfiler = divan::AllocProfiler::system();

fn main() {
    divan::main();
}

const MOTORS: usize = 8;
/// Samples in a run: 20 s at 50 Hz, as long as the longest window.
const SAMPLES: u32 = 1000;
const PROFILES: [&str; 2] = ["flagred", "flagred-paper"];

fn estimator(name: &str) -> Estimator {
    match name {
        "flagred-paper" => shipped::flagred_paper(),
        _ => shipped::flagred(),
    }
}

/// Returns the commands of motors that compensate for gusts, for the sample with the index `i`.
fn commands(i: u32) -> [f64; MOTORS] {
    let t_s = f64::from(i) * 0.02;
    let gust = (t_s * 1.3).sin().max(0.0) * 0.4;
    std::array::from_fn(|n| (0.55 + gust * (t_s * 9.0 + n as f64).sin()).clamp(0.0, 1.0))
}

/// Measures a run of samples after enough samples to fill the windows. The measured time is for the whole run; the
/// throughput counts samples.
fn run(bencher: Bencher<'_, '_>, mut push: impl FnMut(&Sample<'_>)) {
    let flight: Vec<[f64; MOTORS]> = (0..SAMPLES).map(commands).collect();
    let mut i = 0_u32;
    bencher.counter(ItemsCount::new(SAMPLES)).bench_local(|| {
        for motors in &flight {
            i += 1;
            push(black_box(&Sample {
                t_s: f64::from(i) * 0.02,
                motors,
                in_air: Some(true),
                signals: &[],
            }));
        }
    });
}

#[divan::bench(args = PROFILES)]
fn monitor(bencher: Bencher<'_, '_>, profile: &str) {
    let estimator = estimator(profile);
    let mut monitor = Monitor::new(&estimator, Craft::new(MOTORS)).unwrap();
    run(bencher, |sample| {
        black_box(monitor.push(sample));
    });
}

#[divan::bench(args = PROFILES)]
fn on_board(bencher: Bencher<'_, '_>, profile: &str) {
    let estimator = estimator(profile);
    let plan = estimator.plan().unwrap();
    let mut memory = OwnedMemory::new(&plan, MOTORS);
    let mut monitor = memory.monitor(&plan).unwrap();
    run(bencher, |sample| {
        black_box(monitor.push(sample));
    });
}
