//! Rule sets: an open text under an author's hands, a compiled rule set to evaluate and draw, and other programs' formats.

pub mod exchange;
pub mod set;
pub mod text;

use authoring::{answers::Checked, starter};
use flagred::shipped;
use fuzzy::{
    check,
    drawing::{distinct, viridis},
};
use serde::Serialize;
use wasm_bindgen::{JsError, prelude::wasm_bindgen};

use crate::failure::failure;

/// The document of `flagred check --json`. A rule set that a profile names is a shipped one.
#[wasm_bindgen(js_name = checkRules)]
pub fn check_rules(text: &str, file: &str) -> Result<String, JsError> {
    if authoring::is_profile(text) {
        let document = text::document(text);
        let name = document.profile().map(|profile| profile.name.as_str());
        return json(&Checked::profile(file, name, &document.findings().0));
    }
    let examined = authoring::examine(text, &check::Options::default());
    let examined =
        examined.map_err(|finding| failure(&finding.message, finding.help.as_deref()))?;
    json(&Checked::rules(file, &examined))
}

/// A text to start from.
#[derive(Serialize)]
struct Start {
    name: &'static str,
    about: &'static str,
    text: String,
}

/// Texts to start from, as a JSON array: the starter of `flagred new`, the shipped rule sets and profiles, examples.
#[wasm_bindgen(js_name = startingPoints)]
pub fn starting_points() -> Result<String, JsError> {
    let shipped = |all: &'static [shipped::Shipped], about: [&'static str; 2]| {
        let of = |(known, about): (&'static shipped::Shipped, &'static str)| Start {
            name: known.name,
            about,
            text: known.text.to_owned(),
        };
        all.iter().zip(about).map(of)
    };
    let example = |name, about, text: &str| Start {
        name,
        about,
        text: text.to_owned(),
    };
    let mut all = vec![
        Start {
            name: "my-rules",
            about: "a fan in a few lines, with a comment on each",
            text: starter::rules("my-rules"),
        },
        example(
            "tipper",
            "how much to tip: the example of every textbook",
            include_str!("../../../../rules/tipper.yaml"),
        ),
    ];
    all.extend(shipped(
        &shipped::RULE_SETS,
        ["the rule set to fly with", "the rule set of the paper"],
    ));
    all.push(example(
        "flagred-battery",
        "the paper's rules and the battery",
        include_str!("../../../../rules/flagred-battery.yaml"),
    ));
    all.extend(shipped(
        &shipped::PROFILES,
        ["a profile: the rules to fly with", "a profile: the paper's"],
    ));
    all.push(Start {
        name: "my-profile",
        about: "a profile with a comment on each line",
        text: starter::profile("my-profile"),
    });
    json(&all)
}

/// 256 colours of a scale from low to high, then 12 colours without order: red, green and blue of each.
#[wasm_bindgen]
pub fn colours() -> Vec<u8> {
    let scale = (0..=255u8).map(|i| viridis(f64::from(i) / 255.0));
    let all = scale.chain((0..12).map(distinct));
    all.flat_map(|colour| [colour.0, colour.1, colour.2])
        .collect()
}

fn json(value: &impl Serialize) -> Result<String, JsError> {
    serde_json::to_string(value).map_err(|error| failure(error, None))
}
