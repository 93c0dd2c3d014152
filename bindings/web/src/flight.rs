//! Flight logs: read in pieces, assessed, explained.

use flagred::loaded;
use wasm_bindgen::{JsError, prelude::wasm_bindgen};

use crate::failure::failure;

/// The verdict of a log that is given whole.
#[wasm_bindgen(js_name = verdictOf)]
pub fn verdict_of(log: &[u8], profile: &str) -> Result<String, JsError> {
    let loaded = loaded::load(profile, |path| {
        Err(format!("`{}` is not a shipped profile", path.display()))
    });
    let loaded =
        loaded.map_err(|_| failure(format!("`{profile}` is not a shipped profile"), None))?;
    let flight = flightlog::read(log, &flightlog::Options::default());
    let flight = flight.map_err(|error| failure(error, None))?;
    let assessed = flagred::log::assess(&flight, &loaded.estimator, None);
    Ok(assessed.verdict.to_string())
}
