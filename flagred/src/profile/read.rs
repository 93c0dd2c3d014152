//! Reads a profile from YAML and reports all its errors at once, each with its location.

use alloc::{format, string::String, vec::Vec};
use core::str::FromStr;

use fuzzy::{
    Source,
    diagnostic::{Diagnostic, Findings},
    model::AllowedFinding,
    tree::{Fields, Node, Value},
};

mod findings;
mod inputs;
mod reliability;
#[cfg(test)]
mod tests;
mod verdict;

use super::{ALLOW, FINDINGS, OtherRisk, Profile, Sampling};
use crate::{
    accumulator::AccumulatorSettings,
    gap::{GapMethod, GapSettings},
};
use findings::findings;
use inputs::inputs;
use reliability::reliability;
use verdict::{level, verdict};

/// The version of the format.
const VERSION: u64 = 1;

/// The window of an input in seconds, if neither the input nor the profile sets one.
const WINDOW_S: f64 = 2.0;

type Mistakes = Vec<Diagnostic>;

impl FromStr for Profile {
    type Err = Findings;

    /// Reads a profile from YAML; on failure returns all errors of the text, each with its location and help.
    fn from_str(text: &str) -> Result<Profile, Findings> {
        Profile::from_source(&Source::new(text))
    }
}

impl Profile {
    /// As [`from_str`](Self::from_str), from a text that is shared with other readers.
    ///
    /// # Errors
    /// As [`from_str`](Self::from_str).
    pub fn from_source(source: &Source) -> Result<Profile, Findings> {
        let mut found = Vec::new();
        match read(source.tree()?, &mut found) {
            Some(profile) if found.is_empty() => Ok(profile),
            _ => Err(Findings::locate(found, source.text())),
        }
    }
}

fn read(tree: &Node, found: &mut Mistakes) -> Option<Profile> {
    let keys = [
        "flagred",
        "name",
        "description",
        "rules",
        "output",
        "window_s",
        "min_samples",
        "warm_up_s",
        "longest_gap_s",
        "take_off_s",
        "inputs",
        "gap",
        "elevated_risk",
        "verdict",
        "other_risks",
        "findings",
        "reliability",
        "allow",
    ];
    if !matches!(tree.value, Value::Mapping(_)) {
        found.push(tree.unexpected_document("profile", "flagred: 1"));
        return None;
    }
    let fields = tree.fields("the profile", &keys, "", found)?;
    if let Some(entry) = fields.unknown().find(|entry| entry.key == "fuzzy")
        && fields.get("flagred").is_none()
    {
        let (span, message) = (
            entry.key_span.clone(),
            "this is a profile, but it begins like a rule set",
        );
        found.clear();
        found.push(
            Diagnostic::error("unknown-key", span, message)
                .help("write `flagred: 1` in place of `fuzzy: 1`"),
        );
        return None;
    }
    if let Some(version) = fields.require("flagred", "write `flagred: 1` as its first line", found)
        && version.whole("the version", 1, found) != Some(VERSION)
        && found.is_empty()
    {
        let message = format!("this program reads profiles of version {VERSION} only");
        found.push(
            Diagnostic::error("version", version.span.clone(), message)
                .help("write `flagred: 1`, or use a newer version of flagred"),
        );
    }
    for key in ["warn", "fail", "thresholds", "levels", "limits"] {
        if let Some(entry) = fields.unknown().find(|entry| entry.key == key)
            && let Some(finding) = found.iter_mut().find(|one| one.span == entry.key_span)
        {
            finding.help = Some(
                "write the levels under `verdict`: `verdict: {warn: {risk: 60}, fail: {risk: 75}}`"
                    .into(),
            );
        }
    }
    let name = required_words(&fields, "name", "write `name: my-profile`", found);
    let rules = required_words(
        &fields,
        "rules",
        "name a shipped rule set or a file: `rules: flagred-paper`",
        found,
    );
    let description = fields
        .get("description")
        .and_then(|node| node.words("the description", "write text: `description: ...`", found))
        .map(|words| words.text.clone());
    let output = fields
        .get("output")
        .and_then(|node| {
            node.words(
                "the output",
                "write the name of an output of the rule set: `output: risk`",
                found,
            )
        })
        .map_or_else(|| "risk".into(), |words| words.text.clone());
    let window_s = number(&fields, "window_s", WINDOW_S, Bounds::Above0, found);
    let inputs = inputs(&fields, window_s, found);
    let elevated_risk = elevated_risk(&fields, AccumulatorSettings::default(), found);
    let verdict = verdict(&fields, found);
    let defaults = OtherRisk {
        output: output.clone(),
        elevated_risk,
        warn: verdict.warn,
        fail: verdict.fail,
    };
    let profile = Profile {
        name: name.unwrap_or_default(),
        description,
        rules: rules.unwrap_or_default(),
        output,
        sampling: sampling(&fields, found),
        gap: gap(&fields, found),
        elevated_risk,
        other_risks: other_risks(&fields, &defaults, found),
        verdict,
        window_s,
        findings: findings(&fields, &inputs, found),
        reliability: reliability(&fields, found),
        allow: fields.get("allow").map_or_else(Vec::new, |node| {
            AllowedFinding::read(node, &FINDINGS, ALLOW, &mut Vec::new(), found)
        }),
        inputs,
    };
    Some(profile)
}

fn required_words(fields: &Fields, key: &str, help: &str, found: &mut Mistakes) -> Option<String> {
    let node = fields.require(key, help, found)?;
    node.words(&format!("`{key}`"), help, found)
        .map(|words| words.text.clone())
}

fn sampling(fields: &Fields, found: &mut Mistakes) -> Sampling {
    let default = Sampling::default();
    let min_samples = fields
        .get("min_samples")
        .and_then(|node| node.whole("`min_samples`", 1, found));
    Sampling {
        min_samples: min_samples.map_or(default.min_samples, |n| {
            u32::try_from(n).unwrap_or(u32::MAX)
        }),
        warm_up_s: number(fields, "warm_up_s", default.warm_up_s, Bounds::From0, found),
        longest_gap_s: number(
            fields,
            "longest_gap_s",
            default.longest_gap_s,
            Bounds::Above0,
            found,
        ),
        take_off_s: number(
            fields,
            "take_off_s",
            default.take_off_s,
            Bounds::From0,
            found,
        ),
    }
}

fn gap(fields: &Fields, found: &mut Mistakes) -> GapSettings {
    let mut gap = GapSettings::default();
    let Some(fields) = fields.get("gap").and_then(|node| {
        let help = "write `gap: {method: nearest}`";
        node.fields("`gap`", &["method", "coverage_below"], help, found)
    }) else {
        return gap;
    };
    gap.coverage_below = fields
        .get("coverage_below")
        .map(|_| number(&fields, "coverage_below", 0.0, Bounds::From0, found));
    if let Some(method) = fields.get("method").and_then(|node| method(node, found)) {
        gap.method = method;
    }
    gap
}

fn method(node: &Node, found: &mut Mistakes) -> Option<GapMethod> {
    let words = GapMethod::ALL.map(|method| (method.name(), method));
    let Value::Mapping(_) = node.value else {
        return node.choice("the gap method", &words, found);
    };
    let help = "write `{inverse_distance: {power: 2, neighbours: 3}}`";
    let fields = node.fields("the gap method", &["inverse_distance"], help, found)?;
    let settings = fields.require("inverse_distance", help, found)?;
    let keys = ["power", "neighbours"];
    let fields = settings.fields("`inverse_distance`", &keys, help, found)?;
    let neighbours = fields
        .get("neighbours")
        .and_then(|node| node.whole("`neighbours`", 1, found));
    Some(GapMethod::InverseDistance {
        neighbours: neighbours.map_or(3, |n| usize::try_from(n).unwrap_or(usize::MAX)),
        power: number(&fields, "power", 2.0, Bounds::Above0, found),
    })
}

/// Reads the other outputs that are risks; missing settings are taken from the first risk.
fn other_risks(fields: &Fields, defaults: &OtherRisk, found: &mut Mistakes) -> Vec<OtherRisk> {
    let entries = fields.get("other_risks").and_then(|node| {
        let help =
            "write each output by its name: `other_risks: {battery_risk: {warn: {risk: 60}}}`";
        node.entries("`other_risks`", "output", help, found)
    });
    let mut risks = Vec::new();
    for entry in entries.unwrap_or_default() {
        if entry.key == defaults.output {
            let message = format!("`{}` is already the `output` of the profile", entry.key);
            found.push(
                Diagnostic::error("other-risk", entry.key_span.clone(), message)
                    .help("its levels are in `verdict`; name other outputs here"),
            );
        }
        let what = format!("risk `{}`", entry.key);
        let keys = ["elevated_risk", "warn", "fail"];
        let help = format!("write `{}: {{warn: {{risk: 60}}}}`", entry.key);
        if let Some(fields) = entry.value.fields(&what, &keys, &help, found) {
            risks.push(OtherRisk {
                output: entry.key.into(),
                elevated_risk: elevated_risk(&fields, defaults.elevated_risk, found),
                warn: level(&fields, "warn", defaults.warn, found),
                fail: level(&fields, "fail", defaults.fail, found),
            });
        }
    }
    risks
}

fn elevated_risk(
    fields: &Fields,
    default: AccumulatorSettings,
    found: &mut Mistakes,
) -> AccumulatorSettings {
    let keys = ["window_s", "high", "low", "rise_per_s", "fall_per_s"];
    let Some(fields) = fields.get("elevated_risk").and_then(|node| {
        let help = "write `elevated_risk: {window_s: 10, high: 50, low: 20}`";
        node.fields("`elevated_risk`", &keys, help, found)
    }) else {
        return default;
    };
    let settings = AccumulatorSettings {
        window_s: number(&fields, "window_s", default.window_s, Bounds::Above0, found),
        high_pct: number(&fields, "high", default.high_pct, Bounds::From0, found),
        low_pct: number(&fields, "low", default.low_pct, Bounds::From0, found),
        rise_pct_per_s: number(
            &fields,
            "rise_per_s",
            default.rise_pct_per_s,
            Bounds::From0,
            found,
        ),
        fall_pct_per_s: number(
            &fields,
            "fall_per_s",
            default.fall_pct_per_s,
            Bounds::From0,
            found,
        ),
    };
    if let Some(low) = fields.entry("low")
        && settings.low_pct > settings.high_pct
    {
        let message = format!(
            "`low` ({}) is above `high` ({})",
            settings.low_pct, settings.high_pct
        );
        found.push(
            Diagnostic::error("order", low.value.span.clone(), message)
                .help("write a smaller `low` or a larger `high`: the elevated risk falls while the risk is below `low`, and rises while it is above `high`"),
        );
    }
    settings
}

/// The allowed range of a number.
#[derive(Clone, Copy)]
enum Bounds {
    From0,
    Above0,
    /// At least 0 and less than 1.
    Below1,
}

/// Reads an optional number.
fn number(fields: &Fields, key: &str, default: f64, bounds: Bounds, found: &mut Mistakes) -> f64 {
    let Some(node) = fields.get(key) else {
        return default;
    };
    let Some(value) = node.finite(&format!("`{key}`"), found) else {
        return default;
    };
    let (fits, expected) = match bounds {
        Bounds::From0 => (value >= 0.0, "not below 0"),
        Bounds::Above0 => (value > 0.0, "above 0"),
        Bounds::Below1 => (
            (0.0..1.0).contains(&value),
            "from 0 to below 1: the commands of motors are fractions of their range",
        ),
    };
    if !fits {
        let message = format!("`{key}` is {value}");
        found.push(
            Diagnostic::error("out-of-range", node.span.clone(), message)
                .help(format!("write a number {expected}")),
        );
        return default;
    }
    value
}
