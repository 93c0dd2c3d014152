//! A text with its tree, rule set and engine, each computed once.

use std::{string::String, sync::OnceLock};

use crate::{Engine, Findings, format::Document, tree::Node, yaml};

/// A text with its tree, its rule set and the compiled engine. Each is computed on the first request and cached.
///
/// # Example
/// ```
/// use fuzzy::Source;
///
/// let source = Source::new("
/// fuzzy: 1
/// name: fan
/// inputs: {heat: {range: [0, 40], partition: [low, high]}}
/// outputs: {speed: {range: [0, 9], partition: [slow, fast]}}
/// rules: [IF heat IS low THEN speed IS slow, IF heat IS high THEN speed IS fast]
/// ");
/// assert_eq!(source.document()?.model.name, "fan");
/// assert!(source.engine()?.evaluate(&[40.0])?[0].value() > Some(4.5));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Source {
    text: String,
    tree: OnceLock<Result<Node, Findings>>,
    document: OnceLock<Result<Document, Findings>>,
    engine: OnceLock<Result<Engine, Findings>>,
    /// Whether the caller provided the document. Its model may then be invalid.
    is_from_elsewhere: bool,
}

impl Source {
    /// Creates a source from a text in YAML.
    pub fn new(text: impl Into<String>) -> Source {
        Source {
            text: text.into(),
            tree: OnceLock::new(),
            document: OnceLock::new(),
            engine: OnceLock::new(),
            is_from_elsewhere: false,
        }
    }

    /// Creates a source from a text in another format, with the rule set that was parsed from it.
    pub fn with_document(text: impl Into<String>, document: Result<Document, Findings>) -> Source {
        Source {
            document: OnceLock::from(document),
            is_from_elsewhere: true,
            ..Source::new(text)
        }
    }

    /// Returns the text.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Returns the syntax tree of the text, parsed as YAML.
    ///
    /// # Errors
    /// Fails like [`yaml::parse`], but only for syntax errors.
    #[doc(hidden)] // For the packages of this repository.
    pub fn tree(&self) -> Result<&Node, Findings> {
        kept(&self.tree, || yaml::read(&self.text))
    }

    /// Returns the rule set with the positions of its parts.
    ///
    /// # Errors
    /// Fails like [`yaml::parse`].
    pub fn document(&self) -> Result<&Document, Findings> {
        kept(&self.document, || yaml::document(self.tree()?, &self.text))
    }

    /// Returns the compiled rule set.
    ///
    /// # Errors
    /// Fails like [`document`](Self::document), and if the rule set has no rules (a document may have none).
    pub fn engine(&self) -> Result<&Engine, Findings> {
        let compile = || {
            let document = self.document()?;
            // A document that was parsed here is valid, except that it may have no rules.
            match self.is_from_elsewhere || document.model.rules.is_empty() {
                true => document.compile(&self.text),
                false => Ok(Engine::compile(&document.model)),
            }
        };
        kept(&self.engine, compile)
    }
}

/// Returns the cached value, computing it first if necessary.
fn kept<T>(
    place: &OnceLock<Result<T, Findings>>,
    make: impl FnOnce() -> Result<T, Findings>,
) -> Result<&T, Findings> {
    place.get_or_init(make).as_ref().map_err(Findings::clone)
}
