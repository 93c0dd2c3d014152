//! The path of the flight over the decision map, with two inputs of the rules as axes.

use std::fmt::Write as _;

use flagred::{estimator::Estimator, flight::Step, monitor::Estimate};
use fuzzy::{
    Model,
    drawing::{Colour, Scale, number, reds, runs},
};
use maud::{Markup, PreEscaped, html};

use crate::{names::words_of, panel::percent};

/// The number of cells along each side of the map.
const CELLS: usize = 48;
/// The maximum number of steps that are evaluated to find the inputs that affected the risk most.
const TRIED: usize = 200;
/// The maximum number of points of the path.
const POINTS: usize = 600;

/// The part of an input's range that the map shows: it contains the values at which the terms of the input change, and
/// the values during the flight.
pub(super) fn focus(model: &Model, name: &str, input: usize, steps: &[Step]) -> Scale {
    let Some(variable) = model.inputs.iter().find(|known| known.name == name) else {
        return Scale::new(0.0, 1.0);
    };
    let (low, high) = fuzzy::map::changing(variable);
    let seen = steps.iter().filter_map(|step| step.inputs.get(input));
    let seen = seen.filter(|x| x.is_finite());
    seen.map(|x| x.clamp(variable.low, variable.high))
        .fold(Scale::new(low, high), |scale, x| {
            Scale::new(scale.low.min(x), scale.high.max(x))
        })
}

/// The inputs that are the axes of the map, and the values of the other inputs.
struct Slice {
    /// The indices of the inputs along the axes: x, y.
    shown: [usize; 2],
    /// The mean of every input over the flight. On the map, the inputs that are not shown have these values.
    means: Vec<f64>,
}

/// Chooses the two inputs that affected the risk most over the flight. The effect of each is evaluated with the other
/// inputs at their means.
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

/// The map with the path; `None` for rules with one input, and if no risk is known.
pub(super) fn map(estimator: &Estimator, model: &Model, steps: &[Step]) -> Option<Markup> {
    let assessed: Vec<&Step> = steps
        .iter()
        .filter(|step| step.estimate.is_some() && step.inputs.iter().all(|x| x.is_finite()))
        .collect();
    let slice = slice(estimator, &assessed)?;
    let [x, y] = slice.shown;
    let inputs = &estimator.profile().inputs;
    let (x_name, y_name) = (&inputs.get(x)?.name, &inputs.get(y)?.name);
    let x_scale = focus(model, x_name, x, steps);
    let y_scale = focus(model, y_name, y, steps);
    let data_box = format!(
        "{} {} {} {}",
        x_scale.low, x_scale.high, y_scale.low, y_scale.high
    );
    let others: Vec<String> = inputs
        .iter()
        .zip(&slice.means)
        .enumerate()
        .filter(|(i, _)| !slice.shown.contains(i))
        .map(|(_, (input, mean))| format!("{} {}", words_of(&input.name), number(*mean, 3)))
        .collect();
    let drawing = cells(estimator, &slice, x_scale, y_scale)
        + &path(&assessed, [x, y], x_scale, y_scale)
        + r#"<path class="here" d="M-9-9h0"/>"#;
    let marks = |scale: Scale| [0.0, 0.5, 1.0].map(|share| (share, number(scale.value(share), 3)));
    Some(html! {
        figure.map data-x=(x) data-y=(y) data-box=(data_box) {
            figcaption { b { "The flight on the decision map" } " " output {} }
            p.axis { "↑ " (words_of(y_name)) }
            .frame {
                @for (share, label) in marks(y_scale) {
                    span.y style={ "bottom:" (percent(share)) } { (label) }
                }
                .area {
                    svg viewBox={ "0 -" (CELLS) " " (CELLS) " " (CELLS) } preserveAspectRatio="none" {
                        defs {
                            pattern id="hatch" width="1.5" height="1.5" patternUnits="userSpaceOnUse" {
                                path d="M0 0L1.5 1.5" {}
                            }
                        }
                        g transform="scale(1 -1)" { (PreEscaped(drawing)) }
                    }
                }
            }
            .times {
                @for (share, label) in marks(x_scale) {
                    span style={ "left:" (percent(share)) } { (label) }
                }
            }
            p.axis.across { (words_of(x_name)) " →" }
            p.axes {
                @if !others.is_empty() {
                    "The other inputs are held at their mean: " (others.join(", ")) ". "
                }
                "The line is the path of the flight. A larger dot means more time at that point. "
                "Hatched: no rule applies, the risk is interpolated."
            }
            p.legend {
                "risk 0 % "
                span { @for i in 0..20 { i style={ "background:" (colour(i)) } {} } }
                " 100 %"
            }
        }
    })
}

/// The appearance of a cell: the twentieth of the risk's range that contains its risk, and whether the risk is interpolated.
#[derive(Clone, Copy, PartialEq, Eq)]
struct CellAppearance {
    twentieth: u32,
    filled: bool,
}

impl CellAppearance {
    fn of(estimate: Estimate) -> Self {
        CellAppearance {
            twentieth: ((estimate.risk_pct / 5.0) as u32).min(19),
            filled: estimate.filled_from.is_some(),
        }
    }
}

/// The cells of the map, each one unit wide and high.
fn cells(estimator: &Estimator, slice: &Slice, x_scale: Scale, y_scale: Scale) -> String {
    let middle = |scale: Scale, i: usize| scale.value((i as f64 + 0.5) / CELLS as f64);
    let look = |i: usize, j: usize| {
        let mut point = slice.means.clone();
        let [x, y] = slice.shown;
        *point.get_mut(x)? = middle(x_scale, i);
        *point.get_mut(y)? = middle(y_scale, j);
        estimator.at(&point).map(CellAppearance::of)
    };
    let mut drawing = String::new();
    runs(CELLS, CELLS, look, |column, row, length, look| {
        let Some(CellAppearance { twentieth, filled }) = look else {
            return;
        };
        // Cells are drawn slightly larger, so that there is no gap between neighbours.
        let area = format!(r#"x="{column}" y="{row}" width="{length}.05" height="1.05""#);
        let (from, to) = (twentieth * 5, twentieth * 5 + 5);
        let word = if filled { " interpolated" } else { "" };
        // Writing to a String cannot fail.
        let _ = write!(
            drawing,
            r#"<rect {area} fill="{}" data-v="{from} to {to} %{word}"/>"#,
            colour(twentieth),
        );
        if filled {
            let _ = write!(drawing, r#"<rect class="hatch" {area}/>"#);
        }
    });
    drawing
}

/// The path of the flight, with dots for the time spent in each cell.
fn path(steps: &[&Step], [x, y]: [usize; 2], x_scale: Scale, y_scale: Scale) -> String {
    let mut visits = vec![0u32; CELLS * CELLS];
    let mut trail = String::new();
    let every = steps.len().div_ceil(POINTS).max(1);
    for (n, step) in steps.iter().enumerate() {
        let (Some(across), Some(up)) = (step.inputs.get(x), step.inputs.get(y)) else {
            continue;
        };
        let across = x_scale.share(*across) * CELLS as f64;
        let up = y_scale.share(*up) * CELLS as f64;
        let cell = |position: f64| (position.max(0.0) as usize).min(CELLS - 1);
        if let Some(count) = visits.get_mut(cell(up) * CELLS + cell(across)) {
            *count += 1;
        }
        if n % every == 0 {
            let command = if trail.is_empty() { 'M' } else { 'L' };
            let _ = write!(trail, "{command}{} {}", number(across, 2), number(up, 2));
        }
    }
    format!(r#"<path class="trail under" d="{trail}"/><path class="trail" d="{trail}"/>"#)
        + &dots(&visits)
}

/// A dot for each visited cell, in one of five sizes; its area grows with the time spent in the cell.
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
fn colour(twentieth: u32) -> Colour {
    reds(f64::from(twentieth) / 19.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_map_shows_where_its_terms_change_and_where_the_flight_was() {
        let model = flagred::shipped::flagred_paper_rules();
        assert_eq!(focus(&model, "spread", 1, &[]), Scale::new(0.0, 0.2));
        let far = Step {
            inputs: vec![0.1, 0.4],
            ..Step::default()
        };
        assert_eq!(focus(&model, "spread", 1, &[far]), Scale::new(0.0, 0.4));
    }
}
