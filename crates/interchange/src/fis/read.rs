//! Reads FIS.

use fuzzy::{
    diagnostic::quoted,
    format::{Document, TermSpans, VariableSpans},
    model::{Defuzzifier, Formula, Output, Variable},
};

use super::{
    rules,
    term::{self, ParameterForm},
    type2,
};
use crate::{
    Format, Losses,
    model_draft::{self, MAX_VARIABLES, ModelDraft},
    shapes, words,
};

/// A section: `[Name]` and its lines.
pub(super) struct Section<'t> {
    name: &'t str,
    entries: Vec<Entry<'t>>,
}

/// A line `Key=value`; a line without `=` is a value without a key.
struct Entry<'t> {
    key: &'t str,
    value: &'t str,
}

impl<'t> Section<'t> {
    fn get(&self, key: &str) -> Option<&'t str> {
        let is_key = |entry: &&Entry<'_>| entry.key.eq_ignore_ascii_case(key);
        self.entries.iter().find(is_key).map(|entry| entry.value)
    }

    /// The number after a name: 2 for `Input2`.
    fn index(&self, word: &str) -> Option<usize> {
        let (start, number) = self.name.split_at_checked(word.len())?;
        start
            .eq_ignore_ascii_case(word)
            .then(|| number.parse().ok())
            .flatten()
    }

    fn numbered<'s>(sections: &'s [Section<'t>], word: &str) -> Vec<&'s Section<'t>> {
        let mut found: Vec<(usize, &Section<'_>)> = sections
            .iter()
            .filter_map(|section| Some((section.index(word)?, section)))
            .collect();
        found.sort_by_key(|&(index, _)| index);
        found.into_iter().map(|(_, section)| section).collect()
    }
}

pub(crate) fn read(text: &str, losses: Losses) -> Result<Document, fuzzy::Findings> {
    let mut draft = ModelDraft::new(text, losses);
    let sections = sections(&mut draft);
    let system = sections
        .iter()
        .find(|s| s.name.eq_ignore_ascii_case("System"));
    let Some(system) = system else {
        let message = "there is no section `[System]`".into();
        draft.error(
            "fis-syntax",
            &text[..0],
            message,
            "a FIS begins with `[System]`",
        );
        return draft.finish();
    };
    draft.model.name = unquoted(system.get("Name").unwrap_or("unnamed")).into();
    let Some(weighted) = kind(&mut draft, system) else {
        return draft.finish();
    };
    let mut entries = sections.iter().flat_map(|section| &section.entries);
    let is_type2 = entries.any(|entry| type2::bound(entry.key).is_some());
    if is_type2 && !weighted {
        let part = system.get("Type").unwrap_or(system.name);
        let message = "the terms are type-2 terms, but the system is a Mamdani system".into();
        let help = "files with `MF1U` and `MF1L` are those of the IT2-FLS toolbox, which has only Sugeno systems";
        draft.error("type-2", part, message, help);
    }
    operators(&mut draft, system, weighted);
    let inputs = Section::numbered(&sections, "Input");
    let names: Vec<&str> = inputs.iter().map(|input| name(input)).collect();
    for section in &inputs {
        let count = draft.model.inputs.len();
        if !draft.allows_another(count, MAX_VARIABLES, "inputs", section.name) {
            break;
        }
        let form = ParameterForm::Plain;
        if let Some((variable, spans)) = variable(&mut draft, section, &names, false, form) {
            draft.model.inputs.push(variable);
            draft.spans.inputs.push(spans);
        }
    }
    let defuzzifier = defuzzifier(&mut draft, system, weighted);
    for section in Section::numbered(&sections, "Output") {
        let count = draft.model.outputs.len();
        if !draft.allows_another(count, MAX_VARIABLES, "outputs", section.name) {
            break;
        }
        let form = match is_type2 {
            true => ParameterForm::Repeated,
            false => ParameterForm::Plain,
        };
        if let Some((variable, spans)) = variable(&mut draft, section, &names, weighted, form) {
            // fuzzylite writes Tsukamoto outputs as weighted averages of fuzzy sets.
            let defuzzifier = match variable.terms.iter().any(shapes::is_computed) {
                false if defuzzifier == Defuzzifier::WeightedAverage => Defuzzifier::Tsukamoto,
                _ => defuzzifier,
            };
            draft
                .model
                .outputs
                .push(Output::new(variable).defuzzifier(defuzzifier));
            draft.spans.outputs.push(spans);
        }
    }
    if is_type2 {
        let (method, and) = (system.get("TypeRedMethod"), system.get("AndMethod"));
        type2::settings(&mut draft, method, and);
    }
    let outputs = draft.model.outputs.len();
    count(&mut draft, system, ("NumInputs", "input"), names.len());
    count(&mut draft, system, ("NumOutputs", "output"), outputs);
    draft.require_output(
        "add an `[Output1]` section, or copy the whole file again if it is cut off",
    );
    // Rules refer to terms by number, so all variables must exist.
    if !draft.has_errors() {
        let section = sections
            .iter()
            .find(|s| s.name.eq_ignore_ascii_case("Rules"));
        let entries = section.map_or(&[][..], |section| &section.entries);
        if section.is_none() && system.get("NumRules").is_some_and(|number| number != "0") {
            let start = draft.text.get(..0).unwrap_or_default();
            let help = "copy the whole file again if it is cut off; for a file without rules write `NumRules=0`";
            draft.error(
                "wrong-count",
                start,
                "there is no section `[Rules]`".into(),
                help,
            );
            return draft.finish();
        }
        count(&mut draft, system, ("NumRules", "rule"), entries.len());
        for entry in entries {
            let rules = draft.model.rules.len();
            rules::read(&mut draft, entry.value);
            if is_type2 && draft.model.rules.len() > rules {
                type2::check_rule(&mut draft, entry.value);
            }
        }
    }
    draft.finish()
}

fn name<'t>(section: &Section<'t>) -> &'t str {
    section.get("Name").map_or(section.name, unquoted)
}

/// A word without its quotes.
pub(super) fn unquoted(word: &str) -> &str {
    word.trim().trim_matches(['\'', '"'])
}

fn sections<'t>(draft: &mut ModelDraft<'t>) -> Vec<Section<'t>> {
    let mut sections: Vec<Section<'t>> = vec![];
    for line in draft.text.lines() {
        let line =
            without_comment(line).trim_matches(|c: char| c.is_whitespace() || c == '\u{feff}');
        if line.is_empty() {
            continue;
        }
        let inner = line
            .strip_prefix('[')
            .and_then(|line| line.strip_suffix(']'));
        let is_name = |name: &&str| name.chars().all(|c| c.is_ascii_alphanumeric());
        if let Some(name) = inner.filter(is_name) {
            sections.push(Section {
                name,
                entries: vec![],
            });
            continue;
        }
        let Some(section) = sections.last_mut() else {
            let message = format!("`{line}` is before the first section");
            draft.error("fis-syntax", line, message, "a FIS begins with `[System]`");
            continue;
        };
        let rules = section.name.eq_ignore_ascii_case("Rules");
        let (key, value) = match line.split_once('=') {
            Some((key, value)) if !rules => (key.trim(), value.trim()),
            _ if rules => ("", line),
            _ => {
                let message = format!("`{line}` is not a line of FIS");
                draft.error("fis-syntax", line, message, "each line reads `Key=value`");
                continue;
            }
        };
        section.entries.push(Entry { key, value });
    }
    sections
}

/// The line up to `%`, `#` or `//` outside quotes.
fn without_comment(line: &str) -> &str {
    let mut quoted = false;
    for (at, c) in line.char_indices() {
        match c {
            '\'' => quoted = !quoted,
            '%' | '#' if !quoted => return &line[..at],
            '/' if !quoted && line[at..].starts_with("//") => return &line[..at],
            _ => {}
        }
    }
    line
}

/// Whether the system is a Sugeno system; `None`, with an error, if its type is not supported.
fn kind(draft: &mut ModelDraft<'_>, system: &Section<'_>) -> Option<bool> {
    let word = system.get("Type").unwrap_or("mamdani");
    match unquoted(word).to_ascii_lowercase().as_str() {
        "mamdani" => Some(false),
        // fuzzylite writes `tsukamoto` if the terms of outputs are monotone sets.
        "sugeno" | "tsukamoto" => Some(true),
        other if other.contains("type2") => {
            let message = format!("the type-2 system `{other}` cannot be read");
            let help = "the text of MATLAB's own type-2 files is not documented: write the terms in YAML, where `lower_scale` and `lower_lag` are MATLAB's `LowerScale` and `LowerLag`";
            draft.error("type-2", word, message, help);
            None
        }
        other => {
            let message = format!("unknown type `{other}`");
            let help = "`mamdani` and `sugeno` can be read";
            draft.error("unknown-word", word, message, help);
            None
        }
    }
}

fn operators(draft: &mut ModelDraft<'_>, system: &Section<'_>, weighted: bool) {
    if let Some(and) = word(draft, system, "AndMethod", words::CONJUNCTIONS) {
        draft.model.operators.and = and;
    }
    if let Some(or) = word(draft, system, "OrMethod", words::DISJUNCTIONS) {
        draft.model.operators.or = or;
    }
    if weighted {
        // MATLAB always multiplies and sums in Sugeno systems, whatever the keys contain.
        if let Some(word) = system
            .get("AggMethod")
            .filter(|word| unquoted(word) != "sum")
        {
            let message = format!("`AggMethod={word}` has no effect in a Sugeno system");
            draft.note(
                "no-effect",
                word,
                message,
                "MATLAB sums, and so does this rule set",
            );
        }
        return;
    }
    if let Some(implication) = word(draft, system, "ImpMethod", words::CONJUNCTIONS) {
        draft.model.operators.implication = implication;
    }
    if let Some(aggregation) = word(draft, system, "AggMethod", words::AGGREGATIONS) {
        draft.model.operators.aggregation = aggregation;
    }
}

fn word<T: Copy>(
    draft: &mut ModelDraft<'_>,
    system: &Section<'_>,
    key: &str,
    known: &'static words::Words<T>,
) -> Option<T> {
    let written = system.get(key)?;
    let word = unquoted(written);
    if word.is_empty() {
        return None;
    }
    draft.word(Format::Fis, known, &format!("`{key}`"), (word, written))
}

fn defuzzifier(draft: &mut ModelDraft<'_>, system: &Section<'_>, weighted: bool) -> Defuzzifier {
    let fallback = match weighted {
        true => Defuzzifier::WeightedAverage,
        false => Defuzzifier::Centroid,
    };
    let Some(value) = word(draft, system, "DefuzzMethod", words::DEFUZZIFIERS) else {
        return fallback;
    };
    let is_weighted = words::is_weighted(value);
    if is_weighted != weighted {
        let written = system.get("DefuzzMethod").unwrap_or(system.name);
        let message = format!("`DefuzzMethod={written}` does not fit the type of the system");
        let help =
            "`wtaver` and `wtsum` are for Sugeno systems, the other methods for Mamdani systems";
        draft.error("wrong-method", written, message, help);
    }
    value
}

fn variable(
    draft: &mut ModelDraft<'_>,
    section: &Section<'_>,
    inputs: &[&str],
    weighted: bool,
    form: ParameterForm,
) -> Option<(Variable, VariableSpans)> {
    let name = name(section);
    let mut spans = VariableSpans::default();
    spans.name = draft.span(name);
    let Some(range) = section.get("Range") else {
        let message = format!("the variable `{name}` has no range");
        draft.error("no-range", name, message, "add `Range=[LOW HIGH]`");
        return None;
    };
    spans.range = draft.span(range);
    let ends = bracketed(range);
    let [low, high] = ends[..] else {
        let message = format!("`{range}` is not a range");
        draft.error("no-range", range, message, "write `Range=[0 10]`");
        return None;
    };
    let ends = (number(draft, low)?, number(draft, high)?);
    let (low, high) = draft.range(range, ends, weighted);
    let mut variable = Variable::new(name, low, high);
    let is_term = |entry: &&Entry<'_>| {
        let number = entry.key.split_at_checked(2);
        let number = number.filter(|(mf, _)| mf.eq_ignore_ascii_case("MF"));
        let is_plain = number.is_some_and(|(_, index)| index.parse::<usize>().is_ok());
        is_plain || matches!(type2::bound(entry.key), Some((_, 'U')))
    };
    for entry in &section.entries {
        if let Some((number, 'L')) = type2::bound(entry.key)
            && section.get(&format!("MF{number}U")).is_none()
        {
            let message = format!("`{}` has no upper membership function", entry.key);
            draft.error("type-2", entry.key, message, &format!("add `MF{number}U`"));
        }
    }
    let terms: Vec<&Entry<'_>> = section.entries.iter().filter(is_term).collect();
    count(
        draft,
        section,
        ("NumMFs", "membership function"),
        terms.len(),
    );
    for entry in terms {
        if !draft.allows_another_term(&variable, entry.value) {
            break;
        }
        let read = match type2::bound(entry.key) {
            None => term::read(draft, entry.value, inputs, form),
            Some((number, _)) => match section.get(&format!("MF{number}L")) {
                Some(lower) => type2::term(draft, entry.value, lower),
                None => {
                    let message = format!("`{}` has no lower membership function", entry.key);
                    draft.error("type-2", entry.key, message, &format!("add `MF{number}L`"));
                    continue;
                }
            },
        };
        if let Some((mut term, term_spans)) = read {
            term.name = distinct(draft, &variable, term.name, &term_spans);
            variable.terms.push(term);
            spans.terms.push(term_spans);
        }
    }
    Some((variable, spans))
}

/// Makes a name distinct from those of the variable's other terms. In FIS, names may be equal, because rules refer to terms
/// by number.
fn distinct(
    draft: &mut ModelDraft<'_>,
    variable: &Variable,
    name: String,
    spans: &TermSpans,
) -> String {
    let taken = |name: &str| variable.terms.iter().any(|term| term.name == name);
    if !taken(&name) {
        return name;
    }
    let free = (2..).map(|number| format!("{name}_{number}"));
    let Some(free) = free.into_iter().find(|name| !taken(name)) else {
        return name;
    };
    let message = format!("`{}` has another term `{name}`", variable.name);
    let part = draft.text.get(spans.name.clone()).unwrap_or_default();
    draft.note(
        "renamed",
        part,
        message,
        &format!("this one becomes `{free}`"),
    );
    free
}

/// The words between brackets, separated by blanks or commas.
pub(super) fn bracketed(text: &str) -> Vec<&str> {
    let inner = text.trim().trim_start_matches('[').trim_end_matches(']');
    let words = inner.split(|c: char| c.is_whitespace() || c == ',' || c == ';');
    words.filter(|word| !word.is_empty()).collect()
}

/// A number, or an expression of numbers and `pi`, such as `-pi/4`, which MATLAB evaluates.
pub(super) fn number(draft: &mut ModelDraft<'_>, word: &str) -> Option<f64> {
    let is_arithmetic = |c: char| c.is_ascii_digit() || ".eEpi+-*/()".contains(c);
    if model_draft::number(word).is_none()
        && word.chars().all(is_arithmetic)
        && let Ok(formula) = word.parse::<Formula>()
        && formula.variables().len() == 0
    {
        let value = formula.evaluate(|_| f64::NAN);
        if value.is_finite() {
            return Some(value);
        }
    }
    draft.number(word)
}

/// Warns if the number of parts of a section differs from the number in its key, as in a file that was cut off.
fn count(
    draft: &mut ModelDraft<'_>,
    section: &Section<'_>,
    (key, noun): (&str, &str),
    found: usize,
) {
    let Some(written) = section.get(key) else {
        return;
    };
    if written.parse() == Ok(found) {
        return;
    }
    let verb = if found == 1 { "is" } else { "are" };
    let counted = rules::counted(found, noun);
    let message = format!("`{key}` is {}, but there {verb} {counted}", quoted(written));
    if found == 0 && written.parse::<usize>().is_ok() {
        let help = "copy the whole file again: it is cut off";
        draft.error("wrong-count", written, message, help);
    } else {
        let help = "check that the file is complete; the items that it contains are read";
        draft.warning("wrong-count", written, message, help);
    }
}
