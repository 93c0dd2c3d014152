//! Why a model makes no engine.

use alloc::{
    string::{String, ToString},
    vec::Vec,
};

use crate::{
    diagnostic::{Diagnostic, Findings},
    model::ShapeError,
};

/// Why a model makes no engine: every problem found.
///
/// # Example
/// ```
/// use fuzzy::{Engine, Model};
///
/// let error = Engine::new(&Model::builder("empty").build()).unwrap_err();
/// assert_eq!(error.to_string(), "the model has no outputs");
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CompileError {
    /// The problems, in the order of the model; at least one.
    pub problems: Vec<Problem>,
}

impl core::fmt::Display for CompileError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        for (i, problem) in self.problems.iter().enumerate() {
            if i > 0 {
                f.write_str("; ")?;
            }
            problem.fmt(f)?;
        }
        Ok(())
    }
}

impl core::error::Error for CompileError {}

impl CompileError {
    /// The problems as findings of the rule set's text. The engine knows no places, so they have none.
    ///
    /// # Example
    /// ```
    /// use fuzzy::{Engine, Model};
    ///
    /// let error = Engine::new(&Model::builder("empty").build()).unwrap_err();
    /// assert_eq!(error.findings().to_string(), "error[not-compiled]: the model has no outputs");
    /// ```
    #[must_use]
    pub fn findings(&self) -> Findings {
        let finding =
            |problem: &Problem| Diagnostic::error("not-compiled", 0..0, problem.to_string());
        Findings(self.problems.iter().map(finding).collect())
    }
}

/// One reason why a model makes no engine. `rule` is an index into [`Model::rules`](crate::Model::rules); messages count from 1.
///
/// # Example: which rule names what there is not?
/// ```
/// use fuzzy::{Engine, engine::Problem, model::{Model, Output, Variable}, rule};
///
/// let model = Model::builder("fan")
///     .output(Output::new(Variable::new("speed", 0.0, 9.0)))
///     .rule(rule::parse("IF heat IS high THEN speed IS fast")?)
///     .build();
/// let error = Engine::new(&model).unwrap_err();
/// let unknown = Problem::Unknown { rule: 0, name: "heat".into(), kind: "input".into() };
/// assert!(error.problems.contains(&unknown), "{error}");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Problem {
    /// There is nothing to compute.
    #[error("the model has no outputs")]
    NoOutputs,
    /// Two variables of one kind, or two terms of one variable, share a name.
    #[error("`{name}` is defined twice in {place}")]
    Duplicate {
        /// The name.
        name: String,
        /// Where: `the inputs`, `the outputs` or a variable.
        place: String,
    },
    /// A range that is empty or not finite.
    #[error("the range of `{variable}` is not from a finite number up to a larger one")]
    Range {
        /// The variable.
        variable: String,
    },
    /// Parameters that make no membership function.
    #[error("term `{term}` of `{variable}`: {error}")]
    Shape {
        /// The variable.
        variable: String,
        /// The term.
        term: String,
        /// What is wrong with it.
        error: ShapeError,
    },
    /// A height outside (0, 1].
    #[error("term `{term}` of `{variable}`: the height is not in (0, 1]")]
    Height {
        /// The variable.
        variable: String,
        /// The term.
        term: String,
    },
    /// A shape that the output's defuzzifier cannot use, or that no input can have.
    #[error("term `{term}` of `{variable}`: {why}")]
    Misfit {
        /// The variable.
        variable: String,
        /// The term.
        term: String,
        /// Why it does not fit.
        why: &'static str,
    },
    /// A term that is 0 on all of its output's range, where it can say nothing.
    #[error("term `{term}` of `{variable}` is 0 on the whole range")]
    OutsideRange {
        /// The variable.
        variable: String,
        /// The term.
        term: String,
    },
    /// A rule names an input, an output or a term that the model does not have.
    #[error("rule {} names `{name}`, which is no {kind}", rule + 1)]
    Unknown {
        /// The rule.
        rule: usize,
        /// The name.
        name: String,
        /// `input`, `output` or `term of ...`.
        kind: String,
    },
    /// A linear consequent names an input that the model does not have.
    #[error("term `{term}` of `{output}` names `{name}`, which is no input")]
    UnknownCoefficient {
        /// The output.
        output: String,
        /// The term.
        term: String,
        /// The name.
        name: String,
    },
    /// A proposition without a term whose hedges do not end it.
    #[error(
        "rule {} says nothing of `{variable}`: a term, or the hedge `any`, is missing",
        rule + 1
    )]
    NoTerm {
        /// The rule.
        rule: usize,
        /// The input.
        variable: String,
    },
    /// A rule with no consequent, or an empty AND or OR.
    #[error("rule {} is empty", rule + 1)]
    EmptyRule {
        /// The rule.
        rule: usize,
    },
    /// A weight outside [0, 1].
    #[error("the weight of rule {} is not in [0, 1]", rule + 1)]
    Weight {
        /// The rule.
        rule: usize,
    },
    /// A value for where no rule fires that lies outside the output's range.
    #[error("the value of `{output}` where no rule fires is not in its range")]
    DefaultOutsideRange {
        /// The output.
        output: String,
    },
    /// A sampled integration with too few samples.
    #[error("`{output}` is integrated with {samples} samples: it takes at least 2")]
    TooFewSamples {
        /// The output.
        output: String,
        /// How many samples.
        samples: usize,
    },
}
