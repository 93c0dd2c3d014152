//! Takagi-Sugeno consequents.

use alloc::vec::Vec;

use crate::model::Shape;
use crate::table::{Coefficient, Consequent};

/// The consequents of the terms of an output, with spans in their own coefficients.
#[derive(Debug, Clone, Default)]
pub(crate) struct Consequents {
    pub(crate) consequents: Vec<Consequent>,
    pub(crate) coefficients: Vec<Coefficient>,
}

impl Consequents {
    /// Adds the consequent of a term and returns `true`, or returns `false` where its shape is no consequent. A singleton is
    /// a constant. Calls `unknown` with the names of inputs that `input` does not find.
    pub(crate) fn push(
        &mut self,
        shape: &Shape,
        input: impl Fn(&str) -> Option<usize>,
        mut unknown: impl FnMut(&str),
    ) -> bool {
        let first = self.coefficients.len();
        let constant = match shape {
            Shape::Constant { value: constant } | Shape::Singleton { at: constant } => constant,
            Shape::Linear {
                coefficients,
                constant,
            } => {
                for (name, coefficient) in coefficients {
                    match input(name) {
                        Some(index) => self.coefficients.push(Coefficient {
                            coefficient: *coefficient,
                            input: index as u32,
                        }),
                        None => unknown(name),
                    }
                }
                // By input, so that the order in the text does not change a bit of the sum.
                self.coefficients[first..].sort_by_key(|coefficient| coefficient.input);
                constant
            }
            _ => return false,
        };
        self.consequents.push(Consequent {
            constant: *constant,
            first: first as u32,
            end: self.coefficients.len() as u32,
        });
        true
    }
}
