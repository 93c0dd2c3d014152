//! The parts of an open text, and the edits by which forms add, change, rename and remove them.

use std::ops::Range;

use flagred_authoring::{
    Edit,
    structure::{self, Part},
    values,
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
    variables: Vec<NamedVariable>,
    rules: Vec<String>,
    /// The shapes that a term can get.
    shapes: &'static [&'static str],
}

#[derive(Serialize)]
struct NamedVariable {
    /// The start of the variable's name in the text.
    at: usize,
    terms: Vec<NamedTerm>,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct NamedTerm {
    /// The start of the term's name in the text.
    at: usize,
    shape: String,
    parameters: String,
    names: Vec<&'static str>,
    is_editable: bool,
    can_change_shape: bool,
}

#[wasm_bindgen(js_class = RuleText)]
impl RuleText {
    /// The variables (inputs first) and their terms, with the positions of their names and the fields of the terms, and the
    /// rules, as JSON; `null` for a profile and for a text that cannot be read.
    pub fn parts(&self) -> Result<String, JsError> {
        let Some((places, model)) = structure::places(&self.document).zip(self.document.model())
        else {
            return json(&None::<Parts>);
        };
        let text = self.document.text();
        let at = |span: &Range<usize>| utf16(text, span.start);
        let term = |v, (t, name)| {
            let fields = values::fields(&self.document, v, t)?;
            Some(NamedTerm {
                at: at(name),
                shape: fields.shape,
                parameters: fields.parameters,
                names: fields.names,
                is_editable: fields.is_editable,
                can_change_shape: fields.can_change_shape,
            })
        };
        let variables = places.variables.iter().enumerate();
        let variables = variables.map(|(v, (name, terms))| NamedVariable {
            at: at(name),
            terms: terms
                .iter()
                .enumerate()
                .filter_map(|one| term(v, one))
                .collect(),
        });
        let rules = model.rules.iter().map(|rule| rule.rule.to_string());
        json(&Some(Parts {
            variables: variables.collect(),
            rules: rules.collect(),
            shapes: &values::SHAPES,
        }))
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

    /// The edits that change the range of a variable, as JSON.
    #[wasm_bindgen(js_name = setRange)]
    pub fn set_range(&self, variable: usize, low: f64, high: f64) -> Result<String, JsError> {
        self.changed(values::set_range(&self.document, variable, (low, high)))
    }

    /// The edits that change the unit of a variable, as JSON; an empty `unit` removes it.
    #[wasm_bindgen(js_name = setUnit)]
    pub fn set_unit(&self, variable: usize, unit: &str) -> Result<String, JsError> {
        self.changed(values::set_unit(&self.document, variable, unit))
    }

    /// The edits that change the parameters of a term, as JSON.
    #[wasm_bindgen(js_name = setParameters)]
    pub fn set_parameters(
        &self,
        variable: usize,
        term: usize,
        to: &str,
    ) -> Result<String, JsError> {
        let place = (variable, term);
        self.changed(values::set_parameters(&self.document, place, to))
    }

    /// The edits that give a term another shape in about the same part of the range, as JSON.
    #[wasm_bindgen(js_name = setShape)]
    pub fn set_shape(&self, variable: usize, term: usize, shape: &str) -> Result<String, JsError> {
        self.changed(values::set_shape(&self.document, (variable, term), shape))
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
