//! The data that was read from a log, with the message or parameter that contained it.

use flagred::loaded::Loaded;
use fuzzy::drawing::number;
use maud::{Markup, html};

use crate::{charts, subject::Subject, words};

/// The data that was read from the log; the parameters are folded and can be searched.
pub(crate) fn sources(subject: &Subject, loaded: &Loaded) -> Markup {
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
    let range = |range: &flagred_flightlog::Range| {
        let unit = if range.unit == "1" { "" } else { range.unit };
        let (low, high) = (number(range.low, 3), number(range.high, 3));
        format!("{low} to {high} {unit} ({})", range.source)
    };
    add("range", flight.range.as_ref().map(range));
    let has_motors = !flight.motors.is_empty();
    let effective = has_motors.then(|| range(&flight.effective_range));
    add("effective range", effective);
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
    let positions = charts::POSITIONS.into_iter();
    let positions = positions.filter(|name| flight.signal(name).is_some());
    for name in signals.into_iter().chain(drawn).chain(positions) {
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
        @if !flight.parameters.is_empty() {
            details.searched {
                summary { "Parameters of motors and gains (" (flight.parameters.len()) ")" }
                input type="search" placeholder="Search" aria-label="Search the parameters";
                table.facts { tbody {
                    @for parameter in &flight.parameters {
                        tr {
                            th { (parameter.name) }
                            td { (number(parameter.value, 6)) " (" (parameter.source) ")" }
                        }
                    }
                } }
            }
        }
    }
}
