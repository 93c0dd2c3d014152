//! A plan as C. Numbers are written so that they read back bit for bit; the codes are those of `flagred-c`.

use std::fmt::Write;

use flagred::{
    board::{
        Plan,
        table::{Conjunctions, Hedge},
    },
    channel::{Channel, Input, Motors, Observed, Statistic, Threshold},
    follower::Settings,
    verdict::{self, LevelSettings},
};

/// The file.
pub(super) fn text(plan: &Plan<'_>, rules: &str, signals: &[&str]) -> String {
    let name = identifier(plan.name);
    let mut out = String::new();
    let heading = super::heading(plan, rules, signals, "--c").join("\n * ");
    let motor = plan.bytes(1) - plan.bytes(0);
    let guard = name.to_uppercase();
    line(&mut out, &format!("/* {heading} */"));
    line(
        &mut out,
        &format!("#ifndef FLAGRED_PLAN_{guard}_H\n#define FLAGRED_PLAN_{guard}_H\n"),
    );
    line(&mut out, "#include <math.h>\n#include \"flagred.h\"\n");
    line(
        &mut out,
        "/* Enough memory for a monitor of so many motors, on any processor. */",
    );
    line(
        &mut out,
        &format!(
            "#define FLAGRED_MEMORY(motors) ({} + {motor} * (motors))\n",
            plan.bytes(0)
        ),
    );
    let mut arrays = Arrays {
        out,
        prefix: format!("flagred_{name}"),
        fields: Vec::new(),
    };
    arrays.table(plan);
    arrays.profile(plan);
    let Arrays {
        mut out, fields, ..
    } = arrays;
    let (conjunctions, actions_a_cell, first_action, sums) = match plan.table.conjunctions {
        Conjunctions::Uniform {
            actions_a_cell,
            first_action,
            sums,
        } => (0, actions_a_cell, first_action, u32::from(sums)),
        Conjunctions::Dense => (1, 0, 0, 0),
        Conjunctions::Trie => (2, 0, 0, 0),
    };
    let sizes = plan.table.sizes;
    line(
        &mut out,
        &format!("static const flagred_plan flagred_plan_{name} = {{"),
    );
    for (field, value) in [
        ("format", "FLAGRED_PLAN_FORMAT".to_owned()),
        ("and_operator", (plan.table.and as u32).to_string()),
        ("or_operator", (plan.table.or as u32).to_string()),
        ("conjunctions", conjunctions.to_string()),
        ("actions_a_cell", actions_a_cell.to_string()),
        ("first_action", first_action.to_string()),
        ("sums", sums.to_string()),
        ("degrees", sizes.degrees.to_string()),
        ("alive", sizes.alive.to_string()),
        ("partial", sizes.partial.to_string()),
        ("stack", sizes.stack.to_string()),
        ("heights", sizes.heights.to_string()),
        ("output", plan.output.to_string()),
        ("signals", plan.signals.to_string()),
        ("coverage_below", number(plan.coverage_below)),
        ("settings", settings(&plan.settings)),
    ] {
        line(&mut out, &format!("    .{field} = {value},"));
    }
    for (field, array, count) in fields {
        line(
            &mut out,
            &format!("    .{field} = {array}, .{field}_count = {count},"),
        );
    }
    line(&mut out, "};\n\n#endif");
    out
}

/// Arrays that are written, and the fields that point to them.
struct Arrays {
    out: String,
    prefix: String,
    fields: Vec<(&'static str, String, usize)>,
}

impl Arrays {
    /// Writes an array; C has none that are empty.
    fn add(&mut self, kind: &str, field: &'static str, items: Vec<String>) {
        let array = format!("{}_{field}", self.prefix);
        let count = items.len();
        if items.is_empty() {
            self.fields.push((field, "NULL".to_owned(), 0));
            return;
        }
        line(
            &mut self.out,
            &format!("static const {kind} {array}[] = {{"),
        );
        for row in super::rows(&items) {
            line(&mut self.out, &format!("    {row}"));
        }
        line(&mut self.out, "};\n");
        self.fields.push((field, array, count));
    }

    fn numbers(&mut self, field: &'static str, values: impl IntoIterator<Item = f64>) {
        self.add("double", field, values.into_iter().map(number).collect());
    }

    fn counts(&mut self, field: &'static str, values: impl IntoIterator<Item = u32>) {
        let values = values.into_iter().map(|value| value.to_string());
        self.add("uint32_t", field, values.collect());
    }

    /// Structures of numbers followed by counts, as all of these are.
    fn records(
        &mut self,
        kind: &str,
        field: &'static str,
        records: impl IntoIterator<Item = (Vec<f64>, Vec<u32>)>,
    ) {
        let record = |(numbers, counts): (Vec<f64>, Vec<u32>)| {
            let numbers = numbers.into_iter().map(number);
            let counts = counts.into_iter().map(|count| count.to_string());
            let all: Vec<String> = numbers.chain(counts).collect();
            format!("{{{}}}", all.join(", "))
        };
        self.add(kind, field, records.into_iter().map(record).collect());
    }

    fn table(&mut self, plan: &Plan<'_>) {
        let table = &plan.table;
        self.records(
            "flagred_input",
            "inputs",
            table.inputs.iter().map(|i| {
                let counts = [
                    i.first_literal,
                    i.first_cut,
                    i.end_cut,
                    i.first_start,
                    i.first_curve,
                    i.end_curve,
                ];
                (vec![i.low, i.high], counts.to_vec())
            }),
        );
        self.numbers("cuts", table.cuts.iter().copied());
        self.counts("starts", table.starts.iter().copied());
        self.records(
            "flagred_line",
            "lines",
            table
                .lines
                .iter()
                .map(|l| (vec![l.foot, l.run, l.base, l.rise], vec![l.literal])),
        );
        let curves = table.curves.iter().map(|c| {
            let parameters = c.parameters.map(number).join(", ");
            format!(
                "{{{{{parameters}}}, {}, {}, {}, {}, {}, {}, {}}}",
                number(c.height),
                c.kind.0,
                c.literal,
                c.first_point,
                c.end_point,
                c.first_hedge,
                c.end_hedge
            )
        });
        self.add("flagred_curve", "curves", curves.collect());
        let points = table.points.iter().flatten().copied().collect::<Vec<f64>>();
        self.numbers("points", points);
        self.counts(
            "hedges",
            table.hedges.iter().map(|hedge: &Hedge| *hedge as u32),
        );
        self.records(
            "flagred_axis",
            "axes",
            table
                .axes
                .iter()
                .map(|a| (vec![], vec![a.input, a.first_cut, a.end_cut, a.first_line])),
        );
        self.records(
            "flagred_dimension",
            "dimensions",
            table
                .dimensions
                .iter()
                .map(|d| (vec![], vec![d.input, d.stride, d.any])),
        );
        self.counts("cells", table.cells.iter().copied());
        self.records(
            "flagred_node",
            "nodes",
            table.nodes.iter().map(|n| {
                let counts = [n.first_edge, n.end_edge, n.first_action, n.end_action];
                (vec![], counts.to_vec())
            }),
        );
        let edges = table
            .edges
            .iter()
            .map(|e| (vec![], vec![e.literal, e.node]));
        self.records("flagred_edge", "edges", edges);
        self.records(
            "flagred_action",
            "actions",
            table
                .actions
                .iter()
                .map(|a| (vec![a.weight], vec![a.place, a.output, a.rule, a.sums])),
        );
        self.records(
            "flagred_program",
            "programs",
            table.programs.iter().map(|p| {
                let counts = [p.first_step, p.end_step, p.first_action, p.end_action];
                (vec![], counts.to_vec())
            }),
        );
        let steps = table
            .steps
            .iter()
            .map(|s| (vec![], vec![s.op.0, s.literal]));
        self.records("flagred_step", "steps", steps);
        self.records(
            "flagred_output",
            "outputs",
            table.outputs.iter().map(|o| {
                let counts = [o.set.0, o.first, o.end, o.first_height, o.end_height];
                (vec![o.low, o.high, o.otherwise], counts.to_vec())
            }),
        );
        let pairs = table.pairs.iter().map(|p| {
            let two = |[a, b]: [f64; 2]| format!("{{{}, {}}}", number(a), number(b));
            format!(
                "{{{{{}}}, {{{}}}, {}, {}}}",
                p.area.map(two).join(", "),
                p.moment.map(two).join(", "),
                two(p.width),
                two(p.middle)
            )
        });
        self.add("flagred_pair", "pairs", pairs.collect());
        let moments = table
            .moments
            .iter()
            .map(|m| (vec![m.area, m.moment], vec![]));
        self.records("flagred_moment", "moments", moments);
        self.records(
            "flagred_consequence",
            "consequences",
            table
                .consequences
                .iter()
                .map(|c| (vec![c.constant], vec![c.first, c.end])),
        );
        self.records(
            "flagred_coefficient",
            "coefficients",
            table
                .coefficients
                .iter()
                .map(|c| (vec![c.coefficient], vec![c.input])),
        );
    }

    fn profile(&mut self, plan: &Plan<'_>) {
        self.counts("order", plan.order.iter().copied());
        self.records(
            "flagred_channel",
            "channels",
            plan.channels.iter().map(channel),
        );
        self.records("flagred_source", "sources", plan.inputs.iter().map(source));
        let Some(filled) = plan.filled else {
            for field in ["places", "first_places", "values", "distances"] {
                self.fields.push((field, "NULL".to_owned(), 0));
            }
            return;
        };
        self.numbers("places", filled.places.iter().copied());
        self.counts("first_places", filled.starts.iter().copied());
        self.numbers("values", filled.values.iter().copied());
        self.numbers("distances", filled.distances.iter().copied());
    }
}

fn channel(channel: &Channel) -> (Vec<f64>, Vec<u32>) {
    let (observed, signal) = match channel.observed {
        Observed::Command => (0, 0),
        Observed::Margin => (1, 0),
        Observed::LowSide => (2, 0),
        Observed::HighSide => (3, 0),
        Observed::Named(signal) => (4, signal as u32),
    };
    let motors = match channel.motors {
        Motors::Pooled => 0,
        Motors::Mean => 1,
        Motors::Std => 2,
        Motors::Min => 3,
        Motors::Max => 4,
    };
    let (threshold, limit) = match channel.threshold {
        None => (0, 0.0),
        Some(Threshold::Below(limit)) => (1, limit),
        Some(Threshold::Above(limit)) => (2, limit),
    };
    let codes = vec![observed, signal, motors, threshold];
    (vec![channel.window_s, limit], codes)
}

fn source(input: &Input) -> (Vec<f64>, Vec<u32>) {
    let statistic = match input.statistic {
        Statistic::Mean => 0,
        Statistic::Std => 1,
        Statistic::Rms => 2,
        Statistic::Min => 3,
        Statistic::Max => 4,
        Statistic::Last => 5,
        Statistic::ShareBelow(_) => 6,
        Statistic::ShareAbove(_) => 7,
    };
    (vec![], vec![input.channel as u32, statistic])
}

fn settings(settings: &Settings) -> String {
    let Settings {
        sampling,
        elevated_risk,
        verdict,
    } = settings;
    let threshold = |t: &verdict::Threshold| {
        let known = |value: Option<f64>| number(value.unwrap_or(f64::NAN));
        format!("{{{}, {}}}", known(t.risk_pct), known(t.elevated_risk_pct))
    };
    let level = |l: &LevelSettings| {
        let (raise, until) = (threshold(&l.raise), threshold(&l.until));
        format!("{{{raise}, {}, {until}}}", number(l.after_s))
    };
    let values = [
        number(sampling.warm_up_s),
        number(sampling.longest_gap_s),
        number(elevated_risk.window_s),
        number(elevated_risk.high_pct),
        number(elevated_risk.low_pct),
        number(elevated_risk.rise_pct_per_s),
        number(elevated_risk.fall_pct_per_s),
        level(&verdict.warn),
        level(&verdict.fail),
        number(verdict.clear_after_s),
        number(verdict.quiet_after_take_off_s),
        number(verdict.quiet_before_landing_s),
        number(verdict.idle.command_below),
        number(verdict.idle.risk_at_most_pct),
        sampling.min_samples.to_string(),
    ];
    format!("{{{}}}", values.join(", "))
}

/// The shortest decimal that reads back as the same bits.
fn number(value: f64) -> String {
    if value.is_nan() {
        "NAN".to_owned()
    } else if value == f64::INFINITY {
        "INFINITY".to_owned()
    } else if value == f64::NEG_INFINITY {
        "-INFINITY".to_owned()
    } else {
        format!("{value:?}")
    }
}

/// A name that C takes.
fn identifier(name: &str) -> String {
    let letter = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
    name.chars().map(letter).collect()
}

fn line(out: &mut String, line: &str) {
    // Writing into a string cannot fail.
    let _ = writeln!(out, "{line}");
}
