//! Takagi-Sugeno consequents.

use alloc::vec::Vec;

use crate::model::{MembershipFunction, Term};
use crate::table::{Coefficient, Consequent, Point};

/// The consequents of the terms of an output. Their index ranges refer to the coefficients and the code in this struct.
#[derive(Debug, Clone, Default)]
pub(crate) struct Consequents {
    pub(crate) consequents: Vec<Consequent>,
    pub(crate) coefficients: Vec<Coefficient>,
    pub(crate) code: Vec<Point>,
}

impl Consequents {
    /// Creates the consequents of the terms of a valid model; `input` returns the index of an input by its name.
    pub(crate) fn new(terms: &[Term], input: impl Fn(&str) -> Option<usize>) -> Self {
        let mut consequents = Consequents::default();
        for term in terms {
            consequents.push(&term.membership_function, &input);
        }
        consequents
    }

    /// Adds the consequent of a term. A singleton is treated as a constant.
    fn push(&mut self, shape: &MembershipFunction, input: impl Fn(&str) -> Option<usize>) {
        let (first, first_code) = (self.coefficients.len(), self.code.len());
        let constant = match shape {
            MembershipFunction::Constant { value: constant }
            | MembershipFunction::Singleton { at: constant } => *constant,
            MembershipFunction::Linear {
                coefficients,
                constant,
            } => {
                for (name, coefficient) in coefficients {
                    self.coefficients
                        .extend(input(name).map(|index| Coefficient {
                            coefficient: *coefficient,
                            input: index as u32,
                        }));
                }
                // The coefficients are sorted by input, so that the order in the text does not affect the bits of the
                // sum.
                self.coefficients[first..].sort_by_key(|coefficient| coefficient.input);
                *constant
            }
            MembershipFunction::Function { formula } => {
                self.code.extend(formula.code_with(input));
                0.0
            }
            _ => return,
        };
        self.consequents.push(Consequent {
            constant,
            first: first as u32,
            end: self.coefficients.len() as u32,
            first_code: first_code as u32,
            end_code: self.code.len() as u32,
        });
    }
}
