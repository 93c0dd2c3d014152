//! The report of one flight, or a comparison of several, as one HTML file that needs nothing beside it.

use std::fmt::Write as _;

use fuzzy::Model;

use super::{
    charts, decision,
    panel::{Panel, Timeline},
};
use crate::{
    assessment::words,
    drawing::text::{Escaped, number},
    profile::Loaded,
};
use flagred::flight::{Assessment, Peak, Verdict};
use flightlog::Flight;

const CHART_CSS: &str = include_str!("chart.css");
const PAGE_CSS: &str = include_str!("page.css");
const PAGE_JS: &str = include_str!("page.js");

/// One flight that was assessed.
pub(crate) struct Subject {
    pub(crate) name: String,
    pub(crate) flight: Flight,
    pub(crate) assessed: Assessment,
}

impl Subject {
    /// The file without its folders: what a heading has room for.
    fn title(&self) -> &str {
        let file = std::path::Path::new(&self.name).file_name();
        file.and_then(|file| file.to_str()).unwrap_or(&self.name)
    }

    fn in_air_s(&self) -> f64 {
        self.assessed.summary.in_air_s
    }
}

/// The report of one flight.
pub(crate) fn report(subject: &Subject, loaded: &Loaded) -> String {
    let Subject {
        flight, assessed, ..
    } = subject;
    let estimator = &loaded.estimator;
    let timeline = charts::timeline(flight, assessed);
    let stretch = timeline.stretch;

    let mut body = head(subject);
    body += &findings(subject);
    body += &figures(subject);
    let risk = charts::risk(assessed, estimator, stretch);
    let risk: Vec<Panel> = risk.into_iter().collect();
    section(&mut body, "Risk over time", "", risk, &timeline);
    if let Some(map) = decision::html(estimator, &loaded.model, &assessed.steps) {
        let _ = write!(body, "<h2>Why: the rules and their inputs</h2>{map}");
    }
    for panel in charts::inputs(assessed, estimator, &loaded.model, stretch) {
        body += &panel.html(&timeline);
    }
    body += &rules(&loaded.model, assessed);
    let margins = charts::margins(flight, assessed, estimator, stretch);
    let mut motors: Vec<Panel> = margins.into_iter().collect();
    motors.extend(charts::motors(flight, estimator, stretch));
    let limits = "Each command on its full range; it flies between the dashed limits.";
    section(&mut body, "Motors", limits, motors, &timeline);
    let mut vehicle: Vec<Panel> = charts::attitude_error(flight, estimator, stretch)
        .into_iter()
        .collect();
    vehicle.extend(charts::battery(flight, estimator, stretch));
    section(&mut body, "Attitude and battery", "", vehicle, &timeline);
    body += &events(&timeline);
    body += &read(subject, loaded);
    body += &texts(loaded);
    page(subject.title(), &body)
}

/// A heading with its panels, and what has to be said of all of them; nothing where there is none.
fn section(body: &mut String, title: &str, note: &str, panels: Vec<Panel>, timeline: &Timeline) {
    if panels.is_empty() {
        return;
    }
    let _ = write!(body, "<h2>{title}</h2>");
    if !note.is_empty() {
        let _ = write!(body, r#"<p class="soft">{note}</p>"#);
    }
    for panel in panels {
        *body += &panel.html(timeline);
    }
}

/// A comparison of several flights on one scale of time.
pub(crate) fn comparison(subjects: &[Subject], loaded: &Loaded) -> String {
    let longest_s = subjects
        .iter()
        .map(|s| charts::timeline(&s.flight, &s.assessed).stretch.length_s())
        .fold(0.0, f64::max);
    let mut rows = String::new();
    let mut flights = String::new();
    for (i, subject) in subjects.iter().enumerate() {
        let summary = &subject.assessed.summary;
        let peak = |peak: Option<Peak>| percent(peak.map(|peak| peak.value_pct));
        let _ = write!(
            rows,
            r##"<tr><td>{}</td><td class="name"><a href="#flight{i}">{}</a></td><td class="n">{} s</td><td class="n">{}</td><td class="n">{}</td><td class="n">{}</td><td class="n">{}</td><td class="n">{}</td></tr>"##,
            badge(&subject.assessed.verdict),
            Escaped(subject.title()),
            number(subject.in_air_s(), 0),
            percent(summary.risk_mean_pct),
            peak(summary.risk_max),
            peak(summary.elevated_risk_max),
            percent(summary.saturated_share.map(|share| share * 100.0)),
            subject.assessed.findings.len(),
        );
        let _ = write!(
            flights,
            r#"<section id="flight{i}"><h2>{} {}</h2><p class="soft">{}</p>"#,
            badge(&subject.assessed.verdict),
            Escaped(subject.title()),
            Escaped(&words::vehicle(&subject.flight)),
        );
        flights += &findings(subject);
        let mut timeline = charts::timeline(&subject.flight, &subject.assessed);
        timeline.stretch.end_s = timeline.stretch.start_s + longest_s;
        let risk = charts::risk(&subject.assessed, &loaded.estimator, timeline.stretch);
        flights += &risk.map_or_else(String::new, |panel| panel.html(&timeline));
        flights += "</section>";
    }
    let title = format!("{} flights compared", subjects.len());
    let body = format!(
        r#"<h1>{title}</h1><p class="soft">All pictures have the same length, {} s, so that they can be compared. `flagred assess LOG --html FILE` gives the whole report of one flight.</p><div class="scroll"><table><thead><tr><th>Verdict</th><th>Flight</th><th class="n">In the air</th><th class="n">Mean risk</th><th class="n">Highest</th><th class="n">Elevated</th><th class="n">At a limit</th><th class="n">Findings</th></tr></thead><tbody>{rows}</tbody></table></div>{flights}{}"#,
        number(longest_s, 0),
        texts(loaded)
    );
    page(&title, &body)
}

/// The picture of risk over time, as an SVG file of its own.
pub(crate) fn svg(subject: &Subject, loaded: &Loaded) -> Option<String> {
    let timeline = charts::timeline(&subject.flight, &subject.assessed);
    let panel = charts::risk(&subject.assessed, &loaded.estimator, timeline.stretch)?;
    let style = "text{font:12px system-ui,sans-serif;fill:var(--soft)}.y{text-anchor:end}.x{text-anchor:middle}\
        .key{fill:var(--c)}.title{font-size:16px;font-weight:700;fill:var(--ink)}.verdict{font-size:16px;font-weight:700;fill:var(--c)}";
    let verdict = &subject.assessed.verdict;
    Some(format!(
        r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 960 380" width="960" height="380"><style>{CHART_CSS}{style}</style><rect width="960" height="380" fill="var(--paper)"/><text class="verdict {}" x="48" y="30">{}</text><text class="title" x="108" y="30">{}</text>{}</svg>
"#,
        verdict_class(verdict),
        verdict,
        Escaped(subject.title()),
        panel.svg(&timeline, [48.0, 70.0, 896.0, 276.0]),
    ))
}

fn page(title: &str, body: &str) -> String {
    format!(
        r#"<!doctype html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width,initial-scale=1">
<meta http-equiv="Content-Security-Policy" content="default-src 'none';style-src 'unsafe-inline';script-src 'unsafe-inline'">
<meta name="color-scheme" content="light dark"><title>{} - flagred</title>
<style>{CHART_CSS}{PAGE_CSS}</style></head><body>
{body}
<p class="soft">Written by flagred {}.</p><div id="now"></div>
<script>{PAGE_JS}</script></body></html>
"#,
        Escaped(title),
        env!("CARGO_PKG_VERSION"),
    )
}

fn verdict_class(verdict: &Verdict) -> &'static str {
    match verdict {
        Verdict::Known(level) => charts::level_class(*level),
        Verdict::NotAvailable(_) => "na",
    }
}

fn badge(verdict: &Verdict) -> String {
    let class = verdict_class(verdict);
    format!(r#"<span class="badge {class}">{}</span>"#, verdict)
}

fn percent(value: Option<f64>) -> String {
    value.map_or("unknown".into(), |value| format!("{value:.0} %"))
}

fn head(subject: &Subject) -> String {
    let mut html = format!(
        "<h1>{} {}</h1><p class=\"soft\">{}</p>",
        badge(&subject.assessed.verdict),
        Escaped(subject.title()),
        Escaped(&words::vehicle(&subject.flight)),
    );
    if !subject.flight.report.is_clean() {
        let damage = words::damage(&subject.flight.report);
        let _ = write!(html, "<p class=\"soft\">{}</p>", Escaped(&damage));
    }
    html
}

fn findings(subject: &Subject) -> String {
    let assessed = &subject.assessed;
    let mut items = String::new();
    if let Verdict::NotAvailable(reason) = &assessed.verdict {
        let text = reason.to_string();
        let _ = write!(items, r#"<li class="na">No verdict: {}"#, Escaped(&text));
        if let Some(help) = reason.help() {
            let _ = write!(items, "<br><span class=\"soft\">{}</span>", Escaped(help));
        }
        items += "</li>";
    }
    for finding in &assessed.findings {
        let _ = write!(
            items,
            r#"<li class="{}"><b>{}</b> {}</li>"#,
            charts::level_class(finding.level),
            finding.level,
            Escaped(&words::describe(finding, &subject.flight.motors)),
        );
    }
    if items.is_empty() {
        items += r#"<li class="good">Nothing reached a threshold.</li>"#;
    }
    format!("<ul class=\"findings\">{items}</ul>")
}

fn figures(subject: &Subject) -> String {
    let summary = &subject.assessed.summary;
    let at = |peak: Option<Peak>| {
        peak.map_or("unknown".into(), |peak| {
            format!("{:.0} % at {:.1} s", peak.value_pct, peak.t_s)
        })
    };
    let share =
        |part_s: f64| percent((summary.in_air_s > 0.0).then(|| 100.0 * part_s / summary.in_air_s));
    let figures = [
        ("Highest risk", at(summary.risk_max)),
        ("Mean risk", percent(summary.risk_mean_pct)),
        ("Highest elevated risk", at(summary.elevated_risk_max)),
        ("In the air", format!("{:.1} s", subject.in_air_s())),
        ("Risk known", share(summary.assessed_s)),
        ("Filled in beside the rules", share(summary.filled_s)),
        (
            "Motors at a limit",
            percent(summary.saturated_share.map(|share| share * 100.0)),
        ),
    ];
    let items: String = figures
        .iter()
        .map(|(name, value)| format!("<div><dt>{name}</dt><dd>{value}</dd></div>"))
        .collect();
    let quiet = "Highest and mean values leave the seconds around take-off and landing out.";
    format!("<dl class=\"figures\">{items}</dl><p class=\"soft\">{quiet}</p>")
}

/// The rules that said most at some time, those that did so longest first; all of them stand in the rule set below.
fn rules(model: &Model, assessed: &Assessment) -> String {
    let known = assessed.steps.iter().filter_map(|step| step.estimate);
    let total = known.clone().count();
    if total == 0 {
        return String::new();
    }
    let mut steps = vec![0usize; model.rules.len()];
    for rule in known.filter_map(|estimate| estimate.dominant_rule) {
        if let Some(steps) = steps.get_mut(rule) {
            *steps += 1;
        }
    }
    let mut said: Vec<_> = model.rules.iter().zip(steps).enumerate().collect();
    said.retain(|(_, (_, steps))| *steps > 0);
    said.sort_by_key(|(_, (_, steps))| std::cmp::Reverse(*steps));
    let mut rows = String::new();
    for (i, (rule, steps)) in &said {
        let share = 100.0 * *steps as f64 / total as f64;
        let shown = if share < 0.5 {
            "&lt; 1".into()
        } else {
            format!("{share:.0}")
        };
        let support = rule.support.map(|n| n.to_string()).unwrap_or_default();
        let _ = write!(
            rows,
            r#"<tr><td class="n">{}</td><td>{}</td><td class="n">{support}</td><td class="n">{shown} % <span class="bar" style="width:{}rem"></span></td></tr>"#,
            i + 1,
            Escaped(&rule.rule.to_string()),
            number(share / 25.0, 2),
        );
    }
    format!(
        r#"<div class="scroll"><table class="rules"><thead><tr><th class="n">#</th><th>Rule</th><th class="n">Support</th><th class="n">Said most</th></tr></thead><tbody>{rows}</tbody></table></div><p class="soft">{} of {} rules said most at some time.</p>"#,
        said.len(),
        model.rules.len(),
    )
}

fn events(timeline: &Timeline) -> String {
    let modes = timeline
        .modes
        .iter()
        .map(|(stretch, name, _)| (stretch.start_s, format!("flight mode {name}")));
    let mut all: Vec<(f64, String)> = modes.chain(timeline.events.iter().cloned()).collect();
    if all.is_empty() {
        return String::new();
    }
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    let rows: String = all
        .iter()
        .map(|(t_s, what)| {
            format!(
                r#"<tr><td class="n">{t_s:.1} s</td><td>{}</td></tr>"#,
                Escaped(what)
            )
        })
        .collect();
    format!("<h2>Events</h2><table class=\"events\"><tbody>{rows}</tbody></table>")
}

/// What was read, and from where.
fn read(subject: &Subject, loaded: &Loaded) -> String {
    let flight = &subject.flight;
    let mut facts: Vec<(String, String)> = vec![
        ("file".into(), subject.name.clone()),
        ("format".into(), flight.format.to_string()),
        (
            "read".into(),
            format!(
                "{} bytes, {} messages; {} bytes skipped, {} messages thrown away{}",
                flight.report.bytes,
                flight.report.messages,
                flight.report.skipped_bytes,
                flight.report.bad_messages,
                if flight.report.truncated {
                    "; cut off at the end"
                } else {
                    ""
                }
            ),
        ),
        (
            "vehicle".into(),
            format!("{} ({})", flight.vehicle.kind, flight.vehicle.source),
        ),
    ];
    let mut add = |name: &str, value: Option<String>| {
        facts.extend(value.map(|value| (name.to_owned(), value)));
    };
    add("damage", flight.report.reason.clone());
    add("frame", flight.vehicle.frame.clone());
    add("firmware", flight.vehicle.firmware.clone());
    for motor in &flight.motors {
        let value = format!("output {} ({})", motor.output, motor.source);
        add(&format!("motor {}", motor.number), Some(value));
    }
    let rate = flight.command_rate_hz();
    add(
        "motor commands",
        rate.map(|hz| format!("{} rows, {hz:.1} Hz", flight.commands.len())),
    );
    let range = |range: &flightlog::Range| {
        let unit = if range.unit == "1" { "" } else { range.unit };
        format!(
            "{} to {} {unit} ({})",
            number(range.low, 3),
            number(range.high, 3),
            range.source
        )
    };
    add("range", flight.range.as_ref().map(range));
    add("effective range", Some(range(&flight.effective)));
    for (name, spans) in [("armed", &flight.armed), ("in the air", &flight.in_air)] {
        let value = spans
            .as_ref()
            .map(|spans| format!("{:.1} s ({})", spans.duration_s(), spans.rule));
        add(
            name,
            Some(value.unwrap_or("unknown: the log does not tell".into())),
        );
    }
    for name in loaded
        .estimator
        .profile()
        .signals()
        .into_iter()
        .chain(charts::SIGNALS)
    {
        let value = flight.signal(name).map(|signal| {
            let rate = signal
                .rate_hz()
                .map_or(String::new(), |hz| format!(", {hz:.1} Hz"));
            format!("{}{rate}", signal.label.source)
        });
        add(name, Some(value.unwrap_or("not in the log".into())));
    }
    let rows: String = facts
        .iter()
        .map(|(name, value)| {
            format!(
                "<tr><th>{}</th><td>{}</td></tr>",
                Escaped(name),
                Escaped(value)
            )
        })
        .collect();
    format!(
        "<h2>What was read, and from where</h2><table class=\"facts\"><tbody>{rows}</tbody></table>"
    )
}

/// The profile and the rule set as they were written.
fn texts(loaded: &Loaded) -> String {
    format!(
        "<h2>Profile</h2><pre>{}</pre><h2>Rule set</h2><pre>{}</pre>",
        Escaped(&loaded.profile_text),
        Escaped(&loaded.rules_text)
    )
}
