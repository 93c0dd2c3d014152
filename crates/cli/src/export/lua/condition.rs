//! Conditions as expressions over the degrees of terms.

use fuzzy::{
    Model,
    model::{Conjunction, Disjunction, Operators},
    rule::{Condition, Hedge, Proposition},
};

use super::{UnsupportedFeature, comment, number};

/// Converts conditions to expressions over the degrees of terms.
pub(super) struct Expressions<'m> {
    pub(super) model: &'m Model,
    /// The operators of the current rule.
    pub(super) operators: Operators,
    /// The terms that the expressions use, by the index of the variable (inputs, then outputs) and of the term.
    pub(super) used: Vec<(usize, usize)>,
    functions: Vec<&'static str>,
}

impl<'m> Expressions<'m> {
    pub(super) fn new(model: &'m Model) -> Self {
        Expressions {
            model,
            operators: model.operators,
            used: Vec::new(),
            functions: Vec::new(),
        }
    }

    pub(super) fn condition(
        &mut self,
        condition: &Condition,
    ) -> Result<String, UnsupportedFeature> {
        match condition {
            Condition::Is(proposition) => Ok(self.proposition(proposition)),
            Condition::Not(inner) => Ok(format!("(1 - {})", self.condition(inner)?)),
            Condition::And(parts) => {
                let parts = self.conditions(parts)?;
                match self.operators.and {
                    Conjunction::Minimum => Ok(format!("min({})", parts.join(", "))),
                    Conjunction::Product => Ok(parts.join(" * ")),
                    _ => Err(operator("AND", "minimum and product")),
                }
            }
            Condition::Or(parts) => {
                let parts = self.conditions(parts)?;
                let fold = |function: &str| {
                    let mut parts = parts.iter();
                    let first = parts.next().cloned().unwrap_or_default();
                    parts.fold(first, |all, part| format!("{function}({all}, {part})"))
                };
                match self.operators.or {
                    Disjunction::Maximum => Ok(format!("max({})", parts.join(", "))),
                    Disjunction::BoundedSum => Ok(format!("min(1.0, {})", parts.join(" + "))),
                    Disjunction::ProbabilisticSum => {
                        let text = fold("either");
                        self.uses("either");
                        Ok(text)
                    }
                    _ => Err(operator("OR", "maximum, probabilistic_sum and bounded_sum")),
                }
            }
        }
    }

    fn conditions(&mut self, parts: &[Condition]) -> Result<Vec<String>, UnsupportedFeature> {
        parts.iter().map(|part| self.condition(part)).collect()
    }

    fn proposition(&mut self, proposition: &Proposition) -> String {
        let degree = match &proposition.term {
            None => "1.0".to_owned(),
            Some(term) => {
                let mut variables = self.model.variables().enumerate();
                let found =
                    variables.find(|(_, variable)| variable.name == proposition.variable.text);
                let place = found.and_then(|(index, variable)| {
                    let mut terms = variable.terms.iter();
                    Some((index, terms.position(|known| known.name == term.text)?))
                });
                // A model that compiles contains every variable and term that its rules name.
                let place = place.unwrap_or_default();
                let known = self.used.iter().position(|used| *used == place);
                let index = known.unwrap_or_else(|| {
                    self.used.push(place);
                    self.used.len() - 1
                });
                format!("d[{}]", index + 1)
            }
        };
        self.hedged(&proposition.hedges, degree)
    }

    pub(super) fn hedged(&mut self, hedges: &[Hedge], mut degree: String) -> String {
        for hedge in hedges.iter().rev() {
            degree = match hedge {
                Hedge::Not => format!("(1 - {degree})"),
                Hedge::Very => format!("{degree} ^ 2"),
                Hedge::Somewhat => format!("sqrt({degree})"),
                Hedge::Extremely => {
                    self.uses("extremely");
                    format!("extremely({degree})")
                }
                Hedge::Seldom => {
                    self.uses("seldom");
                    format!("seldom({degree})")
                }
                Hedge::Any => "1.0".into(),
            };
        }
        // A power binds more tightly than a product, but a power of a power needs parentheses.
        match hedges.len() {
            0 | 1 => degree,
            _ => format!("({degree})"),
        }
    }

    fn uses(&mut self, function: &'static str) {
        if !self.functions.contains(&function) {
            self.functions.push(function);
        }
    }

    pub(super) fn functions(&self) -> Vec<String> {
        let text = |name: &&str| match *name {
            "either" => "\nlocal function either(a, b)\n  return a + b * (1 - a)\nend",
            "extremely" => {
                "\nlocal function extremely(x)\n  return x <= 0.5 and 2 * x * x or 1 - 2 * (1 - x) * (1 - x)\nend"
            }
            _ => {
                "\nlocal function seldom(x)\n  return x <= 0.5 and sqrt(x / 2) or 1 - sqrt((1 - x) / 2)\nend"
            }
        };
        self.functions
            .iter()
            .flat_map(|name| text(name).lines())
            .map(str::to_owned)
            .collect()
    }
}

fn operator(operator: &str, known: &'static str) -> UnsupportedFeature {
    let message = format!("the script does not support the rule set's function for {operator}");
    match known {
        "minimum and product" => {
            UnsupportedFeature::new(message, "it supports `and: minimum` and `and: product`")
        }
        _ => UnsupportedFeature::new(
            message,
            "it supports `or: maximum`, `or: probabilistic_sum` and `or: bounded_sum`",
        ),
    }
}

/// Returns the corners of a term as numbers for the script, and a comment that names it.
pub(super) fn corners(
    model: &Model,
    (variable, term): (usize, usize),
) -> Result<(Vec<String>, String), UnsupportedFeature> {
    let what = match variable < model.inputs.len() {
        true => "input",
        false => "output",
    };
    let variable = model.variables().nth(variable);
    let Some((variable, term)) = variable.and_then(|of| Some((of, of.terms.get(term)?))) else {
        return Ok(<_>::default());
    };
    let mut corners = term.membership_function.corners().ok_or_else(|| {
        UnsupportedFeature::new(
            format!(
                "term `{}` of {what} `{}` is curved, which the script does not support",
                term.name, variable.name
            ),
            "the script supports terms of straight lines; `piecewise` can approximate a curve",
        )
    })?;
    // At a vertical side, the script uses the degree to the right of the side. A side at the end of the range has no
    // degree to its right.
    if let [.., (left, _), (right, _)] = *corners.as_slice()
        && left == right
        && right >= variable.high
    {
        corners.pop();
    }
    let numbers = corners.iter().filter(|(x, _)| x.is_finite());
    let numbers = numbers.flat_map(|(x, degree)| [number(*x), number(degree * term.height)]);
    let name = comment(&format!("{} {}", variable.name, term.name));
    Ok((numbers.collect(), name))
}
