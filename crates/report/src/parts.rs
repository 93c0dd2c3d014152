//! The parts of the report of one flight; each can be rendered alone, and for any stretch of time.

use std::sync::Arc;

use flagred::{
    estimator::Estimator,
    flight::{Assessment, Peak, Verdict},
    loaded::Loaded,
    profile::{Followed, Reliability},
};
use flagred_flightlog::Flight;
use fuzzy::{
    Model,
    drawing::{number, visible_lines},
};
use maud::{Markup, html};

use crate::{
    charts,
    curve::Stretch,
    decision,
    finding::{self, Teller},
    panel::panel,
    timeline::{Panel, Timeline},
    words,
};

/// An assessed flight.
pub struct Subject {
    /// The name of the file of the log.
    pub name: String,
    /// The flight.
    pub flight: Arc<Flight>,
    /// The assessment of the flight.
    pub assessed: Assessment,
}

impl Subject {
    /// The file name without its folders.
    pub(crate) fn title(&self) -> &str {
        let file = std::path::Path::new(&self.name).file_name();
        file.and_then(|file| file.to_str()).unwrap_or(&self.name)
    }

    /// The time that a report shows by default: from the first take-off to the last landing, or the
    /// whole log if there is none.
    pub fn stretch(&self) -> Stretch {
        charts::stretch(&self.flight)
    }

    pub(crate) fn in_air_s(&self) -> f64 {
        self.assessed.summary.in_air_s
    }
}

/// The parts of a report.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// Verdict, vehicle, findings and figures.
    Head,
    /// Risk over time.
    Risk,
    /// The flight on the decision map.
    Map,
    /// The inputs of the rules over time.
    Inputs,
    /// The rules that were dominant.
    Rules,
    /// The motors and their margins over time.
    Motors,
    /// Attitude and battery over time.
    Attitude,
    /// Flight modes and messages.
    Events,
    /// The data that was read from the log.
    Sources,
    /// Profile and rule set.
    Texts,
}

impl Part {
    /// All parts, in their order on the page.
    pub const ALL: [Part; 10] = [
        Part::Head,
        Part::Risk,
        Part::Map,
        Part::Inputs,
        Part::Rules,
        Part::Motors,
        Part::Attitude,
        Part::Events,
        Part::Sources,
        Part::Texts,
    ];

    /// The name of the part in programs.
    pub fn name(self) -> &'static str {
        match self {
            Part::Head => "head",
            Part::Risk => "risk",
            Part::Map => "map",
            Part::Inputs => "inputs",
            Part::Rules => "rules",
            Part::Motors => "motors",
            Part::Attitude => "attitude",
            Part::Events => "events",
            Part::Sources => "sources",
            Part::Texts => "texts",
        }
    }
}

/// The report of one flight, rendered part by part.
pub struct Report<'a> {
    subject: &'a Subject,
    loaded: &'a Loaded,
    timeline: Timeline,
}

impl<'a> Report<'a> {
    /// Creates a report with curves of a stretch of time, or of the whole flight.
    pub fn new(subject: &'a Subject, loaded: &'a Loaded, stretch: Option<Stretch>) -> Report<'a> {
        let whole = subject.stretch();
        let stretch = stretch.map_or(whole, |part| charts::within(part, whole));
        Report {
            timeline: charts::timeline(&subject.flight, &subject.assessed, stretch),
            subject,
            loaded,
        }
    }

    /// Renders a part as HTML; empty if there is nothing to show.
    pub fn part(&self, part: Part) -> String {
        shown(self.markup(part))
    }

    pub(crate) fn markup(&self, part: Part) -> Markup {
        let Report {
            subject,
            loaded,
            timeline,
        } = self;
        let (flight, assessed) = (&*subject.flight, &subject.assessed);
        let estimator = &loaded.estimator;
        let model = estimator.model();
        let stretch = timeline.stretch;
        match part {
            Part::Head => head(subject, loaded),
            Part::Risk => {
                let risk = charts::risk(assessed, estimator, stretch);
                section("Risk over time", "", risk, timeline)
            }
            Part::Map => html! {
                @if let Some(map) = decision::map(estimator, model, &assessed.steps) {
                    h2 { "The rules and their inputs" }
                    (map)
                }
            },
            Part::Inputs => html! {
                @for (i, input) in charts::inputs(assessed, estimator, model, stretch) {
                    (panel(&input, timeline, Some(i)))
                }
            },
            Part::Rules => rules(model, assessed),
            Part::Motors => {
                let margins = charts::margins(flight, assessed, estimator, stretch);
                let motors = charts::motors(flight, estimator, stretch);
                let limits =
                    "The command of each motor on its full range. The dashed lines are the limits.";
                section(
                    "Motors",
                    limits,
                    margins.into_iter().chain(motors),
                    timeline,
                )
            }
            Part::Attitude => {
                let attitude = charts::attitude_error(flight, estimator, stretch).into_iter();
                let panels = attitude.chain(charts::battery(flight, estimator, stretch));
                section("Attitude and battery", "", panels, timeline)
            }
            Part::Events => events(timeline),
            Part::Sources => sources(subject, loaded),
            Part::Texts => texts(loaded),
        }
    }
}

/// Converts markup to text. HTML allows no control characters, and text from a log must not change the direction of
/// writing.
pub(crate) fn shown(markup: Markup) -> String {
    visible_lines(&markup.into_string()).into_owned()
}

/// Verdict, vehicle, limitations of the verdict, findings and figures.
fn head(subject: &Subject, loaded: &Loaded) -> Markup {
    let Subject {
        flight, assessed, ..
    } = subject;
    html! {
        h1 { (badge(&assessed.verdict)) " " (subject.title()) }
        p.soft { (words::vehicle(flight)) }
        @if !flight.report.is_clean() {
            p.soft { (words::damage(&flight.report)) }
        }
        @for note in words::notes(flight, assessed) { p.soft { (note) } }
        (findings(subject, &loaded.estimator))
        (figures(subject))
        (reliability(&loaded.estimator.profile().reliability))
    }
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

pub(crate) fn verdict_class(verdict: &Verdict) -> &'static str {
    match verdict {
        Verdict::Known(level) => charts::level_class(*level),
        Verdict::NotAvailable(_) => "na",
    }
}

pub(crate) fn badge(verdict: &Verdict) -> Markup {
    html! { span.badge.(verdict_class(verdict)) { (verdict) } }
}

/// The heading for the time in which vehicles are assessed.
pub(crate) fn in_the_air(has_motors: bool) -> &'static str {
    match has_motors {
        true => "In the air",
        false => "In use",
    }
}

pub(crate) fn percent(value: Option<f64>) -> String {
    value.map_or("unknown".into(), |value| format!("{value:.0} %"))
}

pub(crate) fn share(value: Option<f64>) -> String {
    percent(value.map(|share| 100.0 * share))
}

/// One line for each cause, with the details of its worst finding.
pub(crate) fn findings(subject: &Subject, estimator: &Estimator) -> Markup {
    let assessed = &subject.assessed;
    let teller = Teller {
        estimator,
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
                li.(charts::level_class(line.worst.severity)) {
                    b { (line.worst.severity) } " " (teller.line(&line))
                    br;
                    (teller.words(line.worst).advice)
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
    let has_motors = !subject.flight.motors.is_empty();
    let figures = [
        ("Highest risk", at(summary.risk_max)),
        ("Mean risk", percent(summary.risk_mean_pct)),
        ("Highest elevated risk", at(summary.elevated_risk_max)),
        (
            in_the_air(has_motors),
            format!("{:.1} s", subject.in_air_s()),
        ),
        ("Risk known", of_air(summary.assessed_s)),
        ("Risk interpolated", of_air(summary.filled_s)),
    ];
    let at_limit = has_motors.then(|| ("Motors at a limit", share(summary.saturated_share)));
    html! {
        dl.figures {
            @for (name, value) in figures.into_iter().chain(at_limit) { div { dt { (name) } dd { (value) } } }
        }
        @if has_motors {
            p.soft { "The highest and mean values exclude the seconds around take-off and landing." }
        } @else {
            p.soft { "The highest and mean values exclude the first seconds in use and the last seconds before a stop." }
        }
    }
}

/// How often large attitude errors followed a risk, if it was measured.
fn reliability(rows: &[Reliability]) -> Markup {
    let of = |counts: Option<Followed>| counts.and_then(words::share).unwrap_or("unknown".into());
    html! {
        @if !rows.is_empty() {
            details {
                summary { "How sure a risk is" }
                p.soft {
                    "The share of moments with such a risk that were followed by an attitude error over 5 degrees within 5 s, on the flights that the rules were tested on."
                }
                table.rules {
                    thead { tr { th.n { "Risk" } th.n { "Real vehicles" } th.n { "Simulated vehicles" } } }
                    tbody {
                        @for row in rows {
                            tr {
                                td.n { (row.from_pct) " to " (row.to_pct) " %" }
                                td.n { (of(row.real)) }
                                td.n { (of(row.simulated)) }
                            }
                        }
                    }
                }
            }
        }
    }
}

/// The rules that were dominant at some time, and for which share of the time; all rules are in the rule set below.
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

/// The data that was read from the log, with the message or parameter that contained it.
fn sources(subject: &Subject, loaded: &Loaded) -> Markup {
    let flight = &subject.flight;
    let report = &flight.report;
    let end = if report.truncated {
        "; the end is missing"
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
    let range = |range: &flagred_flightlog::Range| {
        let unit = if range.unit == "1" { "" } else { range.unit };
        let (low, high) = (number(range.low, 3), number(range.high, 3));
        format!("{low} to {high} {unit} ({})", range.source)
    };
    add("range", flight.range.as_ref().map(range));
    let has_motors = !flight.motors.is_empty();
    let effective = has_motors.then(|| range(&flight.effective_range));
    add("effective range", effective);
    for parameter in &flight.parameters {
        let value = format!("{} ({})", number(parameter.value, 6), parameter.source);
        add(&parameter.name, Some(value));
    }
    let armed = has_motors.then_some(("armed", &flight.armed));
    let air = (words::in_the_air(flight), &flight.in_air);
    for (name, spans) in armed.into_iter().chain([air]) {
        let value = spans.as_ref();
        let value = value.map(|spans| format!("{:.1} s ({})", spans.duration_s(), spans.rule));
        add(
            name,
            Some(value.unwrap_or("unknown: not in the log".into())),
        );
    }
    let signals = loaded.estimator.profile().signals();
    let drawn = charts::SIGNALS.into_iter();
    let drawn = drawn.filter(|name| has_motors || flight.signal(name).is_some());
    for name in signals.into_iter().chain(drawn) {
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

/// The source of the profile and of the rule set.
pub(crate) fn texts(loaded: &Loaded) -> Markup {
    html! {
        h2 { "Profile" } pre { (loaded.profile.text()) }
        h2 { "Rule set" } pre { (loaded.rules.text()) }
    }
}
