//! Arrays that the caller passes.

use crate::status::Status;

/// A C array and its length.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub(crate) struct Array<T> {
    pub(crate) items: *const T,
    pub(crate) count: usize,
}

impl<T> Array<T> {
    /// The array as a slice.
    ///
    /// # Safety
    /// The pointer must be null or have `count` items, which must not change while the slice is used.
    #[allow(unsafe_code, reason = "foreign memory")]
    pub(crate) unsafe fn read<'a>(&self) -> Result<&'a [T], Status> {
        if self.count == 0 {
            return Ok(&[]);
        }
        if self.items.is_null() || !self.items.is_aligned() {
            return Err(Status::NullPointer);
        }
        // No object is larger than `isize::MAX` bytes, so a larger count can only come from damaged data.
        let bytes = self.count.checked_mul(size_of::<T>());
        if bytes.is_none_or(|bytes| bytes > isize::MAX as usize) {
            return Err(Status::DamagedPlan);
        }
        // SAFETY: the pointer is neither null nor unaligned, the size does not exceed `isize::MAX`, and the caller
        // promises that the items are valid.
        Ok(unsafe { core::slice::from_raw_parts(self.items, self.count) })
    }
}
