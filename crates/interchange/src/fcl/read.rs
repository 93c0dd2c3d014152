//! Reads FCL.

use fuzzy::{
    diagnostic::nearest,
    format::Document,
    model::{Aggregation, Block},
};

use super::lex;
use crate::{Losses, blocks, fll::output_conditions, model_draft::ModelDraft};

/// Reads the function block `name`. If `name` is `None`, reads the first function block, and reports a loss if there
/// are several.
pub(crate) fn read(
    text: &str,
    name: Option<&str>,
    losses: Losses,
) -> Result<Document, fuzzy::Findings> {
    let words = lex::words(text);
    let mut reader = Reader {
        draft: ModelDraft::new(text, losses),
        words: &words,
        next: 0,
        outputs: vec![],
        accumulations: vec![],
        common: None,
        is_fuzzylite: is_fuzzylite(&words),
        computes: false,
        blocks: vec![],
        section: String::new(),
        is_cut_off: false,
    };
    if reader.choose(name) {
        reader.file();
    }
    reader.finish()
}

/// The value of `ACCU :`: `None` if it is missing, `Some(None)` for the method `NONE`.
pub(super) type Accumulation = Option<Option<Aggregation>>;

pub(super) struct Reader<'r, 't> {
    pub(super) draft: ModelDraft<'t>,
    pub(super) words: &'r [&'t str],
    pub(super) next: usize,
    /// The names in VAR_OUTPUT.
    pub(super) outputs: Vec<&'t str>,
    /// The accumulation of each output.
    pub(super) accumulations: Vec<Accumulation>,
    /// The accumulation of a rule block, for outputs without their own.
    pub(super) common: Accumulation,
    /// Whether the text is in fuzzylite's dialect.
    pub(super) is_fuzzylite: bool,
    /// Whether the terms being read compute values, which depends on the `METHOD` that follows them.
    pub(super) computes: bool,
    pub(super) blocks: Vec<Block>,
    /// The current section, for messages.
    section: String,
    /// Whether the premature end of the text was reported. If so, missing parts are not reported.
    is_cut_off: bool,
}

impl<'r, 't> Reader<'r, 't> {
    pub(super) fn peek(&self) -> Option<&'t str> {
        self.words.get(self.next).copied()
    }

    pub(super) fn is(&self, keyword: &str) -> bool {
        self.peek()
            .is_some_and(|word| word.eq_ignore_ascii_case(keyword))
    }

    pub(super) fn take(&mut self, keyword: &str) -> bool {
        let is = self.is(keyword);
        self.next += usize::from(is);
        is
    }

    /// Whether a section ends here: either at `keyword`, which is consumed, or at the end of the text, which is
    /// reported as an error.
    pub(super) fn ends(&mut self, keyword: &str) -> bool {
        let is_cut_off = self.peek().is_none();
        if is_cut_off {
            self.unexpected(&format!("`{keyword}`"));
        }
        is_cut_off || self.take(keyword)
    }

    pub(super) fn word(&mut self) -> Option<&'t str> {
        let word = self.peek()?;
        self.next += 1;
        Some(word)
    }

    /// The words up to the next `;`, which is consumed, or up to one of the keywords.
    pub(super) fn statement(&mut self, keywords: &[&str]) -> &'r [&'t str] {
        let words = self.words;
        let rest = words.get(self.next..).unwrap_or_default();
        let ends =
            |word: &&str| *word == ";" || keywords.iter().any(|k| k.eq_ignore_ascii_case(word));
        let length = rest.iter().position(ends).unwrap_or(rest.len());
        self.next += length;
        self.take(";");
        rest.get(..length).unwrap_or_default()
    }

    /// Whether the last word was `;`.
    pub(super) fn ended(&self) -> bool {
        let last = self
            .next
            .checked_sub(1)
            .and_then(|last| self.words.get(last));
        last.is_some_and(|word| *word == ";")
    }

    /// The location of an error about something missing: the next word, or the end of the text.
    pub(super) fn here(&self) -> &'t str {
        let text = self.draft.text;
        self.peek()
            .unwrap_or(text.get(text.len()..).unwrap_or_default())
    }

    pub(super) fn unexpected(&mut self, expected: &str) {
        if self.is_cut_off {
            return;
        }
        let part = self.here();
        if self.next + 1 >= self.words.len() {
            self.is_cut_off = true;
            let inside = match self.section.as_str() {
                "" => "before its first section",
                section => &format!("inside `{section}`"),
            };
            let message = format!("the file ends {inside}: expected {expected}");
            let help = "it may be cut off: look for the complete file";
            self.draft.error("fcl-syntax", part, message, help);
            return;
        }
        let message = format!("expected {expected}, found `{part}`");
        let end = expected.split('`').find(|word| word.starts_with("END_"));
        let help = match end.filter(|_| is_section(part)) {
            Some(end) => format!("write `{end}` before `{part}`"),
            None => format!("correct `{part}`, or write what is expected before it"),
        };
        self.draft.error("fcl-syntax", part, message, &help);
    }

    /// Finds the function block with the given name, and moves to it. Without a name, the first
    /// block is read, and a loss is reported if there are several. Returns `false` after an error.
    fn choose(&mut self, name: Option<&str>) -> bool {
        let words = self.words.iter().zip(self.words.iter().skip(1)).enumerate();
        let blocks = words.filter(|(_, (word, _))| word.eq_ignore_ascii_case("FUNCTION_BLOCK"));
        let blocks: Vec<(usize, &str)> = blocks.map(|(at, (_, name))| (at, *name)).collect();
        let listed = blocks.iter().map(|(_, name)| format!("`{name}`"));
        let listed = listed.collect::<Vec<_>>().join(", ");
        let Some(name) = name else {
            if let [_, (_, second), ..] = blocks[..] {
                let message = format!("the file has the function blocks {listed}");
                let help = "a rule set is read from one of them";
                self.draft.loss("several-blocks", second, message, help);
            }
            return !self.draft.has_errors();
        };
        if let Some((at, _)) = blocks.iter().find(|(_, known)| *known == name) {
            self.next = *at;
            return true;
        }
        let help = match nearest(name, blocks.iter().map(|(_, known)| *known)) {
            Some(near) => format!("did you mean `{near}`?"),
            None => format!("choose one of {listed}"),
        };
        let message = format!("there is no function block `{name}`");
        let part = blocks
            .first()
            .map_or_else(|| self.here(), |(_, name)| *name);
        self.draft.error("unknown-block", part, message, &help);
        false
    }

    pub(super) fn file(&mut self) {
        if self.take("FUNCTION_BLOCK") {
            let name = self.peek().filter(|word| !is_section(word));
            self.next += usize::from(name.is_some());
            self.draft.model.name = name.unwrap_or("unnamed").to_owned();
        } else {
            self.unexpected("`FUNCTION_BLOCK`");
            return;
        }
        loop {
            let Some(word) = self.word() else {
                return self.unexpected("`END_FUNCTION_BLOCK`");
            };
            let name = self
                .peek()
                .filter(|_| word.to_ascii_uppercase().ends_with("FUZZIFY"));
            self.section = [word, name.unwrap_or_default()]
                .join(" ")
                .trim_end()
                .to_owned();
            match word.to_ascii_uppercase().as_str() {
                "VAR_INPUT" => self.variables(false),
                "VAR_OUTPUT" => self.variables(true),
                "FUZZIFY" => self.fuzzify(),
                "DEFUZZIFY" => self.defuzzify(),
                "RULEBLOCK" => self.rules(),
                "OPTIONS" | "VAR" => self.skip(word),
                "END_FUNCTION_BLOCK" => break,
                _ => {
                    self.next -= 1;
                    self.unexpected("a section such as `FUZZIFY` or `RULEBLOCK`");
                    return;
                }
            }
        }
    }

    /// Moves to the next section after an error: the section that begins here, or the one after the end of the current
    /// section.
    pub(super) fn resume(&mut self, section: &str) {
        if !self.peek().is_some_and(is_section) {
            self.skip(section);
        }
    }

    pub(super) fn skip(&mut self, section: &str) {
        let end = format!("END_{}", section.to_ascii_uppercase());
        while !self.ends(&end) {
            self.next += 1;
        }
    }

    pub(super) fn finish(mut self) -> Result<Document, fuzzy::Findings> {
        let found = (0..self.accumulations.len()).map(|output| self.aggregation(output));
        let found: Vec<Option<Aggregation>> = found.collect();
        blocks::aggregate(&mut self.draft.model, &found);
        blocks::set_blocks(&mut self.draft.model, std::mem::take(&mut self.blocks));
        if self.is_fuzzylite {
            output_conditions::replace(&mut self.draft);
        }
        for name in &self.outputs {
            let has_terms = self
                .draft
                .model
                .outputs
                .iter()
                .any(|output| output.variable.name == *name);
            if !has_terms && !self.is_cut_off && !self.draft.has_errors() {
                let message = format!("the output `{name}` has no `DEFUZZIFY`");
                self.draft
                    .warning("no-terms", name, message, "it is left out");
            }
        }
        for input in &mut self.draft.model.inputs {
            // An input without FUZZIFY has no range; only formulas read it.
            if input.low.is_nan() {
                (input.low, input.high) = (0.0, 1.0);
            }
        }
        // A file with inputs but without rules or rule blocks is a collection of terms.
        let model = &self.draft.model;
        let is_collection =
            !model.inputs.is_empty() && model.blocks.is_empty() && model.rules.is_empty();
        if !self.is_cut_off && !is_collection {
            let help =
                "declare an output in `VAR_OUTPUT`, and write its terms in a `DEFUZZIFY` section";
            self.draft.require_output(help);
        }
        self.draft.finish()
    }
}

/// Whether the text is in fuzzylite's dialect, in which rules have no `;` at their end.
fn is_fuzzylite(words: &[&str]) -> bool {
    let mut pairs = words.iter().zip(words.iter().skip(1));
    pairs.any(|(last, word)| word.eq_ignore_ascii_case("END_RULEBLOCK") && *last != ";")
}

fn is_section(word: &str) -> bool {
    [
        "VAR_INPUT",
        "VAR_OUTPUT",
        "FUZZIFY",
        "DEFUZZIFY",
        "RULEBLOCK",
    ]
    .iter()
    .any(|section| section.eq_ignore_ascii_case(word))
}
