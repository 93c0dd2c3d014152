//! A text that is being written, and what it cannot carry.

use fuzzy::{Diagnostic, Findings, model::Operators};

use crate::{
    Format, Losses, Written,
    words::{self, Words, is_printable},
};

/// A text that is being written.
pub(crate) struct Paper {
    pub(crate) text: String,
    format: Format,
    losses: Losses,
    findings: Vec<Diagnostic>,
}

impl Paper {
    pub(crate) fn new(format: Format, losses: Losses) -> Self {
        Paper {
            text: String::new(),
            format,
            losses,
            findings: vec![],
        }
    }

    pub(crate) fn line(&mut self, line: impl AsRef<str>) {
        self.text.push_str(line.as_ref());
        self.text.push('\n');
    }

    /// Something that the format cannot say: an error, or a warning where losses are accepted.
    pub(crate) fn loss(&mut self, code: &'static str, message: String, help: &str) {
        let finding = match self.losses {
            Losses::Refuse => Diagnostic::error(code, 0..0, message),
            Losses::Accept => Diagnostic::warning(code, 0..0, message),
        };
        self.findings.push(finding.help(help));
    }

    /// Something that is said in another way.
    pub(crate) fn note(&mut self, code: &'static str, message: String, help: &str) {
        self.findings
            .push(Diagnostic::note(code, 0..0, message).help(help));
    }

    /// The word of the format for an operator or a defuzzifier, which `what` names.
    pub(crate) fn word<T: Copy + PartialEq>(
        &mut self,
        words: &Words<T>,
        value: T,
        what: &str,
    ) -> &'static str {
        words::word(words, self.format, value).unwrap_or_else(|| {
            let message = format!("{} has no word for {what}", self.format.name());
            self.loss("no-word", message, "take another one");
            words::all(words, self.format)
                .first()
                .copied()
                .unwrap_or_default()
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

    pub(crate) fn finish(self) -> Result<Written, Findings> {
        let findings = Findings(self.findings);
        match findings.has_errors() {
            true => Err(findings),
            false => Ok(Written {
                text: self.text,
                findings,
            }),
        }
    }
}

/// A text on one line, without control characters.
pub(crate) fn one_line(text: &str) -> String {
    let words = text.split(|c: char| c.is_whitespace() || !is_printable(c));
    let words: Vec<&str> = words.filter(|word| !word.is_empty()).collect();
    words.join(" ")
}

/// Numbers with blanks between.
pub(crate) fn numbers(numbers: &[f64]) -> String {
    let written: Vec<String> = numbers.iter().map(f64::to_string).collect();
    written.join(" ")
}
