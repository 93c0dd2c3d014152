//! The head of a report: the verdict in a sentence, findings, vehicle and figures.

use flagred::{
    flight::{Peak, Verdict},
    loaded::Loaded,
    profile::{ErrorFrequency, Profile},
};
use maud::{Markup, html};

use crate::{
    charts,
    clock::Clock,
    finding::{self, FindingContext, highest},
    names::words_of,
    subject::Subject,
    words,
};

/// Verdict and findings.
pub(crate) fn head(subject: &Subject, loaded: &Loaded) -> Markup {
    html! {
        h1 { (badge(&subject.assessed.verdict)) " " (subject.title()) }
        (findings(subject, loaded))
    }
}

/// Figures, vehicle and limitations of the verdict.
pub(crate) fn about(subject: &Subject, loaded: &Loaded) -> Markup {
    let Subject {
        flight, assessed, ..
    } = subject;
    html! {
        (figures(subject))
        p.soft { (words::vehicle(flight)) }
        @if !flight.report.is_clean() {
            p.soft { (words::damage(&flight.report)) }
        }
        @for note in words::notes(flight, assessed) { p.soft { (note) } }
        (reliability(loaded.estimator.profile()))
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

/// The label for the time during which the vehicle is assessed, which depends on whether it has motors.
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

fn at(peak: Peak, clock: Clock) -> String {
    format!("{:.0} % at {}", peak.value_pct, clock.at(peak.t_s))
}

/// One entry for each cause, the most severe first, with the details of its most severe finding.
pub(crate) fn findings(subject: &Subject, loaded: &Loaded) -> Markup {
    let assessed = &subject.assessed;
    let clock = Clock::Since(subject.stretch().start_s);
    let context = FindingContext {
        estimator: &loaded.estimator,
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
                    span.what { "No verdict: " (reason) }
                    @if let Some(help) = reason.help() { br; (help) }
                }
            }
            @for line in finding::lines(&assessed.findings) {
                li.(charts::level_class(line.worst.severity)) {
                    span.what { b { (line.worst.severity) } " " (context.words(line.worst).text) }
                    br;
                    (finding::advice(context, line.worst, &subject.flight))
                    br;
                    span.soft {
                        (line.when(clock)) " (log time " (Clock::Log.span(line.worst.from_s, line.worst.to_s)) "). "
                        (context.details_by(line.worst, clock))
                    }
                }
            }
            @if unknown.is_none() && assessed.findings.is_empty() {
                li.good {
                    span.what {
                        "No threshold was reached."
                        @if let Some(peak) = highest(assessed) { " The highest risk was " (at(peak, clock)) "." }
                    }
                }
            }
        }
    }
}

fn figures(subject: &Subject) -> Markup {
    let summary = &subject.assessed.summary;
    let clock = Clock::Since(subject.stretch().start_s);
    let of_air = |part_s: f64| share((summary.in_air_s > 0.0).then(|| part_s / summary.in_air_s));
    let has_motors = !subject.flight.motors.is_empty();
    let time = (
        in_the_air(has_motors).to_owned(),
        Clock::Since(0.0).at(subject.in_air_s()),
    );
    let risks = [
        (
            "Highest risk",
            highest(&subject.assessed).map(|peak| at(peak, clock)),
        ),
        (
            "Mean risk",
            summary.risk_mean_pct.map(|mean| percent(Some(mean))),
        ),
        (
            "Highest elevated risk",
            summary.elevated_risk_max.map(|peak| at(peak, clock)),
        ),
    ];
    let risks = risks.into_iter();
    let risks = risks.filter_map(|(name, value)| Some((name.to_owned(), value?)));
    let others = subject.assessed.other_risks.iter().enumerate();
    let others = others.filter_map(|(risk, output)| {
        let peak = finding::highest_other(&subject.assessed, risk)?;
        Some((format!("Highest {}", words_of(output)), at(peak, clock)))
    });
    let figures = risks.chain(others).chain([time]);
    html! {
        dl.figures {
            // A number and its unit stay on one line.
            @for (name, value) in figures { div { dt { (name) } dd { (value.replace(" %", "\u{a0}%").replace(" min", "\u{a0}min")) } } }
        }
        @if summary.risk_max.is_some() {
            p.soft {
                (if subject.assessed.other_risks.is_empty() { "The risk is" } else { "All risks are" })
                " known for " (of_air(summary.assessed_s)) " of that time. The risk is interpolated for "
                (of_air(summary.filled_s)) "."
                @if has_motors { " Motors were at a limit for " (share(summary.saturated_share)) " of it." }
                @if has_motors {
                    " The seconds around take-off and landing are left out of the mean and elevated risk."
                } @else {
                    " The first seconds in use and the last ones before a stop are left out of the mean and elevated risk."
                }
                " Times are minutes since " (if has_motors { "take-off" } else { "the start of use" })
                ", which was at " (Clock::Log.at(subject.stretch().start_s)) " on the log's clock."
            }
        }
    }
}

/// How often large attitude errors followed a risk, if it was measured.
fn reliability(profile: &Profile) -> Markup {
    let rows = &profile.reliability;
    let of =
        |counts: Option<ErrorFrequency>| counts.and_then(words::share).unwrap_or("unknown".into());
    html! {
        @if !rows.is_empty() {
            details {
                summary { "How sure a risk is" }
                p.soft {
                    "The share of the moments with such a risk, in the flights that the rules were tested on, that were followed by an \
                     attitude error over 5 degrees within 5 s."
                    @if !profile.other_risks.is_empty() { " This applies only to the output `" (profile.output) "`." }
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
