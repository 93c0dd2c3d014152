use alloc::string::ToString;

use super::*;
use crate::model::Model;

/// Returns the unweighted rules of the published method: margin and spread determine risk.
fn published() -> Model {
    let text = include_str!("../../../rules/flagred-paper.yaml");
    crate::yaml::parse(text).unwrap().model
}

fn map(points: usize) -> DecisionMap {
    let engine = Engine::new(&published()).unwrap();
    DecisionMap::new(&engine, Grid::new(&engine, points).unwrap(), 0).unwrap()
}

#[test]
fn the_unfilled_map_is_the_published_one() {
    let map = map(51);
    for (spread, row) in [
        (0.05, [90.3, 67.1, 63.4, 50.0, 34.5, 22.0, 22.0, 9.7, 9.7]),
        (0.10, [91.7, 69.4, 63.4, 50.0, 37.5, 25.0, 22.0, 8.3, 8.3]),
        (0.15, [90.3, 67.1, 63.4, 63.4, 46.4, 22.0, 22.0, 9.7, 9.7]),
        (0.20, [91.7, 91.1, 90.3, 91.7, 50.0, 8.3, 9.7, 8.3, 8.3]),
    ] {
        for (margin, risk) in [0.0, 0.03, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.5]
            .iter()
            .zip(row)
        {
            let value = map.interpolate(&[*margin, spread]).unwrap();
            assert!(
                (value - risk).abs() < 0.051,
                "at {margin}, {spread}: {value}, not {risk}"
            );
        }
    }
}

#[test]
fn the_gap_is_the_corner_that_the_paper_marks() {
    let map = map(101);
    for cell in 0..map.grid().cells() {
        let point = map.grid().point(cell);
        let (margin, spread) = (point[0], point[1]);
        // On the border itself, both antecedents fire at 0.5.
        if (margin - 0.15).abs() < 1e-9 || (spread - 0.05).abs() < 1e-9 {
            continue;
        }
        let corner = margin < 0.15 && spread < 0.05;
        assert_eq!(map.coverage(cell) < 0.5, corner, "at {margin}, {spread}");
    }
    assert_eq!((map.value(0), map.dominant(0)), (None, None));
}

#[test]
fn cells_points_and_slices_agree() {
    let engine = Engine::new(&published()).unwrap();
    let grid = Grid::new(&engine, 3).unwrap().points("spread", 5).unwrap();
    assert_eq!(grid.cells(), 15);
    for cell in 0..15 {
        assert_eq!(grid.cell(&grid.indices(cell)), Some(cell));
    }
    assert_eq!(grid.cell(&[0, 5]), None);
    assert_eq!(grid.point(14), [0.5, 0.5]);
    let slice = grid.clone().fix("margin", 0.07).unwrap();
    assert_eq!((slice.cells(), slice.fixed()[0].value), (5, 0.07));
    let map = DecisionMap::new(&engine, slice, 0).unwrap();
    let direct = engine.evaluate(&[0.07, 0.25]).unwrap()[0];
    assert_eq!(map.value(2), direct.value());
    assert_eq!(map.dominant(2), direct.dominant_rule);

    assert_eq!(
        grid.clone().fix("battery", 1.0).unwrap_err().to_string(),
        "the grid has no axis `battery`"
    );
    assert!(grid.fix("margin", f64::NAN).is_err());
    assert!(Grid::new(&engine, 1).is_err());
}

/// The limit applies to the cells that are evaluated: fixing an axis reduces their number.
#[test]
fn a_map_of_too_many_cells_is_refused_with_their_number() {
    let engine = Engine::new(&published()).unwrap();
    let grid = Grid::new(&engine, 4_000).unwrap();
    let refused = DecisionMap::new(&engine, grid.clone(), 0).unwrap_err();
    assert_eq!(
        refused.to_string(),
        "the grid has 16000000 cells; a map has at most 10000000"
    );
    let slice = grid.fix("margin", 0.07).unwrap();
    assert!(DecisionMap::new(&engine, slice, 0).is_ok());
    let endless = Grid::new(&engine, usize::MAX).unwrap();
    let refused = DecisionMap::new(&engine, endless, 0).unwrap_err();
    assert_eq!(
        refused.to_string(),
        "the grid has more than 10000000 cells, the maximum for a map"
    );
}

#[test]
fn values_between_cells_and_beyond_them() {
    let engine = Engine::new(&published()).unwrap();
    let grid = Grid::new(&engine, 3).unwrap();
    // x + 10 y is linear, so the interpolation must be exact.
    let plane = |cell: usize| Some(grid.point(cell)[0] + 10.0 * grid.point(cell)[1]);
    let read = |point: &[f64]| grid.interpolate(plane, point);
    assert!((read(&[0.1, 0.3]).unwrap() - 3.1).abs() < 1e-12);
    assert!((read(&[-1.0, 9.0]).unwrap() - 5.0).abs() < 1e-12);
    assert_eq!(read(&[0.1]), None);
    assert_eq!(read(&[f64::NAN, 0.0]), None);
    // A cell without a value only matters if its weight is not 0.
    let holed = |cell: usize| (cell != 0).then_some(1.0);
    assert_eq!(grid.interpolate(holed, &[0.1, 0.1]), None);
    assert_eq!(grid.interpolate(holed, &[0.0, 0.25]), Some(1.0));
    assert_eq!(grid.interpolate(holed, &[0.0, 0.2]), None);
}
