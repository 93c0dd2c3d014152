//! What is built into the program is what stands in `rules/`: a crate can only embed what is in its own package, so
//! `flagred/rules` holds copies.

use std::{fs, path::Path};

use flagred::shipped::{PROFILES, RULE_SETS};

#[test]
fn the_copies_in_the_package_are_those_in_rules() {
    let rules = Path::new(env!("CARGO_MANIFEST_DIR")).join("../rules");
    for shipped in RULE_SETS.iter().chain(&PROFILES) {
        let text = fs::read_to_string(rules.join(shipped.file)).unwrap();
        assert!(
            text == shipped.text,
            "flagred/rules/{0} differs from rules/{0}; copy the one you edited over the other",
            shipped.file
        );
    }
}
