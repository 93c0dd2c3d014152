//! Conversion of rule sets from and to the formats of other programs.

use flagred_interchange::{Format, Losses};
use fuzzy::Findings;
use serde::Serialize;
use wasm_bindgen::{JsError, prelude::wasm_bindgen};

use super::json;
use crate::failure::failure;

#[derive(Serialize)]
struct Conversion {
    text: String,
    /// The format that was read or written, such as `FIS`.
    format: &'static str,
    /// Notes about content that is expressed differently, or was omitted.
    notes: Vec<String>,
}

/// Converts a rule set from the format of another program to YAML, like `flagred import`. Returns a JSON object
/// with `text`, `format` and `notes`. YAML is returned unchanged.
#[wasm_bindgen(js_name = importRules)]
pub fn import(text: &str, lossy: bool) -> Result<String, JsError> {
    let Some(format) = Format::of(text) else {
        return json(&Conversion {
            text: text.into(),
            format: "YAML",
            notes: Vec::new(),
        });
    };
    let read = flagred_interchange::read(text, format, losses(lossy)).map_err(refused)?;
    read.validate(text).map_err(refused)?;
    json(&Conversion {
        text: fuzzy::yaml::to_string(&read.model),
        format: format.name(),
        notes: notes(&read.warnings),
    })
}

/// Converts a rule set to the format of another program, like `flagred export`: `format` is `FIS`, `FLL`, `FCL` or
/// `FML`.
#[wasm_bindgen(js_name = exportRules)]
pub fn export(text: &str, format: &str, lossy: bool) -> Result<String, JsError> {
    let mut formats = Format::ALL.into_iter();
    let known = formats.find(|known| known.name() == format);
    let known = known.ok_or_else(|| {
        let help = Format::ALL.map(Format::name).join(", ");
        failure(format!("`{format}` is not a format"), Some(&help))
    })?;
    let document = flagred_interchange::document(text).map_err(refused)?;
    match flagred_interchange::write(&document.model, known, losses(lossy)) {
        Ok(written) => json(&Conversion {
            notes: notes(&written.findings),
            text: written.text,
            format: known.name(),
        }),
        Err(findings) => {
            let name = &document.model.name;
            let message = format!("`{name}` cannot be written as {format}");
            Err(failure(message, Some(&notes(&findings).join("\n"))))
        }
    }
}

fn losses(lossy: bool) -> Losses {
    match lossy {
        true => Losses::Accept,
        false => Losses::Refuse,
    }
}

fn notes(findings: &Findings) -> Vec<String> {
    let reported = findings.0.iter();
    reported.map(ToString::to_string).collect()
}

/// Converts findings that make a text unusable to an error.
pub(super) fn refused(findings: Findings) -> JsError {
    failure(findings, None)
}
