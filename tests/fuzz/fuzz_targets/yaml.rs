//! Any text as a rule set: it is a model that saves, loads as itself and compiles, or findings inside the text.
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    match fuzzy::yaml::parse(text) {
        Ok(document) => {
            let saved = fuzzy::yaml::to_string(&document.model);
            let again = fuzzy::yaml::parse(&saved).map(|d| d.model);
            assert_eq!(again.as_ref(), Ok(&document.model), "{saved}");
            if let Err(error) = fuzzy::Engine::new(&document.model) {
                panic!("it loads but does not compile: {error}");
            }
        }
        Err(findings) => {
            assert!(findings.has_errors());
            for finding in findings.0 {
                assert!(text.get(finding.span).is_some());
            }
        }
    }
});
