//! Memory for a monitor as one value, which can be static.

use fuzzy::table::{Outcome, Partial, Scratch, Strongest};

use super::{Memory, Monitor, Plan, Refused};
use crate::{
    channel::{Channel, Seen},
    margin::Range,
    verdict::Motor,
    window::Window,
};

/// Memory for a monitor of a plan: of numbers, of ANDs on their way, of outputs, channels and motors. The exported
/// profile names the sizes.
///
/// A static one is all zeros, so it takes memory but no place in firmware.
#[derive(Debug)]
pub struct Storage<
    const NUMBERS: usize,
    const PARTIALS: usize,
    const OUTPUTS: usize,
    const CHANNELS: usize,
    const MOTORS: usize,
> {
    numbers: [f64; NUMBERS],
    partials: [Partial; PARTIALS],
    strongest: [Strongest; OUTPUTS],
    outcomes: [Outcome; OUTPUTS],
    seen: [Seen; CHANNELS],
    risks: Window,
    motors: [Motor; MOTORS],
}

/// How much memory a plan needs beside its motors.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sizes {
    /// Numbers, of all kinds.
    pub numbers: usize,
    /// ANDs on their way.
    pub partials: usize,
    /// Outputs.
    pub outputs: usize,
    /// Channels.
    pub channels: usize,
}

/// The parts of which a monitor's memory is made, each of the plan's [`Sizes`].
#[derive(Debug)]
#[expect(missing_docs, reason = "each is said at `Sizes` and `Memory`")]
pub struct Parts<'m> {
    pub numbers: &'m mut [f64],
    pub partials: &'m mut [Partial],
    pub strongest: &'m mut [Strongest],
    pub outcomes: &'m mut [Outcome],
    pub seen: &'m mut [Seen],
    pub risks: &'m mut Window,
    pub motors: &'m mut [Motor],
}

impl Plan<'_> {
    /// How much memory it needs.
    pub const fn sizes(&self) -> Sizes {
        let inputs = self.table.inputs.len();
        let sizes = self.table.sizes;
        let rules = sizes.degrees as usize + sizes.stack as usize + sizes.heights as usize;
        Sizes {
            numbers: 2 * inputs + self.inputs.len() + rules,
            partials: sizes.alive as usize + 2 * sizes.partial as usize,
            outputs: self.table.outputs.len(),
            channels: self.channels.len(),
        }
    }

    /// At most so many bytes hold the plan's and the monitor's own data, all its memory, and for each motor its limits and
    /// its command; pieces may be aligned to 16 bytes.
    pub const fn bytes(&self, motors: usize) -> usize {
        const ALIGNED: usize = 15;
        let sizes = self.sizes();
        let own = size_of::<Plan<'_>>() + size_of::<Monitor<'_>>() + size_of::<Window>();
        let channels = sizes.channels * (size_of::<Seen>() + size_of::<Channel>());
        let sources = size_of_val(self.inputs);
        let outputs = sizes.outputs * (size_of::<Strongest>() + size_of::<Outcome>());
        let numbers = sizes.numbers * size_of::<f64>() + sizes.partials * size_of::<Partial>();
        let motor = size_of::<Motor>() + size_of::<Range>() + size_of::<f64>();
        let frame = 4 * size_of::<usize>() + 16 * ALIGNED;
        own + channels + sources + outputs + numbers + motors * motor + frame
    }
}

impl<'m> Memory<'m> {
    /// The memory of a monitor of its parts; `None` where they are not of the plan's sizes.
    pub fn of(plan: &Plan<'_>, parts: Parts<'m>) -> Option<Memory<'m>> {
        let sizes = plan.table.sizes;
        let inputs = plan.table.inputs.len();
        let Parts {
            mut numbers,
            mut partials,
            strongest,
            outcomes,
            seen,
            risks,
            motors,
        } = parts;
        Some(Memory {
            scratch: Scratch {
                values: take(&mut numbers, inputs)?,
                degrees: take(&mut numbers, sizes.degrees as usize)?,
                stack: take(&mut numbers, sizes.stack as usize)?,
                heights: take(&mut numbers, sizes.heights as usize)?,
                alive: take(&mut partials, sizes.alive as usize)?,
                partial: take(&mut partials, sizes.partial as usize)?,
                next: take(&mut partials, sizes.partial as usize)?,
                strongest,
            },
            point: take(&mut numbers, inputs)?,
            inputs: take(&mut numbers, plan.inputs.len())?,
            outcomes,
            seen,
            risks,
            motors,
        })
    }
}

/// Takes the first so many off what is left.
fn take<'m, T>(rest: &mut &'m mut [T], many: usize) -> Option<&'m mut [T]> {
    let (taken, left) = core::mem::take(rest).split_at_mut_checked(many)?;
    *rest = left;
    Some(taken)
}

impl<
    const NUMBERS: usize,
    const PARTIALS: usize,
    const OUTPUTS: usize,
    const CHANNELS: usize,
    const MOTORS: usize,
> Storage<NUMBERS, PARTIALS, OUTPUTS, CHANNELS, MOTORS>
{
    /// Memory that holds nothing yet.
    pub const fn new() -> Self {
        Storage {
            numbers: [0.0; NUMBERS],
            partials: [Partial::NONE; PARTIALS],
            strongest: [Strongest::NONE; OUTPUTS],
            outcomes: [Outcome::UNDEFINED; OUTPUTS],
            seen: [const { Seen::IDLE }; CHANNELS],
            risks: Window::IDLE,
            motors: [Motor::IDLE; MOTORS],
        }
    }

    /// A monitor of a new flight, in this memory.
    ///
    /// # Errors
    /// The plan is another than the one that the sizes were made for, it is damaged, or there is no motor.
    pub fn monitor<'a>(&'a mut self, plan: &'a Plan<'a>) -> Result<Monitor<'a>, Refused> {
        let parts = Parts {
            numbers: &mut self.numbers,
            partials: &mut self.partials,
            strongest: &mut self.strongest,
            outcomes: &mut self.outcomes,
            seen: &mut self.seen,
            risks: &mut self.risks,
            motors: &mut self.motors,
        };
        let memory = Memory::of(plan, parts).ok_or(Refused::Memory)?;
        Monitor::new(plan, memory)
    }
}

impl<
    const NUMBERS: usize,
    const PARTIALS: usize,
    const OUTPUTS: usize,
    const CHANNELS: usize,
    const MOTORS: usize,
> Default for Storage<NUMBERS, PARTIALS, OUTPUTS, CHANNELS, MOTORS>
{
    fn default() -> Self {
        Storage::new()
    }
}
