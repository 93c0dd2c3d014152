//! Numbers of several rows.
//!
//! A single evaluation is one of one row. Each step over rows is a loop that the compiler turns into vector instructions; a
//! choice by a mask keeps it from making a branch for each row. The operations of a row and their order do not depend on the
//! number of rows, so the bits are the same.

#[cfg(feature = "alloc")]
use alloc::{vec, vec::Vec};
#[cfg(feature = "alloc")]
use core::ops::{Deref, DerefMut};

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

/// Numbers of `L` rows each. Those of several rows begin where a cache line does, because a vector that lies on two lines takes
/// twice as long.
#[cfg(feature = "alloc")]
#[derive(Debug, Clone)]
pub(crate) struct Rows<const L: usize> {
    numbers: Vec<f64>,
    /// Where the first row begins.
    start: usize,
}

#[cfg(feature = "alloc")]
impl<const L: usize> Rows<L> {
    /// So many, all 0.
    pub(crate) fn new(count: usize) -> Self {
        const LINE: usize = 64;
        let spare = if L > 1 {
            LINE / size_of::<f64>() - 1
        } else {
            0
        };
        let numbers = vec![0.0; count * L + spare];
        let start = numbers.as_ptr().align_offset(LINE).min(spare);
        Rows { numbers, start }
    }
}

#[cfg(feature = "alloc")]
impl<const L: usize> Deref for Rows<L> {
    type Target = [[f64; L]];

    #[inline(always)]
    fn deref(&self) -> &[[f64; L]] {
        let start = if L > 1 { self.start } else { 0 };
        self.numbers[start..].as_chunks().0
    }
}

#[cfg(feature = "alloc")]
impl<const L: usize> DerefMut for Rows<L> {
    #[inline(always)]
    fn deref_mut(&mut self) -> &mut [[f64; L]] {
        let start = if L > 1 { self.start } else { 0 };
        self.numbers[start..].as_chunks_mut().0
    }
}
