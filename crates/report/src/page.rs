//! HTML pages: the report of one flight, and the comparison of several flights, each as one self-contained file; also
//! the parts that programs embed in their own pages.

use flagred::{flight::Peak, loaded::Loaded};
use fuzzy::drawing::{EscapedText, Frame, SvgDocument};
use maud::{DOCTYPE, Markup, PreEscaped, html};

use crate::{
    charts,
    clock::minutes,
    curve::Stretch,
    finding::highest,
    head::{badge, findings, in_the_air, percent, share, verdict_class},
    panel::panel,
    parts::{shown, texts},
    timeline::{CSS, Timeline},
    words,
};

pub use crate::{
    parts::{Part, Report},
    subject::Subject,
};

const CHART_CSS: &str = include_str!("chart.css");
const PAGE_CSS: &str = include_str!("page.css");
const PAGE_JS: &str = include_str!("page.js");
/// The content security policy: the page loads nothing, because it contains everything that it
/// shows.
const POLICY: &str = "default-src 'none';style-src 'unsafe-inline';script-src 'unsafe-inline'";

/// The report of one flight.
pub fn report(subject: &Subject, loaded: &Loaded) -> String {
    let report = Report::new(subject, loaded, None);
    let body = html! {
        @for part in Part::ALL { (report.markup(part)) }
    };
    page(subject.title(), &body)
}

/// A comparison of several flights on a common time scale.
pub fn comparison(subjects: &[&Subject], loaded: &Loaded) -> String {
    page(
        &together(subjects),
        &comparison_body(subjects, loaded, None),
    )
}

/// Only the body of [`comparison`], for a stretch of time since the start of each flight, or for all of it.
pub fn comparison_fragment(
    subjects: &[&Subject],
    loaded: &Loaded,
    since_start: Option<Stretch>,
) -> String {
    shown(comparison_body(subjects, loaded, since_start))
}

/// The length of the longest of the flights, in seconds. A comparison shows a stretch of this length for each flight.
pub fn longest_s(subjects: &[&Subject]) -> f64 {
    let lengths = subjects.iter().map(|subject| subject.stretch().length_s());
    lengths.fold(0.0, f64::max)
}

fn together(subjects: &[&Subject]) -> String {
    format!("{} flights compared", subjects.len())
}

fn comparison_body(subjects: &[&Subject], loaded: &Loaded, since_start: Option<Stretch>) -> Markup {
    let longest_s = longest_s(subjects);
    let all = Stretch {
        start_s: 0.0,
        end_s: longest_s,
    };
    let since_start = since_start.map_or(all, |part| charts::within(part, all));
    let timelines = subjects.iter().map(|subject| {
        let whole = subject.stretch();
        let stretch = Stretch {
            start_s: whole.start_s + since_start.start_s,
            end_s: whole.start_s + since_start.end_s,
        };
        charts::timeline(&subject.flight, &subject.assessed, stretch)
    });
    let timelines: Vec<Timeline> = timelines.collect();
    let peak = |peak: Option<Peak>| percent(peak.map(|peak| peak.value_pct));
    let mut flights = subjects.iter().map(|subject| &subject.flight);
    let has_motors = flights.any(|flight| !flight.motors.is_empty());
    html! {
        h1 { (together(subjects)) }
        p.soft {
            "All curves have the same time scale, " (minutes(longest_s, 0)) " min. "
            code { "flagred assess LOG --html FILE" } " writes the whole report of one flight."
        }
        .scroll { table {
            thead { tr {
                th { "Verdict" } th { "Flight" } th.n { (in_the_air(has_motors)) } th.n { "Mean risk" }
                th.n { "Highest" } th.n { "Elevated" } @if has_motors { th.n { "At a limit" } } th.n { "Findings" }
            } }
            tbody {
                @for (i, subject) in subjects.iter().enumerate() {
                    @let summary = &subject.assessed.summary;
                    tr {
                        td { (badge(&subject.assessed.verdict)) }
                        td.name { a href={ "#flight" (i) } { (subject.title()) } }
                        td.n { (minutes(subject.in_air_s(), 0)) " min" }
                        td.n { (percent(summary.risk_mean_pct)) }
                        td.n { (peak(highest(&subject.assessed))) }
                        td.n { (peak(summary.elevated_risk_max)) }
                        @if has_motors { td.n { (share(summary.saturated_share)) } }
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
                (findings(subject, loaded))
                @if let Some(risk) = charts::risk(&subject.assessed, &loaded.estimator, timeline.stretch) {
                    (panel(&risk, timeline, None))
                }
            }
        }
        (texts(loaded))
    }
}

/// The risk over time as an SVG file; `None` if no risk is known.
pub fn svg(subject: &Subject, loaded: &Loaded) -> Option<String> {
    const STYLE: &str = "text{font:12px system-ui,sans-serif;fill:var(--soft)}.y{text-anchor:end}.x{text-anchor:middle}\
        .key{fill:var(--c)}.title{font-size:16px;font-weight:700;fill:var(--ink)}.verdict{font-size:16px;font-weight:700;fill:var(--c)}";
    let whole = subject.stretch();
    let timeline = charts::timeline(&subject.flight, &subject.assessed, whole);
    let risk = charts::risk(&subject.assessed, &loaded.estimator, whole)?;
    let verdict = &subject.assessed.verdict;
    let frame = Frame {
        left: 48.0,
        top: 70.0,
        width: 896.0,
        height: 276.0,
    };
    let mut sheet = SvgDocument::styled(960.0, 380.0, [CSS, CHART_CSS, STYLE].concat());
    sheet.push(format_args!(
        r#"<text class="verdict {}" x="48" y="30">{}</text><text class="title" x="108" y="30">{}</text>{}"#,
        verdict_class(verdict),
        verdict,
        EscapedText(subject.title()),
        risk.svg(&timeline, frame),
    ));
    Some(sheet.finish(&format!("{verdict} {}", subject.title())))
}

/// A page in the style of a report, around a body that the caller provides as HTML. The page cannot load other
/// resources, and control characters in it are made visible.
pub fn around(title: &str, body: String) -> String {
    page(title, &PreEscaped(body))
}

/// The style sheet of a page, for programs that embed its parts in their own page.
pub fn style() -> String {
    [CSS, CHART_CSS, PAGE_CSS].concat()
}

fn page(title: &str, body: &Markup) -> String {
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width,initial-scale=1";
                meta http-equiv="Content-Security-Policy" content=(POLICY);
                meta name="color-scheme" content="light dark";
                title { (title) " - flagred" }
                style { (PreEscaped(style())) }
            }
            body {
                (body)
                p.soft { "Written by flagred " (env!("CARGO_PKG_VERSION")) "." }
                #now {}
                script { (PreEscaped(PAGE_JS)) }
            }
        }
    };
    shown(page)
}
