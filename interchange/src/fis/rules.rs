//! Rules of FIS: `1 -2, 3 (0.5) : 1`: a term's number for each input, a comma, one for each output, the weight, and 1 for AND
//! or 2 for OR. A negative number is NOT, 0 leaves the variable out.

use fuzzy::{
    format::RuleSpans,
    model::{Rule, Variable},
    rule::{self, Condition, Consequent, Hedge, Name, Proposition},
};

use crate::draft::Draft;

/// Reads a rule into the model.
pub(super) fn read(draft: &mut Draft<'_>, line: &str) {
    let Some(parts) = parts(line) else {
        let message = format!("`{line}` is no rule");
        let help = "with two inputs and one output a rule reads `1 2, 1 (1) : 1`";
        draft.error("rule-syntax", line, message, help);
        return;
    };
    let (inputs, outputs) = (draft.model.inputs.len(), draft.model.outputs.len());
    if parts.inputs.len() != inputs || parts.outputs.len() != outputs {
        let message = format!(
            "the rule has {} and {} numbers for {inputs} inputs and {outputs} outputs",
            parts.inputs.len(),
            parts.outputs.len()
        );
        let help = "write a number for each variable, 0 where it does not count";
        draft.error("rule-syntax", line, message, help);
        return;
    }
    let Some(weight) = draft.number(parts.weight) else {
        return;
    };
    let mut conditions = vec![];
    for (index, word) in parts.inputs.iter().enumerate() {
        match proposition(draft, word, |draft| draft.model.inputs.get(index).cloned()) {
            Ok(Some(proposition)) => conditions.push(Condition::Is(proposition)),
            Ok(None) => {}
            Err(()) => return,
        }
    }
    let mut consequents = vec![];
    for (index, word) in parts.outputs.iter().enumerate() {
        let output = |draft: &Draft<'_>| Some(draft.model.outputs.get(index)?.variable.clone());
        match proposition(draft, word, output) {
            Ok(Some(Proposition {
                variable,
                hedges,
                term: Some(term),
            })) => {
                if let Some(hedge) = hedges.first() {
                    let message = format!("a hedge, `{}`, stands in a conclusion", hedge.word());
                    draft.loss(
                        "hedge-in-conclusion",
                        word,
                        message,
                        "conclude a term of its own",
                    );
                }
                consequents.push(Consequent {
                    output: variable,
                    hedges: vec![],
                    term,
                });
            }
            Ok(_) => {}
            Err(()) => return,
        }
    }
    if consequents.is_empty() {
        draft.warning(
            "no-conclusion",
            line,
            "the rule concludes nothing".into(),
            "it is left out",
        );
        return;
    }
    let condition = match (conditions.len(), parts.connective) {
        (0, _) => {
            let message = "the rule has no condition".into();
            draft.error(
                "rule-syntax",
                line,
                message,
                "name the term of one input at least",
            );
            return;
        }
        (1, _) => conditions.remove(0),
        (_, "1") => Condition::And(conditions),
        (_, "2") => Condition::Or(conditions),
        (_, other) => {
            let message = format!("`{other}` is no connective");
            draft.error(
                "rule-syntax",
                parts.connective,
                message,
                "1 is AND, 2 is OR",
            );
            return;
        }
    };
    let mut spans = RuleSpans::default();
    spans.whole = draft.span(line);
    draft.spans.rules.push(spans);
    let rule = rule::Rule {
        condition,
        consequents,
        weight,
    };
    draft.model.rules.push(Rule::from(rule));
}

struct Parts<'t> {
    inputs: Vec<&'t str>,
    outputs: Vec<&'t str>,
    weight: &'t str,
    connective: &'t str,
}

fn parts(line: &str) -> Option<Parts<'_>> {
    let (inputs, rest) = line.split_once(',')?;
    let (outputs, rest) = rest.split_once('(')?;
    let (weight, rest) = rest.split_once(')')?;
    let connective = rest.trim().strip_prefix(':')?.trim();
    Some(Parts {
        inputs: inputs.split_whitespace().collect(),
        outputs: outputs.split_whitespace().collect(),
        weight: weight.trim(),
        connective,
    })
}

/// The proposition of a number: of `-2.3` the second term, hedged with NOT and Octave's third hedge; `None` of 0.
fn proposition(
    draft: &mut Draft<'_>,
    word: &str,
    variable: impl Fn(&Draft<'_>) -> Option<Variable>,
) -> Result<Option<Proposition>, ()> {
    let number = draft.number(word).ok_or(())?;
    let index = number.abs().trunc();
    if index == 0.0 {
        return Ok(None);
    }
    let variable = variable(draft).ok_or(())?;
    let Some(term) = variable.terms.get(index as usize - 1) else {
        let count = variable.terms.len();
        let message = format!("`{}` has no term {index}", variable.name);
        draft.error(
            "unknown-term",
            word,
            message,
            &format!("it has {count} terms"),
        );
        return Err(());
    };
    let mut hedges = vec![];
    if number < 0.0 {
        hedges.push(Hedge::Not);
    }
    let fraction = ((number.abs() - index) * 100.0).round();
    hedges.extend(octave(draft, word, fraction)?);
    let name = |text: &str, span| Name {
        text: text.to_owned(),
        span,
    };
    let span = draft.span(word);
    Ok(Some(Proposition {
        variable: name(&variable.name, span.clone()),
        hedges,
        term: Some(name(&term.name, span)),
    }))
}

/// The hedges of Octave's toolkit, the digits behind the point, in hundredths. Its `extremely` is a cube.
fn octave(draft: &mut Draft<'_>, word: &str, hundredths: f64) -> Result<Vec<Hedge>, ()> {
    match hundredths as i64 {
        0 => Ok(vec![]),
        5 => Ok(vec![Hedge::Somewhat]),
        20 => Ok(vec![Hedge::Very]),
        40 => Ok(vec![Hedge::Very, Hedge::Very]),
        30 => {
            let message = format!("`{word}` has Octave's hedge `extremely`, the cube");
            let help = "there is no such hedge; `very very` is the fourth power";
            draft.loss("unknown-hedge", word, message, help);
            Ok(vec![Hedge::Extremely])
        }
        _ => {
            let message = format!("`{word}` has an unknown hedge");
            let help = "known are .05 somewhat, .2 very, .4 very very";
            draft.error("unknown-hedge", word, message, help);
            Err(())
        }
    }
}
