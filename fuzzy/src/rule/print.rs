//! Printing rules; parsing the printed text gives the same syntax tree.

use core::fmt::{self, Display, Formatter, Write};

use super::{Condition, Consequent, Name, Proposition, Rule, is_plain_name};

/// Prints the rule; parsing the text gives the same rule.
impl Display for Rule {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "IF {} THEN ", self.condition)?;
        joined(f, &self.consequents, " AND ", |f, c| c.fmt(f))?;
        if self.weight != 1.0 {
            write!(f, " WITH {}", self.weight)?;
        }
        Ok(())
    }
}

impl Display for Condition {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Condition::Is(proposition) => proposition.fmt(f),
            Condition::Not(inner) => {
                f.write_str("NOT ")?;
                bracketed(
                    f,
                    inner,
                    matches!(**inner, Condition::And(_) | Condition::Or(_)),
                )
            }
            Condition::And(parts) => joined(f, parts, " AND ", |f, part| {
                bracketed(
                    f,
                    part,
                    matches!(part, Condition::And(_) | Condition::Or(_)),
                )
            }),
            Condition::Or(parts) => joined(f, parts, " OR ", |f, part| {
                bracketed(f, part, matches!(part, Condition::Or(_)))
            }),
        }
    }
}

impl Display for Proposition {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "{} IS", self.variable)?;
        for hedge in &self.hedges {
            write!(f, " {}", hedge.word())?;
        }
        match &self.term {
            Some(term) => write!(f, " {term}"),
            None => Ok(()),
        }
    }
}

impl Display for Consequent {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "{} IS ", self.output)?;
        for hedge in &self.hedges {
            write!(f, "{} ", hedge.word())?;
        }
        self.term.fmt(f)
    }
}

/// Prints the name, in quotes if necessary.
impl Display for Name {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        if is_plain_name(&self.text) {
            return f.write_str(&self.text);
        }
        f.write_char('"')?;
        for c in self.text.chars() {
            if matches!(c, '"' | '\\') {
                f.write_char('\\')?;
            }
            f.write_char(c)?;
        }
        f.write_char('"')
    }
}

fn bracketed(f: &mut Formatter<'_>, condition: &Condition, brackets: bool) -> fmt::Result {
    if brackets {
        write!(f, "({condition})")
    } else {
        condition.fmt(f)
    }
}

fn joined<T>(
    f: &mut Formatter<'_>,
    parts: &[T],
    between: &str,
    print: impl Fn(&mut Formatter<'_>, &T) -> fmt::Result,
) -> fmt::Result {
    for (i, part) in parts.iter().enumerate() {
        if i > 0 {
            f.write_str(between)?;
        }
        print(f, part)?;
    }
    Ok(())
}
