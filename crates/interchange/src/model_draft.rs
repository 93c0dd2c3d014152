//! A model that is being read, and its findings so far.

use std::ops::Range;

use fuzzy::{
    Diagnostic, Findings, Model,
    diagnostic::{Severity, suggest},
    format::{Document, Spans},
    model::Variable,
};

use crate::{
    Format, Losses, comments,
    shapes::{self, Shape},
    words::{self, Words},
};

/// The maximum number of inputs, and of outputs, of a rule set.
pub(crate) const MAX_VARIABLES: usize = 1000;
/// The maximum number of terms of a variable.
pub(crate) const MAX_TERMS: usize = 1000;
/// The maximum number of rule blocks of a rule set.
pub(crate) const MAX_BLOCKS: usize = 1000;

/// A model that is being read from a text.
pub(crate) struct ModelDraft<'t> {
    pub(crate) text: &'t str,
    losses: Losses,
    pub(crate) model: Model,
    pub(crate) spans: Spans,
    findings: Vec<Diagnostic>,
}

impl<'t> ModelDraft<'t> {
    pub(crate) fn new(text: &'t str, losses: Losses) -> Self {
        ModelDraft {
            text,
            losses,
            model: Model::builder("").build(),
            spans: Spans::default(),
            findings: vec![],
        }
    }

    /// The location of a part of the text.
    pub(crate) fn span(&self, part: &str) -> Range<usize> {
        let start = (part.as_ptr() as usize).saturating_sub(self.text.as_ptr() as usize);
        start..start + part.len()
    }

    /// Reports an error that makes the text unreadable.
    pub(crate) fn error(&mut self, code: &'static str, part: &str, message: String, help: &str) {
        self.findings
            .push(Diagnostic::error(code, self.span(part), message).help(help));
    }

    /// Reports something that the model cannot represent, so that its results would differ: an error, or a warning if
    /// losses are accepted.
    pub(crate) fn loss(&mut self, code: &'static str, part: &str, message: String, help: &str) {
        let span = self.span(part);
        let finding = match self.losses {
            Losses::Refuse => Diagnostic::error(code, span, message),
            Losses::Accept => Diagnostic::warning(code, span, message),
        };
        self.findings.push(finding.help(help));
    }

    /// Warns about something that has no meaning here and is ignored.
    pub(crate) fn warning(&mut self, code: &'static str, part: &str, message: String, help: &str) {
        self.findings
            .push(Diagnostic::warning(code, self.span(part), message).help(help));
    }

    /// Notes a decision about a point that the text leaves open.
    pub(crate) fn note(&mut self, code: &'static str, part: &str, message: String, help: &str) {
        self.findings
            .push(Diagnostic::note(code, self.span(part), message).help(help));
    }

    /// Parses a number; reports an error if it is not one.
    pub(crate) fn number(&mut self, word: &str) -> Option<f64> {
        let parsed = number(word);
        if parsed.is_none() {
            let message = format!("`{word}` is not a number");
            let with_point = word.replacen(',', ".", 1);
            let help = match word.to_ascii_lowercase().contains("pi") {
                true => "write it out in digits: 0.7853981633974483 for pi/4".to_owned(),
                false if word.contains(',') && number(&with_point).is_some() => {
                    format!("write a decimal point: `{with_point}`")
                }
                false => "write a number in digits, such as `0.5`".to_owned(),
            };
            self.error("not-a-number", word, message, &help);
        }
        parsed
    }

    /// Whether the parameters of a shape, given as numbers and as words, are finite where they must be; otherwise an error
    /// is reported.
    pub(crate) fn is_finite(&mut self, shape: Shape, numbers: &[f64], words: &[&str]) -> bool {
        let Some(index) = shapes::not_finite(shape, numbers) else {
            return true;
        };
        let word = words.get(index).copied().unwrap_or_default();
        let message = format!("the parameter `{word}` is not a finite number");
        let help = "only a triangle or a trapezoid has an open side: `-inf` on the left or `inf` on the right";
        self.error("not-finite", word, message, help);
        false
    }

    /// Returns the value of a word. `part` is the part of the text that an error shows; `what` describes the kind
    /// of word in the message.
    pub(crate) fn word<T: Copy>(
        &mut self,
        format: Format,
        words: &Words<T>,
        what: &str,
        (word, part): (&str, &str),
    ) -> Option<T> {
        let value = words::value(words, format, word);
        if value.is_none() {
            self.unknown_word(format, what, (word, part), &words::all(words, format));
        }
        value
    }

    /// Reports an unknown word.
    pub(crate) fn unknown_word(
        &mut self,
        format: Format,
        what: &str,
        (word, part): (&str, &str),
        known: &[&str],
    ) {
        let known_words = format!("known are {}", known.join(", "));
        let suggested = suggest(word, known.iter().copied());
        let help = match suggested.filter(|help| help.starts_with("did you mean")) {
            Some(help) => help,
            None if format == Format::Fis => {
                format!("functions of your own cannot be read; {known_words}")
            }
            None => known_words,
        };
        let message = format!("unknown {what} `{word}`");
        self.error("unknown-word", part, message, &help);
    }

    /// The ends of a range. If the output has computed values, an empty range such as `0 0` becomes a range of
    /// width 1 around the same number, because the values do not depend on the range.
    pub(crate) fn range(
        &mut self,
        part: &str,
        (low, high): (f64, f64),
        computed: bool,
    ) -> (f64, f64) {
        if low != high || !computed {
            return (low, high);
        }
        let message = format!("the range from {low} to {high} is empty");
        let help = "the values of this output do not depend on its range, which only needs a width: it becomes 1";
        self.note("empty-range", part, message, help);
        (low - 0.5, high + 0.5)
    }

    /// Whether another item is allowed after `count` items; otherwise an error is reported, once. The number of
    /// items is limited because each item is compared with all earlier items.
    pub(crate) fn allows_another(
        &mut self,
        count: usize,
        most: usize,
        what: &str,
        part: &str,
    ) -> bool {
        let is_reported = |finding: &Diagnostic| finding.code == "too-large";
        if count >= most && !self.findings.last().is_some_and(is_reported) {
            let message = format!("there are more than {most} {what}");
            self.error(
                "too-large",
                part,
                message,
                "split the rule set into several",
            );
        }
        count < most
    }

    /// Whether another term may be added to a variable; otherwise an error is reported, once.
    pub(crate) fn allows_another_term(&mut self, variable: &Variable, part: &str) -> bool {
        let what = format!("terms of `{}`", variable.name);
        self.allows_another(variable.terms.len(), MAX_TERMS, &what, part)
    }

    /// Whether an error makes the text unreadable.
    pub(crate) fn has_errors(&self) -> bool {
        self.findings
            .iter()
            .any(|finding| finding.severity == Severity::Error)
    }

    /// Reports a text without an output, which is usually cut off.
    pub(crate) fn require_output(&mut self, help: &str) {
        if self.model.outputs.is_empty() && !self.has_errors() {
            let start = self.text.get(..0).unwrap_or_default();
            self.error("missing-key", start, "the file has no output".into(), help);
        }
    }

    /// The model, or the errors that make the text unreadable.
    pub(crate) fn finish(mut self) -> Result<Document, Findings> {
        comments::keep(self.text, &mut self.model, &self.spans);
        if self.has_errors() {
            // Notes about decisions would distract from the errors.
            self.findings
                .retain(|finding| finding.severity != Severity::Note);
        }
        let findings = Findings::locate(self.findings, self.text);
        if findings.has_errors() {
            return Err(findings);
        }
        Ok(Document::new(self.model, self.spans, findings))
    }
}

/// Parses a number in digits, `inf`, `-inf` or `nan`.
pub(crate) fn number(word: &str) -> Option<f64> {
    let digits = word.trim_start_matches(['-', '+']);
    let plain = digits.starts_with(|c: char| c.is_ascii_digit() || c == '.');
    let named = ["inf", "infinity", "nan"]
        .iter()
        .any(|name| digits.eq_ignore_ascii_case(name));
    (plain || named).then(|| word.parse().ok()).flatten()
}
