//! Several flights side by side.

use std::rc::Rc;

use flagred::loaded::Loaded;
use flagred_report::Stretch;
use flagred_report::page::{self, Subject};
use wasm_bindgen::{JsError, prelude::wasm_bindgen};

use super::assessment::{Assessment, documents, table};
use crate::failure::failure;

/// Assessments of several flights with the same profile.
#[wasm_bindgen]
#[derive(Default)]
pub struct Comparison(Vec<Assessment>);

#[wasm_bindgen]
impl Comparison {
    /// A comparison without flights.
    #[wasm_bindgen(constructor)]
    pub fn new() -> Comparison {
        Comparison::default()
    }

    /// Adds a flight. It is assessed with the profile of the first flight.
    pub fn add(&mut self, assessment: &Assessment) -> Result<(), JsError> {
        let added = Assessment {
            subject: Rc::clone(&assessment.subject),
            loaded: Rc::clone(&assessment.loaded),
        };
        if let Some(first) = self.0.first()
            && texts(&first.loaded) != texts(&added.loaded)
        {
            let message = "only flights assessed with the same profile can be compared";
            return Err(failure(message, None));
        }
        self.0.push(added);
        Ok(())
    }

    /// The output of `flagred assess --json` for these logs.
    pub fn json(&self) -> Result<String, JsError> {
        documents(&self.all())
    }

    /// The output of `flagred assess --csv` for these logs.
    pub fn csv(&self) -> Result<Vec<u8>, JsError> {
        table(&self.all())
    }

    /// The output of `flagred assess --html` for these logs; empty without flights.
    pub fn html(&self) -> String {
        let page = |first: &Assessment| page::comparison(&self.subjects(), &first.loaded);
        self.0.first().map(page).unwrap_or_default()
    }

    /// The body of the HTML page that `html` returns, for a stretch of time since the start of each flight, or for the
    /// whole flights.
    pub fn part(&self, start_s: Option<f64>, end_s: Option<f64>) -> String {
        let stretch = start_s.zip(end_s);
        let stretch = stretch.map(|(start_s, end_s)| Stretch { start_s, end_s });
        let part = |first: &Assessment| {
            page::comparison_fragment(&self.subjects(), &first.loaded, stretch)
        };
        self.0.first().map(part).unwrap_or_default()
    }

    /// The length of the longest flight, in seconds.
    pub fn length_s(&self) -> f64 {
        page::longest_s(&self.subjects())
    }
}

impl Comparison {
    fn all(&self) -> Vec<&Assessment> {
        self.0.iter().collect()
    }

    fn subjects(&self) -> Vec<&Subject> {
        self.0.iter().map(|one| &*one.subject).collect()
    }
}

fn texts(loaded: &Loaded) -> (&str, &str) {
    (loaded.profile.text(), loaded.rules.text())
}
