//! The names of a rule set: where they are defined and used, what they mean, and renaming.

use std::ops::Range;

use fuzzy::{
    Source,
    format::PartialModel,
    model::{Term, Variable},
    rule::{self, Name},
};

use crate::{
    Edit,
    document::{Document, partial},
    edited,
};

/// The meaning of a name in the text.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Meaning {
    Variable(usize),
    Term(usize, usize),
}

/// A variable and its definition.
struct Defined<'r> {
    variable: &'r Variable,
    name: Range<usize>,
    terms: Vec<Range<usize>>,
}

/// The variables, inputs first.
fn variables(rules: &PartialModel) -> Vec<Defined<'_>> {
    let inputs = rules.model.inputs.iter().zip(&rules.spans.inputs);
    let outputs = rules.model.outputs.iter().map(|output| &output.variable);
    inputs
        .chain(outputs.zip(&rules.spans.outputs))
        .map(|(variable, spans)| {
            let terms = spans.terms.iter().map(|term| term.name.clone());
            Defined {
                variable,
                name: spans.name.clone(),
                terms: terms.collect(),
            }
        })
        .collect()
}

/// Every name in the text, with its meaning.
fn all(rules: &PartialModel) -> Vec<(Range<usize>, Meaning)> {
    let variables = variables(rules);
    let mut found = Vec::new();
    for (v, defined) in variables.iter().enumerate() {
        found.push((defined.name.clone(), Meaning::Variable(v)));
        let terms = defined.terms.iter().cloned().enumerate();
        found.extend(terms.map(|(t, span)| (span, Meaning::Term(v, t))));
    }
    let mut used = |variable: &Name, term: Option<&Name>| {
        let mut named = variables.iter().enumerate();
        let Some((v, known)) = named.find(|(_, known)| known.variable.name == variable.text) else {
            return;
        };
        found.push((variable.span.clone(), Meaning::Variable(v)));
        let mut terms = known.variable.terms.iter();
        if let Some(term) = term
            && let Some(t) = terms.position(|known| known.name == term.text)
        {
            found.push((term.span.clone(), Meaning::Term(v, t)));
        }
    };
    let spans = rules.spans.inputs.iter().chain(&rules.spans.outputs);
    for name in spans
        .flat_map(|spans| &spans.terms)
        .flat_map(|term| &term.names)
    {
        used(name, None);
    }
    for (rule, spans) in rules.model.rules.iter().zip(&rules.spans.rules) {
        rule.rule.condition.visit(&mut |proposition| {
            used(&proposition.variable, proposition.term.as_ref());
        });
        for consequent in &rule.rule.consequents {
            used(&consequent.output, Some(&consequent.term));
        }
        for (beaten, span) in rule.against.iter().zip(&spans.against_terms) {
            let term = Name {
                text: beaten.term.clone(),
                span: span.clone(),
            };
            // A learned rule has one consequent.
            if let Some(consequent) = rule.rule.consequents.first() {
                used(&consequent.output, Some(&term));
            }
        }
    }
    found
}

fn at(document: &Document, offset: usize) -> Option<(&PartialModel, Range<usize>, Meaning)> {
    let rules = document.rules()?;
    let names = all(rules).into_iter();
    let (span, meaning) = names
        .filter(|(span, _)| !span.is_empty())
        .find(|(span, _)| span.start <= offset && offset <= span.end)?;
    Some((rules, span, meaning))
}

/// The description of a name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Description {
    /// The bytes of the name.
    pub span: Range<usize>,
    /// The description, in Markdown.
    pub markdown: String,
}

/// Returns the description of the name at an offset in bytes.
pub fn describe(document: &Document, offset: usize) -> Option<Description> {
    let (rules, span, meaning) = at(document, offset)?;
    let variables = variables(rules);
    let markdown = match meaning {
        Meaning::Variable(v) => variable(variables.get(v)?.variable),
        Meaning::Term(v, t) => {
            let of = variables.get(v)?.variable;
            term(of.terms.get(t)?, of)
        }
    };
    Some(Description { span, markdown })
}

fn unit(variable: &Variable) -> String {
    let unit = variable.unit.as_ref();
    unit.map(|unit| format!(" {unit}")).unwrap_or_default()
}

fn variable(variable: &Variable) -> String {
    let terms: Vec<String> = variable
        .terms
        .iter()
        .map(|t| format!("`{}`", t.name))
        .collect();
    let range = format!("[{}, {}]{}", variable.low, variable.high, unit(variable));
    let mut text = format!("**{}** {range}", variable.name);
    if let Some(description) = &variable.description {
        text = format!("{text}\n\n{description}");
    }
    format!("{text}\n\nterms: {}", terms.join(", "))
}

fn term(term: &Term, of: &Variable) -> String {
    let upper = fuzzy::format::shape_text(&term.membership_function);
    let shape = match &term.lower {
        None => upper,
        Some(lower) => {
            let lower = fuzzy::format::shape_text(&lower.membership_function);
            format!("upper {upper}, lower {lower}")
        }
    };
    let range = format!("[{}, {}]{}", of.low, of.high, unit(of));
    format!("**{}** of `{}` {range}\n\n`{shape}`", term.name, of.name)
}

/// Returns the definition of the name at an offset in bytes.
pub fn definition(document: &Document, offset: usize) -> Option<Range<usize>> {
    let (rules, _, meaning) = at(document, offset)?;
    let variables = variables(rules);
    match meaning {
        Meaning::Variable(v) => variables.get(v).map(|defined| defined.name.clone()),
        Meaning::Term(v, t) => variables.get(v)?.terms.get(t).cloned(),
    }
}

/// Refuses a text that is not a valid name of a variable or term.
pub(crate) fn check_name(new: &str) -> Result<(), String> {
    let plain = rule::parse(&format!("IF {new} IS {new} THEN {new} IS {new}"));
    match plain.is_err() || new.contains(|c: char| c.is_whitespace() || "'\":#,[]{}".contains(c)) {
        true => Err(format!(
            "`{new}` is not a name: write letters, digits, `_` and `-`, and no keyword"
        )),
        false => Ok(()),
    }
}

/// Returns all positions of the name at an offset in bytes, if it can be renamed to `new`.
///
/// # Errors
/// Returns the reason if the name cannot be changed.
pub fn rename(document: &Document, offset: usize, new: &str) -> Result<Vec<Range<usize>>, String> {
    let (rules, _, meaning) = at(document, offset).ok_or("there is no variable or term here")?;
    if rules.names_unread {
        return Err(
            "a rule or a term cannot be read, so its names are unknown; correct it first".into(),
        );
    }
    check_name(new)?;
    let variables = variables(rules);
    let taken = match meaning {
        Meaning::Variable(_) => variables.iter().any(|known| known.variable.name == new),
        Meaning::Term(v, _) => variables
            .get(v)
            .is_some_and(|known| known.variable.terms.iter().any(|term| term.name == new)),
    };
    if taken {
        return Err(format!("the name `{new}` is already used"));
    }
    let places = all(rules).into_iter();
    let mut spans: Vec<Range<usize>> = places
        .filter(|(span, known)| *known == meaning && !span.is_empty())
        .map(|(span, _)| span)
        .collect();
    spans.sort_by_key(|span| span.start);
    spans.dedup();
    let edit = |span: &Range<usize>| Edit {
        span: span.clone(),
        text: new.to_owned(),
    };
    let edits: Vec<Edit> = spans.iter().map(edit).collect();
    let meanings = |rules: &PartialModel| -> Vec<Meaning> {
        let names = all(rules).into_iter();
        names.map(|(_, meaning)| meaning).collect()
    };
    let renamed = partial(&Source::new(edited(document.text(), &edits)));
    match renamed.is_some_and(|renamed| meanings(&renamed) == meanings(rules)) {
        true => Ok(spans),
        false => Err(format!(
            "`{new}` cannot be read as a name in a formula or a linear function; write letters, digits and `_`"
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RULES: &str = "fuzzy: 1
name: fan
inputs:
  heat: {range: [0, 10], terms: {low: {left_shoulder: [2, 8]}, high: {function: 'heat / 10 * min(heat, 1)'}}}
  damp: {range: [0, 1], partition: [dry, wet]}
outputs:
  speed:
    range: [0, 10]
    terms:
      slow: {linear: {heat: 1, constant: 2}}
      fast: {function: 'heat^2 + 2 * damp - \"heat\"'}
    defuzzifier: weighted_average
rules:
  - {rule: IF heat IS low THEN speed IS slow, against: [{term: fast, degree: 0.4, support: 3}]}
  - IF heat IS high THEN speed IS fast
";

    fn renamed(text: &str, at: &str, new: &str) -> Result<String, String> {
        let document = Document::new(text, |_| None);
        assert!(!document.findings().has_errors(), "{}", document.findings());
        let spans = rename(&document, text.find(at).unwrap(), new)?;
        let edits = spans.into_iter().map(|span| Edit {
            span,
            text: new.to_owned(),
        });
        Ok(edited(text, &edits.collect::<Vec<_>>()))
    }

    #[test]
    fn formulas_linear_functions_and_rejected_terms_are_renamed_too() {
        let expected = RULES.replace("\"heat\"", "t_in").replace("heat", "t_in");
        assert_eq!(renamed(RULES, "heat", "t_in").unwrap(), expected);
        let from_formula = renamed(RULES, "heat / 10", "t_in").unwrap();
        assert_eq!(from_formula, expected);
        let expected = RULES.replace("fast", "quick");
        assert_eq!(renamed(RULES, "fast,", "quick").unwrap(), expected);
    }

    #[test]
    fn a_name_that_a_formula_would_read_as_something_else_is_refused() {
        for new in ["t-in", "pi", "constant"] {
            let refused = renamed(RULES, "heat", new).unwrap_err();
            assert!(
                refused.contains("cannot be read as a name in a formula"),
                "{new}: {refused}"
            );
        }
        assert_eq!(
            renamed(RULES, "dry", "t-in").unwrap(),
            RULES.replace("dry", "t-in")
        );
        let broken = RULES.replace("heat^2 +", "heat^2 + +* ");
        let document = Document::new(&*broken, |_| None);
        let refused = rename(&document, broken.find("heat").unwrap(), "t").unwrap_err();
        assert!(refused.contains("cannot be read"), "{refused}");
    }
}
