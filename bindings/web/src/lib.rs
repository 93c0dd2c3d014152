//! flagred for JavaScript: rule sets and flight logs in a browser's worker or in Node.
//!
//! Errors are thrown as an `Error` with the same text as on the command line. Documents are the same JSON
//! documents as on the command line; columns and maps are `Float64Array`.
//!
//! This crate is compiled once for each feature: a page that shows flights does not load the code for editing
//! rule sets, and an editor does not load the code for tuning.

#[cfg(feature = "data")]
pub mod data;
mod failure;
#[cfg(feature = "flight")]
pub mod flight;
#[cfg(feature = "rules")]
pub mod rules;

use std::sync::Mutex;

use wasm_bindgen::prelude::wasm_bindgen;

/// The message of the last panic. After a panic only the function that returns this message may be called.
static PANIC: Mutex<String> = Mutex::new(String::new());

/// Sets up the handling of panics when the module is loaded.
#[wasm_bindgen(start)]
fn start() {
    std::panic::set_hook(Box::new(|panic| {
        if let Ok(mut words) = PANIC.lock() {
            *words = panic.to_string();
        }
    }));
}

/// The message of the panic that ended the module; empty if there was none.
#[wasm_bindgen(js_name = panicMessage)]
pub fn panic_message() -> String {
    PANIC
        .lock()
        .map_or_else(|_| String::new(), |words| words.clone())
}

/// The version of flagred.
#[wasm_bindgen]
pub fn version() -> String {
    env!("CARGO_PKG_VERSION").into()
}

/// Panics, for tests of how panics are handled.
#[wasm_bindgen(js_name = panicNow)]
#[expect(clippy::panic, reason = "it is asked for")]
pub fn panic_now(words: &str) {
    panic!("{words}");
}
