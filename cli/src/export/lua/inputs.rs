//! The inputs of a rule set: which windows the script keeps, what goes into them, and how their values are read.

use std::fmt::Write;

use flagred::{
    board::Plan,
    channel::{Channel, Motors, Observed, Statistic, Threshold},
    estimator::Estimator,
};

use super::{Refused, comment, frames, number, template::Filling};

/// The signals that a script can read, by the names of logs.
const SIGNALS: [(&str, &str); 4] = [
    ("battery_v", "battery:voltage(0)"),
    ("battery_a", "battery:current_amps(0)"),
    ("battery_used_mah", "battery:consumed_mah(0)"),
    ("battery_remaining_pct", "battery:capacity_remaining_pct(0)"),
];

/// Of commands, in 32 bits.
const ROUNDING: f64 = 1e-6;

const AXES: [&str; 4] = ["roll", "pitch", "yaw", "thrust"];

/// What brings its values at the same times, so that a window of it has one weight.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Source {
    Motors,
    Effort,
    Noise,
    Signal(usize),
    Difference(usize, usize),
}

/// A window of the script: channels that bring values at the same times share it.
struct Window {
    window_s: f64,
    in_bins: bool,
    source: Source,
    /// The inputs, by their index in the profile.
    inputs: Vec<usize>,
}

/// Writes the inputs into the places of the script.
pub(super) fn fill(
    estimator: &Estimator,
    plan: &Plan<'_>,
    filling: &mut Filling,
) -> Result<(), Refused> {
    let names = estimator.profile().inputs.iter();
    let names: Vec<String> = names.map(|input| comment(&input.name)).collect();
    let signals = signals(&estimator.profile().signals())?;
    let mut windows: Vec<Window> = Vec::new();
    let mut script = Script::default();
    for (input, flagred::channel::Input { channel, statistic }) in plan.inputs.iter().enumerate() {
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
            script
                .read_last
                .push(format!("  all = all and value[{index}]"));
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
        made.push(format!(
            "new_window({}, {}, {in_bins})",
            number(*window_s),
            window.capacity()
        ));
        script.observe.push(match (in_bins, window.source) {
            (true, _) => format!("  take_bin(windows[{i}])"),
            // A noise is known once in a bin, and stands for all of it.
            (_, Source::Noise) => {
                format!("  take_sample(windows[{i}], max(held_s, BIN_US * 1e-6))")
            }
            _ => format!("  take_sample(windows[{i}], held_s)"),
        });
        script
            .read
            .push(format!("  total, out = enough(windows[{i}])"));
        for input in &window.inputs {
            let statistic = plan.inputs.get(*input).map(|input| input.statistic);
            let (kind, read) = row(statistic.unwrap_or(Statistic::Mean), input + 1);
            let name = names.get(*input).map_or("", String::as_str);
            made.push(format!(
                "inputs[{0}] = new_row(windows[{i}], \"{kind}\") -- {name}",
                input + 1
            ));
            script.read.push(format!(
                "  value[{}] = total and {read} -- {name}",
                input + 1
            ));
            script
                .read
                .push(format!("  all = all and value[{}]", input + 1));
        }
    }
    script.read.append(&mut script.read_last);
    script.finish(plan, filling);
    filling.put("inputs", made);
    Ok(())
}

/// The kind of a row, and how its value is read.
fn row(statistic: Statistic, input: usize) -> (&'static str, String) {
    let read = format!("read_row(inputs[{input}], total, out)");
    match statistic {
        Statistic::Std | Statistic::StdLessNoise => {
            ("spread", format!("deviation(inputs[{input}], total, out)"))
        }
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

/// Refuses what a script has no time for, to go through all slots of a window at every call, and what it does not have.
fn carried(channel: &Channel, statistic: Statistic) -> Result<(), Refused> {
    let what = match statistic {
        Statistic::Rate => "the statistic `rate`",
        Statistic::Percentile(_) => "the statistics `median` and `percentile`",
        _ if channel.exponential => "windows with a `time_constant_s`",
        _ => return Ok(()),
    };
    Err(Refused::new(
        format!("a script on the autopilot cannot compute {what}"),
        "`export --rust` and `export --c` carry them",
    ))
}

/// How the script reads each signal of a profile.
fn signals(names: &[&str]) -> Result<Vec<&'static str>, Refused> {
    let read = |name: &&str| {
        let known = SIGNALS.iter().find(|(known, _)| known == name);
        known.map(|(_, read)| *read).ok_or_else(|| {
            Refused::new(
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
                Observed::Difference { a, b, .. } => Source::Difference(a, b),
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

    /// The most slots in use at once: one for each call or bin, and at most as many as the monitor has.
    fn capacity(&self) -> u32 {
        const MOST: f64 = 130.0;
        const CALL_S: f64 = 0.03;
        const BIN_S: f64 = 0.1;
        let step_s = match self.in_bins || self.source == Source::Noise {
            true => BIN_S,
            false => CALL_S,
        };
        ((self.window_s / step_s).floor() + 4.0).min(MOST) as u32
    }
}

/// The lines of the script so far.
#[derive(Default)]
struct Script {
    /// The values of a sample, each computed once: name and expression.
    values: Vec<(String, String)>,
    observe: Vec<String>,
    read: Vec<String>,
    read_last: Vec<String>,
    /// The functions over lists of motors that are used.
    functions: Vec<&'static str>,
    lists: Vec<&'static str>,
    /// The efforts that are used, by their index.
    efforts: Vec<usize>,
    noise: bool,
}

impl Script {
    /// The value of a sample for a channel, and where one sample has a spread in itself, that spread.
    fn value(
        &mut self,
        channel: &Channel,
        statistic: Statistic,
        signals: &[&'static str],
    ) -> (String, Option<String>) {
        let one = match channel.observed {
            Observed::Named(signal) => Some(self.signal(signal, signals)),
            Observed::Difference { a, b, circular } => {
                let [a, b] = [a, b].map(|signal| self.signal(signal, signals));
                let less = match circular {
                    true => format!("({a} - {b} + 180) % 360 - 180"),
                    false => format!("{a} - {b}"),
                };
                Some(self.computed(format!("{a}_less_{b}"), format!("{a} and {b} and {less}")))
            }
            Observed::Effort(axis) => {
                if !self.efforts.contains(&axis) {
                    self.efforts.push(axis);
                }
                let axis = AXES.get(axis).copied().unwrap_or_default();
                Some(format!("{axis}_effort"))
            }
            Observed::CommandNoise => {
                self.noise = true;
                Some("command_noise".into())
            }
            Observed::Command
            | Observed::CommandLessYaw
            | Observed::Margin
            | Observed::LowSide
            | Observed::HighSide => None,
        };
        let squared = statistic == Statistic::Rms;
        if let Some(one) = one {
            return (counted(&one, channel.threshold, squared), None);
        }
        let list = match channel.observed {
            Observed::CommandLessYaw => "less_yaw",
            Observed::Margin => "margin",
            Observed::HighSide => "high_side",
            _ => "command",
        };
        if !self.lists.contains(&list) {
            self.lists.push(list);
        }
        if let Motors::One(motor) = channel.motors {
            let motor = u64::from(motor) + 1;
            let name = format!("{list}_of_motor_{motor}");
            let value = self.computed(name, format!("sum and {list}[{motor}]"));
            return (counted(&value, channel.threshold, squared), None);
        }
        if channel.motors != Motors::Pooled {
            let function = match channel.motors {
                Motors::Std => "deviation_of",
                Motors::Min => "lowest_of",
                Motors::Max => "highest_of",
                Motors::Mean | Motors::Pooled | Motors::One(_) => "mean_of",
            };
            let value = self.of_list(function, list, None);
            return (counted(&value, channel.threshold, squared), None);
        }
        match (channel.threshold, statistic) {
            // Outputs are whole microseconds: a value on the limit is on neither side, whatever its rounding.
            (Some(Threshold::Below(limit)), _) => (
                self.of_list("share_of_below", list, Some(limit - ROUNDING)),
                None,
            ),
            (Some(Threshold::Above(limit)), _) => (
                self.of_list("share_of_above", list, Some(limit + ROUNDING)),
                None,
            ),
            (None, Statistic::Min) => (self.of_list("lowest_of", list, None), None),
            (None, Statistic::Max) => (self.of_list("highest_of", list, None), None),
            (None, Statistic::Rms) => (self.of_list("mean_square_of", list, None), None),
            (None, Statistic::Std) => {
                let deviation = self.of_list("deviation_of", list, None);
                let within = format!("sum and {deviation} * {deviation} or 0.0");
                (self.of_list("mean_of", list, None), Some(within))
            }
            _ => (self.of_list("mean_of", list, None), None),
        }
    }

    /// A signal of the autopilot; nil where it is unknown.
    fn signal(&mut self, signal: usize, signals: &[&'static str]) -> String {
        let read = signals.get(signal).copied().unwrap_or("nil");
        self.computed(format!("signal_{}", signal + 1), read.to_owned())
    }

    /// A value that all motors have together; nil where the commands are unknown.
    fn of_list(&mut self, function: &'static str, list: &str, limit: Option<f64>) -> String {
        if !self.functions.contains(&function) {
            self.functions.push(function);
        }
        let (mut name, mut given) = (format!("{function}_{list}"), list.to_owned());
        if let Some(limit) = limit {
            let limit = number(limit);
            let _ = write!(name, "_{}", limit.replace(['.', '-', '+'], "_"));
            let _ = write!(given, ", {limit}");
        }
        self.computed(name, format!("sum and {function}({given}) or nil"))
    }

    fn computed(&mut self, name: String, expression: String) -> String {
        if !self.values.iter().any(|(known, _)| *known == name) {
            self.values.push((name.clone(), expression));
        }
        name
    }

    fn finish(mut self, plan: &Plan<'_>, filling: &mut Filling) {
        let uses_yaw =
            self.lists.contains(&"less_yaw") || plan.settings.verdict.notices.imbalance.is_some();
        if uses_yaw && !self.efforts.contains(&2) {
            self.efforts.push(2);
        }
        let geometry = !self.efforts.is_empty();
        filling.set("geometry", geometry);
        filling.set("less_yaw", uses_yaw);
        filling.set("margin", self.lists.contains(&"margin"));
        filling.set("high_side", self.lists.contains(&"high_side"));
        filling.set("noise", self.noise);
        let axes: Vec<&str> = self
            .efforts
            .iter()
            .filter_map(|axis| AXES.get(*axis).copied())
            .collect();
        let each = |lines: &dyn Fn(&str) -> String| {
            axes.iter().map(|axis| lines(axis)).collect::<Vec<String>>()
        };
        filling.put(
            "efforts",
            each(&|axis| {
                format!("local {axis}_share, {axis}_effort -- of each motor, and of all together")
            }),
        );
        let of_axis =
            |(i, name): (&usize, &&str)| format!("  {name}_share = shares_of(factors, {})", i + 1);
        filling.put(
            "read_efforts",
            self.efforts.iter().zip(&axes).map(of_axis).collect(),
        );
        let missing: Vec<String> = axes.iter().map(|axis| format!("{axis}_share")).collect();
        filling.put(
            "all_efforts",
            vec![format!(
                "  has_geometry = {} and true or false",
                missing.join(" and ")
            )],
        );
        filling.put(
            "clear_efforts",
            each(&|axis| format!("  {axis}_effort = has_geometry and 0.0 or nil")),
        );
        filling.put(
            "add_efforts",
            each(&|axis| format!("      {axis}_effort = {axis}_effort + {axis}_share[i] * e")),
        );
        filling.put(
            "forget_efforts",
            each(&|axis| format!("      {axis}_effort = nil")),
        );
        if geometry {
            filling.put("frames", frames::lines());
        }
        self.functions.sort_unstable();
        let functions = self.functions.iter().flat_map(|name| function(name));
        filling.put("list_functions", functions.map(str::to_owned).collect());
        let values = self
            .values
            .iter()
            .map(|(name, expression)| format!("  local {name} = {expression}"));
        filling.put("observe", values.chain(self.observe).collect());
        filling.put("read_inputs", self.read);
    }
}

/// The value itself, its square, or for a share whether it is beyond the threshold.
fn counted(value: &str, threshold: Option<Threshold>, squared: bool) -> String {
    let beyond = |sign: &str, limit: f64| {
        format!(
            "{value} and ({value} {sign} {} and 1.0 or 0.0)",
            number(limit)
        )
    };
    match threshold {
        Some(Threshold::Below(limit)) => beyond("<", limit),
        Some(Threshold::Above(limit)) => beyond(">", limit),
        None if squared => format!("{value} and {value} * {value}"),
        None => value.to_owned(),
    }
}

/// A function over a list with a value for each motor.
fn function(name: &str) -> Vec<&'static str> {
    let text = match name {
        "mean_of" => {
            "
local function mean_of(list)
  local total = 0.0
  for i = 1, motors do
    total = total + list[i]
  end
  return total / motors
end"
        }
        "deviation_of" => {
            "
local function deviation_of(list)
  local mean, square = 0.0, 0.0
  for i = 1, motors do
    mean = mean + list[i]
  end
  mean = mean / motors
  for i = 1, motors do
    local d = list[i] - mean
    square = square + d * d
  end
  return sqrt(square / motors)
end"
        }
        "mean_square_of" => {
            "
local function mean_square_of(list)
  local total = 0.0
  for i = 1, motors do
    total = total + list[i] * list[i]
  end
  return total / motors
end"
        }
        "lowest_of" => {
            "\nlocal function lowest_of(list)\n  return min(table.unpack(list, 1, motors))\nend"
        }
        "highest_of" => {
            "\nlocal function highest_of(list)\n  return max(table.unpack(list, 1, motors))\nend"
        }
        "share_of_below" => {
            "
local function share_of_below(list, limit)
  local count = 0
  for i = 1, motors do
    if list[i] < limit then
      count = count + 1
    end
  end
  return count / motors
end"
        }
        "share_of_above" => {
            "
local function share_of_above(list, limit)
  local count = 0
  for i = 1, motors do
    if list[i] > limit then
      count = count + 1
    end
  end
  return count / motors
end"
        }
        _ => "",
    };
    text.lines().collect()
}
