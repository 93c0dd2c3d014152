//! Completions at a position in a text: names, hedges and connectives in a rule, keys and values elsewhere.

use fuzzy::model::Variable;
use serde_json::Value;

use crate::document::Document;

/// A completion.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Completion {
    /// The label to show.
    pub label: String,
    /// The text to insert.
    pub text: String,
    /// The kind of completion.
    pub kind: Kind,
    /// Details: a range, a membership function, a unit.
    pub detail: Option<String>,
}

/// The kind of a completion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// A keyword of the rule language.
    Keyword,
    /// An input or output.
    Variable,
    /// A term, or a value of a key.
    Choice,
    /// A key.
    Key,
    /// A signal of a log.
    Signal,
}

/// Returns the completions at an offset in bytes.
pub fn at(document: &Document, offset: usize) -> Vec<Completion> {
    let before = document.text().get(..offset).unwrap_or("");
    if !document.is_profile()
        && let Some(rule) = rule(before)
    {
        return in_rule(document, rule);
    }
    let schema = match document.is_profile() {
        true => serde_json::from_str(flagred::profile::SCHEMA),
        false => serde_json::to_value(fuzzy::format::schema()),
    };
    schema.map_or_else(
        |_| Vec::new(),
        |schema| in_schema(document, before, &schema),
    )
}

fn item(label: &str, kind: Kind, detail: Option<String>) -> Completion {
    Completion {
        label: label.into(),
        text: label.into(),
        kind,
        detail,
    }
}

/// The text of the rule before the cursor, starting at its `IF`.
fn rule(before: &str) -> Option<&str> {
    let mut start = before.len();
    loop {
        start = before.get(..start)?.rfind('\n').map_or(0, |at| at + 1);
        let line = before.get(start..)?.split('\n').next()?;
        let text = line.trim_start();
        if text.starts_with("- ") || text == "-" {
            break;
        }
        // A rule continues on more deeply indented lines; a key ends it.
        if start == 0 || text.is_empty() || text.ends_with(':') {
            return None;
        }
        start -= 1;
    }
    let item = before.get(start..)?;
    let at = item.to_ascii_uppercase().find("IF ")?;
    item.get(at..)
}

/// Returns completions for the words that may follow the given start of a rule.
fn in_rule(document: &Document, rule: &str) -> Vec<Completion> {
    let spaced = rule.replace(['(', ')'], " ");
    let mut words: Vec<&str> = spaced.split_whitespace().collect();
    // The word at the cursor is still being typed.
    if !rule.ends_with([' ', '(', ')', '\n']) {
        words.pop();
    }
    let is = |word: &str, keyword: &str| word.eq_ignore_ascii_case(keyword);
    let hedges = fuzzy::rule::Hedge::ALL.map(fuzzy::rule::Hedge::word);
    let is_hedge = |word: &str| hedges.iter().any(|hedge| is(word, hedge));
    let concludes = words.iter().any(|word| is(word, "THEN"));
    let Some(rules) = document.rules() else {
        return Vec::new();
    };
    let inputs = rules.model.inputs.iter();
    let outputs = rules.model.outputs.iter().map(|output| &output.variable);
    let variables: Vec<&Variable> = match concludes {
        true => outputs.collect(),
        false => inputs.chain(outputs).collect(),
    };
    let keywords = |words: &[&str]| -> Vec<Completion> {
        words
            .iter()
            .map(|word| item(word, Kind::Keyword, None))
            .collect()
    };
    let range = |variable: &Variable| Some(format!("[{}, {}]", variable.low, variable.high));
    let name_of = |word: &str| word.trim_matches(['"', '\'']).to_owned();
    let before_hedges = words.iter().rposition(|word| !is_hedge(word));
    let last = before_hedges.and_then(|at| words.get(at));
    match last {
        Some(word) if is(word, "IS") => {
            let variable = before_hedges.and_then(|at| words.get(at.checked_sub(1)?));
            let variable = variable.map(|word| name_of(word));
            let known = variables
                .iter()
                .find(|v| Some(&v.name) == variable.as_ref());
            let terms = known.iter().flat_map(|v| v.terms.iter());
            let mut found: Vec<_> = terms
                .map(|term| {
                    let shape = fuzzy::format::shape_text(&term.membership_function);
                    item(&term.name, Kind::Choice, Some(shape))
                })
                .collect();
            let hedges = fuzzy::rule::Hedge::ALL.into_iter();
            let fitting = hedges.filter(|hedge| !concludes || hedge.may_conclude());
            found.extend(keywords(
                &fitting.map(|hedge| hedge.word()).collect::<Vec<_>>(),
            ));
            found
        }
        Some(word)
            if ["IF", "AND", "OR", "THEN"]
                .iter()
                .any(|keyword| is(word, keyword)) =>
        {
            let mut found: Vec<_> = variables
                .iter()
                .map(|v| item(&v.name, Kind::Variable, range(v)))
                .collect();
            if !concludes {
                found.extend(keywords(&["NOT"]));
            }
            found
        }
        Some(word) if variables.iter().any(|v| v.name == name_of(word)) => keywords(&["IS"]),
        Some(_) if concludes => keywords(&["AND", "WITH"]),
        Some(_) => keywords(&["AND", "OR", "THEN"]),
        None => Vec::new(),
    }
}

/// The keys that are allowed in the mapping at the cursor, or the values of a key.
fn in_schema(document: &Document, before: &str, root: &Value) -> Vec<Completion> {
    let (path, key) = path(before);
    let mut parts = vec![root];
    for name in &path {
        parts = parts
            .iter()
            .flat_map(|part| step(root, part, name))
            .collect();
    }
    let Some(key) = key else {
        let mut found = Vec::new();
        for part in parts.iter().flat_map(|part| resolved(root, part)) {
            let properties = part.get("properties").and_then(Value::as_object);
            for (name, about) in properties.into_iter().flatten() {
                let about = about.get("description").and_then(Value::as_str);
                let mut one = item(name, Kind::Key, about.map(str::to_owned));
                one.text = format!("{name}: ");
                if found.iter().all(|known: &Completion| known.label != *name) {
                    found.push(one);
                }
            }
        }
        return found;
    };
    let mut found = Vec::new();
    for part in parts.iter().flat_map(|part| step(root, part, &key)) {
        if part
            .get("$ref")
            .is_some_and(|name| name == "#/$defs/signal")
            && document.is_profile()
        {
            found.extend(signals());
        }
        for part in resolved(root, part) {
            let words = part.get("enum").and_then(Value::as_array);
            let words = words.into_iter().flatten().filter_map(Value::as_str);
            found.extend(words.map(|word| item(word, Kind::Choice, None)));
        }
    }
    found
}

fn signals() -> Vec<Completion> {
    let of_motors = flagred::source::Signal::names().map(|name| (name, None));
    let of_logs = flagred_flightlog::known_signals().into_iter();
    let of_logs = of_logs.map(|signal| (signal.name, Some(signal.unit.to_owned())));
    let all = of_motors.chain(of_logs);
    all.map(|(name, unit)| item(name, Kind::Signal, unit))
        .collect()
}

/// A part of a schema and its alternatives, with references resolved.
fn resolved<'s>(root: &'s Value, part: &'s Value) -> Vec<&'s Value> {
    let mut found = vec![part];
    if let Some(Value::String(name)) = part.get("$ref")
        && let Some(named) = root.pointer(name.trim_start_matches('#'))
    {
        found.extend(resolved(root, named));
    }
    for key in ["anyOf", "oneOf"] {
        let all = part.get(key).and_then(Value::as_array);
        found.extend(
            all.into_iter()
                .flatten()
                .flat_map(|one| resolved(root, one)),
        );
    }
    found
}

/// The schema of a key in a mapping; for a list, the schema of its items.
fn step<'s>(root: &'s Value, part: &'s Value, name: &str) -> Vec<&'s Value> {
    let mut found = Vec::new();
    for part in resolved(root, part) {
        if name == "-" {
            found.extend(part.get("items"));
            continue;
        }
        let known = part.get("properties").and_then(|all| all.get(name));
        let other = part
            .get("additionalProperties")
            .filter(|all| all.is_object());
        found.extend(known.or(other));
    }
    found
}

/// The keys above the cursor, and the key whose value contains the cursor.
fn path(before: &str) -> (Vec<String>, Option<String>) {
    let mut lines = before.split('\n').rev();
    let line = lines.next().unwrap_or("");
    let mut indent = line.len() - line.trim_start().len();
    let mut above = Vec::new();
    for other in lines {
        let text = other.trim_start();
        let there = other.len() - text.len();
        if text.is_empty() || text.starts_with('#') || there >= indent {
            continue;
        }
        indent = there;
        let (text, is_item) = match text.strip_prefix("- ") {
            Some(text) => (text, true),
            None => (text, false),
        };
        if let Some((key, _)) = text.split_once(':') {
            above.push(key.trim_matches(['"', '\'']).to_owned());
        }
        if is_item {
            above.push("-".into());
        }
    }
    above.reverse();
    // `{` opens a mapping within the line, `}` closes it.
    let mut key = None;
    let mut word = String::new();
    for letter in line.trim_start().chars() {
        match letter {
            ':' => {
                key = Some(
                    std::mem::take(&mut word)
                        .trim_matches(['"', '\'', ' '])
                        .to_owned(),
                )
            }
            '{' => {
                above.extend(key.take());
                word.clear();
            }
            '}' => {
                above.pop();
                key = None;
            }
            ',' => {
                key = None;
                word.clear();
            }
            '[' | ']' => word.clear(),
            _ => word.push(letter),
        }
    }
    (above, key)
}
