//! Operations on the numbers of several rows.
//!
//! A single evaluation is an evaluation of one row. Each operation on rows is a loop that the compiler turns into
//! vector instructions; selecting by a mask prevents it from branching per row. The operations of a row and their order
//! do not depend on the number of rows, so the results are bitwise equal.

/// Returns an array with one number per row. Unlike [`core::array::from_fn`], this function is inlined into functions
/// that use wide vectors.
#[inline(always)]
pub(crate) fn each<const L: usize>(mut of_row: impl FnMut(usize) -> f64) -> [f64; L] {
    let mut numbers = [0.0; L];
    for (row, number) in numbers.iter_mut().enumerate() {
        *number = of_row(row);
    }
    numbers
}

/// Writes a number per row. This avoids filling a new array with zeros first.
#[inline(always)]
pub(crate) fn set<const L: usize>(numbers: &mut [f64; L], mut of_row: impl FnMut(usize) -> f64) {
    for (row, number) in numbers.iter_mut().enumerate() {
        *number = of_row(row);
    }
}

/// Applies a function to the number of each row.
#[inline(always)]
pub(crate) fn change<const L: usize>(numbers: &mut [f64; L], change: impl Fn(f64) -> f64) {
    for number in numbers {
        *number = change(*number);
    }
}

/// Combines the number of each row with the number of the same row in `others`.
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
