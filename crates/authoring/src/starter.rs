//! Commented templates for rule sets and profiles.

use flagred::shipped::Shipped;

const RULES: &str = include_str!("starter.yaml");
/// The comment at the top of a profile, which describes its use.
const PROFILE: &str = include_str!("starter-profile.yaml");

/// Returns a rule set with the given name, which must satisfy [`is_name`].
pub fn rules(name: &str) -> String {
    RULES.replace("my-rules", name)
}

/// Returns a profile with the given name, which must satisfy [`is_name`], with the values and
/// comments of a shipped profile.
pub fn profile(name: &str, from: &Shipped) -> String {
    format!("{}\n{}", PROFILE.replace("NAME", name), renamed(name, from))
}

/// The text of a shipped rule set or profile, including comments, with its name replaced by the given one, which must
/// satisfy [`is_name`].
pub fn renamed(name: &str, from: &Shipped) -> String {
    let own = format!("\nname: {}\n", from.name);
    from.text.replacen(&own, &format!("\nname: {name}\n"), 1)
}

/// Whether a name is a valid file name on every system and needs no quotes in YAML.
pub fn is_name(text: &str) -> bool {
    let plain = |c: char| c.is_ascii_alphanumeric() || matches!(c, '-' | '_');
    text.starts_with(|c: char| c.is_ascii_alphabetic()) && text.chars().all(plain)
}

#[cfg(test)]
mod tests {
    use flagred::{
        profile::Profile,
        shipped::{PROFILES, RULE_SETS},
    };

    use super::*;
    use crate::Document;

    #[test]
    fn starters_have_no_mistake() {
        let rules = Document::new(rules("fan"), |_| None);
        assert_eq!(rules.findings().0, []);
        assert_eq!(rules.model().unwrap().name, "fan");
        for (shipped, rules) in PROFILES.iter().zip(&RULE_SETS) {
            let profile = Document::new(profile("quad", shipped), |_| Some(rules.text.to_owned()));
            assert!(profile.is_profile() && !profile.findings().has_errors());
        }
    }

    #[test]
    fn a_copy_differs_from_the_shipped_one_only_by_its_name() {
        for shipped in &PROFILES {
            let mut copy: Profile = profile("quad", shipped).parse().unwrap();
            assert_eq!(copy.name, "quad");
            copy.name = shipped.name.into();
            assert_eq!(copy, shipped.text.parse().unwrap());
            let comments = |text: &str| text.matches('#').count();
            assert!(comments(&profile("quad", shipped)) > comments(shipped.text));
        }
        for shipped in &RULE_SETS {
            let mut copy: fuzzy::Model = renamed("mine", shipped).parse().unwrap();
            assert_eq!(copy.name, "mine");
            copy.name = shipped.name.into();
            assert_eq!(copy, shipped.text.parse().unwrap());
        }
    }

    #[test]
    fn a_starter_name_is_a_plain_word() {
        assert!(is_name("fan-2") && !is_name("2-fan") && !is_name("a/b") && !is_name(""));
    }
}
