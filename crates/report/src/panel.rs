//! A panel of curves over time as HTML. It uses the available width, and its text keeps its size.

use fuzzy::drawing::{Scale, number};
use maud::{Markup, PreEscaped, html};

use crate::{
    curve::Stretch,
    timeline::{Panel, Size, Timeline},
};

/// Renders a panel. If the panel shows an input of the rules, `input` is the index of that input; the script of the
/// page uses it to mark the input on the map.
pub(super) fn panel(panel: &Panel, timeline: &Timeline, input: Option<usize>) -> Markup {
    let class = match panel.size {
        Size::Large => "large",
        Size::Medium => "medium",
        Size::Small => "small",
    };
    let start = number(timeline.stretch.start_s, 3);
    let zero = number(timeline.zero_s, 3);
    let digits = digits(panel);
    let length = number(timeline.stretch.length_s(), 3);
    let lines = panel.lines.iter().filter(|line| !line.data.is_empty());
    let marks = panel.marks.iter().filter(|mark| !mark.name.is_empty());
    html! {
        figure class={ "panel " (class) } data-input=[input] data-unit=(panel.unit.as_str())
            data-start=(start) data-length=(length) data-zero=(zero) data-digits=[digits] {
            figcaption {
                b { (panel.title) }
                @for line in lines {
                    " " span.key.(line.class).bare[line.name.is_empty()] { (line.name) " " output {} }
                }
                @if let Some(band) = &panel.band {
                    " " span.key.filled.(band.class) { (band.name) }
                }
                @for mark in marks {
                    " " span.key.dashed.(mark.class) { (mark.name) }
                }
            }
            .frame {
                @for (value, label) in panel.labels() {
                    span.y style={ "bottom:" (percent(panel.scale.share(value))) } { (label) }
                }
                .area {
                    @if panel.size == Size::Large {
                        (phases(timeline))
                    }
                    (PreEscaped(panel.plot(timeline, "")))
                }
            }
            @if panel.size != Size::Small {
                (times(timeline))
            }
        }
    }
}

/// The number of digits for a value at the cursor; `None` if the default number of digits already shows a thousandth of
/// the scale.
fn digits(panel: &Panel) -> Option<usize> {
    let Scale { low, high } = panel.scale;
    let largest = low.abs().max(high.abs());
    let digits = (largest / (high - low)).log10().ceil() + 3.0;
    (digits > 4.0).then_some((digits as usize).min(12))
}

/// A share as a CSS length.
pub(super) fn percent(share: f64) -> String {
    number(share * 100.0, 2) + "%"
}

/// Renders the names of the phases, each over the time of its phase.
fn phases(timeline: &Timeline) -> Markup {
    let ends = |phase: &Stretch| {
        let (from, to) = (phase.start_s, phase.end_s);
        (timeline.stretch.share(from), timeline.stretch.share(to))
    };
    html! {
        @for phase in &timeline.phases {
            @let (from, to) = ends(&phase.stretch);
            span.phase title=(phase.name) style={ "left:" (percent(from)) ";width:" (percent(to - from)) } { span { (phase.name) } }
        }
    }
}

/// Renders the labels of the time axis.
fn times(timeline: &Timeline) -> Markup {
    let stretch = timeline.stretch;
    html! {
        .times {
            @for (t_s, label) in stretch.ticks(timeline.zero_s) {
                @let share = stretch.share(t_s);
                // Near an edge, the label begins or ends at its tick: there is no room beyond the edge on a phone, and at the left the
                // lowest value of the scale is beside it.
                span.start[share < 0.03].end[share > 0.94] style={ "left:" (percent(share)) } { (label) }
            }
        }
    }
}
