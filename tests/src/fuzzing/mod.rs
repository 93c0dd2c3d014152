//! The bodies of the fuzz targets in `tests/fuzz`, one function each, with small seeds. `tests/tests/mutations.rs` runs them
//! on mutated seeds. They panic if an invariant is violated.
#![expect(
    clippy::unwrap_used,
    clippy::panic,
    clippy::missing_panics_doc,
    reason = "what does not hold fails the test"
)]

mod logs;
pub mod mutation;
mod rule_sets;
pub mod seeds;
mod session;

pub use logs::{check, csv, flight_log, report};
pub use rule_sets::{other_programs, profile, rule, rule_set};
pub use session::session;

use std::sync::LazyLock;

use flagred_cli::fuzzing::Profile;

/// A fuzz target.
pub struct Target {
    /// The name of the target.
    pub name: &'static str,
    /// The function, which accepts any bytes.
    pub body: fn(&[u8]),
    /// Seeds that cover much of the code.
    pub seeds: fn() -> Vec<Vec<u8>>,
    /// The share of all mutated inputs that this target gets, in %.
    pub share: u64,
}

/// All targets. Plans for the C library are not included, because `tests/c/damage.c` tests damaged plans.
pub const TARGETS: [Target; 8] = [
    Target {
        name: "flight_log",
        body: flight_log,
        seeds: seeds::logs,
        share: 30,
    },
    Target {
        name: "csv",
        body: csv,
        seeds: seeds::tables,
        share: 20,
    },
    Target {
        name: "report",
        body: report,
        seeds: seeds::logs,
        share: 5,
    },
    Target {
        name: "session",
        body: session,
        seeds: seeds::links,
        share: 15,
    },
    Target {
        name: "profile",
        body: profile,
        seeds: seeds::profiles,
        share: 10,
    },
    Target {
        name: "rule_set",
        body: rule_set,
        seeds: seeds::rule_sets,
        share: 5,
    },
    Target {
        name: "other_programs",
        body: other_programs,
        seeds: seeds::other_programs,
        share: 10,
    },
    Target {
        name: "rule",
        body: rule,
        seeds: seeds::rules,
        share: 5,
    },
];

/// The default profile.
static SHIPPED: LazyLock<Profile> = LazyLock::new(|| Profile::shipped().unwrap());

/// Asserts that a text is safe on a terminal: it contains no control characters except line ends and tabs.
fn assert_harmless(text: &str) {
    let found = text.find(|c: char| c.is_control() && !"\n\t".contains(c));
    if let Some(offset) = found {
        let before: String = text[..offset].chars().rev().take(80).collect();
        let before: String = before.chars().rev().collect();
        let after: String = text[offset..].chars().take(80).collect();
        panic!("a control character at {offset}: {before:?} {after:?}");
    }
}

/// Removes the control sequences (`ESC [`) that end with one of the characters in `ends`.
fn without(ends: &str, text: &str) -> String {
    let mut parts = text.split("\u{1b}[");
    let mut plain = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let rest = part.trim_start_matches(|c: char| c.is_ascii_digit() || ";?".contains(c));
        match rest.strip_prefix(|c: char| ends.contains(c)) {
            Some(rest) => plain += rest,
            None => plain += "\u{1b}[",
        }
    }
    plain
}
