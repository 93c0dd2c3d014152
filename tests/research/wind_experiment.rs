//! Draws a flight in wind: the risk from the motors, next to the wind estimate of the autopilot and, if the log of a
//! simulator contains it, the true wind.
//!
//! `cargo run -p flagred-tests --example wind_experiment -- FLIGHT.BIN wind.svg`

use std::{error::Error, fmt::Write as _, fs};

use flagred::{
    monitor::{Craft, Monitor, Sample},
    shipped,
};
use flagred_flightlog::Flight;

const WIDTH: f64 = 900.0;
const HEIGHT: f64 = 260.0;
const MARGIN: f64 = 50.0;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let (Some(log), Some(picture)) = (arguments.next(), arguments.next()) else {
        return Err("usage: wind_experiment FLIGHT PICTURE.svg".into());
    };
    let flight = flagred_flightlog::open(&log, &flagred_flightlog::Options::default())?;
    fs::write(picture, draw(&flight, &risks(&flight)?))?;
    Ok(())
}

/// Returns the times in seconds at which the risk is known, each with the risk in %.
fn risks(flight: &Flight) -> Result<Vec<(f64, f64)>, Box<dyn Error>> {
    let estimator = shipped::flagred();
    let mut monitor = Monitor::new(&estimator, Craft::new(flight.motors.len()))?;
    let mut risks = Vec::new();
    for (t_s, row) in flight.commands.rows() {
        let effective = |raw: &f64| flight.effective_command(*raw).unwrap_or(f64::NAN);
        let assessment = monitor.push(&Sample {
            t_s,
            motors: &row.iter().map(effective).collect::<Vec<f64>>(),
            in_air: flagred::log::in_air(flight, t_s),
            signals: &[],
        });
        risks.extend(assessment.risk.ok().map(|risk| (t_s, risk.risk_pct)));
    }
    Ok(risks)
}

fn draw(flight: &Flight, risks: &[(f64, f64)]) -> String {
    let (from_s, to_s) = match (risks.first(), risks.last()) {
        (Some(first), Some(last)) if last.0 > first.0 => (first.0, last.0),
        _ => (0.0, 1.0),
    };
    let signal = |name: &str| {
        let signal = flight.signal(name);
        let points = signal.into_iter().flat_map(|s| s.t_s.iter().zip(s.values));
        let known = points.map(|(t_s, value)| (*t_s, *value));
        let inside = known.filter(|(t_s, v)| v.is_finite() && (from_s..=to_s).contains(t_s));
        inside.collect::<Vec<(f64, f64)>>()
    };
    let (estimate, truth) = (signal("ekf_wind_m_s"), signal("wind_m_s"));
    let winds = estimate.iter().chain(&truth).map(|(_, wind)| *wind);
    let strongest = winds.fold(5.0, f64::max).ceil();
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" font-family=\"sans-serif\" font-size=\"12\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n\
         <text x=\"{MARGIN}\" y=\"20\" fill=\"#d55e00\">risk, 0 to 100 %</text>\
         <text x=\"240\" y=\"20\" fill=\"#0072b2\">autopilot's wind estimate, 0 to {strongest} m/s</text>\
         <text x=\"560\" y=\"20\" fill=\"#777777\">true wind</text>\n\
         <text x=\"{MARGIN}\" y=\"{0}\">{from_s:.0} s</text>\
         <text x=\"{1}\" y=\"{0}\" text-anchor=\"end\">{to_s:.0} s</text>\n",
        HEIGHT - 14.0,
        WIDTH - MARGIN
    );
    for (points, highest, colour) in [
        (truth.as_slice(), strongest, "#bbbbbb"),
        (estimate.as_slice(), strongest, "#0072b2"),
        (risks, 100.0, "#d55e00"),
    ] {
        svg.push_str("<polyline points=\"");
        // Five points per second are finer than the resolution of the picture.
        let mut next_s = f64::NEG_INFINITY;
        for (t_s, value) in points {
            if *t_s < next_s {
                continue;
            }
            next_s = t_s + 0.2;
            let x = MARGIN + (t_s - from_s) / (to_s - from_s) * (WIDTH - 2.0 * MARGIN);
            let y = HEIGHT - 36.0 - value / highest * (HEIGHT - 70.0);
            // Writing to a `String` cannot fail.
            let _ = write!(svg, "{x:.1},{y:.1} ");
        }
        let _ = writeln!(
            svg,
            "\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"1.5\"/>"
        );
    }
    svg.push_str("</svg>\n");
    svg
}
