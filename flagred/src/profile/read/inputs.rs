//! Reads the inputs of a profile: statistics over time of a signal, or of a signal combined over the motors.

use alloc::{borrow::ToOwned, format, string::String, vec::Vec};

use fuzzy::{
    diagnostic::Diagnostic,
    tree::{Entry, Fields, Node, Value, percentage_of_share, share_of_percentage},
};

use super::{Bounds, Mistakes, number};
use crate::{
    profile::{ProfileInput, Ratio},
    source::{Motors, Signal, Source, Statistic},
};

const STATISTICS: [(&str, Statistic); 10] = [
    ("mean", Statistic::Mean),
    ("std", Statistic::Std),
    ("rms", Statistic::Rms),
    ("min", Statistic::Min),
    ("max", Statistic::Max),
    ("last", Statistic::Last),
    ("std_less_noise", Statistic::StdLessNoise),
    ("noise", Statistic::Noise),
    ("rate", Statistic::Rate),
    ("median", Statistic::Percentile(50.0)),
];

/// The keys of a ratio.
const RATIO: [&str; 2] = ["per", "at_least"];

type StatisticOfNumber = fn(f64) -> Statistic;

/// The statistics with a parameter, `{share_below: 0.1, of: SIGNAL}`.
const WITH_NUMBER: [(&str, StatisticOfNumber); 3] = [
    ("share_below", Statistic::ShareBelow),
    ("share_above", Statistic::ShareAbove),
    ("percentile", Statistic::Percentile),
];

const MOTORS: [(&str, Motors); 4] = [
    ("mean", Motors::Mean),
    ("std", Motors::Std),
    ("min", Motors::Min),
    ("max", Motors::Max),
];

pub(super) fn inputs(fields: &Fields, window_s: f64, found: &mut Mistakes) -> Vec<ProfileInput> {
    let help =
        "write the source of each input of the rule set: `inputs: {margin: {mean: motor_margin}}`";
    let Some(node) = fields.require("inputs", help, found) else {
        return Vec::new();
    };
    let help =
        "write each input by its name, without `-`: `inputs: {margin: {mean: motor_margin}}`";
    let entries = node.entries("`inputs`", "input", help, found);
    let entries = entries.unwrap_or_default();
    let read = |entry| input(entry, &entries, window_s, found);
    entries.iter().filter_map(read).collect()
}

/// The suggestion for the source of an input that is not a mapping, such as `motor_margin` or `mean(motor_margin)`.
fn source_help(entry: &Entry) -> String {
    let (statistic, signal) = match &entry.value.value {
        Value::Scalar(scalar) => match scalar.text.trim_end_matches(')').split_once('(') {
            Some((statistic, signal)) => (statistic, signal),
            None => ("mean", scalar.text.as_str()),
        },
        _ => ("mean", ""),
    };
    let is_word = |text: &str| {
        let mut letters = text.chars();
        letters.next().is_some_and(|c| c.is_ascii_alphabetic())
            && letters.all(|c| c.is_ascii_alphanumeric() || c == '_')
    };
    let signal = if is_word(signal) {
        signal
    } else {
        "motor_margin"
    };
    let is_known = STATISTICS.iter().any(|(name, _)| *name == statistic);
    let statistic = if is_known { statistic } else { "mean" };
    format!(
        "write a statistic of a signal: `{}: {{{statistic}: {signal}}}`",
        entry.key
    )
}

fn input(
    entry: &Entry,
    entries: &[Entry],
    window_s: f64,
    found: &mut Mistakes,
) -> Option<ProfileInput> {
    let what = format!("input `{}`", entry.key);
    let statistics = STATISTICS.iter().map(|(name, _)| *name);
    let with_number = WITH_NUMBER.iter().map(|(name, _)| *name);
    let keys: Vec<&str> = statistics
        .clone()
        .chain(with_number.clone())
        .chain(["of", "window_s", "time_constant_s", "if_missing"])
        .chain(RATIO)
        .collect();
    let before = found.len();
    let fields = entry
        .value
        .fields(&what, &keys, &source_help(entry), found)?;
    // For example `{motor_margin: mean}`.
    for entry in fields.unknown() {
        if let Some(word) = entry.value.as_text()
            && keys.contains(&word)
            && let Some(finding) = found.iter_mut().find(|one| one.span == entry.key_span)
        {
            finding.help = Some(format!(
                "exchange the key and the value: `{{{word}: {}}}`",
                entry.key
            ));
        }
        // For example `{p95: motor_margin}`.
        if let Some(percent) = entry
            .key
            .strip_prefix('p')
            .and_then(|text| text.parse::<u8>().ok())
            && let Some(signal) = entry.value.as_text()
            && let Some(finding) = found.iter_mut().find(|one| one.span == entry.key_span)
        {
            finding.help = Some(format!("write `{{percentile: {percent}, of: {signal}}}`"));
        }
        // For example `{motor: 1, of: motor_margin}`.
        if entry.key == "motor"
            && let Some(number) = entry.value.as_number_text()
            && let Some(of) = fields.get("of").and_then(Node::as_text)
            && let Some(finding) = found.iter_mut().find(|one| one.span == entry.key_span)
        {
            finding.help = Some(format!(
                "write a statistic of the motor: `{{mean: {{motor: {number}, of: {of}}}}}`"
            ));
        }
        // For example `{std, motor_margin}`.
        let empty = fields.entries().iter().find(|other| {
            other.value.is_null() && other.key != entry.key && keys.contains(&other.key)
        });
        if let (true, Some(empty)) = (entry.value.is_null(), empty)
            && let Some(finding) = found.iter_mut().find(|one| one.span == entry.key_span)
        {
            finding.help = Some(format!("write `{{{}: {}}}`", empty.key, entry.key));
        }
    }
    let given: Vec<&str> = statistics
        .chain(with_number)
        .filter(|k| fields.get(k).is_some())
        .collect();
    let [key] = given.as_slice() else {
        // An unknown key has already been reported; the missing key is not reported in addition.
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
    let window_s = number(&fields, "window_s", window_s, Bounds::Above0, found);
    let plain = STATISTICS.iter().find(|(name, _)| name == key);
    let (statistic, observed) = match plain {
        Some((_, statistic)) => {
            if let Some(stray) = fields.entry("of") {
                let message = format!(
                    "`of` is only for `share_below`, `share_above` and `percentile`, not for `{key}`"
                );
                found.push(
                    Diagnostic::error("statistic", stray.key_span.clone(), message)
                        .help(format!("write the signal alone: `{{{key}: motor_margin}}`")),
                );
            }
            (*statistic, behind)
        }
        None => {
            if let Value::Scalar(word) = &behind.value
                && word.as_number().is_none()
            {
                let message = format!("`{key}` takes a number, and `of` the signal");
                let share = share_of_percentage(&word.text);
                let help = match (share, fields.get("of").and_then(Node::as_text)) {
                    (Some(share), of) => format!(
                        "write `{{{key}: {}, of: {}}}`",
                        match *key {
                            "percentile" => word.text.trim_end_matches(['%', ' ']).to_owned(),
                            _ => format!("{share}"),
                        },
                        of.unwrap_or("motor_margin")
                    ),
                    (None, _) => {
                        let number = fields.get("of").and_then(Node::as_number_text);
                        let example = if *key == "percentile" { "95" } else { "0.1" };
                        format!(
                            "write `{{{key}: {}, of: {}}}`",
                            number.unwrap_or(example),
                            word.text
                        )
                    }
                };
                found
                    .push(Diagnostic::error("wrong-type", behind.span.clone(), message).help(help));
                return None;
            }
            let number = behind.finite(&format!("`{key}`"), found)?;
            let (_, of_number) = WITH_NUMBER.iter().find(|(name, _)| name == key)?;
            let help = format!("name the signal: `{{{key}: {number}, of: battery_v}}`");
            let observed = fields.require("of", &help, found)?;
            let statistic = of_number(number);
            if matches!(statistic, Statistic::Percentile(_)) && !(0.0..=100.0).contains(&number) {
                let message = format!("`percentile` is {number}");
                found.push(
                    Diagnostic::error("out-of-range", behind.span.clone(), message)
                        .help("write a number from 0 to 100"),
                );
                return None;
            }
            (statistic, observed)
        }
    };
    let (motors, signal) = signal(observed, &what, found)?;
    let exponential = fields.entry("time_constant_s");
    if let Some(entry) = exponential {
        let mistake = if fields.get("window_s").is_some() {
            let help = "remove one: all values in `window_s` have equal weights; with `time_constant_s` older values have less weight";
            Some((
                format!("{what} has both `window_s` and `time_constant_s`"),
                help.into(),
            ))
        } else if !statistic.supports_exponential() {
            let help = format!(
                "`time_constant_s` is for `mean`, `std`, `rms` and shares of time; write `window_s` for `{key}`"
            );
            Some((format!("`{key}` has no `time_constant_s`"), help))
        } else {
            None
        };
        if let Some((mistake, help)) = mistake {
            found.push(Diagnostic::error("window", entry.key_span.clone(), mistake).help(help));
            return None;
        }
    }
    let before = found.len();
    let if_missing = fields
        .get("if_missing")
        .and_then(|node| node.finite("`if_missing`", found));
    if let Some(entry) = fields.entry("if_missing")
        && signal.is_computed_from_commands()
    {
        let message = "`if_missing` is for signals that a vehicle may lack, and the motor commands are not such a signal";
        let help = "remove it: without the commands of the motors the risk is unknown";
        found.truncate(before);
        found.push(Diagnostic::error("if-missing", entry.key_span.clone(), message).help(help));
    }
    let needs_one = statistic.uses_bins() || statistic.uses_slots();
    if needs_one && motors == Motors::Pooled && signal.is_of_motors() {
        let message = format!("`{key}` needs one value for all motors");
        let over = if statistic.uses_bins() { "std" } else { "mean" };
        let signal = Signal::name_of(&signal).unwrap_or("motor_command");
        let help = match statistic {
            Statistic::Percentile(number) if *key == "percentile" => {
                let percent = match number < 1.0 {
                    true => percentage_of_share(number),
                    false => number,
                };
                format!("write for example `{{{key}: {percent}, of: {{{over}: {signal}}}}}`")
            }
            _ => format!("write for example `{{{key}: {{{over}: {signal}}}}}`"),
        };
        found.push(Diagnostic::error("statistic", behind.span.clone(), message).help(help));
        return None;
    }
    Some(ProfileInput {
        name: entry.key.into(),
        source: Source {
            statistic,
            motors,
            signal,
            window_s: number(&fields, "time_constant_s", window_s, Bounds::Above0, found),
            exponential: exponential.is_some(),
        },
        ratio: match RATIO.iter().any(|key| fields.get(key).is_some()) {
            true => Some(ratio(&fields, entry, entries, found)?),
            false => None,
        },
        if_missing,
    })
}

/// Reads `per: OTHER, at_least: NUMBER`.
fn ratio(fields: &Fields, entry: &Entry, entries: &[Entry], found: &mut Mistakes) -> Option<Ratio> {
    let help = "write for example `per: room, at_least: 0.02`, with an input `room` beside it";
    let per = fields.require("per", help, found);
    let least = fields.require("at_least", help, found);
    let per = per.and_then(|node| other(node, entry, entries, found));
    let at_least = least.map(|_| number(fields, "at_least", 1.0, Bounds::Above0, found));
    Some(Ratio {
        per: per?,
        at_least: at_least?,
    })
}

/// The name of the input that a ratio divides by.
fn other(node: &Node, entry: &Entry, entries: &[Entry], found: &mut Mistakes) -> Option<String> {
    let name = &node
        .words(
            "an input of a ratio",
            "write the name of another input",
            found,
        )?
        .text;
    let is_ratio = |other: &Entry| other.value.child("per").is_some();
    let message = match entries.iter().find(|other| other.key == *name) {
        Some(other) if other.key != entry.key && !is_ratio(other) => return Some(name.clone()),
        Some(_) => format!("`{name}` is a ratio itself"),
        None => format!("`{name}` is not an input of this profile"),
    };
    let help = "name another input that is not a ratio; it need not be an input of the rule set. For the ratio of two signals, write `{mean: {ratio: [A, B]}}`";
    found.push(Diagnostic::error("ratio", node.span.clone(), message).help(help));
    None
}

/// Reads the name of a signal, which is neither a number nor a computation.
fn signal_name<'n>(node: &'n Node, what: &str, found: &mut Mistakes) -> Option<&'n str> {
    let name = node
        .words(
            what,
            "write the name of a signal, such as `motor_margin`",
            found,
        )?
        .text
        .as_str();
    let message = if name.parse::<f64>().is_ok() {
        format!("{what} must be a name, not the number {name}")
    } else if [" / ", " * ", " - ", " + "]
        .iter()
        .any(|sign| name.contains(sign))
    {
        format!("{what} must be a name, not the computation `{name}`")
    } else {
        return Some(name);
    };
    let help = "name a signal of the log; `difference`, `ratio` and `product` take two: `{mean: {ratio: [battery_a, battery_v]}}`";
    found.push(Diagnostic::error("signal", node.span.clone(), message).help(help));
    None
}

/// The signals that combine two others.
const PAIRS: [&str; 3] = ["difference", "ratio", "product"];

/// Reads `motor_margin`, `{min: motor_margin}`, `{motor: 3, of: motor_margin}` or `{difference: [yaw_des_deg, yaw_deg]}`.
fn signal(node: &Node, what: &str, found: &mut Mistakes) -> Option<(Motors, Signal)> {
    if !matches!(node.value, Value::Mapping(_)) {
        let name = signal_name(node, &format!("the signal of {what}"), found)?;
        return Some((Motors::Pooled, Signal::named(name)));
    }
    let statistics = MOTORS.iter().map(|(name, _)| *name);
    let keys: Vec<&str> = statistics
        .chain(["motor", "of"])
        .chain(PAIRS)
        .chain(["unknown_below"])
        .collect();
    let over = format!("the statistic over motors of {what}");
    let before = found.len();
    let fields = node.fields(&over, &keys, "write the name of a signal", found)?;
    for entry in fields.unknown() {
        if STATISTICS.iter().any(|(name, _)| *name == entry.key)
            && let Some(finding) = found.iter_mut().find(|one| one.span == entry.key_span)
        {
            finding.help =
                Some("the statistics over motors are `mean`, `std`, `min` and `max`".into());
        }
    }
    let given: Vec<&str> = keys
        .into_iter()
        .filter(|key| fields.get(key).is_some())
        .collect();
    if let ["motor"] = given.as_slice() {
        let number = fields.get("motor").and_then(Node::as_text).unwrap_or("1");
        let help = format!("name a signal of motors: `{{motor: {number}, of: motor_command}}`");
        fields.require("of", &help, found)?;
    }
    let over_motors = match given.as_slice() {
        [key] => MOTORS.iter().find(|(name, _)| name == key),
        _ => None,
    };
    let (motors, node) = match (over_motors, given.as_slice()) {
        (Some((key, motors)), _) => (*motors, fields.get(key)?),
        (None, ["motor", "of"]) => {
            let number = fields.get("motor")?.whole("the motor", 1, found)?;
            let motor = u32::try_from(number - 1).unwrap_or(u32::MAX);
            (Motors::One(motor), fields.get("of")?)
        }
        (None, [key] | [key @ "ratio", "unknown_below"]) if PAIRS.contains(key) => {
            let [a, b] = pair(key, fields.get(key)?, found)?;
            let unknown_below = number(&fields, "unknown_below", 0.0, Bounds::From0, found);
            let signal = match *key {
                "difference" => Signal::Difference { a, b },
                "product" => Signal::Product { a, b },
                _ => Signal::Ratio {
                    a,
                    b,
                    unknown_below,
                },
            };
            return Some((Motors::Pooled, signal));
        }
        _ => {
            if found.len() == before {
                let message = match given.contains(&"unknown_below") {
                    true => format!("`unknown_below` of {what} is only for `ratio`"),
                    false => format!(
                        "{over} must be one of `mean`, `std`, `min`, `max`, `motor`, `difference`, `ratio` and `product`"
                    ),
                };
                found.push(
                    Diagnostic::error("statistic", node.span.clone(), message).help(
                        "write for example `{min: motor_margin}` or `{motor: 1, of: motor_margin}`",
                    ),
                );
            }
            return None;
        }
    };
    let name = signal_name(node, &format!("the signal of {what}"), found)?;
    let signal = Signal::named(name);
    if !signal.is_of_motors() {
        let message = format!("`{name}` has one value, not one for each motor");
        let known: Vec<String> = Signal::names_of_motors()
            .map(|name| format!("`{name}`"))
            .collect();
        found.push(
            Diagnostic::error("signal", node.span.clone(), message).help(format!(
                "write only the name, or a signal of motors: {}",
                known.join(", ")
            )),
        );
        return None;
    }
    Some((motors, signal))
}

/// Reads `[yaw_des_deg, yaw_deg]`.
fn pair(key: &str, node: &Node, found: &mut Mistakes) -> Option<[String; 2]> {
    let (what, example) = match key {
        "difference" => (
            "which is the first minus the second",
            "yaw_des_deg, yaw_deg",
        ),
        "ratio" => (
            "which is the first divided by the second",
            "battery_a, battery_v",
        ),
        _ => (
            "which is the first times the second",
            "battery_a, battery_v",
        ),
    };
    let help = format!("write for example `{{{key}: [{example}]}}`");
    let items = node.items(&format!("`{key}`"), &help, found)?;
    let [a, b] = items else {
        let message = format!("`{key}` takes two signals, not {}", items.len());
        let help = format!("{help}, {what}");
        found.push(Diagnostic::error("signal", node.span.clone(), message).help(help));
        return None;
    };
    let mut name = |node: &Node| {
        let name = signal_name(node, &format!("a signal of `{key}`"), found)?;
        if Signal::names().any(|known| known == name) {
            let message = format!("`{key}` takes signals of the vehicle, not `{name}`");
            found.push(
                Diagnostic::error("signal", node.span.clone(), message)
                    .help("write the names of two signals of the log"),
            );
            return None;
        }
        Some(name.to_owned())
    };
    let (a, b) = (name(a), name(b));
    Some([a?, b?])
}
