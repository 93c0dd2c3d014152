//! Changes the thresholds of a profile in its text. Everything else is preserved, including comments.

use alloc::{borrow::ToOwned, format, string::String, vec::Vec};
use core::ops::Range;

use fuzzy::{
    diagnostic::{Diagnostic, Findings},
    tree::{Node, Value},
    yaml,
};

use super::Profile;
use crate::verdict::{LevelSettings, Threshold, VerdictSettings};

impl Profile {
    /// Returns the text of a profile with other levels and times of its verdict. Notices and the limit for idle motors
    /// do not change.
    ///
    /// # Errors
    /// The findings of the text or of the changed text, or a message if the text is written in a way that cannot be
    /// changed in place.
    ///
    /// # Example
    /// ```
    /// use flagred::profile::Profile;
    ///
    /// let text = "flagred: 1\nname: x\nrules: flagred\ninputs: {load: {mean: motor_command}}\nverdict:\n  clear_after_s: 8 # calm\n";
    /// let mut verdict = text.parse::<Profile>()?.verdict;
    /// verdict.clear_after_s = 5.0;
    /// assert!(Profile::rewritten(text, &verdict)?.ends_with("clear_after_s: 5 # calm\n"));
    /// # Ok::<(), fuzzy::diagnostic::Findings>(())
    /// ```
    pub fn rewritten(text: &str, wanted: &VerdictSettings) -> Result<String, Findings> {
        let now = text.parse::<Profile>()?.verdict;
        let pairs = written(&now).into_iter().zip(written(wanted));
        let changes = pairs.filter(|(now, wanted)| now != wanted);
        let changes: Vec<(&str, String)> = changes.map(|(_, wanted)| wanted).collect();
        let changed = edited(text, &yaml::read(text)?, &changes);
        match changed
            .map(|text| Ok((text.parse::<Profile>()?, text)))
            .transpose()?
        {
            Some((profile, text)) if profile.verdict == *wanted => Ok(text),
            _ => {
                let message = "the thresholds are written in a way that cannot be changed here";
                let error = Diagnostic::error("verdict", 0..0, message);
                let help = "change them in the text of the profile, below `verdict`";
                Err(Findings::locate(Vec::from([error.help(help)]), text))
            }
        }
    }
}

/// The keys of a verdict that can be changed, with their values.
fn written(settings: &VerdictSettings) -> [(&'static str, String); 5] {
    let take_off_s = settings.quiet_after_take_off_s;
    let landing_s = settings.quiet_before_landing_s;
    [
        ("warn", level(&settings.warn)),
        ("fail", level(&settings.fail)),
        ("clear_after_s", number(settings.clear_after_s)),
        ("quiet_after_take_off_s", number(take_off_s)),
        ("quiet_before_landing_s", number(landing_s)),
    ]
}

/// The text with other values for keys of the verdict, or `None` if they cannot be changed in place.
fn edited(text: &str, tree: &Node, changes: &[(&str, String)]) -> Option<String> {
    if changes.is_empty() {
        return Some(text.to_owned());
    }
    let Some(verdict) = tree.child("verdict") else {
        let all = [("verdict", format!("{{{}}}", pairs(changes).join(", ")))];
        let (at, first) = added(text, tree, &all)?;
        return Some([text.get(..at)?, &first, text.get(at..)?].concat());
    };
    let mut missing = Vec::new();
    let mut edits: Vec<(Range<usize>, String)> = Vec::new();
    for (key, value) in changes {
        match verdict.child(key) {
            Some(node) => {
                let old = text.get(node.span.clone())?;
                // A block ends with the line break before the next key.
                let end = node.span.start + old.trim_end().len();
                edits.push((node.span.start..end, value.clone()));
            }
            None => missing.push((*key, value.clone())),
        }
    }
    if !missing.is_empty() {
        let (at, first) = added(text, verdict, &missing)?;
        edits.push((at..at, first));
    }
    // The edits are applied from the end, so that earlier positions stay valid.
    edits.sort_by_key(|(span, _)| core::cmp::Reverse(span.start));
    let mut changed = text.to_owned();
    for (span, with) in edits {
        changed.get(span.clone())?;
        changed.replace_range(span, &with);
    }
    Some(changed)
}

/// The text that inserts keys at the start of a mapping, and its position.
fn added(text: &str, mapping: &Node, keys: &[(&str, String)]) -> Option<(usize, String)> {
    let Value::Mapping(known) = &mapping.value else {
        return None;
    };
    if text.get(mapping.span.start..)?.starts_with('{') {
        let comma = if known.is_empty() { "" } else { ", " };
        let at = mapping.span.start + 1;
        return Some((at, pairs(keys).join(", ") + comma));
    }
    let at = known.first()?.0.span.start;
    let line = text.get(..at)?.rfind('\n').map_or(0, |end| end + 1);
    let indentation = text.get(line..at)?;
    let lines = pairs(keys).into_iter();
    Some((
        at,
        lines.map(|pair| format!("{pair}\n{indentation}")).collect(),
    ))
}

fn pairs(keys: &[(&str, String)]) -> Vec<String> {
    let keys = keys.iter();
    keys.map(|(key, value)| format!("{key}: {value}")).collect()
}

fn number(value: f64) -> String {
    format!("{value}")
}

/// A level on one line.
fn level(settings: &LevelSettings) -> String {
    let LevelSettings {
        raise,
        after_s,
        until,
    } = settings;
    let mut pairs = threshold(raise);
    pairs.push(format!("after_s: {}", number(*after_s)));
    pairs.push(format!("until: {{{}}}", threshold(until).join(", ")));
    format!("{{{}}}", pairs.join(", "))
}

fn threshold(threshold: &Threshold) -> Vec<String> {
    let limits = [
        ("risk", threshold.risk_pct),
        ("elevated_risk", threshold.elevated_risk_pct),
    ];
    let known = limits.into_iter();
    let known = known.filter_map(|(key, limit)| Some(format!("{key}: {}", number(limit?))));
    known.collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shipped::PROFILES;

    fn verdict(text: &str) -> VerdictSettings {
        text.parse::<Profile>().unwrap().verdict
    }

    /// A profile with the given text as its verdict.
    fn profile(verdict: &str) -> String {
        format!(
            "flagred: 1\nname: x\nrules: flagred\ninputs: {{load: {{mean: motor_command}}}}\n{verdict}"
        )
    }

    #[test]
    fn a_rewritten_profile_has_the_new_settings_and_keeps_the_rest() {
        let mut texts: Vec<String> = PROFILES.iter().map(|p| p.text.into()).collect();
        for written in [
            "",
            "verdict: {}\n",
            "verdict: {warn: {risk: 50}}\n",
            "verdict:\n  # why\n  warn:\n    risk: 50   # half\n    until:\n      risk: 10\n  idle_below: 0.2\n",
            "verdict:\n    fail: {risk: 90}\nwindow_s: 3\n",
        ] {
            texts.push(profile(written));
        }
        texts.push(
            "{flagred: 1, name: x, rules: flagred, inputs: {load: {mean: motor_command}}}".into(),
        );
        for text in texts {
            let mut wanted = verdict(&text);
            assert_eq!(
                Profile::rewritten(&text, &wanted).unwrap(),
                text,
                "nothing to change"
            );
            wanted.warn.raise.risk_pct = Some(71.5);
            wanted.fail.after_s = 1.25;
            wanted.quiet_before_landing_s = 0.0;
            let changed = Profile::rewritten(&text, &wanted).unwrap();
            assert_eq!(verdict(&changed), wanted, "{changed}");
            for comment in text.lines().filter_map(|line| line.split_once("# ")) {
                let is_inside = text.contains("# half") && comment.1 == "half";
                assert_eq!(changed.contains(comment.1), !is_inside, "{changed}");
            }
        }
    }

    #[test]
    fn invalid_settings_are_refused() {
        let text = PROFILES[0].text;
        let mut wanted = verdict(text);
        wanted.warn.raise.risk_pct = Some(10.0);
        let refused = Profile::rewritten(text, &wanted).unwrap_err().to_string();
        assert!(
            refused.contains("is 43, above 10, at which the level is raised"),
            "{refused}"
        );
        assert!(Profile::rewritten("name: x", &verdict(text)).is_err());
        // Two keys share one value, which cannot be changed for only one of them.
        let shared = profile("verdict:\n  fail: &level {risk: 80}\n  warn: *level\n");
        let mut wanted = verdict(&shared);
        wanted.warn.raise.risk_pct = Some(70.0);
        wanted.warn.until.risk_pct = Some(70.0);
        match Profile::rewritten(&shared, &wanted) {
            Ok(changed) => assert_eq!(verdict(&changed), wanted),
            Err(refused) => assert!(refused.to_string().contains("cannot be changed here")),
        }
    }
}
