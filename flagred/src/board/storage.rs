//! The memory of a monitor, in three forms: parts that the caller provides, one value that can be static, and allocated
//! memory.

use fuzzy::table::{Outcome, PartialConjunction, StrongestRule};

use super::{Monitor, Plan, SetupError};
use crate::{
    channel::{Channel, ChannelState},
    margin::Range,
    verdict::Motor,
    window::Window,
};

/// The sizes of a plan's memory, without the memory of its motors.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sizes {
    /// The number of floating-point numbers.
    pub numbers: usize,
    /// The number of partial conjunctions.
    pub partials: usize,
    /// The number of outputs.
    pub outputs: usize,
    /// The number of channels.
    pub channels: usize,
}

/// The memory of a monitor, with the [`Sizes`] of its plan.
#[derive(Debug)]
#[doc(hidden)] // For the C interface. Rust uses `Storage` or `OwnedMemory`.
pub struct Memory<'m> {
    /// The floating-point numbers; their count is [`Sizes::numbers`].
    pub numbers: &'m mut [f64],
    /// The partial conjunctions; their count is [`Sizes::partials`].
    pub partials: &'m mut [PartialConjunction],
    /// The strongest rule of each output; the length is [`Sizes::outputs`].
    pub strongest: &'m mut [StrongestRule],
    /// The outcome of each output; the length is [`Sizes::outputs`].
    pub outcomes: &'m mut [Outcome],
    /// The outcomes of one stage of a chain; the length is [`Sizes::outputs`].
    pub own: &'m mut [Outcome],
    /// The state of each channel; the length is [`Sizes::channels`].
    pub seen: &'m mut [ChannelState],
    /// The window of the last risks.
    pub risks: &'m mut Window,
    /// The state of each motor.
    pub motors: &'m mut [Motor],
}

/// Borrows memory whose arrays or vectors have the same names as the fields of [`Memory`].
macro_rules! lent {
    ($held:expr) => {
        Memory {
            numbers: &mut $held.numbers,
            partials: &mut $held.partials,
            strongest: &mut $held.strongest,
            outcomes: &mut $held.outcomes,
            own: &mut $held.own,
            seen: &mut $held.seen,
            risks: &mut $held.risks,
            motors: &mut $held.motors,
        }
    };
}

impl Plan<'_> {
    /// The sizes of the memory that the plan requires.
    pub const fn sizes(&self) -> Sizes {
        let numbers = self
            .rules
            .numbers()
            .saturating_add(self.order.len())
            .saturating_add(self.inputs.len());
        Sizes {
            numbers,
            partials: self.rules.partials(),
            outputs: self.rules.table.outputs.len(),
            channels: self.channels.len(),
        }
    }

    /// An upper bound for the total size of the plan, the monitor, its memory, and the limits and command of each
    /// motor, in bytes, if no part of them needs an alignment of more than 16 bytes.
    pub const fn bytes(&self, motors: usize) -> usize {
        const ALIGNED: usize = 15;
        let sizes = self.sizes();
        let own = size_of::<Plan<'_>>() + size_of::<Monitor<'_>>() + size_of::<Window>();
        let channel = size_of::<ChannelState>() + size_of::<Channel>();
        let output = size_of::<StrongestRule>() + 2 * size_of::<Outcome>();
        let motor = size_of::<Motor>() + size_of::<Range>() + size_of::<f64>();
        let frame = 4 * size_of::<usize>() + 16 * ALIGNED;
        (own + frame + size_of_val(self.inputs))
            .saturating_add(sizes.channels.saturating_mul(channel))
            .saturating_add(sizes.outputs.saturating_mul(output))
            .saturating_add(sizes.numbers.saturating_mul(size_of::<f64>()))
            .saturating_add(
                sizes
                    .partials
                    .saturating_mul(size_of::<PartialConjunction>()),
            )
            .saturating_add(motors.saturating_mul(motor))
    }
}

/// The memory of a monitor as one value. An exported profile defines the type with its sizes.
///
/// A static `Storage` is all zeros, so it takes no space in the firmware image.
///
/// # Example: `Storage<4>` of the exported profile `flagred-paper`
/// ```
/// use flagred::{board::Storage, sample::{Sample, Unknown}, shipped};
///
/// let estimator = shipped::flagred_paper();
/// let plan = estimator.plan()?; // on board, the exported `PLAN`
/// let mut storage: Storage<14, 12, 1, 2, 4> = Storage::new();
/// let mut monitor = storage.monitor(&plan)?;
/// let update = monitor.push(&Sample { t_s: 0.0, motors: &[0.0; 4], in_air: Some(false), signals: &[] });
/// assert_eq!(update.risk, Err(Unknown::OnGround));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Storage<
    const NUMBERS: usize,
    const PARTIALS: usize,
    const OUTPUTS: usize,
    const CHANNELS: usize,
    const MOTORS: usize,
> {
    numbers: [f64; NUMBERS],
    partials: [PartialConjunction; PARTIALS],
    strongest: [StrongestRule; OUTPUTS],
    outcomes: [Outcome; OUTPUTS],
    own: [Outcome; OUTPUTS],
    seen: [ChannelState; CHANNELS],
    risks: Window,
    motors: [Motor; MOTORS],
}

impl<
    const NUMBERS: usize,
    const PARTIALS: usize,
    const OUTPUTS: usize,
    const CHANNELS: usize,
    const MOTORS: usize,
> Storage<NUMBERS, PARTIALS, OUTPUTS, CHANNELS, MOTORS>
{
    /// Creates memory for one monitor.
    #[expect(
        clippy::new_without_default,
        reason = "made in a `static`, where `default` cannot be called"
    )]
    pub const fn new() -> Self {
        Storage {
            numbers: [0.0; NUMBERS],
            partials: [PartialConjunction::NONE; PARTIALS],
            strongest: [StrongestRule::NONE; OUTPUTS],
            outcomes: [Outcome::UNDEFINED; OUTPUTS],
            own: [Outcome::UNDEFINED; OUTPUTS],
            seen: [const { ChannelState::IDLE }; CHANNELS],
            risks: Window::IDLE,
            motors: [Motor::IDLE; MOTORS],
        }
    }

    /// Creates a monitor of a new flight in this memory.
    ///
    /// # Errors
    /// As [`Monitor::new`].
    pub fn monitor<'a>(&'a mut self, plan: &'a Plan<'a>) -> Result<Monitor<'a>, SetupError> {
        Monitor::new(plan, lent!(self))
    }
}

/// The allocated memory of a monitor.
#[cfg(feature = "std")]
#[derive(Debug)]
pub struct OwnedMemory {
    numbers: Vec<f64>,
    partials: Vec<PartialConjunction>,
    strongest: Vec<StrongestRule>,
    outcomes: Vec<Outcome>,
    own: Vec<Outcome>,
    seen: Vec<ChannelState>,
    risks: Window,
    motors: Vec<Motor>,
}

#[cfg(feature = "std")]
impl OwnedMemory {
    /// Allocates memory for one monitor of the plan.
    pub fn new(plan: &Plan<'_>, motors: usize) -> Self {
        let sizes = plan.sizes();
        OwnedMemory {
            numbers: vec![0.0; sizes.numbers],
            partials: vec![PartialConjunction::NONE; sizes.partials],
            strongest: vec![StrongestRule::NONE; sizes.outputs],
            outcomes: vec![Outcome::UNDEFINED; sizes.outputs],
            own: vec![Outcome::UNDEFINED; sizes.outputs],
            seen: vec![ChannelState::IDLE; sizes.channels],
            risks: Window::IDLE,
            motors: vec![Motor::UNKNOWN; motors],
        }
    }

    /// Creates a monitor of a new flight in this memory.
    ///
    /// # Errors
    /// As [`Monitor::new`].
    pub fn monitor<'a>(&'a mut self, plan: &'a Plan<'a>) -> Result<Monitor<'a>, SetupError> {
        Monitor::new(plan, lent!(self))
    }
}
