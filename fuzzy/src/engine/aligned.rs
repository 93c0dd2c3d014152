//! Aligned memory for the numbers of several rows.

use alloc::{vec, vec::Vec};
use core::ops::{Deref, DerefMut};

/// Several numbers for each of `L` rows. If `L` is larger than 1, they start at the beginning of a cache line, because
/// accessing a vector that spans two cache lines takes twice as long.
#[derive(Debug, Clone)]
pub(super) struct AlignedRows<const L: usize> {
    numbers: Vec<f64>,
    /// The index in `numbers` at which the rows start.
    start: usize,
}

impl<const L: usize> AlignedRows<L> {
    /// Creates `count` numbers per row, all 0.
    pub(super) fn new(count: usize) -> Self {
        const LINE: usize = 64;
        let spare = if L > 1 {
            LINE / size_of::<f64>() - 1
        } else {
            0
        };
        let numbers = vec![0.0; count * L + spare];
        let start = numbers.as_ptr().align_offset(LINE).min(spare);
        AlignedRows { numbers, start }
    }
}

impl<const L: usize> Deref for AlignedRows<L> {
    type Target = [[f64; L]];

    #[inline(always)]
    fn deref(&self) -> &[[f64; L]] {
        let start = if L > 1 { self.start } else { 0 };
        self.numbers[start..].as_chunks().0
    }
}

impl<const L: usize> DerefMut for AlignedRows<L> {
    #[inline(always)]
    fn deref_mut(&mut self) -> &mut [[f64; L]] {
        let start = if L > 1 { self.start } else { 0 };
        self.numbers[start..].as_chunks_mut().0
    }
}
