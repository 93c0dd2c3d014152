//! The caller's memory, given out piece by piece.

use core::mem::{align_of, size_of};

use crate::status::Status;

/// What the memory must be aligned to.
const ALIGNMENT: usize = 16;

/// What is left of the caller's memory.
pub(crate) struct Block {
    next: *mut u8,
    left: usize,
}

impl Block {
    /// # Safety
    /// `memory` is null or points to `size` bytes that nothing else uses as long as what is placed in them is used.
    #[allow(unsafe_code, reason = "foreign memory")]
    pub(crate) unsafe fn new(memory: *mut u8, size: usize) -> Result<Block, Status> {
        if memory.is_null() {
            return Err(Status::NullPointer);
        }
        if !memory.addr().is_multiple_of(ALIGNMENT) {
            return Err(Status::MemorySize);
        }
        Ok(Block {
            next: memory,
            left: size,
        })
    }

    /// Puts one value into the memory.
    #[allow(unsafe_code, reason = "foreign memory")]
    pub(crate) fn place<T>(&mut self, value: T) -> Result<&'static mut T, Status> {
        let place = self.reserve::<T>(1)?;
        // SAFETY: reserved for one value; once it is written it is given out once, and by the promise on the block it stays.
        unsafe {
            place.write(value);
            Ok(&mut *place)
        }
    }

    /// Puts the same value into the memory many times.
    pub(crate) fn fill<T: Copy>(
        &mut self,
        count: usize,
        value: T,
    ) -> Result<&'static mut [T], Status> {
        self.repeat(count, |_| Ok(value))
    }

    /// Puts values into the memory, one after the other.
    #[allow(unsafe_code, reason = "foreign memory")]
    pub(crate) fn repeat<T>(
        &mut self,
        count: usize,
        value: impl Fn(usize) -> Result<T, Status>,
    ) -> Result<&'static mut [T], Status> {
        let first = self.reserve::<T>(count)?;
        for i in 0..count {
            let value = value(i)?;
            // SAFETY: within what was reserved.
            unsafe { first.add(i).write(value) };
        }
        // SAFETY: all were just written, they are given out once, and by the promise on the block they stay.
        Ok(unsafe { core::slice::from_raw_parts_mut(first, count) })
    }

    /// Room for values that nothing else uses, aligned.
    #[allow(unsafe_code, reason = "foreign memory")]
    fn reserve<T>(&mut self, count: usize) -> Result<*mut T, Status> {
        let skipped = self.next.align_offset(align_of::<T>());
        let bytes = count.checked_mul(size_of::<T>());
        let needed = bytes.and_then(|bytes| bytes.checked_add(skipped));
        let needed = needed.filter(|needed| *needed <= self.left);
        let needed = needed.ok_or(Status::MemorySize)?;
        // SAFETY: `needed`, of which `skipped` is a part, is no more than what is left of the block behind `next`.
        let (first, next) = unsafe { (self.next.add(skipped), self.next.add(needed)) };
        self.next = next;
        self.left -= needed;
        Ok(first.cast())
    }
}
