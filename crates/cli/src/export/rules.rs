//! A rule set without a profile, in Rust or C: its outputs as a function of its inputs.

use std::path::Path;

use flagred::{
    board::{
        Rules,
        table::{Outcome, PartialConjunction, StrongestRule},
    },
    plan,
};
use fuzzy::{
    Engine, Source,
    model::{Model, Variable},
};

use super::{Arguments, Language, bytes_of_rules, c, harmless, rust};
use crate::{
    failure::{Exit, Failure},
    output::{Files, Replace, print_note},
    rule_set,
};

/// The maximum stack of an evaluation; more would overflow the stack of many threads.
const MAX_STACK_BYTES: usize = 1 << 20;

/// Writes a rule set in Rust or C.
pub(super) fn export(arguments: &Arguments, source: &Source) -> Result<Exit, Failure> {
    let file = &arguments.file;
    let model = rule_set::engine(source, file)?.model();
    let output = Files::reading([Path::new(file)])?.output(&arguments.output, Replace::Yes)?;
    let (text, warnings) = code((model, file), arguments.language(), arguments.lossy)?;
    for warning in warnings {
        print_note(&format!("warning: {warning}"));
    }
    output.write(&text)?;
    Ok(Exit::Clean)
}

/// Returns a rule set as code, with warnings about dropped parts. Messages refer to the rule set as
/// `name`.
pub(super) fn code(
    (model, name): (&Model, &str),
    language: Language,
    lossy: bool,
) -> Result<(String, Vec<String>), Failure> {
    let mut model = model.clone();
    let mut warnings = Vec::new();
    for output in &mut model.outputs {
        if let Some(sampling) = output.samples.take_if(|_| lossy) {
            warnings.push(format!(
                "output `{}` is computed exactly, not from {} samples",
                output.variable.name, sampling.samples
            ));
        }
    }
    let engine = Engine::new(&model)
        .map_err(|findings| Failure::unusable(format!("`{name}`"), &findings))?;
    let model = &model;
    let rules = plan::rules(&engine).map_err(|refused| {
        let sampled = model.outputs.iter().any(|output| output.samples.is_some());
        let help = match sampled {
            true => "`--lossy` drops `samples`: the output is then computed exactly",
            false => refused.help(),
        };
        Failure::unreadable(format!("`{name}`: {refused}")).help(help)
    })?;
    let stack = stack_bytes(&rules);
    if language == Language::Rust && stack > MAX_STACK_BYTES {
        return Err(Failure::unreadable(format!(
            "`{name}`: an evaluation takes {stack} bytes, which is too much for a stack"
        ))
        .help("in C, the caller provides the memory"));
    }
    let text = match language {
        Language::Rust => rust::function(&rules, &heading(model, &rules, "--rust", stack)),
        Language::C => {
            let heading = heading(model, &rules, "--c", rules.bytes());
            c::rules(&rules, &model.name, &heading)
        }
        Language::Lua => {
            return Err(Failure::usage(
                "a script for ArduPilot needs a profile, but this is a rule set",
            )
            .help("export a profile as Lua, or the rule set as Rust or C"));
        }
    };
    Ok((text, warnings))
}

/// The comment above the data.
fn heading(model: &Model, rules: &Rules<'_>, option: &str, memory: usize) -> Vec<String> {
    let named = |variable: &Variable| {
        let unit = variable.unit.as_deref().unwrap_or_default();
        format!(
            "{} ({} to {}{}{unit})",
            variable.name,
            variable.low,
            variable.high,
            if unit.is_empty() { "" } else { " " }
        )
    };
    let inputs: Vec<String> = model.inputs.iter().map(named).collect();
    let outputs = model.outputs.iter().map(|output| named(&output.variable));
    let lines = [
        format!(
            "The rule set `{}`, written by `flagred export {option}` {}. Do not edit.",
            model.name,
            env!("CARGO_PKG_VERSION")
        ),
        format!("Inputs, in this order: {}.", inputs.join(", ")),
        format!(
            "Outputs, in this order: {}.",
            outputs.collect::<Vec<String>>().join(", ")
        ),
        format!(
            "{} bytes of constants. An evaluation takes {memory} bytes of memory.",
            size_of::<Rules<'_>>() + bytes_of_rules(rules)
        ),
    ];
    lines.into_iter().map(harmless).collect()
}

/// The stack that an evaluation in Rust needs.
fn stack_bytes(rules: &Rules<'_>) -> usize {
    let strongest = rules.table.outputs.len() * size_of::<StrongestRule>();
    rules.numbers() * size_of::<f64>()
        + rules.partials() * size_of::<PartialConjunction>()
        + strongest
        + rules.outputs() * 2 * size_of::<Outcome>()
}
