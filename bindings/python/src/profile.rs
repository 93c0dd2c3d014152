//! Profiles: where the inputs of a rule set come from, and when it warns.

use std::{fs, path::Path, sync::Arc};

use flagred::{
    loaded::{self, LoadError, Loaded},
    shipped,
};
use fuzzy::{Findings, Model};
use pyo3::prelude::*;

use crate::errors::{data_error, diagnostics, os_error, rule_set_error};

/// A profile with its rule set: which signals of a flight are the inputs, and at which risk it warns.
///
/// Parameters
/// ----------
/// name
///     A shipped profile, ``flagred`` or ``flagred-paper``, or a file. The rule set of a file is looked for beside it.
///
/// Raises
/// ------
/// RuleSetError
///     The profile or its rule set has errors.
/// OSError
///     The file cannot be read.
///
/// Examples
/// --------
/// >>> import flagred
/// >>> flagred.Profile("flagred-paper").inputs
/// ['margin', 'spread']
#[pyclass(frozen, module = "flagred")]
pub(crate) struct Profile {
    pub(crate) loaded: Arc<Loaded>,
    /// What it was asked for by.
    pub(crate) file: String,
}

impl Profile {
    fn new(file: &str, loaded: Loaded) -> Profile {
        Profile {
            loaded: Arc::new(loaded),
            file: file.to_owned(),
        }
    }
}

/// The text of a built-in rule set.
#[pyfunction]
pub(crate) fn _built_in(name: &str) -> Option<&'static str> {
    let mut known = shipped::RULE_SETS.iter();
    known
        .find(|known| known.name == name)
        .map(|known| known.text)
}

#[pymethods]
impl Profile {
    #[new]
    #[pyo3(signature = (name = "flagred"))]
    pub(crate) fn load(py: Python<'_>, name: &str) -> PyResult<Self> {
        let loaded = loaded::load(name, |path: &Path| fs::read_to_string(path));
        match loaded {
            Ok(loaded) => Ok(Profile::new(name, loaded)),
            Err(LoadError::Read(error)) => {
                let names = shipped::profile_names().join(", ");
                let help = format!("built-in profiles are {names}");
                Err(os_error(py, &error, name, Some(&help))?)
            }
            Err(LoadError::Findings {
                file,
                text,
                findings,
            }) => Err(rule_set_error(py, &findings, &file, &text)),
            Err(LoadError::Unusable { message, help }) => Err(data_error(message, help)),
        }
    }

    /// A profile of its text and that of its rule set, as a pickle has them.
    #[staticmethod]
    fn _of_texts(py: Python<'_>, file: &str, profile: String, rules: String) -> PyResult<Self> {
        let model: Result<Model, Findings> = rules.parse();
        let model = model.map_err(|findings| rule_set_error(py, &findings, file, &rules))?;
        let (findings, estimator) = loaded::fit(&profile, &model);
        let Some(estimator) = estimator else {
            return Err(rule_set_error(py, &findings, file, &profile));
        };
        let loaded = Loaded {
            estimator,
            profile_text: profile,
            rules_text: rules,
            warnings: findings,
            files: Vec::new(),
        };
        Ok(Profile::new(file, loaded))
    }

    fn __reduce__<'py>(
        slf: &Bound<'py, Self>,
    ) -> PyResult<(Bound<'py, PyAny>, (String, String, String))> {
        let profile = slf.get();
        let (profile_text, rules_text) = (&profile.loaded.profile_text, &profile.loaded.rules_text);
        let texts = (
            profile.file.clone(),
            profile_text.clone(),
            rules_text.clone(),
        );
        Ok((slf.getattr("_of_texts")?, texts))
    }

    /// Its name.
    #[getter]
    fn name(&self) -> &str {
        &self.loaded.estimator.profile().name
    }

    /// The inputs of its rule set, in their order.
    #[getter]
    fn inputs(&self) -> Vec<String> {
        let inputs = self.loaded.estimator.profile().inputs.iter();
        inputs.map(|input| input.name.clone()).collect()
    }

    /// The signals that it needs beside the commands of the motors.
    #[getter]
    fn signals(&self) -> Vec<String> {
        let signals = self.loaded.estimator.profile().signals();
        signals.into_iter().map(str::to_owned).collect()
    }

    /// The profile as it is written.
    #[getter]
    fn text(&self) -> &str {
        &self.loaded.profile_text
    }

    /// Its rule set as it is written.
    #[getter]
    fn rules_text(&self) -> &str {
        &self.loaded.rules_text
    }

    /// What is doubtful about it.
    #[getter]
    fn warnings<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyAny>>> {
        diagnostics(
            py,
            &self.loaded.warnings,
            &self.file,
            &self.loaded.profile_text,
        )
    }

    fn __repr__(&self) -> String {
        format!("Profile('{}')", self.file)
    }
}
