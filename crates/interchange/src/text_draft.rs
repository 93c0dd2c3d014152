//! A text that is being written, and its findings so far.

use std::fmt::Debug;

use fuzzy::{
    Diagnostic, Findings, Model,
    model::{MIN_STRENGTH, Operators, Term, Variable},
};

use crate::{
    Format, Losses, WriteResult,
    words::{self, Words, is_printable},
};

/// A text that is being written.
pub(crate) struct TextDraft {
    pub(crate) text: String,
    format: Format,
    losses: Losses,
    findings: Vec<Diagnostic>,
}

impl TextDraft {
    pub(crate) fn new(format: Format, losses: Losses, model: &Model) -> Self {
        let mut draft = TextDraft {
            text: String::new(),
            format,
            losses,
            findings: vec![],
        };
        if model.least_strength != MIN_STRENGTH {
            let message = format!(
                "rules below the strength {} do not fire",
                model.least_strength
            );
            let help = format!("{} has no `least_strength`", format.name());
            draft.loss("least-strength", message, &help);
        }
        draft
    }

    /// The coefficient of each input for a term that is a linear function.
    pub(crate) fn coefficients(
        &mut self,
        term: &str,
        coefficients: &[(String, f64)],
        model: &Model,
    ) -> Vec<f64> {
        let is_input = |name: &str| model.inputs.iter().any(|input| input.name == name);
        if let Some((name, _)) = coefficients.iter().find(|(name, _)| !is_input(name)) {
            let message = format!("the term `{term}` reads the output `{name}`");
            let help = format!(
                "a linear function of {} reads only inputs",
                self.format.name()
            );
            self.refuse("no-shape", message, &help);
        }
        let each = model.inputs.iter().map(|input| {
            let own = coefficients.iter().find(|(name, _)| *name == input.name);
            own.map_or(0.0, |(_, coefficient)| *coefficient)
        });
        each.collect()
    }

    pub(crate) fn line(&mut self, line: impl AsRef<str>) {
        self.text.push_str(line.as_ref());
        self.text.push('\n');
    }

    /// Reports content that the format cannot represent: an error, or a warning if losses are accepted.
    pub(crate) fn loss(&mut self, code: &'static str, message: String, help: &str) {
        let finding = match self.losses {
            Losses::Refuse => Diagnostic::error(code, 0..0, message),
            Losses::Accept => Diagnostic::warning(code, 0..0, message),
        };
        self.findings.push(finding.help(help));
    }

    /// Reports a rule that the format cannot represent: if losses are accepted, it is left out.
    pub(crate) fn leave_out(&mut self, rule: usize, what: &str, help: &str) {
        let message = match self.losses {
            Losses::Refuse => format!("rule {rule} {what}"),
            Losses::Accept => format!("rule {rule} is left out: it {what}"),
        };
        self.loss("rule", message, help);
    }

    /// Reports missing content without which the rest is useless, such as a term that rules refer to: an error even if
    /// losses are accepted.
    pub(crate) fn refuse(&mut self, code: &'static str, message: String, help: &str) {
        self.findings
            .push(Diagnostic::error(code, 0..0, message).help(help));
    }

    /// Notes content that is expressed differently.
    pub(crate) fn note(&mut self, code: &'static str, message: String, help: &str) {
        self.findings
            .push(Diagnostic::note(code, 0..0, message).help(help));
    }

    /// The word of the format for an operator or a defuzzifier; `what` names its kind in messages.
    pub(crate) fn word<T: Copy + PartialEq + Debug>(
        &mut self,
        words: &Words<T>,
        value: T,
        what: &str,
    ) -> &'static str {
        words::word(words, self.format, value).unwrap_or_else(|| {
            let (format, value) = (self.format.name(), snake_case(&format!("{value:?}")));
            let known = words::all(words, self.format);
            let message = format!("{format} has no word for {what} `{value}`");
            self.loss("no-word", message, &format!("it has {}", known.join(", ")));
            known.first().copied().unwrap_or_default()
        })
    }

    /// The words for AND, OR and the implication.
    pub(crate) fn operators(&mut self, operators: Operators) -> [&'static str; 3] {
        [
            self.word(words::CONJUNCTIONS, operators.and, "AND"),
            self.word(words::DISJUNCTIONS, operators.or, "OR"),
            self.word(
                words::CONJUNCTIONS,
                operators.implication,
                "the implication",
            ),
        ]
    }

    pub(crate) fn finish(self) -> Result<WriteResult, Findings> {
        // A finding about several outputs is reported once.
        let mut reported: Vec<Diagnostic> = vec![];
        for finding in self.findings {
            if !reported.contains(&finding) {
                reported.push(finding);
            }
        }
        let findings = Findings(reported);
        match findings.has_errors() {
            true => Err(findings),
            false => Ok(WriteResult {
                text: self.text,
                findings,
            }),
        }
    }
}

/// The word of a rule set for an operator, from its name in Rust: `weighted_average` for `WeightedAverage`.
fn snake_case(name: &str) -> String {
    let mut word = String::new();
    for c in name.chars() {
        if c.is_ascii_uppercase() && !word.is_empty() {
            word.push('_');
        }
        word.push(c.to_ascii_lowercase());
    }
    word
}

/// A text on one line, without control characters.
pub(crate) fn one_line(text: &str) -> String {
    let words = text.split(|c: char| c.is_whitespace() || !is_printable(c));
    let words: Vec<&str> = words.filter(|word| !word.is_empty()).collect();
    words.join(" ")
}

/// The name of a term in messages.
pub(crate) fn named(term: &Term, variable: &Variable) -> String {
    format!("`{}` of `{}`", term.name, variable.name)
}

/// Numbers separated by blanks.
pub(crate) fn numbers(numbers: &[f64]) -> String {
    let written: Vec<String> = numbers.iter().map(f64::to_string).collect();
    written.join(" ")
}
