//! Determines the armed and in-air times from the events of a DataFlash log.

use crate::Intervals;

/// An event that changes the armed or in-air state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum StateEvent {
    Armed,
    Disarmed,
    /// Left the ground.
    Left,
    Landed,
}

impl StateEvent {
    /// The event with the given number in EV messages.
    pub(super) fn of(id: f64) -> Option<Self> {
        Some(match id as i64 {
            10 => Self::Armed,
            11 => Self::Disarmed,
            28 => Self::Left,
            18 => Self::Landed,
            _ => return None,
        })
    }
}

/// Armed and in-air times from the events of the log. The in-air times are known only if the log contains take-offs or
/// landings. A boot ends an armed time and an in-air time.
pub(super) fn air_from_events(
    events: &[(f64, StateEvent)],
    boots_s: &[f64],
    (first_s, last_s): (f64, f64),
) -> (Intervals, Option<Intervals>) {
    let changes = |yes: StateEvent, no: &[StateEvent]| -> Vec<(f64, bool)> {
        let mut changes: Vec<(f64, bool)> = events
            .iter()
            .filter_map(|&(t_s, event)| match event {
                event if event == yes => Some((t_s, true)),
                event if no.contains(&event) => Some((t_s, false)),
                _ => None,
            })
            .chain(boots_s.iter().map(|&t_s| (t_s, false)))
            .collect();
        changes.sort_by(|a, b| a.0.total_cmp(&b.0));
        changes
    };
    let first = events.first().map(|&(_, event)| event);
    let armed = Intervals::from_changes(
        &changes(StateEvent::Armed, &[StateEvent::Disarmed]),
        // If the first event is about flying or about the end of a flight, the vehicle was armed before the log began.
        first.is_some_and(|event| event != StateEvent::Armed),
        first_s,
        last_s,
        "EV 10 (armed) to EV 11 (disarmed), and ARM",
    );
    let in_air = Intervals::from_changes(
        &changes(
            StateEvent::Left,
            &[StateEvent::Landed, StateEvent::Disarmed],
        ),
        first == Some(StateEvent::Landed),
        first_s,
        last_s,
        "EV 28 (not landed) to EV 18 (land complete) or disarmed",
    );
    // Firmware before 3.1 logs arming, but not take-off.
    let is_about_flying = |event| matches!(event, StateEvent::Left | StateEvent::Landed);
    let is_known = events.iter().any(|&(_, event)| is_about_flying(event));
    (armed, is_known.then_some(in_air))
}

/// The boots at which the vehicle was in the air according to the events before them.
pub(super) fn boots_in_air(events: &[(f64, StateEvent)], boots_s: &[f64]) -> Vec<f64> {
    let is_flying = |boot_s: f64| {
        let before = events
            .iter()
            .rfind(|(t_s, event)| *t_s <= boot_s && *event != StateEvent::Armed);
        before.is_some_and(|(_, event)| *event == StateEvent::Left)
    };
    boots_s
        .iter()
        .copied()
        .filter(|boot_s| is_flying(*boot_s))
        .collect()
}
