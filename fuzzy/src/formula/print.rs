//! Printing formulas; parsing the printed text gives the same formula.

use core::fmt::{self, Display, Formatter, Write};

use super::{Expression, Formula, Operation, parse::is_plain_name};

impl Operation {
    /// Returns the precedence of an operator; `None` for a function.
    pub(super) fn binds(self) -> Option<u8> {
        Some(match self {
            Operation::OR => 1,
            Operation::AND => 2,
            Operation::NOT => 3,
            Operation::LESS
            | Operation::LESS_OR_EQUAL
            | Operation::GREATER
            | Operation::GREATER_OR_EQUAL
            | Operation::EQUAL
            | Operation::UNEQUAL => 4,
            Operation::ADD | Operation::SUBTRACT => 5,
            Operation::MULTIPLY | Operation::DIVIDE | Operation::REMAINDER => 6,
            Operation::NEGATE => 7,
            Operation::POWER => 8,
            _ => return None,
        })
    }

    pub(super) fn word(self) -> &'static str {
        let mut all = Operation::ALL.iter();
        all.find(|(operation, ..)| *operation == self)
            .map_or("", |(_, word, _)| word)
    }
}

/// Prints the formula; parsing the text gives the same formula.
impl Display for Formula {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        self.write(f, &self.expression, 0)
    }
}

impl Formula {
    /// Writes an expression, in brackets if its precedence is lower than that of the enclosing operation.
    fn write(&self, f: &mut Formatter<'_>, expression: &Expression, around: u8) -> fmt::Result {
        let (operation, operands) = match expression {
            Expression::Number(number) if *number == core::f64::consts::PI => {
                return f.write_str("pi");
            }
            Expression::Number(number) => return number.fmt(f),
            Expression::Variable(index) => {
                let variable = self.variables.get(*index);
                return name(f, variable.map_or("", |variable| &variable.name));
            }
            Expression::Apply(operation, operands) => (*operation, operands.as_slice()),
        };
        let Some(binds) = operation.binds() else {
            f.write_str(operation.word())?;
            f.write_char('(')?;
            for (i, operand) in operands.iter().enumerate() {
                if i > 0 {
                    f.write_str(", ")?;
                }
                self.write(f, operand, 0)?;
            }
            return f.write_char(')');
        };
        if binds < around {
            f.write_char('(')?;
        }
        match (operation, operands) {
            (Operation::NOT, [operand]) => {
                f.write_str("not ")?;
                self.write(f, operand, binds)?;
            }
            (_, [operand]) => {
                f.write_str(operation.word())?;
                self.write(f, operand, binds)?;
            }
            (Operation::POWER, [base, exponent]) => {
                self.write(f, base, binds + 1)?;
                f.write_char('^')?;
                // To the right of the operator, a sign needs no brackets, and powers may be nested.
                self.write(f, exponent, binds - 1)?;
            }
            (_, [left, right]) => {
                // Comparisons cannot be chained; the left operand of any other operator may have the same precedence.
                let left_around = if binds == 4 { binds + 1 } else { binds };
                self.write(f, left, left_around)?;
                write!(f, " {} ", operation.word())?;
                self.write(f, right, binds + 1)?;
            }
            _ => {}
        }
        if binds < around {
            f.write_char(')')?;
        }
        Ok(())
    }
}

/// Writes a name, in quotes if necessary.
fn name(f: &mut Formatter<'_>, name: &str) -> fmt::Result {
    if is_plain_name(name) {
        return f.write_str(name);
    }
    f.write_char('"')?;
    for c in name.chars() {
        if matches!(c, '"' | '\\') {
            f.write_char('\\')?;
        }
        f.write_char(c)?;
    }
    f.write_char('"')
}
