//! The track of a flight over ground on a plain map: local metres, without tiles.

use std::fmt::Write as _;

use flagred::flight::{Assessment, Step};
use flagred_flightlog::{Flight, Signal};
use fuzzy::drawing::{Colour, number, reds};
use maud::{Markup, PreEscaped, html};

use crate::{clock::minutes, curve::Stretch};

/// The maximum number of points of a track. Each point has the highest risk of its span of time.
const POINTS: f64 = 1200.0;
/// The mean radius of the earth, in metres.
const EARTH_M: f64 = 6_371_008.8;
/// The smallest side of the map, in metres.
const SMALLEST_M: f64 = 20.0;
/// The number of colours of risk.
const COLOURS: u32 = 10;
/// The longest gap between two positions that the track still bridges, in seconds.
const LONGEST_GAP_S: f64 = 5.0;

/// A position and the highest risk until the next one.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Point {
    /// Seconds since the start of the track's stretch.
    x_s: f64,
    north_m: f64,
    east_m: f64,
    risk_pct: Option<f64>,
}

/// The map with the track; `None` if the log has no positions.
pub(crate) fn map(flight: &Flight, assessed: &Assessment, stretch: Stretch) -> Option<Markup> {
    let points = points(flight, &assessed.steps, stretch);
    let (first, last) = (points.first()?, points.last()?);
    let ends = |of: fn(&Point) -> f64| {
        let values = points.iter().map(of);
        values.fold((f64::MAX, f64::MIN), |(low, high), value| {
            (low.min(value), high.max(value))
        })
    };
    let (south, north) = ends(|point| point.north_m);
    let (west, east) = ends(|point| point.east_m);
    let side = ((north - south).max(east - west) * 1.16).max(SMALLEST_M);
    let (left, top) = ((west + east - side) / 2.0, -(south + north + side) / 2.0);
    let step = round_length(side / 4.0);
    let decimals = if side < 200.0 { 2 } else { 1 };
    let m = |metres: f64| number(metres, decimals);
    let place = |point: &Point| format!("{} {}", m(point.east_m), m(-point.north_m));
    let text = side / 30.0;
    let mut drawing = grid(left, top, side, step, m) + &lines(&points, place);
    // Writing to a String cannot fail.
    let _ = write!(
        drawing,
        r#"<path class="take-off" d="M{}h0"/><path class="landing" d="M{}h0"/><path class="here" d="M{}h0"/>"#,
        place(first),
        place(last),
        place(first),
    );
    let (bar_x, bar_y) = (left + side * 0.04, top + side * 0.95);
    let _ = write!(
        drawing,
        r#"<path class="scale" d="M{} {}v{}h{}v{}"/><text x="{}" y="{}" font-size="{}">{} m</text>"#,
        m(bar_x),
        m(bar_y - side * 0.012),
        m(side * 0.012),
        m(step),
        m(-side * 0.012),
        m(bar_x + step + text * 0.5),
        m(bar_y),
        m(text),
        number(step, 1),
    );
    let (north_x, north_y) = (left + side * 0.95, top + side * 0.04);
    let _ = write!(
        drawing,
        r#"<path class="scale" d="M{x} {y}l{a} {b}M{x} {y}l-{a} {b}M{x} {y}v{c}"/><text class="middle" x="{x}" y="{t}" font-size="{size}">N</text>"#,
        x = m(north_x),
        y = m(north_y),
        a = m(side * 0.012),
        b = m(side * 0.025),
        c = m(side * 0.06),
        t = m(north_y + side * 0.06 + text),
        size = m(text),
    );
    let data = points.iter().map(|point| {
        format!(
            "{} {} {}",
            number(point.x_s, 1),
            m(point.east_m),
            m(-point.north_m)
        )
    });
    let data = data.collect::<Vec<_>>().join(";");
    let length = minutes(stretch.length_s(), 0);
    Some(html! {
        figure.track data-start=(number(stretch.start_s, 3)) data-points=(data) {
            figcaption { b { "North is up." } " " output {} }
            .area {
                svg viewBox={ (m(left)) " " (m(top)) " " (m(side)) " " (m(side)) } {
                    title { "The track of " (length) " minutes, seen from above, north up, coloured by risk" }
                    (PreEscaped(drawing))
                }
            }
            p.legend {
                "risk 0 % "
                span { @for i in 0..COLOURS { i style={ "background:" (colour(i)) } {} } }
                " 100 % "
                @for (class, name) in [("unknown", "unknown"), ("take-off", "take-off"), ("landing", "landing")] {
                    b { span.(class) {} " " (name) } " "
                }
            }
        }
    })
}

/// The positions in a stretch in metres from the first one, thinned to the number of points of a track.
fn points(flight: &Flight, steps: &[Step], stretch: Stretch) -> Vec<Point> {
    let signal = |name| flight.signal(name);
    let global = signal("latitude_deg").zip(signal("longitude_deg"));
    let global = global.map(|both| local(positions(both, stretch)));
    let known = |all: &Vec<(f64, f64, f64)>| all.len() > 1;
    let all = global.filter(known).or_else(|| {
        let both = signal("north_m").zip(signal("east_m"))?;
        Some(positions(both, stretch)).filter(known)
    });
    let span_s = stretch.length_s() / POINTS;
    let mut points: Vec<Point> = Vec::new();
    let mut next_s = f64::NEG_INFINITY;
    for (t_s, north_m, east_m) in all.unwrap_or_default() {
        if t_s < next_s {
            continue;
        }
        next_s = t_s + span_s;
        points.push(Point {
            x_s: t_s - stretch.start_s,
            north_m,
            east_m,
            risk_pct: None,
        });
    }
    // Each point gets the highest risk between it and the next point.
    let mut steps = steps.iter().peekable();
    for i in 0..points.len() {
        let until_s = points.get(i + 1).map_or(f64::INFINITY, |next| next.x_s) + stretch.start_s;
        let mut highest: Option<f64> = None;
        while let Some(step) = steps.next_if(|step| step.t_s < until_s) {
            let risk = step.estimate.map(|estimate| estimate.risk_pct);
            highest = highest.into_iter().chain(risk).reduce(f64::max);
        }
        if let Some(point) = points.get_mut(i) {
            point.risk_pct = highest;
        }
    }
    points
}

/// The times at which both signals are known, each with the values of both.
fn positions((a, b): (Signal<'_>, Signal<'_>), stretch: Stretch) -> Vec<(f64, f64, f64)> {
    let mut other = b.hold();
    let all = a
        .t_s
        .iter()
        .zip(a.values)
        .map(|(&t_s, &value)| (t_s, value, other.at(t_s)));
    all.filter(|(t_s, value, _)| stretch.contains(*t_s) && value.is_finite())
        .filter_map(|(t_s, value, other)| Some((t_s, value, other?)))
        .collect()
}

/// Converts positions in degrees to metres north and east of the first one, on the tangent plane; accurate for flights of
/// some kilometres.
fn local(degrees: Vec<(f64, f64, f64)>) -> Vec<(f64, f64, f64)> {
    let Some(&(_, zero_north, zero_east)) = degrees.first() else {
        return Vec::new();
    };
    let shrink = zero_north.to_radians().cos();
    let metres = |(t_s, north, east): (f64, f64, f64)| {
        let across = (east - zero_east + 540.0).rem_euclid(360.0) - 180.0;
        let up = north - zero_north;
        (
            t_s,
            up.to_radians() * EARTH_M,
            across.to_radians() * EARTH_M * shrink,
        )
    };
    degrees.into_iter().map(metres).collect()
}

/// The largest of 1, 2 and 5 times a power of ten that is not larger than `longest`.
fn round_length(longest: f64) -> f64 {
    let power = 10f64.powf(longest.log10().floor());
    let fits = [5.0, 2.0]
        .into_iter()
        .find(|times| times * power <= longest);
    fits.unwrap_or(1.0) * power
}

/// The grid of the map, with a line every `step` metres.
fn grid(left: f64, top: f64, side: f64, step: f64, m: impl Fn(f64) -> String) -> String {
    let mut data = String::new();
    for i in 0..=(side / step) as usize {
        let along = |start: f64| ((start / step).ceil() + i as f64) * step;
        let (x, y) = (along(left), along(top));
        let _ = write!(data, "M{} {}v{}", m(x), m(top), m(side));
        let _ = write!(data, "M{} {}h{}", m(left), m(y), m(side));
    }
    format!(r#"<path class="grid" d="{data}"/>"#)
}

/// The track: a path for each stretch of one colour, over a wider path that separates it from the background.
fn lines(points: &[Point], place: impl Fn(&Point) -> String) -> String {
    let class = |point: &Point| {
        point
            .risk_pct
            .map(|risk| ((risk / 10.0) as u32).min(COLOURS - 1))
    };
    let mut under = String::new();
    let mut paths = String::new();
    let mut open: Option<(Option<u32>, String)> = None;
    let mut close = |open: Option<(Option<u32>, String)>| {
        if let Some((class, data)) = open {
            let _ = match class {
                Some(class) => write!(paths, r#"<path d="{data}" stroke="{}"/>"#, colour(class)),
                None => write!(paths, r#"<path class="unknown" d="{data}"/>"#),
            };
        }
    };
    for pair in points.windows(2) {
        let [from, to] = pair else { continue };
        if to.x_s - from.x_s > LONGEST_GAP_S {
            close(open.take());
            continue;
        }
        let line = format!("L{}", place(to));
        match &mut open {
            Some((of, data)) if *of == class(from) => {
                *data += &line;
                under += &line;
            }
            other => {
                let started = format!("M{}{line}", place(from));
                match other {
                    Some(_) => under += &line,
                    None => under += &started,
                }
                close(open.replace((class(from), started)));
            }
        }
    }
    close(open);
    format!(r#"<path class="under" d="{under}"/>{paths}"#)
}

/// Returns the colour of a tenth of the range of risk. The lightest colours of the scale are not used, because they are
/// too pale for a line.
fn colour(tenth: u32) -> Colour {
    reds(0.18 + 0.82 * f64::from(tenth) / f64::from(COLOURS - 1))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flight(rows: &str) -> Flight {
        let log = format!("t_s,motor1,latitude_deg,longitude_deg\n{rows}");
        let options = flagred_flightlog::Options::default();
        flagred_flightlog::read(log.as_bytes(), &options).unwrap()
    }

    const ALL: Stretch = Stretch {
        start_s: 0.0,
        end_s: 100.0,
    };

    #[test]
    fn degrees_become_metres_also_across_the_date_line() {
        let flight =
            flight("0,0.5,60,179.9999\n10,0.5,60.001,-179.9999\n20,0.5,,\n30,0.5,60,179.9999\n");
        let points = points(&flight, &[], ALL);
        assert_eq!(points.len(), 3, "{points:?}");
        assert!((points[1].north_m - 111.195).abs() < 0.01);
        assert!((points[1].east_m - 11.119).abs() < 0.01);
        assert_eq!(points[2].east_m, 0.0);
    }

    #[test]
    fn a_track_has_the_highest_risk_of_each_span_and_none_where_it_is_unknown() {
        let flight = flight("0,0.5,50,8\n1,0.5,50.0001,8\n2,0.5,50.0002,8\n");
        let step = |t_s, risk_pct: Option<f64>| Step {
            t_s,
            estimate: risk_pct.map(|risk_pct| flagred::monitor::Estimate {
                risk_pct,
                coverage: 1.0,
                filled_from: None,
                dominant_rule: None,
                clamped: false,
            }),
            ..Step::default()
        };
        let steps = [
            step(0.1, Some(20.0)),
            step(0.2, Some(70.0)),
            step(1.5, None),
        ];
        let risks: Vec<_> = points(&flight, &steps, ALL)
            .iter()
            .map(|p| p.risk_pct)
            .collect();
        assert_eq!(risks, [Some(70.0), None, None]);
        let mut assessed = assessment();
        assessed.steps = steps.to_vec();
        let map = map(&flight, &assessed, ALL).unwrap().into_string();
        assert_eq!(map.matches(r#"class="unknown" d=""#).count(), 1);
        assert!(map.contains(&format!(r#"stroke="{}""#, colour(7))), "{map}");
        assert!(map.contains(">5 m</text>"), "{map}");
    }

    #[test]
    fn a_flight_without_positions_has_no_track() {
        let flight = flight("0,0.5,,\n1,0.5,,\n");
        assert!(map(&flight, &assessment(), ALL).is_none());
    }

    fn assessment() -> Assessment {
        let flight = flight("0,0.5,,\n1,0.5,,\n");
        flagred::log::assess(&flight, &flagred::shipped::flagred(), None)
    }
}
