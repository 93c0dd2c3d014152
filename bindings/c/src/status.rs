//! Status codes.

use core::ffi::CStr;

/// A status code: `enum flagred_status` in C.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Status {
    Ok = 0,
    NullPointer = 1,
    OtherFormat = 2,
    DamagedPlan = 3,
    NoMotors = 4,
    MemorySize = 5,
    BadLimits = 6,
    BadGeometry = 7,
    WrongCount = 8,
}

/// Returns a description of a status, as a static C string.
pub(crate) fn text(status: i32) -> &'static CStr {
    match status {
        0 => c"ok",
        1 => c"a required pointer is NULL",
        2 => c"another version exported the plan: export it again",
        3 => c"damaged plan: an index is out of bounds",
        4 => c"the profile reads a motor that the vehicle does not have",
        5 => c"the memory is too small, or not aligned to 16 bytes",
        6 => c"the lower limit of a motor is not below its upper limit",
        7 => c"the factors of the motors do not separate roll, pitch, yaw and thrust, or a motor has none",
        8 => c"the numbers of values or outcomes differ from those of inputs or outputs, or there are too many commands",
        _ => c"unknown status",
    }
}
