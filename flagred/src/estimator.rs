//! From input values to a risk: the engine where rules apply, the filled map where none does.

use alloc::{string::String, vec, vec::Vec};

use fuzzy::{
    Engine, Model,
    engine::{CompileError, EvaluateError, Outcome, Scratch},
    map::{Axis, DecisionMap, Grid, GridError},
    scale::Scale,
    table::Set,
};

use crate::{
    board::Plan,
    channel::{Channel, Input},
    gap::{FilledCells, FilledMap, Run},
    lookup::Lookup,
    profile::Profile,
    source::channels,
};

pub use crate::assessment::Estimate;

/// The most cells a map has that is made to fill gaps; the more inputs, the fewer points along each.
const MAP_CELLS: usize = 100_000;

/// A profile and its rule set, compiled: immutable, and shared by any number of monitors.
#[derive(Debug, Clone)]
pub struct Estimator {
    profile: Profile,
    engine: Engine,
    output: usize,
    coverage_below: f64,
    /// `None` where no gap is in reach: every cell is covered, or there is nothing to fill one from.
    filled: Option<Filled>,
    /// Which input of the profile each input of the model is.
    order: Vec<u32>,
    /// What is observed, where samples carry the signals of the profile in its order.
    channels: Vec<Channel>,
    inputs: Vec<Input>,
}

/// The filled cells of the map.
#[derive(Debug, Clone)]
struct Filled {
    scales: Vec<Scale>,
    runs: Vec<Run>,
    values: Vec<f64>,
    distances: Vec<f32>,
}

/// Why a profile and a rule set make no estimator.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum EstimatorError {
    /// The rule set itself does not compile.
    #[error("the rule set cannot be used: {0}")]
    Rules(#[from] CompileError),
    /// It has too many inputs for a map that fills gaps.
    #[error("the map of the rule set cannot be laid: {0}")]
    Map(#[from] GridError),
    /// The map that fills gaps could not be evaluated.
    #[error("the rule set cannot be evaluated everywhere: {0}")]
    Evaluate(#[from] EvaluateError),
    /// The rule set has an input that the profile does not feed.
    #[error("the profile does not say where input `{input}` of the rule set comes from")]
    NoSource {
        /// The input.
        input: String,
    },
    /// The profile feeds an input that the rule set does not have.
    #[error("the rule set has no input `{input}`")]
    NoSuchInput {
        /// The input.
        input: String,
    },
    /// The rule set does not have the output that the profile takes as the risk.
    #[error("the rule set has no output `{output}`")]
    NoSuchOutput {
        /// The output.
        output: String,
    },
    /// The output is no percentage.
    #[error("output `{output}` goes from {low} to {high}, but a risk goes from 0 to 100 %")]
    NoPercentage {
        /// The output.
        output: String,
        /// The lower end of its range.
        low: f64,
        /// The upper end of its range.
        high: f64,
    },
}

/// The value of an output takes more than a table of numbers, so it cannot fly on board.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("the value of output `{output}` has no closed form, so it cannot be written as a table")]
pub struct NoClosedForm {
    /// The output.
    pub output: String,
}

impl NoClosedForm {
    /// What has one.
    pub fn help(&self) -> &'static str {
        "closed forms have: the centroid over straight terms that overlap only where one falls while the next one rises \
         (a `partition`), with minimum and maximum; the centroid with `implication: product` and `aggregation: sum`, over \
         any terms; the Takagi-Sugeno defuzzifiers. All of them without `samples`"
    }
}

impl Estimator {
    /// Compiles a rule set for a profile and fills the gaps of its map.
    ///
    /// # Errors
    ///
    /// Where the rule set does not compile, the two do not name the same inputs, or the output is no percentage.
    pub fn new(profile: &Profile, model: &Model) -> Result<Estimator, EstimatorError> {
        let engine = Engine::new(model)?;
        let output =
            engine
                .output(&profile.output)
                .ok_or_else(|| EstimatorError::NoSuchOutput {
                    output: profile.output.clone(),
                })?;
        if let Some(variable) = model.outputs.get(output).map(|o| &o.variable)
            && (variable.low < 0.0 || variable.high > 100.0)
        {
            return Err(EstimatorError::NoPercentage {
                output: profile.output.clone(),
                low: variable.low,
                high: variable.high,
            });
        }
        if let Some(stray) = profile
            .inputs
            .iter()
            .find(|i| engine.input(&i.name).is_none())
        {
            return Err(EstimatorError::NoSuchInput {
                input: stray.name.clone(),
            });
        }
        let order = model
            .inputs
            .iter()
            .map(|input| {
                let fed = profile.inputs.iter().position(|i| i.name == input.name);
                fed.map(|place| place as u32)
                    .ok_or_else(|| EstimatorError::NoSource {
                        input: input.name.clone(),
                    })
            })
            .collect::<Result<Vec<u32>, EstimatorError>>()?;
        let sources = profile.inputs.iter().map(|input| &input.source);
        let (channels, inputs) = channels(sources, &profile.signals())
            .map_err(|input| EstimatorError::NoSource { input })?;
        let coverage_below = profile.gap.coverage_below(model);
        let grid = Grid::new(&engine, points_along(model.inputs.len()))?;
        let map = DecisionMap::new(&engine, grid, output)?;
        let filled = FilledMap::new(map, coverage_below, profile.gap.method);
        Ok(Estimator {
            coverage_below,
            profile: profile.clone(),
            engine,
            output,
            filled: Filled::of(&filled),
            order,
            channels,
            inputs,
        })
    }

    /// The profile it was made of.
    pub fn profile(&self) -> &Profile {
        &self.profile
    }

    /// The compiled rule set.
    pub fn engine(&self) -> &Engine {
        &self.engine
    }

    /// The risk at the values of the inputs, in the order of the profile: what a monitor says at such a moment.
    /// `None` where rules say nothing and there is nothing to fill from, or a value is not finite.
    ///
    /// # Example: the corner of the paper's map that no rule covers
    ///
    /// ```
    /// use flagred::{estimator::Estimator, shipped};
    ///
    /// let profile = shipped::profile("flagred-paper").ok_or("not shipped")??;
    /// let rules = shipped::rule_set(&profile.rules).ok_or("not shipped")??;
    /// let estimator = Estimator::new(&profile, &rules)?;
    /// let saturated = estimator.at(&[0.0, 0.0]).ok_or("unknown")?;
    /// assert!(saturated.risk_pct > 75.0 && saturated.filled_from.is_some());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn at(&self, inputs: &[f64]) -> Option<Estimate> {
        self.estimate(inputs, &mut Memory::of(self))
    }

    /// As [`Estimator::at`], without allocating.
    pub(crate) fn estimate(&self, inputs: &[f64], memory: &mut Memory) -> Option<Estimate> {
        let Memory {
            scratch,
            point,
            corner,
            outcomes,
        } = memory;
        let rules = |point: &[f64]| match self.engine.evaluate_with(scratch, point, outcomes) {
            // Where the author calls it an error that no rule fires, the map can still fill the gap.
            Ok(()) | Err(EvaluateError::NoRuleFired { .. }) => outcomes.get(self.output).copied(),
            Err(_) => None,
        };
        self.lookup().estimate(inputs, (point, corner), rules)
    }

    /// The profile and its rule set as plain data, to fly on board; samples carry the signals of
    /// [`Profile::signals`], in that order.
    ///
    /// # Errors
    ///
    /// The output has no closed form.
    ///
    /// # Example: how much memory the paper's profile needs for four motors
    ///
    /// ```
    /// use flagred::{estimator::Estimator, shipped};
    ///
    /// let profile = shipped::profile("flagred-paper").ok_or("not shipped")??;
    /// let rules = shipped::rule_set(&profile.rules).ok_or("not shipped")??;
    /// let estimator = Estimator::new(&profile, &rules)?;
    /// let plan = estimator.plan()?;
    /// assert_eq!(plan.check(), Ok(()));
    /// assert_eq!((plan.sizes().channels, plan.sizes().outputs), (2, 1));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn plan(&self) -> Result<Plan<'_>, NoClosedForm> {
        let table = self.engine.table();
        let open = |output: &fuzzy::table::Output| output.set == Set::OPEN;
        if table.outputs.get(self.output).is_none_or(open) {
            return Err(NoClosedForm {
                output: self.profile.output.clone(),
            });
        }
        Ok(Plan {
            name: &self.profile.name,
            table,
            output: self.output as u32,
            order: &self.order,
            channels: &self.channels,
            inputs: &self.inputs,
            signals: self.profile.signals().len() as u32,
            settings: self.profile.settings(),
            coverage_below: self.coverage_below,
            filled: self.filled.as_ref().map(Filled::lend),
        })
    }

    fn lookup(&self) -> Lookup<'_> {
        Lookup {
            order: &self.order,
            coverage_below: self.coverage_below,
            filled: self.filled.as_ref().map(Filled::lend),
        }
    }
}

impl Filled {
    /// `None` where no cell was filled.
    fn of(map: &FilledMap) -> Option<Filled> {
        let grid = map.map().grid();
        let mut filled = Filled {
            scales: grid.axes().iter().map(Axis::scale).collect(),
            runs: vec![],
            values: vec![],
            distances: vec![],
        };
        for cell in (0..grid.cells()).filter(|cell| map.is_filled(*cell)) {
            let first = filled.values.len() as u32;
            match filled.runs.last_mut() {
                Some(run) if run.cell + (run.end - run.first) == cell as u32 => run.end += 1,
                _ => filled.runs.push(Run {
                    cell: cell as u32,
                    first,
                    end: first + 1,
                }),
            }
            filled.values.push(map.value(cell).unwrap_or(f64::NAN));
            filled.distances.push(map.distance(cell) as f32);
        }
        filled
            .values
            .iter()
            .any(|value| !value.is_nan())
            .then_some(filled)
    }

    fn lend(&self) -> FilledCells<'_> {
        FilledCells {
            scales: &self.scales,
            runs: &self.runs,
            values: &self.values,
            distances: &self.distances,
        }
    }
}

/// How many points the map that fills gaps has along each of so many inputs: 51, or fewer so that there are not more
/// than 100,000 in all, but at least 3.
pub fn points_along(inputs: usize) -> usize {
    let most = libm::pow(MAP_CELLS as f64, 1.0 / inputs.max(1) as f64);
    (most as usize).clamp(3, 51)
}

/// What an estimate needs beside the estimator: allocated once, used for every sample.
#[derive(Debug, Clone)]
pub(crate) struct Memory {
    scratch: Scratch,
    /// The inputs in the order of the model, and room for others.
    point: Vec<f64>,
    corner: Vec<f64>,
    outcomes: Vec<Outcome>,
}

impl Memory {
    pub(crate) fn of(estimator: &Estimator) -> Memory {
        let inputs = estimator.order.len();
        Memory {
            scratch: estimator.engine.scratch(),
            point: vec![0.0; inputs],
            corner: vec![0.0; inputs],
            outcomes: vec![Outcome::default(); estimator.engine.output_names().len()],
        }
    }
}
