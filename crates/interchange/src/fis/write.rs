//! Writes FIS for MATLAB.

use fuzzy::{
    Findings, Model,
    model::{Activation, Defuzzifier, MembershipFunction, NoRuleFires, Rule, Term, Variable},
    rule::{Condition, Hedge, Name},
};

use super::type2;
use crate::{
    Format, Losses, WriteResult, conditions,
    names::{self, NameRules},
    shapes,
    text_draft::{TextDraft, named, numbers, one_line},
    words,
};

/// The names that can be written. Quotes would end a name, and a `:` separates a name from what follows.
const NAMES: NameRules = NameRules {
    is_letter: |c| words::is_printable(c) && !matches!(c, '\'' | '"' | ':'),
    is_first: words::is_printable,
    keywords: &[],
};

pub(crate) fn write(model: &Model, losses: Losses) -> Result<WriteResult, Findings> {
    let mut draft = TextDraft::new(Format::Fis, losses, model);
    let model = &names::plain(model, &NAMES, &mut draft);
    system(&mut draft, model);
    for (index, input) in model.inputs.iter().enumerate() {
        draft.line(format!("\n[Input{}]", index + 1));
        variable(&mut draft, input, model);
    }
    for (index, output) in model.outputs.iter().enumerate() {
        draft.line(format!("\n[Output{}]", index + 1));
        variable(&mut draft, &output.variable, model);
        let name = &output.variable.name;
        if !matches!(
            output.when_no_rule_fires,
            NoRuleFires::Undefined | NoRuleFires::Error
        ) {
            let message =
                format!("`{name}` has a value if no rule fires, which FIS cannot express");
            draft.loss(
                "no-rule-fires",
                message,
                "MATLAB gives the middle of the range",
            );
        }
        if output.clamp || output.aggregation.is_some() {
            let message = format!("`{name}` is clamped, or has an aggregation of its own");
            draft.loss(
                "own",
                message,
                "FIS has one aggregation for all outputs, and does not clamp",
            );
        }
        if output.samples.is_some() {
            let message = format!("the output `{name}` is sampled, which FIS cannot express");
            draft.note(
                "sampled",
                message,
                "MATLAB samples 101 positions by default",
            );
        }
    }
    if !model.blocks.is_empty() || model.activation != Activation::General {
        let message =
            "the rules are in blocks, or an activation method selects those that fire".into();
        draft.loss(
            "blocks",
            message,
            "FIS has no blocks and no activation methods",
        );
    }
    draft.line("\n[Rules]");
    let is_type2 = model.has_type2_terms();
    for (index, rule) in model.rules.iter().enumerate() {
        if is_type2 && let Some(what) = type2::unsupported(rule, Some(model.inputs.len())) {
            let help =
                "a rule of a type-2 system joins one term of every input by AND, without a weight";
            draft.leave_out(index + 1, what, help);
            continue;
        }
        match line(rule, model) {
            Ok(line) => draft.line(line),
            Err(what) => {
                let help = match what {
                    READS_OUTPUT => "write a rule set for each output: FIS has no stages",
                    _ => {
                        "a rule of FIS joins one term of each input, either all by AND or all by OR"
                    }
                };
                draft.leave_out(index + 1, what, help);
            }
        }
    }
    draft.finish()
}

fn system(draft: &mut TextDraft, model: &Model) {
    let first = model
        .outputs
        .first()
        .map_or(Defuzzifier::Centroid, |output| output.defuzzifier);
    let weighted = words::is_weighted(first);
    let mut others = model.outputs.iter().map(|output| output.defuzzifier);
    if others.clone().any(|other| other != first) {
        let message = "the outputs have different defuzzifiers".into();
        let help = "write a rule set for each output";
        match others.any(|other| words::is_weighted(other) != weighted) {
            true => draft.refuse("two-defuzzifiers", message, help),
            false => draft.loss("two-defuzzifiers", message, help),
        }
    }
    let operators = model.operators;
    let quoted = |text: &str| format!("'{}'", one_line(&text.replace('\'', "")));
    if let Some(description) = &model.description {
        draft.line(format!("% {}", one_line(description)));
    }
    draft.line("[System]");
    draft.line(format!("Name={}", quoted(&model.name)));
    draft.line(format!(
        "Type='{}'",
        if weighted { "sugeno" } else { "mamdani" }
    ));
    draft.line("Version=2.0");
    draft.line(format!("NumInputs={}", model.inputs.len()));
    draft.line(format!("NumOutputs={}", model.outputs.len()));
    let is_type2 = model.has_type2_terms();
    let rules = model.rules.iter().filter(|rule| {
        let inputs = Some(model.inputs.len());
        let is_supported = !is_type2 || type2::unsupported(rule, inputs).is_none();
        is_supported && line(rule, model).is_ok()
    });
    draft.line(format!("NumRules={}", rules.count()));
    let [and, or, implication] = draft.operators(operators);
    let aggregation = draft.word(
        words::AGGREGATIONS,
        operators.aggregation,
        "the aggregation",
    );
    draft.line(format!("AndMethod='{and}'"));
    draft.line(format!("OrMethod='{or}'"));
    draft.line(format!(
        "ImpMethod='{}'",
        if weighted { "prod" } else { implication }
    ));
    draft.line(format!(
        "AggMethod='{}'",
        if weighted { "sum" } else { aggregation }
    ));
    let defuzzifier = draft.word(words::DEFUZZIFIERS, first, "the defuzzifier");
    let outputs = &model.outputs;
    if outputs
        .iter()
        .any(|output| output.defuzzifier == Defuzzifier::Tsukamoto)
    {
        let message = "FIS has no word for the defuzzifier `tsukamoto`".into();
        let help = "no method of a Sugeno system takes fuzzy sets as terms of its outputs";
        draft.refuse("no-word", message, help);
    }
    draft.line(format!("DefuzzMethod='{defuzzifier}'"));
    if is_type2 {
        let method = type2::method(draft, model);
        draft.line(format!("TypeRedMethod='{method}'"));
    }
    let known = ["min", "max", "prod", "probor", "sum"];
    for word in [and, or, implication, aggregation] {
        if !known.contains(&word) {
            let message = format!("MATLAB has no method `{word}`");
            draft.note("not-in-matlab", message, "Octave and fuzzylite read it");
        }
    }
}

fn variable(draft: &mut TextDraft, variable: &Variable, model: &Model) {
    draft.line(format!("Name='{}'", variable.name));
    draft.line(format!("Range=[{} {}]", variable.low, variable.high));
    draft.line(format!("NumMFs={}", variable.terms.len()));
    let is_type2 = model.has_type2_terms();
    for (index, term) in variable.terms.iter().enumerate() {
        let (number, name) = (index + 1, &term.name);
        if is_type2 && !type2::is_number(term) {
            for (letter, bound) in type2::pair(term) {
                let Some((shape, mut parameters)) = shape(draft, &bound, variable, model) else {
                    continue;
                };
                type2::check_shape(draft, shape, term, variable);
                parameters.push(bound.height);
                let parameters = numbers(&parameters);
                draft.line(format!(
                    "MF{number}{letter}='{name}{letter}':'{shape}',[{parameters}]"
                ));
            }
            continue;
        }
        let Some((shape, mut parameters)) = shape(draft, term, variable, model) else {
            continue;
        };
        if is_type2 {
            parameters.extend_from_within(..);
        }
        let parameters = numbers(&parameters);
        draft.line(format!("MF{number}='{name}':'{shape}',[{parameters}]"));
    }
}

fn shape(
    draft: &mut TextDraft,
    term: &Term,
    variable: &Variable,
    model: &Model,
) -> Option<(&'static str, Vec<f64>)> {
    use MembershipFunction as Of;
    let name = named(term, variable);
    if term.height != 1.0 && !model.has_type2_terms() {
        let message = format!("the term {name} has the height {}", term.height);
        draft.loss("height", message, "terms of FIS have the height 1");
    }
    // A shape that MATLAB lacks is replaced by one that is equal within the range. Octave does not accept flanks of
    // width 0.
    let width = variable.high - variable.low;
    let written = match term.membership_function {
        Of::LeftShoulder { top, foot } => {
            let left = variable.low.min(top);
            Some(("trapmf", vec![left - width, left, top, foot]))
        }
        Of::RightShoulder { foot, top } => {
            let right = variable.high.max(top);
            Some(("trapmf", vec![foot, top, right, right + width]))
        }
        Of::Rectangle { left, right } => Some(("trapmf", vec![left, left, right, right])),
        Of::Constant { value } => Some(("constant", vec![value])),
        Of::Linear {
            ref coefficients,
            constant,
        } => {
            let mut each = draft.coefficients(&term.name, coefficients, model);
            each.push(constant);
            Some(("linear", each))
        }
        Of::Piecewise { ref points } => Some((
            "discretemf",
            points.iter().flat_map(|&(x, y)| [x, y]).collect(),
        )),
        ref other => shapes::write(Format::Fis, other),
    };
    match written {
        None => {
            let message = format!("the term {name} has a shape that FIS does not support");
            draft.refuse("no-shape", message, "write it as points: `piecewise`");
        }
        Some((shape @ ("discretemf" | "cosinemf" | "spikemf" | "concavemf"), _)) => {
            let message = format!("MATLAB has no shape `{shape}`, of the term {name}");
            draft.note("not-in-matlab", message, "fuzzylite reads it");
        }
        Some(_) => {}
    }
    written
}

/// The reason why a rule with a condition about an output cannot be written.
const READS_OUTPUT: &str = "has a condition about an output";

/// Writes a rule: `1 -2, 3 (0.5) : 1`.
fn line(rule: &Rule, model: &Model) -> Result<String, &'static str> {
    let rule = &rule.rule;
    let condition = conditions::without_not(&rule.condition, model.operators);
    let condition = condition.ok_or("has a NOT before brackets")?;
    let (parts, connective) = match &condition {
        Condition::And(parts) => (parts.as_slice(), 1),
        Condition::Or(parts) => (parts.as_slice(), 2),
        one => (std::slice::from_ref(one), 1),
    };
    let mut inputs = vec![0_i64; model.inputs.len()];
    for part in parts {
        let Condition::Is(proposition) = part else {
            return Err("joins AND and OR");
        };
        let sign = match proposition.hedges[..] {
            [] => 1,
            [Hedge::Not] => -1,
            _ => return Err("has a hedge other than NOT"),
        };
        let index = model
            .inputs
            .iter()
            .position(|input| input.name == proposition.variable.text);
        let index = index.ok_or(READS_OUTPUT)?;
        let variable = model.inputs.get(index).ok_or("names no input")?;
        let number = inputs.get_mut(index).ok_or("names no input")?;
        if *number != 0 {
            return Err("names an input twice");
        }
        let term = proposition.term.as_ref().ok_or("names no term")?;
        *number = sign * number_of(variable, term)?;
    }
    let mut outputs = vec![0_i64; model.outputs.len()];
    for consequent in &rule.consequents {
        if !consequent.hedges.is_empty() {
            return Err("has a hedge in its conclusion");
        }
        let is = |output: &fuzzy::model::Output| output.variable.name == consequent.output.text;
        let index = model.outputs.iter().position(is).ok_or("names no output")?;
        let output = model.outputs.get(index).ok_or("names no output")?;
        let number = outputs.get_mut(index).ok_or("names no output")?;
        if *number != 0 {
            return Err("concludes two terms of one output");
        }
        *number = number_of(&output.variable, &consequent.term)?;
    }
    let joined = |numbers: &[i64]| {
        numbers
            .iter()
            .map(i64::to_string)
            .collect::<Vec<_>>()
            .join(" ")
    };
    Ok(format!(
        "{}, {} ({}) : {connective}",
        joined(&inputs),
        joined(&outputs),
        rule.weight
    ))
}

/// The number of a term, from 1.
fn number_of(variable: &Variable, term: &Name) -> Result<i64, &'static str> {
    let index = variable
        .terms
        .iter()
        .position(|known| known.name == term.text);
    index.map(|index| index as i64 + 1).ok_or("names no term")
}
