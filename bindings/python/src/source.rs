//! The text of a rule set, its document, and its compiled engine.

use std::sync::{Arc, OnceLock};

use fuzzy::{
    Findings,
    format::{self, Document},
    yaml,
};
use pyo3::prelude::*;

use crate::{compiled::CompiledRuleSet, errors::rule_set_error};

/// A rule set as it was read; an edit creates another source.
pub(crate) struct Source {
    pub(crate) file: String,
    pub(crate) text: String,
    pub(crate) document: Document,
    compiled: OnceLock<Result<Arc<CompiledRuleSet>, Findings>>,
}

impl Source {
    /// Reads a rule set in any format; `unfinished` accepts YAML without rules.
    pub(crate) fn read(
        py: Python<'_>,
        text: String,
        file: &str,
        unfinished: bool,
    ) -> PyResult<Arc<Source>> {
        let document = py.detach(|| document(&text, unfinished));
        let document = document.map_err(|findings| rule_set_error(py, &findings, file, &text))?;
        Ok(Arc::new(Source {
            file: file.to_owned(),
            text,
            document,
            compiled: OnceLock::new(),
        }))
    }

    /// The compiled rule set, or its errors.
    pub(crate) fn compile(&self, py: Python<'_>) -> Result<&Arc<CompiledRuleSet>, &Findings> {
        let compile = || {
            let engine = self.document.compile(&self.text)?;
            Ok(Arc::new(CompiledRuleSet::new(py, engine)))
        };
        self.compiled.get_or_init(compile).as_ref()
    }

    /// The compiled rule set.
    pub(crate) fn compiled(&self, py: Python<'_>) -> PyResult<&Arc<CompiledRuleSet>> {
        let drawn = |findings| rule_set_error(py, findings, &self.file, &self.text);
        self.compile(py).map_err(drawn)
    }
}

fn document(text: &str, unfinished: bool) -> Result<Document, Findings> {
    if !unfinished {
        return flagred_interchange::document(text);
    }
    let tree = yaml::read(text)?;
    format::read_unfinished(&tree).map_err(|findings| Findings::locate(findings, text))
}
