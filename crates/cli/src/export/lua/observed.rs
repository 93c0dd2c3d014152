//! Generates the code for the values of a sample. The script computes each value that it needs once, and adds values to
//! the windows.

use std::fmt::Write;

use flagred::{
    board::Plan,
    channel::{Channel, Motors, Observed, Statistic, Threshold},
};

use super::{frames, number, template::TemplateValues};

/// Rounding error of commands in 32 bits.
const ROUNDING: f64 = 1e-6;

/// The smallest divisor of a ratio. Ratios with smaller divisors may be infinite in 32 bits and are reported as unknown.
const MIN_DIVISOR: f64 = 1e-6;

const AXES: [&str; 4] = ["roll", "pitch", "yaw", "thrust"];

/// The lines of the script written so far.
#[derive(Default)]
pub(super) struct Script {
    /// The values of a sample, each computed once: name and expression.
    values: Vec<(String, String)>,
    pub(super) observe: Vec<String>,
    pub(super) read: Vec<String>,
    /// The functions over lists of motors that the script uses.
    functions: Vec<&'static str>,
    lists: Vec<&'static str>,
    /// The indices of the efforts that the script uses.
    efforts: Vec<usize>,
    noise: bool,
}

impl Script {
    /// Returns the code for the value of a channel in a sample. For a standard deviation pooled over the motors, also
    /// returns the code for the variance between the motors within the sample.
    pub(super) fn value(
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
            Observed::Ratio {
                a,
                b,
                unknown_below,
            } => {
                let [a, b] = [a, b].map(|signal| self.signal(signal, signals));
                let least = number(unknown_below.max(MIN_DIVISOR));
                let name = format!("{a}_by_{b}_{}", least.replace(['.', '-', '+'], "_"));
                let ratio =
                    format!("{a} and {b} and max({b}, -{b}) >= {least} and {a} / {b} or nil");
                Some(self.computed(name, ratio))
            }
            Observed::Product { a, b } => {
                let [a, b] = [a, b].map(|signal| self.signal(signal, signals));
                let product = format!("{a} and {b} and {a} * {b}");
                Some(self.computed(format!("{a}_times_{b}"), product))
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
        // The motor with the highest command has the smallest distance to the upper limit, so no list is needed.
        if (channel.observed, channel.motors) == (Observed::HighSide, Motors::Min) {
            self.uses("highest_of");
            let room = "sum and 1 - highest_of(command) or nil".to_owned();
            let value = self.computed("least_room".into(), room);
            return (counted(&value, channel.threshold, squared), None);
        }
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
            // Outputs are whole microseconds, so values are rounded. A value that is equal to the limit except for
            // rounding does not count as above or below it.
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

    /// Returns the variable of an autopilot signal; nil if unknown.
    fn signal(&mut self, signal: usize, signals: &[&'static str]) -> String {
        let read = signals.get(signal).copied().unwrap_or("nil");
        self.computed(format!("signal_{}", signal + 1), read.to_owned())
    }

    /// Returns a value computed over all motors; nil if the commands are unknown.
    fn of_list(&mut self, function: &'static str, list: &str, limit: Option<f64>) -> String {
        // The sum of the commands is already known.
        if (function, list) == ("mean_of", "command") {
            return self.computed("mean_command".into(), "sum and sum / motors or nil".into());
        }
        self.uses(function);
        let (mut name, mut given) = (format!("{function}_{list}"), list.to_owned());
        if let Some(limit) = limit {
            let limit = number(limit);
            let _ = write!(name, "_{}", limit.replace(['.', '-', '+'], "_"));
            let _ = write!(given, ", {limit}");
        }
        if (function, list) == ("deviation_of", "command") {
            given.push_str(", sum");
        }
        self.computed(name, format!("sum and {function}({given}) or nil"))
    }

    fn uses(&mut self, function: &'static str) {
        if !self.functions.contains(&function) {
            self.functions.push(function);
        }
    }

    fn computed(&mut self, name: String, expression: String) -> String {
        if !self.values.iter().any(|(known, _)| *known == name) {
            self.values.push((name.clone(), expression));
        }
        name
    }

    /// The number of local variables of the function that processes a sample: three fixed ones and one for each value.
    pub(super) fn locals(&self) -> usize {
        3 + self.values.len()
    }

    pub(super) fn finish(mut self, plan: &Plan<'_>, filling: &mut TemplateValues) {
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
            each(&|axis| format!("  local {axis}, {axis}_share = 0.0, {axis}_share")),
        );
        filling.put(
            "add_efforts",
            each(&|axis| format!("      {axis} = {axis} + {axis}_share[i] * e")),
        );
        filling.put(
            "set_efforts",
            each(&|axis| format!("  {axis}_effort = has_geometry and {axis} or nil")),
        );
        filling.put(
            "forget_efforts",
            each(&|axis| format!("      {axis}_effort = nil")),
        );
        if geometry {
            filling.put("frames", frames::lines());
        }
        for function in self.functions {
            filling.set(function, true);
        }
        let values = self
            .values
            .iter()
            .map(|(name, expression)| format!("  local {name} = {expression}"));
        filling.put("observe", values.chain(self.observe).collect());
        filling.put("read_inputs", self.read);
    }
}

/// Returns the expression that a window sums: the value, its square or, for a share, whether the value is beyond the
/// threshold (1 or 0).
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
