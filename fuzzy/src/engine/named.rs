//! Evaluation by the names of inputs and outputs.

use alloc::{string::String, sync::Arc};
use core::ops::Index;

use smallvec::{SmallVec, smallvec};

use super::{Engine, EvaluateError, Explanation, NamedOutput, Outcome, Outcomes};
#[cfg(feature = "serde")]
use crate::fields::Fields;

/// The outcomes of an evaluation with the names of their outputs, in the order of the model. They can be indexed by
/// name, as in `outcomes["speed"]`. This panics if there is no output with the name; [`NamedOutcomes::get`] returns
/// `None` instead.
#[derive(Clone)]
pub struct NamedOutcomes<'e> {
    outputs: &'e [NamedOutput],
    outcomes: Outcomes,
}

impl NamedOutcomes<'_> {
    /// Returns the outcome of an output; `None` if the rule set has no output with the given name.
    pub fn get(&self, name: &str) -> Option<&Outcome> {
        let mut named = self.iter();
        named
            .find(|(output, _)| *output == name)
            .map(|(_, outcome)| outcome)
    }

    /// Iterates over the name and the outcome of each output.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = (&str, &Outcome)> {
        let names = self.outputs.iter().map(|output| &*output.name);
        names.zip(&self.outcomes)
    }
}

impl Index<&str> for NamedOutcomes<'_> {
    type Output = Outcome;

    #[expect(clippy::panic, reason = "the contract of indexing")]
    fn index(&self, name: &str) -> &Outcome {
        self.get(name)
            .unwrap_or_else(|| panic!("the rule set has no output `{name}`"))
    }
}

impl PartialEq for NamedOutcomes<'_> {
    fn eq(&self, other: &Self) -> bool {
        self.iter().eq(other.iter())
    }
}

impl core::fmt::Debug for NamedOutcomes<'_> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_map().entries(self.iter()).finish()
    }
}

#[cfg(feature = "serde")]
impl serde::Serialize for NamedOutcomes<'_> {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.iter())
    }
}

impl Engine {
    /// Evaluates values that are identified by the names of the inputs, in any order, and returns the outcomes by the
    /// names of the outputs.
    ///
    /// # Errors
    /// Fails like [`Engine::evaluate`], and if a name is not an input, or an input has no value or two values.
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
    ) -> Result<NamedOutcomes<'_>, EvaluateError> {
        Ok(NamedOutcomes {
            outputs: &self.outputs,
            outcomes: self.evaluate(&self.values_of(inputs)?)?,
        })
    }

    /// Works like [`Engine::explain`], with values identified by the names of the inputs, in any order.
    ///
    /// # Errors
    /// Fails like [`Engine::evaluate_named`].
    ///
    /// # Example
    /// ```
    /// use fuzzy::{Engine, Model};
    ///
    /// let model: Model = "
    /// fuzzy: 1
    /// name: fan
    /// inputs: {heat: {range: [0, 40], partition: [low, high]}}
    /// outputs: {speed: {range: [0, 9], partition: [slow, fast]}}
    /// rules: [IF heat IS low THEN speed IS slow, IF heat IS high THEN speed IS fast]
    /// ".parse()?;
    /// let explanation = Engine::new(&model)?.explain_named([("heat", 40.0)])?;
    /// assert_eq!(explanation.rules[0].text, "IF heat IS high THEN speed IS fast");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn explain_named<'a>(
        &self,
        inputs: impl IntoIterator<Item = (&'a str, f64)>,
    ) -> Result<Explanation, EvaluateError> {
        self.explain(&self.values_of(inputs)?)
    }

    /// Returns the values of all inputs in the order of the model.
    fn values_of<'a>(
        &self,
        inputs: impl IntoIterator<Item = (&'a str, f64)>,
    ) -> Result<SmallVec<[f64; 8]>, EvaluateError> {
        let mut values: SmallVec<[f64; 8]> = smallvec![f64::NAN; self.inputs.len()];
        let mut is_given: SmallVec<[bool; 8]> = smallvec![false; self.inputs.len()];
        for (name, value) in inputs {
            let Some(index) = self.input(name) else {
                let name = String::from(name);
                return Err(EvaluateError::UnknownInput { name });
            };
            if core::mem::replace(&mut is_given[index], true) {
                let name = Arc::clone(&self.inputs[index].name);
                return Err(EvaluateError::RepeatedInput { name });
            }
            values[index] = value;
        }
        if let Some(index) = is_given.iter().position(|given| !given) {
            let name = Arc::clone(&self.inputs[index].name);
            return Err(EvaluateError::MissingInput { name });
        }
        Ok(values)
    }

    /// Works like [`Engine::evaluate_named`] with a struct or map of numbers, whose fields are the inputs.
    ///
    /// # Errors
    /// Fails like [`Engine::evaluate_named`], and if `inputs` is not a struct or map of numbers.
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
    ) -> Result<NamedOutcomes<'_>, EvaluateError> {
        let fields = inputs.serialize(Fields::default());
        let fields = fields.map_err(|why| EvaluateError::NoFields { message: why.0 })?;
        self.evaluate_named(fields.iter().map(|(name, value)| (name.as_str(), *value)))
    }
}
