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

/// Writes a number for each row. Making an array first would fill it with zeros.
#[inline(always)]
pub(crate) fn set<const L: usize>(numbers: &mut [f64; L], mut of_row: impl FnMut(usize) -> f64) {
    for (row, number) in numbers.iter_mut().enumerate() {
        *number = of_row(row);
    }
}

/// Changes the number of each row.
#[inline(always)]
pub(crate) fn change<const L: usize>(numbers: &mut [f64; L], change: impl Fn(f64) -> f64) {
    for number in numbers {
        *number = change(*number);
    }
}

/// Joins the numbers of each row with others.
#[inline(always)]
pub(crate) fn join<const L: usize>(
    numbers: &mut [f64; L],
    others: &[f64; L],
    join: impl Fn(f64, f64) -> f64,
) {
    for (number, other) in numbers.iter_mut().zip(others) {
        *number = join(*number, *other);
    }
}
