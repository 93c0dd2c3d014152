//! What is refused, as JavaScript's `Error`.

use fuzzy::drawing::visible;
use wasm_bindgen::JsError;

/// An error with the words of the command line: the message, then a line of help where there is one. Characters that would be
/// hidden are visible, as there.
pub(crate) fn failure(message: impl std::fmt::Display, help: Option<&str>) -> JsError {
    let message = message.to_string();
    match help {
        Some(help) => JsError::new(&format!("{}\nhelp: {}", visible(&message), visible(help))),
        None => JsError::new(&visible(&message)),
    }
}
