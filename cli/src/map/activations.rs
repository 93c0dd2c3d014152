//! Which rule dominates where: areas with the numbers of their rules.

use std::collections::BTreeMap;

use fuzzy::Model;

use super::{
    heat::{cells, hatch},
    slice::Slice,
    svg::{Anchor, Frame, Sheet, px},
};
use crate::drawing::palette::distinct;

/// The rules named in the legend; a picture with more is read by its numbers.
const NAMED: usize = 20;

/// The most letters of a rule in the legend.
const LETTERS: usize = 30;

pub(super) fn draw(slice: &Slice, model: &Model) -> String {
    let title = format!("{}: the rule that dominates", slice.title());
    let rows = slice.y.as_ref().map_or(1, |y| y.places.len());
    // Where each rule dominates: the sums of the places, and how many.
    let mut areas: BTreeMap<usize, Vec<(usize, usize)>> = BTreeMap::new();
    for i in 0..slice.x.places.len() {
        for j in 0..rows {
            if let Some(rule) = slice.cell(i, j).rule {
                areas.entry(rule).or_default().push((i, j));
            }
        }
    }
    let order: Vec<usize> = areas.keys().copied().collect();
    let mut sheet = Sheet::default();
    sheet.heading(&title);
    let colour = |i: usize, j: usize| {
        let rule = slice.cell(i, j).rule?;
        order.binary_search(&rule).ok().map(distinct)
    };
    cells(&mut sheet, slice, colour);
    hatch(&mut sheet, slice);
    let frame = Frame::USUAL;
    let (columns, rows) = (slice.x.places.len() - 1, rows.saturating_sub(1).max(1));
    for (rule, area) in &areas {
        // The cell nearest to the middle of the area: the middle itself may lie outside.
        let mean = |part: fn(&(usize, usize)) -> usize| {
            area.iter().map(|cell| part(cell) as f64).sum::<f64>() / area.len() as f64
        };
        let middle = (mean(|cell| cell.0), mean(|cell| cell.1));
        let away = |cell: &&(usize, usize)| {
            (cell.0 as f64 - middle.0).powi(2) + (cell.1 as f64 - middle.1).powi(2)
        };
        let nearest = area.iter().min_by(|a, b| away(a).total_cmp(&away(b)));
        if let Some((i, j)) = nearest {
            let (x, y) = frame.at(*i as f64 / columns as f64, *j as f64 / rows as f64);
            let inside = (
                x.clamp(frame.left + 10.0, frame.left + frame.width - 10.0),
                y.clamp(frame.top + 14.0, frame.top + frame.height - 8.0) + 4.0,
            );
            sheet.text_on(inside, &(rule + 1).to_string());
        }
    }
    let vertical = slice.y.as_ref();
    let range = vertical.map_or((0.0, 1.0), |y| (y.low(), y.high()));
    let y_title = vertical.map(|y| y.title()).unwrap_or_default();
    sheet.axes(&frame, slice, range, &y_title);
    for (place, rule) in order.iter().take(NAMED).enumerate() {
        let y = frame.top + 18.0 * place as f64;
        let left = frame.left + frame.width + 12.0;
        sheet.push(format_args!(
            "<rect x=\"{}\" y=\"{}\" width=\"11\" height=\"11\" fill=\"{}\" stroke=\"#1a1a1a\" stroke-width=\".5\"/>",
            px(left),
            px(y),
            distinct(place)
        ));
        let said = model.rules.get(*rule).map(|r| {
            let consequents = r.rule.consequents.iter();
            let words: Vec<&str> = consequents.map(|c| c.term.text.as_str()).collect();
            words.join(", ")
        });
        let text: String = format!("{}: {}", rule + 1, said.unwrap_or_default());
        let text: String = text.chars().take(LETTERS).collect();
        sheet.text((left + 16.0, y + 10.0), Anchor::Start, "label", &text);
    }
    if order.len() > NAMED {
        let y = frame.top + 18.0 * NAMED as f64 + 10.0;
        let left = frame.left + frame.width + 12.0;
        let more = format!("and {} more", order.len() - NAMED);
        sheet.text((left, y), Anchor::Start, "label", &more);
    }
    sheet.notes(slice);
    sheet.finish(&title)
}
