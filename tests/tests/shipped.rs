//! The rule sets and profiles in `rules/` that are shipped are the files in the package: links, and no copies.

use std::{fs, path::Path};

use flagred::shipped::{PROFILES, RULE_SETS};

#[test]
fn the_shipped_files_in_rules_are_those_of_the_package() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    for shipped in RULE_SETS.iter().chain(&PROFILES) {
        let linked = root.join("rules").join(shipped.file);
        let home = root.join("flagred/rules").join(shipped.file);
        assert_eq!(
            linked.canonicalize().unwrap(),
            home.canonicalize().unwrap(),
            "make rules/{0} a link to flagred/rules/{0}",
            shipped.file
        );
        assert_eq!(fs::read_to_string(home).unwrap(), shipped.text);
    }
}
