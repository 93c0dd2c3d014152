//! Calm stretches of a flight: times without a critical error or a steep tilt.

use flagred::profile::CRITICAL_ERROR_DEG;
use flagred_flightlog::Attitude;

use crate::{critical::ErrorRecord, span::Span};

/// The time from take-off, in seconds, before which no calm stretch begins.
const AFTER_TAKE_OFF_S: f64 = 5.0;

/// The minimum distance of a calm stretch from critical errors, steep tilts and unknown attitudes, in seconds.
const AWAY_S: f64 = 10.0;

/// A tilt over this, in degrees, is steep.
const TILT_DEG: f64 = 45.0;

/// Attitudes that are unknown for at most this time, in seconds, do not end a calm stretch.
const UNKNOWN_S: f64 = 1.0;

/// The minimum length of a calm stretch, in seconds.
const SHORTEST_S: f64 = 20.0;

/// Returns the calm stretches of a time in the air: at least 20 s long, from 5 s after take-off, and 10 s away from any
/// attitude error over [`CRITICAL_ERROR_DEG`], any tilt over 45 degrees and any time of over 1 s without a known
/// attitude. An alarm in a calm stretch is needless.
///
/// # Example: one error of 20 degrees in a minute
///
/// ```
/// use flagred_evaluation::{ErrorRecord, Span, calm_stretches};
/// use flagred_flightlog::Attitude;
///
/// let attitudes = (0..1500).map(|i| {
///     let t_s = f64::from(i) * 0.04;
///     let roll_deg = if (10.0..11.0).contains(&t_s) { 20.0 } else { 0.0 };
///     (t_s, Attitude { roll_des_deg: 0.0, roll_deg, pitch_des_deg: 0.0, pitch_deg: 0.0 })
/// });
/// let attitudes: Vec<(f64, Attitude)> = attitudes.collect();
/// let errors = ErrorRecord::new(attitudes.iter().copied());
/// let calm = calm_stretches(&errors, &attitudes, Span { from_s: 0.0, to_s: 60.0 });
/// let [calm] = calm[..] else { return Err("one stretch") };
/// assert!((21.0..22.1).contains(&calm.from_s) && calm.to_s == 60.0);
/// # Ok::<(), &str>(())
/// ```
pub fn calm_stretches(errors: &ErrorRecord, attitudes: &[(f64, Attitude)], air: Span) -> Vec<Span> {
    let inside = attitudes.iter().filter(|(t_s, _)| air.contains(*t_s));
    let steep = inside
        .clone()
        .filter(|(_, attitude)| attitude.tilt_deg() > TILT_DEG)
        .map(|(t_s, _)| *t_s);
    let known = inside
        .filter(|(_, attitude)| attitude.squared_error_deg2().is_finite())
        .map(|(t_s, _)| *t_s);
    let mut last_s = air.from_s;
    let unknown = known
        .chain([air.to_s])
        .map(|t_s| (std::mem::replace(&mut last_s, t_s), t_s))
        .filter(|(from_s, to_s)| to_s - from_s > UNKNOWN_S);
    let moments = errors.times_over(CRITICAL_ERROR_DEG, air).chain(steep);
    let mut busy: Vec<(f64, f64)> = moments.map(|t_s| (t_s, t_s)).chain(unknown).collect();
    busy.sort_by(|(a, _), (b, _)| a.total_cmp(b));
    let mut calm = Vec::new();
    let mut from_s = air.from_s + AFTER_TAKE_OFF_S;
    let mut add = |from_s: f64, to_s: f64| {
        if to_s - from_s >= SHORTEST_S {
            calm.push(Span { from_s, to_s });
        }
    };
    for (busy_from_s, busy_to_s) in busy {
        add(from_s, busy_from_s - AWAY_S);
        from_s = from_s.max(busy_to_s + AWAY_S);
    }
    add(from_s, air.to_s);
    calm
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the calm stretches of a flight of two minutes at 25 Hz. The arguments are the periods with an error,
    /// with a steep tilt and with unknown attitudes.
    fn calm(error: (f64, f64), tilt: (f64, f64), none: (f64, f64)) -> Vec<[f64; 2]> {
        let is_in = |t_s: f64, (from_s, to_s): (f64, f64)| (from_s..to_s).contains(&t_s);
        let attitudes: Vec<(f64, Attitude)> = (0..=3000)
            .map(|i| f64::from(i) * 0.04)
            .filter(|t_s| !is_in(*t_s, none))
            .map(|t_s| {
                let pitch_deg = if is_in(t_s, tilt) { 50.0 } else { 0.0 };
                let attitude = Attitude {
                    roll_des_deg: 0.0,
                    roll_deg: if is_in(t_s, error) { 20.0 } else { 0.0 },
                    pitch_des_deg: pitch_deg,
                    pitch_deg,
                };
                (t_s, attitude)
            })
            .collect();
        let errors = ErrorRecord::new(attitudes.iter().copied());
        let air = Span {
            from_s: 0.0,
            to_s: 120.0,
        };
        let stretches = calm_stretches(&errors, &attitudes, air);
        let rounded = |s: Span| [s.from_s.round(), s.to_s.round()];
        stretches.into_iter().map(rounded).collect()
    }

    #[test]
    fn an_event_ends_calm_ten_seconds_before_and_after() {
        let never = (-1.0, -1.0);
        assert_eq!(calm(never, never, never), [[5.0, 120.0]]);
        let steep = calm(never, (60.0, 61.0), never);
        assert_eq!(steep, [[5.0, 50.0], [71.0, 120.0]]);
        assert_eq!(
            calm(never, never, (60.0, 63.0)),
            [[5.0, 50.0], [73.0, 120.0]]
        );
        // A stretch of 15 s is too short to count.
        assert_eq!(calm(never, (30.0, 31.0), never), [[41.0, 120.0]]);
        assert_eq!(
            calm((60.0, 61.0), (85.0, 86.0), never),
            [[5.0, 50.0], [96.0, 120.0]]
        );
        assert_eq!(calm(never, never, (0.0, 119.0)), [[0.0; 2]; 0]);
    }
}
