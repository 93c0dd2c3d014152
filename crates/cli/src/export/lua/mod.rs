//! A profile and its rule set as a script for ArduPilot.
//!
//! `script/` has the parts of the script, with places for what the profile says. `loader.lua` is what ArduPilot compiles; the
//! other parts are a comment behind it, which the loader compiles one by one. Numbers are rounded to the 32 bits that the
//! autopilot's Lua has.

mod frames;
mod inputs;
mod limits;
mod observed;
mod rules;
mod template;

use flagred::{board::Plan, estimator::Estimator, follower::Settings, verdict::LevelSettings};

use limits::Size;
use template::Filling;

/// The number of the table of script parameters; no script that comes with ArduPilot has it.
const PARAMETER_TABLE: u8 = 157;

/// The parts in the order in which they are compiled. What runs only once comes first and is gone before the rest comes; what
/// takes least to compile comes last, when most memory is taken.
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

/// What the script itself fixes.
const SCRIPT: [(&str, &str); 13] = [
    // Between two calls, and between two values for the ground station.
    ("CALL_MS", "30"),
    ("SEND_US", "500000"),
    // Commands are averaged over a bin before their noise is taken out.
    ("BIN_US", "100000"),
    // Of a window.
    ("SLOTS", "128"),
    // Longer times are this long.
    ("LONG_US", "1000000000"),
    // Half of the heap that must be left for what calls take for a moment.
    ("RESERVE_BYTES", "3000"),
    // Severities of MAVLink.
    ("CRITICAL", "2"),
    ("ERROR", "3"),
    ("WARNING", "4"),
    ("INFO", "6"),
    // Levels.
    ("GOOD", "0"),
    ("WARN", "2"),
    ("FAIL", "3"),
];

/// Why a profile cannot be a script, and what can.
pub(super) struct Refused {
    pub(super) message: String,
    pub(super) help: &'static str,
}

impl Refused {
    fn new(message: String, help: &'static str) -> Self {
        Refused { message, help }
    }
}

/// The file.
pub(super) fn text(estimator: &Estimator, plan: &Plan<'_>) -> Result<String, Refused> {
    if !plan.rules.stages.is_empty() {
        return Err(Refused::new(
            "a script on the autopilot cannot evaluate outputs that read other outputs".into(),
            "write rules whose conditions name inputs only; `export --rust` and `export --c` carry chains",
        ));
    }
    let mut filling = Filling::default();
    let origin = super::origin(plan, &estimator.profile().rules, "--lua");
    filling.put("heading", vec![format!("-- {}", comment(&origin))]);
    constants(plan, &mut filling);
    let settings = &plan.settings;
    let risk = |level: &LevelSettings| level.raise.risk_pct;
    let levels = [
        ("WARN", risk(&settings.verdict.warn)),
        ("FAIL", risk(&settings.verdict.fail)),
    ];
    let told = levels
        .into_iter()
        .filter_map(|(name, risk)| Some((name, risk?)));
    let parameters = [("ENABLE", 1.0)].into_iter().chain(told);
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
    let told = [notices.reserve.is_some(), notices.imbalance.is_some()];
    filling.set("reserve", told[0]);
    filling.set("imbalance", told[1]);
    filling.set("notices", told.contains(&true));
    let mut size = Size::default();
    inputs::fill(estimator, plan, &mut filling, &mut size)?;
    rules::fill(estimator, plan, &mut filling, &mut size)?;
    let parts = PARTS.iter().filter(|(name, _)| match *name {
        "notices" => told.contains(&true),
        "balance" => told[1],
        "geometry" => filling.holds("geometry"),
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

/// The parts with each line as a comment of its own: ArduPilot can compile the file also where it is cut off. Before each part
/// and at the end there is a line with a form feed.
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

/// The settings of the profile and what the script itself fixes, by the names that they have in its parts.
fn constants(plan: &Plan<'_>, filling: &mut Filling) {
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
    set("LEAST_STRENGTH", number(plan.rules.table.least_strength));
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

/// A time in whole microseconds; over a quarter of an hour is as good as for ever.
fn microseconds(seconds: f64) -> String {
    const LONGEST_US: f64 = 900e6;
    format!("{:.0}", (seconds * 1e6).min(LONGEST_US))
}

/// The shortest decimal that reads back as the same 32-bit number.
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

/// A text of a rule set as a string. The escapes of its debug form are Lua's.
fn quoted(text: &str) -> String {
    format!("{:?}", fuzzy::drawing::visible(text))
}

/// A text of a rule set in a comment.
fn comment(text: &str) -> String {
    fuzzy::drawing::visible(text).into_owned()
}
