//! Upsets: times at which the attitude was lost, and whether an alarm preceded them.

use flagred_flightlog::Attitude;

use crate::{critical::ErrorRecord, span::Span};

/// The attitude is lost if its error, as a root mean square over a second, exceeds this, in degrees.
const ERROR_DEG: f64 = 30.0;

/// The attitude is also lost if the vehicle tilts by more than this, in degrees, without being commanded to.
const TILT_DEG: f64 = 60.0;

/// A tilt counts as commanded if the set point tilts by at least this, in degrees.
const COMMANDED_TILT_DEG: f64 = 50.0;

/// The time before and after an intentional flip that is ignored, in seconds. The vehicle flips intentionally while
/// its set point tilts by more than [`TILT_DEG`].
const FLIP_S: f64 = 2.0;

/// An alarm precedes an upset if it was on at any time within this many seconds before the upset.
const BEFORE_S: f64 = 10.0;

/// An alarm follows an upset if it was raised within this many seconds after the upset.
const AFTER_S: f64 = 1.0;

/// Whether an alarm was on before an upset, was raised just after it, or neither.
///
/// # Example: an alarm that is on four seconds before the upset
/// ```
/// use flagred_evaluation::{Span, UpsetAlarm};
///
/// let (air, alarm) = (Span { from_s: 0.0, to_s: 60.0 }, Span { from_s: 26.0, to_s: 28.0 });
/// assert_eq!(UpsetAlarm::of(30.0, air, &[alarm]), UpsetAlarm::Before { lead_s: 4.0 });
/// assert_eq!(UpsetAlarm::of(25.5, air, &[alarm]), UpsetAlarm::After);
/// assert_eq!(UpsetAlarm::of(50.0, air, &[alarm]), UpsetAlarm::Never);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum UpsetAlarm {
    /// An alarm was on at some time in the 10 s before the upset.
    Before {
        /// How long before the upset this alarm was raised, in seconds. Time before the take-off does not count.
        lead_s: f64,
    },
    /// No alarm was on before the upset, but one was raised within 1 s after it.
    After,
    /// No alarm was on or raised from 10 s before the upset to 1 s after it.
    Never,
}

impl UpsetAlarm {
    /// Classifies an upset at `upset_s`, during the flight `air`, by the alarms.
    pub fn of(upset_s: f64, air: Span, alarms: &[Span]) -> UpsetAlarm {
        let earliest_s = air.from_s.max(upset_s - BEFORE_S);
        let before = alarms
            .iter()
            .filter(|alarm| alarm.from_s <= upset_s && alarm.to_s >= earliest_s)
            .map(|alarm| upset_s - alarm.from_s.max(air.from_s))
            .reduce(f64::max);
        match before {
            Some(lead_s) => UpsetAlarm::Before { lead_s },
            None if alarms
                .iter()
                .any(|alarm| alarm.from_s > upset_s && alarm.from_s <= upset_s + AFTER_S) =>
            {
                UpsetAlarm::After
            }
            None => UpsetAlarm::Never,
        }
    }
}

/// Returns the time at which the attitude was first lost during the flight `air`: the error over a second exceeds
/// 30 degrees, or the vehicle tilts by more than 60 degrees while its set point tilts by less than 50. `None` if
/// it was never lost.
///
/// Intentional flips are ignored: the times within 2 s of a set point that tilts by more than 60 degrees.
pub fn upset_s(errors: &ErrorRecord, attitudes: &[(f64, Attitude)], air: Span) -> Option<f64> {
    let inside = || attitudes.iter().filter(|(t_s, _)| air.contains(*t_s));
    let flips = inside().filter(|(_, attitude)| attitude.commanded_tilt_deg() > TILT_DEG);
    let flips_s: Vec<f64> = flips.map(|(t_s, _)| *t_s).collect();
    let is_flown = |t_s: f64| {
        let mut flips = flips_s.iter();
        flips.any(|flip_s| (t_s - flip_s).abs() < FLIP_S)
    };
    let by_tilt = inside().filter(|(_, attitude)| {
        let is_commanded = attitude.commanded_tilt_deg() >= COMMANDED_TILT_DEG;
        attitude.tilt_deg() > TILT_DEG && !is_commanded
    });
    let by_error = errors.times_over(ERROR_DEG, air);
    by_error
        .chain(by_tilt.map(|(t_s, _)| *t_s))
        .filter(|t_s| !is_flown(*t_s))
        .reduce(f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    const AIR: Span = Span {
        from_s: 5.0,
        to_s: 60.0,
    };

    #[test]
    fn an_alarm_precedes_an_upset_if_it_was_on_in_the_ten_seconds_before() {
        let before = |lead_s| UpsetAlarm::Before { lead_s };
        for (alarm, upset_s, expected) in [
            ((20.0, 25.0), 30.0, before(10.0)),
            ((20.0, 20.0), 30.0, before(10.0)),
            ((10.0, 19.9), 30.0, UpsetAlarm::Never),
            ((30.0, 40.0), 30.0, before(0.0)),
            ((30.1, 40.0), 30.0, UpsetAlarm::After),
            ((31.0, 40.0), 30.0, UpsetAlarm::After),
            ((31.1, 40.0), 30.0, UpsetAlarm::Never),
            // The alarm was raised before take-off.
            ((1.0, 40.0), 30.0, before(25.0)),
            ((1.0, 4.0), 8.0, UpsetAlarm::Never),
        ] {
            let alarm = Span {
                from_s: alarm.0,
                to_s: alarm.1,
            };
            let found = UpsetAlarm::of(upset_s, AIR, &[alarm]);
            assert_eq!(found, expected, "{alarm:?}, upset at {upset_s} s");
        }
    }

    #[test]
    fn the_attitude_is_lost_by_its_error_or_by_an_uncommanded_tilt() {
        // A flight at 10 Hz. From 40 s until `until_s`, the roll angle and its set point have the given values.
        let upset = |roll_deg: f64, roll_des_deg: f64, until_s: f64| {
            let attitudes: Vec<(f64, Attitude)> = (0..600)
                .map(|i| {
                    let t_s = f64::from(i) / 10.0;
                    let is_off = (40.0..until_s).contains(&t_s);
                    let of = |value: f64| if is_off { value } else { 0.0 };
                    let attitude = Attitude {
                        roll_des_deg: of(roll_des_deg),
                        roll_deg: of(roll_deg),
                        pitch_des_deg: 0.0,
                        pitch_deg: 0.0,
                    };
                    (t_s, attitude)
                })
                .collect();
            upset_s(
                &ErrorRecord::new(attitudes.iter().copied()),
                &attitudes,
                AIR,
            )
        };
        assert_eq!(upset(61.0, 0.0, 40.2), Some(40.0));
        assert_eq!(upset(61.0, 51.0, 60.0), None);
        assert_eq!(upset(59.0, 0.0, 40.2), None);
        // An error of 40 degrees during a share x of the second gives a root mean square of 40 sqrt(x), which is over
        // 30 from x = 0.5625 on.
        assert_eq!(upset(40.0, 0.0, 60.0), Some(40.5));
        assert_eq!(upset(29.0, 0.0, 60.0), None);
        // A flip is commanded from 40 s to 42 s.
        assert_eq!(upset(100.0, 61.0, 42.0), None);
    }
}
