//! A monitor for flight controllers, in memory that the caller provides. It needs neither an allocator nor a standard
//! library.
//!
//! `flagred export --rust` writes a profile and its rule set as a [`Plan`] of plain data, and the type of the [`Storage`] that
//! its [`Monitor`] needs. On a computer, [`Estimator::plan`](crate::estimator::Estimator::plan) creates the plan and
//! `OwnedMemory` allocates. The results are bit for bit those of
//! [`flagred::monitor::Monitor`](crate::monitor::Monitor).
//!
//! # Example: a flight with a plan created on a computer
//!
//! ```
//! use flagred::{board::OwnedMemory, sample::Sample, shipped};
//!
//! let estimator = shipped::flagred();
//! let plan = estimator.plan()?;
//!
//! let mut memory = OwnedMemory::new(&plan, 4);
//! let mut monitor = memory.monitor(&plan)?;
//! let mut risk_pct = None;
//! for i in 0..2000 {
//!     let t_s = f64::from(i) * 0.02;
//!     let update = monitor.push(&Sample { t_s, motors: &[0.4, 0.5, 0.5, 0.4], in_air: Some(true), signals: &[] });
//!     risk_pct = update.risk.ok().map(|estimate| estimate.risk_pct);
//! }
//! assert!(risk_pct < Some(25.0));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use fuzzy::table::{DamagedArray, StageRuleCriterion};

use crate::{
    cause::{Cause, Propositions, RuleQuery},
    channel::{Channel, ChannelState, Input, Observed, motors_needed, restart},
    effort::ROLL_PITCH_YAW_THRUST,
    follower::{Feed, FlightMemory, Follower, Settings},
    gap::FilledKnots,
    lookup::{Lookup, UNREAD},
    motor,
    sample::{Estimate, Sample, Update},
    verdict::{EndedFindings, Finding, Motor},
    window::Window,
};

pub use crate::{cause::Proposition, effort::Factors};
pub use fuzzy::table;

mod rules;
mod storage;

pub use rules::Rules;
use rules::take;
#[doc(hidden)] // For the C interface.
pub use rules::{Evaluator, RuleMemory};
#[cfg(feature = "std")]
pub use storage::OwnedMemory;
pub use storage::{Memory, Sizes, Storage};

/// A compiled profile and rule set, as plain data.
#[derive(Debug, Clone, Copy)]
pub struct Plan<'a> {
    /// The name of the profile.
    pub name: &'a str,
    /// The rule set.
    pub rules: Rules<'a>,
    /// The index of the output that is the risk, among the outputs of the rule set.
    pub output: u32,
    /// For each input of the rule set, its index among the inputs of the profile; `u32::MAX` for an input that the risk
    /// does not depend on.
    pub order: &'a [u32],
    /// The channels that are observed.
    pub channels: &'a [Channel],
    /// The inputs of the profile.
    pub inputs: &'a [Input],
    /// The number of signals in a sample.
    pub signals: u32,
    /// The time constants and thresholds of the profile.
    pub settings: Settings,
    /// The coverage below which the rules do not apply and the risk is interpolated.
    pub coverage_below: f64,
    /// The values that fill gaps of the rules; `None` if nothing is filled.
    pub filled: Option<FilledKnots<'a>>,
    /// The propositions of all rules, grouped by rule. Within each rule, the most specific proposition comes first.
    pub propositions: &'a [Proposition],
}

/// The words of a finding for the pilot. An exported profile contains two arrays of them: `CAUSES`, indexed by
/// [`Cause::proposition`], and `NOTICES`, indexed by [`Finding::measure`](crate::verdict::Finding::measure) for
/// findings without a cause. Placeholders in braces are to be replaced: `{value}` by [`Cause::value`], `{percent}` by
/// 100 times that value, `{peak}` and `{threshold}` by the values of the finding, `{motor}` by its motor, and `{side}`
/// by `above` or `below`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Words<'a> {
    /// A stable identifier for use by programs: lower-case letters, digits and `_`.
    pub code: &'a str,
    /// A few words, for messages limited to 50 characters.
    pub brief: &'a str,
    /// What happened, and what it means.
    pub text: &'a str,
    /// What to do.
    pub advice: &'a str,
}

/// The reason why a monitor cannot be created.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum SetupError {
    /// The memory does not have the sizes that the plan requires.
    Memory,
    /// The profile reads a motor that the vehicle does not have.
    NoMotors,
    /// The plan is damaged.
    Plan(DamagedArray),
    /// The geometry does not have factors for every motor, or its factors do not separate roll, pitch, yaw and thrust.
    Geometry,
}

impl core::fmt::Display for SetupError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            SetupError::Memory => f.write_str("the memory has other sizes than the plan requires"),
            SetupError::NoMotors => {
                f.write_str("the profile reads a motor that the vehicle does not have")
            }
            SetupError::Plan(damaged) => damaged.fmt(f),
            SetupError::Geometry => f.write_str(
                "the factors of the motors do not separate roll, pitch, yaw and thrust, or a motor has none",
            ),
        }
    }
}

impl core::error::Error for SetupError {}

impl Plan<'_> {
    /// Verifies every index and window of the plan, so that no sample can make a monitor panic. Exported plans pass.
    ///
    /// # Errors
    /// Returns the first array that has an index out of bounds or a window of zero length.
    pub fn check(&self) -> Result<(), DamagedArray> {
        self.rules.check()?;
        let require = |holds: bool, array| holds.then_some(()).ok_or(DamagedArray(array));
        let inputs = self.inputs.len();
        require(
            (self.output as usize) < self.rules.table.outputs.len(),
            "output",
        )?;
        require(
            self.order.len() == self.rules.inputs()
                && self
                    .order
                    .iter()
                    .all(|input| *input == UNREAD || (*input as usize) < inputs),
            "order",
        )?;
        require(
            self.inputs.iter().all(|input| {
                let channel = self.channels.get(input.channel);
                channel.is_some_and(|channel| {
                    channel.in_bins == input.statistic.uses_bins()
                        && (!channel.exponential || input.statistic.supports_exponential())
                }) && input.others().all(|other| {
                    let other = self.inputs.get(other);
                    other.is_some_and(|other| other.ratio.is_none())
                }) && input.ratio.is_none_or(|ratio| is_above_0(ratio.at_least))
                    && input.if_missing.is_none_or(f64::is_finite)
            }),
            "inputs of the profile",
        )?;
        require(
            self.channels.iter().all(|channel| {
                let is_signal = |signal: usize| signal < self.signals as usize;
                let is_known = match channel.observed {
                    Observed::Effort(axis) => axis < ROLL_PITCH_YAW_THRUST,
                    Observed::Ratio { unknown_below, .. } => unknown_below.is_finite(),
                    _ => true,
                };
                is_known
                    && channel.observed.signals().all(is_signal)
                    && is_above_0(channel.window_s)
            }),
            "channels",
        )?;
        require(is_above_0(self.settings.elevated_risk.window_s), "settings")?;
        require(
            self.propositions.iter().all(|antecedent| {
                (antecedent.input as usize) < inputs.saturating_add(self.read_outputs())
            }),
            "propositions",
        )?;
        require(
            self.filled
                .is_none_or(|filled| filled.is_whole(self.order.len())),
            "filled",
        )
    }

    /// Whether the risk depends on the input of the profile with this index.
    pub fn needs(&self, input: usize) -> bool {
        self.feed().needs(input)
    }

    /// Whether the risk depends on an input that reads the commands of the motors.
    pub fn needs_motors(&self) -> bool {
        self.feed().needs_motors()
    }

    const fn feed(&self) -> Feed<'_> {
        Feed {
            channels: self.channels,
            inputs: self.inputs,
            order: self.order,
        }
    }

    /// The number of outputs that rules read: all outputs if there are stages, otherwise 0.
    const fn read_outputs(&self) -> usize {
        match self.rules.stages {
            [] => 0,
            _ => self.rules.table.outputs.len(),
        }
    }

    fn estimate(
        &self,
        inputs: &[f64],
        point: &mut [f64],
        rules: &mut Evaluator<'_>,
    ) -> Option<Estimate> {
        self.lookup().estimate(inputs, point, |point| {
            rules.evaluate(point)?.get(self.output as usize).copied()
        })
    }

    /// The cause of the risk. `rules` must have been evaluated at the same inputs.
    fn cause(
        &self,
        inputs: &[f64],
        risk_pct: f64,
        point: &mut [f64],
        rules: &mut Evaluator<'_>,
    ) -> Option<Cause> {
        self.lookup().reorder(inputs, point)?;
        let Evaluator {
            scratch,
            values,
            outcomes,
            ..
        } = rules;
        let propositions = Propositions {
            all: self.propositions,
        };
        let risk = (self.output as usize, risk_pct);
        let table = &self.rules.table;
        let outputs = table.outputs.len();
        let Some(chain) = self.rules.chain() else {
            return propositions.cause(inputs, risk, outputs, |output, requested, pick| {
                match requested {
                    RuleQuery::Raises(value) => {
                        let rule = table.raised_by(scratch, point, output, value)?;
                        pick(rule, scratch.degrees)
                    }
                    RuleQuery::Concludes(_) => None,
                }
            });
        };
        let is_read = |antecedent: &&Proposition| antecedent.input as usize >= inputs.len();
        let cause = propositions.cause(inputs, risk, outputs, |output, requested, pick| {
            let sought = match requested {
                RuleQuery::Raises(value) => StageRuleCriterion::Raises(value),
                RuleQuery::Concludes(proposition) => {
                    let before = self.propositions.get(..proposition)?;
                    StageRuleCriterion::Concludes(before.iter().filter(is_read).count())
                }
            };
            let given = (&*point, &**outcomes);
            chain.rule_of(scratch, values, given, (output, sought), pick)
        })?;
        let rule = chain.rule(cause.rule)?;
        Some(Cause { rule, ..cause })
    }

    fn lookup(&self) -> Lookup<'_> {
        Lookup {
            order: self.order,
            coverage_below: self.coverage_below,
            filled: self.filled,
        }
    }
}

/// Assesses one flight, sample by sample, in memory that the caller provides.
///
/// It does not allocate, and the cost of a sample does not depend on the lengths of the windows. The monitor itself is about
/// 1600 bytes and can be a local variable.
#[derive(Debug)]
pub struct Monitor<'a> {
    plan: &'a Plan<'a>,
    follower: Follower,
    rules: Evaluator<'a>,
    /// The values of the inputs of the rule set.
    point: &'a mut [f64],
    /// The values of the inputs of the profile.
    inputs: &'a mut [f64],
    seen: &'a mut [ChannelState],
    risks: &'a mut Window,
    motors: &'a mut [Motor],
}

impl<'a> Monitor<'a> {
    /// Creates a monitor of a new flight. The memory determines the number of motors, which may be 0 if the profile
    /// reads no motors.
    ///
    /// # Errors
    /// If the memory does not have the sizes that the plan requires, if motors are missing, or if the plan is damaged.
    #[doc(hidden)] // For the C interface. Rust uses `Storage::monitor` or `OwnedMemory::monitor`.
    pub fn new(plan: &'a Plan<'a>, memory: Memory<'a>) -> Result<Monitor<'a>, SetupError> {
        plan.check().map_err(SetupError::Plan)?;
        if memory.motors.len() < motors_needed(plan.channels, plan.settings.verdict.notices.any()) {
            return Err(SetupError::NoMotors);
        }
        let monitor = Monitor::divide(plan, memory).ok_or(SetupError::Memory)?;
        restart(plan.channels, monitor.seen);
        let window_s = plan.settings.elevated_risk.window_s;
        monitor.risks.restart(window_s);
        monitor.motors.fill(Motor::UNKNOWN);
        monitor.inputs.fill(f64::NAN);
        for (value, input) in monitor.point.iter_mut().zip(plan.rules.table.inputs) {
            *value = input.low;
        }
        Ok(monitor)
    }

    /// Divides the memory into its parts; `None` if it does not have the sizes that the plan requires.
    fn divide(plan: &'a Plan<'a>, memory: Memory<'a>) -> Option<Monitor<'a>> {
        let Memory {
            mut numbers,
            partials,
            strongest,
            outcomes,
            own,
            seen,
            risks,
            motors,
        } = memory;
        let memory = RuleMemory {
            numbers: take(&mut numbers, plan.rules.numbers())?,
            partials,
            strongest,
            outcomes,
            own,
        };
        let fits = seen.len() == plan.channels.len();
        let monitor = Monitor {
            plan,
            follower: Follower::new(plan.settings),
            rules: Evaluator::new(&plan.rules, memory)?,
            point: take(&mut numbers, plan.order.len())?,
            inputs: take(&mut numbers, plan.inputs.len())?,
            seen,
            risks,
            motors,
        };
        (fits && numbers.is_empty()).then_some(monitor)
    }

    /// Sets the factors of each motor, in the order of the samples, so that yaw commands are separated from the rest.
    /// Call it before the first sample.
    ///
    /// # Errors
    /// If a motor has no factors, or if the factors do not separate roll, pitch, yaw and thrust. Nothing changes then.
    ///
    /// # Example: a quadrotor with motors in an X
    /// ```
    /// use flagred::{board::OwnedMemory, shipped};
    ///
    /// let estimator = shipped::flagred();
    /// let plan = estimator.plan()?;
    /// let mut memory = OwnedMemory::new(&plan, 4);
    /// let mut monitor = memory.monitor(&plan)?;
    /// // Front right, rear left, front left, rear right; the first two turn counter-clockwise.
    /// monitor.set_geometry(&[[-1.0, 1.0, 1.0], [1.0, -1.0, 1.0], [1.0, 1.0, -1.0], [-1.0, -1.0, -1.0]])?;
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn set_geometry(&mut self, factors: &[Factors]) -> Result<(), SetupError> {
        let is_known = motor::set_geometry(self.motors, factors);
        is_known.then_some(()).ok_or(SetupError::Geometry)
    }

    /// Processes the next sample of the flight.
    pub fn push(&mut self, sample: &Sample<'_>) -> Update {
        let plan = self.plan;
        let mut room = FlightMemory {
            risks: self.risks,
            seen: self.seen,
            inputs: self.inputs,
            motors: self.motors,
        };
        let point = &mut *self.point;
        let rules = &mut self.rules;
        let estimate = |inputs: &[f64]| plan.estimate(inputs, point, rules);
        let feed = plan.feed();
        let update = self.follower.push(feed, &mut room, sample, estimate);
        self.follower.explain(feed, &update, |risk_pct| {
            plan.cause(self.inputs, risk_pct, self.point, &mut self.rules)
        });
        update
    }

    /// The risk for given values of the inputs, in the order of the profile, independent of the flight. `None` if no
    /// rule fires and the gap is not filled, or if a value is not finite.
    pub fn at(&mut self, inputs: &[f64]) -> Option<Estimate> {
        self.plan.estimate(inputs, self.point, &mut self.rules)
    }

    /// The cause of the risk for given values of the inputs, in the order of the profile, independent of the flight.
    /// `None` if no rule raises the risk.
    pub fn cause_at(&mut self, inputs: &[f64]) -> Option<Cause> {
        let antecedent = self
            .at(inputs)
            .filter(|antecedent| antecedent.filled_from.is_none())?;
        self.plan
            .cause(inputs, antecedent.risk_pct, self.point, &mut self.rules)
    }

    /// The values of the inputs after the last sample, in the order of the profile; NaN is unknown.
    pub fn inputs(&self) -> &[f64] {
        self.inputs
    }

    /// The open finding of the current level; `None` while the level is good.
    pub fn open_finding(&self) -> Option<Finding> {
        self.follower.open_finding()
    }

    /// Ends the flight and returns the findings that were still open.
    pub fn finish(&mut self) -> EndedFindings {
        self.follower.finish(&mut FlightMemory {
            risks: self.risks,
            seen: self.seen,
            inputs: self.inputs,
            motors: self.motors,
        })
    }
}

/// Whether a number is valid as the length of a window or the minimum of a divisor: finite and above 0.
fn is_above_0(number: f64) -> bool {
    number.is_finite() && number > 0.0
}
