//! Interval type-2 terms: terms with an upper and a lower membership function.

use alloc::string::String;

use super::{Activation, MembershipFunction, Model, Output, Rule, Term, Variable, concludes};
#[cfg(feature = "check")]
use crate::rule::Condition;
use crate::rule::{Hedge, Proposition};
pub use crate::table::TypeReduction;

/// The lower membership function of an interval type-2 term.
///
/// # Example: the degree of 27 lies between 0.5 and 0.7
/// ```
/// use fuzzy::model::{LowerFunction, MembershipFunction, Term};
///
/// let hot = Term {
///     name: "hot".into(),
///     membership_function: MembershipFunction::RightShoulder { foot: 20.0, top: 30.0 },
///     height: 1.0,
///     lower: Some(LowerFunction {
///         membership_function: MembershipFunction::RightShoulder { foot: 22.0, top: 32.0 },
///         height: 1.0,
///     }),
/// };
/// assert_eq!(hot.lower_membership(27.0), 0.5);
/// assert_eq!(hot.membership(27.0), 0.7);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct LowerFunction {
    /// The membership function, nowhere above the upper one.
    pub membership_function: MembershipFunction,
    /// The height of the membership function, in (0, 1].
    pub height: f64,
}

/// The lower or the upper bound of a degree or a firing strength.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Bound {
    Lower,
    Upper,
}

impl Bound {
    /// Returns the bound of x that determines this bound of 1 - x.
    pub(crate) fn opposite(self) -> Self {
        match self {
            Bound::Lower => Bound::Upper,
            Bound::Upper => Bound::Lower,
        }
    }

    /// Returns the bound of a degree of membership that determines this bound of the degree with hedges.
    pub(crate) fn through(self, hedges: &[Hedge]) -> Self {
        let nots = hedges.iter().filter(|hedge| **hedge == Hedge::Not);
        nots.fold(self, |bound, _| bound.opposite())
    }
}

impl Term {
    /// Returns the lower degree of membership of `x`. If the term has no lower membership function, this is the result
    /// of [`Term::membership`].
    #[must_use]
    pub fn lower_membership(&self, x: f64) -> f64 {
        match &self.lower {
            None => self.membership(x),
            Some(lower) => lower.height * lower.membership_function.membership(x),
        }
    }

    /// Returns a bound of the degree of membership of `x`.
    pub(crate) fn bound(&self, bound: Bound, x: f64) -> f64 {
        match bound {
            Bound::Lower => self.lower_membership(x),
            Bound::Upper => self.membership(x),
        }
    }

    /// Returns the term with only its lower, or only its upper membership function.
    pub(crate) fn only(&self, bound: Bound) -> Term {
        match (&self.lower, bound) {
            (Some(lower), Bound::Lower) => Term {
                name: self.name.clone(),
                membership_function: lower.membership_function.clone(),
                height: lower.height,
                lower: None,
            },
            (None, _) | (Some(_), Bound::Upper) => Term {
                lower: None,
                ..self.clone()
            },
        }
    }
}

impl Variable {
    /// Adds an interval type-2 term, whose membership functions both have the height 1.
    #[must_use]
    pub fn interval_term(
        mut self,
        name: impl Into<String>,
        upper: MembershipFunction,
        lower: MembershipFunction,
    ) -> Self {
        self.terms.push(Term {
            name: name.into(),
            membership_function: upper,
            height: 1.0,
            lower: Some(LowerFunction {
                membership_function: lower,
                height: 1.0,
            }),
        });
        self
    }

    pub(crate) fn has_type2_terms(&self) -> bool {
        self.terms.iter().any(|term| term.lower.is_some())
    }
}

impl Model {
    /// Returns whether a term of an input or output has a lower membership function, which makes this an interval
    /// type-2 rule set.
    #[must_use]
    pub fn has_type2_terms(&self) -> bool {
        self.variables().any(Variable::has_type2_terms)
    }

    /// Returns the term that a proposition names, if it is a type-2 term.
    pub(crate) fn type2_term(&self, proposition: &Proposition) -> Option<&Term> {
        let name = &proposition.variable.text;
        let variable = self.variables().find(|known| known.name == *name)?;
        let name = &proposition.term.as_ref()?.text;
        let term = variable.terms.iter().find(|term| term.name == *name)?;
        term.lower.is_some().then_some(term)
    }

    /// Returns whether the condition of a rule reads a type-2 term, so that its firing strength is an interval.
    pub(crate) fn reads_type2(&self, rule: &Rule) -> bool {
        let mut found = false;
        rule.rule
            .condition
            .visit(&mut |proposition| found |= self.type2_term(proposition).is_some());
        found
    }

    /// Returns whether the value of an output is the middle of an interval: the output has type-2 terms, or one of its
    /// rules reads such terms. If the output reads another output whose value is the middle of an interval, it uses
    /// only that value.
    #[must_use]
    pub fn has_interval(&self, output: &Output) -> bool {
        let mut rules = self.rules.iter();
        output.variable.has_type2_terms()
            || rules.any(|rule| {
                self.is_enabled(rule) && concludes(rule, output) && self.reads_type2(rule)
            })
    }

    /// Returns whether NOT is applied to a type-2 term in a condition.
    #[cfg(feature = "check")]
    pub(crate) fn negates_type2(&self) -> bool {
        let mut rules = self.rules.iter();
        rules.any(|rule| self.negates(&rule.rule.condition, Bound::Upper))
    }

    #[cfg(feature = "check")]
    fn negates(&self, condition: &Condition, bound: Bound) -> bool {
        match condition {
            Condition::Is(proposition) => {
                self.type2_term(proposition).is_some()
                    && bound.through(&proposition.hedges) == Bound::Lower
            }
            Condition::Not(inner) => self.negates(inner, bound.opposite()),
            Condition::And(parts) | Condition::Or(parts) => {
                parts.iter().any(|part| self.negates(part, bound))
            }
        }
    }

    /// Returns the first rule that reads a type-2 term and is subject to an activation method. The selection of rules is
    /// not monotone in their strengths, so the strengths have no lower and upper bounds.
    pub(crate) fn selected_type2_rule(&self) -> Option<usize> {
        let mut rules = self.rules.iter();
        rules.position(|rule| {
            self.is_enabled(rule)
                && self.activation_of(rule) != Activation::General
                && self.reads_type2(rule)
        })
    }
}
