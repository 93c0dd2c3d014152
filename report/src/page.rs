//! The report of one flight, or a comparison of several, as one HTML file that needs nothing beside it.

use std::sync::Arc;

use flagred::{
    flight::{Assessment, Peak, Verdict},
    loaded::Loaded,
};
use flightlog::Flight;
use fuzzy::{
    Model,
    drawing::{CSS, Escaped, Frame, Panel, Sheet, Timeline, number, visible_lines},
};
use maud::{DOCTYPE, Markup, PreEscaped, html};

use crate::{
    charts, decision,
    finding::{self, Teller},
    panel::panel,
    words,
};

const CHART_CSS: &str = include_str!("chart.css");
const PAGE_CSS: &str = include_str!("page.css");
const PAGE_JS: &str = include_str!("page.js");
/// The page may load nothing: all that it shows is within it.
const POLICY: &str = "default-src 'none';style-src 'unsafe-inline';script-src 'unsafe-inline'";

/// One flight that was assessed.
pub struct Subject {
    /// The name of its file.
    pub name: String,
    /// The flight.
    pub flight: Arc<Flight>,
    /// What is said of it.
    pub assessed: Assessment,
}

impl Subject {
    /// The file name without its folders.
    fn title(&self) -> &str {
        let file = std::path::Path::new(&self.name).file_name();
        file.and_then(|file| file.to_str()).unwrap_or(&self.name)
    }

    fn in_air_s(&self) -> f64 {
        self.assessed.summary.in_air_s
    }
}

/// The report of one flight.
pub fn report(subject: &Subject, loaded: &Loaded) -> String {
    let Subject {
        flight, assessed, ..
    } = subject;
    let estimator = &loaded.estimator;
    let model = estimator.model();
    let timeline = charts::timeline(flight, assessed);
    let stretch = timeline.stretch;
    let risk = charts::risk(assessed, estimator, stretch);
    let margins = charts::margins(flight, assessed, estimator, stretch);
    let motors = margins.into_iter();
    let motors = motors.chain(charts::motors(flight, estimator, stretch));
    let attitude = charts::attitude_error(flight, estimator, stretch).into_iter();
    let attitude = attitude.chain(charts::battery(flight, estimator, stretch));
    let limits = "The command of each motor on its full range. The dashed lines are the limits.";
    let body = html! {
        h1 { (badge(&assessed.verdict)) " " (subject.title()) }
        p.soft { (words::vehicle(flight)) }
        @if !flight.report.is_clean() {
            p.soft { (words::damage(&flight.report)) }
        }
        @for note in words::notes(flight, assessed) { p.soft { (note) } }
        (findings(subject, model))
        (figures(subject))
        (section("Risk over time", "", risk, &timeline))
        @if let Some(map) = decision::map(estimator, model, &assessed.steps) {
            h2 { "The rules and their inputs" }
            (map)
        }
        @for (i, input) in charts::inputs(assessed, estimator, model, stretch) {
            (panel(&input, &timeline, Some(i)))
        }
        (rules(model, assessed))
        (section("Motors", limits, motors, &timeline))
        (section("Attitude and battery", "", attitude, &timeline))
        (events(&timeline))
        (sources(subject, loaded))
        (texts(loaded))
    };
    page(subject.title(), &body)
}

/// A heading with a note and panels; nothing without panels.
fn section(
    title: &str,
    note: &str,
    panels: impl IntoIterator<Item = Panel>,
    timeline: &Timeline,
) -> Markup {
    let panels: Vec<Panel> = panels.into_iter().collect();
    html! {
        @if !panels.is_empty() {
            h2 { (title) }
            @if !note.is_empty() { p.soft { (note) } }
            @for one in panels { (panel(&one, timeline, None)) }
        }
    }
}

/// A comparison of several flights on one scale of time.
pub fn comparison(subjects: &[Subject], loaded: &Loaded) -> String {
    let timelines = subjects
        .iter()
        .map(|s| charts::timeline(&s.flight, &s.assessed));
    let mut timelines: Vec<Timeline> = timelines.collect();
    let lengths = timelines.iter().map(|timeline| timeline.stretch.length_s());
    let longest_s = lengths.fold(0.0, f64::max);
    for Timeline { stretch, .. } in &mut timelines {
        stretch.end_s = stretch.start_s + longest_s;
    }
    let title = format!("{} flights compared", subjects.len());
    let peak = |peak: Option<Peak>| percent(peak.map(|peak| peak.value_pct));
    let body = html! {
        h1 { (title) }
        p.soft {
            "All curves have the same scale of time, " (number(longest_s, 0)) " s. "
            code { "flagred assess LOG --html FILE" } " writes the whole report of one flight."
        }
        .scroll { table {
            thead { tr {
                th { "Verdict" } th { "Flight" } th.n { "In the air" } th.n { "Mean risk" }
                th.n { "Highest" } th.n { "Elevated" } th.n { "At a limit" } th.n { "Findings" }
            } }
            tbody {
                @for (i, subject) in subjects.iter().enumerate() {
                    @let summary = &subject.assessed.summary;
                    tr {
                        td { (badge(&subject.assessed.verdict)) }
                        td.name { a href={ "#flight" (i) } { (subject.title()) } }
                        td.n { (number(subject.in_air_s(), 0)) " s" }
                        td.n { (percent(summary.risk_mean_pct)) }
                        td.n { (peak(summary.risk_max)) }
                        td.n { (peak(summary.elevated_risk_max)) }
                        td.n { (share(summary.saturated_share)) }
                        td.n { (subject.assessed.findings.len()) }
                    }
                }
            }
        } }
        @for (i, (subject, timeline)) in subjects.iter().zip(&timelines).enumerate() {
            section id={ "flight" (i) } {
                h2 { (badge(&subject.assessed.verdict)) " " (subject.title()) }
                p.soft { (words::vehicle(&subject.flight)) }
                @for note in words::notes(&subject.flight, &subject.assessed) { p.soft { (note) } }
                (findings(subject, loaded.estimator.model()))
                @if let Some(risk) = charts::risk(&subject.assessed, &loaded.estimator, timeline.stretch) {
                    (panel(&risk, timeline, None))
                }
            }
        }
        (texts(loaded))
    };
    page(&title, &body)
}

/// The risk over time as an SVG file; `None` where no risk is known.
pub fn svg(subject: &Subject, loaded: &Loaded) -> Option<String> {
    const STYLE: &str = "text{font:12px system-ui,sans-serif;fill:var(--soft)}.y{text-anchor:end}.x{text-anchor:middle}\
        .key{fill:var(--c)}.title{font-size:16px;font-weight:700;fill:var(--ink)}.verdict{font-size:16px;font-weight:700;fill:var(--c)}";
    let timeline = charts::timeline(&subject.flight, &subject.assessed);
    let risk = charts::risk(&subject.assessed, &loaded.estimator, timeline.stretch)?;
    let verdict = &subject.assessed.verdict;
    let frame = Frame {
        left: 48.0,
        top: 70.0,
        width: 896.0,
        height: 276.0,
    };
    let mut sheet = Sheet::styled(960.0, 380.0, [CSS, CHART_CSS, STYLE].concat());
    sheet.push(format_args!(
        r#"<text class="verdict {}" x="48" y="30">{}</text><text class="title" x="108" y="30">{}</text>{}"#,
        verdict_class(verdict),
        verdict,
        Escaped(subject.title()),
        risk.svg(&timeline, frame),
    ));
    Some(sheet.finish(&format!("{verdict} {}", subject.title())))
}

/// A page that looks like a report, around a body that the caller wrote as HTML: it may load nothing, and shows no control
/// characters.
pub fn around(title: &str, body: String) -> String {
    page(title, &PreEscaped(body))
}

/// A page that needs nothing beside it.
pub fn page(title: &str, body: &Markup) -> String {
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width,initial-scale=1";
                meta http-equiv="Content-Security-Policy" content=(POLICY);
                meta name="color-scheme" content="light dark";
                title { (title) " - flagred" }
                style { (PreEscaped(CSS)) (PreEscaped(CHART_CSS)) (PreEscaped(PAGE_CSS)) }
            }
            body {
                (body)
                p.soft { "Written by flagred " (env!("CARGO_PKG_VERSION")) "." }
                #now {}
                script { (PreEscaped(PAGE_JS)) }
            }
        }
    };
    // HTML has no control characters, and a log must not turn the direction of writing.
    visible_lines(&page.into_string()).into_owned()
}

fn verdict_class(verdict: &Verdict) -> &'static str {
    match verdict {
        Verdict::Known(level) => charts::level_class(*level),
        Verdict::NotAvailable(_) => "na",
    }
}

fn badge(verdict: &Verdict) -> Markup {
    html! { span.badge.(verdict_class(verdict)) { (verdict) } }
}

fn percent(value: Option<f64>) -> String {
    value.map_or("unknown".into(), |value| format!("{value:.0} %"))
}

fn share(value: Option<f64>) -> String {
    percent(value.map(|share| 100.0 * share))
}

/// One line a cause, with the details of its worst finding.
fn findings(subject: &Subject, model: &Model) -> Markup {
    let assessed = &subject.assessed;
    let teller = Teller {
        model,
        motors: &subject.flight.motors,
    };
    let unknown = match &assessed.verdict {
        Verdict::NotAvailable(reason) => Some(reason),
        Verdict::Known(_) => None,
    };
    html! {
        ul.findings {
            @if let Some(reason) = unknown {
                li.na {
                    "No verdict: " (reason)
                    @if let Some(help) = reason.help() { br; span.soft { (help) } }
                }
            }
            @for line in finding::lines(&assessed.findings) {
                li.(charts::level_class(line.worst.level)) {
                    b { (line.worst.level) } " " (teller.line(&line))
                    br;
                    span.soft { (teller.details(line.worst)) }
                }
            }
            @if unknown.is_none() && assessed.findings.is_empty() {
                li.good { "No threshold was reached." }
            }
        }
    }
}

fn figures(subject: &Subject) -> Markup {
    let summary = &subject.assessed.summary;
    let at = |peak: Option<Peak>| {
        peak.map_or("unknown".into(), |peak| {
            format!("{:.0} % at {:.1} s", peak.value_pct, peak.t_s)
        })
    };
    let of_air = |part_s: f64| share((summary.in_air_s > 0.0).then(|| part_s / summary.in_air_s));
    let figures = [
        ("Highest risk", at(summary.risk_max)),
        ("Mean risk", percent(summary.risk_mean_pct)),
        ("Highest elevated risk", at(summary.elevated_risk_max)),
        ("In the air", format!("{:.1} s", subject.in_air_s())),
        ("Risk known", of_air(summary.assessed_s)),
        ("Risk interpolated", of_air(summary.filled_s)),
        ("Motors at a limit", share(summary.saturated_share)),
    ];
    html! {
        dl.figures {
            @for (name, value) in figures { div { dt { (name) } dd { (value) } } }
        }
        p.soft { "The highest and mean values are without the seconds around take-off and landing." }
    }
}

/// The rules that were dominant at some point, and how much of the time; all rules are in the rule set below.
fn rules(model: &Model, assessed: &Assessment) -> Markup {
    let known = assessed.steps.iter().filter_map(|step| step.estimate);
    let total = known.clone().count();
    let mut steps = vec![0usize; model.rules.len()];
    for rule in known.filter_map(|estimate| estimate.dominant_rule) {
        if let Some(steps) = steps.get_mut(rule) {
            *steps += 1;
        }
    }
    let mut dominant: Vec<_> = model.rules.iter().zip(steps).enumerate().collect();
    dominant.retain(|(_, (_, steps))| *steps > 0);
    dominant.sort_by_key(|(_, (_, steps))| std::cmp::Reverse(*steps));
    let percent = |steps: usize| 100.0 * steps as f64 / total as f64;
    html! {
        @if total > 0 {
            .scroll { table.rules {
                thead { tr { th.n { "#" } th { "Rule" } th.n { "Support" } th.n { "Dominant" } } }
                tbody {
                    @for (i, (rule, steps)) in &dominant {
                        tr {
                            td.n { (i + 1) }
                            td { (rule.rule.to_string()) }
                            td.n { @if let Some(support) = rule.support { (support) } }
                            td.n {
                                @if percent(*steps) < 0.5 { "< 1 % " } @else { (format!("{:.0} % ", percent(*steps))) }
                                span.bar style={ "width:" (number(percent(*steps) / 25.0, 2)) "rem" } {}
                            }
                        }
                    }
                }
            } }
            p.soft { (dominant.len()) " of " (model.rules.len()) " rules were dominant at some point." }
        }
    }
}

fn events(timeline: &Timeline) -> Markup {
    let phases = timeline.phases.iter();
    let phases = phases.map(|phase| (phase.stretch.start_s, format!("flight mode {}", phase.name)));
    let mut all: Vec<(f64, String)> = phases.chain(timeline.events.iter().cloned()).collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    html! {
        @if !all.is_empty() {
            h2 { "Events" }
            table.events { tbody {
                @for (t_s, what) in all {
                    tr { td.n { (format!("{t_s:.1} s")) } td { (what) } }
                }
            } }
        }
    }
}

/// What was read from the log, and from which message or parameter.
fn sources(subject: &Subject, loaded: &Loaded) -> Markup {
    let flight = &subject.flight;
    let report = &flight.report;
    let end = if report.truncated {
        "; cut off at the end"
    } else {
        ""
    };
    let read = format!(
        "{} bytes, {} messages; {} bytes and {} messages skipped{end}",
        report.bytes, report.messages, report.skipped_bytes, report.bad_messages,
    );
    let vehicle = format!("{} ({})", flight.vehicle.kind, flight.vehicle.source);
    let mut facts = vec![
        ("file".to_owned(), subject.name.clone()),
        ("format".into(), flight.format.to_string()),
        ("read".into(), read),
        ("vehicle".into(), vehicle),
    ];
    let mut add = |name: &str, value: Option<String>| {
        facts.extend(value.map(|value| (name.to_owned(), value)));
    };
    add("damage", report.reason.clone());
    add("frame", flight.vehicle.frame.clone());
    add("firmware", flight.vehicle.firmware.clone());
    for motor in &flight.motors {
        let value = format!("output {} ({})", motor.output, motor.source);
        add(&format!("motor {}", motor.number), Some(value));
    }
    let rate = flight.command_rate_hz();
    let rate = rate.map(|hz| format!("{} rows, {hz:.1} Hz", flight.commands.len()));
    add("motor commands", rate);
    let range = |range: &flightlog::Range| {
        let unit = if range.unit == "1" { "" } else { range.unit };
        let (low, high) = (number(range.low, 3), number(range.high, 3));
        format!("{low} to {high} {unit} ({})", range.source)
    };
    add("range", flight.range.as_ref().map(range));
    add("effective range", Some(range(&flight.effective)));
    for parameter in &flight.parameters {
        let value = format!("{} ({})", number(parameter.value, 6), parameter.source);
        add(&parameter.name, Some(value));
    }
    for (name, spans) in [("armed", &flight.armed), ("in the air", &flight.in_air)] {
        let value = spans.as_ref();
        let value = value.map(|spans| format!("{:.1} s ({})", spans.duration_s(), spans.rule));
        add(
            name,
            Some(value.unwrap_or("unknown: not in the log".into())),
        );
    }
    let signals = loaded.estimator.profile().signals();
    for name in signals.into_iter().chain(charts::SIGNALS) {
        let value = flight.signal(name).map(|signal| {
            let rate = signal.rate_hz().map(|hz| format!(", {hz:.1} Hz"));
            format!("{}{}", signal.label.source, rate.unwrap_or_default())
        });
        add(name, Some(value.unwrap_or("not in the log".into())));
    }
    html! {
        h2 { "What was read from the log" }
        table.facts { tbody {
            @for (name, value) in facts { tr { th { (name) } td { (value) } } }
        } }
    }
}

/// The profile and the rule set as they are written.
fn texts(loaded: &Loaded) -> Markup {
    html! {
        h2 { "Profile" } pre { (loaded.profile_text) }
        h2 { "Rule set" } pre { (loaded.rules_text) }
    }
}
