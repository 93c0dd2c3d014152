//! The full screen: the current state and the latest events.

use std::collections::VecDeque;

use flagred::estimator::Estimator;
use fuzzy::drawing::{bar, visible};

use super::{
    lines,
    session::{Event, Session, VehicleView},
};
use flagred_report::words::level_style;

/// Escape sequence that enters the alternate screen and hides the cursor.
pub(crate) const ENTER: &str = "\x1b[?1049h\x1b[?25l";
/// Escape sequence that shows the cursor and leaves the alternate screen.
pub(crate) const LEAVE: &str = "\x1b[?25h\x1b[?1049l";
const HOME: &str = "\x1b[H";
const CLEAR_LINE: &str = "\x1b[K";
const CLEAR_REST: &str = "\x1b[J";
/// Number of columns of a bar.
const BAR: usize = 40;
/// Maximum number of events shown.
const LATEST: usize = 8;
/// The column in which the text of an event begins.
const INDENT: usize = 12;

/// The latest events, for the screen.
pub(crate) struct Screen {
    title: String,
    latest: VecDeque<String>,
}

impl Screen {
    pub(crate) fn new(title: String) -> Screen {
        Screen {
            title: visible(&title).into_owned(),
            latest: VecDeque::new(),
        }
    }

    /// Adds an event.
    pub(crate) fn add(
        &mut self,
        at_s: f64,
        event: &Event,
        session: &Session<'_>,
        estimator: &Estimator,
    ) {
        if matches!(event, Event::Risk { .. }) {
            return;
        }
        let text = lines::describe(event, session, estimator);
        self.latest
            .push_back(format!("{at_s:8.1} s  {}", visible(&text)));
        while self.latest.len() > LATEST {
            self.latest.pop_front();
        }
    }

    /// Returns the text of a screen of this size, in columns and rows, which replaces the previous screen. The current
    /// state comes first; the latest events fill the remaining rows.
    pub(crate) fn frame(
        &self,
        view: Option<&VehicleView<'_>>,
        estimator: &Estimator,
        (columns, rows): (usize, usize),
    ) -> String {
        let now = match view {
            None => "waiting for a vehicle\n".to_owned(),
            Some(view) => state(view, estimator),
        };
        let title = format!("FLAGRED  {}", self.title);
        let mut lines = wrapped([title.as_str(), ""].into_iter().chain(now.lines()), columns);
        let latest = wrapped(self.latest.iter().map(String::as_str), columns);
        let left = rows.saturating_sub(lines.len() + 4);
        lines.push(String::new());
        lines.extend_from_slice(
            latest
                .get(latest.len().saturating_sub(left)..)
                .unwrap_or(&[]),
        );
        lines.extend([String::new(), "Ctrl-C quits".to_owned()]);
        text(&lines, rows)
    }
}

/// Returns the text that replaces the contents of the screen by these lines, as many as fit.
pub(crate) fn text(lines: &[String], rows: usize) -> String {
    let mut text = HOME.to_owned();
    // A line end in the last row would scroll the first row away.
    for line in lines.iter().take(rows.saturating_sub(1)) {
        text += line;
        text += CLEAR_LINE;
        text += "\r\n";
    }
    text + CLEAR_REST
}

/// The columns and rows of the terminal; 80 and 24 if unknown.
pub(crate) fn size() -> (usize, usize) {
    terminal_size::terminal_size().map_or((80, 24), |(width, height)| {
        (width.0.into(), height.0.into())
    })
}

/// Breaks lines between words, one column before the width: a full line would wrap. Lines with a style are short and
/// are not broken.
fn wrapped<'a>(lines: impl Iterator<Item = &'a str>, columns: usize) -> Vec<String> {
    let width = columns.saturating_sub(1).max(1);
    let mut all = Vec::new();
    for line in lines {
        let mut rest = line.to_owned();
        while let Some((end, _)) = rest
            .char_indices()
            .nth(width)
            .filter(|_| !line.contains('\x1b'))
        {
            let spaces = rest
                .char_indices()
                .take(width + 1)
                .filter(|(_, letter)| *letter == ' ');
            let word_end = spaces
                .map(|(at, _)| at)
                .last()
                .filter(|at| !rest[..*at].trim().is_empty());
            let below = rest.split_off(word_end.unwrap_or(end));
            all.push(rest);
            let indent = if width > 2 * INDENT { INDENT } else { 0 };
            rest = " ".repeat(indent) + below.trim_start();
        }
        all.push(rest);
    }
    all
}

fn state(view: &VehicleView<'_>, estimator: &Estimator) -> String {
    let activity = match (view.is_armed, view.is_in_air) {
        _ if view.link_lost => "LINK LOST",
        (_, true) => "in the air",
        (true, false) => "armed, on the ground",
        (false, false) => "disarmed",
    };
    let mut text = format!(
        "vehicle {}: {}; {activity}; {:.0} % of packets lost\n\n",
        view.system,
        visible(&lines::name(view.vehicle)),
        100.0 * view.lost_share
    );
    let Some(setup) = view.setup else {
        text += "requesting parameters\n";
        return text;
    };
    let known = view
        .latest
        .and_then(|now| Some((now.risk.ok()?, now.elevated_risk_pct?, now.level)));
    match known {
        Some((estimate, elevated_pct, level)) => {
            text += &row(
                "risk",
                estimate.risk_pct / 100.0,
                &format!("{:3.0} %", estimate.risk_pct),
            );
            text += &row(
                "elevated",
                elevated_pct / 100.0,
                &format!("{elevated_pct:3.0} %"),
            );
            if let Some(level) = level {
                let style = level_style(level);
                text += &format!("level     {style}{level}{style:#}\n");
            }
        }
        None => {
            let why = match view.latest.and_then(|now| now.risk.err()) {
                _ if view.link_lost => "no packets from the vehicle".to_owned(),
                _ if view.motors_lost => "no motor commands".to_owned(),
                Some(unknown) => unknown.explain(estimator.profile()),
                None => "no motor command yet".to_owned(),
            };
            text += &format!("risk      unknown: {}\n\n\n", visible(&why));
        }
    }
    let number = |value: Option<f64>| value.map_or("unknown".to_owned(), |v| format!("{v:.2}"));
    text += &format!(
        "margin    {}, spread {}\n\n",
        number(view.margin),
        number(view.spread)
    );
    for (motor, command) in setup.motors.iter().zip(view.motors) {
        let name = format!("motor {}", motor.number);
        text += &if command.is_finite() {
            row(&name, *command, &format!("{command:.2}"))
        } else {
            format!("{name:<9} unknown\n")
        };
    }
    if !setup.assumed.is_empty() {
        text += &format!("\nassumed: {}\n", visible(&setup.assumed.join("; ")));
    }
    text
}

/// A row with a name, a bar for a share from 0 to 1, and the value.
fn row(name: &str, share: f64, value: &str) -> String {
    format!("{name:<9} {} {value}\n", bar(share, BAR))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::watch::session::tests::{Bench, estimator};

    fn rows(frame: &str) -> Vec<String> {
        let shown = frame.trim_start_matches(HOME).trim_end_matches(CLEAR_REST);
        let rows = shown.split_terminator("\r\n");
        rows.map(|row| row.trim_end_matches(CLEAR_LINE).to_owned())
            .collect()
    }

    #[test]
    fn the_risk_is_shown_on_the_smallest_terminal() {
        let estimator = estimator();
        let mut bench = Bench::new(&estimator, Some(191));
        bench.beat(false);
        bench.all_parameters();
        bench.hover(10.0, 20.0, 1500);
        let mut screen = Screen::new("listening at 127.0.0.1:14550, profile flagred-paper".into());
        for i in 0..20 {
            let text = format!(
                "note {i} {}",
                "which is longer than a line: 1000 µs ".repeat(5)
            );
            let event = Event::Note { text };
            screen.add(f64::from(i), &event, &bench.session, &estimator);
        }
        let view = bench.session.view();
        for size in [(80, 24), (60, 20), (40, 12), (20, 8), (1, 1), (0, 0)] {
            let shown = rows(&screen.frame(view.as_ref(), &estimator, size));
            let (columns, most) = size;
            assert!(
                shown.len() <= most.saturating_sub(1),
                "{size:?}: {shown:#?}"
            );
            let widest = shown
                .iter()
                .filter(|row| !row.contains('\x1b'))
                .map(|row| row.chars().count())
                .max();
            assert!(
                widest.unwrap_or(0) <= columns.saturating_sub(1).max(1),
                "{size:?}: {shown:#?}"
            );
            if most >= 20 {
                assert!(
                    shown.iter().any(|row| row.starts_with("risk ")),
                    "{shown:#?}"
                );
                assert!(
                    shown.iter().any(|row| row.starts_with("motor 4")),
                    "{shown:#?}"
                );
                assert_eq!(shown.last().unwrap(), "Ctrl-C quits");
            }
        }
        let shown = rows(&screen.frame(view.as_ref(), &estimator, (200, 50)));
        assert_eq!(
            shown.iter().filter(|row| row.contains("note ")).count(),
            LATEST
        );
        assert!(shown.iter().any(|row| row.contains("note 19 ")));
    }
}
