//! The rule sets and profiles that are part of this crate, as text and compiled.

use alloc::vec::Vec;
use core::fmt::Debug;

use fuzzy::Model;

use crate::{estimator::Estimator, profile::Profile};

/// A rule set or profile that is part of this crate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub struct Shipped {
    /// The name for loading it, such as `flagred-paper`.
    pub name: &'static str,
    /// Its path relative to the folder `rules`.
    pub file: &'static str,
    /// Its text in YAML.
    pub text: &'static str,
}

/// The rule sets.
pub const RULE_SETS: [Shipped; 3] = [
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
    Shipped {
        name: "flagred-battery",
        file: "flagred-battery.yaml",
        text: include_str!("../rules/flagred-battery.yaml"),
    },
];

/// The profiles; the first is the default.
pub const PROFILES: [Shipped; 3] = [
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
    Shipped {
        name: "flagred-battery",
        file: "profiles/flagred-battery.yaml",
        text: include_str!("../rules/profiles/flagred-battery.yaml"),
    },
];

/// The default profile with its rule set, compiled.
///
/// # Example
/// ```
/// let estimator = flagred::shipped::flagred();
/// assert_eq!(estimator.profile().name, "flagred");
/// ```
pub fn flagred() -> Estimator {
    valid(Estimator::new(&profile(0), &flagred_rules()))
}

/// The compiled profile and rule set of the paper.
pub fn flagred_paper() -> Estimator {
    valid(Estimator::new(&profile(1), &flagred_paper_rules()))
}

/// The default profile with the battery level as a risk of its own, compiled.
///
/// # Example
/// ```
/// let estimator = flagred::shipped::flagred_battery();
/// assert_eq!(estimator.others()[0].profile().output, "battery_risk");
/// ```
pub fn flagred_battery() -> Estimator {
    valid(Estimator::new(&profile(2), &flagred_battery_rules()))
}

/// The rule set of [`flagred`].
pub fn flagred_rules() -> Model {
    rule_set(0)
}

/// The rule set of [`flagred_paper`].
///
/// # Example
/// ```
/// assert_eq!(flagred::shipped::flagred_paper_rules().rules.len(), 10);
/// ```
pub fn flagred_paper_rules() -> Model {
    rule_set(1)
}

/// The rule set of [`flagred_battery`].
pub fn flagred_battery_rules() -> Model {
    rule_set(2)
}

/// The names of the shipped profiles, for messages.
pub fn profile_names() -> Vec<&'static str> {
    PROFILES.iter().map(|shipped| shipped.name).collect()
}

/// The names of the shipped profiles whose risk depends only on the motors, so that they can be compared on any log.
pub fn motor_profile_names() -> impl Iterator<Item = &'static str> {
    let reads_motors_alone =
        |shipped: &&Shipped| valid(shipped.text.parse::<Profile>()).signals().is_empty();
    PROFILES
        .iter()
        .filter(reads_motors_alone)
        .map(|shipped| shipped.name)
}

fn profile(index: usize) -> Profile {
    valid(PROFILES[index].text.parse())
}

fn rule_set(index: usize) -> Model {
    valid(fuzzy::yaml::parse(RULE_SETS[index].text)).model
}

/// Unwraps the result for a shipped file. The text is part of the crate, and the tests below verify that it is valid.
fn valid<T, E: Debug>(result: Result<T, E>) -> T {
    result.unwrap_or_else(|error| unreachable!("a shipped file is not valid: {error:?}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_shipped_file_is_valid_and_found_by_its_name() {
        for (shipped, estimator) in
            PROFILES
                .iter()
                .zip([flagred(), flagred_paper(), flagred_battery()])
        {
            assert_eq!(estimator.profile().name, shipped.name);
        }
        for (shipped, model) in RULE_SETS.iter().zip([
            flagred_rules(),
            flagred_paper_rules(),
            flagred_battery_rules(),
        ]) {
            assert_eq!(model.name, shipped.name);
        }
        for (i, shipped) in PROFILES.iter().enumerate() {
            assert_eq!(profile(i).rules, shipped.name);
        }
    }

    #[test]
    fn the_battery_profile_extends_the_default_profile_unchanged() {
        let mut profile = profile(2);
        profile.inputs.retain(|input| input.name != "battery");
        profile.findings.retain(|words| words.input != "battery");
        profile.other_risks.clear();
        let default = self::profile(0);
        assert_eq!(
            profile,
            Profile {
                name: profile.name.clone(),
                description: profile.description.clone(),
                rules: profile.rules.clone(),
                ..default
            }
        );
    }
}
