//! A map of the dominant rules: areas labelled with rule numbers.

use std::collections::BTreeMap;

use super::{
    colour::distinct,
    document::{Anchor, Frame, SvgDocument},
    heat::{axes, cells, whole_title},
    scale::Scale,
    slice::Slice,
};
use crate::model::Model;

/// The maximum number of rules in the legend; further rules appear only as numbers in the drawing.
const NAMED: usize = 20;

/// Returns an SVG of a slice in which each area is labelled with the number of its dominant rule, counted from 1.
pub fn rules_svg(slice: &Slice, model: &Model) -> String {
    // The cells that each rule dominates.
    let mut areas: BTreeMap<usize, Vec<(usize, usize)>> = BTreeMap::new();
    for i in 0..slice.columns() {
        for j in 0..slice.rows() {
            if let Some(rule) = slice.cell(i, j).rule {
                areas.entry(rule).or_default().push((i, j));
            }
        }
    }
    let order: Vec<usize> = areas.keys().copied().collect();
    let mut document = SvgDocument::map();
    let frame = Frame::MAP;
    let title = format!("{}, dominant rule", slice.title());
    document.heading(frame.left, &title, &slice.fixed_text());
    cells(&mut document, slice, |i, j| {
        let rule = slice.cell(i, j).rule?;
        order.binary_search(&rule).ok().map(distinct)
    });
    let share = |i: usize, count: usize| i as f64 / (count - 1).max(1) as f64;
    for (rule, area) in &areas {
        // The cell nearest to the mean of the area: the mean itself may lie outside.
        let mean = |part: fn(&(usize, usize)) -> usize| {
            area.iter().map(|cell| part(cell) as f64).sum::<f64>() / area.len() as f64
        };
        let middle = (mean(|cell| cell.0), mean(|cell| cell.1));
        let distance = |cell: &&(usize, usize)| {
            (cell.0 as f64 - middle.0).powi(2) + (cell.1 as f64 - middle.1).powi(2)
        };
        let nearest = area
            .iter()
            .min_by(|a, b| distance(a).total_cmp(&distance(b)));
        if let Some((i, j)) = nearest {
            let at = frame.label_at(share(*i, slice.columns()), share(*j, slice.rows()));
            document.text_on(at, &(rule + 1).to_string());
        }
    }
    match &slice.y {
        Some(y) => axes(&mut document, slice, y.scale(), &y.title()),
        None => axes(&mut document, slice, Scale::new(0.0, 1.0), ""),
    }
    let keys = order.iter().take(NAMED).enumerate().map(|(i, rule)| {
        let consequents = model
            .rules
            .get(*rule)
            .map(|rule| rule.rule.consequents.iter());
        let terms = consequents
            .into_iter()
            .flatten()
            .map(|c| c.term.text.as_str());
        let terms: Vec<&str> = terms.collect();
        (distinct(i), format!("{}: {}", rule + 1, terms.join(", ")))
    });
    let left = frame.right() + 12.0;
    document.legend_entries(left, frame.top, &keys.collect::<Vec<_>>());
    if order.len() > NAMED {
        let at = (left, frame.top + 18.0 * NAMED as f64 + 10.0);
        let more = format!("and {} more", order.len() - NAMED);
        document.text(at, Anchor::Start, "label", &more);
    }
    document.notes(slice);
    document.finish(&format!("{}, dominant rule", whole_title(slice)))
}
