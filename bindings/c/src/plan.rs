//! The exported plan in C.

use flagred::{
    accumulator::AccumulatorSettings,
    board::{
        self, Proposition,
        table::{
            self, Action, Axis, Block as RuleBlock, Coefficient, Conjunction, Conjunctions,
            Consequent, Curve, Dimension, Disjunction, Edge, Flank, FuzzySet, Hedge, Input, Knot,
            Line, Moment, Node, Output, Pair, Point, Program, Section, SetTerm, Sizes, Step,
            Strand, Table,
        },
    },
    channel::{self, Channel, Motors, Observed, Statistic},
    follower::Settings,
    gap::FilledKnots,
    sample::Sampling,
    verdict::{LevelSettings, Limit, NoticeSettings, Threshold, VerdictSettings},
};

use crate::{memory::Block, status::Status};

#[cfg(test)]
mod tests;

/// The version of the data that this library reads.
const FORMAT: u32 = 5;

/// An array of C and its length.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub(crate) struct Array<T> {
    pub(crate) items: *const T,
    pub(crate) count: usize,
}

impl<T> Array<T> {
    /// The array as a slice.
    ///
    /// # Safety
    /// It is null or has `count` items, and does not change while the slice is used.
    #[allow(unsafe_code, reason = "foreign memory")]
    pub(crate) unsafe fn read<'a>(&self) -> Result<&'a [T], Status> {
        if self.count == 0 {
            return Ok(&[]);
        }
        if self.items.is_null() || !self.items.is_aligned() {
            return Err(Status::NullPointer);
        }
        // No object is larger: the count is damaged.
        let bytes = self.count.checked_mul(size_of::<T>());
        if bytes.is_none_or(|bytes| bytes > isize::MAX as usize) {
            return Err(Status::DamagedPlan);
        }
        // SAFETY: neither null nor unaligned, of a possible size, and the caller's promise.
        Ok(unsafe { core::slice::from_raw_parts(self.items, self.count) })
    }
}

#[derive(Debug, Clone, Copy)]
#[repr(C)]
struct CChannel {
    window_s: f64,
    limit: f64,
    observed: u32,
    indices: [u32; 2],
    motors: u32,
    threshold: u32,
    in_bins: u32,
    exponential: u32,
}

#[derive(Debug, Clone, Copy)]
#[repr(C)]
struct CSource {
    number: f64,
    channel: u32,
    statistic: u32,
}

#[derive(Debug, Clone, Copy)]
#[repr(C)]
struct CThreshold {
    risk_pct: f64,
    elevated_risk_pct: f64,
}

#[derive(Debug, Clone, Copy)]
#[repr(C)]
struct CLevelSettings {
    raise: CThreshold,
    after_s: f64,
    until: CThreshold,
}

#[derive(Debug, Clone, Copy)]
#[repr(C)]
struct CLimit {
    value: f64,
    after_s: f64,
}

#[derive(Debug, Clone, Copy)]
#[repr(C)]
struct CSettings {
    warm_up_s: f64,
    longest_gap_s: f64,
    take_off_s: f64,
    risk_window_s: f64,
    high_pct: f64,
    low_pct: f64,
    rise_pct_per_s: f64,
    fall_pct_per_s: f64,
    warn: CLevelSettings,
    fail: CLevelSettings,
    clear_after_s: f64,
    quiet_after_take_off_s: f64,
    quiet_before_landing_s: f64,
    idle_below: f64,
    noise: CLimit,
    reserve: CLimit,
    imbalance: CLimit,
    min_samples: u32,
}

macro_rules! define {
    ($($(#[$doc:meta])* $array:ident: $item:ident,)*) => {
        /// `struct flagred_plan`.
        #[derive(Debug)]
        #[repr(C)]
        pub struct Plan {
            format: u32,
            and: u32,
            or: u32,
            conjunctions: u32,
            actions_a_cell: u32,
            first_action: u32,
            sums: u32,
            sizes: Sizes,
            output: u32,
            signals: u32,
            coverage_below: f64,
            least_strength: f64,
            settings: CSettings,
            $($array: Array<define!(@item $item)>,)*
            order: Array<u32>,
            channels: Array<CChannel>,
            sources: Array<CSource>,
            coordinates: Array<f64>,
            first_coordinates: Array<u32>,
            values: Array<f64>,
            distances: Array<f64>,
            propositions: Array<Proposition>,
        }

        impl Plan {
            /// # Safety
            /// The arrays have the lengths they say, and do not change.
            #[allow(unsafe_code, reason = "foreign memory")]
            unsafe fn table<'a>(&self) -> Result<Table<'a>, Status> {
                // SAFETY: the caller's promise, for all arrays.
                unsafe {
                    Ok(Table {
                        and: conjunction(self.and)?,
                        or: disjunction(self.or)?,
                        conjunctions: self.conjunctions()?,
                        least_strength: self.least_strength,
                        sizes: self.sizes,
                        $($array: define!(@read $item self.$array),)*
                    })
                }
            }
        }
    };
    // An enumeration, whose codes are verified before they become a reference. Of all other items every bit pattern is valid.
    (@item Hedge) => { u32 };
    (@item Block) => { RuleBlock };
    (@item $item:ident) => { $item };
    (@read Hedge $array:expr) => { hedges($array.read()?)? };
    (@read $item:ident $array:expr) => { $array.read()? };
}
table::arrays!(define!);

impl Plan {
    /// The size of a monitor's memory.
    ///
    /// # Safety
    /// The arrays have the lengths they say.
    #[allow(unsafe_code, reason = "foreign memory")]
    pub(crate) unsafe fn bytes(&self, motors: usize) -> Result<usize, Status> {
        // SAFETY: the caller's promise.
        let plan = unsafe { self.whole(&[], &[]) }?;
        // Plus the channels and inputs, which are converted into the memory.
        let channel = size_of::<Channel>() + size_of::<channel::Seen>();
        let input = size_of::<channel::Input>() + size_of::<f64>();
        let channels = self.channels.count.checked_mul(channel);
        let inputs = self.sources.count.checked_mul(input);
        let bytes = plan
            .bytes(motors)
            .checked_add(channels.ok_or(Status::DamagedPlan)?);
        let bytes = bytes.and_then(|bytes| bytes.checked_add(inputs?));
        bytes.ok_or(Status::MemorySize)
    }

    /// The plan, with its channels and inputs converted into the block.
    ///
    /// # Safety
    /// The arrays have the lengths they say, and do not change.
    #[allow(unsafe_code, reason = "foreign memory")]
    pub(crate) unsafe fn read(&self, block: &mut Block) -> Result<board::Plan<'static>, Status> {
        // SAFETY: the caller's promise.
        let (channels, sources) = unsafe { (self.channels.read()?, self.sources.read()?) };
        let get = |i: usize| channels.get(i).ok_or(Status::DamagedPlan);
        let channels = block.repeat(channels.len(), |i| get(i)?.read())?;
        let get = |i: usize| sources.get(i).ok_or(Status::DamagedPlan);
        let inputs = block.repeat(sources.len(), |i| get(i)?.read())?;
        // SAFETY: the caller's promise.
        unsafe { self.whole(channels, inputs) }
    }

    /// # Safety
    /// The arrays have the lengths they say, and do not change.
    #[allow(unsafe_code, reason = "foreign memory")]
    unsafe fn whole<'a>(
        &self,
        channels: &'a [Channel],
        inputs: &'a [channel::Input],
    ) -> Result<board::Plan<'a>, Status> {
        if self.format != FORMAT {
            return Err(Status::OtherFormat);
        }
        // SAFETY: the caller's promise, for all arrays of the plan.
        unsafe {
            let knots = FilledKnots {
                coordinates: self.coordinates.read()?,
                starts: self.first_coordinates.read()?,
                values: self.values.read()?,
                distances: self.distances.read()?,
            };
            Ok(board::Plan {
                name: "",
                table: self.table()?,
                output: self.output,
                order: self.order.read()?,
                channels,
                inputs,
                signals: self.signals,
                settings: self.settings.read(),
                coverage_below: self.coverage_below,
                filled: (!knots.values.is_empty()).then_some(knots),
                propositions: self.propositions.read()?,
            })
        }
    }
}

impl Plan {
    fn conjunctions(&self) -> Result<Conjunctions, Status> {
        Ok(match self.conjunctions {
            0 => Conjunctions::Uniform {
                actions_a_cell: self.actions_a_cell,
                first_action: self.first_action,
                sums: self.sums != 0,
            },
            1 => Conjunctions::Dense,
            2 => Conjunctions::Trie,
            _ => return Err(Status::DamagedPlan),
        })
    }
}

/// Hedges from their codes, where all codes are valid.
#[allow(unsafe_code, reason = "foreign memory")]
fn hedges(codes: &[u32]) -> Result<&[Hedge], Status> {
    if codes.iter().any(|code| *code as usize >= Hedge::ALL.len()) {
        return Err(Status::DamagedPlan);
    }
    // SAFETY: a hedge is a `u32` below the number of hedges, and all codes are.
    Ok(unsafe { core::slice::from_raw_parts(codes.as_ptr().cast(), codes.len()) })
}

fn conjunction(code: u32) -> Result<Conjunction, Status> {
    Ok(match code {
        0 => Conjunction::Minimum,
        1 => Conjunction::Product,
        2 => Conjunction::BoundedDifference,
        3 => Conjunction::Drastic,
        4 => Conjunction::Einstein,
        5 => Conjunction::Hamacher,
        6 => Conjunction::NilpotentMinimum,
        _ => return Err(Status::DamagedPlan),
    })
}

fn disjunction(code: u32) -> Result<Disjunction, Status> {
    Ok(match code {
        0 => Disjunction::Maximum,
        1 => Disjunction::ProbabilisticSum,
        2 => Disjunction::BoundedSum,
        3 => Disjunction::Drastic,
        4 => Disjunction::Einstein,
        5 => Disjunction::Hamacher,
        6 => Disjunction::NilpotentMaximum,
        _ => return Err(Status::DamagedPlan),
    })
}

impl CChannel {
    fn read(&self) -> Result<Channel, Status> {
        let known = || {
            Some(Channel {
                observed: Observed::from_code(self.observed, self.indices)?,
                motors: Motors::from_code(self.motors),
                threshold: channel::Threshold::from_code(self.threshold, self.limit)?,
                in_bins: self.in_bins != 0,
                window_s: self.window_s,
                exponential: self.exponential != 0,
            })
        };
        known().ok_or(Status::DamagedPlan)
    }
}

impl CSource {
    fn read(&self) -> Result<channel::Input, Status> {
        let statistic = Statistic::from_code(self.statistic, self.number);
        Ok(channel::Input {
            channel: self.channel as usize,
            statistic: statistic.ok_or(Status::DamagedPlan)?,
        })
    }
}

/// A limit; NaN is none.
fn known(limit: f64) -> Option<f64> {
    (!limit.is_nan()).then_some(limit)
}

impl CThreshold {
    fn read(&self) -> Threshold {
        Threshold {
            risk_pct: known(self.risk_pct),
            elevated_risk_pct: known(self.elevated_risk_pct),
        }
    }
}

impl CLimit {
    fn read(&self) -> Option<Limit> {
        let CLimit { value, after_s } = *self;
        known(value).map(|value| Limit { value, after_s })
    }
}

impl CLevelSettings {
    fn read(&self) -> LevelSettings {
        LevelSettings {
            raise: self.raise.read(),
            after_s: self.after_s,
            until: self.until.read(),
        }
    }
}

impl CSettings {
    fn read(&self) -> Settings {
        Settings {
            sampling: Sampling {
                min_samples: self.min_samples,
                warm_up_s: self.warm_up_s,
                longest_gap_s: self.longest_gap_s,
                take_off_s: self.take_off_s,
            },
            elevated_risk: AccumulatorSettings {
                window_s: self.risk_window_s,
                high_pct: self.high_pct,
                low_pct: self.low_pct,
                rise_pct_per_s: self.rise_pct_per_s,
                fall_pct_per_s: self.fall_pct_per_s,
            },
            verdict: VerdictSettings {
                warn: self.warn.read(),
                fail: self.fail.read(),
                clear_after_s: self.clear_after_s,
                quiet_after_take_off_s: self.quiet_after_take_off_s,
                quiet_before_landing_s: self.quiet_before_landing_s,
                idle_below: self.idle_below,
                notices: NoticeSettings {
                    noise: self.noise.read(),
                    reserve: self.reserve.read(),
                    imbalance: self.imbalance.read(),
                },
            },
        }
    }
}
