//! The curves of a report and their data.

use flagred::{
    estimator::Estimator,
    flight::{Assessment, Step},
    profile::CRITICAL_ERROR_DEG,
    verdict::{Level, LevelSettings, Threshold},
};
use flagred_flightlog::{Flight, Options, Signal};
use fuzzy::{
    Model,
    drawing::{Scale, number},
};

use crate::{
    curve::{Stretch, area, path},
    names::words_of,
    timeline::{Line, Mark, Panel, Phase, Size, Timeline},
};

/// The signals that a report draws in addition to those of the profile.
pub(crate) const SIGNALS: [&str; 6] = [
    "roll_des_deg",
    "roll_deg",
    "pitch_des_deg",
    "pitch_deg",
    "battery_v",
    "battery_remaining_pct",
];
/// The signals from which the track is drawn.
pub(crate) const POSITIONS: [&str; 4] = ["latitude_deg", "longitude_deg", "north_m", "east_m"];

/// The signals that are needed to assess a log and to draw the fixed part of its report. Signals that a reader may add to the
/// report are not included.
pub fn signals(estimator: &Estimator) -> Vec<String> {
    let of_profile = estimator.profile().signals().into_iter();
    let drawn = SIGNALS.into_iter().chain(POSITIONS);
    let mut signals: Vec<String> = of_profile.chain(drawn).map(str::to_owned).collect();
    signals.sort_unstable();
    signals.dedup();
    signals
}

/// Options for reading a log to assess it: all signals of the log if a report is `drawn`, otherwise only the signals
/// that the profile needs.
pub fn options(estimator: &Estimator, drawn: bool) -> Options {
    let mut options = Options::default();
    let needed = || estimator.profile().signals().into_iter().map(str::to_owned);
    options.signals = (!drawn).then(|| needed().collect());
    options
}

/// The scale of a percentage.
const PERCENT: (Scale, &str) = (Scale::new(0.0, 100.0), "%");

/// The maximum number of events that are drawn; the last one shows the number of further events.
const MAX_EVENTS: usize = 200;

/// The stretch that is drawn: from the first take-off to the last landing, or the whole log if no time in the air is known.
pub(crate) fn stretch(flight: &Flight) -> Stretch {
    let air = flight.in_air.iter().flat_map(|air| &air.spans);
    let hull = air
        .map(|span| (span.start_s, span.end_s))
        .reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)));
    let (start_s, end_s) = hull.or_else(|| flight.time_span_s()).unwrap_or((0.0, 1.0));
    Stretch {
        start_s,
        end_s: end_s.max(start_s + SHORTEST_S),
    }
}

/// The minimum length of a drawn stretch, in seconds.
const SHORTEST_S: f64 = 0.1;

/// The part of a stretch that is within another, extended to at least the minimum length of a drawn stretch.
pub(crate) fn within(part: Stretch, whole: Stretch) -> Stretch {
    let latest_s = (whole.end_s - SHORTEST_S).max(whole.start_s);
    // `max` and `min` replace NaN by the ends of `whole`.
    let start_s = part.start_s.max(whole.start_s).min(latest_s);
    let end_s = part.end_s.min(whole.end_s).max(start_s + SHORTEST_S);
    Stretch { start_s, end_s }
}

/// The flight modes, findings and events of a flight over a stretch of time, shared by all its curves.
pub(crate) fn timeline(flight: &Flight, assessed: &Assessment, shown: Stretch) -> Timeline {
    let whole = stretch(flight);
    let stretch = Stretch {
        start_s: shown.start_s.max(whole.start_s),
        end_s: shown.end_s.min(whole.end_s),
    };
    let ends = flight.modes.iter().skip(1).map(|next| next.t_s());
    let ends = ends.chain([f64::INFINITY]);
    let mut kinds: Vec<&str> = Vec::new();
    let mut phases: Vec<Phase> = Vec::new();
    let mut more = 0;
    for (mode, end_s) in flight.modes.iter().zip(ends) {
        let span = |within: Stretch| Stretch {
            start_s: mode.t_s().max(within.start_s),
            end_s: end_s.min(within.end_s),
        };
        let is_some = |span: Stretch| span.end_s > span.start_s;
        // A mode has the same shade, whatever part of the flight is shown.
        if is_some(span(whole)) && !kinds.contains(&mode.what.as_str()) {
            kinds.push(&mode.what);
        }
        let span = span(stretch);
        if is_some(span) && phases.len() == MAX_EVENTS {
            more += 1;
        } else if is_some(span) {
            let kind = kinds.iter().position(|known| *known == mode.what);
            phases.push(Phase {
                stretch: span,
                name: mode.what.clone(),
                kind: kind.unwrap_or_default(),
            });
        }
    }
    if let Some(last) = phases.last_mut().filter(|_| more > 0) {
        last.name = format!("and {} more flight modes", more + 1);
        last.stretch.end_s = stretch.end_s;
    }
    // The most severe finding comes first in the list, and is drawn last, on top of the others.
    let findings = assessed.findings.iter().rev().map(|finding| {
        let span = Stretch {
            start_s: finding.from_s,
            end_s: finding.to_s,
        };
        (span, level_class(finding.severity))
    });
    let messages = flight
        .messages
        .iter()
        .map(|message| (message.t_s(), message.what.clone()));
    let boots = flight.boots_s.iter();
    let boots = boots.map(|t_s| (*t_s, "the autopilot rebooted".to_owned()));
    let mut events: Vec<(f64, String)> = messages
        .chain(boots)
        .filter(|(t_s, _)| stretch.contains(*t_s))
        .collect();
    events.sort_by(|a, b| a.0.total_cmp(&b.0));
    if events.len() > MAX_EVENTS {
        let more = format!("and {} more events", events.len() - MAX_EVENTS + 1);
        events.truncate(MAX_EVENTS - 1);
        if let Some((t_s, _)) = events.last() {
            events.push((*t_s, more));
        }
    }
    Timeline {
        stretch: shown,
        zero_s: whole.start_s,
        phases,
        alerts: findings.collect(),
        events,
    }
}

pub(crate) fn level_class(level: Level) -> &'static str {
    match level {
        Level::Good | Level::Info => "good",
        Level::Warn => "warn",
        Level::Fail => "fail",
    }
}

/// The curve of one quantity over the steps of an assessment.
fn of_steps(
    steps: &[Step],
    stretch: Stretch,
    gap_s: f64,
    decimals: usize,
    value: impl Fn(&Step) -> Option<f64>,
) -> String {
    let points = steps
        .iter()
        .map(|step| (step.t_s, value(step).unwrap_or(f64::NAN)));
    path(points, stretch, gap_s, decimals)
}

/// The longest time without a sample that a curve bridges, in seconds: five sample intervals, but at least the longest gap
/// that the profile allows.
pub(crate) fn gap_s(estimator: &Estimator, rate_hz: Option<f64>) -> f64 {
    let longest_gap_s = estimator.profile().sampling.longest_gap_s;
    rate_hz.map_or(longest_gap_s, |rate_hz| longest_gap_s.max(5.0 / rate_hz))
}

/// The classes in the style sheet for the curves of other risks.
const OTHER_RISKS: [&str; 3] = ["value", "motor", "mean"];

/// The curves of the risk, of the elevated risk, and of the other risks of the profile; `None` if no risk is known.
pub(crate) fn risk(
    assessed: &Assessment,
    estimator: &Estimator,
    stretch: Stretch,
) -> Option<Panel> {
    let gap_s = gap_s(estimator, None);
    let draw =
        |value: &dyn Fn(&Step) -> Option<f64>| of_steps(&assessed.steps, stretch, gap_s, 1, value);
    let others = &estimator.profile().other_risks;
    let of_others = others.iter().zip(OTHER_RISKS.into_iter().cycle());
    let of_others = of_others.enumerate().map(|(i, (risk, class))| {
        let data = draw(&|step| step.other_risks_pct.get(i).copied());
        Line::new(class, words_of(&risk.output), data)
    });
    let elevated = draw(&|step| step.elevated_risk_pct);
    let risk = draw(&|step| step.estimate.map(|estimate| estimate.risk_pct));
    let main = [
        Line::new("elevated", "elevated risk", elevated),
        Line::new("risk", "risk", risk),
    ];
    let lines: Vec<Line> = of_others.chain(main).collect();
    if lines.iter().all(|line| line.data.is_empty()) {
        return None;
    }
    let verdict = &estimator.profile().verdict;
    let mark = |raise: &Threshold, level, of: &str| {
        raise.risk_pct.map(|risk_pct| Mark {
            value: risk_pct,
            class: level_class(level),
            name: format!("{level}{of} from {} %", number(risk_pct, 1)),
        })
    };
    let levels = |warn: &LevelSettings, fail: &LevelSettings, of: &str| {
        let warn = mark(&warn.raise, Level::Warn, of);
        warn.into_iter()
            .chain(mark(&fail.raise, Level::Fail, of))
            .collect::<Vec<_>>()
    };
    let mut marks = levels(&verdict.warn, &verdict.fail, "");
    for risk in others {
        let of = format!(" of {}", words_of(&risk.output));
        for own in levels(&risk.warn, &risk.fail, &of) {
            let is_same = |mark: &Mark| (mark.value, mark.class) == (own.value, own.class);
            if !marks.iter().any(is_same) {
                marks.push(own);
            }
        }
    }
    let intervals = assessed.steps.iter().map(|step| {
        let interval = step.risk_interval;
        let ends = interval.map(|interval| (interval.low_pct, interval.high_pct));
        (step.t_s, ends)
    });
    let band = area(intervals, stretch, gap_s, 1);
    let band = Line::new("risk", "interval of the risk", band);
    Some(Panel {
        band: Some(band).filter(|band| !band.data.is_empty()),
        marks,
        ..Panel::new("Risk", PERCENT, Size::Large, lines)
    })
}

/// The smallest distance of any motor from its lower and from its upper limit, and the mean margin.
pub(crate) fn margins(
    flight: &Flight,
    assessed: &Assessment,
    estimator: &Estimator,
    stretch: Stretch,
) -> Option<Panel> {
    let gap_s = gap_s(estimator, flight.command_rate_hz());
    let least = |side: &dyn Fn(f64) -> f64| {
        let rows = flight.commands.rows().map(|(t_s, row)| {
            let sides = row.iter().filter_map(|raw| flight.effective_command(*raw));
            (t_s, sides.map(side).fold(f64::NAN, f64::min))
        });
        path(rows, stretch, gap_s, 3)
    };
    let low = least(&|e| e);
    if low.is_empty() {
        return None;
    }
    let mean = of_steps(&assessed.steps, stretch, gap_s, 3, |step| step.margin);
    let lines = vec![
        Line::new("mean", "mean margin", mean),
        Line::new("low", "to its lower limit", low),
        Line::new("high", "to its upper limit", least(&|e| 1.0 - e)),
    ];
    let scale = (Scale::new(0.0, 1.0), "");
    Some(Panel::new(
        "Margin of the nearest motor",
        scale,
        Size::Medium,
        lines,
    ))
}

/// The command of each motor on its full range; the parts outside the effective range are shaded.
pub(crate) fn motors(flight: &Flight, estimator: &Estimator, stretch: Stretch) -> Vec<Panel> {
    let gap_s = gap_s(estimator, flight.command_rate_hz());
    let limits = &flight.effective_range;
    let limit = |share: f64| Mark {
        value: share * 100.0,
        class: "limit",
        name: String::new(),
    };
    let panel = |(i, motor): (usize, &flagred_flightlog::Motor)| {
        let rows = flight.commands.rows().map(|(t_s, row)| {
            let command = row.get(i).and_then(|raw| flight.command(*raw));
            (t_s, command.unwrap_or(f64::NAN) * 100.0)
        });
        let data = path(rows, stretch, gap_s, 1);
        let lines = vec![Line::new("motor", motor.output.as_str(), data)];
        Panel {
            marks: [limits.low, limits.high].map(limit).into(),
            zones: vec![
                Scale::new(0.0, limits.low * 100.0),
                Scale::new(limits.high * 100.0, 100.0),
            ],
            ..Panel::new(
                format!("Motor {}", motor.number),
                PERCENT,
                Size::Small,
                lines,
            )
        }
    };
    let panels = flight.motors.iter().enumerate().map(panel);
    panels.filter(Panel::has_data).collect()
}

/// The curves of the inputs of the rules, each with the index of its input.
pub(crate) fn inputs(
    assessed: &Assessment,
    estimator: &Estimator,
    model: &Model,
    stretch: Stretch,
) -> Vec<(usize, Panel)> {
    let gap_s = gap_s(estimator, None);
    let panel = |(i, input): (usize, &flagred::profile::ProfileInput)| {
        let scale = super::decision::focus(model, &input.name, i, &assessed.steps);
        let unit = model.inputs.iter().find(|known| known.name == input.name);
        let unit = unit.and_then(|known| known.unit.as_deref());
        let data = of_steps(&assessed.steps, stretch, gap_s, 4, |step| {
            step.inputs.get(i).copied()
        });
        let lines = vec![Line::new("value", unit.unwrap_or_default(), data)];
        let panel = Panel::new(words_of(&input.name), (scale, ""), Size::Small, lines);
        panel.has_data().then_some((i, panel))
    };
    let inputs = estimator.profile().inputs.iter().enumerate();
    inputs.filter_map(panel).collect()
}

/// The attitude error in degrees: `sqrt((roll_des - roll)^2 + (pitch_des - pitch)^2)`.
pub(crate) fn attitude_error(
    flight: &Flight,
    estimator: &Estimator,
    stretch: Stretch,
) -> Option<Panel> {
    let roll = flight.signal("roll_deg")?;
    let errors: Vec<(f64, f64)> = flight
        .attitudes()
        .map(|(t_s, attitude)| (t_s, attitude.squared_error_deg2().sqrt()))
        .collect();
    // The scale includes at least the critical error, so that a calm flight looks calm.
    let largest = errors
        .iter()
        .filter(|(t_s, _)| stretch.contains(*t_s))
        .map(|(_, error)| *error)
        .fold(CRITICAL_ERROR_DEG * 1.1, f64::max);
    let gap_s = gap_s(estimator, roll.rate_hz());
    let data = path(errors.into_iter(), stretch, gap_s, 2);
    let name = "roll and pitch against their set points";
    let lines = vec![Line::new("value", name, data)];
    let scale = (Scale::new(0.0, largest), "°");
    let panel = Panel {
        marks: vec![Mark {
            value: CRITICAL_ERROR_DEG,
            class: "limit",
            name: "critical".into(),
        }],
        ..Panel::new("Attitude error", scale, Size::Medium, lines)
    };
    panel.has_data().then_some(panel)
}

/// Battery voltage and remaining charge, if the log contains them.
pub(crate) fn battery(flight: &Flight, estimator: &Estimator, stretch: Stretch) -> Vec<Panel> {
    let panel = |title: &str, scale, signal: Signal<'_>, decimals| {
        let points = signal.t_s.iter().copied();
        let points = points.zip(signal.values.iter().copied());
        let gap_s = gap_s(estimator, signal.rate_hz());
        let data = path(points, stretch, gap_s, decimals);
        let lines = vec![Line::new("value", signal.label.source.as_str(), data)];
        Panel::new(title, scale, Size::Medium, lines)
    };
    let voltage = flight.signal("battery_v").and_then(|signal| {
        let seen = signal.t_s.iter().zip(signal.values);
        let seen = seen.filter(|(t_s, value)| stretch.contains(**t_s) && value.is_finite());
        let (low, high) = seen
            .map(|(_, value)| (*value, *value))
            .reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))?;
        let room = ((high - low) * 0.1).max(0.1);
        let scale = Scale::new((low - room).max(0.0), high + room);
        Some(panel("Battery voltage", (scale, "V"), signal, 2))
    });
    let remaining = flight
        .signal("battery_remaining_pct")
        .map(|signal| panel("Battery remaining", PERCENT, signal, 1));
    let panels = voltage.into_iter().chain(remaining);
    panels.filter(Panel::has_data).collect()
}
