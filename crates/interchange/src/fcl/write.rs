//! Writes FCL: points and numbers as in IEC 61131-7, curves with the names of jFuzzyLogic.

use fuzzy::{
    Findings, Model,
    model::{
        Activation, Aggregation, Defuzzifier, MembershipFunction, NoRuleFires, Output, Term,
        Variable,
    },
};

use crate::{
    Format, Losses, WriteResult,
    blocks::{self, Rules},
    formula,
    names::{self, NameRules},
    rules, shapes,
    text_draft::{TextDraft, named, numbers, one_line},
    words,
};

const NAMES: NameRules = NameRules {
    is_letter: names::is_plain,
    is_first: names::is_plain_first,
    keywords: &[
        "if",
        "is",
        "then",
        "and",
        "or",
        "with",
        "not",
        "any",
        "very",
        "somewhat",
        "seldom",
        "extremely",
        "real",
        "term",
        "rule",
        "range",
        "method",
        "default",
        "act",
        "accu",
        "nc",
        "cogs",
        "cogss",
        "function",
        "pi",
        "var",
        "options",
        "var_input",
        "var_output",
        "fuzzify",
        "defuzzify",
        "ruleblock",
        "function_block",
        "end_var",
        "end_options",
        "end_fuzzify",
        "end_defuzzify",
        "end_ruleblock",
        "end_function_block",
    ],
};

pub(crate) fn write(model: &Model, losses: Losses) -> Result<WriteResult, Findings> {
    let mut draft = TextDraft::new(Format::Fcl, losses, model);
    let model = names::plain(model, &NAMES, &mut draft);
    let name = names::one(&model.name, &NAMES, &mut draft);
    if let Some(description) = &model.description {
        draft.line(format!(
            "(* {} *)",
            one_line(&description.replace("*)", ""))
        ));
    }
    draft.line(format!("FUNCTION_BLOCK {name}\n\nVAR_INPUT"));
    for input in &model.inputs {
        draft.line(format!("  {} : REAL;", input.name));
    }
    draft.line("END_VAR\n\nVAR_OUTPUT");
    for output in &model.outputs {
        draft.line(format!("  {} : REAL;", output.variable.name));
    }
    draft.line("END_VAR");
    for input in &model.inputs {
        draft.line(format!("\nFUZZIFY {}", input.name));
        terms(&mut draft, input, false);
        draft.line("END_FUZZIFY");
    }
    for output in &model.outputs {
        let name = &output.variable.name;
        draft.line(format!("\nDEFUZZIFY {name}"));
        let computes = words::is_weighted(output.defuzzifier);
        match output.defuzzifier {
            Defuzzifier::WeightedAverage => terms(&mut draft, &widened(output), computes),
            _ => terms(&mut draft, &output.variable, computes),
        }
        let word = draft.word(words::DEFUZZIFIERS, output.defuzzifier, "the defuzzifier");
        draft.line(format!("  METHOD : {word};"));
        // Each rule contributes its computed value with its own weight. In FCL, this corresponds to `ACCU : SUM`.
        let aggregation = match computes {
            true => Aggregation::Sum,
            false => output.aggregation.unwrap_or(model.operators.aggregation),
        };
        let word = draft.word(words::AGGREGATIONS, aggregation, "the aggregation");
        draft.line(format!("  ACCU : {word};"));
        match output.when_no_rule_fires {
            NoRuleFires::Value(value) => draft.line(format!("  DEFAULT := {value};")),
            NoRuleFires::Previous(None) => draft.line("  DEFAULT := NC;"),
            NoRuleFires::Previous(Some(_)) => {
                let message =
                    format!("`{name}` keeps its previous value, and has an initial value");
                draft.loss(
                    "no-rule-fires",
                    message,
                    "FCL supports either `NC` or a value",
                );
            }
            NoRuleFires::Undefined | NoRuleFires::Error => {}
        }
        if output.clamp {
            let message = format!("`{name}` is clamped to its range");
            draft.loss("clamp", message, "FCL does not clamp");
        }
        draft.line("END_DEFUZZIFY");
        if output.samples.is_some() {
            let message = format!("the output `{name}` is sampled, which FCL cannot express");
            draft.note("sampled", message, "each program samples in its own way");
        }
    }
    let mut number = 0;
    for block in blocks::of(&model) {
        rule_block(&mut draft, &block, &mut number);
    }
    draft.line("\nEND_FUNCTION_BLOCK");
    draft.finish()
}

/// Returns the output with a range that contains all numbers of its terms, because the centroid of
/// `COGS` ignores numbers outside the range.
fn widened(output: &Output) -> Variable {
    let mut variable = output.variable.clone();
    for term in &output.variable.terms {
        if let MembershipFunction::Singleton { at } | MembershipFunction::Constant { value: at } =
            term.membership_function
        {
            (variable.low, variable.high) = (variable.low.min(at), variable.high.max(at));
        }
    }
    variable
}

/// Writes the range and the terms. If an output `computes` values, a constant is a value, otherwise a degree.
fn terms(draft: &mut TextDraft, variable: &Variable, computes: bool) {
    draft.line(format!(
        "  RANGE := ({} .. {});",
        variable.low, variable.high
    ));
    for term in &variable.terms {
        if let Some(shape) = shape(draft, term, variable, computes) {
            draft.line(format!("  TERM {} := {shape};", term.name));
        }
    }
}

fn shape(
    draft: &mut TextDraft,
    term: &Term,
    variable: &Variable,
    computes: bool,
) -> Option<String> {
    use MembershipFunction as Of;
    let height = term.height;
    let points = |points: &[(f64, f64)]| {
        let written = points
            .iter()
            .map(|&(x, y)| format!("({x}, {})", y * height));
        Some(written.collect::<Vec<_>>().join(" "))
    };
    match term.membership_function {
        Of::Triangle { left, peak, right } => {
            points(&edges(&[(left, 0.0), (peak, 1.0), (right, 0.0)]))
        }
        Of::Trapezoid {
            left,
            left_top,
            right_top,
            right,
        } => points(&edges(&[
            (left, 0.0),
            (left_top, 1.0),
            (right_top, 1.0),
            (right, 0.0),
        ])),
        Of::LeftShoulder { top, foot } => points(&[(top, 1.0), (foot, 0.0)]),
        Of::RightShoulder { foot, top } => points(&[(foot, 0.0), (top, 1.0)]),
        Of::Rectangle { left, right } => {
            points(&[(left, 0.0), (left, 1.0), (right, 1.0), (right, 0.0)])
        }
        Of::Piecewise { points: ref all } => points(all),
        Of::Constant { value } if !computes => {
            points(&[(variable.low, value), (variable.high, value)])
        }
        Of::Singleton { at } | Of::Constant { value: at } if computes || height == 1.0 => {
            Some(at.to_string())
        }
        Of::Function { ref formula } if height == 1.0 => {
            function(draft, term, variable);
            Some(format!("FUNCTION {}", formula::write(formula, None)))
        }
        Of::Linear {
            ref coefficients,
            constant,
        } => {
            function(draft, term, variable);
            Some(format!("FUNCTION {}", linear(coefficients, constant)))
        }
        ref other => {
            let name = named(term, variable);
            let written = shapes::write(Format::Fcl, other).or_else(|| {
                let written = shapes::write(Format::Fll, other)?;
                let message = format!(
                    "only fuzzylite reads the shape `{}`, of the term {name}",
                    written.0
                );
                draft.note("not-in-iec", message, "write it as points: `piecewise`");
                Some(written)
            });
            let help = "write it as points: `piecewise`";
            if written.is_none() {
                let message = format!("the term {name} has a shape that FCL does not support");
                draft.refuse("no-shape", message, help);
            } else if height != 1.0 {
                let message = format!("the term {name} has a height, which FCL does not support");
                draft.loss("no-shape", message, help);
            }
            written.map(|(shape, parameters)| format!("{shape} {}", numbers(&parameters)))
        }
    }
}

/// Notes that a term is a function, which IEC 61131-7 does not define.
fn function(draft: &mut TextDraft, term: &Term, variable: &Variable) {
    let name = named(term, variable);
    let message = format!("the term {name} is a function, which IEC 61131-7 does not define");
    let help = "jFuzzyLogic reads it in outputs with `COGS`";
    draft.note("not-in-iec", message, help);
}

/// Writes a linear function: `0.5 * food - 2 * service + 3`.
fn linear(coefficients: &[(String, f64)], constant: f64) -> String {
    let mut text = String::new();
    let products = coefficients
        .iter()
        .map(|(input, by)| (*by, format!(" * {input}")));
    for (by, what) in products.chain([(constant, String::new())]) {
        let (sign, size) = match (text.is_empty(), by < 0.0) {
            (true, false) => ("", by),
            (true, true) => ("0 - ", -by),
            (false, false) => (" + ", by),
            (false, true) => (" - ", -by),
        };
        text += &format!("{sign}{size}{what}");
    }
    text
}

/// Removes repeated points with the same position and height, as in a triangle whose peak is at one of its ends.
fn edges(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let mut points = points.to_vec();
    points.dedup();
    points
}

fn rule_block(draft: &mut TextDraft, block: &Rules<'_>, number: &mut usize) {
    let operators = block.operators;
    if !block.enabled {
        return;
    }
    if block.activation != Activation::General {
        let message = format!(
            "the activation method of `{}` selects the rules that fire",
            block.name
        );
        draft.loss("activation", message, "FCL has no activation methods");
    }
    let [and, or, implication] = draft.operators(operators);
    let name = names::one(block.name, &NAMES, draft);
    draft.line(format!(
        "\nRULEBLOCK {name}\n  AND : {and};\n  OR : {or};\n  ACT : {implication};"
    ));
    for (index, rule) in &block.rules {
        match rules::write(&rule.rule, operators, ", ") {
            Some(rules) => {
                for rule in rules {
                    *number += 1;
                    draft.line(format!("  RULE {number} : {};", keywords(&rule)));
                }
            }
            None => {
                draft.leave_out(
                    *index,
                    "has a NOT before brackets",
                    "write NOT before the terms",
                );
            }
        }
    }
    draft.line("END_RULEBLOCK");
}

/// Returns a rule with its keywords in capitals, as IEC 61131-7 writes them.
fn keywords(rule: &str) -> String {
    let words = rule.split(' ').map(|word| match word {
        "if" | "is" | "and" | "or" | "then" | "with" | "not" => word.to_ascii_uppercase(),
        _ => word.to_owned(),
    });
    words.collect::<Vec<_>>().join(" ")
}
