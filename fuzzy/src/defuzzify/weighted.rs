//! Takagi-Sugeno consequents.

use alloc::vec::Vec;

use crate::model::MembershipFunction;

/// `z = constant + sum(coefficient input)`.
#[derive(Debug, Clone)]
pub(crate) struct Consequence {
    pub(crate) constant: f64,
    /// Input and coefficient.
    pub(crate) coefficients: Vec<(usize, f64)>,
}

impl Consequence {
    /// The consequent of a term; `None` of a shape that is no consequent. A singleton is a constant.
    /// Names of inputs that `input` does not know are given to `unknown`.
    pub(crate) fn new(
        shape: &MembershipFunction,
        input: impl Fn(&str) -> Option<usize>,
        mut unknown: impl FnMut(&str),
    ) -> Option<Self> {
        let (constant, coefficients) = match shape {
            MembershipFunction::Constant { value: constant }
            | MembershipFunction::Singleton { at: constant } => (*constant, Vec::new()),
            MembershipFunction::Linear {
                coefficients,
                constant,
            } => {
                let mut indexed = Vec::new();
                for (name, coefficient) in coefficients {
                    match input(name) {
                        Some(index) => indexed.push((index, *coefficient)),
                        None => unknown(name),
                    }
                }
                // By input, so that the order of the lines does not change a bit of the sum.
                indexed.sort_by_key(|(index, _)| *index);
                (*constant, indexed)
            }
            _ => return None,
        };
        Some(Consequence {
            constant,
            coefficients,
        })
    }
}
