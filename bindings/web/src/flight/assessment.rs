//! The assessment of a flight: the documents of the command line, and the report part by part.

use std::rc::Rc;

use flagred::loaded::Loaded;
use flagred_report::Stretch;
use flagred_report::{
    document, moment,
    page::{self, Part, Report, Subject},
    steps,
};
use wasm_bindgen::{JsError, prelude::wasm_bindgen};

use crate::failure::failure;

/// An assessment of a flight with a profile.
#[wasm_bindgen]
pub struct Assessment {
    pub(super) subject: Rc<Subject>,
    pub(super) loaded: Rc<Loaded>,
}

#[wasm_bindgen]
impl Assessment {
    /// The output of `flagred assess --json`.
    pub fn json(&self) -> Result<String, JsError> {
        documents(&[self])
    }

    /// The document of `json` on one line, without its steps.
    pub fn brief(&self) -> Result<String, JsError> {
        let Subject {
            name,
            flight,
            assessed,
        } = &*self.subject;
        let brief = document::brief(name, flight, &self.loaded.estimator, assessed);
        serde_json::to_string(&brief).map_err(|error| failure(error, None))
    }

    /// The output of `flagred assess --csv`.
    pub fn csv(&self) -> Result<Vec<u8>, JsError> {
        table(&[self])
    }

    /// The output of `flagred assess --html`: the whole report.
    pub fn html(&self) -> String {
        page::report(&self.subject, &self.loaded)
    }

    /// The output of `flagred assess --svg`; nothing if no risk is known.
    pub fn svg(&self) -> Option<String> {
        page::svg(&self.subject, &self.loaded)
    }

    /// The stretch of time that the report shows: its start and its end, in seconds.
    pub fn stretch(&self) -> Vec<f64> {
        let Stretch { start_s, end_s } = self.subject.stretch();
        vec![start_s, end_s]
    }

    /// A part of the report as HTML, for the given stretch of time, or for the whole time that the report shows; empty
    /// if there is nothing to show.
    pub fn part(
        &self,
        name: &str,
        start_s: Option<f64>,
        end_s: Option<f64>,
    ) -> Result<String, JsError> {
        let part = Part::ALL.into_iter().find(|part| part.name() == name);
        let part = part.ok_or_else(|| failure(format!("a report has no part `{name}`"), None))?;
        let stretch = start_s.zip(end_s);
        let stretch = stretch.map(|(start_s, end_s)| Stretch { start_s, end_s });
        Ok(Report::new(&self.subject, &self.loaded, stretch).part(part))
    }

    /// The signals of the log with their units and sources, as JSON.
    pub fn signals(&self) -> Result<String, JsError> {
        let signals = flagred_report::available::signals(&self.subject.flight);
        serde_json::to_string(&signals).map_err(|error| failure(error, None))
    }

    /// Charts of the signals with these names as HTML, like those in a part of the report.
    #[wasm_bindgen(js_name = signalCharts)]
    pub fn signal_charts(
        &self,
        names: Vec<String>,
        start_s: Option<f64>,
        end_s: Option<f64>,
    ) -> String {
        let stretch = start_s.zip(end_s);
        let stretch = stretch.map(|(start_s, end_s)| Stretch { start_s, end_s });
        Report::new(&self.subject, &self.loaded, stretch).signals(&names)
    }

    /// The state at a time in seconds, and the rules that fire, as JSON.
    pub fn moment(&self, t_s: f64) -> Result<String, JsError> {
        let Subject {
            flight, assessed, ..
        } = &*self.subject;
        let moment = moment::moment(flight, &self.loaded.estimator, assessed, t_s);
        serde_json::to_string(&moment).map_err(|error| failure(error, None))
    }
}

/// Returns assessments as JSON, as the command line prints them: a document for one flight, an array for several.
pub(super) fn documents(assessments: &[&Assessment]) -> Result<String, JsError> {
    let texts = assessments.iter().map(|assessment| {
        let Subject {
            name,
            flight,
            assessed,
        } = &*assessment.subject;
        let estimator = &assessment.loaded.estimator;
        serde_json::to_string_pretty(&document::document(name, flight, estimator, assessed))
    });
    let texts: Result<Vec<String>, _> = texts.collect();
    let texts = texts.map_err(|error| failure(error, None))?;
    let mut out = Vec::new();
    let written = document::write(&mut out, &texts, texts.len() > 1);
    written.map_err(|error| failure(error, None))?;
    String::from_utf8(out).map_err(|error| failure(error, None))
}

/// The steps of assessments as one table.
pub(super) fn table(assessments: &[&Assessment]) -> Result<Vec<u8>, JsError> {
    let mut out = Vec::new();
    for (i, assessment) in assessments.iter().enumerate() {
        let Subject { name, assessed, .. } = &*assessment.subject;
        let name = (assessments.len() > 1).then_some(name.as_str());
        let estimator = &assessment.loaded.estimator;
        let written = steps::write_csv(&mut out, name, i == 0, estimator, assessed);
        written.map_err(|error| failure(error, None))?;
    }
    Ok(out)
}
