//! Errors as JavaScript's `Error`.

use fuzzy::drawing::visible_lines;
use wasm_bindgen::JsError;

/// Creates an error with the same text as on the command line: the message, then a line of help if there is one. Hidden
/// characters are made visible; each of several findings is on its own line.
pub(crate) fn failure(message: impl std::fmt::Display, help: Option<&str>) -> JsError {
    let message = message.to_string();
    match help {
        Some(help) => {
            let (message, help) = (visible_lines(&message), visible_lines(help));
            JsError::new(&format!("{message}\nhelp: {help}"))
        }
        None => JsError::new(&visible_lines(&message)),
    }
}
