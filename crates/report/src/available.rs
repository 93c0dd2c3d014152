//! Signals of the log that a reader may add to the report.

use flagred::estimator::Estimator;
use flagred_flightlog::{Flight, Signal};
use fuzzy::drawing::Scale;
use maud::{Markup, html};
use serde::Serialize;

use crate::{
    charts::gap_s,
    curve::{FEW_SPANS, path, thinned},
    panel::panel,
    timeline::{Line, Panel, Size, Timeline, decimals},
};

/// A signal of a log.
#[derive(Debug, Serialize)]
pub struct AvailableSignal<'a> {
    /// The name of the signal.
    pub name: &'a str,
    /// The unit of the values; empty if there is none or it is unknown.
    pub unit: &'a str,
    /// The message and field of the log that contain the signal.
    pub source: &'a str,
}

/// The signals of a log with at least one known value, in order of their names.
pub fn signals(flight: &Flight) -> Vec<AvailableSignal<'_>> {
    let known = |signal: &Signal<'_>| signal.values.iter().any(|value| value.is_finite());
    let known = flight.signals().filter(known);
    let mut available: Vec<AvailableSignal<'_>> = known
        .map(|signal| AvailableSignal {
            name: &signal.label.name,
            unit: unit(&signal),
            source: &signal.label.source,
        })
        .collect();
    available.sort_by_key(|signal| signal.name);
    available
}

/// The unit of a signal in the usual notation, such as `m/s²` for `m/s2`; empty for the unit `1`.
fn unit<'a>(signal: &Signal<'a>) -> &'a str {
    match signal.label.unit.as_str() {
        "1" => "",
        "deg" => "°",
        "m/s2" => "m/s²",
        unit => unit,
    }
}

/// The curves of some signals, in the given order.
pub(crate) fn panels(
    flight: &Flight,
    estimator: &Estimator,
    timeline: &Timeline,
    names: &[String],
) -> Markup {
    let signals = names.iter().filter_map(|name| flight.signal(name));
    html! {
        @for one in signals.filter_map(|signal| curve(signal, estimator, timeline, None)) {
            (panel(&one, timeline, None))
        }
    }
}

/// Renders all signals, each in a collapsed section and with few points.
pub(crate) fn folded(flight: &Flight, estimator: &Estimator, timeline: &Timeline) -> Markup {
    let names = signals(flight).into_iter();
    let signals = names.filter_map(|offered| flight.signal(offered.name));
    let curves = signals.filter_map(|signal| curve(signal, estimator, timeline, Some(FEW_SPANS)));
    let curves: Vec<Panel> = curves.collect();
    html! {
        @if !curves.is_empty() {
            h2 { "Signals of the log" }
            p.soft { "Open a signal to see its curve; all curves share one cursor." }
            @for one in &curves {
                details.signal {
                    summary { (one.title) }
                    (panel(one, timeline, None))
                }
            }
        }
    }
}

/// The curve of a signal over the shown stretch, thinned to a number of spans; `None` without a known value there.
fn curve(
    signal: Signal<'_>,
    estimator: &Estimator,
    timeline: &Timeline,
    spans: Option<usize>,
) -> Option<Panel> {
    let stretch = timeline.stretch;
    let points = signal
        .t_s
        .iter()
        .copied()
        .zip(signal.values.iter().copied());
    let seen = points
        .clone()
        .filter(|(t_s, value)| stretch.contains(*t_s) && value.is_finite());
    let (low, high) = seen
        .map(|(_, value)| (value, value))
        .reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))?;
    let room = match high > low {
        true => (high - low) * 0.06,
        false => (high.abs() * 0.01).max(0.5),
    };
    let scale = Scale::new(low - room, high + room);
    let gap_s = gap_s(estimator, signal.rate_hz());
    let places = decimals(scale);
    let data = match spans {
        None => path(points, stretch, gap_s, places),
        Some(spans) => thinned(points, stretch, gap_s, places, spans),
    };
    let label = signal.label;
    let lines = vec![Line::new("value", label.source.as_str(), data)];
    let panel = Panel::new(
        label.name.as_str(),
        (scale, unit(&signal)),
        Size::Medium,
        lines,
    );
    panel.has_data().then_some(panel)
}
