//! Parts of an open text that are added, renamed and removed by forms.

use std::ops::Range;

use flagred_authoring::{
    Edit,
    structure::{self, Part},
};
use serde::Serialize;
use wasm_bindgen::{JsError, prelude::wasm_bindgen};

use super::{
    json,
    text::{RuleText, edits, utf16},
};
use crate::failure::failure;

#[derive(Serialize)]
struct Parts {
    variables: Vec<Named>,
    rules: Vec<String>,
}

#[derive(Serialize)]
struct Named {
    /// The span of its name.
    at: usize,
    /// The spans of the names of its terms.
    terms: Vec<usize>,
}

#[wasm_bindgen(js_class = RuleText)]
impl RuleText {
    /// The spans of the names of variables and terms, inputs first, and the rules, as JSON; `null` for a profile and
    /// for a text that cannot be read.
    pub fn parts(&self) -> Result<String, JsError> {
        let text = self.document.text();
        let at = |span: &Range<usize>| utf16(text, span.start);
        let model = self.document.model();
        json(
            &structure::places(&self.document)
                .zip(model)
                .map(|(places, model)| Parts {
                    variables: places
                        .variables
                        .iter()
                        .map(|(name, terms)| Named {
                            at: at(name),
                            terms: terms.iter().map(at).collect(),
                        })
                        .collect(),
                    rules: model
                        .rules
                        .iter()
                        .map(|rule| rule.rule.to_string())
                        .collect(),
                }),
        )
    }

    /// The edits that add an input or output, as JSON.
    #[wasm_bindgen(js_name = addVariable)]
    pub fn add_variable(
        &self,
        name: &str,
        low: f64,
        high: f64,
        is_output: bool,
    ) -> Result<String, JsError> {
        self.changed(structure::add_variable(
            &self.document,
            name,
            (low, high),
            is_output,
        ))
    }

    /// The edits that add a term to a variable, as JSON.
    #[wasm_bindgen(js_name = addTerm)]
    pub fn add_term(&self, variable: usize, name: &str) -> Result<String, JsError> {
        self.changed(structure::add_term(&self.document, variable, name))
    }

    /// The edits that add a rule, as JSON.
    #[wasm_bindgen(js_name = addRule)]
    pub fn add_rule(&self, rule: &str) -> Result<String, JsError> {
        self.changed(structure::add_rule(&self.document, rule))
    }

    /// The edits that replace the text of a rule, as JSON.
    #[wasm_bindgen(js_name = changeRule)]
    pub fn change_rule(&self, rule: usize, to: &str) -> Result<String, JsError> {
        self.changed(structure::change_rule(&self.document, rule, to))
    }

    /// The edits that remove a variable, or a term of it, as JSON.
    #[wasm_bindgen(js_name = removeNamed)]
    pub fn remove_named(&self, variable: usize, term: Option<usize>) -> Result<String, JsError> {
        let part = term.map_or(Part::Variable(variable), |term| Part::Term(variable, term));
        self.changed(structure::remove(&self.document, part))
    }

    /// The edits that remove a rule, as JSON.
    #[wasm_bindgen(js_name = removeRule)]
    pub fn remove_rule(&self, rule: usize) -> Result<String, JsError> {
        self.changed(structure::remove(&self.document, Part::Rule(rule)))
    }

    fn changed(&self, change: Result<Vec<Edit>, String>) -> Result<String, JsError> {
        let change = change.map_err(|why| failure(why, None))?;
        edits(self.document.text(), change)
    }
}
