//! Numbers of several rows.
//!
//! A single evaluation is one of one row. Each step over rows is a loop that the compiler turns into vector instructions; a
//! choice by a mask keeps it from making a branch for each row. The operations of a row and their order do not depend on the
//! number of rows, so the bits are the same.

/// A number for each row. Unlike [`core::array::from_fn`] it is inlined into functions for wide vectors.
#[inline(always)]
pub(crate) fn each<const L: usize>(mut of_row: impl FnMut(usize) -> f64) -> [f64; L] {
    let mut numbers = [0.0; L];
    for (row, number) in numbers.iter_mut().enumerate() {
        *number = of_row(row);
    }
    numbers
}

/// An operator on each row of two numbers.
#[inline(always)]
pub(crate) fn joined<const L: usize>(
    a: &[f64; L],
    b: &[f64; L],
    operator: impl Fn(f64, f64) -> f64,
) -> [f64; L] {
    each(|row| operator(a[row], b[row]))
}
