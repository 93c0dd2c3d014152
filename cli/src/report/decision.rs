//! The flight's path over the decision map: two inputs of the rules, and where between them the time was spent.

use std::fmt::Write as _;

use flagred::{estimator::Estimator, flight::Step};
use fuzzy::Model;

use crate::drawing::{
    palette,
    text::{Escaped, number},
};

/// Cells along each side of the map.
const CELLS: usize = 48;
/// Steps of a flight that are tried to find out which inputs moved the risk.
const TRIED: usize = 200;
/// Points of the path.
const POINTS: usize = 600;

/// The part of an input's range worth showing: where its terms differ, and where the flight was.
pub(crate) fn focus(model: &Model, name: &str, input: usize, steps: &[Step]) -> (f64, f64) {
    let Some(variable) = model.inputs.iter().find(|known| known.name == name) else {
        return (0.0, 1.0);
    };
    let whole = (variable.low, variable.high);
    let mut corners = Vec::new();
    for term in &variable.terms {
        match term.shape.corners() {
            Some(points) => corners.extend(points.into_iter().map(|(x, _)| x)),
            // A curve ends nowhere.
            None => return whole,
        }
    }
    let seen = steps.iter().filter_map(|step| step.inputs.get(input));
    let hull = corners
        .into_iter()
        .chain(seen.copied())
        .filter(|x| x.is_finite())
        .map(|x| x.clamp(whole.0, whole.1))
        .map(|x| (x, x))
        .reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)));
    match hull {
        Some((low, high)) if high > low => (low, high),
        _ => whole,
    }
}

/// The slice of the map that tells most of a flight.
struct Slice {
    /// The inputs along the sides: x, y.
    shown: [usize; 2],
    /// The value of every input; those that are not shown stay at it.
    means: Vec<f64>,
}

/// Takes the two inputs that moved the risk most over the flight, each alone and the others at their mean.
fn slice(estimator: &Estimator, steps: &[&Step]) -> Option<Slice> {
    let inputs = estimator.profile().inputs.len();
    if inputs < 2 || steps.is_empty() {
        return None;
    }
    let means: Vec<f64> = (0..inputs)
        .map(|i| {
            let sum: f64 = steps.iter().filter_map(|step| step.inputs.get(i)).sum();
            sum / steps.len() as f64
        })
        .collect();
    let every = steps.len().div_ceil(TRIED);
    let mut effects: Vec<(usize, f64)> = (0..inputs)
        .map(|i| {
            let mut values = means.clone();
            let tried = steps.iter().step_by(every).filter_map(|step| {
                *values.get_mut(i)? = *step.inputs.get(i)?;
                Some(estimator.at(&values)?.risk_pct)
            });
            let risks: Vec<f64> = tried.collect();
            let mean = risks.iter().sum::<f64>() / risks.len().max(1) as f64;
            (i, risks.iter().map(|risk| (risk - mean).powi(2)).sum())
        })
        .collect();
    effects.sort_by(|a, b| b.1.total_cmp(&a.1));
    let mut shown = [effects.first()?.0, effects.get(1)?.0];
    shown.sort_unstable();
    Some(Slice { shown, means })
}

/// The map with the path, for the report; `None` for rules of one input and where nothing was assessed.
pub(crate) fn html(estimator: &Estimator, model: &Model, steps: &[Step]) -> Option<String> {
    let assessed: Vec<&Step> = steps
        .iter()
        .filter(|step| step.estimate.is_some() && step.inputs.iter().all(|x| x.is_finite()))
        .collect();
    let slice = slice(estimator, &assessed)?;
    let names: Vec<&str> = slice
        .shown
        .iter()
        .filter_map(|i| estimator.profile().inputs.get(*i))
        .map(|input| input.name.as_str())
        .collect();
    let [x_name, y_name] = names[..] else {
        return None;
    };
    let [x, y] = slice.shown;
    let (x_low, x_high) = focus(model, x_name, x, steps);
    let (y_low, y_high) = focus(model, y_name, y, steps);
    let column = |value: f64| (value - x_low) / (x_high - x_low) * CELLS as f64;
    let row = |value: f64| (value - y_low) / (y_high - y_low) * CELLS as f64;

    let mut drawing = String::new();
    for j in 0..CELLS {
        let at_row = y_low + (j as f64 + 0.5) / CELLS as f64 * (y_high - y_low);
        let values = (0..CELLS).map(|i| {
            let at_column = x_low + (i as f64 + 0.5) / CELLS as f64 * (x_high - x_low);
            let mut point = slice.means.clone();
            for (place, value) in [(x, at_column), (y, at_row)] {
                if let Some(kept) = point.get_mut(place) {
                    *kept = value;
                }
            }
            Cell::of(estimator.at(&point))
        });
        draw_row(&mut drawing, j, &values.collect::<Vec<_>>());
    }
    let mut visits = vec![0u32; CELLS * CELLS];
    let mut trail = String::new();
    let every = assessed.len().div_ceil(POINTS).max(1);
    for (n, step) in assessed.iter().enumerate() {
        let (Some(across), Some(up)) = (step.inputs.get(x), step.inputs.get(y)) else {
            continue;
        };
        let (across, up) = (column(*across), row(*up));
        let cell = |place: f64| (place.max(0.0) as usize).min(CELLS - 1);
        if let Some(count) = visits.get_mut(cell(up) * CELLS + cell(across)) {
            *count += 1;
        }
        if n % every == 0 {
            let command = if trail.is_empty() { 'M' } else { 'L' };
            let _ = write!(trail, "{command}{} {}", number(across, 2), number(up, 2));
        }
    }
    let _ = write!(
        drawing,
        r#"<path class="trail under" d="{trail}"/><path class="trail" d="{trail}"/>"#
    );
    drawing += &dots(&visits);
    drawing += r#"<path class="here" d="M-9-9h0"/>"#;

    let others: Vec<String> = estimator
        .profile()
        .inputs
        .iter()
        .zip(&slice.means)
        .enumerate()
        .filter(|(i, _)| !slice.shown.contains(i))
        .map(|(_, (input, mean))| format!("{} {}", Escaped(&input.name), number(*mean, 3)))
        .collect();
    let others = match others.as_slice() {
        [] => String::new(),
        others => format!(" The other inputs at their mean: {}.", others.join(", ")),
    };
    let tick = |value: f64| number(value, 3);
    Some(format!(
        r#"<figure class="map" data-x="{x}" data-y="{y}" data-box="{x_low} {x_high} {y_low} {y_high}"><figcaption><b>Where the flight was on the decision map</b> <output></output></figcaption><div class="frame"><span class="y" style="bottom:0">{}</span><span class="y" style="bottom:50%">{}</span><span class="y" style="bottom:100%">{}</span><div class="area"><svg class="plot" viewBox="0 -{CELLS} {CELLS} {CELLS}" preserveAspectRatio="none"><defs><pattern id="hatch" width="1.5" height="1.5" patternUnits="userSpaceOnUse"><path d="M0 0L1.5 1.5"/></pattern></defs><g transform="scale(1 -1)">{drawing}</g></svg></div></div><div class="times"><span style="left:0">{}</span><span style="left:50%">{}</span><span style="left:100%">{}</span></div><p class="axes">{} to the right, {} upwards.{others} A dot is where time was spent, the larger the longer; the line is the flight's path. Hatched: no rule covers it, filled in from beside.</p>{}</figure>"#,
        tick(y_low),
        tick((y_low + y_high) / 2.0),
        tick(y_high),
        tick(x_low),
        tick((x_low + x_high) / 2.0),
        tick(x_high),
        Escaped(x_name),
        Escaped(y_name),
        legend(),
    ))
}

/// What is drawn of a cell of the map: the twentieth of the range its risk lies in.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Cell {
    Unknown,
    Risk { twentieth: u32, filled: bool },
}

impl Cell {
    fn of(estimate: Option<flagred::monitor::Estimate>) -> Self {
        estimate.map_or(Cell::Unknown, |estimate| Cell::Risk {
            twentieth: ((estimate.risk_pct / 5.0) as u32).min(19),
            filled: estimate.filled_from.is_some(),
        })
    }
}

/// Draws one row; neighbours that look the same become one rectangle.
fn draw_row(drawing: &mut String, row: usize, cells: &[Cell]) {
    let mut start = 0;
    for run in cells.chunk_by(|a, b| a == b) {
        if let Some(Cell::Risk { twentieth, filled }) = run.first() {
            // A little wider than it is, so that no seam is seen between neighbours.
            let length = run.len();
            let place = format!(r#"x="{start}" y="{row}" width="{length}.05" height="1.05""#);
            let from = twentieth * 5;
            let word = if *filled { " filled" } else { "" };
            let _ = write!(
                drawing,
                r#"<rect {place} fill="{}" data-v="{from} to {} %{word}"/>"#,
                colour(*twentieth),
                from + 5
            );
            if *filled {
                let _ = write!(drawing, r#"<rect class="hatch" {place}/>"#);
            }
        }
        start += run.len();
    }
}

/// The time spent in each cell as dots whose area grows with it, in five sizes.
fn dots(visits: &[u32]) -> String {
    let most = visits.iter().copied().max().unwrap_or(0).max(1);
    let mut sizes = [const { String::new() }; 5];
    for (cell, count) in visits.iter().enumerate().filter(|(_, count)| **count > 0) {
        let share = (f64::from(*count) / f64::from(most)).sqrt();
        let size = ((share * 5.0) as usize).min(4);
        if let Some(data) = sizes.get_mut(size) {
            let _ = write!(data, "M{}.5 {}.5h0", cell % CELLS, cell / CELLS);
        }
    }
    let draw = |class: &str, wider: usize| {
        let drawn = sizes
            .iter()
            .enumerate()
            .filter(|(_, data)| !data.is_empty());
        drawn
            .map(|(size, data)| {
                let width = 3 + 3 * size + wider;
                format!(r#"<path class="{class}" d="{data}" style="stroke-width:{width}"/>"#)
            })
            .collect::<String>()
    };
    draw("dot under", 2) + &draw("dot", 0)
}

/// The colour of a twentieth of the range.
fn colour(twentieth: u32) -> palette::Colour {
    palette::risk(f64::from(twentieth) / 19.0)
}

fn legend() -> String {
    let swatches: String = (0..20)
        .map(|i| format!(r#"<i style="background:{}"></i>"#, colour(i)))
        .collect();
    format!(r#"<p class="legend">risk 0 % <span>{swatches}</span> 100 %</p>"#)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_neighbours_become_one_rectangle() {
        let low = Cell::Risk {
            twentieth: 1,
            filled: false,
        };
        let high = Cell::Risk {
            twentieth: 18,
            filled: true,
        };
        let mut drawing = String::new();
        draw_row(&mut drawing, 3, &[low, low, Cell::Unknown, high]);
        assert_eq!(drawing.matches("<rect").count(), 3, "{drawing}");
        assert!(drawing.contains(r#"x="0" y="3" width="2.05""#), "{drawing}");
        assert!(drawing.contains("90 to 95 % filled"), "{drawing}");
    }

    #[test]
    fn a_map_shows_where_its_terms_differ_and_where_the_flight_was() {
        let model = flagred::shipped::flagred_rules();
        assert_eq!(focus(&model, "unsteady_now", 0, &[]), (0.0, 0.05));
        let far = Step {
            inputs: vec![0.2],
            ..Step::default()
        };
        assert_eq!(focus(&model, "unsteady_now", 0, &[far]), (0.0, 0.2));
    }
}
