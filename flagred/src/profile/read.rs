//! Reads a profile from YAML and reports all its errors at once, each with its location.

use alloc::{format, string::String, vec::Vec};
use core::str::FromStr;

use fuzzy::{
    diagnostic::{Diagnostic, Findings},
    tree::{Entry, Fields, Node, Value},
    yaml,
};

use super::{Profile, ProfileInput, Sampling};
use crate::{
    accumulator::AccumulatorSettings,
    gap::{GapMethod, GapSettings},
    source::{Motors, Signal, Source, Statistic},
    verdict::{LevelSettings, Limit, NoticeSettings, Threshold, VerdictSettings},
};

/// The version of the format.
const VERSION: u64 = 1;

/// The window of an input whose profile names none, in seconds.
const WINDOW_S: f64 = 2.0;

const STATISTICS: [(&str, Statistic); 8] = [
    ("mean", Statistic::Mean),
    ("std", Statistic::Std),
    ("rms", Statistic::Rms),
    ("min", Statistic::Min),
    ("max", Statistic::Max),
    ("last", Statistic::Last),
    ("std_less_noise", Statistic::StdLessNoise),
    ("noise", Statistic::Noise),
];

type Share = fn(f64) -> Statistic;

const SHARES: [(&str, Share); 2] = [
    ("share_below", Statistic::ShareBelow),
    ("share_above", Statistic::ShareAbove),
];

const MOTORS: [(&str, Motors); 4] = [
    ("mean", Motors::Mean),
    ("std", Motors::Std),
    ("min", Motors::Min),
    ("max", Motors::Max),
];

type Found = Vec<Diagnostic>;

impl FromStr for Profile {
    type Err = Findings;

    /// Reads a profile from YAML; on failure gives all errors of the text, each with its location and help.
    fn from_str(text: &str) -> Result<Profile, Findings> {
        let tree = yaml::read(text)?;
        let mut found = Vec::new();
        match read(&tree, &mut found) {
            Some(profile) if found.is_empty() => Ok(profile),
            _ => Err(Findings::locate(found, text)),
        }
    }
}

fn read(tree: &Node, found: &mut Found) -> Option<Profile> {
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
    ];
    let fields = tree.fields("the profile", &keys, found)?;
    if let Some(version) = fields.require("flagred", "write `flagred: 1` as its first line", found)
        && version.whole("the version", 1, found) != Some(VERSION)
        && found.is_empty()
    {
        let message = format!("this program reads profiles of version {VERSION} only");
        found.push(
            Diagnostic::error("version", version.span.clone(), message)
                .help("write `flagred: 1`, or take a newer flagred"),
        );
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
        .and_then(|node| node.words("the description", found))
        .map(|words| words.text.clone());
    let output = fields
        .get("output")
        .and_then(|node| node.words("the output", found))
        .map_or_else(|| "risk".into(), |words| words.text.clone());
    let window_s = number(&fields, "window_s", WINDOW_S, Least::Above0, found);
    let inputs = inputs(&fields, window_s, found);
    let profile = Profile {
        name: name.unwrap_or_default(),
        description,
        rules: rules.unwrap_or_default(),
        output,
        sampling: sampling(&fields, found),
        gap: gap(&fields, found),
        elevated_risk: elevated_risk(&fields, found),
        verdict: verdict(&fields, found),
        window_s,
        inputs,
    };
    Some(profile)
}

fn required_words(fields: &Fields, key: &str, help: &str, found: &mut Found) -> Option<String> {
    let node = fields.require(key, help, found)?;
    node.words(&format!("`{key}`"), found)
        .map(|words| words.text.clone())
}

fn sampling(fields: &Fields, found: &mut Found) -> Sampling {
    let default = Sampling::default();
    let min_samples = fields
        .get("min_samples")
        .and_then(|node| node.whole("`min_samples`", 1, found));
    Sampling {
        min_samples: min_samples.map_or(default.min_samples, |n| {
            u32::try_from(n).unwrap_or(u32::MAX)
        }),
        warm_up_s: number(fields, "warm_up_s", default.warm_up_s, Least::From0, found),
        longest_gap_s: number(
            fields,
            "longest_gap_s",
            default.longest_gap_s,
            Least::Above0,
            found,
        ),
        take_off_s: number(
            fields,
            "take_off_s",
            default.take_off_s,
            Least::From0,
            found,
        ),
    }
}

fn inputs(fields: &Fields, window_s: f64, found: &mut Found) -> Vec<ProfileInput> {
    let help =
        "say where each input of the rule set comes from: `inputs: {margin: {mean: motor_margin}}`";
    let Some(node) = fields.require("inputs", help, found) else {
        return Vec::new();
    };
    let entries = node.entries("`inputs`", "input", found).unwrap_or_default();
    entries
        .iter()
        .filter_map(|entry| {
            Some(ProfileInput {
                name: entry.key.into(),
                source: source(entry, window_s, found)?,
            })
        })
        .collect()
}

fn source(entry: &Entry, window_s: f64, found: &mut Found) -> Option<Source> {
    let what = format!("input `{}`", entry.key);
    let statistics = STATISTICS.iter().map(|(name, _)| *name);
    let shares = SHARES.iter().map(|(name, _)| *name);
    let keys: Vec<&str> = statistics
        .clone()
        .chain(shares.clone())
        .chain(["of", "window_s"])
        .collect();
    let before = found.len();
    let fields = entry.value.fields(&what, &keys, found)?;
    let given: Vec<&str> = statistics
        .chain(shares)
        .filter(|k| fields.get(k).is_some())
        .collect();
    let [key] = given.as_slice() else {
        // An unknown key has been told; what it was meant to be is not missing on top.
        if found.len() == before {
            let message = format!("{what} takes one statistic, not {}", given.len());
            found.push(
                Diagnostic::error("statistic", entry.key_span.clone(), message)
                    .help("write for example `{mean: motor_margin}`"),
            );
        }
        return None;
    };
    let behind = fields.get(key)?;
    let window_s = number(&fields, "window_s", window_s, Least::Above0, found);
    let plain = STATISTICS.iter().find(|(name, _)| name == key);
    let (statistic, observed) = match plain {
        Some((_, statistic)) => {
            if let Some(stray) = fields.entry("of") {
                let message =
                    format!("`of` goes with `share_below` and `share_above`, not with `{key}`");
                found.push(
                    Diagnostic::error("statistic", stray.key_span.clone(), message)
                        .help(format!("write the signal behind `{key}` alone")),
                );
            }
            (*statistic, behind)
        }
        None => {
            let limit = behind.finite(&format!("`{key}`"), found)?;
            let (_, share) = SHARES.iter().find(|(name, _)| name == key)?;
            let help = format!("name the signal: `{{{key}: {limit}, of: motor_margin}}`");
            (share(limit), fields.require("of", &help, found)?)
        }
    };
    let (motors, signal) = signal(observed, &what, found)?;
    if statistic.is_of_bins() && motors == Motors::Pooled && signal.is_of_motors() {
        let message = format!("`{key}` needs one value for all motors");
        found.push(
            Diagnostic::error("statistic", behind.span.clone(), message).help(format!(
                "write for example `{{{key}: {{std: motor_command}}}}`"
            )),
        );
        return None;
    }
    Some(Source {
        statistic,
        motors,
        signal,
        window_s,
    })
}

/// `motor_margin` or `{min: motor_margin}`.
fn signal(node: &Node, what: &str, found: &mut Found) -> Option<(Motors, Signal)> {
    if !matches!(node.value, Value::Mapping(_)) {
        let name = node.words(&format!("the signal of {what}"), found)?;
        return Some((Motors::Pooled, Signal::named(&name.text)));
    }
    let keys = MOTORS.map(|(name, _)| name);
    let over = format!("the statistic over motors of {what}");
    let before = found.len();
    let fields = node.fields(&over, &keys, found)?;
    let mut given = MOTORS.iter().filter(|(name, _)| fields.get(name).is_some());
    let (Some((key, motors)), None) = (given.next(), given.next()) else {
        if found.len() == before {
            let message = format!("{over} is one of `mean`, `std`, `min` and `max`");
            found.push(
                Diagnostic::error("statistic", node.span.clone(), message)
                    .help("write for example `{min: motor_margin}`"),
            );
        }
        return None;
    };
    let node = fields.get(key)?;
    let name = &node.words(&format!("the signal of {what}"), found)?.text;
    let signal = Signal::named(name);
    if !signal.is_of_motors() {
        let message = format!("`{name}` has one value, not one for each motor");
        let known: Vec<String> = Signal::names_of_motors()
            .map(|name| format!("`{name}`"))
            .collect();
        found.push(
            Diagnostic::error("signal", node.span.clone(), message).help(format!(
                "write the name alone, or a signal of motors: {}",
                known.join(", ")
            )),
        );
        return None;
    }
    Some((*motors, signal))
}

fn gap(fields: &Fields, found: &mut Found) -> GapSettings {
    let mut gap = GapSettings::default();
    let Some(fields) = fields
        .get("gap")
        .and_then(|node| node.fields("`gap`", &["method", "coverage_below"], found))
    else {
        return gap;
    };
    gap.coverage_below = fields
        .get("coverage_below")
        .map(|_| number(&fields, "coverage_below", 0.0, Least::From0, found));
    if let Some(method) = fields.get("method").and_then(|node| method(node, found)) {
        gap.method = method;
    }
    gap
}

fn method(node: &Node, found: &mut Found) -> Option<GapMethod> {
    let words = GapMethod::ALL.map(|method| (method.name(), method));
    let Value::Mapping(_) = node.value else {
        return node.choice("the gap method", &words, found);
    };
    let fields = node.fields("the gap method", &["inverse_distance"], found)?;
    let settings = fields.require(
        "inverse_distance",
        "write `{inverse_distance: {power: 2, neighbours: 3}}`",
        found,
    )?;
    let fields = settings.fields("`inverse_distance`", &["power", "neighbours"], found)?;
    let neighbours = fields
        .get("neighbours")
        .and_then(|node| node.whole("`neighbours`", 1, found));
    Some(GapMethod::InverseDistance {
        neighbours: neighbours.map_or(3, |n| usize::try_from(n).unwrap_or(usize::MAX)),
        power: number(&fields, "power", 2.0, Least::Above0, found),
    })
}

fn elevated_risk(fields: &Fields, found: &mut Found) -> AccumulatorSettings {
    let default = AccumulatorSettings::default();
    let keys = ["window_s", "high", "low", "rise_per_s", "fall_per_s"];
    let Some(fields) = fields
        .get("elevated_risk")
        .and_then(|node| node.fields("`elevated_risk`", &keys, found))
    else {
        return default;
    };
    let settings = AccumulatorSettings {
        window_s: number(&fields, "window_s", default.window_s, Least::Above0, found),
        high_pct: number(&fields, "high", default.high_pct, Least::From0, found),
        low_pct: number(&fields, "low", default.low_pct, Least::From0, found),
        rise_pct_per_s: number(
            &fields,
            "rise_per_s",
            default.rise_pct_per_s,
            Least::From0,
            found,
        ),
        fall_pct_per_s: number(
            &fields,
            "fall_per_s",
            default.fall_pct_per_s,
            Least::From0,
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
                .help("the elevated risk falls below `low` and rises above `high`"),
        );
    }
    settings
}

fn verdict(fields: &Fields, found: &mut Found) -> VerdictSettings {
    let default = VerdictSettings::default();
    let keys = [
        "warn",
        "fail",
        "clear_after_s",
        "quiet_after_take_off_s",
        "quiet_before_landing_s",
        "idle_below",
        "noise",
        "reserve",
        "imbalance",
    ];
    let Some(fields) = fields
        .get("verdict")
        .and_then(|node| node.fields("`verdict`", &keys, found))
    else {
        return default;
    };
    let mut seconds = |key, default| number(&fields, key, default, Least::From0, found);
    let settings = VerdictSettings {
        clear_after_s: seconds("clear_after_s", default.clear_after_s),
        quiet_after_take_off_s: seconds("quiet_after_take_off_s", default.quiet_after_take_off_s),
        quiet_before_landing_s: seconds("quiet_before_landing_s", default.quiet_before_landing_s),
        idle_below: seconds("idle_below", default.idle_below),
        ..default
    };
    VerdictSettings {
        warn: level(&fields, "warn", default.warn, found),
        fail: level(&fields, "fail", default.fail, found),
        notices: NoticeSettings {
            noise: limit(&fields, "noise", "above", found),
            reserve: limit(&fields, "reserve", "below", found),
            imbalance: limit(&fields, "imbalance", "above", found),
        },
        ..settings
    }
}

fn level(fields: &Fields, key: &str, default: LevelSettings, found: &mut Found) -> LevelSettings {
    let what = format!("`{key}`");
    let keys = ["risk", "elevated_risk", "after_s", "until"];
    let Some(node) = fields.get(key) else {
        return default;
    };
    let Some(fields) = node.fields(&what, &keys, found) else {
        return default;
    };
    let raise = threshold(&fields, &what, found);
    if raise == Threshold::default() && found.is_empty() {
        let message = format!("{what} has no threshold");
        found.push(
            Diagnostic::error("missing-key", node.span.clone(), message)
                .help("write `risk`, `elevated_risk` or both, in %"),
        );
    }
    let after_s = number(&fields, "after_s", default.after_s, Least::From0, found);
    let mut until = raise;
    if let Some(node) = fields.get("until")
        && let Some(fields) = node.fields("`until`", &["risk", "elevated_risk"], found)
    {
        until = threshold(&fields, "`until`", found);
        for (lower, upper) in [
            (until.risk_pct, raise.risk_pct),
            (until.elevated_risk_pct, raise.elevated_risk_pct),
        ] {
            if let (Some(lower), Some(upper)) = (lower, upper)
                && lower > upper
            {
                let message = format!("{what} is held until {lower}, which is above {upper}");
                found.push(
                    Diagnostic::error("order", node.span.clone(), message)
                        .help("a level is held down to a lower value than it is raised at"),
                );
            }
        }
    }
    LevelSettings {
        raise,
        after_s,
        until,
    }
}

fn threshold(fields: &Fields, what: &str, found: &mut Found) -> Threshold {
    let mut limit = |key: &str| {
        let node = fields.get(key)?;
        let value = node.finite(&format!("`{key}`"), found)?;
        if !(0.0..=100.0).contains(&value) {
            let message = format!("{what}: `{key}` is a percentage, not {value}");
            found.push(
                Diagnostic::error("out-of-range", node.span.clone(), message)
                    .help("write a number from 0 to 100"),
            );
        }
        Some(value)
    };
    Threshold {
        risk_pct: limit("risk"),
        elevated_risk_pct: limit("elevated_risk"),
    }
}

/// A limit of a notice: `{above: 0.04, after_s: 10}`.
fn limit(fields: &Fields, key: &str, side: &str, found: &mut Found) -> Option<Limit> {
    let what = format!("`{key}`");
    let fields = fields.get(key)?.fields(&what, &[side, "after_s"], found)?;
    let help = format!("write `{key}: {{{side}: 0.1, after_s: 3}}`");
    let value = fields
        .require(side, &help, found)?
        .finite(&format!("`{side}`"), found)?;
    let after_s = number(&fields, "after_s", 0.0, Least::From0, found);
    Some(Limit { value, after_s })
}

/// The least that a number may be.
#[derive(Clone, Copy)]
enum Least {
    From0,
    Above0,
}

/// A number that may be left out.
fn number(fields: &Fields, key: &str, default: f64, least: Least, found: &mut Found) -> f64 {
    let Some(node) = fields.get(key) else {
        return default;
    };
    let Some(value) = node.finite(&format!("`{key}`"), found) else {
        return default;
    };
    let (fits, expected) = match least {
        Least::From0 => (value >= 0.0, "not below 0"),
        Least::Above0 => (value > 0.0, "above 0"),
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

#[cfg(test)]
mod tests;
