//! Conversion of a model to a tree, in the short notations where possible.

use alloc::{string::String, vec::Vec};

use super::{
    VERSION, allow, blocks, provenance, rules, shapes,
    words::{self, AGGREGATIONS, DEFUZZIFIERS, TYPE_REDUCTIONS, word_of},
};
use crate::{
    model::{
        Activation, MIN_STRENGTH, MembershipFunction, Model, NoRuleFires, Output, SamplingRule,
        TypeReduction, Variable, even_peaks,
    },
    tree::Node,
};

type Entries = Vec<(&'static str, Node)>;

pub(super) fn model(model: &Model) -> Node {
    let mut entries: Entries = Vec::from([
        ("fuzzy", Node::number(VERSION as f64)),
        ("name", Node::text(model.name.as_str())),
    ]);
    entries.extend(description(model.description.as_deref()));
    let inputs = model.inputs.iter();
    let inputs = inputs.map(|input| (input.name.as_str(), Node::mapping(variable(input))));
    entries.push(("inputs", Node::mapping(inputs)));
    let outputs = model.outputs.iter();
    let outputs = outputs.map(|o| (o.variable.name.as_str(), output(o)));
    entries.push(("outputs", Node::mapping(outputs)));
    entries.push(("operators", Node::mapping(words::written(model.operators))));
    if model.activation != Activation::General {
        entries.push(("activation", blocks::write_activation(model.activation)));
    }
    if model.least_strength != MIN_STRENGTH {
        entries.push(("least_strength", Node::number(model.least_strength)));
    }
    if model.blocks.is_empty() {
        let rules = model.rules.iter().map(rules::write);
        entries.push(("rules", Node::list(rules.collect())));
    } else {
        entries.push(("blocks", blocks::write(model)));
    }
    entries.extend(allow::write(&model.allow).map(|allowed| ("allow", allowed)));
    entries.extend(provenance::write(&model.provenance).map(|steps| ("provenance", steps)));
    Node::mapping(entries)
}

fn description(text: Option<&str>) -> Option<(&'static str, Node)> {
    text.map(|text| ("description", Node::text(text)))
}

fn variable(variable: &Variable) -> Entries {
    let mut entries: Entries = Vec::new();
    entries.extend(description(variable.description.as_deref()));
    entries.extend(variable.unit.as_deref().map(|u| ("unit", Node::text(u))));
    let range = [variable.low, variable.high].map(Node::number);
    entries.push(("range", Node::list(range.into())));
    entries.push(terms(variable));
    entries
}

fn output(output: &Output) -> Node {
    let mut entries = variable(&output.variable);
    let defuzzifier = word_of(&DEFUZZIFIERS, output.defuzzifier);
    entries.push(("defuzzifier", Node::text(defuzzifier)));
    if let Some(sampling) = output.samples {
        let rule = match sampling.rule {
            SamplingRule::Midpoint => "midpoint",
            SamplingRule::Trapezoid => "trapezoid",
        };
        let samples = Node::number(sampling.samples as f64);
        entries.push(("samples", Node::mapping([(rule, samples)])));
    }
    let otherwise = match output.when_no_rule_fires {
        NoRuleFires::Undefined => Node::text("undefined"),
        NoRuleFires::Error => Node::text("error"),
        NoRuleFires::Value(value) => Node::mapping([("value", Node::number(value))]),
        NoRuleFires::Previous(None) => Node::text("previous"),
        NoRuleFires::Previous(Some(value)) => Node::mapping([("previous", Node::number(value))]),
    };
    entries.push(("when_no_rule_fires", otherwise));
    if let Some(aggregation) = output.aggregation {
        let word = word_of(&AGGREGATIONS, aggregation);
        entries.push(("aggregation", Node::text(word)));
    }
    if output.clamp {
        entries.push(("clamp", Node::scalar("true".into(), false)));
    }
    if output.type_reduction != TypeReduction::Exact {
        let word = word_of(&TYPE_REDUCTIONS, output.type_reduction);
        entries.push(("type_reduction", Node::text(word)));
    }
    Node::mapping(entries)
}

fn function(membership_function: &MembershipFunction, height: f64) -> Node {
    let (shape, parameters) = shapes::write(membership_function);
    let mut entries: Entries = Vec::from([(shape, parameters)]);
    if height != 1.0 {
        entries.push(("height", Node::number(height)));
    }
    Node::mapping(entries)
}

/// Returns the key and the value for the terms of a variable: a partition or steps if the terms have such a form,
/// otherwise a mapping of the terms.
fn terms(variable: &Variable) -> (&'static str, Node) {
    let terms = &variable.terms;
    let names = || terms.iter().map(|term| term.name.as_str());
    if let Some(limits) = variable.step_limits() {
        let limits = limits.into_iter().map(Node::number);
        let limits = limits.chain([Node::scalar(String::new(), false)]);
        return ("steps", Node::mapping(names().zip(limits)));
    }
    let Some(peaks) = variable.partition_peaks() else {
        let terms = terms.iter().map(|term| {
            let upper = function(&term.membership_function, term.height);
            let term_node = match &term.lower {
                None => upper,
                Some(lower) => {
                    let lower = function(&lower.membership_function, lower.height);
                    Node::mapping([("upper", upper), ("lower", lower)])
                }
            };
            (term.name.as_str(), term_node)
        });
        return ("terms", Node::mapping(terms));
    };
    let is_even = even_peaks(variable.low, variable.high, terms.len()).eq(peaks.iter().copied());
    let partition = if is_even {
        Node::list(names().map(Node::text).collect())
    } else {
        Node::mapping(names().zip(peaks.iter().copied().map(Node::number)))
    };
    ("partition", partition)
}
