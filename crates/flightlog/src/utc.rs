//! Converts GPS time to UTC.

/// The start of GPS time, 6 January 1980, in seconds since 1970.
const GPS_EPOCH_S: f64 = 315_964_800.0;
/// UTC times in seconds, each with the number of leap seconds by which GPS time is ahead of UTC from then on (IERS
/// Bulletin C).
const LEAPS: &[(f64, f64)] = &[
    (1_483_228_800.0, 18.0),
    (1_435_708_800.0, 17.0),
    (1_341_100_800.0, 16.0),
    (1_230_768_000.0, 15.0),
];

/// Converts a GPS week and the seconds in that week to seconds since 1970.
pub(crate) fn from_gps_s(week: f64, seconds: f64) -> f64 {
    let gps_s = GPS_EPOCH_S + week * 604_800.0 + seconds;
    let leap = LEAPS.iter().find(|(from_s, leap)| gps_s - leap >= *from_s);
    gps_s - leap.map_or(14.0, |(_, leap)| *leap)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn leap_seconds_are_those_of_the_date() {
        // 2016-12-31 23:59:59 UTC was GPS 1167264016. A leap second followed, so midnight was two seconds later.
        let (week, seconds) = (1930.0, 1_167_264_016.0 - 1930.0 * 604_800.0);
        assert_eq!(from_gps_s(week, seconds), 1_483_228_799.0);
        assert_eq!(from_gps_s(week, seconds + 2.0), 1_483_228_800.0);
    }
}
