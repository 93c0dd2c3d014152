//! A plan as Rust.
//!
//! The debug form of plain data is its Rust expression, but for enumerations, whose names are added here, and for numbers
//! that are not finite, for which the file names `inf` and `NaN`. Numbers are written so that they read back bit for bit.

use std::fmt::{Debug, Write};

use flagred::{
    board::Plan,
    channel::{Channel, Input, Observed, Statistic, Threshold},
};

/// The file.
pub(super) fn text(plan: &Plan<'_>, rules: &str, signals: &[&str]) -> String {
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
        board::{{Plan, table::*}},
        channel,
        follower::Settings,
        gap::FilledKnots,
        sample::Sampling,
        verdict::{{Idle, LevelSettings, Threshold, VerdictSettings}},
    }};
    Plan {{
        name: {:?},
        table: Table {{
            and: Conjunction::{:?},
            or: Disjunction::{:?},
            conjunctions: Conjunctions::{:?},
            sizes: {:?},",
            sizes.numbers,
            sizes.partials,
            sizes.outputs,
            sizes.channels,
            plan.name,
            plan.table.and,
            plan.table.or,
            plan.table.conjunctions,
            plan.table.sizes,
        ),
    );
    let table = &plan.table;
    let hedges: Vec<String> = table
        .hedges
        .iter()
        .map(|hedge| format!("Hedge::{hedge:?}"))
        .collect();
    let out = &mut out;
    array(out, 3, "inputs", table.inputs);
    array(out, 3, "cuts", table.cuts);
    array(out, 3, "starts", table.starts);
    array(out, 3, "lines", table.lines);
    array(out, 3, "curves", table.curves);
    array(out, 3, "points", table.points);
    items(out, 3, "hedges", &hedges);
    array(out, 3, "axes", table.axes);
    array(out, 3, "dimensions", table.dimensions);
    array(out, 3, "cells", table.cells);
    array(out, 3, "nodes", table.nodes);
    array(out, 3, "edges", table.edges);
    array(out, 3, "actions", table.actions);
    array(out, 3, "programs", table.programs);
    array(out, 3, "steps", table.steps);
    array(out, 3, "outputs", table.outputs);
    array(out, 3, "pairs", table.pairs);
    array(out, 3, "moments", table.moments);
    array(out, 3, "consequences", table.consequences);
    array(out, 3, "coefficients", table.coefficients);
    line_of(
        out,
        format_args!("        }},\n        output: {},", plan.output),
    );
    array(out, 2, "order", plan.order);
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
            array(out, 3, "places", filled.places);
            array(out, 3, "starts", filled.starts);
            array(out, 3, "values", filled.values);
            array(out, 3, "distances", filled.distances);
            line_of(out, format_args!("        }}),"));
        }
    }
    line_of(out, format_args!("    }}\n}};"));
    std::mem::take(out)
}

fn channel(channel: &Channel) -> String {
    let Channel {
        observed,
        motors,
        threshold,
        window_s,
    } = channel;
    let observed = match observed {
        Observed::Named(signal) => format!("Named({signal})"),
        observed => format!("{observed:?}"),
    };
    let threshold = match threshold {
        None => "None".to_owned(),
        Some(Threshold::Below(limit)) => format!("Some(channel::Threshold::Below({limit:?}))"),
        Some(Threshold::Above(limit)) => format!("Some(channel::Threshold::Above({limit:?}))"),
    };
    format!(
        "channel::Channel {{ observed: channel::Observed::{observed}, motors: channel::Motors::{motors:?}, \
         threshold: {threshold}, window_s: {window_s:?} }}"
    )
}

fn input(input: &Input) -> String {
    let Input { channel, statistic } = input;
    let statistic: &Statistic = statistic;
    format!("channel::Input {{ channel: {channel}, statistic: channel::Statistic::{statistic:?} }}")
}

fn array<T: Debug>(out: &mut String, depth: usize, name: &str, values: &[T]) {
    let values: Vec<String> = values.iter().map(|value| format!("{value:?}")).collect();
    items(out, depth, name, &values);
}

/// An array, in as many lines as it takes.
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
