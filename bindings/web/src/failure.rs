//! What is refused, as JavaScript's `Error`.

use wasm_bindgen::JsError;

/// An error with the words of the command line: the message, then a line of help where there is one.
pub(crate) fn failure(message: impl std::fmt::Display, help: Option<&str>) -> JsError {
    match help {
        Some(help) => JsError::new(&format!("{message}\nhelp: {help}")),
        None => JsError::new(&message.to_string()),
    }
}
