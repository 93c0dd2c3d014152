//! Formulas over the values of variables, such as `2 * speed^2 + min(wind, 1)`.
//!
//! A formula is parsed once to flat code, and evaluated without allocation. Its functions are those of `libm`, so the
//! results for the same values are bitwise equal on every machine.

mod code;
#[cfg(feature = "alloc")]
mod parse;
#[cfg(feature = "alloc")]
mod print;
#[cfg(test)]
mod tests;

#[cfg(feature = "alloc")]
use alloc::{boxed::Box, string::String, vec::Vec};
#[cfg(feature = "alloc")]
use core::{ops::Range, str::FromStr};

#[cfg(feature = "alloc")]
use crate::diagnostic::Diagnostic;

pub(crate) use code::evaluate;
#[cfg(feature = "alloc")]
pub(crate) use code::{Instruction, Operation};

/// A formula over the values of variables.
///
/// # Example: parse, evaluate and print a formula
/// ```
/// use fuzzy::model::Formula;
///
/// let power: Formula = "2*speed ^ 2 + max(wind, 1)".parse()?;
/// let value = |name: &str| if name == "speed" { 3.0 } else { 0.5 };
/// assert_eq!(power.evaluate(value), 19.0);
/// assert_eq!(power.variables().collect::<Vec<_>>(), ["speed", "wind"]);
/// assert_eq!(power.to_string(), "2 * speed^2 + max(wind, 1)");
/// # Ok::<(), Box<fuzzy::Diagnostic>>(())
/// ```
#[cfg(feature = "alloc")]
#[derive(Debug, Clone)]
pub struct Formula {
    expression: Expression,
    /// The variables that the formula reads, each once, in the order of their first occurrence.
    variables: Vec<Variable>,
    /// The code, which reads the variables by their index in `variables`.
    code: Vec<Instruction>,
}

/// A variable that a formula reads.
#[cfg(feature = "alloc")]
#[derive(Debug, Clone)]
pub(crate) struct Variable {
    pub(crate) name: String,
    /// The positions of the name in the formula, from left to right.
    pub(crate) spans: Vec<Range<usize>>,
}

#[cfg(feature = "alloc")]
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Expression {
    Number(f64),
    /// The index in [`Formula::variables`].
    Variable(usize),
    /// An operator or a function with one or two operands.
    Apply(Operation, Vec<Expression>),
}

/// The maximum nesting depth of brackets; deeper nesting is an error because a tree is processed recursively.
#[cfg(feature = "alloc")]
const DEEPEST_NESTING: usize = 64;
/// The maximum count of numbers, variables and operations.
#[cfg(feature = "alloc")]
const LONGEST: usize = 1000;

#[cfg(feature = "alloc")]
impl Formula {
    /// Returns the names of the variables that the formula reads, each once, in the order of their first occurrence.
    pub fn variables(&self) -> impl ExactSizeIterator<Item = &str> {
        self.variables.iter().map(|variable| &*variable.name)
    }

    /// Returns the value of the formula; `value` returns the values of the variables. The result is
    /// NaN or infinite if the formula is undefined, such as `1 / x` at 0.
    pub fn evaluate(&self, value: impl Fn(&str) -> f64) -> f64 {
        evaluate(&self.code, |index| {
            self.variables
                .get(index)
                .map_or(f64::NAN, |variable| value(&variable.name))
        })
    }

    /// Converts the formula to another notation, from the inside out: `apply` receives the word of an operator or a
    /// function, such as `+` or `max`, and its operands. A negative sign is `-` with one operand.
    ///
    /// # Example: print a formula as function calls
    /// ```
    /// use fuzzy::model::Formula;
    ///
    /// let power: Formula = "-speed^2 + 1".parse()?;
    /// let text = power.fold(
    ///     &|number| number.to_string(),
    ///     &str::to_owned,
    ///     &|word, operands: Vec<String>| format!("({word} {})", operands.join(" ")),
    /// );
    /// assert_eq!(text, "(+ (- (^ speed 2)) 1)");
    /// # Ok::<(), Box<fuzzy::Diagnostic>>(())
    /// ```
    pub fn fold<T>(
        &self,
        number: &impl Fn(f64) -> T,
        variable: &impl Fn(&str) -> T,
        apply: &impl Fn(&str, Vec<T>) -> T,
    ) -> T {
        self.folded(&self.expression, number, variable, apply)
    }

    fn folded<T>(
        &self,
        expression: &Expression,
        number: &impl Fn(f64) -> T,
        variable: &impl Fn(&str) -> T,
        apply: &impl Fn(&str, Vec<T>) -> T,
    ) -> T {
        match expression {
            Expression::Number(value) => number(*value),
            Expression::Variable(index) => {
                let read = self.variables.get(*index);
                variable(read.map_or("", |read| &read.name))
            }
            Expression::Apply(operation, operands) => {
                let operands = operands.iter();
                let folded = operands.map(|of| self.folded(of, number, variable, apply));
                apply(operation.word(), folded.collect())
            }
        }
    }

    /// Returns whether the formula reads exactly this variable and no other.
    #[cfg(any(feature = "check", feature = "drawing"))]
    pub(crate) fn is_over(&self, variable: &str) -> bool {
        matches!(&self.variables[..], [only] if only.name == variable)
    }

    /// Returns the position of the first occurrence of each variable in the text that the formula was parsed from.
    pub(crate) fn spans(&self) -> impl Iterator<Item = &Range<usize>> {
        let firsts = self.variables.iter().map(|variable| variable.spans.first());
        firsts.flatten()
    }

    /// Returns each occurrence of a variable, as its name and its position in the text that the formula was parsed
    /// from.
    pub(crate) fn places(&self) -> impl Iterator<Item = (&str, &Range<usize>)> {
        self.variables.iter().flat_map(|variable| {
            let spans = variable.spans.iter();
            spans.map(|span| (&*variable.name, span))
        })
    }

    /// Returns the code, which reads variables by their index.
    pub(crate) fn code(&self) -> &[Instruction] {
        &self.code
    }

    /// Returns the code, with the indices of the variables replaced by `index`.
    pub(crate) fn code_with(
        &self,
        index: impl Fn(&str) -> Option<usize>,
    ) -> impl Iterator<Item = Instruction> {
        self.code.iter().map(move |instruction| {
            let variable = Operation::input_of(instruction).and_then(|i| self.variables.get(i));
            match variable.and_then(|variable| index(&variable.name)) {
                Some(index) => Operation::INPUT.with(index as f64),
                None => *instruction,
            }
        })
    }

    fn new(expression: Expression, variables: Vec<Variable>) -> Self {
        let mut code = Vec::new();
        expression.append(&mut code);
        Formula {
            expression,
            variables,
            code,
        }
    }
}

#[cfg(feature = "alloc")]
impl Expression {
    /// Appends the code of the expression: operands first, then the operation.
    fn append(&self, code: &mut Vec<Instruction>) {
        match self {
            Expression::Number(number) => code.push(Operation::NUMBER.with(*number)),
            Expression::Variable(index) => code.push(Operation::INPUT.with(*index as f64)),
            Expression::Apply(operation, operands) => {
                for operand in operands {
                    operand.append(code);
                }
                code.push(operation.with(0.0));
            }
        }
    }
}

/// Formulas are equal if they consist of the same operations, numbers and names.
#[cfg(feature = "alloc")]
impl PartialEq for Formula {
    fn eq(&self, other: &Self) -> bool {
        self.expression == other.expression && self.variables().eq(other.variables())
    }
}

#[cfg(feature = "alloc")]
impl FromStr for Formula {
    type Err = Box<Diagnostic>;

    /// # Errors
    /// The first syntax error, with its position in the text and a suggestion.
    fn from_str(text: &str) -> Result<Self, Box<Diagnostic>> {
        parse::parse(text)
    }
}
