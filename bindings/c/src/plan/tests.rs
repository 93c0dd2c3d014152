//! Tests that `flagred_start` either refuses a damaged plan or creates a monitor that can process any number of
//! samples. Debug builds also check bounds and overflow.
#![allow(
    unsafe_code,
    clippy::unwrap_used,
    reason = "the tests call the functions as C does"
)]

use core::{any::Any, mem::MaybeUninit, ptr};

use flagred::{
    board::table::{self, Sizes},
    estimator::Estimator,
    profile::Profile,
    shipped,
};

use super::*;
use crate::{
    CMonitor, CSample, flagred_evaluate, flagred_finish, flagred_memory_size, flagred_push,
    flagred_start,
    rules::{FORMAT, Rules, conjunction, disjunction},
};

/// A linear congruential generator; its high bits are random enough.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        const FACTOR: u64 = 6_364_136_223_846_793_005;
        self.0 = self.0.wrapping_mul(FACTOR).wrapping_add(0x9e37_79b9);
        self.0 >> 24
    }

    fn below(&mut self, end: usize) -> usize {
        (self.next() % end.max(1) as u64) as usize
    }

    fn share(&mut self) -> f64 {
        self.below(1000) as f64 / 1000.0
    }

    /// Returns a number that is likely to cause trouble, such as a NaN or an extreme value.
    fn number(&mut self) -> f64 {
        const ODD: [f64; 11] = [
            0.0,
            -0.0,
            -1.0,
            1e-320,
            1e-9,
            1.0,
            1e18,
            1e308,
            f64::NAN,
            f64::INFINITY,
            f64::NEG_INFINITY,
        ];
        match self.below(2) {
            0 => ODD[self.below(ODD.len())],
            _ => f64::from_bits(self.next() << 24 | self.next() & 0xff_ffff),
        }
    }

    fn word(&mut self) -> u32 {
        match self.below(4) {
            0 => self.below(8) as u32,
            1 => self.below(400) as u32,
            2 => u32::MAX - self.below(3) as u32,
            _ => self.next() as u32,
        }
    }
}

/// A part of the plan that can be damaged: its start, and its length in bytes.
struct Piece(*mut u8, usize);

impl Piece {
    fn damage(&self, random: &mut Random) {
        let Piece(start, bytes) = *self;
        let (at, number) = (4 * random.below(bytes / 4), random.number());
        // SAFETY: the bytes are within the piece, and every bit pattern is valid for every item.
        unsafe {
            match bytes - at {
                8.. if random.below(3) == 0 => start.add(at).cast::<f64>().write_unaligned(number),
                _ => start.add(at).cast::<u32>().write(random.word()),
            }
        }
    }
}

/// A plan in C with its arrays.
struct PlanCopy {
    plan: Box<Plan>,
    pieces: Vec<Piece>,
    counts: Vec<*mut usize>,
    /// The arrays that the plan points to.
    _arrays: Vec<Box<dyn Any>>,
}

#[derive(Default)]
struct Arrays {
    kept: Vec<Box<dyn Any>>,
    pieces: Vec<Piece>,
}

impl Arrays {
    fn keep<T: Copy + 'static>(&mut self, items: &[T]) -> Array<T> {
        let mut items = items.to_vec();
        let (start, count) = (items.as_mut_ptr(), items.len());
        if count > 0 {
            self.pieces
                .push(Piece(start.cast(), size_of_val(&items[..])));
        }
        self.kept.push(Box::new(items));
        Array {
            items: start,
            count,
        }
    }
}

macro_rules! copy {
    ($($(#[$doc:meta])* $array:ident: $item:ident,)*) => {
        fn copy(plan: &board::Plan<'_>) -> PlanCopy {
            let table = plan.rules.table;
            let mut arrays = Arrays::default();
            let filled = plan.filled.unwrap_or(FilledKnots { coordinates: &[], starts: &[], values: &[], distances: &[] });
            let [conjunctions, actions_per_cell, first_action, sums] = table.conjunctions.code();
            let channels: Vec<CChannel> = plan.channels.iter().map(channel).collect();
            let sources: Vec<CSource> = plan.inputs.iter().map(source).collect();
            let mut plan = Box::new(Plan {
                rules: Rules {
                    format: FORMAT,
                    and: (0..7).find(|code| conjunction(*code).ok() == Some(table.and)).unwrap(),
                    or: (0..7).find(|code| disjunction(*code).ok() == Some(table.or)).unwrap(),
                    conjunctions,
                    actions_per_cell,
                    first_action,
                    sums,
                    sizes: table.sizes,
                    least_strength: table.least_strength,
                    $($array: copy!(@keep $item arrays, table.$array),)*
                    stages: arrays.keep(plan.rules.stages),
                    indices: arrays.keep(plan.rules.indices),
                },
                output: plan.output,
                signals: plan.signals,
                coverage_below: plan.coverage_below,
                settings: settings(&plan.settings),
                order: arrays.keep(plan.order),
                channels: arrays.keep(&channels),
                sources: arrays.keep(&sources),
                coordinates: arrays.keep(filled.coordinates),
                first_coordinates: arrays.keep(filled.starts),
                values: arrays.keep(filled.values),
                distances: arrays.keep(filled.distances),
                propositions: arrays.keep(plan.propositions),
            });
            let counts = vec![
                $(&raw mut plan.rules.$array.count,)*
                &raw mut plan.rules.stages.count,
                &raw mut plan.rules.indices.count,
                &raw mut plan.order.count,
                &raw mut plan.channels.count,
                &raw mut plan.sources.count,
                &raw mut plan.coordinates.count,
                &raw mut plan.first_coordinates.count,
                &raw mut plan.values.count,
                &raw mut plan.distances.count,
                &raw mut plan.propositions.count,
            ];
            let Arrays { kept, mut pieces } = arrays;
            // The numbers at the front of the plan are listed several times, so that they are chosen for damage more
            // often.
            for _ in 0..pieces.len() / 4 {
                let words = 6 * size_of::<u32>();
                pieces.push(Piece((&raw mut plan.rules.and).cast(), words));
                pieces.push(Piece((&raw mut plan.rules.sizes).cast(), size_of::<Sizes>()));
                pieces.push(Piece((&raw mut plan.output).cast(), 8));
                pieces.push(Piece((&raw mut plan.coverage_below).cast(), 8));
                pieces.push(Piece((&raw mut plan.settings).cast(), size_of::<CSettings>()));
            }
            PlanCopy { plan, pieces, counts, _arrays: kept }
        }
    };
    (@keep Hedge $arrays:expr, $items:expr) => {
        $arrays.keep(&$items.iter().map(|hedge| *hedge as u32).collect::<Vec<_>>())
    };
    (@keep $item:ident $arrays:expr, $items:expr) => { $arrays.keep($items) };
}
table::arrays!(copy!);

fn channel(channel: &Channel) -> CChannel {
    let (observed, indices, unknown_below) = channel.observed.code();
    let (threshold, limit) = channel::Threshold::code(channel.threshold);
    CChannel {
        window_s: channel.window_s,
        limit,
        unknown_below,
        observed,
        indices,
        motors: channel.motors.code(),
        threshold,
        in_bins: channel.in_bins.into(),
        exponential: channel.exponential.into(),
    }
}

fn source(input: &channel::Input) -> CSource {
    let (statistic, number) = input.statistic.code();
    let place = |place: Option<usize>| place.map_or(NONE, |place| place as u32);
    CSource {
        number,
        at_least: input.ratio.map_or(0.0, |ratio| ratio.at_least),
        if_missing: input.if_missing.unwrap_or(f64::NAN),
        channel: input.channel as u32,
        statistic,
        per: place(input.ratio.map(|ratio| ratio.per)),
    }
}

fn settings(settings: &Settings) -> CSettings {
    let threshold = |threshold: Threshold| CThreshold {
        risk_pct: threshold.risk_pct.unwrap_or(f64::NAN),
        elevated_risk_pct: threshold.elevated_risk_pct.unwrap_or(f64::NAN),
    };
    let level = |level: LevelSettings| CLevelSettings {
        raise: threshold(level.raise),
        after_s: level.after_s,
        until: threshold(level.until),
    };
    let limit = |limit: Option<Limit>| CLimit {
        value: limit.map_or(f64::NAN, |limit| limit.value),
        after_s: limit.map_or(0.0, |limit| limit.after_s),
    };
    let Settings {
        sampling,
        elevated_risk,
        verdict,
    } = *settings;
    CSettings {
        warm_up_s: sampling.warm_up_s,
        longest_gap_s: sampling.longest_gap_s,
        take_off_s: sampling.take_off_s,
        risk_window_s: elevated_risk.window_s,
        high_pct: elevated_risk.high_pct,
        low_pct: elevated_risk.low_pct,
        rise_pct_per_s: elevated_risk.rise_pct_per_s,
        fall_pct_per_s: elevated_risk.fall_pct_per_s,
        warn: level(verdict.warn),
        fail: level(verdict.fail),
        clear_after_s: verdict.clear_after_s,
        quiet_after_take_off_s: verdict.quiet_after_take_off_s,
        quiet_before_landing_s: verdict.quiet_before_landing_s,
        idle_below: verdict.idle_below,
        noise: limit(verdict.notices.noise),
        reserve: limit(verdict.notices.reserve),
        imbalance: limit(verdict.notices.imbalance),
        min_samples: sampling.min_samples,
    }
}

/// Profiles whose plans together use every array: uniform, dense and trie tables, programs, curves, hedges, and
/// Takagi-Sugeno outputs.
fn estimators() -> Vec<Estimator> {
    const INPUTS: &str = "inputs:\n  a: {range: [0, 1], terms: {low: {left_shoulder: [0.2, 0.6]}, high: {gaussian: {mean: 0.8, sd: 0.2}}}}\n  \
        b: {range: [0, 1], partition: [low, medium, high]}\n  c: {range: [0, 1], partition: [low, medium, high]}\n";
    const MAMDANI: &str = "outputs: {risk: {range: [0, 100], partition: [low, high]}}\n\
        operators: {and: product, or: maximum, implication: product, aggregation: sum}\n";
    const SUGENO: &str = "outputs: {risk: {range: [0, 100], defuzzifier: weighted_average, terms: {low: {constant: 0}, high: {linear: {a: 50, b: 20, constant: 10}}}}}\n";
    const DENSE: &str = "  - IF a IS low AND b IS low THEN risk IS low\n  - IF a IS high AND b IS medium THEN risk IS high\n  \
        - IF b IS high AND c IS high THEN risk IS high\n  - IF a IS low AND c IS low THEN risk IS low\n";
    const PROGRAMS: &str = "  - IF a IS very low OR b IS NOT low AND c IS high THEN risk IS high\n  \
        - IF (a IS low OR b IS low) AND (b IS low OR c IS low) THEN risk IS low\n  - IF a IS somewhat high THEN risk IS low\n";
    let mut estimators = vec![shipped::flagred(), shipped::flagred_paper()];
    for outputs in [MAMDANI, SUGENO] {
        for rules in [DENSE, PROGRAMS] {
            let mut rules = format!("fuzzy: 1\nname: t\n{INPUTS}{outputs}rules:\n{rules}");
            // More rules are added, because a rule set with few rules uses no table.
            for (b, c) in ["low", "medium", "high"]
                .iter()
                .flat_map(|b| [(b, "low"), (b, "medium"), (b, "high")])
            {
                for (a, risk) in [("low", "low"), ("high", "high")] {
                    rules +=
                        &format!("  - IF a IS {a} AND b IS {b} AND c IS {c} THEN risk IS {risk}\n");
                    rules += &format!("  - IF a IS {a} AND c IS {c} THEN risk IS {risk}\n");
                }
            }
            let profile = "flagred: 1\nname: t\nrules: t\nwindow_s: 0.5\nwarm_up_s: 0.2\nmin_samples: 2\ninputs:\n  a: {mean: motor_margin}\n  \
                b: {std: motor_command}\n  c: {last: wind}\n";
            let profile: Profile = profile.parse().unwrap();
            estimators.push(Estimator::new(&profile, &rules.parse().unwrap()).unwrap());
        }
    }
    const CHAIN: &str = "outputs:\n  risk: {range: [0, 100], partition: [low, high]}\n  mid: {range: [0, 1], partition: [low, high]}\n  \
        end: {range: [0, 9], defuzzifier: weighted_average, terms: {far: {linear: {mid: 8, constant: 1}}}}\n\
        operators: {and: product, or: maximum, implication: product, aggregation: sum}\n";
    const READING: &str = "  - IF a IS low AND b IS low THEN mid IS low\n  - IF b IS high OR c IS low THEN mid IS high\n  \
        - IF mid IS very high AND c IS high THEN risk IS high\n  - IF mid IS NOT high THEN risk IS low\n  - IF a IS high THEN end IS far\n";
    let rules = format!("fuzzy: 1\nname: t\n{INPUTS}{CHAIN}rules:\n{READING}");
    let profile = "flagred: 1\nname: t\nrules: t\nwindow_s: 0.5\nwarm_up_s: 0.2\nmin_samples: 2\ninputs:\n  \
        a: {percentile: 90, of: {motor: 2, of: motor_margin}}\n  b: {mean: {difference: [wind, gust]}, time_constant_s: 1}\n  c: {rate: wind}\n";
    let profile: Profile = profile.parse().unwrap();
    estimators.push(Estimator::new(&profile, &rules.parse().unwrap()).unwrap());
    estimators
}

const MOTORS: usize = 4;
/// An upper bound for the memory of the plans in these tests.
const MAX_BYTES: usize = 1 << 21;

fn start(plan: &Plan, memory: &mut [u128], size: usize) -> (i32, *mut CMonitor) {
    let mut monitor = ptr::null_mut();
    let place = memory.as_mut_ptr().cast();
    // SAFETY: the plan's arrays and the memory have the stated lengths, and outlive the monitor.
    let status = unsafe { flagred_start(plan, MOTORS, ptr::null(), place, size, &mut monitor) };
    (status, monitor)
}

/// A short flight with numbers that are likely to cause trouble.
fn fly(monitor: *mut CMonitor, plan: &Plan, random: &mut Random) {
    let mut update = MaybeUninit::uninit();
    let mut t_s = 0.0;
    for i in 0..80 {
        t_s += match random.below(20) {
            0 => random.number(),
            _ => 0.05,
        };
        let odd = random.below(10) == 0;
        let mut value = || if odd { random.number() } else { random.share() };
        let commands: Vec<f64> = (0..MOTORS).map(|_| value()).collect();
        let signals: Vec<f64> = (0..3).map(|_| value()).collect();
        let array = |items: &[f64]| Array {
            items: items.as_ptr(),
            count: items.len(),
        };
        let sample = CSample {
            t_s,
            commands: array(&commands),
            signals: array(&signals),
            in_air: i32::from(i > 5),
        };
        let inputs: Vec<f64> = (0..plan.sources.count).map(|_| value()).collect();
        // SAFETY: the monitor is started, the arrays have the stated lengths, the update is writable.
        unsafe {
            let pushed = flagred_push(monitor, &sample, update.as_mut_ptr());
            assert_eq!(pushed, Status::Ok as i32);
            flagred_evaluate(monitor, inputs.as_ptr(), inputs.len(), update.as_mut_ptr());
        }
    }
    let mut ended = MaybeUninit::uninit();
    // SAFETY: the monitor is started, and the findings are writable.
    unsafe { flagred_finish(monitor, ended.as_mut_ptr()) };
}

#[test]
fn a_damaged_plan_is_refused_or_can_be_pushed() {
    let mut memory = vec![0_u128; MAX_BYTES / 16];
    let mut random = Random(20_261_122);
    let (mut accepted, mut refused) = (0, 0);
    let mut kinds = [0; 3];
    for estimator in estimators() {
        let plan = estimator.plan().unwrap();
        kinds[copy(&plan).plan.rules.conjunctions as usize] += 1;
        for round in 0..ROUNDS {
            let copied = copy(&plan);
            if round > 0 {
                for _ in 0..=random.below(3) {
                    copied.pieces[random.below(copied.pieces.len())].damage(&mut random);
                }
            }
            if round % 4 == 3 {
                let count = copied.counts[random.below(copied.counts.len())];
                // SAFETY: the pointer is to a count in the plan, which stays in its box. A smaller count is also valid
                // for the array.
                unsafe { *count = random.below(*count + 1) };
            }
            let plan = &*copied.plan;
            // SAFETY: the arrays have the stated lengths.
            let bytes = unsafe { flagred_memory_size(plan, MOTORS) };
            let (status, monitor) = start(plan, &mut memory, MAX_BYTES);
            assert!(round > 0 || status == Status::Ok as i32, "{status}");
            if status != Status::Ok as i32 {
                refused += 1;
                continue;
            }
            accepted += 1;
            assert!(bytes > 0 && bytes <= MAX_BYTES);
            fly(monitor, plan, &mut random);
            for (size, expected) in [(bytes, Status::Ok), (bytes - 1, Status::MemorySize)] {
                assert_eq!(start(plan, &mut memory, size).0, expected as i32);
            }
        }
    }
    assert!(kinds.iter().all(|count| *count > 0), "{kinds:?}");
    assert!(
        accepted > ROUNDS && refused > ROUNDS,
        "{accepted} {refused}"
    );
}

const ROUNDS: usize = 3000;

/// A size that overflows is refused instead of wrapping around to a small one.
#[test]
fn sizes_do_not_wrap() {
    let estimator = shipped::flagred_paper();
    let mut copied = copy(&estimator.plan().unwrap());
    let mut memory = vec![0_u128; MAX_BYTES / 16];
    let mut monitor = ptr::null_mut();
    let place = memory.as_mut_ptr().cast();
    for motors in [usize::MAX, usize::MAX / 8, isize::MAX as usize] {
        // SAFETY: the arrays of the plan have the stated lengths, and the memory exists.
        let (bytes, status) = unsafe {
            let bytes = flagred_memory_size(&*copied.plan, motors);
            let limits = ptr::null();
            let plan = &*copied.plan;
            let status = flagred_start(plan, motors, limits, place, MAX_BYTES, &mut monitor);
            (bytes, status)
        };
        assert!(bytes == 0 || bytes > MAX_BYTES, "{motors} motors: {bytes}");
        assert_eq!(status, Status::MemorySize as i32);
    }
    for count in [usize::MAX, usize::MAX / 4] {
        copied.plan.rules.lines.count = count;
        // SAFETY: an impossible array is refused before it is read.
        let bytes = unsafe { flagred_memory_size(&*copied.plan, MOTORS) };
        assert_eq!(bytes, 0);
    }
}
