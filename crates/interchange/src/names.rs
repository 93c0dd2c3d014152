//! Converts names to names that a format allows.

use std::collections::{BTreeMap, BTreeSet};

use fuzzy::{
    Model,
    model::{MembershipFunction, Variable},
    rule::{Condition, Name, Rule},
};

use crate::{formula, text_draft::TextDraft};

/// The names that a format allows.
pub(crate) struct NameRules {
    /// Whether a character is allowed; others are replaced by `_`.
    pub(crate) is_letter: fn(char) -> bool,
    /// Whether a character is allowed as the first one.
    pub(crate) is_first: fn(char) -> bool,
    /// Reserved words, in lower case.
    pub(crate) keywords: &'static [&'static str],
}

impl NameRules {
    /// The name itself or a similar one, which the format allows and which is not in `taken`.
    fn name(&self, name: &str, taken: &BTreeSet<String>) -> String {
        let letter = |c: char| if (self.is_letter)(c) { c } else { '_' };
        let mut plain: String = name.trim().chars().map(letter).collect();
        let begins = plain.starts_with(self.is_first);
        let keyword = self.keywords.contains(&plain.to_ascii_lowercase().as_str());
        if !begins || keyword {
            plain.insert(0, '_');
        }
        let is_taken = |name: &String| taken.contains(name);
        if is_taken(&plain) {
            let mut others = (2..).map(|number| format!("{plain}_{number}"));
            plain = others.find(|name| !is_taken(name)).unwrap_or_default();
        }
        plain
    }

    /// Returns an allowed name for each of the given names. Names that are already allowed are
    /// assigned first, so that no converted name replaces them.
    fn names(&self, before: &[&str]) -> Vec<String> {
        let mut taken = BTreeSet::new();
        let mut stays = |name: &&str| {
            self.name(name, &BTreeSet::new()) == **name && taken.insert((*name).to_owned())
        };
        let stay: Vec<bool> = before.iter().map(&mut stays).collect();
        let names = before.iter().zip(stay).map(|(name, stays)| {
            if stays {
                return (*name).to_owned();
            }
            let name = self.name(name, &taken);
            taken.insert(name.clone());
            name
        });
        names.collect()
    }
}

/// Whether a character is a letter, a digit or `_`.
pub(crate) fn is_plain(c: char) -> bool {
    c.is_ascii_alphanumeric() || c == '_'
}

/// Whether a character is a letter or `_`.
pub(crate) fn is_plain_first(c: char) -> bool {
    c.is_ascii_alphabetic() || c == '_'
}

/// A single name, such as that of the rule set, in the form that a format allows; a note reports a change.
pub(crate) fn one(name: &str, allowed: &NameRules, draft: &mut TextDraft) -> String {
    let plain = allowed.name(name, &BTreeSet::new());
    note(draft, name, &plain);
    plain
}

/// The model with names that a format allows; notes report changes.
pub(crate) fn plain(model: &Model, allowed: &NameRules, draft: &mut TextDraft) -> Model {
    let mut model = model.clone();
    let mut variables: BTreeMap<String, (String, BTreeMap<String, String>)> = BTreeMap::new();
    let before: Vec<&str> = model
        .variables()
        .map(|variable| variable.name.as_str())
        .collect();
    let mut names = allowed.names(&before).into_iter();
    let mut rename = |variable: &mut Variable| {
        let name = names.next().unwrap_or_default();
        let mut terms = BTreeMap::new();
        let before: Vec<&str> = variable.terms.iter().map(|t| t.name.as_str()).collect();
        let names = allowed.names(&before);
        for (term, name) in variable.terms.iter_mut().zip(names) {
            note(draft, &term.name, &name);
            terms.insert(std::mem::replace(&mut term.name, name.clone()), name);
        }
        note(draft, &variable.name, &name);
        let before = std::mem::replace(&mut variable.name, name.clone());
        variables.insert(before, (name, terms));
    };
    model.inputs.iter_mut().for_each(&mut rename);
    for output in &mut model.outputs {
        rename(&mut output.variable);
    }
    let name = |before: &str| match variables.get(before) {
        Some((name, _)) => name.clone(),
        None => before.to_owned(),
    };
    let outputs = model.outputs.iter_mut().map(|output| &mut output.variable);
    for variable in model.inputs.iter_mut().chain(outputs) {
        for term in &mut variable.terms {
            match &mut term.membership_function {
                MembershipFunction::Linear { coefficients, .. } => {
                    for (input, _) in coefficients {
                        *input = name(input);
                    }
                }
                MembershipFunction::Function { formula }
                    if formula.variables().any(|known| name(known) != known) =>
                {
                    *formula = formula::renamed(formula, name);
                }
                _ => {}
            }
        }
    }
    let change = |variable: &mut Name, term: Option<&mut Name>| {
        if let Some((name, terms)) = variables.get(&variable.text) {
            if let Some((term, name)) =
                term.and_then(|term| Some((terms.get(&term.text)?.clone(), term)))
            {
                name.text = term;
            }
            variable.text.clone_from(name);
        }
    };
    for rule in &mut model.rules {
        names_of(&mut rule.rule, &change);
    }
    model
}

fn note(draft: &mut TextDraft, before: &str, after: &str) {
    if before != after {
        let message = format!("the name `{before}` becomes `{after}`");
        draft.note(
            "renamed",
            message,
            "the format does not allow all its characters, or the name is already used",
        );
    }
}

fn names_of(rule: &mut Rule, change: &impl Fn(&mut Name, Option<&mut Name>)) {
    in_condition(&mut rule.condition, change);
    for consequent in &mut rule.consequents {
        change(&mut consequent.output, Some(&mut consequent.term));
    }
}

fn in_condition(condition: &mut Condition, change: &impl Fn(&mut Name, Option<&mut Name>)) {
    match condition {
        Condition::Is(proposition) => change(&mut proposition.variable, proposition.term.as_mut()),
        Condition::Not(inner) => in_condition(inner, change),
        Condition::And(parts) | Condition::Or(parts) => {
            parts.iter_mut().for_each(|part| in_condition(part, change));
        }
    }
}
