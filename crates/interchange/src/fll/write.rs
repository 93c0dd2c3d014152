//! Writes FLL for fuzzylite 7.

use fuzzy::{
    Findings, Model,
    model::{Defuzzifier, MembershipFunction, NoRuleFires, Output, Term, Variable},
};

use super::activation;
use crate::{
    Format, Losses, WriteResult,
    blocks::{self, Rules},
    formula,
    names::{self, NameRules},
    rules, shapes,
    text_draft::{TextDraft, numbers, one_line},
    words,
};

const NAMES: NameRules = NameRules {
    is_letter: |c| names::is_plain(c) || c == '.',
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
        "pi",
    ],
};

/// The number of samples that approximates an exact integral.
const SAMPLES: usize = 1000;

pub(crate) fn write(model: &Model, losses: Losses) -> Result<WriteResult, Findings> {
    let mut draft = TextDraft::new(Format::Fll, losses, model);
    let model = names::plain(model, &NAMES, &mut draft);
    draft.line(format!("Engine: {}", uncommented(&model.name)));
    description(&mut draft, model.description.as_deref());
    for input in &model.inputs {
        draft.line(format!("InputVariable: {}", input.name));
        variable(&mut draft, input);
        // A rule set clamps values outside the range.
        draft.line("  lock-range: true");
        for term in &input.terms {
            self::term(&mut draft, term, &model, Some(&input.name));
        }
    }
    for output in &model.outputs {
        self::output(&mut draft, output, &model);
    }
    for block in blocks::of(&model) {
        rule_block(&mut draft, &block, &model);
    }
    draft.finish()
}

fn description(draft: &mut TextDraft, text: Option<&str>) {
    if let Some(text) = text {
        draft.line(format!("  description: {}", uncommented(text)));
    }
}

/// A text on one line, without the sign that starts a comment.
fn uncommented(text: &str) -> String {
    one_line(&text.replace('#', " "))
}

fn variable(draft: &mut TextDraft, variable: &Variable) {
    description(draft, variable.description.as_deref());
    draft.line("  enabled: true");
    draft.line(format!("  range: {} {}", variable.low, variable.high));
}

fn output(draft: &mut TextDraft, output: &Output, model: &Model) {
    draft.line(format!("OutputVariable: {}", output.variable.name));
    variable(draft, &output.variable);
    draft.line(format!("  lock-range: {}", output.clamp));
    let computed = match output.defuzzifier {
        Defuzzifier::WeightedAverage | Defuzzifier::WeightedSum => Some("TakagiSugeno"),
        Defuzzifier::Tsukamoto => Some("Tsukamoto"),
        _ => None,
    };
    let aggregation = match computed {
        Some(_) => "none",
        None => draft.word(
            words::AGGREGATIONS,
            output.aggregation.unwrap_or(model.operators.aggregation),
            "the aggregation",
        ),
    };
    draft.line(format!("  aggregation: {aggregation}"));
    let word = draft.word(words::DEFUZZIFIERS, output.defuzzifier, "the defuzzifier");
    let detail = match (computed, output.samples) {
        (Some(kind), _) => kind.to_owned(),
        (None, Some(sampling)) => sampling.samples.to_string(),
        (None, None) => {
            let message = format!(
                "fuzzylite samples the output `{}` at {SAMPLES} positions",
                output.variable.name
            );
            draft.note("sampled", message, "the rule set integrates exactly");
            SAMPLES.to_string()
        }
    };
    draft.line(format!("  defuzzifier: {word} {detail}"));
    let default = match output.when_no_rule_fires {
        NoRuleFires::Value(value) | NoRuleFires::Previous(Some(value)) => value.to_string(),
        NoRuleFires::Undefined | NoRuleFires::Previous(None) => "nan".into(),
        NoRuleFires::Error => {
            let message = format!(
                "the output `{}` is nan where no rule fires, not an error",
                output.variable.name
            );
            draft.note("no-error", message, "fuzzylite has no such error");
            "nan".into()
        }
    };
    draft.line(format!("  default: {default}"));
    let keeps = matches!(output.when_no_rule_fires, NoRuleFires::Previous(_));
    draft.line(format!("  lock-previous: {keeps}"));
    // A fuzzy set is a function of its own variable.
    let own = (!words::is_weighted(output.defuzzifier)).then_some(output.variable.name.as_str());
    for term in &output.variable.terms {
        self::term(draft, term, model, own);
    }
}

fn term(draft: &mut TextDraft, term: &Term, model: &Model, own: Option<&str>) {
    use MembershipFunction as Of;
    if let Of::Function { formula } = &term.membership_function
        && term.height == 1.0
    {
        let formula = formula::write(formula, own);
        draft.line(format!("  term: {} Function {formula}", term.name));
        return;
    }
    let written = match &term.membership_function {
        Of::Piecewise { points } => {
            let flat: Vec<f64> = points.iter().flat_map(|&(x, y)| [x, y]).collect();
            Some(("Discrete", flat))
        }
        Of::Constant { value } => Some(("Constant", vec![*value])),
        Of::Linear {
            coefficients,
            constant,
        } => {
            let mut each = draft.coefficients(&term.name, coefficients, model);
            each.push(*constant);
            Some(("Linear", each))
        }
        other => shapes::write(Format::Fll, other),
    };
    let Some((shape, mut parameters)) = written else {
        let message = format!(
            "the term `{}` is a singleton among fuzzy sets, or a formula with a height",
            term.name
        );
        draft.refuse("no-shape", message, "write it as points: `piecewise`");
        return;
    };
    if term.height != 1.0 && shape != "Linear" {
        parameters.push(term.height);
    }
    draft.line(format!(
        "  term: {} {shape} {}",
        term.name,
        numbers(&parameters)
    ));
}

fn rule_block(draft: &mut TextDraft, block: &Rules<'_>, model: &Model) {
    let operators = block.operators;
    draft.line(format!("RuleBlock: {}", uncommented(block.name)));
    draft.line(format!("  enabled: {}", block.enabled));
    let [and, or, implication] = draft.operators(operators);
    draft.line(format!("  conjunction: {and}"));
    draft.line(format!("  disjunction: {or}"));
    draft.line(format!("  implication: {implication}"));
    draft.line(format!(
        "  activation: {}",
        activation::write(block.activation)
    ));
    for (number, rule) in &block.rules {
        rule.rule.condition.visit(&mut |about| {
            let name = &about.variable.text;
            if model.outputs.iter().any(|output| output.variable.name == *name) {
                let message = format!("rule {number} has a condition about the output `{name}`");
                let help = "fuzzylite uses the degrees of the rules there, not the value: write a rule set for each stage";
                draft.loss("chain", message, help);
            }
        });
        match rules::write(&rule.rule, operators, " and ") {
            Some(rules) => rules
                .iter()
                .for_each(|rule| draft.line(format!("  rule: {rule}"))),
            None => {
                let help = "fuzzylite has `not` before a term only";
                draft.leave_out(*number, "has a NOT before brackets", help);
            }
        }
    }
}
