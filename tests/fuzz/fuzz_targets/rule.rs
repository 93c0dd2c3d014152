//! Any text as a rule: it is a rule that prints and reads back as itself, or a mistake inside the text.
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    match fuzzy::rule::parse(text) {
        Ok(rule) => assert_eq!(fuzzy::rule::parse(&rule.to_string()), Ok(rule)),
        Err(mistake) => assert!(text.get(mistake.span).is_some()),
    }
});
