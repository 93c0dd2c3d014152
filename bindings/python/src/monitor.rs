//! A monitor that follows a flight sample by sample.

use std::{
    borrow::Cow,
    sync::{Arc, Mutex, MutexGuard, PoisonError},
};

use flagred::{
    flight::Assessor,
    monitor::{Craft, Sample, Update as MonitorUpdate, counted},
};
use flagred_report::{document::FindingDocument, finding::FindingContext};
use pyo3::prelude::*;
use serde_json::json;

use crate::{
    assessment::{json_text, steps},
    errors::data_error,
    profile::Profile,
    table::Table,
};
use flagred::loaded::Loaded;

/// The state of a monitor after a sample.
#[pyclass(frozen, get_all, module = "flagred.types")]
pub(crate) struct Update {
    /// The time of the sample in seconds.
    t_s: f64,
    /// The risk in %, from 0 to 100; None if it is unknown.
    risk: Option<f64>,
    /// The reason why the risk is unknown; None if it is known.
    unknown: Option<String>,
    /// The elevated risk in %; None if the risk is unknown.
    elevated_risk: Option<f64>,
    /// ``GOOD``, ``INFO``, ``WARN`` or ``FAIL``; None on the ground and while a risk is unknown, unless an alarm is raised.
    level: Option<String>,
    /// The new level if this sample changed it; None otherwise, or if the new level is unknown.
    change: Option<String>,
    /// The largest firing strength of a rule, in [0, 1].
    coverage: Option<f64>,
    /// Whether the risk is interpolated because no rule fires.
    filled: Option<bool>,
    /// The rule number with the largest firing strength, from 1; None if no rule fires or the risk is unknown.
    dominant_rule: Option<usize>,
    /// Whether the risk counts for levels and findings.
    judged: bool,
}

#[pymethods]
impl Update {
    fn __repr__(&self) -> String {
        let risk = match (&self.risk, &self.unknown) {
            (Some(risk), _) => format!("risk={risk:.1} %"),
            (None, why) => format!("unknown='{}'", why.as_deref().unwrap_or_default()),
        };
        let level = self.level.as_deref().unwrap_or("None");
        format!("Update(t_s={}, {risk}, level={level})", self.t_s)
    }
}

/// Follows a flight sample by sample, inside `flagred.Monitor`.
#[pyclass(frozen, subclass, module = "flagred._core")]
pub(crate) struct MonitorData {
    loaded: Arc<Loaded>,
    signals: Vec<String>,
    /// Created with the first sample, which determines the number of motors.
    state: Mutex<Option<MonitorState>>,
    step_s: Option<f64>,
}

struct MonitorState {
    assessor: Assessor,
    motors: usize,
}

/// Replaces Python's `None` by NaN. Both mean that a value is unknown.
fn numbers(values: &[Option<f64>]) -> Vec<f64> {
    values
        .iter()
        .map(|value| value.unwrap_or(f64::NAN))
        .collect()
}

impl MonitorData {
    fn state(&self) -> MutexGuard<'_, Option<MonitorState>> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn finding_context(&self) -> FindingContext<'_> {
        FindingContext {
            estimator: &self.loaded.estimator,
            motors: &[],
        }
    }

    fn begin(&self, motors: usize) -> PyResult<MonitorState> {
        let signals: Vec<&str> = self.signals.iter().map(String::as_str).collect();
        let craft = Craft::new(motors).with_signals(&signals);
        let assessor = Assessor::new(&self.loaded.estimator, craft, self.step_s);
        let assessor = assessor.map_err(|error| data_error(error, None))?;
        Ok(MonitorState { assessor, motors })
    }
}

#[pymethods]
impl MonitorData {
    #[new]
    #[pyo3(signature = (profile, signals = None, step_s = None))]
    fn new(profile: &Profile, signals: Option<Vec<String>>, step_s: Option<f64>) -> Self {
        MonitorData {
            loaded: Arc::clone(&profile.loaded),
            signals: signals.unwrap_or_default(),
            state: Mutex::new(None),
            step_s,
        }
    }

    fn _push(
        &self,
        t_s: f64,
        commands: Vec<Option<f64>>,
        in_air: Option<bool>,
        signals: Vec<Option<f64>>,
    ) -> PyResult<Update> {
        let commands = numbers(&commands);
        let signals = numbers(&signals);
        // A command that is not a fraction from 0 to 1 is refused before the sample is processed: its unit is
        // probably wrong, and then all commands of the flight are wrong.
        if let Some(motor) = commands
            .iter()
            .position(|e| counted(*e).is_nan() && !e.is_nan())
        {
            return Err(data_error(
                format!(
                    "the command of motor {} is `{}`, but a command is a fraction from 0 to 1",
                    motor + 1,
                    commands[motor]
                ),
                Some("scale it: 0 is the lower limit of the motor, 1 the upper limit".to_owned()),
            ));
        }
        let mut state = self.state();
        let state = match &mut *state {
            Some(state) => state,
            none => none.insert(self.begin(commands.len())?),
        };
        for (what, expected, given) in [
            ("commands", state.motors, commands.len()),
            ("signals", self.signals.len(), signals.len()),
        ] {
            if expected != given {
                return Err(data_error(
                    format!("expected {expected} {what}, but {given} were given"),
                    None,
                ));
            }
        }
        let update = state.assessor.push(&Sample {
            t_s,
            motors: &commands,
            in_air,
            signals: &signals,
        });
        Ok(self.update(&update))
    }

    /// The findings that ended with the latest sample, in JSON.
    fn _ended(&self) -> String {
        let state = self.state();
        let ended = state
            .as_ref()
            .map_or(&[][..], |state| state.assessor.ended());
        let ended: Vec<_> = ended
            .iter()
            .map(|f| FindingDocument::new(f, self.finding_context()))
            .collect();
        json!(ended).to_string()
    }

    /// The number of motors and the state of the flight as bytes, as they are pickled; None without a sample.
    fn _state(&self) -> Option<(usize, Cow<'static, [u8]>)> {
        let state = self.state();
        let state = state.as_ref()?;
        Some((state.motors, Cow::Owned(state.assessor.state())))
    }

    /// Continues the flight of another monitor.
    fn _restore(&self, motors: usize, bytes: &[u8]) -> PyResult<()> {
        let MonitorState { assessor, motors } = self.begin(motors)?;
        let assessor = assessor.restore(bytes);
        let assessor = assessor.map_err(|error| data_error(error, None))?;
        *self.state() = Some(MonitorState { assessor, motors });
        Ok(())
    }

    /// Ends the flight and returns its assessment in JSON, and its steps; None without a sample.
    fn _finish(&self) -> PyResult<Option<(String, Table)>> {
        let Some(mut state) = self.state().take() else {
            return Ok(None);
        };
        let assessed = state.assessor.finish();
        Ok(Some((
            json_text(&assessed, self.finding_context()),
            steps(&assessed)?,
        )))
    }
}

impl MonitorData {
    fn update(&self, update: &MonitorUpdate) -> Update {
        let risk = update.risk.as_ref();
        let estimate = risk.ok();
        let profile = self.loaded.estimator.profile();
        Update {
            t_s: update.t_s,
            risk: estimate.map(|estimate| estimate.risk_pct),
            unknown: risk.err().map(|why| why.explain(profile)),
            elevated_risk: update.elevated_risk_pct,
            level: update.level.map(|level| level.to_string()),
            change: update.change.map(|level| level.to_string()),
            coverage: estimate.map(|estimate| estimate.coverage),
            filled: estimate.map(|estimate| estimate.filled_from.is_some()),
            dominant_rule: estimate.and_then(|estimate| Some(estimate.dominant_rule? + 1)),
            judged: update.judged,
        }
    }
}
