//! A text with its tree, rule set and engine, each made once.

use std::{string::String, sync::OnceLock};

use crate::{Engine, Findings, format::Document, tree::Node, yaml};

/// A text with what is made of it: its tree, the rule set in it, and the engine. Each is made when it is first asked for,
/// and kept.
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
    /// Another reader read it, so the model is not known to be valid.
    is_from_elsewhere: bool,
}

impl Source {
    /// A text in YAML.
    pub fn new(text: impl Into<String>) -> Source {
        Source {
            text: text.into(),
            tree: OnceLock::new(),
            document: OnceLock::new(),
            engine: OnceLock::new(),
            is_from_elsewhere: false,
        }
    }

    /// A text in another format, with the rule set that was read from it.
    pub fn with_document(text: impl Into<String>, document: Result<Document, Findings>) -> Source {
        Source {
            document: OnceLock::from(document),
            is_from_elsewhere: true,
            ..Source::new(text)
        }
    }

    /// The text.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Its tree, as YAML.
    ///
    /// # Errors
    /// As [`yaml::parse`], of the syntax alone.
    #[doc(hidden)] // For the packages of this repository.
    pub fn tree(&self) -> Result<&Node, Findings> {
        kept(&self.tree, || yaml::read(&self.text))
    }

    /// The rule set with the span of each part.
    ///
    /// # Errors
    /// As [`yaml::parse`].
    pub fn document(&self) -> Result<&Document, Findings> {
        kept(&self.document, || yaml::document(self.tree()?, &self.text))
    }

    /// The compiled rule set.
    ///
    /// # Errors
    /// As [`document`](Self::document); a rule set without rules, which can be read.
    pub fn engine(&self) -> Result<&Engine, Findings> {
        let compile = || {
            let document = self.document()?;
            // What was read here is valid but for lacking rules.
            match self.is_from_elsewhere || document.model.rules.is_empty() {
                true => document.compile(&self.text),
                false => Ok(Engine::compile(&document.model)),
            }
        };
        kept(&self.engine, compile)
    }
}

/// What is kept, made now if it is not there yet.
fn kept<T>(
    place: &OnceLock<Result<T, Findings>>,
    make: impl FnOnce() -> Result<T, Findings>,
) -> Result<&T, Findings> {
    place.get_or_init(make).as_ref().map_err(Findings::clone)
}
