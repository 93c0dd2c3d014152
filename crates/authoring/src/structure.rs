//! Adds and removes variables, terms and rules in a text. Comments and layout are preserved. The edited text is parsed again to
//! verify that no other variable, term or rule changed.

use std::ops::Range;

use fuzzy::{
    Source,
    format::PartialModel,
    model::{Defuzzifier, MembershipFunction, Term, Variable},
    tree::{Node, Value},
};

use crate::{
    Edit,
    document::{Document, partial},
    edited,
    names::check_name,
};

/// A part of a rule set that can be added or removed. Variables are counted with the inputs first, and rules as in the text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// An input or output.
    Variable(usize),
    /// A term: the index of its variable and its own index.
    Term(usize, usize),
    /// A rule.
    Rule(usize),
}

/// The positions of the names and the rules of a rule set, in bytes.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct EntryPositions {
    /// The name of each variable, inputs first, and the names of its terms.
    pub variables: Vec<(Range<usize>, Vec<Range<usize>>)>,
    /// The rules.
    pub rules: Vec<Range<usize>>,
}

/// Returns the positions of everything that can be renamed or removed; `None` if the text is not a rule set.
pub fn places(document: &Document) -> Option<EntryPositions> {
    let spans = &document.rules()?.spans;
    let variables = spans.inputs.iter().chain(&spans.outputs);
    let terms = |terms: &[fuzzy::format::TermSpans]| terms.iter().map(|t| t.name.clone()).collect();
    Some(EntryPositions {
        variables: variables
            .map(|v| (v.name.clone(), terms(&v.terms)))
            .collect(),
        rules: spans.rules.iter().map(|rule| rule.whole.clone()).collect(),
    })
}

/// Returns the edits that add an input or output with two terms.
///
/// # Errors
/// Returns the reason if the variable cannot be added.
pub fn add_variable(
    document: &Document,
    name: &str,
    (low, high): (f64, f64),
    is_output: bool,
) -> Result<Vec<Edit>, String> {
    let rules = readable(document)?;
    check_name(name)?;
    if variables(rules).any(|known| known.name == name) {
        return Err(format!("the name `{name}` is already used"));
    }
    if !(low.is_finite() && high.is_finite() && low < high) {
        return Err("the range needs two numbers, the smaller one first".into());
    }
    let [first, last] = [low, high].map(written);
    let range = format!("range: [{first}, {last}]");
    let numbers = is_output && rules.model.outputs.iter().all(is_weighted);
    let terms = match numbers {
        true => format!("terms: {{low: {{constant: {first}}}, high: {{constant: {last}}}}}"),
        false => "partition: [low, high]".to_owned(),
    };
    let mut keys = vec![range, terms];
    if is_output {
        let defuzzifier = if numbers {
            "weighted_average"
        } else {
            "centroid"
        };
        keys.push(format!("defuzzifier: {defuzzifier}"));
    }
    let text = document.text();
    let tree = tree(document)?;
    let key = if is_output { "outputs" } else { "inputs" };
    let all = tree.child(key).ok_or(UNREADABLE)?;
    let is_list = matches!(all.value, Value::List(_));
    let edit = match (is_list, is_flow(text, all)) {
        (true, _) => return Err(format!("`{key}` is a list; add the variable in the text")),
        (_, true) => inserted(
            text,
            all,
            len(all),
            &format!("{name}: {{{}}}", keys.join(", ")),
        ),
        (_, false) => {
            let indent = indent_of_entry(text, all);
            let lines: Vec<String> = keys.iter().map(|key| format!("{indent}  {key}")).collect();
            inserted(
                text,
                all,
                len(all),
                &format!("{name}:\n{}", lines.join("\n")),
            )
        }
    };
    let at = match is_output {
        true => rules.model.inputs.len() + rules.model.outputs.len(),
        false => rules.model.inputs.len(),
    };
    verified(
        document,
        rules,
        vec![edit.ok_or(UNREADABLE)?],
        Change::Added(Part::Variable(at)),
    )
}

/// Returns the edits that add a term to a variable, in the widest gap between its terms.
///
/// # Errors
/// Returns the reason if the term cannot be added.
pub fn add_term(document: &Document, variable: usize, name: &str) -> Result<Vec<Edit>, String> {
    let rules = readable(document)?;
    check_name(name)?;
    let known = variables(rules)
        .nth(variable)
        .ok_or("there is no such variable")?;
    if known.terms.iter().any(|term| term.name == name) {
        return Err(format!("the name `{name}` is already used"));
    }
    let text = document.text();
    let node = variable_node(document, rules, variable).ok_or(UNREADABLE)?;
    if node.child("steps").is_some() {
        return Err("a term of `steps` needs a limit; add it in the text".into());
    }
    if let Some(list) = node.child("partition") {
        let is_list = matches!(list.value, Value::List(_));
        if is_list {
            let edit = inserted(text, list, len(list), name).ok_or(UNREADABLE)?;
            let at = known.terms.len();
            return verified(
                document,
                rules,
                vec![edit],
                Change::Added(Part::Term(variable, at)),
            );
        }
        let peaks = known.partition_peaks().ok_or(UNREADABLE)?;
        let (at, peak) = widest_gap(&peaks, known.low, known.high);
        let edit = inserted(text, list, at, &format!("{name}: {}", written(peak)));
        let change = Change::Added(Part::Term(variable, at));
        return verified(document, rules, vec![edit.ok_or(UNREADABLE)?], change);
    }
    let terms = node.child("terms").ok_or(UNREADABLE)?;
    if matches!(terms.value, Value::List(_)) {
        return Err("the terms are a list; add the term in the text".into());
    }
    let output = variable.checked_sub(rules.model.inputs.len());
    let output = output.and_then(|output| rules.model.outputs.get(output));
    let middles: Vec<f64> = known
        .terms
        .iter()
        .filter_map(|term| middle(&term.membership_function))
        .collect();
    let (_, middle) = widest_gap(&middles, known.low, known.high);
    let shape = match output {
        Some(output) if is_weighted(output) => format!("{{constant: {}}}", written(middle)),
        Some(_) if known.terms.iter().all(is_singleton) => {
            format!("{{singleton: {}}}", written(middle))
        }
        _ => {
            let half = (known.high - known.low) / 4.0;
            let [left, middle, right] =
                [middle - half, middle, middle + half].map(|x| rounded(x, known));
            format!(
                "{{triangle: [{}, {}, {}]}}",
                written(left),
                written(middle),
                written(right)
            )
        }
    };
    let at = len(terms);
    let edit = inserted(text, terms, at, &format!("{name}: {shape}")).ok_or(UNREADABLE)?;
    verified(
        document,
        rules,
        vec![edit],
        Change::Added(Part::Term(variable, at)),
    )
}

/// Returns the edits that add a rule after the others.
///
/// # Errors
/// Returns the reason if the rule cannot be added.
pub fn add_rule(document: &Document, rule: &str) -> Result<Vec<Edit>, String> {
    let rules = readable(document)?;
    fuzzy::rule::parse(rule).map_err(|error| error.message)?;
    let (text, tree) = (document.text(), tree(document)?);
    let item = scalar(rule);
    let at = rules.model.rules.len();
    let edit = match tree.child("rules") {
        Some(list) if len(list) > 0 => inserted(text, list, len(list), &item),
        Some(empty) => {
            // The list is `[]`, or nothing follows the key.
            let key = key_end(tree, "rules");
            let span = key.map(|key| match empty.span.is_empty() {
                true => key..key,
                false => key..empty.span.end,
            });
            span.map(|span| Edit {
                span,
                text: format!("\n  - {item}"),
            })
        }
        None => {
            let end = text.len();
            let newline = if text.ends_with('\n') { "" } else { "\n" };
            Some(Edit {
                span: end..end,
                text: format!("{newline}rules:\n  - {item}\n"),
            })
        }
    };
    verified(
        document,
        rules,
        vec![edit.ok_or(UNREADABLE)?],
        Change::Added(Part::Rule(at)),
    )
}

/// Returns the edits that replace the text of a rule. Its confidence, note and comments are kept.
///
/// # Errors
/// Returns the reason if the rule cannot be changed.
pub fn change_rule(document: &Document, rule: usize, to: &str) -> Result<Vec<Edit>, String> {
    let rules = readable(document)?;
    fuzzy::rule::parse(to).map_err(|error| error.message)?;
    let node = rule_nodes(document)?
        .get(rule)
        .ok_or("there is no such rule")?;
    let words = match &node.value {
        Value::Mapping(_) => node.child("rule").ok_or(UNREADABLE)?,
        _ => node,
    };
    let edit = Edit {
        span: trimmed(document.text(), words),
        text: scalar(to),
    };
    verified(document, rules, vec![edit], Change::Other(Part::Rule(rule)))
}

/// Returns the edits that remove a part that no rule uses.
///
/// # Errors
/// Returns the reason if the part cannot be removed.
pub fn remove(document: &Document, part: Part) -> Result<Vec<Edit>, String> {
    let rules = readable(document)?;
    let (text, tree) = (document.text(), tree(document)?);
    let edit = match part {
        Part::Rule(rule) => {
            let list = tree.child("rules").ok_or(UNREADABLE)?;
            match key_end(tree, "rules") {
                // A key without a value is not a list, so an empty list is written.
                Some(key) if len(list) == 1 && !is_flow(text, list) => removed(text, list, rule)
                    .map(|lines| {
                        let empty = Edit {
                            span: key..key,
                            text: " []".into(),
                        };
                        vec![empty, lines]
                    }),
                _ => removed(text, list, rule).map(|edit| vec![edit]),
            }
        }
        Part::Variable(variable) => {
            let known = variables(rules)
                .nth(variable)
                .ok_or("there is no such variable")?;
            unused(rules, &known.name, None)?;
            let inputs = rules.model.inputs.len();
            let (key, index, all) = match variable.checked_sub(inputs) {
                None => ("inputs", variable, inputs),
                Some(output) => ("outputs", output, rules.model.outputs.len()),
            };
            if all < 2 {
                return Err(format!(
                    "a rule set needs {}",
                    if key == "inputs" {
                        "an input"
                    } else {
                        "an output"
                    }
                ));
            }
            let all = tree.child(key).ok_or(UNREADABLE)?;
            removed(text, all, index).map(|edit| vec![edit])
        }
        Part::Term(variable, term) => {
            let known = variables(rules)
                .nth(variable)
                .ok_or("there is no such variable")?;
            let name = &known.terms.get(term).ok_or("there is no such term")?.name;
            unused(rules, &known.name, Some(name))?;
            let node = variable_node(document, rules, variable).ok_or(UNREADABLE)?;
            let fewest = match node.child("terms") {
                Some(_) => 1,
                None => 2,
            };
            if known.terms.len() <= fewest {
                let terms = if fewest == 1 { "a term" } else { "two terms" };
                return Err(format!("`{}` needs {terms}", known.name));
            }
            let terms = ["terms", "partition", "steps"]
                .into_iter()
                .find_map(|key| node.child(key));
            removed(text, terms.ok_or(UNREADABLE)?, term).map(|edit| vec![edit])
        }
    };
    verified(
        document,
        rules,
        edit.ok_or(UNREADABLE)?,
        Change::Removed(part),
    )
}

pub(crate) const UNREADABLE: &str =
    "this part of the text cannot be changed here; change it in the text";

/// A change to verify.
enum Change {
    Added(Part),
    Removed(Part),
    /// A change in which only this part may differ.
    Other(Part),
}

/// The names of variables and terms, and the rules: an edit may change only one part of these.
#[derive(PartialEq)]
struct Outline {
    variables: Vec<(String, Vec<String>)>,
    rules: Vec<String>,
}

impl Outline {
    fn new(rules: &PartialModel) -> Outline {
        let named = |variable: &Variable| {
            let terms = variable.terms.iter().map(|term| term.name.clone());
            (variable.name.clone(), terms.collect())
        };
        let written = rules.model.rules.iter().map(|rule| rule.rule.to_string());
        Outline {
            variables: variables(rules).map(named).collect(),
            rules: written.collect(),
        }
    }

    /// Removes a part; `None` if there is no such part.
    fn without(mut self, part: Part) -> Option<Outline> {
        match part {
            Part::Variable(v) => {
                drop((v < self.variables.len()).then(|| self.variables.remove(v))?)
            }
            Part::Term(v, t) => {
                let terms = &mut self.variables.get_mut(v)?.1;
                drop((t < terms.len()).then(|| terms.remove(t))?);
            }
            Part::Rule(r) => drop((r < self.rules.len()).then(|| self.rules.remove(r))?),
        }
        Some(self)
    }
}

/// Returns the edits if the edited text has only the intended change.
fn verified(
    document: &Document,
    rules: &PartialModel,
    edits: Vec<Edit>,
    change: Change,
) -> Result<Vec<Edit>, String> {
    let after = partial(&Source::new(edited(document.text(), &edits)));
    let is_right = after.is_some_and(|after| {
        let (before, after) = (Outline::new(rules), Outline::new(&after));
        match change {
            Change::Added(part) => after.without(part) == Some(before),
            Change::Removed(part) => before.without(part) == Some(after),
            Change::Other(part) => {
                before.rules.len() == after.rules.len()
                    && before.without(part) == after.without(part)
            }
        }
    });
    match is_right {
        true => Ok(edits),
        false => Err(UNREADABLE.into()),
    }
}

pub(crate) fn readable(document: &Document) -> Result<&PartialModel, String> {
    let rules = document.rules().ok_or("the rule set cannot be read")?;
    match rules.names_unread {
        true => Err("a rule or a term cannot be read; correct it first".into()),
        false => Ok(rules),
    }
}

fn tree(document: &Document) -> Result<&Node, String> {
    document.source().tree().map_err(|_| UNREADABLE.to_owned())
}

pub(crate) fn variables(rules: &PartialModel) -> impl Iterator<Item = &Variable> {
    let outputs = rules.model.outputs.iter().map(|output| &output.variable);
    rules.model.inputs.iter().chain(outputs)
}

fn is_weighted(output: &fuzzy::model::Output) -> bool {
    matches!(
        output.defuzzifier,
        Defuzzifier::WeightedAverage | Defuzzifier::WeightedSum
    )
}

fn is_singleton(term: &Term) -> bool {
    matches!(
        term.membership_function,
        MembershipFunction::Singleton { .. }
    )
}

/// Refuses a variable or term that a rule uses.
fn unused(rules: &PartialModel, variable: &str, term: Option<&str>) -> Result<(), String> {
    let mut users = Vec::new();
    for (index, rule) in rules.model.rules.iter().enumerate() {
        let mut is_used = false;
        let mut named = |of: &str, its: Option<&str>| {
            is_used |= of == variable && (term.is_none() || its == term)
        };
        rule.rule.condition.visit(&mut |proposition| {
            named(
                &proposition.variable.text,
                proposition.term.as_ref().map(|term| term.text.as_str()),
            );
        });
        for consequent in &rule.rule.consequents {
            named(&consequent.output.text, Some(&consequent.term.text));
        }
        if is_used {
            users.push((index + 1).to_string());
        }
    }
    let name = term.unwrap_or(variable);
    match users.as_slice() {
        [] => Ok(()),
        [one] => Err(format!(
            "rule {one} uses `{name}`; remove or change it first"
        )),
        many => Err(format!(
            "the rules {} use `{name}`; remove or change them first",
            many.join(", ")
        )),
    }
}

/// The position after the colon of a key.
fn key_end(node: &Node, key: &str) -> Option<usize> {
    let Value::Mapping(pairs) = &node.value else {
        return None;
    };
    let pair = pairs.iter().find(|(name, _)| name.as_text() == Some(key));
    pair.map(|(name, _)| name.span.end + 1)
}

pub(crate) fn variable_node<'d>(
    document: &'d Document,
    rules: &PartialModel,
    variable: usize,
) -> Option<&'d Node> {
    let tree = document.source().tree().ok()?;
    let inputs = rules.model.inputs.len();
    let (all, index) = match variable.checked_sub(inputs) {
        None => (tree.child("inputs")?, variable),
        Some(output) => (tree.child("outputs")?, output),
    };
    match &all.value {
        Value::Mapping(pairs) => pairs.get(index).map(|(_, node)| node),
        Value::List(items) => items.get(index),
        Value::Scalar(_) => None,
    }
}

fn rule_nodes(document: &Document) -> Result<&[Node], String> {
    match tree(document)?.child("rules").map(|list| &list.value) {
        Some(Value::List(items)) => Ok(items),
        _ => Err(UNREADABLE.into()),
    }
}

fn len(node: &Node) -> usize {
    match &node.value {
        Value::List(items) => items.len(),
        Value::Mapping(pairs) => pairs.len(),
        Value::Scalar(_) => 0,
    }
}

/// The first and the last node of an entry.
fn entry(node: &Node, index: usize) -> Option<(&Node, &Node)> {
    match &node.value {
        Value::List(items) => items.get(index).map(|item| (item, item)),
        Value::Mapping(pairs) => pairs.get(index).map(|(key, value)| (key, value)),
        Value::Scalar(_) => None,
    }
}

fn is_flow(text: &str, node: &Node) -> bool {
    text.get(node.span.clone())
        .is_some_and(|text| text.starts_with(['[', '{']))
}

/// The end of a node in the text, without the spaces before the next node.
pub(crate) fn end(text: &str, node: &Node) -> usize {
    match &node.value {
        Value::List(_) | Value::Mapping(_) if !is_flow(text, node) => {
            let last = len(node).checked_sub(1).and_then(|last| entry(node, last));
            last.map_or(node.span.end, |(key, value)| match value.span.is_empty() {
                true => key.span.end + 1,
                false => end(text, value),
            })
        }
        _ => trimmed(text, node).end,
    }
}

pub(crate) fn trimmed(text: &str, node: &Node) -> Range<usize> {
    let own = text.get(node.span.clone()).unwrap_or_default();
    node.span.start..node.span.start + own.trim_end().len()
}

fn line_start(text: &str, at: usize) -> usize {
    text.get(..at)
        .and_then(|before| before.rfind('\n'))
        .map_or(0, |newline| newline + 1)
}

/// The position after the line break at the end of a line.
fn line_end(text: &str, at: usize) -> usize {
    text.get(at..)
        .and_then(|rest| rest.find('\n'))
        .map_or(text.len(), |newline| at + newline + 1)
}

/// The indentation of the entries of a block.
fn indent_of_entry<'t>(text: &'t str, node: &Node) -> &'t str {
    let first = entry(node, 0).map_or(node.span.start, |(first, _)| first.span.start);
    let line = text.get(line_start(text, first)..first).unwrap_or_default();
    let width = line.len() - line.trim_start_matches(' ').len();
    line.get(..width).unwrap_or_default()
}

/// The edit that inserts an entry before the one with this index, or after the last one.
pub(crate) fn inserted(text: &str, node: &Node, index: usize, item: &str) -> Option<Edit> {
    let at = |place: usize, text: String| {
        Some(Edit {
            span: place..place,
            text,
        })
    };
    if is_flow(text, node) {
        return match (
            entry(node, index),
            index.checked_sub(1).and_then(|last| entry(node, last)),
        ) {
            (Some((next, _)), _) => at(next.span.start, format!("{item}, ")),
            (None, Some((_, last))) => at(end(text, last), format!(", {item}")),
            (None, None) => at(node.span.end.checked_sub(1)?, item.to_owned()),
        };
    }
    let indent = indent_of_entry(text, node);
    let dash = if matches!(node.value, Value::List(_)) {
        "- "
    } else {
        ""
    };
    let line = format!("{indent}{dash}{item}\n");
    if let Some((next, _)) = entry(node, index) {
        return at(line_start(text, next.span.start), line);
    }
    let place = line_end(text, end(text, node));
    match text.get(..place)?.ends_with('\n') {
        true => at(place, line),
        false => at(place, format!("\n{}", line.trim_end())),
    }
}

/// Returns the edit that removes an entry. In a block, the lines of the entry are removed; comments
/// on separate lines are kept.
pub(crate) fn removed(text: &str, node: &Node, index: usize) -> Option<Edit> {
    let (first, last) = entry(node, index)?;
    let behind = match last.span.is_empty() {
        true => first.span.end + 1,
        false => end(text, last),
    };
    let span = if !is_flow(text, node) {
        line_start(text, first.span.start)..line_end(text, behind)
    } else if let Some((next, _)) = entry(node, index + 1) {
        first.span.start..next.span.start
    } else if let Some((_, before)) = index.checked_sub(1).and_then(|before| entry(node, before)) {
        end(text, before)..behind
    } else {
        first.span.start..behind
    };
    Some(Edit {
        span,
        text: String::new(),
    })
}

/// Writes a rule as a YAML scalar.
fn scalar(rule: &str) -> String {
    let rule = rule.split_whitespace().collect::<Vec<_>>().join(" ");
    let is_plain = !rule.contains(": ")
        && !rule.contains(" #")
        && !rule.contains(['[', ']', '{', '}', ',', '"']);
    match is_plain && rule.starts_with(|c: char| c.is_ascii_alphabetic()) {
        true => rule,
        false => format!("'{}'", rule.replace('\'', "''")),
    }
}

/// The widest gap between positions, or between a position and an end of the range: its index and its middle.
fn widest_gap(places: &[f64], low: f64, high: f64) -> (usize, f64) {
    let mut sorted: Vec<f64> = places.to_vec();
    sorted.sort_by(f64::total_cmp);
    let bounds: Vec<f64> = [low]
        .into_iter()
        .chain(sorted.iter().copied())
        .chain([high])
        .collect();
    let gaps = bounds.windows(2).map(|pair| pair[1] - pair[0]).enumerate();
    let widest = gaps.max_by(|a, b| a.1.total_cmp(&b.1).then(b.0.cmp(&a.0)));
    let at = widest.map_or(0, |(at, _)| at);
    let [from, to] = [at, at + 1].map(|i| bounds.get(i).copied().unwrap_or(low));
    (at, shortened((from + to) / 2.0, high - low))
}

/// The position that represents a term when the gaps between terms are measured: the mean of a Gaussian, otherwise the
/// average of the parameters.
fn middle(shape: &MembershipFunction) -> Option<f64> {
    let numbers: Vec<f64> = shape
        .parameters()
        .iter()
        .map(|(.., value)| *value)
        .collect();
    match shape {
        MembershipFunction::Gaussian { .. } => numbers.first().copied(),
        _ if numbers.is_empty() => None,
        _ => Some(numbers.iter().sum::<f64>() / numbers.len() as f64),
    }
}

/// Rounds a number so that its last digit is worth between a thousandth and a hundredth of the width of a range.
fn shortened(value: f64, width: f64) -> f64 {
    let digits = (2.0 - width.log10().floor()).clamp(0.0, 15.0) as usize;
    format!("{value:.digits$}").parse().unwrap_or(value)
}

pub(crate) fn rounded(value: f64, variable: &Variable) -> f64 {
    shortened(value, variable.high - variable.low)
}

pub(crate) fn written(number: f64) -> String {
    fuzzy::yaml::to_line(&Node::number(number))
}

#[cfg(test)]
mod tests;
