//! A map as CSV: a row for each cell.

use flagred::gap::Filling;
use fuzzy::{
    drawing::{Cell, Slice, short},
    map::{DecisionMap, Grid},
};

use super::{Arguments, MapSource, points_along};
use crate::{failure::Failure, output};

/// Returns every cell of the map over all inputs.
pub(super) fn whole(arguments: &Arguments, evaluated: MapSource) -> Result<String, Failure> {
    let points = match arguments.points {
        Some(points) => usize::from(points),
        None => points_along(evaluated.engine.model().inputs.len()),
    };
    let no_map = |error: &dyn std::fmt::Display| {
        Failure::unreadable(format!(
            "`{}` cannot be mapped: {error}",
            arguments.model.display()
        ))
    };
    let grid = Grid::new(&evaluated.engine, points).map_err(|error| no_map(&error))?;
    let map = DecisionMap::new(&evaluated.engine, grid, evaluated.output).map_err(|error| {
        let help = "use fewer `--points`, or `flagred eval` at the points of a table";
        no_map(&error).help(help)
    })?;
    let filling = evaluated.filling.map(|(filling, _)| filling);
    let axes = map.grid().axes().iter().map(|axis| &*axis.name);
    let mut out = head(axes, map.output())?;
    for cell in 0..map.grid().cells() {
        let point = map.grid().point(cell);
        let is_gap = |filling: &&Filling| filling.is_gap(map.coverage(cell));
        let reading = filling.as_ref().filter(is_gap);
        let reading = reading.and_then(|filling| filling.read(&point));
        let value = reading.map(|reading| reading.value).or(map.value(cell));
        row(
            &mut out,
            &point,
            &Cell {
                value,
                coverage: map.coverage(cell),
                rule: map.dominant(cell),
                filled_from: reading.map(|reading| reading.distance),
            },
        );
    }
    Ok(out)
}

/// Returns the names of the columns.
pub(super) fn head<'a>(
    axes: impl Iterator<Item = &'a str>,
    output: &'a str,
) -> Result<String, Failure> {
    let mut head = csv::Writer::from_writer(Vec::new());
    let names = axes
        .chain([output])
        .map(|name| output::cell(name).into_owned());
    let more = ["coverage", "dominant_rule", "filled", "distance"].map(str::to_owned);
    head.write_record(names.chain(more))?;
    let head = head
        .into_inner()
        .map_err(|error| Failure::unreadable(error.to_string()))?;
    Ok(String::from_utf8_lossy(&head).into_owned())
}

/// Appends a row. Inputs and values have enough digits to read back as the same number, so that `--check` evaluates at the same
/// points.
pub(super) fn row(out: &mut String, point: &[f64], cell: &Cell) {
    for x in point {
        out.push_str(&format!("{x},"));
    }
    let value = cell.value.map(|value| value.to_string());
    let distance = match (cell.value, cell.filled_from) {
        (None, _) => String::new(),
        (_, distance) => short(distance.unwrap_or(0.0)),
    };
    let rule = cell.rule.map(|rule| (rule + 1).to_string());
    out.push_str(&format!(
        "{},{},{},{},{distance}\n",
        value.unwrap_or_default(),
        short(cell.coverage),
        rule.unwrap_or_default(),
        u8::from(cell.filled_from.is_some()),
    ));
}

/// Returns every cell of a slice.
pub(super) fn of_slice(slice: &Slice) -> Result<String, Failure> {
    let axes = std::iter::once(&slice.x).chain(&slice.y);
    let mut out = head(axes.map(|axis| axis.name.as_str()), &slice.output)?;
    for (i, x) in slice.x.points.iter().enumerate() {
        for j in 0..slice.rows() {
            let y = slice.y.as_ref().and_then(|y| y.points.get(j));
            let point: Vec<f64> = [x].into_iter().chain(y).copied().collect();
            row(&mut out, &point, &slice.cell(i, j));
        }
    }
    Ok(out)
}
