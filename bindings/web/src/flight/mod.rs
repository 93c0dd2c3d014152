//! Flight logs: read in pieces, assessed, explained. What is expensive to make stays here between calls: the flight, the
//! compiled profile, the assessment.

mod assessment;
mod comparison;
mod profile;
mod stream;

use std::{
    io::{BufWriter, Write},
    rc::Rc,
    sync::Arc,
};

use flagred_report::{page::Subject, steps::STEP_S};
use js_sys::Function;
use wasm_bindgen::{JsError, prelude::wasm_bindgen};

use crate::failure::failure;
use assessment::Assessment;
use profile::Profile;
use stream::{Sink, Source};

/// Bytes that are handed to JavaScript at once.
const PIECE: usize = 1 << 20;

/// The style sheet of the parts of a report.
#[wasm_bindgen(js_name = reportStyle)]
pub fn report_style() -> String {
    flagred_report::page::style()
}

/// A flight that was read from a log.
#[wasm_bindgen]
pub struct Flight {
    name: String,
    flight: Arc<flagred_flightlog::Flight>,
    /// The signals that were read; `None` for all.
    signals: Option<Vec<String>>,
}

#[wasm_bindgen]
impl Flight {
    /// Reads a log from front to back, plain or gzipped. `read` gets an offset and a length in bytes and gives a `Uint8Array`,
    /// which is empty at the end. Of the signals beside the motors, those named are kept, or all.
    #[wasm_bindgen(constructor)]
    pub fn new(
        name: String,
        read: &Function,
        signals: Option<Vec<String>>,
    ) -> Result<Flight, JsError> {
        let mut options = flagred_flightlog::Options::default();
        options.signals = signals;
        match flagred_flightlog::read(Source::new(read), &options) {
            Ok(flight) => Ok(Flight {
                name,
                flight: Arc::new(flight),
                signals: options.signals,
            }),
            Err(error) => {
                let error = error.with_path(&name);
                Err(failure(&error, error.help()))
            }
        }
    }

    /// Whether everything was read that a profile needs.
    pub fn serves(&self, profile: &Profile) -> bool {
        let read = |name: &String| self.signals.as_ref().is_none_or(|read| read.contains(name));
        profile.signals().iter().all(read)
    }

    /// Assesses the flight.
    pub fn assess(&self, profile: &Profile) -> Assessment {
        let estimator = &profile.loaded.estimator;
        Assessment {
            subject: Rc::new(Subject {
                name: self.name.clone(),
                flight: Arc::clone(&self.flight),
                assessed: flagred::log::assess(&self.flight, estimator, Some(STEP_S)),
            }),
            loaded: Rc::clone(&profile.loaded),
        }
    }

    /// The flight as flight CSV; `write` is called with one `Uint8Array` after the other.
    #[wasm_bindgen(js_name = writeCsv)]
    pub fn write_csv(&self, write: &Function) -> Result<(), JsError> {
        let mut out = BufWriter::with_capacity(PIECE, Sink(write));
        let written = flagred_report::table::write_flight(&mut out, &self.flight);
        let written = written.and_then(|()| out.flush());
        written.map_err(|error| failure(error, None))
    }

    /// What is to be told beside a conversion: the warnings of `flagred convert`.
    pub fn warnings(&self) -> Vec<String> {
        flagred_report::words::conversion(&self.name, &self.flight)
    }
}
