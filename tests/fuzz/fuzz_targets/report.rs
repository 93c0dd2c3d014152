//! Passes the input to `flagred_tests::fuzzing::report`.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| flagred_tests::fuzzing::report(bytes));
