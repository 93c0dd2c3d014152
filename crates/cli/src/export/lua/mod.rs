//! A profile and its rule set as a script for ArduPilot.
//!
//! `script/` contains the parts of the script, as templates that are filled in from the profile. ArduPilot compiles `loader.lua`; the
//! other parts follow it as comments, which the loader compiles one by one. Numbers are rounded to 32 bits, the precision of the
//! autopilot's Lua.

mod cause;
mod condition;
mod frames;
mod inputs;
mod limits;
mod observed;
mod output;
mod rules;
mod template;

use flagred::{board::Plan, estimator::Estimator, follower::Settings, verdict::LevelSettings};

use limits::Size;
use template::TemplateValues;

/// The key of the script's parameter table. No script that ships with ArduPilot uses it.
const PARAMETER_TABLE: u8 = 157;

/// The parts of the script, in the order in which they are compiled. Parts that run only once come first, and their memory is
/// freed afterwards. Parts that need the least memory to compile come last, when the most memory is in use.
const PARTS: [(&str, &str); 15] = [
    ("motors", include_str!("script/motors.lua")),
    ("setup", include_str!("script/setup.lua")),
    ("geometry", include_str!("script/geometry.lua")),
    ("start", include_str!("script/start.lua")),
    ("windows", include_str!("script/windows.lua")),
    ("rules", include_str!("script/rules.lua")),
    ("inputs", include_str!("script/inputs.lua")),
    ("levels", include_str!("script/levels.lua")),
    ("notices", include_str!("script/notices.lua")),
    ("balance", include_str!("script/balance.lua")),
    ("flight", include_str!("script/flight.lua")),
    ("calls", include_str!("script/calls.lua")),
    ("elevated", include_str!("script/elevated.lua")),
    ("words", include_str!("script/words.lua")),
    ("texts", include_str!("script/texts.lua")),
];

/// Constants of the script that do not depend on the profile.
const SCRIPT: [(&str, &str); 13] = [
    // The time between two calls.
    ("CALL_MS", "30"),
    // The time between two values for the ground station.
    ("SEND_US", "500000"),
    // The length of a bin: commands are averaged over a bin before their noise is computed.
    ("BIN_US", "100000"),
    // Maximum number of slots of a window.
    ("SLOTS", "128"),
    // The maximum time of a counter: `later` does not increase a time that has reached it.
    ("LONG_US", "1000000000"),
    // The length of a test string in bytes. Creating it takes twice as many bytes. If that succeeds, enough memory is
    // free for the temporary values of calls.
    ("RESERVE_BYTES", "3000"),
    // Severities of MAVLink.
    ("CRITICAL", "2"),
    ("ERROR", "3"),
    ("WARNING", "4"),
    ("INFO", "6"),
    // Numbers of the levels.
    ("GOOD", "0"),
    ("WARN", "2"),
    ("FAIL", "3"),
];

/// The reason why a profile cannot be exported as a script, with advice.
pub(super) struct UnsupportedFeature {
    pub(super) message: String,
    pub(super) help: &'static str,
}

impl UnsupportedFeature {
    fn new(message: String, help: &'static str) -> Self {
        UnsupportedFeature { message, help }
    }
}

/// Returns the script.
pub(super) fn text(estimator: &Estimator, plan: &Plan<'_>) -> Result<String, UnsupportedFeature> {
    let mut filling = TemplateValues::default();
    let origin = super::origin(plan, &estimator.profile().rules, "--lua");
    filling.put("heading", vec![format!("-- {}", comment(&origin))]);
    constants(plan, &mut filling);
    let settings = &plan.settings;
    let risk = |level: &LevelSettings| level.raise.risk_pct;
    let levels = [
        ("WARN", risk(&settings.verdict.warn)),
        ("FAIL", risk(&settings.verdict.fail)),
    ];
    let reported = levels
        .into_iter()
        .filter_map(|(name, risk)| Some((name, risk?)));
    let parameters = [("ENABLE", 1.0)].into_iter().chain(reported);
    filling.put(
        "parameters",
        parameters
            .map(|(name, value)| format!("  {{\"{name}\", {}}},", number(value)))
            .collect(),
    );
    filling.put("motors_of_class", vec![frames::motors_of_class()]);
    filling.set("warn_risk", levels[0].1.is_some());
    filling.set("fail_risk", levels[1].1.is_some());
    let notices = &settings.verdict.notices;
    let reported = [notices.reserve.is_some(), notices.imbalance.is_some()];
    filling.set("reserve", reported[0]);
    filling.set("imbalance", reported[1]);
    filling.set("notices", reported.contains(&true));
    let mut size = Size::default();
    inputs::fill(estimator, plan, &mut filling, &mut size)?;
    rules::fill(estimator, plan, &mut filling, &mut size)?;
    let parts = PARTS.iter().filter(|(name, _)| match *name {
        "notices" => reported.contains(&true),
        "balance" => reported[1],
        "geometry" => filling.is_set("geometry"),
        _ => true,
    });
    let parts: Vec<(&str, String)> = parts
        .map(|(name, template)| (*name, filling.fill(template)))
        .collect();
    let stays = |name: &str| !["setup", "geometry", "start"].contains(&name);
    for (_, part) in parts.iter().filter(|(name, _)| stays(name)) {
        size.add_code(part);
    }
    size.check()?;
    let names: Vec<String> = parts.iter().map(|(name, _)| quoted(name)).collect();
    filling.put(
        "parts",
        vec![format!("local PARTS = {{{}}}", names.join(", "))],
    );
    let mut file = filling.fill(include_str!("script/loader.lua"));
    let texts: Vec<&str> = parts.iter().map(|(_, text)| text.as_str()).collect();
    file.push_str(&commented(&texts));
    Ok(file)
}

/// Returns the parts with every line as a comment, so that ArduPilot can compile the file even if it is truncated. A line with a form
/// feed precedes each part and follows the last one.
fn commented(parts: &[&str]) -> String {
    const BREAK: &str = "-- \x0c\n";
    let mut text = format!("\n{BREAK}");
    for part in parts {
        for line in part.lines() {
            text += "-- ";
            text += line;
            text.push('\n');
        }
        text += BREAK;
    }
    text
}

/// Adds the settings of the profile and the script's own constants, under the names that the parts use.
fn constants(plan: &Plan<'_>, filling: &mut TemplateValues) {
    let Settings {
        sampling,
        elevated_risk,
        verdict,
    } = &plan.settings;
    let mut set = |name: &'static str, value: String| filling.constant(name, value);
    for (name, value) in SCRIPT {
        set(name, value.to_owned());
    }
    set("MIN_SAMPLES", sampling.min_samples.to_string());
    set("MIN_STRENGTH", number(plan.rules.table.least_strength));
    set("WARM_UP_US", microseconds(sampling.warm_up_s));
    set("LONGEST_GAP_US", microseconds(sampling.longest_gap_s));
    set("TAKE_OFF_US", microseconds(sampling.take_off_s));
    set("ELEVATED_WINDOW_S", number(elevated_risk.window_s));
    set(
        "ELEVATED_CAPACITY",
        inputs::elevated_capacity(plan).to_string(),
    );
    set("ELEVATED_HIGH", number(elevated_risk.high_pct));
    set("ELEVATED_LOW", number(elevated_risk.low_pct));
    set("RISE", number(elevated_risk.rise_pct_per_s));
    set("FALL", number(elevated_risk.fall_pct_per_s));
    let known = |limit: Option<f64>| limit.map_or("nil".to_owned(), number);
    let LevelSettings {
        raise,
        after_s,
        until,
    } = &verdict.warn;
    set("WARN_RISK", known(raise.risk_pct));
    set("WARN_ELEVATED", known(raise.elevated_risk_pct));
    set("WARN_AFTER_US", microseconds(*after_s));
    set("WARN_UNTIL_RISK", known(until.risk_pct));
    set("WARN_UNTIL_ELEVATED", known(until.elevated_risk_pct));
    let LevelSettings {
        raise,
        after_s,
        until,
    } = &verdict.fail;
    set("FAIL_RISK", known(raise.risk_pct));
    set("FAIL_ELEVATED", known(raise.elevated_risk_pct));
    set("FAIL_AFTER_US", microseconds(*after_s));
    set("FAIL_UNTIL_RISK", known(until.risk_pct));
    set("FAIL_UNTIL_ELEVATED", known(until.elevated_risk_pct));
    set("CLEAR_AFTER_US", microseconds(verdict.clear_after_s));
    set("QUIET_US", microseconds(verdict.quiet_after_take_off_s));
    set("IDLE_BELOW", number(verdict.idle_below));
    if let Some(limit) = verdict.notices.reserve {
        set("RESERVE_BELOW", number(limit.value));
        set("RESERVE_AFTER_US", microseconds(limit.after_s));
    }
    if let Some(limit) = verdict.notices.imbalance {
        set("IMBALANCE_ABOVE", number(limit.value));
        set("IMBALANCE_AFTER_US", microseconds(limit.after_s));
    }
    set("COVERAGE_BELOW", number(plan.coverage_below));
    set("PARAMETER_TABLE", PARAMETER_TABLE.to_string());
}

/// Converts a time to whole microseconds. Times above a quarter of an hour are treated as unlimited.
fn microseconds(seconds: f64) -> String {
    const LONGEST_US: f64 = 900e6;
    format!("{:.0}", (seconds * 1e6).min(LONGEST_US))
}

/// Returns the shortest decimal that reads back as the same 32-bit number.
fn number(number: f64) -> String {
    let rounded = number as f32;
    if rounded.is_nan() {
        "nil".into()
    } else if rounded.is_infinite() {
        if rounded > 0.0 { "huge" } else { "-huge" }.into()
    } else {
        format!("{rounded:?}")
    }
}

/// Converts text from a rule set to a string literal. The escapes of Rust's debug form are valid in Lua.
fn quoted(text: &str) -> String {
    format!("{:?}", fuzzy::drawing::visible(text))
}

/// Escapes text from a rule set for use in a comment.
fn comment(text: &str) -> String {
    fuzzy::drawing::visible(text).into_owned()
}
