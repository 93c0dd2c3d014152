//! Writes FLL for fuzzylite 7.

use fuzzy::{
    Findings, Model,
    model::{Defuzzifier, MembershipFunction, NoRuleFires, Output, Term, Variable},
};

use super::activation;
use crate::{
    Format, Losses, Written,
    blocks::{self, Rules},
    formula,
    names::{self, Allowed},
    paper::{Paper, numbers, one_line},
    rules, shapes, words,
};

const NAMES: Allowed = Allowed {
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

pub(crate) fn write(model: &Model, losses: Losses) -> Result<Written, Findings> {
    let mut paper = Paper::new(Format::Fll, losses, model);
    let model = names::plain(model, &NAMES, &mut paper);
    paper.line(format!("Engine: {}", uncommented(&model.name)));
    description(&mut paper, model.description.as_deref());
    for input in &model.inputs {
        paper.line(format!("InputVariable: {}", input.name));
        variable(&mut paper, input);
        // A rule set clamps values outside the range.
        paper.line("  lock-range: true");
        for term in &input.terms {
            self::term(&mut paper, term, &model, Some(&input.name));
        }
    }
    for output in &model.outputs {
        self::output(&mut paper, output, &model);
    }
    for block in blocks::of(&model) {
        rule_block(&mut paper, &block, &model);
    }
    paper.finish()
}

fn description(paper: &mut Paper, text: Option<&str>) {
    if let Some(text) = text {
        paper.line(format!("  description: {}", uncommented(text)));
    }
}

/// A text on one line, without the sign that starts a comment.
fn uncommented(text: &str) -> String {
    one_line(&text.replace('#', " "))
}

fn variable(paper: &mut Paper, variable: &Variable) {
    description(paper, variable.description.as_deref());
    paper.line("  enabled: true");
    paper.line(format!("  range: {} {}", variable.low, variable.high));
}

fn output(paper: &mut Paper, output: &Output, model: &Model) {
    paper.line(format!("OutputVariable: {}", output.variable.name));
    variable(paper, &output.variable);
    paper.line(format!("  lock-range: {}", output.clamp));
    let computed = match output.defuzzifier {
        Defuzzifier::WeightedAverage | Defuzzifier::WeightedSum => Some("TakagiSugeno"),
        Defuzzifier::Tsukamoto => Some("Tsukamoto"),
        _ => None,
    };
    let aggregation = match computed {
        Some(_) => "none",
        None => paper.word(
            words::AGGREGATIONS,
            output.aggregation.unwrap_or(model.operators.aggregation),
            "the aggregation",
        ),
    };
    paper.line(format!("  aggregation: {aggregation}"));
    let word = paper.word(words::DEFUZZIFIERS, output.defuzzifier, "the defuzzifier");
    let detail = match (computed, output.samples) {
        (Some(kind), _) => kind.to_owned(),
        (None, Some(sampling)) => sampling.samples.to_string(),
        (None, None) => {
            let message = format!(
                "fuzzylite samples the output `{}` at {SAMPLES} positions",
                output.variable.name
            );
            paper.note("sampled", message, "the rule set integrates exactly");
            SAMPLES.to_string()
        }
    };
    paper.line(format!("  defuzzifier: {word} {detail}"));
    let default = match output.when_no_rule_fires {
        NoRuleFires::Value(value) | NoRuleFires::Previous(Some(value)) => value.to_string(),
        NoRuleFires::Undefined | NoRuleFires::Previous(None) => "nan".into(),
        NoRuleFires::Error => {
            let message = format!(
                "the output `{}` is nan where no rule fires, not an error",
                output.variable.name
            );
            paper.note("no-error", message, "fuzzylite has no such error");
            "nan".into()
        }
    };
    paper.line(format!("  default: {default}"));
    let keeps = matches!(output.when_no_rule_fires, NoRuleFires::Previous(_));
    paper.line(format!("  lock-previous: {keeps}"));
    // A fuzzy set is a function of its own variable.
    let own = (!words::is_weighted(output.defuzzifier)).then_some(output.variable.name.as_str());
    for term in &output.variable.terms {
        self::term(paper, term, model, own);
    }
}

fn term(paper: &mut Paper, term: &Term, model: &Model, own: Option<&str>) {
    use MembershipFunction as Of;
    if let Of::Function { formula } = &term.membership_function
        && term.height == 1.0
    {
        let formula = formula::write(formula, own);
        paper.line(format!("  term: {} Function {formula}", term.name));
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
            let mut each = paper.coefficients(&term.name, coefficients, model);
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
        paper.refuse("no-shape", message, "write it as points: `piecewise`");
        return;
    };
    if term.height != 1.0 && shape != "Linear" {
        parameters.push(term.height);
    }
    paper.line(format!(
        "  term: {} {shape} {}",
        term.name,
        numbers(&parameters)
    ));
}

fn rule_block(paper: &mut Paper, block: &Rules<'_>, model: &Model) {
    let operators = block.operators;
    paper.line(format!("RuleBlock: {}", uncommented(block.name)));
    paper.line(format!("  enabled: {}", block.enabled));
    let [and, or, implication] = paper.operators(operators);
    paper.line(format!("  conjunction: {and}"));
    paper.line(format!("  disjunction: {or}"));
    paper.line(format!("  implication: {implication}"));
    paper.line(format!(
        "  activation: {}",
        activation::write(block.activation)
    ));
    for (number, rule) in &block.rules {
        rule.rule.condition.visit(&mut |about| {
            let name = &about.variable.text;
            if model.outputs.iter().any(|output| output.variable.name == *name) {
                let message = format!("rule {number} has a condition about the output `{name}`");
                let help = "fuzzylite uses the degrees of the rules there, not the value: write a rule set for each stage";
                paper.loss("chain", message, help);
            }
        });
        match rules::write(&rule.rule, operators, " and ") {
            Some(rules) => rules
                .iter()
                .for_each(|rule| paper.line(format!("  rule: {rule}"))),
            None => {
                let help = "fuzzylite has `not` before a term only";
                paper.leave_out(*number, "has a NOT before brackets", help);
            }
        }
    }
}
