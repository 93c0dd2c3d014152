//! A profile and its rule set as a script for ArduPilot.
//!
//! `script.lua` is the script, with places for what the profile says. Numbers are rounded to the 32 bits that the autopilot's
//! Lua has.

mod frames;
mod inputs;
mod observed;
mod rules;
mod template;

use flagred::{
    board::Plan,
    estimator::Estimator,
    follower::Settings,
    verdict::{LevelSettings, Threshold},
};

use template::Filling;

/// The number of the table of script parameters; no script that comes with ArduPilot has it.
const PARAMETER_TABLE: u8 = 157;

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
    let settings = &plan.settings;
    filling.put("settings", constants(plan));
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
    filling.set("warn_risk", levels[0].1.is_some());
    filling.set("fail_risk", levels[1].1.is_some());
    let notices = &settings.verdict.notices;
    let told = [notices.reserve.is_some(), notices.imbalance.is_some()];
    filling.set("reserve", told[0]);
    filling.set("imbalance", told[1]);
    filling.set("notices", told.contains(&true));
    inputs::fill(estimator, plan, &mut filling)?;
    rules::fill(estimator, plan, &mut filling)?;
    Ok(filling.fill(include_str!("script.lua")))
}

/// The settings of the profile as constants.
fn constants(plan: &Plan<'_>) -> Vec<String> {
    let Settings {
        sampling,
        elevated_risk,
        verdict,
    } = &plan.settings;
    let mut lines = Vec::new();
    let mut set = |name: &str, value: String| lines.push(format!("local {name} = {value}"));
    set("MIN_SAMPLES", sampling.min_samples.to_string());
    set("LEAST_STRENGTH", number(plan.rules.table.least_strength));
    set("WARM_UP_US", microseconds(sampling.warm_up_s));
    set("LONGEST_GAP_US", microseconds(sampling.longest_gap_s));
    set("TAKE_OFF_US", microseconds(sampling.take_off_s));
    set("ELEVATED_WINDOW_S", number(elevated_risk.window_s));
    set(
        "ELEVATED_HIGH, ELEVATED_LOW",
        format!(
            "{}, {}",
            number(elevated_risk.high_pct),
            number(elevated_risk.low_pct)
        ),
    );
    set(
        "RISE, FALL",
        format!(
            "{}, {} -- of the elevated risk, in % per second",
            number(elevated_risk.rise_pct_per_s),
            number(elevated_risk.fall_pct_per_s)
        ),
    );
    for (name, level) in [("WARN", &verdict.warn), ("FAIL", &verdict.fail)] {
        let LevelSettings {
            raise,
            after_s,
            until,
        } = level;
        set(&format!("{name}_RISK, {name}_ELEVATED"), threshold(raise));
        set(&format!("{name}_AFTER_US"), microseconds(*after_s));
        set(
            &format!("{name}_UNTIL_RISK, {name}_UNTIL_ELEVATED"),
            threshold(until),
        );
    }
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
    if plan.filled.is_some() {
        set("COVERAGE_BELOW", number(plan.coverage_below));
    }
    set("PARAMETER_TABLE", PARAMETER_TABLE.to_string());
    lines
}

fn threshold(threshold: &Threshold) -> String {
    let known = |limit: Option<f64>| limit.map_or("nil".to_owned(), number);
    format!(
        "{}, {}",
        known(threshold.risk_pct),
        known(threshold.elevated_risk_pct)
    )
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
