//! A plan or a rule set as Rust.
//!
//! The debug form of plain data is a valid Rust expression once the names of enumerations are added and the
//! constants `inf` and `NaN` are defined. Each number is written so that exactly the same bits are read back.

use std::fmt::{Debug, Write};

use flagred::{
    board::{Plan, Rules, table::Table},
    channel::{Channel, Input, Statistic, Threshold},
    flight::Words,
};

use super::FindingWords;

/// Returns the file for a profile.
pub(super) fn text(plan: &Plan<'_>, rules: &str, signals: &[&str], words: &FindingWords) -> String {
    let mut out = String::new();
    for line in super::heading(plan, rules, signals, "--rust") {
        line_of(&mut out, format_args!("// {line}"));
    }
    let sizes = plan.sizes();
    line_of(
        &mut out,
        format_args!(
            "
/// The memory of a monitor for this number of motors.
#[allow(dead_code)]
pub type Storage<const MOTORS: usize> =
    ::flagred::board::Storage<{}, {}, {}, {}, MOTORS>;

/// The texts of findings with a cause, by the proposition of the cause.
#[allow(dead_code)]
#[rustfmt::skip]
pub static CAUSES: [::flagred::board::Words<'static>; {}] = [
    {},
];

/// The texts of findings without a cause, by their measure.
#[allow(dead_code)]
#[rustfmt::skip]
pub static NOTICES: [::flagred::board::Words<'static>; {}] = [
    {},
];

/// The profile.
#[rustfmt::skip]
pub static PLAN: ::flagred::board::Plan<'static> = {{
    #[allow(dead_code, non_upper_case_globals)]
    const inf: f64 = f64::INFINITY;
    #[allow(dead_code, non_upper_case_globals)]
    const NaN: f64 = f64::NAN;
    #[allow(unused_imports)]
    use ::flagred::{{
        accumulator::AccumulatorSettings,
        board::{{Plan, Proposition, Rules, table::{{*, Hedge::*}}}},
        channel,
        follower::Settings,
        gap::FilledKnots,
        sample::Sampling,
        verdict::{{LevelSettings, Limit, NoticeSettings, Threshold, VerdictSettings}},
    }};
    Plan {{
        name: {:?},",
            sizes.numbers,
            sizes.partials,
            sizes.outputs,
            sizes.channels,
            words.causes.len(),
            rows(&words.causes),
            words.notices.len(),
            rows(&words.notices),
            plan.name,
        ),
    );
    let out = &mut out;
    line_of(out, format_args!("        rules: Rules {{"));
    fields(out, 3, &plan.rules);
    line_of(out, format_args!("        }},"));
    line_of(out, format_args!("        output: {},", plan.output));
    items(out, 2, "order", &debug(plan.order));
    let channels: Vec<String> = plan.channels.iter().map(channel).collect();
    items(out, 2, "channels", &channels);
    let inputs: Vec<String> = plan.inputs.iter().map(input).collect();
    items(out, 2, "inputs", &inputs);
    line_of(out, format_args!("        signals: {},", plan.signals));
    line_of(out, format_args!("        settings: {:?},", plan.settings));
    line_of(
        out,
        format_args!("        coverage_below: {:?},", plan.coverage_below),
    );
    match plan.filled {
        None => line_of(out, format_args!("        filled: None,")),
        Some(filled) => {
            line_of(out, format_args!("        filled: Some(FilledKnots {{"));
            for array in super::filling(&filled) {
                items(out, 3, array.field, &array.items);
            }
            line_of(out, format_args!("        }}),"));
        }
    }
    items(out, 2, "propositions", &debug(plan.propositions));
    line_of(out, format_args!("    }}\n}};"));
    std::mem::take(out)
}

/// Returns texts as expressions.
fn rows(words: &[Words]) -> String {
    let rows = words.iter().map(|words| {
        let [code, brief, text, advice] = super::literals(words);
        format!(
            "::flagred::board::Words {{ code: {code}, brief: {brief}, text: {text}, advice: {advice} }}"
        )
    });
    rows.collect::<Vec<String>>().join(",\n    ")
}

/// Returns a rule set without a profile, as a function of its inputs.
pub(super) fn function(rules: &Rules<'_>, heading: &[String]) -> String {
    let mut text = String::new();
    let out = &mut text;
    for line in heading {
        line_of(out, format_args!("// {line}"));
    }
    let table = &rules.table;
    let (sizes, inputs, outputs) = (table.sizes, rules.inputs(), rules.outputs());
    let (kind, values, of_stages) = match rules.stages {
        [] => ("Table", "", String::new()),
        _ => (
            "Chain",
            "&mut values, ",
            format!(
                "
    let mut values = Values {{
        inputs: &mut [0.0; {}],
        own: &mut [Outcome::UNDEFINED; {outputs}],
    }};",
                rules.most_inputs()
            ),
        ),
    };
    line_of(
        out,
        format_args!(
            "
/// Returns the outcome of each output at the given values of the inputs.
#[allow(dead_code)]
#[rustfmt::skip]
pub fn evaluate(inputs: &[f64; {inputs}]) -> [::fuzzy::table::Outcome; {outputs}] {{
    #[allow(unused_imports)]
    use ::fuzzy::table::{{Outcome, PartialConjunction, Scratch, StrongestRule, Values}};
    let mut scratch = Scratch {{
        values: &mut [0.0; {}],
        degrees: &mut [0.0; {}],
        alive: &mut [PartialConjunction::NONE; {}],
        partial: &mut [PartialConjunction::NONE; {partial}],
        next: &mut [PartialConjunction::NONE; {partial}],
        stack: &mut [0.0; {}],
        strengths: &mut [0.0; {}],
        strongest: &mut [StrongestRule::NONE; {}],
    }};{of_stages}
    let mut outcomes = [Outcome::UNDEFINED; {outputs}];
    RULES.evaluate(&mut scratch, {values}inputs, &mut outcomes);
    outcomes
}}

/// The rule set.
#[rustfmt::skip]
pub static RULES: ::fuzzy::table::{kind}<'static> = {{
    #[allow(dead_code, non_upper_case_globals)]
    const inf: f64 = f64::INFINITY;
    #[allow(dead_code, non_upper_case_globals)]
    const NaN: f64 = f64::NAN;
    #[allow(unused_imports)]
    use ::fuzzy::table::{{*, Hedge::*}};",
            rules.most_inputs(),
            sizes.degrees,
            sizes.alive,
            sizes.stack,
            sizes.strengths,
            table.outputs.len(),
            partial = sizes.partial,
        ),
    );
    match rules.stages {
        [] => fields_of_table(out, 1, "Table {", table),
        _ => {
            line_of(out, format_args!("    Chain {{"));
            fields(out, 2, rules);
        }
    }
    line_of(out, format_args!("    }}\n}};"));
    text
}

/// Writes the fields of a rule set.
fn fields(out: &mut String, depth: usize, rules: &Rules<'_>) {
    let indent = "    ".repeat(depth);
    fields_of_table(out, depth, "table: Table {", &rules.table);
    line_of(out, format_args!("{indent}}},"));
    items(out, depth, "stages", &debug(rules.stages));
    items(out, depth, "indices", &debug(rules.indices));
}

/// Writes the fields of a table, which starts with the line `head`.
fn fields_of_table(out: &mut String, depth: usize, head: &str, table: &Table<'_>) {
    let indent = "    ".repeat(depth);
    line_of(
        out,
        format_args!(
            "{indent}{head}
{indent}    and: Conjunction::{:?},
{indent}    or: Disjunction::{:?},
{indent}    conjunctions: Conjunctions::{:?},
{indent}    least_strength: {:?},
{indent}    sizes: {:?},",
            table.and, table.or, table.conjunctions, table.least_strength, table.sizes,
        ),
    );
    for array in super::arrays(table) {
        items(out, depth + 1, array.field, &array.items);
    }
}

/// Returns the debug form of each item.
fn debug<T: Debug>(items: &[T]) -> Vec<String> {
    items.iter().map(|item| format!("{item:?}")).collect()
}

fn channel(channel: &Channel) -> String {
    let Channel {
        observed,
        motors,
        threshold,
        in_bins,
        window_s,
        exponential,
    } = channel;
    let threshold = match threshold {
        None => "None".to_owned(),
        Some(Threshold::Below(limit)) => format!("Some(channel::Threshold::Below({limit:?}))"),
        Some(Threshold::Above(limit)) => format!("Some(channel::Threshold::Above({limit:?}))"),
    };
    format!(
        "channel::Channel {{ observed: channel::Observed::{observed:?}, motors: channel::Motors::{motors:?}, \
         threshold: {threshold}, in_bins: {in_bins}, window_s: {window_s:?}, \
         exponential: {exponential} }}"
    )
}

fn input(input: &Input) -> String {
    let Input {
        channel,
        statistic,
        ratio,
        if_missing,
    } = input;
    let statistic: &Statistic = statistic;
    let ratio = match ratio {
        Some(ratio) => format!("Some(channel::{ratio:?})"),
        None => "None".to_owned(),
    };
    format!(
        "channel::Input {{ channel: {channel}, statistic: channel::Statistic::{statistic:?}, ratio: {ratio}, if_missing: {if_missing:?} }}"
    )
}

/// Writes an array, on one line if it fits.
fn items(out: &mut String, depth: usize, name: &str, items: &[String]) {
    let indent = "    ".repeat(depth);
    let together = items.join(", ");
    if together.len() <= 100 {
        line_of(out, format_args!("{indent}{name}: &[{together}],"));
        return;
    }
    line_of(out, format_args!("{indent}{name}: &["));
    for row in super::rows(items) {
        line_of(out, format_args!("{indent}    {row}"));
    }
    line_of(out, format_args!("{indent}],"));
}

fn line_of(out: &mut String, line: std::fmt::Arguments<'_>) {
    // Writing into a string cannot fail.
    let _ = writeln!(out, "{line}");
}
