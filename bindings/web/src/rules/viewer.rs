//! All rules with the fuzzy sets of their propositions and consequents, for the rule viewer.

use fuzzy::{
    Model,
    model::Conjunction,
    rule::{Hedge, Proposition},
};
use serde::Serialize;
use wasm_bindgen::{JsError, prelude::wasm_bindgen};

use super::{json, set::RuleSet};

/// The number of points of the curve of a proposition with hedges.
const SAMPLES: usize = 100;

#[derive(Serialize)]
struct RuleView<'a> {
    /// Whether a consequent is scaled by the firing strength, rather than cut.
    scales: bool,
    rules: Vec<Row<'a>>,
}

#[derive(Serialize)]
struct Row<'a> {
    conditions: Vec<Cell<'a>>,
    conclusions: Vec<Conclusion<'a>>,
}

#[derive(Serialize)]
struct Cell<'a> {
    variable: &'a str,
    /// The hedges and the term: `very high`.
    words: String,
    term: Option<&'a str>,
    /// The curve of the term after the hedges, as alternating x and degree; empty without hedges.
    curve: Vec<f64>,
}

#[derive(Serialize)]
struct Conclusion<'a> {
    output: &'a str,
    words: String,
    term: &'a str,
}

#[wasm_bindgen(js_class = RuleSet)]
impl RuleSet {
    /// The propositions and consequents of each rule, as JSON.
    pub fn viewed(&self) -> Result<String, JsError> {
        let model = self.engine.model();
        let rows = model.rules.iter().map(|rule| {
            let mut conditions = Vec::new();
            rule.rule
                .condition
                .visit(&mut |one| conditions.push(Row::cell(model, one)));
            let conclusions = rule.rule.consequents.iter().map(|one| Conclusion {
                output: &one.output.text,
                words: words(&one.hedges, Some(&one.term.text)),
                term: &one.term.text,
            });
            Row {
                conditions,
                conclusions: conclusions.collect(),
            }
        });
        json(&RuleView {
            scales: model.operators.implication == Conjunction::Product,
            rules: rows.collect(),
        })
    }

    /// The degrees of the propositions of all rules at a point, in the order of [`RuleSet::viewed`]. NaN if a
    /// proposition reads an output.
    #[wasm_bindgen(js_name = propositionDegrees)]
    pub fn proposition_degrees(&self, point: &[f64]) -> Vec<f64> {
        let model = self.engine.model();
        let mut degrees = Vec::new();
        for rule in &model.rules {
            rule.rule
                .condition
                .visit(&mut |one| degrees.push(degree(model, one, point)));
        }
        degrees
    }
}

impl<'a> Row<'a> {
    fn cell(model: &Model, one: &'a Proposition) -> Cell<'a> {
        Cell {
            variable: &one.variable.text,
            words: words(
                &one.hedges,
                one.term.as_ref().map(|term| term.text.as_str()),
            ),
            term: one.term.as_ref().map(|term| term.text.as_str()),
            curve: hedged(model, one),
        }
    }
}

fn words(hedges: &[Hedge], term: Option<&str>) -> String {
    let hedges = hedges.iter().map(|hedge| hedge.word());
    hedges.chain(term).collect::<Vec<_>>().join(" ")
}

/// The curve of a proposition with hedges.
fn hedged(model: &Model, one: &Proposition) -> Vec<f64> {
    let Some(variable) = model
        .variables()
        .find(|known| known.name == one.variable.text)
    else {
        return Vec::new();
    };
    if one.hedges.is_empty() {
        return Vec::new();
    }
    let share = |i: usize| i as f64 / (SAMPLES - 1) as f64;
    let x = |i| variable.low + share(i) * (variable.high - variable.low);
    let at = |i| [x(i), of_term(variable, one, x(i))];
    (0..SAMPLES).flat_map(at).collect()
}

fn degree(model: &Model, one: &Proposition, point: &[f64]) -> f64 {
    let mut inputs = model.inputs.iter().zip(point);
    let input = inputs.find(|(known, _)| known.name == one.variable.text);
    input.map_or(f64::NAN, |(variable, x)| {
        of_term(variable, one, x.clamp(variable.low, variable.high))
    })
}

fn of_term(variable: &fuzzy::model::Variable, one: &Proposition, x: f64) -> f64 {
    let name = one.term.as_ref().map(|term| &term.text);
    let term = variable.terms.iter().find(|term| Some(&term.name) == name);
    let degree = term.map_or(1.0, |term| term.membership(x));
    // The hedge nearest the term applies first.
    let hedges = one.hedges.iter().rev();
    hedges.fold(degree, |degree, hedge| hedge.of(degree))
}
