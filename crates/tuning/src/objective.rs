//! The objective: the loss of a model as a function of its free numbers.

use fuzzy::{Engine, Model, check, engine::Outcome};

use crate::{
    TuneError, consequents,
    data::Data,
    loss::{self, Slopes},
    parameters::Parameters,
    settings::Settings,
};

/// A loss on given rows, and the constraints that a model must satisfy.
pub(crate) struct Objective<'a> {
    data: &'a Data,
    settings: &'a Settings,
    /// The terms of a Takagi-Sugeno output that are fitted by least squares.
    fitted: Vec<usize>,
    target: usize,
    /// The claims of [`Settings::monotone`]; those that name no output apply to the tuned output.
    claims: Vec<check::Monotone>,
    low: f64,
    width: f64,
    truths: Vec<f64>,
}

/// A model with its predictions and loss.
#[derive(Debug, Clone)]
pub(crate) struct Point {
    pub(crate) model: Model,
    /// The predictions as positions in the range of the output; NaN without a value.
    pub(crate) predictions: Vec<f64>,
    pub(crate) slopes: Slopes,
}

impl<'a> Objective<'a> {
    pub(crate) fn new(
        model: &Model,
        parameters: &Parameters,
        data: &'a Data,
        settings: &'a Settings,
    ) -> Objective<'a> {
        let variable = model.outputs.get(parameters.target);
        let variable = variable.map(|output| &output.variable);
        let (low, high) = variable.map_or((0.0, 1.0), |variable| (variable.low, variable.high));
        let width = high - low;
        let truths = match settings.loss {
            crate::Loss::Squared => data
                .truths
                .iter()
                .map(|truth| (truth - low) / width)
                .collect(),
            _ => data.truths.clone(),
        };
        Objective {
            data,
            settings,
            fitted: parameters.fitted.clone(),
            target: parameters.target,
            claims: settings
                .monotone
                .iter()
                .map(|claim| check::Monotone {
                    output: claim.output.clone().or(variable.map(|v| v.name.clone())),
                    ..claim.clone()
                })
                .collect(),
            low,
            width,
            truths,
        }
    }

    /// Evaluates a model after fitting its consequents.
    pub(crate) fn fitted(&self, mut model: Model) -> Result<Point, TuneError> {
        if !self.fitted.is_empty() {
            let beyond_range = self.settings.beyond_range;
            consequents::fit(&mut model, &self.fitted, self.data, beyond_range)?;
        }
        self.point(model)
    }

    /// Evaluates a model without changes.
    pub(crate) fn point(&self, model: Model) -> Result<Point, TuneError> {
        let predictions = self.predictions(&Engine::new(&model)?)?;
        let slopes = loss::slopes(self.settings.loss, &predictions, &self.truths, self.data);
        Ok(Point {
            model,
            predictions,
            slopes,
        })
    }

    fn predictions(&self, engine: &Engine) -> Result<Vec<f64>, TuneError> {
        let outcomes = engine.evaluate_batch(&self.data.columns())?;
        let place = |outcome: &Outcome| {
            let value = outcome.value().map(|value| (value - self.low) / self.width);
            value.unwrap_or(f64::NAN)
        };
        let outputs = engine.output_names().len();
        let of_target = outcomes.iter().skip(self.target).step_by(outputs);
        Ok(of_target.map(place).collect())
    }

    /// The loss that is reported.
    pub(crate) fn measure(&self, point: &Point) -> f64 {
        self.measure_of(&point.predictions, self.data)
    }

    /// Converts predictions, which are positions in the range of the output, to values of the output.
    pub(crate) fn values(&self, predictions: &[f64]) -> Vec<f64> {
        let value = |prediction: &f64| self.low + prediction * self.width;
        predictions.iter().map(value).collect()
    }

    /// Returns the loss of other predictions for the same truths, with the weights of the rows in `data`.
    pub(crate) fn measure_of(&self, predictions: &[f64], data: &Data) -> f64 {
        let loss = self.settings.loss;
        loss::measure(loss, predictions, &self.truths, data, self.width)
    }

    /// The first claim of [`Settings::monotone`] that a model violates.
    pub(crate) fn broken_claim(&self, model: &Model) -> Result<Option<check::Monotone>, TuneError> {
        if self.claims.is_empty() {
            return Ok(None);
        }
        let engine = Engine::new(model)?;
        let found =
            check::counterexamples(&engine, &self.claims).map_err(|wrong| TuneError::Claim {
                message: wrong.message.clone(),
            })?;
        Ok(found.into_iter().next().map(|found| found.claim))
    }
}
