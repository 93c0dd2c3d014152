//! From firing strengths to a number.

pub(crate) mod integrals;
pub(crate) mod polyline;
