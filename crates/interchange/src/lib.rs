//! Reads and writes rule sets of other programs: FIS (MATLAB, Octave), FLL (fuzzylite), FCL (IEC 61131-7, jFuzzyLogic
//! and fuzzylite) and FML (IEEE 1855).
//!
//! It converts text to a [`fuzzy::Model`] and a model to text, and does not open files. Content that the model or the
//! format cannot represent is an error, or a warning if losses are accepted.
//!
//! ```
//! use flagred_interchange::{Format, Losses};
//!
//! let text = "
//! Engine: fan
//! InputVariable: heat
//!   range: 0 40
//!   term: low Ramp 20 10
//!   term: high Ramp 20 30
//! OutputVariable: speed
//!   range: 0 9
//!   aggregation: Maximum
//!   defuzzifier: Centroid 100
//!   term: slow Triangle 0 2 4
//!   term: fast Triangle 5 7 9
//! RuleBlock:
//!   implication: Minimum
//!   rule: if heat is low then speed is slow
//!   rule: if heat is high then speed is fast
//! ";
//! assert_eq!(Format::of(text), Some(Format::Fll));
//! let document = flagred_interchange::read(text, Format::Fll, Losses::Refuse)?;
//! let engine = fuzzy::Engine::new(&document.model)?;
//! assert!(engine.evaluate(&[28.0])?[0].value() > Some(6.0));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use fuzzy::{Diagnostic, Findings, Model, Source, format::Document};

mod blocks;
mod comments;
mod conditions;
mod crisp;
mod fcl;
mod fis;
mod fll;
mod fml;
mod formula;
mod model_draft;
mod names;
mod rules;
mod shapes;
mod text_draft;
mod words;

/// A format of rule sets.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// MATLAB's Fuzzy Inference System, which Octave and fuzzylite write too.
    Fis,
    /// fuzzylite's FuzzyLite Language, versions 5 to 7.
    Fll,
    /// Fuzzy Control Language, IEC 61131-7, in the dialects of jFuzzyLogic and fuzzylite.
    Fcl,
    /// Fuzzy Markup Language, IEEE 1855.
    Fml,
}

/// How to treat content that cannot be converted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Losses {
    /// Report an error: a converted rule set always gives the same results.
    #[default]
    Refuse,
    /// Omit the content with a warning; results may differ.
    Accept,
}

impl Format {
    /// All formats.
    pub const ALL: [Format; 4] = [Format::Fis, Format::Fll, Format::Fcl, Format::Fml];

    /// The file name extension in lower case, such as `fis`.
    #[must_use]
    pub fn ending(self) -> &'static str {
        match self {
            Format::Fis => "fis",
            Format::Fll => "fll",
            Format::Fcl => "fcl",
            Format::Fml => "fml",
        }
    }

    /// The name, such as `FIS`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Format::Fis => "FIS",
            Format::Fll => "FLL",
            Format::Fcl => "FCL",
            Format::Fml => "FML",
        }
    }

    /// The format of a text, detected from its start after comments; `None` if the text has none of these formats.
    #[must_use]
    pub fn of(text: &str) -> Option<Format> {
        let text = comments::after_comments(text);
        let starts = |word: &str| {
            text.get(..word.len())
                .is_some_and(|start| start.eq_ignore_ascii_case(word))
        };
        let roots = ["fuzzySystem", "fuzzyController"];
        if starts("<") && roots.iter().any(|root| text.contains(root)) {
            Some(Format::Fml)
        } else if starts("[System]") {
            Some(Format::Fis)
        } else if starts("FUNCTION_BLOCK") || starts("VAR_INPUT") {
            Some(Format::Fcl)
        } else if starts("Engine:") {
            Some(Format::Fll)
        } else {
            None
        }
    }
}

/// Reads a rule set of another program.
///
/// The spans of the document and of all findings refer to `text`.
///
/// # Errors
///
/// The errors that make the text unreadable, and content that the model cannot represent if losses are refused.
pub fn read(text: &str, format: Format, losses: Losses) -> Result<Document, Findings> {
    let document = match format {
        Format::Fis => fis::read(text, losses),
        Format::Fll => fll::read(text, losses),
        Format::Fcl => fcl::read(text, None, losses),
        Format::Fml => fml::read(text, losses),
    }?;
    Ok(crisp::read(document, text))
}

/// Reads one function block of an FCL file that contains several, by its name.
///
/// # Errors
///
/// As [`read`], and if no function block has that name.
pub fn read_block(text: &str, name: &str, losses: Losses) -> Result<Document, Findings> {
    let document = fcl::read(text, Some(name), losses)?;
    Ok(crisp::read(document, text))
}

/// Reads a rule set in any [`Format`] or in YAML.
///
/// # Errors
///
/// The errors of [`read`] with [`Losses::Refuse`], those of [`fuzzy::yaml::parse`], and the errors of the model's
/// validation.
pub fn document(text: &str) -> Result<Document, Findings> {
    let Some(format) = Format::of(text) else {
        return fuzzy::yaml::parse(text);
    };
    let document = read(text, format, Losses::Refuse)?;
    document.validate(text)?;
    Ok(document)
}

/// Creates a source from a text in any format that [`document`] reads.
pub fn source(text: impl Into<String>) -> Source {
    let text = text.into();
    match Format::of(&text) {
        None => Source::new(text),
        Some(_) => {
            let document = document(&text);
            Source::with_document(text, document)
        }
    }
}

/// The result of [`write()`].
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct WriteResult {
    /// The text in the format.
    pub text: String,
    /// Notes about content that is expressed differently, and warnings about accepted losses.
    pub findings: Findings,
}

/// Writes a rule set for another program.
///
/// # Errors
///
/// The errors of the model, and content that the format cannot represent if losses are refused. Even with losses,
/// the result must be a valid rule set; it is read back to verify this.
pub fn write(model: &Model, format: Format, losses: Losses) -> Result<WriteResult, Findings> {
    let invalid = fuzzy::validate(model, &fuzzy::format::Spans::default());
    if !invalid.is_empty() {
        return Err(Findings(invalid));
    }
    if model.has_type2_terms() && format != Format::Fis {
        let message = format!("{} has no type-2 terms", format.name());
        let help = "remove the keys that make terms type-2, such as `blur` or `lower`, or keep the rule set in YAML";
        let finding = Diagnostic::error("type-2-terms", 0..0, message).help(help);
        return Err(Findings(vec![finding]));
    }
    let mut written = match format {
        Format::Fis => fis::write(model, losses),
        Format::Fll => fll::write(model, losses),
        Format::Fcl => fcl::write(model, losses),
        Format::Fml => fml::write(model, losses),
    }?;
    written.findings.0.extend(crisp::written(model));
    let again = read(&written.text, format, losses);
    let again = again.and_then(|document| document.validate(&written.text).map(|()| document));
    match again {
        Ok(document) => match without_rules(model, &document.model) {
            None => Ok(written),
            Some(lost) => {
                written.findings.0.push(lost);
                Err(written.findings)
            }
        },
        Err(Findings(unreadable)) => {
            let what = unreadable.first().map_or("", |finding| &finding.message);
            let message = format!(
                "without the parts that {} cannot express, the rule set is not valid: {what}",
                format.name()
            );
            let finding = Diagnostic::error("unreadable", 0..0, message);
            let mut findings = written.findings;
            findings
                .0
                .push(finding.help("change the parts that the other findings name"));
            Err(findings)
        }
    }
}

/// Returns an error for an output whose rules were all left out.
fn without_rules(model: &Model, written: &Model) -> Option<Diagnostic> {
    let concluded = |model: &Model, output: usize| {
        let name = model
            .outputs
            .get(output)
            .map(|output| &output.variable.name);
        let consequents = model.rules.iter().flat_map(|rule| &rule.rule.consequents);
        consequents
            .map(|one| &one.output.text)
            .any(|it| Some(it) == name)
    };
    let is_lost = |output: &usize| concluded(model, *output) && !concluded(written, *output);
    let lost = (0..model.outputs.len()).find(is_lost)?;
    let name = &model.outputs.get(lost)?.variable.name;
    let message = format!("all rules of the output `{name}` would be left out");
    let help = "write a rule set for each output, with the rules that the format can express";
    Some(Diagnostic::error("no-rules", 0..0, message).help(help))
}

/// Runs the example of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
