//! Profiles that are shipped or given as text, optionally with changed thresholds.

use std::{path::Path, rc::Rc};

use flagred::{
    loaded::{self, LoadError, Loaded},
    shipped::{self, PROFILES},
    verdict::{LevelSettings, VerdictSettings},
};
use flagred_report::diagnostics::{Style, draw};
use serde_json::Value;
use wasm_bindgen::{JsError, prelude::wasm_bindgen};

use crate::failure::failure;

/// A compiled profile and rule set.
#[wasm_bindgen]
pub struct Profile {
    /// The name by which findings refer to the text.
    name: String,
    pub(super) loaded: Rc<Loaded>,
    /// The text of a rule set that is used instead of the one that the profile names.
    rules: Option<String>,
}

#[wasm_bindgen]
impl Profile {
    /// Returns the shipped profile called `name`, or the profile in `text`; findings then refer to
    /// the text as `name`. If `rules` is given, it replaces the rule set that the profile names.
    #[wasm_bindgen(constructor)]
    pub fn new(
        name: String,
        text: Option<String>,
        rules: Option<String>,
    ) -> Result<Profile, JsError> {
        let text = match text {
            Some(text) => text,
            None => shipped_text(&name)?,
        };
        let text = fuzzy::Source::new(text);
        let loaded = match &rules {
            Some(rules) => loaded::with_rules(&name, text, fuzzy::Source::new(rules)),
            None => loaded::from_source(&name, text, None, no_file),
        };
        Ok(Profile {
            loaded: Rc::new(loaded.map_err(refusal)?),
            name,
            rules,
        })
    }

    /// The names of the shipped profiles; the first is the default.
    pub fn shipped() -> Vec<String> {
        PROFILES.iter().map(|known| known.name.to_owned()).collect()
    }

    /// The name in the text of the profile.
    #[wasm_bindgen(getter)]
    pub fn name(&self) -> String {
        self.loaded.estimator.profile().name.clone()
    }

    /// The text of the profile.
    #[wasm_bindgen(getter)]
    pub fn text(&self) -> String {
        self.loaded.profile.text().to_owned()
    }

    /// The warnings about the profile, with the lines that they refer to; empty if there are none. A profile with
    /// warnings can still be used.
    #[wasm_bindgen(getter)]
    pub fn warnings(&self) -> String {
        drawn(
            &self.loaded.warnings,
            &self.name,
            self.loaded.profile.text(),
        )
    }

    /// The signals that must be read from a log to assess it and to draw its report. Signals that a reader may add to
    /// the report are not included.
    #[wasm_bindgen(getter)]
    pub fn signals(&self) -> Vec<String> {
        flagred_report::signals(&self.loaded.estimator)
    }

    /// The conditions for levels, as JSON: `profile.verdict` in the document of an assessment.
    #[wasm_bindgen(getter)]
    pub fn verdict(&self) -> Result<String, JsError> {
        let verdict = &self.loaded.estimator.profile().verdict;
        serde_json::to_string(verdict).map_err(|error| failure(error, None))
    }

    /// Returns the same profile with other thresholds and times. `changes` is JSON in the layout of `verdict`;
    /// values that it omits do not change.
    #[wasm_bindgen(js_name = withVerdict)]
    pub fn with_verdict(&self, changes: &str) -> Result<Profile, JsError> {
        let changes: Value = serde_json::from_str(changes).map_err(|error| failure(error, None))?;
        let mut wanted = self.loaded.estimator.profile().verdict;
        change(&mut wanted, &changes);
        let text = self.loaded.profile.text();
        let text = flagred::profile::Profile::rewritten(text, &wanted);
        let text = text.map_err(|findings| {
            let first = findings.0.first();
            let message = first.map_or_else(String::new, |finding| finding.message.clone());
            failure(message, first.and_then(|finding| finding.help.as_deref()))
        })?;
        Profile::new(self.name.clone(), Some(text), self.rules.clone())
    }
}

fn shipped_text(name: &str) -> Result<String, JsError> {
    let found = PROFILES.iter().find(|known| known.name == name);
    found.map(|known| known.text.to_owned()).ok_or_else(|| {
        let names = shipped::profile_names().join(", ");
        let help = format!("built-in profiles are {names}");
        failure(format!("`{name}` is not a built-in profile"), Some(&help))
    })
}

/// Returns the error for a rule set file that a profile names: a profile that is given as text has no folder in which
/// to look for the file.
fn no_file(path: &Path) -> Result<String, String> {
    Err(format!("`{}` cannot be read", path.display()))
}

fn refusal<E: std::fmt::Display>(error: LoadError<E>) -> JsError {
    match error {
        LoadError::Read(error) => failure(error, None),
        LoadError::Findings {
            file,
            text,
            findings,
        } => JsError::new(&drawn(&findings, &file, &text)),
        LoadError::Unusable { message, help } => failure(message, help.as_deref()),
    }
}

/// Formats findings together with the lines of the text that they refer to.
fn drawn(findings: &fuzzy::Findings, file: &str, text: &str) -> String {
    let style = Style {
        colored: false,
        advice: |_| None,
        all: "the list of problems shows all of them",
        is_quoted: flagred::loaded::is_meant_as_rules,
    };
    draw(&findings.0, file, text, style).trim_end().to_owned()
}

/// Replaces the numbers for which `changes` has a value.
fn change(verdict: &mut VerdictSettings, changes: &Value) {
    let number = |pointer: &str, to: &mut f64| {
        if let Some(value) = changes.pointer(pointer).and_then(Value::as_f64) {
            *to = value;
        }
    };
    number("/clear_after_s", &mut verdict.clear_after_s);
    number(
        "/quiet_after_take_off_s",
        &mut verdict.quiet_after_take_off_s,
    );
    number(
        "/quiet_before_landing_s",
        &mut verdict.quiet_before_landing_s,
    );
    for (name, level) in [("warn", &mut verdict.warn), ("fail", &mut verdict.fail)] {
        let LevelSettings {
            raise,
            after_s,
            until,
        } = level;
        number(&format!("/{name}/after_s"), after_s);
        for (part, threshold) in [("raise", raise), ("until", until)] {
            for (key, limit) in [
                ("risk_pct", &mut threshold.risk_pct),
                ("elevated_risk_pct", &mut threshold.elevated_risk_pct),
            ] {
                match changes.pointer(&format!("/{name}/{part}/{key}")) {
                    Some(Value::Null) => *limit = None,
                    Some(value) => *limit = value.as_f64().or(*limit),
                    None => {}
                }
            }
        }
    }
}
