//! A plan as Rust.
//!
//! The debug form of plain data is a Rust expression, once the names of enumerations are added, and the constants `inf` and
//! `NaN` are defined. Numbers read back bit for bit.

use std::fmt::Write;

use flagred::{
    board::Plan,
    channel::{Channel, Input, Statistic, Threshold},
};

/// The file.
pub(super) fn text(plan: &Plan<'_>, rules: &str, signals: &[&str], causes: &[String]) -> String {
    let mut out = String::new();
    for line in super::heading(plan, rules, signals, "--rust") {
        line_of(&mut out, format_args!("// {line}"));
    }
    let sizes = plan.sizes();
    line_of(
        &mut out,
        format_args!(
            "
/// Memory for a monitor of so many motors.
#[allow(dead_code)]
pub type Storage<const MOTORS: usize> =
    ::flagred::board::Storage<{}, {}, {}, {}, MOTORS>;

/// What the cause of a finding is called.
#[allow(dead_code)]
#[rustfmt::skip]
pub static CAUSES: [&str; {}] = [
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
        board::{{Plan, Proposition, table::{{*, Hedge::*}}}},
        channel,
        follower::Settings,
        gap::FilledKnots,
        sample::Sampling,
        verdict::{{LevelSettings, Limit, NoticeSettings, Threshold, VerdictSettings}},
    }};
    Plan {{
        name: {:?},
        table: Table {{
            and: Conjunction::{:?},
            or: Disjunction::{:?},
            conjunctions: Conjunctions::{:?},
            least_strength: {:?},
            sizes: {:?},",
            sizes.numbers,
            sizes.partials,
            sizes.outputs,
            sizes.channels,
            causes.len(),
            causes.join(",\n    "),
            plan.name,
            plan.table.and,
            plan.table.or,
            plan.table.conjunctions,
            plan.table.least_strength,
            plan.table.sizes,
        ),
    );
    let out = &mut out;
    for array in super::arrays(&plan.table) {
        items(out, 3, array.field, &array.items);
    }
    line_of(
        out,
        format_args!("        }},\n        output: {},", plan.output),
    );
    let order: Vec<String> = plan.order.iter().map(u32::to_string).collect();
    items(out, 2, "order", &order);
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
    let propositions: Vec<String> = plan.propositions.iter().map(|p| format!("{p:?}")).collect();
    items(out, 2, "propositions", &propositions);
    line_of(out, format_args!("    }}\n}};"));
    std::mem::take(out)
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
    let Input { channel, statistic } = input;
    let statistic: &Statistic = statistic;
    format!("channel::Input {{ channel: {channel}, statistic: channel::Statistic::{statistic:?} }}")
}

/// An array, on one line where it fits.
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
