//! Passes the input to `flagred_tests::fuzzing::flight_log`.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| flagred_tests::fuzzing::flight_log(bytes));
