//! Reads rules of FIS, such as `1 -2, 3 (0.5) : 1`: the number of a term for each input, a comma, the number of a term
//! for each output, the weight, and 1 for AND or 2 for OR. A negative number means NOT, 0 omits the variable.

use fuzzy::{
    format::RuleSpans,
    model::{Conjunction, Model, Rule, Variable},
    rule::{self, Condition, Consequent, Hedge, Name, Proposition},
};

use crate::model_draft::ModelDraft;

/// Formats a count with its noun: `1 rule`, `2 rules`.
pub(super) fn counted(count: usize, noun: &str) -> String {
    match count {
        1 => format!("1 {noun}"),
        _ => format!("{count} {noun}s"),
    }
}

/// Reads a rule into the model.
pub(super) fn read(draft: &mut ModelDraft<'_>, line: &str) {
    let Some(parts) = parts(line) else {
        let message = format!("`{line}` is not a rule");
        let help = "with two inputs and one output a rule reads `1 2, 1 (1) : 1`";
        draft.error("rule-syntax", line, message, help);
        return;
    };
    let (inputs, outputs) = (draft.model.inputs.len(), draft.model.outputs.len());
    if parts.inputs.len() != inputs || parts.outputs.len() != outputs {
        let message = format!(
            "the rule has {} for inputs and {} for outputs, but the file has {} and {}",
            counted(parts.inputs.len(), "number"),
            counted(parts.outputs.len(), "number"),
            counted(inputs, "input"),
            counted(outputs, "output")
        );
        let help = "write a number for each variable, 0 for a variable that the rule does not use";
        draft.error("rule-syntax", line, message, help);
        return;
    }
    let Some(weight) = draft.number(parts.weight) else {
        return;
    };
    let mut conditions = vec![];
    for (index, word) in parts.inputs.iter().enumerate() {
        match proposition(draft, word, |model| model.inputs.get(index)) {
            Ok(Some(named)) => conditions.push(named.condition()),
            Ok(None) => {}
            Err(()) => return,
        }
    }
    let mut consequents = vec![];
    for (index, word) in parts.outputs.iter().enumerate() {
        match proposition(draft, word, |model| {
            Some(&model.outputs.get(index)?.variable)
        }) {
            Ok(Some(named)) => {
                if !named.hedges.is_empty() {
                    let message = match named.hedges.as_slice() {
                        [Hedge::Not] => format!("`{word}` negates the term of a conclusion"),
                        _ => format!("`{word}` has a hedge in a conclusion"),
                    };
                    draft.loss(
                        "hedge-in-conclusion",
                        word,
                        message,
                        "add a term with this meaning to the output, and conclude that",
                    );
                }
                consequents.push(Consequent {
                    output: named.variable,
                    hedges: vec![],
                    term: named.term,
                });
            }
            Ok(None) => {}
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
                "name a term of at least one input",
            );
            return;
        }
        (1, _) => conditions.remove(0),
        (_, "1") => Condition::And(conditions),
        (_, "2") => Condition::Or(conditions),
        (_, other) => {
            let message = format!("`{other}` is not a connective");
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

/// The term and hedges that a number in a rule refers to.
struct TermReference {
    variable: Name,
    term: Name,
    /// `NOT` and hedges of Octave.
    hedges: Vec<Hedge>,
    /// Whether the hedged degree is multiplied by the degree of the term.
    is_repeated: bool,
}

impl TermReference {
    fn condition(self) -> Condition {
        let is = |hedges| {
            Condition::Is(Proposition {
                variable: self.variable.clone(),
                hedges,
                term: Some(self.term.clone()),
            })
        };
        if !self.is_repeated {
            return is(self.hedges);
        }
        let hedges = self.hedges.iter().copied();
        let hedged = is(hedges.filter(|hedge| *hedge != Hedge::Not).collect());
        let both = Condition::And(vec![hedged, is(vec![])]);
        match self.hedges.first() {
            Some(Hedge::Not) => Condition::Not(Box::new(both)),
            _ => both,
        }
    }
}

/// The term and hedges that a number in a rule refers to: `-2.3` is the second term with NOT and Octave's `extremely`;
/// `None` for 0.
fn proposition(
    draft: &mut ModelDraft<'_>,
    word: &str,
    variable: impl Fn(&Model) -> Option<&Variable>,
) -> Result<Option<TermReference>, ()> {
    let number = draft.number(word).ok_or(())?;
    let index = number.abs().trunc();
    if !number.is_finite() || (index == 0.0 && number != 0.0) {
        let message = format!("`{word}` names no term");
        let help = "write the number of a term, 1 for the first, or 0 to leave the variable out";
        draft.error("unknown-term", word, message, help);
        return Err(());
    }
    if index == 0.0 {
        return Ok(None);
    }
    let variable = variable(&draft.model).ok_or(())?;
    let name = variable.name.clone();
    let term = variable.terms.get((index as usize).saturating_sub(1));
    let Some(term) = term.map(|term| term.name.clone()) else {
        let help = match variable.terms.len() {
            1 => "write `1`, the number of its only term, or `0` for no condition".into(),
            count => format!("write a number from 1 to {count}, or `0` for no condition"),
        };
        let number = match index < 1e15 {
            true => index.to_string(),
            false => format!("{index:e}"),
        };
        let message = format!("`{name}` has no term {number}");
        draft.error("unknown-term", word, message, &help);
        return Err(());
    };
    let mut hedges = vec![];
    if number < 0.0 {
        hedges.push(Hedge::Not);
    }
    let fraction = ((number.abs() - index) * 100.0).round();
    let (own, is_repeated) = octave(draft, word, fraction)?;
    hedges.extend(own);
    let span = draft.span(word);
    let named = |text| Name {
        text,
        span: span.clone(),
    };
    Ok(Some(TermReference {
        variable: named(name),
        term: named(term),
        hedges,
        is_repeated,
    }))
}

/// The hedges of Octave's toolkit, from the digits after the decimal point, in hundredths. Octave's `extremely` cubes
/// the degree; it is read as the square of the degree AND the degree, if AND is the product. The second result is
/// whether that AND is needed.
fn octave(
    draft: &mut ModelDraft<'_>,
    word: &str,
    hundredths: f64,
) -> Result<(&'static [Hedge], bool), ()> {
    const SQUARE: &[Hedge] = &[Hedge::Very];
    match hundredths as i64 {
        0 => Ok((&[], false)),
        5 => Ok((&[Hedge::Somewhat], false)),
        20 => Ok((SQUARE, false)),
        40 => Ok((&[Hedge::Very, Hedge::Very], false)),
        30 if draft.model.operators.and == Conjunction::Product => Ok((SQUARE, true)),
        30 => {
            let message = format!("`{word}` has Octave's hedge `extremely`, the cube");
            let help = "no hedge of a rule set is a cube; with `AndMethod='prod'` it can be read as `very` times the term";
            draft.loss("unknown-hedge", word, message, help);
            Ok((&[Hedge::Extremely], false))
        }
        _ => {
            let message = format!("`{word}` has an unknown hedge");
            let help = "known hedges are .05 somewhat, .2 very, .3 extremely, .4 very very";
            draft.error("unknown-hedge", word, message, help);
            Err(())
        }
    }
}
