//! Checks whether a profile and its rule set fit together, and reports errors and likely mistakes.

use alloc::{
    format,
    string::{String, ToString},
    vec::Vec,
};
use core::ops::Range;

use fuzzy::{
    Engine, Findings, Model,
    check::AcceptedFindings,
    diagnostic::{Diagnostic, Severity, nearest, suggest},
    model::AllowedFinding,
    tree::{Node, Value},
};

use crate::{
    estimator::{Estimator, EstimatorError},
    profile::{ALLOW, FINDINGS, Profile, ProfileInput},
    source::{Signal, Statistic, is_angle},
};

mod reach;
mod single_inputs;
mod units;

use reach::thresholds;
pub use single_inputs::{InputRisk, risks_of_single_inputs};
use units::{durations, elevated_shares, least_divisor, number_of_statistic, range};

/// The minimum share of an input's range that the values of its signal must cover.
const MIN_SHARE: f64 = 0.02;

/// Reads a profile and compiles it with the rule set that it names.
///
/// The findings are located in the profile's text. If there is an error, no estimator is returned. There are warnings
/// for thresholds that the risk cannot reach or never leaves, for WARN above FAIL, for inputs whose signal has another
/// unit or range, and for signals that are spelled almost like a known one. `signals` are names and units of known
/// signals; a flight may have other signals as well.
///
/// # Example: a threshold above the highest risk of the rules
/// ```
/// use flagred::{check, shipped};
/// use fuzzy::Source;
///
/// let rules = Source::new(shipped::RULE_SETS[1].text);
/// let text = shipped::PROFILES[1].text.replace("fail: {risk: 85", "fail: {risk: 99");
/// let (findings, estimator) = check::profile(&Source::new(text), &rules, &[]);
/// assert_eq!(findings.0[0].code, "out-of-reach");
/// assert!(estimator.is_some());
/// ```
pub fn profile(
    profile: &fuzzy::Source,
    rules: &fuzzy::Source,
    signals: &[(&str, &str)],
) -> (Findings, Option<Estimator>) {
    let (tree, read) = match (profile.tree(), Profile::from_source(profile)) {
        (Ok(tree), Ok(read)) => (tree, read),
        (Err(findings), _) | (_, Err(findings)) => return (findings, None),
    };
    let at = ValuePositions(tree);
    let (mut found, estimator) = examine(&read, rules, signals, &at);
    let (allow, spans) = allowed(&at, |finding| finding != OUTVOTED);
    let accepted = AcceptedFindings::remove(&allow, &mut found);
    if estimator.is_some() {
        found.extend(AcceptedFindings::unneeded(&accepted, &spans));
    }
    (Findings::locate(found, profile.text()), estimator)
}

/// All findings of [`profile`], including those that the author accepts.
fn examine(
    profile: &Profile,
    rules: &fuzzy::Source,
    signals: &[(&str, &str)],
    at: &ValuePositions,
) -> (Vec<Diagnostic>, Option<Estimator>) {
    let mut found = Vec::new();
    let estimator = compile(profile, rules, at, &mut found);
    if let Some(estimator) = &estimator {
        thresholds(estimator, &["verdict"], at, &mut found);
        durations(estimator.profile(), at, &mut found);
        found.extend(elevated_shares(
            &profile.elevated_risk,
            &["elevated_risk"],
            at,
        ));
        for other in estimator.others() {
            let risk = other.profile();
            let place = ["other_risks", &risk.output];
            thresholds(other, &place, at, &mut found);
            if risk.elevated_risk != profile.elevated_risk {
                let place = [place[0], place[1], "elevated_risk"];
                found.extend(elevated_shares(&risk.elevated_risk, &place, at));
            }
            found.extend(dropped(profile, risk, &place, at));
        }
        for input in &profile.inputs {
            found.extend(signal(input, estimator.engine().model(), signals, at));
            found.extend(least_divisor(input, profile, at));
        }
    }
    let is_usable = found.iter().all(|one| one.severity < Severity::Error);
    (found, estimator.filter(|_| is_usable))
}

/// The code of the findings of [`outvoted`].
const OUTVOTED: &str = "outvoted";

/// Returns the entries of `allow` whose code satisfies `is_one`, and the positions of these entries.
fn allowed(
    at: &ValuePositions,
    is_one: impl Fn(&str) -> bool,
) -> (Vec<AllowedFinding>, Vec<Range<usize>>) {
    let Some(node) = at.0.child("allow") else {
        return (Vec::new(), Vec::new());
    };
    let mut spans = Vec::new();
    // The profile was read from the same text, without errors.
    let all = AllowedFinding::read(node, &FINDINGS, ALLOW, &mut spans, &mut Vec::new());
    let entries = all.into_iter().zip(spans);
    entries.filter(|(one, _)| is_one(&one.finding)).unzip()
}

/// Returns the entries of `allow`, each with the number of findings of [`profile`] and [`outvoted`] that it accepts.
pub fn accepted(
    profile: &fuzzy::Source,
    rules: &fuzzy::Source,
    signals: &[(&str, &str)],
) -> Vec<AcceptedFindings> {
    let (Ok(tree), Ok(read)) = (profile.tree(), Profile::from_source(profile)) else {
        return Vec::new();
    };
    if read.allow.is_empty() {
        return Vec::new();
    }
    let at = ValuePositions(tree);
    let (mut found, estimator) = examine(&read, rules, signals, &at);
    let outvoted = estimator
        .iter()
        .flat_map(|one| single_inputs::outvoted(one, &at, signals));
    found.extend(outvoted);
    AcceptedFindings::remove(&read.allow, &mut found)
}

/// Warns about inputs that do not come from the motors and cannot raise a level by themselves: the other inputs outvote
/// them, however bad their values are.
///
/// These warnings are for the author of a profile; the warnings of [`profile`] are for everyone who uses it. `signals` are
/// the known signals, as for [`profile`]; an input whose signal is probably misspelt has no warning.
///
/// # Example: a battery as one more vote
/// ```
/// use flagred::{check, shipped};
/// use fuzzy::Source;
///
/// let rules = shipped::RULE_SETS[0].text;
/// let rules = rules
///     .replace("inputs:", "inputs:\n  battery: {range: [0, 100], partition: {empty: 20, ok: 35}}")
///     .replace("rules:\n", "rules:\n  - IF battery IS empty THEN risk IS very_high\n");
/// let text = shipped::PROFILES[0].text;
/// let text = text.replace("inputs:", "inputs:\n  battery: {last: battery_remaining_pct}");
/// let profile = Source::new(text);
/// let (fits, estimator) = check::profile(&profile, &Source::new(rules), &[]);
/// assert!(fits.0.is_empty());
/// let found = check::outvoted(&profile, &estimator.ok_or("errors")?, &[]);
/// assert!(found.0[0].message.starts_with("`battery` cannot raise a warning alone"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn outvoted(
    profile: &fuzzy::Source,
    estimator: &Estimator,
    signals: &[(&str, &str)],
) -> Findings {
    let Ok(tree) = profile.tree() else {
        return Findings::locate(Vec::new(), profile.text());
    };
    let at = ValuePositions(tree);
    let mut found = single_inputs::outvoted(estimator, &at, signals);
    let (allow, spans) = allowed(&at, |finding| finding == OUTVOTED);
    let accepted = AcceptedFindings::remove(&allow, &mut found);
    found.extend(AcceptedFindings::unneeded(&accepted, &spans));
    Findings::locate(found, profile.text())
}

/// The positions of the values of a document, by their keys.
struct ValuePositions<'t>(&'t Node);

impl ValuePositions<'_> {
    /// The span of a word within the value at a path of keys, or else that of the value.
    fn word(&self, path: &[&str], word: &str) -> Range<usize> {
        fn find(node: &Node, word: &str) -> Option<Range<usize>> {
            match &node.value {
                Value::Scalar(scalar) => (scalar.text == word).then(|| node.span.clone()),
                Value::List(items) => items.iter().find_map(|item| find(item, word)),
                Value::Mapping(pairs) => pairs.iter().find_map(|(_, value)| find(value, word)),
            }
        }
        let node = path.iter().try_fold(self.0, |node, key| node.child(key));
        node.and_then(|node| find(node, word))
            .unwrap_or_else(|| self.of(path))
    }

    /// The span of the value at a path of keys; if it is a default, the span of the deepest key that is written.
    fn of(&self, path: &[&str]) -> Range<usize> {
        let mut node = self.0;
        let mut span = node.span.start..node.span.start;
        for key in path {
            let Value::Mapping(pairs) = &node.value else {
                break;
            };
            let is_key = |node: &Node| matches!(&node.value, Value::Scalar(s) if s.text == *key);
            let Some((name, value)) = pairs.iter().find(|(name, _)| is_key(name)) else {
                break;
            };
            node = value;
            span = match value.value {
                Value::Scalar(_) => value.span.clone(),
                _ => name.span.clone(),
            };
        }
        span
    }
}

/// The estimator, or `None` with an error in `found`, located at the part of the profile to change.
fn compile(
    profile: &Profile,
    rules: &fuzzy::Source,
    at: &ValuePositions,
    found: &mut Vec<Diagnostic>,
) -> Option<Estimator> {
    let compiled = rules.engine().map_err(EstimatorError::from);
    let engine = compiled.as_ref().ok().copied();
    let error = match compiled.and_then(|engine| Estimator::with_engine(profile, engine)) {
        Ok(estimator) => return Some(estimator),
        Err(error) => error,
    };
    let mut errors = Vec::from([error]);
    if let Some(engine) = engine {
        errors.extend(other_names(profile, engine, &errors[0]));
    }
    for error in &errors {
        found.push(misfit(error, profile, engine, at));
    }
    None
}

/// If the first error is about a name, returns all errors about names of inputs except that one; otherwise none.
fn other_names(profile: &Profile, engine: &Engine, first: &EstimatorError) -> Vec<EstimatorError> {
    let is_about_names = matches!(
        first,
        EstimatorError::NoSuchOutput { .. }
            | EstimatorError::NoSuchInput { .. }
            | EstimatorError::NoSource { .. }
    );
    if !is_about_names {
        return Vec::new();
    }
    let inputs: Vec<&str> = engine.input_names().collect();
    let is_stray = |name: &&str| !inputs.contains(name) && !profile.is_part(name);
    let named = profile.inputs.iter().map(|input| input.name.as_str());
    let stray: Vec<&str> = named.clone().filter(is_stray).collect();
    // A misspelt input of the profile is probably the source of the input with a similar name.
    let is_meant = |name: &str| {
        let mut stray = stray.iter();
        stray.any(|stray| nearest(stray, inputs.iter().copied()) == Some(name))
    };
    let missing = inputs
        .iter()
        .filter(|name| named.clone().all(|known| known != **name));
    let missing = missing.filter(|name| !is_meant(name));
    let missing = missing.map(|input| EstimatorError::NoSource {
        input: (*input).into(),
    });
    let stray = stray.iter().map(|input| EstimatorError::NoSuchInput {
        input: (*input).into(),
    });
    stray
        .chain(missing)
        .filter(|error| error != first)
        .collect()
}

/// Returns the finding for an error of [`Estimator::with_engine`].
fn misfit(
    error: &EstimatorError,
    profile: &Profile,
    engine: Option<&Engine>,
    at: &ValuePositions,
) -> Diagnostic {
    let of_output = |output: &str| {
        let mut others = profile.other_risks.iter();
        match others.find(|risk| risk.output == output) {
            Some(risk) => Vec::from(["other_risks", &risk.output]),
            None => Vec::from(["output"]),
        }
    };
    let (code, place, help) = match error {
        EstimatorError::NoSource { input } => (
            "missing-input",
            at.of(&["inputs"]),
            format!("add `{input}: {{mean: SIGNAL}}` to `inputs`"),
        ),
        EstimatorError::NoSuchInput { input } => {
            let inputs = engine.iter().flat_map(|engine| engine.input_names());
            let help = match suggest(input, inputs) {
                Some(help) if help.starts_with("did you mean") => help,
                _ => format!("remove `{input}`, or add an input with this name to the rule set"),
            };
            ("unknown-input", at.of(&["inputs", input]), help)
        }
        EstimatorError::NoSuchOutput { output } => {
            let outputs = engine.iter().flat_map(|engine| engine.output_names());
            let outputs: Vec<&str> = outputs.collect();
            let place = of_output(output);
            match (place.as_slice(), outputs.as_slice()) {
                (["output"], [only]) if at.0.child("output").is_none() => (
                    "unknown-output",
                    at.of(&["rules"]),
                    format!("add `output: {only}`"),
                ),
                (["output"], _) => {
                    let help = suggest(output, outputs.iter().copied())
                        .unwrap_or_else(|| "name the output with `output: NAME`".into());
                    ("unknown-output", at.of(&place), help)
                }
                _ => {
                    let others = outputs.into_iter().filter(|name| *name != profile.output);
                    let help = suggest(output, others).unwrap_or_else(|| {
                        format!("remove it: `{}` is the only output of the rule set", profile.output)
                    });
                    ("unknown-output", at.of(&place), help)
                }
            }
        }
        EstimatorError::NoPercentage { output, .. } => (
            "not-a-percentage",
            at.of(&of_output(output)),
            "write the output of the rule set with `range: [0, 100]`".into(),
        ),
        EstimatorError::KeepsPrevious { output } => (
            "keeps-previous",
            at.of(&of_output(output)),
            "write `when_no_rule_fires: undefined` in the rule set; `gap` of the profile defines how gaps are filled".into(),
        ),
        EstimatorError::IfMissingOutside { input, low, high, .. } => (
            "out-of-range",
            at.of(&["inputs", input, "if_missing"]),
            format!("write a number from {low} to {high}"),
        ),
        EstimatorError::Type2 => (
            "type-2-terms",
            at.of(&["rules"]),
            "name a rule set whose terms have one membership function each".into(),
        ),
        EstimatorError::Rules(_) | EstimatorError::Evaluate(_) => (
            "rule-set",
            at.of(&["rules"]),
            "`flagred check` shows what is wrong with the rule set".into(),
        ),
    };
    Diagnostic::error(code, place, error.to_string()).help(help)
}

/// Finds levels of another risk without a threshold for the elevated risk, although the same level of the first risk
/// has one. A level that is written for another risk replaces the level of the first risk as a whole, so the omitted
/// threshold does not apply.
fn dropped(
    first: &Profile,
    other: &Profile,
    place: &[&str],
    at: &ValuePositions,
) -> Vec<Diagnostic> {
    let levels = [
        ("warn", &first.verdict.warn, &other.verdict.warn),
        ("fail", &first.verdict.fail, &other.verdict.fail),
    ];
    let dropped = levels.into_iter().filter_map(|(name, first, other)| {
        let threshold = first.raise.elevated_risk_pct?;
        let is_dropped = other.raise.elevated_risk_pct.is_none();
        is_dropped.then(|| {
            let message = format!("`{name}` has no `elevated_risk`, unlike `{name}` in `verdict`");
            let help = format!(
                "a level that is written here replaces the whole level of `verdict`: write `elevated_risk: {}`, too",
                shown(threshold)
            );
            Diagnostic::warning(
                "missing-threshold",
                at.of(&[place, &[name]].concat()),
                message,
            )
            .help(help)
        })
    });
    dropped.collect()
}

fn is_above(limit: f64, high: f64) -> bool {
    const ROUNDING: f64 = 1e-6;
    limit > high + ROUNDING
}

/// A percentage rounded for a message.
fn shown(x: f64) -> f64 {
    (x * 10.0).round() / 10.0
}

/// Finds a mismatch between an input of the rule set and its signal.
fn signal(
    input: &ProfileInput,
    model: &Model,
    known: &[(&str, &str)],
    at: &ValuePositions,
) -> Option<Diagnostic> {
    let place = at.of(&["inputs", &input.name]);
    let variable = model.inputs.iter().find(|v| v.name == input.name)?;
    let unit_of = |name: &str| {
        let unit = known.iter().find(|(known, _)| *known == name);
        unit.map(|(_, unit)| *unit)
    };
    if let Some(found) = number_of_statistic(input, unit_of, at) {
        return Some(found);
    }
    if let Signal::Difference { a, b } = &input.source.signal {
        let message = match (unit_of(a), unit_of(b)) {
            (Some(of_a), Some(of_b)) if normal(of_a) != normal(of_b) => {
                Some(format!("`{a}` is in `{of_a}`, but `{b}` is in `{of_b}`"))
            }
            _ if is_angle(a) != is_angle(b) => {
                let (angle, other) = if is_angle(a) { (a, b) } else { (b, a) };
                Some(format!("`{angle}` is in degrees, but `{other}` is not"))
            }
            _ => None,
        };
        if let Some(message) = message {
            let help = "a difference needs two signals of the same unit; the names of angles in degrees end in `_deg`";
            return Some(Diagnostic::error("unit", place, message).help(help));
        }
    }
    if let Some((name, message, help)) = unknown_signal(input, known) {
        let place = at.word(&["inputs", &input.name], name);
        return Some(Diagnostic::warning("unknown-signal", place, message).help(help));
    }
    let mut first = input.source.signal.carried().next();
    // A ratio or a product does not have the unit of its signals.
    first = first.filter(|_| {
        let signal = &input.source.signal;
        !matches!(signal, Signal::Ratio { .. } | Signal::Product { .. })
    });
    let first = first.and_then(|name| Some((name, unit_of(name)?)));
    if let (Some((name, unit)), Some(wanted)) = (first, variable.unit.as_deref()) {
        let is_share = matches!(
            input.source.statistic,
            Statistic::ShareBelow(_) | Statistic::ShareAbove(_)
        );
        let is_rate = input.source.statistic == Statistic::Rate;
        let unit = match unit {
            _ if is_share => "1".into(),
            "" => String::new(),
            _ if is_rate => format!("{unit}/s").replace("/s/s", "/s2"),
            _ => unit.to_owned(),
        };
        let is_known = |(_, unit): &(&str, &str)| {
            let unit = normal(unit);
            normal(wanted) == unit || normal(wanted) == unit + "/s"
        };
        if known.iter().any(is_known) && !unit.is_empty() && normal(wanted) != normal(&unit) {
            let message = format!(
                "input `{}` of the rule set is in `{wanted}`, but {}`{name}` is in `{unit}`",
                input.name,
                if is_rate { "the rate of " } else { "" }
            );
            let help = "choose a signal with that unit, or write the terms of the input in the unit of the signal";
            return Some(Diagnostic::warning("unit", place, message).help(help));
        }
    }
    if input.ratio.is_some() {
        return None;
    }
    let keeps_unit = matches!(
        input.source.statistic,
        Statistic::Mean
            | Statistic::Min
            | Statistic::Max
            | Statistic::Last
            | Statistic::Percentile(_)
    );
    if let Some((name, "%")) = first
        && keeps_unit
        && variable.high <= 1.0
    {
        let message = format!(
            "input `{}` goes from {} to {}, but `{name}` is in percent",
            input.name, variable.low, variable.high
        );
        let help = "write the terms of the input in percent, from 0 to 100";
        return Some(Diagnostic::warning("unit", place, message).help(help));
    }
    let (low, high) = range(&input.source)?;
    let shared = high.min(variable.high) - low.max(variable.low);
    if shared >= MIN_SHARE * (variable.high - variable.low) {
        return None;
    }
    let message = format!(
        "the range of input `{}` is {} to {}, but its values are from {low} to {high}",
        input.name, variable.low, variable.high
    );
    let help = "motor commands are fractions of their range, from 0 to 1; write the terms of the input accordingly";
    Some(Diagnostic::warning("unit", place, message).help(help))
}

/// Returns a signal that is probably misspelt, with the message and the help.
fn unknown_signal<'i>(
    input: &'i ProfileInput,
    known: &[(&str, &str)],
) -> Option<(&'i str, String, String)> {
    let mut carried = input.source.signal.carried();
    let column = carried
        .clone()
        .find_map(|name| Some((name, motor_column(name)?)));
    if let Some((name, number)) = column {
        let message = format!(
            "input `{}` reads a column of motor {number}, which is not a signal",
            input.name
        );
        let help = format!("write `{{motor: {number}, of: motor_command}}` in place of `{name}`");
        return Some((name, message, help));
    }
    let name = carried.find(|name| known.iter().all(|(known, _)| known != name))?;
    // CSV logs may have signals of any name, so only a name that resembles a known one is probably a mistake.
    let meant = nearest(name, known.iter().map(|(name, _)| *name))
        .or_else(|| nearest(name, Signal::names()))?;
    // For example `wind`: several known signals begin with `wind_`.
    let start = format!("{name}_");
    let longer = known
        .iter()
        .map(|(name, _)| *name)
        .filter(|name| name.starts_with(&start));
    let longer: Vec<String> = longer.map(|name| format!("`{name}`")).collect();
    let help = match longer.split_last() {
        Some((last, rest)) if !rest.is_empty() => {
            format!("did you mean {} or {last}?", rest.join(", "))
        }
        _ => format!("did you mean `{meant}`?"),
    };
    Some((name, format!("no log format has a signal `{name}`"), help))
}

/// The number of the motor whose column of a CSV has this name: 3 for `pwm3` and `motor3`.
fn motor_column(name: &str) -> Option<u32> {
    let number = name
        .strip_prefix("pwm")
        .or_else(|| name.strip_prefix("motor"))?;
    number.parse().ok().filter(|number| *number > 0)
}

/// Returns the normalised spelling of a unit.
fn normal(unit: &str) -> String {
    let unit = unit.trim().replace('°', "deg").replace('²', "2");
    unit.to_ascii_lowercase()
}

#[cfg(test)]
mod tests;
