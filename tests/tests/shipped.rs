//! The shipped rule sets and profiles equal those in `rules/`.
//!
//! A package can contain only files below its own folder, so `flagred/rules/` has a copy of each. Edit the file in `rules/`, then
//! run `UPDATE_DOCUMENTS=1 cargo test --workspace --test shipped`, which copies it.

use std::{env, fs, path::Path};

use flagred::shipped::{PROFILES, RULE_SETS};

#[test]
fn the_package_contains_the_files_of_rules() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let files = RULE_SETS
        .iter()
        .chain(&PROFILES)
        .map(|shipped| shipped.file);
    for file in files.chain(["profile-schema.json"]) {
        let text = fs::read_to_string(root.join("rules").join(file)).unwrap();
        let copy = root.join("flagred/rules").join(file);
        if env::var_os("UPDATE_DOCUMENTS").is_some() {
            fs::write(copy, text).unwrap();
            continue;
        }
        assert!(
            fs::read_to_string(copy).unwrap() == text,
            "flagred/rules/{file} is another than rules/{file}: run UPDATE_DOCUMENTS=1 cargo test --workspace --test shipped"
        );
    }
}
