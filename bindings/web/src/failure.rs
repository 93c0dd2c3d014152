//! What is refused, as JavaScript's `Error`.

use fuzzy::drawing::visible_lines;
use wasm_bindgen::JsError;

/// An error with the words of the command line: the message, then a line of help where there is one. Characters that would be
/// hidden are visible, as there; several findings stand on a line each.
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
