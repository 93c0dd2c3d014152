//! The exported plan as C data.

use flagred::{
    accumulator::AccumulatorSettings,
    board::{self, Proposition},
    channel::{self, Channel, Motors, Observed, Statistic},
    follower::Settings,
    gap::FilledKnots,
    sample::Sampling,
    verdict::{LevelSettings, Limit, NoticeSettings, Threshold, VerdictSettings},
};

use crate::{array::Array, memory::Block, rules::Rules, status::Status};

#[cfg(test)]
mod tests;

#[derive(Debug, Clone, Copy)]
#[repr(C)]
struct CChannel {
    window_s: f64,
    limit: f64,
    unknown_below: f64,
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
    at_least: f64,
    if_missing: f64,
    channel: u32,
    statistic: u32,
    per: u32,
}

/// The index that stands for a missing source.
const NONE: u32 = u32::MAX;

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

/// An exported plan: `struct flagred_plan` in C.
#[derive(Debug)]
#[repr(C)]
pub struct Plan {
    pub(crate) rules: Rules,
    output: u32,
    signals: u32,
    coverage_below: f64,
    settings: CSettings,
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
    /// The size of a monitor's memory.
    ///
    /// # Safety
    /// The arrays must have the stated lengths.
    #[allow(unsafe_code, reason = "foreign memory")]
    pub(crate) unsafe fn bytes(&self, motors: usize) -> Result<usize, Status> {
        // SAFETY: the caller's promise.
        let plan = unsafe { self.whole(&[], &[]) }?;
        // The memory also stores the channels and inputs after their conversion.
        let channel = size_of::<Channel>() + size_of::<channel::ChannelState>();
        let input = size_of::<channel::Input>() + size_of::<f64>();
        let channels = self.channels.count.checked_mul(channel);
        let inputs = self.sources.count.checked_mul(input);
        let bytes = plan
            .bytes(motors)
            .checked_add(channels.ok_or(Status::DamagedPlan)?);
        let bytes = bytes.and_then(|bytes| bytes.checked_add(inputs?));
        bytes.ok_or(Status::MemorySize)
    }

    /// Converts the plan. The converted channels and inputs are stored in the block.
    ///
    /// # Safety
    /// The arrays must have the stated lengths, and must not change.
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
    /// The arrays must have the stated lengths, and must not change.
    #[allow(unsafe_code, reason = "foreign memory")]
    unsafe fn whole<'a>(
        &self,
        channels: &'a [Channel],
        inputs: &'a [channel::Input],
    ) -> Result<board::Plan<'a>, Status> {
        // SAFETY: the caller's promise, for all arrays of the plan.
        unsafe {
            let rules = self.rules.read()?;
            let knots = FilledKnots {
                coordinates: self.coordinates.read()?,
                starts: self.first_coordinates.read()?,
                values: self.values.read()?,
                distances: self.distances.read()?,
            };
            Ok(board::Plan {
                name: "",
                rules,
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

impl CChannel {
    fn read(&self) -> Result<Channel, Status> {
        let known = || {
            Some(Channel {
                observed: Observed::from_code(self.observed, self.indices, self.unknown_below)?,
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
            ratio: (self.per != NONE).then_some(channel::Ratio {
                per: self.per as usize,
                at_least: self.at_least,
            }),
            if_missing: known(self.if_missing),
        })
    }
}

/// Converts a limit from C, where NaN means no limit.
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
