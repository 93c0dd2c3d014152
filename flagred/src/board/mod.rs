//! What flies on board: a monitor in fixed memory that the caller lends, without an allocator or a standard library.
//!
//! `flagred export --rust` writes a profile and its rule set as a [`Plan`] of plain data, and the type of the [`Storage`]
//! that a [`Monitor`] of it lives in; [`Estimator::plan`](crate::estimator::Estimator::plan) makes one where there is the
//! standard library. A monitor says, bit for bit, what [`flagred::monitor::Monitor`](crate::monitor::Monitor) says.
//!
//! # Example: a monitor in memory of one's own
//!
//! ```
//! use flagred::{
//!     sample::Sample, board::{Memory, Monitor, Parts, table::{Outcome, Partial, Strongest}},
//!     channel::Seen, estimator::Estimator, shipped, verdict::Motor, window::Window,
//! };
//!
//! let estimator = shipped::flagred();
//! let plan = estimator.plan()?;
//!
//! let sizes = plan.sizes();
//! let (mut numbers, mut partials) = (vec![0.0; sizes.numbers], vec![Partial::NONE; sizes.partials]);
//! let mut strongest = vec![Strongest::NONE; sizes.outputs];
//! let mut outcomes = vec![Outcome::UNDEFINED; sizes.outputs];
//! let (mut seen, mut risks) = (vec![Seen::IDLE; sizes.channels], Window::IDLE);
//! let mut motors = [Motor::UNKNOWN; 4];
//! let memory = Memory::of(&plan, Parts {
//!     numbers: &mut numbers,
//!     partials: &mut partials,
//!     strongest: &mut strongest,
//!     outcomes: &mut outcomes,
//!     seen: &mut seen,
//!     risks: &mut risks,
//!     motors: &mut motors,
//! }).ok_or("another plan's memory")?;
//! let mut monitor = Monitor::new(&plan, memory)?;
//! let mut risk_pct = None;
//! for i in 0..2000 {
//!     let t_s = f64::from(i) * 0.02;
//!     let said = monitor.push(&Sample { t_s, motors: &[0.4, 0.5, 0.5, 0.4], in_air: true, signals: &[] });
//!     risk_pct = said.risk.ok().map(|estimate| estimate.risk_pct);
//! }
//! assert!(risk_pct < Some(25.0));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use fuzzy::table::{Broken, Outcome, Scratch, Table};

use crate::{
    channel::{Channel, Input, Observed, Seen},
    follower::{Follower, Room, Settings},
    gap::FilledKnots,
    lookup::Lookup,
    sample::{Estimate, Sample, Update},
    verdict::{Ended, Finding, Motor},
    window::Window,
};

pub use fuzzy::table;

mod storage;

pub use storage::{Parts, Sizes, Storage};

/// A profile and its rule set, compiled, as plain data.
#[derive(Debug, Clone, Copy)]
pub struct Plan<'a> {
    /// The name of the profile.
    pub name: &'a str,
    /// The rule set.
    pub table: Table<'a>,
    /// Which of its outputs is the risk.
    pub output: u32,
    /// Which input of the profile each input of the rule set is.
    pub order: &'a [u32],
    /// What is observed.
    pub channels: &'a [Channel],
    /// The inputs of the profile.
    pub inputs: &'a [Input],
    /// How many signals samples carry beside the motors.
    pub signals: u32,
    /// What the profile says about time.
    pub settings: Settings,
    /// The coverage below which rules do not apply.
    pub coverage_below: f64,
    /// What fills the gaps of the rules; `None` where there is nothing to fill them from.
    pub filled: Option<FilledKnots<'a>>,
}

/// Why there is no monitor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Refused {
    /// The memory is not of the sizes that the plan needs.
    Memory,
    /// There is no motor to watch.
    NoMotors,
    /// The plan is damaged.
    Plan(Broken),
}

impl core::fmt::Display for Refused {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Refused::Memory => f.write_str("the memory is not of the sizes that the plan needs"),
            Refused::NoMotors => f.write_str("there is no motor to watch"),
            Refused::Plan(broken) => broken.fmt(f),
        }
    }
}

impl core::error::Error for Refused {}

/// Memory for a monitor, of the sizes that its plan needs. [`Storage`] has it as a value of its own.
#[derive(Debug)]
pub struct Memory<'m> {
    /// For evaluations of the rule set.
    pub scratch: Scratch<'m>,
    /// One for each output of the rule set.
    pub outcomes: &'m mut [Outcome],
    /// One for each input of the rule set.
    pub point: &'m mut [f64],
    /// One for each input of the profile.
    pub inputs: &'m mut [f64],
    /// One for each channel.
    pub seen: &'m mut [Seen],
    /// For the risks of the last seconds.
    pub risks: &'m mut Window,
    /// One for each motor.
    pub motors: &'m mut [Motor],
}

impl Plan<'_> {
    /// Whether the plan is whole: then no sample makes a monitor panic. Exported plans are.
    ///
    /// # Errors
    /// What points beyond what it points into.
    pub fn check(&self) -> Result<(), Broken> {
        self.table.check()?;
        let holds = |holds: bool, array| holds.then_some(()).ok_or(Broken(array));
        let inputs = self.inputs.len();
        holds((self.output as usize) < self.table.outputs.len(), "output")?;
        holds(
            self.order.len() == self.table.inputs.len()
                && self.order.iter().all(|input| (*input as usize) < inputs),
            "order of inputs",
        )?;
        holds(
            self.inputs
                .iter()
                .all(|input| input.channel < self.channels.len()),
            "inputs of the profile",
        )?;
        holds(
            self.channels.iter().all(|channel| match channel.observed {
                Observed::Named(signal) => signal < self.signals as usize,
                _ => true,
            }),
            "channels",
        )?;
        holds(
            self.filled
                .is_none_or(|filled| filled.is_whole(self.table.inputs.len())),
            "filling",
        )
    }

    fn estimate(
        &self,
        inputs: &[f64],
        point: &mut [f64],
        (scratch, outcomes): (&mut Scratch<'_>, &mut [Outcome]),
    ) -> Option<Estimate> {
        let lookup = Lookup {
            order: self.order,
            coverage_below: self.coverage_below,
            filled: self.filled,
        };
        lookup.estimate(inputs, point, |point| {
            self.table.evaluate(scratch, point, outcomes);
            outcomes.get(self.output as usize).copied()
        })
    }

    /// Whether memory has the sizes of the plan.
    fn fits(&self, memory: &Memory<'_>) -> bool {
        let inputs = self.table.inputs.len();
        self.table.fits(&memory.scratch)
            && memory.outcomes.len() == self.table.outputs.len()
            && memory.point.len() == inputs
            && memory.inputs.len() == self.inputs.len()
            && memory.seen.len() == self.channels.len()
    }
}

/// Follows one flight, sample by sample, in memory that is lent to it.
///
/// It allocates nothing, and a sample costs the same whatever the lengths of the windows. A flight stack that has no
/// static place for a monitor can keep one as a local variable: it is a few hundred bytes, the rest is in the memory.
#[derive(Debug)]
pub struct Monitor<'a> {
    plan: &'a Plan<'a>,
    memory: Memory<'a>,
    follower: Follower,
}

impl<'a> Monitor<'a> {
    /// A monitor of a new flight, of as many motors as the memory has places for. [`Storage::monitor`] is the short way.
    ///
    /// # Errors
    /// The memory is not of the plan's sizes, there is no motor, or the plan is damaged.
    pub fn new(plan: &'a Plan<'a>, memory: Memory<'a>) -> Result<Monitor<'a>, Refused> {
        plan.check().map_err(Refused::Plan)?;
        if !plan.fits(&memory) {
            return Err(Refused::Memory);
        }
        if memory.motors.is_empty() {
            return Err(Refused::NoMotors);
        }
        for (seen, channel) in memory.seen.iter_mut().zip(plan.channels) {
            seen.restart(channel.window_s);
        }
        memory.risks.restart(plan.settings.elevated_risk.window_s);
        memory.motors.fill(Motor::UNKNOWN);
        memory.inputs.fill(f64::NAN);
        Ok(Monitor {
            plan,
            memory,
            follower: Follower::new(plan.settings),
        })
    }

    /// Takes a sample in.
    pub fn push(&mut self, sample: &Sample<'_>) -> Update {
        let Memory {
            scratch,
            outcomes,
            point,
            inputs,
            seen,
            risks,
            motors,
        } = &mut self.memory;
        let plan = self.plan;
        let mut room = Room {
            risks,
            seen,
            inputs,
            motors,
        };
        self.follower
            .push((plan.channels, plan.inputs), &mut room, sample, |inputs| {
                plan.estimate(inputs, point, (scratch, outcomes))
            })
    }

    /// The risk at values of the inputs, in the order of the profile, whatever was flown: what it says at such a moment.
    /// `None` where rules say nothing and there is nothing to fill from, or a value is not finite.
    pub fn at(&mut self, inputs: &[f64]) -> Option<Estimate> {
        let Memory {
            scratch,
            outcomes,
            point,
            ..
        } = &mut self.memory;
        self.plan.estimate(inputs, point, (scratch, outcomes))
    }

    /// The values of the inputs after the latest sample, in the order of the profile; NaN is unknown.
    pub fn inputs(&self) -> &[f64] {
        self.memory.inputs
    }

    /// The finding that the level rests on, as it stands so far; `None` while the level is good.
    pub fn open_finding(&self) -> Option<Finding> {
        self.follower.open_finding(self.memory.motors)
    }

    /// Ends the flight: the findings that were still open.
    pub fn finish(&mut self) -> Ended {
        let Memory {
            inputs,
            seen,
            risks,
            motors,
            ..
        } = &mut self.memory;
        self.follower.finish(&mut Room {
            risks,
            seen,
            inputs,
            motors,
        })
    }
}
