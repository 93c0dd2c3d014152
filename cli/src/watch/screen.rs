//! The full screen: how things stand now, and what happened last.

use std::collections::VecDeque;

use flagred::{estimator::Estimator, verdict::Level};

use super::{
    lines,
    session::{Event, View},
};
use crate::assessment::{follow::word, words::level_style};

/// The other screen of the terminal, without a cursor; and back.
pub(crate) const ENTER: &str = "\x1b[?1049h\x1b[?25l";
pub(crate) const LEAVE: &str = "\x1b[?25h\x1b[?1049l";
const HOME: &str = "\x1b[H";
const CLEAR_LINE: &str = "\x1b[K";
const CLEAR_REST: &str = "\x1b[J";
/// Columns of a bar.
const BAR: usize = 40;
/// Events kept in sight.
const LATEST: usize = 8;

/// What happened last, for a picture of how things stand.
pub(crate) struct Screen {
    title: String,
    latest: VecDeque<String>,
}

impl Screen {
    pub(crate) fn new(title: String) -> Screen {
        Screen {
            title,
            latest: VecDeque::new(),
        }
    }

    /// Keeps an event in sight.
    pub(crate) fn add(&mut self, at_s: f64, event: &Event) {
        if matches!(event, Event::Risk { .. }) {
            return;
        }
        self.latest
            .push_back(format!("{at_s:8.1} s  {}", lines::describe(event)));
        while self.latest.len() > LATEST {
            self.latest.pop_front();
        }
    }

    /// All of the screen, to be written over what it showed before.
    pub(crate) fn frame(&self, view: Option<&View<'_>>, estimator: &Estimator) -> String {
        let mut frame = HOME.to_owned();
        for line in picture(&self.title, view, estimator, &self.latest).lines() {
            frame += line;
            frame += CLEAR_LINE;
            frame += "\r\n";
        }
        frame + CLEAR_REST
    }
}

fn picture(
    title: &str,
    view: Option<&View<'_>>,
    estimator: &Estimator,
    latest: &VecDeque<String>,
) -> String {
    let mut text = format!("FLAGRED  {title}\n\n");
    match view {
        None => text += "waiting for a vehicle\n",
        Some(view) => text += &standing(view, estimator),
    }
    text += "\n";
    for line in latest {
        text += line;
        text += "\n";
    }
    text += "\nCtrl-C ends the watch\n";
    text
}

fn standing(view: &View<'_>, estimator: &Estimator) -> String {
    let state = match (view.is_armed, view.is_in_air) {
        _ if view.link_lost => "LINK LOST",
        (_, true) => "in the air",
        (true, false) => "armed, on the ground",
        (false, false) => "disarmed",
    };
    let mut text = format!(
        "vehicle {}: {}; {state}; {:.0} % of its packets lost\n\n",
        view.system,
        lines::name(view.vehicle),
        100.0 * view.lost_share
    );
    let Some(setup) = view.setup else {
        text += "asking for its parameters\n";
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
            let level = level.unwrap_or(Level::Good);
            let style = level_style(level);
            text += &format!("level     {style}{}{style:#}\n", word(level));
        }
        None => {
            let why = match view.latest.and_then(|now| now.risk.err()) {
                _ if view.link_lost => "nothing comes from the vehicle".to_owned(),
                _ if view.motors_lost => "no motor commands come".to_owned(),
                Some(unknown) => unknown.explain(estimator.profile()),
                None => "no motor command came yet".to_owned(),
            };
            text += &format!("risk      unknown: {why}\n\n\n");
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
        text += &format!("\nassumed: {}\n", setup.assumed.join("; "));
    }
    text
}

/// A name, a bar for a share of 0 to 1, and the value.
fn row(name: &str, share: f64, value: &str) -> String {
    let full = (share.clamp(0.0, 1.0) * BAR as f64).round() as usize;
    let bar = "█".repeat(full) + &"·".repeat(BAR - full);
    format!("{name:<9} {bar} {value}\n")
}
