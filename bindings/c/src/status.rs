//! What functions return.

use core::ffi::CStr;

/// Whether something went well, or why not.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Status {
    Ok = 0,
    NullPointer = 1,
    OtherFormat = 2,
    DamagedPlan = 3,
    NoMotors = 4,
    MemorySize = 5,
    BadLimits = 6,
}

/// A status in words.
pub(crate) fn text(status: i32) -> &'static CStr {
    match status {
        0 => c"all is well",
        1 => c"a pointer that must not be null is null",
        2 => c"the plan was exported by another version: export it again",
        3 => c"the plan is damaged: it points beyond its own arrays",
        4 => c"there is no motor to watch",
        5 => c"the memory is too small, or not aligned to 16 bytes",
        6 => c"the lower limit of a motor is not below its upper one",
        _ => c"no status of this library",
    }
}
