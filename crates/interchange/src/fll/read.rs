//! Reads FLL.

use fuzzy::{
    diagnostic::nearest,
    format::{Document, RuleSpans, VariableSpans},
    model::{Aggregation, Block, NoRuleFires, Output, Rule, Sampling, SamplingRule, Variable},
};

use super::{activation, conventions, output_conditions, term};
use crate::{
    Format, Losses, blocks,
    model_draft::{MAX_BLOCKS, MAX_VARIABLES, ModelDraft},
    rules, words,
};

/// A section and its lines.
struct Section<'t> {
    kind: SectionKind,
    /// The name after the keyword of the section.
    name: &'t str,
    entries: Vec<Entry<'t>>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum SectionKind {
    Engine,
    Input,
    Output,
    Rules,
}

/// A line `key: value`.
#[derive(Clone, Copy)]
struct Entry<'t> {
    key: &'t str,
    value: &'t str,
}

/// The keywords of the sections.
const SECTIONS: [&str; 4] = ["Engine", "InputVariable", "OutputVariable", "RuleBlock"];

impl SectionKind {
    fn of(word: &str) -> Option<SectionKind> {
        Some(match word {
            "Engine" => SectionKind::Engine,
            "InputVariable" => SectionKind::Input,
            "OutputVariable" => SectionKind::Output,
            "RuleBlock" => SectionKind::Rules,
            _ => return None,
        })
    }

    /// The keys of a section; those of fuzzylite 5 are last.
    fn keys(self) -> &'static [&'static str] {
        match self {
            SectionKind::Engine => &["description"],
            SectionKind::Input => &["description", "enabled", "range", "lock-range", "term"],
            SectionKind::Output => &[
                "description",
                "enabled",
                "range",
                "lock-range",
                "aggregation",
                "defuzzifier",
                "default",
                "lock-previous",
                "term",
                "accumulation",
                "lock-valid",
            ],
            SectionKind::Rules => &[
                "description",
                "enabled",
                "conjunction",
                "disjunction",
                "implication",
                "activation",
                "rule",
            ],
        }
    }
}

impl<'t> Section<'t> {
    /// The value of the last line with this key.
    fn get(&self, key: &str) -> Option<&'t str> {
        let of_key = self.entries.iter().rev().find(|entry| entry.key == key);
        of_key.map(|entry| entry.value)
    }

    fn all(&self, key: &'static str) -> impl Iterator<Item = &'t str> {
        let of_key = self.entries.iter().filter(move |entry| entry.key == key);
        of_key.map(|entry| entry.value)
    }
}

pub(crate) fn read(text: &str, losses: Losses) -> Result<Document, fuzzy::Findings> {
    let mut draft = ModelDraft::new(text, losses);
    let sections = sections(&mut draft);
    let of = |kind| sections.iter().filter(move |section| section.kind == kind);
    let engine = of(SectionKind::Engine).next();
    draft.model.name = engine.map_or("", |engine| engine.name).to_owned();
    if draft.model.name.is_empty() {
        draft.model.name = "unnamed".into();
    }
    draft.model.description = engine.and_then(description);
    let inputs: Vec<&str> = of(SectionKind::Input).map(|input| input.name).collect();
    for section in of(SectionKind::Input) {
        let count = draft.model.inputs.len();
        if !draft.allows_another(count, MAX_VARIABLES, "inputs", section.name) {
            break;
        }
        // Values outside the range always count as the nearest value inside, whatever `lock-range` is. The line is
        // read only to report an invalid value.
        flag(&mut draft, section, "lock-range");
        if let Some((variable, spans)) = variable(&mut draft, section, &inputs) {
            draft.model.inputs.push(variable);
            draft.spans.inputs.push(spans);
        }
    }
    for section in of(SectionKind::Output) {
        let count = draft.model.outputs.len();
        if !draft.allows_another(count, MAX_VARIABLES, "outputs", section.name) {
            return draft.finish();
        }
        output(&mut draft, section, &inputs);
    }
    blocks(&mut draft, &of(SectionKind::Rules).collect::<Vec<_>>());
    aggregate(&mut draft, &of(SectionKind::Output).collect::<Vec<_>>());
    output_conditions::replace(&mut draft);
    draft.require_output(
        "add an `OutputVariable` section, or copy the whole file again if it is cut off",
    );
    draft.finish()
}

fn description(section: &Section<'_>) -> Option<String> {
    section
        .get("description")
        .filter(|text| !text.is_empty())
        .map(str::to_owned)
}

/// The sections of a text. Errors are reported for content before the first section, and for lines that are not `key:
/// value`, blank or a comment.
fn sections<'t>(draft: &mut ModelDraft<'t>) -> Vec<Section<'t>> {
    let mut sections: Vec<Section<'t>> = vec![];
    for line in draft.text.lines() {
        let line = line.split('#').next().unwrap_or("");
        let line = line.trim_matches(|c: char| c.is_whitespace() || c == '\u{feff}');
        if line.is_empty() {
            continue;
        }
        let Some((key, value)) = line.split_once(':') else {
            let message = format!("`{line}` is not a line of FLL");
            let keys = sections
                .last()
                .map_or(&[][..], |section| section.kind.keys());
            let split = line.split_once(char::is_whitespace);
            let known = split.filter(|(key, _)| keys.contains(key));
            let help = match known {
                Some((key, value)) => format!("write `{key}: {value}`"),
                None => "write each line as `key: value`; a comment begins with `#`".into(),
            };
            draft.error("fll-syntax", line, message, &help);
            // The meaning of the line is clear, so the key is not reported as missing as well.
            if let (Some((key, value)), Some(section)) = (known, sections.last_mut()) {
                section.entries.push(Entry { key, value });
            }
            continue;
        };
        let (key, value) = (key.trim(), value.trim());
        if let Some(kind) = SectionKind::of(key) {
            sections.push(Section {
                kind,
                name: value,
                entries: vec![],
            });
            continue;
        }
        let Some(section) = sections.last_mut() else {
            let message = format!("`{key}` is before the first section");
            let help = "a file begins with `Engine: NAME`";
            draft.error("fll-syntax", key, message, help);
            continue;
        };
        let keys = section.kind.keys();
        if keys.contains(&key) {
            section.entries.push(Entry { key, value });
            continue;
        }
        let message = format!("unknown key `{key}`");
        // A misspelt word is read as the one that is meant, so that the latter is not reported as missing as well.
        let near_key = nearest(key, keys.iter().copied());
        let Some(near) = near_key.or_else(|| nearest(key, SECTIONS)) else {
            draft.warning("unknown-key", key, message, "it is left out");
            continue;
        };
        let help = format!("did you mean `{near}`?");
        draft.error("unknown-key", key, message, &help);
        match SectionKind::of(near).filter(|_| near_key.is_none()) {
            Some(kind) => sections.push(Section {
                kind,
                name: value,
                entries: vec![],
            }),
            None => section.entries.push(Entry { key: near, value }),
        }
    }
    sections
}

/// Whether a section is enabled.
fn is_enabled(draft: &mut ModelDraft<'_>, section: &Section<'_>) -> bool {
    flag(draft, section, "enabled").unwrap_or(true)
}

fn flag(draft: &mut ModelDraft<'_>, section: &Section<'_>, key: &str) -> Option<bool> {
    let word = section.get(key)?;
    match word {
        "true" => Some(true),
        "false" => Some(false),
        _ => {
            let message = format!("`{word}` is neither `true` nor `false`");
            draft.error("not-a-flag", word, message, "write `true` or `false`");
            None
        }
    }
}

fn variable(
    draft: &mut ModelDraft<'_>,
    section: &Section<'_>,
    inputs: &[&str],
) -> Option<(Variable, VariableSpans)> {
    let mut spans = VariableSpans::default();
    spans.name = draft.span(section.name);
    if !is_enabled(draft, section) {
        let message = format!("the variable `{}` is not enabled", section.name);
        let help = "remove it from the file, or enable it";
        draft.loss("not-enabled", section.name, message, help);
    }
    let Some(range) = section.get("range") else {
        let message = format!("the variable `{}` has no range", section.name);
        draft.error("no-range", section.name, message, "add `range: LOW HIGH`");
        return None;
    };
    spans.range = draft.span(range);
    let mut ends = range.split_whitespace();
    let (Some(low), Some(high), None) = (ends.next(), ends.next(), ends.next()) else {
        let message = format!("`{range}` is not a range");
        draft.error(
            "no-range",
            range,
            message,
            "write two numbers: `range: 0 10`",
        );
        return None;
    };
    let computed = section
        .get("defuzzifier")
        .is_some_and(|word| word.starts_with("Weighted"));
    let ends = (draft.number(low)?, draft.number(high)?);
    let (low, high) = draft.range(range, ends, computed);
    let mut variable = Variable::new(section.name, low, high);
    // A formula of a computed value reads the inputs; a formula of a fuzzy set reads its own variable.
    let own = (!computed).then_some(section.name);
    variable.description = description(section);
    for written in section.all("term") {
        if let Some((term, span)) = term::read(draft, written, inputs, own) {
            conventions::add(draft, (&mut variable, &mut spans), (term, span), written);
        }
    }
    Some((variable, spans))
}

fn output(draft: &mut ModelDraft<'_>, section: &Section<'_>, inputs: &[&str]) {
    let Some((variable, mut spans)) = variable(draft, section, inputs) else {
        return;
    };
    let mut output = Output::new(variable);
    if let Some(written) = section.get("defuzzifier") {
        spans.samples = draft.span(written);
        defuzzifier(draft, written, &mut output);
    }
    if let Some(word) = section.get("default").filter(|word| !word.is_empty()) {
        spans.default = draft.span(word);
        output.when_no_rule_fires = match draft.number(word) {
            Some(value) if !value.is_nan() => NoRuleFires::Value(value),
            _ => NoRuleFires::Undefined,
        };
    }
    let locks = ["lock-previous", "lock-valid"].map(|key| flag(draft, section, key) == Some(true));
    if locks.contains(&true) {
        output.when_no_rule_fires = NoRuleFires::Previous(match output.when_no_rule_fires {
            NoRuleFires::Value(value) => Some(value),
            _ => None,
        });
    }
    // Values of fuzzy sets are inside the range anyway.
    let is_locked = flag(draft, section, "lock-range") == Some(true);
    output.clamp = words::is_weighted(output.defuzzifier) && is_locked;
    draft.model.outputs.push(output);
    draft.spans.outputs.push(spans);
}

/// Reads `Centroid 100` or `WeightedAverage Automatic`.
fn defuzzifier(draft: &mut ModelDraft<'_>, written: &str, output: &mut Output) {
    let mut parts = written.split_whitespace();
    let word = parts.next().unwrap_or("");
    let words = words::DEFUZZIFIERS;
    let Some(known) = draft.word(Format::Fll, words, "defuzzifier", (word, written)) else {
        return;
    };
    output.defuzzifier = known;
    let weighted = words::is_weighted(known);
    if weighted {
        conventions::tsukamoto(output);
        return;
    }
    let Some(part) = parts.next() else {
        return;
    };
    match part.parse() {
        Ok(samples) => {
            output.samples = Some(Sampling {
                samples,
                rule: SamplingRule::Midpoint,
            });
        }
        Err(_) => {
            let message = format!("`{part}` is not a number of samples");
            let help = "write `defuzzifier: Centroid 100`";
            draft.error("no-samples", part, message, help);
        }
    }
}

/// The operator in a section, if it is present.
fn operator<T: Copy>(
    draft: &mut ModelDraft<'_>,
    section: &Section<'_>,
    key: &'static str,
    words: &words::Words<T>,
) -> Option<T> {
    let word = section.get(key)?;
    if word.is_empty() || word == "none" {
        return None;
    }
    draft.word(Format::Fll, words, key, (word, word))
}

/// The rules of all blocks.
fn blocks(draft: &mut ModelDraft<'_>, sections: &[&Section<'_>]) {
    let mut blocks = vec![];
    for (index, section) in sections.iter().enumerate() {
        if !draft.allows_another(index, MAX_BLOCKS, "rule blocks", section.name) {
            break;
        }
        let mut block = Block::new(section.name);
        block.description = description(section);
        block.enabled = is_enabled(draft, section);
        let and = operator(draft, section, "conjunction", words::CONJUNCTIONS);
        let or = operator(draft, section, "disjunction", words::DISJUNCTIONS);
        (block.and, block.or) = (and.unwrap_or_default(), or.unwrap_or_default());
        // In fuzzylite 5, `activation` had the meaning of the implication.
        let old = section
            .get("activation")
            .filter(|word| words::value(words::CONJUNCTIONS, Format::Fll, word).is_some());
        let key = match old {
            Some(_) => "activation",
            None => "implication",
        };
        let implication = operator(draft, section, key, words::CONJUNCTIONS);
        block.implication = implication.unwrap_or_default();
        if let Some(word) = section
            .get("activation")
            .filter(|word| old.is_none() && !word.is_empty())
        {
            match activation::read(word) {
                Some(activation) => block.activation = activation,
                None => {
                    draft.unknown_word(
                        Format::Fll,
                        "activation",
                        (word, word),
                        &activation::METHODS,
                    );
                }
            }
        }
        let uses = |word: &str| {
            let mut rules = section.all("rule");
            rules.any(|rule| {
                rule.split(" then ")
                    .next()
                    .is_some_and(|it| it.contains(word))
            })
        };
        for (key, word, assumed) in [
            ("conjunction", " and ", "minimum"),
            ("disjunction", " or ", "maximum"),
        ] {
            let part = section.get(key).filter(|part| !part.is_empty());
            if part.is_none_or(|part| part == "none") && uses(word) {
                let message = format!("a rule uses `{}`, but there is no `{key}`", word.trim());
                let help = format!("`{assumed}` is assumed; fuzzylite refuses such an engine");
                draft.note("assumed", part.unwrap_or(section.name), message, &help);
            }
        }
        for written in section.all("rule") {
            let Some(rule) = rules::read(draft, &rules::words(written)) else {
                continue;
            };
            let mut spans = RuleSpans::default();
            spans.whole = draft.span(written);
            draft.spans.rules.push(spans);
            draft.model.rules.push(Rule {
                block: index,
                ..Rule::from(rule)
            });
        }
        blocks.push(block);
    }
    blocks::set_blocks(&mut draft.model, blocks);
}

/// The aggregation of each output.
fn aggregate(draft: &mut ModelDraft<'_>, outputs: &[&Section<'_>]) {
    let mut found = vec![];
    for section in outputs {
        let key = match section.get("accumulation") {
            Some(_) => "accumulation",
            None => "aggregation",
        };
        let aggregation = operator(draft, section, key, words::AGGREGATIONS);
        let output = draft.model.outputs.get(found.len());
        let weighted = output.is_some_and(|output| words::is_weighted(output.defuzzifier));
        let joins = weighted && !matches!(aggregation, None | Some(Aggregation::Sum));
        if joins {
            let part = section.get(key).unwrap_or(section.name);
            blocks::joined(
                draft,
                section.name,
                part,
                "write `aggregation: none`, with which each rule counts",
            );
        }
        found.push(aggregation.filter(|_| !weighted));
    }
    blocks::aggregate(&mut draft.model, &found);
}
