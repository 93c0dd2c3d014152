//! The rule sets and profiles that come with this crate, as text and ready to use.

use alloc::vec::Vec;

use fuzzy::{Model, diagnostic::Findings};

use crate::profile::Profile;

/// A rule set or profile that comes with this crate.
///
/// # Example: every shipped rule set loads
/// ```
/// for shipped in flagred::shipped::RULE_SETS {
///     let model = fuzzy::yaml::parse(shipped.text)?.model;
///     assert_eq!(model.name, shipped.name);
/// }
/// # Ok::<(), fuzzy::diagnostic::Findings>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shipped {
    /// Its name.
    pub name: &'static str,
    /// Its file, from the folder `rules` on.
    pub file: &'static str,
    /// Its YAML.
    pub text: &'static str,
}

/// The rule sets.
pub const RULE_SETS: [Shipped; 2] = [
    Shipped {
        name: "flagred",
        file: "flagred.yaml",
        text: include_str!("../rules/flagred.yaml"),
    },
    Shipped {
        name: "flagred-paper",
        file: "flagred-paper.yaml",
        text: include_str!("../rules/flagred-paper.yaml"),
    },
];

/// The profiles; the first one is for flying.
pub const PROFILES: [Shipped; 2] = [
    Shipped {
        name: "flagred",
        file: "profiles/multirotor.yaml",
        text: include_str!("../rules/profiles/multirotor.yaml"),
    },
    Shipped {
        name: "flagred-paper",
        file: "profiles/flagred-paper.yaml",
        text: include_str!("../rules/profiles/flagred-paper.yaml"),
    },
];

/// The rule set of this name; `None` if there is none.
///
/// # Example
/// ```
/// let model = flagred::shipped::rule_set("flagred-paper").ok_or("not shipped")??;
/// assert_eq!(model.rules.len(), 10);
/// assert!(flagred::shipped::rule_set("mine").is_none());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn rule_set(name: &str) -> Option<Result<Model, Findings>> {
    find(&RULE_SETS, name)
        .map(|shipped| fuzzy::yaml::parse(shipped.text).map(|document| document.model))
}

/// The profile of this name; `None` if there is none.
///
/// ```
/// let profile = flagred::shipped::profile("flagred").ok_or("not shipped")??;
/// assert_eq!(profile.name, "flagred");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn profile(name: &str) -> Option<Result<Profile, Findings>> {
    find(&PROFILES, name).map(|shipped| Profile::from_yaml(shipped.text))
}

/// The names of the shipped profiles, for messages.
///
/// # Example
/// ```
/// assert_eq!(flagred::shipped::profile_names(), ["flagred", "flagred-paper"]);
/// ```
pub fn profile_names() -> Vec<&'static str> {
    PROFILES.iter().map(|shipped| shipped.name).collect()
}

fn find<'a>(all: &'a [Shipped], name: &str) -> Option<&'a Shipped> {
    all.iter().find(|shipped| shipped.name == name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimator::Estimator;

    #[test]
    fn every_profile_goes_by_its_name_and_makes_an_estimator() {
        for shipped in PROFILES {
            let profile = profile(shipped.name).unwrap().unwrap();
            assert_eq!(profile.name, shipped.name);
            let rules = rule_set(&profile.rules).unwrap().unwrap();
            Estimator::new(&profile, &rules).unwrap();
        }
    }
}
