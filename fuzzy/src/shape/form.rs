//! How shapes with a fixed number of parameters are spelt: one table for reading, writing and checking them.

use alloc::vec::Vec;

use super::MembershipFunction;

/// A shape as rule sets spell it.
pub(crate) struct Form {
    /// Its key.
    pub(crate) name: &'static str,
    /// Its parameters, in the order of a list.
    pub(crate) parameters: &'static [(&'static str, Role)],
    /// What it is, for the schema.
    #[cfg_attr(
        not(feature = "serde"),
        allow(dead_code, reason = "only the schema tells it")
    )]
    pub(crate) about: &'static str,
    /// The shape of so many values.
    pub(crate) build: fn(&[f64]) -> Option<MembershipFunction>,
}

/// What a parameter of a membership function may be; all are finite numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// A position on the axis, not left of the one before.
    Ascending,
    /// Over 0: a width, a deviation.
    Positive,
    /// Any.
    Number,
}

impl Form {
    /// Whether the parameters may stand in a list. Only positions may: programs differ in the order of all others,
    /// `gaussian: [1, 5]` means mean 1 to one and mean 5 to another.
    pub(crate) fn as_list(&self) -> bool {
        self.parameters
            .iter()
            .all(|(_, role)| *role == Role::Ascending)
    }

    /// The names of the parameters.
    pub(crate) fn names(&self) -> Vec<&'static str> {
        self.parameters.iter().map(|(name, _)| *name).collect()
    }
}

/// A shape taken apart.
pub(crate) enum Parts<'a> {
    /// A form and the values of its parameters.
    Fixed(&'static Form, Vec<f64>),
    /// The points of a piecewise shape.
    Points(&'a [(f64, f64)]),
    /// A formula.
    Formula(&'a crate::formula::Formula),
    /// The coefficients and the constant of a linear function.
    Linear(&'a [(alloc::string::String, f64)], f64),
}

/// Parameters, and zeros behind them.
pub(super) fn padded(parameters: &[f64]) -> [f64; 4] {
    let mut padded = [0.0; 4];
    for (place, parameter) in padded.iter_mut().zip(parameters) {
        *place = *parameter;
    }
    padded
}

/// Makes the table of forms, and takes shapes apart by it, so that a shape without a line does not compile.
macro_rules! forms {
    ($($shape:ident $name:literal $formula:ident [$($parameter:ident: $role:ident),+] $about:literal;)+) => {
        impl MembershipFunction {
            /// The forms of all shapes with a fixed number of parameters.
            pub(crate) const FORMS: &[Form] = &[$(form::forms!(@form $shape $name [$($parameter: $role),+] $about)),+];

            /// The form and the values, or what a shape without a fixed number of parameters has.
            pub(crate) fn parts(&self) -> Parts<'_> {
                match *self {
                    $(MembershipFunction::$shape { $($parameter),+ } => Parts::Fixed(
                        const { &form::forms!(@form $shape $name [$($parameter: $role),+] $about) },
                        vec![$($parameter),+],
                    ),)+
                    MembershipFunction::Piecewise { ref points } => Parts::Points(points),
                    MembershipFunction::Function { ref formula } => Parts::Formula(formula),
                    MembershipFunction::Linear { ref coefficients, constant } => Parts::Linear(coefficients, constant),
                }
            }

            /// The formula and its parameters; of a piecewise shape the points are apart, of a formula its code, and `Linear` is no membership
            /// function: 0 everywhere.
            pub(crate) fn kind(&self) -> (Kind, [f64; 4]) {
                match *self {
                    $(MembershipFunction::$shape { $($parameter),+ } => (Kind::$formula, form::padded(&[$($parameter),+])),)+
                    MembershipFunction::Piecewise { .. } => (Kind::PIECEWISE, [0.0; 4]),
                    MembershipFunction::Function { .. } => (Kind::FUNCTION, [0.0; 4]),
                    MembershipFunction::Linear { .. } => (Kind::CONSTANT, [0.0; 4]),
                }
            }
        }
    };
    (@form $shape:ident $name:literal [$($parameter:ident: $role:ident),+] $about:literal) => {
        Form {
            name: $name,
            parameters: &[$((stringify!($parameter), Role::$role)),+],
            about: $about,
            build: |values| match *values {
                [$($parameter),+] => Some(MembershipFunction::$shape { $($parameter),+ }),
                _ => None,
            },
        }
    };
}
pub(super) use forms;
