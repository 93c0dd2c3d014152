//! Profiles: the sources of the inputs of a rule set, and the thresholds of warnings.

use std::{fs, io, path::Path, sync::Arc};

use flagred::{
    loaded::{self, LoadError, Loaded},
    shipped,
};
use fuzzy::Source;
use pyo3::prelude::*;

use crate::{
    errors::{data_error, diagnostics, os_error, rule_set_error},
    rule_set,
};

/// A profile with its rule set: which signals of a flight are the inputs, and at which risk it warns.
///
/// Parameters
/// ----------
/// name
///     A shipped profile, ``flagred`` or ``flagred-paper``, or a file. The rule set of a file must be in the same folder.
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
    /// The name or path by which the profile was loaded.
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

/// Returns a loaded profile, or the error that occurred while it was loaded.
fn profile_or_error(
    py: Python<'_>,
    file: &str,
    loaded: Result<Loaded, LoadError<io::Error>>,
) -> PyResult<Profile> {
    match loaded {
        Ok(loaded) => Ok(Profile::new(file, loaded)),
        Err(LoadError::Read(error)) => {
            let names = shipped::profile_names().join(", ");
            let help = format!("built-in profiles are {names}");
            Err(os_error(py, &error, file, Some(&help))?)
        }
        Err(LoadError::Findings {
            file,
            text,
            findings,
        }) => Err(rule_set_error(py, &findings, &file, &text)),
        Err(LoadError::Unusable { message, help }) => Err(data_error(message, help)),
    }
}

#[pymethods]
impl Profile {
    #[new]
    #[pyo3(signature = (name = "flagred"))]
    pub(crate) fn load(py: Python<'_>, name: &str) -> PyResult<Self> {
        let loaded = loaded::load(name, |path: &Path| fs::read_to_string(path));
        profile_or_error(py, name, loaded)
    }

    /// Creates a profile from the pickled texts of the profile and of its rule set.
    #[staticmethod]
    fn _of_texts(py: Python<'_>, file: &str, profile: String, rules: String) -> PyResult<Self> {
        let [profile, rules] = [profile, rules].map(Source::new);
        profile_or_error(py, file, loaded::with_rules(file, profile, rules))
    }

    fn __reduce__<'py>(
        slf: &Bound<'py, Self>,
    ) -> PyResult<(Bound<'py, PyAny>, (String, String, String))> {
        let profile = slf.get();
        let (text, rules) = (profile.loaded.profile.text(), profile.loaded.rules.text());
        let texts = (profile.file.clone(), text.to_owned(), rules.to_owned());
        Ok((slf.getattr("_of_texts")?, texts))
    }

    /// The name of the profile.
    #[getter]
    fn name(&self) -> &str {
        &self.loaded.estimator.profile().name
    }

    /// The inputs of the rule set, in their order.
    #[getter]
    fn inputs(&self) -> Vec<String> {
        let inputs = self.loaded.estimator.profile().inputs.iter();
        inputs.map(|input| input.name.clone()).collect()
    }

    /// The signals that the profile requires besides the commands of the motors.
    #[getter]
    fn signals(&self) -> Vec<String> {
        let signals = self.loaded.estimator.profile().signals();
        signals.into_iter().map(str::to_owned).collect()
    }

    /// The text of the profile.
    #[getter]
    fn text(&self) -> &str {
        self.loaded.profile.text()
    }

    /// The text of the rule set.
    #[getter]
    fn rules_text(&self) -> &str {
        self.loaded.rules.text()
    }

    /// The profile and its rule set as code for firmware, as ``flagred export`` writes it.
    ///
    /// Parameters
    /// ----------
    /// language
    ///     ``rust``, ``c``, or ``lua`` for a script that ArduPilot runs.
    ///
    /// Raises
    /// ------
    /// DataError
    ///     The language cannot express the profile.
    fn to_code(&self, language: &str) -> PyResult<String> {
        let Some(chosen) = rule_set::language(language) else {
            let message = format!("code cannot be exported in the language `{language}`");
            return Err(data_error(
                message,
                Some("write `rust`, `c` or `lua`".into()),
            ));
        };
        let code = flagred_cli::export_profile(&self.loaded.estimator, chosen);
        code.map_err(|error| data_error(error, None))
    }

    /// The warnings about the profile and its rule set.
    #[getter]
    fn warnings<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyAny>>> {
        diagnostics(
            py,
            &self.loaded.warnings,
            &self.file,
            self.loaded.profile.text(),
        )
    }

    fn __repr__(&self) -> String {
        format!("Profile('{}')", self.file)
    }
}
