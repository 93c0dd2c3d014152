//! Writes a plan or a rule set as C. Each number is written so that exactly the same bits are read back. The
//! numeric codes of enumerations are the same as in `flagred-c`.

use std::fmt::Write;

use super::{Array, FindingWords};
use flagred::{
    board::{Plan, Rules, table::Hedge},
    channel::{Channel, Input, Threshold},
    follower::Settings,
    gap::FilledKnots,
    verdict::{self, LevelSettings},
};

/// Returns the file for a profile.
pub(super) fn text(plan: &Plan<'_>, rules: &str, signals: &[&str], words: &FindingWords) -> String {
    let name = identifier(plan.name);
    let motor = plan.bytes(1) - plan.bytes(0);
    let mut arrays = Arrays::begin(
        &super::heading(plan, rules, signals, "--c"),
        &format!("FLAGRED_PLAN_{}_H", name.to_uppercase()),
        format!("flagred_{name}"),
    );
    let out = &mut arrays.out;
    line(
        out,
        "/* The memory of a monitor for this number of motors, on any processor. */",
    );
    let memory = format!("FLAGRED_PLAN_{}_MEMORY(motors)", name.to_uppercase());
    line(
        out,
        &format!("#define {memory} ({} + {motor} * (motors))", plan.bytes(0)),
    );
    line(
        out,
        &format!(
            "/* The same, in a program with one profile. With several, use the names above. */\n\
             #ifndef FLAGRED_HAS_PLAN\n\
             #define FLAGRED_HAS_PLAN\n\
             #define FLAGRED_MEMORY(motors) {memory}\n\
             #else\n\
             #undef FLAGRED_MEMORY\n\
             #endif\n"
        ),
    );
    let rules = arrays.rules(&plan.rules);
    arrays.profile(plan);
    arrays.add_words(words);
    let out = &mut arrays.out;
    line(
        out,
        &format!("static const flagred_plan flagred_plan_{name} = {{"),
    );
    line(out, "    .rules = {");
    for field in rules {
        line(out, &format!("        {field}"));
    }
    line(out, "    },");
    for (field, value) in [
        ("output", plan.output.to_string()),
        ("signals", plan.signals.to_string()),
        ("coverage_below", number(plan.coverage_below)),
        ("settings", settings(&plan.settings)),
    ] {
        line(out, &format!("    .{field} = {value},"));
    }
    for field in arrays.take_fields() {
        line(&mut arrays.out, &format!("    {field}"));
    }
    arrays.end()
}

/// Returns the file for a rule set without a profile.
pub(super) fn rules(rules: &Rules<'_>, name: &str, heading: &[String]) -> String {
    let name = identifier(name);
    let upper = name.to_uppercase();
    let guard = format!("FLAGRED_RULES_{upper}_H");
    let mut arrays = Arrays::begin(heading, &guard, format!("flagred_rules_{name}"));
    let out = &mut arrays.out;
    line(
        out,
        "/* Enough memory for an evaluator, on any processor. */",
    );
    let bytes = rules.bytes();
    line(out, &format!("#define FLAGRED_{upper}_MEMORY {bytes}\n"));
    let fields = arrays.rules(rules);
    let out = &mut arrays.out;
    line(
        out,
        &format!("static const flagred_rules flagred_rules_{name} = {{"),
    );
    for field in fields {
        line(out, &format!("    {field}"));
    }
    arrays.end()
}

/// The arrays written so far, and the fields that point to them.
struct Arrays {
    out: String,
    prefix: String,
    fields: Vec<(&'static str, String, usize)>,
}

impl Arrays {
    /// Writes the beginning of a file.
    fn begin(heading: &[String], guard: &str, prefix: String) -> Self {
        let mut out = String::new();
        line(&mut out, &format!("/* {} */", heading.join("\n * ")));
        line(&mut out, &format!("#ifndef {guard}\n#define {guard}\n"));
        line(&mut out, "#include <math.h>\n#include \"flagred.h\"\n");
        Arrays {
            out,
            prefix,
            fields: Vec::new(),
        }
    }

    /// Closes the structure and the file.
    fn end(mut self) -> String {
        line(&mut self.out, "};\n\n#endif");
        self.out
    }

    /// Returns the initialisers of the arrays written so far, and clears them.
    fn take_fields(&mut self) -> Vec<String> {
        let fields = std::mem::take(&mut self.fields).into_iter();
        fields
            .map(|(field, array, count)| format!(".{field} = {array}, .{field}_count = {count},"))
            .collect()
    }

    /// Writes the arrays of a rule set, and returns its initialisers.
    fn rules(&mut self, rules: &Rules<'_>) -> Vec<String> {
        let table = &rules.table;
        for array in super::arrays(table) {
            self.add_array(array.field, &array);
        }
        self.add_array("stages", &Array::new("stages", "Stage", rules.stages));
        self.add_array("indices", &Array::new("indices", "u32", rules.indices));
        let [conjunctions, actions_per_cell, first_action, sums] = table.conjunctions.code();
        let sizes = table.sizes;
        let fields = [
            ("format", "FLAGRED_FORMAT".to_owned()),
            ("and_operator", (table.and as u32).to_string()),
            ("or_operator", (table.or as u32).to_string()),
            ("conjunctions", conjunctions.to_string()),
            ("actions_per_cell", actions_per_cell.to_string()),
            ("first_action", first_action.to_string()),
            ("sums", sums.to_string()),
            ("degrees", sizes.degrees.to_string()),
            ("alive", sizes.alive.to_string()),
            ("partial", sizes.partial.to_string()),
            ("stack", sizes.stack.to_string()),
            ("strengths", sizes.strengths.to_string()),
            ("least_strength", number(table.least_strength)),
        ];
        let fields = fields.map(|(field, value)| format!(".{field} = {value},"));
        fields.into_iter().chain(self.take_fields()).collect()
    }

    /// Writes an array of C initialisers, or a null pointer for an empty one: C has no empty arrays.
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

    fn add_array(&mut self, field: &'static str, array: &Array) {
        let kind = match array.item {
            "f64" => "double".to_owned(),
            "u32" => "uint32_t".to_owned(),
            item => format!("flagred_{}", snake_case(item)),
        };
        let items = array.items.iter().map(|item| initialiser(item));
        self.add(&kind, field, items.collect());
    }

    fn profile(&mut self, plan: &Plan<'_>) {
        self.add_array("order", &Array::new("order", "u32", plan.order));
        let channels = plan.channels.iter().map(channel).collect();
        self.add("flagred_channel", "channels", channels);
        let sources = plan.inputs.iter().map(source).collect();
        self.add("flagred_source", "sources", sources);
        let none = FilledKnots {
            coordinates: &[],
            starts: &[],
            values: &[],
            distances: &[],
        };
        for array in super::filling(plan.filled.as_ref().unwrap_or(&none)) {
            let field = match array.field {
                "starts" => "first_coordinates",
                field => field,
            };
            self.add_array(field, &array);
        }
        let propositions = Array::new("propositions", "Proposition", plan.propositions);
        self.add_array("propositions", &propositions);
    }

    /// Writes the texts of findings for pilots. The plan does not contain them.
    fn add_words(&mut self, words: &FindingWords) {
        let FindingWords { causes, notices } = words;
        for (comment, field, words) in [
            (
                "The texts of findings with a cause, by flagred_finding.cause.",
                "causes",
                causes,
            ),
            (
                "The texts of findings without a cause, by flagred_finding.measure.",
                "notices",
                notices,
            ),
        ] {
            line(&mut self.out, &format!("/* {comment} */"));
            let rows = words.iter().map(super::literals);
            let rows = rows.map(|row| format!("{{{}}}", row.join(", ")));
            self.add("flagred_words", field, rows.collect());
            self.fields.pop();
        }
    }
}

/// Converts the debug form of plain data into a C initialiser: `Edge { literal: 1, node: 2 }` becomes `{.literal = 1, .node = 2}`.
fn initialiser(debug: &str) -> String {
    let words: Vec<&str> = debug.split(' ').collect();
    let mut text = String::new();
    for (i, word) in words.iter().enumerate() {
        if words.get(i + 1) == Some(&"{") {
            continue; // the name of the structure
        }
        match word.strip_suffix(':') {
            Some(field) => text += &format!(".{field} = "),
            None => text += &format!("{} ", value(word)),
        }
    }
    text.trim_end().replace("{ ", "{").replace(" }", "}")
}

/// Converts a word of a debug form: a number, a code such as `ShapeKind(3)`, or a hedge.
fn value(word: &str) -> String {
    if let Some(code) = Hedge::ALL
        .iter()
        .position(|hedge| format!("{hedge:?}") == word)
    {
        return code.to_string();
    }
    let word = word.rsplit('(').next().unwrap_or(word).replace(')', "");
    let word = word.replace('[', "{").replace(']', "}");
    word.replace("NaN", "NAN").replace("inf", "INFINITY")
}

fn channel(channel: &Channel) -> String {
    let (observed, [first, second], unknown_below) = channel.observed.code();
    let (threshold, limit) = Threshold::code(channel.threshold);
    format!(
        "{{{}, {}, {}, {observed}, {{{first}, {second}}}, {}, {threshold}, {}, {}}}",
        number(channel.window_s),
        number(limit),
        number(unknown_below),
        channel.motors.code(),
        u32::from(channel.in_bins),
        u32::from(channel.exponential)
    )
}

fn source(input: &Input) -> String {
    let (statistic, parameter) = input.statistic.code();
    let at_least = input.ratio.map_or(0.0, |ratio| ratio.at_least);
    let per = input
        .ratio
        .map_or("UINT32_MAX".to_owned(), |ratio| ratio.per.to_string());
    format!(
        "{{{}, {}, {}, {}, {statistic}, {per}}}",
        number(parameter),
        number(at_least),
        number(input.if_missing.unwrap_or(f64::NAN)),
        input.channel
    )
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
    let limit = |limit: Option<verdict::Limit>| {
        let (value, after_s) = limit.map_or((f64::NAN, 0.0), |limit| (limit.value, limit.after_s));
        format!("{{{}, {}}}", number(value), number(after_s))
    };
    let notices = &verdict.notices;
    let values = [
        number(sampling.warm_up_s),
        number(sampling.longest_gap_s),
        number(sampling.take_off_s),
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
        number(verdict.idle_below),
        limit(notices.noise),
        limit(notices.reserve),
        limit(notices.imbalance),
        sampling.min_samples.to_string(),
    ];
    format!("{{{}}}", values.join(", "))
}

/// The shortest decimal that reads back as the same bits.
fn number(number: f64) -> String {
    value(&format!("{number:?}"))
}

/// Replaces the characters of a name that a C identifier cannot contain.
fn identifier(name: &str) -> String {
    let letter = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
    name.chars().map(letter).collect()
}

fn line(out: &mut String, line: &str) {
    // Writing into a string cannot fail.
    let _ = writeln!(out, "{line}");
}

/// Converts a name to snake case: `SetTerm` becomes `set_term`.
fn snake_case(name: &str) -> String {
    let mut snake = String::new();
    for letter in name.chars() {
        if letter.is_ascii_uppercase() && !snake.is_empty() {
            snake.push('_');
        }
        snake.push(letter.to_ascii_lowercase());
    }
    snake
}
