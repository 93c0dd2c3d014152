//! Divides the memory that the caller provides.

use core::mem::{align_of, size_of};

use crate::status::Status;

/// The alignment of the memory.
const ALIGNMENT: usize = 16;

/// The unused rest of the caller's memory.
pub(crate) struct Block {
    next: *mut u8,
    left: usize,
}

impl Block {
    /// # Safety
    /// `memory` must be null or point to `size` bytes that nothing else uses while the values placed there are used.
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

    /// Stores one value in the memory.
    #[allow(unsafe_code, reason = "foreign memory")]
    pub(crate) fn store<T>(&mut self, value: T) -> Result<&'static mut T, Status> {
        let pointer = self.reserve::<T>(1)?;
        // SAFETY: reserved for one value, which is written before its only reference is made.
        unsafe {
            pointer.write(value);
            Ok(&mut *pointer)
        }
    }

    /// Stores copies of a value in the memory.
    pub(crate) fn fill<T: Copy>(
        &mut self,
        count: usize,
        value: T,
    ) -> Result<&'static mut [T], Status> {
        self.repeat(count, |_| Ok(value))
    }

    /// Stores values in the memory.
    #[allow(unsafe_code, reason = "foreign memory")]
    pub(crate) fn repeat<T>(
        &mut self,
        count: usize,
        value: impl Fn(usize) -> Result<T, Status>,
    ) -> Result<&'static mut [T], Status> {
        let first = self.reserve::<T>(count)?;
        for i in 0..count {
            let value = value(i)?;
            // SAFETY: within the reserved memory.
            unsafe { first.add(i).write(value) };
        }
        // SAFETY: reserved for `count` values, which are written before their only reference is made.
        Ok(unsafe { core::slice::from_raw_parts_mut(first, count) })
    }

    /// Reserves aligned memory for values.
    #[allow(unsafe_code, reason = "foreign memory")]
    fn reserve<T>(&mut self, count: usize) -> Result<*mut T, Status> {
        let skipped = self.next.align_offset(align_of::<T>());
        let bytes = count.checked_mul(size_of::<T>());
        let needed = bytes.and_then(|bytes| bytes.checked_add(skipped));
        let needed = needed.filter(|needed| *needed <= self.left);
        let needed = needed.ok_or(Status::MemorySize)?;
        // SAFETY: `skipped <= needed <= left`, so both pointers are within the block.
        let (first, next) = unsafe { (self.next.add(skipped), self.next.add(needed)) };
        self.next = next;
        self.left -= needed;
        Ok(first.cast())
    }
}
