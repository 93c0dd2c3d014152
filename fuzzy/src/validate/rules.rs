//! Validation of rules: names, weights, provenance.

use alloc::{borrow::ToOwned, collections::BTreeMap, format, string::String, vec::Vec};
use core::ops::Range;

use super::{TERMS_HELP, Validator, or};
use crate::{
    diagnostic::{Diagnostic, either, nearest, suggest},
    model::{MembershipFunction, Rule, Term, Variable, document::RuleSpans},
    rule::{self, Condition, Consequent, DEEPEST_NESTING, Hedge, Name, Proposition, is_plain_name},
};

impl<'m> Validator<'m> {
    pub(super) fn rule(&mut self, what: &str, rule: &'m Rule, spans: &RuleSpans) {
        let Rule {
            rule,
            confidence,
            against,
            ..
        } = rule;
        if let Some(finding) = self.exchanged(rule) {
            self.findings.push(finding);
            return;
        }
        self.condition(&rule.condition, 0, &spans.whole);
        if rule.consequents.is_empty() {
            let message = String::from("the rule has no conclusion");
            let help = "add `THEN output IS term`";
            self.error("empty-rule", &spans.whole, message, help);
        }
        for consequent in &rule.consequents {
            if let Some(output) = self.known_output(&consequent.output) {
                self.known_term("output", output, (&consequent.hedges, &consequent.term));
            }
            let mut hedges = consequent.hedges.iter();
            if let Some(hedge) = hedges.find(|hedge| !hedge.may_conclude()) {
                let message = format!("`{}` is not allowed after `THEN`", hedge.word());
                let help = "it belongs in the condition";
                self.error("rule-syntax", &spans.whole, message, help);
            }
        }
        if !is_degree(rule.weight) {
            let message = format!("the weight {} is outside [0, 1]", rule.weight);
            let help = "a weight is a number from 0 to 1";
            self.error("weight-outside-range", &spans.whole, message, help);
        }
        let help = "write a number from 0 to 1";
        if let Some(confidence) = *confidence
            && !is_degree(confidence)
        {
            let here = or(&spans.confidence, &spans.whole);
            let message = format!("the confidence {confidence} of {what} is outside [0, 1]");
            self.error("value-outside-range", here, message, help);
        }
        for (i, rejected) in against.iter().enumerate() {
            if !is_degree(rejected.degree) {
                let here = spans.against.get(i).unwrap_or(&spans.whole);
                let degree = rejected.degree;
                let message =
                    format!("the degree {degree} in `against` of {what} is outside [0, 1]");
                self.error("value-outside-range", here, message, help);
            }
        }
    }

    /// Returns a finding for a rule whose condition reads an output and whose conclusion sets an input.
    fn exchanged(&self, rule: &rule::Rule) -> Option<Diagnostic> {
        let (Condition::Is(read), [set]) = (&rule.condition, rule.consequents.as_slice()) else {
            return None;
        };
        let has = |names: &BTreeMap<&str, &Variable>, name: &Name| names.contains_key(&*name.text);
        let are_exchanged = has(&self.outputs, &read.variable)
            && !has(&self.inputs, &read.variable)
            && has(&self.inputs, &set.output);
        let term = read.term.clone().filter(|_| are_exchanged)?;
        let meant = rule::Rule {
            condition: Condition::Is(Proposition {
                variable: set.output.clone(),
                hedges: set.hedges.clone(),
                term: Some(set.term.clone()),
            }),
            consequents: Vec::from([Consequent {
                output: read.variable.clone(),
                hedges: read.hedges.clone(),
                term,
            }]),
            weight: rule.weight,
        };
        let (output, input) = (&read.variable.text, &set.output.text);
        let message = format!(
            "input and output are swapped: the condition reads the output `{output}`, and the conclusion sets the input `{input}`"
        );
        let finding = Diagnostic::error("input-in-conclusion", read.variable.span.clone(), message);
        Some(finding.help(format!("swap them: `{meant}`")))
    }

    /// Validates a condition. `depth` is the number of enclosing NOTs and brackets in the text of the rule.
    pub(super) fn condition(
        &mut self,
        condition: &'m Condition,
        depth: usize,
        rule: &Range<usize>,
    ) {
        if depth > DEEPEST_NESTING {
            let message =
                format!("brackets and NOTs are nested more than {DEEPEST_NESTING} levels deep");
            let help = "split the rule into several rules with the same conclusion";
            self.error("rule-too-deep", rule, message, help);
            return;
        }
        match condition {
            Condition::Is(proposition) => self.proposition(proposition),
            Condition::Not(inner) => {
                let brackets = matches!(**inner, Condition::And(_) | Condition::Or(_));
                self.condition(inner, depth + 1 + usize::from(brackets), rule);
            }
            Condition::And(parts) | Condition::Or(parts) => {
                if parts.is_empty() {
                    let message = String::from("the rule has an empty condition");
                    self.error("empty-rule", rule, message, "add `input IS term`");
                }
                let in_or = matches!(condition, Condition::Or(_));
                for part in parts {
                    let brackets = match part {
                        Condition::Or(_) => true,
                        Condition::And(_) => !in_or,
                        _ => false,
                    };
                    self.condition(part, depth + usize::from(brackets), rule);
                }
            }
        }
    }

    pub(super) fn proposition(&mut self, proposition: &'m Proposition) {
        let name = &proposition.variable;
        let input = self.inputs.get(name.text.as_str()).copied();
        let output = self.outputs.get(name.text.as_str()).copied();
        let (kind, variable) = match (input, output) {
            (Some(input), _) => ("input", input),
            (None, Some(output)) => ("output", output),
            (None, None) => {
                let mut finding = self.unknown_input(&name.text, &name.span);
                if let Some(other) = &proposition.term
                    && let Some(input) = self.inputs.get(other.text.as_str())
                    && input.terms.iter().any(|term| term.name == name.text)
                {
                    finding.help = Some(format!("write `{} IS {}`", other.text, name.text));
                }
                self.findings.push(finding);
                return;
            }
        };
        match &proposition.term {
            Some(_) if kind == "output" && self.is_weighted(variable) => {
                let message = format!(
                    "a condition reads output `{}`, whose terms are numbers (Takagi-Sugeno), but conditions need fuzzy sets",
                    name.text
                );
                let sets = as_partition(variable).map_or(
                    "give it another defuzzifier and fuzzy sets as terms".to_owned(),
                    |sets| format!("replace `terms` and `defuzzifier` with `{sets}`"),
                );
                let mut reported = self.findings.iter_mut();
                match reported.find(|finding| finding.message == message) {
                    Some(first) if !name.span.is_empty() => {
                        *first = first.clone().related(name.span.clone(), "also read here");
                    }
                    Some(_) => {}
                    None => self.error("output-in-condition", &name.span, message, &sets),
                }
            }
            Some(term) => self.known_term(kind, variable, (&proposition.hedges, term)),
            // A proposition `IS any` without a term is parsed like this.
            None if proposition.hedges.last() == Some(&Hedge::Any) => {}
            None => {
                let message = format!("`{}` has no term", name.text);
                let help = "write a term, or `any`, after `IS`";
                self.error("missing-term", &name.span, message, help);
            }
        }
    }

    pub(super) fn is_weighted(&self, variable: &Variable) -> bool {
        let mut outputs = self.model.outputs.iter();
        outputs.any(|o| o.variable.name == variable.name && o.defuzzifier.takes_numbers())
    }

    /// Returns the finding for an unknown input. An output is suggested only if its name is similar.
    pub(super) fn unknown_input(&self, name: &str, span: &Range<usize>) -> Diagnostic {
        let inputs = self.inputs.keys().copied();
        match nearest(name, inputs.clone().chain(self.outputs.keys().copied())) {
            Some(near) => unknown("input", name, span, core::iter::once(near)),
            None => unknown("input", name, span, inputs),
        }
    }

    pub(super) fn known_output(&mut self, name: &Name) -> Option<&'m Variable> {
        let found = self.outputs.get(name.text.as_str()).copied();
        // A model without outputs is reported separately.
        if found.is_none() && !self.outputs.is_empty() {
            let finding = if self.inputs.contains_key(name.text.as_str()) {
                let message = format!(
                    "`{}` is an input, but a conclusion can only set outputs",
                    name.text
                );
                let outputs: Vec<&str> = self.outputs.keys().copied().collect();
                let help = format!("name an output instead: {}", either(&outputs));
                Diagnostic::error("input-in-conclusion", name.span.clone(), message).help(help)
            } else {
                let known = self.outputs.keys().copied();
                unknown("output", &name.text, &name.span, known)
            };
            self.findings.push(finding);
        }
        found
    }

    /// Requires that a variable has the term that a rule names. `hedges` are the hedges before the term.
    pub(super) fn known_term(
        &mut self,
        kind: &str,
        variable: &'m Variable,
        (hedges, term): (&[Hedge], &Name),
    ) {
        // Terms that could not be parsed, and outputs without terms, are reported separately.
        let is_reported = self.unread.contains(&variable.name.as_str())
            || (kind == "output" && variable.terms.is_empty());
        if is_reported || variable.terms.iter().any(|t| t.name == term.text) {
            return;
        }
        if variable.terms.is_empty() {
            let spans = self.model.inputs.iter().zip(&self.spans.inputs);
            let mut spans = spans.filter(|(input, _)| input.name == variable.name);
            let here = spans
                .next()
                .map_or(term.span.clone(), |(_, spans)| spans.name.clone());
            let message = format!("{kind} `{}` has no terms", variable.name);
            let finding = Diagnostic::error("missing-key", here, message);
            self.findings.push(
                finding
                    .related(term.span.clone(), "a rule uses one of its terms here")
                    .help(TERMS_HELP),
            );
            self.unread.push(&variable.name);
            return;
        }
        let message = format!("{kind} `{}` has no term `{}`", variable.name, term.text);
        let mut finding = Diagnostic::error("unknown-term", term.span.clone(), message);
        let known = variable.terms.iter().map(|t| t.name.as_str());
        finding.help = suggest(&term.text, known).or_else(|| Some("add terms to it".into()));
        // If all names are numbers, as in `partition: [10, 20, 30]`, a single finding is reported for the variable.
        let number = |term: &Term| term.name.parse::<f64>().is_ok();
        if variable.terms.iter().all(number) && term.text.parse::<f64>().is_err() {
            let names = ["low", "medium", "high"].into_iter().map(String::from);
            let names: Vec<String> = match variable.terms.len() {
                3 => names.collect(),
                2 => names.step_by(2).collect(),
                count => (1..=count).map(|i| format!("term{i}")).collect(),
            };
            let peaks = names.iter().zip(&variable.terms);
            let peaks: Vec<String> = peaks
                .map(|(name, term)| format!("{name}: {}", term.name))
                .collect();
            finding.message = format!(
                "the names of the terms of {kind} `{}` are numbers, so there is no term `{}`",
                variable.name, term.text
            );
            finding.help = Some(format!(
                "write a name and a peak for each term: `partition: {{{}}}`",
                peaks.join(", ")
            ));
            self.findings.push(finding);
            self.unread.push(&variable.name);
            return;
        }
        if term.text.parse::<f64>().is_ok() {
            let help = finding.help.unwrap_or_default();
            finding.help = Some(format!("a rule names a term, not a number: {help}"));
        }
        // The term may be called `very humid`, of which the first word is parsed as a hedge.
        let has_hedges = !hedges.is_empty();
        let hedges = hedges.iter().map(|hedge| hedge.word());
        let words: Vec<&str> = hedges.chain([term.text.as_str()]).collect();
        let whole = words.join(" ");
        let mut terms = variable.terms.iter();
        if let Some(known) = terms.find(|term| term.name.eq_ignore_ascii_case(&whole)) {
            finding.help = Some(match has_hedges {
                true => format!("put the name in quotes: `IS \"{}\"`", known.name),
                false => format!("did you mean `{}`?", known.name),
            });
        } else if let Some((hedge, known)) = hedged_term(&term.text, variable) {
            finding.help = Some(format!("write a space after the hedge: `{hedge} {known}`"));
        } else if let Some(joined) = self.joined(kind, variable, &term.text) {
            finding = joined.related(term.span.clone(), "used here");
            self.unread.push(&variable.name);
        }
        self.findings.push(finding);
    }
}

/// Returns the hedge and the term of a name such as `very_hot` or `very-hot`.
fn hedged_term<'v>(name: &str, variable: &'v Variable) -> Option<(&'static str, &'v str)> {
    let (first, second) = name.split_once(['_', '-'])?;
    let hedge = Hedge::ALL.iter().find(|hedge| hedge.word() == first)?;
    let term = variable.terms.iter().find(|term| term.name == second)?;
    Some((hedge.word(), &term.name))
}

impl Validator<'_> {
    /// Returns a finding if a name is one word of a term, as in `[slow medium, fast]` or `[slow 0, fast 9]`.
    fn joined(&self, kind: &str, variable: &Variable, name: &str) -> Option<Diagnostic> {
        let signs = [' ', ':', '='];
        let is_part =
            |term: &Term| term.name != name && term.name.split(signs).any(|word| word == name);
        let index = variable.terms.iter().position(is_part)?;
        let joined = &variable.terms.get(index)?.name;
        let inputs = self.model.inputs.iter().zip(&self.spans.inputs);
        let outputs = self.model.outputs.iter().map(|output| &output.variable);
        let mut variables = inputs.chain(outputs.zip(&self.spans.outputs));
        let spans = variables.find(|(known, _)| core::ptr::eq(*known, variable));
        let span = spans.and_then(|(_, spans)| Some(spans.terms.get(index)?.name.clone()));
        let message = format!(
            "{kind} `{}` has a term `{joined}`, but no term `{name}`",
            variable.name
        );
        let peaks = variable.terms.iter().map(|term| {
            let (name, peak) = term.name.rsplit_once(signs)?;
            Some((name.trim_end_matches(signs), peak.parse::<f64>().ok()?))
        });
        // In names such as `stage 1` and `stage 2`, the number is a part of the name and not a peak.
        let is_distinct = |peaks: &Vec<(&str, f64)>| {
            peaks
                .iter()
                .zip(peaks.iter().skip(1))
                .all(|(a, b)| a.0 != b.0)
        };
        let peaks = peaks.collect::<Option<Vec<(&str, f64)>>>();
        let help = match peaks.filter(is_distinct) {
            Some(peaks) => {
                let peaks = peaks.iter().map(|(name, peak)| format!("{name}: {peak}"));
                let peaks: Vec<String> = peaks.collect();
                format!(
                    "write the terms with their peaks in braces: `{{{}}}`",
                    peaks.join(", ")
                )
            }
            None => format!(
                "write a comma between the terms: `{}`",
                joined.split_whitespace().collect::<Vec<&str>>().join(", ")
            ),
        };
        Some(Diagnostic::error("unknown-term", span.unwrap_or_default(), message).help(help))
    }
}

fn is_degree(x: f64) -> bool {
    (0.0..=1.0).contains(&x)
}

fn unknown<'a>(
    kind: &str,
    name: &str,
    span: &Range<usize>,
    known: impl Iterator<Item = &'a str>,
) -> Diagnostic {
    let message = format!("there is no {kind} `{name}`");
    let mut finding = Diagnostic::error("unknown-variable", span.clone(), message);
    finding.help = suggest(name, known).or_else(|| Some(format!("declare it under `{kind}s`")));
    finding
}

/// Returns a partition whose peaks are the constants of a variable's terms; `None` if the terms are not distinct
/// constants.
fn as_partition<'a>(variable: &'a Variable) -> Option<String> {
    let constant = |term: &'a Term| {
        let MembershipFunction::Constant { value } = term.membership_function else {
            return None;
        };
        Some((value, term.name.as_str()))
    };
    let mut terms: Vec<(f64, &str)> = variable.terms.iter().map(constant).collect::<Option<_>>()?;
    terms.sort_by(|(a, _), (b, _)| a.total_cmp(b));
    if !terms.is_sorted_by(|(a, _), (b, _)| a < b) {
        return None;
    }
    let peaks = terms.iter().map(|(value, name)| match is_plain_name(name) {
        true => format!("{name}: {value}"),
        false => format!("{name:?}: {value}"),
    });
    let peaks: Vec<String> = peaks.collect();
    Some(format!("partition: {{{}}}", peaks.join(", ")))
}
