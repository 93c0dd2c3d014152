//! Evaluation by the names of inputs and outputs.

use alloc::{collections::BTreeMap, string::String, sync::Arc, vec, vec::Vec};

use super::{Engine, EvaluateError, Outcome};
#[cfg(feature = "serde")]
use crate::fields::Fields;

impl Engine {
    /// Evaluates values by the names of the inputs, in any order, and gives outcomes by the names of the outputs.
    ///
    /// # Errors
    /// As [`Engine::evaluate`]; a name that is no input, an input without a value or with two.
    ///
    /// # Example
    /// ```
    /// use fuzzy::{Engine, Model};
    ///
    /// let model: Model = "
    /// fuzzy: 1
    /// name: fan
    /// inputs: {heat: {range: [0, 40], partition: [low, high]}, humidity: {range: [0, 100], partition: [dry, wet]}}
    /// outputs: {speed: {range: [0, 9], partition: [slow, fast]}}
    /// rules: [IF heat IS low THEN speed IS slow, IF heat IS high OR humidity IS wet THEN speed IS fast]
    /// ".parse()?;
    /// let engine = Engine::new(&model)?;
    /// let outcomes = engine.evaluate_named([("humidity", 80.0), ("heat", 30.0)])?;
    /// assert!(outcomes["speed"].value() > Some(4.5));
    /// assert_eq!(
    ///     engine.evaluate_named([("heat", 30.0)]).unwrap_err().to_string(),
    ///     "input `humidity` has no value"
    /// );
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn evaluate_named<'a>(
        &self,
        inputs: impl IntoIterator<Item = (&'a str, f64)>,
    ) -> Result<BTreeMap<&str, Outcome>, EvaluateError> {
        let mut values: Vec<Option<f64>> = vec![None; self.inputs.len()];
        for (name, value) in inputs {
            let known = self.inputs.iter().zip(&mut values);
            let mut named = known.filter(|(input, _)| *input.name == *name);
            let Some((input, slot)) = named.next() else {
                let name = String::from(name);
                return Err(EvaluateError::UnknownInput { name });
            };
            if slot.replace(value).is_some() {
                let name = Arc::clone(&input.name);
                return Err(EvaluateError::RepeatedInput { name });
            }
        }
        let value = |(input, value): (&super::Input, Option<f64>)| {
            let name = || Arc::clone(&input.name);
            value.ok_or_else(|| EvaluateError::MissingInput { name: name() })
        };
        let values: Vec<f64> = self
            .inputs
            .iter()
            .zip(values)
            .map(value)
            .collect::<Result<_, _>>()?;
        Ok(self.output_names().zip(self.evaluate(&values)?).collect())
    }

    /// [`Engine::evaluate_named`] of a struct or map of numbers: fields are inputs.
    ///
    /// # Errors
    /// As [`Engine::evaluate_named`]; and anything but a struct or map of numbers.
    ///
    /// # Example
    /// ```
    /// use fuzzy::{Engine, Model};
    ///
    /// #[derive(serde::Serialize)]
    /// struct Weather {
    ///     heat: f64,
    ///     humidity: u8,
    /// }
    ///
    /// let model: Model = "
    /// fuzzy: 1
    /// name: fan
    /// inputs: {heat: {range: [0, 40], partition: [low, high]}, humidity: {range: [0, 100], partition: [dry, wet]}}
    /// outputs: {speed: {range: [0, 9], partition: [slow, fast]}}
    /// rules: [IF heat IS low THEN speed IS slow, IF heat IS high OR humidity IS wet THEN speed IS fast]
    /// ".parse()?;
    /// let engine = Engine::new(&model)?;
    /// let outcomes = engine.evaluate_struct(&Weather { heat: 30.0, humidity: 80 })?;
    /// assert_eq!(serde_json::to_value(&outcomes)?["speed"]["state"], "defined");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[cfg(feature = "serde")]
    pub fn evaluate_struct<T: serde::Serialize + ?Sized>(
        &self,
        inputs: &T,
    ) -> Result<BTreeMap<&str, Outcome>, EvaluateError> {
        let fields = inputs.serialize(Fields::default());
        let fields = fields.map_err(|why| EvaluateError::NoFields { message: why.0 })?;
        self.evaluate_named(fields.iter().map(|(name, value)| (name.as_str(), *value)))
    }
}
