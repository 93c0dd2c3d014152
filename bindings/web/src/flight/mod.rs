//! Flight logs: read in pieces, assessed, explained. Results that are expensive to compute are kept between calls: the
//! flight, the compiled profile, the assessment.

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

/// The number of bytes that are passed to JavaScript at once.
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
    /// Reads a log, plain or gzipped, from front to back. `read` takes an offset and a length in bytes and returns a
    /// `Uint8Array`, which is empty at the end. Signals other than motor commands are kept only if they are in `signals`;
    /// without `signals`, all are kept.
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

    /// Whether all signals that a profile needs were read.
    #[wasm_bindgen(js_name = serves)]
    pub fn has_signals_for(&self, profile: &Profile) -> bool {
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
                assessed: flagred::log::assess_with_intervals(&self.flight, estimator, STEP_S),
            }),
            loaded: Rc::clone(&profile.loaded),
        }
    }

    /// Writes the flight as flight CSV; `write` is called with a `Uint8Array` for each piece.
    #[wasm_bindgen(js_name = writeCsv)]
    pub fn write_csv(&self, write: &Function) -> Result<(), JsError> {
        let mut out = BufWriter::with_capacity(PIECE, Sink(write));
        let written = flagred_report::table::write_flight(&mut out, &self.flight);
        let written = written.and_then(|()| out.flush());
        written.map_err(|error| failure(error, None))
    }

    /// Warnings about the conversion, as printed by `flagred convert`.
    pub fn warnings(&self) -> Vec<String> {
        flagred_report::words::conversion(&self.name, &self.flight)
    }
}
