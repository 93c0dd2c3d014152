//! The inputs of a rule set: the windows that the script keeps, and the code that computes the inputs from them.

use flagred::{
    board::Plan,
    channel::{Channel, Observed, Ratio, Statistic},
    estimator::Estimator,
};

use super::{
    UnsupportedFeature, comment, limits::Size, number, observed::Script, template::TemplateValues,
};

/// The signals that a script can read, by their names in logs.
const SIGNALS: [(&str, &str); 4] = [
    ("battery_v", "battery:voltage(0)"),
    ("battery_a", "battery:current_amps(0)"),
    ("battery_used_mah", "battery:consumed_mah(0)"),
    ("battery_remaining_pct", "battery:capacity_remaining_pct(0)"),
];

/// Seconds between two calls of the script.
const CALL_S: f64 = 0.03;
/// The length of a bin of commands, in seconds.
const BIN_S: f64 = 0.1;

/// The source of a window's values. Values from the same source become known at the same times, so their statistics
/// share the weights of a window.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Source {
    Motors,
    Effort,
    Noise,
    Signal(usize),
    Both(usize, usize),
    Ratio(usize, usize, f64),
}

/// A window of the script. Channels whose values are known at the same times share it.
struct Window {
    window_s: f64,
    in_bins: bool,
    source: Source,
    /// The indices in the profile of the inputs that read this window.
    inputs: Vec<usize>,
}

/// Sets the parts of the template for the inputs.
pub(super) fn fill(
    estimator: &Estimator,
    plan: &Plan<'_>,
    filling: &mut TemplateValues,
    size: &mut Size,
) -> Result<(), UnsupportedFeature> {
    let names = estimator.profile().inputs.iter();
    let names: Vec<String> = names.map(|input| comment(&input.name)).collect();
    let signals = signals(&estimator.profile().signals())?;
    filling.set("battery", !signals.is_empty());
    filling.set("needs_motors", plan.needs_motors());
    let mut windows: Vec<Window> = Vec::new();
    let mut script = Script::default();
    for (
        input,
        flagred::channel::Input {
            channel, statistic, ..
        },
    ) in plan.inputs.iter().enumerate()
    {
        let Some(channel) = plan.channels.get(*channel) else {
            continue;
        };
        carried(channel, *statistic)?;
        let (x, within) = script.value(channel, *statistic, &signals);
        let index = input + 1;
        let name = names.get(input).map_or("", String::as_str);
        if *statistic == Statistic::Last {
            script
                .observe
                .push(format!("  value[{index}] = {x} -- {name}"));
            continue;
        }
        let window = Window::of(channel);
        match windows.iter_mut().find(|known| known.is_alike(&window)) {
            Some(known) => known.inputs.push(input),
            None => windows.push(Window {
                inputs: vec![input],
                ..window
            }),
        }
        script
            .observe
            .push(format!("  inputs[{index}].x = {x} -- {name}"));
        if let Some(within) = within {
            script
                .observe
                .push(format!("  inputs[{index}].within = {within}"));
        }
    }
    let mut made = Vec::new();
    for (window, i) in windows.iter().zip(1..) {
        let Window {
            window_s, in_bins, ..
        } = window;
        size.windows += 1;
        size.numbers += 2 * window.capacity() as usize;
        made.push(format!(
            "new_window({}, {})",
            number(*window_s),
            window.capacity()
        ));
        script.observe.push(match (in_bins, window.source) {
            (true, _) => format!("  take_bin(windows[{i}])"),
            // Noise is computed once per bin, and applies to the whole bin.
            (_, Source::Noise) => {
                format!("  take_sample(windows[{i}], max(held_s, 0.1))")
            }
            _ => format!("  take_sample(windows[{i}], held_s)"),
        });
        script.read.push(format!("  window = windows[{i}]"));
        script.read.push("  total, out = enough(window)".into());
        for input in &window.inputs {
            let statistic = plan.inputs.get(*input).map(|input| input.statistic);
            let (kind, read) = row(statistic.unwrap_or(Statistic::Mean), input + 1);
            let name = names.get(*input).map_or("", String::as_str);
            size.rows += 1;
            size.numbers += window.capacity() as usize * (1 + usize::from(kind == "spread"));
            made.push(format!(
                "inputs[{0}] = new_row(windows[{i}], \"{kind}\") -- {name}",
                input + 1
            ));
            script.read.push(format!(
                "  value[{}] = total and {read} -- {name}",
                input + 1
            ));
        }
    }
    let extremes = made.iter().any(|line| line.contains("est\")"));
    filling.set("extremes", extremes);
    filling.constant("NONE", if extremes { "list.none" } else { "0.0" }.into());
    // The elevated risk needs a window, too.
    size.windows += 1;
    size.rows += 1;
    size.numbers += 4 * elevated_capacity(plan) as usize;
    size.locals = script.locals();
    let mut noted = Vec::new();
    for (input, of) in (1..).zip(plan.inputs) {
        let (Some(value), Some(channel)) = (of.if_missing, plan.channels.get(of.channel)) else {
            continue;
        };
        let known = channel
            .observed
            .signals()
            .filter_map(|signal| signals.get(signal));
        let known: Vec<String> = known.map(|read| format!("{read} ~= nil")).collect();
        let (has_come, known) = (format!("has_come[{input}]"), known.join(" and "));
        noted.push(format!("  {has_come} = {has_come} or {known}"));
        let value = number(value);
        script.read.push(format!(
            "  if not {has_come} then value[{input}] = {value} end"
        ));
    }
    filling.set("if_missing", !noted.is_empty());
    filling.put("note_signals", noted);
    for (input, of) in plan.inputs.iter().enumerate() {
        let value = format!("value[{}]", input + 1);
        if let Some(ratio) = of.ratio {
            let made = quotient(&value, &ratio);
            script.read.push(match of.if_missing {
                // An assumed value is a value of the ratio itself, so it is not divided.
                Some(_) => format!("  if has_come[{}] then\n  {made}\n  end", input + 1),
                None => made,
            });
        }
        if plan.needs(input) {
            script.read.push(format!("  all = all and {value}"));
        }
    }
    script.finish(plan, filling);
    filling.put("inputs", made);
    Ok(())
}

/// Returns the code that divides a value by the denominator of its ratio.
fn quotient(value: &str, ratio: &Ratio) -> String {
    let (per, least) = (format!("value[{}]", ratio.per + 1), number(ratio.at_least));
    format!("  {value} = {value} and {per} and {value} / max({per}, {least})")
}

/// The kind of a row, and the expression that reads its value.
fn row(statistic: Statistic, input: usize) -> (&'static str, String) {
    let read = format!("read_row(window, inputs[{input}], total, out)");
    match statistic {
        Statistic::Std | Statistic::StdLessNoise => (
            "spread",
            format!("deviation(window, inputs[{input}], total, out)"),
        ),
        Statistic::Rms => ("mean", format!("sqrt({read})")),
        Statistic::Noise => ("mean", format!("sqrt({read} / 2)")),
        Statistic::Min => ("lowest", read),
        Statistic::Max => ("highest", read),
        Statistic::Mean
        | Statistic::Last
        | Statistic::ShareBelow(_)
        | Statistic::ShareAbove(_)
        | Statistic::Rate
        | Statistic::Percentile(_) => ("mean", read),
    }
}

/// Refuses statistics that the script does not support, or that take too long because they would visit all slots of a
/// window in every call.
fn carried(channel: &Channel, statistic: Statistic) -> Result<(), UnsupportedFeature> {
    let what = match statistic {
        Statistic::Rate => "the statistic `rate`",
        Statistic::Percentile(_) => "the statistics `median` and `percentile`",
        _ if channel.exponential => "windows with a `time_constant_s`",
        _ => return Ok(()),
    };
    Err(UnsupportedFeature::new(
        format!("a script on the autopilot cannot compute {what}"),
        "`export --rust` and `export --c` support them",
    ))
}

/// Returns the expression that reads each signal of a profile.
fn signals(names: &[&str]) -> Result<Vec<&'static str>, UnsupportedFeature> {
    let read = |name: &&str| {
        let known = SIGNALS.iter().find(|(known, _)| known == name);
        known.map(|(_, read)| *read).ok_or_else(|| {
            UnsupportedFeature::new(
                format!("a script on the autopilot cannot read the signal `{name}`"),
                "it can read battery_v, battery_a, battery_used_mah and battery_remaining_pct, and all signals of the motors",
            )
        })
    };
    names.iter().map(read).collect()
}

impl Window {
    fn of(channel: &Channel) -> Window {
        Window {
            window_s: channel.window_s,
            in_bins: channel.in_bins,
            source: match channel.observed {
                Observed::Effort(_) => Source::Effort,
                Observed::CommandNoise => Source::Noise,
                Observed::Named(signal) => Source::Signal(signal),
                Observed::Difference { a, b, .. } | Observed::Product { a, b } => {
                    Source::Both(a, b)
                }
                Observed::Ratio {
                    a,
                    b,
                    unknown_below,
                } => Source::Ratio(a, b, unknown_below),
                Observed::Command
                | Observed::CommandLessYaw
                | Observed::Margin
                | Observed::LowSide
                | Observed::HighSide => Source::Motors,
            },
            inputs: Vec::new(),
        }
    }

    fn is_alike(&self, other: &Window) -> bool {
        (self.window_s, self.in_bins, self.source) == (other.window_s, other.in_bins, other.source)
    }

    fn capacity(&self) -> u32 {
        let step_s = match self.in_bins || self.source == Source::Noise {
            true => BIN_S,
            false => CALL_S,
        };
        capacity(self.window_s, step_s)
    }
}

/// The number of slots of a window in the script: one for each call or bin and a few spare ones, but at most 130, as
/// in the monitor.
fn capacity(window_s: f64, step_s: f64) -> u32 {
    const MAX_SLOTS: f64 = 130.0;
    ((window_s / step_s).floor() + 4.0).min(MAX_SLOTS) as u32
}

/// The number of slots in the window of the elevated risk.
pub(super) fn elevated_capacity(plan: &Plan<'_>) -> u32 {
    capacity(plan.settings.elevated_risk.window_s, CALL_S)
}
