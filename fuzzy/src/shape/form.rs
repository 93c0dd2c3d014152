//! The spelling of shapes with a fixed number of parameters: one table for parsing, writing and validating them.

use alloc::vec::Vec;

use super::MembershipFunction;

/// The spelling of a shape in rule sets.
pub(crate) struct ShapeForm {
    /// The key of the shape.
    pub(crate) name: &'static str,
    /// The name and role of each parameter, in the order in which a list contains their values.
    pub(crate) parameters: &'static [(&'static str, Role)],
    /// A description for the schema.
    #[cfg_attr(
        not(feature = "serde"),
        allow(dead_code, reason = "only the schema contains it")
    )]
    pub(crate) about: &'static str,
    /// Builds the shape from values; `None` if their number is wrong.
    pub(crate) build: fn(&[f64]) -> Option<MembershipFunction>,
}

/// The valid values of a parameter of a membership function; all must be finite.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// A position on the axis, not left of the previous one.
    Ascending,
    /// A number above 0, such as a width or a standard deviation.
    Positive,
    /// Any finite number.
    Number,
}

impl ShapeForm {
    /// Returns whether the parameters may be written as a list. This is allowed only if all are positions, because
    /// programs order other parameters differently: `gaussian: [1, 5]` means mean 1 in one program and mean 5 in
    /// another.
    pub(crate) fn as_list(&self) -> bool {
        self.parameters
            .iter()
            .all(|(_, role)| *role == Role::Ascending)
    }

    /// Returns the names of the parameters.
    pub(crate) fn names(&self) -> Vec<&'static str> {
        self.parameters.iter().map(|(name, _)| *name).collect()
    }
}

/// The parts of a shape.
pub(crate) enum ShapeParts<'a> {
    /// A shape with a fixed number of parameters, with their values.
    Fixed(&'static ShapeForm, Vec<f64>),
    /// The points of a piecewise shape.
    Points(&'a [(f64, f64)]),
    /// A formula.
    Formula(&'a crate::formula::Formula),
    /// The coefficients and the constant of a linear function.
    Linear(&'a [(alloc::string::String, f64)], f64),
}

/// Pads parameters with zeros.
pub(super) fn padded(parameters: &[f64]) -> [f64; 4] {
    let mut padded = [0.0; 4];
    for (place, parameter) in padded.iter_mut().zip(parameters) {
        *place = *parameter;
    }
    padded
}

/// Defines the table of forms and the functions that use it. A shape without a row in the table is a compile error.
macro_rules! forms {
    ($($shape:ident $name:literal $formula:ident [$($parameter:ident: $role:ident),+] $about:literal;)+) => {
        impl MembershipFunction {
            /// The forms of all shapes with a fixed number of parameters.
            pub(crate) const FORMS: &[ShapeForm] = &[$(form::forms!(@form $shape $name [$($parameter: $role),+] $about)),+];

            /// Returns the parts of this shape.
            pub(crate) fn parts(&self) -> ShapeParts<'_> {
                match *self {
                    $(MembershipFunction::$shape { $($parameter),+ } => ShapeParts::Fixed(
                        const { &form::forms!(@form $shape $name [$($parameter: $role),+] $about) },
                        vec![$($parameter),+],
                    ),)+
                    MembershipFunction::Piecewise { ref points } => ShapeParts::Points(points),
                    MembershipFunction::Function { ref formula } => ShapeParts::Formula(formula),
                    MembershipFunction::Linear { ref coefficients, constant } => ShapeParts::Linear(coefficients, constant),
                }
            }

            /// Returns the formula and its parameters. The points of a piecewise shape and the code of a formula are
            /// not included. `Linear` is not a membership function and is 0 everywhere.
            pub(crate) fn kind(&self) -> (ShapeKind, [f64; 4]) {
                match *self {
                    $(MembershipFunction::$shape { $($parameter),+ } => (ShapeKind::$formula, form::padded(&[$($parameter),+])),)+
                    MembershipFunction::Piecewise { .. } => (ShapeKind::PIECEWISE, [0.0; 4]),
                    MembershipFunction::Function { .. } => (ShapeKind::FUNCTION, [0.0; 4]),
                    MembershipFunction::Linear { .. } => (ShapeKind::CONSTANT, [0.0; 4]),
                }
            }
        }
    };
    (@form $shape:ident $name:literal [$($parameter:ident: $role:ident),+] $about:literal) => {
        ShapeForm {
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
