//! Rule sets: checked, evaluated, explained, drawn.

use fuzzy::check;
use wasm_bindgen::prelude::wasm_bindgen;

/// The findings of a rule set, as a JSON array.
#[wasm_bindgen(js_name = findingsOf)]
pub fn findings_of(text: &str) -> String {
    let findings = match interchange::document(text) {
        Ok(document) => match check::document(&document, text, &check::Options::default()) {
            Ok((findings, _)) => findings.0,
            Err(finding) => vec![*finding],
        },
        Err(findings) => findings.0,
    };
    serde_json::to_string(&findings).unwrap_or_else(|_| "[]".into())
}
