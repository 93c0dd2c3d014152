//! Commented texts to start from.

const RULES: &str = include_str!("starter.yaml");
const PROFILE: &str = include_str!("starter-profile.yaml");

/// A rule set of this name, which is one that [`is_name`] takes.
pub fn rules(name: &str) -> String {
    RULES.replace("my-rules", name)
}

/// A profile of this name, which is one that [`is_name`] takes.
pub fn profile(name: &str) -> String {
    PROFILE.replace("my-profile", name)
}

/// Whether a name is a file name everywhere and needs no quotes in YAML.
pub fn is_name(text: &str) -> bool {
    let plain = |c: char| c.is_ascii_alphanumeric() || matches!(c, '-' | '_');
    text.starts_with(|c: char| c.is_ascii_alphabetic()) && text.chars().all(plain)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Document;

    #[test]
    fn what_one_starts_from_has_no_mistake() {
        let rules = Document::new(rules("fan"), |_| None);
        assert_eq!(rules.findings().0, []);
        assert_eq!(rules.model().unwrap().name, "fan");
        let flagred = || flagred::shipped::RULE_SETS[1].text.to_owned();
        let profile = Document::new(profile("quad"), |_| Some(flagred()));
        assert!(profile.is_profile() && !profile.findings().has_errors());
    }

    #[test]
    fn a_name_is_plain() {
        assert!(is_name("fan-2") && !is_name("2-fan") && !is_name("a/b") && !is_name(""));
    }
}
