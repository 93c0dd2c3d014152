//! Reads the key `verdict` of a profile: when levels are raised and cleared, and the limits of notices.

use alloc::format;

use fuzzy::{
    diagnostic::Diagnostic,
    tree::{Fields, Node},
};

use super::{Bounds, Mistakes, number};
use crate::verdict::{LevelSettings, Limit, NoticeSettings, Threshold, VerdictSettings};

pub(super) fn verdict(fields: &Fields, found: &mut Mistakes) -> VerdictSettings {
    let default = VerdictSettings::default();
    let keys = [
        "warn",
        "fail",
        "clear_after_s",
        "quiet_after_take_off_s",
        "quiet_before_landing_s",
        "idle_below",
        "noise",
        "reserve",
        "imbalance",
    ];
    let Some(fields) = fields.get("verdict").and_then(|node| {
        let help = "write `verdict: {warn: {risk: 60}, fail: {risk: 70}}`";
        node.fields("`verdict`", &keys, help, found)
    }) else {
        return default;
    };
    let mut seconds = |key, default| number(&fields, key, default, Bounds::From0, found);
    let settings = VerdictSettings {
        clear_after_s: seconds("clear_after_s", default.clear_after_s),
        quiet_after_take_off_s: seconds("quiet_after_take_off_s", default.quiet_after_take_off_s),
        quiet_before_landing_s: seconds("quiet_before_landing_s", default.quiet_before_landing_s),
        idle_below: number(
            &fields,
            "idle_below",
            default.idle_below,
            Bounds::Below1,
            found,
        ),
        ..default
    };
    VerdictSettings {
        warn: level(&fields, "warn", default.warn, found),
        fail: level(&fields, "fail", default.fail, found),
        notices: NoticeSettings {
            noise: limit(&fields, "noise", "above", found),
            reserve: limit(&fields, "reserve", "below", found),
            imbalance: limit(&fields, "imbalance", "above", found),
        },
        ..settings
    }
}

pub(super) fn level(
    fields: &Fields,
    key: &str,
    default: LevelSettings,
    found: &mut Mistakes,
) -> LevelSettings {
    let what = format!("`{key}`");
    let keys = ["risk", "elevated_risk", "after_s", "until"];
    let Some(node) = fields.get(key) else {
        return default;
    };
    let help = format!("write `{key}: {{risk: {}}}`", number_or(node, "60"));
    let Some(fields) = node.fields(&what, &keys, &help, found) else {
        return default;
    };
    let raise = threshold(&fields, &what, found);
    if raise == Threshold::default() && found.is_empty() {
        let message = format!("{what} has no threshold");
        found.push(
            Diagnostic::error("missing-key", node.span.clone(), message)
                .help("write `risk`, `elevated_risk` or both, in %"),
        );
    }
    let after_s = number(&fields, "after_s", default.after_s, Bounds::From0, found);
    let mut until = raise;
    if let Some(node) = fields.get("until")
        && let help = format!("write `until: {{risk: {}}}`", number_or(node, "30"))
        && let Some(fields) = node.fields("`until`", &["risk", "elevated_risk"], &help, found)
    {
        until = threshold(&fields, "`until`", found);
        for (lower, upper) in [
            (until.risk_pct, raise.risk_pct),
            (until.elevated_risk_pct, raise.elevated_risk_pct),
        ] {
            if let (Some(lower), Some(upper)) = (lower, upper)
                && lower > upper
            {
                let message = format!(
                    "`until` of {what} is {lower}, above {upper}, at which the level is raised"
                );
                let help = match upper <= 1.0 && lower > 1.0 {
                    true => format!(
                        "risks are in percent: did you mean {} in place of {upper}?",
                        upper * 100.0
                    ),
                    false => "write a lower value in `until`".into(),
                };
                found.push(Diagnostic::error("order", node.span.clone(), message).help(help));
            }
        }
    }
    LevelSettings {
        raise,
        after_s,
        until,
    }
}

/// The number to show in an example of a mapping: the number that the author wrote in place of the mapping, or `other`
/// if the author did not write a number.
fn number_or<'n>(node: &'n Node, other: &'n str) -> &'n str {
    node.as_number_text().unwrap_or(other)
}

fn threshold(fields: &Fields, what: &str, found: &mut Mistakes) -> Threshold {
    let mut limit = |key: &str| {
        let node = fields.get(key)?;
        let before = found.len();
        let value = node.finite(&format!("`{key}`"), found);
        let percent = node.as_text().and_then(|text| text.strip_suffix('%'));
        if let (Some(percent), Some(finding)) = (percent, found.get_mut(before)) {
            finding.help = Some(format!(
                "risks are in percent: write `{key}: {}`",
                percent.trim()
            ));
        }
        let is_word = value.is_none() && percent.is_none();
        if let Some(finding) = found.get_mut(before).filter(|_| is_word)
            && finding.help.as_deref() == Some("write a number")
        {
            finding.help = Some(format!("write the risk in percent, such as `{key}: 60`"));
        }
        let value = value?;
        if !(0.0..=100.0).contains(&value) {
            let message = format!("{what}: `{key}` is a percentage, not {value}");
            found.push(
                Diagnostic::error("out-of-range", node.span.clone(), message)
                    .help("write a number from 0 to 100"),
            );
        }
        Some(value)
    };
    Threshold {
        risk_pct: limit("risk"),
        elevated_risk_pct: limit("elevated_risk"),
    }
}

/// Reads the limit of a notice: `{above: 0.04, after_s: 10}`.
fn limit(fields: &Fields, key: &str, side: &str, found: &mut Mistakes) -> Option<Limit> {
    let what = format!("`{key}`");
    let node = fields.get(key)?;
    let written = number_or(node, "0.1");
    let help = format!("write `{key}: {{{side}: {written}, after_s: 5}}`");
    let fields = node.fields(&what, &[side, "after_s"], &help, found)?;
    fields.require(side, &help, found)?;
    let value = number(&fields, side, 0.0, Bounds::Below1, found);
    let after_s = number(&fields, "after_s", 0.0, Bounds::From0, found);
    Some(Limit { value, after_s })
}
