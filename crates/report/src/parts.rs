//! The parts of the report of one flight; each can be rendered separately, and for any stretch of time.

use flagred::{flight::Assessment, loaded::Loaded};
use fuzzy::{
    Model,
    drawing::{number, visible_lines},
};
use maud::{Markup, html};

use crate::{
    available, charts,
    clock::Clock,
    curve::Stretch,
    decision,
    head::{about, head},
    panel::panel,
    sources::sources,
    subject::Subject,
    timeline::{Panel, Timeline},
    track,
};

/// The parts of a report.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// Verdict and findings.
    Head,
    /// Figures, vehicle and limitations of the verdict.
    About,
    /// Risk over time.
    Risk,
    /// The track over ground.
    Track,
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
    /// All signals of the log, folded.
    Signals,
    /// The data that was read from the log.
    Sources,
    /// The texts of the profile and of the rule set.
    Texts,
}

impl Part {
    /// All parts, in their order on the page.
    pub const ALL: [Part; 13] = [
        Part::Head,
        Part::About,
        Part::Risk,
        Part::Track,
        Part::Map,
        Part::Inputs,
        Part::Rules,
        Part::Motors,
        Part::Attitude,
        Part::Events,
        Part::Signals,
        Part::Sources,
        Part::Texts,
    ];

    /// The name of the part, for use by programs.
    pub fn name(self) -> &'static str {
        match self {
            Part::Head => "head",
            Part::About => "about",
            Part::Risk => "risk",
            Part::Track => "track",
            Part::Map => "map",
            Part::Inputs => "inputs",
            Part::Rules => "rules",
            Part::Motors => "motors",
            Part::Attitude => "attitude",
            Part::Events => "events",
            Part::Signals => "signals",
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

    /// Renders the curves of the signals with the given names; signals that the log does not have are left out.
    pub fn signals(&self, names: &[String]) -> String {
        let (flight, estimator) = (&self.subject.flight, &self.loaded.estimator);
        shown(available::panels(flight, estimator, &self.timeline, names))
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
            Part::About => about(subject, loaded),
            Part::Risk => {
                let risk = charts::risk(assessed, estimator, stretch);
                section("Risk over time", "", risk, timeline)
            }
            Part::Track => html! {
                @if let Some(map) = track::map(flight, assessed, subject.stretch()) {
                    h2 { "Track over ground" }
                    (map)
                }
            },
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
            Part::Signals => available::folded(flight, estimator, timeline),
            Part::Sources => sources(subject, loaded),
            Part::Texts => texts(loaded),
        }
    }
}

/// Converts markup to text with hidden characters made visible: HTML allows no control characters, and text from a log
/// must not change the direction of writing.
pub(crate) fn shown(markup: Markup) -> String {
    visible_lines(&markup.into_string()).into_owned()
}

/// Renders a heading with a note and panels; empty if there are no panels.
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

/// The rules that were dominant at some time, each with its share of the time, and the rules that findings name. The part
/// [`Part::Texts`] contains all rules.
fn rules(model: &Model, assessed: &Assessment) -> Markup {
    let known = assessed.steps.iter().filter_map(|step| step.estimate);
    let total = known.clone().count();
    let mut steps = vec![0usize; model.rules.len()];
    for rule in known.filter_map(|estimate| estimate.dominant_rule) {
        if let Some(steps) = steps.get_mut(rule) {
            *steps += 1;
        }
    }
    let dominant = steps.iter().filter(|steps| **steps > 0).count();
    let causes = assessed
        .findings
        .iter()
        .filter_map(|finding| finding.cause.as_ref());
    let named: Vec<usize> = causes.map(|cause| cause.rule).collect();
    let mut listed: Vec<_> = model.rules.iter().zip(steps).enumerate().collect();
    listed.retain(|(rule, (_, steps))| *steps > 0 || named.contains(rule));
    listed.sort_by_key(|(_, (_, steps))| std::cmp::Reverse(*steps));
    let percent = |steps: usize| 100.0 * steps as f64 / total as f64;
    html! {
        @if total > 0 {
            .scroll { table.rules {
                thead { tr { th.n { "#" } th { "Rule" } th.n { "Support" } th.n { "Dominant" } } }
                tbody {
                    @for (i, (rule, steps)) in &listed {
                        tr {
                            td.n { (i + 1) }
                            td { (rule.rule.to_string()) }
                            td.n { @if let Some(support) = rule.support { (support) } }
                            td.n {
                                @if *steps == 0 { "never " }
                                @else if percent(*steps) < 0.5 { "< 1 % " }
                                @else { (format!("{:.0} % ", percent(*steps))) }
                                span.bar style={ "width:" (number(percent(*steps) / 25.0, 2)) "rem" } {}
                            }
                        }
                    }
                }
            } }
            p.soft {
                (dominant) " of " (model.rules.len()) " rules were dominant at some point."
                @if listed.len() > dominant { " The others in the table are rules that findings name." }
            }
        }
    }
}

fn events(timeline: &Timeline) -> Markup {
    let clock = Clock::Since(timeline.zero_s);
    let phases = timeline.phases.iter();
    let phases = phases.map(|phase| (phase.stretch.start_s, format!("flight mode {}", phase.name)));
    let mut all: Vec<(f64, String)> = phases.chain(timeline.events.iter().cloned()).collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    html! {
        @if !all.is_empty() {
            h2 { "Events" }
            p.soft { "The time since take-off, and at the right the time on the log's clock." }
            table.events { tbody {
                @for (t_s, what) in all {
                    tr { td.n { (clock.at(t_s)) } td { (what) } td.n.soft { (Clock::Log.at(t_s)) } }
                }
            } }
        }
    }
}

/// Renders the source text of the profile and of the rule set.
pub(crate) fn texts(loaded: &Loaded) -> Markup {
    html! {
        h2 { "Profile" } pre { (loaded.profile.text()) }
        h2 { "Rule set" } pre { (loaded.rules.text()) }
    }
}
