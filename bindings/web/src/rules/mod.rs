//! Rule sets: open texts for editing, compiled rule sets for evaluation and pictures, and conversion from and to other
//! formats.

pub mod exchange;
pub mod parts;
pub mod set;
pub mod single;
pub mod text;
pub mod viewer;

use flagred::shipped;
use flagred_authoring::{answers::CheckDocument, starter};
use fuzzy::{
    check,
    drawing::{Colour, distinct, distinct_line, reds, viridis},
};
use serde::Serialize;
use wasm_bindgen::{JsError, prelude::wasm_bindgen};

use crate::failure::failure;

/// The document of `flagred check --json`. A rule set that a profile names must be a shipped one.
#[wasm_bindgen(js_name = checkRules)]
pub fn check_rules(text: &str, file: &str) -> Result<String, JsError> {
    let document = text::document(text);
    if document.is_profile() {
        let name = document.profile().map(|profile| profile.name.as_str());
        let input_risks = document.risks_of_single_inputs();
        return json(&CheckDocument::profile(
            file,
            name,
            &document.findings().0,
            &input_risks,
        ));
    }
    let examined = flagred_authoring::examine(document.source(), &check::Options::default());
    let examined =
        examined.map_err(|finding| failure(&finding.message, finding.help.as_deref()))?;
    json(&CheckDocument::rules(file, &examined))
}

/// A template text.
#[derive(Serialize)]
struct Template {
    name: String,
    about: &'static str,
    text: String,
}

/// The template texts as a JSON array: the template of `flagred new`, the shipped rule sets and profiles, and examples.
#[wasm_bindgen(js_name = startingPoints)]
pub fn starting_points() -> Result<String, JsError> {
    let start = |name: String, about, text: &str| Template {
        name,
        about,
        text: text.to_owned(),
    };
    let [rules, paper_rules, battery_rules] = &shipped::RULE_SETS;
    let [profile, paper_profile, battery_profile] = &shipped::PROFILES;
    // A profile may have the same name as its rule set.
    let profile_name = |known: &shipped::Shipped| format!("profile-{}", known.name);
    json(&[
        start(
            "my-rules".into(),
            "a fan, with a comment on each line",
            &starter::rules("my-rules"),
        ),
        start(
            "tipper".into(),
            "how much to tip, the example of every textbook",
            include_str!("../../../../rules/tipper.yaml"),
        ),
        start(
            rules.name.into(),
            "the default rule set for flights",
            rules.text,
        ),
        start(
            paper_rules.name.into(),
            "the rule set of the paper",
            paper_rules.text,
        ),
        start(
            battery_rules.name.into(),
            "the default rule set for flights, with the battery",
            battery_rules.text,
        ),
        start(
            "my-profile".into(),
            "a profile, with a comment on each line",
            &starter::profile("my-profile", profile),
        ),
        start(
            profile_name(profile),
            "the default profile for flights",
            profile.text,
        ),
        start(
            profile_name(paper_profile),
            "the profile of the paper",
            paper_profile.text,
        ),
        start(
            profile_name(battery_profile),
            "the default profile for flights, with the battery",
            battery_profile.text,
        ),
    ])
}

/// 256 colours of a scale from low to high, 256 for risks, then 12 unordered colours, then 12 for thin lines on white, each
/// as red, green and blue.
#[wasm_bindgen]
pub fn colours() -> Vec<u8> {
    let scale = |colour: fn(f64) -> Colour| (0..=255u8).map(move |i| colour(f64::from(i) / 255.0));
    let unordered = (0..12).map(distinct).chain((0..12).map(distinct_line));
    let all = scale(viridis).chain(scale(reds)).chain(unordered);
    all.flat_map(|colour| [colour.0, colour.1, colour.2])
        .collect()
}

fn json(value: &impl Serialize) -> Result<String, JsError> {
    serde_json::to_string(value).map_err(|error| failure(error, None))
}
