//! flagred for JavaScript: rule sets and flight logs in a browser's worker or in Node.
//!
//! What is refused is thrown as an `Error` with the words of the command line. Documents are JSON, the same as the command
//! line's; columns and maps are `Float64Array`.
//!
//! It is compiled once for each feature: a page that shows flights need not load what rule sets are edited with, nor an editor what
//! tunes them.

#[cfg(feature = "data")]
pub mod data;
mod failure;
#[cfg(feature = "flight")]
pub mod flight;
#[cfg(feature = "rules")]
pub mod rules;

use std::sync::Mutex;

use wasm_bindgen::prelude::wasm_bindgen;

/// What the last panic said. A panic ends the module: no call after it can be trusted but the one that asks for these words.
static PANIC: Mutex<String> = Mutex::new(String::new());

/// Runs when the module is loaded.
#[wasm_bindgen(start)]
fn start() {
    std::panic::set_hook(Box::new(|panic| {
        if let Ok(mut words) = PANIC.lock() {
            *words = panic.to_string();
        }
    }));
}

/// What the panic said that ended the module; empty where there was none.
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

/// A panic, so that tests see what becomes of one.
#[wasm_bindgen(js_name = panicNow)]
#[expect(clippy::panic, reason = "it is asked for")]
pub fn panic_now(words: &str) {
    panic!("{words}");
}
