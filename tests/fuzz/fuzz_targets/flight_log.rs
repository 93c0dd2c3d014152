//! Any bytes are a flight, an error, or neither for long: never a panic. The content tells
//! the format, so this target is that of all of them; seeds are small logs of each.

#![no_main]

use flightlog::{Options, read};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let Ok(flight) = read(bytes, &Options::default()) else {
        return;
    };
    // What a user would ask next must hold as well.
    let _ = flight.gaps();
    let _ = flight.statistics();
    let mut csv = Vec::new();
    if flight.write_csv(&mut csv).is_ok() && !flight.commands.is_empty() {
        let again = read(&csv[..], &Options::default());
        assert!(again.is_ok(), "what was written is not read back: {again:?}");
    }
});
