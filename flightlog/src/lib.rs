//! One `Flight` out of every log a multirotor pilot has.
